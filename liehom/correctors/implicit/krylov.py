"""GMRES for many linear systems at once, each with the iterates that it has alone.

For lattices and other large systems, of which only the product of the matrix with a vector is known.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from liehom.typing import Array

MAX_VECTORS = 80
"""Largest dimension of a Krylov space; the solution of least residual in it is returned."""


def gmres(
    product: Callable[[Array], Array],
    right: Array,
    axes: tuple[int, ...],
    *,
    rtol: float = 1e-4,
    most: int = MAX_VECTORS,
) -> Array:
    """Approximate solutions of product(x) = right, of the shape of right, by the method of minimal residuals.

    Parameters
    ----------
    product : callable
        Linear; on arrays of the shape of `right`.
    right : array
    axes : tuple of int
        Axes of the coordinates of one system; the other axes are those of independent systems.
    rtol : float
        The iteration ends when all residuals are below rtol |right|.
    most : int

    Examples
    --------
    >>> a = np.array([[2.0, 1.0], [0.0, 3.0]])
    >>> gmres(lambda x: x @ a.T, np.array([[5.0, 6.0], [2.0, 0.0]]), (-1,), rtol=1e-12).round(9).tolist()
    [[1.5, 2.0], [1.0, 0.0]]
    """

    def norm(x: Array) -> Array:
        found: Array = np.sqrt((x * x).sum(axis=axes, keepdims=True))
        return found

    size = norm(right)
    basis = [right / np.where(size > 0, size, 1.0)]
    columns: list[list[Array]] = []
    weights: list[Array] = []
    for j in range(min(most, int(np.prod([right.shape[a] for a in axes])))):
        w = product(basis[j])
        column = []
        for v in basis:
            column.append((v * w).sum(axis=axes, keepdims=True))
            w = w - column[-1] * v
        column.append(norm(w))
        columns.append(column)
        ended = column[-1] <= 1e-14 * sum(np.abs(c) for c in column)
        basis.append(np.where(ended, 0.0, w / np.where(ended, 1.0, column[-1])))
        weights, residual = _least_squares(columns, size)
        if bool((residual <= rtol * size).all()):
            break
    total: Array = np.zeros_like(right)
    for c, v in zip(weights, basis, strict=False):
        total = total + c * v
    return total


def _least_squares(columns: list[list[Array]], size: Array) -> tuple[list[Array], Array]:
    """Weights of the basis vectors, and norms of the residuals, from the Hessenberg matrices."""
    j, lead = len(columns), size.shape
    h = np.zeros((*lead, j + 1, j))
    for k, column in enumerate(columns):
        for i, entry in enumerate(column):
            h[..., i, k] = entry
    first = np.zeros((*lead, j + 1, 1))
    first[..., 0, 0] = size
    found = np.linalg.pinv(np.nan_to_num(h)) @ first
    residual = np.sqrt(((h @ found - first) ** 2).sum(axis=(-1, -2)))
    return [found[..., k, 0] for k in range(j)], residual
