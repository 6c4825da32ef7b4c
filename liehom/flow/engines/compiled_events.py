"""Events of compiled runs."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from types import FunctionType
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import InputError, LiehomError, TraceError
from liehom.base.typing import Array, BooleanArray, IntegerArray
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.fingerprint import Parts
from liehom.flow.engines.engine import Problem
from liehom.flow.engines.lanes import LaneSteps, Memory, times_until
from liehom.flow.engines.traced_step import all_of, arg_values, args_of_lanes, traced_args, with_traced_frame
from liehom.flow.run.events import Events, Look
from liehom.flow.run.records import EventLog, Occurrence, occurrences_of
from liehom.flow.run.run import Run, StepProposal
from liehom.flow.steps.step import Generator, Step, length
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import LaneConstant, RunConstant, Tape, TrajectoryConstant
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import PLACES, Kernel, lanes_per_register, padded

FAILURES = (LiehomError, TypeError, ValueError, IndexError, KeyError, ArithmeticError)
"""What functions raise that were not written for this number of points."""
RTOL = 1e-9
NEAR = 1e-3  # relative distance of trial points
FEW = 16  # points on paths, up to which their signs are compared one by one


# Events of compiled runs: machine code makes the steps of a call, then events are sought in all of them at once. Event
# functions are evaluated at the ends of all steps of all lanes. The steps in which a zero is possible, by the rules of
# `liehom.flow.run.events`, are made again in numpy from their stored starts, and the zeros are located on their dense
# output. A terminal event truncates what the machine code has made of its lane.
#
# An event function is called with all points at once if that gives, at some points, what it gives for them in the form
# of the run: a point (N,), or the whole ensemble (..., N). Others are called in that form, as often as needed.

STEPS_AT_ONCE = 16_384  # steps that are made again at once, at most
ROOT_EPS = float(np.sqrt(np.finfo(np.float64).eps))


class Steps(NamedTuple):
    """The steps of some lanes, of each lane in order of time, one lane after the other."""

    row: IntegerArray  # (p,): where the step is stored
    column: IntegerArray
    lane: IntegerArray  # its trajectory in the flattened ensemble
    t: Array  # time and point before the step
    m: Array  # (p, N)
    h: Array  # signed size
    after: Array  # time and point after the step
    reached: Array  # (p, N)
    first: BooleanArray  # whether it is the first one of its lane


@final
class EventSearch:
    """Looks for the events of a run in steps that a kernel has made."""

    def __init__(self, run: Run) -> None:
        self.run, self.events = run, run.events or Events([])
        self.start = run.start.reshape(-1, run.start.shape[-1])
        self.dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
        lanes, size = self.start.shape
        some = np.arange(max(lanes, size) + 1)[::-1] if lanes else np.zeros(0, dtype=int)
        trial: IntegerArray = some % max(lanes, 1)
        points = self.start[trial]
        if not run.shape:  # points that differ, as those of an ensemble do
            points = points * (1 + NEAR * np.random.default_rng(0).normal(size=points.shape))
        self.at_once = [True] * self.events.count
        for i in range(self.events.count):
            self.checked(i, np.full(len(trial), float(run.span[0])), points, trial, len(trial))
        self.psi_at_once = not lanes or self._psi_works_at_once(trial, points)
        if not self.psi_at_once and run.shape:
            raise InputError(
                "engine='llvm' looks for events by calls of psi for some trajectories of the ensemble, and this psi "
                "cannot be called so: write it for points of shape (..., N), or take engine='numpy'"
            )

    @property
    def ends_runs(self) -> bool:
        """Whether an event is terminal."""
        return bool(np.isfinite(self.events.terminal).any())

    def _psi_works_at_once(self, lanes: IntegerArray, points: Array) -> bool:
        """Whether psi takes more points than there are trajectories, as arrays (..., N)."""
        field, begin, shape = self.run.field, float(self.run.span[0]), self.run.shape
        try:
            values = np.asarray(self._field(lanes).psi(points, np.full(len(lanes), begin)))
            if shape:
                eager = np.asarray(field.psi(self.run.start, np.full(shape, begin)))
                wanted = np.broadcast_to(eager, (*shape, eager.shape[-1])).reshape(len(self.start), -1)[lanes]
            else:
                wanted = np.array([field.psi(m, np.float64(begin)) for m in points])
            return bool(np.allclose(np.broadcast_to(values, wanted.shape), wanted, equal_nan=True))
        except FAILURES:
            return False

    def _field(self, lanes: IntegerArray) -> GeneratorField:
        """The field, with args of these lanes."""
        args = args_of_lanes(self.run.field.args, self.run.shape, lanes)
        return self.run.field if args is None else self.run.field.with_args(args)

    def of(self, lanes: IntegerArray) -> Events:
        """The event functions of pairs t (p,), y (p, N) of these trajectories."""
        events = Events(self.run.options.events or [], args_of_lanes(self.run.field.args, self.run.shape, lanes))
        events.functions = [
            function if self.at_once[i] else partial(self._in_turn, i, lanes)
            for i, function in enumerate(events.functions)
        ]
        return events

    def checked(self, i: int, t: Array, y: Array, lanes: IntegerArray, some: int = 1) -> Array:
        """g_i at pairs; at the last ones it is compared with the function in the form of the run."""
        if self.at_once[i]:
            with suppress(*FAILURES):
                values, there = self.of(lanes).value(i, t, y), slice(len(t) - some, None)
                wanted = self._in_turn(i, lanes[there], t[there], y[there])
                if np.allclose(values[there], wanted, RTOL, RTOL * float(np.abs(wanted).max()), equal_nan=True):
                    return values
            self.at_once[i] = False
        return self._in_turn(i, lanes, t, y)

    def _in_turn(self, i: int, lanes: IntegerArray, t: Array, y: Array) -> Array:
        """g_i by calls in the form of the run; trajectories without a pair are at their initial points."""
        shape = self.run.shape
        if not shape:
            return np.array([float(self.events.value(i, time, point)) for time, point in zip(t, y, strict=True)])
        values: Array = np.empty(len(t))
        for here in _rounds(lanes):
            times, points = np.full(len(self.start), float(self.run.span[0])), self.start.copy()
            times[lanes[here]], points[lanes[here]] = t[here], y[here]
            value = self.events.value(i, times.reshape(shape), points.reshape(*shape, -1))
            values[here] = value.reshape(-1)[lanes[here]]
        return values

    # -- the search --------------------------------------------------------------------------------------
    def __call__(self, lanes: IntegerArray, before: tuple[Array, Array, IntegerArray], done: LaneSteps) -> LaneSteps:
        """Record the events in the steps of some lanes; returns the steps up to the terminal ones."""
        steps = _listed(lanes, before, done)
        if not len(steps.row):
            return done
        events, values = self.events, []
        fresh, last = steps.first & (before[2][steps.column] == 0), np.append(steps.first[1:], True)
        occurrences: list[Occurrence] = []
        for i, known in enumerate(self.run.state.event_values):
            end = self.checked(i, steps.after, steps.reached, steps.lane)
            start, now = np.concatenate([end[:1], end[:-1]]), np.array(known).reshape(-1)
            start[steps.first] = now[steps.lane[steps.first]]
            now[steps.lane[last]] = end[last]
            values.append(now.reshape(self.run.shape))
            for p in np.flatnonzero(fresh & events.left(i, start, end)):
                occurrences.append(Occurrence(int(p), 0.0, i, int(steps.lane[p]), 0.0, steps.t[p], steps.m[p], False))
            chosen = np.flatnonzero(events.crossed(i, start, end) | self._turns(i, steps, start, end))
            for k in range(0, len(chosen), STEPS_AT_ONCE):
                occurrences += self._located(i, steps, chosen[k : k + STEPS_AT_ONCE], start, end)
        self.run.state.event_values = values
        halts = self.run.state.event_log.record(occurrences, events.terminal)
        return _truncated(self.run, steps, before[2], halts, done) if halts else done

    def _turns(self, i: int, steps: Steps, start: Array, end: Array) -> BooleanArray:
        """Steps at whose ends g_i has one sign, and from which slopes lead towards 0."""
        sign = np.sign(start)
        turns: BooleanArray = np.zeros(len(sign), dtype=bool)
        some = np.flatnonzero(sign * end > 0)
        for t, y, value, inwards in ((steps.after, steps.reached, end, -1), (steps.t, steps.m, start, 1)):
            slopes = self._slopes(i, steps.lane[some], t[some], y[some], value[some], inwards)
            some = some[inwards * sign[some] * slopes < 0]
        turns[some] = True
        return turns

    def _slopes(self, i: int, lanes: IntegerArray, t: Array, y: Array, value: Array, inwards: int) -> Array:
        """Derivatives of g_i at places (t, y) of lanes, in the direction of integration (see `Look.slope`)."""
        if not len(lanes):
            return np.zeros(0)
        field, events = self._field(lanes), self.of(lanes)
        if self.psi_at_once:
            vector = np.asarray(field.vector(y, t))
        else:
            vector = np.array([field.vector(m, time) for m, time in zip(y, t, strict=True)])
        return self._slope(events, vector, i, (t, y), value, inwards)

    def _slope(
        self, events: Events, vector: Array, i: int, place: tuple[Array, Array], value: Array, inwards: int
    ) -> Array:
        """The derivative of g_i along a vector, by a difference."""
        (t, y), span = place, self.run.span
        size = ROOT_EPS * np.minimum(length(y) / length(vector), abs(float(span[1] - span[0])))
        e = inwards * float(self.run.direction) * size
        return (events.value(i, t + e, y + e[..., None] * vector) - value) / (inwards * size)

    def _located(self, i: int, steps: Steps, chosen: IntegerArray, start: Array, end: Array) -> list[Occurrence]:
        """The zeros of g_i in some steps, which are made again."""
        if self.psi_at_once:
            return self._zeros(i, steps, chosen, chosen, start, end)
        return [x for p in chosen for x in self._zeros(i, steps, p, np.array([p]), start, end)]

    def _zeros(
        self, i: int, steps: Steps, where: IntegerArray | np.integer[Any], chosen: IntegerArray, start: Array,
        end: Array,
    ) -> list[Occurrence]:  # fmt: skip
        """The zeros of g_i in the steps of numbers `chosen`; `where` is the same, or one number without an axis."""
        run, lanes = self.run, steps.lane[chosen]
        events = self.events if np.ndim(where) == 0 else self.of(lanes)
        field = self._field(lanes)
        own = self.start[steps.lane[where]]
        psi = Generator(field, self.dimensions[steps.lane[where]], own)
        t, m, h, after, reached = (
            np.asarray(x[where]) for x in (steps.t, steps.m, steps.h, steps.after, steps.reached)
        )
        local = run.step.at(run.action, psi, m, t[..., None])
        yes = np.ones(h.shape, dtype=bool)
        step = StepProposal(local, t, m, h, after, reached, yes, ~yes, run.options.nominal, {})

        def slope(i: int, place: tuple[Array, Array], value: Array, inwards: int, here: BooleanArray) -> Array:
            return self._slope(events, np.asarray(field.vector(place[1], place[0])), i, place, value, inwards)

        look = Look(step.position, slope, h, (t, m), (after, reached), yes)
        occurrences: list[Occurrence] = []
        for here, s in events.zeros(i, look, start[where], end[where]):
            occurrences += occurrences_of(i, here, s, *step.position(np.where(here, s, 0)))
        return [x._replace(step=int(chosen[x.lane]), lane=int(lanes[x.lane])) for x in occurrences]


def _rounds(lanes: IntegerArray) -> list[IntegerArray]:
    """Indices of pairs in groups, in each of which a trajectory has at most one pair."""
    if not len(lanes):
        return []
    order, rank = np.argsort(lanes, kind="stable"), np.empty(len(lanes), dtype=int)
    rank[order] = np.arange(len(lanes)) - np.searchsorted(lanes[order], lanes[order])
    return np.split(np.argsort(rank, kind="stable"), np.cumsum(np.bincount(rank))[:-1])


def _listed(lanes: IntegerArray, before: tuple[Array, Array, IntegerArray], done: LaneSteps) -> Steps:
    """The steps of a path, lane by lane."""
    path: Any = done.path
    times, points, sizes = path
    column, row = np.nonzero(sizes.T)
    after, ends = times[row, column], np.ascontiguousarray(points[row, :, column])
    first = np.append(True, column[1:] != column[:-1])[: len(row)]
    t, m = np.concatenate([after[:1], after[:-1]]), np.concatenate([ends[:1], ends[:-1]])
    t[first], m[first] = before[0][column[first]], before[1][column[first]]
    return Steps(row, column, lanes[column], t, m, sizes[row, column], after, ends, first)


def _truncated(
    run: Run, steps: Steps, before: IntegerArray, halts: Mapping[int, Occurrence], all_of: LaneSteps
) -> LaneSteps:
    """The steps up to the terminal events."""
    path: Any = all_of.path
    times, points, sizes = (np.array(x) for x in path)
    m, t, taken, until = all_of.m.copy(), all_of.t.copy(), all_of.taken.copy(), all_of.until.copy()
    rows = np.full(len(t), -1)
    begins = np.flatnonzero(steps.first)
    begin_of = dict(zip(steps.column[begins].tolist(), begins.tolist(), strict=True))
    for x in halts.values():
        k, r = int(steps.column[x.step]), int(steps.row[x.step])
        m[:, k], t[k], rows[k] = x.y, x.t, r
        taken[k] = before[k] + x.step - begin_of[k] + 1
        times[r, k], points[r, :, k], sizes[r, k] = x.t, x.y, x.s
        sizes[r + 1 :, k] = 0
    halted = rows >= 0
    going, done = all_of.going & ~halted, all_of.done & ~halted
    until[halted] = times_until(run, t[halted])
    return all_of._replace(
        m=m, t=t, taken=taken, going=going, done=done, until=until, path=(times, points, sizes), halted=rows
    )


# Events of plans: event functions, and the search for their zeros, are compiled too. One kernel has values and slopes
# of all functions, and its lanes are the points of a path. Where a zero is possible, another one locates it, and its
# lanes are steps. A call that a terminal event ends is made again in the ordinary way.


@final
class PointCode:
    """Machine code of numbers that follow from others, as a step that is made once."""

    def __init__(self, tape: Tape, n: int, inputs: int, outputs: Sequence[object]) -> None:
        numbers = [tape.number(Traced(tape, x).entry) for x in outputs]
        numbers += [tape.zero] * (inputs - len(numbers))
        constants = tuple(map(partial(_of_coordinates, n), tape.constant_functions))
        self.count = len(outputs)
        graph = StepGraph(numbers, None, all_of(tape, tape.required), {}, {}, constants)
        self.kernel = Kernel(graph, lanes_per_register())
        if self.kernel.lane_constants:
            raise TraceError("numbers of a trajectory are not compiled for events")
        self.constants: Array = np.zeros(max(1, len(self.kernel.run_constants)))
        self.alive: int = self.kernel.names.index("alive")
        self.lanes = 0  # for which there is memory

    def run(self, given: Array | Sequence[Array], values: Mapping[str, float], start: Array | None = None) -> None:
        """Make numbers from others, each (L,), constants of the run, and initial points (N, L)."""
        lanes, rows, width = len(given[0]), len(given), self.kernel.width
        if self.lanes < lanes:
            self.lanes = padded(2 * lanes, width)
            self.memory = memory = Memory(self.kernel, self.lanes, self.constants)
            memory.integers[PLACES["end"]] = memory.integers[PLACES["total"]] = 1
            memory.floats[PLACES["step_size"]] = 1.0
            memory.room("stops", 2)[:] = 1.0
            memory.first[0, :rows] = np.asarray(given)[:, :1]  # of lanes that only fill up a block
            if start is not None:
                memory.first[1, : len(start)] = start[:, :1]
        memory = self.memory
        memory.cells[:] = memory.fresh
        memory.state[:rows, :lanes] = given
        if start is not None:
            memory.start[: len(start), :lanes] = start
        for i, name in enumerate(self.kernel.run_constants):
            self.constants[i] = values.get(name, 0.0)
        memory.integers[PLACES["last"]] = -(-lanes // width)
        self.kernel.run(memory.address)

    def made(self, lanes: int) -> Array:
        """The numbers (k, L) that were made; NaN for none."""
        state = self.memory.state
        return np.where(state[self.alive, :lanes] > 0, state[: self.count, :lanes], np.nan)


def _of_coordinates(n: int, function: TrajectoryConstant) -> TrajectoryConstant:
    """A constant of a trajectory as a function of more numbers than the coordinates of its initial point."""
    return function if isinstance(function, RunConstant | LaneConstant) else lambda points: function(points[..., :n])


def events_key(functions: object) -> Hashable:
    """A key that event functions share if they are made at one place from the same values."""
    if isinstance(functions, FunctionType):
        place = id(functions.__code__), id(functions.__globals__)
        if not (functions.__dict__ or functions.__closure__ or functions.__defaults__ or functions.__kwdefaults__):
            return place
    elif isinstance(functions, list | tuple):
        return tuple(map(events_key, functions))
    marks = repr(getattr(functions, "direction", None)), repr(getattr(functions, "terminal", None))
    if isinstance(functions, FunctionType):
        with suppress(ValueError):  # of a cell that is not assigned yet
            cells = [cell.cell_contents for cell in functions.__closure__ or ()]
            inner = [*cells, *(functions.__defaults__ or ()), *(functions.__kwdefaults__ or {}).values()]
            return *place, *map(id, inner), *marks
    return id(functions), *marks


@final
class PlannedEvents:
    """The events of the calls of a plan."""

    def __init__(self, problem: Problem, step: Step, dimension: int) -> None:
        self.problem, self.step, self.dimension = problem, step, dimension
        self.n, self.lead = np.shape(problem.start)[-1], np.ndim(problem.start) - 1
        self.functions: Any = problem.options.events
        self.events: Events = Events(self.functions or [], problem.args)
        self.parts = Parts(self.functions if isinstance(self.functions, list | tuple) else [self.functions])
        self.at_points = self._at_points()
        self.in_steps: dict[int, PointCode | None] = {}
        self.nothing = EventLog(self.events.count, np.shape(problem.start)[:-1], self.n)

    def _traced(self, tape: Tape) -> tuple[Any, Any, GeneratorField, Events]:
        """Point, time, field and events on a tape."""
        args, field = self.problem.args, self.problem.field
        known = traced_args(tape, args, self.lead)
        m, t = Traced.inputs(tape, 0, self.n), Traced(tape, tape.input(self.n))
        return m, t, field if args is None else field.with_args(known), Events(self.functions, known)

    def _at_points(self) -> PointCode:
        """Code of the values and of the slopes along the flow, ahead and back, of all functions at (m, t)."""
        tape = Tape()
        m, t, field, events = self._traced(tape)
        x: Any = field.vector(m, t)
        whole, direction = (Traced(tape, tape.run_constant(name, 1.0)) for name in ("length", "direction"))
        size: Any = ROOT_EPS * np.minimum(length(m) / length(x), whole)
        values = [events.value(i, t, m) for i in range(events.count)]
        slopes = [
            (events.value(i, t + e, m + e * x) - value) / (inwards * size)
            for inwards in (1, -1) for e in [inwards * direction * size] for i, value in enumerate(values)
        ]  # fmt: skip
        return PointCode(tape, self.n, self.n + 1, [*values, *slopes])

    def _in_steps(self, i: int) -> PointCode:
        """Code of the zeros of g_i in a step, from its point, time, size, end, and values and slopes at both ends."""
        p, n, tape = self.problem, self.n, Tape()
        m, t, field, events = self._traced(tape)
        more: list[Any] = [Traced(tape, tape.input(n + k)) for k in range(1, 7)]
        h, after, start, end, ahead, back = more
        action = with_traced_frame(tape, p.action, self.step, np.asarray(p.start).reshape(-1, n), self.dimension)
        local = self.step.at(action, Generator(field, self.dimension), m, t[..., None])
        yes: Any = h == h
        step = StepProposal(local, t, m, h, after, m, yes, ~yes, p.options.nominal, {})

        def slope(i: int, place: object, value: object, inwards: int, here: object) -> Array:
            return ahead if inwards > 0 else back

        look = Look(step.position, slope, h, (t, m), (after, m), yes)
        outputs: list[Any] = []
        for here, s in events.zeros(i, look, start, end):
            s = np.where(here, s, 0)
            time, point = step.position(s)
            outputs += [here, s, time, *point]
        tape.required.append(Traced(tape, local.valid(h[..., None])).entry)
        return PointCode(tape, n, n + 7, outputs)

    def agrees(self, points: Array, times: Array) -> bool:
        """Whether the code has the values of the functions at points (..., N) of the run and times (...,)."""
        wanted = np.array(self.events.values(times, points)).reshape(self.events.count, -1)
        values = {"length": 1.0, "direction": 1.0, **arg_values(self.problem.args, self.lead)}
        self.at_points.run([*points.reshape(-1, self.n).T, times.reshape(-1)], values)
        made = self.at_points.made(times.size)[: self.events.count]
        return np.allclose(made, wanted, RTOL, RTOL * np.abs(wanted).max(initial=0))

    def __call__(self, path: Array, values: Mapping[str, Any]) -> EventLog | None:
        """The events on paths (N + 2, ..., j + 1) of points, times and sizes. None if one may end a run."""
        events, n = self.events, self.n
        places, code = path[: n + 1].reshape(n + 1, -1), self.at_points
        code.run(places, values)
        count, cells, row = places.shape[1], code.memory.cells, code.lanes
        firsts = (code.alive * row, *range(0, code.count * row, row))
        if count <= FEW and all([cells[i] * x > 0 for i in firsts for x in cells[i + 1 : i + count]]):  # noqa: C419
            return self.nothing  # no value and no slope changes its sign
        shape, path = path.shape[1:-1], path.reshape(n + 2, -1, path.shape[-1])
        log = EventLog(events.count, shape, n)
        g, ahead, back = code.made(count).reshape(3, events.count, *path.shape[1:])
        occurrences: list[Occurrence] = []
        starts, ends = g[..., :-1], g[..., 1:]
        same = starts * ends > 0
        turning = same & (starts * back[..., 1:] > 0) & (starts * ahead[..., :-1] < 0)
        t, y, sizes = path[n], path[:n].swapaxes(0, 1), path[n + 1, :, 1:]
        for i in range(events.count):
            start, end, turns = starts[i], ends[i], turning[i]
            for lane in np.flatnonzero(events.left(i, start[:, 0], end[:, 0])).tolist():
                occurrences.append(Occurrence(0, 0.0, i, lane, 0.0, t[lane, 0], y[lane, :, 0].copy(), False))
            some = (turns | events.crossed(i, start, end)).nonzero()
            if not len(some[0]):
                continue
            if i not in self.in_steps:
                self.in_steps[i] = None  # of what cannot be compiled
                with suppress(*FAILURES):
                    self.in_steps[i] = self._in_steps(i)
            locate, (b, j) = self.in_steps[i], some
            if locate is None:
                return None
            given = [*y[b, :, j].T, t[b, j], sizes[b, j], t[b, j + 1], start[some], end[some], ahead[i, b, j]]
            locate.run([*given, back[i, b, j + 1]], values, y[b, :, 0].T)
            if np.isnan(zeros := locate.made(len(b))).any():
                return None
            for here, s, time, *point in zeros.reshape(2, n + 3, -1):
                found = occurrences_of(i, here, s, time, np.transpose(point))
                occurrences += [x._replace(step=int(j[x.lane]), lane=int(b[x.lane])) for x in found]
        return None if log.record(occurrences, events.terminal) else log


def planned_events(problem: Problem, step: Step, dimension: int, made: Array) -> PlannedEvents | None:
    """The compiled events of calls like one with these points (..., N, k); None if they cannot be compiled."""
    try:
        events = PlannedEvents(problem, step, dimension)
        start, times = np.asarray(problem.start), np.full(made.shape[:-2], float(problem.span[0]))
        end = np.where(np.isfinite(made[..., -1]), made[..., -1], start)  # an ensemble may have no end in common
        return events if events.agrees(start, times) and events.agrees(end, times) else None
    except FAILURES:
        return None
