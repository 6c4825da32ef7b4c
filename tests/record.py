"""What each test costs, and which functions of liehom it calls: `python -m pytest --record FILE` writes both.

    python -m tests.record FILE

prints the dearest modules, and the functions that no test of the run called. The calls are those of the process that
runs the test. A function counts from its first statement on, so that one that is traced by JAX counts as well.
"""

import ast
import builtins
import json
import os
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
Record = dict[str, tuple[float, list[str]]]
"""For each test its CPU seconds, set-up included, and the functions that it calls, as `liehom/a/b.py:Class.method`."""


def cpu_seconds() -> float:
    """CPU time of this process and of the children that have ended."""
    return sum(os.times()[:4])


def functions(tree: ast.AST, prefix: str) -> Iterator[tuple[str, ast.FunctionDef]]:
    """Functions and methods of a module that do something, by name; one inside a function counts as the outer one."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            # a docstring or an ellipsis alone says what others are to do
            if any(not isinstance(part, ast.Expr) or not isinstance(part.value, ast.Constant) for part in node.body):
                yield f"{prefix}{node.name}", node
        elif isinstance(node, ast.ClassDef):
            yield from functions(node, f"{prefix}{node.name}.")
        else:
            yield from functions(node, prefix)


class _Loader(SourceFileLoader):
    """Compiles a module so that each function first adds its name to the names of the called functions."""

    def get_code(self, fullname: str) -> CodeType:
        tree = ast.parse(self.get_data(self.path))
        for name, node in functions(tree, f"{Path(self.path).relative_to(ROOT).as_posix()}:"):
            call = ast.parse(f"__called__({name!r})").body[0]
            place = 1 if ast.get_docstring(node, clean=False) is not None else 0
            node.body.insert(place, call)
            for part in ast.walk(call):
                ast.copy_location(part, node.body[place + 1] if len(node.body) > place + 1 else node)
        return compile(tree, self.path, "exec", dont_inherit=True)


class _Finder:
    @staticmethod
    def find_spec(name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name.partition(".")[0] != "liehom":
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path)
        return spec


class Recorder:
    """A pytest plugin that measures each test and writes the record at the end; workers of xdist send it there."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.tests: dict[str, tuple[float, list[str]]] = {}
        self.called: set[str] = set()
        builtins.__called__ = self.called.add  # type: ignore[attr-defined]
        sys.meta_path.insert(0, _Finder)  # type: ignore[arg-type]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        before = cpu_seconds()
        self.called.clear()
        try:
            return (yield)
        finally:
            self.tests[item.nodeid] = round(cpu_seconds() - before, 4), sorted(self.called)

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if hasattr(session.config, "workerinput"):
            session.config.workeroutput["record"] = dumped(self.tests)  # type: ignore[attr-defined]
        else:
            self.file.write_text(dumped(self.tests), encoding="utf-8")

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        self.tests |= loaded(getattr(node, "workeroutput", {}).get("record", '{"names": [], "tests": {}}'))


def dumped(tests: Record) -> str:
    """A record as JSON, in which each function has a number."""
    names = sorted({name for _, called in tests.values() for name in called})
    number = {name: i for i, name in enumerate(names)}
    rows = {test: [seconds, [number[name] for name in called]] for test, (seconds, called) in tests.items()}
    return json.dumps({"names": names, "tests": rows})


def loaded(text: str) -> Record:
    """The record that `dumped` wrote."""
    data = json.loads(text)
    return {test: (s, [data["names"][i] for i in called]) for test, (s, called) in data["tests"].items()}


def uncalled(record: Record) -> list[str]:
    """The functions of liehom that no test of the record calls."""
    called = {name for _, names in record.values() for name in names}
    every = []
    for path in sorted((ROOT / "liehom").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        every += [name for name, _ in functions(tree, f"{path.relative_to(ROOT).as_posix()}:")]
    return [name for name in every if name not in called]


def report(record: Record, rows: int = 20) -> str:
    """The dearest modules of tests, and the functions that none of them calls."""
    seconds: dict[str, float] = defaultdict(float)
    for test, (cost, _) in record.items():
        seconds[test.split("::")[0]] += cost
    lines = [f"{len(record)} tests, {sum(seconds.values()):.0f} s of CPU time besides collection; the dearest modules:"]
    lines += [f"{seconds[module]:8.1f} s {module}" for module in sorted(seconds, key=lambda m: -seconds[m])[:rows]]
    lines += [f"more than a minute: {test}" for test, (cost, _) in sorted(record.items()) if cost > 60]
    without = uncalled(record)
    return "\n".join([*lines, f"{len(without)} functions that no test called in its own process:", *without])


if __name__ == "__main__":
    print(report(loaded(Path(sys.argv[1]).read_text(encoding="utf-8"))))
