"""The jobs of the researcher with scipy alone."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

E = np.array([[0, 0, 0, 0], [3, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0]], dtype=float)
F = np.array([[0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 3], [0, 0, 0, 0]], dtype=float)
BASIS = [E, F, np.diag([3.0, 1.0, -1.0, -3.0])]


def matrix(m, t):
    """The matrix of the generator on cubics."""
    psi = 0.5 + 0.3 * np.sin(t) + 0.1 * m[0], 0.4 * np.cos(2 * t) - 0.2 * m[3], 0.3 * m[1]
    return sum(c * a for c, a in zip(psi, BASIS, strict=True))


def euler_on_cubics(dt):
    """Lie-Euler; the correction by isotropy would have to be derived by hand."""
    m = np.array([1.0, 0, 0, 0])
    for k in range(round(0.5 / dt)):
        m = expm(dt * matrix(m, k * dt)) @ m
    return m


def hat(x):
    """The matrix of y -> x cross y."""
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def driven(m, t):
    """A rigid body with a drive, in the basis of the rotations about the axes."""
    return np.array([np.sin(t) - m[0], -m[1] / 2, np.cos(2 * t) - m[2] / 3])


def commutator_free(dt):
    """The method of order 4 with two exponentials."""
    m = np.array([0.6, 0.0, 0.8])
    for k in range(round(1 / dt)):
        t = k * dt
        k1 = dt * driven(m, t)
        middle = expm(hat(k1 / 2)) @ m
        k2 = dt * driven(middle, t + dt / 2)
        k3 = dt * driven(expm(hat(k2 / 2)) @ m, t + dt / 2)
        k4 = dt * driven(expm(hat(k3 - k1 / 2)) @ middle, t + dt)
        m = expm(hat((3 * k1 + 2 * k2 + 2 * k3 - k4) / 12)) @ m
        m = expm(hat((-k1 + 2 * k2 + 2 * k3 + 3 * k4) / 12)) @ m
    return m


def order(method, exact, dt):
    """The order between two step sizes."""
    one, two = (np.linalg.norm(method(h) - exact) for h in (dt, dt / 2))
    return np.log2(one / two)


COUPLING = np.array([1.0, 0.5, -0.7])


def spins(_, m):
    """Two coupled spins."""
    a, b = m[:3], m[3:]
    return np.concatenate([np.cross(a, COUPLING * b + [0, 0, 0.6 * a[2]]), np.cross(b, COUPLING * a)])


if __name__ == "__main__":
    tight = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    exact = solve_ivp(lambda t, m: matrix(m, t) @ m, (0, 0.5), [1.0, 0, 0, 0], **tight).y[:, -1]
    print(f"Euler on cubics: order {order(euler_on_cubics, exact, 0.01):.2f}")
    exact = solve_ivp(lambda t, m: np.cross(driven(m, t), m), (0, 1), [0.6, 0, 0.8], **tight).y[:, -1]
    print(f"commutator-free: order {order(commutator_free, exact, 0.1):.2f}")
    sol = solve_ivp(spins, (0, 200), [0.6, 0, 0.8, 0, 0.6, -0.8], rtol=1e-6)
    print(f"off the spheres by {abs(np.linalg.norm(sol.y[:3], axis=0) - 1).max():.0e} at t = 200")
