"""Events: zeros of functions g(t, y) along trajectories, located on the dense output of a step.

A zero of g is a change of its sign, or a change to 0, between the ends of a step; or one of the two zeros next to an
extremum of g within the step. There is such an extremum if g has the same sign at both ends of a step, and approaches 0
at its first end and leaves it at its last one. It is found by interpolation with parabolas, until g has the other sign
or the parabolas stay clear of 0. Chandrupatla's method (inverse quadratic interpolation if it is safe, else bisection)
locates the zeros to round-off.

If g has at most one extremum within each step, all of its zeros are found, except those at which it only touches 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias, cast, final

import numpy as np

from liehom.base.errors import InputError, displayed
from liehom.base.typing import Array, BooleanArray, Lanes, Pytree
from liehom.flow.action.components import called_as_event, guarded
from liehom.flow.run.check import repeated
from liehom.flow.run.records import EventLog, Occurrence, occurrences_of
from liehom.flow.tracing.array import Traced

ITERATIONS = 200
EXTREMUM_ITERATIONS = 60
CLEAR_OF_ZERO = 0.5
"""An extremum is clear of 0 if two parabolas in turn leave at least this fraction of the value that is known."""
PARABOLIC = 0.02  # a parabola counts for that if f differs from it at its vertex by at most this fraction of the value
EXTREMUM_RTOL = 1e-9  # the smallest bracket of an extremum, in units of the step

EventFunction: TypeAlias = Callable[[Any, Any], Any]
"""g(t, y): times (...,) and points (..., N) to real numbers (...,)."""


class Look(NamedTuple):
    """A step as events see it."""

    position: Callable[[Array], tuple[Array, Array]]  # s (...,) -> (t, y), at the size s within the step
    # (i, place, value, inwards, here) -> the derivative of event function i in the direction of integration, for the
    # trajectories `here`, at a place (t, y) of known value; inwards is 1 at the start of a step, -1 at its end
    slope: Callable[[int, tuple[Array, Array], Array, int, BooleanArray], Array]
    h: Lanes  # the size of the step, (...,)
    before: tuple[Array, Array]  # at the ends of the step
    after: tuple[Array, Array]
    moves: BooleanArray  # the trajectories that make it


@final
class Events:
    """The events of a run: the zeros of functions, of which one at the initial time does not count for `terminal`."""

    def __init__(self, functions: EventFunction | Sequence[EventFunction], args: Pytree = None) -> None:
        if not callable(functions) and not isinstance(functions, list | tuple):
            raise InputError(f"events is {displayed(functions)}, expected a function g(t, y) or a list of functions")
        listed = [functions] if callable(functions) else list(functions)
        for i, g in enumerate(listed):
            if not callable(g):
                raise InputError(f"events[{i}] is {displayed(g)}, expected a function g(t, y)")
        self.functions: Sequence[EventFunction] = [
            called_as_event(g, args, f"events[{i}]") for i, g in enumerate(listed)
        ]
        self.directions: list[float] = [_direction(getattr(g, "direction", 0), i) for i, g in enumerate(listed)]
        self.terminal: list[float] = [_limit(getattr(g, "terminal", False), i) for i, g in enumerate(listed)]

    @property
    def count(self) -> int:
        """Number of event functions."""
        return len(self.functions)

    def value(self, i: int, t: Lanes, y: Lanes) -> Lanes:
        """g_i(t, y), shape (...,)."""
        t = t if isinstance(t, Traced) or t.ndim else np.asarray(t)[()]
        answer = guarded(self.functions[i], f"events[{i}]", t, y)
        if isinstance(y, Traced):  # a function that ignores y returns a number
            return Traced(y.tape, answer)
        try:
            value = np.asarray(answer)
            value = value if value.dtype.kind == "f" else value.astype(np.float64, casting="same_kind")
        except (TypeError, ValueError):
            raise InputError(f"events[{i}] returned {displayed(answer)}, expected real numbers") from None
        if value.shape != y.shape[:-1]:
            raise InputError(
                f"events[{i}] has shape {value.shape} at y of shape {y.shape}, expected {y.shape[:-1]} "
                "(one number for each trajectory: write y[..., 0])"
            )
        return value

    def values(self, t: Array, y: Array) -> list[Array]:
        """g_i(t, y) for all i, each of shape (...,)."""
        return [self.value(i, t, y) for i in range(self.count)]

    def crossed(self, i: int, before: Array, after: Array) -> BooleanArray:
        """For which trajectories event i occurs between two values of g_i, bool (...,)."""
        return self._directed(i, (before < 0) & (after >= 0), (before > 0) & (after <= 0))

    def left(self, i: int, before: Array, after: Array) -> BooleanArray:
        """For which trajectories g_i was 0 and is not any more, bool (...,)."""
        return self._directed(i, (before == 0) & (after > 0), (before == 0) & (after < 0))

    def _directed(self, i: int, rises: BooleanArray, falls: BooleanArray) -> BooleanArray:
        if self.directions[i] > 0:
            return rises
        return falls if self.directions[i] < 0 else rises | falls

    def record(
        self, log: EventLog, look: Look, before: list[Array], after: list[Array], fresh: BooleanArray
    ) -> tuple[Array, BooleanArray]:
        """Record the events in a step; returns the size up to the first terminal one, and for which trajectories."""
        occurrences: list[Occurrence] = []
        for i, (start, end) in enumerate(zip(before, after, strict=True)):
            at_start = occurrences_of(i, look.moves & fresh & self.left(i, start, end), 0 * look.h, *look.before)
            occurrences += [x._replace(counted=False) for x in at_start]
            for here, s in self.zeros(i, look, start, end):
                occurrences += occurrences_of(i, here, s, *look.position(np.where(here, s, 0)))
        stop, halted = np.array(look.h), np.zeros(np.shape(look.h), dtype=bool)
        for lane, x in log.record(occurrences, self.terminal).items():
            stop.flat[lane], halted.flat[lane] = x.s, True
        return stop, halted

    def zeros(self, i: int, look: Look, start: Array, end: Array) -> list[tuple[BooleanArray, Array]]:
        """The zeros of g_i within a step, in the order of time: for which trajectories, and their sizes s in (0, h]."""
        h = look.h

        def g(s: Array) -> Array:
            return self.value(i, *look.position(s)).astype(s.dtype)

        if not isinstance(h, Traced):
            start, end = (np.asarray(x, dtype=h.dtype) for x in (start, end))
        turns, turn, value = self._extremum(i, g, look, start, end)
        zeros = []
        here = look.moves & self.crossed(i, start, end)
        first = turns & self.crossed(i, start, value)
        if _some(here | first):
            far, there = np.where(first, turn, h), np.where(first, value, end)
            here = here | first
            zeros.append((here, bracketed_zero(g, np.where(here, far, 0), start, there, here)))
        second = turns & self.crossed(i, value, end)
        if _some(second):
            rest = bracketed_zero(lambda s: g(turn + s), np.where(second, h - turn, 0), value, end, second)
            zeros.append((second, turn + rest))
        return zeros

    def _extremum(
        self, i: int, g: Callable[[Array], Array], look: Look, start: Array, end: Array
    ) -> tuple[BooleanArray, Array, Array]:
        """Where g_i has the other sign at an extremum within the step: for which trajectories, s, and g_i there."""
        h, sign = look.h, np.sign(start)
        nowhere = h != h, h, end
        here = look.moves & (sign * end > 0)
        if not _some(here):
            return nowhere
        leaves = sign * look.slope(i, look.after, end, -1, here)
        here = here & (leaves > 0)
        if not _some(here):
            return nowhere
        approaches = -sign * look.slope(i, look.before, start, 1, here)
        here = here & (approaches > 0)
        if not _some(here):
            return nowhere
        guess = h * np.where(here, approaches / (approaches + leaves), 0.5)
        s, value = lowest(lambda s: sign * g(s), h, guess, (sign * start, sign * end), here)
        return here & (value < 0), s, sign * value


def _some(where: Lanes) -> bool:
    """Whether a condition holds somewhere, or may do so because its values are not known."""
    return isinstance(where, Traced) or bool(np.any(where))


def lowest(
    f: Callable[[Array], Array], h: Array, guess: Array, ends: tuple[Array, Array], here: BooleanArray
) -> tuple[Array, Array]:
    """Points s between 0 and h at which f > 0 is lowest, and f(s); ends where f < 0 or f stays clear of 0."""

    def again(*numbers: Array) -> list[Array]:
        busy, clear, a, b, c, fa, fb, fc = cast("list[Any]", numbers)
        x, least = _vertex((a, b, c), (fa, fb, fc))
        bracketed = (fb <= fa) & (fb <= fc)
        far = bracketed & (least > CLEAR_OF_ZERO * fb)
        busy = busy & ~(far & clear)
        # without a bracket, the extremum is beyond the lower end: f decreases at 0 and increases at h
        x = np.where(bracketed, x, np.where(fb > fc, (b + c) / 2, (a + b) / 2))
        x = np.where(busy, x, b)
        fx = np.where(busy, f(x), fb)
        clear = far & (np.abs(fx - least) <= PARABOLIC * fb)  # else the parabola says nothing of f
        left, lower = np.abs(x) < np.abs(b), (fx < fb) | ~bracketed
        moved = busy & (x != b)
        outer, inner = moved & (left ^ lower), moved & ~(left ^ lower)
        a, fa, b, fb, c, fc = (
            np.where(outer, np.where(lower, b, x), a),
            np.where(outer, np.where(lower, fb, fx), fa),
            np.where(moved & lower, x, b),
            np.where(moved & lower, fx, fb),
            np.where(inner, np.where(lower, b, x), c),
            np.where(inner, np.where(lower, fb, fx), fc),
        )
        return [moved & unsettled(a, c, fb), clear, a, b, c, fa, fb, fc]

    def unsettled(a: Array, c: Array, fb: Array) -> BooleanArray:
        return (fb > 0) & (np.abs(c - a) > EXTREMUM_RTOL * np.abs(h))

    fa, fc = (0 * h + x for x in ends)
    fb = f(guess)
    state = [here & unsettled(0 * h, h, fb), h != h, 0 * h, guess, h, fa, fb, fc]
    last = repeated(again, state, EXTREMUM_ITERATIONS)
    return last[3], last[6]


def _vertex(points: tuple[Array, Array, Array], values: tuple[Array, Array, Array]) -> tuple[Array, Array]:
    """The lowest point of the parabola through three points, kept a little away from them, and its value there."""
    (a, b, c), (fa, fb, fc) = points, values
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        left, right = (fb - fa) / (b - a), (fc - fb) / (c - b)
        bend = (right - left) / (c - a)
        x = (a + b) / 2 - left / (2 * bend)
        least = fa + left * (x - a) + bend * (x - a) * (x - b)
    gap = np.minimum(np.abs(b - a), np.abs(c - b)) / 8
    wider = np.where(np.abs(b - a) > np.abs(c - b), a, c)
    inside = np.isfinite(x) & (np.abs(x) > np.abs(a)) & (np.abs(x) < np.abs(c))
    x = np.where(inside, x, (b + wider) / 2)
    close = np.abs(x - b) < EXTREMUM_RTOL / 8 * np.abs(c - a)
    return np.where(close, b + np.sign(wider - b) * gap, x), np.where(np.isfinite(least), least, fb)


def bracketed_zero(g: Callable[[Array], Array], h: Array, start: Array, end: Array, here: BooleanArray) -> Array:
    """Zeros of g between 0 and h by Chandrupatla's method, for the trajectories `here`; the end of the bracket at h."""
    least = 2 * np.finfo(h.dtype).eps * np.abs(h)

    # a is the newest point, b the other end of the bracket, c the newest of the points that are not ends any more
    def again(*numbers: Array) -> list[Array]:
        busy, a, b, c, ga, gb, gc, fraction, far = cast("list[Any]", numbers)
        x = np.where(busy, a + fraction * (b - a), far)
        gx = g(x)
        same = ~((gx > 0) ^ (ga > 0))
        c, gc = np.where(busy, np.where(same, a, b), c), np.where(busy, np.where(same, ga, gb), gc)
        b, gb = np.where(busy & ~same, a, b), np.where(busy & ~same, ga, gb)
        a, ga = np.where(busy, x, a), np.where(busy, gx, ga)
        far = np.where(busy, np.where(np.abs(a) > np.abs(b), a, b), far)
        far, busy = np.where(busy & (gx == 0), x, far), busy & (gx != 0)
        fraction = _next_fraction((a, b, c), (ga, gb, gc), least)
        return [busy & (np.abs(b - a) > 2 * least), a, b, c, ga, gb, gc, fraction, far]

    zero = 0 * h
    state = [here & (end != 0) & (np.abs(h) > 2 * least), h, zero, zero, end, start, start, zero + 0.5, h]
    far: Array = repeated(again, state, ITERATIONS)[8]
    return far


