"""When something fails: which trajectory, with what message, and what there is of the solution; the others go on."""

import warnings
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, SeriesError
from liehom.flow.run.run import Run

pytestmark = pytest.mark.filterwarnings("ignore:status -1")  # runs that fail say so by a warning too

RHO = lh.defining(lh.so(3))
MANY = np.array([[0.6, 0.0, 0.8], [0.36, 0.48, 0.8], [0.48, 0.64, 0.6], [0.8, 0.6, 0.0]])
SECOND = np.array([0.0, 1.0, 0.0, 0.0])
STEPS = [
    lh.LieTaylor(4), lh.Corrected(lh.Euler(), 4), lh.Heun(), lh.RKMK("rk4"), lh.RKMK("rk45"), lh.BackwardEuler(),
    lh.Corrected(lh.Heun(), 3), lh.RKMK("gauss2"),
]  # fmt: skip
ADAPTIVE = {"rtol": 1e-3, "atol": 1e-4}
# without an estimate of its own rk4 is adapted by expansions, as Heun is, and slower
KINDS = [(s, {"dt": 0.1}) for s in STEPS] + [(s, ADAPTIVE) for s in STEPS if s != lh.RKMK("rk4")]


def singular(share: Any) -> lh.GeneratorField:
    """psi has a pole at t = 0.55 where share = 1, and is no number after it."""

    def psi(m: Any, t: Any) -> Any:
        return m * [1.0, 2.0, 3.0] / np.sqrt(share * (0.55 - t) + (1 - share))[..., None]

    return lh.GeneratorField(RHO, psi)


@pytest.mark.parametrize(("step", "kind"), KINDS, ids=str)
def test_a_psi_that_ends_ends_the_run(step: Any, kind: Any) -> None:
    sol = lh.integrate(singular(1.0), (0, 1), MANY[0], step=step, dense_output=True, **kind)
    assert sol.status == sol.statuses == -1 and not sol.success
    assert "At t = 0." in sol.message and 0.4 < sol.t[-1] < 0.65
    assert np.isfinite(sol.y).all() and np.abs((sol.y**2).sum(axis=0) - 1).max() < 1e-13
    assert np.array_equal(sol.sol(sol.t), sol.y)


@pytest.mark.parametrize(("step", "kind"), KINDS, ids=str)
def test_the_other_trajectories_go_on(step: Any, kind: Any) -> None:
    times = [0.2, 0.35, 1.0]
    options: dict[str, Any] = {"step": step, "t_eval": times, "dense_output": True, **kind}
    sol = lh.integrate(singular(SECOND), (0, 1), MANY, events=lambda t, y: y[..., 0] - 0.1, **options)
    free = lh.integrate(singular(0 * SECOND), (0, 1), MANY, **options)
    assert sol.status == -1 and sol.statuses.tolist() == [0, -1, 0, 0]
    assert "trajectory 1" in sol.message and "1 of 4 failed" in sol.message
    assert np.isfinite(sol.y).all(axis=1).tolist() == [[True] * 3, [True, True, False], [True] * 3, [True] * 3]
    others = [0, 2, 3]
    assert np.abs(sol.y[others] - free.y[others]).max() < 0.02
    if "dt" in kind:
        assert np.array_equal(sol.n_steps[others], free.n_steps[others])
        assert np.abs(sol.y[others] - free.y[others]).max() < 1e-11
    assert sol.sol.t_max[others].tolist() == [1.0] * 3 and sol.sol.t_max[1] < 0.65
    assert np.isfinite(sol.sol(np.linspace(0, 1, 5))[others]).all()


def test_the_first_that_failed_is_named_by_its_index() -> None:
    share = np.zeros((2, 2))
    share[1, 0] = share[1, 1] = 1
    sol = lh.integrate(singular(share), (0, 1), MANY.reshape(2, 2, 3), step=lh.RKMK("rk4"), dt=0.1)
    assert "trajectory (1, 0); 2 of 4 failed" in sol.message and sol.statuses.tolist() == [[0, 0], [-1, -1]]


