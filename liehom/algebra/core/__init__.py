"""Lie algebras by structure constants, subalgebras, homomorphisms, and the proofs of their axioms.

`LieAlgebra` is the table of contents of the folder: its methods delegate to the wings above, and only it and
`Subalgebra` may import upwards. `tables` reads structure constants in any form, `jacobi` proves the Jacobi identity.
Every layer above uses this wing; the conventions are in docs/notation.md.
"""

from liehom.algebra.core.homomorphism import Homomorphism as Homomorphism
from liehom.algebra.core.lie_algebra import LieAlgebra as LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants as StructureConstants
from liehom.algebra.core.subalgebra import Subalgebra as Subalgebra
