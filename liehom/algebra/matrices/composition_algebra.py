"""Multiplication tables of the quadratic, quaternion and octonion algebras over Q, by Cayley-Dickson doubling.

Starting from Q, each parameter c doubles the algebra:

    (a, b)(a', b') = (a a' + c conj(b') b,  b' a + b conj(a')),   conj(a, b) = (conj(a), -b).

So (-1,) gives C, (-1, -1) the quaternions, (a, b) the quaternion algebra with i^2 = a and j^2 = b, (-1, -1, -1) the
octonions and (-1, -1, 1) the split octonions. A table t of shape (m, m, m) holds e_i e_j = sum_k t[i, j, k] e_k. The
identity is e_0, and every e_i e_j is a multiple of one basis element.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from liehom.algebra.matrices.matrix_basis import require_nonzero
from liehom.errors import InputError
from liehom.typing import IntegerArray

OCTONIONS = (-1, -1, -1)
SPLIT_OCTONIONS = (-1, -1, 1)


def cayley_dickson(parameters: Sequence[int]) -> IntegerArray:
    """Multiplication table (m, m, m) of the composition algebra with given doubling parameters.

    Parameters
    ----------
    parameters : at most three non-zero integers
        The squares of the elements that the doublings adjoin.

    Returns
    -------
    (m, m, m) int64
        ``e_i e_j = sum_k table[i, j, k] e_k`` with ``m = 2 ** len(parameters)``.

    Raises
    ------
    InputError
        If a parameter is zero, or there are more than three (then the norm is not multiplicative).

    Examples
    --------
    i j = k in the quaternions, with i, j, k = e_1, e_2, e_3:

    >>> cayley_dickson((-1, -1))[1, 2].tolist()
    [0, 0, 0, 1]
    """
    require_nonzero("parameters", parameters)
    if len(parameters) > 3:
        raise InputError(f"a composition algebra has at most 3 parameters; got {len(parameters)}")
    table: IntegerArray = np.ones((1, 1, 1), dtype=np.int64)
    for parameter in parameters:
        table = _double(table, parameter)
    return table


def conjugation(table: ArrayLike) -> IntegerArray:
    """Diagonal of the conjugation, shape (m,): 1 for the identity, -1 for the imaginary units.

    Examples
    --------
    >>> conjugation(cayley_dickson((-1, -1))).tolist()
    [1, -1, -1, -1]
    """
    signs = -np.ones(len(np.asarray(table)), dtype=np.int64)
    signs[0] = 1
    return signs


def norm_diagonal(table: ArrayLike) -> IntegerArray:
    """Diagonal of the norm form ``n(e_i) = e_i conj(e_i)``, shape (m,); the basis is orthogonal for it.

    Examples
    --------
    >>> norm_diagonal(cayley_dickson((-1, 3))).tolist()
    [1, 1, -3, -3]
    """
    products = np.asarray(table, dtype=np.int64)
    return np.diagonal(products[:, :, 0]) * conjugation(products)


def left_multiplications(table: ArrayLike) -> IntegerArray:
    """Matrices of ``x -> e_i x``, shape (m, m, m), first axis i.

    Examples
    --------
    >>> left_multiplications(cayley_dickson((-1,)))[1].tolist()
    [[0, -1], [1, 0]]
    """
    return np.asarray(table, dtype=np.int64).transpose(0, 2, 1).copy()


def right_multiplications(table: ArrayLike) -> IntegerArray:
    """Matrices of ``x -> x e_i``, shape (m, m, m), first axis i.

    In an associative algebra they commute with the left multiplications.

    Examples
    --------
    >>> right_multiplications(cayley_dickson((-1,)))[1].tolist()
    [[0, -1], [1, 0]]
    """
    return np.asarray(table, dtype=np.int64).transpose(1, 2, 0).copy()


def _double(table: IntegerArray, parameter: int) -> IntegerArray:
    """The table (2m, 2m, 2m) of the Cayley-Dickson double."""
    m = len(table)
    signs = conjugation(table)
    double = np.zeros((2 * m, 2 * m, 2 * m), dtype=np.int64)
    double[:m, :m, :m] = table
    double[:m, m:, m:] = table.transpose(1, 0, 2)  # (a, 0)(0, b') = (0, b' a)
    double[m:, :m, m:] = table * signs[None, :, None]  # (0, b)(a', 0) = (0, b conj(a'))
    double[m:, m:, :m] = parameter * table.transpose(1, 0, 2) * signs[None, :, None]  # (c conj(b') b, 0)
    return double
