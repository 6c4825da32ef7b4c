"""Plots of solutions as curves, coordinates and animations."""

from __future__ import annotations

import contextlib
import html
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from liehom.base.disk import check_target, write_file
from liehom.base.errors import ConvergenceError, FormatError, InputError, displayed
from liehom.base.typing import Array
from liehom.exact.representations.core.representation import Representation
from liehom.flow.run.options import Progress
from liehom.flow.run.solution import DenseSolution, Solution, interpolant
from liehom.plotting.canvas import (
    DASHES,
    GREY,
    current_colours,
    figure_of,
    finished,
    matplotlib_module,
    paper_colour,
    plane_axes,
    style_unless,
    written,
)
from liehom.plotting.phase_plot import FAINT, AnyAxes, Quadric, Scene, only, space_axes, sphere

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Points of solutions as curves: smooth between the steps, with a limit for the number of points.

MAX_TRAJECTORIES = 50
CURVE_POINTS = 400  # Number of points of a curve, unless there are more steps
MAX_STEPS_MADE = 400  # Steps are made again for trajectories with at most this number of them
MAX_POINTS = 20_000  # Of a trajectory with more steps, only some are drawn
SPHERE_TOLERANCE = 1e-6  # |m| counts as constant if it varies by at most this fraction


class Curves(NamedTuple):
    """Trajectories to draw, with t (k, n) and y (k, N, n), NaN after an end; every `every`-th step, k of `total`."""

    t: Array
    y: Array
    total: int
    every: int


def real_numbers(value: npt.ArrayLike, what: str) -> Array:
    """An argument as an array of floats."""
    try:
        numbers = np.asarray(value)
        if numbers.dtype.kind not in "cSU":
            return numbers.astype(float)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{what}: found {displayed(value)}, expected real numbers")


