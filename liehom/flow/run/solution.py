"""Solution, the result of a run, with its dense output and its checkpoints."""

from __future__ import annotations

import dataclasses
import json
import os
import pickle
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, final

import numpy as np
import numpy.typing as npt

from liehom.base.disk import check_target, differing, load_arrays, write_arrays, write_atomically, write_file
from liehom.base.errors import ConvergenceError, FormatError, InputError, OrderWarning, ShapeError
from liehom.base.objects import Displayed
from liehom.base.typing import Array, IntegerArray
from liehom.flow.action.space import Action
from liehom.flow.run.control import size_for
from liehom.flow.run.records import ConservationReport, Report, of_lanes
from liehom.flow.steps.step import Generator, LocalStep, Step

# DenseSolution: the solution as a function of time, on the manifold and to the order of the step. Within a step the
# solution is s -> Exp(xi(m, s)) m at the time τ(s). A step is computed again when a time in it is asked for, so only
# points and step sizes are stored.


@final
class DenseSolution:
    """The solution of one trajectory or of an ensemble as a function of time; call it with a time or a list of times.

    Parameters
    ----------
    action : Action
    psi : Generator
    step : Step
        The method that made the steps.
    times : array of shape (n + 1, ...)
        Times of every trajectory from its initial one on without gaps, filled up with NaN.
    points : array of shape (n + 1, ..., N)
    sizes : array of shape (n, ...)
        Step sizes in the parameter of the step, filled up with 0.
    nominal : bool
        Whether time is the parameter of the step rather than its time reparametrization τ.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> sol = lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.25, dense_output=True).sol
    >>> bool(np.allclose(sol(0.3), [np.cos(0.3), np.sin(0.3)])), sol([0.1, 0.2, 0.3]).shape
    (True, (2, 3))
    """

    def __init__(
        self, action: Action, psi: Generator, step: Step, times: Array, points: Array, sizes: Array, *, nominal: bool
    ) -> None:
        self._action, self._psi, self._step = action, psi, step
        self._times, self._points, self._sizes, self._nominal = times, points, sizes, nominal
        self._shape: tuple[int, ...] = points.shape[1:-1]
        count = np.isfinite(times).sum(axis=0)  # points of each trajectory
        self._last_point = np.reshape(count - 1, -1)
        last = np.take_along_axis(times, (count - 1)[None], axis=0)[0]
        self._direction = np.where(last >= times[0], 1, -1)
        # times in the direction of integration, trajectory by trajectory, for searches
        rows = (self._direction * times).reshape(len(times), -1).T
        self._rows = [np.ascontiguousarray(row[:k]) for row, k in zip(rows, count.reshape(-1), strict=True)]
        self._prepared: tuple[IntegerArray, LocalStep] | None = None

    @property
    def steps(self) -> tuple[Array, Array, Array]:
        """Times (n + 1, ...), points (n + 1, ..., N) and sizes (n, ...) of the steps of each trajectory, filled up."""
        return self._times, self._points, self._sizes

    def __getstate__(self) -> dict[str, Any]:
        try:
            pickle.dumps(self._psi.field)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise pickle.PicklingError(
                f"the dense output calls psi, which cannot be pickled ({error}): define psi as a function of a module, "
                "or write the rest of the solution by sol.save(path)"
            ) from None
        return self.__dict__

    @property
    def t_min(self) -> Array:
        """The earliest time of each trajectory, shape (...,)."""
        return np.nanmin(self._times, axis=0)

    @property
    def t_max(self) -> Array:
        """The latest time of each trajectory, shape (...,)."""
        return np.nanmax(self._times, axis=0)

    def __call__(self, t: npt.ArrayLike) -> Array:
        """Points (..., N) at a time, (..., N, k) at k times; outside the time span the outermost step is continued."""
        queries = np.asarray(t, dtype=self._times.dtype)
        if queries.ndim > 1:
            raise ShapeError(f"t has shape {queries.shape}, expected a number or a list of times")
        flat = queries.reshape(-1)
        out: Array = np.full((*self._points.shape[1:], flat.size), np.nan, dtype=self._points.dtype)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for k in np.argsort(flat, kind="stable"):
                if np.isfinite(flat[k]):
                    out[..., k] = self._at(flat[k])
        return out[..., 0] if queries.ndim == 0 else out

    def _at(self, time: np.floating[Any]) -> Array:
        """Points (..., N) at one time, every trajectory in the step that contains it."""
        if not len(self._sizes):
            return np.asarray(self._points[0])
        wanted = (self._direction * time).reshape(-1)
        places = [np.searchsorted(row, x, side="right") - 1 for row, x in zip(self._rows, wanted, strict=True)]
        index = np.clip(np.array(places, dtype=int), 0, np.maximum(self._last_point - 1, 0)).reshape(self._shape)
        start, point = _rows(self._times, index), _rows(self._points, index[..., None])
        local = self._prepare(index, start, point)
        size = _rows(self._sizes, index)
        elapsed = np.where(size != 0, time - start, 0)
        ends = _rows(self._times, index + 1) == time
        s = elapsed if self._nominal else size_for(local, elapsed, size)
        inside = np.where((elapsed == 0)[..., None], point, self._step_to(local, np.where(ends, size, s), size))
        return np.where(ends[..., None], _rows(self._points, (index + 1)[..., None]), inside)

    def _step_to(self, local: LocalStep, s: Array, size: Array) -> Array:
        try:
            return np.asarray(local.point(s[..., None]))
        except (ConvergenceError, np.linalg.LinAlgError):
            # an implicit step that is continued beyond its ends need not have a solution
            outside = (s * np.sign(size) < 0) | (np.abs(s) > np.abs(size))
            return np.where(outside[..., None], np.nan, local.point(np.where(outside, 0, s)[..., None]))

    def _prepare(self, index: IntegerArray, start: Array, point: Array) -> LocalStep:
        """The steps number `index` of the trajectories; the last ones are cached, because times come in order."""
        if self._prepared is None or not np.array_equal(self._prepared[0], index):
            self._prepared = (index, self._step.at(self._action, self._psi, point, start[..., None]))
        return self._prepared[1]


