"""Certificates, their fields in JSON, and how the decision writes them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

from liehom.base.budget import within
from liehom.base.errors import (
    CertificateError,
    CertificateFormatError,
    FieldError,
    InputError,
    LimitError,
    ParseError,
    displayed,
)
from liehom.base.objects import Displayed
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Matrix, Scalar
from liehom.exact.scalars.number_fields import SYMBOL, NumberField
from liehom.exact.scalars.rational import QQ

# A field of a certificate holds one number, a vector (a tuple of numbers), a vector of polynomials (tuples of ascending
# coefficients, or numbers), or a matrix. A matrix is dense, a tuple of rows, or sparse, a tuple of entries (i, j,
# number); it is written as it is held. Strings occur in JSON only, in the grammar of values.

Vector: TypeAlias = tuple[Scalar, ...]
Polynomials: TypeAlias = tuple[Scalar | Vector, ...]
Rows: TypeAlias = tuple[tuple[Any, ...], ...]
"""A matrix: rows of numbers, or entries (i, j, number)."""


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
        return field.convert(value)
    except (ParseError, FieldError) as error:
        raise malformed(f"{name}: {error}") from None


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
    def entry(x: object) -> Scalar | Vector:
        if isinstance(x, (list, tuple)) and not x:
            raise malformed(f"{name} holds an empty list of coefficients; write '0'")
        return _read_vector(field, name, x) if isinstance(x, (list, tuple)) else _read_number(field, name, x)

    return tuple(map(entry, _read_list(name, value)))


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
    indices: set[tuple[int, int]] = set()
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
    """The number field of a JSON object {"name", "minpoly", "interval"}."""
    if not isinstance(data, Mapping):
        raise malformed(f"field must be a JSON object, not {type(data).__name__}")
    check_keys(data, {"name", "minpoly", "interval"}, set(), "field")
    name = data["name"]
    if not isinstance(name, str) or not SYMBOL.fullmatch(name):
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
    """The JSON object {"name", "minpoly", "interval"} of a number field."""
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
    "generic": {"eta": _read_vector},
    "slice": {"point": _read_vector, "directions": _read_rows, "stabilizer": _read_rows},
    "lattice": {"point": _read_vector, "directions": _read_rows},
}
"""For each kind of certificate, its fields and how each is read."""


# -- writing -----------------------------------------------------------------------------------------------
def to_json_value(field: ExactField, value: Any) -> Any:
    """JSON value of a field, numbers as strings, tuples as lists; indices of sparse matrices stay integers."""
    if isinstance(value, tuple):
        return [to_json_value(field, x) for x in value]
    return value if type(value) is int else field.format(value)


def converted(field: ExactField, value: Any) -> Any:
    """Numbers, sequences of numbers and matrices in the form that a certificate holds."""
    if isinstance(value, (list, tuple)):
        return tuple(converted(field, x) for x in value)
    if not isinstance(value, Matrix):
        return field.convert(value)
    entries = tuple((i, j, x) for i, row in enumerate(value) for j, x in enumerate(row) if x != 0)
    size, used = value.nrows * value.ncols, {i for i, _, _ in entries}
    # sparse if at most a quarter of more than 64 entries is nonzero and no row is zero
    return entries if size > 64 and 4 * len(entries) <= size and len(used) == value.nrows else tuple(map(tuple, value))


# A certificate is its kind, the number field that its numbers are in, and the fields of that kind. This file knows the
# form only; `checker.verify` checks what the numbers must satisfy.
#
#     trivial    -
#     full       form (n x n), elements (m x n), eta (n)
#     witness    minpoly, interval (2), eta and phi (n coordinates, polynomials in theta), optionally `also`
#     commutant  matrix (d x d), complement (d x n), cut
#     dominance  element (n), cut, eps
#
# The last three kinds are about the range condition at generic eta, and prove no verdict about fullness.
#
#     generic    eta (n)
#     slice      point (n), directions (w x n), stabilizer (k x (n + 1): elements of h and a scalar)
#     lattice    point (n), directions (w x n)
#
# Matrices are dense (rows of numbers) or sparse (entries (i, j, number); every nonzero entry is listed, both (i, j)
# and (j, i) of a symmetric matrix).

FORMAT, VERSION = "liehom-certificate", 1


@dataclass(frozen=True, slots=True, repr=False)
class Certificate(Displayed):
    """Data that prove a pair full or not full; `verify_certificate` checks them, `verify_range` the last three kinds.

    Parameters
    ----------
    kind : {'trivial', 'full', 'witness', 'commutant', 'dominance', 'generic', 'slice', 'lattice'}
    fields : mapping
        The fields of this kind, as numbers of `field` or as JSON has them: strings and nested lists of strings
        (`Certificate.over` takes matrices as well). `also` is a Certificate or its JSON object.
    field : RationalField or NumberField
        The number field of the pair, which all numbers are in.

    Attributes
    ----------
    fields : mapping
        The numbers: a number, a tuple of numbers, or a tuple of tuples for polynomials and matrices.

    Raises
    ------
    CertificateFormatError
        If a field is missing or unknown, is not of the documented form, or holds a string that is not a number.

    Examples
    --------
    >>> c = Certificate("dominance", {"element": ["1", "0"], "cut": "1/4", "eps": "1/2"})
    >>> c, c.full
    (<certificate of kind 'dominance' over QQ>, False)
    >>> c.number("cut") * 4, c.to_fields()["cut"]
    (1, '1/4')
    >>> Certificate.from_json(c.to_json()) == c
    True
    >>> Certificate("trivial", {"eta": ["1"]})
    Traceback (most recent call last):
    ...
    liehom.base.errors.CertificateFormatError: format: unknown key 'eta' in a certificate of kind 'trivial' ...
    """

    kind: str
    fields: Mapping[str, Any]
    field: ExactField = QQ

    def __post_init__(self) -> None:
        if not isinstance(self.field, ExactField):
            raise malformed(f"a certificate over {self.field!r} proves nothing; the field must be exact")
        if isinstance(self.kind, str):  # a subclass could compare as it likes
            object.__setattr__(self, "kind", str.__str__(self.kind))
        schema = READERS.get(self.kind) if isinstance(self.kind, str) else None
        if schema is None:
            raise malformed(f"the kind is {displayed(self.kind)}, expected one of {', '.join(READERS)}")
        optional = {"also"} if self.kind == "witness" else set()
        check_keys(self.fields, set(schema), optional, f"a certificate of kind {self.kind!r}")
        frozen = {name: read(self.field, name, self.fields[name]) for name, read in schema.items()}
        if "also" in self.fields:
            frozen["also"] = _read_also(self.fields["also"])
        object.__setattr__(self, "fields", MappingProxyType(frozen))

    @classmethod
    def over(cls, field: ExactField, kind: str, **values: object) -> Certificate:
        """The certificate with these numbers, lists of numbers and matrices over an exact field.

        Examples
        --------
        >>> Certificate.over(QQ, "commutant", matrix=QQ.identity(2), complement=[[1, 0], [0, 1]], cut=0).to_fields()
        {'matrix': [['1', '0'], ['0', '1']], 'complement': [['1', '0'], ['0', '1']], 'cut': '0'}
        """
        fields = {name: value if name == "also" else converted(field, value) for name, value in values.items()}
        return cls(kind, fields, field)

    @classmethod
    def from_json(cls, data: object) -> Certificate:
        """The certificate that a parsed JSON object holds.

        Raises
        ------
        CertificateFormatError
            If any part of the object is malformed.
        """
        if not isinstance(data, Mapping):
            raise malformed(f"a certificate is a JSON object, not {type(data).__name__}")
        for key, expected in (("format", FORMAT), ("version", VERSION)):
            if key not in data or data[key] != expected or isinstance(data[key], (bool, float)):
                raise malformed(f"{key} is {displayed(data.get(key))}, expected {expected!r}")
        if "kind" not in data:
            raise malformed("the key 'kind' is missing")
        field = read_number_field(data["field"]) if "field" in data else QQ
        rest = {key: value for key, value in data.items() if key not in ("format", "version", "kind", "field")}
        return cls(data["kind"], rest, field)

    def to_json(self) -> dict[str, Any]:
        """The JSON object, of dicts, lists, strings and integers only."""
        out: dict[str, Any] = {"format": FORMAT, "version": VERSION, "kind": self.kind}
        if isinstance(self.field, NumberField):
            out["field"] = number_field_json(self.field)
        return out | self.to_fields()

    def to_fields(self) -> dict[str, Any]:
        """The fields of this kind as JSON has them; the dict and its lists may be changed."""
        return {
            name: value.to_json() if isinstance(value, Certificate) else to_json_value(self.field, value)
            for name, value in self.fields.items()
        }

    @property
    def full(self) -> bool:
        """Whether the certificate claims that the pair is full (or else that it is not)."""
        return self.kind in ("trivial", "full")

    def copied(self) -> Certificate:
        """A certificate of the same data, checked again and made of plain types only; the checker works on such a copy.

        Examples
        --------
        >>> c = Certificate("trivial", {})
        >>> c.copied() == c, c.copied() is c
        (True, False)
        """
        return Certificate(self.kind, self.fields, self.field)

    # -- numbers -----------------------------------------------------------------------------------------
    def number(self, name: str) -> Scalar:
        """The number in the field `name`."""
        return self.fields[name]

    def vector(self, name: str, length: int | None = None) -> list[Scalar]:
        """The field `name` as a list of numbers, of the given length."""
        values = self.fields[name]
        if length is not None and len(values) != length:
            raise CertificateError("length", f"{name} has {len(values)} entries, expected {length}")
        return list(values)

    def polynomials(self, name: str, length: int, size: int) -> ExactMatrix:
        """The field `name` as a matrix (length, size) whose row i holds the ascending coefficients of entry i."""
        rows = [value if isinstance(value, tuple) else (value,) for value in self.vector(name, length)]
        if any(len(row) > size for row in rows):
            raise CertificateError(
                "length", f"an entry of {name} has more than {size} coefficients, the degree of minpoly"
            )
        return self.field.matrix([[*row, *[self.field.zero] * (size - len(row))] for row in rows], (length, size))

    def matrix(self, name: str, nrows: int | None, ncols: int) -> ExactMatrix:
        """The field `name` as a matrix (nrows, ncols); with `nrows` None, the field determines the number of rows."""
        value = self.fields[name]
        sparse = is_sparse(self.field, value)
        if nrows is None:
            nrows = 1 + max(i for i, _, _ in value) if sparse else len(value)
        if not sparse:
            if value and (len(value) != nrows or len(value[0]) != ncols):
                raise CertificateError(
                    "length", f"{name} is {len(value)} x {len(value[0])}, expected {nrows} x {ncols}"
                )
            return self.field.matrix(value, (nrows, ncols)) if value else self.field.zeros(nrows, ncols)
        entries = [self.field.zero] * (nrows * ncols)
        for i, j, number in value:
            if i >= nrows or j >= ncols:
                raise CertificateError("length", f"{name} has an entry {displayed((i, j))}, but is {nrows} x {ncols}")
            entries[i * ncols + j] = number
        return self.field.from_entries(entries, nrows, ncols)

    # -- dunder ------------------------------------------------------------------------------------------
    def __hash__(self) -> int:
        return hash((self.kind, tuple(sorted(self.fields.items()))))

    def __reduce__(self) -> tuple[Any, ...]:
        return Certificate.from_json, (self.to_json(),)

    def __str__(self) -> str:
        texts = {name: str(value).replace("'", "") for name, value in self.to_fields().items()}
        lines = [f"  {name}: {text if len(text) <= 100 else text[:97] + '...'}" for name, text in texts.items()]
        return "\n".join([f"certificate of kind {self.kind!r} over {self.field.name}", *lines])

    def __repr__(self) -> str:
        return f"<certificate of kind {self.kind!r} over {self.field.name}>"


def _read_also(value: object) -> Certificate:
    inner = value.copied() if isinstance(value, Certificate) else Certificate.from_json(value)
    if inner.kind not in ("commutant", "dominance"):
        raise malformed(f"also is of kind {inner.kind!r}, expected commutant or dominance")
    return inner
