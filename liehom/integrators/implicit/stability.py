"""Stability of steps: the factor by which a step multiplies a small deviation from an equilibrium, and its limits.

The field X = lambda y near a point e of S^2, with complex lambda = -K + i omega in the tangent plane, is given by

    psi(m) = m x X(m) + sigma m,     m' = psi x m = X(m),     X(m) = K (e - <m, e> m) + omega e x m,

where the isotropy sigma m does not change the field, but changes the steps of most methods. `amplification` measures
the factor on the manifold, with the code of the step. Without isotropy it is the stability function of the method.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators.implicit.linearization import Linearization
from liehom.integrators.run.clock import clock_at, size_for
from liehom.integrators.run.control import unsolvable
from liehom.representations import adjoint
from liehom.typing import Array, Values

DEVIATION = 1e-5
"""Distance from the equilibrium, small enough for the field to be linear to 10 digits."""
MAX_SIZE = 100.0
"""Steps that damp up to this size count as stable for all sizes."""


def amplification(step: Step, z: npt.ArrayLike, *, isotropy: float = 0.0, clock: str = "corrected") -> Array:
    """Factors |y(after)| / |y(before)| of steps with lambda dt = z, of the shape of z; NaN where the step fails.

    Parameters
    ----------
    step : Step
    z : array_like of complex numbers
        lambda dt, where dt is the time that passes.
    isotropy : float
        sigma dt, the isotropy of psi at the equilibrium.
    clock : "corrected" or "nominal"
        As for `integrate`.

    Examples
    --------
    >>> import liehom as lh
    >>> amplification(lh.Euler(), [-0.5, -1.5, -3.0]).round(6).tolist()
    [0.5, 0.5, 2.0]
    >>> amplification(lh.BackwardEuler(), [-1.0, -1000.0]).round(6).tolist()
    [0.5, 0.000999]
    """
    values = np.asarray(z, dtype=complex)
    flat = np.atleast_1d(values).ravel()
    rate, turn = -flat.real[:, None], flat.imag[:, None]
    up = np.array([0.0, 0.0, 1.0])

    def psi(m: Values) -> Values:
        point: Any = m
        along = point[..., 2:]
        found: Values = rate * np.cross(point, up) + turn * (up - along * point) + isotropy * point
        return found

    field = GeneratorField(adjoint(so(3)), psi)
    action, m = Action(field.representation), np.tile([DEVIATION, 0.0, np.sqrt(1 - DEVIATION**2)], (len(flat), 1))
    with np.errstate(all="ignore"):
        local = step.at(action, Generator(field, 2, m), m, np.zeros((len(flat), 1)))
        size: Any = np.ones(len(flat))
        if local.clock and clock == "corrected":
            size = _sizes(local, len(flat))
        made: Any = np.full_like(m, np.nan)
        good = np.isfinite(size)
        for _ in range(2):
            try:
                made = np.where(good[:, None], local.point(np.where(good, size, 0.0)[:, None]), np.nan)
            except ConvergenceError as error:
                good = good & ~unsolvable(local, np.where(good, size, 0.0), good, error)
            else:
                break
    found: Array = (np.hypot(made[:, 0], made[:, 1]) / DEVIATION).reshape(values.shape)
    return found


def _sizes(local: LocalStep, count: int) -> Array:
    """Parameters s of steps with tau(s) = 1; NaN where the clock is not admissible."""
    size: Array = size_for(local, np.ones(count), np.full(count, 1e-3))
    good, _ = clock_at(local, np.where(np.isfinite(size), size, 0.0))
    return np.where(good & np.isfinite(size), size, np.nan)


@lru_cache(maxsize=64)
def stability_limit(step: Step, *, clock: str = "corrected") -> float:
    """The largest K dt up to which a step damps m' = -K y near an equilibrium, a float; inf if it is above 100.

    Examples
    --------
    >>> import liehom as lh
    >>> round(stability_limit(lh.Euler()), 3), round(stability_limit(lh.RKMK("rk4")), 3)
    (2.0, 2.785)
    >>> stability_limit(lh.BackwardEuler())
    inf
    """
    grid = np.concatenate([np.linspace(0.02, 20, 1000), np.linspace(20.1, MAX_SIZE, 800)])
    unstable = np.flatnonzero(~(amplification(step, -grid, clock=clock) <= 1))
    if not unstable.size:
        return float("inf")
    if not unstable[0]:
        return 0.0
    fine = np.linspace(grid[unstable[0] - 1], grid[unstable[0]], 200)
    ends = np.flatnonzero(~(amplification(step, -fine, clock=clock) <= 1))
    return float(fine[ends[0] - 1] if ends.size and ends[0] else fine[-1])


def damping_rates(action: Action, psi: Generator, m: Values, t: Values) -> Array:
    """The largest rate with which deviations from a trajectory are damped, shape (...,): max |Re| over Re lambda < 0.

    Eigenvalues whose imaginary part is larger than the real part do not count: there the solution oscillates itself.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 5 * np.cross(m, [0, 0, 1.0]))
    >>> float(damping_rates(lh.Action(field.representation), Generator(field, 2), np.array([0, 0, 1.0]), np.zeros(1)))
    5.0
    """
    jacobian = np.asarray(Linearization(action, psi, m, t, 1).jacobian)
    good = np.isfinite(jacobian).all(axis=(-1, -2))
    values = np.linalg.eigvals(np.where(good[..., None, None], jacobian, 0.0))
    damped = np.where(np.abs(values.imag) <= -values.real, -values.real, 0.0)
    found: Array = damped.max(axis=-1, initial=0.0)
    return found
