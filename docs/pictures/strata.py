"""Pictures of the studies: eigenvalues, singular values, Weyl chambers and binary forms by their orbit types."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.plotting.canvas import GREY, new_figure
from pictures import picture


@picture
def eigenvalues_of_symmetric_matrices(colours: Sequence[str]) -> Any:
    figure = new_figure(5.0, 4.6)
    lh.plotting.plot_eigenvalues(figure.add_subplot())
    return figure


@picture
def weyl_chambers(colours: Sequence[str]) -> Any:
    figure = new_figure(8.4, 4.6)
    for axes, kind in zip(figure.subplots(1, 2), ("B2", "G2"), strict=True):
        lh.plotting.plot_weyl_chamber(kind, axes)
    return figure


@picture
def failure_cones(colours: Sequence[str]) -> Any:
    """One cone each in the plane and in space."""
    figure = new_figure(8.4, 4.2)
    lh.plotting.plot_failure_cone(lh.pair("sl(2)/so(1,1)"), figure.add_subplot(1, 2, 1))
    solid = figure.add_subplot(1, 2, 2, projection="3d", proj_type="ortho")
    lh.plotting.plot_failure_cone(lh.pair("so(3,1)/so(2,1)"), solid)
    return figure


@picture
def singular_values(colours: Sequence[str]) -> Any:
    """The plane of diagonal 2 x 2 matrices: each orbit of SO(2) x SO(2) meets it in a + b and |a - b|."""
    figure = new_figure(5.0, 4.6)
    axes = figure.add_subplot()
    axes.fill([0, 1.2, 1.2, 0], [0, 1.2, -1.2, 0], color=colours[0], alpha=0.18, linewidth=0)
    axes.plot([], [], color=colours[0], alpha=0.4, linewidth=6, label="a > |b|: isotropy 0, orbits of dimension 2")
    axes.plot([0, 1.2], [0, 1.2], color=colours[1], linewidth=2.2, label="a = b: multiples of rotations, isotropy R")
    axes.plot(
        [0, 1.2], [0, -1.2], color=colours[2], linewidth=2.2, label="a = -b: multiples of reflections, isotropy R"
    )
    axes.plot(0, 0, "o", color=colours[3], markersize=8, label="0: isotropy so(2) + so(2)", zorder=4)
    axes.plot([-1.2, 1.2], [-1.2, 1.2], color=GREY, linewidth=0.6, zorder=0)
    axes.plot([-1.2, 1.2], [1.2, -1.2], color=GREY, linewidth=0.6, zorder=0)
    axes.set(aspect="equal", xlim=(-0.5, 1.3), ylim=(-1.3, 1.3), xlabel="a", ylabel="b")
    axes.legend(loc="upper center", bbox_to_anchor=(0.4, -0.14), fontsize=8)
    return figure


@picture
def binary_quartics(colours: Sequence[str]) -> Any:
    """The quartics x^4 + 6 a x^2 y^2 + b y^4 by their real roots, and the forms with isotropy among them."""
    figure = new_figure(5.4, 4.8)
    axes = figure.add_subplot()
    a, b = np.meshgrid(np.linspace(-1.5, 1.5, 601), np.linspace(-1.5, 1.5, 601))
    # z = x^2 / y^2 solves z^2 + 6 a z + b = 0
    gap = 9 * a**2 - b
    larger = np.where(gap >= 0, -3 * a + np.sqrt(abs(gap)), np.nan)
    smaller = np.where(gap >= 0, -3 * a - np.sqrt(abs(gap)), np.nan)
    roots = 2 * (np.nan_to_num(larger, nan=-1) > 0).astype(int) + 2 * (np.nan_to_num(smaller, nan=-1) > 0)
    shades = [colours[0], colours[5], colours[3]]
    axes.contourf(a, b, roots, levels=[-1, 1, 3, 5], colors=shades, alpha=0.22)
    for colour, text in zip(shades, ("no real root", "2 real roots", "4 real roots"), strict=True):
        axes.plot([], [], color=colour, alpha=0.4, linewidth=6, label=text)
    axes.axhline(0, color=colours[1], linewidth=2.0, label="b = 0: x² is a factor, a double root")
    size = np.linspace(0.0, 0.4082, 100)
    for sign, line, text in ((1, "-", "a > 0: (x² + 3ay²)², isotropy so(2)"), (-1, "--", "a < 0: isotropy so(1,1)")):
        axes.plot(sign * size, 9 * size**2, color=colours[2], linewidth=3.2, linestyle=line, label=f"b = 9a², {text}")
    axes.plot(0, 0, "o", color=colours[6], markersize=8, label="x⁴: nilpotent isotropy", zorder=4)
    axes.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5), xlabel="a", ylabel="b", title="x⁴ + 6a x²y² + b y⁴")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), fontsize=8)
    return figure
