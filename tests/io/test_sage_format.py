"""Structure constants in Sage's notation: round trips, what Sage prints, bad input."""

from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom import io
from liehom.base import errors
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from tests.sampling import examples

SL2 = "{('e', 'f'): {'h': 1}, ('e', 'h'): {'e': -2}, ('f', 'h'): {'f': 2}}"


def algebras() -> dict[str, LieAlgebra]:
    return {
        "zero": lh.abelian(0),
        "line": lh.abelian(1),
        "abelian": lh.abelian(3),
        "heisenberg": lh.heisenberg(2),
        "so(3,1)": lh.so(3, 1),
        "with a centre": lh.gl(2),
        "fractions": lh.so(4).change_of_basis([[i + 1 if i == j else j % 2 for j in range(6)] for i in range(6)]),
    }


@pytest.mark.parametrize("key", sorted(algebras()))
def test_round_trip(key: str) -> None:
    algebra = algebras()[key]
    found = io.from_sage(io.to_sage(algebra), name=algebra.name)
    assert found == algebra
    assert (found.basis_names, found.name) == (algebra.basis_names, algebra.name)


def test_names_that_are_not_variables_are_replaced() -> None:
    algebra = lh.LieAlgebra({(0, 1): {1: 1}}, basis=["e+", "f-"])
    found = io.from_sage(io.to_sage(algebra))
    assert found == algebra
    assert found.basis_names == ("e0", "e1")


@pytest.mark.parametrize(
    "text",
    [
        SL2,
        f"LieAlgebra(QQ, {SL2}, names='e,f,h')",
        f"LieAlgebra(QQ, 'e,f,h', {SL2})",
        f"L.<e,f,h> = LieAlgebra(QQ, {SL2})",
        f"L = LieAlgebra(QQ, {SL2}, names=['e', 'f', 'h'])",
        "Finite family {('e', 'f'): h, ('e', 'h'): -2*e, ('f', 'h'): 2*f}",
        "{('e', 'f'): [('h', 1)], ('h', 'e'): [('e', 2)], ('h', 'f'): [('f', -2)]}",
    ],
)
def test_the_ways_to_write_sl2(text: str) -> None:
    algebra = io.from_sage(text)
    assert algebra.basis_names == ("e", "f", "h")
    assert algebra == io.from_sage({("e", "f"): {"h": 1}, ("e", "h"): {"e": -2}, ("f", "h"): {"f": 2}})
    assert algebra.killing_signature() == (2, 1, 0)


def test_linear_combinations_with_fractions() -> None:
    text = "Finite family {('x', 'y'): -x + 3/2*y - (x - 2*y)/2 + 0}"
    assert str(io.from_sage(text)).splitlines()[-1] == "  [x, y] = -3/2*x + 5/2*y"


def test_names_in_no_bracket() -> None:
    assert io.from_sage("{('x', 'y'): {'y': 1}}", names="x, y, z").center().dimension == 1
    assert io.from_sage({("x", "y"): {"y": "1/2"}}, names=["z", "y", "x"]).basis_names == ("z", "y", "x")
    assert io.from_sage({}, names=()).dimension == 0


def test_indices_that_are_integers() -> None:
    assert io.from_sage("{(1, 2): {3: 1}}").basis_names == ("1", "2", "3")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "expected a dictionary"),
        ("{", "does not parse"),
        ("(" * 100000, "does not parse"),
        ("[1]", "expected a dictionary"),
        ("{'x': 1}", "not a pair of names"),
        ("{('x', 'y'): {'z': 0.5}}", "0.5 is not an integer or a fraction"),
        ("{('x', 'y'): {'z': 1/0}}", "1 / 0 is not an integer or a fraction"),
        ("{('x', 'y'): {'z': True}}", "True is not"),
        ("{('x', 'y'): {'z': sqrt(2)}}", r"sqrt\(2\) is not"),
        ("{('x', 'y'): {**z}}", "not the name"),
        ("{('x', 'y'): {'z': 1}, ('x', 'y'): {'z': 1}}", "given twice"),
        ("{('x', 'y'): x*y}", "not a linear combination"),
        ("{('x', 'y'): 2**x}", "not a linear combination"),
        ("{('x', 'y'): x**2}", "not a linear combination"),
        ("{('x', 'y'): 1/x}", "not a linear combination"),
        ("{('x', 'y'): x + 1}", "not a linear combination"),
        ("{('x', 'y'): x/0}", "not a linear combination"),
        ("{('x', f()): x}", "not the name"),
        ("Finite family {('x', 'y'): E[alpha[1]]}", "not a linear combination"),
        ("LieAlgebra(GF(2), {('x', 'y'): {'x': 1}})", "the field is"),
        ("LieAlgebra(QQ, {}, category=C)", "argument category"),
        ("LieAlgebra(QQ)", "needs names"),
        ("__import__('os').system('ls')", "is not read"),
    ],
)
def test_malformed_brackets_raise_with_the_fault(text: str, says: str) -> None:
    with pytest.raises(errors.FormatError, match=says):
        io.from_sage(text)


@pytest.mark.parametrize("value", [0.5, "sqrt(2)", "a"])
def test_coefficients_of_a_mapping_are_rational(value: Any) -> None:
    with pytest.raises(errors.FormatError, match="coefficient"):
        io.from_sage({("x", "y"): {"x": value}})


@pytest.mark.parametrize("brackets", [7, None, ["x"]])
def test_neither_text_nor_mapping(brackets: Any) -> None:
    with pytest.raises(errors.FormatError, match="string or a mapping"):
        io.from_sage(brackets)


def test_names_must_be_there_and_distinct() -> None:
    with pytest.raises(errors.FormatError, match="mention 'y'"):
        io.from_sage("{('x', 'y'): {'x': 1}}", names="x,z")
    with pytest.raises(errors.FormatError, match="distinct"):
        io.from_sage("{('x', 'y'): {'x': 1}}", names="x,y,x")


def test_the_axioms_are_proved() -> None:
    with pytest.raises(errors.StructureError, match="not antisymmetric"):
        io.from_sage("{('x', 'y'): {'x': 1}, ('y', 'x'): {'x': 1}}")
    with pytest.raises(errors.JacobiError):
        io.from_sage("{('x', 'y'): {'z': 3}, ('y', 'z'): {'z': 1}, ('z', 'x'): {'y': 1}}")


@pytest.mark.parametrize("value", ["sqrt(2)", 0.5])
def test_only_rational_numbers_are_carried(value: Any) -> None:
    with pytest.raises(errors.FormatError, match="rational structure constants"):
        io.to_sage(lh.LieAlgebra({(0, 1): {1: value}}))


@settings(max_examples=examples(30))
@given(st.text(alphabet="{}()[]'xy:,*/+-1 =L", max_size=40))
def test_no_text_does_anything_but_raise_or_give_an_algebra(text: str) -> None:
    try:
        found = io.from_sage(text)
    except errors.InputError:
        return
    assert isinstance(found, LieAlgebra)
