"""Change one place of a function, run the tests that call the function, and report the changes that no test notices.

    python -m pytest --record record.json                        # which tests call which functions
    python -m tests.mutation --record record.json 'liehom/exact/fullness/checker/*.py'
    python -m tests.mutation --record record.json --changed main --seconds 60

A change exchanges a comparison or an operation, `and` and `or`, a number with its neighbours, drops a negation or a
statement, or returns None. The tests are collected once. Each mutant is a fork in which the code of the function is
exchanged, and runs the tests that call it, cheapest first, up to the first that fails. Without a record the tests of
the mirrored folders are recorded first. Code that runs at import is not changed: module level, classes, defaults.
`equivalent.toml` lists mutants that change no result.
"""

import argparse
import gc
import importlib
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import FunctionType

import pytest
from hypothesis import Phase, settings

from tests.mutation.mutants import Mutant, equivalent, exchange, live_functions, mutants
from tests.record import ROOT, Record, loaded

PASSED, FAILED = 0, 1
LEAST_LIMIT = 10.0
"""CPU seconds that any mutant may take; otherwise five times what its tests take."""


class Mutation:
    """A pytest plugin whose test loop tries mutants in forks."""

    def __init__(self, chosen: Sequence[Mutant], record: Record, until: float, budget: float) -> None:
        self.chosen, self.until, self.budget = chosen, until, budget
        self.callers: dict[str, list[tuple[float, str]]] = defaultdict(list)
        for test, (seconds, called) in record.items():
            for function in called:
                self.callers[function].append((seconds, test))
        self.outcomes: Counter[str] = Counter()
        self.survivors: list[str] = []
        self.sound: dict[str, bool] = {}
        self.failures = 0

    @pytest.hookimpl(trylast=True)
    def pytest_configure(self) -> None:
        settings.register_profile(
            "mutation", parent=settings.get_profile("liehom"), phases=[Phase.explicit, Phase.generate]
        )
        settings.load_profile("mutation")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.failures += report.failed

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        items = {item.nodeid: item for item in session.items}
        modules = {mutant.module for mutant in self.chosen}
        for module in modules:
            importlib.import_module(module.removesuffix(".py").removesuffix("/__init__").replace("/", "."))
        functions = live_functions(modules)
        gc.freeze()
        for mutant in self.chosen:
            if time.monotonic() > self.until:
                self.outcomes["not tried"] += 1
                continue
            start = time.monotonic()
            outcome = self.outcome(mutant, items, functions)
            self.outcomes[outcome.partition(" by")[0]] += 1
            if outcome.startswith(("survived", "no test")):
                self.survivors.append(f"{mutant} ({outcome})")
            print(f"{time.monotonic() - start:6.2f} s {outcome}: {mutant}", flush=True)
        return True

    def outcome(self, mutant: Mutant, items: dict[str, pytest.Item], functions: Iterable[FunctionType]) -> str:
        """What the tests make of a mutant: killed, timed out, survived, or no test."""
        tests, total = [], 0.0
        for seconds, test in sorted(self.callers[mutant.function]):
            if test in items and self.sound.get(test, True) and total + seconds < self.budget:
                tests.append(test)
                total += seconds
        if not tests:
            return "no test calls it"
        limit = max(LEAST_LIMIT, 5 * total)
        status, number = _forked(lambda: self.run(tests, items, mutant, functions), limit)
        if status == PASSED:
            return "survived" if len(tests) == len(self.callers[mutant.function]) else f"survived {len(tests)} tests"
        if status != FAILED:
            return "timed out" if status == -signal.SIGXCPU else f"crashed by signal {-status}"
        killer = tests[number]
        if killer not in self.sound:
            self.sound[killer] = _forked(lambda: self.run([killer], items, None, ()), limit)[0] == PASSED
        return f"killed by {killer}" if self.sound[killer] else self.outcome(mutant, items, functions)

    def run(
        self, tests: list[str], items: dict[str, pytest.Item], mutant: Mutant | None, functions: Iterable[FunctionType]
    ) -> int | None:
        """In the child: the index of the first test that fails, or None."""
        if mutant is not None:
            exchange(functions, mutant.module, mutant.codes)
        for number, test in enumerate(tests):
            following = items[tests[number + 1]] if number + 1 < len(tests) else None
            items[test].config.hook.pytest_runtest_protocol(item=items[test], nextitem=following)
            if self.failures:
                return number
        return None


