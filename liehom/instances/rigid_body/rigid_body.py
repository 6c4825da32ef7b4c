"""RigidBody: the reduced free rigid body m' = m x Om m, Om = I^-1, on spheres in R^3.

    X(m) = omega(m) x m,   omega_b = -Om m,   omega_o = -Om m + h m,   h = <m, Om m> / |m|^2

omega_b is the generator of the body representation, omega_o the one orthogonal to m; g_m is spanned by m.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.correctors.step import ExponentialLike
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.maps import FieldMatrix, remainder
from liehom.instances.bodies.attitude_body import AttitudeBody
from liehom.instances.bodies.inertia import inertia_tensor
from liehom.instances.rigid_body.attitude import attitude
from liehom.instances.rigid_body.closed_forms import ClosedFormUpdate
from liehom.instances.rigid_body.exact_orbit import ExactOrbit, ExactOrbitUpdate
from liehom.instances.rigid_body.free_body import FloatType
from liehom.instances.rigid_body.free_motion import free_motion
from liehom.instances.rigid_body.updates import Update
from liehom.integrators.points import points_of
from liehom.representations import Representation, adjoint
from liehom.scalars import QQ, Scalar
from liehom.typing import Array, ScalarLike, Values


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

    Raises
    ------
    ShapeError, InputError
        If the inertia is not of this kind.

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

    # -- the field ---------------------------------------------------------------------------------------
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

        Raises
        ------
        InputError
            If the kind is neither "b" nor "o".

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> bool(abs(body.field("o").psi(m) @ m) < 1e-15), bool(np.allclose(body.field("b").vector(m), body.vector(m)))
        (True, True)
        """
        if kind not in _GENERATORS:
            raise InputError(f"the kind of a generator is {kind!r}, expected 'b' (omega = -Om m) or 'o' (orthogonal)")
        return self._fields[kind]

    @cached_property
    def _fields(self) -> dict[str, GeneratorField]:
        def body(m: Values) -> Any:
            return -self.apply(m)

        def orthogonal(m: Values) -> Any:
            turned = self.apply(m)
            h: Any = np.sum(m * turned, axis=-1, keepdims=True) / np.sum(m * m, axis=-1, keepdims=True)
            return h * m - turned

        return {
            kind: GeneratorField(self.representation, psi)
            for kind, psi in zip(_GENERATORS, (body, orthogonal), strict=True)
        }

    def vector(self, m: Values) -> Any:
        """Vector field X(m) = m x Om m, shape (..., 3)."""
        return np.cross(m, self.apply(m))

    def energy(self, m: Values) -> Any:
        """Energy H(m) = <m, Om m> / 2, shape (...,)."""
        return _dot(m, self.apply(m)) / 2

    def casimir(self, m: Values) -> Any:
        """|m|^2, shape (...,)."""
        return _dot(m, m)

    # -- principal axes ----------------------------------------------------------------------------------
    @cached_property
    def _principal(self) -> tuple[list[Scalar], Array]:
        """w_1 <= w_2 <= w_3 (exact for a diagonal tensor) and axes in columns."""
        if self._diagonal:
            rows = self._inverse.to_rows()
            order = sorted(range(3), key=lambda i: rows[i][i])
            axes = np.eye(3)[:, order]
            values = [rows[i][i] for i in order]
        else:
            found, axes = np.linalg.eigh(self.inverse)
            values = [QQ.convert(Fraction(float(x))) for x in found]
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
        om, square = self._inverse, self._inverse @ self._inverse
        trace = om.trace()
        second = (trace**2 - square.trace()) / 2
        return number(trace, dtype), number(second, dtype), number(om.determinant(), dtype)

    def equilibria(self, radius: float = 1.0) -> Array:
        """The equilibria +-e_j on the principal axes, the axis of the largest moment first, shape (6, 3).

        If two moments are equal, every point of the great circle through their axes is an equilibrium too.

        Examples
        --------
        >>> RigidBody([1, 2, 3]).equilibria()[:2].tolist()
        [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
        """
        points: Array = radius * np.stack([self.axes.T, -self.axes.T], axis=1).reshape(6, 3) + 0.0
        return points

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

        Raises
        ------
        InputError
            If two moments are equal, since then there is no separatrix.

        Examples
        --------
        >>> body = RigidBody([1, 2, 3])
        >>> bool(abs(body.rayleigh(body.separatrix(0.3)) - 1 / 2) < 1e-15)
        True
        """
        if branch not in (1, -1):
            raise InputError(f"the branch of a separatrix is 1 or -1, got {branch!r}")
        a1, a2, a3 = self._gaps(np.float64)
        if min(a1, a3) <= 0:
            raise InputError(
                f"a body with the moments {self.moments} has no separatrix: three different ones are needed"
            )
        first, middle, third = self.axes.T
        across = (np.sqrt(a1) * first + branch * np.sqrt(a3) * third) / np.sqrt(a2)
        angles = np.asarray(angle, dtype=float)[..., None]
        points: Array = radius * (np.cos(angles) * middle + np.sin(angles) * across)
        return points

    def _gaps(self, dtype: FloatType) -> tuple[Any, Any, Any]:
        """w_3 - w_2, w_3 - w_1, w_2 - w_1 in a floating type."""
        w1, w2, w3 = self._principal[0]
        return number(w3 - w2, dtype), number(w3 - w1, dtype), number(w2 - w1, dtype)

    # -- exact motion ------------------------------------------------------------------------------------
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

        Raises
        ------
        ShapeError, InputError
            If m0 is not an array of points.

        Examples
        --------
        >>> import numpy as np
        >>> body, m = RigidBody([1, 2, 3]), np.array([0.6, 0.48, 0.64])
        >>> there = body.exact(m, 7.0)
        >>> bool(np.allclose(body.exact(there, -7.0), m, rtol=0, atol=1e-14))
        True
        """
        m = point_of(m0)
        time = np.asarray(t, dtype=m.dtype)
        axes = self.axes.astype(m.dtype)
        return free_motion(m @ axes, self._gaps(m.dtype.type), time) @ axes.T

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

        Raises
        ------
        ShapeError, InputError
            If an argument is not of this form, or Q(0) is not a rotation.

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

    # -- updates -----------------------------------------------------------------------------------------
    def update(self, name: str, exponential: ExponentialLike = "cayley") -> Update:
        """The update (m, dt) -> m of Figure 6 with a name, from its base scheme and the generic corrector.

        Raises
        ------
        InputError
            If no update has this name; the message lists the names.

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


_GENERATORS = ("b", "o")


def number(x: Scalar, dtype: FloatType) -> Any:
    """A rational number rounded to a floating type.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> number(lh.QQ.convert("1/2"), np.float64)
    np.float64(0.5)
    """
    near = QQ.to_float(x)
    return dtype(near) + dtype(remainder(QQ, x, near)) if dtype == np.longdouble else dtype(near)


def point_of(m: npt.ArrayLike) -> Array:
    """Points of R^3 as an array of floats, shape (..., 3).

    Raises
    ------
    ShapeError, InputError
        If they are not points of R^3.

    Examples
    --------
    >>> point_of([1, 0, 0]).tolist()
    [1.0, 0.0, 0.0]
    """
    point = points_of(m)
    if point.ndim == 0 or point.shape[-1] != 3:
        raise ShapeError(f"a point has shape {point.shape}, expected (..., 3)")
    return point


def _dot(a: Values, b: Values) -> Any:
    """<a, b> over the last axis, shape (...,)."""
    return np.sum(a * b, axis=-1)
