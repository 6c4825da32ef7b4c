"""Matrices behave as users of numpy and sympy expect: iteration, len, asarray, sum, products with numbers."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.base.errors import FieldError, ShapeError

ROOT2 = lh.number_field("sqrt(2)")
A = lh.QQ.matrix([[1, "1/2"], [0, 3]])


@pytest.mark.parametrize("matrix", [A, A.T, ROOT2.matrix([["sqrt(2)", 1, 0]]), lh.RR.matrix([[1.0, 2.0]])], ids=repr)
def test_iteration_gives_the_rows(matrix: Any) -> None:
    assert list(matrix) == matrix.to_rows() and len(matrix) == matrix.nrows
    assert [sum(row) for row in matrix] == [sum(row) for row in matrix.to_rows()]
    first, *_ = matrix
    assert first == matrix.row(0)


def test_asarray_holds_exact_numbers() -> None:
    array = np.asarray(lh.so(3).killing_form())
    assert array.shape == (3, 3) and array.dtype == object
    assert (array == -2 * np.eye(3, dtype=int)).all() and all(isinstance(x, type(lh.QQ.one)) for x in array.flat)
    assert np.asarray(A, dtype=float).tolist() == [[1.0, 0.5], [0.0, 3.0]]
    assert np.asarray(A).T.tolist() == A.T.to_rows()
    assert np.array([A, A]).shape == (2, 2, 2)
    assert np.asarray(ROOT2.matrix([["sqrt(2)"]]), dtype=float) == pytest.approx(2**0.5)
    assert np.asarray(lh.RR.matrix([[1.5]])).dtype == np.float64
    assert np.asarray(lh.QQ.zeros(0, 3)).shape == (0, 3)


def test_asarray_with_integers_refuses_fractions() -> None:
    assert np.asarray(2 * A, dtype=int).tolist() == [[2, 1], [0, 6]]
    assert np.asarray(ROOT2.matrix([["sqrt(2)**2", 1]]), dtype=np.int8).tolist() == [[2, 1]]
    for wrong in (A, ROOT2.matrix([["sqrt(2)"]]), lh.QQ.matrix([[10**30]]), lh.QQ.matrix([[300]])):
        with pytest.raises(FieldError, match="not integers that int8 holds"):
            np.asarray(wrong, dtype=np.int8)
    with pytest.raises(ValueError, match="copy"):
        np.asarray(A, copy=False)


def test_an_array_of_floats_is_a_copy() -> None:
    matrix = lh.RR.matrix([[1.0, 2.0]])
    np.asarray(matrix)[0, 0] = 7
    assert matrix[0, 0] == 1


@pytest.mark.parametrize("field", [lh.QQ, ROOT2, lh.RR], ids=repr)
def test_sums_of_matrices(field: Any) -> None:
    one = field.identity(2)
    assert sum([one, one, one]) == one.scale(3)
    assert sum([one]) == one
    with pytest.raises(TypeError):
        one + 1
    with pytest.raises(TypeError):
        1 + one


@pytest.mark.parametrize("two", [2, np.int64(2), Fraction(2), sympy.Integer(2), lh.QQ.convert(2)], ids=repr)
def test_products_with_numbers(two: Any) -> None:
    for matrix in (A, ROOT2.matrix([["sqrt(2)", 1]]), lh.RR.matrix([[1.0, 2.0]])):
        assert two * matrix == matrix * two == matrix + matrix
        assert matrix * two / two == matrix


def test_floats_times_exact_matrices_are_refused_with_the_fraction() -> None:
    for wrong in (0.5, np.float64(0.5)):
        with pytest.raises(FieldError, match="1/2"):
            wrong * A
    assert np.float64(0.5) * lh.RR.identity(1) == lh.RR.matrix([[0.5]])


def test_the_product_of_matrices_is_at() -> None:
    for other in (A, [[1, 2], [3, 4]], np.eye(2), "2"):
        with pytest.raises(TypeError, match="@"):
            A * other
        with pytest.raises(TypeError):
            other * A
    with pytest.raises(TypeError):
        A @ np.eye(2)
    with pytest.raises(TypeError):
        np.eye(2) @ A


def test_matrices_that_do_not_fit_are_refused() -> None:
    """Over two fields the coordinates would be combined as if they were of one: sqrt(2) + sqrt(3) = 2 sqrt(2)."""
    other = lh.number_field("sqrt(3)")
    for wrong in (lambda x, y: x + y, lambda x, y: x - y, lambda x, y: x @ y):
        with pytest.raises(FieldError, match=r"QQ\(sqrt\(2\)\) and QQ\(sqrt\(3\)\)"):
            wrong(ROOT2.matrix([["sqrt(2)"]]), other.matrix([["sqrt(3)"]]))
        with pytest.raises(FieldError):
            wrong(lh.QQ.identity(1), ROOT2.matrix([["sqrt(2)"]]))
        with pytest.raises(ShapeError):
            wrong(lh.QQ.zeros(2, 3), lh.QQ.zeros(2, 2))


def test_a_single_matrix_is_not_a_list_of_matrices() -> None:
    with pytest.raises(lh.InputError):
        lh.LieAlgebra.from_matrices(A)
    with pytest.raises(lh.InputError):
        lh.Representation.from_matrices(A)


def test_structure_constants_from_a_list_of_matrices() -> None:
    g = lh.so(3)
    blocks = [lh.QQ.matrix([g.bracket(x, y) for y in g.field.identity(3)]) for x in g.field.identity(3)]
    assert lh.LieAlgebra(blocks) == g


def test_a_matrix_is_not_equal_to_other_things() -> None:
    assert (lh.QQ.identity(1) == "1") is False and (lh.QQ.identity(1) != "1") is True
