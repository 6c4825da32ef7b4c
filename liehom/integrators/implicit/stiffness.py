"""Adaptive runs of explicit steps whose sizes are limited by stability: they are noticed afterwards, and named.

An explicit step is stable for a damping rate K while K h is below its `stability_limit`. An adaptive run whose sizes
stay near that limit takes small steps for stability, not for accuracy, and a step for stiff fields takes fewer. K is
the largest damping rate at samples of the path, from the derivative of psi. Runs with large moves per step are not
tested, so that the test costs a few calls of psi for most runs.
"""

from __future__ import annotations

import warnings

import numpy as np

from liehom.correctors.step import Generator, Step
from liehom.errors import LiehomError, StiffnessWarning
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators.implicit.stability import damping_rates, stability_limit
from liehom.integrators.run.control import length
from liehom.integrators.run.options import Span
from liehom.integrators.run.solution import Solution
from liehom.typing import Array, IntegerArray

MIN_STEPS = 60
"""Shorter runs are not tested."""
SAMPLES = 6
"""Times of a run at which its step size is compared with the limit."""
FRACTION = 0.5
"""A size is limited by stability if it is at least this fraction of the limit."""
LARGE_MOVE = 0.1
"""Runs whose steps move a point by more than this fraction of its norm are limited by accuracy."""


def warn_of_stiffness(
    action: Action, field: GeneratorField, step: Step, orbit_dimension: int | IntegerArray, span: Span,
    solution: Solution, stacklevel: int,
) -> None:  # fmt: skip
    """Issue a `StiffnessWarning` if the sizes of an adaptive run were limited by stability.

    Parameters
    ----------
    action : Action
    field : GeneratorField
        With psi a function of (m, t).
    step : Step
    orbit_dimension : int or array
    span : (float, float)
    solution : Solution
        Of an adaptive run.
    stacklevel : int
        That of `warnings.warn` for the caller.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e3 * np.cross(m, [0, 0, 1.0]))
    >>> with warnings.catch_warnings(record=True) as found:
    ...     warnings.simplefilter("always")
    ...     sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=lh.RKMK("rk45"))
    ...
    >>> found[0].category.__name__, bool(found[0].message.rate > 900)
    ('StiffnessWarning', True)
    """
    steps = np.asarray(solution.n_steps)
    if not bool((steps >= MIN_STEPS).any()) or np.ndim(solution.t) == 0 or np.shape(solution.t)[-1] < 2:
        return
    try:
        with np.errstate(all="ignore"):
            average = abs(float(span[1]) - float(span[0])) / np.maximum(steps, 1)
            found = _limited(action, Generator(field, orbit_dimension), step, solution, steps, average)
    except (LiehomError, ValueError, TypeError, IndexError, np.linalg.LinAlgError):
        return  # psi that cannot be differentiated, or not at these points
    if found is None:
        return
    rate, limit, size, time = found
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
