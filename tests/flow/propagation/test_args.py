"""Arguments of psi(m, t, args): the run is that of a psi that closes over them, in every engine and at every door."""

import pickle
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.propagation.ensemble import integrate_ensemble

RHO = lh.adjoint(lh.so(3))
START = np.array([0.6, 0.0, 0.8])
STARTS = np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.8, 0.36, 0.48]])
INERTIA = np.array([1.0, 2.0, 4.0])
INERTIAS = np.array([INERTIA, [1.0, 3.0, 5.0], [2.0, 3.0, 4.5]])
EPS = float(np.finfo(float).eps)


class Drive(NamedTuple):
    size: float
    rate: Any


@dataclass(frozen=True)
class Body:
    inertia: Any
    drive: Drive


def driven(m: Any, t: Any, args: Any) -> Any:
    return -m / args.inertia + np.stack([0 * t, 0 * t, args.drive.size * np.sin(args.drive.rate * t)], axis=-1)


FIELD = lh.GeneratorField(RHO, driven)
ARGS = Body(INERTIA, Drive(0.5, 3.0))


def closed(args: Body) -> lh.GeneratorField:
    return lh.GeneratorField(RHO, lambda m, t: driven(m, t, args))


STEPS: dict[str, lh.Step] = {
    "RK4": lh.RKMK("rk4"), "RK45": lh.RKMK("rk45"), "LieTaylor": lh.LieTaylor(4),
    "Euler to 3": lh.Corrected(lh.Euler(), 3), "backward": lh.BackwardEuler(),
}  # fmt: skip


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-5}], ids=["fixed", "adapted"])
def test_in_numpy_args_are_what_psi_closes_over_bit_for_bit(step: str, options: dict[str, Any]) -> None:
    wanted = lh.integrate(closed(ARGS), (0, 1), STARTS, step=STEPS[step], engine="numpy", **options)
    made = lh.integrate(FIELD, (0, 1), STARTS, step=STEPS[step], args=ARGS, engine="numpy", **options)
    np.testing.assert_array_equal(made.y, wanted.y)
    np.testing.assert_array_equal(made.t, wanted.t)


COMPILED = [("llvm", step) for step in STEPS] + [
    pytest.param("jax", step, marks=() if step == "LieTaylor" else pytest.mark.slow) for step in STEPS
]


@pytest.mark.parametrize(("engine", "step"), COMPILED)
def test_compiled_runs_agree_to_round_off_with_args_that_change(engine: str, step: str) -> None:
    if engine == "jax":
        pytest.importorskip("jax")
    propagator = lh.Propagator(FIELD, STEPS[step], engine=engine)
    for args in (ARGS, Body([1.0, 2.0, 3.0], Drive(0.0, 1)), Body(INERTIA[::-1], Drive(1.5, np.float64(2)))):
        numpy = Body(np.asarray(args.inertia), args.drive)
        wanted = lh.integrate(FIELD, (0, 1), STARTS, step=STEPS[step], args=numpy, dt=0.1).y
        made = propagator((0, 1), STARTS, args=args, dt=0.1).y
        np.testing.assert_allclose(made, wanted, rtol=0, atol=64 * EPS)


