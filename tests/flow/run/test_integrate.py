"""integrate: steps and times, ensembles, requested times, what comes back, and what is refused."""

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.base.errors import InputError, ShapeError, TangencyError
from liehom.flow.run.solution import Solution
from tests.sampling import examples

CIRCLE = lh.GeneratorField(lh.defining(lh.so(2)), [1])
DRIVEN = lh.GeneratorField(lh.defining(lh.so(2)), ["cos(t)"])
BODY = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0] + 0.3)
M0 = np.array([0.6, 0.0, 0.8])
E1 = np.array([1.0, 0.0])
CORRECTED = lh.Corrected(lh.Euler(), order=4)


def reference(t_span: Any, m: Any, t_eval: Any = None) -> Any:
    found = solve_ivp(lambda t, y: BODY.vector(y), t_span, m, method="DOP853", rtol=1e-13, atol=1e-14, t_eval=t_eval)
    return found.y


def points(count: tuple[int, ...], seed: int = 0) -> Any:
    m = np.random.default_rng(seed).normal(size=(*count, 3))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def angles(y: Any) -> Any:
    return np.unwrap(np.arctan2(y[1], y[0]))


# -- times and steps -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("n", [1, 2, 3, 7, 10, 49, 98, 103, 1000, 4999])
@pytest.mark.parametrize("span", [(0.0, 1.0), (0.0, 10.0), (-3.7, 2.2), (1e6, 1e6 + 1), (2.2, -3.7), (0.1, 0.7)])
def test_a_step_that_divides_the_span_is_taken_exactly_so_often(n: int, span: tuple[float, float]) -> None:
    dt = abs(span[1] - span[0]) / n
    sol = lh.integrate(CIRCLE, span, E1, step=lh.Euler(), dt=dt)
    assert sol.n_steps == n and sol.t.shape == (n + 1,) and sol.y.shape == (2, n + 1)
    assert sol.t[0] == span[0] and sol.t[-1] == span[1]
    size = max(abs(span[0]), abs(span[1]))
    assert np.abs(sol.t - np.linspace(*span, n + 1)).max() <= 4 * np.finfo(float).eps * size
    passed = sol.t - sol.t[0]
    assert np.abs(sol.y - [np.cos(passed), np.sin(passed)]).max() <= 1e-15 * n + 1e-15 * size + 1e-14


@pytest.mark.parametrize(("dt", "steps"), [(0.3, 4), (0.25, 4), (5.0, 1), (1.0, 1), (1e3, 1), (0.0999, 11)])
@pytest.mark.parametrize("step", [lh.Euler(), CORRECTED], ids=repr)
@pytest.mark.parametrize("end", [1.0, -1.0])
def test_the_last_step_is_shortened(dt: float, steps: int, step: Any, end: float) -> None:
    sol = lh.integrate(DRIVEN, (0, end), E1, step=step, dt=dt, clock="nominal")
    assert sol.success and sol.t[-1] == end and sol.n_steps == steps
    assert (np.diff(sol.t) * np.sign(end) > 0).all()


@pytest.mark.parametrize("dt", [0.2, 1.0, 100.0, 1e6])
def test_a_clock_need_not_run_beyond_the_end(dt: float) -> None:
    # over dt = 100 the clock of this step does not run, but the one step to the end needs only a part of it
    sol = lh.integrate(BODY, (0, 0.05), M0, step=CORRECTED, dt=dt)
    assert sol.success and sol.n_steps == 1 and sol.t.tolist() == [0.0, 0.05]
    assert np.abs(sol.y[:, -1] - reference((0, 0.05), M0)[:, -1]).max() < 1e-6


def test_no_time_at_all() -> None:
    for kind in ({"dt": 0.1}, {}, {"step": CORRECTED}, {"step": CORRECTED, "dt": 0.1}):
        sol = lh.integrate(BODY, (2, 2), M0, dense_output=True, events=lambda t, y: y[0] - 0.6, **kind)
        assert sol.success and sol.n_steps == 0 and sol.t.tolist() == [2.0] and (sol.y[:, 0] == M0).all()
        assert (sol.sol(2.0) == M0).all() and sol.t_events[0].size == 0
    sol = lh.integrate(BODY, (2, 2), M0, t_eval=[2.0])
    assert sol.t.tolist() == [2.0] and (sol.y[:, 0] == M0).all()


