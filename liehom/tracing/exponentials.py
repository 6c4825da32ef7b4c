"""Functions of the exponential that are one operation of the graph: sin(r)/r and cos(r) of r^2, and exp(A) m.

They branch on the size of their arguments, which a graph cannot; the emitters (`machine_code`, `jax_code`) write the
branches and loops.
"""

from __future__ import annotations

from liehom.errors import TraceError
from liehom.tracing.array import Operand, Traced, elementwise, expr_array


def entire_function(name: str, x: Traced) -> Traced:
    """Traced array of sin(r)/r ("sinq") or cos(r) ("cosq") of the entries x = r^2.

    Examples
    --------
    >>> from liehom.tracing import Tape
    >>> entire_function("cosq", Traced(Tape(), [0.0])).entries
    array([1.0], dtype=object)
    """
    return elementwise(x.tape, lambda q: x.tape.call(name, q), x)


def exponential_action(matrix: Operand, m: Operand) -> Traced:
    """exp(A) m for a matrix A (n, n) and a vector m (n,), by a series; the compiled code decides its length.

    Examples
    --------
    >>> import numpy as np
    >>> from liehom.tracing import Tape
    >>> tape = Tape()
    >>> exponential_action(Traced(tape, np.zeros((2, 2))), Traced.inputs(tape, 0, 2)).entries
    array([<input 4>, <input 5>], dtype=object)
    """
    tape = (matrix if isinstance(matrix, Traced) else m).tape
    a, v = expr_array(tape, matrix), expr_array(tape, m)
    if a.ndim != 2 or v.ndim != 1:
        raise TraceError(f"exp(A) m is compiled for one A and one m, got shapes {a.shape} and {v.shape}")
    places = tuple(
        (i, j) for i in range(len(v)) for j in range(len(v)) if not (a[i, j].constant and a[i, j].value == 0)
    )
    if not places:
        return Traced(tape, v)
    return Traced(tape, tape.block("expv", [*[a[p] for p in places], *v], len(v), places))
