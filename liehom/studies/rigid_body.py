"""The free rigid body: exact motion and the system."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import ConvergenceError, InputError, ShapeError, displayed
from liehom.base.typing import Array, ScalarLike, Values
from liehom.exact.algebra.constructions.classical import so
from liehom.exact.representations.constructions import adjoint
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.rational import QQ
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.maps import FieldMatrix, remainder
from liehom.flow.bodies import AttitudeBody, inertia_tensor
from liehom.flow.methods.low_order import LieTaylor
from liehom.flow.run.options import points_of
from liehom.flow.steps.step import ExponentialLike
from liehom.studies.rigid_body_updates import ClosedFormUpdate, ExactOrbit, ExactOrbitUpdate, FloatType, Update
from liehom.studies.spheres import dot

# Jacobi elliptic functions sn, cn, dn of a modulus and its complement, in float64 or longdouble. For k^2 <= 1/2 they
# are quotients of theta functions in the nome q. For k^2 > 1/2 they are sums over the images under the imaginary
# period, which are sech and tanh in the limit k = 1:
#     dn = (pi/2K') sum sech(x_n),   k cn = (pi/2K') sum (-1)^n sech(x_n),   k sn = (pi/2K') sum (-1)^n tanh(x_n),
# x_n = pi (u - 2 n K)/(2 K'). Next to k = 1 the modulus alone does not determine the period, because 1 - k^2 is lost in
# the round-off of k^2.

MEAN_ITERATIONS = 24  # of the arithmetic-geometric mean: enough for k' = 1e-300
THETA_TERMS = 6  # terms are q^(n^2) with q <= exp(-pi)
IMAGE_TERMS = 16  # terms are about exp(-pi n): enough for extended precision


def jacobi_elliptic(u: npt.ArrayLike, square: npt.ArrayLike, complement: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """sn(u), cn(u), dn(u) for k^2 = `square`, 1 - k^2 = `complement` ([NIST] 22.2, 22.12), to a few units of round-off
    of max(1, |u|); next to k = 1 cn and dn are relatively accurate away from their zeros.
    """
    arrays: Any = np.broadcast_arrays(*(np.asarray(x) for x in (u, square, complement)))
    kind = np.result_type(*arrays, np.float64)
    argument, k2, rest_of_k2 = (x.astype(kind) for x in arrays)
    half, other = quarter_period(rest_of_k2), quarter_period(k2)
    finite = np.isfinite(half)
    turns = np.where(finite, np.round(argument / (2 * np.where(finite, half, 1))), 0)
    rest = argument - 2 * np.where(finite, half, 0) * turns
    sign = 1 - 2 * np.mod(turns, 2)
    steep = k2 > rest_of_k2
    near = _images(rest, np.sqrt(np.where(steep, k2, 1)), half, np.where(steep, other, 1))
    far = _thetas(rest, np.where(steep, 1, half), np.where(steep, 1, other))
    sn, cn, dn = (np.where(steep, a, b) for a, b in zip(near, far, strict=True))
    return sign * sn, sign * cn, dn


def quarter_period(complement: npt.ArrayLike) -> Array:
    """The quarter period K = pi / (2 agm(1, k')) for 1 - k^2 = k'^2 = `complement`; inf for 0."""
    square: Any = np.asarray(complement)
    a, g = np.ones_like(square), np.sqrt(np.where(square > 0, square, 1))
    for _ in range(MEAN_ITERATIONS):
        a, g = (a + g) / 2, np.sqrt(a * g)
    return np.where(square > 0, _pi(square) / (2 * a), np.inf)


def _pi(like: Array) -> Any:
    """pi in the type of an array."""
    return 4 * np.arctan(np.ones((), dtype=like.dtype))


def _thetas(u: Array, half: Array, other: Array) -> tuple[Array, Array, Array]:
    """sn, cn, dn as quotients of theta functions; common factors q^(1/4) are left out."""
    z, q = _pi(u) * u / (2 * half), np.exp(-_pi(u) * other / half)
    zeros, ones = np.zeros_like(u), np.ones_like(u)
    theta = [zeros, zeros, ones, ones]  # at z
    null = [zeros, ones, ones]  # theta_2, theta_3, theta_4 at 0
    for n in range(THETA_TERMS):
        odd = q ** (n * (n + 1))
        theta[0] = theta[0] + 2 * (-1) ** n * odd * np.sin((2 * n + 1) * z)
        theta[1] = theta[1] + 2 * odd * np.cos((2 * n + 1) * z)
        null[0] = null[0] + 2 * odd
        even = 2 * q ** ((n + 1) ** 2)
        theta[2] = theta[2] + even * np.cos(2 * (n + 1) * z)
        theta[3] = theta[3] + (-1) ** (n + 1) * even * np.cos(2 * (n + 1) * z)
        null[1] = null[1] + even
        null[2] = null[2] + (-1) ** (n + 1) * even
    sn = null[1] * theta[0] / (null[0] * theta[3])
    cn = null[2] * theta[1] / (null[0] * theta[3])
    return sn, cn, null[2] * theta[2] / (null[1] * theta[3])


def _images(u: Array, modulus: Array, half: Array, other: Array) -> tuple[Array, Array, Array]:
    """sn, cn, dn as sums over images under the imaginary period."""
    scale = _pi(u) / (2 * other)
    x, period = scale * u, 2 * scale * half
    sn, cn, dn = np.tanh(x), _sech(x), _sech(x)
    for n in range(1, IMAGE_TERMS):
        left, right = n * period - x, n * period + x
        both = _sech(left) + _sech(right)
        dn = dn + both
        cn = cn + (-1) ** n * both
        sn = sn + (-1) ** n * (np.tanh(right) - np.tanh(left))
    return scale / modulus * sn, scale / modulus * cn, scale * dn


def _sech(x: Array) -> Array:
    small = np.exp(-np.abs(x))
    return 2 * small / (1 + small * small)


# Exact motion of the free rigid body in principal axes, by Jacobi elliptic functions. With w_1 <= w_2 <= w_3 the
# inverse moments, a_1 = w_3 - w_2, a_2 = w_3 - w_1, a_3 = w_2 - w_1, m' = m x Om m reads
#     m_1' = a_1 m_2 m_3,   m_2' = -a_2 m_3 m_1,   m_3' = a_3 m_1 m_2,
# with the first integrals P = a_2 m_1^2 + a_1 m_2^2, Q = a_3 m_2^2 + a_2 m_3^2 and A = a_1 m_3^2 - a_3 m_1^2. For A > 0
#     m_1 = (P/a_2)^(1/2) cn u,  m_2 = -+ (P/a_1)^(1/2) sn u,  m_3 = +- (Q/a_2)^(1/2) dn u,  u = u_0 + (a_1 Q)^(1/2) t,
#     k^2 = a_3 P / (a_1 Q),  1 - k^2 = a_2 A / (a_1 Q);
# For A < 0 the axes 1 and 3 are exchanged; on the separatrix A = 0 the functions are tanh and sech.


def free_motion(m: Array, gaps: tuple[Any, Any, Any], t: Array) -> Array:
    """Points (..., 3) at time t through m at time 0, in principal axes, by the addition theorem. 1 - k^2 sn^2 u sn^2
    u_0 is cn^2 u_0 + sn^2 u_0 dn^2 u, accurate next to the separatrix.
    """
    a1, a2, a3 = gaps
    if a2 == 0:  # a sphere: nothing moves
        return np.broadcast_to(m, (*np.broadcast_shapes(m.shape[:-1], np.shape(t)), 3)).copy()
    level = a1 * m[..., 2] ** 2 - a3 * m[..., 0] ** 2
    third = (level > 0) | ((level == 0) & (a1 > 0))  # whether the motion circles axis 3, else it circles axis 1
    swing, middle = np.where(third, m[..., 0], m[..., 2]), m[..., 1]
    circled = np.where(third, m[..., 2], m[..., 0])
    own, across = np.where(third, a1, a3), np.where(third, a3, a1)
    p = a2 * swing**2 + own * middle**2
    q = across * middle**2 + a2 * circled**2
    moves = (p > 0) & (q > 0)
    p, q = np.where(moves, p, 1), np.where(moves, q, 1)
    square = np.where(moves, np.clip(across * p / (own * q), 0, 1), 0)
    complement = np.where(moves, np.clip(a2 * np.abs(level) / (own * q), 0, 1), 1)
    s, c, d = jacobi_elliptic(np.where(moves, np.sqrt(own * q), 0) * t, square, complement)
    sign = np.where(circled < 0, -1, 1)
    c0, s0, d0 = swing * np.sqrt(a2 / p), -sign * middle * np.sqrt(own / p), sign * circled * np.sqrt(a2 / q)
    below = np.where(moves, c0 * c0 + s0 * s0 * d * d, 1)
    cn, sn = (c * c0 - s * s0 * d * d0) / below, (s * c0 * d0 + s0 * c * d) / below
    dn = (d * d0 - square * s * s0 * c * c0) / below
    swing = np.where(moves, np.sqrt(p / a2) * cn, swing)
    middle = np.where(moves, -sign * np.sqrt(p / own) * sn, middle)
    circled = np.where(moves, sign * np.sqrt(q / a2) * dn, circled)
    return np.stack([np.where(third, swing, circled), middle, np.where(third, circled, swing)], axis=-1)


# The attitude of a free rigid body: Q' = Q hat(Om m) in SO(3) along m' = m x Om m, at given times.

ORDER = 14
RTOL = 1e-14


def attitude(body: AttitudeBody, m0: Array, t: npt.ArrayLike, start: npt.ArrayLike | None = None) -> Array:
    """Rotations Q(t), shape (..., k, 3, 3), of a free body: see `RigidBody.attitude`."""
    times = np.asarray(t, dtype=m0.dtype)
    if times.ndim != 1 or times.size == 0 or bool(np.any(times > 0) and np.any(times < 0)):
        raise ShapeError(f"the times are {t!r}, expected a list of times that are all of one sign")
    if start is not None and np.shape(start) != (3, 3):
        raise ShapeError(f"the attitude at time 0 has shape {np.shape(start)}, expected (3, 3)")
    y0 = body.start(None if start is None else np.asarray(start, dtype=m0.dtype), momentum=m0)
    end = times[-1] if times[-1] != 0 else times[0]
    if end == 0:
        return np.repeat(body.attitude(y0)[..., None, :, :], len(times), axis=-3)
    sol = body.integrate((0.0, end), y0, step=LieTaylor(ORDER), rtol=RTOL, atol=RTOL, t_eval=times)
    if not sol.success:
        raise ConvergenceError(f"the attitude could not be integrated: {sol.message}")
    rotations: Any = body.attitude(sol)
    return rotations


# RigidBody: the reduced free rigid body m' = m x Om m, Om = I^-1, on spheres in R^3.
#     X(m) = omega(m) x m,   omega_b = -Om m,   omega_o = -Om m + h m,   h = <m, Om m> / |m|^2
# omega_b is the generator of the body representation, omega_o the one orthogonal to m; g_m is spanned by m.


@final
class RigidBody:
    """A free rigid body with any inertia tensor, on spheres of any radius.

    Parameters
    ----------
    inertia : three positive numbers, or a symmetric positive definite (3, 3) matrix
        Principal moments, or the tensor. Entries are numbers, fractions, or strings such as "3/2". A float is read as
        the rational number that it is, so that Om = I^-1 is exact. Moments need not satisfy the triangle inequality.

    Attributes
    ----------
    representation : Representation
        so(3) on R^3: e_a acts by the cross product with e_a, on generators and points alike.
    inertia, inverse : arrays of shape (3, 3)
        I and Om in floats.
    moments : array of shape (3,)
        The principal moments, the largest first.
    axes : array of shape (3, 3)
        Principal axes in columns, in the order of `moments`, right-handed.

    Notes
    -----
    Section 4 of the paper with X = omega x m throughout. Updates have the names of Figure 6;
    `liehom.instances.update_names` lists them.

    Examples
    --------
    >>> import numpy as np
    >>> body = RigidBody([1, 2, 3])
    >>> m = np.array([0.6, 0.48, 0.64])
    >>> body.vector(m).round(4).tolist()
    [-0.0512, 0.256, -0.144]
    >>> after = body.update("eul_i")(m, 0.1)
    >>> bool(abs(body.energy(after) - body.energy(m)) < 1e-6), bool(abs(body.casimir(after) - 1) < 1e-14)
    (True, True)
    """

    def __init__(self, inertia: Sequence[ScalarLike] | Sequence[Sequence[ScalarLike]] | npt.NDArray[Any]) -> None:
        tensor = inertia_tensor(inertia)
        self._inverse = tensor.inverse()
        self._apply = FieldMatrix(self._inverse)
        self.representation: Representation = adjoint(so(3))
        self.inertia: Array = tensor.to_numpy()
        self.inverse: Array = self._inverse.to_numpy()
        for array in (self.inertia, self.inverse):
            array.flags.writeable = False
        self._diagonal = all(tensor.to_rows()[i][j] == 0 for i in range(3) for j in range(3) if i != j)

    def apply(self, m: Values) -> Any:
        """Om m for points m (..., 3): floats of either precision, exact numbers, or a Jet.

        Examples
        --------
        >>> import numpy as np
        >>> RigidBody([1, 2, 4]).apply(np.array([1.0, 1.0, 1.0])).tolist()
        [1.0, 0.5, 0.25]
        """
        return self._apply(m)

    def rayleigh(self, m: Values) -> Any:
        """Rayleigh quotient h = <m, Om m> / |m|^2, twice the energy on the unit sphere, shape (...,)."""
        return _dot(m, self.apply(m)) / _dot(m, m)

    def field(self, kind: str = "o") -> GeneratorField:
        """The vector field with the generator omega_b ("b") or omega_o ("o"), a GeneratorField.

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> bool(abs(body.field("o").psi(m) @ m) < 1e-15), bool(np.allclose(body.field("b").vector(m), body.vector(m)))
        (True, True)
        """
        if kind not in ("b", "o"):
            raise InputError(f"the kind of a generator is {kind!r}, expected 'b' (omega = -Om m) or 'o' (orthogonal)")
        return self._fields[kind]

    @cached_property
    def _fields(self) -> dict[str, GeneratorField]:
        def orthogonal(m: Values) -> Any:
            turned = self._apply(m)
            return dot(m, turned) / dot(m, m) * m - turned

        generators = {"b": lambda m: -self._apply(m), "o": orthogonal}
        return {kind: GeneratorField(self.representation, psi) for kind, psi in generators.items()}

    def vector(self, m: Values) -> Any:
        """Vector field X(m) = m x Om m, shape (..., 3)."""
        return np.cross(m, self.apply(m))

    def energy(self, m: Values) -> Any:
        """Energy H(m) = <m, Om m> / 2, shape (...,)."""
        return _dot(m, self.apply(m)) / 2

    def casimir(self, m: Values) -> Any:
        """|m|^2, shape (...,)."""
        return _dot(m, m)

    @cached_property
    def _principal(self) -> tuple[list[Scalar], Array]:
        """w_1 <= w_2 <= w_3 (exact for a diagonal tensor) and axes in columns."""
        if self._diagonal:
            diagonal = [row[i] for i, row in enumerate(self._inverse.to_rows())]
            order = sorted(range(3), key=diagonal.__getitem__)
            values, axes = [diagonal[i] for i in order], np.eye(3)[:, order]
        else:
            roots, axes = np.linalg.eigh(self.inverse)
            values = [QQ.convert(Fraction(float(x))) for x in roots]
        axes[:, 1] *= np.sign(np.linalg.det(axes))
        axes.flags.writeable = False
        return values, axes

    @property
    def moments(self) -> Array:
        """Principal moments, the largest first, shape (3,)."""
        return np.array([1 / QQ.to_float(x) for x in self._principal[0]])

    @property
    def axes(self) -> Array:
        """Principal axes in columns, in the order of `moments`, shape (3, 3)."""
        return self._principal[1]

    def invariants(self, dtype: FloatType = np.float64) -> tuple[Any, Any, Any]:
        """e_1, e_2, e_3, the elementary symmetric functions of the inverse moments, in a floating type.

        Examples
        --------
        >>> [float(x) for x in RigidBody([1, 2, 4]).invariants()]
        [1.75, 0.875, 0.125]
        """
        om, trace = self._inverse, self._inverse.trace()
        second = (trace**2 - (om @ om).trace()) / 2
        return number(trace, dtype), number(second, dtype), number(om.determinant(), dtype)

    def equilibria(self, radius: float = 1.0) -> Array:
        """The equilibria +-e_j on the principal axes, the axis of the largest moment first, shape (6, 3).

        If two moments are equal, every point of the great circle through their axes is an equilibrium too.

        Examples
        --------
        >>> RigidBody([1, 2, 3]).equilibria()[:2].tolist()
        [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
        """
        return radius * np.stack([self.axes.T, -self.axes.T], axis=1).reshape(6, 3) + 0.0

    def separatrix(self, angle: npt.ArrayLike, branch: int = 1, radius: float = 1.0) -> Array:
        """Points on the separatrix h = w_2, two great circles through the middle axis.

        Parameters
        ----------
        angle : array of shape (...,)
            Angle from the middle axis; 0 and pi are the unstable equilibria.
        branch : 1 or -1
            Selects one of the two circles.
        radius : float

        Returns
        -------
        array of shape (..., 3)

        Examples
        --------
        >>> body = RigidBody([1, 2, 3])
        >>> bool(abs(body.rayleigh(body.separatrix(0.3)) - 1 / 2) < 1e-15)
        True
        """
        if branch not in (1, -1):
            raise InputError(f"the branch of a separatrix is 1 or -1, got {displayed(branch)}")
        a1, a2, a3 = self._gaps(np.float64)
        if min(a1, a3) <= 0:
            raise InputError(
                f"a body with the moments {self.moments} has no separatrix: three different ones are needed"
            )
        first, middle, third = self.axes.T
        across = (np.sqrt(a1) * first + branch * np.sqrt(a3) * third) / np.sqrt(a2)
        angles = np.asarray(angle, dtype=float)[..., None]
        return radius * (np.cos(angles) * middle + np.sin(angles) * across)

    def _gaps(self, dtype: FloatType) -> tuple[Any, Any, Any]:
        """w_3 - w_2, w_3 - w_1, w_2 - w_1 in a floating type."""
        w1, w2, w3 = self._principal[0]
        return number(w3 - w2, dtype), number(w3 - w1, dtype), number(w2 - w1, dtype)

    def exact(self, m0: npt.ArrayLike, t: npt.ArrayLike) -> Array:
        """The point at time t of the motion through m0 at time 0, by Jacobi elliptic functions.

        Parameters
        ----------
        m0 : array_like of shape (..., 3)
            Of any norm. numpy.longdouble gives a result in extended precision (for a tensor that is not diagonal, the
            axes are in double precision).
        t : array_like of shape (...,)
            Broadcasts against the leading axes of m0.

        Returns
        -------
        array of shape (..., 3)

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> there = body.exact(m, 7.0)
        >>> bool(np.allclose(body.exact(there, -7.0), m, rtol=0, atol=1e-14))
        True
        """
        m = point_of(m0)
        axes = self.axes.astype(m.dtype)
        return free_motion(m @ axes, self._gaps(m.dtype.type), np.asarray(t, dtype=m.dtype)) @ axes.T

    def attitude(self, m0: npt.ArrayLike, t: npt.ArrayLike, start: npt.ArrayLike | None = None) -> Array:
        """Rotations Q(t) from the body to space, Q' = Q hat(Om m); the momentum in space, Q m, is constant.

        Parameters
        ----------
        m0 : array_like of shape (3,) or (..., 3)
            Body angular momentum at time 0.
        t : array_like of shape (k,)
            Sorted, all of one sign.
        start : array_like of shape (3, 3), optional
            Q(0); by default the identity.

        Returns
        -------
        array of shape (..., k, 3, 3)

        Notes
        -----
        The state is that of `AttitudeBody`: one rotation, with the generator omega_b, moves the rows of Q.

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> q = body.attitude(m, [1.0, 5.0])[1]
        >>> bool(np.allclose(q @ body.exact(m, 5.0), m, rtol=0, atol=1e-12)), round(float(np.linalg.det(q)), 12)
        (True, 1.0)
        """
        return attitude(AttitudeBody(self._inverse.inverse()), point_of(m0), t, start)

    def update(self, name: str, exponential: ExponentialLike = "cayley") -> Update:
        """The update (m, dt) -> m of Figure 6 with a name, from its base scheme and the generic corrector.

        Examples
        --------
        >>> RigidBody([1, 2, 3]).update("rk2_ib")
        <update rk2_ib with Cayley: Corrected(Heun(), order=4)>
        """
        return Update(self, name, exponential)

    def closed_form(self, name: str, exponential: str = "cayley") -> ClosedFormUpdate:
        """The update (m, dt) -> m of Figure 6 with a name, in closed form.

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> difference = body.closed_form("sy4_io")(m, 0.1) - body.update("sy4_io")(m, 0.1)
        >>> bool(np.abs(difference).max() < 1e-15)
        True
        """
        return ClosedFormUpdate(self, name, exponential)

    def exact_orbit(self) -> ExactOrbitUpdate:
        """The update (m, dt) -> m by the Cayley step that conserves the energy to round-off, of order 2 in time.

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> after = body.exact_orbit()(m, 2.0)
        >>> bool(abs(body.energy(after) - body.energy(m)) < 1e-15)
        True
        """
        return ExactOrbitUpdate(self, ExactOrbit(self))

    def __repr__(self) -> str:
        shown = np.diag(self.inertia) if self._diagonal else self.inertia
        return f"RigidBody({shown.tolist()})"


def number(x: Scalar, dtype: FloatType) -> Any:
    """A rational number rounded to a floating type."""
    near = QQ.to_float(x)
    return dtype(near) + dtype(remainder(QQ, x, near)) if dtype == np.longdouble else dtype(near)


def point_of(m: npt.ArrayLike) -> Array:
    """Points of R^3 as an array of floats, shape (..., 3)."""
    point = points_of(m)
    if point.ndim == 0 or point.shape[-1] != 3:
        raise ShapeError(f"a point has shape {point.shape}, expected (..., 3)")
    return point


def _dot(a: Values, b: Values) -> Any:
    """<a, b> over the last axis, shape (...,)."""
    return np.sum(a * b, axis=-1)
