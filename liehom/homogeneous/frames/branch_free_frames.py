"""Isotropy frames and pseudo-inverses without the values of arrays: for traced steps and for JAX.

A singular value decomposition branches, and its derivative does not exist where singular values agree, as they do on
spheres.  Here A of known rank d is decomposed as U B, with columns of U from d columns of A that are chosen by
selection (the longest first), and B = L V^T by rows; both by orthogonalisation, twice.  Then A^+ = V L^-1 U^T, and
1 - V V^T is the projector on the kernel.  Where all singular values of A are the same, A^+ = A^T d / tr(A A^T).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from liehom.series.arrays import namespace

SAMPLES = 16
TIGHT_RTOL = 1e-11


class OrthogonalDecomposition(NamedTuple):
    """Of a matrix (..., n, k).

    Attributes
    ----------
    image : array of shape (..., n, d)
        U: an orthonormal basis of the range; columns of zeros where the rank is less than d.
    lift : array of shape (..., k, d)
        V L^-1: columns are the least solutions of A x = U[:, j].
    rows : array of shape (..., k, d)
        V: an orthonormal basis of the complement of the kernel.
    """

    image: Any
    lift: Any
    rows: Any


def orthogonal_decomposition(matrix: Any, rank: int, cutoff: Any = 0.0) -> OrthogonalDecomposition:
    """A complete orthogonal decomposition of a matrix of rank at most `rank`.

    Parameters
    ----------
    matrix : array of shape (..., n, k)
    rank : int
        d; no more columns are chosen.
    cutoff : float
        Columns whose rest is no longer than this count as dependent.

    Examples
    --------
    >>> made = orthogonal_decomposition(np.array([[0.0, 3.0, 4.0], [0.0, 0.0, 0.0]]), 1)
    >>> (made.lift @ made.image.T).round(12).tolist()
    [[0.0, 0.0], [0.12, 0.0], [0.16, 0.0]]
    """
    xp = namespace(matrix)
    chosen: list[Any] = []
    columns = [matrix[..., :, j] for j in range(matrix.shape[-1])]
    for _ in range(rank):
        unit = _unit(xp, _longest(xp, columns), chosen, cutoff)
        columns = [c - _dot(xp, unit, c)[..., None] * unit for c in columns]
        chosen.append(unit)
    rows, lifts = _by_rows(xp, [(u[..., None, :] @ matrix)[..., 0, :] for u in chosen], cutoff)
    return OrthogonalDecomposition(*[xp.stack(parts, axis=-1) for parts in (chosen, lifts, rows)])


def _by_rows(xp: Any, rows: list[Any], cutoff: Any) -> tuple[list[Any], list[Any]]:
    """The columns of V and of V L^-1, for the rows of B = L V^T."""
    units: list[Any] = []
    overs: list[Any] = []
    below: list[list[Any]] = []
    for row in rows:
        shares = [_dot(xp, v, row) for v in units]
        for share, v in zip(shares, units, strict=True):
            row = row - share[..., None] * v
        for v in units:
            row = row - _dot(xp, v, row)[..., None] * v
        square = _dot(xp, row, row)
        some = square > cutoff * cutoff
        over = xp.where(some, 1.0 / xp.sqrt(xp.where(some, square, 1.0)), 0.0)[..., None]
        units.append(row * over)
        overs.append(over)
        below.append(shares)
    lifts: list[Any] = list(units)
    for j in range(len(units) - 1, -1, -1):
        for i in range(j + 1, len(units)):
            lifts[j] = lifts[j] - below[i][j][..., None] * lifts[i]
        lifts[j] = lifts[j] * overs[j]
    return units, lifts


def _longest(xp: Any, columns: list[Any]) -> Any:
    best, size = columns[0], _dot(xp, columns[0], columns[0])
    for column in columns[1:]:
        square = _dot(xp, column, column)
        longer = square > size
        best = xp.where(longer[..., None], column, best)
        size = xp.where(longer, square, size)
    return best


def _unit(xp: Any, column: Any, before: list[Any], cutoff: Any) -> Any:
    for u in before:
        column = column - _dot(xp, u, column)[..., None] * u
    square = _dot(xp, column, column)
    some = square > cutoff * cutoff
    return column * xp.where(some, 1.0 / xp.sqrt(xp.where(some, square, 1.0)), 0.0)[..., None]


def _dot(xp: Any, a: Any, b: Any) -> Any:
    return xp.sum(a * b, axis=-1)


class TightFrame(NamedTuple):
    """What makes the linear systems at all points of some orbits short.

    Attributes
    ----------
    trace : array of shape (N, N)
        The form tr(A A^T) of m, with A = [rho(b_1) m, ..., rho(b_r) m] in an orthonormal basis of g.
    isotropy : float
        mu with R P R^T = mu (Pi - u u^T) for all unit tangent vectors u: R = [rho(b_1) u, ...], P the projector on
        g_m, Pi that on the tangent space.
    inverse : array of shape (dim, dim)
        Of the Gram matrix of the inner product on g.
    symmetric : bool
        Whether R^T r is in g_m for all tangent r and u, so that nothing has to be projected.
    over : traced number or None
        rank / tr(A A^T), where it is given: it is constant along orbits if the inner product is invariant.
    """

    trace: Any
    isotropy: float
    inverse: Any
    symmetric: bool
    over: Any = None


def tight_frame(action: Any, points: Any, rank: int, seed: int = 0) -> TightFrame | None:
    """What makes the systems short on the orbits of these points, all of one dimension; None if nothing does.

    That the singular values of A agree, and how isotropy acts on tangent vectors, is checked at the points and at
    random points of their orbits, to round-off: they are identities between polynomials, which hold at random points
    only if they hold everywhere.

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
    if rank < 2:
        return None
    rng = np.random.default_rng(seed)
    some = points[rng.permutation(len(points))[:SAMPLES]]
    some = np.repeat(some, -(-SAMPLES // len(some)), axis=0)[:SAMPLES]
    x = rng.normal(size=(len(some), action.dimension))
    moved = action.act(x / max(1.0, float(action.max_norm)), some)
    basis = action.inner_product.orthonormal_basis()
    if not bool(is_tight(action.infinitesimal.right(np.concatenate([points, moved])) @ basis, rank).all()):
        return None
    columns = action.infinitesimal.right(moved) @ basis
    square = np.sum(columns * columns, axis=(-2, -1))[:, None, None] / rank
    tangent = columns @ np.swapaxes(columns, -1, -2) / square
    kernel = np.eye(columns.shape[-1]) - np.swapaxes(columns, -1, -2) @ columns / square
    u = (tangent @ rng.normal(size=(len(some), points.shape[-1], 1)))[..., 0]
    u = u / np.sqrt(np.sum(u * u, axis=-1, keepdims=True))
    across = action.infinitesimal.right(u) @ basis @ kernel
    made = across @ np.swapaxes(across, -1, -2)
    normal = tangent - u[:, :, None] * u[:, None, :]
    mu = float(np.trace(made[0]) / (rank - 1))
    if not (mu > TIGHT_RTOL and float(np.abs(made - mu * normal).max()) <= TIGHT_RTOL * max(mu, 1.0)):
        return None
    r = (tangent @ rng.normal(size=(len(some), points.shape[-1], 1)))[..., 0]
    turned = np.swapaxes(action.infinitesimal.right(u) @ basis, -1, -2) @ r[..., None]
    outside = np.abs(turned - kernel @ turned).max()
    symmetric = bool(outside <= TIGHT_RTOL * max(1.0, float(np.abs(turned).max())))
    inverse = np.linalg.inv(action.inner_product.matrix)
    corners = action.infinitesimal.right(np.eye(points.shape[-1]))
    trace = np.einsum("pia,ab,qib->pq", corners, inverse, corners)
    near = float(Fraction(mu).limit_denominator(256))
    return TightFrame(trace, near if abs(near - mu) <= 1e-12 * mu else mu, inverse, symmetric)


def is_tight(matrix: Any, rank: int) -> Any:
    """Whether A A^T A = lambda A with lambda = tr(A A^T) / rank, bool (...,).

    Examples
    --------
    >>> bool(is_tight(np.eye(3), 3)), bool(is_tight(np.diag([1.0, 2.0]), 2))
    (True, False)
    """
    a = np.ascontiguousarray(np.moveaxis(matrix, (-2, -1), (0, 1)))  # sums over all matrices at once
    square = np.einsum("pq...,pq...->...", a, a) / rank
    left = np.einsum("pr...,qr...->pq...", a, a)
    defect = np.einsum("pr...,rq...->pq...", left, a) - square * a
    return np.abs(defect).max(axis=(0, 1)) <= TIGHT_RTOL * (square * np.abs(a).max(axis=(0, 1)))
