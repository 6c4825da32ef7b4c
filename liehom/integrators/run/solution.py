"""Solution, the result of `integrate` in the form of scipy's solve_ivp, in memory and on disk."""

from __future__ import annotations

import dataclasses
import json
import os
import struct
import textwrap
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.disk import check_target, checksum, write_file
from liehom.display import Displayed
from liehom.errors import FormatError, OrderWarning
from liehom.integrators.run.checkpoint import MARK, UNREADABLE
from liehom.integrators.run.dense import DenseSolution
from liehom.integrators.run.report import ConservationReport as ConservationReport
from liehom.integrators.run.report import Report as Report
from liehom.integrators.run.report import loss_of_order as loss_of_order
from liehom.integrators.run.report import shown_point as shown_point
from liehom.typing import Array, IntegerArray

FORMAT = "liehom-solution 2"


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Solution(Displayed):
    """The result of `integrate`; its entries are attributes, and items as in a dictionary.

    Attributes
    ----------
    t : array of shape (n,), or (..., n) for an ensemble
        Times; filled up with NaN for a trajectory with fewer steps than others. With `t_eval`: these times, (k,).
    y : array of shape (N, n), or (..., N, n)
        Points. With `t_eval`: (..., N, k), for an ensemble NaN at times that a trajectory has not reached.
    sol : DenseSolution or None
        The solution as a function of t, if dense output was asked for.
    t_events, y_events : list or None
        For each event the times (k,) and points (k, N) at which it occurred; for an ensemble, object arrays of these.
    nfev : int
        Number of calls of psi (on points or on series; a call for a whole ensemble counts once).
    njev, nlu : int
        0; solve_ivp has these entries too.
    status : int
        0: the end was reached; 1: a terminal event occurred; -1: a step failed; -2: the end or a terminal event was
        reached, but a `Corrected` step did not keep its order (`report` says why). For an ensemble -1 if any
        trajectory failed, else -2 if any did not keep its order, else 1 if an event ended any trajectory.
    message : str
    success : bool
        Whether status >= 0.
    n_steps : int or array of shape (...,)
        Number of steps.
    report : Report
    statuses : int or array of shape (...,)
        The status of each trajectory.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> sol = lh.integrate(field, (0, np.pi), [1.0, 0.0], dt=0.1)
    >>> sol.success, np.round(sol["y"][:, -1], 10).tolist()
    (True, [-1.0, 0.0])
    >>> print(repr(sol)[:66])
      message: The solver successfully reached the end of the integrat
    """

    t: Array
    y: Array
    sol: DenseSolution | None
    t_events: list[npt.NDArray[Any]] | None
    y_events: list[npt.NDArray[Any]] | None
    nfev: int
    status: int
    message: str
    n_steps: int | IntegerArray
    report: Report
    statuses: int | IntegerArray
    njev: int = field(default=0)
    nlu: int = field(default=0)
    # makes what `sol` would be with dense output, for plots; neither written to files nor pickled
    _steps: Callable[[], DenseSolution] | None = field(default=None, init=False)

    def __getstate__(self) -> list[object]:
        return [getattr(self, entry.name) for entry in fields(self) if entry.name != "_steps"]

    def __setstate__(self, state: list[object]) -> None:
        for entry, value in zip(fields(self), [*state, None], strict=True):
            object.__setattr__(self, entry.name, value)

    @property
    def success(self) -> bool:
        """Whether the end was reached or a terminal event occurred, with the order of the step kept all the way."""
        return self.status >= 0

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write everything but the dense output to an .npz file, whole or not at all.

        Parameters
        ----------
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
        >>> import os, tempfile
        >>> import liehom as lh
        >>> sol = lh.integrate(lh.GeneratorField(lh.defining(lh.so(2)), [1]), (0, 1), [1.0, 0.0], dt=0.25)
        >>> path = os.path.join(tempfile.mkdtemp(), "rotation.npz")
        >>> sol.save(path)
        >>> lh.Solution.load(path).report == sol.report
        True
        """
        check_target(path, force=force)
        content = archive(self)
        write_file(path, lambda file: np.savez(file, **content))  # type: ignore[arg-type]

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Solution:
        """The solution that `save` wrote, with `sol` None.

        Raises
        ------
        FormatError
            If the file holds no solution, or is damaged.

        Examples
        --------
        >>> Solution.load("there is no such file")
        Traceback (most recent call last):
        ...
        liehom.errors.FormatError: 'there is no such file' is not a solution of liehom, or is damaged: ...
        """
        name = os.fspath(path)
        try:
            with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
                arrays = {key: archive[key] for key in archive.files}
        except (*UNREADABLE, MemoryError, zipfile.BadZipFile, zlib.error, struct.error) as error:
            raise FormatError(f"{name!r} is not a solution of liehom, or is damaged: {error}") from None
        version, text, mark = (str(arrays.pop(key, "")) for key in ("format", "facts", MARK))
        if version != FORMAT:
            raise FormatError(f"{name!r} is not a solution of liehom of this version: Solution.save writes them")
        if mark != checksum(arrays, FORMAT, text):
            raise FormatError(f"the solution {name!r} is damaged, its checksum does not agree with its contents")
        return from_arrays(arrays, json.loads(text))

    def keys(self) -> tuple[str, ...]:
        """Names of the entries, a tuple of strings."""
        return NAMES

    def __getitem__(self, name: str) -> Any:
        """The entry with a name, as in a dictionary."""
        if name not in NAMES:
            raise KeyError(name)
        return getattr(self, name)

    def __contains__(self, name: object) -> bool:
        return name in NAMES

    def __iter__(self) -> Iterator[str]:
        return iter(NAMES)

    def __len__(self) -> int:
        return len(NAMES)

    def __repr__(self) -> str:
        shown = [n for n in SUMMARY if n != "statuses" or np.ndim(self.statuses)]
        width = max(map(len, shown)) + 1
        return "\n".join(f"{name:>{width}}: {_summary_entry(self[name], width + 2)}" for name in shown)


def with_steps(solution: Solution, steps: Callable[[], DenseSolution]) -> Solution:
    """The solution, which remembers its steps so that `interpolant` can make them again.

    Parameters
    ----------
    solution : Solution
    steps : callable
        Returns the dense output.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> sol = lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.5, dense_output=True)
    >>> with_steps(sol, lambda: sol.sol) is sol
    True
    """
    object.__setattr__(solution, "_steps", steps)
    return solution


def interpolant(solution: Solution) -> DenseSolution | None:
    """The solution as a function of time, which is `sol` or makes the steps again; None if it does not know its steps.

    Solutions that were read from files or pickles, those at times of `t_eval`, those that were merged from parts, and
    those of compiled calls without a path do not know their steps.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> sol = lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.5)
    >>> sol.sol is None, interpolant(sol)(0.25).round(4).tolist()
    (True, [0.9689, 0.2474])
    """
    if solution.sol is None and solution._steps is not None:
        return solution._steps()
    return solution.sol


def warn_of_order(report: Report, stacklevel: int) -> None:
    """Issue an `OrderWarning` if a corrected step did not keep its order, with the remedies.

    Parameters
    ----------
    report : Report
    stacklevel : int
        That of `warnings.warn` for the caller.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), [1, 0, 0])
    >>> warn_of_order(lh.integrate(field, (0, 1), [1.0, 0.0, 0.0]).report, 1)
    """
    if report.unkept_from is None:
        return
    text = (
        f"{report.step} did not keep its order {report.wanted_order} from t = {report.unkept_from:.6g} on: "
        f"{report.loss}. LieTaylor({report.wanted_order}) needs no range condition."
    )
    if report.failed_steps:
        text += f" Adaptive sizes are those of order {report.order}: the tolerance is kept with many more steps."
    else:
        text += " A smaller dt or adaptive steps help if the path passes the cone without crossing it, and another psi "
        text += "may move the path away from it."
    warnings.warn(OrderWarning(text, report.wanted_order, report.unkept_from), stacklevel=stacklevel + 1)


_OF_SOLVE_IVP = ("t", "y", "sol", "t_events", "y_events", "nfev", "njev", "nlu", "status", "message", "success")
NAMES = (*_OF_SOLVE_IVP, "n_steps", "report", "statuses")
SUMMARY = (
    "message",
    "success",
    "status",
    "statuses",
    "t",
    "y",
    "sol",
    "t_events",
    "y_events",
    "nfev",
    "n_steps",
    "report",
)


def _summary_entry(value: object, indent: int) -> str:
    """String of an entry in a few lines; lines after the first are indented."""
    if isinstance(value, list):
        text = f"{len(value)} event{'' if len(value) == 1 else 's'}: " + "; ".join(_occurrences(x) for x in value)
        text = textwrap.shorten(text, 100, placeholder=" ...")
    elif isinstance(value, np.ndarray) and value.ndim:
        shape = f" of shape {value.shape}" if value.ndim > 1 or value.size > 6 else ""
        text = np.array2string(value, precision=4, threshold=6, edgeitems=2, max_line_width=100) + shape
    else:
        text = str(value)
    return text.replace("\n", "\n" + " " * indent)


def _occurrences(found: npt.NDArray[Any]) -> str:
    """String of the number of occurrences of an event."""
    count = len(found) if found.dtype != object else sum(len(times) for times in found.reshape(-1))
    return f"{count} time{'' if count == 1 else 's'}"


# -- a solution as arrays and facts ----------------------------------------------------------------------
def archive(solution: Solution, **more: npt.NDArray[Any]) -> dict[str, npt.NDArray[Any]]:
    """The arrays of the .npz file of a solution, from which `Solution.load` makes it again; `more` are other arrays.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> sorted(archive(lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.25)))
    ['checksum', 'facts', 'format', 'n_steps', 'statuses', 't', 'y']
    """
    arrays, facts = as_arrays(solution)
    arrays |= more
    text = json.dumps(facts)
    marks = {"format": np.array(FORMAT), "facts": np.array(text), MARK: np.array(checksum(arrays, FORMAT, text))}
    return {**arrays, **marks}


def as_arrays(solution: Solution) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]:
    """A solution without its dense output as (arrays, facts), facts in types that JSON has.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> arrays, facts = as_arrays(lh.integrate(field, (0, 1), [[1.0, 0.0]], dt=0.25))
    >>> sorted(arrays), sorted(facts)
    (['n_steps', 'statuses', 't', 'y'], ['events', 'message', 'nfev', 'report', 'status'])
    """
    arrays = {name: np.asarray(getattr(solution, name)) for name in ("t", "y", "n_steps", "statuses")}
    count = 0 if solution.t_events is None or solution.y_events is None else len(solution.t_events)
    for i in range(count):
        times, points = (_of_trajectories(found[i]) for found in (solution.t_events, solution.y_events))  # type: ignore[index]
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


def from_arrays(arrays: Mapping[str, npt.NDArray[Any]], facts: Mapping[str, Any]) -> Solution:
    """The solution that `as_arrays` turned into arrays and facts.

    Raises
    ------
    FormatError
        If they are not a solution of this version.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> sol = lh.integrate(field, (0, 1), [[1.0, 0.0]], dt=0.25)
    >>> again = from_arrays(*as_arrays(sol))
    >>> np.array_equal(again.y, sol.y), again.report == sol.report
    (True, True)
    """
    try:
        return _from_arrays(arrays, facts)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FormatError(f"this is not a solution of this version ({type(error).__name__}: {error})") from None


def _of_trajectories(found: npt.NDArray[Any]) -> Sequence[npt.NDArray[Any]]:
    """Occurrences of an event, trajectory by trajectory."""
    return list(found.reshape(-1)) if found.dtype == object else [found]


def _from_arrays(arrays: Mapping[str, npt.NDArray[Any]], facts: Mapping[str, Any]) -> Solution:
    shape = arrays["statuses"].shape
    t_events: list[npt.NDArray[Any]] | None = None
    y_events: list[npt.NDArray[Any]] | None = None
    if facts["events"] is not None:
        t_events, y_events = [], []
        for i in range(facts["events"]):
            ends = np.cumsum(arrays[f"events_{i}_counts"])[:-1]
            times, points = (np.split(arrays[f"events_{i}_{name}"], ends) for name in "ty")
            t_events.append(_objects(times, shape) if shape else times[0])
            y_events.append(_objects(points, shape) if shape else points[0])
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
