"""Calls on JAX arrays: the numbers and statuses of numpy, types, and compiled code that is used again."""

import time
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.engines.jax_loops import _digest
from liehom.flow.series.jet import Jet

jax = pytest.importorskip("jax")
jnp = jax.numpy

EPS = float(np.finfo(float).eps)
MOMENTS = np.array([1.0, 0.5, 0.25])
BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * MOMENTS)
STARTS = np.array([[0.36, 0.48, 0.8], [0.6, 0.0, 0.8]])


@pytest.mark.parametrize(("step", "options"), [
    (lh.RKMK("heun"), {"rtol": 1e-4}), pytest.param(lh.RKMK("rk45"), {"rtol": 1e-8}, marks=pytest.mark.slow),
    pytest.param(lh.LieTaylor(6), {"rtol": 1e-8}, marks=pytest.mark.slow),
    pytest.param(lh.Taylor(8), {"rtol": 1e-8}, marks=pytest.mark.slow),
    pytest.param(lh.Corrected(lh.Euler(), 4), {"rtol": 1e-6}, marks=pytest.mark.slow),
    pytest.param(lh.RKMK("dop853"), {"rtol": 1e-10}, marks=pytest.mark.slow),
    pytest.param(lh.Taylor(8), {"dt": 0.2}, marks=pytest.mark.slow),
    pytest.param(lh.RKMK("radau2a"), {"dt": 0.1}, marks=pytest.mark.slow),
], ids=str)  # fmt: skip
@pytest.mark.parametrize("span", [(0.0, 2.0), (2.0, 0.0)], ids=["forwards", "backwards"])
def test_steps_and_points_are_those_of_numpy(step: Any, options: dict[str, Any], span: tuple[float, float]) -> None:
    if span[0] and step != lh.RKMK("heun"):
        pytest.skip("one step shows that time may decrease")
    times = [0.5, span[1]] if span[1] else [1.5, 0.0]
    plain = lh.integrate(BODY, span, STARTS, step=step, t_eval=times, **options, engine="numpy")
    with jax.enable_x64(True):
        made = lh.integrate(BODY, span, jnp.asarray(STARTS), step=step, t_eval=times, engine="jax", **options)
    np.testing.assert_allclose(np.asarray(made.y), plain.y, rtol=0, atol=1e-12)
    assert np.asarray(made.n_steps).tolist() == np.asarray(plain.n_steps).tolist()


FAILING = {
    "the clock does not run": (BODY, (0.0, 40.0), {"step": lh.Corrected(lh.Euler(), 4), "dt": 20.0}),
    "psi becomes nan": (
        lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: m * np.sqrt(1 - t)[..., None]),
        (0.0, 2.0),
        {"step": lh.RKMK("rk4"), "dt": 0.3, "t_eval": [0.25, 2.0]},
    ),
    "too many steps": (BODY, (0.0, 2.0), {"step": lh.RKMK("rk45"), "rtol": 1e-8, "max_steps": 5, "t_eval": [2.0]}),
}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("case", list(FAILING))
def test_failures_have_the_status_of_numpy(case: str) -> None:
    field, span, options = FAILING[case]
    plain = lh.integrate(field, span, STARTS, **options, engine="numpy")
    with jax.enable_x64(True):
        made = lh.integrate(field, span, jnp.asarray(STARTS), engine="jax", **options)
        alone = lh.integrate(field, span, jnp.asarray(STARTS[0]), engine="jax", **options)
    assert plain.status == -1
    assert made.status == -1 and not made.success and made.message == plain.message
    assert np.asarray(made.statuses).tolist() == np.asarray(plain.statuses).tolist()
    assert alone.statuses == -1 and np.isnan(np.asarray(alone.y)[:, -1]).all()


@pytest.mark.slow
def test_statuses_are_known_to_a_caller_that_jax_traces() -> None:
    field, span, options = FAILING["psi becomes nan"]
    with jax.enable_x64(True):
        found = jax.jit(lambda y: lh.integrate(field, span, y, engine="jax", **options).statuses)(jnp.asarray(STARTS))
    assert np.asarray(found).tolist() == [-1, -1]


