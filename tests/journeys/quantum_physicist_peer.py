"""Three jobs of a quantum control physicist, with numpy and scipy alone."""

from functools import reduce

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

PAULI = {
    "I": np.eye(2),
    "X": np.array([[0, 1], [1, 0]]),
    "Y": np.array([[0, -1j], [1j, 0]]),
    "Z": np.diag([1, -1]),
}
ANHARMONICITY, WIDTH, CENTRE = -2.0, 2.0, 8.0
DETUNINGS = np.random.default_rng(1).normal(size=200)


def driven_end():
    """The dimension and the name of the dynamical Lie algebra of a chain of three qubits driven at one end."""

    def word(letters):
        return reduce(np.kron, [PAULI[letter] for letter in letters])

    chain = sum(word(2 * p + "I") + word("I" + 2 * p) for p in "XYZ")
    generators = [1j * h for h in (chain, word("XII"), word("ZII"))]
    basis, pending = np.empty((0, 128)), list(generators)
    while pending:
        matrix = pending.pop()
        row = np.concatenate([matrix.real.ravel(), matrix.imag.ravel()])
        for _ in range(2):
            row = row - basis.T @ (basis @ row)
        if np.linalg.norm(row) > 1e-9 * max(1, np.linalg.norm(matrix)):
            row /= np.linalg.norm(row)
            basis = np.vstack([basis, row])
            element = (row[:64] + 1j * row[64:]).reshape(8, 8)
            pending += [element @ g - g @ element for g in generators]
    return len(basis), "su(8)" if len(basis) == 63 else "unknown"


def transmon():
    """The leakage of a Gaussian pi pulse to the third level of a transmon, without and with DRAG."""
    lower = np.diag([1, np.sqrt(2)], 1)
    levels = np.diag([0, 0, ANHARMONICITY])
    x, y = (lower + lower.T) / 2, 1j * (lower.T - lower) / 2

    def rhs(t, state, drag):
        u = (t - CENTRE) / WIDTH
        pulse = np.sqrt(np.pi / 2) / WIDTH * np.exp(-(u**2) / 2)
        slope = -u / WIDTH * pulse
        return -1j * (levels + pulse * x + drag * slope / ANHARMONICITY * y) @ state

    start = np.array([1, 0, 0], dtype=complex)
    runs = [solve_ivp(rhs, (0, 16), start, args=(drag,), rtol=1e-9, atol=1e-11) for drag in (0, -0.5)]
    return [float(abs(run.y[2, -1]) ** 2) for run in runs]


def echo():
    """The mean signal of 200 detuned spins with and without a pi pulse of width 0.1 at t = 5."""
    free = DETUNINGS[:, None] * [0, 0, 1]
    wait = Rotation.from_rotvec(4.95 * free)
    pulses = [Rotation.from_rotvec(0.1 * free + [angle, 0, 0]) for angle in (np.pi, 0)]
    return [(wait * pulse * wait).apply([0, 1, 0]).mean(axis=0) for pulse in pulses]


JOBS = (driven_end, transmon, echo)

if __name__ == "__main__":
    for job in JOBS:
        print(job.__name__, job(), sep="\n")
