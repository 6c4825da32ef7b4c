"""Ordinary steps compiled by JAX within a run of numpy."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib import import_module
from typing import Any, final

import numpy as np

from liehom.base.errors import InputError, TraceError
from liehom.base.typing import Array, IntegerArray
from liehom.flow.engines.lanes import HandBack, LaneSteps, operations, steps_per_call
from liehom.flow.engines.traced_step import args_of_lanes, totals_of, traced_step
from liehom.flow.run.control import SLACK
from liehom.flow.run.run import Run
from liehom.flow.tracing.graph import needed
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.sweeps import evaluate_with_jax

MAX_STORED_STEPS = 256
"""Steps are stored in blocks of powers of 2, at most this one, so that few functions are compiled."""
CPU_OPERATION_COST = 16  # duration of an operation by JAX on the CPU, in units of an operation of machine code
UNROLLED_OPERATIONS = 4000
"""Operations of a step up to which they are compiled one by one, in a time that grows with their square."""
MAX_JITTED = 64  # number of graphs whose jitted functions are cached
_JITTED: dict[str, Any] = {}


def _fingerprint(graph: StepGraph) -> str:
    """Digest of the operations of a graph; graphs with equal operations share their jitted functions."""
    rows = [(x.op, *[a.index for a in x.args], x.value) for x in needed(graph.outputs)]
    layout = [x.index for x in graph.outputs], graph.size, len(graph.largest), len(graph.constant_functions)
    absent = graph.elapsed is None, graph.ordinary is None, graph.sizes is None
    return hashlib.sha256(repr((rows, layout, absent)).encode()).hexdigest()


@final
class JaxKernel:
    """A traced step as a jitted loop; an operation takes `cost` times as long as one of machine code."""

    def __init__(self, graph: StepGraph) -> None:
        try:
            import jax
        except ImportError:
            raise TraceError('engine="jax" needs JAX: pip install jax') from None
        self.graph = graph
        self.cost = CPU_OPERATION_COST if jax.default_backend() == "cpu" else 1
        key = _fingerprint(graph)
        if key not in _JITTED:
            if len(_JITTED) >= MAX_JITTED:
                _JITTED.pop(next(iter(_JITTED)))
            _JITTED[key] = jax.jit(self._loop, static_argnames="stored", **options_of("forward"))
        self._jit = _JITTED[key]

    def __call__(
        self, state: tuple[Any, ...], fixed: tuple[Any, ...], steps: int, *, stored: bool
    ) -> tuple[list[Array], list[Array] | None]:
        """The state (points (N, L), times, numbers of steps, 1 for lanes that go on, records, sizes, attempts) after at
        most `steps` steps, and what is `stored`; `fixed` are (limits, constants, initial time, direction).
        """
        with enabled_x64():
            blocks: list[Any] = []
            done = steps if not stored else 0
            if not stored:
                state, _ = self._jit(state, fixed, steps, stored=0)
            while done < steps and np.any(np.asarray(state[3]) > 0):
                size = min(MAX_STORED_STEPS, 1 << (steps - done).bit_length() - 1)
                state, block = self._jit(state, fixed, size, stored=size)
                blocks.append(block)
                done += size
            path = [np.concatenate(parts) for parts in zip(*blocks, strict=True)] if blocks else None
            return [np.asarray(x) for x in state], path

    def _loop(self, state: Any, fixed: Any, steps: Any, stored: int) -> Any:
        import jax.numpy as jnp
        from jax import lax

        state = tuple(jnp.asarray(x) for x in state)
        if not stored:
            _, state = lax.while_loop(
                lambda s: (s[0] < steps) & jnp.any(s[1][3] > 0),
                lambda s: (s[0] + 1, self._step(s[1], fixed)[0]),
                (0, state),
            )
            return state, None

        def body(s: Any, _: Any) -> Any:
            s, size = self._step(s, fixed)
            return s, (s[0], s[1], size)

        return lax.scan(body, state, None, length=stored)

    def _step(self, state: Any, fixed: Any) -> Any:
        """State after one step, and step sizes; lanes for which the step is not an ordinary one are masked out."""
        import jax.numpy as jnp

        m, t, count, alive, extra, h, tries = state
        limit, constants, origin, direction = fixed
        graph, n = self.graph, self.graph.size
        inputs = {**dict(enumerate(m)), n: t, n + 1: h, **{-1 - i: c for i, c in enumerate(constants)}}
        outputs = [jnp.broadcast_to(x, t.shape) for x in evaluate_with_jax(graph.outputs, inputs)]
        new = jnp.stack(outputs[:n])
        rest = outputs[n:]
        go = (alive > 0) & jnp.all(jnp.isfinite(new), axis=0)
        if graph.elapsed is None:
            after = origin + (count + 1) * h
            go = go & (count + 1 <= limit)
        else:
            after = t + rest.pop(0)
        if graph.ordinary is not None:
            go = go & rest.pop(0)
        size, accepted, proposal = (h, True, h) if graph.sizes is None else [rest.pop(0) for _ in range(3)]
        if graph.elapsed is not None:
            go = go & (direction * (limit - after) > SLACK * jnp.abs(size))
        tried, go = go, go & accepted
        more = [jnp.maximum(extra[i], x) if i < len(graph.largest) else extra[i] + x for i, x in enumerate(rest)]
        kept = jnp.concatenate([jnp.stack(more), extra[len(more) :]]) if more else extra
        state = (
            jnp.where(go, new, m), jnp.where(go, after, t), count + go, jnp.where(tried, 1.0, 0.0),
            jnp.where(go, kept, extra), jnp.where(tried, proposal, h), tries + tried,
        )  # fmt: skip
        return state, jnp.where(go, size, 0.0)


@cache
def options_of(how: str) -> dict[str, Any]:
    """Options of jax.jit on this backend for code that is "forward", "long", or "nested" in a transformation (none). On
    the CPU, fusion emitters compute a number again for each use (without them dop853 takes 1000 times fewer
    operations); for a "long" function LLVM does not optimize (it compiles 3 times faster and runs 1.7 times longer).
    """
    import jax

    options: dict[str, Any] = {"xla_cpu_use_fusion_emitters": False}
    if how == "long":
        options["xla_backend_optimization_level"] = 0
    wanted: dict[str, Any] = {"compiler_options": options}
    try:
        if how != "nested" and jax.default_backend() == "cpu" and jax.jit(lambda x: x + 1, **wanted)(1) == 2:
            return wanted
    except (TypeError, ValueError, RuntimeError):  # other versions have no such options
        pass
    return {}


def enabled_x64() -> Any:
    """A context in which JAX computes in float64."""
    import jax

    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(True)
    return import_module("jax.experimental").enable_x64()


# The fast path of a run by JAX: ordinary steps by compiled code, between the steps that the automaton makes. The
# trajectories are the lanes of a kernel, one kernel for all orbits of one dimension. A lane is masked out before its
# last step, before a time of t_eval, and before a step that fails in any way. Adaptive step sizes are those of each
# lane.


@final
class FastPath:
    """Ordinary steps of a run by compiled code, in calls that say if more are left; where a call ends has no effect."""

    def __init__(self, run: Run, backend: str) -> None:
        o = run.options
        if run.stops.events is not None:
            raise InputError(f"engine={backend!r} does not look for events: take engine='llvm' or engine='numpy'")
        if run.dtype != np.float64:
            raise InputError(
                f"engine={backend!r} computes in float64, the start is of type {run.dtype}: take engine='numpy'"
            )
        dimensions = np.broadcast_to(np.asarray(run.psi.orbit_dimension), run.shape).reshape(-1)
        points = run.start.reshape(-1, run.start.shape[-1])
        self.groups: list[tuple[IntegerArray, JaxKernel, Any]] = []  # with the constants of the trajectories
        for d in np.unique(dimensions):
            lanes = np.flatnonzero(dimensions == d)
            graph = traced_step(
                run.action, run.field, run.step, points[lanes], int(d), ends=(float(run.span[0]), float(run.span[1])),
                nominal=o.nominal, limits=run.limits if o.dt is None else None,
                args=args_of_lanes(run.field.args, run.shape, lanes), branching=False, unrolled=UNROLLED_OPERATIONS,
            )  # fmt: skip
            rows = graph.constants(points[lanes])
            self.groups.append((lanes, JaxKernel(graph), np.array(rows) if rows else ()))
        self.work: int = max((kernel.cost * operations(kernel.graph) for _, kernel, _ in self.groups), default=1)
        self.calls: Array = np.zeros(())

    def __call__(self, run: Run) -> bool:
        """Make ordinary steps until every lane is masked out or a call is full; whether there are more to be made."""
        if not run.state.active.any() or (run.tried is None and not run.state.taken.any()):
            return False  # the run makes the first step
        steps = steps_per_call(run, self.work)
        if steps < 1:
            return False
        back = HandBack(run)
        for group in self.groups:
            back.take(group[0], self._made(run, group, back, steps))
        # calls of psi are counted for the trajectory with the most of them
        before, self.calls = np.max(self.calls), self.calls + back.calls
        run.state.calls += int(np.max(self.calls) - before)
        return back.finish()

    def _made(self, run: Run, group: tuple[IntegerArray, JaxKernel, Any], back: HandBack, steps: int) -> LaneSteps:
        """At most `steps` steps of the lanes of a kernel."""
        lanes, kernel, constants = group
        graph, samples, origin, dt = kernel.graph, run.state.samples, float(run.span[0]), run.options.dt
        # proposed sizes are without a sign
        h = back.h if dt is None else (run.direction * np.broadcast_to(dt, run.shape)).reshape(-1)
        limit, until = np.full(back.t.shape, float(run.stops.end)), np.zeros(back.t.shape, dtype=int)
        if samples is not None:
            until, times = samples.done.reshape(-1), samples.times
            if len(times):
                limit = np.where(until < len(times), times[np.minimum(until, len(times) - 1)], limit)
        if graph.elapsed is None:  # the limit as a number of steps that end before it
            total: Any = run.stops.total  # a rest below the round-off of times is not a step
            count = np.ceil(np.abs(limit - origin) / np.abs(h) - SLACK)
            limit = np.minimum(count, np.broadcast_to(total, run.shape).reshape(-1)) - 1
        # without a proposal, the run finds the first size
        alive = (back.active & np.isfinite(h))[lanes].astype(np.float64)
        largest, summed = len(graph.largest), list(graph.summed)
        extra = np.zeros((max(1, largest + len(summed)), len(lanes)))
        extra[:largest] = -np.inf
        taken = back.taken[lanes].astype(np.float64)
        state = back.m[lanes].T, back.t[lanes], taken, alive, extra, h[lanes], np.zeros(len(lanes))
        fixed = limit[lanes], constants, origin, float(run.direction)
        (m, t, taken, alive, extra, h, tries), path = kernel(state, fixed, steps, stored=run.keeps)
        rows = int(tries.max(initial=0))
        # where steps iterate, each trajectory has its own number
        calls = extra[largest + summed.index("calls")] if graph.calls is None else tries * graph.calls
        calls = calls + extra[largest + summed.index("looks")] if "looks" in summed else calls
        return LaneSteps(
            m=m, t=t, taken=taken.astype(int), going=alive > 0, done=np.zeros(len(lanes), dtype=bool), calls=calls,
            records=totals_of(graph, list(extra)) if rows else {}, outputs=np.zeros(0, dtype=int), points=np.zeros(0),
            until=until[lanes], path=None if path is None else (path[1][:rows], path[0][:rows], path[2][:rows]),
            h=h if dt is None else None,
        )  # fmt: skip
