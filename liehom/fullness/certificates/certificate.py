"""Certificate: the data that prove a pair full or not full, as a frozen object and as strict JSON.

A certificate is its kind, the field of its numbers and the fields of that kind; the numbers are kept as text in
the grammar of values, so that what is written is what was read.  This file knows the form only; what the
fields must satisfy is checked in `verify`.

    trivial    -
    full       form (n x n), elements (m x n), eta (n)
    witness    minpoly, interval (2), eta and phi (n coordinates, polynomials in theta), optionally `also`
    commutant  matrix (d x d), complement (d x n), cut
    dominance  element (n), cut, eps

Matrices are dense (a list of rows of texts) or sparse (a list of [i, j, text]; every nonzero entry is listed,
both (i, j) and (j, i) of a symmetric matrix).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from liehom.errors import CertificateError, CertificateFormatError, FieldError, InputError, ParseError
from liehom.scalars import QQ, ExactField, ExactMatrix, Matrix, NumberField, Scalar

FORMAT, VERSION = "liehom-certificate", 1
_NAME = re.compile(r"(?!sqrt$)[A-Za-z_][A-Za-z_0-9]*|sqrt\([0-9]+\)", re.ASCII)


@dataclass(frozen=True, slots=True, repr=False)
class Certificate:
    """What proves that a pair is full or that it is not; `verify_certificate` checks it.

    Parameters
    ----------
    kind : {'trivial', 'full', 'witness', 'commutant', 'dominance'}
    fields : mapping
        The fields of this kind as JSON has them: texts and nested lists of texts (`Certificate.over` takes
        numbers and matrices); `also` is a Certificate or its JSON object.
    field : RationalField or NumberField
        The field of the numbers; that of the pair.

    Raises
    ------
    CertificateFormatError
        If a field is missing or unknown, is not of the documented form, or holds a text that is no number.

    Examples
    --------
    >>> c = Certificate("dominance", {"element": ["1", "0"], "cut": "1/4", "eps": "1/2"})
    >>> c, c.full
    (<certificate of kind 'dominance' over QQ>, False)
    >>> Certificate.from_json(c.to_json()) == c
    True
    >>> Certificate("trivial", {"eta": ["1"]})
    Traceback (most recent call last):
    ...
    liehom.errors.CertificateFormatError: format: unknown key 'eta' in a certificate of kind 'trivial' ...
    """

    kind: str
    fields: Mapping[str, Any]
    field: ExactField = QQ

    def __post_init__(self) -> None:
        if not isinstance(self.field, ExactField):
            raise _malformed(f"a certificate over {self.field!r} proves nothing; the field must be exact")
        schema = _SCHEMA.get(self.kind) if isinstance(self.kind, str) else None
        if schema is None:
            raise _malformed(f"the kind is {self.kind!r}, expected one of {', '.join(_SCHEMA)}")
        optional = {"also"} if self.kind == "witness" else set()
        _check_keys(self.fields, set(schema), optional, f"a certificate of kind {self.kind!r}")
        frozen = {name: read(self.field, name, self.fields[name]) for name, read in schema.items()}
        if "also" in self.fields:
            frozen["also"] = _read_also(self.fields["also"])
        object.__setattr__(self, "fields", MappingProxyType(frozen))

    @classmethod
    def over(cls, field: Any, kind: str, **values: Any) -> Certificate:
        """The certificate with these numbers, lists of numbers and matrices over an exact field.

        Examples
        --------
        >>> Certificate.over(QQ, "commutant", matrix=QQ.identity(2), complement=[[1, 0], [0, 1]], cut=QQ.zero).fields
        mappingproxy({'matrix': (('1', '0'), ('0', '1')), 'complement': (('1', '0'), ('0', '1')), 'cut': '0'})
        """
        return cls(kind, {name: _written(field, value) for name, value in values.items()}, field)

    @classmethod
    def from_json(cls, data: Any) -> Certificate:
        """The certificate that a parsed JSON object holds; nothing of a malformed one is used.

        Raises
        ------
        CertificateFormatError
        """
        if not isinstance(data, Mapping):
            raise _malformed(f"a certificate is a JSON object, not {type(data).__name__}")
        for key, expected in (("format", FORMAT), ("version", VERSION)):
            if key not in data or data[key] != expected or isinstance(data[key], (bool, float)):
                raise _malformed(f"{key} is {data.get(key)!r}, expected {expected!r}")
        if "kind" not in data:
            raise _malformed("the key 'kind' is missing")
        field = _read_field(data["field"]) if "field" in data else QQ
        rest = {key: value for key, value in data.items() if key not in ("format", "version", "kind", "field")}
        return cls(data["kind"], rest, field)

    def to_json(self) -> dict[str, Any]:
        """The JSON object, of dicts, lists, texts and integers only."""
        out: dict[str, Any] = {"format": FORMAT, "version": VERSION, "kind": self.kind}
        if isinstance(self.field, NumberField):
            out["field"] = {
                "name": self.field.symbol,
                "minpoly": [str(c) for c in self.field.minpoly],
                "interval": [str(end) for end in self.field.interval],
            }
        return out | self.to_fields()

    def to_fields(self) -> dict[str, Any]:
        """The fields of this kind as JSON has them; a copy that may be changed."""
        return {name: _thawed(value) for name, value in self.fields.items()}

    @property
    def full(self) -> bool:
        """Whether the certificate claims that the pair is full (or else that it is not)."""
        return self.kind in ("trivial", "full")

    # -- numbers -----------------------------------------------------------------------------------------
    def number(self, name: str) -> Scalar:
        """The field `name` as a number."""
        return self.field.convert(self.fields[name])

    def vector(self, name: str, length: int | None = None) -> list[Scalar]:
        """The field `name` as a list of numbers, of the given length."""
        values = self.fields[name]
        if length is not None and len(values) != length:
            raise CertificateError("length", f"{name} has {len(values)} entries, expected {length}")
        return [self.field.convert(text) for text in values]

    def polynomials(self, name: str, length: int, size: int) -> ExactMatrix:
        """The field `name` as a matrix (length, size) whose row i holds the ascending coefficients of entry i."""
        values = self.fields[name]
        if len(values) != length:
            raise CertificateError("length", f"{name} has {len(values)} entries, expected {length}")
        rows = [(value,) if isinstance(value, str) else value for value in values]
        if any(len(row) > size for row in rows):
            raise CertificateError(
                "length", f"an entry of {name} has more than {size} coefficients, the degree of minpoly"
            )
        return self.field.matrix([[*row, *["0"] * (size - len(row))] for row in rows], (length, size))

    def matrix(self, name: str, nrows: int | None, ncols: int) -> ExactMatrix:
        """The field `name` as a matrix (nrows, ncols); where `nrows` is None it is what the field says."""
        value = self.fields[name]
        sparse = _is_sparse(value)
        if nrows is None:
            nrows = 1 + max(i for i, _, _ in value) if sparse else len(value)
        if not sparse:
            if value and (len(value) != nrows or len(value[0]) != ncols):
                found = f"{len(value)} x {len(value[0])}"
                raise CertificateError("length", f"{name} is {found}, expected {nrows} x {ncols}")
            return self.field.matrix(value, (nrows, ncols)) if value else self.field.zeros(nrows, ncols)
        entries = [self.field.zero] * (nrows * ncols)
        for i, j, text in value:
            if i >= nrows or j >= ncols:
                raise CertificateError("length", f"{name} has an entry ({i}, {j}), but is {nrows} x {ncols}")
            entries[i * ncols + j] = self.field.convert(text)
        return self.field.from_entries(entries, nrows, ncols)

    # -- dunder ------------------------------------------------------------------------------------------
    def __hash__(self) -> int:
        return hash((self.kind, tuple(sorted(self.fields.items()))))

    def __reduce__(self) -> tuple[Any, ...]:
        return Certificate.from_json, (self.to_json(),)

    def __str__(self) -> str:
        lines = [f"certificate of kind {self.kind!r} over {self.field.name}"]
        for name, value in self.to_json().items():
            if name in self.fields:
                text = str(value).replace("'", "")
                lines.append(f"  {name}: {text if len(text) <= 100 else text[:97] + '...'}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<certificate of kind {self.kind!r} over {self.field.name}>"


def _malformed(message: str) -> CertificateFormatError:
    return CertificateFormatError("format", message)


def _check_keys(data: Mapping[str, Any], required: set[str], optional: set[str], what: str) -> None:
    unknown = sorted(repr(key) for key in data if key not in required | optional)
    if unknown:
        known = ", ".join(sorted(required | optional)) or "none"
        raise _malformed(f"unknown key {', '.join(unknown)} in {what} (its fields: {known})")
    missing = sorted(required - set(data))
    if missing:
        raise _malformed(f"the key {', '.join(map(repr, missing))} is missing in {what}")


# -- reading: each function checks one form and returns it with tuples for lists ---------------------------
def _read_text(field: ExactField, name: str, value: Any) -> str:
    if not isinstance(value, str):
        kind = "a float" if isinstance(value, float) else f"of type {type(value).__name__}"
        raise _malformed(f"{name} holds {value!r}, {kind}; write numbers as texts such as '3' or '-1/2'")
    try:
        field.convert(value)
    except (ParseError, FieldError) as error:
        raise _malformed(f"{name}: {error}") from None
    return value


def _read_list(name: str, value: Any) -> Sequence[Any]:
    if not isinstance(value, (list, tuple)):
        raise _malformed(f"{name} must be a list, not {type(value).__name__}")
    return value


def _read_vector(field: ExactField, name: str, value: Any) -> tuple[str, ...]:
    return tuple(_read_text(field, name, x) for x in _read_list(name, value))


def _read_interval(field: ExactField, name: str, value: Any) -> tuple[str, ...]:
    ends = _read_vector(field, name, value)
    if len(ends) != 2:
        raise _malformed(f"{name} must have two ends, it has {len(ends)}")
    return ends


def _read_minpoly(field: ExactField, name: str, value: Any) -> tuple[str, ...]:
    coefficients = _read_vector(field, name, value)
    if len(coefficients) < 2 or field.convert(coefficients[-1]) == 0:
        raise _malformed(f"{name} must have degree at least 1 and a leading (last) coefficient that is not 0")
    return coefficients


def _read_polynomials(field: ExactField, name: str, value: Any) -> tuple[str | tuple[str, ...], ...]:
    out: list[str | tuple[str, ...]] = []
    for x in _read_list(name, value):
        out.append(_read_vector(field, name, x) if isinstance(x, (list, tuple)) else _read_text(field, name, x))
        if not out[-1]:
            raise _malformed(f"{name} holds an empty list of coefficients; write '0'")
    return tuple(out)


def _is_sparse(rows: Sequence[Any]) -> bool:
    """Rows of texts are dense, [integer, integer, text] is sparse; the first row decides."""
    return bool(rows) and len(rows[0]) > 0 and not isinstance(rows[0][0], str)


def _read_matrix(field: ExactField, name: str, value: Any) -> tuple[tuple[Any, ...], ...]:
    rows = [_read_list(f"a row of {name}", row) for row in _read_list(name, value)]
    if _is_sparse(rows):
        return _read_sparse(field, name, rows)
    table = tuple(_read_vector(field, name, row) for row in rows)
    lengths = sorted({len(row) for row in table})
    if len(lengths) > 1:
        raise _malformed(f"the rows of {name} have different lengths: {lengths}")
    return table


def _read_sparse(field: ExactField, name: str, rows: Sequence[Any]) -> tuple[tuple[Any, ...], ...]:
    places = set()
    for row in rows:
        if len(row) != 3 or any(type(index) is not int or index < 0 for index in row[:2]):
            raise _malformed(f"{name} holds {row!r}, expected [i, j, text] with indices from 0 (or rows of texts)")
        if (row[0], row[1]) in places:
            raise _malformed(f"{name} gives the entry ({row[0]}, {row[1]}) twice")
        places.add((row[0], row[1]))
    return tuple((i, j, _read_text(field, name, text)) for i, j, text in rows)


def _read_rows(field: ExactField, name: str, value: Any) -> tuple[tuple[Any, ...], ...]:
    rows = _read_matrix(field, name, value)
    if _is_sparse(rows):
        numbers = {i for i, _, _ in rows}
        if len(numbers) != 1 + max(numbers):
            raise _malformed(f"{name} is sparse and has a row without entries, so its number of rows is unclear")
    return rows


def _read_square(field: ExactField, name: str, value: Any) -> tuple[tuple[Any, ...], ...]:
    rows = _read_matrix(field, name, value)
    if rows and not _is_sparse(rows) and len(rows) != len(rows[0]):
        raise _malformed(f"{name} must be square, it is {len(rows)} x {len(rows[0])}")
    return rows


def _read_also(value: Any) -> Certificate:
    inner = value if isinstance(value, Certificate) else Certificate.from_json(value)
    if inner.kind not in ("commutant", "dominance"):
        raise _malformed(f"also is of kind {inner.kind!r}, expected commutant or dominance")
    return inner


def _read_field(data: Any) -> NumberField:
    if not isinstance(data, Mapping):
        raise _malformed(f"field must be a JSON object, not {type(data).__name__}")
    _check_keys(data, {"name", "minpoly", "interval"}, set(), "field")
    name = data["name"]
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise _malformed(f"the name of the field is {name!r}, expected an identifier such as 'a'")
    minpoly = _read_minpoly(QQ, "minpoly of the field", data["minpoly"])
    ends = _read_interval(QQ, "interval of the field", data["interval"])
    try:
        return NumberField(name, minpoly, (ends[0], ends[1]))
    except InputError as error:
        raise CertificateFormatError("field", str(error)) from None


_SCHEMA: dict[str, dict[str, Callable[[ExactField, str, Any], Any]]] = {
    "trivial": {},
    "full": {"form": _read_square, "elements": _read_rows, "eta": _read_vector},
    "witness": {
        "minpoly": _read_minpoly,
        "interval": _read_interval,
        "eta": _read_polynomials,
        "phi": _read_polynomials,
    },
    "commutant": {"matrix": _read_square, "complement": _read_rows, "cut": _read_text},
    "dominance": {"element": _read_vector, "cut": _read_text, "eps": _read_text},
}


# -- writing ---------------------------------------------------------------------------------------------
def _thawed(value: Any) -> Any:
    if isinstance(value, Certificate):
        return value.to_json()
    return [_thawed(x) for x in value] if isinstance(value, tuple) else value


def _written(field: Any, value: Any) -> Any:
    if isinstance(value, Matrix):
        return _written_matrix(field, value.to_rows())
    if isinstance(value, (list, tuple)):
        return [_written(field, x) for x in value]
    return value if isinstance(value, (str, Certificate)) else field.format(field.convert(value))


def _written_matrix(field: Any, rows: list[list[Scalar]]) -> list[Any]:
    """Sparse where at most a quarter of the entries is not zero, and no row is zero; else dense."""
    places = [(i, j) for i, row in enumerate(rows) for j, x in enumerate(row) if x != 0]
    size = sum(map(len, rows))
    if size > 64 and 4 * len(places) <= size and len({i for i, _ in places}) == len(rows):
        return [[i, j, field.format(rows[i][j])] for i, j in places]
    return [[field.format(x) for x in row] for row in rows]
