"""Results of many tasks on any executor, in order of completion."""

from __future__ import annotations

import math
import pickle
import secrets
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future
from dataclasses import asdict, dataclass
from operator import itemgetter
from queue import SimpleQueue
from typing import Any, Generic, Protocol, TypeAlias, TypeGuard, TypeVar, final

from liehom.base.budget import Limits, limits, remaining_limits
from liehom.base.errors import InputError, WorkerLostError

# Executors: what is called of them, another one in place of a broken one, and what their errors say.
#
# Only the methods `submit` and `shutdown` of an executor are called. It may be a pool of processes or threads, the
# executor of a dask client, or an executor of mpi4py.

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
            executor = self._make()
            if not callable(getattr(executor, "submit", None)):
                raise InputError(f"the function that makes executors returned {executor!r}")
            self._executor = executor
        if self._executor is None:
            raise BrokenExecutor("there is no executor")
        _check_fork(self._executor)
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
    """Whether an exception reports the loss of workers, rather than the failure of a task."""
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
    readable = InputError(
        f"a task cannot be sent to another process: {message}; give functions that have a name in a module (no lambda, "
        "no function within a function), psi as a list of strings such as ['m0', 'sin(t)'], or use an executor that "
        "pickles tasks by cloudpickle (dask), or threads"
    )
    readable.__cause__ = error
    return readable


def _is_executor(source: object) -> TypeGuard[TaskExecutor]:
    """Whether it has the methods of an executor and is not a class of executors."""
    return not isinstance(source, type) and callable(getattr(source, "submit", None))


def _check_fork(executor: TaskExecutor) -> None:
    """Raise `InputError` if an executor is about to fork this process, in which JAX has threads that hold locks."""
    begun, context = getattr(executor, "_processes", None), getattr(executor, "_mp_context", None)
    jax = getattr(sys.modules.get("jax._src.xla_bridge"), "_backends", None)
    if jax and context is not None and not begun and context.get_start_method() == "fork":
        raise InputError(
            "the executor forks this process, in which JAX has started threads, and its workers may wait for ever: "
            "ProcessPoolExecutor(mp_context=multiprocessing.get_context('spawn'))"
        )


# Results of many tasks on any `concurrent.futures.Executor`, in order of completion.
#
# The result of a task depends on its argument alone, so results do not depend on the executor. Tasks of lost workers
# are submitted again. A bounded number of tasks is in flight, so tasks may come from a generator that is longer than
# the memory. Small tasks travel in batches, since a submission takes about a millisecond of the caller.

Label = TypeVar("Label", bound=int | tuple[Any, ...])


RETRIES = 2  # Default number of times that the task of a lost worker is submitted again
# Default number of tasks in flight: enough for hundreds of workers, and a few megabytes of small tasks
BUFFERSIZE = 4096
# Processor time after which a worker returns the rest of a batch; a submission costs some thousandths of it
BATCH_SECONDS = 1.0
PATIENCE = 0.1  # Seconds after which an incomplete batch is sent and results that are ready are taken
FIRST_BATCHES = 256  # Number of batches of one task, while it is not known what a task takes
LARGEST_BATCH = 64  # Largest batch, so that the tasks in flight are at least 64 batches


def completed(
    function: Callable[[Task], Result],
    tasks: Iterable[Task],
    executor: ExecutorLike = None,
    *,
    retries: int = RETRIES,
    buffersize: int = BUFFERSIZE,
) -> Iterator[tuple[int, Result]]:
    """Iterator of pairs (number of the task, function(task)), in order of completion.

    Parameters
    ----------
    function : callable
        A function of one argument. For other processes it must be picklable, as must tasks and results.
    tasks : iterable
        Taken one at a time, as earlier tasks finish.
    executor : Executor, callable or None
        An executor is used and left open. A function without parameters that returns an executor is called to make
        one, and again if that one breaks; these executors are shut down at the end. None runs the tasks in the
        calling process, in order.
    retries : int
        How often a task is submitted again after its worker was lost, and how many times in succession an executor
        may break without a finished task in between.
    buffersize : int
        Largest number of tasks that are submitted and whose results are not yet returned.

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
    check_count("buffersize", buffersize, 1)
    dispatcher = Dispatcher[int, Task, Result](function, executor, retries=retries, chunksize=1)

    def results() -> Iterator[tuple[int, Result]]:
        with dispatcher:
            for number, task in enumerate(tasks):
                dispatcher.submit(number, task)
                while dispatcher.due or len(dispatcher) >= buffersize:
                    for batch in dispatcher.arrived():
                        yield from batch
            while len(dispatcher):
                for batch in dispatcher.arrived():
                    yield from batch

    return results()


def check_count(name: str, value: object, least: int) -> None:
    """Raise `InputError` if an argument is not an integer from `least`."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise InputError(f"{name} is {value!r}, expected an integer at least {least}")


