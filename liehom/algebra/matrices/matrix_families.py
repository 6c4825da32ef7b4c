"""The bases of the linear Lie algebras that liehom builds on, in one place.

matrix_basis           join, combine, stabilizer_rows: what all of them share
matrices_linear        gl, sl over R, C, H (and forms over Q), with commuting scalars
matrices_forms         so, u, su, sp(2n, R), sp(p, q), so*(2n), so(n, C), sp(2n, C)
matrices_tensor        sums on tensor products, Sym^k, Lambda^k, symmetric matrices, Q[t]/(f)
matrices_spin          spin(p, q) from Clifford generators
matrices_octonionic    g2, spin(7), spin(4, 3)
matrices_albert        f4, e6
composition_algebra    the multiplication tables behind them

Every family is an int64 array of shape (dim, N, N).
"""

from liehom.algebra.matrices.composition_algebra import OCTONIONS as OCTONIONS
from liehom.algebra.matrices.composition_algebra import SPLIT_OCTONIONS as SPLIT_OCTONIONS
from liehom.algebra.matrices.composition_algebra import cayley_dickson as cayley_dickson
from liehom.algebra.matrices.composition_algebra import left_multiplications as left_multiplications
from liehom.algebra.matrices.composition_algebra import norm_diagonal as norm_diagonal
from liehom.algebra.matrices.composition_algebra import right_multiplications as right_multiplications
from liehom.algebra.matrices.matrices_albert import albert_idempotent as albert_idempotent
from liehom.algebra.matrices.matrices_albert import albert_product as albert_product
from liehom.algebra.matrices.matrices_albert import e6 as e6
from liehom.algebra.matrices.matrices_albert import f4 as f4
from liehom.algebra.matrices.matrices_forms import complex_so as complex_so
from liehom.algebra.matrices.matrices_forms import complex_sp as complex_sp
from liehom.algebra.matrices.matrices_forms import orthogonal as orthogonal
from liehom.algebra.matrices.matrices_forms import quaternionic_u as quaternionic_u
from liehom.algebra.matrices.matrices_forms import so as so
from liehom.algebra.matrices.matrices_forms import so_star as so_star
from liehom.algebra.matrices.matrices_forms import sp as sp
from liehom.algebra.matrices.matrices_forms import su as su
from liehom.algebra.matrices.matrices_forms import u as u
from liehom.algebra.matrices.matrices_linear import complex_gl as complex_gl
from liehom.algebra.matrices.matrices_linear import complex_sl as complex_sl
from liehom.algebra.matrices.matrices_linear import complex_structure as complex_structure
from liehom.algebra.matrices.matrices_linear import complexify as complexify
from liehom.algebra.matrices.matrices_linear import gl as gl
from liehom.algebra.matrices.matrices_linear import quaternion_scalars as quaternion_scalars
from liehom.algebra.matrices.matrices_linear import quaternionic_gl as quaternionic_gl
from liehom.algebra.matrices.matrices_linear import quaternionic_sl as quaternionic_sl
from liehom.algebra.matrices.matrices_linear import sl as sl
from liehom.algebra.matrices.matrices_octonionic import g2 as g2
from liehom.algebra.matrices.matrices_octonionic import octonion_spin as octonion_spin
from liehom.algebra.matrices.matrices_octonionic import octonion_table as octonion_table
from liehom.algebra.matrices.matrices_spin import clifford as clifford
from liehom.algebra.matrices.matrices_spin import spin as spin
from liehom.algebra.matrices.matrices_tensor import companion_powers as companion_powers
from liehom.algebra.matrices.matrices_tensor import congruence as congruence
from liehom.algebra.matrices.matrices_tensor import exterior_power as exterior_power
from liehom.algebra.matrices.matrices_tensor import symmetric_power as symmetric_power
from liehom.algebra.matrices.matrices_tensor import tensor_sum as tensor_sum
from liehom.algebra.matrices.matrix_basis import combine as combine
from liehom.algebra.matrices.matrix_basis import join as join
from liehom.algebra.matrices.matrix_basis import stabilizer_rows as stabilizer_rows
