"""Gradients through trajectories on JAX arrays are those of differences, for all that a call depends on."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError

jax = pytest.importorskip("jax")
jnp = jax.numpy

START = np.array([0.36, 0.48, 0.8])
RHO = lh.adjoint(lh.so(3))
METHODS = {
    "fixed": (lh.LieTaylor(2), {"dt": 0.1}),
    "corrected": (lh.Corrected(lh.Euler(), 3), {"dt": 0.1}),
    "adaptive pair": (lh.RKMK("rk45"), {"rtol": 1e-9, "atol": 1e-9}),
    "adaptive series": (lh.LieTaylor(5), {"rtol": 1e-9, "atol": 1e-9}),
}


@pytest.fixture(autouse=True)
def _double() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


def differences(function: Callable[[Any], Any], x: Any, e: float = 1e-5) -> Any:
    """Symmetric difference quotients of fourth order along the coordinates of x."""
    flat, found = np.asarray(x, float).ravel(), []
    for direction in e * np.eye(flat.size):
        near, far = (
            float(function(jnp.asarray((flat + k * direction).reshape(np.shape(x)))))
            - float(function(jnp.asarray((flat - k * direction).reshape(np.shape(x)))))
            for k in (1, 2)
        )
        found.append((8 * near - far) / (12 * e))
    return np.array(found).reshape(np.shape(x))


def moments(method: str) -> Callable[[Any], Any]:
    step, options = METHODS[method]
    field = lh.GeneratorField(RHO, lambda m, t, args: -m / args["moments"])
    propagator = lh.Propagator(field, step, engine="jax")
    return lambda x: propagator((0, 1), START, args={"moments": x}, t_eval=[0.37, 1.0], **options).y[2].sum()


@pytest.mark.parametrize(
    "method", ["fixed", *[pytest.param(m, marks=pytest.mark.slow) for m in METHODS if m != "fixed"]]
)
def test_the_moments_of_a_rigid_body(method: str) -> None:
    function, x = moments(method), jnp.asarray([1.0, 2.0, 3.0])
    found = jax.grad(function)(x)
    assert np.abs(found).max() > 1e-2
    # with adaptive steps, differences see that the sizes change: by about the tolerance
    np.testing.assert_allclose(np.asarray(found), differences(function, x), rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["fixed", "adaptive pair"])
def test_all_transformations_give_one_derivative(method: str) -> None:
    function, x = moments(method), jnp.asarray([1.0, 2.0, 3.0])
    found = np.asarray(jax.grad(function)(x))
    forward = jax.jacfwd(function)
    for other in (jax.jit(jax.grad(function)), forward, jax.jacrev(function), jax.jit(forward)):
        np.testing.assert_allclose(np.asarray(other(x)), found, rtol=0, atol=1e-13)
    many = jax.vmap(jax.grad(function))(jnp.stack([x, 2 * x]))
    np.testing.assert_allclose(np.asarray(many[0]), found, rtol=0, atol=1e-13)
    np.testing.assert_allclose(np.asarray(many[1]), np.asarray(jax.grad(function)(2 * x)), rtol=0, atol=1e-13)


@pytest.mark.slow
def test_the_second_derivative_is_that_of_gradients() -> None:
    function, x = moments("fixed"), jnp.asarray([1.0, 2.0, 3.0])
    found = np.asarray(jax.hessian(function)(x))
    rows = [differences(lambda y, i=i: jax.grad(function)(y)[i], x) for i in range(3)]
    assert np.abs(found).max() > 1e-2
    np.testing.assert_allclose(found, np.array(rows), rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["fixed", "adaptive pair"])
def test_the_numbers_of_a_linear_controller(method: str) -> None:
    """psi = -m / I + G (m, s) with the 3 x 12 matrix G and sines of t."""
    step, options = METHODS[method]

    def psi(m: Any, t: Any, gains: Any) -> Any:
        waves = np.stack([np.sin((k + 1) * t) for k in range(9)], axis=-1)
        return -m / np.array([1.0, 2.0, 3.0]) + m @ gains[:3] + waves @ gains[3:]

    propagator = lh.Propagator(lh.GeneratorField(RHO, psi), step, engine="jax")

    def height(gains: Any) -> Any:
        return propagator((0, 1), START, args=gains, **options).y[2, -1]

    gains = jnp.asarray(0.2 * np.random.default_rng(1).normal(size=(12, 3)))
    found = np.asarray(jax.grad(height)(gains))
    assert found.size == 36 and np.abs(found).max() > 1e-2
    np.testing.assert_allclose(found, differences(height, gains), rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("written", ["numpy", "jax"])
def test_the_weights_of_a_network(written: str) -> None:
    """A psi of two layers, written with numpy functions, or with those of JAX, which are called on JAX arrays only."""
    xp = np if written == "numpy" else jnp
    step, options = METHODS["fixed"] if written == "numpy" else (lh.RKMK("rk4"), {"dt": 0.1})

    def psi(m: Any, t: Any, weights: Any) -> Any:
        return xp.tanh(m @ weights["in"] + weights["shift"]) @ weights["out"]

    propagator = lh.Propagator(lh.GeneratorField(RHO, psi), step, engine="jax")
    rng = np.random.default_rng(2)
    weights = {"in": rng.normal(size=(3, 4)), "shift": rng.normal(size=4), "out": rng.normal(size=(4, 3))}
    weights = {k: jnp.asarray(w) for k, w in weights.items()}

    def height(weights: Any) -> Any:
        return propagator((0, 1), START, args=weights, **options).y[2, -1]

    found = jax.grad(height)(weights)
    for name in weights:
        wanted = differences(lambda w, name=name: height({**weights, name: w}), weights[name])
        assert np.abs(wanted).max() > 1e-3
        np.testing.assert_allclose(np.asarray(found[name]), wanted, rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("method", list(METHODS))
def test_the_ends_of_the_time_span_and_output_times(method: str) -> None:
    step, options = METHODS[method]
    field = lh.GeneratorField(RHO, lambda m: -m * np.array([1.0, 0.5, 0.25]))
    propagator = lh.Propagator(field, step, engine="jax")

    def heights(v: Any, **more: Any) -> Any:
        return propagator((v[0], v[1]), START, t_eval=jnp.stack([v[2], v[1]]), **options, **more).y[2].sum()

    v = jnp.asarray([0.1, 1.03, 0.61])
    found = np.asarray(jax.grad(heights)(v))
    np.testing.assert_allclose(found, differences(heights, v), rtol=0, atol=1e-8)
    traced = jax.jit(jax.grad(lambda v: heights(v, max_steps=64)))(v)
    np.testing.assert_allclose(np.asarray(traced), found, rtol=0, atol=1e-12)


def test_what_psi_closes_over() -> None:
    def height(moments: Any) -> Any:
        field = lh.GeneratorField(RHO, lambda m: -m / moments)
        return lh.integrate(field, (0, 0.5), jnp.asarray(START), step=lh.Heun(), dt=0.1, engine="jax").y[2, -1]

    x = jnp.asarray([1.0, 2.0, 3.0])
    np.testing.assert_allclose(np.asarray(jax.grad(height)(x)), differences(height, x), rtol=0, atol=1e-8)


def test_an_unknown_number_of_steps_needs_a_bound() -> None:
    field = lh.GeneratorField(RHO, [0, 0, 1])
    with pytest.raises(InputError, match="give max_steps"):
        jax.jit(lambda t: lh.integrate(field, (0.0, t), START, dt=0.1, engine="jax").y)(1.0)


SMALLEST = pytest.param({"min_step": 2.0}, marks=pytest.mark.slow)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("options", [{"max_steps": 3}, SMALLEST], ids=str)
def test_bounds_of_adaptive_steps_hold_under_jit(options: dict[str, Any]) -> None:
    field = lh.GeneratorField(RHO, lambda m, t, args: -m * args)
    propagator, numbers = lh.Propagator(field, "rk45", engine="jax"), jnp.array([1.0, 0.5, 0.25])

    def run(args: Any, **given: Any) -> Any:
        sol = propagator((0.0, 5.0), jnp.asarray(START), args=args, t_eval=[5.0], **given)
        return sol.statuses, sol.y

    assert int(jax.jit(run)(numbers)[0]) == 0
    status, y = jax.jit(lambda args: run(args, **options))(numbers)
    assert int(status) == int(run(numbers, **options)[0]) == -1
    assert np.isnan(np.asarray(y)).all()
