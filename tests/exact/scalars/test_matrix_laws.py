"""Laws of exact linear algebra over QQ and QQ(a), with dependent rows, huge numbers and unlucky primes."""

import random
from typing import Any

import flint
import numpy as np
import pytest
from hypothesis import given, strategies as st

from liehom.base.errors import FieldError, ShapeError, SingularError
from liehom.exact.algebra.core.subalgebra import independent_rows as rows_of_subalgebras
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.lattices import balancing_rows, fixed_point, lattice_reduction, power_of_two
from liehom.exact.scalars.modular import independent_columns, independent_rows, primitive_residues
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.sparse import SparseInteger
from liehom.exact.scalars.subspaces import orthogonal_basis, quotient
from liehom.testing import random_unimodular

MERSENNE = 2**61 - 1
ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
CUBIC = NumberField("a", [-3, 0, 0, 2], (1, 2))  # 2 a^3 = 3, the generator is no algebraic integer
FIELDS = [QQ, ROOT2, CUBIC]
ENTRIES = st.sampled_from([0, 0, 0, 1, -1, 2, 3, "1/2", "-2/3", MERSENNE, 10**40, f"1/{MERSENNE}"])


@st.composite
def matrices(draw: st.DrawFn, field: Any, nrows: int | None = None, ncols: int | None = None) -> Any:
    r = draw(st.integers(0, 5)) if nrows is None else nrows
    c = draw(st.integers(0, 5)) if ncols is None else ncols
    built = field.zeros(r, c)
    power = field.one
    for _ in range(field.degree):
        rows = draw(st.lists(st.lists(ENTRIES, min_size=c, max_size=c), min_size=r, max_size=r))
        built = built + field.matrix(rows, (r, c)).scale(power)
        power = power * (field.generator if field.degree > 1 else 1)
    if draw(st.booleans()) and r > 1:  # a dependent row
        rows = built.to_rows()
        rows[-1] = [x + 2 * y for x, y in zip(rows[0], rows[-2], strict=True)]
        built = field.matrix(rows, (r, c))
    return built


fields = st.sampled_from(FIELDS)


@given(data=st.data(), field=fields)
def test_rank_plus_nullity_is_the_number_of_columns(data: st.DataObject, field: Any) -> None:
    a = data.draw(matrices(field))
    kernel, left = a.null_space(), a.left_null_space()
    assert a.rank() + kernel.nrows == a.ncols and a.rank() + left.nrows == a.nrows
    assert (a @ kernel.T).is_zero() and (left @ a).is_zero()
    assert kernel.rank() == kernel.nrows and left.rank() == left.nrows
    assert a.T.rank() == a.rank()
    basis = a.row_space()
    assert basis.nrows == a.rank() == field.stack_rows([basis, a], a.ncols).rank()


@given(data=st.data(), field=fields)
def test_solution_satisfies_the_system(data: st.DataObject, field: Any) -> None:
    a = data.draw(matrices(field))
    x = data.draw(matrices(field, a.ncols, 2))
    assert a @ a.solve(a @ x) == a @ x
    left = a.left_null_space()
    if left.nrows:
        with pytest.raises(SingularError):
            a.solve(left.select(rows=[0]).T)  # not orthogonal to itself: real numbers
    with pytest.raises(ShapeError):
        a.solve(field.zeros(a.nrows + 1, 1))


@given(data=st.data(), field=fields)
def test_inverse_exists_if_and_only_if_the_determinant_is_not_zero(data: st.DataObject, field: Any) -> None:
    n = data.draw(st.integers(0, 4))
    a, b = data.draw(matrices(field, n, n)), data.draw(matrices(field, n, n))
    assert (a @ b).determinant() == a.determinant() * b.determinant()
    if a.rank() == n:
        assert a @ a.inverse() == field.identity(n) == a.inverse() @ a
        assert a.inverse().determinant() * a.determinant() == 1
    else:
        assert a.determinant() == 0
        with pytest.raises(SingularError):
            a.inverse()


@given(data=st.data(), field=fields)
def test_matrix_is_a_zero_of_its_characteristic_polynomial(data: st.DataObject, field: Any) -> None:
    """Cayley-Hamilton, the trace, and similarity."""
    n = data.draw(st.integers(1, 4))
    a, b = data.draw(matrices(field, n, n)), data.draw(matrices(field, n, n))
    coefficients = a.characteristic_coefficients()
    total = field.zeros(n, n)
    for c in reversed(coefficients):
        total = total @ a + field.identity(n).scale(c)
    assert total.is_zero() and coefficients[n] == 1 and coefficients[n - 1] == -a.trace()
    if b.rank() == n:
        assert (b.inverse() @ a @ b).characteristic_coefficients() == coefficients


