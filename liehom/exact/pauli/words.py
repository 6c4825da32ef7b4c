"""Pauli words, their commutators over F_2, and Hamiltonians of spin models."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias, final

import numpy as np

from liehom.base.budget import in_time, within
from liehom.base.errors import FieldError, InputError, ParseError, shown
from liehom.base.typing import IntegerArray, ScalarLike
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.tables import field_of_values
from liehom.exact.scalars import grammar
from liehom.exact.scalars.field import Field, Scalar
from liehom.exact.scalars.rational import QQ

# A word on n qubits is the Hermitian matrix P(x, z) = i^(x . z) X^x Z^z with bit vectors x and z. It is stored as one
# integer ``x << n | z``. Bit n - 1 - q of x and of z belongs to qubit q, so that integers sort as bit strings.

Hamiltonian: TypeAlias = str | Mapping[str, ScalarLike] | Sequence[tuple[str, ScalarLike]]
"""A Pauli word such as "ZZI", or a sum of words: a string, ``{word: coefficient}``, or pairs (word, coefficient)."""

LETTERS = re.compile(r"[IXYZ]+")
FACTOR = re.compile(r"([IXYZ])(?:(\d+)|\(\s*(\d+)\s*\))")
DECIMAL = re.compile(r"\d+\.\d*|\.\d+")
BITS = {"I": (0, 0), "X": (1, 0), "Y": (1, 1), "Z": (0, 1)}

Factors = dict[int, str]  # qubit -> letter, without "I"


@final
@dataclass(frozen=True, slots=True)
class PauliSums:
    """Hamiltonians as linear combinations of words on a common number of qubits.

    Attributes
    ----------
    qubits : int
    field : Field
        The smallest field that contains all coefficients.
    terms : tuple of dict
        For each Hamiltonian {word: non-zero coefficient}, with words as integers.
    """

    qubits: int
    field: Field
    terms: tuple[dict[int, Scalar], ...]


def read_sums(hamiltonians: Iterable[Hamiltonian], qubits: int | None = None) -> PauliSums:
    """Hamiltonians from their strings, over the smallest field that contains their coefficients."""
    if isinstance(hamiltonians, (str, Mapping)):
        raise InputError(f"a list of Hamiltonians was expected, got {shown(repr(hamiltonians))}; write [...] around it")
    sums = [_terms(h, i) for i, h in enumerate(hamiltonians)]
    if not sums:
        raise InputError("no Hamiltonian was given; the number of qubits would be unknown")
    n = _qubits(sums, qubits)
    field = field_of_values(c for terms in sums for _, _, c in terms)
    totals = []
    for i, terms in enumerate(sums):
        total: dict[int, Scalar] = {}
        for factors, _, coefficient in terms:
            word = encode(factors, n)
            total[word] = total.get(word, field.zero) + field.convert(coefficient)
        total = {word: c for word, c in total.items() if c != 0}
        if not total:
            raise InputError(f"Hamiltonian {i} is zero; leave it out")
        totals.append(total)
    return PauliSums(n, field, tuple(totals))


def encode(factors: Factors, qubits: int) -> int:
    """The integer of the word with these letters."""
    bits = ((*BITS[letter], qubits - 1 - qubit) for qubit, letter in factors.items())
    return sum((x << qubits | z) << place for x, z, place in bits)


def spell(word: int, qubits: int) -> str:
    """The letters of a word, qubit 0 first."""
    x, z = word >> qubits, word & ((1 << qubits) - 1)
    return "".join("IZXY"[2 * (x >> b & 1) + (z >> b & 1)] for b in reversed(range(qubits)))


Term: TypeAlias = tuple[Factors, int | None, ScalarLike]  # letters, length of a spelled word, coefficient


def _terms(hamiltonian: Hamiltonian, index: int) -> list[Term]:
    if isinstance(hamiltonian, str):
        return [_term(sign, text, index) for sign, text in _signed(hamiltonian, index)]
    pairs: Iterable[tuple[str, ScalarLike]]
    pairs = hamiltonian.items() if isinstance(hamiltonian, Mapping) else hamiltonian
    try:
        terms = [(*_word(word, index), _real(coefficient, index)) for word, coefficient in pairs]
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"Hamiltonian {index} is {shown(repr(hamiltonian))}, expected a string such as 'XX + 1/2 * YY', "
            "{word: coefficient}, or pairs (word, coefficient)"
        ) from None
    if not terms:
        raise InputError(f"Hamiltonian {index} has no terms; leave it out")
    return terms


def _real(coefficient: ScalarLike, index: int) -> ScalarLike:
    if isinstance(coefficient, (float, complex)) or (
        type(coefficient).__module__ == "numpy" and not hasattr(coefficient, "__index__")
    ):
        raise FieldError(
            f"the coefficient {coefficient!r} of Hamiltonian {index} is not exact; write an integer, a Fraction, or a "
            "string such as '7/10', '0.7' or 'sqrt(2)/2'"
        )
    if coefficient is None or isinstance(coefficient, bool):
        raise FieldError(f"the coefficient {coefficient!r} of Hamiltonian {index} is not a number")
    if isinstance(coefficient, str) and DECIMAL.fullmatch(coefficient.strip()):
        return Fraction(coefficient)
    return coefficient


def _signed(text: str, index: int) -> list[tuple[int, str]]:
    """The terms of a sum with their signs, split at + and - outside of parentheses."""
    terms, depth, sign, begin = [], 0, 1, 0
    for at, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and letter in "+-" and not text[begin:at].rstrip().endswith(("*", "@", "/")):
            if text[begin:at].strip():
                terms.append((sign, text[begin:at].strip()))
                sign = 1
            sign = -sign if letter == "-" else sign
            begin = at + 1
    if depth or not text[begin:].strip():
        what = "has parentheses that do not match" if depth else "ends before a word" if text.strip() else "is empty"
        raise ParseError(f"Hamiltonian {index}, {shown(text)!r}, {what}")
    return [*terms, (sign, text[begin:].strip())]


def _term(sign: int, text: str, index: int) -> Term:
    """One term: coefficients and one word, or factors such as X(0), joined by ``*``, ``@`` or spaces."""
    factors: Factors = {}
    length: int | None = None
    coefficients: list[str] = []
    has_word = False
    for part in _parts(text):
        try:
            more, spelled = _word(part, index)
        except ParseError:
            if FACTOR.match(part):
                raise
            coefficients.append(part)
            continue
        clash = sorted(set(more) & set(factors))
        if clash or (has_word and (spelled is not None or length is not None)):
            raise ParseError(
                f"the term {shown(text)!r} of Hamiltonian {index} has several words"
                + (f" or two letters at qubit {clash[0]}" if clash else "")
                + "; write one word such as 'XZI', or factors such as 'X(0) @ Z(1)', in each term"
            )
        factors |= more
        length, has_word = spelled, True
    if not has_word:
        raise ParseError(
            f"the term {shown(text)!r} of Hamiltonian {index} has no Pauli word; write letters I, X, Y, Z such as "
            "'ZZI', or factors such as 'Z(0) @ Z(1)'"
        )
    if len(coefficients) == 1 and DECIMAL.fullmatch(coefficients[0]):
        return factors, length, sign * Fraction(coefficients[0])
    for part in coefficients:
        try:
            grammar.parse(part)
        except ParseError as error:
            raise ParseError(
                f"the coefficient {shown(part)!r} of Hamiltonian {index} is not a number: {error}"
            ) from None
    product = "*".join(f"({c})" for c in coefficients)
    return factors, length, f"{sign}*{product}" if product else sign


def _parts(text: str) -> list[str]:
    """A term split at ``*``, ``@`` and spaces outside of parentheses; ``**`` and ``/`` stay inside coefficients."""
    joined = re.sub(r"\s*(\*\*|/)\s*", r"\1", text)
    joined = re.sub(r"([IXYZ])\s+\(", r"\1(", joined)
    parts, depth, begin = [], 0, 0
    for at, letter in enumerate(joined.replace("**", "^^")):  # only a single star separates
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and letter in "*@ \t\n":
            parts.append(joined[begin:at])
            begin = at + 1
    return [part for part in (*parts, joined[begin:]) if part]


def _word(text: str, index: int) -> tuple[Factors, int | None]:
    """Letters by qubit and, for a spelled word, its length; `ParseError` for any other string."""
    if not isinstance(text, str):
        raise InputError(f"a word of Hamiltonian {index} is {text!r}, expected a string such as 'ZZI'")
    if LETTERS.fullmatch(text):
        return {q: letter for q, letter in enumerate(text) if letter != "I"}, len(text)
    factors: Factors = {}
    rest = re.sub(r"[\s@*]+", "", text)
    if not rest or FACTOR.sub("", rest):
        raise ParseError(f"{shown(text)!r} in Hamiltonian {index} is not a Pauli word such as 'ZZI' or 'Z(0) @ Z(1)'")
    for match in FACTOR.finditer(rest):
        letter, qubit = match[1], match[2] or match[3]
        if len(qubit) > 6:
            raise ParseError(f"qubit {shown(qubit)} of Hamiltonian {index} is too large")
        if int(qubit) in factors:
            raise ParseError(f"{shown(text)!r} in Hamiltonian {index} has two letters at qubit {qubit}")
        factors[int(qubit)] = letter
    return factors, None


def _qubits(sums: Sequence[Sequence[Term]], qubits: int | None) -> int:
    lengths = {length: i for i, terms in enumerate(sums) for _, length, _ in terms if length is not None}
    if len(lengths) > 1:
        (a, i), (b, j) = sorted(lengths.items())[:2]
        raise InputError(f"the words have different lengths: {a} in Hamiltonian {i}, {b} in Hamiltonian {j}")
    last = max((q for terms in sums for factors, _, _ in terms for q in factors), default=0)
    n = qubits if qubits is not None else next(iter(lengths), last + 1)
    if isinstance(n, bool) or not isinstance(n, int) or n < 1:
        raise InputError(f"the number of qubits is {n!r}, expected a positive integer")
    if last >= n or any(length != n for length in lengths):
        wide = max(last + 1, *lengths, 1) if lengths else last + 1
        raise InputError(f"the words act on {wide} qubits, not on {n}")
    return n


# Commutators: two words commute if and only if x . z' + z . x' is even. Otherwise [iP, iQ] = c iR with c = 2 or -2 and
# R the word with the exclusive or of the bits.


def swapped(word: int, qubits: int) -> int:
    """The word with x and z exchanged: words a, b anticommute if ``(a & swapped(b)).bit_count()`` is odd."""
    return (word & ((1 << qubits) - 1)) << qubits | word >> qubits


def closed_words(words: Sequence[int], qubits: int, most: int | None = None) -> list[int]:
    """The words that nested commutators of words reach: the words themselves first, then level by level.

    The Lie algebra that a set generates is spanned by nested commutators [g_1, [g_2, ...]] of the set, so that each
    new word is commuted with the first ones only. The list stops at the first word beyond `most`.
    """
    reached = list(dict.fromkeys(words))
    seen = set(reached)
    generators = [(g, swapped(g, qubits)) for g in reached]
    for word in reached:  # the list grows while it is read
        for g, other in generators:
            if (word & other).bit_count() & 1 and (new := word ^ g) not in seen:
                seen.add(new)
                reached.append(new)
        in_time()
        if most is not None and len(reached) > most:
            return reached[: most + 1]
    return reached


def word_table(words: Sequence[int], qubits: int) -> StructureConstants:
    """The bracket table of the basis iP of closed words: constants 2 and -2, over QQ."""
    first, second, third, signs = products(words, qubits)
    return StructureConstants.from_integers(QQ, len(words), first, second, third, (2 * signs).tolist())


def products(
    words: Sequence[int], qubits: int, chosen: Sequence[int] | None = None
) -> tuple[IntegerArray, IntegerArray, IntegerArray, IntegerArray]:
    """Indices a < b of anticommuting words of a closed list, the index c of their product, and s in
    [iP_a, iP_b] = 2 s iP_c. With `chosen`, a is one of these and b any index."""
    x, z = bits(words, qubits)
    ys = (x & z).sum(axis=1)
    position = {word: i for i, word in enumerate(words)}
    rows: list[IntegerArray] = []
    entries = 0
    for a in range(len(words)) if chosen is None else chosen:
        in_time()
        left = x @ z[a]
        b = np.flatnonzero((left + z @ x[a]) & 1)
        b = b if chosen is not None else b[b > a]
        entries += len(b)
        within("entries", entries, "the bracket table has {} entries")
        c = np.array([position[words[a] ^ words[i]] for i in b.tolist()], dtype=np.int64)
        # P_a P_b = i^p P_c with an odd p, s = p mod 4 - 2, and [iP_a, iP_b] = -2 P_a P_b
        rows.append(np.array([np.full(len(b), a), b, c, (ys[a] + ys[b] - ys[c] + 2 * left[b]) % 4 - 2]))
    first, second, third, signs = np.concatenate(rows, axis=1)
    return first, second, third, signs


def bits(words: Sequence[int], qubits: int) -> tuple[IntegerArray, IntegerArray]:
    """The bits x and z of words, two integer arrays of shape (number of words, qubits)."""
    letters = [f"{word:0{2 * qubits}b}" for word in words]
    table = np.array([[int(b) for b in row] for row in letters], dtype=np.int64).reshape(len(words), 2 * qubits)
    return table[:, :qubits], table[:, qubits:]


def real_matrix(word: int, qubits: int) -> IntegerArray:
    """The real matrix of iP on (Re z_1, Im z_1, ...), shape (2N, 2N) with N = 2 to the number of qubits."""
    size = 1 << qubits
    x, z = word >> qubits, word & (size - 1)
    matrix = np.zeros((2 * size, 2 * size), dtype=np.int64)
    powers = ((1, 0), (0, 1), (-1, 0), (0, -1))  # of i
    for column in range(size):
        # i P e_b = i^(1 + x.z) (-1)^(z.b) e_(b + x)
        real, imaginary = powers[(1 + (x & z).bit_count() + 2 * (z & column).bit_count()) % 4]
        row = column ^ x
        matrix[2 * row : 2 * row + 2, 2 * column : 2 * column + 2] = ((real, -imaginary), (imaginary, real))
    return matrix


# Spin models on graphs, as lists of Pauli words: one word for each coupling and each site. An edge is a pair of
# integers from 0 on, as of `chain` or of a networkx graph.

Edges = Iterable[tuple[int, int]]


def chain(sites: int, *, periodic: bool = False) -> list[tuple[int, int]]:
    """The edges (q, q + 1) of a chain, and (sites - 1, 0) if it is periodic.

    Examples
    --------
    >>> chain(3), chain(3, periodic=True)
    ([(0, 1), (1, 2)], [(0, 1), (1, 2), (2, 0)])
    """
    if isinstance(sites, bool) or not isinstance(sites, int) or sites < (3 if periodic else 2):
        raise InputError(f"a chain has {sites!r} sites, expected an integer of at least {3 if periodic else 2}")
    return [(q, q + 1) for q in range(sites - 1)] + ([(sites - 1, 0)] if periodic else [])


def ising(edges: Edges) -> list[str]:
    """The words Z Z on each edge and X on each site: the Ising model in a transverse field.

    On an open chain of n >= 2 sites they generate so(2n), on a periodic chain of n >= 3 sites so(2n) + so(2n).

    Examples
    --------
    >>> ising(chain(2))
    ['ZZ', 'XI', 'IX']
    """
    return _words(edges, ["ZZ"], "X")


def xy(edges: Edges) -> list[str]:
    """The words X X and Y Y on each edge: the XY model.

    On an open chain of n >= 3 sites they generate so(n) + so(n).

    Examples
    --------
    >>> xy(chain(2))
    ['XX', 'YY']
    """
    return _words(edges, ["XX", "YY"])


def heisenberg(edges: Edges) -> list[str]:
    """The words X X, Y Y and Z Z on each edge: the Heisenberg model.

    On an open chain of n >= 3 sites they generate su(2^(n-1)) for odd n, and four copies of su(2^(n-2)) for even n.

    Examples
    --------
    >>> heisenberg(chain(2))
    ['XX', 'YY', 'ZZ']
    """
    return _words(edges, ["XX", "YY", "ZZ"])


def kitaev(edges: Edges) -> list[str]:
    """The words X X and Y Y on each edge and Z on each site: the Kitaev chain of fermions by Jordan and Wigner.

    On an open chain of n >= 2 sites they generate so(2n).

    Examples
    --------
    >>> kitaev(chain(2))
    ['XX', 'YY', 'ZI', 'IZ']
    """
    return _words(edges, ["XX", "YY"], "Z")


def _words(edges: Edges, couplings: list[str], field: str | None = None) -> list[str]:
    pairs = [_edge(edge) for edge in edges]
    if not pairs:
        raise InputError("the graph has no edges")
    n = 1 + max(q for pair in pairs for q in pair)
    words = [encode({a: letters[0], b: letters[1]}, n) for letters in couplings for a, b in pairs]
    words += [encode({q: field}, n) for q in range(n)] if field else []
    return [spell(word, n) for word in words]


def _edge(edge: tuple[int, int]) -> tuple[int, int]:
    try:
        a, b = (int(q) for q in edge)
    except (TypeError, ValueError):
        raise InputError(f"{edge!r} is not an edge; write a pair of site numbers such as (0, 1)") from None
    if a == b or min(a, b) < 0:
        raise InputError(f"the edge {edge!r} should join two different sites with numbers from 0 on")
    return a, b
