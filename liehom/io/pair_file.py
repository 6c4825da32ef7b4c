"""The format of a pair: dimension, structure constants [i, j, k, value] with i < j, rows of the subalgebra.

Imports json_text, values, algebra, representations.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from liehom.algebra import LieAlgebra
from liehom.algebra.structure_constants import StructureConstants
from liehom.errors import FormatError
from liehom.io.json_text import as_list, check_header, check_keys, is_float64, kind_of, shown
from liehom.io.values import RawList, field_for, table_of_rows, write_field, write_number
from liehom.representations.pair import Pair
from liehom.scalars import Field

FORMAT = "liehom-pair"
REQUIRED = ("dimension", "structure_constants", "subalgebra")
OPTIONAL = ("format", "version", "basis", "field", "arithmetic")
MAX_DIMENSION = 4096
MAX_NAME = 100


def read_pair(data: Mapping[str, Any]) -> Pair:
    """The pair that a parsed JSON object describes; the axioms are proved.

    Raises
    ------
    FormatError, ParseError, ShapeError
        Naming the key and the index.
    JacobiError, NotASubalgebraError, DependentRowsError
        If it is not a Lie algebra with a subalgebra.

    Examples
    --------
    >>> read_pair({"dimension": 2, "structure_constants": [[0, 1, 1, "1"]], "subalgebra": [["1", "0"]]})
    <pair of dimensions 2/1 over QQ>
    """
    check_header(data, FORMAT)
    check_keys(data, REQUIRED, OPTIONAL, "a pair file")
    numerical = is_float64(data)
    n = read_dimension(data["dimension"])
    names = read_names(data["basis"], n) if "basis" in data else None
    index, constants = _read_entries(data["structure_constants"], n, numerical)
    rows, k, _ = table_of_rows(data["subalgebra"], "subalgebra", n, floats=numerical)
    field = field_for(data, [constants, rows], numerical)
    table = _table(field, n, index, constants)
    basis = rows.matrix(field, k, n)
    algebra = LieAlgebra(table, basis=names)
    return Pair(algebra, algebra.subalgebra(basis))


def read_dimension(value: Any) -> int:
    """A dimension from 0 to `MAX_DIMENSION`, or a `FormatError`."""
    if type(value) is not int or value < 0:
        raise FormatError(f"dimension is {shown(value)}, expected an integer from 0")
    if value > MAX_DIMENSION:
        raise FormatError(f"dimension is {shown(value)}, files go up to {MAX_DIMENSION}")
    return value


def read_names(value: Any, n: int) -> tuple[str, ...]:
    """Distinct printable names of the n basis elements, or a `FormatError`."""
    names = as_list(value, "basis")
    for i, name in enumerate(names):
        if not isinstance(name, str) or not name or not name.isprintable() or len(name) > MAX_NAME:
            raise FormatError(f"basis[{i}] is {shown(name)}, expected a printable name of 1 to {MAX_NAME} characters")
    if len(names) != n:
        raise FormatError(f"basis has {len(names)} names, the dimension is {n}")
    if len(set(names)) != n:
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise FormatError(f"basis gives the name {shown(twice)} twice")
    return tuple(names)


Index = tuple[Any, Any, Any]


def _read_entries(value: Any, n: int, floats: bool) -> tuple[Index, RawList]:
    """The columns i, j, k as arrays, and the values."""
    entries = as_list(value, "structure_constants")
    if not entries:
        empty = np.zeros(0, dtype=np.int64)
        return (empty, empty, empty), RawList.checked((), str)
    if not set(map(type, entries)) <= {list, tuple} or set(map(len, entries)) != {4}:
        _refuse_entry(entries, n)
    i, j, k, values = zip(*entries, strict=True)
    if set(map(type, i)) | set(map(type, j)) | set(map(type, k)) != {int}:
        _refuse_entry(entries, n)
    if min(i) < 0 or max(j) >= n or min(k) < 0 or max(k) >= n:
        _refuse_entry(entries, n)
    index = (np.array(i, dtype=np.int64), np.array(j, dtype=np.int64), np.array(k, dtype=np.int64))
    if (index[0] >= index[1]).any():
        _refuse_entry(entries, n)
    flat = (index[0] * n + index[1]) * n + index[2]
    if len(np.unique(flat)) < len(flat):
        _refuse_duplicate(entries)
    return index, RawList.checked(values, lambda x: _place(entries, x), floats=floats)


def _place(entries: list[Any], x: int) -> str:
    i, j, k = entries[x][:3]
    return f"the value of structure_constants[{x}] (i, j, k = {i}, {j}, {k})"


def _refuse_entry(entries: list[Any], n: int) -> None:
    """Raise for the first entry that is not [i, j, k, value] with 0 <= i < j < n and 0 <= k < n."""
    for x, entry in enumerate(entries):
        place = f"structure_constants[{x}]"
        if not isinstance(entry, (list, tuple)):
            raise FormatError(f"{place} is {kind_of(entry)}, expected [i, j, k, value]")
        if len(entry) != 4:
            raise FormatError(f"{place} has {len(entry)} items, expected [i, j, k, value]")
        for name, index in zip("ijk", entry[:3], strict=True):
            if type(index) is not int:
                raise FormatError(f"{place}: the index {name} is {shown(index)}, expected an integer")
            if not 0 <= index < n:
                raise FormatError(f"{place}: the index {name} = {shown(index)} is out of range, expected 0 to {n - 1}")
        if entry[0] >= entry[1]:
            raise FormatError(
                f"{place} has i = {entry[0]} and j = {entry[1]}: only i < j is listed, "
                "[e_j, e_i] = -[e_i, e_j] is understood"
            )


def _refuse_duplicate(entries: list[Any]) -> None:
    first: dict[tuple[int, int, int], int] = {}
    for x, (i, j, k, _) in enumerate(entries):
        if (i, j, k) in first:
            raise FormatError(
                f"structure_constants[{x}] gives (i, j, k) = ({i}, {j}, {k}) again, after entry {first[i, j, k]}"
            )
        first[i, j, k] = x


def _table(field: Field, n: int, index: Index, values: RawList) -> StructureConstants:
    if field.exact:
        integers = values.integers()
        if integers is not None:
            return StructureConstants.from_integers(field, n, *index, integers)
    numbers = values.numbers(field)
    columns = zip(*(column.tolist() for column in index), numbers, strict=True)
    return StructureConstants(field, n, [entry for entry in columns if entry[3] != 0])


def write_pair(pair: Pair) -> dict[str, Any]:
    """The JSON object of a pair.

    Examples
    --------
    >>> import liehom as lh
    >>> so3 = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (0, 2): {1: -1}})
    >>> write_pair(lh.Pair(so3, [[0, 0, 1]]))["structure_constants"]
    [[0, 1, 2, '1'], [0, 2, 1, '-1'], [1, 2, 0, '1']]
    """
    field, algebra = pair.field, pair.algebra
    out: dict[str, Any] = {"format": FORMAT, "version": 1, **write_field(field), "dimension": algebra.dimension}
    if algebra.basis_names != tuple(f"e{i}" for i in range(algebra.dimension)):
        out["basis"] = list(algebra.basis_names)
    out["structure_constants"] = [[i, j, k, write_number(field, v)] for i, j, k, v in algebra.structure_constants()]
    out["subalgebra"] = [[write_number(field, x) for x in row] for row in pair.subalgebra.rows()]
    return out
