"""Derivatives of a recorded graph in reverse mode, and the value of a graph on arrays, Jets and tracers.

A function F of N numbers that is run once on tracers leaves a graph of scalar operations.  One pass backwards over it
gives all N partial derivatives as graphs, for a few times the operations of F.  `evaluated` runs a graph through
numpy's functions, so that it takes whatever they take.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from liehom.errors import TraceError
from liehom.tracing.expr import Expr
from liehom.tracing.graph import Tape, needed

Partials = tuple[Expr, ...]
"""One partial derivative for each argument of an operation."""


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
        for argument, partial in zip(x.args, _partials(tape, x), strict=True):
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
}


def _partials(tape: Tape, x: Expr) -> Partials:
    """The partial derivatives of an operation by its arguments."""
    one, args = tape.one, x.args
    match x.op:
        case "add":
            return one, one
        case "sub":
            return one, tape.neg(one)
        case "neg":
            return (tape.neg(one),)
        case "mul":
            return args[1], args[0]
        case "div":
            return tape.div(one, args[1]), tape.neg(tape.div(x, args[1]))
        case "pow":
            slope = tape.mul(args[1], tape.power(args[0], tape.sub(args[1], one)))
            return slope, tape.zero if args[1].constant else tape.mul(x, tape.call("log", args[0]))
        case "select":
            return tape.zero, tape.select(args[0], one, tape.zero), tape.select(args[0], tape.zero, one)
        case "arctan2":
            size = tape.add(tape.mul(args[0], args[0]), tape.mul(args[1], args[1]))
            return tape.div(args[1], size), tape.neg(tape.div(args[0], size))
    rule = _SLOPES.get(x.op)
    if rule is None:
        raise TraceError(f"the operation {x.op} of a recorded function is not differentiated")
    return (rule(tape, args[0], x),)


def _scaled(tape: Tape, factor: float, x: Expr) -> Expr:
    return tape.mul(tape.constant(factor), x)


def _one_minus(tape: Tape, x: Expr) -> Expr:
    return tape.sub(tape.one, tape.mul(x, x))


def _one_plus(tape: Tape, x: Expr) -> Expr:
    return tape.add(tape.one, tape.mul(x, x))


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
    "abs": lambda tape, a, x: tape.select(tape.compare("lt", a, tape.zero), tape.constant(-1.0), tape.one),
}
