"""Direct sums of ideals, and simple algebras split over the reals."""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from math import gcd, lcm, log
from typing import Any, Literal, final

from liehom.base.errors import FieldError, InputError, InternalError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra, complement_rows
from liehom.exact.algebra.structure.centroid import (
    BracketSeeds,
    centroid_of,
    combinations,
    evaluate,
    is_central,
    minimal_polynomial,
    semisimple_rank,
)
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.extension import Extension, RealFactor, real_factors
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis

# A Lie algebra as the direct sum of indecomposable ideals, over its own field.
# Central elements outside [g, g] split off as abelian ideals of dimension 1.  The complement then has its centre in [g,
# g], and its centroid A is commutative modulo the maps g/[g, g] -> z(g), which are an ideal of square 0.  An element
# theta that generates A modulo its radical has a minimal polynomial with one irreducible factor p_i for each field in A
# / rad A, so the ideals ker p_i(theta)^k are indecomposable and their sum is direct.


def direct_sum_decomposition(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.direct_sum_decomposition`."""
    field, n = algebra.field, algebra.dimension
    parts: list[Matrix] = []
    for indices in components(algebra.table):
        if len(indices) == 1:
            parts.append(field.unit(n, indices[0]))
            continue
        units = field.identity(n).select(rows=indices)
        inner = algebra if len(indices) == n else _restricted(algebra, indices)
        parts += [rows @ units for rows in _indecomposable(inner)]
    ideals = [Subalgebra(algebra, rows, check=False) for rows in parts]  # ideals by construction
    return sorted(ideals, key=lambda h: (h.dimension, h.subspace.basis.to_strings())) if len(ideals) > 1 else ideals


def components(table: StructureConstants) -> list[list[int]]:
    """The finest partition of the basis indices into sets that span ideals and are connected by non-zero c[i, j, k]."""
    parent = list(range(table.dimension))

    def root(x: int) -> int:
        while parent[x] != x:
            parent[x] = parent[parent[x]]
            x = parent[x]
        return x

    for i, j, k in zip(table.i.tolist(), table.j.tolist(), table.k.tolist(), strict=True):
        parent[root(j)] = root(i)
        parent[root(k)] = root(i)
    connected: dict[int, list[int]] = {}
    for x in range(table.dimension):
        connected.setdefault(root(x), []).append(x)
    return list(connected.values())


def _restricted(algebra: LieAlgebra, indices: list[int]) -> LieAlgebra:
    """The ideal spanned by these basis elements, as an algebra."""
    position = {x: i for i, x in enumerate(indices)}
    entries = [(position[i], position[j], position[k], v) for i, j, k, v in algebra.table if i in position]
    # The restriction of a bracket to an ideal.
    return LieAlgebra(StructureConstants(algebra.field, len(indices), entries), check=False)


def _indecomposable(algebra: LieAlgebra) -> list[ExactMatrix]:
    """Bases, as rows, of indecomposable ideals whose direct sum is the algebra."""
    if is_central(algebra):
        return [as_exact(algebra.field.identity(algebra.dimension))]
    seeds = BracketSeeds(algebra)
    if seeds.is_perfect():
        return _split(seeds, None)
    field, n = seeds.field, algebra.dimension
    center = seeds.center()
    if center.nrows == 0:
        return _split(seeds, None)
    derived = field.stack_rows(seeds.ads(field.identity(n)), n).row_space()
    abelian = complement_rows(center, derived)
    lines = [integral_basis(abelian.select(rows=[i])) for i in range(abelian.nrows)]
    if not lines:
        return _split(seeds, center if derived.nrows == seeds.spanned else None)
    rest = _completed(derived, abelian)
    if rest.nrows == 0:
        return lines
    inner = Subalgebra(algebra, rest, check=False).as_algebra()  # it contains [g, g]
    return lines + [rows @ rest for rows in _indecomposable(inner)]


def _completed(space: ExactMatrix, other: ExactMatrix) -> ExactMatrix:
    """A basis, as rows, of a complement of `other` that contains `space`."""
    n, field = space.ncols, space.field
    k = space.nrows + other.nrows
    stacked = field.stack_rows([space, other, field.identity(n)], n)
    units = [x - k for x in stacked.T.echelon()[1] if x >= k]
    return integral_basis(field.stack_rows([space, field.identity(n).select(rows=units)], n))


def _split(seeds: BracketSeeds, center: ExactMatrix | None) -> list[ExactMatrix]:
    """Bases of the indecomposable ideals of an algebra whose centre lies in [g, g]."""
    field, n = seeds.field, seeds.n
    maps = centroid_of(seeds, center)
    rank = semisimple_rank(maps) if len(maps) > 1 else 1
    if rank == 1:
        return [field.identity(n)]
    for theta in combinations(maps, random.Random(n)):
        f = minimal_polynomial(theta, seeds.random_rows(1))
        factors = f.factor()
        if sum(p.degree for p, _ in factors) == rank:
            return _kernels(theta, factors)
    raise InternalError("no element generates the centroid modulo its radical")


def _kernels(theta: ExactMatrix, factors: list[tuple[Polynomial, int]]) -> list[ExactMatrix]:
    """Bases of the spaces ker p_i(theta)^k with k so large that their sum is the algebra."""
    n = theta.nrows
    if len(factors) == 1:
        return [theta.field.identity(n)]
    maps = [evaluate(p, theta) for p, _ in factors]
    kernels = [_kernel(m, k) for m, (_, k) in zip(maps, factors, strict=True)]
    if sum(space.nrows for space in kernels) < n:
        kernels = [_kernel(m, n) for m in maps]
    if sum(space.nrows for space in kernels) != n:
        raise InternalError("the primary components do not add up")
    return [integral_basis(space) for space in kernels]


def _kernel(matrix: ExactMatrix, exponent: int) -> ExactMatrix:
    """A basis, as rows, of the null space of a power of the matrix."""
    return reduce(lambda power, factor: (power @ factor).primitive(), [matrix] * exponent).null_space()


# Simple algebras over a field, split over the reals: one real simple ideal for each place of the centroid.
# Over QQ, the centroid of a simple algebra I is a number field K = QQ(theta), theta a matrix with the irreducible
# minimal polynomial f.  I (x) R is the sum of ideals I_v, one for each real root of f (absolutely simple, of dimension
# dim I / deg f) and one for each pair of complex roots (a complex simple algebra as a real one).  These are the places
# of K, in the sense of number theory.  Let kappa be the Killing form.  The form kappa((theta - c) x, y) is (theta_v -
# c) kappa_v on a real I_v and has signature 0 on a complex one.  As c increases through theta_v, its signature drops by
# twice the signature of kappa_v, so exact signatures over the base field give those of all kappa_v.

CANDIDATES = 12  # generators of the centroid among which the one with the smallest polynomial is chosen
FACTORED_BITS = 160  # bits of the numbers that are factored
LARGEST_DEGREE = 36  # degree over QQ of the fields that are constructed

Interval = tuple[Scalar, Scalar]  # rational ends


@final
@dataclass(frozen=True, slots=True)
class Place:
    """A real simple ideal of I (x) R, given by a root of the polynomial of the centroid.

    Attributes
    ----------
    kind : 'real' or 'complex'
        For 'real' the ideal is absolutely simple, for 'complex' it is a complex simple algebra as a real one.
    polynomial : Polynomial
        The minimal polynomial f of the generator theta of the centroid; of degree 1 if the centroid is the field.
    root : pair of rationals, or None
        The ends of an interval that contains exactly this root among the real roots of f; None at a complex place.
    killing_signature : (int, int)
        Numbers of positive and negative squares of the Killing form of the ideal as a real algebra, which are dim p
        and dim k of a Cartan decomposition.
    dimension : int
        The real dimension of the ideal.
    """

    kind: Literal["real", "complex"]
    polynomial: Polynomial
    root: Interval | None
    killing_signature: tuple[int, int]
    dimension: int


@final
@dataclass(frozen=True, slots=True)
class CentroidField:
    """The centroid of a simple algebra as a field."""

    algebra: LieAlgebra  # in the basis of the ideal
    generator: ExactMatrix  # theta, (n, n) on columns; 1 if the centroid is the base field
    polynomial: Polynomial  # of theta, minimal and irreducible, of degree dim K

    @property
    def degree(self) -> int:
        """The degree of the centroid over the base field, an int."""
        return self.polynomial.degree

    def line(self, x: ExactMatrix) -> ExactMatrix:
        """The rows x, theta x, theta^2 x, ..., a basis of K x for x != 0, shape (dim K, n)."""
        rows = [x]
        while len(rows) < self.degree:
            rows.append(rows[-1] @ self.generator.T)
        return x.field.stack_rows(rows, x.ncols)


def centroid_field(ideal: Subalgebra) -> CentroidField:
    """The centroid, as a field with a generator, of a subalgebra that is simple over its field."""
    algebra = _own_algebra(ideal)
    if algebra.dimension == 0 or algebra.killing_form().rank() < algebra.dimension:
        raise InputError(f"the Killing form of {ideal!r} is degenerate; expected a simple ideal")
    maps = algebra.centroid()
    degree = len(maps)
    start = algebra.field.unit(algebra.dimension, 0)
    generators: list[tuple[ExactMatrix, Polynomial]] = []
    for theta in combinations(maps, random.Random(degree)):
        f = minimal_polynomial(theta, start)
        if len(f.factor()) > 1:
            raise InputError(f"{ideal!r} is a sum of ideals; take one of its direct_sum_decomposition")
        if f.degree == degree:
            generators.append(_simplified(theta, f))
        if len(generators) == (CANDIDATES if degree > 2 else 1):
            break
    if not generators:
        raise InternalError("no element of the centroid generates it")
    return CentroidField(algebra, *min(generators, key=lambda pair: _height(pair[1])))


def places(ideal: Subalgebra) -> list[Place]:
    """Implements `Subalgebra.places`."""
    return field_places(centroid_field(ideal))


def field_places(centroid: CentroidField) -> list[Place]:
    """The places of the centroid of a simple algebra, as `places` returns them."""
    f, n = centroid.polynomial, centroid.algebra.dimension
    size = n // f.degree
    intervals = real_root_intervals(f)
    real = []
    for interval, index in zip(intervals, _indices(centroid, intervals), strict=True):
        if (size + index) % 2 or abs(index) > size:
            raise InternalError(f"a Killing form of dimension {size} and index {index}")
        real.append(Place("real", f, interval, ((size + index) // 2, (size - index) // 2), size))
    pairs = (f.degree - len(intervals)) // 2
    return real + [Place("complex", f, None, (size, size), 2 * size)] * pairs


def _indices(centroid: CentroidField, intervals: list[Interval]) -> list[int]:
    """The number of positive minus the number of negative squares of the Killing form, at each real root."""
    if not intervals:
        return []
    killing = as_exact(centroid.algebra.killing_form())
    twisted = killing @ centroid.generator
    field = centroid.algebra.field
    below = _index(killing)
    between = [_index(twisted - killing.scale(field.convert(high))) for _, high in intervals[:-1]]
    # above all roots the form is minus the form below them, up to positive factors on the ideals
    return [(a - b) // 2 for a, b in itertools.pairwise([below, *between, -below])]


def _index(form: ExactMatrix) -> int:
    """The number of positive minus the number of negative squares of a symmetric form."""
    positive, negative, _ = form.signature()
    return int(positive - negative)


def real_root_intervals(f: Polynomial) -> list[Interval]:
    """Disjoint intervals with one real root each of a squarefree polynomial, by rational ends that are not roots."""
    count = f.root_counter()
    total, bound = count(None, None), QQ.one
    while count(-bound, bound) < total or f(bound) == 0 or f(-bound) == 0:
        bound = bound * 2
    intervals: list[Interval] = []
    rest = [(-bound, bound, total)]
    while rest:
        low, high, inside = rest.pop()
        if inside <= 1:
            intervals += [(low, high)] * inside
            continue
        middle = (low + high) / 2
        while f(middle) == 0:
            middle = (middle + high) / 2
        left = count(low, middle)
        rest += [(middle, high, inside - left), (low, middle, left)]
    return intervals


def real_ideals(ideal: Subalgebra) -> list[Subalgebra]:
    """Implements `Subalgebra.real_ideals`."""
    centroid = centroid_field(ideal)
    f, m = centroid.polynomial, centroid.degree
    complex_pairs = (m - f.count_real_roots()) // 2
    if m == 1 or (m == 2 and complex_pairs):
        return [ideal]
    bound = (m * (m - 1) // 2 if complex_pairs else m) * f.field.degree
    if bound > LARGEST_DEGREE:
        raise FieldError(
            f"a simple ideal over the reals may need a number field of degree {bound}, more than {LARGEST_DEGREE}; "
            "places() gives the ideals and their Killing signatures without it"
        )
    krylov = _krylov(centroid)
    return [_real_ideal(ideal, factor, f, krylov) for factor in real_factors(f)]


def _krylov(centroid: CentroidField) -> list[ExactMatrix]:
    """For a basis b_1, b_2, ... over the centroid the matrices (m, n) with rows b_i, theta b_i, theta^2 b_i, ..."""
    field, n, m = centroid.generator.field, centroid.algebra.dimension, centroid.degree
    blocks: list[ExactMatrix] = []
    for i in range(n):
        line = centroid.line(field.unit(n, i))
        grown = field.stack_rows([*blocks, line], n)
        if grown.rank() == grown.nrows:
            blocks.append(line)
        if len(blocks) * m == n:
            break
    return blocks


def _real_ideal(ideal: Subalgebra, factor: RealFactor, f: Polynomial, krylov: list[ExactMatrix]) -> Subalgebra:
    """The kernel of q(theta) for a factor q of f over a larger field, as the image of (f / q)(theta)."""
    up, q = factor.extension, factor.polynomial
    field = up.field
    cofactor = list((up.polynomial(f) // q).coefficients)
    weights = field.matrix([[field.zero] * k + cofactor + [field.zero] * (q.degree - 1 - k) for k in range(q.degree)])
    rows = [weights @ up.matrix(block) for block in krylov]
    basis = field.stack_rows(rows, rows[0].ncols) @ up.matrix(as_exact(ideal.basis))
    larger = over_extension(ideal.algebra, up)
    return Subalgebra(larger, basis.primitive(), check=False)  # the kernel of a map that commutes with the bracket


def over_extension(algebra: LieAlgebra, up: Extension) -> LieAlgebra:
    """The algebra with its structure constants in a larger field, or itself if the extension is trivial."""
    if up.is_trivial:
        return algebra
    entries = [(i, j, k, up.embed(v)) for i, j, k, v in algebra.table]
    table = StructureConstants(up.field, algebra.dimension, entries)
    return LieAlgebra(table, basis=algebra.basis_names, name=algebra.name, check=False)  # same identities


# -- helpers ---------------------------------------------------------------------------------------------
def _own_algebra(ideal: Subalgebra) -> LieAlgebra:
    """The ideal as an algebra in its own basis; the algebra itself if its basis is that of the ideal."""
    algebra = ideal.algebra
    same = ideal.dimension == algebra.dimension and ideal.basis == algebra.field.identity(algebra.dimension)
    return algebra if same else ideal.as_algebra()


def _simplified(theta: ExactMatrix, f: Polynomial) -> tuple[ExactMatrix, Polynomial]:
    """A generator a theta + b of the field with trace 0 and, over QQ, an integral polynomial of small height."""
    m, field = f.degree, f.field
    if m == 1:
        return theta.field.identity(theta.nrows), Polynomial(field, [-1, 1])
    mean = -f.coefficients[m - 1] / m
    theta, f = theta - theta.field.identity(theta.nrows).scale(mean), f.shifted(mean)
    if field.degree > 1:
        return theta, f
    factor = _scale(f)
    return theta.scale(factor), Polynomial(field, [c * factor ** (m - i) for i, c in enumerate(f.coefficients)])


def _scale(f: Polynomial) -> Scalar:
    """The smallest rational a > 0 for which the polynomial of a theta has integer coefficients, f(theta) = 0."""
    m = f.degree
    low = [(m - i, QQ.convert(c)) for i, c in enumerate(f.coefficients[:-1]) if c != 0]
    factor = QQ.one
    for prime in _primes([c for _, c in low]):
        exponent = max(-((_valuation(int(c.p), prime) - _valuation(int(c.q), prime)) // gap) for gap, c in low)
        factor = factor * QQ.convert(prime) ** exponent if exponent > 0 else factor / QQ.convert(prime) ** -exponent
    return factor


def _primes(values: Sequence[Any]) -> list[int]:
    """Primes that divide a denominator or all numerators; numbers of more than `FACTORED_BITS` bits are skipped."""
    numbers = (lcm(*(int(c.q) for c in values)), gcd(*(int(c.p) for c in values)))
    small = (QQ.convert(number).p for number in numbers if number.bit_length() <= FACTORED_BITS)
    return sorted({int(p) for number in small for p, _ in number.factor()})


def _valuation(number: int, prime: int) -> int:
    """The exponent of a prime in an integer that is not 0."""
    exponent = 0
    while number % prime == 0:
        number, exponent = number // prime, exponent + 1
    return exponent


def _height(f: Polynomial) -> float:
    """Logarithm of the largest size of a coefficient over QQ, relative to its degree; 0 over other fields."""
    if f.field.degree > 1:
        return 0
    rationals = map(QQ.convert, f.coefficients[:-1])
    return max(log(max(abs(int(c.p)), int(c.q))) / (f.degree - i) for i, c in enumerate(rationals))


# The simple ideals of a Lie algebra, over the reals.
# A simple ideal has only inner derivations and no centre, so it is a direct summand.  The simple ideals over the field
# are therefore among the indecomposable summands, and over the reals each of them splits by the places of its centroid.


def simple_ideals(algebra: LieAlgebra) -> list[Subalgebra]:
    """Implements `LieAlgebra.simple_ideals`."""
    large = [ideal for ideal in direct_sum_decomposition(algebra) if ideal.dimension > 2]
    if not large:
        return []
    killing = as_exact(algebra.killing_form())  # the Killing form of an ideal is its restriction
    bases = (as_exact(ideal.basis) for ideal in large)
    semisimple = [(basis @ killing @ basis.T).rank() == basis.nrows for basis in bases]
    return [part for ideal, simple in zip(large, semisimple, strict=True) if simple for part in real_ideals(ideal)]
