"""Matrices of several copies of a representation, computed when they are asked for, are block matrices."""

import pytest

import liehom as lh
from liehom.exact.representations.core.coordinates import Copies
from liehom.exact.scalars.rational import QQ


def test_copies_are_block_matrices() -> None:
    single = lh.defining(lh.sl(2))
    copies, zero = Copies(single, 3), QQ.zeros(2, 2)
    blocks = [
        [[a if i == j == k else zero for j in range(3)] for i in range(3)] for k in range(3) for a in single.matrices
    ]
    whole = tuple(QQ.stack_rows([QQ.stack_columns(row, 2) for row in rows], 6) for rows in blocks)
    assert (copies.size, len(copies)) == (6, 9) and copies == whole and hash(copies) == hash(whole)
    assert copies[1:7:2] == list(whole[1:7:2]) and copies[-1] == whole[8] and copies[-9] == whole[0]
    for wrong in (9, -10):
        with pytest.raises(IndexError):
            copies[wrong]
    assert {(a, j, i): v for a, j, i, v in copies.entries()} == {
        (a, j, i): m[i, j] for a, m in enumerate(whole) for i in range(6) for j in range(6) if m[i, j] != 0
    }
    assert copies == Copies(single, 3) != Copies(single, 2) and copies != Copies(lh.adjoint(lh.sl(2)), 3)
    assert copies != list(whole)
