"""Numerical answer for pairs over float64: the smallest singular value, minimized over the sphere.

Let A_a be an orthonormal basis of the span of rho(h) and 1. Then sigma_d(x)^2 is the minimum over unit vectors u of
sum_a (u . A_a x)^2, which is quadratic in u and in x. Alternating eigenvector steps decrease it monotonically; they
begin at many random points.
"""

from __future__ import annotations

import numpy as np

from liehom.fullness.verdict import NumericallyFull, NumericallyNotFull
from liehom.representations import Pair
from liehom.typing import Array


def decide_numerically(pair: Pair, *, starts: int = 60, seed: int = 0) -> NumericallyFull | NumericallyNotFull:
    """Numerical verdict, with the singular value that it rests on.

    Parameters
    ----------
    pair : Pair
        Exact or over float64; exact numbers are rounded.
    starts : int
        Number of random initial points, in addition to the axes.
    seed : int
        Seed of the initial points.

    Notes
    -----
    The tolerance is the square root of the `rtol` of the pair's field (1e-9 for exact pairs). Non-fullness is not an
    open condition, so rounding alone can cause a numerical 'not full'; the reason of such a verdict says so.

    Examples
    --------
    >>> import liehom as lh
    >>> decide_numerically(lh.pair("so(4)/so(3)")).full
    True
    """
    d = pair.dimension
    tolerance = float(getattr(pair.field, "rtol", 1e-9)) ** 0.5
    if d <= 1:
        return NumericallyFull(pair, f"dim g/h = {d}", 1.0, 1.0 / tolerance)
    basis = orthonormal_action([a.to_numpy() for a in pair.isotropy_matrices()], d)
    value, x = least_singular_value(basis, starts=starts, seed=seed)
    eta = [float(v) for v in x @ pair.subalgebra.quotient().lift.to_numpy()]
    if value > tolerance:
        reason = f"min sigma_d / sigma_1 >= {value:.3g} found in {starts + d} starts, tolerance {tolerance:.1g}"
        return NumericallyFull(pair, reason, value, value / tolerance, eta)
    reason = (
        f"an eta with sigma_d / sigma_1 = {value:.3g} was found, tolerance {tolerance:.1g}; rounding alone can cause it"
    )
    return NumericallyNotFull(pair, reason, value, tolerance / max(value, 1e-300), eta)


def orthonormal_action(matrices: list[Array], d: int) -> Array:
    """Orthonormal basis (m, d, d), in the Frobenius product, of the span of the matrices and the identity."""
    scaled = [a / (np.linalg.norm(a) or 1.0) for a in matrices]
    flat = np.array([np.eye(d) / np.sqrt(d), *scaled]).reshape(-1, d * d)
    _, values, right = np.linalg.svd(flat, full_matrices=False)
    return np.asarray(right[values > 1e-9 * values[0]].reshape(-1, d, d))


def relative_singular_value(basis: Array, x: Array) -> float:
    """Ratio sigma_d / sigma_1 of the matrix with columns A_a x."""
    columns = (basis @ x).T
    if columns.shape[1] < columns.shape[0]:
        return 0.0
    values = np.linalg.svd(columns, compute_uv=False)
    return float(values[-1] / values[0]) if values[0] else 0.0


def least_singular_value(basis: Array, *, starts: int, seed: int, steps: int = 200) -> tuple[float, Array]:
    """Smallest ratio sigma_d / sigma_1 that was found, and the unit vector x at which it was found.

    Examples
    --------
    >>> rotation = np.array([[[0.0, -1.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 1.0]]])
    >>> round(least_singular_value(rotation, starts=3, seed=0)[0], 6)
    1.0
    """
    d = basis.shape[1]
    rng = np.random.default_rng(seed)
    best: tuple[float, Array] = (np.inf, np.eye(d)[0])
    for start in [*np.eye(d), *rng.standard_normal((starts, d))]:
        x = _descend(basis, start / np.linalg.norm(start), steps)
        value = relative_singular_value(basis, x)
        if value < best[0]:
            best = (value, x)
        if best[0] < 1e-13:
            break
    return best


def _descend(basis: Array, x: Array, steps: int) -> Array:
    before: float | np.float64 = np.inf
    for _ in range(steps):
        u = np.linalg.eigh((basis @ x).T @ (basis @ x))[1][:, 0]
        rows = u @ basis  # (m, d): u^T A_a
        values, vectors = np.linalg.eigh(rows.T @ rows)
        x = vectors[:, 0]
        if values[0] <= 1e-26 or before - values[0] < 1e-9 * abs(values[0]):
            break
        before = values[0]
    return np.asarray(x)
