"""Errors against settings, cost against settings, and the cost at a wanted error.

Cost is processor time of the process, the least of some rounds, on one core: other programs on the machine do not
count, and compilation does not (it is done before).  With fixed steps the cost of a call is that of beginning and end,
and so much for each step, both from two runs of different length.
"""

import math
import time
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import liehom as lh
from liehom.flow.convergence.costs import timed
from tests.benchmarks.integration_peers import Solver, extended_reference, sample_times
from tests.benchmarks.integration_problems import Problem

SAMPLES = 5
FINEST = 3e-13
MANY = 1000
CLIFF = 1e6
"""Between two settings whose errors are further apart nothing is interpolated."""
PATIENCE = 20.0
"""Seconds after which no finer setting of a solver is tried for its errors."""
TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
"""The errors at which costs are compared."""
Point = tuple[float, float, float]
"""(setting, error of the orbit, error of the trajectory)"""


def seconds(run: Callable[[], Any], rounds: int = 3) -> float:
    """Processor time of a run, the least of some rounds; long ones are made less often."""
    return timed(run, rounds)[1]


# -- errors ----------------------------------------------------------------------------------------------
def sample_of(problem: Problem) -> Any:
    """The starts on which errors are measured, (L, n)."""
    count = 2 if problem.coupled else 64 if problem.size < 10 else 16
    return problem.starts(count).reshape(count, -1)


@cache
def reference(problem: Problem, span: float) -> Any:
    """Points (SAMPLES, L, n): by heyoka in extended precision, else by Taylor steps of order 12."""
    starts, times = sample_of(problem), sample_times(span, SAMPLES)
    try:
        return extended_reference(problem, starts, times)
    except ImportError:
        dt = 0.05 * problem.slow
        y = problem.field, (0.0, span), starts.reshape(-1, *problem.shape)
        sol = lh.integrate(
            *y, step=lh.LieTaylor(10), dt=dt, t_eval=times, engine="numpy" if problem.coupled else "llvm"
        )
        return np.moveaxis(sol.y, -1, 0).reshape(SAMPLES, len(starts), -1)


def orbit_errors(problem: Problem, y: Any, exact: Any) -> Any:
    """Of every point, (SAMPLES, L): of energy and norm, or the distance from the exact orbit near the exact point."""
    if problem.energy is not None:
        lead = y.shape[:-1]
        points = y.reshape(*lead, *problem.shape)
        start = sample_of(problem)[: lead[-1]].reshape(-1, *problem.shape)
        level = problem.energy(points) - problem.energy(start)
        size = np.linalg.norm(points, axis=-1) - np.linalg.norm(start, axis=-1)
        return np.maximum(np.abs(level), np.abs(size).reshape(*lead, -1).max(-1))
    m = exact.astype(float)
    flow = lh.steps.flow_series(problem.field, m, 8, np.zeros(m.shape[:-1]))
    terms = [y - exact, *[-flow.point(k) for k in range(1, 9)]]
    s = np.zeros(m.shape[:-1])
    for _ in range(20):
        rest = sum(c * s[..., None] ** k for k, c in enumerate(terms))
        slope = sum(k * c * s[..., None] ** (k - 1) for k, c in enumerate(terms) if k)
        s = np.clip(s - (rest * slope).sum(-1) / (slope * slope).sum(-1), -0.2, 0.2)
    rest = sum(c * s[..., None] ** k for k, c in enumerate(terms))
    return np.minimum(_length(rest), _length(y - exact))


def _length(x: Any) -> Any:
    return np.linalg.norm(np.asarray(x, float), axis=-1)


def typical(errors: Any) -> float:
    """Of errors (SAMPLES, L): the largest along a trajectory, which nine of ten trajectories keep below."""
    found = float(np.quantile(np.max(errors, axis=0), 0.9))
    return found if np.isfinite(found) else math.inf


def errors(problem: Problem, solver: Solver, setting: float) -> tuple[float, float]:
    """(orbit, trajectory) at a setting."""
    starts = sample_of(problem)[: solver.sample]
    exact = reference(problem, problem.trajectory_span)[:, : len(starts)]
    with np.errstate(all="ignore"):
        y = solver.solve(problem, starts, problem.span, setting, SAMPLES)
        orbit = typical(orbit_errors(problem, y, exact))
        if problem.trajectory_span != problem.span:
            y = solver.solve(problem, starts, problem.trajectory_span, setting, SAMPLES)
        return orbit, typical(_length(y - exact))


def accuracy(problem: Problem, solver: Solver, settings: tuple[float, ...] | None = None) -> list[Point]:
    found: list[Point] = []
    for setting in settings or solver.settings:
        value = setting * problem.slow if solver.fixed else setting
        begin = time.process_time()
        try:
            found.append((value, *errors(problem, solver, value)))
        except (AssertionError, lh.LiehomError):
            continue  # too coarse: the run fails
        if (found[-1][2] < FINEST and found[-1][1] < FINEST) or time.process_time() - begin > PATIENCE:
            break
        if len(found) > 2 and found[-1][2] > found[-2][2] and found[-1][2] < 1e-9:
            break
    return found