@pytest.mark.parametrize("engine", ["numpy", "llvm", pytest.param("jax", marks=pytest.mark.slow)])
@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-6}], ids=["fixed", "adapted"])
def test_slices_per_trajectory_are_single_runs(engine: str, options: dict[str, Any]) -> None:
    if engine == "jax":
        pytest.importorskip("jax")
    args = {"inertia": lh.PerTrajectory(INERTIAS), "gain": lh.PerTrajectory([1.0, 2.0, 3.0]), "shift": 0.25}

    def psi(m: Any, t: Any, args: Any) -> Any:
        return -args["gain"][..., None] * m / args["inertia"] + args["shift"]

    field = lh.GeneratorField(RHO, psi)
    made = lh.integrate(field, (0, 1), STARTS, step=lh.RKMK("rk45"), args=args, t_eval=[1.0], engine=engine, **options)
    for i in range(3):
        alone = {"inertia": INERTIAS[i], "gain": np.float64(i + 1), "shift": 0.25}
        wanted = lh.integrate(field, (0, 1), STARTS[i], step=lh.RKMK("rk45"), args=alone, t_eval=[1.0], **options)
        np.testing.assert_allclose(made.y[i], wanted.y, rtol=0, atol=1e-12)


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
def test_one_initial_point_is_that_of_all_slices(engine: str) -> None:
    for args in (lh.PerTrajectory(INERTIAS), [lh.PerTrajectory(INERTIAS), lh.PerTrajectory([1.0, 2.0, 3.0])]):
        field = lh.GeneratorField(RHO, lambda m, t, args: -m / (args[0] if isinstance(args, list) else args))
        made, wanted = (
            lh.integrate(field, (0, 1), y0, args=args, engine=engine) for y0 in (STARTS[0], STARTS[[0, 0, 0]])
        )
        np.testing.assert_array_equal(made.y, wanted.y)
    with pytest.raises(ShapeError, match=r"args\[0\] has shape \(3,\), args\[1\] has shape \(2,\)"):
        two = [lh.PerTrajectory([1.0, 2.0, 3.0]), lh.PerTrajectory([1.0, 2.0])]
        lh.integrate(lh.GeneratorField(RHO, lambda m, t, args: np.stack(args)), (0, 1), STARTS[0], args=two)


def test_orbits_of_several_dimensions_keep_their_slices() -> None:
    """Compiled lanes are grouped by the dimension of their orbits."""
    rho = lh.Representation.from_matrices([np.array(x, dtype=float) for x in (ROTATE_12, ROTATE_34)])
    field = lh.GeneratorField(rho, lambda m, t, args: np.stack([args[..., 0] * m[..., 0] ** 2, args[..., 1]], axis=-1))
    starts = np.array([[1.0, 0, 0, 0], [1.0, 0, 1, 0], [0.5, 0, 0, 0], [0, 0, 1.0, 0]])
    rates = lh.PerTrajectory(np.arange(1.0, 9.0).reshape(4, 2))
    plain, made = (
        lh.integrate(field, (0, 1), starts, step=lh.RKMK("rk4"), args=rates, dt=0.1, engine=e).y
        for e in ("numpy", "llvm")
    )
    np.testing.assert_allclose(made, plain, rtol=0, atol=64 * EPS)


ROTATE_12 = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
ROTATE_34 = [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, -1], [0, 0, 1, 0]]


# -- JAX -----------------------------------------------------------------------------------------------------
def test_jax_differentiates_by_args() -> None:
    jax = pytest.importorskip("jax")
    propagator = lh.Propagator(FIELD, lh.Euler(), engine="jax")

    def height(args: Any) -> Any:
        return propagator((0, 1), START, args=args, dt=0.25).y[2, -1]

    with jax.enable_x64(True):
        args = Body(jax.numpy.asarray(INERTIA), Drive(0.5, 3.0))
        jax.tree_util.register_dataclass(Body, ["inertia", "drive"], [])
        slope = jax.jit(jax.grad(height))(args)
        h = 1e-6
        for i in range(3):
            up, down = (float(height(Body(INERTIA + s * h * np.eye(3)[i], args.drive))) for s in (1, -1))
            assert abs(float(slope.inertia[i]) - (up - down) / (2 * h)) < 1e-8
        up, down = (float(height(Body(args.inertia, Drive(0.5, 3.0 + s * h)))) for s in (1, -1))
        assert abs(float(slope.drive.rate) - (up - down) / (2 * h)) < 1e-8
        many = jax.vmap(lambda k: height(Body(args.inertia, Drive(k, 3.0))))(jax.numpy.asarray([0.5, 1.0]))
        np.testing.assert_allclose(float(many[0]), float(height(args)), atol=1e-14)
        assert abs(float(many[1] - many[0])) > 1e-3


def test_jax_differentiates_by_slices_per_trajectory() -> None:
    jax = pytest.importorskip("jax")
    field = lh.GeneratorField(RHO, lambda m, t, args: np.sin(args["rate"])[..., None] * np.array([0.0, 0.0, 1.0]))
    propagator = lh.Propagator(field, lh.Euler(), engine="jax")

    def first(args: Any) -> Any:
        return propagator((0, 1), np.tile([1.0, 0.0, 0.0], (2, 1)), args=args, dt=0.5).y[:, 0, -1].sum()

    with jax.enable_x64(True):
        rates = jax.numpy.asarray([0.5, 1.0])
        slope = jax.grad(first)({"rate": lh.PerTrajectory(rates)})["rate"].value
        expected = -np.sin(np.sin(rates)) * np.cos(rates)
        np.testing.assert_allclose(np.asarray(slope), np.asarray(expected), atol=1e-13)


