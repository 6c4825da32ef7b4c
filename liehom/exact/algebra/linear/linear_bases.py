"""Integer matrix bases of the linear Lie algebras: gl and sl, algebras of forms, tensor products."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations, combinations_with_replacement
from math import comb, gcd, log10

import numpy as np
from numpy.typing import ArrayLike

from liehom.base.budget import current_limits, in_time, within
from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import IntegerArray
from liehom.exact.scalars.rational import QQ

# Operations on matrix bases of linear Lie algebras, and the checks of parameters that all families share.
# A matrix basis A_1, ..., A_dim is one int64 array of shape (dim, N, N). The stabilizers of a vector v and of the line
# through it,
#
#     {c : sum_i c_i A_i v = 0}     and     {c : sum_i c_i A_i v in R v},
#
# are computed exactly, as rows of integer coefficients c.

BYTES = 8
"""Bytes of an entry of a matrix, an int64 or a small integer of flint."""


def combine(rows: ArrayLike, matrices: ArrayLike) -> IntegerArray:
    """Linear combinations of the matrices of a basis, one for each row of coefficients; shape (m, N, N)."""
    basis = as_matrices(matrices)
    coefficients = np.asarray(rows, dtype=np.int64)
    if coefficients.ndim != 2 or coefficients.shape[1] != len(basis):
        raise ShapeError(f"rows of shape (m, {len(basis)}) are needed; got shape {coefficients.shape}")
    return np.tensordot(coefficients, basis, 1)


def join(*families: ArrayLike) -> IntegerArray:
    """Concatenation of matrix bases on the same space, shape (sum of dim_a, N, N)."""
    bases = [as_matrices(family) for family in families]
    sizes = sorted({basis.shape[1] for basis in bases})
    if len(sizes) != 1:
        raise ShapeError(f"families on the same space are needed; got matrices of sizes {sizes}")
    count, size = sum(map(len, bases)), sizes[0]
    within("memory", BYTES * count * size * size, f"{count} matrices of size {size} are {{}} bytes")
    in_time()
    return np.concatenate(bases)


def stabilizer_rows(matrices: ArrayLike, point: ArrayLike, *, up_to_scale: bool = False) -> IntegerArray:
    """Basis of the combinations that annihilate a vector or map its line to itself, rows (m, dim)."""
    basis = as_matrices(matrices)
    vector = np.asarray(point, dtype=np.int64)
    if vector.shape != basis.shape[1:2]:
        raise ShapeError(f"the point must have length {basis.shape[1]}; got an array of shape {vector.shape}")
    system = (basis @ vector).T
    if not up_to_scale:
        return null_space(system)
    if not vector.any():
        raise InputError("the zero vector spans no line; give a point that is not zero")
    rows = null_space(np.column_stack([system, -vector]))[:, :-1]
    return np.array([primitive(row) for row in rows], dtype=np.int64).reshape(-1, len(basis))


def null_space(matrix: ArrayLike) -> IntegerArray:
    """Exact basis of {x : M x = 0} as primitive integer rows, shape (n - rank, n)."""
    # conditions on all pairs of indices repeat many equations
    system = np.unique(np.asarray(matrix, dtype=np.int64), axis=0)
    solved = QQ.from_integers(system.ravel().tolist(), *system.shape).null_space()
    rows = [primitive([int(x) for x in row]) for row in solved.parts[0].tolist()]
    return np.array(rows, dtype=np.int64).reshape(-1, system.shape[1])


def primitive(values: ArrayLike) -> IntegerArray:
    """The integer array divided by the greatest common divisor of its entries."""
    array = np.asarray(values, dtype=np.int64)
    divisor = gcd(*(int(value) for value in array[array != 0]))
    return array // divisor if divisor > 1 else array


def as_matrices(matrices: ArrayLike) -> IntegerArray:
    """The matrices as one int64 array of shape (dim, N, N), checked."""
    array = np.asarray(matrices)
    if array.ndim != 3 or array.shape[1] != array.shape[2]:
        raise ShapeError(f"an array of shape (dim, N, N) is needed; got shape {array.shape}")
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"integer matrices are needed; got entries of type {array.dtype}")
    return array.astype(np.int64, copy=False)


def stack(matrices: Iterable[IntegerArray], size: int) -> IntegerArray:
    """One array of shape (dim, size, size) from matrices; dim may be 0."""
    return np.array(list(matrices), dtype=np.int64).reshape(-1, size, size)


def unit(size: int, i: int, j: int) -> IntegerArray:
    """The elementary matrix E_ij, (size, size), with a one in row i and column j."""
    matrix = np.zeros((size, size), dtype=np.int64)
    matrix[i, j] = 1
    return matrix


def require_size(name: str, value: int, least: int = 1) -> None:
    """Raise `InputError` unless the parameter is an integer >= `least`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise InputError(f"{name} must be an integer >= {least}; got {displayed(value)}")
    within("dimension", int(value), f"{name} is {{}}")


