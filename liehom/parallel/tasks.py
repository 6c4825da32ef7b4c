"""Results of many tasks on any `concurrent.futures.Executor`, in order of completion.

Only the methods `submit` and `shutdown` of an executor are called. It may be a pool of processes or threads, the
executor of a dask client, or an executor of mpi4py. The result of a task depends on its argument alone, so results do
not depend on the executor. Tasks of lost workers are submitted again.
"""

from __future__ import annotations

import pickle
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future
from dataclasses import asdict, dataclass
from queue import SimpleQueue
from typing import Generic, Protocol, TypeAlias, TypeGuard, TypeVar, final

from liehom.budget import Limits, limits, remaining_limits
from liehom.errors import InputError, WorkerLostError

Task = TypeVar("Task")
Result = TypeVar("Result")


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

RETRIES = 2
"""Default number of times that the task of a lost worker is submitted again."""
# exceptions of dask for dead workers, by name, since dask is not imported here
WORKER_LOSS = ("KilledWorker", "CommClosedError", "SchedulerClosedError", "P2PConsistencyError")


def completed(
    function: Callable[[Task], Result], tasks: Sequence[Task], executor: ExecutorLike = None, *, retries: int = RETRIES
) -> Iterator[tuple[int, Result]]:
    """Iterator of pairs (number of the task, function(task)), in order of completion.

    Parameters
    ----------
    function : callable
        A function of one argument. For other processes it must be picklable, as must tasks and results.
    tasks : sequence
    executor : Executor, callable or None
        An executor is used and left open. A function without parameters that returns an executor is called to make
        one, and again if that one breaks; these executors are shut down at the end. None runs the tasks in the
        calling process, in order.
    retries : int
        How often a task is submitted again after its worker was lost, and how many times in succession an executor
        may break without a finished task in between.

    Raises
    ------
    InputError
        If `executor` is neither an executor nor a function, `retries` is negative, or a task cannot be pickled.
    WorkerLostError
        If workers are lost more often than `retries`, or the executor breaks and no function can make another.

    Notes
    -----
    An exception of `function` is raised immediately, and tasks that have not started are cancelled.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> sorted(completed(abs, [-1, 2, -3], lambda: ThreadPoolExecutor(2)))
    [(0, 1), (1, 2), (2, 3)]
    """
    if isinstance(retries, bool) or not isinstance(retries, int) or retries < 0:
        raise InputError(f"retries is {retries!r}, expected an integer at least 0")
    if executor is None:
        return ((number, function(task)) for number, task in enumerate(tasks))
    return _Run(function, tasks, _Pool(executor), retries).results()


@final
@dataclass(frozen=True, slots=True)
class _Limited(Generic[Task, Result]):
    """A function that runs under given limits, in whatever thread or process."""

    function: Callable[[Task], Result]
    limits: Limits

    def __call__(self, task: Task) -> Result:
        with limits(**asdict(self.limits)):
            return self.function(task)


@final
class _Pool:
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
            return self._executor.submit(_Limited(function, remaining_limits()), task)
        except RuntimeError as error:  # raised also by an executor that was shut down
            if isinstance(error, BrokenExecutor):
                raise
            raise BrokenExecutor(str(error)) from error

    def drop(self) -> None:
        """Shut the current executor down if it was made here."""
        if self.renewable and self._executor is not None:
            self._executor.shutdown(wait=True, cancel_futures=True)
            self._executor = None


