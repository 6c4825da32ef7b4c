"""The centroid of a Lie algebra: the matrices phi with phi [x, y] = [phi x, y] for all x, y.

phi commutes with ad x for every x, so phi v commutes with whatever commutes with v: it lies in the centre of the
centralizer C(v), a small space when v is generic (for semisimple algebras a Cartan subalgebra).  A few seeds v have
brackets [v, g] that span [g, g], and phi [v, y] = [phi v, y]: the unknowns are the values on these v and on a
complement of [g, g] alone.  What a few equations leave is verified against a generating set.
"""

from __future__ import annotations

from typing import Any, final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.structure.bracket_seeds import BracketSeeds
from liehom.algebra.structure.commuting_maps import are_independent
from liehom.errors import FieldError, InternalError
from liehom.scalars.spaces.integral_basis import integral_basis

ROUNDS = 16
MODULAR_ROUNDS = 8
REDUCED = 60


def centroid(algebra: LieAlgebra) -> tuple[Any, ...]:
    """Implements `LieAlgebra.centroid`."""
    return centroid_of(seeds_of(algebra), None)


def seeds_of(algebra: LieAlgebra) -> BracketSeeds:
    """`BracketSeeds` of an algebra over an exact field; `FieldError` over float64."""
    if not algebra.field.exact:
        raise FieldError("the centroid is computed over exact fields only; give the structure constants as fractions")
    return BracketSeeds(algebra)


def centroid_of(seeds: BracketSeeds, center: Any) -> tuple[Any, ...]:
    """A basis of the centroid; given the centre z (rows), of a complement of the maps g/[g, g] -> z in it.

    Where z lies in [g, g] these maps are an ideal of square 0.  The centre may be given only where the brackets of
    the seeds are known to span [g, g].
    """
    field, n = seeds.field, seeds.n
    if n == 0:
        return ()
    problem = _Problem(seeds, center)
    conditions, solved = field.zeros(0, problem.size), False
    count = problem.size // (2 * max(seeds.spanned, 1)) + 1
    for attempt in range(ROUNDS):
        blocks = [conditions, problem.conditions(count, solved)]
        before, conditions = conditions.nrows, problem.chosen(blocks, exact=attempt > MODULAR_ROUNDS)
        if conditions.nrows == problem.size - 1:
            return (field.identity(n),)  # the identity is a solution, and nothing else is left
        if conditions.nrows > before:
            count = count if solved else 2 * count
            continue
        candidates = problem.maps(problem.reduced(conditions.null_space()))
        if problem.all_commute(candidates) and are_independent(candidates):
            return candidates
        count, solved = len(candidates) + 2 if not solved else 2 * count, True
    raise InternalError("centroid: the equations did not settle")


