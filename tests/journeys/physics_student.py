"""Three jobs of a physics student: the symmetry of hydrogen, a qubit in an oscillating field, the eightfold way."""

import numpy as np
from scipy.integrate import solve_ivp

import liehom as lh


def hydrogen() -> list[tuple[str, str]]:
    """Symmetry and second Casimir operator of the Kepler problem for energies below 0, 0 and above 0."""
    found = []
    for k in (2, 0, -2):  # [A_i, A_j] = -2 E L_k
        brackets: dict[tuple[int, int], dict[int, int]] = {}
        for i, j, n, s in ((0, 1, 2, 1), (1, 2, 0, 1), (0, 2, 1, -1)):
            brackets |= {(i, j): {n: s}, (i, 3 + j): {3 + n: s}, (j, 3 + i): {3 + n: -s}}
            if k:
                brackets[3 + i, 3 + j] = {n: s * k}
        g = lh.LieAlgebra(brackets, basis=["L1", "L2", "L3", "A1", "A2", "A3"])
        found.append((lh.structure_name(g), " ".join(map(str, g.casimirs(2).polynomials))))
    return found


def rabi() -> tuple[float, float]:
    """Transition probability of a driven qubit: largest distances from scipy, and from the rotating wave."""
    level, drive, times = 5.0, 0.4, np.linspace(0, 20, 101)
    rho = lh.Representation.from_matrices(lh.algebra.pauli_matrices(), hermitian=True)

    def psi(m: np.ndarray, t: np.ndarray) -> np.ndarray:
        return np.stack([-drive * np.cos(level * t), 0 * t, -level / 2 + 0 * t], axis=-1)

    start = rho.real_point([0, 1])
    y = lh.integrate(lh.GeneratorField(rho, psi), (0, 20), start, t_eval=times, rtol=1e-9).y
    up = y[0] ** 2 + y[1] ** 2

    def right_side(t: float, z: np.ndarray) -> np.ndarray:
        c = drive * np.cos(level * t)
        return -1j * np.array([[level / 2, c], [c, -level / 2]]) @ z

    peer = solve_ivp(right_side, (0, 20), np.array([0, 1], complex), t_eval=times, rtol=1e-9, atol=1e-11)
    return float(abs(up - abs(peer.y[0]) ** 2).max()), float(abs(up - np.sin(drive * times / 2) ** 2).max())


def eightfold_way() -> tuple[list[int], str, str]:
    """Three quarks by dimensions, and octet and decuplet by isospin and hypercharge."""
    dimensions = []
    for weight in lh.tensor_product_decomposition("A2", [1, 0], [1, 0]):
        for other, times in lh.tensor_product_decomposition("A2", weight, [1, 0]).items():
            dimensions += [lh.weyl_dimension("A2", other)] * times
    rule = lh.branching_rule("su(3)", "su(2)+u(1)", charges="1/3")
    return sorted(dimensions), str(rule("8")), str(rule("10"))