@final
class _Run(Generic[Task, Result]):
    """The state of one call of `completed`."""

    def __init__(self, function: Callable[[Task], Result], tasks: Sequence[Task], pool: _Pool, retries: int) -> None:
        self.function, self.tasks, self.pool, self.retries = function, tasks, pool, retries
        self.todo = deque(range(len(tasks)))
        self.waiting: dict[Future[Result], int] = {}
        self.ready: SimpleQueue[Future[Result]] = SimpleQueue()
        self.done, self.breaks = 0, 0
        self.lost: Counter[int] = Counter()

    def results(self) -> Iterator[tuple[int, Result]]:
        """Iterator of (number of the task, result) in order of completion."""
        try:
            while self.todo or self.waiting:
                broken = self._submit()
                for future in self._finished():
                    number = self.waiting.pop(future)
                    error = _error_of(future)
                    if error is None:
                        self.done, self.breaks = self.done + 1, 0
                        yield number, future.result()
                    elif isinstance(error, BrokenExecutor):
                        broken = error
                        self.todo.append(number)
                    elif is_worker_loss(error):
                        self._again(number, error)
                    else:
                        raise _explained(error)
                if broken is not None:
                    self._renew(broken)
        finally:
            for future in self.waiting:
                future.cancel()
            self.pool.drop()

    def _submit(self) -> BaseException | None:
        """Submit all tasks in `todo`; returns the error if the executor is broken, else None."""
        while self.todo:
            try:
                future = self.pool.submit(self.function, self.tasks[self.todo[0]])
            except (BrokenExecutor, ConnectionError) as error:
                return error
            except (TypeError, AttributeError, pickle.PicklingError) as error:
                raise _explained(error) from None
            self.waiting[future] = self.todo.popleft()
            future.add_done_callback(self.ready.put)
        return None

    def _finished(self) -> list[Future[Result]]:
        """The finished futures, at least one if any is waiting; those of dropped executors are ignored."""
        found: list[Future[Result]] = []
        while self.waiting and (not found or not self.ready.empty()):
            future = self.ready.get()
            if future in self.waiting:
                found.append(future)
        return found

    def _again(self, number: int, error: BaseException) -> None:
        """Schedule a task again after its worker was lost; raises `WorkerLostError` after `retries` losses."""
        self.lost[number] += 1
        if self.lost[number] > self.retries:
            raise self._gave_up(error) from error
        self.todo.append(number)

    def _renew(self, error: BaseException) -> None:
        """Drop the broken executor and schedule all unfinished tasks for the next one."""
        self.breaks += 1
        if self.breaks > self.retries or not self.pool.renewable:
            raise self._gave_up(error) from error
        self.todo = deque(sorted([*self.todo, *self.waiting.values()]))
        self.waiting.clear()
        self.pool.drop()

    def _gave_up(self, error: BaseException) -> WorkerLostError:
        """The final error, with the numbers of finished and missing tasks."""
        missing = len(self.tasks) - self.done
        advice = "pass a function that makes an executor, and another is made when one breaks"
        if self.pool.renewable or not isinstance(error, BrokenExecutor):
            advice = "is there enough memory for a task? (a script that starts processes needs __name__ == '__main__')"
        return WorkerLostError(
            self.done,
            missing,
            f"workers were lost ({type(error).__name__}: {error}); {self.done} tasks are done, {missing} are not; "
            f"finished results in a store remain, and the same call continues from them; {advice}",
        )


def _is_executor(source: object) -> TypeGuard[TaskExecutor]:
    """Whether it has the methods of an executor and is not a class of executors."""
    return not isinstance(source, type) and callable(getattr(source, "submit", None))


def is_worker_loss(error: BaseException) -> bool:
    """Whether an exception reports the loss of workers, rather than the failure of a task.

    Examples
    --------
    >>> is_worker_loss(BrokenExecutor("a process was killed")), is_worker_loss(ValueError("psi"))
    (True, False)
    """
    kinds = (BrokenExecutor, CancelledError, ConnectionError)
    return isinstance(error, kinds) or type(error).__name__ in WORKER_LOSS


def _error_of(future: Future[Result]) -> BaseException | None:
    """The exception of a finished future, `CancelledError` included, or None."""
    try:
        return future.exception()
    except CancelledError as error:
        return error


def _explained(error: BaseException) -> BaseException:
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
