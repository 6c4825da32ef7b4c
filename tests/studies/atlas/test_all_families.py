"""The atlas: its families, and the entries of a sample of each."""

import json
from pathlib import Path

import pytest

import liehom as lh
from liehom.base.errors import FormatError, InputError
from liehom.studies.atlas.sweeps import COLUMNS, COUNTS, MISSING, table_row


def test_an_unknown_family_raises() -> None:
    with pytest.raises(InputError, match="there is no family 'spheres'"):
        lh.atlas.recipes(["spheres"])
    with pytest.raises(InputError, match="a list of names"):
        lh.atlas.recipes("parabolic")


def test_entries_survive_a_file_and_the_table_counts_them(tmp_path: Path) -> None:
    entries = [entry for entry, _ in zip(lh.atlas.build(["parabolic"]), range(12), strict=False)]
    made = lh.atlas.write_entries(tmp_path / "atlas.jsonl", entries)
    assert list(lh.atlas.read_entries(tmp_path / "atlas.jsonl")) == entries and made == lh.atlas.table(entries)
    counts = made["counts"]["parabolic"]
    assert counts["pairs"] == counts["full"] + counts["not full"] == 12 and counts["undecided"] == 0
    assert set(counts) == {*COUNTS, "seconds"} and all(entry.verified and entry.verify() for entry in entries)
    lh.atlas.write_table(tmp_path / "atlas.json", made)
    assert json.loads((tmp_path / "atlas.json").read_text(encoding="utf-8")) == made


def test_a_row_says_which_facts_are_missing() -> None:
    [(_, entry)] = lh.atlas.iter_sweep(["so(5,3)/P{3,4}"], facts=True)
    cells = dict(zip(COLUMNS, table_row(entry), strict=True))
    assert (cells["degree"], cells["open orbits"], cells["full"]) == (4, MISSING, False)
    [(_, entry)] = lh.atlas.iter_sweep(["sl(3)/so(3)"], facts=True)
    cells = dict(zip(COLUMNS, table_row(entry), strict=True))
    assert (cells["range"], cells["degree"], cells["open orbits"]) == (False, None, 0)


def test_a_line_that_is_not_an_entry_raises(tmp_path: Path) -> None:
    path = tmp_path / "atlas.jsonl"
    path.write_text('{"name": "so(3)"}\n', encoding="utf-8")
    with pytest.raises(FormatError, match=r"line 1 of .* is not an entry"):
        list(lh.atlas.read_entries(path))
