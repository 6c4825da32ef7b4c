"""Structure theory of a given algebra in any basis: radical, Levi factor, ideals, Cartan subalgebras, real form.

Each file answers one question about a `LieAlgebra` exactly; users call it as a method of `LieAlgebra` or `Subalgebra`.
`identification` and `describe` combine the answers. The algorithms and their proofs are in docs/theory/structure.md.
"""

from liehom.algebra.structure.levi import LeviDecomposition as LeviDecomposition
from liehom.algebra.structure.real_splitting import Place as Place
from liehom.algebra.structure.root_spaces import RootSpace as RootSpace
from liehom.algebra.structure.root_spaces import RootSpaceDecomposition as RootSpaceDecomposition
