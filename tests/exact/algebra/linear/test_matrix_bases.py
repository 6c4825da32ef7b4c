"""The families of linear Lie algebras: dimension, closure, what they preserve, and the real form they are.

The rank is taken modulo a prime, and brackets are expanded in floating point by a pseudoinverse: neither uses
the library's own elimination.  The Killing form of a real form with maximal compact subalgebra k has
signature (dim p, dim k), and vanishes on the centre.
"""

import re
from math import comb

import numpy as np
import pytest

from liehom.base.errors import InputError, LiehomError, ShapeError
from liehom.exact.algebra import linear as mf
from liehom.exact.algebra.linear.linear_bases import null_space, primitive

PRIME = 2**31 - 1


def modular_rank(rows):
    """Rank of an integer matrix modulo a prime, which is at most its rank."""
    work, rank = np.array(rows, dtype=np.int64) % PRIME, 0
    for column in range(work.shape[1]):
        if (candidates := np.flatnonzero(work[rank:, column])).size:
            work[[rank, rank + candidates[0]]] = work[[rank + candidates[0], rank]]
            work[rank] = work[rank] * pow(int(work[rank, column]), -1, PRIME) % PRIME
            below = rank + 1 + np.flatnonzero(work[rank + 1 :, column])
            work[below] = (work[below] - work[below, column][:, None] * work[rank]) % PRIME
            rank += 1
    return rank


def structure_constants(matrices):
    """c[i, j, k] in floating point; fails where a bracket leaves the span."""
    dim = len(matrices)
    flat = matrices.reshape(dim, matrices.shape[1] ** 2).astype(float)
    products = np.einsum("inm,jmk->ijnk", matrices, matrices, optimize=True)
    brackets = (products - products.transpose(1, 0, 2, 3)).reshape(dim, dim, flat.shape[1])
    constants = brackets @ np.linalg.pinv(flat)
    assert np.abs(constants @ flat - brackets).max(initial=0) < 1e-8, "a bracket leaves the span"
    return constants


def killing_signature(matrices):
    """(positive, negative, zero) of the Killing form."""
    c = structure_constants(matrices)
    if not len(c):
        return 0, 0, 0
    eigenvalues = np.linalg.eigvalsh(np.einsum("ikl,jlk->ij", c, c, optimize=True))
    small = 1e-7 * max(1.0, np.abs(eigenvalues).max())
    signs = np.where(np.abs(eigenvalues) <= small, 0, np.sign(eigenvalues))
    return int((signs > 0).sum()), int((signs < 0).sum()), int((signs == 0).sum())


def so_signature(p, q):
    """Signature of the Killing form of so(p, q), p + q >= 3."""
    return p * q, comb(p, 2) + comb(q, 2), 0


