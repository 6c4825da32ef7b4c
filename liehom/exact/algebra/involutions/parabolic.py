"""Split tori, restricted root spaces and parabolic subalgebras."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from operator import index
from typing import final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import InputError, InternalError, SingularError, UndecidedError, displayed
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.involutions.cartan_involution import approximate_involution, orthonormal_frame
from liehom.exact.algebra.involutions.rational_involution import generic_nilpotent, lattice_order
from liehom.exact.algebra.roots.diagrams import gram_to_cartan
from liehom.exact.algebra.roots.real_form import RealForm
from liehom.exact.algebra.roots.root_system import Root, isomorphisms
from liehom.exact.algebra.structure.centroid import evaluate, exact_field, minimal_polynomial
from liehom.exact.algebra.structure.identification import SimplePart, simple_parts
from liehom.exact.algebra.structure.root_spaces import cartan_subalgebra, diagonal_weights, simple_roots
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.subspaces import integral_basis, short_basis

# A maximal split torus of a semisimple algebra: a maximal abelian subalgebra of elements with real eigenvalues.
# All eigenvalues of its elements are in the field F of the algebra.  Let t be a subalgebra of commuting x for which ad
# x is diagonalizable over F, and m the Killing complement of t in its centralizer.  If the Killing form K is negative
# definite on m, then t is maximal over the reals: if y in m has real eigenvalues, K(y, y) is the sum of their squares,
# hence y = 0.  Otherwise an element of m is added to t.  All maximal split tori over F are conjugate (Borel, Tits), so
# the choice of this element does not matter.  If the rank over F is smaller than the real rank, there is no such torus.
#
# In a torus c, the elements x for which all alpha(x) are in F are the Killing duals of the traces of c on the sums of
# weight spaces of weights that are conjugate over F.

REAL = 1e-6  # largest imaginary part of an eigenvalue, relative to the largest eigenvalue, that counts as 0
SUMS = 400  # sums and differences of two rows that are tried
HYPERBOLIC = 500  # elements of p of each height that are tried
LATTICE_DIMENSION = 60  # dimension up to which nilpotent elements are searched by lattice reduction
WEIGHT = 99  # bound on the coefficients of a generic element


def maximal_split_torus(algebra: LieAlgebra) -> ExactMatrix:
    """A basis, as rows (r, n), of a split torus over the field that is maximal over the reals; r is the real rank."""
    field, n = exact_field(algebra, "split tori"), algebra.dimension
    killing = as_exact(algebra.killing_form())
    cartan = as_exact(cartan_subalgebra(algebra).basis)
    rows = [cartan.select(rows=[i]) for i in range(cartan.nrows)]
    split = [x for x in rows if (x @ killing @ x.T).trace() > 0 and eigenvalues(algebra, x) is not None]
    torus = short_basis(field.stack_rows(split, n))  # elements of a Cartan subalgebra commute
    while True:
        centralizer = rest = as_exact(algebra.centralizer(torus).basis) if torus.nrows else field.identity(n)
        if torus.nrows:
            rest = ((centralizer @ killing @ torus.T).T.null_space() @ centralizer).row_space()
        if (-(rest @ killing @ rest.T)).is_positive_definite():
            return torus
        split_rows = _split_element(algebra, killing, centralizer, torus, rest)
        if split_rows is None:
            raise UndecidedError(
                f"no split torus of {algebra!r} with eigenvalues in {field.name} was found that is maximal over the "
                f"reals; one of dimension {torus.nrows} was found. Give the algebra over a real number field that "
                "contains the eigenvalues (algebra.over), or in a basis with small structure constants"
            )
        torus = short_basis(field.stack_rows([torus, split_rows], n))


def eigenvalues(algebra: LieAlgebra, x: ExactMatrix) -> list[Scalar] | None:
    """The eigenvalues of ad x if it is diagonalizable over the field of the algebra, else None."""
    field, action = x.field, algebra.ad(x)
    if (weights := diagonal_weights(algebra, x)) is not None:
        return sorted({value for (value,) in weights}, key=field.to_float)
    floats = np.linalg.eigvals(action.to_numpy())
    if np.abs(floats.imag).max() > REAL * np.abs(floats).max():
        return None
    rng = random.Random(algebra.dimension)
    start = field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(algebra.dimension)]])
    polynomial = minimal_polynomial(action, start)
    factors = polynomial.factor()
    if any(f.degree > 1 or k > 1 for f, k in factors) or not evaluate(polynomial, action).is_zero():
        return None
    return sorted((-f.monic().coefficients[0] for f, _ in factors), key=field.to_float)


def split_part(algebra: LieAlgebra, torus: ExactMatrix) -> ExactMatrix:
    """The elements of a torus whose eigenvalues are in the field of the algebra, as a basis (r, n)."""
    field = torus.field
    if not torus.nrows:
        return torus
    rng = random.Random(torus.nrows)
    weights = field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(torus.nrows)]])
    start = field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(algebra.dimension)]])
    action = algebra.ad(weights @ torus)
    actions = [algebra.ad(torus.select(rows=[i])) for i in range(torus.nrows)]
    traces = []
    for f, _ in minimal_polynomial(action, start).factor():
        space, pivots = evaluate(f, action).null_space().echelon()
        traces.append([(space @ a.T).select(columns=pivots).trace() for a in actions])
    gram = torus @ as_exact(algebra.killing_form()) @ torus.T
    return (field.matrix(traces) @ gram.inverse() @ torus).row_space()


def _split_element(
    algebra: LieAlgebra, killing: ExactMatrix, centralizer: ExactMatrix, torus: ExactMatrix, rest: ExactMatrix
) -> ExactMatrix | None:
    """A row of `rest` that is diagonalizable over the field, or a row basis of several that commute, or None."""
    dual = killing @ torus.T
    projection = dual @ (torus @ dual).inverse() @ torus if torus.nrows else None  # to the torus, on rows
    for x in _short_elements(centralizer, rest):
        in_time()
        y = x if projection is None else x - x @ projection
        if (y @ killing @ y.T).trace() > 0 and eigenvalues(algebra, y) is not None:
            return y.primitive()
    if torus.nrows:
        center = as_exact(Subalgebra(algebra, centralizer, check=False).as_algebra().center().basis) @ centralizer
    else:
        center = as_exact(cartan_subalgebra(algebra).basis)
    split = split_part(algebra, center)
    if rest.field.stack_rows([torus, split], algebra.dimension).rank() > torus.nrows:
        return split
    semisimple = _of_the_semisimple_part(algebra, rest)
    return next((x for x in semisimple if eigenvalues(algebra, x) is not None), None)


def _short_elements(centralizer: ExactMatrix, rest: ExactMatrix) -> Iterator[ExactMatrix]:
    """Rows of the centralizer that may be split: basis elements, then sums of two."""
    rows = [basis.select(rows=[i]) for basis in (centralizer.row_space(), rest) for i in range(basis.nrows)]
    yield from rows
    pairs = [(rows[i], rows[j]) for j in range(len(rows)) for i in range(j)]
    yield from (z for x, y in pairs[:SUMS] for z in (x + y, x - y))


def _of_the_semisimple_part(algebra: LieAlgebra, rest: ExactMatrix) -> Iterator[ExactMatrix]:
    """Rows (1, n) of the semisimple part of a reductive subalgebra over QQ that may be split, from a large order."""
    reductive = Subalgebra(algebra, rest, check=False)  # the Killing complement of a split torus in its centralizer
    rows = as_exact(reductive.as_algebra().derived_subalgebra().basis) @ rest
    if rest.field.degree > 1 or not 0 < rows.nrows <= LATTICE_DIMENSION:
        return
    rows = integral_basis(rows)
    inner = Subalgebra(algebra, rows, check=False).as_algebra()
    rank = cartan_subalgebra(inner).dimension
    theta = approximate_involution(inner, rank)
    if theta is None:
        return
    try:
        order = lattice_order(inner, orthonormal_frame(inner, theta))
        inner = inner.change_of_basis(order)
        theta = approximate_involution(inner, rank)
        triple = None if theta is None else generic_nilpotent(inner, theta)
    except (np.linalg.LinAlgError, SingularError):  # double precision was not enough
        return
    elements = [triple.h] if triple is not None else _hyperbolic_elements(inner)
    yield from (x @ order @ rows for x in elements)


def _hyperbolic_elements(algebra: LieAlgebra) -> Iterator[ExactMatrix]:
    """Small x of p, (1, n), for which all eigenvalues of ad x (in an order algebraic integers) are near integers."""
    try:
        p = algebra.cartan_decomposition().p
    except UndecidedError:
        return
    rows = integral_basis(as_exact(p.basis))
    actions = np.array([algebra.ad(rows.select(rows=[i])).to_numpy() for i in range(rows.nrows)])
    rng = np.random.default_rng(rows.nrows)
    for height in (1, 2, 3):
        weights = np.unique(rng.integers(-height, height + 1, (HYPERBOLIC, rows.nrows)), axis=0)
        values = np.linalg.eigvals(np.tensordot(weights.astype(float), actions, 1))
        near = np.abs(values - np.rint(values.real)).max(axis=1) < REAL * np.abs(values).max(axis=1)
        for weight in weights[near].tolist():
            in_time()
            yield rows.field.from_integers(weight, 1, rows.nrows) @ rows


# The restricted root spaces of a semisimple real algebra, with simple roots numbered as in Satake diagrams.
# g = z(a) + sum of g_lambda for a maximal split torus a, [x, v] = lambda(x) v for x in a and v in g_lambda.  A root is
# positive if its last coordinate that is not 0 is positive, in a basis of restricted roots that is chosen by the basis
# of the algebra.  For a basis of root vectors, such as a Chevalley basis or the matrix units of sl(n), these are the
# usual positive roots.
#
# The simple roots are numbered by an isomorphism with the restricted root system of the Satake diagram that preserves
# multiplicities.  If there are several, the root spaces are numbered in the order of the basis as far as possible.


@final
@dataclass(frozen=True, slots=True)
class RestrictedRootSpaces:
    """The decomposition of a semisimple algebra under a maximal split torus."""

    torus: ExactMatrix  # a basis, as rows (r, n)
    centralizer: ExactMatrix  # of the torus, as rows
    spaces: dict[Root, ExactMatrix]  # of roots, by their coefficients in simple ones

    @property
    def rank(self) -> int:
        """The real rank, an int: the number of simple restricted roots."""
        return self.torus.nrows


@lru_cache(maxsize=16)
def restricted_root_spaces(algebra: LieAlgebra) -> RestrictedRootSpaces:
    """The restricted root spaces of a semisimple algebra, the simple ideals in the order of `LieAlgebra.real_forms`."""
    if not algebra.is_semisimple():
        raise InputError(
            "only a semisimple algebra has restricted roots and parabolic subalgebras; take the Levi factor of "
            "levi_decomposition()"
        )
    ideals = simple_parts(algebra)
    if len(ideals) == 1:
        return _of_simple(algebra, ideals[0])
    field, n = algebra.field, algebra.dimension
    parts = [(as_exact(part.ideal.basis), _of_simple(part.ideal.as_algebra(), part)) for part in ideals]
    rank, start = sum(own.rank for _, own in parts), 0
    spaces = {}
    for rows, own in parts:
        for root, space in own.spaces.items():
            spaces[(0,) * start + root + (0,) * (rank - start - own.rank)] = space @ rows
        start += own.rank
    torus = field.stack_rows([own.torus @ rows for rows, own in parts], n)
    return RestrictedRootSpaces(torus, field.stack_rows([own.centralizer @ rows for rows, own in parts], n), spaces)


def _of_simple(algebra: LieAlgebra, part: SimplePart) -> RestrictedRootSpaces:
    """The decomposition of an algebra that is simple over its field."""
    torus = maximal_split_torus(algebra)
    if not torus.nrows:
        return RestrictedRootSpaces(torus, torus.field.identity(algebra.dimension), {})
    weights = _weight_spaces(algebra, torus)
    zero = (torus.field.zero,) * torus.nrows
    values = [value for value in weights if value != zero]
    sizes = [weights[value].nrows for value in values]
    simple = simple_roots(torus.field.matrix(values))
    chosen = torus.field.matrix([values[i] for i in simple])
    gram = (torus @ as_exact(algebra.killing_form()) @ torus.T).inverse()
    inner = (chosen @ gram @ chosen.T).to_rows()
    cartan = torus.field.matrix([[2 * x / inner[j][j] for j, x in enumerate(row)] for row in inner])
    doubled = [tuple(2 * x for x in values[i]) for i in simple]
    multiplicities = [(sizes[i], weights[v].nrows if v in weights else 0) for i, v in zip(simple, doubled, strict=True)]
    order = _numbering(part.real_forms(), _integers(cartan), multiplicities)
    coefficients = torus.field.matrix(values) @ chosen.select(rows=order).inverse()
    spaces = {tuple(row): weights[value] for row, value in zip(_integers(coefficients), values, strict=True)}
    return RestrictedRootSpaces(torus, weights[zero], spaces)


def _weight_spaces(algebra: LieAlgebra, torus: ExactMatrix) -> dict[tuple[Scalar, ...], ExactMatrix]:
    """The joint eigenspaces of a split torus, by the eigenvalues of its basis, in the order of their pivots."""
    field, n = torus.field, algebra.dimension
    spaces: dict[tuple[Scalar, ...], ExactMatrix] = {(): field.identity(n)}
    if (weights := diagonal_weights(algebra, torus)) is not None:
        places: dict[tuple[Scalar, ...], list[int]] = {}
        for j, weight in enumerate(weights):
            places.setdefault(weight, []).append(j)
        spaces = {weight: spaces[()].select(rows=own) for weight, own in places.items()}
    for i in range(torus.nrows if weights is None else 0):
        x = torus.select(rows=[i])
        action, values = algebra.ad(x).T, eigenvalues(algebra, x)
        if values is None:
            raise InternalError("an element of a split torus is not diagonalizable")
        finer = {}
        for value, space in spaces.items():
            echelon, pivots = space.echelon()
            block = (echelon @ action).select(columns=pivots).T
            left = len(pivots)
            for c in values:
                kernel = (block - field.identity(len(pivots)).scale(c)).null_space() if left else field.zeros(0, 0)
                if kernel.nrows:
                    finer[(*value, c)] = (kernel @ echelon).row_space()
                    left -= kernel.nrows
        spaces = finer
    if sum(space.nrows for space in spaces.values()) < n:
        raise InternalError("the joint eigenspaces of a split torus do not span the algebra")
    pivots_of = {value: space.echelon()[1] for value, space in spaces.items()}
    signs = {value: [-field.sign(x) for x in value] for value in spaces}
    return {value: spaces[value] for value in sorted(spaces, key=lambda value: (pivots_of[value], signs[value]))}


def _numbering(
    forms: list[RealForm], cartan: list[list[int]], multiplicities: list[tuple[int, int]]
) -> tuple[int, ...]:
    """For each simple restricted root of the Satake diagram in turn, the index of the corresponding simple root."""
    if len(forms) == 1:
        satake = forms[0].satake
        simple, sizes = satake.simple_restricted_roots(), satake.restricted_roots()
        expected = [(sizes[a], sizes.get(tuple(2 * x for x in a), 0)) for a in simple]
        for order in isomorphisms(gram_to_cartan(satake.root_system(), simple), cartan):
            if [multiplicities[i] for i in order] == expected:
                return order
    raise InternalError("the restricted roots are not those of the Satake diagram")


def _integers(matrix: ExactMatrix) -> list[list[int]]:
    """The entries of a matrix whose entries are integers, as ints."""
    if matrix.den != 1 or any(not part.is_zero() for part in matrix.parts[1:]):
        raise InternalError(f"expected integers, got {matrix}")
    return [[int(matrix.parts[0][i, j]) for j in range(matrix.ncols)] for i in range(matrix.nrows)]


# Parabolic subalgebras: sums of the restricted root spaces on which a grading element has eigenvalues at least 0.


def parabolic_subalgebra(algebra: LieAlgebra, crossed: Iterable[int]) -> Subalgebra:
    """Implements `LieAlgebra.parabolic_subalgebra`."""
    decomposition = restricted_root_spaces(algebra)
    nodes = _checked(crossed, decomposition.rank)
    kept = [space for root, space in decomposition.spaces.items() if sum(root[i] for i in nodes) >= 0]
    rows = as_exact(algebra.field.stack_rows([decomposition.centralizer, *kept], algebra.dimension))
    # no check: the grading by the sum of the coefficients at the crossed roots is one of the algebra
    return Subalgebra(algebra, short_basis(rows), check=False)


def _checked(crossed: Iterable[int], rank: int) -> list[int]:
    """The numbers of the crossed roots, sorted; `InputError` if one is not an integer in range(rank)."""
    if isinstance(crossed, Iterable) and not isinstance(crossed, str | bytes):
        nodes = list(crossed)
        if all(hasattr(i, "__index__") and 0 <= i < rank for i in nodes):
            return sorted({index(i) for i in nodes})
    known = f"0, ..., {rank - 1}" if rank else "none, because the algebra is compact"
    raise InputError(
        f"expected the numbers of crossed simple restricted roots ({known}), such as [0]; got {displayed(crossed)}"
    )
