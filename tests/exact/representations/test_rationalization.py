"""Exact objects near those over floats: the axioms are proved, and what cannot be exact says why."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, UndecidedError
from tests.sampling import examples

small = st.fractions(min_value=-3, max_value=3, max_denominator=20)


@settings(max_examples=examples(40))
@given(rows=st.lists(st.lists(small, min_size=3, max_size=3), min_size=3, max_size=3))
def test_an_exact_algebra_is_found_again(rows: list[list[Fraction]]) -> None:
    if abs(np.linalg.det(np.array(rows, dtype=float))) < 1e-2:
        return
    g = lh.so(3).change_of_basis(rows)
    largest = max(int(v.q) for *_, v in g.structure_constants())
    if largest > 10**6:
        return
    exact, change = lh.rationalize(g.over(lh.RR), max_denominator=largest)
    assert exact == g and change < 1e-12


@settings(max_examples=examples(40))
@given(seed=st.integers(0, 1000), scale=st.floats(-12, 12).map(lambda e: 10.0**e))
def test_the_subalgebra_of_a_pair_does_not_depend_on_its_basis(seed: int, scale: float) -> None:
    pair = lh.pair("so(4)/so(3)")
    rng = np.random.default_rng(seed)
    mixed = scale * (np.eye(3) + rng.normal(size=(3, 3)) / 5) @ pair.subalgebra.basis.to_numpy()
    made: Any = lh.rationalize(lh.Pair(pair.algebra.over(lh.RR), mixed, name=pair.name))
    assert made.exact == pair and made.exact.name == pair.name and made.largest_change < 1e-10
    assert bool(lh.decide_fullness(made.exact))


def test_representations_are_rounded_with_their_algebra() -> None:
    rho = lh.defining(lh.su(2))
    exact, change = lh.rationalize(rho.over(lh.RR))
    assert exact == rho and exact.coordinates == rho.coordinates and change == 0.0
    x, y = (a.to_numpy() for a in lh.defining(lh.so(3)).matrices[:2])
    completed = lh.Representation.from_matrices([x / 3, y / 3 + 1e-12])
    exact, change = lh.rationalize(completed)
    assert exact.algebra.real_form() == "so(3)" and exact.given == 2 and 0 < change < 1e-10
    assert exact.matrices[1] == lh.QQ.matrix((y * 1).astype(int)).scale("1/3") and exact.appended == ((0, 1),)


def test_completed_matrices_generate_an_algebra_of_the_same_dimension() -> None:
    """The fractions leave a small symmetric part out, and generate so(3) in place of sl(3)."""
    x, y = (a.to_numpy() for a in lh.defining(lh.so(3)).matrices[:2])
    completed = lh.Representation.from_matrices([x, y + 1e-5 * np.diag([1.0, -2.0, 1.0])])
    assert completed.algebra.dimension == 8
    with pytest.raises(InputError, match="an algebra of dimension 3, the floats one of dimension 8"):
        lh.rationalize(completed)


def test_zeros_are_fractions() -> None:
    exact, change = lh.rationalize(lh.abelian(2).over(lh.RR))
    assert exact == lh.abelian(2) and change == 0.0


def test_the_largest_change_is_relative_to_the_largest_entry() -> None:
    g = lh.LieAlgebra({(0, 1): {0: 1 / 3 + 2e-7, 1: 4.0}}, field=lh.RR)
    assert lh.rationalize(g, max_denominator=3).largest_change == pytest.approx(5e-8, rel=1e-6)


def test_exact_objects_are_returned() -> None:
    pair = lh.pair("so(4)/so(3)")
    assert lh.rationalize(pair).exact is pair and lh.rationalize(pair.algebra).largest_change == 0.0


def test_the_axioms_are_proved_for_the_fractions() -> None:
    """An arbitrary basis: the entries are irrational, and the fractions violate the Jacobi identity."""
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    g = lh.so(4).over(lh.RR).change_of_basis(np.kron(np.eye(2), turn))
    with pytest.raises(InputError, match=r"denominators up to 1000.*Jacobi.*another max_denominator, or a basis"):
        lh.rationalize(g)


def test_the_fractions_of_a_subalgebra_are_proved_to_be_closed() -> None:
    """A torus of so(4) = so(3) + so(3) in irrational directions."""
    axis = np.array([[1.0, 2.0**0.5, 3.0**0.5]])
    torus = np.vstack([axis @ ideal.basis.to_numpy() for ideal in lh.so(4).simple_ideals()])
    with pytest.raises(InputError, match="do not span a subalgebra"):
        lh.rationalize(lh.Pair(lh.so(4).over(lh.RR), torus))


def test_numbers_that_are_not_near_fractions_are_refused() -> None:
    g = lh.LieAlgebra({(0, 1): {1: 0.49}}, field=lh.RR)
    with pytest.raises(InputError, match="fractions differ"):
        lh.rationalize(g, max_denominator=1)
    exact, change = lh.rationalize(lh.LieAlgebra({(0, 1): {1: float(np.pi)}}, field=lh.RR), max_denominator=113)
    assert next(iter(exact.structure_constants()))[3] == lh.QQ.convert("355/113") and 8e-8 < change < 9e-8
    with pytest.raises(InputError, match="fractions differ"):
        lh.rationalize(lh.LieAlgebra({(0, 1): {1: 1e-5}}, field=lh.RR))  # small constants do not become 0
    assert lh.rationalize(lh.LieAlgebra({(0, 1): {1: 1e-5}}, field=lh.RR), max_denominator=10**5).largest_change < 1e-9


@pytest.mark.parametrize("bad", [0, -1, 1.5, "10", True])
def test_a_bound_that_is_not_a_positive_integer_is_refused(bad: Any) -> None:
    with pytest.raises(InputError, match="max_denominator"):
        lh.rationalize(lh.so(3).over(lh.RR), max_denominator=bad)
    with pytest.raises(InputError, match="Pair"):
        lh.rationalize("so(3)")  # type: ignore[call-overload]


def test_questions_that_need_exact_numbers_lead_to_an_answer() -> None:
    g = lh.so(3, 1).over(lh.RR)
    with pytest.raises(UndecidedError, match=r"lh\.rationalize"):
        g.real_form()
    assert lh.rationalize(g).exact.real_form() == "sl(2,C)"
