from liehom.flow.convergence.costs import (
    WorkPrecisionRow as WorkPrecisionRow,
    WorkPrecisionTable as WorkPrecisionTable,
    work_precision as work_precision,
)
from liehom.flow.convergence.orders import ConvergenceTable as ConvergenceTable, observed_order as observed_order
from liehom.flow.convergence.reference import Reference as Reference, orbit_distance as orbit_distance
