"""Numbers given as sympy expressions: their field is found, their value is kept."""

import pytest
import sympy

import liehom as lh
from liehom.base.errors import FieldError


@pytest.mark.parametrize("value", [
    sympy.Rational(1, 3), sympy.sqrt(2) / 2, sympy.cbrt(2), 1 + 3 * sympy.cbrt(4), -sympy.root(5, 4),
    sympy.sqrt(2 + sympy.sqrt(2)),
])  # fmt: skip
def test_sympy_value_survives_conversion(value: sympy.Expr) -> None:
    algebra = lh.LieAlgebra({(0, 1): {1: value}}, dimension=2)
    (_, _, _, constant) = next(algebra.structure_constants())
    assert algebra.field.exact
    assert algebra.field.to_float(constant) == pytest.approx(float(value), rel=1e-14)


def test_two_values_in_one_given_field() -> None:
    field = lh.number_field(sympy.cbrt(2))
    algebra = lh.LieAlgebra({(0, 1): {1: sympy.cbrt(2)}, (0, 2): {2: sympy.cbrt(4)}}, field, dimension=3)
    first, second = (v for *_, v in algebra.structure_constants())
    assert first * first == second
    assert first**3 == 2


@pytest.mark.parametrize("value", [sympy.pi, sympy.Symbol("x"), sympy.I, sympy.sqrt(-2)])
def test_other_than_real_algebraic_numbers_raise_field_error(value: sympy.Expr) -> None:
    with pytest.raises(FieldError):
        lh.LieAlgebra({(0, 1): {1: value}}, dimension=2)


def test_values_without_a_common_field_ask_for_one() -> None:
    with pytest.raises(FieldError, match="number_field"):
        lh.LieAlgebra({(0, 1): {1: sympy.cbrt(2)}, (0, 2): {2: sympy.cbrt(3)}}, dimension=3)


def test_a_number_outside_the_given_field_is_refused() -> None:
    with pytest.raises(FieldError, match="is not in"):
        lh.number_field("sqrt(2)").convert(sympy.sqrt(3))
