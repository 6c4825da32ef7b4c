"""SE3Body: pose and momentum of a rigid body under a wrench, on SE(3) x R^6.

    Q' = Q hat(omega),   x' = Q v,   (omega, v) = M^-1 (m, p)
    (Q p)' = Q f,   (Q m + x x Q p)' = Q tau + x x Q f

M is the inertia, a mass and a tensor or a 6 x 6 matrix as for a body in a fluid, (tau, f) the wrench in the body. The
state is the rows (r_i, x_i) of the pose, the momentum in space and, with a wrench, the number 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import abelian, direct_sum, so
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.maps import FieldMatrix
from liehom.instances.bodies.body import Body, across, along, generator_of, quaternions_along, vector_like
from liehom.instances.bodies.inertia import inertia_tensor, rotations
from liehom.integrators import Solution
from liehom.representations import Representation, adjoint
from liehom.typing import Array, Values


@cache
def _motions_and_wrenches(wrench: bool) -> Representation:
    """se(3) on the rows (r_i, x_i) of the pose, and with a wrench translations of the momentum."""
    size = 19 if wrench else 18
    motions = np.zeros((6, 4, 4), dtype=int)
    motions[:3, :3, :3] = [a.to_numpy().astype(int) for a in adjoint(so(3)).matrices]
    for i in range(3):  # x_i' = <r_i, v>: the dual of the action on R^4 by homogeneous coordinates
        motions[3 + i, 3, i] = -1
    matrices = np.zeros((12 if wrench else 6, size, size), dtype=int)
    matrices[:6, :12, :12] = [np.kron(np.eye(3, dtype=int), a) for a in motions]
    for i in range(6 if wrench else 0):
        matrices[6 + i, 12 + i, 18] = 1
    algebra = Representation.from_matrices(motions).algebra
    return Representation(direct_sum(algebra, abelian(6)) if wrench else algebra, matrices, name="pose and momentum")


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
class SE3Body(Body):
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

    Raises
    ------
    ShapeError, InputError
        If an argument is not of this form.

    Examples
    --------
    A quadrotor that hovers: thrust against gravity, both in the body.

    >>> import numpy as np
    >>> import liehom as lh
    >>> def wrench(s):
    ...     down = -9.81 * s.attitude[..., 2, :]
    ...     return np.concatenate([-0.1 * s.velocity[..., :3], down + np.array([0.0, 0.0, 9.81])], axis=-1)
    ...
    >>> body = lh.SE3Body([0.02, 0.02, 0.04], wrench)
    >>> sol = body.integrate((0, 1), body.start(velocity=[0, 0, 0.3, 0, 0, 0]), dt=0.05)
    >>> bool(np.abs(body.position(sol)).max() < 1e-12), body.pose(sol).shape
    (True, (21, 4, 4))
    """

    def __init__(
        self,
        inertia: object,
        wrench: Callable[..., Any] | None = None,
        *,
        mass: float | None = None,
        potential: Callable[[PoseState], Any] | None = None,
    ) -> None:
        given = np.asarray(inertia, dtype=object)
        if given.shape == (6, 6):
            if mass is not None:
                raise InputError("a (6, 6) inertia contains the mass: leave mass out")
            tensor = inertia_tensor(inertia, 6)
        else:
            own = inertia_tensor(inertia)
            whole = np.diag(np.array([0, 0, 0] + 3 * [1.0 if mass is None else mass], dtype=object))
            whole[:3, :3] = np.array(own.to_rows(), dtype=object)
            tensor = inertia_tensor(whole, 6)
        self.inertia: Array = tensor.to_numpy()
        self._inertia, self._inverse = FieldMatrix(tensor), FieldMatrix(tensor.inverse())
        self._potential = potential
        psi: Any = self._free if wrench is None else generator_of(wrench, self._driven, "wrench")
        self.field = GeneratorField(_motions_and_wrenches(wrench is not None), psi)

    # -- states and views --------------------------------------------------------------------------------
    def start(
        self,
        attitude: npt.ArrayLike | None = None,
        position: npt.ArrayLike = (0.0, 0.0, 0.0),
        *,
        momentum: npt.ArrayLike | None = None,
        velocity: npt.ArrayLike | None = None,
    ) -> Array:
        """States (..., N) with attitude, position, and the momentum or velocity (..., 6) in the body.

        Raises
        ------
        ShapeError, InputError
            If an argument is not of this form.

        Examples
        --------
        >>> SE3Body([1, 2, 3]).start(position=[1.0, 0, 0], velocity=[0, 0, 0, 0, 1.0, 0])[12:].tolist()
        [0.0, 0.0, 1.0, 0.0, 1.0, 0.0]
        """
        if (momentum is None) == (velocity is None):
            raise InputError("give the momentum or the velocity in the body, one of the two")
        q, x = rotations(attitude), np.asarray(position, dtype=float)
        mu: Any = np.asarray(velocity if momentum is None else momentum, dtype=float)
        if mu.shape[-1:] != (6,) or x.shape[-1:] != (3,):
            raise ShapeError(f"momentum or velocity {mu.shape} and position {x.shape}, expected (..., 6) and (..., 3)")
        mu = self._inertia(mu) if momentum is None else mu
        lead = np.broadcast_shapes(q.shape[:-2], x.shape[:-1], mu.shape[:-1])
        q, x = np.broadcast_to(q, (*lead, 3, 3)), np.broadcast_to(x, (*lead, 3))
        linear: Any = along(q, mu[..., 3:])
        parts: list[Any] = [np.concatenate([q, x[..., None]], axis=-1).reshape((*lead, 12))]
        parts += [along(q, mu[..., :3]) + np.cross(x, linear), linear]
        if self.representation.size > 18:
            parts.append(np.ones((*lead, 1)))
        return np.concatenate(parts, axis=-1)

    def state(self, y: npt.ArrayLike | Values | Solution) -> PoseState:
        """The `PoseState` of states (..., N), or of all times of a solution."""
        y = self.points(y)
        rows = y[..., :12].reshape((*y.shape[:-1], 3, 4))
        q, x, linear = rows[..., :3], rows[..., 3], y[..., 15:18]
        mu = np.concatenate([across(q, y[..., 12:15] - np.cross(x, linear)), across(q, linear)], axis=-1)
        return PoseState(q, x, mu, self._inverse(mu))

    def attitude(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Rotation matrices Q from the body to space, shape (..., 3, 3)."""
        return self.state(y).attitude

    def quaternion(self, y: npt.ArrayLike | Solution) -> Array:
        """Unit quaternions (..., 4) of the attitudes; along the times of a solution their signs are continuous."""
        return quaternions_along(self.attitude(y))

    def position(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Position in space, shape (..., 3)."""
        return self.state(y).position

    def pose(self, y: npt.ArrayLike | Solution) -> Array:
        """Homogeneous matrices (..., 4, 4) of the pose.

        Examples
        --------
        >>> body = SE3Body([1, 1, 1])
        >>> body.pose(body.start(position=[1.0, 2, 3], momentum=np.zeros(6)))[:, 3].tolist()
        [1.0, 2.0, 3.0, 1.0]
        """
        state = self.state(y)
        made = np.zeros((*state.position.shape[:-1], 4, 4))
        made[..., :3, :3], made[..., :3, 3], made[..., 3, 3] = state.attitude, state.position, 1.0
        return made

    def momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """(m, p), angular and linear momentum in the body, shape (..., 6)."""
        return self.state(y).momentum

    def velocity(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """(omega, v), the twist in the body, shape (..., 6)."""
        return self.state(y).velocity

    def space_momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum about the origin and linear momentum in space, (..., 6): constant without a wrench."""
        made: Values = self.points(y)[..., 12:18]
        return made

    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Kinetic energy, plus the potential if there is one; shape (...,).

        Examples
        --------
        >>> body = SE3Body([1, 2, 3], mass=2.0)
        >>> body.energy(body.start(velocity=[0, 1.0, 0, 1.0, 0, 0]))
        np.float64(2.0)
        """
        state = self.state(y)
        kinetic = np.sum(state.momentum * state.velocity, axis=-1) / 2
        made: Values = kinetic if self._potential is None else kinetic + self._potential(state)
        return made

    # -- private -----------------------------------------------------------------------------------------
    def _free(self, y: Values) -> Values:
        return -self.state(y).velocity

    def _driven(self, y: Values, wrench: Callable[[PoseState], Any]) -> Values:
        state = self.state(y)
        given = vector_like(wrench(state), y, "wrench", 6)
        force = along(state.attitude, given[..., 3:])
        torque = along(state.attitude, given[..., :3]) + np.cross(state.position, force)
        return np.concatenate([-state.velocity, torque, force], axis=-1)

    def __repr__(self) -> str:
        driven = ", with a wrench" if self.representation.size > 18 else ""
        return f"<SE3Body of inertia {self.inertia.tolist()}{driven}>"
