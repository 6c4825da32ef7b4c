"""`full_pairs`: the rows of the classification by dimension, with distinct keys, and the families of spirals."""

import pytest

import liehom as lh
from liehom.exact.catalog.pairs import SpiralFamily
from liehom.exact.fullness.classification_rows import rows

COUNTS = {0: 1, 1: 3, 2: 9, 3: 8, 4: 23, 5: 8, 6: 24, 7: 11, 8: 47, 9: 8, 10: 23, 12: 45, 16: 52}


@pytest.mark.parametrize(("d", "count"), COUNTS.items())
def test_number_of_rows(d: int, count: int) -> None:
    assert len(rows(d)) == count


@pytest.mark.parametrize("d", [0, 1, 2, 3, 4, 5, 6, 7])
def test_every_row_is_a_pair_with_its_name_or_a_family(d: int) -> None:
    for pair, row in zip(lh.full_pairs(d), rows(d), strict=True):
        assert pair.name == row.name
        assert isinstance(pair, SpiralFamily) == row.is_family
        if isinstance(pair, lh.Pair):
            assert (pair.dimension, pair) == (d, lh.pair(row.name))


def test_keys_and_names_are_distinct() -> None:
    for d in range(121):
        assert len({row.key for row in rows(d)}) == len(rows(d))
        assert len({row.name for row in rows(d)}) == len(rows(d))
        assert len({row.space + row.isotropy for row in rows(d)}) == len(rows(d))


@pytest.mark.parametrize("d", [-1, 2.0, "2", True, None])
def test_a_dimension_is_an_integer_from_0(d: object) -> None:
    with pytest.raises(lh.InputError):
        lh.full_pairs(d)  # type: ignore[arg-type]


def family(d: int) -> SpiralFamily:
    return next(x for x in lh.full_pairs(d) if isinstance(x, SpiralFamily))


@pytest.mark.parametrize("c", [0, -1, "-2/3", "-sqrt(2)", lh.number_field("sqrt(2)").convert("1 - sqrt(2)")])
def test_c_is_positive(c: object) -> None:
    with pytest.raises(lh.InputError, match="positive"):
        family(6).pair(c)  # type: ignore[arg-type]


@pytest.mark.parametrize(("c", "name"), [
    (2, "affine(su(3)+spiral(2,1))"), ("4/6", "affine(su(3)+spiral(2/3,1))"),
    ("sqrt(8)", "affine(su(3)+spiral(sqrt(8),1))"), ("sqrt(4/9)", "affine(su(3)+spiral(2/3,1))"), ("1 + sqrt(2)", None),
])  # fmt: skip
def test_a_member_has_a_name_if_c_squared_is_rational(c: object, name: str | None) -> None:
    pair = family(6).pair(c)  # type: ignore[arg-type]
    assert pair.name == name
    assert lh.classify(pair).name == name


def test_c_of_a_number_field_with_a_symbol() -> None:
    field = lh.scalars.NumberField("a", [-2, 0, 0, 1], (1, 2))
    pair = family(2).pair(field.generator)
    assert pair.field == field
    assert lh.classify(pair).key.parameter == field.generator**2


# -- names with fractions and square roots -----------------------------------------------------------------
@pytest.mark.parametrize(("name", "printed"), [
    ("affine(su(3) + spiral(4/6, 1))", "affine(su(3)+spiral(2/3,1))"),
    ("affine(spiral(1/2,1))", "affine(spiral(1/2,1))"), ("affine(spiral(4/2,1))", "affine(spiral(2,1))"),
    ("affine(su(3)+spiral(sqrt(1/2),1))", "affine(su(3)+spiral(sqrt(1/2),1))"),
])  # fmt: skip
def test_names_of_spirals_are_printed_in_lowest_terms(name: str, printed: str) -> None:
    assert lh.pair(name).name == printed
    assert lh.pair(printed) == lh.pair(name)


def test_a_fraction_is_the_integer_spiral_scaled() -> None:
    assert lh.pair("affine(su(3)+spiral(2/3,1))") == lh.pair("affine(su(3)+spiral(2,3))")
    assert lh.pair("affine(spiral(1/2,1/3))") == lh.pair("affine(spiral(3,2))")


def test_a_square_root_that_is_rational_gives_a_pair_over_the_rationals() -> None:
    pair = lh.pair("affine(su(3)+spiral(sqrt(4/9),1))")
    assert pair.field == lh.QQ
    assert lh.classify(pair).name == "affine(su(3)+spiral(2/3,1))"


@pytest.mark.parametrize("name", [
    "affine(su(3)+spiral(sqrt(-2),1))", "affine(su(3)+spiral(sqrt(2),0))", "affine(so(3)+spiral(sqrt(2),1))",
    "affine(so(3)+spiral(1/2,1))", "affine(tensor(so(3),spiral(sqrt(2),1)))", "affine(su(3)+spiral(c,1))",
    "affine(spiral(sqrt(2)))", "affine(sqrt(2))", "affine(1/2)", "su(3/2)/u(1)",
])  # fmt: skip
def test_names_that_denote_no_spiral(name: str) -> None:
    with pytest.raises(lh.CatalogError):
        lh.pair(name)
