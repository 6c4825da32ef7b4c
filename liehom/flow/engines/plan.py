"""Calls that are made again: plans and schedules of compiled runs."""

from __future__ import annotations

import threading
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.pytrees import check_numbers
from liehom.base.typing import Array, BooleanArray, IntegerArray, Pytree
from liehom.flow.engines.engine import Problem
from liehom.flow.engines.lanes import run_blocks
from liehom.flow.engines.traced_step import arg_values, args_form
from liehom.flow.run.options import END, MESSAGES
from liehom.flow.run.records import Report
from liehom.flow.run.run import Run
from liehom.flow.run.solution import Solution
from liehom.flow.tracing.graph import LaneConstant
from liehom.flow.tracing.machine import Kernel

# Schedule of a run with steps of one size: the micro-steps of all trajectories, made once for (span, dt, t_eval). A
# *micro-step* starts at the point before a step and goes to the end of the step, or to an output time within it.


@final
@dataclass(frozen=True, slots=True, eq=False)
class Schedule:
    """Micro-steps of a run with steps of one size."""

    sizes: Array  # (q,), signed
    times: Array  # (q,), before each micro-step
    codes: IntegerArray  # (q,): twice the row where the point is stored (-2: none), plus 1 if the trajectory goes there
    repeats: IntegerArray  # (q,): the next micro-step of another size or code, or that is stored or does not go on
    first: IntegerArray  # (n + 1,): first micro-step of each of the n steps, and q
    reached: Array  # (n + 1,): times before the first step and after each step
    rows: IntegerArray  # (q + 1,): number of points that are stored before each micro-step
    output: IntegerArray  # for each stored point the index of its output time, -1 for none
    ends: BooleanArray  # for each stored point whether it is the end of a step

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.first) - 1


def schedule(
    span: tuple[float, float], dt: float, steps: int, times: Array | None, *, keeps: bool, whole: bool = True
) -> Schedule:
    """The schedule of `steps` steps of size dt, the last of them to the end of the span if it is the `whole` run."""
    begin, end = span
    direction = 1.0 if end >= begin else -1.0
    reached: Array = begin + np.arange(steps + 1, dtype=np.float64) * (direction * dt)
    reached[0] = begin
    sizes = np.full(steps, direction * dt)
    if whole:
        reached[-1], sizes[-1] = end, end - reached[-2]
    output = np.full(steps, -1)
    wanted = np.zeros(0) if times is None else times
    offset = int(len(wanted) > 0 and wanted[0] == begin)  # the start is stored by the run
    wanted = wanted[offset:]
    if not whole:
        wanted = wanted[direction * wanted <= direction * reached[-1]]
    step = np.searchsorted(direction * reached[1:], direction * wanted)
    at_end = np.flatnonzero(reached[step + 1] == wanted)
    if len(at_end):
        at_end = at_end[np.unique(step[at_end], return_index=True)[1]]
        output[step[at_end]] = at_end + offset
    within = np.setdiff1d(np.arange(len(wanted)), at_end)
    order = np.argsort(np.concatenate([2 * np.arange(steps) + 1, 2 * step[within]]), kind="stable")
    output = np.concatenate([output, within + offset])[order]
    commits = order < steps
    stored = (output >= 0) | (commits & keeps)
    rows = np.concatenate([[0], np.cumsum(stored)])
    sizes = np.concatenate([sizes, wanted[within] - reached[step[within]]])[order]
    alone = stored | ~commits
    begins = np.append(True, alone[1:] | alone[:-1] | (sizes[1:] != sizes[:-1]))
    places = np.append(np.flatnonzero(begins), len(sizes))
    return Schedule(
        sizes=sizes, times=np.concatenate([reached[:-1], reached[step[within]]])[order],
        codes=(2 * np.where(stored, rows[:-1], -1) + commits).astype(np.int64),
        repeats=places[np.cumsum(begins)].astype(np.int64), first=np.concatenate([[0], np.flatnonzero(commits) + 1]),
        reached=reached, rows=rows, output=output[stored], ends=commits[stored],
    )  # fmt: skip


class RunSchedule(NamedTuple):
    """The numbers from which the schedule of a run follows, hashable."""

    span: tuple[float, float]
    dt: float
    steps: int
    times: tuple[float, ...] | None
    keeps: bool
    whole: bool

    @classmethod
    def of(cls, run: Run, *, keeps: bool) -> RunSchedule:
        """That of a run with steps of one size; no more steps than `max_steps` are scheduled."""
        samples = run.state.samples
        times = None if samples is None else tuple(samples.times.tolist())
        total = float(np.max(np.asarray(run.stops.total)))
        steps, dt = int(min(total, run.options.max_steps)), float(np.max(np.asarray(run.options.dt)))
        return cls((float(run.span[0]), float(run.span[1])), dt, steps, times, keeps, steps == total)

    def schedule(self) -> Schedule:
        """The schedule itself."""
        times = None if self.times is None else np.array(self.times)
        return schedule(self.span, self.dt, self.steps, times, keeps=self.keeps, whole=self.whole)