def _forked(run: object, limit: float) -> tuple[int, int]:
    """The exit status of a fork, negative for a signal, and the number that it returns."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        status = FAILED
        try:
            silent = os.open(os.devnull, os.O_RDWR)
            for descriptor in (0, 1, 2):
                os.dup2(silent, descriptor)
            resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 2))
            number = run()  # type: ignore[operator]
            os.write(writer, str(number or 0).encode())
            status = PASSED if number is None else FAILED
        finally:
            os._exit(status)
    os.close(writer)
    with os.fdopen(reader) as pipe:
        signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGXCPU))  # a child that waits for ever
        signal.setitimer(signal.ITIMER_REAL, 3 * limit)
        _, status = os.waitpid(child, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        return os.waitstatus_to_exitcode(status), int(pipe.read() or 0)


def changed_lines(base: str) -> dict[str, set[int]]:
    """The lines of modules of liehom that differ from a commit."""
    command = ["git", "diff", "-U0", "--no-color", base, "--", "liehom/*.py"]
    text = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    lines: dict[str, set[int]] = {}
    for line in text.splitlines():
        if line.startswith("+++ b/"):
            module = line.removeprefix("+++ b/")
        elif match := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line):
            first, count = int(match[1]), int(match[2] or 1)
            lines.setdefault(module, set()).update(range(first, first + count))
    return {module: numbers for module, numbers in lines.items() if numbers}


def mirrored(module: str) -> Path:
    """The test module of a module, or else the nearest folder of tests."""
    path = ROOT / "tests" / Path(module).relative_to("liehom").with_name(f"test_{Path(module).name}")
    while not path.exists():
        path = path.parent
    return path


def main() -> int:
    """Exit status 1 if a mutant survived."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("modules", nargs="*", help="patterns of paths below the root")
    parser.add_argument("--record", type=Path, default=Path("record.json"), help="default: record.json")
    parser.add_argument("--changed", metavar="BASE", help="mutate the lines that differ from this commit")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="stop after this time")
    parser.add_argument("--budget", type=float, default=20, help="CPU seconds of tests for one mutant (default: 20)")
    parser.add_argument("--count", type=int, help="size of a random sample of the mutants")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--matching", default="", help="only mutants whose line of the report contains this")
    given, options = parser.parse_known_args()
    until = time.monotonic() + given.seconds
    lines: dict[str, set[int] | None] = {
        path.relative_to(ROOT).as_posix(): None for pattern in given.modules for path in sorted(ROOT.glob(pattern))
    }
    lines |= changed_lines(given.changed) if given.changed else {}
    known = equivalent()
    pool = [
        m for module, numbers in lines.items() for m in mutants(module, numbers) if m.key not in known.get(module, {})
    ]
    pool = [mutant for mutant in pool if given.matching in str(mutant)]
    random.Random(given.seed).shuffle(pool)
    print(f"{len(pool)} mutants of {len(lines)} modules")
    quiet = ["-q", "-p", "no:cacheprovider", "--assert=plain", "--tb=no", "-s", *options]
    if not given.record.exists():
        files = sorted({str(mirrored(module)) for module in lines})
        subprocess.run([sys.executable, "-m", "pytest", *quiet, "--record", str(given.record), *files], cwd=ROOT)
    later = [p for p in (ROOT / "tests").rglob("test_*.py") if p.stat().st_mtime > given.record.stat().st_mtime]
    if later:
        print(f"{len(later)} test modules are newer than {given.record}: their new tests do not count")
    record = loaded(given.record.read_text(encoding="utf-8"))
    chosen = pool[: given.count]
    mutated = {mutant.function for mutant in chosen}
    files = sorted({test.partition("::")[0] for test, (_, called) in record.items() if mutated & set(called)})
    mutation = Mutation(chosen, record, until, given.budget)
    if chosen and files:
        pytest.main([*quiet, "--no-header", *files], plugins=[mutation])
    print(", ".join(f"{count} {outcome}" for outcome, count in mutation.outcomes.items()))
    for survivor in mutation.survivors:
        print("*", survivor)
    return int(bool(mutation.survivors))


if __name__ == "__main__":
    sys.exit(main())
