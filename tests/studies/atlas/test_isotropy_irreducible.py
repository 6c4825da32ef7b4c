"""Isotropy-irreducible pairs: irreducible, not symmetric, with the algebras that their names say."""

import re

import pytest

import liehom as lh
from liehom.exact.algebra.roots.real_form import canonical_ideals, join_real_forms
from liehom.studies.atlas.irreducible import (
    _of_catalogue as named_pair_of_row,
    _rows,
    complexified,
    isotropy_irreducible_pair,
    isotropy_irreducible_pairs,
    module_pair,
)
from liehom.studies.atlas.symmetric import symmetric_rank

RECIPES = {recipe.name: recipe for recipe in isotropy_irreducible_pairs()}
WOLF = {
    "g2/su(3)": 6, "sp(2)/S3(su(2))": 7, "so(7)/g2": 7, "g2/principal(so(3))": 11, "sp(3)/tensor(sp(1),so(3))": 15,
    "so(8)/ad(su(3))": 20, "su(6)/tensor(su(2),su(3))": 24, "sp(4)/tensor(sp(1),so(4))": 27, "su(6)/S2(su(3))": 27,
}  # fmt: skip
"""The compact pairs of dimension at most 34, with the dimension of g/h."""


def test_compact_pairs_are_those_of_wolf():
    assert [name for name, recipe in RECIPES.items() if recipe.known["compact"]] == list(WOLF)
    assert all(RECIPES[name].pair().dimension == d for name, d in WOLF.items())
    assert len(RECIPES) == len(list(isotropy_irreducible_pairs(34))) == 34


def test_the_dimension_of_each_row_is_that_of_the_names():
    """Other real forms and complexifications follow the compact pairs; the rows are read again."""
    rows = {row.name: row for row in _rows()}
    assert rows.keys() == RECIPES.keys()
    for name, row in rows.items():
        top, bottom = name.split("/")
        inner = re.sub(r"^(ad|S2|S3|tensor|herm|principal)\((.*)\)$", r"\2", bottom)
        ideals = [
            lh.RealForm.of_name(x) for t in re.findall(r"[a-z]+\d?(?:\([^()]*\))?", inner) for x in canonical_ideals(t)
        ]
        above = lh.RealForm.of_name(top.replace("spin", "so"))
        assert row.dimension == above.dimension - sum(form.dimension for form in ideals)
        assert row.compact == above.is_compact
        if row.build is named_pair_of_row:
            assert row.argument == name


@pytest.mark.parametrize("name", RECIPES)
def test_pair_is_irreducible_not_symmetric_and_has_the_algebras_of_its_name(name):
    pair = RECIPES[name].pair()
    assert pair.name == name and pair.isotropy_representation().is_irreducible()
    with pytest.raises(lh.errors.InputError, match=re.escape("[q, q] is not in h")):
        symmetric_rank(pair)
    top, bottom = name.split("/")
    inner = re.sub(r"^(ad|S2|S3|tensor|herm|principal)\((.*)\)$", r"\2", bottom)
    ideals = [ideal for term in re.findall(r"[a-z]+\d?(?:\([^()]*\))?", inner) for ideal in canonical_ideals(term)]
    assert pair.algebra.real_form() == lh.canonical_real_form(top.replace("spin", "so"))
    assert pair.subalgebra.as_algebra().real_form() == join_real_forms(ideals)
    assert (pair.algebra.killing_signature()[0] == 0) == RECIPES[name].known["compact"]
    assert lh.decide_fullness(pair).full == (name in ("g2/su(3)", "so(7)/g2"))
    # the Jacobi identity and closure, also of complexifications, which are constructed without these proofs
    lh.Pair(lh.LieAlgebra(pair.algebra.table), pair.subalgebra.basis)


def test_other_real_forms_and_complexifications_are_reducible():
    """Negative controls: V is a sum of two modules over C, and conjugation preserves both."""
    pair = module_pair("so(5,3)/ad(sl(3))", "sl(3,R)", (1, 1))
    assert pair.algebra.real_form() == "so(5,3)" and not pair.isotropy_representation().is_irreducible()
    assert not lh.pair("g2(2)/sl(3)").isotropy_representation().is_irreducible()
    assert not complexified(lh.pair("g2(2)/su(2,1)"), "g2(C)/sl(3,C)").isotropy_representation().is_irreducible()


def test_unknown_names_and_dimensions_are_refused():
    with pytest.raises(lh.errors.CatalogError, match="is not in the list"):
        isotropy_irreducible_pair("so(8)/su(3)")
    with pytest.raises(lh.errors.InputError, match="found max_dimension = 35"):
        next(isotropy_irreducible_pairs(35))
