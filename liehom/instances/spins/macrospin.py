"""The macrospin: one spin in a constant field, with damping, solved in closed form.

    m' = -g m x H - a g m x (m x H),   g = gamma/(1 + a^2)

With p = <m, H>/|H| and u = a g |H| t the part along the field is tanh(artanh(p) + u), the part across it turns by the
angle g |H| t and has the length of 1/cosh.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.errors import InputError, ShapeError


def macrospin(m0: Any, field: Any, t: Any, *, damping: Any = 0.0, gyromagnetic: Any = 1.0) -> Any:
    """The spin at time t in a constant field.

    Parameters
    ----------
    m0 : (..., 3) array_like
        Unit vectors.
    field : (..., 3) array_like
        H.
    t, damping, gyromagnetic : float or array_like of shape (...,)
        Conventions of `LandauLifshitz`. All broadcast.

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
    m0, field = np.asarray(m0, dtype=float), np.asarray(field, dtype=float)
    if m0.shape[-1:] != (3,) or field.shape[-1:] != (3,):
        raise ShapeError(f"a spin of shape {m0.shape} in a field of shape {field.shape}, expected (..., 3) for both")
    damping, t = np.asarray(damping, dtype=float), np.asarray(t, dtype=float)
    size = np.linalg.norm(field, axis=-1)
    n = field / np.where(size > 0, size, 1.0)[..., None]
    angle = np.asarray(gyromagnetic, dtype=float) / (1 + damping**2) * size * t
    u = damping * angle
    p = np.sum(m0 * n, axis=-1)
    across = m0 - p[..., None] * n
    # tanh(artanh(p) + u) = s (a - b e)/(a + b e); the smaller one of a and b from the part across the field
    s = np.where(u < 0, -1.0, 1.0)
    square = np.sum(across * across, axis=-1)
    a, b = 1 + s * p, 1 - s * p
    a, b = np.where(s * p < 0, square / np.maximum(b, 1), a), np.where(s * p < 0, b, square / np.maximum(a, 1))
    e = np.maximum(np.exp(-2 * np.abs(u)), np.finfo(float).tiny)
    turned = np.cos(angle)[..., None] * across + np.sin(angle)[..., None] * np.cross(n, m0)
    return (s * (a - b * e) / (a + b * e))[..., None] * n + (2 * np.sqrt(e) / (a + b * e))[..., None] * turned


def switching_time(
    start: float, end: float, *, field: float, anisotropy: float = 0.0, damping: float, gyromagnetic: float = 1.0
) -> float:
    """The time in which m.e goes from one value to another, in a field H along the easy axis e.

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
        If the spin does not go there, or a number is out of range.

    Notes
    -----
    With z = m.e the equation is z' = a g (1 - z^2)(H + 2 K z), and the time an integral of partial fractions. Negative
    times are before the start.

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
