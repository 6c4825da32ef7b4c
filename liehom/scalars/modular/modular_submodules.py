"""Submodules modulo a large prime, from irreducible factors of characteristic polynomials.

Let a be a random element of the algebra that the matrices generate and f an irreducible factor of its characteristic
polynomial.  A vector of the kernel of f(a) lies in a proper submodule more often than other vectors do (the MeatAxe of
Holt and Rees).  The list of submodules need not be complete.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from math import isqrt

import flint

from liehom.budget import in_time

WORD = 2**63  # bound on the primes


def isotropic_submodules(maps: Sequence[int], form: Sequence[int], p: int, tries: int) -> Iterator[list[list[int]]]:
    """Submodules on which a form vanishes, each by its reduced echelon basis, modulo a prime below 2^63.

    Parameters
    ----------
    maps : sequence of int
        Matrices (n, n) that act on rows from the right, in the order of an array (k, n, n).
    form : sequence of int
        A matrix B in the order of an array (n, n): submodules of {x : x B = 0}.
    p : int
    tries : int
        Number of random sums of the matrices.

    Examples
    --------
    >>> maps = [0, 0, 0, 0, 1, 0, 0, 0, -1]  # diagonal with the entries 0, 1, -1
    >>> sorted(isotropic_submodules(maps, [2, 0, 0, 0, 0, 0, 0, 0, 0], 10**9 + 7, 1))
    [[[0, 0, 1]], [[0, 1, 0]]]
    """
    n = isqrt(len(form))
    rng = random.Random(n)
    values = [x % p for x in maps]
    matrices = [flint.nmod_mat(n, n, values[i : i + n * n], p) for i in range(0, len(values), n * n)]
    gram = flint.nmod_mat(n, n, [x % p for x in form], p)
    seen: set[str] = set()
    for _ in range(tries):
        action = sum((m * rng.randrange(p) for m in matrices[1:]), matrices[0] * rng.randrange(p))
        for factor, _ in action.charpoly().factor()[1]:
            in_time()
            start = _left_kernel(_value(factor, action))[:1]
            row = flint.nmod_mat(len(start), n, [x for row in start for x in row], p)
            if start and (row * gram).rank() == 0:
                space = _spun(start, matrices, n, p)
                if len(space) < n and str(space) not in seen:
                    seen.add(str(space))
                    yield space


def _value(polynomial: flint.nmod_poly, matrix: flint.nmod_mat) -> flint.nmod_mat:
    """The matrix f(A), by Horner's rule."""
    n, p = matrix.nrows(), matrix.modulus()
    total = flint.nmod_mat(n, n, [0] * n * n, p)
    for c in reversed(polynomial.coeffs()):
        total = total * matrix + flint.nmod_mat(n, n, [int(c) * (i == j) for i in range(n) for j in range(n)], p)
    return total


def _left_kernel(matrix: flint.nmod_mat) -> list[list[int]]:
    """A basis of the rows x with x A = 0."""
    columns, nullity = matrix.transpose().nullspace()
    return [[int(x) for x in row] for row in columns.transpose().tolist()[:nullity]]


def _spun(rows: list[list[int]], maps: list[flint.nmod_mat], n: int, p: int) -> list[list[int]]:
    """The reduced echelon basis of the smallest space that contains the rows and is invariant under the maps."""
    rank = 0
    while rank < len(rows) < n:
        rank = len(rows)
        space = flint.nmod_mat(rank, n, [x for row in rows for x in row], p)
        images = [[int(x) for x in row] for m in maps for row in (space * m).tolist()]
        table = [*rows, *images]
        reduced, size = flint.nmod_mat(len(table), n, [x for row in table for x in row], p).rref()
        rows = [[int(x) for x in row] for row in reduced.tolist()[:size]]
    return rows