# -- cost ------------------------------------------------------------------------------------------------
def cost(problem: Problem, solver: Solver, count: int, points: list[Point], enough: float = 0.05) -> dict[str, Any]:
    """Microseconds for each trajectory: {"call", "step"}, or for each setting those for the time `problem.span`.

    Where steps of another size cost something else: {"at": {setting: {"call", "step"}}}. Empty if nothing is measured.
    """
    if count >= MANY:
        count = min(count, solver.lanes, problem.lanes)
    starts = problem.starts(count).reshape(count, -1)
    if solver.varying:
        found = {repr(p[0]): _of_steps(problem, solver, starts, enough, p[0]) for p in points}
        return {"at": {setting: taken for setting, taken in found.items() if taken}}
    if solver.fixed:
        return _of_steps(problem, solver, starts, enough)
    span = problem.span if count < MANY else problem.lanes_span
    scale = problem.span / span / count * 1e6
    made = {}
    for setting, *_ in points:
        try:
            solver.solve(problem, starts, span / 1000, setting, 1)
            taken = seconds(lambda setting=setting: solver.solve(problem, starts, span, setting, 1))  # type: ignore[misc]
        except AssertionError:
            continue  # some trajectory is lost at this tolerance
        made[repr(setting)] = taken * scale
    return {"settings": made}


def _of_steps(
    problem: Problem, solver: Solver, starts: Any, enough: float, dt: float | None = None
) -> dict[str, float]:
    dt = 0.1 * problem.slow if dt is None else dt

    def taken(steps: int, rounds: int = 3) -> float:
        return seconds(lambda: solver.solve(problem, starts, dt * steps, dt, 1), rounds)

    few, many = 4, 12
    solver.solve(problem, starts, dt * few, dt, 1)
    first, last = taken(few), taken(many, 1)
    # until the long run is long enough, also when it is repeated
    while many < 10**8:
        if last >= 1.3 * first + enough:
            first, last = min(first, taken(few)), min(last, taken(many, 2))
            if last >= 1.2 * first + enough / 2:
                break
        wanted = (1.5 * first + enough) * (many - few) / max(last - first, 0.02 * enough)
        many = int(min(20 * many, max(3 * many, 1.3 * wanted)))
        last = taken(many, 1)
    else:
        return {}  # the run ends before its steps are made, as at an equilibrium: it shows no cost of a step
    step = max(last - first, 0.0) / (many - few)
    scale = 1e6 / len(starts)
    return {"call": max(first - few * step, 0.0) * scale, "step": step * scale}


def cost_of(problem: Problem, measured: dict[str, Any], setting: float, *, call: bool, orbit: bool) -> float:
    """Microseconds for each trajectory over the time in which the error is measured."""
    span = problem.span if orbit else problem.trajectory_span
    if "settings" in measured:
        return float(measured["settings"][repr(setting)]) * span / problem.span
    measured = measured["at"][repr(setting)] if "at" in measured else measured
    return float(measured["step"] * math.ceil(span / setting - 1e-9) + (measured["call"] if call else 0.0))


def is_known(measured: dict[str, Any], setting: float) -> bool:
    if "at" in measured:
        return repr(setting) in measured["at"]
    return "step" in measured or repr(setting) in measured["settings"]


def matched(
    problem: Problem, points: list[Point], measured: dict[str, Any], target: float, *, orbit: bool, call: bool = True
) -> float:
    """The cost at an error, by interpolation of logarithms between the settings around it; infinite if not reached."""
    column = 1 if orbit else 2
    known = [p for p in points if is_known(measured, p[0])]
    curve = sorted((cost_of(problem, measured, p[0], call=call, orbit=orbit), p[column]) for p in known)
    before: tuple[float, float] | None = None
    for price, error in curve:
        if error <= target:
            if before is None or error <= 0 or before[1] == error or before[1] / error > CLIFF:
                return price
            share = math.log(before[1] / target) / math.log(before[1] / error)
            return math.exp(math.log(before[0]) + share * math.log(price / before[0]))
        if math.isfinite(error) and (before is None or error < before[1]):
            before = price, error
    return math.inf


def drift(problem: Problem, solver: Solver, points: list[Point], target: float = 1e-6) -> float | None:
    """How far norm or spectrum are off at T, at the coarsest setting with that trajectory error; the largest."""
    settings = [p[0] for p in points if p[2] <= target]
    if not settings:
        return None
    starts = sample_of(problem)[: solver.sample]
    y = solver.solve(problem, starts, problem.trajectory_span, settings[0], 1)[0]
    before, after = (problem.drift(x.reshape(-1, *problem.shape)) for x in (starts, y))
    return float(np.max(np.abs(after - before)))


# -- from the tables -----------------------------------------------------------------------------------------
def best(
    problem: Problem, methods: list[dict[str, Any]], count: int, target: float, *, orbit: bool, call: bool
) -> tuple[float, str]:
    """The least cost of some methods at an error, and whose it is."""
    found = [
        (matched(problem, row["points"], row["costs"][str(count)], target, orbit=orbit, call=call), row["label"])
        for row in methods
        if str(count) in row.get("costs", {})
    ]
    return min(found, default=(math.inf, ""))


def curve(problem: Problem, row: dict[str, Any], count: int, *, orbit: bool) -> list[tuple[float, float]]:
    """(cost of the steps, error) along the settings of a method."""
    measured = row["costs"][str(count)]
    known = [p for p in row["points"] if is_known(measured, p[0])]
    made = [(cost_of(problem, measured, p[0], call=False, orbit=orbit), p[1 if orbit else 2]) for p in known]
    return [(c, e) for c, e in made if c > 0 and 0 < e < 3]
