"""Plots of solutions: curves in the plane or in space for two or three coordinates, else coordinates over time."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liehom.errors import InputError, displayed
from liehom.integrators import Solution
from liehom.plotting.canvas import (
    DASHES,
    GREY,
    current_colours,
    figure_of,
    finished,
    matplotlib_module,
    new_figure,
    paper_colour,
    style_unless,
)
from liehom.plotting.curves import Curves, constant_norm, curves_of, steps_of
from liehom.plotting.surfaces import AnyAxes, Quadric, Scene, space_axes, sphere
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_LINES = 8


class Layer(NamedTuple):
    """Trajectories at times (k, n), points (k, N, n), drawn by lines "-" or markers "."."""

    t: Array
    y: Array
    mark: str


SHOWN = ("curve", "steps", "both")


def plot_trajectory(
    solution: Solution,
    path: str | os.PathLike[str] | None = None,
    *,
    show: str = "curve",
    coordinates: Sequence[int] | None = None,
    over_time: bool = False,
    ax: Axes | None = None,
) -> Figure:
    """Draw a solution of `integrate`: a trajectory, or the first 50 trajectories of an ensemble.

    Parameters
    ----------
    solution : Solution
    path : path, optional
        File to write: .png, .pdf, .svg, ....
    show : "curve", "steps" or "both"
        A smooth curve, or markers at the steps that were made, or both.
    coordinates : sequence of int, optional
        Indices of the coordinates to draw, two for the plane and three for space; by default all.
    over_time : bool, optional
        Whether to draw coordinates over time in any case.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; by default those of a new figure. Space can be drawn in axes with ``projection="3d"``, and,
        seen from a fixed point, in axes in the plane.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, or an argument is not of this kind.
    FormatError
        If the file cannot be written.

    Notes
    -----
    The number of coordinates decides:

    * two: curves in the plane;
    * three: curves in space, with the sphere if |m| is constant (parts behind the sphere are pale);
    * four to eight: coordinates over time;
    * more: the coordinates of the first trajectory as colours, at the steps.

    Between two steps the curve follows the method: the step is made again with fractions of its size, so that all
    points of the curve are on the orbit. For solutions that do not know their steps (read from a file, with `t_eval`,
    merged from parts), and for more than 400 steps or 50 trajectories, the curve is the cubic spline through the
    steps, projected to the sphere if |m| is constant. At most 20,000 steps are drawn, evenly chosen; the title says so.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8])
    >>> figure = plot_trajectory(sol, "polhode.png")  # doctest: +SKIP
    """
    steps = steps_of(solution)
    if show not in SHOWN:
        raise InputError(f"show is {displayed(show)}, expected one of {', '.join(map(repr, SHOWN))}")
    chosen = _chosen(coordinates, steps.y.shape[1])
    coloured = len(chosen) > MAX_LINES
    curves = steps if show == "steps" or (coloured and solution.sol is None) else curves_of(solution)
    layers = [Layer(curves.t, curves.y[:, chosen], "-")] if show != "steps" else []
    layers += [Layer(steps.t, steps.y[:, chosen], ".")] if show != "curve" else []
    names = [f"$m_{i}$" if i < 10 else f"$m_{{{i}}}$" for i in chosen]
    with style_unless(ax):
        radius = None
        if len(chosen) == 3 and not over_time:
            ax, radius = _in_space(layers, names, ax)
        elif len(chosen) == 2 and not over_time:
            ax = _in_the_plane(layers, names, ax)
        elif not coloured:
            ax = _over_time(layers, names, ax)
        else:
            ax = _as_colours(layers[0], ax)
        _entitle(ax, solution, steps, radius, 1 if coloured else len(steps.y))
        figure = figure_of(ax)
    return finished(figure, path)


def _chosen(coordinates: Sequence[int] | None, size: int) -> list[int]:
    """The indices of the coordinates to draw, checked."""
    chosen = list(range(size)) if coordinates is None else list(coordinates)
    if not chosen or any(isinstance(i, bool) or not isinstance(i, int) or not 0 <= i < size for i in chosen):
        raise InputError(f"coordinates are indices from 0 to {size - 1}, got {displayed(coordinates)}")
    return chosen


def _entitle(ax: Axes, solution: Solution, steps: Curves, radius: float | None, shown: int) -> None:
    first = steps.t[0][np.isfinite(steps.t[0])]
    title = f"{solution.report.step}, $t$ = {first[0]:.4g} to {first[-1]:.4g}"
    title += "" if radius is None else f", $|m|$ = {radius:.4g}"
    title += f", the first {shown} of {steps.total} trajectories" if shown < steps.total else ""
    title += f", one of {steps.every} steps" if steps.every > 1 else ""
    ax.set_title(title, loc="left")


def look(k: int, count: int) -> dict[str, Any]:
    """Colour and width of curve number k of `count` curves."""
    colours = current_colours()
    return {"color": colours[k % len(colours)], "linewidth": 1.5 if count <= 5 else 0.9}


def _ends(points: Array) -> tuple[Array, Array]:
    """First and last finite point of a curve (N, n)."""
    there = np.flatnonzero(np.isfinite(points).all(axis=0))
    return points[:, there[0]], points[:, there[-1]]


def mark_ends(scene: Scene, y: Array, surface: Quadric | None = None) -> None:
    """Mark initial points by a disc and ends by a square, pale if hidden, with one legend for all curves."""
    colours = current_colours()
    size = 6 if len(y) <= 5 else 3.5
    for k, points in enumerate(y):
        colour = colours[k % len(colours)]
        for marker, point in zip("os", _ends(points), strict=True):
            fill = {"color": colour, "markersize": size, "markerfacecolor": colour if marker == "o" else paper_colour()}
            scene.mark(surface, point, marker, **fill)
    for marker, name in zip("os", ("start", "end"), strict=True):
        fill = {"color": colours[0], "markersize": 6, "label": name}
        fill["markerfacecolor"] = colours[0] if marker == "o" else paper_colour()
        scene.plot(np.full((len(y[0]), 1), np.nan), marker, **fill)
    scene.axes.legend(loc="upper right")


# -- in space --------------------------------------------------------------------------------------------
def _in_space(layers: Sequence[Layer], names: Sequence[str], ax: Axes | None) -> tuple[Axes, float | None]:
    y = layers[0].y
    radius = constant_norm(y)
    scene = Scene(space_axes(ax))
    surface = None
    if radius is None:
        _box(scene, y, names)
    else:
        surface = sphere(radius)
        surface.draw(scene)
        scene.frame(radius, names)
        scene.limit(radius)
    draw_layers(scene, layers, surface)
    return scene.axes, radius


def draw_layers(scene: Scene, layers: Sequence[Layer], surface: Quadric | None = None) -> None:
    """Draw trajectories and mark their ends."""
    for layer in layers:
        for k, points in enumerate(layer.y):
            scene.curve(surface, points, layer.mark, **look(k, len(layer.y)))
    mark_ends(scene, layers[0].y, surface)


def _box(scene: Scene, y: Array, names: Sequence[str]) -> None:
    """Coordinate axes along the edges of a box that contains points (k, 3, n)."""
    low, high = np.nanmin(y, axis=(0, 2)), np.nanmax(y, axis=(0, 2))
    middle, half = (low + high) / 2, max(1.05 * float((high - low).max()) / 2, 1e-12)
    scene.limit(half, middle)
    if not scene.solid:
        return
    axes = scene.axes
    axes.set_axis_on()
    axes.set_box_aspect((1, 1, 1), zoom=0.95)
    for name, axis in zip(names, (axes.xaxis, axes.yaxis, axes.zaxis), strict=True):
        axis.set_label_text(name)
        axis.set_major_locator(matplotlib_module("ticker").MaxNLocator(4))
        axis.set_pane_color((0.5, 0.5, 0.5, 0.05))


# -- in the plane, over time -----------------------------------------------------------------------------
def _in_the_plane(layers: Sequence[Layer], names: Sequence[str], ax: Axes | None) -> AnyAxes:
    axes: AnyAxes = new_figure(5.4, 5.0).add_subplot() if ax is None else ax
    draw_layers(Scene(axes), layers)
    axes.set(xlabel=names[0], ylabel=names[1])
    axes.set_aspect("equal", adjustable="datalim")
    return axes


def _over_time(layers: Sequence[Layer], names: Sequence[str], ax: Axes | None) -> AnyAxes:
    axes: AnyAxes = new_figure(7.0, 4.2).add_subplot() if ax is None else ax
    colours = current_colours()
    for layer in layers:
        for k, (times, points) in enumerate(zip(layer.t, layer.y, strict=True)):
            for i, (name, values) in enumerate(zip(names, points, strict=True)):
                dashes = DASHES[i % len(DASHES)] if layer.mark == "-" else layer.mark
                axes.plot(
                    times, values, dashes, color=colours[i % len(colours)], markersize=4,
                    linewidth=1.5 if len(layer.y) <= 5 else 0.7, label=name if k == 0 and layer is layers[0] else None,
                )  # fmt: skip
    axes.set(xlabel="time $t$", ylabel="coordinates")
    axes.margins(x=0.01)
    if ax is None:
        axes.figure.legend(loc="outside right upper")
    else:
        axes.legend()
    return axes


def _as_colours(layer: Layer, ax: Axes | None) -> AnyAxes:
    axes: AnyAxes = new_figure(7.0, 4.2).add_subplot() if ax is None else ax
    there = np.isfinite(layer.t[0])
    times, points = layer.t[0][there], layer.y[0][:, there]
    most = float(np.abs(points).max(initial=0)) or 1.0
    mesh = axes.pcolormesh(
        times, np.arange(len(points)), points, cmap="RdBu_r", vmin=-most, vmax=most, shading="nearest", rasterized=True
    )
    axes.grid(False)
    axes.set(xlabel="time $t$", ylabel="index $i$")
    axes.invert_yaxis()
    axes.figure.colorbar(mesh, ax=axes, label="$m_i$", pad=0.02).outline.set_edgecolor(GREY)
    return axes
