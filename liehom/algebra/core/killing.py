"""The Killing form from a bracket table."""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.scalars.spaces.sparse import SparseInteger

EXACT_FLOAT = 1 << 53


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
    if table.field.exact and table.field.degree == 1 and table.is_dense():
        found = _in_words(table)
        if found is not None:
            return found
    if table.is_dense() or table.field.degree > 1:
        flat = table.flat()
        swapped = flat.select(columns=[j * n + k for k in range(n) for j in range(n)])
        return flat @ swapped.T
    flat_sparse = table.sparse().reshape(n, n * n)
    j, k = flat_sparse.columns // n, flat_sparse.columns % n
    swapped_t = SparseInteger(k * n + j, flat_sparse.rows, flat_sparse.values, (n * n, n), flat_sparse.den)
    return (flat_sparse @ swapped_t).dense_blocks(table.field, 1, n, n)[0]  # type: ignore[arg-type]


def _in_words(table: StructureConstants) -> Any:
    """The same where no sum leaves the integers that float64 holds exactly, else None."""
    n, values = table.dimension, table.parts[0]
    largest = max(max(values), -min(values))
    if largest * largest * n * n >= EXACT_FLOAT:
        return None
    c = np.zeros((n, n, n))
    c[table.i, table.j, table.k] = values
    c[table.j, table.i, table.k] = [-v for v in values]
    form = c.reshape(n, n * n) @ c.transpose(0, 2, 1).reshape(n, n * n).T
    return table.field.from_integers(form.astype(np.int64).ravel().tolist(), n, n, table.den**2)  # type: ignore[attr-defined]