FAMILIES = {
    "gl(3,R)": (mf.gl(3), 3, (5, 3, 1)), "sl(1,R)": (mf.sl(1), 1, (0, 0, 0)), "sl(2,R)": (mf.sl(2), 2, (2, 1, 0)),
    "sl(5,R)": (mf.sl(5), 5, (14, 10, 0)), "so(1)": (mf.so(1), 1, (0, 0, 0)),
    "so(3)": (mf.so(3), 3, so_signature(3, 0)), "so(0,4)": (mf.so(0, 4), 4, so_signature(0, 4)),
    "so(4,3)": (mf.so(4, 3), 7, so_signature(4, 3)), "so(9,1)": (mf.so(9, 1), 10, so_signature(9, 1)),
    "so(1,1,-3)": (mf.orthogonal([1, 1, -3]), 3, so_signature(2, 1)),
    "so(-2,-4,6,1)": (mf.orthogonal([-2, -4, 6, 1]), 4, so_signature(2, 2)), "sp(6,R)": (mf.sp(3), 6, (12, 9, 0)),
    "u(1)": (mf.u(1), 2, (0, 0, 1)), "u(2,1)": (mf.u(2, 1), 6, (4, 4, 1)), "su(1)": (mf.su(1), 2, (0, 0, 0)),
    "su(4)": (mf.su(4), 8, (0, 15, 0)), "su(2,2)": (mf.su(2, 2), 8, (8, 7, 0)),
    "su(3,1)": (mf.su(3, 1), 8, (6, 9, 0)), "gl(2,C)": (mf.complex_gl(2), 4, (3, 3, 2)),
    "sl(3,C)": (mf.complex_sl(3), 6, (8, 8, 0)), "sl(3,C)+u(1)": (mf.complex_sl(3, scalars=1), 6, (8, 8, 1)),
    "sl(2) over Q(sqrt 2)": (mf.complex_sl(2, parameter=2), 4, (4, 2, 0)),
    "so(4,C)": (mf.complex_so(4), 8, (6, 6, 0)), "sp(4,C)": (mf.complex_sp(2), 8, (10, 10, 0)),
    "sp(4,C)+u(1)": (mf.complex_sp(2, scalars=1), 8, (10, 10, 1)), "gl(2,H)": (mf.quaternionic_gl(2), 8, (5, 10, 1)),
    "sl(1,H)": (mf.quaternionic_sl(1), 4, (0, 3, 0)), "sl(2,H)": (mf.quaternionic_sl(2), 8, (5, 10, 0)),
    "sl(2,H)+u(1)": (mf.quaternionic_sl(2, scalars=1), 8, (5, 10, 1)),
    "sl(2,H)+sp(1)": (mf.quaternionic_sl(2, scalars=3), 8, (5, 13, 0)),
    "sl(3,H)": (mf.quaternionic_sl(3), 12, (14, 21, 0)),
    "sl(2,B)+sl(1,B)": (mf.quaternionic_sl(2, scalars=3, parameters=(-1, 3)), 8, (11, 7, 0)),
    "sl(1,B)": (mf.quaternionic_sl(1, parameters=(-1, 3)), 4, (2, 1, 0)),
    "sp(2)": (mf.quaternionic_u(2), 8, (0, 10, 0)), "sp(2)+u(1)": (mf.quaternionic_u(2, scalars=1), 8, (0, 10, 1)),
    "sp(2)+sp(1)": (mf.quaternionic_u(2, scalars=3), 8, (0, 13, 0)),
    "sp(2,1)": (mf.quaternionic_u(2, 1), 12, (8, 13, 0)), "so*(2)": (mf.so_star(1), 4, (0, 0, 1)),
    "so*(6)": (mf.so_star(3), 12, (6, 9, 0)), "so*(8)": (mf.so_star(4), 16, (12, 16, 0)),
    "g2": (mf.g2(), 7, (0, 14, 0)), "g2 split": (mf.g2(mf.SPLIT_OCTONIONS), 7, (8, 6, 0)),
    "g2 over other octonions": (mf.g2((-1, -2, 3)), 7, (8, 6, 0)),
    "octonion spin(7)": (mf.octonion_spin(), 8, so_signature(7, 0)),
    "octonion spin(4,3)": (mf.octonion_spin(mf.SPLIT_OCTONIONS), 8, so_signature(4, 3)),
    "spin(3)": (mf.spin(3), 4, so_signature(3, 0)), "spin(3,1)": (mf.spin(3, 1), 4, so_signature(3, 1)),
    "spin(5,1)": (mf.spin(5, 1), 8, so_signature(5, 1)), "spin(1,5)": (mf.spin(1, 5), 8, so_signature(5, 1)),
    "spin(3,3)": (mf.spin(3, 3), 4, so_signature(3, 3)), "spin(7)": (mf.spin(7), 8, so_signature(7, 0)),
    "spin(8)": (mf.spin(8), 8, so_signature(8, 0)), "spin(4,3)": (mf.spin(4, 3), 8, so_signature(4, 3)),
    "spin(9)": (mf.spin(9), 16, so_signature(9, 0)), "spin(8,1)": (mf.spin(8, 1), 16, so_signature(8, 1)),
    "spin(9,1)": (mf.spin(9, 1), 16, so_signature(9, 1)), "spin(1,9)": (mf.spin(1, 9), 16, so_signature(9, 1)),
    "spin(5,5)": (mf.spin(5, 5), 16, so_signature(5, 5)), "spin(10)": (mf.spin(10), 32, so_signature(10, 0)),
    "f4": (mf.f4(), 27, (0, 52, 0)), "f4(-20)": (mf.f4((-1, 1, 1)), 27, (16, 36, 0)),
    "f4(4)": (mf.f4(parameters=mf.SPLIT_OCTONIONS), 27, (28, 24, 0)), "e6(-26)": (mf.e6(), 27, (26, 52, 0)),
    "e6(6)": (mf.e6(mf.SPLIT_OCTONIONS), 27, (42, 36, 0)),
    "sl(3)+sl(4)": (mf.tensor_sum(mf.sl(3), mf.sl(4)), 12, (14, 9, 0)),
    "sl(4)+sl(2)": (mf.tensor_sum(mf.sl(4), mf.sl(2)), 8, (11, 7, 0)),
    "sl(2) on cubics": (mf.symmetric_power(mf.sl(2), 3), 4, (2, 1, 0)),
    "gl(2) on quartics": (mf.symmetric_power(mf.gl(2), 4), 5, (2, 1, 1)),
    "sl(3) on Sym^2": (mf.symmetric_power(mf.sl(3), 2), 6, (5, 3, 0)),
    "sl(4) on Lambda^2": (mf.exterior_power(mf.sl(4), 2), 6, (9, 6, 0)),
    "so(3) on Sym(3)": (mf.congruence(mf.so(3)), 6, (0, 3, 0)),
    "Q(zeta_5)": (mf.companion_powers([1, 1, 1, 1]), 4, (0, 0, 4)),
}  # fmt: skip


