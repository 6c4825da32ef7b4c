"""Printing of results: panels on a terminal, plain lines in a pipe, one object with --json."""

from __future__ import annotations

import json
import math
import sys
import textwrap
from collections.abc import Mapping, Sequence
from shutil import get_terminal_size
from typing import Any

from liehom.cli.terminal.steps import step

STYLES = {0: "green", 1: "red", 3: "yellow"}
"""Colour of a panel for each exit code."""


def show_json(data: Mapping[str, Any]) -> None:
    """Print one JSON object to standard output."""
    step("")
    print(json.dumps(finite(data), allow_nan=False))


def finite(value: Any) -> Any:
    """The value with infinities and NaN as strings, since JSON has no such numbers.

    Examples
    --------
    >>> finite({"gap": float("inf")})
    {'gap': 'inf'}
    """
    if isinstance(value, Mapping):
        return {key: finite(x) for key, x in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(x) for x in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def show_answer(sentence: str, rows: Sequence[tuple[str, str]], code: int = 0) -> None:
    """Print a sentence and labelled facts below it."""
    step("")
    if not sys.stdout.isatty():
        width = max((len(name) for name, _ in rows), default=0)
        print(sentence)
        for name, value in rows:
            print(f"  {name:<{width}}  {value}")
        return
    from rich.console import Console, Group
    from rich.panel import Panel
    from rich.table import Table
    from rich.text import Text

    table = Table.grid(padding=(0, 2))
    for name, value in rows:
        table.add_row(Text(name, style="dim"), Text(value))
    style = STYLES.get(code, "green")
    body = Group(Text(sentence, style=f"bold {style}"), Text(""), table)
    Console().print(Panel(body, border_style=style, expand=False))


def show_lines(lines: Sequence[str]) -> None:
    """Print lines, the first of which is the title."""
    step("")
    if not sys.stdout.isatty():
        print("\n".join(lines))
        return
    from rich.console import Console, Group
    from rich.panel import Panel
    from rich.text import Text

    console = Console()
    body = Group(Text(lines[0], style="bold green"), *(Text(_indented(line, console.width - 4)) for line in lines[1:]))
    console.print(Panel(body, border_style="green", expand=False))


def _indented(line: str, width: int) -> str:
    """The line wrapped at a width; the lines below the first are indented by two spaces more."""
    indent = line[: len(line) - len(line.lstrip())]
    return textwrap.fill(line, max(width, 20), subsequent_indent=f"{indent}  ", break_on_hyphens=False)


def show_table(columns: Sequence[str], rows: Sequence[Sequence[str]], *, header: bool = True) -> None:
    """Print a table; as aligned plain lines in a pipe, or if the terminal is too narrow for the longest words."""
    step("")
    if not sys.stdout.isatty() or _least_width(columns, rows) > get_terminal_size().columns:
        shown = [columns, *rows] if header else list(rows)
        widths = [max(len(row[c]) for row in shown) for c in range(len(columns))] if shown else []
        for row in shown:
            print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table()
    for column, *cells in zip(columns, *rows, strict=True):
        table.add_column(column, no_wrap=not _wraps(cells))
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    Console().print(table)


def _wraps(cells: Sequence[str]) -> bool:
    """Whether a column has spaces between words, and not only before a number without its sign."""
    return any(" " in cell.strip() for cell in cells)


def _least_width(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> int:
    """Width of a table with lines between its cells, if the cells are wrapped between words wherever possible."""
    width = 1
    for name, *cells in zip(columns, *rows, strict=True):
        parts = [word for cell in cells for word in cell.split()] if _wraps(cells) else cells
        width += 3 + max(len(part) for part in [*parts, *name.split(), ""])
    return width


def short_vector(values: Sequence[str], limit: int = 100) -> str:
    """String of a vector: all entries if it is short, else its nonzero entries, else its length.

    Examples
    --------
    >>> short_vector(["1", "-2"]), short_vector(["0"] * 60 + ["3"])
    ('(1, -2)', '3 e60')
    """
    whole = "(" + ", ".join(values) + ")"
    if len(whole) <= limit:
        return whole
    terms = [f"{v} e{i}" for i, v in enumerate(values) if v != "0"]
    sparse = " + ".join(terms)
    return sparse if len(sparse) <= limit else f"a vector of length {len(values)} with {len(terms)} non-zero entries"
