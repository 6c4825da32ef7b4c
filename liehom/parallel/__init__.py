"""Many tasks on any executor, and their results on disk; used by ensembles, measured orders and sweeps.

In reading order: `tasks` (results of a function on any `concurrent.futures.Executor`; tasks of lost workers are
submitted again), `store` (finished results in a folder or a zarr group, so that no result is computed twice),
`records` (a store in which millions of small results share files).
"""

from liehom.parallel.records import Records as Records
from liehom.parallel.store import Store as Store
from liehom.parallel.store import open_store as open_store
from liehom.parallel.tasks import Dispatcher as Dispatcher
from liehom.parallel.tasks import ExecutorLike as ExecutorLike
from liehom.parallel.tasks import TaskExecutor as TaskExecutor
from liehom.parallel.tasks import completed as completed
