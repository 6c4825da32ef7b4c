"""Numbers of fields with several square roots are printed in these roots; files keep powers of the generator."""

import pickle

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import JacobiError, NotASubalgebraError, StructureError
from liehom.exact.scalars.number_fields import common_field
from tests.sampling import examples

TWO_THREE = common_field(["sqrt(2)", "sqrt(3)"])
rationals = st.fractions(-9, 9, max_denominator=12)


def test_square_roots_are_printed_as_square_roots() -> None:
    g = lh.LieAlgebra({(0, 1): {1: "sqrt(2)"}, (0, 2): {2: "sqrt(3)/2 + sqrt(2)"}})
    assert "[e0, e1] = sqrt(2)*e1" in str(g)
    assert "[e0, e2] = (sqrt(2) + 1/2*sqrt(3))*e2" in str(g)
    assert str(TWO_THREE.convert("1/sqrt(6)")) == "1/6*sqrt(6)"
    assert str(TWO_THREE.matrix([["sqrt(8)", "-1 - sqrt(3)", 2]])) == "[2*sqrt(2), -1 - sqrt(3), 2]"
    assert "(1, sqrt(3), 0)" in str(g.over(g.field).subalgebra([[1, "sqrt(3)", 0]]))


def test_files_are_as_before() -> None:
    g = lh.LieAlgebra({(0, 1): {1: "sqrt(2)"}, (0, 2): {2: "sqrt(3)"}})
    assert lh.to_json(g)["structure_constants"] == [[0, 1, 1, "-9/2*a + 1/2*a**3"], [0, 2, 2, "11/2*a - 1/2*a**3"]]
    assert TWO_THREE.matrix([["sqrt(2)"]]).to_strings() == [["-9/2*a + 1/2*a**3"]]
    assert lh.from_json(lh.to_json(g)) == g


@given(st.lists(rationals, min_size=4, max_size=4))
@settings(max_examples=examples(60), deadline=None)
def test_what_is_printed_is_the_number(values: list[object]) -> None:
    field = TWO_THREE
    number = sum(c * field.convert(r) for c, r in zip(values, ("1", "sqrt(2)", "sqrt(3)", "sqrt(6)"), strict=True))
    assert field.convert(str(number)) == number == field.convert(field.format(number))


@pytest.mark.parametrize(("field", "text", "printed"), [
    (lh.number_field("sqrt(2) + sqrt(3)"), "sqrt(3)", "sqrt(3)"),
    (lh.number_field("sqrt(12) + sqrt(18)"), "sqrt(2)*sqrt(3)", "sqrt(6)"),
    (common_field(["sqrt(6)", "sqrt(10)"]), "sqrt(15)", "sqrt(15)"),
    (common_field(["sqrt(2)", "sqrt(3)", "sqrt(5)"]), "sqrt(30)/7", "1/7*sqrt(30)"),
    (lh.number_field("sqrt(2)"), "1/sqrt(2)", "1/2*sqrt(2)"),
    (lh.number_field("sqrt(2 + sqrt(2))"), "sqrt(2)", "-2 + a**2"),
    (lh.number_field([-1, -1, 0, 1], (1, 2), name="p"), "p + 1", "1 + p"),
])  # fmt: skip
def test_fields(field: lh.scalars.NumberField, text: str, printed: str) -> None:
    assert str(field.convert(text)) == printed
    again = pickle.loads(pickle.dumps(field))
    assert again == field and str(again.convert(text)) == printed


def test_roots_that_are_not_a_basis_are_not_used() -> None:
    field = lh.scalars.NumberField("a", [1, 0, -10, 0, 1], (3, 4), radicals=[2])
    assert field.radicals == () and str(field.generator) == "a"


def test_messages_show_square_roots() -> None:
    with pytest.raises(StructureError, match=r"c\[0, 1, 0\] = sqrt\(2\) but c\[1, 0, 0\] = sqrt\(3\)"):
        lh.LieAlgebra({(0, 1): {0: "sqrt(2)"}, (1, 0): {0: "sqrt(3)"}})
    with pytest.raises(JacobiError, match=r"\(-sqrt\(6\)\)\*e2|\(sqrt\(6\)\)\*e2"):
        lh.LieAlgebra({(0, 1): {0: "sqrt(2)"}, (0, 2): {2: "sqrt(3)"}})
    g = lh.LieAlgebra({(0, 1): {2: "sqrt(2) + sqrt(3)"}})
    with pytest.raises(NotASubalgebraError, match=r"\(0, 0, sqrt\(2\) \+ sqrt\(3\)\)"):
        g.subalgebra([[1, 0, 0], [0, 1, 0]])


def test_the_bracket_of_an_element_with_itself_is_named() -> None:
    with pytest.raises(StructureError, match=r"c\[0, 0, 0\] = 1 is the coefficient of e0 in \[e0, e0\], expected 0"):
        lh.LieAlgebra({(0, 0): {0: 1}})
