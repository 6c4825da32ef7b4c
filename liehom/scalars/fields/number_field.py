"""Real number fields QQ(a) and their elements, on python-flint.

A real number field is QQ(a) for one real root a of an irreducible integer polynomial f, given by an isolating
interval. Signs are those of this embedding, found by ball arithmetic of growing precision. Elements are polynomials in
the algebraic integer b = c a, where c is the leading coefficient of f, so all products stay integral.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from math import gcd
from typing import Any, TypeAlias, final

import flint

from liehom.display import Typeset
from liehom.errors import FieldError
from liehom.immutable import Immutable
from liehom.scalars.fields import grammar
from liehom.scalars.fields.balls import isolate_real_root, root_ball, working_precision
from liehom.scalars.fields.exact_field import ExactField, ExactMatrix
from liehom.scalars.fields.field import Scalar
from liehom.scalars.fields.minimal_polynomial import irreducible_polynomial, rational_ends
from liehom.scalars.fields.polynomial import Polynomial
from liehom.scalars.fields.rational import QQ, ExactNumber, prime, rational_from_text, rational_number, refused
from liehom.typing import ScalarLike

MAX_PRECISION = 1 << 22
_set = object.__setattr__
Ends: TypeAlias = tuple[ScalarLike, ScalarLike]
_SYMBOL = re.compile(r"(?!sqrt$)[A-Za-z_][A-Za-z_0-9]*|sqrt\([0-9]+\)", re.ASCII)


@final
class NumberField(ExactField, Immutable):
    """A real number field QQ(a), a the root of an irreducible polynomial in an isolating interval.

    Parameters
    ----------
    symbol : str
        How the generator is written: an identifier such as 'a', or 'sqrt(2)' for the positive root of t^2 - 2.
    minpoly : sequence
        Rational coefficients of an irreducible polynomial of degree at least 2, ascending.
    interval : pair
        Rational ends of an interval that contains exactly one of its real roots.
    radicals : sequence of int, optional
        Squarefree integers whose square roots generate the field, independent modulo squares: elements are printed in
        products of these roots. `format` writes powers of a.

    Raises
    ------
    FieldError
        If the polynomial is reducible or constant, the interval does not isolate one root, or the symbol would
        be read as another number than the generator.

    Examples
    --------
    >>> K = NumberField("a", [-2, 0, 1], (1, 2))
    >>> a = K.generator
    >>> a * a, K.sign(a - 1), K.format((a + 1) / 2)
    (2, 1, '1/2 + 1/2*a')
    """

    interval: tuple[flint.fmpq, flint.fmpq]
    root_index: int

    __slots__ = (
        "_balls",
        "_modulus",
        "_powers",
        "_residues",
        "_roots",
        "interval",
        "leading",
        "minpoly",
        "radicals",
        "root_index",
        "symbol",
    )

    def __init__(
        self, symbol: str, minpoly: Sequence[ScalarLike], interval: Ends, radicals: Sequence[int] = ()
    ) -> None:
        integral = irreducible_polynomial(minpoly)
        self.symbol: str = symbol
        self.minpoly: tuple[int, ...] = tuple(int(c) for c in integral.coeffs())
        self.leading: int = self.minpoly[-1]
        m = self.degree
        self.radicals: tuple[int, ...] = tuple(radicals) if 2 ** len(radicals) == m > 2 else ()
        monic = [c * self.leading ** (m - 1 - i) for i, c in enumerate(self.minpoly[:-1])]
        self._modulus = flint.fmpz_poly([*monic, 1])
        ends = rational_ends(interval)
        self.interval, self.root_index = isolate_real_root(integral, ends)
        self._check_symbol()
        self._powers: dict[int, list[int]] = {}
        self._balls: dict[int, flint.arb] = {}
        self._residues: list[tuple[int, int]] = []
        self._roots: tuple[list[str], ExactMatrix] | None = None

    def _check_symbol(self) -> None:
        """Raise `FieldError` unless `convert` reads the symbol as the generator."""
        if not isinstance(self.symbol, str) or not _SYMBOL.fullmatch(self.symbol):
            raise FieldError(f"the symbol of a generator is {self.symbol!r}; expected an identifier such as 'a'")
        if not self.symbol.startswith("sqrt("):
            return
        if self.minpoly != (-int(flint.fmpz(self.symbol[5:-1])), 0, 1) or self.root_index != 1:
            raise FieldError(f"the generator is not {self.symbol}, which is positive; give it another name")

    @property
    def name(self) -> str:
        return f"QQ({self.symbol})"

    @property
    def degree(self) -> int:
        return len(self.minpoly) - 1

    @property
    def zero(self) -> AlgebraicNumber:
        return AlgebraicNumber(self, flint.fmpq_poly([0]))

    @property
    def one(self) -> AlgebraicNumber:
        return AlgebraicNumber(self, flint.fmpq_poly([1]))

    @property
    def generator(self) -> AlgebraicNumber:
        """The generator a, an element of the field."""
        return AlgebraicNumber(self, flint.fmpq_poly([0, flint.fmpq(1, self.leading)]))

    @property
    def modulus(self) -> flint.fmpz_poly:
        """Monic minimal polynomial of b = c a, a ``flint.fmpz_poly``."""
        return self._modulus

    def convert(self, value: ScalarLike) -> AlgebraicNumber:
        if isinstance(value, AlgebraicNumber):
            if value.field is self or value.field == self:
                return value
            if (rational := value.rational()) is not None:
                return self._embedded(rational)
            raise FieldError(f"{value} of {value.field.name} is not in {self.name}")
        if isinstance(value, str):
            rational = rational_from_text(value)
            return self._evaluate(value) if rational is None else self._embedded(rational)
        rational = rational_number(value)
        if rational is not None:
            return self._embedded(rational)
        if getattr(value, "is_real", False) and hasattr(value, "free_symbols"):  # a sympy expression
            return self._from_sympy(value)
        raise refused(value, self)

    def _embedded(self, rational: flint.fmpq) -> AlgebraicNumber:
        return AlgebraicNumber(self, flint.fmpq_poly([rational]))

    def _evaluate(self, text: str) -> AlgebraicNumber:
        names = {self.symbol: self.generator} if self.symbol.isidentifier() else {}
        tree = grammar.parse(text, names)
        made = grammar.evaluate(tree, lambda n: self._embedded(flint.fmpq(n)), names, {"sqrt": self.sqrt})
        return self.convert(made)

    def _from_sympy(self, expression: Any) -> AlgebraicNumber:
        """The element equal to a sympy number made of rationals, sums, products and rational powers."""
        rational = rational_number(expression)
        if rational is not None:
            return self._embedded(rational)
        parts = expression.args
        if expression.is_Add:
            return sum((self._from_sympy(x) for x in parts), self.zero)
        if expression.is_Mul:
            return functools.reduce(lambda a, b: a * b, (self._from_sympy(x) for x in parts))
        if expression.is_Pow and expression.exp.is_Rational:
            exponent = expression.exp
            return self.root(self._from_sympy(expression.base), int(exponent.q)) ** int(exponent.p)
        raise refused(expression, self)

    def sqrt(self, value: ScalarLike) -> AlgebraicNumber:
        """The non-negative square root; `FieldError` if it is not in the field."""
        return self.root(self.convert(value), 2)

    def root(self, value: AlgebraicNumber, k: int) -> AlgebraicNumber:
        """The non-negative k-th root of a non-negative element; `FieldError` if it is not in the field."""
        what = f"sqrt({value})" if k == 2 else f"the root of order {k} of {value}"
        if self.sign(value) < 0:
            raise FieldError(f"{what} is not real" if k % 2 == 0 else f"{what}: write minus the root of {-value}")
        if value == 0 or k == 1:
            return value
        for factor, _ in Polynomial(self, [-value, *[self.zero] * (k - 1), self.one]).factor():
            if factor.degree == 1:
                root = self.convert(-factor.coefficients[0] / factor.coefficients[1])
                if self.sign(root) > 0 or k % 2 == 0:
                    return root if self.sign(root) > 0 else -root
        raise FieldError(f"{what} is not in {self.name}")

    def format(self, value: Scalar) -> str:
        powers = ["", self.symbol, *(f"{self.symbol}**{power}" for power in range(2, self.degree))]
        return _sum(powers, [c * self.leading**power for power, c in enumerate(self.coordinates(value))])

    def show(self, value: Scalar) -> str:
        if not self.radicals or self.convert(value).rational() is not None:
            return self.format(value)
        if self._roots is None:
            self._roots = self._root_basis()
        return _sum(self._roots[0], (QQ.matrix([self.coordinates(value)]) @ self._roots[1]).row(0))

    def _root_basis(self) -> tuple[list[str], ExactMatrix]:
        """The names of a basis of square roots of integers, and the matrix from `coordinates` to coordinates in it."""
        found = {1: self.one}
        for d in self.radicals:
            root = self.sqrt(d)
            for e, other in list(found.items()):
                common = gcd(d, e)
                found[d * e // common**2] = root * other / common
        basis = sorted(found)  # from 1, which is not written
        rows = QQ.matrix([self.coordinates(found[d]) for d in basis])
        return ["", *(f"sqrt({d})" for d in basis[1:])], rows.inverse()

    def sign(self, value: Scalar) -> int:
        polynomial = self.convert(value).polynomial
        if polynomial.is_zero():
            return 0
        precision = 64
        while precision <= MAX_PRECISION:
            with working_precision(precision):
                ball = self._value_ball(polynomial, precision)
                if not ball.contains(0):
                    return 1 if ball > 0 else -1
            precision *= 2
        raise FieldError(f"the sign of {value} could not be found with {MAX_PRECISION} bits")

    def _value_ball(self, polynomial: flint.fmpq_poly, precision: int) -> flint.arb:
        root = self.generator_ball(precision)
        total = flint.arb(0)
        for c in reversed(polynomial.coeffs()):
            total = total * root + flint.arb(c)
        return total

    def generator_ball(self, precision: int) -> flint.arb:
        """Ball (``flint.arb``) around b = c a, found with the given working precision in bits."""
        if precision not in self._balls:
            self._balls[precision] = root_ball(self._modulus, self.root_index, precision)
        return self._balls[precision]

    def ball(self, value: Scalar, precision: int) -> flint.arb:
        """Ball (``flint.arb``) around an element, found with the given working precision in bits."""
        with working_precision(precision):
            return self._value_ball(self.convert(value).polynomial, precision)

    def to_float(self, value: Scalar) -> float:
        precision = 128
        while precision < MAX_PRECISION:
            ball = self.ball(value, precision)
            if ball.is_exact() or ball.rel_accuracy_bits() > 60:
                break
            precision *= 2
        return float(ball)

    def coordinates(self, value: Scalar) -> list[flint.fmpq]:
        return self.convert(value).coordinates

    def from_coordinates(self, coordinates: Sequence[flint.fmpq]) -> AlgebraicNumber:
        return AlgebraicNumber(self, flint.fmpq_poly(list(coordinates)))

    def power_coordinates(self, exponent: int) -> list[int]:
        if exponent not in self._powers:
            power = flint.fmpz_poly([0] * exponent + [1]) % self._modulus
            self._powers[exponent] = [int(power[i]) for i in range(self.degree)]
        return self._powers[exponent]

    def modulus_coefficients(self) -> list[int]:
        return [int(c) for c in self._modulus.coeffs()]

    def residue(self, attempt: int = 0) -> tuple[int, int]:
        index = -1
        while len(self._residues) <= attempt:
            index = self._residues_tried(index)
        return self._residues[attempt]

    def _residues_tried(self, index: int) -> int:
        """Store the next prime modulo which the modulus has a linear factor; return the number of that prime."""
        start = [p for p, _ in self._residues]
        while True:
            index += 1
            p = prime(index)
            if p in start:
                continue
            image = flint.nmod_poly([int(c) % p for c in self._modulus.coeffs()], p)
            linear = [f for f, _ in image.factor()[1] if f.degree() == 1]
            if linear:
                root = (-int(linear[0][0]) * pow(int(linear[0][1]), -1, p)) % p
                self._residues.append((p, root))
                return index

    def __eq__(self, other: object) -> bool:
        return isinstance(other, NumberField) and self.minpoly == other.minpoly and self.root_index == other.root_index

    def __hash__(self) -> int:
        return hash((self.minpoly, self.root_index))


@final
class AlgebraicNumber(ExactNumber, Typeset, Immutable):
    """An element of a real number field, constructed by arithmetic or ``field.convert``.

    Comparisons are those of the real embedding of the field.

    Examples
    --------
    >>> from liehom.scalars import NumberField
    >>> K = NumberField("a", [-2, 0, 1], (1, 2))
    >>> K.generator > "7/5", 1 / K.generator
    (True, 1/2*a)
    """

    __slots__ = ("field", "polynomial")
    field: NumberField
    polynomial: flint.fmpq_poly

    def __init__(self, field: NumberField, polynomial: flint.fmpq_poly) -> None:
        _set(self, "field", field)  # object's own method: numbers are made in inner loops
        _set(self, "polynomial", polynomial)

    @property
    def coordinates(self) -> list[flint.fmpq]:
        """List of rational coordinates (``flint.fmpq``) in powers of the integral generator."""
        return [self.polynomial[i] for i in range(self.field.degree)]

    def rational(self) -> flint.fmpq | None:
        return self.polynomial[0] if self.polynomial.degree() < 1 else None

    def bit_length(self) -> int:
        """Bits of the largest integer among the numerators of the coordinates and their common denominator."""
        return max(int(self.polynomial.numer().height_bits()), int(self.polynomial.denom().bit_length()))

    def is_rational(self) -> bool:
        """Whether the number is rational."""
        return self.rational() is not None

    def _operand(self, other: Any) -> flint.fmpq_poly | None:
        if isinstance(other, AlgebraicNumber) and other.field is self.field:
            return other.polynomial
        try:
            return self.field.convert(other).polynomial
        except FieldError:
            if not isinstance(other, AlgebraicNumber):
                return None
        raise FieldError(
            f"{self} is in {self.field.name}, {other} in {other.field.name}; convert both to one field, such as "
            "liehom.scalars.common_field(['sqrt(2)', 'sqrt(3)'])"
        )

    def _made(self, polynomial: flint.fmpq_poly) -> AlgebraicNumber:
        return AlgebraicNumber(self.field, polynomial)

    def __add__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self._made(self.polynomial + right)

    __radd__ = __add__

    def __sub__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self._made(self.polynomial - right)

    def __rsub__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self._made(right - self.polynomial)

    def __neg__(self) -> AlgebraicNumber:
        return self._made(-self.polynomial)

    def __mul__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        if right is None:
            return NotImplemented
        return self._made((self.polynomial * right) % flint.fmpq_poly(self.field.modulus))

    __rmul__ = __mul__

    def inverse(self) -> AlgebraicNumber:
        """The inverse 1 / x; ``ZeroDivisionError`` for zero."""
        if self.polynomial.is_zero():
            raise ZeroDivisionError("division by zero in a number field")
        common, left, _ = self.polynomial.xgcd(flint.fmpq_poly(self.field.modulus))
        return self._made(left / common[0])

    def __truediv__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self * self._made(right).inverse()

    def __rtruediv__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self.inverse() * self._made(right)

    def __pow__(self, exponent: int) -> AlgebraicNumber:
        base = self if exponent >= 0 else self.inverse()
        result, exponent = self.field.one, abs(exponent)
        while exponent:
            if exponent & 1:
                result = result * base
            base, exponent = base * base, exponent >> 1
        return result

    def __eq__(self, other: object) -> bool:
        try:
            right = None if isinstance(other, str) else self._operand(other)  # a string hashes otherwise
        except FieldError:
            return False
        return NotImplemented if right is None else bool(self.polynomial == right)

    def __abs__(self) -> AlgebraicNumber:
        return self if self.field.sign(self) >= 0 else -self

    def __hash__(self) -> int:
        rational = self.rational()  # equal to a rational number, so hash like it
        return hash(tuple(self.coordinates) if rational is None else rational)

    def __lt__(self, other: ScalarLike) -> bool:
        return self.field.sign(self - other) < 0

    def __le__(self, other: ScalarLike) -> bool:
        return self.field.sign(self - other) <= 0

    def __gt__(self, other: ScalarLike) -> bool:
        return self.field.sign(self - other) > 0

    def __ge__(self, other: ScalarLike) -> bool:
        return self.field.sign(self - other) >= 0

    def __float__(self) -> float:
        return self.field.to_float(self)

    def __repr__(self) -> str:
        return self.field.show(self)


def _sum(monomials: Sequence[str], coefficients: Sequence[Any]) -> str:
    """A linear combination as a string; the monomial 1 is the empty string."""
    terms = []
    for monomial, c in zip(monomials, coefficients, strict=True):
        if monomial and c in (1, -1):
            terms.append(monomial if c == 1 else f"-{monomial}")
        elif c != 0:
            terms.append(f"{c}*{monomial}" if monomial else str(c))
    return " + ".join(terms).replace("+ -", "- ") or "0"