def test_the_last_step_under_the_corrected_clock_ends_at_the_end() -> None:
    for span in [(0.0, 3.0), (3.0, 0.0), (-7.0, -5.5)]:
        sol = lh.integrate(BODY, span, M0, step=lh.Corrected(lh.Euler(), 6), dt=0.03)
        assert sol.t[-1] == span[1] and np.abs(sol.y[:, -1] - reference(span, M0)[:, -1]).max() < 1e-8
        steps = np.abs(np.diff(sol.t))
        assert steps[:-1].min() > 0.01 and steps[-1] > 1e-9


def test_backwards_returns_to_the_start() -> None:
    for kind in ({"dt": 0.02}, {"rtol": 1e-10, "atol": 1e-12}):
        for step in (lh.LieTaylor(6), lh.Corrected(lh.Euler(), 6), lh.RKMK("rk45")):
            there = lh.integrate(BODY, (0, 1), M0, step=step, **kind)
            back = lh.integrate(BODY, (1, 0), there.y[:, -1], step=step, **kind)
            assert back.t[0] == 1 and back.t[-1] == 0 and (np.diff(back.t) < 0).all()
            assert np.abs(back.y[:, -1] - M0).max() < 2e-8


@pytest.mark.parametrize("step", [lh.Heun(), lh.RKMK("rk4"), lh.LieTaylor(3), lh.BackwardEuler(), CORRECTED], ids=repr)
@pytest.mark.parametrize("direction", [1, -1])
def test_the_order_is_reached(step: Any, direction: int) -> None:
    field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m, t: m * [1.0, 2.0, 3.0] + np.sin(t)[..., None])
    exact = solve_ivp(
        lambda t, y: field.vector(y, np.asarray(t)), (0, direction), M0, method="DOP853", rtol=1e-13, atol=1e-14
    )
    errors = []
    for dt in (0.1, 0.05, 0.025):
        sol = lh.integrate(field, (0, direction), M0, step=step, dt=dt)
        errors.append(np.abs(sol.y[:, -1] - exact.y[:, -1]).max())
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert abs(slopes[-1] - step.order) < 0.35, (errors, slopes)


# -- ensembles -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("shape", [(1,), (2, 2)])
@pytest.mark.parametrize(
    "kind",
    [{"dt": 0.05}, {"step": CORRECTED}, {"step": lh.RKMK("rk45"), "rtol": 1e-8}, {"step": lh.Heun(), "rtol": 1e-4}],
    ids=str,
)
def test_an_ensemble_is_its_trajectories(shape: tuple[int, ...], kind: Any) -> None:
    m = points(shape)
    sol = lh.integrate(BODY, (0, 0.8), m, dense_output=True, **kind)
    assert sol.t.shape == (*shape, sol.t.shape[-1]) and sol.y.shape == (*shape, 3, sol.t.shape[-1])
    assert sol.n_steps.shape == shape == sol.statuses.shape
    for index in np.ndindex(shape):
        one = lh.integrate(BODY, (0, 0.8), m[index], dense_output=True, **kind)
        n = sol.n_steps[index]
        assert one.n_steps == n
        # the estimate of a pair is a small difference, so that round-off reaches the step sizes
        assert np.abs(sol.t[index][: n + 1] - one.t).max() < (1e-10 if "rtol" in kind else 1e-13)
        assert np.abs(sol.y[index][:, : n + 1] - one.y).max() < (1e-10 if "rtol" in kind else 1e-13)
        assert np.isnan(sol.t[index][n + 1 :]).all() and np.isnan(sol.y[index][:, n + 1 :]).all()
        times = np.linspace(0, 0.8, 4)
        assert np.abs(sol.sol(times)[index] - one.sol(times)).max() < 1e-12


def test_rejected_steps_of_one_trajectory_leave_no_gaps_in_it() -> None:
    # the first trajectory meets a jump at t = 1, so that its steps are repeated there while the others go on
    def psi(m: Any, t: Any) -> Any:
        return np.where((t > 1) & (np.arange(3) == 0), 20.0, 1.0)[..., None] * np.ones(1)

    field = lh.GeneratorField(lh.defining(lh.so(2)), psi)
    start = np.tile(E1, (3, 1))
    sol = lh.integrate(field, (0, 2), start, step=lh.RKMK("rk45"), rtol=1e-8, dense_output=True)
    for i in range(3):
        n = sol.n_steps[i]
        assert np.isfinite(sol.t[i, : n + 1]).all() and (np.diff(sol.t[i, : n + 1]) > 0).all()
        assert np.isfinite(sol.y[i, :, : n + 1]).all() and sol.t[i, n] == 2
        final = 1 + 20.0 if i == 0 else 2.0
        assert np.abs(sol.y[i, :, n] - [np.cos(final), np.sin(final)]).max() < 3e-6  # the jump by 19 is in one step
    assert np.abs(sol.sol(0.5) - [np.cos(0.5), np.sin(0.5)]).max() < 1e-9
    assert np.abs(sol.sol(2.0)[0] - [np.cos(21), np.sin(21)]).max() < 3e-6
    assert len(set(sol.n_steps)) > 1


