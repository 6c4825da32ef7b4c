"""The family of parabolic pairs: complete by the real rank, dimensions by the grading, names of the catalogue."""

from collections import Counter

import pytest

import liehom as lh
from liehom.exact.algebra.roots.real_form import simple_real_forms
from liehom.studies.atlas.subalgebras import parabolic_pairs, parabolic_pairs_of

RECIPES = list(parabolic_pairs(30))
DEPTHS = {
    "sl(5)/P{1,2,3,4}": 4, "su(2,1)/P{1,2}": 2, "su(2,2)/P{2}": 1, "so(4,3)/P{2}": 2, "so(7,1)/P{1}": 1,
    "sp(6,R)/P{3}": 1, "sp(2,1)/P{2}": 2, "so(4,4)/P{2}": 2, "so(4,4)/P{1,2,3,4}": 5, "g2(2)/P{1}": 3,
    "g2(2)/P{1,2}": 5, "sl(2,C)/P{1}": 1,
}  # fmt: skip


def test_every_simple_real_algebra_has_a_parabolic_subalgebra_for_each_set_of_simple_restricted_roots() -> None:
    counts = Counter(recipe.name.split("/")[0] for recipe in RECIPES)
    expected = [2**form.real_rank - 1 for form in simple_real_forms(30) if form.real_rank]
    assert sorted(counts.values()) == sorted(expected) and sum(expected) == len(RECIPES) == 105
    assert len({recipe.name for recipe in RECIPES}) == 105
    assert len(list(parabolic_pairs(8))) == 6 and not list(parabolic_pairs(2))


def test_simple_real_algebras_up_to_dimension_30() -> None:
    forms = list(simple_real_forms(30))
    assert max(form.dimension for form in forms) == 30 and len(forms) == len({form.name for form in forms}) == 36
    assert [form.name for form in forms if form.is_complex] == ["sl(2,C)", "sl(3,C)", "sl(4,C)", "so(5,C)", "g2(C)"]
    by_type = Counter(form.type for form in forms if not form.is_complex)
    assert by_type == {"A1": 2, "A2": 3, "A3": 5, "A4": 4, "B2": 3, "B3": 4, "C3": 3, "D4": 5, "G2": 2}


@pytest.mark.parametrize("recipe", RECIPES[::6], ids=lambda recipe: recipe.name)
def test_pairs_have_the_dimension_of_the_grading(recipe: lh.atlas.Recipe) -> None:
    pair = recipe.pair()
    assert pair.name == recipe.name and pair.dimension == recipe.known["codimension"]
    g, h = pair.algebra, pair.subalgebra
    nilradical = g.subalgebra((g.killing_form() @ h.basis.T).T.null_space())
    assert len(nilradical.as_algebra().lower_central_series()) - 1 == recipe.known["depth"]
    assert g.subalgebra(h.basis) == h


def test_depths() -> None:
    found = {recipe.name: recipe.known["depth"] for recipe in RECIPES}
    assert {name: found[name] for name in DEPTHS} == DEPTHS


def test_maximal_ones_have_one_crossed_restricted_root() -> None:
    names = [recipe.name for recipe in parabolic_pairs_of(lh.RealForm.of_name("e6(2)")) if recipe.known["maximal"]]
    assert names == ["e6(2)/P{1,6}", "e6(2)/P{2}", "e6(2)/P{3,5}", "e6(2)/P{4}"]
    assert not list(parabolic_pairs_of(lh.RealForm.of_name("f4")))


def test_full_ones_are_projective_spaces_and_conformal_spheres() -> None:
    full = [recipe.name for recipe in parabolic_pairs(16) if lh.decide_fullness(recipe.pair()).full]
    spheres = ["sl(2)/P{1}", "sl(2,C)/P{1}", "so(4,1)/P{1}", "sl(2,H)/P{2}"]
    spaces = ["sl(3)/P{1}", "sl(3)/P{2}", "sl(4)/P{1}", "sl(4)/P{3}"]
    assert sorted(full) == sorted(spheres + spaces + ["sl(3,C)/P{1}", "sl(3,C)/P{2}"])
