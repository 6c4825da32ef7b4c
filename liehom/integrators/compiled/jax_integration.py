"""integrate on JAX arrays, in a form that works under jax.jit, jax.grad and jax.vmap.

Between two requested times, steps are made in a loop of fixed length. The point at a requested time is computed by the
step that contains it, at the parameter s with τ(s) = time - t, by Newton's method.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import Any, final

import numpy as np

from liehom.correctors.isotropy.corrected import Corrected
from liehom.correctors.step import Step
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.integrators.compiled.compiled import compiled_steps
from liehom.integrators.compiled.traced_step import traced_step
from liehom.integrators.engine import Problem, executed
from liehom.integrators.run.clock import SLACK
from liehom.integrators.run.options import ORDER_NOT_KEPT, Options, Span
from liehom.integrators.run.records import time_of
from liehom.integrators.run.solution import Report, Solution
from liehom.series.arrays import is_jax, is_traced
from liehom.tracing import StepGraph
from liehom.tracing.jax_code import JaxArray, evaluate_with_jax
from liehom.typing import Array

STEPS_PER_NOMINAL_STEP = 1.5
"""Largest number of steps of a step with a τ of its own, in units of the nominal number; beyond it points are NaN."""
NEWTON_ITERATIONS = 6
LOSSES = ("unkept", "failed", "near")
"""Numbers of a corrected step on its order: the largest of the first one is stored, the others are summed up."""


@final
class JaxEngine:
    """The engine "jax", which makes ordinary steps of numpy arrays, and all steps of JAX arrays, by code of JAX.

    Examples
    --------
    >>> JaxEngine().name
    'jax'
    """

    name = "jax"

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem, with JAX arrays if the start is one."""
        if is_jax(problem.start):
            return integrate_on_jax(problem)
        return executed(problem, lambda run: compiled_steps(run, self.name))


def integrate_on_jax(problem: Problem) -> Solution:
    """The solution at the times `t_eval`, or at the initial and the final time, with JAX arrays for t and y.

    Parameters
    ----------
    problem : Problem
        Whose start is a JAX array of float64. If JAX traces it, its points are assumed to be on orbits of the largest
        dimension.

    Raises
    ------
    InputError
        If the problem has no fixed step size, or has events, dense output or a checkpoint.
    TraceError
        If the step cannot be compiled.

    Notes
    -----
    The number of steps between two times is at most 1.5 times the nominal number, and at most the nominal number for a
    step without a time reparametrization. `report` repeats what was asked for, because the order that is reached is
    not known while JAX traces.
    """
    from jax import numpy as jnp

    action, step, span, nominal = problem.action, problem.step, problem.span, problem.options.nominal
    dt, times = _fixed_size(problem.options), _output_times(problem)
    start: Any = problem.start
    n = start.shape[-1]
    known = None if is_traced(start) else np.asarray(start).reshape(-1, n)
    points = np.random.default_rng(0).normal(size=(16, n)) if known is None else known
    dimensions = np.unique(problem.orbit_dimension)
    if len(dimensions) > 1:
        raise InputError(
            "trajectories on orbits of several dimensions: integrate them one by one, or from numpy arrays"
        )
    dimension = int(dimensions.max())
    ends = float(span[0]), float(span[1])
    graph = traced_step(action, problem.field, step, points, dimension, ends=ends, nominal=nominal)
    found, taken, seen = _through(graph, jnp.moveaxis(start, -1, 0), span, dt, times)
    y: Any = jnp.moveaxis(jnp.moveaxis(found, 0, -1), 0, -2)
    t: Any = jnp.asarray(times)
    lost: Any = seen[0] > 0
    statuses: Any = jnp.where(lost, ORDER_NOT_KEPT, 0)
    report = _report(action, step, dimension, nominal=nominal)
    status, message = 0, "Integrated by JAX; where a time was not reached, y is nan."
    if known is not None and not is_traced(statuses) and bool(lost.any()):
        report = _with_loss(report, np.asarray(seen), ends)
        status, message = ORDER_NOT_KEPT, f"{message} The order {step.order} was not kept: {report.loss}."
    return Solution(
        t=t,
        y=y,
        sol=None,
        t_events=None,
        y_events=None,
        nfev=0,
        status=status,
        message=message,
        n_steps=taken,
        report=report,
        statuses=statuses if start.ndim > 1 or is_traced(statuses) else status,
    )


def _fixed_size(options: Options) -> float:
    """The step size of all trajectories."""
    possible = options.events is None and not options.dense_output and options.checkpoint is None
    if options.dt is None or not possible:
        raise InputError(
            "integrate on JAX arrays takes fixed steps (give dt), and no events, dense output or checkpoints: from "
            "numpy arrays engine='jax' adapts steps too"
        )
    sizes = np.unique(options.dt)
    if len(sizes) != 1:
        raise InputError("integrate on JAX arrays takes one step size dt for all trajectories: take jax.vmap, or numpy")
    return float(sizes[0])


