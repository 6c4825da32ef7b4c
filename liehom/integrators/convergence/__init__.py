"""Measured orders, work and precision: errors against a reference solution, on trajectories and on orbits.

Users call `liehom.observed_order` and `liehom.work_precision`. `Reference` is a solution to round-off by Taylor series,
with which methods are compared. See docs/tutorials/integrating.md and docs/which-step.md.
"""

from liehom.integrators.convergence.convergence_table import ConvergenceTable as ConvergenceTable
from liehom.integrators.convergence.observed_order import observed_order as observed_order
from liehom.integrators.convergence.orbit_error import orbit_distance as orbit_distance
from liehom.integrators.convergence.reference import Reference as Reference
from liehom.integrators.convergence.work_precision import work_precision as work_precision
from liehom.integrators.convergence.work_precision_table import WorkPrecisionRow as WorkPrecisionRow
from liehom.integrators.convergence.work_precision_table import WorkPrecisionTable as WorkPrecisionTable
