"""Events of compiled runs: machine code makes the steps of a call, then events are sought in all of them at once.

Event functions are evaluated at the ends of all steps of all lanes. The steps in which a zero is possible, by the rules
of `liehom.integrators.run.events`, are made again in numpy from their stored starts, and the zeros are located on their
dense output. A terminal event truncates what the machine code has made of its lane.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, final

import numpy as np

from liehom.correctors.step import Generator
from liehom.errors import InputError
from liehom.homogeneous import GeneratorField
from liehom.integrators.compiled.event_values import FAILURES, EventValues
from liehom.integrators.compiled.lanes import Made, times_until
from liehom.integrators.compiled.parameters import args_of_lanes
from liehom.integrators.run.automaton import StepProposal
from liehom.integrators.run.control import length
from liehom.integrators.run.events import Events, Look
from liehom.integrators.run.run import Run
from liehom.typing import Array, BooleanArray, IntegerArray

STEPS_AT_ONCE = 16_384
"""Steps that are made again at once, at most."""
ROOT_EPS = float(np.sqrt(np.finfo(np.float64).eps))


class Steps(NamedTuple):
    """The steps of some lanes, of each lane in order of time, one lane after the other.

    Attributes
    ----------
    row, column, lane : arrays of int of shape (p,)
        Where the step is stored, and its trajectory in the flattened ensemble.
    t, m, h : arrays of shape (p,), (p, N) and (p,)
        Time and point before the step, and its signed size.
    after, made : arrays of shape (p,) and (p, N)
        Time and point after it.
    first : bool array of shape (p,)
        Whether it is the first one of its lane.
    """

    row: IntegerArray
    column: IntegerArray
    lane: IntegerArray
    t: Array
    m: Array
    h: Array
    after: Array
    made: Array
    first: BooleanArray


class Occurrence(NamedTuple):
    """A zero of event function `event` at the size |s| within step number `step`, at (t, y)."""

    step: int
    distance: float
    event: int
    s: float
    t: Any
    y: Any
    counted: bool


@final
class EventSearch:
    """Looks for the events of a run in steps that a kernel has made.

    Parameters
    ----------
    run : Run

    Raises
    ------
    InputError
        If psi of an ensemble cannot be called for some of its trajectories.

    Examples
    --------
    >>> import liehom as lh
    >>> field, e = lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0])
    >>> sol = lh.integrate(field, (0, 4), e, dt=0.5, events=lambda t, y: y[0], engine="llvm")
    >>> sol.t_events[0].round(12).tolist()
    [1.570796326795]
    """

    def __init__(self, run: Run) -> None:
        self.run = run
        self.values = EventValues(run)
        self.start = run.start.reshape(-1, run.start.shape[-1])
        self.dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
        self.psi_at_once = not len(self.start) or self._psi_works_at_once()
        if not self.psi_at_once and run.shape:
            raise InputError(
                "engine='llvm' looks for events by calls of psi for some trajectories of the ensemble, and this psi "
                "cannot be called so: write it for points of shape (..., N), or take engine='numpy'"
            )

    @property
    def ends_runs(self) -> bool:
        """Whether an event is terminal."""
        return bool(np.isfinite(self.values.events.terminal).any())

    def _psi_works_at_once(self) -> bool:
        """Whether psi takes more points than there are trajectories, as arrays (..., N)."""
        lanes, points, field = self.values.trial_lanes, self.values.trial_points, self.run.field
        begin, shape = float(self.run.span[0]), self.run.shape
        try:
            found = np.asarray(self._field(lanes).psi(points, np.full(len(lanes), begin)))
            if shape:
                given = np.asarray(field.psi(self.run.start, np.full(shape, begin)))
                wanted = np.broadcast_to(given, (*shape, given.shape[-1])).reshape(len(self.start), -1)[lanes]
            else:
                wanted = np.array([field.psi(m, np.float64(begin)) for m in points])
            return bool(np.allclose(np.broadcast_to(found, wanted.shape), wanted, equal_nan=True))
        except FAILURES:
            return False

    def _field(self, lanes: IntegerArray) -> GeneratorField:
        """The field, with args of these lanes."""
        args = self.run.field.args
        return self.run.field if args is None else self.run.field.with_args(args_of_lanes(args, self.run.shape, lanes))

    # -- the search --------------------------------------------------------------------------------------
    def __call__(self, lanes: IntegerArray, before: tuple[Array, Array, IntegerArray], made: Made) -> Made:
        """Record the events in the steps of some lanes; returns the steps up to the terminal ones.

        Parameters
        ----------
        lanes : array of int of shape (L,)
        before : (times (L,), points (L, N), numbers of steps (L,))
            Before the steps.
        made : Made
            With a path.
        """
        steps = _listed(lanes, before, made)
        if not len(steps.row):
            return made
        events, count = self.values.of(steps.lane), self.values.events.count
        starts, ends = [], []
        now = self.run.state
        for i in range(count):
            end = self.values.checked(i, events, steps.after, steps.made, steps.lane)
            start = np.concatenate([end[:1], end[:-1]])
            start[steps.first] = now.event_values[i].reshape(-1)[steps.lane[steps.first]]
            starts.append(start)
            ends.append(end)
        fresh = steps.first & (before[2][steps.column] == 0)
        found: list[Occurrence] = []
        events = self.values.of(steps.lane)
        for i in range(count):
            possible = events.crossed(i, starts[i], ends[i]) | self._turns(i, steps, starts[i], ends[i])
            for p in np.flatnonzero(fresh & events.left(i, starts[i], ends[i])):
                found.append(Occurrence(int(p), 0.0, i, 0.0, steps.t[p], steps.m[p], counted=False))
            chosen = np.flatnonzero(possible)
            for k in range(0, len(chosen), STEPS_AT_ONCE):
                found += self._located(i, steps, chosen[k : k + STEPS_AT_ONCE], starts[i], ends[i])
        last = np.append(steps.first[1:], True)
        for i in range(count):
            new = np.array(now.event_values[i]).reshape(-1)
            new[steps.lane[last]] = ends[i][last]
            now.event_values = [new.reshape(self.run.shape) if k == i else g for k, g in enumerate(now.event_values)]
        halts = self._recorded(steps, sorted(found, key=lambda x: x[:3]))
        return _truncated(self.run, steps, before[2], halts, made) if halts else made

    def _turns(self, i: int, steps: Steps, start: Array, end: Array) -> BooleanArray:
        """Steps at whose ends g_i has one sign, and from which slopes lead towards 0."""
        sign = np.sign(start)
        turns: BooleanArray = np.zeros(len(sign), dtype=bool)
        some = np.flatnonzero(sign * end > 0)
        leaves = sign[some] * self._slopes(
            i, some, steps.lane[some], steps.after[some], steps.made[some], end[some], -1
        )
        some = some[leaves > 0]
        leaves = sign[some] * self._slopes(i, some, steps.lane[some], steps.t[some], steps.m[some], start[some], 1)
        turns[some[leaves < 0]] = True
        return turns

    def _slopes(
        self, i: int, some: IntegerArray, lanes: IntegerArray, t: Array, y: Array, value: Array, inwards: int
    ) -> Array:
        """Derivatives of g_i at places (t, y) of lanes, in the direction of integration (see `Look.slope`)."""
        if not len(some):
            return np.zeros(0)
        field, events = self._field(lanes), self.values.of(lanes)
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
        slope: Array = (events.value(i, t + e, y + e[..., None] * vector) - value) / (inwards * size)
        return slope

    def _located(self, i: int, steps: Steps, chosen: IntegerArray, start: Array, end: Array) -> list[Occurrence]:
        """The zeros of g_i in some steps, which are made again."""
        if self.psi_at_once:
            return self._zeros(i, steps, chosen, chosen, start, end)
        single: list[Occurrence] = []
        for p in chosen:
            single += self._zeros(i, steps, p, np.array([p]), start, end)
        return single

    def _zeros(
        self,
        i: int,
        steps: Steps,
        where: IntegerArray | np.integer[Any],
        chosen: IntegerArray,
        start: Array,
        end: Array,
    ) -> list[Occurrence]:
        """The zeros of g_i in the steps of numbers `chosen`; `where` is the same, or one number without an axis."""
        run, lanes = self.run, steps.lane[chosen]
        events = self.values.events if np.ndim(where) == 0 else self.values.of(lanes)
        field = self._field(lanes)
        own = self.start[steps.lane[where]]
        psi = Generator(field, self.dimensions[steps.lane[where]], own)
        t, m, h, after, made = (np.asarray(x[where]) for x in (steps.t, steps.m, steps.h, steps.after, steps.made))
        local = run.step.at(run.action, psi, m, t[..., None])
        yes = np.ones(h.shape, dtype=bool)
        step = StepProposal(local, t, m, h, after, made, yes, ~yes, run.options.nominal, {})

        def slope(i: int, place: tuple[Array, Array], value: Array, inwards: int, here: BooleanArray) -> Array:
            return self._slope(events, np.asarray(field.vector(place[1], place[0])), i, place, value, inwards)

        look = Look(step.position, slope, h, (t, m), (after, made), yes)
        found: list[Occurrence] = []
        for here, s in events.zeros(i, look, start[where], end[where]):
            times, points = step.position(np.where(here, s, 0))
            flat = [np.reshape(x, len(chosen)) for x in (here, s, times)]
            rows = np.reshape(points, (len(chosen), -1))
            for k in np.flatnonzero(flat[0]):
                size = float(flat[1][k])
                found.append(Occurrence(int(chosen[k]), abs(size), i, size, flat[2][k], rows[k], counted=True))
        return found

    def _recorded(self, steps: Steps, found: list[Occurrence]) -> Mapping[int, Occurrence]:
        """Record occurrences, in order of time in each lane, up to the terminal ones, which are returned by lane."""
        log, halts = self.run.state.event_log, dict[int, Occurrence]()
        counts = np.array(log.occurrences)
        flat, terminal = counts.reshape(len(counts), -1), self.values.events.terminal
        for x in found:
            lane = int(steps.lane[x.step])
            halt = halts.get(lane)
            if halt is not None and (x.step, x.distance) > (halt.step, halt.distance):
                continue
            log.rows.append((x.event, lane, x.t, x.y))
            flat[x.event, lane] += x.counted
            if x.counted and flat[x.event, lane] >= terminal[x.event]:
                halts.setdefault(lane, x)
        log.occurrences = counts
        return halts


def _listed(lanes: IntegerArray, before: tuple[Array, Array, IntegerArray], made: Made) -> Steps:
    """The steps of a path, lane by lane."""
    path: Any = made.path
    times, points, sizes = path
    column, row = np.nonzero(sizes.T)
    after, ends = times[row, column], np.ascontiguousarray(points[row, :, column])
    first = np.append(True, column[1:] != column[:-1])[: len(row)]
    t, m = np.concatenate([after[:1], after[:-1]]), np.concatenate([ends[:1], ends[:-1]])
    t[first], m[first] = before[0][column[first]], before[1][column[first]]
    return Steps(row, column, lanes[column], t, m, sizes[row, column], after, ends, first)


def _truncated(run: Run, steps: Steps, before: IntegerArray, halts: Mapping[int, Occurrence], made: Made) -> Made:
    """The steps up to the terminal events."""
    path: Any = made.path
    times, points, sizes = (np.array(x) for x in path)
    m, t, taken, until = made.m.copy(), made.t.copy(), made.taken.copy(), made.until.copy()
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
    going, done = made.going & ~halted, made.done & ~halted
    if run.state.samples is not None:
        until[halted] = times_until(run, t[halted])
    return made._replace(
        m=m, t=t, taken=taken, going=going, done=done, until=until, path=(times, points, sizes), halted=rows
    )
