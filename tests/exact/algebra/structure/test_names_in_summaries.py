"""`describe` names an algebra in both ways where its name and its canonical name are of isomorphic algebras."""

import pytest

import liehom as lh

COINCIDENCES = {
    "so(3)": ["su(2)", "sp(1)"], "sl(2,R)": ["so(2,1)", "su(1,1)", "sp(2,R)"], "sl(2,C)": ["so(3,1)", "so(3,C)"],
    "so(5)": ["sp(2)"], "so(4,1)": ["sp(1,1)"], "so(3,2)": ["sp(4,R)"], "su(4)": ["so(6)"], "sl(2,H)": ["so(5,1)"],
    "su(2,2)": ["so(4,2)"], "sl(4,R)": ["so(3,3)"], "su(3,1)": ["so*(6)"], "so(6,2)": ["so*(8)"],
    "so(3) + so(3)": ["so(4)"], "so(3) + sl(2,R)": ["so*(4)"], "sl(2,R) + sl(2,R)": ["so(2,2)"],
}  # fmt: skip


@pytest.mark.parametrize(("canonical", "other"), [(c, o) for c, others in COINCIDENCES.items() for o in others])
def test_both_names_are_said(canonical: str, other: str) -> None:
    g = lh.catalog.algebra(other)
    title, line, *_ = g.describe().splitlines()
    assert title == f"{other} = {canonical}, dimension {g.dimension} over QQ" and f"real form {canonical}, rank" in line
    assert g.real_form() == canonical == lh.canonical_real_form(other)


@pytest.mark.parametrize("name", ["so(3)", "sl(2)", "sl(2,C)", "so(5)", "su(4)", "so(4,1)", "g2", "so(3)+so(3)"])
def test_one_name_is_said_once(name: str) -> None:
    assert " = " not in lh.catalog.algebra(name).describe()


@pytest.mark.parametrize("name", [None, "rotations", "su(3)", "so(2)", "so(" + "9" * 5000 + ")", "R^2"])
def test_names_that_denote_another_algebra_are_not_said(name: str | None) -> None:
    g = lh.LieAlgebra(lh.so(3).table, name=name)
    assert "real form so(3), rank 1" in g.describe() and " = " not in g.describe()


def test_the_levi_factor_has_its_canonical_name() -> None:
    assert "Levi factor: simple, real form so(3), rank 1" in lh.u(2).describe()
