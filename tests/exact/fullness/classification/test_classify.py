"""`classify`: the row of every full pair, in any basis, with ideals inside h, over QQ and over number fields."""

import pickle
import random
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.exact.fullness.classification import Classification
from liehom.exact.fullness.classification_rows import Key, Row, rows
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness.classification.support import (
    classified,
    expected_key,
    over_free_nilpotent,
    over_heisenberg,
    pair_of,
    with_module,
    with_summand,
)
from tests.exact.fullness.support import over, scrambled
from tests.exact.fullness.test_number_fields import CUBIC, ROOT2, scrambled as scrambled_over
from tests.sampling import examples

DIMENSIONS = (2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16)
ROWS = [row for d in (0, 1, *DIMENSIONS) for row in rows(d)]
LARGE = 5  # from this dimension on, cases run with --slow only


def of_rows(chosen: list[Row]) -> pytest.MarkDecorator:
    marked = [pytest.param(row, marks=pytest.mark.slow if row.key.d > LARGE else (), id=row.name) for row in chosen]
    return pytest.mark.parametrize("row", marked)


every_row = of_rows(ROWS)
small_rows = of_rows([row for row in ROWS if row.key.d <= 8])
SYMPLECTIC = ("sp(", "su(", "so(2)", "gl(1,C)", "R(J+c)", "sl(2,R)", "sl(2,C)")


def has_invariant_skew_form(row: Row) -> bool:
    """Whether the traceless part of the isotropy of an affine row preserves a skew form."""
    charged = ",C)+" in row.isotropy and row.key.centre != "R"  # complex symplectic forms under u(1)
    linear = row.name.startswith("affine(") and row.isotropy.startswith(SYMPLECTIC)
    return linear and "+sp(1)" not in row.isotropy and not charged


symplectic_rows = of_rows([row for row in ROWS if has_invariant_skew_form(row)])
rows_with_modules = of_rows([row for row in ROWS if 2 <= row.key.d <= (6 if row.key.letter == "A" else 4)])


def is_found(pair: lh.Pair, row: Row, dimension: int = 0) -> None:
    """The pair has the key of the row and an ideal of this dimension; both are verified for small pairs."""
    result = classified(pair)
    assert result.key == expected_key(row)
    assert result.ideal.dimension == dimension
    if row.key.d <= 8:
        assert result.verify(pair)


@every_row
def test_every_row_is_found_in_its_own_basis(row: Row) -> None:
    pair = pair_of(row)
    result = lh.classify(pair)
    assert (result.key, result.ideal.dimension, result.row) == (expected_key(row), 0, row)
    assert result.verify(pair)


@pytest.mark.parametrize("seed", range(3))
@every_row
def test_every_row_is_found_in_a_scrambled_basis(row: Row, seed: int) -> None:
    is_found(scrambled(pair_of(row), random.Random(f"{row.name} {seed}")), row)


# -- ideals inside h ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("dimension", range(1, 7))
@every_row
def test_a_direct_summand_inside_h_leaves_the_key(row: Row, dimension: int) -> None:
    rng = random.Random(f"{row.name} {dimension}")
    is_found(scrambled(with_summand(pair_of(row), dimension, rng), rng), row, dimension)


def extension_is_found(extended: lh.Pair | None, row: Row) -> None:
    assert extended is not None
    added = extended.algebra.dimension - pair_of(row).algebra.dimension
    is_found(scrambled(extended, random.Random(row.name)), row, added)


@rows_with_modules
def test_a_module_inside_h_leaves_the_key(row: Row) -> None:
    extension_is_found(with_module(row), row)


@of_rows([row for row in ROWS if row.key.letter == "A" and 2 <= row.key.d <= 4])
def test_an_extension_by_bivectors_does_not_split_and_leaves_the_key(row: Row) -> None:
    extended, d = over_free_nilpotent(pair_of(row)), row.key.d
    bivectors = d * (d - 1) // 2
    # the brackets of V are all bivectors; an element of the radical that acts on V without kernel adds V to them
    derived = extended.algebra.radical().as_algebra().derived_subalgebra().dimension
    assert derived == bivectors + (d if row.key.centre or not row.key.s else 0)
    is_found(scrambled(extended, random.Random(row.name)), row, bivectors)


@symplectic_rows
def test_a_heisenberg_algebra_over_an_affine_pair_leaves_the_key(row: Row) -> None:
    extension_is_found(over_heisenberg(pair_of(row)), row)


# -- number fields -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("field", [ROOT2, CUBIC], ids=["sqrt(2)", "cube root of 2"])
@small_rows
def test_every_row_is_found_in_a_basis_with_irrational_entries(row: Row, field: Any) -> None:
    is_found(scrambled_over(pair_of(row), field, random.Random(row.name)), row)


FAMILIES = [row for row in ROWS if row.is_family]
ROOTS = {"sqrt(2)": (ROOT2, [0, 1]), "1 + sqrt(2)": (ROOT2, [1, 1]), "cube root of 2": (CUBIC, [0, 1])}