@final
class _Problem:
    """The values of phi on the seeds as unknowns."""

    def __init__(self, seeds: BracketSeeds, center: Any) -> None:
        self.seeds = seeds
        self.field = seeds.field
        self.n = seeds.n
        self.values = [self._allowed(i, v) for i, v in enumerate(seeds.seeds)]
        for i in seeds.free if center is not None and center.nrows else []:
            self.values[i] = self._complement(center, self.values[i])
        self.size = sum(u.nrows for u in self.values)

    def chosen(self, blocks: list[Any], exact: bool = False) -> Any:
        """A basis of the rows, or as many of them as the rank modulo a prime.

        Every row is a necessary condition, so leaving some out is no error.
        """
        whole = self.field.stack_rows(blocks, blocks[0].ncols)
        return whole.row_space() if exact else whole.select(rows=self.seeds.pivots(whole))

    # -- unknowns ----------------------------------------------------------------------------------------
    def _allowed(self, place: int, v: Any) -> Any:
        """A space that holds phi v for every phi: the centralizer of v cut down towards its centre."""
        tables = self.seeds.tables
        table = tables[place] if place < len(tables) else self.seeds.ads(v)[0]
        centralizing = table.left_null_space()
        if centralizing.nrows == self.n:  # v is central
            return self.seeds.center()
        return self._commuting(centralizing).primitive()

    def _commuting(self, whole: Any) -> Any:
        """The elements of a space that commute with many random elements of it: more until none is lost."""
        k = whole.nrows
        count, space = k // (2 * max(self.seeds.spanned, 1)) + 1, whole
        while count < 4 * k:
            weights = [[self.seeds.rng.choice((-1, 1)) for _ in range(k)] for _ in range(count)]
            elements = (self.field.matrix(weights, (count, k)) @ whole).primitive()
            images = [m.T for m in self.seeds.narrow_brackets(elements, space)]
            conditions = self.chosen(images)
            if conditions.nrows == 0:
                break
            space, count = conditions.null_space() @ space, 2 * count
        return space

    def _complement(self, center: Any, space: Any) -> Any:
        """Rows of a space that are a complement of the centre in it; all rows where a prime does not show them."""
        k = center.nrows
        stacked = self.field.stack_rows([center, space], self.n)
        chosen = [x - k for x in self.seeds.pivots(stacked) if x >= k]
        return space.select(rows=chosen) if len(chosen) == space.nrows - k else space

    # -- equations ---------------------------------------------------------------------------------------
    def images(self, rows: Any) -> tuple[int, list[Any]]:
        """An integer c, and for each unknown the matrix (q, n) whose rows are what it contributes to c phi y."""
        factor, moved, weights = self.seeds.coordinates(rows)
        made: list[Any] = []
        for s, allowed in enumerate(self.values):
            if s < len(moved):
                parts = self.seeds.brackets(allowed, moved[s])
            else:
                parts = [self.field.zeros(rows.nrows, self.n)] * allowed.nrows
            if s in self.seeds.free:
                direct = weights.select(columns=[s])
                parts = [p + direct @ allowed.select(rows=[a]) for a, p in enumerate(parts)]
            made += parts
        return factor, made

    def conditions(self, count: int, solved: bool) -> Any:
        """Equations on the unknowns, from random elements x and y, as rows.

        Either [phi x, y] = [x, phi y], with small numbers, or phi [x, y] = [x, phi y], where coordinates of [x, y]
        have to be found; the first imply the others up to the centre.
        """
        made = self._solved_conditions(count) if solved else self._small_conditions(count)
        width = made[0].nrows * self.n
        return self.field.stack_rows([m.reshape(1, width) for m in made], width).T

    def _small_conditions(self, count: int) -> list[Any]:
        """For y = sum_v [v, w_v] + sum_s a_s s with w and a chosen, phi y needs no solution of equations."""
        seeds, n, field = self.seeds, self.n, self.field
        size, tables = len(seeds.seeds), seeds.tables
        rng = seeds.rng
        mixed = [rng.randint(-1, 1) for _ in range(size)]
        x = field.matrix([mixed], (1, size)) @ field.stack_rows(seeds.seeds, n)
        table = seeds.ads(x)[0]
        moved = [seeds.random_rows(count) for _ in tables]
        weights = [[rng.randint(-1, 1) * (s in seeds.free) for s in range(size)] for _ in range(count)]
        direct = field.matrix(weights, (count, size))
        y = direct @ field.stack_rows(seeds.seeds, n)
        for w, t in zip(moved, tables, strict=True):
            y = y + w @ t
        made: list[Any] = []
        for s, allowed in enumerate(self.values):
            column = direct.select(columns=[s])
            right = [column @ allowed.select(rows=[a]) for a in range(allowed.nrows)]
            if s < len(moved):
                right = [r + b for r, b in zip(right, seeds.brackets(allowed, moved[s]), strict=True)]
            left = seeds.brackets(allowed.scale(mixed[s]), y)
            made += [a - r @ table for a, r in zip(left, right, strict=True)]
        return made

    def _solved_conditions(self, count: int) -> list[Any]:
        """phi [x, y] = [x, phi y], and phi v as it is expressed by other values is the value on the seed v."""
        seeds, field = self.seeds, self.field
        x, ys = seeds.ads(seeds.random_rows(1))[0], seeds.random_rows(count)
        given = [s for s in range(len(seeds.tables)) if s not in seeds.free]
        rows = field.stack_rows([ys @ x, ys, *(seeds.seeds[s] for s in given)], self.n)
        factor, images = self.images(rows)
        made = []
        owners = [(s, a) for s, allowed in enumerate(self.values) for a in range(allowed.nrows)]
        for (s, a), m in zip(owners, images, strict=True):
            moved = m.select(rows=range(count)) - m.select(rows=range(count, 2 * count)) @ x
            rest = m.select(rows=range(2 * count, m.nrows))
            if s in given:
                place = field.unit(len(given), given.index(s)).T
                rest = rest - place @ self.values[s].select(rows=[a]).scale(factor)
            made.append(field.stack_rows([moved, rest], self.n))
        return made

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
        _, moved, weights = self.seeds.coordinates(self.field.identity(self.n))
        totals = [self.field.zeros(self.n, self.n) for _ in range(values[0].nrows)]
        for s, images in enumerate(values):
            if s < len(moved):
                parts = self.seeds.brackets(images, moved[s])
                totals = [t + p for t, p in zip(totals, parts, strict=True)]
            if s in self.seeds.free:
                direct = weights.select(columns=[s])
                totals = [t + direct @ images.select(rows=[i]) for i, t in enumerate(totals)]
        return tuple(t.T.primitive() for t in totals)

    def all_commute(self, maps: tuple[Any, ...]) -> bool:
        """Whether the maps commute with ad x for all x: it is enough that they do for generators of the algebra."""
        for table in self.seeds.generating():
            adjoint = table.T
            if not all((phi @ adjoint - adjoint @ phi).is_zero() for phi in maps):
                return False
        return True
