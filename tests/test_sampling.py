"""Samples of expensive tables: every entry names a test that exists; samples are spread and the same each time."""

import ast

import pytest

from tests import sampling


@pytest.fixture(autouse=True)
def no_shard(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "shard", None)


def test_every_entry_names_a_test_that_exists() -> None:
    wrong = []
    for module, entry in sampling.table().items():
        path = sampling.ROOT / module
        tree = ast.parse(path.read_text(encoding="utf-8")) if path.exists() else ast.Module([], [])
        tests = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        single = [*entry.get("slow", ()), *entry.get("alone", ())]
        named = {*entry.get("sample", ()), *(name.split("[")[0] for name in single)}
        wrong += [f"{module}::{name}" for name in named - tests]
    assert not wrong, f"tests/samples.toml names what is not there: {sorted(wrong)}"


def test_a_sample_takes_cases_from_everywhere() -> None:
    ids = [str(i) for i in range(100)]
    tables = {"tests/a.py": {"sample": {"test_table": 10}, "slow": ["test_table[0]"]}}
    chosen = sampling.kept("tests/a.py", "test_table", ids, tables)
    assert len(chosen) == 10
    assert 0 not in chosen
    assert all(any(low <= i < low + 20 for i in chosen) for low in range(0, 100, 20))
    assert chosen == sampling.kept("tests/a.py", "test_table", ids, tables)


def test_other_tables_stay_whole() -> None:
    tables = {"tests/a.py": {"sample": {"test_table": 0}}}
    assert sampling.kept("tests/a.py", "test_other", ["1"], tables) == [0]
    assert sampling.kept("elsewhere/tests/a.py", "test_table", ["1"], tables) == [0]
    assert sampling.kept("tests/a.py", "test_table", ["1"], tables) == []


def test_fewer_examples_are_drawn_by_default() -> None:
    assert sampling.examples(400) == (400 if sampling.whole else 100)
    assert sampling.examples(6) >= 5


def test_a_slow_case_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(ValueError, match=r"tests/a\.py has no case \['test_table\[0\]'\]"):
        sampling.kept("tests/a.py", "test_table", ["1"], {"tests/a.py": {"slow": ["test_table[0]"]}})


def test_each_case_that_is_left_out_is_in_one_shard(monkeypatch: pytest.MonkeyPatch) -> None:
    ids = [str(i) for i in range(100)]
    tables = {"tests/a.py": {"sample": {"test_table": 10}, "slow": ["test_table[0]"], "alone": ["test_table[1]"]}}
    default = set(sampling.kept("tests/a.py", "test_table", ids, tables))
    added = []
    for shard in range(sampling.SHARDS):
        monkeypatch.setattr(sampling, "shard", shard)
        chosen = set(sampling.kept("tests/a.py", "test_table", ids, tables))
        assert default <= chosen
        added += chosen - default
    assert sorted(added) == sorted(set(range(100)) - default - {1})


def test_a_whole_test_may_be_in_no_shard(monkeypatch: pytest.MonkeyPatch) -> None:
    tables = {"tests/a.py": {"alone": ["test_long"]}}
    seen = []
    for shard in range(sampling.SHARDS):
        monkeypatch.setattr(sampling, "shard", shard)
        seen += [sampling.in_shard("tests/a.py", name, tables) for name in ("test_long", "test_long[1]", "test_other")]
    assert sum(seen) == 1
