"""Numpy's functions, methods and ufuncs for Jets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial, reduce
from importlib import import_module
from math import factorial
from numbers import Rational
from operator import matmul
from typing import Any, Never, TypeAlias

import flint
import numpy as np
import numpy.typing as npt
from numpy.typing import DTypeLike

from liehom.base.errors import SeriesError
from liehom.base.typing import Values
from liehom.flow.series import node as recurrences
from liehom.flow.series.arrays import across_lanes, constant_like, elementary, is_jax, is_lazy, namespace, solve, zeros
from liehom.flow.series.jet import HOOKS, WITHOUT_SERIES, Jet, Operand, as_jet, frozen, holds_jets, nodes
from liehom.flow.series.node import FUNCTIONS, Node
from liehom.flow.tracing.sweeps import CHAINED, SLOPES

# Numpy's ufuncs (arithmetic and elementary functions) for Jets; those that are in no table raise `SeriesError`.

# ufuncs that are linear
LINEAR_UFUNCS = ["conjugate", "deg2rad", "radians", "rad2deg", "degrees"]
# ufuncs that multiply arrays as a whole
PRODUCTS = ["matmul", "vecdot", "matvec", "vecmat"]


def apply_ufunc(ufunc: np.ufunc, method: str, inputs: tuple[Operand, ...], options: dict[str, Any]) -> Any:
    """The result of a numpy ufunc with Jets among its inputs."""
    name = ufunc.__name__
    out = options.pop("out", None)
    options = {key: value for key, value in options.items() if value is not None}
    if out is not None:
        return _in_place(ufunc, method, inputs, options, out)
    if getattr(np, name, None) is not ufunc:
        raise refused(name)
    if method == "reduce" and name in ("add", "multiply") and options.keys() <= {"axis", "keepdims"}:
        return (np.sum if name == "add" else np.prod)(*inputs, **{"axis": 0, **options})
    if method != "__call__" or options:
        with_options = " with" + "".join(f" {key}=" for key in options) if options else ""
        raise refused(f"np.{name}" + (f".{method}" if method != "__call__" else "") + with_options)
    if name in FUNCTIONS:
        return fresh(FUNCTIONS[name](inputs[0].node))
    if name == "positive":
        return inputs[0].copy()
    if name in ("add", "subtract"):
        left, right = nodes(*inputs)
        return fresh(recurrences.add(left, right, 1 if name == "add" else -1))
    if name in PRODUCTS:
        return _product(ufunc, *inputs)
    if name in LINEAR_UFUNCS:
        return fresh(recurrences.linear(lambda x: jax_counterpart(ufunc, x)(x), [inputs[0].node]))
    if name in OPERATORS:
        return fresh(OPERATORS[name](*inputs))
    raise refused(f"np.{name}")


def _in_place(
    ufunc: np.ufunc, method: str, inputs: tuple[Operand, ...], options: dict[str, Any], out: tuple[Any, ...]
) -> Any:
    """The result of x += y, which replaces the entries of a Jet x; for a number, the Jet x + y."""
    target = out[0]
    if not isinstance(target, Jet) or len(out) != 1:
        raise SeriesError(f"np.{ufunc.__name__} cannot write a series into an array: use x = x + y in place of x += y")
    result = apply_ufunc(ufunc, method, inputs, options)
    if not target.shape and not target.shares() and inputs and inputs[0] is target:
        return result
    if result.shape != target.shape:
        raise SeriesError(f"a series of shape {result.shape} does not fit into one of shape {target.shape}")
    target[...] = result
    return target


def refused(name: str) -> SeriesError:
    """The `SeriesError` for a function without a Taylor recurrence."""
    return SeriesError(
        f"{name} has no Taylor recurrence here (it branches on values, or is not known): write the generator with "
        "arithmetic, sqrt exp log sin cos tan sinh cosh tanh arctan and linear algebra, or as sympy expressions; "
        f"{WITHOUT_SERIES}"
    )


def fresh(node: Node) -> Jet:
    """New Jet of a node; its entries may be assigned unless it is a number."""
    return Jet.from_node(node, writable=bool(np.ndim(node.value)))


def jax_counterpart(function: Callable[..., Any], *values: object) -> Callable[..., Any]:
    """The function of jax.numpy with the same name if a value is a JAX array, else the function itself."""
    if not any(is_jax(v) for v in values):
        return function
    xp = namespace(*values)
    home = xp.linalg if "linalg" in (getattr(function, "__module__", "") or "") else xp
    return getattr(home, function.__name__)


def _product(ufunc: np.ufunc, x: Operand, y: Operand) -> Jet:
    """Jet of matmul, vecdot, matvec or vecmat; a constant right factor may be a sparse matrix."""
    if hasattr(y, "tocsr"):
        if ufunc is not np.matmul:
            raise refused(f"np.{ufunc.__name__} with a sparse matrix")
        return fresh(recurrences.linear(lambda a: a @ y, [x.node]))
    return bilinear(ufunc, x, y)


def bilinear(function: Callable[..., Any], x: Operand, y: Operand, **options: object) -> Jet:
    """Jet of function(x, y), linear in each argument; one or both are Jets."""
    factors = nodes(x, y)
    shared = function is np.matmul and not options and len(np.shape(factors[1].value)) == 2

    def at(a: Values, b: Values) -> Values:
        if shared and type(b) is np.ndarray:
            return across_lanes(a, b)
        return jax_counterpart(function, a, b)(a, b, **options)

    return fresh(recurrences.multilinear(at, factors))


def _divide(x: Operand, y: Operand) -> Node:
    if not holds_jets(y):
        divisor = constant_like(x.value, y)
        return recurrences.linear(lambda a: a / divisor, [x.node])
    return recurrences.quotient(*nodes(x, y))


def _power(x: Operand, y: Operand) -> Node:
    if holds_jets(y):
        base, exponent = nodes(x, y)
        return FUNCTIONS["exp"](recurrences.product(FUNCTIONS["log"](base), exponent))
    if np.ndim(y):
        return _powers(x, np.asarray(y)).node
    y = y[()] if isinstance(y, np.ndarray) else y
    if isinstance(y, flint.fmpq):
        y = Fraction(int(y.p), int(y.q))
    if isinstance(y, int | np.integer | float | np.floating | Rational) and float(y).is_integer():
        n = round(float(y))
        power = recurrences.integer_power(x.node, abs(n))
        return power if n >= 0 else FUNCTIONS["reciprocal"](power)
    if not isinstance(y, complex | np.complexfloating) and (isinstance(y, Rational) or x.dtype == object):
        y = Fraction(y)
    return FUNCTIONS["sqrt"](x.node) if y == 0.5 else recurrences.real_power(x.node, y)


def _powers(x: Jet, exponents: npt.NDArray[Any]) -> Jet:
    """x ** exponents for an array of exponents; entries with the same exponent are computed together."""
    shape = np.broadcast_shapes(x.shape, exponents.shape)
    base: Any = np.broadcast_to(x, shape)
    powers, places = base.copy(), np.broadcast_to(exponents, shape)
    for exponent in dict.fromkeys(exponents.flat):
        if exponent != 1:
            powers[places == exponent] = base[places == exponent] ** exponent
    return powers


def _arctan2(y: Operand, x: Operand) -> Node:
    """Node of the angle of (x, y)."""
    above, right = (Jet.from_node(node) for node in nodes(y, x))
    if object in (above.dtype, right.dtype):
        raise refused("np.arctan2 of exact numbers")
    value = namespace(above.value, right.value).arctan2(above.value, right.value)
    sine, cosine = elementary("sin", value), elementary("cos", value)
    # the angle relative to its value at 0 is small, so arctan gives the right branch
    turned = right * cosine + above * sine
    across = above * cosine - right * sine
    return recurrences.add(np.arctan(across / turned).node, recurrences.constant(value, above.order))


def _hypot(x: Operand, y: Operand) -> Node:
    a, b = nodes(x, y)
    return FUNCTIONS["sqrt"](recurrences.add(recurrences.product(a, a), recurrences.product(b, b)))


def _logaddexp(x: Operand, y: Operand) -> Node:
    a, b = (Jet.from_node(node) for node in nodes(x, y))
    larger = namespace(a.value, b.value).maximum(a.value, b.value)  # a constant shift, against overflow
    return (larger + np.log(np.exp(a - larger) + np.exp(b - larger))).node


def _chained(name: str, u: Node) -> Node:
    """Node of the function of a name, by its slope."""
    x = Jet.from_node(u)
    return recurrences.chain(u, elementary(name, u.value), lambda f: SLOPES[name](x, Jet.from_node(f)).node)


FUNCTIONS.update({name: partial(_chained, name) for name in CHAINED})
OPERATORS: dict[str, Callable[..., Node]] = {
    "multiply": lambda x, y: recurrences.product(*nodes(x, y)), "divide": _divide, "power": _power,
    "float_power": _power, "arctan2": _arctan2, "hypot": _hypot, "logaddexp": _logaddexp,
}  # fmt: skip

# Numpy's functions of arrays, and the methods of arrays, for Jets: linear in the first argument, bilinear, linear in a
# list of arrays, with a list of parts as result, or special. Functions that are in no table, and options that would add
# something, such as ``initial=``, raise `SeriesError`.

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
LIMITS = LINEAR | VIEWS
OPTIONS = {
    "axis", "axes", "keepdims", "shape", "newshape", "order", "offset", "axis1", "axis2", "k", "n", "shift", "source",
    "destination", "indices", "reps", "repeats", "weights", "where", "subok", "obj", "start", "condition", "x", "dx",
    "mode", "copy", "indices_or_sections", "edge_order",
}  # fmt: skip
BILINEAR = ["dot", "tensordot", "cross", "inner", "outer", "vdot", "kron", "convolve", "correlate", "vecdot", "matmul"]
JOINED = ["stack", "concatenate", "concat", "hstack", "vstack", "dstack", "column_stack"]
PARTED = ["split", "array_split", "hsplit", "vsplit", "dsplit", "unstack"]


def apply_function(
    function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]
) -> Jet | list[Jet] | Any:
    """The result of a numpy function with Jets among its arguments."""
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
    if home is np and name in LIMITS:
        return _linear(function, args, options)
    if name in PARTED:
        return _parted(function, args, options)
    raise refused(f"np.{full}")


def method(jet: Jet, name: str) -> Callable[..., Any]:
    """The method of arrays with this name, for a Jet."""
    if name in FUNCTIONS or name in ("arctan2", "hypot", "logaddexp"):
        return partial(getattr(np, name), jet)
    if name in EXTRA_METHODS:
        return partial(EXTRA_METHODS[name], jet)
    if callable(getattr(np.ndarray, name, None)) and not name.startswith("_"):
        return partial(_method if hasattr(np, name) else _refuse, jet, name)
    raise AttributeError(f"a series has no attribute {name!r}")


def _method(jet: Jet, name: str, *args: object, **options: object) -> Any:
    if name in ("reshape", "transpose") and len(args) > 1:
        args = (args,)
    return getattr(np, name)(jet, *args, **options)


def _refuse(jet: Jet, name: str, *args: object, **options: object) -> Never:
    raise refused(f"the method {name}")


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
        jets = [key for key, value in options.items() if holds_jets(value)]
        options = dict(options)
        args = tuple(options.pop(key) for key in jets[:1])
    first, rest = args[0], args[1:]
    limit = LIMITS[name]
    if not holds_jets(first) or any(map(holds_jets, (*rest, *options.values()))):
        raise refused(f"np.{name} with a series as an option")
    first = as_jet(first)
    odd = [key for key, value in options.items() if key not in OPTIONS and value is not None]
    if odd or len(args) > limit:
        raise refused(f"np.{name} with {', '.join(odd) or f'more than {limit} positional arguments'}")
    rest, options = frozen(tuple(rest)), {key: frozen(value) for key, value in options.items() if value is not None}

    def applied(x: Values) -> Values:
        return jax_counterpart(function, x)(x, *rest, **options)

    return first.part(applied) if name in VIEWS else fresh(recurrences.linear(applied, [first.node]))


def _bilinear(function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]) -> Jet:
    """Jet of a function that is linear in each of its first two arguments; a constant one may be an option."""
    options = dict(options)
    if function.__name__ in ("dot", "cross", "tensordot", "inner", "outer"):
        args = (*args, *[options.pop(key) for key in ("a", "b")[len(args) :] if key in options])
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
        return jax_counterpart(function, *parts)(list(parts), *args[1:], **options)

    return fresh(recurrences.linear(joined, nodes(*members)))


def _parted(function: Callable[..., Any], args: tuple[Operand, ...], options: dict[str, Any]) -> list[Jet]:
    """List of Jets, the parts into which a function cuts an array."""
    first, rest = args[0], frozen(args[1:])
    if not isinstance(first, Jet) or holds_jets(rest):
        raise refused(f"np.{function.__name__} with a series as an option")

    def part(i: int, x: Values) -> Values:
        return jax_counterpart(function, x)(x, *rest, **options)[i]

    count = len(jax_counterpart(function, first.value)(first.value, *rest, **options))
    return [first.part(partial(part, i)) for i in range(count)]


# -- special functions ---------------------------------------------------------------------------------------
def _einsum(*args: Operand, **options: object) -> Jet:
    subscripts, factors = args[0], args[1:]
    if not isinstance(subscripts, str):
        raise refused("np.einsum without a string of subscripts")
    if options.get("out") is not None:
        raise refused("np.einsum with out=")
    series = nodes(*factors)
    # the convolution is over the factors that are Jets
    places = [i for i, factor in enumerate(factors) if holds_jets(factor)]
    constants = [node.value for node in series]

    def contract(*values: Values) -> Values:
        filled = list(constants)
        for i, value in zip(places, values, strict=True):
            filled[i] = value
        return jax_counterpart(np.einsum, *filled)(subscripts, *filled, **options)

    return fresh(recurrences.multilinear(contract, [series[i] for i in places]))


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
    return np.concatenate([np.ravel(arr), np.ravel(values)] if axis is None else [arr, values], axis=axis or 0)


def _norm(x: Jet, ord: float | str | None = None, axis: Axis = None, keepdims: bool = False) -> Jet:
    axes = x.ndim if axis is None else np.size(axis)
    if not (ord is None or (ord == 2 and axes == 1) or (ord == "fro" and axes == 2)):
        raise refused(f"np.linalg.norm with ord={ord!r}")
    square = x * np.conjugate(x) if x.dtype.kind == "c" else x * x
    total = np.sum(square, axis=axis, keepdims=keepdims)
    return np.sqrt(total.real if x.dtype.kind == "c" else total)


def _solve(a: Operand, b: Operand) -> Jet:
    """The solution of a x = b; b is a vector if it has one axis, as in numpy."""
    left, right = (Jet.from_node(node) for node in nodes(a, b))
    vector = right.ndim == 1
    columns = right[..., None] if vector else right
    solutions = fresh(recurrences.solution(columns.node, left.node, matmul, lambda y, x: solve(x, y)))
    return solutions[..., 0] if vector else solutions


def _inverse(a: Jet) -> Jet:
    return _solve(a, Jet.constant(recurrences.identities(a.value), a.order))


def _matrix_power(a: Jet, n: int) -> Jet:
    if n < 0:
        return _matrix_power(_inverse(a), -n)
    power = Jet.constant(recurrences.identities(a.value), a.order)
    for bit in bin(n)[2:]:
        power = power @ power
        power = power @ a if bit == "1" else power
    return power


def _determinant(a: Jet) -> Operand:
    """Determinant of matrices (..., n, n), by the recursion for the characteristic polynomial."""
    n, one = a.shape[-1], recurrences.identities(a.value)
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
    total = first[0] if len(first) else Jet.constant(zeros(a.value, first.shape[1:]) + 1, a.order)
    if keepdims:
        return total.reshape((1,) * a.ndim) if axis is None else np.expand_dims(total, axis)
    return total


def _polyval(p: Operand, x: Operand) -> Jet:
    total: Any = 0 * x
    for coefficient in p:
        total = total * x + coefficient
    return total


def _blank(fill: int) -> Callable[..., Jet]:
    def make(
        a: Jet, dtype: DTypeLike | None = None, order: str = "K", subok: bool = True,
        shape: int | Sequence[int] | None = None, **options: object,
    ) -> Jet:  # fmt: skip
        size = a.shape if shape is None else tuple(int(n) for n in np.atleast_1d(shape))
        value = zeros(a.value, size) if dtype is None else np.zeros(size, dtype=dtype)
        if value.dtype.kind not in "fcO":
            raise SeriesError(f"an array of type {value.dtype} cannot hold a series")
        return Jet.from_node(recurrences.constant(value + fill if fill else value, a.order), writable=True)

    return make


def _full_like(a: Operand, fill_value: Operand, dtype: DTypeLike | None = None, **options: object) -> Jet:
    full = _blank(0)(a if isinstance(a, Jet) else Jet.constant(a, fill_value.order), dtype, **options)
    full[...] = fill_value
    return full


def _where(condition: Operand, x: Operand = None, y: Operand = None) -> Jet:
    if holds_jets(condition):
        raise refused("np.where with a condition on a series")
    mask = condition if is_lazy(condition) else np.array(condition)
    return fresh(recurrences.linear(lambda a, b: namespace(mask, a, b).where(mask, a, b), nodes(x, y)))


def _broadcast_arrays(*args: Operand, subok: bool = False) -> tuple[Any, ...]:
    shape = np.broadcast_shapes(*[np.shape(a) for a in args])
    return tuple(np.broadcast_to(a, shape) for a in args)


EXTRA_METHODS: dict[str, Callable[..., Any]] = {
    "astype": _astype, "flatten": lambda jet: jet.reshape(-1).copy(), "tolist": _listed,
}  # fmt: skip
SPECIAL: dict[str, Callable[..., Any]] = {
    "einsum": _einsum, "block": _block, "append": _append, "prod": _prod, "polyval": _polyval, "where": _where,
    "broadcast_arrays": _broadcast_arrays, "linalg.norm": _norm, "linalg.solve": _solve, "linalg.inv": _inverse,
    "linalg.det": _determinant, "linalg.matrix_power": _matrix_power,
    "linalg.vector_norm": lambda x, axis=None, keepdims=False: _norm(
        x if axis is not None else x.reshape(-1), None, axis, keepdims
    ),
    "linalg.trace": lambda x, offset=0: np.trace(x, offset, -2, -1),
    "linalg.diagonal": lambda x, offset=0: np.diagonal(x, offset, -2, -1),
    "linalg.matrix_transpose": lambda x: np.swapaxes(x, -1, -2),
    "linalg.multi_dot": lambda arrays: reduce(np.dot, arrays),
    "zeros_like": _blank(0), "empty_like": _blank(0), "ones_like": _blank(1), "full_like": _full_like,
    "copy": lambda a, order="K", subok=False: a.copy(), "shape": lambda a: a.shape, "ndim": lambda a: a.ndim,
    "size": lambda a, axis=None: a.size if axis is None else a.shape[axis],
    "iscomplexobj": lambda x: x.dtype.kind == "c", "isrealobj": lambda x: x.dtype.kind != "c",
    "result_type": lambda *args: np.result_type(*[a.dtype if isinstance(a, Jet) else a for a in args]),
}  # fmt: skip

HOOKS.update(ufunc=apply_ufunc, function=apply_function, method=method)


# Series of functions that are written for JAX arrays, which do not run on Jets, by the Taylor mode of JAX.


def expanded_by_jax(function: Callable[..., Values], *operands: Jet | Values) -> Jet:
    """The Jet of function(a, b, ...) for Jets, or arrays, whose values are JAX arrays, in O(n^3) operations."""
    jet: Any = import_module("jax.experimental.jet")
    jnp = import_module("jax.numpy")
    nodes = [x.node for x in operands if isinstance(x, Jet)]

    def of_jets(*values: Values) -> Values:
        rest = iter(values)
        return function(*[next(rest) if isinstance(x, Jet) else x for x in operands])

    values = tuple(jnp.asarray(node.value) for node in nodes)

    def rule(k: int) -> Values:
        series = tuple(
            [jnp.zeros_like(v) if c is None else factorial(i) * jnp.broadcast_to(c, v.shape) for i, c in terms]
            for v, terms in ((v, list(enumerate(n.known[1 : k + 1], 1))) for v, n in zip(values, nodes, strict=True))
        )
        return jet.jet(of_jets, values, series)[1][k - 1] / factorial(k)

    value, order = of_jets(*values), min(node.order for node in nodes)
    return Jet.from_node(Node(order, value, [value], tuple((node, 0) for node in nodes), rule))
