"""Event functions on any number of points of a run, also those that take only what an eager run gives them.

An event function is called with all points at once if that gives, at some points, what it gives for them in the form of
the run: a point (N,), or the whole ensemble (..., N). Others are called in that form, as often as needed.
"""

from __future__ import annotations

from functools import partial
from typing import Any, final

import numpy as np

from liehom.errors import LiehomError
from liehom.integrators.compiled.parameters import args_of_lanes
from liehom.integrators.run.events import Events
from liehom.integrators.run.run import Run
from liehom.typing import Array, IntegerArray

FAILURES = (LiehomError, TypeError, ValueError, IndexError, KeyError, ArithmeticError)
"""What functions raise that were not written for this number of points."""
RTOL = 1e-9
NEAR = 1e-3


@final
class EventValues:
    """The event functions of a run at pairs (t, y) of given trajectories.

    Parameters
    ----------
    run : Run

    Attributes
    ----------
    events : Events
        Those of the run.
    at_once : list of bool
        Which functions are called with all pairs at once.
    trial_lanes, trial_points : arrays of shape (p,) and (p, N)
        Trajectories, in another order and number than in the run, with which this is found out.

    Examples
    --------
    >>> import liehom as lh
    >>> field, e = lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0])
    >>> events = [lambda t, y: y[0], lambda t, y: y[..., 0]]
    >>> [lh.integrate(field, (0, 4), e, dt=0.5, events=g, engine="llvm").t_events[0].size for g in events]
    [1, 1]
    """

    def __init__(self, run: Run) -> None:
        events: Any = run.stops.events
        self.events: Events = events
        self.run = run
        self.start = run.start.reshape(-1, run.start.shape[-1])
        lanes, size = self.start.shape
        some = np.arange(max(lanes, size) + 1)[::-1] if lanes else np.zeros(0, dtype=int)
        self.trial_lanes: IntegerArray = some % max(lanes, 1)
        points = self.start[self.trial_lanes]
        if not run.shape:  # points that differ, as those of an ensemble do
            points = points * (1 + NEAR * np.random.default_rng(0).normal(size=points.shape))
        self.trial_points: Array = points
        begin = np.full(len(self.trial_lanes), float(run.span[0]))
        self.at_once = [True] * events.count
        at_once = self.of(self.trial_lanes)
        for i in range(events.count):
            self.checked(i, at_once, begin, points, self.trial_lanes, len(begin))

    def of(self, lanes: IntegerArray) -> Events:
        """The event functions of pairs t (p,), y (p, N) of these trajectories."""
        args: Any = self.run.field.args
        given: Any = self.run.options.events
        made = Events(given, None if args is None else args_of_lanes(args, self.run.shape, lanes))
        made.functions = [
            function if self.at_once[i] else partial(self._in_turn, i, lanes)
            for i, function in enumerate(made.functions)
        ]
        return made

    def checked(self, i: int, events: Events, t: Array, y: Array, lanes: IntegerArray, some: int = 1) -> Array:
        """g_i at pairs; at the last ones it is compared with the function in the form of the run."""
        if self.at_once[i]:
            try:
                found = events.value(i, t, y)
                there = slice(len(t) - some, None)
                wanted = self._in_turn(i, lanes[there], t[there], y[there])
                if np.allclose(
                    found[there], wanted, rtol=RTOL, atol=RTOL * float(np.abs(wanted).max()), equal_nan=True
                ):
                    return found
            except FAILURES:
                pass
            self.at_once[i] = False
        return self._in_turn(i, lanes, t, y)

    def _in_turn(self, i: int, lanes: IntegerArray, t: Array, y: Array) -> Array:
        """g_i by calls in the form of the run; trajectories without a pair are at their initial points."""
        shape = self.run.shape
        if not shape:
            single: Array = np.array(
                [float(self.events.value(i, time, point)) for time, point in zip(t, y, strict=True)]
            )
            return single
        found: Array = np.empty(len(t))
        for here in _rounds(lanes):
            times, points = np.full(len(self.start), float(self.run.span[0])), self.start.copy()
            times[lanes[here]], points[lanes[here]] = t[here], y[here]
            value = self.events.value(i, times.reshape(shape), points.reshape(*shape, -1))
            found[here] = value.reshape(-1)[lanes[here]]
        return found


def _rounds(lanes: IntegerArray) -> list[IntegerArray]:
    """Indices of pairs in groups, in each of which a trajectory has at most one pair."""
    if not len(lanes):
        return []
    order = np.argsort(lanes, kind="stable")
    ordered = lanes[order]
    begins = np.append(True, ordered[1:] != ordered[:-1])
    rank = np.arange(len(lanes)) - np.maximum.accumulate(np.where(begins, np.arange(len(lanes)), 0))
    by_rank = np.argsort(rank, kind="stable")
    cuts = np.flatnonzero(np.diff(rank[by_rank])) + 1
    return [order[group] for group in np.split(by_rank, cuts)]
