"""Numerical ranks of a batch of small matrices: numbers of singular values above a bound, mostly without an SVD.

Orthogonalization with pivoting runs on all matrices at once, entry by entry.  After k steps the remainder R and the
length r of the last pivot bound the singular values on either side of k:

    s_(k+1) <= |R|_F,    s_k >= 3 r / (4^k + 6 k - 1)^(1/2)

If the given bound is between them, the rank is k; otherwise the singular values are computed.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from liehom.typing import Array, IntegerArray, Values

# below this number of matrices the singular values are computed; larger batches are split into blocks for the cache
MIN_BATCH, BLOCK = 64, 2048
# relative margin for round-off in both bounds
MARGIN = 1e-6


def batched_ranks(matrices: Values, bounds: npt.ArrayLike) -> IntegerArray:
    """Numbers of singular values above a bound, shape (...,).

    Parameters
    ----------
    matrices : array of shape (..., p, q)
        Finite, in float64.
    bounds : array of shape (...,)
        Well above the round-off of the entries.

    Returns
    -------
    array of int, shape (...,)

    Notes
    -----
    The upper bound for s_(k+1) is the distance to a matrix of rank k. The lower bound for s_k follows from the bound
    for the inverse of a triangular factor with pivoting: Higham, Accuracy and Stability of Numerical Algorithms,
    theorem 8.14.

    Examples
    --------
    >>> batched_ranks(np.array([np.eye(2), np.diag([1.0, 0.0]), np.diag([1.0, 1e-12])] * 30), np.full(90, 1e-9))[:3]
    array([2, 1, 1])
    """
    lead, (p, q) = matrices.shape[:-2], matrices.shape[-2:]
    limits: Array = np.broadcast_to(bounds, lead)
    count = limits.size
    if count < MIN_BATCH or not p or not q:
        return _by_values(matrices, limits)
    if p < q:
        matrices, p, q = np.swapaxes(matrices, -1, -2), q, p
    batch: Array = matrices.reshape(count, p, q)
    limits = limits.reshape(count)
    found = np.empty(count, dtype=int)
    for first in range(0, count, BLOCK):
        here = slice(first, first + BLOCK)
        found[here] = _by_pivots(np.array(batch[here].transpose(2, 1, 0), order="C"), limits[here])
    left = np.flatnonzero(found < 0)
    if len(left):
        found[left] = _by_values(batch[left], limits[left])
    ranks: IntegerArray = found.reshape(lead)
    return ranks


def _by_values(matrices: Values, bounds: Array) -> IntegerArray:
    ranks: IntegerArray = (np.linalg.svd(np.asarray(matrices), compute_uv=False) > bounds[..., None]).sum(axis=-1)
    return ranks


def _by_pivots(columns: Array, bounds: Array) -> IntegerArray:
    """Ranks of L matrices given by their columns (q, p, L), which are overwritten; -1 for undecided ones."""
    found, lanes = np.full(bounds.shape, -1), np.arange(len(bounds))
    lowest = np.full(bounds.shape, np.inf)
    for k in range(len(columns) + 1):
        squares = np.einsum("cpl,cpl->cl", columns, columns)
        rest = np.sqrt(squares.sum(axis=0))
        decided = (found < 0) & (rest <= (1 - MARGIN) * bounds) & (lowest > (1 + MARGIN) * bounds)
        found[decided] = k
        if k == len(columns) or bool((rest <= bounds).all()):
            break
        pivot = np.argmax(squares, axis=0)
        size = np.sqrt(squares[pivot, lanes])
        lowest = 3 * size / np.sqrt(4.0 ** (k + 1) + 6 * (k + 1) - 1)
        unit = columns[pivot, :, lanes].T / np.where(size > 0, size, 1.0)
        columns -= np.einsum("cpl,pl->cl", columns, unit)[:, None] * unit
    return found
