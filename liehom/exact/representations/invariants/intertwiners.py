"""Intertwiners, invariant forms and algebras of matrices."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations, islice
from typing import Any, final

from liehom.base.errors import InternalError, ShapeError
from liehom.base.typing import ScalarLike
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field
from liehom.exact.scalars.modular import (
    extending_rows,
    intertwining_residues,
    pivot_columns,
    primitive_residues,
    rational_lifts,
)
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import Subspace, integral_basis

MAX_PAIRS = 60
MAX_REDUCED = 40


@final
class MatrixAlgebra:
    """A span of matrices that contains 1 and is closed under products.

    Coordinates are read from as many entries as determine them. Over QQ the basis is an LLL-reduced one of the integer
    matrices of the span, so that its first members are small.
    """

    field: ExactField
    size: int

    __slots__ = ("_flat", "_inverse", "_places", "basis", "field", "size")

    def __init__(self, field: ExactField, size: int, matrices: Sequence[ExactMatrix]) -> None:
        self.field, self.size = field, size
        flat = field.stack_rows([m.reshape(1, size * size) for m in matrices], size * size)
        reducible = field.degree == 1 and len(matrices) <= MAX_REDUCED
        self._flat = integral_basis(flat) if reducible else flat.row_space()
        self.basis: tuple[ExactMatrix, ...] = tuple(self._flat.split_rows(size, size))
        self._places = self._flat.echelon()[1]
        self._inverse = self._flat.select(columns=self._places).inverse()

    @property
    def dimension(self) -> int:
        """Dimension of the algebra, an int."""
        return len(self.basis)

    def coordinates(self, matrices: Sequence[ExactMatrix]) -> ExactMatrix:
        """The matrix (k, dimension) of coefficients of k elements in the basis."""
        n = self.size
        flat = self.field.stack_rows([m.reshape(1, n * n) for m in matrices], n * n)
        return flat.select(columns=self._places) @ self._inverse

    def element(self, coefficients: Sequence[ScalarLike]) -> ExactMatrix:
        """The element with these coefficients in the basis."""
        return (self.field.matrix([coefficients], (1, self.dimension)) @ self._flat).reshape(self.size, self.size)

    def multiplication(self, element: ExactMatrix) -> ExactMatrix:
        """The matrix (k, k) of x -> element x in the basis, acting on columns."""
        return self.coordinates([element @ t for t in self.basis]).T

    def center(self) -> MatrixAlgebra:
        """The centre: the elements that commute with a few random elements, verified against the basis."""
        k = self.dimension
        rng = random.Random(k)
        tests = [self.element([rng.randint(-3, 3) for _ in range(k)]) for _ in range(2)]
        for _ in range(k + 2):
            blocks = [self.coordinates([t @ s - s @ t for t in self.basis]) for s in tests]
            rows = self.field.stack_columns(blocks, k).left_null_space()
            matrices = (rows @ self._flat).split_rows(self.size, self.size)
            failing = next((t for t in self.basis for z in matrices if not (t @ z - z @ t).is_zero()), None)
            if failing is None:
                return MatrixAlgebra(self.field, self.size, matrices)
            tests.append(failing)
        raise InternalError("the centre of a matrix algebra was not found")

    def elements(self) -> Iterator[ExactMatrix]:
        """Candidate elements, without end: the basis, sums and differences of two, then random combinations."""
        yield from self.basis
        for s, t in list(combinations(self.basis, 2))[:MAX_PAIRS]:
            yield from (s + t, s - t)
        rng, bound = random.Random(self.dimension), 1
        while True:
            yield self.element([rng.randint(-bound, bound) for _ in self.basis])
            bound += 1

    def minimal_polynomial_power(self, element: ExactMatrix) -> Polynomial:
        """A characteristic polynomial, with the irreducible factors of the minimal polynomial of an element."""
        matrix = self.multiplication(element) if self.dimension < self.size else element
        return Polynomial(self.field, matrix.characteristic_coefficients())

    def generator(self) -> tuple[ExactMatrix, Polynomial]:
        """A generator of a commutative algebra without nilpotent elements, and its squarefree minimal polynomial."""
        for element in islice(self.elements(), 2 * MAX_PAIRS + self.dimension + 42):
            polynomial = Polynomial(self.field, self.multiplication(element).characteristic_coefficients())
            if polynomial.gcd(polynomial.derivative()).degree == 0:
                return element, polynomial
        raise InternalError("a commutative algebra without nilpotents has no generator")


# An intertwiner, T with T A_i = B_i T, is determined by its values on seed vectors, which generate the space under the
# A_i.  Words in the A_i applied to a random seed x give a basis v_j = (word in A) x, and T v_j = (same word in B) T x:
# the unknown is T x, of dimension e instead of d e.  Candidates are verified exactly against every A_i, so the result
# does not depend on the random choices.  Large spaces over QQ are computed modulo a prime, where they are at least as
# large, and lifted.

BATCH = 8  # matrices in a random combination
DRAWS = 20  # random vectors from which a seed vector is taken
LIFTED_SIZE = 150  # from this number of unknowns e d on, residues are lifted
MIXED = 3  # random combinations that replace more matrices
ROW_ENTRIES = 8  # non-zero entries that a combination should have in each row
ROUNDS = 4  # attempts of lifting


def intertwiners(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], shape: tuple[int, int], over: Field
) -> list[ExactMatrix]:
    """A basis of the maps T, shape (e, d), with T A_i = B_i T for all i."""
    e, d = shape
    if len(source) != len(target):
        raise ShapeError(f"{len(source)} and {len(target)} matrices to intertwine")
    if e == 0 or d == 0:
        return []
    if all(a.is_zero() for a in (*source, *target)):
        return all_maps(over, e, d)
    if over.degree == 1 and e * d >= LIFTED_SIZE and (lifted := _lifted(source, target, shape, over)) is not None:
        return lifted
    words, rng = _word_basis(source, target, shape, over), random.Random(7)
    conditions = [words.condition(*_mixed(source, target, rng), rng) for _ in range(3)]
    before = e * words.seeds + 1
    while True:
        unknown = over.stack_rows(conditions, e * words.seeds).null_space()
        candidates = [words.map(unknown.select(rows=[i])) for i in range(unknown.nrows)]
        failing = _first_failing(candidates, source, target)
        if failing is None:
            return candidates
        conditions = [over.stack_rows(conditions, e * words.seeds).row_space()]
        # Each round uses a generator that some candidate violates, at random vectors as long as that leaves fewer
        # candidates, else at a whole basis. No candidate violates a generator after the second, so the loop ends.
        if unknown.nrows < before:
            conditions += [words.condition(source[failing], target[failing], rng) for _ in range(2)]
        else:
            conditions += words.conditions(source[failing], target[failing])
        before = unknown.nrows


def _lifted(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], shape: tuple[int, int], over: Field
) -> list[ExactMatrix] | None:
    """The intertwiners from their residues, or None if there is no small kernel or the numbers are too large.

    The dimension modulo a prime is an upper bound, also if only some combinations of the A_i are used.
    """
    rng = random.Random(11)
    pairs = list(zip(source, target, strict=True))
    batch = _enough(source, shape[1])
    used = pairs if len(pairs) <= MIXED else [_mixed(source, target, rng, batch) for _ in range(MIXED)]
    for _ in range(ROUNDS):
        left, right = [a for a, _ in used], [b for _, b in used]
        first = intertwining_residues(left, right)
        if first is None:
            return None
        if first.nrows() == 0:
            return []
        for rows in rational_lifts(partial(_residues_again, left, right, first), over):
            candidates = rows.split_rows(*shape)
            failing = _first_failing(candidates, source, target)
            if failing is None:
                return candidates
            if _first_failing(candidates, left, right) is None:
                used.append(pairs[failing])  # the combinations do not generate: a violated A_i is used next
                break
        else:
            return None
    return None


def _residues_again(left: Sequence[Any], right: Sequence[Any], first: Any, attempt: int) -> Any:
    return intertwining_residues(left, right, attempt) if attempt else first


def _first_failing(
    candidates: Sequence[ExactMatrix], source: Sequence[ExactMatrix], target: Sequence[ExactMatrix]
) -> int | None:
    pairs = enumerate(zip(source, target, strict=True))
    return next((i for i, (a, b) in pairs for t in candidates if not (t @ a - b @ t).is_zero()), None)


def _enough(matrices: Sequence[ExactMatrix], d: int) -> int:
    """Number of these matrices in a combination that has several non-zero entries in each of d rows."""
    entries = max(1, *(sum(map(bool, a.entries())) for a in (matrices[0], matrices[-1])))
    return max(BATCH, -(-ROW_ENTRIES * d // entries))


def _mixed(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], rng: random.Random, batch: int = BATCH
) -> tuple[ExactMatrix, ExactMatrix]:
    """A random combination of a few A_i with small coefficients, and the same combination of the B_i."""
    if not source:
        raise InternalError("no matrices to combine")
    chosen = rng.sample(range(len(source)), min(batch, len(source)))
    weights = [rng.choice((-2, -1, 1, 2)) for _ in chosen]
    a, b = source[chosen[0]].scale(weights[0]), target[chosen[0]].scale(weights[0])
    for i, w in zip(chosen[1:], weights[1:], strict=True):
        a, b = a + source[i].scale(w), b + target[i].scale(w)
    return a, b


@final
@dataclass(slots=True)
class _WordBasis:
    """A basis v_j by words applied to seeds x, with T v_j = images[j] t; t, shape (e * seeds,), has the unknown T x."""

    over: Field
    shape: tuple[int, int]
    seeds: int
    vectors: list[ExactMatrix]
    images: list[ExactMatrix]
    inverse: ExactMatrix

    def value(self, w: ExactMatrix) -> ExactMatrix:
        """The matrix (e, e * seeds) with T w = value t."""
        coordinates = (self.inverse @ w).T.row(0)
        total: ExactMatrix = self.over.zeros(self.shape[0], self.shape[0] * self.seeds)
        for c, image in zip(coordinates, self.images, strict=True):
            if c != 0:
                total = total + image.scale(c)
        return total

    def condition(self, a: ExactMatrix, b: ExactMatrix, rng: random.Random) -> ExactMatrix:
        """The linear conditions on t, as rows, that T a y = b T y imposes for a random y."""
        e, d = self.shape
        weights = [rng.randint(-2, 2) for _ in range(d)]
        y: ExactMatrix = self.over.zeros(d, 1)
        image: ExactMatrix = self.over.zeros(e, e * self.seeds)
        for c, v, m in zip(weights, self.vectors, self.images, strict=True):
            if c:
                y, image = y + v.scale(c), image + m.scale(c)
        return self.value(a @ y) - b @ image

    def conditions(self, a: ExactMatrix, b: ExactMatrix) -> list[ExactMatrix]:
        """All linear conditions on t that T a = b T imposes: those at the basis vectors."""
        return [self.value(a @ v) - b @ m for v, m in zip(self.vectors, self.images, strict=True)]

    def map(self, t: ExactMatrix) -> ExactMatrix:
        """The map T for a row t, shape (1, e * seeds)."""
        values: ExactMatrix = self.over.stack_rows([(m @ t.T).T for m in self.images], self.shape[0]).T
        return values @ self.inverse


def _word_basis(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], shape: tuple[int, int], over: Field
) -> _WordBasis:
    e, d = shape
    rng = random.Random(d)
    vectors: list[ExactMatrix] = []
    words: list[tuple[int, int]] = []  # (generator, parent), or (-1, seed number)
    seeds = 0
    while len(vectors) < d:
        frontier = [len(vectors)]
        vectors.append(_seed_vector(over, vectors, seeds, d, rng))
        words.append((-1, seeds))
        seeds += 1
        while frontier and len(vectors) < d:
            frontier = _grow(source, vectors, words, frontier, d, rng)
    images: list[ExactMatrix] = []
    for generator, parent in words:
        if generator < 0:
            blocks = [over.identity(e) if s == parent else over.zeros(e, e) for s in range(seeds)]
            images.append(over.stack_columns(blocks, e))
        else:
            images.append(target[generator] @ images[parent])
    columns: ExactMatrix = over.stack_rows([v.T for v in vectors], d).T
    return _WordBasis(over, shape, seeds, vectors, images, columns.inverse())


def _residues(vectors: Sequence[ExactMatrix], d: int) -> Any:
    """The columns as rows modulo a prime, each without common factors and denominators."""
    return primitive_residues([v.T for v in vectors], d)


def _seed_vector(over: Field, vectors: list[ExactMatrix], seeds: int, d: int, rng: random.Random) -> ExactMatrix:
    """A vector outside the span of fewer than d vectors; random for the first three seeds if a draw succeeds."""
    random_rows = ([[rng.randint(-3, 3) for _ in range(d)]] for _ in range(DRAWS))
    candidates = (over.matrix(rows).T for rows in random_rows) if seeds < 3 else iter([over.unit(d, seeds % d).T])
    for start in candidates:
        if int(_residues([*vectors, start], d).rank()) == len(vectors) + 1:
            return start
    pivots = set(pivot_columns(_residues(vectors, d))) if vectors else set()
    return over.unit(d, next(j for j in range(d) if j not in pivots)).T


def _grow(
    source: Sequence[ExactMatrix],
    vectors: list[ExactMatrix],
    words: list[tuple[int, int]],
    frontier: list[int],
    d: int,
    rng: random.Random,
) -> list[int]:
    """The indices of appended vectors: images of the frontier that extend the span."""
    pairs = [(g, p) for p in frontier for g in range(len(source))]
    rng.shuffle(pairs)
    before = len(vectors)
    for start in range(0, len(pairs), 2 * d):
        batch = pairs[start : start + 2 * d]
        images = [source[g] @ vectors[p] for g, p in batch]
        for x in extending_rows([_residues(vectors, d)], [_residues(images, d)]):
            vectors.append(images[x])
            words.append(batch[x])
        if len(vectors) == d:
            break
    return list(range(before, len(vectors)))


def commutant(matrices: Sequence[ExactMatrix], size: int, over: Field) -> list[ExactMatrix]:
    """A basis of the matrices that commute with all matrices."""
    return intertwiners(matrices, matrices, (size, size), over)


def all_maps(over: Field, e: int, d: int) -> list[ExactMatrix]:
    """The elementary matrices (e, d), a basis of all maps."""
    return [over.unit(e, i).T @ over.unit(d, j) for i in range(e) for j in range(d)]


@final
@dataclass(frozen=True, slots=True)
class InvariantForms:
    """Bases of the symmetric and of the skew-symmetric forms P with A^T P + P A = 0 for the matrices A of a set."""

    symmetric: tuple[ExactMatrix, ...]
    skew: tuple[ExactMatrix, ...]


def invariant_forms(matrices: Sequence[ExactMatrix], size: int, over: Field) -> InvariantForms:
    """Bases of the symmetric and of the skew-symmetric forms P with A^T P + P A = 0 for all matrices A."""
    forms = intertwiners(matrices, [-a.T for a in matrices], (size, size), over)
    if not forms:
        return InvariantForms((), ())
    parts = ([t + t.T for t in forms], [t - t.T for t in forms])
    flats = (over.stack_rows([m.reshape(1, size * size) for m in part], size * size) for part in parts)
    symmetric, skew = (tuple(flat.row_space().split_rows(size, size)) for flat in flats)
    return InvariantForms(symmetric, skew)


def invariant_vectors(matrices: Sequence[ExactMatrix], size: int, over: Field) -> Subspace:
    """The subspace of vectors v with A v = 0 for all matrices A."""
    return Subspace(over, over.stack_rows(list(matrices), size).null_space(), size)