def test_an_empty_ensemble() -> None:
    for kind in ({"dt": 0.1}, {}, {"step": CORRECTED, "dt": 0.1}, {"step": CORRECTED}, {"step": lh.RKMK("rk45")}):
        sol = lh.integrate(BODY, (0, 1), np.zeros((0, 3)), dense_output=True, events=lambda t, y: y[..., 0], **kind)
        assert sol.success and sol.y.shape == (0, 3, 1) and sol.t.shape == (0, 1)
        assert sol.n_steps.shape == (0,) and sol.sol([0.1, 0.2]).shape == (0, 3, 2)
        assert sol.t_events[0].shape == (0,) and str(sol.report)
    assert lh.integrate(BODY, (0, 1), np.zeros((0, 3)), t_eval=[0, 1]).y.shape == (0, 3, 2)


def test_every_trajectory_has_its_own_step_size() -> None:
    m = points((3,))
    sol = lh.integrate(BODY, (0, 1), m, step=lh.RKMK("rk4"), dt=[0.1, 0.25, 0.03])
    assert sol.n_steps.tolist() == [10, 4, 34]
    for i, dt in enumerate([0.1, 0.25, 0.03]):
        one = lh.integrate(BODY, (0, 1), m[i], step=lh.RKMK("rk4"), dt=dt)
        assert np.array_equal(sol.t[i, : one.n_steps + 1], one.t)
        assert np.abs(sol.y[i, :, one.n_steps] - one.y[:, -1]).max() < 1e-14


def test_parameters_of_trajectories_stay_with_them() -> None:
    # psi is called on the whole ensemble, always
    rates = np.array([[1.0], [2.0], [5.0]])
    field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m: rates + 0 * m[..., :1])
    start = np.tile(E1, (3, 1))
    for kind in ({"dt": [0.1, 0.02, 0.05]}, {"rtol": 1e-9}, {"step": lh.RKMK("rk45"), "rtol": 1e-9}):
        sol = lh.integrate(field, (0, 1), start, t_eval=[0.5, 1], dense_output=True, **kind)
        for i, rate in enumerate(rates[:, 0]):
            assert np.abs(sol.y[i, :, 1] - [np.cos(rate), np.sin(rate)]).max() < 1e-7
            assert np.abs(sol.sol(0.3)[i] - [np.cos(0.3 * rate), np.sin(0.3 * rate)]).max() < 1e-7


def test_orbits_of_different_dimensions_in_one_ensemble() -> None:
    field = lh.GeneratorField(lh.sym_conjugation(3), lambda m: m[..., :3] + 0.2)
    m = np.array([[1.0, 0, 0, 1, 0, 2], [1.0, 0.2, 0, 2, 0, 3]])
    with pytest.warns(lh.OrderWarning, match="no solution"):
        sol = lh.integrate(field, (0, 1), m, step=lh.Corrected(lh.Euler(), 3), dt=0.02)
    assert sol.status == -2 and sol.statuses.tolist() == [0, -2] and "trajectory 1; 1 of 2 did not" in sol.message
    assert sol.report.orbit_dimension == 3 and sol.report.range_condition is False
    for i in range(2):
        s = np.zeros((3, 3))
        s[np.triu_indices(3)] = sol.y[i, :, sol.n_steps[i]]
        before = np.zeros((3, 3))
        before[np.triu_indices(3)] = m[i]
        values = [np.linalg.eigvalsh(a, UPLO="U") for a in (s, before)]
        assert np.abs(values[0] - values[1]).max() < 1e-12


