"""The Levi decomposition g = s + rad(g): a semisimple subalgebra that complements the radical.

Two elements a, b generate g/rad(g), so it has a basis of words in a and b, that is, iterated brackets.  Let
r = r_0 > r_1 > ... be the derived series of the radical and V = r_t / r_{t+1}, an abelian ideal of g / r_{t+1}.  A
section over g / r_t is corrected by adding y_a, y_b in V to the lifts of a and b.  The relations between the words
become linear equations in these 2 dim V unknowns, which have a solution by Whitehead's second lemma.  Relations with
a and b are enough, because the x whose brackets with every word lift correctly form a subalgebra.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.subalgebra import Subalgebra, products
from liehom.algebra.structure.exact_field import exact_field
from liehom.algebra.structure.radical import radical
from liehom.errors import InternalError, SingularError
from liehom.scalars import ExactField, ExactMatrix, as_exact
from liehom.scalars.modular.modular import extending_rows, stacked_residues
from liehom.scalars.spaces.integral_basis import short_basis
from liehom.scalars.spaces.quotient import echelon_quotient

PAIRS = 200  # random pairs of elements that are tried as generators
STRIDE = 20  # pairs after which the coefficients may be larger by 1

Word = tuple[int, int]  # (generator, index of the word on which it acts); the generators are words 0 and 1
Relation = tuple[int, int, ExactMatrix]  # (generator, word, coefficients (1, n) of their bracket in the words)


@final
@dataclass(frozen=True, slots=True)
class LeviDecomposition:
    """A decomposition of g as the semidirect sum of a semisimple subalgebra and the radical.

    Attributes
    ----------
    levi : Subalgebra
        A Levi factor, that is, a semisimple subalgebra that is a complement of the radical.
    radical : Subalgebra
        The solvable radical.
    """

    levi: Subalgebra
    radical: Subalgebra

    def __iter__(self) -> Iterator[Subalgebra]:
        return iter((self.levi, self.radical))


def levi_decomposition(algebra: LieAlgebra) -> LeviDecomposition:
    """Implements `LieAlgebra.levi_decomposition`."""
    exact_field(algebra, "Levi factors")
    ideal = radical(algebra)
    n = algebra.dimension
    if ideal.dimension == 0:
        return LeviDecomposition(Subalgebra(algebra, algebra.field.identity(n), check=False), ideal)
    if ideal.dimension == n:
        return LeviDecomposition(Subalgebra(algebra, algebra.field.zeros(0, n), check=False), ideal)
    return LeviDecomposition(Subalgebra(algebra, _levi_rows(algebra, ideal)), ideal)


def _levi_rows(algebra: LieAlgebra, ideal: Subalgebra) -> ExactMatrix:
    """A basis, as rows, of a Levi factor, for the radical of the algebra."""
    field, n = exact_field(algebra, "Levi factors"), algebra.dimension
    below = as_exact(ideal.basis)
    coordinates = echelon_quotient(below)
    lift = coordinates.lift
    blocks = algebra.table.contract(lift, lift, coordinates.projection)
    # The bracket descends to the quotient by the radical.
    plan = _plan(LieAlgebra(StructureConstants.from_blocks(field, lift.nrows, blocks), check=False))
    generators = [plan.first @ lift, plan.second @ lift]
    while below.nrows:
        above, below = below, products(algebra, below, below)
        generators = _corrected(algebra, plan, generators, above, below)
    words = plan.words_of(algebra, generators)
    return short_basis(field.stack_rows(words, n))


@final
@dataclass(frozen=True, slots=True)
class _Plan:
    """Words in two generators that are a basis of g/rad(g), and their relations.

    Attributes
    ----------
    first, second : ExactMatrix
        The generators, rows (1, dim g/rad(g)).
    steps : tuple of Word
        The words after these two.
    relations : tuple of Relation
    """

    first: ExactMatrix
    second: ExactMatrix
    steps: tuple[Word, ...]
    relations: tuple[Relation, ...]

    def words_of(self, algebra: LieAlgebra, generators: Sequence[ExactMatrix]) -> list[ExactMatrix]:
        """The words as rows of g, for given lifts of the generators."""
        actions = [algebra.ad(x).T for x in generators]
        made = list(generators)
        for generator, parent in self.steps:
            made.append(made[parent] @ actions[generator])
        return made


def _plan(algebra: LieAlgebra) -> _Plan:
    """A plan for a semisimple algebra, from the first two small elements that generate it."""
    field, n = exact_field(algebra, "Levi factors"), algebra.dimension
    rng = random.Random(n)
    for attempt in range(1, PAIRS):
        size = 1 + attempt // STRIDE
        pair = [field.matrix([[rng.randint(-size, size) for _ in range(n)]]) for _ in range(2)]
        steps = _spanning_words(algebra, pair)
        if steps is not None:
            unrelated = _Plan(pair[0], pair[1], tuple(steps), ())
            return _Plan(pair[0], pair[1], tuple(steps), _relations(algebra, unrelated))
    raise InternalError("no two elements generate a semisimple algebra")


def _spanning_words(algebra: LieAlgebra, pair: list[ExactMatrix]) -> list[Word] | None:
    """Words that complete the pair to a basis, chosen modulo a prime, or None if the pair does not generate."""
    n = algebra.dimension
    actions = [algebra.ad(x).T.modulo() for x in pair]
    words = [x.modulo() for x in pair]
    steps: list[Word] = []
    frontier = [0, 1]
    while len(words) < n and frontier:
        options = [(g, p) for p in frontier for g in (0, 1)]
        images = [words[p] * actions[g] for g, p in options]
        kept = extending_rows(words, images)
        frontier = list(range(len(words), len(words) + len(kept)))
        steps += [options[i] for i in kept]
        words += [images[i] for i in kept]
    return steps if len(words) == n and int(stacked_residues(words).rank()) == n else None


def _relations(algebra: LieAlgebra, plan: _Plan) -> tuple[Relation, ...]:
    """The brackets [generator, word] in terms of the words, except those that are words themselves."""
    field, n = exact_field(algebra, "Levi factors"), algebra.dimension
    words = field.stack_rows(plan.words_of(algebra, [plan.first, plan.second]), n)
    inverse = words.inverse()
    made = set(plan.steps)
    found = []
    for generator, start in ((0, plan.first), (1, plan.second)):
        coordinates = words @ algebra.ad(start).T @ inverse
        for word in range(n):
            if (generator, word) not in made and word != generator:
                found.append((generator, word, coordinates.select(rows=[word])))
    return tuple(found)


def _corrected(
    algebra: LieAlgebra, plan: _Plan, generators: list[ExactMatrix], above: ExactMatrix, below: ExactMatrix
) -> list[ExactMatrix]:
    """Lifts of the generators with the relations modulo `below`, from lifts with the relations modulo `above`."""
    field = above.field
    projection = echelon_quotient(below).projection if below.nrows else field.identity(algebra.dimension)
    basis, pivots = (above @ projection).echelon()
    d = basis.nrows
    lifts = above.select(rows=(above @ projection).T.echelon()[1])
    change = (lifts @ projection).select(columns=pivots)  # rows: the lifted basis in the echelon basis
    words = plan.words_of(algebra, generators)
    stacked = field.stack_rows(words, algebra.dimension)
    # rho[w] is the matrix of ad of word w on V, on rows in the echelon basis
    rho = _module(algebra, words, lifts, projection, pivots, change)
    shifts = _shifts(field, plan, rho, d)
    flat = field.stack_rows([x.reshape(1, 2 * d * d) for x in shifts], 2 * d * d)
    equations, constants = [], []
    actions = [algebra.ad(x).T for x in generators]
    for generator, word, row in plan.relations:
        defect = (words[word] @ actions[generator] - row @ stacked) @ projection
        constants.append(-defect.select(columns=pivots))
        change_of = shifts[word] @ rho[generator] - shifts[generator] @ rho[word]
        equations.append(change_of - (row @ flat).reshape(2 * d, d))
    system = field.stack_columns(equations, 2 * d).T
    right = field.stack_columns(constants, 1).T
    try:
        solution = system.solve(right).T
    except SingularError:
        raise InternalError("the equations of a Levi factor have no solution") from None
    correction = solution.reshape(2, d) @ change.inverse() @ lifts
    return [x + correction.select(rows=[i]) for i, x in enumerate(generators)]


def _module(
    algebra: LieAlgebra,
    words: list[ExactMatrix],
    lifts: ExactMatrix,
    projection: ExactMatrix,
    pivots: list[int],
    change: ExactMatrix,
) -> list[ExactMatrix]:
    """The matrices (d, d) by which the words act on V."""
    field = lifts.field
    inverse = change.inverse()
    table = algebra.table.contract(field.stack_rows(words, algebra.dimension), lifts, projection.select(columns=pivots))
    return [inverse @ block for block in table]


def _shifts(field: ExactField, plan: _Plan, rho: list[ExactMatrix], d: int) -> list[ExactMatrix]:
    """For each word the matrix (2 d, d) that maps (y_a, y_b) to the change of the word if they are added to a, b."""
    zero, one = field.zeros(d, d), field.identity(d)
    made = [field.stack_rows([one, zero], d), field.stack_rows([zero, one], d)]
    for generator, parent in plan.steps:
        made.append(made[parent] @ rho[generator] - made[generator] @ rho[parent])
    return made
