"""Structure constants of sparse rational matrices, by dictionaries, at a cost that grows with the non-zero products."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from math import lcm
from typing import Any

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.budget import in_time
from liehom.scalars import ExactMatrix, Matrix, as_exact

Entries = dict[tuple[int, int], int]
ByIndex = dict[int, list[tuple[int, int, int]]]  # row or column -> (matrix, the other index, value)


def sparse_commutator_table(
    basis: Sequence[ExactMatrix], positions: list[int] | None, inverse: ExactMatrix | None
) -> StructureConstants | tuple[int, int]:
    """The bracket table of independent matrices over QQ, or the first pair whose commutator leaves the span.

    Parameters
    ----------
    basis : list of ExactMatrix
        Independent matrices (N, N) over QQ.
    positions : list of int, optional
        Flat indices of d entries that determine an element of the span; None if `exclusive_entries` finds them.
    inverse : ExactMatrix, optional
        The inverse of the (d, d) matrix of the basis at these entries; None if this matrix is diagonal.
    """
    n, d, field = basis[0].nrows, len(basis), basis[0].field
    den = lcm(*(a.den for a in basis))
    tables = [entries_of(a, den // a.den) for a in basis]
    if positions is None or inverse is None:
        rows: dict[int, list[tuple[int, Any]]] = {}
        for k, x in enumerate(exclusive_entries(tables, n) or []):
            rows[x] = [(k, field.one / field.convert(tables[k][divmod(x, n)]))]
    else:
        values = inverse.to_rows()
        rows = {p: [(k, v / den) for k, v in enumerate(values[x]) if v != 0] for x, p in enumerate(positions)}
    entries = []
    by_row, by_column = _by_index(tables)
    for i in range(d):
        for j, product in sorted(_commutators(i, tables, by_row, by_column).items()):
            coordinates: dict[int, Any] = {}
            for (r, c), v in product.items():
                for k, w in rows.get(r * n + c, ()):
                    coordinates[k] = coordinates.get(k, 0) + v * w
            kept = {k: v for k, v in coordinates.items() if v != 0}
            if not _equal(product, kept, tables):
                return i, j
            # product = den^2 [A_i, A_j] and tables = den A_k
            entries += [(i, j, k, v / den) for k, v in kept.items()]
    return StructureConstants(field, d, entries)


def entries_of(matrix: ExactMatrix, factor: int = 1) -> Entries:
    """The non-zero numerators of a matrix over QQ times a factor, as {(row, column): value}."""
    in_time()
    n = matrix.ncols
    entries = matrix.parts[0].entries()
    return {divmod(x, n): int(v) * factor for x, v in compress(enumerate(entries), entries)}


def exclusive_entries(tables: list[Entries], n: int) -> list[int] | None:
    """For each matrix the flat index of an entry where it alone is non-zero, or None if a matrix has no such entry."""
    count: dict[tuple[int, int], int] = {}
    for table in tables:
        for index in table:
            count[index] = count.get(index, 0) + 1
    found = []
    for table in tables:
        own = [index for index in table if count[index] == 1]
        if not own:
            return None
        found.append(own[0][0] * n + own[0][1])
    return found


def _by_index(tables: list[Entries]) -> tuple[ByIndex, ByIndex]:
    """The entries of all matrices by row, and by column."""
    by_row: ByIndex = {}
    by_column: ByIndex = {}
    for j, table in enumerate(tables):
        for (r, c), v in table.items():
            by_row.setdefault(r, []).append((j, c, v))
            by_column.setdefault(c, []).append((j, r, v))
    return by_row, by_column


def _commutators(i: int, tables: list[Entries], by_row: ByIndex, by_column: ByIndex) -> dict[int, Entries]:
    """The non-zero entries of A_i A_j - A_j A_i for all j > i, by j."""
    out: dict[int, Entries] = {}
    for (r, c), v in tables[i].items():
        for j, column, w in by_row.get(c, ()):
            if j > i:
                target = out.setdefault(j, {})
                target[r, column] = target.get((r, column), 0) + v * w
        for j, row, w in by_column.get(r, ()):
            if j > i:
                target = out.setdefault(j, {})
                target[row, c] = target.get((row, c), 0) - v * w
    return {j: {p: v for p, v in table.items() if v} for j, table in out.items()}


def _equal(product: Entries, coordinates: dict[int, Any], tables: list[Entries]) -> bool:
    """Whether a matrix is the combination of matrices with these coordinates."""
    rest: dict[tuple[int, int], Any] = dict(product)
    for k, v in coordinates.items():
        for index, w in tables[k].items():
            rest[index] = rest.get(index, 0) - v * w
    return all(v == 0 for v in rest.values())


def first_difference(basis: Sequence[Matrix], table: StructureConstants) -> tuple[int, int] | None:
    """The first pair i < j of matrices over QQ with [A_i, A_j] different from sum_k c[i, j, k] A_k, or None.

    Parameters
    ----------
    basis : list of ExactMatrix
        One matrix (N, N) over QQ for each basis element of the table.
    table : StructureConstants
        A bracket table over QQ.
    """
    exact = [as_exact(a) for a in basis]
    den = lcm(*(a.den for a in exact))
    tables = [entries_of(a, den // a.den) for a in exact]
    by_row, by_column = _by_index(tables)
    brackets: dict[int, dict[int, list[tuple[int, int]]]] = {}
    for (i, j), terms in table.by_pair().items():
        if i < j:
            brackets.setdefault(i, {})[j] = terms
    for i in range(len(basis)):
        products = _commutators(i, tables, by_row, by_column)
        expected = brackets.get(i, {})
        for j in sorted(products.keys() | expected.keys()):
            # products hold den^2 [A_i, A_j], tables den A_k, and the values of the table are over table.den
            rest = {index: v * table.den for index, v in products.get(j, {}).items()}
            for k, v in expected.get(j, ()):
                for index, w in tables[k].items():
                    rest[index] = rest.get(index, 0) - den * int(v) * w
            if any(rest.values()):
                return i, j
    return None
