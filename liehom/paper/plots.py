"""Plots of Figures 1, 3 to 5 and 7, from tables of the same content."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liehom.paper.tables import Table, symbol
from liehom.plotting.canvas import MARKERS, current_colours, matplotlib_module, new_figure, paper_colour
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ELEVATION, AZIMUTH = np.radians(24.0), np.radians(35.0)
FLOOR, CEILING = 3e-17, 10.0
"""Errors at the lower and upper end of the axes of Figures 3 to 5; a zero of the paper is drawn at the lower end."""


class Look(NamedTuple):
    """Marker and label of a number of the paper in a panel."""

    marker: str
    label: str


IN_RANGE, OUTSIDE, ZERO = Look("D", "paper, in the range"), Look("x", "paper, outside"), Look("v", "paper: 0")


# -- Figure 1 --------------------------------------------------------------------------------------------
def draw_spheres(curves: Mapping[tuple[str, str], Array]) -> Figure:
    """Plot of trajectories on spheres, with a row for each body and a column for each update.

    Parts of a trajectory behind the sphere are pale.

    Parameters
    ----------
    curves : dict of (body, update) to arrays of shape (steps, 3, N)

    Returns
    -------
    matplotlib.figure.Figure
    """
    bodies, names = (list(dict.fromkeys(key[i] for key in curves)) for i in (0, 1))
    figure = new_figure(3.0 * len(names), 2.95 * len(bodies))
    panels = figure.subplots(len(bodies), len(names), squeeze=False)
    for i, body in enumerate(bodies):
        for j, name in enumerate(names):
            _draw_sphere(panels[i, j], curves[body, name])
            if i == 0:
                panels[i, j].set_title(symbol(name), loc="center", fontsize=13)
        panels[i, 0].text(-1.32, 0, body, rotation=90, ha="center", va="center", fontsize=11)
    return figure


def _view() -> Array:
    """Unit vectors to the right, up and towards the viewer, as rows."""
    eye = np.array([np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)])
    right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
    return np.stack([right, np.cross(eye, right), eye])


def _draw_sphere(axes: Axes, points: Array) -> None:
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set(xlim=(-1.4, 1.25), ylim=(-1.2, 1.3))
    turn, edge, colours = np.linspace(0, 2 * np.pi, 200), _edge_colour(), current_colours()
    axes.fill(np.cos(turn), np.sin(turn), facecolor=edge, alpha=0.05, zorder=0)
    axes.plot(np.cos(turn), np.sin(turn), color=edge, linewidth=0.8, zorder=0.5)
    for k in range(points.shape[2]):
        x, y, depth = _view() @ points[:, :, k].T
        for front in (False, True):
            shown = (depth >= 0) == front
            near = shown | np.r_[shown[1:], False] | np.r_[False, shown[:-1]]
            width, alpha, zorder = (0.8, 1.0, 3) if front else (0.5, 0.3, 1)
            line = np.where(near, x, np.nan), np.where(near, y, np.nan)
            axes.plot(*line, color=colours[k], linewidth=width, alpha=alpha, zorder=zorder)
        pale = depth[0] < 0
        fill: dict[str, Any] = {
            "markerfacecolor": colours[k],
            "markeredgecolor": paper_colour(),
            "alpha": 0.4 if pale else 1.0,
        }
        axes.plot(x[:1], y[:1], "o", markersize=5.5, zorder=1.5 if pale else 5, **fill)
    for k, direction in enumerate(np.eye(3)):
        x, y, _ = _view() @ direction
        axes.plot([x, 1.12 * x], [y, 1.12 * y], color=edge, linewidth=0.9, zorder=4)
        axes.text(1.22 * x, 1.22 * y, f"$m_{k + 1}$", ha="center", va="center", fontsize=9, color=edge)


# -- Figures 3 to 5 --------------------------------------------------------------------------------------
def draw_errors(errors: Table, slopes: Table, printed: Table | None = None, columns: int | None = None) -> Figure:
    """Plot of a table of errors: a panel for each body and update, with errors over the step size.

    Parameters
    ----------
    errors : Table
        Columns body, dt, update, average error, low, high, paper, paper in range.
    slopes : Table
        Columns body, update, slope, slope in the paper.
    printed : Table, optional
        Errors of formulas as the paper prints them: columns body, dt, update, average error.
    columns : int, optional
        Panels in a row (default: as in the paper, the updates; or all of them if there are three).

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows, misprints = _records(errors), _records(printed)
    measured = {(row["body"], row["update"]): row for row in _records(slopes)}
    panels = list(dict.fromkeys((row["body"], row["update"]) for row in rows))
    updates = list(dict.fromkeys(name for _, name in panels))
    width = columns or (len(panels) if len(updates) == 3 else len(updates))
    height = -(-len(panels) // width)
    figure = new_figure(0.6 + 1.55 * width, 1.0 + 1.75 * height)
    grid = figure.subplots(height, width, sharex=True, sharey=True, squeeze=False)
    for axes, panel in zip(grid.flat, panels, strict=True):
        mine, other = ([row for row in some if (row["body"], row["update"]) == panel] for some in (rows, misprints))
        _draw_panel(axes, current_colours()[updates.index(panel[1])], mine, other)
        axes.set_title(symbol(panel[1]), fontsize=11)
        axes.set_title(panel[0], loc="right", fontsize=8, color=_edge_colour())
        text = f"slope {measured[panel]['slope']:.2f}\npaper {measured[panel]['slope in the paper']:.2f}"
        if measured[panel]["slope"] == measured[panel]["slope"]:
            axes.text(0.96, 0.04, text, transform=axes.transAxes, ha="right", va="bottom", fontsize=8)
    for axes in grid[-1]:
        axes.set_xlabel("step size", fontsize=9)
    for axes in grid[:, 0]:
        axes.set_ylabel("energy error", fontsize=9)
    _explain(figure, rows, bool(misprints), 5 if width > 4 else min(3, width))
    return figure


def _records(table: Table | None) -> list[dict[str, Any]]:
    return [] if table is None else [dict(zip(table.columns, row, strict=True)) for row in table.rows]


def _draw_panel(
    axes: Axes, colour: str, rows: Sequence[Mapping[str, Any]], printed: Sequence[Mapping[str, Any]]
) -> None:
    dts = [row["dt"] for row in rows]
    low, middle, high = ([max(row[key], FLOOR) for row in rows] for key in ("low", "average error", "high"))
    axes.fill_between(dts, low, high, color=colour, alpha=0.25, linewidth=0)
    axes.plot(dts, middle, "o-", color=colour, markersize=4)
    if printed:
        errors = [row["average error"] for row in printed]
        axes.plot([row["dt"] for row in printed], errors, "--", color=_edge_colour(), linewidth=1.2)
    for row in rows:
        _mark(axes, row["dt"], max(row["paper"], FLOOR), _look(row))
    axes.set(xscale="log", yscale="log", xlim=(4e-3, 25), ylim=(FLOOR / 3, CEILING))
    axes.set_xticks([0.01, 0.1, 1, 10], [".01", ".1", "1", "10"])
    axes.set_yticks([1e-15, 1e-10, 1e-5, 1])
    axes.minorticks_off()
    axes.tick_params(labelsize=8)


def _look(row: Mapping[str, Any]) -> Look:
    return ZERO if row["paper"] == 0 else IN_RANGE if row["paper in range"] == "yes" else OUTSIDE


def _mark(axes: Axes, x: float, y: float, look: Look, label: str | None = None) -> None:
    ink = matplotlib_module("").rcParams["text.color"]
    axes.plot(
        [x], [y], look.marker, color=ink, markersize=6, markerfacecolor="none", markeredgewidth=1.3, zorder=4,
        linestyle="none", label=label,
    )  # fmt: skip


def _explain(figure: Figure, rows: Sequence[Mapping[str, Any]], misprints: bool, columns: int) -> None:
    """Legend above the panels, of what they have."""
    axes, edge = figure.axes[0], _edge_colour()
    nowhere = [np.nan]
    axes.plot(nowhere, nowhere, "o-", color=edge, markersize=4, label="median")
    axes.fill_between(nowhere, nowhere, nowhere, color=edge, alpha=0.3, linewidth=0, label="5 % to 95 %")
    for look in dict.fromkeys(map(_look, rows)):
        _mark(axes, np.nan, np.nan, look, look.label)
    if misprints:
        axes.plot(nowhere, nowhere, "--", color=edge, linewidth=1.2, label="formula as printed")
    figure.legend(loc="outside upper left", ncols=columns, fontsize=8)


# -- Figure 7 --------------------------------------------------------------------------------------------
def draw_costs(points: Table, fits: Table, panels: Sequence[tuple[str, Sequence[str]]]) -> Figure:
    """Plot of cost over accuracy, as natural logarithms, with affine fits (the paper's are dashed).

    Parameters
    ----------
    points : Table
        Columns update, -ln error, ln cost.
    fits : Table
        Columns update, a, b, a paper, b paper.
    panels : sequence of (str, sequence of str)
        Title and updates of each panel.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = new_figure(8.0, 6.6)
    lines = {row["update"]: row for row in _records(fits)}
    for axes, (title, names) in zip(figure.subplots(2, 2, squeeze=False).flat, panels, strict=True):
        for k, name in enumerate(names):
            mine = [row for row in _records(points) if row["update"] == name]
            _draw_cost(axes, k, [row["-ln error"] for row in mine], [row["ln cost"] for row in mine], lines[name])
        axes.set_title(title)
        axes.set_xlabel("$-\\ln$ (average energy error)")
        axes.set_ylabel("$\\ln$ (cost / cost of an Euler step)")
        axes.legend(loc="lower right")
    return figure


def _draw_cost(axes: Axes, k: int, x: Sequence[float], y: Sequence[float], fit: Mapping[str, Any]) -> None:
    colour = current_colours()[k]
    ends = np.array([min(x), max(x)])
    axes.plot(ends, fit["a"] * ends + fit["b"], color=colour, linewidth=1.2, zorder=2)
    paper = fit["a paper"] * ends + fit["b paper"]
    axes.plot(ends, paper, color=colour, linewidth=1.0, linestyle="--", alpha=0.75, zorder=2)
    text = f"{symbol(fit['update'])}: {fit['a']:.2f}, paper {fit['a paper']:.2f}"
    axes.plot(x, y, MARKERS[k], color=colour, markersize=6, zorder=3, label=text, markeredgecolor=paper_colour())


def _edge_colour() -> str:
    colour: str = matplotlib_module("").rcParams["axes.edgecolor"]
    return colour
