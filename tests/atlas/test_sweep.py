"""Sweeps: what `decide_fullness` says of every pair, on any executor; kept, continued, and refused."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import liehom as lh
from liehom.errors import CatalogError, InputError, ParseError
from tests.parallel.test_tasks import processes, threads

NAMES = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1", "affine(sl(2))", "so(3)/so(2)", "so(3)/0"]


def test_every_entry_is_decided() -> None:
    atlas = lh.atlas.sweep(NAMES)
    assert [entry.name for entry in atlas] == NAMES
    for entry in atlas:
        pair = lh.pair(entry.name)
        verdict = lh.decide_fullness(pair)
        assert entry.verdict == verdict.to_json()
        assert entry.full is verdict.full is lh.catalog.CLAIMS.get(entry.name, verdict).full
        assert (entry.dimension, entry.subalgebra_dimension) == (pair.algebra.dimension, pair.subalgebra.dimension)
        assert entry.verified
        assert entry.verify()
        assert str(entry).startswith(entry.name)
    assert {e.name for e in atlas.full} | {e.name for e in atlas.not_full} == set(NAMES)


@pytest.mark.parametrize("executor", [threads, processes], ids=["threads", "processes"])
def test_executors_give_what_serial_gives(executor: Any) -> None:
    pairs = [*NAMES, lh.pair("so(5)/so(4)"), lh.Pair(lh.so(3).over(lh.number_field("sqrt(2)")), [[0, 0, 1]])]
    assert lh.atlas.sweep(pairs, executor=executor) == lh.atlas.sweep(pairs)


def test_stored_entries_are_not_decided_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    decided: list[str] = []
    whole = lh.atlas.sweep(NAMES)
    first = lh.atlas.sweep(NAMES[:3], store=tmp_path / "atlas", progress=lambda entry: decided.append(entry.name))
    assert decided == NAMES[:3]
    assert first.entries == whole.entries[:3]
    again = lh.atlas.sweep(NAMES, store=tmp_path / "atlas", progress=lambda entry: decided.append(entry.name))
    assert decided == NAMES
    assert again == whole
    with pytest.raises(InputError, match="another problem"):
        lh.atlas.sweep(NAMES, store=tmp_path / "atlas", seed=1)


def test_pairs_that_differ_only_in_their_numbers_have_different_keys(tmp_path: Path) -> None:
    affine = lh.LieAlgebra({(0, 1): {1: 1}})
    pairs = [lh.Pair(affine, rows) for rows in ([[1, 0]], [[0, 1]], [])]
    atlas = lh.atlas.sweep(pairs, store=tmp_path / "atlas")
    assert len(list((tmp_path / "atlas").glob("*.json"))) == 4  # and store.json
    assert [entry.full for entry in atlas] == [lh.decide_fullness(pair).full for pair in pairs]
    assert all(entry.verify(pair) for entry, pair in zip(atlas, pairs, strict=True))


def test_pair_given_twice_is_decided_once() -> None:
    decided: list[str] = []
    atlas = lh.atlas.sweep(["so(4)/so(3)", "so(4) / so(3)"], progress=lambda entry: decided.append(entry.name))
    assert len(decided) == 1
    assert atlas[0] == atlas[1]


def test_rejected_pairs_have_a_reason_and_are_not_stored(tmp_path: Path) -> None:
    atlas = lh.atlas.sweep(["so(4)/so(3)", "so(4)/so(5)"], store=tmp_path / "atlas")
    assert [entry.full for entry in atlas] == [True, None]
    assert "CatalogError" in atlas.failures[0].reason
    assert "? " in str(atlas)
    assert len(list((tmp_path / "atlas").glob("so*.json"))) == 1
    with pytest.raises(InputError, match="there is no certificate"):
        atlas[1].verify()


def test_numerical_verdicts_are_labelled() -> None:
    pair = lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]], name="sphere in floats")
    entry = lh.atlas.sweep([pair])[0]
    assert (entry.full, entry.proved, entry.verified, entry.certificate) == (True, False, False, None)
    assert "numerical" in str(entry)


def test_table_as_string_markdown_and_json() -> None:
    atlas = lh.atlas.sweep(NAMES[:2])
    assert len(str(atlas).splitlines()) == 3
    assert len(atlas.to_markdown().splitlines()) == 4
    data = json.loads(json.dumps(atlas.to_json()))
    assert [pair["full"] for pair in data["pairs"]] == [True, False]
    assert lh.verify_certificate(lh.pair(NAMES[0]), data["pairs"][0]["certificate"])


def test_unverified_entries_are_marked() -> None:
    with ThreadPoolExecutor(1) as pool:
        assert not lh.atlas.sweep(NAMES[:1], executor=pool, verify=False)[0].verified


def test_invalid_arguments_raise_errors() -> None:
    with pytest.raises(InputError, match="got one"):
        lh.atlas.sweep("so(4)/so(3)")
    with pytest.raises(InputError, match="expected a Pair"):
        lh.atlas.sweep([3])  # type: ignore[list-item]
    with pytest.raises((ParseError, CatalogError)):
        lh.atlas.sweep(["so(4)//so(3)"])
    with pytest.raises(CatalogError):
        lh.atlas.sweep([lh.Pair(lh.so(3), [[0, 0, 1]], name="my own")])[0].verify()
