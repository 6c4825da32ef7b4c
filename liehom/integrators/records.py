"""What a run keeps: points at every step or at requested times, events, and the corrector's account.

Imports events, clock, solution, correctors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np

from liehom.correctors.corrected import Corrected
from liehom.correctors.order import Correction
from liehom.correctors.step import Step
from liehom.homogeneous import Action
from liehom.integrators.solution import Report

At = Callable[[Any], tuple[Any, Any]]


@final
class Account:
    """The extremes of what the corrector reported, over all steps.

    Examples
    --------
    >>> import liehom as lh
    >>> account = Account(lh.Euler(), (3,))
    >>> account.arrays()["reached"].tolist()
    [1, 1, 1]
    """

    def __init__(self, step: Step, shape: tuple[int, ...]) -> None:
        self._step = step
        self._wanted = step.order
        self._base = step.step.order if isinstance(step, Corrected) else step.order
        self._seen = {
            "reached": np.full(shape, step.order),
            "residual": np.zeros(shape),
            "singular": np.full(shape, np.inf),
            "rank": np.full(shape, np.iinfo(np.int64).max),
            "failed": np.zeros(shape, dtype=int),
            "equilibria": np.zeros(shape, dtype=int),
        }
        self._where: tuple[float, tuple[float, ...]] | None = None

    def add(self, found: Correction, t: Any, m: Any, active: Any) -> None:
        """Take in the correction of one step where trajectories are active."""
        seen = self._seen
        moving = active & (found.leading > 0)
        seen["equilibria"] = seen["equilibria"] + (active & ~moving)
        seen["reached"] = np.where(active, np.minimum(seen["reached"], found.reached), seen["reached"])
        seen["residual"] = np.where(active, np.maximum(seen["residual"], found.residual), seen["residual"])
        seen["failed"] = seen["failed"] + (active & (found.reached < self._wanted))
        seen["rank"] = np.where(moving, np.minimum(seen["rank"], found.rank), seen["rank"])
        lowest = np.where(moving, found.singular_value, np.inf)
        if bool(np.any(lowest < np.min(seen["singular"], initial=np.inf))):
            index = np.unravel_index(int(np.argmin(lowest)), np.shape(lowest))
            self._where = (float(np.asarray(t)[index]), tuple(float(x) for x in np.asarray(m)[index]))
        seen["singular"] = np.minimum(seen["singular"], lowest)

    def report(self, action: Action, clock: str, orbit_dimension: Any) -> Report:
        """The account as a report."""
        seen = self._seen
        rank = int(np.min(seen["rank"], initial=np.iinfo(np.int64).max))
        return Report(
            step=repr(self._step),
            exponential=action.exponential.name,
            clock=clock,
            base_order=self._base,
            order=int(np.min(seen["reached"], initial=self._wanted)),
            wanted_order=self._wanted,
            worst_residual=float(np.max(seen["residual"], initial=0.0)),
            singular_value=float(np.min(seen["singular"], initial=np.inf)),
            singular_at=self._where,
            rank=0 if rank == np.iinfo(np.int64).max else rank,
            orbit_dimension=int(np.max(orbit_dimension, initial=0)),
            failed_steps=int(seen["failed"].sum()),
            equilibria=int(seen["equilibria"].sum()),
            inner_product=action.inner_product.name,
        )

    def arrays(self) -> dict[str, Any]:
        """The state, for a checkpoint."""
        where = [] if self._where is None else [self._where[0], *self._where[1]]
        return {**self._seen, "where": np.array(where)}

    def restore(self, arrays: dict[str, Any]) -> None:
        """Take a state back."""
        self._seen = {name: arrays[name] for name in self._seen}
        where = [float(x) for x in arrays["where"]]
        self._where = (where[0], tuple(where[1:])) if where else None


@final
class Samples:
    """The points at requested times, filled in as steps pass them.

    Examples
    --------
    >>> samples = Samples(np.array([0.5]), (2,), float, 1.0)
    >>> samples.fill(lambda t, here: np.array([t, -t]), np.array(0.0), np.array(1.0), np.array(True))
    >>> samples.points[..., 0].tolist()
    [0.5, -0.5]
    """

    def __init__(self, times: Any, shape: tuple[int, ...], dtype: Any, direction: float) -> None:
        self.times = times
        self.points = np.full((*shape, len(times)), np.nan, dtype=dtype)
        self.done = np.zeros(shape[:-1], dtype=int)
        self._direction = direction

    def start(self, t: Any, m: Any) -> None:
        """The requested times that are the starting time."""
        if len(self.times) and self.times[0] == t:
            self.points[..., 0] = m
            self.done = self.done + 1

    def fill(self, at: Callable[[Any, Any], Any], before: Any, after: Any, active: Any) -> None:
        """Take the times in (before, after] from at(time, here)."""
        if not len(self.times):
            return
        upto = np.searchsorted(self._direction * self.times, self._direction * after, side="right")
        upto = np.where(active, upto, self.done)
        for k in range(int(self.done.min(initial=len(self.times))), int(upto.max(initial=0))):
            here = (self.done <= k) & (k < upto)
            if bool(np.any(here)):
                self.points[..., k] = np.where(here[..., None], at(self.times[k], here), self.points[..., k])
        self.done = np.maximum(self.done, upto)


@final
class Found:
    """The events that occurred: (event, trajectory, time, point) in the order of time.

    Examples
    --------
    >>> found = Found(1, ())
    >>> found.add(0, np.array(True), np.array(0.5), np.array([1.0, 0.0]))
    >>> found.lists()[0][0]
    array([0.5])
    """

    def __init__(self, count: int, shape: tuple[int, ...]) -> None:
        self._count, self._shape = count, shape
        self.occurrences = np.zeros((count, *shape), dtype=int)
        self.rows: list[tuple[int, int, Any, Any]] = []

    def add(self, i: int, here: Any, t: Any, y: Any) -> None:
        """Event i at times t where `here`."""
        more = np.zeros_like(self.occurrences)
        more[i] = here
        self.occurrences = self.occurrences + more
        times, points = np.reshape(t, -1), np.reshape(y, (-1, np.shape(y)[-1]))
        self.rows += [(i, int(b), times[b], points[b]) for b in np.flatnonzero(here)]

    def lists(self) -> tuple[list[Any], list[Any]]:
        """t_events, y_events as a `Solution` has them."""
        size = int(np.prod(self._shape, dtype=int))
        times, points = [], []
        for i in range(self._count):
            t_row, y_row = np.empty(size, dtype=object), np.empty(size, dtype=object)
            for b in range(size):
                mine = [(t, y) for j, c, t, y in self.rows if j == i and c == b]
                t_row[b] = np.array([t for t, _ in mine])
                y_row[b] = np.array([y for _, y in mine])
            times.append(t_row[0] if self._shape == () else t_row.reshape(self._shape))
            points.append(y_row[0] if self._shape == () else y_row.reshape(self._shape))
        return times, points

    def arrays(self) -> dict[str, Any]:
        """The state, for a checkpoint."""
        return {
            "occurrences": self.occurrences,
            "index": np.array([row[:2] for row in self.rows], dtype=int).reshape(-1, 2),
            "t": np.array([row[2] for row in self.rows]),
            "y": np.array([row[3] for row in self.rows]),
        }

    def restore(self, arrays: dict[str, Any]) -> None:
        """Take a state back."""
        self.occurrences = arrays["occurrences"]
        self.rows = [
            (int(i), int(b), t, y) for (i, b), t, y in zip(arrays["index"], arrays["t"], arrays["y"], strict=True)
        ]
