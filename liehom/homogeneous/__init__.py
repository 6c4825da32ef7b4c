"""Homogeneous spaces: actions with an exponential, generator fields, orbit types, and the range condition."""

from liehom.homogeneous.exponentials import Cayley as Cayley
from liehom.homogeneous.exponentials import CustomExponential as CustomExponential
from liehom.homogeneous.exponentials import Exponential as Exponential
from liehom.homogeneous.exponentials import MatrixExponential as MatrixExponential
from liehom.homogeneous.exponentials import Rodrigues as Rodrigues
from liehom.homogeneous.exponentials import SeriesExponential as SeriesExponential
from liehom.homogeneous.exponentials import TrueExponential as TrueExponential
from liehom.homogeneous.exponentials import exponential_of as exponential_of
from liehom.homogeneous.fields import GeneratorField as GeneratorField
from liehom.homogeneous.frames import InnerProduct as InnerProduct
from liehom.homogeneous.frames import inner_product as inner_product
from liehom.homogeneous.orbits import OrbitType as OrbitType
from liehom.homogeneous.orbits import Stratum as Stratum
from liehom.homogeneous.orbits import adjoint_strata as adjoint_strata
from liehom.homogeneous.orbits import hermitian_strata as hermitian_strata
from liehom.homogeneous.orbits import orbit_types as orbit_types
from liehom.homogeneous.orbits import structure_name as structure_name
from liehom.homogeneous.orbits import symmetric_strata as symmetric_strata
from liehom.homogeneous.range import FailureSet as FailureSet
from liehom.homogeneous.range import RangeCondition as RangeCondition
from liehom.homogeneous.range import RelativeInvariant as RelativeInvariant
from liehom.homogeneous.range import failure_cone as failure_cone
from liehom.homogeneous.range import range_condition as range_condition
from liehom.homogeneous.range import relative_invariant as relative_invariant
from liehom.homogeneous.space import Action as Action
from liehom.homogeneous.space import IsotropyFrame as IsotropyFrame
