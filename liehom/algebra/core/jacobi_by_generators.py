"""Whether ad x is a derivation for all x in a generating set, by exact products in float64 or sparse int64.

Products of integers in float64 are exact as long as every sum stays below 2^53.  Either this bound is checked first, or
the numbers are reduced modulo primes below 2^22.
"""

from __future__ import annotations

import random
from typing import Any, TypeAlias

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.scalars import ExactMatrix
from liehom.scalars.modular.modular import invariant_hull_rank, small_residues
from liehom.typing import Array

EXACT = 1 << 53  # float64 holds all integers up to this one
WEIGHT = 2  # bound on the coefficients of the random elements
LARGEST = 320  # dimension up to which the dense table (n, n, n) is held in memory
SPARE = 20  # random elements beyond n before all basis elements are taken
CHUNK = 1 << 24  # entries of one dense product

SparseTable: TypeAlias = Any
"""A sparse array of scipy, which is imported only where it is used."""


def derivations_fit(table: StructureConstants) -> bool:
    """Whether `failure_in_floats` is exact for this table and fits in memory."""
    n = table.dimension
    if n > LARGEST or len(table.parts) > 1:
        return False
    size = max(map(abs, table.parts[0]), default=0)
    return 3 * n * size * (n * WEIGHT * size) < EXACT


def failure_in_floats(table: StructureConstants) -> tuple[int, int] | None:
    """A pair (i, j) on which ad x is not a derivation for some x of a generating set, or None if there is none.

    None proves the Jacobi identity. The table must pass `derivations_fit`.

    Examples
    --------
    >>> import liehom as lh
    >>> failure_in_floats(lh.so(4).table) is None
    True
    """
    dense = _dense(table, np.array(table.parts[0], dtype=np.float64))
    for x in generators(table):
        failing = _first_defect(dense, np.tensordot(x, dense, 1))
        if failing is not None:
            return failing
    return None


def failure_modulo_primes(table: StructureConstants) -> tuple[int, int] | None:
    """A pair (i, j) on which some ad x is not a derivation, or None, by arithmetic modulo primes.

    The entries may have any size and belong to a number field. An entry of the defect is an algebraic integer of
    bounded norm. A prime p with a residue map b -> r maps it to 0 only if p divides its norm, so entries that vanish
    modulo primes whose product exceeds the bound are 0.

    Examples
    --------
    >>> import liehom as lh
    >>> failure_modulo_primes(lh.so(4).over(lh.number_field("sqrt(2)")).table) is None
    True
    """
    n = table.dimension
    size = max((abs(v) for part in table.parts for v in part), default=0)
    bound = 3 * n * n * WEIGHT * size * size
    elements = generators(table)
    for p, root in small_residues(table.exact_field(), bound):
        values = np.zeros(len(table))
        power = 1
        for part in table.parts:
            values = (values + np.array([v % p for v in part], dtype=np.float64) * power) % p
            power = power * root % p
        dense = _dense(table, values) % p
        for x in elements:
            failing = _first_defect(dense, np.tensordot(x, dense, 1) % p, p)
            if failing is not None:
                return failing
    return None


def generators(table: StructureConstants) -> list[Array]:
    """Vectors (n,) with small integer entries that generate the algebra, which a rank modulo a prime shows."""
    n, field = table.dimension, table.exact_field()
    rng = random.Random(n)
    elements: list[list[int]] = []
    adjoints: list[ExactMatrix] = []
    while len(elements) <= n + SPARE:
        elements.append([rng.randint(-WEIGHT, WEIGHT) for _ in range(n)])
        rows = field.matrix(elements)
        adjoints.append(table.adjoint(rows.select(rows=[len(elements) - 1])).T)
        if invariant_hull_rank(rows, adjoints) == n:
            return [np.array(x, dtype=np.float64) for x in elements]
    return list(np.eye(n))


def _dense(table: StructureConstants, values: Array) -> Array:
    """The array (n, n, n) of the table with other values."""
    dense = np.zeros((table.dimension,) * 3)
    dense[table.i, table.j, table.k] = values
    dense[table.j, table.i, table.k] = -values
    return dense


