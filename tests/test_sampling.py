"""Samples of expensive tables: every entry names a test that exists; samples are spread and the same each time."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

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
    names = [f"test_table[{i}]" for i in range(100)]
    tables = {"tests/a.py": {"slow": ["test_table[0]"], "alone": ["test_table[1]"]}}

    def cases(shard: int) -> list[str]:
        monkeypatch.setattr(sampling, "shard", shard)
        return [name for name in names if sampling.in_shard("tests/a.py", name, tables)]

    for first in (0, 1000):  # numbers of shards go on
        dealt = [name for shard in range(sampling.SHARDS) for name in cases(first + shard)]
        assert sorted(dealt) == sorted(set(names) - {"test_table[1]"})


def test_a_whole_test_may_be_in_no_shard(monkeypatch: pytest.MonkeyPatch) -> None:
    tables = {"tests/a.py": {"alone": ["test_long"]}}
    seen = []
    for shard in range(sampling.SHARDS):
        monkeypatch.setattr(sampling, "shard", shard)
        seen += [sampling.in_shard("tests/a.py", name, tables) for name in ("test_long", "test_long[1]", "test_other")]
    assert sum(seen) == 1


SUITE = """
import pytest

@pytest.mark.slow
def test_long(): pass

@pytest.mark.parametrize("n", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in range(1, 9))])
def test_table(n): pass

def test_short(): pass
"""


def report(folder: Path, *options: str, seconds: float = 60.0) -> dict[str, str]:
    """What happens to the tests of a suite with the options of this one and a single shard, in their order."""
    (folder / "test_suite.py").write_text(SUITE)
    settings = f"from tests import sampling\nsampling.SHARDS, sampling.SHARD_SECONDS = 1, {seconds}\n"
    (folder / "conftest.py").write_text(settings + "from tests.conftest import *\n")
    command = [sys.executable, "-m", "pytest", "-c", str(sampling.ROOT / "pyproject.toml"), f"--rootdir={folder}"]
    text = subprocess.run(
        [*command, "-p", "no:cacheprovider", "-v", *options, "test_suite.py"],
        cwd=folder, env=os.environ | {"PYTHONPATH": str(sampling.ROOT)}, capture_output=True, text=True, timeout=60,
    ).stdout  # fmt: skip
    return dict(re.findall(r"^test_suite.py::(\S+) (\w+)", text, re.MULTILINE))


def test_a_shard_runs_after_the_default_tests_in_an_order_of_its_own(tmp_path: Path) -> None:
    first, second = list(report(tmp_path, "--shard=5")), list(report(tmp_path, "--shard=6"))
    assert first[:2] == second[:2] == ["test_table[0]", "test_short"]
    assert sorted(first) == sorted(second) == ["test_long", "test_short", *(f"test_table[{i}]" for i in range(9))]
    assert first != second


def test_a_shard_out_of_time_is_skipped_and_fails_nothing(tmp_path: Path) -> None:
    outcomes = report(tmp_path, "--shard=5", seconds=0.0)
    assert list(outcomes.values()) == ["PASSED"] * 3 + ["SKIPPED"] * 8
