"""The lanes of a kernel: their state as rows, and what becomes of them in the state of a run."""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.integrators.compiled.traced_step import totals_of
from liehom.integrators.run.options import END, EVENT
from liehom.integrators.run.run import Run
from liehom.tracing import Kernel, StepGraph
from liehom.typing import Array, BooleanArray, IntegerArray

LANE_STEPS_FOR_THREADS = 50_000
"""Steps of a call, summed over lanes, from which on threads share the blocks."""
_POOL: dict[int, ThreadPoolExecutor] = {}
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_POOL.clear)


class Made(NamedTuple):
    """The steps that a kernel has made of some lanes.

    Attributes
    ----------
    m, t, taken : arrays of shape (N, L), (L,) and (L,)
        Points, times and numbers of steps.
    going, done : bool arrays of shape (L,)
        Which lanes have steps left to be made by the kernel, and which are at the end.
    calls : array of shape (L,)
        Calls of psi.
    records : dict of (array of shape (L,), kind)
        Totals of the diagnostics of the steps.
    outputs : array of int of shape (k,)
        Indices of output times, which are contiguous.
    points : array of shape (k, N, L)
        The points at these times; only those are valid that `until` of a lane counts.
    until : int array of shape (L,)
        Number of output times that are reached.
    path : (times (j, L), points (j, N, L), sizes (j, L)) or None
        All steps; sizes are 0 where a lane did not move.
    h : array of shape (L,) or None
        Proposed sizes.
    halted : array of int of shape (L,) or None
        The row of `path` in which a terminal event ends the lane, -1 for none.
    """

    m: Array
    t: Array
    taken: IntegerArray
    going: BooleanArray
    done: BooleanArray
    calls: Array
    records: Mapping[str, tuple[Array, str]]
    outputs: IntegerArray
    points: Array
    until: IntegerArray
    path: tuple[Array, Array, Array] | None
    h: Array | None = None
    halted: IntegerArray | None = None


def run_blocks(kernel: Kernel, state: Array, given: Mapping[str, Any], steps: int) -> None:
    """Run a kernel on all blocks of a state, in threads if there is enough to do.

    Parameters
    ----------
    kernel : Kernel
    state : array of shape (names, lanes)
        Changed in place.
    given : dict
        Other fields of the argument of the kernel: arrays, or numbers.
    steps : int
        About the number of steps.
    """
    blocks = state.shape[1] // kernel.width
    workers = min(cores(), blocks) if state.shape[1] * steps >= LANE_STEPS_FOR_THREADS else 1
    if workers == 1:
        kernel(state, **given)
        return
    cuts = np.linspace(0, blocks, 4 * workers + 1 if blocks >= 8 * workers else workers + 1).astype(int)
    jobs = [
        _pool(workers).submit(kernel, state, **{**given, "first": int(a), "last": int(b)})
        for a, b in pairwise(cuts)
        if b > a
    ]
    for job in jobs:
        job.result()


def _pool(workers: int) -> ThreadPoolExecutor:
    """The threads that kernels share."""
    if workers not in _POOL:
        _POOL[workers] = ThreadPoolExecutor(workers, thread_name_prefix="liehom")
    return _POOL[workers]


def cores() -> int:
    """Number of threads that may run at once.

    Examples
    --------
    >>> cores() >= 1
    True
    """
    given = os.environ.get("LIEHOM_NUM_THREADS")
    if given and given.isdigit() and int(given) > 0:
        return int(given)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@final
