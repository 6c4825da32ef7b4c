"""Options shared by the whole suite: `--slow`, samples of expensive tables, and hypothesis without a clock."""

import os
import signal
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import settings

from tests import sampling
from tests.record import Recorder

# before numpy is loaded: workers that share the cores compute many small products, on which more threads only wait
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="also run the tests marked slow, and every table whole")
    parser.addoption("--record", metavar="FILE", type=Path, help="write what each test costs and calls")


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
    if config.getoption("--record") is not None:
        config.pluginmanager.register(Recorder(config.getoption("--record")))


def runs_whole(config: pytest.Config) -> bool:
    """Whether nothing is left out: with --slow, for benchmarks, and for a test that is asked for by name."""
    return sampling.whole or any("::" in argument for argument in config.args)


@pytest.hookimpl(wrapper=True)
def pytest_generate_tests(metafunc: pytest.Metafunc) -> Generator[None]:
    """Leave cases out before pytest makes items of them, which takes longer than to run most of them."""
    yield
    calls = metafunc._calls
    if not calls or runs_whole(metafunc.config):
        return
    fast = [call for call in calls if all(mark.name != "slow" for mark in call.marks)]
    chosen = sampling.kept(
        sampling.module_of(metafunc.definition.path),
        metafunc.definition.name,
        [call.id for call in fast],
        sampling.table(),
    )
    if not chosen:  # a test without cases would run without its parameters
        calls[0].marks.append(pytest.mark.slow.mark)
    calls[:] = [fast[i] for i in chosen] or calls[:1]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    slow = {item for item in items if item.get_closest_marker("slow")}
    if not runs_whole(config):
        tables = sampling.table()
        slow |= {item for item in items if item.name in tables.get(sampling.module_of(item.path), {}).get("slow", ())}
    if slow:
        config.hook.pytest_deselected(items=[item for item in items if item in slow])
        items[:] = [item for item in items if item not in slow]