def _output_times(problem: Problem) -> Array:
    """Times of `t_eval`, by default the initial and the final time."""
    span, times = problem.span, problem.options.t_eval
    if times is not None:
        return times
    ends: Array = np.unique(np.array(span, dtype=np.float64))
    return ends[:: 1 if span[1] >= span[0] else -1]


def _report(action: Action, step: Step, dimension: int, *, nominal: bool) -> Report:
    return Report(
        step=repr(step),
        exponential=action.exponential.name,
        clock="nominal" if nominal else "corrected",
        base_order=step.step.order if isinstance(step, Corrected) else step.order,
        order=step.order,
        wanted_order=step.order,
        worst_residual=float("nan"),
        singular_value=float("nan"),
        singular_at=None,
        rank=dimension,
        orbit_dimension=dimension,
        failed_steps=0,
        equilibria=0,
        inner_product=action.inner_product.name,
    )


def _with_loss(report: Report, seen: Array, ends: tuple[float, float]) -> Report:
    """The report with the totals of `LOSSES` of all trajectories, shape (3, ...)."""
    return replace(
        report,
        order=report.base_order,
        failed_steps=int(seen[1].sum()),
        near_steps=int(seen[2].sum()),
        unkept_from=float(time_of(np.max(seen[0]), ends)),
    )


def _through(graph: StepGraph, m: Any, span: Span, dt: float, times: Array) -> tuple[Any, Any, Any]:
    """Points (k, N, ...) at the times, the numbers of steps, and the totals (3, ...) of `LOSSES`."""
    from jax import lax
    from jax import numpy as jnp

    direction = 1.0 if span[1] >= span[0] else -1.0
    h, n = direction * dt, graph.size
    constants = {-1 - i: c for i, c in enumerate(_constants(graph, m))}
    gaps = np.abs(np.diff(np.concatenate([[span[0]], np.asarray(times)])))
    most = ceil(float(gaps.max(initial=0.0)) / dt * (1.0 if graph.elapsed is None else STEPS_PER_NOMINAL_STEP)) + 1

    numbers = {**graph.largest, **graph.summed}
    losses = [numbers[name] for name in LOSSES] if LOSSES[0] in numbers else []

    def step(m: Any, t: Any, size: Any) -> tuple[Any, Any, Any]:
        outputs = [*graph.point, *losses, *[x for x in (graph.elapsed, graph.solved) if x is not None]]
        made = evaluate_with_jax(outputs, {**dict(enumerate(m)), n: t, n + 1: size, **constants}, differentiable=True)
        made = [jnp.broadcast_to(x, t.shape) for x in made]
        point = jnp.stack(made[:n])
        if graph.solved is not None:
            point = jnp.where(made[-1], point, jnp.nan)
        new = jnp.stack(made[n : n + len(LOSSES)]) if losses else jnp.zeros((len(LOSSES), *t.shape))
        return point, made[n + len(losses)] if graph.elapsed is not None else jnp.broadcast_to(size, t.shape), new

    def added(seen: JaxArray, new: JaxArray) -> JaxArray:
        return jnp.concatenate([jnp.maximum(seen[:1], new[:1]), seen[1:] + new[1:]])

    def size_for(m: Any, t: Any, left: Any) -> Any:
        coefficients = [c for _, c in graph.clock]
        made = evaluate_with_jax(coefficients, {**dict(enumerate(m)), n: t, **constants}, differentiable=True)
        found = dict(zip([k for k, _ in graph.clock], made, strict=True))
        s = left
        for _ in range(NEWTON_ITERATIONS if found else 0):
            tau = s + sum(c * s**k for k, c in found.items())
            s = s + (left - tau) / (1 + sum(k * c * s ** (k - 1) for k, c in found.items()))
        return s

    def towards(state: Any, time: Any) -> Any:
        def plain(state: Any, _: Any) -> Any:
            m, t, count, seen = state
            new, passed, loss = step(m, t, h)
            after = span[0] + (count + 1) * h if graph.elapsed is None else t + passed
            go = direction * (time - after) > SLACK * dt
            seen = jnp.where(go, added(seen, loss), seen)
            return (jnp.where(go, new, m), jnp.where(go, after, t), count + go, seen), None

        state, _ = lax.scan(plain, state, None, length=most)
        m, t, count, seen = state
        left = time - t
        reached = direction * left <= STEPS_PER_NOMINAL_STEP * 2 * dt
        new, _, loss = step(m, t, size_for(m, t, left))
        return (m, t, count, jnp.where(left == 0, seen, added(seen, loss))), jnp.where(reached, new, jnp.nan)

    t = jnp.full(m.shape[1:], span[0], dtype=m.dtype)
    state, found = lax.scan(
        towards, (m, t, jnp.zeros_like(t), jnp.zeros((3, *t.shape))), jnp.asarray(np.asarray(times, dtype=np.float64))
    )
    return found, state[2].astype(int) + 1, state[3]


def _constants(graph: StepGraph, m: Any) -> list[Any]:
    """Constants of the trajectories, computed from their initial points m (N, ...)."""
    from jax import numpy as jnp

    return [number(jnp.moveaxis(m, 0, -1)) for number in graph.constant_functions]