# -- requested times -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("step", [lh.LieTaylor(6), lh.Corrected(lh.Euler(), 5), lh.RKMK("rk45")], ids=repr)
@pytest.mark.parametrize("span", [(0.0, 0.8), (0.8, 0.0)])
def test_requested_times_are_those_of_the_dense_output(step: Any, span: tuple[float, float]) -> None:
    times = np.linspace(*span, 13)
    for m in (M0, points((2, 2))):
        kind: Any = {"step": step, "rtol": 1e-7, "dense_output": True}
        sol = lh.integrate(BODY, span, m, t_eval=times, **kind)
        every = lh.integrate(BODY, span, m, **kind)
        assert np.array_equal(sol.t, times) and sol.y.shape == (*np.shape(m), 13)
        assert np.abs(sol.y - sol.sol(times)).max() < 1e-14
        assert np.abs(sol.y - every.sol(times)).max() < 1e-14
        assert (sol.y[..., 0] == m).all()
        last = np.take_along_axis(every.y, np.asarray(every.n_steps)[..., None, None], axis=-1)[..., 0]
        assert np.array_equal(sol.y[..., -1], last)


def test_more_requested_times_than_steps_and_fewer() -> None:
    times = np.linspace(0, 1, 1001)
    sol = lh.integrate(DRIVEN, (0, 1), E1, t_eval=times, rtol=1e-9, dt=None)
    assert sol.n_steps < 50 and np.abs(angles(sol.y) - np.sin(times)).max() < 1e-7
    sol = lh.integrate(DRIVEN, (0, 1), E1, t_eval=[0.123], dt=0.001, step=lh.RKMK("rk4"))
    assert sol.t.tolist() == [0.123] and abs(angles(sol.y)[0] - np.sin(0.123)) < 1e-12
    sol = lh.integrate(DRIVEN, (0, 1), E1, t_eval=[], dt=0.1)
    assert sol.success and sol.t.shape == (0,) and sol.y.shape == (2, 0) and sol.n_steps == 10


def test_requested_times_after_a_terminal_event_are_left_out() -> None:
    def event(t: Any, y: Any) -> Any:
        return y[..., 1] - 0.5

    event.terminal = True  # type: ignore[attr-defined]
    sol = lh.integrate(CIRCLE, (0, 5), E1, events=event, t_eval=[0.0, 0.1, 0.5, 0.6, 5.0])
    assert sol.t.tolist() == [0.0, 0.1, 0.5] and sol.y.shape == (2, 3)
    sol = lh.integrate(CIRCLE, (0, 5), [E1, -E1], events=event, t_eval=[0.0, 0.1, 0.5, 0.6, 5.0])
    assert sol.t.shape == (5,) and np.isfinite(sol.y).all(axis=1).tolist() == [
        [True] * 3 + [False] * 2,
        [True] * 4 + [False],
    ]


# -- what comes back -----------------------------------------------------------------------------------------
def test_entries_as_solve_ivp_has_them() -> None:
    ours = lh.integrate(BODY, (0, 1), M0, dense_output=True, events=[lambda t, y: y[0]])
    theirs = solve_ivp(lambda t, y: BODY.vector(y), (0, 1), M0, dense_output=True, events=[lambda t, y: y[0]])
    for name in theirs:
        assert type(ours[name]) is type(theirs[name]) or name in ("sol",), name
        assert getattr(ours, name) is ours[name] or ours[name] == getattr(ours, name)
    assert list(ours)[: len(theirs)] == list(theirs) and "t" in ours and len(ours) == len(ours.keys())
    assert dict(ours)["status"] == 0
    with pytest.raises(KeyError):
        ours["nothing"]
    assert lh.integrate(BODY, (0, 1), M0).t_events is None


def test_the_card() -> None:
    sol = lh.integrate(BODY, (0, 1), points((2,)), events=lambda t, y: y[..., 0], dense_output=True)
    text = repr(sol)
    assert text == str(sol) and "message: The solver successfully" in text and "Taylor(n=8)" in text
    assert max(map(len, text.splitlines())) <= 120 and len(text.splitlines()) < 40
    assert "1 event" in text and "statuses" in text
    assert "statuses" not in repr(lh.integrate(BODY, (0, 1), M0))
    assert repr(lh.integrate(BODY, (0, 1), np.zeros((0, 3)), events=lambda t, y: y[..., 0]))


