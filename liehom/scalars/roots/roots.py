"""Location of the roots of a polynomial: balls of growing precision, and rational numbers between them.

Balls only choose cuts and intervals. The roots on each side of a cut are then counted exactly (`Polynomial`).
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import flint

from liehom.errors import FieldError
from liehom.scalars.fields.balls import working_precision
from liehom.scalars.fields.number_field import MAX_PRECISION, NumberField
from liehom.scalars.fields.polynomial import Polynomial
from liehom.scalars.fields.rational import QQ
from liehom.typing import ScalarLike


def complex_root_balls(f: Polynomial, precision: int) -> list[flint.acb]:
    """Balls (``flint.acb``) around the complex roots of a squarefree polynomial, disjoint over a number field.

    The precision (bits) is doubled until it separates the roots.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> len(complex_root_balls(Polynomial(QQ, [1, 0, 0, 1]), 64))
    3
    """
    if not isinstance(f.field, NumberField):
        with working_precision(precision):
            pairs: Any = flint.fmpq_poly([QQ.convert(c) for c in f.coefficients]).complex_roots()
            return [root for root, _ in pairs]
    while precision <= MAX_PRECISION:
        with working_precision(precision), suppress(ValueError):  # flint's: the roots are not isolated
            return list(flint.acb_poly([f.field.ball(c, precision) for c in f.coefficients]).roots())
        precision *= 2
    raise FieldError(f"the roots of {f} could not be isolated with {MAX_PRECISION} bits")


def simplest_between(low: ScalarLike, high: ScalarLike) -> flint.fmpq:
    """The rational number with the smallest denominator strictly between two rational numbers, low < high.

    Examples
    --------
    >>> simplest_between(flint.fmpq(1, 3), flint.fmpq(3, 5))
    1/2
    """
    low, high = QQ.convert(low), QQ.convert(high)
    floor = flint.fmpz(low.p // low.q)
    if floor + 1 < high:
        # the simplest number is 0 or else the integer nearest to 0
        if low < 0 < high:
            return flint.fmpq(0)
        if low >= 0:
            return flint.fmpq(floor + 1)
        top = flint.fmpz((high.p - 1) // high.q) if high.q == 1 else flint.fmpz(high.p // high.q)
        return flint.fmpq(top)
    # the open interval holds no integer: continue with the reciprocals of the fractional parts
    left, right = low - floor, high - floor
    if left == 0:
        return floor + flint.fmpq(1, _above(1 / right))
    return floor + 1 / simplest_between(1 / right, 1 / left)


def _above(value: flint.fmpq) -> flint.fmpz:
    """The smallest integer greater than a rational number."""
    return flint.fmpz(value.p // value.q) + 1


def bounds(ball: flint.arb) -> tuple[flint.fmpq, flint.fmpq]:
    """The exact rational ends of a real ball, for any working precision.

    Examples
    --------
    >>> low, high = bounds(flint.arb(1, 0.5))
    >>> low <= flint.fmpq(1, 2) and flint.fmpq(3, 2) <= high
    True
    """
    middle, radius = ball.mid().fmpq(), ball.rad().fmpq()
    return middle - radius, middle + radius


def cuts_between(balls: list[flint.arb]) -> list[flint.fmpq]:
    """Simple rational numbers in the gaps between consecutive disjoint real balls, widest gaps first."""
    intervals = sorted((bounds(b) for b in balls), key=lambda pair: pair[0])
    gaps = []
    reach = intervals[0][1]
    for low, high in intervals[1:]:
        if low > reach:
            # stay inside the middle half of the gap, so that the cut is robust
            quarter = (low - reach) / 4
            gaps.append((low - reach, simplest_between(reach + quarter, low - quarter)))
        reach = max(reach, high)
    return [cut for _, cut in sorted(gaps, key=lambda pair: pair[0], reverse=True)]


def largest_real_root_interval(f: Polynomial) -> tuple[flint.fmpq, flint.fmpq]:
    """Rational ends of an interval that contains the largest real root of a squarefree polynomial and no other.

    The polynomial changes sign between the ends.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> largest_real_root_interval(Polynomial(QQ, [-2, 0, 1]))
    (0, 2)
    """
    count = f.root_counter()
    total = count(None, None)
    if not total:
        raise FieldError(f"{f} has no real root")
    bound = 1
    while count(-bound, bound) < total or f(bound) == 0 or f(-bound) == 0:
        bound *= 2
    # f is squarefree, so it changes sign at each root, and bisection separates any two roots
    low, high = flint.fmpq(-bound), flint.fmpq(bound)
    while count(low, high) != 1:
        middle = (low + high) / 2
        while f(middle) == 0:
            middle = (middle + high) / 2
        if count(middle, high):
            low = middle
        else:
            high = middle
    while low.q > 4 or high.q > 4:
        wider = (flint.fmpq(low.p // low.q), flint.fmpq(high.p // high.q) + 1)
        if f(wider[0]) == 0 or f(wider[1]) == 0 or count(*wider) != 1:
            break
        low, high = wider
    return low, high


def real_part_cut(f: Polynomial) -> flint.fmpq | None:
    """A rational number strictly between two different real parts of roots, or None if none is found.

    It is proved that 0 < number of roots with larger real part < degree.
    """
    for precision in (64, 128, 256):
        parts = [r.real for r in complex_root_balls(f, precision)]
        for cut in cuts_between(parts):
            for shift in (0, flint.fmpq(1, 97), flint.fmpq(-1, 89)):
                if 0 < count_or_none(f, cut + shift) < f.degree:
                    return cut + shift
    return None


def count_or_none(f: Polynomial, cut: ScalarLike) -> int:
    """`Polynomial.count_right_of`, or -1 if two roots are symmetric about the cut."""
    try:
        return f.count_right_of(cut)
    except FieldError:
        return -1
