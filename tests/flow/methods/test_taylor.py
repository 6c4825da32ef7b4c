"""Taylor steps: their orders on seven kinds of orbits with negative controls, and that they stay on the orbits."""

from functools import cache
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.field import check_point
from liehom.flow.engines.llvm_engine import LlvmEngine
from liehom.flow.methods.taylor import InvariantSeries, LandedSeries, TaylorSeries
from liehom.flow.steps.step import Generator
from tests.flow.methods.test_every_method import problem
from tests.flow.propagation import spaces

PROJECTED = ["S^2", "S^4", "H^3"]
BY_INVARIANTS = ["CP^2", "Sym(3) at (1,2,3)", "SU(3)/T", "V_2(R^4)"]
MANIFOLDS = [*PROJECTED, *BY_INVARIANTS]
COUNTS = {2: (16, 32), 4: (16, 32), 6: (16, 32), 9: (16, 32), 10: (8, 16), 12: (8, 16), 16: (4, 7)}
"""Numbers of steps between which the order is measured, in the range of asymptotics and above round-off."""
WINDOW = {2: 0.15, 4: 0.15, 6: 0.25, 9: 0.25, 10: 0.6, 12: 1.2, 16: 2.5}


@cache
def precise(manifold: str) -> tuple[Any, Any]:
    """Starts and ends of `problem` in extended precision.

    Rounded points of CP^2 are on orbits of larger dimension next to it, and a landing puts them back.
    """
    p = problem(manifold)
    if manifold != "CP^2":
        return p.starts.astype(np.longdouble), p.end
    x = spaces.seeded(manifold).normal(size=(len(p.starts), 8)).astype(np.longdouble)
    point = np.round(spaces.unitary_point([1, 1, -2]), 12).astype(np.longdouble)
    starts = lh.Action(p.field.representation).act(x, np.broadcast_to(point, x.shape))
    assert np.abs(starts - p.starts).max() < 1e-13
    end = lh.integrate(p.field, (0, p.t), starts, step=lh.LieTaylor(14), dt=p.t / 80, t_eval=[p.t])
    return starts, end.y[..., 0]


def run(manifold: str, step: Any, count: int, *, change: Any = None, by_exponentials: bool = False) -> float:
    """The error, relative to the points, after `count` steps in extended precision; `change` spoils each step."""
    p = problem(manifold)
    m, end = precise(manifold)
    action = lh.Action(p.field.representation)
    psi = Generator(p.field, spaces.make(manifold).dimension, m)
    h = np.full((len(m), 1), np.longdouble(p.t) / count)
    for i in range(count):
        if by_exponentials:
            step = step.with_prepared(_prepared=True)
        local = step.at(action, psi, m, i * h)
        if change is not None:
            change(local)
        m = local.point(h)
    scale = np.sqrt(np.mean(np.sum(p.starts**2, axis=-1)))
    return float(np.sqrt(np.mean(np.sum((m - end) ** 2, axis=-1))) / scale)


def slope(manifold: str, n: int, **options: Any) -> float:
    few, many = COUNTS[n]
    errors = [run(manifold, lh.Taylor(n), count, **options) for count in (few, many)]
    assert errors[1] > 1e-18, errors  # above round-off
    return float(np.log2(errors[0] / errors[1]) / np.log2(many / few))


@pytest.mark.parametrize("n", [2, 4, 6, 9, 10, 12, 16])
@pytest.mark.parametrize("manifold", MANIFOLDS)
def test_observed_order(manifold: str, n: int) -> None:
    assert abs(slope(manifold, n) - n) < WINDOW[n]


@pytest.mark.parametrize("n", [4, 9, 12])
@pytest.mark.parametrize("manifold", BY_INVARIANTS)
def test_observed_order_by_exponentials(manifold: str, n: int) -> None:
    assert abs(slope(manifold, n, by_exponentials=True) - n) < WINDOW[n]


def without_last(local: TaylorSeries) -> None:
    """Drop the coefficient of h^n, in the series of the point and of the generator."""
    local.trajectory = local.trajectory[:-1]
    if isinstance(local, LandedSeries):
        local._velocity = local._velocity[:-1]


@pytest.mark.parametrize("n", [2, 6, 10])
@pytest.mark.parametrize("manifold", MANIFOLDS)
def test_without_the_last_coefficient_the_order_is_one_lower(manifold: str, n: int) -> None:
    assert abs(slope(manifold, n, change=without_last) - (n - 1)) < WINDOW[n]


