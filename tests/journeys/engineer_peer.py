"""Three jobs of an engineer in control and robotics, with numpy and scipy alone."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

SCREWS = np.array([[0, 0, 1, 0, 0, 0], [0, 1, 0, -0.5, 0, 0], [0, 1, 0, -0.5, 0, 0.8]])
ANGLES = 0.3, -0.7, 1.1
SPIN = np.array([0, 0, 0.2])
GAINS = 0.5, 1, 2, 4
DRIVE = np.array([[0.0, 0, 1], [0, 0, 0], [0, 0, 0]])
TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]])


def hat(vector):
    """The matrix of the cross product with a vector."""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def arm():
    """The pose and the space Jacobian of an arm of three joints by the product of exponentials."""
    pose, columns = np.eye(4), []
    for screw, angle in zip(SCREWS, ANGLES, strict=True):
        omega = pose[:3, :3] @ screw[:3]
        columns.append(np.concatenate([omega, np.cross(pose[:3, 3], omega) + pose[:3, :3] @ screw[3:]]))
        twist = np.zeros((4, 4))
        twist[:3, :3], twist[:3, 3] = hat(screw[:3]), screw[3:]
        pose = pose @ expm(angle * twist)
    home = np.eye(4)
    home[:3, 3] = 1.5, 0, 0.5
    return pose @ home, np.stack(columns, axis=1)


def tracking():
    """The error angles at t = 40 of a body that tracks a turning attitude by a bounded torque, for each gain."""
    inertia = np.array([1, 1.5, 2])

    def error(attitude, t):
        return (Rotation.from_rotvec(t * SPIN).inv() * Rotation.from_matrix(attitude)).as_rotvec()

    def rhs(t, y, gain):
        attitude, w = y[:9].reshape(3, 3), y[9:]
        torque = 0.5 * np.tanh(-gain * (error(attitude, t) + 2 * (w - attitude.T @ SPIN)) / 0.5)
        return np.concatenate([(attitude @ hat(w)).ravel(), (torque - np.cross(w, inertia * w)) / inertia])

    start = np.concatenate([Rotation.from_rotvec([0.4, -0.3, 2.0]).as_matrix().ravel(), [0, 0.1, 0]])
    runs = [solve_ivp(rhs, (0, 40), start, args=(gain,), rtol=1e-10, atol=1e-12) for gain in GAINS]
    return np.array([np.linalg.norm(error(run.y[:9, -1].reshape(3, 3), 40)) for run in runs])


def unicycle():
    """Dimension and name of the algebra of driving and turning, and the dimension for driving alone."""

    def generated(controls):
        basis, pending = np.empty((0, 9)), list(controls)
        while pending:
            matrix = pending.pop()
            larger = np.vstack([basis, matrix.ravel()])
            if np.linalg.matrix_rank(larger) > len(basis):
                basis = larger
                pending += [matrix @ control - control @ matrix for control in controls]
        return basis

    basis = generated([DRIVE, TURN])
    elements = basis.reshape(-1, 3, 3)
    brackets = [[(x @ y - y @ x).ravel() for y in elements] for x in elements]
    ad = [np.linalg.lstsq(basis.T, np.transpose(rows))[0] for rows in brackets]
    killing = np.linalg.eigvalsh([[np.trace(a @ b) for b in ad] for a in ad])
    unimodular = all(abs(np.trace(a)) < 1e-9 for a in ad)
    signature = int(np.sum(killing > 1e-9)), int(np.sum(killing < -1e-9))
    name = "e(2)" if len(basis) == 3 and unimodular and signature == (0, 1) else "unknown"
    return len(basis), name, len(generated([DRIVE]))


JOBS = (arm, tracking, unicycle)

if __name__ == "__main__":
    for job in JOBS:
        print(job.__name__, job(), sep="\n")
