"""work_precision: errors and costs of several methods on one problem, for several step sizes or tolerances."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from liehom.correctors.step import ExponentialLike
from liehom.errors import InputError, LiehomError, LimitError, SeriesError, ShapeError, displayed
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.integrators.arguments import positive
from liehom.integrators.convergence.compared_methods import (
    Compared,
    Methods,
    Outcome,
    ScipyMethod,
    Setting,
    compared_methods,
)
from liehom.integrators.convergence.convergence_table import NAN
from liehom.integrators.convergence.reference import Reference
from liehom.integrators.convergence.run_errors import errors_of, floor_of, reference_for, root_mean_square
from liehom.integrators.convergence.work_precision_table import WorkPrecisionRow, WorkPrecisionTable, sorted_rows
from liehom.integrators.engines import engine_of
from liehom.integrators.points import points_of, span_of
from liehom.integrators.run.options import Span
from liehom.integrators.run.progress import Progress
from liehom.typing import Array

Made = TypeVar("Made")
ENOUGH = 1.0
"""Seconds of CPU time after which a call is not timed again."""
FINEST, SECOND = 1e-13, 1e-11
"""Tolerances of the two runs of scipy's DOP853 whose difference estimates the accuracy of a reference."""


def work_precision(
    field: GeneratorField,
    methods: Methods,
    t_span: Iterable[float],
    y0: npt.ArrayLike,
    *,
    dts: Iterable[float] = (),
    tolerances: Iterable[float] = (),
    reference: Reference | tuple[npt.ArrayLike, float] | None = None,
    exponential: ExponentialLike = "exp",
    clock: str = "corrected",
    engine: str = "numpy",
    repeats: int = 3,
    max_steps: int = 100_000,
    progress: bool | Callable[[float], object] = False,
) -> WorkPrecisionTable:
    """Work and precision of several methods on a problem, a `WorkPrecisionTable` of errors, calls, steps and times.

    Parameters
    ----------
    field : GeneratorField
    methods : sequence of methods, or mapping of labels to methods
        A method is a step, its name ("rk4"), None for the default step of `integrate`, or "scipy DOP853" for a method
        of scipy's solve_ivp (RK23, RK45, DOP853, Radau, BDF, LSODA).
    t_span, y0
        As for `integrate`. Errors are measured at the end of `t_span`.
    dts : sequence of float, optional
        Fixed step sizes, with which every step is run. Methods of scipy take tolerances only.
    tolerances : sequence of float, optional
        Values of both rtol and atol, with which every method is run with adaptive step sizes.
    reference : Reference, or (points, accuracy), optional
        The exact solution, or its points at the end of `t_span`, shape of y0, and a bound for their error. By default
        it is computed by Taylor series in extended precision, or, if psi cannot be expanded, by scipy's DOP853 with
        the tolerance 1e-13, whose accuracy is the distance from a run with 1e-11.
    exponential, clock, engine
        As for `integrate`.
    repeats : int
        The largest number of timed calls, of which the fastest counts; there are fewer if they take more than a second.
    max_steps : int
        A run that needs more steps fails.
    progress : bool or callable
        A progress bar on standard error, or a function of the fraction of runs done.

    Returns
    -------
    WorkPrecisionTable
        A run that fails is a row that says why. Ctrl-C, or a deadline of `liehom.limits`, ends the study; the table has
        the runs that were finished, and says how many were not.

    Raises
    ------
    InputError, ShapeError
        If an argument is not right: neither step sizes nor tolerances, two methods with the same label.
    ConvergenceError
        If the reference does not exist until the end.
    KeyboardInterrupt, LimitError
        If no run was finished when the study was ended.

    Notes
    -----
    CPU times are those of the process with all its threads, and contain no compilation: with an engine that compiles,
    the first call of each run is not timed. An error below the floor of its row, ten times the accuracy of the
    reference or of accumulated round-off, is not resolved. Tables mark it by an asterisk, and plots by an open gray
    marker.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> methods = {"corrected Euler": lh.Corrected(lh.Euler(), 4), "RK4": "rk4"}
    >>> table = work_precision(field, methods, (0, 5), [0.6, 0.0, 0.8], dts=[0.5, 0.25])
    >>> [(row.method, row.dt, row.steps) for row in table.rows if row.method == "RK4"]
    [('RK4', 0.5, 10), ('RK4', 0.25, 20)]
    >>> all(8 < a.error / b.error < 32 for a, b in (table.rows[:2], table.rows[2:]))
    True
    """
    if not isinstance(field, GeneratorField):
        raise InputError(f"expected a GeneratorField, got {field!r}: make one by liehom.GeneratorField(rho, psi)")
    start = points_of(y0)
    check_point(field.representation, start)
    if not start.size:
        raise ShapeError(f"y0 has shape {start.shape}: an empty ensemble has no errors to compare")
    span = span_of(t_span, start.dtype)
    settings = _settings(dts, tolerances)
    if isinstance(repeats, bool) or not isinstance(repeats, int | np.integer) or repeats < 1:
        raise InputError(f"repeats is {repeats!r}, expected an integer at least 1")
    positive("max_steps", max_steps)
    chosen = compared_methods(
        methods,
        field,
        span,
        start,
        exponential=exponential,
        clock=clock,
        engine=engine,
        max_steps=max_steps,
    )
    runs = [(method, setting) for setting in settings for method in chosen if method.takes(setting)]
    if lazy := [method.label for method in chosen if not any(method is m for m, _ in runs)]:
        raise InputError(f"{', '.join(lazy)}: methods of scipy have no fixed step sizes, give tolerances too")
    exact = _exact(field, start, span, reference, orbit=not (field.time_dependent and clock == "nominal"))
    rows = _finished(runs, lambda method, setting: _row(method, setting, exact, int(repeats)), progress)
    return WorkPrecisionTable(
        rows=sorted_rows(rows, [method.label for method in chosen]),
        t_span=(float(span[0]), float(span[1])),
        trajectories=math.prod(start.shape[:-1]),
        engine=engine_of(engine).name,
        reference=exact.text,
        reference_accuracy=exact.accuracy,
        machine=f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}",
        planned=len(runs),
    )


