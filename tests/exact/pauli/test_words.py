"""Strings of Pauli words and sums to integers, and what is refused."""

import contextlib
import random
from fractions import Fraction

import pytest
from hypothesis import given, settings, strategies as st

from liehom.base.errors import FieldError, InputError, LiehomError, ParseError
from liehom.exact.pauli.dynamical import _anticommute, _arf_invariant
from liehom.exact.pauli.words import encode, read_sums, spell
from tests.sampling import examples

WORDS = st.integers(1, 6).flatmap(lambda n: st.text("IXYZ", min_size=n, max_size=n))


@given(WORDS)
@settings(max_examples=examples(100), deadline=None)
def test_spelling_inverts_encoding(word: str) -> None:
    factors = {q: letter for q, letter in enumerate(word) if letter != "I"}
    assert spell(encode(factors, len(word)), len(word)) == word


@pytest.mark.parametrize("written", [
    "XIZ + 1/2 * IYI", "X(0) @ Z(2) + 0.5 * Y(1)", "X0 Z2 + 1/2*Y1", "1.0 * X(0) @ Z(2)\n+ 0.5 * Y(1)", "1/2 IYI + XIZ",
    "Z2*X0 + Y1*1/2", {"XIZ": 1, "IYI": "1/2"}, {"X(0) @ Z(2)": 1, "Y1": Fraction(1, 2)}, [("XIZ", 1), ("IYI", "0.5")],
    "- -XIZ - -(1/2)*IYI", "IYI + XIZ - 1/2*IYI",
])  # fmt: skip
def test_all_spellings_of_a_sum_are_equal(written: object) -> None:
    expected = read_sums([{"XIZ": 1, "IYI": Fraction(1, 2)}])
    sums = read_sums([written])  # type: ignore[list-item]
    assert sums.qubits == 3 and sums.terms == expected.terms


def test_coefficients_keep_their_field() -> None:
    sums = read_sums(["XX + sqrt(2)/2 * YY", "ZI"])
    assert sums.field.name == "QQ(sqrt(2))" and sums.terms[0][encode({0: "Y", 1: "Y"}, 2)] ** 2 == Fraction(1, 2)


@pytest.mark.parametrize(("given_", "error", "message"), [
    ([], InputError, "no Hamiltonian"), ("XX", InputError, "a list of Hamiltonians"), ([""], ParseError, "is empty"),
    (["XX +"], ParseError, "ends before a word"), (["XX + (1/2 * YY"], ParseError, "parentheses"),
    (["XQ"], ParseError, "no Pauli word"), (["2"], ParseError, "no Pauli word"),
    (["XX YY"], ParseError, "several words"), (["X0 Y0"], ParseError, "two letters at qubit 0"),
    (["XX", "XXX"], InputError, "different lengths: 2 in Hamiltonian 0, 3 in Hamiltonian 1"),
    (["XX", "X(5)"], InputError, "6 qubits, not on 2"), (["XX - XX"], InputError, "Hamiltonian 0 is zero"),
    ([{"XX": 0.5}], FieldError, "not exact"), ([{"XX": 1j}], FieldError, "not exact"),
    ([{"XX": "1j"}], ParseError, "1j"), ([{}], InputError, "no terms"), ([3], InputError, "expected a string"),
    ([[("XX",)]], InputError, "expected a string"), ([{3: 1}], InputError, "expected a string"),
    ([{"XX": None}], FieldError, "not a number"), ([{"XX": True}], FieldError, "not a number"),
    (["X(9999999)"], ParseError, "too large"),
    (["1e400*X"], ParseError, "the coefficient '1e400' of Hamiltonian 0 is not a number"),
])  # fmt: skip
def test_bad_hamiltonians_name_the_fault(given_: object, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        read_sums(given_)  # type: ignore[arg-type]


def test_numbers_of_qubits_that_do_not_fit_are_refused() -> None:
    for qubits in (0, -1, True, 1.5, 1):
        with pytest.raises(InputError):
            read_sums(["XX"], qubits)  # type: ignore[arg-type]
    assert read_sums(["X(1)"], 4).qubits == 4
    with pytest.raises(InputError, match="act on 6 qubits, not on 3"):
        read_sums(["X(5)"], 3)


@given(st.text("IXYZ0123456789()+-*/@. sqrt", max_size=20))
@settings(max_examples=examples(300), deadline=None)
def test_any_string_is_read_or_refused_by_an_error_of_the_library(text: str) -> None:
    with contextlib.suppress(LiehomError):
        read_sums([text])


@pytest.mark.parametrize("qubits", [1, 2, 3])
@pytest.mark.parametrize("seed", range(12))
def test_the_arf_invariant_is_the_value_of_most_words(qubits: int, seed: int) -> None:
    """A quadratic form q with q = 1 on a basis of all words of n qubits has 2^(n-1) (2^n -+ 1) ones."""
    rng, count = random.Random(seed), 2 * qubits
    basis: list[int] = []
    spanned = {0: 0}  # word -> q
    while len(basis) < count:
        word = rng.randrange(1, 1 << count)
        if word not in spanned:
            basis.append(word)
            spanned |= {w ^ word: q ^ 1 ^ _anticommute(w, word, qubits) for w, q in spanned.items()}
    ones = sum(spanned.values())
    assert _arf_invariant(basis, basis, [], qubits) == (ones > len(spanned) / 2)
    assert ones in {(1 << qubits - 1) * ((1 << qubits) + sign) for sign in (1, -1)}
