"""Split tori: the dimension is the rank over the rationals, by the theory of quadratic and Hermitian forms."""

import pytest

import liehom as lh
from liehom.base.errors import UndecidedError
from liehom.exact.algebra.involutions.parabolic import eigenvalues, maximal_split_torus, split_part
from tests.exact.algebra.involutions.test_extended_involution import in_dense_basis, orthogonal, unitary

# rational zeros: 5 = 1 + 4, 3 = 1 + 1 + 1, 14 = 1 + 4 + 9, 7 = 1 + 1 + 1 + 4; the last one has two orthogonal zeros
ISOTROPIC = [(1, 1, -5), (1, 1, 1, -3), (1, 1, 1, -14), (1, 2, 3, -5), (1, 1, 1, 1, -7), (1, 1, -2, -2, 3)]
# no zeros modulo powers of 2, 3, 3, 2; the last one has zeros, but no two orthogonal ones over the 7-adic numbers
ANISOTROPIC = [(1, 1, 1, -7), (1, 1, -3), (1, 1, -3, -3), (1, 1, 1, -15), (1, 1, 1, -7, -7)]


def check(algebra: lh.LieAlgebra, rank: int) -> None:
    torus = maximal_split_torus(algebra)
    assert torus.nrows == rank == algebra.real_rank()
    assert algebra.table.bracket_rows(torus, torus).is_zero()
    for i in range(rank):
        x = torus.select(rows=[i])
        values = eigenvalues(algebra, x)
        assert values is not None
        kernels = [(algebra.ad(x) - algebra.field.identity(algebra.dimension).scale(v)).null_space() for v in values]
        assert sum(kernel.nrows for kernel in kernels) == algebra.dimension


@pytest.mark.parametrize("form", ISOTROPIC, ids=str)
def test_isotropic_quadratic_forms(form: tuple[int, ...]) -> None:
    check(orthogonal(*form), min(sum(d > 0 for d in form), sum(d < 0 for d in form)))


@pytest.mark.parametrize("form", ANISOTROPIC, ids=str)
def test_forms_of_smaller_rank_over_the_rationals_have_no_torus(form: tuple[int, ...]) -> None:
    with pytest.raises(UndecidedError, match="no split torus"):
        maximal_split_torus(orthogonal(*form))


@pytest.mark.parametrize(("field", "form", "rank"), [(1, (1, 1, -3), 1), (2, (1, 1, -3), 1), (1, (1, 1, 1, -3), 1)])
def test_hermitian_forms(field: int, form: tuple[int, ...], rank: int) -> None:
    """3 is a sum of two norms of Gaussian integers, 1 + |1 + i|^2, and 1 + 2 is a norm of QQ(sqrt(-2))."""
    check(unitary(field, *form), rank)


@pytest.mark.parametrize("name", ["so(3,2)", "sl(3,R)", "su(2,1)", "sl(2,H)"])
def test_dense_bases(name: str) -> None:
    check(in_dense_basis(lh.simple(name), 0), lh.RealForm.of_name(name).real_rank)


def test_rational_forms_over_a_number_field() -> None:
    check(orthogonal(1, 1, -3).over(lh.number_field("sqrt(3)")), 1)


def test_split_part_of_a_torus() -> None:
    g = lh.so(3, 1)
    torus = g.field.matrix([[1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 1]])  # a rotation, and a boost that commutes with it
    assert split_part(g, torus).to_strings() == [["0", "0", "0", "0", "0", "1"]]
    assert split_part(g, torus.select(rows=[0])).nrows == 0


def test_eigenvalues_outside_the_field_and_nilpotent_elements() -> None:
    g = lh.sl(2)
    assert eigenvalues(g, g.field.matrix([[1, 2, 0]])) is None  # sqrt(8)
    assert eigenvalues(g, g.field.matrix([[1, -1, 0]])) is None  # imaginary
    assert eigenvalues(g, g.field.matrix([[1, 0, 0]])) is None  # nilpotent
