"""Structure constants of sparse rational matrices, by dictionaries: cost grows with the non-zero products only."""

from __future__ import annotations

from math import lcm
from typing import Any

from liehom.algebra.core.structure_constants import StructureConstants

Entries = dict[tuple[int, int], int]


def sparse_commutator_table(
    basis: list[Any], places: list[int] | None, inverse: Any
) -> StructureConstants | tuple[int, int]:
    """The bracket table of independent matrices over QQ, or the first pair whose commutator leaves the span.

    Parameters
    ----------
    basis : list of ExactMatrix
        Independent, over QQ, (N, N).
    places : list of int, optional
        Flat positions of d entries that determine an element of the span; None when `exclusive_entries` has them.
    inverse : ExactMatrix, optional
        The inverse of the (d, d) matrix of the basis at these places; None where it is diagonal.
    """
    n, d, field = basis[0].nrows, len(basis), basis[0].field
    den = lcm(*(a.den for a in basis))
    tables = [entries_of(a, den // a.den) for a in basis]
    if places is None or inverse is None:
        places = exclusive_entries(tables, n)
        rows: dict[int, list[tuple[int, Any]]] = {}
        for k, place in enumerate(places or []):
            rows[place] = [(k, field.one / field.convert(tables[k][divmod(place, n)]))]
    else:
        values = inverse.to_rows()
        rows = {p: [(k, v / den) for k, v in enumerate(values[x]) if v != 0] for x, p in enumerate(places)}
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


def entries_of(matrix: Any, factor: int = 1) -> Entries:
    """The non-zero numerators of a matrix over QQ, times a factor, by position."""
    n = matrix.ncols
    found = enumerate(matrix.parts[0].entries())
    return {divmod(x, n): int(v) * factor for x, v in found if v}


def exclusive_entries(tables: list[Entries], n: int) -> list[int] | None:
    """For each matrix a flat position where it alone is non-zero, or None if one has no such position."""
    count: dict[tuple[int, int], int] = {}
    for table in tables:
        for place in table:
            count[place] = count.get(place, 0) + 1
    found = []
    for table in tables:
        own = [place for place in table if count[place] == 1]
        if not own:
            return None
        found.append(own[0][0] * n + own[0][1])
    return found


def _by_index(tables: list[Entries]) -> tuple[dict[int, Any], dict[int, Any]]:
    by_row: dict[int, list[tuple[int, int, int]]] = {}
    by_column: dict[int, list[tuple[int, int, int]]] = {}
    for j, table in enumerate(tables):
        for (r, c), v in table.items():
            by_row.setdefault(r, []).append((j, c, v))
            by_column.setdefault(c, []).append((j, r, v))
    return by_row, by_column


def _commutators(
    i: int, tables: list[Entries], by_row: dict[int, Any], by_column: dict[int, Any]
) -> dict[int, Entries]:
    """{j: A_i A_j - A_j A_i} for j > i, non-zero entries only."""
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
    rest: dict[tuple[int, int], Any] = dict(product)
    for k, v in coordinates.items():
        for place, w in tables[k].items():
            rest[place] = rest.get(place, 0) - v * w
    return all(v == 0 for v in rest.values())


def first_difference(basis: list[Any], table: StructureConstants) -> tuple[int, int] | None:
    """The first pair i < j of matrices over QQ with [A_i, A_j] different from sum_k c[i, j, k] A_k, or None.

    Parameters
    ----------
    basis : list of ExactMatrix
        One per basis element of the table, over QQ, (N, N).
    table : StructureConstants
        Over QQ.
    """
    den = lcm(*(a.den for a in basis))
    tables = [entries_of(a, den // a.den) for a in basis]
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
            rest = {place: v * table.den for place, v in products.get(j, {}).items()}
            for k, v in expected.get(j, ()):
                for place, w in tables[k].items():
                    rest[place] = rest.get(place, 0) - den * int(v) * w
            if any(rest.values()):
                return i, j
    return None
