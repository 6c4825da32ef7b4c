"""Matrix bases of the Lie algebras that preserve a form: orthogonal, unitary and symplectic over R, C and H.

For a diagonal form D over R, C or H the condition X* D + D X = 0 reads conj(x_ji) d_j + d_i x_ij = 0, so that

    d_i q E_ji - d_j conj(q) E_ij  (i < j, q a unit)   and   q E_ii  (q an imaginary unit)

are a basis. This covers so(p,q), u(p,q) and sp(p,q). A complex or quaternionic entry is a real block as in
`general_linear`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liehom.algebra.matrices.composition_algebra import cayley_dickson, conjugation, left_multiplications
from liehom.algebra.matrices.general_linear import complexify, with_complex_scalars, with_quaternion_scalars
from liehom.algebra.matrices.matrix_basis import primitive, require_basis, require_nonzero, require_size, stack, unit
from liehom.typing import IntegerArray


def so(p: int, q: int = 0) -> IntegerArray:
    """Basis of so(p, q), which preserves diag(1, ..., 1, -1, ..., -1) with p ones and q minus ones.

    Parameters
    ----------
    p, q : int
        Not negative, with p + q at least 1.

    Returns
    -------
    (n * (n - 1) / 2, n, n) int64 with n = p + q

    Raises
    ------
    InputError
        If p or q is negative or both are zero.

    Examples
    --------
    >>> so(2).tolist(), so(1, 1).tolist()
    ([[[0, -1], [1, 0]]], [[[0, 1], [1, 0]]])
    """
    return orthogonal(_signs(p, q))


def orthogonal(diagonal: Sequence[int]) -> IntegerArray:
    """Basis of the orthogonal algebra of the quadratic form ``sum_i diagonal[i] x_i**2``.

    Parameters
    ----------
    diagonal : non-zero integers
        At least one.

    Returns
    -------
    (n * (n - 1) / 2, n, n) int64
        Primitive matrices X with ``X.T @ D + D @ X = 0``.

    Raises
    ------
    InputError
        If the list is empty or an entry is zero.

    Examples
    --------
    >>> orthogonal([1, -3]).tolist()
    [[[0, 3], [1, 0]]]
    """
    return _skew_hermitian(diagonal, cayley_dickson(()))


def u(p: int, q: int = 0) -> IntegerArray:
    """Basis of u(p, q) on C^{p+q} = R^{2(p+q)}.

    Parameters
    ----------
    p, q : int
        Not negative, with n = p + q at least 1.

    Returns
    -------
    (n**2, 2n, 2n) int64

    Raises
    ------
    InputError
        If p or q is negative or both are zero.

    Examples
    --------
    >>> u(2, 1).shape
    (9, 6, 6)
    """
    return _skew_hermitian(_signs(p, q), cayley_dickson((-1,)))


def su(p: int, q: int = 0) -> IntegerArray:
    """Basis of su(p, q) on C^{p+q} = R^{2(p+q)}, the elements of u(p, q) of complex trace zero.

    Parameters
    ----------
    p, q : int
        Not negative, with n = p + q at least 1.

    Returns
    -------
    (n**2 - 1, 2n, 2n) int64

    Raises
    ------
    InputError
        If p or q is negative or both are zero.

    Examples
    --------
    >>> su(2).shape, su(1, 1).shape
    ((3, 4, 4), (3, 4, 4))
    """
    n = len(_signs(p, q))
    unitary = u(p, q)
    imaginary = complexify(stack((unit(n, i, i) - unit(n, i + 1, i + 1) for i in range(n - 1)), n))[1::2]
    return np.concatenate([unitary[n:], imaginary])


def quaternionic_u(p: int, q: int = 0, *, scalars: int = 0) -> IntegerArray:
    """Basis of sp(p, q), the unitary algebra of H^{p+q} = R^{4(p+q)}, with commuting scalars.

    The compact sp(n) is ``quaternionic_u(n)``.

    Parameters
    ----------
    p, q : int
        Not negative, with n = p + q at least 1.
    scalars : 0, 1 or 3
        The number of right multiplications by imaginary units to adjoin: none, a u(1), or an sp(1).

    Returns
    -------
    (n * (2n + 1) + scalars, 4n, 4n) int64

    Raises
    ------
    InputError
        If p or q is negative or both are zero, or scalars is not 0, 1 or 3.

    Examples
    --------
    sp(2) and sp(2) + sp(1) on R^8:

    >>> quaternionic_u(2).shape, quaternionic_u(2, scalars=3).shape
    ((10, 8, 8), (13, 8, 8))
    """
    family = _skew_hermitian(_signs(p, q), cayley_dickson((-1, -1)))
    return with_quaternion_scalars(family, scalars)


def so_star(n: int) -> IntegerArray:
    """Basis of so*(2n) on H^n = R^{4n}, the matrices with X* j + j X = 0.

    Parameters
    ----------
    n : int
        Size over the quaternions, at least 1.

    Returns
    -------
    (n * (2n - 1), 4n, 4n) int64

    Raises
    ------
    InputError
        If n is not a positive integer.

    Notes
    -----
    The condition is ``x_ij = j conj(x_ji) j``: on the diagonal only j itself satisfies it.

    Examples
    --------
    >>> so_star(3).shape
    (15, 12, 12)
    """
    require_size("n", n)
    require_basis(n * (2 * n - 1), 4 * n)
    units = left_multiplications(cayley_dickson((-1, -1)))
    j = units[2]
    diagonal = [np.kron(unit(n, i, i), j) for i in range(n)]
    pairs = [(a, b) for a in range(n) for b in range(a + 1, n)]
    off = [np.kron(unit(n, a, b), q) + np.kron(unit(n, b, a), j @ q.T @ j) for a, b in pairs for q in units]
    return stack([*diagonal, *off], 4 * n)


def sp(n: int) -> IntegerArray:
    """Basis of sp(2n, R) on R^{2n}, which preserves the skew-symmetric form [[0, 1], [-1, 0]].

    Parameters
    ----------
    n : int
        Half of the size, at least 1.

    Returns
    -------
    (n * (2n + 1), 2n, 2n) int64
        The blocks [[A, 0], [0, -A^T]], then [[0, B], [0, 0]] and [[0, 0], [B, 0]] with B symmetric.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> sp(1).tolist()
    [[[1, 0], [0, -1]], [[0, 1], [0, 0]], [[0, 0], [1, 0]]]
    """
    require_size("n", n)
    size = 2 * n
    require_basis(n * (size + 1), size)
    linear = [unit(size, i, j) - unit(size, n + j, n + i) for i in range(n) for j in range(n)]
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    upper = [unit(size, i, n + j) + (i != j) * unit(size, j, n + i) for i, j in pairs]
    return stack([*linear, *upper, *(matrix.T for matrix in upper)], size)


def complex_so(n: int) -> IntegerArray:
    """Basis of so(n, C) on C^n = R^{2n}, over R.

    Parameters
    ----------
    n : int
        Size over C, at least 1.

    Returns
    -------
    (n * (n - 1), 2n, 2n) int64

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> complex_so(3).shape
    (6, 6, 6)
    """
    require_size("n", n)
    return complexify(so(n))


def complex_sp(n: int, *, scalars: int = 0) -> IntegerArray:
    """Basis of sp(2n, C) on C^{2n} = R^{4n}, over R; with ``scalars=1`` the complex structure comes last.

    Parameters
    ----------
    n : int
        Half of the size over C, at least 1.
    scalars : 0 or 1
        1 to adjoin the complex structure, which spans a u(1).

    Returns
    -------
    (2 * n * (2n + 1) + scalars, 4n, 4n) int64

    Raises
    ------
    InputError
        If n is not a positive integer or scalars is not 0 or 1.

    Examples
    --------
    >>> complex_sp(1).shape, complex_sp(2, scalars=1).shape
    ((6, 4, 4), (21, 8, 8))
    """
    return with_complex_scalars(complexify(sp(n)), scalars)


def _signs(p: int, q: int) -> list[int]:
    """The list of p ones and q minus ones, p and q checked."""
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_size("p + q", p + q)
    return [1] * p + [-1] * q


def _skew_hermitian(diagonal: Sequence[int], table: IntegerArray) -> IntegerArray:
    """Basis of {X : X* D + D X = 0} over the algebra: imaginary diagonal entries, then the pairs i < j."""
    require_size("the number of diagonal entries", len(diagonal))
    require_nonzero("diagonal", diagonal)
    n = len(diagonal)
    units = left_multiplications(table)
    require_basis(n * (len(units) * (n + 1) - 2) // 2, n * len(units))
    on = [np.kron(unit(n, i, i), q) for q in units[1:] for i in range(n)]
    d = [int(value) * (1 if diagonal[0] > 0 else -1) for value in diagonal]
    off = [
        primitive(d[i] * np.kron(unit(n, j, i), q) - d[j] * sign * np.kron(unit(n, i, j), q))
        for i in range(n)
        for j in range(i + 1, n)
        for q, sign in zip(units, conjugation(table), strict=True)
    ]
    return stack([*on, *off], n * len(units))
