"""Polynomials over QQ and number fields: counts against numpy and against known roots, factors multiplied out."""

import math
from typing import Any

import flint
import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from liehom.base.errors import FieldError
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import Polynomial, Polynomial as Direct
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.roots import (
    complex_root_balls,
    count_or_none,
    cuts_between,
    largest_real_root_interval,
    real_part_cut,
    simplest_between,
)

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
CUBIC = NumberField("a", [-2, 0, 0, 1], (1, 2))
FIELDS = [QQ, ROOT2, CUBIC]
small = st.integers(-6, 6)


def number(field: Any, coordinates: list[int]) -> Any:
    return field.from_coordinates([QQ.convert(c) for c in coordinates[: field.degree]])


def numbers(field: Any) -> st.SearchStrategy[Any]:
    return st.lists(small, min_size=field.degree, max_size=field.degree).map(lambda c: number(field, c))


@st.composite
def polynomials(draw: st.DrawFn, field: Any, least: int = 1, most: int = 5) -> Polynomial:
    built = Polynomial(field, draw(st.lists(numbers(field), min_size=least + 1, max_size=most + 1)))
    assume(built.degree >= least)
    return built


def product(field: Any, parts: list[Polynomial]) -> Polynomial:
    total = Polynomial(field, [1])
    for part in parts:
        total = total * part
    return total


def from_roots(field: Any, roots: list[Any], pairs: list[tuple[Any, Any]]) -> Polynomial:
    """The polynomial with these real roots and the complex roots x +- i y for the pairs (x, y), y != 0."""
    linear = [Polynomial(field, [-r, 1]) for r in roots]
    return product(field, [*linear, *(Polynomial(field, [x * x + y * y, -2 * x, 1]) for x, y in pairs)])


@st.composite
def with_known_roots(draw: st.DrawFn) -> tuple[Polynomial, list[Any], list[tuple[Any, Any]]]:
    field = draw(st.sampled_from(FIELDS))
    roots = draw(st.lists(numbers(field), max_size=4))
    pairs = draw(st.lists(st.tuples(numbers(field), st.integers(1, 4).map(field.convert)), max_size=3))
    assume(roots or pairs)
    return from_roots(field, roots, pairs), roots, pairs


# -- arithmetic --------------------------------------------------------------------------------------------
@given(data=st.data(), field=st.sampled_from(FIELDS))
def test_quotient_times_divisor_plus_remainder_is_the_polynomial(data: st.DataObject, field: Any) -> None:
    f, g = data.draw(polynomials(field, 0)), data.draw(polynomials(field, 0, 3))
    quotient, remainder = f.divided(g)
    assert quotient * g + remainder == f and remainder.degree < g.degree


@given(data=st.data(), field=st.sampled_from(FIELDS))
def test_gcd_divides_both_and_contains_common_factors(data: st.DataObject, field: Any) -> None:
    f, g, h = (data.draw(polynomials(field, 0, 3)) for _ in range(3))
    common = (f * h).gcd(g * h)
    assert (f * h % common).degree == -1 and (g * h % common).degree == -1
    assert (common % h).degree == -1 and common.leading == 1


@given(data=st.data(), field=st.sampled_from(FIELDS))
def test_shifted_polynomial_has_the_shifted_values(data: st.DataObject, field: Any) -> None:
    f, by, at = data.draw(polynomials(field, 0)), data.draw(numbers(field)), data.draw(numbers(field))
    assert f.shifted(by)(at) == f(at + by)


def test_zero_polynomial_has_degree_minus_one() -> None:
    zero = Polynomial(QQ, [0, 0])
    assert zero.degree == -1 and zero.leading == 0 and repr(zero) == "0" and zero.count_real_roots() == 0
    with pytest.raises(ZeroDivisionError):
        Polynomial(QQ, [1, 1]) % zero
    assert Direct is Polynomial


# -- factors -----------------------------------------------------------------------------------------------
@given(data=st.data(), field=st.sampled_from(FIELDS))
def test_factors_multiply_to_the_monic_polynomial(data: st.DataObject, field: Any) -> None:
    f = product(field, data.draw(st.lists(polynomials(field, 1, 2), min_size=1, max_size=3)))
    factors = f.factor()
    assert product(field, [p for p, m in factors for _ in range(m)]) == f.monic()
    assert len({p for p, _ in factors}) == len(factors)
    assert [p.degree for p, _ in factors] == sorted(p.degree for p, _ in factors)
    for p, _ in factors:
        assert p.leading == 1
        assert [q for q, _ in p.factor()] == [p]
        if p.degree in (2, 3):  # irreducible: no root in the field
            assert all(
                p(x) != 0 for x in (number(field, [a, b, c]) for a in range(-3, 4) for b in (-1, 0, 1) for c in (0, 1))
            )