# Plan: a call that was made before, so that only points and args are new: nothing is traced or checked twice. Only for
# steps without numbers for the report; steps with sizes of their own need output times. The machine code checks what
# `Propagator` would check of the points: that they are finite and that their orbits have the largest dimension. A plan
# whose lanes do not all come to the end makes nothing, and the call is made in the ordinary way.

SMALL = 64  # number of lanes up to which the state of the kernel is kept
SIZES = frozenset(["dt", "rtol", "atol"])  # options, besides t_eval, that a plan may have


def plan_key(t_span: object, y0: object, options: Mapping[str, Any], args: Pytree = None) -> Hashable | None:
    """The times, sizes and shapes of a call; None if it has other options or arguments of other types."""
    if type(t_span) is not tuple or len(t_span) != 2 or type(y0) is not np.ndarray or y0.dtype != np.float64:
        return None
    times: Any = options.get("t_eval")
    kind, sizes = type(times), []
    for name, value in options.items():
        if name in SIZES and type(value) is float:
            sizes.append((name, value))
        elif name != "t_eval":
            return None
    if kind is np.ndarray:
        times = (times.dtype.char, times.tobytes())
    elif kind is list or kind is tuple:
        times = tuple(times)
    elif times is not None:
        return None
    form = None if args is None else args_form(args, y0.ndim - 1)
    return (*t_span, times, tuple(sorted(sizes)), y0.shape, form)


def plan_names(problem: Problem) -> list[Hashable]:
    """The keys of a problem: its output times as an array and as a list, tolerances that were given or not."""
    o, start = problem.options, np.asarray(problem.start)
    span = (float(problem.span[0]), float(problem.span[1]))
    sizes: list[dict[str, Any]] = [{"dt": float(np.max(o.dt))}] if o.dt is not None else []
    if o.dt is None and np.ndim(o.atol) == 0:
        tolerances = {"rtol": float(o.rtol), "atol": float(o.atol)}
        sizes = [{k: tolerances[k] for k in some} for some in (("rtol", "atol"), ("rtol",), ("atol",), ())]
        sizes = [x for x in sizes if {**DEFAULTS, **x} == tolerances]
    times: list[dict[str, Any]] = [{}]
    if o.t_eval is not None:
        times = [{"t_eval": o.t_eval}, {"t_eval": tuple(o.t_eval.tolist())}]
    keys = [plan_key(span, start.astype(np.float64), {**s, **t}, problem.args) for s in sizes for t in times]
    plain = o.first_step is None and np.isinf(o.max_step) and not o.min_step and o.looks is None
    plain = plain and (o.dt is None or bool((o.dt == np.max(o.dt)).all()))
    return [key for key in keys if key is not None] if plain else []


DEFAULTS = {"rtol": 1e-6, "atol": 1e-9}  # tolerances of a call that gives none


