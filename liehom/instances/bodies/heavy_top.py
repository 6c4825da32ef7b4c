"""HeavyTop: a rigid body with a fixed point in a uniform field of gravity, on coadjoint orbits of se(3).

    m' = m x Om m + w Gamma x chi,   Gamma' = Gamma x Om m,   Om = I^-1

m is the angular momentum and Gamma the upward vertical in the body, chi the vector from the fixed point to the centre
of mass, w the weight. With (omega, v) = (-Om m, -w chi) the equations read m' = omega x m + v x Gamma, Gamma' = omega x
Gamma: the coadjoint action of the Euclidean algebra, so |Gamma| and <m, Gamma> are constant to round-off.
"""

from __future__ import annotations

from functools import cache
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.maps import FieldMatrix
from liehom.instances.bodies.attitude_body import AttitudeBody
from liehom.instances.bodies.body import Body, BodyState
from liehom.instances.bodies.inertia import inertia_tensor, rotations
from liehom.integrators import Solution
from liehom.representations import Representation, adjoint
from liehom.typing import Array, Values


@cache
def _coadjoint() -> Representation:
    """(omega, v) on (m, Gamma) by (omega x m + v x Gamma, omega x Gamma)."""
    cross = np.array([a.to_numpy().astype(int) for a in adjoint(so(3)).matrices])
    matrices = np.zeros((6, 6, 6), dtype=int)
    matrices[:3, :3, :3] = matrices[:3, 3:, 3:] = matrices[3:, :3, 3:] = cross
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
        corrected (`liehom.Corrected`) and the energy conserved (`liehom.correctors.Conserving`).

    Raises
    ------
    ShapeError, InputError
        If an argument is not of this form.

    Examples
    --------
    A Lagrange top, for which m_3 is constant too:

    >>> import numpy as np
    >>> import liehom as lh
    >>> top = lh.HeavyTop([1, 1, 2], centre=[0, 0, 1])
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
        """States (..., 6) with an angular momentum in the body and the vertical, or the attitude that determines it.

        Raises
        ------
        ShapeError
            If an argument is not of this form.

        Examples
        --------
        >>> HeavyTop([1, 1, 2], [0, 0, 1]).start([0, 0, 1.0]).tolist()
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]
        """
        m = np.asarray(momentum, dtype=float)
        up = np.asarray(vertical, dtype=float) if attitude is None else rotations(attitude)[..., 2, :]
        if m.shape[-1:] != (3,) or up.shape[-1:] != (3,):
            raise ShapeError(f"momentum and vertical have shapes {m.shape} and {up.shape}, expected (..., 3)")
        m, up = np.broadcast_arrays(m, up)
        return np.concatenate([m, up], axis=-1)

    def momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular momentum in the body, shape (..., 3)."""
        made: Values = self.points(y)[..., :3]
        return made

    def vertical(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Gamma, the upward vertical in the body, shape (..., 3)."""
        made: Values = self.points(y)[..., 3:]
        return made

    def velocity(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Angular velocity in the body, shape (..., 3)."""
        return self._inverse(self.momentum(y))

    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """<m, Om m>/2 + w <Gamma, chi>, shape (...,).

        Examples
        --------
        >>> HeavyTop([1, 1, 2], [0, 0, 3]).energy([0, 2.0, 0, 0, 0, 1.0])
        np.float64(5.0)
        """
        y = self.points(y)
        m = y[..., :3]
        made: Values = np.sum(m * self._inverse(m), axis=-1) / 2 + np.sum(
            y[..., 3:] * (self.weight * self.centre), axis=-1
        )
        return made

    def vertical_momentum(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """<m, Gamma>, the vertical component of the momentum, constant; shape (...,)."""
        y = self.points(y)
        made: Values = np.sum(y[..., :3] * y[..., 3:], axis=-1)
        return made

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
