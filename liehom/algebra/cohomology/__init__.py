"""Chevalley-Eilenberg cohomology and derivations.

The complex with values in a module, its cohomology with cocycles, and Der(g) by the images of generators. Reached
through `LieAlgebra.cohomology` and `LieAlgebra.derivations`; see docs/theory/structure.md.
"""

from liehom.algebra.cohomology.cohomology import Cohomology as Cohomology
from liehom.algebra.cohomology.derivation_algebra import Derivations as Derivations
