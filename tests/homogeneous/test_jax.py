"""Exponentials, fields and frames on JAX arrays, also under jit and grad."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import liehom as lh
from liehom.errors import InputError
from liehom.homogeneous import exponential_of
from liehom.homogeneous.field import check_point
from tests.homogeneous.support import matrices, representation, vectors


@pytest.fixture(autouse=True)
def double_precision() -> Any:
    with jax.enable_x64(True):
        yield


NAMES = ["so(3)", "Sym(3)", "so(3,1)", "g2", "so(4) scrambled", "QQ(sqrt 2)"]


def exponentials(name: str) -> list[str]:
    return ["exp", "series", "expm"] if name == "g2" else ["exp", "series", "expm", "cayley"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("lead", [(), (3, 2)])
def test_exponentials_agree_with_those_on_numpy_arrays(name: str, lead: tuple[int, ...]) -> None:
    x, m = vectors(name, 1, lead)
    for which in exponentials(name):
        exp = exponential_of(representation(name), which)
        wanted = exp(x, m)
        for made in (exp(jnp.asarray(x), jnp.asarray(m)), jax.jit(exp.__call__)(x, m)):
            assert isinstance(made, jax.Array) and made.dtype == np.float64
            np.testing.assert_allclose(made, wanted, rtol=1e-12, atol=1e-13, err_msg=which)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)"])
@pytest.mark.parametrize("size", [1e-300, 1e-3, 30.0, 1e3])
def test_arguments_of_all_sizes(name: str, size: float) -> None:
    x, m = vectors(name, 2, (4,), size)
    for which in exponentials(name):
        exp = exponential_of(representation(name), which)
        np.testing.assert_allclose(jax.jit(exp.__call__)(x, m), exp(x, m), rtol=0, atol=3e-15 * max(100.0, size))
    series = exponential_of(representation(name), "series")
    assert np.isnan(series(1e9 * jnp.asarray(x), jnp.asarray(m))).all() or size < 1e-5


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(3,1)"])
def test_gradients_against_differences(name: str) -> None:
    x, m = vectors(name, 3)
    for which in exponentials(name):
        exp = exponential_of(representation(name), which)

        def height(x: Any, exp: Any = exp) -> Any:
            return exp(x, m)[0]

        made = jax.grad(height)(jnp.asarray(x))
        h = 1e-5
        wanted = [(height(x + h * e) - height(x - h * e)) / (2 * h) for e in np.eye(len(x))]
        np.testing.assert_allclose(made, wanted, rtol=1e-7, atol=1e-8)
        at_zero = jax.grad(height)(jnp.zeros(len(x)))
        np.testing.assert_allclose(at_zero, (matrices(name) @ m)[:, 0], atol=1e-13)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)"])
def test_series_on_jax_arrays(name: str) -> None:
    x, m = vectors(name, 4, (2,))
    for which in exponentials(name):
        exp = exponential_of(representation(name), which)

        def coefficients(x: Any, m: Any, exp: Any = exp) -> Any:
            curve = lh.Jet.growing(0 * x, 3, zero=True)
            curve.extend(x)
            curve.extend(x * x)
            curve.extend(None)
            return exp(curve, m).coefficients

        wanted = coefficients(x, m)
        np.testing.assert_allclose(coefficients(jnp.asarray(x), jnp.asarray(m)), wanted, atol=1e-13)
        np.testing.assert_allclose(jax.jit(coefficients)(x, m), wanted, atol=1e-13)


FORMS = [
    ["m0*m1", "sin(m0) + 1/3", "2"],
    lambda m: np.stack([m[..., 0] * m[..., 1], np.sin(m[..., 0]) + 1 / 3, 2 + 0 * m[..., 0]], axis=-1),
    lambda m: [m[..., 0] * m[..., 1], np.sin(m[..., 0]) + 1 / 3, 2],
    np.array([1.0, 2.0, 3.0]),
    [1, 2, 3],
]


@pytest.mark.parametrize("psi", FORMS)
def test_generators(psi: Any) -> None:
    field = lh.GeneratorField(representation("so(3)"), psi)
    _, m = vectors("so(3)", 5, (4,))
    for points in (m, m[0]):
        np.testing.assert_allclose(field.psi(jnp.asarray(points)), field.psi(points), rtol=1e-14)
        np.testing.assert_allclose(jax.jit(field.psi)(points), field.psi(points), rtol=1e-14)
        np.testing.assert_allclose(jax.jit(field.vector)(points), field.vector(points), rtol=1e-13, atol=1e-14)
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
    wanted = field.psi(m)
    np.testing.assert_allclose(field.psi(jnp.asarray(m)), wanted, atol=1e-12)
    np.testing.assert_allclose(jax.jit(field.psi)(m), wanted, atol=1e-12)
    flow = jax.jit(lambda m: lh.flow_series(field, m, 4).points.coefficients)
    np.testing.assert_allclose(flow(m), lh.flow_series(field, m, 4).points.coefficients, rtol=1e-8, atol=1e-8)


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


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(5)", "so(3) tensor"])
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
        for which in exponentials("Sym(3)"):
            made = exponential_of(representation("Sym(3)"), which)(x, m)
            assert made.dtype == np.float32
            wanted = exponential_of(representation("Sym(3)"), which)(*vectors("Sym(3)", 10))
            np.testing.assert_allclose(made, wanted, atol=3e-6)
