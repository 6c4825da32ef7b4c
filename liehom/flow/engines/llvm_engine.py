"""LlvmEngine: runs in machine code, every step of every trajectory, in lockstep or with a size of its own.

The engine keeps machine code, the traces behind it and schedules from call to call. A point that
is not finite, a clock that is not admissible, or equations that were not solved end the compiled part of a trajectory
before that step, which the automaton then makes or diagnoses.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Hashable, Mapping
from typing import Any, final

import numpy as np

from liehom.base.errors import ConvergenceError, InputError
from liehom.base.typing import Array, IntegerArray, Pytree
from liehom.flow.action.fingerprint import Watch
from liehom.flow.engines.compiled_events import EventSearch
from liehom.flow.engines.engine import Problem, executed
from liehom.flow.engines.lanes import (
    OPERATIONS_PER_CALL,
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
    stores_path,
    times_until,
    with_guard,
)
from liehom.flow.engines.lattice import LatticeStep, lattice_step, solved_on_lattice
from liehom.flow.engines.plan import Plan, RunSchedule, Schedule, plan_key, plan_names
from liehom.flow.engines.traced_step import arg_values, args_form, args_of_lanes, traced_step
from liehom.flow.run.check import is_unbounded
from liehom.flow.run.options import END
from liehom.flow.run.records import bounds_of
from liehom.flow.run.run import Run
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import Generator
from liehom.flow.tracing.graph import UNROLLED_OPERATIONS, LaneConstant
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import Kernel

COPIES_WITH_EVENTS = 8  # arrays of the size of the path, about, while events are sought
MIN_STEPS_WITH_ENDS = 64  # with terminal events, steps in the first call; further calls double their number
MAX_PLANNED_LANES = 100_000  # plans are kept for ensembles of at most this size, because they hold arrays of its size
PLANNED_STEPS = 4  # a plan makes at most this multiple of the steps of the first call
RANKED = 64  # number of initial points, at most, at which the rank of the range condition is found
MAX_SCHEDULES = MAX_PLANS = 16  # numbers of schedules and of plans that are kept


@final
class LlvmEngine:
    """The engine "llvm", which makes steps by machine code; those that it cannot make are made in numpy."""

    name = "llvm"

    def __init__(self) -> None:
        self._store = CodeStore()
        self._plans: dict[Hashable, Plan] = {}
        self._lattice: LatticeStep | None = None
        self._watch: Watch | None = None

    def __reduce__(self) -> tuple[type[LlvmEngine], tuple[()]]:
        return type(self), ()  # machine code belongs to a process

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem."""
        if self._watch is None or self._watch.changed():
            self._store, self._plans, self._lattice = CodeStore(), {}, None
            self._watch = Watch(problem.bound, problem.start, problem.span[0])
        if problem.field.sites:
            step, self._lattice = self._lattice, None  # its planes serve one call at a time
            if step is None or problem.args is not None:
                step = lattice_step(problem)
            solution = solved_on_lattice(problem, step)
            self._lattice = step
            return solution
        runs: list[_CompiledRun] = []

        def fast_path(run: Run) -> Callable[[Run], bool]:
            runs.append(_CompiledRun(run, self._store))
            return runs[0]

        solution = executed(problem, fast_path)
        if runs[0].groups:  # an ensemble may be empty
            self._keep_plan(problem, runs[0], solution)
        return solution

    def again(self, t_span: object, y0: object, options: Mapping[str, Any], args: Pytree = None) -> Solution | None:
        """The solution of a call like one before, for other points and args; None if it needs a closer look."""
        if not self._plans or self._watch is None or self._watch.changed():
            return None
        key = plan_key(t_span, y0, options, args)
        try:
            plan = self._plans.get(key)
        except TypeError:  # not hashable
            return None
        return None if plan is None else plan(y0, args)  # type: ignore[arg-type]

    def _keep_plan(self, problem: Problem, run: _CompiledRun, solution: Solution) -> None:
        """Keep the plan of a call, if it was one that needs nothing but points and args."""
        o, (_, key, graph) = problem.options, run.groups[0]
        work = run.work * np.sum(solution.n_steps)
        if problem.args is not None and problem.step.prepares_by_psi:
            return
        if len(run.groups) > 1 or graph.guard is None or solution.status != END or work > OPERATIONS_PER_CALL:
            return
        if (
            o.events is not None
            or o.checkpoint is not None
            or o.progress
            or o.dense_output
            or (run.schedule is None and o.t_eval is None)
        ):
            return
        shape = np.asarray(problem.start).shape
        if np.prod(shape[:-1]) > MAX_PLANNED_LANES:
            return
        kernel = self._store.kernel(key, graph, int(np.prod(shape[:-1], dtype=int)))
        if not all(isinstance(number, LaneConstant) for number in kernel.lane_constants):
            return
        most = PLANNED_STEPS * (int(np.max(solution.n_steps)) + (0 if o.t_eval is None else len(o.t_eval)) + 1)
        plan = Plan(kernel, run.schedule, problem, run.values, solution.report, most)
        if len(self._plans) >= MAX_PLANS:
            self._plans.pop(next(iter(self._plans)))
        for name in plan_names(problem):
            self._plans[name] = plan


