"""Starting points as arrays: float64, or numpy.longdouble where it is given."""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.errors import InputError


def points_of(y0: Any) -> Any:
    """Starting points as float64 or longdouble.

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
    except (TypeError, ValueError) as error:
        raise InputError(f"the start is not a point of floats: {error}") from None
    if array.dtype.kind not in "iuf":
        raise InputError(f"the start has the type {array.dtype}, expected real numbers")
    return array.astype(array.dtype if array.dtype in (np.float64, np.longdouble) else np.float64)
