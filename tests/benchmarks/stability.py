"""Stability of corrected steps on stiff fields: limits on three manifolds, and regions in the plane of lambda dt.

    python -m tests.benchmarks.stability [--page docs/stiff.md]

prints a table; with --page it replaces the table between the markers of the page. The build of the pages draws the
regions.
"""

import argparse
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import liehom as lh
from liehom.flow.methods.stability import amplification
from liehom.plotting.canvas import COLOURS, DARK_COLOURS, DASHES, new_figure, style

MARKERS = ("<!-- stability: begin -->", "<!-- stability: end -->")
GRID = np.array([0.2, 0.4, 0.6, 0.8, *np.arange(1, 2.05, 0.1), *np.arange(2.5, 6, 0.5), 8, 10, 30, 100, 1000])
"""Sizes K h that are tried, from the smallest on, until a run does not approach the equilibrium."""
STEPS = 40
STARTS = 10
DISTANCE = 0.2
"""Largest distance of a start from the equilibrium, on a sphere of radius 1."""
EXTENT = (-7.0, 3.0, -5.0, 5.0)
RESOLUTION = 141


class System(NamedTuple):
    """A field with damping rate K, its equilibrium, and points near it."""

    title: str
    field: Callable[[float], lh.GeneratorField]
    starts: Any
    distance: Callable[[Any], Any]


def systems() -> list[System]:
    """A damped spin, relaxation on S^3, and the double bracket flow on symmetric matrices with spectrum 1, 1, 2."""
    rng = np.random.default_rng(0)
    made = []
    up = np.array([0.0, 0.0, 1.0])

    def spin(rate: float) -> lh.GeneratorField:
        alpha = 2.0  # damping rate K, precession K/2
        return lh.LandauLifshitz(applied=rate * (1 + alpha**2) / alpha * up, damping=alpha).field

    near = up + DISTANCE * rng.uniform(-1, 1, size=(STARTS, 3))
    near /= np.linalg.norm(near, axis=-1, keepdims=True)
    made.append(System("damped spin, S²", spin, near, lambda y: np.linalg.norm(y - up, axis=-1)))

    four = lh.defining(lh.so(4))
    e = np.array([0.0, 0.0, 0.0, 1.0])
    matrices = np.array([a.to_numpy() for a in four.matrices])  # <A_a m, e>: the generator of e - <m, e> m

    def relaxation(rate: float) -> lh.GeneratorField:
        return lh.GeneratorField(four, lambda m: rate * np.einsum("aij,...j,i->...a", matrices, m, e))

    near = e + DISTANCE * rng.uniform(-1, 1, size=(STARTS, 4))
    near /= np.linalg.norm(near, axis=-1, keepdims=True)
    made.append(System("relaxation, S³", relaxation, near, lambda y: np.linalg.norm(y - e, axis=-1)))

    rest = lh.representations.symmetric_to_vector(np.diag([1.0, 1.0, 2.0]))
    space = lh.Action(lh.sym_conjugation(3))

    def brackets(rate: float) -> lh.GeneratorField:
        return lh.instances.double_bracket_flow(rate * np.diag([0.0, 1 / 3, 1.0]))

    near = space.act(DISTANCE * rng.uniform(-1, 1, size=(STARTS, 3)), np.broadcast_to(rest, (STARTS, 6)))
    made.append(System("double bracket, Sym(3)", brackets, near, lambda y: np.linalg.norm(y - rest, axis=-1)))
    return made


STEP_LIST: dict[str, lh.Step] = {
    "Euler": lh.Euler(),
    **{f"Euler, order {n}": lh.Corrected(lh.Euler(), n) for n in (2, 3, 4)},
    "backward Euler": lh.BackwardEuler(),
    **{f"backward Euler, order {n}": lh.Corrected(lh.BackwardEuler(), n) for n in (2, 3, 4)},
    "Rosenbrock, order 4": lh.methods.Rosenbrock("rodas4"),
}


