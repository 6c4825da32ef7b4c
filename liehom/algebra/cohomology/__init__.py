"""Chevalley-Eilenberg cohomology and derivations.

The cochain complex with values in a module, cohomology classes with representing cocycles, and Der(g) from the images
of generators. Users call `LieAlgebra.cohomology` and `LieAlgebra.derivations`; see docs/theory/structure.md.
"""

from liehom.algebra.cohomology.cohomology import Cohomology as Cohomology
from liehom.algebra.cohomology.derivation_algebra import Derivations as Derivations
