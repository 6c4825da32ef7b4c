"""Pictures of a page: the failure cone, diagrams of simple factors, the pattern of the brackets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from liehom.algebra import LieAlgebra, RealForm
from liehom.errors import InputError, LiehomError
from liehom.fullness import FailureReport
from liehom.pages.elements import figure, json_script, paragraph
from liehom.plotting import plot_bracket_table, plot_failure_cone, plot_satake
from liehom.plotting.canvas import matplotlib_module
from liehom.plotting.inline_svg import Drawing, inline_svg
from liehom.plotting.strata_plot import failure_curves
from liehom.representations import Pair
from liehom.typing import Array

MAX_PATTERN = 12
"""Largest dimension for which the pattern of the brackets is drawn."""
MOST_DIAGRAMS = 4
MOST_POINTS = 200
"""Points of a curve of the cone that can be turned."""


def picture(draw: Drawing, name: str, caption: str, kinds: Sequence[str] = ("light", "dark")) -> str:
    """A figure with a light and a dark version of a picture; without matplotlib, a sentence about it."""
    if (missing := without_matplotlib()) is not None:
        return missing
    drawn = {kind: inline_svg(draw, f"{name}-{kind}", dark=kind == "dark") for kind in kinds}
    return figure("".join(f'<div class="{kind}">{svg}</div>' for kind, svg in drawn.items()), caption)


def without_matplotlib() -> str | None:
    """The sentence that replaces a picture, or None if matplotlib is installed."""
    try:
        matplotlib_module("")
    except InputError as missing:
        return paragraph(f"No picture: when this page was written, {missing}", "note")
    return None


def bracket_picture(algebra: LieAlgebra) -> str:
    """The pattern of the brackets, for small algebras."""
    if not 0 < algebra.dimension <= MAX_PATTERN:
        return ""
    caption = (
        "Brackets [row, column]: each basis element has its colour at the margin, and each term of a bracket is a "
        "strip in the colour of its basis element, with its sign. The table has the same content."
    )
    return picture(lambda: plot_bracket_table(algebra), "pattern", caption)


def diagrams(parts: Mapping[str, LieAlgebra]) -> str:
    """Satake diagrams of the simple factors of algebras, or why there are none."""
    found: dict[str, list[str]] = {}
    absent = []
    for name, algebra in parts.items():
        if not algebra.dimension:
            continue
        try:
            levi = algebra.levi_decomposition().levi.as_algebra()
            forms = [form.name for form in levi.real_forms()] if levi.dimension else []
        except LiehomError as unknown:  # floats, or real forms that are not decided
            absent.append(f"No Satake diagram of {name}: {unknown}.")
            continue
        for form in forms:
            found.setdefault(form, []).append(name)
        if not forms:
            absent.append(f"{name} is solvable, so it has no Satake diagram.")
    drawn = [
        picture(lambda form=form: plot_satake(form), f"satake{i}", _satake_caption(form, names))  # type: ignore[misc]
        for i, (form, names) in enumerate(list(found.items())[:MOST_DIAGRAMS])
    ]
    if len(found) > MOST_DIAGRAMS:
        absent.append(f"The first {MOST_DIAGRAMS} of {len(found)} Satake diagrams are drawn.")
    return f'<div class="diagrams">{"".join(drawn)}</div>' + "".join(paragraph(words, "note") for words in absent)


def _satake_caption(name: str, inside: Sequence[str]) -> str:
    satake = RealForm.of_name(name).satake
    times = {part: f" ({inside.count(part)} times)" if inside.count(part) > 1 else "" for part in dict.fromkeys(inside)}
    factor = " and ".join(part + often for part, often in times.items())
    black = f"{len(satake.black)} black" if satake.black else "no black nodes"
    arrows = f", {len(satake.arrows)} arrow{'s' if len(satake.arrows) > 1 else ''}" if satake.arrows else ""
    split = (
        f"restricted roots {satake.restricted_type}, real rank {satake.real_rank}" if satake.real_rank else "compact"
    )
    return f"Satake diagram of {name}, a simple factor of {factor}: type {satake.type}, {black}{arrows}; {split}"


def cone_picture(pair: Pair, report: FailureReport) -> str:
    """The cone in g/h of dimension 2, or the cone of dimension 3 that can be turned."""
    if pair.dimension not in (2, 3):
        return paragraph(f"The cone is drawn for dim g/h = 2 or 3; here dim g/h = {pair.dimension}.", "note")
    if (missing := without_matplotlib()) is not None:
        return missing
    curves = failure_curves(report, pair.dimension)
    if not curves:
        return paragraph("No part of it is a curve or surface over the reals that could be drawn.", "note")
    caption = "The cone on which (6.3) fails, cut off at the unit "
    if pair.dimension == 2:
        return picture(lambda: plot_failure_cone(pair), "cone", f"{caption}circle.")
    # shown where no script runs, on white
    still = picture(lambda: plot_failure_cone(pair), "cone", f"{caption}sphere.", ["still"])
    points = [np.round(_thinned(curve.T), 4).tolist() for curve in curves]
    help_ = "Drag it, or use the arrow keys or the buttons, to turn it."
    return (
        f'<div class="turn" hidden>{figure("<div></div>", f"{caption}sphere. {help_}")}</div>'
        f'<div class="unturned">{still}</div>' + json_script("cone", points)
    )


def _thinned(points: Array) -> Array:
    """At most `MOST_POINTS` of the points of a curve, its ends among them."""
    kept = np.linspace(0, len(points) - 1, min(len(points), MOST_POINTS)).round().astype(int)
    thinned: Array = points[kept]
    return thinned
