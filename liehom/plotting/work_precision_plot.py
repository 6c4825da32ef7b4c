"""Plots of errors over costs, on logarithmic axes: which method reaches an error with the least work."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from liehom.errors import InputError
from liehom.integrators import WorkPrecisionRow, WorkPrecisionTable
from liehom.plotting.canvas import (
    DASHES,
    MARKERS,
    current_colours,
    figure_of,
    matplotlib_module,
    plane_axes,
    style_unless,
)
from liehom.plotting.convergence_plot import Curve, draw_curve, draw_floor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COSTS: dict[str, tuple[str, Callable[[WorkPrecisionRow], float]]] = {
    "time": ("CPU time in seconds", lambda row: row.cpu_time),
    "wall": ("wall-clock time in seconds", lambda row: row.wall_time),
    "calls": ("calls of the field", lambda row: math.nan if row.calls is None else row.calls),
    "steps": ("steps", lambda row: math.nan if row.steps is None else row.steps),
}


def plot_work_precision(
    table: WorkPrecisionTable, ax: Axes | None = None, *, against: str = "time", error: str = "trajectory"
) -> Axes:
    """Draw the errors of a table of `work_precision` over the cost, one curve for each method.

    Parameters
    ----------
    table : WorkPrecisionTable
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; by default new ones.
    against : "time", "wall", "calls" or "steps"
        The cost: CPU time, wall-clock time, calls of the field, or steps.
    error : "trajectory" or "orbit"

    Returns
    -------
    matplotlib.axes.Axes
        The lower a curve, the more accurate the method at that cost. A method that was run with step sizes and with
        tolerances has two curves, the adaptive one with hollow markers. Errors that are not resolved have open gray
        markers. The legend says how many runs of a method failed.

    Raises
    ------
    InputError
        If matplotlib is not installed, `table` is not such a table, or an option is none of those above.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> table = lh.work_precision(field, ["heun", "rk4"], (0, 5), [0.6, 0.0, 0.8], dts=[0.5, 0.25])
    >>> ax = plot_work_precision(table, against="calls")  # doctest: +SKIP
    """
    if not isinstance(table, WorkPrecisionTable):
        raise InputError(f"expected a table as liehom.work_precision returns it, got {table!r}")
    if not isinstance(against, str) or against not in COSTS:
        raise InputError(f"against is {against!r}, expected one of {', '.join(map(repr, COSTS))}")
    if error not in ("trajectory", "orbit"):
        raise InputError(f"error is {error!r}, expected 'trajectory' or 'orbit'")
    name, cost = COSTS[against]
    with style_unless(ax):
        own, ax = ax is None, plane_axes(ax, 6.4, 5.2)
        ax.set_xscale("log")
        ax.set_yscale("log")
        for k, method in enumerate(table.methods):
            mine = [row for row in table.rows if row.method == method]
            parts = [[row for row in mine if (row.dt is None) == adaptive] for adaptive in (False, True)]
            for rows in filter(None, parts):
                draw_curve(ax, _curve(rows, k, cost, error, several=all(parts)))
        ticks = matplotlib_module("ticker")
        ax.xaxis.set_minor_formatter(ticks.FuncFormatter(lambda x, _: _small_label(x, *ax.get_xlim())))
        if against in ("calls", "steps"):
            ax.xaxis.set_major_formatter(ticks.StrMethodFormatter("{x:,.0f}"))
            ax.xaxis.set_minor_formatter(ticks.LogFormatter(minor_thresholds=(1.5, 0.5)))
        ax.set_xlabel(name)
        ax.set_ylabel(f"{error} error" + (" (root mean square)" if table.trajectories > 1 else ""))
        ax.set_title(f"$t$ = {table.t_span[0]:.4g} to {table.t_span[1]:.4g}")
        lost = [row for row in table.rows if _error(row, error) <= row.floor]
        draw_floor(ax, max((row.floor for row in lost), default=0.0), [_error(row, error) for row in lost])
        if not own:
            ax.legend(loc="best", handlelength=3.0)
        else:  # next to the curves, which usually cross the whole axes
            figure_of(ax).legend(loc="outside lower center", ncols=2, handlelength=3.0)
    return ax


def _small_label(x: float, low: float, high: float) -> str:
    r"""Label of a tick between powers of ten: only at 2 and 5 on more than half a decade, so that none overlap.

    Examples
    --------
    >>> _small_label(2e-3, 1e-3, 2e-2), _small_label(3e-3, 1e-3, 2e-2), _small_label(3e-3, 2e-3, 4e-3)
    ('$2\\times10^{-3}$', '', '$3\\times10^{-3}$')
    """
    decades = math.log10(high / low)
    power = math.floor(math.log10(x) + 1e-9)
    digit = round(x / 10.0**power)
    if decades > 1.5 or (decades > 0.5 and digit not in (2, 5)):
        return ""
    return rf"${digit}\times10^{{{power}}}$"


def _curve(
    rows: list[WorkPrecisionRow], k: int, cost: Callable[[WorkPrecisionRow], float], error: str, *, several: bool
) -> Curve:
    """The curve of a method with step sizes or with tolerances."""
    colours, adaptive = current_colours(), rows[0].dt is None
    failed = sum(row.failed for row in rows)
    label = rows[0].method + (", adaptive" if several and adaptive else "")
    known = [(cost(row), _error(row, error), row.floor) for row in rows]
    known = [(x, e, floor) for x, e, floor in known if x > 0 and e > 0]
    return Curve(
        f"{label} ({failed} failed)" if failed else label,
        [(x, e) for x, e, floor in known if e > floor],
        [(x, e) for x, e, floor in known if e <= floor],
        math.nan,
        colours[k % len(colours)],
        MARKERS[k % len(MARKERS)],
        DASHES[k % len(DASHES)],
        hollow=several and adaptive,
    )


def _error(row: WorkPrecisionRow, error: str) -> float:
    return row.error if error == "trajectory" else row.orbit_error
