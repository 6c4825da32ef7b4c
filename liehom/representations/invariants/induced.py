"""Matrices induced on duals, sums, tensor products and powers, as linear maps of the entries with integer coefficients.

Every construction here sends a matrix A to a matrix whose entries are integer combinations of the entries of A.  It is
therefore applied both to the integer coordinates of exact matrices and to float arrays.  The functions document bases.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations, combinations_with_replacement
from typing import final

import numpy as np

from liehom.errors import InputError
from liehom.scalars import ExactMatrix, FloatMatrix, Matrix
from liehom.scalars.spaces.matrix_from_entries import matrix_from_entries

Term = tuple[tuple[int, int], tuple[int, int], int]


@final
class EntryMap:
    """The linear map from (n, n) to (m, m) matrices with target entry = sum of factor * source entry.

    Parameters
    ----------
    source, target : int
        n and m.
    terms : iterable of ((row, column) of the target, (row, column) of the source, factor)

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> transpose = EntryMap(2, 2, [((j, i), (i, j), 1) for i in range(2) for j in range(2)])
    >>> print(transpose(QQ.matrix([[1, 2], [3, 4]])))
    [1, 3]
    [2, 4]
    """

    source: int
    target: int

    __slots__ = ("_by_source", "source", "target")

    def __init__(self, source: int, target: int, terms: Iterable[Term]) -> None:
        self.source, self.target = source, target
        self._by_source: dict[int, list[tuple[int, int]]] = {}
        for (r, c), (i, j), factor in terms:
            self._by_source.setdefault(i * source + j, []).append((r * target + c, factor))

    def __call__(self, matrix: Matrix) -> Matrix:
        m = self.target
        if isinstance(matrix, FloatMatrix):
            array = np.zeros(m * m)
            for place, entry in enumerate(matrix.array.ravel().tolist()):
                for at, factor in self._by_source.get(place, ()) if entry else ():
                    array[at] += factor * entry
            return FloatMatrix(matrix.field, array.reshape(m, m), matrix.error * self._size())
        if not isinstance(matrix, ExactMatrix):
            raise InputError(f"expected a matrix over a field, got {matrix!r}")
        tables: list[dict[int, int]] = []
        for part in matrix.parts:
            table: dict[int, int] = {}
            for place, value in enumerate(part.entries()):
                for at, factor in self._by_source.get(place, ()) if value else ():
                    table[at] = table.get(at, 0) + factor * int(value)
            tables.append(table)
        return matrix_from_entries(matrix.field, tables, m, m, matrix.den)

    def _size(self) -> float:
        """A bound on the norm of the map: the square root of the largest row sum times the largest column sum."""
        rows: dict[int, int] = {}
        for terms in self._by_source.values():
            for at, factor in terms:
                rows[at] = rows.get(at, 0) + abs(factor)
        columns = (sum(abs(factor) for _, factor in terms) for terms in self._by_source.values())
        return float((max(rows.values(), default=0) * max(columns, default=0)) ** 0.5)


def dual_map(n: int) -> EntryMap:
    """The map A -> -A^T to the dual; -[A, B]^T = [-A^T, -B^T]."""
    return EntryMap(n, n, (((j, i), (i, j), -1) for i in range(n) for j in range(n)))


def block_map(n: int, total: int, start: int) -> EntryMap:
    """The map from A to the (total, total) matrix with A as a diagonal block from index `start` on."""
    return EntryMap(n, total, (((start + i, start + j), (i, j), 1) for i in range(n) for j in range(n)))


def left_factor_map(n: int, m: int) -> EntryMap:
    """The map A -> A (x) 1_m, in the basis e_i (x) f_j with index i m + j."""
    return EntryMap(
        n, n * m, (((i * m + k, j * m + k), (i, j), 1) for i in range(n) for j in range(n) for k in range(m))
    )


def right_factor_map(n: int, m: int) -> EntryMap:
    """The map B -> 1_n (x) B for B of size m, in the basis of `left_factor_map`."""
    return EntryMap(
        m, n * m, (((k * m + i, k * m + j), (i, j), 1) for k in range(n) for i in range(m) for j in range(m))
    )


def monomials(n: int, k: int) -> list[tuple[int, ...]]:
    """The basis of Sym^k K^n: x_i1 ... x_ik with i1 <= ... <= ik, in lexicographic order of (i1, ..., ik).

    Examples
    --------
    >>> monomials(2, 2)
    [(0, 0), (0, 1), (1, 1)]
    """
    return list(combinations_with_replacement(range(n), k))


def wedges(n: int, k: int) -> list[tuple[int, ...]]:
    """The basis of Lambda^k K^n: e_i1 ^ ... ^ e_ik with i1 < ... < ik, in lexicographic order.

    Examples
    --------
    >>> wedges(3, 2)
    [(0, 1), (0, 2), (1, 2)]
    """
    return list(combinations(range(n), k))


def symmetric_power_map(n: int, k: int) -> EntryMap:
    """The map from A to its action on Sym^k as a derivation, in the basis `monomials`."""
    _require_degree(k)
    return _derivation(n, monomials(n, k), alternating=False)


def exterior_power_map(n: int, k: int) -> EntryMap:
    """The map from A to its action on Lambda^k as a derivation, in the basis `wedges` (empty for k > n)."""
    _require_degree(k)
    return _derivation(n, wedges(n, k), alternating=True)


def congruence_map(n: int) -> EntryMap:
    """The map A -> (S -> A S + S A^T) on symmetric matrices, coordinates S[i, j], i <= j, in lexicographic order.

    For skew-symmetric A this is the conjugation S -> A S - S A.
    """
    places = monomials(n, 2)
    position = {place: x for x, place in enumerate(places)}
    terms: list[Term] = []
    for i, j in places:
        for s in range(n):
            # (A S + S A^T)[i, j] = sum_s A[i, s] S[s, j] + A[j, s] S[i, s]
            terms.append(((position[i, j], position[min(s, j), max(s, j)]), (i, s), 1))
            terms.append(((position[i, j], position[min(i, s), max(i, s)]), (j, s), 1))
    return EntryMap(n, len(places), terms)


def hermitian_map(k: int) -> EntryMap:
    """The map A -> (H -> A H + H A^*) on Hermitian k x k matrices.

    A and H are real (2k, 2k) matrices with blocks [x, -y; y, x]. The coordinates are H[i, i], and
    Re H[i, j], Im H[i, j] for i < j, in lexicographic order of (i, j).

    For skew-Hermitian A this is the conjugation H -> A H - H A.
    """
    places = [(i, j, part) for i in range(k) for j in range(i, k) for part in range(1 + (i < j))]
    terms: list[Term] = []
    for column, (i, j, part) in enumerate(places):
        for s, t, v in _hermitian_entries(i, j, part):
            for row, (a, b, half) in enumerate(places):
                # the coordinate is the entry (2a + half, 2b) of A H + H A^T
                if t == 2 * b:
                    terms.append(((row, column), (2 * a + half, s), v))
                if s == 2 * a + half:
                    terms.append(((row, column), (2 * b, t), v))
    return EntryMap(2 * k, len(places), terms)


def _hermitian_entries(i: int, j: int, part: int) -> list[tuple[int, int, int]]:
    """The entries (row, column, value) of the real matrix of a basis element: E_ij + E_ji, or i E_ij - i E_ji."""
    if i == j:
        return [(2 * i, 2 * i, 1), (2 * i + 1, 2 * i + 1, 1)]
    found = []
    for (p, q), sign in (((i, j), 1), ((j, i), -1 if part else 1)):
        # x + i y has the block [x, -y; y, x]
        block = [(1, 0, sign), (0, 1, -sign)] if part else [(0, 0, 1), (1, 1, 1)]
        found += [(2 * p + r, 2 * q + c, v) for r, c, v in block]
    return found


def _derivation(n: int, words: Sequence[tuple[int, ...]], *, alternating: bool) -> EntryMap:
    """The derivation that replaces one letter after the other, e_i by sum_j A[j, i] e_j."""
    position = {word: index for index, word in enumerate(words)}
    terms: list[Term] = []
    for column, word in enumerate(words):
        for place, letter in enumerate(word):
            for new in range(n):
                image = [*word[:place], new, *word[place + 1 :]]
                row = position.get(tuple(sorted(image)))
                if row is not None:
                    sign = _sorting_sign(image, place) if alternating else 1
                    terms.append(((row, column), (new, letter), sign))
    return EntryMap(n, len(words), terms)


def _sorting_sign(word: list[int], place: int) -> int:
    """Sign of the permutation that sorts a word in which only the letter at `place` is out of order."""
    letter = word[place]
    moves = sum(other > letter for other in word[:place]) + sum(other < letter for other in word[place + 1 :])
    return -1 if moves % 2 else 1


def _require_degree(k: object) -> None:
    if isinstance(k, bool) or not isinstance(k, (int, np.integer)) or k < 0:
        raise InputError(f"the degree of a power is an integer at least 0, got {k!r}")
