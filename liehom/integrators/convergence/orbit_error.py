"""orbit_distance: the distance of a point from the orbit of the flow, min over s of |y - F_s(m_0)|, s near t.

Newton's method on <y - F_s, F_s'> = 0, on any manifold; first integrals are not used.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import ConvergenceError, InputError, ShapeError
from liehom.integrators.convergence.reference import Reference
from liehom.integrators.points import points_of
from liehom.typing import Array

ITERATIONS = 100
HALVINGS = 30
TRUST_FRACTION = 0.5
"""Longest Newton step in units of |F'| / |F''|, a time in which the tangent turns or changes by its own length."""


def orbit_distance(
    reference: Reference, y: npt.ArrayLike, t: npt.ArrayLike, *, window: npt.ArrayLike | None = None
) -> tuple[Array, Array]:
    """Distances of points from the orbits through the initial points of a reference, and the times of the minima.

    Parameters
    ----------
    reference : Reference
    y : array_like of shape (..., N)
        One point for each trajectory; more leading axes are more points.
    t : float or array of shape (...,)
        The times near which the orbit is searched.
    window : float or array, optional
        The largest |s - t|; by default |t - t0|, t0 the initial time of the reference.

    Returns
    -------
    distance, s : arrays of shape (...,)
        The local minimum |y - F_s(m_0)| that is found by descent from s = t; at most |y - F_t(m_0)|.

    Raises
    ------
    ShapeError, InputError
        If y or the window has a wrong shape or is not finite.
    ConvergenceError
        If the solution does not exist until t.

    Notes
    -----
    A step of the descent is a Newton step, or a Gauss-Newton step if the distance is not convex in s. It is halved
    until the distance decreases. At equilibria F' = 0, and s does not change. The error of the distance is of second
    order in the error of s.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> ref = lh.integrators.Reference(lh.GeneratorField(lh.defining(lh.so(2)), [1]), [1.0, 0.0])
    >>> distance, s = orbit_distance(ref, [1.25 * np.cos(2), 1.25 * np.sin(2)], 1.5)
    >>> round(float(distance), 14), round(float(s), 12)
    (0.25, 2.0)
    """
    points, s, window = _arguments(reference, y, t, window)
    low, high = s - window, s + window
    best = _distance(reference, points, s)
    eps = np.finfo(points.dtype).eps
    open_ = best > 0
    for _ in range(ITERATIONS):
        if not open_.any():
            break
        step, speed = _newton_step(reference, points, s)
        step = np.where(open_, np.clip(s + step, low, high) - s, 0)
        open_ = open_ & (np.abs(step) * speed > eps * np.linalg.norm(points, axis=-1))
        step, found = _descended(reference, points, s, np.where(open_, step, 0), best)
        open_ = open_ & (found < best)
        s, best = np.where(open_, s + step, s), np.where(open_, found, best)
    return best, s


def _arguments(
    reference: Reference, y: npt.ArrayLike, t: npt.ArrayLike, window: npt.ArrayLike | None
) -> tuple[Array, Array, Array]:
    """Points, times and windows, checked and broadcast."""
    dtype, lead = reference.start.dtype, reference.start.shape[:-1]
    points = points_of(y).astype(dtype)
    if points.shape[-1:] != reference.start.shape[-1:]:
        raise ShapeError(f"a point has {reference.start.shape[-1]} coordinates, got shape {points.shape}")
    try:
        shape = np.broadcast_shapes(points.shape[:-1], np.shape(t), lead)
        times = np.broadcast_to(np.asarray(t).astype(dtype, casting="same_kind"), shape)
        wide: Any = np.abs(times - reference.t0)
        if window is not None:
            wide = np.asarray(window).astype(dtype, casting="same_kind")
        wide = np.broadcast_to(wide, shape)
    except TypeError:
        raise InputError(f"t or window is not a number: {t!r}, {window!r}") from None
    except ValueError:
        raise ShapeError(
            f"points of shape {points.shape}, times of shape {np.shape(t)} and the ensemble {lead} do not fit together"
        ) from None
    if not bool((wide >= 0).all()):
        raise InputError(f"window is {window!r}, expected numbers at least 0")
    if not bool(np.isfinite(points).all()):
        raise InputError("a point is not finite: the distance from an orbit needs finite points")
    return np.broadcast_to(points, (*shape, points.shape[-1])), times, wide


def _distance(reference: Reference, y: Array, s: Array) -> Array:
    distance: Array = np.linalg.norm(y - reference(s), axis=-1)
    return distance


def _newton_step(reference: Reference, y: Array, s: Array) -> tuple[Array, Array]:
    """The change of s by a Newton step, and the speed |F'|."""
    rest = y - reference(s)
    first, second = reference.derivative(s, 1), reference.derivative(s, 2)
    speed, bend = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
    moves = speed > np.finfo(y.dtype).tiny
    safe = np.where(moves, speed, 1)
    # every term is divided by the speed, whose square may underflow
    slope = np.sum(rest * first / safe[..., None], axis=-1)
    curvature = np.sum(rest * second / safe[..., None], axis=-1)
    steepness = np.where(curvature < 0.75 * safe, safe - curvature, safe)
    bound = TRUST_FRACTION * np.divide(safe, bend, out=np.full_like(safe, np.inf), where=bend > 0)
    return np.where(moves, np.clip(slope / steepness, -bound, bound), 0), speed


def _descended(reference: Reference, y: Array, s: Array, step: Array, best: Array) -> tuple[Array, Array]:
    """The step, halved until the distance decreases, and the distances after it."""
    found = best
    for _ in range(HALVINGS):
        try:
            found = _distance(reference, y, s + step)
        except ConvergenceError:  # the solution ends within the window
            found = np.full_like(best, np.inf)
        worse = (found >= best) & (step != 0)
        if not worse.any():
            break
        step = np.where(worse, step / 2, step)
    return step, found
