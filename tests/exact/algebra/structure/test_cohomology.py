"""Chevalley-Eilenberg cohomology: d^2 = 0, known groups, Euler characteristic, invariance, both ends of errors."""

import itertools
from math import comb
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, RepresentationError, ShapeError, SingularError
from liehom.exact.algebra.structure.cohomology import CochainComplex, cohomology
from liehom.exact.algebra.structure.derivations import derivations, is_derivation
from tests.sampling import examples


def unit(n: int, i: int) -> list[int]:
    return [int(i == j) for j in range(n)]


def adjoint(g: lh.LieAlgebra) -> list[Any]:
    return [g.ad(unit(g.dimension, i)) for i in range(g.dimension)]


def betti(g: lh.LieAlgebra, degrees: int | None = None) -> list[int]:
    top = g.dimension if degrees is None else degrees
    return [cohomology(g, k).dimension for k in range(top + 1)]


# -- the complex ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["so(3)", "heisenberg(2)", "e(3)", "aff(1)", "gl(2)", "R^3", "upper(3)"])
def test_the_square_of_the_differential_is_zero(name: str) -> None:
    g = lh.catalog.algebra(name)
    for cochains in (CochainComplex(g), CochainComplex(g, adjoint(g)), CochainComplex(g, [-m.T for m in adjoint(g)])):
        for k in range(min(g.dimension, 4)):
            first, second = cochains.differential(k), cochains.differential(k + 1)
            assert first.shape == (cochains.length(k), cochains.length(k + 1))
            assert (first @ second).is_zero()


@settings(max_examples=examples(15))
@given(st.lists(st.integers(-3, 3), min_size=18, max_size=18))
def test_the_differential_is_its_formula(values: list[int]) -> None:
    """For a 1-cochain with values in V: dw(x, y) = x w(y) - y w(x) - w([x, y])."""
    g = lh.euclidean(3)
    rho = [m.to_rows() for m in adjoint(g)]
    cochains = CochainComplex(g, adjoint(g))
    w = np.array(values * 2, dtype=object).reshape(6, 6)
    row = lh.QQ.matrix([w.ravel().tolist()]) @ cochains.differential(1)
    for x, (i, j) in enumerate(itertools.combinations(range(6), 2)):
        bracket = [int(v) for v in g.bracket(unit(6, i), unit(6, j))]
        expected = np.array(rho[i]) @ w[j] - np.array(rho[j]) @ w[i] - np.array(bracket) @ w
        assert row.row(0)[6 * x : 6 * x + 6] == list(expected)


@settings(max_examples=examples(10))
@given(st.lists(st.integers(-3, 3), min_size=10, max_size=10))
def test_the_differential_of_two_forms_is_its_formula(values: list[int]) -> None:
    """dw(x, y, z) = -w([x, y], z) + w([x, z], y) - w([y, z], x)."""
    g = lh.heisenberg(2)
    form = np.zeros((5, 5), dtype=object)
    for v, (i, j) in zip(values, itertools.combinations(range(5), 2), strict=True):
        form[i, j], form[j, i] = v, -v
    row = (lh.QQ.matrix([values]) @ CochainComplex(g).differential(2)).row(0)
    c = {(i, j): [int(v) for v in g.bracket(unit(5, i), unit(5, j))] for i in range(5) for j in range(5)}
    for x, (i, j, k) in enumerate(itertools.combinations(range(5), 3)):
        assert row[x] == -(c[i, j] @ form[:, k]) + c[i, k] @ form[:, j] - c[j, k] @ form[:, i]


# -- known groups --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("n", [0, 1, 3, 4])
def test_betti_numbers_of_abelian_algebras_are_binomials(n: int) -> None:
    assert betti(lh.abelian(n)) == [comb(n, k) for k in range(n + 1)]


