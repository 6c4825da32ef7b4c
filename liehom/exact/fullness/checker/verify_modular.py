"""Proofs modulo enough primes, dense and sparse; part of the independent checker."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isqrt
from typing import Any, SupportsInt, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.budget import in_time
from liehom.base.errors import CertificateError
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.number_fields import NumberField

# Data of a pair with denominators cleared, which `verify_modular` and `verify_sparse` reduce modulo primes.

Integers: TypeAlias = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class IntegralPair:
    """Pair with denominators cleared: c' = delta c, Q' = q Q, h'_p = q h_p = q e_p - Q'_p e_free.

    The isotropy R'_p[u, v] = ([h'_p, e_u]' Q')_v, where [x, y]' = delta [x, y] and u counts the free indices,
    is delta q^2 R_p. The notation is that of `liehom.exact.fullness.checker.verify_pair`.
    """

    field: ExactField
    dimension: int
    free: tuple[int, ...]
    pivots: tuple[int, ...]
    places: Integers
    """Indices (i, j, k) of the structure constants, i < j; shape (number, 3)."""
    constants: ExactMatrix
    """Constants c' at these indices, shape (1, number)."""
    quotient: ExactMatrix
    """Q', shape (n, d)."""
    scale: int
    """q."""
    isotropy: ExactMatrix
    """R', shape (k, d d)."""


# The check of `verify_modular` modulo one prime for large sparse pairs, with scipy's sparse matrices of int64.
#
# Entries stay in [0, p), and products of matrices have at most n terms, with n p^2 < 2^53.

Sparse: TypeAlias = Any
"""A sparse matrix of scipy, which has no types."""

_BLOCK = 64
"""Elements of h whose brackets with all of h are checked at once."""


def check_sparse(prime: int, pair: IntegralPair, constants: Integers, quotient: Integers, isotropy: Integers) -> None:
    """Check that h is closed and rho a representation modulo a prime, as `verify_modular._check_dense` does."""
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


# Proof modulo enough primes that h is closed and rho is a representation; part of the independent checker.
#
# After denominators are cleared, both facts say that certain elements z of Z[b] vanish (b is an algebraic integer that
# generates the field; Z[b] = Z over QQ). A prime p and a root of the minimal polynomial F of b modulo p give a ring
# homomorphism Z[b] -> F_p. If z is not 0 but maps to 0, then p divides the norm of z, a nonzero integer, since F and z
# have a common root modulo p. The absolute value of the norm is at most B^m if all m conjugates of z are at most B. So
# z = 0 if it maps to 0 modulo different primes whose product exceeds B^m.
#
# Modulo one prime, numpy computes in float64; for large sparse pairs, scipy computes with sparse matrices
# (`verify_sparse`).

Floats: TypeAlias = npt.NDArray[np.float64]

_DENSE_SIZE = 300
"""Largest dimension of g for which dense matrices may be used."""
_BLOCK_ENTRIES = 1 << 22
"""Entries of the largest array of one block of elements of h."""


class _Numbers:
    """Elements of Z[b] as integer coordinates, from which images in F_p are computed."""

    __slots__ = ("parts", "shape")

    def __init__(self, matrix: ExactMatrix) -> None:
        self.shape = matrix.shape
        self.parts = [_integers(part.entries()) for part in matrix.cleared().parts]

    def image(self, prime: int, root: int) -> Integers:
        """Images of the entries modulo the prime, for b -> root; int64 in [0, prime)."""
        total = np.zeros(self.parts[0].shape, dtype=np.int64)
        for part in reversed(self.parts):
            total = (total * root + (part % prime).astype(np.int64)) % prime
        return total.reshape(self.shape)

    def sizes(self, generator: int) -> npt.NDArray[np.object_]:
        """Bounds of the absolute values of all conjugates, if the conjugates of b are at most `generator`."""
        total = np.zeros(self.parts[0].shape, dtype=object)
        for part in reversed(self.parts):
            total = total * generator + np.abs(part.astype(object))
        return total.reshape(self.shape)


def _integers(entries: Sequence[SupportsInt]) -> npt.NDArray[Any]:
    """Array of int64 if all entries are below 2^62 in absolute value, else of Python integers."""
    values = [int(x) for x in entries]
    small = all(-(1 << 62) < x < 1 << 62 for x in values)
    return np.array(values, dtype=np.int64 if small else object)


def check_representation(pair: IntegralPair) -> None:
    """Check that h is closed and that rho([a, b]) = rho(a) rho(b) - rho(b) rho(a) for all a, b in h."""
    n, k, d = pair.dimension, len(pair.pivots), len(pair.free)
    if k == 0 or d == 0:
        return
    numbers = [_Numbers(matrix) for matrix in (pair.constants, pair.quotient, pair.isotropy)]
    bound = _bound(pair, *numbers) ** pair.field.degree
    product = 1
    for prime, root in _primes(pair.field, n):
        if product > bound:
            return
        in_time()
        constants, quotient, isotropy = (x.image(prime, root) for x in numbers)
        if _is_dense(n, len(pair.places)):
            _check_dense(prime, pair, constants[0], quotient, isotropy)
        else:
            check_sparse(prime, pair, constants[0], quotient, isotropy)
        product *= prime
    raise CertificateError("pair", "the numbers of the pair are too large for the checker")


def _is_dense(n: int, number: int) -> bool:
    """Whether dense matrices are faster."""
    return n <= 80 or (n <= _DENSE_SIZE and 40 * number > n**3)


