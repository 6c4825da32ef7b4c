"""What a decision costs in a warm process, reading and proofs of the axioms included; beside a floor in plain flint.

In the ordinary run each benchmark is executed once, as a test. For figures:

    python -m pytest tests/benchmarks -n 0 --benchmark-enable --benchmark-group-by=group
"""

import json
import random
import statistics
import time
from collections.abc import Callable
from functools import cache
from typing import Any

import flint
import pytest

import liehom as lh
from liehom.testing import random_unimodular
from tests import sampling
from tests.exact.catalog.claims import CLAIMS


@cache
def small() -> list[str]:
    return [name for name in lh.catalog.pair_names() if lh.pair(name).algebra.dimension <= 30]


def text_of(name: str, scrambled: bool) -> str:
    """The JSON text of a catalogue pair, in a random unimodular basis if asked."""
    pair = lh.pair(name)
    n = pair.algebra.dimension
    if scrambled and n > 1:
        pair = pair.change_of_basis(random_unimodular(n, random.Random(n), 4 * n))
    return json.dumps(lh.to_json(pair))


def seconds(action: Callable[[], Any]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def decided(text: str) -> Any:
    """Read the pair, prove its axioms, decide it."""
    return lh.decide_fullness(lh.loads(text))


@pytest.mark.parametrize("scrambled", [False, True], ids=["plain", "scrambled"])
@pytest.mark.benchmark(group="median of the catalogue, dim g <= 30")
def test_catalogue(benchmark: Any, scrambled: bool) -> None:
    names = small() if benchmark.enabled or sampling.whole else small()[::5]
    texts = [text_of(name, scrambled) for name in names]
    claims = [CLAIMS[name].full for name in names]

    def median() -> tuple[float, list[bool]]:
        seconds, verdicts = [], []
        for text in texts:
            start = time.perf_counter()
            verdicts.append(decided(text).full)
            seconds.append(time.perf_counter() - start)
        return statistics.median(seconds), verdicts

    seconds, verdicts = benchmark.pedantic(median, rounds=3)
    benchmark.extra_info["median_milliseconds"] = 1000 * seconds
    assert verdicts == claims


@pytest.mark.parametrize(
    ("name", "scrambled"),
    [("g2/su(3)", False), ("f4/spin(9)", False), ("f4/spin(9)", True), ("e6(-26)/P", False), ("so(20)/so(19)", False)],
)
@pytest.mark.benchmark(group="one pair")
def test_pair(benchmark: Any, name: str, scrambled: bool) -> None:
    assert benchmark.pedantic(decided, args=(text_of(name, scrambled),), rounds=3).full


@pytest.mark.slow
@pytest.mark.benchmark(group="one pair")
def test_so40(benchmark: Any) -> None:
    assert benchmark.pedantic(decided, args=(text_of("so(40)/so(39)", False),), rounds=1).full


@pytest.mark.benchmark(group="median of the catalogue, dim g <= 30")
def test_construction(benchmark: Any) -> None:
    names = small()[::4]

    def median() -> float:
        return statistics.median(seconds(lambda name=name: lh.pair(name)) for name in names)

    benchmark.extra_info["median_milliseconds"] = 1000 * benchmark.pedantic(median, rounds=3)
    assert benchmark.extra_info["median_milliseconds"] < 1000


@pytest.mark.benchmark(group="median of the catalogue, dim g <= 30")
def test_isotropy_of_a_point(benchmark: Any) -> None:
    named = sorted({name.split("/")[0] for name in small() if name.startswith(("so(", "sl(", "su(", "sp("))})
    representations = [lh.catalog.representation(name) for name in named]
    points = [list(range(1, rho.size + 1)) for rho in representations]

    def median() -> float:
        pairs = zip(representations, points, strict=True)
        return statistics.median(seconds(lambda rho=rho, m=m: rho.isotropy(m)) for rho, m in pairs)

    benchmark.extra_info["median_milliseconds"] = 1000 * benchmark.pedantic(median, rounds=3)
    assert benchmark.extra_info["median_milliseconds"] < 1000
    assert all(
        rho.orbit_dimension(m) + rho.isotropy(m).dimension == rho.algebra.dimension
        for rho, m in zip(representations, points, strict=True)
    )


@pytest.mark.benchmark(group="floor")
def test_floor_of_one_product(benchmark: Any) -> None:
    """One product (dim^2 x dim)(dim x dim) of the dense f4 table: what no dense method can do without."""
    n = 52
    rng = random.Random(0)
    table = flint.fmpz_mat(n * n, n, [rng.randint(-(10**4), 10**4) for _ in range(n**3)])
    square = flint.fmpz_mat(n, n, [rng.randint(-(10**4), 10**4) for _ in range(n * n)])
    assert benchmark(lambda: table * square).nrows() == n * n
