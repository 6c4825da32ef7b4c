"""Dense output: the order of the step inside steps, on the manifold, the ends of steps, outside, ensembles."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.base.errors import ShapeError

BODY = lh.GeneratorField(lh.defining(lh.so(3)), lambda m, t: m * [1.0, 2.0, 3.0] + 0.3 + 0.2 * np.sin(t)[..., None])
M0 = np.array([0.6, 0.0, 0.8])
STEPS = [
    lh.Euler(), lh.Heun(), lh.BackwardEuler(), lh.LieTaylor(4), lh.Corrected(lh.Euler(), 3), lh.Corrected(lh.Heun(), 4),
    lh.Corrected(lh.BackwardEuler(), 3), lh.RKMK("rk45"), lh.methods.CommutatorFree4(),
]  # fmt: skip
CLOCKS = [(step, clock) for step in STEPS for clock in ("corrected", "nominal")]


def exact(times: Any, span: tuple[float, float] = (0.0, 0.8)) -> Any:
    found = solve_ivp(
        lambda t, y: BODY.vector(y, np.asarray(t)), span, M0, method="DOP853", rtol=1e-13, atol=1e-14, t_eval=times
    )
    return found.y


@pytest.mark.parametrize("step", STEPS, ids=repr)
def test_inside_the_steps_the_order_is_that_of_the_step(step: Any) -> None:
    for span in ((0.0, 0.8), (0.0, -0.8)):
        times = np.linspace(*span, 41)[1:-1]
        wanted = exact(times, span)
        errors = [
            np.abs(lh.integrate(BODY, span, M0, step=step, dt=dt, dense_output=True).sol(times) - wanted).max()
            for dt in (0.08, 0.04)
        ]
        slopes = np.log2(np.array(errors[:-1]) / errors[1:])
        assert abs(slopes[-1] - step.order) < 0.4, (errors, slopes)


@pytest.mark.parametrize(("step", "clock"), CLOCKS, ids=repr)
@pytest.mark.parametrize("end", [1.0, -1.0])
def test_at_the_ends_of_steps_and_between_them(step: Any, clock: str, end: float) -> None:
    sol = lh.integrate(BODY, (0, end), M0, step=step, dt=0.13, dense_output=True, clock=clock)
    assert np.array_equal(sol.sol(sol.t), sol.y)
    for t, y in zip(sol.t, sol.y.T, strict=True):
        assert np.array_equal(sol.sol(t), y)
        for near in (np.nextafter(t, -np.inf), np.nextafter(t, np.inf)):
            assert np.abs(sol.sol(near) - y).max() < 1e-14
    assert np.abs((sol.sol(np.linspace(0, end, 57)) ** 2).sum(axis=0) - 1).max() < 4e-15


@pytest.mark.parametrize("step", STEPS[3:5], ids=repr)
def test_outside_the_interval_the_steps_go_on(step: Any) -> None:
    sol = lh.integrate(BODY, (0, 1), M0, step=step, dt=0.05, dense_output=True).sol
    for t in (-0.02, 1.02):
        near = exact([t], (0.0, t))[:, -1]
        assert np.abs(sol(t) - near).max() < 1e-4 and abs(sol(t) @ sol(t) - 1) < 4e-15


def test_arguments() -> None:
    sol = lh.integrate(BODY, (0, 1), M0, dt=0.1, dense_output=True).sol
    assert sol(0.5).shape == (3,) and sol(np.float64(0.5)).shape == (3,) and sol(np.array(0.5)).shape == (3,)
    assert sol([0.5]).shape == (3, 1) and sol([]).shape == (3, 0) and sol(1).shape == (3,)
    times = np.array([0.7, 0.1, 0.7, 0.0, 1.0])
    assert np.array_equal(sol(times), np.stack([sol(t) for t in times], axis=-1))
    assert np.isnan(sol([np.nan, np.inf])).all() and np.isfinite(sol([0.2, np.nan])[:, 0]).all()
    with pytest.raises(ShapeError):
        sol(np.zeros((2, 2)))
    assert (sol.t_min, sol.t_max) == (0, 1)
    back = lh.integrate(BODY, (1, 0), M0, dt=0.1, dense_output=True).sol
    assert (back.t_min, back.t_max) == (0, 1)


@pytest.mark.parametrize("step", [lh.LieTaylor(5), lh.Corrected(lh.Euler(), 4), lh.RKMK("rk45")], ids=repr)
@pytest.mark.parametrize("end", [0.2, -0.2])
def test_an_ensemble_with_very_different_steps(step: Any, end: float) -> None:
    speeds = np.array([[0.01, 1.0], [30.0, 1e-9]])[..., None]
    field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: speeds * (m * [1.0, 2.0, 3.0] + 0.3))
    m = np.broadcast_to(M0, (2, 2, 3))
    sol = lh.integrate(field, (0, end), m, step=step, rtol=1e-7, dense_output=True)
    assert sol.n_steps.max() > 5 * sol.n_steps.min()
    times = np.linspace(0, end, 23)
    made = sol.sol(times)
    assert made.shape == (2, 2, 3, 23) and np.abs((made**2).sum(axis=-2) - 1).max() < 1e-13
    for index in np.ndindex(2, 2):
        speed = float(speeds[index][0])
        alone = lh.GeneratorField(
            lh.defining(lh.so(3)), lambda m, speed=speed: speed * (m * [1.0, 2.0, 3.0] + 0.3), time_dependent=False
        )
        one = lh.integrate(alone, (0, end), M0, step=step, rtol=1e-7, dense_output=True)
        assert abs(one.n_steps - sol.n_steps[index]) <= 1
        assert np.abs(one.sol(times) - made[index]).max() < 1e-9
        some = slice(0, sol.n_steps[index] + 1, 5)
        assert np.array_equal(sol.sol(sol.t[index][some])[index], sol.y[index][:, some])


def test_the_solution_is_not_changed_by_asking() -> None:
    sol = lh.integrate(BODY, (0, 1), M0, rtol=1e-8, dense_output=True)
    calls, y = sol.nfev, sol.y.copy()
    sol.sol(np.linspace(0, 1, 9))
    assert sol.nfev == calls and np.array_equal(y, sol.y)


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_trajectory_that_never_moved() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m: 1e160 * m[..., :1])
    start = np.array([[1e-135, 1e-135], [1.0, 1.0]])
    sol = lh.integrate(field, (0, 1), start, dt=0.5, step=lh.LieTaylor(4), dense_output=True)
    assert sol.statuses.tolist() == [0, -1] and sol.n_steps.tolist() == [2, 0]
    assert np.array_equal(sol.sol(0.3)[1], start[1]) and np.isnan(sol.t[1, 1:]).all()