def test_a_solution_is_pickled_and_copied() -> None:
    sol = lh.integrate(BODY, (0, 1), M0, dt=0.1, events=lambda t, y: y[0], step=CORRECTED)
    for again in (pickle.loads(pickle.dumps(sol)), copy.deepcopy(sol)):
        assert isinstance(again, Solution) and np.array_equal(again.y, sol.y) and again.report == sol.report
        assert again.success and again.message == sol.message


def test_calls_of_psi_are_counted() -> None:
    count = [0]

    def psi(m: Any) -> Any:
        count[0] += 1
        return m * [1.0, 2.0, 3.0]

    field = lh.GeneratorField(lh.defining(lh.so(3)), psi)
    sol = lh.integrate(field, (0, 1), M0, dt=0.1, step=lh.Euler())
    assert sol.nfev == 10 and count[0] == 11  # one more to check psi at the start
    assert lh.integrate(field, (0, 1), M0, dt=0.1, step=lh.RKMK("rk4")).nfev == 40


def test_extended_precision_from_end_to_end() -> None:
    m = np.array([0.6, 0.0, 0.8], dtype=np.longdouble)
    m /= np.sqrt(m @ m)
    third = np.longdouble(1) / 3
    for step in (lh.LieTaylor(12), lh.Corrected(lh.Euler(), 12)):
        for kind in ({"dt": third / 20}, {"rtol": 1e-18, "atol": 0}):
            sol = lh.integrate(
                BODY, (0, third), m, step=step, dense_output=True, events=lambda t, y: y[1] + 0.05, **kind
            )
            assert sol.y.dtype == sol.t.dtype == np.longdouble and sol.t[-1] == third
            assert np.abs((sol.y**2).sum(axis=0) - 1).max() < 1e-18
            assert sol.sol(third / 7).dtype == np.longdouble and np.abs((sol.sol(third / 7) ** 2).sum() - 1) < 1e-18
            assert sol.t_events[0].dtype == np.longdouble and len(sol.t_events[0]) == 1
    a = lh.integrate(BODY, (0, third), m, step=lh.LieTaylor(14), dt=third / 40).y[:, -1]
    assert np.abs(a - sol.y[:, -1]).max() < 1e-16


def test_integers_and_fractions_are_taken_as_double_and_single_precision_is_refused() -> None:
    assert lh.integrate(CIRCLE, (0, 1), np.array([1, 0]), dt=0.5).y.dtype == np.float64
    with pytest.raises(InputError, match=r"float32, expected float64: y0\.astype"):
        lh.integrate(CIRCLE, (0, 1), np.array([1, 0], dtype=np.float32), dt=0.5)
    half = lh.QQ.convert("1/2")
    assert np.array_equal(lh.integrate(CIRCLE, (0, 1), [half, half], dt=0.5).y[:, 0], [0.5, 0.5])


def test_progress_is_told_to_a_function() -> None:
    seen: list[float] = []
    lh.integrate(BODY, (3, 1), M0, dt=0.001, step=lh.Euler(), progress=seen.append)
    assert seen[-1] == 1.0 and all(0 <= x <= 1 for x in seen) and seen == sorted(seen)


def test_progress_bar_goes_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    lh.integrate(BODY, (0, 1), M0, dt=0.01, step=lh.Euler(), progress=True)
    assert capsys.readouterr().out == ""


# -- what is refused -----------------------------------------------------------------------------------------
RHO = lh.defining(lh.so(3))


