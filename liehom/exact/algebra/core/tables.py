"""Bracket tables from arrays, mappings and names of basis elements, with a proof of antisymmetry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from numbers import Integral
from typing import Any, NoReturn, Protocol, TypeAlias, TypeGuard

import numpy as np
import numpy.typing as npt

from liehom.base.budget import within
from liehom.base.errors import FieldError, InputError, ParseError, ShapeError, StructureError, displayed, shown
from liehom.base.objects import Typeset
from liehom.base.typing import Array, ElementLike, ScalarLike, VectorLike
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.scalars import grammar
from liehom.exact.scalars.field import Field, MatrixLike, Scalar
from liehom.exact.scalars.floating import RR, FloatField, norm_of
from liehom.exact.scalars.number_fields import AlgebraicNumber, common_field, number_field
from liehom.exact.scalars.rational import QQ

# Brackets and elements by the names of basis elements: {("x", "y"): {"z": 1}}, {"x": 2, "z": -1}, "x".

NamedConstants: TypeAlias = Mapping[tuple[str, str], Mapping[str, ScalarLike]]
"""Structure constants as ``{(name, name): {name: value}}``."""

RowsLike: TypeAlias = MatrixLike | Sequence[ElementLike]
"""Input that a Lie algebra reads as several elements: rows of coefficients, names, {name: coefficient}."""

SHOWN_NAMES = 12


def is_named(constants: object) -> bool:
    """Whether a mapping of brackets has names for basis elements; `StructureError` if some are names, some indices."""
    if not isinstance(constants, Mapping):
        return False
    labels = list(_labels(constants))
    named = [isinstance(x, str) for x in labels]
    if any(named) and not all(named):
        name, index = labels[named.index(True)], labels[named.index(False)]
        raise StructureError(
            "brackets have names or indices for basis elements, not both; got the name "
            f"{displayed(name)} and {displayed(index)}"
        )
    return any(named)


def _labels(constants: Mapping[Any, Any]) -> Iterable[Any]:
    """The basis elements of a mapping of brackets in order of first appearance, perhaps repeated."""
    for pair, row in constants.items():
        if isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping):
            yield from (*pair, *row)
        elif isinstance(pair, str):
            raise no_bracket(pair, row, "('x', 'y'): {'z': value}")


def no_bracket(pair: object, row: object, form: str) -> StructureError:
    """The error for an item of a mapping that is not a bracket of this form."""
    return StructureError(f"{displayed(pair)}: {displayed(row)} is not a bracket; write {{{form}}}")


def by_index(
    constants: Mapping[Any, Any], basis: Sequence[str] | None
) -> tuple[dict[tuple[int, int], dict[int, Any]], tuple[str, ...]]:
    """Brackets by name as brackets by index, and the names: the basis, else in order of first appearance."""
    names = tuple(dict.fromkeys(_labels(constants))) if basis is None else tuple(map(str, basis))
    brackets = {}
    for pair, row in constants.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            raise no_bracket(pair, row, "('x', 'y'): {'z': value}")
        i, j = (index_of(names, x, StructureError) for x in pair)
        brackets[i, j] = {index_of(names, x, StructureError): value for x, value in row.items()}
    return brackets, names


def index_of(names: Sequence[str], name: str, error: type[InputError] = InputError) -> int:
    """The index of a basis element; raises `error` with the nearest names if there is none of this name."""
    if name in names:
        return names.index(name)
    near = get_close_matches(str(name), names, n=3, cutoff=0.4)
    shown = ", ".join(names[:SHOWN_NAMES]) + (", ..." if len(names) > SHOWN_NAMES else "")
    hint = f"the nearest {'is' if len(near) == 1 else 'are'} {', '.join(near)}" if near else f"the names are {shown}"
    raise error(f"no basis element is named {displayed(name)}; {hint}")


def coefficients(names: Sequence[str], x: str | Mapping[str, ScalarLike]) -> list[ScalarLike]:
    """The coefficient vector of a basis element by its name, or of a linear combination {name: coefficient}."""
    vector: list[ScalarLike] = [0] * len(names)
    for name, value in ({x: 1} if isinstance(x, str) else x).items():
        if not isinstance(name, str):
            raise ShapeError(
                f"an element is given by names of basis elements or by a sequence, got the key {displayed(name)}"
            )
        vector[index_of(names, name)] = value
    return vector


def linear_combination(field: Field, names: Sequence[str], values: Iterable[Scalar]) -> list[str]:
    """The terms of a linear combination of names, such as ['x', '-y', '(1 + sqrt(2))*z']."""
    shown = ((name, field.show(v)) for name, v in zip(names, values, strict=True) if v != 0)
    factors = {"1": "", "-1": "-"}
    return [factors.get(value, f"({value})*" if " " in value else f"{value}*") + name for name, value in shown]


class LinearCombination(Typeset, str):
    """String of an element as a linear combination of names, which a notebook shows as a formula."""

    field: Field
    names: Sequence[str]
    values: Sequence[Scalar]

    def __new__(cls, field: Field, names: Sequence[str], values: Sequence[Scalar]) -> LinearCombination:
        text = " + ".join(linear_combination(field, names, values)).replace("+ -", "- ") or "0"
        combination = super().__new__(cls, text)
        combination.field, combination.names, combination.values = field, names, values
        return combination

    def __getnewargs__(self) -> tuple[Field, Sequence[str], Sequence[Scalar]]:  # type: ignore[override]
        return self.field, self.names, self.values


# Bracket tables from arrays, sparse arrays and mappings, with a proof of antisymmetry.


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
    "structure constants with parameters: liehom.algebra.LieAlgebraFamily, whose method at(a=2) gives a Lie algebra"
)


def field_of_values(values: Iterable[ScalarLike]) -> Field:
    """The field that a collection of values calls for: QQ, a number field, or float64 if a float occurs."""
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
    """The bracket table that an array, sparse array or mapping describes."""
    if isinstance(constants, Mapping):
        n, entries = _from_mapping(constants, field, dimension)
    elif _is_sparse(constants):
        n, entries = _from_sparse(constants, field)
    else:
        array = _cubic(constants)
        n = len(array)
        _require_dimension(n, dimension)
        if isinstance(field, FloatField) and array.dtype.kind in "iuf":
            return _from_numbers(array.astype(np.float64), field)
        entries = _from_array(array, field)
    _require_dimension(n, dimension)
    return StructureConstants(field, n, _antisymmetric(entries, field))


def _require_dimension(n: int, expected: int | None) -> None:
    if expected is not None and expected != n:
        raise ShapeError(f"the constants have dimension {n}, not {expected}")


def _from_mapping(constants: Mapping[Any, Any], field: Field, dimension: int | None) -> tuple[int, Entries]:
    for pair, row in constants.items():
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(row, Mapping)):
            raise no_bracket(pair, row, "(i, j): {k: value}")
        if not all(isinstance(x, (int, np.integer, Integral)) for x in (*pair, *row)):  # the first two: quickly
            raise StructureError(f"the indices of {displayed(pair)}: {displayed(dict(row))} are not all integers")
    largest = max((int(x) for (i, j), row in constants.items() for x in (i, j, *row)), default=-1)
    n: Any = largest + 1 if dimension is None else dimension
    if not isinstance(n, Integral) or n < 0:
        raise ShapeError(f"the dimension is {displayed(n)}, expected an integer that is not negative")
    n = int(n)
    within("dimension", n, "the algebra has dimension {}")
    entries: Entries = {}
    for (i, j), row in constants.items():
        for k, value in row.items():
            if not all(0 <= x < n for x in (i, j, k)):
                raise StructureError(f"index out of range in c[{i}, {j}, {k}]: indices run from 0 to {n - 1}")
            entries[int(i), int(j), int(k)] = field.convert(value)
    for (i, j), row in constants.items():
        # A pair in one order only is filled in by antisymmetry.
        if (j, i) not in constants and i != j:
            entries |= {(int(j), int(i), int(k)): -entries[int(i), int(j), int(k)] for k in row}
    return n, entries


def _from_sparse(constants: SparseArray, field: Field) -> tuple[int, Entries]:
    table = constants.tocoo()
    n = int(table.shape[-1])
    if table.shape != (n * n, n):
        raise ShapeError(f"a sparse table has shape (n*n, n), got {table.shape}")
    entries: Entries = {}
    for row, k, value in zip(table.row.tolist(), table.col.tolist(), table.data.tolist(), strict=True):
        index = (*divmod(row, n), k)
        entries[index] = entries.get(index, field.zero) + field.convert(value)
    return n, entries


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
    entries = {(i, j, k): field.convert(array[i, j, k]) for i, j, k in indices.tolist()}
    return {index: value for index, value in entries.items() if value != 0}


def _array(constants: ConstantsLike) -> npt.NDArray[Any]:
    """Nested lists, or an array of numpy or sympy, as a numpy array with at least one axis."""
    try:
        array = np.asarray(constants)
    except (ValueError, RecursionError) as error:
        wrong = "not of equal lengths" if isinstance(error, ValueError) else "nested too deeply"
        raise ShapeError(f"structure constants have shape (n, n, n); these lists are {wrong}") from None
    if array.ndim == 0:
        raise StructureError(
            f"{displayed(constants)} is not a table of structure constants; write {{(i, j): {{k: value}}}} or an array "
            "of shape (n, n, n)"
        )
    return array


def _antisymmetric(entries: Entries, field: Field) -> Iterator[tuple[int, int, int, Scalar]]:
    """The non-zero entries (i, j, k, value) with i < j; `StructureError` if a c[i, j, k] + c[j, i, k] is not 0."""
    zero = field.zero
    failing = next(((x for x, v in entries.items() if v + entries.get((x[1], x[0], x[2]), zero) != 0)), None)
    if failing is not None and isinstance(field, FloatField):
        defects = np.array([float(v + entries.get((j, i, k), zero)) for (i, j, k), v in entries.items()])
        small = norm_of(defects) <= 2 * field.rtol * norm_of(np.array([float(v) for v in entries.values()]))
        failing = None if small else list(entries)[int(np.abs(defects).argmax())]
    if failing is not None:
        i, j, k = failing
        _not_antisymmetric(field, failing, entries[failing], entries.get((j, i, k), zero))
    yield from ((i, j, k, value) for (i, j, k), value in entries.items() if i < j and value != 0)


def _not_antisymmetric(field: Field, indices: tuple[int, int, int], value: Scalar, other: Scalar) -> NoReturn:
    i, j, k = indices
    here = f"the bracket is not antisymmetric: c[{i}, {j}, {k}] = {shown(field.show(value))}"
    if i == j:
        raise StructureError(f"{here} is the coefficient of e{k} in [e{i}, e{i}], expected 0: [x, x] = 0 for every x")
    there = f"c[{j}, {i}, {k}] = {shown(field.show(other))}"
    raise StructureError(f"{here} but {there}, expected {shown(field.show(-value))}")


# Lengths of basis elements for which the constants of a table over floats have similar sizes.
# In the basis d_i e_i the constants are c_ijk d_i d_j / d_k. One error bounds the uncertainty of the whole table, so
# that small constants are lost in it if basis elements have very different lengths. The logarithms of the d_i are the
# least-squares solution of log |c_ijk| + log d_i + log d_j - log d_k = t, t free, for the constants above the error.

RANGE = 1e6  # bound on the ratio of two lengths


def balanced(table: StructureConstants) -> tuple[StructureConstants, Array]:
    """The table over floats in the basis d_i e_i with its error, and the lengths d, an array (n,)."""
    n, field = table.dimension, table.field
    if not isinstance(field, FloatField):
        raise TypeError("tables are balanced over floats only")
    values = np.abs(np.asarray(table.parts[0], dtype=np.float64))
    kept = np.flatnonzero(values > table.error)
    if n < 2 or not len(kept):
        return table, np.ones(n)
    # normal equations with the signs of i, j, k, and of a column for t
    columns = np.stack([table.i[kept], table.j[kept], table.k[kept], np.full(len(kept), n)])
    signs, logs, size = np.array([1.0, 1.0, -1.0, -1.0]), np.log(values[kept]), n + 1
    logs -= logs.mean()  # of the shortest solutions the one that does not depend on the scale of the table
    normal, right = np.zeros((size, size)), np.zeros(size)
    for first, sign in zip(columns, signs, strict=True):
        right -= sign * np.bincount(first, logs, size)
        for second, other in zip(columns, signs, strict=True):
            normal += sign * other * np.bincount(first * size + second, minlength=size * size).reshape(size, size)
    exponents = np.linalg.lstsq(normal, right, rcond=1e-9)[0][:n]
    exponents -= exponents.mean()
    lengths = np.exp(np.clip(exponents, -np.log(RANGE) / 2, np.log(RANGE) / 2))
    constants = table.dense().to_numpy().reshape(n, n, n) * (lengths[:, None, None] * (lengths[:, None] / lengths))
    error = table.error * float(np.prod(np.sort(lengths)[-2:])) / float(lengths.min())
    return StructureConstants.from_array(field, constants, error), lengths
