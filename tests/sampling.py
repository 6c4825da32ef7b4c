"""Which cases of an expensive table run by default: an evenly spread sample. With `--slow` every table is whole.

`samples.toml` names the tables: for each test module how many cases of a test run by default, and which single cases
are so expensive that only `--slow` runs them. The sample is the same in every run: case i comes at the place of the
fractional part of i times the golden ratio, so that any number of cases is spread over all axes of a table.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any, Protocol, TypeVar

FILE = Path(__file__).with_name("samples.toml")
ROOT = FILE.parent.parent
GOLDEN_RATIO = 0.6180339887498949
EXAMPLES_PER_DEFAULT_EXAMPLE = 4  # hypothesis draws this many times more examples with `--slow`

whole = False  # set by conftest before any test module is imported


class Item(Protocol):
    """What of a pytest item decides whether it is in the sample."""

    name: str
    path: Path


I = TypeVar("I", bound=Item)


def table() -> dict[str, dict[str, Any]]:
    """For each test module, `sample` (test: number of cases by default) and `slow` (cases that only `--slow` runs)."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def spread(count: int, size: int) -> set[int]:
    """The indices of a sample of `size` out of `count` cases."""
    return set(sorted(range(count), key=lambda i: (i + 1) * GOLDEN_RATIO % 1)[:size])


def left_out(items: list[I], tables: dict[str, dict[str, Any]]) -> list[I]:
    """The items that do not run by default.

    Raises
    ------
    ValueError
        If a table names a slow case that its module does not have, since the case would run by default in silence.
    """
    cases: dict[tuple[str, str], list[I]] = defaultdict(list)
    names: dict[str, set[str]] = defaultdict(set)
    out = []
    for item in items:
        module = item.path.relative_to(ROOT).as_posix() if item.path.is_relative_to(ROOT) else ""
        entry = tables.get(module, {})
        names[module].add(item.name)
        test = item.name.split("[")[0]
        if item.name in entry.get("slow", ()):
            out.append(item)
        elif test in entry.get("sample", ()):
            cases[module, test].append(item)
    for module, found in names.items():
        if missing := set(tables.get(module, {}).get("slow", ())) - found:
            raise ValueError(f"{FILE.name}: {module} has no case {sorted(missing)}")
    for (module, test), group in cases.items():
        kept = spread(len(group), tables[module]["sample"][test])
        out += [item for i, item in enumerate(group) if i not in kept]
    return out


def examples(count: int) -> int:
    """How many examples hypothesis draws: `count` with `--slow`, a share of them by default."""
    return count if whole else max(5, count // EXAMPLES_PER_DEFAULT_EXAMPLE)
