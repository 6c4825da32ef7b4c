"""Exact matrices from the few entries that are not zero."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import flint

from liehom.scalars.fields.exact_field import ExactField, ExactMatrix


def matrix_of_places(
    field: ExactField, tables: Sequence[Mapping[int, int]], nrows: int, ncols: int, den: int = 1
) -> ExactMatrix:
    """The matrix with integer coordinates at flat places, zero elsewhere, over a common denominator.

    Parameters
    ----------
    field : ExactField
    tables : sequence of mappings
        One for each power of the integral generator: {row * ncols + column: integer}.
    nrows, ncols : int
    den : int

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(matrix_of_places(QQ, [{1: 2, 2: -1}], 2, 2, 2))
    [0, 1]
    [-1/2, 0]
    """
    parts = []
    for table in tables:
        part = flint.fmpz_mat(nrows, ncols)
        for place, value in table.items():
            part[place // ncols, place % ncols] = value
        parts.append(part)
    return ExactMatrix(field, tuple(parts), den).normalized()
