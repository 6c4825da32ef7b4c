"""Strict JSON: a string or file holds one object, without repeated keys, NaN or infinities."""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Mapping
from contextlib import nullcontext
from fractions import Fraction
from typing import Any, BinaryIO, NoReturn, TypeAlias

from liehom.budget import current_limits, within
from liehom.disk import checksum
from liehom.errors import FormatError

Source: TypeAlias = str | os.PathLike[str] | BinaryIO
"""A path, or a file that is open in binary mode, such as ``sys.stdin.buffer``."""
CHECKSUM = "checksum"
"""Key of the checksum, which any file may have."""
MAX_SHOWN = 60
"""Characters of a value that a message shows."""
OTHER_TOOLS = (
    "`liehom describe` reads a file of GAP if it ends in .g or .gap, one of Sage if it ends in .sage; "
    "liehom.io.from_gap and from_sage read strings"
)
CHUNK = 1 << 20
"""Bytes that are read at once."""
MAX_INTEGER_DIGITS = 4000
"""Longer integers stay strings: Python refuses to convert them, the grammar of values does not."""


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
    liehom.errors.FormatError: 'no/such/file.json' cannot be read: No such file or directory
    """
    text = read_text(path, "a JSON file")
    try:
        return parse_object(text)
    except FormatError as error:
        if str(error).startswith("not JSON") and not text.lstrip().startswith("{"):
            raise FormatError(f"{error}; {OTHER_TOOLS}") from None
        raise


def read_text(path: Source, expected: str) -> str:
    """Text of a file in UTF-8, of which no more is read than the limit allows, even if the file has no end.

    Raises
    ------
    FormatError
        If the file cannot be read, or is not UTF-8.
    LimitError
        If it is larger than the limit.

    Examples
    --------
    >>> read_text("/dev/zero", "a JSON file")
    Traceback (most recent call last):
    ...
    liehom.errors.LimitError: the file '/dev/zero' has 67108865 bytes or more, the limit is 67108864; raise it by ...
    """
    if not isinstance(path, str | os.PathLike) and not hasattr(
        path, "read"
    ):  # an integer is the number of an open file
        raise FormatError(f"expected the path of a file, or a file open in binary mode, got {shown(path)}")
    name = shown(str(path)) if isinstance(path, str | os.PathLike) else str(getattr(path, "name", "it"))
    try:
        with open(path, "rb", buffering=0) if isinstance(path, str | os.PathLike) else nullcontext(path) as file:
            found = _content(file)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FormatError(f"{name} cannot be read: {reason}") from None
    within("file_bytes", len(found), f"the file {name} has {{}} bytes or more")
    try:
        return found.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FormatError(f"{name} is not text in UTF-8 (byte {error.start}), so not {expected}") from None


def _content(file: BinaryIO) -> bytearray:
    """Bytes of an open file, at most one more than the limit."""
    allowed = current_limits().file_bytes
    found = bytearray()
    while len(found) <= allowed and (part := file.read(min(CHUNK, allowed + 1 - len(found)))):
        if not isinstance(part, bytes):
            raise FormatError("the file is open in text mode, expected binary mode: open(path, 'rb')")
        found += part
    return found


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
    liehom.errors.FormatError: the key 'dimension' is given twice
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
    """Checksum of a JSON object, whatever the order of its keys.

    Examples
    --------
    >>> json_checksum({"a": 1, "b": 2}) == json_checksum({"b": 2, "a": 1})
    True
    """
    return checksum({}, json.dumps(data, sort_keys=True))


def _without_checksum(data: dict[str, Any]) -> dict[str, Any]:
    """The object without its checksum, if it has one; `FormatError` if the checksum does not agree."""
    if CHECKSUM not in data:
        return data
    stored = data.pop(CHECKSUM)
    if stored != json_checksum(data):
        raise FormatError(
            f"the file is damaged: its {CHECKSUM!r} does not agree with its contents; if it was edited on purpose, "
            f"delete the key {CHECKSUM!r}"
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
    found = dict(items)
    if len(found) < len(items):
        seen: set[str] = set()
        for key, _ in items:
            if key in seen:
                raise FormatError(f"the key {key!r} is given twice")
            seen.add(key)
    return found


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
    match value:
        case None:
            return "null"
        case bool():
            return "a boolean"
        case dict():
            return "an object"
        case list() | tuple():
            return "a list"
        case str():
            return "a string"
        case int() | float():
            return "a number"
    return f"a {type(value).__name__}"


def shown(value: object) -> str:
    """Short ASCII repr for messages; it works for huge integers and deep nesting too."""
    try:
        text = ascii(value)
    except (ValueError, RecursionError):  # an integer of too many digits for Python to print
        return f"{kind_of(value)} too long to show"
    return text if len(text) <= MAX_SHOWN else text[: MAX_SHOWN - 3] + "..."


def fraction_for(value: float) -> str:
    """Fraction that a decimal float was probably meant to be, as a string; "p/q" if it is very large or small.

    Examples
    --------
    >>> fraction_for(0.1), fraction_for(2.0)
    ('1/10', '2')
    """
    plausible = value == 0 or 1e-12 < abs(value) < 1e15
    return str(Fraction(repr(value))) if plausible else "p/q"
