"""At, next to and between equilibria: nothing overflows, corrections stay bounded, equilibria stay where they are.

Warnings are errors, so that no test has to look for divisions by zero.
"""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.field import check_point
from liehom.flow.steps.expansion import flow_series, leading_order
from tests.flow.steps.support import OMEGA, exact_flow, one_step, quadratic, rigid_body, run, spin, unit

BASES = [lh.Euler(), lh.BackwardEuler(), lh.Heun(), lh.LieTaylor(3)]
SPREAD = OMEGA[0] - OMEGA[2]  # 1/I_1 - 1/I_3
DISTANCES = [1e-1, 1e-3, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 3e-14, 1e-14, 1e-15, 1e-16, 1e-30, 1e-300, 5e-324, 0.0]


def turn() -> Any:
    """A rotation without special directions, so that coordinates do not vanish by themselves."""
    q = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    return q * np.sign(np.linalg.det(q))


def turned_body(shift: float) -> lh.GeneratorField:
    q = turn()
    s = q @ np.diag(OMEGA) @ q.T

    def psi(m: Any) -> Any:
        om = m @ s
        return -om + (np.sum(m * om, axis=-1, keepdims=True) + shift) * m

    return lh.GeneratorField(spin(), psi)


def around(distance: float, count: int, seed: int = 0) -> Any:
    """Unit vectors at a distance from the six equilibria of the turned body, shape (6, count, 3)."""
    axes = np.concatenate([turn().T, -turn().T])[:, None]
    v = np.random.default_rng(seed).normal(size=(6, count, 3))
    v -= np.sum(v * axes, axis=-1, keepdims=True) * axes
    m = axes + distance * v / np.linalg.norm(v, axis=-1, keepdims=True)
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("shift", [0.0, -1.0, 5.0])
def test_corrections_are_bounded_next_to_equilibria(shift: float, distance: float) -> None:
    """|sigma_i| <= 1/I_1 - 1/I_3, and the clock stays near the identity for steps up to 1."""
    raised = lh.steps.correction(turned_body(shift), lh.Euler(), around(distance, 200), 6)
    assert (raised.reached == 6).all()
    sigma = 0.0 if raised.zeta[1] is None else np.abs(np.linalg.norm(raised.zeta[1], axis=-1)).max()
    assert sigma <= SPREAD + abs(shift) + 1e-3 / 2  # Euler's own isotropy is shifted away
    for k in range(2, 6):
        assert raised.zeta[k] is None or np.abs(raised.zeta[k]).max() < 1
    for h in (0.1, 0.5, 1.0):
        assert (raised.time(h) / h).min() > 0.5 and (raised.time(h) / h).max() < 1.5
    if distance < 1e-14:
        assert (raised.leading == 0).all() and (raised.singular_value == np.inf).all()
    if distance > 1e-12:
        assert (raised.leading == 1).all() and (raised.rank == 2).all()


def test_sigma_is_the_bounded_function_of_the_paper() -> None:
    """R - h with R a Rayleigh quotient; next to m -> e_3 with m_1 = 0 it approaches 1/I_1 - 1/I_3 in size."""
    angles = np.array([1e-1, 1e-3, 1e-6])
    m = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1)
    sigma = np.sum(lh.steps.correction(rigid_body(), lh.Euler(), m, 2).zeta[1] * m, axis=-1)
    x = np.cross(m, OMEGA * m)
    wanted = np.sum(x * OMEGA * x, axis=-1) / np.sum(x * x, axis=-1) - np.sum(m * OMEGA * m, axis=-1)
    assert np.allclose(sigma, wanted, rtol=1e-9)
    assert np.all(np.abs(sigma) <= SPREAD)


@pytest.mark.parametrize("base", BASES, ids=str)
def test_equilibria_are_fixed_points(base: Any) -> None:
    m = np.concatenate([np.eye(3), -np.eye(3)])
    for field in (rigid_body(), rigid_body(shift=3.0)):
        z, tau = one_step(field, lh.Corrected(base, 6), m, 0.5)
        assert np.array_equal(z, m) and np.array_equal(tau, np.full(6, 0.5))
    z, tau = one_step(turned_body(0.0), lh.Corrected(base, 6), around(0.0, 1), 0.5)
    assert np.abs(z - around(0.0, 1)).max() < 1e-15 and np.all(tau == 0.5)


@pytest.mark.parametrize("distance", [1e-3, 1e-8, 1e-12, 1e-14, 1e-16])
def test_points_next_to_equilibria_move_as_the_flow_does(distance: float) -> None:
    field, m = turned_body(0.0), around(distance, 5)
    z, t = run(field, lh.Corrected(lh.Euler(), 6), m, 0.1, 20)
    away = np.linalg.norm(z - exact_flow(field, m, t, steps=10), axis=-1).max()
    assert away < 1e-8 * distance + 1e-13
    assert np.abs(np.linalg.norm(z, axis=-1) - 1).max() < 1e-14


def test_on_a_separatrix() -> None:
    """sigma_i = 0 there: Euler's step with the orthogonal generator stays on it, and so do all corrected ones."""
    w1, w2, w3 = OMEGA
    slope = np.sqrt((w1 - w2) / (w2 - w3))  # h = w2: m_3 = slope m_1
    m1 = np.array([0.55, 0.3, 1e-2, 1e-5, 1e-9, 1e-13, 1e-15])
    m = np.stack([m1, np.sqrt(1 - m1**2 * (1 + slope**2)), slope * m1], axis=-1)
    field = rigid_body()
    sigma = np.linalg.norm(lh.steps.correction(field, lh.Euler(), m, 6).zeta[1], axis=-1)
    assert np.all(sigma[m1 > 1e-4] < 1e-7) and np.all(sigma <= SPREAD)
    z, t = run(field, lh.Corrected(lh.Euler(), 6), m[:5], 0.1, 30)
    assert np.abs(np.sum(z * OMEGA * z, axis=-1) - w2).max() < 1e-7
    assert np.all(np.isfinite(t)) and np.all(t > 0)


