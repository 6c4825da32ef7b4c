"""Operations on matrix bases of linear Lie algebras, and the checks of parameters that all families share.

A matrix basis A_1, ..., A_dim is one int64 array of shape (dim, N, N). The stabilizers of a vector v and of the line
through it,

    {c : sum_i c_i A_i v = 0}     and     {c : sum_i c_i A_i v in R v},

are computed exactly, as rows of integer coefficients c.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import gcd, log10

import numpy as np
from numpy.typing import ArrayLike

from liehom.budget import current_limits, in_time, within
from liehom.errors import InputError, ShapeError, displayed
from liehom.scalars import QQ
from liehom.typing import IntegerArray

BYTES = 8
"""Bytes of an entry of a matrix, an int64 or a small integer of flint."""


def combine(rows: ArrayLike, matrices: ArrayLike) -> IntegerArray:
    """Linear combinations of the matrices of a basis, one for each row of coefficients; shape (m, N, N).

    Parameters
    ----------
    rows : (m, dim) integers
        Coefficients.
    matrices : (dim, N, N) integers
        A matrix basis.

    Returns
    -------
    (m, N, N) int64
        ``sum_i rows[a, i] matrices[i]``.

    Raises
    ------
    ShapeError
        If the shapes do not fit.

    Examples
    --------
    >>> combine([[1, 1]], [[[0, 1], [0, 0]], [[0, 0], [1, 0]]]).tolist()
    [[[0, 1], [1, 0]]]
    """
    basis = as_matrices(matrices)
    coefficients = np.asarray(rows, dtype=np.int64)
    if coefficients.ndim != 2 or coefficients.shape[1] != len(basis):
        raise ShapeError(f"rows of shape (m, {len(basis)}) are needed; got shape {coefficients.shape}")
    combinations: IntegerArray = np.tensordot(coefficients, basis, 1)
    return combinations


def join(*families: ArrayLike) -> IntegerArray:
    """Concatenation of matrix bases on the same space, shape (sum of dim_a, N, N).

    Parameters
    ----------
    *families : (dim_a, N, N) integers
        Matrix bases on the same R^N, meant to be linearly independent together.

    Returns
    -------
    (sum of dim_a, N, N) int64

    Raises
    ------
    ShapeError
        If the matrices do not all have the same size, or nothing is given.

    Examples
    --------
    >>> join([[[0, -1], [1, 0]]], [[[1, 0], [0, 1]]]).shape
    (2, 2, 2)
    """
    bases = [as_matrices(family) for family in families]
    sizes = sorted({basis.shape[1] for basis in bases})
    if len(sizes) != 1:
        raise ShapeError(f"families on the same space are needed; got matrices of sizes {sizes}")
    count, size = sum(map(len, bases)), sizes[0]
    within("memory", 8 * count * size * size, f"{count} matrices of size {size} are {{}} bytes")
    in_time()
    return np.concatenate(bases)


def stabilizer_rows(matrices: ArrayLike, point: ArrayLike, *, up_to_scale: bool = False) -> IntegerArray:
    """Basis of the combinations that annihilate a vector or map its line to itself, rows (m, dim).

    Parameters
    ----------
    matrices : (dim, N, N) integers
        A matrix basis.
    point : (N,) integers
        The vector v.
    up_to_scale : bool
        Require ``A v`` in the line R v instead of ``A v = 0``; v must then be non-zero.

    Returns
    -------
    (m, dim) int64
        Primitive rows of coefficients, an exact basis of the stabilizer.

    Raises
    ------
    ShapeError
        If the vector does not have length N.
    InputError
        If v is zero and `up_to_scale` is True.

    Examples
    --------
    The stabilizer of e_0 in so(3) is the rotation of the other two coordinates:

    >>> from liehom.algebra.matrices.form_preserving import so
    >>> stabilizer_rows(so(3), [1, 0, 0]).tolist()
    [[0, 0, 1]]
    """
    basis = as_matrices(matrices)
    vector = np.asarray(point, dtype=np.int64)
    if vector.shape != basis.shape[1:2]:
        raise ShapeError(f"the point must have length {basis.shape[1]}; got an array of shape {vector.shape}")
    system = (basis @ vector).T
    if not up_to_scale:
        return null_space(system)
    if not vector.any():
        raise InputError("the zero vector spans no line; give a point that is not zero")
    rows = null_space(np.column_stack([system, -vector]))[:, :-1]
    return np.array([primitive(row) for row in rows], dtype=np.int64).reshape(-1, len(basis))


def null_space(matrix: ArrayLike) -> IntegerArray:
    """Exact basis of {x : M x = 0} as primitive integer rows, shape (n - rank, n).

    Parameters
    ----------
    matrix : (m, n) integers
        The matrix M.

    Returns
    -------
    (n - rank, n) int64
        One row for each column without a pivot, in increasing order of that column.

    Examples
    --------
    >>> null_space([[1, 2, 0], [0, 0, 2]]).tolist()
    [[-2, 1, 0]]
    """
    system = np.asarray(matrix, dtype=np.int64)
    n = system.shape[1]
    system = np.unique(system, axis=0)  # conditions on all pairs of indices repeat many equations
    solved = QQ.from_integers(system.ravel().tolist(), len(system), n).null_space()
    rows = [primitive([int(x) for x in row]) for row in solved.parts[0].tolist()]
    return np.array(rows, dtype=np.int64).reshape(-1, n)


def primitive(values: ArrayLike) -> IntegerArray:
    """The integer array divided by the greatest common divisor of its entries.

    Examples
    --------
    >>> primitive([4, -6, 0]).tolist()
    [2, -3, 0]
    """
    array = np.asarray(values, dtype=np.int64)
    divisor = gcd(*(int(value) for value in array[array != 0]))
    return array // divisor if divisor > 1 else array


def as_matrices(matrices: ArrayLike) -> IntegerArray:
    """The matrices as one int64 array of shape (dim, N, N), checked.

    Raises
    ------
    ShapeError
        If this is not a list of square matrices of one size.
    InputError
        If an entry is not an integer.

    Examples
    --------
    >>> as_matrices([[[1, 0], [0, 1]]]).shape
    (1, 2, 2)
    """
    array = np.asarray(matrices)
    if array.ndim != 3 or array.shape[1] != array.shape[2]:
        raise ShapeError(f"an array of shape (dim, N, N) is needed; got shape {array.shape}")
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"integer matrices are needed; got entries of type {array.dtype}")
    return array.astype(np.int64, copy=False)


def stack(matrices: Iterable[IntegerArray], size: int) -> IntegerArray:
    """One array of shape (dim, size, size) from matrices; dim may be 0.

    Examples
    --------
    >>> stack([], 3).shape
    (0, 3, 3)
    """
    return np.array(list(matrices), dtype=np.int64).reshape(-1, size, size)


def unit(size: int, i: int, j: int) -> IntegerArray:
    """The elementary matrix E_ij, (size, size), with a one in row i and column j.

    Examples
    --------
    >>> unit(2, 0, 1).tolist()
    [[0, 1], [0, 0]]
    """
    matrix = np.zeros((size, size), dtype=np.int64)
    matrix[i, j] = 1
    return matrix


def require_size(name: str, value: int, least: int = 1) -> None:
    """Raise `InputError` unless the parameter is an integer >= `least`.

    Raises
    ------
    InputError
        With the name of the parameter, what was expected and what was given.
    LimitError
        If the parameter is larger than the limit of dimensions, as no parameter exceeds the dimension.

    Examples
    --------
    >>> require_size("n", 0)
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: n must be an integer >= 1; got 0
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise InputError(f"{name} must be an integer >= {least}; got {displayed(value)}")
    within("dimension", int(value), f"{name} is {{}}")


