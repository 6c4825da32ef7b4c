"""The loop behind `integrate`: steps and their sizes, events, dense output, checkpoints and the result.

`run` is the loop, `state` the part of it that changes from step to step and is saved in checkpoints, `records` the
path, samples, events and statistics, `solution` the object that users get. `liehom.integrators.engine`
and compiled runs use it; see docs/tutorials/integrating.md.
"""

from liehom.integrators.run.dense import DenseSolution as DenseSolution
from liehom.integrators.run.solution import ConservationReport as ConservationReport
from liehom.integrators.run.solution import Report as Report
from liehom.integrators.run.solution import Solution as Solution
