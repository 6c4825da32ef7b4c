"""Integer matrices of flint (``flint.fmpz_mat``): common factors, kernels of echelon forms, inverses."""

from __future__ import annotations

import functools
import itertools
import math
import random
from collections.abc import Sequence

import flint

from liehom.base.budget import in_time, within

LARGE_SIZE = 60  # from which characteristic polynomials are computed prime by prime
LONG_BITS = 2000  # of an entry, from which the size of minors is estimated
UNINTERRUPTED = "one call of flint that the limit `seconds` does not end, may need {} bytes"
KEPT_IDENTITY = 64  # largest identity matrix that is kept


def zero_matrix(nrows: int, ncols: int) -> flint.fmpz_mat:
    """The zero matrix; `LimitError` if it is too large, since flint ends the process where memory ends."""
    in_time()
    within("memory", 8 * nrows * ncols, "a matrix needs {} bytes")
    return flint.fmpz_mat(nrows, ncols)


def integer_identity(n: int) -> flint.fmpz_mat:
    """The identity matrix (n, n), which must not be changed."""
    return _small_identity(n) if n <= KEPT_IDENTITY else selecting(range(n), n)


@functools.cache
def _small_identity(n: int) -> flint.fmpz_mat:
    return selecting(range(n), n)


def stacked_rows(blocks: Sequence[flint.fmpz_mat], ncols: int) -> flint.fmpz_mat:
    """The matrix whose rows are those of the blocks, one block below the other; all have `ncols` columns."""
    entries: list[flint.fmpz] = []
    for b in blocks:
        in_time()
        entries += b.entries()
    return flint.fmpz_mat(sum(b.nrows() for b in blocks), ncols, entries)


def cancelled(parts: tuple[flint.fmpz_mat, ...], den: int) -> tuple[tuple[flint.fmpz_mat, ...], int]:
    """Numerators and denominator of a matrix after cancelling their common factor."""
    in_time()  # after every product of matrices
    bound = flint.fmpz(den)  # a multiple of the common factor, by one combination of the rows or of the columns
    for a in parts:
        bound = bound if bound == 1 else _gcd_of(bound, _combination(a))
    if bound == 1:
        return parts, den
    return over_common_denominator([flint.fmpq_mat(a) / den for a in parts])


