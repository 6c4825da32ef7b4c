"""AttitudeBody: attitude and angular momentum of a rigid body under a torque, on SO(3) x R^3.

    Q' = Q hat(Om m),   (Q m)' = Q tau(Q, m, t),   Om = I^-1

The state is the three rows of Q, the momentum Q m in space and, with a torque, the number 1, on which translations act.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import abelian, direct_sum, so
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.maps import FieldMatrix
from liehom.instances.bodies.body import Body, BodyState, across, along, generator_of, quaternions_along, vector_like
from liehom.instances.bodies.inertia import inertia_tensor, rotations
from liehom.integrators import Solution
from liehom.representations import Representation, adjoint
from liehom.typing import Array, Values

FRAMES = ("body", "space")


@cache
def _rotations_and_torques(torque: bool) -> Representation:
    """so(3) on the rows of Q, and with a torque translations of the momentum."""
    turns = [np.kron(np.eye(3, dtype=int), a.to_numpy().astype(int)) for a in adjoint(so(3)).matrices]
    size = 13 if torque else 12
    matrices = np.zeros((6 if torque else 3, size, size), dtype=int)
    matrices[:3, :9, :9] = turns
    for i in range(3 if torque else 0):
        matrices[3 + i, 9 + i, 12] = 1
    algebra = direct_sum(so(3), abelian(3)) if torque else so(3)
    return Representation(algebra, matrices, name="attitude and momentum")


@final
class AttitudeBody(Body):
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

    Raises
    ------
    ShapeError, InputError
        If an argument is not of this form.

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
    >>> body = lh.AttitudeBody([1.0, 2.0, 3.0], lambda s: -0.1 * s.velocity)
    >>> sol = body.integrate((0, 20), body.start([1.0, 0, 0, 0], velocity=[0.1, 0.2, 1.0]))
    >>> bool(body.energy(sol)[-1] < body.energy(sol)[0]), body.quaternion(sol).shape == (sol.t.size, 4)
    (True, True)
    """

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
        tensor = inertia_tensor(inertia)
        self.inertia: Array = tensor.to_numpy()
        self._inertia, self._inverse = FieldMatrix(tensor), FieldMatrix(tensor.inverse())
        self._potential, self._frame = potential, frame
        psi: Any = self._free
        if torque is not None:
            psi = generator_of(torque, self._driven, "torque")
        self.field = GeneratorField(_rotations_and_torques(torque is not None), psi)

    # -- states and views --------------------------------------------------------------------------------
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

        Raises
        ------
        ShapeError, InputError
            If an argument is not of this form.

        Examples
        --------
        >>> AttitudeBody([1, 2, 3]).start(velocity=[0.0, 1.0, 0.0])[9:].tolist()
        [0.0, 2.0, 0.0]
        """
        q = rotations(attitude)
        if (momentum is None) == (velocity is None):
            raise InputError("give the momentum or the velocity in the body, one of the two")
        given = np.asarray(velocity if momentum is None else momentum)
        m: Any = given if given.dtype == np.longdouble else np.asarray(given, dtype=float)
        if m.shape[-1:] != (3,):
            raise ShapeError(f"the momentum or velocity has shape {m.shape}, expected (..., 3)")
        m = self._inertia(m) if momentum is None else m
        lead = np.broadcast_shapes(q.shape[:-2], m.shape[:-1])
        kind = np.result_type(q, m)
        rows = np.broadcast_to(q, (*lead, 3, 3)).reshape((*lead, 9)).astype(kind)
        parts = [rows, np.broadcast_to(along(q, m), (*lead, 3)).astype(kind)]
        if self.representation.size > 12:
            parts.append(np.ones((*lead, 1), dtype=kind))
        return np.concatenate(parts, axis=-1)

    def state(self, y: npt.ArrayLike | Values | Solution) -> BodyState:
        """The `BodyState` of states (..., N), or of all times of a solution."""
        y = self.points(y)
        q = y[..., :9].reshape((*y.shape[:-1], 3, 3))
        m = across(q, y[..., 9:12])
        return BodyState(q, m, self._inverse(m))

    def attitude(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Rotation matrices Q from the body to space, shape (..., 3, 3)."""
        return self.state(y).attitude

    def quaternion(self, y: npt.ArrayLike | Solution) -> Array:
        """Unit quaternions (..., 4) of the attitudes; along the times of a solution their signs are continuous.

        Examples
        --------
        >>> body = AttitudeBody([1, 1, 1])
        >>> sol = body.integrate((0, 2 * np.pi), body.start(velocity=[0, 0, 1.0]), dt=0.1)
        >>> body.quaternion(sol)[-1].round(6).tolist()
        [-1.0, 0.0, 0.0, 0.0]
        """
        found = quaternions_along(self.attitude(y))
        return found + 0.0

    def momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum in the body, shape (..., 3)."""
        return self.state(y).momentum

    def velocity(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular velocity in the body, shape (..., 3)."""
        return self.state(y).velocity

    def space_momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum in space, shape (..., 3): constant without a torque."""
        made: Values = self.points(y)[..., 9:12]
        return made

    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Kinetic energy <m, Om m> / 2, plus the potential if there is one; shape (...,).

        Examples
        --------
        >>> body = AttitudeBody([1, 2, 4])
        >>> body.energy(body.start(momentum=[0.0, 2.0, 0.0]))
        np.float64(1.0)
        """
        state = self.state(y)
        kinetic = np.sum(state.momentum * state.velocity, axis=-1) / 2
        made: Values = kinetic if self._potential is None else kinetic + self._potential(state)
        return made

    # -- private -----------------------------------------------------------------------------------------
    def _free(self, y: Values) -> Values:
        return -self.state(y).velocity

    def _driven(self, y: Values, torque: Callable[[BodyState], Any]) -> Values:
        state = self.state(y)
        tau = vector_like(torque(state), y, "torque")
        force = along(state.attitude, tau) if self._frame == "body" else tau + 0 * state.velocity
        return np.concatenate([-state.velocity, force], axis=-1)

    def __repr__(self) -> str:
        driven = ", with a torque" if self.representation.size > 12 else ""
        return f"<AttitudeBody of inertia {self.inertia.tolist()}{driven}>"
