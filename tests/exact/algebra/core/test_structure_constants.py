"""Sparse contractions of a table, which large algebras use, are those of one dense product."""

import pytest

import liehom as lh
from liehom.exact.algebra.core import structure_constants


@pytest.mark.parametrize("field", [lh.QQ, lh.number_field("sqrt(2)")], ids=str)
def test_sparse_contractions_are_the_dense_ones(field: lh.scalars.Field, monkeypatch: pytest.MonkeyPatch) -> None:
    table = lh.gl(2).over(field).change_of_basis([[1, 2, 0, 0], [0, 1, 0, 3], [0, 0, 1, 1], [0, 0, 0, 1]]).table
    root = field.convert("sqrt(2)") if field.degree > 1 else field.convert(5)
    x = field.matrix([[1, -2, 0, root]])
    left = field.matrix([[0, 1, 0, 2], [root, 0, 0, 1], [1, 1, 1, 1]])
    right = field.matrix([[1, 0, 0, 0], [0, root, 3, 0]])
    out = field.matrix([[1, 0, 2], [0, 1, root], [0, 0, 1], [4, 0, 0]])
    assert table.is_dense()
    dense = table.adjoint(x), table.contract(left, right, out)
    monkeypatch.setattr(structure_constants, "DENSE_DIMENSION", 0)
    monkeypatch.setattr(structure_constants, "LARGEST_DENSE", 0)
    assert not table.is_dense()
    assert (table.adjoint(x), table.contract(left, right, out)) == dense
    column = dense[0] @ right.T  # [x, right_b] in the columns
    assert table.contract(x, right, field.identity(4)) == [column.T]
    assert table.first_nonzero(left, right, out) == dense_first(dense[1])
    assert table.first_nonzero(x, x, out) is None


def dense_first(blocks: list[lh.scalars.ExactMatrix]) -> tuple[int, int] | None:
    """Indices of the first row of the first block that is not zero."""
    rows = enumerate(block.first_nonzero_row() for block in blocks)
    return next(((a, b) for a, b in rows if b is not None), None)
