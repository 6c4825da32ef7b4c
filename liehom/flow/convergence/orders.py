"""observed_order: the measured order of a method."""

from __future__ import annotations

import math
import os
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.base.disk import check_target, write_file
from liehom.base.errors import ConvergenceError, InputError
from liehom.base.objects import DisplayedTable, comma_separated
from liehom.base.tasks import ExecutorLike
from liehom.base.typing import Array
from liehom.flow.action.field import GeneratorField
from liehom.flow.convergence.reference import Reference, orbit_distance
from liehom.flow.engines.engine import Engine
from liehom.flow.propagation.ensemble import EnsembleProblem, all_solved
from liehom.flow.run.options import points_of, span_of
from liehom.flow.steps.step import ExponentialLike, StepLike, as_step

MARGIN = 10.0  # smallest ratio of an error of the method to the accuracy of the reference and to round-off
NAN = math.nan


class MeasuredTable(DisplayedTable, ABC):
    """Errors at the end of runs, in rows that are named tuples."""

    __slots__ = ()

    t_span: tuple[float, float]
    trajectories: int

    @abstractmethod
    def _lines(self) -> list[Sequence[Any]]:
        """The names of the columns, and the rows."""

    def __repr__(self) -> str:
        return str(self)

    def to_csv(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Comma-separated values, empty for NaN and None, also written to a path; `force` replaces a file there."""
        text = comma_separated([["" if x is None or x != x else x for x in line] for line in self._lines()])
        if path is not None:
            check_target(path, force=force)
            write_file(path, text.encode())
        return text

    def _ensemble(self) -> str:
        """The end of a caption, for an ensemble."""
        return f", {self.trajectories} trajectories (root mean squares)" if self.trajectories != 1 else ""


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
class ConvergenceTable(MeasuredTable):
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

    def _lines(self) -> list[Sequence[Any]]:
        return [ConvergenceRow._fields, *self.rows]

    def _caption(self) -> str:
        precision = "" if self.precision == "float64" else f", {self.precision}"
        return (
            f"{self.step} with {self.exponential}, clock {self.clock}, "
            f"t = {self.t_span[0]:.6g} to {self.t_span[1]:.6g}{self._ensemble()}{precision}"
        )

    def _cells(self) -> list[list[str]]:
        head = ["dt", "orbit error", "order", "trajectory error", "order"]
        return [head, *([f"{r.dt:.6g}", *_shown(r[1:3], r.floor), *_shown(r[3:5], r.floor)] for r in self.rows)]

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
    seen = [error > floor for error, floor in zip(errors, floors, strict=True)]
    neighbours = zip(pairwise(dts), pairwise(errors), pairwise(seen), strict=True)
    slopes = [math.log(e[0] / e[1]) / math.log(h[0] / h[1]) if all(s) else NAN for h, e, s in neighbours]
    return (NAN, *slopes) if dts else ()


def _last(slopes: Sequence[float]) -> float:
    return next((slope for slope in reversed(slopes) if not math.isnan(slope)), NAN)


def _shown(entry: tuple[float, ...], floor: float) -> tuple[str, str]:
    """An error and its slope as strings."""
    error, slope = entry
    order = "*" if error < floor else "" if math.isnan(slope) else f"{slope:.2f}"
    return "" if math.isnan(error) else f"{error:.2e}", order


# Errors of a run at its end, on the orbit and on the trajectory, and the floor below which they are not resolved.
#     orbit error = min over s near T of |y - F_s(m_0)|,   trajectory error = |y - F_T(m_0)|
# root mean squares over an ensemble. Errors within a factor `MARGIN` of the accuracy of the reference, or of round-off,
# are not resolved.


def reference_for(
    field: GeneratorField, start: Array, first: np.floating[Any], reference: Reference | None = None
) -> Reference:
    """The reference through (first, start), the given one or one in extended precision."""
    if reference is None:
        return Reference(field, start.astype(np.longdouble), first)
    if not isinstance(reference, Reference):
        raise InputError(f"reference is {reference!r}, expected a liehom.convergence.Reference")
    if not np.array_equal(reference.start, start) or reference.t0 != first:
        raise InputError("the reference goes through another point or starts at another time than y0 at t_span[0]")
    return reference


def errors_of(reference: Reference, points: Array, end: np.floating[Any], *, orbit: bool = True) -> tuple[float, float]:
    """(orbit error, trajectory error) of points at the end; the first is NaN if `orbit` is False."""
    trajectory = root_mean_square(np.linalg.norm(points - reference(end), axis=-1))
    return (root_mean_square(orbit_distance(reference, points, end)[0]) if orbit else NAN), trajectory


def root_mean_square(distances: Array) -> float:
    """Root mean square of numbers, a float."""
    return float(np.sqrt(np.mean(distances**2)))


def floor_of(points: Array, dtype: np.dtype[Any], steps: npt.ArrayLike, accuracy: float) -> float:
    """Ten times the accuracy of the reference, or ten times the rounding of all steps added up as a random walk."""
    unit = float(np.finfo(dtype).eps) * float(np.max(np.linalg.norm(points, axis=-1), initial=0.0))
    return MARGIN * max(accuracy, unit * math.sqrt(float(np.max(steps, initial=1))))


def observed_order(
    field: GeneratorField,
    y0: npt.ArrayLike,
    step: StepLike,
    dts: Iterable[float],
    *,
    t_span: Iterable[float] = (0.0, 1.0),
    exponential: ExponentialLike = "exp",
    clock: str = "corrected",
    engine: str | Engine = "numpy",
    reference: Reference | None = None,
    executor: ExecutorLike = None,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
) -> ConvergenceTable:
    """Measured order of a step on a problem, as a `ConvergenceTable` of errors and slopes.

    Parameters
    ----------
    field : GeneratorField
    y0 : array_like of shape (N,) or (..., N)
        The initial point, or the initial points of an ensemble. numpy.longdouble shows errors below 1e-12.
    step : Step or str
    dts : sequence of float
        Step sizes; halvings are best.
    t_span : (float, float)
        Errors are measured at its end, by default t = 1 from t = 0. Choose it so that a point moves by about |m|.
    exponential, clock, engine
        As for `integrate`. With clock="nominal" the trajectory is compared at the nominal time.
    reference : Reference, optional
        The exact solution through (t_span[0], y0); by default it is computed in extended precision.
    executor, store, retries
        As for `integrate_ensemble`: the runs with the different step sizes go to an executor, and are stored.

    Returns
    -------
    ConvergenceTable

    Raises
    ------
    ConvergenceError
        If the run fails for every step size, or the solution does not exist until the end.

    Notes
    -----
    Definition 1 of the paper: a method captures orbits to order n if its orbit error is O(h^n). That holds for any
    time-step control; with the time reparametrization τ of the correctors, trajectories have the same order.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> step = lh.Corrected(lh.Euler(), order=3)
    >>> orbit, trajectory = observed_order(field, [0.6, 0.0, 0.8], step, [0.1, 0.05, 0.025]).orders
    >>> abs(orbit - 3) < 0.1, abs(trajectory - 3) < 0.1
    (True, True)
    """
    step, start = as_step(step), points_of(y0)
    sizes = decreasing("dts", dts, "two or more different positive step sizes", 2)
    first, last = span_of(t_span, start.dtype)
    if sizes[0] > abs(last - first):
        raise InputError(f"the step size {sizes[0]} is longer than t_span = {t_span!r}: it would be shortened")
    exact = reference_for(field, start, first, reference)
    options = {"step": step, "exponential": exponential, "clock": clock, "engine": engine}
    problems = [EnsembleProblem(field, (first, last), start, {**options, "dt": h}) for h in sizes]
    runs = all_solved(problems, executor, store, retries)
    if all(run.status == -1 for run in runs):
        raise ConvergenceError(
            f"no step size came through to t = {last:.6g}; end t_span before the time below, or choose another "
            f"initial point. The smallest, {sizes[-1]}: {runs[-1].message}"
        )
    accuracy = float(np.max(exact.accuracy(last)))
    orbit = not (field.time_dependent and clock == "nominal")
    errors = [(NAN, NAN) if run.status == -1 else errors_of(exact, run.y_end, last, orbit=orbit) for run in runs]
    report = runs[0].report
    return ConvergenceTable(
        step=repr(step),
        exponential=report.exponential,
        clock=report.clock,
        order=step.order,
        t_span=(float(first), float(last)),
        trajectories=math.prod(start.shape[:-1]),
        precision=start.dtype.name if start.dtype == np.float64 else "longdouble",
        dts=sizes,
        orbit_errors=tuple(e[0] for e in errors),
        trajectory_errors=tuple(e[1] for e in errors),
        floors=tuple(floor_of(exact(last), start.dtype, run.n_steps, accuracy) for run in runs),
        reference_accuracy=accuracy,
        messages=tuple(run.message if run.status == -1 else "" for run in runs),
    )


def decreasing(name: str, values: Iterable[float], expected: str, least: int = 0) -> tuple[float, ...]:
    """Different positive numbers in decreasing order, at least a number of them."""
    try:
        numbers = sorted({float(x) for x in values}, reverse=True)
    except (TypeError, ValueError):
        numbers = [NAN]
    if len(numbers) < least or not all(0 < x < math.inf for x in numbers):
        raise InputError(f"{name} is {values!r}, expected {expected}, e.g. [0.1, 0.05]")
    return tuple(numbers)
