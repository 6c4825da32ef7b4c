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


class Call(NamedTuple):
    """The numbers of a call."""

    points: Array  # (..., N)
    begin: float
    end: float
    dt: float | Array | None = None  # an array of different sizes (...,)
    times: Array | None = None
    dense: bool = False
    rtol: float = RTOL
    atol: float = ATOL
    max_step: float = inf
    min_step: float = 0.0
    first_step: float | None = None
    max_steps: float = inf
    looks: int | None = None
    events: Any = None


ABSENT = frozenset(["dt", "t_eval", "events", "checkpoint", "first_step"])
NUMBERS = frozenset(["rtol", "atol", "max_step", "min_step", "first_step", "max_steps"])


def call_of(t_span: object, y0: object, options: Mapping[str, Any]) -> Call | None:
    """The numbers of a call, None if it needs a closer look."""
    first, last = t_span  # type: ignore[misc]
    if type(first) not in KINDS or type(last) not in KINDS:  # type: ignore[has-type]
        return None
    begin, end = float(first), float(last)  # type: ignore[has-type]
    points = _floats("the start", y0)
    if points is None or not 0.0 < abs(end - begin) < inf:
        return None
    numbers: dict[str, Any] = {}
    for name, value in options.items():
        if name in NUMBERS and type(value) in KINDS:
            numbers[name] = float(value)
        elif name == "dt" and type(value) in KINDS:
            numbers[name] = dt = float(value)
            if not 8 * EPS * max(abs(begin), abs(end)) <= dt < inf:
                return None
        elif name == "dt" and value is not None:
            numbers[name] = sizes = _sizes(value, points.shape[:-1])
            if sizes is None or not 8 * EPS * max(abs(begin), abs(end)) <= np.min(sizes) <= np.max(sizes) < inf:
                return None
        elif name == "t_eval" and value is not None:
            numbers["times"] = times = _floats("t_eval", value)
            if times is None or times.ndim != 1 or not _are_in_order(times, begin, end):
                return None
        elif name == "looks" and (value is None or (type(value) is int and value >= 0)):
            numbers[name] = value
        elif name == "dense_output" and type(value) is bool:
            numbers["dense"] = value
        elif name == "events" and value is not None:
            numbers[name] = value
        elif (value is not None or name not in ABSENT) and (name != "progress" or value is not False):
            return None
    call = Call(points, begin, end, **numbers)
    if not NUMBERS.isdisjoint(numbers):
        rtol, atol, most, least, first, steps = call[6:12]
        good = rtol >= 0 and atol >= 0 and rtol + atol > 0 and 0 <= least <= most and most > 0 and steps >= 1
        return call if good and (first is None or first > 0) else None
    return call


def _floats(what: str, given: object) -> Array | None:
    """An array of floats from an array, or from lists, of floats or integers."""
    value: Any = given
    if type(given) is list or type(given) is tuple:
        refuse_masked(what, given)
        value = np.array(given)
    elif type(given) is not np.ndarray:
        return None
    if value.dtype == np.float64:
        return value
    return value.astype(np.float64) if value.dtype.kind in "iu" else None


def _sizes(value: object, shape: tuple[int, ...]) -> float | Array | None:
    """The step sizes of trajectories, or one size if they agree."""
    sizes = _floats("dt", value)
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


def form_of(call: Call, field: GeneratorField, args: Pytree) -> Hashable:
    """The form of a call: calls of one form have one plan."""
    gap = None if call.dt is not None else gap_of(call.looks, 1.0, field)
    form = None if args is None else args_form(args, call.points.ndim - 1)
    kind = 0 if call.dt is None else 1 if type(call.dt) is float else 2
    events = None if call.events is None else events_key(call.events)
    return call.points.shape, kind, call.times is None, call.dense, gap if gap in (None, inf) else 1.0, form, events


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
TROUBLE = frozenset(["unkept", "failed", "near", "short", "conservation_short", "conservation_missed"])
"""Numbers of steps that are 0, or -inf, if the steps are as they should be."""


