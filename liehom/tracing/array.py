"""Traced: an array of numbers that are not known yet, on which ordinary numpy code runs.

The entries are `Expr` of one tape, in an array of objects.  Numpy's functions that only move entries, add and multiply
run on that array; comparisons, extrema, `np.where` and linear systems are here.  What needs values is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, final

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from liehom.errors import TraceError
from liehom.tracing.elements import ELEMENTS, LOGICAL, solve_linear
from liehom.tracing.expr import FOLDED, Expr
from liehom.tracing.graph import Tape

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


@final
class Traced(NDArrayOperatorsMixin):
    """An array of numbers on a tape.

    Parameters
    ----------
    tape : Tape
    entries : array of objects, or array_like of numbers

    Examples
    --------
    >>> import numpy as np
    >>> tape = Tape()
    >>> m = Traced.inputs(tape, 0, 3)
    >>> x = np.cross(m, [0.0, 0.0, 1.0])
    >>> x.shape, x[0].entries[()] is m[1].entries[()]
    ((3,), True)
    """

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
    __array_priority__ = 100.0

    def __init__(self, tape: Tape, entries: Any) -> None:
        self.tape = tape
        self.entries = _objects(tape, entries)

    @classmethod
    def inputs(cls, tape: Tape, first: int, count: int) -> Traced:
        """The inputs first, ..., first + count - 1."""
        return cls(tape, [tape.input(first + i) for i in range(count)])

    # -- what arrays have --------------------------------------------------------------------------------
    @property
    def shape(self) -> tuple[int, ...]:
        """As of an array."""
        return tuple(self.entries.shape)

    @property
    def ndim(self) -> int:
        """As of an array."""
        return int(self.entries.ndim)

    @property
    def size(self) -> int:
        """As of an array."""
        return int(self.entries.size)

    @property
    def dtype(self) -> Any:
        """float64, or bool."""
        boolean = self.entries.size and self.entries.flat[0].boolean
        return np.dtype(bool) if boolean else np.dtype(np.float64)

    @property
    def T(self) -> Traced:
        """The transpose."""
        return Traced(self.tape, self.entries.T)

    @property
    def real(self) -> Traced:
        """Itself."""
        return self

    @property
    def flat(self) -> Iterator[Traced]:
        """The entries, one after the other."""
        return iter([Traced(self.tape, e) for e in self.entries.flat])

    def __getitem__(self, key: Any) -> Traced:
        return Traced(self.tape, self.entries[_checked_key(key)])

    def __setitem__(self, key: Any, value: Any) -> None:
        self.entries[_checked_key(key)] = value.entries if isinstance(value, Traced) else _objects(self.tape, value)

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

    __int__ = __index__ = __float__
    __hash__ = object.__hash__

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name in METHODS:
            return lambda *args, **options: _method(self, name, *args, **options)
        if name in FOLDED:  # numpy's functions call these on arrays of objects, such as np.array([m[0], m[1]])
            return lambda: getattr(np, name)(self)
        raise AttributeError(f"an array of a compiled step has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"<traced array of shape {self.shape}>"

    # -- numpy's protocols -------------------------------------------------------------------------------
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        # as an array of objects; numbers that are not known are no floats, which they say themselves
        return self.entries.copy() if dtype is None else self.entries.astype(dtype)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        if any(_is_foreign(x) for x in inputs):
            return NotImplemented  # a Jet of traced values
        options = {k: v for k, v in options.items() if v is not None}
        out = options.pop("out", None)
        made = _ufunc(self.tape, ufunc, method, inputs, options)
        if out is None:
            return made
        if not isinstance(out[0], Traced):
            raise TraceError(f"np.{ufunc.__name__} writes into an array of floats: use x = x + y in place of x += y")
        out[0].entries[...] = made.entries
        return out[0]

    def __array_function__(self, function: Any, types: Any, args: Any, options: Any) -> Any:
        if not all(issubclass(t, Traced | np.ndarray) for t in types):
            return NotImplemented
        name = function.__name__
        if "linalg" in (function.__module__ or ""):
            name = f"linalg.{name}"
        if name in SPECIAL:
            return SPECIAL[name](self.tape, *args, **options)
        if name in STRUCTURAL:
            return _wrapped(self.tape, function(*_bare(self.tape, args), **_bare(self.tape, options)))
        raise TraceError(f"np.{name} cannot be compiled: it needs the values of its arguments, or is not known here")


def _is_foreign(x: Any) -> bool:
    return not isinstance(x, Traced | np.ndarray | np.generic) and hasattr(type(x), "__array_ufunc__")


def _method(x: Traced, name: str, *args: Any, **options: Any) -> Any:
    if name == "astype":
        return _converted(x, *args, **options)
    if name == "copy":
        return Traced(x.tape, x.entries.copy())
    if name in ("reshape", "transpose") and len(args) > 1:
        args = (args,)
    if name == "item":
        return x[args] if args else x.reshape(())
    return getattr(np, name)(x, *args, **options)


def _converted(x: Traced, dtype: Any, **_: Any) -> Traced:
    """A copy with another type, where that changes no number."""
    kind = np.dtype(dtype)
    if kind.kind == "b":
        return _each(x.tape, x.tape.truth, x)
    if kind in (np.float64, np.dtype(object)) or (x.dtype.kind == "b" and kind.kind in "iuf"):
        return Traced(x.tape, _numbers(x.tape, x).entries.copy())
    raise TraceError(f"compiled code computes in float64: numbers are not made {kind}")


METHODS = frozenset(["astype", "copy", "item", "reshape", "transpose", "sum", "max", "min", "all", "any", "mean", "dot",
    "swapaxes", "ravel", "squeeze", "clip", "prod", "trace", "diagonal", "take", "repeat", "cumsum", "conj",
    "conjugate"])  # fmt: skip


def _objects(tape: Tape, x: Any) -> Any:
    """An array of Expr."""
    if isinstance(x, Traced):
        return x.entries
    if isinstance(x, Expr):
        out = np.empty((), dtype=object)
        out[()] = x
        return out
    array = np.asarray(x)
    if array.dtype != object:
        out = np.empty(array.shape, dtype=object)
        for index, value in np.ndenumerate(array):
            out[index] = tape.of(value)
        return out
    if all(type(e) is Expr for e in array.flat):
        return array
    out = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array):
        out[index] = value.entries[()] if isinstance(value, Traced) else tape.of(value)
    return out


def _bare(tape: Tape, x: Any) -> Any:
    """Arguments with the arrays of objects in place of traced arrays."""
    if isinstance(x, Traced):
        return x.entries
    if isinstance(x, list) and any(isinstance(e, Traced) for e in x) and all(np.ndim(e) == 0 for e in x):
        return [_objects(tape, e) for e in x]
    if isinstance(x, list | tuple):
        return type(x)(_bare(tape, e) for e in x)
    if isinstance(x, dict):
        return {k: _bare(tape, v) for k, v in x.items()}
    return x


def _wrapped(tape: Tape, x: Any) -> Any:
    if isinstance(x, list | tuple):
        return type(x)(_wrapped(tape, e) for e in x)
    return Traced(tape, x)


def _checked_key(key: Any) -> Any:
    parts = key if isinstance(key, tuple) else (key,)
    if any(isinstance(part, Traced) for part in parts):
        raise TraceError("an index depends on the values of the step: write np.where")
    return key


def _each(tape: Tape, function: Callable[..., Expr], *arrays: Any, numbers: bool = False) -> Traced:
    """function on the entries, with broadcasting; `numbers`: truth values count as 0 and 1."""
    made = np.broadcast_arrays(*[_objects(tape, _numbers(tape, a) if numbers else a) for a in arrays])
    out = np.empty(made[0].shape, dtype=object)
    for index in np.ndindex(out.shape):
        out[index] = function(*[a[index] for a in made])
    return Traced(tape, out)


def special(name: str, x: Traced) -> Traced:
    """An entire function of the entries: "sinq" is sin(r)/r and "cosq" is cos(r), with r^2 = x.

    Examples
    --------
    >>> special("cosq", Traced(Tape(), [0.0])).entries
    array([1.0], dtype=object)
    """
    return _each(x.tape, lambda q: x.tape.call(name, q), x)


def exponential_action(matrix: Any, m: Any) -> Traced:
    """exp(A) m for a matrix (n, n) and a vector (n,), by a series whose length the running code finds.

    Examples
    --------
    >>> tape = Tape()
    >>> exponential_action(Traced(tape, np.zeros((2, 2))), Traced.inputs(tape, 0, 2)).entries
    array([<input 4>, <input 5>], dtype=object)
    """
    tape = (matrix if isinstance(matrix, Traced) else m).tape
    a, v = _objects(tape, matrix), _objects(tape, m)
    if a.ndim != 2 or v.ndim != 1:
        raise TraceError(f"exp(A) m is compiled for one A and one m, got shapes {a.shape} and {v.shape}")
    places = tuple(
        (i, j) for i in range(len(v)) for j in range(len(v)) if not (a[i, j].constant and a[i, j].value == 0)
    )
    if not places:
        return Traced(tape, v)
    return Traced(tape, tape.block("expv", [*[a[p] for p in places], *v], len(v), places))


# -- ufuncs ------------------------------------------------------------------------------------------------
def _ufunc(tape: Tape, ufunc: Any, method: str, inputs: Any, options: Any) -> Traced:
    name = ufunc.__name__
    if method == "reduce" and name in REDUCTIONS:
        options.setdefault("axis", 0)
        made: Traced = getattr(np, REDUCTIONS[name])(*inputs, **options)
        return made
    if method != "__call__" or set(options) - {"dtype", "casting"}:
        raise TraceError(f"np.{name}.{method} with {sorted(options)} cannot be compiled")
    if name == "add" and all((x if isinstance(x, Traced) else np.asarray(x)).dtype.kind == "b" for x in inputs):
        name = "logical_or"
    if name in ARITHMETIC:
        return Traced(tape, ufunc(*[_objects(tape, x) for x in inputs]))
    if name in COMPARISONS:
        return _each(tape, lambda a, b: tape.compare(COMPARISONS[name], a, b), *inputs, numbers=True)
    if name in LOGICAL:
        return _each(tape, lambda *a: LOGICAL[name](tape, *a), *inputs)
    if name in ELEMENTS:
        return _each(tape, lambda *a: ELEMENTS[name](tape, *a), *inputs, numbers=True)
    if name in FOLDED:
        return _each(tape, lambda *a: tape.call(name, *a), *inputs, numbers=True)
    raise TraceError(f"np.{name} cannot be compiled")


# -- functions that are not only structural ----------------------------------------------------------------
def _reduced(
    tape: Tape, combine: Callable[[Expr, Expr], Expr], a: Any, axis: Any, keepdims: bool, start: Any
) -> Traced:
    entries = _objects(tape, a)
    if axis is None:
        axes = tuple(range(entries.ndim))
    else:
        axes = tuple(k % entries.ndim for k in (axis if isinstance(axis, tuple) else (axis,)))
    kept = [k for k in range(entries.ndim) if k not in axes]
    rows = entries.transpose([*kept, *axes]).reshape(*[entries.shape[k] for k in kept], -1)
    out = np.empty(rows.shape[:-1], dtype=object)
    for index in np.ndindex(out.shape):
        total = start
        for e in rows[index]:
            total = e if total is None else combine(total, e)
        out[index] = total
    if keepdims:
        out = out.reshape([1 if k in axes else n for k, n in enumerate(entries.shape)])
    return Traced(tape, out)


def _numbers(tape: Tape, a: Any) -> Traced:
    """Truth values as 0 and 1."""
    made = Traced(tape, a)
    return _each(tape, tape.number, made) if any(e.boolean for e in made.entries.flat) else made


def _sum(tape: Tape, a: Any, axis: Any = None, where: Any = True, **options: Any) -> Traced:
    known = {k: v for k, v in options.items() if k in ("keepdims", "initial")}
    return Traced(tape, np.sum(_numbers(tape, _where(tape, where, a, 0.0)).entries, axis=axis, **known))


def _extremum(least: bool) -> Callable[..., Traced]:
    def found(
        tape: Tape, a: Any, axis: Any = None, out: Any = None, keepdims: Any = False, initial: Any = None,
        where: Any = True,
    ) -> Traced:  # fmt: skip
        start = None if initial is None or not np.isscalar(initial) else tape.of(initial)
        a = _numbers(tape, a) if start is None else _where(tape, where, _numbers(tape, a), start)
        return _reduced(tape, lambda x, y: tape.largest(x, y, least=least), a, axis, keepdims is True, start)

    return found


def _all(tape: Tape, a: Any, axis: Any = None, out: Any = None, keepdims: Any = False, where: Any = True) -> Traced:
    return _reduced(tape, tape.both, _where(tape, where, a, tape.true), axis, keepdims is True, tape.true)


def _any(tape: Tape, a: Any, axis: Any = None, out: Any = None, keepdims: Any = False, where: Any = True) -> Traced:
    return _reduced(tape, tape.either, _where(tape, where, a, tape.false), axis, keepdims is True, tape.false)


def _where(tape: Tape, condition: Any, x: Any = None, y: Any = None) -> Traced:
    if x is None:
        raise TraceError("np.where(condition) gives indices, which depend on values")
    return _each(tape, tape.select, condition, x, y)


def _clip(tape: Tape, a: Any, a_min: Any = None, a_max: Any = None, **options: Any) -> Any:
    low, high = options.get("min", a_min), options.get("max", a_max)
    made = a if low is None else np.maximum(a, low)
    return made if high is None else np.minimum(made, high)


def _without_nan(tape: Tape, a: Any, copy: bool = True, nan: Any = 0.0, posinf: Any = None, neginf: Any = None) -> Any:
    largest = float(np.finfo(np.float64).max)
    high, low = largest if posinf is None else posinf, -largest if neginf is None else neginf
    return np.where(np.isnan(a), nan, np.where(a == np.inf, high, np.where(a == -np.inf, low, a)))


def _norm(tape: Tape, x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    axes = np.ndim(x) if axis is None else np.size(axis)
    if not (ord is None or (ord == 2 and axes == 1) or (ord == "fro" and axes == 2)):
        raise TraceError(f"np.linalg.norm with ord={ord!r} cannot be compiled")
    return np.sqrt(np.sum(x * x, axis=axis, keepdims=keepdims))


def _solve(tape: Tape, a: Any, b: Any) -> Traced:
    """Elimination with partial pivoting, the rows exchanged by selection."""
    a, b = _objects(tape, a), _objects(tape, b)
    vector = b.ndim == 1
    b = b[..., None] if vector else b
    lead = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    a, b = np.broadcast_to(a, (*lead, *a.shape[-2:])), np.broadcast_to(b, (*lead, *b.shape[-2:]))
    out = np.empty(b.shape, dtype=object)
    for index in np.ndindex(*lead):
        out[index] = solve_linear(tape, a[index].copy(), b[index].copy())
    return Traced(tape, out[..., 0] if vector else out)


def _inverse(tape: Tape, a: Any) -> Traced:
    return _solve(tape, a, np.broadcast_to(np.eye(np.shape(a)[-1]), np.shape(a)))


def _blank(fill: float) -> Callable[..., Traced]:
    def make(tape: Tape, a: Any, dtype: Any = None, order: str = "K", subok: bool = True, shape: Any = None) -> Traced:
        return Traced(tape, np.full(np.shape(a) if shape is None else shape, fill))

    return make


SPECIAL: dict[str, Callable[..., Any]] = {
    "max": _extremum(False), "amax": _extremum(False), "min": _extremum(True), "amin": _extremum(True),
    "all": _all, "any": _any, "where": _where, "sum": _sum, "clip": _clip, "linalg.norm": _norm, "linalg.solve": _solve,
    "linalg.inv": _inverse, "zeros_like": _blank(0.0), "ones_like": _blank(1.0), "empty_like": _blank(0.0),
    "full_like": lambda tape, a, fill_value, **_: Traced(tape, np.full(np.shape(a), 1.0)) * fill_value,
    "shape": lambda tape, a: a.shape, "ndim": lambda tape, a: a.ndim,
    "size": lambda tape, a, axis=None: a.size if axis is None else a.shape[axis],
    "result_type": lambda tape, *arrays: np.dtype(np.float64),
    "real": lambda tape, a: a, "nan_to_num": _without_nan,
    "array_equal": lambda tape, a, b: np.all(a == b), "iscomplexobj": lambda tape, a: False,
}  # fmt: skip
