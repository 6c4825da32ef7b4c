"""WorkPrecisionTable: errors and costs of several methods on one problem, one row for each run."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, final

from liehom.display import DisplayedTable
from liehom.integrators.convergence.compared_methods import Setting
from liehom.integrators.convergence.convergence_table import MARGIN
from liehom.integrators.convergence.csv_file import csv_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class WorkPrecisionRow(NamedTuple):
    """Errors and costs of a method with one step size or tolerance.

    Attributes
    ----------
    method : str
    dt, tolerance : float or None
        The fixed step size, or rtol and atol of adaptive steps; the other one is None.
    error, orbit_error : float
        Trajectory and orbit error at the end, root mean squares over an ensemble; NaN if the run failed.
    floor : float
        An error below it is not resolved, because it is within a factor 10 of round-off or of the reference's accuracy.
    calls : int or None
        Calls of the field, on points or on series; a call for a whole ensemble counts once. None if the run failed.
    steps : int or None
        Steps of the trajectory with the most of them.
    cpu_time, wall_time : float
        Seconds of the process and of the clock, each the smallest of a few calls, without compilation.
    message : str
        Why the run failed, that the step did not keep its order, or what scipy warned of; else empty.
    """

    method: str
    dt: float | None
    tolerance: float | None
    error: float
    orbit_error: float
    floor: float
    calls: int | None
    steps: int | None
    cpu_time: float
    wall_time: float
    message: str = ""

    @property
    def failed(self) -> bool:
        """Whether the run did not reach its end."""
        return math.isnan(self.error)

    @property
    def setting(self) -> str:
        """The step size or the tolerance as a string."""
        return str(Setting(self.dt, self.tolerance))


@final
@dataclass(frozen=True, slots=True, repr=False)
class WorkPrecisionTable(DisplayedTable):
    """Errors and costs of several methods on one problem; the result of `work_precision`.

    Attributes
    ----------
    rows : tuple of WorkPrecisionRow
        By method, and with decreasing step sizes and tolerances.
    t_span : (float, float)
        Errors are measured at its end.
    trajectories : int
        The size of the ensemble.
    engine : str
        The engine of the steps of the library. Methods of scipy call the field with numpy arrays.
    reference : str
        How the reference was computed.
    reference_accuracy : float
        Its estimated error.
    machine : str
        Where the times were measured.
    planned : int
        The number of runs that were asked for; larger than the number of rows after an interruption.

    Examples
    --------
    >>> row = WorkPrecisionRow("rk4", 0.1, None, 2.5e-7, 2e-7, 1e-15, 400, 100, 0.0123, 0.0125)
    >>> failed = WorkPrecisionRow("euler", 2.0, None, math.nan, math.nan, 1e-15, None, None, math.nan, math.nan, "far")
    >>> table = WorkPrecisionTable((row, failed), (0.0, 10.0), 1, "numpy", "Taylor series", 1e-18, "a machine", 2)
    >>> print(table)
    errors at t = 10, from t = 0
    method  setting    error  orbit error  calls  steps  CPU ms  wall ms
    rk4     dt 0.1   2.5e-07      2.0e-07    400    100    12.3     12.5
    euler   dt 2      failed
    reference: Taylor series, accurate to 1e-18
    times on a machine, engine numpy, without compilation
    euler, dt 2 failed: far
    """

    rows: tuple[WorkPrecisionRow, ...]
    t_span: tuple[float, float]
    trajectories: int
    engine: str
    reference: str
    reference_accuracy: float
    machine: str
    planned: int

    @property
    def methods(self) -> tuple[str, ...]:
        """Labels of the methods."""
        return tuple(dict.fromkeys(row.method for row in self.rows))

    def to_csv(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Comma-separated values with a line of names, all digits, and empty entries for NaN and None.

        Parameters
        ----------
        path : path_like, optional
            A file to write.
        force : bool
            Whether an existing file may be replaced.

        Raises
        ------
        FormatError
            If the file exists and `force` is False, or the file cannot be written.

        Examples
        --------
        >>> WorkPrecisionTable((), (0.0, 1.0), 1, "numpy", "", 0.0, "", 0).to_csv()[:35]
        'method,dt,tolerance,error,orbit_err'
        """
        return csv_file(WorkPrecisionRow._fields, self.rows, path, force=force)

    def plot(self, ax: Axes | None = None, *, against: str = "time", error: str = "trajectory") -> Axes:
        """Draw the errors over the cost, one curve for each method: `liehom.plotting.plot_work_precision`.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw in; by default new ones.
        against : "time", "wall", "calls" or "steps"
            The cost: CPU time, wall-clock time, calls of the field, or steps.
        error : "trajectory" or "orbit"
        """
        from liehom.plotting.work_precision_plot import plot_work_precision

        return plot_work_precision(self, ax, against=against, error=error)

    def __repr__(self) -> str:
        return str(self)

    def _caption(self) -> str:
        count = f", {self.trajectories} trajectories (root mean squares)" if self.trajectories != 1 else ""
        return f"errors at t = {self.t_span[1]:.6g}, from t = {self.t_span[0]:.6g}{count}"

    def _cells(self) -> list[list[str]]:
        head = ["method", "setting", "error", "orbit error", "calls", "steps", "CPU ms", "wall ms"]
        return [head, *map(_cells_of, self.rows)]

    def _notes(self) -> list[str]:
        notes = [f"reference: {self.reference}, accurate to {self.reference_accuracy:.0e}"]
        if any(error < row.floor for row in self.rows for error in (row.error, row.orbit_error)):
            notes.append(f"* not resolved: within a factor {MARGIN:.0f} of round-off or of the reference's accuracy")
        notes.append(f"times on {self.machine}, engine {self.engine}, without compilation")
        if all(math.isnan(row.orbit_error) for row in self.rows) and not all(row.failed for row in self.rows):
            notes.append("no orbit errors: they need a series as reference, and orbits that do not depend on time")
        if len(self.rows) < self.planned:
            notes.append(f"interrupted: {len(self.rows)} of {self.planned} runs are finished")
        return notes + [
            f"{row.method}, {row.setting}{' failed' if row.failed else ''}: {row.message}"
            for row in self.rows
            if row.message
        ]


