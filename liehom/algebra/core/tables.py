"""Bracket tables from arrays, sparse arrays and mappings, with a proof of antisymmetry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from numbers import Integral
from typing import Any, NoReturn, Protocol, TypeAlias, TypeGuard

import numpy as np
import numpy.typing as npt

from liehom.algebra.core.names import NamedConstants
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.budget import within
from liehom.errors import FieldError, ParseError, ShapeError, StructureError, displayed, shown
from liehom.scalars import QQ, RR, AlgebraicNumber, Field, FloatField, Scalar, common_field, number_field
from liehom.scalars.fields import grammar
from liehom.scalars.fields.floating import norm_of
from liehom.typing import Array, ScalarLike, VectorLike


class SparseArray(Protocol):
    """A sparse array of scipy, or any array with its coordinate format."""

    @property
    def data(self) -> Any:
        """The stored entries."""
        ...

    def tocoo(self) -> Any:
        """The array in coordinate format."""
        ...


ConstantsMapping: TypeAlias = Mapping[tuple[int, int], Mapping[int, ScalarLike]]
"""Structure constants as ``{(i, j): {k: value}}``."""

ConstantsLike: TypeAlias = (
    StructureConstants
    | ConstantsMapping
    | NamedConstants
    | Sequence[Sequence[VectorLike]]
    | npt.NDArray[Any]
    | SparseArray
)
"""What `LieAlgebra` reads as structure constants."""

Entries = dict[tuple[int, int, int], Scalar]
PARAMETERS = (
    "structure constants with parameters are those of liehom.LieAlgebraFamily, whose method at(a=2) gives a Lie algebra"
)


def field_of_values(values: Iterable[ScalarLike]) -> Field:
    """The field that a collection of values calls for: QQ, a number field, or float64 if a float occurs.

    Examples
    --------
    >>> field_of_values([1, "1/2"]), field_of_values(["sqrt(2)"]), field_of_values([0.5])
    (QQ, QQ(sqrt(2)), float64)
    """
    strings: list[str] = []
    others: dict[str, ScalarLike] = {}
    for value in values:
        if isinstance(value, (float, np.floating)) or getattr(value, "is_Float", False):
            return RR
        if isinstance(value, AlgebraicNumber):
            return value.field
        if getattr(value, "free_symbols", None):
            raise FieldError(f"{value} has free symbols: {PARAMETERS}")
        if hasattr(value, "free_symbols") and not _is_radical(str(value)):
            # A sympy number that the grammar does not write needs a field of its own, so there can be only one.
            others = {str(value): value, **others}
        elif isinstance(value, str) or hasattr(value, "free_symbols"):
            strings.append(str(value))
    if not others:
        return common_field(strings)
    if len(others) > 1 or common_field(strings) != QQ:
        raise FieldError(f"the values {', '.join(others)} need a common field: give it, made by liehom.number_field")
    return number_field(next(iter(others.values())))


def _is_radical(expression: str) -> bool:
    try:
        grammar.parse(expression)
    except ParseError:
        return False
    return True


def field_of_constants(constants: ConstantsLike) -> Field:
    """The field that structure constants in any accepted form call for."""
    if isinstance(constants, Mapping):
        return field_of_values(v for row in constants.values() if isinstance(row, Mapping) for v in row.values())
    if _is_sparse(constants):
        return field_of_values(constants.data[:1])
    array = _array(constants)
    if array.dtype.kind in "iu" or (array.size == 0 and not isinstance(constants, np.ndarray)):
        return QQ
    return RR if array.dtype.kind == "f" else field_of_values(array.ravel().tolist())


def _is_sparse(constants: object) -> TypeGuard[SparseArray]:
    return hasattr(constants, "tocoo")


def constants_from(constants: ConstantsLike, field: Field, dimension: int | None) -> StructureConstants:
    """The bracket table that an array, sparse array or mapping describes.

    Raises
    ------
    StructureError
        If an index is out of range or antisymmetry fails; names the indices.
    """
    if isinstance(constants, Mapping):
        n, given = _from_mapping(constants, field, dimension)
    elif _is_sparse(constants):
        n, given = _from_sparse(constants, field)
    else:
        array = _cubic(constants)
        n = len(array)
        _require_dimension(n, dimension)
        if isinstance(field, FloatField) and array.dtype.kind in "iuf":
            return _from_numbers(array.astype(np.float64), field)
        given = _from_array(array, field)
    _require_dimension(n, dimension)
    return StructureConstants(field, n, _antisymmetric(given, field))


def _require_dimension(found: int, expected: int | None) -> None:
    if expected is not None and expected != found:
        raise ShapeError(f"the constants have dimension {found}, not {expected}")


def _from_mapping(constants: Mapping[Any, Any], field: Field, dimension: int | None) -> tuple[int, Entries]:
    for pair, row in constants.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            raise StructureError(
                f"{displayed(pair)}: {displayed(row)} is not a bracket; write {{(i, j): {{k: value}}}}"
            )
        if not all(isinstance(x, (int, np.integer, Integral)) for x in (*pair, *row)):  # the first two: quickly
            raise StructureError(f"the indices of {displayed(pair)}: {displayed(dict(row))} are not all integers")
    largest = max((int(x) for (i, j), row in constants.items() for x in (i, j, *row)), default=-1)
    n: Any = largest + 1 if dimension is None else dimension
    if not isinstance(n, Integral) or n < 0:
        raise ShapeError(f"the dimension is {displayed(n)}, expected an integer that is not negative")
    n = int(n)
    within("dimension", n, "the algebra has dimension {}")
    given: Entries = {}
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


def _from_sparse(constants: SparseArray, field: Field) -> tuple[int, Entries]:
    table = constants.tocoo()
    n = int(table.shape[-1])
    if table.shape != (n * n, n):
        raise ShapeError(f"a sparse table has shape (n*n, n), got {table.shape}")
    given: Entries = {}
    for row, k, value in zip(table.row.tolist(), table.col.tolist(), table.data.tolist(), strict=True):
        index = (*divmod(row, n), k)
        given[index] = given.get(index, field.zero) + field.convert(value)
    return n, given


def _cubic(constants: ConstantsLike) -> npt.NDArray[Any]:
    """Structure constants as an array of shape (n, n, n) with finite entries."""
    array = _array(constants)
    n = array.shape[0]
    if array.shape == (0,):
        return array.reshape(0, 0, 0)
    if array.shape != (n, n, n):
        raise ShapeError(f"structure constants have shape (n, n, n), got {array.shape}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        i, j, k = np.argwhere(~np.isfinite(array))[0].tolist()
        raise StructureError(f"c[{i}, {j}, {k}] is {array[i, j, k]}, expected a finite number")
    return array


def _from_numbers(array: Array, field: FloatField) -> StructureConstants:
    """The table over floats, if the norm of the symmetric part is within the uncertainty of the array."""
    defect = array + array.transpose(1, 0, 2)
    if norm_of(defect) > 2 * field.rtol * norm_of(array):
        i, j, k = np.unravel_index(int(np.abs(defect).argmax()), array.shape)
        _not_antisymmetric(field, (int(i), int(j), int(k)), array[i, j, k], array[j, i, k])
    return StructureConstants.from_array(field, array)


def _from_array(array: npt.NDArray[Any], field: Field) -> Entries:
    indices = np.argwhere(array != 0) if array.dtype.kind in "iuf" else np.argwhere(np.ones(array.shape, dtype=bool))
    given: Entries = {}
    for i, j, k in indices.tolist():
        value = field.convert(array[i, j, k])
        if value != 0:
            given[i, j, k] = value
    return given


def _array(constants: ConstantsLike) -> npt.NDArray[Any]:
    """Nested lists, or an array of numpy or sympy, as a numpy array with at least one axis."""
    try:
        array = np.asarray(constants)
    except ValueError:
        raise ShapeError("structure constants have shape (n, n, n); these lists are not of equal lengths") from None
    except RecursionError:
        raise ShapeError("structure constants have shape (n, n, n); these lists are nested too deeply") from None
    if array.ndim == 0:
        raise StructureError(
            f"{displayed(constants)} is not a table of structure constants; write "
            f"{{(i, j): {{k: value}}}} or an array of shape "
            "(n, n, n)"
        )
    return array


def _antisymmetric(given: Entries, field: Field) -> Iterator[tuple[int, int, int, Scalar]]:
    """The non-zero entries (i, j, k, value) with i < j; `StructureError` if c[i, j, k] + c[j, i, k] is not 0.

    Over floats the norm of all these sums is compared with the uncertainty of the table.
    """
    zero = field.zero
    failing = next(((x for x, v in given.items() if v + given.get((x[1], x[0], x[2]), zero) != 0)), None)
    if failing is not None and isinstance(field, FloatField):
        indices = list(given)
        defects = np.array([float(given[i, j, k] + given.get((j, i, k), zero)) for i, j, k in indices])
        within = norm_of(defects) <= 2 * field.rtol * norm_of(np.array([float(v) for v in given.values()]))
        failing = None if within else indices[int(np.abs(defects).argmax())]
    if failing is not None:
        i, j, k = failing
        _not_antisymmetric(field, failing, given[failing], given.get((j, i, k), zero))
    for (i, j, k), value in given.items():
        if i < j and value != 0:
            yield i, j, k, value


def _not_antisymmetric(field: Field, indices: tuple[int, int, int], value: Scalar, other: Scalar) -> NoReturn:
    i, j, k = indices
    found = f"the bracket is not antisymmetric: c[{i}, {j}, {k}] = {shown(field.show(value))}"
    if i == j:
        raise StructureError(f"{found} is the coefficient of e{k} in [e{i}, e{i}], expected 0: [x, x] = 0 for every x")
    there = f"c[{j}, {i}, {k}] = {shown(field.show(other))}"
    raise StructureError(f"{found} but {there}, expected {shown(field.show(-value))}")
