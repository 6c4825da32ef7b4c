"""Canonical names: coincidences in low dimensions, other spellings, what is refused."""

import pytest
from hypothesis import assume, given, settings, strategies as st

import liehom as lh
from liehom.exact.algebra.roots.real_form import RealForm, _sort_key, canonical_real_form, complex_form, real_forms
from tests.sampling import examples

COINCIDENCES = {
    "so(3)": "so(3) | su(2) | sp(1) | sl(1,H) | spin(3) | su*(2)",
    "sl(2,R)": "sl(2) | sl(2,R) | su(1,1) | sp(2,R) | so(2,1) | so(1,2) | spin(2,1)",
    "sl(2,C)": "so(3,C) | sp(2,C) | so(3,1) | so(1,3) | sl(2, C)", "so(3) + so(3)": "so(4) | so(0,4) | su(2) + sp(1)",
    "sl(2,R) + sl(2,R)": "so(2,2) | su(1,1)+sl(2)", "so(3) + sl(2,R)": "so*(4) | su(2)+su(1,1)",
    "sl(2,C) + sl(2,C)": "so(4,C) | so(3,1) + so(3,C)", "so(5)": "sp(2) | so(5) | so(0,5)",
    "so(4,1)": "sp(1,1) | so(1,4)", "so(3,2)": "sp(4,R) | so(2,3)", "so(5,C)": "sp(4,C)", "su(4)": "so(6) | spin(6)",
    "sl(2,H)": "so(5,1) | su*(4) | so(1,5)", "su(2,2)": "so(4,2) | so(2,4)", "sl(4,R)": "so(3,3) | sl(4)",
    "su(3,1)": "so*(6) | su(1,3)", "sl(4,C)": "so(6,C)", "so(6,2)": "so*(8) | so(2,6)", "sp(2,1)": "sp(1,2)",
    "so*(10)": "so*(10)", "sl(3,H)": "su*(6)", "e6": "e6(-78)", "e7": "e7(-133)", "e8": "e8(-248)", "f4": "f4(-52)",
    "g2": "g2(-14)", "g2(2)": "g2 (2)", "e6(C)": "e6(C)",
}  # fmt: skip


@pytest.mark.parametrize(
    ("canonical", "name"), [(c, n) for c, names in COINCIDENCES.items() for n in names.split(" | ")]
)
def test_low_dimensional_isomorphisms_have_one_name(canonical, name):
    assert canonical_real_form(name) == canonical


def test_sums_are_sorted():
    assert canonical_real_form("su(3)+ e6(2) + so(2,2)") == "sl(2,R) + sl(2,R) + su(3) + e6(2)"


@pytest.mark.parametrize(
    "type_name", ["A1", "A2", "A5", "B2", "B3", "C3", "C4", "D4", "D5", "E6", "E7", "E8", "F4", "G2"]
)
def test_listed_names_are_canonical(type_name):
    for form in [*real_forms(type_name), complex_form(type_name)]:
        assert canonical_real_form(form.name) == form.name


def invariants(name):
    """Dimension, dimension of k and real rank of a semisimple algebra by its name."""
    forms = [RealForm.of_name(part) for part in canonical_real_form(name).split(" + ")]
    return tuple(map(sum, zip(*((f.dimension, f.compact_dimension, f.real_rank) for f in forms), strict=True)))


SIZES = st.integers(0, 7)


@settings(deadline=None, max_examples=examples(40))
@given(SIZES, SIZES)
def test_pseudo_orthogonal_names_keep_dimension_character_and_rank(p, q):
    assume(p + q >= 3)
    n = p + q
    k = (p * (p - 1) + q * (q - 1)) // 2
    assert invariants(f"so({p},{q})") == (n * (n - 1) // 2, k, min(p, q))


@settings(deadline=None, max_examples=examples(12))
@given(SIZES, SIZES)
def test_other_names_keep_dimension_character_and_rank(p, q):
    n = p + q
    assume(n >= 2)
    assert invariants(f"su({p},{q})") == (n * n - 1, p * p + q * q - 1, min(p, q))
    assert invariants(f"sp({p},{q})") == (n * (2 * n + 1), p * (2 * p + 1) + q * (2 * q + 1), min(p, q))
    assert invariants(f"sl({n})") == (n * n - 1, n * (n - 1) // 2, n - 1)
    assert invariants(f"sl({n},H)") == (4 * n * n - 1, n * (2 * n + 1), n - 1)
    assert invariants(f"sl({n},C)") == (2 * n * n - 2, n * n - 1, n - 1)
    assert invariants(f"sp({2 * n},R)") == (n * (2 * n + 1), n * n, n)
    assert invariants(f"sp({2 * n},C)") == (2 * n * (2 * n + 1), n * (2 * n + 1), n)
    assert invariants(f"so*({2 * n})") == (n * (2 * n - 1), n * n, n // 2)
    if n > 2:
        assert invariants(f"so({n},C)") == (n * (n - 1), n * (n - 1) // 2, n // 2)


NOT_SEMISIMPLE = "so(2)|so(1,1)|so(2,C)|so(1)|sl(1)|sl(1,C)|su(1)|so*(2)|sp(0)|so(0)|u(3)|gl(2)|R"


@pytest.mark.parametrize("name", NOT_SEMISIMPLE.split("|"))
def test_name_of_an_algebra_that_is_not_semisimple_raises_catalog_error(name):
    with pytest.raises(lh.errors.CatalogError, match="known"):
        canonical_real_form(name)


NO_NAMES = (
    "|so|so()|so(3,2,1)|so(-3)|so(3,H)|su(2,R)|su(2,C)|sl(2,2)|sp(3,R)|sp(5,C)|so*(7)|su*(3)|e6(3)|e9|e8(-78)|g2(C|"
    "so(3)+|so(3) - so(3)|E6|so(३)|sl(2,O)|e7(H)"
)


@pytest.mark.parametrize("name", NO_NAMES.split("|"))
def test_invalid_name_raises_catalog_error(name):
    with pytest.raises(lh.errors.CatalogError, match=r"known: sl\(n,R\)"):
        canonical_real_form(name)


def test_large_names_cost_nothing():
    assert canonical_real_form("so(1000,2000)") == "so(2000,1000)"


@pytest.mark.parametrize(
    "type_name", ["A1", "A2", "A3", "B2", "B3", "C3", "C4", "D4", "D5", "G2", "F4", "E6", "E7", "E8"]
)
def test_sums_are_sorted_by_the_dimension_of_the_real_form(type_name: str) -> None:
    for form in [*real_forms(type_name), complex_form(type_name)]:
        assert _sort_key(form.name)[:2] == (form.dimension, not form.is_compact)


def test_compact_ideals_come_first() -> None:
    assert canonical_real_form("so(4,1)+sl(2,R)+so(3)") == "so(3) + sl(2,R) + so(4,1)"
