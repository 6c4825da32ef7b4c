"""Exact matrices from their non-zero entries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import flint

from liehom.scalars.fields.exact_field import ExactField, ExactMatrix


def matrix_from_entries(
    field: ExactField, tables: Sequence[Mapping[int, int]], nrows: int, ncols: int, den: int = 1
) -> ExactMatrix:
    """The matrix with the given integer coordinates at some indices and zero elsewhere, over a common denominator.

    Parameters
    ----------
    field : ExactField
    tables : sequence of mappings
        One for each power of the integral generator: {row * ncols + column: integer}.
    nrows, ncols : int
    den : int

    Returns
    -------
    ExactMatrix
        Shape (nrows, ncols).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(matrix_from_entries(QQ, [{1: 2, 2: -1}], 2, 2, 2))
    [0, 1]
    [-1/2, 0]
    """
    parts = []
    for table in tables:
        part = flint.fmpz_mat(nrows, ncols)
        for index, value in table.items():
            part[index // ncols, index % ncols] = value
        parts.append(part)
    return ExactMatrix(field, tuple(parts), den).normalized()
