"""Plots of errors over step sizes and over costs."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from liehom.base.errors import InputError, displayed
from liehom.flow.convergence.costs import WorkPrecisionRow, WorkPrecisionTable
from liehom.flow.convergence.orders import ConvergenceTable
from liehom.plotting.canvas import (
    COLOURS,
    DASHES,
    MARKERS,
    current_colours,
    figure_of,
    finished,
    matplotlib_module,
    muted_colour,
    pale_colour,
    paper_colour,
    plane_axes,
    style_unless,
    written,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Plots of errors over step sizes, on logarithmic axes, with triangles that show the slopes.

# a triangle is drawn if a measured order is at most this far from an integer
SLOPE_TOLERANCE = 0.3
# height of the lower edge of a triangle, as a multiple of the smallest error of its curve
TRIANGLE_OFFSET = 0.4
# the floor is drawn if an error is less than this multiple of it
FLOOR_MARGIN = 300.0


class Curve(NamedTuple):
    """Errors above the floor, errors below it (`lost`), and their style."""

    label: str | None
    points: list[tuple[float, float]]
    lost: list[tuple[float, float]]
    slope: float
    colour: str
    marker: str
    dashes: str
    hollow: bool = False


def plot_convergence(
    tables: ConvergenceTable | Sequence[ConvergenceTable],
    path: str | os.PathLike[str] | None = None,
    *,
    labels: Sequence[str] | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw the errors of one or several tables of `observed_order` over the step size.

    Parameters
    ----------
    tables : ConvergenceTable or sequence of them
    path : path, optional
        File to write: .png, .pdf, .svg, ....
    labels : sequence of str, optional
        One label for each table (default: the step's repr).
    axes : matplotlib.axes.Axes, optional
        Axes to draw on (default: those of a new figure).

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, `tables` are not tables, or there are not as many labels as tables.
    FormatError
        If the file cannot be written.

    Notes
    -----
    Solid lines are orbit errors, dashed lines trajectory errors. Triangles show the integer slopes next to the measured
    ones. Errors of the size of round-off, or of the reference's accuracy, have open grey markers and enter no slope.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + m0/2"])
    >>> table = lh.convergence.observed_order(field, [1.0, 0.0], lh.Euler(), [0.1, 0.05])
    >>> figure = plot_convergence(table, "orders.pdf")  # doctest: +SKIP
    """
    chosen = [tables] if isinstance(tables, ConvergenceTable) else list(tables)
    if not chosen or not all(isinstance(table, ConvergenceTable) for table in chosen):
        raise InputError(f"expected tables as liehom.observed_order returns them, got {displayed(tables)}")
    names = [table.step for table in chosen] if labels is None else [str(label) for label in labels]
    if len(names) != len(chosen):
        raise InputError(f"there are {len(chosen)} tables and {len(names)} labels")
    with style_unless(axes):
        axes = plane_axes(axes, 6.4 if len(chosen) == 1 else 8.0, 4.8)
        figure = figure_of(axes)
        curves = [curve for k, table in enumerate(chosen) for curve in _curves(table, k, len(chosen))]
        _frame(axes, chosen)
        for curve in curves:
            draw_curve(axes, curve)
        _draw_triangles(axes, curves)
        errors = [e for table in chosen for e in (*table.orbit_errors, *table.trajectory_errors)]
        draw_floor(axes, max(max(table.floors) for table in chosen), errors)
        if len(chosen) == 1 and curves:
            axes.legend(loc="lower right")
        elif curves:
            _explain(axes, chosen, names)
    return finished(figure, path)


def _curves(table: ConvergenceTable, k: int, count: int) -> list[Curve]:
    """Curves of the orbit errors and of the trajectory errors, if they have a point."""
    curves = []
    kinds = (("orbit", table.orbit_errors, table.orders[0]), ("trajectory", table.trajectory_errors, table.orders[1]))
    for i, (kind, errors, slope) in enumerate(kinds):
        rows = [row for row in zip(table.dts, errors, table.floors, strict=True) if row[1] > 0]
        if rows:
            number = i if count == 1 else k
            order = "" if math.isnan(slope) else f", order {slope:.2f}"
            curves.append(
                Curve(
                    f"{kind}{order}" if count == 1 else None,
                    [(h, e) for h, e, floor in rows if e > floor],
                    [(h, e) for h, e, floor in rows if e <= floor],
                    slope,
                    current_colours()[number % len(COLOURS)],
                    MARKERS[number % len(MARKERS)],
                    "-" if kind == "orbit" else "--",
                    hollow=kind == "trajectory",
                )
            )
    return curves