@pytest.mark.parametrize(("name", "numbers"), [
    ("heisenberg(1)", [1, 2, 2, 1]), ("heisenberg(2)", [1, 4, 5, 5, 4, 1]), ("so(3)", [1, 0, 0, 1]),
    ("sl(2)", [1, 0, 0, 1]), ("so(4)", [1, 0, 0, 2, 0, 0, 1]), ("sl(3)", [1, 0, 0, 1, 0, 1, 0, 0, 1]),
    ("gl(2)", [1, 1, 0, 1, 1]), ("e(3)", [1, 0, 0, 2, 0, 0, 1]), ("aff(1)", [1, 1, 0]),
])  # fmt: skip
def test_betti_numbers(name: str, numbers: list[int]) -> None:
    assert betti(lh.catalog.algebra(name)) == numbers
    if any(numbers[-1:]):  # unimodular: Poincare duality
        assert numbers == numbers[::-1]
    assert sum((-1) ** k * b for k, b in enumerate(numbers)) == 0


@pytest.mark.parametrize("n", [3, 4, 6, 9])
def test_second_betti_number_of_filiform_algebras(n: int) -> None:
    """b_2 of the standard filiform algebra of dimension n is [(n + 1) / 2]."""
    assert betti(lh.algebra.filiform(n), 2) == [1, 2, (n + 1) // 2]


def test_the_galilei_algebra_has_the_mass_and_nothing_else() -> None:
    g = lh.galilei(3)
    group = cohomology(g, 2)
    assert group.dimension == 1
    k, p = g.basis_names.index("k1"), g.basis_names.index("p1")
    mass = group.cochain({(k + i, p + i): 1 for i in range(3)})
    assert group.is_cocycle(mass) and not group.is_coboundary(mass) and group.coordinates(mass)[0, 0] != 0
    assert cohomology(lh.algebra.bargmann(3), 2).dimension == 0
    assert cohomology(lh.poincare(3), 2).dimension == 0
    assert cohomology(lh.galilei(2), 2).dimension == 3  # in the plane also [k1, k2] and [m, h]


def test_central_extensions_by_representatives() -> None:
    for g in (lh.heisenberg(1), lh.galilei(2), lh.abelian(3), lh.algebra.filiform(5)):
        group = cohomology(g, 2)
        forms = group.forms()
        extended = lh.algebra.central_extension(g, forms)
        assert extended.dimension == g.dimension + group.dimension
        assert extended.center().dimension >= group.dimension
        # all extensions by classes are not split: the new centre lies in the derived algebra
        new = [unit(extended.dimension, g.dimension + a) for a in range(group.dimension)]
        assert all(row in extended.derived_subalgebra() for row in new)


@pytest.mark.parametrize("name", ["so(3)", "sl(2)", "so(2,2)", "sl(2,C)", "su(3)"])
def test_whitehead_lemmas_for_semisimple_algebras(name: str) -> None:
    g = lh.catalog.algebra(name)
    for matrices in (None, adjoint(g)):
        assert cohomology(g, 1, matrices).dimension == 0
        assert cohomology(g, 2, matrices).dimension == 0
    if g.dimension < 8:
        # without the theorem: ranks of the differentials
        cochains = CochainComplex(g, adjoint(g))
        ranks = [cochains.differential(k).rank() for k in range(3)]
        assert ranks[0] + ranks[1] == cochains.length(1)
        assert ranks[1] + ranks[2] == cochains.length(2)


def test_h1_of_the_trivial_module_is_dual_to_the_abelianization() -> None:
    for g in (
        lh.algebra.upper_triangular(3),
        lh.galilei(2),
        lh.algebra.free_nilpotent(3, 2),
        lh.algebra.affine(2),
        lh.sl(2),
    ):
        derived, group = g.derived_subalgebra(), cohomology(g, 1)
        assert group.dimension == g.dimension - derived.dimension
        assert (group.representatives @ derived.basis.T).is_zero()


@pytest.mark.parametrize(
    "name", ["heisenberg(1)", "heisenberg(2)", "e(3)", "aff(1)", "gl(2)", "upper(3)", "R^2", "so(3)"]
)
def test_h1_of_the_adjoint_module_is_outer_derivations(name: str) -> None:
    g = lh.catalog.algebra(name)
    n = g.dimension
    group = cohomology(g, 1, adjoint(g))
    assert group.dimension == derivations(g).outer_dimension
    for row in group.representatives.to_rows():
        # the value at e_j is column j of a derivation
        assert is_derivation(g, lh.QQ.matrix([row[n * j : n * j + n] for j in range(n)], (n, n)).T)
    assert cohomology(g, 0, adjoint(g)).dimension == g.center().dimension


def test_h0_is_the_space_of_invariants() -> None:
    group = cohomology(lh.so(2), 0, [[[0, -1, 0], [1, 0, 0], [0, 0, 0]]])
    assert group.values(group.representatives) == {(): [0, 0, 1]}
    assert cohomology(lh.so(3), 0).dimension == 1
    assert cohomology(lh.so(3), 0, [[[0]]] * 3).dimension == 1


@settings(max_examples=examples(10))
@given(
    st.sampled_from(["heisenberg(1)", "e(3)", "upper(3)", "aff(1)"]),
    st.lists(st.integers(-2, 2), min_size=6, max_size=6),
)
def test_the_dimensions_do_not_depend_on_the_basis(name: str, numbers: list[int]) -> None:
    g = lh.catalog.algebra(name)
    n = g.dimension
    rows = [[(1 if i == j else numbers[(i + j) % 6] if i < j else 0) for j in range(n)] for i in range(n)]
    moved = g.change_of_basis(rows)
    assert betti(moved, 3) == betti(g, 3)
    assert cohomology(moved, 2, adjoint(moved)).dimension == cohomology(g, 2, adjoint(g)).dimension


@settings(max_examples=examples(10))
@given(st.lists(st.integers(-2, 2), min_size=4, max_size=4), st.integers(0, 4))
def test_betti_numbers_of_sums_satisfy_kuenneth(numbers: list[int], k: int) -> None:
    """b_k of a direct sum is the convolution of the Betti numbers."""
    first = lh.algebra.almost_abelian([numbers[:2], numbers[2:]])
    second = lh.heisenberg(1)
    left, right = betti(first), betti(second)
    expected = sum(left[i] * right[k - i] for i in range(4) if 0 <= k - i <= 3)
    assert cohomology(lh.direct_sum(first, second), k).dimension == expected


# -- cochains ------------------------------------------------------------------------------------------------
def test_cochains_and_values() -> None:
    group = cohomology(lh.heisenberg(1), 2)
    row = group.cochain({(2, 0): "1/2", (0, 1): 3})
    assert group.values(row) == {(0, 1): 3, (0, 2): lh.QQ.convert("-1/2")}
    assert group.potential(group.cochain({(0, 1): 5})).to_strings() == [["0", "0", "-5"]]
    with pytest.raises(SingularError):
        group.potential(row)
    assert group.coordinates(row).to_strings() == [["-1/2", "0"]]
    assert group.coboundaries().dimension == 1
    assert group.cocycles().dimension == 3
    module = cohomology(lh.heisenberg(1), 1, adjoint(lh.heisenberg(1)))
    row = module.cochain({0: [1, 0, 0], 1: [0, -1, 0]})
    assert module.is_cocycle(row)
    assert module.values(row) == {(0,): [1, 0, 0], (1,): [0, -1, 0]}


@settings(max_examples=examples(20))
@given(st.lists(st.integers(-4, 4), min_size=9, max_size=9))
def test_coordinates_of_classes(numbers: list[int]) -> None:
    group = cohomology(lh.algebra.filiform(5), 2)
    classes, potential = numbers[: group.dimension], numbers[4:]
    row = lh.QQ.matrix([classes]) @ group.representatives + lh.QQ.matrix([potential]) @ group.cochains.differential(1)
    assert group.coordinates(row).row(0) == classes
    assert group.is_coboundary(row) == (not any(classes))


def test_coordinates_of_a_cochain_that_is_not_a_cocycle_raise_input_error() -> None:
    group = cohomology(lh.heisenberg(2), 2)
    row = group.cochain({(0, 4): 1})
    assert not group.is_cocycle(row)
    with pytest.raises(InputError, match="not a cocycle"):
        group.coordinates(row)


@pytest.mark.parametrize("key", [(0, 0), (0, 5), (0,), 1, "01", (0, 1, 2), ("a", "b")])
def test_invalid_indices_raise_input_error(key: Any) -> None:
    with pytest.raises(InputError, match="different indices"):
        cohomology(lh.heisenberg(1), 2).cochain({key: 1})


# -- fields, sizes, errors -----------------------------------------------------------------------------------
def test_over_other_fields() -> None:
    k = lh.number_field("sqrt(2)")
    for name in ("heisenberg(2)", "e(3)", "gl(2)"):
        g = lh.catalog.algebra(name)
        assert betti(g.over(k), 3) == betti(g, 3) == betti(g.over(lh.RR), 3)
    g = lh.algebra.oscillator(2, ["sqrt(2)", 1])
    assert betti(g)[::-1] == betti(g)
    g = lh.euclidean(3).over(lh.RR)
    assert cohomology(g, 1, adjoint(g)).dimension == 1


def test_the_zero_algebra_and_degrees_beyond_the_dimension() -> None:
    g = lh.abelian(0)
    assert betti(g) == [1]
    assert cohomology(g, 1).dimension == 0
    assert cohomology(g, 0, [], size=4).dimension == 4
    assert cohomology(g, 0).values(cohomology(g, 0).representatives) == {(): 1}
    assert cohomology(lh.so(3), 4).dimension == 0
    assert cohomology(lh.so(3), 4).is_coboundary([])
    with pytest.raises(ShapeError, match="size"):
        cohomology(g, 0, [])


def test_h2_of_a_large_semisimple_algebra_needs_no_matrix() -> None:
    assert cohomology(lh.so(12), 2).dimension == 0
    with pytest.raises(InputError, match="smaller degree"):
        cohomology(lh.so(12), 3)


def test_blocks_reach_degrees_whose_differential_is_large() -> None:
    """Of filiform algebras the extensions by a line, dim H^2 = floor((n + 1) / 2), and H^3 of so(7) is that of S^3."""
    for n in (5, 12, 21):
        assert cohomology(lh.algebra.filiform(n), 2).dimension == (n + 1) // 2
    assert cohomology(lh.so(7), 3).dimension == 1
    g = lh.algebra.strictly_upper_triangular(7)
    h2 = cohomology(g, 2, lh.adjoint(g).matrices)
    assert h2.dimension == 61 and h2.is_cocycle(h2.representatives.select(rows=[30]))


def test_representatives_of_blocks_are_those_of_one_block() -> None:
    """In a dense basis one block is left; the dimensions do not depend on the basis."""
    g = lh.algebra.filiform(5)
    h = g.change_of_basis([[1, 2, 0, 1, 0], [0, 1, 0, 0, 3], [0, 0, 2, 1, 0], [0, 1, 0, 1, 0], [0, 0, 0, 0, 1]])
    for k in range(4):
        assert cohomology(g, k, lh.adjoint(g).matrices).dimension == cohomology(h, k, lh.adjoint(h).matrices).dimension


def test_invalid_modules_and_degrees_raise_errors() -> None:
    for degree in (-1, 1.5, True, "2"):
        with pytest.raises(InputError, match="degree"):
            cohomology(lh.so(3), degree)  # type: ignore[arg-type]
    with pytest.raises(RepresentationError, match="not a representation") as caught:
        cohomology(lh.so(3), 1, [[[1]], [[0]], [[0]]])
    assert caught.value.pair == (1, 2)
    with pytest.raises(ShapeError, match="2 matrices"):
        cohomology(lh.so(3), 1, [[[0]], [[0]]])
    with pytest.raises(InputError, match="degree 2"):
        cohomology(lh.so(3), 1).forms()
    with pytest.raises(ShapeError):
        cohomology(lh.so(3), 1).is_cocycle([1, 2])
    with pytest.raises(ShapeError, match="coordinates"):
        cohomology(lh.so(3), 1).cochain({0: [1, 2]})
