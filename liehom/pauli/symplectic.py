"""Commutators of Pauli words by symplectic arithmetic over F_2.

Two words commute if and only if x . z' + z . x' is even. Otherwise [iP, iQ] = c iR with c = 2 or -2 and R the word with
the exclusive or of the bits.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.budget import in_time, within
from liehom.scalars import QQ
from liehom.typing import IntegerArray


def swapped(word: int, qubits: int) -> int:
    """The word with x and z exchanged: words a, b anticommute if ``(a & swapped(b)).bit_count()`` is odd."""
    return (word & ((1 << qubits) - 1)) << qubits | word >> qubits


def closed_words(words: Sequence[int], qubits: int, most: int | None = None) -> list[int]:
    """The words that nested commutators of the given words reach: the given ones first, then level by level.

    The Lie algebra that a set generates is spanned by nested commutators [g_1, [g_2, ...]] of the set, so that each
    new word is commuted with the given ones only. The list stops at the first word beyond `most`.

    Examples
    --------
    >>> from liehom.pauli.words import encode, spell
    >>> x, y = encode({0: "X"}, 1), encode({0: "Y"}, 1)
    >>> [spell(w, 1) for w in closed_words([x, y], 1)]
    ['X', 'Y', 'Z']
    """
    found = list(dict.fromkeys(words))
    seen = set(found)
    generators = [(g, swapped(g, qubits)) for g in found]
    for word in found:  # the list grows while it is read
        for g, other in generators:
            if (word & other).bit_count() & 1:
                new = word ^ g
                if new not in seen:
                    seen.add(new)
                    found.append(new)
        in_time()
        if most is not None and len(found) > most:
            return found[: most + 1]
    return found


def word_table(words: Sequence[int], qubits: int) -> StructureConstants:
    """The bracket table of the basis iP of closed words: constants 2 and -2, over QQ."""
    first, second, third, signs = products(words, qubits)
    values: list[int] = (2 * signs).tolist()
    return StructureConstants.from_integers(QQ, len(words), first, second, third, values)


def products(words: Sequence[int], qubits: int) -> tuple[IntegerArray, IntegerArray, IntegerArray, IntegerArray]:
    """Indices a < b of anticommuting words of a closed list, the index c of their product, and s in
    [iP_a, iP_b] = 2 s iP_c."""
    x, z = bits(words, qubits)
    left, right = z @ x.T, x @ z.T
    first, second = np.nonzero(np.triu((left + right) & 1, 1))
    within("entries", len(first), "the bracket table has {} entries")
    position = {word: i for i, word in enumerate(words)}
    third = np.array(
        [position[words[a] ^ words[b]] for a, b in zip(first.tolist(), second.tolist(), strict=True)], dtype=np.int64
    )
    ys = (x & z).sum(axis=1)
    # P_a P_b = i^phase P_c with an odd phase, and [iP_a, iP_b] = -2 P_a P_b
    phase = (ys[first] + ys[second] - ys[third] + 2 * left[first, second]) % 4
    return first, second, third, phase - 2


def bits(words: Sequence[int], qubits: int) -> tuple[IntegerArray, IntegerArray]:
    """The bits x and z of words, two integer arrays of shape (number of words, qubits)."""
    letters = [f"{word:0{2 * qubits}b}" for word in words]
    table = np.array([[int(b) for b in row] for row in letters], dtype=np.int64).reshape(len(words), 2 * qubits)
    return table[:, :qubits], table[:, qubits:]


def real_matrix(word: int, qubits: int) -> IntegerArray:
    """The real matrix of iP on (Re z_1, Im z_1, ...), shape (2N, 2N) with N = 2 to the number of qubits.

    Examples
    --------
    >>> from liehom.pauli.words import encode
    >>> real_matrix(encode({0: "Z"}, 1), 1)
    array([[ 0, -1,  0,  0],
           [ 1,  0,  0,  0],
           [ 0,  0,  0,  1],
           [ 0,  0, -1,  0]])
    """
    size = 1 << qubits
    x, z = word >> qubits, word & (size - 1)
    made = np.zeros((2 * size, 2 * size), dtype=np.int64)
    powers = ((1, 0), (0, 1), (-1, 0), (0, -1))  # of i
    for column in range(size):
        # i P e_b = i^(1 + x.z) (-1)^(z.b) e_(b + x)
        real, imaginary = powers[(1 + (x & z).bit_count() + 2 * (z & column).bit_count()) % 4]
        row = column ^ x
        made[2 * row : 2 * row + 2, 2 * column : 2 * column + 2] = ((real, -imaginary), (imaginary, real))
    return made