def over_common_denominator(parts: Sequence[flint.fmpq_mat]) -> tuple[tuple[flint.fmpz_mat, ...], int]:
    """Numerators over the least common denominator."""
    split = [a.numer_denom() for a in parts]
    least = math.lcm(*(int(d) for _, d in split))
    return tuple(a * (least // int(d)) for a, d in split), least


def sign_changes(signs: Sequence[int]) -> int:
    """Number of sign changes in a sequence, zeros left out (Descartes)."""
    return sum(1 for a, b in itertools.pairwise([s for s in signs if s]) if a != b)


def echelon_pivots(parts: Sequence[flint.fmpz_mat | flint.nmod_mat], rank: int) -> list[int]:
    """Pivot columns of a reduced echelon form, whose entries have their coordinates in one matrix or several."""
    in_time()
    pivots, column = [], 0
    for i in range(rank):
        while all(a[i, column] == 0 for a in parts):
            column += 1
        pivots.append(column)
        column += 1
    return pivots


def kernel_rows(reduced: flint.fmpz_mat, pivots: Sequence[int], unit: int) -> flint.fmpz_mat:
    """Rows that span the kernel of a reduced echelon form, with the integer `unit` in the free columns."""
    n, chosen = reduced.ncols(), set(pivots)
    units = selecting([j for j in range(n) if j not in chosen], n)
    return units * unit - units * reduced.transpose() * selecting(pivots, n)


def selecting(indices: Sequence[int], n: int) -> flint.fmpz_mat:
    """The matrix with these rows of the identity (n, n); products with it select rows faster than lists of entries."""
    units = zero_matrix(len(indices), n)
    for i, j in enumerate(indices):
        units[i, j] = 1
    return units


def lifted_inverse(matrix: flint.fmpz_mat, p: int) -> flint.fmpz_mat | None:
    """The inverse modulo a prime with entries between -p/2 and p/2, or None where the matrix is singular modulo p."""
    try:
        entries = flint.nmod_mat(matrix, p).inv().entries()
    except ZeroDivisionError:
        return None
    half = p // 2
    return flint.fmpz_mat(matrix.nrows(), matrix.ncols(), [x - p if x > half else x for x in map(int, entries)])


def interleaved(multiples: Sequence[Sequence[flint.fmpz_mat]]) -> flint.fmpz_mat:
    """The restriction of scalars of a matrix over QQ(b), from the coordinates of its multiples by 1, b, b^2, ...

    Each entry becomes the (m, m) matrix whose row i holds the coordinates of b^i times the entry.
    """
    m, (nrows, ncols) = len(multiples), (multiples[0][0].nrows(), multiples[0][0].ncols())
    require_small_answer(multiples[0][0], m)
    if m == 1:
        return multiples[0][0]
    out: list[int | flint.fmpz] = [0] * (nrows * m * ncols * m)
    for i, parts in enumerate(multiples):
        for s, a in enumerate(parts):
            for index, x in enumerate(a.entries()):
                row, column = divmod(index, ncols)
                out[(row * m + i) * ncols * m + column * m + s] = x
    return flint.fmpz_mat(nrows * m, ncols * m, out)


def characteristic_coefficients(matrix: flint.fmpz_mat) -> list[flint.fmpz]:
    """Ascending coefficients of det(t - A); of a large matrix prime by prime, so that it can be interrupted.

    All eigenvalues are at most R in absolute value, the largest sum of the absolute values in a row, so all
    coefficients are at most (1 + R)^n. They are determined by their residues modulo primes with a larger product.
    """
    n = matrix.nrows()
    if n < LARGE_SIZE:
        return matrix.charpoly().coeffs()
    bound = 2 * (1 + max(sum(abs(int(x)) for x in row) for row in matrix.tolist())) ** n
    values, product, p = [0] * (n + 1), 1, (1 << 62) - 1
    while product <= bound:
        in_time()
        p -= 2
        if not flint.fmpz(p).is_prime():
            continue
        residues = flint.nmod_mat(matrix, p).charpoly().coeffs()
        inverse = pow(product, -1, p)
        values = [v + product * ((int(r) - v) * inverse % p) for v, r in zip(values, residues, strict=True)]
        product *= p
    return [flint.fmpz(v if 2 * v < product else v - product) for v in values]


def require_small_answer(matrix: flint.fmpz_mat, degree: int) -> None:
    """Raise `LimitError` if an echelon form of numbers of over `LONG_BITS` bits may need too much memory (Hadamard)."""
    nrows, ncols = matrix.nrows(), matrix.ncols()
    # one combination has only a few bits more or less than the largest entry
    bits = max((x.bit_length() for x in _combination(matrix)), default=0)
    if bits > LONG_BITS:
        rank = degree * min(nrows, ncols)
        what = f"the echelon form of a matrix ({nrows}, {ncols}) of numbers of {bits} bits, {UNINTERRUPTED}"
        within("memory", rank * degree * ncols * rank * bits // 8, what)


def separated(restricted: flint.fmpz_mat, degree: int, nrows: int) -> list[flint.fmpz_mat]:
    """Coordinate matrices of a matrix over QQ(b), from the first row of each block of its restriction of scalars."""
    if degree == 1 and restricted.nrows() == nrows:
        return [restricted]
    if degree == 1:
        return [selecting(range(nrows), restricted.nrows()) * restricted]
    table, width = restricted.entries(), restricted.ncols()
    rows = [table[i * degree * width : (i * degree + 1) * width] for i in range(nrows)]
    return [flint.fmpz_mat(nrows, width // degree, [x for row in rows for x in row[s::degree]]) for s in range(degree)]


def _combination(matrix: flint.fmpz_mat) -> list[flint.fmpz]:
    """A combination of the rows or of the columns, whichever has fewer entries."""
    nrows, ncols = matrix.nrows(), matrix.ncols()
    product = matrix * _weights(ncols).transpose() if nrows < ncols else _weights(nrows) * matrix
    return product.entries()


def _gcd_of(number: flint.fmpz, entries: Sequence[flint.fmpz]) -> flint.fmpz:
    for x in entries:
        number = number.gcd(x)
        if number == 1:
            break
    return number


@functools.cache
def _weights(n: int) -> flint.fmpz_mat:
    """Row of n fixed pseudo-random integers."""
    rng = random.Random(n)
    return flint.fmpz_mat(1, n, [rng.randint(1, 1 << 20) for _ in range(n)])
