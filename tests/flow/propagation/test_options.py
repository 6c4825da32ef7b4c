"""Options of `integrate` as solve_ivp's users know them: steps by name, atol, min_step, types of the start."""

import decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.run.options import points_of

RHO = lh.adjoint(lh.so(3))
FIELD = lh.GeneratorField(RHO, lambda m: -m * [1.0, 0.5, 0.25])
START = np.array([0.6, 0.0, 0.8])


# -- steps by name -------------------------------------------------------------------------------------------
NAMED: dict[str, lh.Step] = {
    "rk45": lh.RKMK("rk45"), "rk4": lh.RKMK("rk4"), "lietaylor6": lh.LieTaylor(6), "euler": lh.Euler(),
    "Backward Euler": lh.BackwardEuler(),
}  # fmt: skip


@pytest.mark.parametrize("name", NAMED)
def test_a_name_is_its_step_at_every_door(name: str) -> None:
    step = NAMED[name]
    wanted = lh.integrate(FIELD, (0, 0.5), START, step=step, dt=0.1).y
    assert repr(lh.Propagator(FIELD, name).step) == repr(step)
    np.testing.assert_array_equal(lh.integrate(FIELD, (0, 0.5), START, step=name, dt=0.1).y, wanted)
    np.testing.assert_array_equal(lh.Propagator(FIELD, name)((0, 0.5), START, dt=0.1).y, wanted)
    chunked = lh.integrate_ensemble(FIELD, (0, 0.5), START[None], step=name, dt=0.1)
    np.testing.assert_allclose(chunked.y[0], wanted, rtol=0, atol=1e-15)
    spin = lh.LandauLifshitz(applied=[0, 0, 1.0])
    a, b = (spin.integrate((0, 0.5), START, step=s, dt=0.1).y for s in (name, step))
    np.testing.assert_array_equal(a, b)
    if step.order < 4:
        assert repr(lh.Corrected(name, 4)) == repr(lh.Corrected(step, 4))


def test_a_conserving_step_and_a_measured_order_take_names() -> None:
    energy = ["(m0**2 + m1**2/2 + m2**2/4)/2"]
    a, b = (lh.integrate(FIELD, (0, 1), START, step=lh.Conserving(s, energy), dt=0.1).y for s in ("heun", lh.Heun()))
    np.testing.assert_array_equal(a, b)
    made, wanted = (lh.observed_order(FIELD, START, s, [0.1, 0.05]).orders for s in ("heun", lh.Heun()))
    assert made == wanted


def test_a_store_of_a_name_is_that_of_its_step(tmp_path: Any) -> None:
    options: dict[str, Any] = {"store": tmp_path / "runs", "dt": 0.1}
    first = lh.integrate_ensemble(FIELD, (0, 0.5), START[None], step="rk4", **options)
    again = lh.integrate_ensemble(FIELD, (0, 0.5), START[None], step=lh.RKMK("rk4"), **options)
    np.testing.assert_array_equal(first.y, again.y)


def test_unknown_names_are_refused_with_near_ones() -> None:
    for door in (
        lambda: lh.integrate(FIELD, (0, 1), START, step="rk54"), lambda: lh.Propagator(FIELD, "rk54"),
        lambda: lh.Corrected("rk54", 6), lambda: lh.Conserving("rk54", ["m0"]),
        lambda: lh.integrate_ensemble(FIELD, (0, 1), START[None], step="rk54"),
        lambda: lh.observed_order(FIELD, START, "rk54", [0.1, 0.05]),
    ):  # fmt: skip
        with pytest.raises(InputError, match="did you mean 'rk4"):
            door()
    with pytest.raises(InputError, match="expected a step"):
        lh.Corrected(4, 4)  # type: ignore[arg-type]


# -- names of options ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(("name", "hint"), [
    ("method", "step='rk45'"), ("vectorized", "whole ensembles"), ("jac", "computed"), ("rtool", "'rtol'"),
    ("xyz", "known"),
])  # fmt: skip
def test_options_of_other_names_say_what_is_meant(name: str, hint: str) -> None:
    for call in (lh.integrate, lh.Propagator(FIELD)):
        given: Any = (FIELD, (0, 1), START) if call is lh.integrate else ((0, 1), START)
        with pytest.raises(TypeError, match=hint):
            call(*given, **{name: "RK45"})  # type: ignore[operator]


