"""Simple ideals by a Cartan subalgebra modulo a prime: against the generic structure theory and known algebras."""

import functools
import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings

import liehom as lh
from liehom.exact.pauli import simple_ideals
from liehom.exact.pauli.span import WordSpan
from tests.exact.pauli.test_closure import matrix
from tests.exact.pauli.test_span import neighbours, span_of, sums_of
from tests.sampling import examples


def of_matrix(hermitian: np.ndarray) -> dict[str, Fraction]:
    """The sum of words that is equal to a Hermitian matrix."""
    size = len(hermitian)
    letters = itertools.product("IXYZ", repeat=size.bit_length() - 1)
    terms = {word: np.trace(matrix(word) @ hermitian).real / size for word in map("".join, letters)}
    return {word: Fraction(c).limit_denominator(1000) for word, c in terms.items() if abs(c) > 1e-9}


def unit(size: int, i: int, j: int) -> np.ndarray:
    return np.outer(np.eye(size)[i], np.eye(size)[j])


def rotations(k: int, size: int) -> list[dict[str, Fraction]]:
    """Generators of so(k) on the first k of `size` states."""
    return [of_matrix(1j * (unit(size, i, i + 1) - unit(size, i + 1, i))) for i in range(k - 1)]


def symplectic(k: int, size: int) -> list[dict[str, Fraction]]:
    """Generators of sp(k) on the first 2k of `size` states."""
    real = [unit(size, i, k + i) + unit(size, k + i, i) for i in range(k)]
    real += [unit(size, i, i) - unit(size, k + i, k + i) for i in range(k)]
    steps = [(i, i + 1) for i in range(k - 1)]
    real += [
        unit(size, i, j) + unit(size, j, i) - unit(size, k + i, k + j) - unit(size, k + j, k + i) for i, j in steps
    ]
    return [of_matrix(a.astype(complex)) for a in real]


def lines(closure: lh.pauli.DynamicalLieAlgebra) -> list[str]:
    return [line.strip() for line in closure.describe().splitlines()[1:]]


def generic(closure: lh.pauli.DynamicalLieAlgebra) -> list[str]:
    return [line.strip() for line in closure.algebra.describe().splitlines()[1:]]


@pytest.mark.parametrize("coefficients", [["1", "-1", "2"], ["1", "sqrt(2)"]])
def test_summary_is_that_of_the_structure_theory(coefficients: list[str]) -> None:
    @given(sums_of(coefficients))
    @settings(max_examples=examples(20), deadline=None)
    def check(sums: list[list[tuple[str, str]]]) -> None:
        closure = lh.pauli.closure(sums)
        if not closure.spanned_by_words and closure.dimension <= 30:
            assert lines(closure) == generic(closure)

    check()


@pytest.mark.parametrize("words", [
    ["ZZ", "X"], ["ZZ", "X", "Z"], ["XX", "Z"], ["XX", "YY"], ["XY", "ZZ"], ["XX", "ZZ", "Y"], ["XY"], ["ZZ"],
])  # fmt: skip
def test_summary_of_translation_sums_is_that_of_the_structure_theory(words: list[str]) -> None:
    for n in (2, 3):
        closure = lh.pauli.closure([neighbours(word, n) for word in words])
        assert lines(closure) == generic(closure) or closure.spanned_by_words


@pytest.mark.parametrize(("sums", "name"), [
    (rotations(5, 8), "so(5)"), (rotations(6, 8), "su(4)"), (rotations(7, 8), "so(7)"), (symplectic(3, 8), "sp(3)"),
    (rotations(9, 16), "so(9)"), (symplectic(4, 16), "sp(4)"), (rotations(13, 16), "so(13)"),
    (symplectic(6, 16), "sp(6)"), (rotations(14, 16), "so(14)"), (rotations(3, 4), "so(3)"),
    ([neighbours(word, 4) for word in ("ZZ", "X", "Z")], "su(6) + su(10)"),
], ids=lambda value: value if isinstance(value, str) else "")  # fmt: skip
def test_names_of_known_algebras(sums: list[dict[str, Fraction] | str], name: str) -> None:
    assert f"real form {name}, rank" in lh.pauli.closure(sums).describe()


def test_ideals_that_are_conjugate_over_the_rationals_are_separated() -> None:
    # the momenta of a ring of four sites: QQ(sqrt(2)) is the centroid of two of the three ideals
    ring = lh.pauli.closure(["ZZII + IZZI + IIZZ + ZIIZ", "XIII + IXII + IIXI + IIIX"])
    assert "real form so(3) + so(3) + so(3), rank" in ring.describe() and ring.dimension == 11
    assert ideals_modulo(span_of(ring), span_of(ring).basis(derived=True), 4194301) is None  # 2 is no square
    levi = ring.algebra.levi_decomposition().levi.as_algebra()
    assert sorted(ideal.dimension for ideal in levi.direct_sum_decomposition()) == [3, 6]
    assert lines(ring) == generic(ring)


@pytest.mark.parametrize("sums", [["ZZ", "XI + IX", "ZI + IZ"], [neighbours("ZZ", 3), neighbours("X", 3), "YYY"]])
def test_a_small_prime_gives_the_right_ideals_or_none(sums: list[str]) -> None:
    span = span_of(lh.pauli.closure(sums))
    derived = span.basis(derived=True)
    assert derived is not None
    right = sorted(ideal[:2] for ideal in ideals_modulo(span, derived, 4194301) or [])
    assert right
    answers = [
        ideals_modulo(span, derived, p) for p in (3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 101, 103) if derived.den % p
    ]
    assert None in answers
    assert all(sorted(ideal[:2] for ideal in ideals) == right for ideals in answers if ideals is not None)


def ideals_modulo(span: WordSpan, derived: object, p: int) -> list[tuple[int, int, int]] | None:
    return simple_ideals._Reduction(span, derived.modulo(p, 0), p, 0).ideals()  # type: ignore[attr-defined]


def test_the_dynkin_index_excludes_a_type() -> None:
    p = 4194301
    inverse = functools.partial(pow, exp=-1, mod=p)
    # the index of the vector representation of so(7) is 2 of 10, that of sp(3) 1 of 8
    assert simple_ideals._types((21, 3, 2 * inverse(10) % p), 3, p) == ["B3"]
    assert simple_ideals._types((21, 3, inverse(8)), 3, p) == ["C3"]
    # five copies of C^6 have the index 5 for sp(3), and 25/4 for so(7)
    assert simple_ideals._types((21, 3, 5 * inverse(8) % p), 5, p) == ["C3"]
    assert simple_ideals._types((21, 3, 1), 5, p) == ["B3", "C3"]  # four copies of the adjoint representation
    assert simple_ideals._types((8, 2, 17), 3, p) == ["A2"]


def test_the_trace_form_of_rotations_is_a_known_part_of_the_killing_form() -> None:
    p = 4194301
    for n, size in ((5, 8), (7, 8), (9, 16)):
        span = span_of(lh.pauli.closure(rotations(n, size)))
        ideal = n * (n - 1) // 2, n // 2, pow(n - 2, -1, p)
        assert ideals_modulo(span, span.basis(derived=True), p) == [ideal]


def test_an_open_type_is_left_to_the_structure_theory(monkeypatch: pytest.MonkeyPatch) -> None:
    closure = lh.pauli.closure(rotations(7, 8))
    with_index = closure.describe()
    monkeypatch.setattr(simple_ideals, "_types", lambda *_: ["B3", "C3"])
    assert closure.describe() == with_index
    monkeypatch.setattr(simple_ideals._Reduction, "ideals", lambda _: None)
    assert closure.describe() == with_index
