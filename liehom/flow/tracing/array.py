"""Traced: an array of tracers, on which numpy code runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np
import numpy.typing as npt
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import DTypeLike

from liehom.base.errors import TraceError
from liehom.base.typing import IntegerArray, Key
from liehom.flow.tracing.graph import FOLDED, Expr, Tape

# Tables of numpy's functions as operations on a tape, and linear equations by elimination on a tape.

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

ExprArray: TypeAlias = npt.NDArray[Any]  # an array of objects that are `Expr` of one tape


def _sign(tape: Tape, x: Expr) -> Expr:
    negative = tape.select(tape.compare("lt", x, tape.zero), tape.constant(-1.0), x)
    return tape.select(tape.compare("lt", tape.zero, x), tape.one, negative)


def _known_extremum(tape: Tape, a: Expr, b: Expr, *, least: bool = False) -> Expr:
    """The larger of two numbers, or the smaller if `least`; if one is NaN, the other."""
    larger = tape.select(tape.compare("lt", a, b) if least else tape.compare("lt", b, a), a, b)
    return tape.select(tape.compare("ne", b, b), a, larger)


def _exclusive(tape: Tape, a: Expr, b: Expr) -> Expr:
    return tape.select(a, tape.negated(b), tape.truth(b))


LOGICAL: dict[str, Callable[..., Expr]] = {
    "logical_and": Tape.both, "bitwise_and": Tape.both, "logical_or": Tape.either, "bitwise_or": Tape.either,
    "logical_xor": _exclusive, "bitwise_xor": _exclusive, "logical_not": Tape.negated, "invert": Tape.negated,
}  # fmt: skip
ELEMENTS: dict[str, Callable[..., Expr]] = {
    **dict.fromkeys(["absolute", "fabs"], lambda tape, x: tape.call("abs", x)),
    "maximum": Tape.largest, "minimum": partial(Tape.largest, least=True), "fmax": _known_extremum,
    "fmin": partial(_known_extremum, least=True), "greater": lambda tape, a, b: tape.compare("lt", b, a),
    "greater_equal": lambda tape, a, b: tape.compare("le", b, a), "isnan": lambda tape, a: tape.compare("ne", a, a),
    "isfinite": lambda tape, a: tape.compare("lt", tape.call("abs", a), tape.constant(np.inf)),
    "isinf": lambda tape, a: tape.compare("eq", tape.call("abs", a), tape.constant(np.inf)),
    "power": Tape.power, "float_power": Tape.power, "hypot": lambda tape, a, b: tape.call("sqrt", a * a + b * b),
    "sign": _sign, **dict.fromkeys(["deg2rad", "radians"], lambda tape, a: a * (np.pi / 180)),
    **dict.fromkeys(["rad2deg", "degrees"], lambda tape, a: a * (180 / np.pi)),
}  # fmt: skip


def solve_linear(tape: Tape, a: ExprArray, b: ExprArray) -> ExprArray:
    """Solution (n, k) of a x = b for arrays of tracers a (n, n) and b (n, k), with partial pivoting by selection."""
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


# The entries of a traced array are `Expr` of one tape, in an array of objects. Numpy functions that only move, add and
# multiply entries run on that array; comparisons, extrema, `np.where` and linear systems are here; those that need
# values raise `TraceError`.

Operand: TypeAlias = Any
"""A traced array, an array of numbers or of `Expr`, a number, or a nested list of these."""

Axis: TypeAlias = int | tuple[int, ...] | None


@final
class Traced(NDArrayOperatorsMixin):
    """An array of tracers.

    Examples
    --------
    >>> import numpy as np
    >>> tape = Tape()
    >>> m = Traced.inputs(tape, 0, 3)
    >>> x = np.cross(m, [0.0, 0.0, 1.0])
    >>> x.shape, x[0].entry is m[1].entry
    ((3,), True)
    """

    entries: ExprArray
    tape: Tape

    __slots__ = ("entries", "tape")
    if TYPE_CHECKING:  # methods of arrays that `__getattr__` finds
        astype: Callable[..., Traced]
        copy: Callable[..., Traced]
        reshape: Callable[..., Traced]
        sum: Callable[..., Traced]
        max: Callable[..., Traced]
        min: Callable[..., Traced]
        any: Callable[..., Traced]
        all: Callable[..., Traced]
    __array_priority__: float = 100.0

    def __init__(self, tape: Tape, entries: Operand) -> None:
        self.tape = tape
        self.entries = expr_array(tape, entries)

    @classmethod
    def inputs(cls, tape: Tape, first: int, count: int) -> Traced:
        """Array (count,) of the inputs first, ..., first + count - 1."""
        return cls(tape, [tape.input(first + i) for i in range(count)])

    # -- what arrays have --------------------------------------------------------------------------------
    @property
    def shape(self) -> tuple[int, ...]:
        """Tuple of axis lengths, as for numpy arrays."""
        return tuple(self.entries.shape)

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return int(self.entries.ndim)

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(self.entries.size)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the entries, float64 or bool."""
        return np.dtype(bool if self.entries.size and self.entries.flat[0].boolean else np.float64)

    @property
    def T(self) -> Traced:
        """Array with the axes in reverse order."""
        return Traced(self.tape, self.entries.T)

    @property
    def entry(self) -> Expr:
        """The tracer of an array of shape ()."""
        return self.entries.item()

    @property
    def real(self) -> Traced:
        """This array, as all entries are real."""
        return self

    @property
    def flat(self) -> Iterator[Traced]:
        """Iterator over the entries, as arrays of shape ()."""
        return iter([Traced(self.tape, e) for e in self.entries.flat])

    def __getitem__(self, key: Key) -> Traced:
        return Traced(self.tape, self.entries[_checked_key(key)])

    def __setitem__(self, key: Key, value: Operand) -> None:
        self.entries[_checked_key(key)] = value.entries if isinstance(value, Traced) else expr_array(self.tape, value)

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[Traced]:
        if not self.ndim:
            raise TypeError("iteration over a number")
        return iter([self[i] for i in range(len(self))])

    def __bool__(self) -> bool:
        if self.size != 1:
            raise TraceError("the truth value of an array is asked for in the step")
        return bool(self.entries.flat[0])

    def __float__(self) -> float:
        if self.size != 1:
            raise TypeError("only an array of one entry can be a float")
        return float(self.entries.flat[0])

    __int__ = __index__ = __float__  # they raise alike
    __hash__ = object.__hash__

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("__"):
            raise AttributeError(name)
        if callable(getattr(np.ndarray, name, None)) and (hasattr(np, name) or name in ("astype", "item")):
            return lambda *args, **options: _method(self, name, *args, **options)
        if name in FOLDED:  # numpy's functions call these on arrays of objects, such as np.array([m[0], m[1]])
            return lambda: getattr(np, name)(self)
        raise AttributeError(f"an array of a compiled step has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"<traced array of shape {self.shape}>"

    # -- numpy's protocols -------------------------------------------------------------------------------
    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        # an array of objects; a tracer that is converted to a float raises TraceError
        return self.entries.copy() if dtype is None else self.entries.astype(dtype)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: object, **options: Any) -> Any:
        if any(_is_foreign(x) for x in inputs):
            return NotImplemented  # a Jet of traced values
        options = {k: v for k, v in options.items() if v is not None}
        out = options.pop("out", None)
        result = _ufunc(self.tape, ufunc, method, inputs, options)
        if out is None:
            return result
        if not isinstance(out[0], Traced):
            raise TraceError(f"np.{ufunc.__name__} writes into an array of floats: use x = x + y in place of x += y")
        out[0].entries[...] = result.entries
        return out[0]

    def __array_function__(
        self, function: Callable[..., Any], types: Iterable[type], args: tuple[Any, ...], options: dict[str, Any]
    ) -> Any:
        if not all(issubclass(t, Traced | np.ndarray) for t in types):
            return NotImplemented
        name = function.__name__
        if "linalg" in (function.__module__ or ""):
            name = f"linalg.{name}"
        if name in PRODUCTS and self.tape.least_loop is not None and not set(options) - {"optimize"}:
            result = _product(self.tape, name, args)
            if result is not None:
                return result
        if name in SPECIAL:
            return SPECIAL[name](self.tape, *args, **options)
        if name in STRUCTURAL:
            return _wrapped(self.tape, function(*_bare(self.tape, args), **_bare(self.tape, options)))
        raise TraceError(f"np.{name} cannot be compiled: it needs the values of its arguments, or is not known here")


