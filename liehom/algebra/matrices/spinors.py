"""Matrix bases of the real spin representations of spin(p, q), by signed permutation matrices.

Clifford generators of signature (p, q) are anticommuting matrices, p of square 1 and then q of square -1, here on an
irreducible module. They are built from the left multiplications of C, H, O by the steps

    (p+1, q+1): g (x) sz, 1 (x) sx, 1 (x) ep        (n+2, 0) from (0, n): g (x) ep, 1 (x) sx, 1 (x) sz
    (0, n+8): g (x) w, 1 (x) G                       with G of signature (0, 8) and w their product,

where sx and sz are the symmetric Pauli matrices and ep is the skew-symmetric one. The products e_i e_j (i < j) of
generators of signature (p, q) span spin(p, q). The e_i e_n generate the even Clifford algebra, and they are Clifford
generators of signature (p, q-1) or (q, p-1). So the generators g_i of that signature and their products g_i g_j span
the half-spin or spin representation.
"""

from __future__ import annotations

from functools import reduce
from itertools import combinations

import numpy as np

from liehom.algebra.matrices.composition_algebra import OCTONIONS, cayley_dickson, left_multiplications
from liehom.algebra.matrices.matrix_basis import require_basis, require_room, require_size, stack
from liehom.errors import InputError, displayed
from liehom.typing import IntegerArray

_SX: IntegerArray = np.array([[0, 1], [1, 0]], dtype=np.int64)
_SZ: IntegerArray = np.array([[1, 0], [0, -1]], dtype=np.int64)
_EP: IntegerArray = np.array([[0, -1], [1, 0]], dtype=np.int64)


def clifford(p: int, q: int) -> IntegerArray:
    """Clifford generators on an irreducible module: anticommuting signed permutation matrices (p + q, N, N).

    Parameters
    ----------
    p, q : int
        Not negative.

    Returns
    -------
    (p + q, N, N) int64
        First p matrices of square 1, then q of square -1. N is the real dimension of the irreducible
        Clifford modules.

    Raises
    ------
    InputError
        If p or q is not an integer at least 0.

    Examples
    --------
    The seven left multiplications by imaginary octonions, and the nine generators that give spin(9, 1):

    >>> clifford(0, 7).shape, clifford(9, 0).shape
    ((7, 8, 8), (9, 16, 16))
    """
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_room(p + q, 2 ** ((p + q) // 2))
    common = min(p, q)
    start = _positive(p - common) if p > q else _negative(q - common)
    plus, minus = [*start[: p - common]], [*start[p - common :]]
    for _ in range(common):
        one = np.eye(_size(plus, minus), dtype=np.int64)
        plus = [np.kron(g, _SZ) for g in plus] + [np.kron(one, _SX)]
        minus = [np.kron(g, _SZ) for g in minus] + [np.kron(one, _EP)]
    return stack([*plus, *minus], _size(plus, minus))


def spin(p: int, q: int = 0, *, chirality: int = 1) -> IntegerArray:
    """Basis of spin(p, q) on its real spin representation, or on one of its two half-spin representations.

    Parameters
    ----------
    p, q : int
        Not negative, with n = p + q at least 2.
    chirality : 1 or -1
        Selects one of the two half-spin representations if there are two; otherwise both values are equivalent.

    Returns
    -------
    (n * (n - 1) / 2, N, N) int64
        Signed permutation matrices: spin(7) and spin(4, 3) on R^8; spin(9), spin(8, 1), spin(9, 1) and
        spin(5, 5) on R^16.

    Raises
    ------
    InputError
        If p or q is negative, p + q < 2, or chirality is not 1 or -1.

    Examples
    --------
    >>> spin(7).shape, spin(9, 1).shape
    ((21, 8, 8), (45, 16, 16))
    """
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_size("p + q", p + q, 2)
    if chirality not in (1, -1):
        raise InputError(f"chirality must be 1 or -1; got {displayed(chirality)}")
    generators = chirality * (clifford(p, q - 1) if q else clifford(0, p - 1))
    require_basis(len(generators) * (len(generators) + 1) // 2, generators.shape[1])
    products = [a @ b for a, b in combinations(generators, 2)]
    return stack([*generators, *products], generators.shape[1])


def _size(*families: list[IntegerArray]) -> int:
    """Size of the matrices; 1 if there are none."""
    return next((len(matrix) for family in families for matrix in family), 1)


def _positive(n: int) -> IntegerArray:
    """Generators of signature (n, 0)."""
    if n == 0:
        return stack([], 1)
    if n == 1:
        return np.ones((1, 1, 1), dtype=np.int64)
    base = _negative(n - 2)
    one = np.eye(base.shape[1], dtype=np.int64)
    return stack([*(np.kron(g, _EP) for g in base), np.kron(one, _SX), np.kron(one, _SZ)], 2 * base.shape[1])


def _negative(n: int) -> IntegerArray:
    """Generators of signature (0, n)."""
    if n == 0:
        return stack([], 1)
    if n <= 7:
        doublings = n.bit_length()
        return left_multiplications(cayley_dickson(OCTONIONS[:doublings]))[1 : n + 1]
    octonionic = _negative(7)
    eight = [*(np.kron(g, _SX) for g in octonionic), np.kron(np.eye(8, dtype=np.int64), _EP)]
    if n == 8:
        return stack(eight, 16)
    volume = reduce(np.matmul, eight)
    base = _negative(n - 8)
    one = np.eye(base.shape[1], dtype=np.int64)
    return stack([*(np.kron(g, volume) for g in base), *(np.kron(one, g) for g in eight)], 16 * base.shape[1])
