"""One call of `integrate` on its way: the loop over steps, sizes, events, dense output, checkpoints, results.

`run` is the loop, `state` what a checkpoint keeps of it, `records` and `path` what it collects, `solution` what the
user gets. Used by `liehom.integrators.integration` and by the compiled runs; see docs/tutorials/integrating.md.
"""

from liehom.integrators.run.conservation_statistics import ConservationReport as ConservationReport
from liehom.integrators.run.dense import DenseSolution as DenseSolution
from liehom.integrators.run.solution import Report as Report
from liehom.integrators.run.solution import Solution as Solution
