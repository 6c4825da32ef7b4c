"""The lanes of a kernel, and the check of initial points."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import reduce
from itertools import pairwise
from operator import and_
from typing import Any, NamedTuple, TypeVar, final

import numpy as np
import numpy.typing as npt

from liehom.base.typing import Array, BooleanArray, IntegerArray, Lanes, Values
from liehom.flow.action.field import check_point
from liehom.flow.action.maps import matrices_of
from liehom.flow.action.space import Action
from liehom.flow.run.options import END, EVENT
from liehom.flow.run.run import Run
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import needed
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import PLACES, Kernel, lanes_per_register

# How many operations a step has, and how many lanes a block of its code should have.

SHORT_OPERATIONS, LONG_OPERATIONS = 200, 1000  # between two loops, up to which and from which on code is short and long
ASSUMED_ITERATIONS = 5  # iterations that a loop in a step is assumed to make, for the number of its operations


def operations(graph: StepGraph) -> int:
    """Approximate number of scalar operations of a step."""
    rows = needed(graph.outputs)
    tables = sum(len(x.value[0].factors) for x in rows if x.op == "table")
    inside = sum(len(x.value.inside) for x in rows if x.op == "loop" and not x.value.guarded)
    return len(rows) + tables + ASSUMED_ITERATIONS * inside


def block_width(graph: StepGraph, lanes: int) -> int:
    """Number of lanes in a block: as many registers for a number as hide latencies and do not run out in long code."""
    one = lanes_per_register()
    if lanes <= one:
        return 1 if lanes == 1 else one
    ops = needed(graph.outputs)
    breaks = sum(x.op == "expv" or (x.op == "loop" and not x.value.guarded) for x in ops)
    registers = 4 if len(ops) < SHORT_OPERATIONS and not breaks else 2
    widest = one if len(ops) >= LONG_OPERATIONS * (1 + breaks) else registers * one
    return min(widest, 1 << (lanes - 1).bit_length())


# A check of initial points in machine code: finite, and on an orbit of the dimension for which the step was traced.

GUARD_RTOL = 1e-10  # a squared length above this fraction of the sum of all is certainly not 0
GUARD_DEFECT = 1e-11  # a length below this fraction of that of the point is round-off
GUARD_PROJECTIONS = 3  # number of random projections, one of which shows the rank


def with_guard(graph: StepGraph, action: Action, dimension: int) -> StepGraph:
    """The graph with a `guard`, which "checks" switches on: a point is finite, its orbit certainly of dimension d."""
    tape: Any = graph.point[0].tape
    m: Any = Traced.inputs(tape, 0, graph.size)
    size: Any = (m * m).sum()
    matrices = matrices_of(action.representation)
    if dimension == graph.size - 1 and np.array_equal(matrices, -np.swapaxes(matrices, 1, 2)):
        # an orbit that is open in a sphere has a ball of one radius around each of its points: it is the sphere
        certain, bounded = size > 0, size < np.inf
    elif tape.least_loop is not None and GUARD_PROJECTIONS * dimension**2 > len(needed(graph.outputs)):
        return graph  # the check would be longer than the step
    else:
        certain, bounded = _has_rank(action, m, size, dimension)
    certain = certain & bounded
    unchecked = Traced(tape, tape.run_constant("checks", 0.0)) == 0
    guard = Traced(tape, unchecked | certain).entry
    return replace(graph, guard=guard, constant_functions=tuple(tape.constant_functions))


def _has_rank(action: Action, m: Lanes, size: Lanes, dimension: int) -> tuple[Lanes, Lanes]:
    """Whether the orbit of a point m with m.m = size is certainly of at least, and at most, dimension d. A map of a
    random R^d to g, followed by the action on the point, is injective; if orbits of larger dimension exist, those of
    several R^(d + 1) are not. Their defect, divided by the smallest length before it, is round-off in all of them, and
    undivided in one of them.
    """
    rng, tape = np.random.default_rng((0, dimension)), m.tape
    generic = check_point(action.representation, rng.normal(size=(4, m.shape[-1])))
    low = dimension < int(generic.max())
    frame: Lanes = action.infinitesimal.right(m)
    certain: Lanes = Traced(tape, tape.false)
    bounded: Lanes = Traced(tape, tape.true)
    small = certain
    for _ in range(GUARD_PROJECTIONS):
        lengths = _orthogonal_lengths(frame @ rng.normal(size=(action.dimension, dimension + low)))
        total = sum(lengths[:dimension])
        certain = certain | reduce(
            and_, [x > GUARD_RTOL * total for x in lengths[:dimension]], total > GUARD_RTOL * size
        )
        if low:
            *longer, defect = lengths
            round_off, total = GUARD_DEFECT**2 * size, sum(longer)
            small = small | (defect <= round_off)
            bounded = bounded & (defect * reduce(np.minimum, longer) <= round_off * total)
    return certain, bounded & small if low else bounded


def _orthogonal_lengths(matrix: Values) -> list[Any]:
    """Squared lengths of the columns of a traced matrix, each less its part in the span of those before it."""
    columns, lengths = [matrix[:, i] for i in range(matrix.shape[1])], list[Any]()
    while columns:
        first, *columns = columns
        lengths.append((first * first).sum())
        columns = [c - first * ((first * c).sum() / lengths[-1]) for c in columns]
    return lengths


# The lanes of a kernel: their state as rows, and what becomes of them in the state of a run.

PATH_BYTES_PER_CALL = 64_000_000  # bytes of points, times and sizes that a kernel call records at most
OPERATIONS_PER_CALL = 4_000_000_000  # summed over lanes; progress, checkpoints and Ctrl-C are handled between calls
MIN_STEPS_PER_CALL = 8  # steps per kernel call at least: the time between two calls is that of some steps
LANE_STEPS_FOR_THREADS = 50_000  # steps of a call, summed over lanes, from which on threads share the blocks
T = TypeVar("T")
Job = TypeVar("Job")
_POOL: dict[int, ThreadPoolExecutor] = {}  # threads that kernels share, by their number
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_POOL.clear)


class LaneSteps(NamedTuple):
    """The steps that a kernel has made of some lanes."""

    m: Array  # (N, L)
    t: Array  # (L,), as all that have no other shape here
    taken: IntegerArray  # numbers of steps
    going: BooleanArray  # which lanes have steps left to be made by the kernel
    done: BooleanArray  # which lanes are at the end
    calls: Array  # of psi
    records: Mapping[str, tuple[Array, str]]  # totals of the diagnostics of the steps, with their kinds
    outputs: IntegerArray  # (k,): indices of output times, which are contiguous
    points: Array  # (k, N, L): at these times, only those are valid that `until` of a lane counts
    until: IntegerArray  # numbers of output times that are reached
    path: tuple[Array, Array, Array] | None  # times (j, L), points (j, N, L), sizes (j, L): 0 if the lane is masked
    h: Array | None = None  # proposed sizes
    halted: IntegerArray | None = None  # the row of `path` in which a terminal event ends the lane, -1 for none


STATE = len(PLACES) + 2  # where the state begins in a memory


@final
class Memory:
    """Memory of a kernel for some lanes: the argument as integers and as floats, two stops, and state and start."""

    def __init__(self, kernel: Kernel, lanes: int, constants: Array) -> None:
        first = kernel.packed(lanes, {"alive": 1.0, **lowest_numbers(kernel.graph)})
        self.first, whole = np.array([first, first]), np.zeros(STATE + 2 * first.size)
        self.block = whole[STATE:].reshape(self.first.shape)
        self.state, self.start = self.block[0], self.block[1, : kernel.graph.size]
        # views of the state, then of the start, as lists of numbers: for a few numbers they are quicker than arrays
        self.cells = self.block.reshape(-1).data.cast("B").cast("d")
        self.fresh = self.first.reshape(-1).data.cast("B").cast("d")
        self.views: dict[str, memoryview[float]] = {}
        self.points: Array = self.block[:, : kernel.graph.size, :lanes].transpose(0, 2, 1)
        self.rows: Array = np.ones((max(1, len(kernel.lane_constants)), self.state.shape[1]))
        argument = whole[: len(PLACES)].view(np.int64)
        argument[:] = kernel.argument(self.state, start=self.start, rows=self.rows, constants=constants)
        self.whole, self.integers = whole.data.cast("B"), argument.data
        self.floats = self.whole.cast("d")
        self.address: int = whole.ctypes.data
        self.arrays: dict[str, Array] = dict.fromkeys(["stops", "out", "path"], np.zeros(0))
        self._use("stops", whole[len(PLACES) : STATE])
        self.room("out", 2, kernel.graph.size, self.state.shape[1])

    def room(self, name: str, rows: int, *shape: int) -> Array:
        """The array of a name, with at least as many rows."""
        if len(self.arrays[name]) < rows:
            self._use(name, np.empty((rows, *shape)))
        return self.arrays[name]

    def _use(self, name: str, array: Array) -> None:
        self.arrays[name], self.views[name] = array, array.reshape(-1).data.cast("B").cast("d")
        self.integers[PLACES[name]] = array.ctypes.data

    def path(self, steps: int, size: int) -> Array:
        """The array of the path, with a row for the initial points before those of the steps."""
        array = self.arrays["path"]
        if len(array) <= steps:
            array = self.room("path", steps + 1, size, self.state.shape[1])
            self.integers[PLACES["path"]] += array[0].nbytes
        return array


def run_blocks(kernel: Kernel, state: Array, fields: Mapping[str, Any], steps: int) -> None:
    """Run a kernel on all blocks of a state, in threads if there is enough to do."""
    blocks = state.shape[1] // kernel.width
    shares = kernel.in_lockstep and state.shape[1] * steps >= LANE_STEPS_FOR_THREADS
    workers = min(cores(), blocks) if shares else 1
    if workers == 1:
        kernel(state, **fields)
        return
    cuts = np.linspace(0, blocks, 4 * workers + 1 if blocks >= 8 * workers else workers + 1).astype(int)
    in_threads(lambda ab: kernel(state, **{**fields, "first": int(ab[0]), "last": int(ab[1])}), list(pairwise(cuts)))


def in_threads(function: Callable[[Job], T], jobs: Sequence[Job]) -> list[T]:
    """The values of a function that machine code makes, in threads."""
    workers = min(cores(), len(jobs))
    if workers <= 1:
        return [function(job) for job in jobs]
    if workers not in _POOL:
        _POOL[workers] = ThreadPoolExecutor(workers, thread_name_prefix="liehom")
    return [job.result() for job in [_POOL[workers].submit(function, job) for job in jobs]]


def cores() -> int:
    """Number of threads that may run at once."""
    number = os.environ.get("LIEHOM_NUM_THREADS")
    if number and number.isdigit() and int(number) > 0:
        return int(number)
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
        self.active = run.state.active.reshape(-1)
        self.done, self.going, self.halted = np.zeros((3, *self.t.shape), dtype=bool)
        self.calls = np.zeros(self.t.shape)
        self.paths: list[tuple[IntegerArray, tuple[Array, Array, Array]]] = []

    def take(self, lanes: IntegerArray, steps: LaneSteps) -> None:
        """Take over some lanes."""
        run = self.run
        self.m[lanes], self.t[lanes], self.taken[lanes] = steps.m.T, steps.t, steps.taken
        self.going[lanes], self.done[lanes], self.calls[lanes] = steps.going, steps.done, steps.calls
        if steps.h is not None:
            self.h[lanes] = steps.h
        if steps.records:
            run.state.statistics.add_compiled(lanes, steps.records, (float(run.span[0]), float(run.span[1])))
        if steps.halted is not None:
            self.halted[lanes] = steps.halted >= 0
        if steps.path is not None and run.keeps:
            self.paths.append((lanes, steps.path))
        samples = run.state.samples
        if samples is None:
            return
        done = samples.done.reshape(-1).copy()
        if len(steps.outputs):
            points = samples.points.reshape(-1, self.size, len(samples.times))
            here = slice(int(steps.outputs[0]), int(steps.outputs[-1]) + 1)
            new = steps.points.transpose(2, 1, 0)
            valid = (steps.outputs < steps.until[:, None]) & (steps.outputs >= done[lanes, None])
            if len(lanes) == len(points) and bool(valid.all()):
                points[:, :, here] = new
            else:
                points[lanes, :, here] = np.where(valid[:, None], new, points[lanes, :, here])
        done[lanes] = steps.until
        samples.done = done.reshape(run.shape)

    def finish(self) -> bool:
        """Write the state; whether kernels have more steps to make."""
        run, now, shape = self.run, self.run.state, self.run.shape
        if self.paths:
            self._record()
        now.m = self.m.reshape(run.start.shape)
        now.t, now.h, now.taken = self.t.reshape(shape), self.h.reshape(shape), self.taken.reshape(shape)
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
        times, sizes = np.zeros((2, most, len(self.t)))
        points = np.zeros((most, len(self.t), self.size))
        for lanes, path in self.paths:
            count = len(path[0])
            times[:count, lanes], sizes[:count, lanes] = path[0], path[2]
            points[:count, lanes] = np.swapaxes(path[1], 1, 2)
        if most:
            run.state.path.extend(
                times.reshape(most, *shape), points.reshape(most, *run.start.shape), sizes.reshape(most, *shape),
                (sizes != 0).reshape(most, *shape),
            )  # fmt: skip


def records_of(kernel: Kernel, row: dict[str, Array]) -> dict[str, tuple[Array, str]]:
    """The totals of the steps but the calls of psi, by name, with their kinds."""
    rows = [(name, row[e], kind) for e, (name, kind) in kernel.graph.recorded.items() if name != "calls"]
    return {name.removeprefix("-"): (-x, "min") if name[0] == "-" else (x, kind) for name, x, kind in rows}


def lowest_numbers(graph: StepGraph) -> dict[str, float]:
    """Initial values of the rows of the largest numbers."""
    return {e: -np.inf for e, (_, kind) in graph.recorded.items() if kind == "max"}


def calls_of(kernel: Kernel, row: dict[str, Array], steps: npt.NDArray[Any]) -> Array:
    """Calls of psi in a given number of steps of each lane."""
    graph = kernel.graph
    rows = {name: row[e] for e, (name, _) in graph.recorded.items()}
    made = rows["calls"] if graph.calls is None else np.multiply(steps, graph.calls, dtype=np.float64)
    return np.asarray(made + rows.get("looks", 0.0))


def moved_rows(path: Array, n: int) -> tuple[Array, Array, Array]:
    """Times, points and sizes up to the last row in which a lane moves."""
    some = np.flatnonzero((path[:, n + 1] != 0).any(axis=-1))
    path = path[: int(some[-1]) + 1 if len(some) else 0]
    return path[:, n], path[:, :n], path[:, n + 1]


def stops_of(times: Array, end: float) -> Array:
    """The times of the stops of a kernel: output times and the end, which is there twice."""
    rest = times[: len(times) - int(len(times) > 0 and times[-1] == end)]
    return np.concatenate([rest, [end, end]]).astype(np.float64)


def times_until(run: Run, t: Array) -> IntegerArray:
    """Number of output times up to t."""
    if run.state.samples is None:
        return np.zeros(t.shape, dtype=int)
    return np.searchsorted(run.direction * run.state.samples.times, run.direction * t, side="right")


def steps_per_call(run: Run, work: int, copies: int = 1) -> int:
    """Steps that a kernel call makes at most, for a number of operations in a step and of copies of the path."""
    lanes = int(np.prod(run.shape, dtype=int))
    steps = max(MIN_STEPS_PER_CALL, OPERATIONS_PER_CALL // (work * lanes))
    if stores_path(run):
        steps = min(steps, max(1, PATH_BYTES_PER_CALL // (8 * copies * lanes * (run.start.shape[-1] + 2))))
    return int(min(run.options.max_steps - 1 - int(np.max(run.state.taken)), steps))


def stores_path(run: Run) -> bool:
    """Whether kernels store every step: for the path, or to look for events."""
    return run.keeps or run.events is not None
