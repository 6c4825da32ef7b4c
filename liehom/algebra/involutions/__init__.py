"""Cartan decompositions g = k + p, from involutions over the field of the algebra.

`cartan_decomposition` tries the sources of involutions in order of cost and proves the result; `involution_obstruction`
proves, from the centroid, that an algebra has no Cartan involution over its field. Users call
`LieAlgebra.cartan_decomposition`. The algorithms are explained in docs/theory/structure.md.
"""

from liehom.algebra.involutions.cartan_decomposition import CartanDecomposition as CartanDecomposition
