"""Records of a run: its path, the points at requested times, the events, and statistics of the corrections.

Each record gives its state as named arrays, for checkpoints.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.conserving import Conserving, ConservingStep
from liehom.correctors.isotropy.corrected import Corrected, CorrectedStep
from liehom.correctors.isotropy.isotropy_corrector import Correction
from liehom.correctors.step import LocalStep, Step
from liehom.homogeneous import Action
from liehom.integrators.run.conservation_statistics import NO_RANK, ConservationStatistics
from liehom.integrators.run.solution import Report, loss_of_order
from liehom.typing import Array, BooleanArray, IntegerArray, Real, Values

SINCE_0_2: dict[str, float] = {"near": 0, "unkept_from": np.nan}
"""Statistics that checkpoints of 0.1.0 lack, with their values for a run in which nothing was noticed."""
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
class CorrectionStatistics:
    """Extremes and counts over all steps of what the corrector reported, for each trajectory.

    Examples
    --------
    >>> import liehom as lh
    >>> statistics = CorrectionStatistics(lh.Euler(), (3,))
    >>> statistics.arrays()["reached"].tolist()
    [1, 1, 1]
    """

    def __init__(self, step: Step, shape: tuple[int, ...]) -> None:
        self._step = step
        self._wanted = step.order
        inner = step.step if isinstance(step, Conserving) else step
        self._base = inner.step.order if isinstance(inner, Corrected) else step.order
        self._conservation = ConservationStatistics(step, shape)
        self._seen: dict[str, npt.NDArray[Any]] = {
            "reached": np.full(shape, step.order),
            "residual": np.zeros(shape),
            "singular": np.full(shape, np.inf),
            "rank": np.full(shape, NO_RANK),
            "failed": np.zeros(shape, dtype=int),
            "equilibria": np.zeros(shape, dtype=int),
            **{name: np.full(shape, value) for name, value in SINCE_0_2.items()},
        }
        self._where: tuple[float, tuple[float, ...]] | None = None

    def take(self, local: LocalStep, h: Array, t: Array, m: Array, active: BooleanArray) -> None:
        """Record what a step of size h (...,) at (t, m) reports, for the active trajectories."""
        if isinstance(local, ConservingStep):
            self._conservation.add(local, h, t, m, active)
            local = local.base
        if isinstance(local, CorrectedStep):
            self.add(local.correction, h, t, m, active)

    def add(self, found: Correction, h: Array, t: Array, m: Array, active: BooleanArray) -> None:
        """Record the correction of one step of size h at (t, m), for the active trajectories."""
        seen = dict(self._seen)  # the arrays are replaced, never written into: older states stay whole
        moving: BooleanArray = active & (found.leading > 0)
        seen["equilibria"] = seen["equilibria"] + (active & ~moving)
        short = active & (found.reached < self._wanted)
        if bool(short.any()):
            seen["reached"] = np.where(short, np.minimum(seen["reached"], found.reached), seen["reached"])
            seen["failed"] = seen["failed"] + short
        near = active & found.near_cone(h)
        if bool(near.any()):
            seen["near"] = seen["near"] + near
            seen["reached"] = np.where(near, self._base, seen["reached"])
        if bool(short.any()) or bool(near.any()):
            seen["unkept_from"] = np.where((short | near) & np.isnan(seen["unkept_from"]), t, seen["unkept_from"])
        worse = active & (found.residual > seen["residual"])
        seen["residual"] = np.where(worse, found.residual, seen["residual"])
        rank, singular = found.rank, found.singular_value
        less = moving & (rank < seen["rank"])
        seen["rank"] = np.where(less, rank, seen["rank"])
        lower = moving & (singular < seen["singular"])
        if bool(lower.any()):
            self._note_where(np.where(lower, singular, np.inf), t, m)
            seen["singular"] = np.where(lower, singular, seen["singular"])
        self._seen = seen

    def add_compiled(self, lanes: IntegerArray, extra: Mapping[str, Array], ends: tuple[float, float]) -> None:
        """Record the totals of compiled steps, for some trajectories of the flattened ensemble.

        Parameters
        ----------
        lanes : array of int of shape (L,)
            Indices of the trajectories.
        extra : dict of arrays of shape (L,)
            The largest residual, the largest number of orders missed ("short"), the numbers of steps that missed the
            order ("failed"), were near the cone ("near") or at equilibria, the `earliness` of the first step that did
            not keep the order ("unkept"), and the totals that `ConservationStatistics` records.
        ends : (float, float)
            Initial and final time.
        """
        seen = {name: np.array(x).reshape(-1) for name, x in self._seen.items()}
        if "short" in extra:
            seen["residual"][lanes] = np.maximum(seen["residual"][lanes], extra["residual"])
            seen["reached"][lanes] = np.minimum(seen["reached"][lanes], self._wanted - extra["short"].astype(int))
            seen["failed"][lanes] += extra["failed"].astype(int)
            seen["near"][lanes] += extra["near"].astype(int)
            seen["reached"][lanes] = np.where(extra["near"] > 0, self._base, seen["reached"][lanes])
            new = (extra["unkept"] > 0) & np.isnan(seen["unkept_from"][lanes])
            times = time_of(extra["unkept"], ends)
            seen["unkept_from"][lanes] = np.where(new, times, seen["unkept_from"][lanes])
        if "equilibria" in extra:
            seen["equilibria"][lanes] += extra["equilibria"].astype(int)
        self._seen = {name: x.reshape(np.shape(self._seen[name])) for name, x in seen.items()}
        if "usual" in extra:
            self._conservation.add_compiled(lanes, extra)

    def note_ranks(self, found: Correction, lanes: IntegerArray, t: Array, m: Array) -> None:
        """Record ranks and singular values of corrections (L,) at (t, m), for these trajectories of the ensemble."""
        singular = np.where(found.leading > 0, found.singular_value, np.inf)
        self._note_where(singular, t, m)
        for name, new in (("rank", np.where(found.leading > 0, found.rank, NO_RANK)), ("singular", singular)):
            least = np.array(self._seen[name])
            np.minimum.at(least.reshape(-1), lanes, new)
            self._seen = {**self._seen, name: least}

    def _note_where(self, lowest: Array, t: Array, m: Array) -> None:
        """Record where the smallest singular value of all trajectories was met, if it is in `lowest`."""
        if float(lowest.min()) < float(self._seen["singular"].min()):
            index = np.unravel_index(int(np.argmin(lowest)), np.shape(lowest))
            self._where = (float(t[index]), tuple(float(x) for x in m[index]))

    @property
    def unkept_from(self) -> Array:
        """Time of the first step that did not keep the order, shape (...,); NaN if there is none."""
        found: Array = self._seen["unkept_from"]
        return found

    @property
    def loss(self) -> str:
        """Why the order was not kept, a clause; empty if it was kept."""
        return loss_of_order(int(self._seen["failed"].sum()), int(self._seen["near"].sum()), self._order())

    def _order(self) -> int:
        return int(np.min(self._seen["reached"], initial=self._wanted))

    def report(
        self,
        action: Action,
        clock: str,
        orbit_dimension: int | IntegerArray,
        direction: float = 1.0,
        stopped_at: float | None = None,
    ) -> Report:
        """The statistics as a `Report`."""
        seen = self._seen
        from_times = direction * seen["unkept_from"]
        rank = int(np.min(seen["rank"], initial=NO_RANK))
        return Report(
            step=repr(self._step),
            exponential=action.exponential.name,
            clock=clock,
            base_order=self._base,
            order=self._order(),
            wanted_order=self._wanted,
            worst_residual=float(np.max(seen["residual"], initial=0.0)),
            singular_value=float(np.min(seen["singular"], initial=np.inf)),
            singular_at=self._where,
            rank=0 if rank == NO_RANK else rank,
            orbit_dimension=int(np.max(orbit_dimension, initial=0)),
            failed_steps=int(seen["failed"].sum()),
            equilibria=int(seen["equilibria"].sum()),
            inner_product=action.inner_product.name,
            conservation=self._conservation.report(),
            near_steps=int(seen["near"].sum()),
            unkept_from=None if bool(np.isnan(from_times).all()) else direction * float(np.nanmin(from_times)),
            stopped_at=stopped_at,
        )

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        where = [] if self._where is None else [self._where[0], *self._where[1]]
        kept = {f"conservation_{name}": x for name, x in self._conservation.arrays().items()}
        return {**self._seen, "where": np.array(where), **kept}

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self._seen = {name: arrays.get(name, start) for name, start in self._seen.items()}
        where = [float(x) for x in arrays["where"]]
        self._where = (where[0], tuple(where[1:])) if where else None
        start = "conservation_"
        self._conservation.restore({name[len(start) :]: x for name, x in arrays.items() if name.startswith(start)})


def near_cone(local: LocalStep, h: Array) -> BooleanArray:
    """Whether a step of size h (...,) comes near the cone on which its range condition fails, bool (...,).

    Examples
    --------
    >>> near_cone(LocalStep(None, np.zeros(2)), np.array([0.1, 0.2])).tolist()
    [False, False]
    """
    inner = local.base if isinstance(local, ConservingStep) else local
    return inner.correction.near_cone(h) if isinstance(inner, CorrectedStep) else np.zeros(np.shape(h), dtype=bool)


def bounds_of(ends: Sequence[float]) -> tuple[float, float]:
    """(1, or -1 if time decreases; a number that exceeds the times between the ends by at least 1).

    Examples
    --------
    >>> bounds_of((2.0, 0.0))
    (-1.0, 3.0)
    """
    return (1.0 if ends[1] >= ends[0] else -1.0), abs(float(ends[0])) + abs(float(ends[1])) + 1.0


def earliness(time: Values, bounds: tuple[Real, Real]) -> Values:
    """A decreasing function of the time that passes, positive up to the end; its largest value is the earliest time.

    Examples
    --------
    >>> earliness(np.array([0.5, 2.0]), (1.0, 3.0)).tolist(), float(earliness(np.array(0.5), (-1.0, 3.0)))
    ([2.5, 1.0], 3.5)
    """
    direction, limit = bounds
    found: Values = limit - direction * time
    return found


def time_of(value: Array, ends: Sequence[float]) -> Array:
    """The time of a given `earliness`.

    Examples
    --------
    >>> time_of(np.array([2.5, 1.0]), (0.0, 2.0)).tolist(), float(time_of(np.array(3.5), (2.0, 0.0)))
    ([0.5, 2.0], 0.5)
    """
    direction, limit = bounds_of(ends)
    found: Array = direction * (limit - value)
    return found


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
