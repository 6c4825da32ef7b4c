from liehom.exact.geometry.einstein import EinsteinMetric as EinsteinMetric, EinsteinMetrics as EinsteinMetrics
from liehom.exact.geometry.forms import (
    InvariantConnection as InvariantConnection,
    InvariantConnections as InvariantConnections,
    InvariantDifferentialForms as InvariantDifferentialForms,
    InvariantSymplecticForms as InvariantSymplecticForms,
)
from liehom.exact.geometry.metrics import InvariantMetric as InvariantMetric, InvariantMetrics as InvariantMetrics
