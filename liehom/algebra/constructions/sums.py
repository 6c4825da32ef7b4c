"""Direct and semidirect sums of Lie algebras, in the bases of the summands one after the other."""

from __future__ import annotations

import math
from collections.abc import Sequence

from liehom.algebra.closure.closure import square_matrices
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import InputError, ShapeError, displayed
from liehom.scalars import FloatMatrix, Scalar
from liehom.scalars.fields.field import MatricesLike

Entry = tuple[int, int, int, Scalar]


def direct_sum(*algebras: LieAlgebra, name: str | None = None) -> LieAlgebra:
    """The direct sum of Lie algebras over one field, bases one after the other.

    Parameters
    ----------
    *algebras : LieAlgebra
        At least one; the direct power g^3 is ``direct_sum(*[g] * 3)``.
    name : str, optional
        By default the names of the summands joined by '+', if all have one.

    Raises
    ------
    InputError
        If there is no summand, a summand is not a Lie algebra, or the fields differ.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.direct_sum(lh.so(3), lh.abelian(1))
    <Lie algebra so(3)+R of dimension 4 over QQ>
    """
    if not algebras:
        raise InputError("a direct sum needs at least one summand; abelian(0) is the zero algebra")
    strange = [g for g in algebras if not isinstance(g, LieAlgebra)]
    if strange:
        hint = "; if this is a list of summands, unpack the list: direct_sum(*algebras)" if len(algebras) == 1 else ""
        raise InputError(f"a summand must be a LieAlgebra, got {displayed(strange[0])}{hint}")
    field = algebras[0].field
    if any(g.field != field for g in algebras):
        fields = ", ".join(g.field.name for g in algebras)
        raise InputError(f"the summands are over different fields: {fields}; bring all over one field K by .over(K)")
    entries: list[Entry] = []
    shift = 0
    for g in algebras:
        entries += [(i + shift, j + shift, k + shift, v) for i, j, k, v in g.structure_constants()]
        shift += g.dimension
    names = [g.name for g in algebras]
    if name is None and all(names):
        name = "+".join(str(x) for x in names)
    # Each summand satisfies the axioms and brackets between them vanish.
    error = math.hypot(*(g.table.error for g in algebras))
    return LieAlgebra(StructureConstants(field, shift, entries, error), name=name, check=False)


def semidirect_sum(
    algebra: LieAlgebra,
    matrices: MatricesLike,
    ideal: LieAlgebra | None = None,
    *,
    size: int | None = None,
    basis: Sequence[str] | None = None,
    name: str | None = None,
    check: bool = True,
) -> LieAlgebra:
    """The semidirect sum of h with an ideal V, on which h acts: [x, v] = rho(x) v.

    Parameters
    ----------
    algebra : LieAlgebra
        h; its basis comes first.
    matrices : sequence of (N, N) array_like
        rho(e_i), one for each basis element of h: a representation by derivations of the ideal.
    ideal : LieAlgebra, optional
        V with its own bracket, of dimension N; by default abelian.
    size : int, optional
        N, needed only if h has dimension 0 and no ideal is given.
    basis : sequence of str, optional
        Names of the basis elements, first of h, then of V.
    name : str, optional
    check : bool
        Whether to prove the Jacobi identity, which says that the matrices are a representation by derivations.

    Raises
    ------
    ShapeError
        If the number of matrices or their size does not fit.
    JacobiError
        If the matrices do not represent h, or are not derivations of the ideal.
    InputError
        If the ideal is over another field.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.semidirect_sum(lh.so(2), [[[0, -1], [1, 0]]]).derived_series()[1].dimension
    2
    """
    made = square_matrices(matrices, algebra.field)
    if len(made) != algebra.dimension:
        raise ShapeError(f"{len(made)} matrices for an algebra of dimension {algebra.dimension}")
    if not made and ideal is None and size is None:
        raise ShapeError("the zero algebra acts on a space of any size: give size or an ideal")
    d = int(made[0].nrows) if made else ideal.dimension if ideal is not None else int(size or 0)
    h = algebra.dimension
    entries: list[Entry] = list(algebra.structure_constants())
    for a, matrix in enumerate(made):
        for index, value in enumerate(matrix.entries()):
            if value != 0:
                entries.append((a, h + index % d, h + index // d, value))
    if ideal is not None:
        if ideal.dimension != d:
            raise ShapeError(f"matrices of size {d} on an ideal of dimension {ideal.dimension}")
        if ideal.field != algebra.field:
            raise InputError(f"the algebra is over {algebra.field.name}, the ideal over {ideal.field.name}")
        entries += [(i + h, j + h, k + h, v) for i, j, k, v in ideal.structure_constants()]
    acting = (2**0.5 * matrix.error for matrix in made if isinstance(matrix, FloatMatrix))
    error = math.hypot(algebra.table.error, 0.0 if ideal is None else ideal.table.error, *acting)
    return LieAlgebra(StructureConstants(algebra.field, h + d, entries, error), basis=basis, name=name, check=check)
