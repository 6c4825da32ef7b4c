"""LlvmEngine: runs in machine code, every step of every trajectory, in lockstep or with a size of its own.

The engine keeps machine code and the traces behind it from call to call. A point that
is not finite, a clock that is not admissible, or equations that were not solved end the compiled part of a trajectory
before that step, which the automaton then makes or diagnoses.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import replace
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError
from liehom.base.pytrees import leaves
from liehom.base.typing import Array, IntegerArray, Pytree
from liehom.flow.action.fingerprint import Watch
from liehom.flow.engines.compiled_events import EventSearch, events_key, planned_events
from liehom.flow.engines.engine import Problem, executed
from liehom.flow.engines.lanes import (
    HandBack,
    LaneSteps,
    block_width,
    calls_of,
    lowest_numbers,
    moved_rows,
    operations,
    records_of,
    run_blocks,
    steps_per_call,
    stops_of,
    stores_path,
    times_until,
    with_guard,
)
from liehom.flow.engines.lattice import LatticePath, LatticeStep
from liehom.flow.engines.plan import (
    CHUNK,
    FLOAT,
    KINDS,
    Numbers,
    Plan,
    floats,
    form_of,
    frame_key,
    note_ranks,
    numbers_of,
    ranked,
    serves_all_points,
)
from liehom.flow.engines.traced_step import arg_values, args_form, traced_step
from liehom.flow.run.check import is_unbounded
from liehom.flow.run.options import END
from liehom.flow.run.records import bounds_of
from liehom.flow.run.run import Run
from liehom.flow.run.solution import Solution
from liehom.flow.tracing.graph import UNROLLED_OPERATIONS, LaneConstant
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import Kernel

COPIES_WITH_EVENTS = 8  # arrays of the size of the path, about, while events are sought
MIN_STEPS_WITH_ENDS = 64  # with terminal events, steps in the first call; further calls double their number
MAX_PLANS = 64  # number of plans that are kept
NEVER: tuple[Mapping[str, Any] | None, Numbers | None, Hashable, Plan | None] = None, None, None, None
"""Of the latest call: its options, their numbers, and, without args, the rest of its form and its plan."""


@final
class LlvmEngine:
    """The engine "llvm", which makes steps by machine code; those that it cannot make are made in numpy."""

    name = "llvm"

    def __init__(self, store: CodeStore | None = None, watch: Watch | None = None) -> None:
        self._store = CodeStore() if store is None else store
        self._plans: dict[Hashable, Plan] = {}
        self._latest = NEVER
        self._lattice: LatticeStep | None = None
        self._watch = watch  # of the psi from which the store was made

    def __reduce__(self) -> tuple[type[LlvmEngine], tuple[()]]:
        return type(self), ()  # machine code belongs to a process

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem."""
        if self._watch is None or self._watch.changed():
            self._store, self._plans, self._latest, self._lattice = CodeStore(), {}, NEVER, None
            self._watch = Watch(problem.bound, problem.start, problem.span[0])
        if problem.field.sites:
            step, self._lattice = self._lattice, None  # its planes serve one call at a time
            if step is None or problem.args is not None:
                step = LatticeStep(problem)
            solution = executed(replace(problem, step=step), lambda _: LatticePath(step))
            self._lattice = step
            return solution
        runs: list[CompiledRun] = []

        def fast_path(run: Run) -> Callable[[Run], bool]:
            runs.append(CompiledRun(problem, run, self._store))
            return runs[0]

        solution = executed(problem, fast_path)
        if runs[0].groups:  # an ensemble may be empty
            self._keep_plan(problem, runs[0], solution)
        return solution

    def again(
        self, t_span: Iterable[Any], y0: npt.ArrayLike, options: Mapping[str, Any], args: Pytree = None
    ) -> Solution | None:
        """The solution of a call of a form that there was before; None if it needs a closer look."""
        if not self._plans:
            return None
        try:
            begin, end = t_span.tolist() if type(t_span) is np.ndarray else t_span
            if not type(begin) is type(end) is float:
                if type(begin) not in KINDS or type(end) not in KINDS:
                    return None
                begin, end = float(begin), float(end)
            points = y0 if type(y0) is np.ndarray and y0.dtype is FLOAT else floats("the start", y0)
            times = key = None
            if "t_eval" in options or "events" in options:
                options = dict(options)
                times, events = options.pop("t_eval", None), options.pop("events", None)
                key = None if events is None else events_key(events)
                if times is not None and (times := floats("t_eval", times)) is None:
                    return None
            before, known, same, plan = self._latest
            kept: Mapping[str, Any] | None = options
            try:
                numbers = known if options == before else numbers_of(**options)
            except (TypeError, ValueError):  # sizes in an array are not hashable, and may change in place
                numbers, kept = numbers_of.__wrapped__(**options), None
            if points is None or numbers is None:
                return None
            found = None if args is None else leaves(args)
            form = points.shape, times is None, key
            if numbers is not known or form != same or args is not None:
                plan = self._plans.get(form_of(form, numbers, found))
                # True is 1, but not a number of looks
                self._latest = kept if numbers.looks is None else None, numbers, form if args is None else None, plan
            if plan is None or self._watch.changed():  # type: ignore[union-attr]
                return None
            return plan.call(numbers, points, begin, end, times, args, found)
        except (TypeError, ValueError, OverflowError):  # not numbers
            return None

    def _keep_plan(self, problem: Problem, run: CompiledRun, solution: Solution) -> None:
        """Keep the plan of a call, if the trace serves all points, and nothing happens between its steps."""
        o, (_, key, graph) = problem.options, run.groups[0]
        if len(run.groups) > 1 or graph.guard is None or solution.status != END or o.checkpoint or o.progress:
            return
        start, args = np.asarray(problem.start), problem.args
        numbers: Any = numbers_of.__wrapped__(dt=o.dt, looks=o.looks, dense_output=o.dense_output)
        own = start.shape, o.t_eval is None, None if o.events is None else events_key(o.events)
        form = form_of(own, numbers, None if args is None else leaves(args))
        dimension = int(np.max(problem.orbit_dimension))
        known = self._plans.get(form)
        is_current = known is not None and (known.events is None or not known.events.parts.changed())
        if is_current or not serves_all_points(problem, run.step, dimension):
            return
        events = None if o.events is None else planned_events(problem, run.step, dimension, np.asarray(solution.y))
        if events is None and o.events is not None:
            return
        self._latest = NEVER
        if len(self._plans) >= MAX_PLANS:
            self._plans.pop(next(iter(self._plans)))
        kernel = self._store.kernel(key, graph, int(np.prod(start.shape[:-1], dtype=int)))
        self._plans[form] = Plan(kernel, problem, run.step, run.work, run.prepared, events)