@pytest.mark.slow
def test_a_stiff_implicit_step_is_solved_and_differentiated() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 30 * np.cross(m, [0, 0, 1.0]))
    options: dict[str, Any] = {"step": lh.BackwardEuler(), "dt": 0.1, "t_eval": [0.3]}

    def end(y: Any, **how: Any) -> Any:
        return lh.integrate(field, (0, 0.3), y, **options, **how).y[2, -1]

    with jax.enable_x64(True):
        value, slope = jax.value_and_grad(lambda y: end(y, engine="jax"))(jnp.asarray(STARTS[0]))
    assert abs(float(value) - end(STARTS[0])) < 1e-13
    differences = [(end(STARTS[0] + e) - end(STARTS[0] - e)) / 2e-6 for e in 1e-6 * np.eye(3)]
    np.testing.assert_allclose(np.asarray(slope), differences, rtol=0, atol=1e-8)


@pytest.mark.parametrize("x64", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_type_of_the_start_is_that_of_the_solution(x64: bool) -> None:
    step = lh.LieTaylor(2)
    plain = lh.integrate(BODY, (0, 1), STARTS[0], step=step, dt=0.1).y[:, -1]
    with jax.enable_x64(x64):
        single = lh.integrate(BODY, (0, 1), jnp.asarray(STARTS[0], "float32"), step=step, dt=0.1, engine="jax")
    assert single.y.dtype == np.float32
    np.testing.assert_allclose(np.asarray(single.y[:, -1]), plain, rtol=0, atol=2e-6)


def test_integers_and_float64_starts_without_x64_are_refused() -> None:
    with jax.enable_x64(False), pytest.raises(InputError, match="type int32, expected float64 or float32"):
        lh.integrate(BODY, (0, 1), jnp.arange(3), dt=0.1, engine="jax")
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m * args)
    with jax.enable_x64(False), pytest.raises(InputError, match="of type float64, and JAX computes in float32"):
        lh.integrate(field, (0, 1), STARTS[0], dt=0.1, engine="jax", args=jnp.ones(3))


def test_code_is_compiled_once_whatever_numbers_psi_closes_over() -> None:
    def end(moments: Any) -> Any:
        field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * moments)
        return np.asarray(lh.integrate(field, (0, 1), start, step=lh.RKMK("rk4"), dt=0.1, engine="jax").y[:, -1])

    with jax.enable_x64(True):
        start = jnp.asarray(STARTS[0])
        first = end(jnp.asarray(MOMENTS))
        before = time.process_time()
        second = end(jnp.asarray(2 * MOMENTS))
        assert time.process_time() - before < 0.5
    doubled = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -2 * m * MOMENTS)
    plain = lh.integrate(doubled, (0, 1), STARTS[0], step=lh.RKMK("rk4"), dt=0.1, engine="numpy")
    assert np.abs(first - second).max() > 1e-3
    np.testing.assert_allclose(second, plain.y[:, -1], rtol=0, atol=64 * EPS)


def test_series_of_a_psi_that_is_written_with_functions_of_jax_are_those_of_numpy() -> None:
    def psi_of(xp: Any) -> Any:
        return lambda m: xp.stack([m[..., 0] ** 2, xp.sin(m[..., 1]), xp.exp(m[..., 2])], axis=-1)

    plain, made = (lh.GeneratorField(lh.adjoint(lh.so(3)), psi_of(xp)) for xp in (np, jnp))
    terms = np.random.default_rng(2).normal(size=(4, 3))
    with jax.enable_x64(True):
        found = made.psi(Jet(jnp.asarray(terms))).coefficients
    np.testing.assert_allclose(np.asarray(found), plain.psi(Jet(terms)).coefficients, rtol=0, atol=1e-12)


def test_digests_of_traced_functions_are_those_of_their_operations() -> None:
    first, again, other = (
        _digest(jax.make_jaxpr(f)(1.0).jaxpr) for f in (lambda x: 2.0 * x, lambda y: 2.0 * y, lambda x: 3.0 * x)
    )
    assert first is not None and len(first) == 64 and first == again != other
