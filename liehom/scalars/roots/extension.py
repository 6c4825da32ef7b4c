"""Extensions of real number fields: adjoining a real root, and factorization over the reals.

Let K = QQ(b) and F = QQ(c) with c = alpha + s b for a root alpha of an irreducible polynomial f over K (Trager). The
norm of f(t - s b) is the minimal polynomial of c, and b is the common root of its own minimal polynomial and of
x -> f^x(c - s x). A pair of roots alpha, conj(alpha) is adjoined through alpha + conj(alpha) or
(alpha + k)(conj(alpha) + k), whose conjugates are the roots of a resolvent (Newton's identities).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import comb, lcm
from typing import Any, final

import flint

from liehom.errors import FieldError, InternalError
from liehom.scalars.fields.balls import working_precision
from liehom.scalars.fields.exact_field import ExactField, ExactMatrix
from liehom.scalars.fields.field import Scalar
from liehom.scalars.fields.number_field import MAX_PRECISION, NumberField
from liehom.scalars.fields.number_fields import number_field
from liehom.scalars.fields.polynomial import Polynomial
from liehom.scalars.fields.rational import QQ
from liehom.scalars.roots.primitive_element import field_of_root, smaller_generator
from liehom.scalars.roots.roots import complex_root_balls


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
    >>> from liehom.scalars import QQ
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
        total = self.field.zero
        for c, power in zip(self.base.coordinates(value), self.powers, strict=True):
            total = total + power * c
        return total

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
    """The extension of a field that is the field itself.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> trivial_extension(QQ).is_trivial
    True
    """
    generator = field.from_coordinates([flint.fmpq(int(i == 1)) for i in range(field.degree)])
    return Extension(field, field, tuple(generator**i if i else field.one for i in range(field.degree)))


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
    >>> from liehom.scalars import QQ
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
        p, q = f.coefficients[1], f.coefficients[0]
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
    b = base.from_coordinates([flint.fmpq(int(i == 1)) for i in range(base.degree)])
    for s in range(1, 100):
        norm = f.shifted(-s * b)._norm()
        if norm.gcd(norm.derivative()).degree == 0:
            break
    else:
        raise InternalError("no shift makes the norm of a polynomial squarefree")
    precision = 64
    while True:
        near = _nth(real_roots(f, precision), index, f)
        with working_precision(precision):
            value = near + s * base.generator_ball(precision)
        if len([r for r in real_roots(norm, precision) if r.overlaps(value)]) == 1:
            break
        precision *= 2
    large = field_of_root(norm.coefficients, value, name)
    c = large.generator
    image = _image_of_generator(base, f, large, c, s)
    root = c - s * image
    den = lcm(*(int(x.q) for coefficient in f.coefficients for x in base.coordinates(coefficient)))
    # b and den * alpha are algebraic integers, and so are the elements of the ring that they generate
    integers = [large.convert(image**i * (root * den) ** j) for i in range(base.degree) for j in range(f.degree)]
    field, up = smaller_generator(large, integers)
    below, above = (_carried(large.coordinates(x), up) for x in (image, root))
    return Extension(base, field, tuple(below**i if i else field.one for i in range(base.degree))), above


def _carried(coordinates: Sequence[flint.fmpq], generator: Scalar) -> Scalar:
    """The element with these coordinates in powers of the integral generator, given the image of the generator."""
    total = generator * 0
    for c in reversed(coordinates):
        total = total * generator + c
    return total


def _image_of_generator(base: NumberField, f: Polynomial, field: NumberField, c: Scalar, s: int) -> Scalar:
    """Image of b: the common root in F of the modulus of K and of x -> f^x(c - s x)."""
    line = Polynomial(field, [c, -s])
    total = Polynomial(field, [])
    for coefficient in reversed(f.coefficients):
        total = total * line + Polynomial(field, base.coordinates(coefficient))
    common = total.gcd(Polynomial(field, base.modulus_coefficients()))
    if common.degree != 1:
        raise InternalError("a base field is not found in its extension")
    return -common.coefficients[0] / common.coefficients[1]


# -- roots and factors ---------------------------------------------------------------------------------------
def real_roots(f: Polynomial, precision: int) -> list[flint.arb]:
    """List of disjoint balls (``flint.arb``) around the real roots of a squarefree polynomial, in increasing order.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> [round(float(r), 3) for r in real_roots(Polynomial(QQ, [-2, 0, 1]), 64)]
    [-1.414, 1.414]
    """
    return [r.real for r in _sorted_roots(f, precision)[0]]


def _sorted_roots(f: Polynomial, precision: int) -> tuple[list[flint.acb], list[flint.acb]]:
    """Balls around the real roots, increasing, and around the roots in the upper half plane, by real part."""
    count = f.count_real_roots() if f.degree > 0 else 0
    while precision <= MAX_PRECISION:
        balls = complex_root_balls(f, precision)
        real = [r for r in balls if r.imag.contains(0)]
        upper = [r for r in balls if r.imag > 0]
        apart = len(real) == count and len(upper) == (f.degree - count) // 2
        ordered = sorted(real, key=lambda r: r.real.mid())
        if apart and not any(x.real.overlaps(y.real) for x, y in pairwise(ordered)):
            return ordered, sorted(upper, key=lambda r: (round(float(r.real.mid()), 9), float(r.imag.mid())))
        precision *= 2
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
    >>> from liehom.scalars import QQ
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
    found = []
    for index in range(len(real)):
        extension, root = adjoin_root(f, index, name)
        found.append(RealFactor(extension, Polynomial(extension.field, [-root, extension.field.one])))
    if f.degree == 2 and upper:
        return [RealFactor(trivial_extension(f.field), f)]
    return found + [_quadratic_factor(f, near, name) for near in upper]


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
    pairs = []
    for k in range(1, size + 1):
        total = sum((sums[r] * sums[k - r] * comb(k, r) for r in range(k + 1)), f.field.zero)
        pairs.append((total - sums[k] * 2**k) / 2)
    yield None, _from_power_sums(f.field, pairs)
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
        total = e[k] * k
        for i in range(1, k):
            total = total + e[i] * sums[k - i]
        sums.append(-total)
    return sums


def _from_power_sums(field: ExactField, sums: list[Scalar]) -> Polynomial:
    """The monic polynomial whose roots have these sums of 1st, 2nd, ... powers."""
    e = [field.one]
    for k in range(1, len(sums) + 1):
        total = field.zero
        for i in range(1, k + 1):
            total = total + e[k - i] * sums[i - 1]
        e.append(-total / k)
    return Polynomial(field, e[::-1])


def _refined(f: Polynomial, near: flint.acb, precision: int) -> flint.acb:
    """A smaller ball around the root of f in the ball `near`."""
    return next(r for r in _sorted_roots(f, precision)[1] if r.overlaps(near))


def _matching_root(
    f: Polynomial, near: flint.acb, shift: int | None, factors: list[Polynomial]
) -> tuple[Polynomial, int]:
    """The factor with the real root alpha + conj(alpha) or |alpha + shift|^2, and the index of this root."""
    precision = 64
    while precision <= MAX_PRECISION:
        alpha = _refined(f, near, precision)
        with working_precision(precision):
            centre = alpha.real + (shift or 0)
            # products, because the power of a ball that contains 0 is NaN in flint
            value = 2 * alpha.real if shift is None else centre * centre + alpha.imag * alpha.imag
        roots = [(g, i, root) for g in factors for i, root in enumerate(real_roots(g, precision))]
        found = [(g, i) for g, i, root in roots if root.overlaps(value)]
        if len(found) == 1:
            return found[0]
        precision *= 2
    raise FieldError(f"a root of {f} could not be distinguished with {MAX_PRECISION} bits")


def _has_root(h: Polynomial, f: Polynomial, near: flint.acb) -> bool:
    """Whether the quadratic factor h of f (over a larger field) has the given root of f."""
    if h.count_real_roots():
        return False
    precision = 64
    while precision <= MAX_PRECISION:
        root = _sorted_roots(h, precision)[1][0]
        close = [alpha for alpha in _sorted_roots(f, precision)[1] if alpha.overlaps(root)]
        if len(close) == 1:
            return bool(close[0].overlaps(near))
        precision *= 2
    raise FieldError(f"a root of {f} could not be distinguished with {MAX_PRECISION} bits")
