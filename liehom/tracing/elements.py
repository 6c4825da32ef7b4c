"""Tables of numpy's functions as operations on a tape, and linear equations by elimination on a tape."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.tracing.expr import Expr
from liehom.tracing.graph import Tape

# numpy functions that run on arrays of `Expr` as they are
ARITHMETIC = frozenset(["add", "subtract", "multiply", "divide", "true_divide", "negative", "positive", "matmul",
                        "square", "reciprocal", "conjugate", "vecdot", "matvec", "vecmat"])  # fmt: skip
REDUCTIONS = {
    "add": "sum", "multiply": "prod", "maximum": "max", "minimum": "min", "logical_and": "all", "logical_or": "any",
}  # fmt: skip
COMPARISONS = {"less": "lt", "less_equal": "le", "equal": "eq", "not_equal": "ne"}
STRUCTURAL = frozenset(["stack", "concatenate", "reshape", "swapaxes", "transpose", "moveaxis", "broadcast_to",
    "expand_dims", "squeeze", "ravel", "diagonal", "trace", "dot", "tensordot", "inner", "outer", "cross", "kron",
    "vdot", "roll", "flip", "take", "repeat", "tile", "cumsum", "diff", "mean", "prod", "hstack", "vstack", "dstack",
    "column_stack", "split", "array_split", "atleast_1d", "atleast_2d", "copy", "fliplr", "flipud", "rot90", "triu",
    "tril", "append", "diag", "delete", "insert", "rollaxis", "matrix_transpose", "vecdot", "block", "average",
    "concat", "permute_dims", "unstack", "einsum"])  # fmt: skip
# methods of arrays that are numpy functions of the same name
METHODS = frozenset(["astype", "copy", "item", "reshape", "transpose", "sum", "max", "min", "all", "any", "mean", "dot",
    "swapaxes", "ravel", "squeeze", "clip", "prod", "trace", "diagonal", "take", "repeat", "cumsum", "conj",
    "conjugate"])  # fmt: skip

ExprArray: TypeAlias = npt.NDArray[Any]
"""An array of objects that are `Expr` of one tape."""


def _sign(tape: Tape, x: Expr) -> Expr:
    negative = tape.select(tape.compare("lt", x, tape.zero), tape.constant(-1.0), x)
    return tape.select(tape.compare("lt", tape.zero, x), tape.one, negative)


def _known_extremum(tape: Tape, a: Expr, b: Expr, *, least: bool = False) -> Expr:
    """The larger of two numbers, or the smaller if `least`; if one is NaN, the other."""
    larger = tape.select(tape.compare("lt", a, b) if least else tape.compare("lt", b, a), a, b)
    return tape.select(tape.compare("ne", b, b), a, larger)


LOGICAL: dict[str, Callable[..., Expr]] = {
    "logical_and": lambda tape, a, b: tape.both(a, b),
    "bitwise_and": lambda tape, a, b: tape.both(a, b),
    "logical_or": lambda tape, a, b: tape.either(a, b),
    "bitwise_or": lambda tape, a, b: tape.either(a, b),
    "logical_xor": lambda tape, a, b: tape.select(a, tape.negated(b), tape.truth(b)),
    "bitwise_xor": lambda tape, a, b: tape.select(a, tape.negated(b), tape.truth(b)),
    "logical_not": lambda tape, a: tape.negated(a),
    "invert": lambda tape, a: tape.negated(a),
}
ELEMENTS: dict[str, Callable[..., Expr]] = {
    "absolute": lambda tape, x: tape.call("abs", x),
    "fabs": lambda tape, x: tape.call("abs", x),
    "maximum": lambda tape, a, b: tape.largest(a, b),
    "minimum": lambda tape, a, b: tape.largest(a, b, least=True),
    "fmax": lambda tape, a, b: _known_extremum(tape, a, b),
    "fmin": lambda tape, a, b: _known_extremum(tape, a, b, least=True),
    "greater": lambda tape, a, b: tape.compare("lt", b, a),
    "greater_equal": lambda tape, a, b: tape.compare("le", b, a),
    "isfinite": lambda tape, a: tape.compare("lt", tape.call("abs", a), tape.constant(np.inf)),
    "isinf": lambda tape, a: tape.compare("eq", tape.call("abs", a), tape.constant(np.inf)),
    "isnan": lambda tape, a: tape.compare("ne", a, a),
    "power": lambda tape, a, b: tape.power(a, b),
    "float_power": lambda tape, a, b: tape.power(a, b),
    "hypot": lambda tape, a, b: tape.call("sqrt", tape.add(tape.mul(a, a), tape.mul(b, b))),
    "sign": _sign,
    "deg2rad": lambda tape, a: tape.mul(a, tape.constant(np.pi / 180)),
    "radians": lambda tape, a: tape.mul(a, tape.constant(np.pi / 180)),
    "rad2deg": lambda tape, a: tape.mul(a, tape.constant(180 / np.pi)),
    "degrees": lambda tape, a: tape.mul(a, tape.constant(180 / np.pi)),
}


def solve_linear(tape: Tape, a: ExprArray, b: ExprArray) -> ExprArray:
    """Solution (n, k) of a x = b for arrays of tracers a (n, n) and b (n, k), with partial pivoting by selection.

    Examples
    --------
    >>> tape = Tape()
    >>> x = tape.input(0)
    >>> one, zero = tape.one, tape.zero
    >>> solve_linear(tape, np.array([[zero, one], [one, zero]]), np.array([[x], [one]])).ravel().tolist()
    [1.0, <input 4>]
    """
    n = len(a)
    rows = np.concatenate([a, b], axis=1)
    for i in range(n):
        for j in range(i + 1, n):
            better = tape.compare("lt", tape.call("abs", rows[i, i]), tape.call("abs", rows[j, i]))
            for k in range(i, rows.shape[1]):
                p, q = rows[i, k], rows[j, k]
                rows[i, k], rows[j, k] = tape.select(better, q, p), tape.select(better, p, q)
        rows[i, i + 1 :] = rows[i, i + 1 :] / rows[i, i]
        for j in range(i + 1, n):
            rows[j, i + 1 :] = rows[j, i + 1 :] - rows[i, i + 1 :] * rows[j, i]
    for i in range(n - 1, 0, -1):
        for j in range(i):
            rows[j, n:] = rows[j, n:] - rows[i, n:] * rows[j, i]
    return rows[:, n:]
