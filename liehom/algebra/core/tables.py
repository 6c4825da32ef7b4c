"""From what a user writes to a bracket table: arrays, sparse arrays, mappings; antisymmetry is proved here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from numbers import Integral
from typing import Any

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import FieldError, ParseError, ShapeError, StructureError, shown
from liehom.scalars import QQ, RR, AlgebraicNumber, Field, common_field, number_field
from liehom.scalars.fields import grammar


def field_of_values(values: Iterable[Any]) -> Field:
    """The field that a collection of values calls for: QQ, a number field, or float64 if a float occurs.

    Examples
    --------
    >>> field_of_values([1, "1/2"]), field_of_values(["sqrt(2)"]), field_of_values([0.5])
    (QQ, QQ(sqrt(2)), float64)
    """
    texts: list[str] = []
    others: dict[str, Any] = {}
    for value in values:
        if isinstance(value, (float, np.floating)) or getattr(value, "is_Float", False):
            return RR
        if isinstance(value, AlgebraicNumber):
            return value.field
        if hasattr(value, "free_symbols") and not _is_radical_text(str(value)):
            # A sympy number beyond square roots: its own field; several of them need `field`.
            others = {str(value): value, **others}
        elif isinstance(value, str) or hasattr(value, "free_symbols"):
            texts.append(str(value))
    if not others:
        return common_field(texts)
    if len(others) > 1 or common_field(texts) != QQ:
        raise FieldError(f"the values {', '.join(others)} need a common field: give it, made by liehom.number_field")
    return number_field(next(iter(others.values())))


def _is_radical_text(text: str) -> bool:
    try:
        grammar.parse(text)
    except ParseError:
        return False
    return True


def field_of_constants(constants: Any) -> Field:
    """The field that structure constants in any accepted form call for."""
    if isinstance(constants, Mapping):
        return field_of_values(v for row in constants.values() if isinstance(row, Mapping) for v in row.values())
    if hasattr(constants, "tocoo"):
        return field_of_values(constants.data[:1])
    array = _array(constants)
    if array.dtype.kind in "iu" or (array.size == 0 and not isinstance(constants, np.ndarray)):
        return QQ
    return RR if array.dtype.kind == "f" else field_of_values(array.ravel().tolist())


def constants_from(constants: Any, field: Field, dimension: int | None) -> StructureConstants:
    """The bracket table that an array, sparse array or mapping describes.

    Raises
    ------
    StructureError
        Naming the indices out of range, or where antisymmetry fails.
    """
    if isinstance(constants, Mapping):
        n, given = _from_mapping(constants, field, dimension)
    elif hasattr(constants, "tocoo"):
        n, given = _from_sparse(constants, field)
    else:
        n, given = _from_array(constants, field)
    if dimension is not None and dimension != n:
        raise ShapeError(f"the constants have dimension {n}, not {dimension}")
    return StructureConstants(field, n, _antisymmetric(given, field))


Given = dict[tuple[int, int, int], Any]


def _from_mapping(constants: Any, field: Field, dimension: int | None) -> tuple[int, Given]:
    for pair, row in constants.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            raise StructureError(f"{pair!r}: {row!r} is no bracket; write {{(i, j): {{k: value}}}}")
        if not all(isinstance(x, (int, np.integer, Integral)) for x in (*pair, *row)):  # the first two: quickly
            raise StructureError(f"the indices of {pair!r}: {dict(row)!r} are not all integers")
    largest = max((int(x) for (i, j), row in constants.items() for x in (i, j, *row)), default=-1)
    n: Any = largest + 1 if dimension is None else dimension
    if not isinstance(n, Integral) or n < 0:
        raise ShapeError(f"the dimension is {n!r}, expected an integer that is not negative")
    n = int(n)
    given: Given = {}
    for (i, j), row in constants.items():
        for k, value in row.items():
            if not all(0 <= x < n for x in (i, j, k)):
                raise StructureError(f"index out of range in c[{i}, {j}, {k}]: indices run from 0 to {n - 1}")
            given[int(i), int(j), int(k)] = field.convert(value)
    for i, j in list(constants):
        # A pair given in one order only is filled in by antisymmetry.
        if (j, i) not in constants and i != j:
            for k in constants[i, j]:
                given[int(j), int(i), int(k)] = -given[int(i), int(j), int(k)]
    return n, given


def _from_sparse(constants: Any, field: Field) -> tuple[int, Given]:
    table = constants.tocoo()
    n = int(table.shape[-1])
    if table.shape != (n * n, n):
        raise ShapeError(f"a sparse table has shape (n*n, n), got {table.shape}")
    given: Given = {}
    for row, k, value in zip(table.row.tolist(), table.col.tolist(), table.data.tolist(), strict=True):
        place = (*divmod(row, n), k)
        given[place] = given.get(place, field.zero) + field.convert(value)
    return n, given


def _from_array(constants: Any, field: Field) -> tuple[int, Given]:
    array = _array(constants)
    n = array.shape[0]
    if array.shape == (0,):
        return 0, {}
    if array.shape != (n, n, n):
        raise ShapeError(f"structure constants have shape (n, n, n), got {array.shape}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        i, j, k = np.argwhere(~np.isfinite(array))[0].tolist()
        raise StructureError(f"c[{i}, {j}, {k}] is {array[i, j, k]}, expected a finite number")
    places = np.argwhere(array != 0) if array.dtype.kind in "iuf" else np.argwhere(np.ones(array.shape, dtype=bool))
    given: Given = {}
    for i, j, k in places.tolist():
        value = field.convert(array[i, j, k])
        if value != 0:
            given[i, j, k] = value
    return n, given


def _array(constants: Any) -> Any:
    """Nested lists, or an array of numpy or sympy, as a numpy array that is no number."""
    try:
        array = np.asarray(constants)
    except ValueError:
        raise ShapeError("structure constants have shape (n, n, n); these lists are not of equal lengths") from None
    if array.ndim == 0:
        raise StructureError(
            f"{constants!r} are no structure constants; write {{(i, j): {{k: value}}}} or an array of shape (n, n, n)"
        )
    return array


def _antisymmetric(given: Given, field: Field) -> Iterator[tuple[int, int, int, Any]]:
    bound = getattr(field, "rtol", 0.0) * max((abs(v) for v in given.values()), default=0.0) if not field.exact else 0
    for (i, j, k), value in given.items():
        defect = value + given.get((j, i, k), field.zero)
        if (defect != 0) if field.exact else (abs(defect) > bound):
            other = shown(field.format(given.get((j, i, k), field.zero)))
            raise StructureError(
                f"the bracket is not antisymmetric: c[{i}, {j}, {k}] = {shown(field.format(value))} but "
                f"c[{j}, {i}, {k}] = {other}, expected {shown(field.format(-value)) if i != j else '0'}"
            )
        if i < j and value != 0:
            yield i, j, k, value
