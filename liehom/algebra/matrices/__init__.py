"""Bases of linear Lie algebras: each is one int64 array of shape (dim, N, N), closed under commutators.

The Hermitian matrices of physics are lists of sympy matrices.

matrix_basis         join, combine, stabilizer_rows: operations on every basis
general_linear       gl, sl over R, C, H (and forms over Q), with commuting scalars; triangular matrices
form_preserving      so, u, su, sp(2n, R), sp(p, q), so*(2n), so(n, C), sp(2n, C)
tensor_products      sums on tensor products, Sym^k, Lambda^k, symmetric matrices, Q[t]/(f)
spinors              spin(p, q) from Clifford generators
composition_algebra  multiplication tables of quadratic, quaternion and octonion algebras
octonionic           g2, spin(7), spin(4, 3)
albert               f4, e6
physics_matrices     Pauli, Gell-Mann, Dirac and spin matrices
named_matrices       the table of names and parameters of all classical and exceptional bases

The constructors of `liehom.algebra.constructions` and the catalogue build on this wing; the bases are described in
docs/catalogue.md.
"""

from liehom.algebra.matrices.albert import albert_idempotent as albert_idempotent
from liehom.algebra.matrices.albert import albert_product as albert_product
from liehom.algebra.matrices.albert import e6 as e6
from liehom.algebra.matrices.albert import f4 as f4
from liehom.algebra.matrices.composition_algebra import OCTONIONS as OCTONIONS
from liehom.algebra.matrices.composition_algebra import SPLIT_OCTONIONS as SPLIT_OCTONIONS
from liehom.algebra.matrices.composition_algebra import cayley_dickson as cayley_dickson
from liehom.algebra.matrices.composition_algebra import left_multiplications as left_multiplications
from liehom.algebra.matrices.composition_algebra import norm_diagonal as norm_diagonal
from liehom.algebra.matrices.composition_algebra import right_multiplications as right_multiplications
from liehom.algebra.matrices.form_preserving import complex_so as complex_so
from liehom.algebra.matrices.form_preserving import complex_sp as complex_sp
from liehom.algebra.matrices.form_preserving import orthogonal as orthogonal
from liehom.algebra.matrices.form_preserving import quaternionic_u as quaternionic_u
from liehom.algebra.matrices.form_preserving import so as so
from liehom.algebra.matrices.form_preserving import so_star as so_star
from liehom.algebra.matrices.form_preserving import sp as sp
from liehom.algebra.matrices.form_preserving import su as su
from liehom.algebra.matrices.form_preserving import u as u
from liehom.algebra.matrices.general_linear import complex_gl as complex_gl
from liehom.algebra.matrices.general_linear import complex_sl as complex_sl
from liehom.algebra.matrices.general_linear import complex_structure as complex_structure
from liehom.algebra.matrices.general_linear import complexify as complexify
from liehom.algebra.matrices.general_linear import gl as gl
from liehom.algebra.matrices.general_linear import quaternion_scalars as quaternion_scalars
from liehom.algebra.matrices.general_linear import quaternionic_gl as quaternionic_gl
from liehom.algebra.matrices.general_linear import quaternionic_sl as quaternionic_sl
from liehom.algebra.matrices.general_linear import sl as sl
from liehom.algebra.matrices.general_linear import triangular as triangular
from liehom.algebra.matrices.matrix_basis import combine as combine
from liehom.algebra.matrices.matrix_basis import join as join
from liehom.algebra.matrices.matrix_basis import stabilizer_rows as stabilizer_rows
from liehom.algebra.matrices.named_matrices import classical_matrices as classical_matrices
from liehom.algebra.matrices.named_matrices import classical_name as classical_name
from liehom.algebra.matrices.named_matrices import exceptional_matrices as exceptional_matrices
from liehom.algebra.matrices.named_matrices import linear_lie_algebra as linear_lie_algebra
from liehom.algebra.matrices.octonionic import g2 as g2
from liehom.algebra.matrices.octonionic import octonion_spin as octonion_spin
from liehom.algebra.matrices.octonionic import octonion_table as octonion_table
from liehom.algebra.matrices.physics_matrices import dirac_matrices as dirac_matrices
from liehom.algebra.matrices.physics_matrices import gell_mann_matrices as gell_mann_matrices
from liehom.algebra.matrices.physics_matrices import pauli_matrices as pauli_matrices
from liehom.algebra.matrices.physics_matrices import spin_matrices as spin_matrices
from liehom.algebra.matrices.spinors import clifford as clifford
from liehom.algebra.matrices.spinors import spin as spin
from liehom.algebra.matrices.tensor_products import companion_powers as companion_powers
from liehom.algebra.matrices.tensor_products import congruence as congruence
from liehom.algebra.matrices.tensor_products import exterior_power as exterior_power
from liehom.algebra.matrices.tensor_products import symmetric_power as symmetric_power
from liehom.algebra.matrices.tensor_products import tensor_sum as tensor_sum
