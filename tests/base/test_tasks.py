"""Tasks on executors of every kind; workers that are killed, errors of tasks, what cannot be pickled."""

import multiprocessing
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from liehom.base.errors import DependentRowsError, InputError, WorkerLostError
from liehom.base.tasks import Dispatcher, completed
from tests.base import work


def processes() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def threads() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(2)


class Immediate(Executor):
    """Runs tasks as they are submitted; `moods` are errors of the next futures, None for none."""

    def __init__(self, *moods: BaseException | None) -> None:
        self.moods, self.calls, self.ended = list(moods), 0, False

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.calls += 1
        future: Future[Any] = Future()
        error = self.moods.pop(0) if self.moods else None
        try:
            if error is not None:
                raise error
            future.set_result(function(*args))
        except Exception as caught:  # noqa: BLE001 - as executors do
            future.set_exception(caught)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self.ended = True


class KilledWorker(Exception):
    """As dask's is called."""


def test_results_without_executor_are_in_order() -> None:
    assert list(completed(work.square, [3, 1, 2])) == [(0, 9), (1, 1), (2, 4)]


def test_empty_list_of_tasks_has_no_results() -> None:
    assert list(completed(work.square, [], threads)) == []


def test_an_executor_is_used_and_left_open() -> None:
    pool = Immediate()
    assert sorted(completed(work.square, range(4), pool)) == [(0, 0), (1, 1), (2, 4), (3, 9)]
    assert (pool.calls, pool.ended) == (4, False)


def test_executor_class_is_a_function_that_makes_executors() -> None:
    assert sorted(completed(work.square, [2, 3], Immediate)) == [(0, 4), (1, 9)]


def test_executor_made_by_the_function_is_shut_down() -> None:
    made: list[Immediate] = []

    def make() -> Immediate:
        made.append(Immediate())
        return made[-1]

    assert len(list(completed(work.square, range(4), make))) == 4
    assert [pool.ended for pool in made] == [True]


def test_processes_and_a_killed_one(tmp_path: Path) -> None:
    tasks = [(str(tmp_path), x) for x in range(5)]
    assert sorted(completed(work.kills_its_worker_once, tasks, processes)) == [(x, x) for x in range(5)]
    assert (tmp_path / "killed").exists()


def test_a_process_that_is_killed_again_and_again() -> None:
    with pytest.raises(WorkerLostError, match="0 tasks are done, 2 are not") as caught:
        list(completed(work.kills_its_worker, [0, 1], processes, retries=1))
    assert (caught.value.done, caught.value.missing) == (0, 2)
    assert isinstance(caught.value.__cause__, BrokenExecutor)


def test_an_executor_that_breaks_and_cannot_be_made_again() -> None:
    pool = Immediate(None, BrokenExecutor("gone"))
    with pytest.raises(WorkerLostError, match="pass a function that makes an executor") as caught:
        list(completed(work.square, range(3), pool))
    assert caught.value.done == 2


@pytest.mark.parametrize("loss", [KilledWorker("a task"), CancelledError(), ConnectionError("lost")], ids=repr)
def test_a_lost_task_is_submitted_again(loss: BaseException) -> None:
    pool = Immediate(None, loss)
    assert sorted(completed(work.square, range(3), pool)) == [(0, 0), (1, 1), (2, 4)]
    assert pool.calls == 4


def test_a_task_that_is_lost_too_often() -> None:
    pool = Immediate(*[KilledWorker("again")] * 3)
    with pytest.raises(WorkerLostError):
        list(completed(work.square, [5], pool, retries=2))
    assert pool.calls == 3


def test_count_of_breaks_restarts_after_progress() -> None:
    moods = [[None, BrokenExecutor("a")]] * 4  # each executor does one task and breaks
    made = iter([Immediate(*mood) for mood in moods] + [Immediate()])
    assert len(list(completed(work.square, range(6), lambda: next(made), retries=1))) == 6


@pytest.mark.parametrize("executor", [None, threads, processes], ids=["none", "threads", "processes"])
def test_exception_of_a_task_is_raised(executor: Any) -> None:
    with pytest.raises(DependentRowsError) as caught:
        list(completed(work.fails_at_three, range(5), executor))
    assert caught.value.dependent == [3]


def test_task_that_cannot_be_pickled_raises_input_error() -> None:
    with pytest.raises(InputError, match="no lambda"):
        list(completed(lambda x: x, [1], processes))


@pytest.mark.parametrize("executor", [3, "dask", [1]])
def test_invalid_executor_raises_input_error(executor: Any) -> None:
    with pytest.raises(InputError, match=r"expected a concurrent.futures.Executor"):
        list(completed(work.square, [1], executor))


