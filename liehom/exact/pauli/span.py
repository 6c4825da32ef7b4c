"""The algebra that sums of Pauli words generate, in coordinates on words: modulo primes, and lifted with a proof."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from math import lcm
from typing import Any, final

import flint
import numpy as np

from liehom.base.errors import InternalError
from liehom.base.typing import IntegerArray
from liehom.exact.pauli.words import PauliSums, products
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.modular import (
    RationalLift,
    Residues,
    invariant_span,
    product,
    remainders,
    residue_map,
    residues,
    small_residues,
    splitting_primes,
)

# Let W be the span of the w words that occur, and g the algebra that the sums generate, a subspace of W.
#
# Lower bound. Elements of g with integral coefficients reduce modulo a prime to elements of an algebra that contains
# the closure of the reduced generators. So the rank of that closure is at most dim g. If it is w, then g = W.
#
# Upper bound. The reduced echelon basis of the closure, for several primes, is lifted to a matrix E = R / D over the
# field (Wang). If the span of the rows of E contains the generators g_a and all [g_a, row], it contains g, and dim g is
# at most the number of rows. With the pivot columns P of E this says
#
#     D g_a = (g_a)_P R,    D [g_a, R] = [g_a, R]_P R.
#
# The differences are sums of products of integers with a known bound, so they vanish if they vanish modulo enough
# primes. A lift from too few primes fails there, and one prime more is taken. E exists, so this ends.


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

    def maps(self, rows: Residues, p: int) -> list[Any]:
        """For each row g the sparse matrix of x -> [g, x], acting on rows x, modulo a prime."""
        from scipy import sparse

        first, second, third, signs = self._products
        maps = []
        for row in rows:
            chosen = np.flatnonzero(row[first])
            values = remainders(2 * signs[chosen] * row[first[chosen]], p)
            place = (second[chosen], third[chosen])
            maps.append(sparse.csr_array((values, place), shape=(self.size, self.size)))
        return maps

    def closure(self, p: int, root: int) -> tuple[IntegerArray, list[int]]:
        """The reduced echelon basis of the closure modulo a prime, and its pivots."""
        rows = residues(self.generators, p, root)
        return invariant_span(self.maps(rows, p), rows, p).echelon()

    def basis(self) -> ExactMatrix | None:
        """The reduced echelon basis (d, w) of the generated algebra, or None if it contains every word."""
        if len(self.closure(*residue_map(self.field))[1]) == self.size:
            return None
        for rows, pivots in self._lifts():
            if self._is_closed(rows, pivots):
                return rows
        raise InternalError("the basis of a generated algebra was not found modulo primes")

    def _lifts(self) -> Iterator[tuple[ExactMatrix, list[int]]]:
        """Proposals for the basis with its pivots, from one prime, from two, ..."""
        best: tuple[int, list[int]] = (-1, [])  # a rank, and pivots from the left, that fewer primes exceed
        lift = RationalLift()
        for p, roots in splitting_primes(self.field):
            spans = [self.closure(p, root) for root in roots]
            pivots = spans[0][1]
            rank = (len(pivots), [-j for j in pivots])
            if rank < best or any(other != pivots for _, other in spans):
                continue
            if rank > best:
                best, lift = rank, RationalLift()
            free = sorted(set(range(self.size)) - set(pivots))
            values = np.array([rows[:, free].ravel() for rows, _ in spans], dtype=np.float64)
            m = len(roots)
            powers = flint.nmod_mat(m, m, [pow(root, s, p) for root in roots for s in range(m)], p).inv().entries()
            values = product(np.array([int(x) for x in powers], dtype=np.float64).reshape(m, m), values, p)
            lift.add(values.astype(np.int64).ravel().tolist(), p)
            if (fractions := lift.fractions()) is not None:
                yield self._with_units(fractions, pivots, free), pivots

    def _with_units(self, fractions: list[flint.fmpq], pivots: list[int], free: list[int]) -> ExactMatrix:
        """The echelon matrix with these coordinates in the columns that are not pivots."""
        d, w, m = len(pivots), self.size, self.field.degree
        den = lcm(*{int(f.q) for f in fractions})
        known = {f: int(f.p) * (den // int(f.q)) for f in set(fractions)}
        table = np.zeros((m, d, w), dtype=np.object_)
        table[:, :, free] = np.array([known[f] for f in fractions], dtype=np.object_).reshape(m, d, len(free))
        table[0, range(d), pivots] = den
        return self.field.from_parts([part.ravel().tolist() for part in table], d, w, den)

    def _is_closed(self, rows: ExactMatrix, pivots: list[int]) -> bool:
        """Whether the span of echelon rows contains the generators and is closed under commutators with them."""
        modulus = self.field.modulus_coefficients()
        spread = sum((1 + max(map(abs, modulus))) ** s for s in range(self.field.degree))
        largest, size = _largest(rows), 2 * _largest(self.generators) * self.size
        bound = spread * size * largest * (rows.den + len(pivots) * largest)
        return all(self._is_closed_modulo(rows, pivots, p, root) for p, root in small_residues(self.field, bound))

    def _is_closed_modulo(self, rows: ExactMatrix, pivots: list[int], p: int, root: int) -> bool:
        generators, basis, den = residues(self.generators, p, root), residues(rows, p, root), rows.den % p
        brackets = (product(basis, matrix, p) for matrix in self.maps(generators, p))
        return not any(
            remainders(den * images - product(images[:, pivots], basis, p), p).any()
            for images in itertools.chain([generators], brackets)
        )


def _largest(matrix: ExactMatrix) -> int:
    """The largest integer coordinate of the numerators, in absolute value."""
    return max((int(abs(x)) for part in matrix.parts for x in part.entries()), default=0)
