"""ConvergenceTable: errors for several step sizes, and the slopes between those above round-off."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, final

from liehom.display import DisplayedTable
from liehom.integrators.convergence.csv_file import csv_file

MARGIN = 10.0
"""Smallest ratio of an error of the method to the accuracy of the reference and to round-off."""
NAN = math.nan


class ConvergenceRow(NamedTuple):
    """Errors for one step size, with slopes to the previous row; NaN if an error is below its floor."""

    dt: float
    orbit_error: float
    orbit_slope: float
    trajectory_error: float
    trajectory_slope: float
    floor: float


@final
@dataclass(frozen=True, slots=True, repr=False)
class ConvergenceTable(DisplayedTable):
    """Errors for several step sizes, and the slopes between them; the result of `observed_order`.

    Attributes
    ----------
    step, exponential, clock : str
        The method, as printed.
    order : int
        The order that the step claims.
    t_span : (float, float)
        Errors are measured at its end.
    trajectories : int
        The size of the ensemble; errors are root mean squares over it.
    precision : str
        Floating type of the method's computations.
    dts : tuple of float
        Step sizes, decreasing.
    orbit_errors, trajectory_errors : tuple of float
        NaN if the run failed; orbit errors also for a time-dependent field with the nominal clock.
    floors : tuple of float
        An error below its floor is within a factor 10 of the accuracy of the reference or of round-off, and no slope
        is computed from it.
    reference_accuracy : float
        The largest difference of the reference from a second solution.
    messages : tuple of str
        Why the run failed; empty if it did not.
    orbit_slopes, trajectory_slopes : tuple of float
        The slope to the previous step size; NaN in the first row and if one of the two errors is below its floor.

    Examples
    --------
    >>> table = ConvergenceTable(
    ...     "Method", "exp", "corrected", 2, (0.0, 1.0), 1, "float64", (0.2, 0.1), (4e-3, 1e-3), (8e-3, 2e-3),
    ...     (1e-15, 1e-15), 1e-16, ("", ""),
    ... )
    >>> table.orders
    (2.0, 2.0)
    >>> print(table)
    Method with exp, clock corrected, t = 0 to 1
     dt  orbit error  order  trajectory error  order
    0.2     4.00e-03                 8.00e-03
    0.1     1.00e-03   2.00          2.00e-03   2.00
    reference accurate to 1e-16
    """

    step: str
    exponential: str
    clock: str
    order: int
    t_span: tuple[float, float]
    trajectories: int
    precision: str
    dts: tuple[float, ...]
    orbit_errors: tuple[float, ...]
    trajectory_errors: tuple[float, ...]
    floors: tuple[float, ...]
    reference_accuracy: float
    messages: tuple[str, ...]
    orbit_slopes: tuple[float, ...] = field(init=False)
    trajectory_slopes: tuple[float, ...] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "orbit_slopes", _slopes(self.dts, self.orbit_errors, self.floors))
        object.__setattr__(self, "trajectory_slopes", _slopes(self.dts, self.trajectory_errors, self.floors))

    @property
    def orders(self) -> tuple[float, float]:
        """(orbit order, trajectory order): the slopes at the smallest step sizes whose errors are above the floor."""
        return _last(self.orbit_slopes), _last(self.trajectory_slopes)

    @property
    def rows(self) -> tuple[ConvergenceRow, ...]:
        """The rows of the table."""
        columns = (self.dts, self.orbit_errors, self.orbit_slopes, self.trajectory_errors, self.trajectory_slopes)
        return tuple(ConvergenceRow(*row) for row in zip(*columns, self.floors, strict=True))

    def __repr__(self) -> str:
        return str(self)

    def to_csv(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Comma-separated values with a line of names, all digits, and empty entries for NaN.

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
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + m0/2"])
        >>> table = lh.integrators.observed_order(field, [1.0, 0.0], lh.Euler(), [0.1, 0.05])
        >>> print(table.to_csv().splitlines()[0])
        dt,orbit_error,orbit_slope,trajectory_error,trajectory_slope,floor
        """
        return csv_file(ConvergenceRow._fields, self.rows, path, force=force)

    def _caption(self) -> str:
        count = f", {self.trajectories} trajectories (root mean squares)" if self.trajectories != 1 else ""
        precision = "" if self.precision == "float64" else f", {self.precision}"
        return (
            f"{self.step} with {self.exponential}, clock {self.clock}, "
            f"t = {self.t_span[0]:.6g} to {self.t_span[1]:.6g}{count}{precision}"
        )

    def _cells(self) -> list[list[str]]:
        body = []
        for i, row in enumerate(self.rows):
            orbit = (_error(row.orbit_error), self._slope(i, row.orbit_error, row.orbit_slope))
            trajectory = (_error(row.trajectory_error), self._slope(i, row.trajectory_error, row.trajectory_slope))
            body.append([f"{row.dt:.6g}", *orbit, *trajectory])
        return [["dt", "orbit error", "order", "trajectory error", "order"], *body]

    def _slope(self, i: int, error: float, slope: float) -> str:
        if error < self.floors[i]:
            return "*"
        return "" if math.isnan(slope) else f"{slope:.2f}"

    def _notes(self) -> list[str]:
        notes = [f"reference accurate to {self.reference_accuracy:.0e}"]
        errors = zip((*self.orbit_errors, *self.trajectory_errors), (*self.floors, *self.floors), strict=True)
        if any(error < floor for error, floor in errors):
            notes.append(f"* within a factor {MARGIN:.0f} of round-off or of the reference's accuracy: no order")
        if all(map(math.isnan, self.orbit_errors)) and not all(map(math.isnan, self.trajectory_errors)):
            notes.append("no orbit errors: under the nominal clock a time-dependent flow has no orbits to compare with")
        notes += [f"dt = {dt:.6g} failed: {text}" for dt, text in zip(self.dts, self.messages, strict=True) if text]
        return notes


def _slopes(dts: Sequence[float], errors: Sequence[float], floors: Sequence[float]) -> tuple[float, ...]:
    """log(e / e') / log(h / h') between neighbours; NaN where an error is NaN or below its floor."""
    made = [NAN]
    for i in range(1, len(dts)):
        seen = all(e > floor for e, floor in zip(errors[i - 1 : i + 1], floors[i - 1 : i + 1], strict=True))
        made.append(math.log(errors[i - 1] / errors[i]) / math.log(dts[i - 1] / dts[i]) if seen else NAN)
    return tuple(made[: len(dts)])


def _last(slopes: Sequence[float]) -> float:
    return next((slope for slope in reversed(slopes) if not math.isnan(slope)), NAN)


def _error(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.2e}"
