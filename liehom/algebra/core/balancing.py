"""Lengths of basis elements for which the constants of a table over floats have similar sizes.

In the basis d_i e_i the constants are c_ijk d_i d_j / d_k. One error bounds the uncertainty of the whole table, so that
small constants are lost in it if basis elements have very different lengths. The logarithms of the d_i are the
least-squares solution of log |c_ijk| + log d_i + log d_j - log d_k = t, t free, for the constants above the error.
"""

from __future__ import annotations

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.scalars import FloatField
from liehom.typing import Array

RANGE = 1e6  # bound on the ratio of two lengths


def balanced(table: StructureConstants) -> tuple[StructureConstants, Array]:
    """The table over floats in the basis d_i e_i with its error, and the lengths d, an array (n,).

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.LieAlgebra({(0, 1): {2: 1e3}, (1, 2): {0: 1e-3}, (0, 2): {1: -1e-3}})
    >>> table, lengths = balanced(g.table)
    >>> [round(abs(v), 6) for *_, v in table], (lengths / lengths[0]).round(6).tolist()
    ([0.1, 0.1, 0.1], [1.0, 1.0, 1000.0])
    """
    n, field = table.dimension, table.field
    if not isinstance(field, FloatField):
        raise TypeError("tables are balanced over floats only")
    values = np.abs(np.asarray(table.parts[0], dtype=np.float64))
    kept = np.flatnonzero(values > table.error)
    if n < 2 or not len(kept):
        return table, np.ones(n)
    # a column for t, then normal equations with the signs of i, j, k
    columns = np.stack([table.i[kept], table.j[kept], table.k[kept], np.full(len(kept), n)])
    signs = np.array([1.0, 1.0, -1.0, -1.0])
    logs = np.log(values[kept])
    logs -= logs.mean()  # of the shortest solutions the one that does not depend on the scale of the table
    normal, right = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    size = n + 1
    for first, sign in zip(columns, signs, strict=True):
        right -= sign * np.bincount(first, logs, size)
        for second, other in zip(columns, signs, strict=True):
            normal += sign * other * np.bincount(first * size + second, minlength=size * size).reshape(size, size)
    exponents = np.linalg.lstsq(normal, right, rcond=1e-9)[0][:n]
    exponents -= exponents.mean()
    lengths = np.exp(np.clip(exponents, -np.log(RANGE) / 2, np.log(RANGE) / 2))
    constants = table.dense().to_numpy().reshape(n, n, n)
    constants = constants * (lengths[:, None, None] * (lengths[:, None] / lengths))
    error = table.error * float(np.prod(np.sort(lengths)[-2:])) / float(lengths.min())
    return StructureConstants.from_array(field, constants, error), lengths
