"""Expr, a tracer: a symbolic number or boolean on a tape, which records the operations on it. Constants of a run."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.errors import TraceError

NumberLike: TypeAlias = object
"""A tracer, or a number that `Tape.of` makes a constant."""

Payload: TypeAlias = Any
"""Data of an operation: a constant's value, an index, the name of a variable, a `Loop`, positions in a matrix."""

FOLDED: dict[str, Callable[..., float]] = {
    "sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan, "exp": math.exp, "log": math.log,
    "sinh": math.sinh, "cosh": math.cosh, "tanh": math.tanh, "arcsin": math.asin, "arccos": math.acos,
    "arctan": math.atan, "arcsinh": math.asinh, "arccosh": math.acosh, "arctanh": math.atanh, "expm1": math.expm1,
    "log1p": math.log1p, "log2": math.log2, "log10": math.log10, "exp2": math.exp2, "cbrt": math.cbrt,
    "arctan2": math.atan2, "pow": math.pow, "abs": abs,
    "sinq": lambda q: (cmath.sin(cmath.sqrt(q)) / cmath.sqrt(q)).real if q else 1.0,
    "cosq": lambda q: cmath.cos(cmath.sqrt(q)).real,
}  # fmt: skip
BOOLEAN = frozenset(["lt", "le", "eq", "ne", "and", "or", "not", "flag"])


class Recorder(Protocol):
    """The methods of `liehom.tracing.Tape` that arithmetic on an `Expr` calls."""

    def of(self, x: NumberLike) -> Expr: ...
    def number(self, x: Expr) -> Expr: ...
    def add(self, a: Expr, b: Expr) -> Expr: ...
    def sub(self, a: Expr, b: Expr) -> Expr: ...
    def mul(self, a: Expr, b: Expr) -> Expr: ...
    def div(self, a: Expr, b: Expr) -> Expr: ...
    def neg(self, a: Expr) -> Expr: ...
    def power(self, a: Expr, b: Expr) -> Expr: ...
    def call(self, name: str, *args: Expr) -> Expr: ...


@final
class Expr:
    """A tracer: a symbolic number or boolean on a tape.

    Attributes
    ----------
    tape : Tape
    op : str
        "const", "input", "add", ..., "get" for one of the results of a block.
    args : tuple of Expr
    value : float, int, str or None
        The value of a constant, the index of an input or of a block's result, data of other operations.
    index : int
        Position on the tape; arguments have smaller ones.
    boolean : bool
        Whether it is a boolean.
    """

    args: tuple[Expr, ...]
    boolean: bool
    index: int
    op: str
    tape: Recorder
    value: Payload

    __slots__ = ("args", "boolean", "index", "op", "tape", "terms", "value")

    def __init__(self, tape: Recorder, op: str, args: tuple[Expr, ...], value: Payload, index: int) -> None:
        self.tape, self.op, self.args, self.value, self.index = tape, op, args, value, index
        self.terms: dict[Expr, float] | Literal[False] | None = None
        self.boolean = op in BOOLEAN
        if op == "const":
            self.boolean = isinstance(value, bool)
        elif op == "select":
            self.boolean = args[1].boolean
        elif op == "get" and args[0].op == "loop":
            self.boolean = args[0].args[value].boolean

    @property
    def constant(self) -> bool:
        """Whether the value is known while the step is traced."""
        return self.op == "const"

    def __add__(self, other: NumberLike) -> Expr:
        return self.tape.add(*self._with(other))

    def __sub__(self, other: NumberLike) -> Expr:
        return self.tape.sub(*self._with(other))

    def __mul__(self, other: NumberLike) -> Expr:
        return self.tape.mul(*self._with(other))

    def __truediv__(self, other: NumberLike) -> Expr:
        return self.tape.div(*self._with(other))

    __radd__: Callable[[Expr, NumberLike], Expr] = __add__
    __rmul__: Callable[[Expr, NumberLike], Expr] = __mul__

    def __rsub__(self, other: NumberLike) -> Expr:
        return self.tape.sub(*self._with(other)[::-1])

    def __rtruediv__(self, other: NumberLike) -> Expr:
        return self.tape.div(*self._with(other)[::-1])

    def __neg__(self) -> Expr:
        return self.tape.neg(self.tape.number(self))

    def __pos__(self) -> Expr:
        return self

    def __pow__(self, other: NumberLike) -> Expr:
        return self.tape.power(*self._with(other))

    def __rpow__(self, other: NumberLike) -> Expr:
        return self.tape.power(*self._with(other)[::-1])

    def __getattr__(self, name: str) -> Callable[..., Expr]:
        # numpy's functions call these methods on the entries of an array of objects
        if name in FOLDED and name not in ("pow", "abs"):
            return lambda *args: self.tape.call(name, self, *[self.tape.of(x) for x in args])
        raise AttributeError(f"a number of a compiled step has no attribute {name!r}")

    def __abs__(self) -> Expr:
        return self.tape.call("abs", self)

    def _with(self, other: NumberLike) -> tuple[Expr, Expr]:
        """This tracer and `other` as a pair of numbers; booleans become 0 or 1."""
        other = self.tape.of(other)
        return self.tape.number(self) if self.boolean else self, self.tape.number(other) if other.boolean else other

    def conjugate(self) -> Expr:
        """This tracer, as all numbers are real."""
        return self

    def __bool__(self) -> bool:
        if self.constant:
            return bool(self.value)
        raise TraceError(
            "the step branches on the value of a number (`if`, `while`, `and`, a comparison used as an index), which "
            "compiled code does not know: write np.where, or take engine='numpy'"
        )

    def __float__(self) -> float:
        if self.constant:
            return float(self.value)
        raise TraceError(
            "the step makes a plain float of a number that compiled code does not know yet (math.sin, float(), an "
            "entry of a float array): use numpy's functions and np.stack, or take engine='numpy'"
        )

    if TYPE_CHECKING:
        # raises like __float__
        def __int__(self) -> int: ...
        def __index__(self) -> int: ...
        def __complex__(self) -> complex: ...
    else:
        __int__ = __index__ = __complex__ = __float__

    def __repr__(self) -> str:
        return repr(self.value) if self.constant else f"<{self.op} {self.index}>"


# -- numbers that a graph is given when it runs, by their names ------------------------------------------
@final
@dataclass(frozen=True, slots=True)
class RunConstant:
    """A number that all trajectories of a run share and that may differ from run to run, as a trajectory constant.

    Attributes
    ----------
    name : str
    value : float
        Its value in the run for which the step was traced.

    Examples
    --------
    >>> RunConstant("rtol", 1e-3)(np.zeros((2, 3))).tolist()
    [0.001, 0.001]
    """

    name: str
    value: float

    def __call__(self, points: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        return np.full(points.shape[:-1], self.value)


@final
@dataclass(frozen=True, slots=True)
class LaneConstant:
    """A number that each trajectory is given, as a trajectory constant that is not a function of the initial point.

    Attributes
    ----------
    name : str
    values : array of shape (L,)
        Its values in the run for which the step was traced.

    Examples
    --------
    >>> LaneConstant("rate", np.array([1.0, 2.0]))(np.zeros((2, 3)))
    array([1., 2.])
    """

    name: str
    values: npt.NDArray[Any]

    def __call__(self, points: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return self.values
