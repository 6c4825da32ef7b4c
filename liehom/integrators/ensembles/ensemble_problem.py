"""EnsembleProblem: one call of `integrate` as a value, which can be cut into rows, sent to a worker and compared."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.disk import digest
from liehom.errors import InputError, LiehomError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.integrators.integration import integrate
from liehom.integrators.propagator import without_order_warning
from liehom.integrators.run.checkpoint import stable_repr
from liehom.integrators.run.options import Span
from liehom.integrators.run.solution import Solution, as_arrays, from_arrays
from liehom.parallel import ExecutorLike, completed, open_store
from liehom.pytrees import Leaf, PerTrajectory, check_numbers, mapped, numbers_of
from liehom.typing import Array, Pytree

ARRAYS = ("dt", "t_eval")
"""The options of `integrate` that are arrays."""

Fields: TypeAlias = GeneratorField | Callable[..., GeneratorField]
"""A field, or a function of parameters that returns one."""


class EnsembleProblem(NamedTuple):
    """The arguments of a call of `integrate`, for a whole ensemble or for the rows that one worker gets.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> EnsembleProblem(field, (0, 1), np.eye(2), {}, {"dt": 0.5}).task((1, 2)).start
    array([[0., 1.]])
    """

    field: Fields
    t_span: Iterable[float] | Span
    start: Array
    parameters: dict[str, npt.NDArray[Any]]
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
            options = {**options, "args": _rows(options["args"], here)}
        mine = {name: array[here] for name, array in self.parameters.items()}
        return EnsembleProblem(self.field, self.t_span, self.start[here], mine, options)

    def ends(self) -> tuple[float, float]:
        """Initial and final time as floats; (0, 0) if they are not numbers, which `integrate` rejects."""
        try:
            first, last = (float(t) for t in self.t_span)
        except (TypeError, ValueError):
            return 0.0, 0.0
        return first, last

    def made(self) -> GeneratorField:
        """The field of these trajectories, with its args if they are given."""
        found = self.field if isinstance(self.field, GeneratorField) else self.field(**self.parameters)
        if not isinstance(found, GeneratorField):
            raise InputError(f"field(**parameters) returned {found!r}, expected a GeneratorField")
        args = self.options.get("args")
        return found if args is None else found.with_args(args)

    def check(self, bounds: list[tuple[int, int]]) -> GeneratorField:
        """The field of the whole ensemble, after a test that psi of a chunk equals psi of the whole on its rows."""
        check_numbers(self.options.get("args"), self.start.shape[:-1])
        whole = self.made()
        time = self.ends()[0]
        # here rather than by the workers, who would count trajectories from the first of their chunk
        check_point(whole.representation, self.start)
        whole.check(self.start, np.full(self.start.shape[:-1], time))
        with np.errstate(all="ignore"):
            values = np.asarray(whole.psi(self.start, np.full(self.start.shape[:-1], time)))
            for rows in {bounds[0], bounds[-1]} if len(bounds) > 1 else ():
                part = self.task(rows)
                try:
                    mine = np.asarray(part.made().psi(part.start, np.full(part.start.shape[:-1], time)))
                    same = np.allclose(mine, values[slice(*rows)], rtol=1e-6, equal_nan=True)
                except (ValueError, LiehomError) as error:
                    raise _whole_only(rows) from error
                if not same:
                    raise _whole_only(rows)
        return whole

    def fingerprint(self, whole: GeneratorField, bounds: list[tuple[int, int]]) -> str:
        """Digest that distinguishes this problem from others: numbers, strings, psi at the initial points and near."""
        named = sorted(_as_before(name, value) for name, value in self.options.items())
        texts = [f"{name}={_option_text(value)}" for name, value in named if name not in (*ARRAYS, "args")]
        numbers = [np.asarray(self.options[name]) for name in ARRAYS if self.options.get(name) is not None]
        parameters = [self.parameters[name] for name in sorted(self.parameters)]
        parameters += numbers_of(self.options.get("args"))
        matrices = [a.to_numpy() for a in whole.representation.matrices]
        first, last = self.ends()
        lead, ahead = self.start.shape[:-1], 1e-3 * (last - first)
        here = np.asarray(whole.psi(self.start, np.full(lead, first)))
        near = self.start + ahead * np.asarray(whole.vector(self.start, np.full(lead, first)))
        there = np.asarray(whole.psi(near, np.full(lead, first + ahead)))
        span = np.array([first, last])
        return digest(repr(texts), repr(bounds), span, self.start, *numbers, *parameters, *matrices, here, there)


def solved(task: EnsembleProblem) -> Solution:
    """The solution of a problem, by `integrate` without its warning; the function that workers call.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> solved(EnsembleProblem(field, (0, 1), np.array([1.0, 0.0]), {}, {"dt": 0.5})).n_steps
    2
    """
    with without_order_warning():  # chunks are merged, and the whole ensemble issues one
        return integrate(task.made(), task.t_span, task.start, **task.options)


def all_solved(
    problems: Sequence[EnsembleProblem], executor: ExecutorLike, store: str | os.PathLike[str] | None, retries: int = 2
) -> list[Solution]:
    """The solutions of some problems, in their order, computed on an executor and kept in a store if one is given.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> problems = [EnsembleProblem(field, (0, 1), np.eye(2), {}, {"dt": dt}) for dt in (0.5, 0.25)]
    >>> [solution.y.shape for solution in all_solved(problems, None, None)]
    [(2, 2, 3), (2, 2, 5)]
    """
    names = [f"run-{number:04d}" for number in range(len(problems))]
    kept = None
    if store is not None:
        marks = [problem.fingerprint(problem.made(), []) for problem in problems]
        kept = open_store(store, digest(repr(marks)))
    done = frozenset() if kept is None else kept.names()
    read = {i: kept.restored(names[i], from_arrays) for i in range(len(names)) if kept is not None and names[i] in done}
    found = {i: solution for i, solution in read.items() if solution is not None}
    todo = [i for i in range(len(problems)) if i not in found]
    for number, solution in completed(solved, (problems[i] for i in todo), executor, retries=retries):
        if kept is not None:
            kept.save(names[todo[number]], *as_arrays(solution))
        found[todo[number]] = solution
    return [found[i] for i in range(len(problems))]


# -- private helpers ---------------------------------------------------------------------------------------
def _whole_only(rows: tuple[int, int]) -> ShapeError:
    return ShapeError(
        f"psi of the trajectories {rows[0]} to {rows[1] - 1} is not what it is within the whole ensemble: does it "
        "carry one parameter for each trajectory? Pass a function that makes the field, and parameters={'name': array}"
    )


def _rows(args: Pytree, rows: slice) -> Pytree:
    """args of some rows of an ensemble."""

    def taken(leaf: Leaf) -> object:
        return leaf.value.rows(rows) if isinstance(leaf.value, PerTrajectory) else leaf.value

    return mapped(args, taken)


def _as_before(name: str, value: object) -> tuple[str, object]:
    """An option under the name it had in version 0.1.0, whose stores can still be continued."""
    return ("compile", None if value == "numpy" else value) if name == "engine" else (name, value)


def _option_text(value: object) -> str:
    """String of an option for fingerprints, equal in every process."""
    if isinstance(value, list | tuple):
        return repr([_option_text(x) for x in value])
    if callable(value) and hasattr(value, "__qualname__"):
        marks = [repr(getattr(value, name, None)) for name in ("terminal", "direction")]
        return f"{value.__module__}.{value.__qualname__} {marks}"
    return stable_repr(value)
