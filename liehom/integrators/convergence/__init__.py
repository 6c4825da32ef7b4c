"""Measured orders: errors against a reference solution, on trajectories and on orbits.

Users call `liehom.observed_order`. `Reference` is a solution to round-off by Taylor series, with which methods are
compared. See docs/tutorials/integrating.md.
"""

from liehom.integrators.convergence.convergence_table import ConvergenceTable as ConvergenceTable
from liehom.integrators.convergence.observed_order import observed_order as observed_order
from liehom.integrators.convergence.orbit_error import orbit_distance as orbit_distance
from liehom.integrators.convergence.reference import Reference as Reference