@pytest.mark.parametrize("name", FAMILIES)
def test_is_a_lie_algebra_of_the_right_dimension_and_real_form(name):
    matrices, size, signature = FAMILIES[name]
    assert matrices.dtype == np.int64
    assert matrices.shape == (sum(signature), size, size)
    assert modular_rank(matrices.reshape(len(matrices), size**2)) == len(matrices)
    assert killing_signature(matrices) == signature


@pytest.mark.parametrize("name", FAMILIES)
def test_entries_have_small_absolute_value(name):
    bound = {"so(-2,-4,6,1)": 6, "gl(2) on quartics": 4, "g2 over other octonions": 6}.get(name, 3)
    assert np.abs(FAMILIES[name][0]).max(initial=0) <= bound


def preserves(matrices, form):
    """Whether X^T F + F X = 0 for all the matrices."""
    return not (matrices.transpose(0, 2, 1) @ form + form @ matrices).any()


def commutes(matrices, other):
    return not (matrices @ other - other @ matrices).any()


def diagonal(p, q, block=1):
    return np.diag([1] * (p * block) + [-1] * (q * block))


@pytest.mark.parametrize(("matrices", "form"), [
    (mf.so(4, 3), diagonal(4, 3)), (mf.orthogonal([-2, -4, 6, 1]), np.diag([-2, -4, 6, 1])),
    (mf.sp(3), np.kron([[0, 1], [-1, 0]], np.eye(3, dtype=int))), (mf.u(2, 1), diagonal(2, 1, 2)),
    (mf.su(3, 2), diagonal(3, 2, 2)), (mf.quaternionic_u(2, 1, scalars=3), diagonal(2, 1, 4)),
    (mf.g2(), np.eye(7, dtype=int)), (mf.g2(mf.SPLIT_OCTONIONS), diagonal(3, 4)),
    (mf.octonion_spin(), np.eye(8, dtype=int)), (mf.octonion_spin(mf.SPLIT_OCTONIONS), diagonal(4, 4)),
    (mf.spin(7), np.eye(8, dtype=int)), (mf.spin(9), np.eye(16, dtype=int)),
])  # fmt: skip
def test_preserves_its_form(matrices, form):
    assert preserves(matrices, form)


@pytest.mark.parametrize(("p", "q"), [(2, 0), (2, 1), (3, 2)])
def test_su_has_complex_trace_zero_and_commutes_with_the_complex_structure(p, q):
    structure = mf.complex_structure(p + q)
    assert commutes(mf.su(p, q), structure)
    assert commutes(mf.u(p, q), structure)
    assert not np.trace(mf.su(p, q) @ structure, axis1=1, axis2=2).any()
    assert not np.trace(mf.su(p, q), axis1=1, axis2=2).any()


