"""The Lie algebra that matrices generate, by the echelon basis of its span and the bracket table in this basis.

The generated algebra is the span of all iterated commutators [a_1, [a_2, ... a_k]] of generators.  It is found modulo a
prime, where its dimension is at most the true one, and lifted to the rationals.  A lift that contains the generators
and is closed under commutators contains the algebra; because its dimension is not larger, it is the algebra.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, final

import numpy as np

from liehom.algebra.closure.sparse_commutators import sparse_commutator_table
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.scalars import ExactMatrix
from liehom.scalars.modular.modular_span import (
    ModularSpan,
    Residues,
    flat_echelon,
    product,
    rational_lifts,
    residue_map,
    residues,
)

Words: TypeAlias = list[tuple[int, int]]
"""A basis of the generated algebra: (g, -1) is generator g, (g, w) the commutator [generator g, word w]."""


@final
@dataclass(frozen=True, slots=True)
class GeneratedSpan:
    """The Lie algebra that matrices over QQ generate, in the echelon basis of its span.

    Attributes
    ----------
    rows : ExactMatrix
        The flattened basis, (d, N*N), in reduced echelon form.
    pivots : list of int
        Flat indices of the entries that are the coordinates of an element.
    table : StructureConstants
        The bracket table in this basis.
    """

    rows: ExactMatrix
    pivots: list[int]
    table: StructureConstants

    def coordinates(self, matrices: Sequence[ExactMatrix]) -> ExactMatrix:
        """The coordinates (k, d) of k elements of the algebra."""
        size = self.rows.ncols
        flat = self.rows.field.stack_rows([a.reshape(1, size) for a in matrices], size)
        return flat.select(columns=self.pivots)


def spanning_commutators(generators: Sequence[ExactMatrix]) -> Words:
    """Iterated commutators of the generators that are a basis of the generated algebra modulo a prime.

    They are independent, and a basis for all but finitely many primes.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> spanning_commutators([QQ.matrix([[0, 1], [0, 0]]), QQ.matrix([[0, 0], [1, 0]])])
    [(0, -1), (1, -1), (0, 1)]
    """
    field, n = generators[0].field, generators[0].nrows
    p, root = residue_map(field)
    given = np.array([residues(a, p, root) for a in generators])

    def brackets(last: Residues) -> Residues:
        return np.concatenate([np.mod(product(a, last, p) - product(last, a, p), p) for a in given])

    return right_normed_words(ModularSpan(p, n * n), given, brackets)[0]


def right_normed_words(
    span: ModularSpan, generators: Residues, brackets: Callable[[Residues], Residues]
) -> tuple[Words, list[Residues]]:
    """Words [x_i, [x_j, ... x_k]] that are a basis, modulo a prime, of the generated algebra, and their values.

    Parameters
    ----------
    span : ModularSpan
        Empty; afterwards the span of all words.
    generators : (s, ...) float64
        The residues of x_1, ..., x_s.
    brackets : callable
        Maps the residues of m words w_j to the array whose entry i m + j holds the residues of [x_i, w_j].

    Returns
    -------
    words : list of (int, int)
    levels : list of arrays
        The residues of the words of each length. Their concatenation is in the order of `words`.

    Examples
    --------
    The cross product, from the first two unit vectors:

    >>> one = np.eye(3)
    >>> words, levels = right_normed_words(
    ...     ModularSpan(7, 3), one[:2], lambda w: np.concatenate([np.cross(x, w) % 7 for x in one[:2]])
    ... )
    >>> words, levels[1].tolist()
    ([(0, -1), (1, -1), (0, 1)], [[0.0, 0.0, 1.0]])
    """
    kept = span.extend(generators)
    words: Words = [(i, -1) for i in kept]
    levels, start = [generators[kept]], 0
    while len(levels[-1]) and span.rank < span.ncols:
        images, count = brackets(levels[-1]), len(levels[-1])
        kept = span.extend(images)
        words += [(i // count, start + i % count) for i in kept]
        start += count
        levels.append(images[kept])
    return words, levels


def commutator_pairs(basis: Sequence[ExactMatrix], dimension: int) -> list[tuple[int, int]]:
    """Pairs (i, j) of basis elements whose commutators complete the basis, in rounds, each in lexicographic order.

    Each commutator is independent of all earlier elements, which residues modulo a prime prove.

    Parameters
    ----------
    basis : sequence of ExactMatrix
        Independent matrices.
    dimension : int
        The dimension of the generated algebra modulo a prime (`spanning_commutators`).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> commutator_pairs([QQ.matrix([[0, 1], [0, 0]]), QQ.matrix([[0, 0], [1, 0]])], 3)
    [(0, 1)]
    """
    n = basis[0].nrows
    p, root = residue_map(basis[0].field)
    made = np.array([residues(a, p, root) for a in basis])
    span = ModularSpan(p, n * n)
    span.extend(made)
    pairs: list[tuple[int, int]] = []
    before = -1
    while before < span.rank < dimension:
        before, new = span.rank, []
        for i in range(len(made) - 1):
            later = made[i + 1 :]
            images = np.mod(product(made[i], later, p) - product(later, made[i], p), p)
            kept = span.extend(images)
            pairs += [(i, i + 1 + j) for j in kept]
            new.append(images[kept])
            if span.rank == dimension:
                break
        made = np.concatenate([made, *new])
    return pairs


def generated_span(generators: Sequence[ExactMatrix]) -> GeneratedSpan | None:
    """The generated Lie algebra in the echelon basis of its span, proved, or None if no lift could be proved.

    Parameters
    ----------
    generators : sequence of ExactMatrix
        At least one matrix (N, N) over QQ.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> found = generated_span([QQ.matrix([[0, 3], [0, 0]]), QQ.matrix([[1, 1], [1, -1]])])
    >>> found.rows.to_strings()
    [['1', '0', '0', '-1'], ['0', '1', '0', '0'], ['0', '0', '1', '0']]
    """
    field, n = generators[0].field, generators[0].nrows
    flat = field.stack_rows([a.reshape(1, n * n) for a in generators], n * n)
    words = spanning_commutators(generators)
    for rows in rational_lifts(lambda attempt: _echelon(generators, words, attempt), field):
        pivots = _pivots(rows)
        if not (flat - flat.select(columns=pivots) @ rows).is_zero():
            continue
        table = sparse_commutator_table(rows.split_rows(n, n), pivots, field.identity(rows.nrows))
        if isinstance(table, StructureConstants):
            return GeneratedSpan(rows, pivots, table)
    return None


def _pivots(rows: ExactMatrix) -> list[int]:
    """The column of the first non-zero entry of each row of an echelon form."""
    n, entries = rows.ncols, rows.parts[0].entries()
    return [next(j for j in range(n) if entries[i * n + j]) for i in range(rows.nrows)]


def _echelon(generators: Sequence[ExactMatrix], words: Words, attempt: int) -> Any:
    """The echelon form of the flattened words modulo a prime (``flint.nmod_mat``)."""
    images = [a.modulo(attempt) for a in generators]
    made: list[Any] = []
    for generator, parent in words:
        a = images[generator]
        made.append(a if parent < 0 else a * made[parent] - made[parent] * a)
    return flat_echelon(made)
