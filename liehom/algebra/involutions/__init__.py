"""Cartan decompositions g = k + p, from involutions over the field of the algebra.

`cartan_decomposition` tries the sources of involutions in order of cost and proves what it finds;
`involution_obstruction` proves where there is none. Reached through `LieAlgebra.cartan_decomposition`; see
docs/theory/structure.md.
"""

from liehom.algebra.involutions.cartan_decomposition import CartanDecomposition as CartanDecomposition
