"""The macrospin: one spin in a constant field, with damping, solved in closed form.

    m' = -g m x H - a g m x (m x H),   g = gamma/(1 + a^2)

With p = <m, H>/|H| and u = a g |H| t, the component along the field is tanh(artanh(p) + u). The component across it
turns by the angle g |H| t and has the length 1/cosh(artanh(p) + u).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError
from liehom.typing import Array


def macrospin(
    m0: npt.ArrayLike,
    field: npt.ArrayLike,
    t: npt.ArrayLike,
    *,
    damping: npt.ArrayLike = 0.0,
    gyromagnetic: npt.ArrayLike = 1.0,
) -> Array:
    """The spin at time t in a constant field, in closed form, shape (..., 3).

    Parameters
    ----------
    m0 : (..., 3) array_like
        Unit vectors, the spins at time 0.
    field : (..., 3) array_like
        H.
    t, damping, gyromagnetic : float or array_like of shape (...,)
        Time, alpha and gamma of `LandauLifshitz`. All arguments are broadcast.

    Returns
    -------
    array of shape (..., 3)

    Raises
    ------
    ShapeError
        If m0 or the field has no last axis of length 3.

    Examples
    --------
    A quarter of a turn, counterclockwise about the field; and a spin that switches:

    >>> import numpy as np
    >>> macrospin([1.0, 0.0, 0.0], [0.0, 0.0, 2.0], np.pi / 4).round(12) + 0.0
    array([0., 1., 0.])
    >>> bool(macrospin([0.1, 0.0, -np.sqrt(0.99)], [0.0, 0.0, 1.0], 80.0, damping=0.1)[2] > 0.999)
    True
    """
    spin, h = np.asarray(m0, dtype=float), np.asarray(field, dtype=float)
    if spin.shape[-1:] != (3,) or h.shape[-1:] != (3,):
        raise ShapeError(f"a spin of shape {spin.shape} in a field of shape {h.shape}, expected (..., 3) for both")
    alpha, time = np.asarray(damping, dtype=float), np.asarray(t, dtype=float)
    size = np.linalg.norm(h, axis=-1)
    n = h / np.where(size > 0, size, 1.0)[..., None]
    angle = np.asarray(gyromagnetic, dtype=float) / (1 + alpha**2) * size * time
    u = alpha * angle
    p = np.sum(spin * n, axis=-1)
    across = spin - p[..., None] * n
    # tanh(artanh(p) + u) = s (a - b e)/(a + b e); the smaller of a and b comes from the component across the field
    s = np.where(u < 0, -1.0, 1.0)
    square = np.sum(across * across, axis=-1)
    a, b = 1 + s * p, 1 - s * p
    a, b = np.where(s * p < 0, square / np.maximum(b, 1), a), np.where(s * p < 0, b, square / np.maximum(a, 1))
    e = np.maximum(np.exp(-2 * np.abs(u)), np.finfo(float).tiny)
    turned = np.cos(angle)[..., None] * across + np.sin(angle)[..., None] * np.cross(n, spin)
    made: Array = (s * (a - b * e) / (a + b * e))[..., None] * n + (2 * np.sqrt(e) / (a + b * e))[..., None] * turned
    return made


def switching_time(
    start: float, end: float, *, field: float, anisotropy: float = 0.0, damping: float, gyromagnetic: float = 1.0
) -> float:
    """The time in which m.e goes from one value to another, in a field H along the easy axis e, a float.

    Parameters
    ----------
    start, end : float
        Between -1 and 1, both excluded.
    field, anisotropy : float
        H and K of `LandauLifshitz`, with |H| != 2 |K|.
    damping, gyromagnetic : float

    Raises
    ------
    InputError
        If m.e does not reach the value, or a number is out of range.

    Notes
    -----
    With z = m.e the equation is z' = a g (1 - z^2)(H + 2 K z), and the time is an integral of partial fractions. It is
    negative if m.e had the second value before the first one.

    Examples
    --------
    Without anisotropy it is artanh; with H < 2 K a spin close to -e does not switch:

    >>> import numpy as np
    >>> t = switching_time(-0.5, 0.5, field=2.0, damping=0.1)
    >>> bool(np.isclose(t, 2 * np.arctanh(0.5) * 1.01 / (0.1 * 2.0)))
    True
    >>> switching_time(-0.9, 0.9, field=1.0, anisotropy=1.0, damping=0.1)
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: m.e does not go from -0.9 to 0.9: it stays on its side of -0.5
    """
    if not (-1 < start < 1 and -1 < end < 1):
        raise InputError(f"start and end are {start} and {end}, expected numbers between -1 and 1, both excluded")
    h, k = float(field), float(anisotropy)
    if abs(h) == abs(2 * k) or damping == 0 or gyromagnetic == 0:
        raise InputError("there is no such formula for |H| = 2 |K|, and no switching without damping")
    if (h + 2 * k * start) * (h + 2 * k * end) <= 0:
        raise InputError(f"m.e does not go from {start} to {end}: it stays on its side of {-h / (2 * k):.6g}")

    def integral(z: float) -> float:
        made = -np.log1p(-z) / (2 * (h + 2 * k)) + np.log1p(z) / (2 * (h - 2 * k))
        return float(made + (2 * k / (4 * k * k - h * h) * np.log(abs(h + 2 * k * z)) if k else 0.0))

    return (integral(end) - integral(start)) * (1 + damping**2) / (damping * gyromagnetic)
