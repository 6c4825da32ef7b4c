"""Lists of JSON values as numbers of a field, with a fast path for integers.

A value is a JSON integer or a string in the grammar of values; in a float64 file also a JSON float. Equal strings are
parsed once, and a list of plain integers is converted at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, TypeAlias, final

from liehom.errors import FieldError, FormatError, InputError, LimitError, ParseError, ShapeError
from liehom.io.json_reader import as_list, check_keys, fraction_for, kind_of, shown
from liehom.scalars import QQ, RR, ExactField, Field, FloatField, Matrix, NumberField, Scalar, common_field
from liehom.scalars.fields.complex_parts import field_determining_values, is_complex

DIGITS = b"0123456789-,"
FIELD_NAME = re.compile(r"(?!sqrt$)[A-Za-z][A-Za-z_0-9]{0,40}|sqrt\([0-9]+\)", re.ASCII)

Where: TypeAlias = Callable[[int], str]
"""Name of the x-th value of a list in messages, such as "point[2]"."""
JsonNumber: TypeAlias = int | str | float


@final
@dataclass(frozen=True, slots=True)
class RawList:
    """List of JSON values that are integers or strings, or floats if these are allowed.

    Attributes
    ----------
    values : sequence of int, str or float
    where : callable
        ``where(x)`` names the position of the x-th value in the file, for messages.
    distinct : set
        The distinct values (1 and 1.0 count as one).
    """

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
        """Distinct strings with an "s" in them, hence all with a square root, on which the field depends.

        Complex values are replaced by real ones with the same square roots.
        """
        radicals = (v for v in self.distinct if type(v) is str and "s" in v)
        return {str(x) for v in radicals for x in field_determining_values(v)}

    def has_complex(self) -> bool:
        """Whether a string has the imaginary unit i or I."""
        return any(type(v) is str and is_complex(v) for v in self.distinct)

    def integers(self) -> list[int] | None:
        """Values as Python integers if all are plain integers of moderate length, else None."""
        strings = [v for v in self.distinct if type(v) is str]
        joined = ",".join(strings)
        if joined.count(",") >= max(len(strings), 1) or not joined.isascii():
            return None
        if joined.encode().translate(None, DIGITS):
            return None
        try:
            table: dict[Any, int] = dict(zip(strings, map(int, strings), strict=True))
        except ValueError:  # '' or '1-2' or thousands of digits: the grammar of values decides
            return None
        if len(strings) < len(self.distinct):
            table.update((v, v) for v in self.distinct if type(v) is int)
        return list(map(table.__getitem__, self.values))

    def numbers(self, field: Field) -> list[Scalar]:
        """Values as elements of a field; each distinct value is converted once.

        Raises
        ------
        ParseError
            If a string is not in the grammar; names its position.
        FormatError
            If a number is not in the field; names its position.
        """
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
        matrix: Matrix = field.from_entries(self.numbers(field), nrows, ncols)
        return matrix


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
    """Triple (values row after row, number of rows, number of columns) of a list of rows of equal length.

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


def vector(value: object, what: str, *, floats: bool = False) -> RawList:
    """Checked list of numbers; `FormatError` if the value is not one."""
    return RawList.checked(as_list(value, what), lambda x: f"{what}[{x}]", floats=floats)


# -- fields ----------------------------------------------------------------------------------------------
def field_for(data: Mapping[str, Any], lists: Sequence[RawList], numerical: bool) -> Field:
    """Field of a file: float64, the number field that it states, or the smallest field of its values.

    Raises
    ------
    FormatError
        If the stated field is malformed, or the values need a number field that must be stated.
    ParseError
        If a value is not in the grammar; names its position.
    """
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
    """Number field of a JSON object {"name", "minpoly", "interval"}.

    Raises
    ------
    FormatError
        If the object is malformed, or does not determine one real root of an irreducible polynomial.

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
