"""The record of a run: what tests cost, and which functions of liehom they call."""

import ast
import builtins
from pathlib import Path

import pytest

from tests import record

SOURCE = '''"""Module."""
from __future__ import annotations


def plain(x: int) -> int:
    """First."""
    return x + 1


class Holder:
    @property
    def value(self) -> int:
        def inner() -> int:
            return 2

        return inner()

    def promised(self) -> int:
        """Of a protocol."""
        ...
'''


def test_functions_are_named_by_module_and_class() -> None:
    names = [name for name, _ in record.functions(ast.parse(SOURCE), "liehom/a.py:")]
    assert names == ["liehom/a.py:plain", "liehom/a.py:Holder.value"]


def test_a_module_that_is_loaded_for_a_record_tells_what_is_called(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, called = tmp_path / "a.py", set[str]()
    file.write_text(SOURCE)
    monkeypatch.setattr(record, "ROOT", tmp_path)
    monkeypatch.setattr(builtins, "__called__", called.add, raising=False)
    space: dict[str, object] = {}
    exec(record._Loader("a", str(file)).get_code("a"), space)
    assert called == set()
    assert space["plain"](1) == 2  # type: ignore[operator]
    assert called == {"a.py:plain"}
    assert space["Holder"]().value == 2  # type: ignore[operator]
    assert called == {"a.py:plain", "a.py:Holder.value"}
    assert space["plain"].__doc__ == "First."
    assert space["plain"].__code__.co_firstlineno == 5  # type: ignore[attr-defined]


def test_a_record_is_written_and_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "liehom").mkdir()
    (tmp_path / "liehom" / "a.py").write_text(SOURCE)
    monkeypatch.setattr(record, "ROOT", tmp_path)
    tests = {"a::b": (0.5, ["liehom/a.py:plain"]), "a::c": (0.25, []), "d::e": (62.0, ["liehom/a.py:plain"])}
    assert record.loaded(record.dumped(tests)) == tests
    text = record.report(tests, rows=1).splitlines()
    assert text[0].startswith("3 tests, 63 s")
    assert text[1].split() == ["62.0", "s", "d"]
    assert text[2:] == [
        "more than a minute: d::e",
        "1 functions that no test called in its own process:",
        "liehom/a.py:Holder.value",
    ]
