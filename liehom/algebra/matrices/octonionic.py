"""Matrix bases of the Lie algebras of the octonions: g2 on the imaginary octonions, spin(7) on all octonions.

Let w_ab(x) = e_a <e_b, x> - e_b <e_a, x>. Then so(Im O) is Lambda^2 Im O, and the derivations are the kernel of the
equivariant map e_a ^ e_b -> Im(e_a e_b). Its part over the imaginary unit e_l consists of the combinations of the
three w_ab with e_a e_b = s_ab e_l whose coefficients c_ab satisfy sum c_ab s_ab = 0.

The products L_a L_b (a < b) of left multiplications span spin(7), and g2 is the stabilizer of 1 in spin(7).
"""

from __future__ import annotations

from itertools import combinations, pairwise

from liehom.algebra.matrices.composition_algebra import OCTONIONS, cayley_dickson, left_multiplications, norm_diagonal
from liehom.algebra.matrices.matrix_basis import primitive, stack, unit
from liehom.errors import InputError
from liehom.typing import IntegerArray


def g2(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of g2 on R^7, the derivations of the octonions on their imaginary part.

    Parameters
    ----------
    parameters : three non-zero integers
        Doubling parameters: OCTONIONS for compact g2 in so(7), SPLIT_OCTONIONS for split g2 in so(3, 4).

    Returns
    -------
    (14, 7, 7) int64
        In the basis e_1, ..., e_7.

    Raises
    ------
    InputError
        If the parameters are not three non-zero integers.

    See Also
    --------
    liehom.algebra.matrices.matrix_basis.stabilizer_rows : su(3) as the stabilizer of a unit imaginary octonion.

    Examples
    --------
    >>> from liehom.algebra.matrices.matrix_basis import stabilizer_rows
    >>> g2().shape, stabilizer_rows(g2(), [1, 0, 0, 0, 0, 0, 0]).shape
    ((14, 7, 7), (8, 14))
    """
    table = octonion_table(parameters)
    norm = norm_diagonal(table)
    basis = []
    for target in range(1, 8):
        planes = []
        for a, b in combinations(range(1, 8), 2):
            if table[a, b, target]:
                rotation = norm[b] * unit(7, a - 1, b - 1) - norm[a] * unit(7, b - 1, a - 1)
                planes.append((table[a, b, target], rotation))
        basis += [primitive(t * first - s * second) for (s, first), (t, second) in pairwise(planes)]
    return stack(basis, 7)


def octonion_spin(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Basis of spin(7) or spin(4, 3) on R^8 = O: products of two left multiplications by imaginary units.

    Parameters
    ----------
    parameters : three non-zero integers
        Doubling parameters: OCTONIONS for spin(7), SPLIT_OCTONIONS for spin(4, 3).

    Returns
    -------
    (21, 8, 8) int64
        ``L_a L_b`` for 1 <= a < b <= 7; e_0 is the identity of the octonions.

    Raises
    ------
    InputError
        If the parameters are not three non-zero integers.

    Examples
    --------
    The stabilizer of 1 is g2:

    >>> from liehom.algebra.matrices.matrix_basis import stabilizer_rows
    >>> stabilizer_rows(octonion_spin(), [1, 0, 0, 0, 0, 0, 0, 0]).shape
    (14, 21)
    """
    left = left_multiplications(octonion_table(parameters))
    return stack((left[a] @ left[b] for a, b in combinations(range(1, 8), 2)), 8)


def octonion_table(parameters: tuple[int, int, int] = OCTONIONS) -> IntegerArray:
    """Multiplication table (8, 8, 8) of the octonion algebra with the given doubling parameters.

    Raises
    ------
    InputError
        If the parameters are not three non-zero integers.

    Examples
    --------
    >>> octonion_table().shape
    (8, 8, 8)
    """
    if len(parameters) != 3:
        raise InputError(f"an octonion algebra has three doubling parameters; got {list(parameters)!r}")
    return cayley_dickson(parameters)