def _is_foreign(x: object) -> bool:
    return not isinstance(x, Traced | np.ndarray | np.generic) and hasattr(type(x), "__array_ufunc__")


def _method(x: Traced, name: str, *args: Operand, **options: Operand) -> Operand:
    if name == "astype":
        return _converted(x, *args, **options)
    if name in ("reshape", "transpose") and len(args) > 1:
        args = (args,)
    if name == "item":
        return x[args] if args else x.reshape(())
    return getattr(np, name)(x, *args, **options)


def _converted(x: Traced, dtype: DTypeLike, **_: object) -> Traced:
    """Copy with another dtype; raises TraceError if that would change a number."""
    kind = np.dtype(dtype)
    if kind.kind == "b":
        return elementwise(x.tape, x.tape.truth, x)
    if kind in (np.float64, np.dtype(object)) or (x.dtype.kind == "b" and kind.kind in "iuf"):
        return Traced(x.tape, _numbers(x.tape, x).entries.copy())
    raise TraceError(f"compiled code computes in float64: numbers are not made {kind}")


def expr_array(tape: Tape, x: Operand) -> ExprArray:
    """x as an array of `Expr`, with broadcasting of numbers left to numpy."""
    if isinstance(x, Traced):
        return x.entries
    if isinstance(x, Expr):
        out = np.empty((), dtype=object)
        out[()] = x
        return out
    array = np.asarray(x)
    if array.dtype == object and all(type(e) is Expr for e in array.flat):
        return array
    out = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array):
        out[index] = value.entries[()] if isinstance(value, Traced) else tape.of(value)
    return out