@final
class CodeStore:
    """Traces and code of a kind for one field, step, exponential and clock."""

    def __init__(self, code: type[Kernel] = Kernel, graphs: dict[Hashable, StepGraph] | None = None) -> None:
        self.code = code
        self.graphs: dict[Hashable, StepGraph] = {} if graphs is None else graphs
        self.works: dict[Hashable, int] = {}  # operations of a step
        self.kernels: dict[Hashable, Kernel] = {}

    def graph(self, run: Run, dimension: int, points: Array) -> tuple[Hashable, StepGraph]:
        """The graph of a step on orbits of a dimension, traced if it is not known, and its key."""
        o = run.options
        uniform = self.code.in_lockstep and o.dt is not None and bool((o.dt == np.max(o.dt, initial=0.0)).all())
        args, lead = run.field.args, len(run.shape)
        bounds = o.dt is None and (run.limits.moves, run.limits.gap is None, is_unbounded(run.limits.gap))
        key = (dimension, uniform, bounds, o.nominal, run.step.trace_key, frame_key(run.action), args_form(args, lead))
        if key not in self.graphs:
            limits = run.limits if o.dt is None else None

            def traced(*, stops: bool) -> StepGraph:
                return traced_step(
                    run.action, run.field, run.step, points, dimension, nominal=o.nominal, limits=limits,
                    ends=(float(run.span[0]), float(run.span[1])), stops=stops,
                    args=args, lead=lead, **{"unrolled": UNROLLED_OPERATIONS, **self.code.tracing},
                )  # fmt: skip

            raised = run.step.order > run.step.base_order and not o.nominal  # such steps have a clock
            graph = traced(stops=not uniform or raised)
            if graph.reached is None and graph.elapsed is not None:
                graph = traced(stops=True)
            self.graphs[key] = with_guard(graph, run.action, dimension)
        if key not in self.works:
            self.works[key] = operations(self.graphs[key])
        return key, self.graphs[key]

    def kernel(self, key: Hashable, graph: StepGraph, lanes: int) -> Kernel:
        """The machine code of a graph, in blocks for this number of lanes."""
        width = block_width(graph, lanes) if self.code is Kernel else 1
        if (key, width) not in self.kernels:
            self.kernels[key, width] = self.code(graph, width)
        return self.kernels[key, width]


