"""Bodies under torques: against solve_ivp on quaternions, conserved quantities, views, engines and refusals."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import liehom as lh
from liehom.flow.action.motions import matrix_to_quaternion, quaternion_to_matrix
from liehom.flow.bodies import BodyState, PoseState, across
from liehom.studies.rigid_body import RigidBody

TENSOR = np.array([[1.0, 0.2, 0.1], [0.2, 2.0, 0.3], [0.1, 0.3, 3.0]])
ADDED_MASS = np.diag([1.0, 2.0, 3.0, 1.5, 2.5, 4.0]) + 0.2 * (np.eye(6, k=3) + np.eye(6, k=-3))
Q0 = Rotation.from_rotvec([0.3, -0.5, 1.1]).as_matrix()


def torque(s: Any, t: Any) -> Any:
    """Damping, a magnet that tries to align e_1 with the vertical, and a motor."""
    return -0.1 * s.velocity + np.cross([1.0, 0, 0], s.attitude[..., 2, :]) + np.sin(t)[..., None] * [0.0, 0.2, 0.0]


def wrench(s: Any) -> Any:
    """Damping, and a spring to the origin."""
    return np.concatenate([-0.1 * s.velocity[..., :3], -across(s.attitude, s.position)], axis=-1)


def by_quaternions(inertia: Any, m0: Any, force: Callable[..., Any], end: float) -> tuple[Any, Any]:
    """Attitude and momentum at the end, from q' = q (0, Om m) / 2 and m' = m x Om m + tau in solve_ivp."""
    inverse = np.linalg.inv(inertia)

    def rates(t: float, y: Any) -> Any:
        q, m = y[:4] / np.linalg.norm(y[:4]), y[4:]
        omega = inverse @ m
        state = BodyState(quaternion_to_matrix(q), m, omega)
        turned = np.append(-q[1:] @ omega, q[0] * omega + np.cross(q[1:], omega)) / 2  # the quaternion q omega / 2
        return np.concatenate([turned, np.cross(m, omega) + force(state, np.asarray(t))])

    start = np.concatenate([matrix_to_quaternion(Q0), m0])
    result = solve_ivp(rates, (0, end), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return quaternion_to_matrix(result[:4]), result[4:]


def by_newton_and_euler(m0: Any, force: Callable[..., Any], end: float) -> tuple[Any, Any, Any]:
    """Attitude, position and momentum at the end, from Kirchhoff's equations in the body."""
    inverse = np.linalg.inv(ADDED_MASS)

    def rates(t: float, y: Any) -> Any:
        q, x, mu = y[:9].reshape(3, 3), y[9:12], y[12:]
        omega, v = np.split(inverse @ mu, 2)
        data = force(PoseState(q, x, mu, np.concatenate([omega, v])))
        angular = np.cross(mu[:3], omega) + np.cross(mu[3:], v) + data[:3]
        turned = q @ np.cross(np.eye(3), omega)  # hat(omega) has columns omega x e_i: rows e_i x omega, transposed
        return np.concatenate([turned.ravel(), q @ v, angular, np.cross(mu[3:], omega) + data[3:]])

    start = np.concatenate([Q0.ravel(), [1.0, 0.0, -1.0], m0])
    y = solve_ivp(rates, (0, end), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return y[:9].reshape(3, 3), y[9:12], y[12:]


# -- against other programs --------------------------------------------------------------------------------
def test_attitude_under_a_torque_agrees_with_quaternions() -> None:
    body, m0 = lh.bodies.AttitudeBody(TENSOR, torque), np.array([0.5, -0.2, 1.0])
    sol = body.integrate((0, 5), body.start(Q0, momentum=m0), rtol=1e-10, atol=1e-10)
    q, m = by_quaternions(TENSOR, m0, torque, 5.0)
    np.testing.assert_allclose(body.attitude(sol)[-1], q, rtol=0, atol=1e-8)
    np.testing.assert_allclose(body.momentum(sol)[-1], m, rtol=0, atol=1e-8)
    in_space = lh.bodies.AttitudeBody(
        TENSOR, lambda s, t: np.sum(s.attitude * torque(s, t)[..., None, :], axis=-1), frame="space"
    )
    again = in_space.integrate((0, 5), in_space.start(Q0, momentum=m0), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(again.y[:, -1], sol.y[:, -1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("frame", ["body", "space"])
def test_every_body_of_an_ensemble_turns_by_its_own_torque(frame: str) -> None:
    """One torque for all, and one for each body."""
    momenta = np.array([[0.5, -0.2, 1.0], [0.0, 1.0, -0.3]])
    for force in (lambda s: np.array([0.1, 0.0, -0.2]), lambda s: -0.1 * s.velocity):
        body = lh.bodies.AttitudeBody(TENSOR, force, frame=frame)
        together = body.integrate((0, 1), body.start(Q0, momentum=momenta), dt=0.1)
        for k, m0 in enumerate(momenta):
            alone = body.integrate((0, 1), body.start(Q0, momentum=m0), dt=0.1)
            np.testing.assert_allclose(together.y[k], alone.y, rtol=0, atol=1e-13)


def test_pose_under_a_wrench_agrees_with_kirchhoffs_equations() -> None:
    body, mu = lh.bodies.SE3Body(ADDED_MASS, wrench), np.array([0.5, -0.2, 1.0, 0.3, 0.1, -0.4])
    sol = body.integrate((0, 4), body.start(Q0, [1.0, 0, -1.0], momentum=mu), rtol=1e-10, atol=1e-10)
    q, x, m = by_newton_and_euler(mu, wrench, 4.0)
    np.testing.assert_allclose(body.attitude(sol)[-1], q, rtol=0, atol=1e-8)
    np.testing.assert_allclose(body.position(sol)[-1], x, rtol=0, atol=1e-8)
    np.testing.assert_allclose(body.momentum(sol)[-1], m, rtol=0, atol=1e-8)
    np.testing.assert_allclose(body.pose(sol)[-1][:3, :3], q, rtol=0, atol=1e-8)


def test_reduced_and_full_heavy_top_are_one_motion() -> None:
    top = lh.bodies.HeavyTop(TENSOR, [0.3, -0.1, 1.0], weight=2.0)
    body, m0 = top.with_attitude(), np.array([0.5, -0.2, 3.0])
    options: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-11, "t_eval": [0, 1.5, 3]}
    y, full = top.start(m0, attitude=Q0), body.start(Q0, momentum=m0)
    short, long = top.integrate((0, 3), y, **options), body.integrate((0, 3), full, **options)
    np.testing.assert_allclose(top.momentum(short), body.momentum(long), rtol=0, atol=1e-8)
    np.testing.assert_allclose(top.vertical(short), body.attitude(long)[:, 2], rtol=0, atol=1e-8)
    np.testing.assert_allclose(top.energy(short), body.energy(long), rtol=0, atol=1e-8)
    m, up = y[:3], y[3:]
    field = top.field.vector(y)
    np.testing.assert_allclose(field[:3], np.cross(m, top.velocity(y)) + 2 * np.cross(up, top.centre), atol=1e-15)
    np.testing.assert_allclose(field[3:], np.cross(up, top.velocity(y)), atol=1e-15)


# -- conserved quantities ----------------------------------------------------------------------------------
@pytest.mark.parametrize("step", [lh.Euler(), lh.RKMK("rk4"), lh.LieTaylor(3), lh.methods.CommutatorFree4()])
def test_free_bodies_keep_rotations_and_momentum(step: Any) -> None:
    body, m0 = lh.bodies.AttitudeBody(TENSOR), np.array([0.5, -0.2, 1.0])
    sol = body.integrate((0, 20), body.start(Q0, momentum=m0), step=step, dt=0.1)
    q = body.attitude(sol)
    assert np.abs(q @ np.swapaxes(q, -1, -2) - np.eye(3)).max() < 1e-13
    assert np.ptp(body.space_momentum(sol), axis=0).max() == 0
    rigid = lh.bodies.SE3Body(ADDED_MASS)
    start = rigid.start(Q0, [1.0, 0, -1.0], momentum=[*m0, 0.3, 0.1, -0.4])
    moved = rigid.integrate((0, 20), start, step=step, dt=0.1)
    assert np.ptp(rigid.space_momentum(moved), axis=0).max() == 0
    assert np.abs(rigid.attitude(moved)[-1] @ rigid.attitude(moved)[-1].T - np.eye(3)).max() < 1e-13


def test_gravity_keeps_the_vertical_momentum_and_the_energy_to_the_order() -> None:
    top = lh.bodies.HeavyTop([1, 2, 3], [0.1, 0.0, 1.0])
    y = top.start([0.5, -0.2, 3.0], [0.6, 0, 0.8])
    drifts = []
    for dt in (0.1, 0.05):
        sol = top.integrate((0, 10), y, step=lh.RKMK("rk4"), dt=dt)
        assert np.ptp(top.vertical_momentum(sol)) < 1e-12
        assert np.ptp(np.linalg.norm(top.vertical(sol), axis=-1)) < 1e-13
        drifts.append(np.ptp(top.energy(sol)))
    assert 3.5 < np.log2(drifts[0] / drifts[1]) < 5.5
    body = top.with_attitude()
    full = body.integrate((0, 10), body.start(Q0, momentum=[0.5, -0.2, 3.0]), dt=0.1)
    assert np.ptp(body.space_momentum(full)[:, 2]) < 1e-13
    assert np.ptp(body.space_momentum(full)[:, 0]) > 0.1


def test_isotropy_conserves_the_energy_of_the_heavy_top() -> None:
    top = lh.bodies.HeavyTop([1, 2, 3], [0.1, 0.0, 1.0])
    y = top.start([0.5, -0.2, 3.0], [0.6, 0, 0.8])
    plain = top.integrate((0, 10), y, step=lh.Heun(), dt=0.05)
    kept = top.integrate((0, 10), y, step=lh.Conserving(lh.Heun(), top.energy), dt=0.05)
    assert np.ptp(top.energy(plain)) > 1e-4
    assert np.ptp(top.energy(kept)) < 1e-11


def test_a_lagrange_top_keeps_its_spin() -> None:
    top = lh.bodies.HeavyTop([1, 1, 2], [0, 0, 1])
    sol = top.integrate((0, 10), top.start([0.3, 0, 4.0], [0.6, 0, 0.8]), rtol=1e-10, atol=1e-10)
    assert np.ptp(top.momentum(sol)[:, 2]) < 1e-8


# -- views -------------------------------------------------------------------------------------------------
def test_quaternions_of_a_solution_are_continuous() -> None:
    body = lh.bodies.AttitudeBody([1, 1, 1])
    sol = body.integrate((0, 4 * np.pi), body.start(velocity=[0.6, 0, 0.8]), dt=0.05)
    q = body.quaternion(sol)
    assert np.abs(np.diff(q, axis=0)).max() < 0.03
    assert np.allclose(q[:, 0], np.cos(sol.t / 2), atol=1e-6)
    assert np.allclose(quaternion_to_matrix(q), body.attitude(sol), atol=1e-14)


def test_quaternions_against_scipy() -> None:
    values = Rotation.random(50, random_state=1)
    q = values.as_quat(scalar_first=True)
    assert np.allclose(quaternion_to_matrix(q), values.as_matrix(), atol=1e-15)
    back = matrix_to_quaternion(values.as_matrix())
    assert np.allclose(back * np.sign(np.sum(back * q, axis=-1))[:, None], q, atol=1e-15)


@pytest.mark.parametrize("axis", range(3))
def test_quaternions_of_half_turns_keep_all_digits(axis: int) -> None:
    for angle in (np.pi, np.pi - 1e-9, 1e-9):
        v = np.zeros(3)
        v[axis] = angle
        q = matrix_to_quaternion(Rotation.from_rotvec(v).as_matrix())
        assert abs(np.linalg.norm(q[1:]) - np.sin(angle / 2)) < 1e-15


def test_states_from_quaternions_matrices_velocity_and_momentum_agree() -> None:
    body, omega = lh.bodies.AttitudeBody(TENSOR, torque), np.array([0.1, 0.2, 0.3])
    y = body.start(Q0, velocity=omega)
    other = body.start(matrix_to_quaternion(Q0), momentum=TENSOR @ omega)
    np.testing.assert_allclose(y, other, rtol=0, atol=1e-15)
    assert body.start(Q0, velocity=np.tile(omega, (4, 1))).shape == (4, 13)
    np.testing.assert_allclose(body.velocity(y), omega, atol=1e-15)
    np.testing.assert_allclose(body.state(y).space_momentum, body.space_momentum(y), atol=1e-15)
    rigid = lh.bodies.SE3Body(ADDED_MASS)
    twist = np.arange(6.0)
    np.testing.assert_allclose(rigid.velocity(rigid.start(Q0, [1, 2, 3], velocity=twist)), twist, atol=1e-14)


def test_the_free_body_is_that_of_rigid_body() -> None:
    body, rigid, m = lh.bodies.AttitudeBody(TENSOR), RigidBody(TENSOR), np.array([0.5, -0.2, 1.0])
    sol = body.integrate((0, 5), body.start(Q0, momentum=m), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(body.attitude(sol)[-1], rigid.attitude(m, [5.0], Q0)[-1], rtol=0, atol=1e-10)
    np.testing.assert_allclose(body.momentum(sol)[-1], rigid.exact(m, 5.0), rtol=0, atol=1e-10)


# -- engines and gradients ---------------------------------------------------------------------------------
def bodies() -> dict[str, tuple[Any, Any]]:
    attitude, rigid = lh.bodies.AttitudeBody(TENSOR, torque), lh.bodies.SE3Body(ADDED_MASS, wrench)
    top = lh.bodies.HeavyTop(TENSOR, [0.3, -0.1, 1.0])
    return {
        "attitude": (attitude, attitude.start(Q0, momentum=[0.5, -0.2, 1.0])),
        "pose": (rigid, rigid.start(Q0, [1.0, 0, -1.0], momentum=[0.5, -0.2, 1.0, 0.3, 0.1, -0.4])),
        "top": (top, top.start([0.5, -0.2, 3.0], [0.6, 0, 0.8])),
    }


@pytest.mark.parametrize("name", ["attitude", "pose", "top"])
def test_compiled_steps_agree(name: str) -> None:
    pytest.importorskip("llvmlite")
    body, y = bodies()[name]
    for options in ({"step": lh.RKMK("rk4"), "dt": 0.05}, {"step": lh.RKMK("rk45"), "rtol": 1e-8}):
        plain = lh.integrate(body.field, (0, 2), y, **options)
        sol = lh.integrate(body.field, (0, 2), y, engine="llvm", **options)
        assert plain.n_steps == sol.n_steps
        np.testing.assert_allclose(sol.y[:, -1], plain.y[:, -1], rtol=0, atol=1e-10)


@pytest.mark.slow
def test_gradients_by_jax_agree_with_differences() -> None:
    jax = pytest.importorskip("jax")
    body, y = bodies()["attitude"]

    def final(y: Any) -> Any:
        return lh.integrate(body.field, (0, 0.5), y, step=lh.RKMK("heun"), dt=0.1, engine="jax").y[0, -1]

    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
        slope = np.asarray(jax.grad(final)(jax.numpy.asarray(y)))
    h, ahead = 1e-6, np.eye(13)[10]
    options: dict[str, Any] = {"step": lh.RKMK("heun"), "dt": 0.1}
    ends = [body.integrate((0, 0.5), y + sign * h * ahead, **options).y[0, -1] for sign in (1, -1)]
    assert abs(slope[10] - (ends[0] - ends[1]) / (2 * h)) < 1e-8


def test_args_of_a_torque_are_inputs_of_every_engine() -> None:
    pytest.importorskip("llvmlite")
    body = lh.bodies.AttitudeBody(TENSOR, lambda s, t, args: -args["drag"] * s.velocity)
    plain = lh.bodies.AttitudeBody(TENSOR, lambda s: -0.2 * s.velocity)
    y = body.start(Q0, velocity=[0.1, 0.2, 1.0])
    wanted = plain.integrate((0, 2), y, step=lh.RKMK("rk4"), dt=0.1).y
    for engine in ("numpy", "llvm"):
        sol = body.integrate((0, 2), y, step=lh.RKMK("rk4"), dt=0.1, args={"drag": 0.2}, engine=engine).y
        np.testing.assert_allclose(sol, wanted, rtol=0, atol=1e-13)


# -- refusals ----------------------------------------------------------------------------------------------
def test_arguments_that_are_refused() -> None:
    body = lh.bodies.AttitudeBody([1, 2, 3])
    with pytest.raises(lh.errors.InputError, match="one of the two"):
        body.start(Q0)
    with pytest.raises(lh.errors.InputError, match="unit quaternion"):
        body.start([1.0, 1.0, 0, 0], momentum=[1.0, 0, 0])
    with pytest.raises(lh.errors.InputError, match="rotation"):
        body.start(-np.eye(3), momentum=[1.0, 0, 0])
    with pytest.raises(lh.errors.ShapeError, match=r"\(\.\.\., 3\)"):
        body.start(momentum=[1.0, 0])
    with pytest.raises(lh.errors.ShapeError, match="states of shape"):
        body.energy([1.0, 0, 0])
    with pytest.raises(lh.errors.InputError, match="positive definite"):
        lh.bodies.AttitudeBody([1, 2, -3])
    with pytest.raises(lh.errors.InputError, match="frame"):
        lh.bodies.AttitudeBody([1, 2, 3], torque, frame="inertial")
    with pytest.raises(lh.errors.InputError, match=r"\(state, t, args\)"):
        lh.bodies.AttitudeBody([1, 2, 3], lambda a, b, c, d: a)
    with pytest.raises(lh.errors.InputError, match="torque is a function"):
        lh.bodies.AttitudeBody([1, 2, 3], [1.0, 0, 0])  # type: ignore[arg-type]
    with pytest.raises(lh.errors.ShapeError, match="torque has shape"):
        lh.bodies.AttitudeBody([1, 2, 3], lambda s: s.velocity[..., :2]).integrate(
            (0, 1), np.zeros(13) + np.eye(13)[12]
        )
    with pytest.raises(lh.errors.InputError, match="contains the mass"):
        lh.bodies.SE3Body(ADDED_MASS, mass=2.0)
    with pytest.raises(lh.errors.ShapeError, match="centre"):
        lh.bodies.HeavyTop([1, 2, 3], [0, 1])
    with pytest.raises(lh.errors.InputError, match="weight"):
        lh.bodies.HeavyTop([1, 2, 3], [0, 0, 1], np.inf)


def test_an_ensemble_of_poses_starts_at_its_momenta_and_positions() -> None:
    body = lh.bodies.SE3Body([1, 2, 3])
    momentum, position = np.arange(30.0).reshape(5, 6), np.arange(15.0).reshape(5, 3)
    state = body.state(body.start(momentum=momentum, position=position))
    assert np.allclose(state.position, position) and np.allclose(state.momentum, momentum)
    for n, wrong in ((6, {"momentum": np.ones(5)}), (3, {"momentum": np.ones(6), "position": np.ones(2)})):
        with pytest.raises(lh.errors.ShapeError, match=rf"expected \(\.\.\., {n}\)"):
            body.start(**wrong)  # type: ignore[arg-type]
