"""Rational functions modulo constraints, against their values at rational points."""

import operator
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

from liehom.base.errors import FieldError, SingularError
from liehom.exact.scalars.function_field import FunctionField, RationalFunction
from tests.sampling import examples

SPHERE: dict[tuple[int, ...], int] = {(2, 0, 0, 0): 1, (0, 2, 0, 0): 1, (0, 0, 2, 0): 1, (0, 0, 0, 0): -1}
POLYNOMIALS = st.dictionaries(
    st.tuples(*[st.integers(0, 2)] * 4), st.integers(-3, 3).filter(bool), min_size=1, max_size=4
)
SMALL = st.integers(-4, 4)


def sphere() -> FunctionField:
    return FunctionField(["x", "y", "z", "a"], [SPHERE], ["x", "y", "z"])


def built(field: FunctionField, terms: Any) -> RationalFunction:
    return RationalFunction(field, field.ring.reduce(field.ring.polynomial(terms)), ())


def point(u: int, v: int) -> list[Fraction]:
    n = 1 + u * u + v * v
    return [Fraction(2 * u, n), Fraction(2 * v, n), Fraction(u * u + v * v - 1, n)]


def at(x: RationalFunction, values: list[Fraction]) -> Fraction | None:
    """The value, None where the denominator vanishes."""

    def of(p: Any) -> Fraction:
        total = Fraction(0)
        for e, c in p.terms():
            term = Fraction(int(c.p), int(c.q))
            for value, k in zip(values, e, strict=True):
                term *= value ** int(k)
            total += term
        return total

    top, bottom = of(x.numerator), Fraction(1)
    for i, k in x.powers:
        bottom *= of(x.field.atoms[i]) ** k
    return None if bottom == 0 else top / bottom


@settings(max_examples=examples(60))
@given(POLYNOMIALS, POLYNOMIALS, POLYNOMIALS, SMALL, SMALL, SMALL)
def test_arithmetic_is_that_of_the_values(p: Any, q: Any, r: Any, u: int, v: int, a: int) -> None:
    field, values = sphere(), [*point(u, v), Fraction(a)]
    x, y, z = (built(field, terms) for terms in (p, q, r))
    if not y or not z:
        return
    made_of = x / y - 2 * y / z + x * y
    parts = [at(e, values) for e in (x, y, z)]
    result = at(made_of, values)
    if result is not None and parts[1] and parts[2]:
        assert result == parts[0] / parts[1] - 2 * parts[1] / parts[2] + parts[0] * parts[1]  # type: ignore[operator]
    assert made_of * y * z == x * z - 2 * y * y + x * y * y * z


@settings(max_examples=examples(60))
@given(POLYNOMIALS, POLYNOMIALS)
def test_products_are_divided(p: Any, q: Any) -> None:
    """Whatever the parities: quotients on the sphere are found where they exist."""
    field = sphere()
    x, y = built(field, p), built(field, q)
    if not x or not y:
        return
    again = (x * y / y).cancelled()
    assert again == x and again.powers == ()
    quotient = field.ring.divide((x * y).numerator, y.numerator)
    assert quotient is not None and RationalFunction(field, quotient, ()) == x


@settings(max_examples=examples(40))
@given(POLYNOMIALS)
def test_factors_and_shorter_forms_are_equal(p: Any) -> None:
    field = sphere()
    x = built(field, p)
    content, factors = x.factors()
    total = field.convert(content)
    for factor, k in factors:
        total = total * RationalFunction(field, field.ring.reduce(factor), ()) ** k
    assert total == x
    assert field.ring.reduce(field.ring.shortest(field.ring.polynomial(p))) == x.numerator


def test_what_is_not_divisible_is_not_divided() -> None:
    field = sphere()
    x, y, z, a = field.variables
    assert field.ring.divide((x * y).numerator, (x + y).numerator) is None
    assert (x / (1 + y)).cancelled().powers != ()
    assert ((1 - y**2) / (1 + y)).cancelled() == 1 - y
    assert ((x**2 + z**2) * a / (1 - y)).cancelled().powers == ()


def test_division_modulo_several_constraints() -> None:
    """The curve of the rank one symmetric 2 x 2 matrices of trace one, where quotients are found by an ansatz."""
    field = FunctionField(["x", "y", "z"], [{(1, 0, 1): 1, (0, 2, 0): -1}, {(1, 0, 0): 1, (0, 0, 1): 1, (0, 0, 0): -1}])
    x, y, z = field.variables
    assert x * z == y**2 and x + z == 1
    assert (y**2 / x).cancelled() == z
    assert ((x - x**2) / y).cancelled() == y


def test_primitive_vectors_have_no_common_divisor() -> None:
    x, y = FunctionField(["x", "y"]).variables
    field = x.field
    assert field.primitive([-x / 2, x * y / 3]) == [field.convert(3), -2 * y]
    assert field.primitive([field.zero, field.zero]) == [field.zero, field.zero]
    assert field.primitive([1 / x, 1 / y]) == [y, x]


def test_contradictory_constraints_division_by_zero_and_floats_are_refused() -> None:
    with pytest.raises(FieldError, match="no common zero"):
        FunctionField(["x"], [{(1,): 1}, {(1,): 1, (0,): 1}])
    field = FunctionField(["x"], [])
    (x,) = field.variables
    with pytest.raises(SingularError):
        x / (x - x)
    with pytest.raises(SingularError):
        x / 0
    with pytest.raises(FieldError, match="write a fraction"):
        field.convert(0.5)
    for operation, other in [("add", 0.5), ("mul", "a"), ("pow", 0.5), ("truediv", 0.5), ("sub", 0.5)]:
        with pytest.raises(TypeError):
            getattr(operator, operation)(x, other)
        if operation != "pow":
            with pytest.raises(TypeError):
                getattr(operator, operation)(other, x)
    assert (x == "a") is False and bool(x) and not x - x
    assert x**-2 * x**2 == 1