def test_all_may_fail() -> None:
    sol = lh.integrate(singular(np.ones(4)), (0, 1), MANY, step=lh.LieTaylor(3), dt=0.1)
    assert "4 of 4" in sol.message and (sol.statuses == -1).all() and np.isfinite(sol.y).any()


@pytest.mark.parametrize("step", STEPS, ids=repr)
@pytest.mark.parametrize("kind", [{"dt": 0.1}, {}], ids=str)
def test_a_huge_psi(step: Any, kind: Any) -> None:
    field = lh.GeneratorField(RHO, lambda m: 1e200 * m * [1.0, 2.0, 3.0])
    sol = lh.integrate(field, (0, 1), MANY[0], step=step, max_steps=10, **kind)
    assert sol.status == -1 and sol.y.shape[1] <= 11 and np.isfinite(sol.y).all() and sol.message


def test_a_clock_that_does_not_run() -> None:
    field = lh.GeneratorField(RHO, lambda m: m * [1.0, 2.0, 3.0] + 0.3)
    sol = lh.integrate(field, (0, 1000), MANY[0], step=lh.Corrected(lh.Euler(), 6), dt=20.0)
    assert sol.status == -1 and "clock" in sol.message and "smaller dt" in sol.message and sol.n_steps == 0
    assert lh.integrate(field, (0, 5), MANY[0], step=lh.Corrected(lh.Euler(), 6), dt=20.0, clock="nominal").success
    assert lh.integrate(field, (0, 5), MANY[0], step=lh.Corrected(lh.Euler(), 6), max_step=20.0, rtol=1e-2).success
    # only where it does not run
    sizes = [0.1, 20.0, 0.1, 0.1]
    sol = lh.integrate(field, (0, 25), MANY, step=lh.Corrected(lh.Euler(), 3), dt=sizes)
    assert sol.statuses.tolist() == [0, -1, 0, 0] and "trajectory 1" in sol.message


def test_an_implicit_step_that_is_too_large() -> None:
    field = lh.GeneratorField(RHO, lambda m: 3000 * m * [1.0, 2.0, 3.0])
    sol = lh.integrate(field, (0, 1), MANY[0], step=lh.BackwardEuler(), dt=0.5)
    assert sol.status == -1 and "implicit" in sol.message and sol.n_steps == 0
    sol = lh.integrate(field, (0, 0.1), MANY[0], step=lh.BackwardEuler(), rtol=0.1, atol=0.1)
    assert sol.success  # smaller steps are taken
    sizes = [1e-4, 0.5, 1e-4, 2e-4]
    sol = lh.integrate(field, (0, 0.002), MANY, step=lh.BackwardEuler(), dt=sizes)
    assert sol.success  # the end is nearer than 0.5
    sol = lh.integrate(field, (0, 1), MANY, step=lh.BackwardEuler(), dt=sizes, max_steps=9)
    assert sol.statuses.tolist() == [-1] * 4 and sol.n_steps.tolist() == [9, 0, 9, 9]


def test_too_many_steps() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    sol = lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.1, max_steps=7)
    assert sol.status == -1 and "max_steps" in sol.message and sol.n_steps == 7 and sol.t.shape == (8,)
    assert lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.1, max_steps=10).success
    assert lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.1, max_steps=np.inf).success
    sol = lh.integrate(field, (0, 1), np.tile([1.0, 0.0], (3, 1)), dt=[0.1, 0.5, 0.05], max_steps=10)
    assert sol.statuses.tolist() == [0, 0, -1]


