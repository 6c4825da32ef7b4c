"""Functions of matrices (..., n, n) for exponentials: exp(a) - 1, 2 artanh(a/2), and linear systems.

They are computed in float64, in extended precision (which LAPACK does not support), and on JAX arrays.  On JAX arrays
the number of operations is fixed, so that they can be traced and differentiated.  A matrix that is not finite gives nan
and does not affect the others of a batch.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import ceil, log, log2
from typing import TypeVar

import numpy as np

from liehom.errors import SingularError
from liehom.series.arrays import is_jax, namespace
from liehom.typing import Values

S = TypeVar("S")

MAX_SQUARINGS = 60
MAX_TERMS = 60
JAX_SQUARINGS = 12
JAX_TERMS = 14
SERIES_RADIUS = 0.35
MAX_HALVINGS = 12
MAX_ITERATIONS = 60
# Newton steps for the square root in each halving under JAX; they reach round-off for |a| up to a few hundred
JAX_ITERATIONS = (16, 7, 6)


def norms(a: Values) -> Values:
    """The Frobenius norms of matrices, shape (...,).

    Examples
    --------
    >>> float(norms(np.array([[3.0, 0.0], [4.0, 0.0]])))
    5.0
    """
    if type(a) is np.ndarray and a.ndim == 2:
        flat = a.ravel()
        one: Values = np.sqrt(flat.dot(flat))
        return one
    xp = namespace(a)
    many: Values = xp.sqrt(xp.einsum("...ij,...ij->...", a, a))
    return many


def identity(a: Values) -> Values:
    """The identity matrix of the size and dtype of a matrix.

    Examples
    --------
    >>> identity(np.zeros((5, 2, 2))).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    made: Values = namespace(a).eye(a.shape[-1], dtype=a.dtype)
    return made


def expm1(a: Values) -> Values:
    """The matrices exp(a) - 1, with errors relative to their norms.

    Notes
    -----
    The Taylor polynomial is evaluated at b = a / 2^s. Then exp(2b) - 1 = 2 (exp(b) - 1) + (exp(b) - 1)^2 is applied s
    times, which loses no digits for small a. Matrices of norm beyond 2^60 give nan: no digit of their exponential is
    determined.

    Examples
    --------
    >>> expm1(np.array([[0.0, 1e-20], [0.0, 0.0]]))[0, 1]
    np.float64(1e-20)
    """
    if is_jax(a):
        made = _doubled(_taylor(a / 2**JAX_SQUARINGS, JAX_TERMS), JAX_SQUARINGS)
        found: Values = namespace(a).where((norms(a) < 2 ** (JAX_SQUARINGS - 1))[..., None, None], made, np.nan)
        return found
    a, bad, size = _finite(a, 2.0**MAX_SQUARINGS)
    squarings = max(0, ceil(log2(2 * size))) if size > 0 else 0
    terms = series_terms(size / 2**squarings, float(np.finfo(a.dtype).eps))
    return _marked(_doubled(_taylor(a / 2**squarings, terms), squarings), bad)


def series_terms(size: float, eps: float) -> int:
    """Number of terms after which size^j / j! is below eps / 8, at most 60.

    Examples
    --------
    >>> series_terms(0.0, 1e-16), series_terms(1.0, 1e-16)
    (1, 19)
    """
    j, bound = 1, size
    while bound > eps / 8 and j < MAX_TERMS:
        j += 1
        bound *= size / j
    return j


def _taylor(a: Values, terms: int) -> Values:
    """The sum a + a^2/2 + ... by Horner's rule."""
    return _repeated(_horner, terms - 1, (a, a / terms, terms - 1))[1]


def _horner(_: int, state: tuple[Values, Values, int]) -> tuple[Values, Values, int]:
    a, total, k = state
    return a, (a + a @ total) / k, k - 1


def _doubled(e: Values, times: int) -> Values:
    return _repeated(_double, times, e)


def _double(_: int, e: Values) -> Values:
    return 2 * e + e @ e


def _repeated(body: Callable[[int, S], S], times: int, state: S) -> S:
    """The state after body(i, state) for i < times; under JAX in one loop, compiled once and differentiable."""
    if any(is_jax(x) for x in (state if isinstance(state, tuple) else (state,))):
        looped: S = sys.modules["jax"].lax.fori_loop(0, times, body, state)
        return looped
    for i in range(times):
        state = body(i, state)
    return state


