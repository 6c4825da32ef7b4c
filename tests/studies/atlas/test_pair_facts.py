"""Facts about decided pairs."""

import time

import pytest

import liehom as lh
from liehom.base.budget import in_time
from liehom.base.errors import LimitError, UndecidedError
from liehom.studies.atlas.entry import _in, facts as facts_of


@pytest.mark.parametrize(
    ("name", "holds", "dimension", "degree", "orbits"),
    [
        ("so(7)/so(6)", True, 6, 2, 1), ("so(3,1)/so(2,1)", True, 3, 2, 3), ("sl(2,C)/P1", True, 2, 2, 1),
        ("sl(3)/so(3)", False, 4, None, 0), ("sl(2)/P1", True, 1, 1, 2), ("so(3)/so(3)", True, 0, None, 1),
    ],
)  # fmt: skip
def test_facts_of_known_pairs(name: str, holds: bool, dimension: int, degree: int | None, orbits: int) -> None:
    pair = lh.pair(name)
    found = facts_of(pair, lh.decide_fullness(pair))
    assert (found["range_condition"], found["orbit_dimension"]) == (holds, dimension)
    assert (found["invariant_degree"], found["open_orbits"]) == (degree, orbits) and found["missing"] == {}


def test_the_facts_of_a_full_pair_agree_with_their_computation() -> None:
    for name in ("so(5)/so(4)", "sl(4)/P1", "su(3)/u(2)", "affine(sl(2,C))", "sl(3,C)/P1"):
        pair = lh.pair(name)
        found = facts_of(pair, lh.decide_fullness(pair))
        assert found["orbit_dimension"] == lh.orbits.orbit_dimension(pair)
        assert found["open_orbits"] == lh.orbits.open_orbit_count(pair)


def test_full_pairs_have_their_row() -> None:
    pair = lh.pair("so(6)/u(3)")
    found = facts_of(pair, lh.decide_fullness(pair))
    assert found["key"] == ["C", 6, 8, 2, "J", 1] and found["row"] == "su(4)/u(3)" and "CP^3" in str(found["space"])
    pair = lh.pair("so(3,1)/so(2,1)")
    assert facts_of(pair, lh.decide_fullness(pair))["key"] is None


def test_missing_facts_say_why() -> None:
    pair = lh.pair("so(5,3)/P{3,4}")
    found = facts_of(pair, lh.decide_fullness(pair))
    assert found["open_orbits"] is None and "degrees 4" in found["missing"]["open_orbits"]
    over = lh.Pair(pair.algebra.over(lh.number_field("sqrt(2)")), pair.subalgebra.rows())
    found = facts_of(over, lh.decide_fullness(over))
    assert found["range_condition"] is True and "over QQ only" in found["missing"]["invariant_degree"]


def test_a_fact_that_takes_too_long_is_missing_and_a_limit_of_the_caller_is_kept() -> None:
    def slow(pair: lh.Pair) -> int:
        end = time.monotonic() + 5
        while time.monotonic() < end:
            in_time()
        return 0

    pair = lh.pair("so(4)/so(3)")
    with pytest.raises(UndecidedError, match=r"not computed within 0\.01 seconds"):
        _in(0.01, slow, pair)
    with lh.limits(seconds=0.01), pytest.raises(LimitError, match="seconds"):
        _in(3, slow, pair)


def test_a_sweep_adds_facts_and_what_its_recipe_knows() -> None:
    recipe = lh.atlas.Recipe("so(5)/so(4)", "symmetric", lh.pair, ("so(5)/so(4)",), {"rank": 1})
    [(_, entry)] = lh.atlas.iter_sweep([recipe], facts=True)
    assert entry.family == "symmetric" and entry.facts["rank"] == 1 and entry.facts["open_orbits"] == 1
    assert lh.atlas.Entry.from_json(entry.to_json()) == entry
    [(_, plain)] = lh.atlas.iter_sweep([recipe])
    assert plain.facts == {"rank": 1}
    [(_, bare)] = lh.atlas.iter_sweep(["so(5)/so(4)"])
    assert lh.atlas.Entry.from_json({k: v for k, v in bare.to_json().items() if v}) == bare  # what may be missing is


def test_one_pair_in_two_families_has_two_entries() -> None:
    recipes = [lh.atlas.Recipe("so(5)/so(4)", family, lh.pair, ("so(5)/so(4)",)) for family in ("symmetric", "maximal")]
    assert [entry.family for entry in lh.atlas.sweep(recipes)] == ["symmetric", "maximal"]


def test_stores_with_and_without_facts_are_not_mixed(tmp_path: object) -> None:
    names = ["so(4)/so(3)"]
    list(lh.atlas.iter_sweep(names, store=str(tmp_path)))
    with pytest.raises(lh.errors.InputError):
        list(lh.atlas.iter_sweep(names, store=str(tmp_path), facts=True))