@pytest.mark.parametrize("retries", [-1, 1.5, True])
def test_invalid_retries_raise_input_error(retries: Any) -> None:
    with pytest.raises(InputError, match="retries"):
        list(completed(work.square, [1], retries=retries))


# -- many tasks ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("executor", [None, threads, Immediate], ids=["none", "threads", "immediate"])
def test_tasks_are_taken_one_at_a_time_and_at_most_buffersize_are_in_flight(executor: Any) -> None:
    taken, returned, ahead = [], [], []

    def tasks() -> Iterator[int]:
        for x in range(300):
            taken.append(x)
            ahead.append(len(taken) - len(returned))
            yield x

    for number, square in completed(work.square, tasks(), executor, buffersize=10):
        assert square == number**2
        returned.append(number)
    assert sorted(returned) == list(range(300)) and max(ahead) <= 11


def dispatched(dispatcher: Dispatcher[int, Any, Any], tasks: Iterable[Any]) -> list[tuple[int, Any]]:
    with dispatcher:
        for number, task in enumerate(tasks):
            dispatcher.submit(number, task)
        found = []
        while len(dispatcher):
            found += [item for batch in dispatcher.arrived() for item in batch]
    return found


@pytest.mark.parametrize("chunksize", [None, 1, 7, 1000])
def test_batches_of_any_size_give_every_result(chunksize: int | None) -> None:
    for executor in (None, threads, Immediate):
        made = Dispatcher[int, int, int](work.square, executor, chunksize=chunksize)
        assert sorted(dispatched(made, range(500))) == [(x, x * x) for x in range(500)]


def test_batches_of_small_tasks_grow() -> None:
    pool = Immediate()
    assert len(list(completed(work.square, range(1000), pool))) == pool.calls == 1000
    pool = Immediate()
    with Dispatcher[int, int, int](work.square, pool) as dispatcher:
        count = 0
        for number in range(1000):
            dispatcher.submit(number, number)
            while dispatcher.due:
                count += sum(map(len, dispatcher.arrived()))
        while len(dispatcher):
            count += sum(map(len, dispatcher.arrived()))
    assert count == 1000 and pool.calls < 100


def test_the_first_tasks_go_alone_and_those_of_a_long_queue_do_not() -> None:
    sizes: list[int] = []

    class Waiting(Immediate):
        def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            sizes.append(len(args[0].tasks))
            return Future()

    with Dispatcher[int, int, int](work.square, Waiting()) as dispatcher:
        for number in range(1056):
            dispatcher.submit(number, number)
    assert sizes == [1] * 256 + [8] * 100


def test_a_worker_returns_what_it_has_no_time_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("liehom.base.tasks.BATCH_SECONDS", 0.0)
    pool = Immediate()
    made = Dispatcher[int, int, int](work.square, pool)
    monkeypatch.setattr(made, "_size", lambda: 8)  # as after small tasks
    assert sorted(dispatched(made, range(32))) == [(x, x * x) for x in range(32)]
    assert pool.calls == 32


def test_a_task_whose_worker_was_lost_goes_alone() -> None:
    sizes: list[int] = []

    class Recording(Immediate):
        def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            sizes.append(len(args[0].tasks))
            return super().submit(function, *args, **kwargs)

    made = Dispatcher[int, int, int](work.square, Recording(KilledWorker("a batch")), chunksize=4)
    assert sorted(dispatched(made, range(8))) == [(x, x * x) for x in range(8)]
    assert sizes == [4, 4, 1, 1, 1, 1]


def test_a_killed_process_takes_nothing_from_its_batch(tmp_path: Path) -> None:
    made = Dispatcher[int, tuple[str, int], int](work.kills_its_worker_once, processes, chunksize=3)
    assert sorted(dispatched(made, [(str(tmp_path), x) for x in range(8)])) == [(x, x) for x in range(8)]
    assert (tmp_path / "killed").exists()


def test_a_pool_that_would_fork_a_process_with_jax_is_refused() -> None:
    jax = pytest.importorskip("jax")
    jax.numpy.zeros(3).block_until_ready()  # starts its threads
    fork = partial(ProcessPoolExecutor, 1, mp_context=multiprocessing.get_context("fork"))
    with fork() as pool:
        for executor in (pool, fork):
            with pytest.raises(InputError, match="get_context\\('spawn'\\)"):
                list(completed(abs, [-1], executor))
    with processes() as pool:
        assert list(completed(abs, [-1], pool)) == [(0, 1)]