def _rows(array: Array, index: IntegerArray) -> Array:
    """array[index[...], ...]: for each trajectory its own row."""
    return np.take_along_axis(array, index[None], axis=0)[0]


# Checkpoints: the whole state of a run in one .npz file, from which it continues bit for bit. An interruption leaves
# the older checkpoint whole. A checksum shows whether a file is damaged, and it is read without pickles.

CHECKPOINT_FORMAT = "liehom-checkpoint 2"


def checked_path(path: str | os.PathLike[str]) -> Path:
    """The path of a checkpoint, after a test that a file can be written there."""
    try:
        target = Path(os.fsdecode(path))
        check_target(target, force=True)
    except TypeError:
        raise InputError(f"checkpoint is {path!r}, expected the path of a file") from None
    except FormatError as error:
        raise InputError(f"the checkpoint {error}") from None
    return target


def save(path: str | os.PathLike[str], fingerprint: str, state: Mapping[str, npt.NDArray[Any]]) -> None:
    """Write the arrays of a state to a checkpoint."""
    texts = {"format": CHECKPOINT_FORMAT, "fingerprint": fingerprint}
    try:
        write_atomically(path, lambda file: write_arrays(file, state, texts))
    except OSError as error:
        raise InputError(f"the checkpoint {os.fspath(path)!r} cannot be written: {error.strerror}") from None


def load(path: str | os.PathLike[str], fingerprint: str) -> dict[str, npt.NDArray[Any]]:
    """Arrays of the state in a checkpoint, by name."""
    state, own = load_arrays(path, "checkpoint", CHECKPOINT_FORMAT, "fingerprint")
    if different := differing(own, fingerprint):
        raise InputError(
            f"the checkpoint {os.fspath(path)!r} belongs to another problem ({different} differ): delete it, or give "
            "another path"
        )
    return state


