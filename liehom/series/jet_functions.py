"""What numpy functions do with Jets: one table of ufuncs, one of functions.

Entries are linear (in all arguments jointly), multilinear, or built from the recurrences.  Anything else is
refused by name.  Imports jet, recurrences, arrays, errors.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from liehom.errors import SeriesError
from liehom.series import recurrences
from liehom.series.arrays import as_values, is_jax, namespace, zeros
from liehom.series.jet import Jet
from liehom.series.node import Node

LINEAR = (
    "reshape transpose swapaxes moveaxis expand_dims squeeze broadcast_to roll flip cumsum diff take tile repeat ravel "
    "diagonal trace sum mean tril triu rot90 fliplr flipud real imag diag atleast_1d atleast_2d ediff1d average "
    "permute_dims matrix_transpose"
).split()
BILINEAR = "dot tensordot cross inner outer vdot kron convolve vecdot matvec vecmat".split()
JOINED = "stack concatenate concat hstack vstack dstack column_stack block".split()


def apply_ufunc(ufunc: Any, method: str, inputs: tuple[Any, ...], options: dict[str, Any]) -> Any:
    """What a numpy ufunc returns for Jets among its inputs."""
    name = ufunc.__name__
    if options.get("out") is not None:
        raise SeriesError(f"np.{name} cannot write a series into an array: use x = x + y in place of x += y")
    if method == "reduce" and name == "add":
        return _linear(np.sum, inputs, {"axis": options.get("axis", 0), "keepdims": options.get("keepdims", False)})
    if method != "__call__" or any(value is not None for key, value in options.items() if key != "axes"):
        raise SeriesError(f"np.{name}.{method} with options {sorted(options)} has no Taylor recurrence here")
    if name in recurrences.FUNCTIONS:
        return _jet(recurrences.FUNCTIONS[name](inputs[0].node))
    if name == "positive":
        return inputs[0]
    if name in ("add", "subtract"):
        left, right = nodes(*inputs)
        return _jet(recurrences.add(left, right, 1 if name == "add" else -1))
    if name in ("matmul", "vecdot", "matvec", "vecmat"):
        return _multilinear(ufunc, inputs, {})
    if name in OPERATORS:
        return _jet(OPERATORS[name](*inputs))
    raise refused(f"np.{name}")


def nodes(*values: Any) -> list[Node]:
    """The nodes of Jets and constants, at the lowest order among the Jets."""
    order = min(x.order for x in values if isinstance(x, Jet))
    jets = [x for x in values if isinstance(x, Jet)]
    return [x.node if isinstance(x, Jet) else recurrences.constant(beside(jets, x), order) for x in values]


def beside(jets: list[Jet], value: Any) -> Any:
    """A constant as an array that can stand in one formula with the Jets: next to exact ones it must be exact."""
    exact = next((j.value for j in jets if j.dtype == object), None)
    if exact is None or is_jax(value):
        return as_values(value)
    array = np.asarray(value)
    if array.dtype.kind in "iub":
        array = array.astype(object)
    zero = zeros(exact, ())[()]
    if isinstance(zero, Fraction | flint.fmpq) and any(isinstance(x, float | np.floating) for x in array.flat):
        raise SeriesError(
            f"the float {value!r} stands next to exact numbers: write a fraction, or use floats throughout"
        )
    return as_values(array + zero) if all(isinstance(x, int) for x in array.flat) else as_values(array)


def refused(name: str) -> SeriesError:
    """The error for a function without a recurrence."""
    return SeriesError(
        f"{name} has no Taylor recurrence here (it branches on values, or is not known): write the generator with "
        "arithmetic, sqrt exp log sin cos tan sinh cosh tanh arctan and linear algebra, or as sympy expressions"
    )


def _jet(node: Node) -> Jet:
    return Jet.from_node(node)


def _multiply(x: Any, y: Any) -> Node:
    return recurrences.product(*nodes(x, y))


def _divide(x: Any, y: Any) -> Node:
    if not isinstance(y, Jet):
        divisor = beside([x], y)
        return recurrences.linear(lambda a: a / divisor, [x.node])
    return recurrences.quotient(*nodes(x, y))


def _power(x: Any, y: Any) -> Node:
    if isinstance(y, Jet):
        base = x if isinstance(x, Jet) else Jet.constant(x, y.order)
        return _exponential_of(_multiply(np.log(base), y))
    if np.ndim(y) != 0:
        raise SeriesError("a power of a series needs one number as its exponent, not an array of them")
    whole = int(y) if float(y) == int(y) else None
    if whole is None:
        return recurrences.real_power(x.node, y)
    powered = recurrences.integer_power(x.node, abs(whole))
    return powered if whole >= 0 else recurrences.FUNCTIONS["reciprocal"](powered)


def _exponential_of(node: Node) -> Node:
    return recurrences.FUNCTIONS["exp"](node)


def _arctan2(y: Any, x: Any) -> Node:
    """The angle of (x, y): its derivative is (x y' - y x') / (x^2 + y^2)."""
    above, right = (v if isinstance(v, Jet) else Jet.constant(v, min(_orders(x, y))) for v in (y, x))
    value = namespace(above.value).arctan2(above.value, right.value)
    # the angle relative to its value at 0 is small, so arctan gives the right branch
    turned = right * np.cos(value) + above * np.sin(value)
    across = above * np.cos(value) - right * np.sin(value)
    return recurrences.add(np.arctan(across / turned).node, recurrences.constant(value, above.order))


def _orders(*values: Any) -> list[int]:
    return [v.order for v in values if isinstance(v, Jet)]


OPERATORS: dict[str, Callable[..., Node]] = {
    "multiply": _multiply,
    "divide": _divide,
    "true_divide": _divide,
    "power": _power,
    "float_power": _power,
    "arctan2": _arctan2,
    "hypot": lambda x, y: recurrences.real_power((x * x + y * y).node, 0.5),
    "conjugate": lambda x: recurrences.linear(np.conjugate, [x.node]),
}


# -- __array_function__ ----------------------------------------------------------------------------------
def apply_function(function: Any, args: tuple[Any, ...], options: dict[str, Any]) -> Any:
    """What a numpy function returns for Jets among its arguments."""
    name = function.__name__
    module = "linalg." if "linalg" in (function.__module__ or "") else ""
    if module + name in SPECIAL:
        return SPECIAL[module + name](*args, **options)
    if name in LINEAR and not module:
        return _linear(function, args, options)
    if name in BILINEAR:
        return _multilinear(function, args, options)
    if name in JOINED:
        return _joined(function, args, options)
    raise refused(f"np.{module}{name}")


def _twin(function: Any, *values: Any) -> Any:
    """The same function of jax.numpy where a value is a JAX array."""
    if not any(is_jax(v) for v in values):
        return function
    xp = namespace(*values)
    home = xp.linalg if "linalg" in (getattr(function, "__module__", "") or "") else xp
    return getattr(home, function.__name__)


def _linear(function: Any, args: tuple[Any, ...], options: dict[str, Any]) -> Jet:
    """A function that is linear in its first argument."""
    first, rest = args[0], args[1:]
    if any(isinstance(x, Jet) for x in (*rest, *options.values())):
        raise refused(f"np.{function.__name__} with a series as an option")
    return _jet(recurrences.linear(lambda x: _twin(function, x)(x, *rest, **options), [first.node]))


def _multilinear(function: Any, args: tuple[Any, ...], options: dict[str, Any], count: int = 2) -> Jet:
    """A function that is linear in each of its first `count` arguments."""
    factors, rest = args[:count], args[count:]
    places = [i for i, x in enumerate(factors) if isinstance(x, Jet)]

    def at(*values: Any) -> Any:
        filled = list(factors)
        for i, value in zip(places, values, strict=True):
            filled[i] = value
        return _twin(function, *filled)(*filled, *rest, **options)

    return _jet(recurrences.multilinear(at, [factors[i].node for i in places]))


def _einsum(*args: Any, **options: Any) -> Jet:
    if not isinstance(args[0], str):
        raise SeriesError("np.einsum of a series needs the form with a string of subscripts")
    subscripts, factors = args[0], args[1:]

    def contract(*values: Any) -> Any:
        return _twin(np.einsum, *values)(subscripts, *values, **options)

    return _multilinear(contract, factors, {}, len(factors))


def _joined(function: Any, args: tuple[Any, ...], options: dict[str, Any]) -> Jet:
    """A function of a sequence of arrays that is linear in all of them together."""
    members, rest = list(args[0]), args[1:]
    return _jet(
        recurrences.linear(lambda *parts: _twin(function, *parts)(list(parts), *rest, **options), nodes(*members))
    )


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Jet:
    if ord not in (None, 2, "fro") or (ord == 2 and (x.ndim if axis is None else np.size(axis)) != 1):
        raise refused(f"np.linalg.norm with ord={ord!r}")
    return np.sqrt(np.sum(x * x, axis=axis, keepdims=keepdims))  # type: ignore[no-any-return]


def _solve(a: Any, b: Any) -> Jet:
    """The solution of a x = b; b is a vector if it has one axis, as in numpy."""
    order = min(_orders(a, b))
    vector = np.ndim(b) == 1
    right = b if isinstance(b, Jet) else Jet.constant(b, order)
    columns = right[..., None] if vector else right
    if not isinstance(a, Jet):
        made = _linear(lambda x: _twin(np.linalg.solve, x)(a, x), (columns,), {})
    else:
        made = _jet(recurrences.solution(columns.node, a.node, _matmul, lambda y, x: _twin(np.linalg.solve, x)(x, y)))
    return made[..., 0] if vector else made


def _matmul(x: Any, y: Any) -> Any:
    return x @ y


def _inverse(a: Any) -> Jet:
    return _solve(a, namespace(a.value).broadcast_to(np.eye(a.shape[-1], dtype=a.dtype), a.shape))


def _blank(fill: float) -> Callable[..., Jet]:
    def make(a: Any, dtype: Any = None, *, shape: Any = None, **options: Any) -> Jet:
        value = zeros(a.value, a.shape if shape is None else tuple(np.atleast_1d(shape))) + fill
        return Jet.from_node(recurrences.constant(value, a.order), writable=True)

    return make


def _full_like(a: Any, fill_value: Any, dtype: Any = None, **options: Any) -> Jet:
    made = _blank(0)(a)
    made[...] = fill_value
    return made


def _where(condition: Any, x: Any = None, y: Any = None) -> Jet:
    if isinstance(condition, Jet):
        raise refused("np.where with a condition on a series")
    return _jet(recurrences.linear(lambda a, b: namespace(a, b).where(condition, a, b), nodes(x, y)))


SPECIAL: dict[str, Callable[..., Any]] = {
    "einsum": _einsum,
    "linalg.norm": _norm,
    "linalg.solve": _solve,
    "linalg.inv": _inverse,
    "linalg.cross": lambda x, y, **options: _multilinear(np.cross, (x, y), options),
    "linalg.trace": lambda x, **options: _linear(np.trace, (x,), {"axis1": -2, "axis2": -1}),
    "linalg.outer": lambda x, y: _multilinear(np.outer, (x, y), {}),
    "linalg.matmul": lambda x, y: np.matmul(x, y),
    "linalg.multi_dot": lambda arrays: _dot_all(list(arrays)),
    "zeros_like": _blank(0),
    "empty_like": _blank(0),
    "ones_like": _blank(1),
    "full_like": _full_like,
    "where": _where,
    "copy": lambda a, **options: a.copy(),
    "shape": lambda a: a.shape,
    "ndim": lambda a: a.ndim,
    "size": lambda a: a.size,
    "iscomplexobj": lambda a: bool(np.iscomplexobj(a.value)),
    "isrealobj": lambda a: bool(np.isrealobj(a.value)),
    "result_type": lambda *args: np.result_type(*[a.value if isinstance(a, Jet) else a for a in args]),
}


def _dot_all(arrays: list[Any]) -> Any:
    total = arrays[0]
    for a in arrays[1:]:
        total = np.dot(total, a)
    return total
