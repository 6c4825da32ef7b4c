"""Linear algebra modulo a prime: lower bounds for ranks, at machine speed.

A rank modulo a prime (by a residue map of the field onto F_p) is at most the true rank, so a bound that is reached
modulo p is reached. If it is not reached, numbers of the input may be multiples of p, and the exact rank decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import flint

from liehom.scalars.fields.exact_field import ExactField, ExactMatrix
from liehom.scalars.fields.integer_matrices import echelon_pivots


def invariant_hull_rank(span: ExactMatrix, maps: Sequence[ExactMatrix]) -> int:
    """A lower bound, nearly always sharp, for the dimension of the smallest invariant space that contains given rows.

    Parameters
    ----------
    span : ExactMatrix
        The given rows, shape (k, n).
    maps : sequence of ExactMatrix
        Matrices (n, n) acting on rows from the right.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> shift = QQ.matrix([[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    >>> invariant_hull_rank(QQ.matrix([[1, 0, 0]]), [shift])
    3
    """
    n = span.ncols
    images = [m.modulo() for m in maps]
    current, before = row_basis(span.modulo()), -1
    while before < current.nrows() < n:
        before = current.nrows()
        current = row_basis(stacked_residues([current, *[current * image for image in images]]))
    return int(current.nrows())


def small_residues(field: ExactField, bound: int) -> Iterator[tuple[int, int]]:
    """Pairs (p, r): primes p < 2^22 and residue maps b -> r of the field, enough of them to recognize zero.

    A sum of products of two elements of Z[b] is zero if all of these maps send it to 0.

    Parameters
    ----------
    field : ExactField
    bound : int
        The sum over all terms of |integer factors| times the product of the largest coordinates.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> [p for p, _ in small_residues(QQ, 10**10)]
    [4194301, 4194287]
    """
    modulus = field.modulus_coefficients()
    remaining = norm_bound(modulus, bound)
    p = 1 << 22
    while remaining:
        p -= 1
        while not flint.fmpz(p).is_prime():
            p -= 1
        image = flint.nmod_poly([c % p for c in modulus], p)
        linear = [f for f, _ in image.factor()[1] if f.degree() == 1] if len(modulus) > 2 else []
        if len(modulus) > 2 and not linear:
            continue
        root = (-int(linear[0][0]) * pow(int(linear[0][1]), -1, p)) % p if linear else 0
        yield p, root
        remaining //= p


def norm_bound(modulus: Sequence[int], bound: int) -> int:
    """Upper bound for twice the norm of sums of products of two elements, given the bound for coordinates of size 1.

    Every conjugate of the generator is at most 1 + max |coefficient| (Cauchy), so a conjugate of an element with
    coordinates of size s is at most s (1 + beta + ... + beta^(m-1)).
    """
    m = len(modulus) - 1
    if m == 1:
        return 2 * bound
    beta = 1 + max(abs(c) for c in modulus)
    spread = sum(beta**s for s in range(m))
    norm: int = (bound * spread * spread) ** m
    return 2 * norm


def independent_rows(matrix: ExactMatrix) -> list[int]:
    """List of the indices of rows that are a basis of the row space, with proof.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> independent_rows(QQ.matrix([[1, 2], [2, 4], [0, 1]]))
    [0, 2]
    """
    return independent_columns(matrix.T)


def independent_columns(matrix: ExactMatrix) -> list[int]:
    """List of the indices of columns that are a basis of the column space, with proof; 0 is one unless column 0 is 0.

    Pivots modulo a prime are independent. The shape or the exact rank proves that their number is the rank.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> independent_columns(QQ.matrix([[0, 1, 2, 0], [0, 2, 4, 2**61 - 1]]))
    [1, 3]
    """
    found = pivot_columns(matrix.modulo())
    starts = not matrix.ncols or found[:1] == [0] or matrix.select(columns=[0]).is_zero()
    if starts and (len(found) == min(matrix.shape) or len(found) == matrix.rank()):
        return found
    return matrix.echelon()[1]


def primitive_residues(rows: Sequence[ExactMatrix], ncols: int) -> flint.nmod_mat:
    """Rows modulo a prime (``flint.nmod_mat``), each first cleared of its denominator and common factor.

    Parameters
    ----------
    rows : sequence of ExactMatrix
        Row matrices (1, ncols) over one field, at least one.
    """
    return rows[0].field.stack_rows([_primitive(row) for row in rows], ncols).modulo()


def _primitive(row: ExactMatrix) -> ExactMatrix:
    content = flint.fmpz(0)
    for part in row.parts:
        for x in part.entries():
            content = content.gcd(x)
            if content == 1:
                return row.cleared()
    return row if content == 0 else row.scale(flint.fmpq(row.den, content))


def pivot_columns(image: flint.nmod_mat) -> list[int]:
    """List of the pivot columns of a matrix modulo a prime."""
    reduced, rank = image.rref()
    return echelon_pivots((reduced,), int(rank))


def row_basis(image: flint.nmod_mat) -> flint.nmod_mat:
    """The non-zero rows of the reduced echelon form of a matrix modulo a prime.

    Examples
    --------
    >>> row_basis(flint.nmod_mat(2, 2, [2, 4, 1, 2], 7))
    [1, 2]
    """
    reduced, rank = image.rref()
    return selected_rows(reduced, range(int(rank)))


def selected_rows(image: flint.nmod_mat, indices: Sequence[int]) -> flint.nmod_mat:
    """The rows with the given indices of a matrix modulo a prime.

    Examples
    --------
    >>> selected_rows(flint.nmod_mat(2, 2, [2, 4, 1, 2], 7), [1])
    [1, 2]
    """
    n, entries = image.ncols(), image.entries()
    chosen = [int(x) for i in indices for x in entries[i * n : (i + 1) * n]]
    return flint.nmod_mat(len(indices), n, chosen, image.modulus())


def stacked_residues(blocks: Sequence[flint.nmod_mat]) -> flint.nmod_mat:
    """Matrices modulo one prime with the same number of columns, one below the other; at least one.

    Examples
    --------
    >>> stacked_residues([flint.nmod_mat(1, 2, [2, 4], 7), flint.nmod_mat(1, 2, [1, 2], 7)])
    [2, 4]
    [1, 2]
    """
    rows = sum(b.nrows() for b in blocks)
    entries = [int(x) for b in blocks for x in b.entries()]
    return flint.nmod_mat(rows, blocks[0].ncols(), entries, blocks[0].modulus())


def extending_rows(known: Sequence[flint.nmod_mat], candidates: Sequence[flint.nmod_mat]) -> list[int]:
    """Indices of candidate rows that are independent of all known rows and of the earlier candidates.

    Parameters
    ----------
    known, candidates : sequences of flint.nmod_mat
        Blocks of rows modulo one prime; the known rows are independent.

    Examples
    --------
    >>> extending_rows([flint.nmod_mat(1, 2, [2, 4], 7)], [flint.nmod_mat(2, 2, [1, 2, 0, 1], 7)])
    [1]
    """
    rank = sum(b.nrows() for b in known)
    pivots = pivot_columns(stacked_residues([*known, *candidates]).transpose())
    return [i - rank for i in pivots if i >= rank]
