"""The check of `verify_modular` modulo one prime for large sparse pairs, with scipy's sparse matrices of int64.

Entries stay in [0, p), and products of matrices have at most n terms, with n p^2 < 2^53.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from liehom.errors import CertificateError
from liehom.fullness.checker.integral_pair import Integers, IntegralPair

Sparse: TypeAlias = Any
"""A sparse matrix of scipy, which has no types."""

_BLOCK = 64
"""Elements of h whose brackets with all of h are checked at once."""


def check_sparse(prime: int, pair: IntegralPair, constants: Integers, quotient: Integers, isotropy: Integers) -> None:
    """Check that h is closed and rho a representation modulo a prime, as `verify_modular._check_dense` does.

    Parameters
    ----------
    prime : int
    pair : IntegralPair
    constants, quotient, isotropy : arrays of int64
        The c', Q' and R' of the pair modulo the prime; shapes (number of constants,), (n, d) and (k, d d).
    """
    from scipy.sparse import csr_matrix

    n, k, d = pair.dimension, len(pair.pivots), len(pair.free)
    pivots, scale = list(pair.pivots), pair.scale % prime
    table = _table(n, pair.places, constants)  # (i; j, m)
    lift = csr_matrix(quotient[pivots])
    basis = _chosen(range(k), pivots, (k, n), scale) - lift @ _chosen(range(d), pair.free, (d, n), 1)
    projection, rho = csr_matrix(quotient), csr_matrix(isotropy)
    by_row = _swapped(rho, k, d, d)  # (w; p, v)
    action = _product(prime, basis, _product(prime, table.reshape(n * n, n), projection).reshape(n, n * d))
    closed = scale * _swapped(action, k, n, d) - _product(prime, projection, by_row)
    if np.any(closed.data % prime):
        raise CertificateError("closed", "a bracket of two elements of h is not in h")
    stacked = rho.reshape(k * d, d).tocsr()
    pivotal = table.reshape(n * n, n).tocsc()[:, pivots].reshape(n, n * k)
    for start in range(0, k, _BLOCK):
        stop = min(start + _BLOCK, k)
        b = stop - start
        inner = _swapped(_product(prime, basis[start:stop], pivotal), b, n, k)  # (j; p, r)
        inner = _product(prime, basis, inner).reshape(k * b, k)  # (q, p; r): [h'_p, h'_q]
        left = _product(prime, inner, rho).reshape(k, b * d * d)  # (q; p, w, v)
        first = _product(prime, stacked[start * d : stop * d], by_row)  # (p, w; q, v): R_p R_q
        first = _swapped(first, b * d, k, d)  # (q; p, w, v)
        second = _product(prime, stacked, _swapped(rho[start:stop], b, d, d))  # (q, w; p, v): R_q R_p
        second = _swapped(_swapped(second, k * d, b, d), b, k, d * d)  # by (p; q, w, v) to (q; p, w, v)
        if np.any((left + first - second).data % prime):
            raise CertificateError(
                "homomorphism", "rho([a, b]) is not rho(a) rho(b) - rho(b) rho(a) for some a, b in h"
            )


def _table(n: int, places: Integers, constants: Integers) -> Sparse:
    """Structure constants (i; j, m), antisymmetric in i and j."""
    from scipy.sparse import csr_matrix

    i, j, m = places.T
    rows, columns = np.concatenate([i, j]), np.concatenate([j * n + m, i * n + m])
    return csr_matrix((np.concatenate([constants, -constants]), (rows, columns)), shape=(n, n * n))


def _chosen(rows: Sequence[int], columns: Sequence[int], shape: tuple[int, int], entry: int) -> Sparse:
    """Matrix with one value at the given positions and 0 elsewhere."""
    from scipy.sparse import csr_matrix

    return csr_matrix((np.full(len(rows), entry, dtype=np.int64), (list(rows), list(columns))), shape=shape)


def _product(prime: int, left: Sparse, right: Sparse) -> Sparse:
    """Product modulo the prime of factors whose entries are below the prime in absolute value."""
    product = left.tocsr() @ right.tocsr()
    product.data %= prime
    product.eliminate_zeros()
    return product


def _swapped(matrix: Sparse, a: int, b: int, c: int) -> Sparse:
    """Matrix of shape (b, a c) with rows j and columns (i, l), from one with rows i and columns (j, l)."""
    from scipy.sparse import coo_matrix

    entries = matrix.tocoo()
    j, l = np.divmod(entries.col.astype(np.int64), c)
    return coo_matrix((entries.data, (j, entries.row.astype(np.int64) * c + l)), shape=(b, a * c)).tocsr()
