"""Step sizes from the Taylor coefficients of the error of a step.

For a step with defects d_k = |[t^k](F - step)|, F the flow, the step size is the largest h with d_k h^k within the
tolerance and below a fraction of |X| h, the length of the step; the second bound keeps h where the series converges,
also next to equilibria.

The rules run on arrays, and on the tracers of compiled steps (`Values`); results are of the same kind.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np

from liehom.series.arrays import is_jax, namespace
from liehom.typing import Array, Values

SAFETY = 0.9
"""Fraction of the step size at which the estimated error equals the tolerance."""
SERIES_FRACTION = 0.1
"""The largest length of a term of the error, in units of the length |X| h of the step."""

Defects: TypeAlias = tuple[tuple[int, Values], ...]
"""(k, |[t^k] (flow - step)|) for the orders k above the order of a step; arrays of shape (...,)."""


class StepLimits(NamedTuple):
    """Bounds of a step size, the argument of `LocalStep.size`; arrays of shape (...,).

    Attributes
    ----------
    allowed : array
        The error allowed in the step, a 2-norm.
    speed : array
        |X|, or 0 to disregard the length of the step.
    largest : array
        A bound for the size.
    axes : int
        Number of the last axes that are the sites of a lattice, which has one size.
    """

    allowed: Values
    speed: Values
    largest: Values
    axes: int = 0


def size_from_defects(defects: Defects, allowed: Values, speed: Values, largest: Values, axes: int = 0) -> Array:
    """The largest step size whose error is within the tolerance, by its Taylor coefficients; shape (...,).

    The arguments after the first are the entries of `StepLimits`.

    Examples
    --------
    >>> import numpy as np
    >>> one = np.array(1.0)
    >>> float(size_from_defects(((2, one),), np.array(1e-4), one, one))
    0.009000000000000001
    """
    xp = namespace(largest, speed)
    h: Array = floats(largest)
    way: Any = speed
    for k, defect in defects:
        size: Any = over_sites(floats(defect), axes)
        some = size > 0
        safe = xp.where(some, size, 1.0)
        found: Any = (allowed / safe) ** (1 / k)
        if k > 2:  # not for k = 2: next to a time at which X vanishes steps would shrink with X
            series = (SERIES_FRACTION * way / safe) ** (1 / (k - 1))
            found = xp.where(way > 0, xp.minimum(found, series), found)
        h = xp.minimum(h, xp.where(some, SAFETY * found, xp.where(xp.isnan(size), np.nan, np.inf)))
    return h


def over_sites(x: Values, axes: int) -> Array:
    """Root of the sum of squares over the last axes, the sites of a lattice, repeated for each site.

    Examples
    --------
    >>> over_sites(np.array([[3.0, 4.0], [0.0, 1.0]]), 1).tolist()
    [[5.0, 5.0], [1.0, 1.0]]
    """
    if not axes:
        return x  # type: ignore[return-value]
    xp = namespace(x)
    found: Array = xp.sqrt(xp.sum(x * x, axis=tuple(range(-axes, 0)), keepdims=True))
    repeated: Array = xp.broadcast_to(found, x.shape)
    return repeated


def floats(x: Values) -> Array:
    """x in float64; tracers and JAX arrays as they are.

    Examples
    --------
    >>> floats(np.longdouble(1)).dtype.name
    'float64'
    """
    values: Any = x
    if is_jax(x):
        found: Array = values
        return found
    made: Array = values.astype(np.float64, copy=False) if hasattr(x, "astype") else np.asarray(x, dtype=np.float64)
    return made
