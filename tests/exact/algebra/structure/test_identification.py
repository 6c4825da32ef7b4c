"""Every simple real algebra of dimension at most 78, in random rational bases, is called by its name."""

import random
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.roots.real_form import RealForm, complex_form, real_forms
from liehom.exact.algebra.structure.identification import simple_parts, small_name
from liehom.testing import random_unimodular

TYPES = [
    *(f"A{n}" for n in range(1, 8)), *(f"B{n}" for n in range(2, 7)), *(f"C{n}" for n in range(3, 7)),
    *(f"D{n}" for n in range(4, 7)), "G2", "F4", "E6",
]  # fmt: skip
FORMS = {
    form.name: form
    for type_name in TYPES
    for form in (*real_forms(type_name), complex_form(type_name))
    if form.dimension <= 78
}
QUICK = 24  # dimension


def rational_scramble(algebra: LieAlgebra, seed: int) -> LieAlgebra:
    """A random basis with small entries, some rows divided by 2 or 3."""
    n, rng = algebra.dimension, random.Random(seed)
    rows: list[list[Any]] = [list(row) for row in random_unimodular(n, rng, 2 * n)]
    for i in rng.sample(range(n), max(1, n // 8)):
        divisor = rng.choice([2, 3])
        rows[i] = [lh.QQ.convert(x) / divisor for x in rows[i]]
    return algebra.change_of_basis(rows)


def cases() -> list[Any]:
    marks = {name: [] if form.dimension <= QUICK else [pytest.mark.slow] for name, form in FORMS.items()}
    return [pytest.param(name, id=name, marks=marks[name]) for name in FORMS]


@pytest.mark.parametrize("name", cases())
def test_the_real_form_is_named(name: str) -> None:
    form = FORMS[name]
    g = rational_scramble(lh.simple(form.type, name), form.dimension)
    assert g.real_form() == name
    copies = 2 if form.is_complex else 1
    assert g.semisimple_type() == " + ".join([form.type] * copies)
    assert g.real_rank() == form.real_rank and g.is_simple()


@pytest.mark.parametrize("name", ["so(4,1)", "so(7)", "sp(2,1)", "f4(-20)", "su(3,1)"])
def test_in_a_basis_with_large_denominators(name: str) -> None:
    g = lh.simple(RealForm.of_name(name).type, name)
    n, rng = g.dimension, random.Random(7)
    rows = [[rng.randint(-2, 2) + 7 * (i == j) for j in range(n)] for i in range(n)]
    if n < 30:
        assert g.change_of_basis(rows).real_form() == name
    else:
        assert rational_scramble(g, 3).real_form() == name


@pytest.mark.parametrize(("algebra", "name"), [
    (lh.so(4), "so(3) + so(3)"), (lh.so(2, 2), "sl(2,R) + sl(2,R)"), (lh.so(3, 1), "sl(2,C)"),
    (lh.so(5, 1), "sl(2,H)"), (lh.so(4, 2), "su(2,2)"), (lh.sp(4, "R"), "so(3,2)"), (lh.algebra.so_star(3), "su(3,1)"),
    (lh.algebra.so_star(4), "so(6,2)"), (lh.gl(3, "H"), "sl(3,H)"),
    (lh.direct_sum(lh.so(3), lh.so(5)), "so(3) + so(5)"),
    (lh.direct_sum(lh.sl(2), lh.so(3), lh.so(4, 1)), "so(3) + sl(2,R) + so(4,1)"),
    (lh.euclidean(4), "so(3) + so(3)"), (lh.so(3).over(lh.number_field("sqrt(2)")), "so(3)"),
], ids=lambda x: x if isinstance(x, str) else "")  # fmt: skip
def test_coincidences_and_sums(algebra: LieAlgebra, name: str) -> None:
    assert algebra.real_form() == name
    assert rational_scramble(algebra, 11).real_form() == name


def test_isomorphism_over_the_reals() -> None:
    assert rational_scramble(lh.so(4, 2), 1).is_isomorphic(rational_scramble(lh.su(2, 2), 2))
    assert not lh.so(4, 2).is_isomorphic(lh.so(5, 1))
    assert not lh.so(5).is_isomorphic(lh.so(4, 1))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["so*(18)", "so(12,6)"])
def test_real_forms_with_equal_killing_signature_raise_undecided_error(name: str) -> None:
    with pytest.raises(UndecidedError, match=r"so\(12,6\) and so\*\(18\)"):
        lh.simple("D9", name).real_form()


def test_number_of_simple_ideals_over_the_complex_numbers() -> None:
    (part,) = simple_parts(lh.so(3, 1))
    assert part.centroid.degree == 2 and part.type == "A1"
    assert [place.kind for place in part.places] == ["complex"]


def test_small_algebras_have_a_name_up_to_dimension_6() -> None:
    algebras = (lh.low_dimensional(6, 3), lh.low_dimensional(5, 1), lh.so(4), lh.heisenberg(3), lh.abelian(7))
    assert [small_name(algebra) for algebra in algebras] == ["A6,3", "A5,1", "A3,9+A3,9", "", ""]