def test_an_ensemble_with_equilibria() -> None:
    field = rigid_body()
    m = np.array([[0.0, 0, 1.0], [0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [0.36, 0.48, 0.8], [1e-20, 0.0, 1.0]])
    raised = lh.steps.correction(field, lh.Euler(), m, 5)
    assert raised.leading.tolist() == [0, 1, 0, 1, 0]
    assert raised.rank.tolist() == [0, 2, 0, 2, 0]
    for i in (1, 3):
        alone = lh.steps.correction(field, lh.Euler(), m[i], 5)
        for k in range(1, 5):
            assert np.allclose(raised.zeta[k][i], alone.zeta[k], rtol=1e-14, atol=1e-15)
    for k in range(1, 5):
        assert np.all(raised.zeta[k][[0, 2, 4]] == 0) and np.all(raised.clock[k + 1][[0, 2, 4]] == 0)


@pytest.mark.parametrize("size", [1e-5, 1e-100, 1e-160, 1e-200, 1e-300, 1e-310, 5e-324, 0.0])
def test_tiny_and_vanishing_fields(size: float) -> None:
    field, m = lh.GeneratorField(spin(), lambda m: size * (m * OMEGA + [0.1, 0.2, 0.3])), unit(3, 4, 3)
    raised = lh.steps.correction(field, lh.Euler(), m, 5)
    assert (raised.reached == 5).all()
    for x in [*raised.zeta, *raised.clock]:
        assert x is None or (np.isfinite(x).all() and np.abs(x).max() < 2)
    z, tau = one_step(field, lh.Corrected(lh.Euler(), 5), m, 0.1)
    assert np.abs(z - exact_flow(field, m, tau, steps=1)).max() < 1e-15


@pytest.mark.parametrize("size", [1e-138, 1e-20, 1e20, 1e138])
def test_tiny_and_huge_orbits(size: float) -> None:
    """The action is linear: the sphere of any radius."""
    m = unit(3, 4, 3)
    one = lh.steps.correction(lh.GeneratorField(spin(), lambda m: m * OMEGA), lh.Euler(), m, 4)
    other = lh.steps.correction(lh.GeneratorField(spin(), lambda m: m / size * OMEGA), lh.Euler(), size * m, 4)
    for a, b in zip([*one.zeta, *one.clock], [*other.zeta, *other.clock], strict=True):
        assert (a is None) == (b is None)
        assert a is None or np.allclose(a, b, rtol=1e-11, atol=1e-13)


def test_huge_rates() -> None:
    """Time in other units: zeta_k and c_k scale."""
    m = unit(3, 4, 3)
    one = lh.steps.correction(rigid_body(), lh.Euler(), m, 4)
    other = lh.steps.correction(rigid_body(omega=1e9 * OMEGA), lh.Euler(), m, 4)
    for k in range(1, 4):
        assert np.allclose(other.zeta[k] * 1e-9**k, one.zeta[k], rtol=1e-9, atol=1e-12)
        assert np.allclose(other.clock[k + 1] * 1e-9**k, one.clock[k + 1], rtol=1e-9, atol=1e-12)


def test_a_generator_in_the_isotropy_moves_nothing() -> None:
    field, m = lh.GeneratorField(spin(), lambda m: 7.0 * m), unit(3, 50, 3)
    raised = lh.steps.correction(field, lh.Euler(), m, 6)
    assert (raised.leading == 0).all() and (raised.residual == 0).all()
    assert np.abs(one_step(field, lh.Corrected(lh.Euler(), 6), m, 0.3)[0] - m).max() < 1e-15


def test_a_steep_field_is_no_equilibrium() -> None:
    """Large derivatives of psi do not make a point that moves an equilibrium."""
    field = lh.GeneratorField(spin(), lambda m: np.sin(1e6 * m))
    m = unit(3, 200, 3)
    assert (leading_order(flow_series(field, m, 2), 2) == 1).all()


@pytest.mark.parametrize("name", ["Sym(3)", "su(3)"])
def test_equilibria_of_other_spaces(name: str) -> None:
    """Points next to an equilibrium of a field on an orbit without the range condition: no false alarms."""
    rho = lh.sym_conjugation(3) if name == "Sym(3)" else lh.adjoint(lh.su(3))
    base = np.array([1.0, 0, 0, 2.0, 0, 3.0]) if name == "Sym(3)" else np.random.default_rng(0).normal(size=8)
    frame = lh.Action(rho).isotropy_frame(base, check_point(rho, base))
    inside = frame.basis[:, 0] if frame.basis.shape[1] else np.zeros(rho.algebra.dimension)
    slope = quadratic(rho, 2, 0.1)
    for d in (0.0, 1e-300, 1e-17, 1e-12, 1e-4):
        field = lh.GeneratorField(rho, lambda m, d=d: inside + d * slope.psi(m), time_dependent=False)
        raised = lh.steps.correction(field, lh.Euler(), base, 4)
        assert np.isfinite(float(raised.residual)) and int(raised.reached) in (1, 4)
        if d == 0 or (name == "su(3)" and d <= 1e-17):
            assert int(raised.reached) == 4 and float(raised.residual) == 0
        if d == 1e-4 or (name == "Sym(3)" and d >= 1e-17):  # no isotropy: psi is as small as it is given
            assert int(raised.reached) == 1
