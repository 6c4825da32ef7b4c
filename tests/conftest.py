"""Options shared by the whole suite: `--slow`, samples of expensive tables, and hypothesis without a clock."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from hypothesis import settings

from tests import sampling
from tests.costs import Costs


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="also run the tests marked slow, and every table whole")
    parser.addoption("--costs", metavar="FILE", type=Path, help="write what each test module costs")


def pytest_configure(config: pytest.Config) -> None:
    # a run in the background has an ignored SIGINT, which the processes that tests interrupt would inherit
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    sampling.whole = config.getoption("--slow") or config.getoption("benchmark_enable", default=False)
    # deadline: the suite shares two cores, so a slow example says nothing about the code;
    # derandomize: a run is the same run everywhere, and a failure found once is found again
    settings.register_profile(
        "liehom", deadline=None, derandomize=True, print_blob=True, max_examples=sampling.examples(100)
    )
    settings.load_profile("liehom")
    if config.getoption("--costs") is not None:
        config.pluginmanager.register(Costs(config.getoption("--costs")))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    slow = {item for item in items if item.get_closest_marker("slow")}
    named = {arg.split("::")[-1] for arg in config.args if "::" in arg}  # a test asked for by name runs whole
    if not named and not sampling.whole:
        slow.update(sampling.left_out([item for item in items if item not in slow], sampling.table()))
    if slow:
        config.hook.pytest_deselected(items=[item for item in items if item in slow])
        items[:] = [item for item in items if item not in slow]
