"""Cartan involutions over the field of the algebra or a larger one, from single elements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import reduce
from itertools import islice, product
from math import isqrt
from operator import mul
from typing import TypeAlias, final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import InternalError, SingularError
from liehom.base.typing import Array, IntegerArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.involutions.cartan_involution import (
    approximate_involution,
    float_constants,
    near_compact,
    orthonormal_frame,
    short_elements,
)
from liehom.exact.algebra.involutions.rational_involution import (
    eigenspace,
    involution_of_triple,
    lattice_order,
)
from liehom.exact.algebra.structure.centroid import evaluate, exact_field
from liehom.exact.algebra.structure.ideals import CentroidField, direct_sum_decomposition, field_places, over_extension
from liehom.exact.algebra.structure.identification import real_form
from liehom.exact.algebra.structure.nilpotent import triple_through
from liehom.exact.algebra.structure.root_spaces import cartan_subalgebra
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.extension import Extension, adjoin_root, real_roots, trivial_extension
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.exact.scalars.joint_spectrum import complex_conjugation
from liehom.exact.scalars.lattices import reduced_rows, smallest_prime
from liehom.exact.scalars.modular import ModularSpan, left_kernel
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis, orthogonal_basis

# Cartan involutions of algebras of dimension 3 over their centroid, as the rotation by pi about an axis.
# Let K be the centroid of g, dim_K g = 3.  An x with [x, x'] = 0 for x' in K x defines the K-linear automorphism that
# is 1 on the axis K x and -1 on its complement for the Killing form.  It is a Cartan involution if the Killing form is
# negative definite on K x and K is totally real with dim p = 2 at every place.  Such x form an open set, so an x from
# floating point may be rounded.  Every matrix that results is a Cartan involution by this theorem.

DIGITS = 12  # roundings that are tried, to integers of up to 12 decimal digits
SEEDS = 4  # random elements for each rounding


def involution_about_axis(algebra: LieAlgebra) -> Matrix:
    """The Cartan involution, (3, 3) on columns, of an algebra of dimension 3 whose Killing form is indefinite."""
    field, killing = algebra.field, as_exact(algebra.killing_form())
    rows, values = orthogonal_basis(killing)
    axis, value = next((r, v) for r, v in zip(rows, values, strict=True) if field.sign(v) < 0)
    return (axis.T @ (axis @ killing)).scale(2 / value) - field.identity(3)


def involution_about_axis_over_centroid(centroid: CentroidField, theta: Array) -> ExactMatrix | None:
    """A Cartan involution, (n, n) on columns, about an axis K x with x near the fixed points of an approximate one."""
    algebra, n = centroid.algebra, centroid.algebra.dimension
    field = centroid.generator.field
    killing = as_exact(algebra.killing_form())
    for digits in range(DIGITS):
        for seed in range(SEEDS):
            x = np.random.default_rng(seed).standard_normal(n) @ (np.eye(n) + theta)
            x = np.rint(x * (10.0**digits / np.abs(x).max()))
            line = centroid.line(field.matrix([[int(v) for v in x]], (1, n)))
            form = line @ killing @ line.T
            if (-form).is_positive_definite():
                return (line.T @ form.inverse() @ line @ killing).scale(2) - field.identity(n)
    return None


# Proofs, from the centroid alone, that a simple algebra has no Cartan involution over its field.
# Let K be the centroid of g, simple over F, and theta a Cartan involution with entries in F.  It permutes no ideals of
# g (x) R, because K(x, theta x) < 0.  Therefore phi -> theta phi theta is an automorphism s of K over F that is trivial
# on the factor R of K (x) R at a real place and complex conjugation on the factor C at a complex one.  So
#
#     K is totally real and s = 1, theta is K-linear, and dim p is the same at all places, or
#     K is totally complex and s is conjugation in all embeddings: K has complex multiplication.


def involution_obstruction(centroid: CentroidField) -> str | None:
    """The reason why no Cartan involution has entries in the field, or None if the centroid does not exclude one."""
    if centroid.degree == 1:
        return None
    places = field_places(centroid)
    kinds = {place.kind for place in places}
    if len(kinds) == 2:
        return "its centroid has real and complex places"
    sizes = sorted({place.killing_signature[0] for place in places}, reverse=True)
    if kinds == {"real"} and len(sizes) > 1:
        return f"dim p is {sizes[0]} at one real place of its centroid and {sizes[1]} at another"
    f = centroid.polynomial
    integral = f.field is QQ and all(QQ.convert(c).q == 1 for c in f.coefficients)
    if kinds == {"complex"} and f.degree > 2 and integral and complex_conjugation(f) is None:
        return "its centroid is totally complex without complex multiplication"
    return None


# A proof at a prime p that a form of sl(m, R) or sl(m/2, H), m > 2, has no Cartan involution over QQ.
# Let M_0 > M_1 > ... > M_r = p M_0 be lattices in g (x) QQ_p, M_(i+r) = p M_i, with [M_i, M_j] in M_(i+j). If x in M_i
# is nilpotent, so is the map of ad x on the sum of the M_j / M_(j+1), j modulo r, which depends on x modulo M_(i+1)
# only. If none of these finitely many maps is nilpotent, g is anisotropic at p. Then its automorphisms are inner, while
# Cartan involutions of the two real forms are outer: docs/theory/structure.md.

LARGEST = 100  # primes below this one are tried
CLASSES = 10_000  # elements of M_i / M_(i+1) with one leading coefficient


def local_obstruction(algebra: LieAlgebra) -> str | None:
    """The reason why no Cartan involution is over QQ, from a small prime, or None; in the basis of an order."""
    m, killing = isqrt(algebra.dimension + 1), as_exact(algebra.killing_form()).primitive()
    if m < 3 or m**2 != algebra.dimension + 1 or algebra.table.den != 1:
        return None
    if real_form(algebra) not in (f"sl({m},R)", f"sl({m // 2},H)"):
        return None
    determinant = int(QQ.convert(killing.determinant()).p)
    for p in range(2, LARGEST):
        prime = determinant % p == 0 and smallest_prime(p) == p
        if prime and _is_anisotropic(algebra, killing, p):
            return f"over the {p}-adic numbers it is the part of trace 0 of a division algebra of degree {m}"
    return None


def _is_anisotropic(algebra: LieAlgebra, killing: ExactMatrix, p: int) -> bool:
    """Whether M_1 = {x : K(x, M_0) = 0 mod p} and M_(i+1) = [M_1, M_i] + p M_0 show that g is anisotropic at p."""
    n, form = algebra.dimension, np.array([int(x) % p for x in killing.parts[0].entries()])
    constants = _residues(algebra, p)
    spaces = [np.eye(n, dtype=np.int64), left_kernel(form.reshape(n, n), p)]
    while len(spaces[-1]):
        span = ModularSpan(p, n)
        span.extend(np.einsum("ai,bj,ijk->abk", spaces[1], spaces[-1], constants, optimize=True).reshape(-1, n) % p)
        if span.rank == len(spaces[-1]):
            return False
        spaces.append(span.echelon()[0])
    # a basis of M_0 that contains bases of the M_i modulo p M_0
    span, r = ModularSpan(p, n), len(spaces) - 1
    parts = [space[span.extend(space)] for space in reversed(spaces[:r])]
    level = np.repeat(range(r - 1, -1, -1), [len(part) for part in parts])
    constants = _residues(algebra.change_of_basis(np.concatenate(parts).tolist()), p**2)
    rise = level[:, None, None] + level[:, None] - level
    if (constants % p ** np.clip(-(-rise // r), 0, 2)).any():
        return False
    graded = np.where(rise == 0, constants % p, np.where(rise == r, constants // p, 0))
    return not any(_has_nilpotent(graded[level == i], p) for i in range(r))


def _residues(algebra: LieAlgebra, modulus: int) -> IntegerArray:
    """The structure constants (n, n, n) modulo a number that is coprime to their denominator."""
    n, table = algebra.dimension, as_exact(algebra.table.dense())
    inverse = pow(int(table.den), -1, modulus)
    return np.array([int(x) * inverse % modulus for x in table.parts[0].entries()], dtype=np.int64).reshape(n, n, n)


def _has_nilpotent(maps: IntegerArray, p: int) -> bool:
    """Whether a combination modulo p, not all coefficients 0, is nilpotent, or there are too many combinations."""
    d, n = maps.shape[:2]
    for lead in range(d):
        if p ** (d - 1 - lead) > CLASSES:
            return True
        tails = product(range(p), repeat=d - 1 - lead)
        powers = np.tensordot(np.array([(1, *tail) for tail in tails]), maps[lead:], axes=1) % p
        for _ in range(n.bit_length()):
            powers = powers @ powers % p
        if not powers.any(axis=(1, 2)).all():
            return True
    return False


# Cartan involutions from elements with a compact centralizer, over the field of the algebra or a larger real one.
# Let ad x be semisimple with imaginary eigenvalues i mu, and K negative definite on z(x).  One Cartan involution theta
# is 1 on z(x).  On the eigenspaces of i mu and -i mu it is 1 where K(v, conj v) < 0, and -1 where K(v, conj v) > 0.  So
# p is the kernel of N(ad x), N the product of the t^2 + mu^2 of the second kind.  If the roots of each irreducible
# factor of the minimal polynomial are of one kind, theta is over the field of the algebra.  If not, N is over a larger
# real field: values mu^2 of the factors with roots of both kinds are adjoined until no such factor is left.
#
# Such x exist if g has a compact Cartan subalgebra, and they form an open set.  The kinds are found in floating point;
# callers check that the result is a Cartan involution.

ELLIPTIC_QUESTION = "Cartan involutions of elliptic elements"
IMAGINARY = 1e-6  # largest real part of an eigenvalue, relative to the largest eigenvalue, that counts as 0
DEFINITE = 1e-6  # smallest eigenvalue of K(v, conj v), relative to -K(v, theta conj v), with which it is definite
BITS = 64  # precision of roots of factors
TRIED = 40  # short elements, and random ones, that are tried
INSIDE = 8  # elements of one centralizer that are tried
FACTORED = 150  # elements whose characteristic polynomial is factored
DEPTH = 2  # centralizers inside one another
DEEPER = 2  # short elements of one centralizer whose centralizers are tried
SHIFT = 5  # of an element of a centralizer, by which no two eigenvalues coincide in most cases

Kinds: TypeAlias = list[tuple[float, bool]]
"""Pairs (mu^2, whether theta is -1 on the eigenspaces of i mu and -i mu)."""


@final
@dataclass(frozen=True, slots=True)
class EllipticElement:
    """An element x with a compact centralizer, (1, n), and the factors of the minimal polynomial of ad x."""

    element: ExactMatrix
    kinds: Kinds
    factors: list[Polynomial]  # irreducible, of the polynomial with the roots mu^2

    @property
    def mixed(self) -> int:
        """The largest degree of a factor with roots of both kinds, 1 if there is none."""
        return max((f.degree for f in self.factors if len(set(_kinds(f, self.kinds))) > 1), default=1)


def elliptic_elements(algebra: LieAlgebra, theta: Array) -> list[EllipticElement]:
    """Elements with a compact centralizer, the best last: theta is over the field if its `mixed` is 1."""
    field, spectrum = exact_field(algebra, ELLIPTIC_QUESTION), _Spectrum(algebra, theta)
    elements: list[EllipticElement] = []
    if spectrum.kinds(near_compact(theta, 0)) is None:
        return elements  # no compact Cartan subalgebra
    for x, kinds in islice(_candidates(algebra, theta, spectrum), FACTORED):
        in_time()
        f = Polynomial(field, algebra.ad(x).characteristic_coefficients())
        factors = [g for g, _ in _of_squares(f).factor()]
        if any(g.count_real_roots() < g.degree for g in factors):
            continue  # double precision was not enough
        element = EllipticElement(x, kinds, factors)
        if not elements or element.mixed < elements[-1].mixed:
            elements.append(element)
        if element.mixed == 1:
            break
    return elements


def elliptic_involution(algebra: LieAlgebra, x: EllipticElement, degree: int) -> tuple[Extension, ExactMatrix] | None:
    """The map theta, (n, n) on columns, over a field of at most this degree over that of the algebra, or None."""
    separated = _separated(x, trivial_extension(exact_field(algebra, ELLIPTIC_QUESTION)), degree)
    if separated is None:
        return None
    up, factors = separated
    square = up.matrix(algebra.ad(x.element) @ algebra.ad(x.element))
    of_p = (f for f in factors if _kinds(f, x.kinds)[0])
    p = evaluate(reduce(mul, of_p, Polynomial(up.field, [1])), -square).null_space()
    killing = up.matrix(as_exact(algebra.killing_form()))
    form = p @ killing @ p.T
    if form.rank() < p.nrows:
        return None
    return up, up.field.identity(algebra.dimension) - (p.T @ form.inverse() @ p @ killing).scale(2)


def _separated(x: EllipticElement, up: Extension, degree: int) -> tuple[Extension, list[Polynomial]] | None:
    """Factors with roots of one kind each, over an extension of at most this degree, or None."""
    base, factors = up.field.degree, x.factors
    while True:
        in_time()
        mixed = [(f, kinds) for f in factors if len(set(kinds := _kinds(f, x.kinds))) > 1]
        if not mixed:
            return up, factors
        f, kinds = min(mixed, key=lambda pair: pair[0].degree)
        if up.field.degree * f.degree > base * degree:
            return None
        fewer = 2 * sum(kinds) <= len(kinds)
        larger, _ = adjoin_root(f, kinds.index(fewer))
        up = up.then(larger)
        factors = [g for f in factors for g, _ in larger.polynomial(f).factor()]


def _kinds(f: Polynomial, kinds: Kinds) -> list[bool]:
    """The kinds of the roots of a factor, in increasing order."""
    values = np.array([value for value, _ in kinds])
    return [kinds[int(np.argmin(np.abs(values - float(r.mid()))))][1] for r in real_roots(f, BITS)]


def _of_squares(f: Polynomial) -> Polynomial:
    """The polynomial with the roots -t^2 for the roots t, except 0, of an even or odd polynomial."""
    low = next(i for i, c in enumerate(f.coefficients) if c != 0)
    even = f.coefficients[low::2]
    return Polynomial(f.field, [c if i % 2 == 0 else -c for i, c in enumerate(even)])


def _candidates(algebra: LieAlgebra, theta: Array, spectrum: _Spectrum) -> Iterator[tuple[ExactMatrix, Kinds]]:
    """Short elements with a compact centralizer, elements of the centralizers of others, and elements near k."""
    field, n = exact_field(algebra, ELLIPTIC_QUESTION), algebra.dimension
    for row in short_elements(algebra, theta)[:TRIED]:
        x = field.from_integers([int(v) for v in row], 1, n)
        if (kinds := spectrum.kinds(row)) is not None:
            yield x, kinds
        elif spectrum.is_elliptic(row):
            yield from _inside(algebra, spectrum, x, DEPTH)
    for seed in range(TRIED):
        row = near_compact(theta, seed)
        if (kinds := spectrum.kinds(row)) is not None:
            yield field.from_integers([int(v) for v in row], 1, n), kinds


def _inside(
    algebra: LieAlgebra, spectrum: _Spectrum, x: ExactMatrix, depth: int
) -> Iterator[tuple[ExactMatrix, Kinds]]:
    """Elements with a compact centralizer in z(x), x elliptic, and in the centralizers of short elements of z(x)."""
    in_time()
    field = exact_field(algebra, ELLIPTIC_QUESTION)
    rows = integral_basis(as_exact(algebra.centralizer(x).basis))
    if field.degree == 1:
        form = rows.to_numpy() @ spectrum.frame
        rows = reduced_rows(field.identity(rows.nrows), np.linalg.cholesky(form @ form.T)) @ rows
    rng = np.random.default_rng(rows.nrows)
    for _ in range(INSIDE):
        weights = rng.integers(-1, 2, rows.nrows).tolist()
        y = field.from_integers(weights, 1, rows.nrows) @ rows + x.scale(int(rng.integers(0, 3)))
        if (kinds := spectrum.kinds(y.to_numpy()[0])) is not None:
            yield y, kinds
    if depth == 0:
        return
    lengths = np.linalg.norm(rows.to_numpy() @ spectrum.frame, axis=1)
    deeper = 0
    for i in np.argsort(lengths, kind="stable").tolist():
        y = rows.select(rows=[i])
        joint = y + x.scale(SHIFT)  # commutes with what commutes with x and y
        smaller = (rows @ algebra.ad(y).T).rank() > 0
        if smaller and deeper < DEEPER and spectrum.is_elliptic(joint.to_numpy()[0]):
            deeper += 1
            yield from _inside(algebra, spectrum, joint, depth - 1)


class _Spectrum:
    """The eigenvalues of ad x, and the kinds of the eigenspaces, in floating point."""

    def __init__(self, algebra: LieAlgebra, theta: Array) -> None:
        self.frame = orthonormal_frame(algebra, theta)
        self.inverse = np.linalg.inv(self.frame)
        self.constants = float_constants(algebra)
        self.killing = self.inverse @ algebra.killing_form().to_numpy() @ self.inverse.T

    def is_elliptic(self, x: Array) -> bool:
        """Whether all eigenvalues of ad x are imaginary, and not all are 0."""
        values = np.linalg.eigvals(self._action(x))
        size = float(np.abs(values).max())
        return (
            size > IMAGINARY * float(np.linalg.norm(x @ self.frame))
            and float(np.abs(values.real).max()) < IMAGINARY * size
        )

    def kinds(self, x: Array) -> Kinds | None:
        """The kinds of the eigenspaces for mu > 0, or None if x is not elliptic or its centralizer is not compact."""
        if not self.is_elliptic(x):
            return None
        values, vectors = np.linalg.eig(self._action(x).T)
        size = float(np.abs(values).max())
        kinds: Kinds = []
        left = np.flatnonzero(values.imag > -IMAGINARY * size)
        while len(left):
            mu = values[left[0]].imag
            chosen = left[np.abs(values[left].imag - mu) < 1e2 * IMAGINARY * size]
            left = np.setdiff1d(left, chosen)
            rows = np.linalg.qr(vectors[:, chosen])[0].T
            signs = np.linalg.eigvalsh(rows @ self.killing @ rows.conj().T)
            if signs[0] < DEFINITE and signs[-1] > -DEFINITE:
                return None
            if mu > 1e2 * IMAGINARY * size:
                kinds.append((float(mu) ** 2, bool(signs[0] > 0)))
            elif signs[0] > 0:
                return None
        return kinds

    def _action(self, x: Array) -> Array:
        """The matrix of ad x on rows, in an orthonormal frame."""
        return self.inverse @ np.einsum("i,ijk->jk", x, self.constants) @ self.frame


# Cartan involutions over a real number field that contains the eigenvalues of an ad x, all of them real.
# Over the field of the eigenvalues, the eigenspaces with positive eigenvalues span the nilradical of a parabolic
# subalgebra.  A generic element e of it, with its triple (h, e, f), leads to a Cartan involution as in
# `rational_involution` if the parabolic subalgebra is minimal.  If g is split over the reals and x is generic, it is.
# The elements of trace 0 of a division algebra of degree 3, for example, have no nilpotent elements over the rationals,
# but over each maximal subfield.

HYPERBOLIC_QUESTION = "Cartan involutions of hyperbolic elements"
REAL = 1e-6  # largest imaginary part of an eigenvalue, relative to the largest eigenvalue, that counts as 0
FACTORED_ELEMENTS = 60  # elements whose characteristic polynomial is factored
EXTENDED = 4  # elements over whose eigenvalues a nilpotent element is tried
RANDOM = 6  # elements near p


def hyperbolic_involution(algebra: LieAlgebra, theta: Array, degree: int) -> tuple[Extension, ExactMatrix] | None:
    """A map that may be a Cartan involution, (n, n) on columns, over a field of at most this degree, or None."""
    for x, factors in _elements(algebra, theta)[:EXTENDED]:
        split = _eigenvalues(factors, trivial_extension(exact_field(algebra, HYPERBOLIC_QUESTION)), degree)
        if split is None:
            continue
        up, values = split
        theta_up = _of_parabolic(over_extension(algebra, up), up.matrix(x), values)
        if theta_up is not None:
            return up, theta_up
    return None


def _elements(algebra: LieAlgebra, theta: Array) -> list[tuple[ExactMatrix, list[Polynomial]]]:
    """Elements with real eigenvalues, small centralizers first, and the factors of characteristic polynomials."""
    field, n = exact_field(algebra, HYPERBOLIC_QUESTION), algebra.dimension
    constants, frame = float_constants(algebra), orthonormal_frame(algebra, theta)
    inverse = np.linalg.inv(frame)
    rows = [*short_elements(algebra, theta), *(near_compact(-theta, seed) for seed in range(1, RANDOM))]
    elements: list[tuple[int, int, int, ExactMatrix, list[Polynomial]]] = []
    for row in rows:
        values = np.linalg.eigvals(inverse @ np.einsum("i,ijk->jk", row, constants) @ frame)
        size = float(np.abs(values).max())
        if float(np.abs(values.imag).max()) > REAL * size or size <= REAL * float(np.linalg.norm(row @ frame)):
            continue
        in_time()
        x = field.from_integers([int(v) for v in row], 1, n)
        factors = Polynomial(field, algebra.ad(x).characteristic_coefficients()).factor()
        zeros = next(m for f, m in factors if f.degree == 1 and f.coefficients[0] == 0)
        elements.append((zeros, max(f.degree for f, _ in factors), len(elements), x, [f for f, _ in factors]))
        if len(elements) == FACTORED_ELEMENTS:
            break
    return [entry[3:] for entry in sorted(elements, key=lambda entry: entry[:3])]


def _eigenvalues(factors: list[Polynomial], up: Extension, degree: int) -> tuple[Extension, list[Scalar]] | None:
    """The roots of the polynomials over an extension of at most this degree, or None."""
    base = up.field.degree
    while larger := [f for f in factors if f.degree > 1]:
        in_time()
        f = min(larger, key=lambda g: g.degree)
        if up.field.degree * f.degree > base * degree:
            return None
        step, _ = adjoin_root(f, f.degree - 1)
        up = up.then(step)
        factors = [g for f in factors for g, _ in step.polynomial(f).factor()]
    return up, [-f.coefficients[0] for f in factors]


def _of_parabolic(algebra: LieAlgebra, x: ExactMatrix, values: list[Scalar]) -> ExactMatrix | None:
    """The map of the triple of a generic sum of eigenvectors with positive eigenvalues, or None."""
    field, n = exact_field(algebra, HYPERBOLIC_QUESTION), algebra.dimension
    nilradical = field.stack_rows([eigenspace(algebra, x, v) for v in values if field.sign(v) > 0], n)
    weights = np.random.default_rng(n).integers(1, 4, nilradical.nrows).tolist()
    e = field.from_integers(weights, 1, nilradical.nrows) @ nilradical
    try:
        return involution_of_triple(algebra, triple_through(algebra, e))
    except (np.linalg.LinAlgError, SingularError):
        return None


# Cartan involutions over a real number field that is larger than the field of the algebra.
# Each simple ideal is put in the basis of a large order.  Elements with a compact centralizer and
# elements whose eigenvalues are real give involutions over fields of small degree.  The fields
# of the ideals are joined.

DEGREE = 6  # largest degree, over the field of the algebra, of the field for one ideal
ELEMENTS = 3  # elliptic elements, the best ones, for which larger fields are tried
GENERATOR_BITS = 128  # precision of the roots of polynomials of generators

Proof = Callable[[LieAlgebra, ExactMatrix], bool]
"""Whether a matrix, on columns, is proved to be a Cartan involution of an algebra."""


def extended_involution(algebra: LieAlgebra, proved: Proof) -> tuple[LieAlgebra, ExactMatrix] | None:
    """The algebra over a larger field and a Cartan involution of it, (n, n) on columns, or None."""
    n, field = algebra.dimension, as_exact(algebra.killing_form()).field
    joint, basis, images = trivial_extension(field), field.zeros(0, n), field.zeros(0, n)
    for ideal in direct_sum_decomposition(algebra):
        of_ideal = _of_ideal(ideal.as_algebra(), proved)
        if of_ideal is None:
            return None
        up, theta = of_ideal
        before, after = _joined(joint, up)
        joint = joint.then(before)
        rows = joint.matrix(as_exact(ideal.basis))
        basis = joint.field.stack_rows([before.matrix(basis), rows], n)
        images = joint.field.stack_rows([before.matrix(images), after.matrix(theta).T @ rows], n)
    combined, larger = (basis.inverse() @ images).T, over_extension(algebra, joint)
    return (larger, combined) if proved(larger, combined) else None


def _of_ideal(algebra: LieAlgebra, proved: Proof) -> tuple[Extension, ExactMatrix] | None:
    """An extension and a Cartan involution over it, on columns, of a simple algebra, or None."""
    n, field = algebra.dimension, as_exact(algebra.killing_form()).field
    if algebra.killing_form().signature()[0] == 0:
        return trivial_extension(field), field.identity(n)
    rank = cartan_subalgebra(algebra).dimension
    theta = approximate_involution(algebra, rank)
    if field.degree == 1:
        frame = np.eye(n) if theta is None else orthonormal_frame(algebra, theta)
        basis = lattice_order(algebra, frame, thorough=False)
        current = algebra.change_of_basis(basis)
        theta = approximate_involution(current, rank)
    else:
        basis, current = field.identity(n), algebra
    if theta is None:
        return None
    for up, candidate in _extensions(current, theta):
        if proved(over_extension(current, up), candidate):
            change = up.matrix(basis)
            return up, change.T @ candidate @ change.T.inverse()
    return None


def _extensions(algebra: LieAlgebra, theta: Array) -> list[tuple[Extension, ExactMatrix]]:
    """Extensions and maps that may be Cartan involutions over them, those over small fields first."""
    elliptic = [elliptic_involution(algebra, x, DEGREE) for x in elliptic_elements(algebra, theta)[-ELEMENTS:]]
    both = [entry for entry in (*elliptic, hyperbolic_involution(algebra, theta, DEGREE)) if entry is not None]
    return sorted(both, key=lambda entry: entry[0].field.degree)


def _joined(first: Extension, second: Extension) -> tuple[Extension, Extension]:
    """Two extensions of one field in a field that contains both, as extensions of these two fields."""
    small, field = second.field, first.field
    if second.is_trivial:
        return trivial_extension(field), first
    modulus = Polynomial(field, small.modulus_coefficients())
    near = float(small.to_float(trivial_extension(small).powers[1]))  # of the generator
    choices = [
        (abs(float(root.mid()) - near), f, index)
        for f, _ in modulus.factor()
        for index, root in enumerate(real_roots(f, GENERATOR_BITS))
    ]
    if not choices:
        raise InternalError("a real field has no real generator")
    _, f, index = min(choices, key=lambda choice: choice[0])
    before, root = adjoin_root(f, index)
    powers = tuple(root**i if i else before.field.one for i in range(small.degree))
    return before, Extension(small, before.field, powers)
