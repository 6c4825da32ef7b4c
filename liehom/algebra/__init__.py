"""Lie algebras by structure constants: the algebra, its subalgebras, and how they are made."""

from liehom.algebra.closure import Closure as Closure
from liehom.algebra.closure import lie_closure as lie_closure
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
from liehom.algebra.dynkin import cartan_matrix as cartan_matrix
from liehom.algebra.dynkin import dynkin_diagram as dynkin_diagram
from liehom.algebra.homomorphism import Homomorphism as Homomorphism
from liehom.algebra.lie_algebra import LieAlgebra as LieAlgebra
from liehom.algebra.root_system import RootSystem as RootSystem
from liehom.algebra.root_system import root_system as root_system
from liehom.algebra.simple import simple as simple
from liehom.algebra.structure_constants import StructureConstants as StructureConstants
from liehom.algebra.subalgebra import Subalgebra as Subalgebra
