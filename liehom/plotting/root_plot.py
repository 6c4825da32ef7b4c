"""Plots of root systems and of the weights of irreducible modules, for rank 1, 2 and 3.

Coordinates are taken in an orthonormal basis of the span of the roots, in which the simple roots are the rows of the
Cholesky factor of their Gram matrix. So the first simple root points along the first axis, and lengths and angles are
those of the root system, with (a, a) = 2 for the short roots of each component.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from liehom.algebra.roots.root_system import RootSystem, root_system
from liehom.errors import InputError
from liehom.plotting.canvas import GREY, MARKERS, axes_of_dimension, current_colours, paper_colour, style_unless
from liehom.plotting.surfaces import AnyAxes
from liehom.representations.highest_weight import character, weyl_dimension
from liehom.typing import Array, IntegerArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

READABLE = 9.0
"""Least diameter, in points, of a point with its multiplicity in it; smaller points show it by their size only."""
WIDTH = 230.0
"""Width in points of a picture of the default size, from which diameters follow."""
LEGEND_ROWS = 6
LARGEST = 1_000_000
"""Largest dimension of a module whose weights are drawn; they are a few ten thousand points at most."""
VIEW = (22.0, 72.0)
"""Elevation and azimuth, in degrees, from which few roots of A3, B3 and C3 hide one another."""


def plot_root_system(kind: str | RootSystem, ax: Axes | None = None) -> Axes:
    """Draw the roots of a root system of rank 1, 2 or 3, with the simple roots named.

    Parameters
    ----------
    kind : str or RootSystem
        'A2', 'G2', 'B3', 'A1 + A1', or the result of ``algebra.root_system()``.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in, for rank 3 with ``projection="3d"``; by default new ones.

    Returns
    -------
    matplotlib.axes.Axes
        With one colour for each length of roots. Negative roots are pale, and gray edges join nearest roots of one
        length.

    Raises
    ------
    InputError
        If matplotlib is not installed, the rank is not 1, 2 or 3, or the axes do not have this dimension.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_root_system("G2")  # doctest: +SKIP
    >>> ax = lh.plotting.plot_root_system("B3")  # doctest: +SKIP
    """
    system = _of_small_rank(kind, "a root system")
    simple = simple_root_coordinates(system)
    norms = np.array([system.norm(root) for root in system.roots])
    with style_unless(ax):
        ax = axes_of_dimension(ax, system.rank)
        colours = current_colours()
        for k, norm in enumerate(sorted(set(norms.tolist()))):
            roots = _padded(system.root_matrix()[norms == norm] @ simple)
            _plot(ax, _nearest(roots), color=GREY, linewidth=0.6, zorder=1)
            positive, negative = roots[: len(roots) // 2], roots[len(roots) // 2 :]
            for part, alpha in ((negative, 0.4), (positive, 1.0)):
                rays = _segments(0 * part, part)
                _plot(ax, rays, color=colours[k], alpha=alpha, linewidth=1.8, zorder=2)
                text = f"{len(roots)} roots with $(\\alpha, \\alpha) = {norm}$" if part is positive else None
                _plot(ax, part, marker=MARKERS[k], linestyle="", color=colours[k], alpha=alpha, label=text, zorder=3)
        gap = 0.16 * float(np.sqrt(norms.max()))
        for node, root in enumerate(_padded(simple)):
            _write(ax, _beside(root, gap), f"$\\alpha_{node}$")
        _finish(ax, _padded(system.root_matrix() @ simple), f"{system.type}: {system.number_of_roots} roots")
    return ax


def plot_weights(kind: str | RootSystem, highest_weight: Sequence[int], ax: Axes | None = None) -> Axes:
    """Draw the weights of an irreducible module with their multiplicities, for rank 1, 2 or 3.

    Parameters
    ----------
    kind : str or RootSystem
        'A2', 'G2', 'B3', 'A1 + A1', or the result of ``algebra.root_system()``.
    highest_weight : sequence of int
        Dominant, in fundamental coordinates, in Bourbaki's numbering.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in, for rank 3 with ``projection="3d"``; by default new ones.

    Returns
    -------
    matplotlib.axes.Axes
        Gray edges join weights that differ by a short root. Multiplicities above 1 are written into their points; in
        diagrams of many weights the points grow with their multiplicity instead.

    Raises
    ------
    ShapeError, InputError
        If matplotlib is not installed, the rank is not 1, 2 or 3, the axes do not have this dimension, the weight is
        not dominant, or the module has a dimension above 1,000,000.

    Examples
    --------
    The adjoint representation of sl(3), and the 27 of so(7):

    >>> import liehom as lh
    >>> ax = lh.plotting.plot_weights("A2", (1, 1))  # doctest: +SKIP
    >>> ax = lh.plotting.plot_weights("B3", (2, 0, 0))  # doctest: +SKIP
    """
    system = _of_small_rank(kind, "a weight diagram")
    dimension = weyl_dimension(system, highest_weight)
    if dimension > LARGEST:
        raise InputError(f"a picture shows the weights of a module of dimension at most {LARGEST}, found {dimension}")
    weights = character(system, highest_weight)
    cartan = np.array(system.cartan, dtype=float)
    points = _padded(np.array(list(weights), dtype=float) @ np.linalg.inv(cartan) @ simple_root_coordinates(system))
    times = np.array(list(weights.values()))
    with style_unless(ax):
        ax = axes_of_dimension(ax, system.rank)
        index = {weight: i for i, weight in enumerate(weights)}
        for root in np.array([a for a in system.positive_roots if system.norm(a) == 2]) @ np.array(system.cartan):
            lower = [
                (i, index.get(tuple(x - y for x, y in zip(weight, root.tolist(), strict=True))))
                for weight, i in index.items()
            ]
            ends = np.array([pair for pair in lower if pair[1] is not None], dtype=int).reshape(-1, 2)
            _plot(ax, _segments(points[ends[:, 0]], points[ends[:, 1]]), color=GREY, linewidth=0.6, zorder=1)
        _draw_multiplicities(ax, points, times)
        top = tuple(int(x) for x in highest_weight)
        _write(ax, _beside(points[0], 0.14 * abs(points).max()), r"$\lambda$")
        where = f"$\\lambda$ = {top if len(top) > 1 else top[0]}"
        _finish(ax, points, f"{system.type}, {where}: dimension {times.sum()}, {len(points)} weights")
    return ax


def _draw_multiplicities(ax: Axes, points: Array, times: IntegerArray) -> None:
    """A point for each weight, with its multiplicity in it if there is room between nearest weights."""
    colours = current_colours()
    room = min(13.0, 0.85 * WIDTH * np.sqrt(2) / (2.3 * abs(points).max() + 0.2))
    values = np.unique(times)
    named = values[np.unique(np.linspace(0, len(values) - 1, LEGEND_ROWS).astype(int))]
    for k in values.tolist():
        size = (6.0 if k == 1 else room) if room >= READABLE else room * (0.3 + 0.7 * k / times.max())
        options = {"marker": "o", "linestyle": "", "color": colours[min(k, 2) - 1], "markersize": size, "zorder": 3}
        _plot(ax, points[times == k], label=f"multiplicity {k}" if k in named else None, **options)
        for point in points[times == k] if room >= READABLE and k > 1 else ():
            _write(ax, point, str(k), color=paper_colour(), fontsize=8, zorder=10)


def simple_root_coordinates(system: RootSystem) -> Array:
    """The simple roots as rows of a lower triangular matrix (r, r): coordinates in an orthonormal basis.

    Examples
    --------
    >>> simple_root_coordinates(root_system("B2")).round(3).tolist()
    [[2.0, 0.0], [-1.0, 1.0]]
    """
    gram = np.array(system.cartan, dtype=float) * np.array(system.norms, dtype=float) / 2
    return np.asarray(np.linalg.cholesky(gram), dtype=float)


def _of_small_rank(kind: str | RootSystem, what: str) -> RootSystem:
    system = kind if isinstance(kind, RootSystem) else root_system(kind)
    if not 1 <= system.rank <= 3:
        raise InputError(
            f"{what} is drawn for rank 1, 2 or 3; {system.type} has rank {system.rank}: plot_dynkin draws every rank"
        )
    return system


def _padded(points: Array) -> Array:
    """Points (k, 1) on a line as points of the plane; others unchanged."""
    return np.hstack([points, np.zeros_like(points)]) if points.shape[1] == 1 else points


def _segments(starts: Array, ends: Array) -> Array:
    """Segments as one curve with gaps, shape (3 k, d)."""
    gaps = np.full_like(starts, np.nan, dtype=float)
    return np.stack([starts, ends, gaps], axis=1).reshape(-1, starts.shape[1])


def _nearest(points: Array) -> Array:
    """Segments between the pairs of points at the smallest distance."""
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    least = distance[distance > 0].min()
    pairs = np.argwhere(np.triu(abs(distance - least) < 1e-9))
    return _segments(points[pairs[:, 0]], points[pairs[:, 1]])


def _plot(ax: Axes, points: Array, **options: object) -> None:
    anywhere: AnyAxes = ax
    anywhere.plot(*points.T, **options)


def _write(ax: Axes, point: Array, text: str, **options: object) -> None:
    anywhere: AnyAxes = ax
    anywhere.text(*point, text, ha="center", va="center", **options)


def _beside(point: Array, gap: float) -> Array:
    """Place for the name of a point: a little further from 0."""
    size = float(np.linalg.norm(point))
    return point * (1 + gap / size) if size else point + gap


def _finish(ax: Axes, points: Array, title: str) -> None:
    """Equal scales around the points, no frame, title and legend."""
    size = 1.15 * max(float(abs(points).max()), 0.5) + 0.1
    low = size if points[:, 1].any() else 0.2 * size  # less for points on a line
    limits = {"xlim": (-size, size), "ylim": (-low, low)}
    anywhere: AnyAxes = ax
    if ax.name == "3d":
        anywhere.view_init(elev=VIEW[0], azim=VIEW[1])
        anywhere.set(zlim=(-size, size), **limits)
        anywhere.set_box_aspect((1, 1, 1), zoom=1.5)
    else:
        anywhere.set(aspect="equal", **limits)
    ax.set_axis_off()
    ax.set_title(title, loc="left")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.04), ncols=2, fontsize=8)
