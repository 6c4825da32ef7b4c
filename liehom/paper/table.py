r"""Tables of a reproduction as CSV, Markdown and LaTeX, and the names of updates as formulas.

An update has a name such as `rk2_ib` in the library, is written xi_ib^RK2 in sentences, and
$\xi_{ib}^{\mathrm{RK2}}$ in plots and in LaTeX.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from liehom.display import DisplayedTable, comma_separated, escaped_latex, latex_table
from liehom.errors import InputError

Cell: TypeAlias = Any
"""Content of a cell of a table: a string, a number of Python or numpy, or None."""

SCHEMES = {"eul": "Eul", "rk2": "RK2", "sy4": "sy4", "rk4": "RK4"}
"""Superscripts of the updates."""
_FORMULA = re.compile(r"\b(eul|rk2|sy4|rk4)_(io|ib|b|o|i)\b|\b(xi|sigma|omega)_(io|ib|b|o|i)(?:\^(Eul|RK2|sy4|RK4))?")
_NUMBER = re.compile(r"(-?[0-9.]+)e([+-][0-9]+)")


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
        False for the points of curves; Markdown then shows only the number of rows, and LaTeX leaves the table out.

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
        cells = [[x.replace("|", "\\|") for x in row] for row in self._cells()[1:]]
        lines = ["| " + " | ".join(row) + " |" for row in (self.columns, *cells)]
        lines.insert(1, "|" + "---|" * len(self.columns))
        return "\n".join(lines)

    def latex(self, caption: str | None = None) -> str:
        r"""Table environment of LaTeX, with the title or another sentence as its caption.

        Examples
        --------
        >>> print(Table("errors", ("update", "error"), [("eul_b", 1.25e-7)]).latex())
        \begin{table}
        \caption{errors}
        \begin{tabular}{ll}
        \hline
        update & error \\
        \hline
        $\xi_{b}^{\mathrm{Eul}}$ & $1.25\cdot10^{-7}$ \\
        \hline
        \end{tabular}
        \end{table}
        """
        cells = [list(map(typeset, row)) for row in self._cells()]
        return latex_table(cells, typeset(self.title if caption is None else caption))

    def to_json(self) -> dict[str, Any]:
        """JSON object of the columns and the rows."""
        return {"columns": list(self.columns), "rows": [[_json(x) for x in row] for row in self.rows]}

    def _caption(self) -> str:
        return self.title

    def _cells(self) -> list[list[str]]:
        return [list(self.columns), *shown_rows(self)]


def shown_rows(table: Table) -> list[list[str]]:
    """Rows of a table as strings, numbers with three digits."""
    return [[_shown(x) for x in row] for row in table.rows]


def symbol(name: str) -> str:
    """Symbol of an update in the paper, as mathtext and LaTeX.

    Examples
    --------
    >>> symbol("rk2_ib")
    '$\\\\xi_{ib}^{\\\\mathrm{RK2}}$'
    """
    scheme, variant = name.split("_")
    return rf"$\xi_{{{variant}}}^{{\mathrm{{{SCHEMES[scheme]}}}}}$"


def mathtext(text: str) -> str:
    """A sentence with the names of updates as formulas, as matplotlib reads it.

    Examples
    --------
    >>> mathtext("xi_o^sy4 costs $ 2")
    '$\\\\xi_{o}^{\\\\mathrm{sy4}}$ costs \\\\$ 2'
    """
    return _FORMULA.sub(_formula, text.replace("$", r"\$"))


def typeset(text: str) -> str:
    r"""A sentence or a cell of a table in LaTeX, for text mode.

    Examples
    --------
    >>> print(typeset("error of eul_b < 2e-05"))
    error of $\xi_{b}^{\mathrm{Eul}}$ $<$ $2\cdot10^{-5}$
    """
    parts, end = [], 0
    for match in re.finditer(f"{_FORMULA.pattern}|{_NUMBER.pattern}|[<>|]", text):
        parts += [escaped_latex(text[end : match.start()]), _typeset(match[0])]
        end = match.end()
    return "".join([*parts, escaped_latex(text[end:])])


def _typeset(text: str) -> str:
    if number := _NUMBER.fullmatch(text):
        return rf"${number[1]}\cdot10^{{{int(number[2])}}}$"
    return _FORMULA.sub(_formula, text) if _FORMULA.fullmatch(text) else f"${text}$"


def _formula(match: re.Match[str]) -> str:
    if match[1]:
        return symbol(match[0])
    scheme = rf"^{{\mathrm{{{match[5]}}}}}" if match[5] else ""
    return rf"$\{match[3]}_{{{match[4]}}}{scheme}$"


def _is_empty(x: Cell) -> bool:
    return x is None or (not isinstance(x, str) and math.isnan(x))


def _plain(x: Cell) -> str | int:
    return x if isinstance(x, str | int) else repr(float(x))


def _json(x: Cell) -> str | float | None:
    return None if _is_empty(x) else x if isinstance(x, str | int) else float(x)


def _shown(x: Cell) -> str:
    """Content of a cell, a number with three digits.

    Examples
    --------
    >>> [_shown(x) for x in (None, "a|b", 2, 0.0, 12.345, 1e-9)]
    ['', 'a|b', '2', '0', '12.3', '1e-09']
    """
    if _is_empty(x):
        return ""
    return x if isinstance(x, str) else str(x) if isinstance(x, int) else f"{x:.3g}"