def _bound(pair: IntegralPair, constants: _Numbers, quotient: _Numbers, isotropy: _Numbers) -> int:
    """Bound of all conjugates of the elements that the checks compare with 0.

    Let |.| be the sum of the sizes of the coordinates, so that |[x, y]'| <= g |x| |y| for g = max |[e_i, e_j]'|. Let
    l = max |h'_p|, and let m and r bound the entries of Q' and R'. Then

        q [h'_p, e_j]' Q' - Q'_j R'_p             is at most  q g l m + d m r,
        sum_r x_r R'_r - (R'_q R'_p - R'_p R'_q)  is at most  g l^2 r + 2 d r^2,  x = [h'_p, h'_q]'.
    """
    modulus = [int(c) for c in pair.field.modulus.coeffs()] if isinstance(pair.field, NumberField) else [0]
    generator = 1 + max(map(abs, modulus))  # Cauchy's bound of all roots
    totals: dict[tuple[int, int], int] = {}
    for (i, j, _), size in zip(pair.places.tolist(), constants.sizes(generator)[0], strict=True):
        totals[i, j] = totals.get((i, j), 0) + size
    g, d, q = max(totals.values(), default=0), len(pair.free), pair.scale
    rows = quotient.sizes(generator)
    l = q + max(sum(rows[p]) for p in pair.pivots)
    m, r = int(rows.max()), int(isotropy.sizes(generator).max())
    return int(max(q * g * l * m + d * m * r, g * l * l * r + 2 * d * r * r))


def _primes(field: ExactField, n: int) -> Iterator[tuple[int, int]]:
    """Different primes p with n p^2 < 2^53, each with a root of the minimal polynomial of b modulo p."""
    limit = isqrt((1 << 53) // max(n, 64))
    if not isinstance(field, NumberField):
        yield from ((p, 0) for p in range(limit, 2, -1) if _is_prime(p))
        return
    modulus = tuple(int(c) for c in field.modulus.coeffs())
    for p in filter(_is_prime, range(min(1 << 15, limit), limit)):
        root = _root(modulus, p)
        if root is not None:
            yield p, root


@lru_cache(maxsize=1 << 12)
def _root(modulus: tuple[int, ...], p: int) -> int | None:
    """The smallest root modulo p < 2^31 of a polynomial with these ascending coefficients, or None."""
    points = np.arange(p, dtype=np.int64)
    values = np.zeros(p, dtype=np.int64)
    for c in reversed(modulus):
        values = (values * points + c % p) % p
    roots = np.flatnonzero(values == 0)
    return int(roots[0]) if len(roots) else None


@lru_cache(maxsize=1 << 12)
def _is_prime(candidate: int) -> bool:
    return candidate % 2 == 1 and all(candidate % f for f in range(3, isqrt(candidate) + 1, 2))


def _check_dense(prime: int, pair: IntegralPair, constants: Integers, quotient: Integers, isotropy: Integers) -> None:
    """Check the two identities of `_bound` modulo a prime, in float64.

    The first identity, for all j, says [h_p, e_j] Q = Q_j R_p: so [h_p, .] Q factors over V and vanishes on h. The
    second is rho([h_p, h_q]) = rho(h_p) rho(h_q) - rho(h_q) rho(h_p) times delta^2 q^4: the bracket x lies in h, so it
    is the sum of x_r h_r over the pivots r. Products have entries below n p^2 < 2^53 and are exact.
    """
    n, k, d = pair.dimension, len(pair.pivots), len(pair.free)
    pivots, free = list(pair.pivots), list(pair.free)
    table = np.zeros((n, n, n))
    i, j, m = pair.places.T
    table[i, j, m] = constants
    table[j, i, m] = -constants
    projection, rho = quotient.astype(np.float64), isotropy.astype(np.float64).reshape(k, d, d)
    scale, lift = pair.scale % prime, projection[pivots]
    by_row = rho.transpose(1, 0, 2).reshape(d, k * d)  # (w; q, v)
    from_free = table[free].reshape(d, n * n)
    size = max(1, _BLOCK_ENTRIES // (n * n + k * d * d))
    for start in range(0, k, size):
        stop = min(start + size, k)
        b, chosen = stop - start, slice(start, stop)
        action = _reduced(
            prime, scale * table[pivots[chosen]] - _reduced(prime, lift[chosen] @ from_free).reshape(b, n, n)
        )
        factored = _reduced(prime, projection @ rho[chosen])
        if _reduced(prime, scale * _reduced(prime, action @ projection) - factored).any():
            raise CertificateError("closed", "a bracket of two elements of h is not in h")
        action = action[:, :, pivots]  # (p, j, r)
        inner = scale * action[:, pivots[:stop]] - _reduced(prime, lift[:stop] @ action[:, free])  # (p, q, r)
        left = _reduced(prime, _reduced(prime, inner).reshape(b * stop, k) @ rho.reshape(k, d * d))
        first = _reduced(prime, rho[chosen].reshape(b * d, d) @ by_row[:, : stop * d])  # (p, w, q, v): R_p R_q
        second = _reduced(prime, rho[:stop].reshape(stop * d, d) @ by_row[:, start * d : stop * d])  # (q, w, p, v)
        difference = left.reshape(b, stop, d, d) + first.reshape(b, d, stop, d).transpose(0, 2, 1, 3)
        difference -= second.reshape(stop, d, b, d).transpose(2, 0, 1, 3)
        if _reduced(prime, difference).any():
            raise CertificateError(
                "homomorphism", "rho([a, b]) is not rho(a) rho(b) - rho(b) rho(a) for some a, b in h"
            )


def _reduced(prime: int, array: Floats) -> Floats:
    """Integers below 2^53 modulo the prime, in (-0.51 p, 0.51 p); the result is 0 only for multiples of p."""
    return array - np.rint(array * (1.0 / prime)) * prime
