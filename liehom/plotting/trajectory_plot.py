"""Plots of solutions: curves in the plane or in space for two or three coordinates, else coordinates over time."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liehom.errors import InputError
from liehom.integrators import Solution
from liehom.plotting.canvas import COLOURS, DASHES, GREY, PALE, finished, matplotlib_module, new_figure, style
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AnyAxes: TypeAlias = Any
"""Axes of matplotlib in the plane or in space; those in space have no types."""

MAX_TRAJECTORIES = 50
MAX_LINES = 8
CURVE_POINTS = 400
# |m| counts as constant, and a sphere is drawn, if it varies by at most this fraction
SPHERE_TOLERANCE = 1e-6
ELEVATION, AZIMUTH = 22.0, 35.0
SIDES = np.array([-1.0, 1.0])


def plot_trajectory(solution: Solution, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draw a solution of `integrate`: a trajectory, or the first 50 trajectories of an ensemble.

    Parameters
    ----------
    solution : Solution
        With dense output the curves follow it; without, they connect the steps.
    path : path, optional
        File to write: .png, .pdf, .svg, ....

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, or `solution` is not a Solution.
    FormatError
        If the file cannot be written.

    Notes
    -----
    The number of coordinates decides:

    * two: curves in the plane;
    * three: curves in space, with the sphere if |m| is constant (parts behind the sphere are pale);
    * four to eight: coordinates over time;
    * more: the coordinates of the first trajectory as colours.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8], dense_output=True)
    >>> figure = plot_trajectory(sol, "polhode.png")  # doctest: +SKIP
    """
    if not isinstance(solution, Solution):
        raise InputError(f"expected a solution as liehom.integrate returns it, got {solution!r}")
    t, y, count = _paths(solution)
    size = y.shape[1]
    with style():
        if size == 3:
            figure = _in_space(y)
        elif size == 2:
            figure = _in_the_plane(y)
        elif size <= MAX_LINES:
            figure = _over_time(t, y)
        else:
            figure = _as_colours(t[0], y[0])
        shown = 1 if size > MAX_LINES else len(y)
        radius = _radius(y) if size == 3 else None
        where = "" if radius is None else f", $|m|$ = {radius:.4g}"
        more = f", the first {shown} of {count} trajectories" if shown < count else ""
        figure.axes[0].set_title(f"{solution.report.step}, {_span(t)}{where}{more}", loc="left")
    return finished(figure, path)


def _paths(solution: Solution) -> tuple[Array, Array, int]:
    """Times (k, n) and points (k, N, n) of the trajectories to draw, and the number of all trajectories."""
    y = np.asarray(solution.y, dtype=float)
    t = np.broadcast_to(np.asarray(solution.t, dtype=float), (*y.shape[:-2], y.shape[-1]))
    t, y = t.reshape(-1, t.shape[-1]), y.reshape(-1, *y.shape[-2:])
    count = len(y)
    if solution.sol is not None and y.shape[-1] > 1:
        times = np.linspace(np.nanmin(t), np.nanmax(t), CURVE_POINTS)
        y = np.asarray(solution.sol(times), dtype=float).reshape(count, y.shape[1], CURVE_POINTS)
        low, high = np.nanmin(t, axis=-1)[:, None], np.nanmax(t, axis=-1)[:, None]
        y = np.where(((times >= low) & (times <= high))[:, None, :], y, np.nan)
        t = np.broadcast_to(times, (count, CURVE_POINTS))
        if solution.t[..., 0].flat[0] == np.nanmax(solution.t):  # backwards in time: the initial point comes first
            t, y = t[:, ::-1], y[..., ::-1]
    return t[:MAX_TRAJECTORIES], y[:MAX_TRAJECTORIES], count


def _span(t: Array) -> str:
    first = t[0][np.isfinite(t[0])]
    return f"$t$ = {first[0]:.4g} to {first[-1]:.4g}"


def _look(k: int, count: int) -> dict[str, Any]:
    return {"color": COLOURS[k % len(COLOURS)], "linewidth": 1.5 if count <= 5 else 0.9}


def _ends(points: Array) -> tuple[Array, Array]:
    """First and last finite point of a curve (N, n)."""
    there = np.flatnonzero(np.isfinite(points).all(axis=0))
    return points[:, there[0]], points[:, there[-1]]


def _mark_ends(axes: AnyAxes, y: Array, hidden: Callable[[Array], bool] | None = None) -> None:
    """Mark initial points by a disc and ends by a square, pale if `hidden`, with one legend for all curves."""
    size = 6 if len(y) <= 5 else 3.5
    for k, points in enumerate(y):
        colour = COLOURS[k % len(COLOURS)]
        for marker, point in zip("os", _ends(points), strict=True):
            pale = hidden is not None and hidden(point)
            look = {"color": colour, "markersize": size, "zorder": 1.2 if pale else 5, "alpha": 0.35 if pale else 1}
            axes.plot(*[[x] for x in point], marker, markerfacecolor=colour if marker == "o" else "white", **look)
    for marker, name in zip("os", ("start", "end"), strict=True):
        nowhere = [[np.nan]] * len(y[0])
        fill = COLOURS[0] if marker == "o" else "white"
        axes.plot(*nowhere, marker, color=COLOURS[0], markersize=6, markerfacecolor=fill, label=name)
    axes.legend(loc="upper right")


