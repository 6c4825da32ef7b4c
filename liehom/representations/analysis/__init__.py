"""Analysis of a representation: decomposition over the reals, equivalence, submodules, weights, symbolic isotropy.

Each module implements some methods of `Representation`, and users call these methods. See
docs/theory/representations.md.
"""

from liehom.representations.analysis.central_charges import Charge as Charge
from liehom.representations.analysis.decomposition import Component as Component
from liehom.representations.analysis.decomposition import Decomposition as Decomposition
from liehom.representations.analysis.decomposition import IsotypicComponent as IsotypicComponent
from liehom.representations.analysis.hermitian_forms import HermitianForms as HermitianForms
from liehom.representations.analysis.maximal_submodules import MaximalSubmodules as MaximalSubmodules
from liehom.representations.analysis.symbolic import SymbolicIsotropy as SymbolicIsotropy
from liehom.representations.analysis.weight_multiplicities import ChargedWeight as ChargedWeight
