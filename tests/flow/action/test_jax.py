"""Exponentials, fields and frames on JAX arrays, also under jit and grad."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.action.custom_exponential import exponential_of
from liehom.flow.action.field import check_point
from tests.flow.action.support import matrices, representation, vectors


@pytest.fixture(autouse=True)
def double_precision() -> Any:
    with jax.enable_x64(True):
        yield


CASES = [("so(3)", "exp"), ("so(3)", "cayley"), ("Sym(3)", "exp"), ("Sym(3)", "cayley")]


@pytest.mark.parametrize(
    ("name", "which"), [*CASES, ("Sym(3)", "expm"), ("so(3,1)", "cayley"), ("so(4) scrambled", "exp"), ("g2", "exp")]
)
def test_exponentials_agree_with_those_on_numpy_arrays(name: str, which: str) -> None:
    x, m = vectors(name, 1, (3, 2))
    exp = exponential_of(representation(name), which)
    made = jax.jit(exp.__call__)(x, m)
    assert isinstance(made, jax.Array) and made.dtype == np.float64
    np.testing.assert_allclose(made, exp(x, m), rtol=1e-12, atol=1e-13, err_msg=which)
    one = exp(jnp.asarray(x[0, 0]), jnp.asarray(m[0, 0]))
    assert isinstance(one, jax.Array)
    np.testing.assert_allclose(one, made[0, 0], rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(("name", "which"), CASES)
def test_arguments_of_all_sizes(name: str, which: str) -> None:
    exp = exponential_of(representation(name), which)
    compiled = jax.jit(exp.__call__)
    for size in (0.0, 1e-300, 1e-3, 30.0, 1e3):
        x, m = vectors(name, 2, (4,), size)
        np.testing.assert_allclose(compiled(x, m), exp(x, m), rtol=0, atol=3e-15 * max(100.0, size))
    if name == "Sym(3)" and which == "exp":  # too large for the number of squarings
        assert np.isnan(compiled(1e9 * x, m)).all()


@pytest.mark.parametrize(("name", "which"), CASES)
def test_gradients_against_differences(name: str, which: str) -> None:
    x, m = vectors(name, 3)
    exp = exponential_of(representation(name), which)
    gradient = jax.jit(jax.grad(lambda x: exp(x, m)[0]))
    h = 1e-5
    wanted = [(exp(x + h * e, m)[0] - exp(x - h * e, m)[0]) / (2 * h) for e in np.eye(len(x))]
    np.testing.assert_allclose(gradient(x), wanted, rtol=1e-7, atol=1e-8)
    np.testing.assert_allclose(gradient(0 * x), (matrices(name) @ m)[:, 0], atol=1e-13)


@pytest.mark.parametrize(("name", "which"), CASES)
def test_series_on_jax_arrays(name: str, which: str) -> None:
    x, m = vectors(name, 4, (2,))
    exp = exponential_of(representation(name), which)

    def coefficients(x: Any, m: Any) -> Any:
        curve = lh.Jet.growing(0 * x, 3, zero=True)
        curve.extend(x)
        curve.extend(x * x)
        curve.extend(None)
        return exp(curve, m).coefficients

    np.testing.assert_allclose(jax.jit(coefficients)(x, m), coefficients(x, m), atol=1e-13)


FORMS = [
    ["m0*m1", "sin(m0) + 1/3", "2"],
    lambda m: np.stack([m[..., 0] * m[..., 1], np.sin(m[..., 0]) + 1 / 3, 2 + 0 * m[..., 0]], axis=-1),
    lambda m: [m[..., 0] * m[..., 1], np.sin(m[..., 0]) + 1 / 3, 2], np.array([1.0, 2.0, 3.0]), [1, 2, 3],
]  # fmt: skip


@pytest.mark.parametrize("psi", FORMS)
def test_generators(psi: Any) -> None:
    field = lh.GeneratorField(representation("so(3)"), psi)
    _, m = vectors("so(3)", 5, (4,))
    np.testing.assert_allclose(field.psi(jnp.asarray(m[0])), field.psi(m[0]), rtol=1e-14)
    np.testing.assert_allclose(jax.jit(field.psi)(m), field.psi(m), rtol=1e-14)
    np.testing.assert_allclose(jax.jit(field.vector)(m), field.vector(m), rtol=1e-13, atol=1e-14)
    field.check(jnp.asarray(m))


def test_generators_that_depend_on_time() -> None:
    field = lh.GeneratorField(representation("so(3)"), ["t*m0", "cos(t)", "m2"])
    _, m = vectors("so(3)", 6, (4,))
    t = np.linspace(0, 1, 4)
    np.testing.assert_allclose(jax.jit(field.psi)(m, t), field.psi(m, t), rtol=1e-13)


@pytest.mark.parametrize("given", [None, 2])
def test_the_generator_of_least_norm(given: int | None) -> None:
    rho = representation("Sym(3)")
    a = matrices("Sym(3)")
    psi = np.random.default_rng(7).normal(size=(3, 6))
    field = lh.GeneratorField.from_vector_field(
        rho, lambda m: np.einsum("...a,aij,...j", np.einsum("ai,...i", psi, m), a, m), orbit_dimension=given
    )
    x, _ = vectors("Sym(3)", 8, (3,))
    m = lh.Action(rho).act(x, np.array([1.0, 0, 0, 1, 0, 2]))
    np.testing.assert_allclose(jax.jit(field.psi)(m), field.psi(m), atol=1e-12)
    flow = jax.jit(lambda m: lh.steps.flow_series(field, m, 4).points.coefficients)
    np.testing.assert_allclose(flow(m), lh.steps.flow_series(field, m, 4).points.coefficients, rtol=1e-8, atol=1e-8)


def test_its_derivative_along_an_orbit() -> None:
    """The frame is not differentiated, so equal singular values do no harm."""
    rho = representation("so(3)")
    field = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross(m * [1.0, 2.0, 3.0], m), orbit_dimension=2)
    m = np.array([0.0, 0.6, 0.8])
    direction = np.array([1.0, 0.0, 0.0])

    def along(s: Any) -> Any:
        return field.psi(m * jnp.cos(s) + direction * jnp.sin(s))

    made = jax.jacobian(along)(0.0)
    h = 1e-5
    np.testing.assert_allclose(made, (along(h) - along(-h)) / (2 * h), rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("name", ["Sym(3)", "so(5)"])
def test_frames(name: str) -> None:
    action = lh.Action(representation(name))
    _, m = vectors(name, 9, (3,))
    d = int(check_point(action.representation, m)[0])

    def projectors(m: Any) -> Any:
        frame = action.isotropy_frame(m, d)
        parts = frame.basis, frame.tangent
        return [p @ jnp.swapaxes(p, -1, -2) for p in parts] + [frame.lift @ jnp.swapaxes(frame.tangent, -1, -2)]

    for made, wanted in zip(jax.jit(projectors)(m), projectors(m), strict=True):
        np.testing.assert_allclose(made, wanted, atol=1e-11)


def test_traced_points_have_no_dimension() -> None:
    with pytest.raises(InputError, match="traced"):
        jax.jit(lambda m: check_point(representation("so(3)"), m))(np.ones(3))


def test_single_precision_stays_single() -> None:
    with jax.enable_x64(False):
        x, m = (jnp.asarray(v, dtype=jnp.float32) for v in vectors("Sym(3)", 10))
        for which in ("exp", "cayley"):
            made = exponential_of(representation("Sym(3)"), which)(x, m)
            assert made.dtype == np.float32
            wanted = exponential_of(representation("Sym(3)"), which)(*vectors("Sym(3)", 10))
            np.testing.assert_allclose(made, wanted, atol=3e-6)
