"""Radical, Levi factor, centroid, ideals, root spaces, cohomology, derivations, and the name of an algebra.

Exact, in any basis and over the field of the algebra; see docs/theory/structure.md.
"""
