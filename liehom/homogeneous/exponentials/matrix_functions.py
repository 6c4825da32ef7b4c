"""Functions of matrices (..., n, n) on which exponentials rest: exp(a) - 1, 2 artanh(a/2), and linear systems.

In float64, in extended precision (for which LAPACK has nothing), and on JAX arrays with a fixed number of operations,
so that they can be traced and differentiated.  A matrix that is not finite gives nan and leaves the others of a
batch alone.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import ceil, log, log2
from typing import Any

import numpy as np

from liehom.errors import SingularError
from liehom.series.arrays import is_jax, namespace

MAX_SQUARINGS = 60
MAX_TERMS = 60
JAX_SQUARINGS = 12
JAX_TERMS = 14
SERIES_RADIUS = 0.35
MAX_HALVINGS = 12
MAX_ITERATIONS = 60
# of the square roots in the halvings under JAX; they reach round-off for |a| up to a few hundred
JAX_ITERATIONS = (16, 7, 6)


def norms(a: Any) -> Any:
    """The Frobenius norms, shape (...,).

    Examples
    --------
    >>> float(norms(np.array([[3.0, 0.0], [4.0, 0.0]])))
    5.0
    """
    if type(a) is np.ndarray and a.ndim == 2:
        flat = a.ravel()
        return np.sqrt(flat.dot(flat))
    xp = namespace(a)
    return xp.sqrt(xp.einsum("...ij,...ij->...", a, a))


def identity(a: Any) -> Any:
    """The identity matrix of the size and dtype of a.

    Examples
    --------
    >>> identity(np.zeros((5, 2, 2))).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    return namespace(a).eye(a.shape[-1], dtype=a.dtype)


def expm1(a: Any) -> Any:
    """exp(a) - 1, relative to its own size.

    Notes
    -----
    The Taylor polynomial at a / 2^s, then s times exp(2b) - 1 = 2 (exp(b) - 1) + (exp(b) - 1)^2, which loses nothing
    where a is small. Matrices of norm beyond 2^60 give nan: no digit of their exponential is determined.

    Examples
    --------
    >>> expm1(np.array([[0.0, 1e-20], [0.0, 0.0]]))[0, 1]
    np.float64(1e-20)
    """
    if is_jax(a):
        made = _doubled(_taylor(a / 2**JAX_SQUARINGS, JAX_TERMS), JAX_SQUARINGS)
        return namespace(a).where((norms(a) < 2 ** (JAX_SQUARINGS - 1))[..., None, None], made, np.nan)
    a, bad, size = _finite(a, 2.0**MAX_SQUARINGS)
    squarings = max(0, ceil(log2(2 * size))) if size > 0 else 0
    terms = series_terms(size / 2**squarings, float(np.finfo(a.dtype).eps))
    return _marked(_doubled(_taylor(a / 2**squarings, terms), squarings), bad)


def series_terms(size: float, eps: float) -> int:
    """The number of terms after which size^j / j! is below eps / 8.

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


def _taylor(a: Any, terms: int) -> Any:
    """a + a^2/2 + ... by Horner's rule."""
    return _repeated(_horner, terms - 1, (a, a / terms, terms - 1))[1]


def _horner(_: Any, state: Any) -> Any:
    a, total, k = state
    return a, (a + a @ total) / k, k - 1


def _doubled(e: Any, times: int) -> Any:
    return _repeated(_double, times, e)


def _double(_: Any, e: Any) -> Any:
    return 2 * e + e @ e


def _repeated(body: Callable[[Any, Any], Any], times: int, state: Any) -> Any:
    """body(i, state) for i < times; under JAX in one loop, which is compiled once and can be differentiated."""
    if any(is_jax(x) for x in (state if isinstance(state, tuple) else (state,))):
        return sys.modules["jax"].lax.fori_loop(0, times, body, state)
    for i in range(times):
        state = body(i, state)
    return state


def cayley_logarithm(a: Any) -> Any:
    """2 artanh(a/2) = a + a^3/12 + a^5/80 + ..., the y with exp(y) = (1 - a/2)^-1 (1 + a/2).

    Raises
    ------
    SingularError
        If an eigenvalue of a is real and at least 2 in size: the transform is then on no one-parameter group.

    Notes
    -----
    artanh(z) = 2 artanh(z / (1 + sqrt(1 - z^2))) until z is small, then the series.

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


def _halved(z: Any, iterations: int | None) -> Any:
    """tanh(artanh(z) / 2)."""
    one = identity(z)
    b = one - z @ z
    start = b, namespace(b).broadcast_to(one, b.shape)
    if iterations is not None:
        return solve(one + _repeated(_newton, iterations, start)[0], z)
    root = _square_root(b, start)
    # where 1 - z^2 has a negative eigenvalue no root is a function of it; others do not commute with z
    if root is None or not bool(np.all(norms(root @ z - z @ root) <= 1e-6 * norms(root) * norms(z))):
        raise SingularError(
            "the Cayley transform of x is on no one-parameter group: its matrix has a real eigenvalue beyond 2 in "
            "size; take a smaller step, or exponential='exp'"
        )
    return solve(one + root, z)


def _newton(_: Any, state: Any) -> Any:
    """The coupled iteration y, p -> sqrt(b), 1/sqrt(b) from b, 1."""
    y, p = state
    return (y + inverse(p)) / 2, (p + inverse(y)) / 2


def _square_root(b: Any, state: Any) -> Any:
    """The square root of b, None where the iteration does not converge."""
    for i in range(MAX_ITERATIONS):
        y, p = _newton(i, state)
        if _has_converged(y, p, state[0], b):
            return y
        state = y, p
    return None


def _has_converged(y: Any, p: Any, before: Any, b: Any) -> bool:
    spread = norms(y) * norms(p)  # the condition number, to which round-off is proportional
    bound = 8 * b.shape[-1] * float(np.finfo(b.dtype).eps) * norms(y) * spread
    return bool(np.all(norms(y - before) <= bound)) and bool(np.all(norms(y @ y - b) <= 1e-6 * norms(b)))


def _artanh(z: Any, terms: int) -> Any:
    """z + z^3/3 + z^5/5 + ... by Horner's rule."""
    start = z @ z, z, z / (2 * terms - 1), 2 * terms - 3
    return _repeated(_odd_horner, terms - 1, start)[2]


def _odd_horner(_: Any, state: Any) -> Any:
    square, z, total, k = state
    return square, z, z / k + square @ total, k - 2


def solve(a: Any, b: Any) -> Any:
    """x with a x = b, for b of shape (..., n, k); in extended precision by refinement of the double one.

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
            return xp.linalg.solve(a, b)
        rough = np.linalg.inv(a.astype(np.float64)).astype(np.longdouble)
    except np.linalg.LinAlgError:
        raise SingularError("a linear system is singular: 1 - x/2, for a Cayley transform of x") from None
    found = rough @ b
    for _ in range(3):
        found = found + rough @ (b - a @ found)
    return found


def inverse(a: Any) -> Any:
    """The inverse, in the precision of a.

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


def _finite(a: Any, limit: float) -> tuple[Any, Any, float]:
    """a with 0 for matrices that are too large or not finite, where these are (or None), and the largest norm."""
    size = norms(a)
    bad = ~(size < limit)
    if not bool(np.any(bad)):
        return a, None, float(np.max(size, initial=0.0))
    return np.where(bad[..., None, None], 0, a), bad, float(np.max(np.where(bad, 0, size), initial=0.0))


def _marked(a: Any, bad: Any) -> Any:
    return a if bad is None else np.where(bad[..., None, None], a.dtype.type(np.nan), a)
