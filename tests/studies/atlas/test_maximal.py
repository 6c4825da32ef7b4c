"""Maximal subalgebras: counts, maximality of each, controls that are not maximal, compact and complex algebras."""

import pickle
from collections import Counter, defaultdict

import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.exact.algebra.roots.real_form import simple_real_forms
from liehom.studies.atlas.subalgebras import maximal_pairs, parabolic_pairs
from liehom.studies.atlas.symmetric import symmetric_pairs_of

RECIPES = list(maximal_pairs())

# dimensions of the maximal subalgebras of compact algebras, from Dynkin's tables and those of Borel and de Siebenthal
COMPACT = {
    "so(3)": (1,), "su(3)": (3, 4), "su(4)": (6, 7, 9, 10), "su(5)": (10, 12, 16), "so(5)": (3, 4, 6),
    "so(7)": (9, 11, 14, 15), "sp(3)": (3, 6, 9, 13), "so(8)": (8, 12, 13, 16, 21), "g2": (3, 6, 8),
}  # fmt: skip
REDUCIBLE = [
    "sl(2)/so(1,1)", "sl(3)/s(gl(2)+gl(1))", "su(2,2)/sl(2,C)+R", "so(3,2)/so(2,1)+so(1,1)",
    "sl(3,C)/s(gl(2,C)+gl(1,C))", "so(6,1)/so(5)+so(1,1)", "sp(6,R)/gl(3)", "so(5,C)/so(3,C)+so(2,C)",
    "so(7,1)/so(6)+so(1,1)",
]  # fmt: skip


def top(recipe: lh.atlas.Recipe) -> lh.RealForm:
    return lh.RealForm.of_name(recipe.name.split("/")[0].replace("spin", "so"))


def test_numbers_of_pairs() -> None:
    assert Counter(recipe.known["kind"] for recipe in RECIPES) == {"symmetric": 150, "parabolic": 45, "other": 21}
    assert len({recipe.name for recipe in RECIPES}) == len(RECIPES) == 216
    assert {recipe.family for recipe in RECIPES} == {"maximal"} and all(recipe.known["maximal"] for recipe in RECIPES)
    assert {top(recipe).name for recipe in RECIPES} == {form.name for form in simple_real_forms(30)}


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.name)
def test_subalgebra_is_maximal(recipe: lh.atlas.Recipe) -> None:
    pair = recipe.pair()
    assert pair.name == recipe.name and pair.is_primitive() and pair.algebra.real_form() == top(recipe).name
    assert pair.algebra.subalgebra(pair.subalgebra.basis) == pair.subalgebra


@pytest.mark.parametrize("name", REDUCIBLE)
def test_symmetric_subalgebras_with_a_noncompact_centre_are_not_maximal(name: str) -> None:
    (recipe,) = (r for r in symmetric_pairs_of(lh.RealForm.of_name(name.split("/")[0])) if r.name == name)
    assert not recipe.known["maximal"] and not recipe.pair().is_primitive()
    assert name not in {recipe.name for recipe in RECIPES}


def test_parabolic_subalgebras_are_listed_up_to_symmetries() -> None:
    listed = {recipe.name for recipe in RECIPES if recipe.known["kind"] == "parabolic"}
    all_maximal = {recipe.name for recipe in parabolic_pairs() if recipe.known["maximal"]}
    assert all_maximal - listed == {
        *("sl(3)/P{2}", "sl(3,C)/P{2}", "sl(4)/P{3}", "sl(4,C)/P{3}", "sl(5)/P{3}", "sl(5)/P{4}"),
        *("so(4,4)/P{3}", "so(4,4)/P{4}"),
    }
    assert listed < all_maximal


@pytest.mark.parametrize("name", COMPACT)
def test_compact_algebras(name: str) -> None:
    recipes = [recipe for recipe in RECIPES if top(recipe).name == name]
    assert tuple(sorted(recipe.pair().subalgebra.dimension for recipe in recipes)) == COMPACT[name]


def test_reductive_subalgebras_are_real_forms_of_those_of_the_compact_algebra() -> None:
    found = defaultdict(set)
    for recipe in RECIPES:
        form = top(recipe)
        if recipe.known["kind"] != "parabolic" and not form.is_complex:
            found[form.type].add(form.dimension - recipe.pair().dimension)
    assert found == {lh.RealForm.of_name(name).type: set(dimensions) for name, dimensions in COMPACT.items()}


def test_complex_algebras_contain_their_real_forms_and_semisimple_complex_subalgebras() -> None:
    for form in simple_real_forms(30):
        if not form.is_complex:
            continue
        own = [recipe for recipe in RECIPES if top(recipe) == form and recipe.known["kind"] != "parabolic"]
        compact = [recipe.pair().subalgebra for recipe in RECIPES if top(recipe) == lh.real_forms(form.type)[-1]]
        semisimple = [h for h in compact if h.as_algebra().is_semisimple() and h.dimension]
        assert len(own) == len(lh.real_forms(form.type)) + len(semisimple)


def test_list_ends_at_dimension_30() -> None:
    with pytest.raises(InputError, match="complete up to dimension 30"):
        next(maximal_pairs(31))
    assert not list(maximal_pairs(2))


def test_recipes_can_be_pickled() -> None:
    for recipe in RECIPES[::90] + [recipe for recipe in RECIPES if recipe.known["kind"] == "other"][::9]:
        assert pickle.loads(pickle.dumps(recipe)).pair() == recipe.pair()
