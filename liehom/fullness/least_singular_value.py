"""Unit vectors x at which the smallest singular value of the matrix with columns A_1 x, ..., A_m x is least.

sigma_d(x)^2 is the minimum over unit vectors u of sum_a (u . A_a x)^2, which is quadratic in u and in x. Alternating
singular value decompositions decrease it monotonically from many initial points. The best points are then improved by
Gauss-Newton steps for the bilinear equations u . A_a x = 0, which converge quadratically to a simple zero and linearly
to a multiple one.
"""

from __future__ import annotations

import numpy as np

from liehom.typing import Array

ALTERNATIONS, IMPROVED, STEPS = 30, 8, 100


def least_singular_value(basis: Array, *, starts: int, seed: int) -> tuple[float, Array]:
    """Smallest sigma_d that was found, and the unit vector x at which it was found.

    Parameters
    ----------
    basis : Array
        The matrices A_a, shape (m, d, d).
    starts : int
        Number of random initial points, in addition to the axes.
    seed : int

    Examples
    --------
    >>> rotation = np.array([[[0.0, -1.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 1.0]]])
    >>> round(least_singular_value(rotation, starts=3, seed=0)[0], 6)
    1.0
    """
    m, d = len(basis), basis.shape[1]
    if m < d:
        return 0.0, np.eye(d)[0]
    points = np.concatenate([np.eye(d), np.random.default_rng(seed).standard_normal((starts, d))])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    for _ in range(ALTERNATIONS):
        left = np.linalg.svd(np.einsum("aij,nj->nia", basis, points), full_matrices=False)[0][:, :, -1]
        points = np.linalg.svd(np.einsum("ni,aij->naj", left, basis), full_matrices=False)[2][:, -1]
    values = np.linalg.svd(np.einsum("aij,nj->nia", basis, points), compute_uv=False)[:, -1]
    improved = [_improved(basis, points[i]) for i in np.argsort(values)[:IMPROVED]]
    return min(improved, key=lambda found: found[0])


def smallest(basis: Array, x: Array) -> tuple[float, Array]:
    """The value sigma_d of the matrix with columns A_a x, and its left singular vector; m >= d."""
    left, values, _ = np.linalg.svd((basis @ x).T, full_matrices=False)
    return float(values[-1]), left[:, -1]


def _improved(basis: Array, x: Array) -> tuple[float, Array]:
    """The point after Gauss-Newton steps with the damping, of four, that decreases sigma_d most."""
    d = len(x)
    value, u = smallest(basis, x)
    for _ in range(STEPS):
        rows, columns = np.einsum("i,aij->aj", u, basis), basis @ x
        left, values, right = np.linalg.svd(np.concatenate([rows, columns], axis=1), full_matrices=False)
        residual = left.T @ (columns @ u)
        tries = []
        for damping in (0.0, 1e-3 * value, value, 10 * value**0.5):
            inverse = np.where(values > 1e-13 * values[0], values / (values**2 + damping**2 + 1e-300), 0.0)
            moved = x - (right.T * inverse @ residual)[:d]
            moved = moved / np.linalg.norm(moved)
            tries.append((*smallest(basis, moved), moved))
        best = min(tries, key=lambda found: found[0])
        if not best[0] < 0.98 * value:
            break
        value, u, x = best
    return value, x
