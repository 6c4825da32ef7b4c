"""Plan: a call that was made before, so that only points and args are new: nothing is traced or checked twice.

Only for steps without numbers for the report; steps with sizes of their own need output times. The machine code checks
what `Propagator` would check of the points: that they are finite and that their orbits have the largest dimension. A
plan whose lanes do not all come to the end makes nothing, and the call is made in the ordinary way.
"""

from __future__ import annotations

import threading
from collections.abc import Hashable, Mapping
from typing import Any, final

import numpy as np

from liehom.integrators.compiled.lanes import run_blocks
from liehom.integrators.compiled.parameters import arg_values, args_form
from liehom.integrators.compiled.schedule import Schedule
from liehom.integrators.engine import Problem
from liehom.integrators.run.options import END, MESSAGES
from liehom.integrators.run.solution import Report, Solution
from liehom.pytrees import check_numbers
from liehom.tracing import Kernel, LaneConstant
from liehom.typing import Array, Pytree

SMALL = 64
"""Number of lanes up to which the state of the kernel is kept."""
SIZES = frozenset(["dt", "rtol", "atol"])
"""Options, besides t_eval, that a plan may have."""


def plan_key(t_span: object, y0: object, options: Mapping[str, Any], args: Pytree = None) -> Hashable | None:
    """The times, sizes and shapes of a call; None if it has other options or arguments of other types.

    Examples
    --------
    >>> plan_key((0, 1), np.zeros(3), {"dt": 0.1})
    (0, 1, None, (('dt', 0.1),), (3,), None)
    """
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
    found = [plan_key(span, start.astype(np.float64), {**s, **t}, problem.args) for s in sizes for t in times]
    plain = o.first_step is None and np.isinf(o.max_step) and not getattr(o, "min_step", 0.0)
    plain = plain and (o.dt is None or bool((o.dt == np.max(o.dt)).all()))
    return [key for key in found if key is not None] if plain else []


DEFAULTS = {"rtol": 1e-6, "atol": 1e-9}
"""Tolerances of a call that gives none."""


@final
class Plan:
    """A call that was made before.

    Parameters
    ----------
    kernel : Kernel
    schedule : Schedule or None
        None for lanes with sizes of their own.
    problem : Problem
        That of the first call.
    values : dict
        Numbers of the run by their names.
    report : Report
        That of the first call.
    most : int
        The largest number of steps of a trajectory, with those that are rejected and those to output times.
    """

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
        calls = self.steps if self.steps is not None else int(state[self.tries, :lanes].max(initial=0))
        statuses: Any = END
        if shape:
            steps = np.full(shape, steps) if self.steps is not None else steps.reshape(shape)
            statuses = np.full(shape, END)
        elif self.steps is None:
            steps = int(steps[0])
        calls *= self.kernel.graph.calls or 0
        y = y.reshape((*self.shape, y.shape[-1]))
        return Solution(self.t.copy(), y, None, None, None, calls, END, MESSAGES[END], steps, self.report, statuses)