def _cells_of(row: WorkPrecisionRow) -> list[str]:
    if row.failed:
        return [row.method, row.setting, "failed", "", "", "", "", ""]
    errors = (row.error, row.orbit_error)
    times = (row.cpu_time, row.wall_time)
    return [
        row.method,
        row.setting,
        *("" if math.isnan(x) else f"{x:.1e}" + "*" * (x < row.floor) for x in errors),
        str(row.calls),
        str(row.steps),
        *(_milliseconds(x) for x in times),
    ]


def _milliseconds(seconds: float) -> str:
    """Three significant digits, without an exponent."""
    x = 1000 * seconds
    return f"{x:.0f}" if x >= 100 else f"{x:.3g}"


def sorted_rows(rows: Sequence[WorkPrecisionRow], methods: Sequence[str]) -> tuple[WorkPrecisionRow, ...]:
    """Rows by method, fixed step sizes before tolerances, and each in decreasing order.

    Examples
    --------
    >>> rows = [WorkPrecisionRow(m, dt, None, 0, 0, 0, 0, 0, 0, 0) for dt in (0.1, 0.2) for m in "ab"]
    >>> [(row.method, row.dt) for row in sorted_rows(rows, "ba")]
    [('b', 0.2), ('b', 0.1), ('a', 0.2), ('a', 0.1)]
    """
    order = {label: k for k, label in enumerate(methods)}
    return tuple(sorted(rows, key=lambda row: (order[row.method], row.dt is None, -(row.dt or row.tolerance or 0.0))))
