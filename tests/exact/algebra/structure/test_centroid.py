"""The centroid: dimensions that are known, the defining identity, invariance under change of basis, other fields."""

import random
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.exact.algebra.structure.centroid import (
    BracketSeeds,
    centroid,
    evaluate,
    minimal_polynomial,
    semisimple_rank,
)
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis
from liehom.testing import random_unimodular
from tests.sampling import examples

# what is known: a field for a simple algebra; End for an abelian one; R id + Hom(g/[g, g], z) for a Heisenberg algebra
KNOWN: dict[str, tuple[lh.LieAlgebra, int]] = {
    "0": (lh.abelian(0), 0), "R^3": (lh.abelian(3), 9), "so(3)": (lh.so(3), 1), "so(4)": (lh.so(4), 2),
    "so(3,1)": (lh.so(3, 1), 2), "sl(2,H)": (lh.sl(2, "H"), 1), "sl(3,C)": (lh.sl(3, "C"), 2),
    "gl(3)": (lh.gl(3), 2), "e(3)": (lh.euclidean(3), 2), "e(5)": (lh.euclidean(5), 1),
    "heisenberg": (lh.heisenberg(3), 7), "affine line": (lh.LieAlgebra({(0, 1): {1: 1}}), 1),
    "three of so(3)": (lh.direct_sum(lh.so(3), lh.so(3), lh.so(3)), 3),
}  # fmt: skip


def scrambled(algebra: lh.LieAlgebra, seed: int) -> lh.LieAlgebra:
    return algebra.change_of_basis(random_unimodular(algebra.dimension, random.Random(seed)))


def dense_centroid_dimension(algebra: lh.LieAlgebra) -> int:
    """The null space of all the equations phi ad(e_i) = ad(e_i) phi, entry by entry."""
    n = algebra.dimension
    rows = []
    for i in range(n):
        a = algebra.ad([int(i == k) for k in range(n)]).to_rows()
        for r in range(n):
            for s in range(n):
                row = [QQ.zero] * (n * n)
                for t in range(n):
                    row[r * n + t] += a[t][s]
                    row[t * n + s] -= a[r][t]
                rows.append(row)
    return n * n - int(QQ.matrix(rows, (len(rows), n * n)).rank())


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_known_dimensions_in_any_basis(name: str) -> None:
    algebra, expected = KNOWN[name]
    assert len(centroid(algebra)) == expected
    assert len(centroid(scrambled(algebra, 2))) == expected


def respects(algebra: lh.LieAlgebra, phi: Any, rng: random.Random) -> bool:
    n = algebra.dimension
    x, y = ([rng.randint(-3, 3) for _ in range(n)] for _ in range(2))
    column = algebra.row(x).T
    left = phi @ algebra.row(algebra.bracket(x, y)).T
    return bool((left - algebra.row(algebra.bracket((phi @ column).T.row(0), y)).T).is_zero())


@settings(max_examples=examples(20))
@given(st.integers(2, 6), st.data())
def test_random_solvable_algebras_against_all_equations(n: int, data: st.DataObject) -> None:
    """R acting on R^(n-1) by a random matrix: the centroid solves [phi, ad x] = 0, and nothing is left out."""
    entries = data.draw(st.lists(st.integers(-1, 1), min_size=(n - 1) ** 2, max_size=(n - 1) ** 2))
    table = {
        (0, i): {j: entries[(i - 1) * (n - 1) + j - 1] for j in range(1, n) if entries[(i - 1) * (n - 1) + j - 1]}
        for i in range(1, n)
    }
    algebra = lh.LieAlgebra(table, dimension=n)
    maps = centroid(algebra)
    assert len(maps) == dense_centroid_dimension(algebra)
    assert all(respects(algebra, phi, random.Random(n)) for phi in maps)


@settings(max_examples=examples(15))
@given(st.integers(2, 4), st.integers(1, 2), st.data())
def test_random_two_step_algebras_against_all_equations(m: int, k: int, data: st.DataObject) -> None:
    """R^m with brackets in a centre R^k, in a scrambled basis; here the centroid is far from commutative."""
    values = data.draw(st.lists(st.integers(-1, 1), min_size=m * m * k, max_size=m * m * k))
    table = {
        (i, j): {m + a: values[(i * m + j) * k + a] for a in range(k) if values[(i * m + j) * k + a]}
        for i in range(m)
        for j in range(i + 1, m)
    }
    algebra = scrambled(lh.LieAlgebra(table, dimension=m + k), 3)
    assert len(centroid(algebra)) == dense_centroid_dimension(algebra)


