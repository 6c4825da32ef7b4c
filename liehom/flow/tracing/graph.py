"""Tracers, and the tape: a graph of scalar operations, recorded and simplified."""

from __future__ import annotations

import cmath
import hashlib
import math
import operator
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import TraceError
from liehom.base.typing import Array, IntegerArray, Lanes

# Tracers. An Expr is a symbolic number or boolean on a tape, which records the operations on it. Constants of a run.

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
OPERATORS: dict[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv, "neg": operator.neg,
    "pow": operator.pow, "lt": operator.lt, "le": operator.le, "eq": operator.eq, "ne": operator.ne,
}  # fmt: skip
# Powers of step sizes need no digits: with the exponent of a float as an integer, and the polynomials of degree 1 and 2
# of the mantissa, they need no branches either. All engines compute the same numbers.
MIDDLE = 0.0430  # half of the largest difference of log2(1 + x) and x in [0, 1]
BEND = 0.3435  # 1 + x (1 - BEND (1 - x)) is 2^x up to 0.4 % in [0, 1]
LARGEST_EXPONENT = 1000.0


def coarse_log2(x: Lanes, xp: ModuleType = np) -> Lanes:
    """The logarithm of x > 0 to base 2, up to 0.0431; -1023 for 0."""
    mantissa, exponent = xp.frexp(x)
    return xp.where(x == 0, MIDDLE - 1023.0, exponent + (2.0 * mantissa - 2.0) + MIDDLE)


def coarse_exp2(x: Lanes, xp: ModuleType = np) -> Lanes:
    """2^x up to 0.4 %, for x between -1000 and 1000, the nearest of which is taken for others."""
    x = xp.clip(x, -LARGEST_EXPONENT, LARGEST_EXPONENT)
    whole = xp.floor(x)
    rest = x - whole
    known = xp.where(xp.isfinite(whole), whole, 0.0)
    return xp.ldexp(1.0 + rest * ((1.0 - BEND) + BEND * rest), known.astype("int32"))


def _coarse_log2(x: float) -> float:
    """`coarse_log2` of a float."""
    mantissa, exponent = math.frexp(x)
    return exponent + (2.0 * mantissa - 2.0) + MIDDLE if x else MIDDLE - 1023.0


def _coarse_exp2(x: float) -> float:
    x = max(min(x, LARGEST_EXPONENT), -LARGEST_EXPONENT)
    whole = math.floor(x)
    rest = x - whole
    return math.ldexp(1.0 + rest * ((1.0 - BEND) + BEND * rest), whole)


COARSE: dict[str, Callable[..., Lanes]] = {"coarse_log2": coarse_log2, "coarse_exp2": coarse_exp2}
FOLDED |= {"coarse_log2": _coarse_log2, "coarse_exp2": _coarse_exp2}
BOOLEAN = frozenset(["lt", "le", "eq", "ne", "and", "or", "not", "flag"])


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

    __slots__ = ("args", "boolean", "index", "op", "tape", "terms", "value")

    def __init__(self, tape: Tape, op: str, args: tuple[Expr, ...], value: Payload, index: int) -> None:
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

    def __add__(self, other: object) -> Expr:
        return self.tape.add(*self._with(other))

    def __sub__(self, other: object) -> Expr:
        return self.tape.sub(*self._with(other))

    def __mul__(self, other: object) -> Expr:
        return self.tape.mul(*self._with(other))

    def __truediv__(self, other: object) -> Expr:
        return self.tape.div(*self._with(other))

    __radd__: Callable[[Expr, object], Expr] = __add__
    __rmul__: Callable[[Expr, object], Expr] = __mul__

    def __rsub__(self, other: object) -> Expr:
        return self.tape.sub(*self._with(other)[::-1])

    def __rtruediv__(self, other: object) -> Expr:
        return self.tape.div(*self._with(other)[::-1])

    def __neg__(self) -> Expr:
        return self.tape.neg(self.tape.number(self))

    def __pos__(self) -> Expr:
        return self

    def __getattr__(self, name: str) -> Callable[..., Expr]:
        # numpy's functions call these methods on the entries of an array of objects
        if name in FOLDED and name not in ("pow", "abs"):
            return lambda *args: self.tape.call(name, self, *[self.tape.of(x) for x in args])
        raise AttributeError(f"a number of a compiled step has no attribute {name!r}")

    def __abs__(self) -> Expr:
        return self.tape.call("abs", self)

    def _with(self, other: object) -> tuple[Expr, Expr]:
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

    __int__ = __index__ = __complex__ = __float__  # they raise alike

    def __repr__(self) -> str:
        return repr(self.value) if self.constant else f"<{self.op} {self.index}>"


