"""Damaged stores and files are noticed; what is damaged is named and made again."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import DamageWarning, FormatError
from liehom.base.store import Records, open_store
from tests.campaigns.damage import BELIEVED, FIGURES, campaign

PAIRS = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1"]


def test_no_damage_of_a_sample_is_believed() -> None:
    rows = campaign(450, seed=7)["rows"]
    assert sum(row["noticed"] for row in rows) > 250 and not any(row[BELIEVED] for row in rows)


def test_committed_figures_are_those_of_a_whole_campaign() -> None:
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))
    counted = sum(row["noticed"] + row["identical"] + row[BELIEVED] for row in figures["rows"])
    assert figures["count"] == counted >= 10_000 and not any(row[BELIEVED] for row in figures["rows"])


def parts(folder: Path) -> list[bytes]:
    """The lines of the only file of entries, in the order of `PAIRS`."""
    return (folder / "records-000000.jsonl").read_bytes().splitlines(keepends=True)


def test_a_damaged_entry_is_named_and_decided_again(tmp_path: Path) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    first, second, third = parts(tmp_path / "atlas")
    name = json.loads(first)["name"]
    for content in (
        first.replace(b'"full": true', b'"full": false'),
        first.replace(b'"facts": {', b'"facts": [', 1),
        first.replace(b'"checksum"', b'"checksun"'),
        first[:100] + b"\n",
        b'{"name": "' + name.encode() + b'", ' + second.partition(b", ")[2],
        b'{"name": "' + name.encode() + b'", ' + b"[" * 10**5 + b"\n",
    ):
        assert content != first
        for file in (tmp_path / "atlas").glob("records-*"):
            file.unlink()
        (tmp_path / "atlas" / "records-000000.jsonl").write_bytes(content + second + third)
        with pytest.warns(DamageWarning, match=name):
            assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole
        assert (tmp_path / "atlas" / "records-000001.jsonl").read_bytes() == first
        assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole  # without a warning


@pytest.mark.parametrize("content", [b"[]\n", b"\x00\n", b'{"nome": "x", "facts": {}}\n'])
def test_a_line_without_a_name_is_counted_and_its_entry_decided_again(tmp_path: Path, content: bytes) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    first, _, third = parts(tmp_path / "atlas")
    (tmp_path / "atlas" / "records-000000.jsonl").write_bytes(first + content + third)
    decided: list[str] = []
    with pytest.warns(DamageWarning, match=r"line 2 of .*records-000000.jsonl"):
        again = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas", progress=lambda entry: decided.append(entry.name))
    assert again == whole and decided == [PAIRS[1]]


def test_half_a_line_at_the_end_of_a_file_is_no_damage(tmp_path: Path) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    first, second, third = parts(tmp_path / "atlas")
    (tmp_path / "atlas" / "records-000000.jsonl").write_bytes(first + second + third[:-1])
    decided: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas", progress=lambda entry: decided.append(entry.name))
    assert again == whole and decided == [PAIRS[2]]


def test_stored_certificates_are_checked_again_where_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    checked: list[str] = []
    monkeypatch.setattr(lh.atlas.Entry, "verify", lambda entry, pair=None: checked.append(entry.name))
    assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas") == whole and checked == []
    assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas", recheck=True) == whole and checked == PAIRS


def test_entries_are_believed_only_with_their_certificates_where_asked(tmp_path: Path) -> None:
    whole = lh.atlas.sweep(PAIRS, store=tmp_path / "atlas")
    fingerprint = json.loads((tmp_path / "atlas" / "store.json").read_text())["fingerprint"]
    line, other_line = map(json.loads, parts(tmp_path / "atlas")[:2])
    entry, other = line["facts"], other_line["facts"]
    for changed in (
        {**entry, "verdict": {**entry["verdict"], "full": False}},
        {**entry, "verdict": {**entry["verdict"], "certificate": other["verdict"]["certificate"]}},
        {**entry, "dimension": "6"},
        {**entry, "unknown": 1},
        {"name": "so(4)/so(3)"},
        {**entry, "verified": 1},
    ):
        with Records(open_store(tmp_path / "atlas", fingerprint)) as records:
            records.append([(line["name"], changed)])
        with pytest.warns(DamageWarning):
            assert lh.atlas.sweep(PAIRS, store=tmp_path / "atlas", recheck=True) == whole


@pytest.mark.parametrize("name", ["runs", "runs.zarr"])
def test_a_damaged_chunk_of_an_ensemble_is_computed_again(tmp_path: Path, name: str) -> None:
    field = lh.GeneratorField(lh.defining(lh.so(3)), ["m2", "m0", "1"])
    starts = np.random.default_rng(0).standard_normal((4, 3))

    def run() -> np.ndarray:
        made = lh.propagation.integrate_ensemble(field, (0, 1), starts, chunk=2, store=tmp_path / name, dt=0.25)
        return np.asarray(made.y)

    whole = run()
    for file in sorted(f for f in (tmp_path / name).rglob("*") if f.is_file() and f.name not in ("store.json",)):
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
    path.write_text(json.dumps(dict(reversed(json.loads(text).items()))))
    assert lh.load(path) == lh.pair("so(4)/so(3)")