def cayley_logarithm(a: Values) -> Values:
    """The y = 2 artanh(a/2) = a + a^3/12 + a^5/80 + ... with exp(y) = (1 - a/2)^-1 (1 + a/2).

    Raises
    ------
    SingularError
        If a has a real eigenvalue of size at least 2: the transform is then on no one-parameter group.

    Notes
    -----
    artanh(z) = 2 artanh(z / (1 + sqrt(1 - z^2))) is applied until z is small enough for the series.

    Examples
    --------
    >>> float(cayley_logarithm(np.array([[0.0, -2.0], [2.0, 0.0]]))[1, 0])  # 2 arctan 1
    1.57079632679...
    """
    if is_jax(a):
        z, factor = a / 2, 2
        for iterations in JAX_ITERATIONS:
            z, factor = _halved(z, iterations), 2 * factor
        return factor * _artanh(z, 16)
    z, bad, size = _finite(a / 2, 1e100)
    factor = 2
    for _ in range(MAX_HALVINGS):
        if size < SERIES_RADIUS:
            break
        z, factor = _halved(z, None), 2 * factor
        size = float(norms(z).max(initial=0.0))
    # size^(2 terms) is below round-off
    terms = 2 + int(log(float(np.finfo(a.dtype).eps)) / (2 * log(max(size, 1e-20))))
    return _marked(factor * _artanh(z, terms), bad)


def _halved(z: Values, iterations: int | None) -> Values:
    """The matrix tanh(artanh(z) / 2)."""
    one = identity(z)
    b = one - z @ z
    start = b, namespace(b).broadcast_to(one, b.shape)
    if iterations is not None:
        return solve(one + _repeated(_newton, iterations, start)[0], z)
    root = _square_root(b, start)
    # if 1 - z^2 has a negative eigenvalue, no square root is a function of it, and others do not commute with z
    if root is None or not bool(np.all(norms(root @ z - z @ root) <= 1e-6 * norms(root) * norms(z))):
        raise SingularError(
            "the Cayley transform of x is on no one-parameter group: its matrix has a real eigenvalue beyond 2 in "
            "size; take a smaller step, or exponential='exp'"
        )
    return solve(one + root, z)


def _newton(_: int, state: tuple[Values, Values]) -> tuple[Values, Values]:
    """One step of the coupled iteration that takes (b, 1) to (sqrt(b), 1/sqrt(b))."""
    y, p = state
    return (y + inverse(p)) / 2, (p + inverse(y)) / 2


def _square_root(b: Values, state: tuple[Values, Values]) -> Values | None:
    """The square root of b, or None if the iteration does not converge."""
    for i in range(MAX_ITERATIONS):
        y, p = _newton(i, state)
        if _has_converged(y, p, state[0], b):
            return y
        state = y, p
    return None


def _has_converged(y: Values, p: Values, before: Values, b: Values) -> bool:
    spread = norms(y) * norms(p)  # the condition number, to which round-off is proportional
    bound = 8 * b.shape[-1] * float(np.finfo(b.dtype).eps) * norms(y) * spread
    return bool(np.all(norms(y - before) <= bound)) and bool(np.all(norms(y @ y - b) <= 1e-6 * norms(b)))


def _artanh(z: Values, terms: int) -> Values:
    """The sum z + z^3/3 + z^5/5 + ... by Horner's rule."""
    start = z @ z, z, z / (2 * terms - 1), 2 * terms - 3
    return _repeated(_odd_horner, terms - 1, start)[2]


def _odd_horner(_: int, state: tuple[Values, Values, Values, int]) -> tuple[Values, Values, Values, int]:
    square, z, total, k = state
    return square, z, z / k + square @ total, k - 2


def solve(a: Values, b: Values) -> Values:
    """The solution x of a x = b, for b of shape (..., n, k); in extended precision by refinement of float64.

    Raises
    ------
    SingularError
        If a matrix is singular.

    Examples
    --------
    >>> solve(np.array([[np.longdouble(3)]]), np.array([[np.longdouble(1)]]))[0, 0]
    np.longdouble('0.33333333333333333334')
    """
    xp = namespace(a, b)
    try:
        if xp is not np or np.result_type(a, b) != np.longdouble:
            direct: Values = xp.linalg.solve(a, b)
            return direct
        rough = np.linalg.inv(a.astype(np.float64)).astype(np.longdouble)
    except np.linalg.LinAlgError:
        raise SingularError("a linear system is singular: 1 - x/2, for a Cayley transform of x") from None
    found: Values = rough @ b
    for _ in range(3):
        found = found + rough @ (b - a @ found)
    return found


def inverse(a: Values) -> Values:
    """The inverse matrix, in the precision of a.

    Raises
    ------
    SingularError
        If a matrix is singular.

    Examples
    --------
    >>> inverse(np.array([[2.0]]))
    array([[0.5]])
    """
    return solve(a, namespace(a).broadcast_to(identity(a), a.shape))


def _finite(a: Values, limit: float) -> tuple[Values, Values | None, float]:
    """The matrices with 0 for those too large or not finite, the mask of these (or None), and the largest norm."""
    size = norms(a)
    bad = ~(size < limit)
    if not bool(np.any(bad)):
        return a, None, float(np.max(size, initial=0.0))
    return np.where(bad[..., None, None], 0, a), bad, float(np.max(np.where(bad, 0, size), initial=0.0))


def _marked(a: Values, bad: Values | None) -> Values:
    return a if bad is None else np.where(bad[..., None, None], a.dtype.type(np.nan), a)
