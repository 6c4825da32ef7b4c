"""`classify`: the row of every full pair, in any basis, with ideals inside h, over QQ and over number fields."""

from __future__ import annotations

import pickle
import random
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import liehom as lh
from liehom.catalog import CLAIMS
from liehom.fullness.classification import Key, Row, rows
from liehom.fullness.classification.classification import Classification
from tests.fullness.classification.support import expected_key, pair_of, with_ideal
from tests.fullness.support import over, scrambled
from tests.fullness.test_number_fields import CUBIC, ROOT2
from tests.fullness.test_number_fields import scrambled as scrambled_over
from tests.sampling import examples

DIMENSIONS = (2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16)
ROWS = [row for d in (0, 1, *DIMENSIONS) for row in rows(d)]
SMALL = [row for row in ROWS if row.key.d <= 8]
every_row = pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
small_rows = pytest.mark.parametrize("row", SMALL, ids=lambda row: row.name)


@every_row
def test_every_row_is_found_in_its_own_basis(row: Row) -> None:
    pair = pair_of(row)
    found = lh.classify(pair)
    assert found.key == expected_key(row)
    assert found.ideal.dimension == 0
    assert found.row == row
    assert found.verify(pair)


@pytest.mark.parametrize("seed", range(3))
@every_row
def test_every_row_is_found_in_a_scrambled_basis(row: Row, seed: int) -> None:
    pair = scrambled(pair_of(row), random.Random(f"{row.name} {seed}"))
    found = lh.classify(pair)
    assert found.key == expected_key(row)
    assert found.verify(pair)


@pytest.mark.parametrize("dimension", range(1, 7))
@every_row
def test_an_ideal_inside_h_leaves_the_key(row: Row, dimension: int) -> None:
    rng = random.Random(f"{row.name} {dimension}")
    pair = scrambled(with_ideal(pair_of(row), dimension, rng), rng)
    found = lh.classify(pair)
    assert found.key == expected_key(row)
    assert found.ideal.dimension == dimension
    assert found.verify(pair)


@pytest.mark.parametrize("field", [ROOT2, CUBIC], ids=["sqrt(2)", "cube root of 2"])
@small_rows
def test_every_row_is_found_in_a_basis_with_irrational_entries(row: Row, field: Any) -> None:
    pair = scrambled_over(pair_of(row), field, random.Random(row.name))
    found = lh.classify(pair)
    assert found.key == expected_key(row)
    assert found.verify(pair)


FULL = [name for name, claim in CLAIMS.items() if claim.full]


@pytest.mark.parametrize("name", FULL)
def test_the_name_denotes_the_same_row(name: str) -> None:
    found = lh.classify(lh.pair(name))
    assert found.name is not None
    assert lh.pair(found.name).name == found.name
    assert lh.classify(lh.pair(found.name)).key == found.key


@pytest.mark.parametrize("name", [name for name, claim in CLAIMS.items() if not claim.full])
def test_a_pair_that_is_not_full_raises_an_error_with_the_verdict(name: str) -> None:
    with pytest.raises(lh.NotFullError, match="not full") as caught:
        lh.classify(lh.pair(name))
    assert caught.value.verdict.full is False  # type: ignore[attr-defined]
    assert pickle.loads(pickle.dumps(caught.value)).verdict == caught.value.verdict


# -- laws --------------------------------------------------------------------------------------------------
@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([row for row in ROWS if row.key.d <= 6]), st.randoms(use_true_random=False))
def test_the_key_does_not_depend_on_the_basis(row: Row, rng: random.Random) -> None:
    pair = pair_of(row)
    assert lh.classify(scrambled(pair, rng)).key == lh.classify(pair).key


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([row for row in ROWS if row.key.d <= 6]), st.sampled_from([ROOT2, CUBIC]))
def test_the_key_does_not_depend_on_the_field(row: Row, field: Any) -> None:
    pair = pair_of(row)
    assert lh.classify(over(pair, field)).key == lh.classify(pair).key


# -- the object --------------------------------------------------------------------------------------------
@small_rows
def test_json_and_pickle_restore_a_classification(row: Row) -> None:
    for field in (lh.QQ, ROOT2):
        found = lh.classify(over(pair_of(row), field))
        assert Classification.from_json(found.to_json()) == found
        assert pickle.loads(pickle.dumps(found)) == found


def test_a_given_verdict_spares_the_decision(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = lh.pair("so(4)/so(3)")
    verdict = lh.decide_fullness(pair)
    monkeypatch.setattr("liehom.fullness.classifier.decide_fullness", None)
    assert lh.classify(pair, verdict).name == "so(4)/so(3)"
    with pytest.raises(lh.InputError, match="different pair"):
        lh.classify(lh.pair("so(5)/so(4)"), verdict)


def test_numerical_pairs_and_other_objects_are_rejected() -> None:
    pair = lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]])
    with pytest.raises(lh.UndecidedError, match="rationalize"):
        lh.classify(pair)
    with pytest.raises(lh.InputError, match=r"liehom\.pair"):
        lh.classify("so(4)/so(3)")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "change",
    [
        {"letter": "B"},
        {"d": 4},
        {"s": 2},
        {"e": 2},
        {"centre": "R"},
        {"parameter": -1},
        {"letter": "A", "parameter": None},
    ],
    ids=str,
)
def test_a_wrong_key_is_not_verified(change: dict[str, Any]) -> None:
    pair = lh.pair("so(4)/so(3)")
    found = lh.classify(pair)
    wrong = replace(found, key=found.key._replace(**change))
    with pytest.raises(lh.CertificateError):
        wrong.verify(pair)


@small_rows
def test_the_key_of_another_row_is_not_verified(row: Row) -> None:
    pair = pair_of(row)
    found = lh.classify(pair)
    for other in rows(row.key.d):
        if other != row:
            with pytest.raises(lh.CertificateError):
                replace(found, key=expected_key(other)).verify(pair)


def test_a_wrong_ideal_is_not_verified() -> None:
    pair = lh.pair("so(4)/u(2)")
    found = lh.classify(pair)
    for rows_of_ideal in (found.ideal.basis.select(rows=[0]), pair.subalgebra.basis, pair.field.zeros(0, 6)):
        wrong = replace(found, ideal=lh.Subspace(pair.field, rows_of_ideal, 6))
        with pytest.raises(lh.CertificateError, match="ideal"):
            wrong.verify(pair)


def test_a_key_in_no_row_is_reported_as_a_counterexample(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = lh.pair("so(4)/so(3)")
    key = Key("C", 3, 5, 1, "", 1)
    monkeypatch.setattr("liehom.fullness.classifier.key_of", lambda action: (key, pair.subalgebra))
    with pytest.raises(lh.errors.InternalError, match="counterexample to the theorem"):
        lh.classify(pair)
