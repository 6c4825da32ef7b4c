"""Characters beside GAP's tables (tests/oracles/gap_characters.py), and the laws that tie them to each other."""

import json
from math import prod
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, InputError, ShapeError
from liehom.exact.algebra.roots.root_system import RootSystem
from tests.sampling import examples

TESTS = Path(__file__).resolve().parents[3]
ORACLE = json.loads((TESTS / "oracles" / "gap_characters.json").read_text(encoding="utf-8"))
SMALL_TYPES = {"A1": 8, "A2": 4, "B2": 3, "G2": 2, "A3": 2, "B3": 2, "C3": 2, "A1 + A2": 2}


@st.composite
def modules(draw: st.DrawFn) -> tuple[str, list[int]]:
    kind = draw(st.sampled_from(sorted(SMALL_TYPES)))
    rank = lh.root_system(kind).rank
    return kind, draw(st.lists(st.integers(0, SMALL_TYPES[kind]), min_size=rank, max_size=rank))


def label(case: dict[str, Any]) -> str:
    return " ".join([case["type"], *(str(case[key]) for key in ("weight", "left", "right") if key in case)])


def pairs(table: list[Any]) -> dict[tuple[int, ...], int]:
    return {tuple(weight): count for weight, count in table}


@pytest.mark.parametrize("case", ORACLE["characters"], ids=label)
def test_dimension_and_dominant_character_are_those_of_gap(case: dict[str, Any]) -> None:
    assert lh.weyl_dimension(case["type"], case["weight"]) == case["dimension"]
    assert lh.representations.dominant_character(case["type"], case["weight"]) == pairs(case["dominant"])


@pytest.mark.parametrize("case", ORACLE["products"], ids=label)
def test_tensor_products_are_those_of_gap(case: dict[str, Any]) -> None:
    for left, right in ((case["left"], case["right"]), (case["right"], case["left"])):
        assert lh.tensor_product_decomposition(case["type"], left, right) == pairs(case["parts"])


def test_the_smallest_modules_have_the_dimensions_of_the_tables() -> None:
    known = {"G2": [7, 14], "F4": [52, 1274, 273, 26], "E6": [27, 78, 351, 2925, 351, 27]}
    known["E7"] = [133, 912, 8645, 365750, 27664, 1539, 56]
    known["E8"] = [3875, 147250, 6696000, 6899079264, 146325270, 2450240, 30380, 248]
    for kind, dimensions in known.items():
        rank = len(dimensions)
        found = [lh.weyl_dimension(kind, [int(i == j) for j in range(rank)]) for i in range(rank)]
        assert found == dimensions


@given(module=modules())
@settings(deadline=None, max_examples=examples(30))
def test_the_character_has_the_dimension_and_the_symmetry_of_the_module(module: tuple[str, list[int]]) -> None:
    kind, weight = module
    full = lh.representations.character(kind, weight)
    assert sum(full.values()) == lh.weyl_dimension(kind, weight) and next(iter(full)) == tuple(weight)
    dual = lh.representations.character(kind, lh.representations.dual_weight(kind, weight))
    assert dual == {tuple(-x for x in mu): m for mu, m in full.items()}
    assert {mu: m for mu, m in full.items() if min(mu) >= 0} == lh.representations.dominant_character(kind, weight)
    assert lh.representations.decompose_character(kind, full) == {tuple(weight): 1}


@given(module=modules(), data=st.data())
@settings(deadline=None, max_examples=examples(20))
def test_the_two_ways_to_decompose_a_tensor_product_agree(module: tuple[str, list[int]], data: st.DataObject) -> None:
    kind, left = module
    right = data.draw(st.lists(st.integers(0, 1), min_size=len(left), max_size=len(left)))
    left = [min(x, 2 if len(left) < 3 else 1) for x in left]
    product: dict[tuple[int, ...], int] = {}
    for mu, m in lh.representations.character(kind, left).items():
        for nu, n in lh.representations.character(kind, right).items():
            total = tuple(x + y for x, y in zip(mu, nu, strict=True))
            product[total] = product.get(total, 0) + m * n
    parts = lh.tensor_product_decomposition(kind, left, right)
    assert lh.representations.decompose_character(kind, product) == parts
    dimension = prod(lh.weyl_dimension(kind, weight) for weight in (left, right))
    assert sum(m * lh.weyl_dimension(kind, top) for top, m in parts.items()) == dimension


