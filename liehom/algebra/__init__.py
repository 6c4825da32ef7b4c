"""Lie algebras by structure constants: the algebra, its subalgebras, and how they are made."""

from liehom.algebra.closure import Closure as Closure
from liehom.algebra.closure import lie_closure as lie_closure
from liehom.algebra.lie_algebra import LieAlgebra as LieAlgebra
from liehom.algebra.structure_constants import StructureConstants as StructureConstants
from liehom.algebra.subalgebra import Subalgebra as Subalgebra
