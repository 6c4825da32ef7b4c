"""Malformed bracket tables raise an error of the library that names the fault."""

from typing import Any

import pytest

import liehom as lh
from liehom.errors import InputError, ShapeError, StructureError


@pytest.mark.parametrize(
    "table",
    [
        {("0", 1): {1: 1}},
        {(0, 1): {"1": 1}},
        {"01": {1: 1}},
        {(0, 1.0): {1: 1}},
        {(0, 1, 2): {1: 1}},
        {(0, 1): [0, 1]},
        {(0, 1): 1},
        {3: {1: 1}},
    ],
)
@pytest.mark.parametrize("field", [None, lh.number_field("sqrt(2)")])
@pytest.mark.parametrize("dimension", [None, 2])
def test_malformed_mappings(table: Any, field: Any, dimension: int | None) -> None:
    with pytest.raises(StructureError):
        lh.LieAlgebra(table, field=field, dimension=dimension)


@pytest.mark.parametrize("dimension", [-1, 2.5, "3"])
def test_invalid_dimensions_raise(dimension: Any) -> None:
    with pytest.raises(ShapeError, match="dimension"):
        lh.LieAlgebra({}, dimension=dimension)


def test_a_table_keeps_its_field_and_dimension() -> None:
    table = lh.so(3).table
    assert lh.LieAlgebra(table, field=lh.QQ, dimension=3) == lh.so(3)
    with pytest.raises(InputError, match=r"over\(\)"):
        lh.LieAlgebra(table, field=lh.number_field("sqrt(2)"))
    with pytest.raises(InputError, match="dimension 3"):
        lh.LieAlgebra(table, dimension=4)
