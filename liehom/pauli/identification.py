"""Names of the Lie algebras that Pauli words span, by linear algebra over F_2.

Let D be a set of words that is closed under commutators and connected by anticommutation. Let W be its span over F_2,
R the radical of the symplectic form on W, V = W / R of dimension 2m, and K the translations of R that preserve D. The
words of K are central and square to 1, so their signs split the algebra into |K| copies of the span of D / K:

* su(2^m) if D / K has 4^m - 1 elements. These are all words except the identity on m qubits.
* so(2^m) or sp(2^(m-1)) if D is the set {q = 1} of a quadratic form q on W that vanishes on R. These are the words that
  an involutive anti-automorphism negates. The algebra is orthogonal if q has Arf invariant 0, else symplectic.
* so(k) if D / K consists of anticommuting words c_1, ..., c_(k-1) and their products c_i c_j.

Each criterion is checked as it is stated. If none applies, the ideal has no name here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import final

from liehom.algebra.roots.real_form_names import canonical_real_form
from liehom.pauli.symplectic import closed_words, swapped


@final
@dataclass(frozen=True, slots=True)
class WordIdeal:
    """An ideal that is spanned by Pauli words which anticommutation connects.

    Attributes
    ----------
    words : tuple of int
    copies : int
        The number of isomorphic ideals whose sum it is.
    kind : str or None
        Name of one of them, such as 'so(20)'; 'u(1)' for a central word; None if it was not recognized.
    """

    words: tuple[int, ...]
    copies: int
    kind: str | None


def word_ideals(generators: Sequence[int], qubits: int) -> list[WordIdeal]:
    """The ideals that connected sets of words generate, in the order of their first words.

    Examples
    --------
    >>> from liehom.pauli.words import encode
    >>> x, z, other = encode({0: "X"}, 2), encode({0: "Z"}, 2), encode({1: "Y"}, 2)
    >>> [(ideal.kind, ideal.copies) for ideal in word_ideals([x, z, other], 2)]
    [('so(3)', 1), ('u(1)', 1)]
    """
    ideals = []
    for part in _connected(generators, qubits):
        words = closed_words(part, qubits)
        ideals.append(_recognized(part, words, qubits))
    return ideals


def _connected(generators: Sequence[int], qubits: int) -> list[list[int]]:
    """The generators, distinct, by connected components of their anticommutation graph."""
    left = list(dict.fromkeys(generators))
    parts = []
    while left:
        part, left = [left[0]], left[1:]
        for word in part:  # the list grows while it is read
            other = swapped(word, qubits)
            near = [w for w in left if (w & other).bit_count() & 1]
            part += near
            left = [w for w in left if w not in set(near)]
        parts.append(part)
    return parts


def _recognized(generators: Sequence[int], words: Sequence[int], qubits: int) -> WordIdeal:
    if len(words) == 1:
        return WordIdeal(tuple(words), 1, "u(1)")
    radical = _radical(generators, qubits)
    fibre = [w ^ words[0] for w in words if _in_span(w ^ words[0], radical)]
    inside = set(words)
    translations = [r for r in fibre if all(w ^ r in inside for w in words)]
    if len(translations) < len(fibre):
        return WordIdeal(tuple(words), 1, None)
    m = (len(_reduced(generators)) - len(radical)) // 2
    kind = _kind(generators, words, radical, translations, m, qubits)
    return WordIdeal(tuple(words), len(translations), None if kind is None else canonical_real_form(kind))


def _kind(
    generators: Sequence[int],
    words: Sequence[int],
    radical: Sequence[int],
    translations: Sequence[int],
    m: int,
    qubits: int,
) -> str | None:
    count = len(words) // len(translations)
    images = {_residue(w, radical) for w in words}
    if len(images) == count == 4**m - 1:
        return f"su({2**m})"
    arf = _arf_invariant(generators, words, radical, qubits)
    if arf is not None and len(words) == 2 ** len(radical) * 2 ** (m - 1) * (2**m + (1 if arf else -1)):
        return f"sp({2 ** (m - 1)})" if arf else f"so({2**m})"
    return _orthogonal(words, _reduced(translations), count, qubits)


def _orthogonal(words: Sequence[int], translations: Sequence[int], count: int, qubits: int) -> str | None:
    """'so(k)' if the words modulo translations are k - 1 anticommuting words and their products."""
    classes = list(dict.fromkeys(_residue(w, translations) for w in words))
    first = classes[0]
    near = [w for w in classes if _anticommute(w, first, qubits)]
    second = near[0]
    rest = [w for w in near if _anticommute(w, second, qubits) and w != _residue(first ^ second, translations)]
    units = [first, second, *rest]
    products = {_residue(a ^ b, translations) for i, a in enumerate(units) for b in units[:i]}
    found = products | set(units)
    k = len(units) + 1
    if not all(_anticommute(a, b, qubits) for i, a in enumerate(units) for b in units[:i]):
        return None
    return f"so({k})" if len(found) == count == k * (k - 1) // 2 and found == set(classes) else None


def _arf_invariant(generators: Sequence[int], words: Sequence[int], radical: Sequence[int], qubits: int) -> int | None:
    """The Arf invariant of the quadratic form that is 1 on all words, or None if there is none on V.

    q(a + b) = q(a) + q(b) + <a, b>. It is carried along as one more bit of each word.
    """
    flag = 1 << (2 * qubits)
    marked = [g | flag for g in generators]

    def add(a: int, b: int) -> int:
        return (a ^ b) ^ (flag if _anticommute(a, b, qubits) else 0)

    basis: dict[int, int] = {}  # leading bit of the word -> word with its value of q

    def reduce(word: int) -> int:
        while word & (flag - 1):
            top = (word & (flag - 1)).bit_length()
            if top not in basis:
                return word
            word = add(word, basis[top])
        return word

    for word in marked:
        left = reduce(word)
        if left & (flag - 1):
            basis[(left & (flag - 1)).bit_length()] = left
        elif left:
            return None  # q(0) = 1: the values at the generators contradict each other
    if any(reduce(r) for r in radical) or any(reduce(w) != flag for w in words):
        return None  # q(r) = 1 for a central word, or q(w) = 0 for a word: read off the value left at 0
    return _arf_of(list(basis.values()), add, flag, qubits)


def _arf_of(vectors: list[int], add: Callable[[int, int], int], flag: int, qubits: int) -> int:
    """Sum of q(a) q(b) over the pairs of a symplectic basis, by Gram-Schmidt."""
    total = 0
    while vectors:
        a, *vectors = vectors
        partner = next((b for b in vectors if _anticommute(a, b, qubits)), None)
        if partner is None:
            continue
        vectors.remove(partner)
        total ^= int(bool(a & flag) and bool(partner & flag))
        for i, v in enumerate(vectors):
            to_a, to_b = _anticommute(v, a, qubits), _anticommute(v, partner, qubits)
            v = add(v, partner) if to_a else v
            vectors[i] = add(v, a) if to_b else v
    return total


def _anticommute(a: int, b: int, qubits: int) -> bool:
    return bool((a & ((1 << 2 * qubits) - 1) & swapped(b & ((1 << 2 * qubits) - 1), qubits)).bit_count() & 1)


def _reduced(words: Iterable[int]) -> list[int]:
    """A basis over F_2 of the span, by elimination from the leading bit."""
    basis: dict[int, int] = {}
    for word in words:
        while word:
            top = word.bit_length()
            if top not in basis:
                basis[top] = word
                break
            word ^= basis[top]
    return [basis[top] for top in sorted(basis, reverse=True)]


def _residue(word: int, basis: Sequence[int]) -> int:
    """The representative of a word modulo the span of a basis made by `_reduced`."""
    for b in basis:
        word = min(word, word ^ b)
    return word


def _in_span(word: int, basis: Sequence[int]) -> bool:
    return _residue(word, basis) == 0


def _radical(generators: Sequence[int], qubits: int) -> list[int]:
    """A basis of the words in the span that commute with all generators."""
    basis = _reduced(generators)
    rows = []  # for each basis word the bits of its anticommutation with the basis, and its own index
    for i, word in enumerate(basis):
        row = sum(1 << j for j, other in enumerate(basis) if _anticommute(word, other, qubits))
        rows.append(row << len(basis) | 1 << i)
    found = []
    pivots: dict[int, int] = {}
    for row in rows:
        while row >> len(basis):
            top = row.bit_length()
            if top not in pivots:
                pivots[top] = row
                break
            row ^= pivots[top]
        else:
            total = 0
            for i, word in enumerate(basis):
                total ^= word if row >> i & 1 else 0
            found.append(total)
    return _reduced(found)
