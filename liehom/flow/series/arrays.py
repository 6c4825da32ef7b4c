"""The kinds of arrays that series have as coefficients: numpy of any dtype, JAX (recognized, never imported), traced
arrays (on which numpy's functions run), arrays of exact numbers.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import isqrt
from types import ModuleType
from typing import Any, TypeAlias, TypeGuard, TypeVar

import flint
import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from liehom.base.errors import FieldError, SeriesError, SingularError
from liehom.base.objects import refuse_masked
from liehom.base.typing import Array, Lanes, Number, ObjectArray, Values
from liehom.flow.tracing.array import Traced, elementwise
from liehom.flow.tracing.graph import COARSE
from liehom.flow.tracing.lattice import LatticeTraced

ExactNumber: TypeAlias = Any
"""An entry of an array of objects: a number of sympy, mpmath or flint, a Fraction, an element of a field."""

NumbersLike: TypeAlias = ArrayLike | Number | Sequence[Number]
"""Whatever becomes an array of numbers: arrays, numbers and nested sequences, also of exact numbers."""

T = TypeVar("T")

# the values at 0 that stay in every field; at other arguments these functions leave QQ
_AT_ZERO = {
    "exp": 1, "cos": 1, "cosh": 1, "sin": 0, "tan": 0, "sinh": 0, "tanh": 0, "arctan": 0, "arcsin": 0,
    "arctanh": 0, "arcsinh": 0, "expm1": 0, "log1p": 0, "cbrt": 0,
}  # fmt: skip
_SYMPY = {
    "arctan": "atan", "arcsin": "asin", "arccos": "acos", "arctanh": "atanh", "arcsinh": "asinh", "arccosh": "acosh",
}  # fmt: skip


def is_jax(x: object) -> TypeGuard[Any]:
    """Whether x is a JAX array or tracer."""
    return type(x).__module__.startswith(("jax", "jaxlib"))


def is_lazy(x: object) -> TypeGuard[Any]:
    """Whether x is a JAX array or a traced array, whose values must not decide what is computed."""
    kind = type(x)
    return kind is Traced or kind is LatticeTraced or kind.__module__.startswith(("jax", "jaxlib"))


def is_traced(x: object) -> bool:
    """Whether x is a tracer, inside ``jax.jit`` or ``jax.grad`` or while a step is traced."""
    return type(x) is Traced or (is_jax(x) and isinstance(x, sys.modules["jax"].core.Tracer))


def is_exact(x: object) -> bool:
    """Whether x is an array of objects: exact scalars or symbols, not machine numbers."""
    return getattr(x, "dtype", None) == np.dtype(object)


def namespace(*arrays: object) -> ModuleType:
    """The module ``jax.numpy`` if one of the arrays is a JAX array, else ``numpy``."""
    return sys.modules["jax.numpy"] if any(is_jax(x) for x in arrays) else np


def as_values(x: NumbersLike) -> npt.NDArray[Any]:
    """x as an array with the arithmetic of a field: machine integers become floats, exact integers fractions."""
    if is_lazy(x):
        return x if x.dtype.kind not in "iub" else x.astype(float)
    if type(x) is not np.ndarray:
        refuse_masked("a point", x)
    array = np.asarray(x)
    if array.dtype.kind in "fc":
        return array
    if array.dtype.kind in "iub":
        return array.astype(np.float64)
    if array.dtype.kind != "O":
        raise SeriesError(f"the entries of a series are numbers, got an array of type {array.dtype}")
    kinds = [x for x in array.flat if not isinstance(x, int | np.integer | flint.fmpz)]
    return _alike(array, 0 * kinds[0] if kinds and _is_number(kinds[0]) else Fraction(0))


def _alike(array: npt.NDArray[Any], zero: Number) -> ObjectArray:
    """An array of objects in which integers and rational numbers are of the kind of `zero`."""
    out = np.empty(array.shape, dtype=object)
    rational = isinstance(zero, Fraction | flint.fmpq)
    for index, value in np.ndenumerate(array):
        if isinstance(value, int | np.integer | flint.fmpz) and not isinstance(value, bool):
            out[index] = zero + int(value)
        elif isinstance(value, Fraction | flint.fmpq):
            top, bottom = _ratio(value)
            out[index] = (zero + top) / bottom
        elif rational and isinstance(value, float | complex | np.inexact):
            raise _next_to_exact(value)
        elif _is_number(value):
            out[index] = value
        else:
            raise SeriesError(f"the entries of a series are numbers, got {value!r}")
    return out


def _next_to_exact(value: object) -> SeriesError:
    return SeriesError(f"the float {value!r} stands next to exact numbers: write a fraction, or floats throughout")


def _ratio(x: ExactNumber) -> tuple[int, int]:
    """Numerator and denominator of a rational number."""
    return (int(x.p), int(x.q)) if isinstance(x, flint.fmpq) else x.as_integer_ratio()


def _is_number(value: object) -> bool:
    no_number = isinstance(value, str | bytes | bool | np.bool_ | list | tuple) or bool(getattr(value, "ndim", False))
    return not no_number and hasattr(value, "__mul__")


def constant_like(like: Values, value: NumbersLike) -> npt.NDArray[Any]:
    """A copy of a constant as an array of the same kind of numbers as `like`, exact if these are."""
    if is_lazy(value):
        return as_values(value)
    dtype = getattr(like, "dtype", np.dtype(object))
    if dtype.kind == "O":
        array = np.asarray(value)
        if array.dtype.kind in "fc" and isinstance(zeros(like, ())[()], Fraction | flint.fmpq):
            raise _next_to_exact(value)
        return _alike(array, zeros(like, ())[()]) if array.dtype.kind in "iuO" else as_values(array)
    if isinstance(value, Fraction | flint.fmpq):
        top, bottom = _ratio(value)
        return np.ones((), dtype=dtype) * top / bottom
    if isinstance(value, int | float | complex) and not isinstance(value, np.generic):
        return np.asarray(value, dtype=np.result_type(dtype, 1.0 if isinstance(value, int) else value))
    return owned(as_values(value))


def owned(x: T) -> T:
    """A copy of x if it is a numpy array, which the caller might change later; else x itself."""
    return x.copy(order="K") if isinstance(x, np.ndarray) else x


def zeros(like: Values, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """Array of zeros of this shape, with the dtype of `like`; for exact numbers, their own zero."""
    if is_lazy(like):
        return namespace(like).zeros(shape, dtype=like.dtype)
    dtype = np.asarray(like).dtype
    if dtype.kind != "O":
        if len(shape) > 1:  # see `in_lanes`
            return np.moveaxis(np.zeros((shape[-1], *shape[:-1]), dtype=dtype), 0, -1)
        return np.zeros(shape, dtype=dtype)
    array = np.asarray(like, dtype=object)
    out = np.empty(shape, dtype=object)
    out.fill(0 * array.flat[0] if array.size else Fraction(0))
    return out


def norm(x: Values) -> Values:
    """Euclidean norms of x (..., N), shape (...,)."""
    xp = namespace(x)
    return xp.sqrt(xp.sum(x * x, axis=-1))


def in_lanes(x: Lanes) -> Lanes:
    """x (..., N) with each component contiguous in memory, the last axis outermost; a copy if x has another layout.

    Values and shape are those of x. Arithmetic of numpy keeps the layout, and with few components is several times
    faster in it: the inner loops run over the ensemble.
    """
    if type(x) is not np.ndarray or x.ndim < 2:
        return x
    components = x.T if x.ndim == 2 else np.moveaxis(x, -1, 0)
    return x if components.flags.c_contiguous else np.moveaxis(np.ascontiguousarray(components), 0, -1)


def across_lanes(x: Values, matrix: Values) -> Values:
    """x @ matrix for x (..., n) and one matrix (n, k) for all trajectories, in the memory layout of x."""
    if type(x) is not np.ndarray or x.ndim < 2 or x.flags.c_contiguous or not x.size:
        return x @ matrix
    components = x.T if x.ndim == 2 else np.moveaxis(x, -1, 0)
    if not components.flags.c_contiguous:
        return x @ matrix
    if x.ndim == 2:
        return (matrix.T @ components).T
    columns = matrix.T @ components.reshape(len(components), -1)
    return np.moveaxis(columns.reshape(-1, *components.shape[1:]), 0, -1)


def elementary(name: str, x: Values) -> npt.NDArray[Any]:
    """The numpy function of this name applied to the entries of an array."""
    if is_lazy(x):
        return getattr(namespace(x), name)(x)
    array = np.asarray(x)
    if array.dtype.kind != "O":
        return getattr(np, name)(array)
    return _entrywise(lambda value: _elementary_scalar(name, value), array)


def _entrywise(function: Callable[[ExactNumber], ExactNumber], array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    out = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array):
        out[index] = function(value)
    return out if array.ndim else out[()]


def _elementary_scalar(name: str, x: ExactNumber) -> ExactNumber:
    kind = type(x).__module__
    if kind.startswith("sympy"):
        import sympy

        return _symbolic(sympy, name, x)
    if kind.startswith("mpmath"):
        import mpmath  # type: ignore[import-untyped]

        return _symbolic(mpmath, name, x)
    if x == 0 and name in _AT_ZERO:
        return x + _AT_ZERO[name]
    if x == 1 and name in ("log", "sqrt"):
        return x - 1 if name == "log" else x
    root = _rational_root(x) if name == "sqrt" else None
    if root is not None:
        return root
    if isinstance(x, float | np.floating):
        return getattr(np, name)(x)
    raise FieldError(f"{name}({x}) is not known to be in the field of the exact numbers; use floats or sympy symbols")


def _symbolic(library: ModuleType, name: str, x: ExactNumber) -> ExactNumber:
    """The function of sympy or mpmath with the numpy name."""
    if name in ("expm1", "log1p"):
        return library.exp(x) - 1 if name == "expm1" else library.log(x + 1)
    if name == "exp2":
        return (0 * x + 2) ** x
    if name in ("log2", "log10"):
        return library.log(x) / library.log(0 * x + int(name[3:]))
    return getattr(library, _SYMPY.get(name, name))(x)


def coarse(name: str, x: Values) -> Array:
    """`coarse_log2` or `coarse_exp2` of x (`liehom.flow.tracing.graph`), the same numbers for all kinds of arrays."""
    if isinstance(x, Traced):
        return elementwise(x.tape, lambda e: x.tape.call(name, e), x)  # type: ignore[return-value]
    return COARSE[name](x, namespace(x))


def power(x: Values, exponent: Fraction) -> npt.NDArray[Any]:
    """x ** exponent for arrays of exact numbers: square roots of squares, and all powers in sympy and mpmath."""
    return _entrywise(lambda value: _power_scalar(value, exponent), np.asarray(x, dtype=object))


def _power_scalar(x: ExactNumber, exponent: Fraction) -> ExactNumber:
    kind = type(x).__module__
    if kind.startswith("sympy"):
        import sympy

        return x ** sympy.Rational(exponent.numerator, exponent.denominator)
    if kind.startswith("mpmath"):
        return x ** (x**0 * exponent.numerator / exponent.denominator)
    if x == 1:
        return x
    if exponent.denominator == 2:
        return _elementary_scalar("sqrt", x) ** exponent.numerator
    raise FieldError(f"({x}) ** ({exponent}) is not known to be in the field of the exact numbers; use floats")


def solve(a: Values, b: Values) -> npt.NDArray[Any]:
    """Solution of a x = b for matrices a (..., n, n), b (..., n, k), also of long doubles and exact numbers."""
    if is_lazy(a) or is_lazy(b):
        return namespace(a, b).linalg.solve(a, b)
    dtype = np.result_type(a, b)
    if dtype.char not in "gGO":
        return np.linalg.solve(a, b)
    if dtype.char != "O":
        rough = np.linalg.inv(a.astype(np.float64 if dtype.char == "g" else np.complex128)).astype(dtype)
        x = rough @ b
        for _ in range(3):
            x = x + rough @ (b - a @ x)
        return x
    leading = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    left = np.broadcast_to(a, (*leading, *a.shape[-2:])).astype(dtype)
    right = np.broadcast_to(b, (*leading, *b.shape[-2:])).astype(dtype)
    for index in np.ndindex(*leading):
        _eliminate(left[index], right[index])
    return right


def _eliminate(a: npt.NDArray[Any], b: npt.NDArray[Any]) -> None:
    """Solve a x = b for exact numbers in place by Gauss-Jordan elimination; b becomes x."""
    n = a.shape[0]
    for i in range(n):
        pivot = int(np.argmax(a[i:, i] != 0))
        if a[i + pivot, i] == 0:
            raise SingularError(f"a matrix of size {n} that has to be inverted is singular")
        a[[i, i + pivot]], b[[i, i + pivot]] = a[[i + pivot, i]], b[[i + pivot, i]]
        b[i] = b[i] / a[i, i]
        a[i] = a[i] / a[i, i]
        for j in range(n):
            if j != i:
                b[j] = b[j] - a[j, i] * b[i]
                a[j] = a[j] - a[j, i] * a[i]


def _rational_root(x: ExactNumber) -> ExactNumber:
    """The square root of an exact rational square, of the kind of x, else None."""
    if not isinstance(x, flint.fmpq | Fraction) or x < 0:
        return None
    root = type(x)(*map(isqrt, _ratio(x)))
    return root if root**2 == x else None
