"""Inertia tensors as users give them, read as matrices over QQ, and rotations, checked."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError
from liehom.homogeneous.exponentials.quaternions import quaternion_to_matrix
from liehom.scalars import QQ, ExactMatrix
from liehom.typing import Array

SYMMETRY_RTOL = 1e-10
"""Largest difference of I[i, j] and I[j, i], relative to the largest entry."""
ROTATION_ATOL = 1e-8
"""Largest entry of Q Q^T - 1 for a matrix that is read as a rotation."""


def inertia_tensor(inertia: object, size: int = 3) -> ExactMatrix:
    """The inertia tensor as a matrix over QQ, from its diagonal or its entries.

    Raises
    ------
    ShapeError, InputError
        If it is not a symmetric positive definite matrix of this size.

    Examples
    --------
    >>> inertia_tensor([1, "3/2", 2]).determinant()
    3
    """
    if isinstance(inertia, ExactMatrix):
        return inertia
    given = np.asarray(inertia, dtype=object)
    if given.shape == (size,):
        given = np.diag(given)
    if given.shape != (size, size):
        moments = "three moments" if size == 3 else f"{size} moments"
        raise ShapeError(f"the inertia has shape {given.shape}, expected {moments} or a ({size}, {size}) matrix")
    exact = [[_rational(x) for x in row] for row in given]
    largest = max(abs(x) for row in exact for x in row)
    for i in range(size):
        for j in range(i + 1, size):
            gap = abs(exact[i][j] - exact[j][i])
            if gap > SYMMETRY_RTOL * largest:
                raise InputError(
                    f"the inertia tensor is not symmetric: I[{i}, {j}] = {given[i, j]}, I[{j}, {i}] = {given[j, i]}"
                )
            exact[i][j] = exact[j][i] = (exact[i][j] + exact[j][i]) / 2
    tensor = QQ.matrix(exact)
    if not tensor.is_positive_definite():
        raise InputError(f"the inertia {inertia} is not positive definite: principal moments are positive")
    return tensor


def _rational(x: object) -> Fraction:
    """A number, or a string, as a fraction."""
    try:
        if isinstance(x, str | int | Fraction):
            return Fraction(x)
        if hasattr(x, "p") and hasattr(x, "q"):
            return Fraction(int(x.p), int(x.q))
        return Fraction(*np.float64(x).as_integer_ratio())  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError, ZeroDivisionError):
        raise InputError(f"a moment of inertia is {x!r}, expected a finite real number") from None


def rotations(attitude: npt.ArrayLike | None) -> Array:
    """Rotation matrices (..., 3, 3) from matrices or unit quaternions (..., 4), checked; the identity for None.

    Raises
    ------
    ShapeError, InputError
        If they are not of this form.

    Examples
    --------
    >>> rotations([0.0, 1.0, 0.0, 0.0]).tolist()
    [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]
    """
    if attitude is None:
        return np.eye(3)
    given = np.asarray(attitude)
    q: Array = given if given.dtype == np.longdouble else np.asarray(given, dtype=float)
    if q.shape[-1:] == (4,):
        if not np.allclose(np.sum(q * q, axis=-1), 1, rtol=0, atol=ROTATION_ATOL):
            raise InputError("the attitude at time 0 is not a unit quaternion: divide it by its norm")
        turned: Any = quaternion_to_matrix(q)
        made: Array = turned
        return made
    if q.shape[-2:] != (3, 3):
        raise ShapeError(
            f"the attitude at time 0 has shape {q.shape}, expected (..., 3, 3), or (..., 4) for quaternions"
        )
    gram = q @ np.swapaxes(q, -1, -2)
    if not np.allclose(gram, np.eye(3), rtol=0, atol=ROTATION_ATOL) or np.any(np.linalg.det(q.astype(float)) < 0):
        raise InputError("the attitude at time 0 is not a rotation matrix")
    return q
