"""liehom: Lie algebras, isotropy and fullness, exactly. (Docstring to be completed as the layers land.)"""

from liehom.algebra.constructions import abelian as abelian
from liehom.algebra.constructions import direct_sum as direct_sum
from liehom.algebra.constructions import euclidean as euclidean
from liehom.algebra.constructions import gl as gl
from liehom.algebra.constructions import heisenberg as heisenberg
from liehom.algebra.constructions import semidirect_sum as semidirect_sum
from liehom.algebra.constructions import sl as sl
from liehom.algebra.constructions import so as so
from liehom.algebra.constructions import sp as sp
from liehom.algebra.constructions import su as su
from liehom.algebra.constructions import u as u
from liehom.algebra.homomorphism import Homomorphism as Homomorphism
from liehom.algebra.lie_algebra import LieAlgebra as LieAlgebra
from liehom.algebra.simple import simple as simple
from liehom.algebra.subalgebra import Subalgebra as Subalgebra
from liehom.catalog.pairs import pair as pair
from liehom.catalog.pairs import pair_names as pair_names
from liehom.homogeneous.failure_cone import failure_cone as failure_cone
from liehom.homogeneous.orbit_types import orbit_types as orbit_types
from liehom.homogeneous.range_condition import range_condition as range_condition
from liehom.homogeneous.relative_invariant import relative_invariant as relative_invariant
from liehom.representations.constructions import adjoint as adjoint
from liehom.representations.constructions import coadjoint as coadjoint
from liehom.representations.constructions import defining as defining
from liehom.representations.constructions import sym_conjugation as sym_conjugation
from liehom.representations.constructions import trivial as trivial
from liehom.representations.pair import Pair as Pair
from liehom.representations.representation import Representation as Representation
from liehom.representations.symbolic import symbolic_isotropy as symbolic_isotropy
from liehom.scalars.number_fields import number_field as number_field
from liehom.scalars.rational import QQ as QQ

__version__ = "0.1.0"
