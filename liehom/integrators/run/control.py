"""Step sizes from the Taylor coefficients of the error, or from an embedded pair.

For a step with defects d_k = |[t^k](F - step)| the step size is the largest h with d_k h^k within the tolerance and
below a share of the way |X| h that is made (so that the series is used where it converges, next to equilibria too);
for an embedded pair the step is taken, judged, and repeated where it was too large.  The rules of sizes run on arrays
and on traced numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.expansion import flow_series, step_series
from liehom.correctors.step import Generator, LocalStep
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField

SAFETY = 0.9
MAX_PAIR_GROWTH = 5.0
MAX_SHRINK = 0.2
ERROR_TERMS = 2
SERIES_FRACTION = 0.1
MAX_GROWTH = 8.0
"""Without an embedded pair the next size is bounded by so many times the last one."""
NONFINITE_RATIO = 1e10
"""What an error that is not finite counts as, in units of the tolerance."""
MAX_TRIALS = 200
MIN_ROUNDOFFS = 10.0


@final
@dataclass(frozen=True, slots=True)
class Tolerance:
    """The error allowed in a step: its root mean square is at most atol + rtol |m| (also a root mean square).

    It is never less than 10 units of round-off of m.

    Examples
    --------
    >>> import numpy as np
    >>> float(Tolerance(1e-3, 1e-6).norm(np.array([3.0, 4.0])))
    0.00500...
    """

    rtol: float
    atol: float

    def norm(self, m: Any) -> Any:
        """The 2-norm of the error that is allowed at m, shape (...,)."""
        relative = np.maximum(self.rtol, MIN_ROUNDOFFS * float(np.finfo(m.dtype).eps))
        return self.atol * m.shape[-1] ** 0.5 + relative * length(m)


def length(x: Any) -> Any:
    """The 2-norm over the last axis, in float64.

    Examples
    --------
    >>> import numpy as np
    >>> float(length(np.array([3.0, 4.0])))
    5.0
    """
    x = _floats(x)
    return np.sqrt((x * x).sum(axis=-1))


def _floats(x: Any) -> Any:
    """In float64; traced numbers are."""
    return x.astype(np.float64, copy=False) if hasattr(x, "astype") else np.asarray(x, dtype=np.float64)


def largest_size(max_step: Any, left: Any) -> Any:
    """A bound for the step sizes with the time `left` to the end; not `left`: the clock may be slow.

    Examples
    --------
    >>> float(largest_size(np.inf, np.array(0.5)))
    1.0
    """
    return np.minimum(max_step, 2 * left)


def is_large_enough(h: Any, tiny: Any, left: Any) -> Any:
    """Whether steps of these sizes go on: nan does not.

    Examples
    --------
    >>> is_large_enough(np.array([1e-3, 1e-17, np.nan]), 1e-16, 1.0).tolist()
    [True, False, False]
    """
    return h >= np.minimum(tiny, left)


def time_scale(field: GeneratorField, m: Any, t: Any) -> Any:
    """|m| / |X|, (...,).

    Examples
    --------
    >>> import liehom as lh
    >>> float(time_scale(lh.GeneratorField(lh.defining(lh.so(2)), [4]), np.array([1.0, 0.0]), np.array(0.0)))
    0.25
    """
    return length(m) / length(field.vector(m, t))


def size_from_defects(defects: tuple[tuple[int, Any], ...], allowed: Any, speed: Any, largest: Any) -> Any:
    """The largest step size whose error is within the tolerance, by its Taylor coefficients; shape (...,).

    Parameters
    ----------
    defects : tuple of (int, array of shape (...,))
    allowed, speed, largest : array of shape (...,)
        The error allowed; |X|, 0 where it is not to matter; a bound.

    Examples
    --------
    >>> import numpy as np
    >>> float(size_from_defects(((2, np.array(1.0)),), np.array(1e-4), np.array(1.0), np.array(1.0)))
    0.009000000000000001
    """
    h = _floats(largest)
    for k, size in defects:
        size = _floats(size)
        some = size > 0
        safe = np.where(some, size, 1.0)
        found = (allowed / safe) ** (1 / k)
        if k > 2:  # not for k = 2: next to a time at which X vanishes steps would shrink with X
            series = (SERIES_FRACTION * speed / safe) ** (1 / (k - 1))
            found = np.where(speed > 0, np.minimum(found, series), found)
        h = np.minimum(h, np.where(some, SAFETY * found, np.where(np.isnan(size), np.nan, np.inf)))
    return h


def defects_of(
    action: Action, psi: Generator, local: LocalStep, m: Any, t: Any, order: int
) -> tuple[tuple[int, Any], ...]:
    """|[t^k] (F - step)| for the orders above the order of a step.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), ["m0", "0", "0"])
    >>> action, psi = lh.Action(field.representation), Generator(field, 2)
    >>> m = np.array([0.6, 0.0, 0.8])
    >>> found = defects_of(action, psi, lh.Euler().at(action, psi, m, 0.0), m, 0.0, 1)
    >>> [k for k, _ in found]
    [2, 3]
    """
    if local.defects is not None:
        return local.defects
    total = order + ERROR_TERMS
    flow = flow_series(psi.field, m, total, t)
    made = step_series(action, local, m, total)
    return tuple((k, length(flow.point(k) - made.coefficient(k))) for k in range(order + 1, total + 1))


def judged(error: Any, allowed: Any, h: Any, order: int) -> tuple[Any, Any]:
    """Whether the estimate (..., N) of an embedded pair accepts a step of size h, and the next size.

    Examples
    --------
    >>> accepted, size = judged(np.array([3e-4, 4e-4]), np.array(1e-3), np.array(-0.1), 4)
    >>> bool(accepted), float(size.round(4))
    (True, 0.107)
    """
    ratio = length(error) / allowed
    ratio = np.where(np.isfinite(ratio), ratio, NONFINITE_RATIO)
    return ratio <= 1, next_size(np.abs(h), ratio, order)


def next_size(h: Any, ratio: Any, order: int) -> Any:
    """The next step size from error / tolerance of an embedded pair whose error is of the given order.

    Examples
    --------
    >>> import numpy as np
    >>> float(next_size(np.array(0.1), np.array(0.0), 5)), float(next_size(np.array(0.1), np.array(1e9), 5).round(4))
    (0.5, 0.02)
    """
    safe = np.where(ratio > 0, ratio, 1.0)
    factor = np.where(ratio > 0, SAFETY * safe ** (-1 / order), MAX_PAIR_GROWTH)
    return h * np.clip(factor, MAX_SHRINK, MAX_PAIR_GROWTH)


def unsolvable(local: LocalStep, h: Any, where: Any) -> Any:
    """For which trajectories the equations of a step of size h have no solution, bool (...,).

    They are tried group by group, with h = 0 for the others; psi is still called on the whole ensemble.

    Examples
    --------
    >>> import numpy as np
    >>> def factors(h):
    ...     if np.any(h > 1):
    ...         raise ConvergenceError("too large")
    ...     return (h,)
    >>> unsolvable(LocalStep(factors), np.array([0.5, 2.0, 0.7]), np.array([True, True, True])).tolist()
    [False, True, False]
    """
    found = np.zeros(np.size(h), dtype=bool)
    groups, trials = [np.flatnonzero(where)], 0
    while groups:
        group = groups.pop()
        chosen = np.zeros(np.size(h), dtype=bool)
        chosen[group] = True
        # of the first group it is known
        if trials and _is_solvable(local, np.where(chosen.reshape(np.shape(h)), h, 0)):
            trials += 1
        elif len(group) <= 1 or trials > MAX_TRIALS:
            found[group] = True
        else:
            trials += 1
            groups += [group[: len(group) // 2], group[len(group) // 2 :]]
    # a group may fail although its halves do not: the equations are iterated together
    return found.reshape(np.shape(h)) if bool(found.any()) else where


def _is_solvable(local: LocalStep, h: Any) -> bool:
    try:
        local.factors(h[..., None])
    except (ConvergenceError, np.linalg.LinAlgError):
        return False
    return True
