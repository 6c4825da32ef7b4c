"""Complex numbers as pairs of real ones: which values are complex, and their parts in a real field.

The fields of liehom are real. A value is complex if it is a complex number of Python or numpy, a number of sympy that
is not real, or a string with the imaginary unit, written i or I: "1+2i", "i/2", "-i*sqrt(2)". A factor in front of the
unit needs no sign "*", except after "/" and "**", where "1/2i" could mean i/2 or -i/2.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Literal, final

import numpy as np

from liehom.errors import InputError, ParseError
from liehom.scalars.fields import grammar
from liehom.scalars.fields.field import Field, Scalar
from liehom.scalars.fields.floating import FloatField
from liehom.scalars.fields.number_field import NumberField
from liehom.scalars.fields.number_fields import common_field
from liehom.typing import Expression, ScalarLike

UNITS = ("i", "I")
_UNIT = re.compile(r"(?<![A-Za-z_])[iI](?![A-Za-z_0-9])")
_FACTOR = re.compile(r"((?:/|\*\*)[-+\s]*)?(?<![A-Za-z_0-9])([0-9]+)\s*(?=[iI](?![A-Za-z_0-9]))")


def is_complex(value: object, field: Field | None = None) -> bool:
    """Whether a value is written as a complex number, which may be real, as 1 + 0j is.

    Parameters
    ----------
    value : object
        A number in any form that a field reads; other objects are not complex.
    field : Field, optional
        A number field whose generator is called i or I reads this letter as its generator.

    Examples
    --------
    >>> [is_complex(x) for x in (1, "sqrt(2)", "pi", 1j, "1+2i", "-I/2", 0j)]
    [False, False, False, True, True, True, True]
    """
    if isinstance(value, str):
        return _UNIT.search(value) is not None and getattr(field, "symbol", None) not in UNITS
    if isinstance(value, (complex, np.complexfloating)):
        return True
    expression: Any = value
    if not hasattr(value, "as_real_imag") or expression.is_real or expression.is_finite is False:
        return False
    return expression.is_real is False or any(str(x) == "I" for x in expression.atoms())


def field_determining_values(value: ScalarLike) -> list[ScalarLike]:
    """Real values whose field contains the real and the imaginary part of a value.

    Examples
    --------
    >>> field_determining_values(1j), field_determining_values("2i*sqrt(3)"), field_determining_values("1/2")
    ([0.0, 1.0], ['2*1*sqrt(3)'], ['1/2'])
    """
    if not is_complex(value):
        return [value]
    if isinstance(value, str):
        return [_UNIT.sub("1", _with_products(value))]  # the same square roots
    return list(_number_parts(value))


def complex_parts(value: ScalarLike, field: Field) -> tuple[ScalarLike, ScalarLike]:
    """The real and the imaginary part of a value, in forms that the field reads.

    Parameters
    ----------
    value : number or str
        Real or complex.
    field : Field
        The field in which a string is evaluated.

    Raises
    ------
    ParseError
        If a string is not in the grammar of values with i and I.
    FieldError
        If a square root in a string is not in the field.
    InputError
        If a sympy expression has symbols that are not declared real.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> complex_parts("(1+2i)/(1-i)", QQ), complex_parts(2 - 1j, QQ), complex_parts("3", QQ)
    ((-1/2, 3/2), (2.0, -1.0), ('3', 0))
    """
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
            made = _evaluated(value, exact)
            return exact.to_float(made.real), exact.to_float(made.imaginary)
        made = _evaluated(value, field)
        return made.real, made.imaginary
    return _number_parts(value)


def _number_parts(value: Expression) -> tuple[ScalarLike, ScalarLike]:
    """The parts of a number of Python, numpy or sympy."""
    if isinstance(value, (complex, np.complexfloating)):
        return float(value.real), float(value.imag)
    real, imaginary = value.as_real_imag()
    return real, imaginary


def _with_products(text: str) -> str:
    """The string with a sign "*" between a factor and the imaginary unit; `ParseError` after "/" and "**"."""

    def product(found: re.Match[str]) -> str:
        before, factor = found.groups()
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
    made: _Complex = grammar.evaluate(tree, lambda n: _Complex(field.convert(n), field.zero), names, {"sqrt": root})
    return made


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
