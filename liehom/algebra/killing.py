"""The Killing form from a bracket table. Imports structure_constants, scalars."""

from __future__ import annotations

from typing import Any

from liehom.algebra.structure_constants import StructureConstants
from liehom.scalars.sparse import SparseInteger


def killing_form(table: StructureConstants) -> Any:
    """The matrix of K(e_a, e_b) = sum_{j,k} c[a, j, k] c[b, k, j].

    Examples
    --------
    >>> import liehom as lh
    >>> killing_form(lh.so(3).table).trace()
    -6
    """
    n = table.dimension
    if n == 0 or not len(table):
        return table.field.zeros(n, n)
    if table.is_dense() or table.field.degree > 1:
        flat = table.flat()
        swapped = flat.select(columns=[j * n + k for k in range(n) for j in range(n)])
        return flat @ swapped.T
    flat_sparse = table.sparse().reshape(n, n * n)
    j, k = flat_sparse.columns // n, flat_sparse.columns % n
    swapped_t = SparseInteger(k * n + j, flat_sparse.rows, flat_sparse.values, (n * n, n), flat_sparse.den)
    return (flat_sparse @ swapped_t).dense_blocks(table.field, 1, n, n)[0]  # type: ignore[arg-type]
