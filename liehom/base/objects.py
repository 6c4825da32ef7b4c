"""Bases of classes: attributes that are set once, objects that notebooks show, tables as CSV and LaTeX."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import Any, cast

from liehom.base.errors import InputError

MOST_AXES = 64  # of an array of numpy


def refuse_masked(what: str, value: object) -> None:
    """Raise `InputError` if a value, or an entry of a list, is a masked array of numpy, whose mask would be lost."""
    level, depth = [value], 0
    while level:
        if any(hasattr(x, "filled") and hasattr(x, "mask") for x in level):
            raise InputError(f"{what} is a masked array, and a masked entry has no number: fill it, or leave it out")
        level, depth = [y for x in level if isinstance(x, list | tuple) for y in x], depth + 1
        if depth > MOST_AXES:
            raise InputError(f"{what} is a list in lists, more than {MOST_AXES} deep: give an array of numbers")


# Immutable: base of the classes whose public attributes are set once, by their constructor.

_UNSET = object()


class Immutable:
    """Objects whose public attributes are set once, by constructor or pickle; those with an underscore are caches."""

    __slots__ = ()

    def __setattr__(self, name: str, value: object) -> None:
        if name[0] != "_" and getattr(self, name, _UNSET) is not _UNSET:
            raise AttributeError(
                f"{type(self).__name__} is immutable: {name} cannot be assigned; construct another object"
            )
        object.__setattr__(self, name, value)

    def __delattr__(self, name: str) -> None:
        if name[:1] != "_":
            raise AttributeError(f"{type(self).__name__} is immutable: {name} cannot be deleted")
        object.__delattr__(self, name)


# Tables as CSV and LaTeX, and bases of the classes that notebooks show as formulas, cards and tables.
#
# IPython asks an object for its methods ``_repr_latex_`` and ``_repr_html_``. The classes of all layers inherit them
# from here. The providers know every class and are above all of them, in `liehom.io`; `providers` has their places.

SHOWN_LINES = 8  # Lines of brackets, and rows and columns of matrices, that a notebook shows
# Cells that are aligned at the right: without letters, except the e of an exponent
NUMBER = re.compile(r"[^A-Za-z?]*([0-9.]e[-+]?[0-9]+)?[^A-Za-z?]*|nan|inf")

_SPECIAL = {"\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}"}


def comma_separated(rows: Iterable[Sequence[str | int | float]]) -> str:
    """Rows as lines of comma-separated values, the head of the table first."""
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerows(rows)
    return target.getvalue()


def escaped_latex(text: str) -> str:
    r"""A string as LaTeX prints it in text mode."""
    return "".join(_SPECIAL.get(c, f"\\{c}" if c in "&%$#_{}" else c) for c in text)


def latex_table(cells: Sequence[Sequence[str]], caption: str = "") -> str:
    r"""Table environment of LaTeX, for text mode, that needs no package."""
    head, *body = [" & ".join(row) + r" \\" for row in cells]
    begin = [r"\begin{table}", *([rf"\caption{{{caption}}}"] if caption else [])]
    rows = [rf"\begin{{tabular}}{{{'l' * len(cells[0])}}}", r"\hline", head, r"\hline", *body, r"\hline"]
    return "\n".join([*begin, *rows, r"\end{tabular}", r"\end{table}"])


providers: dict[str, tuple[str, str]] = {}
"""What a lower floor calls of a higher one -> its module and its name; the top level, which is above both, fills it."""


def provider(what: str) -> Callable[..., Any]:
    """The function of a higher floor that does something, such as showing an object."""
    module, name = providers[what]
    return cast("Callable[..., Any]", getattr(import_module(module), name))


class Typeset:
    """Objects that a notebook shows as a formula; `liehom.latex` has it in full."""

    __slots__ = ()

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {provider('latex')(self, most=SHOWN_LINES)}$"


class Displayed(Typeset):
    """Objects that a notebook shows as a card: a title, a few facts, and details that unfold."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        return str(provider("html")(self))


class DisplayedTable(Displayed):
    """Tables: `_caption`, `_cells` and `_notes` of a derived class are what is shown."""

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
        """The table as a Markdown string, with the notes below it."""
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
