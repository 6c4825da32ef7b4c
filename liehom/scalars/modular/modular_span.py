"""Spans modulo a prime: a growing space of rows, and the lift of an echelon basis to the rationals.

Elimination uses float64 arrays modulo a prime below 2^22: sums of up to 512 products of residues stay below 2^53. A
basis modulo a larger prime p lifts entry by entry to rationals with numerator and denominator below sqrt(p / 2), and
several primes together give larger ones (Wang). A lift is a proposal that the caller verifies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import isqrt
from typing import final

import flint
import numpy as np
import numpy.typing as npt

from liehom.scalars.fields.exact_field import ExactField, ExactMatrix
from liehom.scalars.fields.field import Field
from liehom.scalars.fields.rational import prime
from liehom.scalars.modular.modular import row_basis, small_residues
from liehom.typing import Array, IntegerArray

# primes combined for one lift
MAX_PRIMES = 12
# products of residues below 2^22 in one sum, so that it stays below 2^53
MAX_TERMS = 512
Residues = Array


@final
class ModularSpan:
    """A growing space of rows modulo a small prime.

    Parameters
    ----------
    modulus : int
        A prime below 2^22.
    ncols : int

    Examples
    --------
    >>> span = ModularSpan(7, 3)
    >>> span.extend(np.array([[1, 2, 3], [2, 4, 6], [0, 0, 1]])), span.rank
    ([0, 2], 2)
    """

    modulus: int
    ncols: int

    __slots__ = ("modulus", "ncols", "pivots", "rows")

    def __init__(self, modulus: int, ncols: int) -> None:
        self.modulus, self.ncols = modulus, ncols
        self.pivots: list[int] = []
        self.rows: Residues = np.zeros((0, ncols))

    @property
    def rank(self) -> int:
        """Dimension, an int."""
        return len(self.pivots)

    def extend(self, rows: npt.ArrayLike) -> list[int]:
        """Add rows; return the list of indices of the rows that are independent of all earlier rows."""
        p = self.modulus
        rest = remainders(np.array(rows, dtype=np.float64).reshape(-1, self.ncols), p)
        if self.rank:
            rest = remainders(rest - product(rest[:, self.pivots], self.rows, p), p)
        found: list[int] = []
        pivots: list[int] = []
        for i in np.flatnonzero(rest.any(axis=1)).tolist():
            if self.rank + len(found) == self.ncols:
                break
            pivot = int((rest[i] != 0).argmax())
            if not rest[i, pivot]:
                continue
            rest[i] = remainders(rest[i] * pow(int(rest[i, pivot]), -1, p), p)
            others = np.flatnonzero(rest[:, pivot])
            others = others[others != i]
            rest[others] = remainders(rest[others] - rest[others, pivot, None] * rest[i], p)
            found.append(i)
            pivots.append(pivot)
        if found:
            new = rest[found]
            old = remainders(self.rows - product(self.rows[:, pivots], new, p), p) if self.rank else self.rows
            self.rows = np.concatenate([old, new])
            self.pivots += pivots
        return found

    def echelon(self) -> tuple[IntegerArray, list[int]]:
        """The reduced echelon basis (rank, ncols) as int64, and its pivots in increasing order."""
        order = np.argsort(self.pivots)
        return self.rows[order].astype(np.int64), sorted(self.pivots)


def invariant_span(maps: npt.ArrayLike, rows: npt.ArrayLike, modulus: int) -> ModularSpan:
    """The smallest space of rows modulo a prime below 2^22 that contains the given rows and is invariant under maps.

    Parameters
    ----------
    maps : (k, n, n) array
        Matrices that act on rows from the right.
    rows : (m, n) array
    modulus : int

    Examples
    --------
    >>> shift = [[0, 1, 0], [0, 0, 1], [0, 0, 0]]
    >>> invariant_span([shift], [[0, 2, 0]], 7).echelon()[0].tolist()
    [[0, 1, 0], [0, 0, 1]]
    """
    frontier, matrices = np.asarray(rows, dtype=np.float64), np.asarray(maps, dtype=np.float64)
    n = frontier.shape[1]
    span = ModularSpan(modulus, n)
    frontier = frontier[span.extend(frontier)]
    while len(frontier) and span.rank < n:
        images = product(frontier, matrices, modulus).reshape(-1, n)
        frontier = images[span.extend(images)]
    return span


def left_kernel(matrix: npt.ArrayLike, modulus: int) -> IntegerArray:
    """A basis of the rows x with x A = 0 modulo a prime below 2^22, as int64.

    Examples
    --------
    >>> left_kernel([[1], [4]], 5)
    array([[1, 1]])
    """
    columns = np.asarray(matrix).T
    n = columns.shape[1]
    span = ModularSpan(modulus, n)
    span.extend(columns)
    reduced, pivots = span.echelon()
    free = [j for j in range(n) if j not in set(pivots)]
    rows: IntegerArray = np.zeros((len(free), n), dtype=np.int64)
    for i, j in enumerate(free):
        rows[i, j] = 1
        rows[i, pivots] = -reduced[:, j] % modulus
    return rows


def remainders(values: Residues, modulus: int) -> Residues:
    """Residues between 0 and p - 1 of integers of size at most 2^53 - p, exactly; faster than ``numpy.mod``.

    Notes
    -----
    Where x = k p + r, 0 <= r < p, the quotient x/p is at most k + 1 - 1/p. Rounding cannot lift it to k + 1, because
    1/p exceeds half the spacing (k + 1) / 2^52 of floats there: (k + 1) p <= x + p < 2^53. So the floor is k.

    Examples
    --------
    >>> remainders(np.array([-1.0, 7.0, 2.0**51]), 7)
    array([6., 0., 1.])
    """
    remainder: Residues = values - modulus * np.floor(values / modulus)
    return remainder


def product(left: Residues, right: Residues, modulus: int) -> Residues:
    """The matrix product modulo a prime below 2^22, exactly: sums of at most 512 terms at a time.

    Examples
    --------
    >>> product(np.array([[4.0, 5.0]]), np.array([[2.0], [3.0]]), 7)
    array([[2.]])
    """
    total: Residues = remainders(left[..., :MAX_TERMS] @ right[..., :MAX_TERMS, :], modulus)
    for start in range(MAX_TERMS, left.shape[-1], MAX_TERMS):
        end = start + MAX_TERMS
        total = remainders(total + left[..., start:end] @ right[..., start:end, :], modulus)
    return total


def residue_map(field: ExactField) -> tuple[int, int]:
    """A prime below 2^22 and the image of the integral generator modulo it.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> residue_map(QQ)
    (4194301, 0)
    """
    return next(small_residues(field, 1 << 40))


def residues(matrix: ExactMatrix, modulus: int, root: int) -> Residues:
    """Array of float64 with the numerators of a matrix modulo a small prime.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> residues(QQ.matrix([[8, "-1/2"]]), 7, 0)
    array([[2., 6.]])
    """
    total = np.zeros(matrix.nrows * matrix.ncols)
    power = 1
    for part in matrix.parts:
        coordinates = np.array([int(x) % modulus for x in part.entries()], dtype=np.float64)
        total = remainders(total + power * coordinates, modulus)
        power = power * root % modulus
    return total.reshape(matrix.shape)


def flat_echelon(matrices: Sequence[flint.nmod_mat]) -> flint.nmod_mat:
    """The non-zero rows of the reduced echelon form of flattened matrices modulo a prime.

    Examples
    --------
    >>> flat_echelon([flint.nmod_mat(1, 2, [2, 4], 7), flint.nmod_mat(1, 2, [1, 2], 7)])
    [1, 2]
    """
    width, p = matrices[0].nrows() * matrices[0].ncols(), matrices[0].modulus()
    entries = [int(x) for m in matrices for x in m.entries()]
    return row_basis(flint.nmod_mat(len(matrices), width, entries, p))


def rational_lifts(make: Callable[[int], flint.nmod_mat | None], field: Field) -> Iterator[ExactMatrix]:
    """Proposals, possibly wrong, for a matrix over QQ that is known modulo primes: from one prime, from two, ...

    Parameters
    ----------
    make : function of int
        The matrix (``flint.nmod_mat``) modulo the prime with that number, for example a reduced echelon form.
    field : RationalField

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> A = QQ.matrix([[1, "-2/3"], [0, 5]])
    >>> next(rational_lifts(lambda attempt: _residue(A, attempt), QQ)) == A
    True
    """
    first = make(0)
    if first is None:
        return
    shape, modulus = (first.nrows(), first.ncols()), int(first.modulus())
    values = [int(x) for x in first.entries()]
    for attempt in range(1, MAX_PRIMES):
        lifted = _lifted(values, modulus)
        if lifted is not None:
            yield field.from_entries([flint.fmpq(a, b) for a, b in lifted], *shape)
        further = make(attempt)
        if further is None or (further.nrows(), further.ncols()) != shape:
            return
        p = int(further.modulus())
        inverse = pow(modulus, -1, p)
        residues = [int(x) for x in further.entries()]
        values = [v + modulus * ((r - v) * inverse % p) for v, r in zip(values, residues, strict=True)]
        modulus *= p


def lifted(values: Residues, modulus: int, field: Field) -> ExactMatrix | None:
    """The matrix of small fractions equal to a matrix modulo one prime, or None if some entry is not one.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(lifted(np.array([[99.0, 51.0], [0.0, 3.0]]), 101, QQ))
    [-2, 1/2]
    [0, 3]
    """
    found = _lifted([int(x) for x in values.ravel()], modulus)
    if found is None:
        return None
    entries = [field.convert(flint.fmpq(a, b)) for a, b in found]
    matrix: ExactMatrix = field.from_entries(entries, *values.shape)
    return matrix


def _residue(matrix: ExactMatrix, attempt: int) -> flint.nmod_mat:
    p = prime(attempt)
    return matrix.modulo(attempt) * pow(matrix.den, -1, p)


def _lifted(values: list[int], modulus: int) -> list[tuple[int, int]] | None:
    bound = isqrt(modulus // 2)
    known: dict[int, tuple[int, int]] = {}
    for value in values:
        if value not in known:
            fraction = _fraction(value, modulus, bound)
            if fraction is None:
                return None
            known[value] = fraction
    return [known[value] for value in values]


def _fraction(value: int, modulus: int, bound: int) -> tuple[int, int] | None:
    """(a, b) with a / b = value modulo the modulus and |a|, b at most the bound (extended Euclid), or None."""
    if value <= bound:
        return value, 1
    r, s, t, u = modulus, value, 0, 1
    while s > bound:
        q = r // s
        r, s, t, u = s, r - q * s, u, t - q * u
    if u < 0:
        s, u = -s, -u
    return (s, u) if 0 < u <= bound else None
