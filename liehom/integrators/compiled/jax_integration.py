"""integrate on JAX arrays, in a form that works under jax.jit, jax.grad and jax.vmap.

Between two requested times, steps are made in a loop of fixed length. The point at a requested time is computed by the
step that contains it, at the parameter s with τ(s) = time - t, by Newton's method.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.correctors.isotropy.corrected import Corrected
from liehom.correctors.step import Step
from liehom.errors import InputError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.integrators.compiled.traced_step import traced_step
from liehom.integrators.run.clock import SLACK
from liehom.integrators.run.options import Span
from liehom.integrators.run.solution import Report, Solution
from liehom.series.arrays import is_traced
from liehom.tracing import StepGraph
from liehom.tracing.jax_code import evaluate_with_jax
from liehom.typing import Array

STEPS_PER_NOMINAL_STEP = 1.5
"""Largest number of steps of a step with a τ of its own, in units of the nominal number; beyond it points are NaN."""
NEWTON_ITERATIONS = 6


def integrate_on_jax(
    action: Action, field: GeneratorField, step: Step, span: Span, y0: npt.ArrayLike, dt: float, times: Array,
    *, nominal: bool,
) -> Solution:  # fmt: skip
    """The solution at given times, with JAX arrays for t and y.

    Parameters
    ----------
    action : Action
    field : GeneratorField
    step : Step
    span : (float, float)
    y0 : JAX array of shape (..., N)
        If JAX traces it, its points are assumed to be on orbits of the largest dimension.
    dt : float
    times : array of shape (k,)
        In the direction of integration.
    nominal : bool

    Raises
    ------
    InputError
        If y0 is not of type float64 (see ``jax.config.update("jax_enable_x64", True)``).
    TraceError
        If the step cannot be compiled.

    Notes
    -----
    The number of steps between two times is at most 1.5 times the nominal number, and at most the nominal number for a
    step without a time reparametrization. `report` repeats what was asked for, because the order that is reached is
    not known while JAX traces.
    """
    from jax import numpy as jnp

    start: Any = y0
    if start.dtype != np.float64:
        raise InputError(
            f"compile='jax' computes in float64, the start is of type {start.dtype}: "
            'jax.config.update("jax_enable_x64", True)'
        )
    n = field.representation.size
    if start.ndim == 0 or start.shape[-1] != n:
        raise InputError(f"a point has {n} coordinates (on its last axis), got shape {start.shape}")
    known = None if is_traced(start) else np.asarray(start).reshape(-1, n)
    points = np.random.default_rng(0).normal(size=(16, n)) if known is None else known
    dimensions = np.unique(check_point(field.representation, points))
    if known is not None and len(dimensions) > 1:
        raise InputError(
            "trajectories on orbits of several dimensions: integrate them one by one, or from numpy arrays"
        )
    dimension = int(dimensions.max())
    graph = traced_step(action, field, step, points, dimension, nominal=nominal)
    found, taken = _through(graph, jnp.moveaxis(start, -1, 0), span, dt, times)
    y: Any = jnp.moveaxis(jnp.moveaxis(found, 0, -1), 0, -2)
    t: Any = jnp.asarray(times)
    statuses: Any = jnp.zeros(start.shape[:-1], dtype=int) if start.ndim > 1 else 0
    return Solution(
        t=t,
        y=y,
        sol=None,
        t_events=None,
        y_events=None,
        nfev=0,
        status=0,
        message="Integrated by JAX; where a time was not reached, y is nan.",
        n_steps=taken,
        report=_report(action, step, dimension, nominal=nominal),
        statuses=statuses,
    )


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


def _through(graph: StepGraph, m: Any, span: Span, dt: float, times: Array) -> tuple[Any, Any]:
    """Points (k, N, ...) at the times, and the numbers of steps."""
    from jax import lax
    from jax import numpy as jnp

    direction = 1.0 if span[1] >= span[0] else -1.0
    h, n = direction * dt, graph.size
    constants = {-1 - i: c for i, c in enumerate(_constants(graph, m))}
    gaps = np.abs(np.diff(np.concatenate([[span[0]], np.asarray(times)])))
    most = ceil(float(gaps.max(initial=0.0)) / dt * (1.0 if graph.elapsed is None else STEPS_PER_NOMINAL_STEP)) + 1

    def step(m: Any, t: Any, size: Any) -> tuple[Any, Any]:
        outputs = [*graph.point, *[x for x in (graph.elapsed, graph.solved) if x is not None]]
        made = evaluate_with_jax(outputs, {**dict(enumerate(m)), n: t, n + 1: size, **constants}, differentiable=True)
        made = [jnp.broadcast_to(x, t.shape) for x in made]
        point = jnp.stack(made[:n])
        if graph.solved is not None:
            point = jnp.where(made[-1], point, jnp.nan)
        return point, made[n] if graph.elapsed is not None else jnp.broadcast_to(size, t.shape)

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
            m, t, count = state
            new, passed = step(m, t, h)
            after = span[0] + (count + 1) * h if graph.elapsed is None else t + passed
            go = direction * (time - after) > SLACK * dt
            return (jnp.where(go, new, m), jnp.where(go, after, t), count + go), None

        state, _ = lax.scan(plain, state, None, length=most)
        m, t, _ = state
        left = time - t
        reached = direction * left <= STEPS_PER_NOMINAL_STEP * 2 * dt
        return state, jnp.where(reached, step(m, t, size_for(m, t, left))[0], jnp.nan)

    t = jnp.full(m.shape[1:], span[0], dtype=m.dtype)
    state, found = lax.scan(towards, (m, t, jnp.zeros_like(t)), jnp.asarray(np.asarray(times, dtype=np.float64)))
    return found, state[2].astype(int) + 1


def _constants(graph: StepGraph, m: Any) -> list[Any]:
    """Constants of the trajectories, computed from their initial points m (N, ...)."""
    from jax import numpy as jnp

    return [number(jnp.moveaxis(m, 0, -1)) for number in graph.constant_functions]
