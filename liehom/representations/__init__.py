"""Representations by matrices, pairs (g, h), and the isotropy of a point."""

from liehom.representations.admissible_lattice import AdmissibleLattice as AdmissibleLattice
from liehom.representations.admissible_lattice import admissible_lattice as admissible_lattice
from liehom.representations.characters import character as character
from liehom.representations.characters import decompose_character as decompose_character
from liehom.representations.characters import dominant_character as dominant_character
from liehom.representations.characters import tensor_product_decomposition as tensor_product_decomposition
from liehom.representations.characters import weyl_dimension as weyl_dimension
from liehom.representations.constructions import adjoint as adjoint
from liehom.representations.constructions import coadjoint as coadjoint
from liehom.representations.constructions import defining as defining
from liehom.representations.constructions import sym_conjugation as sym_conjugation
from liehom.representations.constructions import symmetric_to_vector as symmetric_to_vector
from liehom.representations.constructions import trivial as trivial
from liehom.representations.constructions import vector_to_symmetric as vector_to_symmetric
from liehom.representations.highest_weight import HighestWeightModule as HighestWeightModule
from liehom.representations.highest_weight import highest_weight_module as highest_weight_module
from liehom.representations.pair import Pair as Pair
from liehom.representations.representation import Representation as Representation
from liehom.representations.spin import SpinorType as SpinorType
from liehom.representations.spin import spin_representation as spin_representation
from liehom.representations.spin import spinor_type as spinor_type
from liehom.representations.symbolic import SymbolicIsotropy as SymbolicIsotropy
from liehom.representations.symbolic import symbolic_isotropy as symbolic_isotropy
from liehom.representations.weights import dual_weight as dual_weight
from liehom.representations.weights import frobenius_schur_indicator as frobenius_schur_indicator
from liehom.representations.weights import weyl_orbit as weyl_orbit
