"""Simple algebras over a field, split over the reals: one real simple ideal for each place of the centroid.

Over QQ, the centroid of a simple algebra I is a number field K = QQ(theta), theta a matrix with the irreducible minimal
polynomial f.  I (x) R is the sum of ideals I_v, one for each real root of f (absolutely simple, of dimension
dim I / deg f) and one for each pair of complex roots (a complex simple algebra as a real one).  These are the places of
K, in the sense of number theory.  Let kappa be the Killing form.  The form kappa((theta - c) x, y) is
(theta_v - c) kappa_v on a real I_v and has signature 0 on a complex one.  As c increases through theta_v, its signature
drops by twice the signature of kappa_v, so exact signatures over the base field give those of all kappa_v.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import gcd, lcm, log
from typing import Any, Literal, final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.structure.commuting_maps import combinations, minimal_polynomial
from liehom.errors import FieldError, InputError, InternalError
from liehom.scalars import QQ, ExactMatrix, Polynomial, Scalar, as_exact
from liehom.scalars.roots.extension import Extension, RealFactor, real_factors

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
    """The centroid of a simple algebra as a field.

    Attributes
    ----------
    algebra : LieAlgebra
        The simple algebra in the basis of the given ideal.
    generator : ExactMatrix
        A generator theta, shape (n, n), on columns in that basis; the identity if the centroid is the base field.
    polynomial : Polynomial
        The minimal polynomial f of theta over the base field, irreducible, of degree dim K.
    """

    algebra: LieAlgebra
    generator: ExactMatrix
    polynomial: Polynomial

    @property
    def degree(self) -> int:
        """The degree of the centroid over the base field, an int."""
        return self.polynomial.degree


def centroid_field(ideal: Subalgebra) -> CentroidField:
    """The centroid, as a field with a generator, of a subalgebra that is simple over its field.

    Raises
    ------
    InputError
        If the subalgebra is not simple, because its Killing form is degenerate or it is a sum of ideals.
    UndecidedError
        Over float64.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3, 1)
    >>> centroid_field(g.subalgebra(g.whole().basis)).polynomial
    (1)*t**0 + (1)*t**2
    """
    algebra = _own_algebra(ideal)
    if algebra.dimension == 0 or algebra.killing_form().rank() < algebra.dimension:
        raise InputError(f"the Killing form of {ideal!r} is degenerate; expected a simple ideal")
    maps = algebra.centroid()
    degree = len(maps)
    start = algebra.field.unit(algebra.dimension, 0)
    found: list[tuple[ExactMatrix, Polynomial]] = []
    for theta in combinations(maps, random.Random(degree)):
        f = minimal_polynomial(theta, start)
        if len(f.factor()) > 1:
            raise InputError(f"{ideal!r} is a sum of ideals; take one of its direct_sum_decomposition")
        if f.degree == degree:
            found.append(_simplified(theta, f))
        if len(found) == (CANDIDATES if degree > 2 else 1):
            break
    if not found:
        raise InternalError("no element of the centroid generates it")
    theta, f = min(found, key=lambda pair: _height(pair[1]))
    return CentroidField(algebra, theta, f)


def places(ideal: Subalgebra) -> list[Place]:
    """Implements `Subalgebra.places`."""
    return field_places(centroid_field(ideal))


def field_places(centroid: CentroidField) -> list[Place]:
    """The places of the centroid of a simple algebra, as `places` returns them."""
    f, n = centroid.polynomial, centroid.algebra.dimension
    size = n // f.degree
    intervals = real_root_intervals(f)
    made = []
    for interval, index in zip(intervals, _indices(centroid, intervals), strict=True):
        if (size + index) % 2 or abs(index) > size:
            raise InternalError(f"a Killing form of dimension {size} and index {index}")
        made.append(Place("real", f, interval, ((size + index) // 2, (size - index) // 2), size))
    pairs = (f.degree - len(intervals)) // 2
    return made + [Place("complex", f, None, (size, size), 2 * size)] * pairs


def _indices(centroid: CentroidField, intervals: list[Interval]) -> list[int]:
    """The number of positive minus the number of negative squares of the Killing form, at each real root."""
    if not intervals:
        return []
    killing = as_exact(centroid.algebra.killing_form())
    twisted = killing @ centroid.generator
    field = centroid.algebra.field
    below = _index(killing)
    values = [below]
    for interval in intervals[:-1]:
        values.append(_index(twisted - killing.scale(field.convert(interval[1]))))
    values.append(-below)  # above all roots the form is minus the form below them, up to positive factors on the ideals
    return [(a - b) // 2 for a, b in itertools.pairwise(values)]


def _index(form: ExactMatrix) -> int:
    """The number of positive minus the number of negative squares of a symmetric form."""
    positive, negative, _ = form.signature()
    return int(positive - negative)


def real_root_intervals(f: Polynomial) -> list[Interval]:
    """Disjoint intervals with one real root each of a squarefree polynomial, by their rational ends, left to right.

    No end is a root.

    Examples
    --------
    >>> real_root_intervals(Polynomial(QQ, [1, -3, 0, 1]))
    [(-2, 0), (0, 1), (1, 2)]
    """
    count = f.root_counter()
    total, bound = count(None, None), QQ.one
    while count(-bound, bound) < total or f(bound) == 0 or f(-bound) == 0:
        bound = bound * 2
    found: list[Interval] = []
    rest = [(-bound, bound, total)]
    while rest:
        low, high, inside = rest.pop()
        if inside <= 1:
            found += [(low, high)] * inside
            continue
        middle = (low + high) / 2
        while f(middle) == 0:
            middle = (middle + high) / 2
        left = count(low, middle)
        rest += [(middle, high, inside - left), (low, middle, left)]
    return found


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
        rows = [field.unit(n, i)]
        while len(rows) < m:
            rows.append(rows[-1] @ centroid.generator.T)
        grown = field.stack_rows([*blocks, *rows], n)
        if grown.rank() == grown.nrows:
            blocks.append(field.stack_rows(rows, n))
        if len(blocks) * m == n:
            break
    return blocks


def _real_ideal(ideal: Subalgebra, factor: RealFactor, f: Polynomial, krylov: list[ExactMatrix]) -> Subalgebra:
    """The kernel of q(theta) for a factor q of f over a larger field, as the image of (f / q)(theta)."""
    up, q = factor.extension, factor.polynomial
    field = up.field
    cofactor = list((up.polynomial(f) // q).coefficients)
    shifts = [[field.zero] * k + cofactor + [field.zero] * (q.degree - 1 - k) for k in range(q.degree)]
    weights = field.matrix(shifts)
    rows = [weights @ up.matrix(block) for block in krylov]
    smaller, given = ideal.algebra, as_exact(ideal.basis)
    larger = over_extension(smaller, up)
    basis = field.stack_rows(rows, rows[0].ncols) @ up.matrix(given)
    return Subalgebra(larger, basis.primitive(), check=False)  # the kernel of a map that commutes with the bracket


def over_extension(algebra: LieAlgebra, up: Extension) -> LieAlgebra:
    """The algebra with its structure constants in a larger field, or itself if the extension is trivial.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.scalars.roots.extension import adjoin_root
    >>> up, _ = adjoin_root(Polynomial(QQ, [-2, 0, 1]), 1)
    >>> over_extension(lh.so(3), up).field
    QQ(sqrt(2))
    """
    if up.is_trivial:
        return algebra
    entries = [(i, j, k, up.embed(v)) for i, j, k, v in algebra.table]
    table = StructureConstants(up.field, algebra.dimension, entries)
    return LieAlgebra(table, basis=algebra.basis_names, name=algebra.name, check=False)  # same identities


# -- helpers ---------------------------------------------------------------------------------------------
def _own_algebra(ideal: Subalgebra) -> LieAlgebra:
    """The ideal as an algebra in its own basis, which is the whole algebra if the ideal is."""
    algebra = ideal.algebra
    whole = ideal.dimension == algebra.dimension and ideal.basis == algebra.field.identity(algebra.dimension)
    return algebra if whole else ideal.as_algebra()


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
    bottom = lcm(*(int(c.q) for c in values))
    common = gcd(*(int(c.p) for c in values))
    found: set[int] = set()
    for number in (bottom, common):
        if number.bit_length() <= FACTORED_BITS:
            found |= {int(p) for p, _ in QQ.convert(number).p.factor()}
    return sorted(found)


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
