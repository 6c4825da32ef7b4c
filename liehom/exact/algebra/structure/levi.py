"""The radical, the nilradical and the Levi decomposition."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import InternalError, SingularError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra, complement_rows, products
from liehom.exact.algebra.core.tables import balanced
from liehom.exact.algebra.structure.centroid import exact_field, flat_rows
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.floating import FloatMatrix
from liehom.exact.scalars.modular import extending_rows, stacked_residues
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import echelon_quotient, short_basis

# The solvable radical and the nilradical.
#
#     rad(g) = {x : K(x, [g, g]) = 0},    nil(g) = {x in rad(g) : ad x is nilpotent},
#
# with K the Killing form (Cartan's criterion; Jacobson, Lie Algebras, chapters II and III).  Both formulas hold in
# characteristic 0.

ATTEMPTS = 20  # random elements of the radical


def radical(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.radical`."""
    field, n = algebra.field, algebra.dimension
    if not field.exact:
        return _over_floats(algebra)
    killing = algebra.killing_form()
    if n == 0 or (isinstance(killing, ExactMatrix) and int(killing.modulo().rank()) == n):
        return Subalgebra(algebra, field.zeros(0, n), check=False)  # Cartan's criterion: semisimple
    one = field.identity(n)
    derived = products(algebra, one, one)
    basis = (derived @ killing).null_space() if derived.nrows else one
    return Subalgebra(algebra, basis, check=False)  # the radical is an ideal


def _over_floats(algebra: LieAlgebra) -> Subalgebra:
    """The radical over floats, in a basis in which the structure constants have similar sizes."""
    field, n, question = algebra.field, algebra.dimension, "the dimension of the radical"
    if algebra.is_semisimple():
        return Subalgebra(algebra, field.zeros(0, n), check=False)
    table, lengths = balanced(algebra.table)
    inner = LieAlgebra(table, check=False)  # a basis of the same algebra
    one = field.identity(n)
    derived = products(inner, one, one)
    if not derived.nrows:
        return Subalgebra(algebra, one, check=False)
    basis: Any = (derived @ inner.killing_form()).null_space(question)
    back = (basis @ FloatMatrix(basis.field, np.diag(lengths), 0.0)).row_space(question)
    return Subalgebra(algebra, back, check=False)  # the radical is an ideal


