"""The generator of a moving frame: known cases, orders of Euler's step on strata, equivariance, exact circles."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.studies.spheres import Sphere, SphereFrame


def orbit_order(field: lh.GeneratorField, m: Any, same: lh.GeneratorField) -> float:
    """The order to which Euler's step captures the orbit of m under the `same` field, from distances after t = 1."""
    errors = []
    near = lh.integrate(same, (0, 1.5), m, step=lh.RKMK("rk4"), dt=1 / 512).y.T
    for h in (1 / 32, 1 / 64):
        end = lh.integrate(field, (0, 1), m, step=lh.Euler(), dt=h, clock="nominal").y[:, -1]
        i = int(np.clip(np.argmin(np.linalg.norm(near - end, axis=-1)), 1, len(near) - 2))
        chord = near[i + 1] - near[i - 1]
        rest = end - near[i]
        errors.append(np.linalg.norm(rest - chord * (rest @ chord) / (chord @ chord)))
    return float(np.log2(errors[0] / errors[1]))


def test_frame_of_the_sphere() -> None:
    """psi of {m, m'/|m'|, m x m'/|m'|}: its derivatives are psi x them, and zeta = sigma_i m = (c_1/v) m."""
    rho = lh.adjoint(lh.so(3))
    field = lh.GeneratorField(rho, lambda m: np.stack([m[..., 1], m[..., 2] ** 2, 1 + m[..., 0]], axis=-1))
    framed, m, h = lh.steps.moving_frame_field(field), np.array([0.6, 0.48, 0.64]), 1e-5

    def frame(y: Any) -> Any:
        velocity = field.vector(y)
        unit = velocity / np.linalg.norm(velocity)
        return np.stack([y, unit, np.cross(y, unit)])

    ends = [lh.integrate(field, (0, s), m, step=lh.LieTaylor(6), dt=h).y[:, -1] for s in (h, -h)]
    change = (frame(ends[0]) - frame(ends[1])) / (2 * h)
    assert np.abs(np.cross(framed.psi(m), frame(m)) - change).max() < 1e-8
    coordinates = SphereFrame(field, m)
    orthogonal = Sphere(3).orthogonal(field).psi(m)
    assert np.allclose(framed.psi(m) - orthogonal, coordinates.c[1] / coordinates.v * m, atol=1e-12)


def test_rigid_body_has_the_isotropy_of_the_paper() -> None:
    body = lh.RigidBody([1, 2, 3])
    m = np.random.default_rng(0).normal(size=(5, 3))
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    x = body.vector(m)
    sigma = np.sum(x * body.apply(x), axis=-1) / np.sum(x * x, axis=-1) - body.rayleigh(m)
    for kind in "bo":
        field = lh.steps.moving_frame_field(body.field(kind)).psi(m)
        assert np.allclose(field, body.field("o").psi(m) + sigma[:, None] * m, atol=1e-12)


def test_euler_with_the_frame_follows_axisymmetric_bodies_exactly() -> None:
    """Orbits of one-parameter subgroups; with the generator of the paper Euler leaves them."""
    body, m = lh.RigidBody([1, 1, 3]), np.array([0.6, 0.48, 0.64])
    for field, exact in ((lh.steps.moving_frame_field(body.field("b")), True), (body.field("b"), False)):
        sol = lh.integrate(field, (0, 10), m, step=lh.Euler(), dt=0.5)
        assert bool(np.abs(sol.y[:, -1] - body.exact(m, 10.0)).max() < 1e-13) is exact


@pytest.mark.parametrize(("angles", "order"), [((1,), None), ((1, 2), 2)])
def test_one_parameter_subgroups_are_followed_exactly_where_zeta_is_determined(
    angles: tuple[int, ...], order: int | None
) -> None:
    """Rotations with these angular velocities: exact on S^2, of order 2 on S^3, where orbits have torsion."""
    size = 2 * len(angles) + len(angles) % 2
    turn = np.zeros((size, size))
    for i, angle in enumerate(angles):
        turn[2 * i + 1, 2 * i], turn[2 * i, 2 * i + 1] = angle, -angle
    rho = lh.defining(lh.so(size))
    field = lh.GeneratorField.from_vector_field(rho, lambda m: m @ turn.T)
    m = np.array([0.6, 0.0, 0.8, 0.0])[:size]
    exact = lh.integrate(field, (0, 2), m, step=lh.LieTaylor(12), dt=0.1).y[:, -1]
    framed = lh.steps.moving_frame_field(field)
    errors = [
        np.linalg.norm(lh.integrate(framed, (0, 2), m, step=lh.Euler(), dt=h).y[:, -1] - exact) for h in (0.05, 0.025)
    ]
    if order is None:
        assert max(errors) < 1e-12
    else:
        assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.02)
        assert errors[1] > 1e-4


