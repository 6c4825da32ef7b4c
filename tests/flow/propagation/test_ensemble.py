"""Ensembles in chunks: what `integrate` gives, on any executor, bit for bit; resumed after a kill."""

import signal
import subprocess
import sys
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.propagation.ensemble import EnsembleProblem, ensemble_parts, stored_parts
from tests.base import work
from tests.base.test_tasks import processes, threads

ROOT = Path(__file__).resolve().parents[3]
TOP = lh.GeneratorField(lh.adjoint(lh.so(3)), work.top)


def starts(n: int = 13) -> Any:
    points = np.random.default_rng(1).normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=-1, keepdims=True)


def same(a: Any, b: Any, *, calls: bool = True) -> None:
    """Two solutions are equal bit for bit."""
    for name in ("t", "y", "n_steps", "statuses"):
        assert np.array_equal(getattr(a, name), getattr(b, name), equal_nan=True), name
    assert (a.status, a.message) == (b.status, b.message)
    assert a.report == b.report
    assert not calls or a.nfev == b.nfev
    assert (a.t_events is None) == (b.t_events is None)
    for one, other in zip(a.t_events or [], b.t_events or [], strict=True):
        assert [x.tolist() for x in one.flat] == [x.tolist() for x in other.flat]


@pytest.fixture(scope="module")
def pool() -> Any:
    with processes() as made:
        yield made


OPTIONS: list[dict[str, Any]] = [
    {"dt": 0.25}, {"t_eval": [0.5, 1.0], "rtol": 1e-7},
    {"step": lh.Corrected(lh.Euler(), 3), "dt": np.linspace(0.1, 0.2, 13)},
    {"step": lh.RKMK("rk45"), "events": work.crossing}, {"step": lh.BackwardEuler(), "dt": 0.1, "t_eval": [1.0]},
]  # fmt: skip


@pytest.mark.parametrize("options", OPTIONS, ids=range(len(OPTIONS)))
def test_chunks_are_the_whole(options: dict[str, Any]) -> None:
    whole = lh.integrate(TOP, (0, 1), starts(), **options)
    same(lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=4, **options), whole, calls=False)


@pytest.mark.parametrize("options", OPTIONS[1:4], ids=range(1, 4))
@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_executors_give_what_serial_gives(executor: str, options: dict[str, Any], pool: Executor) -> None:
    serial = lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=5, **options)
    made = threads if executor == "threads" else pool
    same(lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=5, executor=made, **options), serial)


@pytest.mark.parametrize("chunk", [1, 13, 1000])
def test_any_size_of_chunk(chunk: int) -> None:
    whole = lh.integrate(TOP, (0, 1), starts(), dt=0.25)
    assert np.allclose(lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=chunk, dt=0.25).y, whole.y, atol=1e-15)


def test_more_axes_are_cut_along_the_first() -> None:
    y = starts(12).reshape(4, 3, 3)
    whole = lh.integrate(TOP, (0, 1), y, dt=0.25)
    same(lh.integrate_ensemble(TOP, (0, 1), y, chunk=3, dt=0.25), whole, calls=False)


def test_parameters_go_with_their_trajectories(pool: Executor) -> None:
    inertia = np.random.default_rng(2).uniform(1, 2, size=(13, 3))
    whole = lh.integrate(work.spinning(inertia), (0, 1), starts(), t_eval=[1.0])
    for executor in (None, pool):
        args = lh.PerTrajectory(inertia)
        made = lh.integrate_ensemble(
            work.spinning(), (0, 1), starts(), args=args, executor=executor, chunk=4, t_eval=[1.0]
        )
        same(made, whole, calls=False)


def test_psi_with_one_parameter_per_trajectory_is_refused() -> None:
    inertia = np.random.default_rng(2).uniform(1, 2, size=(13, 3))
    with pytest.raises(ShapeError, match="args=PerTrajectory"):
        lh.integrate_ensemble(work.spinning(inertia), (0, 1), starts(), chunk=4)
    hidden = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / inertia[: len(m)])
    with pytest.raises(ShapeError, match="args=PerTrajectory"):
        lh.integrate_ensemble(hidden, (0, 1), starts(), chunk=4)


@pytest.mark.filterwarnings("ignore:status -1")
def test_failures_are_told_of_the_whole() -> None:
    def blows(m: Any, t: Any) -> Any:
        return m / np.where(m[..., :1] > 0.9, 1 - t[..., None], 1.0)

    y = starts(9)
    y[6] = [1.0, 0.0, 0.0]
    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.1, "t_eval": [0.5, 1.2]}
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), blows, time_dependent=True)
    whole = lh.integrate(field, (0, 1.2), y, **options)
    made = lh.integrate_ensemble(field, (0, 1.2), y, chunk=4, **options)
    assert not whole.success
    assert "trajectory 6; 1 of 9 failed" in made.message
    same(made, whole, calls=False)


