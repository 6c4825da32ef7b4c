"""Solutions as .npz archives: the arrays of `Solution.save`, and the report as a JSON string, without pickles.

A reader never sees a partial file.
"""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liehom.flow.run.records import Report
    from liehom.flow.run.solution import Solution

FORMAT = "liehom-solution"


def report_json(report: Report) -> dict[str, Any]:
    """JSON object of a report; a number that is not finite is null."""
    entries = {entry.name: plain(getattr(report, entry.name)) for entry in dataclasses.fields(report)}
    return {**entries, "range_condition": report.range_condition}


def summary_json(solution: Solution) -> dict[str, Any]:
    """JSON object of a run's outcome: status, message, counts and the report."""
    return {
        "success": bool(solution.success),
        "status": int(solution.status),
        "message": str(solution.message),
        "n_steps": plain(solution.n_steps),
        "nfev": int(solution.nfev),
        "report": report_json(solution.report),
    }


def save_solution(solution: Solution, path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write a solution to an .npz file, with its report as a JSON string; `Solution.load` reads it again."""
    import numpy as np

    from liehom.flow.run.solution import write_solution

    text = json.dumps({"format": FORMAT, "version": 1, **summary_json(solution)}, allow_nan=False)
    write_solution(solution, path, force, report=np.array(text))


def plain(value: Any) -> Any:
    """JSON value of Python data: numpy scalars and arrays as numbers and lists, null if not finite."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        value = dataclasses.asdict(value)
    if isinstance(value, Mapping):
        return {str(key): plain(x) for key, x in value.items()}
    if isinstance(value, list | tuple):
        return [plain(x) for x in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
