"""A run that does not keep the order of its corrected step says so: status, message, success, report and a warning.

On the one-sheeted hyperboloid of so(2,1) the range condition fails where the velocity is a null vector. There the
corrections are as large as the step, and the run has the order of its base.
"""

from __future__ import annotations

import pickle
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import Phase, example, given, settings, strategies as st

import liehom as lh
from liehom.flow.run.records import bounds_of, earliness, time_of
from liehom.flow.steps.corrected import check_adaptive
from tests.flow.action.test_branch_free_frames import points_on_two_spheres, two_spheres
from tests.sampling import examples

HYPERBOLOID = lh.defining(lh.so(2, 1))
MINKOWSKI = np.array([1.0, 1.0, -1.0])
FIELD = lh.GeneratorField(HYPERBOLOID, ["3/4 + 3*m0/4", "1/2", "-3*m1/4 - m2/4"])
CROSSING, AWAY = np.array([0.6, 0.8, 0.0]), np.array([-1.0, 0.0, 0.0])
STEP = lh.Corrected(lh.Euler(), 4)
KEPT, LOST, STOPPED = 0, -2, -1


class Quiet(NamedTuple):
    """A solution and the warnings that it came with."""

    sol: Any
    caught: list[Any]


def quietly(*args: Any, **options: Any) -> Quiet:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sol = lh.integrate(*args, **options)
    return Quiet(sol, [entry for entry in caught if issubclass(entry.category, lh.OrderWarning)])


def null_times(start: Any, end: float) -> Any:
    """Times at which the velocity of FIELD is a null vector, to 1e-3."""
    t = np.linspace(0, end, 2001)
    x = FIELD.vector(lh.integrate(FIELD, (0, end), start, step=lh.LieTaylor(8), dt=0.02, t_eval=t).y.T)
    return t[1:][np.diff(np.sign(np.sum(x * x * MINKOWSKI, axis=-1))) != 0]


def test_the_reproducer_crosses_the_cone_once_and_the_control_does_not() -> None:
    assert len(null_times(CROSSING, 2.0)) == 1 and len(null_times(AWAY, 2.0)) == 0


@pytest.mark.parametrize("dt", [0.1, 0.05, 0.025, 0.0125])
def test_a_step_across_the_cone_is_noticed_at_every_step_size(dt: float) -> None:
    sol, caught = quietly(FIELD, (0, 2), CROSSING, step=STEP, dt=dt)
    (crossing,) = null_times(CROSSING, 2.0)
    assert not sol.success and sol.status in (LOST, STOPPED)
    assert len(caught) == (sol.report.unkept_from is not None)
    if sol.status == LOST:
        assert abs(sol.report.unkept_from - crossing) < 3 * dt
        assert sol.report.range_condition is False and sol.report.order == 1 and sol.report.near_steps > 0
        assert "order 4 was not kept" in sol.message and "cone" in sol.message and "At t = " in sol.message
        assert caught[0].message.time == sol.report.unkept_from and caught[0].message.order == 4
        assert caught[0].filename == __file__ and "LieTaylor(4)" in str(caught[0].message)
    else:
        assert "cone" in sol.message and abs(sol.t[-1] - crossing) < 3 * dt
        assert "up to t = " in str(sol.report)


def test_the_warning_next_to_the_cone_names_smaller_steps() -> None:
    """The path ends before it crosses: smaller steps stay more than two steps away, as the warning says."""
    sol, caught = quietly(FIELD, (0, 0.88), CROSSING, step=STEP, dt=0.1)
    assert sol.status == LOST and "A smaller dt or adaptive steps help" in str(caught[0].message)
    assert quietly(FIELD, (0, 0.88), CROSSING, step=STEP, dt=0.05).sol.status == KEPT


@pytest.mark.parametrize("backend", ["numpy", "llvm", pytest.param("jax", marks=pytest.mark.slow)])
def test_adaptive_sizes_keep_the_tolerance_across_the_cone(backend: str) -> None:
    """The order is not kept there, which the report and a warning say; what such a run promises is the tolerance."""
    pytest.importorskip({"llvm": "llvmlite"}.get(backend, backend))
    end = lh.integrate(FIELD, (0, 2), CROSSING, rtol=1e-13, atol=1e-15).y[:, -1]
    for rtol in (1e-3, 1e-6, 1e-9):
        sol, caught = quietly(FIELD, (0, 2), CROSSING, step=STEP, rtol=rtol, atol=1e-3 * rtol, engine=backend)
        assert sol.success and sol.status == KEPT and np.linalg.norm(sol.y[:, -1] - end) < 100 * rtol
        assert sol.report.order == 1 and sol.report.range_condition is False and len(caught) == 1
        assert "Sizes follow the tolerance" in str(caught[0].message)