@pytest.mark.parametrize("matrices", [mf.complex_gl(2), mf.complex_sl(2), mf.complex_so(2), mf.complex_sp(1)])
def test_complex_families_commute_with_the_complex_structure(matrices):
    structure = mf.complex_structure(matrices.shape[1] // 2)
    assert np.array_equal(structure @ structure, -np.eye(len(structure)))
    assert commutes(matrices, structure)


@pytest.mark.parametrize("parameters", [(-1, -1), (-1, 3), (2, 5)])
def test_quaternionic_families_commute_with_right_multiplications(parameters):
    scalars = mf.quaternion_scalars(2, parameters=parameters)
    assert all(np.array_equal(s @ s, c * np.eye(8)) for s, c in zip(scalars, parameters, strict=False))
    assert np.array_equal(scalars[0] @ scalars[1], -scalars[1] @ scalars[0])
    for scalar in scalars:
        assert commutes(mf.quaternionic_gl(2, parameters=parameters), scalar)
        assert commutes(mf.quaternionic_sl(2, parameters=parameters), scalar)


@pytest.mark.parametrize("matrices", [mf.quaternionic_u(2, 1), mf.so_star(3)])
def test_quaternionic_unitary_families_commute_with_right_multiplications(matrices):
    for scalar in mf.quaternion_scalars(3):
        assert commutes(matrices, scalar)


def test_so_star_preserves_the_skew_hermitian_form():
    """The components of conj(x) j y are forms; the real one is skew, and preserved with the others."""
    form = np.kron(np.eye(3, dtype=int), mf.left_multiplications(mf.cayley_dickson((-1, -1)))[2])
    assert preserves(mf.so_star(3), form)
    for scalar in mf.quaternion_scalars(3):
        assert preserves(mf.so_star(3), form @ scalar)


@pytest.mark.parametrize("parameters", [mf.OCTONIONS, mf.SPLIT_OCTONIONS, (-1, -2, 3)])
def test_g2_acts_by_derivations(parameters):
    extended = np.zeros((14, 8, 8), dtype=int)
    extended[:, 1:, 1:] = mf.g2(parameters)
    assert derivation_defect(extended, mf.octonion_table(parameters)) == 0


def derivation_defect(matrices, product):
    of_product = np.einsum("ijk,alk->aijl", product, matrices, optimize=True)
    first = np.einsum("ami,mjl->aijl", matrices, product, optimize=True)
    return np.abs(of_product - first - np.einsum("amj,iml->aijl", matrices, product, optimize=True)).max()


@pytest.mark.parametrize(
    ("signs", "parameters"), [((1, 1, 1), mf.OCTONIONS), ((-1, 1, 1), mf.OCTONIONS), ((1, 1, 1), mf.SPLIT_OCTONIONS)]
)
def test_f4_acts_by_derivations_and_fixes_the_identity(signs, parameters):
    product = mf.albert_product(signs, parameters=parameters)
    matrices = mf.f4(signs, parameters=parameters)
    assert derivation_defect(matrices, product) == 0
    identity = mf.albert_idempotent(1) + mf.albert_idempotent(2) + mf.albert_idempotent(3)
    assert not (matrices @ identity).any()
    assert np.array_equal(np.einsum("i,ijk->jk", identity, product), 2 * np.eye(27))


@pytest.mark.parametrize("signs", [(1, 1, 1), (-1, 1, 1), (1, -1, 1)])
def test_albert_product_is_a_jordan_product(signs):
    product = mf.albert_product(signs)
    x, y = np.random.default_rng(7).integers(-4, 5, (2, 27))

    def times(a, b):
        return np.einsum("i,j,ijk->k", a, b, product)

    square = times(x, x)
    assert np.array_equal(times(x, y), times(y, x))
    assert np.array_equal(times(times(x, y), square), times(x, times(y, square)))


@pytest.mark.parametrize("parameters", [mf.OCTONIONS, mf.SPLIT_OCTONIONS])
def test_e6_preserves_the_cubic_norm(parameters):
    """N(x) = tr(x^3)/3 - tr(x^2) tr(x)/2 + tr(x)^3/6; its derivative along A x vanishes."""
    product = mf.albert_product(parameters=parameters)
    trace = np.array([1, 1, 1] + [0] * 24)
    x = np.random.default_rng(11).integers(-5, 6, 27)
    square = np.einsum("i,j,ijk->k", x, x, product)  # 2 x^2
    metric = product @ trace  # 2 tr(e_i o e_j)
    t = trace @ x
    # dN(v) = tr(x^2 o v) - tr(x) tr(x o v) - tr(x^2) tr(v) / 2 + tr(x)^2 tr(v) / 2, here 8 times
    gradient = 2 * (metric @ square) - 4 * t * (metric @ x) + (4 * t * t - 2 * trace @ square) * trace
    assert not (mf.e6(parameters) @ x @ gradient).any()
    assert x @ gradient != 0


STABILIZERS = {
    "so(4)/so(3)": (mf.so(4), [1, 0, 0, 0], (0, 3, 0)),
    "so(3,1)/so(2,1)": (mf.so(3, 1), [1, 0, 0, 0], (2, 1, 0)),
    "so(3,1)/e(2)": (mf.so(3, 1), [1, 0, 0, 1], (0, 1, 2)),
    "g2/su(3)": (mf.g2(), [0, 0, 1, 0, 0, 0, 0], (0, 8, 0)),
    "split g2/su(2,1)": (mf.g2(mf.SPLIT_OCTONIONS), [1, 0, 0, 0, 0, 0, 0], (4, 4, 0)),
    "split g2/sl(3)": (mf.g2(mf.SPLIT_OCTONIONS), [0, 0, 0, 1, 0, 0, 0], (5, 3, 0)),
    "spin(7)/g2": (mf.spin(7), [1] + [0] * 7, (0, 14, 0)),
    "octonion spin(7)/g2": (mf.octonion_spin(), [1] + [0] * 7, (0, 14, 0)),
    "spin(4,3)/g2 split": (mf.octonion_spin(mf.SPLIT_OCTONIONS), [1] + [0] * 7, (8, 6, 0)),
    "spin(9)/spin(7)": (mf.spin(9), [1] + [0] * 15, (0, 21, 0)),
    "f4/spin(9)": (mf.f4(), mf.albert_idempotent(1), (0, 36, 0)),
    "f4(-20)/spin(9)": (mf.f4((-1, 1, 1)), mf.albert_idempotent(1), (0, 36, 0)),
    "f4(-20)/spin(8,1)": (mf.f4((-1, 1, 1)), mf.albert_idempotent(2), (8, 28, 0)),
}


@pytest.mark.parametrize("name", STABILIZERS)
def test_stabilizer_of_a_point(name):
    matrices, point, signature = STABILIZERS[name]
    rows = mf.stabilizer_rows(matrices, point)
    stabilizer = mf.combine(rows, matrices)
    assert not (stabilizer @ np.asarray(point)).any()
    orbit = modular_rank(matrices @ np.asarray(point))
    assert len(rows) == modular_rank(rows) == sum(signature) == len(matrices) - orbit
    assert killing_signature(stabilizer) == signature


def test_first_36_of_f4_are_the_stabilizer_of_the_first_idempotent():
    for signs in ((1, 1, 1), (-1, 1, 1)):
        assert not (mf.f4(signs)[:36] @ mf.albert_idempotent(1)).any()
        assert killing_signature(mf.f4(signs)[:36]) == (0, 36, 0)


def test_parabolic_of_e6_keeps_the_line_of_a_primitive_idempotent():
    matrices, point = mf.e6(), mf.albert_idempotent(1)
    rows = mf.stabilizer_rows(matrices, point, up_to_scale=True)
    images = mf.combine(rows, matrices) @ point
    assert len(rows) == modular_rank(rows) == 62
    assert not images[:, 1:].any() and images[:, 0].any()
    structure_constants(mf.combine(rows, matrices))
    assert len(mf.stabilizer_rows(matrices, point)) == 61
    # the nilradical is where the Killing form of P degenerates: 16 dimensions; the rest is so(9,1) + R
    assert killing_signature(mf.combine(rows, matrices)) == (9 + 1, 36, 16)


def test_null_space_is_the_primitive_basis_dual_to_the_columns_without_pivot():
    rng = np.random.default_rng(3)
    for _ in range(60):
        n = int(rng.integers(1, 8))
        matrix = rng.integers(-3, 4, size=(int(rng.integers(0, 7)), n))
        rows = null_space(matrix)
        free = [j for j in range(n) if modular_rank(matrix[:, : j + 1]) == modular_rank(matrix[:, :j])]
        assert rows.shape == (len(free), n)
        assert not (rows @ matrix.T).any()
        assert (np.gcd.reduce(rows, axis=1) == 1).all()
        assert (np.diag(rows[:, free]) > 0).all()
        assert np.count_nonzero(rows[:, free]) == len(free)


def test_null_space_agrees_with_the_modular_rank():
    rng = np.random.default_rng(1)
    for m, n, rank in ((4, 6, 2), (7, 5, 4), (3, 3, 3), (0, 3, 0), (2, 4, 0)):
        matrix = rng.integers(-4, 5, (m, rank)) @ rng.integers(-4, 5, (rank, n))
        kernel = null_space(matrix)
        assert kernel.shape == (n - modular_rank(matrix), n) and modular_rank(kernel) == len(kernel)
        assert not (matrix @ kernel.T).any() and all(np.gcd.reduce(row) == 1 for row in kernel)
    assert primitive([0, 0]).tolist() == [0, 0]


@pytest.mark.parametrize(("call", "message"), [
    (lambda: mf.gl(0), "n must be an integer >= 1; got 0"), (lambda: mf.sl(2.0), "got 2.0"),
    (lambda: mf.sl(True), "got True"), (lambda: mf.so(-1, 3), "p must be an integer >= 0; got -1"),
    (lambda: mf.so(0, 0), "must be an integer >= 1; got 0"), (lambda: mf.orthogonal([]), "number of diagonal entries"),
    (lambda: mf.orthogonal([1, 0]), "non-zero integers"), (lambda: mf.orthogonal([1, 0.5]), "non-zero integers"),
    (lambda: mf.complex_sl(2, scalars=3), "0 or 1"), (lambda: mf.complex_gl(2, parameter=0), "non-zero"),
    (lambda: mf.quaternionic_sl(2, scalars=2), "0, 1 (for u(1)) or 3"),
    (lambda: mf.quaternionic_gl(2, parameters=(-1,)), "two parameters"),
    (lambda: mf.cayley_dickson((1, 1, 1, 1)), "at most 3"), (lambda: mf.g2((-1, -1)), "three doubling parameters"),
    (lambda: mf.f4((1, 1, 2)), "three signs"), (lambda: mf.albert_idempotent(0), "numbered 1, 2, 3"),
    (lambda: mf.spin(1), ">= 2"), (lambda: mf.spin(4, chirality=0), "chirality"),
    (lambda: mf.clifford(1, -1), "q must be"), (lambda: mf.symmetric_power(mf.sl(2), -1), "k must be"),
    (lambda: mf.exterior_power(mf.sl(2), 3), "k <= 2"), (lambda: mf.companion_powers([]), "degree at least 1"),
    (lambda: mf.stabilizer_rows(mf.so(3), [0, 0, 0], up_to_scale=True), "zero vector"),
    (lambda: mf.tensor_sum([[[0.5]]], mf.sl(2)), "integer matrices"),
])  # fmt: skip
def test_invalid_parameters_raise_errors(call, message):
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        call()
    assert isinstance(caught.value, LiehomError)


@pytest.mark.parametrize("call", [
    lambda: mf.join(mf.so(3), mf.so(4)), lambda: mf.join(), lambda: mf.stabilizer_rows(mf.so(3), [1, 0]),
    lambda: mf.combine([[1, 2]], mf.so(3)), lambda: mf.congruence([[1, 2], [3, 4]]),
])  # fmt: skip
def test_shapes_that_do_not_fit_are_refused(call):
    with pytest.raises(ShapeError):
        call()


def test_stabilizer_of_the_zero_vector_is_everything():
    assert np.array_equal(mf.stabilizer_rows(mf.so(3), [0, 0, 0]), np.eye(3))
