"""Calls that are made again: a plan is a compiled call of which the numbers alone are new."""

from __future__ import annotations

import contextlib
from collections.abc import Hashable, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from math import ceil, inf
from operator import itemgetter
from struct import Struct
from typing import Any, Literal, NamedTuple, TypeAlias, final

import numpy as np

from liehom.base.errors import ConvergenceError, LiehomError
from liehom.base.objects import refuse_masked
from liehom.base.pytrees import Leaf, PerTrajectory
from liehom.base.typing import Array, IntegerArray, Pytree
from liehom.flow.action.field import check_point
from liehom.flow.action.space import Action
from liehom.flow.engines.arguments import with_tight_frame
from liehom.flow.engines.compiled_events import PlannedEvents
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
from liehom.flow.run.records import EventLog, StepStatistics, without_gaps
from liehom.flow.run.solution import DenseSolution, Solution, solution_of
from liehom.flow.steps.step import Generator, Step
from liehom.flow.tracing.graph import LaneConstant
from liehom.flow.tracing.machine import PLACES, Kernel, padded

# The numbers of a call, as numbers of Python and arrays of floats. Lists, tuples, integers and numbers of numpy are the
# same call. Whatever is unusual, or not right, has no such form: `Propagator` looks at it closely.

KINDS = frozenset([float, int, np.float64, np.float32, np.int64, np.int32])
ROUND_OFF = 8 * float(np.finfo(np.float64).eps)
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
        value = np.array(given)
        if value.ndim != 1:
            refuse_masked(what, given)
    elif type(given) is not np.ndarray:
        return None
    if value.dtype is FLOAT or value.dtype == FLOAT:
        return value
    return value.astype(np.float64) if value.dtype.kind in "iu" else None


def _stops_of(times: Array, begin: float, end: float) -> tuple[Array, int, int] | None:
    """Output times with the slice of those within a span; None if they are not in order."""
    if times.ndim != 1 or not len(times):
        return None
    first, last = times.item(0), times.item(-1)
    if not (begin <= first <= last <= end if end > begin else begin >= first >= last >= end):
        return None
    if len(times) > 1 and not (np.diff(times) * (1 if end > begin else -1) > 0).all():
        return None
    return times, int(first == begin), len(times) - int(last == end)


def form_of(form: Hashable, numbers: Numbers, args: Sequence[Leaf] | None) -> Hashable:
    """The form of a call, with the leaves of its args: calls of one form have one plan."""
    return form, numbers.form, None if args is None else tuple([_form_of_leaf(*leaf) for leaf in args])


def _form_of_leaf(path: str, x: object) -> Hashable:
    """The place, the type and the shape of a leaf; a number is not of the type of anything that is refused."""
    if type(x) is np.ndarray:
        return path, x.dtype, x.shape
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

WRITTEN = 8 * PLACES["begin"]  # from where on a call of one trajectory writes its memory
CHUNK = 16_384  # number of lanes, at most, that are copied in, run, and copied out at once
SMALL = 1024  # number of lanes up to which memory is kept from call to call
ROOM = 64  # rows of the path, at first, of steps whose number is not known
SORTED = 256  # lanes from which on those with as many steps left are put into one block
FIRST_STEPS = 24  # steps after which lanes are sorted first
MOVED, ENTERED = 200.0, 3  # to move a number, in operations; to enter the machine code again, in steps
TINY = float(np.finfo(np.float64).tiny)
LAST, LAST_STOP, FIRST_STOP, ORIGIN, BEGIN, END_STEP, TOTAL, STEP_SIZE = (
    PLACES[name] for name in ("last", "last_stop", "first_stop", "origin", "begin", "end", "total", "step_size")
)
OF_A_CALL = ("checks", "rest", "end", "direction", "tiny", "latest", "gap", *Numbers._fields)
"""The numbers of a call that a kernel may take, before those of args."""
TROUBLE = frozenset(["unkept", "failed", "near", "short", "conservation_short", "conservation_missed"])
"""Numbers of steps that are 0, or -inf, if the steps are as they should be."""


