"""A point as floats or as exact numbers of the representation's field."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from liehom.errors import InputError, ShapeError
from liehom.homogeneous.fields.field import check_point
from liehom.representations import Representation
from liehom.series.arrays import as_values, is_exact
from liehom.typing import IntegerArray


def read_point(representation: Representation, m: ArrayLike) -> tuple[npt.NDArray[Any], IntegerArray]:
    """(points as floats or as exact numbers of the representation's field, dimensions of their orbits).

    Raises
    ------
    ShapeError
        If m does not have N coordinates.
    InputError
        If the group fixes a point.

    Examples
    --------
    >>> import liehom as lh
    >>> point, dimension = read_point(lh.defining(lh.so(3)), [0, 0, 1])
    >>> point, int(dimension)
    (array([0., 0., 1.]), 2)
    """
    point = as_values(m)
    if not is_exact(point):
        return point, check_point(representation, point)
    if point.ndim == 0 or point.shape[-1] != representation.size:
        raise ShapeError(f"a point has {representation.size} coordinates (on its last axis), got shape {point.shape}")
    made = np.empty(point.shape, dtype=object)
    for index, value in np.ndenumerate(point):
        made[index] = representation.field.convert(value)
    dimensions = np.empty(point.shape[:-1], dtype=int)
    for index in np.ndindex(dimensions.shape):
        dimensions[index] = representation.orbit_dimension(made[index])
        if dimensions[index] == 0:
            raise InputError(f"the group leaves the point {made[index]} fixed: its orbit has dimension 0")
    return made, dimensions