@pytest.mark.parametrize(("q", "iterations"), [(5, 0), (3, 0), (3, 1), (3, 2)])
@pytest.mark.parametrize("manifold", BY_INVARIANTS)
def test_the_corrections_limit_the_order(manifold: str, q: int, iterations: int) -> None:
    """Theorem 3 of theory/taylor: the error of a step after j corrections is O(h^(q (j + 1))).

    For q = 3 the commutator is left out of xi.
    """

    def changed(local: Any) -> None:
        assert local.iterations == 2
        local.iterations = iterations
        if q == 3:
            psi = list(local._velocity)
            local.generator = lambda h: sum(x * h ** (k + 1) / (k + 1) for k, x in enumerate(psi))

    errors, whole = (
        [run(manifold, lh.Taylor(12), k, change=by, by_exponentials=True) for k in (12, 24)] for by in (changed, None)
    )
    limit = q * (iterations + 1) - 1
    assert abs(np.log2(errors[0] / errors[1]) - limit) < 1.1, errors
    # near the steps at which the lower order costs nothing yet, the whole step shows its order, else its accuracy
    assert errors[0] > 20 * whole[0] or np.log2(whole[0] / whole[1]) > limit + 1.1, whole


@pytest.mark.parametrize("manifold", ["Sym(3) at (1,2,3)", "V_2(R^4)"])
def test_the_landing_keeps_the_order_with_the_cayley_transform(manifold: str) -> None:
    """On V_2(R^4) by the action of SO(4) on both vectors; elsewhere Cayley goes through the group."""
    p = problem(manifold)
    ends = [
        lh.integrate(p.field, (0, p.t), p.starts, step=lh.Taylor(8), dt=p.t / k, t_eval=[p.t], exponential="cayley")
        for k in (4, 8)
    ]
    errors = [float(np.abs(e.y[..., 0] - p.end).max()) for e in ends]
    assert 7 < np.log2(errors[0] / errors[1]) < 10, errors


@pytest.mark.parametrize("n", [6, 12])
@pytest.mark.parametrize("manifold", ["S^2", "H^3", "SU(3)/T"])
def test_order_for_a_time_dependent_field(manifold: str, n: int) -> None:
    space = spaces.make(manifold)
    psi = spaces.quadratic(space, spaces.seeded(f"forced fields on {manifold}"), timed=True)
    field = lh.GeneratorField(space.representation, psi)
    points = space.starts.astype(np.longdouble)
    end = lh.integrate(field, (0, 1), points, step=lh.LieTaylor(16), dt=1 / 50, t_eval=[1]).y[..., 0]
    counts = (16, 32) if n == 6 else (6, 12)
    ends = [lh.integrate(field, (0, 1), points, step=lh.Taylor(n), dt=1 / k, t_eval=[1]).y[..., 0] for k in counts]
    errors = [float(np.sqrt(np.mean((y - end) ** 2))) for y in ends]
    assert abs(np.log2(errors[0] / errors[1]) - n) < 0.8, errors


# -- on the orbit ------------------------------------------------------------------------------------------
def invariants(manifold: str, m: Any) -> Any:
    """Functions that are constant on the orbits, relative to powers of |m|."""
    if manifold == "H^3":
        return (m**2 * [1.0, 1.0, 1.0, -1.0]).sum(-1, keepdims=True) / (m * m).sum(-1, keepdims=True)
    if manifold.startswith("Sym(3)"):
        return np.linalg.eigvalsh(m[..., [[0, 1, 2], [1, 3, 4], [2, 4, 5]]])
    return np.linalg.norm(m, axis=-1, keepdims=True)


@pytest.mark.parametrize(("manifold", "bound"), [("S^2", 4e-16), ("S^4", 4e-16), ("Sym(3) at (1,2,3)", 4e-14)])
def test_points_stay_on_the_orbit_over_a_long_run(manifold: str, bound: float) -> None:
    """By projection the error is that of one step, whatever the number of steps; by exponentials it walks."""
    p = problem(manifold)
    sol = lh.integrate(p.field, (0, 300), p.starts, step=lh.Taylor(8), dt=0.25, t_eval=np.linspace(0, 300, 7))
    result = invariants(manifold, np.moveaxis(sol.y, -1, 0))
    assert sol.success and np.abs(result - result[0]).max() < bound


def by_maps(manifold: str, h: float) -> tuple[InvariantSeries, Any]:
    """A step that is landed by an equivariant map, and its sizes."""
    p = problem(manifold)
    action, psi = lh.Action(p.field.representation), Generator(p.field, spaces.make(manifold).dimension, p.starts)
    local = lh.Taylor(4).at(action, psi, p.starts, np.zeros((len(p.starts), 1)))
    assert isinstance(local, InvariantSeries)
    return local, np.full((len(p.starts), 1), h)


