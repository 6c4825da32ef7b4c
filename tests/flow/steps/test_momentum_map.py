"""Momentum maps: on cotangent bundles, coadjoint orbits and symplectic representations, conserved by isotropy."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.steps.first_integral import conservation_map, cotangent_momentum

POINT = np.array([0.6, 0.48, 0.64])


def test_momentum_on_the_cotangent_bundle_is_the_pairing_with_the_field() -> None:
    rho = lh.sym_conjugation(3)
    rng = np.random.default_rng(0)
    m, alpha, eta = rng.normal(size=(2, 6)), rng.normal(size=(2, 6)), rng.normal(size=3)
    field = lh.GeneratorField(rho, eta)
    assert np.allclose(cotangent_momentum(rho, m, alpha) @ eta, np.sum(alpha * field.vector(m), axis=-1))
    with pytest.raises(ShapeError):
        cotangent_momentum(rho, m, alpha[:, :3])


@pytest.mark.parametrize("kind", ["b", "o"])
def test_chi_is_the_coadjoint_action_on_the_momentum(kind: str) -> None:
    """The remark after Corollary 11: <z, chi(zeta)> = -(1/2) J(dF)([xi_1, zeta])."""
    body = lh.RigidBody([1, 2, 3])
    field = body.field(kind)
    chi = conservation_map(field, lh.Heun(), POINT, body.energy)
    momentum = cotangent_momentum(field.representation, POINT, body.apply(POINT))
    bracket = np.cross(field.psi(POINT), chi.basis[:, 0])
    assert np.allclose(chi.matrix[0, 0], -momentum @ bracket / 2, atol=1e-15)
    assert abs(chi.matrix[0, 0]) > 1e-2


def structure_constants(algebra: lh.LieAlgebra) -> Any:
    n = algebra.dimension
    return np.array([algebra.ad(algebra.field.unit(n, i)).to_numpy().T for i in range(n)])


def test_momentum_maps_are_poisson_and_equivariant() -> None:
    """dJ_eta = Omega(rho(eta) m, .) and J(rho(x) m) = -ad*_x J, on sp(4,R) acting on R^4."""
    rho = lh.defining(lh.sp(4, "R"))
    matrices = np.array([a.to_numpy() for a in rho.matrices])
    form = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    J = lh.steps.MomentumMap(rho, form=form)
    m = np.array([0.3, -0.7, 1.1, 0.4])
    slope = lh.steps.FirstIntegral(J, 4).gradient(m)[1]
    assert np.allclose(slope, (matrices @ m) @ form, atol=1e-14)
    constants = structure_constants(rho.algebra)
    for a, matrix in enumerate(matrices):
        assert np.allclose(slope @ (matrix @ m), -constants[a] @ J(m), atol=1e-13)


def test_isotropy_conserves_the_momentum_of_symmetric_bodies() -> None:
    """A free body with two equal moments: energy and momentum along the axis, by isotropy."""
    g = lh.so(3)
    field = lh.hamiltonian_field(g, "m0**2/2 + m1**2/2 + m2**2/6", sign=-1)
    J = lh.steps.MomentumMap(field.representation, g.subalgebra([[0, 0, 1]]))
    changes = {}
    for step in (lh.Heun(), lh.Conserving(lh.Heun(), J), lh.Conserving(lh.Euler(), J)):
        sol = lh.integrate(field, (0, 50), POINT, step=step, dt=0.1)
        changes[repr(step.order), isinstance(step, lh.Conserving)] = np.ptp(J(sol.y.T))
    assert changes["2", True] < 1e-15
    assert changes["1", True] < 1e-15
    assert changes["2", False] > 1e-6


def pair_of_spins() -> tuple[lh.LieAlgebra, Any, lh.steps.MomentumMap]:
    """Two spins with an exchange that is symmetric under rotations of both about e3, in fields along e3."""
    g = lh.direct_sum(lh.so(3), lh.so(3))

    def energy(m: Any) -> Any:
        return m[..., 0] * m[..., 3] + m[..., 1] * m[..., 4] + 2 * m[..., 2] * m[..., 5] + m[..., 2] - 0.4 * m[..., 5]

    return g, energy, lh.steps.MomentumMap(lh.coadjoint(g), g.subalgebra([[0, 0, 1, 0, 0, 1]]))


def test_energy_and_momentum_of_two_spins_by_their_two_directions_of_isotropy() -> None:
    g, energy, J = pair_of_spins()
    field = lh.hamiltonian_field(g, energy)
    start = np.array([0.6, 0.48, 0.64, 0.8, 0.0, 0.6])

    def both(m: Any) -> Any:
        return np.stack([energy(m), J(m)[..., 0]], axis=-1)

    sol = lh.integrate(field, (0, 2), start, step=lh.Conserving(lh.Heun(), both), dt=0.02)
    assert np.ptp(both(sol.y.T), axis=0).max() < 1e-14
    control = lh.integrate(field, (0, 2), start, step=lh.Conserving(lh.Heun(), energy), dt=0.02)
    assert np.ptp(J(control.y.T)) > 1e-5


def test_symplectic_steps_conserve_the_momentum_of_two_spins() -> None:
    """Linear momentum maps are conserved by the spherical midpoint step; by Heun's step they are not."""
    g, energy, J = pair_of_spins()
    field = lh.hamiltonian_field(g, energy)
    start = np.array([0.6, 0.48, 0.64, 0.0, -0.6, 0.8])
    changes = [
        np.ptp(J(lh.integrate(field, (0, 10), start, step=step, dt=0.1).y.T))
        for step in (lh.SphericalMidpoint(), lh.methods.VariationalMidpoint(), lh.Heun())
    ]
    assert max(changes[:2]) < 1e-13
    assert changes[2] > 1e-5


