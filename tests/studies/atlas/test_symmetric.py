"""Symmetric pairs: names, dimensions, the identification of h, rank, agreement with the catalogue."""

import pickle
import re
from collections import Counter

import numpy as np
import pytest

import liehom as lh
from liehom.exact.algebra.roots.chevalley import RootAutomorphism
from liehom.exact.algebra.roots.real_form import canonical_ideals, join_real_forms
from liehom.exact.algebra.roots.real_form_involutions import involution_type
from liehom.exact.catalog.names import parse
from liehom.studies.atlas.symmetric import group_pairs, symmetric_pair, symmetric_pairs, symmetric_rank

RECIPES = {recipe.name: recipe for recipe in symmetric_pairs()}
SMALL = [
    name
    for name, recipe in RECIPES.items()
    if re.match(r"(s[lu]\((2|3|2,1)(,C)?\)|so\((3|5|4,1|3,2)(,C)?\)|g2.*)/", name)
]
SAMPLE = ["su(2,2)/sl(2,C)+R", "so(6,2)/u(3,1)", "sp(8,R)/sp(4,C)", "sp(2,2)/gl(2,H)", "f4(4)/sp(6,R)+sl(2)"]


def test_numbers_of_pairs_and_names():
    assert len(RECIPES) == 473 and sum(recipe.make is symmetric_pair for recipe in RECIPES.values()) == 301
    assert len(SMALL) == len(list(symmetric_pairs(2, 0))) == 41
    assert Counter(recipe.known["rank"] for recipe in RECIPES.values()) == {1: 240, 2: 89, 3: 61, 4: 73, 6: 5, 8: 5}
    assert all(str(parse(name)) == name for name in RECIPES)


def test_the_rank_is_limited():
    with pytest.raises(lh.errors.InputError, match="found max_rank = 5"):
        next(symmetric_pairs(5))


def test_recipes_can_be_pickled():
    recipe = RECIPES["su(2,2)/so*(4)"]
    assert pickle.loads(pickle.dumps(recipe)).pair() == recipe.pair()


@pytest.mark.parametrize("name", SMALL + SAMPLE)
def test_pair_is_the_one_that_its_name_and_its_involution_say(name):
    _check(RECIPES[name])


@pytest.mark.slow
def test_pairs_of_all_ranks_are_those_that_their_names_and_involutions_say():
    for name, recipe in RECIPES.items():
        if recipe.make is symmetric_pair and name not in SMALL + SAMPLE:
            _check(recipe)


@pytest.mark.slow
def test_pairs_of_rank_one_beyond_are_symmetric_of_rank_one():
    for recipe in RECIPES.values():
        if recipe.make is not symmetric_pair:
            pair = recipe.pair()
            assert symmetric_rank(pair) == 1 and _satisfies_range_condition(pair)
            positive = (pair.subalgebra.basis @ pair.algebra.killing_form() @ pair.subalgebra.basis.T).signature()[0]
            assert recipe.known["riemannian"] == (positive == 0)


def _check(recipe):
    pair = recipe.pair()
    algebra, isotropy = pair.algebra, pair.subalgebra
    top, bottom = recipe.name.split("/")
    assert algebra.killing_signature() == _signature(lh.RealForm.of_name(top))
    basis = isotropy.basis
    positive, negative, zero = (basis @ algebra.killing_form() @ basis.T).signature()
    assert zero == 0
    if recipe.make is symmetric_pair:
        _, form, images, exponents = recipe.arguments
        real = lh.RealForm.of_name(form)
        kind = involution_type(real, RootAutomorphism(real.vogan.type, images, exponents))
        assert (kind.noncompact, kind.compact) == (positive, negative)
    assert recipe.known["riemannian"] == (positive == 0) and symmetric_rank(pair) == recipe.known["rank"]
    assert _satisfies_range_condition(pair) == (recipe.known["rank"] == 1)
    ideals, center = _ideals(bottom)
    inner = isotropy.as_algebra()
    assert inner.center().dimension == center and inner.real_form() == join_real_forms(ideals)
    # the table of a constructed pair satisfies the Jacobi identity, and h is closed
    lh.Pair(lh.LieAlgebra(algebra.table), isotropy.basis)


def _satisfies_range_condition(pair):
    """Whether [h, eta] + R eta = q for one of three random eta, which is then so for generic eta."""
    matrices = pair.isotropy_matrices()
    for eta in np.random.default_rng(1).integers(-9, 10, (3, pair.dimension, 1)):
        column = pair.field.matrix(eta.tolist())
        rows = pair.field.stack_rows([column.T, *((m @ column).T for m in matrices)], pair.dimension)
        if rows.rank() == pair.dimension:
            return True
    return False


def _signature(form):
    return form.dimension - form.compact_dimension, form.compact_dimension, 0


def _ideals(name):
    """The canonical names of the simple ideals of h, and the dimension of its centre, read from its name."""
    traceless = name.startswith("s(")
    ideals, center = [], 0
    for term in re.findall(r"[a-z]+\d?\*?(?:\([^()]*\))?|R", name[2:-1] if traceless else name):
        if term in ("R", "u(1)", "so(2)", "so(1,1)"):
            center += 1
        elif term == "so(2,C)":
            center += 2
        elif term[0] == "u" or term[:2] == "gl":
            center += 2 if term.endswith("C)") else 1
            linear = "s" + (term if term[0] == "u" else term[1:])
            if not re.fullmatch(r"s[ul]\((1|0,1)(,[RC])?\)", linear):
                ideals += canonical_ideals(linear)
        else:
            ideals += canonical_ideals(term)
    return ideals, center - traceless * (2 if name.endswith("C))") else 1)


def test_a_wrong_name_is_noticed():
    recipe = RECIPES["su(2,2)/so*(4)"]
    wrong = lh.atlas.Recipe("su(2,2)/so(2,2)", "symmetric", symmetric_pair, recipe.arguments, recipe.known)
    with pytest.raises(AssertionError):
        _check(wrong)


@pytest.mark.parametrize("name", ["so(5)/so(3)", "iso(3,1)/so(3,1)", "g2/su(3)", "sl(3)/P1", "so(4)/0"])
def test_rank_is_refused_for_pairs_that_are_not_symmetric(name):
    with pytest.raises(lh.errors.InputError, match="expected a symmetric pair"):
        symmetric_rank(lh.pair(name))


def test_group_pairs_have_the_rank_of_the_algebra():
    recipes = list(group_pairs(2))
    assert len(recipes) == 2 + 3 + 3 + 2
    for recipe in recipes:
        pair = recipe.pair()
        assert pair.subalgebra.as_algebra().real_form() == lh.canonical_real_form(recipe.name.split("+")[0])
        assert symmetric_rank(pair) == recipe.known["rank"]
    assert len(list(group_pairs())) == 43
