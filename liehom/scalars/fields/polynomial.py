"""Polynomials in one variable over QQ or a real number field, with exact root counts and factorization.

Real roots are counted by Sturm sequences, roots with real part above a cut by the Cauchy index of f(c + i y)
(Routh-Hurwitz). Over QQ, flint factors. Over QQ(a), Trager's method shifts the polynomial until its norm is
squarefree, factors the norm over QQ and takes greatest common divisors.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import TypeAlias, final

import flint

from liehom.errors import FieldError, InternalError
from liehom.immutable import Immutable
from liehom.scalars.fields.exact_field import ExactField
from liehom.scalars.fields.field import Scalar
from liehom.scalars.fields.rational import QQ
from liehom.typing import ScalarLike

RootCounter: TypeAlias = Callable[[ScalarLike | None, ScalarLike | None], int]
"""The number of roots in an interval (low, high], unbounded where an end is None."""


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
        total = self.field.zero
        for c in reversed(self.coefficients):
            total = total * value + c
        return total

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

    def _made(self, coefficients: Sequence[ScalarLike]) -> Polynomial:
        return Polynomial(self.field, coefficients)

    def __add__(self, other: Polynomial) -> Polynomial:
        n = max(len(self.coefficients), len(other.coefficients))
        zero = self.field.zero
        left = [*self.coefficients, *[zero] * (n - len(self.coefficients))]
        right = [*other.coefficients, *[zero] * (n - len(other.coefficients))]
        return self._made([a + b for a, b in zip(left, right, strict=True)])

    def __neg__(self) -> Polynomial:
        return self._made([-c for c in self.coefficients])

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + (-other)

    def __mul__(self, other: Polynomial) -> Polynomial:
        if self.field.degree == 1:
            return self._made((self._flint() * other._flint()).coeffs())
        out = [self.field.zero] * max(0, len(self.coefficients) + len(other.coefficients) - 1)
        for i, a in enumerate(self.coefficients):
            for j, b in enumerate(other.coefficients):
                out[i + j] = out[i + j] + a * b
        return self._made(out)

    def divided(self, other: Polynomial) -> tuple[Polynomial, Polynomial]:
        """Quotient and remainder; ``ZeroDivisionError`` if the divisor is zero."""
        if other.degree < 0:
            raise ZeroDivisionError("division by the zero polynomial")
        if self.field.degree == 1:
            whole, remainder = divmod(self._flint(), other._flint())
            return self._made(whole.coeffs()), self._made(remainder.coeffs())
        rest, inverse = list(self.coefficients), 1 / other.leading
        quotient = [self.field.zero] * max(0, len(rest) - other.degree)
        for i in range(len(rest) - 1 - other.degree, -1, -1):
            factor = rest[i + other.degree] * inverse
            quotient[i] = factor
            for j, c in enumerate(other.coefficients):
                rest[i + j] = rest[i + j] - factor * c
        return self._made(quotient), self._made(rest[: other.degree])

    def __mod__(self, other: Polynomial) -> Polynomial:
        return self.divided(other)[1]

    def __floordiv__(self, other: Polynomial) -> Polynomial:
        return self.divided(other)[0]

    def monic(self) -> Polynomial:
        """The polynomial divided by its leading coefficient."""
        return self._made([c / self.leading for c in self.coefficients])

    def derivative(self) -> Polynomial:
        """The derivative."""
        return self._made([c * i for i, c in enumerate(self.coefficients)][1:])

    def shifted(self, by: ScalarLike) -> Polynomial:
        """The polynomial f(t + by)."""
        values, by = list(self.coefficients), self.field.convert(by)
        for start in range(len(values) - 1):
            for i in range(len(values) - 2, start - 1, -1):
                values[i] = values[i] + by * values[i + 1]
        return self._made(values)

    def gcd(self, other: Polynomial) -> Polynomial:
        """The monic greatest common divisor."""
        if self.field.degree == 1:
            return self._made(self._flint().gcd(other._flint()).coeffs())
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
            found = [(self._made(f.coeffs()).monic(), m) for f, m in self._flint().numer().factor()[1]]
        else:
            found = [(f, m) for part, m in self.squarefree_parts() for f in part._factor_squarefree()]
        return sorted(found, key=lambda pair: pair[0].degree)

    def _factor_squarefree(self) -> list[Polynomial]:
        if self.degree <= 1:
            return [self.monic()]
        generator = self.field.from_coordinates([flint.fmpq(int(i == 1)) for i in range(self.field.degree)])
        for s in range(100):
            shifted = self.shifted(-s * generator)
            norm = shifted._norm()
            if norm.gcd(norm.derivative()).degree == 0:
                break
        else:
            raise InternalError("no shift makes the norm of a polynomial squarefree")
        factors, rest = [], self.monic()
        for f, _ in norm.factor():
            lifted = Polynomial(self.field, f.coefficients).shifted(s * generator)
            common = rest.gcd(lifted)
            if common.degree > 0:
                factors.append(common)
                rest = rest // common
        return factors

    def _norm(self) -> Polynomial:
        """Norm over QQ, the product of the conjugates, as a resultant with the modulus of the field (interpolation)."""
        if self.field.degree == 1:
            return self
        size = self.degree * self.field.degree + 1
        points = [flint.fmpq(x) for x in range(size)]
        modulus = flint.fmpq_poly(self.field.modulus_coefficients())
        values = [modulus.resultant(flint.fmpq_poly(self.field.coordinates(self(x)))) for x in points]
        vandermonde = flint.fmpq_mat(size, size, [x**i if i else flint.fmpq(1) for x in points for i in range(size)])
        solution = vandermonde.solve(flint.fmpq_mat(size, 1, values))
        return Polynomial(QQ, solution.entries())

    # -- roots -------------------------------------------------------------------------------------------
    def _signed_remainders(self, first: Polynomial, second: Polynomial) -> list[Polynomial]:
        chain = [first, second]
        while chain[-1].degree > 0:
            remainder = -(chain[-2] % chain[-1])
            if remainder.degree < 0:
                break
            chain.append(remainder._positively_scaled())
        return [p for p in chain if p.degree >= 0]

    def _positively_scaled(self) -> Polynomial:
        size = self.leading if self.field.sign(self.leading) > 0 else -self.leading
        return self._made([c / size for c in self.coefficients])

    def _variations(self, chain: list[Polynomial], at: Scalar | str) -> int:
        """Number of sign changes of a chain of polynomials at a number, or at +-infinity (at = '+' or '-')."""
        signs = []
        for p in chain:
            if isinstance(at, str):
                sign = self.field.sign(p.leading) * (-1 if at == "-" and p.degree % 2 else 1)
            else:
                sign = self.field.sign(p(at))
            if sign:
                signs.append(sign)
        return sum(1 for a, b in itertools.pairwise(signs) if a != b)

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
        total = 0
        for part, multiplicity in self.squarefree_parts():
            total += multiplicity * part.shifted(cut)._count_right()
        return total

    def _count_right(self) -> int:
        """Number of roots in the open right half plane, by f(iy) = i^n (p(y) + i q(y))."""
        n, signs = self.degree, (1, -1, -1, 1)
        main = [self.field.zero] * (n + 1)
        side = [self.field.zero] * (n + 1)
        for k, c in enumerate(self.coefficients):
            # i^(k-n) is real for even n - k; the Cauchy index of q / p is the number of roots right minus left.
            gap = n - k
            (main if gap % 2 == 0 else side)[k] = c * signs[gap % 4]
        first, second = self._made(main), self._made(side)
        if second.degree < 0 or first.gcd(second).degree > 0:
            raise FieldError("two roots are symmetric about the cut; move it")
        chain = self._signed_remainders(first, second)
        right_minus_left = self._variations(chain, "-") - self._variations(chain, "+")
        return (n + right_minus_left) // 2