Task: TypeAlias = tuple[Numbers, Array, tuple[Array, int, int] | None, float, float, Any, float, tuple[Any, ...], int]
"""Numbers of a call, points (..., N), output times, begin and end of the span, sizes with their sign, the direction,
numbers in the order of `Plan.names`, and the number of steps in lockstep, 0 for steps of their own sizes."""


@final
class Plan:
    """A compiled call of one form: points, span, sizes, tolerances, output times and args are those of each call."""

    def __init__(
        self, kernel: Kernel, problem: Problem, step: Step, work: int, calls: int, events: PlannedEvents | None
    ) -> None:  # fmt: skip
        shape, graph, options = np.shape(problem.start), kernel.graph, problem.options
        self.kernel, self.problem, self.step, self.work, self.prepared = kernel, problem, step, work, calls
        self.shape, self.n, self.lanes, self.events = shape[:-1], shape[-1], int(np.prod(shape[:-1], dtype=int)), events
        self.axes = (*range(1, len(shape)), 0, len(shape))  # which take a path (N, ..., j + 1) to (..., N, j + 1)
        self.lockstep, self.place = graph.reached is None, {name: i for i, name in enumerate(kernel.names)}
        self.alive, self.taken, self.time, self.size = (self.place.get(x, 0) for x in ("alive", "count", "t", "h"))
        self.trouble = [self.place[e] for e, (name, _) in graph.recorded.items() if name in TROUBLE]
        self.kept = [x for x in kernel.names if self.lanes == 1 or x in graph.recorded or x in ("count", "tries")]
        self.kept_rows = [self.place[name] for name in self.kept]
        self.ranked = ranked(self.lanes) if step.uses_isotropy else None
        wanted = [*kernel.run_constants, "checks", "checks"]  # of one name itemgetter would make no tuple
        self.names = [*OF_A_CALL, *arg_values(problem.args, len(self.shape))]
        self.constants: Array = np.ones(len(wanted))
        self.slots, self.pack_constants = self.constants.data, Struct(f"{len(wanted)}d").pack_into
        self.chosen = itemgetter(*map(self.names.index, wanted))
        self.is_fixed, self.has_gap = {*wanted} == {"checks"} and problem.args is None, "gap" in wanted
        self.keeps = options.t_eval is None or options.dense_output or events is not None
        memory = Memory(kernel, self.lanes, self.constants) if self.lanes <= SMALL else None
        self.free = [memory]  # the memory, unless a call is using it
        self.is_alone = not self.shape and kernel.width == 1 and not kernel.lane_constants
        if memory is not None and self.is_alone:
            # a call of one trajectory writes at once from `begin` to the initial point, and the first row of the path
            known, point = 2 if self.lockstep else 5, f"{8 * self.n}s"
            self.later = memory.fresh[self.n + known : len(kernel.names)].tobytes()
            self.pack = Struct(f"3q4d{point}{known}d{len(self.later)}s{point}").pack_into
            self.pack_first = Struct(point + "d").pack_into
            self.room = -1  # rows of the path in memory, as far as they are known here
        self.is_judged, self.rows = options.dt is not None, ROOM
        self.most = max(1, OPERATIONS_PER_CALL // work)  # steps of a call
        # rows of a path, and output times, up to which there is one piece in the memory that is kept
        row = max(8 * (self.n + 2) / PATH_BYTES_PER_CALL, work / OPERATIONS_PER_CALL, 1 / LANE_STEPS_FOR_THREADS)
        self.short = int(1 / (row * self.lanes))

    def call(
        self, numbers: Numbers, points: Array, begin: float, end: float, times: Array | None,
        args: Pytree, found: Sequence[Leaf] | None,
    ) -> Solution | None:  # fmt: skip
        """The solution, or None if the call needs a closer look."""
        length, size, first, last, total = abs(end - begin), numbers.dt, abs(begin), abs(end), 0
        rest = ROUND_OFF * (first if first > last else last)
        direction = 1.0 if end > begin else -1.0
        if not 0.0 < length < inf or (numbers.shape and numbers.shape != self.shape):
            return None
        if size is None:
            size = numbers.first_step or numbers.min_step or inf
        else:
            if rest > (size if type(size) is float else np.min(size)):
                return None
            if self.lockstep:
                total = ceil(length / size - (SLACK + rest / size)) or 1
                if total >= numbers.max_steps:
                    return None
            size = direction * size
        stops = None if times is None else _stops_of(times, begin, end)
        if (times is not None and stops is None) or (self.events is not None and self.events.parts.changed()):
            return None
        try:
            memory = self.free.pop()
        except IndexError:  # another thread makes a call
            return None
        try:
            values = () if self.is_fixed else self._take(numbers, begin, end, rest, direction, found)
            task = numbers, points, stops, begin, end, size, direction, values, total
            is_short = (total or self.keeps * self.rows) <= self.short and (times is None or len(times) <= self.short)
            if is_short and self.is_alone and memory:
                solution = self._alone(task, args, memory)
                if solution is not False:
                    return solution
            made = self._in_pieces(task, memory if is_short else None)
            return None if made is None else self._solution(task, args, *made)
        finally:
            self.free.append(memory)

    def _solution(
        self, task: Task, args: Pytree, most: float, state: Array | bytes, path: Array, y: Array
    ) -> Solution | None:
        """The solution from states (k, L) or their bytes, and a path (N + 2, ..., j + 1); None for a closer look."""
        n, log, start, stops = self.n, None, None, task[2]
        if not self.is_judged and most >= MIN_STEPS:
            self.is_judged = True  # an ordinary call says whether the field is stiff
            return None
        if self.events is not None:
            values = {**dict(zip(self.names, task[7], strict=False)), "length": abs(task[4] - task[3])}
            values["direction"] = task[6]
            if (log := self.events(path, values)) is None:
                return None
        if stops is None:
            times, y = path[n], path[:n].transpose(self.axes) if self.shape else path[:n]
        else:
            times = stops[0].copy()
        if self.ranked is not None:  # what the other entries need is copied: points may change
            start = task[1].reshape(self.lanes, n).copy()
        return solution_of(times, y, END, (self._others, task, args, state, path, start, log))

    def _alone(self, task: Task, args: Pytree, memory: Memory) -> Solution | Literal[False] | None:
        """The solution of one trajectory, by few operations; False if the path has no room, or if a step fails."""
        numbers, points, stops, begin, end, size, _, _, total = task
        path: Any = None
        y: Any = None
        cells, n, point = memory.cells, self.n, points.tobytes()
        rows = total or (self.rows if self.keeps else self.most)
        if total:
            self.pack(memory.whole, WRITTEN, 0, rows, rows, begin, size, end, end, point, 1.0, rows, self.later, point)
        else:
            state = 1.0, 0.0, begin, 0.0, size
            self.pack(memory.whole, WRITTEN, 0, rows, 0, begin, 0.0, end, end, point, *state, self.later, point)
        if stops is not None:
            self._put(stops, memory, end)
        if self.keeps:
            if rows > self.room:
                self.room, self.path, self.columns = rows, memory.path(rows, n + 2), dict[int, Array]()
                self.row = memory.views["path"]
            self.pack_first(self.row, 0, point, begin)
        self.kernel.run(memory.address)
        left, most = cells[self.alive], total or int(cells[self.taken])
        failed = left <= 0 if total else left >= 0 or most >= numbers.max_steps
        if failed or (self.trouble and any([cells[i] > 0 for i in self.trouble])):  # noqa: C419 - quicker
            return False
        if self.keeps:
            rows = total or memory.integers[BEGIN]
            columns = self.columns.get(rows)
            if columns is None:
                columns = self.path[: rows + 1, :, 0].T
                if rows <= ROOM:
                    self.columns[rows] = columns
            path = columns.copy()
            if rows > most:  # some rows are not steps
                path[n + 1, 0] = 1.0
                path = path[:, path[n + 1] != 0]
        if stops is not None:
            y = memory.arrays["out"][: len(stops[0]), :, 0].T.copy()
        return self._solution(task, args, most, cells.tobytes(), path, y)

    def _in_pieces(self, task: Task, memory: Memory | None) -> tuple[float, Array, Any, Any] | None:
        """States and paths of the lanes in pieces, in threads if they are many; None if one of them fails."""
        stops, total, n = task[2], task[-1], self.n
        rows = total if self.lockstep or not self.keeps else self.rows
        y = None if stops is None else np.empty((self.lanes, n, len(stops[0])))
        if memory is not None:
            pieces = [self._made(task, slice(0, self.lanes), y, memory)]
        else:
            chunk = self._chunk(rows)
            cuts = pairwise([*range(0, self.lanes, chunk), self.lanes] if chunk else [])
            pieces = in_threads(lambda lanes: self._made(task, lanes, y), [slice(a, b) for a, b in cuts])
        made = [piece for piece in pieces if piece is not None]
        if not made or len(made) < len(pieces):
            return None
        state = made[0][0] if len(made) == 1 else np.concatenate([x[0] for x in made], axis=1)
        most = np.maximum.reduce(state[self.kept.index("count")])
        if most >= task[0].max_steps:
            return None
        path = _joined([x[1] for x in made]).transpose(1, 2, 0).reshape(n + 2, *self.shape, -1) if self.keeps else None
        return most, state, path, None if y is None else y.reshape(*self.shape, n, -1)

    def _made(
        self, task: Task, lanes: slice, y: Array | None, kept: Memory | None = None
    ) -> tuple[Array, Array] | None:
        """Numbers of states and the path of some lanes, whose points at output times go to y; None if one fails."""
        numbers, points, stops, begin, end, size, _, values, total = task
        points = points.reshape(self.lanes, self.n)[lanes]
        memory = Memory(self.kernel, len(points), self.constants) if kept is None else kept  # pieces run in threads
        count, n, state, integers = len(points), self.n, memory.state, memory.integers
        for row, f in zip(memory.rows, self.kernel.lane_constants, strict=False):
            row[:count] = values[self.names.index(f.name)][lanes] if isinstance(f, LaneConstant) else f(points)
        memory.cells[:] = memory.fresh
        memory.points[:] = points
        if not total:
            own = size if isinstance(size, float) else size.reshape(-1)[lanes]
            state[self.time], state[self.size, :count] = begin, own
        if count < state.shape[1]:
            memory.block[:, :, count:] = memory.block[:, :, :1]
        memory.floats[ORIGIN] = begin
        if stops is not None:
            self._put(stops, memory, end)
        else:
            memory.arrays["stops"][:2] = end
        if total:
            path: Any = memory.path(total, n + 2)[: total + 1, :, :count] if self.keeps else state
            if self.keeps:
                path[0, :n], path[0, n] = state[:n, :count], begin
            integers[END_STEP] = integers[TOTAL] = total
            memory.floats[STEP_SIZE] = size
            self.kernel.run(memory.address)
            if state[self.alive, :count].min() <= 0:
                return None
            state[self.taken], path = total, path if kept is None else path.copy()
        else:
            sorts = count >= SORTED and self.kernel.width > 1 and not self.keeps
            path = (self._by_pace if sorts else self._to_the_end)(memory, count, begin, numbers.max_steps)
        if path is None or (self.trouble and (state[self.trouble, :count] > 0).any()):
            return None
        if y is not None:
            y[lanes] = memory.arrays["out"][: y.shape[2], :, :count].transpose(2, 1, 0)
        return state[self.kept_rows, :count], path

    def _put(self, stops: tuple[Array, int, int], memory: Memory, end: float) -> None:
        """Give a kernel output times and the end, and take the points at the begin."""
        times, first, last = stops
        if len(memory.views["stops"]) < last + 2:
            memory.room("stops", last + 2)
            memory.room("out", last + 2, *memory.start.shape)
        places = memory.views["stops"]
        if last:
            places[:last] = times.data[:last]
        places[last] = places[last + 1] = end
        memory.integers[LAST_STOP], memory.integers[FIRST_STOP] = last, first
        if first:
            memory.arrays["out"][0] = memory.start
            memory.state[[self.place[name] for name in ("stop", "kept") if name in self.place]] = 1

    def _chunk(self, rows: int) -> int:
        """Number of lanes that are run at once, whole blocks; 0 if even one block is too long for one call."""
        width, most = self.kernel.width, min(self.lanes, CHUNK)
        if self.lanes * max(rows, 1) >= LANE_STEPS_FOR_THREADS:
            most = min(most, max(width, -(-self.lanes // cores())))
        most = min(most, OPERATIONS_PER_CALL // (self.work * max(rows, 1)))
        if self.keeps:
            most = min(most, PATH_BYTES_PER_CALL // (8 * (self.n + 2) * rows))
        return padded(most, width) if most >= min(width, self.lanes) else 0

    def _take(
        self, numbers: Numbers, begin: float, end: float, rest: float, direction: float, found: Sequence[Leaf] | None
    ) -> tuple[Any, ...]:
        """The numbers of a call, of which the constants of the run are taken."""
        tiny = rest if numbers.dt is not None or rest > numbers.min_step else numbers.min_step
        gap = gap_of(numbers.looks, end - begin, self.problem.field) if self.has_gap else None
        latest = abs(begin) + abs(end) + 1.0  # see bounds_of
        known: tuple[Any, ...] = (1.0, rest, end, direction, tiny, latest, gap) + numbers  # noqa: RUF005 - quicker
        if found is not None:
            known += (*numbers_in(found, len(self.shape)),)
        self.pack_constants(self.slots, 0, *self.chosen(known))
        return known

    def _by_pace(self, memory: Memory, count: int, begin: float, most: float) -> Array | None:
        """The states at the end, of lanes that are sorted by the steps that they have left, as long as that pays."""
        state, start, integers, width = memory.state, memory.start, memory.integers, self.kernel.width
        limit, made, steps, lanes = max(1, OPERATIONS_PER_CALL // (self.work * count)), 0, FIRST_STEPS, np.arange(count)
        last = int(integers[LAST_STOP])
        out, end = memory.arrays["out"][: last + 1], memory.arrays["stops"][last]
        held = [state, start, *out, *([memory.rows] if self.kernel.lane_constants else [])]
        cost = count * (ENTERED + MOVED / self.work * sum(map(len, held)))
        while True:
            integers[BEGIN], integers[END_STEP] = 0, min(steps, limit)
            self.kernel.run(memory.address)
            alive, t = state[self.alive, :count], state[self.time, :count]
            going = int(np.count_nonzero(alive > 0))
            if not alive.all() or (going and state[self.taken, :count].max() >= most):
                return None
            if not going:
                break
            made += min(steps, limit)
            left = np.where(alive > 0, made * np.abs(end - t) / (np.abs(t - begin) + TINY), 0.0)
            total, slowest = left.sum(), np.maximum.reduceat(left, np.arange(0, count, width)).sum()
            if steps < limit and width * slowest - total > cost:
                order = np.argsort(-left)
                lanes, integers[LAST] = lanes[order], -(-going // width)
                for array in held:
                    array[:, :count] = array.take(order, 1)
            steps = int(total / (2 * going)) + 1
            if steps * count < 3 * cost:
                steps = limit
        integers[LAST] = state.shape[1] // width
        back = np.argsort(lanes)
        for array in (state, *out):
            array[:, :count] = array.take(back, 1)
        return state

    def _to_the_end(self, memory: Memory, count: int, begin: float, most: float) -> Array | None:
        """Run the kernel until all lanes are at the end, by steps of their own sizes; the path."""
        parts, n, state, integers, left = list[Array](), self.n, memory.state, memory.integers, 1.0
        integers[END_STEP] = max(1, OPERATIONS_PER_CALL // (self.work * count))
        while left > 0:
            if self.keeps:
                path = memory.path(self.rows, n + 2)
                path[0, :n], path[0, n], path[0, n + 1], path[1:, n + 1] = state[:n], begin, not parts, 0.0
                integers[END_STEP] = len(path) - 1
            integers[BEGIN] = 0
            self.kernel.run(memory.address)
            lanes = state[self.alive, :count]
            left = np.maximum.reduce(lanes)
            if left >= 0 and (not lanes.all() or state[self.taken, :count].max() >= most):
                return None
            if self.keeps:
                parts.append(path[path[:, n + 1, :count].any(axis=-1), :, :count])  # rows with steps
                self.rows *= 1 + (left > 0)  # the path is full
        if not self.keeps:
            return state
        path = parts[0] if len(parts) == 1 else np.concatenate(parts)
        moved = path[:, n + 1] != 0
        if moved.all():
            return path
        return without_gaps(path.swapaxes(1, 2), moved).swapaxes(1, 2)

    def _others(
        self, task: Task, args: Pytree, state: Array | bytes, path: Array, start: Array | None, log: EventLog | None
    ) -> dict[str, object]:
        """The other entries of a solution, which are made when one of them is asked for."""
        p, shape, graph = self.problem, self.shape, self.kernel.graph
        given, _, stops, *span, _, direction, _, _ = task
        bound = p.field if args is None else p.field.with_args(args)
        p = replace(p, bound=bound, span=(np.float64(span[0]), np.float64(span[1])))
        rows = np.frombuffer(state, count=len(self.kept))[:, None] if isinstance(state, bytes) else state
        row = dict(zip(self.kept, rows, strict=True))
        statistics = StepStatistics(self.step, shape)
        if self.ranked is not None and start is not None:
            note_ranks(statistics, p, self.step, start[self.ranked], self.ranked, shape)
        statistics.add_compiled(np.arange(self.lanes), records_of(self.kernel, row), (span[0], span[1]))
        calls = calls_of(self.kernel, row, row.get("tries", row["count"]))
        calls = calls + int(graph.first is not None and given.dt is None and not (given.first_step or given.min_step))
        steps = row["count"].astype(int)
        check = replace(p.options, looks=given.looks).check(p.field.time_dependent)
        how: dict[str, Any] = {"check": check, "engine": self.kernel.engine}
        report = statistics.report(p.action, p.options.clock, p.orbit_dimension, direction, **how)

        def dense() -> DenseSolution:
            steps = path.swapaxes(0, -1)
            ends, points, sizes = steps[..., self.n], steps[..., : self.n], np.nan_to_num(steps[1:, ..., self.n + 1])
            psi = Generator(bound, p.orbit_dimension, points[0])
            step = p.step.prepare(p.action, psi, psi.start, np.full(shape, p.span[0]))  # type: ignore[arg-type]
            return DenseSolution(p.action, psi, step, ends, points, sizes, nominal=p.options.nominal)

        t_events, y_events = (None, None) if log is None else log.lists()
        return {
            "sol": dense() if given.dense else None, "t_events": t_events, "y_events": y_events,
            "nfev": self.prepared + int(calls.max()), "message": MESSAGES[END],
            "n_steps": steps.reshape(shape) if shape else int(steps[0]), "report": report,
            "statuses": np.full(shape, END) if shape else END, "njev": 0, "nlu": 0,
            "_steps": dense if stops is None or given.dense else None,
        }  # fmt: skip


def _joined(paths: Sequence[Array]) -> Array:
    """The paths of pieces as one, filled up with NaN."""
    if len(paths) == 1:
        return paths[0]
    whole, first = np.full((max(map(len, paths)), paths[0].shape[1], sum(x.shape[2] for x in paths)), np.nan), 0
    for path in paths:
        whole[: len(path), :, first : first + path.shape[2]] = path
        first += path.shape[2]
    return whole
