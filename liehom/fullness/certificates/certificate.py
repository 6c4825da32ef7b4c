"""Certificate: the data that prove a pair full or not full, as a frozen object and as strict JSON.

A certificate is its kind, the number field that its numbers are in, and the fields of that kind. The fields hold
numbers; JSON holds them as strings in the grammar of values (`certificate_fields`). This file knows the form only;
`checker.verify` checks what the numbers must satisfy.

    trivial    -
    full       form (n x n), elements (m x n), eta (n)
    witness    minpoly, interval (2), eta and phi (n coordinates, polynomials in theta), optionally `also`
    commutant  matrix (d x d), complement (d x n), cut
    dominance  element (n), cut, eps

Matrices are dense (rows of numbers) or sparse (entries (i, j, number); every nonzero entry is listed, both (i, j)
and (j, i) of a symmetric matrix).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from liehom.display import Displayed
from liehom.errors import CertificateError, displayed
from liehom.fullness.certificates.certificate_fields import (
    READERS,
    check_keys,
    converted,
    is_sparse,
    malformed,
    number_field_json,
    read_number_field,
    to_json_value,
)
from liehom.scalars import QQ, ExactField, ExactMatrix, NumberField, Scalar

FORMAT, VERSION = "liehom-certificate", 1


@dataclass(frozen=True, slots=True, repr=False)
class Certificate(Displayed):
    """Data that prove a pair full or not full; `verify_certificate` checks them.

    Parameters
    ----------
    kind : {'trivial', 'full', 'witness', 'commutant', 'dominance'}
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
    liehom.errors.CertificateFormatError: format: unknown key 'eta' in a certificate of kind 'trivial' ...
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
        value: Scalar = self.fields[name]
        return value

    def vector(self, name: str, length: int | None = None) -> list[Scalar]:
        """The field `name` as a list of numbers, of the given length."""
        values = self.fields[name]
        if length is not None and len(values) != length:
            raise CertificateError("length", f"{name} has {len(values)} entries, expected {length}")
        return list(values)

    def polynomials(self, name: str, length: int, size: int) -> ExactMatrix:
        """The field `name` as a matrix (length, size) whose row i holds the ascending coefficients of entry i."""
        values = self.fields[name]
        if len(values) != length:
            raise CertificateError("length", f"{name} has {len(values)} entries, expected {length}")
        rows = [value if isinstance(value, tuple) else (value,) for value in values]
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
                found = f"{len(value)} x {len(value[0])}"
                raise CertificateError("length", f"{name} is {found}, expected {nrows} x {ncols}")
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
        lines = [f"certificate of kind {self.kind!r} over {self.field.name}"]
        for name, value in self.to_json().items():
            if name in self.fields:
                text = str(value).replace("'", "")
                lines.append(f"  {name}: {text if len(text) <= 100 else text[:97] + '...'}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<certificate of kind {self.kind!r} over {self.field.name}>"


def _read_also(value: object) -> Certificate:
    inner = value.copied() if isinstance(value, Certificate) else Certificate.from_json(value)
    if inner.kind not in ("commutant", "dominance"):
        raise malformed(f"also is of kind {inner.kind!r}, expected commutant or dominance")
    return inner
