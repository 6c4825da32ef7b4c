"""Where the range condition fails: the residual is reported, the order stays, and nothing more is corrected."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps.order_conditions import order_condition
from tests.flow.steps.support import exact_flow, one_step, quadratic, run, slopes, spin


def two_spins() -> lh.Representation:
    """so(3) + so(3) on R^3 + R^3."""
    blocks = []
    for place in (0, 3):
        for a in spin().matrices:
            block = np.zeros((6, 6))
            block[place : place + 3, place : place + 3] = a.to_numpy()
            blocks.append(block.astype(int).tolist())
    return lh.Representation.from_matrices(blocks)


def planes() -> lh.Representation:
    """so(4) on bivectors: the orbit of a decomposable one is the Grassmannian of oriented planes, S^2 x S^2."""
    return lh.defining(lh.so(4)).exterior_power(2)


def flags() -> lh.Representation:
    """su(3) on itself: generic adjoint orbits are SU(3)/T, of dimension 6."""
    return lh.adjoint(lh.su(3))


def _regular(rho: lh.Representation) -> Any:
    return np.random.default_rng(0).normal(size=rho.size)


CASES: dict[str, tuple[lh.Representation, Any, int, int]] = {
    # representation, point, dimension of the orbit, rank of [rho(g_m) w, w] for generic w
    "Sym(3) at (1,2,3)": (lh.sym_conjugation(3), np.array([1.0, 0, 0, 2.0, 0, 3.0]), 3, 1),
    "Gr(2,4)": (planes(), np.array([1.0, 0, 0, 0, 0, 0]), 4, 3),
    "SU(3)/T": (flags(), _regular(flags()), 6, 3),
    "two spins": (two_spins(), np.array([0.6, 0, 0.8, 0, 1.0, 0]), 4, 3),
}


@pytest.mark.parametrize("base", [lh.Euler(), lh.Heun()], ids=str)
@pytest.mark.parametrize("name", list(CASES))
def test_the_residual_is_reported_and_the_order_stays(name: str, base: Any) -> None:
    rho, m, dimension, rank = CASES[name]
    field = quadratic(rho, 3, 0.1)
    raised = lh.steps.correction(field, base, m, base.order + 3)
    assert int(raised.rank) == rank < dimension
    assert float(raised.singular_value) < 1e-12
    assert 1e-3 < float(raised.residual) <= 1
    assert int(raised.reached) == base.order
    # only the first level was corrected, in least squares
    assert [k for k, x in enumerate(raised.zeta) if x is not None and np.any(x != 0)] in ([base.order], [])
    assert all(x is None or np.all(x == 0) for x in raised.clock[base.order + 2 :])
    assert raised.defects[0][0] == base.order + 1 and raised.defects[0][1] > 0
    condition = order_condition(field, base, m, base.order + 1)
    assert not condition and not condition.range_holds
    assert (condition.rank, condition.dimension) == (rank, dimension)
    assert np.isclose(np.linalg.norm(condition.residual), raised.defects[0][1])
    assert condition.numerical is not None and condition.numerical.gap > 1e8


@pytest.mark.parametrize("name", list(CASES))
def test_the_observed_order_is_that_of_the_base(name: str) -> None:
    rho, m, *_ = CASES[name]
    field = quadratic(rho, 3, 0.1)
    errors = []
    for count in (40, 80):
        z, t = run(field, lh.Corrected(lh.Euler(), 3), m, 1.0 / count, count)
        errors.append(np.linalg.norm(z - exact_flow(field, m, t, steps=10)))
    assert 0.7 < slopes([2, 1], errors)[0] < 1.4, errors


def test_least_squares_are_the_least() -> None:
    """No zeta in g_m and no c leave less than the residual."""
    rho, m, *_ = CASES["two spins"]
    field = quadratic(rho, 3, 0.1)
    condition = order_condition(field, lh.Euler(), m, 2)
    action = lh.Action(rho)
    basis = action.isotropy_frame(m, 4).basis
    w = field.vector(m)
    columns = np.array([action.infinitesimal(x, w) / 2 for x in basis.T] + [-w]).T
    right = -condition.chi / 2
    best = np.linalg.lstsq(columns, right, rcond=1e-10)
    assert np.isclose(np.linalg.norm(right - columns @ best[0]), np.linalg.norm(condition.residual), rtol=1e-12)


def test_uncoupled_spins_can_be_raised_by_chance() -> None:
    """The range condition fails for two spins, yet (5.5) holds for this step: equal spins need equal clocks."""
    rho = two_spins()
    inertia = np.array([1.0, 0.5, 0.25])

    def psi(m: Any) -> Any:
        first, second = m[..., :3], m[..., 3:]
        return np.concatenate([-first * inertia, -second * inertia], axis=-1)

    field, m = lh.GeneratorField(rho, psi), np.array([0.6, 0.48, 0.64, 0.6, 0.48, 0.64])
    condition = order_condition(field, lh.Euler(), m, 2)
    assert condition.solvable and not condition.range_holds
    assert "(5.5) holds for this step" in str(condition) and "does not hold for every step (rank 3 of 4)" in str(
        condition
    )
    assert int(lh.steps.correction(field, lh.Euler(), m, 4).reached) == 4
    other = np.array([0.6, 0.48, 0.64, 0.48, 0.6, 0.64])
    assert not order_condition(field, lh.Euler(), other, 2).solvable
    assert int(lh.steps.correction(field, lh.Euler(), other, 4).reached) == 1


def test_solvable_and_not_in_one_ensemble() -> None:
    """Sym(3): eigenvalues (1,1,2) and (1,2,3), orbits of dimension 2 and 3."""
    field = quadratic(lh.sym_conjugation(3), 3, 0.1)
    m = np.array([[1.0, 0, 0, 1.0, 0, 2.0], [1.0, 0, 0, 2.0, 0, 3.0], [2.0, 0, 0, 1.0, 0, 1.0]])
    raised = lh.steps.correction(field, lh.Euler(), m, 4)
    assert raised.reached.tolist() == [4, 1, 4] and raised.rank.tolist() == [2, 1, 2]
    assert (raised.singular_value > 0.1).tolist() == [True, False, True]
    z, _ = one_step(field, lh.Corrected(lh.Euler(), 4), m, 0.1)
    for i in range(3):
        alone = one_step(field, lh.Corrected(lh.Euler(), 4), m[i], 0.1)[0]
        assert np.allclose(z[i], alone, rtol=0, atol=2e-15)
