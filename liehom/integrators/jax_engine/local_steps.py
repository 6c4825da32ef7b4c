"""A step at one point on JAX arrays, in two forms that give the same numbers to round-off.

* "arrays": the step's own code runs on JAX arrays of shape (..., N).  Its operations are as many as those of the numpy
  code, whatever N and dim g are.  XLA compiles it fast.  psi sees the whole array, and may couple its points.
* "graph": the scalar graph of the step (`liehom.tracing`), with the trajectories on the last axis.  XLA compiles n
  operations in a time that grows like n^2, but short graphs run several times faster than arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Protocol, final

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.homogeneous import Action, GeneratorField
from liehom.integrators.compiled.parameters import arg_values
from liehom.integrators.run.clock import MAX_RATE, MIN_RATE, RATE_SAMPLES
from liehom.integrators.run.options import END, IMPLICIT, NOT_FINITE
from liehom.tracing import StepGraph
from liehom.tracing.jax_code import JaxArray, evaluate_with_jax

NEWTON_ITERATIONS = 8
"""Iterations for the step size after which the time reparametrization gives a time."""
NEWTON_ROUNDOFFS = 1e4
"""Largest error of that time, in units of round-off."""


class Moved(NamedTuple):
    """A step of one size.

    Attributes
    ----------
    point : array of shape (..., N)
    code : int array of shape (...,)
        `END` if the point is finite and the equations of the step are solved, else how the step failed.
    failed, near : arrays of shape (...,)
        1 if a linear system of the correction had no solution, or the step came near the cone on which some have none.
    """

    point: JaxArray
    code: JaxArray
    failed: JaxArray
    near: JaxArray


class LocalOnJax(NamedTuple):
    """A step at one point, as a function of its size s (...,).

    Attributes
    ----------
    moved : callable
        s -> `Moved`.
    clock : tuple of (int, array)
        (k, c_k) of tau(s) = s + sum_k c_k s^k; empty if time is s.
    local : LocalStep or None
        The step of the library; None for a graph.
    """

    moved: Callable[[JaxArray], Moved]
    clock: tuple[tuple[int, JaxArray], ...]
    local: LocalStep | None = None

    def time(self, s: JaxArray) -> JaxArray:
        """Time that passes in a step of size s."""
        total: Any = s
        for k, c in self.clock:
            total = total + c * s**k
        return total

    def runs(self, s: JaxArray) -> JaxArray:
        """Whether tau increases at an admissible rate over a step of size s, as in `liehom.integrators.run.clock`."""
        import jax.numpy as jnp

        if not self.clock:
            return jnp.ones(jnp.shape(s), dtype=bool)
        parts = jnp.stack([s * (i / RATE_SAMPLES) for i in range(RATE_SAMPLES + 1)])
        times = self.time(parts)
        advance, part = (times[1:] - times[:-1]) * jnp.sign(s), jnp.abs(s) / RATE_SAMPLES
        admissible = jnp.all((advance > MIN_RATE * part) & (advance < MAX_RATE * part), axis=0)
        return admissible | (s == 0)

    def size_for(self, time: JaxArray) -> tuple[JaxArray, JaxArray]:
        """The size s with tau(s) = time, by Newton's method, and whether it was found."""
        import jax.numpy as jnp

        s: Any = time
        if not self.clock:
            return s, jnp.ones(jnp.shape(s), dtype=bool)
        for _ in range(NEWTON_ITERATIONS):
            slope = 1 + sum(k * c * s ** (k - 1) for k, c in self.clock)
            s = s + (time - self.time(s)) / jnp.clip(slope, MIN_RATE, MAX_RATE)
        bound = NEWTON_ROUNDOFFS * float(np.finfo(s.dtype).eps) * jnp.abs(time)
        return s, jnp.abs(self.time(s) - time) <= bound


class StepOnJax(Protocol):
    """A step as a function of point, time and leaves of args, for the loops of `liehom.integrators.jax_engine`."""

    def at(self, field: GeneratorField, m: JaxArray, t: JaxArray, start: JaxArray) -> LocalOnJax:
        """The step at the points m (..., N) and times t (...,) of trajectories that begin at `start`."""
        ...