def require_basis(count: int, size: int) -> None:
    """Raise `LimitError` if a Lie algebra of `count` matrices (size, size) has too large a dimension or array.

    Examples
    --------
    >>> require_basis(4498500, 3000)
    Traceback (most recent call last):
    ...
    liehom.errors.LimitError: the algebra has dimension 4498500, the limit is 4096; raise it by ...
    """
    within("dimension", count, "the algebra has dimension {}")
    require_room(count, size)


def require_room(count: int, size: int, hint: str = "") -> None:
    """Raise `LimitError` if `count` dense matrices (size, size) need too much memory; `hint` says what helps.

    Examples
    --------
    >>> require_room(248, 30380)
    Traceback (most recent call last):
    ...
    liehom.errors.LimitError: 248 dense matrices of size 30380 are 1.83e+03 GB: 1831121689600 bytes, the limit is ...
    """
    needed = BYTES * count * size**2
    if needed > current_limits().memory:
        # the logarithm of an integer of any length is a float; the integer itself may be too large
        gigabytes = f"{needed / 1e9:.3g}" if needed < 10**16 else f"about 10^{int(log10(needed)) - 9}"
        dimension = str(size) if size < 10**15 else f"about 10^{int(log10(size))}"
        advice = f"; {hint}" if hint else ""
        what = f"{displayed(count)} dense matrices of size {dimension} are {gigabytes} GB{advice}: {{}} bytes"
        within("memory", needed, what)


def require_nonzero(name: str, values: Sequence[int]) -> None:
    """Raise `InputError` unless all entries are non-zero integers.

    Raises
    ------
    InputError
        With the name of the parameter and what was given.

    Examples
    --------
    >>> require_nonzero("diagonal", [1, 0])
    Traceback (most recent call last):
    ...
    liehom.errors.InputError: the entries of diagonal must be non-zero integers; got [1, 0]
    """
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value == 0:
            raise InputError(f"the entries of {name} must be non-zero integers; got {displayed(list(values))}")
