"""Initial points and time spans as users give them, read as float64 or numpy.longdouble."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, displayed
from liehom.integrators.run.options import Span
from liehom.typing import Array

REMEDIES = {
    "c": "give real and imaginary parts as 2 N real coordinates of the representation on them",
    "f": "y0.astype(numpy.float64) computes in double precision",
    "b": "y0.astype(float) computes with 0 and 1",
}
"""What to do about initial points of a kind that is refused."""
ROUNDED = ("mpf", "mpc", "mpfr", "Decimal", "Float", "arb")
"""Names of types of numbers of more digits than floats, in mpmath, gmpy2, decimal, sympy and flint."""


def points_of(y0: npt.ArrayLike) -> Array:
    """Initial points as an array of float64, or of longdouble if they are given in it.

    Integers, fractions and other exact numbers become floats.

    Raises
    ------
    InputError
        If they are not real numbers, or are numbers of another precision, which would be changed.

    Examples
    --------
    >>> points_of([1, 0]).dtype.name
    'float64'
    >>> points_of(np.zeros(3, dtype=np.float32))
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: the start has the type float32, expected float64: y0.astype(numpy.float64) computes in ...
    """
    try:
        array = np.asarray(y0)
        if array.dtype.kind == "O":
            array = _from_objects(array)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"the start is not a point of floats: {error}") from None
    if array.dtype in (np.float64, np.longdouble) or array.dtype.kind in "iu":
        return array.astype(array.dtype if array.dtype.kind == "f" else np.float64)
    remedy = REMEDIES.get(array.dtype.kind)
    expected = "float64" if array.dtype.kind == "f" else "real numbers"
    raise InputError(f"the start has the type {array.dtype}, expected {expected}" + (f": {remedy}" if remedy else ""))


def _from_objects(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """An array of floats from numbers of Python and of other libraries."""
    for x in array.flat:
        if type(x).__name__ in ROUNDED:
            raise InputError(
                f"the start has a number of type {type(x).__name__}, which would be rounded: "
                "numpy.array(y0, dtype=float) computes in double precision, numpy.longdouble in extended precision"
            )
    return array.astype(np.float64)


def span_of(t_span: Iterable[float] | Span, dtype: np.dtype[Any]) -> Span:
    """Start and end of a time span, in a floating type.

    Raises
    ------
    InputError
        If `t_span` is not two finite numbers.

    Examples
    --------
    >>> span_of((0, 1), np.dtype(np.float64))
    (np.float64(0.0), np.float64(1.0))
    """
    try:
        if isinstance(t_span, str | bytes):
            raise TypeError
        first, last = (dtype.type(t) for t in t_span)
        if np.ndim(first) or np.ndim(last):
            raise TypeError
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"t_span is {displayed(t_span)}, expected two numbers (start, end)") from None
    if not (np.isfinite(first) and np.isfinite(last)):
        raise InputError(f"t_span is {displayed(t_span)}: start and end must be finite")
    return first, last
