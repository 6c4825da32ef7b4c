"""From the words of a command to pairs, points and rows. Imports io, catalog."""

from __future__ import annotations

import os
from typing import Any

from liehom.errors import FormatError
from liehom.io import load_pair
from liehom.io.json_text import parse_object
from liehom.io.values import vector
from liehom.representations import Pair, Representation
from liehom.scalars import RR, common_field


def is_file(text: str) -> bool:
    """Whether an argument names a file rather than an entry of the catalogue."""
    return os.path.exists(text) or text.endswith(".json")


def pair_argument(text: str) -> Pair:
    """The pair of a file or of a catalogue name.

    Raises
    ------
    FormatError, CatalogError
    """
    if is_file(text):
        return load_pair(text)
    from liehom.catalog import pair

    return pair(text)


def row_values(text: str, what: str) -> list[Any]:
    """The JSON values of a row on the command line: '1, 0, sqrt(2)' or '["1", "0"]'.

    Examples
    --------
    >>> row_values("1, -2/3", "psi")
    ['1', '-2/3']
    """
    stripped = text.strip()
    if stripped.startswith("["):
        values = parse_object(f'{{"row": {stripped}}}')["row"]
        if not isinstance(values, list):
            raise FormatError(f"{what} is {text!r}, expected a row such as '1,0,-2/3'")
        return values
    return [part.strip() for part in stripped.split(",")] if stripped else []


def row_in(field: Any, text: str, what: str) -> list[Any]:
    """A row on the command line as elements of a field."""
    return vector(row_values(text, what), what, floats=not field.exact).numbers(field)


def point_in(representation: Representation, text: str) -> tuple[Representation, list[Any]]:
    """A point on the command line, and the representation over a field that holds it.

    Floats make the answer numerical; a square root extends QQ.
    """
    raw = vector(row_values(text, "point"), "point", floats=True)
    if representation.field.exact and any(type(x) is float for x in raw.values):
        return representation.over(RR), raw.numbers(RR)
    needed = common_field(sorted(raw.texts())) if representation.field.degree == 1 else None
    if representation.field.exact and needed is not None and needed.degree > 1:
        representation = representation.over(needed)
    return representation, raw.numbers(representation.field)
