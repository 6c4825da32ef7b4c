"""Mutation testing: change one place of a module, run the tests of this module, and report the mutants that survive.

    python tests/mutation/mutate.py --count 40 --seed 1 --results mutants.jsonl 'liehom/fullness/checker/*.py'
    python tests/mutation/mutate.py --results mutants.jsonl --report

Each mutant is one change of the syntax tree: another comparison, `+` for `-`, `and` for `or`, a number one larger or
smaller, True for False, a negation left out, None returned, a statement left out. A sample of the mutants of all
given modules is drawn with the seed. A copy of the repository is mutated, never the repository itself. The results are
written one a line, and a run that is continued skips the mutants that it has tried.

The tests of a module are the test modules of the mirrored folder, the nearest first: for liehom/a/b/x.py these are
tests/a/b/test_x.py, then the other tests in tests/a/b; if there are none, those in tests/a. `--tests` names others,
where a module is tested in another folder or its folder takes too long. SURVIVORS.md explains the survivors.
"""

from __future__ import annotations

import argparse
import ast
import copy
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
OPERATIONS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Add, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv, ast.Pow: ast.Mult, ast.LShift: ast.RShift, ast.RShift: ast.LShift, ast.MatMult: ast.Add,
}  # fmt: skip
TIMED_OUT = "timed out"
Place = tuple[tuple[str, int | None], ...]
"""The way from the root of a syntax tree to a node: names of fields, with indices."""


@dataclass(frozen=True)
class Mutant:
    """A module with one change."""

    module: str
    line: int
    change: str
    number: int
    place: Place
    kind: str

    @property
    def key(self) -> str:
        return f"{self.module}:{self.line} #{self.number} {self.change}"

    @property
    def source(self) -> str:
        """The module with this change."""
        tree = ast.parse((ROOT / self.module).read_text(encoding="utf-8"))
        after = dict(changes(_at(tree, self.place)))[self.kind]
        _put(tree, self.place, ast.Pass() if after is None else after)
        return ast.unparse(ast.fix_missing_locations(tree))


# -- mutants -----------------------------------------------------------------------------------------------
def changes(node: ast.AST) -> Iterator[tuple[str, ast.AST | None]]:
    """The changes of one node: a description and the new node; None leaves a statement out."""
    match node:
        case ast.Compare(ops=[operator]) if type(operator) in COMPARISONS:
            other = copy.deepcopy(node)
            other.ops = [COMPARISONS[type(operator)]()]
            yield "comparison", other
        case ast.BinOp() if type(node.op) in OPERATIONS and not _is_text(node):
            yield "operator", _with(node, op=OPERATIONS[type(node.op)]())
        case ast.BoolOp():
            yield "and/or", _with(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
            yield "negation left out", operand
        case ast.Constant(value=bool(value)):
            yield "constant", ast.Constant(not value)
        case ast.Constant(value=int(value)):
            yield "constant + 1", ast.Constant(value + 1)
            yield "constant - 1", ast.Constant(value - 1)
        case ast.Return(value=ast.expr() as value) if not (isinstance(value, ast.Constant) and value.value is None):
            yield "return None", ast.Return(ast.Constant(None))
        case ast.AugAssign() | ast.Raise() | ast.Continue() | ast.Break():
            yield "statement left out", None
        case ast.Expr(value=ast.Call()):
            yield "statement left out", None


def _with(node: ast.AST, **fields: object) -> ast.AST:
    made = copy.deepcopy(node)
    for name, value in fields.items():
        setattr(made, name, value)
    return made


def _is_text(node: ast.BinOp) -> bool:
    sides = (node.left, node.right)
    return any(isinstance(s, (ast.JoinedStr, ast.List)) or getattr(s, "value", None).__class__ is str for s in sides)


def mutants(module: str) -> Iterator[Mutant]:
    """All mutants of a module. Annotations, messages of errors, decorators and imports are left as they are."""
    tree, number = ast.parse((ROOT / module).read_text(encoding="utf-8")), 0
    for place in _places(tree, ()):
        before = _at(tree, place)
        for change, after in changes(before):
            old = ast.unparse(before).splitlines()[0]
            new = "pass" if after is None else ast.unparse(ast.fix_missing_locations(after)).splitlines()[0]
            yield Mutant(module, getattr(before, "lineno", 0), f"{change}: `{old}` -> `{new}`", number, place, change)
            number += 1


SKIPPED = {"annotation", "returns", "decorator_list", "type_params", "exc", "bases"}


def _places(node: ast.AST, path: Place) -> Iterator[Place]:
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.JoinedStr)):
        return
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        return
    if isinstance(node, ast.keyword) and node.arg == "strict":  # zip's own check of equal lengths
        return
    yield path
    for name, value in ast.iter_fields(node):
        if name in SKIPPED:
            continue
        for index, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(child, ast.AST):
                yield from _places(child, (*path, (name, index)))


def _at(node: ast.AST, path: Place) -> ast.AST:
    for name, index in path:
        value = getattr(node, name)
        node = value if index is None else value[index]
    return node


def _put(tree: ast.AST, path: Place, new: ast.AST) -> None:
    parent, (name, index) = _at(tree, path[:-1]), path[-1]
    if index is None:
        setattr(parent, name, new)
    else:
        getattr(parent, name)[index] = new