def test_integrals_are_recognized_where_they_vanish_with_their_round_off() -> None:
    """At this point the energy is 0, and so is each product of a coordinate and its derivative."""
    g, energy, J = pair_of_spins()
    flow = lh.steps.flow_series(lh.hamiltonian_field(g, energy), np.array([1.0, 0, 0, 0, 1.0, 0]), 3)
    lh.steps.FirstIntegral(lambda m: np.stack([energy(m), J(m)[..., 0]], axis=-1), 6).check(flow, 3)
    with pytest.raises(InputError, match="not a first integral"):
        lh.steps.FirstIntegral(lambda m: energy(m) + 1e-6 * m[..., 2], 6).check(flow, 3)


def test_momentum_that_is_not_conserved_is_refused() -> None:
    g, energy, _ = pair_of_spins()
    J = lh.steps.MomentumMap(lh.coadjoint(g), g.subalgebra([[1, 0, 0, 1, 0, 0]]))
    field = lh.hamiltonian_field(g, energy)
    with pytest.raises(InputError, match="not a first integral"):
        lh.integrate(field, (0, 1), np.arange(1.0, 7.0), step=lh.Conserving(lh.Heun(), J), dt=0.1)


def test_compiled_conservation_of_a_component() -> None:
    g, energy, _ = pair_of_spins()
    J = lh.steps.MomentumMap(lh.coadjoint(g), g.subalgebra([[0, 0, 1, 0, 0, 1]]))
    field = lh.hamiltonian_field(g, energy)
    sol = lh.integrate(
        field, (0, 10), np.arange(1.0, 7.0) / 5, step=lh.Conserving(lh.Heun(), J), dt=0.05, engine="llvm"
    )
    assert np.ptp(J(sol.y.T)) < 1e-14


@pytest.mark.parametrize(("options", "error", "message"), [
    ({}, InputError, "form="), ({"form": np.eye(4)}, InputError, "antisymmetric"),
    ({"form": np.eye(3)}, ShapeError, "expected"), ({"form": np.zeros((4, 4))}, InputError, "degenerate"),
    ({"form": np.kron([[0, 1], [-1, 0]], [[1, 0], [0, 2]])}, InputError, "not invariant"),
    ({"subalgebra": lh.so(3).subalgebra([[1, 0, 0]])}, InputError, "not a subalgebra"),
])  # fmt: skip
def test_wrong_forms_are_refused(options: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        lh.steps.MomentumMap(lh.defining(lh.sp(4, "R")), **options)
