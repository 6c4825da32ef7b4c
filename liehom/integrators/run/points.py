"""Initial points and time spans as users give them, read as float64 or numpy.longdouble."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, displayed
from liehom.integrators.run.options import Span
from liehom.typing import Array


def points_of(y0: npt.ArrayLike) -> Array:
    """Initial points as an array of float64, or of longdouble if they are given in it.

    Raises
    ------
    InputError
        If they are not real numbers.

    Examples
    --------
    >>> points_of([1, 0]).dtype.name
    'float64'
    """
    try:
        array = np.asarray(y0)
        if array.dtype.kind == "O":
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"the start is not a point of floats: {error}") from None
    if array.dtype.kind not in "iuf":
        raise InputError(f"the start has the type {array.dtype}, expected real numbers")
    return array.astype(array.dtype if array.dtype in (np.float64, np.longdouble) else np.float64)


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
