"""Fields that depend on time: leading orders, and zeros of the field that a trajectory passes."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps import corrected as completion_module
from liehom.flow.steps.corrected import isotropy_fraction
from liehom.flow.steps.expansion import Clock, flow_series, leading_order
from tests.flow.steps.support import exact_flow, one_step, run, slopes, spin, unit

A = np.array([[1.0, 0.3, -0.5], [-0.2, 0.7, 0.4], [0.1, -0.6, 0.9]])
C = np.array([[0.2, -0.8, 0.1], [0.5, 0.3, 0.6], [-0.7, 0.2, -0.1]])


def power(l: int) -> lh.GeneratorField:
    """psi = t^(l-1) f(m): leading order l at t = 0."""
    return lh.GeneratorField(spin(), lambda m, t: (t ** (l - 1))[..., None] * (m @ A.T + [0.2, 0.1, 0.5]))


def turning(m: Any, t: Any) -> Any:
    """A zero at t = 0 and a direction that turns there."""
    return t[..., None] * (m @ A.T) + (t * t)[..., None] * ((m * m) @ C.T)


@pytest.mark.parametrize("l", [1, 2, 3])
def test_leading_order(l: int) -> None:
    m = unit(2, 3)
    assert int(leading_order(flow_series(power(l), m, 4), 4)) == l
    assert int(leading_order(flow_series(power(l), m, 4, 0.5), 4)) == 1
    exact = lh.GeneratorField(lh.defining(lh.so(2)), ["m0", "m0*t", "t**2*m1"][l - 1 : l])
    point = np.array([lh.QQ.convert("3/5"), lh.QQ.convert("4/5")])
    assert int(leading_order(flow_series(exact, point, 4, 0), 4)) == l


@pytest.mark.parametrize("base", [lh.LieTaylor(2), lh.LieTaylor(3)], ids=str)
def test_the_clock_has_the_factor_l(base: Any) -> None:
    """F_tau agrees with the corrected step, tau = t + c t^(n-l+1)."""
    field, m = power(2), unit(2, 3)
    n = base.order + 1
    raised = lh.steps.correction(field, base, m, n)
    assert [k for k, x in enumerate(raised.zeta) if x is not None] == [n - 2]
    assert [k for k, x in enumerate(raised.clock) if x is not None and k > 1] == [n - 1]
    flow = flow_series(field, m, n)
    clock = Clock(flow, n, ())
    clock.set(n - 1, raised.clock[n - 1])
    assert np.allclose(clock.point(n), flow.point(n) + 2 * raised.clock[n - 1] * flow.point(2), rtol=1e-13)
    assert int(raised.reached) == n and float(raised.residual) < 1e-12


@pytest.mark.parametrize("order", [2, 3, 4, 5])
@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun(), lh.LieTaylor(3)], ids=str)
@pytest.mark.parametrize("l", [1, 2, 3])
def test_local_error_from_a_zero(l: int, base: Any, order: int) -> None:
    """One step from t = 0: the slope is order + 1, also where the base has an order below l (Euler, l = 2, 3)."""
    field, m = power(l), unit(2, 3)
    step = lh.Corrected(base, order)
    errors, sizes = [], [0.2, 0.1, 0.05]
    for h in sizes:
        z, tau = one_step(field, step, m, h)
        errors.append(np.linalg.norm(z - exact_flow(field, m, tau, steps=6)))
    assert slopes(sizes, errors)[-1] > step.order + 0.7, errors
    raised = lh.steps.correction(field, base, m, step.order)
    assert int(raised.reached) == step.order and int(raised.leading) == (l if l <= step.order else 0)


def test_an_uncorrected_step_is_worse_from_a_zero() -> None:
    field, m = power(2), unit(2, 3)
    errors, sizes = [], [0.2, 0.1, 0.05]
    for h in sizes:
        errors.append(np.linalg.norm(one_step(field, lh.Euler(), m, h)[0] - exact_flow(field, m, h, steps=6)))
    assert slopes(sizes, errors)[-1] < 2.2


def test_leading_orders_mixed_in_one_ensemble() -> None:
    field = power(2)
    m, times = unit(5, 4, 3), np.array([0.0, 0.7, 0.0, -0.4])
    step = lh.Corrected(lh.Euler(), 4)
    together, tau = one_step(field, step, m, 0.1, times)
    raised = lh.steps.correction(field, lh.Euler(), m, 4, t=times)
    assert raised.leading.tolist() == [2, 1, 2, 1]
    assert raised.reached.tolist() == [4] * 4
    for i in range(4):
        one, time = one_step(field, step, m[i], 0.1, times[i])
        assert np.allclose(one, together[i], rtol=0, atol=4e-16)
        assert np.isclose(time, tau[i], rtol=1e-15)
        alone = lh.steps.correction(field, lh.Euler(), m[i], 4, t=times[i])
        assert np.isclose(alone.singular_value, raised.singular_value[i]) and alone.rank == raised.rank[i] == 2


@pytest.mark.parametrize(
    ("base", "order"), [(lh.Euler(), 3), (lh.Euler(), 4), (lh.Heun(), 4), (lh.LieTaylor(3), 5)], ids=str
)
@pytest.mark.parametrize("start", [0.0, -0.47])
def test_the_order_holds_through_a_zero_of_the_field(base: Any, order: int, start: float) -> None:
    field, m = lh.GeneratorField(spin(), turning), unit(3, 3)
    errors = []
    for count in (40, 80):
        z, t = run(field, lh.Corrected(base, order), m, 1.0 / count, count, t=start)
        errors.append(np.linalg.norm(z - exact_flow(field, m, t - start, start, steps=30)))
    assert abs(slopes([2, 1], errors)[0] - order) < 0.3, errors


def test_by_isotropy_alone_the_order_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reason for the flow's own terms: corrections are series in h / t_0, so that order 2 is what remains."""
    monkeypatch.setattr(completion_module, "NO_ISOTROPY_UP_TO", -2.0)
    monkeypatch.setattr(completion_module, "ONLY_ISOTROPY_FROM", -1.0)
    field, m = power(2), unit(3, 3)
    errors = []
    for count in (40, 80):
        z, t = run(field, lh.Corrected(lh.Euler(), 4), m, 1.0 / count, count)
        errors.append(np.linalg.norm(z - exact_flow(field, m, t, steps=30)))
    assert 1.7 < slopes([2, 1], errors)[0] < 2.3, errors


