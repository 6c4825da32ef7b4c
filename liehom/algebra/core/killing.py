"""The Killing form from a bracket table, by the cheapest exact product that the size of the numbers allows."""

from __future__ import annotations

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.scalars import ExactField, ExactMatrix, Matrix
from liehom.scalars.spaces.sparse import SparseInteger

EXACT_FLOAT = 1 << 53  # float64 holds all integers up to this one


def killing_form(table: StructureConstants) -> Matrix:
    """The matrix (n, n) of K(e_a, e_b) = sum_{j,k} c[a, j, k] c[b, k, j].

    Examples
    --------
    >>> import liehom as lh
    >>> killing_form(lh.so(3).table).trace()
    -6
    """
    n = table.dimension
    if n == 0 or not len(table):
        zero: Matrix = table.field.zeros(n, n)
        return zero
    field = table.field
    if isinstance(field, ExactField) and field.degree == 1 and table.is_dense():
        found = _by_floats(table, field)
        if found is not None:
            return found
    if not isinstance(field, ExactField) or table.is_dense() or field.degree > 1:
        flat = table.flat()
        swapped = flat.select(columns=[j * n + k for k in range(n) for j in range(n)])
        form: Matrix = flat @ swapped.T
        return form
    flat_sparse = table.sparse().reshape(n, n * n)
    j, k = flat_sparse.columns // n, flat_sparse.columns % n
    swapped_t = SparseInteger(k * n + j, flat_sparse.rows, flat_sparse.values, (n * n, n), flat_sparse.den)
    return (flat_sparse @ swapped_t).dense_blocks(field, 1, n, n)[0]


def _by_floats(table: StructureConstants, field: ExactField) -> ExactMatrix | None:
    """The Killing form over QQ by float64 products, or None if a sum could reach 2^53."""
    n, values = table.dimension, table.parts[0]
    largest = max(max(values), -min(values))
    if largest * largest * n * n >= EXACT_FLOAT:
        return None
    c = np.zeros((n, n, n))
    c[table.i, table.j, table.k] = values
    c[table.j, table.i, table.k] = [-v for v in values]
    form = c.reshape(n, n * n) @ c.transpose(0, 2, 1).reshape(n, n * n).T
    return field.from_integers(form.astype(np.int64).ravel().tolist(), n, n, table.den**2)
