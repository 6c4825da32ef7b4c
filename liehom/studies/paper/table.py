"""Tables of the paper, and the numbers that it prints."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from liehom.base.errors import InputError
from liehom.base.objects import DisplayedTable, comma_separated, escaped_latex, latex_table

# Numbers that the paper prints in section 4, unchanged; `None` if it prints nothing. Tables of errors have the keys
# (body, step size, update), with the names of updates in `liehom.instances.RigidBody`.

EULER = ("eul_b", "eul_o", "eul_i")
HEUN = ("rk2_b", "rk2_o", "rk2_ib", "rk2_io")
FOURTH = ("sy4_b", "sy4_o", "sy4_ib", "sy4_io", "rk4_b", "rk4_o")
UPDATES = (*EULER, *HEUN, *FOURTH)

Errors = dict[tuple[str, float, str], float]


def _table(updates: tuple[str, ...], rows: dict[tuple[str, float], tuple[float, ...]]) -> Errors:
    return {
        (body, dt, name): value
        for (body, dt), values in rows.items()
        for name, value in zip(updates, values, strict=True)
    }


# Figure 2: maximum energy error over the trajectories of Figure 1; its first header reads xi_n^Eul, for xi_b^Eul
FIGURE_2 = _table(
    EULER, {("triaxial", 0.1): (6.37e-2, 2.23e-2, 4.60e-6), ("axisymmetric", 0.1): (2.46e-1, 1.46e-1, 7.38e-14)}
)

# Figure 3: average energy errors over ten runs on [0, 100], forward Euler
FIGURE_3 = _table(
    EULER,
    {
        ("triaxial", 10): (9.04e-2, 1.81e-2, 4.56e-3),
        ("triaxial", 1): (8.53e-2, 8.54e-3, 3.68e-5),
        ("triaxial", 0.1): (9.06e-3, 1.44e-3, 3.55e-7),
        ("triaxial", 0.01): (7.09e-4, 1.62e-4, 3.57e-9),
        ("axisymmetric", 10): (3.09e-3, 3.70e-3, 0.0),
        ("axisymmetric", 1): (1.55e-3, 6.17e-4, 0.0),
        ("axisymmetric", 0.1): (2.33e-4, 6.31e-5, 0.0),
        ("axisymmetric", 0.01): (2.43e-5, 6.32e-6, 0.0),
    },
)

# Figure 4: average maximum energy errors over ten runs on [0, 100], Heun
FIGURE_4 = _table(
    HEUN,
    {
        ("triaxial", 10): (7.42e-2, 1.22e-2, 6.11e-2, 4.99e-2),
        ("triaxial", 1): (4.36e-3, 1.06e-4, 9.61e-4, 5.67e-7),
        ("triaxial", 0.1): (5.03e-6, 1.10e-7, 1.11e-8, 2.14e-11),
        ("triaxial", 0.01): (5.01e-9, 1.10e-10, 2.94e-13, 9.07e-15),
        ("axisymmetric", 10): (2.70e-3, 4.86e-4, 6.34e-3, 1.83e-3),
        ("axisymmetric", 1): (6.99e-5, 8.59e-7, 4.07e-6, 2.44e-9),
        ("axisymmetric", 0.1): (7.50e-8, 8.64e-10, 4.28e-11, 2.72e-14),
        ("axisymmetric", 0.01): (7.50e-11, 8.78e-13, 0.0, 3.81e-14),
    },
)

# Figure 5: average maximum energy errors over ten runs on [0, 100], methods of order four
FIGURE_5 = _table(
    FOURTH,
    {
        ("triaxial", 10): (5.67e-3, 3.37e-2, 6.06e-3, 1.90e-2, 6.07e-2, 3.59e-3),
        ("triaxial", 1): (3.62e-6, 2.72e-7, 1.55e-6, 1.68e-7, 2.15e-5, 1.46e-7),
        ("triaxial", 0.1): (3.56e-10, 7.45e-12, 3.56e-10, 7.45e-12, 2.97e-10, 3.06e-12),
        ("axisymmetric", 10): (1.10e-3, 2.42e-5, 1.10e-3, 3.54e-5, 4.81e-4, 1.38e-5),
        ("axisymmetric", 1): (3.24e-8, 2.67e-7, 3.24e-8, 2.67e-7, 8.17e-8, 1.70e-10),
        ("axisymmetric", 0.1): (3.28e-13, 2.67e-10, 2.28e-13, 2.67e-10, 8.41e-13, 4.85e-15),
    },
)

# section 4, before Figure 3: average errors of xi_b^Eul on ten separatrices over [0, 500]
SEPARATRIX = {1.0: 9.72e-2, 0.1: 3.89e-2, 0.01: 1.94e-3}

# Figure 6: discretization order, energy order, relative CPU time, the same within its class, ln CPU = a x + b with
# x = -ln error
FIGURE_6: dict[str, tuple[int, int, float, float, float, float]] = {
    "eul_b": (1, 1, 1.0, 1.0, 1.22, -7.58),
    "eul_o": (1, 1, 1.18, 1.18, 1.40, -10.8),
    "eul_i": (1, 2, 1.45, 1.45, 0.491, -8.24),
    "rk2_b": (2, 3, 2.10, 1.0, 0.402, -5.72),
    "rk2_o": (2, 3, 2.42, 1.15, 0.333, -5.78),
    "rk2_ib": (2, 4, 2.83, 1.35, 0.248, -4.95),
    "rk2_io": (2, 4, 17.14, 8.17, 0.235, -4.02),
    "sy4_b": (4, 4, 6.99, 1.21, 0.267, -5.24),
    "sy4_o": (4, 4, 5.80, 1.0, 0.233, -5.18),
    "sy4_ib": (4, 5, 8.15, 1.40, 0.249, -4.97),
    "sy4_io": (4, 5, 11.24, 1.94, 0.230, -4.70),
    "rk4_b": (4, 4, 12.08, 2.08, 0.247, -4.22),
    "rk4_o": (4, 4, 13.19, 2.27, 0.249, -4.91),
}

# section 4, end: where the fits of xi_i^Eul and xi_o^sy4 intersect
CROSSOVER = 7.16e-6


# Tables of a reproduction as CSV, Markdown and LaTeX, and the names of updates as formulas. An update has a name such
# as `rk2_ib` in the library, is written xi_ib^RK2 in sentences, and $\xi_{ib}^{\mathrm{RK2}}$ in plots and in LaTeX.

Cell: TypeAlias = Any  # Content of a cell of a table: a string, a number of Python or numpy, or None

SCHEMES = {"eul": "Eul", "rk2": "RK2", "sy4": "sy4", "rk4": "RK4"}  # Superscripts of the updates
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
    """Symbol of an update in the paper, as mathtext and LaTeX."""
    scheme, variant = name.split("_")
    return rf"$\xi_{{{variant}}}^{{\mathrm{{{SCHEMES[scheme]}}}}}$"


def mathtext(text: str) -> str:
    """A sentence with the names of updates as formulas, as matplotlib reads it."""
    return _FORMULA.sub(_formula, text.replace("$", r"\$"))


def typeset(text: str) -> str:
    r"""A sentence or a cell of a table in LaTeX, for text mode."""
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
    """Content of a cell, a number with three digits."""
    if _is_empty(x):
        return ""
    return x if isinstance(x, str) else str(x) if isinstance(x, int) else f"{x:.3g}"