class HandBack:
    """Writes what kernels have made of lanes to the state of a run."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.size: int = run.start.shape[-1]
        self.m = run.state.m.reshape(-1, self.size).astype(np.float64, copy=True)
        self.t = np.array(run.state.t, dtype=np.float64).reshape(-1)
        self.h = np.array(run.state.h, dtype=np.float64).reshape(-1)
        self.taken = np.array(run.state.taken).reshape(-1)
        self.before = self.taken.copy()
        self.active = run.state.active.reshape(-1)
        self.done = np.zeros(self.t.shape, dtype=bool)
        self.going = np.zeros(self.t.shape, dtype=bool)
        self.halted = np.zeros(self.t.shape, dtype=bool)
        self.calls = np.zeros(self.t.shape)
        self.paths: list[tuple[IntegerArray, tuple[Array, Array, Array]]] = []

    def take(self, lanes: IntegerArray, made: Made) -> None:
        """Take over some lanes."""
        run = self.run
        self.m[lanes], self.t[lanes], self.taken[lanes] = made.m.T, made.t, made.taken
        self.going[lanes], self.done[lanes], self.calls[lanes] = made.going, made.done, made.calls
        if made.h is not None:
            self.h[lanes] = made.h
        if made.records:
            run.state.statistics.add_compiled(lanes, made.records, (float(run.span[0]), float(run.span[1])))
        if made.halted is not None:
            self.halted[lanes] = made.halted >= 0
        if made.path is not None and run.keeps:
            self.paths.append((lanes, made.path))
        samples = run.state.samples
        if samples is None:
            return
        done = samples.done.reshape(-1).copy()
        if len(made.outputs):
            points = samples.points.reshape(-1, self.size, len(samples.times))
            here = slice(int(made.outputs[0]), int(made.outputs[-1]) + 1)
            new = made.points.transpose(2, 1, 0)
            valid = (made.outputs < made.until[:, None]) & (made.outputs >= done[lanes, None])
            if len(lanes) == len(points) and bool(valid.all()):
                points[:, :, here] = new
            else:
                points[lanes, :, here] = np.where(valid[:, None], new, points[lanes, :, here])
        done[lanes] = made.until
        samples.done = done.reshape(run.shape)

    def finish(self) -> bool:
        """Write the state; whether kernels have more steps to make."""
        run, now, shape = self.run, self.run.state, self.run.shape
        if self.paths:
            self._record()
        now.m = self.m.reshape(run.start.shape)
        now.t = self.t.reshape(shape)
        now.h = self.h.reshape(shape)
        now.taken = self.taken.reshape(shape)
        done = self.done.reshape(shape)
        if bool(done.any()):
            run.stop(now, done, END)
        if bool(self.halted.any()):
            run.stop(now, self.halted.reshape(shape), EVENT)
        return bool(self.going.any()) or not bool(now.active.any())

    def _record(self) -> None:
        """Append the steps of all lanes to the path of the run."""
        run, shape = self.run, self.run.shape
        most = max(len(path[0]) for _, path in self.paths)
        if len(self.paths) == 1 and len(self.paths[0][0]) == len(self.t):
            times, points, sizes = self.paths[0][1]
            points = np.swapaxes(points, 1, 2)
        else:
            times, sizes = np.zeros((most, len(self.t))), np.zeros((most, len(self.t)))
            points = np.zeros((most, len(self.t), self.size))
            for lanes, path in self.paths:
                count = len(path[0])
                times[:count, lanes], sizes[:count, lanes] = path[0], path[2]
                points[:count, lanes] = np.swapaxes(path[1], 1, 2)
        if most:
            run.state.path.extend(
                times.reshape(most, *shape),
                points.reshape(most, *run.start.shape),
                sizes.reshape(most, *shape),
                (sizes != 0).reshape(most, *shape),
            )


def records_of(kernel: Kernel, row: dict[str, Array]) -> dict[str, tuple[Array, str]]:
    """The totals of the steps, by name."""
    return totals_of(kernel.graph, [row[name] for name in _recorded(kernel.graph)])


def _recorded(graph: StepGraph) -> list[str]:
    """Names of the rows of the largest and the summed numbers."""
    return [f"e{i}" for i in range(len(graph.largest) + len(graph.summed))]


def lowest_numbers(graph: StepGraph) -> dict[str, float]:
    """Initial values of the rows of the largest numbers."""
    return dict.fromkeys(_recorded(graph)[: len(graph.largest)], -np.inf)


def calls_of(kernel: Kernel, row: dict[str, Array], steps: npt.NDArray[Any]) -> Array:
    """Calls of psi in a given number of steps of each lane."""
    graph = kernel.graph
    if graph.calls is not None:
        made: Array = np.multiply(steps, graph.calls, dtype=np.float64)
        return made
    return row[f"e{len(graph.largest) + list(graph.summed).index('calls')}"]


def moved_rows(path: Array, n: int) -> tuple[Array, Array, Array]:
    """Times, points and sizes up to the last row in which a lane moves."""
    some = np.flatnonzero((path[:, n + 1] != 0).any(axis=-1))
    path = path[: int(some[-1]) + 1 if len(some) else 0]
    return path[:, n], path[:, :n], path[:, n + 1]


def times_until(run: Run, t: Array) -> IntegerArray:
    """Number of output times up to t."""
    if run.state.samples is None:
        return np.zeros(t.shape, dtype=int)
    found: IntegerArray = np.searchsorted(run.direction * run.state.samples.times, run.direction * t, side="right")
    return found


def stores_path(run: Run) -> bool:
    """Whether kernels store every step: for the path, or to look for events."""
    return run.keeps or run.stops.events is not None
