"""Rotations SO(3) and rigid motions SE(3) as objects: products, exp and log, adjoints, quaternions.

Each object holds matrices with any leading axes, in numpy or JAX arrays.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self, final

import numpy as np

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Values, ValuesLike
from liehom.flow.action.rigid_motions import (
    are_rotations,
    matrix_to_quaternion,
    quaternion_to_matrix,
    se3_exp,
    se3_log,
    so3_exp,
    so3_log,
)
from liehom.flow.series.arrays import as_values, is_jax, namespace

TOLERANCE = 1e-6
"""How far from a rotation a matrix may be that `from_matrix` takes."""


def _read(x: ValuesLike, shape: tuple[int, ...], what: str) -> Values:
    """An array whose last axes have a shape."""
    array: Any = as_values(x)
    if array.shape[-len(shape) :] != shape:
        raise ShapeError(f"{what} has shape {array.shape}, expected (..., {', '.join(map(str, shape))})")
    return array


def _check_rotation(matrix: Values) -> None:
    """Refuse numpy arrays that are not rotations; values of JAX may be traced and are not checked."""
    if not is_jax(matrix) and not are_rotations(np.asarray(matrix), TOLERANCE):
        raise InputError(f"no rotation: R R^T differs from 1 by more than {TOLERANCE}, or det R is not positive")


def _skew(x: Values) -> Values:
    """The matrices of v -> x x v."""
    return namespace(x).stack([namespace(x).cross(x, e) for e in np.eye(3)], axis=-1)


@dataclass(frozen=True, eq=False)
class _Motions:
    """Matrices (..., n, n) of a group; `@` is the product."""

    matrix: Values

    def as_matrix(self) -> Values:
        """The matrices (..., n, n), n = 3 for rotations and 4 for rigid motions."""
        return self.matrix

    def multiply(self, other: Self) -> Self:
        """The product, ``self @ other``: first `other`, then `self`."""
        return type(self)(self.matrix @ other.matrix)

    def __matmul__(self, other: Self) -> Self:
        return self.multiply(other) if isinstance(other, type(self)) else NotImplemented

    def __repr__(self) -> str:
        return f"{type(self).__name__}({np.array2string(np.asarray(self.matrix), precision=4, suppress_small=True)})"


@final
class SO3(_Motions):
    """Rotations of R^3, as matrices (..., 3, 3).

    Tangent vectors (..., 3) are rotation vectors: the axis times the angle in radians. Quaternions (w, x, y, z) have
    the scalar part first, if the name does not say otherwise.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> a, b = lh.SO3.exp([0, 0, np.pi / 2]), lh.SO3.from_quaternion_wxyz([1, 0, 0, 0])
    >>> (a @ b.inverse()).apply([1.0, 0.0, 0.0]).round(12).tolist(), a.log().round(4).tolist()
    ([0.0, 1.0, 0.0], [0.0, 0.0, 1.5708])
    """

    @staticmethod
    def identity() -> SO3:
        """The rotation by the angle 0."""
        return SO3(np.eye(3))

    @staticmethod
    def from_matrix(matrix: ValuesLike) -> SO3:
        """Rotations of matrices (..., 3, 3), which are checked."""
        array = _read(matrix, (3, 3), "a rotation")
        _check_rotation(array)
        return SO3(array)

    @staticmethod
    def from_quaternion_wxyz(quaternion: ValuesLike) -> SO3:
        """Rotations of quaternions (..., 4) with the scalar part first, which are divided by their norms."""
        q = _read(quaternion, (4,), "a quaternion")
        if not is_jax(q) and not np.all(np.isfinite(q).all(axis=-1) & np.any(q != 0, axis=-1)):
            raise InputError("a quaternion of a rotation is finite and not 0")
        return SO3(quaternion_to_matrix(q))

    @staticmethod
    def from_quaternion_xyzw(quaternion: ValuesLike) -> SO3:
        """Rotations of quaternions (..., 4) with the scalar part last, as scipy and ROS write them."""
        q = _read(quaternion, (4,), "a quaternion")
        return SO3.from_quaternion_wxyz(namespace(q).roll(q, 1, axis=-1))

    @staticmethod
    def exp(tangent: ValuesLike) -> SO3:
        """Rotations of rotation vectors (..., 3)."""
        return SO3(so3_exp(_read(tangent, (3,), "a rotation vector")))

    def log(self) -> Values:
        """Rotation vectors (..., 3) of length at most pi."""
        return so3_log(self.matrix)

    def adjoint(self) -> Values:
        """Ad_R on rotation vectors, the matrix R itself."""
        return self.matrix

    def inverse(self) -> SO3:
        """The inverse rotations, the transposed matrices."""
        return SO3(namespace(self.matrix).swapaxes(self.matrix, -1, -2))

    def apply(self, points: ValuesLike) -> Values:
        """R v for points v (..., 3)."""
        return (self.matrix @ _read(points, (3,), "a point")[..., None])[..., 0]

    def as_quaternion_wxyz(self) -> Values:
        """Unit quaternions (..., 4), scalar part first, of the sign for which the largest entry is positive."""
        return matrix_to_quaternion(self.matrix)


@final
class SE3(_Motions):
    """Rigid motions v -> R v + x of R^3, as homogeneous matrices (..., 4, 4).

    Tangent vectors (omega, v), shape (..., 6), have the angular part first, as momenta and velocities of bodies have.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> pose = lh.SE3.exp([0, 0, np.pi, 1, 0, 0])
    >>> pose.translation().round(4).tolist(), pose.apply([1.0, 0, 0]).round(4).tolist()
    ([0.0, 0.6366, 0.0], [-1.0, 0.6366, 0.0])
    >>> bool(abs((pose @ pose.inverse()).log()).max() < 1e-15)
    True
    """

    @staticmethod
    def identity() -> SE3:
        """The motion that moves no point."""
        return SE3(np.eye(4))

    @staticmethod
    def from_rotation_and_translation(rotation: SO3, translation: ValuesLike) -> SE3:
        """The motions v -> R v + x for rotations R and vectors x (..., 3)."""
        r: Any = rotation.matrix
        x = _read(translation, (3,), "a translation")
        xp = namespace(r, x)
        lead = np.broadcast_shapes(r.shape[:-2], x.shape[:-1])
        top = xp.concatenate([xp.broadcast_to(r, (*lead, 3, 3)), xp.broadcast_to(x, (*lead, 3))[..., None]], axis=-1)
        last = xp.broadcast_to(xp.asarray([0.0, 0.0, 0.0, 1.0], dtype=top.dtype), (*lead, 1, 4))
        return SE3(xp.concatenate([top, last], axis=-2))

    @staticmethod
    def from_matrix(matrix: ValuesLike) -> SE3:
        """Motions of homogeneous matrices (..., 4, 4), which are checked."""
        array = _read(matrix, (4, 4), "a rigid motion")
        _check_rotation(array[..., :3, :3])
        if not is_jax(array) and np.abs(array[..., 3, :] - np.eye(4)[3]).max(initial=0.0) > TOLERANCE:
            raise InputError("the last row of a rigid motion is 0, 0, 0, 1")
        return SE3(array)

    @staticmethod
    def exp(tangent: ValuesLike) -> SE3:
        """Motions of elements (omega, v) of se(3), shape (..., 6)."""
        return SE3(se3_exp(_read(tangent, (6,), "an element of se(3)")))

    def log(self) -> Values:
        """Elements (omega, v) of se(3), shape (..., 6), with omega of length at most pi."""
        return se3_log(self.matrix)

    def adjoint(self) -> Values:
        """Ad_g as matrices (..., 6, 6) on (omega, v): (R omega, x x R omega + R v)."""
        r, x = self.rotation().matrix, self.translation()
        xp = namespace(r)
        rows = [xp.concatenate([r, 0 * r], axis=-1), xp.concatenate([_skew(x) @ r, r], axis=-1)]
        return xp.concatenate(rows, axis=-2)

    def inverse(self) -> SE3:
        """The inverse motions v -> R^T (v - x)."""
        back = self.rotation().inverse()
        return SE3.from_rotation_and_translation(back, -back.apply(self.translation()))

    def apply(self, points: ValuesLike) -> Values:
        """R v + x for points v (..., 3)."""
        return self.rotation().apply(points) + self.translation()

    def rotation(self) -> SO3:
        """The rotations R."""
        return SO3(self.matrix[..., :3, :3])

    def translation(self) -> Values:
        """The vectors x, shape (..., 3)."""
        return self.matrix[..., :3, 3]
