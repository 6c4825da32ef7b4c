"""Lattices in QQ^n: reduced bases, preimages of integer vectors, linear algebra modulo composite numbers.

LLL reduces a basis for a form that is known approximately. Elimination modulo a number treats it as a prime and returns
a divisor if it meets one, so the number need not be factored.
"""

from __future__ import annotations

import random
from math import gcd
from typing import Any

import flint
import numpy as np
import numpy.typing as npt

from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.rational import QQ
from liehom.typing import Array

# bits of the largest entry of a rounded frame
FRAME_BITS = 40
# random combinations of columns beyond the dimension
EXTRA_COMBINATIONS = 12
# number of primes tried as divisors
TRIAL_DIVISION_PRIMES = 10_000


def reduced_basis(form: Array) -> ExactMatrix:
    """A unimodular matrix whose rows are short and nearly orthogonal for a positive definite form.

    Parameters
    ----------
    form : (n, n) float array
        Symmetric positive definite.

    Returns
    -------
    ExactMatrix
        Shape (n, n), integer entries, determinant 1 or -1 for any rounding errors.

    Examples
    --------
    >>> import numpy as np
    >>> reduced_basis(np.array([[1.0, 10.0], [10.0, 101.0]])).to_strings()
    [['1', '0'], ['-10', '1']]
    """
    factor = np.linalg.cholesky((form + form.T) / 2)
    n = len(factor)
    scale = float(1 << FRAME_BITS) / float(np.abs(factor).max())
    rows = [round(x) for x in (factor * scale).ravel().tolist()]
    lattice: Any = flint.fmpz_mat(n, n, rows)
    _, change = lattice.lll(transform=True)
    return QQ.from_integers(change.entries(), n, n)


def reduced_rows(rows: ExactMatrix, factor: npt.NDArray[np.floating[Any]]) -> ExactMatrix:
    """A basis of the lattice spanned by rows, short and nearly orthogonal for the form factor factor^T.

    Parameters
    ----------
    rows : ExactMatrix
        Shape (n, n), over QQ.
    factor : (n, n) float array
        Row i is unit vector e_i of QQ^n in an orthonormal frame. The entries are rounded to 40 bits.

    Examples
    --------
    >>> import numpy as np
    >>> reduced_rows(QQ.matrix([["1/2", 100], [0, 1]]), np.eye(2)).to_strings()
    [['1/2', '0'], ['0', '1']]
    """
    n = len(factor)
    scale = float(1 << FRAME_BITS) / float(np.abs(factor).max())
    frame = flint.fmpz_mat(n, n, [round(x) for x in (factor * scale).ravel().tolist()])
    lattice: Any = rows.parts[0] * frame
    _, change = lattice.lll(transform=True)
    return ExactMatrix(rows.field, (change * rows.parts[0],), rows.den).normalized()


def kernel_modulo(matrix: ExactMatrix, modulus: int) -> tuple[list[list[int]], list[int]] | int:
    """The rows x with x A = 0 modulo a number that is treated as a prime, or a proper divisor of the number.

    Parameters
    ----------
    matrix : ExactMatrix
        A, shape (n, m), integral, over QQ.
    modulus : int
        At least 2.

    Returns
    -------
    (rows, pivots) or int
        A basis of the solutions and the pivot columns; each row has a single 1 outside the pivots. Or a divisor of the
        modulus that elimination met.

    Examples
    --------
    >>> kernel_modulo(QQ.matrix([[1], [4]]), 5)
    ([[1, 1]], [0])
    >>> kernel_modulo(QQ.matrix([[3], [4]]), 15)
    3
    """
    n, m = matrix.shape
    entries = [int(x) % modulus for x in matrix.parts[0].transpose().entries()]
    table = np.array(entries, dtype=object).reshape(m, n)
    pivots: list[int] = []
    for column in range(n):
        rank = len(pivots)
        found = next((r for r in range(rank, m) if table[r, column]), None)
        if found is None:
            continue
        common = gcd(table[found, column], modulus)
        if common != 1:
            return int(common)
        table[[rank, found]] = table[[found, rank]]
        table[rank] = table[rank] * pow(table[rank, column], -1, modulus) % modulus
        others = [r for r in range(m) if r != rank and table[r, column]]
        if others:
            table[others] = (table[others] - np.outer(table[others, column], table[rank])) % modulus
        pivots.append(column)
    free = [j for j in range(n) if j not in pivots]
    rows = [[0] * n for _ in free]
    for row, j in zip(rows, free, strict=True):
        row[j] = 1
        for i, pivot in enumerate(pivots):
            row[pivot] = -int(table[i, j]) % modulus
    return rows, pivots


def pairwise_coprime(number: int) -> list[int]:
    """Divisors d > 1 of a number such that each of its prime divisors divides some d; small divisors are primes.

    Notes
    -----
    Only primes below about 10^5 are divided out. A remaining factor is replaced by its smallest integral root, and the
    caller may split it further.

    Examples
    --------
    >>> pairwise_coprime(2**5 * 3 * (10**40 + 121) ** 2) == [2, 3, 10**40 + 121]
    True
    """
    found = [int(p) for p, _ in flint.fmpz(number).factor(trial_limit=TRIAL_DIVISION_PRIMES)]
    roots = []
    for x in found:
        base = x
        for k in range(x.bit_length(), 1, -1):
            root = int(flint.fmpz(x).root(k))
            if root**k == x:
                base = root
                break
        roots.append(base)
    return sorted(set(roots))


def smallest_prime(number: int) -> int:
    """The smallest prime divisor of an integer greater than 1; numbers of more than 100 bits may take long.

    Examples
    --------
    >>> smallest_prime(2071759 * 15816027105855133)
    2071759
    """
    return min(int(p) for p, _ in flint.fmpz(number).factor())


def integral_preimage(matrix: ExactMatrix) -> ExactMatrix:
    """Rows of a basis of a lattice that contains {x : x A is integral}, and nearly always equals it.

    Parameters
    ----------
    matrix : ExactMatrix
        A, shape (n, m), of rank n, over QQ.

    Notes
    -----
    The lattice is the dual of the lattice generated by n + 12 random combinations of the columns of A.

    Examples
    --------
    >>> integral_preimage(QQ.matrix([[2, 4]])).to_strings()
    [['1/2']]
    """
    n, m = matrix.shape
    rng = random.Random(n)
    count = min(m, n + EXTRA_COMBINATIONS)
    if count < m:
        mixing = flint.fmpz_mat(m, count, [rng.randint(-9, 9) for _ in range(m * count)])
        columns = matrix.parts[0] * mixing
    else:
        columns = matrix.parts[0]
    hermite = columns.transpose().hnf()
    square = flint.fmpz_mat(n, n, hermite.entries()[: n * n])
    dual, den = (flint.fmpq_mat(square.transpose()).inv() * matrix.den).numer_denom()
    return ExactMatrix(matrix.field, (dual,), int(den))
