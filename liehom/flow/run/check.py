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
from typing import Any, NamedTuple

import numpy as np

from liehom.base.typing import Array, BooleanArray, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.series.arrays import is_jax, namespace
from liehom.flow.steps.step import LocalStep, length, over_sites
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop

LOOKS = 128  # looks across the span, for psi(m, t); one at the end of each step for psi(m)
OFFSET = 0.382  # added to their number, so that looks do not fall on the times at which a periodic pulse vanishes
ALLOWED_RESIDUAL = 30.0  # of a series, in units of the error that is allowed
SMALLEST_CUT, LARGEST_CUT = 0.1, 0.8  # bounds of the factor by which a size is cut
MAX_LOOKS = 1_000_000  # within one step


class Checked(NamedTuple):
    """Sizes (...,) of steps after the check, and how often psi was looked at and a size was cut."""

    size: Array
    looks: Array
    cuts: Array


def gap_of(looks: int, span: Real, field: GeneratorField) -> Real | None:
    """The longest time between two looks: inf for psi(m), None if there are no looks."""
    return None if looks == 0 else abs(span) / (looks + OFFSET) if field.time_dependent else np.inf


def checked(
    field: GeneratorField, local: LocalStep, m: Values, t: Values, h: Values, allowed: Values, left: Values, *,
    direction: Real, gap: Real, tiny: Real, axes: int,
) -> Checked:  # fmt: skip
    """Sizes at most h, without sign, at which the series of a step passes all looks; below `tiny` if there are none."""
    xp, c = namespace(m, t, h), local.trajectory
    root = 1 / (len(c) + 1)
    # round-off of X, and of the time at which it is asked for
    drift: Any = length(c[1]) if len(c) > 1 else 0.0
    floor: Any = 8 * float(np.finfo(np.float64).eps) * (length(c[0]) + 2 * xp.abs(t) * drift)

    def body(h: Any, back: Any, pending: Any, looks: Any, cuts: Any) -> tuple[list[Any], BooleanArray]:
        passed: Any = local.time(direction * h) * direction if local.clock else h
        window: Any = xp.minimum(xp.where(passed > 0, passed, h), left)
        s: Any = direction * xp.where(pending, window - back, 0.0)
        near = local.nearby(s[..., None])
        lack: Any = length(slope(c, s[..., None]) - field.vector(near, t + s)) - floor
        residual: Any = window * over_sites(xp.maximum(lack, 0.0), axes) / allowed
        passes = residual <= ALLOWED_RESIDUAL
        factor: Any = 0.9 * (ALLOWED_RESIDUAL / residual) ** root
        factor = xp.where(factor > SMALLEST_CUT, xp.minimum(factor, LARGEST_CUT), SMALLEST_CUT)
        cut = pending & ~passes
        looks, cuts = looks + xp.where(pending, 1.0, 0.0), cuts + xp.where(cut, 1.0, 0.0)
        h, back = xp.where(cut, factor * h, h), xp.where(passes, back + gap, 0.0)
        pending = pending & xp.where(passes, back < window, h >= tiny)
        return [h, back, pending, looks, cuts], pending

    zero: Any = 0.0 * h
    size, _, _, looks, cuts = _repeated(body, [h, zero, h > 0, zero, zero])
    return Checked(size, looks, cuts)


def slope(coefficients: Sequence[Values], s: Values) -> Values:
    """c_1 + 2 c_2 s + 3 c_3 s^2 + ..., for s of shape (..., 1)."""
    total: Any = len(coefficients) * coefficients[-1]
    for k in range(len(coefficients) - 1, 0, -1):
        total = total * s + k * coefficients[k - 1]
    return total  # type: ignore[no-any-return]


def _repeated(body: Callable[..., tuple[list[Any], Any]], state: list[Any]) -> Sequence[Any]:
    """The state after a loop over `body`, which tells whether to go on: of numpy, of tracers, or of JAX."""
    first = state[0]
    if isinstance(first, Traced):
        return while_loop(body, state, first.tape, MAX_LOOKS)
    if is_jax(first):
        from jax import lax, numpy as jnp

        go_on, known = (lambda s: jnp.any(s[2])), [x.dtype for x in state]
        return list(lax.while_loop(go_on, lambda s: [x.astype(d) for x, d in zip(body(*s)[0], known)], state))
    while True:
        state, again = body(*state)
        if not again.any():
            return state


def widest_gap(nodes: Sequence[float]) -> float:
    """The largest distance between two times at which a method asks psi, in units of its step, by its nodes c_i."""
    times = sorted({min(max(float(c), 0.0), 1.0) for c in nodes})
    return max([b - a for a, b in zip(times, times[1:])] + [1 - times[-1] + times[0]], default=1.0)
