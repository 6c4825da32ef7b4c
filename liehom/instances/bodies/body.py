"""Body: what bodies have in common, and BodyState, the state of a body as functions of users see it.

The rows r_1, r_2, r_3 of the attitude Q turn by r_i' = -omega x r_i, omega the angular velocity in the body. The
momentum is stored in space, where it changes by torques and forces only: p' = Q tau. So the group is a product of
rotations, or rigid motions, with translations of the momentum, and a momentum on which nothing acts is constant bit for
bit.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from inspect import Parameter, signature
from typing import Any, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.step import StepLike
from liehom.errors import InputError, ShapeError, displayed
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.exponentials.quaternions import matrix_to_quaternion
from liehom.homogeneous.fields.components import joined
from liehom.integrators import Solution, integrate
from liehom.integrators.arguments import SingleRunOptions
from liehom.representations import Representation
from liehom.typing import Array, Values


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
    >>> from liehom.instances import AttitudeBody
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
    """A body: its generator field, states and views.

    Attributes
    ----------
    field : GeneratorField
    representation : Representation

    Examples
    --------
    >>> import liehom as lh
    >>> isinstance(lh.HeavyTop([1, 1, 2], [0, 0, 1]), Body)
    True
    """

    field: GeneratorField

    @property
    def representation(self) -> Representation:
        """The action on states, a `Representation`."""
        return self.field.representation

    @abstractmethod
    def energy(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """Energy of states, shape (...,)."""

    def points(self, y: npt.ArrayLike | Values | Solution) -> Values:
        """States (..., N) as arrays or Jets; those of a solution, with its times on the next to last axis.

        Raises
        ------
        ShapeError
            If they do not have N coordinates.

        Examples
        --------
        >>> import liehom as lh
        >>> top = lh.HeavyTop([1, 1, 2], [0, 0, 1])
        >>> sol = top.integrate((0, 1), top.start(momentum=[0, 0.1, 2.0]), t_eval=[0, 0.5, 1])
        >>> top.points(sol).shape
        (3, 6)
        """
        if isinstance(y, Solution):
            y = np.swapaxes(y.y, -1, -2)
        made: Any = y if hasattr(y, "shape") else np.asarray(y, dtype=float)
        if not made.shape or made.shape[-1] != self.representation.size:
            raise ShapeError(f"states of shape {made.shape}, expected (..., {self.representation.size})")
        found: Values = made
        return found

    def integrate(
        self,
        t_span: Iterable[float],
        y0: npt.ArrayLike,
        *,
        step: StepLike | None = None,
        dt: npt.ArrayLike | None = None,
        **options: Unpack[SingleRunOptions],
    ) -> Solution:
        """Trajectories of the body: `liehom.integrate` with its field.

        Examples
        --------
        >>> import liehom as lh
        >>> body = lh.AttitudeBody([1, 2, 3])
        >>> sol = body.integrate((0, 10), body.start(momentum=[0.1, 1.0, 0.2]))
        >>> bool(abs(body.energy(sol)[-1] - body.energy(sol)[0]) < 1e-5)
        True
        """
        return integrate(self.field, t_span, y0, step=step, dt=dt, **options)


def along(attitude: Values, v: Values) -> Values:
    """Q v, shape (..., 3), of vectors in the body."""
    made: Values = np.sum(attitude * v[..., None, :], axis=-1)
    return made


def across(attitude: Values, v: Values) -> Values:
    """Q^T v, shape (..., 3), of vectors in space."""
    made: Values = np.sum(attitude * v[..., :, None], axis=-2)
    return made


def quaternions_along(attitude: Values) -> Array:
    """Unit quaternions (..., k, 4) of attitudes (..., k, 3, 3), with signs that continue along the axis of times."""
    q: Any = matrix_to_quaternion(attitude)
    if q.ndim < 2 or q.shape[-2] < 2:
        single: Array = q
        return single
    turned = np.sum(q[..., 1:, :] * q[..., :-1, :], axis=-1) < 0
    signs = np.cumprod(np.where(turned, -1.0, 1.0), axis=-1)
    return np.concatenate([q[..., :1, :], q[..., 1:, :] * signs[..., None]], axis=-2)


def generator_of(
    force: Callable[..., Any], made: Callable[[Values, Callable[[Any], Any]], Values], what: str
) -> Callable[..., Values]:
    """psi with as many parameters as the force, which is a function of (state), (state, t) or (state, t, args).

    `made(y, apply)` is psi at y, where apply(state) calls the force.

    Raises
    ------
    InputError
        If the force has other parameters.
    """
    if not callable(force):
        raise InputError(f"the {what} is a function of (state), (state, t) or (state, t, args), got {displayed(force)}")
    given = list(signature(force).parameters.values())
    needed = [
        p for p in given if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) and p.default is Parameter.empty
    ]
    if len(needed) == 1:
        return lambda y: made(y, force)
    if len(needed) == 2:
        return lambda y, t: made(y, lambda state: force(state, t))
    if len(needed) == 3:
        return lambda y, t, args: made(y, lambda state: force(state, t, args))
    raise InputError(
        f"the {what} has the parameters {signature(force)}: expected (state), (state, t) or (state, t, args)"
    )


def vector_like(value: object, like: Values, what: str, size: int = 3) -> Values:
    """The value of a user's function as an array or Jet of shape (..., size) next to `like`.

    Raises
    ------
    ShapeError
        If it has another number of components.
    """
    made = joined(value, like)
    if not made.shape or made.shape[-1] != size:
        raise ShapeError(f"the {what} has shape {made.shape}, expected (..., {size}): np.stack(parts, axis=-1)")
    found: Values = made
    return found
