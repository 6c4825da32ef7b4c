"""QQ, conversions to it, and rigorous enclosures of real numbers."""

from __future__ import annotations

import copyreg
import functools
import numbers
import re
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from fractions import Fraction
from typing import Any, final

import flint
import numpy as np

from liehom.base.budget import within
from liehom.base.errors import FieldError, displayed, shown
from liehom.base.typing import ScalarLike
from liehom.exact.scalars import grammar
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.field import Field, Scalar

# A ball [m +- r] contains the number that it represents, so a comparison of disjoint balls is a proof. If balls
# overlap, the precision is doubled.

MAX_PRECISION = 1 << 22


def precisions(first: int = 64, last: int = MAX_PRECISION) -> Iterator[int]:
    """Working precisions (bits) from the first one on, each twice the one before, up to the last."""
    while first <= last:
        yield first
        first *= 2


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Context manager that sets flint's working precision (bits) for the block and restores it."""
    before = flint.ctx.prec
    flint.ctx.prec = bits
    try:
        yield
    finally:
        flint.ctx.prec = before


def real_root_balls(polynomial: flint.fmpz_poly, precision: int) -> list[flint.arb]:
    """Disjoint balls around the real roots of a squarefree integer polynomial, in increasing order."""
    with working_precision(precision):
        pairs: Any = polynomial.complex_roots()  # of a root and its multiplicity
        return sorted((r.real for r, _ in pairs if r.imag.is_zero()), key=lambda ball: ball.mid())


def isolate_real_root(
    polynomial: flint.fmpz_poly, interval: tuple[flint.fmpq, flint.fmpq]
) -> tuple[tuple[flint.fmpq, flint.fmpq], int]:
    """The interval and the index from the left of the one root that it contains."""
    low, high = interval
    if not low < high:
        raise FieldError(f"the interval ({shown(str(low))}, {shown(str(high))}) of a number field is empty")
    precision = 64
    while True:
        bits = precision * polynomial.degree()
        within("coefficient_bits", bits, "an end of the interval is so close to a root that {} bits are needed")
        balls = real_root_balls(polynomial, precision)
        with working_precision(precision):
            left, right = flint.arb(low), flint.arb(high)
            sides = [(b > left, b < left, b < right, b > right) for b in balls]
        if all((s[0] or s[1]) and (s[2] or s[3]) for s in sides):
            inside = [i for i, s in enumerate(sides) if s[0] and s[2]]
            if len(inside) == 1:
                return interval, inside[0]
            raise FieldError(
                f"the interval ({shown(str(low))}, {shown(str(high))}) contains {len(inside)} real roots of "
                f"{shown(str(polynomial))}; "
                f"it must contain exactly one ({len(balls)} real roots in all)"
            )
        precision *= 2


# QQ: the rational numbers, as ``flint.fmpq``, and the conversion of other numbers and strings to them.

FIRST_PRIME = (1 << 61) - 1
_INTEGER = re.compile(r"[-+]?[0-9]+", re.ASCII)
_FRACTION = re.compile(r"[-+]?[0-9]+/[0-9]+", re.ASCII)


class ExactNumber:
    """Base of the exact numbers that need not be rational."""

    __slots__ = ()

    @abstractmethod
    def rational(self) -> flint.fmpq | None:
        """The rational number that this one equals, or None."""


def rational_number(value: Any) -> flint.fmpq | None:
    """The ``flint.fmpq`` equal to a rational number of Python, numpy, flint or sympy; None for other values."""
    if isinstance(value, flint.fmpq):
        return value
    if isinstance(value, (bool, np.bool_)):
        return None
    if isinstance(value, (int, flint.fmpz)):
        return flint.fmpq(value)
    if isinstance(value, numbers.Rational):  # int, Fraction, numpy integers, sympy Rational
        return flint.fmpq(int(value.numerator), int(value.denominator))
    if getattr(value, "is_Rational", False):
        return flint.fmpq(int(value.p), int(value.q))
    return None


def rational_from_text(text: str) -> flint.fmpq | None:
    """The rational number that a string such as '-3' or '1/2' denotes, else None (fast path of the grammar)."""
    stripped = text.strip()
    if _INTEGER.fullmatch(stripped):
        return flint.fmpq(grammar.read_integer(stripped.removeprefix("+")))
    if _FRACTION.fullmatch(stripped):
        top, bottom = stripped.removeprefix("+").split("/")
        if bottom.strip("0"):
            return flint.fmpq(grammar.read_integer(top), grammar.read_integer(bottom))
    return None