@given(data=st.data(), field=fields)
def test_matrix_products_are_associative_and_distributive(data: st.DataObject, field: Any) -> None:
    a, b, c = (data.draw(matrices(field, 3, 3)) for _ in range(3))
    assert (a @ b) @ c == a @ (b @ c) and a @ (b + c) == a @ b + a @ c and (a @ b).T == b.T @ a.T
    assert (a - a).is_zero() and a.scale("2/3").scale("3/2") == a


@given(data=st.data(), field=fields)
def test_signature_counts_the_signs_of_an_orthogonal_basis(data: st.DataObject, field: Any) -> None:
    """Sylvester: T^T D T has the signs of D; orthogonal bases show them."""
    n = data.draw(st.integers(1, 4))
    signs = data.draw(st.lists(st.sampled_from([-1, 0, 1]), min_size=n, max_size=n))
    change = data.draw(matrices(field, n, n))
    diagonal = field.matrix([[s if i == j else 0 for j in range(n)] for i, s in enumerate(signs)])
    form = change.T @ diagonal @ change
    rows, values = orthogonal_basis(form)
    basis = field.stack_rows(rows, n)
    assert basis.rank() == n
    assert basis @ form @ basis.T == field.matrix([[values[i] if i == j else 0 for j in range(n)] for i in range(n)])
    result = [field.sign(v) for v in values]
    assert form.signature() == (result.count(1), result.count(-1), result.count(0))
    if change.rank() == n:
        assert form.signature() == (signs.count(1), signs.count(-1), signs.count(0))


@pytest.mark.parametrize("seed", range(20))
def test_signature_equals_that_of_numpy_eigenvalues(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 9))
    half = rng.integers(-4, 5, (n, n))
    form = half + half.T
    values = np.linalg.eigvalsh(form)
    zero = int((np.abs(values) < 1e-9).sum())
    assert QQ.matrix(form.tolist()).signature() == (int((values > 1e-9).sum()), int((values < -1e-9).sum()), zero)


def test_signature_of_a_nonsymmetric_matrix_raises_field_error() -> None:
    with pytest.raises(FieldError, match="not symmetric"):
        QQ.matrix([[0, 1], [0, 0]]).signature()


# -- modulo primes -----------------------------------------------------------------------------------------
@given(data=st.data(), field=fields)
def test_independent_rows_are_a_basis(data: st.DataObject, field: Any) -> None:
    a = data.draw(matrices(field))
    rows = independent_rows(a)
    assert len(rows) == a.rank() == a.select(rows=rows).rank()
    columns = independent_columns(a)
    assert len(columns) == a.rank() == a.select(columns=columns).rank()
    if a.ncols and not a.select(columns=[0]).is_zero():
        assert columns[0] == 0


def test_ranks_are_exact_if_the_prime_divides_entries() -> None:
    a = QQ.matrix([[MERSENNE, 0], [0, 1]])
    assert int(a.modulo().rank()) == 1 and a.rank() == 2 and independent_rows(a) == [0, 1]
    assert int(primitive_residues([a.select(rows=[0]), a.select(rows=[1])], 2).rank()) == 2
    b = QQ.matrix([[1, 1], [1, 1 + MERSENNE]])
    assert int(b.modulo().rank()) == 1 and independent_columns(b) == [0, 1] and b.rank() == 2
    assert primitive_residues([QQ.zeros(1, 2)], 2).rank() == 0


# -- coordinates on a quotient -----------------------------------------------------------------------------
@given(data=st.data(), field=fields)
def test_quotient_coordinates_vanish_on_the_subspace_only(data: st.DataObject, field: Any) -> None:
    a = data.draw(matrices(field)).row_space()
    n, d = a.ncols, a.ncols - a.nrows
    built = quotient(a)
    assert built.subspace.shape == (n - d, n) and built.lift.shape == (d, n) and built.projection.shape == (n, d)
    assert field.stack_rows([built.subspace, a], n).rank() == n - d
    assert (built.subspace @ built.projection).is_zero() and built.lift @ built.projection == field.identity(d)


