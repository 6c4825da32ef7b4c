"""Solutions of the parts of an ensemble merged into one."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

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
    ...
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


# -- private helpers -------------------------------------------------------------------------------------
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