@final
class CodeStore:
    """Traces, machine code and schedules for one field, step, exponential and clock."""

    def __init__(self) -> None:
        self.graphs: dict[Hashable, StepGraph] = {}
        self.kernels: dict[Hashable, Kernel] = {}
        self.schedules: dict[RunSchedule, Schedule] = {}

    def graph(self, run: Run, dimension: int, points: Array) -> tuple[Hashable, StepGraph]:
        """The graph of a step on orbits of a dimension, traced if it is not known, and its key."""
        o, tight = run.options, run.action.tight_frame
        frame = None if tight is None else (tight.symmetric, round(float(tight.isotropy), 9))
        uniform = o.dt is not None and bool((o.dt == np.max(o.dt, initial=0.0)).all())
        args, lead = run.field.args, len(run.shape)
        bounds = o.dt is None and (run.limits.moves, run.limits.gap is None, is_unbounded(run.limits.gap))
        key = (dimension, uniform, bounds, o.nominal, run.step.trace_key, frame, args_form(args, lead))
        if key not in self.graphs:
            limits = run.limits if o.dt is None else None

            def traced(*, stops: bool) -> StepGraph:
                return traced_step(
                    run.action, run.field, run.step, points, dimension, nominal=o.nominal, limits=limits,
                    ends=(float(run.span[0]), float(run.span[1])), stops=stops,
                    args=args, lead=lead, unrolled=UNROLLED_OPERATIONS,
                )  # fmt: skip

            raised = run.step.order > run.step.base_order and not o.nominal  # such steps have a clock
            graph = traced(stops=not uniform or raised)
            if graph.reached is None and graph.elapsed is not None:
                graph = traced(stops=True)
            self.graphs[key] = with_guard(graph, run.action, dimension)
        return key, self.graphs[key]

    def kernel(self, key: Hashable, graph: StepGraph, lanes: int) -> Kernel:
        """The machine code of a graph, in blocks for this number of lanes."""
        width = block_width(graph, lanes)
        if (key, width) not in self.kernels:
            self.kernels[key, width] = Kernel(graph, width)
        return self.kernels[key, width]

    def schedule(self, run: Run) -> Schedule:
        """The micro-steps of a run with steps of one size."""
        wanted = RunSchedule.of(run, keeps=stores_path(run))
        if wanted not in self.schedules:
            if len(self.schedules) >= MAX_SCHEDULES:
                self.schedules.pop(next(iter(self.schedules)))
            self.schedules[wanted] = wanted.schedule()
        return self.schedules[wanted]


