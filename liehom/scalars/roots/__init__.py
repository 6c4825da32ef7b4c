"""Roots of polynomials and joint eigenvalues of commuting matrices, by rigorous enclosures.

`extension` adjoins a real root and factors polynomials over the reals, and `primitive_element` finds a small generator
of a number field. `joint_spectrum` and `joint_multiplicities` give eigenvalues with exact multiplicities. Structure
theory and decompositions of representations use this wing; see docs/theory/structure.md.
"""

from liehom.scalars.roots.extension import Extension as Extension
from liehom.scalars.roots.extension import RealFactor as RealFactor
from liehom.scalars.roots.extension import adjoin_root as adjoin_root
from liehom.scalars.roots.extension import real_factors as real_factors
