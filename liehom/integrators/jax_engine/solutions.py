"""The `Solution` of a call on JAX arrays, with a status for each trajectory as from numpy arrays."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple, final

import numpy as np

from liehom.integrators.engine import Problem
from liehom.integrators.run.options import END, ORDER_NOT_KEPT, outcome
from liehom.integrators.run.solution import Report, Solution, loss_of_order
from liehom.series.arrays import is_traced
from liehom.tracing.jax_code import JaxArray


@final
class Found(NamedTuple):
    """Results of a loop over steps: points (k, ..., N), and arrays (...) as in `State`."""

    points: JaxArray
    code: JaxArray
    count: JaxArray
    t: JaxArray
    failed: JaxArray
    near: JaxArray
    lost: JaxArray


def solution_of(problem: Problem, dimension: int, times: JaxArray, found: Found) -> Solution:
    """The solution, with JAX arrays for t, y and, for an ensemble or if JAX traces the call, `statuses`.

    Parameters
    ----------
    problem : Problem
    dimension : int
        Of the orbits.
    times : array of shape (k,)
    found : Found
    """
    import jax
    from jax import numpy as jnp

    y: Any = jnp.moveaxis(found.points, 0, -1)
    report = _report(problem, dimension)
    code, lost, count, t = (jax.lax.stop_gradient(x) for x in (found.code, found.lost, found.count, found.t))
    statuses: Any = jnp.where(code < 0, -1, jnp.where(jnp.isfinite(lost), ORDER_NOT_KEPT, 0))
    status, message = 0, "Traced by JAX: `statuses` is -1 for trajectories that failed; there y is nan."
    if not is_traced(code) and not is_traced(problem.span[0]):
        start, end = (np.asarray(jax.lax.stop_gradient(x)) for x in problem.span)
        direction = 1.0 if end >= start else -1.0
        first: Any = np.where(np.isfinite(lost), lost, np.nan)
        failed, near = (int(np.sum(np.asarray(jax.lax.stop_gradient(x)))) for x in (found.failed, found.near))
        reason = loss_of_order(failed, near, report.base_order)
        ended = outcome(np.asarray(code), np.asarray(t), first, direction, problem.step.order, reason)
        status, message = ended.status, ended.message
        if not np.all(np.isnan(first)):
            unkept = direction * float(np.nanmin(direction * first))
            order = report.base_order
            report = replace(report, order=order, failed_steps=failed, near_steps=near, unkept_from=unkept)
        report = replace(report, stopped_at=ended.stopped_at)
    alone = found.code.ndim == 0 and not is_traced(code)
    return Solution(
        t=times,
        y=y,
        sol=None,
        t_events=None,
        y_events=None,
        nfev=0,
        status=status,
        message=message,
        n_steps=count + (code == END),
        report=report,
        statuses=status if alone else statuses,
    )


def _report(problem: Problem, dimension: int) -> Report:
    """The report that repeats the options; the order that is reached is not known while JAX traces."""
    step = problem.step
    return Report(
        step=repr(step),
        exponential=problem.action.exponential.name,
        clock=problem.options.clock,
        base_order=step.base_order,
        order=step.order,
        wanted_order=step.order,
        worst_residual=float("nan"),
        singular_value=float("nan"),
        singular_at=None,
        rank=dimension,
        orbit_dimension=dimension,
        failed_steps=0,
        equilibria=0,
        inner_product=problem.action.inner_product.name,
    )
