"""Errors of a run at its end, on the orbit and on the trajectory, and the floor below which they are not resolved.

    orbit error = min over s near T of |y - F_s(m_0)|,   trajectory error = |y - F_T(m_0)|

root mean squares over an ensemble. Errors within a factor `MARGIN` of the accuracy of the reference, or of round-off,
are not resolved.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError
from liehom.homogeneous import GeneratorField
from liehom.integrators.convergence.convergence_table import MARGIN, NAN
from liehom.integrators.convergence.orbit_error import orbit_distance
from liehom.integrators.convergence.reference import Reference
from liehom.integrators.run.solution import Solution
from liehom.typing import Array


def reference_for(
    field: GeneratorField, start: Array, first: np.floating[Any], given: Reference | None = None
) -> Reference:
    """The reference through (first, start), the given one or one in extended precision.

    Raises
    ------
    InputError
        If the given reference is not a `Reference`, or has another initial point.

    Examples
    --------
    >>> import liehom as lh
    >>> reference_for(lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0]), np.float64(0)).order
    24
    """
    if given is None:
        return Reference(field, start.astype(np.longdouble), first)
    if not isinstance(given, Reference):
        raise InputError(f"reference is {given!r}, expected a liehom.integrators.Reference")
    if not np.array_equal(given.start, start) or given.t0 != first:
        raise InputError("the reference goes through another point or starts at another time than y0 at t_span[0]")
    return given


def errors_of(reference: Reference, points: Array, end: np.floating[Any], *, orbit: bool = True) -> tuple[float, float]:
    """(orbit error, trajectory error) of points at the end; the first is NaN if `orbit` is False.

    Examples
    --------
    >>> import liehom as lh
    >>> reference = Reference(lh.GeneratorField(lh.defining(lh.so(2)), [1]), [1.0, 0.0])
    >>> distances = errors_of(reference, np.array([1.0, 0.0]), np.float64(0.001))
    >>> [round(x, 9) for x in distances]
    [0.0, 0.001]
    """
    trajectory = root_mean_square(np.linalg.norm(points - reference(end), axis=-1))
    return (root_mean_square(orbit_distance(reference, points, end)[0]) if orbit else NAN), trajectory


def end_points(run: Solution) -> Array:
    """The last points (..., N) of a run; behind them rows of ensembles are filled up with NaN.

    Examples
    --------
    >>> import liehom as lh
    >>> sol = lh.integrate(lh.GeneratorField(lh.defining(lh.so(2)), [1]), (0, 1), [[1.0, 0.0], [2.0, 0.0]])
    >>> end_points(sol).shape
    (2, 2)
    """
    count = np.isfinite(run.t).sum(axis=-1)
    points: Array = np.take_along_axis(run.y, (count - 1)[..., None, None], axis=-1)[..., 0]
    return points


def root_mean_square(distances: Array) -> float:
    """Root mean square of numbers, a float.

    Examples
    --------
    >>> root_mean_square(np.array([3.0, 3.0]))
    3.0
    """
    return float(np.sqrt(np.mean(distances**2)))


def floor_of(points: Array, dtype: np.dtype[Any], steps: npt.ArrayLike, accuracy: float) -> float:
    """Ten times the accuracy of the reference, or ten times the rounding of all steps added up as a random walk.

    Parameters
    ----------
    points : array of shape (..., N)
    dtype : numpy.dtype
        Type of the numbers of the run.
    steps : int or array
        Number of steps.
    accuracy : float
        That of the reference.

    Examples
    --------
    >>> bool(floor_of(np.array([1.0, 0.0]), np.dtype(np.float64), 100, 1e-18) == 100 * np.finfo(float).eps)
    True
    """
    unit = float(np.finfo(dtype).eps) * float(np.max(np.linalg.norm(points, axis=-1), initial=0.0))
    return MARGIN * max(accuracy, unit * math.sqrt(float(np.max(steps, initial=1))))
