"""The automaton of a run: the transitions that every trajectory (lane) makes, written once.

1. Propose: the step at (t, m), as a function of its size (`Step.at`).
2. Size: by the tolerance, `LocalStep.size` or the size that the last estimate left.
3. Fit: shortened so that it ends at the end of the time span.
4. Judge: by its point, `LocalStep.estimate` and `LocalStep.valid`. A lane that rejects its step tries a smaller one.
5. Look: events in it are recorded, and a terminal one shortens it.
6. Commit: time, point, path, samples, diagnostics.
7. End: at the end, at a terminal event, or by a failure, with its code.

All lanes make them together, each with its own time, step size and time reparametrization τ (its "clock": a step of
size h takes the time τ(h)). A lane that has ended takes steps of size 0 from its initial point, where psi is known to
be finite. A step is asked for nothing but the methods of `LocalStep`.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple, final

import numpy as np

from liehom.correctors.expansion import flow_series
from liehom.correctors.step import Diagnostics, Generator, LocalStep, Step
from liehom.correctors.step_size import StepLimits, over_sites
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators.run.clock import SLACK, fitted, size_for
from liehom.integrators.run.control import (
    ERROR_TERMS,
    MAX_GROWTH,
    MAX_SHRINK,
    Tolerance,
    is_large_enough,
    judged,
    known_size,
    largest_size,
    length,
    time_scale,
    unsolvable,
    whole_lattice,
)
from liehom.integrators.run.events import Events, Look
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
)
from liehom.integrators.run.state import RunState
from liehom.series.arrays import in_lanes
from liehom.series.jet import Jet
from liehom.typing import Array, BooleanArray, IntegerArray, Real, Values

LOGGER = logging.getLogger("liehom.integrators")
"""One line at level DEBUG for each step and each failure of a run."""
FIRST_STEP_FRACTION = 0.01
"""The first step of an embedded pair, in units of |m| / |X|."""
MAX_MOVE_WITH_EVENTS = 0.5
"""With events, an adaptive step moves a point by at most |m| times this, so that g has few extrema in it."""


class Stops(NamedTuple):
    """Where the steps of a run stop.

    Attributes
    ----------
    end : floating
        The end of the time span.
    total : array of int of shape (...,), or None
        The number of steps of fixed size up to the end; None for adaptive sizes.
    events : Events or None
        A step ends at a terminal event.
    """

    end: np.floating[Any]
    total: Array | None
    events: Events | None


@final
@dataclass(frozen=True, slots=True)
class StepProposal:
    """A step of all lanes before it is committed.

    Attributes
    ----------
    local : LocalStep
    t, m : arrays of shape (...,) and (..., N)
        Times and points before the step.
    h : array of shape (...,)
        Signed step sizes; 0 for lanes that do not move.
    after, made : arrays of shape (...,) and (..., N)
        Times and points after the step.
    moves, last : bool arrays of shape (...,)
        Which lanes move, and for which the step ends at the end of the time span.
    nominal : bool
        Whether time advances by the size of the step rather than by its time reparametrization τ.
    diagnostics : dict
        `LocalStep.diagnostics`.

    Examples
    --------
    >>> import liehom as lh
    >>> action, m, t, yes = lh.Action(lh.defining(lh.so(2))), np.array([1.0, 0.0]), np.array(0.0), np.array(True)
    >>> local = LocalStep(action, m, lambda h: (h * np.array([1.0]),))
    >>> made = action.act(np.array([0.5]), m)
    >>> proposal = StepProposal(local, t, m, t + 0.5, t + 0.5, made, yes, yes, nominal=False, diagnostics={})
    >>> proposal.point(np.array(0.25), yes).round(6).tolist() == [round(np.cos(0.25), 6), round(np.sin(0.25), 6)]
    True
    """

    local: LocalStep
    t: Array
    m: Array
    h: Array
    after: Array
    made: Array
    moves: BooleanArray
    last: BooleanArray
    nominal: bool
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
        point: Any = self.local.point(s[..., None])
        return t, point

    def point(self, time: Array, here: BooleanArray) -> Array:
        """The points (..., N) at a time within the step, for the lanes `here`."""
        elapsed = np.where(here, time - self.t, 0)
        s = elapsed if self.nominal else size_for(self.local, elapsed, np.where(here, self.h, 0))
        return self.position(np.where(here & (time == self.after), self.h, s))[1]


class Automaton:
    """The transitions of the lanes of a run; `advance` makes them.

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
    step : Step
        Prepared for the run.
    tried : (LocalStep, array) or None
        The last step that was proposed, and its sizes.

    Examples
    --------
    `Run`, which is an automaton with a state, makes one step:

    >>> import liehom as lh
    >>> from liehom.integrators.run.options import Options
    >>> from liehom.integrators.run.run import Run
    >>> field, m = lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0])
    >>> options = Options(np.array(0.25), 0, 0, None, False, None, False, np.inf, None, 10, 30.0)
    >>> span = np.float64(0), np.float64(1)
    >>> run = Run(lh.Action(field.representation), Generator(field, 1), lh.Euler(), span, m, options)
    >>> run.advance(run.state, run.stops, budget=1)
    >>> float(run.state.t), int(run.state.taken)
    (0.25, 1)
    """

    action: Action
    step: Step
    options: Options
    span: Span
    start: Array
    shape: tuple[int, ...]
    dtype: np.dtype[np.float64]
    direction: np.float64
    rest: np.floating[Any]
    """A time below which nothing is left."""
    tiny: float
    """The smallest step size."""

    def __init__(self, action: Action, psi: Generator, step: Step, span: Span, start: Array, options: Options) -> None:
        self.action, self.options, self.span = action, options, span
        self.calls, self.psi_raised, self.axes = 0, False, len(psi.field.sites)
        self.field: GeneratorField = psi.field
        # the generator is 0 at points that the group fixes, so that round-off does not move them
        moving = np.asarray(psi.orbit_dimension) > 0
        self._moving: Array | None = None if moving.all() else np.where(moving, 1.0, 0.0).astype(start.dtype)[..., None]
        self.psi: Generator = Generator(self._counted(psi.field), psi.orbit_dimension, start)
        self.start, self.shape, self.dtype = in_lanes(start), start.shape[:-1], start.dtype
        self.direction = self.dtype.type(1 if span[1] >= span[0] else -1)
        self.tried: tuple[LocalStep, Array] | None = None
        self.tolerance: Tolerance = Tolerance(options.rtol, options.atol, self.axes)
        self.rest = self.dtype.type(8 * np.finfo(self.dtype).eps * max(abs(span[0]), abs(span[1])))
        self.tiny = max(float(self.rest), options.least_step)
        self.keeps: bool = options.t_eval is None or options.dense_output
        self.logs = LOGGER.isEnabledFor(logging.DEBUG)  # asked once: a run without a log pays nothing for it
        self.step = step.prepare(action, self.psi, self.start, np.full(self.shape, span[0], dtype=self.dtype))

    def _counted(self, field: GeneratorField) -> GeneratorField:
        """The field, with psi counted and its linear algebra errors noted."""

        def psi(m: Values, t: Real = 0.0) -> Values:
            self.calls += 1
            try:
                made: Values = in_lanes(field.psi(m, t))
                if self._moving is not None:
                    made = made * self._moving
            except np.linalg.LinAlgError:
                self.psi_raised = bool(np.isfinite(m.value if isinstance(m, Jet) else m).all())
                raise
            return made

        return GeneratorField(field.representation, psi, time_dependent=field.time_dependent, sites=field.sites)

    # -- the transitions ---------------------------------------------------------------------------------
    def advance(self, state: RunState, stops: Stops, budget: int) -> None:
        """Make steps of all active lanes, at most `budget`; a step that is rejected counts as one."""
        for _ in range(budget):
            if not state.active.any():
                return
            active = state.active
            try:
                proposal = self._proposed(state, stops)
            except (np.linalg.LinAlgError, ConvergenceError) as error:
                if np.array_equal(active, state.active):  # else the step is tried again without those that failed
                    self._diagnose(state, stops, error)
            else:
                if self.logs:
                    proposal.log(state.active)
                if proposal.moves.any():
                    proposal, halted = self._looked_into(state, stops, proposal)
                    self._commit(state, proposal, halted)
            state.calls, self.calls = state.calls + self.calls, 0

    def _proposed(self, now: RunState, stops: Stops) -> StepProposal:
        """A step of the right size, of the lanes that accept it."""
        adaptive, self.tried = self.options.dt is None, None
        now.m = in_lanes(now.m)
        local = self.step.at(self.action, self.psi, now.m, now.t[..., None], error_terms=ERROR_TERMS if adaptive else 0)
        size = self._size(now, stops, local) if self.options.dt is None else self.options.dt
        h, after, last = self._fitted(now, stops, local, size)
        self.tried = local, h
        made: Any = local.point(h[..., None])
        moves = now.active & self._judged(now, local, h) if adaptive else now.active
        diagnostics = local.diagnostics(h[..., None])
        good = np.isfinite(made).all(axis=-1)
        usable = ~whole_lattice(~(good & local.valid(h[..., None])), self.axes)
        if not usable.all():
            if adaptive:
                now.h = np.where(usable, now.h, np.abs(h) * MAX_SHRINK)
            else:
                self._fail_by_psi(now, moves & ~usable, np.where(good, IMPLICIT, NOT_FINITE))
            moves = moves & usable
        if not moves.all():
            h, after = np.where(moves, h, 0), np.where(moves, after, now.t)
            made = np.where(moves[..., None], made, now.m)
        made = made.astype(self.dtype, copy=False)
        return StepProposal(local, now.t, now.m, h, after, made, moves, last, self.options.nominal, diagnostics)

    def _size(self, now: RunState, stops: Stops, local: LocalStep) -> Array:
        """The step size that the tolerance asks for, positive, (...,)."""
        embedded = local.estimate_order is not None
        left = np.abs(stops.end - now.t)
        bound = largest_size(self.options.max_step, left)
        first = embedded and bool(np.isinf(now.h).any())
        needed = not embedded or first or stops.events is not None
        scale = time_scale(self.psi.field, now.m, now.t) if needed else np.inf
        if stops.events is not None:
            bound = np.minimum(bound, MAX_MOVE_WITH_EVENTS * scale)
        if first:
            now.h = np.where(np.isinf(now.h), np.minimum(bound, FIRST_STEP_FRACTION * scale), now.h)
        h = np.minimum(now.h, bound)
        if not embedded:
            speed = over_sites(length(now.m), self.axes) / scale
            limits = StepLimits(self.tolerance.norm(now.m), speed, h, self.axes)
            h = known_size(self.action, self.psi, local, now.m, now.t, self.step.order, limits).astype(self.dtype)
        small = now.active & ~is_large_enough(h, self.tiny, left)
        if small.any():
            self._fail(now, small & np.isnan(h), PSI)
            self._fail_by_psi(now, small, TOO_SMALL)
            h = np.where(now.active, h, 0)
        return h

    def _fitted(self, now: RunState, stops: Stops, local: LocalStep, size: Array) -> tuple[Array, Array, BooleanArray]:
        """Signed step sizes that do not pass the end, the times after them, and which steps are the last."""
        h = self.direction * np.where(now.active, size, 0).astype(self.dtype)
        left = stops.end - now.t
        if not self.options.nominal and local.clock:
            h, passed, last, runs = fitted(local, h, left, halve=stops.total is None)
            if not runs.all():
                self._fail_by_psi(now, now.active & ~runs, np.where(local.is_near_cone(h), CONE, CLOCK))
                h, passed = np.where(now.active, h, 0), np.where(now.active, passed, 0)
            after, last = now.t + passed, last & now.active
            return h, np.where(last, stops.end, after) if last.any() else after, last
        dt = self.options.dt
        if dt is None or stops.total is None:
            last = now.active & (self.direction * (left - h) <= SLACK * np.abs(h))
            after = now.t + h
        else:  # by counting, so that round-off does not add up
            count = now.taken + 1
            last = now.active & (count >= stops.total)
            after = self.span[0] + count * (self.direction * dt)
        if last.any():
            h, after = np.where(last, left, h), np.where(last, stops.end, after)
        return h, after, last

    def _judged(self, now: RunState, local: LocalStep, h: Array) -> BooleanArray | bool:
        """Which lanes accept the step by its estimate, all without one; adapts the next step size."""
        if local.estimate_order is None:
            now.h = MAX_GROWTH * np.abs(h)
            return True
        error = local.estimate(h[..., None])
        accepted, now.h = judged(error, self.tolerance.norm(now.m), h, local.estimate_order, self.axes)
        return accepted

    def _looked_into(self, now: RunState, stops: Stops, proposal: StepProposal) -> tuple[StepProposal, BooleanArray]:
        """The step, shortened at a terminal event, and for which lanes it is; the events are recorded."""
        now.statistics.take(proposal.diagnostics, proposal.local, now.t, now.m, proposal.moves)
        if stops.events is None:
            return proposal, np.zeros(self.shape, dtype=bool)
        values = stops.events.values(proposal.after, proposal.made)
        ends = (proposal.t, proposal.m), (proposal.after, proposal.made)
        look = Look(proposal.position, partial(self._slope, stops.events), proposal.h, *ends, proposal.moves)
        stop, halted = stops.events.record(now.event_log, look, now.event_values, values, now.taken == 0)
        before = now.event_values
        now.event_values = [np.where(proposal.moves, v, g) for v, g in zip(values, before, strict=True)]
        if not halted.any():
            return proposal, halted
        t, y = proposal.position(np.where(halted, stop, 0))
        after, made = np.where(halted, t, proposal.after), np.where(halted[..., None], y, proposal.made)
        return replace(proposal, h=np.where(halted, stop, proposal.h), after=after, made=made), halted

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
        slope: Array = (ahead - value) / np.where(here, inwards * size, 1)
        return slope

    def _commit(self, now: RunState, proposal: StepProposal, halted: BooleanArray) -> None:
        """Make the step, with its samples, and end the lanes whose last one it is."""
        if now.samples is not None:
            now.samples.fill(proposal.point, proposal.after, proposal.moves)
        now.t, now.m = proposal.after, proposal.made
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

    def _diagnose(self, now: RunState, stops: Stops, error: Exception) -> None:
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
        self._fail(now, where & ((stops.total is not None) | (sizes <= 2 * self.tiny)), code)
