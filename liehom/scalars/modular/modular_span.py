"""Spans modulo a prime: a space of rows that grows, and the lift of an echelon basis to the rationals.

Elimination runs on float64 arrays modulo a prime below 2^22: products of residues, summed over up to 512 terms, stay
below 2^53.  A basis modulo larger primes lifts entry by entry to the rationals with numerator and denominator below
sqrt(p / 2), several primes together to larger ones (Wang).  A lift is a proposal: who takes it verifies it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import isqrt
from typing import Any, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.scalars.fields.exact_field import ExactField, ExactMatrix
from liehom.scalars.fields.rational import prime
from liehom.scalars.modular.modular import small_residues

PRIMES = 12
TERMS = 512
Residues = npt.NDArray[np.float64]


@final
class ModularSpan:
    """A space of rows modulo a small prime that grows.

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

    __slots__ = ("modulus", "ncols", "pivots", "rows")

    def __init__(self, modulus: int, ncols: int) -> None:
        self.modulus, self.ncols = modulus, ncols
        self.pivots: list[int] = []
        self.rows: Residues = np.zeros((0, ncols))

    @property
    def rank(self) -> int:
        """The dimension."""
        return len(self.pivots)

    def extend(self, rows: npt.ArrayLike) -> list[int]:
        """Add rows; the numbers of those that are independent of all earlier ones."""
        p = self.modulus
        rest = np.mod(np.array(rows, dtype=np.float64).reshape(-1, self.ncols), p)
        if self.rank:
            rest = np.mod(rest - product(rest[:, self.pivots], self.rows, p), p)
        found, pivots = [], []
        for i in range(len(rest)):
            places = np.flatnonzero(rest[i])
            if not len(places):
                continue
            pivot = int(places[0])
            rest[i] = np.mod(rest[i] * pow(int(rest[i, pivot]), -1, p), p)
            others = np.flatnonzero(rest[:, pivot])
            others = others[others != i]
            rest[others] = np.mod(rest[others] - rest[others, pivot, None] * rest[i], p)
            found.append(i)
            pivots.append(pivot)
        if found:
            new = rest[found]
            old = np.mod(self.rows - product(self.rows[:, pivots], new, p), p) if self.rank else self.rows
            self.rows = np.concatenate([old, new])
            self.pivots += pivots
        return found


def product(left: Residues, right: Residues, modulus: int) -> Residues:
    """The matrix product modulo a prime below 2^22, exactly: sums of at most 512 terms at a time.

    Examples
    --------
    >>> product(np.array([[4.0, 5.0]]), np.array([[2.0], [3.0]]), 7)
    array([[2.]])
    """
    total: Residues = np.mod(left[..., :TERMS] @ right[..., :TERMS, :], modulus)
    for start in range(TERMS, left.shape[-1], TERMS):
        total = np.mod(total + left[..., start : start + TERMS] @ right[..., start : start + TERMS, :], modulus)
    return total


def residue_map(field: ExactField) -> tuple[int, int]:
    """A prime below 2^22 and the image of the integral generator.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> residue_map(QQ)
    (4194301, 0)
    """
    return next(small_residues(field, 1 << 40))


def residues(matrix: ExactMatrix, modulus: int, root: int) -> Residues:
    """The numerators of a matrix modulo a small prime, as float64.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> residues(QQ.matrix([[8, "-1/2"]]), 7, 0)
    array([[2., 6.]])
    """
    total = np.zeros(matrix.nrows * matrix.ncols)
    power = 1
    for part in matrix.parts:
        total = np.mod(total + power * np.array([int(x) % modulus for x in part.entries()], dtype=np.float64), modulus)
        power = power * root % modulus
    return total.reshape(matrix.shape)


def flat_echelon(matrices: Sequence[Any]) -> Any:
    """The reduced echelon form of flattened matrices modulo a prime (``flint.nmod_mat``), non-zero rows only.

    Examples
    --------
    >>> flat_echelon([flint.nmod_mat(1, 2, [2, 4], 7), flint.nmod_mat(1, 2, [1, 2], 7)])
    [1, 2]
    """
    width, p = matrices[0].nrows() * matrices[0].ncols(), matrices[0].modulus()
    entries = [int(x) for m in matrices for x in m.entries()]
    reduced, rank = flint.nmod_mat(len(matrices), width, entries, p).rref()
    kept = [int(x) for x in reduced.entries()[: int(rank) * width]]
    return flint.nmod_mat(int(rank), width, kept, p)


def rational_lifts(make: Callable[[int], Any], field: Any) -> Iterator[ExactMatrix]:
    """Proposals for a matrix over QQ that is given modulo primes, from one prime, two, ...; wrong ones among them.

    Parameters
    ----------
    make : function of int
        The matrix modulo the prime of that number (``flint.nmod_mat``), a reduced echelon form say.
    field : RationalField

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> A = QQ.matrix([[1, "-2/3"], [0, 5]])
    >>> next(rational_lifts(lambda attempt: _residue(A, attempt), QQ)) == A
    True
    """
    first = make(0)
    shape, modulus = (first.nrows(), first.ncols()), int(first.modulus())
    values = [int(x) for x in first.entries()]
    for attempt in range(1, PRIMES):
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


def lifted(values: Residues, modulus: int, field: Any) -> ExactMatrix | None:
    """The matrix of small fractions that a matrix modulo one prime proposes, or None if an entry proposes none.

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
    return field.from_entries(entries, *values.shape)  # type: ignore[no-any-return]


def _residue(matrix: ExactMatrix, attempt: int) -> Any:
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
    """a / b = value modulo the modulus with |a|, b at most the bound, by the extended Euclidean algorithm."""
    if value <= bound:
        return value, 1
    r, s, t, u = modulus, value, 0, 1
    while s > bound:
        q = r // s
        r, s, t, u = s, r - q * s, u, t - q * u
    if u < 0:
        s, u = -s, -u
    return (s, u) if 0 < u <= bound else None
