"""Figures of the paper, for docs/reproduction.md: from the tables that `liehom reproduce all --out DIR` writes.

The tables are files of the documentation, so that its build need not compute for half a minute; a slow test compares
them with new ones. The trajectories of Figure 1 are computed.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from liehom.studies.paper.efficiency import PANELS
from liehom.studies.paper.figures import reproduce
from liehom.studies.paper.plots import draw_costs, draw_errors
from liehom.studies.paper.table import Table
from pictures import picture

TABLES = Path(__file__).resolve().parent.parent / "_static" / "reproduction"


def table(name: str) -> Table:
    """Table of a CSV file: numbers, or strings where there is no number."""
    head, *rows = csv.reader((TABLES / f"{name}.csv").read_text(encoding="utf-8").splitlines())
    return Table(name, head, [[_cell(x) for x in row] for row in rows])


def _cell(text: str) -> str | float:
    try:
        return float(text or "nan")
    except ValueError:
        return text


@cache
def _trajectories() -> Any:
    return reproduce("fig1")


@picture
def paper_figure_1(colours: Sequence[str]) -> Any:
    """Trajectories of Euler's method."""
    figure = _trajectories().draw()
    figure.set_size_inches(6.0, 4.2)
    return figure


@picture
def paper_figure_3(colours: Sequence[str]) -> Any:
    """Energy errors of Euler's method."""
    return draw_errors(table("fig3"), table("fig3_slopes"), columns=3)


@picture
def paper_figure_4(colours: Sequence[str]) -> Any:
    """Energy errors of Heun's method."""
    figure = draw_errors(table("fig4"), table("fig4_slopes"), table("fig4_as_printed"))
    figure.set_size_inches(6.0, 4.4)
    return figure


@picture
def paper_figure_5(colours: Sequence[str]) -> Any:
    """Energy errors of the methods of order four."""
    return draw_errors(table("fig5"), table("fig5_slopes"), table("fig5_as_printed"), columns=3)


@picture
def paper_figure_7(colours: Sequence[str]) -> Any:
    """Cost over accuracy."""
    figure = draw_costs(table("fig7"), table("fig7_lines"), PANELS)
    figure.set_size_inches(6.4, 7.0)
    return figure
