"""Plan: a call that was made before, so that only the points are new: nothing is traced, checked or allocated twice.

Only for steps of one size in lockstep without numbers for the report. The machine code checks what `Propagator` would
check of the points: that they are finite and that their orbits have the largest dimension. A plan whose lanes do not
all come to the end makes nothing, and the call is made in the ordinary way.
"""

from __future__ import annotations

import threading
from collections.abc import Hashable, Mapping
from typing import Any, final

import numpy as np

from liehom.integrators.compiled.lanes import run_blocks
from liehom.integrators.compiled.schedule import Schedule
from liehom.integrators.run.options import END, MESSAGES
from liehom.integrators.run.solution import Report, Solution
from liehom.tracing import Kernel
from liehom.typing import Array

SMALL = 64
"""Number of lanes up to which the state of the kernel is kept."""


def plan_key(t_span: object, y0: object, options: Mapping[str, Any]) -> Hashable | None:
    """What a plan is for: times, size and shape; None if the call has other options or arguments of other types.

    Examples
    --------
    >>> plan_key((0, 1), np.zeros(3), {"dt": 0.1})
    (0, 1, 0.1, None, (3,))
    """
    if type(t_span) is not tuple or type(y0) is not np.ndarray or y0.dtype != np.float64:
        return None
    if len(options) != 1 + ("t_eval" in options):
        return None
    dt, times = options.get("dt"), options.get("t_eval")
    if type(dt) is not float or len(t_span) != 2:
        return None
    kind = type(times)
    if kind is np.ndarray:
        times = (times.dtype.char, times.tobytes())
    elif kind is list or kind is tuple:
        times = tuple(times)
    elif times is not None:
        return None
    return (*t_span, dt, times, y0.shape)


@final
class Plan:
    """A call that was made before.

    Parameters
    ----------
    kernel : Kernel
    schedule : Schedule
    shape : tuple of int
        That of the initial points.
    times : array or None
        Output times.
    values : dict
        Numbers of the run by their names.
    report : Report
        That of the first call.
    """

    def __init__(
        self, kernel: Kernel, schedule: Schedule, shape: tuple[int, ...], times: Array | None,
        values: Mapping[str, float], report: Report,
    ) -> None:  # fmt: skip
        self.kernel, self.schedule, self.shape, self.report = kernel, schedule, shape, report
        self.n, self.lanes = shape[-1], int(np.prod(shape[:-1], dtype=int))
        self.t: Array = (
            times if times is not None else np.broadcast_to(schedule.reached, (*shape[:-1], schedule.steps + 1))
        )
        self.starts: bool = times is None or (len(times) > 0 and times[0] == schedule.reached[0])
        self.calls: int = schedule.steps * (kernel.graph.calls or 0)
        self.steps: Any = schedule.steps if len(shape) == 1 else np.full(shape[:-1], schedule.steps)
        self.statuses: Any = END if len(shape) == 1 else np.full(shape[:-1], END)
        self.alive = kernel.names.index("alive")
        self.constants = kernel.run_values({**values, "checks": 1.0})
        self.first: Array = kernel.packed(self.lanes, {"x": np.ones((self.n, self.lanes)), "alive": 1.0})
        self.rows = int(schedule.rows[-1])
        self.fields: dict[str, Any] = {
            "end": len(schedule.sizes), "sizes": schedule.sizes, "times": schedule.times, "codes": schedule.codes,
            "constants": self.constants,
        }  # fmt: skip
        self.lock = threading.Lock()
        if self.lanes <= SMALL:
            self.state, self.out = self.first.copy(), np.empty((self.rows, self.n, self.first.shape[1]))
            self.argument = kernel.argument(self.state, start=self.state, out=self.out, **self.fields)
            self.address = self.argument.ctypes.data

    def __call__(self, y0: Array) -> Solution | None:
        """The solution, or None if a trajectory does not come to the end."""
        if not self.lock.acquire(blocking=False):
            return None
        try:
            y = self._points(y0)
        finally:
            self.lock.release()
        if y is None:
            return None
        t, steps, statuses = self.t.copy(), self.steps, self.statuses
        if len(self.shape) > 1:
            steps, statuses = steps.copy(), statuses.copy()
        return Solution(t, y, None, None, None, self.calls, END, MESSAGES[END], steps, self.report, statuses)

    def _points(self, y0: Array) -> Array | None:
        """Points (..., N, k) at the output times."""
        n, lanes = self.n, self.lanes
        if lanes <= SMALL:
            state, out = self.state, self.out
            state[:] = self.first
            state[:n, :lanes] = y0.reshape(lanes, n).T
            self.kernel.run(self.address)
        else:
            state = self.first.copy()
            state[:n, :lanes] = y0.reshape(lanes, n).T
            out = np.empty((self.rows, n, state.shape[1]))
            run_blocks(self.kernel, state, {**self.fields, "start": state.copy(), "out": out}, len(self.schedule.sizes))
        if not (state[self.alive, :lanes] > 0).all():
            return None
        y = np.empty((lanes, n, self.rows + self.starts))
        if self.starts:
            y[..., 0] = y0.reshape(lanes, n)
        y[..., int(self.starts) :] = out[..., :lanes].transpose(2, 1, 0)
        return y.reshape((*self.shape, y.shape[-1]))
