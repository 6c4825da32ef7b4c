"""Format of an algebra file: dimension and structure constants [i, j, k, value] with i < j.

A pair file has the same keys for its algebra, and its reader uses the functions below.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np

from liehom.algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.budget import within
from liehom.errors import FormatError
from liehom.io.json_reader import as_list, check_header, check_keys, is_float64, kind_of, shown
from liehom.io.number_lists import RawList, field_for, write_field, write_number
from liehom.scalars import ExactField, Field
from liehom.typing import IntegerArray

FORMAT = "liehom-algebra"
REQUIRED = ("dimension", "structure_constants")
OPTIONAL = ("format", "version", "name", "basis", "field", "arithmetic", "tolerance")
MAX_NAME = 100
"""Characters of the longest name."""


def read_algebra(data: Mapping[str, Any]) -> LieAlgebra:
    """Lie algebra that a parsed JSON object describes, after a proof of the axioms.

    Raises
    ------
    FormatError, ParseError
        If the object is malformed; names the key and the index.
    JacobiError
        If the brackets are not those of a Lie algebra.

    Examples
    --------
    >>> read_algebra({"dimension": 2, "structure_constants": [[0, 1, 1, "1"]], "name": "aff(1)"})
    <Lie algebra aff(1) of dimension 2 over QQ>
    """
    check_header(data, FORMAT)
    check_keys(data, REQUIRED, OPTIONAL, "an algebra file")
    numerical = is_float64(data)
    n = read_dimension(data["dimension"])
    names = read_names(data["basis"], n) if "basis" in data else None
    name = read_name(data["name"], "name") if "name" in data else None
    index, constants = read_entries(data["structure_constants"], n, numerical)
    field = field_for(data, [constants], numerical)
    return LieAlgebra(made_table(field, n, index, constants), basis=names, name=name)


def write_algebra(algebra: LieAlgebra) -> dict[str, Any]:
    """JSON object of an algebra; a name of more than 100 characters is left out.

    Examples
    --------
    >>> import liehom as lh
    >>> write_algebra(lh.heisenberg(1))["structure_constants"]
    [[0, 1, 2, '1']]
    """
    out: dict[str, Any] = {"format": FORMAT, "version": 1}
    if algebra.name and algebra.name.isprintable() and len(algebra.name) <= MAX_NAME:
        out["name"] = algebra.name
    return {**out, **algebra_keys(algebra)}


def algebra_keys(algebra: LieAlgebra) -> dict[str, Any]:
    """Keys of an algebra in every file: its field, dimension, basis names and structure constants."""
    out: dict[str, Any] = {**write_field(algebra.field), "dimension": algebra.dimension}
    if algebra.basis_names != tuple(f"e{i}" for i in range(algebra.dimension)):
        out["basis"] = list(algebra.basis_names)
    field = algebra.field
    out["structure_constants"] = [[i, j, k, write_number(field, v)] for i, j, k, v in algebra.structure_constants()]
    return out


# -- parts of a file ----------------------------------------------------------------------------------------------
def read_dimension(value: object) -> int:
    """Dimension, an integer from 0; `FormatError` if the value is not one, `LimitError` if it is too large."""
    if type(value) is not int or value < 0:
        raise FormatError(f"dimension is {shown(value)}, expected an integer from 0")
    within("dimension", value, "the dimension is {}")
    return value


def read_names(value: object, n: int) -> tuple[str, ...]:
    """Distinct printable names of the n basis elements; `FormatError` if the value is not such a list."""
    names = as_list(value, "basis")
    for i, name in enumerate(names):
        read_name(name, f"basis[{i}]")
    if len(names) != n:
        raise FormatError(f"basis has {len(names)} names, the dimension is {n}")
    if len(set(names)) != n:
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise FormatError(f"basis gives the name {shown(twice)} twice")
    return tuple(names)


def read_name(value: object, what: str) -> str:
    """Printable name; `FormatError` names the key `what` if the value is not one."""
    if not isinstance(value, str) or not value or not value.isprintable() or len(value) > MAX_NAME:
        raise FormatError(f"{what} is {shown(value)}, expected a printable name of 1 to {MAX_NAME} characters")
    return value


Index: TypeAlias = tuple[IntegerArray, IntegerArray, IntegerArray]
"""The columns i, j, k of structure constants."""


def read_entries(value: object, n: int, floats: bool) -> tuple[Index, RawList]:
    """Columns i, j, k of the structure constants as arrays, and their values."""
    entries = as_list(value, "structure_constants")
    within("entries", len(entries), "there are {} structure constants")
    if not entries:
        empty = np.zeros(0, dtype=np.int64)
        return (empty, empty, empty), RawList.checked((), str)
    if not set(map(type, entries)) <= {list, tuple} or set(map(len, entries)) != {4}:
        _refuse_entry(entries, n)
    i, j, k, values = zip(*entries, strict=True)
    if set(map(type, i)) | set(map(type, j)) | set(map(type, k)) != {int}:
        _refuse_entry(entries, n)
    if min(i) < 0 or max(i) >= n or min(j) < 0 or max(j) >= n or min(k) < 0 or max(k) >= n:
        _refuse_entry(entries, n)
    index = (np.array(i, dtype=np.int64), np.array(j, dtype=np.int64), np.array(k, dtype=np.int64))
    if (index[0] >= index[1]).any():
        _refuse_entry(entries, n)
    flat = (index[0] * n + index[1]) * n + index[2]
    if len(np.unique(flat)) < len(flat):
        _refuse_duplicate(entries)
    return index, RawList.checked(values, lambda x: _position(entries, x), floats=floats)


def _position(entries: list[Any], x: int) -> str:
    i, j, k = entries[x][:3]
    return f"the value of structure_constants[{x}] (i, j, k = {i}, {j}, {k})"


def _refuse_entry(entries: list[Any], n: int) -> None:
    """Raise for the first entry that is not [i, j, k, value] with 0 <= i < j < n and 0 <= k < n."""
    for x, entry in enumerate(entries):
        position = f"structure_constants[{x}]"
        if not isinstance(entry, (list, tuple)):
            raise FormatError(f"{position} is {kind_of(entry)}, expected [i, j, k, value]")
        if len(entry) != 4:
            raise FormatError(f"{position} has {len(entry)} items, expected [i, j, k, value]")
        for name, index in zip("ijk", entry[:3], strict=True):
            if type(index) is not int:
                raise FormatError(f"{position}: the index {name} is {shown(index)}, expected an integer")
            if not 0 <= index < n:
                raise FormatError(
                    f"{position}: the index {name} = {shown(index)} is out of range, expected 0 to {n - 1}"
                )
        if entry[0] >= entry[1]:
            raise FormatError(
                f"{position} has i = {entry[0]} and j = {entry[1]}: only i < j is listed, "
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


def made_table(field: Field, n: int, index: Index, values: RawList) -> StructureConstants:
    """Structure constants from indices and values; zero values are dropped."""
    if isinstance(field, ExactField):
        integers = values.integers()
        if integers is not None:
            return StructureConstants.from_integers(field, n, *index, integers)
    numbers = values.numbers(field)
    columns = zip(*(column.tolist() for column in index), numbers, strict=True)
    return StructureConstants(field, n, [entry for entry in columns if entry[3] != 0])
