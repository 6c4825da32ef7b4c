"""Strict JSON, and lists of JSON values as numbers of a field."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Collection, Mapping, Sequence, Set
from contextlib import nullcontext
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, BinaryIO, NoReturn, TypeAlias, final

from liehom.base.budget import current_limits, within
from liehom.base.disk import MARK, checksum
from liehom.base.errors import FieldError, FormatError, InputError, LimitError, ParseError, ShapeError
from liehom.exact.scalars.complex_parts import field_determining_values, is_complex
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.field import Field, Matrix, Scalar
from liehom.exact.scalars.floating import RR, FloatField
from liehom.exact.scalars.number_fields import NumberField, common_field
from liehom.exact.scalars.rational import QQ

# Strict JSON: a string or file holds one object, without repeated keys, NaN or infinities.

# A path, or a file that is open in binary mode, such as ``sys.stdin.buffer``
Source: TypeAlias = str | os.PathLike[str] | BinaryIO
MAX_SHOWN = 60  # Characters of a value that a message shows
OTHER_TOOLS = (
    "`liehom describe` reads a file of GAP if it ends in .g or .gap, one of Sage if it ends in .sage; "
    "liehom.io.from_gap and from_sage read strings"
)
CHUNK = 1 << 20  # Bytes that are read at once
# Longer integers stay strings: Python refuses to convert them, the grammar of values does not
MAX_INTEGER_DIGITS = 4000
# Python's types of JSON values, in words
KINDS: tuple[tuple[type | tuple[type, ...], str], ...] = (
    (bool, "a boolean"),
    (dict, "an object"),
    ((list, tuple), "a list"),
    (str, "a string"),
    ((int, float), "a number"),
)


def read_object(path: Source) -> dict[str, Any]:
    """JSON object in a file, as a dict.

    Raises
    ------
    FormatError
        If the file cannot be read, is not UTF-8, or does not hold one JSON object.

    Examples
    --------
    >>> read_object("no/such/file.json")
    Traceback (most recent call last):
    ...
    liehom.base.errors.FormatError: 'no/such/file.json' cannot be read: No such file or directory
    """
    text = read_text(path, "a JSON file")
    try:
        return parse_object(text)
    except FormatError as error:
        if str(error).startswith("not JSON") and not text.lstrip().startswith("{"):
            raise FormatError(f"{error}; {OTHER_TOOLS}") from None
        raise


def read_text(path: Source, expected: str) -> str:
    """Text of a file in UTF-8, of which no more is read than the limit allows, even if the file has no end."""
    is_path = isinstance(path, str | os.PathLike)
    if not is_path and not hasattr(path, "read"):  # an integer is the number of an open file
        raise FormatError(f"expected the path of a file, or a file open in binary mode, got {shown(path)}")
    name = shown(str(path)) if is_path else str(getattr(path, "name", "it"))
    try:
        with open(path, "rb", buffering=0) if isinstance(path, str | os.PathLike) else nullcontext(path) as file:
            content = _content(file)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FormatError(f"{name} cannot be read: {reason}") from None
    within("file_bytes", len(content), f"the file {name} has {{}} bytes or more")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FormatError(f"{name} is not text in UTF-8 (byte {error.start}), so not {expected}") from None


def _content(file: BinaryIO) -> bytearray:
    """Bytes of an open file, at most one more than the limit."""
    allowed, content = current_limits().file_bytes, bytearray()
    while len(content) <= allowed and (part := file.read(min(CHUNK, allowed + 1 - len(content)))):
        if not isinstance(part, bytes):
            raise FormatError("the file is open in text mode, expected binary mode: open(path, 'rb')")
        content += part
    return content


def parse_object(text: str) -> dict[str, Any]:
    """JSON object in a string, as a dict.

    Raises
    ------
    FormatError
        If the string is not JSON, is not an object, repeats a key, holds NaN or an infinity, or has a wrong checksum.

    Examples
    --------
    >>> parse_object('{"dimension": 2, "dimension": 3}')
    Traceback (most recent call last):
    ...
    liehom.base.errors.FormatError: the key 'dimension' is given twice
    """
    within("file_bytes", len(text), "the string has {} characters")
    try:
        data = _decoded(text)
    except json.JSONDecodeError as error:
        raise FormatError(f"not JSON: {error.msg} at line {error.lineno}, column {error.colno}") from None
    except RecursionError:
        raise FormatError("not a file of liehom: its lists or objects are nested too deeply") from None
    if not isinstance(data, dict):
        raise FormatError(f"a file holds one JSON object {{...}}, this one holds {kind_of(data)}")
    return _without_checksum(data)


def json_checksum(data: Mapping[str, Any]) -> str:
    """Checksum of a JSON object, whatever the order of its keys."""
    return checksum({}, json.dumps(data, sort_keys=True))


def _without_checksum(data: dict[str, Any]) -> dict[str, Any]:
    """The object without its checksum, if it has one; `FormatError` if the checksum does not agree."""
    if MARK in data and data.pop(MARK) != json_checksum(data):
        raise FormatError(
            f"the file is damaged: its {MARK!r} does not agree with its contents; if it was edited on purpose, "
            f"delete the key {MARK!r}"
        )
    return data


def _decoded(text: str) -> object:
    options: dict[str, Any] = {"object_pairs_hook": _distinct, "parse_constant": _no_constant}
    try:
        return json.loads(text, **options)
    except json.JSONDecodeError:
        raise
    except ValueError:  # an integer of more digits than Python reads
        return json.loads(text, parse_int=_integer, **options)


def _integer(digits: str) -> int | str:
    return int(digits) if len(digits) <= MAX_INTEGER_DIGITS else digits


def _distinct(items: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(items)
    if len(data) < len(items):
        keys = [key for key, _ in items]
        repeated = next(key for number, key in enumerate(keys) if key in keys[:number])
        raise FormatError(f"the key {repeated!r} is given twice")
    return data


def _no_constant(name: str) -> NoReturn:
    raise FormatError(f"the file holds {name}, expected finite numbers")


# -- what the readers of the formats share ---------------------------------------------------------------
def check_keys(data: Mapping[str, Any], required: Collection[str], optional: Collection[str], what: str) -> None:
    """Raise `FormatError` if a key is unknown or missing; the message names it."""
    unknown = [key for key in data if key not in required and key not in optional]
    if unknown:
        named = ", ".join(shown(key) for key in unknown[:5])
        known = ", ".join(sorted([*required, *optional]))
        raise FormatError(f"unknown key {named} in {what}; known: {known}")
    missing = [key for key in required if key not in data]
    if missing:
        raise FormatError(f"the key {', '.join(map(repr, missing))} is missing in {what}")


def check_header(data: Mapping[str, Any], expected: str) -> None:
    """Raise `FormatError` if `format` is not the expected one, or `version` is not 1; both may be absent."""
    if "format" in data and data["format"] != expected:
        raise FormatError(f"format is {shown(data['format'])}, expected {expected!r}")
    if "version" in data and (type(data["version"]) is not int or data["version"] != 1):
        raise FormatError(f"version is {shown(data['version'])}, expected 1")


def is_float64(data: Mapping[str, Any]) -> bool:
    """Whether the file states "arithmetic": "float64"."""
    if "arithmetic" not in data:
        return False
    value = data["arithmetic"]
    if value not in ("exact", "float64"):
        raise FormatError(f"arithmetic is {shown(value)}, expected 'float64' (or 'exact', as without the key)")
    if value == "float64" and "field" in data:
        raise FormatError("a file has either 'arithmetic': 'float64' or a 'field', not both")
    return bool(value == "float64")


def as_list(value: object, what: str) -> list[Any]:
    """List in a JSON value (from Python also a tuple); `FormatError` names `what` if the value is not a list."""
    if not isinstance(value, (list, tuple)):
        raise FormatError(f"{what} must be a list, not {kind_of(value)}")
    return list(value) if isinstance(value, tuple) else value


def kind_of(value: object) -> str:
    """Kind of a JSON value in words, with its article."""
    if value is None:
        return "null"
    return next((words for kind, words in KINDS if isinstance(value, kind)), f"a {type(value).__name__}")


def shown(value: object) -> str:
    """Short ASCII repr for messages; it works for huge integers and deep nesting too."""
    try:
        text = ascii(value)
    except (ValueError, RecursionError):  # an integer of too many digits for Python to print
        return f"{kind_of(value)} too long to show"
    return text if len(text) <= MAX_SHOWN else text[: MAX_SHOWN - 3] + "..."


def fraction_for(value: float) -> str:
    """Fraction that a decimal float was probably meant to be, as a string; "p/q" if it is very large or small."""
    return str(Fraction(repr(value))) if (value == 0 or 1e-12 < abs(value) < 1e15) else "p/q"


# Lists of JSON values as numbers of a field, with a fast path for integers. A value is a JSON integer or a string in
# the grammar of values; in a float64 file also a JSON float. Equal strings are parsed once, and a list of plain
# integers is converted at once.

DIGITS = b"0123456789-,"
FIELD_NAME = re.compile(r"(?!sqrt$)[A-Za-z][A-Za-z_0-9]{0,40}|sqrt\([0-9]+\)", re.ASCII)

Where: TypeAlias = Callable[[int], str]  # name of the x-th value of a list in messages, such as "point[2]"
JsonNumber: TypeAlias = int | str | float


@final
@dataclass(frozen=True, slots=True)
class RawList:
    """JSON integers, strings or floats, and the distinct ones; ``where(x)`` names the place of the x-th."""

    values: Sequence[JsonNumber]
    where: Where
    distinct: Set[JsonNumber]

    @classmethod
    def checked(cls, values: Sequence[Any], where: Where, *, floats: bool = False) -> RawList:
        """List of checked values; `FormatError` names the first value that is not a number."""
        allowed = {int, str, float} if floats else {int, str}
        types = set(map(type, values))
        if not types <= allowed:
            for x, value in enumerate(values):
                if type(value) not in allowed:
                    raise FormatError(_not_a_value(value, where(x)))
        if float in types:
            for x, value in enumerate(values):
                if type(value) is float and not math.isfinite(value):
                    raise FormatError(f"{where(x)} is {value!r}, expected a finite number")
        return cls(values, where, set(values))

    def radicals(self) -> set[str]:
        """Distinct strings with a square root, on which the field depends; complex values are replaced by real ones."""
        radicals = (v for v in self.distinct if type(v) is str and "s" in v)
        return {str(x) for v in radicals for x in field_determining_values(v)}

    def has_complex(self) -> bool:
        """Whether a string has the imaginary unit i or I."""
        return any(type(v) is str and is_complex(v) for v in self.distinct)

    def integers(self) -> list[int] | None:
        """Values as Python integers if all are plain integers of moderate length, else None."""
        strings = [v for v in self.distinct if type(v) is str]
        joined = ",".join(strings)
        if joined.count(",") >= max(len(strings), 1) or not joined.isascii() or joined.encode().translate(None, DIGITS):
            return None
        try:
            table: dict[Any, int] = dict(zip(strings, map(int, strings), strict=True))
        except ValueError:  # '' or '1-2' or thousands of digits: the grammar of values decides
            return None
        if len(strings) < len(self.distinct):
            table.update((v, v) for v in self.distinct if type(v) is int)
        return list(map(table.__getitem__, self.values))

    def numbers(self, field: Field) -> list[Scalar]:
        """Values as elements of a field; each distinct value is converted once."""
        table: dict[Any, Scalar] = {}
        for x, value in enumerate(self.values):
            if value not in table:
                table[value] = self._number(field, x, value)
        return list(map(table.__getitem__, self.values))

    def _number(self, field: Field, x: int, value: JsonNumber) -> Scalar:
        try:
            return field.convert(value)
        except ParseError as error:
            raise ParseError(f"{self.where(x)}: {error}") from None
        except (FieldError, OverflowError) as error:
            raise FormatError(f"{self.where(x)}: {error}") from None

    def matrix(self, field: Field, nrows: int, ncols: int) -> Matrix:
        """Matrix (nrows, ncols) of the values, row after row."""
        if isinstance(field, ExactField):
            integers = self.integers()
            if integers is not None:
                return field.from_integers(integers, nrows, ncols)
        return field.from_entries(self.numbers(field), nrows, ncols)


def _not_a_value(value: object, place: str) -> str:
    if type(value) is float:
        if not math.isfinite(value):
            return f"{place} is {value!r}, expected a finite number"
        return (
            f"{place} is the float {value!r}, and the data are exact: write the fraction "
            f'"{fraction_for(value)}", or add "arithmetic": "float64" to the file'
        )
    return f"{place} must be an integer or a string such as '3/4', not {kind_of(value)}"


def table_of_rows(
    value: object, what: str, width: int | None = None, *, floats: bool = False
) -> tuple[RawList, int, int]:
    """Triple (values row after row, number of rows, number of columns) of a list of rows of equal length."""
    rows = [as_list(row, f"{what}[{i}]") for i, row in enumerate(as_list(value, what))]
    ncols = width if width is not None else len(rows[0]) if rows else 0
    for i, row in enumerate(rows):
        if len(row) != ncols:
            raise ShapeError(f"{what}[{i}] has length {len(row)}, expected {ncols}")
    flat = [x for row in rows for x in row]
    raw = RawList.checked(flat, lambda x: f"{what}[{x // ncols}][{x % ncols}]", floats=floats)
    return raw, len(rows), ncols


def vector(value: object, what: str, *, floats: bool = False) -> RawList:
    """Checked list of numbers; `FormatError` if the value is not one."""
    return RawList.checked(as_list(value, what), lambda x: f"{what}[{x}]", floats=floats)


# -- fields ----------------------------------------------------------------------------------------------
def field_for(data: Mapping[str, Any], lists: Sequence[RawList], numerical: bool) -> Field:
    """Field of a file: float64, the number field that it states, or the smallest field of its values."""
    if "tolerance" in data:
        return _float_field(data["tolerance"], numerical)
    if numerical:
        return RR
    if "field" in data:
        return read_field(data["field"])
    radicals: set[str] = set().union(*(raw.radicals() for raw in lists))
    try:
        return common_field(sorted(radicals))
    except LimitError:
        raise
    except InputError:
        for raw in lists:  # one by one, to name the position
            for x, value in enumerate(raw.values):
                if type(value) is str:
                    _own_field(str(field_determining_values(value)[0]), raw.where(x))
        raise FormatError(
            "the radicals of this file together need a number field that must be stated as 'field'"
        ) from None


def _own_field(text: str, place: str) -> None:
    try:
        common_field([text])
    except ParseError as error:
        raise ParseError(f"{place}: {error}") from None
    except LimitError:
        raise
    except InputError as error:
        raise FormatError(f"{place}: {error}") from None


def read_field(data: object) -> NumberField:
    """Number field of a JSON object {"name", "minpoly", "interval"}."""
    if not isinstance(data, Mapping):
        raise FormatError(f"field must be an object, not {kind_of(data)}")
    check_keys(data, ("name", "minpoly", "interval"), (), "field")
    name = data["name"]
    if not isinstance(name, str) or not FIELD_NAME.fullmatch(name):
        raise FormatError(f"field.name is {shown(name)}, expected an identifier such as 'a' other than 'sqrt'")
    minpoly = vector(data["minpoly"], "field.minpoly").numbers(QQ)
    interval = vector(data["interval"], "field.interval").numbers(QQ)
    if len(interval) != 2:
        raise FormatError(f"field.interval must have two ends, it has {len(interval)}")
    try:
        return NumberField(name, minpoly, (interval[0], interval[1]))
    except LimitError:
        raise
    except InputError as error:
        raise FormatError(f"field: {error}") from None


def _float_field(tolerance: object, numerical: bool) -> FloatField:
    if not numerical or not isinstance(tolerance, float) or not 0 < tolerance < 1:
        expected = "a number between 0 and 1" if numerical else 'no such key without "arithmetic": "float64"'
        raise FormatError(f"tolerance is {shown(tolerance)}, expected {expected}")
    return FloatField(tolerance)


def write_field(field: Field) -> dict[str, Any]:
    """Keys of a file that state a field: none for QQ, `arithmetic` (and `tolerance`) for float64, else `field`."""
    if isinstance(field, FloatField):
        return {"arithmetic": "float64"} if field == RR else {"arithmetic": "float64", "tolerance": float(field.rtol)}
    if not isinstance(field, NumberField):
        return {}
    ends = [str(end) for end in field.interval]
    return {
        "field": {"name": field.symbol, "minpoly": [QQ.format(QQ.convert(c)) for c in field.minpoly], "interval": ends}
    }


def write_number(field: Field, value: Scalar) -> float | str:
    """JSON value of a number: a float in a float64 file, else a string."""
    return float(value) if isinstance(field, FloatField) else field.format(value)
