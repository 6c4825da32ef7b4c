"""The centroid of a Lie algebra, by seed vectors."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from functools import reduce
from itertools import accumulate, pairwise
from operator import add
from typing import final

from liehom.base.errors import InternalError, SingularError, UndecidedError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.modular import invariant_hull_rank, pivot_columns, stacked_residues
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import integral_basis

# The exact field of an algebra, for algorithms that a rounding error would turn into a guess.


def exact_field(algebra: LieAlgebra, result: str) -> ExactField:
    """The field of an algebra, if it is exact."""
    if not isinstance(algebra.field, ExactField):
        raise UndecidedError(
            f"{result} are computed over exact fields only, because rounding decides them; make the algebra exact by "
            "lh.rationalize(algebra, max_denominator=...), or build it over QQ or a number field"
        )
    return algebra.field


# Seed vectors of a Lie algebra g: a few elements v whose brackets [v, g] span [g, g], and a complement of [g, g].
# For a semisimple algebra two random elements are enough.  Every vector of g is a sum of brackets [v, w] with seed
# vectors v and of multiples of seed vectors, so a linear map that commutes with all ad x is determined by its values on
# the seed vectors.

SUPPORT = 16  # non-zero entries of a random element of an algebra with a sparse table
IDLE = 2  # random elements without a new bracket after which [g, g] counts as spanned
NARROW = 2  # brackets are computed in selected columns if n is at least this many times dim [g, g]
FEW_GENERATORS = 12  # seed vectors that are tried as generators of the algebra
DIRECT_INVERSE = 100  # dimension up to which the matrix of the coordinates is inverted at once


@final
class BracketSeeds:
    """Seed `vectors` v, (1, n), and `tables` of the brackets [v, e_b] of the first ones; `free` ones outside [g, g]."""

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
            dense = as_exact(self.algebra.table.dense())
            self._narrow = dense.select(columns=columns).reshape(self.n, self.n * len(columns))
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
            larger = int(self.field.stack_rows(grown, self.n).modulo(self.attempt).rank())
            if larger == rank:
                idle += 1  # [v, g] of random v adds nothing: [g, g] is spanned
            else:
                self.vectors, self.tables, rank = [*self.vectors, v], grown, larger
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
        """An integer c, vectors w_v and numbers a_s with c y = sum_v [v, w_v] + sum_s a_s s, for each row y."""
        n, count = self.n, len(self.tables)
        basis = self.field.stack_rows([*self.tables, *self.vectors], n).select(rows=self._basis_rows)
        if self._inverse is None and (n <= DIRECT_INVERSE or rows.nrows >= n):
            self._inverse = basis.inverse()
        solution = basis.T.solve(rows.T).T if self._inverse is None else rows @ self._inverse
        padded = self.field.stack_columns([solution.cleared(), self.field.zeros(rows.nrows, 1)], rows.nrows)
        where = {x: i for i, x in enumerate(self._basis_rows)}
        moved = [padded.select(columns=[where.get(i * n + b, n) for b in range(n)]) for i in range(count)]
        direct = padded.select(columns=[where.get(count * n + s, n) for s in range(len(self.vectors))])
        return solution.den, moved, direct

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


# Algebras of commuting matrices: minimal polynomials, the trace form, candidates for a generator.
# A commutative algebra A of matrices has A / rad A = K_1 x ... x K_s with fields K_i, and rad A is the radical of the
# form tr(a b) (characteristic 0).  An element whose minimal polynomial has a squarefree part of degree
# dim A / rad A generates A / rad A, and that part has one irreducible factor for each K_i.

ATTEMPTS = 40  # random sums of matrices that are tried as generators


def minimal_polynomial(matrix: ExactMatrix, start: ExactMatrix) -> Polynomial:
    """The monic polynomial f of smallest degree with f(A) v = 0."""
    field, n = matrix.field, matrix.nrows
    rows = [start]
    for degree in range(n + 1):
        krylov = field.stack_rows(rows, n)
        if int(krylov.modulo().rank()) <= degree:
            try:
                lower = krylov.select(rows=range(degree)).T.solve(rows[-1].T) if degree else field.zeros(0, 1)
                if degree or rows[-1].is_zero():
                    return Polynomial(field, [*(-c for c in lower.entries()), field.one])
            except SingularError:
                pass  # the vectors are dependent modulo the prime only
        rows.append((matrix @ rows[-1].T).T)
    raise InternalError("a vector and its images are independent in a space that is too small for them")


def evaluate(polynomial: Polynomial, matrix: ExactMatrix) -> ExactMatrix:
    """The matrix f(A) for a polynomial f over the field of A, by Horner's rule."""
    field, n = matrix.field, matrix.nrows
    total, one = field.zeros(n, n), field.identity(n)
    for c in reversed(polynomial.coefficients):
        total = total @ matrix + one.scale(c)
    return total