def test_quotient_of_a_subspace_in_general_position_has_small_numbers() -> None:
    scrambled = [QQ.matrix(random_unimodular(n, random.Random(n), 8 * n)) for n in (7, 12)]
    basis = scrambled[0] @ scrambled[1].select(rows=range(7))
    built = quotient(basis)
    assert max(max(abs(x.p), x.q) for x in basis.row_space().entries()) > 100
    assert max(max(abs(x.p), x.q) for x in built.projection.entries()) < 20
    assert (built.subspace @ built.projection).is_zero() and built.lift @ built.projection == QQ.identity(5)


# -- sparse integers ---------------------------------------------------------------------------------------
@given(data=st.data())
def test_sparse_products_equal_dense_products(data: st.DataObject) -> None:
    """Against dense products, with entries on both sides of what 64 bits hold."""
    entry = st.sampled_from([0, 0, 0, 1, -1, 3, 2**31, -(2**32), 2**61, -(2**62), 10**30])
    p, q, r = (data.draw(st.integers(1, 4)) for _ in range(3))
    a = QQ.matrix(data.draw(st.lists(st.lists(entry, min_size=q, max_size=q), min_size=p, max_size=p)))
    b = QQ.matrix(data.draw(st.lists(st.lists(entry, min_size=r, max_size=r), min_size=q, max_size=q)))
    assert (SparseInteger.from_matrix(a) @ SparseInteger.from_matrix(b)).dense_blocks(QQ, 1, p, r)[0] == a @ b


# -- fixed point -------------------------------------------------------------------------------------------
@given(data=st.data(), field=fields)
def test_fixed_point_approximates_to_the_given_bits(data: st.DataObject, field: Any) -> None:
    a = data.draw(matrices(field, 2, 3))
    integers, scale = fixed_point(a, 100)
    assert all(x.q == 1 for x in integers.entries())
    size = max((abs(field.to_float(x)) for x in a.entries()), default=0)
    for x, y in zip(a.entries(), integers.scale(scale).entries(), strict=True):
        assert abs(field.to_float(x - field.convert(y))) <= size * 2.0**-95


@given(st.fractions(min_value="1/10000", max_value=10**6))
def test_power_of_two_is_within_a_factor_two(value: Any) -> None:
    power = power_of_two(QQ.convert(value))
    assert QQ.convert(value) / 2 <= power <= QQ.convert(value) * 2
    assert power.p * power.q == flint.fmpz(2) ** (int(power.p * power.q).bit_length() - 1)


@pytest.mark.parametrize("size", [1, 10**3, 10**30])
def test_balancing_undoes_a_conjugation(size: int) -> None:
    """Matrices conjugated by one of large condition: in the basis of the rows they are as small as before."""
    maps = [QQ.matrix([[0, -1, 0], [1, 0, 1], [0, 2, 0]]), QQ.matrix([[1, 0, 2], [0, -1, 1], [1, 1, 0]])]
    change = QQ.matrix([[1, size, size * size], [0, 1, size + 1], [1, 0, 1]])
    moved = [(change.inverse() @ m @ change) for m in maps]
    integers, _ = fixed_point(QQ.stack_rows(moved, 3), 1000)
    rows = balancing_rows([integers.select(rows=range(3 * i, 3 * i + 3)) for i in range(2)], 1000)
    assert rows is not None
    for m in moved:
        assert np.abs((rows.T.inverse() @ m @ rows.T).to_numpy()).max() < 10


def test_balancing_without_enough_bits_is_none() -> None:
    change = QQ.matrix([[1, 10**60], [0, 1]])
    maps = [change.inverse() @ QQ.matrix(m) @ change for m in ([[0, -1], [1, 0]], [[1, 0], [0, -1]])]
    assert balancing_rows([fixed_point(m, 64)[0] for m in maps], 64) is None
    assert balancing_rows([fixed_point(m, 1000)[0] for m in maps], 1000) is not None
    assert balancing_rows([QQ.zeros(2, 2)], 64) is None


def test_lattice_reduction_shortens_rows() -> None:
    rows = QQ.matrix([[1, 0, 0], [10**20, 1, 0], [1, 10**25, "1/1000"]])
    assert np.linalg.cond((lattice_reduction(rows, 300) @ rows).to_numpy()) < 10


def test_independent_rows_over_floats_and_exact_numbers() -> None:
    rows = [[0, 0, 0], [1, 2, 0], [2, 4, 0], [0, 0, 3], [1, 2, 3], [0, 1, 0]]
    floats = RR.matrix([[float(x) for x in row] for row in rows])
    assert rows_of_subalgebras(QQ.matrix(rows)) == rows_of_subalgebras(floats) == [1, 3, 5]