def test_errors_of_psi_reach_the_user() -> None:
    def psi(m: Any, t: Any) -> Any:
        if float(np.asarray(t).max()) > 0.5:
            raise ZeroDivisionError("mine")
        return m * 1.0

    field = lh.GeneratorField(RHO, psi)
    with pytest.raises(ZeroDivisionError, match="mine"):
        lh.integrate(field, (0, 1), MANY[0], step=lh.RKMK("rk4"), dt=0.1)

    def singular_matrix(m: Any, t: Any) -> Any:
        return m + (np.linalg.inv(np.zeros((3, 3))) if np.min(t) > 0.5 else 0.0)

    with pytest.raises(np.linalg.LinAlgError, match="Singular"):
        lh.integrate(lh.GeneratorField(RHO, singular_matrix), (0, 1), MANY[0], step=lh.RKMK("rk4"), dt=0.1)


@pytest.mark.parametrize("options", [{}, {"dt": 0.1}, {"rtol": 1e-3}])
def test_a_psi_that_cannot_be_expanded_is_integrated_by_a_runge_kutta_step(options: dict[str, Any]) -> None:
    field = lh.GeneratorField(RHO, lambda m: np.where(m > 0.5, m, 0.0))
    with pytest.raises(SeriesError):
        lh.integrate(field, (0, 1), MANY[0], step=lh.LieTaylor(4), **options)
    named, sol = (lh.integrate(field, (0, 1), MANY[0], step=step, **options) for step in ("dop853", None))
    np.testing.assert_array_equal(sol.y, named.y)
    assert sol.report.step == named.report.step


def test_numpy_warnings_stay_the_users_own() -> None:
    before = np.geterr()
    lh.integrate(singular(1.0), (0, 1), MANY[0], step=lh.LieTaylor(4), dt=0.1)
    assert np.geterr() == before


def test_steps_and_failures_are_logged_at_level_debug(caplog: pytest.LogCaptureFixture) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    options: dict[str, Any] = {"step": lh.RKMK("rk45"), "max_steps": 3}
    quiet = lh.integrate(field, (0, 50), [0.6, 0.0, 0.8], **options)
    assert not caplog.records
    with caplog.at_level("DEBUG", logger="liehom.flow.propagation"):
        logged = lh.integrate(field, (0, 50), [0.6, 0.0, 0.8], **options)
    assert np.array_equal(quiet.y, logged.y)
    assert [record.getMessage().split(",")[0] for record in caplog.records[:1]] == ["step: 1 accepted"]
    assert "1 trajectories fail" in caplog.records[-1].getMessage()