@given(data=st.data(), field=st.sampled_from(FIELDS))
def test_squarefree_parts_multiply_to_the_polynomial_and_are_coprime(data: st.DataObject, field: Any) -> None:
    f = product(field, [p for p in data.draw(st.lists(polynomials(field, 1, 2), min_size=1, max_size=3)) for _ in "ab"])
    parts = f.squarefree_parts()
    assert product(field, [p for p, m in parts for _ in range(m)]) == f.monic()
    assert all(p.gcd(p.derivative()).degree == 0 for p, _ in parts)


@pytest.mark.parametrize(("field", "coefficients", "degrees"), [
    (ROOT2, [-2, 0, 1], [1, 1]),
    (ROOT2, [1, 0, 0, 0, 1], [2, 2]),  # t^4 + 1 = (t^2 + a t + 1)(t^2 - a t + 1)
    (ROOT2, [-3, 0, 1], [2]), (ROOT2, [-8, 0, 0, 0, 1], [2, 2]), (CUBIC, [-2, 0, 0, 1], [1, 2]),
    (CUBIC, [-2, 0, 1], [2]), (CUBIC, [-16, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1], [1, 1, 2, 2, 2, 4]),
    (QQ, [1, 1, 1, 1, 1], [4]), (QQ, [-4, 0, 0, 0, 1], [2, 2]), (QQ, ["-1/4", 0, 1], [1, 1]),
])  # fmt: skip
def test_known_factors_have_the_expected_degrees(field: Any, coefficients: list[Any], degrees: list[int]) -> None:
    assert [f.degree for f, _ in Polynomial(field, coefficients).factor()] == degrees


def test_factors_of_norms_that_are_not_squarefree() -> None:
    """f with rational coefficients: without a shift its norm is a square, so Trager's shift is needed."""
    f = Polynomial(ROOT2, [-2, 0, 0, 1]) * Polynomial(ROOT2, [1, 0, 1])
    assert sorted(p.degree for p, _ in f.factor()) == [2, 3]


# -- counts ------------------------------------------------------------------------------------------------
@given(known=with_known_roots(), data=st.data())
def test_real_root_counts_equal_known_roots(known: Any, data: st.DataObject) -> None:
    f, roots, _ = known
    assert f.count_real_roots() == len({*roots})
    low, high = sorted(data.draw(st.tuples(small, small)))
    if f(f.field.convert(low)) != 0 and f(f.field.convert(high)) != 0:
        inside = {r for r in roots if f.field.sign(r - low) > 0 and f.field.sign(high - r) >= 0}
        assert f.count_real_roots(low, high) == len(inside)


@given(known=with_known_roots(), cut=st.fractions(-7, 7, max_denominator=5))
def test_half_plane_counts_equal_known_roots(known: Any, cut: Any) -> None:
    f, roots, pairs = known
    cut = f.field.convert(cut)
    parts = [*roots, *(x for x, _ in pairs for _ in range(2))]
    expected = sum(1 for x in parts if f.field.sign(x - cut) > 0)
    result = count_or_none(f, cut)
    if result < 0:  # two roots symmetric about the cut
        points = {*((r, f.field.zero) for r in roots), *pairs}
        assert any((2 * cut - x, y) in points for x, y in points)
    else:
        assert result == expected
        assert all(x != cut for x in parts)


@pytest.mark.parametrize("seed", range(40))
def test_root_counts_equal_those_of_numpy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    coefficients = [int(c) for c in rng.integers(-9, 10, int(rng.integers(2, 14)))]
    coefficients[-1] = 1
    f = Polynomial(QQ, coefficients)
    roots = np.roots(coefficients[::-1])
    simple = f.gcd(f.derivative()).degree == 0
    if simple:
        assert f.count_real_roots() == int((np.abs(roots.imag) < 1e-7).sum())
    cut = flint.fmpq(int(rng.integers(-20, 20)), 7)
    if np.abs(roots.real - float(int(cut.p) / int(cut.q))).min() > 1e-4:
        expected = int((roots.real > int(cut.p) / int(cut.q)).sum())
        assert count_or_none(f, cut) in (expected, -1)


