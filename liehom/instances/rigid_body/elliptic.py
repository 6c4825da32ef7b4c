"""Jacobi elliptic functions sn, cn, dn of a modulus and its complement, in float64 or longdouble.

For k^2 <= 1/2 they are quotients of theta functions in the nome q. For k^2 > 1/2 they are sums over the images under
the imaginary period, which are sech and tanh in the limit k = 1:

    dn = (pi/2K') sum sech(x_n),   k cn = (pi/2K') sum (-1)^n sech(x_n),   k sn = (pi/2K') sum (-1)^n tanh(x_n),

x_n = pi (u - 2 n K)/(2 K'). Next to k = 1 the modulus alone does not determine the period, because 1 - k^2 is lost in
the round-off of k^2.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.typing import Array

MEAN_ITERATIONS = 24  # of the arithmetic-geometric mean: enough for k' = 1e-300
THETA_TERMS = 6  # terms are q^(n^2) with q <= exp(-pi)
IMAGE_TERMS = 16  # terms are about exp(-pi n): enough for extended precision


def jacobi_elliptic(u: npt.ArrayLike, square: npt.ArrayLike, complement: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """sn(u), cn(u), dn(u) for the modulus k with k^2 = `square`, 1 - k^2 = `complement`.

    Parameters
    ----------
    u, square, complement : arrays that broadcast
        k^2 and 1 - k^2 lie between 0 and 1; the smaller one determines the accuracy.

    Returns
    -------
    sn, cn, dn : arrays

    Notes
    -----
    [NIST] 22.2 and 22.12. Absolute errors are a few units of round-off of max(1, |u|). Next to k = 1, cn and dn are
    also relatively accurate away from their zeros.

    Examples
    --------
    >>> import numpy as np
    >>> sn, cn, dn = jacobi_elliptic(0.5, 0.0, 1.0)
    >>> bool(abs(sn - np.sin(0.5)) < 1e-15), float(dn)
    (True, 1.0)
    >>> sn, cn, dn = jacobi_elliptic(0.5, 1.0, 0.0)
    >>> bool(abs(sn - np.tanh(0.5)) < 1e-15), bool(cn == dn)
    (True, True)
    """
    given: Any = np.broadcast_arrays(*(np.asarray(x) for x in (u, square, complement)))
    kind = np.result_type(*given, np.float64)
    argument, k2, rest_of_k2 = (x.astype(kind) for x in given)
    half, other = quarter_period(rest_of_k2), quarter_period(k2)
    finite = np.isfinite(half)
    turns = np.where(finite, np.round(argument / (2 * np.where(finite, half, 1))), 0)
    rest = argument - 2 * np.where(finite, half, 0) * turns
    sign = 1 - 2 * np.mod(turns, 2)
    steep = k2 > rest_of_k2
    near = _images(rest, np.sqrt(np.where(steep, k2, 1)), half, np.where(steep, other, 1))
    far = _thetas(rest, np.where(steep, 1, half), np.where(steep, 1, other))
    sn, cn, dn = (np.where(steep, a, b) for a, b in zip(near, far, strict=True))
    return sign * sn, sign * cn, dn


def quarter_period(complement: npt.ArrayLike) -> Array:
    """The quarter period K = pi / (2 agm(1, k')) for 1 - k^2 = k'^2 = `complement`; inf for 0.

    Examples
    --------
    >>> import numpy as np
    >>> bool(abs(quarter_period(np.array(1.0)) - np.pi / 2) < 1e-15), float(quarter_period(np.array(0.0)))
    (True, inf)
    """
    square: Any = np.asarray(complement)
    a, g = np.ones_like(square), np.sqrt(np.where(square > 0, square, 1))
    for _ in range(MEAN_ITERATIONS):
        a, g = (a + g) / 2, np.sqrt(a * g)
    return np.where(square > 0, _pi(square) / (2 * a), np.inf)


def _pi(like: Array) -> Any:
    """pi in the type of an array."""
    return 4 * np.arctan(np.ones((), dtype=like.dtype))


def _thetas(u: Array, half: Array, other: Array) -> tuple[Array, Array, Array]:
    """sn, cn, dn as quotients of theta functions; common factors q^(1/4) are left out."""
    z = _pi(u) * u / (2 * half)
    q = np.exp(-_pi(u) * other / half)
    ones = np.ones_like(u)
    theta = [np.zeros_like(u), np.zeros_like(u), ones, ones]  # at z
    null = [np.zeros_like(u), ones, ones]  # theta_2, theta_3, theta_4 at 0
    for n in range(THETA_TERMS):
        odd = q ** (n * (n + 1))
        theta[0] = theta[0] + 2 * (-1) ** n * odd * np.sin((2 * n + 1) * z)
        theta[1] = theta[1] + 2 * odd * np.cos((2 * n + 1) * z)
        null[0] = null[0] + 2 * odd
        even = 2 * q ** ((n + 1) ** 2)
        theta[2] = theta[2] + even * np.cos(2 * (n + 1) * z)
        theta[3] = theta[3] + (-1) ** (n + 1) * even * np.cos(2 * (n + 1) * z)
        null[1] = null[1] + even
        null[2] = null[2] + (-1) ** (n + 1) * even
    sn = null[1] * theta[0] / (null[0] * theta[3])
    cn = null[2] * theta[1] / (null[0] * theta[3])
    return sn, cn, null[2] * theta[2] / (null[1] * theta[3])


def _images(u: Array, modulus: Array, half: Array, other: Array) -> tuple[Array, Array, Array]:
    """sn, cn, dn as sums over images under the imaginary period."""
    scale = _pi(u) / (2 * other)
    x, period = scale * u, 2 * scale * half
    sn, cn, dn = np.tanh(x), _sech(x), _sech(x)
    for n in range(1, IMAGE_TERMS):
        left, right = n * period - x, n * period + x
        both = _sech(left) + _sech(right)
        dn = dn + both
        cn = cn + (-1) ** n * both
        sn = sn + (-1) ** n * (np.tanh(right) - np.tanh(left))
    return scale / modulus * sn, scale / modulus * cn, scale * dn


def _sech(x: Array) -> Array:
    small = np.exp(-np.abs(x))
    made: Array = 2 * small / (1 + small * small)
    return made
