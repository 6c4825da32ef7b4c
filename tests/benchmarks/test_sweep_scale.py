"""The sweep that is killed and resumed, with few pairs: every entry once, and nothing decided twice."""

from pathlib import Path

import pytest

from tests.benchmarks.sweep_scale import LIMITS, lines, measured


@pytest.mark.parametrize("executor", ["threads", pytest.param("dask", marks=pytest.mark.slow)])
def test_a_killed_sweep_is_resumed(tmp_path: Path, executor: str) -> None:
    count = 1000 if executor == "threads" else 20_000
    figures = measured(count, executor, 2, tmp_path / "store")
    assert figures["entries"] == figures["full, with a checked certificate"] == count
    assert count // 2 <= figures["entries when killed"] < count
    assert lines(tmp_path / "store") <= count + 1  # the kill may leave half a line
    # times are for an idle machine and are measured by running the script; sizes hold on every machine
    assert all(figures[name] < limit for name, limit in LIMITS.items() if "ms" not in name and "seconds" not in name)
