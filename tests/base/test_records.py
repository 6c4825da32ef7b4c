"""Records: what is appended is read, across files, processes and interruptions; other shards are still there."""

import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liehom.base import store as records
from liehom.base.errors import FormatError, InputError
from liehom.base.store import Records, open_store


def opened(path: Path) -> Records:
    return Records(open_store(path, "abc"))


FACTS: dict[str, dict[str, Any]] = {
    "plain": {"value": 0.1, "far": float("inf"), "list": [1, None, True]},
    "ψ": {"text": "ψ\n\u2028"},
    'a "quoted" \\ name': {},
    "line\nbreak": {"full": False},
}


@pytest.mark.parametrize("name", ["atlas", pytest.param("atlas.zarr", marks=pytest.mark.filterwarnings("ignore"))])
def test_appended_records_load_unchanged(tmp_path: Path, name: str) -> None:
    if name.endswith(".zarr"):
        pytest.importorskip("zarr")
    with opened(tmp_path / name) as made:
        made.append(FACTS.items())
        assert all(made.load(name) == ({}, facts) for name, facts in FACTS.items())
    again = opened(tmp_path / name)
    assert again.names() == set(FACTS) and "other" not in again
    assert all(name in again and again.load(name) == ({}, facts) for name, facts in FACTS.items())
    with pytest.raises(FormatError, match="is missing or damaged"):
        again.load("other")


def test_a_full_file_is_followed_by_another_and_each_writer_begins_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(records, "LINES", 10)
    with opened(tmp_path / "a") as first, opened(tmp_path / "a") as second:
        for i in range(25):
            first.append([(f"first {i}", {"i": i})])
            second.append([(f"second {i}", {"i": i})])
    again = opened(tmp_path / "a")
    assert len(list((tmp_path / "a").glob("records-*.jsonl"))) == 6
    assert all(again.load(f"{who} {i}") == ({}, {"i": i}) for i in range(25) for who in ("first", "second"))


def test_a_record_is_replaced_by_a_later_one_of_the_same_name(tmp_path: Path) -> None:
    for value in range(3):
        with opened(tmp_path / "a") as made:
            made.append([("x", {"value": value})])
            assert made.load("x")[1] == {"value": value}
    assert opened(tmp_path / "a").load("x")[1] == {"value": 2}


def test_shards_with_arrays_are_kept_beside(tmp_path: Path) -> None:
    with opened(tmp_path / "a") as made:
        made.save("with", {"y": np.arange(3)}, {"n": 1})
        made.save("without", {}, {"n": 2})
    again = opened(tmp_path / "a")
    assert again.names() == {"with", "without"} and "with" in again
    assert again.load("with")[0]["y"].tolist() == [0, 1, 2] and again.load("without") == ({}, {"n": 2})


KILLED = """
import os, signal, sys
from liehom.base.store import Records, open_store
made = Records(open_store(sys.argv[1], "abc"))
for i in range(100):
    made.append([(f"name {i}", {"i": i})])
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_records_survive_the_death_of_their_process(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path / "a")], check=False, timeout=120)
    assert done.returncode != 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = opened(tmp_path / "a")
        assert all(again.load(f"name {i}") == ({}, {"i": i}) for i in range(100))


def test_half_a_line_is_ignored_and_not_continued(tmp_path: Path) -> None:
    with opened(tmp_path / "a") as made:
        made.append([("x", {"value": 1}), ("y", {"value": 2})])
    file = tmp_path / "a" / "records-000000.jsonl"
    whole = file.read_bytes()
    first = whole.index(b"\n") + 1
    for length in (first, first + 5, first + 30, len(whole) - 1):
        copy = tmp_path / f"cut at {length}"
        shutil.copytree(tmp_path / "a", copy)
        (copy / file.name).write_bytes(whole[:length])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with opened(copy) as again:
                assert again.names() == {"x"} and "y" not in again
                again.append([("y", {"value": 3})])
            assert opened(copy).load("y")[1] == {"value": 3}
        assert (copy / file.name).stat().st_size == length


def test_a_file_that_cannot_be_read_raises_format_error(tmp_path: Path) -> None:
    store = open_store(tmp_path / "a", "abc")
    (tmp_path / "a" / "records-000007.jsonl").mkdir()
    with pytest.raises(FormatError, match=r"records-000007.jsonl' cannot be read"):
        Records(store)


def test_a_folder_that_cannot_be_written_raises_input_error(tmp_path: Path) -> None:
    made = opened(tmp_path / "a")
    shutil.rmtree(tmp_path / "a")
    with pytest.raises(InputError, match="cannot be written"):
        made.append([("x", {})])
