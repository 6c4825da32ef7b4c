from liehom.exact.representations.analysis.branching import (
    Branching as Branching,
    BranchingRule as BranchingRule,
    BranchingTerm as BranchingTerm,
    module_name as module_name,
)
from liehom.exact.representations.analysis.decomposition import (
    Component as Component,
    Decomposition as Decomposition,
    HermitianForms as HermitianForms,
    IsotypicComponent as IsotypicComponent,
)
from liehom.exact.representations.analysis.embeddings import (
    branching_rule as branching_rule,
    maximal_subalgebras as maximal_subalgebras,
)
from liehom.exact.representations.analysis.polynomial_invariants import HilbertSeries as HilbertSeries
from liehom.exact.representations.analysis.submodules import MaximalSubmodules as MaximalSubmodules
from liehom.exact.representations.analysis.symbolic import SymbolicIsotropy as SymbolicIsotropy
from liehom.exact.representations.analysis.weight_multiplicities import Charge as Charge, ChargedWeight as ChargedWeight
from liehom.exact.representations.constructions import (
    adjoint as adjoint,
    coadjoint as coadjoint,
    defining as defining,
    hermitian_conjugation as hermitian_conjugation,
    pair_from_matrices as pair_from_matrices,
    sym_conjugation as sym_conjugation,
    symmetric_to_vector as symmetric_to_vector,
    trivial as trivial,
    vector_to_symmetric as vector_to_symmetric,
)
from liehom.exact.representations.core.pair import Pair as Pair
from liehom.exact.representations.core.representation import Representation as Representation
from liehom.exact.representations.highest_weight.characters import (
    character as character,
    decompose_character as decompose_character,
    dominant_character as dominant_character,
    exterior_power_decomposition as exterior_power_decomposition,
    symmetric_power_decomposition as symmetric_power_decomposition,
    tensor_product_decomposition as tensor_product_decomposition,
    weyl_dimension as weyl_dimension,
)
from liehom.exact.representations.highest_weight.highest_weight import (
    AdmissibleLattice as AdmissibleLattice,
    HighestWeightModule as HighestWeightModule,
    admissible_lattice as admissible_lattice,
    highest_weight_module as highest_weight_module,
)
from liehom.exact.representations.highest_weight.real_modules import (
    RealModule as RealModule,
    SpinorType as SpinorType,
    real_module as real_module,
    real_module_type as real_module_type,
    spin_representation as spin_representation,
    spinor_type as spinor_type,
)
from liehom.exact.representations.highest_weight.weights import (
    casimir_eigenvalue as casimir_eigenvalue,
    congruency_class as congruency_class,
    dual_weight as dual_weight,
    dynkin_index as dynkin_index,
    frobenius_schur_indicator as frobenius_schur_indicator,
    weyl_orbit as weyl_orbit,
)
from liehom.exact.representations.invariants.intertwiners import InvariantForms as InvariantForms
from liehom.exact.representations.rationalization import Rationalization as Rationalization, rationalize as rationalize
