"""Tables as CSV and LaTeX, and bases of the classes that notebooks show as formulas, cards and tables.

IPython asks an object for its methods ``_repr_latex_`` and ``_repr_html_``. The classes of all layers inherit them from
here. The renderers know every class and are therefore above all of them, in `liehom.io`. The two imports below, made
when a notebook asks, are the only ones outside the class files that point upwards; tests/test_layers.py lists them.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence

SHOWN_LINES = 8
"""Lines of brackets, and rows and columns of matrices, that a notebook shows."""
NUMBER = re.compile(r"[^A-Za-z?]*([0-9.]e[-+]?[0-9]+)?[^A-Za-z?]*|nan|inf")
"""Cells that are aligned at the right: without letters, except the e of an exponent."""

_SPECIAL = {"\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}"}


def comma_separated(rows: Iterable[Sequence[str | int | float]]) -> str:
    """Rows as lines of comma-separated values, the head of the table first.

    Examples
    --------
    >>> comma_separated([("dt", "error"), (0.1, "1,5")])
    'dt,error\\n0.1,"1,5"\\n'
    """
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerows(rows)
    return target.getvalue()


def escaped_latex(text: str) -> str:
    r"""A string as LaTeX prints it in text mode.

    Examples
    --------
    >>> print(escaped_latex("50% of a_b ^ c"))
    50\% of a\_b \textasciicircum{} c
    """
    return "".join(_SPECIAL.get(c, f"\\{c}" if c in "&%$#_{}" else c) for c in text)


def latex_table(cells: Sequence[Sequence[str]], caption: str = "") -> str:
    r"""Table environment of LaTeX, for text mode, that needs no package.

    Parameters
    ----------
    cells : sequence of sequences of str
        Cells in LaTeX, the head of the table first.
    caption : str, optional
        Caption in LaTeX.

    Examples
    --------
    >>> print(latex_table([("dt", "error"), ("0.1", "$10^{-7}$")], "Errors"))
    \begin{table}
    \caption{Errors}
    \begin{tabular}{ll}
    \hline
    dt & error \\
    \hline
    0.1 & $10^{-7}$ \\
    \hline
    \end{tabular}
    \end{table}
    """
    head, *body = [" & ".join(row) + r" \\" for row in cells]
    begin = [r"\begin{table}", *([rf"\caption{{{caption}}}"] if caption else [])]
    rows = [rf"\begin{{tabular}}{{{'l' * len(cells[0])}}}", r"\hline", head, r"\hline", *body, r"\hline"]
    return "\n".join([*begin, *rows, r"\end{tabular}", r"\end{table}"])


class Typeset:
    """Objects that a notebook shows as a formula; `liehom.latex` has it in full.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.heisenberg(1).killing_form().select(rows=[0])._repr_latex_()
    '$\\\\displaystyle \\\\begin{pmatrix}\\n0 & 0 & 0\\n\\\\end{pmatrix}$'
    """

    __slots__ = ()

    def _repr_latex_(self) -> str:
        from liehom.io.latex_format import latex

        return rf"$\displaystyle {latex(self, most=SHOWN_LINES)}$"


class Displayed(Typeset):
    """Objects that a notebook shows as a card: a title, a few facts, and details that unfold.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.simple("E8")._repr_html_()[:60]
    '<div class="liehom"><p><b>Lie algebra e8(8) of dimension 248'
    """

    __slots__ = ()

    def _repr_html_(self) -> str:
        from liehom.io.html_format import html

        return html(self)


class DisplayedTable(Displayed):
    """Tables; `_caption`, `_cells` and `_notes` of a derived class are what is shown.

    Columns of numbers are aligned at the right, others at the left.

    Examples
    --------
    >>> class Squares(DisplayedTable):
    ...     def _cells(self) -> list[list[str]]:
    ...         return [["n", "n^2"], ["2", "4"]]
    ...
    >>> print(Squares())
    n  n^2
    2    4
    >>> print(Squares()._repr_latex_())
    $\\displaystyle \\begin{array}{ll}
    \\text{n} & \\text{n\\textasciicircum{}2} \\\\ \\hline
    \\text{2} & \\text{4}
    \\end{array}$
    """

    __slots__ = ()

    def __str__(self) -> str:
        cells, right = self._cells(), self._right()
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = [
            "  ".join(f"{x:>{w}}" if r else f"{x:<{w}}" for x, w, r in zip(row, widths, right, strict=True)).rstrip()
            for row in cells
        ]
        return "\n".join([*filter(None, [self._caption()]), *lines, *self._notes()])

    def to_markdown(self) -> str:
        """The table as a Markdown string, with the notes below it.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.atlas.sweep(["so(3)/so(2)"]).to_markdown())
        | pair | dim g | dim h | full | certificate |
        | --- | ---: | ---: | --- | --- |
        | so(3)/so(2) | 3 | 1 | yes | full |
        """
        head, *body = self._cells()
        rule = ["---:" if right else "---" for right in self._right()]
        lines = ["| " + " | ".join(row) + " |" for row in (head, rule, *body)]
        return "\n".join([*lines, "", *(f"{note}  " for note in self._notes())]).rstrip()

    def _right(self) -> list[bool]:
        """A bool for each column: whether all its cells are numbers, or marks without letters."""
        _, *body = self._cells()
        columns = zip(*body, strict=True) if body else [()] * len(self._cells()[0])
        return [all(NUMBER.fullmatch(cell) for cell in column) for column in columns]

    def _caption(self) -> str:
        """Line above the table."""
        return ""

    def _cells(self) -> list[list[str]]:
        """Strings of the cells, the head of the table first."""
        raise NotImplementedError

    def _notes(self) -> list[str]:
        """Lines below the table."""
        return []
