"""Run: the loop of `integrate` over the steps of one trajectory or an ensemble.

All trajectories are stepped together, each with its own time, clock and step size.  One that has ended takes steps of
size 0 from its start, where psi is known to be finite.
With compiled code, runs of plain steps are made ahead by it, and the steps between them here.
"""

from __future__ import annotations

import time as wall
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path as File
from typing import Any, final

import numpy as np

from liehom.correctors.conserving.conserving import ConservingStep
from liehom.correctors.expansion import flow_series
from liehom.correctors.isotropy.corrected import CorrectedStep
from liehom.correctors.step import Generator, LocalStep, Step, apply_factors
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators.run import checkpoint as files
from liehom.integrators.run import state
from liehom.integrators.run.clock import SLACK, fitted, has_clock, size_for
from liehom.integrators.run.control import (
    ERROR_TERMS,
    GROWTH,
    SMALLEST_SHRINK,
    Tolerance,
    defects_of,
    is_large_enough,
    judged,
    largest_size,
    length,
    size_from_defects,
    time_scale,
    unsolvable,
)
from liehom.integrators.run.dense import DenseSolution
from liehom.integrators.run.events import Events
from liehom.integrators.run.options import (
    CLOCK,
    END,
    EVENT,
    IMPLICIT,
    LINEAR,
    MESSAGES,
    NOT_FINITE,
    PSI,
    TOO_MANY,
    TOO_SMALL,
    Options,
)
from liehom.integrators.run.path import Path
from liehom.integrators.run.progress import Progress
from liehom.integrators.run.records import Account, Found, Samples
from liehom.integrators.run.solution import Solution
from liehom.series.arrays import in_lanes
from liehom.series.jet import Jet

FIRST = 0.01
WITH_EVENTS = 0.5
"""Events are seen at the ends of steps: where there are some, a step moves a point by at most half its size."""


@final
@dataclass(frozen=True, slots=True)
class Move:
    """A step that is made: parameter h, time and point after it, where it is made and where it is the last."""

    local: LocalStep
    h: Any
    after: Any
    made: Any
    moves: Any
    last: Any


