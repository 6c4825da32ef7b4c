"""Data of a reproduction: tables (CSV, Markdown), claims with their evidence, and a plot."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from liehom.disk import check_target, write_atomically
from liehom.display import DisplayedTable, comma_separated
from liehom.errors import FormatError, InputError

Cell: TypeAlias = Any
"""Content of a cell of a table: a string, a number of Python or numpy, or None."""


@dataclass(frozen=True, slots=True)
class Table(DisplayedTable):
    """Named columns and rows of strings and numbers.

    Parameters
    ----------
    title : str
    columns : sequence of str
    rows : sequence of sequences
        Cells are strings or numbers; None and NaN become an empty cell.
    in_markdown : bool, optional
        False for the points of curves; Markdown then shows only the number of rows.

    Raises
    ------
    InputError
        If a row does not have as many cells as there are columns.

    Examples
    --------
    >>> table = Table("errors", ("dt", "error"), [(0.1, 1.25e-7)])
    >>> print(table.markdown())
    | dt | error |
    |---|---|
    | 0.1 | 1.25e-07 |
    >>> table.csv()
    'dt,error\\n0.1,1.25e-07\\n'
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    in_markdown: bool = True

    def __post_init__(self) -> None:
        wrong = [row for row in self.rows if len(row) != len(self.columns)]
        if wrong:
            raise InputError(
                f"a row of the table {self.title!r} has {len(wrong[0])} cells, expected {len(self.columns)}"
            )

    def csv(self) -> str:
        """Table as comma-separated values, numbers with all digits."""
        rows = [["" if _is_empty(x) else _plain(x) for x in row] for row in self.rows]
        return comma_separated([self.columns, *rows])

    def markdown(self) -> str:
        """Table in Markdown, numbers with three digits."""
        lines = ["| " + " | ".join(cells) + " |" for cells in (self.columns, *map(_shown_row, self.rows))]
        lines.insert(1, "|" + "---|" * len(self.columns))
        return "\n".join(lines)

    def _caption(self) -> str:
        return self.title

    def _cells(self) -> list[list[str]]:
        return [list(self.columns), *map(_shown_row, self.rows)]


@dataclass(frozen=True, slots=True)
class Check:
    """Claim of the paper or of its correction, the evidence, and whether the claim holds."""

    claim: str
    found: str
    holds: bool


@dataclass(frozen=True, slots=True)
class Reproduction:
    """Reproduction of a figure of the paper.

    Attributes
    ----------
    name, title : str
    sample : str
        Sentence on the random data: distribution, numbers, seed.
    tables : dict of str to Table
        Tables by the end of their file names; "" is the main table.
    checks : tuple of Check
    notes : tuple of str
    plot : callable or None
        Writes the plot to a path; with None it returns a figure of matplotlib.

    Examples
    --------
    >>> done = Reproduction("fig0", "nothing", "none", {}, (Check("1 = 1", "1", True),))
    >>> done.holds
    True
    """

    name: str
    title: str
    sample: str
    tables: dict[str, Table]
    checks: tuple[Check, ...] = ()
    notes: tuple[str, ...] = ()
    plot: Callable[[Path | None], object] | None = None

    @property
    def holds(self) -> bool:
        """Whether all claims hold."""
        return all(check.holds for check in self.checks)

    def markdown(self) -> str:
        """Page in Markdown with the title, the data, all tables and the claims."""
        parts = [f"# {self.title}", self.sample]
        for table in self.tables.values():
            body = table.markdown() if table.in_markdown else f"{len(table.rows)} rows: see the CSV file."
            parts.append(f"## {table.title}\n\n{body}")
        if self.checks:
            rows = [(c.claim, c.found, "yes" if c.holds else "NO") for c in self.checks]
            parts.append("## Claims\n\n" + Table("claims", ("claim", "found", "holds"), rows).markdown())
        return "\n\n".join([*parts, *self.notes]) + "\n"

    def write(self, folder: str | os.PathLike[str], plot: bool = True) -> list[Path]:
        """Paths of the files NAME.md, NAME.csv (one for each table) and NAME.png, after writing them.

        Existing files with these names are replaced. With `plot` False no plot is drawn, so matplotlib is not needed.

        Raises
        ------
        FormatError
            If a file cannot be written.
        """
        target = Path(os.fspath(folder))
        texts = {f"{self.name}.md": self.markdown()}
        texts |= {f"{self.name}{'_' if end else ''}{end}.csv": table.csv() for end, table in self.tables.items()}
        written = []
        try:
            target.mkdir(parents=True, exist_ok=True)
            for name, text in texts.items():
                check_target(target / name, force=True)
                write_atomically(target / name, text.encode())
                written.append(target / name)
        except OSError as error:
            raise FormatError(f"{os.fspath(folder)!r} cannot be written: {error.strerror or error}") from None
        if plot and self.plot is not None:
            self.plot(target / f"{self.name}.png")
            written.append(target / f"{self.name}.png")
        return written

    def to_json(self) -> dict[str, Any]:
        """JSON object of the tables and claims."""
        tables = {
            end or "table": {"columns": list(t.columns), "rows": [[_json(x) for x in row] for row in t.rows]}
            for end, t in self.tables.items()
            if t.in_markdown
        }
        checks = [{"claim": c.claim, "found": c.found, "holds": c.holds} for c in self.checks]
        return {"name": self.name, "title": self.title, "sample": self.sample, "tables": tables, "checks": checks}


def _is_empty(x: Cell) -> bool:
    return x is None or (not isinstance(x, str) and math.isnan(x))


def _plain(x: Cell) -> str | int:
    return x if isinstance(x, str | int) else repr(float(x))


def _json(x: Cell) -> str | float | None:
    return None if _is_empty(x) else x if isinstance(x, str | int) else float(x)


def _shown_row(row: Sequence[Cell]) -> list[str]:
    return [_shown(x) for x in row]


def _shown(x: Cell) -> str:
    """Content of a cell in Markdown.

    Examples
    --------
    >>> [_shown(x) for x in (None, "a|b", 2, 0.0, 12.345, 1e-9)]
    ['', 'a\\\\|b', '2', '0', '12.3', '1e-09']
    """
    if _is_empty(x):
        return ""
    return x.replace("|", "\\|") if isinstance(x, str) else str(x) if isinstance(x, int) else f"{x:.3g}"
