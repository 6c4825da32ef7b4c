"""Plots of the cone on which the range condition fails, of eigenvalues by their stratum, and of Weyl chambers."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from liehom.base.errors import InputError, displayed
from liehom.base.typing import Array
from liehom.exact.algebra.roots.root_system import root_system
from liehom.exact.fullness.decide import decide_fullness
from liehom.exact.fullness.verdict import FailureReport, failure_report
from liehom.exact.orbits.cone import FailureSet, RelativeInvariant
from liehom.exact.orbits.strata import adjoint_strata, symmetric_strata
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.field import Matrix
from liehom.plotting.canvas import GREY, axes_of_dimension, current_colours, new_figure, plain, style_unless, written
from liehom.plotting.diagram_plot import simple_root_coordinates
from liehom.plotting.phase_plot import AZIMUTH, ELEVATION, AnyAxes, Scene, sphere

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Term: TypeAlias = tuple[Array, float]  # Exponents and coefficient of one term of a polynomial

GRID = 181  # Points of the half circle on which zeros are looked for


def plot_failure_cone(pair: Pair, ax: Axes | None = None, *, path: str | os.PathLike[str] | None = None) -> Axes:
    """Draw the cone of the psi at which the range condition (6.3) fails, in g/h of dimension 2 or 3.

    Parameters
    ----------
    pair : Pair
        Over QQ, with dim g/h 2 or 3.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in, for dimension 3 with ``projection="3d"``; by default new ones.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        With the coordinates of ``pair.coordinates``, and the cone cut off at the unit sphere.

    Notes
    -----
    Drawn are the parts that ``verdict.where_it_fails()`` lists: zeros of the relative invariant, null cones, and
    invariant subspaces. The title says whether the pair is full, or (6.3) holds nowhere.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_failure_cone(lh.pair("so(3,1)/so(2,1)"))  # doctest: +SKIP
    """
    if not isinstance(pair, Pair) or pair.dimension not in (2, 3):
        actual = f"a pair with dim g/h = {pair.dimension}" if isinstance(pair, Pair) else repr(pair)
        raise InputError(f"the failure cone is drawn for pairs with dim g/h = 2 or 3; got {actual}")
    report = failure_report(pair)
    with style_unless(ax):
        colours = current_colours()
        ax = axes_of_dimension(ax, pair.dimension, 4.6)
        _prepare(ax)
        curves = failure_curves(report, pair.dimension)
        for curve in curves:
            _draw(ax, curve, colours[0])
        ax.set_title(_title(pair, report.generic.holds, len(curves)), loc="left")
    return written(ax, path)


def failure_curves(report: FailureReport, dimension: int) -> list[Array]:
    """Curves on the unit sphere whose rays make up the parts of a failure cone in dimension 2 or 3."""
    return [curve for part in report.parts for curve in _curves(part, dimension)]


def _title(pair: Pair, holds: bool | None, drawn: int) -> str:
    name = f"{plain(pair.name)}: " if pair.name else ""
    if holds is False:
        return f"{name}range condition holds for no ψ"
    if decide_fullness(pair):
        return f"{name}full, range condition fails at 0 only"
    return name + f"range condition fails on {'this cone' if drawn else 'a cone that is not drawn'}"


def _curves(part: FailureSet, size: int) -> Iterator[Array]:
    """Curves (size, k) on the unit sphere whose rays make up the cone; a single column spans a line."""
    data = part.data
    if isinstance(data, RelativeInvariant):
        for factor in data.factors:
            terms = factor.to_dict()
            largest = max(map(abs, terms.values()))  # its size does not matter, and may be too large for floats
            yield from _zeros([(np.array([int(x) for x in e]), float(c / largest)) for e, c in terms.items()], size)
        return
    rows = data if isinstance(data, np.ndarray) else _floats(data)
    if part.kind == "null cone":
        unit = np.eye(size, dtype=int)
        yield from _zeros([(unit[i] + unit[j], rows[i, j]) for i in range(size) for j in range(size)], size)
    else:
        yield _in_subspace(np.linalg.qr(rows.T)[0].T)


def _in_subspace(basis: Array) -> Array:
    """The point, or the great circle, that the orthonormal rows span."""
    turn = np.linspace(0, 2 * np.pi, 2 * GRID)
    return basis.T if len(basis) == 1 else basis.T @ np.array([np.cos(turn), np.sin(turn)])


def _floats(matrix: Matrix) -> Array:
    """The rows as floats, each up to a factor; a symmetric matrix up to one factor."""
    symmetric = matrix.nrows == matrix.ncols
    rows = [matrix] if symmetric else [matrix.select(rows=[i]) for i in range(matrix.nrows)]
    return np.concatenate([(part / max(map(abs, part.entries()))).to_numpy() for part in rows])


def _zeros(terms: Sequence[Term], size: int) -> Iterator[Array]:
    """The curves on the unit sphere, or directions in the plane, on which a homogeneous polynomial changes its sign."""
    if size == 2:
        # x1 = 0, or a root of the polynomial in x0 / x1
        degree = int(max(e.sum() for e, _ in terms))
        coefficients = np.zeros(degree + 1)
        for exponents, c in terms:
            coefficients[degree - exponents[0]] += c
        if coefficients[0] == 0:
            yield np.array([[1.0], [0.0]])
        for root in np.roots(coefficients):
            if abs(root.imag) < 1e-9 * (1 + abs(root)):
                yield np.array([[root.real], [1.0]]) / np.hypot(root.real, 1.0)
        return
    if all(e.sum() == 2 for e, _ in terms):
        # a semidefinite form changes no sign: its zeros are its kernel
        squares, vectors = np.linalg.eigh(sum(c * np.outer(e, e) - c * np.diag(e * (e - 1)) for e, c in terms))
        small = 1e-12 * abs(squares).max()
        if squares[0] > -small or squares[-1] < small:
            kernel = vectors[:, abs(squares) <= small].T
            yield from [_in_subspace(kernel)] if len(kernel) else []
            return
    exponents = np.array([e for e, _ in terms])
    coefficients = np.array([c for _, c in terms])
    yield from (curve for _, curve in sphere(1.0).contours(lambda m: _value(m, exponents, coefficients), [0.0]))


def _value(m: Array, exponents: Array, coefficients: Array) -> Array:
    """A polynomial at points (..., 3)."""
    return np.prod(m[..., None, :] ** exponents, axis=-1) @ coefficients


def _prepare(ax: Axes) -> None:
    """The unit circle or sphere and the names of the coordinates."""
    if ax.name == "3d":
        _prepare_space(ax)
        return
    turn = np.linspace(0, 2 * np.pi, 2 * GRID)
    ax.plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=0.9)
    ax.set(aspect="equal", xlim=(-1.15, 1.15), ylim=(-1.15, 1.15), xlabel="$x_0$", ylabel="$x_1$")


def _prepare_space(ax: AnyAxes) -> None:
    ax.view_init(elev=ELEVATION, azim=AZIMUTH)
    scene = Scene(ax)
    sphere(1.0).draw(scene)
    scene.frame(1.0, ("$x_0$", "$x_1$", "$x_2$"))
    scene.limit(1.0)
    ax.set_axis_off()


def _draw(ax: Axes, curve: Array, colour: str) -> None:
    """The rays through a curve on the unit sphere, or the line through a point."""
    if curve.shape[1] == 1:
        ax.plot(*(curve * np.array([-1.0, 1.0])), color=colour)
        return
    sheet = curve[:, :, None] * np.array([0.0, 1.0])
    solid: AnyAxes = ax
    solid.plot_surface(*sheet, color=colour, alpha=0.25, rstride=2, cstride=1, linewidth=0, shade=False)
    ax.plot(*curve, color=colour)


def plot_eigenvalues(
    ax: Axes | None = None, *, points: Sequence[Sequence[float]] = (), path: str | os.PathLike[str] | None = None
) -> Axes:
    """Draw the eigenvalues of symmetric 3 x 3 matrices of trace 1, in a triangle divided by the orbit types of SO(3).

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    points : sequence of (a, b, c), optional
        Eigenvalues of matrices to mark; they are divided by their sum, which must be positive.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes

    Notes
    -----
    The corners are matrices of rank 1. On the medians two eigenvalues agree. There the orbits are projective planes,
    and the isotropy so(2) is full. Elsewhere the isotropy is 0 and not full, and at the center it is so(3). The
    triangle of Hermitian matrices, such as the states of a system with three levels, is divided in the same way.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_eigenvalues(points=[(0.6, 0.2, 0.2)])  # doctest: +SKIP
    """
    if any(len(point) != 3 or not sum(point) > 0 for point in points):
        raise InputError(f"a point has three eigenvalues with a positive sum; got {displayed(points)}")
    marked = np.array([list(point) for point in points], dtype=float).reshape(-1, 3)
    corners = np.array([[0.0, 1.0], [-np.sqrt(3) / 2, -0.5], [np.sqrt(3) / 2, -0.5]])
    with style_unless(ax):
        colours = current_colours()
        ax = new_figure(4.8, 4.4).add_subplot() if ax is None else ax
        closed = corners[[0, 1, 2, 0]]
        ax.fill(*corners.T, color=colours[0], alpha=0.15, linewidth=0)
        ax.plot(*closed.T, color=GREY, linewidth=0.9)
        kinds = {len(s.label): s for s in symmetric_strata(3)}
        for corner, opposite in zip(corners, -corners / 2, strict=True):
            ax.plot(*np.array([corner, opposite]).T, color=colours[1], linewidth=2.2)
        ax.plot(0, 0, "o", color=colours[2], markersize=8, zorder=4)
        for number, name, colour in ((3, "a > b > c", 0), (2, "two equal", 1), (1, "a = b = c", 2)):
            stratum = kinds[number]
            text = f"{name}: isotropy {stratum.structure}, orbits of dimension {stratum.orbit_dimension}"
            ax.plot([], [], color=colours[colour], linewidth=6 if number == 3 else 2.2, label=text)
        for corner, text in zip(corners, ("(1, 0, 0)", "(0, 1, 0)", "(0, 0, 1)"), strict=True):
            ax.annotate(text, corner, 1.14 * corner - (0, 0.02), ha="center", va="center")
        if marked.size:
            ax.plot(*(marked / marked.sum(axis=1, keepdims=True) @ corners).T, "x", color=GREY, markersize=7, zorder=5)
        ax.set(aspect="equal", xlim=(-1.15, 1.15), ylim=(-0.75, 1.25))
        ax.set_axis_off()
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.02), fontsize=8)
    return written(ax, path)


def plot_weyl_chamber(kind: str, ax: Axes | None = None, *, path: str | os.PathLike[str] | None = None) -> Axes:
    """Draw a root system of rank 2 with its Weyl chamber, whose walls are the strata of the adjoint representation.

    Parameters
    ----------
    kind : str
        'A2', 'B2', 'C2', 'G2' or 'A1 + A1'.
    ax : matplotlib.axes.Axes, optional
        Axes in the plane; by default new ones.
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        With the isotropy algebra of the compact form at the inside, the walls and the corner of the chamber.

    Examples
    --------
    >>> import liehom as lh
    >>> ax = lh.plotting.plot_weyl_chamber("G2")  # doctest: +SKIP
    """
    system = root_system(kind)
    if system.rank != 2:
        raise InputError(f"a Weyl chamber is drawn for rank 2; {kind} has rank {system.rank}")
    simple = simple_root_coordinates(system)
    roots = np.array(system.roots, dtype=float) @ simple
    weights = np.linalg.inv(simple).T  # dual to the simple roots: the edges of the chamber
    edges = 1.5 * abs(roots).max() * weights / np.linalg.norm(weights, axis=1)[:, None]
    with style_unless(ax):
        colours = current_colours()
        ax = new_figure(4.8, 4.8).add_subplot() if ax is None else ax
        for root in roots:
            ax.annotate("", root, (0, 0), arrowprops={"arrowstyle": "-|>", "color": GREY, "linewidth": 1.2})
        for node, root in enumerate(simple):
            ax.annotate(f"$\\alpha_{node + 1}$", 1.13 * root, ha="center", va="center")
        corner = edges.sum(axis=0) * 0.62
        ax.fill(*np.array([(0, 0), edges[0], edges[1]]).T, color=colours[0], alpha=0.15, linewidth=0)
        ax.plot([], [], color=colours[0], alpha=0.4, linewidth=6, label=f"inside: {_structure(kind, ())}")
        for node in (0, 1):
            other = 1 - node  # the wall on which this simple root vanishes is the edge dual to the other one
            text = f"$\\alpha_{node + 1} = 0$: {_structure(kind, (node,))}"
            ax.plot(*np.array([(0, 0), edges[other]]).T, color=colours[1 + node], linewidth=2.2, label=text)
        ax.plot(0, 0, "o", color=colours[3], label=f"0: {_structure(kind, (0, 1))}", zorder=4)
        size = 1.2 * max(abs(roots).max(), abs(edges).max(), abs(corner).max())
        ax.set(aspect="equal", xlim=(-size, size), ylim=(-size, size), title=f"{kind}: isotropy in the adjoint action")
        ax.set_axis_off()
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.04), ncols=2, fontsize=8)
    return written(ax, path)


def _structure(kind: str, vanishing: tuple[int, ...]) -> str:
    """The isotropy algebra of the stratum on which these simple roots vanish."""
    return next(s.structure for s in adjoint_strata(kind) if vanishing in s.label)
