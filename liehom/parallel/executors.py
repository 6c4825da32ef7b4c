"""Executors: what is called of them, another one in place of a broken one, and what their errors say.

Only the methods `submit` and `shutdown` of an executor are called. It may be a pool of processes or threads, the
executor of a dask client, or an executor of mpi4py.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Future
from typing import Any, Protocol, TypeAlias, TypeGuard, TypeVar, final

from liehom.errors import InputError

Task = TypeVar("Task")
Result = TypeVar("Result")
# exceptions of dask for dead workers, by name, since dask is not imported here
WORKER_LOSS = ("KilledWorker", "CommClosedError", "SchedulerClosedError", "P2PConsistencyError")


class TaskExecutor(Protocol):
    """The methods that liehom calls of an executor; every `concurrent.futures.Executor` has them."""

    def submit(self, function: Callable[[Task], Result], task: Task, /) -> Future[Result]:
        """The future of ``function(task)``."""
        ...

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Release the workers."""
        ...


ExecutorLike: TypeAlias = TaskExecutor | Callable[[], TaskExecutor] | None
"""An executor, a function that makes one (called again if one breaks), or None for the calling process."""


@final
class Pool:
    """The current executor, replaced by another one when it breaks."""

    def __init__(self, source: TaskExecutor | Callable[[], TaskExecutor]) -> None:
        self._make: Callable[[], TaskExecutor] | None = None
        self._executor: TaskExecutor | None = None
        if _is_executor(source):
            self._executor = source
        elif callable(source):
            self._make = source
        else:
            raise InputError(
                f"executor is {source!r}, expected a concurrent.futures.Executor, or a function that makes one"
            )

    @property
    def renewable(self) -> bool:
        """Whether there is a function that makes another executor."""
        return self._make is not None

    def submit(self, function: Callable[[Task], Result], task: Task) -> Future[Result]:
        """The future of a task; raises `BrokenExecutor` if the executor does not accept tasks."""
        if self._executor is None and self._make is not None:
            made = self._make()
            if not callable(getattr(made, "submit", None)):
                raise InputError(f"the function that makes executors returned {made!r}")
            self._executor = made
        if self._executor is None:
            raise BrokenExecutor("there is no executor")
        try:
            return self._executor.submit(function, task)
        except RuntimeError as error:  # raised also by an executor that was shut down
            if isinstance(error, BrokenExecutor):
                raise
            raise BrokenExecutor(str(error)) from error

    def drop(self) -> None:
        """Shut the current executor down if it was made here."""
        if self.renewable and self._executor is not None:
            self._executor.shutdown(wait=True, cancel_futures=True)
            self._executor = None


def is_worker_loss(error: BaseException) -> bool:
    """Whether an exception reports the loss of workers, rather than the failure of a task.

    Examples
    --------
    >>> is_worker_loss(BrokenExecutor("a process was killed")), is_worker_loss(ValueError("psi"))
    (True, False)
    """
    kinds = (BrokenExecutor, CancelledError, ConnectionError)
    return isinstance(error, kinds) or type(error).__name__ in WORKER_LOSS


def error_of(future: Future[Any]) -> BaseException | None:
    """The exception of a finished future, `CancelledError` included, or None."""
    try:
        return future.exception()
    except CancelledError as error:
        return error


def explained(error: BaseException) -> BaseException:
    """The error of a task; for a pickling error, an `InputError` with the remedy."""
    message = str(error)
    is_pickling = isinstance(error, TypeError | AttributeError) and ("pickle" in message or "serialize" in message)
    if not is_pickling and not isinstance(error, pickle.PicklingError):
        return error
    made = InputError(
        f"a task cannot be sent to another process: {message}; give functions that have a name in a module (no lambda, "
        "no function within a function), psi as a list of strings such as ['m0', 'sin(t)'], or use an executor that "
        "pickles tasks by cloudpickle (dask), or threads"
    )
    made.__cause__ = error
    return made


def _is_executor(source: object) -> TypeGuard[TaskExecutor]:
    """Whether it has the methods of an executor and is not a class of executors."""
    return not isinstance(source, type) and callable(getattr(source, "submit", None))