def test_next_to_the_cone_a_step_is_compared_with_the_series_of_the_trajectory() -> None:
    """Coefficients at points next to a pole of zeta can miss it: this step made 800 times the error that is allowed."""
    rng = np.random.default_rng(1)
    rho = lh.defining("gl(2)")
    worst, near = 0.0, 0
    for _ in range(40):
        linear, constant, m = 0.4 * rng.normal(size=(4, 2)), 0.5 * rng.normal(size=4), rng.normal(size=2)
        field = lh.GeneratorField(rho, lambda m, a=linear, b=constant: m @ a.T + b)
        sol = quietly(field, (0, 3), m, step=STEP, rtol=1e-4, atol=1e-7, engine="numpy", max_steps=200).sol
        if not sol.report.near_steps or not sol.success:
            continue
        near += 1
        sizes = {"d": lh.PerTrajectory(np.diff(sol.t))}
        scaled = lh.GeneratorField(rho, lambda m, t, args, f=field: f.psi(m) * args["d"][..., None])
        ends = lh.integrate(scaled, (0, 1), sol.y.T[:-1], args=sizes, rtol=1e-11, atol=1e-13, t_eval=[1.0]).y[..., 0]
        errors = np.linalg.norm(ends - sol.y.T[1:], axis=-1)
        worst = max(worst, float((errors / (1e-4 * np.linalg.norm(sol.y.T[:-1], axis=-1))).max()))
    assert near > 3 and 0.1 < worst < 3


def test_what_would_be_claimed_is_not_reached() -> None:
    """The negative control of the check: the errors of the runs that it flags."""
    end = lh.integrate(FIELD, (0, 2), CROSSING, step=lh.LieTaylor(8), dt=0.01).y[:, -1]
    far = lh.integrate(FIELD, (0, 2), AWAY, step=lh.LieTaylor(8), dt=0.01).y[:, -1]
    worse = 0
    for dt in (0.1, 0.05, 0.025, 0.0125):
        flagged = quietly(FIELD, (0, 2), CROSSING, step=STEP, dt=dt).sol
        healthy = lh.integrate(FIELD, (0, 2), AWAY, step=STEP, dt=dt)
        assert healthy.success and np.abs(healthy.y[:, -1] - far).max() < 3 * dt**4
        worse += flagged.status == STOPPED or bool(np.abs(flagged.y[:, -1] - end).max() > 100 * dt**4)
    assert worse == 4


def test_an_orbit_without_range_condition_in_an_ensemble_is_named() -> None:
    rng = np.random.default_rng(5)
    linear, constant = rng.normal(size=(8, 6)) / 2, rng.normal(size=6) / 3
    field = lh.GeneratorField(two_spheres(), lambda m: m @ linear + constant)
    starts = points_on_two_spheres(60)
    sol, caught = quietly(field, (0, 1), starts, step=lh.Corrected(lh.Euler(), 3), dt=0.1)
    assert sol.statuses.tolist() == [KEPT] * 60 + [LOST] and sol.status == LOST and len(caught) == 1
    assert "trajectory 60; 1 of 61 did not keep it." in sol.message and sol.report.order == 1
    sizes = np.array([0.1, 0.05, 0.025])[:, None]
    ends = lh.integrate(field, (0, 1), starts, step=lh.LieTaylor(8), dt=0.04, t_eval=[1.0]).y[..., 0]
    points = np.broadcast_to(starts, (3, *starts.shape))
    made = quietly(field, (0, 1), points, step=lh.Corrected(lh.Euler(), 3), dt=sizes, t_eval=[1.0]).sol
    errors = np.linalg.norm(made.y[..., 0] - ends, axis=-1)
    slopes = np.log2(errors[1] / errors[2])
    assert np.abs(slopes[:60] - 3).max() < 0.4 and abs(slopes[60] - 1) < 0.1


