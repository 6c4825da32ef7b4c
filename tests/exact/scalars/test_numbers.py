"""Numbers of a real field as floats, signs and texts."""

import math
from typing import Any

import pytest
from hypothesis import given, strategies as st

from liehom.base.errors import FieldError
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
NESTED = NumberField("a", [2, 0, -4, 0, 1], (1, 2))  # sqrt(2 + sqrt(2))
NOT_MONIC = NumberField("a", [-3, 0, 0, 2], (1, 2))  # (3/2)^(1/3)
VALUES = {ROOT2: math.sqrt(2), NESTED: math.sqrt(2 + math.sqrt(2)), NOT_MONIC: 1.5 ** (1 / 3)}


@st.composite
def elements(draw: st.DrawFn) -> tuple[Any, float]:
    """A number with its value in floats."""
    field = draw(st.sampled_from(list(VALUES)))
    coordinates = draw(st.lists(st.fractions(-9, 9, max_denominator=7), min_size=field.degree, max_size=field.degree))
    built, value = field.zero, 0.0
    for c in reversed(coordinates):
        built, value = built * field.generator + field.convert(c), value * VALUES[field] + float(c)
    return built, value


@given(elements())
def test_floats_signs_and_strings_agree_with_the_value(case: tuple[Any, float]) -> None:
    number, value = case
    field = number.field
    assert float(number) == pytest.approx(value, rel=1e-9, abs=1e-9)
    if abs(value) > 1e-9:
        assert field.sign(number) == (1 if value > 0 else -1)
    assert field.convert(field.format(number)) == number
    assert (number == 0) == (field.sign(number) == 0)
    if number != 0:
        assert number * (1 / number) == 1 and number / number == 1


@given(elements())
def test_square_roots_square_to_the_number(case: tuple[Any, float]) -> None:
    number, value = case
    root = number.field.sqrt(number * number)
    assert root == (number if number.field.sign(number) >= 0 else -number)
    assert float(root) == pytest.approx(abs(value), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("k", [1, 10, 52, 300])
def test_floats_of_numbers_that_nearly_vanish(k: int) -> None:
    """(sqrt 2 - 1)^k as a + b sqrt 2: nearly all digits cancel."""
    assert float((ROOT2.generator - 1) ** k) == pytest.approx((math.sqrt(2) - 1) ** k, rel=1e-12)


@pytest.mark.parametrize("field", [QQ, ROOT2])
def test_floats_beyond_their_range(field: Any) -> None:
    assert field.to_float(field.convert(10**400)) == math.inf
    assert field.to_float(field.convert(f"1/{10**400}")) == 0.0
    assert field.to_float(field.convert(f"{10**400}/{10**399}")) == 10.0


def test_rational_numbers_of_a_number_field_are_told() -> None:
    root = ROOT2.generator
    assert (root * root).is_rational() and not root.is_rational() and (root - root).is_rational()
    assert QQ.power_coordinates(3) == [1]


def test_square_roots_over_floats_are_refused_with_the_way_out() -> None:
    with pytest.raises(FieldError, match="not exact"):
        RR.sqrt(2.0)
    assert [RR.sign(x) for x in (-0.5, 0.0, 2.0)] == [-1, 0, 1]
    assert str(RR.matrix([[1.0, 2.5]])) == "[[1.  2.5]]"


def test_zero_is_false_in_every_field() -> None:
    assert not ROOT2.zero and ROOT2.one and ROOT2.generator and not ROOT2.generator - ROOT2.generator
    assert not QQ.zero and QQ.one
