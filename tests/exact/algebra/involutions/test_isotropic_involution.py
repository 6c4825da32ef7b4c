"""Cartan involutions from nilpotent elements: sl2-triples, minimal parabolic subalgebras, and failures."""

import random

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import SingularError
from liehom.exact.algebra.involutions.cartan_decomposition import cartan_decomposition, is_cartan_involution
from liehom.exact.algebra.involutions.cartan_involution import approximate_involution
from liehom.exact.algebra.involutions.rational_involution import (
    generic_nilpotent,
    isotropic_involution,
    lattice_order,
)
from liehom.exact.algebra.structure.nilpotent import triple_through
from liehom.testing import random_unimodular

SPLIT = ("sl(2,R)", "sl(4,R)", "so(3,2)", "sp(6,R)", "g2(2)")
QUASI_SPLIT = ("sl(2,C)", "sl(3,C)", "su(2,1)", "su(2,2)", "so(5,3)")
OTHERS = ("so(4,1)", "so(5,1)", "su(3,1)", "sl(2,H)", "sp(2,1)", "so(5,2)", "so(6,2)")


def form(name: str, seed: int) -> lh.LieAlgebra:
    natural = lh.simple(lh.RealForm.of_name(name).type, name)
    return natural.change_of_basis(random_unimodular(natural.dimension, random.Random(seed)))


@pytest.mark.parametrize("name", [*SPLIT, *QUASI_SPLIT, *OTHERS])
def test_a_candidate_is_a_cartan_involution(name: str) -> None:
    algebra = form(name, 5)
    theta = isotropic_involution(algebra, approximate_involution(algebra, lh.RealForm.of_name(name).rank))
    assert theta is not None and is_cartan_involution(algebra, theta)


@pytest.mark.parametrize("name", ["sl(4,R)", "so(4,1)", "su(3,1)", "g2(2)"])
def test_the_parabolic_subalgebra_of_a_generic_element_is_minimal(name: str) -> None:
    algebra, real = form(name, 2), lh.RealForm.of_name(name)
    triple = generic_nilpotent(algebra, approximate_involution(algebra, real.rank))
    assert triple is not None
    h, e, f = (x.to_rows()[0] for x in (triple.h, triple.e, triple.f))
    assert list(algebra.bracket(h, e)) == [2 * x for x in e]
    assert list(algebra.bracket(h, f)) == [-2 * x for x in f]
    assert list(algebra.bracket(e, f)) == list(h)
    assert algebra.centralizer(triple.h).dimension == real.satake.anisotropic_dimension + real.real_rank


def test_a_compact_algebra_has_no_nilpotent_elements() -> None:
    algebra = form("so(5)", 1)
    assert generic_nilpotent(algebra, approximate_involution(algebra, 2)) is None


def test_sl2_triple_of_a_non_nilpotent_element_raises() -> None:
    g = lh.sl(2)
    for row in ([[0, 0, 1]], [[1, -1, 0]], [[0, 0, 0]]):
        with pytest.raises(SingularError):
            triple_through(g, g.field.matrix(row))


@pytest.mark.parametrize(("name", "seed"), [("g2(2)", 6), ("sp(6,R)", 1)])
def test_bases_in_which_no_small_involution_is_found(name: str, seed: int) -> None:
    """Lattice reduction and random moves alone do not find one in the first of these."""
    algebra = form(name, seed)
    decomposition = cartan_decomposition(algebra)
    assert is_cartan_involution(algebra, decomposition.theta)
    assert decomposition.k.dimension == lh.RealForm.of_name(name).compact_dimension


@pytest.mark.slow
def test_dimension_45_in_a_rational_basis() -> None:
    natural = lh.simple("D5", "so*(10)")
    rng = random.Random(1)
    rows = [[rng.randint(-3, 3) + 5 * (i == j) for j in range(45)] for i in range(45)]
    assert cartan_decomposition(natural.change_of_basis(rows)).k.dimension == 25


def test_an_order_at_a_prime_that_divides_the_dual_coxeter_number() -> None:
    """The Killing form of so(4,3) is 0 modulo 5 on every order: its radical modulo 25 leads out of a sublattice."""
    natural = lh.simple("B3", "so(4,3)")
    rng = random.Random(1)
    rows = [[rng.randint(-3, 3) + 5 * (i == j) for j in range(21)] for i in range(21)]
    algebra = natural.change_of_basis(rows)
    order = algebra.change_of_basis(lattice_order(algebra, np.eye(21), thorough=False))
    assert order.table.den == 1
    assert int(order.killing_form().determinant()) % 5**22 != 0
    decomposition = cartan_decomposition(algebra)
    assert is_cartan_involution(algebra, decomposition.theta) and decomposition.k.dimension == 9
