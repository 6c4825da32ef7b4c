"""Options shared by the whole suite: `--slow`, samples of expensive tables, and hypothesis without a clock."""

import os
import signal
import time
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
    parser.addoption(
        "--shard", metavar="K", type=int, help="also run shard K of what is left out, for a minute at most"
    )
    parser.addoption("--record", metavar="FILE", type=Path, help="write what each test costs and calls")


def pytest_configure(config: pytest.Config) -> None:
    # a run in the background has an ignored SIGINT, which the processes that tests interrupt would inherit
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if (cache := getattr(config, "cache", None)) is not None:
        # a folder for each worker, since JAX does not write whole files
        folder = cache.mkdir(f"jax-{os.environ.get('PYTEST_XDIST_WORKER', 'main')}")
        os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(folder))
        os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.1")
    sampling.whole = config.getoption("--slow") or config.getoption("benchmark_enable", default=False)
    sampling.shard = config.getoption("--shard")
    # deadline: the suite shares two cores, so a slow example says nothing about the code;
    # derandomize: a run is the same run everywhere, and a failure found once is found again, except with a shard,
    # which is there to find what other runs do not, and takes --hypothesis-seed
    settings.register_profile(
        "liehom",
        deadline=None,
        derandomize=sampling.shard is None,
        database=None,
        print_blob=True,
        max_examples=sampling.examples(100),
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
    module, name, tables = sampling.module_of(metafunc.definition.path), metafunc.definition.name, sampling.table()
    whole_test = metafunc.definition.get_closest_marker("slow") is not None
    slow = {call.id for call in calls if whole_test or any(mark.name == "slow" for mark in call.marks)}
    ids = [call.id for call in calls if call.id not in slow]
    chosen = {ids[i] for i in sampling.kept(module, name, ids, tables)}
    more = {c.id for c in calls if c.id not in chosen and sampling.in_shard(module, f"{name}[{c.id}]", tables)}
    for call in calls:
        if call.id in more:
            call.marks.append(pytest.mark.shard.mark)
    left = [call for call in calls if call.id in chosen | more]
    if not left:  # a test without cases would run without its parameters
        calls[0].marks.append(pytest.mark.slow.mark)
    calls[:] = left or calls[:1]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    slow = {item for item in items if item.get_closest_marker("slow")}
    if not runs_whole(config):
        tables = sampling.table()
        slow |= {item for item in items if item.name in tables.get(sampling.module_of(item.path), {}).get("slow", ())}
        for item in slow:
            if sampling.in_shard(sampling.module_of(item.path), item.name, tables):
                item.add_marker(pytest.mark.shard)
    shard = {item for item in items if item.get_closest_marker("shard")}
    places = sampling.shuffled({item.nodeid for item in shard})
    if left_out := slow - shard:
        config.hook.pytest_deselected(items=[item for item in items if item in left_out])
    items[:] = sorted((i for i in items if i not in left_out), key=lambda item: places.get(item.nodeid, -1))


shard_began: list[float] = []


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("shard"):
        shard_began.append(time.monotonic())
        if shard_began[-1] - shard_began[0] > sampling.SHARD_SECONDS:
            pytest.skip(f"the {sampling.SHARD_SECONDS:.0f} s of the shard are over")
