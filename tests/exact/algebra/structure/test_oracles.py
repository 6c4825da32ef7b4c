"""Answers of GAP and of liehom about 200 random Lie algebras of dimensions 3 to 30 agree.

The files structure_*.json of tests/oracles are written by tests/oracles/make_structure.py.  Each test takes one
family and lists all disagreements; what rests on a Levi factor is compared for every fourth algebra, with --slow for
all.  Where GAP refused or ran out of time, what is left of its answers is compared.
"""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import liehom as lh
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra

ORACLES = Path(__file__).resolve().parents[3] / "oracles"
FILES = {path.stem.removeprefix("structure_"): path for path in sorted(ORACLES.glob("structure_*.json"))}
SAME = {"B1": "A1", "C1": "A1", "C2": "B2", "D3": "A3"}

each_family = pytest.mark.parametrize("family", sorted(FILES))
every = pytest.mark.parametrize("stride", [4, pytest.param(1, marks=pytest.mark.slow)])


@cache
def file_of(family: str) -> dict[str, Any]:
    data = json.loads(FILES[family].read_text(encoding="utf-8"))
    assert isinstance(data, dict)
    return data


@cache
def algebras(family: str) -> list[tuple[str, LieAlgebra, dict[str, Any]]]:
    cases = []
    for entry in file_of(family)["algebras"]:
        algebra = lh.from_json(entry["algebra"])
        assert isinstance(algebra, LieAlgebra)
        cases.append((entry["label"], algebra, entry["gap"]))
    return cases


def disagreements(family: str, **questions: Callable[[LieAlgebra], Any]) -> list[str]:
    """For each question that GAP answered, what liehom says, where it is something else."""
    wrong = []
    for index, (label, algebra, gap) in enumerate(algebras(family)):
        for key, ours in questions.items():
            if key in gap and (value := ours(algebra)) != gap[key]:
                wrong.append(f"{family} {index} ({label}): {key} is {value}, GAP says {gap[key]}")
    return wrong


def dimensions(terms: list[Subalgebra]) -> list[int]:
    return [h.dimension for h in terms]


def simple_types(text: str) -> str:
    """One type for each isomorphism class, sorted; nothing for the zero algebra."""
    return " ".join(sorted(SAME.get(x, x) for x in text.replace("+", " ").split() if x != "0"))


def test_the_files_are_what_they_should_be() -> None:
    sizes = [gap["dimension"] for family in FILES for _, _, gap in algebras(family)]
    assert (len(sizes), min(sizes), max(sizes)) == (200, 3, 30)
    for family in FILES:
        head = file_of(family)["provenance"]
        assert {"tool", "tool_version", "script", "date", "licence", "seed"} <= set(head)
        assert (ORACLES.parent.parent / head["script"]).is_file()


def test_gap_answered_nearly_everything() -> None:
    answered = sum(len(gap) for family in FILES for _, _, gap in algebras(family))
    refused = sum(len(entry.get("refused", {})) for family in FILES for entry in file_of(family)["algebras"])
    assert answered > 100 * refused > 0


@each_family
def test_centre_and_series(family: str) -> None:
    assert not disagreements(
        family,
        dimension=lambda g: g.dimension,
        center=lambda g: g.center().dimension,
        derived_series=lambda g: dimensions(g.derived_series()),
        lower_central_series=lambda g: dimensions(g.lower_central_series()),
    )


@each_family
def test_killing_form(family: str) -> None:
    assert not disagreements(
        family, killing_rank=lambda g: g.killing_form().rank(), killing_signature=lambda g: list(g.killing_signature())
    )


@each_family
def test_radical_has_the_known_dimension(family: str) -> None:
    assert not disagreements(
        family, radical=lambda g: g.radical().dimension, nilradical=lambda g: g.nilradical().dimension
    )


@each_family
def test_cartan_subalgebra(family: str) -> None:
    assert not disagreements(family, cartan_subalgebra=lambda g: g.cartan_subalgebra().dimension)


@cache
def levi_factor(family: str, index: int) -> LieAlgebra:
    return algebras(family)[index][1].levi_decomposition().levi.as_algebra()


@every
@each_family
def test_levi_factor_and_its_types(family: str, stride: int) -> None:
    wrong = []
    for index, (label, _, gap) in list(enumerate(algebras(family)))[::stride]:
        levi = levi_factor(family, index)
        if levi.dimension != gap["dimension"] - gap["radical"] or levi.dimension != gap.get("levi", levi.dimension):
            wrong.append(f"{family} {index} ({label}): Levi factor of dimension {levi.dimension}")
        value = simple_types(levi.semisimple_type())
        if "type" in gap and value != simple_types(gap["type"]):
            wrong.append(f"{family} {index} ({label}): {value}, GAP says {gap['type']}")
        if sum(map(dimension_of_type, value.split())) != levi.dimension:  # also where GAP has no answer
            wrong.append(f"{family} {index} ({label}): {value} has not dimension {levi.dimension}")
    assert not wrong


def dimension_of_type(name: str) -> int:
    system = lh.root_system(name)
    return system.rank + system.number_of_roots


@every
@each_family
def test_indecomposable_ideals_over_the_rationals(family: str, stride: int) -> None:
    wrong = []
    for index, (label, _, gap) in list(enumerate(algebras(family)))[::stride]:
        value = sorted(dimensions(levi_factor(family, index).direct_sum_decomposition()))
        if value != gap.get("simple_ideals_over_QQ", [] if gap["radical"] == gap["dimension"] else value):
            wrong.append(f"{family} {index} ({label}): {value}, GAP says {gap['simple_ideals_over_QQ']}")
    assert not wrong


@every
@each_family
def test_simple_ideals(family: str, stride: int) -> None:
    """An ideal that is simple over QQ is a sum of ideals that are simple over the reals."""
    wrong = []
    for index, (label, _, gap) in list(enumerate(algebras(family)))[::stride]:
        rational = gap.get("simple_ideals_over_QQ", [])
        real = sorted(dimensions(levi_factor(family, index).simple_ideals())) if rational else []
        if sum(real) != sum(rational) or len(real) < len(rational):
            wrong.append(f"{family} {index} ({label}): {real}, over QQ {rational}")
        if len(real) > len(rational) and family != "hard_forms":  # elsewhere all is split or simple over the reals
            wrong.append(f"{family} {index} ({label}): {real}, over QQ {rational}")
    assert not wrong


@every
def test_real_forms_are_those_that_were_scrambled(stride: int) -> None:
    """Not GAP's, which has no real forms: the semisimple family is made of known ones."""
    wrong = []
    for label, algebra, _ in algebras("semisimple")[::stride]:
        if algebra.real_form() != lh.canonical_real_form(label):
            wrong.append(f"{label}: {algebra.real_form()}")
    assert not wrong