class Piece(NamedTuple):
    """The result of a kernel for some lanes: rows of their path, and numbers of their states."""

    lanes: slice
    path: Array | None  # (j, N + 2, L): points, times and signed sizes, without gaps
    numbers: Array


class Task(NamedTuple):
    """The order that a call gives to a kernel."""

    call: Call
    points: Array  # (L, N)
    values: Mapping[str, Any]  # the constants of the run, by name
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
        self.ranked = ranked(self.lanes) if step.uses_isotropy else np.zeros(0, dtype=int)
        self.given = [(name, i) for name, i in self.place.items() if name in ("t", "stop", "kept", "h")]
        self.constants: Array = np.zeros(max(1, len(kernel.run_constants)))
        self.memory = Memory(kernel, self.lanes, self.constants) if small else None
        self.is_judged, self.rows, self.lock = problem.options.dt is not None, ROOM, threading.Lock()

    @property
    def is_current(self) -> bool:
        """Whether the event functions are those that were compiled."""
        return self.events is None or not self.events.parts.changed()

    def __call__(self, call: Call, args: Pytree = None) -> Solution | None:
        """The solution, or None if the call needs a closer look."""
        if not self.lock.acquire(blocking=False):
            return None
        try:
            return self._solution(call, args)
        finally:
            self.lock.release()

    def _solution(self, call: Call, args: Pytree) -> Solution | None:
        times, begin, end = call.times, call.begin, call.end
        points, direction = call.points.reshape(self.lanes, self.n), 1.0 if end > begin else -1.0
        rest, total = 8 * EPS * max(abs(begin), abs(end)), 0
        if self.lockstep:
            dt: Any = call.dt
            total = max(ceil(abs(end - begin) / dt - (SLACK + rest / dt)), 1)
            if total >= call.max_steps:
                return None
        if not self.is_current:
            return None
        keeps = times is None or call.dense or self.events is not None
        starts = int(times is not None and float(times[0]) == begin)
        chunk = self._chunk(total if self.lockstep or not keeps else self.rows, keeps=keeps)
        if chunk < 1:
            return None
        y = None if times is None else np.empty((self.lanes, self.n, len(times)))
        if y is not None and starts:
            y[:, :, 0] = points
        task = Task(call, points, self._take(call, args, direction, rest), direction, total, starts, keeps, y)
        if chunk >= self.lanes:
            pieces = [self._made(task, slice(0, self.lanes))]
        else:
            cuts = pairwise([*range(0, self.lanes, chunk), self.lanes])
            pieces = in_threads(lambda lanes: self._made(task, lanes), [slice(a, b) for a, b in cuts])
        good = [piece for piece in pieces if piece is not None]
        if len(good) < len(pieces):
            return None
        numbers = good[0].numbers if len(good) == 1 else np.concatenate([x.numbers for x in good], axis=1)
        if not self.is_judged and numbers[self.count].max() >= MIN_STEPS:
            self.is_judged = True  # an ordinary call says whether the field is stiff
            return None
        path, log = _joined(good, points, begin) if keeps else None, None
        if self.events is not None and path is not None:
            log = self.events(path, task.values, (begin, end))
            if log is None:
                return None
        t: Any = times
        result: Any = y
        if path is not None and y is None:
            t, result, _ = path
        t = t.copy() if times is not None else t[0] if not self.shape else t.reshape(*self.shape, t.shape[-1])
        result = result[0] if not self.shape else result.reshape(*self.shape, self.n, result.shape[-1])
        # what the other entries need is copied: points may change
        first = points[self.ranked] if len(self.ranked) else points[:0]
        start = np.array(points) if keeps and y is not None else None
        return solution_of(t, result, END, lambda: self._others(call, args, numbers, path, (first, start), log))

    def _made(self, task: Task, lanes: slice) -> Piece | None:
        """Run the kernel for some lanes; None if one of them fails."""
        points, y = task.points[lanes], task.y
        count, memory = len(points), self.memory
        if memory is None or count < self.lanes:  # pieces run in threads
            memory = Memory(self.kernel, count, self.constants)
        for row, number in zip(memory.rows, self.kernel.lane_constants, strict=False):
            row[:count] = task.values[number.name][lanes] if isinstance(number, LaneConstant) else number(points)
        parts = self._run(memory, task, points, lanes)
        state = memory.state
        if parts is None or any((state[i, 0] if count == 1 else state[i, :count].max()) > 0 for i in self.trouble):
            return None
        if y is not None and y.shape[2] > task.starts:
            out = memory.arrays["out"]
            y[lanes, :, task.starts :] = out[task.starts : y.shape[2], :, :count].transpose(2, 1, 0)
        numbers = state[:, :count].copy() if self.memory is not None else state[self.kept_rows, :count]
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

    def _take(self, call: Call, args: Pytree, direction: float, rest: float) -> Mapping[str, Any]:
        """Take over the numbers of a call as constants of the run; returns them by name."""
        names = self.kernel.run_constants
        values: dict[str, Any] = {"checks": 1.0, "direction": direction, "rest": rest}
        if len(names) > 1:
            values |= {"end": call.end, "rtol": call.rtol, "atol": call.atol, "max_step": call.max_step}
            values["tiny"] = max(rest, call.min_step if call.dt is None else 0.0)
            values["gap"] = gap_of(call.looks, call.end - call.begin, self.problem.field)
            values["latest"] = bounds_of((call.begin, call.end))[1]
        if args is not None:
            check_numbers(args, self.shape)
            values |= arg_values(args, len(self.shape))
        self.constants[: len(names)] = [values.get(name, 0.0) for name in names]
        return values

    def _run(self, memory: Memory, task: Task, points: Array, lanes: slice) -> list[Array] | None:
        """Run the kernel for some points from begin to end; the parts of the path, None if a lane fails."""
        call, n, count, state = task.call, self.n, len(points), memory.state
        integers, floats, width = memory.integers, memory.floats, state.shape[1]
        state[:] = memory.first
        state[:n, :count] = points.T
        times: Any = call.times
        last = 0 if times is None else len(times) - int(times[-1] == call.end)
        stops = memory.room("stops", last + 2)
        if last:
            stops[:last] = times[:last]
        stops[last : last + 2] = call.end
        memory.room("out", last + 2, n, width)
        integers[LAST_STOP], integers[FIRST_STOP], floats[ORIGIN] = last, task.starts, call.begin
        size: Any = call.dt
        if size is None:
            size = call.first_step or call.min_step or inf
        else:
            size = task.direction * (size if type(size) is float else size.reshape(-1)[lanes])
        if self.lockstep:
            state[self.place["count"]] = task.total
            integers[END_STEP], integers[TOTAL], floats[STEP_SIZE] = task.total, task.total, size
        else:
            given = {"t": call.begin, "stop": task.starts, "kept": task.starts, "h": size}
            for name, i in self.given:
                state[i, :count] = given[name]
        if count < width:
            state[:, count:] = state[:, :1]
        memory.start[:] = state[:n]
        if not self.lockstep:
            return self._to_the_end(memory, count, call.max_steps, keeps=task.keeps)
        parts = [memory.room("path", task.total, n + 2, width)[: task.total]] if task.keeps else []
        self.kernel.run(memory.address)
        alive = state[self.place["alive"]]
        return parts if (alive[0] if count == 1 else alive[:count].min()) > 0 else None

    def _to_the_end(self, memory: Memory, count: int, most: float, *, keeps: bool) -> list[Array] | None:
        """Run the kernel until all lanes are at the end, by steps of their own sizes."""
        parts, width, row, state = list[Array](), memory.state.shape[1], self.n + 1, memory.state
        alive, taken = state[self.place["alive"], :count], state[self.place["count"], :count]
        memory.integers[END_STEP] = max(1, OPERATIONS_PER_CALL // (self.work * count))
        while True:
            if keeps:
                path = memory.room("path", self.rows, row + 1, width)
                memory.integers[END_STEP] = len(path)
                path[:, row] = 0.0
            self.kernel.run(memory.address)
            if keeps:
                moved = np.flatnonzero(path[:, row, :count].any(axis=-1))
                parts.append(path[: int(moved[-1]) + 1 if len(moved) else 0])
            least, most_left = (alive[0], alive[0]) if count == 1 else (np.abs(alive).min(), alive.max())
            if least == 0 or (taken[0] if count == 1 else taken.max()) >= most:
                return None
            if most_left < 0:
                return parts
            if keeps:  # the path is full
                memory.arrays["path"], self.rows = np.zeros(0), 2 * self.rows

    def _path(self, parts: list[Array], count: int) -> Array:
        """The path of some lanes, without gaps, from its parts."""
        path = (parts[0] if len(parts) == 1 else np.concatenate(parts))[..., :count]
        if self.lockstep or (count == 1 and path[:, self.n + 1].all()):
            return path
        moved = path[:, self.n + 1] != 0
        if not moved.all():
            order = np.argsort(~moved, axis=0, kind="stable")[: int(moved.sum(axis=0).max(initial=0))]
            path, moved = (np.take_along_axis(x, i, axis=0) for x, i in ((path, order[:, None]), (moved, order)))
            path = np.where(moved[:, None], path, np.nan)
        # memory that is used again is copied when the parts are joined
        return path

    def _others(
        self, call: Call, args: Pytree, numbers: Array, path: tuple[Array, Array, Array] | None,
        starts: tuple[Array, Array | None], log: EventLog | None,
    ) -> dict[str, object]:  # fmt: skip
        """The other entries of a solution, which are made when one of them is asked for."""
        p, shape, graph, (points, start) = self.problem, self.shape, self.kernel.graph, starts
        bound = p.field if args is None else p.field.with_args(args)
        p = replace(p, bound=bound, span=(np.float64(call.begin), np.float64(call.end)))
        row = dict(zip(self.kept, numbers, strict=True))
        statistics = StepStatistics(self.step, shape)
        if len(points):
            note_ranks(statistics, p, self.step, points, self.ranked, shape)
        statistics.add_compiled(np.arange(self.lanes), records_of(self.kernel, row), (call.begin, call.end))
        calls = calls_of(self.kernel, row, row.get("tries", row["count"]))
        calls = calls + int(graph.first is not None and call.dt is None and not (call.first_step or call.min_step))
        steps = row["count"].astype(int)
        check = replace(p.options, looks=call.looks).check(p.field.time_dependent)
        direction = 1.0 if call.end > call.begin else -1.0
        report = statistics.report(
            p.action, p.options.clock, p.orbit_dimension, direction, check=check, engine=self.kernel.engine
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
            "sol": dense() if call.dense else None, "t_events": t_events, "y_events": y_events,
            "nfev": self.prepared + int(calls.max()), "message": MESSAGES[END],
            "n_steps": steps.reshape(shape) if shape else int(steps[0]), "report": report,
            "statuses": np.full(shape, END) if shape else END, "njev": 0, "nlu": 0,
            "_steps": dense if call.times is None or call.dense else None,
        }  # fmt: skip


def _joined(pieces: Sequence[Piece], points: Array, begin: float) -> tuple[Array, Array, Array]:
    """Times (L, j + 1), points (L, N, j + 1) and sizes (L, j) of the paths of all lanes, filled up with NaN."""
    (lanes, n), paths = points.shape, [(x.lanes, x.path) for x in pieces if x.path is not None]
    rows = len(paths[0][1]) if len(paths) == 1 else max(len(path) for _, path in paths)
    t, y, sizes = np.empty((lanes, rows + 1)), np.empty((lanes, n, rows + 1)), np.empty((lanes, rows))
    t[:, 0], y[:, :, 0] = begin, points
    for here, path in paths:
        count = len(path)
        t[here, 1 : count + 1], y[here, :, 1 : count + 1] = path[:, n].T, path[:, :n].transpose(2, 1, 0)
        sizes[here, :count] = path[:, n + 1].T
        if count < rows:
            t[here, count + 1 :], y[here, :, count + 1 :], sizes[here, count:] = np.nan, np.nan, np.nan
    return t, y, sizes