def _next_fraction(points: tuple[Array, Array, Array], values: tuple[Array, Array, Array], least: Array) -> Array:
    """The next point as a fraction of the way from a to b: by inverse quadratic interpolation if monotone, else 1/2."""
    (a, b, c), (ga, gb, gc) = points, values
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        xi, phi = (a - b) / (c - b), (ga - gb) / (gc - gb)
        safe = (phi * phi < xi) & ((1 - phi) * (1 - phi) < 1 - xi)
        fitted = ga / (gb - ga) * (gc / (gb - gc)) + (c - a) / (b - a) * (ga / (gc - ga)) * (gb / (gc - gb))
        margin = np.minimum(least / np.abs(b - a), 0.5)
    margin = np.where(np.isfinite(margin), margin, 0.5)
    return np.clip(np.where(safe & np.isfinite(fitted), fitted, 0.5), margin, 1 - margin)


def _direction(direction: object, i: int) -> float:
    try:
        number = float(direction)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = np.nan
    if np.isnan(number):
        raise InputError(f"events[{i}].direction is {displayed(direction)}, expected a number")
    return number


def _limit(terminal: object, i: int) -> float:
    """Number of occurrences that ends the integration, inf for none."""
    if isinstance(terminal, bool | np.bool_) or terminal is None:
        return 1.0 if terminal else np.inf
    if isinstance(terminal, int | np.integer | float) and terminal >= 0 and terminal == np.floor(terminal):
        return float(terminal) if terminal > 0 else np.inf
    raise InputError(
        f"events[{i}].terminal is {displayed(terminal)}, expected a bool or a positive number of occurrences"
    )
