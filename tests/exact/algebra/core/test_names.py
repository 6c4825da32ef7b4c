"""Brackets and elements by the names of basis elements."""

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, ShapeError, StructureError
from tests.sampling import examples

SL2: Any = {("h", "e"): {"e": 2}, ("h", "f"): {"f": -2}, ("e", "f"): {"h": 1}}


def test_names_in_order_of_first_appearance() -> None:
    g = lh.LieAlgebra(SL2)
    assert g.basis_names == ("h", "e", "f")
    assert g == lh.LieAlgebra({(0, 1): {1: 2}, (0, 2): {2: -2}, (1, 2): {0: 1}})
    assert lh.LieAlgebra({("x", "y"): {"z": 1}}).basis_names == ("x", "y", "z")
    assert lh.LieAlgebra({("x", "y"): {"z": "sqrt(2)"}}).field == lh.number_field("sqrt(2)")


def test_basis_gives_the_order_and_elements_without_brackets() -> None:
    g = lh.LieAlgebra(SL2, basis=["e", "f", "h", "c"])
    assert g.dimension == 4 and g.center().rows() == [[0, 0, 0, 1]]
    assert g.show(g.bracket("e", "f")) == "h"
    assert lh.LieAlgebra({}, basis=["x", "y"]).is_abelian()
    assert lh.LieAlgebra({(0, 1): {1: 1}}, basis=["x", "y", "z"]).dimension == 3


@given(st.permutations(["h", "e", "f"]))
@settings(max_examples=examples(12), deadline=None)
def test_the_order_of_names_is_a_change_of_basis(order: list[str]) -> None:
    rows = [[int(name == other) for other in ("h", "e", "f")] for name in order]
    assert lh.LieAlgebra(SL2, basis=order) == lh.LieAlgebra(SL2).change_of_basis(rows)


@pytest.mark.parametrize(("constants", "options", "match"), [
    ({("x", 0): {"z": 1}}, {}, "names or indices for basis elements, not both; got the name 'x' and 0"),
    ({("x", "y"): {0: 1}}, {}, "not both"),
    ({("x", "y"): {"z": 1}}, {"basis": ["x", "y"]}, "no basis element is named 'z'; the names are x, y"),
    ({("x1", "y1"): {"z": 1}}, {"basis": ["x1", "y1", "zz"]}, "'z'; the nearest is zz"),
    ({"xy": {"z": 1}}, {}, "'xy'.* is not a bracket"), ({("x", "y"): 3}, {}, "is not a bracket"),
])  # fmt: skip
def test_wrong_names_are_refused(constants: Any, options: dict[str, Any], match: str) -> None:
    with pytest.raises(StructureError, match=match):
        lh.LieAlgebra(constants, **options)


def test_elements_by_name() -> None:
    g = lh.LieAlgebra(SL2)
    assert g.bracket("h", "e").tolist() == [0, 2, 0]
    assert g.bracket({"h": "1/2", "e": 1}, "f").tolist() == [1, 0, -1]
    assert g.ad("h") == g.ad([1, 0, 0])
    assert g.subalgebra(["h", {"e": 1, "h": 3}]) == g.subalgebra([[1, 0, 0], [0, 1, 0]])
    assert lh.Pair(g, ["h"]).subalgebra == g.centralizer(["h"]) == g.centralizer([[1, 0, 0]])
    assert g.subalgebra_generated_by(["e", "f"]).dimension == 3 == g.ideal_generated_by(["e"]).dimension
    assert "e" in g.subalgebra(["h", "e"]) and {"f": 1} not in g.subalgebra(["h", "e"])
    assert lh.so(3).bracket("e0", "e1").tolist() == [0, 0, 1]


def test_wrong_elements_are_refused() -> None:
    g = lh.LieAlgebra({("x1", "y1"): {"z": 1}})
    with pytest.raises(InputError, match="no basis element is named 'y'; the nearest is y1"):
        g.bracket("x1", "y")
    with pytest.raises(ShapeError, match="the key 0"):
        g.bracket({0: 1}, "y1")  # type: ignore[dict-item]
    with pytest.raises(InputError):
        g.subalgebra("z")
    with pytest.raises(InputError, match="'q'"):
        g.subalgebra(["z", "q"])


def test_elements_are_shown_by_name() -> None:
    g = lh.LieAlgebra(SL2)
    assert g.show([0, 0, 0]) == "0"
    assert g.show(np.array([1, -1, "-1/2"], dtype=object)) == "h - e - 1/2*f"
    assert g.over(lh.number_field("sqrt(2)")).show([0, "1 + sqrt(2)", "-sqrt(2)"]) == "(1 + sqrt(2))*e - sqrt(2)*f"
    assert g.show({"f": 1}) == g.show("f") == "f"
    assert g.over(lh.RR).show([0.5, 0.0, -1.0]) == "0.5*h - 1.0*f"


def test_a_shown_element_is_a_string_and_survives_pickling() -> None:
    shown = lh.LieAlgebra(SL2).show([1, -1, 0])
    assert isinstance(shown, str)
    assert repr(shown) == "'h - e'"
    loaded = pickle.loads(pickle.dumps(shown))
    assert loaded == shown
    assert lh.latex(loaded) == lh.latex(shown) == "h - e"


def test_a_failing_jacobi_identity_is_shown_by_names() -> None:
    with pytest.raises(lh.JacobiError, match=r"that is for x, y, z: .* = \(1\)\*y, expected 0"):
        lh.LieAlgebra({("x", "y"): {"x": 1}, ("x", "z"): {"y": 1}})
    with pytest.raises(lh.JacobiError, match=r"\(1\)\*e1, expected 0"):
        lh.LieAlgebra({(0, 1): {0: 1}, (0, 2): {1: 1}})