def test_jax_arrays_in_args_are_numpy_arrays_for_other_engines() -> None:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True):
        args = Body(jax.numpy.asarray(INERTIA), Drive(0.5, 3.0))
        for engine in ("numpy", "llvm"):
            made = lh.integrate(FIELD, (0, 1), START, args=args, dt=0.1, engine=engine)
            wanted = lh.integrate(FIELD, (0, 1), START, args=ARGS, dt=0.1, engine=engine)
            np.testing.assert_array_equal(made.y, wanted.y)

        def traced(inertia: Any) -> Any:
            return lh.integrate(FIELD, (0, 1), START, args=Body(inertia, ARGS.drive), dt=0.1).y[0, -1]

        with pytest.raises(InputError, match=r"traces args\.inertia: take engine='jax'"):
            jax.grad(traced)(jax.numpy.asarray(INERTIA))


# -- doors ---------------------------------------------------------------------------------------------------
FORMS: list[Callable[..., Any]] = [
    lambda m, t, args: args * m, lambda m, t, k: k * m, lambda m, args: args * m, lambda m, *, args: args * m,
    lambda m, args, t: args * m, lambda m, *, t, args: args * m, lambda m, t=0.0, args=1.0: args * m,
]  # fmt: skip


@pytest.mark.parametrize("psi", FORMS)
def test_forms_of_psi(psi: Callable[..., Any]) -> None:
    field = lh.GeneratorField(RHO, psi)
    assert field.takes_args and field.args is None
    bound = field.with_args(2.0)
    assert bound.args == 2.0
    np.testing.assert_array_equal(bound.psi(START, 0.5), 2.0 * START)
    np.testing.assert_array_equal(bound.with_args(3.0).psi(START), 3.0 * START)


def test_strings_components_and_functions_without_args_take_none() -> None:
    for source in (
        ["m0", "m1", "m2"], [1.0, 0.0, 0.0], lambda m: m, lambda m, t: m, lambda m, *args: m, lambda m, k=2: m,
    ):  # fmt: skip
        field = lh.GeneratorField(RHO, source)
        assert not field.takes_args
        with pytest.raises(InputError, match="psi takes none"):
            lh.integrate(field, (0, 1), START, args={"k": 1.0})


def test_args_that_are_missing_or_no_numbers_are_named() -> None:
    with pytest.raises(InputError, match="psi takes args, but none were given"):
        lh.integrate(FIELD, (0, 1), START)
    with pytest.raises(InputError, match=r"args\.drive\.rate is 'quick'"):
        lh.integrate(FIELD, (0, 1), START, args=Body(INERTIA, Drive(0.5, "quick")))
    with pytest.raises(ShapeError, match=r"args\.inertia has shape \(2, 3\)"):
        lh.integrate(FIELD, (0, 1), STARTS, args=Body(lh.PerTrajectory(INERTIAS[:2]), Drive(0.5, 1)))


def test_args_of_a_call_come_before_those_of_the_propagator_and_those_of_the_field() -> None:
    def psi(m: Any, t: Any, args: Any) -> Any:
        return args * np.array([0.0, 0.0, 1.0])

    field, ends = lh.GeneratorField(RHO, psi).with_args(1.0), []
    for own, given in ((None, None), (2.0, None), (2.0, 3.0), (None, 3.0)):
        y = lh.Propagator(field, args=own)((0, 1), [1.0, 0.0, 0.0], args=given, dt=0.5).y[:, -1]
        ends.append(round(float(np.arctan2(y[1], y[0])), 12))
    assert ends == [1.0, 2.0, 3.0, 3.0]


