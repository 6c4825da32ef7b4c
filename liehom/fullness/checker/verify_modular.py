"""That h is closed and rho a representation, proved modulo enough primes; part of the independent checker.

Once denominators are cleared both facts say that certain elements z of Z[b] vanish (b an algebraic integer that
generates the field; Z[b] = Z over QQ).  A prime p and a root of the minimal polynomial F of b modulo p give a
ring homomorphism Z[b] -> F_p.  If z is not 0 but is sent to 0, then p divides the norm of z, a nonzero
integer, as F and z have a common root modulo p.  The norm is at most B^m in absolute value if all m conjugates
of z are at most B.  So z = 0 if it is sent to 0 modulo different primes whose product is above B^m.

The work modulo one prime is done by numpy in float64, here, or for large sparse pairs by scipy in
`verify_sparse`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isqrt
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import CertificateError
from liehom.fullness.checker.verify_sparse import check_sparse
from liehom.scalars import ExactField, ExactMatrix, NumberField

_DENSE_SIZE = 300
_BLOCK_ENTRIES = 1 << 22


@dataclass(frozen=True, slots=True)
class IntegralPair:
    """A pair with denominators cleared: c' = delta c, Q' = q Q, h'_p = q h_p = q e_p - Q'_p e_free.

    The isotropy R'_p[u, v] = ([h'_p, e_u]' Q')_v, where [x, y]' = delta [x, y] and u counts the free indices,
    is delta q^2 R_p.  See `liehom.fullness.checker.verify_pair` for the notation.
    """

    field: ExactField
    dimension: int
    free: tuple[int, ...]
    pivots: tuple[int, ...]
    places: npt.NDArray[np.int64]
    """The (i, j, k) of the structure constants, i < j, shape (number, 3)."""
    constants: ExactMatrix
    """c' at the places, shape (1, number)."""
    quotient: ExactMatrix
    """Q', shape (n, d)."""
    scale: int
    """q."""
    isotropy: ExactMatrix
    """R', shape (k, d d)."""


class _Numbers:
    """Elements of Z[b] by their integer coordinates, ready to be sent to F_p."""

    __slots__ = ("parts", "shape")

    def __init__(self, matrix: ExactMatrix) -> None:
        self.shape = matrix.shape
        self.parts = [_integers(part.entries()) for part in matrix.cleared().parts]

    def image(self, prime: int, root: int) -> npt.NDArray[np.int64]:
        """The entries modulo the prime."""
        total = np.zeros(self.parts[0].shape, dtype=np.int64)
        for part in reversed(self.parts):
            total = (total * root + (part % prime).astype(np.int64)) % prime
        return total.reshape(self.shape)

    def sizes(self, generator: int) -> npt.NDArray[np.object_]:
        """Bounds of the absolute values of all conjugates, those of b being at most `generator`."""
        total = np.zeros(self.parts[0].shape, dtype=object)
        for part in reversed(self.parts):
            total = total * generator + np.abs(part.astype(object))
        return total.reshape(self.shape)


def _integers(entries: Sequence[Any]) -> npt.NDArray[Any]:
    values = [int(x) for x in entries]
    small = all(-(1 << 62) < x < 1 << 62 for x in values)
    return np.array(values, dtype=np.int64 if small else object)


def check_representation(pair: IntegralPair) -> None:
    """Check that h is closed and that rho([a, b]) = rho(a) rho(b) - rho(b) rho(a) for all a, b in h.

    Raises
    ------
    CertificateError
        With the check "closed" or "homomorphism".
    """
    n, k, d = pair.dimension, len(pair.pivots), len(pair.free)
    if k == 0 or d == 0:
        return
    numbers = [_Numbers(matrix) for matrix in (pair.constants, pair.quotient, pair.isotropy)]
    bound = _bound(pair, *numbers) ** pair.field.degree
    product = 1
    for prime, root in _primes(pair.field, n):
        if product > bound:
            return
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
    """A bound of all conjugates of the elements that the checks compare with 0.

    With |.| the sum over coordinates of the sizes, |[x, y]'| <= g |x| |y| for g = max |[e_i, e_j]'|; let
    l = max |h'_p|, and m and r bound the entries of Q' and R'.  Then

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
    """Different primes, each with a root of the minimal polynomial of b; n p^2 < 2^53 for all of them."""
    limit = isqrt((1 << 53) // max(n, 64))
    if not isinstance(field, NumberField):
        yield from ((p, 0) for p in range(limit, 2, -1) if _is_prime(p))
        return
    modulus = [int(c) for c in field.modulus.coeffs()]
    for p in filter(_is_prime, range(min(1 << 15, limit), limit)):
        points = np.arange(p, dtype=np.int64)
        values = np.zeros(p, dtype=np.int64)
        for c in reversed(modulus):
            values = (values * points + c % p) % p
        roots = np.flatnonzero(values == 0)
        if len(roots):
            yield p, int(roots[0])


def _is_prime(candidate: int) -> bool:
    return candidate % 2 == 1 and all(candidate % f for f in range(3, isqrt(candidate) + 1, 2))


def _check_dense(prime: int, pair: IntegralPair, constants: Any, quotient: Any, isotropy: Any) -> None:
    """Check the two identities of `_bound` modulo a prime, in float64.

    The first at all j says [h_p, e_j] Q = Q_j R_p: so [h_p, .] Q factors over V, it vanishes on h.  The second is
    rho([h_p, h_q]) = rho(h_p) rho(h_q) - rho(h_q) rho(h_p) times delta^2 q^4: the bracket x lies in h, so it is
    the sum of x_r h_r over the pivots r.  Products have entries below n p^2 < 2^53 and are exact.
    """
    n, k, d = pair.dimension, len(pair.pivots), len(pair.free)
    pivots, free = list(pair.pivots), list(pair.free)
    table = np.zeros((n, n, n))
    i, j, m = pair.places.T
    table[i, j, m] = constants
    table[j, i, m] = -constants
    quotient, rho = quotient.astype(np.float64), isotropy.astype(np.float64).reshape(k, d, d)
    scale, lift = pair.scale % prime, quotient[pivots]
    by_row = rho.transpose(1, 0, 2).reshape(d, k * d)  # (w; q, v)
    from_free = table[free].reshape(d, n * n)
    size = max(1, _BLOCK_ENTRIES // (n * n + k * d * d))
    for start in range(0, k, size):
        stop = min(start + size, k)
        b, chosen = stop - start, slice(start, stop)
        action = _reduced(
            prime, scale * table[pivots[chosen]] - _reduced(prime, lift[chosen] @ from_free).reshape(b, n, n)
        )
        factored = _reduced(prime, quotient @ rho[chosen])
        if _reduced(prime, scale * _reduced(prime, action @ quotient) - factored).any():
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


def _reduced(prime: int, array: Any) -> Any:
    """Integers below 2^53 modulo the prime, in (-0.51 p, 0.51 p): 0 only for multiples of p."""
    return array - np.rint(array * (1.0 / prime)) * prime
