"""The run: the transitions that every trajectory makes, its state, progress and result."""

from __future__ import annotations

import logging
import time as wall
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path as File
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.base.disk import digest
from liehom.base.errors import ConvergenceError
from liehom.base.typing import Array, BooleanArray, IntegerArray, Real, Values, ValuesLike
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.fingerprint import events_by_name, fingerprint, stable_repr
from liehom.flow.action.space import Action
from liehom.flow.run import solution as files
from liehom.flow.run.check import Seen, gap_of
from liehom.flow.run.control import (
    ERROR_TERMS,
    MAX_SHRINK,
    SLACK,
    SizeLimits,
    first_size,
    fitted,
    judgement,
    size_for,
    tried_size,
    unsolvable,
    whole_lattice,
)
from liehom.flow.run.events import Events, Look
from liehom.flow.run.options import (
    CLOCK,
    CONE,
    END,
    EVENT,
    IMPLICIT,
    LINEAR,
    NOT_FINITE,
    PSI,
    TOO_MANY,
    TOO_SMALL,
    Options,
    Progress,
    Span,
    outcome,
)
from liehom.flow.run.records import EventLog, Path, Samples, StepStatistics
from liehom.flow.run.solution import DenseSolution, Solution
from liehom.flow.series.arrays import in_lanes
from liehom.flow.series.jet import Jet
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.step import Diagnostics, Generator, LocalStep, Step, length
from liehom.flow.tracing.array import Traced

# RunState, the part of a run that changes from step to step. Checkpoints save it, and after an interruption it is
# rolled back to the last whole step. Steps replace the arrays of the state and never write into them, so a snapshot
# needs no copies.

ARRAYS = ("t", "m", "active", "code", "ended_at", "h", "taken")
"""Attributes with one entry for each trajectory; also their names in a checkpoint."""


class Snapshot(NamedTuple):
    """A state between two steps: its arrays, and how much of the records belongs to it."""

    arrays: dict[str, Any]
    path_length: int
    statistics: dict[str, npt.NDArray[Any]]
    occurrences: IntegerArray
    event_rows: int
    samples_done: IntegerArray | None


@final
@dataclass(slots=True)
class RunState:
    """State of a run between two steps."""

    t: Array  # (...,); that of the start for trajectories that have ended
    m: Array  # (..., N), likewise
    active: BooleanArray  # which trajectories go on
    code: IntegerArray  # how they have ended: a code of `liehom.flow.run.options`
    ended_at: Array  # when they have ended
    h: Array  # proposed for the next step, positive; inf if there is no proposal yet
    taken: IntegerArray  # numbers of steps
    calls: int  # of psi
    event_values: list[Array]  # at (t, m)
    path: Path  # what was recorded so far, like the next three
    statistics: StepStatistics
    event_log: EventLog
    samples: Samples | None  # None without t_eval

    # -- interruptions -----------------------------------------------------------------------------------
    def snapshot(self) -> Snapshot:
        """The state as it is now, for `rollback`; nothing is copied."""
        kept = {name: getattr(self, name) for name in (*ARRAYS, "calls", "event_values")}
        done = None if self.samples is None else self.samples.done
        log = self.event_log
        return Snapshot(kept, len(self.path), self.statistics.arrays(), log.occurrences, len(log.rows), done)

    def rollback(self, snapshot: Snapshot) -> None:
        """Undo what an interrupted step has done since the snapshot."""
        for name, value in snapshot.arrays.items():
            setattr(self, name, value)
        self.path.cut(snapshot.path_length)
        self.event_log.occurrences = snapshot.occurrences
        del self.event_log.rows[snapshot.event_rows :]
        self.statistics.restore(snapshot.statistics)
        if self.samples is not None and snapshot.samples_done is not None:
            self.samples.done = snapshot.samples_done

    # -- checkpoints -------------------------------------------------------------------------------------
    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """All that `restore` needs, as named arrays: the content of a checkpoint."""
        arrays = {name: np.asarray(getattr(self, name)) for name in (*ARRAYS, "calls")}
        arrays |= {f"before_{i}": g for i, g in enumerate(self.event_values)}
        for part, record in self._records().items():
            arrays |= {f"{part}_{name}": value for name, value in record.arrays().items()}
        return arrays

    def restore(self, arrays: dict[str, npt.NDArray[Any]]) -> None:
        """Replace the state by the content of a checkpoint, bit for bit."""
        for name in ARRAYS:
            setattr(self, name, arrays[name])
        self.calls = int(arrays["calls"])
        self.event_values = [arrays[f"before_{i}"] for i in range(len(self.event_values))]
        for part, record in self._records().items():
            start = f"{part}_"
            record.restore({name[len(start) :]: x for name, x in arrays.items() if name.startswith(start)})

    def _records(self) -> dict[str, Path | StepStatistics | EventLog | Samples]:
        """The records by the names that they have in checkpoints."""
        samples = {} if self.samples is None else {"samples": self.samples}
        return {"path": self.path, "account": self.statistics, "found": self.event_log, **samples}