@pytest.mark.parametrize("backend", ["llvm", pytest.param("jax", marks=pytest.mark.slow)])
@pytest.mark.parametrize("dt", [0.05, None])
def test_compiled_steps_notice_what_numpy_notices(backend: str, dt: float | None) -> None:
    pytest.importorskip("jax" if backend == "jax" else "llvmlite")
    starts = np.array([AWAY, CROSSING])
    options: dict[str, Any] = {"step": STEP, "dt": dt, "rtol": 1e-4, "max_steps": 400}
    plain, ours = quietly(FIELD, (0, 2), starts, **options)
    made, theirs = quietly(FIELD, (0, 2), starts, engine=backend, **options)
    assert made.statuses.tolist() == plain.statuses.tolist() and made.message == plain.message
    assert len(ours) == len(theirs)
    for name in ("order", "near_steps", "failed_steps", "range_condition"):
        assert getattr(made.report, name) == getattr(plain.report, name)
    if plain.report.unkept_from is not None:
        assert abs(made.report.unkept_from - plain.report.unkept_from) < 1e-12


def test_backwards_in_time_the_first_step_is_the_latest_time() -> None:
    end = lh.integrate(FIELD, (0, 2), CROSSING, step=lh.LieTaylor(8), dt=0.01).y[:, -1]
    for backend in ("numpy", "llvm"):
        sol, caught = quietly(FIELD, (2, 0), end, step=STEP, dt=0.025, engine=backend)
        (crossing,) = null_times(CROSSING, 2.0)
        assert len(caught) == (sol.report.unkept_from is not None) and not sol.success
        found = sol.t[-1] if sol.status == STOPPED else sol.report.unkept_from
        assert abs(found - crossing) < 0.1


def test_jax_arrays_notice_what_numpy_notices() -> None:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True):
        starts = jax.numpy.array([AWAY, CROSSING])
        sol, caught = quietly(FIELD, (0, 2), starts, step=STEP, dt=0.03, engine="jax")
        assert np.asarray(sol.statuses).tolist() == [KEPT, LOST] and len(caught) == 1 and not sol.success
        plain = quietly(FIELD, (0, 2), np.asarray(starts), step=STEP, dt=0.03).sol
        assert sol.message == plain.message and sol.report.near_steps == plain.report.near_steps > 0
        assert abs(sol.report.unkept_from - plain.report.unkept_from) < 1e-12 and sol.report.order == 1


@pytest.mark.slow
def test_one_jax_array_and_traced_ones_have_statuses() -> None:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True):
        starts = jax.numpy.array([AWAY, CROSSING])
        one, none = quietly(FIELD, (0, 2), starts[0], step=STEP, dt=0.03, engine="jax")
        assert one.status == one.statuses == KEPT and one.success and not none
        traced = jax.jit(lambda m: lh.integrate(FIELD, (0, 2), m, step=STEP, dt=0.03, engine="jax").statuses)
        assert np.asarray(traced(starts)).tolist() == [KEPT, LOST]


