"""The check of adaptive steps: psi is looked at within a step before the step is taken.

A size that follows from the Taylor coefficients at one point does not show what psi does later in the step: a pulse, a
switch, a wall. So the series p(s) of the trajectory is compared with the field X at the end of the step, and for
psi(m, t) at further times within it, at most `gap` apart. Where

    h |p'(s) - X(p(s), t + s)|  >  30 (error that is allowed in a step)

the size is cut, and the same series is looked at again. For series of analytic fields the left side is a few times the
allowed error at most. A method with stages is not compared with a series. Its steps are so short that the times at
which it asks psi anyway are at most `gap` apart, or a point moves by at most its own size for psi(m).

No method of finitely many looks sees everything: what lies between two of them stays unseen. `max_step` is how users
say what they know of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from liehom.base.typing import Array, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.series.arrays import is_jax, namespace
from liehom.flow.steps.step import LocalStep, length, over_sites
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop

LOOKS = 128  # looks across the span, by default for psi(m, t); for psi(m) there is one at the end of each step
OFFSET = 0.382  # added to their number, so that looks do not fall on the times at which a periodic pulse vanishes
ALLOWED_RESIDUAL = 30.0  # of a series, in units of the error that is allowed
SMALLEST_CUT, LARGEST_CUT = 0.1, 0.8  # bounds of the factor by which a size is cut
MAX_LOOKS = 1_000_000  # within one step
FITS = 3  # iterations for the size of a step with a time of its own that comes to the end of the span


class Checked(NamedTuple):
    """Sizes (...,) of steps after the check, and how often psi was looked at and a size was cut."""

    size: Array
    looks: Array
    cuts: Array


def gap_of(looks: int | None, span: Real, field: GeneratorField) -> Real | None:
    """The longest time between two looks: None if there are none, inf if there is one in a step."""
    if looks is None:
        looks = LOOKS if field.time_dependent else -1
    if looks <= 0:
        return None if looks == 0 else float("inf")
    gap: Real = abs(span) / (looks + OFFSET)  # type: ignore[operator]
    return gap


def is_unbounded(gap: Real | None) -> bool:
    """Whether a gap bounds no time; False for a traced number."""
    return isinstance(gap, float) and gap == float("inf")


def checked(
    field: GeneratorField, local: LocalStep, m: Values, t: Values, h: Values, allowed: Values, left: Values, *,
    direction: Real, gap: Real, tiny: Real, axes: int,
) -> Checked:  # fmt: skip
    """Sizes at most h, without sign, at which the series of a step passes all looks; below `tiny` if there are none."""
    xp, c = namespace(m, t, h), local.trajectory
    root = 1 / (len(c) + 1)
    rounded: Any = length(c[0])
    if field.time_dependent and len(c) > 1:  # the times at which X is asked for are rounded too
        rounded = rounded + 2 * xp.abs(t) * length(c[1])
    floor = 8 * float(np.finfo(np.float64).eps) * rounded

    def look(wanted: Values, h: Values, back: Values) -> tuple[Values, Values]:
        """The residual at a look, in units of what is allowed, and whether the step needs another one."""
        s: Any = direction * xp.where(wanted, h - back, 0.0)
        time: Any = direction * xp.minimum(direction * local.time(s), left) if local.clock else s
        point, velocity = local.look(s[..., None], time[..., None])
        lack: Any = length(velocity - field.vector(point, t + time)) - floor
        residual: Any = h * over_sites(xp.maximum(lack, 0.0), axes) / (ALLOWED_RESIDUAL * allowed)
        return residual, wanted & xp.where(residual <= 1, back + gap < h, h >= tiny)

    def again(wanted: Values, h: Values, back: Values, residual: Values, looks: Values, cuts: Values) -> list[Values]:
        passes = ~wanted | (residual <= 1)
        factor: Any = 0.9 * residual**-root
        factor = xp.where(factor > SMALLEST_CUT, xp.minimum(factor, LARGEST_CUT), SMALLEST_CUT)
        h, back = xp.where(passes, h, factor * h), xp.where(passes, back + gap, 0.0)
        looks, cuts = looks + xp.where(wanted, 1.0, 0.0), cuts + xp.where(passes, 0.0, 1.0)
        new, wanted_again = look(wanted, h, back)
        return [wanted_again, h, back, xp.where(wanted, new, residual), looks, cuts]

    size: Any = xp.minimum(h, left)
    for _ in range(FITS if local.clock else 0):  # psi is not asked beyond the end
        passed: Any = local.time(direction * size) * direction
        size = xp.where(passed > left, size * left / passed, size)
    zero: Any = 0.0 * size
    residual, wanted = look(size > 0, size, zero)
    _, cut, _, residual, looks, cuts = repeated(again, [wanted, size, zero, residual, zero + 1, zero])
    # psi that is not finite within the step is the reason of a size that is too small
    cut = xp.where(xp.isnan(residual), np.nan, cut)
    return Checked(xp.where(cuts > 0, cut, h), looks, cuts)


def repeated(body: Callable[..., list[Any]], state: list[Any], limit: int = MAX_LOOKS) -> Sequence[Any]:
    """The state after a loop while its first number, a boolean, is true somewhere: of numpy, of tracers, or of JAX."""
    first = state[0]
    if isinstance(first, Traced):
        return while_loop(lambda *s: ((new := body(*s)), new[0]), state, first.tape, limit, guarded=True)
    if is_jax(first):
        from jax import lax, numpy as jnp

        def again(s: list[Any]) -> list[Any]:
            return [x.astype(y.dtype) for x, y in zip(body(*s), state, strict=True)]

        last: list[Any] = lax.while_loop(lambda s: jnp.any(s[0]), again, state)
        return last
    for _ in range(limit):
        if not np.any(state[0]):
            break
        state = body(*state)
    return state


def widest_gap(nodes: Sequence[float]) -> float:
    """The largest distance between two times at which a method asks psi, in units of its step, by its nodes c_i."""
    times = sorted({min(max(float(c), 0.0), 1.0) for c in nodes})
    return max([b - a for a, b in pairwise(times)] + [1 - times[-1] + times[0]], default=1.0)
