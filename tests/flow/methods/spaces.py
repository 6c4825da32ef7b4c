"""Lie-Poisson systems for the tests of symplectic steps, and the defect of a step as a Poisson map."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

import liehom as lh
from liehom.flow.steps.step import Generator

DIFFERENCES = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
"""Weights of central differences of order 8."""
SPACING = 1e-3


class System(NamedTuple):
    """A Hamiltonian system on the dual of an algebra, with a point."""

    algebra: lh.LieAlgebra
    energy: Any
    sign: int
    start: Any

    @property
    def field(self) -> lh.GeneratorField:
        return lh.hamiltonian_field(self.algebra, self.energy, sign=self.sign)


def quadratic(w: Any) -> Any:
    return lambda m: np.sum(w * m * m, axis=-1) / 2


@cache
def system(name: str) -> System:
    start = np.cos(np.arange(1.0, 20.0))
    if name == "so(3)":
        return System(
            lh.so(3), lambda m: quadratic(np.array([1 / 2, 1 / 3, 1 / 4]))(m) + np.sin(m[..., 0]) / 9, -1, start[:3]
        )
    if name == "body":
        return System(lh.so(3), quadratic(np.array([1 / 2, 1 / 3, 1 / 4])), -1, start[:3])
    if name == "body in R^4":
        places = [np.nonzero(a.to_numpy())[0] for a in lh.defining(lh.so(4)).matrices]
        moments = np.array([np.array([1.0, 2.0, 3.5, 5.0])[place].sum() for place in places])
        return System(lh.so(4), quadratic(1 / moments), 1, start[:6])
    if name == "three spins":  # of different lengths, with exchange and anisotropy
        spins = lh.direct_sum(lh.so(3), lh.so(3), lh.so(3))

        def energy(m: Any) -> Any:
            a, b, c = m[..., :3], m[..., 3:6], m[..., 6:]
            return np.sum(a * b + b * c + a * c * 0.3, axis=-1) + m[..., 2] ** 2 + 0.4 * m[..., 3]

        return System(spins, energy, 1, start[:9])
    if name == "su(3)":
        return System(lh.su(3), lambda m: quadratic(np.arange(1, 9) / 8)(m) + m[..., 0] ** 3 / 5, 1, start[:8] / 2)
    if name == "sp(4,R)":
        return System(lh.sp(4, "R"), quadratic(np.arange(1, 11) / 10), 1, start[:10] / 2)
    if name == "heavy top":
        w = np.array([1.0, 1 / 2, 1 / 3, 0, 0, 0])
        return System(lh.euclidean(3), lambda m: quadratic(w)(m) + m[..., 5], -1, start[:6])
    raise KeyError(name)


def moved(step: lh.Step, given: System, m: Any, h: float, t: float = 0.0) -> Any:
    """The points after a step of size h."""
    field = given.field
    psi = Generator(field, 2)
    return step.at(lh.Action(field.representation), psi, m, np.full((*m.shape[:-1], 1), t)).point(
        np.full((*m.shape[:-1], 1), h)
    )


def poisson_defect(step: lh.Step, given: System, h: float) -> float:
    """The largest entry of Df K(m) Df^T - K(f(m)) for the step f, by differences."""
    m, n = given.start, len(given.start)
    rows = sum(
        w * (moved(step, given, m + k * SPACING * np.eye(n), h) - moved(step, given, m - k * SPACING * np.eye(n), h))
        for k, w in DIFFERENCES.items()
    )
    jacobian = np.asarray(rows).T / SPACING
    before = lh.action.lie_poisson_tensor(given.algebra, m, sign=given.sign)
    after = lh.action.lie_poisson_tensor(given.algebra, moved(step, given, m, h), sign=given.sign)
    return float(np.abs(jacobian @ before @ jacobian.T - after).max())