def test_a_vector_field_with_args() -> None:
    def turning(m: Any, t: Any, args: Any) -> Any:
        return args["rate"] * np.cross([0.0, 0.0, 1.0], m)

    field = lh.GeneratorField.from_vector_field(RHO, turning)
    assert field.takes_args
    y = lh.integrate(field, (0, 1), [1.0, 0.0, 0.0], args={"rate": 0.75}, dt=0.25).y[:, -1]
    np.testing.assert_allclose(y, [np.cos(0.75), np.sin(0.75), 0.0], atol=1e-14)


def test_ensembles_in_chunks_get_their_rows() -> None:
    args = {"rate": lh.PerTrajectory([1.0, 2.0, 3.0, 4.0, 5.0]), "axis": np.array([0.0, 0.0, 1.0])}
    field = lh.GeneratorField(RHO, lambda m, t, args: args["rate"][..., None] * args["axis"])
    starts = np.tile([1.0, 0.0, 0.0], (5, 1))
    whole = lh.integrate(field, (0, 0.5), starts, args=args, dt=0.1, t_eval=[0.5])
    made = integrate_ensemble(field, (0, 0.5), starts, args=args, dt=0.1, t_eval=[0.5], chunk=2)
    np.testing.assert_allclose(made.y, whole.y, atol=1e-15)
    np.testing.assert_allclose(np.arctan2(made.y[:, 1, -1], made.y[:, 0, -1]), [0.5, 1, 1.5, 2, 2.5], atol=1e-14)
    with pytest.raises(ShapeError, match="rate"):
        integrate_ensemble(field, (0, 0.5), starts[:4], args=args, dt=0.1)


def test_a_store_of_other_args_is_another_problem(tmp_path: Path) -> None:
    field = lh.GeneratorField(RHO, late)
    options: dict[str, Any] = {"step": lh.Euler(), "store": tmp_path / "runs", "dt": 0.25, "chunk": 1}
    integrate_ensemble(field, (0, 1), STARTS, args={"late": 1.0}, **options)
    integrate_ensemble(field, (0, 1), STARTS, args={"late": 1.0}, **options)
    with pytest.raises(InputError, match="another problem"):
        integrate_ensemble(field, (0, 1), STARTS, args={"late": 2.0}, **options)


def late(m: Any, t: Any, args: Any) -> Any:
    """Args that psi does not show at the start nor next to it."""
    return m * np.array([1.0, 2.0, 3.0]) + np.where(t > 0.5, args["late"], 0.0)[..., None]


def test_a_checkpoint_of_other_args_is_another_problem(tmp_path: Path) -> None:
    def stopping(fraction: float) -> None:
        if 0 < fraction < 1:
            raise KeyboardInterrupt

    field, path = lh.GeneratorField(RHO, late), tmp_path / "run.npz"
    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.1, "checkpoint": path}
    with pytest.raises(KeyboardInterrupt):
        lh.integrate(field, (0, 1), START, args={"late": 1.0}, progress=stopping, **options)
    with pytest.raises(InputError, match="another problem"):
        lh.integrate(field, (0, 1), START, args={"late": 2.0}, **options)
    resumed = lh.integrate(field, (0, 1), START, args={"late": 1.0}, **options)
    whole = lh.integrate(field, (0, 1), START, args={"late": 1.0}, step=lh.RKMK("rk4"), dt=0.1)
    np.testing.assert_array_equal(resumed.y, whole.y)


def test_a_field_with_args_is_pickled_with_them() -> None:
    field = pickle.loads(pickle.dumps(lh.GeneratorField(RHO, late).with_args({"late": 3.0})))
    assert field.args == {"late": 3.0}
    np.testing.assert_array_equal(field.psi(START, 1.0), START * [1.0, 2.0, 3.0] + 3.0)


def test_dense_output_and_events_know_the_args() -> None:
    field = lh.GeneratorField(RHO, lambda m, t, args: args["rate"] * np.array([0.0, 0.0, 1.0]))
    sol: Any = lh.integrate(
        field, (0, 2), [1.0, 0.0, 0.0], args={"rate": 1.0}, dt=0.5, dense_output=True, events=lambda t, y: y[0]
    )
    np.testing.assert_allclose(sol.sol(0.3), [np.cos(0.3), np.sin(0.3), 0.0], atol=1e-14)
    np.testing.assert_allclose(sol.t_events[0], [np.pi / 2], atol=1e-14)
