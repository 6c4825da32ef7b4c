"""Values of results: kept as they are where they are short, and by their digests where they are long."""

import dataclasses
import hashlib
import json
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

LETTERS = 16
PLACES = 5
LATER = ("near_steps", "unkept_from", "stopped_at")
"""Attributes of reports that 0.1.0 did not have."""


class Long:
    """A long value: printed in full, recorded by a digest of its canonical JSON."""

    def __init__(self, value: Any, about: str = "") -> None:
        self.value, self.about = value, about

    def short(self) -> str:
        text = json.dumps(self.value, sort_keys=True, separators=(",", ":"))
        return f"{self.about} {digest(text.encode())}".strip()

    def __str__(self) -> str:
        return json.dumps(self.value)


class Numbers:
    """An array of floats: recorded by its shape, a digest of its bytes and a few values along the last axis."""

    def __init__(self, array: Any) -> None:
        self.array = np.asarray(array)

    def short(self) -> str:
        a = self.array
        content = a
        if a.dtype == np.longdouble:  # without the padding bytes, which are arbitrary
            high = a.astype(np.float64)
            content = np.stack([high, (a - high).astype(np.float64)])
        shown = ""
        if a.size and a.dtype.kind == "f":
            row = a.reshape(-1, a.shape[-1])[0]
            picked = np.unique(np.linspace(0, len(row) - 1, PLACES).astype(int))
            shown = " at " + ", ".join(f"{i}: {float(row[i]).hex()}" for i in picked)
        return f"{a.dtype} {a.shape} {digest(np.ascontiguousarray(content).tobytes())}{shown}"

    def __str__(self) -> str:
        return str([_hex(x) for x in self.array.ravel()])


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:LETTERS]


def rows(matrix: Any, field: Any) -> Long:
    return Long([field.format(x) for x in matrix.entries()], f"{matrix.nrows} x {matrix.ncols}")


def flat(value: Any) -> Iterator[Any]:
    """The numbers in a report, by position, so that names do not matter; strings are left out."""
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            if field.name not in LATER:
                yield from flat(getattr(value, field.name))
    elif isinstance(value, dict):
        for item in value.values():
            yield from flat(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from flat(item)
    elif isinstance(value, np.ndarray):
        yield from map(_hex, value.ravel())
    elif not isinstance(value, str):
        yield _hex(value)


def _hex(value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        return value.hex()
    return str(value) if isinstance(value, Fraction | np.longdouble) else value
