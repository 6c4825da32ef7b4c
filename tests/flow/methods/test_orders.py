"""The orders that are promised, measured: trajectories with the corrected clock, root mean squares over eight
random fields and starts, slope over the last halving of the step size."""

from contextlib import nullcontext
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import liehom as lh
from tests.flow.propagation import spaces

FULL = ["S^2", "S^4", "S^6", "Sym(3) at (1,1,2)", "CP^2", "H^3"]
QUADRATIC = ["S^2", "S^4", "Sym(3) at (1,1,2)", "H^3"]
NOT_FULL = ["Sym(3) at (1,2,3)", "Gr(2,4)", "SU(3)/T", "two coupled spins"]
SIZES = np.array([0.1, 0.05, 0.025, 0.0125])
WINDOW = 0.15
HEUN, RKMK4 = lh.Heun(), lh.RKMK("rk4")


@cache
def problem(name: str, timed: bool = False) -> tuple[lh.GeneratorField, Any, Any]:
    """A field, starts, and the solution at t = 1 in extended precision, confirmed by another method."""
    space = spaces.make(name)
    field = lh.GeneratorField(
        space.representation, spaces.quadratic(space, spaces.seeded(f"fields on {name}"), timed=timed)
    )
    starts = space.starts
    end = lh.integrate(field, (0, 1), starts.astype(np.longdouble), step=lh.LieTaylor(16), dt=1 / 50, t_eval=[1])

    def ambient(t: float, y: Any) -> Any:
        m = y.reshape(starts.shape)
        return field.vector(m, np.full(m.shape[:-1], t)).ravel()

    other = solve_ivp(ambient, (0, 1), starts.ravel(), method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert np.abs(end.y[..., 0].ravel() - other).max() < 1e-10 * np.abs(other).max()
    return field, starts, end.y[..., 0]


def errors(
    name: str, step: lh.Step, *, timed: bool = False, precise: bool = False, kept: bool = True, **options: Any
) -> tuple[Any, Any]:
    """Root mean square errors at t = 1 for all step sizes at once, and the report; `kept` is what the run must say."""
    field, starts, end = problem(name, timed)
    points = np.broadcast_to(starts, (len(SIZES), *starts.shape)).astype(np.longdouble if precise else float)
    with nullcontext() if kept else pytest.warns(lh.OrderWarning, match=f"did not keep its order {step.order} from"):
        sol = lh.integrate(field, (0, 1), points, step=step, dt=SIZES[:, None], t_eval=[1.0], **options)
    assert sol.success == kept and sol.status == (0 if kept else -2), sol.message
    result = np.sqrt(np.mean(np.sum((sol.y[..., 0] - end) ** 2, axis=-1), axis=-1)).astype(float)
    if result.min() < 1e-12 and not precise:
        return errors(name, step, timed=timed, precise=True, kept=kept, **options)
    return result, sol.report


def slope(found: Any) -> float:
    return float(np.log2(found[-2] / found[-1]))


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("name", FULL)
def test_euler_is_raised_to_any_order(name: str, order: int) -> None:
    result, report = errors(name, lh.Corrected(lh.Euler(), order=order))
    assert abs(slope(result) - order) < WINDOW, result
    assert report.order == order and report.range_condition and report.worst_residual < 1e-9


@pytest.mark.parametrize("name", [*FULL, *NOT_FULL])
def test_plain_euler_has_order_one(name: str) -> None:
    assert abs(slope(errors(name, lh.Euler())[0]) - 1) < WINDOW


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("name", QUADRATIC)
def test_the_same_with_the_cayley_transform(name: str, order: int) -> None:
    result, _ = errors(name, lh.Corrected(lh.Euler(), order=order), exponential="cayley")
    assert abs(slope(result) - order) < WINDOW, result


@pytest.mark.parametrize(
    "order", [3, pytest.param(4, marks=pytest.mark.slow), 5, pytest.param(6, marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("name", FULL)
def test_heun_is_raised(name: str, order: int) -> None:
    result, report = errors(name, lh.Corrected(HEUN, order=order))
    assert abs(slope(result) - order) < WINDOW, result
    assert report.base_order == 2


@pytest.mark.parametrize("order", [5, pytest.param(6, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", FULL)
def test_runge_kutta_munthe_kaas_is_raised(name: str, order: int) -> None:
    result, report = errors(name, lh.Corrected(RKMK4, order=order))
    assert abs(slope(result) - order) < WINDOW, result
    assert report.base_order == 4


@pytest.mark.parametrize("name", ["S^4", "Sym(3) at (1,1,2)", "CP^2"])
def test_without_the_clock_only_orbits_are_captured(name: str) -> None:
    """The negative control: with the nominal clock the trajectory has the order of the base."""
    result, report = errors(name, lh.Corrected(lh.Euler(), order=4), clock="nominal")
    assert abs(slope(result) - 1) < WINDOW
    assert report.order == 4


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("name", NOT_FULL)
def test_where_the_range_condition_fails_the_order_stays(name: str, order: int) -> None:
    result, report = errors(name, lh.Corrected(lh.Euler(), order=order), kept=False)
    assert abs(slope(result) - 1) < WINDOW
    assert report.order == 1 and report.range_condition is False
    assert report.worst_residual > 0.1 and report.singular_value < 1e-12
    assert report.rank < report.orbit_dimension == spaces.make(name).dimension
    assert "NOT reached" in str(report) and "FAILS" in str(report)


def test_two_spins_have_rank_three_of_four() -> None:
    _, report = errors("two coupled spins", lh.Corrected(lh.Euler(), order=2), kept=False)
    assert (report.rank, report.orbit_dimension) == (3, 4)


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("name", ["two coupled spins", "Sym(3) at (1,2,3)", "S^4"])
def test_lie_taylor_has_its_order_everywhere(name: str, order: int) -> None:
    assert abs(slope(errors(name, lh.LieTaylor(order))[0]) - order) < WINDOW


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun(), RKMK4, lh.LieTaylor(3)], ids=repr)
@pytest.mark.parametrize("name", ["S^2", "S^4"])
def test_time_dependent_fields(name: str, base: lh.Step) -> None:
    order = max(4, base.order + 1)
    result, _ = errors(name, lh.Corrected(base, order=order), timed=True)
    assert abs(slope(result) - order) < WINDOW, result
