"""AlgebraicNumber: an element of a real number field."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

import flint

from liehom.errors import FieldError

if TYPE_CHECKING:
    from liehom.scalars.fields.number_field import NumberField


@final
class AlgebraicNumber:
    """An element of a real number field; made by arithmetic or ``field.convert``.

    Comparisons are those of the field's real embedding.

    Examples
    --------
    >>> from liehom.scalars import NumberField
    >>> K = NumberField("a", [-2, 0, 1], (1, 2))
    >>> K.generator > "7/5", 1 / K.generator
    (True, 1/2*a)
    """

    __slots__ = ("field", "polynomial")

    def __init__(self, field: NumberField, polynomial: Any) -> None:
        self.field = field
        self.polynomial = polynomial

    @property
    def coordinates(self) -> list[Any]:
        """Rational coordinates in powers of the integral generator."""
        return [self.polynomial[i] for i in range(self.field.degree)]

    def is_rational(self) -> bool:
        """Whether the number is rational."""
        return bool(self.polynomial.degree() < 1)

    def _operand(self, other: Any) -> Any:
        if isinstance(other, AlgebraicNumber) and other.field is self.field:
            return other.polynomial
        try:
            return self.field.convert(other).polynomial
        except FieldError:
            return None

    def _made(self, polynomial: Any) -> AlgebraicNumber:
        return AlgebraicNumber(self.field, polynomial)

    def __add__(self, other: Any) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self._made(self.polynomial + right)

    __radd__ = __add__

    def __sub__(self, other: Any) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self._made(self.polynomial - right)

    def __rsub__(self, other: Any) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self._made(right - self.polynomial)

    def __neg__(self) -> AlgebraicNumber:
        return self._made(-self.polynomial)

    def __mul__(self, other: Any) -> AlgebraicNumber:
        right = self._operand(other)
        if right is None:
            return NotImplemented
        return self._made((self.polynomial * right) % flint.fmpq_poly(self.field.modulus))

    __rmul__ = __mul__

    def inverse(self) -> AlgebraicNumber:
        """1 divided by the number; ZeroDivisionError for zero."""
        if self.polynomial.is_zero():
            raise ZeroDivisionError("division by zero in a number field")
        common, left, _ = self.polynomial.xgcd(flint.fmpq_poly(self.field.modulus))
        return self._made(left / common[0])

    def __truediv__(self, other: Any) -> AlgebraicNumber:
        right = self._operand(other)
        return NotImplemented if right is None else self * self._made(right).inverse()

    def __rtruediv__(self, other: Any) -> AlgebraicNumber:
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
        right = self._operand(other)
        return NotImplemented if right is None else bool(self.polynomial == right)

    def __hash__(self) -> int:
        return hash(tuple((int(c.p), int(c.q)) for c in self.coordinates))

    def __lt__(self, other: Any) -> bool:
        return self.field.sign(self - other) < 0

    def __le__(self, other: Any) -> bool:
        return self.field.sign(self - other) <= 0

    def __gt__(self, other: Any) -> bool:
        return self.field.sign(self - other) > 0

    def __ge__(self, other: Any) -> bool:
        return self.field.sign(self - other) >= 0

    def __float__(self) -> float:
        return self.field.to_float(self)

    def __repr__(self) -> str:
        return self.field.format(self)
