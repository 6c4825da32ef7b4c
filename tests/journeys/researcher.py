"""A researcher in geometric integration: an action of his own, methods of his own, energy over many steps.

Three jobs that no page of the documentation contains. Every number is compared with numpy and scipy.
"""

from __future__ import annotations

import importlib.util
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import liehom as lh
from liehom.flow.convergence import Reference

# sl(2) on binary cubics a x^3 + b x^2 y + c x y^2 + d y^3: y d/dx, x d/dy and their bracket
RAISE = [[0, 0, 0, 0], [3, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0]]
LOWER = [[0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 3], [0, 0, 0, 0]]
WEIGHT = [[3, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, -3]]
CUBICS = np.array([RAISE, LOWER, WEIGHT], dtype=float)


def turning(m, t):
    """A generator on cubics that depends on the point and on the time."""
    return np.stack(
        [0.5 + 0.3 * np.sin(t) + 0.1 * m[..., 0], 0.4 * np.cos(2 * t) - 0.2 * m[..., 3], 0.3 * m[..., 1]], -1
    )


def hessian(m):
    """The discriminating quadrics of a cubic; all vanish on cubes of linear forms."""
    a, b, c, d = m
    return np.array([b * b - 3 * a * c, b * c - 9 * a * d, c * c - 3 * b * d])


def solvable(m):
    """Whether Theorem 5 of the paper can raise Euler's step at m, by least squares in numpy alone."""
    rho = np.einsum("aij,j->ia", CUBICS, m)
    isotropy = np.linalg.svd(rho)[2][np.linalg.matrix_rank(rho) :]
    psi = turning(m, 0.0)
    speed, h = rho @ psi, 1e-6
    change = (turning(m + h * speed, h) - turning(m - h * speed, -h)) / (2 * h)
    columns = [np.einsum("a,aij,j->i", z, CUBICS, speed) for z in isotropy]
    system = np.stack([*columns, speed], axis=-1)
    wanted = rho @ change
    return bool(np.linalg.norm(system @ np.linalg.lstsq(system, wanted)[0] - wanted) < 1e-6 * np.linalg.norm(wanted))


def binary_cubics():
    """Order 4 from Euler's step on cubes of linear forms, and nothing on cubics without isotropy."""
    rho = lh.Representation.from_matrices([RAISE, LOWER, WEIGHT], name="binary cubics")
    field = lh.GeneratorField(rho, turning)
    step, span = lh.Corrected(lh.Euler(), order=4), (0, 0.3)
    for m, dimension, raised in (([1, 0, 0, 0], 2, True), ([1, 0, 0, 1], 3, False)):
        print(f"{m}: orbit of dimension {rho.orbit_dimension(m)}; {lh.classify_range(rho.pair(m))}")
        table = lh.observed_order(field, m, step, [0.025, 0.0125], t_span=span)
        print(table)
        assert rho.orbit_dimension(m) == dimension == np.linalg.matrix_rank(np.einsum("aij,j->ia", CUBICS, m))
        assert solvable(np.array(m, dtype=float)) == raised
        assert all(abs(order - (4 if raised else 1)) < 0.2 for order in table.orders)
    exact = solve_ivp(
        lambda t, m: np.einsum("a,aij,j->i", turning(m, t), CUBICS, m), span, [1.0, 0, 0, 0], rtol=1e-12, atol=1e-13
    )
    sol = lh.integrate(field, span, [1.0, 0, 0, 0], step=step, dt=0.005)
    end, drift = sol.y[:, -1], float(np.abs(hessian(sol.y[:, -1])).max())
    print(f"error {np.abs(end - exact.y[:, -1]).max():.1e}; off the cubes by {drift:.1e}")
    assert np.allclose(end, exact.y[:, -1], rtol=0, atol=2e-9)
    assert drift < 1e-12


class CommutatorFree(lh.Step):
    """The method of order 4 with two exponentials of Celledoni, Marthinsen and Owren (2003)."""

    order = 4

    def factors(self, action, psi, m, t, h):
        """The generators of the two exponentials, the first one to act first."""
        first = h * psi(m, t)
        middle = action.act(first / 2, m)
        second = h * psi(middle, t + h / 2)
        third = h * psi(action.act(second / 2, m), t + h / 2)
        fourth = h * psi(action.act(third - first / 2, middle), t + h)
        return (
            (3 * first + 2 * second + 2 * third - fourth) / 12,
            (-first + 2 * second + 2 * third + 3 * fourth) / 12,
        )


class Magnus(lh.steps.OneExponential):
    """Magnus' series to order 2 by the midpoint rule."""

    order = 2

    def generator(self, action, psi, m, t, h):
        """The generator of the exponential."""
        return h * psi(action.act(h / 2 * psi(m, t), m), t + h / 2)


def driven(m, t):
    """A rigid body with a drive."""
    return np.stack([np.sin(t) - m[..., 0], -m[..., 1] / 2, np.cos(2 * t) - m[..., 2] / 3], -1)


