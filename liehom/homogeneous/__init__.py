"""Homogeneous spaces: actions and generator fields; orbit types, the range condition and the cone on which it fails."""

from liehom.homogeneous.cayley import Cayley as Cayley
from liehom.homogeneous.exponential import Exponential as Exponential
from liehom.homogeneous.exponential import MatrixExponential as MatrixExponential
from liehom.homogeneous.exponential import SeriesExponential as SeriesExponential
from liehom.homogeneous.exponential import TrueExponential as TrueExponential
from liehom.homogeneous.failure_cone import FailureSet as FailureSet
from liehom.homogeneous.failure_cone import failure_cone as failure_cone
from liehom.homogeneous.field import GeneratorField as GeneratorField
from liehom.homogeneous.inner_product import InnerProduct as InnerProduct
from liehom.homogeneous.inner_product import inner_product as inner_product
from liehom.homogeneous.orbit_types import OrbitType as OrbitType
from liehom.homogeneous.orbit_types import orbit_types as orbit_types
from liehom.homogeneous.own_exponential import OwnExponential as OwnExponential
from liehom.homogeneous.own_exponential import exponential_of as exponential_of
from liehom.homogeneous.range_condition import RangeCondition as RangeCondition
from liehom.homogeneous.range_condition import range_condition as range_condition
from liehom.homogeneous.relative_invariant import RelativeInvariant as RelativeInvariant
from liehom.homogeneous.relative_invariant import relative_invariant as relative_invariant
from liehom.homogeneous.rodrigues import Rodrigues as Rodrigues
from liehom.homogeneous.space import Action as Action
from liehom.homogeneous.space import IsotropyFrame as IsotropyFrame
from liehom.homogeneous.strata import Stratum as Stratum
from liehom.homogeneous.strata import adjoint_strata as adjoint_strata
from liehom.homogeneous.strata import hermitian_strata as hermitian_strata
from liehom.homogeneous.strata import symmetric_strata as symmetric_strata
from liehom.homogeneous.structure_name import structure_name as structure_name
