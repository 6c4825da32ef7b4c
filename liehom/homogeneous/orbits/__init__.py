"""Orbit types: the isotropy of points up to conjugation, of strata, and short names for both.

Used by the instances and by `liehom.orbit_types`; see docs/theory/representations.md.
"""

from liehom.homogeneous.orbits.conjugacy_invariants import ConjugacyInvariants as ConjugacyInvariants
from liehom.homogeneous.orbits.conjugacy_proof import ConjugacyProof as ConjugacyProof
from liehom.homogeneous.orbits.matrix_strata import binary_form_strata as binary_form_strata
from liehom.homogeneous.orbits.matrix_strata import rectangular_strata as rectangular_strata
from liehom.homogeneous.orbits.matrix_strata import skew_strata as skew_strata
from liehom.homogeneous.orbits.orbit_types import OrbitType as OrbitType
from liehom.homogeneous.orbits.orbit_types import orbit_types as orbit_types
from liehom.homogeneous.orbits.strata import Stratum as Stratum
from liehom.homogeneous.orbits.strata import adjoint_strata as adjoint_strata
from liehom.homogeneous.orbits.strata import hermitian_strata as hermitian_strata
from liehom.homogeneous.orbits.strata import symmetric_strata as symmetric_strata
from liehom.homogeneous.orbits.structure_name import structure_name as structure_name
