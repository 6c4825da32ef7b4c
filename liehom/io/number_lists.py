"""Lists of JSON values as numbers of a field, with a fast path for integers.

A value is a JSON integer or a text in the grammar of values; in a float64 file also a JSON float.  Equal
texts are parsed once, and a list of plain integers is converted in one go.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, final

from liehom.errors import FieldError, FormatError, InputError, ParseError, ShapeError
from liehom.io.json_reader import as_list, check_keys, fraction_for, kind_of, shown
from liehom.scalars import QQ, RR, Field, FloatField, NumberField, Scalar, common_field

DIGITS = b"0123456789-,"
FIELD_NAME = re.compile(r"(?!sqrt$)[A-Za-z][A-Za-z_0-9]{0,40}|sqrt\([0-9]{1,40}\)", re.ASCII)
MAX_DEGREE = 64

Where = Callable[[int], str]


@final
@dataclass(frozen=True, slots=True)
class RawList:
    """JSON values in a row, each known to be an integer or a text (or a float where `floats`).

    Attributes
    ----------
    values : sequence
    where : callable
        Names the place of the x-th value in the file.
    distinct : set
        The different values (1 and 1.0 count as one).
    """

    values: Sequence[Any]
    where: Where
    distinct: Set[Any]

    @classmethod
    def checked(cls, values: Sequence[Any], where: Where, *, floats: bool = False) -> RawList:
        """The list, after a check of the types; `FormatError` names the first value that is no number."""
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

    def texts(self) -> set[str]:
        """The distinct texts with a radical in them, on which the field depends."""
        return {v for v in self.distinct if type(v) is str and "s" in v}

    def integers(self) -> list[int] | None:
        """The values as Python integers if all are plain integers of moderate length, else None."""
        texts = [v for v in self.distinct if type(v) is str]
        joined = ",".join(texts)
        if joined.count(",") >= max(len(texts), 1) or not joined.isascii():
            return None
        if joined.encode().translate(None, DIGITS):
            return None
        try:
            table: dict[Any, int] = dict(zip(texts, map(int, texts), strict=True))
        except ValueError:  # '' or '1-2' or thousands of digits: the grammar of values decides
            return None
        if len(texts) < len(self.distinct):
            table.update((v, v) for v in self.distinct if type(v) is int)
        return list(map(table.__getitem__, self.values))

    def numbers(self, field: Field) -> list[Scalar]:
        """The values as elements of a field; each distinct one is converted once.

        Raises
        ------
        ParseError
            If a text is not of the grammar; names the place.
        FormatError
            If a number is not in the field; names the place.
        """
        table: dict[Any, Scalar] = {}
        for x, value in enumerate(self.values):
            if value not in table:
                table[value] = self._number(field, x, value)
        return list(map(table.__getitem__, self.values))

    def _number(self, field: Field, x: int, value: Any) -> Scalar:
        try:
            return field.convert(value)
        except ParseError as error:
            raise ParseError(f"{self.where(x)}: {error}") from None
        except (FieldError, OverflowError) as error:
            raise FormatError(f"{self.where(x)}: {error}") from None

    def matrix(self, field: Any, nrows: int, ncols: int) -> Any:
        """The values, row after row, as a matrix."""
        if field.exact:
            integers = self.integers()
            if integers is not None:
                return field.from_integers(integers, nrows, ncols)
        return field.from_entries(self.numbers(field), nrows, ncols)


def _not_a_value(value: Any, place: str) -> str:
    if type(value) is float:
        if not math.isfinite(value):
            return f"{place} is {value!r}, expected a finite number"
        return (
            f"{place} is the float {value!r}, and this file is exact: write the fraction "
            f'"{fraction_for(value)}", or add "arithmetic": "float64"'
        )
    return f"{place} must be an integer or a text such as '3/4', not {kind_of(value)}"


def table_of_rows(value: Any, what: str, width: int | None = None, *, floats: bool = False) -> tuple[RawList, int, int]:
    """A list of rows of equal length as (its values row after row, number of rows, number of columns).

    Raises
    ------
    FormatError
        If it is not a list of lists of numbers.
    ShapeError
        If a row does not have the expected width, or the width of the first row.
    """
    rows = [as_list(row, f"{what}[{i}]") for i, row in enumerate(as_list(value, what))]
    ncols = width if width is not None else len(rows[0]) if rows else 0
    for i, row in enumerate(rows):
        if len(row) != ncols:
            raise ShapeError(f"{what}[{i}] has length {len(row)}, expected {ncols}")
    flat = [x for row in rows for x in row]
    raw = RawList.checked(flat, lambda x: f"{what}[{x // ncols}][{x % ncols}]", floats=floats)
    return raw, len(rows), ncols


def vector(value: Any, what: str, *, floats: bool = False) -> RawList:
    """A list of numbers, or a `FormatError`."""
    return RawList.checked(as_list(value, what), lambda x: f"{what}[{x}]", floats=floats)


# -- fields ----------------------------------------------------------------------------------------------
def field_for(data: Mapping[str, Any], lists: Sequence[RawList], numerical: bool) -> Field:
    """The field of a file: float64, the one it states, or the smallest that holds its values.

    Raises
    ------
    FormatError
        If the stated field is malformed, or the values call for one that must be stated.
    ParseError
        If a value is not of the grammar; names its place.
    """
    if numerical:
        return RR
    if "field" in data:
        return read_field(data["field"])
    texts = set().union(*(raw.texts() for raw in lists))
    try:
        return common_field(sorted(texts))
    except InputError:
        for raw in lists:  # again one by one, to name the place
            for x, value in enumerate(raw.values):
                if type(value) is str:
                    _own_field(value, raw.where(x))
        raise FormatError(
            "the radicals of this file together need a number field that must be stated as 'field'"
        ) from None


def _own_field(text: str, place: str) -> None:
    try:
        common_field([text])
    except ParseError as error:
        raise ParseError(f"{place}: {error}") from None
    except InputError as error:
        raise FormatError(f"{place}: {error}") from None


def read_field(data: Any) -> NumberField:
    """The number field of {"name", "minpoly", "interval"}.

    Raises
    ------
    FormatError

    Examples
    --------
    >>> read_field({"name": "a", "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]})
    QQ(a)
    """
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
    if len(minpoly) > MAX_DEGREE + 1:
        raise FormatError(f"field.minpoly has degree {len(minpoly) - 1}, at most {MAX_DEGREE} is allowed in a file")
    try:
        found = NumberField(name, minpoly, (interval[0], interval[1]))
    except InputError as error:
        raise FormatError(f"field: {error}") from None
    if name.startswith("sqrt") and found.minpoly != (-int(name[5:-1]), 0, 1):
        raise FormatError(f"field: {name} is not a root of its minpoly; give the generator another name")
    return found


def write_field(field: Field) -> dict[str, Any]:
    """The keys of a file that state a field: none for QQ, `arithmetic` for float64, else `field`."""
    if isinstance(field, FloatField):
        return {"arithmetic": "float64"}
    if not isinstance(field, NumberField):
        return {}
    ends = [str(end) for end in field.interval]
    return {
        "field": {"name": field.symbol, "minpoly": [QQ.format(QQ.convert(c)) for c in field.minpoly], "interval": ends}
    }


def write_number(field: Field, value: Scalar) -> Any:
    """A number as a file has it: a float in a float64 file, else a text."""
    return float(value) if isinstance(field, FloatField) else field.format(value)
