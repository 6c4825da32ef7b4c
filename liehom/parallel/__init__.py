"""Many tasks on any executor, and their results on disk; used by ensembles, measured orders and sweeps.

In reading order:

* `executors`: what is called of an executor, and what the loss of a worker looks like.
* `tasks`: results of a function on any executor; tasks of lost workers are submitted again.
* `store`: finished results in a folder or a zarr group, so that no result is computed twice.
* `records`: a store in which millions of small results share files.
"""

from liehom.parallel.executors import ExecutorLike as ExecutorLike
from liehom.parallel.executors import TaskExecutor as TaskExecutor
from liehom.parallel.records import Records as Records
from liehom.parallel.store import Store as Store
from liehom.parallel.store import open_store as open_store
from liehom.parallel.tasks import Dispatcher as Dispatcher
from liehom.parallel.tasks import completed as completed
