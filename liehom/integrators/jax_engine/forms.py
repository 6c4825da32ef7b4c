"""The choice between the two forms of a step on JAX arrays, a scalar graph or array code.

XLA compiles a graph of n operations in a time that grows like n^2, on one core about 0.2 s for 600, 2 s for 1600 and
20 s for 6000.  Array code of the same steps takes 0.4 s to 1 s.  Once compiled, short graphs are 3 to 10 times faster.
"""

from __future__ import annotations

import inspect
from collections.abc import Hashable
from functools import partial
from typing import Any

import numpy as np

from liehom.correctors.conserving import Conserving
from liehom.errors import TraceError
from liehom.homogeneous.frames.branch_free_frames import tight_frame
from liehom.integrators.compiled.parameters import args_form
from liehom.integrators.compiled.traced_step import traced_step
from liehom.integrators.engine import Problem
from liehom.integrators.jax_engine.local_steps import ArrayStep, GraphStep, StepOnJax
from liehom.integrators.run.control import ERROR_TERMS
from liehom.pytrees import Leaf, PerTrajectory, leaves, mapped, unwrapped
from liehom.series.arrays import is_jax, is_traced
from liehom.tracing import StepGraph, needed
from liehom.tracing.jax_code import JaxArray
from liehom.typing import Pytree

MAX_GRAPH_OPERATIONS = 700
"""Scalar graphs of at most so many operations are compiled as graphs, longer ones as array code."""
MAX_GRAPH_ARGS = 100
"""Steps with more numbers in args are compiled as array code: a graph has an operation for each of them."""


def step_for(problem: Problem, dimension: int, known: dict[Hashable, StepOnJax]) -> StepOnJax:
    """The step in the form that is compiled: as a graph if it is short, else as array code.

    Parameters
    ----------
    problem : Problem
    dimension : int
        Of the orbits.
    known : dict
        The forms that an engine has made before, to which new ones are added.
    """
    o, action, step = problem.options, problem.action, problem.step
    array = ArrayStep(action, step, dimension, o.nominal, ERROR_TERMS if o.dt is None else 0)
    args, lead = problem.args, problem.start.ndim - 1
    numbers = sum(int(np.size(leaf.value)) for leaf in leaves(unwrapped(args)))
    if o.dt is None or numbers > MAX_GRAPH_ARGS or _closes_over_jax(problem.field.source):
        return array
    points: Any = representative_points(problem.start, problem.field.representation.size)
    tight = tight_frame(action, points, dimension) if step.uses_isotropy else None
    form = None if args is None else (lead, args_form(args, lead))
    key = dimension, form, None if tight is None else repr([np.asarray(x).tolist() for x in tight[:4]])
    if key not in known:
        try:
            graph = traced_step(
                action, problem.field, step, points, dimension, nominal=o.nominal, args=_blank(args), lead=lead
            )
            made: StepOnJax = GraphStep(graph) if _is_short(graph) or isinstance(step, Conserving) else array
        except TraceError:
            made = array
        known[key] = made
    return known[key]


def representative_points(start: JaxArray, size: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Points (L, N) on which special properties of orbits are looked for: the initial ones, or random ones if traced.

    Examples
    --------
    >>> representative_points(np.ones((2, 2, 3)), 3).shape
    (4, 3)
    """
    if is_traced(start):
        return np.random.default_rng(0).normal(size=(16, size))
    found: np.ndarray[Any, np.dtype[np.float64]] = np.asarray(start, dtype=np.float64).reshape(-1, size)
    return found


def _closes_over_jax(source: object) -> bool:
    """Whether a function uses JAX arrays of its surroundings; a graph would have their numbers in its operations."""
    while isinstance(source, partial):
        if any(is_jax(x) for x in (*source.args, *source.keywords.values())):
            return True
        source = source.func
    if not inspect.isfunction(source):
        return False
    found = inspect.getclosurevars(source)
    return any(is_jax(x) for x in (*found.nonlocals.values(), *found.globals.values()))


def _blank(args: Pytree) -> Pytree:
    """args with numpy zeros in place of numbers, which JAX may trace."""

    def zeros(leaf: Leaf) -> object:
        inner: Any = leaf.value.value if isinstance(leaf.value, PerTrajectory) else leaf.value
        made = np.zeros(np.shape(inner), getattr(inner, "dtype", np.dtype(type(inner))))
        return PerTrajectory(made) if isinstance(leaf.value, PerTrajectory) else made

    return mapped(args, zeros)


def _is_short(graph: StepGraph) -> bool:
    """Whether a graph is compiled as such: array code differentiates loops by the implicit function theorem."""
    operations = needed([*graph.point, *graph.summed.values()])
    return len(operations) <= MAX_GRAPH_OPERATIONS and not any(x.op == "loop" for x in operations)
