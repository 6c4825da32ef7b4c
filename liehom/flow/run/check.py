"""The check of adaptive steps: psi is looked at within a step before the step is taken.

A size that follows from the Taylor coefficients at one point does not show what psi does later in the step: a pulse, a
switch, a wall. So the series p(s) of the trajectory is compared with the field X at the end of the step, and for
psi(m, t) at further times within it, at most `gap` apart. Where

    h |p'(s) - X(p(s), t + s)|  >  30 (error that is allowed in a step)

the size is cut, and the same series is looked at again. For series of analytic fields the left side is a few times the
allowed error at most. A method with stages is not compared with a series. Its steps are so short that the times at
which it asks psi anyway are at most `gap` apart. A collocation method has a polynomial, and for psi(m, t) its estimate
of the error is asked for at the looks instead (`looked_within`). For psi(m) a point moves by at most `MAX_WAY` |m| in
the gap. There a series of points is looked at once: it is accurate over about |m| only.

No method of finitely many looks sees everything: what lies between two of them stays unseen. `max_step` is how users
say what they know of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from liehom.base.typing import Array, Lanes, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.series.arrays import coarse, is_jax, namespace
from liehom.flow.steps.step import LocalStep, squared_length
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop
from liehom.flow.tracing.sweeps import jnp, lax

LOOKS = 128  # looks across the span, by default for psi(m, t); for psi(m) there is one at the end of each step
MAX_WAY = 0.22  # of a point between two looks at psi(m), in units of |m|
OFFSET = 0.382  # added to their number, so that looks do not fall on the times at which a periodic pulse vanishes
ALLOWED_RESIDUAL = 30.0  # of a series, in units of the error that is allowed
SMALLEST_CUT, LARGEST_CUT = 0.1, 0.8  # bounds of the factor by which a size is cut
MAX_LOOKS = 1_000_000  # within one step
FITS = 3  # iterations for the size of a step with a time of its own that comes to the end of the span


class Seen(NamedTuple):
    """The first look at psi in a step: at a signed size (...,), and the point (..., N) there."""

    size: Array
    point: Values


def gap_of(looks: int | None, span: Lanes, field: GeneratorField) -> Lanes | None:
    """The longest time between two looks: None if there are none, inf if there is one in a step."""
    if looks is None:
        looks = LOOKS if field.time_dependent else -1
    if looks <= 0:
        return None if looks == 0 else float("inf")
    return abs(span) / (looks + OFFSET)


def is_unbounded(gap: Real | None) -> bool:
    """Whether a gap bounds no time; False for a traced number."""
    return isinstance(gap, float) and gap == float("inf")


def checked(
    field: GeneratorField, local: LocalStep, m: Values, t: Lanes, h: Lanes, allowed: Lanes, left: Values, *,
    direction: Lanes, gap: Lanes, tiny: Lanes, axes: int,
) -> tuple[Lanes, Lanes, Lanes, Seen]:  # fmt: skip
    """Sizes at most h, without sign, at which the series of a step passes all looks; below `tiny` if there are none.
    Also how often psi was looked at and a size was cut, and the first look.
    """
    xp, c = namespace(m, t, h), local.trajectory
    root = 1 / (len(c) + 1)
    rounded: Lanes = squared_length(c[0])
    if field.time_dependent and len(c) > 1:  # the times at which X is asked for are rounded too
        rounded = rounded + 4 * t * t * squared_length(c[1])
    floor = (8 * float(np.finfo(np.float64).eps)) ** 2 * rounded
    largest = (ALLOWED_RESIDUAL * allowed) * (ALLOWED_RESIDUAL * allowed)

    def look(size: Lanes, back: Lanes) -> tuple[Lanes, Lanes, Seen]:
        """The square of the residual at a look, whether the step needs another one, and where psi was looked at."""
        s = direction * (size - back)
        time: Lanes = direction * xp.minimum(direction * local.time(s), left) if local.clock else s
        point, velocity = local.look(s[..., None], time[..., None])
        lack: Lanes = squared_length(velocity - field.vector(point, t + time)) - floor
        if axes:
            total = xp.sum(xp.maximum(lack, 0.0), axis=tuple(range(-axes, 0)), keepdims=True)
            lack = xp.broadcast_to(total, lack.shape)
        residual = size * size * lack
        return residual, xp.where(residual <= largest, back + gap < size, size >= tiny), Seen(s, point)

    def again(wanted: Lanes, h: Lanes, back: Lanes, residual: Lanes, looks: Lanes, cuts: Lanes) -> list[Lanes]:
        passes = ~wanted | (residual <= largest)
        gain = coarse("coarse_log2", largest) - coarse("coarse_log2", residual)
        factor: Lanes = 0.9 * coarse("coarse_exp2", (root / 2) * gain)
        factor = xp.where(factor > SMALLEST_CUT, xp.minimum(factor, LARGEST_CUT), SMALLEST_CUT)
        h, back = xp.where(passes, h, factor * _within(local, h, left, direction)), xp.where(passes, back + gap, 0.0)
        looks, cuts = looks + xp.where(wanted, 1.0, 0.0), cuts + xp.where(passes, 0.0, 1.0)
        size = _within(local, h, left, direction)
        new, more, _ = look(xp.where(wanted, size, 0.0), xp.where(wanted, back, 0.0))
        # psi that is not finite within the step is the reason of a size that is too small
        h = xp.where(wanted & xp.isnan(new) & ~more, np.nan, h)
        return [wanted & more, h, back, xp.where(wanted, new, residual), looks, cuts]

    size = _within(local, h, left, direction)
    zero = 0.0 * size
    residual, wanted, seen = look(size, zero)
    _, cut, _, _, looks, cuts = repeated(again, [wanted, h, zero, residual, zero + 1, zero])
    return cut, looks, cuts, seen


def looked_within(local: LocalStep, size: Lanes, gap: Lanes, allowed: Lanes, error: Lanes) -> Lanes:
    """The estimate of a step with a collocation polynomial, or the first one above `allowed` at looks within it."""
    h = abs(size[..., 0])
    xp = namespace(h)

    def look(wanted: Lanes, at: Lanes, error: Lanes) -> list[Lanes]:
        new = local.estimate_within(size, (at / xp.maximum(h, gap))[..., None])
        error = xp.where((wanted & ~(squared_length(new) <= squared_length(error)))[..., None], new, error)
        at = at + gap
        return [wanted & (at < h) & (squared_length(error) <= allowed * allowed), at, error]

    passes = (gap < h) & (squared_length(error) <= allowed * allowed)
    return repeated(look, [passes, 0 * h + gap, error])[2]


def _within(local: LocalStep, h: Lanes, left: Values, direction: Real) -> Lanes:
    """Sizes, at most h, of steps to the end at most, beyond which psi is not asked."""
    xp = namespace(h, left)
    h = xp.minimum(h, left) if local.clock else h
    for _ in range(FITS if local.clock else 0):
        passed: Lanes = local.time(direction * h) * direction
        h = xp.where(passed > left, h * left / passed, h)
    return h


def repeated(body: Callable[..., list[Any]], state: list[Any], limit: int = MAX_LOOKS) -> Sequence[Any]:
    """The state after a loop while its first number, a boolean, is true somewhere: of numpy, of tracers, or of JAX."""
    first = state[0]
    if isinstance(first, Traced):
        return while_loop(lambda *s: ((new := body(*s)), new[0]), state, first.tape, limit, guarded=True)
    if is_jax(first):
        return lax.while_loop(
            lambda s: jnp.any(s[0]),
            lambda s: [x.astype(y.dtype) for x, y in zip(body(*s), state, strict=True)],
            state,
        )
    for _ in range(limit):
        if not state[0].any():
            break
        state = body(*state)
    return state


def widest_gap(nodes: Sequence[float]) -> float:
    """The largest distance between two times at which a method asks psi, in units of its step, by its nodes c_i."""
    times = sorted({min(max(float(c), 0.0), 1.0) for c in nodes})
    return max([b - a for a, b in pairwise(times)] + [1 - times[-1] + times[0]], default=1.0)