# The transitions that every trajectory (lane) of a run makes, written once.
# 1. Propose: the step at (t, m), as a function of its size (`Step.at`).
# 2. Size: by the tolerance, `LocalStep.size` or the size that the last estimate left.
# 3. Fit: shortened so that it ends at the end of the time span.
# 4. Judge: by its point, `LocalStep.estimate` and `LocalStep.valid`. A lane that rejects its step tries a smaller one.
# 5. Look: events in it are recorded, and a terminal one shortens it.
# 6. Commit: time, point, path, samples, diagnostics.
# 7. End: at the end, at a terminal event, or by a failure, with its code.
# All lanes make them together, each with its own time, step size and time reparametrization τ (its "clock": a step of
# size h takes the time τ(h)). A lane that has ended takes steps of size 0 from its initial point, where psi is known to
# be finite. A step is asked for nothing but the methods of `LocalStep`.

LOGGER = logging.getLogger("liehom.flow.propagation")  # one line at level DEBUG for each step and each failure of a run
MAX_MOVE_WITH_EVENTS = 0.5
"""With events, an adaptive step moves a point by at most |m| times this, so that g has few extrema in it."""


@final
@dataclass(frozen=True, slots=True)
class StepProposal:
    """A step of all lanes before it is committed."""

    local: LocalStep
    t: Array  # times and points before the step
    m: Array
    h: Array  # signed sizes; 0 for lanes that do not move
    after: Array  # times and points after the step
    reached: Array
    moves: BooleanArray  # which lanes move, and for which the step ends at the end of the time span
    last: BooleanArray
    nominal: bool  # whether time advances by the size of the step, not by its clock τ
    diagnostics: Diagnostics

    def log(self, active: BooleanArray) -> None:
        """Log times, sizes, and the numbers of active lanes that accept and reject the step."""
        t, h = (x[self.moves] for x in (self.t, self.h))
        ranges = "".join(f", {n} {x.min():.17g} to {x.max():.17g}" for n, x in (("t", t), ("h", h)) if x.size)
        LOGGER.debug("step: %d accepted, %d rejected%s", self.moves.sum(), (active & ~self.moves).sum(), ranges)

    def position(self, s: Array) -> tuple[Array, Array]:
        """(t, y) within the step at the size s (...,)."""
        passed = s if self.nominal else self.local.time(s)
        low, high = np.minimum(self.t, self.after), np.maximum(self.t, self.after)
        t = np.where(s == self.h, self.after, np.clip(self.t + passed, low, high))
        y: Any = self.local.point(s[..., None])
        y = y if isinstance(y, Traced) else np.asarray(y)
        return t, y

    def point(self, time: Array, here: BooleanArray) -> Array:
        """The points (..., N) at a time within the step, for the lanes `here`."""
        elapsed = np.where(here, time - self.t, 0)
        s = elapsed if self.nominal else size_for(self.local, elapsed, np.where(here, self.h, 0))
        return self.position(np.where(here & (time == self.after), self.h, s))[1]


