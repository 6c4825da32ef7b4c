"""orbit_distance: how far a point is from the orbit of the flow, min over s of |y - F_s(m_0)|, s near t.

On any manifold, and no energy takes part: Newton's method on <y - F_s, F_s'> = 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.errors import ConvergenceError, InputError, ShapeError
from liehom.integrators.convergence.reference import Reference
from liehom.integrators.run.points import points_of

ITERATIONS = 100
HALVINGS = 30
# a Newton step goes at most this share of |F'| / |F''|, over which the tangent turns or changes its length by itself
TRUST_FRACTION = 0.5


def orbit_distance(reference: Reference, y: Any, t: Any, *, window: Any = None) -> tuple[Any, Any]:
    """The distance of points from the orbits of the flow through the starts of a reference, and where it is assumed.

    Parameters
    ----------
    reference : Reference
    y : array_like of shape (..., N)
        One point for each trajectory; more leading axes are more points.
    t : float or array of shape (...,)
        The times near which the orbit is searched.
    window : float or array, optional
        How far from t; by default as far as t is from the start of the reference, beyond t too.

    Returns
    -------
    distance, s : arrays of shape (...,)
        The local minimum |y - F_s(m_0)| that is found by descent from s = t; at most |y - F_t(m_0)|.

    Raises
    ------
    ShapeError, InputError
        If y or the window does not fit.
    ConvergenceError
        If the solution does not exist until t.

    Notes
    -----
    A step is that of Newton, or of Gauss and Newton where the distance is not convex in s; it is halved until the
    distance decreases. At equilibria F' = 0 and s stays. The distance has an error of second order in that of s.

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


def _arguments(reference: Reference, y: Any, t: Any, window: Any) -> tuple[Any, Any, Any]:
    dtype, lead = reference.start.dtype, reference.start.shape[:-1]
    points = points_of(y).astype(dtype)
    if points.shape[-1:] != reference.start.shape[-1:]:
        raise ShapeError(f"a point has {reference.start.shape[-1]} coordinates, got shape {points.shape}")
    try:
        shape = np.broadcast_shapes(points.shape[:-1], np.shape(t), lead)
        times = np.broadcast_to(np.asarray(t).astype(dtype, casting="same_kind"), shape)
        wide = np.abs(times - reference.t0) if window is None else np.asarray(window).astype(dtype, casting="same_kind")
        wide = np.broadcast_to(wide, shape)
    except TypeError:
        raise InputError(f"t or window is no number: {t!r}, {window!r}") from None
    except ValueError:
        raise ShapeError(
            f"points of shape {points.shape}, times of shape {np.shape(t)} and the ensemble {lead} do not fit together"
        ) from None
    if not bool((wide >= 0).all()):
        raise InputError(f"window is {window!r}, expected numbers at least 0")
    if not bool(np.isfinite(points).all()):
        raise InputError("a point is not finite: the distance from an orbit needs finite points")
    return np.broadcast_to(points, (*shape, points.shape[-1])), times, wide


def _distance(reference: Reference, y: Any, s: Any) -> Any:
    return np.linalg.norm(y - reference(s), axis=-1)


def _newton_step(reference: Reference, y: Any, s: Any) -> tuple[Any, Any]:
    """The change of s, and the speed |F'|."""
    rest = y - reference(s)
    first, second = reference.derivative(s, 1), reference.derivative(s, 2)
    speed, bend = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
    moves = speed > np.finfo(y.dtype).tiny
    safe = np.where(moves, speed, 1)
    # all divided by the speed, whose square may underflow
    ahead = np.sum(rest * first / safe[..., None], axis=-1)
    curvature = np.sum(rest * second / safe[..., None], axis=-1)
    steepness = np.where(curvature < 0.75 * safe, safe - curvature, safe)
    bound = TRUST_FRACTION * np.divide(safe, bend, out=np.full_like(safe, np.inf), where=bend > 0)
    return np.where(moves, np.clip(ahead / steepness, -bound, bound), 0), speed


def _descended(reference: Reference, y: Any, s: Any, step: Any, best: Any) -> tuple[Any, Any]:
    """The step, halved where the distance does not decrease by it, and the distances after it."""
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
