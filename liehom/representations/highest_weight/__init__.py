"""Irreducible modules by their highest weight: characters, integer matrices, real forms, spinors.

Weights are in fundamental coordinates. Users call `liehom.highest_weight_module`, `real_module` and
`spin_representation`; see docs/theory/representations.md.
"""

from liehom.representations.highest_weight.admissible_lattice import AdmissibleLattice as AdmissibleLattice
from liehom.representations.highest_weight.admissible_lattice import admissible_lattice as admissible_lattice
from liehom.representations.highest_weight.characters import character as character
from liehom.representations.highest_weight.characters import decompose_character as decompose_character
from liehom.representations.highest_weight.characters import dominant_character as dominant_character
from liehom.representations.highest_weight.characters import (
    tensor_product_decomposition as tensor_product_decomposition,
)
from liehom.representations.highest_weight.characters import weyl_dimension as weyl_dimension
from liehom.representations.highest_weight.highest_weight import HighestWeightModule as HighestWeightModule
from liehom.representations.highest_weight.highest_weight import highest_weight_module as highest_weight_module
from liehom.representations.highest_weight.real_form_module import RealModule as RealModule
from liehom.representations.highest_weight.real_form_module import real_module as real_module
from liehom.representations.highest_weight.real_form_module import real_module_type as real_module_type
from liehom.representations.highest_weight.spin import SpinorType as SpinorType
from liehom.representations.highest_weight.spin import spin_representation as spin_representation
from liehom.representations.highest_weight.spin import spinor_type as spinor_type
from liehom.representations.highest_weight.weights import dual_weight as dual_weight
from liehom.representations.highest_weight.weights import frobenius_schur_indicator as frobenius_schur_indicator
from liehom.representations.highest_weight.weights import weyl_orbit as weyl_orbit
