"""A check of initial points in machine code: finite, and on an orbit of the largest dimension."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from liehom.homogeneous import Action
from liehom.homogeneous.fields.field import check_point
from liehom.tracing import StepGraph, Traced
from liehom.typing import Values

GUARD_RTOL = 1e-10
"""A pivot above this fraction of the trace is certainly not 0."""
GUARD_PROJECTIONS = 2
"""Number of random projections, one of which shows the rank."""


def with_guard(graph: StepGraph, action: Action, dimension: int) -> StepGraph:
    """The graph with a `guard`: whether a point is finite and its orbit is certainly of a dimension, the largest.

    It is in force where the number "checks" of the run is 1. Orbits are of dimension d if a random projection of
    g onto d coordinates, followed by the action on the point, is injective. Graphs
    whose steps record numbers, and orbits that are not of the largest dimension, have no guard.
    """
    rng = np.random.default_rng((0, dimension))
    generic = check_point(action.representation, rng.normal(size=(4, graph.size)))
    if graph.largest or graph.summed or graph.calls is None or dimension != int(generic.max()):
        return graph
    tape: Any = graph.point[0].tape
    m: Any = Traced.inputs(tape, 0, graph.size)
    frame: Any = action.infinitesimal.right(m)
    certain: Any = False
    for _ in range(GUARD_PROJECTIONS):
        certain = certain | _is_injective(frame @ rng.normal(size=(action.dimension, dimension)), (m * m).sum())
    unchecked = Traced(tape, tape.run_constant("checks", 0.0)) == 0
    guard = Traced(tape, unchecked | certain).entry
    return replace(graph, guard=guard, constant_functions=tuple(tape.constant_functions))


def _is_injective(matrix: Values, scale: Values) -> Values:
    """Whether a traced matrix (N, d) is certainly of rank d, by elimination in its Gram matrix; of entries ~ scale."""
    gram: Any = np.swapaxes(matrix, -1, -2) @ matrix
    total = np.trace(gram)
    certain: Any = total > GUARD_RTOL * scale
    for i in range(len(gram)):
        certain = certain & (gram[i, i] > GUARD_RTOL * total)
        gram = gram - gram[i][:, None] * gram[i][None] / gram[i, i]
    found: Values = certain
    return found
