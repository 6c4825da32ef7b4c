"""Run: the loop of `integrate` over the steps of one trajectory or an ensemble.

All trajectories are stepped together, each with its own time, clock and step size; one that has ended takes
steps of size 0.  Imports checkpoint, clock, control, dense, events, progress, records, solution, correctors.
"""

from __future__ import annotations

import os
import time as wall
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.corrected import CorrectedStep
from liehom.correctors.step import Generator, LocalStep, Step, apply_factors
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators import checkpoint as files
from liehom.integrators.clock import has_clock, runs, size_for
from liehom.integrators.control import ERROR_TERMS, Tolerance, defects_of, next_size, size_from_defects
from liehom.integrators.dense import DenseSolution
from liehom.integrators.events import Events
from liehom.integrators.progress import Progress
from liehom.integrators.records import Account, Found, Samples
from liehom.integrators.solution import Solution

GROWTH = 8.0
_REPLACED = ("t", "m", "active", "h", "taken", "calls", "halted", "failure", "before")
MESSAGES = {
    0: "The solver successfully reached the end of the integration interval.",
    1: "A termination event occurred.",
}


@final
@dataclass(frozen=True, slots=True)
class Options:
    """The options of a run, checked."""

    dt: Any
    rtol: float
    atol: float
    t_eval: Any
    dense_output: bool
    events: Any
    nominal: bool
    max_step: float
    first_step: float | None
    max_steps: int
    checkpoint_every: float


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
        self.calls = 0
        self.psi = Generator(self._counted(psi.field), psi.orbit_dimension)
        self.end, self.direction = span[1], start.dtype.type(1 if span[1] >= span[0] else -1)
        self.m = start
        self.shape = start.shape[:-1]
        self.t = np.full(self.shape, span[0], dtype=start.dtype)
        self.active = np.full(self.shape, bool(span[0] != span[1]))
        self.h = np.full(self.shape, options.first_step or np.inf, dtype=start.dtype)
        self.taken = np.zeros(self.shape, dtype=int)
        self.halted, self.failure = False, ""
        self.account = Account(step, self.shape)
        self.events = None if options.events is None else Events(options.events)
        self.found = Found(self.events.count if self.events else 0, self.shape)
        self.before = self.events.values(self.t, self.m) if self.events else []
        self.samples: Samples | None = None
        if options.t_eval is not None:
            self.samples = Samples(options.t_eval, start.shape, start.dtype, float(self.direction))
            self.samples.start(span[0], start)
        self.times, self.points, self.sizes = [self.t], [self.m], []
        self.keeps = options.t_eval is None or options.dense_output
        self.fingerprint = self._fingerprint(psi.field, span)

    def _counted(self, field: GeneratorField) -> GeneratorField:
        def psi(m: Any, t: Any = 0.0) -> Any:
            self.calls += 1
            return field.psi(m, t)

        return GeneratorField(field.representation, psi, time_dependent=field.time_dependent)

    def _fingerprint(self, field: GeneratorField, span: tuple[Any, Any]) -> str:
        o = self.options
        matrices = [a.to_numpy() for a in field.representation.matrices]
        away = self.action.act(np.full((*self.shape, self.action.dimension), 0.1, dtype=self.m.dtype), self.m)
        values = [field.psi(self.m, self.t), field.psi(away, self.t + 0.1)]
        texts = (
            f"{self.step!r} {self.action.exponential.name} {o.nominal} {o.rtol} {o.atol} {o.max_step} {o.first_step}"
        )
        texts += f" {o.dense_output} {o.t_eval is None} {0 if self.events is None else self.events.count}"
        numbers = [np.array(span), o.dt if o.dt is not None else 0, o.t_eval if o.t_eval is not None else 0]
        return files.digest(texts, self.m, *numbers, *matrices, *values)

    # -- the loop ----------------------------------------------------------------------------------------
    def execute(self, show: bool | Callable[[float], Any], path: str | os.PathLike[str] | None) -> Solution:
        """Run to the end, with progress and checkpoints."""
        if path is not None and os.path.exists(path):
            self._restore(files.load(path, self.fingerprint))
        mark = self._mark()
        begin, last = np.min(self.direction * self.t, initial=np.inf), wall.monotonic()
        length = float(self.direction * self.end - begin) or 1.0
        with Progress(show) as progress:
            try:
                while bool(np.any(self.active)):
                    mark = self._mark()
                    self.advance()
                    progress.update(min(1.0, float(np.min(self.direction * self.t) - begin) / length))
                    if path is not None and wall.monotonic() - last >= self.options.checkpoint_every:
                        files.save(path, self.fingerprint, self._state())
                        last = wall.monotonic()
            except KeyboardInterrupt:
                if path is not None:
                    self._back_to(mark)
                    files.save(path, self.fingerprint, self._state())
                raise
            progress.update(1.0)
        if path is not None and os.path.exists(path):
            os.remove(path)
        return self._solution()

    def advance(self) -> None:
        """One step of all active trajectories."""
        adaptive = self.options.dt is None
        local = self.step.at(
            self.action, self.psi, self.m, self.t[..., None], error_terms=ERROR_TERMS if adaptive else 0
        )
        estimate = getattr(local, "estimate", None) if adaptive else None
        wanted = self._wanted(local, estimate)
        h, after, last = self._clipped(local, wanted)
        factors = local.factors(h[..., None])
        made = apply_factors(self.action, factors, self.m)
        if estimate is not None:
            accepted = self._judged(estimate(h[..., None]), h, local.estimate_order)  # type: ignore[attr-defined]
        else:
            accepted = np.ones(self.shape, dtype=bool)
        good = np.isfinite(made).all(axis=-1)
        self._fail(self.active & accepted & ~good, "The solution is not finite after a step; take smaller steps.")
        moves = self.active & accepted
        after = np.where(moves, after, self.t)
        made = np.where(moves[..., None], made, self.m)
        h = np.where(moves, h, 0)
        if isinstance(local, CorrectedStep):
            self.account.add(local.correction, self.t, self.m, moves)
        stopped = self._look_for_events(local, h, after, made, moves)
        if stopped is not None:
            after, made, h, halted = stopped
            last = last | halted
        self._sample(local, after, h, moves)
        self._commit(after, made, h, moves, last)
        if adaptive and estimate is None:
            self.h = np.where(moves, np.abs(h), self.h)

    def _wanted(self, local: LocalStep, estimate: Any) -> Any:
        """The step size before the end of the interval is looked at, positive, (...,)."""
        o = self.options
        if o.dt is not None:
            if has_clock(local) and not o.nominal:
                bad = self.active & ~runs(local, self.direction * o.dt)
                self._fail(bad, "The clock of the corrected step does not run at this step size; take a smaller dt.")
            return o.dt
        left = np.abs(self.end - self.t)
        largest = np.minimum(o.max_step, left)
        if estimate is not None:
            first = np.minimum(largest, 0.01 * self._time_scale())
            h = np.minimum(np.where(np.isfinite(self.h), self.h, first), largest)
        else:
            allowed = Tolerance(o.rtol, o.atol).norm(self.m)
            found = defects_of(self.action, self.psi, local, self.m, self.t, self.step.order)
            grown = GROWTH * self.h  # infinite before the first step
            h = size_from_defects(found, allowed, np.minimum(largest, grown)).astype(self.m.dtype)
            h = h if o.nominal else _until_the_clock_runs(local, h, self.direction)
        tiny = 8 * np.finfo(self.m.dtype).eps * np.maximum(np.abs(self.t), np.abs(self.end))
        small = self.active & ~(h >= np.minimum(tiny, left))
        self._fail(small, "The step size that the tolerance asks for is below round-off.")
        return h

    def _time_scale(self) -> Any:
        speed = np.linalg.norm(np.asarray(self.psi.field.vector(self.m, self.t), dtype=float), axis=-1)
        size = np.linalg.norm(np.asarray(self.m, dtype=float), axis=-1)
        return np.where(speed > 0, size / np.where(speed > 0, speed, 1.0), np.inf)

    def _clipped(self, local: LocalStep, wanted: Any) -> tuple[Any, Any, Any]:
        """Signed step sizes that end at the end, the times after them, and which steps are the last."""
        h = np.where(self.active, self.direction * wanted, 0).astype(self.m.dtype)
        left = self.end - self.t
        passed = h if self.options.nominal else local.time(h)
        last = self.active & (self.direction * (left - passed) <= 1e-9 * np.abs(h))
        if bool(np.any(last)):
            aim = np.where(last, left, 0)
            shorter = aim if self.options.nominal else size_for(local, aim, np.where(last, h, 0))
            h = np.where(last, shorter, h)
        after = np.where(last, self.end, self.t + passed)
        return h, after, last

    def _judged(self, error: Any, h: Any, order: int) -> Any:
        """Where an embedded pair accepts the step; adapts the next step size."""
        allowed = Tolerance(self.options.rtol, self.options.atol).norm(self.m)
        size = np.linalg.norm(np.asarray(error, dtype=float), axis=-1)
        ratio = np.where(np.isfinite(size), size / allowed, 1e10)
        self.h = np.where(self.active, next_size(np.abs(h), ratio, order), self.h)
        return ratio <= 1

    # -- events and samples ------------------------------------------------------------------------------
    def _position(self, local: LocalStep, s: Any) -> tuple[Any, Any]:
        """(t, y) within the step at the parameter s (...,)."""
        return self.t + (s if self.options.nominal else local.time(s)), apply_factors(
            self.action, local.factors(s[..., None]), self.m
        )

    def _look_for_events(self, local: LocalStep, h: Any, after: Any, made: Any, moves: Any) -> Any:
        """Record events; where a terminal one occurs, the shortened step (times, points, sizes, where)."""
        if self.events is None:
            return None
        values, before = self.events.values(after, made), self.before
        crossed = [moves & self.events.crossed(i, g, values[i]) for i, g in enumerate(before)]
        self.before = [np.where(moves, v, g) for v, g in zip(values, before, strict=True)]
        if not any(bool(np.any(c)) for c in crossed):
            return None
        where = [
            self.events.locate(i, lambda s: self._position(local, s), h, before[i], c) if bool(np.any(c)) else 0 * h
            for i, c in enumerate(crossed)
        ]
        halted, stop = self._stops(crossed, where, h)
        for i in np.argsort([float(np.min(np.abs(w))) for w in where]):
            here = crossed[i] & (np.abs(where[i]) <= np.abs(stop))
            if bool(np.any(here)):
                t, y = self._position(local, np.where(here, where[i], 0))
                self.found.add(int(i), here, t, y)
        if not bool(np.any(halted)):
            return None
        t, y = self._position(local, np.where(halted, stop, 0))
        self.halted = True
        return np.where(halted, t, after), np.where(halted[..., None], y, made), np.where(halted, stop, h), halted

    def _stops(self, crossed: list[Any], where: list[Any], h: Any) -> tuple[Any, Any]:
        """Which trajectories a terminal event ends, and at which parameter."""
        halted, stop = np.zeros(self.shape, dtype=bool), h
        for i, here in enumerate(crossed):
            ends = here & (self.found.occurrences[i] + 1 >= self.events.terminal[i] if self.events else False)
            stop = np.where(ends & (np.abs(where[i]) <= np.abs(stop)), where[i], stop)
            halted = halted | ends
        return halted, stop

    def _sample(self, local: LocalStep, after: Any, h: Any, moves: Any) -> None:
        if self.samples is None:
            return

        def at(time: Any, here: Any) -> Any:
            aim = np.where(here, time - self.t, 0)
            s = aim if self.options.nominal else size_for(local, aim, np.where(here, h, 0))
            return self._position(local, s)[1]

        self.samples.fill(at, self.t, after, moves)

    # -- state -------------------------------------------------------------------------------------------
    def _commit(self, after: Any, made: Any, h: Any, moves: Any, last: Any) -> None:
        self.t, self.m = after, made
        self.taken = self.taken + moves
        self.active = self.active & ~(last & moves)
        if self.keeps and bool(np.any(moves)):
            self.times.append(np.where(moves, self.t, np.nan))
            self.points.append(np.where(moves[..., None], self.m, np.nan))
            self.sizes.append(h)
        self._fail(self.active & (self.taken >= self.options.max_steps), f"More than {self.options.max_steps} steps.")

    def _fail(self, where: Any, message: str) -> None:
        """End the trajectories at `where`."""
        if bool(np.any(where)):
            self.failure = message
            self.active = self.active & ~where

    def _mark(self) -> tuple[Any, ...]:
        """The state between two steps, cheaply: arrays are replaced, never written into."""
        kept = {name: getattr(self, name) for name in _REPLACED}
        done = None if self.samples is None else self.samples.done
        return kept, len(self.times), self.account.arrays(), self.found.occurrences, len(self.found.rows), done

    def _back_to(self, mark: tuple[Any, ...]) -> None:
        """Undo what an interrupted step has done."""
        kept, length, account, self.found.occurrences, rows, done = mark
        for name, value in kept.items():
            setattr(self, name, value)
        del self.times[length:], self.points[length:], self.sizes[max(length - 1, 0) :], self.found.rows[rows:]
        self.account.restore(account)
        if self.samples is not None:
            self.samples.done = done

    def _state(self) -> dict[str, Any]:
        """All that `_restore` needs, as arrays."""
        state = {"t": self.t, "m": self.m, "active": self.active, "h": self.h, "taken": self.taken}
        state |= {"calls": np.array(self.calls), "halted": np.array(self.halted), "failure": np.array(self.failure)}
        state |= {"times": np.stack(self.times), "points": np.stack(self.points)}
        state["sizes"] = np.stack(self.sizes) if self.sizes else np.zeros((0, *self.shape), dtype=self.m.dtype)
        state |= {f"before{i}": g for i, g in enumerate(self.before)}
        state |= {f"account_{k}": v for k, v in self.account.arrays().items()}
        state |= {f"found_{k}": v for k, v in self.found.arrays().items()}
        if self.samples is not None:
            state |= {"sample_points": self.samples.points, "sample_done": self.samples.done}
        return state

    def _restore(self, state: dict[str, Any]) -> None:
        self.t, self.m, self.active = state["t"], state["m"], state["active"]
        self.h, self.taken, self.calls = state["h"], state["taken"], int(state["calls"])
        self.halted, self.failure = bool(state["halted"]), str(state["failure"])
        self.times, self.points, self.sizes = list(state["times"]), list(state["points"]), list(state["sizes"])
        self.before = [state[f"before{i}"] for i in range(len(self.before))]
        self.account.restore({k[8:]: v for k, v in state.items() if k.startswith("account_")})
        self.found.restore({k[6:]: v for k, v in state.items() if k.startswith("found_")})
        if self.samples is not None:
            self.samples.points, self.samples.done = state["sample_points"], state["sample_done"]

    def _solution(self) -> Solution:
        o = self.options
        status = -1 if self.failure else int(self.halted)
        times, points = np.stack(self.times), np.stack(self.points)
        dense = None
        if o.dense_output:
            sizes = np.stack(self.sizes) if self.sizes else np.zeros((1, *self.shape), dtype=self.m.dtype)
            known = (times, points) if self.sizes else (np.stack([self.t] * 2), np.stack([self.m] * 2))
            dense = DenseSolution(self.action, self.psi, self.step, *known, sizes, nominal=o.nominal)
        if self.samples is None:
            t, y = np.moveaxis(times, 0, -1), np.moveaxis(points, 0, -1)
        else:
            t, y = self.samples.times, self.samples.points
            if not self.shape:
                t, y = t[: int(self.samples.done)], y[..., : int(self.samples.done)]
        t_events, y_events = self.found.lists() if self.events is not None else (None, None)
        return Solution(
            t=t,
            y=y,
            sol=dense,
            t_events=t_events,
            y_events=y_events,
            nfev=self.calls,
            status=status,
            message=self.failure or MESSAGES[status],
            n_steps=int(self.taken) if not self.shape else self.taken,
            report=self.account.report(self.action, "nominal" if o.nominal else "corrected", self.psi.orbit_dimension),
        )


def _until_the_clock_runs(local: LocalStep, h: Any, direction: Any) -> Any:
    """Step sizes halved until the clock of the step is usable."""
    for _ in range(40):
        slow = ~runs(local, direction * h)
        if not bool(np.any(slow)):
            break
        h = np.where(slow, h / 2, h)
    return h
