"""Pictures of invariant geometry: curvature of Berger spheres, and scalar curvature on a flag manifold."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm

import liehom as lh
from liehom.plotting.canvas import GREY, new_figure
from pictures import picture


@picture
def berger_spheres(colours: Sequence[str]) -> Any:
    """The fibre of S^3 over S^2, and of S^5 over CP^2, has length 2 pi sqrt(s)."""
    figure = new_figure(8.4, 4.0)
    values = np.linspace(0.02, 2, 34)
    rng = random.Random(4)
    for axes, n in zip(figure.subplots(1, 2, sharey=True), (1, 2), strict=True):
        metrics = lh.pair(f"su({n + 1})/{f'su({n})' if n > 1 else 0}").invariant_metrics()
        fibre, round_metric = round_sphere(metrics, n)
        for s in values:
            text = lh.QQ.convert(f"{round(100 * s)}/100")
            metric = metrics(metrics.coordinates(round_metric + fibre * (text - 1)))
            d = 2 * n + 1
            planes = [[[rng.randint(-3, 3) for _ in range(d)] for _ in range(2)] for _ in range(14)]
            dots = [float(metric.sectional(x, y)) for x, y in planes if np.linalg.matrix_rank([x, y]) == 2]
            axes.plot([float(text)] * len(dots), dots, ".", color=GREY, markersize=2.5, zorder=1)
        axes.plot(values, values, color=colours[0], label="planes with the fibre: s")
        axes.plot(values, 4 - 3 * values, color=colours[1], label="complex horizontal planes: 4 - 3s")
        if n > 1:
            axes.axhline(1, color=colours[2], label="totally real horizontal planes: 1")
        axes.plot(1, 1, "o", color=colours[3], markersize=7, zorder=4, label="round sphere")
        axes.axhline(0, color=GREY, linewidth=0.6, zorder=0)
        axes.set(xlabel="s = |fibre|²", title=f"S{'³⁵'[n - 1]}", xlim=(0, 2), ylim=(-2.2, 4.2))
        axes.legend(loc="lower left", fontsize=7)
    figure.axes[0].set_ylabel("sectional curvature")
    return figure


def round_sphere(metrics: Any, n: int) -> tuple[Any, Any]:
    """The form of the fibre and the round metric of radius 1 on S^(2n+1), from the matrices of su(n+1)."""
    point = np.zeros(2 * n + 2, dtype=int)
    point[-2] = 1
    rho = lh.defining(metrics.pair.algebra)
    moved = np.array([np.asarray(rho(m)) @ point for m in metrics.pair.reductive_complement().rows()])
    turned = np.zeros(2 * n + 2, dtype=int)
    turned[-1] = 1
    along = moved @ turned
    return np.outer(along, along), moved @ moved.T


@picture
def scalar_curvature_of_flags(colours: Sequence[str]) -> Any:
    """Metrics x1 : x2 : x3 of SU(3)/T^2 as points of a triangle, normalized to volume 1."""
    figure = new_figure(5.6, 4.8)
    axes = figure.add_subplot()
    metrics = lh.pair("SU(3)/T^2").invariant_metrics()
    scalar = metrics.generic().scalar()
    corners = np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]])
    grid = [(i, j, 100 - i - j) for i in range(1, 100) for j in range(1, 100 - i)]
    x = np.array(grid) / 100
    level = curvature(scalar, x) * np.prod(x, axis=1) ** (1 / 3)
    u, v = (x @ corners).T
    levels = [-10, 10, 20, 25, 28, 29, 29.6, 29.9, 30.05, 30.15, 30.238, 30.4, 30.7, 31.2, 32, 34, 38]
    norm = BoundaryNorm(levels, 256, extend="both")
    shown = axes.tricontourf(u, v, level, levels=levels, cmap="viridis", norm=norm, extend="both", alpha=0.9)
    axes.tricontour(u, v, level, levels=levels, colors=[GREY], linewidths=0.4)
    figure.colorbar(shown, ax=axes, shrink=0.8, label="scalar curvature for volume 1", ticks=levels[::2])
    labels = {0: "minus the Killing form: a minimum, 30", 1: "three Kähler–Einstein metrics: saddles, 24 · 2^(1/3)"}
    for metric in metrics.einstein():
        y = np.array([float(p) for p in metric.parameters])
        place = (y / y.sum()) @ corners
        kaehler = metric.metric.kaehler_form() is not None
        axes.plot(*place, "s" if kaehler else "o", color=colours[1] if kaehler else colours[3], markersize=7,
                  markeredgecolor="white", label=labels.pop(int(kaehler), None))  # fmt: skip
    for corner, name, shift in zip(
        corners, ("x₁", "x₂", "x₃"), ((-0.04, -0.05), (0.04, -0.05), (0, 0.03)), strict=True
    ):
        axes.text(*(corner + shift), name, ha="center", va="center")
    axes.plot(*corners[[0, 1, 2, 0]].T, color=GREY, linewidth=1)
    axes.set(aspect="equal", xlim=(-0.1, 1.1), ylim=(-0.12, 0.95))
    axes.set_axis_off()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), fontsize=8, frameon=False)
    return figure


def curvature(scalar: Any, x: Any) -> Any:
    """A rational function of three parameters at the rows of an array."""
    top = sum(float(c) * np.prod(x ** np.array(list(map(int, e))), axis=1) for e, c in scalar.numerator.terms())
    for i, power in scalar.powers:
        top = (
            top
            / sum(
                float(c) * np.prod(x ** np.array(list(map(int, e))), axis=1) for e, c in scalar.field.atoms[i].terms()
            )
            ** power
        )
    return top
