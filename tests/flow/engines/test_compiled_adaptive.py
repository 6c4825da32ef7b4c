"""Compiled steps with adapted sizes against numpy: times, points, steps, calls; ensembles, ends, refusals."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.engines import lanes as kernel_lanes
from liehom.flow.engines.lanes import HandBack
from liehom.flow.run.options import Progress
from liehom.flow.tracing.graph import needed
from tests.flow.engines.test_compiled import BODY, START, a_field, both, cache, sphere
from tests.flow.propagation import spaces

__all__ = ["cache"]

EPS = float(np.finfo(float).eps)
ULPS = 256
"""How far points at the same times, and times of sizes by defects, may be apart; measured are up to 40."""
PAIRED = 1e-6
"""How far times between steps of embedded pairs may be apart: estimates of errors are noisy. Measured are 2e-8."""
SPEEDS = np.linspace(0.3, 6.0, 17)[:, None]
STEPS = {
    "Heun pair": lh.RKMK("heun"), "RK45": lh.RKMK("rk45"), "DOP853": lh.RKMK("dop853"), "RK4": lh.RKMK("rk4"),
    "Taylor 4": lh.LieTaylor(4), "Euler to 4": lh.Corrected(lh.Euler(), 4), "Heun to 3": lh.Corrected(lh.Heun(), 3),
    "default": None,
}  # fmt: skip


def assert_same(plain: Any, made: Any, times: float = ULPS * EPS) -> None:
    """The same steps, of sizes the same to `times`."""
    assert made.y.shape == plain.y.shape and made.t.shape == plain.t.shape
    np.testing.assert_array_equal(np.isnan(made.y), np.isnan(plain.y))
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_array_equal(made.statuses, plain.statuses)
    size, span = float(np.nanmax(np.abs(plain.y))), max(1.0, float(np.nanmax(np.abs(plain.t))))
    np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=times * span)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=4 * max(times, ULPS * EPS) * size)
    ours, theirs = made.report, plain.report
    assert (made.message, ours.order, ours.failed_steps, ours.equilibria) == (
        plain.message, theirs.order, theirs.failed_steps, theirs.equilibria,
    )  # fmt: skip


# -- every space, every rule ---------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "step"),
    [("S^4", "Taylor 4"), ("Sym(3) at (1,1,2)", "Heun to 3"), ("Sym(3) at (1,2,3)", "RK4"), ("H^3", "Euler to 4")],
)
def test_sizes_from_defects_agree_to_round_off(name: str, step: str) -> None:
    space = spaces.make(name)
    plain, made = both(a_field(name, space), (0, 1), space.starts[:3], step=STEPS[step], rtol=1e-7, atol=1e-9)
    assert_same(plain, made)
    assert made.nfev == plain.nfev and np.min(made.n_steps) > 3


@pytest.mark.parametrize(
    ("name", "step"), [("S^4", "RK45"), ("Sym(3) at (1,2,3)", "RK45"), ("CP^2", "Heun pair"), ("H^3", "DOP853")]
)
def test_embedded_pairs_agree_as_well_as_their_estimates(name: str, step: str) -> None:
    space, times = spaces.make(name), [0.0, 0.31, 1.0]
    options: dict[str, Any] = {"step": STEPS[step], "rtol": 1e-6, "atol": 1e-8}
    assert_same(*both(a_field(name, space), (0, 1), space.starts[:3], **options), times=PAIRED)
    plain, made = both(a_field(name, space), (0, 1), space.starts[:3], t_eval=times, **options)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-12 * float(np.abs(plain.y).max()))
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::liehom.OrderWarning")  # without isotropy nothing is corrected
@pytest.mark.parametrize("clock", ["corrected", "nominal"])
@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("name", ["S^2", "S^4", "Sym(3) at (1,1,2)", "Sym(3) at (1,2,3)", "CP^2", "two coupled spins"])
def test_every_space_and_step_agree(name: str, step: str, clock: str) -> None:
    space = spaces.make(name)
    found = both(a_field(name, space), (0, 1), space.starts, step=STEPS[step], clock=clock, rtol=1e-7, atol=1e-9)
    # after a thousand steps, defects being differences too: measured are 5e-13
    assert_same(*found, times=PAIRED if step in ("Heun pair", "RK45", "DOP853") else 1e-11)


ENERGY = "m0**2/2 + m1**2/4 + m2**2/8"
SOLVING = {
    "backward Euler": lh.BackwardEuler(), "Gauss": lh.RKMK("gauss2"),
    "conserving pair": lh.Conserving(lh.RKMK("heun"), ENERGY), "conserving": lh.Conserving(lh.LieTaylor(2), ENERGY),
    "conserving with a clock": lh.Conserving(lh.Corrected(lh.Euler(), 3), ENERGY),
}  # fmt: skip


@pytest.mark.parametrize("step", SOLVING)
def test_steps_that_solve_equations_agree(step: str) -> None:
    plain, made = both(BODY, (0, 2), sphere(3) * [[0.5], [1.0], [2.0]], step=SOLVING[step], rtol=1e-4, atol=1e-4)
    assert_same(plain, made, times=PAIRED if "pair" in step else ULPS * EPS)
    if "conserving" in step:
        assert made.nfev == plain.nfev
    else:  # as many as in the first step
        assert plain.nfev / 3 < made.nfev < 3 * plain.nfev


# -- ensembles -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("step", ["Euler to 4", "RK45"])
def test_every_lane_has_its_own_sizes_and_any_number_of_lanes_will_do(step: str) -> None:
    """Bodies of different speeds; one lane alone, blocks that are not full, and an ensemble of two axes."""
    starts = sphere(17) * SPEEDS
    for y0 in (starts[0], starts[4:5], starts[:3], starts, np.tile(starts, (2, 1, 1))):
        plain, made = both(BODY, (0, 2), y0, step=STEPS[step])
        assert_same(plain, made, times=PAIRED if step == "RK45" else ULPS * EPS)
    assert np.ptp(made.n_steps) > 10


@pytest.mark.parametrize("clock", ["corrected", "nominal"])
def test_backwards(clock: str) -> None:
    plain, made = both(BODY, (2, -1), sphere(5), step=lh.Corrected(lh.Heun(), 3), clock=clock)
    assert_same(plain, made)
    assert (np.nan_to_num(np.diff(made.t, axis=-1)) <= 0).all()
    assert_same(*both(BODY, (2, -1), sphere(5), step=STEPS["RK45"], clock=clock), times=PAIRED)


def test_orbits_of_several_dimensions_in_one_ensemble() -> None:
    rho = lh.sym_conjugation(3)
    starts = np.array([[1.0, 0, 0, 1.0, 0, 2.0], [1.0, 0, 0, 2.0, 0, 3.0], [3.0, 0, 0, 1.0, 0, 1.0]])
    field = lh.GeneratorField(rho, lambda m: 0.2 * m[..., [1, 2, 4]] + [0.1, 0.3, -0.2])
    assert_same(*both(field, (0, 4), starts, step=STEPS["RK4"]))
    assert_same(*both(field, (0, 4), starts, step=STEPS["RK45"]), times=PAIRED)


def test_equilibria_take_ever_larger_steps() -> None:
    starts = np.array([[1.0, 0, 0], [0.0, 1.0, 0], [0.6, 0, 0.8]])
    for step in ("Taylor 4", "RK45"):
        plain, made = both(BODY, (0, 80), starts, step=STEPS[step])
        np.testing.assert_array_equal(made.n_steps, plain.n_steps)
        assert made.n_steps[0] < made.n_steps[2] / 3


# -- rejected steps --------------------------------------------------------------------------------------------
PULSE = lh.GeneratorField(lh.adjoint(lh.so(3)), ["1/10 + 20*exp(-200*(t - 1)**2)", "m0/5", "1/10"])


def attempts(solution: Any) -> int:
    """Of a step of 7 stages, with the one call of psi for the first size."""
    return (solution.nfev - 1) // 7


@pytest.mark.parametrize("backend", ["llvm", "jax"])
def test_rejected_steps_leave_no_trace_but_calls(backend: str) -> None:
    pytest.importorskip({"llvm": "llvmlite"}.get(backend, backend))
    plain, made = both(PULSE, (0, 3), START, engine=backend, step=STEPS["RK45"], dense_output=True)
    assert attempts(plain) >= plain.n_steps + 4  # else this tests nothing
    assert_same(plain, made, times=PAIRED)
    assert made.nfev == plain.nfev
    s = np.linspace(0, 3, 40)
    np.testing.assert_allclose(made.sol(s), plain.sol(s), rtol=0, atol=1e-10)


def test_rejections_of_some_lanes_do_not_hold_others_up() -> None:
    starts = sphere(17) * SPEEDS
    rough = lh.GeneratorField(
        lh.adjoint(lh.so(3)), lambda m, t: -m * [1.0, 0.5, 0.25] * (1 + 9 * np.exp(-80 * (t - 1) ** 2))[..., None]
    )
    plain, made = both(rough, (0, 2), starts, step=STEPS["RK45"], dense_output=True)
    assert_same(plain, made, times=PAIRED)
    np.testing.assert_allclose(made.sol(1.03), plain.sol(1.03), rtol=0, atol=1e-9)
    steps = made.n_steps
    assert all(
        np.isfinite(made.t[i, : steps[i] + 1]).all() and np.isnan(made.t[i, steps[i] + 1 :]).all() for i in (0, 9)
    )
    assert (np.nan_to_num(np.diff(made.t, axis=-1), nan=1.0) > 0).all()


# -- options ---------------------------------------------------------------------------------------------------
def test_the_largest_and_the_first_step() -> None:
    for step in ("RK45", "Taylor 4"):
        plain, made = both(BODY, (0, 5), START, step=STEPS[step], max_step=0.07, first_step=1e-5)
        assert_same(plain, made, times=PAIRED)
        assert made.t[1] == 1e-5 and 0.0699 < np.diff(made.t).max() <= 0.07 * (1 + 1e-12)


def test_tolerances_spans_and_bounds_share_machine_code(cache: Path) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: m * [1.0, 0.654321, 0.25])
    before = len(list(cache.iterdir()))
    for span, options in (((0, 2), {"rtol": 1e-4}), ((3, -1), {"rtol": 1e-9, "atol": 1e-7, "max_step": 0.5})):
        assert_same(*both(field, span, START, step=STEPS["Heun to 3"], **options))
    assert len(list(cache.iterdir())) == before + 1


@pytest.mark.filterwarnings("ignore:status -1")
def test_max_steps_ends_a_run_as_without() -> None:
    plain, made = both(BODY, (0, 50), START, step=STEPS["RK45"], max_steps=37)
    assert (made.status, made.message, int(made.n_steps)) == (-1, plain.message, 37)
    plain, made = both(BODY, (0, 20), sphere(5) * SPEEDS[::4], step=STEPS["RK45"], max_steps=40)
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_array_equal(made.statuses, plain.statuses)
    assert sorted(set(made.statuses.tolist())) == [-1, 0] and made.n_steps.max() == 40


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("step", ["RK45", "Taylor 4"])
def test_a_psi_that_ends_ends_a_trajectory_as_without(step: str) -> None:
    ends = lh.GeneratorField(lh.adjoint(lh.so(3)), ["sqrt(9/10 - t)", "m0", "1"])
    plain, made = both(ends, (0, 2), START, step=STEPS[step])
    assert plain.status == made.status == -1
    # the last digit of a time next to the end decides which of the two is met first
    reasons = {
        "psi or one of its derivatives is not finite.",
        "The step size that the tolerance asks for is below round-off.",
    }
    assert {made.message.split(" At ")[0], plain.message.split(" At ")[0]} <= reasons
    assert abs(made.t[-1] - 0.9) < 1e-3 and abs(made.t[-1] - plain.t[-1]) < 1e-6
    part = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: np.sqrt(m[..., :1] + 0.5) * [0.01, 0, 0] + [0, 0.5, 1.0])
    plain, made = both(part, (0, 3), [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.4, -0.8, 0.1]], step=STEPS[step])
    np.testing.assert_array_equal(made.statuses, plain.statuses)
    assert set(made.statuses.tolist()) == {-1, 0}


@pytest.mark.parametrize("within", [False, True], ids=["between", "within"])
@pytest.mark.parametrize("dt", [None, 0.05], ids=["adapted", "fixed"])
def test_an_interrupted_run_goes_on_bit_for_bit(
    dt: float | None, within: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the pauses are in which interruptions are noticed."""
    file, starts = tmp_path / "state.npz", sphere(3)
    options: dict[str, Any] = {"step": STEPS["Heun to 3"], "dt": dt, "engine": "llvm", "t_eval": [7.3, 50.0]}
    whole = lh.integrate(BODY, (0, 50), starts, **options)
    monkeypatch.setattr(kernel_lanes, "OPERATIONS_PER_CALL", 10_000)
    calls: list[int] = []

    def stop(*_: Any) -> None:
        calls.append(1)
        if len(calls) == 8:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        if not within:
            patch.setattr(Progress, "update", stop)
        else:
            real = HandBack.finish
            patch.setattr(HandBack, "finish", lambda state: (real(state), stop()))
        lh.integrate(BODY, (0, 50), starts, checkpoint=file, **options)
    with np.load(file) as kept:
        assert 2 < kept["t"].min() < kept["t"].max() < 45
    again = lh.integrate(BODY, (0, 50), starts, checkpoint=file, **options)
    np.testing.assert_array_equal(again.y, whole.y)
    np.testing.assert_array_equal(again.n_steps, whole.n_steps)
    assert str(again.report) == str(whole.report) and not file.exists()


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_least_step_size_does_not_lengthen_steps() -> None:
    starts = sphere(5) * SPEEDS[::4]
    for options in ({"min_step": 0.5, "max_steps": 200}, {"min_step": 0.01, "t_eval": [1.0, 3.0]}):
        plain, made = both(BODY, (0, 3), starts, step=STEPS["RK45"], **options)
        np.testing.assert_array_equal(made.statuses, plain.statuses)
        np.testing.assert_array_equal(made.n_steps, plain.n_steps)
        np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-9)
    plain = lh.integrate(BODY, (0, 3), START, step=STEPS["RK45"], dt=0.125, min_step=0.5, engine="numpy")
    assert plain.n_steps == 24