def sym_field() -> lh.GeneratorField:
    a = np.random.default_rng(4).normal(size=(3, 6))
    return lh.GeneratorField(lh.sym_conjugation(3), lambda m: m @ a.T + 0.3 * m[..., :3] * m[..., 3:])


def test_strata_of_symmetric_matrices() -> None:
    """On (2, 1), where so(2) is full, Euler's step captures orbits to order 2; on (1, 1, 1) psi is as it was."""
    field = sym_field()
    framed = lh.steps.moving_frame_field(field)
    turned = lh.Action(field.representation).act(np.array([0.4, -0.3, 0.2]), np.eye(6)[[0, 3, 5]])
    small, large = turned.T @ [1.0, 1.0, 2.0], turned.T @ [1.0, 2.0, 4.0]
    assert field.representation.orbit_dimension([lh.QQ.convert(x) for x in (1, 0, 0, 1, 0, 2)]) == 2
    assert orbit_order(framed, small, field) > 1.8
    assert orbit_order(field, small, field) < 1.3  # a control
    assert np.array_equal(framed.psi(large), field.psi(large))
    assert orbit_order(framed, large, field) < 1.3
    assert np.array_equal(framed.psi(np.stack([small, large]))[1], field.psi(large))
    assert np.allclose(framed.psi(np.stack([small, large]))[0], framed.psi(small), atol=1e-13)


def test_the_vector_field_does_not_change() -> None:
    field = sym_field()
    m = np.array([1.0, 0, 0, 1.0, 0, 2.0])
    framed = lh.steps.moving_frame_field(field)
    assert np.abs(framed.psi(m) - field.psi(m)).max() > 1e-2
    assert np.abs(framed.vector(m) - field.vector(m)).max() < 1e-13


def test_choice_is_equivariant() -> None:
    """X = X_0(m) for a field that commutes with rotations about e3: psi(g m) = g psi(m)."""
    rho = lh.adjoint(lh.so(3))
    field = lh.GeneratorField(
        rho, lambda m: np.stack([m[..., 1] * m[..., 2], -m[..., 0] * m[..., 2], 1 + m[..., 2] ** 2], axis=-1)
    )
    framed, m, angle = lh.steps.moving_frame_field(field), np.array([0.6, 0.48, 0.64]), 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    assert np.allclose(framed.psi(turn @ m), turn @ framed.psi(m), atol=1e-12)
    other = lh.steps.moving_frame_field(lh.GeneratorField(rho, lambda m: m[..., ::-1] * [1.0, 2.0, 3.0]))
    assert np.abs(other.psi(turn @ m) - turn @ other.psi(m)).max() > 0.1  # a control


def test_equilibria_keep_their_generator() -> None:
    body = lh.RigidBody([1, 2, 3])
    pole = np.array([0.0, 0.0, 1.0])
    assert np.array_equal(lh.steps.moving_frame_field(body.field("b")).psi(pole), body.field("b").psi(pole))


def test_compiled_runs_need_the_dimension_of_the_orbits() -> None:
    body, m = lh.RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
    framed = lh.steps.moving_frame_field(body.field("b"), orbit_dimension=2)
    ends = [
        lh.integrate(framed, (0, 2), m, step=lh.Heun(), dt=0.1, engine=engine).y[:, -1] for engine in ("numpy", "llvm")
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-13


def test_time_dependent_fields_and_series() -> None:
    rho = lh.adjoint(lh.so(3))
    field = lh.GeneratorField(rho, lambda m, t: m[..., ::-1] * (1 + np.asarray(t)[..., None]) * [1.0, 2.0, 3.0])
    framed, m = lh.steps.moving_frame_field(field), np.array([0.6, 0.48, 0.64])
    assert np.allclose(framed.vector(m, 0.5), field.vector(m, 0.5), atol=1e-13)
    assert np.abs(framed.psi(m, 0.5) - framed.psi(m, 0.6)).max() > 1e-3
    with pytest.raises(InputError, match="Corrected"):
        lh.steps.flow_series(framed, m, 2)
