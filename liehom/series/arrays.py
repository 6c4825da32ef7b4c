"""Which arrays a computation runs on: numpy of any dtype, JAX, or numpy arrays of exact scalars.

`namespace` gives the module whose functions fit an array, `elementary` applies a function such as ``exp`` to the
values of an array: numerically, or exactly to objects (sympy expressions; field elements where the value is in
the field), and says so where it cannot.  JAX is never imported, only recognised.  Imports errors.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from liehom.errors import FieldError, SeriesError

# the values at 0 that stay in every field; at other arguments these functions leave QQ
_AT_ZERO = {
    "exp": 1, "cos": 1, "cosh": 1, "sin": 0, "tan": 0, "sinh": 0, "tanh": 0, "arctan": 0, "arcsin": 0,
    "arctanh": 0, "arcsinh": 0, "expm1": 0, "log1p": 0,
}  # fmt: skip
_SYMPY = {"arctan": "atan", "arcsin": "asin", "arccos": "acos", "arctanh": "atanh", "arcsinh": "asinh"}


def is_jax(x: Any) -> bool:
    """Whether x is a JAX array or tracer.

    Examples
    --------
    >>> import numpy as np
    >>> is_jax(np.zeros(2))
    False
    """
    module = type(x).__module__
    return module.startswith(("jax", "jaxlib"))


def is_traced(x: Any) -> bool:
    """Whether x stands for a value that is not known yet, inside ``jax.jit`` or ``jax.grad``.

    Examples
    --------
    >>> import numpy as np
    >>> is_traced(np.zeros(2))
    False
    """
    return is_jax(x) and isinstance(x, sys.modules["jax"].core.Tracer)


def is_exact(x: Any) -> bool:
    """Whether x is an array of objects: exact scalars or symbols, not machine numbers.

    Examples
    --------
    >>> import numpy as np
    >>> is_exact(np.zeros(2)), is_exact(np.array([None]))
    (False, True)
    """
    kind = getattr(x, "dtype", None)
    return kind is not None and kind == np.dtype(object)


def namespace(*arrays: Any) -> Any:
    """``jax.numpy`` if one of the arrays is a JAX array, else ``numpy``.

    Examples
    --------
    >>> import numpy as np
    >>> namespace(np.zeros(2)).__name__
    'numpy'
    """
    return sys.modules["jax.numpy"] if any(is_jax(x) for x in arrays) else np


def as_values(x: Any) -> Any:
    """x as an array whose arithmetic is a field's: integers become floats, exact integers become fractions.

    Examples
    --------
    >>> from fractions import Fraction
    >>> as_values([1, 2]).dtype, as_values([Fraction(1, 2), 3])[1]
    (dtype('float64'), Fraction(3, 1))
    """
    if is_jax(x):
        return x
    array = np.asarray(x)
    if array.dtype.kind in "iub":
        return array.astype(np.float64)
    if array.dtype.kind in "fc":
        return array
    if array.dtype.kind != "O":
        raise SeriesError(f"the entries of a series are numbers, got an array of type {array.dtype}")
    kinds = [x for x in array.flat if not isinstance(x, int | np.integer | flint.fmpz)]
    zero = 0 * kinds[0] if kinds else Fraction(0)
    out = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array):
        if isinstance(value, bool | np.bool_):
            raise SeriesError(f"{value!r} is not a number")
        out[index] = zero + int(value) if isinstance(value, int | np.integer | flint.fmpz) else value
    return out


def zeros(like: Any, shape: tuple[int, ...]) -> Any:
    """An array of zeros of the kind of `like`; over exact scalars they are the zero of their kind.

    Examples
    --------
    >>> import numpy as np
    >>> zeros(np.ones(2, dtype=np.float32), (1,)).dtype
    dtype('float32')
    """
    if is_jax(like):
        return namespace(like).zeros(shape, dtype=like.dtype)
    dtype = np.asarray(like).dtype
    if dtype.kind != "O":
        return np.zeros(shape, dtype=dtype)
    array = np.asarray(like, dtype=object)
    out = np.empty(shape, dtype=object)
    out.fill(0 * array.flat[0] if array.size else Fraction(0))
    return out


def elementary(name: str, x: Any) -> Any:
    """The numpy function of this name on the values of an array.

    Raises
    ------
    FieldError
        If the values are exact and the result is not in the field.

    Examples
    --------
    >>> import numpy as np
    >>> elementary("exp", np.zeros(2))
    array([1., 1.])
    """
    if is_jax(x):
        return getattr(namespace(x), name)(x)
    array = np.asarray(x)
    if array.dtype.kind != "O":
        return getattr(np, name)(array)
    out = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array):
        out[index] = _elementary_scalar(name, value)
    return out if array.ndim else out[()]


def _elementary_scalar(name: str, x: Any) -> Any:
    kind = type(x).__module__
    if kind.startswith("sympy"):
        import sympy

        return getattr(sympy, _SYMPY.get(name, name))(x)
    if kind.startswith("mpmath"):
        import mpmath

        return getattr(mpmath, _SYMPY.get(name, name))(x)
    if x == 0 and name in _AT_ZERO:
        return x + _AT_ZERO[name]
    if x == 1 and name in ("log", "sqrt"):
        return x - 1 if name == "log" else x
    if name == "sqrt":
        root = _rational_root(x)
        if root is not None:
            return root
    if isinstance(x, float | np.floating):
        return getattr(np, name)(x)
    raise FieldError(f"{name}({x}) is not known to be in the field of the exact numbers; use floats or sympy symbols")


def _rational_root(x: Any) -> Any:
    """The square root of an exact rational square, else None."""
    if isinstance(x, Fraction):
        x = flint.fmpq(x.numerator, x.denominator)
    if not isinstance(x, flint.fmpq) or x < 0:
        return None
    top, bottom = flint.fmpz(x.p).isqrt(), flint.fmpz(x.q).isqrt()
    return flint.fmpq(top, bottom) if flint.fmpq(top * top, bottom * bottom) == x else None