def require_basis(count: int, size: int) -> None:
    """Raise `LimitError` if a Lie algebra of `count` matrices (size, size) has too large a dimension or array."""
    within("dimension", count, "the algebra has dimension {}")
    require_room(count, size)


def require_room(count: int, size: int, hint: str = "") -> None:
    """Raise `LimitError` if `count` dense matrices (size, size) need too much memory; `hint` says what helps."""
    needed = BYTES * count * size**2
    if needed > current_limits().memory:
        # the logarithm of an integer of any length is a float; the integer itself may be too large
        gigabytes = f"{needed / 1e9:.3g}" if needed < 10**16 else f"about 10^{int(log10(needed)) - 9}"
        dimension = str(size) if size < 10**15 else f"about 10^{int(log10(size))}"
        hint = f"; {hint}" if hint else ""
        what = f"{displayed(count)} dense matrices of size {dimension} are {gigabytes} GB{hint}: {{}} bytes"
        within("memory", needed, what)


def require_nonzero(name: str, values: Sequence[int]) -> None:
    """Raise `InputError` unless all entries are non-zero integers."""
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value == 0:
            raise InputError(f"the entries of {name} must be non-zero integers; got {displayed(list(values))}")


# Multiplication tables of the quadratic, quaternion and octonion algebras over Q, by Cayley-Dickson doubling.
# Starting from Q, each parameter c doubles the algebra:
#
#     (a, b)(a', b') = (a a' + c conj(b') b,  b' a + b conj(a')),   conj(a, b) = (conj(a), -b).
#
# So (-1,) gives C, (-1, -1) the quaternions, (a, b) the quaternion algebra with i^2 = a and j^2 = b, (-1, -1, -1) the
# octonions and (-1, -1, 1) the split octonions. A table t of shape (m, m, m) holds e_i e_j = sum_k t[i, j, k] e_k. The
# identity is e_0, and every e_i e_j is a multiple of one basis element.

OCTONIONS = (-1, -1, -1)
SPLIT_OCTONIONS = (-1, -1, 1)


def cayley_dickson(parameters: Sequence[int]) -> IntegerArray:
    """Multiplication table (m, m, m) of the composition algebra with given doubling parameters."""
    require_nonzero("parameters", parameters)
    if len(parameters) > 3:
        raise InputError(f"a composition algebra has at most 3 parameters; got {len(parameters)}")
    table: IntegerArray = np.ones((1, 1, 1), dtype=np.int64)
    for parameter in parameters:
        table = _double(table, parameter)
    return table


def conjugation(table: ArrayLike) -> IntegerArray:
    """Diagonal of the conjugation, shape (m,): 1 for the identity, -1 for the imaginary units."""
    signs = -np.ones(len(np.asarray(table)), dtype=np.int64)
    signs[0] = 1
    return signs


def norm_diagonal(table: ArrayLike) -> IntegerArray:
    """Diagonal of the norm form ``n(e_i) = e_i conj(e_i)``, shape (m,); the basis is orthogonal for it."""
    return np.diagonal(np.asarray(table, dtype=np.int64)[:, :, 0]) * conjugation(table)


def left_multiplications(table: ArrayLike) -> IntegerArray:
    """Matrices of ``x -> e_i x``, shape (m, m, m), first axis i."""
    return np.asarray(table, dtype=np.int64).transpose(0, 2, 1).copy()


def right_multiplications(table: ArrayLike) -> IntegerArray:
    """Matrices of ``x -> x e_i``, (m, m, m), first axis i; they commute with left ones if x (y z) = (x y) z."""
    return np.asarray(table, dtype=np.int64).transpose(1, 2, 0).copy()


def _double(table: IntegerArray, parameter: int) -> IntegerArray:
    """The table (2m, 2m, 2m) of the Cayley-Dickson double."""
    m, signs = len(table), conjugation(table)
    double = np.zeros((2 * m, 2 * m, 2 * m), dtype=np.int64)
    double[:m, :m, :m] = table
    double[:m, m:, m:] = table.transpose(1, 0, 2)  # (a, 0)(0, b') = (0, b' a)
    double[m:, :m, m:] = table * signs[None, :, None]  # (0, b)(a', 0) = (0, b conj(a'))
    double[m:, m:, :m] = parameter * table.transpose(1, 0, 2) * signs[None, :, None]  # (c conj(b') b, 0)
    return double


