"""The attitude of a free rigid body: Q' = Q hat(Om m) in SO(3) along m' = m x Om m, at given times."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import ConvergenceError, ShapeError
from liehom.instances.bodies.attitude_body import AttitudeBody
from liehom.integrators.methods.steps import LieTaylor
from liehom.typing import Array

ORDER = 14
RTOL = 1e-14


def attitude(body: AttitudeBody, m0: Array, t: npt.ArrayLike, start: npt.ArrayLike | None = None) -> Array:
    """Rotations Q(t), shape (..., k, 3, 3), of a free body: see `RigidBody.attitude`.

    Examples
    --------
    >>> import numpy as np
    >>> q = attitude(AttitudeBody([0.5, 0.5, 0.5]), np.array([0.0, 0.0, 1.0]), [np.pi / 4])
    >>> np.round(q[0], 12).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    times = np.asarray(t, dtype=m0.dtype)
    if times.ndim != 1 or times.size == 0 or bool(np.any(times > 0) and np.any(times < 0)):
        raise ShapeError(f"the times are {t!r}, expected a list of times that are all of one sign")
    if start is not None and np.shape(start) != (3, 3):
        raise ShapeError(f"the attitude at time 0 has shape {np.shape(start)}, expected (3, 3)")
    y0 = body.start(None if start is None else np.asarray(start, dtype=m0.dtype), momentum=m0)
    end = times[-1] if times[-1] != 0 else times[0]
    if end == 0:
        made: Array = np.repeat(body.attitude(y0)[..., None, :, :], len(times), axis=-3)
        return made
    found = body.integrate((0.0, end), y0, step=LieTaylor(ORDER), rtol=RTOL, atol=RTOL, t_eval=times)
    if not found.success:
        raise ConvergenceError(f"the attitude could not be integrated: {found.message}")
    rotations: Any = body.attitude(found)
    turned: Array = rotations
    return turned
