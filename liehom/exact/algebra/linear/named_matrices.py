"""Matrix bases on octonions, the Albert algebra and spinors, all bases by name, and the matrices of physics."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import reduce
from itertools import combinations, pairwise
from numbers import Integral
from typing import Literal

import numpy as np

from liehom.base.budget import within
from liehom.base.errors import CatalogError, InputError, LiehomError, displayed
from liehom.base.typing import Expression, IntegerArray, ScalarLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.linear import linear_bases
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.linear.linear_bases import (
    OCTONIONS,
    SPLIT_OCTONIONS,
    cayley_dickson,
    conjugation,
    left_multiplications,
    norm_diagonal,
    primitive,
    require_basis,
    require_room,
    require_size,
    stack,
    unit,
)
from liehom.exact.scalars.rational import QQ

# Matrix bases of the Lie algebras of the octonions: g2 on the imaginary octonions, spin(7) on all octonions.
# Let w_ab(x) = e_a <e_b, x> - e_b <e_a, x>. Then so(Im O) is Lambda^2 Im O, and the derivations are the kernel of the
# equivariant map e_a ^ e_b -> Im(e_a e_b). Its part over the imaginary unit e_l consists of the combinations of the
# three w_ab with e_a e_b = s_ab e_l whose coefficients c_ab satisfy sum c_ab s_ab = 0.
#
# The products L_a L_b (a < b) of left multiplications span spin(7), and g2 is the stabilizer of 1 in spin(7).


def g2(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of g2 on R^7, the derivations of the octonions on their imaginary part."""
    table = octonion_table(parameters)
    norm = norm_diagonal(table)
    rotations = {
        (a, b): norm[b] * unit(7, a - 1, b - 1) - norm[a] * unit(7, b - 1, a - 1)
        for a, b in combinations(range(1, 8), 2)
    }
    basis = []
    for target in range(1, 8):
        planes = [(table[a, b, target], w) for (a, b), w in rotations.items() if table[a, b, target]]
        basis += [primitive(t * first - s * second) for (s, first), (t, second) in pairwise(planes)]
    return stack(basis, 7)