@pytest.mark.parametrize("manifold", BY_INVARIANTS)
def test_long_steps_are_landed_by_exponentials(manifold: str) -> None:
    """A series that is far from the orbit is landed as if there were no map, and the others of the ensemble by it."""
    local, h = by_maps(manifold, 0.25)
    long = h.copy()
    long[::2] *= 60
    result, far = local.point(long), local._far.point(long)
    assert (result[::2] == far[::2]).all()
    assert (result[1::2] == local.point(h)[1::2]).all()
    assert (np.abs(result - far)[1::2].max(axis=-1) > 0).all()
    assert np.abs(result - far)[1::2].max() < 1e-3
    for points in (result, local.point(h)):
        assert (check_point(local.action.representation, points) == spaces.make(manifold).dimension).all()
        assert np.abs(local._landing.improved(points, local._numbers) - points).max() < 1e-13 * np.abs(points).max()


@pytest.mark.parametrize("manifold", BY_INVARIANTS)
def test_compiled_steps_that_are_too_long_are_those_of_numpy(manifold: str) -> None:
    pytest.importorskip("llvmlite")
    p = problem(manifold)
    ends = [
        lh.integrate(p.field, (0, 12), p.starts, step=lh.Taylor(4), dt=3.0, engine=engine).y
        for engine in ("numpy", "llvm")
    ]
    assert np.isfinite(ends[0]).all()
    assert np.abs(ends[0] - ends[1]).max() < 1e-9 * np.abs(ends[0]).max()


@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-8}])
def test_a_second_call_on_an_orbit_of_smaller_dimension_is_made_by_its_plan(options: dict[str, Any]) -> None:
    """Points of another orbit of that dimension, and of one of larger dimension, are looked at closely."""
    pytest.importorskip("llvmlite")
    p = problem("CP^2")
    propagator = lh.Propagator(p.field, step=lh.Taylor(8), engine="llvm")
    with patch.object(LlvmEngine, "solve", autospec=True, side_effect=LlvmEngine.solve) as solve:
        for factor, calls in ((1.0, 1), (2.0, 1), (-1.0, 2)):
            start = factor * p.starts[1]
            end = propagator((0, 2), start, t_eval=[2.0], **options).y
            assert solve.call_count == calls
            exact = lh.integrate(p.field, (0, 2), start, step=lh.LieTaylor(12), dt=0.02, t_eval=[2.0]).y
            assert np.abs(end - exact).max() < 1e-6
        start = problem("SU(3)/T").starts[0]
        end = propagator((0, 2), start, t_eval=[2.0], **options).y
        exact = lh.integrate(p.field, (0, 2), start, step=lh.LieTaylor(12), dt=0.02, t_eval=[2.0]).y
        assert solve.call_count == 3
        assert np.abs(end - exact).max() < 1e-6


def test_without_the_landing_points_leave_the_orbit() -> None:
    p = problem("S^2")
    action, psi = lh.Action(p.field.representation), Generator(p.field, 2, p.starts)
    local = lh.Taylor(8).at(action, psi, p.starts, np.zeros((len(p.starts), 1)))
    assert isinstance(local, TaylorSeries)
    h = np.full((len(p.starts), 1), 0.5)
    assert np.abs(np.linalg.norm(local.series(h), axis=-1) - 1).max() > 1e-9
    assert np.abs(np.linalg.norm(local.point(h), axis=-1) - 1).max() < 4e-16


@pytest.mark.parametrize("manifold", ["S^2", "H^3", "SU(3)/T"])
def test_backwards_in_time(manifold: str) -> None:
    p = problem(manifold)
    there = lh.integrate(p.field, (0, 1), p.starts, step=lh.Taylor(12), rtol=1e-12, atol=0, t_eval=[1]).y[..., 0]
    back = lh.integrate(p.field, (1, 0), there, step=lh.Taylor(12), rtol=1e-12, atol=0, t_eval=[0]).y[..., 0]
    assert np.abs(back - p.starts).max() < 1e-10 * np.abs(p.starts).max()
    assert np.abs(there - p.starts).max() > 0.1


@pytest.mark.parametrize("manifold", ["S^4", "H^3", "V_2(R^4)"])
def test_adaptive_sizes_keep_the_tolerance(manifold: str) -> None:
    p, result = problem(manifold), []
    for rtol in (1e-4, 1e-7, 1e-10):
        sol = lh.integrate(p.field, (0, p.t), p.starts, step=lh.Taylor(10), rtol=rtol, atol=0, t_eval=[p.t])
        result.append(float(np.abs(sol.y[..., 0] - p.end).max() / np.abs(p.starts).max()) / rtol)
        assert sol.success and sol.n_steps.max() > 1
    assert max(result) < 10, result


def test_dense_output_has_the_order_and_stays_on_the_orbit() -> None:
    p = problem("S^4")
    sol = lh.integrate(p.field, (0, p.t), p.starts, step=lh.Taylor(12), rtol=1e-11, atol=0, dense_output=True).sol
    times = np.linspace(0, p.t, 33)
    exact = lh.integrate(p.field, (0, p.t), p.starts, step=lh.LieTaylor(14), dt=p.t / 100, t_eval=times).y
    result = sol(times)
    assert np.abs(result - exact).max() < 1e-9
    assert np.abs(np.linalg.norm(result, axis=-2) - 1).max() < 4e-16