# -- JAX, and refusals -----------------------------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.parametrize("step", ["Euler to 4", "RK45"])
def test_jax_agrees(step: str) -> None:
    pytest.importorskip("jax")
    starts = sphere(5) * SPEEDS[::4]
    plain, made = both(BODY, (2, 0), starts, engine="jax", step=STEPS[step], t_eval=[2.0, 0.7, 0.0])
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    assert np.ptp(made.n_steps) > 10


@pytest.mark.slow
@pytest.mark.parametrize("step", STEPS)
def test_steps_by_jax_agree(step: str) -> None:
    pytest.importorskip("jax")
    times = PAIRED if step in ("Heun pair", "RK45", "DOP853") else ULPS * EPS
    assert_same(*both(BODY, (0, 2), sphere(5) * SPEEDS[::4], engine="jax", step=STEPS[step]), times=times)


def test_what_is_not_compiled_is_refused() -> None:
    jax = pytest.importorskip("jax")
    with pytest.raises(InputError, match="events"):
        lh.integrate(BODY, (0, 1), START, step=STEPS["RK45"], events=lambda t, y: y[0], engine="jax")
    with jax.enable_x64(True), pytest.raises(InputError, match="events"):
        lh.integrate(BODY, (0, 1), jax.numpy.asarray(START), step=STEPS["RK45"], engine="jax", events=lambda t, y: y[0])


def test_sizes_of_taylor_steps_need_no_library_and_few_roots() -> None:
    propagator = lh.Propagator(BODY, lh.Taylor(8), engine="llvm")
    propagator((0, 3), START, rtol=1e-7)
    (graph,) = propagator.engine._store.graphs.values()  # type: ignore[attr-defined]
    ops = Counter(x.op for x in needed(graph.outputs))
    assert graph.sizes is not None and not ops["pow"] + ops["log2"] + ops["exp2"]
    assert ops["sqrt"] <= 2 and ops["div"] <= 1 and ops["coarse_exp2"] <= 1


@pytest.mark.parametrize("rtol", [1e-3, 1e-7])
def test_points_at_output_times_within_steps_are_not_those_of_the_looks(rtol: float) -> None:
    times = np.linspace(0.1, 9.9, 57)
    plain, made = both(BODY, (0, 10), sphere(9) * SPEEDS[:9], step=lh.Taylor(8), rtol=rtol, t_eval=times)
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-12)
