"""Points of solutions as curves: smooth between the steps, with a limit for the number of points."""

from __future__ import annotations

import contextlib
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from liehom.errors import ConvergenceError, InputError, displayed
from liehom.integrators import Solution
from liehom.integrators.run.dense import DenseSolution
from liehom.integrators.run.solution import interpolant
from liehom.typing import Array

MAX_TRAJECTORIES = 50
CURVE_POINTS = 400
"""Number of points of a curve, unless there are more steps."""
MAX_STEPS_MADE = 400
"""Steps are made again for trajectories with at most this number of them."""
MAX_POINTS = 20_000
"""Of a trajectory with more steps, only some are drawn."""
SPHERE_TOLERANCE = 1e-6
"""|m| counts as constant if it varies by at most this fraction."""


class Curves(NamedTuple):
    """Trajectories to draw.

    Attributes
    ----------
    t : array of shape (k, n)
    y : array of shape (k, N, n)
        NaN where a trajectory has ended.
    total : int
        Number of all trajectories, of which k are drawn.
    every : int
        1, or s if only every s-th step is drawn.
    """

    t: Array
    y: Array
    total: int
    every: int


def real_numbers(value: npt.ArrayLike, what: str) -> Array:
    """An argument as an array of floats.

    Raises
    ------
    InputError
        If it is not one of real numbers.

    Examples
    --------
    >>> real_numbers([1, 2], "value")
    array([1., 2.])
    """
    try:
        found = np.asarray(value)
        if found.dtype.kind not in "cSU":
            return found.astype(float)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{what}: found {displayed(value)}, expected real numbers")


def steps_of(solution: Solution) -> Curves:
    """The points of the steps of the first trajectories."""
    if not isinstance(solution, Solution):
        raise InputError(f"expected a solution as liehom.integrate returns it, got {solution!r}")
    y = np.asarray(solution.y, dtype=float)
    if not y.size:
        raise InputError("the solution has no point to draw: its ensemble or its t_eval is empty")
    t = np.broadcast_to(np.asarray(solution.t, dtype=float), (*y.shape[:-2], y.shape[-1]))
    t, y = t.reshape(-1, t.shape[-1]), y.reshape(-1, *y.shape[-2:])
    every = -(-t.shape[-1] // MAX_POINTS) or 1
    kept = np.unique(np.r_[0 : t.shape[-1] : every, t.shape[-1] - 1])
    return Curves(t[:MAX_TRAJECTORIES, kept], y[:MAX_TRAJECTORIES][..., kept], len(y), every)


def curves_of(solution: Solution) -> Curves:
    """The first trajectories as smooth curves.

    If the solution knows its steps, each is made again with fractions of its size, so that the curve is on the orbit.
    Otherwise, and for more than 400 steps or 50 trajectories, the curve is the cubic spline in time through the steps,
    projected to the sphere if |m| is constant.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> curves = curves_of(lh.integrate(field, (0, 3), [1.0, 0.0], dt=1.0))
    >>> curves.y.shape[-1], bool(abs((curves.y**2).sum(axis=1) - 1).max() < 1e-14)
    (301, True)
    """
    steps = steps_of(solution)
    points = steps.t.shape[-1]
    if points < 2:
        return steps
    if steps.total <= MAX_TRAJECTORIES and points <= MAX_STEPS_MADE + 1:
        # an implicit step of another size need not have a solution
        with contextlib.suppress(ConvergenceError, np.linalg.LinAlgError):
            known = interpolant(solution)
            if known is not None:
                return _made_again(steps, known)
    parts = [_splined(t, y, max(1, 2 * CURVE_POINTS // points)) for t, y in zip(steps.t, steps.y, strict=True)]
    return steps._replace(t=np.stack([t for t, _ in parts]), y=np.stack([y for _, y in parts]))


def _made_again(steps: Curves, known: DenseSolution) -> Curves:
    """The curves that the method draws between its steps."""
    times = _times(steps.t)
    y = np.asarray(known(times), dtype=float).reshape(steps.total, -1, len(times))
    low, high = np.nanmin(steps.t, axis=-1)[:, None], np.nanmax(steps.t, axis=-1)[:, None]
    y = np.where(((times >= low) & (times <= high))[:, None, :], y, np.nan)
    return steps._replace(t=np.broadcast_to(times, (steps.total, len(times))), y=y)


def constant_norm(y: Array) -> float | None:
    """|m| for points (k, N, n), if it is the same for all points and positive."""
    norms = np.linalg.norm(y, axis=1)
    low, high = float(np.nanmin(norms)), float(np.nanmax(norms))
    return (low + high) / 2 if low > 0 and high - low <= SPHERE_TOLERANCE * high else None


def _times(t: Array) -> Array:
    """About `CURVE_POINTS` times, in the direction of integration, and among them those of steps that agree."""
    same = np.unique(t[:, :1]).size == 1 and bool((t == t[:1]).all())
    if same:
        return _divided(t[0], max(2, CURVE_POINTS // t.shape[-1]))
    first = t[0, 0]
    last = np.nanmin(t) if first == np.nanmax(t) else np.nanmax(t)
    times: Array = np.linspace(first, last, CURVE_POINTS)
    return times


def _divided(t: Array, parts: int) -> Array:
    """Times, and between any two of them further ones, so that there are `parts` intervals for one."""
    within = t[:-1, None] + np.diff(t)[:, None] * (np.arange(parts) / parts)
    return np.append(within.reshape(-1), t[-1])


def _splined(t: Array, y: Array, parts: int) -> tuple[Array, Array]:
    """The spline through points (N, n), at times filled up with NaN; the points themselves if times do not increase."""
    there = np.isfinite(t) & np.isfinite(y).all(axis=0)
    count, size = int(there.sum()), parts * (t.shape[-1] - 1) + 1
    times, points = t[there], y[:, there]
    if count > 1 and parts > 1:
        direction = 1.0 if times[-1] > times[0] else -1.0
        if bool((direction * np.diff(times) > 0).all()):
            fine = _divided(times, parts)
            smooth = CubicSpline(direction * times, points, axis=1)(direction * fine)
            norm = constant_norm(points[None])
            if norm is not None:
                smooth *= norm / np.linalg.norm(smooth, axis=0)
            smooth[:, ::parts] = points
            times, points = fine, smooth
    filled = np.full(size, np.nan), np.full((len(y), size), np.nan)
    filled[0][: len(times)], filled[1][:, : len(times)] = times, points
    return filled