def nilradical(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.nilradical`."""
    field, n = exact_field(algebra, "nilradicals"), algebra.dimension
    solvable = radical(algebra)
    basis = as_exact(solvable.basis)
    inner = products(algebra, field.identity(n), basis)
    if inner.nrows == solvable.dimension:
        return Subalgebra(algebra, inner, check=False)  # [g, rad g] is a nilpotent ideal
    outer = complement_rows(basis, inner)
    rng = random.Random(n)
    for _ in range(ATTEMPTS):
        kept = _annihilated_by_weights(algebra, outer, field.matrix([[rng.randint(-9, 9) for _ in range(outer.nrows)]]))
        characteristic = (algebra.ad(kept.select(rows=[i])).characteristic_coefficients() for i in range(kept.nrows))
        if all(c == 0 for coefficients in characteristic for c in coefficients[:-1]):  # all act nilpotently
            rows = field.stack_rows([inner, kept], n).row_space()
            return Subalgebra(algebra, rows, check=False)  # the nilradical is an ideal
    raise InternalError("no element of the radical separates its weights")


def _annihilated_by_weights(algebra: LieAlgebra, outer: ExactMatrix, coefficients: ExactMatrix) -> ExactMatrix:
    """The combinations x of rows with tr(ad x (ad y)^k) = 0 for all k >= 1, for one combination y with coefficients."""
    field = outer.field
    adjoints = [algebra.ad(outer.select(rows=[i])) for i in range(outer.nrows)]
    y = algebra.ad(coefficients @ outer)
    characteristic = Polynomial(field, y.characteristic_coefficients())
    distinct = sum(f.degree for f, _ in characteristic.squarefree_parts())
    conditions, power = [], field.identity(algebra.dimension)
    for _ in range(distinct):
        power = power @ y
        conditions.append([(a @ power).trace() for a in adjoints])
    return field.matrix(conditions, (distinct, outer.nrows)).null_space() @ outer


# The Levi decomposition g = s + rad(g): a semisimple subalgebra that complements the radical.
# Two elements a, b generate g/rad(g), so it has a basis of words in a and b, that is, iterated brackets.  Let
# r = r_0 > r_1 > ... be the derived series of the radical and V = r_t / r_{t+1}, an abelian ideal of g / r_{t+1}.  A
# section over g / r_t is corrected by adding y_a, y_b in V to the lifts of a and b.  The relations between the words
# become linear equations in these 2 dim V unknowns, which have a solution by Whitehead's second lemma.  Relations with
# a and b are enough, because the x whose brackets with every word lift correctly form a subalgebra.

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
    below = as_exact(ideal.basis)
    coordinates = echelon_quotient(below)
    field, lift = below.field, coordinates.lift
    blocks = algebra.table.contract(lift, lift, coordinates.projection)
    # The bracket descends to the quotient by the radical.
    plan = _plan(LieAlgebra(StructureConstants.from_blocks(field, lift.nrows, blocks), check=False))
    generators = [x @ lift for x in plan.pair]
    while below.nrows:
        above, below = below, products(algebra, below, below)
        generators = _corrected(algebra, plan, generators, above, below)
    return short_basis(field.stack_rows(_words(algebra, generators, plan.steps), algebra.dimension))


class _Plan(NamedTuple):
    """Words in two generators, rows (1, dim g/rad(g)), that are a basis of g/rad(g), and their relations."""

    pair: list[ExactMatrix]
    steps: list[Word]
    relations: list[Relation]


def _words(algebra: LieAlgebra, generators: list[ExactMatrix], steps: list[Word]) -> list[ExactMatrix]:
    """The words in two generators, as rows."""
    actions = [algebra.ad(x).T for x in generators]
    words = list(generators)
    for generator, parent in steps:
        words.append(words[parent] @ actions[generator])
    return words


def _plan(algebra: LieAlgebra) -> _Plan:
    """A plan for a semisimple algebra, from the first two small elements that generate it."""
    field, n = exact_field(algebra, "Levi factors"), algebra.dimension
    rng = random.Random(n)
    for attempt in range(1, PAIRS):
        size = 1 + attempt // STRIDE
        pair = [field.matrix([[rng.randint(-size, size) for _ in range(n)]]) for _ in range(2)]
        steps = _spanning_words(algebra, pair)
        if steps is not None:
            return _Plan(pair, steps, _relations(algebra, pair, steps))
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


def _relations(algebra: LieAlgebra, pair: list[ExactMatrix], steps: list[Word]) -> list[Relation]:
    """The brackets [generator, word] in terms of the words, except those that are words themselves."""
    n = algebra.dimension
    words = pair[0].field.stack_rows(_words(algebra, pair, steps), n)
    inverse = words.inverse()
    coordinates = [words @ algebra.ad(x).T @ inverse for x in pair]
    others = [(g, word) for g in (0, 1) for word in range(n) if word != g and (g, word) not in set(steps)]
    return [(g, word, coordinates[g].select(rows=[word])) for g, word in others]


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
    inverse = change.inverse()
    words = _words(algebra, generators, plan.steps)
    stacked = field.stack_rows(words, algebra.dimension)
    # rho[w] is the matrix (d, d) of ad of word w on V, on rows in the echelon basis
    blocks = algebra.table.contract(stacked, lifts, projection.select(columns=pivots))
    rho = [inverse @ block for block in blocks]
    shifts = _shifts(field, plan, rho, d)
    flat = flat_rows(shifts)
    equations, constants = [], []
    actions = [algebra.ad(x).T for x in generators]
    for generator, word, row in plan.relations:
        defect = (words[word] @ actions[generator] - row @ stacked) @ projection
        constants.append(-defect.select(columns=pivots))
        change_of = shifts[word] @ rho[generator] - shifts[generator] @ rho[word]
        equations.append(change_of - (row @ flat).reshape(2 * d, d))
    try:
        solution = field.stack_columns(equations, 2 * d).T.solve(field.stack_columns(constants, 1).T).T
    except SingularError:
        raise InternalError("the equations of a Levi factor have no solution") from None
    correction = solution.reshape(2, d) @ inverse @ lifts
    return [x + correction.select(rows=[i]) for i, x in enumerate(generators)]


def _shifts(field: ExactField, plan: _Plan, rho: list[ExactMatrix], d: int) -> list[ExactMatrix]:
    """For each word the matrix (2 d, d) that maps (y_a, y_b) to the change of the word if they are added to a, b."""
    zero, one = field.zeros(d, d), field.identity(d)
    shifts = [field.stack_rows([one, zero], d), field.stack_rows([zero, one], d)]
    for generator, parent in plan.steps:
        shifts.append(shifts[parent] @ rho[generator] - shifts[generator] @ rho[parent])
    return shifts
