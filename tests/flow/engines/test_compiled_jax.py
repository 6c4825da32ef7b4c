"""Steps compiled by JAX: the same results as numpy's, and derivatives through whole integrations."""

import time
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, TraceError
from tests.flow.engines.test_compiled import sphere

jax = pytest.importorskip("jax")

EPS = float(np.finfo(float).eps)
BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
START = np.array([0.36, 0.48, 0.8])


@pytest.mark.parametrize("step", [lh.Euler(), lh.Corrected(lh.Euler(), 2)], ids=["Euler", "corrected"])
def test_numpy_arrays_give_the_same_solution(step: Any) -> None:
    for options in ({}, {"t_eval": [0.55, 2.0]}):
        plain = lh.integrate(BODY, (0, 2), sphere(3, 2), step=step, dt=0.1, **options, engine="numpy")
        made = lh.integrate(BODY, (0, 2), sphere(3, 2), step=step, dt=0.1, engine="jax", **options)
        np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=64 * EPS)
        np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=64 * EPS)
        assert str(made.report) == str(plain.report)


def test_the_matrix_exponential_on_a_sphere_of_dimension_four() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(5)), lambda m: np.ones(10) * m[..., :1])
    plain = lh.integrate(field, (0, 1), np.eye(5), step=lh.Euler(), dt=0.1, engine="numpy")
    made = lh.integrate(field, (0, 1), np.eye(5), step=lh.Euler(), dt=0.1, engine="jax")
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=64 * EPS)


def gradient_and_differences(step: Any, **options: Any) -> tuple[Any, Any]:
    weights = np.array([1.0, -2.0, 0.5])

    def last(m: Any, **how: Any) -> Any:
        return weights @ lh.integrate(BODY, (0, 1), m, step=step, dt=0.1, t_eval=[1.0], **how, **options).y[:, -1]

    with jax.enable_x64(True):
        found = np.asarray(jax.jit(jax.grad(lambda m: last(m, engine="jax")))(jax.numpy.asarray(START)))
    e = 1e-6
    return found, np.array([(last(START + e * d) - last(START - e * d)) / (2 * e) for d in np.eye(3)])


def test_the_gradient_of_an_integration_is_that_of_differences() -> None:
    found, wanted = gradient_and_differences(lh.Euler())
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("clock", ["corrected", "nominal"])
def test_the_gradient_through_the_corrector_on_the_sphere(clock: str) -> None:
    """Where the singular values agree: by a singular value decomposition it is nan."""
    found, wanted = gradient_and_differences(lh.Corrected(lh.Euler(), 2), clock=clock)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8)


def test_vmap_is_an_ensemble() -> None:
    def end(m: Any) -> Any:
        return lh.integrate(BODY, (0, 1), m, step=lh.Euler(), dt=0.1, t_eval=[0.5, 1.0], engine="jax").y

    with jax.enable_x64(True):
        m = jax.numpy.asarray(sphere(4, 2))
        mapped, whole = jax.jit(jax.vmap(end))(m), end(m)
    plain = lh.integrate(BODY, (0, 1), sphere(4, 2), step=lh.Euler(), dt=0.1, t_eval=[0.5, 1.0], engine="numpy").y
    np.testing.assert_allclose(np.asarray(mapped), plain, rtol=0, atol=64 * EPS)
    np.testing.assert_allclose(np.asarray(whole), plain, rtol=0, atol=64 * EPS)


def test_half_precision_and_what_needs_values_are_refused() -> None:
    half = jax.numpy.asarray(START, dtype="float16")
    with pytest.raises(InputError, match="jax_enable_x64"):
        lh.integrate(BODY, (0, 1), half, step=lh.Euler(), dt=0.1, engine="jax")
    with jax.enable_x64(True), pytest.raises(InputError, match="no events"):
        double = jax.numpy.asarray(START)
        lh.integrate(BODY, (0, 1), double, step=lh.Euler(), dt=0.1, events=lambda t, y: y[0], engine="jax")
    step = lh.steps.Conserving(lh.Heun(), ["m0**2 + m1**2/2 + m2**2/4", "m0*m0 + m1*m1 + m2*m2"])
    with pytest.raises(TraceError, match="compiled"):
        lh.integrate(BODY, (0, 1), START, step=step, dt=0.1, engine="jax")


def test_stages_are_not_computed_anew_for_each_use() -> None:
    """A step of RK4 for one point takes 0.2 us; where it does not hold, 40 us."""
    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.01, "t_eval": [0.5], "engine": "jax"}
    starts = sphere(4000, 2)
    lh.integrate(BODY, (0, 0.5), starts, **options)
    before = time.process_time()
    lh.integrate(BODY, (0, 0.5), starts, **options)
    assert time.process_time() - before < 2
