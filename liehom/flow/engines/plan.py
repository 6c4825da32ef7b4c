"""Calls that are made again: a plan is a compiled call of which the numbers alone are new."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from math import ceil, inf
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from liehom.base.errors import ConvergenceError, LiehomError
from liehom.base.objects import refuse_masked
from liehom.base.pytrees import Leaf, PerTrajectory
from liehom.base.typing import Array, IntegerArray, Pytree
from liehom.flow.action.field import check_point
from liehom.flow.action.space import Action
from liehom.flow.engines.arguments import with_tight_frame
from liehom.flow.engines.compiled_events import PlannedEvents, events_key
from liehom.flow.engines.engine import Problem
from liehom.flow.engines.lanes import (
    LANE_STEPS_FOR_THREADS,
    OPERATIONS_PER_CALL,
    PATH_BYTES_PER_CALL,
    Memory,
    calls_of,
    cores,
    in_threads,
    records_of,
)
from liehom.flow.engines.traced_step import arg_values, args_of_lanes, numbers_in
from liehom.flow.methods.stability import MIN_STEPS
from liehom.flow.run.check import gap_of
from liehom.flow.run.control import SLACK
from liehom.flow.run.options import ATOL, END, MESSAGES, RTOL
from liehom.flow.run.records import EventLog, StepStatistics
from liehom.flow.run.solution import DenseSolution, Solution, solution_of
from liehom.flow.steps.step import Generator, Step
from liehom.flow.tracing.graph import LaneConstant
from liehom.flow.tracing.machine import PLACES, Kernel, padded

# The numbers of a call, as numbers of Python and arrays of floats. Lists, tuples, integers and numbers of numpy are the
# same call. Whatever is unusual, or not right, has no such form: `Propagator` looks at it closely.

KINDS = frozenset([float, int, np.float64, np.float32, np.int64, np.int32])
EPS = float(np.finfo(np.float64).eps)
FLOAT = np.dtype(np.float64)


class Numbers(NamedTuple):
    """The numbers among the options of a call."""

    dt: float | Array | None = None  # an array of different sizes (...,)
    rtol: float = RTOL
    atol: float = ATOL
    max_step: float = inf
    min_step: float = 0.0
    first_step: float | None = None
    max_steps: float = inf
    looks: int | None = None
    dense: bool = False
    shape: tuple[int, ...] = ()  # of dt
    form: Hashable = None  # which calls of a form have in common


BOUNDS = frozenset(["dt", "rtol", "atol", "max_step", "min_step", "first_step", "max_steps"])
ABSENT = frozenset(["dt", "first_step", "looks", "checkpoint", "t_eval", "events"])


@lru_cache(maxsize=256, typed=True)
def numbers_of(**options: object) -> Numbers | None:
    """The numbers of a call, None if it needs a closer look."""
    numbers: dict[str, Any] = {}
    for name, value in options.items():
        if name in BOUNDS and type(value) in KINDS:
            numbers[name] = float(value)  # type: ignore[arg-type]
        elif name == "dt" and value is not None:
            sizes = floats("dt", value)
            if sizes is None or not sizes.size:
                return None
            numbers["shape"], dt = sizes.shape, float(sizes.flat[0])
            numbers[name] = dt if bool((sizes == dt).all()) else sizes
        elif name == "looks" and type(value) is int and value >= 0:
            numbers[name] = value
        elif name == "dense_output" and type(value) is bool:
            numbers["dense"] = value
        elif (value is not None or name not in ABSENT) and (name != "progress" or value is not False):
            return None
    x = Numbers(**numbers)
    good = x.rtol >= 0 and x.atol >= 0 and x.rtol + x.atol > 0 and 0 <= x.min_step <= x.max_step and x.max_step > 0
    good = good and x.max_steps >= 1 and (x.first_step is None or x.first_step > 0)
    if not good or (x.dt is not None and not 0 < np.min(x.dt) <= np.max(x.dt) < inf):
        return None
    return x._replace(form=(type(x.dt) if x.dt is not None else x.looks and 1, x.dense))


def floats(what: str, given: object) -> Array | None:
    """An array of floats from an array, or from lists, of floats or integers."""
    value: Any = given
    if type(given) is list or type(given) is tuple:
        if not KINDS.issuperset(map(type, given)):
            refuse_masked(what, given)
        value = np.array(given)
    elif type(given) is not np.ndarray:
        return None
    if value.dtype is FLOAT or value.dtype == FLOAT:
        return value
    return value.astype(np.float64) if value.dtype.kind in "iu" else None


def _are_in_order(times: Array, begin: float, end: float) -> bool:
    """Whether times are increasing, or decreasing, from the begin of a span to its end."""
    if not len(times):
        return False
    first, last = float(times[0]), float(times[-1])
    if not (begin <= first <= last <= end if end > begin else begin >= first >= last >= end):
        return False
    return len(times) == 1 or bool((np.diff(times) * (1 if end > begin else -1) > 0).all())


def form_of(
    shape: tuple[int, ...], numbers: Numbers, t_eval: object, events: object, args: Sequence[Leaf] | None
) -> Hashable:  # fmt: skip
    """The form of a call, with the leaves of its args: calls of one form have one plan."""
    form = None if args is None else tuple([_form_of_leaf(*leaf) for leaf in args])
    return shape, numbers.form, t_eval is None, form, None if events is None else events_key(events)


def _form_of_leaf(path: str, x: object) -> Hashable:
    """The place, the type and the shape of a leaf; a number is not of the type of anything that is refused."""
    inner = x.value if isinstance(x, PerTrajectory) else x
    return path, type(x), type(inner), getattr(inner, "dtype", None), getattr(inner, "shape", None)


def serves_all_points(problem: Problem, step: Step, dimension: int) -> bool:
    """Whether the trace of a prepared step is that for all points on orbits of a dimension: at generic ones it is."""
    points = np.random.default_rng((1, dimension)).normal(size=(4, np.shape(problem.start)[-1]))
    if dimension < int(check_point(problem.action.representation, points).max()):
        # no point is generic there; the numbers of a landing are NaN at points that it does not serve
        points = np.asarray(problem.start).reshape(-1, points.shape[-1])[:4]
    psi = Generator(problem.bound, dimension, points)
    if problem.args is not None and problem.step.prepares_by_psi:
        return False
    try:
        action = with_tight_frame(problem.action, problem.step, points, dimension)
        other = problem.step.prepare(action, psi, points, np.full(len(points), float(problem.span[0])))
    except (LiehomError, np.linalg.LinAlgError):
        return False
    return other.trace_key == step.trace_key and frame_key(action) == frame_key(problem.action)


def frame_key(action: Action) -> Hashable:
    """The part of the tight frame of an action that a trace depends on."""
    tight = action.tight_frame
    return None if tight is None else (tight.symmetric, round(float(tight.isotropy), 9))


def note_ranks(
    statistics: StepStatistics, problem: Problem, step: Step, points: Array, lanes: IntegerArray, shape: tuple[int, ...]
) -> None:
    """Record the ranks of the range condition at some initial points (L, N); compiled steps know of none."""
    times = np.full(len(lanes), float(problem.span[0]))
    dimensions = np.broadcast_to(np.asarray(problem.orbit_dimension), shape).reshape(-1)
    args = problem.bound.args
    field = problem.bound if args is None else problem.bound.with_args(args_of_lanes(args, shape, lanes))
    psi = Generator(field, dimensions[lanes], points)
    with contextlib.suppress(np.linalg.LinAlgError, ConvergenceError):  # the first step will end with it
        local = step.prepare(problem.action, psi, points, times).at(problem.action, psi, points, times[:, None])
        statistics.take_lowest(local.diagnostics(np.zeros((len(lanes), 1))), lanes, times, points)


RANKED = 64  # number of initial points, at most, at which the rank of the range condition is found


def ranked(count: int) -> IntegerArray:
    """The trajectories at whose initial points ranks are found."""
    return np.unique(np.linspace(0, count - 1, min(count, RANKED)).astype(int))


# Plan. The machine code checks what `Propagator` would check of the points: that they are finite and that their orbits
# have the largest dimension. A call whose lanes do not all come to the end, or whose steps have something to say, is
# made again in the ordinary way.

CHUNK = 16_384  # number of lanes, at most, that are copied in, run, and copied out at once
SMALL = 64  # number of lanes up to which memory is kept from call to call
ROOM = 64  # rows of the path, at first, of steps whose number is not known
LAST_STOP, FIRST_STOP, ORIGIN, BEGIN, END_STEP, TOTAL, STEP_SIZE = (
    PLACES[name] for name in ("last_stop", "first_stop", "origin", "begin", "end", "total", "step_size")
)
OF_A_CALL = ("checks", "direction", "rest", "end", "rtol", "atol", "max_step", "tiny", "gap", "latest")
"""The numbers of a call that a kernel may take, besides args."""
TROUBLE = frozenset(["unkept", "failed", "near", "short", "conservation_short", "conservation_missed"])
"""Numbers of steps that are 0, or -inf, if the steps are as they should be."""


Piece: TypeAlias = tuple[slice, Array | None, Array]
"""Lanes, the rows (j + 1, N + 2, L) of their path, which are points, times and signed sizes, and numbers of states."""

Task: TypeAlias = tuple[Numbers, Array, Array | None, tuple[float, float], Mapping[str, Any], int, Array | None, bool]
"""Numbers of a call, points (L, N), output times, ends of the span, numbers of args and the direction by name, number
of steps in lockstep, points (L, N, k) at output times, and whether all steps are kept."""


@final
class Plan:
    """A compiled call of one form: points, span, sizes, tolerances, output times and args are those of each call."""

    def __init__(
        self, kernel: Kernel, problem: Problem, step: Step, work: int, calls: int, events: PlannedEvents | None
    ) -> None:  # fmt: skip
        self.events = events
        shape, graph = np.shape(problem.start), kernel.graph
        self.kernel, self.problem, self.step, self.work, self.prepared = kernel, problem, step, work, calls
        self.shape, self.n, self.lanes = shape[:-1], shape[-1], int(np.prod(shape[:-1], dtype=int))
        self.place = {name: i for i, name in enumerate(kernel.names)}
        self.alive, self.taken, self.time, self.size = (self.place.get(x, 0) for x in ("alive", "count", "t", "h"))
        self.lockstep = graph.reached is None
        recorded = {f"e{i}": name for i, name in enumerate([*graph.largest, *graph.summed])}
        self.trouble = [self.place[e] for e, name in recorded.items() if name in TROUBLE]
        small = self.lanes <= SMALL
        self.kept = [x for x in kernel.names if small or x in recorded or x in ("count", "tries")]
        self.kept_rows: Any = slice(None) if small else [self.place[name] for name in self.kept]
        self.count = self.kept.index("count")
        self.ranked = ranked(self.lanes) if step.uses_isotropy else None
        self.constants: Array = np.zeros(max(1, len(kernel.run_constants)))
        self.slots = self.constants.data.cast("B").cast("d")
        self.slot = {name: i for i, name in enumerate(kernel.run_constants)}
        self.own = [(i, OF_A_CALL.index(name)) for name, i in self.slot.items() if name in OF_A_CALL]
        names = () if problem.args is None else arg_values(problem.args, len(self.shape))
        self.names = [(name, self.slot.get(name)) for name in names]
        self.memory = Memory(kernel, self.lanes, self.constants) if small else None
        self.begin = len(kernel.names)
        self.is_alone = not shape[:-1] and kernel.width == 1 and not kernel.lane_constants
        self.is_judged, self.rows, self.lock = problem.options.dt is not None, ROOM, threading.Lock()
        # rows of a path up to which there is one piece
        row = max(8 * (self.n + 2) / PATH_BYTES_PER_CALL, work / OPERATIONS_PER_CALL, 1 / LANE_STEPS_FOR_THREADS)
        self.short = int(1 / (row * self.lanes))

    @property
    def is_current(self) -> bool:
        """Whether the event functions are those that were compiled."""
        return self.events is None or not self.events.parts.changed()

    def __call__(
        self, numbers: Numbers, points: Array, begin: float, end: float, times: Array | None,
        args: Pytree, found: Sequence[Leaf] | None,
    ) -> Solution | None:  # fmt: skip
        """The solution, or None if the call needs a closer look."""
        length, rest, dt, total = abs(end - begin), 8 * EPS * max(abs(begin), abs(end)), numbers.dt, 0
        if not 0.0 < length < inf or (dt is not None and rest > (dt if type(dt) is float else np.min(dt))):
            return None
        if (numbers.shape and numbers.shape != self.shape) or not (self.events is None or self.is_current):
            return None
        if self.lockstep:
            total = max(ceil(length / dt - (SLACK + rest / dt)), 1)  # type: ignore[operator]
            if total >= numbers.max_steps:
                return None
        if (times is not None and not _are_in_order(times, begin, end)) or not self.lock.acquire(blocking=False):
            return None
        try:
            values = self._take(numbers, begin, end, rest, found)
            if times is None and self.is_alone and (total or self.rows) <= self.short:
                known = self._alone(numbers, points, (begin, end), values, total, args)
                if known is not None:
                    return known
            points = points if len(self.shape) == 1 else points.reshape(self.lanes, self.n)
            y = None if times is None else np.empty((self.lanes, self.n, len(times)))
            keeps = y is None or numbers.dense or self.events is not None
            return self._solution((numbers, points, times, (begin, end), values, total, y, keeps), args)
        finally:
            self.lock.release()

    def _solution(self, task: Task, args: Pytree) -> Solution | None:
        _, points, times, span, values, total, y, keeps = task
        rows = total if self.lockstep or not keeps else self.rows
        path: Any
        if self.memory is not None and rows <= self.short:
            piece = self._made(task, slice(0, self.lanes), self.memory)
            if piece is None:
                return None
            _, path, numbers = piece
        else:
            chunk = self._chunk(rows, keeps=keeps)
            cuts = pairwise([*range(0, self.lanes, chunk), self.lanes] if chunk else [])
            made = in_threads(lambda lanes: self._made(task, lanes), [slice(a, b) for a, b in cuts])
            pieces = [piece for piece in made if piece is not None]
            if not pieces or len(pieces) < len(made):
                return None
            path = _joined(pieces, self.lanes) if keeps else None
            numbers = np.concatenate([x[2] for x in pieces], axis=1)
        if not self.is_judged and numbers[self.count].max() >= MIN_STEPS:
            self.is_judged = True  # an ordinary call says whether the field is stiff
            return None
        n, shape, log = self.n, self.shape, None
        if path is not None and self.events is not None and (log := self.events(path, values, span)) is None:
            return None
        t: Any
        if y is not None:
            t, result = times.copy(), y.reshape(*shape, *y.shape[1:])  # type: ignore[union-attr]
        elif shape:
            t, result = path[:, n].T.reshape(*shape, -1), path[:, :n].transpose(2, 1, 0).reshape(*shape, n, -1)
        else:
            t, result = path[:, n, 0], path[:, :n, 0].T
        # what the other entries need is copied: points may change
        start = None if self.ranked is None else points.copy()
        return solution_of(t, result, END, lambda: self._others(task, args, numbers, path, start, log))

    def _alone(
        self, numbers: Numbers, points: Array, span: tuple[float, float], values: Mapping[str, Any], total: int,
        args: Pytree,
    ) -> Solution | None:  # fmt: skip
        """The solution of one trajectory with its path, of few numbers; None if the call takes more than one run."""
        memory: Any = self.memory
        cells, integers, n, size, stops = memory.cells, memory.integers, self.n, numbers.dt, memory.views["stops"]
        cells[:], m = memory.fresh, points.data
        cells[:n] = cells[self.begin : self.begin + n] = m
        stops[0] = stops[1] = span[1]
        integers[LAST_STOP] = integers[FIRST_STOP] = integers[BEGIN] = 0
        size = values["direction"] * size if size is not None else numbers.first_step or numbers.min_step or inf
        path = memory.path(total or self.rows, n + 2)
        first = memory.views["path"]
        first[:n], first[n], memory.floats[ORIGIN], memory.floats[STEP_SIZE] = m, span[0], span[0], size
        integers[END_STEP], integers[TOTAL] = total or len(path) - 1, total
        if not total:
            cells[self.time], cells[self.size] = span[0], size
        self.kernel.run(memory.address)
        left, count = cells[self.alive], int(cells[self.taken])
        rows = total if total else integers[BEGIN]
        good = left > 0 if total else left < 0 and rows == count < numbers.max_steps
        if not good or (not self.is_judged and count >= MIN_STEPS):
            return None
        for i in self.trouble:
            if cells[i] > 0:
                return None
        if total:
            cells[self.taken] = total
        path, state, log = path[: rows + 1].copy(), cells.tobytes(), None
        if self.events is not None and (log := self.events(path, values, span)) is None:
            return None
        start = None if self.ranked is None else np.array([points])
        task: Task = numbers, points, None, span, values, total, None, True
        t, y = path[:, n, 0], path[:, :n, 0].T

        def others() -> dict[str, object]:
            return self._others(task, args, np.frombuffer(state, count=self.begin)[:, None], path, start, log)

        return solution_of(t, y, END, others)

    def _made(self, task: Task, lanes: slice, memory: Memory | None = None) -> Piece | None:
        """Run the kernel for some lanes from begin to end; None if one of them fails."""
        numbers, points, times, (begin, end), values, total, y, keeps = task
        if memory is None:  # pieces run in threads
            points = points[lanes]
            memory = Memory(self.kernel, len(points), self.constants)
        count, n, state, integers, cells = len(points), self.n, memory.state, memory.integers, memory.cells
        width, starts, last = state.shape[1], 0, 0
        for row, number in zip(memory.rows, self.kernel.lane_constants, strict=False):
            row[:count] = values[number.name][lanes] if isinstance(number, LaneConstant) else number(points)
        memory.block[:] = memory.first
        memory.points[:] = points
        if times is not None:
            starts, last = int(times[0] == begin), len(times) - int(times[-1] == end)
            memory.room("out", last + 2, n, width)[:starts] = state[:n]
            memory.room("stops", last + 2)[:last] = times[:last]
        memory.arrays["stops"][last : last + 2] = end
        integers[LAST_STOP], integers[FIRST_STOP], memory.floats[ORIGIN] = last, starts, begin
        size: Any = numbers.dt
        if size is None:
            size = numbers.first_step or numbers.min_step or inf
        else:
            size = values["direction"] * (size if type(size) is float else size.reshape(-1)[lanes])
        if self.lockstep:
            integers[END_STEP] = integers[TOTAL] = total
            memory.floats[STEP_SIZE] = size
        elif width == 1 and not starts:
            cells[self.time], cells[self.size] = begin, size
        else:
            for name, x in (("t", begin), ("h", size), ("stop", starts), ("kept", starts)):
                if name in self.place:
                    state[self.place[name], :count] = x
        if count < width:
            memory.block[:, :, count:] = memory.block[:, :, :1]
        if not self.lockstep:
            path = self._to_the_end(memory, count, task)
        else:
            path = memory.path(total, n + 2) if keeps else state
            if keeps:
                path[0, :n], path[0, n] = state[:n], begin
                path = path[: total + 1] if count == width else path[: total + 1, :, :count]
            self.kernel.run(memory.address)
            alive = cells[self.alive] if width == 1 else state[self.alive, :count].min()
            if alive <= 0:
                return None
            if cells[self.taken * width] != total:  # which is not counted
                state[self.taken] = total
        if path is None:
            return None
        for i in self.trouble:
            if (cells[i] if width == 1 else state[i, :count].max()) > 0:
                return None
        if y is not None:
            y[lanes] = memory.arrays["out"][: y.shape[2], :, :count].transpose(2, 1, 0)
        if memory is self.memory:
            return lanes, path.copy() if keeps else None, state.copy()
        return lanes, path if keeps else None, state[self.kept_rows, :count]

    def _chunk(self, rows: int, *, keeps: bool) -> int:
        """Number of lanes that are run at once, whole blocks; 0 if even one block is too long for one call."""
        width, most = self.kernel.width, min(self.lanes, CHUNK)
        if self.lanes * max(rows, 1) >= LANE_STEPS_FOR_THREADS:
            most = min(most, max(width, -(-self.lanes // cores())))
        most = min(most, OPERATIONS_PER_CALL // (self.work * max(rows, 1)))
        if keeps:
            most = min(most, PATH_BYTES_PER_CALL // (8 * (self.n + 2) * rows))
        return padded(most, width) if most >= min(width, self.lanes) else 0

    def _take(
        self, numbers: Numbers, begin: float, end: float, rest: float, found: Sequence[Leaf] | None
    ) -> Mapping[str, Any]:
        """Take over the numbers of a call as constants of the run; returns the direction and those of args by name."""
        dt, rtol, atol, most, least, _, _, looks, *_ = numbers
        tiny = rest if dt is not None or rest > least else least
        gap = (gap_of(looks, end - begin, self.problem.field) if "gap" in self.slot else None) or 0.0
        direction, latest = 1.0 if end >= begin else -1.0, abs(begin) + abs(end) + 1.0  # see bounds_of
        known: Any = 1.0, direction, rest, end, rtol, atol, most, tiny, gap, latest
        slots = self.slots
        for place, i in self.own:
            slots[place] = known[i]
        values: dict[str, Any] = {"direction": direction}
        if found is None:
            return values
        for (name, slot), number in zip(self.names, numbers_in(found, len(self.shape)), strict=True):
            values[name] = number
            if slot is not None:
                slots[slot] = number
        return values

    def _to_the_end(self, memory: Memory, count: int, task: Task) -> Array | None:
        """Run the kernel until all lanes are at the end, by steps of their own sizes; the path."""
        parts, size, n, state, integers = list[Array](), self.n + 1, self.n, memory.state, memory.integers
        keeps, most_steps, one = task[7], task[0].max_steps, state.shape[1] == 1
        integers[END_STEP] = max(1, OPERATIONS_PER_CALL // (self.work * count))
        while True:
            if keeps:
                path = memory.path(self.rows, n + 2)
                path[0, :n], path[0, n], integers[END_STEP] = state[:n], task[3][0], len(path) - 1
                if not one:
                    path[1:, size] = 0.0
            integers[BEGIN] = 0
            self.kernel.run(memory.address)
            if one:
                least, most_left, most = abs(left := memory.cells[self.alive]), left, memory.cells[self.taken]
            else:
                lanes = state[self.alive, :count]
                least, most_left, most = np.abs(lanes).min(), lanes.max(), state[self.taken, :count].max()
            if least == 0 or most >= most_steps:
                return None
            if keeps:
                part = path[: integers[BEGIN] + 1] if one else path
                if not one or len(part) != most + 1:  # some rows are not steps
                    part[0, size] = not parts
                    part = part[part[:, size, 0] != 0 if one else part[:, size, :count].any(axis=-1)]
                parts.append(part)
            if most_left < 0:
                break
            if keeps:  # the path is full
                memory.arrays["path"], self.rows = np.zeros(0), 2 * self.rows
        path = state if not keeps else parts[0] if len(parts) == 1 else np.concatenate(parts)
        if one or not keeps:
            return path
        path = path[..., :count]
        moved = path[:, size] != 0
        if moved.all():
            return path
        order = np.argsort(~moved, axis=0, kind="stable")[: int(moved.sum(axis=0).max(initial=0))]
        path, moved = (np.take_along_axis(x, i, axis=0) for x, i in ((path, order[:, None]), (moved, order)))
        return np.where(moved[:, None], path, np.nan)

    def _others(
        self, task: Task, args: Pytree, numbers: Array, path: Array | None, start: Array | None,
        log: EventLog | None,
    ) -> dict[str, object]:  # fmt: skip
        """The other entries of a solution, which are made when one of them is asked for."""
        p, shape, graph, given = self.problem, self.shape, self.kernel.graph, task[0]
        bound = p.field if args is None else p.field.with_args(args)
        p = replace(p, bound=bound, span=(np.float64(task[3][0]), np.float64(task[3][1])))
        row = {name: x[: self.lanes] for name, x in zip(self.kept, numbers, strict=True)}
        statistics = StepStatistics(self.step, shape)
        if self.ranked is not None and start is not None:
            note_ranks(statistics, p, self.step, start[self.ranked], self.ranked, shape)
        statistics.add_compiled(np.arange(self.lanes), records_of(self.kernel, row), task[3])
        calls = calls_of(self.kernel, row, row.get("tries", row["count"]))
        calls = calls + int(graph.first is not None and given.dt is None and not (given.first_step or given.min_step))
        steps = row["count"].astype(int)
        check = replace(p.options, looks=given.looks).check(p.field.time_dependent)
        how: dict[str, Any] = {"check": check, "engine": self.kernel.engine}
        report = statistics.report(p.action, p.options.clock, p.orbit_dimension, task[4]["direction"], **how)

        def dense() -> DenseSolution:
            steps = path.swapaxes(1, 2).reshape(-1, *shape, self.n + 2)  # type: ignore[union-attr]
            times, points, sizes = steps[..., self.n], steps[..., : self.n], np.nan_to_num(steps[1:, ..., self.n + 1])
            psi = Generator(bound, p.orbit_dimension, points[0])
            step = p.step.prepare(p.action, psi, psi.start, np.full(shape, p.span[0]))  # type: ignore[arg-type]
            return DenseSolution(p.action, psi, step, times, points, sizes, nominal=p.options.nominal)

        t_events, y_events = (None, None) if log is None else log.lists()
        return {
            "sol": dense() if given.dense else None, "t_events": t_events, "y_events": y_events,
            "nfev": self.prepared + int(calls.max()), "message": MESSAGES[END],
            "n_steps": steps.reshape(shape) if shape else int(steps[0]), "report": report,
            "statuses": np.full(shape, END) if shape else END, "njev": 0, "nlu": 0,
            "_steps": dense if task[2] is None or given.dense else None,
        }  # fmt: skip


def _joined(pieces: Sequence[Piece], lanes: int) -> Array:
    """The path of all lanes, filled up with NaN."""
    paths = [(here, path) for here, path, _ in pieces if path is not None]
    whole = np.full((max(len(path) for _, path in paths), paths[0][1].shape[1], lanes), np.nan)
    for here, path in paths:
        whole[: len(path), :, here] = path
    return whole