def test_an_ensemble_in_chunks_warns_once_for_all() -> None:
    starts = np.array([AWAY, CROSSING, AWAY, CROSSING])
    whole = quietly(FIELD, (0, 2), starts, step=STEP, dt=0.05).sol
    for executor in (None, ThreadPoolExecutor(2)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            made = lh.integrate_ensemble(FIELD, (0, 2), starts, executor=executor, chunk=1, step=STEP, dt=0.05)
        # of the order, and of the run that failed
        assert sorted(w.category.__name__ for w in caught) == ["OrderWarning", "RuntimeWarning"]
        assert {w.filename for w in caught} == {__file__}
        assert made.statuses.tolist() == whole.statuses.tolist() and made.message == whole.message
        assert made.report == whole.report


def test_a_resumed_run_knows_what_was_noticed_before(tmp_path: Path) -> None:
    class Interrupted(Exception):
        pass

    left = [10**9]

    def psi(m: Any) -> Any:
        left[0] -= 1
        if left[0] < 0:
            raise Interrupted
        return FIELD.psi(m)

    field = lh.GeneratorField(HYPERBOLOID, psi)
    whole, _ = quietly(field, (0, 2), CROSSING, step=STEP, dt=0.0125)
    path = tmp_path / "run.npz"
    left[0] = 10**9
    quietly(field, (0, 2), CROSSING, step=STEP, dt=0.0125, checkpoint=path)
    left[0] = int(0.9 * (10**9 - left[0]))
    with pytest.raises(Interrupted):
        lh.integrate(field, (0, 2), CROSSING, step=STEP, dt=0.0125, checkpoint=path)
    assert path.exists()
    left[0] = 10**9
    sol, caught = quietly(field, (0, 2), CROSSING, step=STEP, dt=0.0125, checkpoint=path)
    assert (sol.status, sol.message, sol.report) == (whole.status, whole.message, whole.report) and len(caught) == 1
    assert sol.status == LOST and not path.exists()


def test_an_event_after_the_cone_does_not_hide_it() -> None:
    def late(t: Any, y: Any) -> Any:
        return t - 1.9

    late.terminal = True  # type: ignore[attr-defined]
    sol, caught = quietly(FIELD, (0, 2), CROSSING, step=STEP, dt=0.0125, events=late)
    assert sol.status == LOST and sol.message.startswith("A termination event occurred, but order 4") and caught


def test_a_stopped_run_says_up_to_where_it_was_checked() -> None:
    sol, caught = quietly(FIELD, (0, 2), AWAY, step=STEP, dt=0.1, max_steps=7)
    assert sol.status == STOPPED and not caught and sol.report.stopped_at == sol.t[-1]
    assert f"range condition: holds up to t = {sol.t[-1]:.6g}, where the run stopped" in str(sol.report)


def test_the_warning_is_found_again_in_a_pickle() -> None:
    after = pickle.loads(pickle.dumps(lh.OrderWarning("text", 3, 0.5)))
    assert (type(after), str(after), after.order, after.time) == (lh.OrderWarning, "text", 3, 0.5)


@given(*[st.floats(-1e9, 1e9)] * 2, *[st.floats(0, 1)] * 2)
def test_earlier_times_have_larger_numbers(start: float, end: float, a: float, b: float) -> None:
    before, after = (start + x * (end - start) for x in sorted((a, b)))
    numbers = [earliness(np.array(time), bounds_of((start, end))) for time in (before, after)]
    assert numbers[0] >= numbers[1] > 0
    for time, number in zip((before, after), numbers, strict=True):
        assert abs(time_of(number, (start, end)) - time) <= 1e-15 * (abs(start) + abs(end) + 1)


# -- no silent failure ---------------------------------------------------------------------------------------
SIZES = np.array([1 / 25, 1 / 50, 1 / 100])
FINER = np.array([1 / 200, 1 / 400, 1 / 800])


def suspicious(field: lh.GeneratorField, starts: Any, sizes: Any) -> tuple[Any, Any]:
    """Masks: trajectories that neither reach order 4 to 0.3 on the last halving nor say so; those that say so."""
    # fixed sizes are not enough for trajectories that grow: the error of the reference was taken for that of the step
    reference = quietly(field, (0, 1), starts, step=lh.Taylor(16), rtol=1e-13, atol=0, t_eval=[1.0]).sol
    points = np.broadcast_to(starts, (len(sizes), *starts.shape))
    sol, _ = quietly(field, (0, 1), points, step=STEP, dt=sizes[:, None], t_eval=[1.0])
    errors = np.linalg.norm(sol.y[..., 0] - reference.y[..., 0], axis=-1) / np.linalg.norm(starts, axis=-1)
    said = (sol.statuses != KEPT).any(axis=0) | (reference.statuses != KEPT)
    return ~said & (np.log2(errors[-2] / errors[-1]) < 3.7) & (errors[-1] > 1e-11), said


def test_a_family_of_points_that_approaches_the_cone_has_no_silent_failure() -> None:
    """One field, and initial points all around the neck of the hyperboloid: some paths cross the cone, most do not."""
    angle = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    starts = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    left, said = suspicious(FIELD, starts, SIZES)
    assert 2 <= said.sum() <= 6
    if left.any():
        assert not suspicious(FIELD, starts[left], FINER)[0].any()


@given(st.integers(0, 10**6), st.sampled_from(["so(2,1)", "so(3,1)", "sl(2)", "gl(2)", "sp(4,R)"]))
@settings(max_examples=examples(20), deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@example(276, "sl(2)")  # the path ends on the cone
@example(3774, "sl(2)")  # a trajectory that grows sixteenfold has its order from dt = 1/400 on
def test_no_random_problem_fails_silently(seed: int, name: str) -> None:
    rho = lh.defining(name)
    starts = np.random.default_rng(seed + 1).normal(size=(8, rho.size))
    rng = np.random.default_rng(seed)
    linear = 0.4 * rng.normal(size=(8, rho.algebra.dimension, rho.size))
    constant = 0.5 * rng.normal(size=(8, rho.algebra.dimension))

    def field(some: Any) -> lh.GeneratorField:
        return lh.GeneratorField(rho, lambda m: np.einsum("bai,...bi->...ba", linear[some], m) + constant[some])

    left, _ = suspicious(field(slice(None)), starts, SIZES)
    if left.any():
        assert not suspicious(field(left), starts[left], FINER)[0].any()


# -- orbits on which isotropy does not reach the tangent space ------------------------------------------------
TOP = lh.hamiltonian_field(
    lh.euclidean(3), lambda m: m[..., 0] ** 2 / 2 + m[..., 1] ** 2 / 4 + m[..., 2] ** 2 / 6 + m[..., 5], sign=-1
)
UPRIGHT = np.array([0.5, 0.2, 1.0, 0.0, 0.6, 0.8])


@pytest.mark.parametrize("start", [UPRIGHT, np.array([UPRIGHT, UPRIGHT + 0.1])], ids=["one", "ensemble"])
def test_the_heavy_top_says_without_a_printed_report_that_the_order_is_not_reached(start: Any) -> None:
    found = quietly(TOP, (0, 1), start, step=STEP, dt=0.05)
    assert found.sol.status == LOST and len(found.caught) == 1
    message = str(found.caught[0].message)
    assert "did not keep its order 4 from t = 0" in message and "LieTaylor(4) needs no range condition" in message
    assert "dt" not in message
    assert not quietly(TOP, (0, 1), start, step=lh.LieTaylor(4), dt=0.05).caught


WITHOUT_RANGE: dict[str, tuple[Any, Any, str]] = {
    "rigid motions": (lambda: TOP.representation, UPRIGHT, "3 of the 4"),
    "flags": (lambda: lh.adjoint(lh.su(3)), [0.3, -0.2, 0.5, 0.4, -0.1, 0.2, 0.6, 0.3], "3 of the 6"),
    "three eigenvalues": (lambda: lh.sym_conjugation(3), [1.0, 0.2, 0.1, 2.0, 0.3, 3.0], "1 of the 3"),
    # 4 directions of isotropy and the clock, but no velocity at which they are independent
    "Grassmannian": (lambda: lh.defining(lh.so(4)).exterior_power(2), [1.0, 0, 0, 0, 0, 0], "3 of the 4"),
}


@pytest.mark.parametrize("engine", ["auto", "numpy", "llvm", "jax"])
@pytest.mark.parametrize("name", list(WITHOUT_RANGE))
def test_sizes_by_a_tolerance_are_refused_where_isotropy_reaches_no_order(name: str, engine: str) -> None:
    """No order above that of the base can be reached there: the tolerance would take the steps of Euler's method."""
    made, start, reached = WITHOUT_RANGE[name]
    pytest.importorskip({"llvm": "llvmlite", "auto": "numpy"}.get(engine, engine))
    field = lh.GeneratorField(made(), lambda m: m[..., :1] * np.ones(made().algebra.dimension) + 0.3)
    for step in (STEP, lh.Corrected(lh.Heun(), 3), lh.Conserving(STEP, "m0")):
        with pytest.raises(lh.InputError, match=f"{reached} dimensions .* LieTaylor"):
            lh.integrate(field, (0, 1), start, step=step, engine=engine)
    looked = lh.Propagator(field, STEP).inspect(start)  # which makes no step
    assert looked.rank < looked.orbit_dimension
    assert lh.integrate(field, (0, 0.1), start, step=lh.Corrected(lh.LieTaylor(4), 3), engine=engine).success


def test_the_trajectory_whose_orbit_is_refused_is_named() -> None:
    field = lh.GeneratorField(two_spheres(), lambda m: m @ np.ones((8, 6)) + 0.3)
    for count in (60, 5000):
        with pytest.raises(lh.InputError, match=rf"of trajectory {count}: .* whatever the velocity"):
            lh.integrate(field, (0, 1), points_on_two_spheres(count), step=STEP)


def test_points_with_a_cone_are_not_refused() -> None:
    for name in ("so(2,1)", "so(3,1)", "sl(2)", "gl(2)", "sp(4,R)"):
        rho = lh.defining(name)
        starts = np.vstack([np.random.default_rng(3).normal(size=(60, rho.size)), np.eye(rho.size)])
        check_adaptive(STEP, lh.Action(rho), starts, rho.orbit_dimension(starts[0].tolist()))


def test_a_step_at_nominal_time_says_that_its_order_is_not_reached() -> None:
    from liehom.studies.rigid_body_updates import NominalTimeCorrected

    step = NominalTimeCorrected(lh.LieTaylor(2), 4)
    found = quietly(TOP, (0, 1), UPRIGHT, step=step, dt=0.1)
    assert found.sol.status == LOST and len(found.caught) == 1 and found.sol.report.order == 2
    body = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    kept = quietly(body, (0, 1), UPRIGHT[3:], step=step, dt=0.1)
    assert kept.sol.status == KEPT and not kept.caught and kept.sol.report.order == 4
