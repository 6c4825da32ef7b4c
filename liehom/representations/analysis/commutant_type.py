"""The type R, C or H of an irreducible representation: its commutant over the reals.

By Schur's lemma and Frobenius' theorem the commutant over the reals is a division algebra, of dimension 1, 2 or 4,
which equals the dimension of the commutant over the field.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from liehom.errors import InputError, InternalError
from liehom.representations.invariants.intertwiners import commutant
from liehom.representations.invariants.irreducibility import anticommutator_gram, combination, reduction, traceless
from liehom.scalars import ExactMatrix, Field, Scalar
from liehom.scalars.spaces.forms import orthogonal_basis

CommutantType = Literal["R", "C", "H"]
"""Type of an irreducible representation: its commutant over the reals is R, C or H."""

COMMUTANT_DIMENSIONS: dict[CommutantType, int] = {"R": 1, "C": 2, "H": 4}
"""Real dimensions of the commutants."""


def commutant_type(
    matrices: Sequence[ExactMatrix],
    size: int,
    over: Field,
    generating: Sequence[ExactMatrix] | None = None,
    *,
    semisimple: bool = False,
) -> CommutantType:
    """Type, 'R', 'C' or 'H', of an irreducible action of a linear Lie algebra on R^N; arguments as for `reduction`.

    Raises
    ------
    InputError
        If the action is reducible over the reals; the message says how it splits.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> commutant_type([QQ.matrix([[0, -2], [1, 0]])], 2, QQ)
    'C'
    """
    found = None if size == 0 else reduction(matrices, size, over, generating, semisimple=semisimple)
    if size == 0 or found is not None:
        how = {
            "kernel": "the kernel of a matrix is an invariant subspace",
            "eigenvalue": "a commuting matrix has an irrational real eigenvalue",
            "cut": "a commuting matrix has eigenvalues with different real parts",
        }
        why = "the space is zero" if found is None else how[found.kind]
        raise InputError(
            f"the type R, C or H belongs to an irreducible representation, and this one is reducible over the reals "
            f"({why}): use decomposition(), whose components have types"
        )
    dimension = len(commutant(matrices if generating is None else generating, size, over))
    return next(kind for kind, d in COMMUTANT_DIMENSIONS.items() if d == dimension)


def complex_structure(matrices: Sequence[ExactMatrix], size: int, over: Field) -> tuple[ExactMatrix, Scalar]:
    """A commuting matrix J of an irreducible action of type C or H with J^2 = -d, and d > 0.

    Over the reals J / sqrt(d) is a complex structure.

    Raises
    ------
    InputError
        If the action is reducible, or of type R.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> J, d = complex_structure([QQ.matrix([[0, -2], [1, 0]])], 2, QQ)
    >>> print(J, d)
    [0, 1]
    [-1/2, 0] 1/2
    """
    units = imaginary_units(matrices, size, over)
    if not units:
        raise InputError("a representation of type R has no complex structure that commutes with it")
    return units[0]


def imaginary_units(matrices: Sequence[ExactMatrix], size: int, over: Field) -> list[tuple[ExactMatrix, Scalar]]:
    """Anticommuting matrices J_i and numbers d_i, J_i^2 = -d_i: a basis of the traceless commutant (0, 1 or 3).

    Raises
    ------
    InputError
        If the action is reducible.

    Examples
    --------
    >>> import liehom as lh
    >>> [str(d) for _, d in imaginary_units(lh.defining(lh.su(2)).matrices, 4, lh.QQ)]
    ['1', '1', '1']
    """
    commutant_type(matrices, size, over)
    imaginary = traceless(commutant(matrices, size, over), size, over)
    if not imaginary:
        return []
    gram = anticommutator_gram(imaginary, size, over)
    if gram is None:
        raise InternalError("an anticommutator of imaginary units is not scalar")
    rows, values = orthogonal_basis(gram)
    return [(combination(imaginary, row.row(0)), -value) for row, value in zip(rows, values, strict=True)]
