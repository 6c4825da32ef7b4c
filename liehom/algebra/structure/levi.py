"""The Levi decomposition g = s + rad(g): a semisimple subalgebra that complements the radical.

Two elements a, b generate g/rad(g), so a basis of it consists of words in a and b.  Along the derived series
r = r_0 > r_1 > ... of the radical, r_t / r_{t+1} = V is an abelian ideal of g / r_{t+1}, and a section over
g / r_t is corrected by adding y_a, y_b in V to the lifts of a and b: the relations of the words become linear
equations in these 2 dim V unknowns, which Whitehead's second lemma solves.
(The subalgebra of all x whose brackets with every word lift correctly is closed, so relations with a and b are enough.)
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.subalgebra import Subalgebra, products
from liehom.algebra.structure.radical import radical
from liehom.errors import FieldError, InternalError, SingularError
from liehom.scalars.modular.modular import extending_rows, stacked_residues
from liehom.scalars.spaces.quotient import echelon_quotient

Word = tuple[int, int]  # (generator, index of the word it acts on); the generators are words 0 and 1


@final
@dataclass(frozen=True, slots=True)
class LeviDecomposition:
    """g as the semidirect sum of a semisimple subalgebra and the radical.

    Attributes
    ----------
    levi : Subalgebra
        A Levi factor: semisimple, a complement of the radical.
    radical : Subalgebra
    """

    levi: Subalgebra
    radical: Subalgebra

    def __iter__(self) -> Iterator[Subalgebra]:
        return iter((self.levi, self.radical))


def levi_decomposition(algebra: LieAlgebra) -> LeviDecomposition:
    """Implements `LieAlgebra.levi_decomposition`."""
    if not algebra.field.exact:
        raise FieldError("a Levi factor is computed exactly: build the algebra over QQ or a number field")
    ideal = radical(algebra)
    n = algebra.dimension
    if ideal.dimension == 0:
        return LeviDecomposition(Subalgebra(algebra, algebra.field.identity(n), check=False), ideal)
    if ideal.dimension == n:
        return LeviDecomposition(Subalgebra(algebra, algebra.field.zeros(0, n), check=False), ideal)
    return LeviDecomposition(Subalgebra(algebra, _levi_rows(algebra, ideal)), ideal)


def _levi_rows(algebra: LieAlgebra, ideal: Subalgebra) -> Any:
    field, n = algebra.field, algebra.dimension
    coordinates = echelon_quotient(ideal.basis)
    lift = coordinates.lift
    blocks = algebra.table.contract(lift, lift, coordinates.projection)
    # The bracket descends to the quotient by the radical.
    plan = _plan(LieAlgebra(StructureConstants.from_blocks(field, lift.nrows, blocks), check=False))
    generators = [plan.first @ lift, plan.second @ lift]
    below = ideal.basis
    while below.nrows:
        above, below = below, products(algebra, below, below)
        generators = _corrected(algebra, plan, generators, above, below)
    words = plan.words_of(algebra, generators)
    return field.stack_rows(words, n).row_space()


@final
@dataclass(frozen=True, slots=True)
class _Plan:
    """Words in two generators that are a basis of g/rad(g), and their relations.

    first, second: rows of coefficients in g/rad(g); steps: the words after these two; relations: (generator, word,
    row of the coefficients of their bracket in the words).
    """

    first: Any
    second: Any
    steps: tuple[Word, ...]
    relations: tuple[tuple[int, int, Any], ...]

    def words_of(self, algebra: LieAlgebra, generators: Sequence[Any]) -> list[Any]:
        """The words as rows of g, for given lifts of the generators."""
        actions = [algebra.ad(x).T for x in generators]
        made = list(generators)
        for generator, parent in self.steps:
            made.append(made[parent] @ actions[generator])
        return made


def _plan(algebra: LieAlgebra) -> _Plan:
    """A plan for a semisimple algebra, from the first two small elements that generate it."""
    field, n = algebra.field, algebra.dimension
    rng = random.Random(n)
    for attempt in range(1, 200):
        size = 1 + attempt // 20
        pair = [field.matrix([[rng.randint(-size, size) for _ in range(n)]]) for _ in range(2)]
        steps = _spanning_words(algebra, pair)
        if steps is not None:
            unrelated = _Plan(pair[0], pair[1], tuple(steps), ())
            return _Plan(pair[0], pair[1], tuple(steps), _relations(algebra, unrelated))
    raise InternalError("no two elements generate a semisimple algebra")


def _spanning_words(algebra: LieAlgebra, pair: list[Any]) -> list[Word] | None:
    """Words that with the pair are a basis, chosen modulo a prime; None if the pair does not generate."""
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


def _relations(algebra: LieAlgebra, plan: _Plan) -> tuple[tuple[int, int, Any], ...]:
    """[generator, word] in terms of the words, where that is not itself a word."""
    field, n = algebra.field, algebra.dimension
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


def _corrected(algebra: LieAlgebra, plan: _Plan, generators: list[Any], above: Any, below: Any) -> list[Any]:
    """Lifts of the generators whose words satisfy the relations modulo `below`, if they did modulo `above`."""
    field = algebra.field
    projection = echelon_quotient(below).projection if below.nrows else field.identity(algebra.dimension)
    images = (above @ projection).echelon()
    basis, pivots = images
    d = basis.nrows
    lifts = above.select(rows=(above @ projection).T.echelon()[1])
    change = (lifts @ projection).select(columns=pivots)  # rows: the lifted basis in the echelon basis
    words = plan.words_of(algebra, generators)
    stacked = field.stack_rows(words, algebra.dimension)
    # rho[w]: rows of V (echelon basis), acted on from the right by ad of word w
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


def _module(algebra: LieAlgebra, words: list[Any], lifts: Any, projection: Any, pivots: list[int], change: Any) -> Any:
    field = algebra.field
    inverse = change.inverse()
    table = algebra.table.contract(field.stack_rows(words, algebra.dimension), lifts, projection.select(columns=pivots))
    return [inverse @ block for block in table]


def _shifts(field: Any, plan: _Plan, rho: list[Any], d: int) -> list[Any]:
    """For each word the matrix (2 d, d): how it moves when (y_a, y_b) is added to the generators."""
    zero, one = field.zeros(d, d), field.identity(d)
    made = [field.stack_rows([one, zero], d), field.stack_rows([zero, one], d)]
    for generator, parent in plan.steps:
        made.append(made[parent] @ rho[generator] - made[generator] @ rho[parent])
    return made
