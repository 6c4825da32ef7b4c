"""Isospectral flows on Sym(k): the double bracket flow, the Toda flow, and QR flows with their solution.

    S' = [S, [S, N]]                                              double bracket flow: sorts as N is sorted
    S' = [S, P(f(S))],  P(X) = L - L^T, L the part of X below the diagonal            f(x) = x: Toda flow

(R. W. Brockett, Linear Algebra Appl. 146, 1991; W. W. Symes, Physica D 4, 1982). With exp(t f(S_0)) = Q(t) R(t),
R upper triangular with positive diagonal, S(t) = Q(t)^T S_0 Q(t) solves the second equation. At integer times S(t) is
an iterate of the QR algorithm for exp(f(S_0)), and for f = log of the QR algorithm for S_0 itself.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.instances.sym_conjugation import SymmetricMatrices
from liehom.series.jet import Jet
from liehom.typing import Array, Values

SpectralFunction: TypeAlias = Callable[[Any], Any]
"""A function of an array of eigenvalues, entry by entry, such as `numpy.log`."""

MAX_SPREAD = 4.0
"""exp(X) is factorized for eigenvalues of X at most this far apart, so for condition numbers up to e^4."""
SPECTRUM_RTOL = 1e-6
"""Relative tolerance for the invariants of a point, which must be those of the matrix that a QR flow is made for."""


def double_bracket_flow(n: npt.ArrayLike) -> GeneratorField:
    """The field S' = [S, [S, N]], the gradient flow of tr(S N) on the orbit, with A(S) = [N, S].

    Parameters
    ----------
    n : (..., k, k) array_like
        Symmetric. For a diagonal N with different entries, S tends to the diagonal matrix whose entries are sorted as
        those of N (except for initial points on lower-dimensional sets). Leading axes: one N for each trajectory.

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
    space, matrix = _space(n)
    space.to_vector(matrix)  # raises unless it is symmetric
    return space.flow(lambda s: matrix @ s - s @ matrix)


def toda_flow(k: int) -> GeneratorField:
    """The field S' = [S, P(S)], P(S) = L - L^T with the part L of S below the diagonal.

    Notes
    -----
    On tridiagonal S, which stay tridiagonal, it is the Toda lattice of k particles in Flaschka's variables: with
    diagonal a and off-diagonal b, a_i' = 2 (b_i^2 - b_{i-1}^2) and b_i' = b_i (a_{i+1} - a_i). As t tends to infinity,
    S tends to the diagonal matrix of the eigenvalues in decreasing order, for almost all initial points.

    Examples
    --------
    >>> import liehom as lh
    >>> field, space = toda_flow(2), SymmetricMatrices(2)
    >>> space.to_matrix(field.vector([1.0, 3.0, 2.0])).tolist()
    [[18.0, 3.0], [3.0, -18.0]]
    """
    space = SymmetricMatrices(k)
    return space.flow(lambda s: _upper_minus_lower(space, s))