def test_what_is_kept_is_what_was_computed(tmp_path: Path) -> None:
    options: dict[str, Any] = {"step": lh.RKMK("rk45"), "events": work.crossing}
    solve = partial(lh.integrate_ensemble, TOP, (0, 1), starts(), chunk=5, store=tmp_path / "runs", **options)
    first = solve()
    files = {file: file.stat().st_mtime_ns for file in (tmp_path / "runs").iterdir()}
    assert len(files) == 4
    same(solve(), first)
    assert files == {file: file.stat().st_mtime_ns for file in (tmp_path / "runs").iterdir()}
    rows = [(part.first, part.last) for part in stored_parts(tmp_path / "runs")]
    assert rows == [(0, 4), (4, 8), (8, 13)]
    with pytest.raises(InputError, match="another problem"):
        lh.integrate_ensemble(TOP, (0, 2), starts(), chunk=5, store=tmp_path / "runs", **options)


def test_conservation_and_corrections_are_kept_with_their_reports(tmp_path: Path) -> None:
    step = lh.Conserving(lh.Heun(), "m0**2 + m1**2/2 + m2**2/4")
    options: dict[str, Any] = {"step": step, "dt": 0.25}
    whole = lh.integrate(TOP, (0, 1), starts(), **options)
    for _ in range(2):
        made = lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=5, store=tmp_path / "runs", **options)
        same(made, whole, calls=False)


KILLED = """
import os, signal, sys
import liehom as lh
from tests.flow.propagation.test_ensemble import TOP, starts
from liehom.flow.propagation import ensemble_parts
for number, part in enumerate(ensemble_parts(TOP, (0, 1), starts(), chunk=3, dt=0.25, store=sys.argv[1])):
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_run_continues_where_it_was(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    run = subprocess.run([sys.executable, "-c", KILLED, str(folder)], cwd=ROOT, capture_output=True, check=False)
    assert run.returncode == -signal.SIGKILL, run.stderr
    kept = {file: file.stat().st_mtime_ns for file in folder.glob("part-*.npz")}
    assert len(kept) == 3
    again = lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=3, dt=0.25, store=folder)
    assert all(file.stat().st_mtime_ns == written for file, written in kept.items())
    assert len(list(folder.glob("part-*.npz"))) == 5
    same(again, lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=3, dt=0.25))


def test_parts_come_one_by_one_and_can_be_left() -> None:
    parts = ensemble_parts(TOP, (0, 1), starts(), chunk=4, executor=threads, dt=0.25)
    part = next(parts)
    assert part.solution.y.shape == (part.last - part.first, 3, 5)
    parts.close()  # type: ignore[attr-defined]


def test_chunks_are_cut_when_they_are_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    cut: list[tuple[int, int]] = []
    task = EnsembleProblem.task

    def counted(self: EnsembleProblem, rows: tuple[int, int]) -> EnsembleProblem:
        cut.append(rows)
        return task(self, rows)

    monkeypatch.setattr(EnsembleProblem, "task", counted)
    parts = ensemble_parts(TOP, (0, 1), starts(), chunk=1, dt=0.25)
    checked = len(cut)  # the first and the last chunk
    for number, _ in enumerate(parts, 1):
        assert len(cut) == checked + number
    assert checked == 2 and number == len(starts())


def test_progress() -> None:
    seen: list[float] = []
    lh.integrate_ensemble(TOP, (0, 1), starts(), chunk=4, dt=0.25, progress=seen.append)
    assert seen[-1] == 1.0


@pytest.mark.parametrize(("change", "message"), [
    ({"chunk": 0}, "chunk is 0"), ({"chunk": 2.5}, "chunk is 2.5"), ({"dense_output": True}, "take t_eval"),
    ({"checkpoint": "a.npz"}, "give store"),
    ({"field": work.spinning(), "args": lh.PerTrajectory(np.ones((12, 3)))}, "leading axes must be those"),
    ({"field": work.square}, "expected a GeneratorField"),
    ({"field": 3}, "expected a GeneratorField"), ({"y0": [0.6, 0.0, 0.8]}, "expected an ensemble"),
    ({"y0": np.zeros((0, 3))}, "expected an ensemble"), ({"dt": [0.1, 0.2]}, "dt has shape"),
    ({"t_span": "ab", "dt": 0.1}, "t_span"), ({"no_such_option": 1}, "no_such_option"),
], ids=lambda value: value if isinstance(value, str) else None)  # fmt: skip
def test_what_is_refused(change: dict[str, Any], message: str) -> None:
    call: dict[str, Any] = {"field": TOP, "t_span": (0, 1), "y0": starts(), "chunk": 4, **change}
    kind = TypeError if "no_such_option" in change else InputError
    with pytest.raises(kind, match=message):
        lh.integrate_ensemble(**call)


def test_measured_orders_on_executors_and_kept(pool: Executor, tmp_path: Path) -> None:
    solve = partial(lh.observed_order, TOP, starts(2), lh.Heun(), [0.2, 0.1, 0.05])
    serial = solve()
    assert solve(executor=pool).to_csv() == serial.to_csv()
    for _ in range(2):
        assert solve(store=tmp_path / "orders").to_csv() == serial.to_csv()
    assert len(list((tmp_path / "orders").glob("run-*.npz"))) == 3
