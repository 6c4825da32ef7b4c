"""Solutions of the parts of an ensemble merged into one, and a Solution as arrays and facts, for a store."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import FormatError
from liehom.integrators.run.options import LOST, TRAJECTORY_MARK, also_lost, among, overall_status
from liehom.integrators.run.solution import ConservationReport, Report, Solution
from liehom.typing import Array, IntegerArray


def merged(parts: Sequence[Solution], *, sampled: bool) -> Solution:
    """The solution of an ensemble from the solutions of its parts, consecutive rows of it.

    Parameters
    ----------
    parts : sequence of Solution
        At least one, without dense output.
    sampled : bool
        Whether all have the same times, those of t_eval.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> def solve(y):
    ...     return lh.integrate(field, (0, 1), y, dt=0.25)
    >>> made = merged([solve([[1.0, 0.0]]), solve([[0.6, 0.8], [0.0, 1.0]])], sampled=False)
    >>> made.y.shape, made.n_steps.tolist(), made.success
    ((3, 2, 5), [4, 4, 4], True)
    """
    statuses = np.concatenate([part.statuses for part in parts])
    status = overall_status(statuses)
    report = merged_report([part.report for part in parts], _direction(parts))
    count = max(part.t.shape[-1] for part in parts)
    events = parts[0].t_events is not None
    return Solution(
        t=parts[0].t if sampled else np.concatenate([_filled(part.t, count) for part in parts]),
        y=np.concatenate([_filled(part.y, count) for part in parts]),
        sol=None,
        t_events=_joined([part.t_events for part in parts]) if events else None,
        y_events=_joined([part.y_events for part in parts]) if events else None,
        nfev=sum(part.nfev for part in parts),
        status=status,
        message=_message(parts, statuses, status, report),
        n_steps=np.concatenate([part.n_steps for part in parts]),
        report=report,
        statuses=statuses,
    )


def merged_report(reports: Sequence[Report], direction: float = 1.0) -> Report:
    """The report of several runs by one method: extremes and sums of their reports.

    Parameters
    ----------
    reports : sequence of Report
    direction : float
        1, or -1 if time decreases.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> step = lh.Corrected(lh.Euler(), 3)
    >>> runs = [lh.integrate(field, (0, 1), y, step=step, dt=0.1) for y in ([0.6, 0.0, 0.8], [0.0, 0.6, 0.8])]
    >>> made = merged_report([run.report for run in runs])
    >>> made.singular_value == min(run.report.singular_value for run in runs)
    True
    """
    least = min(reports, key=lambda report: report.singular_value)
    conserved = [report.conservation for report in reports if report.conservation is not None]
    return dataclasses.replace(
        reports[0],
        order=min(report.order for report in reports),
        worst_residual=max(report.worst_residual for report in reports),
        singular_value=least.singular_value,
        singular_at=least.singular_at,
        rank=_least_rank([report.rank for report in reports]),
        orbit_dimension=max(report.orbit_dimension for report in reports),
        failed_steps=sum(report.failed_steps for report in reports),
        equilibria=sum(report.equilibria for report in reports),
        near_steps=sum(report.near_steps for report in reports),
        unkept_from=_earliest([report.unkept_from for report in reports], direction),
        stopped_at=_earliest([report.stopped_at for report in reports], direction),
        conservation=_conserved(conserved) if conserved else None,
        diagnostics=_totals([report.diagnostics for report in reports]),
    )


def to_shard(solution: Solution) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]:
    """A solution of an ensemble as (arrays, facts), facts in types that JSON has.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> arrays, facts = to_shard(lh.integrate(field, (0, 1), [[1.0, 0.0]], dt=0.25))
    >>> sorted(arrays), sorted(facts)
    (['n_steps', 'statuses', 't', 'y'], ['events', 'message', 'nfev', 'report', 'status'])
    """
    arrays = {name: np.asarray(getattr(solution, name)) for name in ("t", "y", "n_steps", "statuses")}
    count = 0 if solution.t_events is None or solution.y_events is None else len(solution.t_events)
    for i in range(count):
        times, points = solution.t_events[i].reshape(-1), solution.y_events[i].reshape(-1)  # type: ignore[index]
        arrays[f"events_{i}_counts"] = np.array([len(t) for t in times], dtype=int)
        arrays[f"events_{i}_t"] = np.concatenate([*times, np.zeros(0)])
        arrays[f"events_{i}_y"] = np.concatenate([*points, np.zeros((0, solution.y.shape[-2]))])
    facts = {
        "status": int(solution.status),
        "message": solution.message,
        "nfev": int(solution.nfev),
        "events": None if solution.t_events is None else count,
        "report": dataclasses.asdict(solution.report),
    }
    return arrays, facts


def from_shard(arrays: Mapping[str, npt.NDArray[Any]], facts: Mapping[str, Any]) -> Solution:
    """The solution that `to_shard` turned into arrays and facts.

    Raises
    ------
    FormatError
        If they are not a solution of this version.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> sol = lh.integrate(field, (0, 1), [[1.0, 0.0]], dt=0.25)
    >>> again = from_shard(*to_shard(sol))
    >>> np.array_equal(again.y, sol.y), again.report == sol.report
    (True, True)
    """
    try:
        return _from_shard(arrays, facts)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FormatError(f"a shard holds no solution of this version ({type(error).__name__}: {error})") from None


# -- private helpers -------------------------------------------------------------------------------------
def _from_shard(arrays: Mapping[str, npt.NDArray[Any]], facts: Mapping[str, Any]) -> Solution:
    shape = arrays["statuses"].shape
    t_events: list[npt.NDArray[Any]] | None = None
    y_events: list[npt.NDArray[Any]] | None = None
    if facts["events"] is not None:
        t_events, y_events = [], []
        for i in range(facts["events"]):
            ends = np.cumsum(arrays[f"events_{i}_counts"])[:-1]
            t_events.append(_objects(np.split(arrays[f"events_{i}_t"], ends), shape))
            y_events.append(_objects(np.split(arrays[f"events_{i}_y"], ends), shape))
    return Solution(
        t=arrays["t"],
        y=arrays["y"],
        sol=None,
        t_events=t_events,
        y_events=y_events,
        nfev=facts["nfev"],
        status=facts["status"],
        message=facts["message"],
        n_steps=arrays["n_steps"] if shape else int(arrays["n_steps"]),
        report=_report(facts["report"]),
        statuses=arrays["statuses"] if shape else int(arrays["statuses"]),
    )


def _report(facts: Mapping[str, Any]) -> Report:
    at, conservation = facts["singular_at"], facts["conservation"]
    if conservation is not None:
        short = conservation["short_at"]
        short = None if short is None else (short[0], tuple(short[1]), short[2])
        conservation = ConservationReport(**{**conservation, "short_at": short})
    at = None if at is None else (at[0], tuple(at[1]))
    others = tuple((name, kind, value) for name, kind, value in facts.get("diagnostics", ()))
    return Report(**{**facts, "singular_at": at, "conservation": conservation, "diagnostics": others})


def _objects(found: Sequence[object], shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """An array of objects with some entries; `np.array` would join entries of equal shapes."""
    made = np.empty(len(found), dtype=object)
    for i, entry in enumerate(found):
        made[i] = entry
    return made.reshape(shape)


def _filled(array: Array, count: int) -> Array:
    """The array with its last axis filled up with NaN to length `count`."""
    missing = count - array.shape[-1]
    if missing == 0:
        return array
    return np.concatenate([array, np.full((*array.shape[:-1], missing), np.nan, dtype=array.dtype)], axis=-1)


def _joined(parts: Sequence[list[npt.NDArray[Any]] | None]) -> list[npt.NDArray[Any]]:
    """For each event, the arrays of the parts joined."""
    return [np.concatenate(found) for found in zip(*[part or [] for part in parts], strict=True)]


def _message(parts: Sequence[Solution], statuses: IntegerArray, status: int, report: Report) -> str:
    """The message of the first part with the status; after a failure, with the index in the whole ensemble."""
    message = next(part.message for part in parts if part.status == status)
    if status >= 0:
        return message
    more = "" if status != -1 or report.unkept_from is None else also_lost(report.wanted_order, report.loss)
    return message.split(TRAJECTORY_MARK)[0] + among(statuses == status, " failed" if status == -1 else LOST) + more


def _direction(parts: Sequence[Solution]) -> float:
    """1, or -1 if time decreases in the trajectories."""
    return -1.0 if any(np.any(np.diff(part.t) < 0) for part in parts) else 1.0


def _earliest(times: Sequence[float | None], direction: float) -> float | None:
    """The earliest of some times; None stands for no time, in `times` and as the result."""
    return min((time for time in times if time is not None), key=lambda time: direction * time, default=None)


def _least_rank(ranks: Sequence[int]) -> int:
    """The smallest rank that was met; 0 stands for no rank, in `ranks` and as the result."""
    return min((rank for rank in ranks if rank), default=0)


def _totals(parts: Sequence[tuple[tuple[str, str, float], ...]]) -> tuple[tuple[str, str, float], ...]:
    """Totals of the diagnostics of several runs."""
    found: dict[tuple[str, str], list[float]] = {}
    for name, kind, value in (entry for part in parts for entry in part):
        found.setdefault((name, kind), []).append(value)
    return tuple(
        (name, kind, max(x) if kind == "max" else min(x) if kind == "min" else sum(x))
        for (name, kind), x in found.items()
    )


def _conserved(reports: Sequence[ConservationReport]) -> ConservationReport:
    short = [report.short_at for report in reports if report.short_at is not None]
    return dataclasses.replace(
        reports[0],
        rank=_least_rank([report.rank for report in reports]),
        wanted=max(report.wanted for report in reports),
        iterations=max(report.iterations for report in reports),
        defect=max(report.defect for report in reports),
        missed_steps=sum(report.missed_steps for report in reports),
        left_steps=sum(report.left_steps for report in reports),
        short_steps=sum(report.short_steps for report in reports),
        short_at=min(short, key=lambda at: at[0], default=None),
    )