def _bare(tape: Tape, x: Operand) -> Operand:
    """Arguments with traced arrays replaced by their arrays of `Expr`."""
    if isinstance(x, Traced):
        return x.entries
    if isinstance(x, list) and any(isinstance(e, Traced) for e in x) and all(np.ndim(e) == 0 for e in x):
        return [expr_array(tape, e) for e in x]
    if isinstance(x, list | tuple):
        return type(x)(_bare(tape, e) for e in x)
    if isinstance(x, dict):
        return {k: _bare(tape, v) for k, v in x.items()}
    return x


def _wrapped(tape: Tape, x: Operand) -> Operand:
    if isinstance(x, list | tuple):
        return type(x)(_wrapped(tape, e) for e in x)
    return Traced(tape, x)


def _checked_key(key: Key) -> Key:
    parts = key if isinstance(key, tuple) else (key,)
    if any(isinstance(part, Traced) for part in parts):
        raise TraceError("an index depends on the values of the step: write np.where")
    return key


def elementwise(tape: Tape, function: Callable[..., Expr], *arrays: Operand, numbers: bool = False) -> Traced:
    """Traced array of function(entries), with broadcasting; with `numbers`, booleans become 0 or 1."""
    entries = [expr_array(tape, _numbers(tape, a) if numbers else a) for a in arrays]
    return Traced(tape, np.frompyfunc(function, len(entries), 1)(*entries))


