"""Chevalley-Eilenberg cohomology H^k(g, V)."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import comb, lcm
from operator import itemgetter
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import InputError, InternalError, RepresentationError, ShapeError, SingularError
from liehom.base.objects import Immutable
from liehom.base.typing import ScalarLike, VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.linear.closure import acting_matrices
from liehom.exact.algebra.linear.linear_bases import require_size
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.field import Field, MatricesLike, Matrix
from liehom.exact.scalars.floating import FloatField, FloatMatrix
from liehom.exact.scalars.modular import pivot_columns
from liehom.exact.scalars.sparse import matrix_from_entries
from liehom.exact.scalars.subspaces import Subspace

# The Chevalley-Eilenberg complex of a Lie algebra g with values in a module V, as matrices.
# A k-cochain is a row of length C(n, k) m, m = dim V. It lists the values w(e_i1, ..., e_ik) for i1 < ... < ik in the
# order of ``itertools.combinations``, with the coordinates of V innermost. The differential is
#
#     (dw)(x_0, ..., x_k) = sum_a (-1)^a rho(x_a) w(..., no x_a, ...)
#                         + sum_{a < b} (-1)^(a+b) w([x_a, x_b], ..., no x_a, no x_b, ...).

MAX_ENTRIES = 30_000_000
"""Largest number of entries of a dense matrix: a differential, or a block of it."""

MAX_COCHAINS = 300_000
"""Largest dimension of a space of cochains to which a differential is computed."""

Tables: TypeAlias = tuple[list[dict[tuple[int, int], Any]], int]
"""Numerators by row and column, one mapping for each coordinate of the field, and their common denominator."""


@final
class CochainComplex:
    """The cochains of g with values in V, and their differentials (each computed once)."""

    size: int

    __slots__ = ("_differentials", "_entries", "algebra", "matrices", "size")

    def __init__(self, algebra: LieAlgebra, matrices: MatricesLike | None = None, *, size: int | None = None) -> None:
        self.algebra: LieAlgebra = algebra
        self._differentials: dict[int, Matrix] = {}
        self._entries: dict[int, Tables] = {}
        self.matrices: tuple[Matrix, ...] | None = None
        self.size = 1
        if matrices is not None:
            self.matrices, self.size = acting_matrices(algebra, matrices, size, "give size")
            _prove_representation(algebra, self.matrices)

    def length(self, degree: int) -> int:
        """The dimension of the space of cochains of a degree, an int; 0 for negative degrees."""
        return comb(self.algebra.dimension, degree) * self.size if degree >= 0 else 0

    def differential(self, degree: int) -> Matrix:
        """The matrix of d from k-cochains to (k+1)-cochains; rows are multiplied with it from the right."""
        if degree not in self._differentials:
            shape = (self.length(degree), self.length(degree + 1))
            if shape[0] * shape[1] > MAX_ENTRIES:
                raise InputError(
                    f"the differential of cochains of degree {degree} has {shape[0]} x {shape[1]} entries, more than "
                    f"{MAX_ENTRIES}; a smaller degree is cheaper"
                )
            self._differentials[degree] = self._assembled(degree, shape)
        return self._differentials[degree]

    def index_tuples(self, degree: int) -> list[tuple[int, ...]]:
        """The increasing tuples of indices of a degree, in the order of the coordinates of cochains."""
        return list(itertools.combinations(range(self.algebra.dimension), degree)) if degree >= 0 else []

    # -- the matrix --------------------------------------------------------------------------------------
    def _assembled(self, degree: int, shape: tuple[int, int]) -> Matrix:
        field: Field[Matrix] = self.algebra.field
        if 0 in shape:
            return field.zeros(*shape)
        tables, den = self.tables(degree)
        if isinstance(field, ExactField):
            return block_of(field, tables, den, range(shape[0]), range(shape[1]))
        if not isinstance(field, FloatField):
            raise InputError(f"cochains over {field} are not supported")
        dense = np.zeros(shape)
        for place, value in tables[0].items():
            dense[place] = value
        n, table = self.algebra.dimension, self.algebra.table
        # a constant occurs in at most comb(n - 2, degree - 1) m entries, an entry is a sum of at most n constants
        occurrences = comb(max(n - 2, 0), max(degree - 1, 0)) * self.size * n
        action = math.hypot(*(a.error for a in self.matrices or () if isinstance(a, FloatMatrix)))
        error = math.hypot(table.error * math.sqrt(occurrences), action * math.sqrt(comb(n - 1, degree)))
        return FloatMatrix(field, dense, error)

    def tables(self, degree: int) -> Tables:
        """The non-zero entries of d on k-cochains, computed once."""
        if degree not in self._entries:
            self._entries[degree] = self._tables(degree)
        return self._entries[degree]

    def _tables(self, degree: int) -> Tables:
        if (length := self.length(degree + 1)) > MAX_COCHAINS:
            raise InputError(
                f"the cochains of degree {degree + 1} have {length} coordinates, more than {MAX_COCHAINS}; a smaller "
                "degree is cheaper"
            )
        field, table = self.algebra.field, self.algebra.table
        den, action = _integral(self.matrices or (), field)
        common = lcm(den, table.den)
        parts: list[dict[tuple[int, int], Any]] = [{} for _ in table.parts]
        if 0 <= degree < self.algebra.dimension:
            self._from_brackets(parts, degree, common // table.den)
            self._from_action(parts, degree, common // den, action)
        return [{place: value for place, value in part.items() if value} for part in parts], common

    def _from_brackets(self, parts: list[dict[tuple[int, int], Any]], degree: int, factor: int) -> None:
        """The second sum of d: each c[i, j, l] and each set R without i, j, l map R + l to R + i + j."""
        table, n, m = self.algebra.table, self.algebra.dimension, self.size
        source = {indices: x for x, indices in enumerate(self.index_tuples(degree))}
        target = {indices: x for x, indices in enumerate(self.index_tuples(degree + 1))}
        constants = list(zip(table.i.tolist(), table.j.tolist(), table.k.tolist(), strict=True))
        for rest in itertools.combinations(range(n), degree - 1) if degree else ():
            for entry, (i, j, l) in enumerate(constants):
                if i in rest or j in rest or l in rest:
                    continue
                at = bisect_left(rest, i), bisect_left(rest, j), bisect_left(rest, l)
                moved = (*rest[: at[2]], l, *rest[at[2] :])
                grown = (*rest[: at[0]], i, *rest[at[0] : at[1]], j, *rest[at[1] :])
                sign = -factor if (at[0] + at[1] + 1 + at[2]) % 2 else factor
                row, column = source[moved] * m, target[grown] * m
                for part, values in zip(parts, table.parts, strict=True):
                    for u in range(m if values[entry] else 0):
                        place = row + u, column + u
                        part[place] = part.get(place, 0) + sign * values[entry]

    def _from_action(
        self,
        parts: list[dict[tuple[int, int], Any]],
        degree: int,
        factor: int,
        action: list[list[list[tuple[int, Any]]]],
    ) -> None:
        """The first sum of d: the matrix of e_t maps S to S + t."""
        m = self.size
        source = {indices: x for x, indices in enumerate(self.index_tuples(degree))}
        for x, grown in enumerate(self.index_tuples(degree + 1) if action else ()):
            for a, t in enumerate(grown):
                start, sign = source[grown[:a] + grown[a + 1 :]] * m, -factor if a % 2 else factor
                for part, values in zip(parts, action[t], strict=True):
                    for index, value in values:
                        u, v = divmod(index, m)
                        place = start + v, x * m + u
                        part[place] = part.get(place, 0) + sign * value


def block_of(
    field: ExactField,
    tables: Sequence[Mapping[tuple[int, int], Any]],
    den: int,
    rows: Sequence[int],
    columns: Sequence[int],
) -> ExactMatrix:
    """The matrix of these rows and columns, which hold all the entries of the tables."""
    row, column = ({x: i for i, x in enumerate(chosen)} for chosen in (rows, columns))
    n = len(columns)
    flat = [{row[r] * n + column[c]: value for (r, c), value in table.items()} for table in tables]
    return matrix_from_entries(field, flat, len(rows), n, den)


def _integral(matrices: Sequence[Matrix], field: Field) -> tuple[int, list[list[list[tuple[int, Any]]]]]:
    """A common denominator, and for each matrix and field coordinate the non-zero numerators by flat index."""
    if not field.exact:
        return 1, [[[(x, v) for x, v in enumerate(a.entries()) if v != 0]] for a in matrices]
    exact = [as_exact(a) for a in matrices]
    den = lcm(*(a.den for a in exact))
    scaled = ((a, den // a.den) for a in exact)
    return den, [
        [[(x, int(v) * factor) for x, v in enumerate(part.entries()) if v] for part in a.parts] for a, factor in scaled
    ]


def _prove_representation(algebra: LieAlgebra, matrices: tuple[Matrix, ...]) -> None:
    n, field = algebra.dimension, algebra.field
    if n == 0 or matrices[0].nrows == 0:
        return
    m = matrices[0].nrows
    flat = field.stack_rows([a.reshape(1, m * m) for a in matrices], m * m)
    one = field.identity(n)
    for i, block in enumerate(algebra.table.contract(one, one, flat)):
        for j in range(i + 1, n):
            left = block.select(rows=[j]).reshape(m, m)
            if not (left - matrices[i] @ matrices[j] + matrices[j] @ matrices[i]).is_zero():
                x, y = algebra.basis_names[i], algebra.basis_names[j]
                raise RepresentationError(
                    (i, j),
                    f"the matrices are not a representation: rho([{x}, {y}]) differs from the commutator of rho({x}) "
                    f"and rho({y})",
                )


# Chevalley-Eilenberg cohomology H^k(g, V) of a Lie algebra, with cocycles that represent its classes.
# Ranks modulo a prime bound dim H^k from above, which proves H^k = 0 if the bound is 0. Otherwise a complement of the
# coboundaries is computed exactly: the cocycles that vanish at indices where the coboundaries are independent modulo
# the prime.

CochainLike: TypeAlias = VectorLike | Matrix
"""A cochain: its coordinates as a sequence of numbers, or a row matrix."""

MAX_PRIMES = 5
"""Number of primes that are tried before the computation fails."""


@final
class Cohomology(Immutable):
    """The cohomology of a Lie algebra in one degree, the result of `LieAlgebra.cohomology`.

    A cochain is a row, as in `liehom.exact.algebra.structure.cohomology`. `cochain` and `values` translate it from and
    to its values on basis elements.

    Attributes
    ----------
    cochains : CochainComplex
        The complex, with the algebra g and the module V.
    degree : int
        k.
    representatives : Matrix
        Cocycles, one row for each member of a basis of H^k.

    Examples
    --------
    >>> import liehom as lh
    >>> h2 = lh.heisenberg(1).cohomology(2)
    >>> h2.dimension, [h2.values(row) for row in h2.representatives.to_rows()]
    (2, [{(0, 2): 1}, {(1, 2): 1}])
    >>> h2.is_coboundary(h2.cochain({(0, 1): 5}))
    True
    """

    __slots__ = ("cochains", "degree", "representatives")

    def __init__(self, cochains: CochainComplex, degree: int, representatives: Matrix) -> None:
        self.cochains: CochainComplex = cochains
        self.degree: int = degree
        self.representatives: Matrix = representatives

    # -- properties --------------------------------------------------------------------------------------
    @property
    def algebra(self) -> LieAlgebra:
        """The Lie algebra g."""
        return self.cochains.algebra

    @property
    def dimension(self) -> int:
        """dim H^k(g, V), an int."""
        return int(self.representatives.nrows)

    # -- verbs -------------------------------------------------------------------------------------------
    def coboundaries(self) -> Subspace:
        """The subspace of coboundaries d w, for cochains w of degree k - 1."""
        return Subspace(self.algebra.field, self.cochains.differential(self.degree - 1), self._length())

    def cocycles(self) -> Subspace:
        """The subspace of cocycles."""
        return self.coboundaries() + Subspace(self.algebra.field, self.representatives, self._length())

    def is_cocycle(self, cochain: CochainLike) -> bool:
        """Whether d w = 0 for a cochain w."""
        row, field = self._row(cochain), self.algebra.field
        if not isinstance(field, ExactField):
            return bool((row @ self.cochains.differential(self.degree)).is_zero())
        support = [i for i, x in enumerate(row.row(0)) if x != 0]
        (tables, den), inside = self.cochains.tables(self.degree), set(support)
        parts = [{place: x for place, x in part.items() if place[0] in inside} for part in tables]
        columns = sorted({column for part in parts for _, column in part})
        return (as_exact(row).select(columns=support) @ block_of(field, parts, den, support, columns)).is_zero()

    def is_coboundary(self, cochain: CochainLike) -> bool:
        """Whether a cochain w is d v for some v."""
        try:
            self.potential(cochain)
        except SingularError:
            return False
        return True

    def potential(self, cochain: CochainLike) -> Matrix:
        """A cochain v with d v = w, as a row matrix; raises `SingularError` if w is not a coboundary."""
        row, before = self._row(cochain), self.cochains.differential(self.degree - 1)
        if row.is_zero():
            field: Field[Matrix] = self.algebra.field
            return field.zeros(1, before.nrows)
        if 0 in before.shape:
            raise SingularError("the cochain is not zero, and there are no coboundaries")
        return before.T.solve(row.T).T

    def coordinates(self, cochain: CochainLike) -> Matrix:
        """The class of a cocycle in the basis of the representatives, as a row matrix (1, dim H^k)."""
        row = self._row(cochain)
        field: Field[Matrix] = self.algebra.field
        if not self.is_cocycle(row):
            raise InputError("the cochain is not a cocycle: it has no class")
        if self.dimension == 0 or row.is_zero():
            return field.zeros(1, self.dimension)
        rows = field.stack_rows([self.representatives, self.cochains.differential(self.degree - 1)], self._length())
        return rows.T.solve(row.T).T.select(columns=range(self.dimension))

    def cochain(self, values: Mapping[Any, ScalarLike | VectorLike]) -> Matrix:
        """The cochain with given values on basis elements, as a row matrix.

        Parameters
        ----------
        values : mapping
            From k different indices (a tuple, or one index if k = 1) to a number, or to the coordinates of a vector of
            V if dim V is not 1. The order of the indices determines the sign; other values are 0.
        """
        field, m, n = self.algebra.field, self.cochains.size, self.algebra.dimension
        position = {indices: x for x, indices in enumerate(self.cochains.index_tuples(self.degree))}
        entries = [field.zero] * self._length()
        for key, value in values.items():
            indices = tuple(key) if isinstance(key, tuple) else (key,)
            ordered = tuple(sorted(indices)) if all(isinstance(i, int) for i in indices) else indices
            if ordered not in position:
                raise InputError(f"{key!r} is not a tuple of {self.degree} different indices from 0 to {n - 1}")
            vector = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
            if len(vector) != m:
                raise ShapeError(f"the value at {key!r} has {len(vector)} coordinates, expected {m}")
            odd = sum(a > b for x, a in enumerate(indices) for b in indices[x + 1 :]) % 2
            for u, v in enumerate(map(field.convert, vector)):
                entries[position[ordered] * m + u] += -v if odd else v
        return field.from_entries(entries, 1, self._length())

    def values(self, cochain: CochainLike) -> dict[tuple[int, ...], Any]:
        """The non-zero values by increasing indices: numbers, or lists of coordinates if dim V is not 1."""
        row, m = self._row(cochain).row(0), self.cochains.size
        blocks = {p: row[x * m : (x + 1) * m] for x, p in enumerate(self.cochains.index_tuples(self.degree))}
        return {p: v[0] if m == 1 else v for p, v in blocks.items() if any(x != 0 for x in v)}

    def forms(self) -> list[Matrix]:
        """Antisymmetric matrices of the representatives of degree 2 with values in R, for `central_extension`.

        Examples
        --------
        >>> import liehom as lh
        >>> form = lh.abelian(2).cohomology(2).forms()[0]
        >>> lh.algebra.central_extension(lh.abelian(2), form) == lh.heisenberg(1)
        True
        """
        if self.degree != 2 or self.cochains.size != 1:
            raise InputError(f"only cochains of degree 2 with values in R are matrices; here k = {self.degree}")
        n, field = self.algebra.dimension, self.algebra.field
        forms = []
        for row in self.representatives.to_rows():
            rows = [[field.zero] * n for _ in range(n)]
            for (i, j), v in self.values(row).items():
                rows[i][j], rows[j][i] = v, -v
            forms.append(field.matrix(rows, (n, n)))
        return forms

    def _length(self) -> int:
        return self.cochains.length(self.degree)

    def _row(self, cochain: CochainLike) -> Matrix:
        field, length = self.algebra.field, self._length()
        row: Matrix = field.read(cochain) if isinstance(cochain, Matrix) else field.matrix([cochain], (1, length))
        if row.shape != (1, length):
            raise ShapeError(f"a cochain of degree {self.degree} is a row of length {length}, got shape {row.shape}")
        return row

    def __repr__(self) -> str:
        g = self.algebra.name or f"a Lie algebra of dimension {self.algebra.dimension}"
        module = "" if self.cochains.matrices is None else f" with values in dimension {self.cochains.size}"
        return f"<H^{self.degree} of {g}{module}: dimension {self.dimension}>"


def cohomology(
    algebra: LieAlgebra, degree: int, matrices: MatricesLike | None = None, *, size: int | None = None
) -> Cohomology:
    """Implements `LieAlgebra.cohomology`."""
    require_size("degree", degree, 0)
    degree = int(degree)
    cochains = CochainComplex(algebra, matrices, size=size)
    field, length = algebra.field, cochains.length(degree)
    if length == 0:
        return Cohomology(cochains, degree, field.zeros(0, 0))
    if not field.exact:
        # cochains in the kernel of d that are orthogonal to the coboundaries
        after, before = cochains.differential(degree), cochains.differential(degree - 1)
        conditions = field.stack_rows([after.T, before], length)
        return Cohomology(cochains, degree, conditions.null_space("the dimension of the cohomology"))
    if degree in (1, 2) and algebra.is_semisimple():
        return Cohomology(cochains, degree, field.zeros(0, length))  # Whitehead's lemmas
    return Cohomology(cochains, degree, _Solver(cochains).complement(degree))


@dataclass(slots=True)
class _Block:
    """A direct summand of C^(k-1) -> C^k -> C^(k+1), spanned by cochains of the basis."""

    before: Tables
    after: Tables
    low: list[int]  # indices of cochains of degree k - 1
    middle: list[int]
    high: list[int]

    def differentials(self, field: ExactField) -> tuple[ExactMatrix, ExactMatrix]:
        """The two maps of the summand."""
        if len(self.middle) * max(len(self.low), len(self.high)) > MAX_ENTRIES:
            raise InputError(
                f"a block of the differential has {len(self.middle)} rows and {len(self.high)} columns, more than "
                f"{MAX_ENTRIES} entries; a smaller degree is cheaper"
            )
        before = block_of(field, *self.before, self.low, self.middle)
        return before, block_of(field, *self.after, self.middle, self.high)


def _blocks(cochains: CochainComplex, degree: int) -> list[_Block]:
    """The finest decomposition into summands that are spanned by cochains of the basis: weights separate these."""
    (before, first_den), (after, second_den) = cochains.tables(degree - 1), cochains.tables(degree)
    parent = {(1, x): (1, x) for x in range(cochains.length(degree))}

    def root(x: tuple[int, int]) -> tuple[int, int]:
        parent.setdefault(x, x)
        while parent[x] != x:
            parent[x] = parent[parent[x]]
            x = parent[x]
        return x

    for step, tables in enumerate((before, after)):
        for row, column in (place for part in tables for place in part):
            parent[root((step, row))] = root((step + 1, column))
    found: dict[tuple[int, int], tuple[list[int], list[int], list[int]]] = {}
    for level, x in sorted(parent):
        found.setdefault(root((level, x)), ([], [], []))[level].append(x)
    made = {
        key: _Block(([{} for _ in after], first_den), ([{} for _ in after], second_den), *own)
        for key, own in found.items()
    }
    for step, tables in enumerate((before, after)):
        for s, part in enumerate(tables):
            for place, value in part.items():
                block = made[root((step, place[0]))]
                (block.after if step else block.before)[0][s][place] = value
    return list(made.values())


class _Solver:
    """Complements of the coboundaries in the cocycles, degree by degree, over an exact field."""

    def __init__(self, cochains: CochainComplex) -> None:
        self.cochains = cochains
        self.complement = cache(self._complement)

    def rank(self, degree: int) -> int:
        """The exact rank of d on k-cochains, an int."""
        length = self.cochains.length(degree)
        if length == 0 or self.cochains.length(degree + 1) == 0:
            return 0
        # C^k = coboundaries + complement + (a complement of the kernel of d)
        return length - self.rank(degree - 1) - int(self.complement(degree).nrows)

    def _complement(self, degree: int) -> Matrix:
        """Cocycles that are a basis of the cocycles modulo the coboundaries, as rows."""
        length = self.cochains.length(degree)
        field = as_exact(self.cochains.algebra.field.zeros(0, 0)).field
        blocks = _blocks(self.cochains, degree)
        maps = [block.differentials(field) for block in blocks]
        for attempt in range(MAX_PRIMES):
            pivots = [tuple(_pivots(matrix, attempt) for matrix in pair) for pair in maps]
            bounding = sum(len(first) for first, _ in pivots)
            if bounding + sum(len(second) for _, second in pivots) == length:
                # the ranks modulo a prime are at most the true ones, whose sum is at most the length
                return field.zeros(0, length)
            if bounding < self.rank(degree - 1):
                continue
            chosen = zip(blocks, maps, pivots, strict=True)
            cocycles = [
                (b, _cocycles(after, *own)) for b, (_, after), own in chosen if sum(map(len, own)) < len(b.middle)
            ]
            if all(rows is not None for _, rows in cocycles):
                return _placed([(b.middle, rows) for b, rows in cocycles if rows is not None], field, length)
        raise InternalError(f"no prime was usable for the cohomology of {self.cochains.algebra!r} in degree {degree}")


def _pivots(matrix: ExactMatrix, attempt: int) -> list[int]:
    """Indices of columns that are a basis of the column space modulo a prime."""
    return [] if 0 in matrix.shape else pivot_columns(matrix.modulo(attempt))


def _cocycles(after: ExactMatrix, bounding: list[int], needed: list[int]) -> ExactMatrix | None:
    """The cocycles that are 0 at the indices `bounding`, as rows, from `needed` equations; None if these miss one."""
    field, count = after.field, after.nrows
    kept = sorted(set(range(count)) - set(bounding))
    solved = after.select(kept, needed).left_null_space() if needed else field.identity(len(kept))
    rows = solved @ field.identity(count).select(rows=kept)
    return rows if (rows @ after).is_zero() else None


def _placed(parts: list[tuple[list[int], ExactMatrix]], field: ExactField, length: int) -> ExactMatrix:
    """Rows on some of the coordinates each as rows on all, ordered by their last coordinate that is not 0."""
    den = lcm(*(rows.den for _, rows in parts))
    entries: list[tuple[int, list[dict[int, Any]]]] = []
    for places, rows in parts:
        for i in range(rows.nrows):
            own = [{c: a[i, j] * (den // rows.den) for j, c in enumerate(places) if a[i, j]} for a in rows.parts]
            entries.append((max(c for part in own for c in part), own))
    entries.sort(key=itemgetter(0))
    tables = [
        {r * length + c: x for r, (_, own) in enumerate(entries) for c, x in own[s].items()}
        for s in range(field.degree)
    ]
    return matrix_from_entries(field, tables, len(entries), length, den)
