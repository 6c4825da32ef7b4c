"""Events: zeros of functions g(t, y) along trajectories, located on the dense output of a step.

An event is a change of the sign of g, or a change to 0, between the ends of a step. Chandrupatla's method (inverse
quadratic interpolation if it is safe, else bisection) locates it to round-off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np

from liehom.errors import InputError, displayed
from liehom.typing import Array, BooleanArray

ITERATIONS = 200

EventFunction: TypeAlias = Callable[[Any, Any], Any]
"""g(t, y): times (...,) and points (..., N) to real numbers (...,)."""


@final
class Events:
    """The events of a run, for one trajectory or an ensemble.

    Parameters
    ----------
    functions : callable or sequence of callables
        g(t, y) with y (N,); for an ensemble y (..., N) and t (...,), result (...,). As in solve_ivp, a function may
        have the attributes `terminal` (bool, or the number of occurrences that ends the integration) and
        `direction` (positive: only zeros at which g increases in the direction of integration; negative: only those
        at which g decreases).

    Raises
    ------
    InputError
        If an entry is not a function, or returns an array of another shape.

    Notes
    -----
    A zero at the initial time is recorded, as by solve_ivp, if g leaves it in the right direction. It is not counted
    towards `terminal`, so that a run may start where another one has ended. Two zeros within one step are not noticed:
    see `max_step`.

    Examples
    --------
    >>> events = Events(lambda t, y: y[..., 0])
    >>> events.count
    1
    """

    def __init__(self, functions: EventFunction | Sequence[EventFunction]) -> None:
        if not callable(functions) and not isinstance(functions, list | tuple):
            raise InputError(f"events is {displayed(functions)}, expected a function g(t, y) or a list of functions")
        listed = [functions] if callable(functions) else list(functions)
        for i, g in enumerate(listed):
            if not callable(g):
                raise InputError(f"events[{i}] is {displayed(g)}, expected a function g(t, y)")
        self.functions: Sequence[EventFunction] = listed
        self.directions: list[float] = [_direction(getattr(g, "direction", 0), i) for i, g in enumerate(listed)]
        self.terminal: list[float] = [_limit(getattr(g, "terminal", False), i) for i, g in enumerate(listed)]

    @property
    def count(self) -> int:
        """Number of event functions."""
        return len(self.functions)

    def value(self, i: int, t: Array, y: Array) -> Array:
        """g_i(t, y), shape (...,)."""
        given = self.functions[i](t if np.ndim(t) else np.asarray(t)[()], y)
        try:
            value = np.asarray(given)
            value = value if value.dtype.kind == "f" else value.astype(np.float64, casting="same_kind")
        except (TypeError, ValueError):
            raise InputError(f"events[{i}] returned {displayed(given)}, expected real numbers") from None
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

    def locate(
        self,
        i: int,
        at: Callable[[Array], tuple[Array, Array]],
        h: Array,
        ends: tuple[Array, Array],
        here: BooleanArray,
    ) -> Array:
        """Step sizes s in (0, h] at which event i occurs, on the far side of the zero, for the trajectories `here`.

        Parameters
        ----------
        i : int
        at : callable
            s (...,) -> (t, y).
        h : array of shape (...,)
        ends : (array, array)
            g_i at s = 0 and at s = h.
        here : bool array of shape (...,)
        """

        def g(s: Array) -> Array:
            return self.value(i, *at(s)).astype(s.dtype)

        start, end = (np.asarray(x, dtype=h.dtype) for x in ends)
        return bracketed_zero(g, np.where(here, h, 0), start, end, here)


def bracketed_zero(g: Callable[[Array], Array], h: Array, start: Array, end: Array, here: BooleanArray) -> Array:
    """Zeros of g between 0 and h by Chandrupatla's method, for the trajectories `here`; the end of the bracket at h.

    Parameters
    ----------
    g : callable
        s (...,) -> g(s) (...,).
    h, start, end : arrays of shape (...,)
        The far end of the bracket, g(0) and g(h).
    here : bool array of shape (...,)

    Examples
    --------
    >>> import numpy as np
    >>> found = bracketed_zero(lambda s: s * s - 2, np.array(2.0), np.array(-2.0), np.array(2.0), np.array(True))
    >>> round(float(found), 12)
    1.414213562373
    """
    # a is the newest point, b the other end of the bracket, c the newest of the points that are not ends any more
    a, b, c = h, np.zeros_like(h), np.zeros_like(h)
    ga, gb, gc = end, start, start
    fraction = np.full(np.shape(h), 0.5, dtype=h.dtype)
    least = 2 * np.finfo(h.dtype).eps * np.abs(h)
    busy = here & (end != 0)
    far = h
    for _ in range(ITERATIONS):
        busy = busy & (np.abs(b - a) > 2 * least)
        if not bool(np.any(busy)):
            break
        x = np.where(busy, a + fraction * (b - a), far)
        gx = g(x)
        same = (gx > 0) == (ga > 0)
        c, gc = np.where(busy, np.where(same, a, b), c), np.where(busy, np.where(same, ga, gb), gc)
        b, gb = np.where(busy & ~same, a, b), np.where(busy & ~same, ga, gb)
        a, ga = np.where(busy, x, a), np.where(busy, gx, ga)
        far = np.where(busy, np.where(np.abs(a) > np.abs(b), a, b), far)
        far, busy = np.where(busy & (gx == 0), x, far), busy & (gx != 0)
        fraction = _next_fraction((a, b, c), (ga, gb, gc), least)
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
    fraction: Array = np.clip(np.where(safe & np.isfinite(fitted), fitted, 0.5), margin, 1 - margin)
    return fraction


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
