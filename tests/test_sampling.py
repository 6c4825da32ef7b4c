"""Samples of expensive tables: every entry names a test that exists; samples are spread and the same each time."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests import sampling


@dataclass(frozen=True)
class Case:
    name: str
    path: Path


def test_every_entry_names_a_test_that_exists() -> None:
    wrong = []
    for module, entry in sampling.table().items():
        path = sampling.ROOT / module
        tree = ast.parse(path.read_text(encoding="utf-8")) if path.exists() else ast.Module([], [])
        tests = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        named = {*entry.get("sample", ()), *(name.split("[")[0] for name in entry.get("slow", ()))}
        wrong += [f"{module}::{name}" for name in named - tests]
    assert not wrong, f"tests/samples.toml names what is not there: {sorted(wrong)}"


def test_a_sample_takes_cases_from_everywhere() -> None:
    cases = [Case(f"test_table[{i}]", sampling.ROOT / "tests/a.py") for i in range(100)]
    tables = {"tests/a.py": {"sample": {"test_table": 10}, "slow": ["test_table[0]"]}}
    left = {case.name for case in sampling.left_out(cases, tables)}
    kept = [i for i, case in enumerate(cases) if case.name not in left]
    assert len(kept) == 10
    assert 0 not in kept
    assert all(any(low <= i < low + 20 for i in kept) for low in range(0, 100, 20))
    assert left == {case.name for case in sampling.left_out(cases, tables)}


def test_other_tables_stay_whole() -> None:
    cases = [Case("test_other[1]", sampling.ROOT / "tests/a.py"), Case("test_table[1]", Path("/elsewhere/tests/a.py"))]
    assert not sampling.left_out(cases, {"tests/a.py": {"sample": {"test_table": 0}}})


def test_fewer_examples_are_drawn_by_default() -> None:
    assert sampling.examples(400) == (400 if sampling.whole else 100)
    assert sampling.examples(6) >= 5


def test_a_slow_case_that_does_not_exist_is_an_error() -> None:
    cases = [Case("test_table[1]", sampling.ROOT / "tests/a.py")]
    with pytest.raises(ValueError, match=r"tests/a\.py has no case \['test_table\[0\]'\]"):
        sampling.left_out(cases, {"tests/a.py": {"slow": ["test_table[0]"]}})