@final
class Run:
    """The state of an integration and its loop.

    Parameters
    ----------
    action : Action
    psi : Generator
    step : Step
    span : (float, float)
    start : array of shape (..., N)
    options : Options
    """

    def __init__(
        self, action: Action, psi: Generator, step: Step, span: tuple[Any, Any], start: Any, options: Options
    ) -> None:
        self.action, self.step, self.options = action, step, options
        self.calls, self.psi_raised = 0, False
        self.field = psi.field
        self.psi = Generator(self._counted(psi.field), psi.orbit_dimension, start)
        self.span, self.start, self.shape, self.dtype = span, in_lanes(start), start.shape[:-1], start.dtype
        self.end, self.direction = span[1], self.dtype.type(1 if span[1] >= span[0] else -1)
        self.t, self.m = np.full(self.shape, span[0], dtype=self.dtype), self.start
        self.active = np.full(self.shape, bool(span[0] != span[1]))
        self.code = np.zeros(self.shape, dtype=int)
        self.ended_at = self.t
        self.h = np.full(self.shape, options.first_step or np.inf, dtype=self.dtype)
        self.taken = np.zeros(self.shape, dtype=int)
        self.tried: tuple[LocalStep, Any] | None = None
        self.tolerance = Tolerance(options.rtol, options.atol)
        self.tiny = 8 * np.finfo(self.dtype).eps * max(abs(span[0]), abs(span[1]))
        self.total = None if options.dt is None else self._number_of_steps(options.dt)
        self.account = Account(step, self.shape)
        self.events = None if options.events is None else Events(options.events)
        self.found = Found(self.events.count if self.events else 0, self.shape, start.shape[-1])
        self.before = self.events.values(self.t, self.m) if self.events else []
        self.samples: Samples | None = None
        if options.t_eval is not None:
            self.samples = Samples(options.t_eval, start.shape, self.dtype, float(self.direction))
            self.samples.start(span[0], start)
        self.path = Path(self.t, self.m)
        self.ahead: Callable[[Run], bool] | None = None
        self.keeps = options.t_eval is None or options.dense_output

    def _counted(self, field: GeneratorField) -> GeneratorField:
        def psi(m: Any, t: Any = 0.0) -> Any:
            self.calls += 1
            try:
                return in_lanes(field.psi(m, t))
            except np.linalg.LinAlgError:
                self.psi_raised = bool(np.isfinite(m.value if isinstance(m, Jet) else m).all())
                raise

        return GeneratorField(field.representation, psi, time_dependent=field.time_dependent)

    def _number_of_steps(self, dt: Any) -> Any:
        """How many steps of size dt reach the end; a rest below 1e-9 dt, or below round-off, is no step."""
        rest = SLACK + self.tiny / dt
        return np.maximum(np.ceil(abs(self.end - self.span[0]) / dt - rest), 1)

    # -- the loop ----------------------------------------------------------------------------------------
    def execute(self, show: bool | Callable[[float], Any], path: File | None) -> Solution:
        """Run to the end, with progress and checkpoints."""
        with Progress(show) as progress:
            if path is None:
                while self.active.any():
                    self._go_on()
                    progress.update(self._fraction)
            else:
                self._execute_with_checkpoints(progress, path)
            progress.update(lambda: 1.0, last=True)
            solution = self._solution()
        if path is not None and solution.success:
            files.remove(path)
        return solution

    def _execute_with_checkpoints(self, progress: Progress, path: File) -> None:
        fingerprint = state.fingerprint(self)
        if path.exists():
            state.restore(self, files.load(path, fingerprint))
        mark, due = state.mark(self), wall.monotonic() + self.options.checkpoint_every
        try:
            while self.active.any():
                self._go_on()
                mark = state.mark(self)
                progress.update(self._fraction)
                if wall.monotonic() >= due:
                    begin = wall.monotonic()
                    files.save(path, fingerprint, state.arrays(self))
                    # a long history takes long to write: at most a tenth of the time goes into it
                    cost = wall.monotonic() - begin
                    due = begin + cost + max(self.options.checkpoint_every, 10 * cost)
        except BaseException:
            state.back_to(self, mark)
            files.save(path, fingerprint, state.arrays(self))
            raise

    def _fraction(self) -> float:
        passed = np.min(np.abs(self.t - self.span[0]), where=self.active, initial=np.inf)
        whole = float(abs(self.end - self.span[0])) or 1.0
        return float(min(passed / whole, 1.0))

    def _go_on(self) -> None:
        """Plain steps ahead, for a while; where there are none to be made, one step of all active trajectories."""
        if self.ahead is None or not self.ahead(self):
            self.advance()

    def advance(self) -> None:
        """One step of all active trajectories."""
        active = self.active
        try:
            move = self._proposed()
        except (np.linalg.LinAlgError, ConvergenceError) as error:
            if np.array_equal(active, self.active):  # else the step is tried again without those that failed
                self._diagnose(error)
            return
        if not move.moves.any():
            return
        self.account.take(move.local, move.h, self.t, self.m, move.moves)
        halted = np.zeros(self.shape, dtype=bool)
        if self.events is not None:
            move, halted = self._watched(self.events, move)
        if self.samples is not None:
            self.samples.fill(lambda time, here: self._point(move, time, here), move.after, move.moves)
        self._commit(move, halted)

    def _proposed(self) -> Move:
        """A step of the right size, where it is accepted."""
        adaptive, self.tried = self.options.dt is None, None
        self.m = in_lanes(self.m)
        local = self.step.at(
            self.action, self.psi, self.m, self.t[..., None], error_terms=ERROR_TERMS if adaptive else 0
        )
        estimate = getattr(local, "estimate", None) if adaptive else None
        size = self._size(local, estimate is not None) if adaptive else self.options.dt
        h, after, last = self._fitted(local, size)
        self.tried = local, h
        made = apply_factors(self.action, local.factors(h[..., None]), self.m)
        moves = self.active
        if estimate is not None:
            moves = moves & self._judged(estimate(h[..., None]), h, local.estimate_order)  # type: ignore[attr-defined]
        elif adaptive:
            self.h = GROWTH * np.abs(h)
        inner = local.base if isinstance(local, ConservingStep) else local
        if isinstance(inner, CorrectedStep):
            _ = inner.correction.singular_value  # computed when it is asked for, and fails where psi is not finite
        good = np.isfinite(made).all(axis=-1)
        if not good.all():
            if adaptive:
                self.h = np.where(good, self.h, np.abs(h) * SMALLEST_SHRINK)
            else:
                self._fail_by_psi(moves & ~good, NOT_FINITE)
            moves = moves & good
        if not moves.all():
            h, after = np.where(moves, h, 0), np.where(moves, after, self.t)
            made = np.where(moves[..., None], made, self.m)
        return Move(local, h, after, made.astype(self.dtype, copy=False), moves, last)

    # -- step sizes --------------------------------------------------------------------------------------
    def _size(self, local: LocalStep, embedded: bool) -> Any:
        """The step size that the tolerance asks for, positive, (...,)."""
        left = np.abs(self.end - self.t)
        bound = largest_size(self.options.max_step, left)
        first = embedded and bool(np.isinf(self.h).any())
        scale = np.inf if embedded and not first and self.events is None else time_scale(self.psi.field, self.m, self.t)
        if self.events is not None:
            bound = np.minimum(bound, WITH_EVENTS * scale)
        if first:
            self.h = np.where(np.isinf(self.h), np.minimum(bound, FIRST * scale), self.h)
        h = np.minimum(self.h, bound)
        if not embedded:
            defects = defects_of(self.action, self.psi, local, self.m, self.t, self.step.order)
            speed = length(self.m) / scale
            h = size_from_defects(defects, self.tolerance.norm(self.m), speed, h).astype(self.dtype)
        small = self.active & ~is_large_enough(h, self.tiny, left)
        if small.any():
            self._fail(small & np.isnan(h), PSI)
            self._fail_by_psi(small, TOO_SMALL)
            h = np.where(self.active, h, 0)
        return h

    def _fitted(self, local: LocalStep, size: Any) -> tuple[Any, Any, Any]:
        """Signed step sizes that end at the end, the times after them, and which steps are the last."""
        h = self.direction * np.where(self.active, size, 0).astype(self.dtype)
        left = self.end - self.t
        if not self.options.nominal and has_clock(local):
            h, passed, last, runs = fitted(local, h, left, halve=self.total is None)
            if not runs.all():
                self._fail_by_psi(self.active & ~runs, CLOCK)
                h, passed = np.where(self.active, h, 0), np.where(self.active, passed, 0)
            after, last = self.t + passed, last & self.active
            return h, np.where(last, self.end, after) if last.any() else after, last
        if self.total is None:
            last = self.active & (self.direction * (left - h) <= SLACK * np.abs(h))
            after = self.t + h
        else:  # by counting, so that round-off does not add up
            count = self.taken + 1
            last = self.active & (count >= self.total)
            after = self.span[0] + count * (self.direction * self.options.dt)
        if last.any():
            h, after = np.where(last, left, h), np.where(last, self.end, after)
        return h, after, last

    def _judged(self, error: Any, h: Any, order: int) -> Any:
        """Where an embedded pair accepts the step; adapts the next step size."""
        accepted, self.h = judged(error, self.tolerance.norm(self.m), h, order)
        return accepted

    # -- events and samples ------------------------------------------------------------------------------
    def _position(self, move: Move, s: Any) -> tuple[Any, Any]:
        """(t, y) within a step at the parameter s (...,)."""
        passed = s if self.options.nominal else move.local.time(s)
        low, high = np.minimum(self.t, move.after), np.maximum(self.t, move.after)
        t = np.where(s == move.h, move.after, np.clip(self.t + passed, low, high))
        return t, apply_factors(self.action, move.local.factors(s[..., None]), self.m)

    def _point(self, move: Move, time: Any, here: Any) -> Any:
        """The point at a time within the step."""
        aim = np.where(here, time - self.t, 0)
        s = aim if self.options.nominal else size_for(move.local, aim, np.where(here, move.h, 0))
        return self._position(move, np.where(here & (time == move.after), move.h, s))[1]

    def _watched(self, events: Events, move: Move) -> tuple[Move, Any]:
        """Record events; where a terminal one occurs, the step is shortened."""
        values, before, moves = events.values(move.after, move.made), self.before, move.moves
        self.before = [np.where(moves, v, g) for v, g in zip(values, before, strict=True)]
        halted = np.zeros(self.shape, dtype=bool)
        crossed, where, stop = [], [], move.h
        for i, (start, end) in enumerate(zip(before, values, strict=True)):
            at_start = moves & (self.taken == 0) & events.left(i, start, end)
            if at_start.any():
                self.found.add(i, at_start, self.t, self.m, counted=False)
            here = moves & events.crossed(i, start, end)
            s = move.h
            if here.any():
                s = events.locate(i, lambda s: self._position(move, s), move.h, (start, end), here)
                ends = here & (self.found.occurrences[i] + 1 >= events.terminal[i])
                stop = np.where(ends & (np.abs(s) <= np.abs(stop)), s, stop)
                halted = halted | ends
            crossed.append(here)
            where.append(s)
        for i, (here, s) in enumerate(zip(crossed, where, strict=True)):
            kept = here & (np.abs(s) <= np.abs(stop))
            if kept.any():
                self.found.add(i, kept, *self._position(move, np.where(kept, s, 0)))
        if not halted.any():
            return move, halted
        t, y = self._position(move, np.where(halted, stop, 0))
        after, made = np.where(halted, t, move.after), np.where(halted[..., None], y, move.made)
        return Move(move.local, np.where(halted, stop, move.h), after, made, moves, move.last), halted

    # -- state -------------------------------------------------------------------------------------------
    def _commit(self, move: Move, halted: Any) -> None:
        self.t, self.m = move.after, move.made
        self.taken = self.taken + move.moves
        if self.keeps:
            self.path.add(self.t, self.m, move.h, move.moves)
        done = move.moves & (move.last | halted)
        if done.any():
            self._stop(done & ~halted, END)
            self._stop(halted, EVENT)
        if np.max(self.taken) >= self.options.max_steps:
            self._fail(self.taken >= self.options.max_steps, TOO_MANY)

    def _stop(self, where: Any, code: int) -> None:
        """End trajectories: from now on they rest at the start."""
        self.code = np.where(where, code, self.code)
        self.ended_at = np.where(where, self.t, self.ended_at)
        self.active = self.active & ~where
        self.t, self.m = np.where(where, self.span[0], self.t), np.where(where[..., None], self.start, self.m)

    def _fail(self, where: Any, code: int) -> None:
        where = self.active & where
        if where.any():
            self._stop(where, code)

    def _fail_by_psi(self, where: Any, code: int) -> None:
        """End trajectories, by a code of their own where psi is not finite."""
        finite = np.isfinite(self.field.psi(self.m, self.t)).all(axis=-1)
        self._fail(where & ~finite, PSI)
        self._fail(where & finite, code)

    def _diagnose(self, error: Exception) -> None:
        """A step could not be computed: find out for which trajectories, or take smaller steps."""
        if self.psi_raised:
            raise error
        bad = self.active & ~np.isfinite(self.field.psi(self.m, self.t)).all(axis=-1)
        if isinstance(error, np.linalg.LinAlgError) and not bad.any():
            series = flow_series(self.field, self.m, self.step.order + ERROR_TERMS, self.t)
            points = [series.point(k) for k in range(series.points.order + 1)]
            bad = self.active & ~np.isfinite(points).all(axis=(0, -1))
        if bad.any():
            self._fail(bad, PSI)
            return
        code = IMPLICIT if isinstance(error, ConvergenceError) else LINEAR
        if self.tried is None:
            self._fail(self.active, code)
            return
        where = self.active & unsolvable(*self.tried, self.active)
        sizes = np.abs(self.tried[1])
        self.h = np.where(where, sizes / 2, self.h)
        self._fail(where & ((self.total is not None) | (sizes <= 2 * self.tiny)), code)

    def _solution(self) -> Solution:
        o = self.options
        times, points, sizes = self.path.compact()
        dense = None
        if o.dense_output:
            psi = Generator(self.field, self.psi.orbit_dimension, self.start)
            dense = DenseSolution(self.action, psi, self.step, times, points, sizes, nominal=o.nominal)
        if self.samples is None:
            t, y = np.moveaxis(times, 0, -1), np.moveaxis(points, 0, -1)
        else:
            t, y = self.samples.times, self.samples.points
            if not self.shape:
                t, y = t[: int(self.samples.done)], y[..., : int(self.samples.done)]
        t_events, y_events = self.found.lists() if self.events is not None else (None, None)
        statuses = np.maximum(self.code, -1)
        worst = -1 if np.any(statuses < 0) else int(np.max(statuses, initial=0))
        return Solution(
            t=t,
            y=y,
            sol=dense,
            t_events=t_events,
            y_events=y_events,
            nfev=self.calls,
            status=worst,
            message=self._message(worst),
            n_steps=self.taken if self.shape else int(self.taken),
            report=self.account.report(self.action, "nominal" if o.nominal else "corrected", self.psi.orbit_dimension),
            statuses=statuses if self.shape else int(statuses),
        )

    def _message(self, status: int) -> str:
        if status >= 0:
            return MESSAGES[status]
        failed = np.argwhere(self.code < 0)
        index = tuple(int(i) for i in failed[0])
        message = f"{MESSAGES[int(self.code[index])]} At t = {float(self.ended_at[index]):.10g}"
        if self.shape:
            shown = index[0] if len(index) == 1 else index
            message += f", trajectory {shown}; {len(failed)} of {self.code.size} failed"
        return message + "."