@given(module=modules())
@settings(deadline=None, max_examples=examples(20))
def test_the_indicator_is_the_symmetry_of_the_invariant_form(module: tuple[str, list[int]]) -> None:
    """Sym^2 V holds the trivial module for 1, Lambda^2 V for -1: by the character of Sym^2, g(2) added to g^2."""
    kind, weight = module
    weight = [min(x, 2 if len(weight) < 3 else 1) for x in weight]
    full = lh.representations.character(kind, weight)
    square: dict[tuple[int, ...], int] = {}
    for mu, m in full.items():
        for nu, n in full.items():
            total = tuple(x + y for x, y in zip(mu, nu, strict=True))
            square[total] = square.get(total, 0) + m * n
    doubled = {tuple(2 * x for x in mu): m for mu, m in full.items()}
    symmetric = {mu: (m + doubled.get(mu, 0)) // 2 for mu, m in square.items()}
    skew = {mu: m - symmetric[mu] for mu, m in square.items() if m != symmetric[mu]}
    zero = (0,) * len(weight)
    found = [lh.representations.decompose_character(kind, part).get(zero, 0) for part in (symmetric, skew)]
    expected = {1: [1, 0], -1: [0, 1], 0: [0, 0]}[lh.representations.frobenius_schur_indicator(kind, weight)]
    assert found == expected


@pytest.mark.parametrize(("kind", "weight", "indicator"), [
    ("A3", [0, 1, 0], 1), ("A5", [0, 0, 1, 0, 0], -1), ("A2", [1, 0], 0), ("B3", [0, 0, 1], 1), ("B2", [0, 1], -1),
    ("B5", [0, 0, 0, 0, 1], -1), ("C3", [1, 0, 0], -1), ("D4", [0, 0, 0, 1], 1), ("D5", [0, 0, 0, 0, 1], 0),
    ("D6", [0, 0, 0, 0, 0, 1], -1), ("E6", [1, 0, 0, 0, 0, 0], 0), ("E7", [0, 0, 0, 0, 0, 0, 1], -1),
    ("E8", [1, 0, 0, 0, 0, 0, 0, 0], 1), ("G2", [1, 1], 1), ("A1 + A1", [1, 1], 1),
])  # fmt: skip
def test_known_types_of_modules_of_the_compact_form(kind: str, weight: list[int], indicator: int) -> None:
    assert lh.representations.frobenius_schur_indicator(kind, weight) == indicator
    assert (lh.representations.dual_weight(kind, weight) == tuple(weight)) == (indicator != 0)


@pytest.mark.parametrize(("kind", "weight"), [("F4", (1, 1, 1, 1)), ("B3", (0, 1, 0)), ("D4", (0, 0, 0, 1))])
def test_the_orbit_is_listed_once_and_is_closed(kind: str, weight: tuple[int, ...]) -> None:
    system = lh.root_system(kind)
    orbit = lh.representations.weyl_orbit(system, weight)
    assert len(set(orbit)) == len(orbit) and system.weyl_group_order() % len(orbit) == 0
    for mu in orbit:
        for i, row in enumerate(system.cartan):
            assert tuple(m - mu[i] * a for m, a in zip(mu, row, strict=True)) in set(orbit)
    assert lh.representations.weyl_orbit(kind, orbit[-1]) == orbit


def test_a_semisimple_type_and_the_zero_algebra() -> None:
    assert lh.weyl_dimension("A2 + G2", [1, 1, 1, 0]) == 8 * 7
    assert lh.representations.character("A1 + A1", [1, 1]) == {(1, 1): 1, (1, -1): 1, (-1, 1): 1, (-1, -1): 1}
    nothing = RootSystem([])
    assert lh.weyl_dimension(nothing, []) == 1 and lh.representations.character(nothing, []) == {(): 1}


@pytest.mark.parametrize(("function", "kind", "weight", "error", "match"), [
    ("weyl_dimension", "E8", [1, 0], ShapeError, "2 coordinates, the rank is 8"),
    ("character", "A2", [1, -1], InputError, "not dominant"), ("character", "H3", [1, 0, 0], CatalogError, None),
    *(("dominant_character", "A2", weight, InputError, "not integral") for weight in ([1, 0.5], [True, 0])),
    ("weyl_dimension", 3, [1], InputError, "root system"),
    ("decompose_character", "A1", {(2,): 1, (-2,): 1}, InputError, "too rarely"),
    ("decompose_character", "A1", {(1,): 1}, InputError, "occurs 1 times"),
    ("decompose_character", "A1", {(0,): -1}, InputError, "multiplicity"),
])  # fmt: skip
def test_what_is_no_weight_or_no_character_is_refused(function, kind, weight, error, match) -> None:
    with pytest.raises(error, match=match):
        getattr(lh.representations, function)(kind, weight)
