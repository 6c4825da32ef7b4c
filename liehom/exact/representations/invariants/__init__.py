"""Matrices that respect a bracket: the proof, intertwiners, invariant forms, irreducibility, isotropy of a point.

Everything here works on lists of matrices, below the class `Representation`; see docs/theory/representations.md.
"""