def test_linear_algebra_that_fails_blames_psi_only_if_a_derivative_is_not_finite(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def failing(*given: Any) -> Any:
        raise np.linalg.LinAlgError("SVD did not converge")

    monkeypatch.setattr(Run, "_proposed", failing)
    field = lh.GeneratorField(RHO, ["sqrt(m1)", "1", "m0"])
    smooth, at_the_root = [0.6, 0.8, 0.0], [1.0, 0.0, 0.0]
    assert "psi" in lh.integrate(field, (0, 1), at_the_root, step=lh.LieTaylor(2), dt=0.1).message
    assert "linear algebra" in lh.integrate(field, (0, 1), smooth, step=lh.LieTaylor(2), dt=0.1).message


def test_a_run_that_fails_warns_once_whoever_makes_it() -> None:
    field, message = singular(1.0), r"^status -1: "
    how: dict[str, Any] = {"dt": 0.1}
    propagator = lh.Propagator(field, lh.RKMK("rk4"))
    for call in (
        lambda: lh.integrate(field, (0, 1), MANY[0], step="rk4", **how),
        lambda: propagator((0, 1), MANY[0], **how),
        lambda: propagator((0, 1), MANY[0], **how),
        lambda: lh.integrate_ensemble(field, (0, 1), MANY, chunk=2, step="rk4", **how),
    ):
        with pytest.warns(RuntimeWarning, match=message) as caught:
            sol = call()
        assert not sol.success and len(caught) == 1 and caught[0].filename == __file__
        assert str(caught[0].message) == f"status -1: {sol.message}"


# -- points of any size ---------------------------------------------------------------------------------------
SIZED_STEPS = [None, "rk45", "rk4", lh.Corrected(lh.Euler(), 3)]
EXPONENTS = np.array([-300, -160, -145, -137, -100, -60, 0, 60, 100, 137, 145, 160, 300])


def sized(rho: lh.Representation) -> lh.GeneratorField:
    """A generator psi(m / args), so that the multiples of a point by args move alike."""
    rng = np.random.default_rng(3)
    constant, linear = rng.normal(size=rho.algebra.dimension), 0.5 * rng.normal(size=(rho.size, rho.algebra.dimension))
    return lh.GeneratorField(rho, lambda m, args: constant + (m / args) @ linear)


@pytest.mark.parametrize("engine", ["numpy", "llvm", pytest.param("jax", marks=pytest.mark.slow)])
@pytest.mark.parametrize("step", SIZED_STEPS, ids=repr)
def test_points_of_any_size_end_right_or_are_refused(step: Any, engine: str) -> None:
    """Squares of coordinates overflow above 1e154: such a point seemed fixed by the group, and ended where it began."""
    pytest.importorskip("llvmlite" if engine == "llvm" else "numpy")
    field = sized(lh.defining(lh.so(3)))
    how: dict[str, Any] = {"step": step, "engine": engine, "t_eval": [1.0]}
    how |= {"dt": 0.05} if step == "rk4" or isinstance(step, lh.Corrected) else {"atol": 0.0}
    point = np.array([0.6, -0.3, 0.7])
    for exponent in EXPONENTS[abs(EXPONENTS) > 138]:
        with pytest.raises(InputError, match=rf"the largest coordinate 7e\{exponent - 1:+d}.*take other units"):
            lh.integrate(field, (0, 1), 10.0**exponent * point, args=1.0, **how)
    sizes = 10.0 ** EXPONENTS[abs(EXPONENTS) < 138, None]
    sol = lh.integrate(field, (0, 1), sizes * point, args=lh.PerTrajectory(sizes), **how)
    ends = sol.y[..., 0] / sizes
    # powers of sizes by the tolerance 1e-6 depend on digits of the point, to some per mille
    least = 1e-12 if step is not None else 1e-8
    assert sol.success and np.abs(ends - ends[3]).max() < least and np.abs(ends[3] - point).max() > 0.1


@pytest.mark.parametrize("rate", [60.0, -60.0])
@pytest.mark.parametrize("engine", ["numpy", "llvm", pytest.param("jax", marks=pytest.mark.slow)])
def test_points_that_leave_the_range_of_floats_do_not_end_in_success(engine: str, rate: float) -> None:
    rho = lh.Representation.from_matrices([[[0, -1], [1, 0]], [[1, 0], [0, 1]]])
    starts = 10.0 ** (np.sign(rate) * np.array([[0], [100], [120], [130], [137]])) * [1.0, 2.0]
    step: Any
    for step in (None, "rk45"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            sol = lh.integrate(lh.GeneratorField(rho, [1, rate]), (0, 1), starts, step=step, atol=0, engine=engine)
        turn = np.array([[np.cos(1), np.sin(1)], [-np.sin(1), np.cos(1)]])
        errors = np.abs(sol.y[np.arange(5), :, sol.n_steps] / (starts @ turn * np.exp(rate)) - 1).max(axis=-1)
        assert (sol.statuses[:2] == 0).all() and (errors[sol.statuses == 0] < 1e-4).all()


def test_floats_of_32_bits_have_a_range_of_their_own() -> None:
    jax = pytest.importorskip("jax")
    field = sized(lh.defining(lh.so(3)))
    with pytest.raises(InputError, match=r"coordinate 1e\+15, expected 0 or a number from 9.1e-13 to 2.2e\+12"):
        lh.integrate(field, (0, 1), jax.numpy.array([1e15, 0, 0], "float32"), args=1.0, dt=0.1, engine="jax")
