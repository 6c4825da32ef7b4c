"""The attitude of a free rigid body: Q' = Q hat(Om m) in SO(3) along m' = m x Om m.

With the generator omega_b = -Om m both equations read y' = omega_b x y, for y = m and for each row of Q. So one
rotation moves all of them, points of four copies of R^3 under so(3), and the momentum in space, Q m, is constant to
round-off.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.algebra import so
from liehom.errors import ConvergenceError, InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.integrators.integration import integrate
from liehom.integrators.methods.steps import LieTaylor
from liehom.representations import Representation, adjoint
from liehom.typing import Array

ORDER = 14
RTOL = 1e-14
ROTATION_ATOL = 1e-8


@cache
def _copies() -> Representation:
    """The representation of so(3) on m and the three rows of Q."""
    rho = adjoint(so(3))
    return rho.direct_sum(rho).direct_sum(rho).direct_sum(rho)


def attitude(apply: Callable[[Any], Any], m0: Array, t: npt.ArrayLike, start: npt.ArrayLike | None = None) -> Array:
    """Rotations Q(t), shape (..., k, 3, 3), of the body with m -> Om m given as a function: see `RigidBody.attitude`.

    Examples
    --------
    >>> import numpy as np
    >>> q = attitude(lambda m: 2 * m, np.array([0.0, 0.0, 1.0]), [np.pi / 4])
    >>> np.round(q[0], 12).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    times = np.asarray(t, dtype=m0.dtype)
    if times.ndim != 1 or times.size == 0 or bool(np.any(times > 0) and np.any(times < 0)):
        raise ShapeError(f"the times are {t!r}, expected a list of times that are all of one sign")
    q = np.eye(3) if start is None else np.asarray(start, dtype=m0.dtype)
    if q.shape != (3, 3):
        raise ShapeError(f"the attitude at time 0 has shape {q.shape}, expected (3, 3)")
    if not np.allclose(q @ q.T, np.eye(3), rtol=0, atol=ROTATION_ATOL) or np.linalg.det(q.astype(float)) < 0:
        raise InputError("the attitude at time 0 is not a rotation matrix")
    rows = np.broadcast_to(q.reshape(9), (*m0.shape[:-1], 9)).astype(m0.dtype)
    field = GeneratorField(_copies(), lambda y: -apply(y[..., :3]))
    end = times[-1] if times[-1] != 0 else times[0]
    made: Array
    if end == 0:
        made = np.repeat(rows[..., None], len(times), axis=-1)
    else:
        span, y0 = (0.0, end), np.concatenate([m0, rows], axis=-1)
        found = integrate(field, span, y0, step=LieTaylor(ORDER), rtol=RTOL, atol=RTOL, t_eval=times)
        if not found.success:
            raise ConvergenceError(f"the attitude could not be integrated: {found.message}")
        made = found.y[..., 3:, :]
    return np.swapaxes(made, -1, -2).reshape(*made.shape[:-2], len(times), 3, 3)
