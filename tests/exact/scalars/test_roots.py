"""Cuts between real parts: they are found whatever their distance, or there is proved to be none."""

import math

import flint
import pytest

from liehom.base.errors import FieldError
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ, isolate_real_root
from liehom.exact.scalars.roots import gaps_between, rationals_inside, real_part_cut

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))


def four_roots(square: flint.fmpq) -> Polynomial:
    """The polynomial with the roots +-e +- i, e^2 = square, irreducible over QQ unless e is rational."""
    return Polynomial(QQ, [(1 + square) ** 2, 0, 2 - 2 * square, 0, 1])


@pytest.mark.parametrize("digits", [0, 1, 20, 100])
def test_real_parts_are_separated_at_any_distance(digits: int) -> None:
    f = four_roots(flint.fmpq(2, 10 ** (2 * digits)))
    cut = real_part_cut(f)
    assert cut is not None and f.count_right_of(cut) == 2
    shifted = f.shifted(flint.fmpq(5, 7))
    assert shifted.count_right_of(real_part_cut(shifted)) == 2


def test_roots_on_one_line_have_no_cut() -> None:
    for f in ([1, 0, 1], [0, 1, 0, 1], [2, 0, 3, 0, 1], [5, -2, 1], [7, 1], [0, 2, 0, 3, 0, 1]):
        for shift in (0, 3, flint.fmpq(-1, 3)):
            assert real_part_cut(Polynomial(QQ, f).shifted(shift)) is None
            assert real_part_cut(Polynomial(ROOT2, f).shifted(shift * ROOT2.generator)) is None


def test_even_polynomials_with_other_roots_have_a_cut() -> None:
    for f in ([1, 0, 0, 0, 1], [-2, 0, 1], [-2, 0, 0, 0, 1], [3, 0, -4, 0, 1], [0, -2, 0, 1]):
        built = Polynomial(QQ, f)
        assert 0 < built.count_right_of(real_part_cut(built)) < built.degree


@pytest.mark.parametrize("count", [1, 3, 4, 20])
def test_numbers_in_an_interval_are_distinct_and_begin_in_its_middle(count: int) -> None:
    result = list(rationals_inside(QQ.convert(0), QQ.convert(8), count))
    assert len(set(result)) == count and all(1 < c < 7 for c in result)
    assert abs(result[0] - 4) <= flint.fmpq(6, count)


def test_gaps_lie_between_the_closed_intervals() -> None:
    assert gaps_between([(0, 3), (1, 2), (5, 6), (6, 7), (8, 8)]) == [(3, 5), (7, 8)]
    assert gaps_between([(1, 1)]) == []


def test_an_interval_may_end_close_to_a_root() -> None:
    polynomial, below = flint.fmpz_poly([-2, 0, 1]), flint.fmpq(math.isqrt(2 * 10**120), 10**60)
    assert isolate_real_root(polynomial, (below, flint.fmpq(2))) == ((below, 2), 1)
    assert isolate_real_root(polynomial, (-below, flint.fmpq(2)))[1] == 1
    with pytest.raises(FieldError, match="contains 0 real roots"):
        isolate_real_root(polynomial, (flint.fmpq(1), below))
