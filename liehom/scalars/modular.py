"""Linear algebra modulo a prime: lower bounds for ranks, at machine speed.

A rank modulo a prime (a residue map of the field onto F_p) is at most the true rank, so reaching a bound
modulo p proves that it is reached.  Imports exact_matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import flint

from liehom.scalars.exact_matrix import ExactMatrix


def invariant_hull_rank(span: ExactMatrix, maps: Sequence[ExactMatrix]) -> int:
    """A lower bound (nearly always sharp) for the dimension of the least space of rows closed under maps.

    Parameters
    ----------
    span : ExactMatrix
        Rows to start from, shape (k, n).
    maps : sequence of ExactMatrix
        Matrices (n, n) acting on rows from the right.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> shift = QQ.matrix([[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    >>> invariant_hull_rank(QQ.matrix([[1, 0, 0]]), [shift])
    3
    """
    n = span.ncols
    images = [m.modulo() for m in maps]
    current, rank = _row_basis(span.modulo())
    before = -1
    while before < rank < n:
        before = rank
        current, rank = _row_basis(_stacked([current, *[current * image for image in images]]))
    return rank


def independent_rows(matrix: ExactMatrix, attempt: int = 0) -> list[int]:
    """Indices of rows that are independent (modulo a prime, hence truly), greedily from the first on.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> independent_rows(QQ.matrix([[1, 2], [2, 4], [0, 1]]))
    [0, 2]
    """
    return pivot_columns(matrix.T.modulo(attempt))


def pivot_columns(image: Any) -> list[int]:
    """The pivot columns of a matrix modulo a prime (``flint.nmod_mat``)."""
    reduced, rank = image.rref()
    pivots, column = [], 0
    for i in range(int(rank)):
        while int(reduced[i, column]) == 0:
            column += 1
        pivots.append(column)
        column += 1
    return pivots


def _row_basis(image: Any) -> tuple[Any, int]:
    reduced, rank = image.rref()
    n, rank = image.ncols(), int(rank)
    return flint.nmod_mat(rank, n, [int(x) for x in reduced.entries()[: rank * n]], image.modulus()), rank


def _stacked(blocks: list[Any]) -> Any:
    rows = sum(b.nrows() for b in blocks)
    entries = [int(x) for b in blocks for x in b.entries()]
    return flint.nmod_mat(rows, blocks[0].ncols(), entries, blocks[0].modulus())