# -- running -----------------------------------------------------------------------------------------------
def tests_of(module: str) -> list[str]:
    """The test modules of a module, the nearest first."""
    path = Path(module)
    folder = ROOT / "tests" / path.parent.relative_to("liehom")
    own = folder / f"test_{path.stem}.py"
    found = [own] if own.exists() else []
    while not any(folder.rglob("test_*.py")):
        folder = folder.parent
    near = list(folder.glob("test_*.py")) or list(folder.rglob("test_*.py"))
    found += [p for p in sorted(near, key=lambda p: p.stat().st_size) if p != own]
    return [p.relative_to(ROOT).as_posix() for p in found]


def tested(copied: Path, tests: list[str], timeout: float) -> subprocess.CompletedProcess[str] | None:
    """The run of the tests in the copy up to the first that fails, or None if it took too long."""
    environment = os.environ | {"PYTHONPATH": str(copied), "PYTHONDONTWRITEBYTECODE": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider", *tests]
    try:
        return subprocess.run(command, cwd=copied, env=environment, timeout=timeout, capture_output=True, text=True)
    except subprocess.TimeoutExpired:
        return None


def outcome(copied: Path, mutant: Mutant, tests: list[str], timeout: float) -> str:
    """'killed by MODULE', 'timed out' (counted as killed) or 'survived'."""
    target = copied / mutant.module
    original = target.read_text(encoding="utf-8")
    try:
        target.write_text(mutant.source, encoding="utf-8")
        made = tested(copied, tests, timeout)
    finally:
        target.write_text(original, encoding="utf-8")
    if made is None:
        return TIMED_OUT
    if made.returncode == 0:
        return "survived"
    lines = [line for line in made.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return f"killed by {Path(lines[0].split()[1].split('::')[0]).name if lines else 'the import'}"


def run(
    modules: list[str], count: int, seed: int, results: Path, timeout: float, only: list[str], named: list[str]
) -> None:
    """Try a sample of the mutants; append one line of JSON for each."""
    pool = [mutant for module in modules for mutant in mutants(module)]
    random.Random(seed).shuffle(pool)
    done = {json.loads(line)["mutant"] for line in results.read_text().splitlines()} if results.exists() else set()
    print(f"{len(pool)} mutants of {len(modules)} modules")
    with tempfile.TemporaryDirectory() as folder:
        copied = Path(folder) / "copy"
        for name in ("liehom", "tests", "docs", "examples"):
            shutil.copytree(ROOT / name, copied / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md", "CONTRIBUTING.md"):
            shutil.copy(ROOT / name, copied / name)
        seconds_of: dict[str, float] = {}
        for mutant in [m for m in pool if only == [] or m.key in only][:count]:
            if mutant.key in done:
                continue
            tests = named or tests_of(mutant.module)
            start = time.monotonic()
            if tests[0] not in seconds_of:  # do the tests pass without a mutant, and how long do they take
                right = tested(copied, tests, timeout)
                seconds_of[tests[0]] = time.monotonic() - start
                if right is None or right.returncode != 0:
                    print(f"{mutant.module} is left out, as its tests do not pass without a mutant")
                    print("\n".join(right.stdout.splitlines()[-5:]) if right else f"in {timeout} s")
                    seconds_of[tests[0]] = 0.0
            if not seconds_of[tests[0]]:
                continue
            start = time.monotonic()
            found = outcome(copied, mutant, tests, min(timeout, max(30.0, 5 * seconds_of[tests[0]])))
            seconds = round(time.monotonic() - start, 1)
            with results.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"mutant": mutant.key, "outcome": found, "seconds": seconds}) + "\n")
            print(f"{found:40} {seconds:6} {mutant.key}", flush=True)


def report(results: Path) -> None:
    """Print the figures for each module, and the survivors."""
    lines = [json.loads(line) for line in results.read_text(encoding="utf-8").splitlines()]
    tried: Counter[str] = Counter(line["mutant"].split(":")[0] for line in lines)
    alive = [line["mutant"] for line in lines if line["outcome"] == "survived"]
    survived = Counter(key.split(":")[0] for key in alive)
    print("| module | mutants | killed | survived |\n|---|---|---|---|")
    for module in sorted(tried):
        print(f"| `{module}` | {tried[module]} | {tried[module] - survived[module]} | {survived[module]} |")
    print(f"| together | {tried.total()} | {tried.total() - len(alive)} | {len(alive)} |\n")
    for key in alive:
        print(f"* {key}")


def main() -> None:
    """Read the command line; see the docstring of the module."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("modules", nargs="*", help="paths or patterns relative to the repository")
    parser.add_argument("--count", type=int, default=50, help="mutants in the sample")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--timeout", type=float, default=300, help="most seconds for the tests, with a mutant or without"
    )
    parser.add_argument("--results", type=Path, default=Path("mutants.jsonl"))
    parser.add_argument("--only", action="append", default=[], help="try this mutant, named as in the results")
    parser.add_argument("--tests", nargs="+", default=[], help="test modules for all mutants, not the mirrored ones")
    parser.add_argument("--report", action="store_true", help="print a table of the results instead")
    chosen = parser.parse_args()
    if chosen.report:
        report(chosen.results)
        return
    found = sorted({p.relative_to(ROOT).as_posix() for pattern in chosen.modules for p in ROOT.glob(pattern)})
    modules = [m for m in found if not m.endswith("__init__.py")]
    run(modules, chosen.count, chosen.seed, chosen.results, chosen.timeout, chosen.only, chosen.tests)


if __name__ == "__main__":
    main()
