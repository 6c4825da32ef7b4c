"""Pauli words, and sums of words with real coefficients, from strings.

A word on n qubits is the Hermitian matrix P(x, z) = i^(x . z) X^x Z^z with bit vectors x and z. It is stored as one
integer ``x << n | z``. Bit n - 1 - q of x and of z belongs to qubit q, so that integers sort as bit strings.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias, final

from liehom.algebra.core.tables import field_of_values
from liehom.errors import FieldError, InputError, ParseError, shown
from liehom.scalars import Field, Scalar
from liehom.scalars.fields import grammar
from liehom.typing import ScalarLike

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
    """Hamiltonians from their strings, over the smallest field that contains their coefficients.

    Parameters
    ----------
    hamiltonians : iterable of Hamiltonian
    qubits : int, optional
        Number of qubits; by default the smallest number that the words show.

    Raises
    ------
    ParseError
        If a string is not a sum of words; names the Hamiltonian and the part.
    InputError
        If words do not fit the number of qubits, or a Hamiltonian is zero.
    FieldError
        If a coefficient is a float or not real.

    Examples
    --------
    >>> read_sums(["ZZ", "X(0) + 1/2 * X(1)"]).terms
    ({3: 1}, {8: 1, 4: 1/2})
    """
    if isinstance(hamiltonians, (str, Mapping)):
        raise InputError(f"a list of Hamiltonians was expected, got {shown(repr(hamiltonians))}; write [...] around it")
    given = [_terms(h, i) for i, h in enumerate(hamiltonians)]
    if not given:
        raise InputError("no Hamiltonian was given; the number of qubits would be unknown")
    n = _qubits(given, qubits)
    field = field_of_values(c for terms in given for _, _, c in terms)
    sums = []
    for i, terms in enumerate(given):
        total: dict[int, Scalar] = {}
        for factors, _, coefficient in terms:
            word = encode(factors, n)
            total[word] = total.get(word, field.zero) + field.convert(coefficient)
        total = {word: c for word, c in total.items() if c != 0}
        if not total:
            raise InputError(f"Hamiltonian {i} is zero; leave it out")
        sums.append(total)
    return PauliSums(n, field, tuple(sums))


def encode(factors: Factors, qubits: int) -> int:
    """The integer of the word with these letters.

    Examples
    --------
    >>> encode({0: "Z", 1: "Z"}, 3), encode({0: "X"}, 3)
    (6, 32)
    """
    x = z = 0
    for qubit, letter in factors.items():
        bit = 1 << (qubits - 1 - qubit)
        x |= BITS[letter][0] * bit
        z |= BITS[letter][1] * bit
    return x << qubits | z


def spell(word: int, qubits: int) -> str:
    """The letters of a word, qubit 0 first.

    Examples
    --------
    >>> spell(encode({0: "X", 2: "Y"}, 3), 3)
    'XIY'
    """
    x, z = word >> qubits, word & ((1 << qubits) - 1)
    return "".join("IZXY"[2 * (x >> b & 1) + (z >> b & 1)] for b in reversed(range(qubits)))


Term: TypeAlias = tuple[Factors, int | None, ScalarLike]  # letters, length of a spelled word, coefficient


def _terms(hamiltonian: Hamiltonian, index: int) -> list[Term]:
    if isinstance(hamiltonian, str):
        return [_term(sign, text, index) for sign, text in _signed(hamiltonian, index)]
    pairs: Iterable[tuple[str, ScalarLike]]
    pairs = hamiltonian.items() if isinstance(hamiltonian, Mapping) else hamiltonian
    terms: list[Term] = []
    try:
        for word, coefficient in pairs:
            factors, length = _word(word, index)
            terms.append((factors, length, _real(coefficient, index)))
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
    if isinstance(coefficient, str):
        return _exact(coefficient)
    return coefficient


def _exact(text: str) -> ScalarLike:
    """A decimal string as the fraction that it spells; any other string unchanged, for the grammar of values."""
    return Fraction(text) if DECIMAL.fullmatch(text.strip()) else text


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
    found = False
    for part in _parts(text):
        try:
            more, spelled = _word(part, index)
        except ParseError:
            if FACTOR.match(part):
                raise
            coefficients.append(part)
            continue
        clash = sorted(set(more) & set(factors))
        if clash or (found and None in (spelled, length) and spelled != length) or (found and spelled is not None):
            raise ParseError(
                f"the term {shown(text)!r} of Hamiltonian {index} has several words"
                + (f" or two letters at qubit {clash[0]}" if clash else "")
                + "; write one word such as 'XZI', or factors such as 'X(0) @ Z(1)', in each term"
            )
        factors |= more
        length, found = spelled, True
    if not found:
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
    parts, depth, begin, at = [], 0, 0, 0
    while at < len(joined):
        letter = joined[at]
        depth += (letter == "(") - (letter == ")")
        if joined.startswith("**", at):
            at += 2
            continue
        if depth == 0 and letter in "*@ \t\n":
            parts.append(joined[begin:at])
            begin = at + 1
        at += 1
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


def _qubits(given: Sequence[Sequence[Term]], qubits: int | None) -> int:
    lengths = {length: i for i, terms in enumerate(given) for _, length, _ in terms if length is not None}
    if len(lengths) > 1:
        (a, i), (b, j) = sorted(lengths.items())[:2]
        raise InputError(f"the words have different lengths: {a} in Hamiltonian {i}, {b} in Hamiltonian {j}")
    last = max((q for terms in given for factors, _, _ in terms for q in factors), default=0)
    n = qubits if qubits is not None else next(iter(lengths), last + 1)
    if isinstance(n, bool) or not isinstance(n, int) or n < 1:
        raise InputError(f"the number of qubits is {n!r}, expected a positive integer")
    if last >= n or any(length != n for length in lengths):
        wide = max(last + 1, *lengths, 1) if lengths else last + 1
        raise InputError(f"the words act on {wide} qubits, not on {n}")
    return n
