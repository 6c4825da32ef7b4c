"""Real number fields QQ(a), their elements, and number fields from user input."""

from __future__ import annotations

import copyreg
import functools
import re
from collections.abc import Iterable, Sequence
from itertools import count
from math import gcd, prod
from typing import Any, TypeAlias, final

import flint

from liehom.base.budget import current_limits, within
from liehom.base.errors import FieldError, displayed, shown
from liehom.base.objects import Immutable, Typeset
from liehom.base.typing import Number, ScalarLike
from liehom.exact.scalars import grammar
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.polynomial import Polynomial, horner, linear_root
from liehom.exact.scalars.rational import (
    MAX_PRECISION,
    QQ,
    ExactNumber,
    RationalField,
    isolate_real_root,
    precisions,
    prime,
    rational_from_text,
    rational_number,
    real_root_balls,
    refused,
    working_precision,
)


def irreducible_polynomial(minpoly: Sequence[ScalarLike]) -> flint.fmpz_poly:
    """The primitive integer polynomial with these ascending rational coefficients, up to a factor."""
    within("minpoly_degree", len(minpoly) - 1, "the minimal polynomial has degree {}")
    polynomial = flint.fmpq_poly([QQ.convert(c) for c in minpoly])
    if polynomial.degree() < 2:
        raise FieldError("the minimal polynomial of a number field must have degree at least 2")
    integral = polynomial.numer()
    bits = int(integral.height_bits()) * polynomial.degree()
    within("coefficient_bits", bits, "the minimal polynomial has coefficients of {} bits together")
    integral = integral // integral.content() * (1 if integral[integral.degree()] > 0 else -1)
    factors = integral.factor()[1]
    if len(factors) != 1 or factors[0][1] != 1:
        product = shown(", ".join(str(f) for f, _ in factors))
        raise FieldError(f"the minimal polynomial {shown(str(integral))} is reducible: factors {product}; use one")
    return integral


def rational_ends(interval: object) -> tuple[flint.fmpq, flint.fmpq]:
    """The two rational ends of an interval; `FieldError` if it is not a pair of rational numbers."""
    if not isinstance(interval, (tuple, list)) or len(interval) != 2:
        raise FieldError(f"the interval is {displayed(interval)}, expected its two rational ends")
    return QQ.convert(interval[0]), QQ.convert(interval[1])


# A real number field is QQ(a) for one real root a of an irreducible integer polynomial f, in an isolating interval.
# Signs are those of this embedding, by ball arithmetic of growing precision. Elements are polynomials in the algebraic
# integer b = c a, where c is the leading coefficient of f, so all products stay integral.

