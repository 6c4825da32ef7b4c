"""integrate_ensemble: an ensemble in chunks on any executor."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import chain, pairwise
from typing import Any, NamedTuple, TypeAlias, Unpack

import numpy as np
import numpy.typing as npt

from liehom.base.disk import digest
from liehom.base.errors import InputError, LiehomError, ShapeError
from liehom.base.pytrees import PerTrajectory, check_numbers, mapped
from liehom.base.store import Store, open_store
from liehom.base.tasks import BUFFERSIZE, ExecutorLike, completed
from liehom.base.typing import Array, IntegerArray
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.action.fingerprint import events_by_name, fingerprint, stable_repr
from liehom.flow.action.space import Action
from liehom.flow.engines.arguments import EnsembleOptions, least_atol
from liehom.flow.propagation.integration import integrate
from liehom.flow.propagation.propagator import default_step, has_series, without_order_warning
from liehom.flow.run.events import Events
from liehom.flow.run.options import (
    ATOL,
    LOST,
    RTOL,
    TRAJECTORY_MARK,
    Progress,
    Span,
    also_lost,
    among,
    overall_status,
    points_of,
    span_of,
)
from liehom.flow.run.records import ConservationReport, Report
from liehom.flow.run.solution import Solution, as_arrays, from_arrays, warn_of_failure
from liehom.flow.steps.step import as_step

# Solutions of the parts of an ensemble merged into one.


def merged(parts: Sequence[Solution], *, sampled: bool) -> Solution:
    """The solution of an ensemble from the solutions of its parts, consecutive rows of it."""
    statuses = np.concatenate([part.statuses for part in parts])
    status = overall_status(statuses)
    direction = -1.0 if any(np.any(np.diff(part.t) < 0) for part in parts) else 1.0
    report = merged_report([part.report for part in parts], direction)
    count = max(part.t.shape[-1] for part in parts)
    return Solution(
        t=parts[0].t if sampled else np.concatenate([_filled(part.t, count) for part in parts]),
        y=np.concatenate([_filled(part.y, count) for part in parts]), sol=None,
        t_events=_joined([part.t_events for part in parts]), y_events=_joined([part.y_events for part in parts]),
        nfev=sum(part.nfev for part in parts), status=status, message=_message(parts, statuses, status, report),
        n_steps=np.concatenate([part.n_steps for part in parts]), report=report, statuses=statuses,
    )  # fmt: skip


def merged_report(reports: Sequence[Report], direction: float = 1.0) -> Report:
    """The report of several runs by one method: extremes and sums of their reports."""
    least = min(reports, key=lambda report: report.singular_value)
    conserved = [report.conservation for report in reports if report.conservation is not None]
    names = [report.engine.split(", ") for report in reports if report.engine]
    numbers = _joint(reports, max, "worst_residual", "orbit_dimension")
    numbers |= _joint(reports, sum, "failed_steps", "equilibria", "near_steps", "looks", "cuts")
    numbers |= {
        name: min(_known(reports, name), key=lambda time: direction * time, default=None)
        for name in ("unkept_from", "stopped_at")
    }
    return dataclasses.replace(
        reports[0], **numbers, order=min(report.order for report in reports), singular_value=least.singular_value,
        singular_at=least.singular_at, rank=_least_rank(reports),
        engine=", ".join(dict.fromkeys(name for some in names for name in some)),
        conservation=_conserved(conserved) if conserved else None,
        diagnostics=_totals([report.diagnostics for report in reports]),
    )  # fmt: skip


# -- private helpers -------------------------------------------------------------------------------------
AnyReport: TypeAlias = Report | ConservationReport


def _filled(array: Array, count: int) -> Array:
    """The array with its last axis filled up with NaN to length `count`."""
    missing = count - array.shape[-1]
    if missing == 0:
        return array
    return np.concatenate([array, np.full((*array.shape[:-1], missing), np.nan, dtype=array.dtype)], axis=-1)


def _joined(parts: Sequence[list[npt.NDArray[Any]] | None]) -> list[npt.NDArray[Any]] | None:
    """For each event, the arrays of the parts joined."""
    lists = [part for part in parts if part is not None]
    return [np.concatenate(arrays) for arrays in zip(*lists, strict=True)] if lists else None


def _message(parts: Sequence[Solution], statuses: IntegerArray, status: int, report: Report) -> str:
    """The message of the first part with the status; after a failure, with the index in the whole ensemble."""
    message = next(part.message for part in parts if part.status == status)
    if status >= 0:
        return message
    lost = status == -1 and report.unkept_from is not None and not report.check
    more = also_lost(report.wanted_order, report.loss) if lost else ""
    return message.split(TRAJECTORY_MARK)[0] + among(statuses == status, " failed" if status == -1 else LOST) + more


def _joint(reports: Sequence[AnyReport], join: Callable[[Iterator[Any]], Any], *names: str) -> dict[str, Any]:
    """Some entries of all reports, joined."""
    return {name: join(getattr(report, name) for report in reports) for name in names}


def _known(reports: Sequence[AnyReport], name: str) -> list[Any]:
    """The values of an entry that are not None."""
    return [x for report in reports if (x := getattr(report, name)) is not None]


def _least_rank(reports: Sequence[AnyReport]) -> int:
    """The smallest rank that was met; 0 stands for no rank, in reports and as the result."""
    return min((report.rank for report in reports if report.rank), default=0)


def _totals(parts: Sequence[tuple[tuple[str, str, float], ...]]) -> tuple[tuple[str, str, float], ...]:
    """Totals of the diagnostics of several runs."""
    values: dict[tuple[str, str], list[float]] = {}
    for name, kind, value in chain.from_iterable(parts):
        values.setdefault((name, kind), []).append(value)
    joins: dict[str, Callable[[list[float]], float]] = {"max": max, "min": min, "sum": sum}
    return tuple((name, kind, joins[kind](x)) for (name, kind), x in values.items())


def _conserved(reports: Sequence[ConservationReport]) -> ConservationReport:
    first = min(_known(reports, "short_at"), key=lambda at: at[0], default=None)
    numbers = _joint(reports, max, "wanted", "iterations", "defect")
    numbers |= _joint(reports, sum, "missed_steps", "left_steps", "short_steps")
    return dataclasses.replace(reports[0], **numbers, rank=_least_rank(reports), short_at=first)


# EnsembleProblem: one call of `integrate` as a value, which can be cut into rows, sent to a worker and compared.

ARRAYS = ("dt", "t_eval")  # the options of `integrate` that are arrays


class EnsembleProblem(NamedTuple):
    """The arguments of a call of `integrate`, for a whole ensemble or for the rows that one worker gets."""

    field: GeneratorField
    t_span: Iterable[float] | Span
    start: Array
    options: dict[str, Any]

    def task(self, rows: tuple[int, int]) -> EnsembleProblem:
        """The problem of the rows first to last - 1, given as (first, last)."""
        here = slice(*rows)
        options = self.options
        dt: Any = options.get("dt")
        if np.ndim(dt):
            try:
                options = {**options, "dt": np.broadcast_to(np.asarray(dt), self.start.shape[:-1])[here]}
            except ValueError:
                raise ShapeError(f"dt has shape {np.shape(dt)}, the ensemble {self.start.shape[:-1]}") from None
        if "args" in options:
            inner = mapped(
                options["args"], lambda x: x.value.rows(here) if isinstance(x.value, PerTrajectory) else x.value
            )
            options = {**options, "args": inner}
        return self._replace(start=self.start[here], options=options)

    def ends(self) -> Span:
        """Initial and final time."""
        return span_of(self.t_span, np.dtype(np.float64))

    def made(self) -> GeneratorField:
        """The field of these trajectories, with its args if they are given."""
        args = self.options.get("args")
        return self.field if args is None else self.field.with_args(args)

    def check(self, bounds: list[tuple[int, int]]) -> GeneratorField:
        """The field of the whole ensemble, after a test that psi of a chunk equals psi of the whole on its rows."""
        check_numbers(self.options.get("args"), self.start.shape[:-1])
        field, times = self.made(), np.full(self.start.shape[:-1], self.ends()[0])
        # here rather than by the workers, who would count trajectories from the first of their chunk
        check_point(field.representation, self.start)
        field.check(self.start, times)
        with np.errstate(all="ignore"):
            values = np.asarray(field.psi(self.start, times))
            for rows in {bounds[0], bounds[-1]} if len(bounds) > 1 else ():
                part, why = self.task(rows), None
                try:
                    mine = np.asarray(part.made().psi(part.start, times[slice(*rows)]))
                    same = np.allclose(mine, values[slice(*rows)], rtol=1e-6, equal_nan=True)
                except (ValueError, LiehomError) as error:
                    same, why = False, error
                if not same:
                    raise ShapeError(
                        f"psi of the trajectories {rows[0]} to {rows[1] - 1} is not what it is within the whole "
                        "ensemble: does it hold a number for each trajectory? Pass it as args=PerTrajectory(array) to "
                        "psi(m, t, args)"
                    ) from why
        return field

    def fingerprint(self, field: GeneratorField, bounds: list[tuple[int, int]]) -> str:
        """String that distinguishes this problem from others: what was given by name, and values of psi."""
        options, events = self.options, self.options.get("events")
        functions = {"step": options.get("step"), "exponential": options.get("exponential")} | events_by_name(events)
        texts = [
            f"{name}={stable_repr(options[name])}" for name in sorted(options.keys() - {*ARRAYS, "args", "events"})
        ]
        others = {
            "options": digest(*texts, *(np.asarray(options[name]) for name in ARRAYS if options.get(name) is not None)),
            "chunk": digest(repr(bounds)),
        }
        look, (begin, end) = None, np.array(self.ends())
        if events is not None:
            look = partial(Events(events, field.args).values, np.full(self.start.shape[:-1], begin), self.start)
        return fingerprint(Action(field.representation), field, self.start, (begin, end), functions, others, look)


def solved(task: EnsembleProblem) -> Solution:
    """The solution of a problem, by `integrate` without its warning; the function that workers call."""
    with without_order_warning():  # chunks are merged, and the whole ensemble issues one
        return integrate(task.made(), task.t_span, task.start, **task.options)


def all_solved(
    problems: Sequence[EnsembleProblem], executor: ExecutorLike, store: str | os.PathLike[str] | None, retries: int = 2
) -> list[Solution]:
    """The solutions of problems that differ in dt, in order, computed on an executor and kept in a store if given."""
    kept = None
    if store is not None:
        together = problems[0].options | {"dt": [problem.options["dt"] for problem in problems]}
        kept = open_store(store, problems[0]._replace(options=together).fingerprint(problems[0].made(), []))
    names = [f"run-{number:04d}" for number in range(len(problems))]
    solutions = dict(_stored(names, problems.__getitem__, kept, executor, retries=retries))
    return [solutions[i] for i in range(len(problems))]


def _stored(
    names: Sequence[str], task: Callable[[int], EnsembleProblem], kept: Store | None, executor: ExecutorLike,
    **options: int,
) -> Iterator[tuple[int, Solution]]:  # fmt: skip
    """(number, solution) of tasks: first those that a store has under their names, then the others, which it gets."""
    done, todo = frozenset() if kept is None else kept.names(), list[int]()
    for i, name in enumerate(names):
        stored = kept.restored(name, from_arrays) if kept is not None and name in done else None
        if stored is None:
            todo.append(i)
        else:
            yield i, stored
    for number, solution in completed(solved, map(task, todo), executor, **options):
        if kept is not None:
            kept.save(names[todo[number]], *as_arrays(solution))
        yield todo[number], solution


# integrate_ensemble: an ensemble in chunks, each by `integrate`, on any executor and optionally stored on disk. The
# boundaries of the chunks depend on the size of the ensemble and of a chunk alone. So they, and the results, do not
# depend on the executor.

CHUNK = 1024  # default number of trajectories in a chunk, large enough for the fixed cost of a step to be small
UNSUPPORTED_OPTIONS = {
    "dense_output": "take t_eval: the interpolant of an ensemble is not put together from chunks",
    "checkpoint": "give store=...: finished chunks are stored there",
    "checkpoint_every": "give store=...: finished chunks are stored there",
}


class EnsemblePart(NamedTuple):
    """The solution of the trajectories `first` to `last` - 1 of an ensemble."""

    first: int
    last: int
    solution: Solution


def integrate_ensemble(
    field: GeneratorField, t_span: Iterable[float], y0: npt.ArrayLike, *, executor: ExecutorLike = None,
    chunk: int = CHUNK, store: str | os.PathLike[str] | None = None, retries: int = 2,
    progress: bool | Callable[[float], object] = False, **options: Unpack[EnsembleOptions],
) -> Solution:  # fmt: skip
    """Solution of an ensemble that is integrated in chunks, on any executor, like that of one run of `integrate`.

    Parameters
    ----------
    field : GeneratorField
    t_span, y0
        As for `integrate`; y0 has shape (n, ..., N) and is cut along its first axis.
    executor : Executor or callable, optional
        Any `concurrent.futures.Executor`: of processes, of threads, of a dask client (``client.get_executor()``), of
        mpi4py, ...; or a function without parameters that returns one, which is called again when workers die.
        Without it chunks are solved one after the other.
    chunk : int
        The largest number of rows of y0 in a task; the sizes of tasks differ by at most one row.
    store : path, optional
        A folder, or a name that ends in .zarr for a zarr group, to which each finished chunk is written. After an
        interruption of any kind, the same call continues with the missing chunks.
    retries : int
        How many times a chunk whose worker was lost is tried again, and how many times in succession executors may
        break without a chunk finished in between.
    progress : bool or callable
        As for `integrate`, by finished chunks.
    **options
        Options of `integrate` (step, dt, rtol, t_eval, events, ...); dt may have a step size for each trajectory.

    Returns
    -------
    Solution
        As `integrate` returns it. `nfev` is the sum over the chunks.

    Raises
    ------
    ShapeError, InputError
        As for `integrate`; also if psi needs the whole ensemble, or an argument cannot be sent to another process.
    WorkerLostError
        If workers are lost more often than `retries` allows.
    FormatError
        If `store` is not a store. A damaged shard is computed again, with a `DamageWarning`.

    Notes
    -----
    For a given `chunk` the results do not depend on the executor, bit for bit on machines of one kind. They hardly
    depend on `chunk`: trajectories are stepped together, each with its own time and step size, but some decisions (the
    number of terms of a series) are made for all of them, which may show in the last bit.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/3"])
    >>> starts = np.random.default_rng(0).normal(size=(20, 3))
    >>> with ThreadPoolExecutor(2) as pool:
    ...     sol = integrate_ensemble(field, (0, 1), starts, executor=pool, chunk=5, t_eval=[0.5, 1])
    ...
    >>> sol.y.shape, np.array_equal(sol.y, integrate_ensemble(field, (0, 1), starts, chunk=5, t_eval=[0.5, 1]).y)
    ((20, 3, 2), True)
    """
    starts: Any = y0
    parts: list[EnsemblePart] = []
    how: dict[str, Any] = {"executor": executor, "chunk": chunk, "store": store, "retries": retries, **options}
    with Progress(progress) as shown:
        for part in ensemble_parts(field, t_span, y0, **how):
            parts.append(part)
            shown.update(lambda: sum(part.last - part.first for part in parts) / len(starts))
        shown.update(lambda: 1.0, last=True)
    sampled = options.get("t_eval") is not None
    solution = merged([part.solution for part in sorted(parts, key=lambda part: part.first)], sampled=sampled)
    warn_of_failure(solution, stacklevel=2)
    return solution


def ensemble_parts(
    field: GeneratorField, t_span: Iterable[float], y0: npt.ArrayLike, *, executor: ExecutorLike = None,
    chunk: int = CHUNK, store: str | os.PathLike[str] | None = None, retries: int = 2,
    **options: Unpack[EnsembleOptions],
) -> Iterator[EnsemblePart]:  # fmt: skip
    """Iterator over the chunks of an ensemble in order of completion, for ensembles that do not fit in memory.

    Parameters
    ----------
    field, t_span, y0, executor, chunk, store, retries, **options
        As for `integrate_ensemble`.

    Returns
    -------
    iterator of EnsemblePart
        (first, last, solution): rows first to last - 1 of y0. Chunks in the store come first, and each chunk is in the
        store when it is returned.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> starts = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0]])
    >>> for part in ensemble_parts(field, (0, 1), starts, chunk=2, dt=0.25):
    ...     print(part.first, part.last, part.solution.y.shape)
    ...
    0 1 (1, 2, 5)
    1 3 (2, 2, 5)
    """
    for name in UNSUPPORTED_OPTIONS.keys() & options.keys():
        raise InputError(f"{name} is not an option of an ensemble in chunks; {UNSUPPORTED_OPTIONS[name]}")
    start = points_of(y0)
    if start.ndim < 2 or not len(start):
        raise ShapeError(f"y0 has shape {start.shape}, expected an ensemble, (n, ..., N); one run is `integrate`'s")
    if isinstance(chunk, bool) or not isinstance(chunk, int | np.integer) or chunk < 1:
        raise InputError(f"chunk is {chunk!r}, expected the number of trajectories of a task")
    if not isinstance(field, GeneratorField):
        raise InputError(f"expected a GeneratorField, got {field!r}: make one by liehom.GeneratorField(rho, psi)")
    problem = EnsembleProblem(field, t_span, start, dict(_with_step(options)))
    bounds = _bounds(len(start), int(chunk))
    one_field = problem.check(bounds)
    if options.get("step") is None and not has_series(one_field, start, float(problem.ends()[0])):
        problem.options["step"] = as_step("dop853")
    kept = None if store is None else open_store(store, problem.fingerprint(one_field, bounds))
    # chunks in flight, whose initial points take some 100 MB
    size = max(64, min(BUFFERSIZE, 10**8 // (8 * chunk * int(start[0].size))))
    parts = _stored(
        list(map(_name, bounds)), lambda i: problem.task(bounds[i]), kept, executor, retries=retries, buffersize=size
    )
    return (EnsemblePart(*bounds[i], solution) for i, solution in parts)


def stored_parts(store: str | os.PathLike[str]) -> Iterator[EnsemblePart]:
    """Iterator over the chunks in a store, in the order of the trajectories; missing chunks are skipped.

    Parameters
    ----------
    store : path

    Raises
    ------
    FormatError
        If the path is not a store of an ensemble, or a shard is damaged.

    Examples
    --------
    >>> import os, tempfile
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> folder = os.path.join(tempfile.mkdtemp(), "runs")
    >>> sol = integrate_ensemble(field, (0, 1), np.eye(2), chunk=1, store=folder, dt=0.25)
    >>> [(part.first, part.last, bool(part.solution.success)) for part in stored_parts(folder)]
    [(0, 1, True), (1, 2, True)]
    """
    kept = open_store(store)
    rows = [(int(m[1]), int(m[2])) for m in (re.fullmatch(r"part-(\d+)-(\d+)", name) for name in kept.names()) if m]
    return (EnsemblePart(*r, from_arrays(*kept.load(_name(r)))) for r in sorted(rows))


def _with_step(options: EnsembleOptions) -> EnsembleOptions:
    """The options with a step in place of its name or of the default for tolerances."""
    with_step: EnsembleOptions = options.copy()
    step = options.get("step")
    if isinstance(step, str):
        with_step["step"] = as_step(step)
    elif step is None and options.get("dt") is None:
        # by its name in the fingerprint, so that a store that was begun with another default is not continued
        atol = options.get("atol", ATOL)
        with_step["step"] = default_step(None, options.get("rtol", RTOL), least_atol(atol, np.size(atol)))
    return with_step


def _bounds(n: int, chunk: int) -> list[tuple[int, int]]:
    """Rows (first, last) of the chunks: as few as possible, of sizes that differ by at most 1."""
    count = -(-n // chunk)
    return list(pairwise(i * n // count for i in range(count + 1)))


def _name(rows: tuple[int, int]) -> str:
    return f"part-{rows[0]:09d}-{rows[1]:09d}"
