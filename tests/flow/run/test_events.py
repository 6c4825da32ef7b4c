"""Events: located against closed forms, counted once, directed, terminal; many per step, many trajectories."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.run.events import Events, bracketed_zero, lowest
from tests.sampling import examples

CIRCLE = lh.GeneratorField(lh.defining(lh.so(2)), [1])
DRIVEN = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + cos(t)/2"])  # the angle is t + sin(t)/2
E1 = np.array([1.0, 0.0])
STEPS = [lh.LieTaylor(6), lh.Corrected(lh.Euler(), 5), lh.RKMK("rk45"), lh.BackwardEuler()]
BODY = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0] + 0.3)
M0 = np.array([0.6, 0.0, 0.8])


def event(g: Callable[[Any, Any], Any], *, terminal: Any = False, direction: float = 0) -> Any:
    def function(t: Any, y: Any) -> Any:
        return g(t, y)

    function.terminal, function.direction = terminal, direction  # type: ignore[attr-defined]
    return function


def height(level: float = 0.0, **kind: Any) -> Any:
    return event(lambda t, y: y[..., 1] - level, **kind)


# -- where they are ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("step", [lh.LieTaylor(6), lh.RKMK("rk45"), lh.Euler()], ids=repr)
@pytest.mark.parametrize("kind", [{"dt": 0.3}, {"rtol": 1e-8}], ids=str)
@pytest.mark.parametrize("end", [20.0, -20.0])
def test_events_on_a_circle_are_found_to_round_off(step: Any, kind: Any, end: float) -> None:
    # a constant psi is integrated exactly, so that nothing but the location is measured
    sol = lh.integrate(CIRCLE, (0, end), E1, step=step, events=height(0.5), **kind)
    turns = 2 * np.pi * np.arange(-5, 5)
    wanted = np.sort(np.add.outer(turns, [np.pi / 6, 5 * np.pi / 6]).ravel())
    wanted = wanted[(wanted > 0) & (wanted < 20)] if end > 0 else wanted[(wanted < 0) & (wanted > -20)][::-1]
    assert len(sol.t_events[0]) == len(wanted)
    assert np.abs(sol.t_events[0] - wanted).max() < 1e-13
    assert np.abs(sol.y_events[0] - np.stack([np.cos(wanted), np.sin(wanted)], axis=-1)).max() < 1e-13
    assert np.abs(sol.y_events[0][:, 1] - 0.5).max() < 1e-14


@pytest.mark.parametrize("step", [lh.LieTaylor(8), lh.Corrected(lh.Euler(), 8), lh.RKMK("rk45")], ids=repr)
def test_events_of_a_driven_circle_are_as_good_as_the_solution(step: Any) -> None:
    sol = lh.integrate(DRIVEN, (0, 10), E1, step=step, rtol=1e-12, atol=1e-13, events=height())
    wanted = [brentq(lambda t, k=k: t + np.sin(t) / 2 - k * np.pi, 0, 12, xtol=1e-15) for k in range(4)]
    assert len(sol.t_events[0]) == 4 and np.abs(sol.t_events[0] - wanted).max() < 1e-10


def test_events_as_solve_ivp_finds_them() -> None:
    g = [event(lambda t, y: y[1] - 0.1), event(lambda t, y: y[0] * y[2] - 0.2 * t, direction=-1)]
    ours = lh.integrate(BODY, (0, 6), M0, step=lh.Corrected(lh.Euler(), 8), rtol=1e-12, atol=1e-13, events=g)
    theirs = solve_ivp(
        lambda t, y: BODY.vector(y), (0, 6), M0, method="DOP853", rtol=1e-13, atol=1e-14, max_step=0.02, events=g
    )
    for a, b in zip(ours.t_events, theirs.t_events, strict=True):
        assert len(a) == len(b) > 0 and np.abs(a - b).max() < 1e-10


@pytest.mark.parametrize("step", STEPS, ids=repr)
@pytest.mark.parametrize("end", [4.0, -4.0])
def test_events_lie_on_the_dense_output_and_on_the_manifold(step: Any, end: float) -> None:
    g = event(lambda t, y: y[..., 1] - 0.1 * np.cos(t))
    sol = lh.integrate(BODY, (0, end), M0, step=step, dt=0.1, events=g, dense_output=True)
    times, found = sol.t_events[0], sol.y_events[0]
    assert len(times) >= 2 and (np.diff(times) * np.sign(end) > 0).all()
    assert np.abs(sol.sol(times).T - found).max() < 1e-14
    assert np.abs((found**2).sum(axis=-1) - 1).max() < 1e-14
    assert np.abs(g(times, found)).max() < 1e-14


# -- which are counted ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("end", [10.0, -10.0])
def test_direction(end: float) -> None:
    both, up, down = (
        lh.integrate(CIRCLE, (0, end), E1, dt=0.1, events=height(0.5, direction=d)).t_events[0] for d in (0, 2, -0.5)
    )
    assert len(up) and len(down) and np.array_equal(np.sort(np.concatenate([up, down])), np.sort(both))
    # rising is meant along the integration, as in solve_ivp
    theirs = solve_ivp(
        lambda t, y: [-y[1], y[0]], (0, end), E1, rtol=1e-10, max_step=0.1, events=height(0.5, direction=1)
    )
    assert np.abs(theirs.t_events[0] - up).max() < 1e-6


def test_terminal_ends_there() -> None:
    for step in STEPS[:3]:
        sol = lh.integrate(CIRCLE, (0, 9), E1, step=step, dt=0.2, events=height(0.5, terminal=True), dense_output=True)
        assert sol.status == 1 and sol.success and "termination" in sol.message
        assert sol.t[-1] == sol.t_events[0][0] and len(sol.t_events[0]) == 1
        assert np.array_equal(sol.y[:, -1], sol.y_events[0][0]) and np.array_equal(sol.sol(sol.t[-1]), sol.y[:, -1])
        assert abs(sol.t[-1] - np.pi / 6) < 1e-13


@pytest.mark.parametrize("count", [1, 2, 5])
def test_terminal_at_the_nth_occurrence(count: int) -> None:
    sol = lh.integrate(CIRCLE, (0, 50), E1, dt=0.1, events=height(0.5, terminal=count))
    assert sol.status == 1 and len(sol.t_events[0]) == count and sol.t[-1] == sol.t_events[0][-1]
    for never in (9, 0):
        assert lh.integrate(CIRCLE, (0, 5), E1, dt=0.1, events=height(0.5, terminal=never)).status == 0


def test_several_in_one_step_are_all_found_and_none_after_the_terminal_one() -> None:
    g = [height(np.sin(a), terminal=a == 0.5) for a in (0.7, 0.1, 0.5, 0.3)]
    sol = lh.integrate(CIRCLE, (0, 1), E1, dt=1.0, events=g)
    assert [len(t) for t in sol.t_events] == [0, 1, 1, 1] and sol.n_steps == 1
    assert np.abs(np.concatenate(sol.t_events) - [0.1, 0.5, 0.3]).max() < 1e-14 and sol.status == 1
    g = [height(np.sin(0.4), terminal=True), height(np.sin(0.2), terminal=True)]
    sol = lh.integrate(CIRCLE, (0, 1), E1, dt=1.0, events=g)
    assert [len(t) for t in sol.t_events] == [0, 1] and abs(sol.t[-1] - 0.2) < 1e-14


def test_at_the_end_of_a_step_it_is_counted_once() -> None:
    g = event(lambda t, y: t - 0.5)
    for direction, count in ((0, 1), (1, 1), (-1, 0)):
        g.direction = direction
        sol = lh.integrate(CIRCLE, (0, 1), E1, dt=0.125, events=g)
        assert sol.t_events[0].tolist() == [0.5] * count
        assert [x for x in sol.t if x == 0.5] == [0.5]


def test_at_the_end_of_the_span() -> None:
    for end in (1.0, -1.0):
        sol = lh.integrate(CIRCLE, (0, end), E1, dt=0.3, events=event(lambda t, y, end=end: t - end, terminal=True))
        assert sol.t_events[0].tolist() == [end] and sol.status == 1 and sol.t[-1] == end
        near = np.nextafter(end, 0)
        sol = lh.integrate(CIRCLE, (0, end), E1, dt=0.3, events=event(lambda t, y, near=near: t - near))
        assert len(sol.t_events[0]) == 1 and abs(sol.t_events[0][0]) <= abs(end)
        assert len(lh.integrate(CIRCLE, (0, end), E1, dt=0.3, events=event(lambda t, y: t - 1.1)).t_events[0]) == 0


def test_at_the_start_it_is_recorded_and_does_not_end_the_run() -> None:
    for direction, count in ((0, 2), (1, 1), (-1, 1)):
        sol = lh.integrate(CIRCLE, (0, 4), E1, dt=0.1, events=height(direction=direction))
        assert len(sol.t_events[0]) == count and (0.0 in sol.t_events[0]) == (direction >= 0)
    sol = lh.integrate(CIRCLE, (0, 4), E1, dt=0.1, events=height(terminal=True))
    assert sol.status == 1 and abs(sol.t[-1] - np.pi) < 1e-14 and sol.t_events[0][0] == 0
    # g that stays 0 has no events
    assert lh.integrate(CIRCLE, (0, 4), E1, dt=0.1, events=event(lambda t, y: 0 * t)).t_events[0].size == 0


def test_a_run_goes_on_from_where_an_event_has_ended_it() -> None:
    t, y, times = 0.0, E1, []
    for _ in range(6):
        sol = lh.integrate(CIRCLE, (t, 50), y, rtol=1e-10, events=height(0.5, terminal=True))
        t, y = sol.t[-1], sol.y[:, -1]
        times.append(t)
    wanted = [np.pi / 6, 5 * np.pi / 6, 13 * np.pi / 6, 17 * np.pi / 6, 25 * np.pi / 6, 29 * np.pi / 6]
    assert np.abs(np.array(times) - wanted).max() < 1e-12


def test_adaptive_steps_do_not_jump_over_turns() -> None:
    # constant psi: the tolerance alone would allow one step over all 16 turns
    assert len(lh.integrate(CIRCLE, (0, 100), E1, events=height(0.5)).t_events[0]) == 32


def test_what_is_no_number_is_no_event() -> None:
    sol = lh.integrate(CIRCLE, (0, 6), E1, dt=0.1, events=event(lambda t, y: np.log(y[..., 1]) + 1))
    assert len(sol.t_events[0]) == 2


def test_a_jump_of_g_is_bracketed() -> None:
    sol = lh.integrate(CIRCLE, (0, 1), E1, dt=0.3, events=event(lambda t, y: np.where(t < 0.7318, -1.0, 1.0)))
    assert abs(sol.t_events[0][0] - 0.7318) < 1e-15


# -- ensembles -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("kind", [{"dt": 0.1}, {"rtol": 1e-9}], ids=str)
@pytest.mark.parametrize("step", STEPS[:3], ids=repr)
def test_each_trajectory_has_its_events_and_its_end(step: Any, kind: Any) -> None:
    angles = np.linspace(-1, 2, 6).reshape(2, 3)
    start = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    g = [height(0.9, terminal=True), height(0.0)]
    sol = lh.integrate(CIRCLE, (0, 1.5), start, step=step, events=g, dense_output=True, t_eval=[0.0, 0.5, 1.5], **kind)
    for index in np.ndindex(2, 3):
        one = lh.integrate(
            CIRCLE, (0, 1.5), start[index], step=step, events=g, dense_output=True, t_eval=[0.0, 0.5, 1.5], **kind
        )
        assert sol.statuses[index] == one.status
        for i in range(2):
            assert sol.t_events[i].shape == sol.y_events[i].shape == (2, 3)
            assert len(sol.t_events[i][index]) == len(one.t_events[i])
            assert np.allclose(sol.t_events[i][index], one.t_events[i], rtol=0, atol=1e-13)
            assert np.allclose(sol.y_events[i][index], one.y_events[i], rtol=0, atol=1e-13)
        assert np.allclose(sol.y[index][:, : one.t.size], one.y, rtol=0, atol=1e-13)
        assert np.isnan(sol.y[index][:, one.t.size :]).all()
        assert abs(sol.sol.t_max[index] - (one.t_events[0][0] if one.status else 1.5)) < 1e-13
    assert sol.status == 1 and set(sol.statuses.ravel()) == {0, 1}


# -- what is refused -----------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("g", "text"),
    [
        (lambda t, y: y, "shape"),
        (lambda t, y: y[..., :1], "shape"),
        (lambda t, y: "a", "real"),
        (lambda t, y: 1j, "real"),
        (lambda t, y: None, "real"),
        (event(lambda t, y: y[0], terminal=1.5), "terminal"),
        (event(lambda t, y: y[0], terminal=-1), "terminal"),
        (event(lambda t, y: y[0], terminal="yes"), "terminal"),
        (event(lambda t, y: y[0], direction="up"), "direction"),  # type: ignore[arg-type]
    ],
)
def test_wrong_events_are_refused(g: Any, text: str) -> None:
    with pytest.raises(InputError, match=text):
        lh.integrate(CIRCLE, (0, 1), E1, events=[g])


def test_the_shape_for_an_ensemble_is_checked() -> None:
    with pytest.raises(InputError, match=r"y\[\.\.\., 0\]"):
        lh.integrate(CIRCLE, (0, 1), [E1, E1, E1], events=lambda t, y: y[0])


def test_an_error_of_g_reaches_the_user() -> None:
    def g(t: Any, y: Any) -> Any:
        if t > 0.5:
            raise ZeroDivisionError("mine")
        return y[0]

    with pytest.raises(ZeroDivisionError, match="mine"):
        lh.integrate(CIRCLE, (0, 1), E1, dt=0.1, events=g)


def test_g_is_evaluated_on_the_path_only() -> None:
    """Also for the members of an ensemble that do not cross the level in a step in which others do."""
    angles = np.array([0.0, -0.2, 3.0])
    seen = []

    def g(t: Any, y: Any) -> Any:
        seen.append(np.arctan2(y[..., 1], y[..., 0]) % (2 * np.pi))
        return y[..., 1] - 0.5

    lh.integrate(CIRCLE, (0, 1), np.stack([np.cos(angles), np.sin(angles)], axis=-1), dt=0.25, events=g)
    passed = (np.array(seen) - angles + 1) % (2 * np.pi) - 1
    assert passed.min() > -1e-14 and passed.max() < 1 + 1e-14 and len(seen) > 5


# -- two zeros within a step ---------------------------------------------------------------------------------
def peaks(level: float, step: Any, kind: Any, start: Any = E1, **options: Any) -> Any:
    """Zeros of y_1 - (1 - level) on circles: each maximum of y_1 has one before it and one after it."""
    return lh.integrate(CIRCLE, (0, 20), start, step=step, events=height(1 - level, **options), **kind)


@pytest.mark.parametrize("step", [*STEPS[:3], lh.RKMK("dop853")], ids=repr)
@pytest.mark.parametrize("kind", [{"dt": 0.4}, {"rtol": 1e-9}, {"rtol": 1e-3, "max_step": 0.5}], ids=str)
@pytest.mark.parametrize("level", [1e-2, 1e-4, 1e-7, 1e-10])
def test_both_zeros_next_to_a_maximum_are_found(step: Any, kind: Any, level: float) -> None:
    half = np.arccos(1 - level)
    wanted = np.add.outer(np.pi / 2 + 2 * np.pi * np.arange(3), [-half, half]).ravel()
    found = peaks(level, step, kind).t_events[0]
    assert len(found) == 6 and np.abs(found - wanted).max() < 1e-15 / half + 1e-13
    assert len(peaks(-level, step, kind).t_events[0]) == 0  # above the maximum


def test_without_the_search_for_extrema_they_are_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Events, "_extremum", lambda *given: (np.zeros((), dtype=bool), given[3].h, given[5]))
    assert len(peaks(1e-4, lh.LieTaylor(6), {"dt": 0.4}).t_events[0]) < 6


@pytest.mark.parametrize(("direction", "side"), [(1, -1), (-1, 1)])
def test_two_zeros_in_a_step_have_directions(direction: int, side: int) -> None:
    found = peaks(1e-4, lh.LieTaylor(6), {"dt": 0.4}, direction=direction).t_events[0]
    wanted = np.pi / 2 + 2 * np.pi * np.arange(3) + side * np.arccos(1 - 1e-4)
    assert len(found) == 3 and np.abs(found - wanted).max() < 1e-12


@pytest.mark.parametrize(("terminal", "count"), [(1, 1), (2, 2), (3, 3), (7, 6)])
def test_two_zeros_in_a_step_end_the_run_at_the_one_asked_for(terminal: int, count: int) -> None:
    sol = peaks(1e-4, lh.LieTaylor(6), {"dt": 0.4}, terminal=terminal)
    every = peaks(1e-4, lh.LieTaylor(6), {"dt": 0.4}).t_events[0]
    assert np.allclose(sol.t_events[0], every[:count], rtol=0, atol=1e-13)
    assert sol.status == (1 if terminal < 7 else 0)
    assert np.isclose(sol.t[-1], every[count - 1] if terminal < 7 else 20, rtol=0, atol=1e-13)


def test_two_zeros_in_a_step_of_some_trajectories() -> None:
    angles, levels = np.array([0.0, 0.1, -2.0, 3.0]), np.array([1e-4, -1e-4, 1e-8, 0.5])
    starts = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    g = event(lambda t, y: y[..., 1] - (1 - levels))
    every = lh.integrate(CIRCLE, (0, 7), starts, dt=0.35, events=g).t_events[0]
    for k, (angle, level) in enumerate(zip(angles, levels, strict=True)):
        half = np.arccos(min(1 - level, 1.0))
        wanted = np.add.outer(np.pi / 2 - angle + 2 * np.pi * np.arange(-1, 3), [-half, half]).ravel()
        wanted = wanted[(wanted > 0) & (wanted < 7)] if level > 0 else []
        assert np.allclose(every[k], wanted, rtol=0, atol=1e-11)
        alone = event(lambda t, y, level=level: y[..., 1] - (1 - level))
        found = lh.integrate(CIRCLE, (0, 7), starts[k], dt=0.35, events=alone).t_events[0]
        assert np.allclose(found, every[k], rtol=0, atol=1e-11)


def test_an_extremum_at_zero_is_not_an_event() -> None:
    touching = event(lambda t, y: (y[..., 1] - 0.5) ** 2)
    assert len(lh.integrate(CIRCLE, (0, 20), E1, dt=0.3, events=touching).t_events[0]) == 0


@given(st.floats(0.01, 0.99), st.floats(0.02, 0.98), st.sampled_from([1.0, -2.0, 1e-6]), st.floats(-12, -1))
@settings(max_examples=examples(150))
@example(0.0625, 0.03125, 1.0, -8.0)  # the far end makes a poor parabola
def test_a_minimum_below_zero_is_found(where: float, guess: float, h: float, depth: float) -> None:
    def f(s: Any) -> Any:
        u = np.abs(s / h) - where
        return u * u * (1 + u / 3) - 10**depth

    assume(f(0.0) > 0 and f(h) > 0)
    _, value = lowest(f, np.array(h), np.array(guess * h), (f(0.0), f(h)), np.array(True))
    assert value <= 0
    above = lowest(lambda s: f(s) + 2 * 10**depth, np.array(h), np.array(guess * h), (1.0, 1.0), np.array(True))
    assert above[1] > 0 and 0 < abs(above[0]) < abs(h)


# -- the search ----------------------------------------------------------------------------------------------
@given(
    st.lists(st.floats(0.001, 0.999), min_size=1, max_size=5),
    st.sampled_from([lambda x: x, np.cbrt, lambda x: x**3, np.sign, lambda x: np.expm1(20 * x), lambda x: 1e-200 * x]),
    st.sampled_from([-3.0, 1.0, 1e-9]),
)
@settings(max_examples=examples(150))
def test_zeros_are_bracketed_to_round_off(zeros: Any, shape: Any, h: float) -> None:
    where = np.array(zeros)
    calls = [0]

    def g(s: Any) -> Any:
        calls[0] += 1
        return shape(s / h - where)

    size = np.full(len(zeros), h)
    found = bracketed_zero(g, size, shape(-where), shape(1 - where), np.ones(len(zeros), dtype=bool))
    assert np.abs(found / h - where).max() < 1e-14 and calls[0] < 100
    assert (np.sign(shape(found / h - where)) >= 0).all()  # the far side