_set = object.__setattr__
Ends: TypeAlias = tuple[ScalarLike, ScalarLike]
SYMBOL = re.compile(r"(?!sqrt$)[A-Za-z_][A-Za-z_0-9]*|sqrt\([0-9]+\)", re.ASCII)


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
        self.interval, self.root_index = isolate_real_root(integral, rational_ends(interval))
        self._check_symbol()
        self._powers: dict[int, list[int]] = {}
        self._balls: dict[int, flint.arb] = {}
        self._residues: list[tuple[int, int]] = []
        self._roots: tuple[list[str], ExactMatrix] | None = None

    def _check_symbol(self) -> None:
        """Raise `FieldError` unless `convert` reads the symbol as the generator."""
        if not isinstance(self.symbol, str) or not SYMBOL.fullmatch(self.symbol):
            raise FieldError(f"the symbol of a generator is {self.symbol!r}; expected an identifier such as 'a'")
        if self.symbol.startswith("sqrt(") and (
            self.minpoly != (-int(flint.fmpz(self.symbol[5:-1])), 0, 1) or self.root_index != 1
        ):
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
        return self.convert(grammar.evaluate(tree, lambda n: self._embedded(flint.fmpq(n)), names, {"sqrt": self.sqrt}))

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
        roots = {1: self.one}
        for d in self.radicals:
            root = self.sqrt(d)
            roots |= {d * e // gcd(d, e) ** 2: root * other / gcd(d, e) for e, other in roots.items()}
        basis = sorted(roots)  # from 1, which is not written
        rows = QQ.matrix([self.coordinates(roots[d]) for d in basis])
        return ["", *(f"sqrt({d})" for d in basis[1:])], rows.inverse()

    def sign(self, value: Scalar) -> int:
        polynomial = self.convert(value).polynomial
        if polynomial.is_zero():
            return 0
        for precision in precisions():
            with working_precision(precision):
                ball = self._value_ball(polynomial, precision)
                if not ball.contains(0):
                    return 1 if ball > 0 else -1
        raise FieldError(f"the sign of {value} could not be found with {MAX_PRECISION} bits")

    def _value_ball(self, polynomial: flint.fmpq_poly, precision: int) -> flint.arb:
        return horner([flint.arb(c) for c in polynomial.coeffs()], self.generator_ball(precision), flint.arb(0))

    def generator_ball(self, precision: int) -> flint.arb:
        """Ball (``flint.arb``) around b = c a, found with the given working precision in bits."""
        if precision not in self._balls:
            self._balls[precision] = real_root_balls(self._modulus, precision)[self.root_index]
        return self._balls[precision]

    def ball(self, value: Scalar, precision: int) -> flint.arb:
        """Ball (``flint.arb``) around an element, found with the given working precision in bits."""
        with working_precision(precision):
            return self._value_ball(self.convert(value).polynomial, precision)

    def to_float(self, value: Scalar) -> float:
        for precision in precisions(128, MAX_PRECISION - 1):
            ball = self.ball(value, precision)
            if ball.is_exact() or ball.rel_accuracy_bits() > 60:
                break
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
        if len(self._residues) <= attempt:
            known, modulus = {p for p, _ in self._residues}, self.modulus_coefficients()
            roots = ((p, linear_root(modulus, p)) for p in map(prime, count()) if p not in known)
            while len(self._residues) <= attempt:
                self._residues.append(next((p, root) for p, root in roots if root is not None))
        return self._residues[attempt]

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
    >>> from liehom.exact.scalars import NumberField
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

    def __add__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else AlgebraicNumber(self.field, self.polynomial + right)

    __radd__ = __add__

    def __sub__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else AlgebraicNumber(self.field, self.polynomial - right)

    def __rsub__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else AlgebraicNumber(self.field, right - self.polynomial)

    def __neg__(self) -> AlgebraicNumber:
        return AlgebraicNumber(self.field, -self.polynomial)

    def __mul__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        if right is None:
            return NotImplemented
        return AlgebraicNumber(self.field, (self.polynomial * right) % flint.fmpq_poly(self.field.modulus))

    __rmul__ = __mul__

    def inverse(self) -> AlgebraicNumber:
        """The inverse 1 / x; ``ZeroDivisionError`` for zero."""
        if self.polynomial.is_zero():
            raise ZeroDivisionError("division by zero in a number field")
        common, left, _ = self.polynomial.xgcd(flint.fmpq_poly(self.field.modulus))
        return AlgebraicNumber(self.field, left / common[0])

    def __truediv__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self * AlgebraicNumber(self.field, right).inverse()

    def __rtruediv__(self, other: ScalarLike) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self.inverse() * AlgebraicNumber(self.field, right)

    def __pow__(self, exponent: int) -> AlgebraicNumber:
        base = self if exponent >= 0 else self.inverse()
        result, exponent = self.field.one, abs(exponent)
        while exponent:
            if exponent & 1:
                result = result * base
            base, exponent = base * base, exponent >> 1
        return result

    def __bool__(self) -> bool:
        """False for 0, as for other numbers."""
        return bool(self.polynomial)

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


# Fields from user input: `number_field` constructs the field of one number ('sqrt(2)', a polynomial with an interval, a
# sympy expression), `common_field` one that contains all values of a list of strings.

TRIAL_PRIMES = 6542
"""Primes below 2^16, by which the number under a square root is divided."""
FACTORED_BITS = 128
"""A rest of more bits after these divisions is not factored."""


def number_field(
    generator: str | Sequence[ScalarLike] | Number,
    interval: tuple[ScalarLike, ScalarLike] | None = None,
    name: str = "a",
) -> RationalField | NumberField:
    """The real number field QQ(a).

    Parameters
    ----------
    generator : str, sympy expression, or sequence of coefficients
        The number a ('sqrt(2)', 'sqrt(2 + sqrt(2))', ``sympy.root(2, 3)``), or the ascending rational
        coefficients of its minimal polynomial.
    interval : pair, optional
        With a polynomial: rational ends of an interval that contains exactly one of its real roots.
    name : str
        Symbol of a generator that is not a plain square root.

    Returns
    -------
    RationalField or NumberField
        QQ if a is rational.

    Raises
    ------
    FieldError
        If the number is not real algebraic, or the polynomial and interval do not define a real number.
    ParseError
        If a string is not in the grammar of values.

    Examples
    --------
    >>> K = number_field("sqrt(2)")
    >>> K, K.convert("1/sqrt(2)")
    (QQ(sqrt(2)), 1/2*sqrt(2))
    >>> number_field([-1, -1, 0, 1], (1, 2), name="p").degree
    3
    """
    if isinstance(generator, str):
        return _field_of_tree(grammar.parse(generator), name)
    if isinstance(generator, Sequence):
        if interval is None:
            raise FieldError("a polynomial needs an interval that contains exactly one of its real roots")
        return NumberField(name, generator, interval)
    if hasattr(generator, "free_symbols"):
        return _field_of_sympy(generator, name)
    raise FieldError(
        f"{displayed(generator)} does not describe a number field; write 'sqrt(2)' or coefficients and an interval"
    )


def common_field(texts: Iterable[str]) -> RationalField | NumberField:
    """A field that contains all values: QQ, QQ(sqrt(d)), or a field with several radicals.

    Examples
    --------
    >>> common_field(["1/2", "sqrt(8)"])
    QQ(sqrt(2))
    """
    radicals: list[int] = []
    nested: list[grammar.Node] = []
    for text in texts:
        if "s" not in text:  # no sqrt: the common case, decided without parsing
            continue
        for argument in grammar.sqrt_arguments(grammar.parse(text)):
            if grammar.sqrt_arguments(argument):
                nested += [grammar.Call("sqrt", argument)] if grammar.Call("sqrt", argument) not in nested else []
                continue
            kernel = _kernel(grammar.evaluate(argument, flint.fmpq, {}, {}))
            if kernel != 1 and kernel not in radicals:
                radicals.append(kernel)
            _check_radicals((len(radicals) + len(nested) - 1) // 16)
    radicals = _independent(radicals)
    _check_radicals(len(radicals) + len(nested))
    if not nested and len(radicals) <= 1:
        return _quadratic(radicals[0]) if radicals else QQ
    terms: list[grammar.Node] = [grammar.Call("sqrt", grammar.Number(flint.fmpz(d))) for d in radicals]
    tree = terms[0] if terms else nested.pop(0)
    for weight, term in enumerate([*terms[1:], *nested], start=1):
        tree = grammar.Operation("+", (tree, grammar.Operation("*", (grammar.Number(flint.fmpz(weight)), term))))
    return _field_of_tree(tree, "a")


def exact_value(text: str) -> Scalar:
    """The real algebraic number that a string denotes, in the field that `common_field` finds.

    Examples
    --------
    >>> exact_value("(1 + sqrt(5))/2")
    1/2 + 1/2*sqrt(5)
    """
    return common_field([text]).convert(text)


def _check_radicals(count: int) -> None:
    within(
        "radicals",
        count,
        "the values have {} different square roots or more, and a field with all of them has a large degree: state a "
        "field by its minimal polynomial, or use fewer",
    )


def _kernel(value: flint.fmpq) -> int:
    """An integer d such that sqrt(value) is a rational multiple of sqrt(d), 1 if that is rational.

    It is squarefree if at most `FACTORED_BITS` bits are left after trial division. Of a larger rest only squares are
    recognized, so the field is the same, but its generator may be a multiple of the smallest square root.
    """
    if value < 0:
        raise FieldError(f"sqrt({shown(str(value))}) is not real")
    rest = flint.fmpz(value.p) * flint.fmpz(value.q)
    if rest == 0 or rest.is_square():
        return 1
    kernel = flint.fmpz(1)
    for factor, multiplicity in rest.factor(trial_limit=TRIAL_PRIMES):
        if multiplicity % 2:
            kernel *= _squarefree_rest(factor)
    return int(kernel)


def _squarefree_rest(factor: flint.fmpz) -> flint.fmpz:
    """The rest after trial division, prime or composite, without its squares if these are easy to find."""
    if factor.is_square():
        return flint.fmpz(1)
    if factor.bit_length() > FACTORED_BITS:
        return factor
    return prod((prime for prime, multiplicity in factor.factor() if multiplicity % 2), start=flint.fmpz(1))


def _independent(radicals: list[int]) -> list[int]:
    """Radicals that are independent modulo squares (over F_2), so that none is in the field of the others."""
    kept: list[int] = []
    products = {1}
    for d in radicals:
        if len(kept) <= current_limits().radicals and not any(flint.fmpz(d * e).is_square() for e in products):
            kept.append(d)
            products |= {d * e // gcd(d, e) ** 2 for e in products}
    return kept


def _quadratic(d: int) -> NumberField:
    number = flint.fmpz(d)  # prints any number of digits
    root = int(number.isqrt())
    return NumberField(f"sqrt({number})", [-d, 0, 1], (root, root + 1))


def _field_of_tree(tree: grammar.Node, name: str) -> RationalField | NumberField:
    match tree:
        case grammar.Call("sqrt", argument) if not grammar.sqrt_arguments(argument):
            kernel = _kernel(grammar.evaluate(argument, flint.fmpq, {}, {}))
            return QQ if kernel == 1 else _quadratic(kernel)
    import sympy

    roots = {str(argument) for argument in grammar.sqrt_arguments(tree)}
    within("minpoly_degree", 2 ** len(roots), "the square roots of a value give a field of degree up to {}")
    # Trees hold only integers, operators and sqrt, so building the expression executes nothing else.
    expression = grammar.evaluate(tree, lambda n: sympy.Integer(int(n)), {}, {"sqrt": sympy.sqrt})
    arguments = grammar.sqrt_arguments(tree)
    nested = any(map(grammar.sqrt_arguments, arguments))
    kernels = [] if nested else [_kernel(grammar.evaluate(argument, flint.fmpq, {}, {})) for argument in arguments]
    return _field_of_sympy(expression, name, _independent([d for d in kernels if d != 1]))


def _field_of_sympy(expression: Any, name: str, radicals: Sequence[int] = ()) -> RationalField | NumberField:
    import sympy

    if expression.free_symbols or expression.is_real is False:
        raise FieldError(f"{expression} is not a real number")
    try:
        polynomial = sympy.minimal_polynomial(expression, polys=True)
    except (NotImplementedError, sympy.polys.polyerrors.BasePolynomialError) as error:
        raise FieldError(f"{expression} is not recognized as an algebraic number: {error}") from None
    coefficients = [flint.fmpq(int(c.p), int(c.q)) for c in reversed(polynomial.all_coeffs())]
    if len(coefficients) == 2:
        return QQ
    integral = flint.fmpq_poly(coefficients).numer()
    for digits in (30, 60, 120, 240, 480):
        value = sympy.re(sympy.N(expression, digits))
        near = flint.fmpq(flint.fmpz(int(value * 10**digits)), flint.fmpz(10) ** digits)
        margin = flint.fmpq(1, flint.fmpz(10) ** (digits // 2))
        balls = real_root_balls(integral, 8 * digits)
        with working_precision(8 * digits):
            low, high = flint.arb(near - margin), flint.arb(near + margin)
            inside = [b for b in balls if b > low and b < high]
        if len(inside) == 1:
            return NumberField(name, coefficients, (near - margin, near + margin), radicals)
    raise FieldError(f"{expression} could not be distinguished from its conjugates; give a polynomial and an interval")


# the cached enclosures are left out: balls cannot be pickled, and are computed again
copyreg.pickle(NumberField, lambda k: (NumberField, (k.symbol, k.minpoly, k.interval, k.radicals)))
