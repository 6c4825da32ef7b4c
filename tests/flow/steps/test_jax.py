"""Corrected steps on JAX arrays: jit and vmap give what numpy gives."""

from collections.abc import Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps.step import Generator
from tests.flow.steps.support import OMEGA, one_step, quadratic, rigid_body, spin, unit


@pytest.fixture(autouse=True)
def _double() -> Iterator[None]:
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", before)


def stepper(field: lh.GeneratorField, step: Any, dimension: int, exponential: Any = "exp") -> Any:
    """(m, t, h) -> (the next point, the time that has passed)."""
    action, psi = lh.Action(field.representation, exponential), Generator(field, dimension)

    def one(m: Any, t: Any, h: Any) -> Any:
        local = step.at(action, psi, m, t[..., None])
        return local.point(h[..., None]), local.time(h)

    return one


@pytest.mark.parametrize(("base", "exponential"), [
    (lh.Euler(), "exp"), (lh.Heun(), "cayley"),
    *[pytest.param(*x, marks=pytest.mark.slow) for x in ((lh.Euler(), "cayley"), (lh.Heun(), "exp"))],
    *[pytest.param(lh.LieTaylor(2), x, marks=pytest.mark.slow) for x in ("exp", "cayley")],
], ids=str)  # fmt: skip
def test_jit_and_vmap(base: Any, exponential: str) -> None:
    field, m, h = rigid_body(), unit(1, 7, 3), 0.1 + 0.02 * np.arange(7)
    step = lh.Corrected(base, 4)
    one = stepper(field, step, 2, exponential)
    wanted, times = one_step(field, step, m, h, exponential=exponential)
    zero = jnp.zeros(7)
    functions = [jax.jit(jax.vmap(one))]
    if (base, exponential) == (lh.Euler(), "exp"):
        functions.append(jax.jit(one))
    for function in functions:
        z, tau = function(jnp.asarray(m), zero, jnp.asarray(h))
        assert np.abs(np.asarray(z) - wanted).max() < 1e-13
        assert np.abs(np.asarray(tau) - times).max() < 1e-13


def test_other_spaces() -> None:
    field, m = quadratic(lh.defining(lh.so(4)), 2, 0.4), unit(3, 5, 4)
    wanted, times = one_step(field, lh.Corrected(lh.Euler(), 4), m, 0.1)
    function = jax.jit(stepper(field, lh.Corrected(lh.Euler(), 4), 3))
    z, tau = function(jnp.asarray(m), jnp.zeros(5), jnp.full(5, 0.1))
    assert np.abs(np.asarray(z) - wanted).max() < 1e-13 and np.abs(np.asarray(tau) - times).max() < 1e-13


def test_equilibria_and_failing_points_in_a_traced_ensemble() -> None:
    field = rigid_body()
    m = np.array([[0.0, 0, 1.0], [0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [1e-15, 0.0, 1.0]])
    wanted, times = one_step(field, lh.Corrected(lh.Euler(), 4), m, 0.2)
    z, tau = jax.jit(stepper(field, lh.Corrected(lh.Euler(), 4), 2))(jnp.asarray(m), jnp.zeros(4), jnp.full(4, 0.2))
    assert np.abs(np.asarray(z) - wanted).max() < 1e-14 and np.abs(np.asarray(tau) - times).max() < 1e-14
    assert np.array_equal(np.asarray(z)[[0, 2]], m[[0, 2]])
    other = quadratic(lh.sym_conjugation(3), 3, 0.1)
    points = np.array([1.0, 0, 0, 2.0, 0, 3.0])
    wanted, times = one_step(other, lh.Corrected(lh.Euler(), 4), points, 0.1)
    z, tau = jax.jit(stepper(other, lh.Corrected(lh.Euler(), 4), 3))(
        jnp.asarray(points), jnp.zeros(()), jnp.asarray(0.1)
    )
    assert np.abs(np.asarray(z) - wanted).max() < 1e-13 and abs(float(tau) - times) < 1e-13


def test_time_dependent_fields_through_a_zero() -> None:
    """At the zero itself the leading order is not known while tracing: the flow's own terms serve there."""
    field = lh.GeneratorField(spin(), lambda m, t: t[..., None] * (m * OMEGA + np.array([0.1, 0.2, 0.3])))
    m, times = unit(2, 5, 3), np.array([0.0, 1e-9, 0.3, 1.0, 2.0])
    one = jax.jit(stepper(field, lh.Corrected(lh.Euler(), 4), 2))
    z, tau = one(jnp.asarray(m), jnp.asarray(times), jnp.full(5, 0.1))
    wanted, clock = one_step(field, lh.Corrected(lh.Euler(), 4), m, 0.1, times)
    assert np.abs(np.asarray(z)[1:] - wanted[1:]).max() < 1e-13
    assert np.abs(np.asarray(tau)[1:] - clock[1:]).max() < 1e-13
    assert np.abs(np.asarray(z)[0] - wanted[0]).max() < 1e-6 and float(tau[0]) == 0.1
