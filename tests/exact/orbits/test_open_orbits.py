"""Dimension and number of generic orbits of rho(h) + R, and the degree of the relative invariant."""

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, UndecidedError
from liehom.exact.orbits import cone
from liehom.exact.orbits.cone import counted_open_orbits
from liehom.exact.orbits.range import generic_rank, number_of_points
from liehom.exact.scalars.polynomial_matrix import LinearForms, RankLoss, rank_losses_on_line
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

# name: (dimension of generic orbits, degree of the relative invariant, number of open orbits); None: not proved
CASES: dict[str, tuple[int, int | None, int | None]] = {
    "so(9)/so(8)": (8, 2, 1), "so(3,1)/so(2,1)": (3, 2, 3), "affine(so(1,1))": (2, 2, 4),
    "affine(so(3,2))": (5, 2, 2), "affine(gl(4))": (4, 0, 1), "affine(sl(2,C))": (4, 0, 1),
    "affine(S2(gl(2)))": (3, 2, 3), "affine(S3(gl(2)))": (4, 4, 2), "affine(S2(gl(4)))": (10, 4, 5),
    "affine(L2(gl(6)))": (15, 3, 2), "affine(upper(4))": (4, 1, 2), "affine(diag(1,2))": (2, 2, 4),
    "affine(field(1,0))": (2, 2, 1), "affine(copies(2,gl(2,C)))": (8, 4, 1), "sl(3,C)/P{1,2}": (6, 2, 1),
    "so(5,C)/P{1,2}": (8, 6, 1), "sl(4)/so(4)": (7, None, 0), "so(8)/so(4)+so(4)": (13, None, 0),
    "affine(S2(gl(2,C)))": (8, None, 0), "so(3)/0": (1, None, 0), "so(3)/so(3)": (0, None, 1),
    "so(5,3)/P{3,4}": (9, 4, None), "affine(so(3,C)+u(1))": (6, 4, 1), "affine(S2(upper(2)))": (3, 3, 4),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_known_orbits(name: str) -> None:
    dimension, degree, count = CASES[name]
    pair = lh.pair(name)
    assert lh.orbits.orbit_dimension(pair) == dimension and lh.orbits.invariant_degree(pair) == degree
    if count is None:
        with pytest.raises(UndecidedError, match="not counted"):
            lh.orbits.open_orbit_count(pair)
    else:
        assert lh.orbits.open_orbit_count(pair) == count


def test_determinants_are_known_without_elimination() -> None:
    reason = "f is the determinant of 3 x 3 matrices, and it has two signs"
    assert counted_open_orbits(lh.pair("affine(tensor(gl(3),sl(3)))")) == (2, reason)


TENSORS = {
    "gl(2),so(3,1)": (2, "f is the Gram determinant of 2 vectors of R^(3,1)"),
    "gl(2),so(2,1)": (3, "f is the Gram determinant of 2 vectors of R^(2,1)"),
    "gl(2),so(5)": (1, "f is the Gram determinant of 2 vectors of R^(5,0)"),
    "gl(2),g2": (1, "f is the Gram determinant of 2 vectors of R^(7,0)"),
    "gl(2),so(4)": (1, "f = |S|^2 for a skew-Hermitian form S of H^2, and S = 0 has codimension at least 2"),
    "gl(3),so(3)": (2, "f is the determinant of 3 x 3 matrices, and it has two signs"),
}


@pytest.mark.parametrize("name", TENSORS)
def test_invariants_of_tensor_products_are_known(name: str) -> None:
    assert counted_open_orbits(lh.pair(f"affine(tensor({name}))")) == TENSORS[name]


@pytest.mark.parametrize(("name", "d", "degree", "count"), [
    ("sl(3,R)", 6, 3, 4), ("sl(4,R)", 10, 4, 5), ("sl(3,C)", 9, 3, 4), ("sl(3,H)", 15, 3, 4), ("e6(-26)", 27, 3, 4),
    ("sl(6,R)", 15, 3, 2), ("sl(8,R)", 28, 4, 2), ("sl(2,H)", 10, 4, 1), ("sl(3,H)", 21, 6, 1), ("sl(2,R)", 4, 4, 2),
    ("sl(6,R)", 20, 4, 2), ("sl(2,R)", 4, 3, None), ("sl(6,R)", 20, 3, None), ("sl(2,H)", 10, 3, None),
    ("e6(-26)", 27, 4, None), ("sl(3,R)", 8, 3, None), ("sl(5,R)", 10, 5, None),
])  # fmt: skip
def test_invariants_of_simple_algebras_are_known(name: str, d: int, degree: int, count: int | None) -> None:
    known = cone._of_simple(lh.RealForm.of_name(name), d, degree)
    assert (known and known[0]) == count


@pytest.mark.parametrize(("conic", "count"), [
    ("x^2+y^2-1", 2), ("x^2+y^2", 1), ("x^2+y^2+1", 1), ("1-x^2-y^2", 2), ("x^2-y^2-1", 3), ("x^2-y^2+1", 3),
    ("x^2-y^2", 4), ("x^2-2*y", 2), ("x^2", 2), ("x^2-1", 3), ("x^2+1", 1), ("-2*y-x^2", 2), ("2*x+x^2", 3),
])  # fmt: skip
def test_components_of_the_complements_of_plane_conics(conic: str, count: int) -> None:
    x, y, z = (QQ.unit(3, i) for i in range(3))
    pairs = {"x": (x, z), "y": (y, z), "1": (z, z), "x^2": (x, x), "y^2": (y, y)}
    form = QQ.zeros(3, 3)
    for sign, factor, name in re.findall(r"([+-]?)(?:(\d)\*)?([xy](?:\^2)?|1)", conic):
        one, other = pairs[name]
        form = form + (one.T @ other + other.T @ one).scale((-1 if sign == "-" else 1) * QQ.convert(factor or 1) / 2)
    mixed = QQ.matrix([[1, 2, 0], [0, 1, 3], [1, 0, 1]])  # other coordinates of the same plane and conic
    assert cone._affine_components(z, form) == cone._affine_components(z @ mixed, mixed.T @ form @ mixed) == count


@pytest.mark.parametrize("name", [name for name in CASES if lh.pair(name).dimension <= 7])
def test_the_degree_on_a_line_is_that_of_the_computed_invariant(name: str) -> None:
    pair = lh.pair(name)
    invariant = lh.orbits.relative_invariant(pair)
    assert lh.orbits.invariant_degree(pair) == (None if invariant is None else invariant.degree)


def test_invariants_without_an_open_orbit_in_the_hypersurface_are_left_undecided() -> None:
    """GL(3) on 3 x 3 matrices by left multiplication; the orbits in det = 0 have codimension 3."""
    with pytest.raises(UndecidedError, match="codimension 2 or more"):
        lh.orbits.invariant_degree(lh.pair("affine(copies(3,gl(3)))"))


def test_other_fields_raise() -> None:
    pair = lh.pair("so(4)/so(3)")
    over = lh.Pair(pair.algebra.over(lh.number_field("sqrt(2)")), pair.subalgebra.rows())
    assert lh.orbits.orbit_dimension(over) == 3
    for function in (lh.orbits.invariant_degree, lh.orbits.open_orbit_count):
        with pytest.raises(FieldError):
            function(over)
    floats = lh.Pair(pair.algebra.over(lh.RR), pair.subalgebra.basis.to_numpy().tolist())
    with pytest.raises(UndecidedError):
        lh.orbits.orbit_dimension(floats)


@settings(max_examples=examples(20))
@given(data=st.data(), blocks=st.lists(st.integers(1, 3), min_size=1, max_size=3))
def test_orbits_of_products_add(data: st.DataObject, blocks: list[int]) -> None:
    """so(k) on R^k (x) R^m, in blocks and in a random basis: the dimension is that of m vectors, without R."""
    sizes = [(k, data.draw(st.integers(1, 2))) for k in blocks]
    d = sum(k * m for k, m in sizes)
    parts = []
    start = 0
    for k, m in sizes:
        for i in range(k):
            for j in range(i):
                made = np.zeros((d, d), dtype=int)
                for copy in range(m):
                    (
                        made[start + copy * k + i, start + copy * k + j],
                        made[start + copy * k + j, start + copy * k + i],
                    ) = 1, -1
                parts.append(made)
        start += k * m
    rows = data.draw(st.lists(st.lists(st.integers(-2, 2), min_size=d, max_size=d), min_size=d, max_size=d))
    base = QQ.matrix(rows)
    if base.rank() < d:
        base = QQ.identity(d)
    matrices = [base @ QQ.matrix(a.tolist()) @ base.inverse() for a in parts]
    forms = LinearForms(
        [QQ.stack_rows([m.T.select(rows=[i]) for m in matrices] or [QQ.zeros(1, d)], d).T for i in range(d)]
    )
    expected = sum(min(m, k - 1) * (2 * k - min(m, k - 1) - 1) // 2 for k, m in sizes)
    point, rank, _ = generic_rank(forms, [QQ.zero] * d)
    assert forms.at(point).rank() == rank == expected


def test_the_number_of_points_is_that_of_the_polynomials() -> None:
    """Polynomials of degree at most r + 1 in d - r variables."""
    assert number_of_points(7, 9) == 45 and number_of_points(9, 9) == 1


def forms_of(matrices: list[Any], d: int) -> LinearForms:
    return LinearForms([QQ.stack_rows([m.T.select(rows=[i]) for m in matrices], d).T for i in range(d)])


def test_a_tangential_line_is_told() -> None:
    """x^2 + y^2 - z^2 for so(2,1) + R, on a line that touches the cone at (1, 0, 1)."""
    pair = lh.pair("so(2,2)/so(2,1)")
    assert str(lh.orbits.relative_invariant(pair)) == "x0^2 + x1^2 - x2^2"
    forms = forms_of([QQ.identity(3), *pair.isotropy_matrices()], 3)
    assert rank_losses_on_line(forms, [1, 0, 1], [0, 1, 0]) == [RankLoss(1, 2, False)]
    assert rank_losses_on_line(forms, [1, 0, 1], [1, 1, 0]) == [RankLoss(1, 2, True), RankLoss(1, 2, True)]