# -- ufuncs ------------------------------------------------------------------------------------------------
def _ufunc(tape: Tape, ufunc: np.ufunc, method: str, inputs: tuple[Operand, ...], options: dict[str, Any]) -> Traced:
    name = ufunc.__name__
    if tape.least_loop is not None and method == "__call__" and not options:
        result = _in_loops(tape, name, inputs)
        if result is not None:
            return result
    if method == "reduce" and name in REDUCTIONS:
        options.setdefault("axis", 0)
        return getattr(np, REDUCTIONS[name])(*inputs, **options)
    if method != "__call__" or set(options) - {"dtype", "casting"}:
        raise TraceError(f"np.{name}.{method} with {sorted(options)} cannot be compiled")
    if name == "add" and all((x if isinstance(x, Traced) else np.asarray(x)).dtype.kind == "b" for x in inputs):
        name = "logical_or"
    if name in ARITHMETIC:
        return Traced(tape, ufunc(*[expr_array(tape, x) for x in inputs]))
    if name in COMPARISONS:
        return elementwise(tape, lambda a, b: tape.compare(COMPARISONS[name], a, b), *inputs, numbers=True)
    if name in LOGICAL:
        return elementwise(tape, lambda *a: LOGICAL[name](tape, *a), *inputs)
    if name in ELEMENTS:
        return elementwise(tape, lambda *a: ELEMENTS[name](tape, *a), *inputs, numbers=True)
    if name in FOLDED:
        return elementwise(tape, lambda *a: tape.call(name, *a), *inputs, numbers=True)
    raise TraceError(f"np.{name} cannot be compiled")


# -- operations that are recorded as loops over entries ----------------------------------------------------
LABELS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
MAPPED = {
    "add": "add", "subtract": "sub", "multiply": "mul", "divide": "div", "true_divide": "div", "negative": "neg",
    "absolute": "abs", "fabs": "abs", "square": "mul",
}  # fmt: skip
SUBSCRIPTS = {
    "matvec": "...ij,...j->...i", "vecmat": "...i,...ij->...j", "vecdot": "...i,...i->...", "outer": "i,j->ij",
    "inner": "...i,ji->...j", "matmul": "...i,ij->...j", "row": "i,...ij->...j", "batch": "...ki,...ij->...kj",
}  # fmt: skip
PRODUCTS = frozenset(["matmul", "matvec", "vecmat", "vecdot", "dot", "inner", "outer", "einsum"])


def _in_loops(tape: Tape, name: str, inputs: Sequence[Operand]) -> Traced | None:
    """The result of a function of arrays that is recorded as one operation; None if it is not recorded so."""
    if name in PRODUCTS:
        return _product(tape, name, inputs)
    operation = MAPPED.get(name) or (name if name in FOLDED and len(inputs) == 1 else None)
    if operation is None:
        return None
    arrays = [_numbers(tape, x).entries for x in (*inputs, *inputs[: name == "square"])]
    if operation == "div" and (arrays[1].size == 1 or all(x.constant and x.value != 0 for x in arrays[1].flat)):
        operation, arrays[1] = "mul", elementwise(tape, lambda x: tape.div(tape.one, x), arrays[1]).entries
    spread = np.broadcast_arrays(*arrays)
    out = np.empty(spread[0].size, dtype=object)
    out[:] = tape.mapped(operation, *[list(a.reshape(-1)) for a in spread])
    return Traced(tape, out.reshape(spread[0].shape))


def _product(tape: Tape, name: str, inputs: Sequence[Operand]) -> Traced | None:
    """A product of arrays with sums over axes, at most two of them not constant; None for other products."""
    subscripts = inputs[0] if name == "einsum" else None
    arrays = [_numbers(tape, x).entries for x in (inputs[1:] if name == "einsum" else inputs)]
    if name == "outer":
        arrays = [a.reshape(-1) for a in arrays]
    if name in ("matmul", "dot", "inner"):
        first, second = (a.ndim for a in arrays)
        if not first or not second or (name != "matmul" and second > 2):
            return None
        name = name if name == "inner" and second == 2 else "matmul" if second < 3 else "row" if first == 1 else "batch"
        subscripts = "...i,i->..." if second == 1 else SUBSCRIPTS[name]
    else:
        subscripts = SUBSCRIPTS.get(name, subscripts)
    varying = sum(any(not x.constant for x in a.flat) for a in arrays)
    if not isinstance(subscripts, str) or "->" not in subscripts or varying > 2:
        return None
    left, out = subscripts.replace(" ", "").split("->")
    parts, free = left.split(","), [x for x in LABELS if x not in subscripts]
    dots = [max(a.ndim - len(part.replace("...", "")), 0) for a, part in zip(arrays, parts, strict=True)]
    names = "".join(free[: max(dots)])
    labels = [p.replace("...", names[len(names) - d :]) for p, d in zip(parts, dots, strict=True)]
    return contracted(tape, arrays, labels, out.replace("...", names))


