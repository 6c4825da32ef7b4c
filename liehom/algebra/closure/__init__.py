"""From matrices to an abstract Lie algebra: the closure of matrices under commutators.

`lie_closure` finds a basis and the structure constants exactly. Representations and the catalogue are built on it;
see docs/theory/structure.md.
"""

from liehom.algebra.closure.closure import Closure as Closure
from liehom.algebra.closure.closure import lie_closure as lie_closure