def test_centroid_is_the_same_space_in_all_bases() -> None:
    """phi -> P^-T phi P^T carries the centroid of the one basis to that of the other."""
    algebra = lh.direct_sum(lh.so(4), lh.heisenberg(1))
    rows = QQ.matrix(random_unimodular(9, random.Random(1)))
    moved = centroid(algebra.change_of_basis(rows))
    back = [rows.T @ phi @ rows.T.inverse() for phi in moved]
    own = centroid(algebra)
    assert len(own) == len(moved) == QQ.stack_rows([m.reshape(1, 81) for m in (*own, *back)], 81).rank()


def test_over_a_number_field() -> None:
    algebra = scrambled(lh.direct_sum(lh.so(4), lh.so(3, 1)).over(lh.number_field("sqrt(2)")), 1)
    maps = centroid(algebra)
    assert len(maps) == 4 and all(respects(algebra, phi, random.Random(1)) for phi in maps)


def test_large_sparse_tables() -> None:
    """so(12) over the rationals, and sl(6, C), whose centroid is QQ(i), in the sparse tables of their own bases."""
    assert not lh.so(12).table.is_dense() and len(centroid(lh.so(12))) == 1
    algebra = lh.sl(6, "C")
    maps = centroid(algebra)
    assert not algebra.table.is_dense() and len(maps) == 2
    assert all(respects(algebra, phi, random.Random(2)) for phi in maps)


def test_floats_raise_undecided_error() -> None:
    with pytest.raises(UndecidedError, match="exact"):
        centroid(lh.so(3).over(lh.RR))


def test_seeds_express_every_vector() -> None:
    algebra = scrambled(lh.direct_sum(lh.gl(2), lh.heisenberg(1)), 4)
    seeds, n = BracketSeeds(algebra), algebra.dimension
    factor, moved, weights = seeds.coordinates(QQ.identity(n))
    total = weights @ QQ.stack_rows(seeds.vectors, n)
    for w, table in zip(moved, seeds.tables, strict=True):
        total = total + w @ table
    assert factor > 0 and total == QQ.identity(n).scale(factor)
    assert not seeds.is_perfect() and seeds.center().nrows == 2


def test_minimal_polynomial_and_semisimple_rank() -> None:
    shear = QQ.matrix([[2, 1, 0], [0, 2, 0], [0, 0, 3]])
    assert minimal_polynomial(shear, QQ.matrix([[0, 1, 1]])) == Polynomial(QQ, [-12, 16, -7, 1])
    assert minimal_polynomial(shear, QQ.matrix([[0, 0, 0]])) == Polynomial(QQ, [1])
    assert evaluate(Polynomial(QQ, [-12, 16, -7, 1]), shear).is_zero()
    assert semisimple_rank([QQ.identity(3), shear, shear @ shear]) == 2
    assert semisimple_rank([]) == 0


@given(st.lists(st.lists(st.integers(-9, 9), min_size=4, max_size=4), min_size=1, max_size=3))
def test_integral_basis_has_all_integer_vectors(rows: list[list[int]]) -> None:
    given_rows = QQ.matrix(rows, (len(rows), 4))
    basis = integral_basis(given_rows)
    assert basis.den == 1 and basis.nrows == given_rows.rank()
    assert QQ.stack_rows([basis, given_rows], 4).rank() == basis.nrows
    # the greatest common divisor of the maximal minors is 1: the lattice is saturated
    if basis.nrows == 1:
        assert basis == basis.primitive()
    if basis.nrows:
        image = basis.T.echelon()[0]
        doubled = integral_basis(QQ.stack_rows([basis.scale(2)], 4))
        assert image == QQ.identity(basis.nrows) and QQ.stack_rows([doubled, basis], 4).rank() == basis.nrows
        assert abs((doubled @ basis.T @ (basis @ basis.T).inverse()).determinant()) == 1
