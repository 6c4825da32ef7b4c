"""integrate_ensemble: an ensemble in chunks, each by `integrate`, on any executor and optionally stored on disk.

The boundaries of the chunks depend on the size of the ensemble and of a chunk alone. So they, and the results, do not
depend on the executor.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any, NamedTuple, Unpack

import numpy as np
import numpy.typing as npt

from liehom.correctors.step import as_step
from liehom.errors import InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.integrators.arguments import EnsembleOptions, least_atol
from liehom.integrators.engines import engine_option
from liehom.integrators.ensembles.ensemble_problem import EnsembleProblem, Fields, solved
from liehom.integrators.ensembles.merging import merged
from liehom.integrators.points import points_of
from liehom.integrators.propagator import ATOL, RTOL, default_step
from liehom.integrators.run.progress import Progress
from liehom.integrators.run.solution import Solution, as_arrays, from_arrays, warn_of_order
from liehom.parallel import ExecutorLike, completed, open_store
from liehom.parallel.tasks import BUFFERSIZE
from liehom.typing import Array

CHUNK = 1024
"""Default number of trajectories in a chunk, large enough for the fixed cost of a step to be small."""
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
    field: Fields,
    t_span: Iterable[float],
    y0: npt.ArrayLike,
    *,
    parameters: Mapping[str, npt.ArrayLike] | None = None,
    executor: ExecutorLike = None,
    chunk: int = CHUNK,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    progress: bool | Callable[[float], object] = False,
    **options: Unpack[EnsembleOptions],
) -> Solution:
    """Solution of an ensemble that is integrated in chunks, on any executor, like that of one run of `integrate`.

    Parameters
    ----------
    field : GeneratorField or callable
        The field; or, if trajectories have their own parameters, a function ``field(**parameters)`` that returns the
        field of a chunk, called with the rows of the parameters that belong to it.
    t_span, y0
        As for `integrate`; y0 has shape (n, ..., N) and is cut along its first axis.
    parameters : mapping of str to array of shape (n, ...), optional
        Only with a function as `field`.
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
    given: Any = y0
    options = _renamed(options, stacklevel=4)
    with Progress(progress) as shown:
        parts: list[EnsemblePart] = []
        done = 0
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
            done += part.last - part.first
            shown.update(lambda: done / len(given))  # noqa: B023 - called at once
        shown.update(lambda: 1.0, last=True)
    sampled = options.get("t_eval") is not None
    solution = merged([part.solution for part in sorted(parts, key=lambda part: part.first)], sampled=sampled)
    warn_of_order(solution.report, stacklevel=2)
    return solution


def ensemble_parts(
    field: Fields,
    t_span: Iterable[float],
    y0: npt.ArrayLike,
    *,
    parameters: Mapping[str, npt.ArrayLike] | None = None,
    executor: ExecutorLike = None,
    chunk: int = CHUNK,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    **options: Unpack[EnsembleOptions],
) -> Iterator[EnsemblePart]:
    """Iterator over the chunks of an ensemble in order of completion, for ensembles that do not fit in memory.

    Parameters
    ----------
    field, t_span, y0, parameters, executor, chunk, store, retries, **options
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
    given = _checked(parameters, field, len(start))
    problem = EnsembleProblem(field, t_span, start, given, dict(_renamed(options, stacklevel=4)))
    bounds = _bounds(len(start), int(chunk))
    whole = problem.check(bounds)
    kept = None if store is None else open_store(store, problem.fingerprint(whole, bounds))
    done = frozenset() if kept is None else kept.names()
    todo = [rows for rows in bounds if _name(rows) not in done]

    def parts() -> Iterator[EnsemblePart]:
        for rows in bounds:
            if kept is not None and _name(rows) in done:
                stored = kept.restored(_name(rows), from_arrays)
                if stored is None:
                    todo.append(rows)
                else:
                    yield EnsemblePart(*rows, stored)
        tasks, buffersize = (problem.task(rows) for rows in todo), _buffersize(start, chunk)
        for number, solution in completed(solved, tasks, executor, retries=retries, buffersize=buffersize):
            rows = todo[number]
            if kept is not None:
                kept.save(_name(rows), *as_arrays(solution))
            yield EnsemblePart(*rows, solution)

    return parts()


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


def _renamed(options: EnsembleOptions, stacklevel: int) -> EnsembleOptions:
    """The options with `engine` in place of its former name `compile`, and a step in place of its name."""
    renamed: EnsembleOptions = options.copy()
    if isinstance(renamed.get("step"), str):
        renamed["step"] = as_step(renamed["step"] or "")
    if renamed.get("step") is None and renamed.get("dt") is None:
        # by its name in the fingerprint, so that a store that was begun with another default is not continued
        atol = renamed.get("atol", ATOL)
        renamed["step"] = default_step(None, renamed.get("rtol", RTOL), least_atol(atol, np.size(atol)))
    if "compile" in renamed:
        renamed["engine"] = engine_option(options.get("engine", "numpy"), renamed.pop("compile"), stacklevel=stacklevel)
    return renamed


def _checked(parameters: Mapping[str, npt.ArrayLike] | None, field: Fields, n: int) -> dict[str, npt.NDArray[Any]]:
    """The parameters as arrays of n rows each."""
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
    """Rows (first, last) of the chunks: as few as possible, of sizes that differ by at most 1."""
    count = -(-n // chunk)
    ends = [i * n // count for i in range(count + 1)]
    return list(pairwise(ends))


def _buffersize(start: Array, chunk: int) -> int:
    """Number of chunks in flight, whose initial points take some 100 MB."""
    return max(64, min(BUFFERSIZE, 10**8 // (8 * chunk * int(start[0].size))))


def _name(rows: tuple[int, int]) -> str:
    return f"part-{rows[0]:09d}-{rows[1]:09d}"
