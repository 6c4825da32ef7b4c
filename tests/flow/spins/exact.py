"""One spin in closed form: in a constant field, and the time in which it switches.

    m' = -g m x H - a g m x (m x H),   g = gamma/(1 + a^2)

With p = <m, H>/|H| and u = a g |H| t, the component along the field is tanh(artanh(p) + u). The component across it
turns by the angle g |H| t and has the length 1/cosh(artanh(p) + u).
"""

from typing import Any

import numpy as np


def macrospin(m0: Any, field: Any, t: Any, *, damping: float = 0.0, gyromagnetic: float = 1.0) -> Any:
    """The spin at time t in a constant field, shape (..., 3)."""
    spin, h = np.asarray(m0, dtype=float), np.asarray(field, dtype=float)
    size = np.linalg.norm(h, axis=-1)
    n = h / np.where(size > 0, size, 1.0)[..., None]
    angle = gyromagnetic / (1 + damping**2) * size * t
    u = damping * angle
    p = np.sum(spin * n, axis=-1)
    across = spin - p[..., None] * n
    # tanh(artanh(p) + u) = s (a - b e)/(a + b e); the smaller of a and b comes from the component across the field
    s = np.where(u < 0, -1.0, 1.0)
    square = np.sum(across * across, axis=-1)
    a, b = 1 + s * p, 1 - s * p
    a, b = np.where(s * p < 0, square / np.maximum(b, 1), a), np.where(s * p < 0, b, square / np.maximum(a, 1))
    e = np.maximum(np.exp(-2 * np.abs(u)), np.finfo(float).tiny)
    turned = np.cos(angle)[..., None] * across + np.sin(angle)[..., None] * np.cross(n, spin)
    return (s * (a - b * e) / (a + b * e))[..., None] * n + (2 * np.sqrt(e) / (a + b * e))[..., None] * turned


def switching_time(
    start: float, end: float, *, field: float, anisotropy: float = 0.0, damping: float, gyromagnetic: float = 1.0
) -> float:
    """The time in which z = m.e goes from one value to another, by z' = a g (1 - z^2)(H + 2 K z), |H| != 2 |K|."""
    h, k = field, anisotropy

    def integral(z: float) -> Any:
        outer = -np.log1p(-z) / (2 * (h + 2 * k)) + np.log1p(z) / (2 * (h - 2 * k))
        return outer + (2 * k / (4 * k * k - h * h) * np.log(abs(h + 2 * k * z)) if k else 0.0)

    return float((integral(end) - integral(start)) * (1 + damping**2) / (damping * gyromagnetic))
