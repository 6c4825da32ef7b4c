"""The algebra that sums of Pauli words generate, in coordinates on words: modulo primes, and lifted with a proof."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import lcm
from typing import Any, final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import InternalError
from liehom.base.typing import IntegerArray
from liehom.exact.pauli.words import PauliSums, products
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.modular import (
    RationalLift,
    ResidueMap,
    Residues,
    interpolated,
    invariant_span,
    product,
    remainders,
    residue_map,
    residues,
    small_residues,
    splitting_primes,
)

# Elements with integral coefficients reduce modulo a prime to elements of the closure of the reduced generators. So the
# rank of that closure is at most dim g. The echelon basis E = R / D that is lifted from several closures bounds dim g
# from above if its span contains the generators g_a and the commutators [g_a, row]. With the pivot columns P of E:
#
#     D g_a = (g_a)_P R,    D [g_a, R] = [g_a, R]_P R.
#
# The differences are sums of products of integers with a known bound: they vanish if they do modulo enough primes. A
# lift from too few primes fails there, and one prime more is taken. E exists, so this ends.

DENSE = 1 / 32  # of all entries, from which a matrix is not held sparse


@final
@dataclass(frozen=True, slots=True)
class LiftedRows:
    """A matrix E in reduced echelon form with few distinct entries outside the pivot columns."""

    field: ExactField
    pivots: list[int]
    free: list[int]  # the other columns
    numerators: list[int]  # the distinct coordinates of entries in powers of the generator, times the denominator
    den: int
    index: IntegerArray  # (degree, d, free columns): which of them each coordinate is

    def modulo(self, p: int, root: int) -> Residues:
        """The numerators R modulo a prime, shape (d, w)."""
        distinct = np.array([x % p for x in self.numerators], dtype=np.float64)
        rows = np.zeros((len(self.pivots), len(self.pivots) + len(self.free)))
        for s, part in enumerate(self.index):
            in_time()
            rows[:, self.free] = remainders(rows[:, self.free] + pow(root, s, p) * distinct[part], p)
        rows[range(len(self.pivots)), self.pivots] = self.den % p
        return rows

    def matrix(self) -> ExactMatrix:
        """The matrix E."""
        d, w = len(self.pivots), len(self.pivots) + len(self.free)
        distinct, parts = np.array(self.numerators, dtype=np.object_), []
        for s, part in enumerate(self.index):
            in_time()
            table = np.zeros((d, w), dtype=np.object_)
            table[:, self.free] = distinct[part]
            table[range(d), self.pivots] = 0 if s else self.den
            parts.append(table.ravel().tolist())
        return self.field.from_parts(parts, d, w, self.den)


@final
class WordSpan:
    """Sums of words as rows of coefficients of all words that occur, and the space that nested commutators span."""

    def __init__(self, sums: PauliSums, words: Sequence[int]) -> None:
        field: Any = sums.field
        self.field: ExactField = field
        self.size = len(words)
        position = {word: i for i, word in enumerate(words)}
        entries = [{position[word]: c for word, c in terms.items()} for terms in sums.terms]
        table = [[row.get(i, field.zero) for i in range(self.size)] for row in entries]
        self.generators: ExactMatrix = field.matrix(table, (len(table), self.size)).cleared()
        self._products = products(words, sums.qubits, sorted({i for row in entries for i in row}))
        self._words, self.qubits = words, sums.qubits

    @cached_property
    def _all_products(self) -> tuple[IntegerArray, ...]:
        return products(self._words, self.qubits, range(self.size))

    def maps(self, rows: Residues, p: int) -> list[ResidueMap]:
        """For each combination g of generators the matrix of x -> [g, x], acting on rows x, modulo a prime."""
        from scipy import sparse

        first, second, third, signs = self._products
        maps: list[ResidueMap] = []
        for row in rows:
            chosen = np.flatnonzero(row[first])
            values = remainders(2 * signs[chosen] * row[first[chosen]], p)
            matrix = sparse.csr_array((values, (second[chosen], third[chosen])), shape=(self.size, self.size))
            maps.append(matrix.toarray() if len(chosen) > DENSE * self.size**2 else matrix)
        return maps

    def dense_map(self, row: Residues, p: int) -> Residues:
        """The matrix of x -> [y, x] for any row y, acting on rows x, modulo a prime."""
        first, second, third, signs = self._all_products
        matrix: Residues = np.zeros((self.size, self.size))
        matrix[second, third] = remainders(2 * signs * row[first], p)
        return matrix

    def closure(self, p: int, root: int, derived: bool = False) -> tuple[IntegerArray, list[int]]:
        """The reduced echelon basis of the closure modulo a prime, or of its derived algebra, and the pivots."""
        rows = residues(self.generators, p, root)
        maps = self.maps(rows, p)
        return invariant_span(maps, self._start(rows, maps, p) if derived else rows, p).echelon()

    def basis(self, derived: bool = False) -> LiftedRows | None:
        """The echelon basis (d, w) of the generated algebra or its derived algebra; None if it contains every word."""
        if len(self.closure(*residue_map(self.field), derived)[1]) == self.size:
            return None
        rows = next((rows for rows in self._lifts(derived) if self._is_closed(rows, derived)), None)
        if rows is None:
            raise InternalError("the basis of a generated algebra was not found modulo primes")
        return rows if rows.free else None

    def _lifts(self, derived: bool) -> Iterator[LiftedRows]:
        """Proposals for the basis, from one prime, from two, ..."""
        best: tuple[int, list[int]] = (-1, [])  # rank and pivots: all but finitely many primes give the largest
        lift = RationalLift()
        for p, roots in splitting_primes(self.field):
            spans = [self.closure(p, root, derived) for root in roots]
            pivots, m = spans[0][1], len(roots)
            rank = (len(pivots), [-j for j in pivots])
            if rank < best or any(other != pivots for _, other in spans):
                continue
            if rank > best:
                best, lift = rank, RationalLift()
            free = sorted(set(range(self.size)) - set(pivots))
            values = np.array([rows[:, free].ravel() for rows, _ in spans], dtype=np.float64)
            lift.add(interpolated(values, roots, p).astype(np.int64).ravel().tolist(), p)
            if (fractions := lift.fractions()) is not None:
                den = lcm(*(int(f.q) for f in fractions))
                numerators = [int(f.p) * (den // int(f.q)) for f in fractions]
                index = np.array(lift.index, dtype=np.int64).reshape(m, len(pivots), len(free))
                yield LiftedRows(self.field, pivots, free, numerators, den, index)

    def _is_closed(self, rows: LiftedRows, derived: bool) -> bool:
        """Whether the span of rows contains the generators or their commutators, and commutators with generators."""
        modulus = self.field.modulus_coefficients()
        spread = sum((1 + max(map(abs, modulus))) ** s for s in range(self.field.degree))
        coordinate = max(int(abs(x)) for part in self.generators.parts for x in part.entries())
        largest = max(map(abs, [rows.den, *rows.numerators]))
        bracket = 2 * self.size * coordinate * max(coordinate, largest)
        bound = bracket * (rows.den + len(rows.pivots) * largest) * spread
        return all(self._is_closed_modulo(rows, derived, *pair) for pair in small_residues(self.field, bound))

    def _is_closed_modulo(self, rows: LiftedRows, derived: bool, p: int, root: int) -> bool:
        generators, basis = residues(self.generators, p, root), rows.modulo(p, root)
        maps = self.maps(generators, p)
        start = self._start(generators, maps, p) if derived else generators
        return not any(
            remainders(rows.den % p * images - product(images[:, rows.pivots], basis, p), p).any()
            for images in itertools.chain([start], (product(basis, matrix, p) for matrix in maps))
        )

    @staticmethod
    def _start(generators: Residues, maps: list[ResidueMap], p: int) -> Residues:
        """The commutators of generators, which generate the derived algebra as an ideal."""
        return np.concatenate([product(generators, matrix, p) for matrix in maps])
