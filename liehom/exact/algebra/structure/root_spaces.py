"""Cartan subalgebras, root spaces and roots."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.base.errors import InputError, InternalError
from liehom.base.typing import Array, IntegerArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import EXACT_FLOATS, exact_floats
from liehom.exact.algebra.core.subalgebra import Subalgebra, independent_rows
from liehom.exact.algebra.roots.diagrams import simple_system
from liehom.exact.algebra.roots.root_system import CartanMatrix, RootSystem
from liehom.exact.algebra.structure.centroid import evaluate, exact_field
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.joint_spectrum import Balls, JointSpectrum, joint_spectrum
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import SHORT_BITS, Subspace, echelon_quotient, integral_basis

# A Cartan subalgebra: nilpotent and its own normalizer.
# For x in g let g_0(x) = {y : (ad x)^k y = 0 for some k} be the Fitting null component of ad x, a subalgebra that is
# its own normalizer.  The algorithm starts with g.  As long as the subalgebra is not nilpotent, some element of its
# basis or some sum of two basis elements has a smaller null component in it (de Graaf, Lie Algebras: Theory and
# Algorithms, 3.2). Basis elements are tried first, so that a basis of root vectors gives the split Cartan subalgebra
# that it contains.

Entries = tuple[object, ...]  # the integer coordinates of an element


def cartan_subalgebra(algebra: LieAlgebra) -> Subalgebra:
    """Implements `LieAlgebra.cartan_subalgebra`."""
    field, n = exact_field(algebra, "Cartan subalgebras"), algebra.dimension
    rows, pivots = field.identity(n), list(range(n))
    tried: set[Entries] = set()
    while not _is_abelian(algebra, rows) and (smaller := _smaller(algebra, rows, pivots, tried)) is not None:
        rows, pivots = smaller
    basis = rows.primitive() if rows.nrows else rows
    if any(int(abs(x)).bit_length() > SHORT_BITS for part in basis.parts for x in part.entries()):
        basis = integral_basis(rows)
    abelian = _is_abelian(algebra, basis)
    cartan = Subalgebra(algebra, basis, check=not abelian)  # echelon rows are independent
    if not abelian and cartan.as_algebra().lower_central_series()[-1].dimension:
        raise InternalError("no element has a smaller null component, but the subalgebra is not nilpotent")
    if not is_self_normalizing(cartan):
        raise InternalError("a null component is not its own normalizer")
    return cartan


def is_self_normalizing(subalgebra: Subalgebra) -> bool:
    """Whether h is its own normalizer: it is if an element acts on g/h without a kernel, modulo a prime."""
    algebra, basis = subalgebra.algebra, as_exact(subalgebra.basis)
    if 0 < basis.nrows < algebra.dimension:
        rng = random.Random(basis.nrows)
        x = algebra.field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(basis.nrows)]]) @ basis
        coordinates = echelon_quotient(basis)
        action = coordinates.lift @ algebra.ad(x).T @ coordinates.projection
        if int(action.modulo().rank()) == action.nrows:
            return True
    return algebra.normalizer(subalgebra).dimension == subalgebra.dimension


def _is_abelian(algebra: LieAlgebra, rows: ExactMatrix) -> bool:
    """Whether all rows commute; two random combinations are tried first."""
    one = algebra.field.identity(algebra.dimension)
    if rows.nrows > 2:
        weights = [[i + 1 for i in range(rows.nrows)], [(i + 1) ** 2 % 17 - 8 for i in range(rows.nrows)]]
        pair = rows.field.matrix(weights) @ rows
        if algebra.table.first_nonzero(pair.select(rows=[0]), pair.select(rows=[1]), one) is not None:
            return False
    return algebra.table.first_nonzero(rows, rows, one) is None


def _smaller(
    algebra: LieAlgebra, rows: ExactMatrix, pivots: list[int], tried: set[Entries]
) -> tuple[ExactMatrix, list[int]] | None:
    """A smaller null component in the span of the rows, as an echelon basis with its pivots, or None.

    The rows are an echelon basis of a subalgebra, so the entries of an element at the pivots are its coordinates.
    An element that acts nilpotently on a subalgebra also does on the subalgebras of it, and x acts nilpotently on
    g_0(x). Elements in `tried` are therefore skipped.
    """
    for candidate in _candidates(rows):
        key = tuple(x for part in candidate.parts for x in part.entries())
        if key in tried:
            continue
        tried.add(key)
        if _is_clearly_nilpotent(algebra, candidate):
            continue
        action = algebra.ad(candidate).T
        if rows.nrows < algebra.dimension:
            action = (rows @ action).select(columns=pivots)
        step, before = action.modulo(), rows.nrows
        rank = int(step.rank())
        while 0 < rank < before:  # ranks of powers decrease until they are constant
            step, before = step * step, rank
            rank = int(step.rank())
        if rank:
            return (_null_component(action, rows.nrows - rank) @ rows).echelon()
    return None


def _is_clearly_nilpotent(algebra: LieAlgebra, x: ExactMatrix) -> bool:
    """Whether (ad x)^4 = 0 in float64, where its numerators are exact, as for a root vector; x is a row (1, n)."""
    values, weights = algebra.table.floats(), None if x.field.degree > 1 else exact_floats(x)
    if values is None or weights is None:
        return False
    action = algebra.table.adjoint_floats(weights[0], values)
    square = action @ action
    small = np.abs(action).sum(axis=1).max() ** 4 < EXACT_FLOATS
    return bool(small and not (square @ square).any())


def _null_component(action: ExactMatrix, expected: int) -> ExactMatrix:
    """A basis of the rows that some power of the action annihilates, `expected` many modulo a prime."""
    power, kernel = action, action.left_null_space()
    while kernel.nrows < expected:
        power, smaller = power @ action, kernel
        kernel = power.left_null_space()
        if kernel.nrows == smaller.nrows:
            return smaller
    return kernel


def _candidates(rows: ExactMatrix) -> Iterator[ExactMatrix]:
    """The rows, then their pairwise sums."""
    yield from (rows.select(rows=[i]) for i in range(rows.nrows))
    yield from (rows.select(rows=[i]) + rows.select(rows=[j]) for i in range(rows.nrows) for j in range(i))


# Bases of weight vectors, such as a Chevalley basis: the weights are on the diagonals of the matrices ad h.


def diagonal_weights(algebra: LieAlgebra, torus: ExactMatrix) -> list[tuple[Scalar, ...]] | None:
    """The weights of the basis elements, if all rows of the torus act diagonally in the basis of the algebra."""
    n, weights = algebra.dimension, []
    for i in range(torus.nrows):
        action = algebra.ad(torus.select(rows=[i]))
        if any(x for part in action.parts for place, x in enumerate(part.entries()) if place % (n + 1)):
            return None
        weights.append([action[j, j] for j in range(n)])
    return list(zip(*weights, strict=True))


def simple_roots(values: ExactMatrix) -> list[int]:
    """The indices of the simple ones among the roots with these values (m, r), in the order of the rows."""
    base = values.select(rows=independent_rows(values))
    coordinates = values @ base.inverse()  # rational: fractions with one denominator
    roots = [tuple(int(coordinates.parts[0][i, j]) for j in range(values.ncols)) for i in range(values.nrows)]
    index = {root: i for i, root in enumerate(roots)}
    return sorted(index[root] for root in simple_system(roots, lambda a: a[::-1]))


# The root space decomposition g = h + sum of V_alpha over the field of the algebra.
# For a generic x in a Cartan subalgebra h each irreducible factor f of the characteristic polynomial of ad x on g/h
# gives the subspace ker f(ad x), which h preserves.  A linear factor gives a root space, [h_j, v] = alpha(h_j) v with
# exact values.  A factor of higher degree gives the sum of the root spaces of roots that are conjugate over the field.

ATTEMPTS = 12  # random elements of the Cartan subalgebra


@final
@dataclass(frozen=True, slots=True)
class RootSpace:
    """A root space, or the sum of the root spaces of roots that are conjugate over the field.

    Attributes
    ----------
    space : Subspace
        A subspace of the algebra, of dimension 1 for a root with values in the field.
    values : tuple of scalars, or None
        The values alpha(h_j) on the basis of the Cartan subalgebra; None for several conjugate roots.
    polynomial : Polynomial
        The irreducible polynomial whose roots are the alpha(x), x the generic element.
    """

    space: Subspace
    values: tuple[Scalar, ...] | None
    polynomial: Polynomial


@final
@dataclass(frozen=True, slots=True)
class RootSpaceDecomposition:
    """The decomposition of g as the sum of a Cartan subalgebra h and the root spaces.

    Attributes
    ----------
    cartan : Subalgebra
        The Cartan subalgebra h.
    element : tuple of scalars
        The generic x in h, in the basis of the algebra.
    spaces : tuple of RootSpace
        By degree of the polynomial, then by its coefficients.
    """

    cartan: Subalgebra
    element: tuple[Scalar, ...]
    spaces: tuple[RootSpace, ...]

    @property
    def is_split(self) -> bool:
        """Whether all roots have values in the field."""
        return all(space.values is not None for space in self.spaces)


def root_space_decomposition(algebra: LieAlgebra, cartan: Subalgebra | None = None) -> RootSpaceDecomposition:
    """Implements `LieAlgebra.root_space_decomposition`."""
    field, n = exact_field(algebra, "root spaces"), algebra.dimension
    h = cartan_subalgebra(algebra) if cartan is None else algebra.as_subalgebra(cartan)
    if not algebra.is_semisimple():
        raise InputError("only a semisimple algebra has root spaces; take the Levi factor of levi_decomposition()")
    if not h.as_algebra().is_abelian() or not is_self_normalizing(h):
        raise InputError(f"{h!r} is not a Cartan subalgebra: it is not abelian or not its own normalizer")
    basis = as_exact(h.basis)
    zero = Polynomial(field, [0, 1])
    rng = random.Random(n)
    for attempt in range(ATTEMPTS):
        size = 3 << attempt
        x = field.matrix([[rng.randint(-size, size) for _ in range(h.dimension)]], (1, h.dimension)) @ basis
        action = algebra.ad(x)
        factors = [(f.monic(), k) for f, k in Polynomial(field, action.characteristic_coefficients()).factor()]
        nullity = sum(k for f, k in factors if f == zero)
        if nullity == h.dimension and all(k == 1 or f == zero for f, k in factors):
            others = [f for f, _ in factors if f != zero]
            others.sort(key=lambda f: (f.degree, [field.to_float(c) for c in f.coefficients]))
            return RootSpaceDecomposition(h, tuple(x.row(0)), tuple(_space(algebra, h, action, f) for f in others))
    raise InternalError("no element of the Cartan subalgebra separates the roots")


def _space(algebra: LieAlgebra, h: Subalgebra, action: ExactMatrix, f: Polynomial) -> RootSpace:
    """The kernel of f(ad x), with the values of the root if f is linear."""
    space = Subspace(algebra.field, evaluate(f, action).null_space(), algebra.dimension)
    if f.degree > 1:
        return RootSpace(space, None, f)
    (v,) = space.basis.to_rows()
    pivot = next(i for i, c in enumerate(v) if c != 0)
    images = (space.basis @ algebra.ad(row).T for row in h.rows())
    return RootSpace(space, tuple(image[0, pivot] / v[pivot] for image in images), f)


# The roots of a semisimple algebra on a Cartan subalgebra in rigorous enclosures, and their exact Cartan integers.
# The Cartan subalgebra h need not split.  ad h acts on g/h with the roots as joint eigenvalues.  The ball arithmetic of
# flint encloses the eigenvalues and eigenvectors of one generic element, and with them all alpha(h_j), in balls that
# are proved to contain them.  The Cartan integers <alpha, beta^vee> = 2 (alpha, beta) / (beta, beta), in the dual of
# the Killing form on h, lie in balls that contain exactly one integer each, so they are exact.  So is the permutation
# of the roots by complex conjugation.  If the balls are too wide the precision is doubled.

FIRST_PRECISION = 64  # in bits
LAST_PRECISION = 4096  # in bits, if the entries are small
MARGIN = 64  # largest precision in units of the bits of the largest entry
WEIGHT = 99_999  # bound on the coefficients of the generic element
HEIGHT = 10**6  # bound on the coefficients of the generic linear form that orders the roots


@final
@dataclass(frozen=True, slots=True)
class RootData:
    """The roots of a semisimple algebra with respect to a Cartan subalgebra h over its field."""

    algebra: LieAlgebra
    cartan: Subalgebra
    root_system: RootSystem  # of the complexification, for some choice of simple roots
    roots: tuple[tuple[int, ...], ...]  # coefficients in these, in the order of `spectrum.values`
    spectrum: JointSpectrum  # the joint eigenvalues alpha_i(h_j), balls (flint.acb)

    def simple_values(self) -> list[Balls]:
        """The values of the simple roots on the basis of h as balls, in the order of the root system."""
        index = {root: i for i, root in enumerate(self.roots)}
        return [self.spectrum.values[index[root]] for root in self.root_system.simple_roots]


def root_data(algebra: LieAlgebra, cartan: Subalgebra | None = None, least: int = 0) -> RootData:
    """The roots of a semisimple algebra on a Cartan subalgebra, by default on the one of `cartan_subalgebra`.

    The precision is at least `least` bits.
    """
    exact_field(algebra, "roots")
    killing = as_exact(algebra.killing_form())
    if killing.rank() < algebra.dimension:
        raise InputError("only a semisimple algebra has a root system; take the Levi factor of levi_decomposition()")
    h = cartan_subalgebra(algebra) if cartan is None else cartan
    if algebra.dimension == 0:
        return RootData(algebra, h, RootSystem(()), (), JointSpectrum((), (), 0))
    actions = _actions(algebra, h)
    basis = as_exact(h.basis)
    form = (basis @ killing @ basis.T).inverse()
    rng = random.Random(algebra.dimension)
    for precision in _precisions(actions, least):
        spectrum = joint_spectrum(actions, [rng.randint(-WEIGHT, WEIGHT) for _ in actions], precision)
        pairing = None if spectrum is None else spectrum.cartan_integers(form)
        if spectrum is not None and pairing is not None:
            cartan_matrix, roots = _in_simple_roots(pairing)
            return RootData(algebra, h, RootSystem(cartan_matrix), roots, spectrum)
    raise InternalError("the roots could not be separated; please report this algebra")


def _precisions(actions: list[ExactMatrix], least: int) -> list[int]:
    """The precisions to try, in bits: at least three times the bits of the largest entry, which is mostly enough."""
    bits = max(int(abs(x)).bit_length() for a in actions for part in a.parts for x in part.entries())
    last = max(LAST_PRECISION, MARGIN * bits)
    return [p for k in range(last.bit_length()) if max(least, 3 * bits) <= (p := FIRST_PRECISION << k) <= last]


def _actions(algebra: LieAlgebra, h: Subalgebra) -> list[ExactMatrix]:
    """The matrices of ad h_j on g/h, acting on rows."""
    if not is_self_normalizing(h) or not h.as_algebra().is_abelian():
        raise InputError("a Cartan subalgebra of a semisimple algebra is abelian and its own normalizer")
    basis = as_exact(h.basis)
    coordinates = echelon_quotient(basis)
    return algebra.table.contract(basis, coordinates.lift, coordinates.projection)


def simple_indices(pairing: Array | IntegerArray, heights: Array | IntegerArray) -> list[int]:
    """The simple ones among the roots with positive heights, from the Cartan integers."""
    simple: list[int] = []
    for i in np.argsort(heights, kind="stable").tolist():
        # a positive root that is not simple pairs positively with a lower simple one
        if heights[i] > 0 and all(pairing[i, j] <= 0 for j in simple):
            simple.append(i)
    return simple


def _in_simple_roots(pairing: IntegerArray) -> tuple[CartanMatrix, tuple[tuple[int, ...], ...]]:
    """The Cartan matrix for a choice of simple roots and all roots in these, from the Cartan integers alone."""
    m = len(pairing)
    rng = random.Random(m)
    heights = np.zeros(m, dtype=np.int64)
    while not heights.all():
        heights = pairing @ np.array([rng.randint(-HEIGHT, HEIGHT) for _ in range(m)], dtype=np.int64)
    simple = simple_indices(pairing, heights)
    cartan = pairing[np.ix_(simple, simple)]
    solved = np.rint(np.linalg.solve(cartan.T.astype(float), pairing[:, simple].T.astype(float)).T).astype(np.int64)
    if (solved @ cartan != pairing[:, simple]).any():
        raise InternalError("the Cartan integers are not those of a root system")
    return tuple(map(tuple, cartan.tolist())), tuple(tuple(row) for row in solved.tolist())
