"""Three jobs of a physicist in quantum control: `python tests/journeys/quantum_physicist.py`."""

import itertools

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import liehom as lh


def driven_end() -> tuple[int, str, int]:
    """A Heisenberg chain of three qubits, the first one driven: dimension and name, and dimension by matrices."""
    words = ["XXI + YYI + ZZI", "IXX + IYY + IZZ", "XII", "ZII"]
    algebra = lh.pauli.closure(words)
    letters = {"I": np.eye(2), "X": [[0, 1], [1, 0]], "Y": [[0, -1j], [1j, 0]], "Z": [[1, 0], [0, -1]]}

    def matrix(text: str) -> np.ndarray:
        return sum(np.kron(np.kron(letters[a], letters[b]), letters[c]) for a, b, c in text.split(" + "))

    found = [1j * matrix(text) for text in words]
    while True:
        more = [a @ b - b @ a for a, b in itertools.combinations(found, 2)]
        rows = np.array([np.concatenate([m.real.ravel(), m.imag.ravel()]) for m in [*found, *more]])
        left = np.linalg.svd(rows.T, full_matrices=False)
        rank = int((left[1] > 1e-9 * left[1][0]).sum())
        if rank == len(found):
            return algebra.dimension, algebra.name, rank
        found = [(u[:64] + 1j * u[64:]).reshape(8, 8) for u in left[0].T[:rank]]


def transmon() -> tuple[list[float], float]:
    """Leakage of a pi pulse into the third level without and with a DRAG term; an error beside solve_ivp."""
    low = np.diag([1, np.sqrt(2)], 1)
    number = np.diag([0, 1, 2])
    matrices = [low + low.T, -1j * low + 1j * low.T, number @ (number - np.eye(3))]
    anharmonicity, width, middle = -2.0, 2.0, 8.0
    rho = lh.Representation.from_matrices(matrices, hermitian=True)
    drive_x, drive_y, detune = (rho.element(m, hermitian=True) for m in matrices)
    columns = np.array([[float(x) for x in e] for e in (drive_x, drive_y, detune)])

    def envelope(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        shape = np.sqrt(np.pi) / (2 * width) * np.exp(-(((t - middle) / width) ** 2))
        return shape, -2 * (t - middle) / width**2 * shape

    def psi(m: np.ndarray, t: np.ndarray, drag: float) -> np.ndarray:
        shape, slope = envelope(t)
        parts = np.stack([shape, -drag * slope / anharmonicity, anharmonicity / 2 + 0 * t], -1)
        return -parts @ columns  # the algebra has i H, and the evolution is exp(-i H t)

    field = lh.GeneratorField(rho, psi)
    start = np.array([1, 0, 0], dtype=complex)
    ends = []
    for drag in (0.0, 0.5):
        sol = lh.integrate(field, (0, 16), start.view(float), args=drag, rtol=1e-9, atol=1e-11)
        ends.append(sol.y[:, -1].copy().view(complex))

    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        shape, slope = envelope(np.array(t))
        return (
            -1j
            * (shape * matrices[0] - 0.5 * slope / anharmonicity * matrices[1] + anharmonicity / 2 * matrices[2])
            @ y
        )

    peer = solve_ivp(rhs, (0, 16), start, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    return [float(abs(end[2]) ** 2) for end in ends], float(abs(ends[1] - peer).max())


def echo() -> tuple[float, float, float]:
    """The mean signal of 200 detuned spins after a free decay and after an echo; the error beside expm."""
    detunings = np.random.default_rng(1).normal(0.0, 1.0, 200)

    def psi(m: np.ndarray, t: np.ndarray, args: dict[str, np.ndarray]) -> np.ndarray:
        pulse = args["area"] / (0.1 * np.sqrt(np.pi)) * np.exp(-(((t - 5) / 0.1) ** 2))
        return np.stack([pulse, 0 * t, args["detuning"] + 0 * t], -1)

    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    signals = []
    for area in (0.0, np.pi):
        args = {"area": area, "detuning": lh.PerTrajectory(detunings)}
        signals.append(lh.integrate(field, (0, 10), [0, 1, 0], args=args, rtol=1e-8, atol=1e-10).y_end)
    around_z = [expm(np.array([[0, -d, 0], [d, 0, 0], [0, 0, 0]]) * 10) @ [0, 1, 0] for d in detunings]
    lengths = [float(np.linalg.norm(s.mean(axis=0)[:2])) for s in signals]
    return lengths[0], lengths[1], float(abs(signals[0] - around_z).max())


JOBS = (driven_end, transmon, echo)

if __name__ == "__main__":
    for job in JOBS:
        print(f"{job.__name__}: {job()}")
