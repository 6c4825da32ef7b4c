"""Seed vectors of a Lie algebra g: a few elements v whose brackets [v, g] span [g, g], and a complement of [g, g].

For a semisimple algebra two random elements are enough.  Every vector of g is a sum of brackets [v, w] with seed
vectors v and of multiples of seed vectors, so a linear map that commutes with all ad x is determined by its values on
the seed vectors.
"""

from __future__ import annotations

import random
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.structure.exact_field import exact_field
from liehom.scalars import ExactField, ExactMatrix, as_exact
from liehom.scalars.modular.modular import invariant_hull_rank, pivot_columns

SUPPORT = 16  # non-zero entries of a random element of an algebra with a sparse table
IDLE = 2  # random elements without a new bracket after which [g, g] counts as spanned
NARROW = 2  # brackets are computed in selected columns if n is at least this many times dim [g, g]
FEW_GENERATORS = 12  # seed vectors that are tried as generators of the algebra
DIRECT_INVERSE = 100  # dimension up to which the matrix of the coordinates is inverted at once


@final
class BracketSeeds:
    """Seed vectors of an algebra over an exact field, with their brackets.

    Attributes
    ----------
    vectors : list of ExactMatrix
        The seed vectors, rows (1, n).
    tables : list of ExactMatrix
        The matrices (n, n) with rows [v, e_b] for the first seed vectors v, whose brackets are used.
    free : list of int
        Indices of seed vectors that span a complement of the span of all these brackets, hence of [g, g].

    Examples
    --------
    >>> import liehom as lh
    >>> seeds = BracketSeeds(lh.so(6))
    >>> len(seeds.vectors), seeds.is_perfect(), seeds.center().nrows
    (2, True, 0)
    """

    def __init__(self, algebra: LieAlgebra) -> None:
        self.algebra = algebra
        self.field: ExactField = exact_field(algebra, "centroids")
        self.n: int = algebra.dimension
        self.rng: random.Random = random.Random(self.n)
        table = algebra.table
        dense = as_exact(table.dense()) if table.is_dense() else None
        # clearing denominators multiplies the bracket by a number, which changes no statement about it
        self._flat: ExactMatrix | None = None if dense is None else dense.cleared().reshape(self.n, self.n**2)
        self.attempt: int = 0 if self._flat is None else self._best_prime(self._flat)
        self._narrow: ExactMatrix | None = None
        self._inverse: ExactMatrix | None = None
        self._generating: list[ExactMatrix] | None = None
        self.vectors: list[ExactMatrix] = []
        self.tables: list[ExactMatrix] = []
        self._grow()
        self._complete()

    def _best_prime(self, flat: ExactMatrix) -> int:
        """The number 0 or 1 of a prime: 1 if more brackets are independent modulo the second prime."""
        tall = flat.reshape(self.n**2, self.n)
        ranks = [int(tall.modulo(a).rank()) + int(flat.modulo(a).rank()) for a in (0, 1)]
        return int(ranks[1] > ranks[0])

    def pivots(self, rows: ExactMatrix) -> list[int]:
        """Indices of the first rows that are independent modulo the prime."""
        return pivot_columns(rows.modulo(self.attempt).transpose())

    # -- brackets ----------------------------------------------------------------------------------------
    def brackets(self, left: ExactMatrix, right: ExactMatrix) -> list[ExactMatrix]:
        """For each row a of `left` the matrix with rows [left_a, right_b]."""
        if self._flat is None:
            return self.algebra.table.contract(left, right, self.field.identity(self.n))
        return [right @ block for block in (left @ self._flat).split_rows(self.n, self.n)]

    def narrow_brackets(self, left: ExactMatrix, right: ExactMatrix) -> list[ExactMatrix]:
        """`brackets`, restricted to dim [g, g] columns that determine an element of [g, g] if these are few."""
        if self._flat is None or NARROW * self.spanned > self.n or not self.tables:
            return self.brackets(left, right)
        if self._narrow is None:
            columns = self.pivots(self.field.stack_rows(self.tables, self.n).T)
            self._narrow = (
                as_exact(self.algebra.table.dense()).select(columns=columns).reshape(self.n, self.n * len(columns))
            )
        return [right @ block for block in (left @ self._narrow).split_rows(self.n, self.spanned)]

    def ads(self, left: ExactMatrix) -> list[ExactMatrix]:
        """For each row a of `left` the matrix with rows [left_a, e_b]."""
        if self._flat is None:
            return self.brackets(left, self.field.identity(self.n))
        return (left @ self._flat).split_rows(self.n, self.n)

    def random_rows(self, count: int) -> ExactMatrix:
        """Random rows with entries -1, 0, 1, few of them non-zero if the table is sparse, to keep numbers small."""
        if self._flat is None:
            chosen = [self.rng.sample(range(self.n), SUPPORT) for _ in range(count)]
            rows = [[self.rng.choice((-1, 1)) if j in support else 0 for j in range(self.n)] for support in chosen]
        else:
            rows = [[self.rng.randint(-1, 1) for _ in range(self.n)] for _ in range(count)]
        return self.field.matrix(rows, (count, self.n))

    # -- seed vectors ----------------------------------------------------------------------------------
    def _grow(self) -> None:
        rank = idle = 0
        while rank < self.n and idle < IDLE:
            v = self.random_rows(1)
            grown = [*self.tables, self.ads(v)[0]]
            found = int(self.field.stack_rows(grown, self.n).modulo(self.attempt).rank())
            if found == rank:
                idle += 1  # [v, g] of random v adds nothing: [g, g] is spanned
                continue
            self.vectors, self.tables, rank = [*self.vectors, v], grown, found
        self.spanned = rank

    def _complete(self) -> None:
        """Add unit vectors to the seed vectors until, with all brackets, they span g; choose a basis among these."""
        n = self.n
        extended = self.field.stack_rows([*self.tables, *self.vectors, self.field.identity(n)], n)
        chosen = self.pivots(extended)
        first = len(self.tables) * n
        first_unit = first + len(self.vectors)
        units = [x - first_unit for x in chosen if x >= first_unit]
        self.vectors = self.vectors + [self.field.unit(n, i) for i in units]
        self._basis_rows = [x for x in chosen if x < first_unit] + [first_unit + i for i in range(len(units))]
        self.free: list[int] = [x - first for x in self._basis_rows if x >= first]

    def is_perfect(self) -> bool:
        """Whether [g, g] = g. True is proved; False is correct for all but finitely many primes."""
        return self.spanned == self.n

    def coordinates(self, rows: ExactMatrix) -> tuple[int, list[ExactMatrix], ExactMatrix]:
        """An integer c, vectors w_v and numbers a_s with c y = sum_v [v, w_v] + sum_s a_s s, for each row y.

        Returns
        -------
        int
            c > 0, which clears denominators, the same for all rows.
        list of ExactMatrix
            The w_v, (q, n) for each seed vector v that has a table.
        ExactMatrix
            The a_s, (q, number of seed vectors).
        """
        n, count = self.n, len(self.tables)
        basis = self.field.stack_rows([*self.tables, *self.vectors], n).select(rows=self._basis_rows)
        if self._inverse is None and (n <= DIRECT_INVERSE or rows.nrows >= n):
            self._inverse = basis.inverse()
        found = basis.T.solve(rows.T).T if self._inverse is None else rows @ self._inverse
        padded = self.field.stack_columns([found.cleared(), self.field.zeros(rows.nrows, 1)], rows.nrows)
        where = {x: i for i, x in enumerate(self._basis_rows)}
        moved = [padded.select(columns=[where.get(i * n + b, n) for b in range(n)]) for i in range(count)]
        return found.den, moved, padded.select(columns=[where.get(count * n + s, n) for s in range(len(self.vectors))])

    # -- generators --------------------------------------------------------------------------------------
    def generating(self) -> list[ExactMatrix]:
        """The matrices with rows [x, e_b] for the x of a set that is proved to generate the algebra."""
        if self._generating is None:
            self._generating = self._few_generating() or self.ads(self.field.identity(self.n))
        return self._generating

    def _few_generating(self) -> list[ExactMatrix] | None:
        """The matrices for the seed vectors, or None if they are many or not known to generate the algebra."""
        if not 0 < len(self.vectors) <= FEW_GENERATORS:
            return None
        span = self.field.stack_rows(self.vectors, self.n)
        tables = self.ads(span)
        return tables if invariant_hull_rank(span, tables) == self.n else None

    def center(self) -> ExactMatrix:
        """A basis of the centre, as rows: the vectors that commute with generators of the algebra."""
        if self.n == 0:
            return self.field.zeros(0, 0)
        wide = self.field.stack_columns(self.generating(), self.n)
        if int(wide.modulo(self.attempt).rank()) == self.n:
            return self.field.zeros(0, self.n)
        return wide.left_null_space()
