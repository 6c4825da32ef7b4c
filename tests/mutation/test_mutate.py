"""The mutants themselves: each is a module with one change, and each has its tests."""

import ast
import difflib
import random

import pytest

from tests.mutation import mutate
from tests.mutation.mutate import ROOT, mutants

MODULES = ["liehom/exact/fullness/checker/verify_modular.py", "liehom/flow/run/control.py"]


@pytest.mark.parametrize("module", MODULES)
def test_every_mutant_is_the_module_with_one_change(module: str) -> None:
    found = list(mutants(module))
    assert len({mutant.key for mutant in found}) == len(found) > 100
    plain = ast.unparse(ast.parse((ROOT / module).read_text(encoding="utf-8"))).splitlines()
    for mutant in random.Random(module).sample(found, 25):
        lines = mutant.source.splitlines()
        compile(mutant.source, module, "exec")
        changes = [line for line in difflib.ndiff(plain, lines) if line[0] in "+-"]
        assert 1 <= len(changes) <= 6, mutant.key


def test_all_sorts_of_changes_occur() -> None:
    kinds = {mutant.kind for module in MODULES for mutant in mutants(module)}
    assert kinds == {"comparison", "operator", "and/or", "negation left out", "constant + 1", "constant - 1",
                     "return None", "statement left out"} | ({"constant"} & kinds)  # fmt: skip


def test_the_own_tests_of_a_module_come_first() -> None:
    assert mutate.tests_of(MODULES[0])[0] == "tests/exact/fullness/checker/test_verify_modular.py"
    assert "tests/exact/fullness/checker/test_verify.py" in mutate.tests_of(MODULES[0])
    assert mutate.tests_of("liehom/exact/scalars/lattices.py")