# -- tolerances and sizes ------------------------------------------------------------------------------------
def test_of_an_array_of_tolerances_the_least_counts() -> None:
    options: dict[str, Any] = {"step": "rk45", "rtol": 0.0}
    made = lh.integrate(FIELD, (0, 1), START, atol=[1e-3, 1e-7, 1e-5], **options)
    wanted = lh.integrate(FIELD, (0, 1), START, atol=1e-7, **options)
    coarse = lh.integrate(FIELD, (0, 1), START, atol=1e-3, **options)
    np.testing.assert_array_equal(made.y, wanted.y)
    assert coarse.n_steps < made.n_steps
    for atol, error in (([1e-3, 1e-6], ShapeError), ([1e-3, -1.0, 1e-3], InputError), (["a", "b", "c"], InputError)):
        with pytest.raises(error, match="atol"):
            lh.integrate(FIELD, (0, 1), START, atol=atol, **options)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("engine", ["numpy", "llvm"])
@pytest.mark.parametrize("step", ["rk45", "lietaylor4"])
def test_min_step_ends_a_trajectory_that_needs_less(engine: str, step: str) -> None:
    options: dict[str, Any] = {"step": step, "engine": engine}
    free = lh.integrate(FIELD, (0, 10), START, rtol=1e-10, atol=1e-12, **options)
    least = np.diff(free.t)[:-1].min()
    ended = lh.integrate(FIELD, (0, 10), START, rtol=1e-10, atol=1e-12, min_step=4 * least, **options)
    assert ended.status == -1 and "below min_step" in ended.message
    fine = lh.integrate(FIELD, (0, 10), START, rtol=1e-10, atol=1e-12, min_step=least / 1e3, **options)
    assert fine.status == 0 and np.abs(fine.y[:, -1] - free.y[:, -1]).max() < 1e-7


def test_min_step_bounds_no_fixed_step_and_is_below_max_step() -> None:
    assert lh.integrate(FIELD, (0, 1), START, dt=0.1, min_step=0.5).status == 0
    with pytest.raises(InputError, match="larger than max_step"):
        lh.integrate(FIELD, (0, 1), START, min_step=0.5, max_step=0.1)


# -- types of the start --------------------------------------------------------------------------------------
def test_exact_numbers_are_floats_and_longdouble_stays() -> None:
    for start in ([1, 0, 0], np.array([1, 0, 0], dtype=np.uint8), [Fraction(1, 2), 0, 1], [sympy.Rational(1, 2), 0, 1]):
        made = points_of(start)
        assert made.dtype == np.float64 and np.array_equal(made, [float(x) for x in start])
    assert lh.integrate(FIELD, (0, 1), START.astype(np.longdouble), dt=0.5).y.dtype == np.longdouble


@pytest.mark.parametrize(("start", "remedy"), [
    (START.astype(np.float32), "numpy.float64"), (START.astype(np.float16), "numpy.float64"),
    (START + 0j, "z.view"), ([0.6, 0.0, 0.8j], "z.view"), (START > 0.1, "0 and 1"),
    ([mpmath.mpf("0.6"), 0, 0.8], "mpf, which would be rounded"),
    ([decimal.Decimal("0.6"), 0, 0], "Decimal, which would be rounded"),
    ([sympy.Float("0.6", 30), 0, 0], "Float, which would be rounded"), (["a", "b", "c"], "expected real numbers"),
])  # fmt: skip
def test_other_types_are_refused_with_the_remedy_at_every_door(start: Any, remedy: str) -> None:
    for door in (
        lambda: lh.integrate(FIELD, (0, 1), start, dt=0.5),
        lambda: lh.Propagator(FIELD, engine="llvm")((0, 1), start, dt=0.5),
        lambda: lh.integrate_ensemble(FIELD, (0, 1), [start], dt=0.5),
        lambda: lh.observed_order(FIELD, start, "euler", [0.1, 0.05]),
    ):
        with pytest.raises(InputError, match=remedy):
            door()