@pytest.mark.parametrize("multiplicity", [1, 2, 5])
def test_symmetric_roots_are_refused(multiplicity: int) -> None:
    f = product(QQ, [Polynomial(QQ, [-1, 0, 1])] * multiplicity)
    with pytest.raises(FieldError, match="symmetric"):
        f.count_right_of(0)
    assert f.count_right_of(flint.fmpq(1, 9)) == multiplicity


# -- intervals and cuts ------------------------------------------------------------------------------------
@given(
    roots=st.lists(st.fractions(-50, 50, max_denominator=9), min_size=1, max_size=5, unique=True),
    scale=st.integers(0, 40),
)
def test_interval_of_the_largest_root(roots: list[Any], scale: int) -> None:
    size = QQ.convert(10**scale) if scale % 2 else QQ.convert(f"1/{10**scale}")
    exact = [QQ.convert(r) * size for r in roots]
    f = from_roots(QQ, exact, [(flint.fmpq(1), flint.fmpq(2))])
    low, high = largest_real_root_interval(f)
    assert low < max(exact) < high and sum(1 for r in exact if low <= r <= high) == 1
    assert f(low) * f(high) < 0


def test_ends_are_integers_if_no_other_root_is_between_them() -> None:
    f = from_roots(QQ, [QQ.convert(x) for x in ("-33/10", 0, "13/5", 4)], [])
    assert largest_real_root_interval(f) == (3, 5)


@pytest.mark.parametrize("offset", [0, 7, -7, 10**6, -(10**6)])
def test_roots_closer_than_floats(offset: int) -> None:
    """Roots offset +- sqrt(2)/10^100, and a third one far below."""
    tiny = flint.fmpq(1, 10**200)
    f = Polynomial(QQ, [offset * offset - 2 * tiny, -2 * offset, 1]) * Polynomial(QQ, [10**7, 1])
    low, high = largest_real_root_interval(f)
    assert f.count_real_roots(low, high) == 1 and f.count_real_roots(high, None) == 0
    assert low > offset - flint.fmpq(1, 10**99) * 2 and high > offset


def test_largest_root_of_a_polynomial_without_real_roots_raises_field_error() -> None:
    with pytest.raises(FieldError, match="no real root"):
        largest_real_root_interval(Polynomial(QQ, [1, 0, 1]))


def test_interval_over_a_number_field() -> None:
    f = Polynomial(ROOT2, [-5, ROOT2.generator, 0, 1])
    low, high = largest_real_root_interval(f)
    assert f.count_real_roots(low, high) == 1 and f.count_real_roots(high, None) == 0


@given(low=st.fractions(-9, 9), width=st.fractions(min_value="1/1000", max_value=3))
def test_the_simplest_number_between(low: Any, width: Any) -> None:
    a, b = QQ.convert(low), QQ.convert(low + width)
    result = simplest_between(a, b)
    assert a < result < b
    for q in range(1, int(result.q)):  # no fraction with a smaller denominator lies strictly between
        assert math.floor(low * q) + 1 >= (low + width) * q


@pytest.mark.parametrize(("low", "high", "expected"), [
    ("-1", "1", "0"), ("0", "1", "1/2"), ("1", "2", "3/2"), ("-3", "-1", "-2"), ("-1/2", "-1/3", "-2/5"),
    ("0", "1/7", "1/8"), ("-1/7", "0", "-1/8"), ("5/2", "7/2", "3"), ("-7/2", "-5/2", "-3"), ("2", "1000", "3"),
])  # fmt: skip
def test_simplest_number_between_examples(low: str, high: str, expected: str) -> None:
    assert simplest_between(QQ.convert(low), QQ.convert(high)) == QQ.convert(expected)


def test_cut_between_real_parts() -> None:
    f = from_roots(QQ, [flint.fmpq(3)], [(flint.fmpq(1), flint.fmpq(5)), (flint.fmpq(1), flint.fmpq(2))])
    cut = real_part_cut(f)
    assert 1 < cut < 3 and f.count_right_of(cut) == 1
    assert real_part_cut(from_roots(QQ, [], [(flint.fmpq(1), flint.fmpq(5)), (flint.fmpq(1), flint.fmpq(2))])) is None


def test_balls_over_a_number_field_sharpen() -> None:
    """Two pairs of roots that 64 bits cannot tell apart."""
    a = ROOT2.generator * 10**40
    f = Polynomial(ROOT2, [a, 1, 1]) * Polynomial(ROOT2, [a + flint.fmpq(1, 10**30), 1, 1])
    balls = complex_root_balls(f, 64)
    assert len(balls) == 4
    assert len(cuts_between([b.imag for b in balls])) == 3