def limit(system: System, step: lh.Step, clock: str) -> float:
    """K times the mean time of a step, for the largest size up to which all starts approach the equilibrium."""
    best = 0.0
    for size in GRID:
        field = system.field(float(size))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sol = lh.integrate(field, (0, STEPS), system.starts, step=step, dt=1.0, clock=clock, t_eval=[0.0, STEPS])
        if not bool(np.isin(sol.statuses, (0, -2)).all()):
            break
        before, after = system.distance(system.starts), system.distance(sol.y[..., -1])
        if not bool((after < 0.7 * before + 1e-6).all()):
            break
        best = float(size * STEPS / np.max(sol.n_steps))
        if size == GRID[-1]:
            return np.inf
    return best


def table() -> str:
    found = systems()
    heads = [
        f"{s.title}{', nominal' if clock == 'nominal' else ''}" for s in found for clock in ("corrected", "nominal")
    ]
    rows = ["| step | " + " | ".join(heads) + " |", "|---|" + "---|" * len(heads)]
    for name, step in STEP_LIST.items():
        values = [limit(s, step, clock) for s in found for clock in ("corrected", "nominal")]
        shown = ["all" if np.isinf(v) else "none" if v == 0 else f"{v:.1f}" for v in values]
        rows.append(f"| {name} | " + " | ".join(shown) + " |")
        print(rows[-1], flush=True)
    return "\n".join(rows)


PANELS = (
    ("explicit base, order of trajectories", "corrected", ["Euler", *[f"Euler, order {n}" for n in (2, 3, 4)]]),
    ("explicit base, order of orbits only", "nominal", ["Euler", "Euler, order 2"]),
    ("implicit base, order of orbits only", "nominal", ["backward Euler", "backward Euler, order 2"]),
)  # fmt: skip


def regions() -> list[tuple[str, list[tuple[str, Any]]]]:
    """For each panel the names of the steps and their amplification on the grid of lambda dt."""
    x, y = np.linspace(EXTENT[0], EXTENT[1], RESOLUTION), np.linspace(0, EXTENT[3], RESOLUTION // 2 + 1)
    z = x[None, :] + 1j * y[:, None]
    made = []
    for title, clock, names in PANELS:
        maps = []
        for name in names:
            values = np.concatenate([amplification(STEP_LIST[name], row, clock=clock)[None] for row in z])
            maps.append((name, np.concatenate([values[:0:-1], values])))
        made.append((title, maps))
    return made


def draw_for_pages(folder: Path) -> None:
    """Write stability_light.svg and stability_dark.svg, if one is missing or older than this module."""
    files, changed = [folder / f"stability_{kind}.svg" for kind in ("light", "dark")], Path(__file__).stat().st_mtime
    if not all(file.exists() and file.stat().st_mtime > changed for file in files):
        draw(regions(), folder)


def draw(found: list[tuple[str, list[tuple[str, Any]]]], folder: Path) -> None:
    """stability_light.svg and stability_dark.svg: the boundaries of the regions where deviations do not grow."""
    x = np.linspace(EXTENT[0], EXTENT[1], RESOLUTION)
    y = np.linspace(EXTENT[2], EXTENT[3], 2 * (RESOLUTION // 2) + 1)
    for kind, colours in (("light", COLOURS), ("dark", DARK_COLOURS)):
        with style(dark=kind == "dark"):
            figure = new_figure(5.6, 8.4)
            figure.patch.set_alpha(0.0)
            panels = figure.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
            for axes, (title, maps) in zip(panels, found, strict=True):
                for colour, dashes, (name, values) in zip(colours, DASHES, maps, strict=False):
                    factor = np.minimum(np.nan_to_num(values, nan=2.0), 2.0)
                    axes.contour(x, y, factor, levels=[1 + 1e-6], colors=[colour], linewidths=1.4, linestyles=[dashes])
                    axes.plot([], [], dashes, color=colour, label=name)
                axes.axhline(0, linewidth=0.5, color="#888888")
                axes.axvline(0, linewidth=0.5, color="#888888")
                axes.set_title(title)
                axes.set_ylabel("Im λ dt")
                axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=10)
            panels[-1].set_xlabel("Re λ dt")
            figure.savefig(folder / f"stability_{kind}.svg", metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    made = table()
    if given.page is not None:
        before, rest = given.page.read_text(encoding="utf-8").split(MARKERS[0])
        after = rest.split(MARKERS[1])[1]
        given.page.write_text(f"{before}{MARKERS[0]}\n\n{made}\n\n{MARKERS[1]}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
