"""Lie algebras by construction: the classical ones, abelian, Heisenberg, Euclidean, and sums.

Every algebra here is over QQ and carries a name that prints and that the catalogue reads.  Bases: the classical
algebras have those of their matrices (`liehom.algebra.matrices.matrix_families`), sums have the bases of their parts
one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from liehom.algebra.closure.closure import square_matrices
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.matrices.classical import Parameter, classical_matrices, classical_name, linear_algebra
from liehom.algebra.matrices.matrix_basis import require_size
from liehom.errors import InputError, ShapeError
from liehom.scalars import QQ, Scalar

Entry = tuple[int, int, int, Scalar]


def gl(n: int, over: str = "R") -> LieAlgebra:
    """gl(n) over 'R', 'C' or 'H', as a real Lie algebra of dimension n**2, 2 n**2 or 4 n**2.

    Parameters
    ----------
    n : int
        Size, at least 1.
    over : 'R', 'C' or 'H'

    Raises
    ------
    InputError
        If n is not a positive integer or the letter is another one.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.gl(2).dimension, lh.gl(1, "H").dimension
    (4, 4)
    """
    return _classical("gl", n, over)


def sl(n: int, over: str = "R") -> LieAlgebra:
    """sl(n) over 'R', 'C' or 'H'; over H it is the real trace that vanishes.

    Raises
    ------
    InputError
        If n is not a positive integer or the letter is another one.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sl(3), lh.sl(2, "H").dimension
    (<Lie algebra sl(3) of dimension 8 over QQ>, 15)
    """
    return _classical("sl", n, over)


def so(p: int, q: int | str = 0) -> LieAlgebra:
    """so(p, q), of dimension n (n - 1) / 2 with n = p + q, or so(n, 'C').

    Raises
    ------
    InputError
        If p or q is negative or p + q is 0.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.so(3).killing_signature(), lh.so(2, 1).killing_signature(), lh.so(3, "C").dimension
    ((0, 3, 0), (2, 1, 0), 6)
    """
    return _classical("so", p, q)


def su(p: int, q: int = 0) -> LieAlgebra:
    """su(p, q), of dimension n**2 - 1 with n = p + q.

    Raises
    ------
    InputError
        If p or q is negative or p + q is 0.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.su(3).killing_signature(), lh.su(1, 1).killing_signature()
    ((0, 8, 0), (2, 1, 0))
    """
    return _classical("su", p, q)


def u(p: int, q: int = 0) -> LieAlgebra:
    """u(p, q), of dimension n**2 with n = p + q.

    Raises
    ------
    InputError
        If p or q is negative or p + q is 0.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.u(2).center().dimension
    1
    """
    return _classical("u", p, q)


def sp(p: int, q: int | str = 0) -> LieAlgebra:
    """The compact sp(n) and sp(p, q) on H^n, n = p + q; with a letter the split sp(2n, 'R') and sp(2n, 'C').

    Parameters
    ----------
    p : int
        With q a number: sp(p, q) of dimension n (2n + 1), sp(1) = su(2). With a letter: the even size 2n.
    q : int, 'R' or 'C'

    Raises
    ------
    InputError
        If p or q is negative, p + q is 0, or the size before a letter is odd.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sp(2).killing_signature(), lh.sp(4, "R").killing_signature(), lh.sp(1, 1).killing_signature()
    ((0, 10, 0), (6, 4, 0), (4, 6, 0))
    """
    return _classical("sp", p, q)


def abelian(n: int) -> LieAlgebra:
    """The abelian Lie algebra R^n; n may be 0.

    Raises
    ------
    InputError
        If n is not an integer at least 0.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.abelian(2), lh.abelian(2).is_abelian()
    (<Lie algebra R^2 of dimension 2 over QQ>, True)
    """
    require_size("n", n, 0)
    name = f"R^{n}" if n > 1 else "R" if n else "0"
    return LieAlgebra(StructureConstants(QQ, n, []), name=name, check=False)  # no bracket, nothing to prove


def heisenberg(n: int) -> LieAlgebra:
    """The Heisenberg algebra of dimension 2n + 1: [x_i, y_i] = z, basis x_1, ..., x_n, y_1, ..., y_n, z.

    Raises
    ------
    InputError
        If n is not an integer at least 0.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.heisenberg(1))
    Lie algebra heisenberg(1) over QQ, dimension 3
      basis x1, y1, z
      [x1, y1] = z
    """
    require_size("n", n, 0)
    entries = [(i, n + i, 2 * n, QQ.one) for i in range(n)]
    basis = [*(f"x{i + 1}" for i in range(n)), *(f"y{i + 1}" for i in range(n)), "z"]
    # All double brackets vanish: z is central.
    table = StructureConstants(QQ, 2 * n + 1, entries)
    return LieAlgebra(table, basis=basis, name=f"heisenberg({n})", check=False)


def euclidean(n: int) -> LieAlgebra:
    """e(n) = so(n) + R^n, the rotations first and then the translations.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.euclidean(3), lh.euclidean(3).center().dimension
    (<Lie algebra e(3) of dimension 6 over QQ>, 0)
    """
    matrices = classical_matrices("so", n)
    # The matrices are the basis of so(n) itself: a representation.
    return semidirect_sum(so(n), matrices, size=n, name=f"e({n})", check=False)


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
        If there is no summand, one is no Lie algebra, or they are over different fields.

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
        raise InputError(f"a summand must be a LieAlgebra, got {strange[0]!r}{hint}")
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
    return LieAlgebra(StructureConstants(field, shift, entries), name=name, check=False)


def semidirect_sum(
    algebra: LieAlgebra,
    matrices: Any,
    ideal: LieAlgebra | None = None,
    *,
    size: int | None = None,
    basis: Sequence[str] | None = None,
    name: str | None = None,
    check: bool = True,
) -> LieAlgebra:
    """The semidirect sum of h with an ideal V on which it acts: [x, v] = rho(x) v.

    Parameters
    ----------
    algebra : LieAlgebra
        h; its basis comes first.
    matrices : sequence of (N, N) array_like
        rho(e_i), one for each basis element of h: a representation by derivations of the ideal.
    ideal : LieAlgebra, optional
        V with its own bracket, of dimension N; by default abelian.
    size : int, optional
        N, needed only where h has dimension 0 and no ideal is given.
    basis : sequence of str, optional
        Names of the basis elements, those of h first.
    name : str, optional
    check : bool
        Prove the Jacobi identity, that is that the matrices are a representation by derivations (default).

    Raises
    ------
    ShapeError
        If the number of matrices or their size does not fit.
    JacobiError
        If the matrices do not represent h, or are no derivations of the ideal.
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
        for place, value in enumerate(matrix.entries()):
            if value != 0:
                entries.append((a, h + place % d, h + place // d, value))
    if ideal is not None:
        if ideal.dimension != d:
            raise ShapeError(f"matrices of size {d} on an ideal of dimension {ideal.dimension}")
        if ideal.field != algebra.field:
            raise InputError(f"the algebra is over {algebra.field.name}, the ideal over {ideal.field.name}")
        entries += [(i + h, j + h, k + h, v) for i, j, k, v in ideal.structure_constants()]
    return LieAlgebra(StructureConstants(algebra.field, h + d, entries), basis=basis, name=name, check=check)


def _classical(kind: str, first: int, second: Parameter) -> LieAlgebra:
    return linear_algebra(classical_matrices(kind, first, second), classical_name(kind, first, second))