# -- in space --------------------------------------------------------------------------------------------
def _in_space(y: Array) -> Figure:
    figure = new_figure(5.6, 5.6)
    axes = figure.add_subplot(projection="3d", proj_type="ortho", computed_zorder=False)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    radius = _radius(y)
    if radius is not None:
        _on_the_sphere(axes, y, radius)
        return figure
    for k, points in enumerate(y):
        axes.plot(*points, **_look(k, len(y)))
    _mark_ends(axes, y)
    low, high = np.nanmin(y, axis=(0, 2)), np.nanmax(y, axis=(0, 2))
    middle, half = (low + high) / 2, max(1.05 * float((high - low).max()) / 2, 1e-12)
    for i, axis in enumerate((axes.xaxis, axes.yaxis, axes.zaxis)):
        axis.set_label_text(f"$m_{i}$")
        axis.set_major_locator(matplotlib_module("ticker").MaxNLocator(4))
        axis.set_pane_color("#fafafa")
    axes.set(xlim=middle[0] + half * SIDES, ylim=middle[1] + half * SIDES, zlim=middle[2] + half * SIDES)
    axes.set_box_aspect((1, 1, 1), zoom=0.95)
    return figure


def _on_the_sphere(axes: AnyAxes, y: Array, radius: float) -> None:
    """Draw curves on the sphere, pale if behind it, and the ends of the coordinate axes."""
    draw_sphere(axes, radius)
    for k, points in enumerate(y):
        front = _towards_the_eye() @ points >= 0
        axes.plot(*_only(points, ~front), **_look(k, len(y)), alpha=0.3, zorder=1)
        axes.plot(*_only(points, front), **_look(k, len(y)), zorder=3)
    _mark_ends(axes, y, hidden=lambda point: bool(_towards_the_eye() @ point < 0))
    for i, direction in enumerate(np.eye(3)):
        axes.plot(*np.outer(direction, radius * np.array([1.0, 1.15])), color=GREY, linewidth=1.0, zorder=4)
        axes.text(*(1.23 * radius * direction), f"$m_{i}$", ha="center", va="center", zorder=6)
    axes.set(xlim=radius * SIDES, ylim=radius * SIDES, zlim=radius * SIDES)
    axes.set_axis_off()
    axes.set_box_aspect((1, 1, 1), zoom=1.25)


def _radius(y: Array) -> float | None:
    """Common |m| of all points, or None if |m| varies or is 0."""
    sizes = np.linalg.norm(y, axis=1)
    largest = float(np.nanmax(sizes))
    return largest if largest - float(np.nanmin(sizes)) <= SPHERE_TOLERANCE * largest and largest > 0 else None


def _towards_the_eye() -> Array:
    """Unit vector from the origin to the viewer."""
    up, round_ = np.radians(ELEVATION), np.radians(AZIMUTH)
    return np.array([np.cos(up) * np.cos(round_), np.cos(up) * np.sin(round_), np.sin(up)])


def _only(points: Array, kept: Array) -> Array:
    """Points that are kept, and the point before each part, so that the parts of a curve meet; NaN elsewhere."""
    near = kept | np.r_[kept[1:], False]
    return np.where(near, points, np.nan)


def draw_sphere(axes: AnyAxes, radius: float) -> None:
    """Draw the outline of the sphere, and the visible parts of its circles of latitude and longitude."""
    u, v = np.linspace(0, 2 * np.pi, 145), np.linspace(0, np.pi, 73)
    grid = radius * np.array(
        [np.outer(np.cos(u), np.sin(v)), np.outer(np.sin(u), np.sin(v)), np.outer(0 * u + 1, np.cos(v))]
    )
    for line in (*np.moveaxis(grid[:, :-1:12], 1, 0), *np.moveaxis(grid[:, :, 12:-1:12], 2, 0)):
        axes.plot(*_only(line, _towards_the_eye() @ line >= 0), color=PALE, linewidth=0.7, zorder=0.5)
    across = np.linalg.svd(_towards_the_eye()[None])[2][1:]
    outline = radius * (np.outer(across[0], np.cos(u)) + np.outer(across[1], np.sin(u)))
    axes.plot(*outline, color=GREY, linewidth=0.9, zorder=0.6)


# -- in the plane, over time -----------------------------------------------------------------------------
def _in_the_plane(y: Array) -> Figure:
    figure = new_figure(5.4, 5.0)
    axes = figure.add_subplot()
    for k, points in enumerate(y):
        axes.plot(*points, **_look(k, len(y)))
    _mark_ends(axes, y)
    axes.set_xlabel("$m_0$")
    axes.set_ylabel("$m_1$")
    axes.set_aspect("equal", adjustable="datalim")
    return figure


def _over_time(t: Array, y: Array) -> Figure:
    figure = new_figure(7.0, 4.2)
    axes = figure.add_subplot()
    for k, (times, points) in enumerate(zip(t, y, strict=True)):
        for i, values in enumerate(points):
            label = f"$m_{i}$" if k == 0 else None
            axes.plot(
                times, values, color=COLOURS[i % len(COLOURS)], linestyle=DASHES[i % len(DASHES)],
                linewidth=1.5 if len(y) <= 5 else 0.7, label=label,
            )  # fmt: skip
    axes.set_xlabel("time $t$")
    axes.set_ylabel("coordinates")
    axes.margins(x=0.01)
    figure.legend(loc="outside right upper")
    return figure


def _as_colours(times: Array, points: Array) -> Figure:
    figure = new_figure(7.0, 4.2)
    axes = figure.add_subplot()
    there = np.isfinite(times)
    times, points = times[there], points[:, there]
    most = float(np.abs(points).max(initial=0)) or 1.0
    mesh = axes.pcolormesh(
        times, np.arange(len(points)), points, cmap="RdBu_r", vmin=-most, vmax=most, shading="nearest", rasterized=True
    )
    axes.grid(False)
    axes.set_xlabel("time $t$")
    axes.set_ylabel("index $i$")
    axes.invert_yaxis()
    figure.colorbar(mesh, ax=axes, label="$m_i$", pad=0.02).outline.set_edgecolor(GREY)
    return figure
