"""Stability of steps, and runs that are limited by it."""

from __future__ import annotations

import warnings
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.base.errors import ConvergenceError, LiehomError, StiffnessWarning
from liehom.base.typing import Array, IntegerArray, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.door import adjoint, so
from liehom.flow.methods.stiff import Linearization
from liehom.flow.run.control import clock_at, size_for, unsolvable
from liehom.flow.run.options import Span
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import Generator, LocalStep, Step, length

# Stability of steps: the factor by which a step multiplies a small deviation from an equilibrium, and its limits. The
# field X = lambda y near a point e of S^2, with complex lambda = -K + i omega in the tangent plane, is given by
#     psi(m) = m x X(m) + sigma m,     m' = psi x m = X(m),     X(m) = K (e - <m, e> m) + omega e x m,
# where the isotropy sigma m does not change the field, but changes the steps of most methods. `amplification` measures
# the factor on the manifold, with the code of the step. Without isotropy it is the stability function of the method.

DEVIATION = 1e-5  # distance from the equilibrium, small enough for the field to be linear to 10 digits
MAX_SIZE = 100.0  # steps that damp up to this size count as stable for all sizes


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
        return rate * np.cross(point, up) + turn * (up - point[..., 2:] * point) + isotropy * point

    field = GeneratorField(adjoint(so(3)), psi)
    action, m = Action(field.representation), np.tile([DEVIATION, 0.0, np.sqrt(1 - DEVIATION**2)], (len(flat), 1))
    with np.errstate(all="ignore"):
        local = step.at(action, Generator(field, 2, m), m, np.zeros((len(flat), 1)))
        size: Any = np.ones(len(flat))
        if local.clock and clock == "corrected":
            size = _sizes(local, len(flat))
        result: Any = np.full_like(m, np.nan)
        good = np.isfinite(size)
        for _ in range(2):
            try:
                result = np.where(good[:, None], local.point(np.where(good, size, 0.0)[:, None]), np.nan)
            except ConvergenceError as error:
                good = good & ~unsolvable(local, np.where(good, size, 0.0), good, error)
            else:
                break
    return (np.hypot(result[:, 0], result[:, 1]) / DEVIATION).reshape(values.shape)


def _sizes(local: LocalStep, count: int) -> Array:
    """Parameters s of steps with tau(s) = 1; NaN where the clock is not admissible."""
    size: Array = size_for(local, np.ones(count), np.full(count, 1e-3))
    good, _ = clock_at(local, np.where(np.isfinite(size), size, 0.0))
    return np.where(good & np.isfinite(size), size, np.nan)


@lru_cache(maxsize=64)
def stability_limit(step: Step) -> float:
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
    unstable = np.flatnonzero(~(amplification(step, -grid) <= 1))
    if not unstable.size:
        return float("inf")
    if not unstable[0]:
        return 0.0
    fine = np.linspace(grid[unstable[0] - 1], grid[unstable[0]], 200)
    ends = np.flatnonzero(~(amplification(step, -fine) <= 1))
    return float(fine[ends[0] - 1] if ends.size and ends[0] else fine[-1])


def damping_rates(action: Action, psi: Generator, m: Values, t: Values) -> Array:
    """The largest rate with which deviations are damped, shape (...,): max |Re| over Re lambda < 0, without the
    eigenvalues with |Im| > |Re|, where the solution oscillates itself.
    """
    jacobian = np.asarray(Linearization(action, psi, m, t, 1).jacobian)
    good = np.isfinite(jacobian).all(axis=(-1, -2))
    values = np.linalg.eigvals(np.where(good[..., None, None], jacobian, 0.0))
    damped = np.where(np.abs(values.imag) <= -values.real, -values.real, 0.0)
    return damped.max(axis=-1, initial=0.0)


# Adaptive runs of explicit steps whose sizes are limited by stability: they are noticed afterwards, and named. An
# explicit step is stable for a damping rate K while K h is below its `stability_limit`. An adaptive run whose sizes
# stay near that limit takes small steps for stability, not for accuracy, and a step for stiff fields takes fewer. K is
# the largest damping rate at samples of the path, from the derivative of psi. Runs with large moves per step are not
# tested, so that the test costs a few calls of psi for most runs.

MIN_STEPS = 60  # shorter runs are not tested
SAMPLES = 6  # times of a run at which its step size is compared with the limit
FRACTION = 0.5  # a size is limited by stability if it is at least this fraction of the limit
LARGE_MOVE = 0.1  # runs whose steps move a point by more than this fraction of its norm are limited by accuracy


def warn_of_stiffness(
    action: Action, field: GeneratorField, step: Step, orbit_dimension: int | IntegerArray, span: Span,
    solution: Solution, stacklevel: int,
) -> None:  # fmt: skip
    """Issue a `StiffnessWarning` if the sizes of an adaptive run were limited by stability."""
    steps = np.asarray(solution.n_steps)
    if not bool((steps >= MIN_STEPS).any()) or np.ndim(solution.t) == 0 or np.shape(solution.t)[-1] < 2:
        return
    try:
        with np.errstate(all="ignore"):
            average = abs(float(span[1]) - float(span[0])) / np.maximum(steps, 1)
            limited = _limited(action, Generator(field, orbit_dimension), step, solution, steps, average)
    except (LiehomError, ValueError, TypeError, IndexError, np.linalg.LinAlgError):
        return  # psi that cannot be differentiated, or not at these points
    if limited is None:
        return
    rate, limit, size, time = limited
    text = (
        f"the step sizes of {step!r} were limited by stability, not by accuracy: at t = {time:.6g} deviations are "
        f"damped with the rate {rate:.3g}, which allows sizes up to {limit / rate:.3g}, and the size was {size:.3g} "
        f"(up to {int(steps.max())} steps). Take a step for stiff fields: StiffRKMK('radau5'), Rosenbrock('rodas4') "
        "or ExponentialRosenbrock(4)."
    )
    warnings.warn(StiffnessWarning(text, rate, time), stacklevel=stacklevel + 1)


def _limited(
    action: Action, psi: Generator, step: Step, solution: Solution, steps: IntegerArray, average: Array
) -> tuple[float, float, float, float] | None:
    """(rate, limit of rate times size, size, time) of the first sample, if most samples are limited by stability."""
    times, points = np.asarray(solution.t), np.asarray(solution.y)
    count = times.shape[-1]
    samples = np.unique(np.linspace(count // 8, count - 2, SAMPLES).astype(int))
    every = times.ndim == points.ndim - 1 and count > int(steps.max())  # one row for each step
    limit, hits, first = None, 0, None
    for k in samples:
        t, m = times[..., k], points[..., k]
        size: Array = np.abs(times[..., k + 1] - t) if every else average
        t = np.broadcast_to(t, m.shape[:-1])
        good = np.isfinite(m).all(axis=-1) & np.isfinite(size) & (steps >= MIN_STEPS)
        m = np.where(good[..., None], m, points[..., 0])
        moved = size * length(psi.field.vector(m, t)) / length(m)
        good = good & (moved < LARGE_MOVE)
        if not bool(np.any(good)):
            continue
        rates = damping_rates(action, psi, m, t[..., None])
        limit = stability_limit(step) if limit is None else limit
        hit = good & (size * rates > FRACTION * limit)
        if bool(np.any(hit)):
            hits += 1
            at = int(np.argmax(np.where(hit, rates, 0.0)))
            here = [float(np.ravel(np.broadcast_to(x, rates.shape))[at]) for x in (rates, size, t)]
            first = (here[0], limit, here[1], here[2]) if first is None else first
    return first if 2 * hits > len(samples) else None
