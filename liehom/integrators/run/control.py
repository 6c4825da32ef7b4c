"""Step sizes by the tolerance: from what a step knows of its error, or from an embedded pair.

For an embedded pair the step is taken, judged, and repeated if it was too large; see `liehom.correctors.step_size` for
the sizes that are known in advance.

The rules run on arrays, and on the tracers of compiled steps (`Values`); results are of the same kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.expansion import flow_series, step_series
from liehom.correctors.step import Generator, LocalStep
from liehom.correctors.step_size import SAFETY, Defects, StepLimits, floats, over_sites, size_from_defects
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField
from liehom.series.arrays import namespace
from liehom.typing import Array, BooleanArray, Real, Values

MAX_PAIR_GROWTH = 5.0
"""With an embedded pair, the largest ratio of the next step size to the last one."""
MAX_SHRINK = 0.2
"""The smallest ratio of the next step size to the last one."""
ERROR_TERMS = 2
"""Number of Taylor coefficients of the error that are computed."""
MAX_GROWTH = 8.0
"""Without an embedded pair, the largest ratio of the next step size to the last one."""
NONFINITE_RATIO = 1e10
"""Error, in units of the tolerance, that stands for one that is not finite."""
MAX_TRIALS = 200
"""Number of attempts to find out which trajectories a step cannot be solved for."""
MIN_ROUNDOFFS = 10.0
"""The smallest relative tolerance, in units of round-off."""


@final
@dataclass(frozen=True, slots=True)
class Tolerance:
    """Error allowed in a step: at most atol + rtol |m|, as root mean squares over the coordinates.

    It is never less than 10 units of round-off of m. Compiled steps give tracers for `rtol` and `atol`. The last `axes`
    leading axes of m are the sites of a lattice, whose coordinates count together.

    Examples
    --------
    >>> import numpy as np
    >>> float(Tolerance(1e-3, 1e-6).norm(np.array([3.0, 4.0])))
    0.00500...
    """

    rtol: Real
    atol: Real
    axes: int = 0

    def norm(self, m: Values) -> Array:
        """2-norm of the error that is allowed at the points m (..., N), shape (...,)."""
        point: Any = m
        relative = namespace(self.rtol).maximum(self.rtol, MIN_ROUNDOFFS * float(np.finfo(point.dtype).eps))
        allowed: Array = self.atol * point.shape[-1] ** 0.5 + relative * length(point)
        return over_sites(allowed, self.axes)


def length(x: Values) -> Array:
    """2-norm over the last axis, in float64.

    Examples
    --------
    >>> import numpy as np
    >>> float(length(np.array([3.0, 4.0])))
    5.0
    """
    values = floats(x)
    found: Array = namespace(values).sqrt((values * values).sum(axis=-1))
    return found


def whole_lattice(where: BooleanArray, axes: int) -> BooleanArray:
    """All sites of the lattices, on the last axes, that have one of these sites; the same sites without a lattice.

    Examples
    --------
    >>> whole_lattice(np.array([[True, False], [False, False]]), 1).tolist()
    [[True, True], [False, False]]
    """
    if not axes:
        return where
    xp = namespace(where)
    some: BooleanArray = xp.any(where, axis=tuple(range(-axes, 0)), keepdims=True)
    repeated: BooleanArray = xp.broadcast_to(some, where.shape)
    return repeated


def largest_size(max_step: Real, left: Values) -> Array:
    """Bound for the step sizes with the time `left` to the end, twice that time because the clock may be slow.

    Examples
    --------
    >>> float(largest_size(np.inf, np.array(0.5)))
    1.0
    """
    bound: Array = namespace(max_step, left).minimum(max_step, 2 * left)
    return bound


def is_large_enough(h: Values, tiny: Real, left: Real) -> BooleanArray:
    """Whether steps of these sizes advance time, bool (...,); False for NaN.

    Examples
    --------
    >>> is_large_enough(np.array([1e-3, 1e-17, np.nan]), 1e-16, 1.0).tolist()
    [True, False, False]
    """
    size: Any = h
    enough: BooleanArray = size >= namespace(tiny, left).minimum(tiny, left)
    return enough


def time_scale(field: GeneratorField, m: Values, t: Values) -> Array:
    """|m| / |X(m, t)|, the time in which a point moves by its own size, shape (...,).

    Examples
    --------
    >>> import liehom as lh
    >>> float(time_scale(lh.GeneratorField(lh.defining(lh.so(2)), [4]), np.array([1.0, 0.0]), np.array(0.0)))
    0.25
    """
    axes = len(field.sites)
    size, speed = over_sites(length(m), axes), over_sites(length(field.vector(m, t)), axes)
    if isinstance(size, np.ndarray | np.floating) and not size.all():  # the point 0 does not move
        return np.where(size == 0, np.inf, size / speed)
    return size / speed


def known_size(
    action: Action, psi: Generator, local: LocalStep, m: Values, t: Values, order: int, limits: StepLimits
) -> Values:
    """The size that the step knows in advance (`LocalStep.size`), else from the Taylor coefficients of its error.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), ["m0", "0", "0"])
    >>> action, psi, m = lh.Action(field.representation), Generator(field, 2), np.array([0.6, 0.0, 0.8])
    >>> limits = StepLimits(np.array(1e-3), np.array(0.36), np.array(1.0))
    >>> local = lh.Euler().at(action, psi, m, np.zeros(1))
    >>> float(known_size(action, psi, local, m, np.array(0.0), 1, limits).round(6))
    0.323165
    """
    found = local.size(limits)
    return size_from_defects(defects_of(action, psi, local, m, t, order), *limits) if found is None else found


def defects_of(action: Action, psi: Generator, local: LocalStep, m: Values, t: Values, order: int) -> Defects:
    """(k, |[t^k] (F - step)|) for `ERROR_TERMS` orders k above the order of a step, F the flow.

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


