"""The centroid of a Lie algebra: the matrices phi with phi [x, y] = [phi x, y] for all x, y.

phi commutes with ad x for every x, so phi v commutes with whatever commutes with v: it lies in the centre of the
centralizer C(v), a small space when v is generic (for semisimple algebras a Cartan subalgebra).  A few v have
brackets [v, g] that span [g, g], and phi [v, y] = [phi v, y]: the unknowns are the values on these v and on a
complement of [g, g] alone.  What a few equations leave is verified against a generating set.
Imports lie_algebra, scalars, errors.
"""

from __future__ import annotations

import random
from typing import Any, final

from liehom.algebra.lie_algebra import LieAlgebra
from liehom.errors import FieldError, InternalError
from liehom.scalars.lattice import integral_basis
from liehom.scalars.modular import invariant_hull_rank, pivot_columns

WEIGHT = 1
FEW_GENERATORS = 12
DIRECT_INVERSE = 100
ROUNDS = 60
REDUCED = 60


def centroid(algebra: LieAlgebra) -> tuple[Any, ...]:
    """A basis of the centroid of a Lie algebra over an exact field.

    Parameters
    ----------
    algebra : LieAlgebra

    Returns
    -------
    tuple of Matrix
        Matrices phi, shape (n, n), acting on columns of coefficients. Proved: each is verified exactly, and the
        equations that define the space are necessary, so that no other matrix belongs to it.

    Raises
    ------
    FieldError
        Over float64, where the dimension of a null space is no fact.

    Notes
    -----
    The centroid is an associative algebra with one. It is commutative where the algebra is perfect or has no
    centre; for a simple algebra it is a field, the largest one over which the algebra can be seen.

    Examples
    --------
    >>> import liehom as lh
    >>> len(centroid(lh.so(3))), len(centroid(lh.so(4))), len(centroid(lh.so(3, 1)))
    (1, 2, 2)
    >>> print(centroid(lh.sl(2))[0])
    [1, 0, 0]
    [0, 1, 0]
    [0, 0, 1]
    """
    field, n = algebra.field, algebra.dimension
    if not field.exact:
        raise FieldError("the centroid is computed over exact fields only; give the structure constants as fractions")
    if n == 0:
        return ()
    problem = _Problem(algebra)
    conditions = field.zeros(0, problem.size)
    for _ in range(ROUNDS):
        conditions = field.stack_rows([conditions, problem.conditions()], problem.size).row_space()
        if conditions.nrows == problem.size - 1:
            return (field.identity(n),)  # the identity is in the centroid, and nothing else is left
        candidates = problem.maps(problem.reduced(conditions.null_space()))
        if problem.all_commute(candidates):
            return candidates
    raise InternalError("centroid: the equations did not settle")


