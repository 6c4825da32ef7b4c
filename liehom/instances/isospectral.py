"""Isospectral flows on Sym(k): the double bracket flow, the Toda flow, QR flows, and the solution of the latter.

    S' = [S, [S, N]]                                              double bracket flow: sorts as N is sorted
    S' = [S, P(f(S))],  P(X) = L - L^T, L the part of X below the diagonal            f(x) = x: Toda flow

(R. W. Brockett, Linear Algebra Appl. 146, 1991; W. W. Symes, Physica D 4, 1982).  With exp(t f(S_0)) = Q(t) R(t),
R upper triangular with positive diagonal, the second one is solved by S(t) = Q(t)^T S_0 Q(t): at integer times these
are the iterates of the QR algorithm for exp(f(S_0)), and for f = log those for S_0 itself.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import Any

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.instances.sym_conjugation import SymmetricMatrices
from liehom.series.jet import Jet

MAX_SPREAD = 4.0
"""A factorization is made of exp(X) for eigenvalues of X at most this far apart: of a condition number of e^4."""
SPECTRUM_RTOL = 1e-6


def double_bracket_flow(n: Any) -> GeneratorField:
    """S' = [S, [S, N]], the gradient flow of tr(S N) on the orbit: A(S) = [N, S].

    Parameters
    ----------
    n : (..., k, k) array_like
        Symmetric. For a diagonal one with different entries the flow brings S to the diagonal matrix whose entries
        are sorted as those of N (but for starts on lower-dimensional sets). Leading axes: one for each trajectory.

    Raises
    ------
    ShapeError, InputError
        If N is not a symmetric matrix of size at least 2.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = double_bracket_flow(np.diag([1.0, 3.0, 2.0]))
    >>> space = SymmetricMatrices(3)
    >>> start = space.to_vector([[2.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 2.0]])
    >>> end = space.to_matrix(lh.integrate(field, (0, 30), start).y[:, -1])
    >>> np.diag(end).round(6).tolist()
    [0.585786, 3.414214, 2.0]
    """
    space, n = _space(n)
    space.to_vector(n)  # is it symmetric?
    return space.flow(lambda s: n @ s - s @ n)


def toda_flow(k: int) -> GeneratorField:
    """S' = [S, P(S)], P(S) = L - L^T with the part L of S below the diagonal.

    Notes
    -----
    On tridiagonal S, which stay tridiagonal, it is the Toda lattice of k particles in Flaschka's variables: with
    diagonal a and b beside it, a_i' = 2 (b_i^2 - b_{i-1}^2) and b_i' = b_i (a_{i+1} - a_i). For t to infinity S tends
    to the diagonal matrix of the eigenvalues in decreasing order, for almost all starts.

    Examples
    --------
    >>> import liehom as lh
    >>> field, space = toda_flow(2), SymmetricMatrices(2)
    >>> space.to_matrix(field.vector([1.0, 3.0, 2.0])).tolist()
    [[18.0, 3.0], [3.0, -18.0]]
    """
    space = SymmetricMatrices(k)
    return space.flow(lambda s: _upper_minus_lower(space, s))


def qr_flow(start: Any, function: Callable[[Any], Any] = np.log) -> GeneratorField:
    """S' = [S, P(f(S))] through S_0: for f = log at integer times the iterates of the QR algorithm.

    Parameters
    ----------
    start : (..., k, k) array_like
        S_0; the eigenvalues are constant, so that f(S) is the polynomial in S which interpolates f there, and the
        field can be expanded for any f. It belongs to this spectrum (leading axes: to those of these trajectories).
    function : callable
        f, on an array of eigenvalues (default: the logarithm, for positive definite S_0).

    Raises
    ------
    ShapeError, InputError
        If S_0 is not symmetric, or f not finite at its eigenvalues; when it is evaluated, if a point has another
        spectrum.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> start, space = np.array([[2.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 4.0]]), SymmetricMatrices(3)
    >>> sol = lh.integrate(qr_flow(start), (0, 1), space.to_vector(start), rtol=1e-12, atol=1e-14)
    >>> q, r = np.linalg.qr(start)
    >>> bool(np.allclose(np.abs(space.to_matrix(sol.y[:, -1])), np.abs(r @ q), atol=1e-10))
    True
    """
    space, start = _space(start)
    matrix = space.to_matrix(space.to_vector(start))
    spectrum = np.linalg.eigvalsh(matrix)
    nodes, coefficients = _interpolated(spectrum, _values(function, spectrum))
    sums, squares = spectrum.sum(axis=-1), (spectrum**2).sum(axis=-1)

    def generator(s: Any) -> Any:
        if not isinstance(s, Jet) and s.dtype.kind == "f":
            other = np.abs(np.trace(s, axis1=-2, axis2=-1) - sums) > SPECTRUM_RTOL * np.sqrt(squares)
            other |= np.abs((s * s).sum(axis=(-1, -2)) - squares) > SPECTRUM_RTOL * squares
            if bool(np.any(other)):
                raise InputError("the point has other eigenvalues than the matrix that the QR flow was made for")
        identity = np.eye(space.k)
        total = coefficients[..., -1, None, None] * identity
        for i in range(space.k - 2, -1, -1):
            total = total @ (s - nodes[..., i, None, None] * identity) + coefficients[..., i, None, None] * identity
        return _upper_minus_lower(space, total)

    return space.flow(generator)


def qr_solution(start: Any, t: Any, function: Callable[[Any], Any] | None = None) -> Any:
    """The solution S(t) = Q^T S_0 Q of `toda_flow` or `qr_flow`, exp(t f(S_0)) = Q R, in closed form.

    Parameters
    ----------
    start : (..., k, k) array_like
        S_0.
    t : float or array_like
        Times, one for all matrices or of a shape that broadcasts against their leading axes.
    function : callable, optional
        f, on an array of eigenvalues (default: f(x) = x, the Toda flow).

    Returns
    -------
    array of shape (..., k, k)

    Raises
    ------
    ShapeError, InputError
        If S_0 is not symmetric, f not finite at its eigenvalues, or t not finite.

    Notes
    -----
    exp(t f(S_0)) is factorized in so many parts of t that none has a condition number above e^4: no overflow, and no
    column of Q is lost.

    Examples
    --------
    >>> import numpy as np
    >>> np.round(np.diag(qr_solution([[1.0, 1.0], [1.0, 3.0]], 20.0)) - 2, 9)
    array([ 1.41421356, -1.41421356])
    """
    space, start = _space(start)
    t = np.asarray(t, dtype=float)
    if not bool(np.isfinite(t).all()):
        raise InputError(f"the time is {t}, expected finite numbers")
    try:
        lead = np.broadcast_shapes(t.shape, start.shape[:-2])
    except ValueError:
        raise ShapeError(f"times of shape {t.shape} for matrices of shape {start.shape}") from None
    s = np.broadcast_to(space.to_matrix(space.to_vector(start)), (*lead, space.k, space.k))
    eigenvalues, vectors = np.linalg.eigh(s)
    values = _values((lambda x: x) if function is None else function, eigenvalues)
    exponents = t[..., None] * values
    exponents = exponents - exponents.max(axis=-1, keepdims=True)
    parts = max(1, ceil(float(-exponents.min(initial=0.0)) / MAX_SPREAD))
    sizes = np.exp(exponents / parts)[..., None, :]
    for _ in range(parts):
        q, r = np.linalg.qr(vectors * sizes @ np.swapaxes(vectors, -1, -2))
        diagonal = np.diagonal(r, axis1=-2, axis2=-1)
        vectors = np.swapaxes(q * np.where(diagonal < 0, -1.0, 1.0)[..., None, :], -1, -2) @ vectors
    return vectors * eigenvalues[..., None, :] @ np.swapaxes(vectors, -1, -2)


# -- private helpers -------------------------------------------------------------------------------------
def _space(matrix: Any) -> tuple[SymmetricMatrices, Any]:
    matrix = np.asarray(matrix)
    if matrix.ndim < 2 or matrix.shape[-1] != matrix.shape[-2] or matrix.shape[-1] < 2:
        raise ShapeError(f"expected square matrices of size at least 2, got shape {matrix.shape}")
    if matrix.dtype.kind not in "iuf" or not bool(np.isfinite(matrix).all()):
        raise InputError(f"expected a matrix of finite real numbers, got {matrix!r}")
    return SymmetricMatrices(matrix.shape[-1]), matrix


def _upper_minus_lower(space: SymmetricMatrices, x: Any) -> Any:
    """L^T - L for the part L of a symmetric X below the diagonal: S' = [A, S] with A = -P(X)."""
    signs = np.triu(np.ones((space.k, space.k), dtype=int), 1)
    return x * (signs - signs.T)


