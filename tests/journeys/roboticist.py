"""Three jobs of a roboticist: inverse kinematics, an attitude from samples and its mean, vehicles that steer."""

import numpy as np
from scipy.spatial.transform import Rotation

import liehom as lh


def inverse_kinematics() -> tuple[int, float]:
    """Newton's method for the joints of an arm with six: iterations and error of the pose."""
    a, b, w, v, h, k = 0.425, 0.392, 0.109, 0.082, 0.089, 0.095
    screws = np.array([[0, 0, 1, 0, 0, 0], [0, 1, 0, -h, 0, 0], [0, 1, 0, -h, 0, a], [0, 1, 0, -h, 0, a + b],
                       [0, 0, -1, -w, a + b, 0], [0, 1, 0, k - h, 0, a + b]])  # fmt: skip
    home = lh.SE3.from_matrix(np.array([[-1, 0, 0, a + b], [0, 0, 1, w + v], [0, 1, 0, h - k], [0, 0, 0, 1.0]]))

    def kinematics(q: np.ndarray) -> tuple[lh.SE3, np.ndarray]:
        pose, columns = lh.SE3.identity(), []
        for screw, angle in zip(screws, q, strict=True):
            columns.append(pose.adjoint() @ screw)
            pose = pose @ lh.SE3.exp(angle * screw)
        return pose @ home, np.stack(columns, axis=-1)

    goal, _ = kinematics(np.array([0.3, -1.0, 1.2, -0.5, 0.7, 0.2]))
    q = np.array([0.1, -0.8, 1.0, -0.3, 0.5, 0.0])
    iterations, error = 0, np.ones(6)
    while np.linalg.norm(error) > 1e-12 and iterations < 10:
        pose, jacobian = kinematics(q)
        error = (goal @ pose.inverse()).log()
        q = q + np.linalg.solve(jacobian, error)
        iterations += 1
    return iterations, float(abs(kinematics(q)[0].matrix - goal.matrix).max())


def attitude_from_samples() -> tuple[float, float]:
    """Distances from scipy: the attitude by a sampled gyro, and the mean of noisy attitudes."""
    times = np.arange(0, 2, 0.01)
    samples = np.stack([0.3 * np.sin(times), 0.2 * np.cos(2 * times), 0.5 + 0 * times], axis=-1)

    def gyro(t: np.ndarray) -> np.ndarray:
        return np.stack([np.interp(t, times, samples[:, k]) for k in range(3)], axis=-1)

    rows = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: -gyro(t))
    attitude = lh.integrate(rows, (0, times[-1]), np.eye(3), max_step=0.02).y_end
    peer = Rotation.identity()
    for t in np.arange(0.0005, times[-1], 0.001):
        peer = peer * Rotation.from_rotvec(0.001 * gyro(t))
    noise = np.random.default_rng(0).normal(size=(200, 3))
    noisy, mean = lh.SO3.from_matrix(attitude) @ lh.SO3.exp(0.1 * noise), lh.SO3.identity()
    for _ in range(10):
        mean = mean @ lh.SO3.exp((mean.inverse() @ noisy).log().mean(axis=0))
    chordal = Rotation.from_quat(noisy.as_quaternion_xyzw()).mean().as_matrix()
    return float(abs(attitude - peer.as_matrix()).max()), float(abs(mean.as_matrix() - chordal).max())


def steering() -> list[str]:
    """What two wheels, and forward thrust with two turns, reach: groups and answers."""
    turns, motions = lh.defining("so(3)").matrices, lh.defining("e(3)").matrices
    systems = [
        lh.controllability(controls=turns[:2]),
        lh.controllability(controls=[motions[0], motions[1], motions[3]]),
        lh.controllability(drift=motions[3], controls=motions[:2]),
    ]
    return [f"{system.name}: {system.group.state}" for system in systems]
