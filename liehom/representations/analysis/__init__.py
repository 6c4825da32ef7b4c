"""What a given representation is made of: decomposition over the reals, equivalence, submodules, weights.

Each file answers one question about a `Representation` and is reached as a method of it; `symbolic` gives the
isotropy at points with free symbols. See docs/theory/representations.md.
"""

from liehom.representations.analysis.decomposition import Component as Component
from liehom.representations.analysis.decomposition import Decomposition as Decomposition
from liehom.representations.analysis.decomposition import IsotypicComponent as IsotypicComponent
from liehom.representations.analysis.hermitian_forms import HermitianForms as HermitianForms
from liehom.representations.analysis.symbolic import SymbolicIsotropy as SymbolicIsotropy
