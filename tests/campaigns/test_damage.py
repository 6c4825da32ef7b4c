"""Damaged stores and files are noticed; what is damaged is named and made again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import liehom as lh
from liehom.errors import DamageWarning, FormatError
from tests.campaigns.damage import BELIEVED, FIGURES, campaign

PAIRS = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1"]


def test_no_damage_of_a_sample_is_believed() -> None:
    rows = campaign(450, seed=7)["rows"]
    assert sum(row["noticed"] for row in rows) > 250 and not any(row[BELIEVED] for row in rows)


def test_committed_figures_are_those_of_a_whole_campaign() -> None:
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))
    counted = sum(row["noticed"] + row["identical"] + row[BELIEVED] for row in figures["rows"])
    assert figures["count"] == counted >= 10_000 and not any(row[BELIEVED] for row in figures["rows"])


def shard(folder: Path, pair: str) -> Path:
    return next(f for f in folder.iterdir() if f.name.startswith("".join(c if c.isalnum() else "-" for c in pair)))


def test_a_damaged_entry_is_named_and_decided_again(tmp_path: Path) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    first, second = shard(tmp_path / "atlas", PAIRS[0]), shard(tmp_path / "atlas", PAIRS[1])
    original = first.read_bytes()
    for content in (
        b"[]",
        b"1",
        original.replace(b'"full": true', b'"full": false'),
        second.read_bytes(),
        b"[" * 10**5,
    ):
        first.write_bytes(content)
        with pytest.warns(DamageWarning, match=first.stem):
            assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole
        assert first.read_bytes() == original


def test_stored_certificates_are_checked_again_where_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    checked: list[str] = []
    monkeypatch.setattr(lh.atlas.Entry, "verify", lambda entry, pair=None: checked.append(entry.name))
    assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole and checked == []
    assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas", recheck=True) == whole and checked == PAIRS


def as_version_1(folder: Path) -> None:
    """Rewrites a store of JSON shards as liehom 0.1.0 writes it, without checksums."""
    for file in folder.iterdir():
        data = json.loads(file.read_text())
        if file.name == "store.json":
            data = {**data, "version": 1}
            del data["checksum"]
        else:
            data = data["facts"]
        file.write_text(json.dumps(data))


def test_entries_without_checksums_are_believed_only_with_their_certificates(tmp_path: Path) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    as_version_1(tmp_path / "atlas")
    assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole
    file = shard(tmp_path / "atlas", PAIRS[0])
    entry = json.loads(file.read_text())
    other = json.loads(shard(tmp_path / "atlas", PAIRS[1]).read_text())
    for changed in (
        {**entry, "verdict": {**entry["verdict"], "full": False}},
        {**entry, "verdict": {**entry["verdict"], "certificate": other["verdict"]["certificate"]}},
        {**entry, "dimension": "6"},
        {**entry, "unknown": 1},
        {"name": "so(4)/so(3)"},
        {**entry, "verified": 1},
    ):
        file.write_text(json.dumps(changed))
        with pytest.warns(DamageWarning):
            assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole


@pytest.mark.parametrize("name", ["runs", "runs.zarr"])
def test_a_damaged_chunk_of_an_ensemble_is_computed_again(tmp_path: Path, name: str) -> None:
    field = lh.GeneratorField(lh.defining(lh.so(3)), ["m2", "m0", "1"])
    starts = np.random.default_rng(0).standard_normal((4, 3))

    def run() -> np.ndarray:
        made = lh.integrators.integrate_ensemble(field, (0, 1), starts, chunk=2, store=tmp_path / name, dt=0.25)
        return np.asarray(made.y)

    whole = run()
    inside = [f for f in (tmp_path / name).rglob("*") if f.is_file() and f.name not in ("store.json",)]
    for file in sorted(inside):
        if file.parent == tmp_path / name and name == "runs.zarr":
            continue  # the description of the store
        data = file.read_bytes()
        file.write_bytes(data[: len(data) // 2])
        with pytest.warns(DamageWarning, match="computed again"):
            np.testing.assert_array_equal(run(), whole)
        np.testing.assert_array_equal(run(), whole)


def test_a_damaged_description_of_a_store_is_refused(tmp_path: Path) -> None:
    lh.atlas.sweep(PAIRS[:1], store=tmp_path / "atlas")
    about = tmp_path / "atlas" / "store.json"
    data = about.read_text()
    for content in (
        "[]",
        "1",
        "null",
        data.replace("seed 0", "seed 1"),
        data.replace('"version": 2', '"version": 1'),
        "",
    ):
        about.write_text(content)
        with pytest.raises(FormatError, match="damaged"):
            lh.atlas.sweep(PAIRS[:1], store=tmp_path / "atlas")


def test_a_file_with_a_checksum_notices_every_edit(tmp_path: Path) -> None:
    path = tmp_path / "pair.json"
    lh.dump(lh.pair("so(4)/so(3)"), path, checksum=True)
    assert lh.load(path) == lh.pair("so(4)/so(3)")
    text = path.read_text()
    path.write_text(text.replace('"-1"', '"1"', 1))
    with pytest.raises(FormatError, match="delete the key 'checksum'"):
        lh.load(path)
    keys = json.loads(text)
    path.write_text(json.dumps(dict(reversed(keys.items()))))
    assert lh.load(path) == lh.pair("so(4)/so(3)")
