"""Mutants: each is its module with one change of one function, and the tool tells those that tests notice."""

import ast
import random
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.mutation import __main__ as tool
from tests.mutation.mutants import codes_of, equivalent, exchange, live_functions, mutants
from tests.record import ROOT

ROOTS = "liehom/exact/fullness/checker/verify_roots.py"
MODULES = [ROOTS, "liehom/exact/fullness/checker/verify_modular.py", "liehom/flow/run/control.py"]


@pytest.mark.parametrize("module", MODULES)
def test_a_mutant_changes_its_function_alone(module: str) -> None:
    found = list(mutants(module))
    assert len({mutant.key for mutant in found}) == len(found) > 100
    plain = codes_of(compile((ROOT / module).read_text(encoding="utf-8"), str(ROOT / module), "exec"))
    for mutant in random.Random(module).sample(found, 25):
        codes = mutant.codes
        changed = {name for name, line in codes if codes[name, line] != plain.get((name, line))}
        name = mutant.function.partition(":")[2]
        assert changed, mutant
        # the body of a class holds the codes of its methods
        assert all(f"{name}.".startswith(f"{other}.") or other.startswith(f"{name}.<locals>") for other in changed), (
            mutant
        )
    assert [m.key for m in mutants(module)] == [m.key for m in found]


def test_changes_of_all_sorts_occur() -> None:
    texts = [mutant.change for module in MODULES for mutant in mutants(module)]
    for part in ("<=", "!=", " or ", "return None", "`pass`", " + ", "`1` -> `2`", "`1` -> `0`", "`not "):
        assert any(part in text for text in texts), part


def test_only_changed_lines_are_mutated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    line = next(i for i, text in enumerate((ROOT / ROOTS).read_text().splitlines(), 1) if "rest[top] * inverse" in text)
    assert [m.change for m in mutants(ROOTS, {line})] == ["`rest[top] * inverse` -> `rest[top] + inverse`"]
    (tmp_path / "liehom").mkdir()
    file = tmp_path / "liehom" / "a.py"
    file.write_text("x = 1\ny = 2\nz = 3\n")
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "first"]):
        subprocess.run([*git, *command], cwd=tmp_path, check=True)
    file.write_text("x = 1\ny = 3\nz = 3\nt = 4\nu = 5\n")
    monkeypatch.setattr(tool, "ROOT", tmp_path)
    assert tool.changed_lines("HEAD") == {"liehom/a.py": {2, 4, 5}}


def test_a_function_has_the_code_of_its_mutant_until_it_is_given_back() -> None:
    from liehom.exact.fullness.checker import verify_roots

    functions = live_functions([ROOTS])
    before = [(f, f.__code__) for f in functions]
    mutant = next(m for m in mutants(ROOTS) if m.key == "variations: `a != b` -> `a == b`")
    assert verify_roots.variations([1, -1, 1]) == 2
    exchange(functions, ROOTS, mutant.codes)
    try:
        assert verify_roots.variations([1, -1, 1]) == 0
    finally:
        for function, code in before:
            function.__code__ = code
    assert verify_roots.variations([1, -1, 1]) == 2


def test_the_nearest_tests_of_a_module_are_recorded() -> None:
    assert tool.mirrored(ROOTS) == ROOT / "tests/exact/fullness/checker/test_verify_roots.py"
    assert tool.mirrored("liehom/exact/fullness/search/dominance.py") == ROOT / "tests/exact/fullness/search"


def test_equivalent_mutants_exist() -> None:
    for module, keys in equivalent().items():
        there = Counter(mutant.key for mutant in mutants(module))
        assert set(keys) <= set(there), f"{module}: {sorted(set(keys) - set(there))}"


@pytest.mark.slow
def test_the_tool_tells_the_mutants_that_tests_notice(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.mutation", "--record", str(tmp_path / "record.json"), ROOTS]
    run = subprocess.run([*command, "--matching", " divided:"], cwd=ROOT, capture_output=True, text=True)
    survivors = [line for line in run.stdout.splitlines() if line.startswith("* ")]
    assert (run.returncode, survivors) == (0, []), run.stderr
    assert run.stdout.count("killed by tests/exact/fullness/checker/test_verify_roots.py::") > 20


def test_places_outside_of_functions_are_left_alone() -> None:
    tree = ast.parse((ROOT / MODULES[1]).read_text(encoding="utf-8"))
    inside = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for mutant in mutants(MODULES[1]):
        assert any(f.body[0].lineno <= mutant.line <= (f.end_lineno or 0) for f in inside), mutant
