"""One prime's worth of `verify_modular` for large sparse pairs, with scipy's sparse matrices of 64-bit integers.

Entries are kept in [0, p) and products of matrices have at most n terms, with n p^2 < 2^53.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.errors import CertificateError

_BLOCK = 64


def check_sparse(prime: int, pair: Any, constants: Any, quotient: Any, isotropy: Any) -> None:
    """Check that h is closed and rho a representation modulo a prime, as `verify_modular._check_dense` does.

    Parameters
    ----------
    prime : int
    pair : IntegralPair
    constants, quotient, isotropy : arrays of int64
        Its c', Q' and R' modulo the prime, shapes (number of constants,), (n, d) and (k, d d).
    """
    from scipy.sparse import csr_matrix

    n, k, d = pair.dimension, len(pair.pivots), len(pair.free)
    pivots, scale = list(pair.pivots), pair.scale % prime
    table = _table(n, pair.places, constants)  # (i; j, m)
    lift = csr_matrix(quotient[pivots])
    basis = _chosen(range(k), pivots, (k, n), scale) - lift @ _chosen(range(d), pair.free, (d, n), 1)
    quotient, rho = csr_matrix(quotient), csr_matrix(isotropy)
    by_row = _swapped(rho, k, d, d)  # (w; p, v)
    action = _product(prime, basis, _product(prime, table.reshape(n * n, n), quotient).reshape(n, n * d))
    closed = scale * _swapped(action, k, n, d) - _product(prime, quotient, by_row)
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


def _table(n: int, places: Any, constants: Any) -> Any:
    from scipy.sparse import csr_matrix

    i, j, m = places.T
    rows, columns = np.concatenate([i, j]), np.concatenate([j * n + m, i * n + m])
    return csr_matrix((np.concatenate([constants, -constants]), (rows, columns)), shape=(n, n * n))


def _chosen(rows: Any, columns: Any, shape: tuple[int, int], entry: int) -> Any:
    from scipy.sparse import csr_matrix

    return csr_matrix((np.full(len(rows), entry, dtype=np.int64), (list(rows), list(columns))), shape=shape)


def _product(prime: int, left: Any, right: Any) -> Any:
    """The product modulo the prime; the factors have entries of absolute value below it."""
    product = left.tocsr() @ right.tocsr()
    product.data %= prime
    product.eliminate_zeros()
    return product


def _swapped(matrix: Any, a: int, b: int, c: int) -> Any:
    """Entries (i; j, l) of a matrix of shape (a, b c) to (j; i, l) of shape (b, a c)."""
    from scipy.sparse import coo_matrix

    entries = matrix.tocoo()
    j, l = np.divmod(entries.col.astype(np.int64), c)
    return coo_matrix((entries.data, (j, entries.row.astype(np.int64) * c + l)), shape=(b, a * c)).tocsr()
