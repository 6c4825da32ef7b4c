"""Solutions as .npz archives: the arrays of `Solution.save`, and the report as a JSON string, without pickles.

A reader never sees a partial file.
"""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from liehom.disk import check_target, write_file

if TYPE_CHECKING:
    from liehom.integrators import Report, Solution

FORMAT = "liehom-solution"


def report_json(report: Report) -> dict[str, Any]:
    """JSON object of a report; a number that is not finite is null.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> report = lh.integrators.integrate(field, (0, 1), [1.0, 0.0]).report
    >>> report_json(report)["order"], report_json(report)["singular_value"]
    (8, None)
    """
    made = {entry.name: plain(getattr(report, entry.name)) for entry in dataclasses.fields(report)}
    return {**made, "range_condition": report.range_condition}


def summary_json(solution: Solution) -> dict[str, Any]:
    """JSON object of a run's outcome: status, message, counts and the report.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> summary_json(lh.integrators.integrate(field, (0, 1), [1.0, 0.0], dt=0.25))["n_steps"]
    4
    """
    return {
        "success": bool(solution.success),
        "status": int(solution.status),
        "message": str(solution.message),
        "n_steps": plain(solution.n_steps),
        "nfev": int(solution.nfev),
        "report": report_json(solution.report),
    }


def save_solution(solution: Solution, path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write a solution to an .npz file, with its report as a JSON string; `Solution.load` reads it again.

    Parameters
    ----------
    solution : Solution
    path : path_like
        Name of the file; no suffix is added.
    force : bool
        Whether an existing file may be replaced.

    Raises
    ------
    FormatError
        If the file exists and `force` is False, or the file cannot be written.

    Examples
    --------
    >>> import json, os, tempfile
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> path = os.path.join(tempfile.mkdtemp(), "rotation.npz")
    >>> save_solution(lh.integrators.integrate(field, (0, 1), [1.0, 0.0], dt=0.25), path)
    >>> with np.load(path) as file:
    ...     print(file["t"].shape, file["y"].shape, json.loads(str(file["report"]))["n_steps"])
    ...
    (5,) (2, 5) 4
    >>> lh.Solution.load(path).n_steps
    4
    """
    import numpy as np

    from liehom.integrators.run.solution import archive

    target = Path(path)
    check_target(target, force=force)
    text = json.dumps({"format": FORMAT, "version": 1, **summary_json(solution)}, allow_nan=False)
    arrays: dict[str, Any] = dict(archive(solution, report=np.array(text)))

    def content(file: BinaryIO) -> None:
        np.savez(file, **arrays)
        check_target(target, force=force)  # again: another process may have made the file meanwhile

    write_file(target, content)


def plain(value: Any) -> Any:
    """JSON value of Python data: numpy scalars and arrays become numbers and lists, numbers that are not finite null.

    Examples
    --------
    >>> plain((1, float("inf"), {"x": "a"}))
    [1, None, {'x': 'a'}]
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        value = dataclasses.asdict(value)
    if isinstance(value, Mapping):
        return {str(key): plain(x) for key, x in value.items()}
    if isinstance(value, list | tuple):
        return [plain(x) for x in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
