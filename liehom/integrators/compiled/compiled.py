"""The fast path of a run by JAX: ordinary steps by compiled code, between the steps that the automaton makes.

The trajectories are the lanes of a kernel, one kernel for all orbits of one dimension. A lane is masked out before its
last step, before a time of t_eval, and before a step that fails in any way. Adaptive step sizes are those of each lane.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError
from liehom.integrators.compiled.jax_kernel import JaxKernel
from liehom.integrators.compiled.parameters import args_of_lanes
from liehom.integrators.compiled.traced_size import SizeLimits
from liehom.integrators.compiled.traced_step import totals_of, traced_step
from liehom.integrators.compiled.widths import operations
from liehom.integrators.run.clock import SLACK
from liehom.integrators.run.run import Run
from liehom.tracing import StepGraph
from liehom.typing import Array, IntegerArray

PATH_BYTES_PER_CALL = 64_000_000
"""Bytes of points, times and sizes that a kernel call records at most."""
OPERATIONS_PER_CALL = 4_000_000_000
"""Scalar operations per kernel call, summed over lanes. Progress, checkpoints and Ctrl-C are handled between calls."""
MIN_STEPS_PER_CALL = 8
"""Steps per kernel call at least: the time between two calls is that of some steps."""


def compiled_steps(run: Run, backend: str) -> FastPath:
    """The fast path of a run, a function that makes ordinary steps of it and returns whether there are more to be made.

    Parameters
    ----------
    run : Run
    backend : "jax"

    Raises
    ------
    InputError
        If the run has something that is not compiled.
    TraceError
        If the step cannot be compiled.
    """
    if run.stops.events is not None:
        raise InputError(f"engine={backend!r} does not look for events: take engine='llvm' or engine='numpy'")
    if run.dtype != np.float64:
        raise InputError(
            f"engine={backend!r} computes in float64, the start is of type {run.dtype}: take engine='numpy'"
        )
    dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
    points = run.start.reshape(-1, run.start.shape[-1])
    groups = []
    for d in np.unique(dimensions):
        lanes = np.flatnonzero(dimensions == d)
        graph = traced_step(
            run.action,
            run.field,
            run.step,
            points[lanes],
            int(d),
            ends=(float(run.span[0]), float(run.span[1])),
            nominal=run.options.nominal,
            limits=_size_limits(run) if run.options.dt is None else None,
            args=args_of_lanes(run.field.args, run.shape, lanes),
        )
        groups.append(LaneGroup(graph, lanes, points[lanes]))
    return FastPath(groups)


def _size_limits(run: Run) -> SizeLimits:
    o = run.options
    return SizeLimits(o.rtol, o.atol, o.max_step, float(run.stops.end), float(run.direction), float(run.tiny))


@final
class LaneGroup:
    """Trajectories with orbits of one dimension, and their kernel.

    Parameters
    ----------
    graph : StepGraph
    lanes : array of int of shape (L,)
        Indices of the trajectories in the flattened ensemble.
    points : array of shape (L, N)
        Their initial points.
    """

    graph: StepGraph
    lanes: IntegerArray

    def __init__(self, graph: StepGraph, lanes: IntegerArray, points: Array) -> None:
        self.graph, self.lanes = graph, lanes
        self.kernel: JaxKernel = JaxKernel(graph)
        rows = graph.constants(points)
        self.constants: Array | None = np.array(rows) if rows else None

    def packed(self, values: npt.NDArray[Any]) -> Array:
        """Values of these lanes from those of the ensemble (last axis)."""
        return np.array(values[..., self.lanes], dtype=np.float64, order="C")

    def run(self, arrays: list[Array | None], steps: int, origin: float, direction: float) -> None:
        """Make at most `steps` steps of all lanes."""
        count = len(self.lanes)
        self.kernel(arrays, count, (0, count), steps, (origin, direction))


@final
class FastPath:
    """Ordinary steps of a run by compiled code.

    The number of steps in one call has no effect on the results: the next call continues where one ended.

    Parameters
    ----------
    groups : list of LaneGroup
    """

    def __init__(self, groups: list[LaneGroup]) -> None:
        self.groups = groups
        self.work: int = max((group.kernel.cost * operations(group.graph) for group in groups), default=1)
        self.calls: Array = np.zeros(())

    def __call__(self, run: Run) -> bool:
        """Make ordinary steps until every lane is masked out or a call is full; whether there are more to be made."""
        lanes = int(np.prod(run.shape, dtype=int))
        if not run.state.active.any() or (run.tried is None and not run.state.taken.any()):
            return False  # the run makes the first step
        most = max(MIN_STEPS_PER_CALL, OPERATIONS_PER_CALL // (self.work * lanes))
        steps = int(min(run.options.max_steps - 1 - int(np.max(run.state.taken)), most))
        if run.keeps:
            steps = min(steps, max(1, PATH_BYTES_PER_CALL // (8 * lanes * (run.start.shape[-1] + 2))))
        if steps < 1:
            return False
        state = _Lanes(run)
        for group in self.groups:
            state.step(group, steps)
        # calls of psi are counted for the trajectory with the most of them
        before, self.calls = np.max(self.calls), self.calls + state.calls
        run.state.calls += int(np.max(self.calls) - before)
        state.hand_back()
        return bool((state.going > 0).any())


class _Lanes:
    """The lanes of a run as rows, while kernels change them."""

    def __init__(self, run: Run) -> None:
        self.run = run
        size = run.start.shape[-1]
        self.m = run.state.m.reshape(-1, size).T.astype(np.float64, order="C", copy=True)
        self.t = np.array(run.state.t, dtype=np.float64).reshape(-1)
        dt = run.options.dt
        self.adaptive = dt is None
        if dt is None:  # proposed sizes, without a sign
            self.h = np.array(run.state.h, dtype=np.float64).reshape(-1)
        else:
            self.h = (run.direction * np.broadcast_to(dt, run.shape)).reshape(-1)
        self.limit = np.full(self.t.shape, float(run.stops.end))
        if run.state.samples is not None and len(run.state.samples.times):
            done, times = run.state.samples.done.reshape(-1), run.state.samples.times
            ahead = times[np.minimum(done, len(times) - 1)]
            self.limit = np.where(done < len(times), ahead, self.limit)
        # without a proposal, the run finds the first size
        self.alive = run.state.active.reshape(-1) & np.isfinite(self.h)
        self.going = np.zeros(self.t.shape)
        self.before = run.state.taken.reshape(-1).astype(np.float64)
        self.count = self.before.copy()
        self.tries = np.zeros(self.t.shape)
        self.paths: list[tuple[IntegerArray, Array, Array, Array | None]] = []
        self.totals: list[tuple[IntegerArray, dict[str, tuple[Array, str]]]] = []
        self.calls = np.zeros(self.t.shape)

    def step(self, group: LaneGroup, steps: int) -> None:
        """Make at most `steps` steps of the lanes of a group."""
        run, graph, lanes = self.run, group.graph, group.lanes
        m, t, count = (group.packed(x) for x in (self.m, self.t, self.count))
        limit = self.limit
        if graph.elapsed is None:  # the limit as a number of steps that end before it
            whole = np.abs(limit - float(run.span[0])) / np.abs(self.h)
            total: Any = run.stops.total  # a rest below the round-off of times is not a step
            limit = np.minimum(np.ceil(whole - SLACK), np.broadcast_to(total, run.shape).reshape(-1)) - 1
        h, limit = group.packed(self.h), group.packed(limit)
        alive, tries = group.packed(self.alive.astype(np.float64)), group.packed(self.tries)
        extra = np.zeros((max(1, len(graph.largest) + len(graph.summed)), m.shape[-1]))
        extra[: len(graph.largest)] = -np.inf
        path = path_t = path_h = None
        if run.keeps:
            path, path_t = np.empty((steps, *m.shape)), np.empty((steps, m.shape[-1]))
            path_h = np.zeros(path_t.shape) if self.adaptive else None
        group.run(
            [m, t, h, limit, count, alive, extra, group.constants, path, path_t, tries, path_h],
            steps,
            float(run.span[0]),
            float(run.direction),
        )
        used = slice(0, len(lanes))
        self.m[:, lanes], self.t[lanes], self.count[lanes] = m[:, used], t[used], count[used]
        self.going[lanes] = alive[used]
        self.tries[lanes] = tries[used] if self.adaptive else count[used] - self.before[lanes]
        if self.adaptive:
            self.h[lanes] = h[used]
        if path is not None and path_t is not None:
            made = slice(0, int(self.tries[lanes].max(initial=0)))
            sizes = None if path_h is None else path_h[made, used]
            self.paths.append((lanes, path[made, :, used], path_t[made, used], sizes))
        self.totals.append((lanes, totals_of(graph, list(extra[:, used]))))
        # where steps iterate, each trajectory has its own number
        here = 0 if graph.calls is not None else len(graph.largest) + list(graph.summed).index("calls")
        self.calls[lanes] = extra[here, used] if graph.calls is None else self.tries[lanes] * graph.calls

    def hand_back(self) -> None:
        """Write the new times, points, sizes and records to the state of the run."""
        run, shape = self.run, self.run.shape
        new = (self.count - self.before).astype(int)
        most = int(self.tries.max(initial=0))
        if most == 0:
            return
        run.state.m = self.m.T.copy().reshape(run.start.shape)
        run.state.t = self.t.reshape(shape) if shape else np.asarray(self.t[0])
        if self.adaptive:
            run.state.h = self.h.reshape(shape)
        run.state.taken = run.state.taken + new.reshape(shape)
        for lanes, extra in self.totals:
            run.state.statistics.add_compiled(lanes, extra, (float(run.span[0]), float(run.span[1])))
        if run.keeps:
            self._record(new, most)

    def _record(self, new: IntegerArray, most: int) -> None:
        """Append the steps to the path of the run: `new` of each trajectory, `most` attempts."""
        run, shape = self.run, self.run.shape
        if len(self.paths) == 1 and len(self.paths[0][0]) == len(new):
            _, points, times, made = self.paths[0]
            points, sizes = np.swapaxes(points, 1, 2), np.zeros(0) if made is None else made
        else:
            points, times = np.zeros((most, len(new), run.start.shape[-1])), np.zeros((most, len(new)))
            sizes = np.zeros(times.shape)
            for lanes, path, path_t, path_h in self.paths:
                points[: len(path), lanes] = np.swapaxes(path, 1, 2)
                times[: len(path_t), lanes] = path_t
                if path_h is not None:
                    sizes[: len(path_t), lanes] = path_h
        if self.adaptive:
            moved = sizes != 0
        else:
            moved = np.arange(most)[:, None] < new
            sizes = np.where(moved, self.h, 0.0)
        run.state.path.extend(
            times.reshape(most, *shape),
            points.reshape(most, *run.start.shape),
            sizes.reshape(most, *shape),
            moved.reshape(most, *shape),
        )
