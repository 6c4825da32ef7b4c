"""Pictures of the measured figures of integration, in a light and a dark version; nothing is measured again.

The build of the pages draws them from docs/_static/integration.json. They are as wide as the text column of a phone
allows with readable letters, so panels are below one another.
"""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from liehom.plotting.canvas import MARKERS, current_colours, matplotlib_module, muted_colour, new_figure, style
from liehom.plotting.error_plot import Curve, draw_curve
from tests.benchmarks.integration_measure import best, curve
from tests.benchmarks.integration_methods import EAGER, IN_JIT, JAX, LLVM
from tests.benchmarks.integration_problems import Problem, problems

DATA = Path(__file__).resolve().parents[2] / "docs" / "_static" / "integration.json"
MANY = 10_000
RATIOS = "cost_ratios"
KINDS = ("light", "dark")
PEERS = ("heyoka.py", "scipy DOP853", "diffrax", "numba RK4 by hand")
LOOKS = {
    LLVM: (0, "-"), EAGER: (1, "-"), JAX: (2, "-"), "scipy DOP853": (3, "--"), "heyoka.py": (4, "--"),
    "diffrax": (5, "--"), "numba RK4 by hand": (6, ":"), IN_JIT: (0, "-"),
}  # fmt: skip
"""Index of the color and marker of each program, and its dashes, in all pictures."""


def groups(methods: list[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """Rows by program, in the order of the figures, liehom first."""
    found: dict[str, list[dict[str, Any]]] = {}
    for row in methods:
        found.setdefault(row["group"], []).append(row)
    return found


def picture_name(problem: Problem) -> str:
    plain = problem.name.lower().translate(
        str.maketrans({"⁴": "4", "³": "3", "²": "2", "(": "", ")": "", ",": "", " ": "_"})
    )
    return f"work_precision_{plain}"


def image(name: str, words: str) -> list[str]:
    """Lines of a page that show a picture."""
    return [f"```{{picture}} {name}", f":alt: {words}", ":width: 34em", "```", ""]


def draw_for_pages(folder: Path) -> None:
    """Write the pictures of the pages into a folder, if one is missing or older than the figures or this module."""
    changed = max(path.stat().st_mtime for path in (DATA, Path(__file__)))
    files = [folder / f"{name}_{kind}.svg" for name in (*map(picture_name, problems()), RATIOS) for kind in KINDS]
    if not all(file.exists() and file.stat().st_mtime > changed for file in files):
        draw(json.loads(DATA.read_text(encoding="utf-8")), folder)


def draw(data: dict[str, Any], folder: Path) -> None:
    """Write both versions of the picture of each problem, and of the ratios of costs."""
    pictures = [
        (picture_name(problem), lambda problem=problem: _of_problem(problem, data["problems"][problem.name]))
        for problem in problems()
        if problem.name in data["problems"]
    ]
    for name, figure_of in (*pictures, (RATIOS, lambda: _of_ratios(data))):
        for kind in KINDS:
            with style(dark=kind == "dark"), matplotlib_module("").rc_context({"svg.fonttype": "none"}):
                figure = figure_of()
                figure.patch.set_alpha(0.0)
                figure.savefig(folder / f"{name}_{kind}.svg", metadata={"Date": None})


# -- work and precision --------------------------------------------------------------------------------------
def _of_problem(problem: Problem, data: dict[str, Any]) -> Any:
    """Errors against the cost of the steps: orbits or energy above, trajectories below."""
    count = MANY if any(str(MANY) in row.get("costs", {}) for row in data["methods"]) else 1
    figure = new_figure(5.6, 7.6)
    panels = figure.subplots(2, 1, sharex=True)
    for ax, orbit in zip(panels, (True, False), strict=True):
        ax.set_xscale("log")
        ax.set_yscale("log")
        for name, rows in groups(data["methods"]).items():
            measured = [r for r in rows if str(count) in r.get("costs", {})]
            front = _front([p for r in measured for p in curve(problem, r, count, orbit=orbit)])
            if front:
                index, dashes = LOOKS[name]
                draw_curve(ax, Curve(name, front, [], math.nan, current_colours()[index], MARKERS[index], dashes))
        what = ("energy" if problem.energy is not None else "distance from the orbit") if orbit else "trajectory"
        ax.set(title=f"{problem.name}: {what}", ylim=(1e-14, 1), ylabel="error")
    panels[1].set_xlabel("µs for each of 10,000 trajectories" if count == MANY else "µs for one trajectory")
    figure.legend(
        *panels[1].get_legend_handles_labels(), loc="outside lower center", ncols=2, handlelength=3.0, fontsize=10
    )
    return figure


def _front(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points (cost, error) for which no cheaper point has a smaller error."""
    kept: list[tuple[float, float]] = []
    for cost, error in sorted(points):
        if not kept or error < kept[-1][1]:
            kept.append((cost, error))
    return kept


# -- ratios --------------------------------------------------------------------------------------------------
def multiples(data: dict[str, Any], peer: str, count: int, target: float) -> Iterator[tuple[Problem, float]]:
    """(problem, cost of a program as a multiple of that of liehom) at a trajectory error, whole calls."""
    for problem in problems():
        methods = data["problems"].get(problem.name, {"methods": []})["methods"]
        ours = [row for row in methods if row["group"].startswith("liehom")]
        theirs = [row for row in methods if row["group"] == peer]
        mine, other = (
            best(problem, rows, count, target, orbit=False, call=True)[0] for rows in (ours, theirs)
        )  # fmt: skip
        if math.isfinite(mine) and math.isfinite(other):
            yield problem, other / mine


def _of_ratios(data: dict[str, Any], target: float = 1e-6) -> Any:
    """How many times the cost of liehom other programs need for the same error: one and 10,000 trajectories."""
    found = [
        (title, {peer: list(multiples(data, peer, count, target)) for peer in PEERS})
        for count, title in ((1, "one trajectory"), (MANY, "10,000 trajectories"))
    ]
    known = [{problem.name for points in by.values() for problem, _ in points} for _, by in found]
    names = [[problem.name for problem in problems() if problem.name in present] for present in known]
    figure = new_figure(5.6, 6.6)
    panels = figure.subplots(2, 1, sharex=True, height_ratios=[len(present) + 1 for present in names])
    for ax, shown, (title, by) in zip(panels, names, found, strict=True):
        for peer, points in by.items():
            index, _ = LOOKS[peer]
            ax.plot(
                [ratio for _, ratio in points], [shown.index(problem.name) for problem, _ in points],
                MARKERS[index], color=current_colours()[index], markersize=8, label=peer,
            )  # fmt: skip
        ax.axvline(1.0, color=muted_colour(), linewidth=1.2)
        ax.set_xscale("log")
        ax.set_yticks(range(len(shown)), shown)
        ax.set_ylim(len(shown) - 0.5, -0.5)
        ax.set_title(title)
    panels[1].set_xlabel(
        "CPU time of other programs / CPU time of liehom\n(left of 1 liehom costs more, right of 1 less)"
    )
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=10)
    return figure
