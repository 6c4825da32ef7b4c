"""exp on blocks of coordinates: against the matrix exponential, in every kind of array, and where it is not taken."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.exponential import BlockExponential, MatrixExponential, default_exponential
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from tests.flow.action.support import representation


def rows_and_shift() -> lh.Representation:
    """so(3) on three rows of R^3 and translations of R^3, in homogeneous coordinates."""
    turns = [np.kron(np.eye(3), a.to_numpy()) for a in lh.defining(lh.so(3)).matrices]
    made = np.zeros((6, 13, 13), dtype=int)
    made[:3, :9, :9] = turns
    for i in range(3):
        made[3 + i, 9 + i, 12] = 1
    return lh.Representation(lh.direct_sum(lh.so(3), lh.abelian(3)), made)


def scrambled() -> lh.Representation:
    """The same with the coordinates in another order, so that results are sorted back."""
    order = np.random.default_rng(0).permutation(13)
    rho = rows_and_shift()
    return lh.Representation(rho.algebra, [a.to_numpy().astype(int)[np.ix_(order, order)] for a in rho.matrices])


def two_rates() -> lh.Representation:
    """Two planes in which one generator turns at different rates: two blocks with forms of their own, one fixed."""
    turn = np.zeros((5, 5), dtype=int)
    turn[0, 1], turn[1, 0], turn[3, 4], turn[4, 3] = -1, 1, -2, 2
    return lh.Representation(lh.abelian(1), [turn])


def poses() -> lh.Representation:
    """Three copies of se(3) on R^4, on which the fourth power is needed, and a plane."""
    rho = representation("e(3)").dual()
    made = np.zeros((7, 14, 14), dtype=int)
    made[:6, :12, :12] = [np.kron(np.eye(3), a.to_numpy()) for a in rho.matrices]
    made[6, 12, 13], made[6, 13, 12] = -1, 1
    return lh.Representation(lh.direct_sum(rho.algebra, lh.abelian(1)), made)


BUILDERS = {"rows": rows_and_shift, "scrambled": scrambled, "rates": two_rates, "poses": poses}


@pytest.mark.parametrize("name", BUILDERS)
@pytest.mark.parametrize("size", [1e-9, 1e-2, 0.03, 1.0, 3.1, 8.0])
def test_blocks_give_the_matrix_exponential(name: str, size: float) -> None:
    rho = BUILDERS[name]()
    exp = default_exponential(rho)
    assert isinstance(exp, BlockExponential)
    rng = np.random.default_rng(1)
    x, m = size * rng.normal(size=(2, 5, rho.algebra.dimension)), rng.normal(size=(2, 5, rho.size))
    wanted = MatrixExponential(rho)(x, m)
    np.testing.assert_allclose(exp(x, m), wanted, rtol=0, atol=3e-14 * (1 + size) ** 2)
    np.testing.assert_allclose(exp(x[0, 0], m[0, 0]), wanted[0, 0], rtol=0, atol=3e-14 * (1 + size) ** 2)
    wide = exp(x.astype(np.longdouble), m.astype(np.longdouble))
    assert wide.dtype == np.longdouble
    exact = MatrixExponential(rho)(x.astype(np.longdouble), m.astype(np.longdouble))
    np.testing.assert_allclose(np.asarray(wide - exact, dtype=float), 0, atol=2e-17 * (1 + size) ** 2)


@pytest.mark.parametrize("name", BUILDERS)
def test_small_increments_keep_their_digits(name: str) -> None:
    """exp(x) m - m to round-off of the increment, which a matrix exponential does not give."""
    rho = BUILDERS[name]()
    x, m = np.full(rho.algebra.dimension, 1e-9), np.zeros(rho.size)
    moved = default_exponential(rho)(x, m + 1.0) - 1.0
    np.testing.assert_allclose(moved, lh.Action(rho).infinitesimal(x, m + 1.0), rtol=0, atol=3e-16)


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILDERS)
def test_jax_arrays_give_the_same(name: str) -> None:
    jax = pytest.importorskip("jax")
    rho = BUILDERS[name]()
    exp, rng = default_exponential(rho), np.random.default_rng(2)
    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
        for size in (0.0, 1e-3, 1.0):
            x, m = size * rng.normal(size=rho.algebra.dimension), rng.normal(size=rho.size)
            made = jax.jit(exp.act)(jax.numpy.asarray(x), jax.numpy.asarray(m))
            np.testing.assert_allclose(np.asarray(made), exp(x, m), rtol=0, atol=1e-14)
            slope = jax.jacfwd(lambda x: exp.act(x, m))(jax.numpy.asarray(x))  # noqa: B023
            assert bool(np.isfinite(np.asarray(slope)).all())


@pytest.mark.parametrize("name", BUILDERS)
def test_traced_arrays_need_no_series(name: str) -> None:
    rho, tape = BUILDERS[name](), Tape()
    exp = default_exponential(rho)
    traced = exp(Traced.inputs(tape, 0, rho.algebra.dimension), Traced.inputs(tape, 20, rho.size))
    assert not any(e.op == "expv" for e in tape.recorded)
    assert traced.shape == (rho.size,)


@pytest.mark.parametrize("engine", ["llvm", "jax"])
def test_compiled_steps_agree(engine: str) -> None:
    pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    field = lh.GeneratorField(poses(), lambda m: np.stack([0.3 * m[..., i] for i in range(7)], axis=-1))
    start = np.random.default_rng(3).normal(size=(4, 14))
    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.05, "t_eval": [1.0]}
    wanted = lh.integrate(field, (0, 1), start, **options)
    made = lh.integrate(field, (0, 1), start, engine=engine, **options)
    np.testing.assert_allclose(made.y, wanted.y, rtol=0, atol=1e-12)


def test_a_block_without_closed_form_leaves_the_series() -> None:
    rho = lh.Representation(
        lh.direct_sum(lh.so(4), lh.abelian(1)),
        [np.pad(a.to_numpy().astype(int), (0, 2)) for a in lh.defining(lh.so(4)).matrices]
        + [np.pad([[0, -1], [1, 0]], (4, 0))],
    )
    assert default_exponential(rho).name == "exp (series)"
