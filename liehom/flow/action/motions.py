"""Rotations SO(3) and rigid motions SE(3) as objects: products, exp, log and dexp, adjoints, quaternions.

Each object holds matrices with any leading axes, in numpy or JAX arrays.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Self, final

import numpy as np

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Array, Values, ValuesLike
from liehom.flow.action.exponential import rotation_quotients
from liehom.flow.action.maps import applied, expm1, solve
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


@dataclass(frozen=True, eq=False)
class _Motions(ABC):
    """Matrices (..., n, n) of a group; `@` is the product."""

    matrix: Values
    _element: ClassVar[tuple[int, str]]  # number of coordinates of a tangent vector, and what it is called

    @staticmethod
    @abstractmethod
    def _differential(x: Values) -> Values:
        """The matrices of dexp_x."""

    @classmethod
    def dexp(cls, x: ValuesLike, y: ValuesLike) -> Values:
        """dexp_x y for tangent vectors x and y: exp(x(t)) moves with the velocity dexp_x(x') from the left."""
        return applied(cls._differential(cls._read(x)), cls._read(y))

    @classmethod
    def dexp_inverse(cls, x: ValuesLike, y: ValuesLike) -> Values:
        """dexp_x^-1 y for tangent vectors x and y, where the angle of x is less than 2 pi."""
        matrix: Any = cls._differential(cls._read(x))
        return solve(matrix, cls._read(y)[..., None])[..., 0]

    @classmethod
    def _read(cls, x: ValuesLike) -> Values:
        return _read(x, cls._element[:1], cls._element[1])

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

    _element = 3, "a rotation vector"

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
        x = SO3._read(tangent)
        s, c, _ = rotation_quotients(_square(x))
        return SO3(_of_skew(x, s, c))

    @staticmethod
    def _differential(x: Values) -> Values:
        _, c, d = rotation_quotients(_square(x))
        return _of_skew(x, c, d)

    def log(self) -> Values:
        """Rotation vectors (..., 3) of length at most pi."""
        return quaternion_log(matrix_to_quaternion(self.matrix))

    def adjoint(self) -> Values:
        """Ad_R on rotation vectors, the matrix R itself."""
        return self.matrix

    def inverse(self) -> SO3:
        """The inverse rotations, the transposed matrices."""
        return SO3(namespace(self.matrix).swapaxes(self.matrix, -1, -2))

    def apply(self, points: ValuesLike) -> Values:
        """R v for points v (..., 3)."""
        return applied(self.matrix, _read(points, (3,), "a point"))

    def as_quaternion_wxyz(self) -> Values:
        """Unit quaternions (..., 4), scalar part first, of the sign for which the largest entry is positive."""
        return matrix_to_quaternion(self.matrix)

    def as_quaternion_xyzw(self) -> Values:
        """Unit quaternions (..., 4), scalar part last, as scipy and ROS write them."""
        return namespace(self.matrix).roll(self.as_quaternion_wxyz(), -1, axis=-1)


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

    _element = 6, "an element of se(3)"

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
        x = SE3._read(tangent)
        return SE3.from_rotation_and_translation(SO3.exp(x[..., :3]), SO3.dexp(x[..., :3], x[..., 3:]))

    @staticmethod
    def _differential(x: Values) -> Values:
        xp, ad = namespace(x), _in_blocks(_skew(x[..., :3]), _skew(x[..., 3:]))
        one = xp.broadcast_to(xp.eye(6, dtype=x.dtype), ad.shape)
        # the upper right block of exp is the integral of exp(s ad_x) for s from 0 to 1
        wide = xp.concatenate([xp.concatenate([ad, one], axis=-1), 0 * xp.concatenate([ad, ad], axis=-1)], axis=-2)
        return expm1(wide)[..., :6, 6:]

    def log(self) -> Values:
        """Elements (omega, v) of se(3), shape (..., 6), with omega of length at most pi."""
        omega = self.rotation().log()
        return namespace(omega).concatenate([omega, SO3.dexp_inverse(omega, self.translation())], axis=-1)

    def adjoint(self) -> Values:
        """Ad_g as matrices (..., 6, 6) on (omega, v): (R omega, x x R omega + R v)."""
        r = self.rotation().matrix
        return _in_blocks(r, _skew(self.translation()) @ r)

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


def are_rotations(matrices: Array, atol: float) -> bool:
    """Whether the entries of R R^T differ from those of 1 by at most atol, and det R > 0, for matrices (..., 3, 3)."""
    near = np.allclose(matrices @ np.swapaxes(matrices, -1, -2), np.eye(3), rtol=0, atol=atol)
    return bool(near and np.all(np.linalg.det(matrices.astype(float)) > 0))


# Unit quaternions (w, x, y, z), scalar part first, and the rotation matrices that they denote.
#
# q v q^-1 = R(q) v,   R(q) = R(-q),   R(p q) = R(p) R(q)


def quaternion_to_matrix(q: Values) -> Values:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), which are divided by their norms."""
    xp = namespace(q)
    w, x, y, z = (q[..., i] for i in range(4))
    s = 2 / (w * w + x * x + y * y + z * z)
    rows = [
        [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
    ]
    return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)


def matrix_to_quaternion(matrix: Values) -> Values:
    """Unit quaternions (..., 4) of rotation matrices (..., 3, 3), of the sign for which the largest entry is positive.

    4 q q^T is linear in the matrix; the row of its largest diagonal entry is divided by its norm, so that no digits
    are lost at any angle.
    """
    xp = namespace(matrix)
    r: Any = matrix
    (a, b, c), (d, e, f), (g, h, i) = ([r[..., k, j] for j in range(3)] for k in range(3))
    rows = [
        [1 + a + e + i, h - f, c - g, d - b],
        [h - f, 1 + a - e - i, b + d, c + g],
        [c - g, b + d, 1 - a + e - i, f + h],
        [d - b, c + g, f + h, 1 - a - e + i],
    ]
    outer = xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)
    largest = xp.argmax(xp.stack([rows[k][k] for k in range(4)], axis=-1), axis=-1)
    row = xp.take_along_axis(outer, largest[..., None, None], axis=-2)[..., 0, :]
    return row / xp.sqrt(xp.sum(row * row, axis=-1, keepdims=True))


# Elements of so(3) are vectors x, those of se(3) vectors (omega, v), the angular part first. The differential is
# trivialized on the right, as everywhere in the library. That is, d/dt exp(x(t)) = dexp_x(x') exp(x) with the operator
# dexp_x = (exp(ad_x) - 1)/ad_x. For g' = y g and x = log g follows x' = dexp_x^-1(y). log uses quaternions, so no
# digits are lost near rotations by pi. All functions run on float64, numpy.longdouble and JAX arrays.


def quaternion_log(q: Values) -> Values:
    """Rotation vectors (..., 3) of length at most pi of unit quaternions (..., 4); q and -q have the same one."""
    xp = namespace(q)
    w, v = q[..., :1], q[..., 1:]
    v, w = xp.where(w < 0, -v, v), xp.abs(w)
    square = _square(v)
    small = square < 1e-8 * w * w
    safe = xp.where(small, 1.0, square)
    z = square / xp.where(small, w * w, 1.0)
    near = (1 - z / 3 * (1 - 3 * z / 5)) / xp.where(small, w, 1.0)
    far = xp.arctan2(xp.sqrt(safe), w) / xp.sqrt(safe)
    return 2 * xp.where(small, near, far) * v


def _skew(x: Values) -> Values:
    """The matrices of v -> x x v."""
    return namespace(x).stack([namespace(x).cross(x, e) for e in np.eye(3)], axis=-1)


def _of_skew(x: Values, a: Values, b: Values) -> Values:
    """The matrices 1 + a X + b X^2, X = _skew(x), for a and b of shape (..., 1)."""
    matrix = _skew(x)
    return np.eye(3) + (a[..., None] * matrix + b[..., None] * (matrix @ matrix))


def _in_blocks(a: Values, b: Values) -> Values:
    """The matrices [[a, 0], [b, a]]."""
    xp = namespace(a)
    return xp.concatenate([xp.concatenate([a, 0 * a], axis=-1), xp.concatenate([b, a], axis=-1)], axis=-2)


def _square(x: Values) -> Values:
    return namespace(x).sum(x * x, axis=-1, keepdims=True)
