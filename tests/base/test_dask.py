"""The same calls on a dask cluster of two processes: results bit for bit, functions without a name, a killed worker."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.tasks import completed
from tests.base import work
from tests.flow.propagation.test_ensemble import TOP, same, starts

pytest.importorskip("distributed")

# what dask and what it imports warn of is not about this library
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    from distributed import Client, LocalCluster

    quiet = {"dashboard_address": None, "silence_logs": 50}
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, **quiet) as cluster, Client(cluster) as made:
        yield made


def test_ensemble_on_dask_equals_the_serial_one(client: Any, tmp_path: Path) -> None:
    options: dict[str, Any] = {"step": lh.Corrected(lh.Euler(), 3), "dt": 0.1, "t_eval": [0.5, 1.0]}
    serial = lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=4, **options)
    with client.get_executor() as executor:
        made = lh.integrate_ensemble(
            TOP, (0, 1), starts(), chunk=4, executor=executor, store=tmp_path / "runs", **options
        )
    same(made, serial)


def test_functions_without_a_name(client: Any) -> None:
    inertia = np.random.default_rng(3).uniform(1, 2, size=(13, 3))
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args)
    call: dict[str, Any] = {"args": lh.PerTrajectory(inertia), "chunk": 4, "dt": 0.25}
    with client.get_executor() as executor:
        made = lh.integrate_ensemble(field, (0, 1), starts(), executor=executor, **call)
    same(made, lh.integrate_ensemble(field, (0, 1), starts(), **call))


def test_measured_orders_on_dask_equal_the_serial_ones(client: Any) -> None:
    arguments = TOP, starts(2), lh.Heun(), [0.2, 0.1, 0.05]
    with client.get_executor() as executor:
        made = lh.observed_order(*arguments, executor=executor)
    assert made.to_csv() == lh.observed_order(*arguments).to_csv()


def test_sweep_on_dask_equals_the_serial_one(client: Any) -> None:
    names = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1"]
    with client.get_executor() as executor:
        assert lh.atlas.sweep(names, executor=executor) == lh.atlas.sweep(names)


def test_killed_dask_worker_is_survived(client: Any, tmp_path: Path) -> None:
    """The scheduler starts another, and gives it what the first had."""
    with client.get_executor() as executor:
        tasks = [(str(tmp_path), x) for x in range(6)]
        assert sorted(completed(work.kills_its_worker_once, tasks, executor)) == [(x, x) for x in range(6)]
    assert (tmp_path / "killed").exists()


def test_a_worker_killed_while_an_ensemble_runs(client: Any) -> None:
    serial = lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=2, dt=0.01)
    with client.get_executor() as executor:
        parts = lh.propagation.ensemble_parts(TOP, (0, 1), starts(), chunk=2, dt=0.01, executor=executor)
        found = [next(parts)]
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
        found += parts
    made = np.concatenate([part.solution.y for part in sorted(found, key=lambda part: part.first)])
    assert np.array_equal(made, serial.y)
