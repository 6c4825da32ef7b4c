"""Calls of a propagator that differ in the points only."""

import pickle
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.engines.llvm_engine import LlvmEngine
from tests.flow.engines.test_compiled import BODY, START, sphere

pytest.importorskip("llvmlite")
SPAN = (0.0, 3.0)


class Watched(LlvmEngine):
    """The engine, which counts the calls that are made from the beginning."""

    def __init__(self) -> None:
        super().__init__()
        self.solved = 0

    def solve(self, problem: Any) -> Any:
        self.solved += 1
        return super().solve(problem)


def propagator(field: lh.GeneratorField = BODY, step: Any = None) -> tuple[lh.Propagator, Watched]:
    engine = Watched()
    return lh.Propagator(field, step, engine=engine), engine


@pytest.mark.parametrize("options", [{}, {"t_eval": [0.0, 0.55, 3.0]}, {"t_eval": [3.0]}], ids=str)
@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_a_second_call_is_that_of_numpy(count: int, options: dict[str, Any]) -> None:
    made, engine = propagator(step=lh.LieTaylor(4))
    starts = sphere(2 * count).reshape(2, count, 3)
    points = starts if count > 1 else starts[:, 0]
    for y0 in points:
        sol, plain = (
            made(SPAN, y0, dt=0.1, **options),
            lh.integrate(BODY, SPAN, y0, step=made.step, dt=0.1, engine="numpy", **options),
        )
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-14)
        np.testing.assert_array_equal(sol.t, plain.t)
        np.testing.assert_array_equal(sol.n_steps, plain.n_steps)
        np.testing.assert_array_equal(sol.statuses, plain.statuses)
        assert (sol.nfev, sol.status, sol.message, sol.report) == (plain.nfev, 0, plain.message, plain.report)
    assert engine.solved == 1


def test_a_result_is_not_that_of_the_next_call() -> None:
    made, _ = propagator(step=lh.RKMK("rk4"))
    made(SPAN, START, dt=0.1)
    first, second = (made(SPAN, y0, dt=0.1) for y0 in (START, -START))
    kept = second.y.copy()
    first.y[:], first.t[:] = 7.0, 7.0
    np.testing.assert_array_equal(second.y, kept)
    assert made(SPAN, START, dt=0.1).t[-1] == 3.0


@pytest.mark.parametrize("bad", [[np.nan, 0.0, 1.0], [np.inf, 0.0, 1.0]])
@pytest.mark.parametrize("count", [1, 100])
def test_points_are_checked_in_every_call(bad: list[float], count: int) -> None:
    made, _ = propagator(step=lh.RKMK("rk4"))
    points = sphere(count) if count > 1 else START
    made(SPAN, points, dt=0.1)
    wrong = points.copy()
    wrong[-1 if count > 1 else slice(None)] = bad
    with pytest.raises(InputError, match="not finite"):
        made(SPAN, wrong, dt=0.1)


@pytest.mark.parametrize("count", [1, 100])
def test_points_that_the_group_fixes_are_found_in_every_call(count: int) -> None:
    made, engine = propagator(step=lh.RKMK("rk4"))
    points = sphere(count) if count > 1 else START
    made(SPAN, points, dt=0.1)
    fixed = points.copy()
    fixed[-1 if count > 1 else slice(None)] = 0.0
    sol = made(SPAN, fixed, dt=0.1)
    plain = lh.integrate(BODY, SPAN, fixed, step=made.step, dt=0.1, engine="numpy")
    np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-14)
    assert sol.report == plain.report and engine.solved == 1  # numpy makes it


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_trajectory_that_fails_is_made_from_the_beginning() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: np.sqrt(m[..., :1] + 0.5) * [0.01, 0, 0] + [0, 0.5, 1.0])
    made, engine = propagator(field, lh.RKMK("rk4"))
    good, bad = np.array([0.0, 0.45, 0.9]), np.array([0.4, -0.8, 0.1])
    assert made(SPAN, good, dt=0.1).status == 0 and made(SPAN, good, dt=0.1).status == 0 and engine.solved == 1
    failed, plain = made(SPAN, bad, dt=0.1), lh.integrate(field, SPAN, bad, step=made.step, dt=0.1)
    assert engine.solved == 2 and failed.status == plain.status == -1 and failed.message == plain.message


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("change", [{"dt": 0.2}, {"t_eval": [1.0]}, {"max_steps": 3}, {"rtol": 1e-3}], ids=str)
def test_another_call_is_made_from_the_beginning(change: dict[str, Any]) -> None:
    made, engine = propagator(step=lh.RKMK("rk4"))
    made(SPAN, START, dt=0.1)
    options: dict[str, Any] = {"dt": 0.1, **change}
    sol = made(SPAN, START, **options)
    assert engine.solved == 2
    np.testing.assert_allclose(sol.y, lh.integrate(BODY, SPAN, START, step=made.step, **options).y, atol=1e-14)


