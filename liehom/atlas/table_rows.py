"""The atlas as a table: one row of short cells for each entry, counts for each family, files of entries.

A file of entries has one JSON object on each line, with the certificate. The table has no certificates; docs/atlas.md
shows its JSON file.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import nullcontext
from typing import Any, BinaryIO

from liehom.atlas.entry import Entry
from liehom.disk import write_atomically
from liehom.errors import FormatError, displayed

COLUMNS = (
    "pair",
    "family",
    "dim g",
    "dim h",
    "dim g/h",
    "full",
    "letter",
    "row",
    "range",
    "orbit",
    "degree",
    "open orbits",
    "rank",
    "reason",
)
"""Names of the cells of a row. In all of them None is a question without an answer for this pair."""

MISSING = "?"
"""Cell of a fact that is not proved, or not computed within the limit."""


FACTS = ("range_condition", "orbit_dimension", "invariant_degree", "open_orbits")

COUNTS = ("pairs", "full", "not full", "undecided", "A", "B", "C", "range holds", "facts missing")
"""What is counted in each family; A, B and C are the full pairs by the letter of their row."""


def table_row(entry: Entry) -> list[str | int | bool | None]:
    """The cells of an entry, in the order of `COLUMNS`.

    Examples
    --------
    >>> import liehom as lh
    >>> table_row(next(lh.atlas.build(["parabolic"])))[:6]
    ['sl(2)/P{1}', 'parabolic', 3, 2, 1, True]
    """
    facts, g, h = entry.facts, entry.dimension, entry.subalgebra_dimension
    missing = facts.get("missing", {})
    return [
        entry.name,
        entry.family,
        g,
        h,
        None if g is None or h is None else g - h,
        entry.full,
        (facts.get("key") or [None])[0],
        facts.get("space"),
        *(MISSING if name in missing else facts.get(name) for name in FACTS),
        facts.get("rank"),
        entry.reason.partition(";")[0],
    ]


def table(entries: Iterable[Entry]) -> dict[str, Any]:
    """The rows of entries and the counts of their families, a JSON object.

    Examples
    --------
    >>> import liehom as lh
    >>> table(lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"]))["counts"][""]["full"]
    1
    """
    rows = []
    counts: dict[str, dict[str, float]] = {}
    for entry in entries:
        cells = table_row(entry)
        rows.append(cells)
        own = counts.setdefault(entry.family, dict.fromkeys((*COUNTS, "seconds"), 0))
        own["pairs"] += 1
        own[{True: "full", False: "not full", None: "undecided"}[entry.full]] += 1
        if (letter := cells[COLUMNS.index("letter")]) is not None:
            own[str(letter)] += 1
        own["range holds"] += entry.facts.get("range_condition") is True
        own["facts missing"] += MISSING in cells
        own["seconds"] += entry.facts.get("seconds", 0)
    for own in counts.values():
        own["seconds"] = round(own["seconds"], 1)
    return {"columns": list(COLUMNS), "counts": counts, "rows": rows}


def write_table(path: str | os.PathLike[str], made: Mapping[str, Any]) -> None:
    """Write a table as a JSON file with one row on each line."""
    head = {key: value for key, value in made.items() if key != "rows"}
    rows = ",\n".join(json.dumps(cells, ensure_ascii=False, separators=(",", ":")) for cells in made["rows"])
    text = json.dumps(head, ensure_ascii=False, separators=(",", ":"))[:-1] + ',"rows":[\n' + rows + "\n]}\n"
    write_atomically(path, text.replace("<", "\\u003c").encode())  # so that a script element of a page can hold it


def write_entries(path: str | os.PathLike[str], entries: Iterable[Entry]) -> dict[str, Any]:
    """Write entries to a file one by one, and return their `table`. The file is there when all are written.

    Examples
    --------
    >>> import tempfile, liehom as lh
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = write_entries(f"{folder}/atlas.jsonl", lh.atlas.build(["parabolic"]))
    ...     entries = list(read_entries(f"{folder}/atlas.jsonl"))
    ...
    >>> made["counts"]["parabolic"]["pairs"] == len(entries)
    True
    """
    made: dict[str, Any] = {}

    def copied(file: BinaryIO) -> Iterator[Entry]:
        for entry in entries:
            file.write(json.dumps(entry.to_json(), separators=(",", ":")).encode() + b"\n")
            yield entry

    write_atomically(path, lambda file: made.update(table(copied(file))))
    return made


def read_entries(path: str | os.PathLike[str] | BinaryIO) -> Iterator[Entry]:
    """Iterator of the entries in a file of entries: its path, or the file open in binary mode.

    Raises
    ------
    FormatError
        If the file cannot be read, or a line is not an entry.
    """
    shown = displayed(str(getattr(path, "name", path)))
    try:
        with open(path, "rb") if isinstance(path, str | os.PathLike) else nullcontext(path) as file:
            for number, line in enumerate(file, 1):
                try:
                    entry = Entry.from_json(json.loads(line))
                    table_row(entry)  # fails if the facts are malformed
                except (ValueError, TypeError, LookupError, AttributeError, RecursionError, FormatError) as error:
                    raise FormatError(f"line {number} of {shown} is not an entry of the atlas: {error}") from None
                yield entry
    except OSError as error:
        raise FormatError(f"{shown} cannot be read: {error.strerror}") from None
