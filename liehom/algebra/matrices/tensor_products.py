"""Matrix bases on tensor products, symmetric and exterior powers, and symmetric matrices.

A acts on V (x) V by A (x) 1 + 1 (x) A. This induces the actions on Sym^k and Lambda^k, which are written in the bases
of monomials and of wedge products.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, combinations_with_replacement
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from liehom.algebra.matrices.matrix_basis import BYTES, as_matrices, require_basis, require_size, stack
from liehom.budget import within
from liehom.errors import InputError
from liehom.typing import IntegerArray


def tensor_sum(first: ArrayLike, second: ArrayLike) -> IntegerArray:
    """Basis of the sum of two linear Lie algebras on the tensor product: all A (x) 1, then all 1 (x) B.

    Parameters
    ----------
    first : (a, p, p) integers
        A matrix basis.
    second : (b, q, q) integers
        A matrix basis. If both contain the identity, the result is linearly dependent.

    Returns
    -------
    (a + b, p * q, p * q) int64

    Examples
    --------
    sl(4, R) + sl(2, R) on R^8:

    >>> from liehom.algebra.matrices.general_linear import sl
    >>> tensor_sum(sl(4), sl(2)).shape
    (18, 8, 8)
    """
    left, right = as_matrices(first), as_matrices(second)
    p, q = left.shape[1], right.shape[1]
    require_basis(len(left) + len(right), p * q)
    one_p, one_q = np.eye(p, dtype=np.int64), np.eye(q, dtype=np.int64)
    return stack([*(np.kron(a, one_q) for a in left), *(np.kron(one_p, b) for b in right)], p * q)


def symmetric_power(matrices: ArrayLike, k: int) -> IntegerArray:
    """Action on Sym^k, the polynomials of degree k in the basis vectors, in lexicographic monomials.

    Parameters
    ----------
    matrices : (dim, n, n) integers
        A matrix basis.
    k : int
        Degree, at least 0.

    Returns
    -------
    (dim, m, m) int64 with m = binomial(n + k - 1, k)
        A maps the monomial ``x_i1 ... x_ik`` to ``sum_r x_i1 ... (A x_ir) ... x_ik``.

    Raises
    ------
    InputError
        If k is not an integer at least 0.

    Examples
    --------
    sl(2, R) on binary quadratic forms, basis x^2, xy, y^2:

    >>> from liehom.algebra.matrices.general_linear import sl
    >>> symmetric_power(sl(2), 2)[0].tolist()
    [[0, 1, 0], [0, 0, 2], [0, 0, 0]]
    """
    basis = as_matrices(matrices)
    require_size("k", k, 0)
    n = basis.shape[1]
    require_basis(len(basis), comb(n + k - 1, k) if n else 1)
    return _induced(basis, list(combinations_with_replacement(range(basis.shape[1]), k)), alternating=False)


def exterior_power(matrices: ArrayLike, k: int) -> IntegerArray:
    """Action on Lambda^k, in the basis of the wedges ``e_i1 ^ ... ^ e_ik``, i1 < ... < ik, lexicographically.

    Parameters
    ----------
    matrices : (dim, n, n) integers
        A matrix basis.
    k : int
        Degree, from 0 to n.

    Returns
    -------
    (dim, m, m) int64 with m = binomial(n, k)

    Raises
    ------
    InputError
        If k is not an integer from 0 to n.

    Examples
    --------
    On the top power a matrix acts by its trace:

    >>> exterior_power([[[1, 7], [0, 2]]], 2).tolist()
    [[[3]]]
    """
    basis = as_matrices(matrices)
    require_size("k", k, 0)
    n = basis.shape[1]
    if k > n:
        raise InputError(f"Lambda^k of a space of dimension {n} needs k <= {n}; got k = {k}")
    require_basis(len(basis), comb(n, k))
    return _induced(basis, list(combinations(range(n), k)), alternating=True)


def congruence(matrices: ArrayLike) -> IntegerArray:
    """Action ``S -> A S + S A^T`` on the symmetric matrices.

    For skew-symmetric A this is the conjugation ``S -> A S - S A``.

    Parameters
    ----------
    matrices : (dim, n, n) integers
        A matrix basis.

    Returns
    -------
    (dim, m, m) int64 with m = n (n + 1) / 2
        In the basis E_ij + E_ji (i < j), E_ii, ordered by (i, j), i <= j: coordinates are the entries of S.

    Examples
    --------
    so(3) on Sym(3) = R^6 by conjugation:

    >>> from liehom.algebra.matrices.form_preserving import so
    >>> congruence(so(3)).shape
    (3, 6, 6)
    """
    basis = as_matrices(matrices)
    n = basis.shape[1]
    rows, columns = np.triu_indices(n)
    m = len(rows)
    require_basis(len(basis), m)
    within("memory", BYTES * len(basis) * m * n * n, "the images of symmetric matrices need {} bytes")
    elements = np.zeros((m, n, n), dtype=np.int64)
    elements[np.arange(m), rows, columns] = 1
    elements[np.arange(m), columns, rows] = 1
    images = basis[:, None] @ elements
    images = images + images.transpose(0, 1, 3, 2)
    return np.ascontiguousarray(images[:, :, rows, columns].transpose(0, 2, 1))


def companion_powers(coefficients: Sequence[int]) -> IntegerArray:
    """Regular representation of Q[t]/(f): the powers 1, C, ..., C^{n-1} of the companion matrix C of f.

    Parameters
    ----------
    coefficients : integers
        ``f = t**n + sum_i coefficients[i] t**i``; the leading coefficient 1 is omitted.

    Returns
    -------
    (n, n, n) int64

    Raises
    ------
    InputError
        If no coefficient is given.

    Examples
    --------
    The cyclotomic field Q(zeta_5), with f = t^4 + t^3 + t^2 + t + 1:

    >>> companion_powers([1, 1, 1, 1])[1].tolist()
    [[0, 0, 0, -1], [1, 0, 0, -1], [0, 1, 0, -1], [0, 0, 1, -1]]
    """
    n = len(coefficients)
    if n == 0:
        raise InputError("the polynomial must have degree at least 1; got no coefficient")
    require_basis(n, n)
    size = 1 + max(abs(int(c)) for c in coefficients)
    if n * size.bit_length() > 62:
        raise InputError("the powers of the companion matrix have entries of more than 63 bits; use smaller numbers")
    companion: IntegerArray = np.eye(n, k=-1, dtype=np.int64)
    companion[:, -1] = -np.asarray(coefficients, dtype=np.int64)
    return stack((np.linalg.matrix_power(companion, k) for k in range(n)), n)


def _induced(basis: IntegerArray, words: list[tuple[int, ...]], *, alternating: bool) -> IntegerArray:
    """The derived action on words in the basis vectors, a sum over the letters: e_i becomes sum_j A[j, i] e_j."""
    n = basis.shape[1]
    position = {word: row for row, word in enumerate(words)}
    result = np.zeros((len(basis), len(words), len(words)), dtype=np.int64)
    for column, word in enumerate(words):
        for index, letter in enumerate(word):
            for new in range(n):
                image = [*word[:index], new, *word[index + 1 :]]
                row = position.get(tuple(sorted(image)))
                if row is None:
                    continue
                sign = _sorting_sign(image, index) if alternating else 1
                result[:, row, column] += sign * basis[:, new, letter]
    return result


def _sorting_sign(word: list[int], index: int) -> int:
    """Sign of the permutation that sorts a word in which only the letter at `index` is out of order."""
    letter = word[index]
    greater_before = sum(other > letter for other in word[:index])
    smaller_after = sum(other < letter for other in word[index + 1 :])
    return -1 if (greater_before + smaller_after) % 2 else 1