@final
class Plan:
    """A call that was made before."""

    def __init__(
        self, kernel: Kernel, schedule: Schedule | None, problem: Problem, values: Mapping[str, Any], report: Report,
        most: int,
    ) -> None:  # fmt: skip
        shape, o = np.asarray(problem.start).shape, problem.options
        self.kernel, self.shape, self.report = kernel, shape, report
        self.n, self.lanes = shape[-1], int(np.prod(shape[:-1], dtype=int))
        self.values = {**values, "checks": 1.0}
        begin = float(problem.span[0])
        times = o.t_eval
        self.starts: bool = times is None or (len(times) > 0 and float(times[0]) == begin)
        state: dict[str, Any] = {"x": np.ones((self.n, self.lanes)), "alive": 1.0}
        if schedule is not None:
            every = np.broadcast_to(schedule.reached, (*shape[:-1], schedule.steps + 1))
            self.t: Array = every if times is None else times
            self.steps: int | None = schedule.steps
            self.rows = slice(0, int(schedule.rows[-1]))
            self.fields: dict[str, Any] = {
                "end": len(schedule.sizes), "sizes": schedule.sizes, "times": schedule.times, "codes": schedule.codes,
                "repeats": schedule.repeats,
            }  # fmt: skip
        else:
            self.t = times = np.zeros(0) if times is None else times
            self.steps, self.rows = None, slice(int(self.starts), len(times))
            end = float(problem.span[1])
            stops = np.concatenate([times[: len(times) - int(len(times) > 0 and times[-1] == end)], [end, end]])
            size = (
                np.inf if o.dt is None else float(values["direction"]) * np.broadcast_to(o.dt, shape[:-1]).reshape(-1)
            )
            state |= {"t": begin, "stop": float(self.starts), "h": size}
            state |= {} if kernel.graph.sizes is None else {"kept": float(self.starts)}
            self.fields = {"end": most, "stops": stops, "last_stop": len(stops) - 2, "origin": begin}
        self.first: Array = kernel.packed(self.lanes, state)
        # lanes with sizes of their own have rows for the end, and one that is not read
        self.out_shape = (self.rows.stop + 2, self.n, self.first.shape[1])
        self.constants = kernel.run_values(self.values)
        self.changing = [(i, name) for i, name in enumerate(kernel.run_constants) if name.startswith("args")]
        self.extra: Array = np.ones((max(1, len(kernel.lane_constants)), self.first.shape[1]))
        self.lock = threading.Lock()
        self.alive, self.count = kernel.names.index("alive"), kernel.names.index("count")
        self.checks = slice(i := kernel.names.index("e0"), i + 2) if kernel.graph.summed else None
        self.tries = kernel.names.index("tries") if "tries" in kernel.names else self.count
        if self.lanes <= SMALL:
            self.state, self.out = self.first.copy(), np.empty(self.out_shape)
            self.argument = kernel.argument(
                self.state, start=self.state, out=self.out, constants=self.constants, rows=self.extra, **self.fields
            )
            self.address = self.argument.ctypes.data

    def __call__(self, y0: Array, args: Pytree = None) -> Solution | None:
        """The solution, or None if a trajectory does not come to the end."""
        if not self.lock.acquire(blocking=False):
            return None
        try:
            if args is not None:
                self._take(args)
            return self._solution(y0)
        except (TypeError, ValueError, OverflowError):  # args that are not numbers
            return None
        finally:
            self.lock.release()

    def _take(self, args: Pytree) -> None:
        """Take over the numbers of args."""
        check_numbers(args, self.shape[:-1])
        values = arg_values(args, len(self.shape) - 1)
        for i, name in self.changing:
            self.constants[i] = values[name]
        for row, number in zip(self.extra, self.kernel.lane_constants, strict=False):
            if isinstance(number, LaneConstant):
                row[: self.lanes] = values[number.name]

    def _solution(self, y0: Array) -> Solution | None:
        n, lanes, shape = self.n, self.lanes, self.shape[:-1]
        points = y0.reshape(lanes, n)
        if lanes <= SMALL:
            state, out = self.state, self.out
            state[:] = self.first
            state[:n, :lanes] = points.T
            self.kernel.run(self.address)
        else:
            state, out = self.first.copy(), np.empty(self.out_shape)
            state[:n, :lanes] = points.T
            fields = {**self.fields, "start": state.copy(), "out": out, "constants": self.constants, "rows": self.extra}
            run_blocks(self.kernel, state, fields, self.fields["end"])
        alive = state[self.alive, :lanes]
        if not ((alive > 0) if self.steps is not None else (alive < 0)).all():
            return None
        y = np.empty((lanes, n, self.rows.stop - self.rows.start + self.starts))
        if self.starts:
            y[..., 0] = points
        y[..., int(self.starts) :] = out[self.rows, :, :lanes].transpose(2, 1, 0)
        steps: Any = self.steps if self.steps is not None else state[self.count, :lanes].astype(int)
        statuses: Any = END
        if shape:
            steps = np.full(shape, steps) if self.steps is not None else steps.reshape(shape)
            statuses = np.full(shape, END)
        elif self.steps is None:
            steps = int(steps[0])
        made: Any = self.steps if self.steps is not None else state[self.tries, :lanes]
        graph, report = self.kernel.graph, self.report
        made = made * (graph.calls or 0) + (graph.first is not None)
        if self.checks is not None:
            looks, cuts = state[self.checks, :lanes]
            made, total, cut = made + looks, int(looks.sum()), int(cuts.sum())
            if (total, cut) != (report.looks, report.cuts):
                report = replace(report, looks=total, cuts=cut)
        calls, y = int(np.max(made, initial=0)), y.reshape((*self.shape, y.shape[-1]))
        return Solution(self.t.copy(), y, None, None, None, calls, END, MESSAGES[END], steps, report, statuses)
