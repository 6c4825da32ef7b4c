"""Rotations SO(3) and rigid motions SE(3) as objects: products, exp, log and dexp, adjoints, quaternions.

Each object holds matrices with any leading axes, in numpy or JAX arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import factorial
from typing import Any, Self, final

import numpy as np

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Array, Values, ValuesLike
from liehom.flow.action.exponential import rotation_quotients
from liehom.flow.series.arrays import as_values, is_jax, namespace
from liehom.flow.series.lie_series import bernoulli

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

    @staticmethod
    def dexp(x: ValuesLike, y: ValuesLike) -> Values:
        """dexp_x y, shape (..., 3): exp(x(t)) moves with the velocity dexp_x(x') from the left."""
        return so3_dexp(_read(x, (3,), "a rotation vector"), _read(y, (3,), "a rotation vector"))

    @staticmethod
    def dexp_inverse(x: ValuesLike, y: ValuesLike) -> Values:
        """dexp_x^-1 y, shape (..., 3), for |x| < 2 pi."""
        return so3_dexp_inverse(_read(x, (3,), "a rotation vector"), _read(y, (3,), "a rotation vector"))

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

    @staticmethod
    def dexp(x: ValuesLike, y: ValuesLike) -> Values:
        """dexp_x y, shape (..., 6): exp(x(t)) moves with the velocity dexp_x(x') from the left."""
        return se3_dexp(_read(x, (6,), "an element of se(3)"), _read(y, (6,), "an element of se(3)"))

    @staticmethod
    def dexp_inverse(x: ValuesLike, y: ValuesLike) -> Values:
        """dexp_x^-1 y, shape (..., 6), for |omega| < 2 pi."""
        return se3_dexp_inverse(_read(x, (6,), "an element of se(3)"), _read(y, (6,), "an element of se(3)"))

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


# exp, log and the differential of exp for SO(3), unit quaternions and SE(3), for arrays with any leading axes.
#
# Elements of so(3) are vectors x, those of se(3) vectors (omega, v), the angular part first. The differential is
# trivialized on the right, as everywhere in the library. That is, d/dt exp(x(t)) = dexp_x(x') exp(x) with the operator
# dexp_x = (exp(ad_x) - 1)/ad_x. For g' = y g and x = log g follows x' = dexp_x^-1(y).
#
# All are sums of few powers of ad_x whose coefficients are functions of |omega|^2, by series near 0. log uses
# quaternions, so no digits are lost near rotations by pi. The functions run on float64, numpy.longdouble and JAX
# arrays.

SERIES_TERMS = 14
SERIES_REACH = 1.0
"""|omega|^2 up to which coefficients are Taylor series."""


# -- SO(3) -------------------------------------------------------------------------------------------------
def so3_exp(x: ValuesLike) -> Values:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3)."""
    x = as_values(x)
    xp = namespace(x)
    s, c, _ = rotation_quotients(_square(x))
    columns = [s * xp.cross(x, e) + c * xp.cross(x, xp.cross(x, e)) + e for e in np.eye(3)]
    return xp.stack(columns, axis=-1)


def so3_log(rotation: ValuesLike) -> Values:
    """Rotation vectors (..., 3) of length at most pi of rotation matrices (..., 3, 3)."""
    return quaternion_log(matrix_to_quaternion(as_values(rotation)))


def so3_dexp(x: ValuesLike, y: ValuesLike) -> Values:
    """dexp_x y, shape (..., 3)."""
    x, y = as_values(x), as_values(y)
    cross = namespace(x, y).cross
    _, c, d = rotation_quotients(_square(x))
    once = cross(x, y)
    return y + (c * once + d * cross(x, once))


def so3_dexp_inverse(x: ValuesLike, y: ValuesLike) -> Values:
    """dexp_x^-1 y, shape (..., 3), for |x| < 2 pi."""
    x, y = as_values(x), as_values(y)
    cross = namespace(x, y).cross
    q: Any = _square(x)
    once = cross(x, y)
    return y + (-0.5 * once + _inverse_coefficient(q) * cross(x, once))


# -- unit quaternions --------------------------------------------------------------------------------------
def quaternion_log(quaternion: ValuesLike) -> Values:
    """Rotation vectors (..., 3) of length at most pi of unit quaternions (..., 4); q and -q have the same one."""
    q: Any = as_values(quaternion)
    xp = namespace(q)
    w, v = q[..., :1], q[..., 1:]
    v, w = xp.where(w < 0, -v, v), xp.abs(w)
    square = xp.sum(v * v, axis=-1, keepdims=True)
    small = square < 1e-8 * w * w
    safe = xp.where(small, 1.0, square)
    z = square / xp.where(small, w * w, 1.0)
    near = (1 - z / 3 * (1 - 3 * z / 5)) / xp.where(small, w, 1.0)
    far = xp.arctan2(xp.sqrt(safe), w) / xp.sqrt(safe)
    return 2 * xp.where(small, near, far) * v


# -- SE(3) -------------------------------------------------------------------------------------------------
def se3_exp(x: ValuesLike) -> Values:
    """Homogeneous matrices (..., 4, 4) of elements (omega, v) of se(3), shape (..., 6)."""
    x = as_values(x)
    xp = namespace(x)
    rotation, shift = so3_exp(x[..., :3]), so3_dexp(x[..., :3], x[..., 3:])
    top = xp.concatenate([rotation, shift[..., None]], axis=-1)
    last = xp.broadcast_to(xp.asarray([0.0, 0.0, 0.0, 1.0], dtype=top.dtype), (*top.shape[:-2], 1, 4))
    return xp.concatenate([top, last], axis=-2)


def se3_log(motion: ValuesLike) -> Values:
    """Elements (omega, v) of se(3), shape (..., 6), with |omega| at most pi, of homogeneous matrices (..., 4, 4)."""
    g: Any = as_values(motion)
    omega = so3_log(g[..., :3, :3])
    return namespace(g).concatenate([omega, so3_dexp_inverse(omega, g[..., :3, 3])], axis=-1)


def se3_dexp(x: ValuesLike, y: ValuesLike) -> Values:
    """dexp_x y in se(3), shape (..., 6)."""
    x, y = as_values(x), as_values(y)
    c = _se3_coefficients(_square(x[..., :3]))
    first = se3_bracket(x, y)
    second = se3_bracket(x, first)
    third = se3_bracket(x, second)
    return y + (c[0] * first + c[1] * second + c[2] * third + c[3] * se3_bracket(x, third))


def se3_dexp_inverse(x: ValuesLike, y: ValuesLike) -> Values:
    """dexp_x^-1 y in se(3), shape (..., 6), for |omega| < 2 pi."""
    x, y = as_values(x), as_values(y)
    second, fourth = _se3_inverse_coefficients(_square(x[..., :3]))
    once = se3_bracket(x, y)
    twice = se3_bracket(x, once)
    return y + (-0.5 * once + second * twice + fourth * se3_bracket(x, se3_bracket(x, twice)))


def se3_bracket(x: ValuesLike, y: ValuesLike) -> Values:
    """[x, y] = (omega x eta, omega x u + v x eta) for x = (omega, v) and y = (eta, u), shape (..., 6)."""
    a, b = as_values(x), as_values(y)
    xp = namespace(a, b)
    turned = xp.cross(a[..., :3], b[..., 3:]) + xp.cross(a[..., 3:], b[..., :3])
    return xp.concatenate([xp.cross(a[..., :3], b[..., :3]), turned], axis=-1)


# -- coefficients as functions of q = |omega|^2 ------------------------------------------------------------
def _square(x: Values) -> Values:
    xp = namespace(x)
    return xp.sum(x * x, axis=-1, keepdims=True)


def _series(q: Values, coefficients: list[Fraction]) -> Values:
    """The polynomial in q with these coefficients, rounded to its type."""
    wide = not is_jax(q) and q.dtype == np.longdouble
    numbers: list[Any] = [
        np.longdouble(str(c.numerator)) / np.longdouble(str(c.denominator)) if wide else float(c) for c in coefficients
    ]
    total: Any = 0 * q + numbers[-1]
    for c in reversed(numbers[:-1]):
        total = total * q + c
    return total


def _joined(q: Values, coefficients: list[Fraction], far: Callable[[Values], Values]) -> Values:
    """A Taylor series near 0 and another expression elsewhere."""
    xp = namespace(q)
    small = q < SERIES_REACH
    return xp.where(small, _series(xp.where(small, q, 0.0), coefficients), far(xp.where(small, 1.0, q)))


def _inverse_coefficient(q: Values) -> Values:
    """(1 - (r/2) cot(r/2))/r^2, the coefficient of ad_x^2 in dexp_x^-1 on so(3)."""

    def far(q: Values) -> Values:
        s, c, _ = rotation_quotients(q)
        return (1 - s / (2 * c)) / q

    return _joined(q, [b * (-1) ** k for k, b in enumerate(_bernoulli())], far)


@cache
def _bernoulli() -> list[Fraction]:
    """B_2k/(2k)! for k = 1, 2, ...: the even coefficients of z/(exp(z) - 1)."""
    return [b / factorial(k) for k, b in enumerate(bernoulli(2 * SERIES_TERMS))][2::2]


def _se3_coefficients(q: Values) -> tuple[Values, ...]:
    """Coefficients of ad, ..., ad^4 in dexp on se(3), where ad^5 = -2 q ad^3 - q^2 ad."""
    js = range(2, SERIES_TERMS + 2)
    first = [Fraction(1, 2), Fraction(0), *(-(j - 1) * (-1) ** j * Fraction(1, factorial(2 * j + 2)) for j in js)]
    second = [Fraction(1, 6), Fraction(0), *(-(j - 1) * (-1) ** j * Fraction(1, factorial(2 * j + 3)) for j in js)]
    third = [j * (-1) ** (j - 1) * Fraction(1, factorial(2 * j + 2)) for j in range(1, SERIES_TERMS)]
    fourth = [j * (-1) ** (j - 1) * Fraction(1, factorial(2 * j + 3)) for j in range(1, SERIES_TERMS)]

    def ratio(a: float, b: float, odd: bool, power: int) -> Callable[[Values], Values]:
        def far(q: Values) -> Values:
            xp = namespace(q)
            r = xp.sqrt(q)
            sine, cosine = xp.sin(r), xp.cos(r)
            top = a * r - b * sine + r * cosine if odd else a - r * sine - b * cosine
            return top / (2 * r**power)

        return far

    return (
        _joined(q, first, ratio(4, 4, False, 2)),
        _joined(q, second, ratio(4, 5, True, 3)),
        _joined(q, third, ratio(2, 2, False, 4)),
        _joined(q, fourth, ratio(2, 3, True, 5)),
    )


def _se3_inverse_coefficients(q: Values) -> tuple[Values, Values]:
    """Coefficients of ad^2 and ad^4 in dexp^-1 on se(3)."""
    beta = _bernoulli()
    second = [beta[0], Fraction(0), *((j - 1) * (-1) ** (j - 1) * beta[j] for j in range(2, SERIES_TERMS))]
    fourth = [j * (-1) ** (j - 1) * beta[j] for j in range(1, SERIES_TERMS)]

    def of(power: int, top: float, factor: float) -> Callable[[Values], Values]:
        def far(q: Values) -> Values:
            xp = namespace(q)
            r = xp.sqrt(q)
            half = xp.sin(r / 2)
            return top / r**power - (r + factor * xp.sin(r)) / (8 * r ** (power - 1) * half * half)

        return far

    return _joined(q, second, of(2, 2.0, 3.0)), _joined(q, fourth, of(4, 1.0, 1.0))
