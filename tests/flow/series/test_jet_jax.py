"""Jets over JAX arrays: numpy functions call their twins, also inside jit, grad and vmap."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from liehom.base.errors import SeriesError
from liehom.flow.series.arrays import is_jax
from liehom.flow.series.jet import Jet, as_jet
from liehom.flow.series.lie_series import (
    Bilinear,
    bch,
    cayley_magnus,
    commutator,
    dexp,
    dexp_inverse,
    exp_series,
    log_series,
    magnus,
    without_constant,
)
from liehom.flow.series.node import FUNCTIONS


@pytest.fixture(autouse=True)
def doubles() -> Any:
    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
        yield


POINTS = {"arccosh": 1.7}
Q = np.random.default_rng(0).normal(size=(3, 3, 3))
TERMS = np.random.default_rng(1).normal(size=(4, 3)) * 0.3 + [[1.0], [0], [0], [0]]


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_elementary_functions(name: str) -> None:
    terms = np.array([POINTS.get(name, 0.3), 0.7, -0.3, 0.1])
    found = getattr(np, name)(Jet(jnp.asarray(terms)))
    assert is_jax(found.value) and is_jax(found.coefficient(2))
    np.testing.assert_allclose(found.coefficients, getattr(np, name)(Jet(terms)).coefficients, rtol=1e-12, atol=1e-13)


PSI = {
    "einsum": lambda m: np.einsum("aij,...i,...j->...a", Q, m, m),
    "stack": lambda m: np.stack([m[..., 1] * m[..., 2], 0.5 * m[..., 0], np.sin(m[..., 0])], axis=-1),
    "list": lambda m: as_jet([m[1] * m[2], 0.5, np.sin(m[0])]),
    "objects": lambda m: as_jet(np.array([m[1] * m[2], 0.5, np.sin(m[0])], dtype=object)),
    "unit": lambda m: m / np.linalg.norm(m, axis=-1, keepdims=True),
    "assigned": lambda m: assigned(m),
    "matmul": lambda m: Q[0] @ m + m @ Q[1],
    "cross": lambda m: np.cross(m, [1.0, 2.0, 3.0]) + np.cross(Q[0, 0], m),
    "dot": lambda m: np.dot(m, m) * m - np.vdot(m, m) + np.tensordot(Q, m, 1)[0],
    "quotient": lambda m: 1 / m + m / (1 + m[::-1]) - 2,
    "powers": lambda m: m**3 + m**-2 + m**0.5 + 2 ** m[0] + m**m,
    "where": lambda m: np.where([True, False, True], m, 1.0),
    "joined": lambda m: np.concatenate([m, [0.0], np.ones(2)]) * np.hstack([m, m]),
    "shapes": lambda m: np.moveaxis(m[None, :, None], 1, 0).reshape(3).T + m.sum() + np.mean(m) + np.prod(m),
    "solve": lambda m: np.linalg.solve(np.diag(m) + Q[0], m) + np.linalg.inv(np.diag(m))[0],
    "det": lambda m: np.linalg.det(np.diag(m) + Q[0]) * m,
    "hypot": lambda m: np.hypot(m[0], m[1]) * np.arctan2(m[1], m[0]) + np.logaddexp(m, 1.0),
    "in place": lambda m: in_place(m),
    "fancy": lambda m: m[[0, 2]] * m[np.array([False, True, True])],
    "conjugate": lambda m: np.conj(m) * np.radians(m) + np.real(m) + np.exp2(m),
    "sums": lambda m: sum(m) * m + np.cumsum(m) + np.roll(m, 1) + np.flip(m),
    "jax constant": lambda m: jnp.asarray(Q[0]) @ m * jnp.asarray(2.0) + m * jnp.ones(3) - jnp.ones(3) * m,
}  # fmt: skip


def assigned(m: Any) -> Any:
    out = np.zeros_like(m)
    out[..., 0] = m[..., 1] * m[..., 2]
    out[..., 1] = 1.0
    return out


def in_place(m: Any) -> Any:
    x = m * 2
    x += m
    x[1:] *= m[0]
    return x


@pytest.mark.parametrize("name", PSI)
def test_programs_run_on_jax_values(name: str) -> None:
    found, expected = PSI[name](Jet(jnp.asarray(TERMS))), PSI[name](Jet(TERMS))
    assert is_jax(found.value) and found.dtype == expected.dtype
    np.testing.assert_allclose(found.coefficients, expected.coefficients, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", PSI)
def test_programs_run_inside_jit_and_grad(name: str) -> None:
    """The last coefficient of psi along a line, and its derivative by the starting point."""

    def last(m: Any, v: Any) -> Any:
        return jnp.sum(PSI[name](Jet.variable(m, 3, v)).coefficient(3) ** 2)

    last = jax.jit(last)
    m, v = TERMS[0], TERMS[1]
    expected = float(np.sum(np.asarray(PSI[name](Jet.variable(m, 3, v)).coefficient(3)) ** 2))
    np.testing.assert_allclose(last(m, v), expected, rtol=1e-9, atol=1e-12)
    slope = jax.jit(jax.grad(last))(jnp.asarray(m), v)
    h = 1e-6
    for i, e in enumerate(np.eye(3)):
        difference = (last(jnp.asarray(m + h * e), v) - last(jnp.asarray(m - h * e), v)) / (2 * h)
        np.testing.assert_allclose(slope[i], difference, rtol=1e-4, atol=1e-5)


def test_vmap_is_leading_axes() -> None:
    batch = np.random.default_rng(2).normal(size=(5, 3))

    def second(m: Any) -> Any:
        return PSI["einsum"](Jet.variable(m, 2)).coefficient(2)

    np.testing.assert_allclose(jax.vmap(second)(batch), second(batch), rtol=1e-12)


def test_single_precision_and_whole_numbers() -> None:
    m = Jet(jnp.asarray(TERMS, dtype=jnp.float32))
    for function in (lambda m: 2 * m + 1, lambda m: m**0.5, lambda m: 0.5 / m, lambda m: np.exp(m) / 3):
        assert function(m).dtype == np.float32
        assert function(m).coefficient(2).dtype == np.float32
    assert Jet(jnp.arange(3)).dtype.kind == "f"


def test_an_index_out_of_range_is_an_error() -> None:
    m = Jet(jnp.asarray(TERMS))
    with pytest.raises(IndexError):
        m[5]
    x, y, z = m
    assert (x + y + z).shape == ()


def test_functions_of_jax_refuse_series() -> None:
    m = Jet(jnp.asarray(TERMS))
    for function in (jnp.sin, jnp.sum, jnp.linalg.norm, lambda m: jnp.stack([m, m]), lambda m: jnp.dot(m, m)):
        with pytest.raises((TypeError, SeriesError, ValueError)):
            function(m)
    with pytest.raises(SeriesError):
        np.abs(m)


CROSS = [
    (i, j, k, float(np.cross(np.eye(3)[i], np.eye(3)[j])[k])) for i in range(3) for j in range(3) for k in range(3)
]


@pytest.mark.parametrize("size", [3, 40])
def test_bilinear_maps(size: int) -> None:
    bilinear = Bilinear([entry for entry in CROSS if entry[3]], (size, size, size))
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(2, 4, size))
    for a, b in ((jnp.asarray(x), jnp.asarray(y)), (x, jnp.asarray(y)), (jnp.asarray(x), y)):
        found = bilinear(a, b)
        assert is_jax(found)
        np.testing.assert_allclose(found, bilinear(x, y), rtol=1e-13)
    np.testing.assert_allclose(jax.jit(bilinear)(x, y), bilinear(x, y), rtol=1e-13)
    np.testing.assert_allclose(bilinear.left(jnp.asarray(x)), bilinear.left(x))
    assert bilinear(jnp.asarray(x, dtype=jnp.float32), jnp.asarray(y, dtype=jnp.float32)).dtype == np.float32
    jets = Jet(jnp.asarray(rng.normal(size=(3, size))))
    np.testing.assert_allclose(
        bilinear(jets, jets * 2 + 1).coefficients,
        bilinear(Jet(np.asarray(jets.coefficients)), Jet(np.asarray((jets * 2 + 1).coefficients))).coefficients,
        atol=1e-13,
    )


def test_series_in_lie_algebras() -> None:
    terms = np.random.default_rng(4).normal(size=(5, 3, 3))
    bracket = Bilinear([entry for entry in CROSS if entry[3]], (3, 3, 3))

    def every(terms: Any) -> list[Any]:
        a = Jet(terms)
        x = without_constant(a)
        return [
            magnus(commutator, a).coefficients, magnus(bracket, a[0]).coefficients, cayley_magnus(a).coefficients,
            exp_series(x).coefficients, log_series(exp_series(x)).coefficients, bch(commutator, x, x.T).coefficients,
            bch(bracket, terms[0, 0], terms[1, 1], 6).coefficients, dexp(bracket, terms[0, 0], terms[1, 1], 9),
            dexp_inverse(commutator, x, a).coefficients,
        ]  # fmt: skip

    for found, traced, expected in zip(every(jnp.asarray(terms)), jax.jit(every)(terms), every(terms), strict=True):
        assert is_jax(found)
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(traced, expected, rtol=1e-10, atol=1e-10)


def test_traced_constant_terms_are_refused_with_advice() -> None:
    with pytest.raises(SeriesError, match="without_constant"):
        jax.jit(lambda v: exp_series(Jet(v)).coefficients)(np.zeros((3, 2, 2)))


def test_growing_series_inside_jit() -> None:
    def exponential(start: Any) -> Any:
        y = Jet.growing(start, 6)
        slope = np.einsum("ij,j->i", np.eye(2), y)
        for k in range(6):
            y.extend(slope.coefficient(k) / (k + 1))
        y.replace(6, 0 * y.coefficient(6))
        return y.coefficients

    found = jax.jit(exponential)(np.ones(2))
    np.testing.assert_allclose(found[:, 0], [1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 0], rtol=1e-12)