@pytest.mark.parametrize(("field", "coordinates"), ROOTS.values(), ids=list(ROOTS))
@of_rows(FAMILIES)
def test_spirals_with_irrational_c(row: Row, field: Any, coordinates: list[int]) -> None:
    family = next(x for x in lh.full_pairs(row.key.d) if x.name == row.name)
    c = coordinates[0] + coordinates[1] * field.generator
    pair = family.pair(c)  # type: ignore[union-attr]
    assert lh.classify(pair).key == row.key._replace(parameter=c * c)
    if row.key.d > 8:
        return
    moved = scrambled_over(pair, pair.field, random.Random(row.name))
    result = classified(moved)
    assert result.key == row.key._replace(parameter=c * c)
    assert (result.name is None) == ((c * c).rational() is None)
    assert result.name is not None or result.space.endswith(f", c^2 = {c * c}")
    assert result.verify(moved)


@pytest.mark.parametrize(("name", "square"), [
    ("affine(sl(2,Q(sqrt(-2)))+spiral(1,1))", "1/2"), ("affine(sl(3,Q(sqrt(-3)))+spiral(2,1))", "4/3"),
])  # fmt: skip
def test_spirals_over_the_rationals_with_irrational_c(name: str, square: str) -> None:
    pair = lh.pair(name)
    result = lh.classify(pair)
    assert pair.field == lh.QQ
    assert result.key.parameter == lh.QQ.convert(square)
    assert result.name is not None
    assert lh.classify(lh.pair(result.name)).key == result.key
    assert result.verify(pair)


# -- names -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", [name for name, claim in CLAIMS.items() if claim.full])
def test_the_name_denotes_the_same_row(name: str) -> None:
    result = lh.classify(lh.pair(name))
    assert result.name is not None
    assert lh.pair(result.name).name == result.name
    assert lh.classify(lh.pair(result.name)).key == result.key


@pytest.mark.parametrize("name", [name for name, claim in CLAIMS.items() if not claim.full])
def test_a_pair_that_is_not_full_raises_an_error_with_the_verdict(name: str) -> None:
    with pytest.raises(lh.NotFullError, match="not full") as caught:
        lh.classify(lh.pair(name))
    assert caught.value.verdict.full is False  # type: ignore[attr-defined]
    assert pickle.loads(pickle.dumps(caught.value)).verdict == caught.value.verdict


# -- laws --------------------------------------------------------------------------------------------------
@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([row for row in ROWS if row.key.d <= 5]), st.randoms(use_true_random=False))
def test_the_key_does_not_depend_on_the_basis(row: Row, rng: random.Random) -> None:
    pair = pair_of(row)
    assert classified(scrambled(pair, rng)).key == classified(pair).key


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([row for row in ROWS if row.key.d <= 5]), st.sampled_from([ROOT2, CUBIC]))
def test_the_key_does_not_depend_on_the_field(row: Row, field: Any) -> None:
    pair = pair_of(row)
    assert classified(over(pair, field)).key == classified(pair).key


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from([row for row in ROWS if row.key.d <= 5]), st.integers(1, 6), st.randoms(use_true_random=False))
def test_the_ideal_is_the_same_subspace_in_every_basis(row: Row, dimension: int, rng: random.Random) -> None:
    pair = with_summand(pair_of(row), dimension, rng)
    n = pair.algebra.dimension
    moved = scrambled(pair, rng)
    given_ideal, result = classified(pair).ideal, classified(moved).ideal
    assert given_ideal == lh.scalars.Subspace(
        pair.field, pair.field.identity(n).select(rows=range(n - dimension, n)), n
    )
    assert result.dimension == dimension
    assert moved.algebra.subalgebra(result.basis).is_ideal()


# -- the object --------------------------------------------------------------------------------------------
@small_rows
def test_json_and_pickle_restore_a_classification(row: Row) -> None:
    for field in (lh.QQ, ROOT2):
        result = classified(over(pair_of(row), field))
        assert Classification.from_json(result.to_json()) == result
        assert pickle.loads(pickle.dumps(result)) == result


@pytest.mark.parametrize("change", [
    {"format": "liehom-pair"}, {"version": 2}, {"key": None}, {"key": {"letter": "A"}},
    {"key": {"letter": "C", "d": 3, "s": 5, "e": 1, "centre": "", "parameter": 1}},
    {"key": {"letter": "C", "d": 3.0, "s": 3, "e": 1, "centre": "", "parameter": 1}},
    {"key": {"letter": "A", "d": 2, "s": 0, "e": 4, "centre": "J+c", "parameter": "x"}}, {"ideal": [["1"]]},
    {"dimension": "six"}, {"field": "QQ"},
], ids=str)  # fmt: skip
def test_malformed_json_raises_a_format_error(change: dict[str, Any]) -> None:
    data = lh.classify(lh.pair("so(4)/so(3)")).to_json()
    with pytest.raises(lh.FormatError):
        Classification.from_json({**data, **change})


