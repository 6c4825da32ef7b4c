"""Calls that are made again: a plan is a compiled call of which the numbers alone are new."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil, inf
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import ConvergenceError, LiehomError
from liehom.base.objects import refuse_masked
from liehom.base.pytrees import check_numbers
from liehom.base.typing import Array, IntegerArray, Pytree
from liehom.flow.action.field import GeneratorField, check_point
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
from liehom.flow.engines.traced_step import arg_values, args_form, args_of_lanes
from liehom.flow.methods.stability import MIN_STEPS
from liehom.flow.run.check import gap_of
from liehom.flow.run.control import SLACK
from liehom.flow.run.options import ATOL, END, MESSAGES, RTOL
from liehom.flow.run.records import EventLog, StepStatistics, bounds_of
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


ABSENT = frozenset(["dt", "first_step", "looks", "checkpoint"])
BOUNDS = frozenset(["rtol", "atol", "max_step", "min_step", "first_step", "max_steps"])
APART = frozenset(["t_eval", "events"])  # options that are not numbers


def numbers_of(options: Mapping[str, Any], shape: tuple[int, ...]) -> Numbers | None:
    """The numbers of a call from points of a shape, None if it needs a closer look."""
    numbers: dict[str, Any] = {}
    for name, value in options.items():
        if name in APART or (value is None and name in ABSENT) or (name == "progress" and value is False):
            continue
        if (name in BOUNDS or name == "dt") and type(value) in KINDS:
            numbers[name] = float(value)
        elif name == "dt":
            numbers[name] = _sizes(value, shape[:-1])
        elif name == "looks" and type(value) is int and value >= 0:
            numbers[name] = value
        elif name == "dense_output" and type(value) is bool:
            numbers["dense"] = value
        else:
            return None
    dt, rtol, atol, most, least, first, steps = (x := Numbers(**numbers))[:7]
    good = rtol >= 0 and atol >= 0 and rtol + atol > 0 and 0 <= least <= most and most > 0 and steps >= 1
    good = good and (first is None or first > 0) and ("dt" not in numbers or (dt is not None and np.max(dt) < inf))
    return x if good else None


def key_of(shape: tuple[int, ...], options: Mapping[str, Any], args: Pytree) -> Hashable:
    """A key that calls share if they differ in points, span, output times and the numbers of args alone."""
    if args is None and APART.isdisjoint(options):
        return (shape, *options.items(), *map(type, options.values()))
    events, form = options.get("events"), None if args is None else args_form(args, len(shape) - 1)
    others = {name: x for name, x in options.items() if name not in APART}
    return key_of(shape, others, None), options.get("t_eval") is None, events_key(events), form


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


def _sizes(value: object, shape: tuple[int, ...]) -> float | Array | None:
    """The step sizes of trajectories, or one size if they agree."""
    sizes = floats("dt", value)
    if sizes is None or not sizes.size or sizes.shape not in ((), shape):
        return None
    largest = float(sizes.max())
    return largest if float(sizes.min()) == largest else sizes


def _are_in_order(times: Array, begin: float, end: float) -> bool:
    """Whether times are increasing, or decreasing, from the begin of a span to its end."""
    if not len(times):
        return False
    first, last = float(times[0]), float(times[-1])
    if not (begin <= first <= last <= end if end > begin else begin >= first >= last >= end):
        return False
    if len(times) <= 2:
        return len(times) == 1 or first != last
    steps = np.diff(times)
    return bool((steps > 0).all() if end > begin else (steps < 0).all())


def form_of(
    shape: tuple[int, ...], numbers: Numbers, t_eval: object, events: object, field: GeneratorField, args: Pytree
) -> Hashable:  # fmt: skip
    """The form of a call: calls of one form have one plan."""
    gap = None if numbers.dt is not None else gap_of(numbers.looks, 1.0, field)
    form = None if args is None else args_form(args, len(shape) - 1)
    kind = 0 if numbers.dt is None else 1 if type(numbers.dt) is float else 2
    looks = gap if gap in (None, inf) else 1.0
    return shape, kind, t_eval is None, numbers.dense, looks, form, events_key(events)


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
LAST_STOP, FIRST_STOP, ORIGIN, END_STEP, TOTAL, STEP_SIZE = (
    PLACES[name] for name in ("last_stop", "first_stop", "origin", "end", "total", "step_size")
)
OF_A_CALL = {
    name: i
    for i, name in enumerate(["checks", "direction", "rest", "end", "rtol", "atol", "max_step", "tiny", "gap", "latest"])
}
"""Places of the numbers of a call among those that a kernel may take, besides args."""
TROUBLE = frozenset(["unkept", "failed", "near", "short", "conservation_short", "conservation_missed"])
"""Numbers of steps that are 0, or -inf, if the steps are as they should be."""


class Piece(NamedTuple):
    """The result of a kernel for some lanes: rows of their path, and numbers of their states."""

    lanes: slice
    path: Array | None  # (j, N + 2, L): points, times and signed sizes, without gaps
    numbers: Array


class Task(NamedTuple):
    """The order that a call gives to a kernel."""

    numbers: Numbers
    points: Array  # (L, N)
    times: Array | None
    span: tuple[float, float]
    values: Mapping[str, Any]  # the numbers in args, by name
    direction: float
    total: int  # number of steps in lockstep
    starts: int  # number of output times at the begin
    keeps: bool  # whether all steps are kept
    y: Array | None  # (L, N, k): points at output times


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
        self.lockstep = graph.reached is None
        recorded = {f"e{i}": name for i, name in enumerate([*graph.largest, *graph.summed])}
        self.trouble = [self.place[e] for e, name in recorded.items() if name in TROUBLE]
        small = self.lanes <= SMALL
        self.kept = [x for x in kernel.names if small or x in recorded or x in ("count", "tries")]
        self.kept_rows: Any = slice(None) if small else [self.place[name] for name in self.kept]
        self.count = self.kept.index("count")
        self.ranked = ranked(self.lanes) if step.uses_isotropy else None
        self.constants: Array = np.zeros(max(1, len(kernel.run_constants)))
        self.slots = memoryview(self.constants)
        self.slot = {name: i for i, name in enumerate(kernel.run_constants)}
        self.own = [(i, OF_A_CALL[name]) for name, i in self.slot.items() if name in OF_A_CALL]
        self.memory = Memory(kernel, self.lanes, self.constants) if small else None
        self.is_judged, self.rows, self.lock = problem.options.dt is not None, ROOM, threading.Lock()
        # rows of a path up to which the lanes are not run in pieces
        row_bytes, row_work = 8 * (self.n + 2) * self.lanes, work * self.lanes
        most = min(LANE_STEPS_FOR_THREADS // self.lanes, OPERATIONS_PER_CALL // row_work, PATH_BYTES_PER_CALL // row_bytes)
        self.short = most if small else 0

    @property
    def is_current(self) -> bool:
        """Whether the event functions are those that were compiled."""
        return self.events is None or not self.events.parts.changed()

    def __call__(
        self, numbers: Numbers, points: Array, begin: float, end: float, times: Array | None, args: Pytree
    ) -> Solution | None:  # fmt: skip
        """The solution, or None if the call needs a closer look."""
        length, rest, dt, total = abs(end - begin), 8 * EPS * max(abs(begin), abs(end)), numbers.dt, 0
        if not 0.0 < length < inf or not (dt is None or rest <= (dt if type(dt) is float else np.min(dt))):
            return None
        if self.lockstep:
            total = max(ceil(length / dt - (SLACK + rest / dt)), 1)  # type: ignore[operator,arg-type]
            if total >= numbers.max_steps:
                return None
        if times is not None and not _are_in_order(times, begin, end):
            return None
        if not self.is_current or not self.lock.acquire(blocking=False):
            return None
        try:
            values = self._take(numbers, begin, end, rest, args)
            keeps = times is None or numbers.dense or self.events is not None
            starts = int(times is not None and float(times[0]) == begin)
            y = None if times is None else np.empty((self.lanes, self.n, len(times)))
            if len(self.shape) != 1:
                points = points.reshape(self.lanes, self.n)
            direction = 1.0 if end > begin else -1.0
            return self._solution(
                Task(numbers, points, times, (begin, end), values, direction, total, starts, keeps, y), args
            )
        finally:
            self.lock.release()

    def _solution(self, task: Task, args: Pytree) -> Solution | None:
        _, points, times, span, values, _, total, starts, keeps, y = task
        if y is not None and starts:
            y[:, :, 0] = points
        rows = total if self.lockstep or not keeps else self.rows
        if rows <= self.short:
            piece = self._made(task, slice(0, self.lanes))
            pieces = [] if piece is None else [piece]
        elif chunk := self._chunk(rows, keeps=keeps):
            cuts = pairwise([*range(0, self.lanes, chunk), self.lanes])
            made = in_threads(lambda lanes: self._made(task, lanes), [slice(a, b) for a, b in cuts])
            pieces = [piece for piece in made if piece is not None] if None not in made else []
        else:
            pieces = []
        if not pieces:
            return None
        numbers = pieces[0].numbers if len(pieces) == 1 else np.concatenate([x.numbers for x in pieces], axis=1)
        if not self.is_judged and (numbers.item(self.count) if self.lanes == 1 else numbers[self.count].max()) >= MIN_STEPS:
            self.is_judged = True  # an ordinary call says whether the field is stiff
            return None
        path, log = _joined(pieces, points, span[0]) if keeps else None, None
        if self.events is not None and path is not None:
            log = self.events(path, {**values, "direction": task.direction}, span)
            if log is None:
                return None
        if y is not None:
            t, y = times.copy(), y  # type: ignore[union-attr]
        else:
            t, y = path[0], path[1]  # type: ignore[index]
        if not self.shape:
            t, y = t if times is not None else t[0], y[0]
        elif len(self.shape) > 1:
            t, y = t if times is not None else t.reshape(*self.shape, -1), y.reshape(*self.shape, *y.shape[1:])
        # what the other entries need is copied: points may change
        kept = points.copy() if self.ranked is not None or (keeps and times is not None) else None
        return solution_of(t, y, END, lambda: self._others(task, args, numbers, path, kept, log))

    def _made(self, task: Task, lanes: slice) -> Piece | None:
        """Run the kernel for some lanes; None if one of them fails."""
        points, y, memory = task.points, task.y, self.memory
        if lanes.stop - lanes.start < self.lanes:
            points, memory = points[lanes], None
        count = len(points)
        if memory is None:  # pieces run in threads
            memory = Memory(self.kernel, count, self.constants)
        for row, number in zip(memory.rows, self.kernel.lane_constants, strict=False):
            row[:count] = task.values[number.name][lanes] if isinstance(number, LaneConstant) else number(points)
        parts = self._run(memory, task, points, lanes)
        state = memory.state
        if parts is None:
            return None
        for i in self.trouble:
            if (state.item(i) if self.lanes == 1 else state[i, :count].max()) > 0:
                return None
        if y is not None and y.shape[2] > task.starts:
            out = memory.arrays["out"]
            y[lanes, :, task.starts :] = out[task.starts : y.shape[2], :, :count].transpose(2, 1, 0)
        numbers = state.copy() if memory is self.memory else state[self.kept_rows, :count]
        return Piece(lanes, self._path(parts, count) if task.keeps else None, numbers)

    def _chunk(self, rows: int, *, keeps: bool) -> int:
        """Number of lanes that are run at once, whole blocks; 0 if even one block is too long for one call."""
        width, most = self.kernel.width, min(self.lanes, CHUNK)
        if self.lanes * max(rows, 1) >= LANE_STEPS_FOR_THREADS:
            most = min(most, max(width, -(-self.lanes // cores())))
        most = min(most, OPERATIONS_PER_CALL // (self.work * max(rows, 1)))
        if keeps:
            most = min(most, PATH_BYTES_PER_CALL // (8 * (self.n + 2) * rows))
        return padded(most, width) if most >= min(width, self.lanes) else 0

    def _take(self, numbers: Numbers, begin: float, end: float, rest: float, args: Pytree) -> Mapping[str, Any]:
        """Take over the numbers of a call as constants of the run; returns those of args by name."""
        dt, rtol, atol, most, least, _, _, looks, _ = numbers
        tiny = rest if dt is not None or rest > least else least
        gap = (gap_of(looks, end - begin, self.problem.field) if "gap" in self.slot else None) or 0.0
        direction, latest = bounds_of((begin, end))
        known = 1.0, direction, rest, end, rtol, atol, most, tiny, gap, latest
        slots = self.slots
        for place, i in self.own:
            slots[place] = known[i]
        if args is None:
            return {}
        check_numbers(args, self.shape)
        values = arg_values(args, len(self.shape))
        for name in values.keys() & self.slot.keys():
            slots[self.slot[name]] = values[name]
        return values

    def _run(self, memory: Memory, task: Task, points: Array, lanes: slice) -> list[Array] | None:
        """Run the kernel for some points from begin to end; the parts of the path, None if a lane fails."""
        numbers, _, times, (begin, end), _, direction, total, starts, keeps, _ = task
        n, count, state, integers, floats = self.n, len(points), memory.state, memory.integers, memory.floats
        width = state.shape[1]
        state[:] = memory.first
        memory.points[:] = points
        if times is not None:
            last = len(times) - int(times[-1] == end)
            stops = memory.room("stops", last + 2)
            stops[:last], stops[last : last + 2] = times[:last], end
            memory.room("out", last + 2, n, width)
            integers[LAST_STOP], integers[FIRST_STOP] = last, starts
        else:
            memory.room("stops", 2)[:2] = end
            memory.room("out", 2, n, width)
            integers[LAST_STOP] = integers[FIRST_STOP] = 0
        floats[ORIGIN] = begin
        size: Any = numbers.dt
        if size is None:
            size = numbers.first_step or numbers.min_step or inf
        else:
            size = direction * (size if type(size) is float else size.reshape(-1)[lanes])
        if self.lockstep:
            state[self.place["count"]] = total
            integers[END_STEP], integers[TOTAL], floats[STEP_SIZE] = total, total, size
        else:
            state[self.place["t"], :count], state[self.place["h"], :count] = begin, size
            if starts:
                for name in {"stop", "kept"} & self.place.keys():
                    state[self.place[name], :count] = starts
        if count < width:
            state[:, count:] = state[:, :1]
        memory.start[:] = memory.top
        if not self.lockstep:
            return self._to_the_end(memory, count, numbers.max_steps, keeps=keeps)
        parts = [memory.room("path", total, n + 2, width)[:total]] if keeps else []
        self.kernel.run(memory.address)
        alive = state[self.place["alive"]]
        return parts if (alive[0] if count == 1 else alive[:count].min()) > 0 else None

    def _to_the_end(self, memory: Memory, count: int, most: float, *, keeps: bool) -> list[Array] | None:
        """Run the kernel until all lanes are at the end, by steps of their own sizes; the parts of the path."""
        parts, width, size, state = list[Array](), memory.state.shape[1], self.n + 1, memory.state
        alive, taken = self.place["alive"], self.place["count"]
        memory.integers[END_STEP] = max(1, OPERATIONS_PER_CALL // (self.work * count))
        while True:
            if keeps:
                path = memory.room("path", self.rows, size + 1, width)
                memory.integers[END_STEP] = len(path)
                path[:, size] = 0.0
            self.kernel.run(memory.address)
            if keeps:
                parts.append(path[path[:, size, :count].any(axis=-1)] if count > 1 else path[path[:, size, 0] != 0])
            if count == 1:
                least, most_left, most_taken = abs(left := state.item(alive * width)), left, state.item(taken * width)
            else:
                lanes = state[alive, :count]
                least, most_left, most_taken = np.abs(lanes).min(), lanes.max(), state[taken, :count].max()
            if least == 0 or most_taken >= most:
                return None
            if most_left < 0:
                return parts
            if keeps:  # the path is full
                memory.arrays["path"], self.rows = np.zeros(0), 2 * self.rows

    def _path(self, parts: list[Array], count: int) -> Array:
        """The path of some lanes, without gaps, from its parts."""
        path = (parts[0] if len(parts) == 1 else np.concatenate(parts))[..., :count]
        if self.lockstep or count == 1:
            return path
        moved = path[:, self.n + 1] != 0
        if not moved.all():
            order = np.argsort(~moved, axis=0, kind="stable")[: int(moved.sum(axis=0).max(initial=0))]
            path, moved = (np.take_along_axis(x, i, axis=0) for x, i in ((path, order[:, None]), (moved, order)))
            path = np.where(moved[:, None], path, np.nan)
        return path

    def _others(
        self, task: Task, args: Pytree, numbers: Array, path: tuple[Array, Array, Array] | None, start: Array | None,
        log: EventLog | None,
    ) -> dict[str, object]:  # fmt: skip
        """The other entries of a solution, which are made when one of them is asked for."""
        p, shape, graph, given = self.problem, self.shape, self.kernel.graph, task.numbers
        bound = p.field if args is None else p.field.with_args(args)
        p = replace(p, bound=bound, span=(np.float64(task.span[0]), np.float64(task.span[1])))
        row = {name: x[: self.lanes] for name, x in zip(self.kept, numbers, strict=True)}
        statistics = StepStatistics(self.step, shape)
        if self.ranked is not None and start is not None:
            note_ranks(statistics, p, self.step, start[self.ranked], self.ranked, shape)
        statistics.add_compiled(np.arange(self.lanes), records_of(self.kernel, row), task.span)
        calls = calls_of(self.kernel, row, row.get("tries", row["count"]))
        calls = calls + int(graph.first is not None and given.dt is None and not (given.first_step or given.min_step))
        steps = row["count"].astype(int)
        check = replace(p.options, looks=given.looks).check(p.field.time_dependent)
        report = statistics.report(
            p.action, p.options.clock, p.orbit_dimension, task.direction, check=check, engine=self.kernel.engine
        )

        def dense() -> DenseSolution:
            t, y, sizes = path  # type: ignore[misc]
            first = y[..., 0] if start is None else start
            psi = Generator(bound, p.orbit_dimension, first.reshape(*shape, self.n))
            begin = np.full(shape, p.span[0])
            step = p.step.prepare(p.action, psi, psi.start, begin)  # type: ignore[arg-type]
            times, points = (np.moveaxis(x.reshape(*shape, *x.shape[1:]), -1, 0) for x in (t, y))
            sizes = np.moveaxis(np.nan_to_num(sizes).reshape(*shape, -1), -1, 0)
            return DenseSolution(p.action, psi, step, times, points, sizes, nominal=p.options.nominal)

        t_events, y_events = (None, None) if log is None else log.lists()
        return {
            "sol": dense() if given.dense else None, "t_events": t_events, "y_events": y_events,
            "nfev": self.prepared + int(calls.max()), "message": MESSAGES[END],
            "n_steps": steps.reshape(shape) if shape else int(steps[0]), "report": report,
            "statuses": np.full(shape, END) if shape else END, "njev": 0, "nlu": 0,
            "_steps": dense if task.times is None or given.dense else None,
        }  # fmt: skip


def _joined(pieces: Sequence[Piece], points: Array, begin: float) -> tuple[Array, Array, Array]:
    """Times (L, j + 1), points (L, N, j + 1) and sizes (L, j) of the paths of all lanes, filled up with NaN."""
    (lanes, n), paths = points.shape, [(x.lanes, x.path) for x in pieces if x.path is not None]
    rows = len(paths[0][1]) if len(paths) == 1 else max(len(path) for _, path in paths)
    whole = np.empty((lanes, n + 2, rows + 1))
    whole[:, :n, 0], whole[:, n, 0] = points, begin
    for here, path in paths:
        count = len(path)
        whole[here, :, 1 : count + 1] = path.transpose(2, 1, 0)
        if count < rows:
            whole[here, :, count + 1 :] = np.nan
    return whole[:, n], whole[:, :n], whole[:, n + 1, 1:]
