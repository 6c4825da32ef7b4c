"""Affine pairs: the transitive rows, the modules beyond with their commutants and scalars, verdicts."""

import pickle
from collections import Counter

import pytest

import liehom as lh
from liehom.exact.catalog.names import parse
from liehom.studies.atlas.affine import _catalogue_name, _modules, _transitive_names, affine_pairs, module_pair

RECIPES = {recipe.name: recipe for recipe in affine_pairs()}
BEYOND = {name: recipe for name, recipe in RECIPES.items() if not recipe.known["transitive"]}
MODULES = _modules()[:200]
SMALL = [module for module in MODULES if module.algebra_dimension < 30]
NAMED = [module for module in MODULES if _catalogue_name(module)]


def test_rows_of_each_dimension_are_those_of_the_classification():
    counts = [len(list(_transitive_names(d))) for d in (*range(2, 11), 12, 16)]
    assert counts == [5, 4, 16, 4, 16, 6, 37, 4, 16, 35, 39]


def test_numbers_of_pairs_and_modules():
    assert len(RECIPES) == len(list(affine_pairs())) == 940 and len(BEYOND) == 730
    assert Counter(module.commutant for module in MODULES) == {"R": 132, "C": 52, "H": 16}
    assert _modules.__wrapped__()[:200] == MODULES  # found again, as all names of modules depend on it
    assert all(str(parse(name)) == name for name, recipe in RECIPES.items() if recipe.make is lh.pair)


def test_number_of_modules_is_limited():
    with pytest.raises(lh.errors.InputError, match="found modules = 1000"):
        list(affine_pairs(1, 1000))


def test_recipes_can_be_pickled():
    recipe = RECIPES["affine(V(1,1) of su(2,1)+R)"]
    assert pickle.loads(pickle.dumps(recipe)).pair() == recipe.pair()


@pytest.mark.parametrize("module", SMALL[::9], ids=str)
def test_modules_are_irreducible_with_their_commutant(module):
    _check(module, module_pair("one", module.form, module.weight))


@pytest.mark.parametrize("module", [m for m in NAMED if m in SMALL][::4], ids=str)
def test_catalogue_names_denote_the_module(module):
    _check(module, lh.pair(f"affine({_catalogue_name(module)})"))


@pytest.mark.slow
def test_all_modules_are_irreducible_and_all_names_denote_them():
    for module in MODULES:
        _check(module, module_pair("one", module.form, module.weight))
    for module in NAMED:
        _check(module, lh.pair(f"affine({_catalogue_name(module)})"))


def _check(module, pair):
    representation = pair.isotropy_representation()
    assert representation.is_irreducible() and representation.commutant_type() == module.commutant
    assert (pair.dimension, pair.subalgebra.dimension) == (module.dimension, module.algebra_dimension)
    assert pair.subalgebra.as_algebra().real_form() == module.form


def test_a_module_and_its_dual_are_listed_once():
    listed = {(module.form, module.weight) for module in MODULES}
    duals = [
        (m.form, lh.representations.dual_weight(lh.RealForm.of_name(m.form).vogan.root_system(), m.weight))
        for m in MODULES
    ]
    assert all(dual == (m.form, m.weight) or dual not in listed for dual, m in zip(duals, MODULES, strict=True))
    assert any(dual != (m.form, m.weight) for dual, m in zip(duals, MODULES, strict=True))


@pytest.mark.parametrize(
    ("name", "dimension", "commutant"),
    [
        ("affine(V(3) of so(3))", 3, 4), ("affine(V(3) of so(3)+R)", 4, 4), ("affine(V(3) of so(3)+u(1)+R)", 5, 2),
        ("affine(V(3) of so(3)+sp(1))", 6, 1), ("affine(V(2,0) of su(3)+u(1))", 9, 2),
        ("affine(V(2,0) of su(3)+u(1)+R)", 10, 2),
    ],
)  # fmt: skip
def test_scalars_are_those_of_the_name(name, dimension, commutant):
    pair = RECIPES[name].pair()
    assert pair.subalgebra.dimension == dimension and len(pair.isotropy_representation().commutant()) == commutant
    lh.LieAlgebra(pair.algebra.table)  # the Jacobi identity


def test_transitive_pairs_are_full_and_a_module_beyond_is_not():
    assert all(lh.decide_fullness(lh.pair(name)).full for d in (2, 3, 4) for name in _transitive_names(d))
    assert not any(lh.decide_fullness(recipe.pair()).full for recipe in list(BEYOND.values())[:12])