@pytest.mark.parametrize(("error", "text", "change"), [
    (InputError, "GeneratorField", {"field": "m0"}), (InputError, "step", {"step": "eulr"}),
    (InputError, "step", {"step": 4}), (ShapeError, "3 coordinates", {"y0": [1.0, 0.0]}),
    (ShapeError, "3 coordinates", {"y0": 1.0}), (InputError, "not finite", {"y0": [np.nan, 0, 1.0]}),
    (InputError, "not finite", {"y0": [np.inf, 0, 1.0]}), (InputError, "real", {"y0": [1j, 0, 1.0]}),
    (InputError, "start", {"y0": ["a", 0, 1.0]}), (InputError, "start", {"y0": [[1.0, 0], [1.0]]}),
    (InputError, "t_span", {"t_span": 3}), (InputError, "t_span", {"t_span": (0, 1, 2)}),
    (InputError, "t_span", {"t_span": "12"}), (InputError, "finite", {"t_span": (0, np.inf)}),
    (InputError, "finite", {"t_span": (np.nan, 1)}), (InputError, "dt", {"dt": 0}), (InputError, "dt", {"dt": -0.1}),
    (InputError, "dt", {"dt": np.nan}), (InputError, "dt", {"dt": np.inf}), (InputError, "dt", {"dt": "a"}),
    (InputError, "round-off", {"dt": 1e-17}), (ShapeError, "dt", {"dt": [0.1, 0.2]}),
    (InputError, "rtol", {"rtol": -1}), (InputError, "atol", {"atol": np.nan}),
    (InputError, "both 0", {"rtol": 0, "atol": 0}), (InputError, "max_step", {"max_step": 0}),
    (InputError, "first_step", {"first_step": -1}), (InputError, "max_steps", {"max_steps": 0}),
    (InputError, "clock", {"clock": "own"}), (InputError, "exponential", {"exponential": "sqrt"}),
    (InputError, "within t_span", {"t_eval": [0.5, 1.1]}), (InputError, "within t_span", {"t_eval": [-0.1, 0.5]}),
    (InputError, "within t_span", {"t_eval": [0.1, np.nan]}), (InputError, "sorted", {"t_eval": [0.5, 0.1]}),
    (InputError, "sorted", {"t_eval": [0.5, 0.5]}), (InputError, "sorted", {"t_span": (1, 0), "t_eval": [0.1, 0.5]}),
    (ShapeError, "t_eval", {"t_eval": 0.5}), (InputError, "t_eval", {"t_eval": ["x"]}),
    (InputError, "events", {"events": 3}), (InputError, r"events\[1\]", {"events": [lambda t, y: y[0], 4]}),
    (InputError, "progress", {"progress": "yes"}), (InputError, "path of a file", {"checkpoint": 3}),
    (ShapeError, "psi", {"field": lh.GeneratorField(RHO, lambda m: m[..., :2])}),
    (InputError, "finite", {"field": lh.GeneratorField(RHO, lambda m: m * np.nan)}),
    (InputError, "finite", {"field": lh.GeneratorField(RHO, lambda m: m / (m - m))}),
    (InputError, "real", {"field": lh.GeneratorField(RHO, lambda m: m * 1j)}),
], ids=lambda x: "-".join(x) if isinstance(x, dict) else "")  # fmt: skip
def test_bad_input_is_refused(error: type[Exception], text: str, change: dict[str, Any]) -> None:
    arguments = {"field": BODY, "t_span": (0, 1), "y0": M0, **change}
    with pytest.raises(error, match=text):
        lh.integrate(**arguments)


def test_a_field_that_is_not_tangent_is_refused() -> None:
    field = lh.GeneratorField.from_vector_field(RHO, lambda m: m * 1.0)
    with pytest.raises(TangencyError):
        lh.integrate(field, (0, 1), M0)


def test_one_bad_start_of_an_ensemble_is_named() -> None:
    m = points((2, 2))
    m[1, 0] = 0  # a point that the group fixes is constant
    assert (lh.integrate(BODY, (0, 1), m, t_eval=[1.0]).y[1, 0] == 0).all()
    field = lh.GeneratorField(RHO, lambda m: m / (m[..., :1] - 5))
    m[1, 0] = [5.0, 0, 0]
    with pytest.raises(InputError, match=r"\(1, 0\)"):
        lh.integrate(field, (0, 1), m)


@given(
    st.floats(-10, 10), st.floats(-10, 10), st.floats(1e-3, 30), st.booleans(), st.lists(st.floats(0, 1), max_size=4)
)
@settings(max_examples=examples(25))
def test_whatever_the_span_the_step_and_the_times(start: float, end: float, dt: float, fixed: bool, share: Any) -> None:
    dt = max(dt, abs(end - start) / 60)
    times = np.unique(start + np.array(sorted(share)) * (end - start))
    times = np.clip(times if end >= start else times[::-1], min(start, end), max(start, end))
    kind = {"dt": dt} if fixed else {"max_step": dt}
    sol = lh.integrate(
        DRIVEN, (start, end), E1, t_eval=np.array(times), dense_output=True, step=lh.LieTaylor(4), **kind
    )
    assert sol.success and np.array_equal(sol.t, times)
    assert np.abs((sol.y**2).sum(axis=0) - 1).max(initial=0) < 1e-12
    assert np.abs(sol.sol(times) - sol.y).max(initial=0) < 1e-12
    n = abs(end - start) / dt
    assert sol.n_steps >= np.floor(n) and (not fixed or sol.n_steps <= np.ceil(n))
