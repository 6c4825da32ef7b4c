"""Intertwiners, all T with T A_i = B_i T, and with them the commutant, invariant forms and invariant vectors.

An intertwiner is determined by its values on seed vectors, vectors that generate the space under the A_i.  Words in the
A_i applied to a random seed x give a basis v_j = (word in A) x, and T v_j = (same word in B) T x: the unknown is T x,
of dimension e instead of d e.  Candidates are verified exactly against every A_i, so the result does not depend on the
random choices.  Large spaces over QQ are computed modulo a prime, where they are at least as large, and lifted.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, final

from liehom.errors import InternalError, ShapeError
from liehom.scalars import ExactMatrix, Field, Subspace
from liehom.scalars.modular.modular import extending_rows, pivot_columns, primitive_residues
from liehom.scalars.modular.modular_maps import intertwining_residues
from liehom.scalars.modular.modular_span import rational_lifts

BATCH = 8  # matrices in a random combination
DRAWS = 20  # random vectors from which a seed vector is taken
LIFTED_SIZE = 150  # from this number of unknowns e d on, residues are lifted
MIXED = 3  # random combinations that replace more matrices
ROW_ENTRIES = 8  # non-zero entries that a combination should have in each row
ROUNDS = 4  # attempts of lifting


def intertwiners(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], shape: tuple[int, int], over: Field
) -> list[ExactMatrix]:
    """A basis of the maps T, shape (e, d), with T A_i = B_i T for all i.

    Parameters
    ----------
    source, target : sequences of Matrix
        The A_i, (d, d), and the B_i, (e, e), over one exact field; equally many.
    shape : (e, d)
    over : Field

    Returns
    -------
    list of Matrix
        Proved to be a basis: every T intertwines all A_i, and the conditions used are necessary.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> J = QQ.matrix([[0, -1], [1, 0]])
    >>> len(intertwiners([J], [J], (2, 2), QQ))
    2
    """
    e, d = shape
    if len(source) != len(target):
        raise ShapeError(f"{len(source)} and {len(target)} matrices to intertwine")
    if e == 0 or d == 0:
        return []
    if all(a.is_zero() for a in (*source, *target)):
        return [_elementary(over, (e, d), i, j) for i in range(e) for j in range(d)]
    if over.degree == 1 and e * d >= LIFTED_SIZE:
        lifted = _lifted(source, target, shape, over)
        if lifted is not None:
            return lifted
    words = _word_basis(source, target, shape, over)
    conditions: list[ExactMatrix] = []
    rng = random.Random(7)
    for _ in range(3):
        conditions.append(words.condition(*_mixed(source, target, rng), rng))
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
        failing: int | None = None
        for rows in rational_lifts(partial(_residues_again, left, right, first), over):
            candidates = rows.split_rows(*shape)
            failing = _first_failing(candidates, source, target)
            if failing is None:
                return candidates
            if _first_failing(candidates, left, right) is None:
                break  # the combinations do not generate: a violated A_i is used next
        else:
            return None
        if failing is not None:
            used.append(pairs[failing])
    return None


def _residues_again(left: Sequence[Any], right: Sequence[Any], first: Any, attempt: int) -> Any:
    return intertwining_residues(left, right, attempt) if attempt else first


def _first_failing(
    candidates: Sequence[ExactMatrix], source: Sequence[ExactMatrix], target: Sequence[ExactMatrix]
) -> int | None:
    for i, (a, b) in enumerate(zip(source, target, strict=True)):
        for t in candidates:
            if not (t @ a - b @ t).is_zero():
                return i
    return None


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
    """A basis v_j of the source by words in the A_i applied to seed vectors, with T v_j = images[j] t.

    t, shape (e * seeds,), has the unknown values T x of the seed vectors x.
    """

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
        d = self.shape[1]
        weights = [rng.randint(-2, 2) for _ in range(d)]
        y: ExactMatrix = self.over.zeros(d, 1)
        image: ExactMatrix = self.over.zeros(self.shape[0], self.shape[0] * self.seeds)
        for c, v, m in zip(weights, self.vectors, self.images, strict=True):
            if c:
                y, image = y + v.scale(c), image + m.scale(c)
        return self.value(a @ y) - b @ image

    def conditions(self, a: ExactMatrix, b: ExactMatrix) -> list[ExactMatrix]:
        """All linear conditions on t that T a = b T imposes: those at the basis vectors."""
        return [self.value(a @ v) - b @ m for v, m in zip(self.vectors, self.images, strict=True)]

    def map(self, t: ExactMatrix) -> ExactMatrix:
        """The map T for a row t, shape (1, e * seeds)."""
        e = self.shape[0]
        columns = [(m @ t.T).T for m in self.images]
        values: ExactMatrix = self.over.stack_rows(columns, e).T
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
        start = _seed_vector(over, vectors, seeds, d, rng)
        frontier = [len(vectors)]
        vectors.append(start)
        words.append((-1, seeds))
        seeds += 1
        while frontier and len(vectors) < d:
            frontier = _grow(over, source, vectors, words, frontier, d, rng)
    return _WordBasis(over, shape, seeds, vectors, _images(over, target, words, seeds, e), _inverse(over, vectors, d))


def _inverse(over: Field, vectors: list[ExactMatrix], d: int) -> ExactMatrix:
    columns: ExactMatrix = over.stack_rows([v.T for v in vectors], d).T
    return columns.inverse()


def _residues(vectors: Sequence[ExactMatrix], d: int) -> Any:
    """The columns as rows modulo a prime, each without common factors and denominators."""
    return primitive_residues([v.T for v in vectors], d)


def _extends(vectors: list[ExactMatrix], candidate: ExactMatrix, d: int) -> bool:
    return int(_residues([*vectors, candidate], d).rank()) == len(vectors) + 1


def _seed_vector(over: Field, vectors: list[ExactMatrix], seeds: int, d: int, rng: random.Random) -> ExactMatrix:
    """A vector outside the span of fewer than d vectors; random for the first three seeds if a draw succeeds."""
    random_rows = ([[rng.randint(-3, 3) for _ in range(d)]] for _ in range(DRAWS))
    candidates = (over.matrix(rows).T for rows in random_rows) if seeds < 3 else iter([over.unit(d, seeds % d).T])
    start: ExactMatrix
    for start in candidates:
        if _extends(vectors, start, d):
            return start
    pivots = set(pivot_columns(_residues(vectors, d))) if vectors else set()
    found: ExactMatrix = over.unit(d, next(j for j in range(d) if j not in pivots)).T
    return found


def _grow(
    over: Field,
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
    added: list[int] = []
    for start in range(0, len(pairs), 2 * d):
        batch = pairs[start : start + 2 * d]
        images = [source[g] @ vectors[p] for g, p in batch]
        for x in extending_rows([_residues(vectors, d)], [_residues(images, d)]):
            added.append(len(vectors))
            vectors.append(images[x])
            words.append(batch[x])
        if len(vectors) == d:
            break
    return added


def _images(
    over: Field, target: Sequence[ExactMatrix], words: list[tuple[int, int]], seeds: int, e: int
) -> list[ExactMatrix]:
    images: list[ExactMatrix] = []
    for generator, parent in words:
        if generator < 0:
            blocks = [over.identity(e) if s == parent else over.zeros(e, e) for s in range(seeds)]
            images.append(over.stack_columns(blocks, e))
        else:
            images.append(target[generator] @ images[parent])
    return images


def commutant(matrices: Sequence[ExactMatrix], size: int, over: Field) -> list[ExactMatrix]:
    """A basis of the matrices that commute with all given matrices.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> len(commutant([QQ.matrix([[0, -1], [1, 0]])], 2, QQ))
    2
    """
    return intertwiners(matrices, matrices, (size, size), over)


def _elementary(over: Field, shape: tuple[int, int], i: int, j: int) -> ExactMatrix:
    made: ExactMatrix = over.unit(shape[0], i).T @ over.unit(shape[1], j)
    return made


@final
@dataclass(frozen=True, slots=True)
class InvariantForms:
    """The invariant bilinear forms of a set of matrices, P with A^T P + P A = 0.

    Attributes
    ----------
    symmetric, skew : tuple of Matrix
        Bases of the symmetric and of the skew-symmetric forms.
    """

    symmetric: tuple[ExactMatrix, ...]
    skew: tuple[ExactMatrix, ...]


def invariant_forms(matrices: Sequence[ExactMatrix], size: int, over: Field) -> InvariantForms:
    """Bases of the symmetric and of the skew-symmetric forms P with A^T P + P A = 0 for all matrices A.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> forms = invariant_forms([QQ.matrix([[0, -1], [1, 0]])], 2, QQ)
    >>> len(forms.symmetric), len(forms.skew)
    (1, 1)
    """
    found = intertwiners(matrices, [-a.T for a in matrices], (size, size), over)
    return InvariantForms(
        _independent(over, [t + t.T for t in found], size), _independent(over, [t - t.T for t in found], size)
    )


def _independent(over: Field, matrices: list[ExactMatrix], size: int) -> tuple[ExactMatrix, ...]:
    if not matrices:
        return ()
    flat = over.stack_rows([m.reshape(1, size * size) for m in matrices], size * size)
    space: ExactMatrix = flat.row_space()
    return tuple(space.select(rows=[i]).reshape(size, size) for i in range(space.nrows))


def invariant_vectors(matrices: Sequence[ExactMatrix], size: int, over: Field) -> Subspace:
    """The subspace of vectors v with A v = 0 for all matrices A.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> invariant_vectors([QQ.matrix([[0, 1], [0, 0]])], 2, QQ).rows()
    [[1, 0]]
    """
    rows = over.stack_rows(list(matrices), size) if matrices else over.zeros(0, size)
    kernel = rows.null_space() if matrices else over.identity(size)
    return Subspace(over, kernel, size)