def semisimple_rank(maps: Sequence[ExactMatrix]) -> int:
    """The dimension of A / rad A for a commutative algebra A of matrices with this basis, the rank of tr(a b)."""
    return int((flat_rows(maps) @ flat_rows([a.T for a in maps]).T).rank()) if maps else 0


def combinations(maps: Sequence[ExactMatrix], rng: random.Random) -> Iterator[ExactMatrix]:
    """The matrices themselves, then `ATTEMPTS` random sums of them with growing integer weights."""
    yield from maps
    for attempt in range(ATTEMPTS):
        size = len(maps) * (1 + attempt // 2) // 2
        yield reduce(add, [a.scale(rng.randint(-size, size)) for a in maps])


def are_independent(maps: Sequence[ExactMatrix]) -> bool:
    """Whether matrices of one shape are linearly independent."""
    return not maps or flat_rows(maps).rank() == len(maps)


def flat_rows(matrices: Sequence[ExactMatrix]) -> ExactMatrix:
    """The entries of each matrix, row after row, as one row; the matrices have one shape."""
    size = matrices[0].nrows * matrices[0].ncols
    return matrices[0].field.stack_rows([a.reshape(1, size) for a in matrices], size)


# The centroid of a Lie algebra: the matrices phi with phi [x, y] = [phi x, y] for all x, y.
# phi commutes with ad x for every x, so phi v commutes with all elements that commute with v.  It lies in the centre of
# the centralizer C(v), which is a small space for generic v: for semisimple algebras it is a Cartan subalgebra.  The
# brackets [v, g] with a few seed vectors v (`BracketSeeds`) span [g, g], and phi [v, y] = [phi v, y].  The unknowns are
# therefore the values of phi on the seed vectors only.  The solutions of a few random equations are verified against a
# generating set.

ROUNDS = 16  # sets of equations
MODULAR_ROUNDS = 8  # sets of equations after which independent ones are no longer chosen modulo a prime
REDUCED = 60  # dimension of the centroid up to which its basis is reduced to small integers


def centroid(algebra: LieAlgebra) -> tuple[ExactMatrix, ...]:
    """Implements `LieAlgebra.centroid`."""
    field = exact_field(algebra, "centroids")
    return (field.identity(algebra.dimension),) if is_central(algebra) else centroid_of(BracketSeeds(algebra), None)


def is_central(algebra: LieAlgebra) -> bool:
    """Whether two elements show modulo a prime that the algebra is perfect with only multiples of 1 in its centroid.

    For u = phi x and v = phi y, [x, u] = [y, v] = [y, u] + [x, v] = 0. If u = c x and v = c y are the only solutions,
    phi - c maps x and y to 0, hence [x, g] + [y, g], which is g. Ranks modulo a prime are at most the true ranks.
    """
    n = algebra.dimension
    rng = random.Random(n)
    x, y = (
        algebra.ad(exact_field(algebra, "centroids").from_integers([rng.randint(-9, 9) for _ in range(n)], 1, n)).T
        for _ in range(2)
    )
    if n == 0 or int(stacked_residues([x.modulo(), y.modulo()]).rank()) < n:
        return False
    zero = x.field.zeros(n, n)
    blocks = [x.field.stack_columns(row, n).modulo() for row in ([x, zero, y], [zero, y, x])]
    return int(stacked_residues(blocks).rank()) == 2 * n - 1


def centroid_of(seeds: BracketSeeds, center: ExactMatrix | None) -> tuple[ExactMatrix, ...]:
    """A basis of the centroid, or of a part of it, of the algebra with these seed vectors."""
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
    """Linear equations for phi in `size` unknowns: for each seed vector v, phi v in the span of rows of `values`."""

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
        """A basis of the span of the rows (necessary conditions), or first rows independent modulo a prime."""
        rows = self.field.stack_rows(blocks, blocks[0].ncols)
        return rows.row_space() if exact else rows.select(rows=self.seeds.pivots(rows))

    # -- unknowns ----------------------------------------------------------------------------------------
    def _allowed(self, index: int, v: ExactMatrix) -> ExactMatrix:
        """A space that contains phi v for every phi: the centralizer of v, reduced towards its centre."""
        tables = self.seeds.tables
        table = tables[index] if index < len(tables) else self.seeds.ads(v)[0]
        centralizing = table.left_null_space()
        if centralizing.nrows == self.n:  # v is central
            return self.seeds.center()
        return self._commuting(centralizing).primitive()

    def _commuting(self, full: ExactMatrix) -> ExactMatrix:
        """The elements of a space that commute with random elements of it, more and more until none is lost."""
        k = full.nrows
        count, space = k // (2 * max(self.seeds.spanned, 1)) + 1, full
        while count < 4 * k:
            weights = [[self.seeds.rng.choice((-1, 1)) for _ in range(k)] for _ in range(count)]
            elements = (self.field.matrix(weights, (count, k)) @ full).primitive()
            conditions = self.chosen([m.T for m in self.seeds.narrow_brackets(elements, space)])
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
        images: list[ExactMatrix] = []
        for s, allowed in enumerate(self.values):
            if s < len(moved):
                parts = self.seeds.brackets(allowed, moved[s])
            else:
                parts = [self.field.zeros(rows.nrows, self.n)] * allowed.nrows
            if s in self.seeds.free:
                direct = weights.select(columns=[s])
                parts = [p + direct @ allowed.select(rows=[a]) for a, p in enumerate(parts)]
            images += parts
        return factor, images

    def conditions(self, count: int, solved: bool) -> ExactMatrix:
        """Linear equations on the unknowns from random elements x and y, as rows.

        The equations are [phi x, y] = [x, phi y], which have small numbers, or phi [x, y] = [x, phi y] if `solved`,
        which need the coordinates of [x, y]. The first equations imply the others up to the centre.
        """
        return flat_rows(self._solved_conditions(count) if solved else self._small_conditions(count)).T

    def _small_conditions(self, count: int) -> list[ExactMatrix]:
        """The equations [phi x, y] = [x, phi y], for y = sum_v [v, w_v] + sum_s a_s s with chosen w_v and a_s."""
        seeds, field, rng = self.seeds, self.field, self.seeds.rng
        vectors, size = field.stack_rows(seeds.vectors, self.n), len(seeds.vectors)
        mixed = [rng.randint(-1, 1) for _ in range(size)]
        table = seeds.ads(field.matrix([mixed], (1, size)) @ vectors)[0]
        moved = [seeds.random_rows(count) for _ in seeds.tables]
        weights = [[rng.randint(-1, 1) * (s in seeds.free) for s in range(size)] for _ in range(count)]
        direct = field.matrix(weights, (count, size))
        y = direct @ vectors
        for w, t in zip(moved, seeds.tables, strict=True):
            y = y + w @ t
        equations: list[ExactMatrix] = []
        for s, allowed in enumerate(self.values):
            column = direct.select(columns=[s])
            right = [column @ allowed.select(rows=[a]) for a in range(allowed.nrows)]
            if s < len(moved):
                right = [r + b for r, b in zip(right, seeds.brackets(allowed, moved[s]), strict=True)]
            left = seeds.brackets(allowed.scale(mixed[s]), y)
            equations += [a - r @ table for a, r in zip(left, right, strict=True)]
        return equations

    def _solved_conditions(self, count: int) -> list[ExactMatrix]:
        """The equations phi [x, y] = [x, phi y], and phi v = the value on v for phi v in terms of the unknowns."""
        seeds, field = self.seeds, self.field
        x, ys = seeds.ads(seeds.random_rows(1))[0], seeds.random_rows(count)
        bracketed = [s for s in range(len(seeds.tables)) if s not in seeds.free]
        rows = field.stack_rows([ys @ x, ys, *(seeds.vectors[s] for s in bracketed)], self.n)
        factor, images = self.images(rows)
        equations = []
        owners = [(s, a) for s, allowed in enumerate(self.values) for a in range(allowed.nrows)]
        for (s, a), m in zip(owners, images, strict=True):
            moved = m.select(rows=range(count)) - m.select(rows=range(count, 2 * count)) @ x
            rest = m.select(rows=range(2 * count, m.nrows))
            if s in bracketed:
                column = field.unit(len(bracketed), bracketed.index(s)).T
                rest = rest - column @ self.values[s].select(rows=[a]).scale(factor)
            equations.append(field.stack_rows([moved, rest], self.n))
        return equations

    def reduced(self, unknowns: ExactMatrix) -> list[ExactMatrix]:
        """For each seed vector s the values phi s as rows, for a basis of the solutions with small integers."""
        ends = pairwise(accumulate((allowed.nrows for allowed in self.values), initial=0))
        parts = [unknowns.select(columns=range(*own)) @ u for own, u in zip(ends, self.values, strict=True)]
        basis = self.field.stack_columns(parts, unknowns.nrows)
        if basis.nrows <= REDUCED:
            basis = integral_basis(basis)
        return [basis.select(columns=range(s * self.n, (s + 1) * self.n)) for s in range(len(parts))]

    def maps(self, values: list[ExactMatrix]) -> tuple[ExactMatrix, ...]:
        """Multiples of the matrices phi, on columns, with these values on the seed vectors, one row per phi."""
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
        adjoints = (table.T for table in self.seeds.generating())
        return all((phi @ adjoint - adjoint @ phi).is_zero() for adjoint in adjoints for phi in maps)
