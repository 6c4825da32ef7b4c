"""work_precision: errors and costs of several methods on one problem."""

from __future__ import annotations

import math
import platform
import re
import time
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar, cast, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import ConvergenceError, InputError, LiehomError, LimitError, SeriesError, ShapeError, displayed
from liehom.base.objects import provider
from liehom.base.typing import Array
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.convergence.orders import (
    MARGIN,
    NAN,
    MeasuredTable,
    decreasing,
    errors_of,
    floor_of,
    reference_for,
    root_mean_square,
)
from liehom.flow.convergence.reference import Reference
from liehom.flow.engines.arguments import positive
from liehom.flow.propagation.propagator import Propagator, engine_of, without_order_warning
from liehom.flow.run.options import Progress, Span, points_of, span_of
from liehom.flow.steps.step import ExponentialLike, StepLike

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Methods of a comparison: steps of the library and solvers of scipy, each run with a step size or a tolerance.

MethodLike: TypeAlias = StepLike | None
"""A step, its name, None for the default step, or "scipy NAME" for a method of scipy's solve_ivp."""
Methods: TypeAlias = MethodLike | Mapping[str, MethodLike] | Iterable[MethodLike]

PEERS = {name.lower(): name for name in ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")}
_PEER = re.compile(r"scipy[\s:.]+(\w+)", re.IGNORECASE)
DEFAULT = "default"  # label of the default step


class Setting(NamedTuple):
    """A fixed step size or a tolerance; the other one is None."""

    dt: float | None = None
    tolerance: float | None = None

    def __str__(self) -> str:
        return f"tol {self.tolerance:.6g}" if self.dt is None else f"dt {self.dt:.6g}"


class Outcome(NamedTuple):
    """Points (..., N) at the end of a run, calls of the field, steps, and a message if the order was lost."""

    points: Array
    calls: int
    steps: int
    message: str = ""


@dataclass(frozen=True, slots=True)
class Compared:
    """A method of a comparison, for one field, time span and initial point."""

    label: str
    run: Callable[[Setting], Outcome]  # to the end; raises `ConvergenceError` if it fails
    compiles: bool = False
    adaptive_only: bool = False  # whether it has no fixed step sizes


def step_method(label: str, propagator: Propagator, span: Span, start: Array, max_steps: int) -> Compared:
    """A step of the library, as a `Propagator` that is made once."""

    def run(setting: Setting) -> Outcome:
        size, tolerance = setting
        options: dict[str, Any] = {"dt": size} if tolerance is None else {"rtol": tolerance, "atol": tolerance}
        with without_order_warning():
            solution = propagator(span, start, t_eval=[span[1]], max_steps=max_steps, **options)
        if solution.status == -1:
            raise ConvergenceError(solution.message)
        lost = solution.message if solution.status == -2 else ""
        return Outcome(solution.y[..., -1], int(solution.nfev), int(np.max(solution.n_steps)), lost)

    return Compared(label, run, compiles=propagator.engine.name != "numpy")


def scipy_method(label: str, name: str, field: GeneratorField, span: Span, start: Array) -> Compared:
    """A method of scipy's solve_ivp on m' = X(m, t), all trajectories of an ensemble as one system."""

    def rates(t: float, y: Array) -> Array:
        return np.asarray(field.vector(y.reshape(start.shape), np.full(start.shape[:-1], t))).reshape(-1)

    def run(setting: Setting) -> Outcome:
        from scipy.integrate import solve_ivp

        options = {"rtol": setting.tolerance, "atol": setting.tolerance}
        with warnings.catch_warnings(record=True) as said:  # for example that the tolerance is replaced
            warnings.simplefilter("always")
            solution = solve_ivp(
                rates, (float(span[0]), float(span[1])), start.astype(float).reshape(-1), name, **options
            )
        if not solution.success:
            raise ConvergenceError(solution.message)
        message = " ".join(dict.fromkeys(str(warning.message) for warning in said))
        return Outcome(solution.y[:, -1].reshape(start.shape), int(solution.nfev), len(solution.t) - 1, message)

    return Compared(label, run, adaptive_only=True)


def compared_methods(
    methods: Methods,
    field: GeneratorField,
    propagator: Callable[[StepLike | None], Propagator],
    span: Span,
    start: Array,
    max_steps: int,
) -> list[Compared]:
    """The methods of a comparison, with labels that differ, from the propagator of each step."""
    if isinstance(methods, Mapping):
        labelled = [(str(label), method) for label, method in methods.items()]
    else:
        one = isinstance(methods, str) or not isinstance(methods, Iterable)
        labelled = [("", method) for method in ([methods] if one else methods)]  # type: ignore[union-attr]
    compared: list[Compared] = []
    for label, method in labelled:
        peer = _PEER.fullmatch(method.strip()) if isinstance(method, str) else None
        if peer is None:
            label = label or (DEFAULT if method is None else method if isinstance(method, str) else repr(method))
            compared.append(step_method(label, propagator(method), span, start, max_steps))
        elif peer[1].lower() in PEERS:
            name = PEERS[peer[1].lower()]
            compared.append(scipy_method(label or f"scipy {name}", name, field, span, start))
        else:
            raise InputError(f"no method of scipy is called {displayed(peer[1])}; known: {', '.join(PEERS.values())}")
    labels = [method.label for method in compared]
    if not compared or len(set(labels)) < len(labels):
        raise InputError(f"expected methods with different labels, got {labels}: give a mapping of labels to steps")
    return compared


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
class WorkPrecisionTable(MeasuredTable):
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
        return cast("Axes", provider("work precision")(self, ax, against=against, error=error))

    def _lines(self) -> list[Sequence[Any]]:
        return [WorkPrecisionRow._fields, *self.rows]

    def _caption(self) -> str:
        return f"errors at t = {self.t_span[1]:.6g}, from t = {self.t_span[0]:.6g}{self._ensemble()}"

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
    errors = ("" if math.isnan(x) else f"{x:.1e}" + "*" * (x < row.floor) for x in (row.error, row.orbit_error))
    times = (f"{x:.0f}" if x >= 100 else f"{x:.3g}" for x in (1000 * row.cpu_time, 1000 * row.wall_time))
    return [row.method, row.setting, *errors, str(row.calls), str(row.steps), *times]


def sorted_rows(rows: Sequence[WorkPrecisionRow], methods: Sequence[str]) -> tuple[WorkPrecisionRow, ...]:
    """Rows by method, fixed step sizes before tolerances, and each in decreasing order."""
    order = {label: k for k, label in enumerate(methods)}
    return tuple(sorted(rows, key=lambda row: (order[row.method], row.dt is None, -(row.dt or row.tolerance or 0.0))))


Made = TypeVar("Made")
ENOUGH = 1.0  # seconds of CPU time after which a call is not timed again
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
    propagator = partial(Propagator, field, exponential=exponential, clock=clock, engine=engine)
    chosen = compared_methods(methods, field, propagator, span, start, max_steps)
    runs = [(x, setting) for setting in settings for x in chosen if setting.dt is None or not x.adaptive_only]
    if lazy := [method.label for method in chosen if not any(method is m for m, _ in runs)]:
        raise InputError(f"{', '.join(lazy)}: methods of scipy have no fixed step sizes, give tolerances too")
    exact = _exact(field, start, span, reference, orbit=not (field.time_dependent and clock == "nominal"))
    rows = _finished(runs, partial(_row, exact=exact, repeats=int(repeats)), progress)
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
    settings = [Setting(dt=x) for x in decreasing("dts", dts, "positive numbers")]
    settings += [Setting(tolerance=x) for x in decreasing("tolerances", tolerances, "positive numbers")]
    if not settings:
        raise InputError("give step sizes, e.g. dts=[0.2, 0.1, 0.05], or tolerances=[1e-3, 1e-6, 1e-9], or both")
    return settings


class _Exact(NamedTuple):
    """The exact points at the end, their accuracy, how they were found, and the errors of other points."""

    points: Array
    accuracy: float
    text: str
    errors: Callable[[Array], tuple[float, float]]  # of the orbit and of the trajectory


def _exact(
    field: GeneratorField,
    start: Array,
    span: Span,
    reference: Reference | tuple[npt.ArrayLike, float] | None,
    *,
    orbit: bool,
) -> _Exact:
    """The reference: the given one, Taylor series, or two runs of DOP853."""
    first, last = span
    points: Any

    def apart(reached: Array) -> tuple[float, float]:
        return NAN, root_mean_square(np.linalg.norm(reached - points, axis=-1))

    if isinstance(reference, tuple):
        try:
            points, accuracy = np.asarray(reference[0], dtype=np.longdouble), float(reference[1])
        except (TypeError, ValueError, IndexError):
            points, accuracy = np.zeros(0), NAN
        if not (len(reference) == 2 and 0 <= accuracy < math.inf and bool(np.isfinite(points).all())):
            raise InputError(f"reference is {displayed(reference)}, expected a Reference or (points, accuracy)")
        if points.shape != start.shape:
            raise ShapeError(f"the reference has points of shape {points.shape}, y0 has shape {start.shape}")
        return _Exact(points, accuracy, "given points", apart)
    try:
        series = reference_for(field, start, first, reference)
        points, accuracy = series(last), float(np.max(series.accuracy(last)))
        text = "given series" if reference is not None else "Taylor series in extended precision"
        return _Exact(points, accuracy, text, partial(errors_of, series, end=last, orbit=orbit))
    except SeriesError:
        solver = scipy_method("", "DOP853", field, span, start)
        points, second = (solver.run(Setting(tolerance=x)).points for x in (FINEST, SECOND))
        accuracy = float(np.max(np.linalg.norm(points - second, axis=-1)))
        return _Exact(points, accuracy, f"scipy DOP853 with tolerance {FINEST:.0e}", apart)


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
            run, cpu, wall = timed_run(method, setting, repeats)
            orbit, error = exact.errors(run.points)
    except LimitError:
        raise
    except (LiehomError, ArithmeticError, ValueError) as problem:
        message = str(problem).strip() or type(problem).__name__
        return WorkPrecisionRow(method.label, *setting, NAN, NAN, exact.accuracy, None, None, NAN, NAN, message)
    message = run.message if math.isfinite(error) else "the points at the end are not finite"
    floor = floor_of(exact.points, run.points.dtype, run.steps, exact.accuracy)
    error, orbit = (x if math.isfinite(x) else NAN for x in (error, orbit))
    return WorkPrecisionRow(method.label, *setting, error, orbit, floor, run.calls, run.steps, cpu, wall, message)


def timed_run(method: Compared, setting: Setting, repeats: int) -> tuple[Outcome, float, float]:
    """Outcome of a run, and its CPU and wall-clock time; the first call counts only if the method compiles nothing."""
    if method.compiles:
        method.run(setting)
    return timed(lambda: method.run(setting), repeats)


def timed(action: Callable[[], Made], repeats: int) -> tuple[Made, float, float]:
    """(result, CPU time, wall-clock time) of a call, the smallest times of some calls, in seconds."""
    cpu = wall = math.inf
    spent = 0.0
    for _ in range(repeats):
        begin = time.process_time(), time.perf_counter()
        result = action()
        taken = time.process_time() - begin[0], time.perf_counter() - begin[1]
        cpu, wall, spent = min(cpu, taken[0]), min(wall, taken[1]), spent + taken[0]
        if spent > ENOUGH:
            break
    return result, cpu, wall
