"""A reproduction that costs nothing, for tests of files."""

from typing import Any

from matplotlib.figure import Figure

from liehom.plotting.canvas import new_figure
from liehom.studies.paper.reproduction import Check, Reproduction
from liehom.studies.paper.table import Table


def axes_only() -> Figure:
    figure = new_figure(3, 2)
    figure.add_subplot()
    return figure


def small(name: str, **settings: Any) -> Reproduction:
    table = Table("t", ("a",), [(len(name),)])
    given = {"quick": False, "seed": None} | settings
    return Reproduction(
        name, name, "none", {"": table}, (Check("1 = 1", "1", True, "1 = 2"),), draw=axes_only, settings=given
    )
