"""The loop over ordinary steps around a traced step by JAX, the counterpart of `liehom.tracing.Kernel`."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from typing import Any, final

import numpy as np

from liehom.errors import TraceError
from liehom.integrators.run.clock import SLACK
from liehom.tracing import StepGraph, needed
from liehom.tracing.jax_code import evaluate_with_jax

MAX_STORED_STEPS = 256
"""Steps are stored in blocks of powers of 2, at most this one, so that few functions are compiled."""
CPU_OPERATION_COST = 16
"""Duration of an operation by JAX on the CPU, in units of an operation of machine code."""
MAX_JITTED = 64
"""Number of graphs whose jitted functions are cached."""
_JITTED: dict[str, Any] = {}


def _fingerprint(graph: StepGraph) -> str:
    """Digest of the operations of a graph; graphs with equal operations share their jitted functions."""
    rows = [(x.op, *[a.index for a in x.args], x.value) for x in needed(graph.outputs)]
    layout = [x.index for x in graph.outputs], graph.size, len(graph.largest), len(graph.constant_functions)
    optional = graph.elapsed is None, graph.ordinary is None, graph.sizes is None
    return hashlib.sha256(repr((rows, layout, optional)).encode()).hexdigest()


@final
class JaxKernel:
    """A traced step as a jitted loop, with the call of `liehom.tracing.Kernel`.

    Parameters
    ----------
    graph : StepGraph

    Attributes
    ----------
    cost : int
        Duration of an operation, in units of an operation of machine code.
    """

    width = 1

    def __init__(self, graph: StepGraph) -> None:
        try:
            import jax
        except ImportError:
            raise TraceError('engine="jax" needs the extra: pip install "liehom[jax]"') from None
        self.graph = graph
        self.cost = CPU_OPERATION_COST if jax.default_backend() == "cpu" else 1
        key = _fingerprint(graph)
        if key not in _JITTED:
            if len(_JITTED) >= MAX_JITTED:
                _JITTED.pop(next(iter(_JITTED)))
            _JITTED[key] = jax.jit(self._loop, static_argnames="stored", **options_of("forward"))
        self._jit = _JITTED[key]

    def __call__(self, arrays: Sequence[Any], lanes: int, blocks: tuple[int, int], steps: int, time: Any) -> None:
        """Make at most `steps` steps of all lanes; `arrays` are changed in place (the path may be None)."""
        m, t, h, limit, count, alive, extra, constants, path, path_t, *more = arrays
        tries, path_h = more or (np.zeros_like(t), None)
        with enabled_x64():
            fixed = (limit, () if constants is None else constants, *time)
            state = (m, t, count, alive, extra, h, tries)
            if path is None:
                state, _ = self._jit(state, fixed, steps, stored=0)
            done = 0
            while path is not None and done < steps and np.any(np.asarray(state[3]) > 0):
                size = min(MAX_STORED_STEPS, 1 << (steps - done).bit_length() - 1)
                state, (points, times, sizes) = self._jit(state, fixed, size, stored=size)
                path[done : done + size], path_t[done : done + size] = points, times
                if path_h is not None:
                    path_h[done : done + size] = sizes
                done += size
            for old, new in zip((m, t, count, alive, extra, h, tries), state, strict=True):
                old[...] = new

    def _loop(self, state: Any, fixed: Any, steps: Any, stored: int) -> Any:
        import jax.numpy as jnp
        from jax import lax

        state = tuple(jnp.asarray(x) for x in state)
        if not stored:
            found = lax.while_loop(
                lambda s: (s[0] < steps) & jnp.any(s[1][3] > 0),
                lambda s: (s[0] + 1, self._step(s[1], fixed)[0]),
                (0, state),
            )
            return found[1], None

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
        made = [jnp.broadcast_to(x, t.shape) for x in evaluate_with_jax(graph.outputs, inputs)]
        new = jnp.stack(made[:n])
        rest = made[n:]
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
            jnp.where(go, new, m),
            jnp.where(go, after, t),
            count + go,
            jnp.where(tried, 1.0, 0.0),
            jnp.where(go, kept, extra),
            jnp.where(tried, proposal, h),
            tries + tried,
        )
        return state, jnp.where(go, size, 0.0)


@cache
def options_of(how: str) -> dict[str, Any]:
    """Options of jax.jit for code on this backend: "forward", "long", or "nested" in a transformation of JAX (none).

    On the CPU, fusion emitters are switched off. They compute a number again for each of its uses, and so on through a
    whole step: without them RK4 takes 200 times fewer operations, and dop853 1000 times fewer. For a "long" function,
    LLVM does not optimize: a gradient of order 6 on S^4 compiles in 1.3 s instead of 4.3 s, and runs 1.7 times longer.
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