@final
@dataclass(frozen=True, slots=True, eq=False)
class ArrayStep:
    """The step's own code on JAX arrays.

    Attributes
    ----------
    action : Action
    step : Step
    orbit_dimension : int
    nominal : bool
    error_terms : int
        See `Step.at`.
    """

    action: Action
    step: Step
    orbit_dimension: int
    nominal: bool
    error_terms: int = 0

    def at(self, field: GeneratorField, m: JaxArray, t: JaxArray, start: JaxArray) -> LocalOnJax:
        """The step at the points m (..., N) and times t (...,)."""
        psi = Generator(field, self.orbit_dimension, start)
        local = self.step.at(self.action, psi, m, t[..., None], error_terms=self.error_terms)
        clock: Any = () if self.nominal else local.clock
        return LocalOnJax(partial(_moved, local, m, t), clock, local)


def _moved(local: LocalStep, m: JaxArray, t: JaxArray, s: JaxArray) -> Moved:
    import jax.numpy as jnp

    made: Any = local.point(s[..., None])
    point = jnp.broadcast_to(made, m.shape).astype(m.dtype)
    zero = jnp.zeros(t.shape, t.dtype)
    failed, near = zero, zero
    found: Any = local.diagnostics(s[..., None])
    if "failed" in found:
        failed, near = (jnp.where(found[name][0], 1.0, zero) for name in ("failed", "near"))
    valid: Any = local.valid(s[..., None])
    code = _code(point)
    return Moved(point, code if valid is True else jnp.where(valid, code, np.int32(IMPLICIT)), failed, near)


@final
@dataclass(frozen=True, slots=True, eq=False)
class GraphStep:
    """The scalar graph of a step, with the trajectories on the last axis.

    Attributes
    ----------
    graph : StepGraph
    """

    graph: StepGraph

    def at(self, field: GeneratorField, m: JaxArray, t: JaxArray, start: JaxArray) -> LocalOnJax:
        """The step at the points m (..., N) and times t (...,); the field is that of the graph, with other args."""
        import jax.numpy as jnp

        graph = self.graph
        inputs = {**dict(enumerate(jnp.moveaxis(m, -1, 0))), graph.size: t}
        known = arg_values(field.args, m.ndim - 1)
        for i, function in enumerate(graph.constant_functions):
            name = getattr(function, "name", None)
            value = known[name] if name in known else function(start)
            inputs[-1 - i] = jnp.asarray(value, m.dtype).reshape(t.shape if np.ndim(value) else ())
        made = evaluate_with_jax([c for _, c in graph.clock], inputs, differentiable=True)
        clock = tuple((k, jnp.broadcast_to(c, t.shape)) for (k, _), c in zip(graph.clock, made, strict=True))
        return LocalOnJax(partial(self._moved, inputs, m, t), clock)

    def _moved(self, inputs: dict[int, JaxArray], m: JaxArray, t: JaxArray, s: JaxArray) -> Moved:
        import jax.numpy as jnp

        graph = self.graph
        numbers = [graph.summed[name] for name in ("failed", "near") if name in graph.summed]
        solved = [] if graph.solved is None else [graph.solved]
        outputs = [*graph.point, *numbers, *solved]
        made = evaluate_with_jax(outputs, {**inputs, graph.size + 1: s}, differentiable=True)
        made = [jnp.broadcast_to(x, t.shape) for x in made]
        point = jnp.stack(made[: graph.size], axis=-1).astype(m.dtype)
        code = jnp.where(made[-1], _code(point), np.int32(IMPLICIT)) if solved else _code(point)
        zero = jnp.zeros(t.shape, t.dtype)
        failed, near = made[graph.size : graph.size + 2] if numbers else (zero, zero)
        return Moved(point, code, failed.astype(t.dtype), near.astype(t.dtype))


def _code(point: JaxArray) -> JaxArray:
    import jax.numpy as jnp

    return jnp.where(jnp.all(jnp.isfinite(point), axis=-1), np.int32(END), np.int32(NOT_FINITE))
