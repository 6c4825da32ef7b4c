"""Fields of a certificate: numbers of its field, read from JSON and written to it.

A field holds one number, a vector (a tuple of numbers), a vector of polynomials (tuples of ascending coefficients, or
numbers), or a matrix. A matrix is dense, a tuple of rows, or sparse, a tuple of entries (i, j, number); it is written
as it is held. Strings occur in JSON only, in the grammar of values.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

from liehom.budget import within
from liehom.errors import CertificateFormatError, FieldError, InputError, LimitError, ParseError, displayed
from liehom.scalars import QQ, ExactField, Matrix, NumberField, Scalar

Vector: TypeAlias = tuple[Scalar, ...]
Polynomials: TypeAlias = tuple[Scalar | Vector, ...]
Rows: TypeAlias = tuple[tuple[Any, ...], ...]
"""A matrix: rows of numbers, or entries (i, j, number)."""

_NAME = re.compile(r"(?!sqrt$)[A-Za-z_][A-Za-z_0-9]*|sqrt\([0-9]+\)", re.ASCII)


def malformed(message: str) -> CertificateFormatError:
    """The error for a certificate whose form is wrong."""
    return CertificateFormatError("format", message)


def check_keys(data: Mapping[str, Any], required: set[str], optional: set[str], what: str) -> None:
    """Raise `CertificateFormatError` if a key is unknown or missing; it names the key."""
    unknown = sorted(displayed(key) for key in data if key not in required | optional)
    if unknown:
        known = ", ".join(sorted(required | optional)) or "none"
        raise malformed(f"unknown key {', '.join(unknown)} in {what} (its fields: {known})")
    missing = sorted(required - set(data))
    if missing:
        raise malformed(f"the key {', '.join(map(repr, missing))} is missing in {what}")


# -- reading: each function checks one form and returns numbers, with tuples for lists ---------------------
def _is_number(field: ExactField, value: object) -> bool:
    """Whether a value is an element of the field already (no subclass), or a string to be parsed as one."""
    return type(value) is type(field.one) or isinstance(value, str)


def _read_number(field: ExactField, name: str, value: Any) -> Scalar:
    if not _is_number(field, value):
        kind = "a float" if isinstance(value, float) else f"of type {type(value).__name__}"
        raise malformed(f"{name} holds {displayed(value)}, {kind}; write numbers as strings such as '3' or '-1/2'")
    try:
        number: Scalar = field.convert(value)
    except (ParseError, FieldError) as error:
        raise malformed(f"{name}: {error}") from None
    return number


def _read_list(name: str, value: object) -> Sequence[Any]:
    if not isinstance(value, (list, tuple)):
        raise malformed(f"{name} must be a list, not {type(value).__name__}")
    return value


def _read_vector(field: ExactField, name: str, value: object) -> Vector:
    return tuple(_read_number(field, name, x) for x in _read_list(name, value))


def _read_interval(field: ExactField, name: str, value: object) -> Vector:
    ends = _read_vector(field, name, value)
    if len(ends) != 2:
        raise malformed(f"{name} must have two ends, it has {len(ends)}")
    return ends


def _read_minpoly(field: ExactField, name: str, value: object) -> Vector:
    coefficients = _read_vector(field, name, value)
    within("minpoly_degree", len(coefficients) - 1, f"{name} has degree {{}}")
    if len(coefficients) < 2 or coefficients[-1] == 0:
        raise malformed(f"{name} must have degree at least 1 and a leading (last) coefficient that is not 0")
    return coefficients


def _read_polynomials(field: ExactField, name: str, value: object) -> Polynomials:
    out: list[Scalar | Vector] = []
    for x in _read_list(name, value):
        if not isinstance(x, (list, tuple)):
            out.append(_read_number(field, name, x))
        elif x:
            out.append(_read_vector(field, name, x))
        else:
            raise malformed(f"{name} holds an empty list of coefficients; write '0'")
    return tuple(out)


def is_sparse(field: ExactField, rows: Sequence[Any]) -> bool:
    """Whether a matrix is given by entries (i, j, number) rather than by rows of numbers; the first item decides."""
    return bool(rows) and len(rows[0]) > 0 and not _is_number(field, rows[0][0])


def _read_matrix(field: ExactField, name: str, value: object) -> Rows:
    rows = [_read_list(f"a row of {name}", row) for row in _read_list(name, value)]
    if is_sparse(field, rows):
        return _read_sparse(field, name, rows)
    table = tuple(_read_vector(field, name, row) for row in rows)
    lengths = sorted({len(row) for row in table})
    if len(lengths) > 1:
        raise malformed(f"the rows of {name} have different lengths: {lengths}")
    return table


def _read_sparse(field: ExactField, name: str, rows: Sequence[Any]) -> Rows:
    indices = set()
    for row in rows:
        if len(row) != 3 or any(type(index) is not int or index < 0 for index in row[:2]):
            raise malformed(
                f"{name} holds {displayed(row)}, expected [i, j, number] with indices from 0 (or rows of numbers)"
            )
        if (row[0], row[1]) in indices:
            raise malformed(f"{name} gives the entry {displayed(tuple(row[:2]))} twice")
        indices.add((row[0], row[1]))
    return tuple((i, j, _read_number(field, name, x)) for i, j, x in rows)


def _read_rows(field: ExactField, name: str, value: object) -> Rows:
    rows = _read_matrix(field, name, value)
    if is_sparse(field, rows):
        numbers = {i for i, _, _ in rows}
        if len(numbers) != 1 + max(numbers):
            raise malformed(f"{name} is sparse and has a row without entries, so its number of rows is unclear")
    return rows


def _read_square(field: ExactField, name: str, value: object) -> Rows:
    rows = _read_matrix(field, name, value)
    if rows and not is_sparse(field, rows) and len(rows) != len(rows[0]):
        raise malformed(f"{name} must be square, it is {len(rows)} x {len(rows[0])}")
    return rows


def read_number_field(data: object) -> NumberField:
    """The number field of a JSON object {"name", "minpoly", "interval"}.

    Examples
    --------
    >>> read_number_field({"name": "a", "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]})
    QQ(a)
    """
    if not isinstance(data, Mapping):
        raise malformed(f"field must be a JSON object, not {type(data).__name__}")
    check_keys(data, {"name", "minpoly", "interval"}, set(), "field")
    name = data["name"]
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise malformed(f"the name of the field is {displayed(name)}, expected an identifier such as 'a'")
    minpoly = _read_minpoly(QQ, "minpoly of the field", data["minpoly"])
    ends = _read_interval(QQ, "interval of the field", data["interval"])
    try:
        return NumberField(name, minpoly, (ends[0], ends[1]))
    except LimitError:
        raise
    except InputError as error:
        raise CertificateFormatError("field", str(error)) from None


def number_field_json(field: NumberField) -> dict[str, Any]:
    """The JSON object {"name", "minpoly", "interval"} of a number field.

    Examples
    --------
    >>> import liehom as lh
    >>> read_number_field(number_field_json(lh.number_field("sqrt(2)"))) == lh.number_field("sqrt(2)")
    True
    """
    minpoly = [QQ.format(QQ.convert(c)) for c in field.minpoly]
    return {"name": field.symbol, "minpoly": minpoly, "interval": [str(end) for end in field.interval]}


READERS: dict[str, dict[str, Callable[[ExactField, str, object], object]]] = {
    "trivial": {},
    "full": {"form": _read_square, "elements": _read_rows, "eta": _read_vector},
    "witness": {
        "minpoly": _read_minpoly,
        "interval": _read_interval,
        "eta": _read_polynomials,
        "phi": _read_polynomials,
    },
    "commutant": {"matrix": _read_square, "complement": _read_rows, "cut": _read_number},
    "dominance": {"element": _read_vector, "cut": _read_number, "eps": _read_number},
}
"""For each kind of certificate, its fields and how each is read."""


# -- writing -----------------------------------------------------------------------------------------------
def to_json_value(field: ExactField, value: Any) -> Any:
    """JSON value of a field, with strings for numbers and lists for tuples; indices of sparse matrices stay integers.

    Examples
    --------
    >>> to_json_value(QQ, ((0, 1, QQ.convert("1/2")),))
    [[0, 1, '1/2']]
    """
    if isinstance(value, tuple):
        return [to_json_value(field, x) for x in value]
    return value if type(value) is int else field.format(value)


def converted(field: ExactField, value: Any) -> Any:
    """Numbers, sequences of numbers and matrices in the form that a certificate holds."""
    if isinstance(value, Matrix):
        return converted_matrix(field, value.to_rows())
    if isinstance(value, (list, tuple)):
        return tuple(converted(field, x) for x in value)
    return field.convert(value)


def converted_matrix(field: ExactField, rows: Sequence[Sequence[Scalar]]) -> Rows:
    """Sparse if at most a quarter of more than 64 entries is nonzero and no row is zero, else dense."""
    entries = [(i, j, x) for i, row in enumerate(rows) for j, x in enumerate(row) if x != 0]
    size = sum(map(len, rows))
    if size > 64 and 4 * len(entries) <= size and len({i for i, _, _ in entries}) == len(rows):
        return tuple(entries)
    return tuple(map(tuple, rows))
