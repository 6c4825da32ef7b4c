"""Location of the roots of a polynomial: balls of growing precision, and rational numbers between them.

Balls only choose cuts and intervals. The roots on each side of a cut are then counted exactly (`Polynomial`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any

import flint

from liehom.budget import in_time
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


def gaps_between(intervals: Iterable[tuple[ScalarLike, ScalarLike]]) -> list[tuple[flint.fmpq, flint.fmpq]]:
    """Open intervals between closed intervals with rational ends, from left to right.

    Examples
    --------
    >>> gaps_between([(4, 5), (0, 1), (1, 2)])
    [(2, 4)]
    """
    ordered = sorted((QQ.convert(low), QQ.convert(high)) for low, high in intervals)
    gaps, reach = [], ordered[0][1]
    for low, high in ordered[1:]:
        if low > reach:
            gaps.append((reach, low))
        reach = max(reach, high)
    return gaps


def rationals_inside(low: flint.fmpq, high: flint.fmpq, count: int) -> Iterator[flint.fmpq]:
    """`count` simple rational numbers in the middle three quarters of an interval, those near its middle first.

    A cut fails if two roots are symmetric about it, so a larger count than the number of pairs always succeeds.

    Examples
    --------
    >>> list(rationals_inside(QQ.convert(0), QQ.convert(8), 3))
    [4, 2, 6]
    """
    start, width = low + (high - low) / 8, (high - low) * 3 / (4 * count)
    for number in sorted(range(count), key=lambda i: abs(2 * i - count + 1)):
        yield simplest_between(start + width * number, start + width * (number + 1))


def cuts_between(balls: list[flint.arb]) -> list[flint.fmpq]:
    """Simple rational numbers in the gaps between consecutive disjoint real balls, widest gaps first."""
    gaps = gaps_between(bounds(ball) for ball in balls)
    # the middle half of a gap, so that the cut is robust
    middle = [(high - low, low + (high - low) / 4, high - (high - low) / 4) for low, high in gaps]
    return [simplest_between(low, high) for _, low, high in sorted(middle, key=lambda gap: gap[0], reverse=True)]


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
    """A rational number strictly between two different real parts of roots, or None if all real parts are equal.

    It is proved that 0 < number of roots with larger real part < degree. The precision and the number of cuts grow
    until a cut is found, unless all roots are proved to lie on one line Re = c.

    Parameters
    ----------
    f : Polynomial
        Squarefree, of degree at least 1.
    """
    for attempt in itertools.count(1):
        in_time()
        parts = [r.real for r in complex_root_balls(f, 32 << attempt)]
        cuts = [cut + shift for cut in cuts_between(parts) for shift in (0, flint.fmpq(1, 97), flint.fmpq(-1, 89))]
        for low, high in gaps_between(map(bounds, parts)):
            cuts += rationals_inside(low, high, 4 * attempt)
        found = next((cut for cut in cuts if 0 < count_or_none(f, cut) < f.degree), None)
        if found is not None or (attempt == 1 and _on_one_line(f)):
            return found
    return None


def _on_one_line(f: Polynomial) -> bool:
    """Whether the roots of a squarefree polynomial of degree at least 1 have equal real parts.

    The centred polynomial is then t^e G(t^2), e = 0 or 1, where all roots of G are real and negative.
    """
    centred = f.shifted(-f.coefficients[-2] / (f.coefficients[-1] * f.degree)).coefficients
    odd = f.degree % 2
    if any(c != 0 for c in centred[1 - odd :: 2]):
        return False
    squares = Polynomial(f.field, centred[odd::2])
    return squares.count_real_roots(None, 0) == squares.degree


def count_or_none(f: Polynomial, cut: ScalarLike) -> int:
    """`Polynomial.count_right_of`, or -1 if two roots are symmetric about the cut."""
    try:
        return f.count_right_of(cut)
    except FieldError:
        return -1
