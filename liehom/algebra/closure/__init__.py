"""From matrices to an abstract Lie algebra: the closure of matrices under commutators.

`lie_closure` finds a basis and the structure constants exactly, for `LieAlgebra.from_matrices`, representations and
the catalogue. Sparse matrices are multiplied as dictionaries; large closures are found modulo a prime and lifted. The
algorithms that use the result are explained in docs/theory/structure.md.
"""

from liehom.algebra.closure.closure import Closure as Closure
from liehom.algebra.closure.closure import lie_closure as lie_closure