@final
class CompiledRun:
    """Steps of a run by code of a kind; the number of steps in one call has no effect on the results."""

    def __init__(self, problem: Problem, run: Run, store: CodeStore, most: int | None = None) -> None:
        if run.dtype != np.float64:
            name, kind = store.code.engine, run.dtype
            raise InputError(f"engine={name!r} computes in float64, the start is of type {kind}: take engine='numpy'")
        self.store, self.most = store, most  # steps of a call
        self.search = None if run.events is None else EventSearch(run)
        self.start = run.start.reshape(-1, run.start.shape[-1])
        dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
        self.groups: list[tuple[IntegerArray, Hashable, StepGraph]] = []
        for d in np.unique(dimensions):
            lanes = np.flatnonzero(dimensions == d)
            self.groups.append((lanes, *store.graph(run, int(d), self.start[lanes])))
        self.work = store.code.cost * max((store.works[key] for _, key, _ in self.groups), default=1)
        self.total = int(np.max(np.asarray(0 if run.total is None else run.total), initial=0))
        latest = bounds_of((float(run.span[0]), float(run.span[1])))[1]
        self.values: dict[str, Any] = {**arg_values(run.field.args, len(run.shape)), **run.limits._asdict()}
        self.values |= {"latest": latest, "rest": float(run.rest)}
        self.step, self.prepared = run.step, run.state.calls
        if len(self.start) and not run.state.taken.any() and run.step.uses_isotropy:
            some = ranked(len(self.start))
            note_ranks(run.state.statistics, problem, run.step, self.start[some], some, run.shape)

    def __call__(self, run: Run) -> bool:
        """Make steps until every lane is at the end or has a step that is not made here, or a call is full."""
        now, active = run.state, run.state.active.reshape(-1)
        if not active.any():
            return False
        steps = steps_per_call(run, self.work, 1 if self.search is None else COPIES_WITH_EVENTS)
        if self.search is not None and self.search.ends_runs:
            steps = min(steps, max(MIN_STEPS_WITH_ENDS, int(np.max(now.taken))))
        steps = steps if self.most is None else min(steps, self.most)
        if steps < 1:
            return False
        run.engines[self.store.code.engine] = None
        back = HandBack(run)
        for members, key, graph in self.groups:
            here = members[active[members]]
            if graph.reached is None:
                parts = [here[back.taken[here] == taken] for taken in np.unique(back.taken[here])]
            else:
                parts = [here]
            for some in (part[i : i + CHUNK] for part in parts for i in range(0, len(part), CHUNK)):
                done = self._stepped(run, (key, graph), some, back, steps)
                back.take(some, self._looked_into(run, (key, graph), some, back, done))
        # calls of psi are counted for the trajectory with the most of them
        now.calls += int(np.max(back.calls, initial=0))
        return back.finish()

    def _stepped(
        self, run: Run, code: tuple[Hashable, StepGraph], lanes: IntegerArray, back: HandBack, steps: int
    ) -> LaneSteps:
        """At most `steps` steps of some lanes by the code of a key, which have all taken as many if in lockstep."""
        kernel, graph = self.store.kernel(*code, len(lanes)), code[1]
        n, count, samples = self.start.shape[-1], len(lanes), run.state.samples
        times = np.zeros(0) if samples is None else samples.times
        stops = stops_of(times, float(run.span[1]))
        done = np.zeros(count) if samples is None else samples.done.reshape(-1)[lanes]
        taken = back.taken[lanes]
        rows: dict[str, Any] = {"x": back.m[lanes].T, "alive": 1.0, "count": taken, **lowest_numbers(graph)}
        fields: dict[str, Any] = {"begin": 0, "end": steps}
        if graph.reached is None:
            dt, before = float(np.max(np.asarray(run.options.dt))), int(taken[0])
            last = int(min(before + steps, self.total))
            fields = {"begin": before, "end": last, "total": self.total, "step_size": run.direction * dt}
            fields["first_stop"] = int(done[0])
            steps, rows["count"] = last - before, float(last)
        else:
            given = run.options.dt
            sizes = back.h[lanes]
            if given is not None:
                sizes = run.direction * np.broadcast_to(given, run.shape).reshape(-1)[lanes]
            rows |= {"t": back.t[lanes], "stop": done, "h": sizes} | ({} if graph.sizes is None else {"kept": done})
        state = kernel.packed(count, rows)
        out = np.empty((len(stops) + 1, n, state.shape[1]))
        path = np.zeros((steps, n + 2, state.shape[1])) if stores_path(run) else None
        fields |= {"stops": stops, "last_stop": len(stops) - 2, "origin": float(run.span[0]), "out": out, "path": path}
        run_blocks(kernel, state, {**self._given(kernel, lanes), **fields}, steps)
        row = {name: state[i, :count] for i, name in enumerate(kernel.names)}
        alive, now = row["alive"], row["count"].astype(int)
        if graph.reached is None:
            reached = np.where(now >= self.total, float(run.span[1]), float(run.span[0]) + now * fields["step_size"])
            going, ended = (alive > 0) & (last < self.total), (alive > 0) & (last == self.total)
            until, tries = times_until(run, reached), now - taken
        else:
            reached, going, ended = row["t"], alive > 0, alive < 0
            until = np.where(ended, len(times), row["stop" if graph.sizes is None else "kept"].astype(int))
            tries = row.get("tries", now - taken)  # type: ignore[assignment]
        calls = calls_of(kernel, row, tries)
        if graph.first is not None:
            calls = calls + np.isinf(sizes)
        first, most = (int(x) for x in (done.min(), until.max(initial=0)))
        return LaneSteps(
            m=state[:n, :count], t=reached, taken=now, going=going, done=ended, calls=calls,
            records=records_of(kernel, row), outputs=np.arange(first, max(first, most)),
            points=out[first : max(first, most), :, :count], until=until,
            path=None if path is None else moved_rows(path[..., :count], n),
            h=row["h"] if graph.sizes is not None else None,
        )  # fmt: skip

    def _looked_into(
        self, run: Run, code: tuple[Hashable, StepGraph], lanes: IntegerArray, back: HandBack, done: LaneSteps
    ) -> LaneSteps:
        """The steps up to terminal events; events are recorded."""
        if self.search is not None:
            done = self.search(lanes, (back.t[lanes], back.m[lanes], back.taken[lanes]), done)
        if done.halted is None:
            return done
        graph, calls = code[1], np.array(done.calls)
        records = {name: (np.array(x), kind) for name, (x, kind) in done.records.items()}
        for row in np.unique(done.halted[done.halted >= 0]):
            here = done.halted == row
            if not graph.largest and not graph.summed:
                calls[here] = np.minimum(calls[here], (row + 1) * (graph.calls or 0))
                continue
            # what steps report is known as totals only, so that the steps up to the event are made again
            again = self._stepped(run, code, lanes[here], back, int(row) + 1)
            calls[here] = again.calls
            for name, (x, _) in again.records.items():
                records[name][0][here] = x
        return done._replace(calls=calls, records=records)

    def _given(self, kernel: Kernel, lanes: IntegerArray) -> dict[str, Any]:
        """Fields of the argument of a kernel that do not depend on the loop."""
        start = self.start[lanes]
        filled = kernel.packed(len(lanes), {"x": start.T})
        fields: dict[str, Any] = {"constants": kernel.run_values(self.values), "start": filled}
        if kernel.lane_constants:
            rows = np.ones((len(kernel.lane_constants), filled.shape[1]))
            rows[:, : len(lanes)] = [
                self.values[number.name][lanes] if isinstance(number, LaneConstant) else number(start)
                for number in kernel.lane_constants
            ]
            fields["rows"] = rows
        return fields