def _settings(dts: Iterable[float], tolerances: Iterable[float]) -> list[Setting]:
    """Different settings, step sizes first, each in decreasing order."""
    found: list[Setting] = []
    for name, values in (("dts", dts), ("tolerances", tolerances)):
        try:
            numbers = sorted({float(x) for x in values}, reverse=True)
        except (TypeError, ValueError):
            numbers = [NAN]
        if not all(0 < x < math.inf for x in numbers):
            raise InputError(f"{name} is {values!r}, expected positive numbers, e.g. [0.1, 0.05]")
        found += [Setting(dt=x) if name == "dts" else Setting(tolerance=x) for x in numbers]
    if not found:
        raise InputError("give step sizes, e.g. dts=[0.2, 0.1, 0.05], or tolerances=[1e-3, 1e-6, 1e-9], or both")
    return found


class _Exact(NamedTuple):
    """The exact points at the end, their accuracy, and the solution as a series if there is one."""

    points: Array
    accuracy: float
    text: str
    end: np.floating[Any]
    series: Reference | None
    orbit: bool

    def errors(self, points: Array) -> tuple[float, float]:
        """(orbit error, trajectory error)."""
        if self.series is not None:
            return errors_of(self.series, points, self.end, orbit=self.orbit)
        return NAN, root_mean_square(np.linalg.norm(points - self.points, axis=-1))