# The linear Lie algebras gl and sl over R, C and H, as real integer matrices.
# C^n is R^{2n} and H^n is R^{4n}, coordinate by coordinate: the entry q at (i, j) is the block E_ij (x) L_q, L_q the
# left multiplication by q. The right multiplications by scalars, with which all of these commute, span a u(1) over C
# and an sp(1) over H: `scalars` adjoins imaginary ones, so ``quaternionic_sl(n, scalars=3)`` is sl(n,H) + sp(1). With
# parameters other than -1 these are algebras over Q(sqrt(c)) and over the quaternion algebra (a, b) over Q, such as
# (-1, 3), a division algebra over Q that splits over R.


def gl(n: int) -> IntegerArray:
    """Basis of gl(n, R): all elementary matrices, row by row."""
    return _gl_over(n, cayley_dickson(()))


def sl(n: int) -> IntegerArray:
    """Basis of sl(n, R): the E_ij with i != j, then the E_ii - E_{i+1,i+1}."""
    return _sl_over(n, cayley_dickson(()))


def triangular(n: int, above: int = 0) -> IntegerArray:
    """Basis of the upper triangular matrices in gl(n, R): the E_ij with j - i >= `above`, row by row."""
    require_size("n", n)
    require_basis(n * (n + 1) // 2, n)
    return stack((unit(n, i, j) for i in range(n) for j in range(i + above, n)), n)


def motions(linear: IntegerArray) -> IntegerArray:
    """Basis of h + R^N in gl(N + 1) for a basis of h in gl(N), then the translations: (A, v) is [[A, v], [0, 0]]."""
    size = linear.shape[1]
    require_basis(len(linear) + size, size + 1)
    return np.concatenate([np.pad(linear, ((0, 0), (0, 1), (0, 1))), [unit(size + 1, i, size) for i in range(size)]])


def galilei(n: int) -> IntegerArray:
    """Basis of the Galilei algebra on the vectors (x, t, 1): rotations, boosts, translations, time translation."""
    rotations = np.pad(so(n), ((0, 0), (0, 2), (0, 2)))
    shifts = [unit(n + 2, i, column) for column in (n, n + 1) for i in range(n)]
    return np.concatenate([rotations, [*shifts, unit(n + 2, n, n + 1)]])


def heisenberg(n: int) -> IntegerArray:
    """Basis of the Heisenberg algebra on R^{n+2}: the x_i in the first row, the y_i in the last column, z in both."""
    require_basis(2 * n + 1, n + 2)
    rows, columns = ([unit(n + 2, 0, i + 1) for i in range(n)], [unit(n + 2, i + 1, n + 1) for i in range(n)])
    return stack([*rows, *columns, unit(n + 2, 0, n + 1)], n + 2)


def complex_gl(n: int, *, parameter: int = -1) -> IntegerArray:
    """Basis of gl(n, C), or of gl(n) over Q(sqrt(parameter)), on R^{2n}."""
    return complexify(gl(n), parameter=parameter)


def complex_sl(n: int, *, scalars: int = 0, parameter: int = -1) -> IntegerArray:
    """Basis of sl(n, C) on R^{2n}; with ``scalars=1`` of sl(n, C) + u(1), the complex structure last."""
    return with_complex_scalars(complexify(sl(n), parameter=parameter), scalars, parameter=parameter)


def quaternionic_gl(n: int, *, parameters: tuple[int, int] = (-1, -1)) -> IntegerArray:
    """Basis of gl(n, H), or of gl(n) over another quaternion algebra over Q, on R^{4n}."""
    return _gl_over(n, quaternion_table(parameters))


def quaternionic_sl(n: int, *, scalars: int = 0, parameters: tuple[int, int] = (-1, -1)) -> IntegerArray:
    """Basis of sl(n, H) on R^{4n}; with commuting scalars of sl(n, H) + u(1) or sl(n, H) + sp(1).

    The real (reduced) trace vanishes. With ``scalars=3, parameters=(-1, 3)`` and n = 2
    this is a form over Q of sl(4, R) + sl(2, R) on R^8.
    """
    return with_quaternion_scalars(_sl_over(n, quaternion_table(parameters)), scalars, parameters=parameters)


def complexify(matrices: ArrayLike, *, parameter: int = -1) -> IntegerArray:
    """Real matrices of the complex span of a family: A and i A for each A, shape (2 dim, 2n, 2n)."""
    basis = as_matrices(matrices)
    require_basis(2 * len(basis), 2 * basis.shape[1])
    units = left_multiplications(cayley_dickson((parameter,)))
    return stack((np.kron(a, u) for a in basis for u in units), 2 * basis.shape[1])


def complex_structure(n: int, *, parameter: int = -1) -> IntegerArray:
    """Matrix of the multiplication by i on C^n = R^{2n}, shape (2n, 2n); it commutes with gl(n, C)."""
    require_size("n", n)
    return np.kron(np.eye(n, dtype=np.int64), left_multiplications(cayley_dickson((parameter,)))[1])


def quaternion_scalars(n: int, *, parameters: tuple[int, int] = (-1, -1)) -> IntegerArray:
    """Right multiplications by i, j, k on H^n = R^{4n}, a basis of the sp(1) that commutes with gl(n, H)."""
    require_size("n", n)
    units = right_multiplications(quaternion_table(parameters))[1:]
    return stack((np.kron(np.eye(n, dtype=np.int64), u) for u in units), 4 * n)


def with_complex_scalars(family: IntegerArray, scalars: int, *, parameter: int = -1) -> IntegerArray:
    """The family on R^{2n}, followed by the complex structure if ``scalars`` is 1."""
    if scalars not in (0, 1):
        raise InputError(f"over C there are 0 or 1 (for u(1)) commuting scalars; got {displayed(scalars)}")
    structure = complex_structure(family.shape[1] // 2, parameter=parameter)
    return join(family, structure[None]) if scalars else family


def with_quaternion_scalars(
    family: IntegerArray, scalars: int, *, parameters: tuple[int, int] = (-1, -1)
) -> IntegerArray:
    """The family on R^{4n}, followed by 0, 1 (for u(1)) or 3 (for sp(1)) right multiplications."""
    if scalars not in (0, 1, 3):
        raise InputError(
            f"over H there are 0, 1 (for u(1)) or 3 (for sp(1)) commuting scalars; got {displayed(scalars)}"
        )
    return join(family, quaternion_scalars(family.shape[1] // 4, parameters=parameters)[:scalars])


def quaternion_table(parameters: tuple[int, int]) -> IntegerArray:
    """Multiplication table (4, 4, 4) of the quaternion algebra over Q with given i^2 and j^2."""
    if len(parameters) != 2:
        raise InputError(f"a quaternion algebra has two parameters, i^2 and j^2; got {displayed(list(parameters))}")
    return cayley_dickson(parameters)


def _gl_over(n: int, table: IntegerArray) -> IntegerArray:
    """Basis of gl(n) over the algebra: all E_ij (x) L_q."""
    require_size("n", n)
    units = left_multiplications(table)
    require_basis(n * n * len(units), n * len(units))
    return stack((np.kron(unit(n, *ij), u) for ij in np.ndindex(n, n) for u in units), n * len(units))


def _sl_over(n: int, table: IntegerArray) -> IntegerArray:
    """Basis of sl(n): E_ij (x) L_q for i != j, E_ii (x) L_q for imaginary units q, differences of the E_ii (x) 1."""
    require_size("n", n)
    units = left_multiplications(table)
    require_basis(n * n * len(units) - 1, n * len(units))
    off = [np.kron(unit(n, i, j), u) for i, j in np.ndindex(n, n) if i != j for u in units]
    imaginary = [np.kron(unit(n, i, i), u) for i in range(n) for u in units[1:]]
    real = [np.kron(unit(n, i, i) - unit(n, i + 1, i + 1), units[0]) for i in range(n - 1)]
    return stack([*off, *imaginary, *real], n * len(units))


# Matrix bases of the Lie algebras that preserve a form: orthogonal, unitary and symplectic over R, C and H.
# For a diagonal form D over R, C or H the condition X* D + D X = 0 reads conj(x_ji) d_j + d_i x_ij = 0, so that
#
#     d_i q E_ji - d_j conj(q) E_ij  (i < j, q a unit)   and   q E_ii  (q an imaginary unit)
#
# are a basis. This covers so(p,q), u(p,q) and sp(p,q). A complex or quaternionic entry is a real block, as
# above.


def so(p: int, q: int = 0) -> IntegerArray:
    """Basis of so(p, q), which preserves diag(1, ..., 1, -1, ..., -1) with p ones and q minus ones."""
    return orthogonal(_signs(p, q))


def orthogonal(diagonal: Sequence[int]) -> IntegerArray:
    """Basis of the orthogonal algebra of the quadratic form ``sum_i diagonal[i] x_i**2``."""
    return _skew_hermitian(diagonal, cayley_dickson(()))


def u(p: int, q: int = 0) -> IntegerArray:
    """Basis of u(p, q) on C^{p+q} = R^{2(p+q)}."""
    return _skew_hermitian(_signs(p, q), cayley_dickson((-1,)))


def su(p: int, q: int = 0) -> IntegerArray:
    """Basis of su(p, q) on C^{p+q} = R^{2(p+q)}, the elements of u(p, q) of complex trace zero."""
    unitary, n = u(p, q), p + q
    imaginary = complexify(stack((unit(n, i, i) - unit(n, i + 1, i + 1) for i in range(n - 1)), n))[1::2]
    return np.concatenate([unitary[n:], imaginary])


def quaternionic_u(p: int, q: int = 0, *, scalars: int = 0) -> IntegerArray:
    """Basis of sp(p, q), unitary on H^{p+q} = R^{4(p+q)}, with commuting scalars; sp(n) is ``quaternionic_u(n)``."""
    return with_quaternion_scalars(_skew_hermitian(_signs(p, q), cayley_dickson((-1, -1))), scalars)


def so_star(n: int) -> IntegerArray:
    """Basis of so*(2n) on H^n = R^{4n}, the matrices with X* j + j X = 0.

    The condition is ``x_ij = j conj(x_ji) j``: on the diagonal only j itself satisfies it.
    """
    require_size("n", n)
    require_basis(n * (2 * n - 1), 4 * n)
    _, _, j, _ = units = left_multiplications(cayley_dickson((-1, -1)))
    diagonal = [np.kron(unit(n, i, i), j) for i in range(n)]
    pairs = combinations(range(n), 2)
    off = [np.kron(unit(n, a, b), q) + np.kron(unit(n, b, a), j @ q.T @ j) for a, b in pairs for q in units]
    return stack([*diagonal, *off], 4 * n)


def sp(n: int) -> IntegerArray:
    """Basis of sp(2n, R) on R^{2n}, which preserves the skew-symmetric form [[0, 1], [-1, 0]]."""
    require_size("n", n)
    size = 2 * n
    require_basis(n * (size + 1), size)
    linear = [unit(size, i, j) - unit(size, n + j, n + i) for i, j in np.ndindex(n, n)]
    pairs = combinations_with_replacement(range(n), 2)
    upper = [unit(size, i, n + j) + (i != j) * unit(size, j, n + i) for i, j in pairs]
    return stack([*linear, *upper, *(matrix.T for matrix in upper)], size)


def complex_so(n: int) -> IntegerArray:
    """Basis of so(n, C) on C^n = R^{2n}, over R."""
    require_size("n", n)
    return complexify(so(n))


def complex_sp(n: int, *, scalars: int = 0) -> IntegerArray:
    """Basis of sp(2n, C) on C^{2n} = R^{4n}, over R; with ``scalars=1`` the complex structure comes last."""
    return with_complex_scalars(complexify(sp(n)), scalars)


def _signs(p: int, q: int) -> list[int]:
    """The list of p ones and q minus ones, p and q checked."""
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_size("p + q", p + q)
    return [1] * p + [-1] * q


def _skew_hermitian(diagonal: Sequence[int], table: IntegerArray) -> IntegerArray:
    """Basis of {X : X* D + D X = 0} over the algebra: imaginary diagonal entries, then the pairs i < j."""
    require_size("the number of diagonal entries", len(diagonal))
    require_nonzero("diagonal", diagonal)
    n = len(diagonal)
    units = left_multiplications(table)
    require_basis(n * (len(units) * (n + 1) - 2) // 2, n * len(units))
    on = [np.kron(unit(n, i, i), q) for q in units[1:] for i in range(n)]
    d = [int(value) * (1 if diagonal[0] > 0 else -1) for value in diagonal]
    off = [
        primitive(d[i] * np.kron(unit(n, j, i), q) - d[j] * sign * np.kron(unit(n, i, j), q))
        for i, j in combinations(range(n), 2)
        for q, sign in zip(units, conjugation(table), strict=True)
    ]
    return stack([*on, *off], n * len(units))


# Matrix bases on tensor products, symmetric and exterior powers, and symmetric matrices.
# A acts on V (x) V by A (x) 1 + 1 (x) A. This induces the actions on Sym^k and Lambda^k, which are written in the bases
# of monomials and of wedge products.


def tensor_sum(first: ArrayLike, second: ArrayLike) -> IntegerArray:
    """Basis of the sum of two linear Lie algebras on the tensor product: all A (x) 1, then all 1 (x) B."""
    left, right = as_matrices(first), as_matrices(second)
    p, q = left.shape[1], right.shape[1]
    require_basis(len(left) + len(right), p * q)
    one_p, one_q = np.eye(p, dtype=np.int64), np.eye(q, dtype=np.int64)
    return stack([*(np.kron(a, one_q) for a in left), *(np.kron(one_p, b) for b in right)], p * q)


def symmetric_power(matrices: ArrayLike, k: int) -> IntegerArray:
    """Action on Sym^k, the polynomials of degree k in the basis vectors, in lexicographic monomials."""
    basis = as_matrices(matrices)
    require_size("k", k, 0)
    n = basis.shape[1]
    require_basis(len(basis), comb(n + k - 1, k) if n else 1)
    return _induced(basis, list(combinations_with_replacement(range(n), k)), alternating=False)


def exterior_power(matrices: ArrayLike, k: int) -> IntegerArray:
    """Action on Lambda^k, in the basis of the wedges ``e_i1 ^ ... ^ e_ik``, i1 < ... < ik, lexicographically."""
    basis = as_matrices(matrices)
    require_size("k", k, 0)
    n = basis.shape[1]
    if k > n:
        raise InputError(f"Lambda^k of a space of dimension {n} needs k <= {n}; got k = {k}")
    require_basis(len(basis), comb(n, k))
    return _induced(basis, list(combinations(range(n), k)), alternating=True)


def congruence(matrices: ArrayLike) -> IntegerArray:
    """Action ``S -> A S + S A^T`` on symmetric matrices; for skew-symmetric A the conjugation ``S -> A S - S A``."""
    basis = as_matrices(matrices)
    n = basis.shape[1]
    rows, columns = np.triu_indices(n)
    m = len(rows)
    require_basis(len(basis), m)
    within("memory", BYTES * len(basis) * m * n * n, "the images of symmetric matrices need {} bytes")
    elements = np.zeros((m, n, n), dtype=np.int64)
    elements[np.arange(m), rows, columns] = elements[np.arange(m), columns, rows] = 1
    images = basis[:, None] @ elements
    images = images + images.transpose(0, 1, 3, 2)
    return np.ascontiguousarray(images[:, :, rows, columns].transpose(0, 2, 1))


def companion_powers(coefficients: Sequence[int]) -> IntegerArray:
    """Regular representation of Q[t]/(f): the powers 1, C, ..., C^{n-1} of the companion matrix C of f."""
    n = len(coefficients)
    if n == 0:
        raise InputError("the polynomial must have degree at least 1; got no coefficient")
    require_basis(n, n)
    size = 1 + max(abs(int(c)) for c in coefficients)
    if n * size.bit_length() > 62:
        raise InputError("the powers of the companion matrix have entries of more than 63 bits; use smaller numbers")
    companion: IntegerArray = np.eye(n, k=-1, dtype=np.int64)
    companion[:, -1] = -np.asarray(coefficients, dtype=np.int64)
    return stack((np.linalg.matrix_power(companion, k) for k in range(n)), n)


def _induced(basis: IntegerArray, words: list[tuple[int, ...]], *, alternating: bool) -> IntegerArray:
    """The derived action on words in the basis vectors, a sum over the letters: e_i becomes sum_j A[j, i] e_j."""
    n = basis.shape[1]
    position = {word: row for row, word in enumerate(words)}
    result = np.zeros((len(basis), len(words), len(words)), dtype=np.int64)
    for column, word in enumerate(words):
        for index, letter in enumerate(word):
            for new in range(n):
                image = [*word[:index], new, *word[index + 1 :]]
                row = position.get(tuple(sorted(image)))
                if row is not None:
                    sign = _sorting_sign(image, index) if alternating else 1
                    result[:, row, column] += sign * basis[:, new, letter]
    return result


def _sorting_sign(word: list[int], index: int) -> int:
    """Sign of the permutation that sorts a word in which only the letter at `index` is out of order."""
    wrong = [other > word[index] for other in word[:index]] + [other < word[index] for other in word[index + 1 :]]
    return -1 if sum(wrong) % 2 else 1
