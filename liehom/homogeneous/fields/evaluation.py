"""Evaluation of expressions at a point and a time in the arithmetic of the point, and the nodes of expressions.

A compiled expression is a function of an `Evaluation`, that is of m and t.  Its constants are numbers of the arithmetic
of m: float64, extended precision, exact numbers, or Jets of these.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, Literal, TypeAlias, final

import numpy as np

from liehom.errors import FieldError, ParseError
from liehom.homogeneous.maps import remainder
from liehom.scalars.fields.number_field import AlgebraicNumber
from liehom.series.arrays import elementary, is_exact
from liehom.series.jet import Jet
from liehom.typing import Real, Values

Value: TypeAlias = Any
"""A value of an expression: a float, an exact number, an array or a Jet."""


@final
class Evaluation:
    """The coordinates of a point m, the time t, and constants as numbers of the arithmetic of m.

    Parameters
    ----------
    m : array or Jet of shape (..., N)
    t : float, array or Jet

    Attributes
    ----------
    kind : {'float', 'extended', 'exact'}
        The arithmetic.

    Examples
    --------
    >>> at = Evaluation(np.array([2.0, 3.0]), 0.0)
    >>> float(at.coordinate(1)), at.rational(Fraction(1, 4))
    (3.0, 0.25)
    """

    t: Real

    __slots__ = ("_coordinates", "_m", "_zero", "kind", "t")

    def __init__(self, m: Values, t: Real) -> None:
        value: Any = m.value if isinstance(m, Jet) else m
        self._m, self.t = m, t
        self._coordinates: dict[int, Value] = {}
        self._zero: Value = 0.0
        self.kind: Literal["float", "extended", "exact"] = "float"
        if is_exact(value):
            self.kind, self._zero = "exact", 0 * value.flat[0] if value.size else Fraction(0)
        elif value.dtype == np.longdouble:
            self.kind, self._zero = "extended", np.longdouble(0)

    def coordinate(self, i: int) -> Value:
        """The coordinate m_i, of shape (...,)."""
        found = self._coordinates.get(i)
        if found is None:
            found = self._coordinates[i] = self._m[..., i]
        return found

    def rational(self, value: Fraction) -> Value:
        """A rational number in the arithmetic of m."""
        try:
            if self.kind == "float":
                return value.numerator / value.denominator
            return (self._zero + value.numerator) / value.denominator
        except OverflowError:
            raise FieldError("a number of the generator leaves the range of floats") from None

    def irrational(self, value: float, digits: str) -> Value:
        """An irrational number such as pi in the arithmetic of m, given by its float and by a string of digits."""
        if self.kind == "exact":
            raise FieldError(f"{value!r} stands next to exact numbers: write a fraction, or use floats throughout")
        return value if self.kind == "float" else np.longdouble(digits)

    def algebraic(self, value: AlgebraicNumber) -> Value:
        """An element of a number field in the arithmetic of m."""
        if self.kind == "exact":
            return self._zero + value
        near = value.field.to_float(value)
        return (
            near if self.kind == "float" else np.longdouble(near) + np.longdouble(remainder(value.field, value, near))
        )


Compiled = Callable[[Evaluation], Value]
"""A compiled expression."""


@final
class Constant:
    """The node of a constant, computed once for each arithmetic.

    Examples
    --------
    >>> Constant(lambda s: s.rational(Fraction(1, 3)))(Evaluation(np.zeros(1), 0.0))
    0.3333333333333333
    """

    __slots__ = ("_inner", "_known")

    def __init__(self, inner: Compiled) -> None:
        self._inner = inner
        self._known: dict[str, Value] = {}

    def __call__(self, at: Evaluation) -> Value:
        if at.kind == "exact":
            return self._inner(at)
        if at.kind not in self._known:
            self._known[at.kind] = self._inner(at)
        return self._known[at.kind]


@final
class Chain:
    """The node of a + b - c ... or a * b / c ..., evaluated from left to right.

    Raises
    ------
    ParseError
        On division of an exact number by zero.

    Examples
    --------
    >>> Chain(lambda s: 6.0, [("/", lambda s: 2.0), ("-", lambda s: 1.0)])(Evaluation(np.zeros(1), 0.0))
    2.0
    """

    __slots__ = ("_first", "_steps")

    def __init__(self, first: Compiled, steps: list[tuple[str, Compiled]]) -> None:
        self._first, self._steps = first, steps

    def __call__(self, at: Evaluation) -> Value:
        total = self._first(at)
        for operator, part in self._steps:
            right = part(at)
            if operator == "+":
                total = total + right
            elif operator == "-":
                total = total - right
            elif operator == "*":
                total = total * right
            else:
                try:
                    total = total / right
                except ZeroDivisionError:
                    raise ParseError("division by zero in a value") from None
        return total


@final
class Power:
    """The node of a power with a constant integer exponent.

    Examples
    --------
    >>> Power(lambda s: 3.0, 2)(Evaluation(np.zeros(1), 0.0))
    9.0
    """

    __slots__ = ("_base", "_exponent")

    def __init__(self, base: Compiled, exponent: int) -> None:
        self._base, self._exponent = base, exponent

    def __call__(self, at: Evaluation) -> Value:
        try:
            return self._base(at) ** self._exponent
        except ZeroDivisionError:
            raise ParseError("a negative power of zero in a value") from None


@final
class Function:
    """The node of a function of one argument, given by its numpy name.

    Examples
    --------
    >>> float(Function("arctan", lambda s: 0.0)(Evaluation(np.zeros(1), 0.0)))
    0.0
    """

    __slots__ = ("_argument", "_name")

    def __init__(self, name: str, argument: Compiled) -> None:
        self._name, self._argument = name, argument

    def __call__(self, at: Evaluation) -> Value:
        x = self._argument(at)
        if isinstance(x, Jet):
            return getattr(np, self._name)(x)
        if self._name == "sqrt" and at.kind == "exact":
            return np.vectorize(_exact_root, otypes=[object])(x) if np.ndim(x) else _exact_root(np.asarray(x).item())
        return elementary(self._name, x)


def _exact_root(x: Value) -> Value:
    return x.field.sqrt(x) if isinstance(x, AlgebraicNumber) else elementary("sqrt", x)
