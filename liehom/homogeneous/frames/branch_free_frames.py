"""Isotropy frames and pseudo-inverses with a fixed sequence of operations, for traced steps and JAX.

The singular value decomposition branches, and it is not differentiable where singular values coincide, as they do on
spheres.  A matrix A of known rank d is therefore factored as A = U B and B = L V^T.  The columns of U come from d
columns of A, chosen by selection (the longest first), and B = L V^T by rows; both orthogonalizations are repeated once.
Then A^+ = V L^-1 U^T, and 1 - V V^T is the projector on the kernel.  If all singular values of A agree, then
A^+ = A^T d / tr(A A^T).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple, Protocol

import numpy as np

from liehom.homogeneous.frames.inner_product import InnerProduct
from liehom.homogeneous.maps import FieldMap
from liehom.series.arrays import namespace
from liehom.typing import Array, BooleanArray, Real, Values, ValuesLike

SAMPLES = 16
"""Number of random points at least; fewer initial points are used several times."""
POINTS_AT_ONCE = 4096
"""Points whose matrices are in memory at once."""
TIGHT_RTOL = 1e-11
OWN_STREAM = 20011
"""Second word of the seed: points that a caller drew with the same seed must not be the random tangent vectors too."""


class OrthogonalDecomposition(NamedTuple):
    """A complete orthogonal decomposition A = U L V^T of a matrix (..., n, k).

    Attributes
    ----------
    image : array of shape (..., n, d)
        U: an orthonormal basis of the range, filled with zero columns where the rank is less than d.
    lift : array of shape (..., k, d)
        V L^-1: column j is the solution of A x = U[:, j] of smallest norm.
    rows : array of shape (..., k, d)
        V: an orthonormal basis of the orthogonal complement of the kernel.
    """

    image: Values
    lift: Values
    rows: Values


def orthogonal_decomposition(matrix: Values, rank: int, cutoff: Real = 0.0) -> OrthogonalDecomposition:
    """A complete orthogonal decomposition of a matrix of rank at most `rank`.

    Parameters
    ----------
    matrix : array of shape (..., n, k)
    rank : int
        d, the number of columns that are chosen.
    cutoff : float
        Columns whose remainder has at most this length count as dependent.

    Examples
    --------
    >>> made = orthogonal_decomposition(np.array([[0.0, 3.0, 4.0], [0.0, 0.0, 0.0]]), 1)
    >>> (made.lift @ made.image.T).round(12).tolist()
    [[0.0, 0.0], [0.12, 0.0], [0.16, 0.0]]
    """
    xp = namespace(matrix)
    chosen: list[Values] = []
    columns = [matrix[..., :, j] for j in range(matrix.shape[-1])]
    for _ in range(rank):
        unit = _unit(xp, _longest(xp, columns), chosen, cutoff)
        columns = [c - _dot(xp, unit, c)[..., None] * unit for c in columns]
        chosen.append(unit)
    rows, lifts = _by_rows(xp, [(u[..., None, :] @ matrix)[..., 0, :] for u in chosen], cutoff)
    return OrthogonalDecomposition(*[xp.stack(parts, axis=-1) for parts in (chosen, lifts, rows)])


def _by_rows(xp: Any, rows: list[Values], cutoff: Real) -> tuple[list[Values], list[Values]]:
    """The columns of V and of V L^-1, for the rows of B = L V^T."""
    units: list[Values] = []
    overs: list[Values] = []
    below: list[list[Values]] = []
    for row in rows:
        coefficients = [_dot(xp, v, row) for v in units]
        for c, v in zip(coefficients, units, strict=True):
            row = row - c[..., None] * v
        for v in units:
            row = row - _dot(xp, v, row)[..., None] * v
        square = _dot(xp, row, row)
        some = square > cutoff * cutoff
        over = xp.where(some, 1.0 / xp.sqrt(xp.where(some, square, 1.0)), 0.0)[..., None]
        units.append(row * over)
        overs.append(over)
        below.append(coefficients)
    lifts: list[Values] = list(units)
    for j in range(len(units) - 1, -1, -1):
        for i in range(j + 1, len(units)):
            lifts[j] = lifts[j] - below[i][j][..., None] * lifts[i]
        lifts[j] = lifts[j] * overs[j]
    return units, lifts


def _longest(xp: Any, columns: list[Values]) -> Values:
    best, size = columns[0], _dot(xp, columns[0], columns[0])
    for column in columns[1:]:
        square = _dot(xp, column, column)
        longer = square > size
        best = xp.where(longer[..., None], column, best)
        size = xp.where(longer, square, size)
    return best


def _unit(xp: Any, column: Values, before: list[Values], cutoff: Real) -> Values:
    for u in before:
        column = column - _dot(xp, u, column)[..., None] * u
    square = _dot(xp, column, column)
    some = square > cutoff * cutoff
    over: Values = xp.where(some, 1.0 / xp.sqrt(xp.where(some, square, 1.0)), 0.0)[..., None]
    return column * over


def _dot(xp: Any, a: Values, b: Values) -> Values:
    made: Values = xp.sum(a * b, axis=-1)
    return made


class TightFrame(NamedTuple):
    """Data of orbits on which all singular values agree: rho(b_1) m, ..., rho(b_r) m is a tight frame of T_m.

    The linear systems of the correctors then have short closed solutions at all points of the orbits.

    Attributes
    ----------
    trace : array of shape (N, N)
        The form tr(A A^T) of m, with A = [rho(b_1) m, ..., rho(b_r) m] in an orthonormal basis of g.
    isotropy : float
        mu with R P R^T = mu (Pi - u u^T) for all unit tangent vectors u. Here R = [rho(b_1) u, ...], P is the projector
        on g_m, and Pi is the projector on the tangent space.
    inverse : array of shape (dim, dim)
        The inverse of the Gram matrix of the inner product on g.
    symmetric : bool
        Whether R^T r is in g_m for all tangent r and u, so that no projection is needed.
    over : traced number or None
        rank / tr(A A^T) if it is computed once: it is constant along orbits if the inner product is invariant.
    """

    trace: Array
    isotropy: float
    inverse: Array
    symmetric: bool
    over: Values | None = None


class ActionLike(Protocol):
    """The part of `liehom.Action` that `tight_frame` uses; `Action` itself is in a module above this one."""

    infinitesimal: FieldMap
    inner_product: InnerProduct

    @property
    def dimension(self) -> int:
        """Dimension of the algebra."""
        ...

    @property
    def max_norm(self) -> float:
        """The largest norm of rho(x) for x in an orthonormal basis of g."""
        ...

    def act(self, x: ValuesLike, m: ValuesLike) -> Values:
        """Exp(x) m."""
        ...


def tight_frame(action: ActionLike, points: Array, rank: int, seed: int = 0) -> TightFrame | None:
    """The tight frame of the orbits of points, all of one dimension, or None if their singular values differ.

    Both conditions, on the singular values of A and on the action of the isotropy on tangent vectors, are identities
    between polynomials. An orbit of a connected group is irreducible, so such an identity holds on all of it if it
    holds at a random point of it. It says nothing about another orbit. Therefore the conditions are checked, to
    round-off, on the orbit of each of the points, and `isotropy` must be one number for all of them. Where the group
    acts by orthogonal matrices on V and on g, both conditions hold on a whole orbit if they hold at one point of it,
    and the points themselves are used. Otherwise they are moved by random elements of the group.

    Parameters
    ----------
    action : Action
    points : array of shape (L, N)
    rank : int
        The dimension of the orbits.

    Examples
    --------
    >>> import liehom as lh
    >>> round(tight_frame(lh.Action(lh.defining(lh.so(4))), np.eye(4), 3).isotropy, 12)
    0.5
    >>> tight_frame(lh.Action(lh.sym_conjugation(3)), np.array([[1.0, 0, 0, 2, 0, 3]]), 3) is None
    True
    """
    if rank < 2 or not len(points):
        return None
    rng = np.random.default_rng((seed, OWN_STREAM))
    basis = action.inner_product.orthonormal_basis()
    rows = np.arange(max(len(points), SAMPLES)) % len(points)
    mu, symmetric, orthogonal = None, True, _acts_orthogonally(action)
    for first in range(0, len(rows), POINTS_AT_ONCE):
        some = points[rows[first : first + POINTS_AT_ONCE]]
        if not bool(is_tight(action.infinitesimal.right(some) @ basis, rank).all()):
            return None
        if not orthogonal:
            x = rng.normal(size=(len(some), action.dimension))
            some = np.asarray(action.act(x / max(1.0, float(action.max_norm)), some))
            if not bool(is_tight(action.infinitesimal.right(some) @ basis, rank).all()):
                return None
        found = _isotropy_constant(action, some, rank, rng, mu)
        if found is None:
            return None
        mu, symmetric = found[0], symmetric and found[1]
    if mu is None:
        return None
    inverse: Any = np.linalg.inv(action.inner_product.matrix)
    corners = action.infinitesimal.right(np.eye(points.shape[-1]))
    trace = np.einsum("pia,ab,qib->pq", corners, inverse, corners)
    near = float(Fraction(mu).limit_denominator(256))
    return TightFrame(trace, near if abs(near - mu) <= 1e-12 * mu else mu, inverse, symmetric)


def _acts_orthogonally(action: ActionLike) -> bool:
    """Whether the matrices rho(e_i) are skew-symmetric and the inner product on g is Ad-invariant."""
    matrices = action.infinitesimal.right(np.eye(action.infinitesimal.shape[1]))  # [j, :, i]: rho(e_i) e_j
    defect = np.abs(matrices + np.swapaxes(matrices, 0, 1)).max(initial=0.0)
    return action.inner_product.invariant and bool(defect <= TIGHT_RTOL * np.abs(matrices).max(initial=0.0))


def _isotropy_constant(
    action: ActionLike, points: Array, rank: int, rng: np.random.Generator, given: float | None
) -> tuple[float, bool] | None:
    """`isotropy` and `symmetric` of a `TightFrame` at points; None unless `isotropy` is one number, the given one."""
    basis = action.inner_product.orthonormal_basis()
    columns = action.infinitesimal.right(points) @ basis
    square = np.sum(columns * columns, axis=(-2, -1))[:, None, None] / rank
    tangent = columns @ np.swapaxes(columns, -1, -2) / square
    kernel = np.eye(columns.shape[-1]) - np.swapaxes(columns, -1, -2) @ columns / square
    u = (tangent @ rng.normal(size=(*points.shape, 1)))[..., 0]
    u = u / np.sqrt(np.sum(u * u, axis=-1, keepdims=True))
    across = action.infinitesimal.right(u) @ basis @ kernel
    made = across @ np.swapaxes(across, -1, -2)
    normal = tangent - u[:, :, None] * u[:, None, :]
    mu = float(np.trace(made[0]) / (rank - 1)) if given is None else given
    if not (mu > TIGHT_RTOL and float(np.abs(made - mu * normal).max()) <= TIGHT_RTOL * max(mu, 1.0)):
        return None
    r = (tangent @ rng.normal(size=(*points.shape, 1)))[..., 0]
    turned = np.swapaxes(action.infinitesimal.right(u) @ basis, -1, -2) @ r[..., None]
    outside = np.abs(turned - kernel @ turned).max()
    return mu, bool(outside <= TIGHT_RTOL * max(1.0, float(np.abs(turned).max())))


def is_tight(matrix: Values, rank: int) -> BooleanArray:
    """Mask, shape (...,), of the matrices with A A^T A = lambda A, lambda = tr(A A^T) / rank.

    Examples
    --------
    >>> bool(is_tight(np.eye(3), 3)), bool(is_tight(np.diag([1.0, 2.0]), 2))
    (True, False)
    """
    a = np.ascontiguousarray(np.moveaxis(np.asarray(matrix), (-2, -1), (0, 1)))  # sums over all matrices at once
    square = np.einsum("pq...,pq...->...", a, a) / rank
    left = np.einsum("pr...,qr...->pq...", a, a)
    defect = np.einsum("pr...,rq...->pq...", left, a) - square * a
    tight: BooleanArray = np.abs(defect).max(axis=(0, 1)) <= TIGHT_RTOL * (square * np.abs(a).max(axis=(0, 1)))
    return tight
