"""Rigid bodies: attitude under a torque, pose under a wrench, and the heavy top."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, ClassVar, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError
from liehom.base.typing import Array, IntegerArray, Values
from liehom.flow.action.components import joined, parameters_like
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.maps import FieldMatrix
from liehom.flow.action.motions import are_rotations, matrix_to_quaternion, quaternion_to_matrix
from liehom.flow.door import QQ, ExactMatrix, LieAlgebra, Representation, abelian, adjoint, direct_sum, so
from liehom.flow.engines.arguments import SingleRunOptions
from liehom.flow.propagation.integration import integrate
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import StepLike

SYMMETRY_RTOL = 1e-10
"""Largest difference of I[i, j] and I[j, i], relative to the largest entry."""
ROTATION_ATOL = 1e-8
"""Largest entry of Q Q^T - 1 for a matrix that is read as a rotation."""


def inertia_tensor(inertia: object, size: int = 3) -> ExactMatrix:
    """The inertia tensor as a matrix over QQ, from its diagonal or its entries."""
    if isinstance(inertia, ExactMatrix):
        return inertia
    entries = np.asarray(inertia, dtype=object)
    if entries.shape == (size,):
        entries = np.diag(entries)
    if entries.shape != (size, size):
        raise ShapeError(f"the inertia has shape {entries.shape}, expected {size} moments or a ({size}, {size}) matrix")
    exact = [[_rational(x) for x in row] for row in entries]
    largest = max(abs(x) for row in exact for x in row)
    for i in range(size):
        for j in range(i + 1, size):
            if abs(exact[i][j] - exact[j][i]) > SYMMETRY_RTOL * largest:
                raise InputError(
                    f"the inertia tensor is not symmetric: I[{i}, {j}] = {entries[i, j]}, I[{j}, {i}] = {entries[j, i]}"
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
    """Rotation matrices (..., 3, 3) from matrices or unit quaternions (..., 4), checked; the identity for None."""
    if attitude is None:
        return np.eye(3)
    q: Array = np.asarray(attitude)
    q = q if q.dtype == np.longdouble else np.asarray(q, dtype=float)
    if q.shape[-1:] == (4,):
        if not np.allclose(np.sum(q * q, axis=-1), 1, rtol=0, atol=ROTATION_ATOL):
            raise InputError("the attitude at time 0 is not a unit quaternion: divide it by its norm")
        return np.asarray(quaternion_to_matrix(q))
    if q.shape[-2:] != (3, 3):
        raise ShapeError(
            f"the attitude at time 0 has shape {q.shape}, expected (..., 3, 3), or (..., 4) for quaternions"
        )
    if not are_rotations(q, ROTATION_ATOL):
        raise InputError("the attitude at time 0 is not a rotation matrix")
    return q


# Body and PosedBody: what bodies have in common, and BodyState, the state of a body as functions of users see it.
#
# The rows r_1, r_2, r_3 of the attitude Q turn by r_i' = -omega x r_i, omega the angular velocity in the body. The
# momentum is stored in space, where it changes by torques and forces only: p' = Q tau. So the group is a product of
# rotations, or rigid motions, with translations of the momentum, and a momentum on which nothing acts is constant bit
# for bit.


@final
@dataclass(frozen=True, slots=True)
class BodyState:
    """A state as torques and potentials see it.

    Attributes
    ----------
    attitude : array or Jet of shape (..., 3, 3)
        Q, from the body to space.
    momentum, velocity : array or Jet of shape (..., 3)
        Angular momentum and angular velocity in the body.

    Examples
    --------
    >>> from liehom.studies.instances import AttitudeBody
    >>> AttitudeBody([1, 2, 4]).state(AttitudeBody([1, 2, 4]).start(momentum=[1.0, 1.0, 1.0])).velocity.tolist()
    [1.0, 0.5, 0.25]
    """

    attitude: Values
    momentum: Values
    velocity: Values

    @property
    def space_momentum(self) -> Values:
        """Angular momentum in space, Q m, shape (..., 3)."""
        return along(self.attitude, self.momentum)


class Body(ABC):
    """A body: its generator field, states and views."""

    field: GeneratorField

    @property
    def representation(self) -> Representation:
        """The action on states, a `Representation`."""
        return self.field.representation

    @abstractmethod
    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Energy of states, shape (...,)."""

    def points(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """States (..., N) as arrays or Jets; those of a solution, with its times on the next to last axis."""
        if isinstance(y, Solution):
            y = np.swapaxes(y.y, -1, -2)
        states: Any = y if hasattr(y, "shape") else np.asarray(y, dtype=float)
        if not states.shape or states.shape[-1] != self.representation.size:
            raise ShapeError(f"states of shape {states.shape}, expected (..., {self.representation.size})")
        return states

    def integrate(
        self,
        t_span: Iterable[float],
        y0: npt.ArrayLike,
        *,
        step: StepLike | None = None,
        dt: npt.ArrayLike | None = None,
        **options: Unpack[SingleRunOptions],
    ) -> Solution:
        """Trajectories of the body: `liehom.integrate` with its field."""
        return integrate(self.field, t_span, y0, step=step, dt=dt, **options)


class PosedBody(Body):
    """A body whose state begins with the rows of its pose: `AttitudeBody` and `SE3Body`."""

    _force: ClassVar[str]
    """Name of the vector that acts on the body."""
    state: Callable[..., Any]
    """The state of the body as its forces see it, for states (..., N) or all times of a solution."""

    def _begin(
        self,
        tensor: ExactMatrix,
        space: Callable[[bool], Representation],
        force: Callable[..., Any] | None,
        potential: Callable[[Any], Any] | None,
    ) -> None:
        self.inertia: Array = tensor.to_numpy()
        self._inertia, self._inverse = FieldMatrix(tensor), FieldMatrix(tensor.inverse())
        self._potential, self._driven = potential, force is not None
        psi: Any = self._free
        if force is not None:

            def forced(y: Values, *rest: object) -> Values:
                return self._forced(y, lambda state: force(state, *rest))

            psi = parameters_like(force, forced, self._force, "state")
        self.field = GeneratorField(space(self._driven), psi)

    def _in_body(self, momentum: npt.ArrayLike | None, velocity: npt.ArrayLike | None) -> Array:
        """The momentum in the body, from itself or the velocity, whichever is not None."""
        if (momentum is None) == (velocity is None):
            raise InputError("give the momentum or the velocity in the body, one of the two")
        vector: Any = np.asarray(velocity if momentum is None else momentum)
        vector = vector if vector.dtype == np.longdouble else vector.astype(float)
        if vector.shape[-1:] != self.inertia.shape[:1]:
            raise ShapeError(f"the momentum or velocity has shape {vector.shape}, expected (..., {len(self.inertia)})")
        return np.asarray(self._inertia(vector)) if momentum is None else vector

    @abstractmethod
    def _forced(self, y: Values, force: Callable[[Any], Any]) -> Values:
        """psi at y with the force."""

    def _free(self, y: Values) -> Values:
        return -self.state(y).velocity

    def attitude(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Rotation matrices Q from the body to space, shape (..., 3, 3)."""
        return self.state(y).attitude

    def quaternion(self, y: npt.ArrayLike | Solution) -> Array:
        """Unit quaternions (..., 4) of the attitudes; along the times of a solution their signs are continuous.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> body = lh.bodies.AttitudeBody([1, 1, 1])
        >>> sol = body.integrate((0, 2 * np.pi), body.start(velocity=[0, 0, 1.0]), dt=0.1)
        >>> body.quaternion(sol)[-1].round(6).tolist()
        [-1.0, 0.0, 0.0, 0.0]
        """
        q: Any = matrix_to_quaternion(self.attitude(y))
        if q.ndim > 1 and q.shape[-2] > 1:
            turned = np.sum(q[..., 1:, :] * q[..., :-1, :], axis=-1) < 0
            signs = np.cumprod(np.where(turned, -1.0, 1.0), axis=-1)
            q = np.concatenate([q[..., :1, :], q[..., 1:, :] * signs[..., None]], axis=-2)
        return q + 0.0

    def momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Momentum in the body: angular, shape (..., 3), and for an `SE3Body` also linear, shape (..., 6)."""
        return self.state(y).momentum

    def velocity(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Velocity in the body: angular, shape (..., 3), and for an `SE3Body` also linear, shape (..., 6)."""
        return self.state(y).velocity

    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Kinetic energy, plus the potential if there is one; shape (...,)."""
        state = self.state(y)
        kinetic = np.sum(state.momentum * state.velocity, axis=-1) / 2
        return kinetic if self._potential is None else kinetic + self._potential(state)

    def __repr__(self) -> str:
        driven = f", with a {self._force}" if self._driven else ""
        return f"<{type(self).__name__} of inertia {self.inertia.tolist()}{driven}>"


def cross_products() -> IntegerArray:
    """The matrices x -> e_i x x, shape (3, 3, 3)."""
    return np.array([a.to_numpy().astype(int) for a in adjoint(so(3)).matrices])


def pose_and_momentum(algebra: LieAlgebra, motions: IntegerArray, driven: bool, name: str) -> Representation:
    """An algebra on the rows of a pose by matrices (k, s, s), and translations of the momentum if driven."""
    k, rows = len(motions), 3 * motions.shape[-1]
    size = rows + k + driven
    matrices = np.zeros((2 * k if driven else k, size, size), dtype=int)
    matrices[:k, :rows, :rows] = np.kron(np.eye(3, dtype=int), motions)
    if driven:
        matrices[range(k, 2 * k), range(rows, rows + k), -1] = 1
        algebra = direct_sum(algebra, abelian(k))
    return Representation(algebra, matrices, name=name)


def along(attitude: Values, v: Values) -> Values:
    """Q v, shape (..., 3), of vectors in the body."""
    return np.sum(attitude * v[..., None, :], axis=-1)


def across(attitude: Values, v: Values) -> Values:
    """Q^T v, shape (..., 3), of vectors in space."""
    return np.sum(attitude * v[..., :, None], axis=-2)


def vector_like(value: object, like: Values, what: str, size: int = 3) -> Values:
    """The value of a user's function as an array or Jet of shape (..., size) next to `like`."""
    vector = joined(value, like)
    if not vector.shape or vector.shape[-1] != size:
        raise ShapeError(f"the {what} has shape {vector.shape}, expected (..., {size}): np.stack(parts, axis=-1)")
    return vector


# AttitudeBody: attitude and angular momentum of a rigid body under a torque, on SO(3) x R^3.
#
#     Q' = Q hat(Om m),   (Q m)' = Q tau(Q, m, t),   Om = I^-1
#
# The state is the three rows of Q, the momentum Q m in space and, with a torque, the number 1, on which translations
# act.

FRAMES = ("body", "space")


@cache
def _space(torque: bool) -> Representation:
    """so(3) on the rows of Q, and with a torque translations of the momentum."""
    return pose_and_momentum(so(3), cross_products(), torque, "attitude and momentum")


@final
class AttitudeBody(PosedBody):
    """A rigid body that turns about a fixed point or its centre of mass, with attitude and angular momentum.

    Parameters
    ----------
    inertia : three positive numbers, or a symmetric positive definite (3, 3) matrix
    torque : callable, optional
        tau(state), tau(state, t) or tau(state, t, args), shape (..., 3), for a `BodyState`, written with numpy
        functions.
    frame : "body" or "space"
        Where the components of the torque are meant.
    potential : callable, optional
        U(state), shape (...,): the potential of the torque, which `energy` adds to the kinetic energy.

    Attributes
    ----------
    field : GeneratorField
        On R^12, or R^13 with a torque: rows of Q, momentum in space, and 1.

    Notes
    -----
    Rows of Q turn by one rotation in every step, so Q stays a rotation to round-off. The component of the momentum in
    space along which a torque has no component is constant to round-off, and without a torque all three are constant
    bit for bit. Isotropy is trivial here: take `LieTaylor` or `RKMK` steps.

    Examples
    --------
    A satellite with a damping torque and a magnet:

    >>> import numpy as np
    >>> import liehom as lh
    >>> body = lh.bodies.AttitudeBody([1.0, 2.0, 3.0], lambda s: -0.1 * s.velocity)
    >>> sol = body.integrate((0, 20), body.start([1.0, 0, 0, 0], velocity=[0.1, 0.2, 1.0]))
    >>> bool(body.energy(sol)[-1] < body.energy(sol)[0]), body.quaternion(sol).shape == (sol.t.size, 4)
    (True, True)
    """

    _force = "torque"

    def __init__(
        self,
        inertia: object,
        torque: Callable[..., Any] | None = None,
        *,
        frame: str = "body",
        potential: Callable[[BodyState], Any] | None = None,
    ) -> None:
        if frame not in FRAMES:
            raise InputError(f"frame is {frame!r}, expected one of {', '.join(map(repr, FRAMES))}")
        self._frame = frame
        self._begin(inertia_tensor(inertia), _space, torque, potential)

    def start(
        self,
        attitude: npt.ArrayLike | None = None,
        *,
        momentum: npt.ArrayLike | None = None,
        velocity: npt.ArrayLike | None = None,
    ) -> Array:
        """States (..., N) with an attitude, and the angular momentum or velocity in the body.

        Parameters
        ----------
        attitude : (..., 3, 3) or (..., 4) array_like, optional
            Rotation matrices, or unit quaternions (w, x, y, z); by default the identity.
        momentum, velocity : (..., 3) array_like
            One of the two.

        Examples
        --------
        >>> AttitudeBody([1, 2, 3]).start(velocity=[0.0, 1.0, 0.0])[9:].tolist()
        [0.0, 2.0, 0.0]
        """
        q = rotations(attitude)
        m = self._in_body(momentum, velocity)
        lead, kind = np.broadcast_shapes(q.shape[:-2], m.shape[:-1]), np.result_type(q, m)
        rows = np.broadcast_to(q, (*lead, 3, 3)).reshape((*lead, 9)).astype(kind)
        one = np.ones((*lead, int(self._driven)), dtype=kind)
        return np.concatenate([rows, np.broadcast_to(along(q, m), (*lead, 3)).astype(kind), one], axis=-1)

    def state(self, y: npt.ArrayLike | Values | Solution) -> BodyState:
        """The `BodyState` of states (..., N), or of all times of a solution."""
        y = self.points(y)
        q = y[..., :9].reshape((*y.shape[:-1], 3, 3))
        m = across(q, y[..., 9:12])
        return BodyState(q, m, self._inverse(m))

    def space_momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum in space, shape (..., 3): constant without a torque."""
        return self.points(y)[..., 9:12]

    def _forced(self, y: Values, force: Callable[[BodyState], Any]) -> Values:
        state = self.state(y)
        tau = vector_like(force(state), y, "torque")
        turning = along(state.attitude, tau) if self._frame == "body" else tau + 0 * state.velocity
        return np.concatenate([-state.velocity, turning], axis=-1)


# HeavyTop is a rigid body with a fixed point in a uniform field of gravity. It moves on coadjoint orbits of se(3).
#
#     m' = m x Om m + w Gamma x chi,   Gamma' = Gamma x Om m,   Om = I^-1
#
# m is the angular momentum and Gamma the upward vertical in the body, chi the vector from the fixed point to the centre
# of mass, w the weight. With (omega, v) = (-Om m, -w chi) the equations read m' = omega x m + v x Gamma, Gamma' = omega
# x Gamma: the coadjoint action of the Euclidean algebra, so |Gamma| and <m, Gamma> are constant to round-off.


@cache
def _coadjoint() -> Representation:
    """(omega, v) on (m, Gamma) by (omega x m + v x Gamma, omega x Gamma)."""
    matrices = np.zeros((6, 6, 6), dtype=int)
    matrices[:3, :3, :3] = matrices[:3, 3:, 3:] = matrices[3:, :3, 3:] = cross_products()
    rho = Representation.from_matrices(matrices)
    return Representation(rho.algebra, rho.matrices, name="momentum and vertical", check=False)


@final
class HeavyTop(Body):
    """A heavy top: angular momentum and vertical in the body.

    Parameters
    ----------
    inertia : three positive numbers, or a symmetric positive definite (3, 3) matrix
        About the fixed point.
    centre : (3,) array_like
        chi, the vector from the fixed point to the centre of mass, in the body.
    weight : float
        w = mass times gravity.

    Attributes
    ----------
    field : GeneratorField
        On R^6, points (m, Gamma). Generic orbits have dimension 4 and isotropy of dimension 2, so steps can be
        corrected (`liehom.Corrected`) and the energy conserved (`liehom.steps.Conserving`).

    Examples
    --------
    A Lagrange top, for which m_3 is constant too:

    >>> import numpy as np
    >>> import liehom as lh
    >>> top = lh.bodies.HeavyTop([1, 1, 2], centre=[0, 0, 1])
    >>> sol = top.integrate((0, 10), top.start(momentum=[0.3, 0, 4.0], vertical=[0.6, 0, 0.8]))
    >>> bool(np.ptp(top.momentum(sol)[:, 2]) < 1e-4), bool(np.ptp(np.sum(top.vertical(sol) ** 2, axis=-1)) < 1e-13)
    (True, True)
    """

    def __init__(self, inertia: object, centre: npt.ArrayLike, weight: float = 1.0) -> None:
        tensor = inertia_tensor(inertia)
        self.inertia: Array = tensor.to_numpy()
        self._tensor, self._inverse = tensor, FieldMatrix(tensor.inverse())
        self.centre: Array = np.asarray(centre, dtype=float)
        if self.centre.shape != (3,) or not bool(np.isfinite(self.centre).all()):
            raise ShapeError(f"the centre of mass is {centre!r}, expected a finite vector of R^3")
        self.weight = float(weight)
        if not np.isfinite(self.weight):
            raise InputError(f"the weight is {weight!r}, expected a finite number")
        self.field = GeneratorField(_coadjoint(), self._generator)

    def start(
        self,
        momentum: npt.ArrayLike,
        vertical: npt.ArrayLike = (0.0, 0.0, 1.0),
        *,
        attitude: npt.ArrayLike | None = None,
    ) -> Array:
        """States (..., 6) with an angular momentum in the body and the vertical, or the attitude that determines it."""
        m = np.asarray(momentum, dtype=float)
        up = np.asarray(vertical, dtype=float) if attitude is None else rotations(attitude)[..., 2, :]
        if m.shape[-1:] != (3,) or up.shape[-1:] != (3,):
            raise ShapeError(f"momentum and vertical have shapes {m.shape} and {up.shape}, expected (..., 3)")
        return np.concatenate(np.broadcast_arrays(m, up), axis=-1)

    def momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum in the body, shape (..., 3)."""
        return self.points(y)[..., :3]

    def vertical(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Gamma, the upward vertical in the body, shape (..., 3)."""
        return self.points(y)[..., 3:]

    def velocity(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular velocity in the body, shape (..., 3)."""
        return self._inverse(self.momentum(y))

    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """<m, Om m>/2 + w <Gamma, chi>, shape (...,)."""
        y = self.points(y)
        m = y[..., :3]
        return np.sum(m * self._inverse(m), axis=-1) / 2 + np.sum(y[..., 3:] * (self.weight * self.centre), axis=-1)

    def vertical_momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """<m, Gamma>, the vertical component of the momentum, constant; shape (...,)."""
        y = self.points(y)
        return np.sum(y[..., :3] * y[..., 3:], axis=-1)

    def with_attitude(self) -> AttitudeBody:
        """The top with its attitude: an `AttitudeBody` under the torque of gravity.

        Examples
        --------
        >>> top = HeavyTop([1, 1, 2], [0, 0, 1])
        >>> body = top.with_attitude()
        >>> sol = body.integrate((0, 1), body.start([1.0, 0, 0, 0], momentum=[0.3, 0, 4.0]), dt=0.1)
        >>> again = top.integrate((0, 1), top.start([0.3, 0, 4.0]), dt=0.1)
        >>> bool(np.allclose(body.attitude(sol)[-1, 2], top.vertical(again)[-1], rtol=0, atol=1e-6))
        True
        """
        weighted = self.weight * self.centre

        def gravity(state: BodyState) -> Values:
            return np.cross(state.attitude[..., 2, :], weighted)

        return AttitudeBody(
            self._tensor, gravity, potential=lambda state: np.sum(state.attitude[..., 2, :] * weighted, axis=-1)
        )

    def _generator(self, y: Values) -> Values:
        m: Any = y[..., :3]
        return np.concatenate([-self._inverse(m), 0 * m - self.weight * self.centre], axis=-1)

    def __repr__(self) -> str:
        return f"<HeavyTop of inertia {self.inertia.tolist()}, centre {self.centre.tolist()}, weight {self.weight}>"


# SE3Body: pose and momentum of a rigid body under a wrench, on SE(3) x R^6.
#
#     Q' = Q hat(omega),   x' = Q v,   (omega, v) = M^-1 (m, p)
#     (Q p)' = Q f,   (Q m + x x Q p)' = Q tau + x x Q f
#
# M is the inertia, a mass and a tensor or a 6 x 6 matrix as for a body in a fluid, (tau, f) the wrench in the body. The
# state is the rows (r_i, x_i) of the pose, the momentum in space and, with a wrench, the number 1.


@cache
def _se3_space(wrench: bool) -> Representation:
    """se(3) on the rows (r_i, x_i) of the pose, and with a wrench translations of the momentum."""
    motions = np.zeros((6, 4, 4), dtype=int)
    motions[:3, :3, :3] = cross_products()
    for i in range(3):  # x_i' = <r_i, v>: the dual of the action on R^4 by homogeneous coordinates
        motions[3 + i, 3, i] = -1
    algebra = Representation.from_matrices(motions).algebra
    return pose_and_momentum(algebra, motions, wrench, "pose and momentum")


@final
@dataclass(frozen=True, slots=True)
class PoseState:
    """A state as wrenches and potentials see it.

    Attributes
    ----------
    attitude : array or Jet of shape (..., 3, 3)
        Q, from the body to space.
    position : array or Jet of shape (..., 3)
        x, in space.
    momentum, velocity : array or Jet of shape (..., 6)
        (m, p) and (omega, v) in the body: angular parts first.

    Examples
    --------
    >>> body = SE3Body([1, 1, 1], mass=2.0)
    >>> body.state(body.start(momentum=[0, 0, 0, 4.0, 0, 0])).velocity.tolist()
    [0.0, 0.0, 0.0, 2.0, 0.0, 0.0]
    """

    attitude: Values
    position: Values
    momentum: Values
    velocity: Values


@final
class SE3Body(PosedBody):
    """A rigid body that moves freely, with pose and momentum.

    Parameters
    ----------
    inertia : three positive numbers, or a symmetric positive definite (3, 3) or (6, 6) matrix
        A (6, 6) matrix acts on (omega, v), as for a body in an ideal fluid, and contains the mass.
    wrench : callable, optional
        (tau, f)(state), (state, t) or (state, t, args), shape (..., 6), in the body, for a `PoseState`, written with
        numpy functions.
    mass : float, optional
        By default 1; not for a (6, 6) inertia.
    potential : callable, optional
        U(state), shape (...,), which `energy` adds to the kinetic energy.

    Attributes
    ----------
    field : GeneratorField
        On R^18, or R^19 with a wrench.

    Examples
    --------
    A quadrotor that hovers: thrust against gravity, both in the body.

    >>> import numpy as np
    >>> import liehom as lh
    >>> def wrench(s):
    ...     down = -9.81 * s.attitude[..., 2, :]
    ...     return np.concatenate([-0.1 * s.velocity[..., :3], down + np.array([0.0, 0.0, 9.81])], axis=-1)
    ...
    >>> body = lh.bodies.SE3Body([0.02, 0.02, 0.04], wrench)
    >>> sol = body.integrate((0, 1), body.start(velocity=[0, 0, 0.3, 0, 0, 0]), dt=0.05)
    >>> bool(np.abs(body.position(sol)).max() < 1e-12), body.pose(sol).shape
    (True, (21, 4, 4))
    """

    _force = "wrench"

    def __init__(
        self,
        inertia: object,
        wrench: Callable[..., Any] | None = None,
        *,
        mass: float | None = None,
        potential: Callable[[PoseState], Any] | None = None,
    ) -> None:
        if np.shape(np.asarray(inertia, dtype=object)) == (6, 6):
            if mass is not None:
                raise InputError("a (6, 6) inertia contains the mass: leave mass out")
            blocks = inertia
        else:
            blocks = np.diag(np.array([0, 0, 0] + 3 * [1.0 if mass is None else mass], dtype=object))
            blocks[:3, :3] = np.array(inertia_tensor(inertia).to_rows(), dtype=object)
        self._begin(inertia_tensor(blocks, 6), _se3_space, wrench, potential)

    def start(
        self,
        attitude: npt.ArrayLike | None = None,
        position: npt.ArrayLike = (0.0, 0.0, 0.0),
        *,
        momentum: npt.ArrayLike | None = None,
        velocity: npt.ArrayLike | None = None,
    ) -> Array:
        """States (..., N) with attitude, position, and the momentum or velocity (..., 6) in the body."""
        mu = self._in_body(momentum, velocity)
        q, x = rotations(attitude), np.asarray(position, dtype=float)
        if x.shape[-1:] != (3,):
            raise ShapeError(f"the position has shape {x.shape}, expected (..., 3)")
        lead = np.broadcast_shapes(q.shape[:-2], x.shape[:-1], mu.shape[:-1])
        q, x = np.broadcast_to(q, (*lead, 3, 3)), np.broadcast_to(x, (*lead, 3))
        linear: Any = along(q, mu[..., 3:])
        rows = np.concatenate([q, x[..., None]], axis=-1).reshape((*lead, 12))
        angular = along(q, mu[..., :3]) + np.cross(x, linear)
        return np.concatenate([rows, angular, linear, np.ones((*lead, int(self._driven)))], axis=-1)

    def state(self, y: npt.ArrayLike | Values | Solution) -> PoseState:
        """The `PoseState` of states (..., N), or of all times of a solution."""
        y = self.points(y)
        rows = y[..., :12].reshape((*y.shape[:-1], 3, 4))
        q, x, linear = rows[..., :3], rows[..., 3], y[..., 15:18]
        mu = np.concatenate([across(q, y[..., 12:15] - np.cross(x, linear)), across(q, linear)], axis=-1)
        return PoseState(q, x, mu, self._inverse(mu))

    def position(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Position in space, shape (..., 3)."""
        return self.state(y).position

    def pose(self, y: npt.ArrayLike | Solution) -> Array:
        """Homogeneous matrices (..., 4, 4) of the pose."""
        state = self.state(y)
        pose = np.zeros((*state.position.shape[:-1], 4, 4))
        pose[..., :3, :3], pose[..., :3, 3], pose[..., 3, 3] = state.attitude, state.position, 1.0
        return pose

    def space_momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum about the origin and linear momentum in space, (..., 6): constant without a wrench."""
        return self.points(y)[..., 12:18]

    def _forced(self, y: Values, force: Callable[[PoseState], Any]) -> Values:
        state = self.state(y)
        wrench = vector_like(force(state), y, "wrench", 6)
        linear = along(state.attitude, wrench[..., 3:])
        torque = along(state.attitude, wrench[..., :3]) + np.cross(state.position, linear)
        return np.concatenate([-state.velocity, torque, linear], axis=-1)
