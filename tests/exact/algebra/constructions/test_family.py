"""Families of Lie algebras with parameters: identities, generic statements, and the members at values."""

import pickle
from collections.abc import Callable
from typing import Any

import pytest
import sympy
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, JacobiError, ParseError, ShapeError, StructureError
from tests.sampling import examples

a, b, c = sympy.symbols("a b c")
DIAGONAL: Any = {("x", "y"): {"z": c}, ("y", "z"): {"x": a}, ("z", "x"): {"y": b}}
BIANCHI = lh.algebra.LieAlgebraFamily(DIAGONAL, name="diagonal")
values = st.sampled_from([0, 0, 1, -1]) | st.fractions(-3, 3, max_denominator=4)


def test_the_jacobi_identity_is_an_identity_of_polynomials() -> None:
    assert BIANCHI.conditions == () and BIANCHI.parameters == (a, b, c) and BIANCHI.basis_names == ("x", "y", "z")
    assert BIANCHI.at(a=1, b=1, c=1) == lh.bianchi("IX").change_of_basis([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert BIANCHI.at({"a": 1, "b": 1}, c=-1).real_form() == "sl(2,R)"
    assert BIANCHI.at(a=1, b=2, c=3).name == "diagonal(1,2,3)"
    assert BIANCHI.at(a="sqrt(2)", b=0, c=0).field == lh.number_field("sqrt(2)")
    assert not BIANCHI.at(a=0.5, b=1, c=1).field.exact


@given(st.tuples(values, values, values))
@settings(max_examples=examples(60), deadline=None)
def test_generic_statements_hold_where_their_polynomials_do_not_vanish(point: tuple[Any, Any, Any]) -> None:
    g = BIANCHI.at(dict(zip("abc", point, strict=True)))
    at = {symbol: sympy.Rational(str(value)) for symbol, value in zip((a, b, c), point, strict=True)}
    form = BIANCHI.killing_form().subs(at)
    assert [[str(x) for x in row] for row in form.tolist()] == g.killing_form().to_strings()
    assert g.is_semisimple() == (BIANCHI.killing_determinant().subs(at) != 0)
    for number, dimension in (
        (BIANCHI.derived_dimension(), g.derived_series()[1].dimension if len(g.derived_series()) > 1 else g.dimension),
        (BIANCHI.center_dimension(), g.center().dimension),
        (BIANCHI.killing_rank(), g.killing_form().rank()),
    ):
        assert number.sharp
        assert (number.nonvanishing.subs(at) != 0) == (number.value == dimension)


def test_the_centre_is_larger_exactly_where_two_parameters_vanish() -> None:
    family = lh.algebra.LieAlgebraFamily({("x", "y"): {"z": a}, ("y", "z"): {"x": b}, ("z", "x"): {"y": 1}})
    assert repr(family.center_dimension()) == "0 where a**2 + b**2 != 0"


def test_conditions_are_those_of_the_jacobi_identity() -> None:
    family = lh.algebra.LieAlgebraFamily({(0, 1): {1: a}, (0, 2): {2: b}, (1, 2): {0: a * b - 1}})
    assert family.conditions == ((a + b) * (a * b - 1),)
    assert family.at(a=2, b="1/2").dimension == family.at(a=2, b=-2).dimension == 3
    with pytest.raises(JacobiError):
        family.at(a=2, b=3)
    sample = family.sample()
    assert sample is not None and family.at(sample).dimension == 3
    for question in (family.killing_form, family.derived_dimension, family.is_semisimple):
        with pytest.raises(StructureError, match=r"only where .* = 0; choose values, for example .at\(a=2, b=-2\)"):
            question()


def test_a_jacobi_identity_that_always_fails_is_refused() -> None:
    with pytest.raises(JacobiError, match="x, y, z"):
        lh.algebra.LieAlgebraFamily({("x", "y"): {"x": 1}, ("x", "z"): {"y": 1}})


def test_semisimple_if_uniform() -> None:
    assert lh.algebra.LieAlgebraFamily(
        {("h", "e"): {"e": 2}, ("h", "f"): {"f": -2, "e": 0}, ("e", "f"): {"h": 1}}
    ).is_semisimple()
    assert not lh.algebra.LieAlgebraFamily({("x", "t"): {"x": 1}, ("y", "t"): {"y": a}}).is_semisimple()
    with pytest.raises(lh.UndecidedError, match=r"if and only if \(a\)\*\(b\)\*\(c\) != 0; .*at\(a=2, b=2, c=2\)"):
        BIANCHI.is_semisimple()


def test_denominators_are_left_out() -> None:
    family = lh.algebra.LieAlgebraFamily({("x", "t"): {"x": "1/(a - 1)"}, ("y", "t"): {"y": "a"}}, ["a"])
    assert family.denominator == a - 1
    assert family.derived_dimension().nonvanishing == a * (a - 1)
    assert family.at(a=3).derived_series()[1].dimension == 2
    with pytest.raises(InputError, match=r"1/\(a - 1\) is not defined there"):
        family.at(a=1)


@pytest.mark.parametrize(("constants", "parameters", "error", "match"), [
    ({(0, 1): {1: sympy.sin(a)}}, None, FieldError, "rational function"),
    ({(0, 1): {1: sympy.sqrt(2) * a}}, None, FieldError, "rational coefficients"),
    ({(0, 1): {1: 0.5 * a}}, None, FieldError, "rational coefficients"),
    ({(0, 1): {1: 0.5}}, None, FieldError, "fraction"),
    ({(0, 1): {1: "b"}}, ["a"], ParseError, r"c\[0, 1, 1\].*'b' is not known"),
    ({(0, 1): {1: a * b}}, ["a"], InputError, "symbols b"),
    ({(0, 1): {1: a}, (1, 0): {1: a}}, None, StructureError, "antisymmetric"),
    ({(0, 0): {1: a}}, None, StructureError, "antisymmetric"), ({("x", 1): {1: a}}, None, StructureError, "not both"),
    ({(0, 1): 3}, None, StructureError, "is not a bracket"), ([[a]], None, ShapeError, "shape"),
    ({(0, 1): {1: "(a + b + c + 1)**4096"}}, ["a", "b", "c"], InputError, "degree 4096"),
    ({(0, 1): {1: ((a + b) ** 64 + c) ** 64}}, None, InputError, "degree 4096"),
    ({(0, 1): {1: sum(1 / (a + k * b + c) for k in range(60))}}, None, InputError, "degree 60"),
    ({(0, 1): {1: a + sympy.Symbol("a", positive=True)}}, None, InputError, "two symbols of one name"),
])  # fmt: skip
def test_bad_input_is_refused(constants: Any, parameters: Any, error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        lh.algebra.LieAlgebraFamily(constants, parameters)


def test_an_algebra_with_symbols_names_the_door() -> None:
    array = [[[0, 0], [0, a]], [[0, -a], [0, 0]]]
    forms: list[Callable[[], Any]] = [
        lambda: lh.LieAlgebra({("x", "y"): {"z": a}}),
        lambda: lh.LieAlgebra({(0, 1): {2: a + 1}}),
        lambda: lh.LieAlgebra(array),  # type: ignore[arg-type]
    ]
    for make in forms:
        with pytest.raises(FieldError, match=r"liehom\.algebra\.LieAlgebraFamily.*at\(a=2\)"):
            make()
    assert lh.algebra.LieAlgebraFamily(array).at(a=2) == lh.LieAlgebra({(0, 1): {1: 2}})  # type: ignore[arg-type]


def test_everything_else_is_refused_with_values_to_try() -> None:
    with pytest.raises(AttributeError, match=r"'radical' depends on the parameters; .*\.at\(a=2, b=2, c=2\)\.radical"):
        _ = BIANCHI.radical
    with pytest.raises(AttributeError, match="no attribute 'colour'"):
        _ = BIANCHI.colour
    with pytest.raises(InputError, match="b, c have no value"):
        BIANCHI.at(a=1)
    with pytest.raises(InputError, match="d: the parameters are a, b, c"):
        BIANCHI.at(a=1, b=1, c=1, d=1)


def test_equal_families_hash_equal_and_are_immutable() -> None:
    again = lh.algebra.LieAlgebraFamily({(0, 1): {2: "c"}, (1, 2): {0: "a"}, (0, 2): {1: "-b"}}, ["a", "b", "c"])
    assert again == BIANCHI and hash(again) == hash(BIANCHI) and pickle.loads(pickle.dumps(BIANCHI)) == BIANCHI
    with pytest.raises(AttributeError, match="immutable"):
        BIANCHI.conditions = ()


def test_printing() -> None:
    assert str(BIANCHI).splitlines()[1:] == ["  basis x, y, z", "  [x, y] = c*z", "  [x, z] = -b*y", "  [y, z] = a*x"]
    assert repr(BIANCHI) == "<family diagonal of Lie algebras of dimension 3 with parameters a, b, c>"
    assert repr(BIANCHI.derived_dimension()) == "3 where a*b*c != 0"
