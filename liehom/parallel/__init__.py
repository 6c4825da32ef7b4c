"""Work that is spread over executors and kept on disk: what ensembles, measured orders and sweeps share.

In reading order: `tasks` (a function of many tasks on any `concurrent.futures.Executor`, loss of workers survived),
`store` (results as they come, in a folder or a zarr group, so that nothing finished is done again).
"""

from liehom.parallel.store import Store as Store
from liehom.parallel.store import open_store as open_store
from liehom.parallel.tasks import ExecutorLike as ExecutorLike
from liehom.parallel.tasks import TaskExecutor as TaskExecutor
from liehom.parallel.tasks import completed as completed
