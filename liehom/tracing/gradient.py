"""Derivatives of a recorded graph in reverse mode, and the value of a graph on arrays, Jets and tracers.

A function F of N numbers that is run once on tracers leaves a graph of scalar operations.  One pass backwards over it
gives all N partial derivatives as graphs, for a few times the operations of F.  `evaluated` runs a graph through
numpy's functions, so that it takes whatever they take.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.errors import TraceError
from liehom.tracing.expr import Expr
from liehom.tracing.graph import Tape, needed
from liehom.typing import Array

Number: TypeAlias = Any
"""A number of a graph, or an array of such numbers."""
Arithmetic: TypeAlias = Any
"""A `Tape`, or an object with its methods add, sub, mul, ..., on other numbers."""

SINQ_TERMS = 10
"""Terms of the derivative of sin(r)/r by r^2, for |r| <= 1."""


def gradient(output: Expr, inputs: Sequence[Expr]) -> list[Expr]:
    """List of the partial derivatives of a number of a graph by its inputs, as numbers of the same graph.

    Parameters
    ----------
    output : Expr
    inputs : sequence of Expr
        Tracers on the tape of the output.

    Raises
    ------
    TraceError
        If the output depends on an input through a loop, a matrix exponential, or a function without a derivative.

    Examples
    --------
    >>> tape = Tape()
    >>> x, y = tape.input(0), tape.input(1)
    >>> [float(d) for d in evaluated(gradient(x * x * y, [x, y]), {0: 3.0, 1: 2.0})]
    [12.0, 9.0]
    """
    recorder: Any = output.tape
    tape: Tape = recorder
    wanted = {x.index for x in inputs}
    order = needed([output])
    moving = set(wanted)  # operations that depend on an input
    for x in order:
        if x.index not in moving and any(a.index in moving for a in x.args):
            moving.add(x.index)
    seeds = {output.index: tape.one}
    for x in reversed(order):
        seed = seeds.get(x.index)
        if seed is None or x.index in wanted or x.index not in moving:
            continue
        slopes = partials(tape, x.op, x.args, x, fixed_exponent=x.op == "pow" and x.args[1].constant)
        for argument, partial in zip(x.args, slopes, strict=True):
            if argument.index in moving and not argument.boolean:
                part = tape.mul(seed, partial)
                known = seeds.get(argument.index)
                seeds[argument.index] = part if known is None else tape.add(known, part)
    return [seeds.get(x.index, tape.zero) for x in inputs]


def evaluated(outputs: Sequence[Expr], inputs: Mapping[int, Any]) -> list[Any]:
    """List of the outputs of a graph, computed by numpy on arrays of any precision, Jets or tracers.

    Parameters
    ----------
    outputs : sequence of Expr
    inputs : dict
        Values, of shapes that broadcast, by the index of the input.

    Raises
    ------
    TraceError
        If the graph has a loop or a matrix exponential.

    Examples
    --------
    >>> tape = Tape()
    >>> evaluated([tape.call("sin", tape.input(0) * 0.5)], {0: np.array([0.0, np.pi])})[0].tolist()
    [0.0, 1.0]
    """
    values: dict[int, Any] = {}
    for x in needed(outputs):
        if x.constant:
            values[x.index] = x.value
        elif x.op == "input":
            values[x.index] = inputs[x.value]
        else:
            function = _NUMPY.get(x.op) or getattr(np, x.op, None)
            if function is None:
                raise TraceError(f"the operation {x.op} of a recorded function has no counterpart in numpy")
            values[x.index] = function(*[values[a.index] for a in x.args])
    return [values[x.index] for x in outputs]


_NUMPY: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "pow": lambda a, b: a**b,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
    "and": lambda a, b: np.logical_and(a, b),
    "not": lambda a: np.logical_not(a),
    "select": lambda where, a, b: np.where(where, a, b),
    "abs": np.abs,
    "sinq": lambda q: rotation(q, 1),
    "cosq": lambda q: rotation(q, 0),
}


def rotation(square: npt.ArrayLike, first: int) -> Array:
    """sin(r)/r (first = 1) or cos(r) (first = 0) of r^2, hyperbolic for r^2 < 0.

    Examples
    --------
    >>> rotation([0.0, -1.0], 1).round(6).tolist()
    [1.0, 1.175201]
    """
    q: Array = np.asarray(square, dtype=np.float64)
    r = np.sqrt(np.abs(q))
    grown = np.where(q < 0, r, 0.0)
    if not first:
        return np.where(q < 0, np.cosh(grown), np.cos(r))
    safe = np.where(r == 0, 1.0, r)
    return np.where(r == 0, 1.0, np.where(q < 0, np.sinh(grown), np.sin(r)) / safe)


def partials(
    ops: Arithmetic, op: str, args: Sequence[Number], value: Number, *, fixed_exponent: bool = False
) -> tuple[Number, ...]:
    """The partial derivatives of an operation by its arguments, one for each.

    Parameters
    ----------
    ops : Tape, or an object with its arithmetic
    op : str
    args : sequence of numbers
    value : number
        The result of the operation.
    fixed_exponent : bool
        Whether the exponent of a power is a constant.

    Raises
    ------
    TraceError
        If the operation has no derivative here.

    Examples
    --------
    >>> tape = Tape()
    >>> x, y = tape.input(0), tape.input(1)
    >>> partials(tape, "mul", (x, y), x * y) == (y, x)
    True
    """
    one = ops.one
    match op:
        case "add":
            return one, one
        case "sub":
            return one, ops.neg(one)
        case "neg":
            return (ops.neg(one),)
        case "mul":
            return args[1], args[0]
        case "div":
            return ops.div(one, args[1]), ops.neg(ops.div(value, args[1]))
        case "pow":
            slope = ops.mul(args[1], ops.power(args[0], ops.sub(args[1], one)))
            return slope, ops.zero if fixed_exponent else ops.mul(value, ops.call("log", args[0]))
        case "select":
            return ops.zero, ops.select(args[0], one, ops.zero), ops.select(args[0], ops.zero, one)
        case "arctan2":
            size = ops.add(ops.mul(args[0], args[0]), ops.mul(args[1], args[1]))
            return ops.div(args[1], size), ops.neg(ops.div(args[0], size))
    rule = _SLOPES.get(op)
    if rule is None:
        raise TraceError(f"the operation {op} of a recorded function is not differentiated")
    return (rule(ops, args[0], value),)


def _scaled(tape: Tape, factor: float, x: Expr) -> Expr:
    return tape.mul(tape.constant(factor), x)


def _one_minus(tape: Tape, x: Expr) -> Expr:
    return tape.sub(tape.one, tape.mul(x, x))


def _one_plus(tape: Tape, x: Expr) -> Expr:
    return tape.add(tape.one, tape.mul(x, x))


def _sinq_slope(tape: Tape, a: Expr, x: Expr) -> Expr:
    """Derivative of sin(r)/r by q = r^2: (cos(r) - sin(r)/r) / 2q, and near q = 0 its series."""
    near = tape.compare("lt", tape.call("abs", a), tape.one)
    total: Any = tape.zero
    for k in range(SINQ_TERMS, 0, -1):
        total = tape.add(tape.mul(total, a), tape.constant(k * (-1) ** k / math.factorial(2 * k + 1)))
    safe = tape.select(near, tape.one, a)
    return tape.select(near, total, tape.div(_scaled(tape, 0.5, tape.sub(tape.call("cosq", a), x)), safe))


# slope of a function of one number: (tape, argument, value) -> derivative
_SLOPES: dict[str, Callable[[Tape, Expr, Expr], Expr]] = {
    "sqrt": lambda tape, a, x: tape.div(tape.constant(0.5), x),
    "cbrt": lambda tape, a, x: tape.div(tape.constant(1 / 3), tape.mul(x, x)),
    "sin": lambda tape, a, x: tape.call("cos", a),
    "cos": lambda tape, a, x: tape.neg(tape.call("sin", a)),
    "tan": lambda tape, a, x: _one_plus(tape, x),
    "exp": lambda tape, a, x: x,
    "exp2": lambda tape, a, x: _scaled(tape, math.log(2), x),
    "expm1": lambda tape, a, x: tape.add(x, tape.one),
    "log": lambda tape, a, x: tape.div(tape.one, a),
    "log2": lambda tape, a, x: tape.div(tape.constant(1 / math.log(2)), a),
    "log10": lambda tape, a, x: tape.div(tape.constant(1 / math.log(10)), a),
    "log1p": lambda tape, a, x: tape.div(tape.one, tape.add(tape.one, a)),
    "sinh": lambda tape, a, x: tape.call("cosh", a),
    "cosh": lambda tape, a, x: tape.call("sinh", a),
    "tanh": lambda tape, a, x: _one_minus(tape, x),
    "arcsin": lambda tape, a, x: tape.div(tape.one, tape.call("sqrt", _one_minus(tape, a))),
    "arccos": lambda tape, a, x: tape.neg(tape.div(tape.one, tape.call("sqrt", _one_minus(tape, a)))),
    "arctan": lambda tape, a, x: tape.div(tape.one, _one_plus(tape, a)),
    "arcsinh": lambda tape, a, x: tape.div(tape.one, tape.call("sqrt", _one_plus(tape, a))),
    "arccosh": lambda tape, a, x: tape.div(tape.one, tape.call("sqrt", tape.neg(_one_minus(tape, a)))),
    "arctanh": lambda tape, a, x: tape.div(tape.one, _one_minus(tape, a)),
    "sinq": _sinq_slope,
    "cosq": lambda tape, a, x: _scaled(tape, -0.5, tape.call("sinq", a)),
    "abs": lambda tape, a, x: tape.select(tape.compare("lt", a, tape.zero), tape.constant(-1.0), tape.one),
}
