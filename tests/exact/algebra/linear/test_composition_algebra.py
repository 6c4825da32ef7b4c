"""Composition algebras: the norm is multiplicative, and multiplications are what the table says."""

import numpy as np
import pytest

from liehom.exact.algebra import linear as mf

ALGEBRAS = [(), (-1,), (2,), (-1, -1), (-1, 3), (-1, -1, -1), (-1, -1, 1), (2, -3, 5)]


@pytest.mark.parametrize("parameters", ALGEBRAS)
def test_cayley_dickson_norm_is_multiplicative(parameters):
    table = mf.cayley_dickson(parameters)
    norm = mf.norm_diagonal(table)
    x, y = np.random.default_rng(5).integers(-9, 10, (2, len(table)))
    assert norm @ np.einsum("i,j,ijk->k", x, y, table) ** 2 == (norm @ x**2) * (norm @ y**2)
    assert np.array_equal(table[0], np.eye(len(table)))
    assert np.array_equal(table[:, 0], np.eye(len(table)))


@pytest.mark.parametrize("parameters", ALGEBRAS)
def test_multiplications_are_the_rows_and_columns_of_the_table(parameters):
    table = mf.cayley_dickson(parameters)
    left, right = mf.left_multiplications(table), mf.right_multiplications(table)
    x, y = np.random.default_rng(6).integers(-9, 10, (2, len(table)))
    product = np.einsum("i,j,ijk->k", x, y, table)
    assert np.array_equal(np.tensordot(x, left, 1) @ y, product)
    assert np.array_equal(np.tensordot(y, right, 1) @ x, product)
