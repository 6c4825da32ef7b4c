"""Exact motion of the free rigid body in principal axes, by Jacobi elliptic functions.

With w_1 <= w_2 <= w_3 the inverse moments, a_1 = w_3 - w_2, a_2 = w_3 - w_1, a_3 = w_2 - w_1, m' = m x Om m reads

    m_1' = a_1 m_2 m_3,   m_2' = -a_2 m_3 m_1,   m_3' = a_3 m_1 m_2,

with the first integrals P = a_2 m_1^2 + a_1 m_2^2, Q = a_3 m_2^2 + a_2 m_3^2 and A = a_1 m_3^2 - a_3 m_1^2. For A > 0

    m_1 = (P/a_2)^(1/2) cn u,  m_2 = -+ (P/a_1)^(1/2) sn u,  m_3 = +- (Q/a_2)^(1/2) dn u,  u = u_0 + (a_1 Q)^(1/2) t,
    k^2 = a_3 P / (a_1 Q),  1 - k^2 = a_2 A / (a_1 Q);

For A < 0 the axes 1 and 3 are exchanged; on the separatrix A = 0 the functions are tanh and sech.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.instances.rigid_body.elliptic import jacobi_elliptic
from liehom.typing import Array


def free_motion(m: Array, gaps: tuple[Any, Any, Any], t: Array) -> Array:
    """Points at time t of the motions through m at time 0, in principal axes, shape (..., 3).

    Parameters
    ----------
    m : array of shape (..., 3)
        Axis 1 is the axis of the largest moment of inertia.
    gaps : (a_1, a_2, a_3)
        Not negative, a_2 = a_1 + a_3.
    t : array of shape (...,)

    Returns
    -------
    array of shape (..., 3)

    Notes
    -----
    The addition theorem is used instead of u_0. Its denominator 1 - k^2 sn^2 u sn^2 u_0 is computed as the sum of
    cn^2 u_0 and sn^2 u_0 dn^2 u, which is accurate next to the separatrix.

    Examples
    --------
    >>> import numpy as np
    >>> m = np.array([0.6, 0.3, 0.8])
    >>> free_motion(m, (0.5, 1.0, 0.5), np.array([0.0, 1.0])).round(3).tolist()
    [[0.6, 0.3, 0.8], [0.618, -0.214, 0.814]]
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
    below = c0 * c0 + s0 * s0 * d * d
    below = np.where(moves, below, 1)
    cn, sn = (c * c0 - s * s0 * d * d0) / below, (s * c0 * d0 + s0 * c * d) / below
    dn = (d * d0 - square * s * s0 * c * c0) / below
    swing = np.where(moves, np.sqrt(p / a2) * cn, swing)
    middle = np.where(moves, -sign * np.sqrt(p / own) * sn, middle)
    circled = np.where(moves, sign * np.sqrt(q / a2) * dn, circled)
    return np.stack([np.where(third, swing, circled), middle, np.where(third, circled, swing)], axis=-1)
