"""observed_order: the measured order of a method, on orbits and on trajectories.

    orbit error = min over s near T of |y - F_s(m_0)|,   trajectory error = |y - F_T(m_0)|,   y after steps of size h,

root mean squares over an ensemble; the order is the slope of log(error) over log(h).
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from liehom.correctors.step import ExponentialLike, StepLike, as_step
from liehom.errors import ConvergenceError, InputError
from liehom.homogeneous import GeneratorField
from liehom.integrators.convergence.convergence_table import NAN, ConvergenceTable
from liehom.integrators.convergence.reference import Reference
from liehom.integrators.convergence.run_errors import end_points, errors_of, floor_of, reference_for
from liehom.integrators.engine import Engine
from liehom.integrators.engines import engine_option
from liehom.integrators.ensembles.ensemble_problem import EnsembleProblem, all_solved
from liehom.integrators.points import points_of, span_of
from liehom.parallel import ExecutorLike


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
    compile: str | None = None,
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
    exponential, clock, engine, compile
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
    InputError, ShapeError
        If an argument is not right: fewer than two different step sizes, or a reference with another initial point.
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
    sizes = _sizes(dts)
    first, last = span_of(t_span, start.dtype)
    if sizes[0] > abs(last - first):
        raise InputError(f"the step size {sizes[0]} is longer than t_span = {t_span!r}: it would be shortened")
    exact = reference_for(field, start, first, reference)
    chosen = engine_option(engine, compile, stacklevel=3)
    options = {"step": step, "exponential": exponential, "clock": clock, "engine": chosen}
    problems = [EnsembleProblem(field, (first, last), start, {}, {**options, "dt": h}) for h in sizes]
    runs = all_solved(problems, executor, store, retries)
    if all(run.status == -1 for run in runs):
        raise ConvergenceError(f"no step size came through; the smallest, {sizes[-1]}: {runs[-1].message}")
    accuracy = float(np.max(exact.accuracy(last)))
    orbit = not (field.time_dependent and clock == "nominal")
    errors = [(NAN, NAN) if run.status == -1 else errors_of(exact, end_points(run), last, orbit=orbit) for run in runs]
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


def _sizes(dts: Iterable[float]) -> tuple[float, ...]:
    """Different step sizes in decreasing order, at least two."""
    try:
        sizes = sorted({float(h) for h in dts}, reverse=True)
    except (TypeError, ValueError):
        sizes = []
    if len(sizes) < 2 or not all(0 < h < math.inf for h in sizes):
        raise InputError(f"dts is {dts!r}, expected two or more different positive step sizes, e.g. [0.1, 0.05]")
    return tuple(sizes)
