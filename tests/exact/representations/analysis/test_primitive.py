"""Maximal subalgebras: known ones, controls that are not maximal, and undecided cases."""

import random

import pytest

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.testing import random_unimodular

MAXIMAL = (
    *("so(4)/so(3)", "so(5)/so(3)+so(2)", "su(3)/so(3)", "sp(3)/u(3)", "sl(3)/so(2,1)", "sl(3,C)/su(2,1)", "g2/su(3)"),
    *("g2(2)/sl(3)", "so(7)/g2", "so(8)/spin(7)", "so(3,4)/g2(2)", "sp(6,R)/tensor(sp(2,R),so(3))", "sl(4)/sp(4,R)"),
    *("sl(4)/P2", "sp(6,R)/P2", "so(4,3)/P{2}", "g2(2)/P{1}", "su(2,1)/P{1,2}", "affine(so(3))", "R/0", "aff(1)/R"),
)
NOT_MAXIMAL = (
    *("so(5)/so(3)", "so(4)/so(2)+so(2)", "sl(3)/s(gl(2)+gl(1))", "sp(6,R)/gl(3)"),
    *("so(8)/g2", "sl(3)/B", "so(4,4)/P{3,4}", "g2(2)/P{1,2}", "so(3)/0", "R^2/0"),
)


@pytest.mark.parametrize("name", MAXIMAL)
def test_maximal_subalgebras(name: str) -> None:
    assert lh.pair(name).is_primitive()


@pytest.mark.parametrize("name", ["so(5)/so(3)+so(2)", "sl(4)/s(gl(2)+gl(2))", "sl(3)/P{1,2}", "so(4,1)/P{1}"])
def test_the_answer_does_not_depend_on_the_basis(name: str) -> None:
    pair = lh.pair(name)
    moved = pair.change_of_basis(random_unimodular(pair.algebra.dimension, random.Random(3)))
    assert moved.is_primitive() == pair.is_primitive()


@pytest.mark.parametrize("name", NOT_MAXIMAL)
def test_subalgebras_of_larger_ones_are_not_maximal(name: str) -> None:
    assert not lh.pair(name).is_primitive()


def test_irreducible_spaces_over_a_larger_field_decide() -> None:
    """Q^2 is irreducible over Q for a generator with eigenvalues sqrt(2) and -sqrt(2), and reducible over R."""
    generator = lh.Representation.from_matrices([[[0, 2], [1, 0]]])
    g = lh.semidirect_sum(generator.algebra, generator.matrices)
    assert not lh.Pair(g, [[1, 0, 0]]).is_primitive()
    rotation = lh.Representation.from_matrices([[[0, -2], [1, 0]]])
    g = lh.semidirect_sum(rotation.algebra, rotation.matrices)
    assert lh.Pair(g, [[1, 0, 0]]).is_primitive()


def test_whole_algebra_is_not_a_maximal_subalgebra() -> None:
    assert not lh.pair("so(3)/so(3)").is_primitive()


def diagonal() -> lh.Pair:
    """so(3) as the diagonal of so(3)+so(3)+so(3): g/h is twice the adjoint module."""
    g = lh.direct_sum(lh.so(3), lh.so(3), lh.so(3))
    return lh.Pair(g, [[int(j % 3 == i) for j in range(9)] for i in range(3)])


def test_diagonal_of_three_summands_is_in_the_diagonal_of_two() -> None:
    assert not diagonal().is_primitive()


def test_equivalent_irreducible_spaces_that_generate_leave_it_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("liehom.exact.representations.analysis.decomposition._generates_algebra", lambda *_: True)
    with pytest.raises(UndecidedError, match="equivalent irreducible"):
        diagonal().is_primitive()


def test_floats_leave_it_undecided() -> None:
    pair = lh.pair("so(3)/so(2)")
    with pytest.raises(UndecidedError, match="exact"):
        lh.Pair(pair.algebra.over(lh.RR), pair.subalgebra.rows()).is_primitive()
