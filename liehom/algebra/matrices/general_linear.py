"""The linear Lie algebras gl and sl over R, C and H, as real integer matrices.

C^n is R^{2n} and H^n is R^{4n}, coordinate by coordinate: the entry q at (i, j) is the block E_ij (x) L_q,
with L_q the left multiplication by q. The right multiplications by scalars commute with all of these: over C the
complex structure, which spans a u(1), over H the imaginary quaternions, which span an sp(1). The parameter `scalars`
adjoins imaginary scalars to the family, so ``quaternionic_sl(n, scalars=3)`` is sl(n,H) + sp(1).

With parameters other than -1 the same formulas give the algebras over Q(sqrt(c)) and over the quaternion algebra
(a, b) over Q. For example, (-1, 3) is a division algebra over Q and splits over R.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from liehom.algebra.matrices.composition_algebra import cayley_dickson, left_multiplications, right_multiplications
from liehom.algebra.matrices.matrix_basis import as_matrices, join, require_basis, require_size, stack, unit
from liehom.errors import InputError, displayed
from liehom.typing import IntegerArray


def gl(n: int) -> IntegerArray:
    """Basis of gl(n, R): all elementary matrices, row by row.

    Parameters
    ----------
    n : int
        Size, at least 1.

    Returns
    -------
    (n**2, n, n) int64

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> gl(3).shape
    (9, 3, 3)
    """
    require_size("n", n)
    return _gl_over(n, cayley_dickson(()))


def sl(n: int) -> IntegerArray:
    """Basis of sl(n, R): the E_ij with i != j, then the E_ii - E_{i+1,i+1}.

    Parameters
    ----------
    n : int
        Size, at least 1.

    Returns
    -------
    (n**2 - 1, n, n) int64

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> sl(2).tolist()
    [[[0, 1], [0, 0]], [[0, 0], [1, 0]], [[1, 0], [0, -1]]]
    """
    require_size("n", n)
    return _sl_over(n, cayley_dickson(()))


def triangular(n: int, above: int = 0) -> IntegerArray:
    """Basis of the upper triangular matrices in gl(n, R): the E_ij with j - i >= `above`, row by row.

    Parameters
    ----------
    n : int
        Size, at least 1.
    above : int
        0 for upper triangular, 1 for strictly upper triangular matrices.

    Returns
    -------
    (dim, n, n) int64

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> triangular(3).shape, triangular(3, 1).shape
    ((6, 3, 3), (3, 3, 3))
    """
    require_size("n", n)
    require_basis(n * (n + 1) // 2, n)
    return stack((unit(n, i, j) for i in range(n) for j in range(i + above, n)), n)


def complex_gl(n: int, *, parameter: int = -1) -> IntegerArray:
    """Basis of gl(n, C), or of gl(n) over Q(sqrt(parameter)), on R^{2n}.

    Parameters
    ----------
    n : int
        Size over C, at least 1.
    parameter : int
        Square of the adjoined unit; a positive non-square gives a field that splits over R.

    Returns
    -------
    (2 * n**2, 2n, 2n) int64

    Raises
    ------
    InputError
        If n is not a positive integer or the parameter is zero.

    Examples
    --------
    >>> complex_gl(2).shape
    (8, 4, 4)
    """
    return complexify(gl(n), parameter=parameter)


def complex_sl(n: int, *, scalars: int = 0, parameter: int = -1) -> IntegerArray:
    """Basis of sl(n, C) on R^{2n}; with ``scalars=1`` of sl(n, C) + u(1), the complex structure last.

    Parameters
    ----------
    n : int
        Size over C, at least 1.
    scalars : 0 or 1
        Number of commuting imaginary scalars adjoined at the end.
    parameter : int
        Square of the adjoined unit, as in `complex_gl`.

    Returns
    -------
    (2 * n**2 - 2 + scalars, 2n, 2n) int64

    Raises
    ------
    InputError
        If n is not a positive integer, scalars is not 0 or 1, or the parameter is zero.

    Examples
    --------
    >>> complex_sl(2).shape, complex_sl(2, scalars=1).shape
    ((6, 4, 4), (7, 4, 4))
    """
    return with_complex_scalars(complexify(sl(n), parameter=parameter), scalars, parameter=parameter)


def quaternionic_gl(n: int, *, parameters: tuple[int, int] = (-1, -1)) -> IntegerArray:
    """Basis of gl(n, H), or of gl(n) over another quaternion algebra over Q, on R^{4n}.

    Parameters
    ----------
    n : int
        Size over the quaternions, at least 1; for n = 1 the quaternion algebra acts on itself.
    parameters : pair of non-zero integers
        i^2 and j^2.

    Returns
    -------
    (4 * n**2, 4n, 4n) int64

    Raises
    ------
    InputError
        If n is not a positive integer or the parameters are not two non-zero integers.

    Examples
    --------
    >>> quaternionic_gl(2).shape
    (16, 8, 8)
    """
    require_size("n", n)
    return _gl_over(n, quaternion_table(parameters))


def quaternionic_sl(n: int, *, scalars: int = 0, parameters: tuple[int, int] = (-1, -1)) -> IntegerArray:
    """Basis of sl(n, H) on R^{4n}; with commuting scalars of sl(n, H) + u(1) or sl(n, H) + sp(1).

    The real (reduced) trace vanishes. With ``scalars=3, parameters=(-1, 3)`` and n = 2
    this is a form over Q of sl(4, R) + sl(2, R) on R^8.

    Parameters
    ----------
    n : int
        Size over the quaternions, at least 1.
    scalars : 0, 1 or 3
        Number of right multiplications by imaginary units adjoined at the end: none, i, or i, j, k.
    parameters : pair of non-zero integers
        i^2 and j^2.

    Returns
    -------
    (4 * n**2 - 1 + scalars, 4n, 4n) int64

    Raises
    ------
    InputError
        If n is not a positive integer, scalars is not 0, 1 or 3, or a parameter is zero.

    Examples
    --------
    >>> quaternionic_sl(2).shape, quaternionic_sl(2, scalars=3, parameters=(-1, 3)).shape
    ((15, 8, 8), (18, 8, 8))
    """
    require_size("n", n)
    family = _sl_over(n, quaternion_table(parameters))
    return with_quaternion_scalars(family, scalars, parameters=parameters)


def complexify(matrices: ArrayLike, *, parameter: int = -1) -> IntegerArray:
    """Real matrices of the complex span of a family: A and i A for each A, shape (2 dim, 2n, 2n).

    Parameters
    ----------
    matrices : (dim, n, n) integers
        A matrix basis.
    parameter : int
        Square of the adjoined unit.

    Returns
    -------
    (2 * dim, 2n, 2n) int64

    Raises
    ------
    InputError
        If the parameter is zero.

    Examples
    --------
    >>> complexify([[[1]]]).tolist()
    [[[1, 0], [0, 1]], [[0, -1], [1, 0]]]
    """
    basis = as_matrices(matrices)
    require_basis(2 * len(basis), 2 * basis.shape[1])
    units = left_multiplications(cayley_dickson((parameter,)))
    return stack((np.kron(a, u) for a in basis for u in units), 2 * basis.shape[1])


def complex_structure(n: int, *, parameter: int = -1) -> IntegerArray:
    """Matrix of the multiplication by i on C^n = R^{2n}, shape (2n, 2n); it commutes with gl(n, C).

    Examples
    --------
    >>> complex_structure(1).tolist()
    [[0, -1], [1, 0]]
    """
    require_size("n", n)
    unit_i = left_multiplications(cayley_dickson((parameter,)))[1]
    return np.kron(np.eye(n, dtype=np.int64), unit_i)


def quaternion_scalars(n: int, *, parameters: tuple[int, int] = (-1, -1)) -> IntegerArray:
    """Right multiplications by i, j, k on H^n = R^{4n}, a basis of the sp(1) that commutes with gl(n, H).

    Returns
    -------
    (3, 4n, 4n) int64

    Examples
    --------
    >>> quaternion_scalars(2).shape
    (3, 8, 8)
    """
    require_size("n", n)
    units = right_multiplications(quaternion_table(parameters))[1:]
    return stack((np.kron(np.eye(n, dtype=np.int64), u) for u in units), 4 * n)


def with_complex_scalars(family: IntegerArray, scalars: int, *, parameter: int = -1) -> IntegerArray:
    """The family on R^{2n}, followed by the complex structure if ``scalars`` is 1.

    Raises
    ------
    InputError
        If scalars is not 0 or 1.

    Examples
    --------
    >>> with_complex_scalars(complexify(sl(2)), 1).shape
    (7, 4, 4)
    """
    if scalars not in (0, 1):
        raise InputError(f"over C there are 0 or 1 (for u(1)) commuting scalars; got {displayed(scalars)}")
    structure = complex_structure(family.shape[1] // 2, parameter=parameter)
    return join(family, structure[None]) if scalars else family


def with_quaternion_scalars(
    family: IntegerArray, scalars: int, *, parameters: tuple[int, int] = (-1, -1)
) -> IntegerArray:
    """The family on R^{4n}, followed by 0, 1 (for u(1)) or 3 (for sp(1)) right multiplications.

    Raises
    ------
    InputError
        If scalars is not 0, 1 or 3.

    Examples
    --------
    >>> with_quaternion_scalars(quaternionic_gl(1), 1).shape
    (5, 4, 4)
    """
    if scalars not in (0, 1, 3):
        raise InputError(
            f"over H there are 0, 1 (for u(1)) or 3 (for sp(1)) commuting scalars; got {displayed(scalars)}"
        )
    return join(family, quaternion_scalars(family.shape[1] // 4, parameters=parameters)[:scalars])


def quaternion_table(parameters: tuple[int, int]) -> IntegerArray:
    """Multiplication table (4, 4, 4) of the quaternion algebra over Q with given i^2 and j^2.

    Raises
    ------
    InputError
        If the parameters are not two non-zero integers.

    Examples
    --------
    >>> quaternion_table((-1, 3))[2, 2].tolist()
    [3, 0, 0, 0]
    """
    if len(parameters) != 2:
        raise InputError(f"a quaternion algebra has two parameters, i^2 and j^2; got {displayed(list(parameters))}")
    return cayley_dickson(parameters)


def _gl_over(n: int, table: IntegerArray) -> IntegerArray:
    """Basis of gl(n) over the algebra: all E_ij (x) L_q."""
    units = left_multiplications(table)
    require_basis(n * n * len(units), n * len(units))
    entries = ((i, j) for i in range(n) for j in range(n))
    return stack((np.kron(unit(n, i, j), u) for i, j in entries for u in units), n * len(units))


def _sl_over(n: int, table: IntegerArray) -> IntegerArray:
    """Basis of sl(n) over the algebra.

    E_ij (x) L_q for i != j, then E_ii (x) L_q for imaginary units q, then the differences of the E_ii (x) 1.
    """
    units = left_multiplications(table)
    require_basis(n * n * len(units) - 1, n * len(units))
    off = [np.kron(unit(n, i, j), u) for i in range(n) for j in range(n) if i != j for u in units]
    imaginary = [np.kron(unit(n, i, i), u) for i in range(n) for u in units[1:]]
    real = [np.kron(unit(n, i, i) - unit(n, i + 1, i + 1), units[0]) for i in range(n - 1)]
    return stack([*off, *imaginary, *real], n * len(units))