def octonion_spin(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of spin(7) or spin(4, 3) on R^8 = O: products of two left multiplications by imaginary units."""
    left = left_multiplications(octonion_table(parameters))
    return stack((left[a] @ left[b] for a, b in combinations(range(1, 8), 2)), 8)


def octonion_table(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Multiplication table (8, 8, 8) of the octonion algebra with the given doubling parameters."""
    if len(parameters) != 3:
        raise InputError(f"an octonion algebra has three doubling parameters; got {list(parameters)!r}")
    return cayley_dickson(parameters)


# Matrix bases of f4 and e6 on the Albert algebra, the hermitian 3 x 3 matrices over the octonions.
# For signs (g1, g2, g3) the matrices with X_ij = g_i g_j conj(X_ji) form a Jordan algebra with the product L_X Y = X o
# Y = (XY + YX) / 2. The commutators [L_X, L_Y] span the derivations, f4. Together with the L_X of trace zero they span
# e6, which preserves the cubic norm. Coordinates are X_11, X_22, X_33, X_23, X_31, X_12 in R^{3 + 8 + 8 + 8}. The
# first three basis vectors E_1, E_2, E_3 are orthogonal primitive idempotents.

_DIMENSION = 27
_OFF_DIAGONAL = ((1, 2), (2, 0), (0, 1))


def albert_product(
    signs: tuple[int, int, int] = (1, 1, 1), *, parameters: tuple[int, int, int] = OCTONIONS
) -> IntegerArray:
    """Structure constants of twice the Jordan product: ``2 e_i o e_j = sum_k table[i, j, k] e_k``."""
    table = octonion_table(parameters)
    basis = _hermitian_basis(signs, conjugation(table))
    half = np.einsum("xija,abc->xijbc", basis, table)
    products = np.einsum("xijbc,yjkb->xyikc", half, basis, optimize=True)
    doubled = products + products.transpose(1, 0, 2, 3, 4)
    diagonal = doubled[:, :, range(3), range(3), 0]
    return np.concatenate([diagonal, *(doubled[:, :, i, j] for i, j in _OFF_DIAGONAL)], axis=2)


def f4(signs: tuple[int, int, int] = (1, 1, 1), *, parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of f4 on R^27, the derivations of the Albert algebra, which annihilate E_1 + E_2 + E_3.

    Let x_k(e) be the element whose k-th off-diagonal entry is e. The basis is [L_{x_1(e_i)}, L_{x_1(e_j)}]
    (i < j), an so(8), followed by [L_{E_{k+1}}, L_{x_k(e_i)}] for k = 1, 2, 3.
    """
    doubled = albert_product(signs, parameters=parameters).transpose(0, 2, 1)  # 2 L_x for the basis vectors x
    pairs = [(3 + i, 3 + j) for i, j in combinations(range(8), 2)]
    pairs += [((k + 1) % 3, 3 + 8 * k + i) for k in range(3) for i in range(8)]
    return stack((primitive(doubled[x] @ doubled[y] - doubled[y] @ doubled[x]) for x, y in pairs), _DIMENSION)


def e6(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of e6 on R^27, the linear maps that preserve the cubic norm of the Albert algebra."""
    doubled = albert_product(parameters=parameters).transpose(0, 2, 1)  # 2 L_x for the basis vectors x
    traceless = [doubled[0] - doubled[1], doubled[1] - doubled[2], *doubled[3:]]
    return np.concatenate([f4(parameters=parameters), stack(map(primitive, traceless), _DIMENSION)])


def albert_idempotent(k: int) -> IntegerArray:
    """Coordinates of the primitive idempotent E_k, k = 1, 2 or 3."""
    if k not in (1, 2, 3):
        raise InputError(f"the primitive idempotents are numbered 1, 2, 3; got {displayed(k)}")
    return np.eye(_DIMENSION, dtype=np.int64)[k - 1]


def _hermitian_basis(signs: tuple[int, int, int], conjugate: IntegerArray) -> IntegerArray:
    """The 27 basis matrices as octonion entries, shape (27, 3, 3, 8)."""
    if len(signs) != 3 or any(sign not in (1, -1) for sign in signs):
        raise InputError(f"three signs 1 or -1 are needed; got {list(signs)!r}")
    basis = np.zeros((_DIMENSION, 3, 3, 8), dtype=np.int64)
    basis[range(3), range(3), range(3), 0] = 1
    for k, (i, j) in enumerate(_OFF_DIAGONAL):
        block = basis[3 + 8 * k : 11 + 8 * k]
        block[:, i, j] = np.eye(8)
        block[:, j, i] = np.diag(signs[i] * signs[j] * conjugate)
    return basis


# Matrix bases of the real spin representations of spin(p, q), by signed permutation matrices.
# Clifford generators of signature (p, q) are anticommuting matrices, p of square 1 and then q of square -1, here on an
# irreducible module. They are built from the left multiplications of C, H, O by the steps
#
#     (p+1, q+1): g (x) sz, 1 (x) sx, 1 (x) ep        (n+2, 0) from (0, n): g (x) ep, 1 (x) sx, 1 (x) sz
#     (0, n+8): g (x) w, 1 (x) G                       with G of signature (0, 8) and w their product,
#
# where sx and sz are the symmetric Pauli matrices and ep is the skew-symmetric one. The products e_i e_j (i < j) of
# generators of signature (p, q) span spin(p, q). The e_i e_n generate the even Clifford algebra, and they are Clifford
# generators of signature (p, q-1) or (q, p-1). So the generators g_i of that signature and their products g_i g_j span
# the half-spin or spin representation.

_SX: IntegerArray = np.array([[0, 1], [1, 0]], dtype=np.int64)
_SZ: IntegerArray = np.array([[1, 0], [0, -1]], dtype=np.int64)
_EP: IntegerArray = np.array([[0, -1], [1, 0]], dtype=np.int64)


def clifford(p: int, q: int) -> IntegerArray:
    """Clifford generators on an irreducible module: anticommuting signed permutation matrices (p + q, N, N)."""
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_room(p + q, 2 ** ((p + q) // 2))
    common = min(p, q)
    start = _positive(p - common) if p > q else _negative(q - common)
    plus, minus = [*start[: p - common]], [*start[p - common :]]
    for _ in range(common):
        one = np.eye(_size(plus, minus), dtype=np.int64)
        plus = [np.kron(g, _SZ) for g in plus] + [np.kron(one, _SX)]
        minus = [np.kron(g, _SZ) for g in minus] + [np.kron(one, _EP)]
    return stack([*plus, *minus], _size(plus, minus))


def spin(p: int, q: int = 0, *, chirality: int = 1) -> IntegerArray:
    """Basis of spin(p, q) on its real spin representation, or on one of its two half-spin representations."""
    require_size("p", p, 0)
    require_size("q", q, 0)
    require_size("p + q", p + q, 2)
    if chirality not in (1, -1):
        raise InputError(f"chirality must be 1 or -1; got {displayed(chirality)}")
    generators = chirality * (clifford(p, q - 1) if q else clifford(0, p - 1))
    require_basis(len(generators) * (len(generators) + 1) // 2, generators.shape[1])
    return stack([*generators, *(a @ b for a, b in combinations(generators, 2))], generators.shape[1])


def _size(*families: list[IntegerArray]) -> int:
    """Size of the matrices; 1 if there are none."""
    return next((len(matrix) for family in families for matrix in family), 1)


def _positive(n: int) -> IntegerArray:
    """Generators of signature (n, 0)."""
    if n <= 1:
        return np.ones((n, 1, 1), dtype=np.int64)
    base = _negative(n - 2)
    one = np.eye(base.shape[1], dtype=np.int64)
    return stack([*(np.kron(g, _EP) for g in base), np.kron(one, _SX), np.kron(one, _SZ)], 2 * base.shape[1])


def _negative(n: int) -> IntegerArray:
    """Generators of signature (0, n)."""
    if n == 0:
        return stack([], 1)
    if n <= 7:
        return left_multiplications(cayley_dickson(OCTONIONS[: n.bit_length()]))[1 : n + 1]
    eight = [*(np.kron(g, _SX) for g in _negative(7)), np.kron(np.eye(8, dtype=np.int64), _EP)]
    volume, base = reduce(np.matmul, eight), _negative(n - 8)
    one = np.eye(base.shape[1], dtype=np.int64)
    return stack([*(np.kron(g, volume) for g in base), *(np.kron(one, g) for g in eight)], 16 * base.shape[1])


# The bases of classical and exceptional linear Lie algebras by name: one table for constructors and catalogue.
# The second parameter of a classical name is a number or a letter. A number q stands for a form of signature (p, q),
# and 'R', 'C' or 'H' for the scalars.
#
# ==========  =====================================  ==========================
# gl, sl      (n), (n, 'C'), (n, 'H')                on R^n, R^2n, R^4n
# so          (p), (p, q), (n, 'C')                  on R^(p+q), R^2n
# su, u       (p), (p, q)                            on R^2(p+q)
# sp          (p), (p, q) compact and indefinite     on R^4(p+q)
# sp          (2n, 'R'), (2n, 'C') split             on R^2n, R^4n
# spin        (p), (p, q)                            on the spin representation
# ==========  =====================================  ==========================
#
# So 'sp(3)' is the compact quaternionic algebra of dimension 21, and 'sp(4,R)' has *size* 4 and rank 2.

Parameter = int | str


SPELLINGS = {
    "schrodinger": "schroedinger", "poincare": "iso", "euclidean": "e", "se": "e", "o": "so", "galilean": "galilei",
}  # fmt: skip
"""Other spellings of heads of names."""


def spelled(name: str) -> str:
    """A name without '+' in the usual spelling; a head alone stays as it is, since E6 is a type and e6 a real form."""
    head, bracket, rest = name.replace(" ", "").partition("(")
    return f"{SPELLINGS.get(head.lower(), head.lower())}({rest.upper()}" if bracket else head


def classical_matrices(kind: str, first: int, second: Parameter = 0) -> IntegerArray:
    """The matrix basis of a classical linear Lie algebra, shape (dim, N, N)."""
    sizes: list[object] = [first] if isinstance(second, str) else [first, second]
    for size in sizes:
        if not isinstance(size, Integral):
            raise InputError(f"{kind}(n, m) takes integers, got {displayed(first)} and {displayed(second)}")
        within("dimension", abs(int(size)), "a parameter of the family is {}")
    if not isinstance(second, str) and kind in _FORMS:
        return _FORMS[kind](first, second)
    build = _BY_LETTER.get((kind, "R" if second == 0 else str(second)))
    if build is None:
        known = ", ".join(sorted(CLASSICAL_KINDS))
        raise InputError(f"there is no {kind}({first},{second}); the kinds are {known}, the scalars R, C, H")
    return build(first)


def exceptional_matrices(form: str) -> IntegerArray:
    """The matrix basis of an exceptional real form by its name, shape (dim, N, N)."""
    if form not in EXCEPTIONAL_MATRICES:
        known = ", ".join(EXCEPTIONAL_MATRICES)
        raise CatalogError(f"{form!r} has no construction by matrices here; known: {known}; see also lh.simple")
    return EXCEPTIONAL_MATRICES[form]()


def classical_name(kind: str, first: int, second: Parameter = 0) -> str:
    """The printed name of a classical algebra, without parameters that are the default."""
    silent = second == 0 or (second == "R" and kind in ("gl", "sl"))
    return f"{kind}({first})" if silent else f"{kind}({first},{second})"


def linear_lie_algebra(matrices: IntegerArray, name: str | None = None) -> LieAlgebra:
    """The Lie algebra over QQ with a matrix basis that is closed under commutators."""
    within("dimension", len(matrices), "the algebra has dimension {}")
    if len(matrices) == 0:
        return LieAlgebra(StructureConstants(QQ, 0, []), name=name, check=False)  # no bracket, nothing to prove
    return lie_closure(matrices, close=False, name=name).algebra


def _half(build: Callable[[int], IntegerArray]) -> Callable[[int], IntegerArray]:
    """From a builder that takes the rank n, the builder that takes the size 2n."""

    def by_size(size: int) -> IntegerArray:
        if size % 2:
            raise InputError(f"sp(2n,R), sp(2n,C) and so*(2n) are named by their even size 2n; got {size}")
        return build(size // 2)

    return by_size


_FORMS: dict[str, Callable[[int, int], IntegerArray]] = {
    "so": linear_bases.so,
    "su": linear_bases.su,
    "u": linear_bases.u,
    "sp": linear_bases.quaternionic_u,
    "spin": spin,
}

_BY_LETTER: dict[tuple[str, str], Callable[[int], IntegerArray]] = {
    ("gl", "R"): linear_bases.gl, ("gl", "C"): linear_bases.complex_gl, ("gl", "H"): linear_bases.quaternionic_gl,
    ("sl", "R"): linear_bases.sl, ("sl", "C"): linear_bases.complex_sl, ("sl", "H"): linear_bases.quaternionic_sl,
    ("so", "R"): linear_bases.so, ("so", "C"): linear_bases.complex_so, ("sp", "R"): _half(linear_bases.sp),
    ("sp", "C"): _half(linear_bases.complex_sp),
}  # fmt: skip

CLASSICAL_KINDS = frozenset({kind for kind, _ in _BY_LETTER} | _FORMS.keys())
"""All kinds that `classical_matrices` accepts."""

FAMILY_MATRICES: dict[str, Callable[..., IntegerArray]] = {
    "e": lambda n: linear_bases.motions(linear_bases.so(n)),
    "iso": lambda p, q: linear_bases.motions(linear_bases.so(p, q)),
    "aff": lambda n: linear_bases.motions(linear_bases.gl(n)),
    "galilei": linear_bases.galilei,
    "so*": _half(linear_bases.so_star),
    "upper": linear_bases.triangular,
    "strict": lambda n: linear_bases.triangular(n, 1),
}
"""Builders of the matrices of algebras that have no scalars in their names, by the heads of the names."""

EXCEPTIONAL_MATRICES: dict[str, Callable[[], IntegerArray]] = {
    "g2(2)": lambda: g2(SPLIT_OCTONIONS), "g2": g2, "f4(4)": lambda: f4(parameters=SPLIT_OCTONIONS), "f4": f4,
    "f4(-20)": lambda: f4((-1, 1, 1)), "e6(6)": lambda: e6(SPLIT_OCTONIONS), "e6(-26)": e6,
}  # fmt: skip
"""Builders of the matrix bases of exceptional real forms, by name."""


# Complex matrices of physics, exact: Pauli, Gell-Mann, Dirac and spin matrices, as matrices of sympy.
# The matrices are Hermitian (the Dirac matrices are gamma^0 only). Physicists write [A, B] = i C for Hermitian A, B, C;
# the real Lie algebra consists of the skew-Hermitian i A, which ``hermitian=True`` of `LieAlgebra.from_matrices` and
# `Representation.from_matrices` builds. Square roots in the entries make number fields, such as QQ(sqrt(3)).

DiracBasis = Literal["dirac", "weyl", "majorana"]


def pauli_matrices() -> list[Expression]:
    """The Pauli matrices sigma_x, sigma_y, sigma_z, three sympy matrices (2, 2) with [sigma_x, sigma_y] = 2i sigma_z.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.LieAlgebra.from_matrices(pauli_matrices(), hermitian=True).real_form()  # su(2)
    'so(3)'
    """
    return gell_mann_matrices(2)


def gell_mann_matrices(n: int = 3, *, normalized: bool = True) -> list[Expression]:
    """The generalized Gell-Mann matrices, n^2 - 1 sympy matrices (n, n): a basis of the traceless Hermitian matrices.

    Parameters
    ----------
    n : int
        At least 1. For n = 2 they are the Pauli matrices, for n = 3 lambda_1, ..., lambda_8 in Gell-Mann's order.
    normalized : bool
        Normalize the diagonal matrices to tr(A A) = 2, which needs the square roots of l (l + 1) / 2 for 2 <= l < n
        (default). Otherwise they are diag(1, ..., 1, -l, 0, ..., 0), with integers only.

    Notes
    -----
    The order is E_jk + E_kj, -i E_jk + i E_kj for j < k, then the diagonal matrix of l = k, for k = 2, ..., n (indices
    from 1).

    Examples
    --------
    >>> import liehom as lh
    >>> gell_mann_matrices()[7]
    Matrix([
    [sqrt(3)/3,         0,            0],
    [        0, sqrt(3)/3,            0],
    [        0,         0, -2*sqrt(3)/3]])
    >>> lh.LieAlgebra.from_matrices(gell_mann_matrices(3), hermitian=True).real_form()
    'su(3)'
    """
    require_size("n", n)
    import sympy

    matrices = []
    for k in range(1, n):
        for j in range(k):
            units = [sympy.Matrix(n, n, lambda r, c, at=at: int((r, c) == at)) for at in ((j, k), (k, j))]
            matrices += [units[0] + units[1], sympy.I * (units[1] - units[0])]
        scale = sympy.sqrt(sympy.Rational(2, k * (k + 1))) if normalized else 1
        matrices.append(sympy.diag(*[scale] * k, -k * scale, *[0] * (n - k - 1)))
    return matrices


def dirac_matrices(basis: DiracBasis = "dirac") -> list[Expression]:
    """The Dirac matrices gamma^0, ..., gamma^3, sympy matrices (4, 4), with the metric (1, -1, -1, -1).

    The basis 'weyl' is the chiral one; in 'majorana' all entries are imaginary.

    gamma^a gamma^b + gamma^b gamma^a = 2 eta^ab. The matrices [gamma^a, gamma^b] / 4 span so(3, 1); all products of
    gamma matrices together span the Clifford algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> gamma = dirac_matrices("weyl")
    >>> spin = [(gamma[a] * gamma[b] - gamma[b] * gamma[a]) / 4 for a in range(4) for b in range(a)]
    >>> lh.LieAlgebra.from_matrices(spin).real_form()  # so(3, 1)
    'sl(2,C)'
    """
    import sympy

    x, y, z = pauli_matrices()
    one, zero = sympy.eye(2), sympy.zeros(2)

    def blocks(a: Expression, b: Expression, c: Expression, d: Expression) -> Expression:
        return sympy.Matrix(sympy.BlockMatrix([[a, b], [c, d]]))

    if basis == "majorana":
        i = sympy.I
        return [
            blocks(zero, y, y, zero),
            blocks(i * z, zero, zero, i * z),
            blocks(zero, -y, y, zero),
            blocks(-i * x, zero, zero, -i * x),
        ]
    first = {"dirac": blocks(one, zero, zero, -one), "weyl": blocks(zero, one, one, zero)}
    if basis not in first:
        raise InputError(f"the bases of the Dirac matrices are 'dirac', 'weyl' and 'majorana', got {displayed(basis)}")
    return [first[basis], *(blocks(zero, s, -s, zero) for s in (x, y, z))]


def spin_matrices(spin: ScalarLike) -> list[Expression]:
    """The angular momentum matrices J_x, J_y, J_z of spin j, such as 1 or "3/2", sympy matrices (2j + 1, 2j + 1).

    The basis is m = j, j - 1, ..., -j.

    [J_x, J_y] = i J_z, and J_x + i J_y maps the vector m to sqrt(j (j + 1) - m (m + 1)) times the vector m + 1.

    Examples
    --------
    >>> import liehom as lh
    >>> spin_matrices("1/2")[0]
    Matrix([
    [  0, 1/2],
    [1/2,   0]])
    >>> rho = lh.Representation.from_matrices(spin_matrices(1), hermitian=True)
    >>> rho.algebra.dimension, rho.isotropy([1, 0, 0]).dimension, rho.isotropy([0, 1, 0]).dimension
    (3, 0, 1)
    """
    import sympy

    try:
        number = QQ.convert(spin)
        j = Fraction(int(number.p), int(number.q))
    except LiehomError as error:
        raise InputError(
            f"a spin is an integer or half-integer such as 1 or '3/2', got {displayed(spin)}: {error}"
        ) from None
    if j < 0 or j.denominator > 2:
        raise InputError(f"a spin is an integer or half-integer at least 0 such as 1 or '3/2', got {displayed(spin)}")
    n = int(2 * j) + 1
    m = [sympy.Rational((j - k).numerator, (j - k).denominator) for k in range(n)]
    raising = sympy.zeros(n)
    for k in range(1, n):
        raising[k - 1, k] = sympy.sqrt(m[0] * (m[0] + 1) - m[k] * (m[k] + 1))
    return [(raising + raising.T) / 2, (raising - raising.T) / (2 * sympy.I), sympy.diag(*m)]
