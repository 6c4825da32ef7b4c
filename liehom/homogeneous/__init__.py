"""Homogeneous spaces infinitesimally: orbit types, the range condition and the cone on which it fails."""

from liehom.homogeneous.failure_cone import FailureSet as FailureSet
from liehom.homogeneous.failure_cone import failure_cone as failure_cone
from liehom.homogeneous.orbit_types import OrbitType as OrbitType
from liehom.homogeneous.orbit_types import orbit_types as orbit_types
from liehom.homogeneous.range_condition import RangeCondition as RangeCondition
from liehom.homogeneous.range_condition import range_condition as range_condition
from liehom.homogeneous.relative_invariant import RelativeInvariant as RelativeInvariant
from liehom.homogeneous.relative_invariant import relative_invariant as relative_invariant
