"""Compiled steps that solve equations by iteration: loops in the trace, for every lane as long as it needs."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.loop import StepGraph, while_loop
from liehom.flow.tracing.machine import Kernel
from liehom.flow.tracing.sweeps import evaluate_with_jax
from tests.flow.engines.test_compiled import BODY, EPS, START, ULPS, a_field, assert_same, both, cache, sphere
from tests.flow.propagation import spaces

__all__ = ["cache"]

STEPS = ["implicit euler", "implicit midpoint", "gauss2", "gauss3", "radau2a", "sdirk2", "trapezoidal"]


@pytest.mark.parametrize("name", STEPS)
def test_the_rigid_body_agrees(name: str) -> None:
    for y0 in (START, sphere(21)):
        assert_same(*both(BODY, (0, 2), y0, step=lh.RKMK(name), dt=0.1))


@pytest.mark.parametrize("name", STEPS)
def test_calls_of_psi_are_counted_iteration_by_iteration(name: str) -> None:
    plain, made = both(BODY, (0, 2), START, step=lh.RKMK(name), dt=0.1)
    # an iteration that stops at round-off may stop one later or earlier
    assert abs(made.nfev - plain.nfev) <= 0.05 * plain.nfev
    assert plain.nfev > 4 * 20


@pytest.mark.parametrize("step", [lh.BackwardEuler(), lh.Corrected(lh.BackwardEuler(), 2)], ids=["plain", "corrected"])
def test_backward_euler_agrees(step: lh.steps.Step) -> None:
    assert_same(*both(BODY, (0, 2), sphere(5), step=step, dt=0.1))


@pytest.mark.parametrize("name", ["S^4", "Sym(3) at (1,2,3)", "H^3"])
def test_other_spaces_agree(name: str) -> None:
    space = spaces.make(name)
    assert_same(*both(a_field(name, space), (0, 1), space.starts[:3], step=lh.RKMK("gauss2"), dt=0.05))


def test_lanes_iterate_as_long_as_they_need() -> None:
    """A trajectory at rest beside fast ones: each has the result that it has alone."""
    w = np.array([1.0, 0.5, 0.25])
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * w * (1 + 30 * m[..., :1] ** 2))
    y0 = np.concatenate([[[0.0, 0.0, 1.0]], sphere(9)])
    options: dict[str, Any] = {"step": lh.RKMK("gauss2"), "dt": 0.01, "engine": "llvm"}
    many = lh.integrate(field, (0, 1), y0, **options)
    for k in (0, 1, 9):
        alone = lh.integrate(field, (0, 1), y0[k], **options)
        np.testing.assert_allclose(alone.y, many.y[k], rtol=0, atol=ULPS * EPS)
    assert_same(*both(field, (0, 1), y0, step=lh.RKMK("gauss2"), dt=0.01))


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("backend", ["llvm", "jax"])
def test_an_iteration_that_fails_ends_as_on_arrays(backend: str) -> None:
    # across a jump of psi that points back, the equation of the midpoint rule has no solution
    jump = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: [0.0, 0.0, 1.0] * np.where(m[..., :1] > 0, 1.0, -3.0))
    y0 = np.array([[0.6, 0.48, 0.64], [0.0, 0.6, 0.8], [0.1, 0.6, np.sqrt(0.63)]])
    y0[1] = [-0.6, 0.48, 0.64]
    plain = lh.integrate(jump, (0, 0.5), y0, step=lh.RKMK("implicit midpoint"), dt=0.1, engine="numpy")
    made = lh.integrate(jump, (0, 0.5), y0, step=lh.RKMK("implicit midpoint"), dt=0.1, engine=backend)
    assert list(plain.statuses) == list(made.statuses) and set(plain.statuses) == {0, int(plain.statuses.min())}
    assert plain.statuses.min() < 0
    assert plain.message == made.message


def test_jax_agrees_and_differentiates() -> None:
    jax = pytest.importorskip("jax")
    step = lh.RKMK("implicit midpoint")
    plain = lh.integrate(BODY, (0, 2), sphere(3), step=step, dt=0.1, engine="numpy")
    made = lh.integrate(BODY, (0, 2), sphere(3), step=step, dt=0.1, engine="jax")
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=ULPS * EPS)

    def last(m: Any, **how: Any) -> Any:
        return lh.integrate(BODY, (0, 0.5), m, step=step, dt=0.1, t_eval=[0.5], **how).y[1, -1]

    with jax.enable_x64(True):
        found = np.asarray(jax.jit(jax.grad(lambda m: last(m, engine="jax")))(jax.numpy.asarray(START)))
    e = 1e-6
    wanted = [(last(START + e * d) - last(START - e * d)) / (2 * e) for d in np.eye(3)]
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8)


# -- the loop itself -----------------------------------------------------------------------------------------
def heron(tape: Tape, a: Traced, limit: int) -> Traced:
    """Square roots, each lane until nothing changes; a loop inside a loop computes the half."""

    def half(x: Any) -> Any:
        return while_loop(lambda y, k: ([y - x / 8, k + 1], k < 3), [x, 0.0], tape, 10)[0]

    def body(x: Any) -> Any:
        new = half(x + a / x)
        going = np.abs(new - x) > 1e-14 * new
        return [np.where(going, new, x)], going

    return while_loop(body, [a], tape, limit)[0]


def test_loops_within_loops_by_both_emitters() -> None:
    tape = Tape()
    found = heron(tape, Traced(tape, tape.input(0)), 60).entries[()]
    values = np.array([2.0, 1e-3, 5.0, 1e6, 1.0, 3.0, 7.0, 0.5])
    np.testing.assert_allclose(np.asarray(evaluate_with_jax([found], {0: values})[0]), np.sqrt(values), rtol=1e-6)
    for width in (1, 8):
        kernel = Kernel(StepGraph([found], None, None, {}, {}), width)
        state = kernel.packed(8, {"x": values[None], "alive": 1.0})
        kernel(state, end=1, total=1, step_size=1.0, stops=np.ones(2), out=np.empty((1, 1, 8)))
        np.testing.assert_allclose(state[0], np.sqrt(values), rtol=1e-12)


def test_a_limit_is_kept() -> None:
    tape = Tape()
    found = while_loop(lambda y: ([y + 1], y < 1e9), [Traced(tape, tape.input(0))], tape, 7)[0].entries[()]
    for whole in (False, True):
        assert float(evaluate_with_jax([found], {0: 0.0}, differentiable=whole)[0]) == 7.0


# -- stiff fields --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("backend", "name"), [("llvm", "implicit euler"), ("llvm", "radau2a"), ("jax", "implicit euler")]
)
def test_newton_in_compiled_code_agrees_with_arrays(backend: str, name: str) -> None:
    y0 = sphere(9)
    for rate in (10.0, 1000.0):  # two fields whose numbers appear inside loops only
        field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, k=rate: k * np.cross(m, [0.0, 0.0, 1.0]))
        plain = lh.integrate(field, (0, 1), y0, step=lh.RKMK(name), dt=0.1, t_eval=[0.2, 1.0], engine="numpy")
        made = lh.integrate(field, (0, 1), y0, step=lh.RKMK(name), dt=0.1, t_eval=[0.2, 1.0], engine=backend)
        assert (plain.statuses == 0).all() and (made.statuses == 0).all()
        np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-13)


@pytest.mark.slow
def test_jax_differentiates_a_stiff_step() -> None:
    jax = pytest.importorskip("jax")
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1000 * np.cross(m, [0.0, 0.0, 1.0]))

    def last(m: Any, **how: Any) -> Any:
        return lh.integrate(field, (0, 0.01), m, step=lh.BackwardEuler(), dt=0.01, t_eval=[0.01], **how).y[:, -1]

    with jax.enable_x64(True):
        found = np.asarray(jax.jacfwd(lambda m: last(m, engine="jax"))(jax.numpy.asarray(START)))
    e = 1e-6
    wanted = [(last(START + e * d) - last(START - e * d)) / (2 * e) for d in np.eye(3)]
    np.testing.assert_allclose(found, np.array(wanted).T, rtol=0, atol=1e-8)


def test_eighteen_unknowns_are_solved_in_the_kernel() -> None:
    """radau5 on S^3, a stiff field: no step is left to numpy."""
    rho = lh.defining(lh.so(4))
    matrices, goal = np.array([a.to_numpy() for a in rho.matrices]), np.array([1.0, 0.0, 0.0, 0.0])
    field = lh.GeneratorField(rho, lambda m: 1e3 * np.einsum("aij,...j,i->...a", matrices, m, goal))
    options: dict[str, Any] = {"step": lh.methods.StiffRKMK("radau5"), "rtol": 1e-4, "t_eval": [1.0]}
    plain, made = both(field, (0, 1), [0.6, 0.0, 0.48, 0.64], **options)
    assert made.report.engine == "llvm" and np.array_equal(made.n_steps, plain.n_steps)
    assert np.abs(made.y - plain.y).max() < 1e-11