def refused(value: Any, field: Field) -> FieldError:
    """The error for a value that is not in an exact field; for a float it proposes a fraction."""
    if isinstance(value, (float, np.floating, Decimal)) or getattr(value, "is_Float", False):
        shown = Fraction(float(value)).limit_denominator(1000) if np.isfinite(float(value)) else "p/q"
        return FieldError(
            f"{float(value)!r} is a float, and {field.name} is exact: write a fraction such as '{shown}', "
            "or work numerically, over float64: .over(liehom.RR)"
        )
    if isinstance(value, (complex, np.complexfloating)) or getattr(value, "is_real", None) is False:
        return FieldError(
            f"{displayed(value)} is a complex number, and {field.name} is real: complex matrices go to from_matrices "
            "of Representation or LieAlgebra"
        )
    return FieldError(f"{displayed(value)} of type {type(value).__name__} is not an element of {field.name}")


@final
class RationalField(ExactField):
    """The field QQ of rational numbers; its elements are ``flint.fmpq``. Use the instance `QQ`.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> QQ.convert("-6/4"), QQ.sign(QQ.convert("-6/4"))
    (-3/2, -1)
    """

    __slots__ = ()

    @property
    def name(self) -> str:
        return "QQ"

    @property
    def degree(self) -> int:
        return 1

    @property
    def zero(self) -> flint.fmpq:
        return flint.fmpq(0)

    @property
    def one(self) -> flint.fmpq:
        return flint.fmpq(1)

    def convert(self, value: ScalarLike) -> flint.fmpq:
        if isinstance(value, str):
            rational = rational_from_text(value)
            if rational is None:
                return grammar.evaluate(grammar.parse(value), flint.fmpq, {}, {"sqrt": self.sqrt})
            return rational
        rational = value.rational() if isinstance(value, ExactNumber) else rational_number(value)
        if rational is None:
            raise refused(value, self)
        return rational

    def sqrt(self, value: ScalarLike) -> flint.fmpq:
        """The non-negative square root; `FieldError` if it is not rational."""
        number = self.convert(value)
        numerator, denominator = flint.fmpz(number.p), flint.fmpz(number.q)
        if numerator < 0:
            raise FieldError(f"sqrt({value}) is not real")
        top, bottom = numerator.isqrt(), denominator.isqrt()
        if top * top != numerator or bottom * bottom != denominator:
            raise FieldError(f"sqrt({value}) is not in QQ; give the field: .over(number_field('sqrt({value})'))")
        return flint.fmpq(top, bottom)

    def format(self, value: Scalar) -> str:
        return str(value)

    def sign(self, value: Scalar) -> int:
        return int(value > 0) - int(value < 0)

    def to_float(self, value: Scalar) -> float:
        number = self.convert(value)
        try:
            return int(number.p) / int(number.q)
        except OverflowError:
            with working_precision(64):
                return float(flint.arb(number))

    def coordinates(self, value: Scalar) -> list[flint.fmpq]:
        return [self.convert(value)]

    def from_coordinates(self, coordinates: Sequence[flint.fmpq]) -> flint.fmpq:
        return coordinates[0]

    def power_coordinates(self, exponent: int) -> list[int]:
        return [1]

    def modulus_coefficients(self) -> list[int]:
        return [0, 1]

    def residue(self, attempt: int = 0) -> tuple[int, int]:
        return prime(attempt), 0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RationalField)

    def __hash__(self) -> int:
        return hash("QQ")


@functools.cache
def prime(attempt: int) -> int:
    """The `attempt`-th prime at or below 2^61 - 1."""
    candidate = FIRST_PRIME if attempt == 0 else prime(attempt - 1) - 2
    while not flint.fmpz(candidate).is_prime():
        candidate -= 2
    return candidate


QQ = RationalField()

# python-flint does not define pickling; every object that contains exact numbers can so be sent to another process
copyreg.pickle(flint.fmpz, lambda x: (flint.fmpz, (int(x),)))
copyreg.pickle(flint.fmpq, lambda x: (flint.fmpq, (int(x.p), int(x.q))))
copyreg.pickle(flint.fmpz_poly, lambda f: (flint.fmpz_poly, ([int(c) for c in f.coeffs()],)))
copyreg.pickle(flint.fmpq_poly, lambda f: (flint.fmpq_poly, ([int(c) for c in f.numer().coeffs()], int(f.denom()))))
copyreg.pickle(flint.fmpz_mat, lambda a: (flint.fmpz_mat, (a.nrows(), a.ncols(), [int(x) for x in a.entries()])))
copyreg.pickle(flint.fmpq_mat, lambda a: (flint.fmpq_mat, (a.nrows(), a.ncols(), a.entries())))
