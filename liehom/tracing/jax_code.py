"""A graph as a function on JAX arrays, to be compiled by jax.jit; it can be differentiated and vmapped."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import ModuleType
from typing import Any, TypeAlias

from liehom.errors import TraceError
from liehom.tracing.expr import Expr
from liehom.tracing.graph import needed
from liehom.tracing.machine_code.rotation import SHORT_SERIES_REACH, rotation_series

JaxArray: TypeAlias = Any
"""A JAX array or tracer, a numpy array or a number."""

EXP_SUBSTEPS, EXP_TERMS = 4, 18
"""Numbers of substeps and of terms in which exp(A) m is summed; enough for |A| <= 4, beyond that the result is NaN."""


def evaluate_with_jax(
    outputs: Sequence[Expr], inputs: Mapping[int, JaxArray], *, differentiable: bool = False
) -> list[JaxArray]:
    """List of the outputs of a graph, computed by jax.numpy.

    Parameters
    ----------
    outputs : sequence of Expr
    inputs : dict
        Arrays, of shapes that broadcast, by the index of the input.
    differentiable : bool
        Whether loops must be differentiable backwards. They then run for their largest number of iterations.

    Raises
    ------
    TraceError
        If JAX is not installed, or an operation is not known.

    Examples
    --------
    >>> from liehom.tracing import Tape
    >>> tape = Tape()
    >>> float(evaluate_with_jax([tape.input(0) * 2.0 + 1.0], {0: 3.0})[0])
    7.0
    """
    try:
        import jax.numpy as jnp
    except ImportError:
        raise TraceError('engine="jax" needs the extra: pip install "liehom[jax]"') from None
    values: dict[int, Any] = {}
    for x in needed(outputs):
        values[x.index] = _value(jnp, x, values, inputs, differentiable)
    return [values[x.index] for x in outputs]


def _known(x: Expr, values: Mapping[int, JaxArray]) -> Any:
    return x.value if x.constant else values[x.index]


def _value(
    jnp: ModuleType, x: Expr, values: Mapping[int, JaxArray], inputs: Mapping[int, JaxArray], whole: bool
) -> Any:
    if x.constant:
        return x.value
    if x.op == "input":
        return inputs[x.value]
    args = [_known(a, values) for a in x.args]
    if x.op == "get":
        return args[0][x.value]
    if x.op == "loop":
        return _iterated(jnp, x, values, whole)
    if x.op == "expv":
        return _exponential(jnp, x.value, args)
    if x.op in _OPERATIONS:
        return _OPERATIONS[x.op](jnp, *args)
    function = getattr(jnp, x.op, None)
    if function is None:
        raise TraceError(f"the operation {x.op} is not known to JAX")
    return function(*args)


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda jnp, a, b: a + b,
    "sub": lambda jnp, a, b: a - b,
    "mul": lambda jnp, a, b: a * b,
    "div": lambda jnp, a, b: a / b,
    "neg": lambda jnp, a: -a,
    "lt": lambda jnp, a, b: a < b,
    "le": lambda jnp, a, b: a <= b,
    "eq": lambda jnp, a, b: a == b,
    "ne": lambda jnp, a, b: a != b,
    "and": lambda jnp, a, b: jnp.logical_and(a, b),
    "not": lambda jnp, a: jnp.logical_not(a),
    "select": lambda jnp, where, a, b: jnp.where(where, a, b),
    "pow": lambda jnp, a, b: a**b,
    "sinq": lambda jnp, q: _rotation(jnp, q, 1),
    "cosq": lambda jnp, q: _rotation(jnp, q, 0),
}


def _rotation(jnp: ModuleType, q: JaxArray, first: int) -> JaxArray:
    """sin(r)/r (first = 1) or cos(r) (first = 0) with r^2 = q; neither value nor derivative of any branch overflows."""
    near = jnp.abs(q) < SHORT_SERIES_REACH
    total: Any = 0.0
    for c in reversed(rotation_series(SHORT_SERIES_REACH, first)):
        total = total * q + c
    safe = jnp.where(near, 1.0, q)
    r = jnp.sqrt(jnp.abs(safe))
    grown = jnp.where(safe > 0, 0.0, r)
    if first:
        far = jnp.where(safe > 0, jnp.sin(r), jnp.sinh(grown)) / r
    else:
        far = jnp.where(safe > 0, jnp.cos(r), jnp.cosh(grown))
    return jnp.where(near, total, far)


def _iterated(jnp: ModuleType, x: Expr, values: Mapping[int, JaxArray], whole: bool) -> list[JaxArray]:
    """The values of the variables after a loop."""
    from jax import lax

    loop = x.value
    before = [jnp.asarray(_known(a, values)) for a in x.args]
    shape = jnp.broadcast_shapes(*[a.shape for a in before])
    start = [
        jnp.broadcast_to(jnp.asarray(a, dtype=bool if v.boolean else float), shape)
        for a, v in zip(before, loop.variables, strict=False)
    ]

    def body(state: list[JaxArray]) -> tuple[list[JaxArray], JaxArray]:
        known = dict(values) | {v.index: s for v, s in zip(loop.variables, state, strict=True)}
        for y in loop.inside:
            known[y.index] = _value(jnp, y, known, {}, whole)
        new = [jnp.broadcast_to(_known(y, known), shape) for y in loop.new]
        return new, jnp.any(_known(loop.again, known))

    more = (start, jnp.any(start[0]) if loop.guarded else jnp.asarray(True))
    if whole:  # loops of a fixed length are differentiated
        return list(
            lax.fori_loop(
                0, loop.limit, lambda _, state: lax.cond(state[1], lambda s: body(s[0]), lambda s: s, state), more
            )[0]
        )
    found = lax.while_loop(
        lambda state: (state[0] < loop.limit) & state[1][1],
        lambda state: (state[0] + 1, body(state[1][0])),
        (0, more),
    )
    return list(found[1][0])


def _exponential(jnp: ModuleType, places: tuple[tuple[int, int], ...], args: list[JaxArray]) -> list[JaxArray]:
    from jax import lax

    shape = jnp.broadcast_shapes(*[jnp.shape(a) for a in args])
    args = [jnp.broadcast_to(jnp.asarray(a, dtype=float), shape) for a in args]
    entries, m = args[: len(places)], jnp.stack(args[len(places) :])
    n = len(m)
    rows = [[jnp.zeros(shape) for _ in range(n)] for _ in range(n)]
    for (i, j), a in zip(places, entries, strict=True):
        rows[i][j] = a
    matrix = jnp.stack([jnp.stack(row) for row in rows])
    size = sum(a * a for a in entries)

    def term(j: JaxArray, state: JaxArray) -> JaxArray:
        last, total = state
        last = jnp.einsum("ij...,j...->i...", matrix, last) / (EXP_SUBSTEPS * (j + 1.0))
        return last, total + last

    def substep(_: JaxArray, v: JaxArray) -> JaxArray:
        return v + lax.fori_loop(0, EXP_TERMS, term, (v, jnp.zeros_like(v)))[1]

    moved = lax.fori_loop(0, EXP_SUBSTEPS, substep, m)
    return list(jnp.where(size <= EXP_SUBSTEPS**2, moved, jnp.nan))