def _frame(axes: Axes, tables: Sequence[ConvergenceTable]) -> None:
    label = "error (root mean square)" if any(table.trajectories > 1 for table in tables) else "error"
    axes.set(xscale="log", yscale="log", xlabel="step size $h$", ylabel=label)
    sizes = sorted({h for table in tables for h in table.dts})
    axes.minorticks_off()
    if len(sizes) <= 7:
        axes.set_xticks(sizes, [f"{h:.4g}" for h in sizes])
    first = tables[0]
    name = f"{first.step}\n" if len(tables) == 1 else ""
    methods = {(t.exponential, t.clock, t.t_span) for t in tables}
    if len(methods) == 1:
        span = f"$t$ = {first.t_span[0]:.4g} to {first.t_span[1]:.4g}"
        axes.set_title(f"{name}{first.exponential}, clock {first.clock}, {span}")


def draw_curve(axes: Axes, curve: Curve) -> None:
    """Draw errors as markers on a line; those below their floor get open gray markers on a pale line."""
    paper, muted = paper_colour(), muted_colour()
    both = sorted([*curve.points, *curve.lost])
    if curve.lost:
        axes.plot(*zip(*both, strict=True), color=muted, alpha=0.5, linestyle=curve.dashes, linewidth=1.0, zorder=1.5)
        axes.plot(*zip(*curve.lost, strict=True), curve.marker, color=muted, markerfacecolor=paper, zorder=2.5)
    look: dict[str, Any] = {"color": curve.colour, "marker": curve.marker, "linestyle": curve.dashes, "markersize": 6}
    hollow: dict[str, Any] = {"markerfacecolor": paper} if curve.hollow else {}
    points = sorted(curve.points) or [(math.nan, math.nan)]
    axes.plot(*zip(*points, strict=True), label=curve.label, **look, **hollow)


def _explain(axes: Axes, tables: Sequence[ConvergenceTable], names: Sequence[str]) -> None:
    """Legend next to the axes: names and measured orders of the tables, and the meaning of solid and dashed lines."""
    for k, (table, name) in enumerate(zip(tables, names, strict=True)):
        orders = ", ".join("–" if math.isnan(order) else f"{order:.2f}" for order in table.orders)
        look: dict[str, Any] = {
            "color": current_colours()[k % len(COLOURS)],
            "marker": MARKERS[k % len(MARKERS)],
            "markersize": 6,
        }
        axes.plot([math.nan], [math.nan], label=f"{name}\norders {orders}", **look)
    for dashes, fill, kind in (("-", muted_colour(), "orbit"), ("--", paper_colour(), "trajectory")):
        axes.plot([math.nan], [math.nan], dashes, marker="o", markerfacecolor=fill, color=muted_colour(), label=kind)
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0)


def _draw_triangles(axes: Axes, curves: Sequence[Curve]) -> None:
    """Draw one triangle for each integer slope, below the lowest curve with this slope."""
    lowest: dict[int, Curve] = {}
    for curve in curves:
        if len(curve.points) < 2 or math.isnan(curve.slope):
            continue
        p = round(curve.slope)
        if (
            p > 0
            and abs(curve.slope - p) < SLOPE_TOLERANCE
            and (p not in lowest or min(curve.points)[1] < min(lowest[p].points)[1])
        ):
            lowest[p] = curve
    for p, curve in lowest.items():
        (left, low), (right, _) = sorted(curve.points)[:2]
        base = TRIANGLE_OFFSET * low
        corners = [(left, base), (right, base), (right, base * (right / left) ** p)]
        axes.fill(
            *zip(*corners, strict=True),
            facecolor=pale_colour(),
            edgecolor=muted_colour(),
            linewidth=0.8,
            alpha=0.6,
            zorder=1,
        )
        middle = math.sqrt(corners[1][1] * corners[2][1])
        axes.annotate(str(p), (right, middle), (4, 0), textcoords="offset points", va="center", color=muted_colour())
        axes.annotate(
            "1",
            (math.sqrt(left * right), base),
            (0, -3),
            textcoords="offset points",
            ha="center",
            va="top",
            color=muted_colour(),
        )