def test_the_share_of_isotropy() -> None:
    """All of it for a field far from zeros, none next to one; continuous, and without regard to the unit of time."""
    action, m = lh.Action(spin()), unit(3, 3)
    times = np.linspace(-1.5, 1.5, 301)
    points = np.broadcast_to(m, (301, 3))
    share = isotropy_fraction(action, flow_series(power(2), points, 4, times), 1, 4)
    assert share[150] == 0 and share[0] == share[-1] == 1
    assert np.abs(np.diff(share)).max() < 0.1
    fast = lh.GeneratorField(spin(), lambda m, t: 50 * power(2).psi(m, 50 * t))
    assert np.allclose(isotropy_fraction(action, flow_series(fast, points, 4, times / 50), 1, 4), share, atol=1e-12)
    steady = lh.GeneratorField(spin(), lambda m, t: m @ A.T + 0.1 * np.sin(t)[..., None] * m)
    assert np.all(isotropy_fraction(action, flow_series(steady, points, 4, times), 1, 4) == 1)


def test_next_to_a_zero_all_is_bounded() -> None:
    """Down to denormal distances in time, without warnings (they are errors)."""
    field, m = lh.GeneratorField(spin(), turning), unit(3, 3)
    times = np.array([0.0, 5e-324, 1e-310, 1e-160, 1e-30, 1e-17, 1e-12, 1e-8, 1e-4, 1e-2])
    times = np.concatenate([times, -times])
    raised = lh.steps.correction(field, lh.Euler(), np.broadcast_to(m, (20, 3)), 5, t=times)
    for x in [*raised.zeta, *raised.clock]:
        assert x is None or (np.isfinite(x).all() and np.abs(x).max() < 20)
    assert (raised.reached == 5).all()
    m = np.broadcast_to(m, (20, 3))
    z, tau = one_step(field, lh.Corrected(lh.Euler(), 5), m, 0.05, times)
    assert np.abs(z - exact_flow(field, m, tau, times, steps=2)).max() < 1e-8


def test_a_flow_that_begins_later_than_the_order_is_completed() -> None:
    """w_1 = w_2 = w_3 = 0 but z_3 != 0: at order 3 no l is known, and the flow's own term still removes z_3."""

    class Ahead(lh.steps.OneExponential):
        order = 2

        def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
            return h * psi(m, t + h / 2) + h * h * h * np.array([0.1, 0.2, 0.3])

    field, m = power(4), unit(2, 3)
    raised = lh.steps.correction(field, Ahead(), m, 3)
    assert int(raised.leading) == 0 and int(raised.reached) == 3
    assert raised.singular_value == np.inf and raised.rank == 0
    z, tau = one_step(field, lh.Corrected(Ahead(), 3), m, 1e-2)
    assert tau == 1e-2 and np.abs(z - exact_flow(field, m, tau, steps=1)).max() < 1e-7
    assert np.abs(one_step(field, Ahead(), m, 1e-2)[0] - z).max() > 1e-7


def test_a_time_dependent_equilibrium_stays() -> None:
    field = lh.GeneratorField(spin(), lambda m, t: (1 + t)[..., None] * m)
    m = unit(4, 5, 3)
    raised = lh.steps.correction(field, lh.Euler(), m, 4, t=0.3)
    assert (raised.leading == 0).all() and (raised.reached == 4).all()
    z, tau = one_step(field, lh.Corrected(lh.Euler(), 4), m, 0.3, 0.3)
    assert np.abs(z - m).max() < 1e-15 and np.array_equal(tau, np.full(5, 0.3))


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
@pytest.mark.parametrize("rho", [spin(), lh.adjoint(lh.sl(2))], ids=["tight frame", "frame"])
def test_a_field_whose_squares_underflow(rho: lh.Representation, engine: str) -> None:
    """The tail of a pulse, where psi is between 1e-323 and 1e-140: isotropy makes no part of a correction there."""
    first = np.array([1e-323, 1e-310, 1e-250, 1e-200, 1e-170, 1e-162, 1e-158, 1e-155, 1e-140])
    args = {"c": lh.PerTrajectory(np.sqrt(-np.log(first) / 40))}
    field = lh.GeneratorField(rho, lambda m, t, a: np.exp(-40 * (t - a["c"]) ** 2)[..., None] * np.array([3, 2, 1.0]))
    m, options = np.broadcast_to([0.6, 0.9, -0.3], (len(first), 3)), {"args": args, "rtol": 1e-9, "atol": 1e-12}
    raised = lh.integrate(field, (0, 5), m, step=lh.Corrected(lh.Euler(), 4), engine=engine, **options)
    assert (raised.statuses == 0).all()
    assert np.abs(raised.y_end - lh.integrate(field, (0, 5), m, **options).y_end).max() < 1e-6
