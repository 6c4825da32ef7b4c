"""Numpy's functions of arrays, and the methods of arrays, for Jets.

Each function in the tables is linear in its first argument, bilinear, linear in a list of arrays, one that returns a
list of parts, or special.  Functions that are in no table, and options that would add something, such as
``initial=``, raise `SeriesError`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Never, TypeAlias

import numpy as np
import numpy.typing as npt
from numpy.typing import DTypeLike

from liehom.errors import SeriesError
from liehom.series import recurrences
from liehom.series.arrays import is_lazy, namespace, solve, zeros
from liehom.series.assembly import as_jet, holds_jets, nodes
from liehom.series.jet import Jet
from liehom.series.jet_dispatch import Operand, dispatch
from liehom.series.jet_ufuncs import bilinear, fresh, jax_counterpart, refused
from liehom.series.jet_views import frozen
from liehom.typing import Values

Axis: TypeAlias = int | tuple[int, ...] | None

# name -> number of positional arguments that are supported, the array included
LINEAR: dict[str, int] = {
    "roll": 3, "cumsum": 2, "diff": 3, "take": 3, "take_along_axis": 3, "delete": 3, "tile": 2, "repeat": 3, "sum": 2,
    "mean": 2, "average": 2, "trace": 4, "tril": 2, "triu": 2, "ediff1d": 1, "trapezoid": 4, "cumulative_sum": 1,
}  # fmt: skip
# linear, and a view of the array
VIEWS: dict[str, int] = {
    "reshape": 2, "transpose": 2, "swapaxes": 3, "moveaxis": 3, "rollaxis": 3, "expand_dims": 2, "squeeze": 2,
    "broadcast_to": 2, "flip": 2, "ravel": 1, "diagonal": 4, "rot90": 3, "fliplr": 1, "flipud": 1, "real": 1, "imag": 1,
    "diag": 2, "atleast_1d": 1, "atleast_2d": 1, "atleast_3d": 1, "permute_dims": 2, "matrix_transpose": 1,
}  # fmt: skip
OPTIONS = {
    "axis", "axes", "keepdims", "shape", "newshape", "order", "offset", "axis1", "axis2", "k", "n", "shift", "source",
    "destination", "indices", "reps", "repeats", "weights", "where", "subok", "obj", "start", "condition", "x", "dx",
    "mode", "copy", "indices_or_sections", "edge_order",
}  # fmt: skip
BILINEAR = ["dot", "tensordot", "cross", "inner", "outer", "vdot", "kron", "convolve", "correlate", "vecdot", "matmul"]
JOINED = ["stack", "concatenate", "concat", "hstack", "vstack", "dstack", "column_stack"]
PARTED = ["split", "array_split", "hsplit", "vsplit", "dsplit", "unstack"]
# methods of arrays that are numpy functions of the same name
METHODS = [
    "conj", "conjugate", "cumsum", "diagonal", "dot", "mean", "prod", "ravel", "repeat", "reshape", "squeeze", "sum",
    "swapaxes", "take", "trace", "transpose",
]  # fmt: skip
REFUSED_METHODS = [
    "all", "any", "argmax", "argmin", "argpartition", "argsort", "choose", "clip", "compress", "cumprod", "item", "max",
    "min", "nonzero", "partition", "ptp", "put", "resize", "round", "searchsorted", "sort", "std", "var", "fill",
    "tobytes", "tofile", "view", "byteswap",
]  # fmt: skip


def apply_function(
    function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]
) -> Jet | list[Jet] | Any:
    """The result of a numpy function with Jets among its arguments.

    Raises
    ------
    SeriesError
        If it has no Taylor recurrence, or an option has none.

    Examples
    --------
    >>> apply_function(np.sum, (Jet([[1.0, 2.0]]),), {"axis": 0}).value
    np.float64(3.0)
    """
    name = function.__name__
    home = np.linalg if "linalg" in (function.__module__ or "") else np
    full = f"linalg.{name}" if home is np.linalg else name
    if getattr(home, name, None) is not function:
        raise refused(f"{function.__module__}.{name}")
    if full in SPECIAL:
        return SPECIAL[full](*args, **options)
    if name in JOINED:
        return _joined(function, args, options)
    if name in BILINEAR:
        return _bilinear(function, args, options)
    if home is np and (name in LINEAR or name in VIEWS):
        return _linear(function, args, options)
    if name in PARTED:
        return _parted(function, args, options)
    raise refused(f"np.{full}")


def method(jet: Jet, name: str) -> Callable[..., Any]:
    """The method of arrays with this name, for a Jet."""
    if name in recurrences.FUNCTIONS or name in ("arctan2", "hypot", "logaddexp"):
        return partial(getattr(np, name), jet)
    if name in METHODS:
        return partial(_method, jet, name)
    if name in EXTRA_METHODS:
        return partial(EXTRA_METHODS[name], jet)
    if name in REFUSED_METHODS:
        return partial(_refuse, f"the method {name}")
    raise AttributeError(f"a series has no attribute {name!r}")


def _method(jet: Jet, name: str, *args: object, **options: object) -> Any:
    if name in ("reshape", "transpose") and len(args) > 1:
        args = (args,)
    elif name == "transpose" and args == (None,):
        args = ()
    return getattr(np, name)(jet, *args, **options)


def _refuse(name: str, *args: object, **options: object) -> Never:
    raise refused(name)


def _astype(jet: Jet, dtype: DTypeLike | None, **options: object) -> Jet:
    if np.dtype(dtype).kind not in "fcO":
        raise refused(f"astype({dtype!r})")
    if np.dtype(dtype).kind == "f" and jet.dtype.kind == "c":
        raise SeriesError("astype(float) would drop the imaginary part: take .real")
    return fresh(
        recurrences.linear(lambda x: np.asarray(x).astype(dtype) if np.isscalar(x) else x.astype(dtype), [jet.node])
    )


def _listed(jet: Jet) -> Any:
    return [_listed(entry) for entry in jet] if jet.ndim else jet


# -- the kinds of functions --------------------------------------------------------------------------------
def _linear(function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]) -> Jet:
    """Jet of a function that is linear in its first argument."""
    name = function.__name__
    if not args:
        found = [key for key, value in options.items() if holds_jets(value)]
        options = dict(options)
        args = tuple(options.pop(key) for key in found[:1])
    first, rest = args[0], args[1:]
    limit = LINEAR[name] if name in LINEAR else VIEWS[name]
    if not isinstance(first, Jet):
        if not holds_jets(first):
            raise refused(f"np.{name} with a series as an option")
        first = as_jet(first)
    if any(holds_jets(x) for x in (*rest, *options.values())):
        raise refused(f"np.{name} with a series as an option")
    odd = [key for key, value in options.items() if key not in OPTIONS and value is not None]
    if odd or len(args) > limit:
        raise refused(f"np.{name} with {', '.join(odd) or f'more than {limit} positional arguments'}")
    rest, options = frozen(tuple(rest)), {key: frozen(value) for key, value in options.items() if value is not None}

    def applied(x: Values) -> Values:
        found: Values = jax_counterpart(function, x)(x, *rest, **options)
        return found

    if name in VIEWS:
        return first.part(applied)
    return fresh(recurrences.linear(applied, [first.node]))


def _bilinear(function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]) -> Jet:
    """Jet of a function that is linear in each of its first two arguments; a constant one may be an option."""
    names = {"dot": ("a", "b"), "cross": ("a", "b"), "tensordot": ("a", "b"), "inner": ("a", "b"), "outer": ("a", "b")}
    options = dict(options)
    for key in names.get(function.__name__, ())[len(args) :]:
        if key in options:
            args = (*args, options.pop(key))
    if len(args) < 2 or options.get("out") is not None:
        raise refused(f"np.{function.__name__} with these arguments")
    rest = {key: frozen(value) for key, value in options.items() if value is not None}
    if len(args) > 2:
        third = {"tensordot": "axes", "convolve": "mode", "correlate": "mode", "cross": "axisa"}.get(function.__name__)
        if third is None or len(args) > 3:
            raise refused(f"np.{function.__name__} with these positional arguments")
        rest[third] = frozen(args[2])
    return bilinear(function, args[0], args[1], **rest)


def _joined(function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]) -> Jet:
    """Jet of a function of a sequence of arrays that is jointly linear in them."""
    options = {key: value for key, value in options.items() if value is not None}
    members = options.pop("arrays", None) or options.pop("tup", None) or args[0]
    if "out" in options or "dtype" in options or len(args) > 2:
        raise refused(f"np.{function.__name__} with out= or dtype=")

    last = function is np.stack and not args[1:] and options == {"axis": -1}

    def joined(*parts: Values) -> Values:
        if last and all(type(x) is np.ndarray and x.ndim for x in parts):
            return np.moveaxis(np.stack(parts), 0, -1)  # in the layout of `in_lanes`
        found: Values = jax_counterpart(function, *parts)(list(parts), *args[1:], **options)
        return found

    return fresh(recurrences.linear(joined, nodes(*members)))


def _parted(function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]) -> list[Jet]:
    """List of Jets, the parts into which a function cuts an array."""
    first, rest = args[0], frozen(args[1:])
    if not isinstance(first, Jet) or holds_jets(rest):
        raise refused(f"np.{function.__name__} with a series as an option")

    def part(i: int, x: Values) -> Values:
        found: Values = jax_counterpart(function, x)(x, *rest, **options)[i]
        return found

    count = len(jax_counterpart(function, first.value)(first.value, *rest, **options))
    return [first.part(partial(part, i)) for i in range(count)]


# -- special functions ---------------------------------------------------------------------------------------
def _einsum(*args: Operand, **options: object) -> Jet:
    subscripts, factors = args[0], args[1:]
    if not isinstance(subscripts, str):
        raise refused("np.einsum without a string of subscripts")
    if options.get("out") is not None:
        raise refused("np.einsum with out=")
    made = nodes(*factors)
    # the convolution is over the factors that are Jets
    places = [i for i, factor in enumerate(factors) if holds_jets(factor)]
    constants = [node.value for node in made]

    def contract(*values: Values) -> Values:
        filled = list(constants)
        for i, value in zip(places, values, strict=True):
            filled[i] = value
        found: Values = jax_counterpart(np.einsum, *filled)(subscripts, *filled, **options)
        return found

    return fresh(recurrences.multilinear(contract, [made[i] for i in places]))


def _block(arrays: Sequence[Operand]) -> Any:
    """Nested lists of arrays: rebuilt from the list of all of them."""
    members: list[Any] = []

    def places(x: Operand) -> Any:
        if isinstance(x, list):
            return [places(entry) for entry in x]
        members.append(x)
        return len(members) - 1

    def filled(x: Operand, parts: Sequence[Values]) -> Any:
        return [filled(entry, parts) for entry in x] if isinstance(x, list) else parts[x]

    shape = places(arrays)
    return fresh(
        recurrences.linear(lambda *parts: jax_counterpart(np.block, *parts)(filled(shape, parts)), nodes(*members))
    )


def _append(arr: Operand, values: Operand, axis: int | None = None) -> Operand:
    if axis is None:
        return np.concatenate([np.ravel(part) for part in (arr, values)])
    return np.concatenate([arr, values], axis=axis)


def _norm(x: Jet, ord: float | str | None = None, axis: Axis = None, keepdims: bool = False) -> Jet:
    axes = x.ndim if axis is None else np.size(axis)
    known = ord is None or (ord == 2 and axes == 1) or (ord == "fro" and axes == 2)
    if not known:
        raise refused(f"np.linalg.norm with ord={ord!r}")
    square = x * np.conjugate(x) if x.dtype.kind == "c" else x * x
    total = np.sum(square, axis=axis, keepdims=keepdims)
    found: Jet = np.sqrt(total.real if x.dtype.kind == "c" else total)
    return found


def _solve(a: Operand, b: Operand) -> Jet:
    """The solution of a x = b; b is a vector if it has one axis, as in numpy."""
    left, right = (Jet.from_node(node) for node in nodes(a, b))
    vector = right.ndim == 1
    columns = right[..., None] if vector else right

    def divide(y: Values, x: Values) -> Values:
        return solve(x, y)

    made = fresh(recurrences.solution(columns.node, left.node, _matmul, divide))
    return made[..., 0] if vector else made


def _matmul(x: Values, y: Values) -> Values:
    return x @ y


def _identity(a: Jet) -> npt.NDArray[Any]:
    eye = np.eye(a.shape[-1], dtype=int)
    found: npt.NDArray[Any] = zeros(a.value, a.shape) + (
        eye.astype(object) if a.dtype == object else eye.astype(a.dtype)
    )
    return found


def _inverse(a: Jet) -> Jet:
    return _solve(a, Jet.constant(_identity(a), a.order))


def _matrix_power(a: Jet, n: int) -> Jet:
    if n < 0:
        return _matrix_power(_inverse(a), -n)
    made = Jet.constant(_identity(a), a.order)
    for bit in bin(n)[2:]:
        made = made @ made
        made = made @ a if bit == "1" else made
    return made


def _determinant(a: Jet) -> Operand:
    """Determinant of matrices (..., n, n), by the recursion for the characteristic polynomial."""
    n, one = a.shape[-1], _identity(a)
    power, coefficient = Jet.constant(zeros(a.value, a.shape), a.order), zeros(a.value, a.shape[:-2]) + 1
    for k in range(1, n + 1):
        power = a @ power + coefficient[..., None, None] * one
        coefficient = -np.trace(a @ power, axis1=-2, axis2=-1) / k
    return coefficient if n % 2 == 0 else -coefficient


def _prod(
    a: Jet, axis: Axis = None, dtype: DTypeLike | None = None, out: object = None, keepdims: bool = False
) -> Operand:
    """Product of the entries, by repeated halving."""
    if dtype is not None or out is not None or isinstance(axis, tuple):
        raise refused("np.prod with these options")
    array: Any = a
    first: Any = np.moveaxis(array.reshape(-1) if axis is None else array, 0 if axis is None else axis, 0)
    while len(first) > 1:
        half = len(first) // 2
        pairs = first[:half] * first[half : 2 * half]
        first = pairs if len(first) % 2 == 0 else np.concatenate([pairs, first[2 * half :]])
    made = first[0] if len(first) else Jet.constant(zeros(a.value, first.shape[1:]) + 1, a.order)
    if keepdims:
        return made.reshape((1,) * a.ndim) if axis is None else np.expand_dims(made, axis)
    return made


def _polyval(p: Operand, x: Operand) -> Jet:
    total: Any = 0 * x
    for coefficient in p:
        total = total * x + coefficient
    found: Jet = total
    return found


def _blank(fill: int) -> Callable[..., Jet]:
    def make(
        a: Jet,
        dtype: DTypeLike | None = None,
        order: str = "K",
        subok: bool = True,
        shape: int | Sequence[int] | None = None,
        **options: object,
    ) -> Jet:
        size = a.shape if shape is None else tuple(int(n) for n in np.atleast_1d(shape))
        value = zeros(a.value, size) if dtype is None else np.zeros(size, dtype=dtype)
        if value.dtype.kind not in "fcO":
            raise SeriesError(f"an array of type {value.dtype} cannot hold a series")
        return Jet.from_node(recurrences.constant(value + fill if fill else value, a.order), writable=True)

    return make


def _full_like(a: Operand, fill_value: Operand, dtype: DTypeLike | None = None, **options: object) -> Jet:
    made = _blank(0)(a if isinstance(a, Jet) else Jet.constant(a, fill_value.order), dtype, **options)
    made[...] = fill_value
    return made


def _where(condition: Operand, x: Operand = None, y: Operand = None) -> Jet:
    if holds_jets(condition):
        raise refused("np.where with a condition on a series")
    mask = condition if is_lazy(condition) else np.array(condition)
    return fresh(recurrences.linear(lambda a, b: namespace(mask, a, b).where(mask, a, b), nodes(x, y)))


def _dot_all(arrays: Sequence[Operand]) -> Jet:
    total, *others = arrays
    for a in others:
        total = np.dot(total, a)
    found: Jet = total
    return found


def _size(a: Jet, axis: int | None = None) -> int:
    return a.size if axis is None else a.shape[axis]


def _broadcast_arrays(*args: Operand, subok: bool = False) -> tuple[Any, ...]:
    shape = np.broadcast_shapes(*[np.shape(a) for a in args])
    return tuple(np.broadcast_to(a, shape) for a in args)


EXTRA_METHODS: dict[str, Callable[..., Any]] = {
    "astype": _astype,
    "flatten": lambda jet: jet.reshape(-1).copy(),
    "tolist": _listed,
}
SPECIAL: dict[str, Callable[..., Any]] = {
    "einsum": _einsum,
    "block": _block,
    "append": _append,
    "prod": _prod,
    "polyval": _polyval,
    "where": _where,
    "broadcast_arrays": _broadcast_arrays,
    "linalg.norm": _norm,
    "linalg.vector_norm": lambda x, axis=None, keepdims=False: _norm(
        x if axis is not None else x.reshape(-1), None, axis, keepdims
    ),
    "linalg.solve": _solve,
    "linalg.inv": _inverse,
    "linalg.det": _determinant,
    "linalg.matrix_power": _matrix_power,
    "linalg.trace": lambda x, offset=0: np.trace(x, offset, -2, -1),
    "linalg.diagonal": lambda x, offset=0: np.diagonal(x, offset, -2, -1),
    "linalg.matrix_transpose": lambda x: np.swapaxes(x, -1, -2),
    "linalg.multi_dot": _dot_all,
    "zeros_like": _blank(0),
    "empty_like": _blank(0),
    "ones_like": _blank(1),
    "full_like": _full_like,
    "copy": lambda a, order="K", subok=False: a.copy(),
    "shape": lambda a: a.shape,
    "ndim": lambda a: a.ndim,
    "size": _size,
    "iscomplexobj": lambda x: x.dtype.kind == "c",
    "isrealobj": lambda x: x.dtype.kind != "c",
    "result_type": lambda *args: np.result_type(*[a.dtype if isinstance(a, Jet) else a for a in args]),
}

dispatch.apply_function = apply_function
dispatch.method = method