def _values(function: Callable[[Any], Any], spectrum: Any) -> Any:
    with np.errstate(all="ignore"):
        values = np.asarray(function(spectrum), dtype=float)
    if values.shape != spectrum.shape:
        raise ShapeError(f"f returned shape {values.shape} for eigenvalues of shape {spectrum.shape}")
    if not bool(np.isfinite(values).all()):
        bad = np.broadcast_to(spectrum, values.shape)[~np.isfinite(values)]
        raise InputError(f"f is not finite at the eigenvalue {bad[0]:.6g}: it must be defined on the spectrum")
    return values


def _interpolated(spectrum: Any, values: Any) -> tuple[Any, Any]:
    """Nodes and coefficients of Newton's interpolation polynomial, (..., k) each.

    The nodes are taken in Leja's order, each as far from those before it as possible; eigenvalues that differ by
    round-off count once.
    """
    k = spectrum.shape[-1]
    nodes, coefficients = spectrum.copy(), np.zeros_like(values)
    left, f = spectrum.copy(), values.copy()
    tiny = 64 * k * np.finfo(float).eps * np.abs(spectrum).max(axis=-1)
    products, nearest = np.ones_like(spectrum), np.full_like(spectrum, np.inf)
    for i in range(k):
        measure = np.abs(left) if i == 0 else np.abs(products)
        chosen = np.argmax(np.where(nearest > tiny[..., None], measure, -1.0), axis=-1)[..., None]
        new = np.take_along_axis(nearest, chosen, axis=-1)[..., 0] > tiny
        x, y = (np.take_along_axis(a, chosen, axis=-1)[..., 0] for a in (left, f))
        total, product = np.zeros_like(x), np.ones_like(x)
        for j in range(i):
            total, product = total + coefficients[..., j] * product, product * (x - nodes[..., j])
        coefficients[..., i] = np.where(new, (y - total) / np.where(new, product, 1.0), 0.0)
        nodes[..., i] = x
        products, nearest = products * (left - x[..., None]), np.minimum(nearest, np.abs(left - x[..., None]))
    return nodes, coefficients