@final
@dataclass(frozen=True, slots=True)
class _Batch(Generic[Task, Result]):
    """Tasks for one worker, under limits; after `seconds` it returns the results it has, at least one."""

    function: Callable[[Task], Result]
    tasks: Sequence[Task]
    limits: Limits
    seconds: float

    def results(self) -> tuple[list[Result], float]:
        """The results, and the processor time that they took."""
        begin, elapsed = time.thread_time(), 0.0
        results: list[Result] = []
        with limits(**asdict(self.limits)):
            for task in self.tasks:
                results.append(self.function(task))
                elapsed = time.thread_time() - begin
                if elapsed > self.seconds:
                    break
        return results, elapsed

    def __dask_tokenize__(self) -> str:  # dask would pickle each task thrice for the name of the batch
        return secrets.token_hex(16)


@final
class Dispatcher(Generic[Label, Task, Result]):
    """Tasks in flight on an executor, sent in batches; a context manager that cancels what is left at its end.

    Parameters
    ----------
    function, executor, retries
        As for `completed`.
    chunksize : int, optional
        Number of tasks in a batch. By default as many as take about half a second of processor time, at most 64, and a
        worker that has used a second returns the rest of its batch.

    Notes
    -----
    Labels are numbers, or tuples that begin with one; tasks are submitted again in the order of their labels. A task
    whose worker was lost is submitted again in a batch of its own.

    Examples
    --------
    >>> with Dispatcher(abs, None) as dispatcher:
    ...     dispatcher.submit(0, -5)
    ...     len(dispatcher), list(dispatcher.arrived()), len(dispatcher)
    (1, [[(0, 5)]], 0)
    """

    def __init__(
        self,
        function: Callable[[Task], Result],
        executor: ExecutorLike,
        *,
        retries: int = RETRIES,
        chunksize: int | None = None,
    ) -> None:
        check_count("retries", retries, 0)
        if chunksize is not None:
            check_count("chunksize", chunksize, 1)
        self._function, self._retries = function, retries
        self._pool = None if executor is None else Pool(executor)
        self._chunksize = chunksize
        self._pace: float | None = None  # seconds that a task takes, the mean of the last ones
        self._unsent: deque[tuple[Label, Task]] = deque()
        self._waiting: dict[Future[tuple[list[Result], float]], list[tuple[Label, Task]]] = {}
        self._ready: SimpleQueue[Future[tuple[list[Result], float]]] = SimpleQueue()
        self._done, self._open, self._breaks = 0, 0, 0
        self._credit = 0  # tasks that may be submitted before results that are ready are taken
        self._since = self._took = time.monotonic()  # when the first unsent task came, and the last result
        self._losses: dict[Label, int] = {}  # of unfinished tasks
        self._broken: BaseException | None = None

    def __len__(self) -> int:
        """The number of tasks that were submitted and whose results have not been returned."""
        return self._open

    def __enter__(self) -> Dispatcher[Label, Task, Result]:
        return self

    def __exit__(self, *error: object) -> None:
        for future in self._waiting:
            future.cancel()
        if self._pool is not None:
            self._pool.drop()

    def submit(self, label: Label, task: Task) -> None:
        """Submit a task, or keep it until its batch is complete or results are asked for."""
        if not self._unsent:
            self._since = time.monotonic()
        self._unsent.append((label, task))
        self._open += 1
        self._credit -= 1
        if self._pool is not None:
            self._send_batches(self._pool, PATIENCE)

    @property
    def due(self) -> bool:
        """Whether results should be taken now; between them, twice as many tasks are submitted as have finished."""
        if self._pool is None:
            return bool(self._unsent)
        is_late = time.monotonic() - self._took > PATIENCE
        return self._broken is not None or (not self._ready.empty() and (is_late or self._credit <= 0))

    def arrived(self) -> Iterator[list[tuple[Label, Result]]]:
        """Iterator of finished batches, as lists of (label, result); it waits for the first one.

        Raises
        ------
        WorkerLostError
            If workers are lost more often than `retries`, or the executor breaks and no function can make another.
        """
        if self._pool is None:
            while self._unsent:
                label, task = self._unsent.popleft()
                self._open -= 1
                yield [(label, self._function(task))]
            return
        self._send_batches(self._pool, PATIENCE if self._waiting else 0.0)
        for future in self._arrived():
            batch = self._waiting.pop(future)
            error = error_of(future)
            if error is None:
                yield self._taken(batch, *future.result())
            elif isinstance(error, BrokenExecutor):
                self._broken = error
                self._unsent.extend(batch)
            elif is_worker_loss(error):
                self._again(batch, error)
            else:
                raise explained(error)
        if self._broken is not None:
            self._renew(self._pool, self._broken)

    def finished(self) -> Iterator[list[tuple[Label, Result]]]:
        """Iterator of the batches that have finished, without waiting and without errors, for the end of a run."""
        while not self._ready.empty():
            future = self._ready.get()
            if future in self._waiting and error_of(future) is None:
                yield self._taken(self._waiting.pop(future), *future.result())

    def _send_batches(self, pool: Pool, patience: float) -> None:
        """Submit complete batches, and an incomplete one if it has waited for `patience` seconds."""
        while self._unsent and self._broken is None:
            if len(self._unsent) < self._size() and time.monotonic() - self._since < patience:
                return
            self._send(pool)

    def _size(self) -> int:
        """Number of tasks in the next batch."""
        if self._chunksize is not None:
            return self._chunksize
        if self._pace is None:  # nothing has finished: one task for each worker, and more if there are many tasks
            return 1 if len(self._waiting) < FIRST_BATCHES else LARGEST_BATCH // 8
        return max(1, min(LARGEST_BATCH, int(BATCH_SECONDS / (2 * self._pace + 1e-9))))

    def _send(self, pool: Pool) -> None:
        """Submit one batch; a broken executor is remembered."""
        size = 1 if self._unsent[0][0] in self._losses else self._size()
        batch = [self._unsent.popleft() for _ in range(min(size, len(self._unsent)))]
        seconds = BATCH_SECONDS if self._chunksize is None else math.inf
        tasks = _Batch(self._function, [task for _, task in batch], remaining_limits(), seconds)
        try:
            future = pool.submit(_Batch.results, tasks)
        except (BrokenExecutor, ConnectionError) as error:
            self._unsent.extendleft(reversed(batch))
            self._broken = error
            return
        except (TypeError, AttributeError, pickle.PicklingError) as error:
            raise explained(error) from None
        self._waiting[future] = batch
        future.add_done_callback(self._ready.put)

    def _arrived(self) -> list[Future[tuple[list[Result], float]]]:
        """The finished futures, at least one if any is waiting; those of dropped executors are ignored."""
        arrived: list[Future[tuple[list[Result], float]]] = []
        while self._waiting and (not arrived or not self._ready.empty()):
            future = self._ready.get()
            if future in self._waiting:
                arrived.append(future)
        return arrived

    def _taken(
        self, batch: list[tuple[Label, Task]], results: list[Result], seconds: float
    ) -> list[tuple[Label, Result]]:
        """The results of a batch with their labels; tasks for which there was no time are scheduled again."""
        self._unsent.extendleft(reversed(batch[len(results) :]))
        if self._chunksize is None:
            pace = seconds / len(results)
            self._pace = pace if self._pace is None else 0.9 * self._pace + 0.1 * pace
        taken = [(label, result) for (label, _), result in zip(batch, results, strict=False)]
        for label, _ in taken:
            self._losses.pop(label, None)
        self._breaks, self._credit, self._took = 0, 2 * len(taken), time.monotonic()
        self._open, self._done = self._open - len(taken), self._done + len(taken)
        return taken

    def _again(self, batch: list[tuple[Label, Task]], error: BaseException) -> None:
        """Schedule a batch again after its worker was lost; raises `WorkerLostError` after `retries` losses."""
        self._unsent.extendleft(reversed(batch))
        for label, _ in batch:
            self._losses[label] = self._losses.get(label, 0) + 1
            if self._losses[label] > self._retries:
                raise self._gave_up(error) from error

    def _renew(self, pool: Pool, error: BaseException) -> None:
        """Drop the broken executor and schedule all unfinished tasks for the next one."""
        self._breaks += 1
        if self._breaks > self._retries or not pool.renewable:
            raise self._gave_up(error) from error
        self._unsent.extend(item for batch in self._waiting.values() for item in batch)
        self._unsent = deque(sorted(self._unsent, key=itemgetter(0)))
        self._losses.update({label: self._losses.get(label, 0) for label, _ in self._unsent})
        self._waiting.clear()
        self._broken = None
        pool.drop()

    def _gave_up(self, error: BaseException) -> WorkerLostError:
        """The final error, with the numbers of finished and missing tasks."""
        advice = (
            "is there enough memory for a task? (a script that starts processes needs __name__ == '__main__')"
            if self._pool is None or self._pool.renewable or not isinstance(error, BrokenExecutor)
            else "pass a function that makes an executor, and another is made when one breaks"
        )
        return WorkerLostError(
            self._done,
            self._open,
            f"workers were lost ({type(error).__name__}: {error}); {self._done} tasks are done, {self._open} are not; "
            f"finished results in a store remain, and the same call continues from them; {advice}",
        )
