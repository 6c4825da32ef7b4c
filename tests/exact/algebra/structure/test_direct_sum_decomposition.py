"""Direct sums: every summand is found in scrambled bases, and only what splits over the field is split."""

import random
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.exact.algebra.structure.ideals import components, direct_sum_decomposition
from liehom.testing import random_unimodular
from tests.sampling import examples

PARTS: dict[str, tuple[lh.LieAlgebra, tuple[int, ...]]] = {
    "so(3)": (lh.so(3), (3,)), "so(4)": (lh.so(4), (3, 3)), "so(3,1)": (lh.so(3, 1), (6,)),
    "sl(3)": (lh.sl(3), (8,)), "gl(2)": (lh.gl(2), (1, 3)), "heisenberg(1)": (lh.heisenberg(1), (3,)),
    "heisenberg(2)": (lh.heisenberg(2), (5,)), "e(2)": (lh.euclidean(2), (3,)), "e(3)": (lh.euclidean(3), (6,)),
    "R^2": (lh.abelian(2), (1, 1)), "affine": (lh.LieAlgebra({(0, 1): {1: 1}}), (2,)),
    "filiform": (lh.LieAlgebra({(0, 1): {2: 1}, (0, 2): {3: 1}}), (4,)),
}  # fmt: skip


def scrambled(algebra: lh.LieAlgebra, rng: random.Random) -> lh.LieAlgebra:
    return algebra.change_of_basis(random_unimodular(algebra.dimension, rng))


def dimensions(algebra: lh.LieAlgebra) -> list[int]:
    """The dimensions of the summands, after checking that they are ideals with direct sum the algebra."""
    ideals = direct_sum_decomposition(algebra)
    n = algebra.dimension
    rows = algebra.field.stack_rows([h.basis for h in ideals], n) if ideals else algebra.field.zeros(0, n)
    assert rows.nrows == n and rows.rank() == n
    assert all(h.is_ideal() for h in ideals)
    return [h.dimension for h in ideals]


@settings(max_examples=examples(15))
@given(st.lists(st.sampled_from(sorted(PARTS)), min_size=1, max_size=3), st.randoms())
def test_sums_in_scrambled_bases(names: list[str], rng: random.Random) -> None:
    """Krull, Remak and Schmidt: the dimensions of the summands do not depend on the basis."""
    algebra = lh.direct_sum(*(PARTS[name][0] for name in names))
    expected = sorted(d for name in names for d in PARTS[name][1])
    assert dimensions(algebra) == expected
    assert dimensions(scrambled(algebra, rng)) == expected


def test_the_ideals_of_a_semisimple_algebra_are_unique() -> None:
    algebra = lh.direct_sum(lh.so(3), lh.sl(2), lh.so(3))
    rows = lh.QQ.matrix(random_unimodular(9, random.Random(3)))
    ideals = direct_sum_decomposition(algebra.change_of_basis(rows))
    spans = [algebra.subalgebra(h.basis @ rows) for h in ideals]
    units = [[[int(3 * b + i == j) for j in range(9)] for i in range(3)] for b in range(3)]
    assert all(any(s == algebra.subalgebra(u) for s in spans) for u in units)


def test_an_extension_of_the_field_splits_more() -> None:
    """so(3) over QQ(sqrt 2), seen over QQ, splits over QQ(sqrt 2) only; so(3,1) does over no real field."""
    table: dict[tuple[int, int], dict[int, Any]] = {}
    for i, j, k, sign in ((0, 1, 2, 1), (1, 2, 0, 1), (0, 2, 1, -1)):
        for a in range(2):
            for b in range(2):
                table[2 * i + a, 2 * j + b] = {2 * k + (a + b) % 2: sign * (2 if a + b == 2 else 1)}
    algebra = scrambled(lh.LieAlgebra(table, dimension=6), random.Random(1))
    field = lh.number_field("sqrt(2)")
    assert dimensions(algebra) == [6]
    assert dimensions(algebra.over(field)) == [3, 3]
    assert dimensions(algebra.over(lh.number_field("sqrt(3)"))) == [6]
    assert dimensions(scrambled(lh.so(3, 1).over(field), random.Random(1))) == [6]


def test_a_centre_inside_the_derived_algebra_is_not_split_off() -> None:
    """Two Heisenberg algebras with one common centre are indecomposable; the sum with separate centres is not."""
    common = lh.LieAlgebra({(0, 1): {4: 1}, (2, 3): {4: 1}}, dimension=5)
    separate = lh.LieAlgebra({(0, 1): {4: 1}, (2, 3): {5: 1}}, dimension=6)
    assert dimensions(scrambled(common, random.Random(1))) == [5]
    assert dimensions(scrambled(separate, random.Random(1))) == [3, 3]


def test_a_complex_heisenberg_algebra_is_one_piece_over_the_rationals() -> None:
    """[x + iy, u + iv] = z + iw, i^2 = d: one piece over QQ, two where d is a square."""
    for d, expected in ((-1, [6]), (2, [6]), (4, [3, 3])):
        table = {(0, 2): {4: 1}, (0, 3): {5: 1}, (1, 2): {5: 1}, (1, 3): {4: d}}
        assert dimensions(scrambled(lh.LieAlgebra(table, dimension=6), random.Random(2))) == expected


@pytest.mark.parametrize("places", [(0,), (0, 3, 5), tuple(range(9))], ids=["one", "three", "all"])
def test_numbers_that_a_prime_divides(places: tuple[int, ...]) -> None:
    """Basis elements multiplied by the prime that residues are taken of first: no rank modulo it is then right."""
    algebra = lh.direct_sum(lh.so(4), lh.heisenberg(1))
    for factor in (lh.QQ.convert(2**61 - 1), 1 / lh.QQ.convert(2**61 - 1), lh.QQ.convert("2/3")):
        rows = [[(factor if i in places else 1) if i == j else 0 for j in range(9)] for i in range(9)]
        assert dimensions(algebra.change_of_basis(rows)) == [3, 3, 3]


def test_dimension_zero_and_floats() -> None:
    assert direct_sum_decomposition(lh.abelian(0)) == []
    with pytest.raises(UndecidedError):
        direct_sum_decomposition(lh.so(4).over(lh.RR))


def test_components_of_the_table() -> None:
    table = lh.LieAlgebra({(0, 3): {3: 1}, (1, 2): {4: 1}}, dimension=6).table
    assert components(table) == [[0, 3], [1, 2, 4], [5]]


def test_dimension_fifty() -> None:
    """Ten summands, some with a centre, in a dense basis."""
    algebra = lh.direct_sum(lh.so(4), lh.sl(3), lh.gl(3), lh.euclidean(3), lh.heisenberg(2), lh.so(5), lh.so(3, 1))
    assert algebra.dimension == 50
    assert dimensions(scrambled(algebra, random.Random(1))) == [1, 3, 3, 5, 6, 6, 8, 8, 10]
