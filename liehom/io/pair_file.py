"""Formats of a pair and of a subalgebra: dimension, structure constants [i, j, k, value] with i < j, rows of h."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.io.algebra_file import FORMAT as ALGEBRA
from liehom.io.algebra_file import (
    algebra_keys,
    made_table,
    read_dimension,
    read_entries,
    read_name,
    read_names,
    write_algebra,
)
from liehom.io.json_reader import check_header, check_keys, is_float64
from liehom.io.number_lists import field_for, table_of_rows, write_number
from liehom.representations.core.pair import Pair

FORMAT, SUBALGEBRA = "liehom-pair", "liehom-subalgebra"
REQUIRED = ("dimension", "structure_constants", "subalgebra")
OPTIONAL = ("format", "version", "basis", "field", "arithmetic", "tolerance")


def read_pair(data: Mapping[str, Any]) -> Pair:
    """Pair that a parsed JSON object describes, after a proof of the axioms.

    Raises
    ------
    FormatError, ParseError, ShapeError
        If the object is malformed; names the key and the index.
    JacobiError, NotASubalgebraError, DependentRowsError
        If the object does not describe a Lie algebra with a subalgebra.

    Examples
    --------
    >>> read_pair({"dimension": 2, "structure_constants": [[0, 1, 1, "1"]], "subalgebra": [["1", "0"]]})
    <pair of dimensions 2/1 over QQ>
    """
    check_header(data, FORMAT)
    hint = "" if "subalgebra" in data else f' (the file of an algebra alone has "format": "{ALGEBRA}")'
    check_keys(data, REQUIRED, OPTIONAL, f"a pair file{hint}")
    subalgebra = _subalgebra(data)
    return Pair(subalgebra.algebra, subalgebra)


def read_subalgebra(data: Mapping[str, Any]) -> Subalgebra:
    """Subalgebra that a parsed JSON object describes, with its algebra, after a proof of the axioms.

    Raises
    ------
    FormatError, ParseError, ShapeError, JacobiError, NotASubalgebraError, DependentRowsError
        As `read_pair`.

    Examples
    --------
    >>> import liehom as lh
    >>> h = lh.so(3).subalgebra([[0, 0, 1]])
    >>> read_subalgebra(write_subalgebra(h)) == h
    True
    """
    check_header(data, SUBALGEBRA)
    check_keys(data, REQUIRED, (*OPTIONAL, "name"), "a subalgebra file")
    return _subalgebra(data)


def _subalgebra(data: Mapping[str, Any]) -> Subalgebra:
    numerical = is_float64(data)
    n = read_dimension(data["dimension"])
    names = read_names(data["basis"], n) if "basis" in data else None
    name = read_name(data["name"], "name") if "name" in data else None
    index, constants = read_entries(data["structure_constants"], n, numerical)
    rows, k, _ = table_of_rows(data["subalgebra"], "subalgebra", n, floats=numerical)
    field = field_for(data, [constants, rows], numerical)
    table = made_table(field, n, index, constants)
    return LieAlgebra(table, basis=names, name=name).subalgebra(rows.matrix(field, k, n))


def write_pair(pair: Pair) -> dict[str, Any]:
    """JSON object of a pair.

    Examples
    --------
    >>> import liehom as lh
    >>> so3 = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}})
    >>> write_pair(lh.Pair(so3, [[0, 0, 1]]))["structure_constants"]
    [[0, 1, 2, '1'], [0, 2, 1, '-1'], [1, 2, 0, '1']]
    """
    return {"format": FORMAT, "version": 1, **algebra_keys(pair.algebra), **_rows(pair.subalgebra)}


def write_subalgebra(subalgebra: Subalgebra) -> dict[str, Any]:
    """JSON object of a subalgebra, with its algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> write_subalgebra(lh.heisenberg(1).center())["subalgebra"]
    [['0', '0', '1']]
    """
    algebra = write_algebra(subalgebra.algebra)
    return {**algebra, "format": SUBALGEBRA, **_rows(subalgebra)}


def _rows(subalgebra: Subalgebra) -> dict[str, Any]:
    field = subalgebra.algebra.field
    return {"subalgebra": [[write_number(field, x) for x in row] for row in subalgebra.rows()]}
