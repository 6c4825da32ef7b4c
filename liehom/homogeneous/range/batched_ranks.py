"""The ranks of many small matrices: singular values above a bound, counted without computing them.

Orthogonalization with pivoting is worked on all matrices at once, entry by entry.  After k steps the rest R, and the
length r of the last pivot, enclose the singular values on either side of k:

    s_(k+1) <= |R|_F,    s_k >= 3 r / (4^k + 6 k - 1)^(1/2)

Where the bound is between them, the rank is k; else the singular values decide.
"""

from __future__ import annotations

from typing import Any

import numpy as np

FEW, BLOCK = 64, 2048
SLACK = 1e-6


def batched_ranks(matrices: Any, bounds: Any) -> Any:
    """The numbers of singular values above a bound.

    Parameters
    ----------
    matrices : array of shape (..., p, q)
        In float64, finite.
    bounds : array of shape (...,)
        Well above round-off of the entries.

    Returns
    -------
    array of int, shape (...,)

    Notes
    -----
    The first bound is that of s_(k+1) by any matrix of rank k. The second is that of the inverse of a triangular
    factor with pivoting: Higham, Accuracy and Stability of Numerical Algorithms, theorem 8.14.

    Examples
    --------
    >>> batched_ranks(np.array([np.eye(2), np.diag([1.0, 0.0]), np.diag([1.0, 1e-12])] * 30), np.full(90, 1e-9))[:3]
    array([2, 1, 1])
    """
    lead, (p, q) = matrices.shape[:-2], matrices.shape[-2:]
    bounds = np.broadcast_to(bounds, lead)
    count = bounds.size
    if count < FEW or not p or not q:
        return _by_values(matrices, bounds)
    if p < q:
        matrices, p, q = np.swapaxes(matrices, -1, -2), q, p
    matrices, bounds = matrices.reshape(count, p, q), bounds.reshape(count)
    found = np.empty(count, dtype=int)
    for first in range(0, count, BLOCK):
        here = slice(first, first + BLOCK)
        found[here] = _by_pivots(np.array(matrices[here].transpose(2, 1, 0), order="C"), bounds[here])
    left = np.flatnonzero(found < 0)
    if len(left):
        found[left] = _by_values(matrices[left], bounds[left])
    return found.reshape(lead)


def _by_values(matrices: Any, bounds: Any) -> Any:
    return (np.linalg.svd(matrices, compute_uv=False) > bounds[..., None]).sum(axis=-1)


def _by_pivots(columns: Any, bounds: Any) -> Any:
    """The ranks of the matrices with these columns (q, p, L), which are overwritten; -1 where they are not decided."""
    found, lanes = np.full(bounds.shape, -1), np.arange(len(bounds))
    lowest = np.full(bounds.shape, np.inf)
    for k in range(len(columns) + 1):
        squares = np.einsum("cpl,cpl->cl", columns, columns)
        rest = np.sqrt(squares.sum(axis=0))
        decided = (found < 0) & (rest <= (1 - SLACK) * bounds) & (lowest > (1 + SLACK) * bounds)
        found[decided] = k
        if k == len(columns) or bool((rest <= bounds).all()):
            break
        pivot = np.argmax(squares, axis=0)
        size = np.sqrt(squares[pivot, lanes])
        lowest = 3 * size / np.sqrt(4.0 ** (k + 1) + 6 * (k + 1) - 1)
        unit = columns[pivot, :, lanes].T / np.where(size > 0, size, 1.0)
        columns -= np.einsum("cpl,pl->cl", columns, unit)[:, None] * unit
    return found
