"""Closures of sums by primes and lifts: against exact ones, with unlucky primes, large numbers, wrong proposals."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import LimitError
from liehom.exact.pauli.span import LiftedRows, WordSpan
from tests.clock import seconds
from tests.sampling import examples

UNLUCKY = 4194301  # the largest prime below 2^22, the first that is tried


def neighbours(word: str, n: int) -> str:
    return " + ".join("I" * i + word + "I" * (n - len(word) - i) for i in range(n - len(word) + 1))


def span_of(closure: lh.pauli.DynamicalLieAlgebra) -> WordSpan:
    return WordSpan(closure.sums, closure._integers)


def sums_of(coefficients: list[str]) -> st.SearchStrategy[list[list[tuple[str, str]]]]:
    words = st.lists(st.text("IXYZ", min_size=3, max_size=3), min_size=2, max_size=6, unique=True)
    return words.flatmap(
        lambda pool: st.lists(
            st.lists(
                st.tuples(st.sampled_from(pool), st.sampled_from(coefficients)),
                min_size=1,
                max_size=4,
                unique_by=lambda term: term[0],
            ),
            min_size=1,
            max_size=3,
        )
    )


@pytest.mark.parametrize("coefficients", [["1", "-1", "2"], ["1/2", "-7/3", "5"], ["1", "sqrt(2)", "1-sqrt(2)/3"]])
def test_closure_equals_the_exact_one(coefficients: list[str]) -> None:
    @given(sums_of(coefficients))
    @settings(max_examples=examples(15), deadline=None)
    def check(sums: list[list[tuple[str, str]]]) -> None:
        closure = lh.pauli.closure(sums)
        rows = [closure._row(terms) for terms in closure.sums.terms]
        exact = closure.word_algebra.subalgebra_generated_by(rows)
        assert exact == closure.subalgebra and exact.dimension == closure.dimension
        assert closure.spanned_by_words == (exact.dimension == len(closure.words))

    check()


@pytest.mark.parametrize("extra", ["", " + 1/64*ZIZI + 1/64*IZIZ"])
def test_sums_on_four_qubits_that_generate_all_words(extra: str) -> None:
    sums = [neighbours("ZZ", 4) + extra, neighbours("X", 4), " + ".join(f"{i + 1}*Z({i})" for i in range(4))]
    assert lh.pauli.closure(sums).name == "su(16)"
    assert seconds(lambda: lh.pauli.closure(sums).describe(), tries=2) < 5


def test_sums_that_a_reflection_preserves_generate_two_blocks() -> None:
    closure = lh.pauli.closure([neighbours(word, 4) for word in ("ZZ", "X", "Z")])
    assert (closure.dimension, len(closure.words)) == (99 + 35 + 1, 255)
    rows = closure.subalgebra.basis
    assert rows.rank() == 135 and not closure.spanned_by_words


@pytest.mark.parametrize(("sums", "dimension"), [
    (["X", f"X + {UNLUCKY}*Z"], 3), (["XI + IX", f"XI + IX + {UNLUCKY}*ZI + {UNLUCKY}*IZ"], 3),
    ([f"{UNLUCKY}*XX + YY", "YY", "ZI"], 6), (["XI + IX", f"sqrt(2)*XI + sqrt(2)*IX + {UNLUCKY}*ZI + {UNLUCKY}*IZ"], 3),
])  # fmt: skip
def test_a_prime_that_divides_coefficients_does_not_change_the_answer(sums: list[str], dimension: int) -> None:
    closure = lh.pauli.closure(sums)
    assert closure.dimension == dimension and closure.spanned_by_words == (dimension == len(closure.words))
    assert len(closure.subalgebra.rows()) == dimension


@pytest.mark.parametrize("number", ["1000003", "12345678901/9876543217", "1/3**40", "sqrt(2)*10**9+1/7"])
def test_large_numbers_take_more_primes(number: str) -> None:
    closure = lh.pauli.closure([{"XI": 1, "IX": number}, {"ZI": 1, "IZ": number}])
    rows = [closure._row(terms) for terms in closure.sums.terms]
    assert closure.subalgebra == closure.word_algebra.subalgebra_generated_by(rows)
    (single,) = lh.pauli.closure([{"XX": 1, "ZZ": number}]).subalgebra.rows()
    assert single == [1, closure.word_algebra.field.convert(number)]


def test_derived_algebra_is_that_of_the_exact_one() -> None:
    for sums in (["XX + YY", "ZI"], ["XX + YY + ZZ", "ZI + IZ"], ["XX + 2*ZZ", "XI + sqrt(3)*IX"], ["XX + ZZ"]):
        closure = lh.pauli.closure(sums)
        basis = span_of(closure).basis(derived=True)
        assert basis is not None
        inside = closure.subalgebra
        exact = [closure.algebra.field.matrix([r]) @ inside.basis for r in closure.algebra.derived_series()[-1].rows()]
        assert len(basis.pivots) == len(exact)
        if exact:
            rows = inside.algebra.field.stack_rows(exact, len(closure.words))
            assert inside.algebra.subalgebra(basis.matrix()) == inside.algebra.subalgebra(rows)


def test_wrong_proposals_are_refused() -> None:
    closure = lh.pauli.closure(["ZZI + IZZ", "XII + IXI + IIX"])
    span = span_of(closure)
    rows = span.basis()
    assert rows is not None and span._is_closed(rows, derived=False)
    other = [x + (x != 0) for x in rows.numerators]  # another space
    assert not span._is_closed(dataclasses.replace(rows, numerators=other), derived=False)
    scaled = [x + 4194301 * rows.den for x in rows.numerators]  # the same modulo the first prime
    assert not span._is_closed(dataclasses.replace(rows, numerators=scaled), derived=False)
    assert not span._is_closed(of_words(span, ["ZZI", "IZZ", "XII", "IXI", "IIX"], closure), derived=False)
    assert not span._is_closed(of_words(span, ["ZZI", "IZZ"], closure), derived=False)  # without a generator
    assert span._is_closed(of_words(span, list(closure.words), closure), derived=False)


def of_words(span: WordSpan, words: list[str], closure: lh.pauli.DynamicalLieAlgebra) -> LiftedRows:
    """The echelon rows of the span of words."""
    pivots = sorted(closure.words.index(word) for word in words)
    free = sorted(set(range(span.size)) - set(pivots))
    return LiftedRows(span.field, pivots, free, [0], 1, np.zeros((1, len(pivots), len(free)), dtype=np.int64))


def test_seconds_end_a_closure_on_six_qubits() -> None:
    closure = lh.pauli.closure([neighbours("ZZ", 6), neighbours("X", 6), "6*ZIIIII + IIIZII"])
    with lh.limits(seconds=0.2), pytest.raises(LimitError, match=r"the limit is 0\.2"):
        _ = closure.dimension
    with lh.limits(seconds=0), pytest.raises(LimitError, match="seconds"):
        lh.pauli.closure([neighbours("ZZ", 3), neighbours("X", 3)])
