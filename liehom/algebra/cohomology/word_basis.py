"""Generators of a Lie algebra and a basis of their left-normed brackets, modulo a small prime.

A word is a generator or w = [x_i, v] with an earlier word v. Words that are a basis modulo a prime are a basis.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra.closure.generated_span import Words, right_normed_words
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import FieldError
from liehom.scalars import ExactField, Matrix
from liehom.scalars.modular.modular import small_residues
from liehom.scalars.modular.modular_span import ModularSpan, Residues, product

PRIME_SUPPLY = 1 << 200
"""The primes below 2^22 that are tried have this product at least: about nine of them."""


@final
@dataclass(frozen=True, slots=True)
class WordBasis:
    """Generators x_1, ..., x_s, a basis of words in them, and their brackets modulo a prime.

    Attributes
    ----------
    modulus : int
        A prime p below 2^22.
    generators : Matrix
        Rows (s, n) of small integers.
    words : tuple of (int, int)
        (i, -1) for generator i (these come first, in order), else (i, v): the bracket of generator i with word v.
    basis, inverse : array (n, n)
        The words as rows modulo p, and the inverse.
    table, word_table : array (n, n, n)
        The structure constants modulo p in the given basis and in the basis of words.
    """

    modulus: int
    generators: Matrix
    words: tuple[tuple[int, int], ...]
    basis: Residues
    inverse: Residues
    table: Residues
    word_table: Residues


def word_bases(algebra: LieAlgebra) -> Iterator[WordBasis]:
    """Word bases for one prime after the other, to be tried until a prime is usable.

    Parameters
    ----------
    algebra : LieAlgebra
        Over an exact field. The generators are a complement of [g, g], extended by small random elements until they
        generate g.

    Raises
    ------
    UndecidedError
        Over float64.

    Examples
    --------
    >>> import liehom as lh
    >>> next(word_bases(lh.heisenberg(1))).words
    ((0, -1), (1, -1), (0, 1))
    """
    field = algebra.field
    if not isinstance(field, ExactField):
        raise FieldError(f"words modulo primes exist over exact fields, got {field.name}")
    for p, root in small_residues(field, PRIME_SUPPLY):
        if algebra.table.den % p:
            yield _words_modulo(algebra, p, root)


def exact_words(algebra: LieAlgebra, found: WordBasis) -> Matrix:
    """The words as exact rows, a matrix (n, n)."""
    n, field = algebra.dimension, algebra.field
    s = found.generators.nrows
    actions = [algebra.ad(found.generators.select(rows=[i])).T for i in range(s)]
    rows = [found.generators.select(rows=[i]) for i in range(s)]
    for i, v in found.words[s:]:
        rows.append(rows[v] @ actions[i])
    whole: Matrix = field.stack_rows(rows, n)
    return whole


def table_modulo(table: StructureConstants, p: int, root: int) -> Residues:
    """The structure constants modulo a prime p as an array (n, n, n); p must not divide their denominator.

    Examples
    --------
    >>> import liehom as lh
    >>> table_modulo(lh.so(3).table, 7, 0)[0, 2].tolist()
    [0.0, 6.0, 0.0]
    """
    values, power = [0] * len(table), pow(table.den, -1, p)
    for part in table.parts:
        values = [(v + power * int(x)) % p for v, x in zip(values, part, strict=True)]
        power = power * root % p
    dense = np.zeros((table.dimension,) * 3)
    dense[table.i, table.j, table.k] = values
    dense[table.j, table.i, table.k] = [-v % p for v in values]
    return dense


def _words_modulo(algebra: LieAlgebra, p: int, root: int) -> WordBasis:
    n = algebra.dimension
    table = table_modulo(algebra.table, p, root)
    derived = ModularSpan(p, n)
    derived.extend(table.reshape(n * n, n))
    outside = sorted(set(range(n)) - set(derived.pivots))
    generators = [[int(i == j) for j in range(n)] for i in outside]
    rng = random.Random(n)
    words, basis = _closed(table, generators, p)
    while len(words) < n:
        generators.append([rng.randint(-1, 1) for _ in range(n)])
        words, basis = _closed(table, generators, p)
        if sum(v < 0 for _, v in words) < len(generators):  # the new generator depends on the others
            generators.pop()
    inverse = _inverse(basis, p)
    moved = product(product(basis, table.reshape(n, n * n), p).reshape(n, n, n), inverse, p)
    rows = algebra.field.matrix(generators, (len(generators), n))
    return WordBasis(p, rows, tuple(words), basis, inverse, table, product(basis, moved, p))


def _closed(table: Residues, generators: list[list[int]], p: int) -> tuple[Words, Residues]:
    """A basis of words in the generators, and its residues (m, n)."""
    n = len(table)
    first = np.mod(np.array(generators, dtype=np.float64).reshape(-1, n), p)
    actions = product(first, table.reshape(n, n * n), p).reshape(-1, n, n)

    def brackets(last: Residues) -> Residues:
        return np.concatenate([product(last, action, p) for action in actions])

    words, levels = right_normed_words(ModularSpan(p, n), first, brackets)
    return words, np.concatenate(levels)


def _inverse(matrix: Residues, p: int) -> Residues:
    """The inverse modulo p of a matrix (n, n) that is invertible there."""
    n = len(matrix)
    span = ModularSpan(p, 2 * n)
    span.extend(np.hstack([matrix, np.eye(n)]))
    order = np.argsort(span.pivots)
    return span.rows[order][:, n:]