@final
class _Problem:
    """The values of phi on seeds as unknowns; every vector as a sum of brackets with seeds and of seeds."""

    def __init__(self, algebra: LieAlgebra) -> None:
        self.algebra = algebra
        self.field = algebra.field
        self.n = algebra.dimension
        self.rng = random.Random(self.n)
        table = algebra.table
        self.flat = table.dense().reshape(self.n, self.n**2) if table.is_dense() else None
        self.seeds, self.bracketed, self.columns = self._spanning()
        self.values = [self._allowed(v, i) for i, v in enumerate(self.seeds)]
        self.size = sum(u.nrows for u in self.values)
        self._inverse: Any = None

    # -- brackets ----------------------------------------------------------------------------------------
    def brackets(self, left: Any, right: Any) -> list[Any]:
        """For each row a of `left` the matrix with rows [left_a, right_b]."""
        if self.flat is None:
            return self.algebra.table.contract(left, right, self.field.identity(self.n))
        return [right @ block for block in (left @ self.flat).split_rows(self.n, self.n)]

    def ads(self, left: Any) -> list[Any]:
        """For each row a of `left` the matrix with rows [left_a, e_b]."""
        if self.flat is None:
            return self.brackets(left, self.field.identity(self.n))
        return (left @ self.flat).split_rows(self.n, self.n)  # type: ignore[no-any-return]

    def random_rows(self, count: int) -> Any:
        rows = [[self.rng.randint(-WEIGHT, WEIGHT) for _ in range(self.n)] for _ in range(count)]
        return self.field.matrix(rows, (count, self.n))

    # -- unknowns ----------------------------------------------------------------------------------------
    def _spanning(self) -> tuple[list[Any], list[Any], list[int]]:
        """Seeds, the matrices [v, e_b] of those v that are used so, and a basis among all these rows.

        Places in the basis count the rows of the matrices first, then the seeds.
        """
        seeds: list[Any] = []
        tables: list[Any] = []
        rank = 0
        while rank < self.n:
            v = self.random_rows(1)
            grown = [*tables, self.ads(v)[0]]
            found = int(self.field.stack_rows(grown, self.n).modulo().rank())
            if found == rank:
                break  # [v, g] of a random v adds nothing: [g, g] is spanned
            seeds, tables, rank = [*seeds, v], grown, found
        extended = self.field.stack_rows([*tables, *seeds, self.field.identity(self.n)], self.n)
        chosen = pivot_columns(extended.modulo().transpose())
        first_unit = len(tables) * self.n + len(seeds)
        units = [x - first_unit for x in chosen if x >= first_unit]
        kept = [x for x in chosen if x < first_unit] + [first_unit + i for i in range(len(units))]
        return seeds + [self.field.unit(self.n, i) for i in units], tables, kept

    def _allowed(self, v: Any, place: int) -> Any:
        """A space that holds phi v for every phi: the centralizer of v cut down towards its centre."""
        table = self.bracketed[place] if place < len(self.bracketed) else self.ads(v)[0]
        space = centralizing = table.left_null_space()
        idle = 0
        while idle < 2 and space.nrows > 1:
            weights = [[self.rng.choice((-1, 1)) for _ in range(centralizing.nrows)]]
            element = self.field.matrix(weights, (1, centralizing.nrows)) @ centralizing
            images = space @ self.ads(element)[0]
            if images.is_zero():
                idle += 1
                continue
            space, idle = images.left_null_space() @ space, 0
        return space.primitive()

    # -- equations ---------------------------------------------------------------------------------------
    def coordinates(self, rows: Any) -> tuple[list[Any], Any]:
        """For rows y the w_v and a_s with c y = sum_v [v, w_v] + sum_s a_s s: matrices (q, n), and one (q, seeds).

        The integer c > 0 clears denominators and is the same for all rows.
        """
        n, tables = self.n, self.bracketed
        basis = self.field.stack_rows([*tables, *self.seeds], n).select(rows=self.columns)
        if self._inverse is None and (n <= DIRECT_INVERSE or rows.nrows >= n):
            self._inverse = basis.inverse()
        found = basis.T.solve(rows.T).T if self._inverse is None else rows @ self._inverse
        padded = self.field.stack_columns([found.cleared(), self.field.zeros(rows.nrows, 1)], rows.nrows)
        where = {x: i for i, x in enumerate(self.columns)}
        moved = [padded.select(columns=[where.get(i * n + b, n) for b in range(n)]) for i in range(len(tables))]
        first = len(tables) * n
        return moved, padded.select(columns=[where.get(first + s, n) for s in range(len(self.seeds))])

    def images(self, rows: Any) -> list[Any]:
        """For each unknown the matrix (q, n) whose rows are what it contributes to phi y, times a common integer."""
        moved, weights = self.coordinates(rows)
        made: list[Any] = []
        for s, allowed in enumerate(self.values):
            direct = weights.select(columns=[s])
            parts = [direct @ allowed.select(rows=[a]) for a in range(allowed.nrows)]
            if s < len(moved):
                parts = [p + b for p, b in zip(parts, self.brackets(allowed, moved[s]), strict=True)]
            made += parts
        return made

    def conditions(self) -> Any:
        """Equations on the unknowns: phi [x, y] = [x, phi y] for random x and y."""
        count = self.size // self.n + 2
        blocks = []
        for table in self.ads(self.random_rows(2)):
            ys = self.random_rows(count)
            both = self.images(self.field.stack_rows([ys @ table, ys], self.n))
            half = range(count), range(count, 2 * count)
            differences = [m.select(rows=half[0]) - m.select(rows=half[1]) @ table for m in both]
            blocks.append(self.field.stack_rows([d.reshape(1, count * self.n) for d in differences], count * self.n).T)
        return self.field.stack_rows(blocks, self.size)

    def reduced(self, unknowns: Any) -> list[Any]:
        """For each seed s the values phi s, one row for each row of unknowns; combined so that they are small."""
        start, parts = 0, []
        for allowed in self.values:
            parts.append(unknowns.select(columns=range(start, start + allowed.nrows)) @ allowed)
            start += allowed.nrows
        whole = self.field.stack_columns(parts, unknowns.nrows)
        if whole.nrows <= REDUCED:
            whole = integral_basis(whole)
        n = self.n
        return [whole.select(columns=range(s * n, (s + 1) * n)) for s in range(len(parts))]

    def maps(self, values: list[Any]) -> tuple[Any, ...]:
        """The matrices phi, on columns, with multiples of the given values on the seeds (one row a map)."""
        moved, weights = self.coordinates(self.field.identity(self.n))
        totals = [self.field.zeros(self.n, self.n) for _ in range(values[0].nrows)]
        for s, images in enumerate(values):
            direct = weights.select(columns=[s])
            parts = self.brackets(images, moved[s]) if s < len(moved) else None
            for i in range(len(totals)):
                if parts is not None:
                    totals[i] = totals[i] + parts[i]
                if not direct.is_zero():
                    totals[i] = totals[i] + direct @ images.select(rows=[i])
        return tuple(t.T.primitive() for t in totals)

    # -- proof -------------------------------------------------------------------------------------------
    def all_commute(self, maps: tuple[Any, ...]) -> bool:
        """Whether the maps commute with ad x for all x: it is enough that they do for generators of the algebra."""
        for table in self._generating():
            adjoint = table.T
            if not all((phi @ adjoint - adjoint @ phi).is_zero() for phi in maps):
                return False
        return True

    def _generating(self) -> list[Any]:
        """The matrices [x, e_b] for x in a set that generates the algebra, which is proved."""
        if len(self.seeds) <= FEW_GENERATORS:
            span = self.field.stack_rows(self.seeds, self.n)
            tables = self.ads(span)
            if invariant_hull_rank(span, tables) == self.n:
                return tables
        return self.ads(self.field.identity(self.n))
