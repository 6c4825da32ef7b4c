"""Extensions of real number fields: small generators, adjoining a real root, factorization over the reals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, count, pairwise
from math import comb, lcm
from typing import Any, final

import flint

from liehom.base.errors import FieldError, InternalError
from liehom.base.typing import ScalarLike
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.number_fields import AlgebraicNumber, NumberField, number_field
from liehom.exact.scalars.polynomial import Polynomial, horner, integral_generator
from liehom.exact.scalars.rational import MAX_PRECISION, QQ, precisions, real_root_balls, working_precision
from liehom.exact.scalars.roots import bounds, complex_root_balls, simplest_between

# The size of an algebraic integer is the sum of the squares of its conjugates (T2-norm). An LLL-reduced basis of a
# lattice of algebraic integers starts with small ones, and one of them, or the sum of two, generates the field. Balls
# only propose candidates: the chosen generator is exact for any precision.

MAX_REDUCED_DEGREE = 24  # up to which a smaller generator is sought
MAX_DEGREE_FOR_SUMS = 8  # up to which sums of two elements are candidates too
SMALL_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31)


def field_of_root(f: Sequence[ScalarLike], near: flint.arb, name: str = "a") -> NumberField:
    """The field QQ(alpha) of the real root of an irreducible rational polynomial in a ball."""
    integral = flint.fmpq_poly([QQ.convert(c) for c in f]).numer()
    for precision in precisions():
        interval = _isolating(integral, near, precision)
        if interval is not None:
            return NumberField(name, [int(c) for c in integral.coeffs()], interval)
    raise FieldError(f"the root of {integral} in {near} could not be isolated with {MAX_PRECISION} bits")


def smaller_generator(field: NumberField, integers: Sequence[AlgebraicNumber]) -> tuple[NumberField, AlgebraicNumber]:
    """The field with a generator of small minimal polynomial, and the image in it of the old integral generator."""
    n = field.degree
    modulus, one, t = flint.fmpq_poly(field.modulus), flint.fmpq_poly([1]), flint.fmpq_poly([0, 1])
    best, chosen = field.modulus, t
    for element in _small(field, integers) if n <= MAX_REDUCED_DEGREE else []:
        # the characteristic polynomial over QQ
        polynomial = _multiples(element, t, modulus).charpoly().numer()
        if polynomial.gcd(polynomial.derivative()).degree() > 0:
            continue  # of a proper subfield
        k = _common_scale([polynomial[i] for i in range(n)])
        scaled = flint.fmpz_poly([*(polynomial[i] // flint.fmpz(k) ** (n - i) for i in range(n)), 1])
        if _size(scaled) < _size(best):
            best, chosen = scaled, element / k
    value = AlgebraicNumber(field, chosen)
    for precision in precisions():
        interval = _isolating(best, field.ball(value, precision), precision)
        if interval is not None:
            smaller = NumberField(field.symbol, [int(c) for c in best.coeffs()], interval)
            target = flint.fmpq_mat(n, 1, [int(i == 1) for i in range(n)])
            powers = _multiples(one, chosen, modulus).transpose()
            return smaller, smaller.from_coordinates(powers.solve(target).entries())
    raise FieldError(
        f"a generator of {field.name} could not be distinguished from its conjugates with {MAX_PRECISION} bits"
    )


def _size(polynomial: flint.fmpz_poly) -> tuple[int, int]:
    coefficients = [int(c) for c in polynomial.coeffs()]
    return max(abs(c) for c in coefficients), sum(c != 0 for c in coefficients)


def _small(field: NumberField, integers: Sequence[AlgebraicNumber]) -> list[flint.fmpq_poly]:
    """Elements with small conjugates, as polynomials in the integral generator."""
    n = field.degree
    rows = [x.coordinates for x in integers]
    den = lcm(*(int(c.q) for row in rows for c in row))
    size = max(int(abs(c)).bit_length() for c in field.modulus.coeffs())
    bits = 64 + 4 * n
    with working_precision(2 * bits + 8 * n * size):
        pairs: Any = field.modulus.complex_roots()  # of a root and its multiplicity
        roots = [r for r, _ in pairs if r.imag.is_zero() or r.imag > 0]
        table = [[int(c * den) for c in row] + _embedded(row, roots, bits) for row in rows]
    # the coordinates, small compared with the scaled embeddings, record the combination
    reduced = [row[:n] for row in flint.fmpz_mat(table).lll().tolist() if any(row[:n])]
    if n <= MAX_DEGREE_FOR_SUMS:
        two = list(combinations(reduced, 2))
        reduced += [[x + sign * y for x, y in zip(p, q, strict=True)] for p, q in two for sign in (1, -1)]
    return [flint.fmpq_poly([flint.fmpq(c, den) for c in row]) for row in reduced]


def _embedded(coordinates: list[flint.fmpq], roots: list[flint.acb], bits: int) -> list[int]:
    """Real and imaginary parts of the conjugates, times 2^bits, rounded."""
    parts = []
    for root in roots:
        value = horner([flint.arb(c) for c in coordinates], root, root * 0)
        parts += [value.real] if root.imag.is_zero() else [value.real, value.imag]
    return [int((part * (1 << bits)).mid().floor().fmpz()) for part in parts]


def _multiples(element: flint.fmpq_poly, factor: flint.fmpq_poly, modulus: flint.fmpq_poly) -> flint.fmpq_mat:
    """Rows: the n coordinates of an element times the powers 0, ..., n - 1 of a factor."""
    n, rows = modulus.degree(), []
    for _ in range(n):
        rows += [element[i] for i in range(n)]
        element = (element * factor) % modulus
    return flint.fmpq_mat(n, n, rows)


def _common_scale(coefficients: list[flint.fmpz]) -> int:
    """The largest k made of small primes with k^(n - i) dividing coefficient i for all i."""
    n, k = len(coefficients), 1
    for p in SMALL_PRIMES:
        while all(c % flint.fmpz(p * k) ** (n - i) == 0 for i, c in enumerate(coefficients)):
            k *= p
    return k


def _isolating(polynomial: flint.fmpz_poly, near: flint.arb, precision: int) -> tuple[flint.fmpq, flint.fmpq] | None:
    """Simple rational ends of an interval around the one real root in a ball, or None if the precision is too low."""
    roots = real_root_balls(polynomial, precision)
    close = [i for i, r in enumerate(roots) if r.overlaps(near)]
    if len(close) != 1:
        return None
    (at,) = close
    low, high = bounds(roots[at])
    floor = bounds(roots[at - 1])[1] if at else low - 1
    ceiling = bounds(roots[at + 1])[0] if at + 1 < len(roots) else high + 1
    return (simplest_between(floor, low), simplest_between(high, ceiling)) if floor < low and high < ceiling else None


# Let K = QQ(b) and F = QQ(c) with c = alpha + s b for a root alpha of an irreducible polynomial f over K (Trager). The
# norm of f(t - s b) is the minimal polynomial of c, and b is the common root of its own minimal polynomial and of x ->
# f^x(c - s x). A pair of roots alpha, conj(alpha) is adjoined through alpha + conj(alpha) or (alpha + k)(conj(alpha) +
# k), whose conjugates are the roots of a resolvent (Newton's identities).


@final
@dataclass(frozen=True, slots=True)
class Extension:
    """An embedding of a real number field K in a field F that respects the real embeddings.

    Attributes
    ----------
    base, field : ExactField
        K and F.
    powers : tuple of elements of F
        The images of 1, b, b^2, ... for the integral generator b of K (of 1 for QQ).

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> up, root = adjoin_root(Polynomial(QQ, [-2, 0, 1]), 1)
    >>> up.field, root, up.embed(QQ.convert("1/2"))
    (QQ(sqrt(2)), sqrt(2), 1/2)
    """

    base: ExactField
    field: ExactField
    powers: tuple[Scalar, ...]

    @property
    def is_trivial(self) -> bool:
        """Whether F equals K."""
        return self.base == self.field

    def embed(self, value: Scalar) -> Scalar:
        """Image in F of an element of K."""
        if self.is_trivial:
            return value
        pairs = zip(self.base.coordinates(value), self.powers, strict=True)
        return sum((power * c for c, power in pairs), self.field.zero)

    def matrix(self, matrix: ExactMatrix) -> ExactMatrix:
        """Image over F of a matrix over K, an `ExactMatrix`."""
        if self.is_trivial:
            return matrix
        total = self.field.zeros(*matrix.shape)
        for part, power in zip(matrix.parts, self.powers, strict=True):
            if not part.is_zero():
                total = total + self.field.from_integers(part.entries(), *matrix.shape, matrix.den).scale(power)
        return total

    def polynomial(self, polynomial: Polynomial) -> Polynomial:
        """Image over F of a polynomial over K."""
        return Polynomial(self.field, [self.embed(c) for c in polynomial.coefficients])

    def then(self, other: Extension) -> Extension:
        """The extension of K in a third field, given the extension `other` of F in it."""
        return Extension(self.base, other.field, tuple(other.embed(p) for p in self.powers))


def trivial_extension(field: ExactField) -> Extension:
    """The extension of a field that is the field itself."""
    generator = integral_generator(field)
    return Extension(field, field, tuple(generator**i for i in range(field.degree)))


def adjoin_root(f: Polynomial, index: int, name: str = "a") -> tuple[Extension, Scalar]:
    """The extension of K in K(alpha) and alpha, a real root of an irreducible polynomial over K.

    Parameters
    ----------
    f : Polynomial
        Irreducible over its field K.
    index : int
        The number of the real root, counted from the left.
    name : str
        The symbol of the new generator, unless it is the square root of a rational number.

    Raises
    ------
    FieldError
        If f has no such real root.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> up, root = adjoin_root(Polynomial(QQ, [1, -3, 0, 1]), 2)
    >>> up.field.degree, root**3 - 3 * root + 1, round(float(root), 3)
    (3, 0, 1.532)
    """
    base = f.field
    f = f.monic()
    if f.degree == 1:
        return trivial_extension(base), -f.coefficients[0]
    if isinstance(base, NumberField):
        return _above(base, f, index, name)
    near = _nth(real_roots(f, 64), index, f)
    if f.degree == 2:
        # root = (-p +- sqrt(p^2 - 4 q)) / 2
        q, p, _ = f.coefficients
        field, square_root = _quadratic(p * p - 4 * q, name)
        return Extension(base, field, (field.one,)), (square_root if index == 1 else -square_root) / 2 - p / 2
    large = field_of_root(f.coefficients, near, name)
    b = large.generator * large.leading
    small, image = smaller_generator(large, [b**i for i in range(large.degree)])
    return Extension(base, small, (small.one,)), image / large.leading


def _quadratic(discriminant: Scalar, name: str) -> tuple[ExactField, Scalar]:
    """The field QQ(sqrt(d)) and the positive square root of the discriminant in it."""
    try:
        field: Any = number_field(f"sqrt({discriminant})")
    except FieldError:  # the number is too large for its squarefree part
        field = field_of_root([-discriminant, 0, 1], flint.arb(QQ.convert(discriminant)).sqrt(), name)
        return field, field.generator
    return field, field.sqrt(field.convert(discriminant))


def _nth(balls: list[flint.arb], index: int, f: Polynomial) -> flint.arb:
    if not 0 <= index < len(balls):
        raise FieldError(f"{f} has {len(balls)} real roots, number {index} was asked for")
    return balls[index]


def _above(base: NumberField, f: Polynomial, index: int, name: str) -> tuple[Extension, Scalar]:
    s, norm = f.squarefree_norm(1)
    for precision in (64 << k for k in count()):
        near = _nth(real_roots(f, precision), index, f)
        with working_precision(precision):
            value = near + s * base.generator_ball(precision)
        if len([r for r in real_roots(norm, precision) if r.overlaps(value)]) == 1:
            break
    large = field_of_root(norm.coefficients, value, name)
    image = _image_of_generator(base, f, large, large.generator, s)
    root = large.generator - s * image
    den = lcm(*(int(x.q) for coefficient in f.coefficients for x in base.coordinates(coefficient)))
    # b and den * alpha are algebraic integers, and so are the elements of the ring that they generate
    integers = [large.convert(image**i * (root * den) ** j) for i in range(base.degree) for j in range(f.degree)]
    field, up = smaller_generator(large, integers)
    below, above = (horner(large.coordinates(x), up, up * 0) for x in (image, root))
    return Extension(base, field, tuple(below**i for i in range(base.degree))), above


def _image_of_generator(base: NumberField, f: Polynomial, field: NumberField, c: Scalar, s: int) -> Scalar:
    """Image of b: the common root in F of the modulus of K and of x -> f^x(c - s x)."""
    coefficients = [Polynomial(field, base.coordinates(coefficient)) for coefficient in f.coefficients]
    value: Polynomial = horner(coefficients, Polynomial(field, [c, -s]), Polynomial(field, []))
    common = value.gcd(Polynomial(field, base.modulus_coefficients()))
    if common.degree != 1:
        raise InternalError("a base field is not found in its extension")
    return -common.coefficients[0] / common.coefficients[1]


# -- roots and factors ---------------------------------------------------------------------------------------
def real_roots(f: Polynomial, precision: int) -> list[flint.arb]:
    """List of disjoint balls (``flint.arb``) around the real roots of a squarefree polynomial, in increasing order."""
    return [r.real for r in _sorted_roots(f, precision)[0]]


def _sorted_roots(f: Polynomial, precision: int) -> tuple[list[flint.acb], list[flint.acb]]:
    """Balls around the real roots, increasing, and around the roots in the upper half plane, by real part."""
    number = f.count_real_roots() if f.degree > 0 else 0
    for bits in precisions(precision):
        balls = complex_root_balls(f, bits)
        real = sorted((r for r in balls if r.imag.contains(0)), key=lambda r: r.real.mid())
        upper = [r for r in balls if r.imag > 0]
        apart = len(real) == number and len(upper) == (f.degree - number) // 2
        if apart and not any(x.real.overlaps(y.real) for x, y in pairwise(real)):
            return real, sorted(upper, key=lambda r: (round(float(r.real.mid()), 9), float(r.imag.mid())))
    raise FieldError(f"the real roots of {f} could not be distinguished with {MAX_PRECISION} bits")


@final
@dataclass(frozen=True, slots=True)
class RealFactor:
    """A real factor of a polynomial over K, over the smallest field that contains its coefficients.

    Attributes
    ----------
    extension : Extension
        K in the field of the factor.
    polynomial : Polynomial
        Monic, of degree 1, or of degree 2 without real roots, over ``extension.field``.
    """

    extension: Extension
    polynomial: Polynomial


def real_factors(f: Polynomial, name: str = "a") -> list[RealFactor]:
    """The real factors of an irreducible polynomial over K, the linear factors first.

    Returns
    -------
    list of RealFactor
        t - alpha over K(alpha) for the real roots alpha in increasing order, then t^2 - p t + q over K(p, q).

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> for factor in real_factors(Polynomial(QQ, [1, 0, 0, 0, 1])):
    ...     print(factor.extension.field, factor.polynomial)
    ...
    QQ(sqrt(2)) (1)*t**0 + (sqrt(2))*t**1 + (1)*t**2
    QQ(sqrt(2)) (1)*t**0 + (-sqrt(2))*t**1 + (1)*t**2
    >>> [factor.extension.field.degree for factor in real_factors(Polynomial(QQ, [-2, 0, 0, 1]))]
    [3, 3]
    """
    f = f.monic()
    real, upper = _sorted_roots(f, 64)
    if f.degree == 2 and upper:
        return [RealFactor(trivial_extension(f.field), f)]
    roots = (adjoin_root(f, index, name) for index in range(len(real)))
    linear = [RealFactor(up, Polynomial(up.field, [-root, up.field.one])) for up, root in roots]
    return linear + [_quadratic_factor(f, near, name) for near in upper]


def _quadratic_factor(f: Polynomial, near: flint.acb, name: str) -> RealFactor:
    """The quadratic factor whose root in the upper half plane is in a ball."""
    for shift, resolvent in _resolvents(f):
        factors = [g for part, _ in resolvent.squarefree_parts() for g, _ in part.factor()]
        g, index = _matching_root(f, near, shift, factors)
        extension, _ = adjoin_root(g, index, name)
        for h, _ in extension.polynomial(f).factor():
            if h.degree == 2 and _has_root(h, f, near):
                return RealFactor(extension, h)
    raise InternalError("no resolvent shows the field of a pair of complex roots")


def _resolvents(f: Polynomial) -> Iterator[tuple[int | None, Polynomial]]:
    """(None, polynomial with roots alpha_i + alpha_j), then (k, polynomial with roots (alpha_i + k)(alpha_j + k))."""
    size = f.degree * (f.degree - 1) // 2
    sums = _power_sums(f, size)
    squares = [sum((sums[r] * sums[k - r] * comb(k, r) for r in range(k + 1)), f.field.zero) for k in range(size + 1)]
    yield None, _from_power_sums(f.field, [(squares[k] - sums[k] * 2**k) / 2 for k in range(1, size + 1)])
    for k in range(4 * size + 4):
        shift = (k + 1) // 2 if k % 2 else -(k // 2)
        sums = _power_sums(f.shifted(-shift), 2 * size)
        yield shift, _from_power_sums(f.field, [(sums[i] ** 2 - sums[2 * i]) / 2 for i in range(1, size + 1)])


def _power_sums(f: Polynomial, count: int) -> list[Scalar]:
    """List of the sums of the 0th, ..., count-th powers of the roots of a monic polynomial."""
    n = f.degree
    e = [f.coefficients[n - i] if i <= n else f.field.zero for i in range(count + 1)]  # signs included
    sums = [f.field.one * n]
    for k in range(1, count + 1):
        sums.append(-sum((e[i] * sums[k - i] for i in range(1, k)), e[k] * k))
    return sums


def _from_power_sums(field: ExactField, sums: list[Scalar]) -> Polynomial:
    """The monic polynomial whose roots have these sums of 1st, 2nd, ... powers."""
    e = [field.one]
    for k in range(1, len(sums) + 1):
        e.append(-sum((e[k - i] * sums[i - 1] for i in range(1, k + 1)), field.zero) / k)
    return Polynomial(field, e[::-1])


def _matching_root(
    f: Polynomial, near: flint.acb, shift: int | None, factors: list[Polynomial]
) -> tuple[Polynomial, int]:
    """The factor with the real root alpha + conj(alpha) or |alpha + shift|^2, and the index of this root."""
    for precision in precisions():
        alpha = next(r for r in _sorted_roots(f, precision)[1] if r.overlaps(near))
        with working_precision(precision):
            centre = alpha.real + (shift or 0)
            # products, because the power of a ball that contains 0 is NaN in flint
            value = 2 * alpha.real if shift is None else centre * centre + alpha.imag * alpha.imag
        roots = [(g, i, root) for g in factors for i, root in enumerate(real_roots(g, precision))]
        close = [(g, i) for g, i, root in roots if root.overlaps(value)]
        if len(close) == 1:
            return close[0]
    raise FieldError(f"a root of {f} could not be distinguished with {MAX_PRECISION} bits")


def _has_root(h: Polynomial, f: Polynomial, near: flint.acb) -> bool:
    """Whether the quadratic factor h of f (over a larger field) has the given root of f."""
    if h.count_real_roots():
        return False
    for precision in precisions():
        root = _sorted_roots(h, precision)[1][0]
        close = [alpha for alpha in _sorted_roots(f, precision)[1] if alpha.overlaps(root)]
        if len(close) == 1:
            return bool(close[0].overlaps(near))
    raise FieldError(f"a root of {f} could not be distinguished with {MAX_PRECISION} bits")
