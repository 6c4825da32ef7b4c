"""Run: the loop of `integrate` over the steps of one trajectory or an ensemble.

All trajectories are stepped together, each with its own time, step size and time reparametrization τ (its "clock": a
step of size h takes the time τ(h)). A trajectory that has ended takes steps of size 0 from its initial point, where
psi is known to be finite. With compiled code, the fast path makes ordinary steps, those without an output time, an
end or a failure in them, and `Run.advance` makes the steps between.
"""

from __future__ import annotations

import time as wall
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path as File
from typing import Any, final

import numpy as np

from liehom.correctors.conserving import ConservingStep
from liehom.correctors.expansion import flow_series
from liehom.correctors.isotropy.corrected import CorrectedStep
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.disk import digest
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators.run import checkpoint as files
from liehom.integrators.run.clock import SLACK, fitted, has_clock
from liehom.integrators.run.control import (
    ERROR_TERMS,
    MAX_GROWTH,
    MAX_SHRINK,
    Tolerance,
    defects_of,
    is_large_enough,
    judged,
    largest_size,
    length,
    over_sites,
    size_from_defects,
    time_scale,
    unsolvable,
    whole_lattice,
)
from liehom.integrators.run.dense import DenseSolution
from liehom.integrators.run.events import Events
from liehom.integrators.run.options import (
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
    Span,
    outcome,
)
from liehom.integrators.run.progress import Progress
from liehom.integrators.run.proposal import LOGGER, StepProposal
from liehom.integrators.run.records import CorrectionStatistics, EventLog, Path, Samples, near_cone
from liehom.integrators.run.solution import Solution
from liehom.integrators.run.state import RunState
from liehom.pytrees import numbers_of
from liehom.series.arrays import in_lanes
from liehom.series.jet import Jet
from liehom.typing import Array, BooleanArray, IntegerArray, Real, Values

FIRST_STEP_FRACTION = 0.01
"""The first step of an embedded pair, in units of |m| / |X|."""
MAX_MOVE_WITH_EVENTS = 0.5
"""Events are noticed at the ends of steps, so with events an adaptive step moves a point by at most |m| times this."""


