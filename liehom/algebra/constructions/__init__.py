"""Constructors of Lie algebras, by name and from other Lie algebras.

Classical, kinematical, solvable, free nilpotent and simple algebras; sums, quotients, central extensions and
complexifications. Users call the functions of the top level, such as `liehom.so` and `liehom.direct_sum`. The bases are
described in docs/catalogue.md.
"""

from liehom.algebra.constructions.classical_algebras import gl as gl
from liehom.algebra.constructions.classical_algebras import parabolic_subalgebra as parabolic_subalgebra
from liehom.algebra.constructions.classical_algebras import sl as sl
from liehom.algebra.constructions.classical_algebras import so as so
from liehom.algebra.constructions.classical_algebras import so_star as so_star
from liehom.algebra.constructions.classical_algebras import sp as sp
from liehom.algebra.constructions.classical_algebras import su as su
from liehom.algebra.constructions.classical_algebras import u as u
from liehom.algebra.constructions.complex_algebra import ComplexLieAlgebra as ComplexLieAlgebra
from liehom.algebra.constructions.complex_algebra import realification as realification
from liehom.algebra.constructions.extensions import central_extension as central_extension
from liehom.algebra.constructions.family import Generic as Generic
from liehom.algebra.constructions.family import LieAlgebraFamily as LieAlgebraFamily
from liehom.algebra.constructions.form_algebras import so_form as so_form
from liehom.algebra.constructions.form_algebras import sp_form as sp_form
from liehom.algebra.constructions.free_nilpotent import free_nilpotent as free_nilpotent
from liehom.algebra.constructions.kinematical_families import affine as affine
from liehom.algebra.constructions.kinematical_families import affine_of as affine_of
from liehom.algebra.constructions.kinematical_families import bargmann as bargmann
from liehom.algebra.constructions.kinematical_families import conformal as conformal
from liehom.algebra.constructions.kinematical_families import euclidean as euclidean
from liehom.algebra.constructions.kinematical_families import galilei as galilei
from liehom.algebra.constructions.kinematical_families import poincare as poincare
from liehom.algebra.constructions.kinematical_families import schroedinger as schroedinger
from liehom.algebra.constructions.low_dimensional import low_dimensional as low_dimensional
from liehom.algebra.constructions.simple import simple as simple
from liehom.algebra.constructions.solvable_families import abelian as abelian
from liehom.algebra.constructions.solvable_families import almost_abelian as almost_abelian
from liehom.algebra.constructions.solvable_families import bianchi as bianchi
from liehom.algebra.constructions.solvable_families import filiform as filiform
from liehom.algebra.constructions.solvable_families import heisenberg as heisenberg
from liehom.algebra.constructions.solvable_families import oscillator as oscillator
from liehom.algebra.constructions.solvable_families import strictly_upper_triangular as strictly_upper_triangular
from liehom.algebra.constructions.solvable_families import upper_triangular as upper_triangular
from liehom.algebra.constructions.sums import direct_sum as direct_sum
from liehom.algebra.constructions.sums import semidirect_sum as semidirect_sum
