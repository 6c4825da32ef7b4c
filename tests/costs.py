"""What each test module costs, in CPU seconds: `python -m pytest -n 2 --costs tests/costs.md` writes the table."""

import os
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

HEAD = """# What the tests cost

CPU seconds of the default run (`--costs tests/costs.md` writes this page), fixtures included, modules above {least} s.
This run: {tests} tests, {seconds:.0f} CPU seconds, besides collection.

| module | tests | CPU seconds |
|---|---:|---:|
"""
LEAST_SECONDS = 1.0


def cpu_seconds() -> float:
    """CPU time of this process and of the children that have ended."""
    return sum(os.times()[:4])


class Costs:
    """A pytest plugin: measures setup and call of each test, and writes the table at the end."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.seconds: dict[str, float] = defaultdict(float)
        self.tests: dict[str, int] = defaultdict(int)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Iterator[None]:
        yield from self._measured(item)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        yield from self._measured(item)

    def _measured(self, item: pytest.Item) -> Iterator[None]:
        before = cpu_seconds()
        try:
            return (yield)
        finally:
            item.user_properties.append(("cpu", cpu_seconds() - before))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Workers of xdist report here, in the process that writes the table."""
        if report.when == "teardown":
            module = report.nodeid.split("::")[0]
            self.tests[module] += 1
            self.seconds[module] += sum(value for name, value in report.user_properties if name == "cpu")

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if not hasattr(session.config, "workerinput"):
            self.file.write_text(self.table(), encoding="utf-8")

    def table(self) -> str:
        rows = sorted(self.seconds, key=lambda module: -self.seconds[module])
        text = HEAD.format(least=LEAST_SECONDS, tests=sum(self.tests.values()), seconds=sum(self.seconds.values()))
        for module in rows:
            if self.seconds[module] >= LEAST_SECONDS:
                text += f"| `{module}` | {self.tests[module]} | {self.seconds[module]:.1f} |\n"
        return text
