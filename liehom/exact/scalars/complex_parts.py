"""Complex numbers as pairs of real ones, and numbers of a field as sympy numbers.

The fields of liehom are real. A value is complex if it is a complex number of Python or numpy, a number of sympy that
is not real, or a string with the imaginary unit, written i or I: "1+2i", "i/2", "-i*sqrt(2)". A factor in front of the
unit needs no sign "*", except after "/" and "**", where "1/2i" could mean i/2 or -i/2.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Literal, final

import numpy as np

from liehom.base.errors import InputError, ParseError
from liehom.base.typing import Expression, ScalarLike
from liehom.exact.scalars import grammar
from liehom.exact.scalars.field import Field, Scalar
from liehom.exact.scalars.floating import FloatField
from liehom.exact.scalars.number_fields import NumberField, common_field
from liehom.exact.scalars.rational import QQ

UNITS = ("i", "I")
_UNIT = re.compile(r"(?<![A-Za-z_])[iI](?![A-Za-z_0-9])")
_FACTOR = re.compile(r"((?:/|\*\*)[-+\s]*)?(?<![A-Za-z_0-9])([0-9]+)\s*(?=[iI](?![A-Za-z_0-9]))")


def is_complex(value: object, field: Field | None = None) -> bool:
    """Whether a value is written as a complex number, which may be real, as 1 + 0j is."""
    if isinstance(value, str):
        return _UNIT.search(value) is not None and getattr(field, "symbol", None) not in UNITS
    if isinstance(value, (complex, np.complexfloating)):
        return True
    expression: Any = value
    if not hasattr(value, "as_real_imag") or expression.is_real or expression.is_finite is False:
        return False
    return expression.is_real is False or any(str(x) == "I" for x in expression.atoms())


def field_determining_values(value: ScalarLike) -> list[ScalarLike]:
    """Real values whose field contains the real and the imaginary part of a value."""
    if not is_complex(value):
        return [value]
    if isinstance(value, str):
        return [_UNIT.sub("1", _with_products(value))]  # the same square roots
    return list(_number_parts(value))


def complex_parts(value: ScalarLike, field: Field) -> tuple[ScalarLike, ScalarLike]:
    """The real and the imaginary part of a value, in forms that the field reads."""
    symbols = sorted(str(s) for s in getattr(value, "free_symbols", ()) if not s.is_real)
    if symbols:
        raise InputError(
            f"{value} has the symbols {', '.join(symbols)}: declare them real, sympy.Symbol({symbols[0]!r}, real=True)"
        )
    if not is_complex(value, field) and not getattr(value, "free_symbols", ()):
        return value, 0
    if isinstance(value, str):
        if isinstance(field, FloatField):
            exact = common_field(map(str, field_determining_values(value)))
            number = _evaluated(value, exact)
            return exact.to_float(number.real), exact.to_float(number.imaginary)
        number = _evaluated(value, field)
        return number.real, number.imaginary
    return _number_parts(value)


def _number_parts(value: Expression) -> tuple[ScalarLike, ScalarLike]:
    """The parts of a number of Python, numpy or sympy."""
    if isinstance(value, (complex, np.complexfloating)):
        return float(value.real), float(value.imag)
    return value.as_real_imag()


def _with_products(text: str) -> str:
    """The string with a sign "*" between a factor and the imaginary unit; `ParseError` after "/" and "**"."""

    def product(match: re.Match[str]) -> str:
        before, factor = match.groups()
        if before:
            raise ParseError(
                f"{text!r} is not a value: {before}{factor}i has two meanings; write ({factor}*i), or put the "
                "fraction or power in parentheses"
            )
        return f"{factor}*"

    return _FACTOR.sub(product, text)


def _evaluated(text: str, field: Field) -> _Complex:
    names = {unit: _Complex(field.zero, field.one) for unit in UNITS}
    if isinstance(field, NumberField) and field.symbol.isidentifier():
        names[field.symbol] = _Complex(field.generator, field.zero)

    def root(value: _Complex) -> _Complex:
        if value.imaginary != 0:
            raise ParseError(f"{text!r} has the square root of a number that is not real: write its two parts")
        return _Complex(field.sqrt(value.real), field.zero)

    tree = grammar.parse(_with_products(text), names)
    return grammar.evaluate(tree, lambda n: _Complex(field.convert(n), field.zero), names, {"sqrt": root})


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Complex:
    """A complex number with its parts in a real field, with the arithmetic that the grammar needs."""

    real: Any
    imaginary: Any

    def __eq__(self, other: object) -> bool:
        return bool(self.real == other and self.imaginary == 0)

    __hash__ = None  # type: ignore[assignment]

    def bit_length(self) -> int:
        parts = (self.real, self.imaginary)
        return max(int(v.bit_length()) for x in parts for v in ((x.p, x.q) if hasattr(x, "p") else (x,)))

    def __neg__(self) -> _Complex:
        return _Complex(-self.real, -self.imaginary)

    def __add__(self, other: _Complex) -> _Complex:
        return _Complex(self.real + other.real, self.imaginary + other.imaginary)

    def __sub__(self, other: _Complex) -> _Complex:
        return _Complex(self.real - other.real, self.imaginary - other.imaginary)

    def __mul__(self, other: _Complex) -> _Complex:
        return _Complex(
            self.real * other.real - self.imaginary * other.imaginary,
            self.real * other.imaginary + self.imaginary * other.real,
        )

    def __truediv__(self, other: _Complex) -> _Complex:
        square: Scalar = other.real * other.real + other.imaginary * other.imaginary
        if square == 0:
            raise ZeroDivisionError
        product = self * _Complex(other.real, -other.imaginary)
        return _Complex(product.real / square, product.imaginary / square)

    def __rtruediv__(self, one: int) -> _Complex:
        return _Complex(one + 0 * self.real, 0 * self.real) / self

    def __pow__(self, exponent: Literal[0]) -> _Complex:
        return _Complex(0 * self.real + 1, 0 * self.real)


def sympy_number(field: Field, value: Scalar) -> Expression:
    """The sympy number equal to an element of a field, in square roots, or in ``CRootOf`` of another generator."""
    import sympy

    if isinstance(field, FloatField):
        return sympy.Float(value)
    if not isinstance(field, NumberField):
        rational: Any = value
        return sympy.Rational(int(rational.p), int(rational.q))
    if field.symbol.startswith("sqrt("):
        root = sympy.sqrt(int(field.symbol[5:-1]))
    else:
        t = sympy.Symbol("t")
        # Real roots come first and in order, in sympy too.
        root = sympy.CRootOf(sympy.Add(*(c * t**p for p, c in enumerate(field.minpoly))), field.root_index)
    terms = (sympy_number(QQ, c) * (field.leading * root) ** p for p, c in enumerate(field.coordinates(value)))
    return sympy.Add(*terms)