def judged(error: Values, allowed: Values, h: Values, order: int, axes: int = 0) -> tuple[BooleanArray, Array]:
    """Whether the estimate (..., N) of an embedded pair accepts a step of size h, and the next step size.

    The last `axes` leading axes are the sites of a lattice.

    Examples
    --------
    >>> accepted, size = judged(np.array([3e-4, 4e-4]), np.array(1e-3), np.array(-0.1), 4)
    >>> bool(accepted), float(size.round(4))
    (True, 0.107)
    """
    xp = namespace(error, h)
    ratio: Any = over_sites(length(error), axes) / allowed
    ratio = xp.where(xp.isfinite(ratio), ratio, NONFINITE_RATIO)
    return ratio <= 1, next_size(xp.abs(h), ratio, order)


def next_size(h: Array, ratio: Array, order: int) -> Array:
    """The next step size after one of size h > 0, from error / tolerance of an embedded pair of the given order.

    Examples
    --------
    >>> import numpy as np
    >>> float(next_size(np.array(0.1), np.array(0.0), 5)), float(next_size(np.array(0.1), np.array(1e9), 5).round(4))
    (0.5, 0.02)
    """
    xp = namespace(h, ratio)
    safe = xp.where(ratio > 0, ratio, 1.0)
    factor = xp.where(ratio > 0, SAFETY * safe ** (-1 / order), MAX_PAIR_GROWTH)
    size: Array = h * xp.clip(factor, MAX_SHRINK, MAX_PAIR_GROWTH)
    return size


def unsolvable(local: LocalStep, h: Array, where: BooleanArray, error: Exception | None = None) -> BooleanArray:
    """For which trajectories the equations of a step of size h have no solution, bool (...,).

    The error, a `ConvergenceError`, may say it. Otherwise groups of trajectories are tried one after the other, with
    h = 0 for the others, so that psi is still called on the whole ensemble.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> def point(h):
    ...     if np.any(h > 1):
    ...         raise ConvergenceError("too large")
    ...     return np.zeros((3, 2))
    ...
    >>> local = LocalStep(lh.Action(lh.defining(lh.so(2))), np.zeros((3, 2)), point=point)
    >>> h, where = np.array([0.5, 2.0, 0.7]), np.array([True, True, True])
    >>> unsolvable(local, h, where).tolist()
    [False, True, False]
    >>> unsolvable(local, h, where, ConvergenceError("too large", np.array([False, True, False]))).tolist()
    [False, True, False]
    """
    known = getattr(error, "unsolved", None)
    if known is not None and known.shape == np.shape(h) and bool((known & where).any()):
        named: BooleanArray = known & where
        return named
    found = np.zeros(np.size(h), dtype=bool)
    groups, trials = [np.flatnonzero(where)], 0
    while groups:
        group = groups.pop()
        chosen = np.zeros(np.size(h), dtype=bool)
        chosen[group] = True
        # the first group, all of them, is known to fail
        if trials and _is_solvable(local, np.where(chosen.reshape(np.shape(h)), h, 0)):
            trials += 1
        elif len(group) <= 1 or trials > MAX_TRIALS:
            found[group] = True
        else:
            trials += 1
            groups += [group[: len(group) // 2], group[len(group) // 2 :]]
    # a group may fail although its halves do not: the equations are iterated together
    return found.reshape(np.shape(h)) if bool(found.any()) else where


def _is_solvable(local: LocalStep, h: Array) -> bool:
    try:
        local.point(h[..., None])
    except (ConvergenceError, np.linalg.LinAlgError):
        return False
    return True
