"""Whether ad x is a derivation, for integer tables small enough that float64 products are exact.

Products of integers in float64 are exact as long as every sum stays below 2^53; the bound is checked before.
Imports structure_constants, scalars.
"""

from __future__ import annotations

import random
from typing import Any

import numpy as np

from liehom.algebra.structure_constants import StructureConstants
from liehom.scalars.modular import invariant_hull_rank

EXACT = 1 << 53
WEIGHT = 2
LARGEST = 320
CHUNK = 1 << 24


def derivations_fit(table: StructureConstants) -> bool:
    """Whether `failure_in_floats` is exact for this table and fits in memory."""
    n = table.dimension
    if n > LARGEST or len(table.parts) > 1:
        return False
    size = max(map(abs, table.parts[0]), default=0)
    return 3 * n * size * (n * WEIGHT * size) < EXACT


def failure_in_floats(table: StructureConstants) -> tuple[int, int] | None:
    """A pair (i, j) on which ad x is no derivation for some x of a generating set, or None: Jacobi holds.

    Examples
    --------
    >>> import liehom as lh
    >>> failure_in_floats(lh.so(4).table) is None
    True
    """
    n = table.dimension
    dense = np.zeros((n, n, n))
    values = np.array(table.parts[0], dtype=np.float64)
    dense[table.i, table.j, table.k] = values
    dense[table.j, table.i, table.k] = -values
    rng = random.Random(n)
    elements: list[Any] = []
    adjoints: list[Any] = []
    while len(elements) <= n + 20:
        x = [rng.randint(-WEIGHT, WEIGHT) for _ in range(n)]
        adjoint = np.tensordot(np.array(x, dtype=np.float64), dense, 1)  # row j: [x, e_j]
        failing = _first_defect(dense, adjoint)
        if failing is not None:
            return failing
        elements.append(table.field.matrix([x]))
        integers = adjoint.astype(np.int64).ravel().tolist()
        adjoints.append(table.field.from_integers(integers, n, n))  # type: ignore[attr-defined]
        span = table.field.stack_rows(elements, n)
        if invariant_hull_rank(span, adjoints) == n:
            return None
    return _all_pairs(dense)


def _first_defect(dense: Any, adjoint: Any) -> tuple[int, int] | None:
    """(i, j) with [x, [e_i, e_j]] != [[x, e_i], e_j] + [e_i, [x, e_j]], or None."""
    n = len(dense)
    step = max(1, CHUNK // (n * n))
    flat = dense.reshape(n, n * n)
    for low in range(0, n, step):
        rows = slice(low, min(low + step, n))
        outer = dense[rows] @ adjoint
        first = (adjoint[rows] @ flat).reshape(-1, n, n)
        second = np.matmul(adjoint, dense[rows])  # sum_l adjoint[j, l] c[i, l, m]
        wrong = np.argwhere(np.abs(outer - first - second).max(axis=2) > 0)
        if len(wrong):
            return int(wrong[0, 0]) + low, int(wrong[0, 1])
    return None


def _all_pairs(dense: Any) -> tuple[int, int] | None:
    for element in dense:
        failing = _first_defect(dense, element)
        if failing is not None:
            return failing
    return None
