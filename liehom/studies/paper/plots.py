"""Plots of Figures 1, 3 to 5 and 7 and of the separatrix experiment, most of them from tables of the same content."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liehom.base.typing import Array
from liehom.plotting.canvas import MARKERS, current_colours, matplotlib_module, new_figure, paper_colour
from liehom.plotting.phase_plot import Scene, plot_phase_portrait, space_axes, sphere
from liehom.studies.paper.table import Table, symbol

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Errors at the lower and upper end of the axes of Figures 3 to 5; a zero of the paper is drawn at the lower end
FLOOR, CEILING = 3e-17, 10.0


class Look(NamedTuple):
    """Marker and label of a number of the paper in a panel."""

    marker: str
    label: str


IN_RANGE, OUTSIDE, ZERO = Look("D", "paper, in the range"), Look("x", "paper, outside"), Look("v", "paper: 0")


# -- Figure 1 --------------------------------------------------------------------------------------------
def draw_spheres(curves: Mapping[tuple[str, str], Array]) -> Figure:
    """Trajectories on spheres, faint behind them: a row for each body, a column for each update."""
    bodies, names = (list(dict.fromkeys(key[i] for key in curves)) for i in (0, 1))
    figure = new_figure(3.0 * len(names), 2.95 * len(bodies))
    panels = figure.subplots(len(bodies), len(names), squeeze=False)
    for i, body in enumerate(bodies):
        for j, name in enumerate(names):
            _draw_sphere(panels[i, j], curves[body, name])
            if i == 0:
                panels[i, j].set_title(symbol(name), loc="center", fontsize=13, y=1.0)
        panels[i, 0].text(
            -0.02, 0.5, body, transform=panels[i, 0].transAxes, rotation=90, ha="center", va="center", fontsize=11
        )
    return figure


def _draw_sphere(axes: Axes, points: Array) -> None:
    scene, surface = Scene(space_axes(axes)), sphere(1.0)
    surface.draw(scene)
    for colour, curve in zip(current_colours(), np.moveaxis(points, 2, 0), strict=False):
        scene.curve(surface, curve.T, color=colour, linewidth=0.8)
        scene.mark(surface, curve[0], "o", color=colour, markersize=5, markeredgecolor=paper_colour())
    scene.frame(1.0, ("$m_1$", "$m_2$", "$m_3$"))
    scene.limit(1.0)


def draw_separatrices(moments: Array, curves: Mapping[str, Array]) -> Figure:
    """Plot of trajectories of a triaxial body on its phase portrait, with a panel for each update."""
    figure = new_figure(3.0 * len(curves), 3.2)
    for axes, (name, curve) in zip(figure.subplots(1, len(curves), squeeze=False).flat, curves.items(), strict=True):
        plot_phase_portrait(lambda m: (m * m / (2 * moments)).sum(axis=-1), axes, levels=1)
        axes.get_legend().remove()
        scene, surface = Scene(axes), sphere(1.0)
        scene.curve(surface, curve.T, color=current_colours()[-1], linewidth=0.7, zorder=6)
        scene.mark(surface, curve[0], "o", color=current_colours()[-1], markersize=5, markeredgecolor=paper_colour())
        axes.set_title(symbol(name), loc="center", fontsize=13, y=1.0)
    return figure


# -- Figures 3 to 5 --------------------------------------------------------------------------------------
def draw_errors(errors: Table, slopes: Table, printed: Table | None = None, columns: int | None = None) -> Figure:
    """Plot of a table of errors: a panel for each body and update, with errors over the step size."""
    rows, misprints = _records(errors), _records(printed)
    measured = {(row["body"], row["update"]): row for row in _records(slopes)}
    panels = list(dict.fromkeys((row["body"], row["update"]) for row in rows))
    updates = list(dict.fromkeys(name for _, name in panels))
    width = columns or (len(panels) if len(updates) == 3 else len(updates))
    height = -(-len(panels) // width)
    figure = new_figure(0.6 + 1.55 * width, 1.0 + 1.75 * height)
    grid = figure.subplots(height, width, sharex=True, sharey=True, squeeze=False)
    grid[0, 0].set(xscale="log", yscale="log", xlim=(4e-3, 25), ylim=(FLOOR / 3, CEILING))
    grid[0, 0].set_xticks([0.01, 0.1, 1, 10], [".01", ".1", "1", "10"])
    grid[0, 0].set_yticks([1e-15, 1e-10, 1e-5, 1], ["1e-15", "1e-10", "1e-5", "1"])
    for axes, panel in zip(grid.flat, panels, strict=True):
        mine, other = ([row for row in some if (row["body"], row["update"]) == panel] for some in (rows, misprints))
        _draw_panel(axes, current_colours()[updates.index(panel[1])], mine, other)
        axes.minorticks_off()
        axes.tick_params(labelsize=8)
        axes.set_title(symbol(panel[1]), fontsize=11, y=1.0)  # a given height saves half the time of the plot
        axes.set_title(panel[0], loc="right", fontsize=8, color=_edge_colour(), y=1.0)
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
    for look in dict.fromkeys(map(_look, rows)):
        chosen = [row for row in rows if _look(row) == look]
        _mark(axes, [row["dt"] for row in chosen], [max(row["paper"], FLOOR) for row in chosen], look)


def _look(row: Mapping[str, Any]) -> Look:
    return ZERO if row["paper"] == 0 else IN_RANGE if row["paper in range"] == "yes" else OUTSIDE


def _mark(axes: Axes, x: Sequence[float], y: Sequence[float], look: Look, label: str | None = None) -> None:
    ink = matplotlib_module("").rcParams["text.color"]
    axes.plot(
        x, y, look.marker, color=ink, markersize=6, markerfacecolor="none", markeredgewidth=1.3, zorder=4,
        linestyle="none", label=label,
    )  # fmt: skip


def _explain(figure: Figure, rows: Sequence[Mapping[str, Any]], misprints: bool, columns: int) -> None:
    """Legend above the panels, of what they have."""
    axes, edge = figure.axes[0], _edge_colour()
    nowhere = [np.nan]
    axes.plot(nowhere, nowhere, "o-", color=edge, markersize=4, label="median")
    axes.fill_between(nowhere, nowhere, nowhere, color=edge, alpha=0.3, linewidth=0, label="5 % to 95 %")
    for look in dict.fromkeys(map(_look, rows)):
        _mark(axes, nowhere, nowhere, look, look.label)
    if misprints:
        axes.plot(nowhere, nowhere, "--", color=edge, linewidth=1.2, label="formula as printed")
    figure.legend(loc="outside upper left", ncols=columns, fontsize=8)


# -- Figure 7 --------------------------------------------------------------------------------------------
def draw_costs(points: Table, fits: Table, panels: Sequence[tuple[str, Sequence[str]]]) -> Figure:
    """Plot of cost over accuracy, as natural logarithms, with affine fits (the paper's are dashed)."""
    figure = new_figure(8.0, 6.6)
    lines = {row["update"]: row for row in _records(fits)}
    for axes, (title, names) in zip(figure.subplots(2, 2, squeeze=False).flat, panels, strict=True):
        for k, name in enumerate(names):
            mine = [row for row in _records(points) if row["update"] == name]
            _draw_cost(axes, k, [row["-ln error"] for row in mine], [row["ln cost"] for row in mine], lines[name])
        axes.set_title(title, y=1.0)
        axes.set(xlabel="$-\\ln$ (average energy error)", ylabel="$\\ln$ (cost / cost of an Euler step)")
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
    return matplotlib_module("").rcParams["axes.edgecolor"]