def own_methods():
    """Orders of a tableau, of a commutator-free and of a Magnus method of his own, beside those of the library."""
    tableau = lh.methods.Tableau(
        [[0, 0, 0, 0], ["2/5", 0, 0, 0], ["-3/20", "3/4", 0, 0], ["19/44", "-15/44", "10/11", 0]],
        ["11/72", "25/72", "25/72", "11/72"],
        name="mine",
    )
    start, rho = [0.6, 0.0, 0.8], lh.adjoint(lh.so(3))
    field = lh.GeneratorField(rho, driven)
    steps = {lh.RKMK(tableau): 4, CommutatorFree(): 4, Magnus(): 2, lh.Corrected(Magnus(), 4): 4, lh.RKMK("rk4"): 4}
    exact = Reference(field, np.array(start, dtype=np.longdouble))
    for step, order in steps.items():
        table = lh.observed_order(field, start, step, [0.05, 0.025], reference=exact)
        print(f"{step!s:32} {table.trajectory_errors[-1]:.1e}  order {table.orders[1]:.2f}")
        assert abs(table.orders[1] - order) < 0.3, step
    hats = [a.to_numpy() for a in rho.matrices]

    def exp(x):
        return expm(sum(c * a for c, a in zip(x, hats, strict=True)))

    h, m = 0.1, np.array(start)
    k1 = h * driven(m, 0)
    middle = exp(k1 / 2) @ m
    k2 = h * driven(middle, h / 2)
    k3 = h * driven(exp(k2 / 2) @ m, h / 2)
    k4 = h * driven(exp(k3 - k1 / 2) @ middle, h)
    expected = exp((-k1 + 2 * k2 + 2 * k3 + 3 * k4) / 12) @ exp((3 * k1 + 2 * k2 + 2 * k3 - k4) / 12) @ m
    one = lh.integrate(field, (0, h), start, step=CommutatorFree(), dt=h).y[:, -1]
    print(f"one step of the commutator-free method, against expm: {np.abs(one - expected).max():.1e}")
    assert np.allclose(one, expected, rtol=0, atol=1e-14)


COUPLING = np.array([1.0, 0.5, -0.7])


def energy(m):
    """Two spins with an anisotropic coupling and an axis for the first one."""
    return (COUPLING * m[..., :3] * m[..., 3:]).sum(-1) + 0.3 * m[..., 2] ** 2


def midpoints(m, h, count):
    """The spherical midpoint rule of two spins, in numpy."""
    for _ in range(count):
        end = m
        for _ in range(60):
            middle = (m + end).reshape(2, 3)
            middle = middle / np.linalg.norm(middle, axis=1)[:, None]
            (a, b), axis = middle, np.array([0, 0, 0.6 * middle[0, 2]])
            end = m + h * np.concatenate([np.cross(a, COUPLING * b + axis), np.cross(b, COUPLING * a)])
        m = end
    return m


def two_spins(steps=10_000):
    """Energy on a product of spheres over many steps: bounded, drifting, and conserved to round-off."""
    algebra = lh.catalog.algebra("so(3)+so(3)")
    field = lh.hamiltonian_field(algebra, energy, sign=-1)
    start, dt = np.array([0.6, 0, 0.8, 0, 0.6, -0.8]), 0.1
    fast = importlib.util.find_spec("llvmlite") is not None
    steps = steps if fast else 500
    methods = {"midpoint": lh.SphericalMidpoint(), "RKMK": lh.RKMK("rk4")}
    if fast and steps > 10_000:
        methods["conserving"] = lh.Conserving(lh.RKMK("rk4"), energy)
    largest = {}
    for name, step in methods.items():
        sol = lh.integrate(field, (0, dt * steps), start, step=step, dt=dt, engine="llvm" if fast else "numpy")
        error = np.abs(energy(sol.y.T) - energy(start))
        radii = np.linalg.norm(sol.y.reshape(2, 3, -1), axis=1)
        largest[name] = error[: steps // 10 + 1].max(), error.max()
        print(f"{name:12} energy off by {largest[name][0]:.1e} in a tenth of the time, by {error.max():.1e} in all")
        assert np.allclose(radii, 1, rtol=0, atol=1e-12)
        if name == "midpoint":
            assert np.allclose(sol.y[:, 200], midpoints(start, dt, 200), rtol=0, atol=1e-11)
    assert largest["midpoint"][1] < 2e-4
    if fast:
        assert largest["midpoint"][1] < 1.1 * largest["midpoint"][0]
        assert largest["RKMK"][1] > 5 * largest["RKMK"][0]
    assert largest.get("conserving", (0, 0))[1] < 1e-14


if __name__ == "__main__":
    binary_cubics()
    own_methods()
    two_spins(100_000 if "--long" in sys.argv else 10_000)
