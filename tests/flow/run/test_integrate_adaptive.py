"""Adapted step sizes: errors in proportion to the tolerance, bounds on steps, equilibria, separatrices."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liehom as lh
from liehom.flow.run.control import allowed_error, next_size
from liehom.flow.steps.step import size_from_defects

BODY = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0] + 0.3)
M0 = np.array([0.6, 0.0, 0.8])
# of the free rigid body: the coordinate axes are the equilibria, the second one is unstable
CROSS = lh.Representation.from_matrices(
    [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
)
FREE = lh.GeneratorField(CROSS, lambda m: -m / [1.0, 2.0, 3.0])
SCALING = lh.Representation.from_matrices([[[1]]])
STEPS = [lh.LieTaylor(6), lh.LieTaylor(3), lh.Corrected(lh.Euler(), 5), lh.RKMK("rk45"), lh.methods.CommutatorFree4()]


def reference(field: lh.GeneratorField, span: Any, m: Any, atol: float = 1e-14) -> Any:
    return solve_ivp(lambda t, y: field.vector(y), span, m, method="DOP853", rtol=1e-13, atol=atol).y[:, -1]


def near_the_axis(distance: float) -> Any:
    m = np.array([distance, 1.0, distance / 2])
    return m / np.linalg.norm(m)


# -- tolerances ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("step", STEPS, ids=repr)
def test_errors_follow_the_tolerance(step: Any) -> None:
    wanted = reference(BODY, (0, 2), M0)
    errors, counts = [], []
    tolerances = 10.0 ** -np.arange(3, 13, 3)
    for rtol in tolerances[: 4 if step.order > 4 else 3]:
        sol = lh.integrate(BODY, (0, 2), M0, step=step, rtol=rtol, atol=rtol * 1e-3)
        errors.append(np.abs(sol.y[:, -1] - wanted).max() / rtol)
        counts.append(sol.n_steps)
    # per step the error is the tolerance: what adds up is at most one tolerance per step, times how the flow spreads
    assert all(e < 3 * n for e, n in zip(errors, counts, strict=True)), errors
    # a thousandth of the tolerance needs 1000^(1/(p + 1)) times the steps
    growth = (counts[-1] / counts[0]) ** (1 / (len(counts) - 1))
    assert growth < 1.5 * 1000 ** (1 / (step.order if step == lh.RKMK("rk45") else step.order + 1))


@pytest.mark.parametrize("step", [lh.Corrected(lh.Euler(), 4), lh.Corrected(lh.Heun(), 4), lh.LieTaylor(6)], ids=repr)
def test_errors_of_all_steps_add_up_to_the_same_multiple_of_the_tolerance(step: Any) -> None:
    wanted, errors = reference(BODY, (0, 10), M0), []
    for rtol in (1e-4, 1e-6, 1e-9):
        sol = lh.integrate(BODY, (0, 10), M0, step=step, rtol=rtol, atol=1e-3 * rtol)
        errors.append(np.linalg.norm(sol.y[:, -1] - wanted) / rtol)
    assert min(errors) > 1 and max(errors) < 6  # with a tolerance in each step they are up to 9, 19 and 69


def test_as_few_steps_as_solve_ivp_for_the_same_error() -> None:
    wanted = reference(BODY, (0, 5), M0)
    for rtol in (1e-5, 1e-8):
        ours = lh.integrate(BODY, (0, 5), M0, step=lh.RKMK("rk45"), rtol=rtol, atol=1e-3 * rtol)
        theirs = solve_ivp(lambda t, y: BODY.vector(y), (0, 5), M0, rtol=rtol, atol=1e-3 * rtol)
        errors = [np.abs(s.y[:, -1] - wanted).max() for s in (ours, theirs)]
        work = [s.nfev * e**0.2 for s, e in zip((ours, theirs), errors, strict=True)]
        assert work[0] < 2 * work[1]


def test_absolute_and_relative_alone() -> None:
    small = 1e-6 * M0
    field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: 1e6 * m * [1.0, 2.0, 3.0] + 0.3)
    alone = lh.integrate(field, (0, 2), small, rtol=0, atol=1e-14, step=lh.LieTaylor(4))
    same = lh.integrate(field, (0, 2), small, rtol=1e-8 * np.sqrt(3), atol=0, step=lh.LieTaylor(4))
    assert abs(alone.n_steps - same.n_steps) <= 1
    assert lh.integrate(field, (0, 2), small, rtol=0, atol=1.0).n_steps < alone.n_steps


@pytest.mark.filterwarnings("ignore:status -1")
def test_tolerances_below_round_off_are_round_off() -> None:
    for step in (lh.LieTaylor(8), lh.Corrected(lh.Euler(), 8), lh.RKMK("rk45")):
        sol = lh.integrate(BODY, (0, 0.2), M0, step=step, rtol=1e-300, atol=0, max_steps=5000)
        assert sol.success and np.abs(sol.y[:, -1] - reference(BODY, (0, 0.2), M0)).max() < 1e-13
    sol = lh.integrate(BODY, (0, 1), M0, step=lh.Euler(), rtol=1e-300, atol=0, max_steps=30)
    assert sol.status == -1 and "max_steps" in sol.message and sol.n_steps == 30


@pytest.mark.parametrize("step", [lh.LieTaylor(6), lh.Corrected(lh.Euler(), 4), lh.RKMK("rk45")], ids=repr)
@pytest.mark.parametrize("end", [3.0, -3.0])
def test_bounds_on_steps(step: Any, end: float) -> None:
    sol = lh.integrate(BODY, (0, end), M0, step=step, max_step=0.02, clock="nominal")
    assert np.abs(np.diff(sol.t)).max() <= 0.02 * (1 + 1e-9) and sol.n_steps <= 152
    sol = lh.integrate(BODY, (0, end), M0, step=step, first_step=1e-5, clock="nominal")
    assert abs(abs(sol.t[1]) - 1e-5) < 1e-16 and sol.n_steps < 200 and sol.t[-1] == end
    sol = lh.integrate(BODY, (0, end), M0, step=step, first_step=100.0)
    assert sol.success and sol.t[-1] == end


def test_nominal_clock() -> None:
    # as in the paper: the orbit is right to the order of the correction, the times are not
    sol = lh.integrate(FREE, (0, 5), near_the_axis(0.5), step=lh.Corrected(lh.Euler(), 6), rtol=1e-10, clock="nominal")
    energy = (sol.y**2 / np.array([[1.0], [2.0], [3.0]])).sum(axis=0)
    assert sol.report.clock == "nominal" and sol.t[-1] == 5 and np.abs(energy - energy[0]).max() < 1e-8
    assert np.abs(sol.y[:, -1] - reference(FREE, (0, 5), near_the_axis(0.5))).max() > 1e-5


def test_a_jump_of_psi_is_seen_by_a_pair() -> None:
    jump = lh.GeneratorField(lh.defining(lh.so(2)), lambda m, t: np.where(t < 0.5, 1.0, -3.0)[..., None] * np.ones(1))
    sol = lh.integrate(jump, (0, 1), [1.0, 0.0], step=lh.RKMK("rk45"), rtol=1e-8)
    assert abs(np.arctan2(*sol.y[::-1, -1]) + 1) < 1e-5


def test_stiff_problems_get_there() -> None:
    # a fast approach to a point that moves slowly
    field = lh.GeneratorField(
        lh.defining(lh.so(2)), lambda m, t: (1000 * (m[..., 0] * np.sin(t) - m[..., 1] * np.cos(t)))[..., None]
    )
    for step in (lh.LieTaylor(6), lh.RKMK("rk45")):
        with pytest.warns(lh.StiffnessWarning):
            sol = lh.integrate(field, (0, 0.4), [0.0, 1.0], step=step, rtol=1e-6)
        assert sol.success and abs(np.arctan2(*sol.y[::-1, -1]) - 0.4) < 2e-3


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_pole_of_the_solution_is_not_passed() -> None:
    # m' = m^2 from 1: 1/(1 - t)
    field = lh.GeneratorField(SCALING, lambda m: m)
    for step in (lh.LieTaylor(6), lh.Corrected(lh.Euler(), 4), lh.RKMK("rk45")):
        sol = lh.integrate(field, (0, 2), [1.0], step=step, rtol=1e-6)
        assert sol.status == -1 and not sol.success and "below round-off" in sol.message
        assert abs(sol.t[-1] - 1) < 1e-5 and sol.y[0, -1] > 1e10 and np.isfinite(sol.y).all()
        some = sol.t < 0.9
        assert np.abs(sol.y[0, some] * (1 - sol.t[some]) - 1).max() < 1e-3


# -- equilibria ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("step", STEPS, ids=repr)
def test_at_an_equilibrium_one_step_is_enough(step: Any) -> None:
    zero = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: 0 * m)
    for field, m in ((zero, M0), (FREE, np.array([0.0, 1.0, 0.0])), (FREE, np.array([0.0, 0.0, -2.0]))):
        sol = lh.integrate(field, (0, 1e6), m, step=step)
        assert sol.n_steps == 1 and np.array_equal(sol.y[:, -1], m)
        sol = lh.integrate(field, (0, 1), m, step=step, dt=0.01)
        assert np.array_equal(sol.y[:, -1], m) and sol.report.equilibria in (0, 100)


@pytest.mark.parametrize("step", [lh.LieTaylor(4), lh.Corrected(lh.Euler(), 4), lh.RKMK("rk4")], ids=repr)
@pytest.mark.parametrize("distance", [1e-3, 1e-8])
def test_the_order_next_to_an_equilibrium(step: Any, distance: float) -> None:
    m = near_the_axis(distance)
    wanted = reference(FREE, (0, 20), m, atol=1e-25)[[0, 2]]
    errors = []
    for dt in (0.4, 0.2):
        sol = lh.integrate(FREE, (0, 20), m, step=step, dt=dt)
        errors.append(np.abs(sol.y[[0, 2], -1] - wanted).max() / np.abs(wanted).max())
        assert sol.report.order == 4 and np.abs((sol.y**2).sum(axis=0) - 1).max() < 1e-14
    assert abs(np.log2(errors[0] / errors[1]) - 4) < 0.25 and errors[-1] < 1e-4


@pytest.mark.parametrize("step", [lh.LieTaylor(6), lh.Corrected(lh.Euler(), 6), lh.RKMK("rk45")], ids=repr)
@pytest.mark.parametrize("distance", [1e-3, 1e-8, 1e-14])
def test_leaving_an_equilibrium_with_adapted_steps(step: Any, distance: float) -> None:
    m = near_the_axis(distance)
    end = 60.0 if distance == 1e-8 else 20.0
    wanted = reference(FREE, (0, end), m, atol=1e-25)
    sol = lh.integrate(FREE, (0, end), m, step=step, rtol=1e-9, atol=1e-20)
    assert sol.success and np.isfinite(sol.y).all()
    moved = np.abs(wanted - m).max()
    # errors grow as the distance does
    assert np.abs(sol.y[:, -1] - wanted).max() < 1e-6 * max(1, moved / distance) + 1e-12
    series = lh.integrate(FREE, (0, end), m, step=lh.LieTaylor(6), rtol=1e-9, atol=1e-30)
    assert np.abs(series.y[[0, 2], -1] - wanted[[0, 2]]).max() < 0.3 * np.abs(wanted[[0, 2]]).max()


@pytest.mark.parametrize("step", [lh.LieTaylor(6), lh.Corrected(lh.Euler(), 6), lh.RKMK("rk45")], ids=repr)
def test_on_a_separatrix(step: Any) -> None:
    # m1^2 (1/I1 - 1/I2) = m3^2 (1/I2 - 1/I3): the orbit runs into the second axis
    m = np.array([np.sqrt(1 / 6), 0.5, np.sqrt(1 / 2)])
    m /= np.linalg.norm(m)
    wanted = reference(FREE, (0, 8), m)
    for end in (8.0, -8.0, 60.0):
        sol = lh.integrate(FREE, (0, end), m, step=step, rtol=1e-10, atol=1e-13)
        energy = (sol.y**2 / np.array([[1.0], [2.0], [3.0]])).sum(axis=0)
        assert sol.success and np.isfinite(sol.y).all() and np.abs(energy - 0.5).max() < 1e-8
        if end == 8:
            assert np.abs(sol.y[:, -1] - wanted).max() < 1e-7
    errors = [
        np.abs(lh.integrate(FREE, (0, 8), m, step=lh.Corrected(lh.Euler(), 4), dt=dt).y[:, -1] - wanted).max()
        for dt in (0.2, 0.1)
    ]
    assert abs(np.log2(errors[0] / errors[1]) - 4) < 0.3


# -- the rules -----------------------------------------------------------------------------------------------
def test_rules_for_step_sizes() -> None:
    one, inf = np.array(1.0), np.array(np.inf)
    assert size_from_defects((), one, one, inf) == np.inf
    assert size_from_defects(((3, np.array(0.0)),), one, one, np.array(2.0)) == 2
    assert np.isclose(size_from_defects(((3, np.array(8.0)),), np.array(1.0), np.array(0.0), inf), 0.45)
    # next to an equilibrium the error is bounded by a share of the way
    assert np.isclose(size_from_defects(((3, np.array(1e-9)),), one, np.array(1e-9), inf), 0.9 * 0.1**0.5)
    assert np.isnan(size_from_defects(((3, np.array(np.nan)),), one, one, one))
    assert next_size(one, np.array(1.0), 5) == 0.9 and next_size(one, np.array(1e-30), 5) == 5
    assert allowed_error(0.0, 0.0, np.array([3.0, 4.0])) == 50 * np.finfo(float).eps