def steps_of(solution: Solution) -> Curves:
    """The points of the steps of the first trajectories."""
    if not isinstance(solution, Solution):
        raise InputError(
            f"expected a solution as liehom.integrate returns it, got {displayed(solution)}"
            + "; for several trajectories give integrate initial points (k, N)" * isinstance(solution, list | tuple)
        )
    y = np.asarray(solution.y, dtype=float)
    if not y.size:
        raise InputError("the solution has no point to draw: its ensemble or its t_eval is empty")
    t = np.broadcast_to(np.asarray(solution.t, dtype=float), (*y.shape[:-2], y.shape[-1]))
    t, y = t.reshape(-1, t.shape[-1]), y.reshape(-1, *y.shape[-2:])
    every = -(-t.shape[-1] // MAX_POINTS)
    kept = np.unique(np.r_[0 : t.shape[-1] : every, t.shape[-1] - 1])
    return Curves(t[:MAX_TRAJECTORIES, kept], y[:MAX_TRAJECTORIES][..., kept], len(y), every)


def curves_of(solution: Solution) -> Curves:
    """The first trajectories as smooth curves: steps made again with fractions of their size, or the cubic spline in
    time (if steps are not known, or more than 400 in 50 trajectories), on the sphere if |m| is constant.
    """
    steps = steps_of(solution)
    points = steps.t.shape[-1]
    if points < 2:
        return steps
    if steps.total <= MAX_TRAJECTORIES and points <= MAX_STEPS_MADE + 1:
        # an implicit step of another size need not have a solution
        with contextlib.suppress(ConvergenceError, np.linalg.LinAlgError):
            known = interpolant(solution)
            if known is not None:
                return _made_again(steps, known)
    parts = [_splined(t, y, max(1, 2 * CURVE_POINTS // points)) for t, y in zip(steps.t, steps.y, strict=True)]
    return steps._replace(t=np.stack([t for t, _ in parts]), y=np.stack([y for _, y in parts]))


def _made_again(steps: Curves, known: DenseSolution) -> Curves:
    """The curves that the method draws between its steps."""
    times = _times(steps.t)
    y = np.asarray(known(times), dtype=float).reshape(steps.total, -1, len(times))
    low, high = np.nanmin(steps.t, axis=-1)[:, None], np.nanmax(steps.t, axis=-1)[:, None]
    y = np.where(((times >= low) & (times <= high))[:, None, :], y, np.nan)
    return steps._replace(t=np.broadcast_to(times, (steps.total, len(times))), y=y)


def constant_norm(y: Array) -> float | None:
    """|m| for points (k, N, n), if it is the same for all points and positive."""
    norms = np.linalg.norm(y, axis=1)
    low, high = float(np.nanmin(norms)), float(np.nanmax(norms))
    return (low + high) / 2 if low > 0 and high - low <= SPHERE_TOLERANCE * high else None


def _times(t: Array) -> Array:
    """About `CURVE_POINTS` times, in the direction of integration, and among them those of steps that agree."""
    if np.unique(t[:, :1]).size == 1 and bool((t == t[:1]).all()):
        return _divided(t[0], max(2, CURVE_POINTS // t.shape[-1]))
    first = t[0, 0]
    last = np.nanmin(t) if first == np.nanmax(t) else np.nanmax(t)
    return np.linspace(first, last, CURVE_POINTS)


def _divided(t: Array, parts: int) -> Array:
    """Times, and between any two of them further ones, so that there are `parts` intervals for one."""
    within = t[:-1, None] + np.diff(t)[:, None] * (np.arange(parts) / parts)
    return np.append(within.reshape(-1), t[-1])


def _splined(t: Array, y: Array, parts: int) -> tuple[Array, Array]:
    """The spline through points (N, n), at times filled up with NaN; the points themselves if times do not increase."""
    there = np.isfinite(t) & np.isfinite(y).all(axis=0)
    count, size = int(there.sum()), parts * (t.shape[-1] - 1) + 1
    times, points = t[there], y[:, there]
    if count > 1 and parts > 1:
        direction = 1.0 if times[-1] > times[0] else -1.0
        if bool((direction * np.diff(times) > 0).all()):
            fine = _divided(times, parts)
            smooth = CubicSpline(direction * times, points, axis=1)(direction * fine)
            norm = constant_norm(points[None])
            if norm is not None:
                smooth *= norm / np.linalg.norm(smooth, axis=0)
            smooth[:, ::parts] = points
            times, points = fine, smooth
    filled = np.full(size, np.nan), np.full((len(y), size), np.nan)
    filled[0][: len(times)], filled[1][:, : len(times)] = times, points
    return filled


# Plots of solutions as curves in the plane, in space and on quadrics, or as coordinates over time.

MAX_LINES = 8
TITLED = 3  # Quadrics that the title of a picture names
LEVEL_TOLERANCE = 1e-6  # Variation of an invariant form along trajectories that is admissible, relative to |Q| |m|^2


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

    * two: curves in the plane,
    * three: curves in space, with the sphere if |m| is constant (parts behind the sphere are pale),
    * four to eight: coordinates over time,
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
    chosen, names = chosen_coordinates(coordinates, steps.y.shape[1])
    coloured = len(chosen) > MAX_LINES
    curves = steps if show == "steps" or (coloured and solution.sol is None) else curves_of(solution)
    layers = [Layer(curves.t, curves.y[:, chosen], "-")] if show != "steps" else []
    layers += [Layer(steps.t, steps.y[:, chosen], ".")] if show != "curve" else []
    with style_unless(ax):
        radius = None
        if len(chosen) in (2, 3) and not over_time:
            scene, surface = draw_scenery(layers[0].y, names, ax)
            draw_layers(scene, layers, surface)
            ax, radius = scene.axes, None if surface is None else np.sqrt(surface.level)
        elif not coloured:
            ax = _over_time(layers, names, ax)
        else:
            ax = _as_colours(layers[0], ax)
        _entitle(ax, solution, steps, radius, 1 if coloured else len(steps.y))
        figure = figure_of(ax)
    return finished(figure, path)


def plot_quadric(
    form: Representation | npt.ArrayLike,
    through: Solution | npt.ArrayLike,
    ax: Axes | None = None,
    *,
    path: str | os.PathLike[str] | None = None,
) -> Axes:
    """Draw the quadrics m^T Q m = c in space on which given trajectories or points are, with the trajectories.

    Parameters
    ----------
    form : Representation, or array_like of shape (3, 3)
        A representation on space with one invariant symmetric form Q, up to multiples; or Q itself.
    through : Solution, or array_like of shape (3,) or (..., 3)
        A solution of `integrate`, of an ensemble the first 50 trajectories; or points.
    ax : matplotlib.axes.Axes, optional
        Axes in space or in the plane; by default new ones in space.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes

    Notes
    -----
    Drawn are spheres, ellipsoids, hyperboloids of one and two sheets, cones and elliptic cylinders: the sheets on which
    there are points, and a little more of them than the points need. Parts of a trajectory that its surface hides are
    faint. Curves between the steps are those of `plot_trajectory`.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(2, 1))
    >>> sol = lh.integrate(lh.GeneratorField(rho, ["m2", "1", "m0"]), (0, 3), [0.0, 0.0, 1.0])
    >>> ax = lh.plotting.plot_quadric(rho, sol)  # doctest: +SKIP
    """
    matrix = invariant_form(form)
    layer = None
    if isinstance(through, Solution):
        curves = curves_of(through)
        layer = Layer(curves.t, curves.y, "-")
        y = layer.y
    else:
        y = _points(through)
    if y.shape[1] != 3:
        raise InputError(f"quadrics are drawn in space; the solution has {y.shape[1]} coordinates")
    surfaces = _surfaces(matrix, y)
    shown = list(dict.fromkeys(surfaces))
    if len(shown) > MAX_TRAJECTORIES:
        raise InputError(
            f"the points are on {len(shown)} quadrics; at most {MAX_TRAJECTORIES} are drawn in one picture"
        )
    with style_unless(ax):
        scene = Scene(space_axes(ax))
        for surface in shown:
            surface.draw(scene)
        if layer is not None:
            for k, (surface, points) in enumerate(zip(surfaces, y, strict=True)):
                scene.curve(surface, points, **look(k, len(y)))
            mark_ends(scene, y, surfaces)
        else:
            for surface, points in zip(surfaces, y, strict=True):
                scene.mark(surface, points[:, 0], "o", color=current_colours()[0], markersize=6)
        low, high = (f([s.bounds()[i] for s in surfaces], axis=0) for i, f in enumerate((np.min, np.max)))
        scene.frame(high, ("$m_0$", "$m_1$", "$m_2$"), whole=not surfaces[0].closed)
        scene.limit((high - low) / 2, (high + low) / 2, zoom=1.0)
        title = ", ".join(f"{s.kind}, $c$ = {s.level:.4g}" for s in shown[:TITLED])
        scene.axes.set_title(title + (f", and {len(shown) - TITLED} more" if len(shown) > TITLED else ""), loc="left")
    return written(scene.axes, path)


def _points(through: npt.ArrayLike) -> Array:
    """Points of the caller, (k, 3, 1)."""
    points = real_numbers(through, "the points")
    if not points.size or points.shape[-1:] != (3,) or not np.isfinite(points).all():
        raise InputError(f"expected a solution, or finite points of shape (3,) or (..., 3), got {displayed(through)}")
    return points.reshape(-1, 3, 1)


def invariant_form(form: Representation | npt.ArrayLike) -> Array:
    """The matrix Q (3, 3) of the first argument of `plot_quadric`."""
    if isinstance(form, Representation):
        forms = form.invariant_forms().symmetric if form.size == 3 else []
        if len(forms) != 1:
            actual = f"{len(forms)} independent invariant forms" if form.size == 3 else f"{form.size} coordinates"
            raise InputError(f"expected a representation on space with one invariant form; this one has {actual}")
        return np.array(forms[0].to_numpy(), dtype=float)
    matrix = real_numbers(form, "the form")
    if matrix.shape != (3, 3) or not np.allclose(matrix, matrix.T) or not matrix.any():
        raise InputError(f"expected a symmetric 3 x 3 matrix that is not 0, got {displayed(form)}")
    return matrix


def _surfaces(form: Array, y: Array) -> list[Quadric]:
    """The quadric of each trajectory (k, 3, n), the same one for equal levels."""
    values = np.einsum("kin,ij,kjn->kn", y, form, y)
    scale = np.abs(form).max() * np.nanmax((y**2).sum(axis=1), initial=0.0)
    levels = np.nanmean(values, axis=1)
    if not np.nanmax(np.abs(values - levels[:, None]), initial=0.0) <= LEVEL_TOLERANCE * scale:
        raise InputError("Q does not have the same value along a trajectory, so that it is not an invariant form of it")
    distinct = np.unique(np.round(levels / (LEVEL_TOLERANCE * scale or 1.0)), return_inverse=True)[1].reshape(-1)
    quadrics = {}
    for number in np.unique(distinct):
        points = np.concatenate([part[:, np.isfinite(part).all(axis=0)] for part in y[distinct == number]], axis=1)
        quadrics[number] = Quadric(form, float(levels[distinct == number].mean()), points)
    return [quadrics[number] for number in distinct]


def chosen_coordinates(coordinates: Sequence[int] | None, size: int) -> tuple[list[int], list[str]]:
    """The indices of the coordinates to draw, checked, and their names."""
    indices: list[Any] = list(coordinates) if isinstance(coordinates, Iterable) else []
    chosen = list(range(size)) if coordinates is None else [int(i) if isinstance(i, np.integer) else i for i in indices]
    if not chosen or any(isinstance(i, bool) or not isinstance(i, int) or not 0 <= i < size for i in chosen):
        raise InputError(f"coordinates are indices from 0 to {size - 1}, got {displayed(coordinates)}")
    return chosen, [f"$m_{i}$" if i < 10 else f"$m_{{{i}}}$" for i in chosen]


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


def mark_ends(scene: Scene, y: Array, surfaces: Sequence[Quadric | None]) -> None:
    """Mark initial points by a disc and ends by a square, pale if hidden, with one legend for all curves."""
    colours = current_colours()
    size = 6 if len(y) <= 5 else 3.5
    for k, (points, surface) in enumerate(zip(y, surfaces, strict=True)):
        colour = colours[k % len(colours)]
        for marker, point in zip("os", _ends(points), strict=True):
            fill = {"color": colour, "markersize": size, "markerfacecolor": colour if marker == "o" else paper_colour()}
            scene.mark(surface, point, marker, **fill)
    for marker, name in zip("os", ("start", "end"), strict=True):
        fill = {"color": colours[0], "markersize": 6, "label": name}
        fill["markerfacecolor"] = colours[0] if marker == "o" else paper_colour()
        scene.plot(np.full((len(y[0]), 1), np.nan), marker, **fill)
    scene.axes.legend(loc="upper right")


# -- in the plane and in space ---------------------------------------------------------------------------
def draw_scenery(y: Array, names: Sequence[str], ax: Axes | None) -> tuple[Scene, Quadric | None]:
    """Axes for trajectories (k, 2, n) or (k, 3, n); for three coordinates of constant norm, with the sphere."""
    if y.shape[1] == 2:
        flat: AnyAxes = plane_axes(ax, 5.4, 5.0)
        flat.set(xlabel=names[0], ylabel=names[1])
        flat.set_aspect("equal", adjustable="datalim")
        return Scene(flat), None
    scene, radius = Scene(space_axes(ax)), constant_norm(y)
    if radius is None:
        _box(scene, y, names)
        return scene, None
    surface = sphere(radius)
    surface.draw(scene)
    scene.frame(radius, names)
    scene.limit(radius)
    return scene, surface


def draw_layers(scene: Scene, layers: Sequence[Layer], surface: Quadric | None = None) -> None:
    """Draw trajectories and mark their ends."""
    for layer in layers:
        for k, points in enumerate(layer.y):
            scene.curve(surface, points, layer.mark, **look(k, len(layer.y)))
    mark_ends(scene, layers[0].y, [surface] * len(layers[0].y))


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


# -- over time --------------------------------------------------------------------------------------------
def _over_time(layers: Sequence[Layer], names: Sequence[str], ax: Axes | None) -> AnyAxes:
    axes: AnyAxes = plane_axes(ax, 7.0, 4.2)
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
    axes: AnyAxes = plane_axes(ax, 7.0, 4.2)
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


# Animations of trajectories, in memory or as a GIF or an HTML page.

MAX_ANIMATED = 10
SUFFIXES = (".gif", ".html")
DPI = 100
TAIL = 0.25  # The bright part of a curve, as a fraction of the time span
SYMBOLS = {
    "fa fa-minus": "\N{MINUS SIGN}",
    "fa fa-fast-backward": "|\N{BLACK LEFT-POINTING POINTER}",
    "fa fa-step-backward": "\N{LEFT-POINTING ANGLE BRACKET}",
    "fa fa-play fa-flip-horizontal": "\N{BLACK LEFT-POINTING POINTER}",
    "fa fa-pause": "||",
    "fa fa-play": "\N{BLACK RIGHT-POINTING POINTER}",
    "fa fa-step-forward": "\N{RIGHT-POINTING ANGLE BRACKET}",
    "fa fa-fast-forward": "\N{BLACK RIGHT-POINTING POINTER}|",
    "fa fa-plus": "+",
}


def animate_trajectory(
    solution: Solution,
    path: str | os.PathLike[str] | None = None,
    *,
    seconds: float = 6.0,
    fps: int = 20,
    coordinates: Sequence[int] | None = None,
    over_time: bool = False,
    ax: Axes | None = None,
    progress: bool | Callable[[float], object] | None = None,
) -> FuncAnimation:
    """Animation of a solution of `integrate`: points that move along the trajectories, at most 10 of them.

    Parameters
    ----------
    solution : Solution
    path : path, optional
        File to write: .gif, or .html for a page with buttons that needs no other file and no network.
    seconds : float, optional
        Length of the animation, in which the whole time span passes.
    fps : int, optional
        Frames in a second.
    coordinates, over_time, ax
        As for `plot_trajectory`. For more than three coordinates, they are drawn over time.
    progress : bool or callable, optional
        Whether to show the progress of writing on standard error, by default if that is a terminal; or a function of
        the fraction done.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        In a notebook, ``IPython.display.HTML(animation.to_jshtml())`` shows it.

    Raises
    ------
    InputError
        If matplotlib is not installed, or an argument is not of this kind.
    FormatError
        If the path has another suffix, or cannot be written.

    Notes
    -----
    Curves are those of `plot_trajectory`. A file is written as a whole: an interrupted call leaves no file, or the one
    that was there before.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8])
    >>> animation = animate_trajectory(sol, "polhode.gif")  # doctest: +SKIP
    """
    target = None if path is None else _target(path)
    frames = _frames(seconds, fps)
    show = progress if progress is not None else target is not None and sys.stderr.isatty()
    with style_unless(ax):
        actors = stage(solution, coordinates, over_time=over_time, ax=ax)
    with Progress(show, "drawing") as report:

        def draw(frame: int) -> list[object]:
            report.update(lambda: (frame + 1) / frames, last=frame == frames - 1)
            return [line for actor in actors for line in actor.move(frame / (frames - 1))]

        animation: FuncAnimation = matplotlib_module("animation").FuncAnimation(
            actors[0].scene.axes.figure, draw, frames=frames, interval=1000 / fps, blit=False
        )
        if target is not None:
            _write(animation, target, fps)
    return animation


def stage(
    solution: Solution, coordinates: Sequence[int] | None = None, *, over_time: bool = False, ax: Axes | None = None
) -> list[Actor]:
    """The trajectories of an animation, drawn in the axes with what does not move."""
    curves = curves_of(solution)
    chosen, names = chosen_coordinates(coordinates, curves.y.shape[1])
    if len(chosen) > MAX_LINES:
        raise InputError(f"an animation shows up to {MAX_LINES} coordinates, got {len(chosen)}: choose coordinates=")
    times, y = curves.t[:MAX_ANIMATED], curves.y[:MAX_ANIMATED][:, chosen]
    if over_time or len(chosen) not in (2, 3):
        # each coordinate is a curve in the plane of time and value
        y = np.stack([np.broadcast_to(times[:, None], y.shape), y], axis=2).reshape(-1, 2, y.shape[-1])
        times, names = np.repeat(times, len(chosen), axis=0), ["time $t$", "coordinates"]
    scene, surface = draw_scenery(y, names, ax)
    if names[0] == "time $t$":
        scene.axes.set_aspect("auto")
    span = float(np.nanmax(np.abs(times - times[:, :1])))
    cast = zip(times, y, strict=True)
    return [Actor(scene, surface, t, points, span, look(k, len(y))) for k, (t, points) in enumerate(cast)]


class Actor:
    """A trajectory of an animation: its whole curve, faint, its bright tail, and the point that moves."""

    def __init__(
        self, scene: Scene, surface: Quadric | None, t: Array, points: Array, span: float, style: Mapping[str, object]
    ) -> None:
        there = np.isfinite(t) & np.isfinite(points).all(axis=0)
        self.scene, self.surface = scene, surface
        self.points: Array = points[:, there]
        self.passed: Array = np.abs(t[there] - t[there][0])
        self.span = span
        scene.plot(self.points, **{**style, "linewidth": 0.8, "alpha": FAINT, "zorder": 1})
        blank = self.points[:, :1] * np.nan
        self.lines: list[AnyAxes] = []
        for mark, more in (("-", {"linewidth": 2.2}), ("-", {"alpha": FAINT}), ("o", {"markersize": 8, "zorder": 5})):
            scene.plot(blank, mark, **{**style, **more})
            self.lines.append(scene.axes.lines[-1])

    def move(self, fraction: float) -> list[AnyAxes]:
        """Show the trajectory up to a fraction of the time span; returns the lines that have changed."""
        now = fraction * self.span
        place = np.array([np.interp(now, self.passed, x) for x in self.points])[:, None]
        tail = (self.passed > now - TAIL * self.span) & (self.passed <= now)
        points = np.concatenate([self.points[:, tail], place], axis=1)
        hidden = (
            np.zeros(points.shape[1], dtype=bool)
            if self.surface is None
            else self.surface.hidden(points, self.scene.eye)
        )
        for line, part in zip(self.lines, (only(points, ~hidden), only(points, hidden), place), strict=True):
            self.scene.move(line, part)
        self.lines[2].set_alpha(FAINT if hidden[-1] else 1.0)
        return self.lines


def _frames(seconds: float, fps: int) -> int:
    numbers = all(isinstance(x, int | float | np.integer | np.floating) for x in (seconds, fps))
    if not numbers or not 0 < fps <= 100 or not 2 <= seconds * fps <= 5000:
        raise InputError(
            f"seconds is {displayed(seconds)} and fps is {displayed(fps)}, expected numbers with a product from 2 to "
            "5000, which is the number of frames, and fps at most 100"
        )
    return round(seconds * fps)


def _target(path: str | os.PathLike[str]) -> Path:
    """The file to write, checked before the work."""
    target = Path(os.fspath(path))
    if target.suffix.lower() not in SUFFIXES:
        raise FormatError(f"{os.fspath(path)!r} is not the name of an animation: it must end in .gif or .html")
    check_target(target, force=True)
    return target


def _write(animation: FuncAnimation, target: Path, fps: int) -> None:
    """Write a GIF or a page, as a whole or not at all."""
    if target.suffix.lower() == ".html":
        # no frame is left out, however large the page
        with matplotlib_module("").rc_context({"animation.embed_limit": 2.0**20, "savefig.dpi": DPI}):
            content = page(animation.to_jshtml(fps=fps), target.stem).encode()
    else:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "animation.gif"
            animation.save(file, writer=matplotlib_module("animation").PillowWriter(fps=fps), dpi=DPI)
            content = file.read_bytes()
    write_file(target, content)


def page(player: str, title: str) -> str:
    """A page with matplotlib's player, whose symbols are characters instead of a font from the network."""
    player = re.sub(r"<link [^>]*>", "", player)
    for name, symbol in SYMBOLS.items():
        player = player.replace(f'<i class="{name}"></i>', symbol)
    return (
        f'<!doctype html>\n<html lang="en">\n<head><meta charset="utf-8"><title>{html.escape(title)}</title></head>\n'
        f"<body>\n{player}\n</body>\n</html>\n"
    )
