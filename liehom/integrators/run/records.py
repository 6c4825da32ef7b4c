"""Records of a run: its path, the points at requested times, and the events.

Each record gives its state as named arrays, for checkpoints.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.typing import Array, BooleanArray, IntegerArray

PATH_NAMES = ("times", "points", "sizes", "moved")


@final
class Path:
    """Times, points and sizes of all steps; in an ensemble, some trajectories may not move in a step.

    Parameters
    ----------
    t : array of shape (...,)
        Initial times.
    m : array of shape (..., N)
        Initial points.

    Examples
    --------
    >>> path = Path(np.zeros(2), np.zeros((2, 3)))
    >>> path.add(np.array([0.0, 0.5]), np.ones((2, 3)), np.array([0.0, 0.5]), np.array([False, True]))
    >>> times, points, sizes = path.compact()
    >>> times.tolist(), points.shape, sizes.tolist()
    ([[0.0, 0.0], [nan, 0.5]], (2, 2, 3), [[0.0, 0.5]])
    """

    def __init__(self, t: Array, m: Array) -> None:
        # blocks (k, ...) of times, points, sizes, and of booleans: whether the trajectory moved
        self._blocks: list[tuple[npt.NDArray[Any], ...]] = []
        self.add(t, m, np.zeros_like(t), np.ones(t.shape, dtype=bool))

    def __len__(self) -> int:
        return sum(len(block[0]) for block in self._blocks)

    def add(self, t: Array, m: Array, h: Array, moved: BooleanArray) -> None:
        """Append a step of sizes h to (t, m), for the trajectories that moved."""
        self.extend(np.asarray(t)[None], np.asarray(m)[None], np.asarray(h)[None], np.asarray(moved)[None])

    def extend(self, t: Array, m: Array, h: Array, moved: BooleanArray) -> None:
        """Append several steps, along a first axis.

        Examples
        --------
        >>> path = Path(np.array(0.0), np.zeros(2))
        >>> path.extend(np.array([1.0, 2.0]), np.ones((2, 2)), np.ones(2), np.ones(2, dtype=bool))
        >>> len(path)
        3
        """
        self._blocks.append((t, m, h, moved))

    def cut(self, length: int) -> None:
        """Remove all but the first `length` entries."""
        excess = len(self) - length
        while excess > 0:
            block = self._blocks.pop()
            if len(block[0]) > excess:
                self._blocks.append(tuple(x[:-excess] for x in block))
            excess -= len(block[0])

    def _whole(self) -> tuple[npt.NDArray[Any], ...]:
        made = tuple(np.concatenate(parts) for parts in zip(*self._blocks, strict=True))
        self._blocks = [made]
        return made

    def compact(self) -> tuple[Array, Array, Array]:
        """Times (n + 1, ...), points (n + 1, ..., N) and sizes (n, ...), of each trajectory without gaps.

        They are filled up with NaN (sizes with 0) to the largest number of steps.
        """
        times, points, sizes, moved = self._whole()
        if not bool(moved.all()):
            order = np.argsort(~moved, axis=0, kind="stable")[: int(moved.sum(axis=0).max(initial=1))]
            moved = np.take_along_axis(moved, order, axis=0)
            times = np.where(moved, np.take_along_axis(times, order, axis=0), np.nan)
            sizes = np.where(moved, np.take_along_axis(sizes, order, axis=0), 0)
            points = np.where(moved[..., None], np.take_along_axis(points, order[..., None], axis=0), np.nan)
        return times, points, sizes[1:]

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return dict(zip(PATH_NAMES, self._whole(), strict=True))

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self._blocks = [tuple(arrays[name] for name in PATH_NAMES)]


@final
class Samples:
    """Points at requested times, filled in when a step passes them.

    Parameters
    ----------
    times : array of shape (k,)
        In the direction of integration.
    shape : tuple of int
        Shape (..., N) of the points at one time.
    dtype : dtype
    direction : float
        1, or -1 if time decreases.

    Examples
    --------
    >>> samples = Samples(np.array([0.5]), (2,), float, 1.0)
    >>> samples.fill(lambda t, here: np.array([t, -t]), np.array(1.0), np.array(True))
    >>> samples.points[..., 0].tolist()
    [0.5, -0.5]
    """

    def __init__(self, times: Array, shape: tuple[int, ...], dtype: npt.DTypeLike, direction: float) -> None:
        self.times = times
        self.points: Array = np.full((*shape, len(times)), np.nan, dtype=dtype)
        self.done: IntegerArray = np.zeros(shape[:-1], dtype=int)
        self._direction = direction
        self._ascending = direction * times

    def start(self, t: np.floating[Any], m: Array) -> None:
        """Fill in the initial points if the first requested time is the initial time."""
        if len(self.times) and self.times[0] == t:
            self.points[..., 0] = m
            self.done = self.done + 1

    def fill(self, at: Callable[[Array, BooleanArray], Array], after: Array, moves: BooleanArray) -> None:
        """Fill in the times up to `after` by at(time, here), for the trajectories that move."""
        upto = np.searchsorted(self._ascending, self._direction * after, side="right")
        new = moves & (upto > self.done)
        if not bool(np.any(new)):
            return
        first, last = np.min(self.done, where=new, initial=len(self.times)), np.max(upto, where=new, initial=0)
        for k in range(int(first), int(last)):
            here = new & (self.done <= k) & (k < upto)
            if bool(np.any(here)):
                self.points[..., k] = np.where(here[..., None], at(self.times[k], here), self.points[..., k])
        self.done = np.where(new, upto, self.done)

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return {"points": self.points, "done": self.done}

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self.points, self.done = arrays["points"], arrays["done"]


@final
class EventLog:
    """Log of the events that occurred: rows (event, trajectory, time, point), for each trajectory in order of time.

    Parameters
    ----------
    count : int
        Number of event functions.
    shape : tuple of int
        Shape of the ensemble.
    size : int
        Number of coordinates of a point.

    Examples
    --------
    >>> log = EventLog(1, (), 2)
    >>> log.add(0, np.array(True), np.array(0.5), np.array([1.0, 0.0]))
    >>> log.lists()[0][0]
    array([0.5])
    """

    def __init__(self, count: int, shape: tuple[int, ...], size: int) -> None:
        self._count, self._shape, self._size = count, shape, size
        self.occurrences: IntegerArray = np.zeros((count, *shape), dtype=int)
        self.rows: list[tuple[int, int, np.floating[Any], Array]] = []

    def add(self, i: int, here: BooleanArray, t: Array, y: Array, *, counted: bool = True) -> None:
        """Record event i at (t, y) for the trajectories `here`, `counted` towards the number that ends them."""
        if counted:
            more = np.zeros_like(self.occurrences)
            more[i] = here
            self.occurrences = self.occurrences + more
        times, points = np.reshape(t, -1), np.reshape(y, (-1, self._size))
        self.rows += [(i, int(b), times[b], points[b]) for b in np.flatnonzero(here)]

    def lists(self) -> tuple[list[npt.NDArray[Any]], list[npt.NDArray[Any]]]:
        """(t_events, y_events) of a `Solution`."""
        size = int(np.prod(self._shape, dtype=int))
        groups: list[list[list[tuple[np.floating[Any], Array]]]]
        groups = [[[] for _ in range(size)] for _ in range(self._count)]
        for i, b, t, y in self.rows:
            groups[i][b].append((t, y))
        times, points = [], []
        for group in groups:
            t_row, y_row = np.empty(size, dtype=object), np.empty(size, dtype=object)
            for b, mine in enumerate(group):
                t_row[b] = np.array([t for t, _ in mine])
                y_row[b] = np.array([y for _, y in mine]).reshape(-1, self._size)
            times.append(t_row[0] if self._shape == () else t_row.reshape(self._shape))
            points.append(y_row[0] if self._shape == () else y_row.reshape(self._shape))
        return times, points

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return {
            "occurrences": self.occurrences,
            "index": np.array([row[:2] for row in self.rows], dtype=int).reshape(-1, 2),
            "t": np.array([row[2] for row in self.rows]),
            "y": np.array([row[3] for row in self.rows]),
        }

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self.occurrences = arrays["occurrences"]
        rows = zip(arrays["index"], arrays["t"], arrays["y"], strict=True)
        self.rows = [(int(i), int(b), t, y) for (i, b), t, y in rows]
