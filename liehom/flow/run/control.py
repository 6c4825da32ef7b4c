"""Step sizes by the tolerance, and the time reparametrization."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

import numpy as np

from liehom.base.errors import ConvergenceError
from liehom.base.typing import Array, BooleanArray, Lanes, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.run.check import LOOKS, MAX_WAY, Seen, checked, is_unbounded, looked_within
from liehom.flow.series.arrays import namespace
from liehom.flow.steps.expansion import flow_series, step_series
from liehom.flow.steps.step import (
    SAFETY,
    Generator,
    LocalStep,
    StepLimits,
    length,
    over_sites,
    size_from_defects,
)

# The time reparametrization τ of a step, its "clock": τ(h) is the time that passes in a step of size h. The clock is
# admissible over a step if τ increases everywhere at between 1/5 and 5 times the nominal rate 1. Values at some points
# do not prove it. Bernstein coefficients of τ' do, because τ' lies between the smallest and the largest of them. The
# step size s with τ(s) = a given time is found by Newton's method.

NEWTON_ITERATIONS = 60
MIN_RATE = 0.2  # smallest admissible rate dτ/dh
MAX_RATE = 5.0  # largest admissible rate dτ/dh
RATE_PARTS = 4  # equal parts of a step with Bernstein coefficients of their own, which approximate τ' better
MAX_HALVINGS = 40
SLACK = 1e-9  # a step that ends this close to the end of the integration, in units of the step, ends there


def clock_at(local: LocalStep, h: Lanes) -> tuple[Lanes, Lanes]:
    """Whether a clock is admissible over [0, h], bool (...,), and the time τ(h), both for h of shape (...,)."""
    return is_admissible(local.clock, h), local.time(h)


def is_admissible(clock: Sequence[tuple[int, Values]], h: Lanes) -> BooleanArray:
    """Whether all Bernstein coefficients of τ' are between the admissible rates, so that τ' is on all of [0, h]."""
    rows = _bernstein(max(k for k, _ in clock) - 1)
    rows = rows.reshape(*rows.shape, *[1] * np.ndim(h))
    rates: Any = sum((rows[:, k - 1] * (k * c * h ** (k - 1)) for k, c in clock), 1.0)
    return ((rates > MIN_RATE) & (rates < MAX_RATE)).all(axis=0) | (h == 0)


@cache
def _bernstein(degree: int) -> Array:
    """Bernstein coefficients of 1, s, ..., s^degree on each of `RATE_PARTS` equal parts of [0, 1], a column for each.

    Coefficient k of s^j on [a, b] is its polar form, an elementary symmetric function of a (degree - k times) and b.
    """
    parts = pairwise(np.arange(RATE_PARTS + 1) / RATE_PARTS)
    forms = [np.poly([-a] * (degree - k) + [-b] * k) for a, b in parts for k in range(degree + 1) if a == 0 or k]
    return np.array(forms) / [comb(degree, j) for j in range(degree + 1)]


def size_for(local: LocalStep, time: Array, guess: Array) -> Array:
    """Step sizes s (...,) with τ(s) = time, of the sign of time; 0 where time is 0, NaN if no s is found."""
    if not local.clock:
        return time + 0 * guess
    reached: Lanes = local.time(guess)
    fraction = np.divide(time, reached, out=np.ones_like(time), where=reached != 0)
    within = (fraction >= 0) & (fraction <= 1)
    s = np.where(within, fraction * guess, time)
    low, high = 0 * s, np.where(within, guess, np.sign(time) * np.inf)
    eps = np.finfo(s.dtype).eps
    settled = np.zeros(np.shape(s), dtype=bool)  # a trajectory does not depend on those it is solved with
    for _ in range(NEWTON_ITERATIONS):
        times: Any = local.time(np.stack([s - 1e-4 * s, s, s + 1e-4 * s]))
        before, now, beyond = times
        missing = time - now
        short = missing * np.sign(time) > 0
        low, high = np.where(short, s, low), np.where(short, high, s)
        slope = (beyond - before) / np.where(s == 0, 1.0, 2e-4 * s)
        new = s + missing / np.clip(slope, MIN_RATE, MAX_RATE)
        outside = (new - low) * (new - high) > 0
        new = np.where(outside, np.where(np.isfinite(high), (low + high) / 2, 2 * s), new)
        done = (np.abs(new - s) <= 2 * eps * np.abs(s)) | (missing == 0)
        s = np.where(settled | (missing == 0), s, new)
        settled = settled | done
        if bool(settled.all()):
            break
    solved = np.abs(local.time(s) - time) <= 64 * eps * np.abs(time)
    return np.where(solved, s, np.nan)


def fitted(local: LocalStep, h: Array, left: Array, *, halve: bool) -> tuple[Array, Array, BooleanArray, BooleanArray]:
    """Step sizes that end within the time `left`: h, or the size that takes exactly that time if it is shorter."""
    runs, passed = clock_at(local, h)
    for _ in range(MAX_HALVINGS if halve else 0):
        if bool(runs.all()):
            break
        h = np.where(runs, h, h / 2)
        runs, passed = clock_at(local, h)
    over = (h != 0) & (np.sign(h) * (left - passed) <= SLACK * np.abs(h))
    # a clock that is not admissible over the whole step may still be so up to the end
    last = over if bool(runs.all()) else np.where(runs, over, np.abs(left) <= MAX_RATE * np.abs(h))
    if not bool(last.any()):
        return h, passed, last, runs
    s = size_for(local, np.where(last, left, 0), np.where(runs, h, left))
    last = last & clock_at(local, s)[0] & (np.abs(s) <= np.abs(h) * (1 + SLACK * 2 * MAX_RATE))
    return np.where(last, s, h), np.where(last, left, passed), last, last | (runs & ~over)


# Step sizes by the tolerance: from what a step knows of its error, or from an embedded pair. For an embedded pair the
# step is taken, judged, and repeated if it was too large; see `liehom.flow.steps.step` for the sizes that are known in
# advance. The rules run on arrays, and on the tracers of compiled steps (`Values`); results are of the same kind.

FIRST_STEP_FRACTION = 0.01  # the first step of an embedded pair, in units of |m| / |X|
MAX_PAIR_GROWTH = 5.0  # with an embedded pair, the largest ratio of the next step size to the last one
MAX_SHRINK = 0.2  # the smallest ratio of the next step size to the last one
ERROR_TERMS = 2  # number of Taylor coefficients of the error that are computed
ALLOWED_DEPARTURE = 3.0  # of a step from the trajectory (`LocalStep.departure`), in units of the error that is allowed
MAX_GROWTH = 8.0  # without an embedded pair, the largest ratio of the next step size to the last one
NONFINITE_RATIO = 1e10  # error, in units of the tolerance, that stands for one that is not finite
SLOW_CLOCK = 2.0  # with a clock, the largest size of a step, in units of the time to the end
MAX_TRIALS = 200  # number of attempts to find out which trajectories a step cannot be solved for
MIN_ROUNDOFFS = 10.0  # the smallest relative tolerance, in units of round-off


def allowed_error(rtol: Real, atol: Real, m: Lanes, axes: int = 0) -> Array:
    """2-norm (...,) of the error that is allowed in a step from m (..., N): atol + rtol |m|, as root mean squares over
    the coordinates and the last `axes` leading axes (the sites of a lattice), but at least 10 units of round-off of m.
    """
    relative = namespace(rtol).maximum(rtol, MIN_ROUNDOFFS * float(np.finfo(m.dtype).eps))
    return over_sites(atol * m.shape[-1] ** 0.5 + relative * length(m), axes)


def whole_lattice(where: BooleanArray, axes: int) -> BooleanArray:
    """All sites of the lattices, on the last axes, that have one of these sites; the same sites without a lattice."""
    if not axes:
        return where
    xp = namespace(where)
    return xp.broadcast_to(xp.any(where, axis=tuple(range(-axes, 0)), keepdims=True), where.shape)


class SizeLimits(NamedTuple):
    """Tolerances and bounds of adaptive step sizes: numbers of a run, or tracers for them."""

    rtol: Lanes
    atol: Lanes
    max_step: Lanes
    end: Lanes  # the time at the end
    direction: Lanes  # 1, or -1 if time decreases
    tiny: Lanes  # below this size time does not advance
    gap: Lanes | None  # the longest time between two looks at psi (`liehom.flow.run.check`); None for no looks
    moves: float = float("inf")  # bound for the way of a point in a step, in units of |m|


class Tried(NamedTuple):
    """Sizes (...,) of the next steps, without sign."""

    size: Lanes
    good: Lanes  # whether time advances by the size; if not, the run ends the trajectory
    looks: Lanes  # at psi within the step, and how often they have cut its size
    cuts: Lanes
    seen: Seen | None = None  # the first look


def tried_size(
    limits: SizeLimits, action: Action, psi: Generator, local: LocalStep, order: int, m: Values, t: Values,
    proposal: Values, looked_at: GeneratorField,
) -> Tried:  # fmt: skip
    """The sizes of the next steps, at most the proposal; what psi does within the step is seen in `looked_at`."""
    xp, axes, embedded = namespace(m, t), len(psi.field.sites), local.estimate_order is not None
    left = xp.abs(limits.end - t)
    h: Lanes = xp.minimum(proposal, largest_size(limits.max_step, left, SLOW_CLOCK if local.clock else 1.0))
    looks: Lanes = 0.0
    seen, cuts, moves = None, looks, limits.moves
    if embedded and limits.gap is not None:
        if is_unbounded(limits.gap):
            moves = min(moves, MAX_WAY / local.widest_gap)
        elif not local.collocates:
            h = xp.minimum(h, limits.gap / local.widest_gap)
    if moves < np.inf:
        h = xp.minimum(h, moves * time_scale(psi.field, m, t))
    local.allowed = allowed = allowed_error(limits.rtol, limits.atol, m, axes)
    if not embedded:
        if not local.trajectory:  # of a step that has not expanded it
            flow_series(psi.field, m, order + ERROR_TERMS, t).note(local, order + ERROR_TERMS)
        speed = over_sites(length(local.trajectory[0]), axes)
        if limits.gap is not None and psi.field.time_dependent:
            # terms far below the allowed error are not compared with |X| h, else steps go to 0 at a time when X does
            speed = xp.maximum(speed, allowed / h)
        gap = limits.gap
        if is_unbounded(gap) and not local.looks_ahead:  # exponentials may turn a point many times in a step
            gap = xp.maximum(left / LOOKS, MAX_WAY * over_sites(length(m), axes) / speed)
        bounds = StepLimits(allowed, speed, h, axes, allowed / over_sites(length(m), axes))
        h = local.size(bounds)
        if h is None:  # the step does not know it: from the Taylor coefficients of its error
            series = step_series(action, local, m, order + ERROR_TERMS)
            terms = range(order + 1, order + ERROR_TERMS + 1)
            local.defects = tuple((k, length(local.trajectory[k - 1] - series.coefficient(k))) for k in terms)
            h = size_from_defects(local.defects, *bounds)
        if limits.gap is not None:
            h, looks, cuts, seen = checked(
                looked_at, local, m, t, h, allowed, left,
                direction=limits.direction, gap=gap, tiny=limits.tiny, axes=axes,
            )  # fmt: skip
    return Tried(h, is_large_enough(h, limits.tiny, left), looks, cuts, seen)


def first_size(limits: SizeLimits, local: LocalStep, psi: Generator, m: Values, t: Values) -> Lanes:
    """Size of the first step of an embedded pair, without sign; None where the Taylor coefficients give it."""
    if local.estimate_order is None:
        return None
    xp = namespace(m, t)
    longest = largest_size(limits.max_step, xp.abs(limits.end - t))
    return xp.minimum(longest, FIRST_STEP_FRACTION * time_scale(psi.field, m, t))


def largest_size(max_step: Real, left: Values, slow: float = SLOW_CLOCK) -> Array:
    """Bound for the step sizes with the time `left` to the end, a multiple of that time if a clock may be slow."""
    return namespace(max_step, left).minimum(max_step, slow * left)


def is_large_enough(h: Lanes, tiny: Real, left: Real) -> BooleanArray:
    """Whether steps of these sizes advance time, bool (...,); False for NaN."""
    return h >= namespace(tiny, left).minimum(tiny, left)


def time_scale(field: GeneratorField, m: Values, t: Values) -> Array:
    """|m| / |X(m, t)|, the time in which a point moves by its own size, shape (...,)."""
    axes = len(field.sites)
    size, speed = over_sites(length(m), axes), over_sites(length(field.vector(m, t)), axes)
    if isinstance(size, np.ndarray | np.floating) and not size.all():  # the point 0 does not move
        return np.where(size == 0, np.inf, size / speed)
    return size / speed


def judgement(limits: SizeLimits, local: LocalStep, m: Values, size: Lanes, axes: int = 0) -> tuple[Lanes, Lanes]:
    """Whether a step of signed size (..., 1) is accepted, and the next size; one for all of the last `axes` axes."""
    allowed, order = allowed_error(limits.rtol, limits.atol, m, axes), local.estimate_order
    if order is None:
        departure, tried = local.departure(size), abs(size[..., 0])
        if departure is None:
            return True, MAX_GROWTH * tried
        near = over_sites(departure, axes) <= ALLOWED_DEPARTURE * allowed
        return near, namespace(near).where(near, MAX_GROWTH, MAX_SHRINK) * tried
    error = local.estimate(size)
    if local.collocates and limits.gap is not None and not is_unbounded(limits.gap):
        error = looked_within(local, size, limits.gap, allowed, error)
    return judged(error, allowed, size[..., 0], order, axes)


def judged(error: Values, allowed: Values, h: Values, order: int, axes: int = 0) -> tuple[BooleanArray, Array]:
    """Whether the estimate (..., N) of an embedded pair accepts a step of size h, and the next step size."""
    xp = namespace(error, h)
    ratio: Any = over_sites(length(error), axes) / allowed
    ratio = xp.where(xp.isfinite(ratio), ratio, NONFINITE_RATIO)
    return ratio <= 1, next_size(xp.abs(h), ratio, order)


def next_size(h: Array, ratio: Array, order: int) -> Array:
    """The next step size after one of size h > 0, from error / tolerance of an embedded pair of the given order."""
    xp = namespace(h, ratio)
    safe = xp.where(ratio > 0, ratio, 1.0)
    factor = xp.where(ratio > 0, SAFETY * safe ** (-1 / order), MAX_PAIR_GROWTH)
    return h * xp.clip(factor, MAX_SHRINK, MAX_PAIR_GROWTH)


def unsolvable(local: LocalStep, h: Array, where: BooleanArray, error: Exception | None = None) -> BooleanArray:
    """For which trajectories the equations of a step of size h have no solution, bool (...,): the `ConvergenceError`
    says it, or groups are tried one after the other, with h = 0 for the others.
    """
    known = getattr(error, "unsolved", None)
    if known is not None and known.shape == np.shape(h) and bool((known & where).any()):
        return np.asarray(known & where)
    failing = np.zeros(np.size(h), dtype=bool)
    groups, trials = [np.flatnonzero(where)], 0
    while groups:
        group = groups.pop()
        chosen = np.zeros(np.size(h), dtype=bool)
        chosen[group] = True
        # the first group, all of them, is known to fail
        if trials and _is_solvable(local, np.where(chosen.reshape(np.shape(h)), h, 0)):
            trials += 1
        elif len(group) <= 1 or trials > MAX_TRIALS:
            failing[group] = True
        else:
            trials += 1
            groups += [group[: len(group) // 2], group[len(group) // 2 :]]
    # a group may fail although its halves do not: the equations are iterated together
    return failing.reshape(np.shape(h)) if bool(failing.any()) else where


def _is_solvable(local: LocalStep, h: Array) -> bool:
    try:
        local.point(h[..., None])
    except (ConvergenceError, np.linalg.LinAlgError):
        return False
    return True
