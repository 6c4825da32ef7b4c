"""Stores: what is written is read; whole or not there; of one problem; damage is named."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liehom.base.errors import FormatError, InputError
from liehom.base.store import open_store

KINDS = ["runs", pytest.param("runs.zarr", marks=pytest.mark.filterwarnings("ignore"))]


@pytest.fixture(params=KINDS)
def path(request: Any, tmp_path: Path) -> str:
    if request.param.endswith(".zarr"):
        pytest.importorskip("zarr")
    return str(tmp_path / "deeper" / request.param)


def test_saved_shards_load_unchanged(path: str) -> None:
    arrays = {"y": np.arange(6.0).reshape(2, 3) / 7, "n": np.array([3, 4]), "none": np.zeros((0, 2))}
    facts = {"status": -1, "value": 0.1, "far": float("inf"), "text": "ψ"}
    store = open_store(path, "abc")
    store.save("part-0", arrays, facts)
    store.save("only-facts", {}, {"full": True})
    again = open_store(path, "abc")
    assert again.names() == {"part-0", "only-facts"}
    found, told = again.load("part-0")
    assert told == facts
    assert {name: a.dtype for name, a in found.items()} == {name: a.dtype for name, a in arrays.items()}
    assert all(np.array_equal(found[name], arrays[name]) for name in arrays)
    assert again.load("only-facts") == ({}, {"full": True})


def test_a_shard_is_replaced(path: str) -> None:
    store = open_store(path, "abc")
    for value in (1.0, 2.0):
        store.save("part", {"y": np.array([value])}, {})
    assert store.load("part")[0]["y"].tolist() == [2.0]


def test_store_of_another_problem_raises_input_error(path: str) -> None:
    open_store(path, "abc").save("part", {"y": np.zeros(1)}, {})
    with pytest.raises(InputError, match="another problem"):
        open_store(path, "abd")
    assert open_store(path).names() == {"part"}


def test_missing_store_and_missing_shard_raise_format_error(path: str) -> None:
    with pytest.raises(FormatError, match="there is no store"):
        open_store(path)
    with pytest.raises(FormatError, match="is missing or damaged"):
        open_store(path, "abc").load("part")


def test_a_damaged_shard_is_named(tmp_path: Path) -> None:
    store = open_store(tmp_path / "runs", "abc")
    store.save("part", {"y": np.zeros(100)}, {})
    file = tmp_path / "runs" / "part.npz"
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(FormatError, match=r"part.npz' is missing or damaged .* delete it"):
        store.load("part")


def test_unfinished_files_are_not_listed(tmp_path: Path) -> None:
    store = open_store(tmp_path / "runs", "abc")
    (tmp_path / "runs" / ".part.npz.123.part").write_bytes(b"half of it")
    assert store.names() == frozenset()


def test_zarr_shard_without_facts_is_not_listed(tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr")
    path = str(tmp_path / "runs.zarr")
    open_store(path, "abc").save("whole", {"y": np.zeros(2)}, {})
    zarr.open_group(path, mode="a").create_group("half")
    assert open_store(path, "abc").names() == {"whole"}


def test_missing_zarr_raises_with_the_extra_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(InputError, match="pip install zarr"):
        open_store(tmp_path / "runs.zarr", "abc")


def test_other_content_at_the_path_raises_format_error(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("data")
    with pytest.raises(FormatError, match="is not a store of liehom"):
        open_store(tmp_path, "abc")
    with pytest.raises(FormatError, match="is not a store of liehom"):
        open_store(tmp_path / "mine.txt", "abc")
    (tmp_path / "store.json").write_text("{}")
    with pytest.raises(FormatError, match="is not a store of liehom of this version"):
        open_store(tmp_path, "abc")
    (tmp_path / "store.json").write_text('{"format": "liehom-store", "version": 1, "fingerprint": "abc"}')
    with pytest.raises(FormatError, match="its format is 'liehom-store 1', expected 'liehom-store 2'"):
        open_store(tmp_path, "abc")
    (tmp_path / "store.json").write_text("{")
    with pytest.raises(FormatError, match="is damaged"):
        open_store(tmp_path, "abc")


@pytest.mark.parametrize("path", [3, None, ["a"]])
def test_invalid_path_raises_input_error(path: Any) -> None:
    with pytest.raises(InputError, match="expected the path"):
        open_store(path, "abc")