def _exact(
    field: GeneratorField,
    start: Array,
    span: Span,
    given: Reference | tuple[npt.ArrayLike, float] | None,
    *,
    orbit: bool,
) -> _Exact:
    """The reference: the given one, Taylor series, or two runs of DOP853."""
    first, last = span
    points: Any
    if isinstance(given, tuple):
        try:
            points, accuracy = np.asarray(given[0], dtype=np.longdouble), float(given[1])
            known = len(given) == 2 and 0 <= accuracy < math.inf and bool(np.isfinite(points).all())
        except (TypeError, ValueError, IndexError):
            known = False
        if not known:
            raise InputError(f"reference is {displayed(given)}, expected a Reference or (points, accuracy)")
        if points.shape != start.shape:
            raise ShapeError(f"the reference has points of shape {points.shape}, y0 has shape {start.shape}")
        return _Exact(points, accuracy, "given points", last, None, False)
    try:
        series = reference_for(field, start, first, given)
        points, accuracy = series(last), float(np.max(series.accuracy(last)))
        text = "given series" if given is not None else "Taylor series in extended precision"
        return _Exact(points, accuracy, text, last, series, orbit)
    except SeriesError:
        solver = ScipyMethod("", "DOP853", field, span, start)
        points, second = (solver.run(Setting(tolerance=x)).points for x in (FINEST, SECOND))
        accuracy = float(np.max(np.linalg.norm(points - second, axis=-1)))
        return _Exact(points, accuracy, f"scipy DOP853 with tolerance {FINEST:.0e}", last, None, False)


def _finished(
    runs: Sequence[tuple[Compared, Setting]],
    row: Callable[[Compared, Setting], WorkPrecisionRow],
    progress: bool | Callable[[float], object],
) -> list[WorkPrecisionRow]:
    """The rows of all runs; after an interruption, of those that are finished."""
    rows: list[WorkPrecisionRow] = []
    with Progress(progress) as shown:
        try:
            for method, setting in runs:
                shown.update(lambda: len(rows) / len(runs))
                rows.append(row(method, setting))
            shown.update(lambda: 1.0, last=True)
        except (KeyboardInterrupt, LimitError):
            if not rows:
                raise
    return rows


def _row(method: Compared, setting: Setting, exact: _Exact, repeats: int) -> WorkPrecisionRow:
    """The row of one run; a failure is a row too."""
    try:
        with np.errstate(all="ignore"):
            found, cpu, wall = timed_run(method, setting, repeats)
            orbit, error = exact.errors(found.points)
    except LimitError:
        raise
    except (LiehomError, ArithmeticError, ValueError) as problem:
        message = str(problem).strip() or type(problem).__name__
        return WorkPrecisionRow(method.label, *setting, NAN, NAN, exact.accuracy, None, None, NAN, NAN, message)
    message = found.message if math.isfinite(error) else "the points at the end are not finite"
    floor = floor_of(exact.points, found.points.dtype, found.steps, exact.accuracy)
    error, orbit = (x if math.isfinite(x) else NAN for x in (error, orbit))
    return WorkPrecisionRow(
        method.label, *setting, error, orbit, floor, found.calls, found.steps, cpu, wall, message
    )  # fmt: skip


def timed_run(method: Compared, setting: Setting, repeats: int) -> tuple[Outcome, float, float]:
    """Outcome of a run, and its CPU and wall-clock time; the first call counts only if the method compiles nothing."""
    found, cpu, wall = timed(lambda: method.run(setting), 1)
    if method.compiles:
        return (found, *timed(lambda: method.run(setting), repeats)[1:])
    if repeats > 1 and cpu < ENOUGH:
        again = timed(lambda: method.run(setting), repeats - 1)
        cpu, wall = min(cpu, again[1]), min(wall, again[2])
    return found, cpu, wall


def timed(action: Callable[[], Made], repeats: int) -> tuple[Made, float, float]:
    """(result, CPU time, wall-clock time) of a call, the smallest times of some calls, in seconds.

    Parameters
    ----------
    action : callable
    repeats : int
        The largest number of calls; no call begins after a second of CPU time.

    Examples
    --------
    >>> result, cpu, wall = timed(lambda: sum(range(1000)), 3)
    >>> result, 0 <= cpu < 1, 0 < wall < 1
    (499500, True, True)
    """
    cpu = wall = math.inf
    spent = 0.0
    for _ in range(repeats):
        begin = time.process_time(), time.perf_counter()
        made = action()
        taken = time.process_time() - begin[0], time.perf_counter() - begin[1]
        cpu, wall, spent = min(cpu, taken[0]), min(wall, taken[1]), spent + taken[0]
        if spent > ENOUGH:
            break
    return made, cpu, wall