@final
class CountedField(GeneratorField):
    """The field of a run: its psi counts its calls, notes errors of linear algebra, and is 0 at fixed points."""

    __slots__ = ("_moving", "_run")

    def __init__(self, field: GeneratorField, run: Run, orbit_dimension: int | IntegerArray) -> None:
        # the maps of the field are shared, not computed again
        self.representation, self.source = field.representation, field._components
        self._action, self._components, self._dimension = field._action, field._components, field._dimension
        self.time_dependent, self._sites, self._run = field.time_dependent, field.sites, run
        # round-off does not move points that the group fixes
        moving = np.asarray(orbit_dimension) > 0
        self._moving: Array | None = None if moving.all() else np.where(moving, 1.0, 0.0).astype(run.dtype)[..., None]

    def psi(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The generator at m (..., N) and t: an array or Jet of shape (..., r)."""
        self._run.calls += 1
        try:
            x = in_lanes(super().psi(m, t if self.time_dependent else 0.0))
            return x if self._moving is None else x * self._moving
        except np.linalg.LinAlgError:
            self._run.psi_raised = bool(np.isfinite(m.value if isinstance(m, Jet) else m).all())
            raise


@final
class Run:
    """An integration: what is integrated, its `state`, the loop over steps, and the transitions of the lanes."""

    def __init__(self, action: Action, psi: Generator, step: Step, span: Span, start: Array, options: Options) -> None:
        self.action, self.options, self.span = action, options, span
        self.calls, self.psi_raised, self.axes = 0, False, len(psi.field.sites)
        self.start, self.shape, self.dtype = in_lanes(start), start.shape[:-1], start.dtype
        self.field: GeneratorField = psi.field
        field = CountedField(psi.field, self, psi.orbit_dimension)
        self.psi: Generator = Generator(field, psi.orbit_dimension, start)
        self.direction = self.dtype.type(1 if span[1] >= span[0] else -1)
        self.tried: tuple[LocalStep, Array] | None = None  # the last step that was proposed, and its sizes
        # below this time nothing is left
        self.rest = self.dtype.type(8 * np.finfo(self.dtype).eps * max(abs(span[0]), abs(span[1])))
        self.tiny = max(float(self.rest), options.least_step)  # the smallest step size
        self.looked: Diagnostics = {}  # what the last step was checked by
        self.seen: Seen | None = None  # a look of the last step at its point
        self.limits: SizeLimits = SizeLimits(
            options.rtol, options.atol, options.max_step, span[1], self.direction, self.tiny,
            gap=gap_of(options.looks, span[1] - span[0], psi.field),
            moves=np.inf if options.events is None else MAX_MOVE_WITH_EVENTS,
        )  # fmt: skip
        self.keeps: bool = options.t_eval is None or options.dense_output
        self.logs = LOGGER.isEnabledFor(logging.DEBUG)  # asked once: a run without a log pays nothing for it
        self.step = step.prepare(action, self.psi, self.start, np.full(self.shape, span[0], dtype=self.dtype))
        self.events = None if options.events is None else Events(options.events, psi.field.args)
        self.total: Array | None = None  # steps of fixed size up to the end (...,)
        if options.dt is not None:  # a rest below 1e-9 dt, or below round-off, is not a step
            self.total = np.maximum(np.ceil(abs(span[1] - span[0]) / options.dt - (SLACK + self.rest / options.dt)), 1)
        self.fast_path: Callable[[Run], bool] | None = None  # makes steps; returns whether there are more to be made
        self.engines: dict[str, None] = {}  # what has made steps, in order
        self.state: RunState = self._initial_state(start)

    # -- the transitions ---------------------------------------------------------------------------------
    def advance(self, now: RunState) -> None:
        """Make one step of all active lanes, which some of them may reject."""
        active, self.tried = now.active, None
        now.m = in_lanes(now.m)
        terms = ERROR_TERMS if self.options.dt is None else 0
        try:
            local = self.step.at(self.action, self.psi, now.m, now.t[..., None], error_terms=terms)
            proposal = self._proposed(now, local)
        except (np.linalg.LinAlgError, ConvergenceError) as error:
            if np.array_equal(active, now.active):  # else the step is tried again without those that failed
                self._diagnose(now, error)
        else:
            if self.logs:
                proposal.log(now.active)
            if proposal.moves.any():
                self._commit(now, *self._looked_into(now, proposal))
        now.calls, self.calls = now.calls + self.calls, 0

    def _proposed(self, now: RunState, local: LocalStep) -> StepProposal:
        """The step of the right size, of the lanes that accept it."""
        adaptive = self.options.dt is None
        size = self._size(now, local) if self.options.dt is None else self.options.dt
        h, after, last = self._fitted(now, local, size)
        self.tried = local, h
        seen = self.seen
        known = seen is not None and h.dtype == seen.size.dtype and (h == seen.size).all()
        reached: Any = seen.point if seen is not None and known else local.point(h[..., None])
        moves = now.active
        if adaptive:
            accepted, now.h = judgement(self.limits, local, now.m, h[..., None], self.axes)
            moves = moves & accepted
        diagnostics = {**local.diagnostics(h[..., None]), **self.looked}
        good = np.isfinite(reached).all(axis=-1)
        usable = ~whole_lattice(~(good & local.valid(h[..., None])), self.axes)
        if not usable.all():
            if adaptive:
                now.h = np.where(usable, now.h, np.abs(h) * MAX_SHRINK)
            else:
                self._fail_by_psi(now, moves & ~usable, np.where(good, IMPLICIT, NOT_FINITE))
            moves = moves & usable
        if not moves.all():
            h, after = np.where(moves, h, 0), np.where(moves, after, now.t)
            reached = np.where(moves[..., None], reached, now.m)
        reached = reached.astype(self.dtype, copy=False)
        return StepProposal(local, now.t, now.m, h, after, reached, moves, last, self.options.nominal, diagnostics)

    def _size(self, now: RunState, local: LocalStep) -> Array:
        """The step size that the tolerance asks for, positive, (...,)."""
        limits = self.limits
        if local.estimate_order is not None and np.isinf(now.h).any():
            now.h = np.where(np.isinf(now.h), first_size(limits, local, self.psi, now.m, now.t), now.h)
        h, good, looks, cuts, seen = tried_size(
            limits, self.action, self.psi, local, self.step.order, now.m, now.t, now.h, self.psi.field
        )
        self.seen = seen if local.looks_ahead else None
        h = np.asarray(h).astype(self.dtype)
        self.looked = {"looks": (looks, "sum"), "cuts": (cuts, "sum")}
        small = now.active & ~good
        if small.any():
            self._fail(now, small & np.isnan(h), PSI)
            self._fail_by_psi(now, small, TOO_SMALL)
            h = np.where(now.active, h, 0)
        return h

    def _fitted(self, now: RunState, local: LocalStep, size: Array) -> tuple[Array, Array, BooleanArray]:
        """Signed step sizes that do not pass the end, the times after them, and which steps are the last."""
        h = self.direction * np.where(now.active, size, 0).astype(self.dtype)
        left = self.span[1] - now.t
        if not self.options.nominal and local.clock:
            h, passed, last, runs = fitted(local, h, left, halve=self.total is None)
            if not runs.all():
                self._fail_by_psi(now, now.active & ~runs, np.where(local.is_near_cone(h), CONE, CLOCK))
                h, passed = np.where(now.active, h, 0), np.where(now.active, passed, 0)
            after, last = now.t + passed, last & now.active
            return h, np.where(last, self.span[1], after) if last.any() else after, last
        dt = self.options.dt
        if dt is None or self.total is None:
            last = now.active & (self.direction * (left - h) <= SLACK * np.abs(h))
            after = now.t + h
        else:  # by counting, so that round-off does not add up
            count = now.taken + 1
            last = now.active & (count >= self.total)
            after = self.span[0] + count * (self.direction * dt)
        if last.any():
            h, after = np.where(last, left, h), np.where(last, self.span[1], after)
        return h, after, last

    def _looked_into(self, now: RunState, proposal: StepProposal) -> tuple[StepProposal, BooleanArray]:
        """The step, shortened at a terminal event, and for which lanes it is; the events are recorded."""
        now.statistics.take(proposal.diagnostics, proposal.local, now.t, now.m, proposal.moves)
        events = self.events
        if events is None:
            return proposal, np.zeros(self.shape, dtype=bool)
        values = events.values(proposal.after, proposal.reached)
        ends = (proposal.t, proposal.m), (proposal.after, proposal.reached)
        look = Look(proposal.position, partial(self._slope, events), proposal.h, *ends, proposal.moves)
        stop, halted = events.record(now.event_log, look, now.event_values, values, now.taken == 0)
        before = now.event_values
        now.event_values = [np.where(proposal.moves, v, g) for v, g in zip(values, before, strict=True)]
        if not halted.any():
            return proposal, halted
        t, y = proposal.position(np.where(halted, stop, 0))
        after, reached = np.where(halted, t, proposal.after), np.where(halted[..., None], y, proposal.reached)
        return replace(proposal, h=np.where(halted, stop, proposal.h), after=after, reached=reached), halted

    def _slope(
        self, events: Events, i: int, place: tuple[Array, Array], value: Array, inwards: int, here: BooleanArray
    ) -> Array:
        """Derivative of event function i along the flow (`Look.slope`), by a difference over points of the path."""
        t, y = place
        x = self.psi(y, t[..., None])
        scale = length(y) / length(self.field.infinitesimal(x, y))
        size = np.sqrt(np.finfo(self.dtype).eps) * np.minimum(scale, abs(self.span[1] - self.span[0]))
        e = np.where(here, inwards * self.direction * size, 0)
        ahead = events.value(i, t + e, np.asarray(self.action.act(e[..., None] * x, y)))
        return (ahead - value) / np.where(here, inwards * size, 1)

    def _commit(self, now: RunState, proposal: StepProposal, halted: BooleanArray) -> None:
        """Make the step, with its samples, and end the lanes whose last one it is."""
        if now.samples is not None:
            now.samples.fill(proposal.point, proposal.after, proposal.moves)
        now.t, now.m = proposal.after, proposal.reached
        now.taken = now.taken + proposal.moves
        if self.keeps:
            now.path.add(now.t, now.m, proposal.h, proposal.moves)
        done = proposal.moves & (proposal.last | halted)
        if done.any():
            self.stop(now, done & ~halted, END)
            self.stop(now, halted, EVENT)
        if np.max(now.taken) >= self.options.max_steps:
            self._fail(now, now.taken >= self.options.max_steps, TOO_MANY)

    # -- the ends ----------------------------------------------------------------------------------------
    def stop(self, now: RunState, where: BooleanArray, code: int | IntegerArray) -> None:
        """End lanes: from now on they stay at their initial points."""
        now.code = np.where(where, code, now.code)
        now.ended_at = np.where(where, now.t, now.ended_at)
        now.active = now.active & ~where
        now.t, now.m = np.where(where, self.span[0], now.t), np.where(where[..., None], self.start, now.m)

    def _fail(self, now: RunState, where: BooleanArray, code: int | IntegerArray) -> None:
        where = now.active & whole_lattice(where, self.axes)
        if where.any():
            if self.logs:
                LOGGER.debug("%d trajectories fail with code %s at t = %s", where.sum(), code, now.t[where])
            self.stop(now, where, code)

    def _fail_by_psi(self, now: RunState, where: BooleanArray, code: int | IntegerArray) -> None:
        """End lanes by a code; by `PSI` if psi is not finite at their points."""
        finite = np.isfinite(self.field.psi(now.m, now.t)).all(axis=-1)
        self._fail(now, where & ~finite, PSI)
        self._fail(now, where & finite, code)

    def _diagnose(self, now: RunState, error: Exception) -> None:
        """A step could not be computed: end the lanes that are the cause, or halve their step sizes."""
        if self.psi_raised:
            raise error
        bad = now.active & ~np.isfinite(self.field.psi(now.m, now.t)).all(axis=-1)
        if isinstance(error, np.linalg.LinAlgError) and not bad.any():
            series = flow_series(self.field, now.m, self.step.order + ERROR_TERMS, now.t)
            points = [series.point(k) for k in range(series.points.order + 1)]
            bad = now.active & ~np.isfinite(points).all(axis=(0, -1))
        if bad.any():
            self._fail(now, bad, PSI)
            return
        code = IMPLICIT if isinstance(error, ConvergenceError) else LINEAR
        if self.tried is None:
            self._fail(now, now.active, code)
            return
        where = now.active & unsolvable(*self.tried, now.active, error)
        sizes = np.abs(self.tried[1])
        now.h = np.where(where, sizes / 2, now.h)
        self._fail(now, where & ((self.total is not None) | (sizes <= 2 * self.tiny)), code)

    # -- the state ---------------------------------------------------------------------------------------
    def _initial_state(self, start: Array) -> RunState:
        options, span, events = self.options, self.span, self.events
        t = np.full(self.shape, span[0], dtype=self.dtype)
        times, samples = options.t_eval, None
        if times is not None:
            samples = Samples(times, span[0], start, float(self.direction))
        calls, self.calls = self.calls, 0
        return RunState(
            t=t, m=self.start, active=np.full(self.shape, bool(span[0] != span[1])),
            code=np.zeros(self.shape, dtype=int), ended_at=t,
            h=np.full(self.shape, options.first_step or np.inf, dtype=self.dtype),
            taken=np.zeros(self.shape, dtype=int), calls=calls,  # of the preparation of the step
            event_values=events.values(t, self.start) if events else [], path=Path(t, self.start),
            statistics=StepStatistics(self.step, self.shape),
            event_log=EventLog(events.count if events else 0, self.shape, start.shape[-1]), samples=samples,
        )  # fmt: skip

    # -- the loop ----------------------------------------------------------------------------------------
    def execute(self, show: bool | Callable[[float], object], path: File | None) -> Solution:
        """Integrate to the end, with progress and checkpoints; returns the solution."""
        state = self.state
        with Progress(show) as progress:
            mark = "" if path is None else self._fingerprint()
            if path is not None and path.exists():
                state.restore(files.load(path, mark))
            snapshot, due = state.snapshot(), wall.monotonic() + self.options.checkpoint_every
            try:
                while state.active.any():
                    if self.fast_path is None or not self.fast_path(self):
                        self.engines["numpy"] = None
                        self.advance(state)
                    if path is not None:
                        snapshot = state.snapshot()
                    progress.update(self.fraction)
                    if path is not None and wall.monotonic() >= due:
                        begin = wall.monotonic()
                        files.save(path, mark, state.arrays())
                        # a long history takes long to write: at most a tenth of the time goes into it
                        cost = wall.monotonic() - begin
                        due = begin + cost + max(self.options.checkpoint_every, 10 * cost)
            except BaseException:
                if path is not None:
                    state.rollback(snapshot)
                    files.save(path, mark, state.arrays())
                raise
            progress.update(lambda: 1.0, last=True)
            solution = self._solution()
        if path is not None and solution.status != -1:
            path.unlink(missing_ok=True)
        return solution

    def _fingerprint(self) -> str:
        """String that distinguishes this problem from others: what was given by name, and values of psi."""
        o, events, field = self.options, self.events, self.field
        functions = {"step": self.step, "exponential": self.action.exponential} | events_by_name(o.events)
        numbers = [0 if x is None else x for x in (o.dt, o.t_eval)]
        text = f"{stable_repr(self.step)} {self.action.exponential.name} {o.fixed_text()}"
        others, look = {"options": digest(text, *numbers), "events": ""}, None
        if events is not None:
            others["events"] = digest(f"{events.directions} {events.terminal}", *self.state.event_values)
            look = partial(events.values, self.state.t, self.start)
        return fingerprint(self.action, field, self.start, self.span, functions, others, look)

    def fraction(self) -> float:
        """How much of the time span the slowest trajectory has passed."""
        passed = np.min(np.abs(self.state.t - self.span[0]), where=self.state.active, initial=np.inf)
        length = float(abs(self.span[1] - self.span[0])) or 1.0
        return float(min(passed / length, 1.0))

    # -- the result --------------------------------------------------------------------------------------
    def _solution(self) -> Solution:
        o, now = self.options, self.state
        times, points, sizes = now.path.compact()
        psi = Generator(self.field, self.psi.orbit_dimension, self.start)
        dense = partial(DenseSolution, self.action, psi, self.step, times, points, sizes, nominal=o.nominal)
        if now.samples is None:
            t, y = np.moveaxis(times, 0, -1), np.moveaxis(points, 0, -1)
        else:
            t, y = now.samples.times, now.samples.points
            if not self.shape:
                t, y = t[: int(now.samples.done)], y[..., : int(now.samples.done)]
        t_events, y_events = now.event_log.lists() if self.events is not None else (None, None)
        record, direction = now.statistics, float(self.direction)
        # sizes by the tolerance are those of the order that a step has: the order is not what such a run promises
        unkept = record.unkept_from if o.dt is not None else np.full(self.shape, np.nan)
        ended = outcome(now.code, now.ended_at, unkept, direction, self.step.order, record.loss)
        report = record.report(
            self.action, o.clock, self.psi.orbit_dimension, direction, ended.stopped_at,
            check=o.check(self.field.time_dependent), engine=", ".join(self.engines),
        )  # fmt: skip
        solution = Solution(
            t=t, y=y, sol=dense() if o.dense_output else None, t_events=t_events, y_events=y_events, nfev=now.calls,
            status=ended.status, message=ended.message, n_steps=now.taken if self.shape else int(now.taken),
            report=report, statuses=ended.statuses if self.shape else ended.status,
        )  # fmt: skip
        if self.keeps:
            object.__setattr__(solution, "_steps", dense)  # for `interpolant`
        return solution