@final
class _CompiledRun:
    """Steps of a run by machine code; the number of steps in one call has no effect on the results."""

    def __init__(self, run: Run, store: CodeStore) -> None:
        if run.dtype != np.float64:
            raise InputError(
                f"engine='llvm' computes in float64, the start is of type {run.dtype}: take engine='numpy'"
            )
        self.store = store
        self.search = None if run.stops.events is None else EventSearch(run)
        self.start = run.start.reshape(-1, run.start.shape[-1]).astype(np.float64)
        dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
        self.groups: list[tuple[IntegerArray, Hashable, StepGraph]] = []
        for d in np.unique(dimensions):
            lanes = np.flatnonzero(dimensions == d)
            self.groups.append((lanes, *store.graph(run, int(d), self.start[lanes])))
        self.work = max((operations(graph) for _, _, graph in self.groups), default=1)
        self.schedule = store.schedule(run) if self.groups and self.groups[0][2].reached is None else None
        latest = bounds_of((float(run.span[0]), float(run.span[1])))[1]
        self.values: dict[str, Any] = {**arg_values(run.field.args, len(run.shape)), **run.limits._asdict()}
        self.values |= {"latest": latest, "rest": float(run.rest)}

        if len(self.start) and not run.state.taken.any() and run.step.uses_isotropy:
            self._note_ranks(run)

    def _note_ranks(self, run: Run) -> None:
        """Record the ranks of the range condition at some of the initial points; compiled steps know of none."""
        some = np.unique(np.linspace(0, len(self.start) - 1, min(len(self.start), RANKED)).astype(int))
        points, times = self.start[some], np.full(len(some), float(run.span[0]))
        dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
        args = run.field.args
        field = run.field if args is None else run.field.with_args(args_of_lanes(args, run.shape, some))
        psi = Generator(field, dimensions[some], points)
        with contextlib.suppress(np.linalg.LinAlgError, ConvergenceError):  # the first step will end with it
            step = run.step.prepare(run.action, psi, points, times)  # what it has prepared is for all lanes
            local = step.at(run.action, psi, points, times[:, None])
            run.state.statistics.take_lowest(local.diagnostics(np.zeros((len(some), 1))), some, times, points)

    def __call__(self, run: Run) -> bool:
        """Make steps until every lane is at the end or has a step that is not made here, or a call is full."""
        now, active = run.state, run.state.active.reshape(-1)
        if not active.any():
            return False
        steps = steps_per_call(run, self.work, 1 if self.search is None else COPIES_WITH_EVENTS)
        if self.search is not None and self.search.ends_runs:
            steps = min(steps, max(MIN_STEPS_WITH_ENDS, int(np.max(now.taken))))
        if steps < 1:
            return False
        back = HandBack(run)
        for members, key, graph in self.groups:
            here = members[active[members]]
            if graph.reached is None:
                parts = [here[back.taken[here] == taken] for taken in np.unique(back.taken[here])]
            else:
                parts = [here] if len(here) else []
            for some in parts:
                done = self._stepped(run, (key, graph), some, back, steps)
                back.take(some, self._looked_into(run, (key, graph), some, back, done))
        # calls of psi are counted for the trajectory with the most of them
        now.calls += int(np.max(back.calls, initial=0))
        return back.finish()

    def _stepped(
        self, run: Run, code: tuple[Hashable, StepGraph], lanes: IntegerArray, back: HandBack, steps: int
    ) -> LaneSteps:
        """At most `steps` steps of some lanes by the code of a key, which have all taken as many if in lockstep."""
        kernel = self.store.kernel(*code, len(lanes))
        if code[1].reached is None:
            return self._in_lockstep(run, kernel, lanes, back, int(back.taken[lanes[0]]), steps)
        return self._by_themselves(run, kernel, lanes, back, steps)

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

    def _in_lockstep(
        self, run: Run, kernel: Kernel, lanes: IntegerArray, back: HandBack, taken: int, steps: int
    ) -> LaneSteps:
        """Steps of lanes that have all taken as many."""
        plan: Any = self.schedule
        n, count = self.start.shape[-1], len(lanes)
        last = min(taken + steps, plan.steps)
        begin, end = int(plan.first[taken]), int(plan.first[last])
        state = kernel.packed(
            count, {"x": back.m[lanes].T, "alive": 1.0, "count": float(end), **lowest_numbers(kernel.graph)}
        )
        low, high = int(plan.rows[begin]), int(plan.rows[end])
        out = np.empty((high - low, n, state.shape[1]))
        run_blocks(
            kernel,
            state,
            {
                **self._given(kernel, lanes),
                "begin": begin, "end": end, "sizes": plan.sizes, "times": plan.times,
                "codes": plan.codes, "repeats": plan.repeats, "out": out.ctypes.data - low * n * state.shape[1] * 8,
            },
            end - begin,
        )  # fmt: skip
        row = {name: state[i, :count] for i, name in enumerate(kernel.names)}
        alive = row["alive"] > 0
        taken_now = np.where(alive, last, np.searchsorted(plan.first, row["count"], side="right") - 1)
        reached, outputs, out = plan.reached[taken_now], plan.output[low:high], out[..., :count]
        path = None
        if stores_path(run):
            ends = plan.ends[low:high]
            number = np.arange(taken, last)[:, None]
            sizes = plan.sizes[plan.first[1:] - 1][taken:last, None]
            path = (np.broadcast_to(plan.reached[taken + 1 : last + 1, None], (last - taken, count)), out[ends],
                    np.where(number < taken_now, sizes, 0.0))  # fmt: skip
        return LaneSteps(
            m=state[:n, :count], t=reached, taken=taken_now, going=alive & (last < plan.steps),
            done=alive & (last == plan.steps), calls=calls_of(kernel, row, taken_now - taken),
            records=records_of(kernel, row), outputs=outputs[outputs >= 0], points=out[outputs >= 0],
            until=times_until(run, reached), path=path,
        )  # fmt: skip

    def _by_themselves(self, run: Run, kernel: Kernel, lanes: IntegerArray, back: HandBack, steps: int) -> LaneSteps:
        """Steps of lanes with their own sizes and times."""
        n, count, graph, samples = self.start.shape[-1], len(lanes), kernel.graph, run.state.samples
        times = np.zeros(0) if samples is None else samples.times
        at_end = len(times) > 0 and times[-1] == run.stops.end
        stops = np.concatenate([times[: len(times) - at_end], [run.stops.end, run.stops.end]]).astype(np.float64)
        done = np.zeros(count) if samples is None else samples.done.reshape(-1)[lanes]
        dt = run.options.dt
        sizes = back.h[lanes] if dt is None else run.direction * np.broadcast_to(dt, run.shape).reshape(-1)[lanes]
        rows = {"x": back.m[lanes].T, "alive": 1.0, "count": back.taken[lanes], "t": back.t[lanes], "stop": done,
                 "h": sizes, **lowest_numbers(graph)}  # fmt: skip
        state = kernel.packed(count, rows if graph.sizes is None else {**rows, "kept": done})
        out = np.empty((len(stops) + 1, n, state.shape[1]))
        path = np.zeros((steps, n + 2, state.shape[1])) if stores_path(run) else None
        run_blocks(
            kernel,
            state,
            {
                **self._given(kernel, lanes),
                "begin": 0, "end": steps, "stops": stops, "last_stop": len(stops) - 2,
                "origin": float(run.span[0]), "out": out, "path": path,
            },
            steps,
        )  # fmt: skip
        row = {name: state[i, :count] for i, name in enumerate(kernel.names)}
        taken, reached, alive = row["count"].astype(int), row["t"], row["alive"]
        tries = row.get("tries", taken - back.taken[lanes])
        until = np.where(alive < 0, len(times), row["stop" if graph.sizes is None else "kept"].astype(int))
        first = int(done.min()) if count else 0
        return LaneSteps(
            m=state[:n, :count], t=reached, taken=taken, going=alive > 0, done=alive < 0,
            calls=calls_of(kernel, row, tries) + (graph.first is not None and np.isinf(sizes)),
            records=records_of(kernel, row),
            outputs=np.arange(first, int(until.max(initial=first))),
            points=out[first : int(until.max(initial=first)), :, :count], until=until,
            path=None if path is None else moved_rows(path[..., :count], n),
            h=row["h"] if graph.sizes is not None else None,
        )  # fmt: skip