def test_a_jump_is_not_seen_but_the_orbit_is_kept() -> None:
    """The stated limit: coefficients at the initial point of a step do not know of a jump within it."""
    axes = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])

    def psi(m: Any, t: Any) -> Any:
        return axes[0 if float(np.max(t.value if isinstance(t, lh.Jet) else t)) < 0.55 else 1] + 0 * m

    field = lh.GeneratorField(lh.defining(lh.so(3)), psi)
    start, action = np.array([0.6, 0.0, 0.8]), lh.Action(lh.defining(lh.so(3)))
    exact = action.act(0.45 * axes[1], action.act(0.55 * axes[0], start))
    sol = lh.integrate(field, (0, 1), start, step=lh.Taylor(8), dt=0.1).y[:, -1]
    assert 0.01 < np.abs(sol - exact).max() < 0.1  # the jump times half a step
    assert abs(np.linalg.norm(sol) - 1) < 4e-16
    halves = lh.integrate(field, (0, 0.55), start, step=lh.Taylor(8), dt=0.05).y[:, -1]
    halves = lh.integrate(field, (0.55, 1), halves, step=lh.Taylor(8), dt=0.05).y[:, -1]
    assert np.abs(halves - exact).max() < 1e-13
    pair = lh.integrate(field, (0, 1), start, step=lh.RKMK("rk45"), rtol=1e-9, atol=1e-12).y[:, -1]
    assert np.abs(pair - exact).max() < 1e-6


@pytest.mark.parametrize("n", [0, -1, True, 2.0, "4"])
def test_orders_that_are_not_positive_integers_are_rejected(n: Any) -> None:
    with pytest.raises(lh.InputError, match="the order of a Taylor step is an integer at least 1"):
        lh.Taylor(n)


# -- compiled ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("adaptive", [False, True])
@pytest.mark.parametrize("manifold", ["S^4", "H^3", "CP^2", "Sym(3) at (1,2,3)"])
def test_compiled_steps_agree(manifold: str, adaptive: bool) -> None:
    pytest.importorskip("llvmlite")
    p = problem(manifold)
    options: dict[str, Any] = {"rtol": 1e-9, "atol": 0.0} if adaptive else {"dt": p.t / 7}
    one, other = [
        lh.integrate(p.field, (0, p.t), p.starts, step=lh.Taylor(6), t_eval=[p.t], engine=engine, **options)
        for engine in ("numpy", "llvm")
    ]
    assert np.abs(one.y - other.y).max() < 1e-13 * np.abs(one.y).max()
    assert (one.n_steps == other.n_steps).all()


def test_corrected_by_isotropy_on_a_sphere() -> None:
    p = problem("S^4")
    errors = [
        np.abs(
            lh.integrate(p.field, (0, p.t), p.starts, step=lh.Corrected(lh.Taylor(2), order=4), dt=p.t / k).y[..., -1]
            - p.end
        ).max()
        for k in (16, 32)
    ]
    assert abs(np.log2(float(errors[0] / errors[1])) - 4) < 0.3, errors


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-11])
@pytest.mark.parametrize("power", [1, 2, 3, 4, 5, 6])
def test_sizes_are_right_where_the_last_terms_of_the_series_vanish(power, tolerance, engine):
    # at t = 0 the series has powers of t^(power + 1) only
    if engine == "llvm":
        pytest.importorskip("llvmlite")
    field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m, t: (t**power)[..., None])
    end = lh.integrate(field, (0, 2), [1.0, 0.0], rtol=tolerance, atol=tolerance / 10, engine=engine).y[:, -1]
    angle = 2 ** (power + 1) / (power + 1)
    assert np.abs(end - [np.cos(angle), np.sin(angle)]).max() < 30 * tolerance


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
@pytest.mark.parametrize("unit", [1e-11, 1e9])
def test_the_unit_of_time_does_not_change_the_steps(unit, engine):
    if engine == "llvm":
        pytest.importorskip("llvmlite")
    rho = lh.defining(lh.so(2))

    def run(u):
        field = lh.GeneratorField(rho, lambda m, t: (t / u**2)[..., None])
        return lh.integrate(field, (0, 4 * u), [1.0, 0.0], rtol=1e-8, engine=engine)

    result, expected = run(unit), run(1.0)
    assert result.n_steps == expected.n_steps
    # powers of sizes are computed to some per mille, which depend on the unit
    assert np.allclose(result.t / unit, expected.t, rtol=0.01, atol=0)
    assert np.abs(result.y[:, -1] - [np.cos(8), np.sin(8)]).max() < 1e-8