def contracted(tape: Tape, arrays: Sequence[ExprArray], labels: Sequence[str], out: str) -> Traced:
    """The sums of products of entries over the axes whose labels are not in `out`."""
    sizes = dict[str, int]()
    for array, names in zip(arrays, labels, strict=True):
        for size, name in zip(array.shape, names, strict=True):
            sizes[name] = max(size, sizes.get(name, 1)) if size else 0
    order = out + "".join(x for x in sizes if x not in out)
    grid = np.indices([sizes[x] for x in order]).reshape(len(order), int(np.prod([sizes[x] for x in order], dtype=int)))
    places = dict(zip(order, grid, strict=True))

    def flat(shape: Sequence[int], names: str) -> IntegerArray:
        place = np.zeros(grid.shape[1], dtype=np.int64)
        for size, name in zip(shape, names, strict=True):
            place = place * size + (places[name] if size > 1 else 0)
        return place

    shape = tuple(sizes[x] for x in out)
    operands = [(list(a.reshape(-1)), flat(a.shape, names)) for a, names in zip(arrays, labels, strict=True)]
    entries = np.empty(int(np.prod(shape, dtype=int)), dtype=object)
    entries[:] = tape.summed(len(entries), flat(shape, out), np.ones(1), *operands)
    return Traced(tape, entries.reshape(shape))


# -- functions that are not only structural ----------------------------------------------------------------
def _reduced(
    tape: Tape, combine: Callable[[Expr, Expr], Expr], a: Operand, axis: Axis, keepdims: bool, start: Expr | None
) -> Traced:
    function: Any = np.frompyfunc(combine, 2, 1, identity=None)
    return Traced(tape, function.reduce(expr_array(tape, a), axis=axis, keepdims=keepdims, initial=start))


def _numbers(tape: Tape, a: Operand) -> Traced:
    """a as a traced array of numbers, booleans as 0 or 1."""
    array = Traced(tape, a)
    return elementwise(tape, tape.number, array) if any(e.boolean for e in array.entries.flat) else array


def _sum(tape: Tape, a: Operand, axis: Axis = None, where: Operand = True, **options: Operand) -> Traced:
    known = {k: v for k, v in options.items() if k in ("keepdims", "initial")}
    if tape.least_loop is not None and not any(known.values()):
        entries = _numbers(tape, _where(tape, where, a, 0.0)).entries
        axes = {k % entries.ndim for k in (range(entries.ndim) if axis is None else np.atleast_1d(axis))}
        names = LABELS[: entries.ndim]
        return contracted(tape, [entries], [names], "".join(x for k, x in enumerate(names) if k not in axes))
    return Traced(tape, np.sum(_numbers(tape, _where(tape, where, a, 0.0)).entries, axis=axis, **known))


def _extremum(
    tape: Tape, a: Operand, axis: Axis = None, out: object = None, keepdims: bool = False,
    initial: float | None = None, where: Operand = True, *, least: bool = False,
) -> Traced:  # fmt: skip
    start = None if initial is None or not np.isscalar(initial) else tape.of(initial)
    a = _numbers(tape, a) if start is None else _where(tape, where, _numbers(tape, a), start)
    return _reduced(tape, partial(tape.largest, least=least), a, axis, keepdims is True, start)


def _quantifier(
    tape: Tape, a: Operand, axis: Axis = None, out: object = None, keepdims: bool = False, where: Operand = True,
    *, every: bool = False,
) -> Traced:  # fmt: skip
    combine, empty = (tape.both, tape.true) if every else (tape.either, tape.false)
    return _reduced(tape, combine, _where(tape, where, a, empty), axis, keepdims is True, empty)


def _where(tape: Tape, condition: Operand, x: Operand = None, y: Operand = None) -> Traced:
    if x is None:
        raise TraceError("np.where(condition) gives indices, which depend on values")
    return elementwise(tape, tape.select, condition, x, y)