def test_points_on_smaller_orbits_are_looked_at_closely() -> None:
    field = lh.GeneratorField(lh.sym_conjugation(3), lambda m: np.stack([m[..., 1], m[..., 2], m[..., 4]], axis=-1))
    made, engine = propagator(field, lh.RKMK("rk4"))
    made(SPAN, np.array([1.0, 0.1, 0.2, 2.0, 0.3, 3.0]), dt=0.1)
    small = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 2.0])
    assert made(SPAN, small, dt=0.1).report.orbit_dimension == 2 and engine.solved == 2
    made(SPAN, np.array([1.0, 0.1, 0.3, 2.0, 0.3, 4.0]), dt=0.1)
    assert engine.solved == 2


@pytest.mark.parametrize("options", [{}, {"rtol": 1e-9}, {"rtol": 1e-4, "atol": 1e-7}], ids=str)
@pytest.mark.parametrize("step", [lh.RKMK("rk45"), lh.Taylor(8)], ids=repr)
@pytest.mark.parametrize("count", [1, 7, 100])
def test_a_second_call_with_adapted_steps_is_that_of_numpy(count: int, step: Any, options: dict[str, Any]) -> None:
    made, engine = propagator(step=step)
    times = np.array([0.0, 0.55, 3.0])
    starts = sphere(2 * count).reshape(2, count, 3)
    for y0 in starts if count > 1 else starts[:, 0]:
        sol = made(SPAN, y0, t_eval=times, **options)
        plain = lh.integrate(BODY, SPAN, y0, step=step, t_eval=times, **options, engine="numpy")
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(sol.n_steps, plain.n_steps)
        assert (sol.status, sol.message, sol.report) == (0, plain.message, plain.report)
    assert engine.solved == 1


def test_a_second_call_with_other_args_is_that_of_numpy() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"] + args["torque"])
    made, engine = propagator(field, lh.LieTaylor(4))
    for inertia, torque in (([1.0, 2.0, 3.0], 0.1), ([2.0, 2.5, 1.0], -0.3)):
        args = {"inertia": np.array(inertia), "torque": torque}
        sol, plain = (
            go(SPAN, START, dt=0.1, args=args) for go in (made, lh.Propagator(field, made.step, engine="numpy"))
        )
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-14)
    assert engine.solved == 1
    made(SPAN, START, dt=0.1, args={"inertia": np.array(2.0), "torque": 0.1})
    assert engine.solved == 2


def test_a_second_call_with_args_of_each_trajectory_is_that_of_numpy() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args["rate"][..., None])
    made, engine = propagator(field, lh.LieTaylor(4))
    points = sphere(5)
    for scale in (1.0, 2.0):
        args = {"rate": lh.PerTrajectory(scale * np.arange(1.0, 6.0))}
        sol, plain = (
            go(SPAN, points, dt=0.1, args=args) for go in (made, lh.Propagator(field, made.step, engine="numpy"))
        )
        np.testing.assert_allclose(sol.y, plain.y, rtol=0, atol=1e-13)
    assert engine.solved == 1


def test_sizes_of_each_trajectory_are_not_taken_for_one_size() -> None:
    made, _ = propagator(step=lh.RKMK("rk4"))
    points = sphere(2)
    made(SPAN, points, dt=np.array([0.1, 0.2]), t_eval=[3.0])
    assert made(SPAN, points, dt=0.2, t_eval=[3.0]).n_steps.tolist() == [15, 15]


@pytest.mark.parametrize(
    "args", ["3.0", np.complex128(2 + 3j), np.array(2 + 3j), lh.PerTrajectory(np.ones((1, 3)))], ids=repr
)
def test_a_second_call_checks_the_numbers_of_args(args: Any) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args)
    made, starts = lh.Propagator(field, engine="llvm"), sphere(5)
    first = lh.PerTrajectory(np.ones((5, 3))) if isinstance(args, lh.PerTrajectory) else 2.0
    made((0.0, 1.0), starts, args=first, dt=0.1)
    with pytest.raises(lh.errors.LiehomError, match="args"):
        made((0.0, 1.0), starts, args=args, dt=0.1)


def test_a_propagator_that_has_compiled_can_be_pickled() -> None:
    made = lh.Propagator(lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"]), engine="llvm")
    expected = made(SPAN, START, dt=0.1).y
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(made))(SPAN, START, dt=0.1).y, expected)
