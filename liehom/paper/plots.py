"""Plots of Figures 1 and 7."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from liehom.plotting.canvas import COLOURS, GREY, MARKERS, PALE, finished, new_figure, style
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Path: TypeAlias = str | os.PathLike[str] | None

ELEVATION, AZIMUTH = np.radians(24.0), np.radians(35.0)


class Curve(NamedTuple):
    """Points (-ln error, ln cost) of an update, its affine fit and the paper's, as (a, b) of a x + b."""

    name: str
    x: Array
    y: Array
    fit: tuple[float, float]
    paper: tuple[float, float]


def label(name: str) -> str:
    """Symbol of an update in the paper, as mathtext.

    Examples
    --------
    >>> label("rk2_ib")
    '$\\\\xi_{ib}^{\\\\mathrm{RK2}}$'
    """
    scheme, variant = name.split("_")
    upper = {"eul": "Eul", "rk2": "RK2", "sy4": "sy4", "rk4": "RK4"}[scheme]
    return rf"$\xi_{{{variant}}}^{{\mathrm{{{upper}}}}}$"


def draw_spheres(curves: Mapping[tuple[str, str], Array], path: Path = None) -> Figure:
    """Plot of trajectories on spheres, with a row for each body and a column for each update.

    Parts of a trajectory behind the sphere are pale.

    Parameters
    ----------
    curves : dict of (body, update) to arrays of shape (steps, 3, N)
    path : path, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    bodies, names = (list(dict.fromkeys(key[i] for key in curves)) for i in (0, 1))
    with style():
        figure = new_figure(3.0 * len(names), 2.95 * len(bodies))
        panels = figure.subplots(len(bodies), len(names), squeeze=False)
        for i, body in enumerate(bodies):
            for j, name in enumerate(names):
                _draw_sphere(panels[i, j], curves[body, name])
                if i == 0:
                    panels[i, j].set_title(label(name), loc="center", fontsize=13)
            panels[i, 0].text(-1.32, 0, body, rotation=90, ha="center", va="center", fontsize=11)
    return finished(figure, path)


def _view() -> Array:
    """Unit vectors to the right, up and towards the viewer, as rows."""
    eye = np.array([np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)])
    right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
    return np.stack([right, np.cross(eye, right), eye])


def _draw_sphere(axes: Axes, points: Array) -> None:
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set(xlim=(-1.4, 1.25), ylim=(-1.2, 1.3))
    turn = np.linspace(0, 2 * np.pi, 200)
    axes.fill(np.cos(turn), np.sin(turn), facecolor="#fafafa", edgecolor=GREY, linewidth=0.8, zorder=0)
    for k in range(points.shape[2]):
        x, y, depth = _view() @ points[:, :, k].T
        for front in (False, True):
            shown = (depth >= 0) == front
            near = shown | np.r_[shown[1:], False] | np.r_[False, shown[:-1]]
            width, alpha, zorder = (0.8, 1.0, 3) if front else (0.5, 0.22, 1)
            line = np.where(near, x, np.nan), np.where(near, y, np.nan)
            axes.plot(*line, color=COLOURS[k], linewidth=width, alpha=alpha, zorder=zorder)
        pale = depth[0] < 0
        fill: dict[str, Any] = {
            "markerfacecolor": COLOURS[k],
            "markeredgecolor": "white",
            "alpha": 0.4 if pale else 1.0,
        }
        axes.plot(x[:1], y[:1], "o", markersize=5.5, zorder=1.5 if pale else 5, **fill)
    for k, direction in enumerate(np.eye(3)):
        x, y, _ = _view() @ direction
        axes.plot([x, 1.12 * x], [y, 1.12 * y], color=GREY, linewidth=0.9, zorder=4)
        axes.text(1.22 * x, 1.22 * y, f"$m_{k + 1}$", ha="center", va="center", fontsize=9, color=GREY)


def draw_costs(panels: Sequence[tuple[str, Sequence[Curve]]], path: Path = None) -> Figure:
    """Plot of Figure 7: cost over accuracy, as natural logarithms, with affine fits (the paper's are dashed).

    Returns
    -------
    matplotlib.figure.Figure
    """
    colours: dict[str, int] = {}
    for _, curves in panels[:-1]:
        colours.update({curve.name: k for k, curve in enumerate(curves)})
    with style():
        figure = new_figure(9.0, 7.4)
        grid = figure.subplots(2, 2, squeeze=False)
        for number, (axes, (title, curves)) in enumerate(zip(grid.flat, panels, strict=True)):
            for k, curve in enumerate(curves):
                _draw_cost(axes, curve, k if number == len(panels) - 1 else colours[curve.name])
            axes.set_title(title)
            axes.set_xlabel("$-\\ln$ (average energy error)")
            axes.set_ylabel("$\\ln$ (cost / cost of an Euler step)")
            axes.legend(loc="lower right")
    return finished(figure, path)


def _draw_cost(axes: Axes, curve: Curve, k: int) -> None:
    colour = COLOURS[k % len(COLOURS)]
    ends = np.array([curve.x.min(), curve.x.max()])
    axes.plot(ends, np.polyval(curve.fit, ends), color=colour, linewidth=1.2, zorder=2)
    axes.plot(ends, np.polyval(curve.paper, ends), color=colour, linewidth=1.0, linestyle="--", alpha=0.75, zorder=2)
    text = f"{label(curve.name)}: {curve.fit[0]:.2f}, paper {curve.paper[0]:.2f}"
    axes.plot(curve.x, curve.y, MARKERS[k], color=colour, markersize=6, zorder=3, label=text, markeredgecolor="white")
    axes.grid(color=PALE, linewidth=0.5)
