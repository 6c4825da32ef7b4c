"""Run: an integration with its state, its progress, its checkpoints and its result.

The automaton (`liehom.integrators.run.automaton`) makes the steps. With compiled code, the fast path makes ordinary
steps, those without an output time, an end or a failure in them, and the automaton makes the steps between.
"""

from __future__ import annotations

import time as wall
from collections.abc import Callable
from functools import partial
from pathlib import Path as File
from typing import final

import numpy as np

from liehom.correctors.step import Generator, Step
from liehom.disk import digest
from liehom.homogeneous import Action
from liehom.integrators.run import checkpoint as files
from liehom.integrators.run.automaton import Automaton, Stops
from liehom.integrators.run.clock import SLACK
from liehom.integrators.run.dense import DenseSolution
from liehom.integrators.run.events import Events
from liehom.integrators.run.options import Options, Span, outcome
from liehom.integrators.run.progress import Progress
from liehom.integrators.run.records import EventLog, Path, Samples
from liehom.integrators.run.solution import Solution, with_steps
from liehom.integrators.run.state import RunState
from liehom.integrators.run.statistics import StepStatistics
from liehom.pytrees import numbers_of
from liehom.typing import Array


@final
class Run(Automaton):
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
    stops : Stops
    fast_path : callable or None
        Makes ordinary steps of the run by compiled code; returns whether there are more to be made.
    """

    def __init__(self, action: Action, psi: Generator, step: Step, span: Span, start: Array, options: Options) -> None:
        super().__init__(action, psi, step, span, start, options)
        events = None if options.events is None else Events(options.events, psi.field.args)
        total = None if options.dt is None else self._number_of_steps(options.dt)
        self.stops: Stops = Stops(span[1], total, events)
        self.fast_path: Callable[[Run], bool] | None = None
        self.state: RunState = self._initial_state(start)

    def _initial_state(self, start: Array) -> RunState:
        options, span, events = self.options, self.span, self.stops.events
        t = np.full(self.shape, span[0], dtype=self.dtype)
        samples = None
        if options.t_eval is not None:
            samples = Samples(options.t_eval, start.shape, self.dtype, float(self.direction))
            samples.start(span[0], start)
        made = RunState(
            t=t,
            m=self.start,
            active=np.full(self.shape, bool(span[0] != span[1])),
            code=np.zeros(self.shape, dtype=int),
            ended_at=t,
            h=np.full(self.shape, options.first_step or np.inf, dtype=self.dtype),
            taken=np.zeros(self.shape, dtype=int),
            calls=self.calls,  # of the preparation of the step
            event_values=events.values(t, self.start) if events else [],
            path=Path(t, self.start),
            statistics=StepStatistics(self.step, self.shape),
            event_log=EventLog(events.count if events else 0, self.shape, start.shape[-1]),
            samples=samples,
        )
        self.calls = 0
        return made

    def _number_of_steps(self, dt: Array) -> Array:
        """Numbers of steps of size dt to the end; a rest below 1e-9 dt, or below round-off, is not a step."""
        rest = SLACK + self.rest / dt
        return np.maximum(np.ceil(abs(self.span[1] - self.span[0]) / dt - rest), 1)

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
        o, events, field = self.options, self.stops.events, self.field
        strings = f"{files.stable_repr(self.step)} {self.action.exponential.name} {o.fixed_text()}"
        strings += "" if events is None else f" {events.directions} {events.terminal}"
        t, ahead = np.full(self.shape, self.span[0]), 1e-3 * (self.stops.end - self.span[0])
        here = np.asarray(field.psi(self.start, t))
        near = self.action.act((ahead * here).astype(self.dtype), self.start)
        there = np.asarray(field.psi(near, t + ahead))
        numbers = [np.array(self.span), *(0 if x is None else x for x in (o.dt, o.t_eval)), *numbers_of(field.args)]
        numbers += [a.to_numpy() for a in field.representation.matrices]
        return digest(strings, self.start, *numbers, here, near, there, *self.state.event_values)

    def _fraction(self) -> float:
        passed = np.min(np.abs(self.state.t - self.span[0]), where=self.state.active, initial=np.inf)
        whole = float(abs(self.stops.end - self.span[0])) or 1.0
        return float(min(passed / whole, 1.0))

    def _go_on(self) -> None:
        """Ordinary steps on the fast path; if there are none to be made, one step of all active trajectories."""
        if self.fast_path is None or not self.fast_path(self):
            self.advance(self.state, self.stops, budget=1)

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
        t_events, y_events = now.event_log.lists() if self.stops.events is not None else (None, None)
        record, direction = now.statistics, float(self.direction)
        ended = outcome(now.code, now.ended_at, record.unkept_from, direction, self.step.order, record.loss)
        made = Solution(
            t=t,
            y=y,
            sol=dense() if o.dense_output else None,
            t_events=t_events,
            y_events=y_events,
            nfev=now.calls,
            status=ended.status,
            message=ended.message,
            n_steps=now.taken if self.shape else int(now.taken),
            report=record.report(self.action, o.clock, self.psi.orbit_dimension, direction, ended.stopped_at),
            statuses=ended.statuses if self.shape else ended.status,
        )
        return with_steps(made, dense) if self.keeps else made