@pytest.mark.parametrize(
    "c", ["5000", "1/5000", "sqrt(5000)", "99999999/7", "123456789123456789123/2", "sqrt(10000000000000000019)"]
)
def test_a_name_is_given_only_if_it_can_be_read(c: str) -> None:
    (family,) = (x for x in lh.full_pairs(2) if not isinstance(x, lh.Pair))
    pair = family.pair(c)
    result = lh.classify(pair)
    assert result.verify(pair)
    assert (result.name is None) == (len(c) > 18)
    if result.name is not None:
        assert lh.classify(lh.pair(result.name)).key == result.key


MALFORMED = [("key", part, value) for part in Key._fields for value in ([], {}, float("nan"), "x", 10**400, -2)]
MALFORMED += [("dimension", value) for value in (None, True, 1.5, float("nan"), float("inf"), -1, 10**400, "3", [])]
MALFORMED += [("ideal", value) for value in (None, 1, "x", [1], [["1", "x", "0"]], [["1"]])]
MALFORMED += [("name", "so(3)/so(2)"), ("space", "a point"), ("isotropy", 1), ("field", "x"), ("key", None)]


@pytest.mark.parametrize("change", MALFORMED, ids=lambda change: " ".join(map(str, change))[:40])
def test_a_changed_part_is_an_error_of_the_format(change: tuple[Any, ...]) -> None:
    data: Any = lh.classify(lh.pair("affine(spiral(2,3))")).to_json()
    *path, last, value = change
    part = data[path[0]] if path else data
    part[last] = value
    with pytest.raises(lh.FormatError):
        Classification.from_json(data)


@pytest.mark.parametrize("part", ["key", "name", "space", "isotropy", "dimension", "ideal"])
def test_a_missing_part_is_named(part: str) -> None:
    data = lh.classify(lh.pair("so(4)/u(2)")).to_json()
    del data[part]
    with pytest.raises(lh.FormatError, match=f"'{part}' is missing"):
        Classification.from_json(data)


def test_a_given_verdict_spares_the_decision(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = lh.pair("so(4)/so(3)")
    verdict = lh.decide_fullness(pair)
    monkeypatch.setattr("liehom.exact.fullness.decide.decide_fullness", None)
    assert lh.classify(pair, verdict).name == "so(4)/so(3)"
    with pytest.raises(lh.InputError, match="different pair"):
        lh.classify(lh.pair("so(5)/so(4)"), verdict)


def test_numerical_pairs_and_other_objects_are_rejected() -> None:
    pair = lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]])
    with pytest.raises(lh.UndecidedError, match="rationalize"):
        lh.classify(pair)
    with pytest.raises(lh.InputError, match=r"liehom\.pair"):
        lh.classify("so(4)/so(3)")  # type: ignore[arg-type]


def test_a_key_in_no_row_is_reported_as_a_counterexample(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = lh.pair("so(4)/so(3)")
    key = Key("C", 3, 5, 1, "", 1)
    monkeypatch.setattr("liehom.exact.fullness.decide.key_of", lambda action: (key, pair.subalgebra))
    with pytest.raises(lh.errors.InternalError, match="counterexample to the theorem"):
        lh.classify(pair)


# -- verification ------------------------------------------------------------------------------------------
WRONG = {"letter": "B", "d": 4, "s": 2, "e": 2, "centre": "R", "parameter": -1}


@pytest.mark.parametrize("change", [
    *({part: v} for part, v in zip(Key._fields, ("B", 4, 2, 2, "R", -1), strict=True)),
    {"letter": "A", "parameter": None},
], ids=str)  # fmt: skip
def test_a_wrong_key_is_not_verified(change: dict[str, Any]) -> None:
    pair = lh.pair("so(4)/so(3)")
    result = lh.classify(pair)
    with pytest.raises(lh.CertificateError):
        replace(result, key=result.key._replace(**change)).verify(pair)


@small_rows
def test_the_key_of_another_row_is_not_verified(row: Row) -> None:
    pair = pair_of(row)
    result = classified(pair)
    for other in rows(row.key.d):
        if other != row:
            with pytest.raises(lh.CertificateError):
                replace(result, key=expected_key(other)).verify(pair)


def test_another_c_is_not_verified() -> None:
    pair = lh.pair("affine(su(3)+spiral(2/3,1))")
    result = lh.classify(pair)
    with pytest.raises(lh.CertificateError, match="parameter"):
        replace(result, key=result.key._replace(parameter=lh.QQ.convert("4/8"))).verify(pair)


def test_a_wrong_ideal_is_not_verified() -> None:
    pair = lh.pair("so(4)/u(2)")
    result = lh.classify(pair)
    for basis in (result.ideal.basis.select(rows=[0]), pair.subalgebra.basis, pair.field.zeros(0, 6)):
        with pytest.raises(lh.CertificateError, match="ideal"):
            replace(result, ideal=lh.scalars.Subspace(pair.field, basis, 6)).verify(pair)
