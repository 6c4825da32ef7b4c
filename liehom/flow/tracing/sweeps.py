"""A recorded graph as a function: on arrays, with derivatives, on JAX arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from math import ceil, log2
from types import ModuleType
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import TraceError
from liehom.base.lazy import Module
from liehom.base.typing import Array, Lanes
from liehom.flow.tracing.array import Traced, entire_function
from liehom.flow.tracing.graph import COARSE, OPERATORS, Expr, needed
from liehom.flow.tracing.llvm_text import SHORT_SERIES_REACH, rotation_series

# Derivatives of a recorded graph in reverse mode: one pass backwards gives all partial derivatives as graphs, at a
# few times the cost of the function; and the value of a graph by numpy's functions, on arrays, Jets and tracers.

SINQ_TERMS = 10  # of the derivative of sin(r)/r by r^2, for |r| <= 1


def gradient(output: Expr, inputs: Sequence[Expr]) -> list[Expr]:
    """List of the partial derivatives of a number of a graph by its inputs, as numbers of the same graph."""
    tape: Any = output.tape
    wanted = {x.index for x in inputs}
    order = needed([output])
    moving = set(wanted)  # operations that depend on an input
    for x in order:
        if x.index not in moving and any(a.index in moving for a in x.args):
            moving.add(x.index)
    seeds: dict[int, Any] = {output.index: Traced(tape, tape.one)}
    for x in reversed(order):
        seed = seeds.get(x.index)
        if seed is None or x.index in wanted or x.index not in moving:
            continue
        args = [Traced(tape, a) for a in x.args]
        slopes = partials(x.op, args, Traced(tape, x), fixed_exponent=x.op == "pow" and x.args[1].constant)
        for argument, slope in zip(x.args, slopes, strict=True):
            if argument.index in moving and not argument.boolean:
                part = seed * slope
                seeds[argument.index] = seeds[argument.index] + part if argument.index in seeds else part
    return [seeds[x.index].entry if x.index in seeds else tape.zero for x in inputs]


def evaluated(outputs: Sequence[Expr], inputs: Mapping[int, Any]) -> list[Any]:
    """List of the outputs of a graph, computed by numpy on arrays of any precision, Jets or tracers."""
    values: dict[int, Any] = {}
    for x in needed(outputs):
        values[x.index] = _value_of(x, values, inputs)
    return [values[x.index] for x in outputs]


def _value_of(x: Expr, values: Mapping[int, Any], inputs: Mapping[int, Any]) -> Lanes:
    """The value of an elementary operation, an input or a constant, from those before."""
    if x.constant:
        return x.value
    return inputs[x.value] if x.op == "input" else applied(np, x.op, [values[a.index] for a in x.args])


# names in numpy of operations that have another one
NAMES = {"and": "logical_and", "not": "logical_not", "select": "where"}


def applied(xp: ModuleType, op: str, args: Sequence[Lanes]) -> Any:
    """The value of an elementary operation, by numpy or by JAX."""
    if op in ("sinq", "cosq"):
        return rotation(xp, args[0], int(op == "sinq"))
    if op in COARSE:
        return COARSE[op](args[0], xp)
    function = OPERATORS.get(op) or getattr(xp, NAMES.get(op, op), None)
    if function is None:
        raise TraceError(f"the operation {op} of a recorded function is not known to {xp.__name__}")
    return function(*args)


def rotation(xp: ModuleType, q: Lanes, first: int) -> Any:
    """sin(r)/r (first = 1) or cos(r) (first = 0) with r^2 = q; neither value nor derivative of any branch overflows."""
    near = xp.abs(q) < SHORT_SERIES_REACH
    total: Any = 0.0
    for c in reversed(rotation_series(SHORT_SERIES_REACH, first)):
        total = total * q + c
    safe = xp.where(near, 1.0, q)
    r = xp.sqrt(xp.abs(safe))
    grown = xp.where(safe > 0, 0.0, r)
    round_, straight = (xp.sin(r) / r, xp.sinh(grown) / r) if first else (xp.cos(r), xp.cosh(grown))
    return xp.where(near, total, xp.where(safe > 0, round_, straight))


def partials(op: str, args: Sequence[Lanes], value: Lanes, *, fixed_exponent: bool = False) -> tuple[Lanes, ...]:
    """The partial derivatives of an operation by its arguments, arrays or tracers, one for each."""
    match op:
        case "add":
            return 1.0, 1.0
        case "sub":
            return 1.0, -1.0
        case "neg":
            return (-1.0,)
        case "mul":
            return args[1], args[0]
        case "div":
            return 1.0 / args[1], -(value / args[1])
        case "pow":
            slope = args[1] * np.power(args[0], args[1] - 1.0)
            return slope, 0.0 if fixed_exponent else value * np.log(args[0])
        case "select":
            return 0.0, np.where(args[0], 1.0, 0.0), np.where(args[0], 0.0, 1.0)
        case "arctan2":
            size = args[0] * args[0] + args[1] * args[1]
            return args[1] / size, -(args[0] / size)
    if op not in SLOPES:
        raise TraceError(f"the operation {op} of a recorded function is not differentiated")
    return (SLOPES[op](args[0], value),)


def _sinq_slope(q: Lanes, x: Lanes) -> Lanes:
    """Derivative of sin(r)/r by q = r^2: (cos(r) - sin(r)/r) / 2q, and near q = 0 its series."""
    near = np.abs(q) < 1.0
    total: Any = 0.0
    for k in range(SINQ_TERMS, 0, -1):
        total = total * q + k * (-1) ** k / math.factorial(2 * k + 1)
    return np.where(near, total, 0.5 * (_rotation_of("cosq", q) - x) / np.where(near, 1.0, q))


def _rotation_of(name: str, q: Lanes) -> Lanes:
    """sin(r)/r or cos(r) of r^2, an array or a tracer."""
    return entire_function(name, q) if isinstance(q, Traced) else applied(np, name, [q])


# The slope of a function of one number, from its argument and its value; the first rows are those of series, too.
SLOPES: dict[str, Callable[[Any, Any], Any]] = {
    "exp": lambda x, y: y, "expm1": lambda x, y: y + 1, "log": lambda x, y: 1 / x, "log1p": lambda x, y: 1 / (x + 1),
    "tan": lambda x, y: y * y + 1, "tanh": lambda x, y: 1 - y * y, "arctan": lambda x, y: 1 / (x * x + 1),
    "arcsin": lambda x, y: 1 / np.sqrt(1 - x * x), "arccos": lambda x, y: -1 / np.sqrt(1 - x * x),
    "arcsinh": lambda x, y: 1 / np.sqrt(x * x + 1), "arctanh": lambda x, y: 1 / (1 - x * x),
    "arccosh": lambda x, y: 1 / (np.sqrt(x - 1) * np.sqrt(x + 1)),
}  # fmt: skip
CHAINED = tuple(SLOPES)
SLOPES |= {
    "sqrt": lambda x, y: 0.5 / y, "cbrt": lambda x, y: 1 / (3 * y * y), "sin": lambda x, y: np.cos(x),
    "cos": lambda x, y: -np.sin(x), "sinh": lambda x, y: np.cosh(x), "cosh": lambda x, y: np.sinh(x),
    "exp2": lambda x, y: math.log(2) * y, "log2": lambda x, y: 1 / (math.log(2) * x),
    "log10": lambda x, y: 1 / (math.log(10) * x), "abs": lambda x, y: np.where(x < 0, -1.0, 1.0),
    "sinq": _sinq_slope, "cosq": lambda q, y: -0.5 * _rotation_of("sinq", q),
}  # fmt: skip


# A recorded graph on arrays of one entry per lane: its values in one forward sweep, and weights of the outputs times
# the derivatives of the graph in one backward sweep, at a few times the cost.

EXP_TERMS = 18  # of exp(A) for |A| <= 1, to double precision


@final
class Sweeps:
    """The values of a graph at given inputs, and its derivatives there."""

    def __init__(self, outputs: Sequence[Expr], inputs: Mapping[int, Array | float], lanes: int) -> None:
        self.lanes = lanes
        self._outputs = list(outputs)
        self._order = needed(outputs)
        self._values: dict[int, Any] = {}
        with np.errstate(all="ignore"):
            for x in self._order:
                self._values[x.index] = self._value(x, inputs)
        self.values: list[Array] = [np.broadcast_to(self._values[x.index], (lanes,)) for x in outputs]

    def _value(self, x: Expr, inputs: Mapping[int, Array | float]) -> Lanes:
        if x.op == "get":
            return self._values[x.args[0].index][x.value]
        if x.op == "expv":  # exp(A) v, shape (n, L), of the entries of A and v
            matrix, vector = self._parts(x)
            return np.moveaxis((exponentials(matrix) @ vector[..., None])[..., 0], -1, 0)
        if x.op in ("loop", "map", "table"):
            raise TraceError(
                "the derivative of a step with an iteration is not known: take an explicit method, or differentiate "
                "with JAX (engine='jax')"
            )
        return _value_of(x, self._values, inputs)

    def _parts(self, x: Expr) -> tuple[Array, Array]:
        """The matrices and the vectors of an exponential."""
        args, places = [self._values[a.index] for a in x.args], x.value
        n = len(args) - len(places)
        matrix = np.zeros((self.lanes, n, n))
        for (i, j), value in zip(places, args, strict=False):
            matrix[:, i, j] = value
        return matrix, np.stack([np.broadcast_to(v, (self.lanes,)) for v in args[len(places) :]], axis=-1)

    def pulled(self, weights: Sequence[Array | float]) -> dict[int, Array]:
        """The sums of weight times derivative over the outputs, by the index of the input; each of shape (L,)."""
        seeds: dict[int, Any] = {}
        sums: dict[int, Array] = {}
        for output, weight in zip(self._outputs, weights, strict=True):
            if np.any(weight):
                seeds[output.index] = seeds.get(output.index, 0.0) + weight
        blocks: dict[int, dict[int, Any]] = {}
        with np.errstate(all="ignore"):
            for x in reversed(self._order):
                if x.index in blocks:
                    parts = self._through_exponential(x, blocks.pop(x.index))
                elif x.constant or x.index not in seeds:
                    continue
                elif x.op == "input":
                    sums[x.value] = np.broadcast_to(seeds.pop(x.index), (self.lanes,))
                    continue
                elif x.op == "get":
                    blocks.setdefault(x.args[0].index, {})[x.value] = seeds.pop(x.index)
                    continue
                else:
                    parts = self._through(x, seeds.pop(x.index))
                for argument, part in parts:
                    seeds[argument.index] = seeds[argument.index] + part if argument.index in seeds else part
        return sums

    def _through(self, x: Expr, seed: Lanes) -> list[tuple[Expr, Any]]:
        """The weights of the arguments of an operation, from the weight of its result."""
        args = [self._values[a.index] for a in x.args]
        if x.op == "select":
            where = np.broadcast_to(args[0], (self.lanes,))
            parts = [None, np.where(where, seed, 0.0), np.where(where, 0.0, seed)]
        else:
            fixed = x.op == "pow" and x.args[1].constant
            slopes = partials(x.op, args, self._values[x.index], fixed_exponent=fixed)
            parts = [np.where(seed == 0, 0.0, seed * p) for p in slopes]  # also where a branch not taken is infinite
        return [(a, p) for a, p in zip(x.args, parts, strict=True) if not (a.constant or a.boolean)]

    def _through_exponential(self, x: Expr, seeds: dict[int, Any]) -> list[tuple[Expr, Any]]:
        """The weights of A and v, from the weights w of exp(A) v.

        They are exp(A)^T w for v, and for A the block (1, 2) of exp of ((A^T, w v^T), (0, A^T)).
        """
        matrix, vector = self._parts(x)
        n = vector.shape[-1]
        weight = np.stack([np.broadcast_to(seeds.get(i, 0.0), (self.lanes,)) for i in range(n)], axis=-1)
        double = np.zeros((self.lanes, 2 * n, 2 * n))
        double[:, :n, :n] = double[:, n:, n:] = np.swapaxes(matrix, 1, 2)
        double[:, :n, n:] = weight[:, :, None] * vector[:, None, :]
        blocks = exponentials(double)
        by_matrix, by_vector = blocks[:, :n, n:], (blocks[:, :n, :n] @ weight[..., None])[..., 0]
        parts = [by_matrix[:, i, j] for i, j in x.value] + [by_vector[:, i] for i in range(n)]
        return [(a, p) for a, p in zip(x.args, parts, strict=True) if not a.constant]


def exponentials(matrices: Array) -> Array:
    """exp of matrices (L, n, n), by its series after scaling, and squaring."""
    norms = np.abs(matrices).sum(axis=-1).max(axis=-1, initial=0.0)
    largest = float(np.max(norms, initial=0.0, where=np.isfinite(norms)))
    squarings = max(0, ceil(log2(largest))) if largest > 0 else 0
    scaled = matrices / 2**squarings
    one = np.eye(matrices.shape[-1])
    power: Array = one + scaled / EXP_TERMS
    for k in range(EXP_TERMS - 1, 0, -1):
        power = one + scaled @ power / k
    for _ in range(squarings):
        power = power @ power
    return power


# A graph as a function on JAX arrays, to be compiled by jax.jit; it can be differentiated and vmapped.

JaxArray: TypeAlias = Any
"""A JAX array or tracer, a numpy array or a number."""
jax: Any = Module("jax")
jnp: Any = Module("jax.numpy")
lax: Any = Module("jax.lax")

EXP_SUBSTEPS, JAX_EXP_TERMS = 4, 18
"""Numbers of substeps and of terms in which exp(A) m is summed; enough for |A| <= 4, beyond that the result is NaN."""


def evaluate_with_jax(
    outputs: Sequence[Expr], inputs: Mapping[int, JaxArray], *, differentiable: bool = False
) -> list[JaxArray]:
    """List of the outputs of a graph, computed by jax.numpy."""
    values: dict[int, Any] = {}
    for x in needed(outputs):
        if not _of_loop(x):
            values[x.index] = _value(x, values, inputs, differentiable)
    return [_known(x, values) for x in outputs]


def _of_loop(x: Expr) -> bool:
    """Whether a number is one of the entries of an array."""
    return x.op == "get" and x.args[0].op in ("map", "table")


def _known(x: Expr, values: Mapping[int, JaxArray]) -> Any:
    if _of_loop(x):
        return values[x.args[0].index][x.value]
    return x.value if x.constant else values[x.index]


def _array(some: Sequence[Expr], values: Mapping[int, JaxArray]) -> Any:
    """Numbers of a graph as one array, along its first axis."""
    if all(x.constant for x in some):
        return np.array([x.value for x in some])
    if _of_loop(some[0]) and all(_of_loop(x) and x.args[0] is some[0].args[0] for x in some):
        whole, places = values[some[0].args[0].index], [x.value for x in some]
        return whole if places == list(range(len(whole))) else whole[np.array(places)]
    return jnp.stack(jnp.broadcast_arrays(*[jnp.asarray(_known(x, values), dtype=float) for x in some]))


def _entries(x: Expr, values: Mapping[int, JaxArray]) -> Any:
    """The results of a "map" or a "table", along the first axis of an array."""
    if x.op == "map":
        name, size = x.value
        lists = [_array(x.args[i : i + size], values) for i in range(0, len(x.args), size)]
        axes = max(a.ndim for a in lists)
        return applied(jnp, name, [a.reshape(size, *[1] * (axes - a.ndim), *a.shape[1:]) for a in lists])
    table, first = x.value
    places, factors = table.padded()
    some = x.args[:first], x.args[first:]
    lists = [_array(part, values) for part, _ in zip(some, places, strict=False)]
    if len(lists) == 1 and np.array_equal(places[0], np.broadcast_to(np.arange(first), (table.rows, first))):
        return jnp.tensordot(factors, lists[0], 1)
    axes = max(a.ndim for a in lists) - 1
    total: Any = factors.reshape(*factors.shape, *[1] * axes)
    for a, place in zip(lists, places, strict=True):
        total = total * a[place].reshape(*place.shape, *[1] * (axes + 1 - a.ndim), *a.shape[1:])
    return total.sum(axis=1)


def _value(x: Expr, values: Mapping[int, Any], inputs: Mapping[int, Any], differentiable: bool) -> Any:
    if x.constant:
        return x.value
    if x.op == "input":
        return inputs[x.value]
    if x.op in ("map", "table"):
        return _entries(x, values)
    if x.op == "loop":
        return _iterated(x, values, differentiable)
    args = [_known(a, values) for a in x.args]
    if x.op == "get":
        return args[0][x.value]
    if x.op == "expv":
        return _exponential(x.value, args)
    return applied(jnp, x.op, args)


def _iterated(x: Expr, values: Mapping[int, JaxArray], differentiable: bool) -> list[JaxArray]:
    """The values of the variables after a loop."""
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
            if not _of_loop(y):
                known[y.index] = _value(y, known, {}, differentiable)
        new = [jnp.broadcast_to(_known(y, known), shape) for y in loop.new]
        return new, jnp.any(_known(loop.again, known))

    more = (start, jnp.any(start[0]) if loop.guarded else jnp.asarray(True))
    if differentiable:  # a loop of a fixed length
        return list(
            lax.fori_loop(
                0, loop.limit, lambda _, state: lax.cond(state[1], lambda s: body(s[0]), lambda s: s, state), more
            )[0]
        )
    _, (state, _) = lax.while_loop(
        lambda state: (state[0] < loop.limit) & state[1][1], lambda state: (state[0] + 1, body(state[1][0])), (0, more)
    )
    return list(state)


def _exponential(places: tuple[tuple[int, int], ...], args: list[JaxArray]) -> list[JaxArray]:
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
        last = jnp.einsum("ij...,j...->i...", matrix, state[0]) / (EXP_SUBSTEPS * (j + 1.0))
        return last, state[1] + last

    def substep(_: JaxArray, v: JaxArray) -> JaxArray:
        return v + lax.fori_loop(0, JAX_EXP_TERMS, term, (v, jnp.zeros_like(v)))[1]

    moved = lax.fori_loop(0, EXP_SUBSTEPS, substep, m)
    return list(jnp.where(size <= EXP_SUBSTEPS**2, moved, jnp.nan))
