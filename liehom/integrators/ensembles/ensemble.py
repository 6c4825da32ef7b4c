"""integrate_ensemble: an ensemble in chunks, each by `integrate`, on any executor; kept on disk as they are done.

Where the boundaries of the chunks are depends on their number and size alone, never on the executor, so that neither
do the results.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.integrators.ensembles.ensemble_problem import EnsembleProblem, Fields, solved
from liehom.integrators.ensembles.merging import from_shard, merged, to_shard
from liehom.integrators.run.points import points_of
from liehom.integrators.run.progress import Progress
from liehom.integrators.run.solution import Solution
from liehom.parallel import ExecutorLike, completed, open_store

CHUNK = 1024
"""Trajectories of a chunk, where the caller does not say: many enough to hide what a step costs besides them."""
UNSUPPORTED_OPTIONS = {
    "dense_output": "take t_eval: the interpolant of an ensemble is not put together from chunks",
    "checkpoint": "give store=...: what is finished is kept there",
    "checkpoint_every": "give store=...: what is finished is kept there",
}


class EnsemblePart(NamedTuple):
    """Trajectories `first` to `last` - 1 of an ensemble, and their solution."""

    first: int
    last: int
    solution: Solution


def integrate_ensemble(
    field: Fields,
    t_span: Any,
    y0: Any,
    *,
    parameters: Mapping[str, Any] | None = None,
    executor: ExecutorLike = None,
    chunk: int = CHUNK,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    progress: bool | Callable[[float], Any] = False,
    **options: Any,
) -> Solution:
    """Integrate an ensemble in chunks, on any executor, with the results of one run.

    Parameters
    ----------
    field : GeneratorField or callable
        The field; or, where trajectories have parameters of their own, a function ``field(**parameters)`` that makes
        it: it is called with the rows that belong to a chunk.
    t_span, y0
        As for `integrate`; y0 has shape (n, ..., N) and is cut along its first axis.
    parameters : mapping of str to array of shape (n, ...), optional
        Only with a function as `field`.
    executor : Executor or callable, optional
        Any `concurrent.futures.Executor`, such as those of processes, threads, of a dask client
        (``client.get_executor()``) or of mpi4py; or a function without parameters that makes one: then another is
        made when workers die. Without it chunks are solved one after the other.
    chunk : int
        How many rows of y0 a task has, at most; tasks are of equal size up to one row.
    store : path, optional
        A folder, or a name that ends in .zarr for a zarr group, where each chunk is written when it is done. The same
        call, after whatever interruption, continues with the chunks that are missing.
    retries : int
        How often a chunk is tried again whose worker was lost, and how many times in succession executors may break
        with nothing finished in between.
    progress : bool or callable
        As for `integrate`; by finished chunks.
    **options
        Those of `integrate` (step, dt, rtol, t_eval, events, ...); dt may have a step size for each trajectory.

    Returns
    -------
    Solution
        As `integrate` returns it. `nfev` is the sum over the chunks.

    Raises
    ------
    ShapeError, InputError
        As `integrate`; also if psi needs the whole ensemble, or something cannot be sent to another process.
    WorkerLostError
        If workers are lost more often than `retries` allows.
    FormatError
        If `store` is no store, or a shard in it is damaged.

    Notes
    -----
    For a given `chunk` results do not depend on the executor, bit for bit on machines of one kind. They hardly depend
    on `chunk`: trajectories are stepped together, each with its own time and step size, but some decisions are made
    for all at once (how many terms of a series are summed), which shows in the last bit, if at all.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/3"])
    >>> starts = np.random.default_rng(0).normal(size=(20, 3))
    >>> with ThreadPoolExecutor(2) as pool:
    ...     sol = integrate_ensemble(field, (0, 1), starts, executor=pool, chunk=5, t_eval=[0.5, 1])
    >>> sol.y.shape, np.array_equal(sol.y, integrate_ensemble(field, (0, 1), starts, chunk=5, t_eval=[0.5, 1]).y)
    ((20, 3, 2), True)
    """
    with Progress(progress) as shown:
        parts: list[EnsemblePart] = []
        for part in ensemble_parts(
            field,
            t_span,
            y0,
            parameters=parameters,
            executor=executor,
            chunk=chunk,
            store=store,
            retries=retries,
            **options,
        ):
            parts.append(part)
            done = sum(p.last - p.first for p in parts) / len(y0)
            shown.update(lambda done=done: done)  # type: ignore[misc]
        shown.update(lambda: 1.0, last=True)
    sampled = options.get("t_eval") is not None
    return merged([part.solution for part in sorted(parts, key=lambda part: part.first)], sampled=sampled)


def ensemble_parts(
    field: Fields,
    t_span: Any,
    y0: Any,
    *,
    parameters: Mapping[str, Any] | None = None,
    executor: ExecutorLike = None,
    chunk: int = CHUNK,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    **options: Any,
) -> Iterator[EnsemblePart]:
    """The chunks of an ensemble as they are done, those in the store first: where all together are too large.

    Parameters
    ----------
    field, t_span, y0, parameters, executor, chunk, store, retries, **options
        As for `integrate_ensemble`.

    Returns
    -------
    iterator of EnsemblePart
        (first, last, solution): rows first to last - 1 of y0. Each is in the store when it is handed out.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> starts = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0]])
    >>> for part in ensemble_parts(field, (0, 1), starts, chunk=2, dt=0.25):
    ...     print(part.first, part.last, part.solution.y.shape)
    0 1 (1, 2, 5)
    1 3 (2, 2, 5)
    """
    for name in UNSUPPORTED_OPTIONS.keys() & options.keys():
        raise InputError(f"{name} is no option of an ensemble in chunks; {UNSUPPORTED_OPTIONS[name]}")
    start = points_of(y0)
    if start.ndim < 2 or not len(start):
        raise ShapeError(f"y0 has shape {start.shape}, expected an ensemble, (n, ..., N); one run is `integrate`'s")
    if isinstance(chunk, bool) or not isinstance(chunk, int | np.integer) or chunk < 1:
        raise InputError(f"chunk is {chunk!r}, expected the number of trajectories of a task")
    problem = EnsembleProblem(field, t_span, start, _checked(parameters, field, len(start)), options)
    bounds = _bounds(len(start), int(chunk))
    whole = problem.check(bounds)
    kept = None if store is None else open_store(store, problem.fingerprint(whole, bounds))
    done = frozenset() if kept is None else kept.names()
    todo = [rows for rows in bounds if _name(rows) not in done]

    def parts() -> Iterator[EnsemblePart]:
        for rows in bounds:
            if kept is not None and _name(rows) in done:
                yield EnsemblePart(*rows, from_shard(*kept.load(_name(rows))))
        for number, solution in completed(solved, [problem.task(rows) for rows in todo], executor, retries=retries):
            rows = todo[number]
            if kept is not None:
                kept.save(_name(rows), *to_shard(solution))
            yield EnsemblePart(*rows, solution)

    return parts()


def stored_parts(store: str | os.PathLike[str]) -> Iterator[EnsemblePart]:
    """The chunks in a store, in the order of the trajectories, one at a time; those that are missing are left out.

    Parameters
    ----------
    store : path

    Raises
    ------
    FormatError
        If there is no store of an ensemble, or a shard is damaged.

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
    return (EnsemblePart(*r, from_shard(*kept.load(_name(r)))) for r in sorted(rows))


def _checked(parameters: Mapping[str, Any] | None, field: Any, n: int) -> dict[str, Any]:
    if parameters is None:
        if not isinstance(field, GeneratorField) and not callable(field):
            raise InputError(f"expected a GeneratorField, got {field!r}: make one by liehom.GeneratorField(rho, psi)")
        return {}
    if isinstance(field, GeneratorField):
        raise InputError("parameters go to a function field(**parameters) that makes the field; this one is made")
    made = {str(name): np.asarray(value) for name, value in parameters.items()}
    for name, array in made.items():
        if array.ndim == 0 or len(array) != n:
            raise ShapeError(
                f"the parameter {name!r} has shape {array.shape}, expected one row per trajectory, ({n}, ...)"
            )
    return made


def _bounds(n: int, chunk: int) -> list[tuple[int, int]]:
    """Rows (first, last) of the chunks: as few as there can be, of sizes that differ by 1 at most."""
    count = -(-n // chunk)
    ends = [i * n // count for i in range(count + 1)]
    return list(pairwise(ends))


def _name(rows: tuple[int, int]) -> str:
    return f"part-{rows[0]:09d}-{rows[1]:09d}"
