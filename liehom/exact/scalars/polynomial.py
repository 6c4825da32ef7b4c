"""Polynomials in one variable over QQ or a real number field, with exact root counts and factorization.

Real roots are counted by Sturm sequences, roots with real part above a cut by the Cauchy index of f(c + i y)
(Routh-Hurwitz). Over QQ, flint factors. Over QQ(a), Trager's method shifts the polynomial until its norm is
squarefree, factors the norm over QQ and takes greatest common divisors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import zip_longest
from typing import Any, TypeAlias, TypeVar, final

import flint

from liehom.base.errors import FieldError, InternalError
from liehom.base.objects import Immutable
from liehom.base.typing import ScalarLike
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.integer_matrices import sign_changes
from liehom.exact.scalars.rational import QQ

T = TypeVar("T")
RootCounter: TypeAlias = Callable[[ScalarLike | None, ScalarLike | None], int]
"""The number of roots in an interval (low, high], unbounded where an end is None."""


def horner(coefficients: Sequence[object], at: object, zero: T) -> T:
    """The value of a polynomial with ascending coefficients at a number, a ball, a matrix, ..."""
    total: Any = zero
    for c in reversed(coefficients):
        total = total * at + c
    return total


def linear_root(coefficients: Sequence[int], p: int) -> int | None:
    """A root modulo a prime of a polynomial with ascending integer coefficients, or None if it has none."""
    return next(iter(linear_roots(coefficients, p)), None)


def linear_roots(coefficients: Sequence[int], p: int) -> list[int]:
    """The distinct roots modulo a prime of a polynomial with ascending integer coefficients."""
    factors = flint.nmod_poly([c % p for c in coefficients], p).factor()[1]
    return [-int(f[0]) * pow(int(f[1]), -1, p) % p for f, _ in factors if f.degree() == 1]


def integral_generator(field: ExactField) -> Scalar:
    """The integral generator b of a field; 0 for QQ."""
    return field.from_coordinates([flint.fmpq(int(i == 1)) for i in range(field.degree)])


@final
class Polynomial(Immutable):
    """A polynomial over an exact field; coefficients ascending, no leading zeros, zero is the empty tuple.

    Examples
    --------
    >>> f = Polynomial(QQ, [-2, 0, 1])
    >>> f.degree, f.count_real_roots(), f.count_right_of(1)
    (2, 2, 1)
    """

    __slots__ = ("coefficients", "field")

    def __init__(self, field: ExactField, coefficients: Sequence[ScalarLike]) -> None:
        self.field: ExactField = field
        values = [field.convert(c) for c in coefficients]
        while values and values[-1] == 0:
            values.pop()
        self.coefficients: tuple[Scalar, ...] = tuple(values)

    @property
    def degree(self) -> int:
        """Degree, an int; -1 for the zero polynomial."""
        return len(self.coefficients) - 1

    @property
    def leading(self) -> Scalar:
        """Leading coefficient, a field element; zero for the zero polynomial."""
        return self.coefficients[-1] if self.coefficients else self.field.zero

    def __call__(self, value: Scalar | int) -> Scalar:
        return horner(self.coefficients, value, self.field.zero)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial) and self.coefficients == other.coefficients

    def __hash__(self) -> int:
        return hash(self.coefficients)

    def __repr__(self) -> str:
        terms = [f"({self.field.format(c)})*t**{i}" for i, c in enumerate(self.coefficients) if c != 0]
        return " + ".join(terms) or "0"

    # -- arithmetic --------------------------------------------------------------------------------------
    def _flint(self) -> flint.fmpq_poly:
        """The polynomial over QQ as a ``flint.fmpq_poly``."""
        return flint.fmpq_poly([QQ.convert(c) for c in self.coefficients])

    def __add__(self, other: Polynomial) -> Polynomial:
        pairs = zip_longest(self.coefficients, other.coefficients, fillvalue=self.field.zero)
        return Polynomial(self.field, [a + b for a, b in pairs])

    def __neg__(self) -> Polynomial:
        return Polynomial(self.field, [-c for c in self.coefficients])

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + (-other)

    def __mul__(self, other: Polynomial) -> Polynomial:
        if self.field.degree == 1:
            return Polynomial(self.field, (self._flint() * other._flint()).coeffs())
        out = [self.field.zero] * max(0, len(self.coefficients) + len(other.coefficients) - 1)
        for i, a in enumerate(self.coefficients):
            for j, b in enumerate(other.coefficients):
                out[i + j] = out[i + j] + a * b
        return Polynomial(self.field, out)

    def divided(self, other: Polynomial) -> tuple[Polynomial, Polynomial]:
        """Quotient and remainder; ``ZeroDivisionError`` if the divisor is zero."""
        if other.degree < 0:
            raise ZeroDivisionError("division by the zero polynomial")
        if self.field.degree == 1:
            pair = divmod(self._flint(), other._flint())
            return Polynomial(self.field, pair[0].coeffs()), Polynomial(self.field, pair[1].coeffs())
        rest, inverse = list(self.coefficients), 1 / other.leading
        quotient = [self.field.zero] * max(0, len(rest) - other.degree)
        for i in range(len(rest) - 1 - other.degree, -1, -1):
            quotient[i] = rest[i + other.degree] * inverse
            for j, c in enumerate(other.coefficients):
                rest[i + j] = rest[i + j] - quotient[i] * c
        return Polynomial(self.field, quotient), Polynomial(self.field, rest[: other.degree])

    def __mod__(self, other: Polynomial) -> Polynomial:
        return self.divided(other)[1]

    def __floordiv__(self, other: Polynomial) -> Polynomial:
        return self.divided(other)[0]

    def monic(self) -> Polynomial:
        """The polynomial divided by its leading coefficient."""
        return Polynomial(self.field, [c / self.leading for c in self.coefficients])

    def derivative(self) -> Polynomial:
        """The derivative."""
        return Polynomial(self.field, [c * i for i, c in enumerate(self.coefficients)][1:])

    def shifted(self, by: ScalarLike) -> Polynomial:
        """The polynomial f(t + by)."""
        values, by = list(self.coefficients), self.field.convert(by)
        for start in range(len(values) - 1):
            for i in range(len(values) - 2, start - 1, -1):
                values[i] = values[i] + by * values[i + 1]
        return Polynomial(self.field, values)

    def gcd(self, other: Polynomial) -> Polynomial:
        """The monic greatest common divisor."""
        if self.field.degree == 1:
            return Polynomial(self.field, self._flint().gcd(other._flint()).coeffs())
        a, b = self, other
        while b.degree >= 0:
            a, b = b, (a % b)
            b = b.monic() if b.degree >= 0 else b
        return a.monic() if a.degree >= 0 else a

    # -- factors -----------------------------------------------------------------------------------------
    def squarefree_parts(self) -> list[tuple[Polynomial, int]]:
        """Pairs (squarefree monic part, multiplicity) whose product is the polynomial up to a constant (Yun)."""
        parts = []
        derivative = self.derivative()
        common = self.gcd(derivative)
        rest, quotient, multiplicity = self // common, derivative // common, 1
        while rest.degree > 0:
            other = quotient - rest.derivative()
            part = rest.gcd(other)
            if part.degree > 0:
                parts.append((part.monic(), multiplicity))
            rest, quotient, multiplicity = rest // part, other // part, multiplicity + 1
        return parts

    def factor(self) -> list[tuple[Polynomial, int]]:
        """Pairs (monic irreducible factor, multiplicity), sorted by degree.

        Examples
        --------
        >>> [f.degree for f, _ in Polynomial(QQ, [-1, 0, 0, 1]).factor()]
        [1, 2]
        """
        if self.field.degree == 1:
            factors = [(Polynomial(self.field, f.coeffs()).monic(), m) for f, m in self._flint().numer().factor()[1]]
        else:
            factors = [(f, m) for part, m in self.squarefree_parts() for f in part._factor_squarefree()]
        return sorted(factors, key=lambda pair: pair[0].degree)

    def _factor_squarefree(self) -> list[Polynomial]:
        if self.degree <= 1:
            return [self.monic()]
        s, norm = self.squarefree_norm(0)
        shift = s * integral_generator(self.field)
        factors, rest = [], self.monic()
        for f, _ in norm.factor():
            common = rest.gcd(Polynomial(self.field, f.coefficients).shifted(shift))
            if common.degree > 0:
                factors.append(common)
                rest = rest // common
        return factors

    def squarefree_norm(self, first: int) -> tuple[int, Polynomial]:
        """The least s >= `first` such that the norm of f(t - s b) is squarefree, and this norm, over a field QQ(b)."""
        generator = integral_generator(self.field)
        for s in range(first, 100):
            norm = self.shifted(-s * generator)._norm()
            if norm.gcd(norm.derivative()).degree == 0:
                return s, norm
        raise InternalError("no shift makes the norm of a polynomial squarefree")

    def _norm(self) -> Polynomial:
        """Norm over QQ, the product of the conjugates, as a resultant with the modulus of the field (interpolation)."""
        size = self.degree * self.field.degree + 1
        points = [flint.fmpq(x) for x in range(size)]
        modulus = flint.fmpq_poly(self.field.modulus_coefficients())
        values = [modulus.resultant(flint.fmpq_poly(self.field.coordinates(self(x)))) for x in points]
        vandermonde = flint.fmpq_mat(size, size, [x**i if i else flint.fmpq(1) for x in points for i in range(size)])
        return Polynomial(QQ, vandermonde.solve(flint.fmpq_mat(size, 1, values)).entries())

    # -- roots -------------------------------------------------------------------------------------------
    def _signed_remainders(self, first: Polynomial, second: Polynomial) -> list[Polynomial]:
        chain = [first, second]
        while chain[-1].degree > 0:
            remainder = -(chain[-2] % chain[-1])
            if remainder.degree < 0:
                break
            size = abs(remainder.leading)
            chain.append(Polynomial(self.field, [c / size for c in remainder.coefficients]))
        return [p for p in chain if p.degree >= 0]

    def _variations(self, chain: list[Polynomial], at: Scalar | str) -> int:
        """Number of sign changes of a chain of polynomials at a number, or at +-infinity (at = '+' or '-')."""
        sign = self.field.sign
        if isinstance(at, str):
            return sign_changes([sign(p.leading) * (-1 if at == "-" and p.degree % 2 else 1) for p in chain])
        return sign_changes([sign(p(at)) for p in chain])

    def root_counter(self) -> RootCounter:
        """The function `count_real_roots`, with Sturm's chain computed only once.

        Examples
        --------
        >>> count = Polynomial(QQ, [-2, 0, 1]).root_counter()
        >>> count(0, 1), count(0, None)
        (0, 1)
        """
        chain = self._signed_remainders(self, self.derivative()) if self.degree > 0 else []

        def count(low: ScalarLike | None, high: ScalarLike | None) -> int:
            left = self._variations(chain, "-" if low is None else self.field.convert(low))
            return left - self._variations(chain, "+" if high is None else self.field.convert(high))

        return count

    def count_real_roots(self, low: ScalarLike | None = None, high: ScalarLike | None = None) -> int:
        """Number of distinct real roots in the interval (low, high] (unbounded where None); Sturm's theorem.

        The ends must not be multiple roots.
        """
        return self.root_counter()(low, high)

    def count_right_of(self, cut: ScalarLike) -> int:
        """Number of roots with real part above `cut`, with multiplicity.

        Raises
        ------
        FieldError
            If two roots of a squarefree part are symmetric about the line Re = cut (or lie on it): the method
            then does not give the count, and another cut is needed.
        """
        return sum(multiplicity * part.shifted(cut)._count_right() for part, multiplicity in self.squarefree_parts())

    def _count_right(self) -> int:
        """Number of roots in the open right half plane, by f(iy) = i^n (p(y) + i q(y))."""
        n, zero = self.degree, self.field.zero
        # i^(k-n) is real for even n - k; the Cauchy index of q / p is the number of roots right minus left.
        signed = [c * (1, -1, -1, 1)[(n - k) % 4] for k, c in enumerate(self.coefficients)]
        first, second = (
            Polynomial(self.field, [zero if (n - k) % 2 - odd else c for k, c in enumerate(signed)]) for odd in (0, 1)
        )
        if second.degree < 0 or first.gcd(second).degree > 0:
            raise FieldError("two roots are symmetric about the cut; move it")
        chain = self._signed_remainders(first, second)
        return (n + self._variations(chain, "-") - self._variations(chain, "+")) // 2
