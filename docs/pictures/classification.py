"""Pictures of the classification: spirals, weights, nodes of coefficient 1, and the rows of the plane."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.plotting.canvas import DASHES, GREY, new_figure
from liehom.plotting.diagram_plot import node_places, plot_dynkin, simple_root_coordinates
from pictures import picture

CLASS_B = {"A7": {0, 1, 5, 6}, "B6": {0}, "C6": set(), "D6": {0}, "E6": {0, 5}, "E7": set()}
"""The nodes of coefficient 1 whose gradings are rows of class B."""

ROWS_OF_THE_PLANE = {
    "similarities\nC": (0.0, 4),
    "spirals\nR(J + c)": (-1.15, 3),
    "Euclid\nso(2)": (0.0, 3),
    "sphere\nso(3)/so(2)": (1.15, 3),
    "hyperbolic\nso(2,1)/so(2)": (2.45, 3),
    "equiaffine\nsl(2)": (-1.15, 5),
    "affine\ngl(2)": (-0.6, 6),
    "Möbius, CP¹\nsl(2,C)/P1": (1.8, 6),
    "projective, RP²\nsl(3)/P1": (0.6, 8),
}
"""(horizontal place, dimension of g) of the rows with d = 2."""
INCLUSIONS = ((1, 0), (2, 0), (2, 5), (0, 6), (5, 6), (0, 7), (6, 8), (3, 7), (4, 7), (3, 8), (4, 8))
"""Indices of rows (i, j): the group of i acts on the space of j, or on an open part of it, as a subgroup."""


def blank(axes: Any) -> Any:
    """Axes without a frame, of equal scales."""
    axes.set_aspect("equal")
    axes.axis("off")
    return axes


@picture
def spirals(colours: Sequence[str]) -> Any:
    """Orbits of exp t(J + c) through one point, with their tangents there, and rays."""
    figure = new_figure(5.0, 5.0)
    axes = blank(figure.add_subplot())
    for angle in np.arange(12) * np.pi / 6:
        axes.plot([0, 3 * np.cos(angle)], [0, 3 * np.sin(angle)], color=GREY, linewidth=0.6, zorder=0)
    axes.plot([0, 3], [0, 0], color=colours[6], linewidth=1.6, label="the ray of x")
    for k, c in enumerate((0.0, 0.15, 0.6)):
        t = np.linspace(-np.pi, np.pi, 400) if c == 0 else np.linspace(-4 * np.pi, np.log(3) / c, 1600)
        r = np.exp(c * t)
        label = "c = 0: circles" if c == 0 else f"c = {c}"
        axes.plot(r * np.cos(t), r * np.sin(t), color=colours[k], linestyle=DASHES[k], linewidth=1.8, label=label)
        scale = 0.8 / np.hypot(c, 1)
        arrow = {"arrowstyle": "-|>", "color": colours[k], "linewidth": 1.6}
        axes.annotate("", (1 + scale * c, scale), (1, 0), arrowprops=arrow)
    axes.plot(1, 0, "o", color=colours[6], markersize=6, zorder=5)
    axes.annotate("x", (1, 0), xytext=(4, -12), textcoords="offset points")
    axes.set(xlim=(-3, 3), ylim=(-3, 3))
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=2)
    return figure


def draw_weights(axes: Any, kind: str, top: tuple[int, ...], colours: Sequence[str]) -> None:
    """The weights of a module of rank 2, those of the form lambda - beta joined to lambda."""
    system = lh.root_system(kind)
    simple = simple_root_coordinates(system)
    fundamental = np.linalg.inv(np.array(system.cartan, dtype=float)) @ simple
    start = np.array(top) @ fundamental
    up = np.array([[start[1], start[0]], [-start[0], start[1]]]) / np.linalg.norm(start)  # turns lambda upwards
    for beta in system.positive_roots:
        if any(x and y for x, y in zip(top, beta, strict=True)):
            x, y = (np.array([start, start - np.array(beta) @ simple]) @ up).T
            axes.plot(x, y, color=colours[0], linewidth=1.2, zorder=1)
    for weight, multiplicity in lh.representations.character(kind, top).items():
        point = np.array(weight) @ fundamental @ up
        axes.plot(*point, "o", color=colours[0], markersize=7, zorder=3)
        if multiplicity > 1:
            axes.plot(*point, "o", color=colours[1], markersize=14, fillstyle="none", markeredgewidth=2, zorder=3)
    axes.annotate("λ", start @ up, xytext=(8, 2), textcoords="offset points")
    axes.annotate("−λ", -start @ up, xytext=(8, -8), textcoords="offset points")
    axes.margins(0.12)


@picture
def weights_of_the_proof(colours: Sequence[str]) -> Any:
    """The module of G2 that satisfies the condition, and the adjoint module of A2, in which 0 is a double weight."""
    figure = new_figure(5.4, 3.2)
    left, right = figure.subplots(1, 2)
    draw_weights(blank(left), "G2", (1, 0), colours)
    left.set_title("G₂ on ℝ⁷: transitive", loc="center")
    draw_weights(blank(right), "A2", (1, 1), colours)
    right.set_title("SU(3) on ℝ⁸: 0 is double", loc="center")
    return figure


@picture
def nodes_of_coefficient_one(colours: Sequence[str]) -> Any:
    """Dynkin diagrams with the coefficients of the highest root; full where the grading is a row of class B."""
    figure = new_figure(5.2, 6.0)
    heights = [1.45 + np.ptp(node_places(kind)[:, 1]) for kind in CLASS_B]
    for axes, (kind, rows) in zip(
        figure.subplots(len(CLASS_B), 1, height_ratios=heights), CLASS_B.items(), strict=True
    ):
        marks = lh.root_system(kind).highest_roots[0]
        plot_dynkin(kind, axes, labels=marks)
        axes.set(xlim=(-1.2, 6.5), title="")
        axes.text(-0.9, 0.0, kind, va="center", fontsize=12)
        for i, (mark, node) in enumerate(zip(marks, axes.patches, strict=True)):
            colour = colours[0] if i in rows else colours[1]
            if mark == 1:
                node.set(edgecolor=colour, facecolor=colour if i in rows else "none", linewidth=2.4)
    axes.plot([], [], "o", color=colours[0], markersize=9, label="coefficient 1, a row of class B")
    ring = {"markersize": 9, "fillstyle": "none", "markeredgewidth": 2.4}
    axes.plot([], [], "o", color=colours[1], label="coefficient 1, not full", **ring)
    figure.legend(loc="outside lower center", ncols=2)
    return figure


@picture
def rows_of_the_plane(colours: Sequence[str]) -> Any:
    """The nine rows with d = 2 by the dimension of g; lines are inclusions of the groups that act."""
    figure = new_figure(5.6, 5.2)
    axes = figure.add_subplot()
    classes = {"A": (0, 1, 2, 5, 6), "B": (7, 8), "C": (3, 4)}
    labels = {}
    for k, (letter, members) in enumerate(classes.items()):
        for i in members:
            name, place = list(ROWS_OF_THE_PLANE.items())[i]
            box = {"boxstyle": "round,pad=0.35", "edgecolor": colours[k], "linestyle": DASHES[k], "linewidth": 1.6}
            box |= {"facecolor": "none"}
            labels[i] = axes.text(*place, name, ha="center", va="center", fontsize=8.5, bbox=box)
        axes.plot([], [], color=colours[k], linestyle=DASHES[k], label=f"class {letter}")
    for i, j in INCLUSIONS:
        ends = labels[i].get_position(), labels[j].get_position()
        line: dict[str, Any] = {"arrowstyle": "-", "color": GREY, "shrinkA": 0, "shrinkB": 0}
        line |= {"patchA": labels[i].get_bbox_patch(), "patchB": labels[j].get_bbox_patch()}
        axes.annotate("", ends[1], ends[0], arrowprops=line)
    axes.set(xlim=(-1.8, 3.2), ylim=(2.5, 8.5), yticks=[3, 4, 5, 6, 8], ylabel="dimension of g", xticks=[])
    axes.spines["bottom"].set_visible(False)
    axes.grid(visible=False)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    return figure
