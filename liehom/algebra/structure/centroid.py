"""The centroid of a Lie algebra: the matrices phi with phi [x, y] = [phi x, y] for all x, y.

phi commutes with ad x for every x, so phi v commutes with all elements that commute with v.  It lies in the centre of
the centralizer C(v), which is a small space for generic v: for semisimple algebras it is a Cartan subalgebra.  The
brackets [v, g] with a few seed vectors v (`BracketSeeds`) span [g, g], and phi [v, y] = [phi v, y].  The unknowns are
therefore the values of phi on the seed vectors only.  The solutions of a few random equations are verified against a
generating set.
"""

from __future__ import annotations

from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.structure.bracket_seeds import BracketSeeds
from liehom.algebra.structure.commuting_maps import are_independent
from liehom.errors import InternalError
from liehom.scalars import ExactMatrix
from liehom.scalars.spaces.integral_basis import integral_basis

ROUNDS = 16  # sets of equations
MODULAR_ROUNDS = 8  # sets of equations after which independent ones are no longer chosen modulo a prime
REDUCED = 60  # dimension of the centroid up to which its basis is reduced to small integers


def centroid(algebra: LieAlgebra) -> tuple[ExactMatrix, ...]:
    """Implements `LieAlgebra.centroid`."""
    return centroid_of(BracketSeeds(algebra), None)