# -- numbers that a graph is given when it runs, by their names ------------------------------------------
@final
@dataclass(frozen=True, slots=True)
class RunConstant:
    """A number that all trajectories of a run share and that may differ from run to run, as a trajectory constant."""

    name: str
    value: float  # in the run for which the step was traced

    def __call__(self, points: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        return np.full(points.shape[:-1], self.value)


@final
@dataclass(frozen=True, slots=True)
class LaneConstant:
    """A number that each trajectory is given, as a trajectory constant that is not a function of the initial point."""

    name: str
    values: npt.NDArray[Any]  # (L,): in the run for which the step was traced

    def __call__(self, points: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return self.values


# Operations on many numbers that are recorded, and compiled, as one loop: "map", an elementary operation on the entries
# of arrays, and "table", a linear or bilinear map with constant coefficients.

UNROLLED_OPERATIONS = 28_000
"""Operations of a step up to which code has no loops over entries: it is 2 to 4 times faster, and compiles in 4 s."""
LEAST_LOOP = 4  # entries from which on an operation is a loop, if there are loops over entries


@final
class LongGraphError(Exception):
    """A tape is full."""


@final
class Table:
    """Coefficients of a map of lists: the sums of c x_i, or of c x_i y_j, over the terms of each row.

    Row by row, `places` are arrays (terms,) of the positions i, or i and j, and `factors` (terms,) the numbers c;
    `counts` (rows,) are the numbers of terms of the rows.
    """

    __slots__ = ("counts", "digest", "factors", "places", "rows")

    def __init__(self, rows: int, row: IntegerArray, places: Sequence[IntegerArray], factors: Array) -> None:
        order = np.argsort(row, kind="stable")
        self.rows, self.counts = rows, np.bincount(row, minlength=rows)
        self.places, self.factors = tuple(p[order] for p in places), np.asarray(factors, dtype=np.float64)[order]
        content = b"|".join(x.tobytes() for x in (self.counts, *self.places, self.factors))
        self.digest = hashlib.sha256(content).hexdigest()

    def padded(self) -> tuple[tuple[IntegerArray, ...], Array]:
        """Places and factors as arrays (rows, largest number of terms), with factors 0 in shorter rows."""
        here = np.arange(max(1, int(self.counts.max(initial=0)))) < self.counts[:, None]
        places = tuple(np.zeros(here.shape, dtype=np.int64) for _ in self.places)
        factors = np.zeros(here.shape)
        for full, short in zip((*places, factors), (*self.places, self.factors), strict=True):
            full[here] = short
        return places, factors

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        return f"<table of {self.rows} rows {self.digest}>"


# Tape: a graph of scalar operations, recorded and simplified while numpy code computes with tracers.
#
# Equal operations are recorded once, operations on constants carried out, and products with 0 and 1, terms that cancel
# in a sum, and quotients by the same divisor simplified.

TrajectoryConstant: TypeAlias = Callable[[Any], Any]
"""A number of each trajectory, shape (L,), as a function of the initial points (L, N)."""

COMMUTATIVE = frozenset(["add", "mul", "and", "or", "eq", "ne"])
MAX_TERMS = 10  # of sums that are searched for terms that cancel
CANCELLATION_RTOL = 4e-16  # coefficients of a term cancel if their sum is at most this fraction of one of them


@final
class Tape:
    """The operations of one trace, in the order in which they were recorded.

    Parameters
    ----------
    branching : bool
        Whether rare cases may be left to loops of one iteration, which most blocks of lanes skip. Derivatives and
        array code need a tape without them.

    Examples
    --------
    >>> tape = Tape()
    >>> x, y = tape.input(0), tape.input(1)
    >>> (x * y + 0.0) is (y * x), ((x + y) - y) is x, tape.of(2.0) * 3.0
    (True, True, 6.0)
    """

    def __init__(self, *, branching: bool = True, most: int | None = None, least_loop: int | None = None) -> None:
        """A tape on which `LongGraphError` is raised beyond a number of operations, or which records operations on
        that many entries at least as one."""
        self.branching = branching and least_loop is None
        self.recorded: list[Expr] = []
        self.most, self.least_loop = most, least_loop
        self._known: dict[tuple[Hashable, ...], Expr] = {}
        self.zero, self.one = self.constant(0.0), self.constant(1.0)
        self.false, self.true = self.constant(False), self.constant(True)
        # booleans that must all hold for the compiled step to be valid; otherwise numpy takes the step
        self.required: list[Expr] = []
        self.constant_functions: list[TrajectoryConstant] = []
        self.calls = self.zero  # number of calls of psi, all iterations of loops included

    # -- numbers ----------------------------------------------------------------------------------------
    def constant(self, value: float) -> Expr:
        """Tracer of a known number or boolean."""
        return self._make("const", (), value, (type(value), value, math.copysign(1.0, value)))

    def input(self, index: int) -> Expr:
        """Tracer of input number `index`, known when the compiled code runs."""
        return self._make("input", (), index)

    def trajectory_constant(self, function: TrajectoryConstant) -> Expr:
        """Tracer of a number that is constant along each trajectory, a function of the initial points (L, N)."""
        self.constant_functions.append(function)
        return self.input(-len(self.constant_functions))

    def run_constant(self, name: str, value: float) -> Expr:
        """Tracer of a number of a run, by its name: the same tracer for the same name."""
        for place, known in enumerate(self.constant_functions):
            if isinstance(known, RunConstant) and known.name == name:
                return self.input(-1 - place)
        return self.trajectory_constant(RunConstant(name, value))

    def lane_constant(self, name: str, values: npt.NDArray[Any]) -> Expr:
        """Tracer of a number of each trajectory, by its name."""
        return self.trajectory_constant(LaneConstant(name, values))

    def variable(self, name: Hashable, *, boolean: bool = False) -> Expr:
        """Tracer of a number, or boolean, that changes in a loop."""
        return self._make("flag" if boolean else "variable", (), name)

    def of(self, x: object) -> Expr:
        """x as a tracer; numbers and booleans become constants.

        Raises
        ------
        TraceError
            If x is not a real number.
        """
        if isinstance(x, Expr):
            return x
        if isinstance(x, bool) or type(x).__name__ in ("bool", "bool_"):
            return self.true if x else self.false
        try:
            return self.constant(float(x))  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise TraceError(f"compiled code works on real numbers, got {x!r} in the step") from None

    def number(self, x: Expr) -> Expr:
        """x as a number: 0 or 1 for a boolean."""
        return self.select(x, self.one, self.zero) if x.boolean else x

    def truth(self, x: Expr) -> Expr:
        """x as a boolean: for a number, whether it is not 0."""
        return x if x.boolean else self.compare("ne", x, self.zero)

    def _make(self, op: str, args: tuple[Expr, ...], value: Payload = None, extra: Payload = None) -> Expr:
        if op in COMMUTATIVE and args[0].index > args[1].index:
            args = args[1], args[0]
        key = (op, *[a.index for a in args], value if extra is None else extra)
        known = self._known.get(key)
        if known is None:
            if self.most is not None and len(self.recorded) >= self.most:
                raise LongGraphError
            known = self._known[key] = Expr(self, op, args, value, len(self.recorded))
            self.recorded.append(known)
        return known

    def again(self, x: Expr, args: tuple[Expr, ...]) -> Expr:
        """The operation of x with other arguments."""
        return self._make(x.op, args, x.value)

    # -- arithmetic --------------------------------------------------------------------------------------
    def add(self, a: Expr, b: Expr) -> Expr:
        """a + b."""
        if a.constant and b.constant:
            return self.constant(a.value + b.value)
        if a is self.zero or (a.constant and a.value == 0):
            return b
        if b.constant and b.value == 0:
            return a
        if a is b:
            return self.mul(self.constant(2.0), a)
        total = self._cancelled(a, b, 1.0)
        return self._sum(a, b) if total is None else total

    def _sum(self, a: Expr, b: Expr) -> Expr:
        if b.op == "neg":
            return self._make("sub", (a, b.args[0]))
        if a.op == "neg":
            return self._make("sub", (b, a.args[0]))
        return self._make("add", (a, b))

    def sub(self, a: Expr, b: Expr) -> Expr:
        """a - b."""
        if a.constant and b.constant:
            return self.constant(a.value - b.value)
        if b.constant and b.value == 0:
            return a
        if a.constant and a.value == 0:
            return self.neg(b)
        if a is b:
            return self.zero
        total = self._cancelled(a, b, -1.0)
        if total is not None:
            return total
        return self._sum(a, b.args[0]) if b.op == "neg" else self._make("sub", (a, b))

    def neg(self, a: Expr) -> Expr:
        """-a."""
        if a.constant:
            return self.constant(-a.value)
        if a.op == "neg":
            return a.args[0]
        if a.op == "sub":
            return self._make("sub", (a.args[1], a.args[0]))
        if a.op == "mul" and a.args[0].constant:
            return self.mul(self.constant(-a.args[0].value), a.args[1])
        return self._make("neg", (a,))

    def mul(self, a: Expr, b: Expr) -> Expr:
        """a b."""
        if b.constant:
            a, b = b, a
        if a.constant:
            if b.constant:
                return self.constant(a.value * b.value)
            if a.value == 0:
                return self.zero
            if a.value == 1:
                return b
            if a.value == -1:
                return self.neg(b)
            if b.op == "neg":
                return self.mul(self.constant(-a.value), b.args[0])
            if b.op == "mul" and b.args[0].constant:
                return self.mul(self.constant(a.value * b.args[0].value), b.args[1])
            return self._make("mul", (a, b))
        if a.op == "neg" and b.op == "neg":
            return self.mul(a.args[0], b.args[0])
        for x, y in ((a, b), (b, a)):
            if x.op == "neg":
                return self.neg(self.mul(x.args[0], y))
            if x.op == "mul" and x.args[0].constant and y.op == "mul" and y.args[0].constant:
                return self.mul(x.args[0], self.mul(y.args[0], self.mul(x.args[1], y.args[1])))
        return self._make("mul", (a, b))

    def div(self, a: Expr, b: Expr) -> Expr:
        """a / b, as a product with 1 / b, which is computed once for all quotients by b."""
        if b.constant:
            if b.value == 0:
                return self._make("div", (a, b))
            return self.constant(a.value / b.value) if a.constant else self.mul(self.constant(1.0 / b.value), a)
        if a.constant and a.value == 0:
            return self.zero
        if a is b:
            return self.one
        if b.op == "neg":
            return self.neg(self.div(a, b.args[0]))
        if b.op == "mul" and b.args[0].constant:
            return self.mul(self.constant(1.0 / b.args[0].value), self.div(a, b.args[1]))
        return self.mul(a, self._make("div", (self.one, b)))

    def power(self, a: Expr, b: Expr) -> Expr:
        """a ** b, by products and square roots if b is a small multiple of 1/2."""
        if b.constant:
            p = b.value
            if p == 0:
                return self.one
            if float(2 * p).is_integer() and abs(p) <= 32:
                n = int(abs(p))
                power = self.one if abs(p) == n else self.call("sqrt", a)
                while n:
                    power = self.mul(power, a) if n & 1 else power
                    n >>= 1
                    a = self.mul(a, a) if n else a
                return power if p > 0 else self.div(self.one, power)
        return self.call("pow", a, b)

    def call(self, name: str, *args: Expr) -> Expr:
        """The elementary function of this name, computed at once if all arguments are constants."""
        if all(a.constant for a in args) and name in FOLDED:
            try:
                return self.constant(float(FOLDED[name](*[float(a.value) for a in args])))
            except (ValueError, OverflowError):  # numpy gives inf or NaN
                with np.errstate(all="ignore"):
                    function = getattr(np, {"pow": "power"}.get(name, name), None)
                    return self.constant(float(function(*[a.value for a in args])) if function else math.nan)
        if name == "abs" and args[0].op in ("neg", "abs"):
            return self.call("abs", args[0].args[0])
        return self._make(name, args)

    def largest(self, a: Expr, b: Expr, *, least: bool = False) -> Expr:
        """The larger of two numbers, or the smaller if `least`; NaN if one of them is NaN."""
        if a is b:
            return a
        a, b = (b, a) if a.constant else (a, b)
        if b.constant:
            if a.constant and math.isnan(a.value):
                return a
            if math.isnan(b.value):
                return b
            return self.select(self.compare("le", b, a) if least else self.compare("le", a, b), b, a)
        first = self.select(self.compare("ne", a, a), a, b)
        return self.select(self.compare("lt", a, b) if least else self.compare("lt", b, a), a, first)

    # -- booleans ----------------------------------------------------------------------------------------
    def compare(self, op: str, a: Expr, b: Expr) -> Expr:
        """The comparison a < b, a <= b, a == b or a != b, for op = "lt", "le", "eq", "ne"."""
        if a.constant and b.constant:
            x, y = a.value, b.value
            return self.of({"lt": x < y, "le": x <= y, "eq": x == y, "ne": x != y}[op])
        if a is b and op == "lt":
            return self.false
        if op in ("lt", "le"):
            first, second = self._square(a), self._square(b)
            if first and second and (first[1] or second[1]):  # of roots, without the roots
                a, b = first[0], second[0]
        return self._make(op, (a, b))

    def _square(self, x: Expr) -> tuple[Expr, bool] | None:
        """(x^2, whether x contains a square root) if x >= 0 is certain, else None."""
        if x.constant:
            return (self.constant(x.value * x.value), False) if x.value >= 0 else None
        if x.op == "sqrt":  # the root of a negative number is NaN
            return (x.args[0], True) if _is_nonnegative(x.args[0]) else None
        if x.op == "abs":
            return self.mul(x.args[0], x.args[0]), False
        if x.op == "mul":
            first, second = self._square(x.args[0]), self._square(x.args[1])
            if first and second:
                return self.mul(first[0], second[0]), first[1] or second[1]
        return None

    def both(self, a: Expr, b: Expr) -> Expr:
        """The conjunction of a and b, as booleans."""
        a, b = self.truth(a), self.truth(b)
        if a.constant:
            return b if a.value else self.false
        if b.constant:
            return a if b.value else self.false
        return a if a is b else self._make("and", (a, b))

    def either(self, a: Expr, b: Expr) -> Expr:
        """The disjunction of a and b, as booleans."""
        return self.negated(self.both(self.negated(a), self.negated(b)))

    def negated(self, a: Expr) -> Expr:
        """The negation of a, as a boolean."""
        a = self.truth(a)
        if a.constant:
            return self.of(not a.value)
        return a.args[0] if a.op == "not" else self._make("not", (a,))

    def select(self, where: Expr, a: Expr, b: Expr) -> Expr:
        """a in the lanes where the condition holds, b in the others."""
        where = self.truth(where)
        if a.boolean is not b.boolean:
            a, b = self.number(a), self.number(b)
        if where.constant:
            return a if where.value else b
        if a is b:
            return a
        if where.op == "not":
            return self.select(where.args[0], b, a)
        return self._make("select", (where, a, b))

    # -- blocks ------------------------------------------------------------------------------------------
    def block(self, name: str, args: Sequence[Expr], count: int, data: Payload) -> list[Expr]:
        """The `count` results of one operation that contains loops, such as "expv"."""
        operation = self._make(name, tuple(args), data)
        return [self._make("get", (operation,), i) for i in range(count)]

    def mapped(self, name: str, *lists: Sequence[Expr]) -> list[Expr]:
        """An operation on the entries of lists of one length; those that constants simplify are recorded alone."""
        alone: Callable[..., Expr] = getattr(self, name, None) or (lambda *args: self.call(name, *args))
        simple = np.array([_simplifies(name, entries) for entries in zip(*lists, strict=True)], dtype=bool)
        rest = np.flatnonzero(~simple).tolist()
        if self.least_loop is None or len(rest) < self.least_loop:
            return [alone(*entries) for entries in zip(*lists, strict=True)]
        loop = iter(self.block("map", [x[i] for x in lists for i in rest], len(rest), (name, len(rest))))
        return [alone(*e) if s else next(loop) for e, s in zip(zip(*lists, strict=True), simple, strict=True)]

    def summed(
        self, rows: int, row: IntegerArray, factors: Array, *operands: tuple[Sequence[Expr], IntegerArray]
    ) -> list[Expr]:
        """The sums of c x_i or c x_i y_j over the terms of each row; operands are (numbers, place in each term)."""
        factors, lists = np.broadcast_to(factors, row.shape), list[tuple[Sequence[Expr], IntegerArray]]()
        for numbers, place in operands:
            constant = np.array([x.constant for x in numbers], dtype=bool)
            values = np.array([float(x.value) if x.constant else 1.0 for x in numbers])
            factors = factors * values[place]
            if not constant.all():
                one = dict.fromkeys(np.flatnonzero(constant).tolist(), self.one)
                lists.append(([one.get(i, x) for i, x in enumerate(numbers)] if one else numbers, place))
        kept = factors != 0
        row, factors, lists = row[kept], factors[kept], [(x, place[kept]) for x, place in lists]
        alone = np.bincount(row, minlength=rows) < (2 if len(lists) == 1 else 1)  # rows of one number
        if self.least_loop is None or len(row) < self.least_loop or not lists:
            alone[:] = True
        results = [self.zero] * rows
        for term in np.flatnonzero(alone[row]):
            product = self.constant(float(factors[term]))
            for numbers, place in reversed(lists):
                product = self.mul(product, numbers[place[term]])
            results[row[term]] = self.add(results[row[term]], product)
        others, rest = np.flatnonzero(~alone), ~alone[row]
        if len(others):
            used = [np.unique(place[rest], return_inverse=True) for _, place in lists]
            places = [renumbered.reshape(-1) for _, renumbered in used]
            args = [x[i] for (x, _), (some, _) in zip(lists, used, strict=True) for i in some]
            table = Table(len(others), np.searchsorted(others, row[rest]), places, factors[rest])
            for i, x in zip(others, self.block("table", args, len(others), (table, len(used[0][0]))), strict=True):
                results[i] = x
        return results

    # -- sums in which terms cancel ----------------------------------------------------------------------
    def _cancelled(self, a: Expr, b: Expr, sign: float) -> Expr | None:
        """a + sign b if terms of a and b cancel, else None."""
        first, second = self._terms(a), self._terms(b)
        if first is None or second is None or not any(x in first for x in second):
            return None
        merged, gone = dict(first), 0
        for x, c in second.items():
            total = merged.get(x, 0.0) + sign * c
            if abs(total) <= CANCELLATION_RTOL * abs(c):
                del merged[x]
                gone += 1
            else:
                merged[x] = total
        return self._combination(merged) if gone else None

    def _combination(self, terms: dict[Expr, float]) -> Expr:
        total = self.zero
        for x, c in sorted(terms.items(), key=lambda item: (item[1] < 0, item[0].index)):
            term = self.mul(self.constant(abs(c)), x)
            if total is self.zero:
                total = term if c > 0 else self.neg(term)
            else:
                total = self._make("add" if c > 0 else "sub", (total, term))
        return total

    def _terms(self, x: Expr) -> dict[Expr, float] | None:
        """x as a sum {tracer: coefficient}, or None if it has more than MAX_TERMS terms."""
        if x.terms is None:
            terms = self._expanded(x)
            x.terms = terms if terms is not None and len(terms) <= MAX_TERMS else False
        return x.terms or None

    def _expanded(self, x: Expr) -> dict[Expr, float] | None:
        if x.op in ("add", "sub"):
            parts = [(x.args[0], 1.0), (x.args[1], 1.0 if x.op == "add" else -1.0)]
        elif x.op == "neg":
            parts = [(x.args[0], -1.0)]
        elif x.op == "mul" and x.args[0].constant:
            parts = [(x.args[1], x.args[0].value)]
        else:
            return {x: 1.0}
        total: dict[Expr, float] = {}
        for part, factor in parts:
            terms = self._terms(part)
            if terms is None:
                return None
            for y, c in terms.items():
                total[y] = total.get(y, 0.0) + factor * c
        return total


def _simplifies(name: str, args: Sequence[Expr]) -> bool:
    """Whether constants among the arguments of an operation leave no operation, or a change of sign."""
    known = [x.value for x in args if x.constant]
    return len(known) == len(args) or any(x == 0 or (name == "mul" and abs(x) == 1) for x in known)


def _is_nonnegative(x: Expr) -> bool:
    """Whether x >= 0 or x = NaN is certain, as for sums, products and quotients of squares."""
    stack, seen = [x], set()
    while stack:
        y = stack.pop()
        square = y.op == "mul" and y.args[0] is y.args[1]
        if y.index in seen or square or y.op in ("sqrt", "abs", "exp") or (y.constant and y.value >= 0):
            continue
        if y.op not in ("add", "mul", "div", "select"):
            return False
        seen.add(y.index)
        stack.extend(y.args[1:] if y.op == "select" else y.args)
    return True


def needed(outputs: Sequence[Expr]) -> list[Expr]:
    """All operations that the outputs depend on, in the order of the tape.

    Examples
    --------
    >>> tape = Tape()
    >>> x, unused = tape.input(0), tape.input(1)
    >>> [e.op for e in needed([x * x + 1.0])]
    ['const', 'input', 'mul', 'add']
    """
    seen: dict[int, Expr] = {}
    stack = list(outputs)
    while stack:
        x = stack.pop()
        if x.index not in seen:
            seen[x.index] = x
            stack.extend(x.args)
    return [seen[place] for place in sorted(seen)]
