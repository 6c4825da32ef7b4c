"""Root systems and Levi factors in bases with large entries."""

import random

import pytest

import liehom as lh
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.rational import QQ


def scrambled(algebra: LieAlgebra, size: int, seed: int) -> LieAlgebra:
    """The algebra in a random basis with integer coefficients up to `size`."""
    rng, n = random.Random(seed), algebra.dimension
    while True:
        rows: ExactMatrix = QQ.matrix([[rng.randint(-size, size) for _ in range(n)] for _ in range(n)])
        if rows.rank() == n:
            return LieAlgebra(algebra.table.changed(rows, rows.inverse()), check=False)


def parabolic(a: int, b: int) -> LieAlgebra:
    """The parabolic subalgebra of sl(a + b, R) that preserves a subspace of dimension a."""
    n = a + b
    units = [(i, j) for i in range(n) for j in range(n) if i != j and not (i >= a > j)]
    matrices = [[[int((r, c) == unit) for c in range(n)] for r in range(n)] for unit in units]
    matrices += [[[int(r == c == i) - int(r == c == i + 1) for c in range(n)] for r in range(n)] for i in range(n - 1)]
    return LieAlgebra.from_matrices(matrices)


@pytest.mark.parametrize("digits", [20, 300])
def test_roots_do_not_depend_on_the_size_of_the_entries(digits: int) -> None:
    algebra = scrambled(lh.direct_sum(lh.so(3), lh.sl(2)), 10**digits, seed=1)
    assert algebra.root_system().type == "A1 + A1"
    assert algebra.real_form() == "so(3) + sl(2,R)"


def test_real_forms_do_not_depend_on_numbers_beyond_floats() -> None:
    """A minimal polynomial of the centroid has coefficients of 400 digits."""
    algebra = lh.so(3, 1)
    scales = QQ.matrix([[10**400 * (i % 2) + (i + 1) % 2 if i == j else 0 for j in range(6)] for i in range(6)])
    assert algebra.change_of_basis(scales).real_form() == "sl(2,C)"


@pytest.mark.parametrize(("a", "b", "kind"), [(2, 2, "A1 + A1"), pytest.param(4, 3, "A2 + A3", marks=pytest.mark.slow)])
def test_roots_of_the_levi_factor_of_a_scrambled_parabolic_subalgebra(a: int, b: int, kind: str) -> None:
    levi = scrambled(parabolic(a, b), 1, seed=0).levi_decomposition().levi
    assert levi.as_algebra().root_system().type == kind


@pytest.mark.parametrize(("a", "b"), [(3, 2), (3, 3)])
def test_levi_factor_and_its_cartan_subalgebra_have_short_bases(a: int, b: int) -> None:
    levi = scrambled(parabolic(a, b), 1, seed=0).levi_decomposition().levi
    for space in (levi, levi.as_algebra().cartan_subalgebra()):
        basis = as_exact(space.basis)
        assert max(basis.den, *(abs(int(x)) for x in basis.parts[0].entries())) < 2**128
