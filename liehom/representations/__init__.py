"""Representations by matrices, pairs (g, h), and the isotropy of a point."""

from liehom.representations.constructions import adjoint as adjoint
from liehom.representations.constructions import coadjoint as coadjoint
from liehom.representations.constructions import defining as defining
from liehom.representations.constructions import sym_conjugation as sym_conjugation
from liehom.representations.constructions import symmetric_to_vector as symmetric_to_vector
from liehom.representations.constructions import trivial as trivial
from liehom.representations.constructions import vector_to_symmetric as vector_to_symmetric
from liehom.representations.pair import Pair as Pair
from liehom.representations.representation import Representation as Representation
from liehom.representations.symbolic import SymbolicIsotropy as SymbolicIsotropy
from liehom.representations.symbolic import symbolic_isotropy as symbolic_isotropy
