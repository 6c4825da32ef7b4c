"""Values of results: kept as they are where they are short, and by their digests where they are long."""

import hashlib
import json
from collections.abc import Iterator
from typing import Any

LETTERS = 16


class Long:
    """A long value: printed in full, recorded by a digest of its canonical JSON."""

    def __init__(self, value: Any, about: str = "") -> None:
        self.value, self.about = value, about

    def short(self) -> str:
        text = json.dumps(self.value, sort_keys=True, separators=(",", ":"))
        return f"{self.about} {digest(text.encode())}".strip()

    def __str__(self) -> str:
        return json.dumps(self.value)


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:LETTERS]


def rows(matrix: Any, field: Any) -> Long:
    return Long([field.format(x) for x in matrix.entries()], f"{matrix.nrows} x {matrix.ncols}")


def flat(value: Any) -> Iterator[Any]:
    """The numbers in nested lists, floats in hexadecimal."""
    if isinstance(value, list):
        for item in value:
            yield from flat(item)
    else:
        yield value.hex() if isinstance(value, float) else value