def draw_floor(axes: Axes, highest: float, errors: Sequence[float]) -> None:
    """Shade the region below the highest floor, if errors come near it."""
    muted = muted_colour()
    errors = [e for e in errors if e > 0]
    if errors and min(errors) < FLOOR_MARGIN * highest:
        axes.axhspan(min(0.3 * min(errors), 0.05 * highest), highest, color=muted, alpha=0.12, zorder=0, linewidth=0)
        axes.text(
            0.01, 0.8 * highest, "round-off or accuracy of the reference", transform=axes.get_yaxis_transform(),
            va="top", color=muted, fontsize=8,
        )  # fmt: skip


# Plots of errors over costs, on logarithmic axes: which method reaches an error with the least work.

COSTS: dict[str, tuple[str, Callable[[WorkPrecisionRow], float]]] = {
    "time": ("CPU time in seconds", lambda row: row.cpu_time),
    "wall": ("wall-clock time in seconds", lambda row: row.wall_time),
    "calls": ("calls of the field", lambda row: math.nan if row.calls is None else row.calls),
    "steps": ("steps", lambda row: math.nan if row.steps is None else row.steps),
}


def plot_work_precision(
    table: WorkPrecisionTable,
    ax: Axes | None = None,
    *,
    against: str = "time",
    error: str = "trajectory",
    path: str | os.PathLike[str] | None = None,
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
    path : path, optional
        A file to write the picture to.

    Returns
    -------
    matplotlib.axes.Axes
        The lower a curve, the more accurate the method at that cost. A method that was run with step sizes and with
        tolerances has two curves, the adaptive one with hollow markers. Errors that are not resolved have open gray
        markers. The legend says how many runs of a method failed.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> table = lh.work_precision(field, ["heun", "rk4"], (0, 5), [0.6, 0.0, 0.8], dts=[0.5, 0.25])
    >>> ax = plot_work_precision(table, against="calls")  # doctest: +SKIP
    """
    if not isinstance(table, WorkPrecisionTable):
        raise InputError(f"expected a table as liehom.work_precision returns it, got {displayed(table)}")
    if not isinstance(against, str) or against not in COSTS:
        raise InputError(f"against is {against!r}, expected one of {', '.join(map(repr, COSTS))}")
    if error not in ("trajectory", "orbit"):
        raise InputError(f"error is {error!r}, expected 'trajectory' or 'orbit'")
    name, cost = COSTS[against]
    with style_unless(ax):
        own, ax = ax is None, plane_axes(ax, 6.4, 5.2)
        ax.set(xscale="log", yscale="log")
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
        label = f"{error} error" + (" (root mean square)" if table.trajectories > 1 else "")
        ax.set(xlabel=name, ylabel=label, title=f"$t$ = {table.t_span[0]:.4g} to {table.t_span[1]:.4g}")
        lost = [row for row in table.rows if _error(row, error) <= row.floor]
        draw_floor(ax, max((row.floor for row in lost), default=0.0), [_error(row, error) for row in lost])
        if not own:
            ax.legend(loc="best", handlelength=3.0)
        else:  # next to the curves, which usually cross the whole axes
            figure_of(ax).legend(loc="outside lower center", ncols=2, handlelength=3.0)
    return written(ax, path)


def _small_label(x: float, low: float, high: float) -> str:
    r"""Label of a tick between powers of ten: only at 2 and 5 on more than half a decade, so that none overlap."""
    decades = math.log10(high / low)
    power = math.floor(math.log10(x) + 1e-9)
    digit = round(x / 10.0**power)
    return "" if decades > 1.5 or (decades > 0.5 and digit not in (2, 5)) else rf"${digit}\times10^{{{power}}}$"


def _curve(
    rows: list[WorkPrecisionRow], k: int, cost: Callable[[WorkPrecisionRow], float], error: str, *, several: bool
) -> Curve:
    """The curve of a method with step sizes or with tolerances."""
    colours, adaptive = current_colours(), rows[0].dt is None
    failed = sum(row.failed for row in rows)
    label = rows[0].method + (", adaptive" if several and adaptive else "")
    points = ((cost(row), _error(row, error), row.floor) for row in rows)
    known = [(x, e, floor) for x, e, floor in points if x > 0 and e > 0]
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
