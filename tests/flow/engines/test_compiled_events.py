"""Events of runs by machine code against numpy: the same zeros, ends, statistics; one trajectory and ensembles."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.engines import compiled_events as event_search, lanes as kernel_lanes, llvm_engine
from liehom.flow.engines.compiled_events import EventSearch
from liehom.flow.run.options import Progress
from tests.flow.engines.test_compiled import BODY, START, both, cache, sphere
from tests.flow.run.test_events import event

__all__ = ["cache"]

EPS = float(np.finfo(float).eps)
ULPS = 512
"""How far times and points of events may be apart; those of embedded pairs may be by `PAIRED`."""
PAIRED = 1e-6
CIRCLE = lh.GeneratorField(lh.defining(lh.so(2)), [1])
E1 = np.array([1.0, 0.0])
RUNS: dict[str, tuple[Any, dict[str, Any]]] = {
    "fixed": (lh.LieTaylor(4), {"dt": 0.3}), "fixed, clock": (lh.Corrected(lh.Euler(), 4), {"dt": 0.3}),
    "fixed, nominal": (lh.Corrected(lh.Euler(), 3), {"dt": 0.3, "clock": "nominal"}),
    "implicit": (lh.BackwardEuler(), {"dt": 0.4}), "pair": (lh.RKMK("rk45"), {"rtol": 1e-6}),
    "adaptive": (lh.LieTaylor(6), {"rtol": 1e-5}), "adaptive, clock": (lh.Corrected(lh.Euler(), 4), {"rtol": 1e-5}),
}  # fmt: skip


FIRST = event(lambda t, y: y[..., 0] - 0.1)
FALLING = event(lambda t, y: y[..., 1] + 0.02 * t, direction=-1)
RISING = event(lambda t, y: y[..., 1] - 0.3, direction=1)
END_AT_SECOND = event(lambda t, y: y[..., 0] - 0.1, terminal=2)
END = event(lambda t, y: y[..., 1], terminal=True, direction=-1)
EVENTS: dict[str, Any] = {"all": [FIRST, FALLING, RISING], "second": [END_AT_SECOND, FALLING], "end": END}
SHOWN = dict(zip(RUNS, ["second", "second", "all", "end", "second", "all", "second"], strict=True))
"""Those that are not slow tests."""


def listed(rows: Any) -> list[Any]:
    """The events of each function and trajectory."""
    return [x for row in rows for x in (row.reshape(-1) if row.dtype == object else [row])]


def assert_same(plain: Any, made: Any, near: float = ULPS * EPS) -> int:
    """The same run and the same events; returns their number."""
    assert made.message == plain.message and made.t.shape == plain.t.shape
    np.testing.assert_array_equal(made.statuses, plain.statuses)
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=20 * near)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=20 * near)
    times, points = (list(zip(listed(a), listed(b), strict=True)) for a, b in (
        (made.t_events, plain.t_events), (made.y_events, plain.y_events)))  # fmt: skip
    assert [len(x) for x, _ in times] == [len(x) for _, x in times]
    for x, y in (*times, *points):
        np.testing.assert_allclose(x, y, rtol=0, atol=20 * near)
    ours, theirs = made.report, plain.report
    assert (ours.order, ours.failed_steps, ours.equilibria) == (theirs.order, theirs.failed_steps, theirs.equilibria)
    return sum(len(x) for x, _ in times)


# -- every kind of step --------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("run", "events"),
    [
        pytest.param(run, events, id=f"{run}, {name}", marks=() if name == SHOWN[run] else pytest.mark.slow)
        for run in RUNS
        for name, events in EVENTS.items()
    ],
)
def test_events_of_ensembles_are_those_of_numpy(run: str, events: Any) -> None:
    step, options = RUNS[run]
    near = PAIRED if run == "pair" else ULPS * EPS
    starts = sphere(6)
    assert assert_same(*both(BODY, (0, 12), starts, step=step, events=events, **options), near) >= 2
    back = both(BODY, (12, 0), starts.reshape(2, 3, 3), step=step, events=events, t_eval=[9.0, 5.0, 0.0], **options)
    assert assert_same(*back, near) >= 2
    if events is END:
        assert (back[1].statuses == 1).any()


@pytest.mark.parametrize("run", ["fixed", "fixed, clock", "pair"])
@pytest.mark.parametrize("g", [lambda t, y: y[0] - 0.5, lambda t, y: y[..., 0] - 0.5], ids=["one point", "any points"])
def test_events_of_one_trajectory_end_it(run: str, g: Any) -> None:
    step, options = RUNS[run]
    plain, made = both(CIRCLE, (0, 40), E1, step=step, events=event(g, terminal=3), dense_output=True, **options)
    assert assert_same(plain, made) == 3 and made.status == 1
    assert abs(made.t[-1] - (2 * np.pi + np.pi / 3)) < 1e-12 and abs(made.y[0, -1] - 0.5) < 1e-12
    np.testing.assert_allclose(made.sol(4.0), plain.sol(4.0), rtol=0, atol=1e-12)


def test_a_psi_for_one_point_has_events() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: np.stack([-m[0], -m[1] / 2, -m[2] / 3]))
    assert assert_same(*both(field, (0, 20), START, step=lh.LieTaylor(4), dt=0.3, events=lambda t, y: y[1])) >= 2


# -- rules -----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("level", [1e-2, 1e-6, 1e-10])
def test_two_zeros_within_a_step_are_found(level: float, monkeypatch: pytest.MonkeyPatch) -> None:
    events = event(lambda t, y: y[..., 1] - (1 - level))
    options: dict[str, Any] = {"step": lh.LieTaylor(4), "dt": 0.7, "events": events}
    plain, made = both(CIRCLE, (0, 20), E1, **options)
    assert len(made.t_events[0]) == 6
    np.testing.assert_allclose(made.t_events[0], plain.t_events[0], rtol=0, atol=64 * EPS / np.sqrt(level))
    # without the search for extrema they are not
    monkeypatch.setattr(EventSearch, "_turns", lambda self, i, steps, start, end: np.zeros(len(start), dtype=bool))
    assert len(lh.integrate(CIRCLE, (0, 20), E1, engine="llvm", **options).t_events[0]) < 6


def test_events_are_located_in_the_steps_and_not_between_their_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    options: dict[str, Any] = {"step": lh.LieTaylor(4), "dt": 0.7, "events": event(lambda t, y: y[..., 1] - 0.2)}
    wanted = lh.integrate(CIRCLE, (0, 20), E1, **options).t_events[0]
    assert np.abs(lh.integrate(CIRCLE, (0, 20), E1, engine="llvm", **options).t_events[0] - wanted).max() < 1e-13
    straight = event_search.StepProposal.position
    monkeypatch.setattr(
        event_search.StepProposal, "position",
        lambda self, s: (straight(self, s)[0], self.m + (s / self.h)[..., None] * (self.reached - self.m)),
    )  # fmt: skip
    found = lh.integrate(CIRCLE, (0, 20), E1, engine="llvm", **options).t_events[0]
    assert len(found) == len(wanted) and np.abs(found - wanted).max() > 1e-3


def test_a_zero_at_the_start_is_recorded_and_not_counted() -> None:
    events = event(lambda t, y: y[..., 1], terminal=2)
    plain, made = both(CIRCLE, (0, 20), np.stack([E1, -E1]), step=lh.LieTaylor(2), dt=0.3, events=events)
    assert assert_same(plain, made) == 6 and made.t_events[0][1][0] == 0


@pytest.mark.parametrize("per_call", [1_000, 64_000_000])
def test_calls_of_any_length_find_the_same(per_call: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_lanes, "PATH_BYTES_PER_CALL", per_call)
    monkeypatch.setattr(llvm_engine, "MIN_STEPS_WITH_ENDS", 3)
    step, options = RUNS["fixed, clock"]
    assert assert_same(*both(BODY, (0, 12), sphere(5), step=step, events=[END_AT_SECOND, RISING], **options)) > 3


def test_events_take_args_in_both_orders_and_functions_of_the_whole_ensemble() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"])
    levels, starts = np.linspace(-0.2, 0.2, 5), sphere(5)
    args = {"inertia": lh.PerTrajectory(np.outer(np.linspace(0.3, 1, 5), [1, 2, 3])), "level": 0.1}
    events = [lambda m, t, args: m[..., 0] - args["level"] * args["inertia"][..., 1], lambda t, y: y[:, 1] - levels]
    assert assert_same(*both(field, (0, 9), starts, step=lh.LieTaylor(4), dt=0.3, events=events, args=args)) > 10


def test_an_interrupted_run_goes_on_with_its_events(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_lanes, "PATH_BYTES_PER_CALL", 20_000)
    path = tmp_path / "run.npz"
    options: dict[str, Any] = {"step": lh.LieTaylor(4), "dt": 0.3, "events": [FIRST, END_AT_SECOND], "engine": "llvm"}
    whole = lh.integrate(BODY, (0, 30), sphere(5), **options)
    calls, update = [0], Progress.update

    def interrupted(self: Any, *given: Any, **more: Any) -> None:
        calls[0] += 1
        if calls[0] == 2:
            raise KeyboardInterrupt
        update(self, *given, **more)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Progress, "update", interrupted)
        lh.integrate(BODY, (0, 30), sphere(5), checkpoint=path, **options)
    assert path.exists()
    made = lh.integrate(BODY, (0, 30), sphere(5), checkpoint=path, **options)
    np.testing.assert_array_equal(made.y, whole.y)
    for x, y in zip(listed(made.t_events), listed(whole.t_events), strict=True):
        np.testing.assert_array_equal(x, y)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("count", [0, 1, 3])
def test_ensembles_of_any_size_and_runs_that_fail_have_events(count: int) -> None:
    options: dict[str, Any] = {"step": lh.LieTaylor(4), "dt": 0.3, "events": FIRST, "max_steps": 15}
    plain, made = both(BODY, (0, 12), sphere(3)[:count], **options)
    assert made.message == plain.message and made.t.shape == plain.t.shape
    for x, y in zip(listed(made.t_events), listed(plain.t_events), strict=True):
        np.testing.assert_allclose(x, y, rtol=0, atol=ULPS * EPS)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("count", [1, 3])
def test_runs_whose_first_step_fails_have_no_events(count: int) -> None:
    def psi(m: Any, t: Any) -> Any:
        return np.stack([np.sqrt(0.01 - t) + 0 * m[..., 0], m[..., 0], m[..., 1]], axis=-1)

    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    plain, made = both(field, (0, 1), sphere(count), step=lh.RKMK("rk4"), dt=0.1, events=FIRST)
    assert (made.status, made.message) == (plain.status, plain.message) == (-1, made.message)
    assert not any(map(len, listed(made.t_events)))
