from liehom.exact.orbits.cone import (
    FailureSet as FailureSet,
    RelativeInvariant as RelativeInvariant,
    failure_cone as failure_cone,
    invariant_degree as invariant_degree,
    open_orbit_count as open_orbit_count,
    relative_invariant as relative_invariant,
)
from liehom.exact.orbits.conjugacy import ConjugacyInvariants as ConjugacyInvariants, ConjugacyProof as ConjugacyProof
from liehom.exact.orbits.range import (
    RangeCondition as RangeCondition,
    orbit_dimension as orbit_dimension,
    range_condition as range_condition,
)
from liehom.exact.orbits.strata import (
    Stratum as Stratum,
    adjoint_strata as adjoint_strata,
    binary_form_strata as binary_form_strata,
    hermitian_strata as hermitian_strata,
    rectangular_strata as rectangular_strata,
    skew_strata as skew_strata,
    symmetric_strata as symmetric_strata,
)
from liehom.exact.orbits.types import (
    OrbitType as OrbitType,
    orbit_types as orbit_types,
    structure_name as structure_name,
)
