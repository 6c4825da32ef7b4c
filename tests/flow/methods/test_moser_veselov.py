"""The Moser-Veselov step: the factorization, its first integrals, the inertia that it reads off psi."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.methods.midpoint import MatrixCoordinates, inertia_of
from liehom.flow.steps.step import Generator
from tests.flow.methods.spaces import System, moved, quadratic, system

STEP = lh.methods.MoserVeselov()


def test_step_is_the_factorization_of_the_matrix_polynomial() -> None:
    """X by scipy's Riccati solver: (X - N)(X + N) = J^2, w = J^-1 (X - N), M' = w M w^T."""
    data = system("body in R^4")
    coordinates = MatrixCoordinates(lh.defining(data.algebra))
    h, j = 0.3, np.diag([1.0, 2.0, 3.5, 5.0])
    m = -2 * coordinates.form(data.start)
    n = -h * m / 2  # psi = +Om: backwards in time
    w = np.linalg.solve(j, solve_continuous_are(-n, np.eye(4), j @ j + n @ n, np.eye(4)) - n)
    assert np.abs(w.T @ w - np.eye(4)).max() < 1e-13
    assert np.abs(w.T @ j - j @ w - 2 * n).max() < 1e-13
    assert np.abs(moved(STEP, data, data.start, h) - coordinates.point(w @ m @ w.T / -2)).max() < 1e-13


def test_first_integrals_of_the_discrete_body_are_conserved() -> None:
    """The coefficients of det(J^2 + x h M - x^2) in x do not change (Moser and Veselov 1991)."""
    data = system("body in R^4")
    coordinates = MatrixCoordinates(lh.defining(data.algebra))
    j = np.diag([1.0, 2.0, 3.5, 5.0])
    h, m = 0.3, data.start
    results = []
    for _ in range(30):
        form = -2 * coordinates.form(m)
        results.append([np.linalg.det(j @ j + h * x * form - x * x * np.eye(4)) for x in (0.3, 0.7, 1.9)])
        m = moved(STEP, data, m, h)
    assert np.ptp(results, axis=0).max() < 1e-11
    assert np.abs(m - data.start).max() > 0.1


@pytest.mark.parametrize("name", ["body", "body in R^4"])
def test_energy_is_conserved_to_round_off(name: str) -> None:
    data = system(name)
    spans = [
        np.ptp(data.energy(lh.integrate(data.field, (0, 20), 3 * data.start, step=step, dt=0.1).y.T))
        for step in (STEP, lh.methods.IsospectralMidpoint())
    ]
    assert spans[0] < 1e-13
    assert spans[1] > 1e-5  # a control


@pytest.mark.parametrize("step", [STEP, pytest.param(lh.methods.Composition(STEP, 4), marks=pytest.mark.slow)], ids=str)
def test_each_call_of_a_propagator_has_the_inertia_of_its_args(step: lh.Step) -> None:
    """The inertia is a constant of compiled code, which is not used for other args."""
    field = lh.hamiltonian_field(lh.so(3), "0", gradient=lambda m, *, args: m / args, sign=-1)
    start = np.array([0.6, 0.48, 0.64])
    propagator = lh.Propagator(field, step, args=np.array([2.0, 3.0, 4.0]), engine="llvm")
    for moments in ([2.0, 3.0, 4.0], [3.0, 3.5, 4.0], [2.0, 3.0, 4.0]):
        values = propagator((0.0, 2.0), start, dt=0.1, args=np.array(moments)).y[:, -1]
        again = propagator((0.0, 2.0), start, dt=0.1, args=np.array(moments)).y[:, -1]
        assert np.array_equal(values, again)
        plain = lh.integrate(lh.RigidBody(moments).field("b"), (0, 2), start, step=step, dt=0.1).y[:, -1]
        assert np.abs(values - plain).max() < 1e-14


@pytest.mark.parametrize("kind", [1, -1])
def test_inertia_of_a_turned_body(kind: int) -> None:
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    tensor = turn @ np.diag([2.0, 3.0, 4.0]) @ turn.T
    tensor = (tensor + tensor.T) / 2
    inverse = np.linalg.inv(tensor)
    field = lh.hamiltonian_field(lh.so(3), lambda m: np.sum(m * (m @ inverse), axis=-1) / 2, sign=kind)
    coordinates = MatrixCoordinates(lh.defining(lh.so(3)))
    result = inertia_of(coordinates, Generator(field, 2))
    j = result.axes @ np.diag(result.moments) @ result.axes.T
    m = np.array([0.6, 0.48, 0.64])
    velocity = coordinates.element(m @ inverse)
    assert result.sign == kind
    assert np.allclose(result.moments, [0.5, 1.5, 2.5])
    assert np.allclose(j @ velocity + velocity @ j, -2 * coordinates.form(m), atol=1e-13)


@pytest.mark.parametrize(
    ("w", "message"),
    [
        ([1.0, 0.5, 1 / 3], "J = "),  # a plane body: 1 + 2 = 3
        (lambda m: np.sum(m**4, axis=-1), "not that of a free rigid body"),
    ],
)
def test_other_systems_are_refused(w: object, message: str) -> None:
    values = System(lh.so(3), (w if callable(w) else quadratic(np.array(w))), -1, np.array([0.6, 0.48, 0.64]))
    with pytest.raises(InputError, match=message):
        moved(STEP, values, values.start, 0.1)


def test_general_quadratic_energies_in_four_dimensions_are_refused() -> None:
    """so(4) has metrics that are not those of bodies: J_i + J_j has four parameters, the metric six."""
    values = System(lh.so(4), quadratic(np.array([1.0, 0.5, 0.7, 0.3, 0.6, 0.2])), -1, np.arange(1.0, 7.0))
    with pytest.raises(InputError, match="IsospectralMidpoint"):
        moved(STEP, values, values.start, 0.1)


def test_bodies_that_are_not_in_space_are_integrated() -> None:
    """I_1 + I_2 < I_3: one J_i is negative."""
    values = System(lh.so(3), quadratic(1 / np.array([1.0, 1.5, 4.0])), -1, np.array([0.6, 0.48, 0.64]))
    field = values.field
    ends = [lh.integrate(field, (0, 1), values.start, step=STEP, dt=h).y[:, -1] for h in (1 / 8, 1 / 16, 1 / 32)]
    assert 3.8 < np.abs(ends[0] - ends[1]).max() / np.abs(ends[1] - ends[2]).max() < 4.2
