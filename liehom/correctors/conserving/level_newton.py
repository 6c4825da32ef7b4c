"""Newton's method for the isotropy that puts a step on a level set of first integrals (Proposition 10).

The unknown is an element x of V_m, the complement of ker chi_m in g_m.  The first Jacobian is that of Corollary 11
along the step, e DF(m) rho(x) (step - m).  Broyden's updates correct it by the differences observed, which for
one integral is the secant method.  Residuals are measured in units of the round-off of F.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.conserving.conservation import RANK_RTOL
from liehom.tracing import Traced, while_loop
from liehom.typing import Array, BooleanArray, Values

MAX_ITERATIONS = 20
MAX_STALLED_ITERATIONS = 2
"""The iteration ends after this many iterations that did not reduce the residual."""
MIN_RESOLVED_UNITS = 32.0
"""A direction along which one radian changes F by less than this many units of round-off is not used: near an
equilibrium F does not resolve the orbits."""


@final
@dataclass(frozen=True, slots=True)
class LevelSolution:
    """Solution found by Newton's method.

    Attributes
    ----------
    x : array of shape (..., dim g), or None
        The isotropy to be added; None if it is 0 in all trajectories.
    residual : array of shape (..., k)
        F - target with this x.
    iterations : array of int, shape (...,)
    resolved : array of int, shape (...,)
        Number of directions in which F resolves the change by isotropy.
    """

    x: Values | None
    residual: Values
    iterations: Values
    resolved: Values


def solve_levels(
    residual: Callable[[Any], Any], first: Values, directions: Values, jacobian: Values, unit: Values, size: float
) -> LevelSolution:
    """`LevelSolution` x in the span of `directions` with residual(x) = 0 to round-off.

    Parameters
    ----------
    residual : callable
        x (..., dim g) -> F - target, shape (..., k).
    first : array of shape (..., k)
        residual(0).
    directions : array of shape (..., dim g, q)
        Orthonormal, or columns of zeros.
    jacobian : array of shape (..., k, q)
        Approximate Jacobian of residual at 0, in these directions.
    unit : array of shape (..., k)
        Residuals up to this size are round-off.
    size : float
        The largest norm of rho(x) for |x| = 1. An iteration moves by at most one radian.

    Notes
    -----
    Proposition 10 of the paper with V_m = (ker chi_m)^perp. Equations that isotropy does not reach are omitted.

    Examples
    --------
    >>> found = solve_levels(lambda x: np.sin(x) - 0.5, np.array([-0.5]), np.eye(1), np.eye(1), np.array([1e-16]), 1.0)
    >>> bool(np.isclose(found.x[0], np.pi / 6, rtol=1e-15)), bool(found.iterations < 8)
    (True, True)
    """
    units: Any = np.maximum(unit, float(np.finfo(first.dtype).tiny))
    if type(first) is Traced:
        return _on_tape(residual, first, directions[:, 0], jacobian[0, 0], units, size)
    start: Any = first
    slope: Any = jacobian
    if jacobian.shape == (1, 1):
        return _of_one(residual, start, directions[:, 0], slope.item(), units.item(), size)
    project, lift, slopes, kept = _reduced(slope / units[..., None], MIN_RESOLVED_UNITS * size)
    resolved = kept.sum(axis=-1)
    r = (project @ (first / units)[..., None])[..., 0]
    active = np.abs(r).max(axis=-1, initial=0.0) > 1
    iterations = np.zeros(active.shape, dtype=int)
    if not active.any():
        return LevelSolution(None, first, iterations, resolved)
    turn = directions @ lift
    inverse = np.where(kept, 1 / np.where(kept, slopes, 1.0), 0.0)[..., None] * np.eye(kept.shape[-1], dtype=r.dtype)
    c, left, stalled = 0 * r, first, 0 * iterations
    for _ in range(MAX_ITERATIONS):
        step = _limited(-(inverse @ r[..., None])[..., 0], 1 / size) * active[..., None]
        value = residual((turn @ (c + step)[..., None])[..., 0])
        made = (project @ (value / units)[..., None])[..., 0]
        iterations = iterations + active
        inverse = _updated(inverse, step, made - r)
        better = active & (_square(made) < _square(r))
        c, r = np.where(better[..., None], c + step, c), np.where(better[..., None], made, r)
        left = np.where(better[..., None], value, left)
        stalled = np.where(better, stalled, stalled + 1)
        active = active & (np.abs(r).max(axis=-1) > 1) & (stalled < MAX_STALLED_ITERATIONS)
        if not active.any():
            break
    return LevelSolution((turn @ c[..., None])[..., 0], left, iterations, resolved)


def _of_one(
    residual: Callable[[Any], Any], first: Array, direction: Array, slope: float, unit: float, size: float
) -> LevelSolution:
    """`solve_levels` for one trajectory, one integral and one direction, without the overhead of arrays."""
    resolved = abs(slope) > MIN_RESOLVED_UNITS * size * unit
    best = value = first.item()
    if not resolved or not abs(value) > unit:
        return LevelSolution(None, first, np.array(0), np.array(int(resolved)))
    c, x, left = 0.0, None, first
    iterations = stalled = 0
    while abs(best) > unit and stalled < MAX_STALLED_ITERATIONS and iterations < MAX_ITERATIONS:
        step = -best / slope
        if abs(step) > 1 / size:
            step = 1 / size if step > 0 else -1 / size
        trial = (c + step) * direction
        made = residual(trial)
        iterations += 1
        value = made.item()
        change = (value - best) / step
        if abs(change) > 1e-3 * abs(slope):
            slope = change
        if abs(value) < abs(best):
            c, x, best, left = c + step, trial, value, made
        else:
            stalled += 1
    return LevelSolution(x, left, np.array(iterations), np.array(1))


def _on_tape(
    residual: Callable[[Any], Any], first: Traced, direction: Traced, slope: Traced, unit: Traced, size: float
) -> LevelSolution:
    """`_of_one` in compiled code, in each lane separately."""
    tape = first.tape
    resolved = np.abs(slope) > MIN_RESOLVED_UNITS * size * unit[0]
    start = first[0]

    def iteration(
        c: Values, best: Values, over: Values, stalled: Values, count: Values, active: Values
    ) -> tuple[list[Values], Values]:
        # 1 / slope is kept, which needs one division less
        step = np.clip(-best * over, -1 / size, 1 / size)
        value = residual((c + step) * direction)[0]
        change = value - best
        better = active & (np.abs(value) < np.abs(best))
        clear = np.abs(change * over) > 1e-3 * np.abs(step)
        over = np.where(clear, step / np.where(clear, change, 1.0), over)
        c, best = np.where(better, c + step, c), np.where(better, value, best)
        stalled = np.where(better, stalled, stalled + 1.0)
        count = count + np.where(active, 1.0, 0.0)
        active = active & (np.abs(best) > unit[0]) & (stalled < MAX_STALLED_ITERATIONS)
        return [c, best, over, stalled, count, active], active

    active = resolved & (np.abs(start) > unit[0])
    over = 1.0 / np.where(resolved, slope, 1.0)
    found = while_loop(iteration, [0.0, start, over, 0.0, 0.0, active], tape, MAX_ITERATIONS)
    c, best, _, _, count, _ = found
    return LevelSolution(c * direction, best[None], count, np.where(resolved, 1, 0))


def _reduced(jacobian: Array, cutoff: float) -> tuple[Array, Array, Array, BooleanArray]:
    """(U^T, V, S, mask of the singular values above the cutoff) of a singular value decomposition."""
    if jacobian.shape[-2:] == (1, 1):
        one, slopes = np.ones_like(jacobian), jacobian[..., 0]
        kept = np.abs(slopes) > cutoff
        return kept[..., None] * one, one, slopes, kept
    left, slopes, right = np.linalg.svd(np.nan_to_num(np.asarray(jacobian, dtype=np.float64)), full_matrices=False)
    kept = (slopes > cutoff) & (slopes > RANK_RTOL * slopes[..., :1])
    project, lift = np.swapaxes(left * kept[..., None, :], -1, -2), np.swapaxes(right * kept[..., None], -1, -2)
    return project.astype(jacobian.dtype), lift.astype(jacobian.dtype), slopes.astype(jacobian.dtype), kept


def _limited(step: Array, largest: float) -> Array:
    """step, shortened to norm at most `largest`; 0 where it is not finite."""
    norm = np.sqrt(_square(step))[..., None]
    step = np.where(norm > largest, step * (largest / np.where(norm > 0, norm, 1.0)), step)
    return np.where(np.isfinite(norm), step, 0.0)


def _updated(inverse: Array, step: Array, change: Array) -> Array:
    """Inverse Jacobian after Broyden's update, which maps `change` of the residual to `step`."""
    moved = (inverse @ change[..., None])[..., 0]
    row = (step[..., None, :] @ inverse)[..., 0, :]
    along = (step * moved).sum(axis=-1)[..., None, None]
    good = np.isfinite(along) & (np.abs(along) > 1e-3 * _square(step)[..., None, None])
    return inverse + np.where(good, (step - moved)[..., :, None] * row[..., None, :] / np.where(good, along, 1.0), 0.0)


def _square(x: Array) -> Array:
    found: Array = (x * x).sum(axis=-1)
    return found
