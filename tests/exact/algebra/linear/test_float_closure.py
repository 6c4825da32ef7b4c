"""Closures of matrices over floats end, do not depend on scale and basis, and are right or undecided."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import DependentRowsError, NotClosedError, UndecidedError
from liehom.base.typing import Array
from liehom.exact.algebra.linear.closure import lie_closure
from tests.sampling import examples

scales = st.floats(-12, 12).map(lambda e: 10.0**e)
seeds = st.integers(0, 10_000)


def skew(a: Array) -> Array:
    return a - a.transpose(0, 2, 1)


def hamiltonian(a: Array) -> Array:
    return np.asarray(np.kron([[0.0, 1.0], [-1.0, 0.0]], np.eye(a.shape[1] // 2)) @ (a + a.transpose(0, 2, 1)))


def traceless(a: Array) -> Array:
    n = a.shape[1]
    return a - np.trace(a, axis1=1, axis2=2)[:, None, None] * np.eye(n) / n


FAMILIES = {
    "so": (skew, lambda n: n * (n - 1) // 2),
    "sp": (hamiltonian, lambda n: n * (n + 1) // 2),
    "sl": (traceless, lambda n: n * n - 1),
}


@settings(max_examples=examples(40))
@given(kind=st.sampled_from(sorted(FAMILIES)), n=st.sampled_from([2, 4, 6]), seed=seeds, scale=scales)
def test_generated_algebras_do_not_depend_on_scale_and_orthogonal_basis(
    kind: str, n: int, seed: int, scale: float
) -> None:
    rng = np.random.default_rng(seed)
    make, dimension = FAMILIES[kind]
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0]
    matrices = scale * turn @ make(rng.normal(size=(2, n, n))) @ turn.T
    if (kind, n) == ("so", 2):
        with pytest.raises(DependentRowsError):
            lie_closure(matrices)
        return
    try:
        closure = lie_closure(matrices)
    except UndecidedError:  # seldom: generators that are nearly parallel or commute nearly
        closure = lie_closure(matrices, field=lh.FloatField(1e-14))
    assert closure.algebra.dimension == dimension(n) == len(closure.matrices) == 2 + len(closure.appended)
    assert [np.array_equal(a.to_numpy(), b) for a, b in zip(closure.matrices, matrices, strict=False)] == [True, True]
    assert closure.algebra.is_semisimple()
    for i, j, b in ((0, 1, closure.matrices), (1, dimension(n) - 1, closure.matrices)):
        commutator = b[i].array @ b[j].array - b[j].array @ b[i].array
        bracket = closure.algebra.bracket(np.eye(len(b))[i].tolist(), np.eye(len(b))[j].tolist())
        combination = sum(c * x.array for c, x in zip(bracket, b, strict=True))
        assert np.abs(commutator - combination).max() <= 1e-9 * np.abs(commutator).max(initial=scale * scale)


@pytest.mark.parametrize("n", range(2, 13))
def test_gaussian_pairs_generate_gl(n: int) -> None:
    for seed in range(examples(20) if n < 8 else examples(10) - 4):
        closure = lie_closure(np.random.default_rng(seed).normal(size=(2, n, n))).algebra
        assert closure.dimension == n * n and not closure.is_semisimple()
        assert closure.killing_signature() == (n * (n + 1) // 2 - 1, n * (n - 1) // 2, 1)


def test_pairs_that_kept_the_loop_running_end() -> None:
    matrices = 100 * np.array([[[0, 0.3], [0.7, 0]], [[0.1, 0], [0, -0.2]]])
    assert lh.LieAlgebra.from_matrices(matrices).dimension == 4


@pytest.mark.parametrize("scale", [1e-12, 1e-5, 1.0, 1e12])
def test_small_rotations_generate_so3(scale: float) -> None:
    x, y, z = (scale * a.to_numpy() for a in lh.defining(lh.so(3)).matrices)
    g = lh.LieAlgebra.from_matrices([x, y])
    assert g.dimension == 3 and g.killing_signature() == (0, 3, 0)
    assert lh.LieAlgebra.from_matrices([x, 30 * y, z]).killing_signature() == (0, 3, 0)
    assert lie_closure([x], close=False).algebra.is_abelian()
    with pytest.raises(NotClosedError, match="0 and 1"):
        lie_closure([x, y], close=False)
    with pytest.raises(NotClosedError, match="more than 2"):
        lie_closure([x, y], limit=2)
    with pytest.raises(DependentRowsError, match=r"number.s. 1"):
        lie_closure([x, -2 * x])
    assert lie_closure([x, -2 * x, 0 * x, y], independent=True).kept == (0, 3)


def test_a_commutator_near_the_tolerance_is_undecided() -> None:
    x, y, z = (a.to_numpy() for a in lh.defining(lh.so(3)).matrices)
    wide = [scipy.linalg.block_diag(a, b) for a, b in ((x, 0 * x), (y, 0 * x), (z, 0 * x))]
    for size, dimension in ((1e-13, 3), (1e-3, 4)):
        moved = [wide[0], wide[1], wide[2] + size * scipy.linalg.block_diag(0 * x, x)]
        assert lie_closure(moved).algebra.dimension == dimension
    with pytest.raises(UndecidedError, match=r"residual is .*e-0.*FloatField"):
        lie_closure([wide[0], wide[1], wide[2] + 2e-8 * scipy.linalg.block_diag(0 * x, x)])


def test_matrices_of_very_different_norms_are_refused() -> None:
    x, y = (a.to_numpy() for a in lh.defining(lh.so(3)).matrices[:2])
    with pytest.raises(UndecidedError, match="divide the matrices by their norms"):
        lie_closure([x, 1e4 * y])


def test_an_ill_conditioned_basis_is_undecided_at_the_default_and_right_at_a_smaller_tolerance() -> None:
    rng = np.random.default_rng(0)
    matrices, change = skew(rng.normal(size=(2, 8, 8))), rng.normal(size=(8, 8))
    matrices = change @ matrices @ np.linalg.inv(change)
    with pytest.raises(UndecidedError):
        lie_closure(matrices)
    assert lie_closure(matrices, field=lh.FloatField(1e-14)).algebra.dimension == 28
