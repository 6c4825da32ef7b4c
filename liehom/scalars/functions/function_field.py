"""Rational functions on a variety: the field of fractions of its coordinate ring, exactly.

An element is numerator / denominator. The numerator is a normal form modulo the constraints, so an element is zero if
and only if its numerator is zero. The denominator is a product of powers of known polynomials ("atoms"), so fractions
with denominators such as |X|^2 and |X|^4 are added without a gcd.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar, final

import flint

from liehom.errors import FieldError, SingularError
from liehom.scalars.fields.rational import rational_number
from liehom.scalars.functions.coordinate_ring import MAX_TERMS_TO_FACTOR, CoordinateRing
from liehom.typing import Number, ScalarLike

Powers = tuple[tuple[int, int], ...]


@final
class FunctionField:
    """The field of fractions of QQ[names] / (constraints); the constraints should generate a prime ideal.

    Parameters
    ----------
    names : sequence of str
    constraints : sequence of mappings from exponents (tuples) to rational numbers
        Polynomials that vanish.
    graded : sequence of str
        The variables with degree 1 in the grading (the others have degree 0).

    Raises
    ------
    FieldError
        If the constraints contradict each other.

    Notes
    -----
    Equality in the ring is proved for every ideal: an element is 0 if its numerator is in the ideal. Only division
    requires a prime ideal, because a divisor of zero must not be a denominator.

    Examples
    --------
    >>> circle = FunctionField(["x", "y"], [{(2, 0): 1, (0, 2): 1, (0, 0): -1}], ["x", "y"])
    >>> x, y = circle.variables
    >>> x**2 + y**2 == 1, (1 - x**2) / y == y
    (True, True)
    >>> ((1 - x**4) / y**2).cancelled()
    -y^2 + 2
    """

    def __init__(
        self,
        names: Sequence[str],
        constraints: Iterable[Mapping[tuple[int, ...], ScalarLike]] = (),
        graded: Sequence[str] = (),
    ) -> None:
        self.ring: CoordinateRing = CoordinateRing(names, constraints, graded)
        constant = self.ring.context.constant
        self.atoms: list[flint.fmpq_mpoly] = []
        self._reduced: list[flint.fmpq_mpoly] = []
        self.zero: RationalFunction = RationalFunction(self, constant(0), ())
        self.one: RationalFunction = RationalFunction(self, constant(1), ())
        generators = map(self.ring.reduce, self.ring.context.gens())
        self.variables: tuple[RationalFunction, ...] = tuple(RationalFunction(self, g, ()) for g in generators)

    # -- denominators ------------------------------------------------------------------------------------
    def atom(self, p: flint.fmpq_mpoly) -> int:
        """Index of the atom p, which is added if it is new."""
        for i, known in enumerate(self.atoms):
            if known == p:
                return i
        self.atoms.append(p)
        self._reduced.append(self.ring.reduce(p))
        return len(self.atoms) - 1

    def reduced_atom(self, i: int) -> flint.fmpq_mpoly:
        """Normal form of atom i, a ``flint.fmpq_mpoly``."""
        return self._reduced[i]

    def denominator(self, powers: Powers) -> flint.fmpq_mpoly:
        """Normal form of a product of powers of atoms."""
        made = self.ring.context.constant(1)
        for i, k in powers:
            for _ in range(k):
                made = self.ring.reduce(made * self._reduced[i])
        return made

    def inverse(self, p: flint.fmpq_mpoly) -> RationalFunction:
        """1 / p for a polynomial that is not zero on the variety."""
        if p.is_zero():
            raise SingularError("division by a function that is zero")
        lifted = self.ring.homogeneous(p)
        powers: dict[int, int] = {}
        if lifted is None:
            for i in range(len(self.atoms)):
                while (quotient := self.ring.divide(p, self._reduced[i])) is not None:
                    p, powers[i] = quotient, powers.get(i, 0) + 1
        source = p if lifted is None else lifted
        content, factors = source.leading_coefficient(), [(source / source.leading_coefficient(), 1)]
        if len(source) <= MAX_TERMS_TO_FACTOR:
            content, factors = source.factor()
        for factor, k in factors:
            if not factor.is_constant():
                i = self.atom(factor)
                powers[i] = powers.get(i, 0) + int(k)
        return RationalFunction(self, self.ring.context.constant(1) / content, tuple(sorted(powers.items())))

    def primitive(self, vector: Sequence[RationalFunction]) -> list[RationalFunction]:
        """The multiple of a vector by a function that has no denominators and no known common divisor.

        The leading coefficient of the first component that is not zero is positive.
        """
        common: Powers = ()
        for x in vector:
            common = join(common, x.powers)
        tops = [x.over(common) for x in vector]
        lifted = [None if p.is_zero() else self.ring.homogeneous(p) for p in tops]
        known = [p if q is None else q for p, q in zip(tops, lifted, strict=True)]
        divisor = self.ring.context.constant(0)
        for p in known:
            divisor = p if divisor.is_zero() else divisor.gcd(p) if not p.is_zero() else divisor
        if divisor.is_zero():
            return [self.zero for _ in vector]
        known = [divmod(p, divisor)[0] for p in known]
        first = next(p for p in known if not p.is_zero())
        scale = _content(known) * (1 if first.leading_coefficient() > 0 else -1)
        return [RationalFunction(self, self.ring.reduce(p / scale), ()) for p in known]

    # -- numbers -----------------------------------------------------------------------------------------
    def convert(self, value: RationalFunction | Number | int) -> RationalFunction:
        """The element equal to a rational number or an element.

        Raises
        ------
        FieldError
            If the value is neither of these.
        """
        if isinstance(value, RationalFunction):
            return value
        number = rational_number(value)
        if number is None:
            raise FieldError(f"{value!r} is not a rational number: write a fraction, or a symbol for it")
        return RationalFunction(self, self.ring.context.constant(number), ())


@final
class RationalFunction:
    """An element of a `FunctionField`, with arithmetic with rational numbers and elements of the same field.

    Parameters
    ----------
    field : FunctionField
    numerator : flint polynomial, in normal form
    powers : tuple of (number of an atom, exponent)
        The denominator, a product of powers of atoms.

    Examples
    --------
    >>> x, y = FunctionField(["x", "y"]).variables
    >>> 1 / x - 1 / y
    (-x + y)/((x)*(y))
    >>> (x**2 - y**2) / (x - y) == x + y
    True
    """

    __slots__ = ("field", "numerator", "powers")

    def __init__(self, field: FunctionField, numerator: flint.fmpq_mpoly, powers: Powers) -> None:
        self.field: FunctionField = field
        self.numerator: flint.fmpq_mpoly = numerator
        self.powers: Powers = () if numerator.is_zero() else powers

    def _other(self, value: Any) -> RationalFunction | None:
        if isinstance(value, RationalFunction):
            return value
        number = rational_number(value)
        return None if number is None else RationalFunction(self.field, self.field.ring.context.constant(number), ())

    def __add__(self, other: RationalFunction | Number | int) -> RationalFunction:
        right = self._other(other)
        if right is None:
            return NotImplemented
        if self.powers == right.powers:
            return RationalFunction(self.field, self.numerator + right.numerator, self.powers)
        common = join(self.powers, right.powers)
        a = self.over(common)
        return RationalFunction(self.field, a + right.over(common), common)

    __radd__ = __add__

    def over(self, common: Powers) -> flint.fmpq_mpoly:
        """The numerator of the function over `common`, a multiple of its denominator."""
        if common == self.powers:
            return self.numerator
        own = dict(self.powers)
        missing = tuple((i, k - own.get(i, 0)) for i, k in common if k > own.get(i, 0))
        return self.field.ring.reduce(self.numerator * self.field.denominator(missing))

    def __neg__(self) -> RationalFunction:
        return RationalFunction(self.field, -self.numerator, self.powers)

    def __sub__(self, other: RationalFunction | Number | int) -> RationalFunction:
        right = self._other(other)
        return NotImplemented if right is None else self + (-right)

    def __rsub__(self, other: RationalFunction | Number | int) -> RationalFunction:
        left = self._other(other)
        return NotImplemented if left is None else left + (-self)

    def __mul__(self, other: RationalFunction | Number | int) -> RationalFunction:
        if not isinstance(other, RationalFunction):
            number = rational_number(other)
            if number is None:
                return NotImplemented
            return RationalFunction(self.field, self.numerator * number, self.powers)
        made = self.field.ring.reduce(self.numerator * other.numerator)
        return RationalFunction(self.field, made, times(self.powers, other.powers))

    __rmul__ = __mul__

    def __truediv__(self, other: RationalFunction | Number | int) -> RationalFunction:
        if not isinstance(other, RationalFunction):
            number = rational_number(other)
            if number is None:
                return NotImplemented
            if number == 0:
                raise SingularError("division by a function that is zero")
            return RationalFunction(self.field, self.numerator / number, self.powers)
        return self * other.inverse()

    def __rtruediv__(self, other: RationalFunction | Number | int) -> RationalFunction:
        left = self._other(other)
        return NotImplemented if left is None else left * self.inverse()

    def inverse(self) -> RationalFunction:
        """The inverse function 1 / f."""
        below = RationalFunction(self.field, self.field.denominator(self.powers), ())
        made: RationalFunction = self.field.inverse(self.numerator) * below
        return made

    def __pow__(self, exponent: int) -> RationalFunction:
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

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        return not self.numerator.is_zero()

    # -- simplification ----------------------------------------------------------------------------------
    def cancelled(self) -> RationalFunction:
        """The function after cancelling the atoms of the denominator that are found to divide the numerator."""
        if not self.powers:
            return self
        top, kept = self.numerator, []
        for i, k in self.powers:
            while k and (quotient := self.field.ring.divide(top, self.field.reduced_atom(i))) is not None:
                top, k = quotient, k - 1
            if k:
                kept.append((i, k))
        return RationalFunction(self.field, top, tuple(kept))

    def factors(self) -> tuple[flint.fmpq, list[tuple[flint.fmpq_mpoly, int]]]:
        """A number and pairs (polynomial, exponent of either sign) whose product equals the function on the variety."""
        lifted = self.field.ring.homogeneous(self.numerator)
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


def _content(polynomials: Sequence[flint.fmpq_mpoly]) -> flint.fmpq:
    """The positive rational number by which integer coefficients without common divisor are left."""
    numbers = [c for p in polynomials for c in p.coeffs()]
    top, bottom = flint.fmpz(0), flint.fmpz(1)
    for c in numbers:
        top, bottom = top.gcd(c.p), bottom.lcm(c.q)
    return flint.fmpq(top, bottom)
