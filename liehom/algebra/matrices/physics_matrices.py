"""Complex matrices of physics, exact: Pauli, Gell-Mann, Dirac and spin matrices, as matrices of sympy.

The matrices are Hermitian (the Dirac matrices are gamma^0 only). Physicists write [A, B] = i C for Hermitian A, B, C;
the real Lie algebra consists of the skew-Hermitian i A, which ``hermitian=True`` of `LieAlgebra.from_matrices` and
`Representation.from_matrices` builds. Square roots in the entries make number fields, such as QQ(sqrt(3)).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

from liehom.algebra.matrices.matrix_basis import require_size
from liehom.errors import InputError, LiehomError
from liehom.scalars import QQ
from liehom.typing import Expression, ScalarLike

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

    Raises
    ------
    InputError
        If n is not an integer at least 1.

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

    made = []
    for k in range(1, n):
        for j in range(k):
            made.append(sympy.Matrix(n, n, lambda r, c, j=j, k=k: int((r, c) in ((j, k), (k, j)))))
            made.append(
                sympy.Matrix(n, n, lambda r, c, j=j, k=k: sympy.I * (int((r, c) == (k, j)) - int((r, c) == (j, k))))
            )
        scale = sympy.sqrt(sympy.Rational(2, k * (k + 1))) if normalized else 1
        made.append(sympy.diag(*[scale] * k, -k * scale, *[0] * (n - k - 1)))
    return made


def dirac_matrices(basis: DiracBasis = "dirac") -> list[Expression]:
    """The Dirac matrices gamma^0, ..., gamma^3, sympy matrices (4, 4), with the metric (1, -1, -1, -1).

    Parameters
    ----------
    basis : {'dirac', 'weyl', 'majorana'}
        'weyl' is the chiral basis; in 'majorana' all entries are imaginary.

    Notes
    -----
    gamma^a gamma^b + gamma^b gamma^a = 2 eta^ab. The matrices [gamma^a, gamma^b] / 4 span so(3, 1); all products of
    gamma matrices together span the Clifford algebra.

    Raises
    ------
    InputError
        If the basis has another name.

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
        raise InputError(f"the bases of the Dirac matrices are 'dirac', 'weyl' and 'majorana', got {basis!r}")
    return [first[basis], *(blocks(zero, s, -s, zero) for s in (x, y, z))]


def spin_matrices(spin: ScalarLike) -> list[Expression]:
    """The angular momentum matrices J_x, J_y, J_z of spin j, sympy matrices (2j + 1, 2j + 1).

    Parameters
    ----------
    spin : int, str, Fraction or sympy number
        j, an integer or half-integer at least 0: 1, "1/2", "3/2". The basis is m = j, j - 1, ..., -j.

    Notes
    -----
    [J_x, J_y] = i J_z, and J_x + i J_y maps the vector m to sqrt(j (j + 1) - m (m + 1)) times the vector m + 1.

    Raises
    ------
    InputError
        If j is not an integer or half-integer at least 0.

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
        raise InputError(f"a spin is an integer or half-integer such as 1 or '3/2', got {spin!r}: {error}") from None
    if j < 0 or j.denominator > 2:
        raise InputError(f"a spin is an integer or half-integer at least 0 such as 1 or '3/2', got {spin!r}")
    n = int(2 * j) + 1
    values = [sympy.Rational((j - k).numerator, (j - k).denominator) for k in range(n)]
    square = values[0] * (values[0] + 1)
    raising = sympy.zeros(n)
    for k in range(1, n):
        raising[k - 1, k] = sympy.sqrt(square - values[k] * (values[k] + 1))
    lowering = raising.T
    return [(raising + lowering) / 2, (raising - lowering) / (2 * sympy.I), sympy.diag(*values)]
