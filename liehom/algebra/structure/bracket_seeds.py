"""Seeds of a Lie algebra: a few elements v whose brackets [v, g] span [g, g], and a complement of [g, g].

Two random elements will do for a semisimple algebra.  Every vector is then a sum of brackets with seeds and of
seeds, so that a linear map that respects brackets in some way is known from a few values.
"""

from __future__ import annotations

import random
from typing import Any, final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.scalars.modular.modular import invariant_hull_rank, pivot_columns

SUPPORT = 16
IDLE = 2
NARROW = 2
FEW_GENERATORS = 12
DIRECT_INVERSE = 100


@final
class BracketSeeds:
    """Seeds of an algebra over an exact field, with the brackets that they make.

    Attributes
    ----------
    seeds : list of ExactMatrix
        Rows (1, n).
    tables : list of ExactMatrix
        For the first seeds v, those whose brackets are used, the matrix (n, n) with rows [v, e_b].
    free : list of int
        Which seeds are a complement of the span of all these brackets, hence of [g, g].

    Examples
    --------
    >>> import liehom as lh
    >>> seeds = BracketSeeds(lh.so(6))
    >>> len(seeds.seeds), seeds.is_perfect(), seeds.center().nrows
    (2, True, 0)
    """

    def __init__(self, algebra: LieAlgebra) -> None:
        self.algebra = algebra
        self.field: Any = algebra.field
        self.n = algebra.dimension
        self.rng = random.Random(self.n)
        table = algebra.table
        # clearing denominators multiplies the bracket by a number, which changes no statement about it
        self._flat = table.dense().cleared().reshape(self.n, self.n**2) if table.is_dense() else None
        self.attempt = 0 if self._flat is None else self._best_prime()
        self._narrow: Any = None
        self._inverse: Any = None
        self._generating: list[Any] | None = None
        self.seeds: list[Any] = []
        self.tables: list[Any] = []
        self._grow()
        self._complete()

    def _best_prime(self) -> int:
        """The first prime, unless brackets are more independent modulo the second: then it divides their numbers."""
        flat: Any = self._flat
        tall = flat.reshape(self.n**2, self.n)
        ranks = [int(tall.modulo(a).rank()) + int(flat.modulo(a).rank()) for a in (0, 1)]
        return int(ranks[1] > ranks[0])

    def pivots(self, rows: Any) -> list[int]:
        """Indices of rows that are independent modulo a prime."""
        return pivot_columns(rows.modulo(self.attempt).transpose())

    # -- brackets ----------------------------------------------------------------------------------------
    def brackets(self, left: Any, right: Any) -> list[Any]:
        """For each row a of `left` the matrix with rows [left_a, right_b]."""
        if self._flat is None:
            return self.algebra.table.contract(left, right, self.field.identity(self.n))
        return [right @ block for block in (left @ self._flat).split_rows(self.n, self.n)]

    def narrow_brackets(self, left: Any, right: Any) -> list[Any]:
        """The same in a few columns, whose number is that of independent brackets where that is small."""
        if self._flat is None or NARROW * self.spanned > self.n or not self.tables:
            return self.brackets(left, right)
        if self._narrow is None:
            columns = self.pivots(self.field.stack_rows(self.tables, self.n).T)
            dense = self.algebra.table.dense().select(columns=columns)
            self._narrow = dense.reshape(self.n, self.n * len(columns))
        return [right @ block for block in (left @ self._narrow).split_rows(self.n, self.spanned)]

    def ads(self, left: Any) -> list[Any]:
        """For each row a of `left` the matrix with rows [left_a, e_b]."""
        if self._flat is None:
            return self.brackets(left, self.field.identity(self.n))
        return (left @ self._flat).split_rows(self.n, self.n)  # type: ignore[no-any-return]

    def random_rows(self, count: int) -> Any:
        """Random rows with entries -1, 0, 1; few are not 0 where the table is sparse, so that numbers remain small."""
        if self._flat is None:
            chosen = [self.rng.sample(range(self.n), SUPPORT) for _ in range(count)]
            rows = [[self.rng.choice((-1, 1)) if j in places else 0 for j in range(self.n)] for places in chosen]
        else:
            rows = [[self.rng.randint(-1, 1) for _ in range(self.n)] for _ in range(count)]
        return self.field.matrix(rows, (count, self.n))

    # -- seeds -------------------------------------------------------------------------------------------
    def _grow(self) -> None:
        rank = idle = 0
        while rank < self.n and idle < IDLE:
            v = self.random_rows(1)
            grown = [*self.tables, self.ads(v)[0]]
            found = int(self.field.stack_rows(grown, self.n).modulo(self.attempt).rank())
            if found == rank:
                idle += 1  # [v, g] of random v adds nothing: [g, g] is spanned
                continue
            self.seeds, self.tables, rank = [*self.seeds, v], grown, found
        self.spanned = rank

    def _complete(self) -> None:
        """Take unit vectors in as seeds where they are missing, and choose a basis among all rows."""
        n = self.n
        extended = self.field.stack_rows([*self.tables, *self.seeds, self.field.identity(n)], n)
        chosen = self.pivots(extended)
        first = len(self.tables) * n
        first_unit = first + len(self.seeds)
        units = [x - first_unit for x in chosen if x >= first_unit]
        self.seeds = self.seeds + [self.field.unit(n, i) for i in units]
        self._places = [x for x in chosen if x < first_unit] + [first_unit + i for i in range(len(units))]
        self.free = [x - first for x in self._places if x >= first]

    def is_perfect(self) -> bool:
        """Whether brackets are known to span the algebra: True is proved, False holds for nearly all primes."""
        return self.spanned == self.n

    def coordinates(self, rows: Any) -> tuple[int, list[Any], Any]:
        """For rows y an integer c, w_v and a_s with c y = sum_v [v, w_v] + sum_s a_s s.

        Returns
        -------
        int
            c > 0, which clears denominators, the same for all rows.
        list of ExactMatrix
            The w_v, (q, n) for each v that has a table.
        ExactMatrix
            The a_s, (q, number of seeds).
        """
        n, count = self.n, len(self.tables)
        basis = self.field.stack_rows([*self.tables, *self.seeds], n).select(rows=self._places)
        if self._inverse is None and (n <= DIRECT_INVERSE or rows.nrows >= n):
            self._inverse = basis.inverse()
        found = basis.T.solve(rows.T).T if self._inverse is None else rows @ self._inverse
        padded = self.field.stack_columns([found.cleared(), self.field.zeros(rows.nrows, 1)], rows.nrows)
        where = {x: i for i, x in enumerate(self._places)}
        moved = [padded.select(columns=[where.get(i * n + b, n) for b in range(n)]) for i in range(count)]
        return found.den, moved, padded.select(columns=[where.get(count * n + s, n) for s in range(len(self.seeds))])

    # -- generators --------------------------------------------------------------------------------------
    def generating(self) -> list[Any]:
        """The matrices with rows [x, e_b] for x in a set that generates the algebra, which is proved."""
        if self._generating is None:
            self._generating = self._few_generating() or self.ads(self.field.identity(self.n))
        return self._generating

    def _few_generating(self) -> list[Any] | None:
        if not 0 < len(self.seeds) <= FEW_GENERATORS:
            return None
        span = self.field.stack_rows(self.seeds, self.n)
        tables = self.ads(span)
        return tables if invariant_hull_rank(span, tables) == self.n else None

    def center(self) -> Any:
        """Rows of a basis of the centre: what commutes with generators."""
        if self.n == 0:
            return self.field.zeros(0, 0)
        wide = self.field.stack_columns(self.generating(), self.n)
        if int(wide.modulo(self.attempt).rank()) == self.n:
            return self.field.zeros(0, self.n)
        return wide.left_null_space()
