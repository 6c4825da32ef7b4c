"""Numpy's ufuncs (arithmetic and elementary functions) for Jets.

Elementary functions are in the table of `recurrences`, operators in the table here.  All others raise `SeriesError`
with their name.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from numbers import Rational
from typing import Any

import flint
import numpy as np
import numpy.typing as npt

from liehom.errors import SeriesError
from liehom.series import recurrences
from liehom.series.arrays import across_lanes, constant_like, elementary, is_jax, namespace
from liehom.series.assembly import holds_jets, nodes
from liehom.series.jet import Jet
from liehom.series.jet_dispatch import WITHOUT_SERIES, Operand, dispatch
from liehom.series.node import Node
from liehom.typing import Values

# ufuncs that are linear
LINEAR_UFUNCS = ["conjugate", "deg2rad", "radians", "rad2deg", "degrees"]
# ufuncs that multiply arrays as a whole
PRODUCTS = ["matmul", "vecdot", "matvec", "vecmat"]


def apply_ufunc(ufunc: np.ufunc, method: str, inputs: tuple[Operand, ...], options: dict[str, Any]) -> Any:
    """The result of a numpy ufunc with Jets among its inputs.

    Raises
    ------
    SeriesError
        If it has no Taylor recurrence, or would write a Jet into an array of numbers.

    Examples
    --------
    >>> apply_ufunc(np.multiply, "__call__", (2.0, Jet([1.0, 3.0])), {}).coefficients
    array([2., 6.])
    """
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
        given = "".join(f" {key}=" for key in options)
        raise refused(
            f"np.{name}" + (f".{method}" if method != "__call__" else "") + (" with" + given if given else "")
        )
    return _called(ufunc, name, inputs)


def _called(ufunc: np.ufunc, name: str, inputs: tuple[Operand, ...]) -> Jet:
    if name in recurrences.FUNCTIONS:
        return fresh(recurrences.FUNCTIONS[name](inputs[0].node))
    if name == "positive":
        found: Jet = inputs[0].copy()
        return found
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
    if not target.shape and not target.shares() and inputs and inputs[0] is target:
        return apply_ufunc(ufunc, method, inputs, options)
    made = apply_ufunc(ufunc, method, inputs, options)
    if made.shape != target.shape:
        raise SeriesError(f"a series of shape {made.shape} does not fit into one of shape {target.shape}")
    target[...] = made
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
    found: Callable[..., Any] = getattr(home, function.__name__)
    return found


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
        found: Values = jax_counterpart(function, a, b)(a, b, **options)
        return found

    return fresh(recurrences.multilinear(at, factors))


def _multiply(x: Operand, y: Operand) -> Node:
    return recurrences.product(*nodes(x, y))


def _divide(x: Operand, y: Operand) -> Node:
    if not holds_jets(y):
        divisor = constant_like(x.value, y)
        return recurrences.linear(lambda a: a / divisor, [x.node])
    return recurrences.quotient(*nodes(x, y))


def _power(x: Operand, y: Operand) -> Node:
    if holds_jets(y):
        base, exponent = nodes(x, y)
        logarithm = recurrences.FUNCTIONS["log"](base)
        return recurrences.FUNCTIONS["exp"](recurrences.product(logarithm, exponent))
    if np.ndim(y):
        return _powers(x, np.asarray(y)).node
    y = y[()] if isinstance(y, np.ndarray) else y
    if isinstance(y, flint.fmpq):
        y = Fraction(int(y.p), int(y.q))
    if isinstance(y, int | np.integer | float | np.floating | Rational) and float(y).is_integer():
        whole = round(float(y))
        powered = recurrences.integer_power(x.node, abs(whole))
        return powered if whole >= 0 else recurrences.FUNCTIONS["reciprocal"](powered)
    if not isinstance(y, complex | np.complexfloating) and (isinstance(y, Rational) or x.dtype == object):
        y = Fraction(y)
    return recurrences.FUNCTIONS["sqrt"](x.node) if y == 0.5 else recurrences.real_power(x.node, y)


def _powers(x: Jet, exponents: npt.NDArray[Any]) -> Jet:
    """x ** exponents for an array of exponents; entries with the same exponent are computed together."""
    shape = np.broadcast_shapes(x.shape, exponents.shape)
    base: Any = np.broadcast_to(x, shape)
    made, places = base.copy(), np.broadcast_to(exponents, shape)
    for exponent in dict.fromkeys(exponents.flat):
        if exponent != 1:
            made[places == exponent] = base[places == exponent] ** exponent
    return made  # type: ignore[no-any-return]


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
    return recurrences.FUNCTIONS["sqrt"](recurrences.add(recurrences.product(a, a), recurrences.product(b, b)))


def _logaddexp(x: Operand, y: Operand) -> Node:
    a, b = (Jet.from_node(node) for node in nodes(x, y))
    larger = namespace(a.value, b.value).maximum(a.value, b.value)  # a constant shift, against overflow
    return (larger + np.log(np.exp(a - larger) + np.exp(b - larger))).node  # type: ignore[no-any-return]


OPERATORS: dict[str, Callable[..., Node]] = {
    "multiply": _multiply,
    "divide": _divide,
    "power": _power,
    "float_power": _power,
    "arctan2": _arctan2,
    "hypot": _hypot,
    "logaddexp": _logaddexp,
}

dispatch.apply_ufunc = apply_ufunc
