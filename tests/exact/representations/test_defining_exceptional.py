"""The defining representations of exceptional real forms: every form of every type has one, of the known dimension."""

import pytest

import liehom as lh
from liehom.base.errors import RepresentationError

DIMENSIONS = {
    "G2": {"g2(2)": 7, "g2": 7}, "F4": {"f4(4)": 27, "f4(-20)": 27, "f4": 27},
    "E6": {"e6(6)": 27, "e6(2)": 54, "e6(-14)": 54, "e6(-26)": 27, "e6": 54},
    "E7": {"e7(7)": 56, "e7(-5)": 112, "e7(-25)": 56, "e7": 112}, "E8": {"e8(8)": 248, "e8(-24)": 248, "e8": 248},
}  # fmt: skip
CASES = [(kind, name) for kind, forms in DIMENSIONS.items() for name in forms]


@pytest.mark.parametrize(("kind", "name"), CASES)
def test_every_exceptional_form_has_a_defining_representation(kind: str, name: str) -> None:
    assert [form.name for form in lh.real_forms(kind)] == list(DIMENSIONS[kind])
    algebra = lh.simple(kind, name)
    rho = lh.defining(algebra)
    assert rho.algebra is algebra and rho.size == DIMENSIONS[kind][name]


def test_a_name_alone_is_understood() -> None:
    assert lh.defining("e7(-25)").size == 56


@pytest.mark.slow
def test_a_larger_field_is_understood() -> None:
    over = lh.defining(lh.simple("E6", "e6(2)").over(lh.number_field("sqrt(2)")))
    assert over.field.name == "QQ(sqrt(2))"


def test_another_basis_is_refused() -> None:
    moved = lh.simple("E6", "e6(-14)")
    doubled = lh.LieAlgebra(
        {(i, j): {k: 2 * v} for i, j, k, v in moved.structure_constants()}, dimension=78, name=moved.name, check=False
    )
    with pytest.raises(RepresentationError, match="basis"):
        lh.defining(doubled)


def test_the_adjoint_matrices_are_those_of_ad_with_fractions_too() -> None:
    moved = lh.so(4).change_of_basis([[int(i == j) * (i + 2) + int(j > i) for j in range(6)] for i in range(6)])
    assert moved.table.den > 1
    for algebra in (moved, lh.abelian(3), lh.abelian(0), lh.simple("G2", "g2")):
        units = [[int(i == j) for j in range(algebra.dimension)] for i in range(algebra.dimension)]
        assert list(lh.adjoint(algebra).matrices) == [algebra.ad(unit) for unit in units]
