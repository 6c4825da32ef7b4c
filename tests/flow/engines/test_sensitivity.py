"""Derivatives of points by initial points and args: those of the differences, forward and backward."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError, TraceError
from liehom.flow.engines.sensitivity import Sensitivity

RNG = np.random.default_rng(11)
MOMENTS = np.array([1.0, 2.0, 4.0])
TIMES = [0.33, 1.0, 2.0]


def by_differences(function: Callable[[Any], Any], x: Any, h: float = 1e-4) -> Any:
    """Derivatives by the extrapolated central difference, with axes (N, *x, times).

    `function` takes values of x along a first axis, all that are needed at once, and returns (..., N, times).
    """
    x = np.asarray(x, dtype=float)
    e = h * np.eye(x.size).reshape(-1, *x.shape)
    up, down, far_up, far_down = np.split(function(np.concatenate([x + e, x - e, x + 2 * e, x - 2 * e])), 4)
    slopes = (4 * (up - down) / (2 * h) - (far_up - far_down) / (4 * h)) / 3
    slopes = slopes.reshape(*x.shape, *slopes.shape[1:])
    return np.moveaxis(slopes, list(range(x.ndim)), list(range(1, 1 + x.ndim)))


class Case(NamedTuple):
    """A field with args and an initial point."""

    field: lh.GeneratorField
    start: Any
    args: dict[str, Any]


def rigid_body() -> Case:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["moments"])
    return Case(field, np.array([0.6, 0.1, 0.8]), {"moments": MOMENTS})


def controller() -> Case:
    """A linear controller on S^3, whose 24 + 12 numbers enter with and without the time."""
    rng = np.random.default_rng(3)

    def psi(m: Any, t: Any, args: Any) -> Any:
        offset, slow = args["offset"], np.sin(0.5 * t)[..., None]
        return np.einsum("...i,...ia->...a", m, args["gain"]) + offset[..., 0, :] + slow * offset[..., 1, :]

    args = {"gain": rng.normal(size=(4, 6)) / 2, "offset": rng.normal(size=(2, 6)) / 2}
    return Case(lh.GeneratorField(lh.defining(lh.so(4)), psi), np.array([0.5, -0.5, 0.1, 0.7]), args)


def flag_manifold() -> Case:
    def psi(m: Any, t: Any, args: Any) -> Any:
        return args["a"] * m[..., [1, 2, 4]] + args["b"][..., None]

    args = {"a": np.array([0.3, -0.5, 0.4]), "b": np.float64(0.2)}
    return Case(lh.GeneratorField(lh.sym_conjugation(3), psi), np.array([1.0, 0.2, 0.1, 2.0, -0.3, 3.0]), args)


CASES = {"rigid body": rigid_body(), "controller": controller(), "flag manifold": flag_manifold()}
STEPS = [lh.LieTaylor(6), lh.Taylor(8), lh.RKMK("rk4"), lh.methods.CrouchGrossman3(), lh.Corrected(lh.Euler(), order=4)]


def check(case: Case, step: lh.Step | None, *, bound: float = 1e-8, **options: Any) -> Sensitivity:
    """Compare all derivatives, forward and backward, with differences."""
    propagator = lh.Propagator(case.field, step)
    found = propagator.sensitivity((0, 2), case.start, args=case.args, **options)
    weights = RNG.normal(size=found.solution.y.shape)
    gradient = found.vjp(weights)

    def points(y0: Any, args: Any) -> Any:
        return propagator((0, 2), y0, args=args, **options).y

    def of_arg(name: str) -> Callable[[Any], Any]:
        return lambda values: points(
            np.broadcast_to(case.start, (len(values), len(case.start))), {**case.args, name: lh.PerTrajectory(values)}
        )

    expected = by_differences(lambda y0: points(y0, case.args), case.start)
    assert np.abs(expected).max() > 0.1
    assert np.abs(found.y0 - expected).max() < bound
    assert np.abs(gradient.y0 - np.einsum("ik,ijk->j", weights, found.y0)).max() < 1e-12
    for name, value in case.args.items():
        expected = by_differences(of_arg(name), value)
        assert np.abs(expected).max() > 1e-3
        assert found.args[name].shape == expected.shape
        assert np.abs(found.args[name] - expected).max() < bound
        contracted = np.tensordot(weights, np.moveaxis(found.args[name], -1, 1), 2)
        assert np.shape(gradient.args[name]) == np.shape(value)
        assert np.abs(gradient.args[name] - contracted).max() < 1e-12
    return found


@pytest.mark.parametrize("step", STEPS, ids=repr)
@pytest.mark.parametrize("name", ["rigid body", "controller"])
def test_fixed_steps(name: str, step: lh.Step) -> None:
    check(CASES[name], step, dt=0.1, t_eval=TIMES)


@pytest.mark.parametrize("step", [lh.LieTaylor(4), lh.Taylor(8)], ids=repr)
def test_on_a_flag_manifold(step: lh.Step) -> None:
    """The landing by exponentials, with an orthogonal decomposition that is differentiated too."""
    check(CASES["flag manifold"], step, dt=0.1, t_eval=[2.0])


def test_at_every_step() -> None:
    found = check(CASES["rigid body"], lh.LieTaylor(6), dt=0.25)
    assert found.y0.shape == (3, 3, 9)
    assert np.abs(found.y0[..., 0] - np.eye(3)).max() == 0


@pytest.mark.parametrize("step", [None, lh.RKMK("rk45"), lh.LieTaylor(6)], ids=repr)
def test_adaptive_steps(step: lh.Step | None) -> None:
    """Sizes are held fixed, so differences of runs that choose their sizes anew agree to the tolerance."""
    check(CASES["rigid body"], step, rtol=1e-12, atol=1e-13, t_eval=TIMES)


def test_backwards_in_time() -> None:
    case = CASES["controller"]
    propagator = lh.Propagator(case.field, lh.Taylor(6))
    there = propagator.sensitivity((0, 1), case.start, args=case.args, dt=0.02, t_eval=[1.0])
    back = propagator.sensitivity((1, 0), there.solution.y[:, -1], args=case.args, dt=0.02, t_eval=[0.0])
    assert np.abs(back.y0[..., 0] @ there.y0[..., 0] - np.eye(4)).max() < 1e-9


def test_each_trajectory_of_an_ensemble_has_its_own() -> None:
    starts = np.array([[0.6, 0.1, 0.8], [0.0, 0.6, 0.8], [1.0, 0.0, 0.1]])
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["moments"] * args["rate"][..., None])
    rates = np.array([0.5, 1.0, 2.0])
    args = {"moments": MOMENTS, "rate": lh.PerTrajectory(rates)}
    whole = lh.Propagator(field, lh.LieTaylor(4)).sensitivity((0, 1), starts, args=args, dt=0.1, t_eval=[0.5, 1.0])
    weights = RNG.normal(size=whole.solution.y.shape)
    gradient = whole.vjp(weights)
    assert whole.args["rate"].shape == (3, 3, 2) and gradient.args["rate"].shape == (3,)
    total = np.zeros(3)
    for i, start in enumerate(starts):
        one_args = {"moments": MOMENTS, "rate": rates[i]}
        one = lh.Propagator(field, lh.LieTaylor(4)).sensitivity((0, 1), start, args=one_args, dt=0.1, t_eval=[0.5, 1.0])
        part = one.vjp(weights[i])
        total += part.args["moments"]
        assert np.abs(whole.y0[i] - one.y0).max() < 1e-13
        assert np.abs(whole.args["moments"][i] - one.args["moments"]).max() < 1e-13
        assert np.abs(whole.args["rate"][i] - one.args["rate"]).max() < 1e-13
        assert np.abs(gradient.y0[i] - part.y0).max() < 1e-13
        assert abs(gradient.args["rate"][i] - part.args["rate"]) < 1e-13
    assert np.abs(gradient.args["moments"] - total).max() < 1e-12


def test_conserved_quantities_have_conserved_derivatives() -> None:
    """|y|^2 = |y0|^2 for all y0 in R^3, so that y^T dy/dy0 = y0^T; the energy does not depend on the other moments."""
    case = CASES["rigid body"]
    found = lh.Propagator(case.field, lh.Taylor(12)).sensitivity(
        (0, 10), case.start, args=case.args, rtol=1e-12, t_eval=[5.0, 10.0]
    )
    for k in range(2):
        assert np.abs(found.solution.y[:, k] @ found.y0[..., k] - case.start).max() < 1e-12
        assert np.abs(found.solution.y[:, k] @ found.args["moments"][..., k]).max() < 1e-12


def test_without_args_only_the_initial_point_counts() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / MOMENTS)
    found = lh.Propagator(field, lh.LieTaylor(6)).sensitivity((0, 2), [0.6, 0.1, 0.8], dt=0.1, t_eval=TIMES)
    case = CASES["rigid body"]
    same = lh.Propagator(case.field, lh.LieTaylor(6)).sensitivity(
        (0, 2), case.start, args=case.args, dt=0.1, t_eval=TIMES
    )
    assert found.args is None and np.abs(found.y0 - same.y0).max() < 1e-14


def test_a_wrong_derivative_would_be_noticed() -> None:
    """The negative control: derivatives at other moments do not agree."""
    case = CASES["rigid body"]
    other = Case(case.field, case.start, {"moments": MOMENTS * [1.0, 1.0, 1.01]})
    one, two = [
        lh.Propagator(c.field, lh.LieTaylor(6)).sensitivity((0, 2), c.start, args=c.args, dt=0.1, t_eval=TIMES)
        for c in (case, other)
    ]
    assert np.abs(one.y0 - two.y0).max() > 1e-4


def test_what_is_refused() -> None:
    case = CASES["rigid body"]
    found = lh.Propagator(case.field, lh.LieTaylor(4)).sensitivity((0, 1), case.start, args=case.args, dt=0.1)
    with pytest.raises(ShapeError, match=r"weights of shape \(3,\), expected that of solution.y, \(3, 11\)"):
        found.vjp(np.ones(3))
    with pytest.raises(TraceError, match=r"an iteration is not known: .*engine='jax'"):
        _ = lh.Propagator(case.field, lh.BackwardEuler()).sensitivity((0, 1), case.start, args=case.args, dt=0.1).y0
    propagator = lh.Propagator(case.field)
    problem = propagator.problem((0, 1), case.start, args=case.args)
    with pytest.raises(InputError, match="integrate with dense_output=True"):
        Sensitivity(problem, propagator((0, 1), case.start, args=case.args))
