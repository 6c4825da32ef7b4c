"""Rational functions on a variety: the elements of a `FunctionField`.

Numerator and powers of atoms; arithmetic with rational numbers and with elements of the same field.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

import flint

from liehom.errors import SingularError
from liehom.scalars.fields.rational import rational_number

if TYPE_CHECKING:
    from liehom.scalars.functions.function_field import FunctionField

Powers = tuple[tuple[int, int], ...]


@final
class RationalFunction:
    """An element of a `FunctionField`: arithmetic with rational numbers and with elements of the same field.

    Parameters
    ----------
    field : FunctionField
    numerator : flint polynomial, in normal form
    powers : tuple of (number of an atom, exponent)
        The denominator.

    Examples
    --------
    >>> from liehom.scalars.functions.function_field import FunctionField
    >>> x, y = FunctionField(["x", "y"]).variables
    >>> 1 / x - 1 / y
    (-x + y)/((x)*(y))
    >>> (x**2 - y**2) / (x - y) == x + y
    True
    """

    __slots__ = ("field", "numerator", "powers")

    def __init__(self, field: FunctionField, numerator: Any, powers: Powers) -> None:
        self.field = field
        self.numerator = numerator
        self.powers: Powers = () if numerator.is_zero() else powers

    def _other(self, value: Any) -> RationalFunction | None:
        if isinstance(value, RationalFunction):
            return value
        number = rational_number(value)
        return None if number is None else RationalFunction(self.field, self.field.ring.constant(number), ())

    def __add__(self, other: Any) -> Any:
        right = self._other(other)
        if right is None:
            return NotImplemented
        if self.powers == right.powers:
            return RationalFunction(self.field, self.numerator + right.numerator, self.powers)
        common = join(self.powers, right.powers)
        a = self.over(common)
        return RationalFunction(self.field, a + right.over(common), common)

    __radd__ = __add__

    def over(self, common: Powers) -> Any:
        """The numerator over a multiple of the denominator."""
        if common == self.powers:
            return self.numerator
        own = dict(self.powers)
        missing = tuple((i, k - own.get(i, 0)) for i, k in common if k > own.get(i, 0))
        return self.field.reduce(self.numerator * self.field.denominator(missing))

    def __neg__(self) -> RationalFunction:
        return RationalFunction(self.field, -self.numerator, self.powers)

    def __sub__(self, other: Any) -> Any:
        right = self._other(other)
        return NotImplemented if right is None else self + (-right)

    def __rsub__(self, other: Any) -> Any:
        left = self._other(other)
        return NotImplemented if left is None else left + (-self)

    def __mul__(self, other: Any) -> Any:
        if not isinstance(other, RationalFunction):
            number = rational_number(other)
            if number is None:
                return NotImplemented
            return RationalFunction(self.field, self.numerator * number, self.powers)
        made = self.field.reduce(self.numerator * other.numerator)
        return RationalFunction(self.field, made, times(self.powers, other.powers))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        if not isinstance(other, RationalFunction):
            number = rational_number(other)
            if number is None:
                return NotImplemented
            if number == 0:
                raise SingularError("division by a function that is zero")
            return RationalFunction(self.field, self.numerator / number, self.powers)
        return self * other.inverse()

    def __rtruediv__(self, other: Any) -> Any:
        left = self._other(other)
        return NotImplemented if left is None else left * self.inverse()

    def inverse(self) -> RationalFunction:
        """1 / self."""
        below = RationalFunction(self.field, self.field.denominator(self.powers), ())
        made: RationalFunction = self.field.inverse(self.numerator) * below
        return made

    def __pow__(self, exponent: int) -> Any:
        if isinstance(exponent, bool) or not isinstance(exponent, int):
            return NotImplemented
        base, made = (self if exponent >= 0 else self.inverse()), self.field.one
        for _ in range(abs(exponent)):
            made = made * base
        return made

    def __eq__(self, other: object) -> bool:
        right = self._other(other)
        if right is None:
            return NotImplemented
        return bool((self - right).numerator.is_zero())

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        return not self.numerator.is_zero()

    # -- simplification ----------------------------------------------------------------------------------
    def cancelled(self) -> RationalFunction:
        """The same function without the atoms of the denominator that are seen to divide the numerator."""
        if not self.powers:
            return self
        top, kept = self.numerator, []
        for i, k in self.powers:
            while k and (quotient := self.field.divide(top, self.field.reduced_atom(i))) is not None:
                top, k = quotient, k - 1
            if k:
                kept.append((i, k))
        return RationalFunction(self.field, top, tuple(kept))

    def factors(self) -> tuple[Any, list[tuple[Any, int]]]:
        """A number and polynomials with exponents of either sign, whose product equals the function on the variety."""
        lifted = self.field.homogeneous(self.numerator)
        top = self.numerator if lifted is None else lifted
        if top.is_zero():
            return flint.fmpq(0), []
        content, found = top.factor()
        below = [(self.field.atoms[i], -k) for i, k in self.powers]
        return content, [(p, int(k)) for p, k in found] + below

    def __repr__(self) -> str:
        if not self.powers:
            return str(self.numerator)
        below = "*".join(f"({self.field.atoms[i]})" + (f"^{k}" if k > 1 else "") for i, k in self.powers)
        return f"({self.numerator})/({below})"


def join(a: Powers, b: Powers) -> Powers:
    """The least common multiple of two denominators.

    Examples
    --------
    >>> join(((0, 1),), ((0, 2), (1, 1)))
    ((0, 2), (1, 1))
    """
    made = dict(a)
    for i, k in b:
        made[i] = max(k, made.get(i, 0))
    return tuple(sorted(made.items()))


def times(a: Powers, b: Powers) -> Powers:
    """The product of two denominators.

    Examples
    --------
    >>> times(((0, 1),), ((0, 2), (1, 1)))
    ((0, 3), (1, 1))
    """
    if not a or not b:
        return a or b
    made = dict(a)
    for i, k in b:
        made[i] = made.get(i, 0) + k
    return tuple(sorted(made.items()))