def centroid_of(seeds: BracketSeeds, center: ExactMatrix | None) -> tuple[ExactMatrix, ...]:
    """A basis of the centroid, or of a part of it, of the algebra with these seed vectors.

    Parameters
    ----------
    seeds : BracketSeeds
    center : ExactMatrix, optional
        A basis of the centre z, as rows. If it is given, the basis is one of a complement, in the centroid, of the
        maps g/[g, g] -> z. If z lies in [g, g] these maps are an ideal of square 0. The brackets of the seed vectors
        must be known to span [g, g].
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
            return (field.identity(n),)  # the identity is a solution, and the space has dimension 1
        if conditions.nrows > before:
            count = count if solved else 2 * count
            continue
        candidates = problem.maps(problem.reduced(conditions.null_space()))
        if problem.all_commute(candidates) and are_independent(candidates):
            return candidates
        count, solved = len(candidates) + 2 if not solved else 2 * count, True
    raise InternalError("centroid: the equations did not converge")


@final
class _Problem:
    """The linear equations for phi, with its values on the seed vectors as unknowns.

    Attributes
    ----------
    values : list of ExactMatrix
        For each seed vector v a basis, as rows, of a space that contains phi v for every phi of the centroid.
    size : int
        The number of unknowns, the sum of the dimensions of these spaces.
    """

    def __init__(self, seeds: BracketSeeds, center: ExactMatrix | None) -> None:
        self.seeds = seeds
        self.field = seeds.field
        self.n = seeds.n
        self.values = [self._allowed(i, v) for i, v in enumerate(seeds.vectors)]
        if center is not None and center.nrows:
            for i in seeds.free:
                self.values[i] = self._complement(center, self.values[i])
        self.size = sum(u.nrows for u in self.values)

    def chosen(self, blocks: list[ExactMatrix], exact: bool = False) -> ExactMatrix:
        """A basis of the span of the rows, or the first rows that are independent modulo a prime.

        Every row is a necessary condition, so a row that is left out makes no result wrong.
        """
        whole = self.field.stack_rows(blocks, blocks[0].ncols)
        return whole.row_space() if exact else whole.select(rows=self.seeds.pivots(whole))

    # -- unknowns ----------------------------------------------------------------------------------------
    def _allowed(self, index: int, v: ExactMatrix) -> ExactMatrix:
        """A space that contains phi v for every phi: the centralizer of v, reduced towards its centre."""
        tables = self.seeds.tables
        table = tables[index] if index < len(tables) else self.seeds.ads(v)[0]
        centralizing = table.left_null_space()
        if centralizing.nrows == self.n:  # v is central
            return self.seeds.center()
        return self._commuting(centralizing).primitive()

    def _commuting(self, whole: ExactMatrix) -> ExactMatrix:
        """The elements of a space that commute with random elements of it, more and more until none is lost."""
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

    def _complement(self, center: ExactMatrix, space: ExactMatrix) -> ExactMatrix:
        """Rows of a space that span a complement of the centre; all rows if they are not found modulo the prime."""
        k = center.nrows
        stacked = self.field.stack_rows([center, space], self.n)
        chosen = [x - k for x in self.seeds.pivots(stacked) if x >= k]
        return space.select(rows=chosen) if len(chosen) == space.nrows - k else space

    # -- equations ---------------------------------------------------------------------------------------
    def images(self, rows: ExactMatrix) -> tuple[int, list[ExactMatrix]]:
        """An integer c, and for each unknown the matrix (q, n) of its contributions to c phi y for the q rows y."""
        factor, moved, weights = self.seeds.coordinates(rows)
        made: list[ExactMatrix] = []
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

    def conditions(self, count: int, solved: bool) -> ExactMatrix:
        """Linear equations on the unknowns from random elements x and y, as rows.

        The equations are [phi x, y] = [x, phi y], which have small numbers, or phi [x, y] = [x, phi y] if `solved`,
        which need the coordinates of [x, y]. The first equations imply the others up to the centre.
        """
        made = self._solved_conditions(count) if solved else self._small_conditions(count)
        width = made[0].nrows * self.n
        return self.field.stack_rows([m.reshape(1, width) for m in made], width).T

    def _small_conditions(self, count: int) -> list[ExactMatrix]:
        """The equations [phi x, y] = [x, phi y], for y = sum_v [v, w_v] + sum_s a_s s with chosen w_v and a_s."""
        seeds, n, field = self.seeds, self.n, self.field
        size, tables = len(seeds.vectors), seeds.tables
        rng = seeds.rng
        mixed = [rng.randint(-1, 1) for _ in range(size)]
        x = field.matrix([mixed], (1, size)) @ field.stack_rows(seeds.vectors, n)
        table = seeds.ads(x)[0]
        moved = [seeds.random_rows(count) for _ in tables]
        weights = [[rng.randint(-1, 1) * (s in seeds.free) for s in range(size)] for _ in range(count)]
        direct = field.matrix(weights, (count, size))
        y = direct @ field.stack_rows(seeds.vectors, n)
        for w, t in zip(moved, tables, strict=True):
            y = y + w @ t
        made: list[ExactMatrix] = []
        for s, allowed in enumerate(self.values):
            column = direct.select(columns=[s])
            right = [column @ allowed.select(rows=[a]) for a in range(allowed.nrows)]
            if s < len(moved):
                right = [r + b for r, b in zip(right, seeds.brackets(allowed, moved[s]), strict=True)]
            left = seeds.brackets(allowed.scale(mixed[s]), y)
            made += [a - r @ table for a, r in zip(left, right, strict=True)]
        return made

    def _solved_conditions(self, count: int) -> list[ExactMatrix]:
        """The equations phi [x, y] = [x, phi y], and phi v = the value on v for phi v in terms of the unknowns."""
        seeds, field = self.seeds, self.field
        x, ys = seeds.ads(seeds.random_rows(1))[0], seeds.random_rows(count)
        given = [s for s in range(len(seeds.tables)) if s not in seeds.free]
        rows = field.stack_rows([ys @ x, ys, *(seeds.vectors[s] for s in given)], self.n)
        factor, images = self.images(rows)
        made = []
        owners = [(s, a) for s, allowed in enumerate(self.values) for a in range(allowed.nrows)]
        for (s, a), m in zip(owners, images, strict=True):
            moved = m.select(rows=range(count)) - m.select(rows=range(count, 2 * count)) @ x
            rest = m.select(rows=range(2 * count, m.nrows))
            if s in given:
                column = field.unit(len(given), given.index(s)).T
                rest = rest - column @ self.values[s].select(rows=[a]).scale(factor)
            made.append(field.stack_rows([moved, rest], self.n))
        return made

    def reduced(self, unknowns: ExactMatrix) -> list[ExactMatrix]:
        """For each seed vector s the values phi s as rows, for a basis of the solutions with small integers."""
        start, parts = 0, []
        for allowed in self.values:
            parts.append(unknowns.select(columns=range(start, start + allowed.nrows)) @ allowed)
            start += allowed.nrows
        whole = self.field.stack_columns(parts, unknowns.nrows)
        if whole.nrows <= REDUCED:
            whole = integral_basis(whole)
        n = self.n
        return [whole.select(columns=range(s * n, (s + 1) * n)) for s in range(len(parts))]

    def maps(self, values: list[ExactMatrix]) -> tuple[ExactMatrix, ...]:
        """Multiples of the matrices phi, on columns, with the given values on the seed vectors, one row per phi."""
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

    def all_commute(self, maps: tuple[ExactMatrix, ...]) -> bool:
        """Whether the maps commute with all ad x, which is decided by the x of a generating set."""
        for table in self.seeds.generating():
            adjoint = table.T
            if not all((phi @ adjoint - adjoint @ phi).is_zero() for phi in maps):
                return False
        return True