# Solution, the result of `integrate` in the form of scipy's solve_ivp, in memory and on disk.

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
    # a function that makes the entries that are not there yet, and its arguments
    _others: tuple[Any, ...] | None = field(default=None, init=False)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> object:
            others = None if name == "_others" else self._others
            if others is None:
                raise AttributeError(f"a Solution has no entry {name!r}", name=name, obj=self)
            make, *given = others
            for key, value in make(*given).items():
                object.__setattr__(self, key, value)
            object.__setattr__(self, "_others", None)
            return getattr(self, name)

    def __getstate__(self) -> list[object]:
        return [getattr(self, entry.name) for entry in fields(self) if entry.name[0] != "_"]

    def __setstate__(self, state: list[object]) -> None:
        for entry, value in zip(fields(self), [*state, None, None], strict=True):
            object.__setattr__(self, entry.name, value)

    @property
    def success(self) -> bool:
        """Whether the end was reached or a terminal event occurred, with the order of the step kept all the way."""
        return self.status >= 0

    @property
    def y_end(self) -> Array:
        """The last point of each trajectory in `y` that is not NaN, an array of shape (..., N).

        Examples
        --------
        Two trajectories that take 9 and 24 steps:

        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m: m[..., :1] ** 2)
        >>> sol = lh.integrate(field, (0, 5), [[0.6, 0.8], [3.0, 4.0]], rtol=1e-6)
        >>> sol.y[..., -1].round(3).tolist(), sol.y_end.round(3).tolist()
        ([[nan, nan], [0.04, 5.0]], [[0.156, 0.988], [0.04, 5.0]])
        """
        last = np.maximum(np.isfinite(self.y).all(axis=-2).sum(axis=-1) - 1, 0)
        return np.take_along_axis(self.y, np.asarray(last)[..., None, None], axis=-1)[..., 0]

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
        write_solution(self, path, force)

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
        liehom.base.errors.FormatError: 'there is no such file' is not a solution of liehom, or is damaged: ...
        """
        arrays, facts = load_arrays(path, "solution", FORMAT, "facts")
        return from_arrays(arrays, json.loads(facts))

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


class _Draft(Displayed):
    """A solution while its entries are written."""

    __slots__ = Solution.__slots__


def solution_of(t: Array, y: Array, status: int, others: tuple[Any, ...]) -> Solution:
    """A solution whose other entries a function of arguments, all in a tuple, makes when one of them is asked for."""
    draft: Any = _Draft()
    draft.t, draft.y, draft.status, draft._others = t, y, status, others
    draft.__class__ = Solution
    return draft


def interpolant(solution: Solution) -> DenseSolution | None:
    """The solution as a function of time, `sol` or the steps made again; None if it does not know its steps."""
    if solution.sol is None and solution._steps is not None:
        return solution._steps()
    return solution.sol


def warn_of_failure(solution: Solution, stacklevel: int) -> None:
    """Issue a RuntimeWarning if a trajectory failed, and an `OrderWarning` with remedies if an order was not kept."""
    if solution.status == -1:
        warnings.warn(f"status -1: {solution.message}", RuntimeWarning, stacklevel=stacklevel + 1)
    report = solution.report
    if report.unkept_from is None:
        return
    text = (
        f"{report.step} did not keep its order {report.wanted_order} from t = {report.unkept_from:.6g} on: "
        f"{report.loss}. LieTaylor({report.wanted_order}) needs no range condition."
    )
    if report.check:  # the clause of adaptive sizes
        text += " Sizes follow the tolerance, and are small there."
    elif not report.failed_steps:
        text += (
            " A smaller dt or adaptive steps help if the path passes the cone without crossing it, and another psi may "
            "move the path away."
        )
    warnings.warn(OrderWarning(text, report.wanted_order, report.unkept_from), stacklevel=stacklevel + 1)


_TRAJECTORY = ("t", "y", "sol", "t_events", "y_events", "nfev")
NAMES = (*_TRAJECTORY, "njev", "nlu", "status", "message", "success", "n_steps", "report", "statuses")
SUMMARY = ("message", "success", "status", "statuses", *_TRAJECTORY, "n_steps", "report")


def _summary_entry(value: object, indent: int) -> str:
    """String of an entry in a few lines; lines after the first are indented."""
    if isinstance(value, list):
        counts = [sum(map(len, _of_trajectories(events))) for events in value]
        times = "; ".join(f"{count} time{'' if count == 1 else 's'}" for count in counts)
        text = f"{len(value)} event{'' if len(value) == 1 else 's'}: {times}"
        text = textwrap.shorten(text, 100, placeholder=" ...")
    elif isinstance(value, np.ndarray) and value.ndim:
        shape = f" of shape {value.shape}" if value.ndim > 1 or value.size > 6 else ""
        text = np.array2string(value, precision=4, threshold=6, edgeitems=2, max_line_width=100) + shape
    else:
        text = str(value)
    return text.replace("\n", "\n" + " " * indent)


# -- a solution as arrays and facts ----------------------------------------------------------------------
def write_solution(solution: Solution, path: str | os.PathLike[str], force: bool, **more: npt.NDArray[Any]) -> None:
    """Write a solution to an .npz file, from which `Solution.load` makes it again; `more` are other arrays."""
    check_target(path, force=force)
    arrays, facts = as_arrays(solution)
    texts = {"format": FORMAT, "facts": json.dumps(facts)}

    def content(file: BinaryIO) -> None:
        write_arrays(file, {**arrays, **more}, texts)
        check_target(path, force=force)  # again: another process may have made the file meanwhile

    write_file(path, content)


def as_arrays(solution: Solution) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]:
    """A solution without its dense output as (arrays, facts), facts in types that JSON has."""
    arrays = {name: np.asarray(getattr(solution, name)) for name in ("t", "y", "n_steps", "statuses")}
    count = 0 if solution.t_events is None or solution.y_events is None else len(solution.t_events)
    for i in range(count):
        times, points = (_of_trajectories(occurrences[i]) for occurrences in (solution.t_events, solution.y_events))  # type: ignore[index]
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
    """The solution that `as_arrays` turned into arrays and facts."""
    try:
        return _from_arrays(arrays, facts)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FormatError(f"this is not a solution of this version ({type(error).__name__}: {error})") from None


def _of_trajectories(events: npt.NDArray[Any]) -> Sequence[npt.NDArray[Any]]:
    """Occurrences of an event, trajectory by trajectory."""
    return list(events.reshape(-1)) if events.dtype == object else [events]


def _from_arrays(arrays: Mapping[str, npt.NDArray[Any]], facts: Mapping[str, Any]) -> Solution:
    shape = arrays["statuses"].shape

    def occurrences(name: str) -> list[npt.NDArray[Any]] | None:
        if facts["events"] is None:
            return None
        ends = [np.cumsum(arrays[f"events_{i}_counts"])[:-1] for i in range(facts["events"])]
        return [of_lanes(np.split(arrays[f"events_{i}_{name}"], x), shape) for i, x in enumerate(ends)]

    report = _as_tuples(facts["report"])
    if report["conservation"] is not None:
        report["conservation"] = ConservationReport(**report["conservation"])
    return Solution(
        t=arrays["t"],
        y=arrays["y"],
        sol=None,
        t_events=occurrences("t"),
        y_events=occurrences("y"),
        nfev=facts["nfev"],
        status=facts["status"],
        message=facts["message"],
        n_steps=arrays["n_steps"] if shape else int(arrays["n_steps"]),
        report=Report(**report),
        statuses=arrays["statuses"] if shape else int(arrays["statuses"]),
    )


def _as_tuples(value: Any) -> Any:
    """The value with tuples in place of the lists of JSON."""
    if isinstance(value, Mapping):
        return {name: _as_tuples(x) for name, x in value.items()}
    return tuple(map(_as_tuples, value)) if isinstance(value, list | tuple) else value
