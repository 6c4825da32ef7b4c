"""Recipes of pairs."""

import pickle
from functools import partial

import pytest

import liehom as lh


def sphere(n: int) -> lh.Pair:
    return lh.pair(f"so({n + 1})/so({n})")


def test_a_recipe_constructs_its_pair_after_a_trip_through_pickle() -> None:
    recipe = lh.atlas.Recipe("so(6)/so(5)", "spheres", sphere, (5,), {"rank": 1})
    again = pickle.loads(pickle.dumps(recipe))
    assert again == recipe and hash(again) == hash(recipe) and again.known == {"rank": 1}
    assert again.pair().dimension == 5


def test_the_key_depends_on_function_and_arguments_alone() -> None:
    first = lh.atlas.Recipe("so(6)/so(5)", "spheres", sphere, (5,))
    assert first.key == lh.atlas.Recipe("S^5", "symmetric", sphere, (5,), {"rank": 1}).key
    assert len({first.key, lh.atlas.Recipe("S", "s", sphere, ("5",)).key, lh.atlas.Recipe("S", "s", lh.pair).key}) == 3


@pytest.mark.parametrize("make", [partial(sphere, 3), lambda: sphere(3), "sphere", lh.LieAlgebra.subalgebra])
def test_a_function_that_cannot_be_pickled_by_name_raises(make: object) -> None:
    with pytest.raises(lh.errors.InputError, match="at the level of a module"):
        lh.atlas.Recipe("so(4)/so(3)", "spheres", make)  # type: ignore[arg-type]


def test_a_recipe_without_a_name_raises() -> None:
    with pytest.raises(lh.errors.InputError, match="a name and a family"):
        lh.atlas.Recipe("", "spheres", sphere, (3,))


def test_what_is_not_a_pair_raises() -> None:
    with pytest.raises(lh.errors.InputError, match="expected a Pair"):
        lh.atlas.Recipe("so(3)", "spheres", lh.so, (3,)).pair()  # type: ignore[arg-type]
