"""Matrix bases of f4 and e6 on the Albert algebra, the hermitian 3 x 3 matrices over the octonions.

For signs (g1, g2, g3) the matrices with X_ij = g_i g_j conj(X_ji) form a Jordan algebra with the product
X o Y = (XY + YX) / 2. Let L_X Y = X o Y. The commutators [L_X, L_Y] span the derivations, f4. Together with the L_X of
trace zero they span e6, which preserves the cubic norm. Coordinates are

    (X_11, X_22, X_33; X_23; X_31; X_12) in R^{3 + 8 + 8 + 8},

so the first three basis vectors E_1, E_2, E_3 are orthogonal primitive idempotents.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from liehom.algebra.matrices.composition_algebra import OCTONIONS, conjugation
from liehom.algebra.matrices.matrix_basis import primitive, stack
from liehom.algebra.matrices.octonionic import octonion_table
from liehom.errors import InputError
from liehom.typing import IntegerArray

_DIMENSION = 27
_OFF_DIAGONAL = ((1, 2), (2, 0), (0, 1))


def albert_product(
    signs: tuple[int, int, int] = (1, 1, 1), *, parameters: tuple[int, int, int] = OCTONIONS
) -> IntegerArray:
    """Structure constants of twice the Jordan product: ``2 e_i o e_j = sum_k table[i, j, k] e_k``.

    Parameters
    ----------
    signs : three of 1, -1
        The diagonal form for which the matrices are hermitian.
    parameters : three non-zero integers
        Doubling parameters of the octonions.

    Returns
    -------
    (27, 27, 27) int64

    Raises
    ------
    InputError
        If a sign is not 1 or -1, or the parameters are not three non-zero integers.

    Examples
    --------
    E_1 is an idempotent:

    >>> albert_product()[0, 0, :3].tolist()
    [2, 0, 0]
    """
    table = octonion_table(parameters)
    basis = _hermitian_basis(signs, conjugation(table))
    half = np.einsum("xija,abc->xijbc", basis, table)
    products = np.einsum("xijbc,yjkb->xyikc", half, basis, optimize=True)
    doubled = products + products.transpose(1, 0, 2, 3, 4)
    diagonal = doubled[:, :, range(3), range(3), 0]
    return np.concatenate([diagonal, *(doubled[:, :, i, j] for i, j in _OFF_DIAGONAL)], axis=2)


def f4(signs: tuple[int, int, int] = (1, 1, 1), *, parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of f4 on R^27, the derivations of the Albert algebra, which annihilate E_1 + E_2 + E_3.

    Parameters
    ----------
    signs : three of 1, -1
        (1, 1, 1) for compact f4, (-1, 1, 1) for f4(-20).
    parameters : three non-zero integers
        Doubling parameters of the octonions; SPLIT_OCTONIONS gives f4(4).

    Returns
    -------
    (52, 27, 27) int64
        The first 36 matrices are a basis of the stabilizer of E_1, which is spin(9) for both choices of signs above.

    Raises
    ------
    InputError
        If a sign is not 1 or -1, or the parameters are not three non-zero integers.

    See Also
    --------
    liehom.algebra.matrices.matrix_basis.stabilizer_rows : the stabilizer of any element.

    Notes
    -----
    Let x_k(e) be the element whose k-th off-diagonal entry is e. The basis is [L_{x_1(e_i)}, L_{x_1(e_j)}]
    (i < j), an so(8), followed by [L_{E_{k+1}}, L_{x_k(e_i)}] for k = 1, 2, 3.

    Examples
    --------
    >>> f4().shape
    (52, 27, 27)
    """
    doubled = _multiplications(albert_product(signs, parameters=parameters))
    pairs = [(3 + i, 3 + j) for i, j in combinations(range(8), 2)]
    pairs += [((k + 1) % 3, 3 + 8 * k + i) for k in range(3) for i in range(8)]
    brackets = (doubled[x] @ doubled[y] - doubled[y] @ doubled[x] for x, y in pairs)
    return stack((primitive(bracket) for bracket in brackets), _DIMENSION)


def e6(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of e6 on R^27, the linear maps that preserve the cubic norm of the Albert algebra.

    Parameters
    ----------
    parameters : three non-zero integers
        Doubling parameters of the octonions: OCTONIONS for e6(-26), SPLIT_OCTONIONS for e6(6).

    Returns
    -------
    (78, 27, 27) int64
        The 52 derivations of `f4`, then twice the multiplications by E_1 - E_2, E_2 - E_3 and the 24
        off-diagonal basis vectors.

    Raises
    ------
    InputError
        If the parameters are not three non-zero integers.

    Examples
    --------
    The parabolic subalgebra that stabilizes the line through the idempotent E_1 has dimension 78 - 16:

    >>> from liehom.algebra.matrices.matrix_basis import stabilizer_rows
    >>> stabilizer_rows(e6(), albert_idempotent(1), up_to_scale=True).shape
    (62, 78)
    """
    doubled = _multiplications(albert_product(parameters=parameters))
    diagonal = [primitive(doubled[0] - doubled[1]), primitive(doubled[1] - doubled[2])]
    traceless = stack([*diagonal, *(primitive(matrix) for matrix in doubled[3:])], _DIMENSION)
    return np.concatenate([f4(parameters=parameters), traceless])


def albert_idempotent(k: int) -> IntegerArray:
    """Coordinates of the primitive idempotent E_k, k = 1, 2 or 3.

    Returns
    -------
    (27,) int64

    Raises
    ------
    InputError
        If k is not 1, 2 or 3.

    Examples
    --------
    >>> albert_idempotent(2)[:4].tolist()
    [0, 1, 0, 0]
    """
    if k not in (1, 2, 3):
        raise InputError(f"the primitive idempotents are numbered 1, 2, 3; got {k!r}")
    vector = np.zeros(_DIMENSION, dtype=np.int64)
    vector[k - 1] = 1
    return vector


def _multiplications(product: IntegerArray) -> IntegerArray:
    """Matrices of 2 L_x for the basis vectors x, shape (27, 27, 27)."""
    return product.transpose(0, 2, 1)


def _hermitian_basis(signs: tuple[int, int, int], conjugate: IntegerArray) -> IntegerArray:
    """The 27 basis matrices as octonion entries, shape (27, 3, 3, 8)."""
    if len(signs) != 3 or any(sign not in (1, -1) for sign in signs):
        raise InputError(f"three signs 1 or -1 are needed; got {list(signs)!r}")
    basis = np.zeros((_DIMENSION, 3, 3, 8), dtype=np.int64)
    basis[range(3), range(3), range(3), 0] = 1
    for k, (i, j) in enumerate(_OFF_DIAGONAL):
        for e in range(8):
            basis[3 + 8 * k + e, i, j, e] = 1
            basis[3 + 8 * k + e, j, i, e] = signs[i] * signs[j] * conjugate[e]
    return basis
