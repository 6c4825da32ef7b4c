"""Steps compiled by JAX within a run of numpy."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any, ClassVar, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import TraceError
from liehom.flow.tracing.graph import TrajectoryConstant, needed
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.machine import Kernel
from liehom.flow.tracing.run_text import ALIVE, DONE, FAILED, Constant
from liehom.flow.tracing.sweeps import evaluate_with_jax, jax, jnp, lax

MAX_STORED_STEPS = 256
"""Steps are stored in blocks of powers of 2, at most this one, so that few functions are compiled."""
MAX_JITTED = 64  # number of graphs whose jitted functions are cached
WAITS = 2.0  # what `alive` says of a lane that has reached an output time, until numpy has stored its point
_JITTED: dict[str, Any] = {}


def _fingerprint(graph: StepGraph) -> str:
    """Digest of the operations of a graph; graphs with equal operations share their jitted functions."""
    rows = [(x.op, *[a.index for a in x.args], x.value) for x in needed(graph.outputs)]
    layout = [x.index for x in graph.outputs], graph.size, len(graph.largest), len(graph.constant_functions)
    absent = [x is None for x in (graph.elapsed, graph.ordinary, graph.sizes, graph.tried, graph.reached)]
    return hashlib.sha256(repr((rows, layout, absent)).encode()).hexdigest()


@final
class JaxKernel(Kernel):
    """The run of a traced step as a jitted loop over steps, all lanes at once, each with its own sizes and times."""

    engine = "jax"
    in_lockstep, cost = False, 16  # cost on the CPU
    # XLA compiles operations one by one in a time that grows with the square of their number
    tracing: ClassVar[dict[str, Any]] = {"branching": False, "unrolled": 4000}

    def _build(self, constants: Sequence[Constant]) -> None:
        if find_spec("jax") is None:
            raise TraceError('engine="jax" needs JAX: pip install jax')
        self._constants: Any = constants
        key = _fingerprint(self.graph)
        if key not in _JITTED:
            if len(_JITTED) >= MAX_JITTED:
                _JITTED.pop(next(iter(_JITTED)))
            _JITTED[key] = jax.jit(self._loop, static_argnames="stored", **options_of("forward"))
        self._jit = _JITTED[key]

    def _place(self, function: TrajectoryConstant) -> Constant:
        place = super()._place(function)
        if isinstance(place, tuple):
            return place
        self.lane_constants.append(function)
        return "lane", len(self.lane_constants) - 1

    def __call__(self, state: npt.NDArray[np.float64], **fields: npt.NDArray[Any] | float | None) -> None:
        known: dict[str, Any] = dict(fields)
        n, k, end, out, path = self.graph.size, known["begin"], known["end"], known["out"], known["path"]
        given = [known["constants" if kind == "run" else "rows"][place] for kind, place in self._constants]
        fixed = given, known["stops"], known["last_stop"], known["origin"]
        alive, stop = (state[self.names.index(name)] for name in ("alive", "stop"))
        with enabled_x64():
            while k < end and np.any(alive == ALIVE):
                stored = 0 if path is None else min(MAX_STORED_STEPS, 1 << (end - k - 1).bit_length())
                steps = min(end - k, stored or end)
                made, new, landed, block = self._jit(np.array(state), fixed, steps, stored=stored)
                state[:] = new
                if path is not None:
                    path[k - known["begin"] :][: int(made)] = block[: int(made)]
                k += int(made)
                waits, ended = alive == WAITS, alive == DONE
                out[stop[waits].astype(int) - 1, :, waits] = np.asarray(landed).T[waits]
                out[stop[ended].astype(int), :, ended] = state[:n, ended].T
                alive[waits] = ALIVE

    def _loop(self, state: Any, fixed: Any, steps: Any, stored: int) -> Any:
        """Number of steps, state, points at stops and rows of the path, after steps of the lanes that do not wait."""
        n, lanes = self.graph.size, state.shape[1]
        s = dict(zip(self.names, state, strict=True))
        if self.graph.first is not None:
            inputs = {**{i: s[f"x{i}"] for i in range(n)}, n: s["t"], **{-1 - i: c for i, c in enumerate(fixed[0])}}
            first = evaluate_with_jax([self.graph.first], inputs)[0]
            s["h"] = jnp.where(jnp.isinf(s["h"]), first, s["h"])

        def body(carried: Any) -> Any:
            k, before, landed, block = carried
            s, new, size = self._step(before, fixed)
            landed = jnp.where((s["alive"] == WAITS) & (before["alive"] == ALIVE), new, landed)
            if stored:
                row = jnp.stack([*[s[f"x{i}"] for i in range(n)], s["t"], size])
                block = lax.dynamic_update_index_in_dim(block, row, k, 0)
            return k + 1, s, landed, block

        start = 0, s, jnp.zeros((n, lanes)), jnp.zeros((stored, n + 2, lanes))
        k, s, landed, block = lax.while_loop(lambda c: (c[0] < steps) & jnp.any(c[1]["alive"] == ALIVE), body, start)
        return k, jnp.stack([s[name] for name in self.names]), landed, block

    def _step(self, s: Any, fixed: Any) -> Any:
        """The state after one step, the point after it or at the stop, and the size, 0 for lanes that do not move."""
        given, stops, last, origin = fixed
        graph, n, sizes, time, h = self.graph, self.graph.size, self.graph.sizes, s["t"], s["h"]
        stop_time = stops[s["stop"].astype(int)]
        inputs = {**{i: s[f"x{i}"] for i in range(n)}, n: time, n + 1: h, n + 2: stop_time}
        numbers = [f"e{i}" for i in range(len(graph.largest) + len(graph.summed))]
        wanted = dict(zip(self.names, graph.point, strict=False))
        wanted |= dict(zip(numbers, (*graph.largest.values(), *graph.summed.values()), strict=True))
        more = {"elapsed": graph.elapsed, "ordinary": graph.ordinary, "tried": graph.tried, "reached": graph.reached}
        more |= {} if sizes is None else {"accepted": sizes.accepted, "proposal": sizes.proposal}
        wanted |= {name: x for name, x in more.items() if x is not None}
        results = evaluate_with_jax(list(wanted.values()), inputs | {-1 - i: c for i, c in enumerate(given)})
        new = {name: jnp.broadcast_to(x, time.shape) for name, x in zip(wanted, results, strict=True)}
        points = jnp.stack([new[f"x{i}"] for i in range(n)])
        going = s["alive"] == ALIVE
        valid = going & jnp.all(jnp.isfinite(points), axis=0) & new.get("ordinary", True)
        ends = new["reached"] & (s["stop"] >= last)
        waits = valid & new["reached"] & ~ends
        full = valid & ~waits
        moved = full & new.get("accepted", True)
        done = moved & ends
        new["count"] = s["count"] + 1
        after = time + new["elapsed"] if "elapsed" in new else origin + new["count"] * h
        new["t"], new["kept"] = jnp.where(done, stop_time, after), s["stop"]
        for i, name in enumerate(numbers):
            new[name] = jnp.maximum(s[name], new[name]) if i < len(graph.largest) else s[name] + new[name]
        state = {name: jnp.where(moved, new[name], x) if name in new else x for name, x in s.items()}
        state["stop"] = s["stop"] + waits
        if sizes is not None:
            state["h"], state["tries"] = jnp.where(full, new["proposal"], h), s["tries"] + full
            state["stop"] = jnp.where(full & ~moved, s["kept"], state["stop"])
        alive = jnp.where(done, DONE, jnp.where(waits, WAITS, s["alive"]))
        state["alive"] = jnp.where(going & ~valid, FAILED, alive)
        return state, points, jnp.where(moved, new.get("tried", h), 0.0)


@cache
def options_of(how: str) -> dict[str, Any]:
    """Options of jax.jit on this backend for code that is "forward", "long", or "nested" in a transformation (none). On
    the CPU, fusion emitters compute a number again for each use (without them dop853 takes 1000 times fewer
    operations); for a "long" function LLVM does not optimize (it compiles 3 times faster and runs 1.7 times longer).
    """
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
    return jax.enable_x64(True) if hasattr(jax, "enable_x64") else import_module("jax.experimental").enable_x64()
