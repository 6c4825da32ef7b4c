"""The range condition (6.1)-(6.3) at a generator, generically, and the cone on which it fails.

Fullness uses `failure_cone` and `relative_invariant`. The atlas uses `orbit_dimension`, `invariant_degree` and
`open_orbit_count`. Integrators use `batched_ranks` along a path. See
docs/theory/fullness.md.
"""

from liehom.homogeneous.range.failure_cone import FailureSet as FailureSet
from liehom.homogeneous.range.failure_cone import failure_cone as failure_cone
from liehom.homogeneous.range.invariant_degree import invariant_degree as invariant_degree
from liehom.homogeneous.range.open_orbits import open_orbit_count as open_orbit_count
from liehom.homogeneous.range.range_condition import RangeCondition as RangeCondition
from liehom.homogeneous.range.range_condition import orbit_dimension as orbit_dimension
from liehom.homogeneous.range.range_condition import range_condition as range_condition
from liehom.homogeneous.range.relative_invariant import RelativeInvariant as RelativeInvariant
from liehom.homogeneous.range.relative_invariant import relative_invariant as relative_invariant
