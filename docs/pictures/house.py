"""The house of the code: its folders as rooms, the imports between them as arrows, read from the sources."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from matplotlib.patches import FancyBboxPatch

import liehom
from liehom.plotting.canvas import GREY, new_figure
from pictures import picture

PACKAGE = Path(liehom.__file__).resolve().parent
SLABS = ("cli", "testing", "io", "studies", "plotting")
EXACT = ("catalog",), ("fullness",), ("pauli", "orbits"), ("representations",), ("algebra",), ("scalars",)
FLOW = (
    ("convergence", "bodies", "spins"),
    ("propagation",),
    ("methods", "engines"),
    ("run",),
    ("steps",),
    ("action",),
    ("series",),
    ("tracing",),
)
"""Floors from the roof down."""


def room(module: str) -> str:
    """The room that a module is in, such as "exact.scalars"."""
    parts = module.split(".")[1:]
    return ".".join(parts[: 2 if parts and parts[0] in ("exact", "flow") else 1])


def modules() -> Iterator[tuple[str, Path]]:
    """All modules with their files."""
    for path in sorted(PACKAGE.rglob("*.py")):
        name = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        yield name.removesuffix(".__init__"), path


def arrows() -> set[tuple[str, str]]:
    """Pairs of rooms of which one imports the other when it is loaded, without those that follow from two others."""
    pairs = set()
    for module, path in modules():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom) and str(node.module).startswith("liehom."):
                pairs.add((room(module), room(str(node.module))))
    direct = {(one, other) for one, other in pairs if one and other and one != other}
    return {
        (one, other)
        for one, other in direct
        if not any((one, middle) in direct and (middle, other) in direct for middle, _ in direct)
    }


def sizes() -> dict[str, int]:
    """The lines of each room."""
    lines: dict[str, int] = {}
    for module, path in modules():
        count = path.read_text(encoding="utf-8").count("\n")
        lines[room(module)] = lines.get(room(module), 0) + count
    return lines


def places() -> dict[str, tuple[float, float, float]]:
    """Left end, bottom and width of each room, all of height 0.6."""
    boxes = {"base": (0.0, 0.0, 10.0), "flow.door": (4.55, 1.3, 0.9)}
    boxes |= {name: (0.0, 10.1 + 0.8 * floor, 10.0) for floor, name in enumerate(reversed(SLABS))}
    for half, left, floors in (("exact", 0.25, EXACT), ("flow", 6.0, FLOW)):
        for floor, row in enumerate(reversed(floors)):
            width = (3.75 + 0.15) / len(row) - 0.15
            for column, name in enumerate(row):
                height = 1.3 + floor * 7.2 / (len(floors) - 1)
                boxes[f"{half}.{name}"] = (left + column * (width + 0.15), height, width)
    return boxes


def box(axes: Any, x: float, y: float, width: float, height: float, **style: Any) -> None:
    """A rectangle with round corners."""
    shape = "round,pad=0,rounding_size=0.12"
    axes.add_patch(FancyBboxPatch((x, y), width, height, boxstyle=shape, **style))


@picture
def house_of_the_code(colours: Sequence[str]) -> Any:
    """Floors from the base to the command line; an arrow points to what is imported."""
    figure = new_figure(7.4, 8.4)
    axes = figure.add_subplot()
    axes.set(xlim=(-0.1, 10.1), ylim=(-0.1, 14.0))
    axes.set_axis_off()
    boxes, lines = places(), sizes()
    colour = {"exact": colours[0], "flow": colours[1]}
    for half, left in (("exact", 0.0), ("flow", 5.75)):
        box(axes, left, 1.05, 4.25, 8.7, facecolor=colour[half], alpha=0.12, edgecolor="none")
        about = {"exact": "exact: algebra with proofs", "flow": "flow: trajectories"}[half]
        axes.text(left + 2.1, 9.42, about, ha="center", va="center", fontsize=10, color=colour[half])
    for name, (x, y, width) in boxes.items():
        edge = colour.get(name.partition(".")[0], GREY)
        box(axes, x, y, width, 0.6, facecolor="none", edgecolor=edge, linewidth=1.4)
        label = name.rpartition(".")[2] + ("" if width < 2.0 else f"   {lines[name]:,}")
        size = 8.5 if width > 1.5 else 7.5
        axes.text(x + width / 2, y + 0.28, label, ha="center", va="center", fontsize=size)
    style = {"arrowstyle": "-|>", "color": GREY, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
    for one, other in sorted(arrows()):
        (x, y, width), (u, v, reach) = boxes.get(one, (0, 0, 0)), boxes.get(other, (0, 0, 0))
        if one.startswith(("exact.", "flow.")) and "flow.door" not in (one, other):
            across = x + width / 2 if width < reach else u + reach / 2
            axes.annotate("", (across, v + 0.6), (across, y), arrowprops=style)
    axes.annotate("", (5.45, 1.6), (5.75, 1.6), arrowprops=style)
    axes.annotate("", (4.25, 1.6), (4.55, 1.6), arrowprops=style)
    return figure