def qr_flow(start: npt.ArrayLike, function: SpectralFunction = np.log) -> GeneratorField:
    """The field S' = [S, P(f(S))] through S_0; for f = log, S(1), S(2), ... are the iterates of the QR algorithm.

    Parameters
    ----------
    start : (..., k, k) array_like
        S_0. The eigenvalues are constant, so f(S) is the polynomial in S that interpolates f at the eigenvalues, and
        the field can be expanded for any f. The field is valid for points with this spectrum only (leading axes: one
        spectrum for each trajectory).
    function : callable
        f, on an array of eigenvalues (default: the logarithm, for positive definite S_0).

    Raises
    ------
    ShapeError, InputError
        If S_0 is not symmetric, or f is not finite at its eigenvalues. The field raises InputError at a point with
        another spectrum.

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
    space, given = _space(start)
    matrix: Any = space.to_matrix(space.to_vector(given))
    spectrum: Array = np.linalg.eigvalsh(matrix)
    nodes, coefficients = _interpolated(spectrum, _values(function, spectrum))
    sums, squares = spectrum.sum(axis=-1), (spectrum**2).sum(axis=-1)

    def generator(s: Values) -> Values:
        if not isinstance(s, Jet) and s.dtype.kind == "f":
            other: Any = np.abs(np.trace(s, axis1=-2, axis2=-1) - sums) > SPECTRUM_RTOL * np.sqrt(squares)
            other |= np.abs((s * s).sum(axis=(-1, -2)) - squares) > SPECTRUM_RTOL * squares
            if bool(np.any(other)):
                raise InputError("the point has other eigenvalues than the matrix that the QR flow was made for")
        identity = np.eye(space.k)
        total: Values = coefficients[..., -1, None, None] * identity
        for i in range(space.k - 2, -1, -1):
            total = total @ (s - nodes[..., i, None, None] * identity) + coefficients[..., i, None, None] * identity
        return _upper_minus_lower(space, total)

    return space.flow(generator)


def qr_solution(start: npt.ArrayLike, t: npt.ArrayLike, function: SpectralFunction | None = None) -> Array:
    """The solution S(t) = Q^T S_0 Q of `toda_flow` or `qr_flow`, exp(t f(S_0)) = Q R, in closed form.

    Parameters
    ----------
    start : (..., k, k) array_like
        S_0.
    t : float or array_like
        Times: one for all matrices, or of a shape that broadcasts against their leading axes.
    function : callable, optional
        f, on an array of eigenvalues (default: f(x) = x, the Toda flow).

    Returns
    -------
    array of shape (..., k, k)

    Raises
    ------
    ShapeError, InputError
        If S_0 is not symmetric, f is not finite at its eigenvalues, or t is not finite.

    Notes
    -----
    exp(t f(S_0)) is factorized in equal parts of t, as many as are needed for condition numbers of at most e^4, so that
    there is no overflow and every column of Q is accurate.

    Examples
    --------
    >>> import numpy as np
    >>> np.round(np.diag(qr_solution([[1.0, 1.0], [1.0, 3.0]], 20.0)) - 2, 9)
    array([ 1.41421356, -1.41421356])
    """
    space, given = _space(start)
    times = np.asarray(t, dtype=float)
    if not bool(np.isfinite(times).all()):
        raise InputError(f"the time is {times}, expected finite numbers")
    try:
        lead = np.broadcast_shapes(times.shape, given.shape[:-2])
    except ValueError:
        raise ShapeError(f"times of shape {times.shape} for matrices of shape {given.shape}") from None
    s: Any = np.broadcast_to(space.to_matrix(space.to_vector(given)), (*lead, space.k, space.k))
    eigenvalues, vectors = np.linalg.eigh(s)
    values = _values((lambda x: x) if function is None else function, eigenvalues)
    exponents = times[..., None] * values
    exponents = exponents - exponents.max(axis=-1, keepdims=True)
    parts = max(1, ceil(float(-exponents.min(initial=0.0)) / MAX_SPREAD))
    sizes = np.exp(exponents / parts)[..., None, :]
    for _ in range(parts):
        q, r = np.linalg.qr(vectors * sizes @ np.swapaxes(vectors, -1, -2))
        diagonal = np.diagonal(r, axis1=-2, axis2=-1)
        vectors = np.swapaxes(q * np.where(diagonal < 0, -1.0, 1.0)[..., None, :], -1, -2) @ vectors
    solution: Array = vectors * eigenvalues[..., None, :] @ np.swapaxes(vectors, -1, -2)
    return solution


# -- private helpers -------------------------------------------------------------------------------------
def _space(matrix: npt.ArrayLike) -> tuple[SymmetricMatrices, npt.NDArray[Any]]:
    """The space of symmetric matrices of the size of given ones, and these as an array (..., k, k)."""
    given = np.asarray(matrix)
    if given.ndim < 2 or given.shape[-1] != given.shape[-2] or given.shape[-1] < 2:
        raise ShapeError(f"expected square matrices of size at least 2, got shape {given.shape}")
    if given.dtype.kind not in "iuf" or not bool(np.isfinite(given).all()):
        raise InputError(f"expected a matrix of finite real numbers, got {given!r}")
    return SymmetricMatrices(given.shape[-1]), given


def _upper_minus_lower(space: SymmetricMatrices, x: Values) -> Values:
    """L^T - L for the part L of a symmetric X below the diagonal: S' = [A, S] with A = -P(X)."""
    signs = np.triu(np.ones((space.k, space.k), dtype=int), 1)
    return x * (signs - signs.T)


def _values(function: SpectralFunction, spectrum: Array) -> Array:
    """f at the eigenvalues, checked."""
    with np.errstate(all="ignore"):
        values = np.asarray(function(spectrum), dtype=float)
    if values.shape != spectrum.shape:
        raise ShapeError(f"f returned shape {values.shape} for eigenvalues of shape {spectrum.shape}")
    if not bool(np.isfinite(values).all()):
        bad = np.broadcast_to(spectrum, values.shape)[~np.isfinite(values)]
        raise InputError(f"f is not finite at the eigenvalue {bad[0]:.6g}: it must be defined on the spectrum")
    return values


def _interpolated(spectrum: Array, values: Array) -> tuple[Array, Array]:
    """Nodes and coefficients of Newton's interpolation polynomial, (..., k) each.

    The nodes are in Leja order, each as far from the previous ones as possible. Eigenvalues that differ by round-off
    count once.
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
