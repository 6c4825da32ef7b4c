"""Rigorous enclosures: roots of polynomials, matrices of balls, independence over the reals."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from typing import Any

import flint

from liehom.base.budget import in_time
from liehom.base.errors import FieldError, ShapeError
from liehom.base.typing import ScalarLike
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.number_fields import AlgebraicNumber, NumberField
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import MAX_PRECISION, QQ, precisions, working_precision

# Balls only choose cuts and intervals. The roots on each side of a cut are then counted exactly (`Polynomial`).


def complex_root_balls(f: Polynomial, precision: int) -> list[flint.acb]:
    """Disjoint balls (``flint.acb``) around the complex roots of a squarefree polynomial over a number field."""
    if not isinstance(f.field, NumberField):
        with working_precision(precision):
            pairs: Any = flint.fmpq_poly([QQ.convert(c) for c in f.coefficients]).complex_roots()
            return [root for root, _ in pairs]
    for bits in precisions(precision):
        with working_precision(bits), suppress(ValueError):  # flint's: the roots are not isolated
            return list(flint.acb_poly([f.field.ball(c, bits) for c in f.coefficients]).roots())
    raise FieldError(f"the roots of {f} could not be isolated with {MAX_PRECISION} bits")


def simplest_between(low: ScalarLike, high: ScalarLike) -> flint.fmpq:
    """The rational number with the smallest denominator strictly between two rational numbers, low < high."""
    low, high = QQ.convert(low), QQ.convert(high)
    floor = flint.fmpz(low.p // low.q)
    if floor + 1 < high:
        # the simplest number is 0 or else the integer nearest to 0
        if low < 0 < high:
            return flint.fmpq(0)
        if low >= 0:
            return flint.fmpq(floor + 1)
        return flint.fmpq(high.p - 1 if high.q == 1 else high.p // high.q)
    # the open interval holds no integer: continue with the reciprocals of the fractional parts
    left, right = low - floor, high - floor
    if left == 0:
        return floor + flint.fmpq(1, right.q // right.p + 1)
    return floor + 1 / simplest_between(1 / right, 1 / left)


def bounds(ball: flint.arb) -> tuple[flint.fmpq, flint.fmpq]:
    """The exact rational ends of a real ball, for any working precision."""
    middle, radius = ball.mid().fmpq(), ball.rad().fmpq()
    return middle - radius, middle + radius


def gaps_between(intervals: Iterable[tuple[ScalarLike, ScalarLike]]) -> list[tuple[flint.fmpq, flint.fmpq]]:
    """Open intervals between closed intervals with rational ends, from left to right."""
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
    """Rational ends, of opposite signs, of an interval with only the largest real root of a squarefree polynomial."""
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
        low, high = (middle, high) if count(middle, high) else (low, middle)
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
    """
    for attempt in itertools.count(1):
        in_time()
        parts = [r.real for r in complex_root_balls(f, 32 << attempt)]
        cuts = [cut + shift for cut in cuts_between(parts) for shift in (0, flint.fmpq(1, 97), flint.fmpq(-1, 89))]
        for low, high in gaps_between(map(bounds, parts)):
            cuts += rationals_inside(low, high, 4 * attempt)
        cut = next((cut for cut in cuts if 0 < count_or_none(f, cut) < f.degree), None)
        if cut is not None or (attempt == 1 and _on_one_line(f)):
            return cut
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


Ball = flint.arb
BallMatrix = flint.arb_mat


def ball_matrix(matrix: ExactMatrix, precision: int) -> flint.arb_mat:
    """Enclosure (``flint.arb_mat``) of a matrix over an exact field, with the current working precision."""
    total = flint.arb_mat(matrix.parts[0])
    if isinstance(matrix.field, NumberField):
        generator = matrix.field.generator_ball(precision)
        power = generator
        for part in matrix.parts[1:]:
            total += flint.arb_mat(part) * power
            power = power * generator
    return total * (flint.arb(1) / matrix.den)


def real_ball(value: Scalar, precision: int) -> flint.arb:
    """Ball (``flint.arb``) around a number that is rational or in a real number field."""
    return value.field.ball(value, precision) if isinstance(value, AlgebraicNumber) else flint.arb(QQ.convert(value))


def complex_ball(real: Scalar, imaginary: Scalar, precision: int) -> flint.acb:
    """Ball (``flint.acb``) around a complex number whose parts are rational or in real number fields."""
    return flint.acb(real_ball(real, precision), real_ball(imaginary, precision))


def frobenius_bound(matrix: flint.arb_mat) -> flint.arb:
    """Upper bound, a number without radius, of the Frobenius norm of every matrix in an enclosure."""
    return sum((x * x for x in matrix.entries()), flint.arb(0)).sqrt().upper()


PRECISION_LIMIT = 1 << 14


def is_basis_of_reals(blocks: Sequence[ExactMatrix], n: int) -> bool:
    """Whether the rows of all blocks are a basis of R^n."""
    if any(b.ncols != n for b in blocks):
        raise ShapeError(f"rows of length {[b.ncols for b in blocks]} in R^{n}")
    if sum(b.nrows for b in blocks) != n:
        return False
    for precision in precisions(128, PRECISION_LIMIT):
        with working_precision(precision):
            table = [row for block in blocks for row in ball_matrix(block, precision).tolist()]
            if not table or not flint.arb_mat(table).det().contains(0):
                return True
    return False
