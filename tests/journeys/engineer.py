"""Three jobs of an engineer in control and robotics: `python tests/journeys/engineer.py`."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import liehom as lh


def arm() -> float:
    """Pose and Jacobian of an arm with three joints, by products of exponentials; the error beside expm."""
    screws = np.array([[0, 0, 1, 0, 0, 0], [0, 1, 0, -0.5, 0, 0], [0, 1, 0, -0.5, 0, 0.8]], dtype=float)
    home = lh.SE3.from_rotation_and_translation(lh.SO3.identity(), [1.5, 0, 0.5])

    def joints(q: np.ndarray) -> list[lh.SE3]:
        return [lh.SE3.exp(s * x) for s, x in zip(screws, q, strict=True)]

    def pose(q: np.ndarray) -> lh.SE3:
        first, second, third = joints(q)
        return first @ second @ third @ home

    q = np.array([0.3, -0.7, 1.1])
    first, second, _ = joints(q)
    jacobian = np.stack([screws[0], first.adjoint() @ screws[1], (first @ second).adjoint() @ screws[2]], axis=1)

    def hat(x: np.ndarray) -> np.ndarray:
        w, v = x[:3], x[3:]
        return np.array([[0, -w[2], w[1], v[0]], [w[2], 0, -w[0], v[1]], [-w[1], w[0], 0, v[2]], [0, 0, 0, 0]])

    wanted = expm(hat(screws[0] * q[0])) @ expm(hat(screws[1] * q[1])) @ expm(hat(screws[2] * q[2])) @ home.matrix
    step = 1e-6
    differences = [
        (pose(q + step * e).matrix - pose(q - step * e).matrix) @ pose(q).inverse().matrix / (2 * step)
        for e in np.eye(3)
    ]
    return max(
        abs(pose(q).matrix - wanted).max(),
        max(abs(hat(jacobian[:, k]) - d).max() for k, d in enumerate(differences)),
    )


def tracking() -> tuple[list[float], float]:
    """Last errors of a body that tracks a turning target by a bounded torque, for four gains; one beside scipy."""
    inertia, rate, most = np.array([1.0, 1.5, 2.0]), 0.2, 0.5
    gains = np.array([0.5, 1.0, 2.0, 4.0])

    def torque(s: lh.bodies.BodyState, t: np.ndarray, gain: np.ndarray) -> np.ndarray:
        zero, one = 0 * t, 1 + 0 * t
        c, n = np.cos(rate * t), np.sin(rate * t)
        target = np.stack([np.stack(row, -1) for row in ([c, -n, zero], [n, c, zero], [zero, zero, one])], -2)
        turn = np.swapaxes(target, -1, -2) @ s.attitude
        error = np.stack([turn[..., 2, 1] - turn[..., 1, 2], turn[..., 0, 2] - turn[..., 2, 0],
                          turn[..., 1, 0] - turn[..., 0, 1]], -1)  # fmt: skip
        wanted = turn[..., 2, :] * rate  # the target's velocity in the body
        return most * np.tanh(-gain[..., None] * (error + 2 * (s.velocity - wanted)) / most)

    body = lh.bodies.AttitudeBody(inertia, torque)
    start = body.start(lh.SO3.exp([0.4, -0.3, 2.0]).as_matrix(), velocity=[0.0, 0.1, 0.0])
    sol = body.integrate((0, 40), start, args=lh.PerTrajectory(gains), t_eval=[40], rtol=1e-8, atol=1e-10)
    target = lh.SO3.exp([0, 0, rate * 40])
    last = body.attitude(sol)[:, -1]
    errors = [float(np.linalg.norm((target.inverse() @ lh.SO3.from_matrix(q)).log())) for q in last]

    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        q, m = y[:9].reshape(3, 3), y[9:]
        w = m / inertia
        state = type("State", (), {"attitude": q, "velocity": w})
        hat = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return np.concatenate([(q @ hat).ravel(), np.cross(m, w) + torque(state, np.array(t), np.array(2.0))])

    first = np.concatenate([lh.SO3.exp([0.4, -0.3, 2.0]).as_matrix().ravel(), inertia * [0.0, 0.1, 0.0]])
    peer = solve_ivp(rhs, (0, 40), first, method="DOP853", rtol=1e-10, atol=1e-12).y[:9, -1].reshape(3, 3)
    return errors, float(abs(last[2] - peer).max())


def unicycle() -> str:
    """A unicycle reaches every pose by driving and turning; a car that only drives, or only turns, does not."""
    drive, turn = [[0, 0, 1], [0, 0, 0], [0, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]
    both = lh.controllability(controls=[drive, turn])
    one = lh.controllability(controls=[drive])
    return f"{both.name} {both.group.state}, {one.name} {one.group.state}"


JOBS = (arm, tracking, unicycle)

if __name__ == "__main__":
    for job in JOBS:
        print(f"{job.__name__}: {job()}")
