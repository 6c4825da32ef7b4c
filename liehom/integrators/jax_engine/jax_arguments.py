"""Arguments of a call on JAX arrays: start, times and step sizes may be arrays that JAX traces.

The type of the start is the type of the solution: float64 or float32.  It is never changed: for float64, JAX has to be
told once, by ``jax.config.update("jax_enable_x64", True)``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError
from liehom.homogeneous.fields.field import check_point
from liehom.integrators.arguments import step_sizes
from liehom.integrators.points import points_of
from liehom.integrators.run.options import Span
from liehom.representations import Representation
from liehom.series.arrays import is_jax, is_traced
from liehom.typing import Array, IntegerArray, Values

REMEDY = 'jax.config.update("jax_enable_x64", True)'


def jax_start(representation: Representation, y0: npt.ArrayLike) -> tuple[Values, int | IntegerArray]:
    """Initial points as a JAX array, and the dimensions of their orbits; the largest one if JAX traces them.

    Raises
    ------
    InputError
        If they are not of type float64 or float32, or do not have N coordinates.

    Examples
    --------
    >>> import liehom as lh
    >>> import jax
    >>> jax_start(lh.defining(lh.so(2)), jax.numpy.arange(2))
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: the start is a JAX array of type int..., expected float64 or float32: ...
    """
    start: Any = y0
    if not is_jax(start):
        from jax import numpy as jnp

        points = points_of(y0)
        start = jnp.asarray(points)
        if start.dtype != points.dtype:
            raise InputError(
                f"the start is of type {points.dtype}, and JAX computes in {start.dtype}: {REMEDY}, or start from a "
                "JAX array"
            )
    if start.dtype not in (np.float64, np.float32):
        raise InputError(f"the start is a JAX array of type {start.dtype}, expected float64 or float32: {REMEDY}")
    n = representation.size
    if start.ndim == 0 or start.shape[-1] != n:
        raise InputError(f"a point has {n} coordinates (on its last axis), got shape {start.shape}")
    if is_traced(start):
        points = np.random.default_rng(0).normal(size=(16, n))
        return start, int(check_point(representation, points).max())
    return start, check_point(representation, np.asarray(start))


def traces_times(t_span: Iterable[float] | Span, others: Sequence[object]) -> bool:
    """Whether JAX traces an end of the time span, or one of the other arrays.

    Examples
    --------
    >>> traces_times((0.0, 1.0), [None, 0.1])
    False
    """
    ends = list(t_span) if isinstance(t_span, list | tuple) else [t_span]
    return any(is_traced(x) for x in [*ends, *others])


def jax_span(t_span: Iterable[float] | Span) -> Span:
    """Start and end of a time span, of which JAX may trace one or both.

    Raises
    ------
    InputError
        If there are not two numbers.

    Examples
    --------
    >>> jax_span((0.0, 2.0))
    (0.0, 2.0)
    """
    ends: list[Any] = list(t_span)
    if len(ends) != 2 or any(np.ndim(t) for t in ends):
        raise InputError(f"t_span has {len(ends)} entries, expected two numbers (start, end)")
    return ends[0], ends[1]


def jax_times(
    dt: npt.ArrayLike | None, t_eval: npt.ArrayLike | None, start: Values
) -> tuple[Array | None, Array | None]:
    """Step sizes and output times of a call where JAX traces one of them or the span, checked as far as possible.

    Raises
    ------
    InputError, ShapeError
        If a known step size is not positive, or an array has a wrong shape.

    Examples
    --------
    >>> jax_times(0.5, None, np.zeros((2, 3)))
    (array([0.5, 0.5]), None)
    """
    sizes: Any = dt
    if dt is not None and not is_traced(dt):
        sizes = step_sizes(dt, start, (np.float64(0), np.float64(0)))
    elif dt is not None and np.shape(dt) not in ((), start.shape[:-1]):
        raise ShapeError(f"dt has shape {np.shape(dt)}, the ensemble {start.shape[:-1]}")
    times: Any = t_eval if t_eval is None or is_traced(t_eval) else np.asarray(t_eval, dtype=np.float64)
    if times is not None and np.ndim(times) != 1:
        raise ShapeError(f"t_eval has shape {np.shape(times)}, expected a list of times")
    return sizes, times
