"""Structure theory of a given algebra in any basis: radical, Levi factor, ideals, Cartan subalgebras, real form.

Each file answers one question about a `LieAlgebra`, exactly, and is reached as a method of it. `identification` and
`describe` put the answers together. The algorithms and their proofs are in docs/theory/structure.md.
"""

from liehom.algebra.structure.levi import LeviDecomposition as LeviDecomposition
from liehom.algebra.structure.real_splitting import Place as Place
from liehom.algebra.structure.real_splitting import places as places
from liehom.algebra.structure.real_splitting import real_ideals as real_ideals
from liehom.algebra.structure.root_spaces import RootSpace as RootSpace
from liehom.algebra.structure.root_spaces import RootSpaceDecomposition as RootSpaceDecomposition