@final
class Run:
    """An integration: what is integrated, its `state`, and the loop over steps.

    Parameters
    ----------
    action : Action
    psi : Generator
    step : Step
    span : (float, float)
    start : array of shape (..., N)
    options : Options

    Attributes
    ----------
    state : RunState
        All that changes from step to step, except `tried` and `psi_raised`, which belong to one step.
    fast_path : callable or None
        Makes ordinary steps of the run by compiled code; returns whether there are more to be made.
    """

    action: Action
    step: Step
    options: Options
    span: Span
    start: Array
    shape: tuple[int, ...]
    dtype: np.dtype[np.float64]
    end: np.floating[Any]
    direction: np.float64
    tiny: np.float64

    def __init__(self, action: Action, psi: Generator, step: Step, span: Span, start: Array, options: Options) -> None:
        self.action, self.step, self.options = action, step, options
        self.psi_raised, self.axes = False, len(psi.field.sites)
        self.field: GeneratorField = psi.field
        self.psi: Generator = Generator(self._counted(psi.field), psi.orbit_dimension, start)
        self.span, self.start, self.shape, self.dtype = span, in_lanes(start), start.shape[:-1], start.dtype
        self.end, self.direction = span[1], self.dtype.type(1 if span[1] >= span[0] else -1)
        self.tried: tuple[LocalStep, Array] | None = None
        self.tolerance: Tolerance = Tolerance(options.rtol, options.atol, self.axes)
        self.tiny = 8 * np.finfo(self.dtype).eps * max(abs(span[0]), abs(span[1]))
        self.total: Array | None = None if options.dt is None else self._number_of_steps(options.dt)
        self.events: Events | None = None if options.events is None else Events(options.events)
        self.fast_path: Callable[[Run], bool] | None = None
        self.keeps: bool = options.t_eval is None or options.dense_output
        self.logs = LOGGER.isEnabledFor(10)  # DEBUG, asked once: a run without a log pays nothing for it
        self.state: RunState = self._initial_state(start)

    def _initial_state(self, start: Array) -> RunState:
        options, span = self.options, self.span
        t = np.full(self.shape, span[0], dtype=self.dtype)
        samples = None
        if options.t_eval is not None:
            samples = Samples(options.t_eval, start.shape, self.dtype, float(self.direction))
            samples.start(span[0], start)
        return RunState(
            t=t,
            m=self.start,
            active=np.full(self.shape, bool(span[0] != span[1])),
            code=np.zeros(self.shape, dtype=int),
            ended_at=t,
            h=np.full(self.shape, options.first_step or np.inf, dtype=self.dtype),
            taken=np.zeros(self.shape, dtype=int),
            calls=0,
            event_values=self.events.values(t, self.start) if self.events else [],
            path=Path(t, self.start),
            statistics=CorrectionStatistics(self.step, self.shape),
            event_log=EventLog(self.events.count if self.events else 0, self.shape, start.shape[-1]),
            samples=samples,
        )

    def _counted(self, field: GeneratorField) -> GeneratorField:
        """The field, with psi counted and its linear algebra errors noted."""

        def psi(m: Values, t: Real = 0.0) -> Values:
            self.state.calls += 1
            try:
                made: Values = in_lanes(field.psi(m, t))
            except np.linalg.LinAlgError:
                self.psi_raised = bool(np.isfinite(m.value if isinstance(m, Jet) else m).all())
                raise
            return made

        return GeneratorField(field.representation, psi, time_dependent=field.time_dependent, sites=field.sites)

    def _number_of_steps(self, dt: Array) -> Array:
        """Numbers of steps of size dt to the end; a rest below 1e-9 dt, or below round-off, is not a step."""
        rest = SLACK + self.tiny / dt
        return np.maximum(np.ceil(abs(self.end - self.span[0]) / dt - rest), 1)

    # -- the loop ----------------------------------------------------------------------------------------
    def execute(self, show: bool | Callable[[float], object], path: File | None) -> Solution:
        """Integrate to the end, with progress and checkpoints; returns the solution."""
        with Progress(show) as progress:
            if path is None:
                while self.state.active.any():
                    self._go_on()
                    progress.update(self._fraction)
            else:
                self._execute_with_checkpoints(progress, path)
            progress.update(lambda: 1.0, last=True)
            solution = self._solution()
        if path is not None and solution.status != -1:
            files.remove(path)
        return solution

    def _execute_with_checkpoints(self, progress: Progress, path: File) -> None:
        fingerprint, state = self._fingerprint(), self.state
        if path.exists():
            state.restore(files.load(path, fingerprint))
        snapshot, due = state.snapshot(), wall.monotonic() + self.options.checkpoint_every
        try:
            while state.active.any():
                self._go_on()
                snapshot = state.snapshot()
                progress.update(self._fraction)
                if wall.monotonic() >= due:
                    begin = wall.monotonic()
                    files.save(path, fingerprint, state.arrays())
                    # a long history takes long to write: at most a tenth of the time goes into it
                    cost = wall.monotonic() - begin
                    due = begin + cost + max(self.options.checkpoint_every, 10 * cost)
        except BaseException:
            state.rollback(snapshot)
            files.save(path, fingerprint, state.arrays())
            raise

    def _fingerprint(self) -> str:
        """Digest that distinguishes this problem from others: numbers, strings, psi at the start and next to it."""
        o, events, field = self.options, self.events, self.field
        strings = f"{files.stable_repr(self.step)} {self.action.exponential.name} {o.fixed_text()}"
        strings += "" if events is None else f" {events.directions} {events.terminal}"
        t, ahead = np.full(self.shape, self.span[0]), 1e-3 * (self.end - self.span[0])
        here = np.asarray(field.psi(self.start, t))
        near = self.action.act((ahead * here).astype(self.dtype), self.start)
        there = np.asarray(field.psi(near, t + ahead))
        numbers = [np.array(self.span), *(0 if x is None else x for x in (o.dt, o.t_eval)), *numbers_of(field.args)]
        numbers += [a.to_numpy() for a in field.representation.matrices]
        return digest(strings, self.start, *numbers, here, near, there, *self.state.event_values)

    def _fraction(self) -> float:
        passed = np.min(np.abs(self.state.t - self.span[0]), where=self.state.active, initial=np.inf)
        whole = float(abs(self.end - self.span[0])) or 1.0
        return float(min(passed / whole, 1.0))

    def _go_on(self) -> None:
        """Ordinary steps on the fast path; if there are none to be made, one step of all active trajectories."""
        if self.fast_path is None or not self.fast_path(self):
            self.advance()

    def advance(self) -> None:
        """Make one step of all active trajectories."""
        now = self.state
        active = now.active
        try:
            proposal = self._proposed()
        except (np.linalg.LinAlgError, ConvergenceError) as error:
            if np.array_equal(active, now.active):  # else the step is tried again without those that failed
                self._diagnose(error)
            return
        if self.logs:
            proposal.log(now.active)
        if not proposal.moves.any():
            return
        now.statistics.take(proposal.local, proposal.h, now.t, now.m, proposal.moves)
        halted = np.zeros(self.shape, dtype=bool)
        if self.events is not None:
            proposal, halted = self._watched(self.events, proposal)
        if now.samples is not None:
            now.samples.fill(proposal.point, proposal.after, proposal.moves)
        self._commit(proposal, halted)

    def _proposed(self) -> StepProposal:
        """A step of the right size, of the trajectories for which it is accepted."""
        now, adaptive, self.tried = self.state, self.options.dt is None, None
        now.m = in_lanes(now.m)
        local = self.step.at(self.action, self.psi, now.m, now.t[..., None], error_terms=ERROR_TERMS if adaptive else 0)
        estimate = getattr(local, "estimate", None) if adaptive else None
        size = self._size(local, estimate is not None) if self.options.dt is None else self.options.dt
        h, after, last = self._fitted(local, size)
        self.tried = local, h
        made: Any = local.point(h[..., None])
        moves = now.active
        if estimate is not None:
            moves = moves & self._judged(estimate(h[..., None]), h, local.estimate_order)  # type: ignore[attr-defined]
        elif adaptive:
            now.h = MAX_GROWTH * np.abs(h)
        inner = local.base if isinstance(local, ConservingStep) else local
        if isinstance(inner, CorrectedStep):
            _ = inner.correction.singular_value  # computed when it is asked for, and fails if psi is not finite
        good = ~whole_lattice(~np.isfinite(made).all(axis=-1), self.axes)
        if not good.all():
            if adaptive:
                now.h = np.where(good, now.h, np.abs(h) * MAX_SHRINK)
            else:
                self._fail_by_psi(moves & ~good, NOT_FINITE)
            moves = moves & good
        if not moves.all():
            h, after = np.where(moves, h, 0), np.where(moves, after, now.t)
            made = np.where(moves[..., None], made, now.m)
        made = made.astype(self.dtype, copy=False)
        return StepProposal(local, now.t, now.m, h, after, made, moves, last, self.options.nominal)

    # -- step sizes --------------------------------------------------------------------------------------
    def _size(self, local: LocalStep, embedded: bool) -> Array:
        """The step size that the tolerance asks for, positive, (...,)."""
        now = self.state
        left = np.abs(self.end - now.t)
        bound = largest_size(self.options.max_step, left)
        first = embedded and bool(np.isinf(now.h).any())
        needed = not embedded or first or self.events is not None
        scale = time_scale(self.psi.field, now.m, now.t) if needed else np.inf
        if self.events is not None:
            bound = np.minimum(bound, MAX_MOVE_WITH_EVENTS * scale)
        if first:
            now.h = np.where(np.isinf(now.h), np.minimum(bound, FIRST_STEP_FRACTION * scale), now.h)
        h = np.minimum(now.h, bound)
        if not embedded:
            found = defects_of(self.action, self.psi, local, now.m, now.t, self.step.order)
            defects = tuple((k, over_sites(d, self.axes)) for k, d in found)
            speed, allowed = over_sites(length(now.m), self.axes) / scale, self.tolerance.norm(now.m)
            h = size_from_defects(defects, allowed, speed, h).astype(self.dtype)
        small = now.active & ~is_large_enough(h, self.tiny, left)
        if small.any():
            self._fail(small & np.isnan(h), PSI)
            self._fail_by_psi(small, TOO_SMALL)
            h = np.where(now.active, h, 0)
        return h

    def _fitted(self, local: LocalStep, size: Array) -> tuple[Array, Array, BooleanArray]:
        """Signed step sizes that do not pass the end, the times after them, and which steps are the last."""
        now = self.state
        h = self.direction * np.where(now.active, size, 0).astype(self.dtype)
        left = self.end - now.t
        if not self.options.nominal and has_clock(local):
            h, passed, last, runs = fitted(local, h, left, halve=self.total is None)
            if not runs.all():
                self._fail_by_psi(now.active & ~runs, np.where(near_cone(local, h), CONE, CLOCK))
                h, passed = np.where(now.active, h, 0), np.where(now.active, passed, 0)
            after, last = now.t + passed, last & now.active
            return h, np.where(last, self.end, after) if last.any() else after, last
        dt = self.options.dt
        if dt is None or self.total is None:
            last = now.active & (self.direction * (left - h) <= SLACK * np.abs(h))
            after = now.t + h
        else:  # by counting, so that round-off does not add up
            count = now.taken + 1
            last = now.active & (count >= self.total)
            after = self.span[0] + count * (self.direction * dt)
        if last.any():
            h, after = np.where(last, left, h), np.where(last, self.end, after)
        return h, after, last

    def _judged(self, error: Array, h: Array, order: int) -> BooleanArray:
        """For which trajectories an embedded pair accepts the step; adapts the next step size."""
        accepted, self.state.h = judged(error, self.tolerance.norm(self.state.m), h, order, self.axes)
        return accepted

    # -- events -------------------------------------------------------------------------------------------
    def _watched(self, events: Events, proposal: StepProposal) -> tuple[StepProposal, BooleanArray]:
        """Record the events in a step; returns the step, shortened at a terminal event, and where it was."""
        now, log, moves = self.state, self.state.event_log, proposal.moves
        values, before = events.values(proposal.after, proposal.made), now.event_values
        now.event_values = [np.where(moves, v, g) for v, g in zip(values, before, strict=True)]
        halted = np.zeros(self.shape, dtype=bool)
        crossed, sizes, stop = [], [], proposal.h
        for i, (start, end) in enumerate(zip(before, values, strict=True)):
            at_start = moves & (now.taken == 0) & events.left(i, start, end)
            if at_start.any():
                log.add(i, at_start, now.t, now.m, counted=False)
            here = moves & events.crossed(i, start, end)
            s = proposal.h
            if here.any():
                s = events.locate(i, proposal.position, proposal.h, (start, end), here)
                ends = here & (log.occurrences[i] + 1 >= events.terminal[i])
                stop = np.where(ends & (np.abs(s) <= np.abs(stop)), s, stop)
                halted = halted | ends
            crossed.append(here)
            sizes.append(s)
        for i, (here, s) in enumerate(zip(crossed, sizes, strict=True)):
            kept = here & (np.abs(s) <= np.abs(stop))
            if kept.any():
                log.add(i, kept, *proposal.position(np.where(kept, s, 0)))
        if not halted.any():
            return proposal, halted
        t, y = proposal.position(np.where(halted, stop, 0))
        after, made = np.where(halted, t, proposal.after), np.where(halted[..., None], y, proposal.made)
        return replace(proposal, h=np.where(halted, stop, proposal.h), after=after, made=made), halted

    # -- the end of a step -------------------------------------------------------------------------------
    def _commit(self, proposal: StepProposal, halted: BooleanArray) -> None:
        now = self.state
        now.t, now.m, now.taken = proposal.after, proposal.made, now.taken + proposal.moves
        if self.keeps:
            now.path.add(now.t, now.m, proposal.h, proposal.moves)
        done = proposal.moves & (proposal.last | halted)
        if done.any():
            self._stop(done & ~halted, END)
            self._stop(halted, EVENT)
        if np.max(now.taken) >= self.options.max_steps:
            self._fail(now.taken >= self.options.max_steps, TOO_MANY)

    def _stop(self, where: BooleanArray, code: int | IntegerArray) -> None:
        """End trajectories: from now on they stay at their initial points."""
        now = self.state
        now.code = np.where(where, code, now.code)
        now.ended_at = np.where(where, now.t, now.ended_at)
        now.active = now.active & ~where
        now.t, now.m = np.where(where, self.span[0], now.t), np.where(where[..., None], self.start, now.m)

    def _fail(self, where: BooleanArray, code: int | IntegerArray) -> None:
        if (where := self.state.active & whole_lattice(where, self.axes)).any():
            if self.logs:
                LOGGER.debug("%d trajectories fail with code %s at t = %s", where.sum(), code, self.state.t[where])
            self._stop(where, code)

    def _fail_by_psi(self, where: BooleanArray, code: int | IntegerArray) -> None:
        """End trajectories by a code; by `PSI` if psi is not finite at their points."""
        finite = np.isfinite(self.field.psi(self.state.m, self.state.t)).all(axis=-1)
        self._fail(where & ~finite, PSI)
        self._fail(where & finite, code)

    def _diagnose(self, error: Exception) -> None:
        """A step could not be computed: end the trajectories that are the cause, or halve their step sizes."""
        if self.psi_raised:
            raise error
        now = self.state
        bad = now.active & ~np.isfinite(self.field.psi(now.m, now.t)).all(axis=-1)
        if isinstance(error, np.linalg.LinAlgError) and not bad.any():
            series = flow_series(self.field, now.m, self.step.order + ERROR_TERMS, now.t)
            points = [series.point(k) for k in range(series.points.order + 1)]
            bad = now.active & ~np.isfinite(points).all(axis=(0, -1))
        if bad.any():
            self._fail(bad, PSI)
            return
        code = IMPLICIT if isinstance(error, ConvergenceError) else LINEAR
        if self.tried is None:
            self._fail(now.active, code)
            return
        where = now.active & unsolvable(*self.tried, now.active)
        sizes = np.abs(self.tried[1])
        now.h = np.where(where, sizes / 2, now.h)
        self._fail(where & ((self.total is not None) | (sizes <= 2 * self.tiny)), code)

    # -- the result --------------------------------------------------------------------------------------
    def _solution(self) -> Solution:
        o, now = self.options, self.state
        times, points, sizes = now.path.compact()
        dense = None
        if o.dense_output:
            psi = Generator(self.field, self.psi.orbit_dimension, self.start)
            dense = DenseSolution(self.action, psi, self.step, times, points, sizes, nominal=o.nominal)
        t, y = np.moveaxis(times, 0, -1), np.moveaxis(points, 0, -1)
        if now.samples is not None:
            t, y = now.samples.times, now.samples.points
            if not self.shape:
                t, y = t[: int(now.samples.done)], y[..., : int(now.samples.done)]
        t_events, y_events = now.event_log.lists() if self.events is not None else (None, None)
        record, direction = now.statistics, float(self.direction)
        ended = outcome(now.code, now.ended_at, record.unkept_from, direction, self.step.order, record.loss)
        return Solution(
            t=t,
            y=y,
            sol=dense,
            t_events=t_events,
            y_events=y_events,
            nfev=now.calls,
            status=ended.status,
            message=ended.message,
            n_steps=now.taken if self.shape else int(now.taken),
            report=record.report(self.action, o.clock, self.psi.orbit_dimension, direction, ended.stopped_at),
            statuses=ended.statuses if self.shape else ended.status,
        )