def products_fit(table: StructureConstants) -> bool:
    """Whether `failure_in_slices` is exact for this table: no sum of its products leaves int64."""
    size = max(map(abs, table.parts[0]), default=0)
    return len(table.parts) == 1 and 3 * table.dimension * size * size < 1 << 62


def failure_in_slices(table: StructureConstants) -> tuple[int, int] | None:
    """A pair (i, j) on which some ad x is not a derivation, or None, by sparse products for large tables.

    One slice c[i, :, :] is treated at a time. The table must pass `products_fit`. The generators are sums of two
    basis elements, whose adjoints are nearly as sparse as the table.

    Examples
    --------
    >>> import liehom as lh
    >>> failure_in_slices(lh.so(4).table) is None
    True
    """
    n = table.dimension
    whole = _whole(table)
    slices = [_folded(whole[[i]], n) for i in range(n)]
    rng = random.Random(n)
    field = table.exact_field()
    elements: list[ExactMatrix] = []
    adjoints: list[ExactMatrix] = []
    while len(elements) <= n + SPARE:
        x = [0] * n
        for a in rng.sample(range(n), 2):
            x[a] = 1
        adjoint: SparseTable = sum(slices[a] for a in range(n) if x[a])  # row j: [x, e_j]
        failing = _first_defect_in_slices(whole, slices, adjoint)
        if failing is not None:
            return failing
        elements.append(field.matrix([x]))
        adjoints.append(field.from_integers(adjoint.toarray().ravel().tolist(), n, n))
        if len(elements) > 1 and invariant_hull_rank(field.stack_rows(elements, n), adjoints) == n:
            return None
    failures = (_first_defect_in_slices(whole, slices, block) for block in slices)
    return next((failing for failing in failures if failing is not None), None)


def _whole(table: StructureConstants) -> SparseTable:
    """The table as a sparse int64 matrix (n, n * n) with c[i, j, k] in row i, column j n + k."""
    from scipy import sparse

    n = table.dimension
    rows = np.concatenate([table.i, table.j])
    columns = np.concatenate([table.j * n + table.k, table.i * n + table.k])
    first = np.array(table.parts[0], dtype=np.int64)
    return sparse.coo_array((np.concatenate([first, -first]), (rows, columns)), shape=(n, n * n)).tocsr()


def _folded(row: SparseTable, n: int) -> SparseTable:
    """A sparse row of length n * n as a sparse matrix (n, n)."""
    from scipy import sparse

    found = row.tocoo()
    return sparse.coo_array((found.data, (found.col // n, found.col % n)), shape=(n, n)).tocsr()


def _first_defect_in_slices(
    whole: SparseTable, slices: list[SparseTable], adjoint: SparseTable
) -> tuple[int, int] | None:
    """The first (i, j) with [x, [e_i, e_j]] != [[x, e_i], e_j] + [e_i, [x, e_j]], or None; `adjoint` is ad x."""
    n = len(slices)
    for i, block in enumerate(slices):
        # rows j: [x, [e_i, e_j]] - [e_i, [x, e_j]] - [[x, e_i], e_j]
        defect = block @ adjoint - adjoint @ block - _folded(adjoint[[i]] @ whole, n)
        wrong = np.flatnonzero(defect.data)
        if len(wrong):
            return i, int(np.searchsorted(defect.indptr, wrong[0], side="right")) - 1
    return None


def _first_defect(dense: Array, adjoint: Array, p: int = 0) -> tuple[int, int] | None:
    """The first (i, j) with [x, [e_i, e_j]] != [[x, e_i], e_j] + [e_i, [x, e_j]] (modulo p if given), or None."""
    n = len(dense)
    step = max(1, CHUNK // (n * n))
    flat = dense.reshape(n, n * n)
    for low in range(0, n, step):
        rows = slice(low, min(low + step, n))
        outer = dense[rows] @ adjoint
        first = (adjoint[rows] @ flat).reshape(-1, n, n)
        second = np.matmul(adjoint, dense[rows])  # sum_l adjoint[j, l] c[i, l, m]
        defect = (outer % p - first % p - second % p) % p if p else outer - first - second
        wrong = np.argwhere(np.abs(defect).max(axis=2) > 0)
        if len(wrong):
            return int(wrong[0, 0]) + low, int(wrong[0, 1])
    return None
