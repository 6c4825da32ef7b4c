"""Radical, Levi factor, centroid, ideals, root spaces, cohomology, derivations, and the name of an algebra.

Exact, in any basis and over the field of the algebra; see docs/theory/structure.md.
"""

from liehom.base.lazy import lazy_modules

__getattr__ = lazy_modules(__name__)