def _clip(tape: Tape, a: Operand, a_min: Operand = None, a_max: Operand = None, **options: Operand) -> Operand:
    low, high = options.get("min", a_min), options.get("max", a_max)
    a = a if low is None else np.maximum(a, low)
    return a if high is None else np.minimum(a, high)


def _without_nan(
    tape: Tape, a: Operand, copy: bool = True, nan: float = 0.0, posinf: float | None = None,
    neginf: float | None = None,
) -> Operand:  # fmt: skip
    largest = float(np.finfo(np.float64).max)
    high, low = largest if posinf is None else posinf, -largest if neginf is None else neginf
    return np.where(np.isnan(a), nan, np.where(a == np.inf, high, np.where(a == -np.inf, low, a)))


def _norm(tape: Tape, x: Operand, ord: float | str | None = None, axis: Axis = None, keepdims: bool = False) -> Operand:
    axes = np.ndim(x) if axis is None else np.size(axis)
    if not (ord is None or (ord == 2 and axes == 1) or (ord == "fro" and axes == 2)):
        raise TraceError(f"np.linalg.norm with ord={ord!r} cannot be compiled")
    return np.sqrt(np.sum(x * x, axis=axis, keepdims=keepdims))


def _solve(tape: Tape, a: Operand, b: Operand) -> Traced:
    """Solution of a x = b by elimination with partial pivoting."""
    a, b = expr_array(tape, a), expr_array(tape, b)
    vector = b.ndim == 1
    b = b[..., None] if vector else b
    lead = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    a, b = np.broadcast_to(a, (*lead, *a.shape[-2:])), np.broadcast_to(b, (*lead, *b.shape[-2:]))
    out = np.empty(b.shape, dtype=object)
    for index in np.ndindex(*lead):
        out[index] = solve_linear(tape, a[index].copy(), b[index].copy())
    return Traced(tape, out[..., 0] if vector else out)


def _inverse(tape: Tape, a: Operand) -> Traced:
    return _solve(tape, a, np.broadcast_to(np.eye(np.shape(a)[-1]), np.shape(a)))


def _blank(
    tape: Tape, a: Operand, *_: object, shape: Sequence[int] | None = None, fill: float = 0.0, **__: object
) -> Traced:
    return Traced(tape, np.full(np.shape(a) if shape is None else shape, fill))


SPECIAL: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(["max", "amax"], _extremum), **dict.fromkeys(["min", "amin"], partial(_extremum, least=True)),
    "all": partial(_quantifier, every=True), "any": _quantifier, "where": _where, "sum": _sum, "clip": _clip,
    "linalg.norm": _norm, "linalg.solve": _solve, "linalg.inv": _inverse,
    "zeros_like": _blank, "ones_like": partial(_blank, fill=1.0), "empty_like": _blank,
    "full_like": lambda tape, a, fill_value, **_: Traced(tape, np.full(np.shape(a), 1.0)) * fill_value,
    "shape": lambda tape, a: a.shape, "ndim": lambda tape, a: a.ndim,
    "size": lambda tape, a, axis=None: a.size if axis is None else a.shape[axis],
    "result_type": lambda tape, *arrays: np.dtype(np.float64),
    "real": lambda tape, a: a, "nan_to_num": _without_nan,
    "array_equal": lambda tape, a, b: np.all(a == b), "iscomplexobj": lambda tape, a: False,
}  # fmt: skip


# Functions of the exponential that are one operation of the graph: sin(r)/r and cos(r) of r^2, and exp(A) m.
#
# They branch on the size of their arguments, which a graph cannot; the emitters (`machine_code`, `jax_code`) write the
# branches and loops.


def entire_function(name: str, x: Traced) -> Traced:
    """Traced array of sin(r)/r ("sinq") or cos(r) ("cosq") of the entries x = r^2."""
    return elementwise(x.tape, lambda q: x.tape.call(name, q), x)


def exponential_action(matrix: Operand, m: Operand) -> Traced:
    """exp(A) m for a matrix A (n, n) and a vector m (n,), by a series; the compiled code decides its length."""
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
