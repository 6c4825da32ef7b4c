"""How many operations a step has, and how many lanes a block of its code should have."""

from __future__ import annotations

from liehom.tracing import StepGraph, lanes_per_register, needed

SHORT_OPERATIONS, LONG_OPERATIONS = 200, 1000
"""Operations between two loops up to which code is short, and from which on it is long."""
ASSUMED_ITERATIONS = 5
"""Iterations that a loop in a step is assumed to make, for the number of its operations."""


def operations(graph: StepGraph) -> int:
    """Approximate number of scalar operations of a step.

    Examples
    --------
    >>> from liehom.tracing import Tape
    >>> x = Tape().input(0)
    >>> operations(StepGraph([x * x + 1.0], None, None, {}, {}))
    4
    """
    rows = needed(graph.outputs)
    return len(rows) + ASSUMED_ITERATIONS * sum(
        len(x.value.inside) for x in rows if x.op == "loop" and not x.value.guarded
    )


def block_width(graph: StepGraph, lanes: int) -> int:
    """Number of lanes in a block: as many registers for a number as hide latencies and do not run out in long code."""
    one = lanes_per_register()
    if lanes <= one:
        return 1 if lanes == 1 else one
    ops = needed(graph.outputs)
    breaks = sum(x.op == "expv" or (x.op == "loop" and not x.value.guarded) for x in ops)
    registers = 4 if len(ops) < SHORT_OPERATIONS and not breaks else 2
    widest = one if len(ops) >= LONG_OPERATIONS * (1 + breaks) else registers * one
    return min(widest, 1 << (lanes - 1).bit_length())
