"""Representations constructed from a Lie algebra: defining, adjoint, coadjoint, trivial, conjugation of matrices.

Constructions from a representation (dual, sums, products, powers, restriction) are methods of `Representation`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from numbers import Integral
from typing import Any

from liehom.base.budget import within
from liehom.base.errors import (
    DependentRowsError,
    InputError,
    NotASubalgebraError,
    RepresentationError,
    ShapeError,
    displayed,
)
from liehom.base.typing import IntegerArray, VectorLike
from liehom.exact.algebra.constructions.classical import simple
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.linear.closure import lie_closure, square_matrices
from liehom.exact.algebra.linear.complex_matrices import (
    field_of_matrices,
    has_complex_entry,
    list_of_matrices,
    real_matrices,
)
from liehom.exact.algebra.linear.linear_bases import heisenberg as heisenberg_matrices
from liehom.exact.algebra.linear.named_matrices import (
    FAMILY_MATRICES,
    classical_matrices,
    exceptional_matrices,
    linear_lie_algebra,
    spelled,
)
from liehom.exact.representations.core.coordinates import Coordinates
from liehom.exact.representations.core.elements import rows_of_matrices
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.highest_weight import highest_weight_module
from liehom.exact.representations.highest_weight.real_modules import real_module
from liehom.exact.representations.invariants.representation_identity import congruence_map, monomials
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.field import Field, Matrix, MatrixLike
from liehom.exact.scalars.rational import QQ

_CLASSICAL = re.compile(r"(gl|sl|so|su|u|sp|spin)\(([0-9]+)(?:,([0-9]+|[RCH]))?\)")
_COMPLEX = re.compile(r"s?u\([0-9]+(,[0-9]+)?\)|(gl|sl|so|sp)\([0-9]+,C\)")
_FAMILY = re.compile(r"(e|aff|galilei|so\*|upper|strict|heisenberg)\(([0-9]+)\)|(iso)\(([0-9]+),([0-9]+)\)")


def defining(algebra: LieAlgebra | str) -> Representation:
    """The defining representation of an algebra with a name by its standard matrices.

    C^n is R^(2n) and H^n is R^(4n).

    Parameters
    ----------
    algebra : LieAlgebra or str
        An algebra whose name is one of 'gl(n)', 'sl(n)' (also 'sl(n,C)', 'sl(n,H)'), 'so(p,q)', 'so(n,C)', 'so*(2n)',
        'su(p,q)', 'u(p,q)', 'sp(p,q)' (quaternionic), 'sp(2n,R)', 'sp(2n,C)', 'spin(p,q)', or an exceptional one such
        as 'g2(2)', 'f4', 'e6(-26)', in the basis of its standard matrices; or 'e(n)', 'iso(p,q)', 'aff(n)',
        'galilei(n)', 'heisenberg(n)', 'upper(n)', 'strict(n)', in the basis of its constructor, such as
        `liehom.euclidean`; or such a name.

    Raises
    ------
    RepresentationError
        If the algebra does not have the basis of the standard matrices, for example after a change of basis.

    Notes
    -----
    e(n), iso(p,q) and aff(n) act on the vectors (x, 1) of size n + 1 or p + q + 1, galilei(n) on the vectors (x, t, 1).

    The forms of f4 and e6 act on the Albert algebra of dimension 27; spin(p, q) acts on a real spin representation.
    The exceptional algebras that `liehom.simple` constructs without matrices have modules of smallest dimension: e6(2),
    e6(-14) and e6 on R^54, e7(7) and e7(-25) on R^56, e7(-5) and e7 on R^112, and the forms of e8 on themselves.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3, 1)
    >>> rho = lh.defining(g)
    >>> rho.size, rho.algebra is g, lh.defining("su(2)").size
    (4, True, 4)
    >>> print(lh.defining(lh.euclidean(2)).matrices[1])  # the translation along the first axis
    [0, 0, 1]
    [0, 0, 0]
    [0, 0, 0]
    """
    if not isinstance(algebra, str):
        _require_algebra(algebra)
    name = spelled(algebra) if isinstance(algebra, str) else algebra.name
    text = spelled(name or "")
    if least := _least_module(text):
        return _of_algebra(least, algebra)
    matrices = standard_matrices(name)
    size = int(matrices.shape[1])
    coordinates: Coordinates = "complex" if _COMPLEX.fullmatch(text) else "real"
    if isinstance(algebra, str):
        if not len(matrices):
            zero = linear_lie_algebra(matrices, name)
            return Representation(zero, [], size=size, name="defining", coordinates=coordinates)
        closure = lie_closure(matrices, close=False, name=name)
        # The constants are those of the commutators themselves.
        return Representation(closure.algebra, closure.matrices, name="defining", coordinates=coordinates, check=False)
    if isinstance(algebra.field, ExactField):
        over = [algebra.field.from_integers(a.ravel().tolist(), size, size) for a in matrices]
    else:
        over = [algebra.field.from_entries([float(x) for x in a.ravel().tolist()], size, size) for a in matrices]
    if len(over) != algebra.dimension:
        raise RepresentationError(
            (0, 0), f"{displayed(algebra)} does not have the dimension {len(over)} of the standard matrices of {name}"
        )
    return Representation(algebra, over, size=size, name="defining", coordinates=coordinates)


def _of_algebra(rho: Representation, algebra: LieAlgebra | str) -> Representation:
    """The representation with the same matrices for an equal algebra, which may be over a larger field."""
    if isinstance(algebra, str):
        return rho
    over = rho if algebra.field == rho.field else rho.over(algebra.field)
    if over.algebra != algebra:
        raise RepresentationError((0, 0), f"{displayed(algebra)} does not have the basis that liehom.simple gives it")
    # the constants are those of the algebra that the matrices represent
    return Representation(algebra, over.matrices, size=over.size, name=over.name, check=False)


def _least_module(name: str) -> Representation | None:
    """The smallest module of an exceptional form without a family of matrices, in the basis of `liehom.simple`."""
    if name in ("e6(2)", "e6(-14)", "e6"):
        return real_module(name, [1, 0, 0, 0, 0, 0]).representation
    if name in ("e7(-5)", "e7(-25)", "e7"):
        return real_module(name, [0, 0, 0, 0, 0, 0, 1]).representation
    if name == "e7(7)":
        return highest_weight_module("E7", [0, 0, 0, 0, 0, 0, 1]).representation
    return adjoint(simple("E8", name)) if name in ("e8(8)", "e8(-24)", "e8") else None


def standard_matrices(name: str | None) -> IntegerArray:
    """The standard basis of a named matrix algebra, integer matrices of shape (dim, N, N)."""
    text = spelled(name or "")
    if match := _CLASSICAL.fullmatch(text):
        kind, first, second = match.groups()
        parameter = 0 if second is None else int(second) if second.isdigit() else second
        return classical_matrices(kind, int(first), parameter)
    if match := _FAMILY.fullmatch(text):
        kind, *numbers = filter(None, match.groups())
        build = heisenberg_matrices if kind == "heisenberg" else FAMILY_MATRICES[kind]
        return build(*map(int, numbers))
    if text[:2] in ("g2", "f4", "e6"):
        return exceptional_matrices(text)
    known = "so(4), so(3,1), su(2), sl(3), sl(2,C), gl(2), sp(2), sp(4,R), so*(6), spin(7), g2, f4, e6(-26), e(3)"
    raise InputError(f"no defining representation is known for {displayed(name)}; names are such as {known}")


def adjoint(algebra: LieAlgebra) -> Representation:
    """The adjoint representation x -> ad x on g.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.adjoint(lh.so(3)).size
    3
    """
    _require_algebra(algebra)
    # ad [x, y] = [ad x, ad y] is the Jacobi identity, which the algebra has proved.
    return Representation(algebra, _adjoint_matrices(algebra), size=algebra.dimension, name="adjoint", check=False)


def _require_algebra(algebra: LieAlgebra) -> None:
    if not isinstance(algebra, LieAlgebra):
        raise InputError(
            f"expected a LieAlgebra, such as lh.so(3) or lh.catalog.algebra('so(3)'); got {displayed(algebra)}"
        )


def _adjoint_matrices(algebra: LieAlgebra) -> list[Matrix]:
    n, over, table = algebra.dimension, algebra.field, algebra.table
    if over != QQ:
        return [algebra.ad(over.unit(n, i)) for i in range(n)]
    matrices = [QQ.zeros(n, n) for _ in range(n)]
    for (i, j), terms in table.by_pair().items():
        (numerators,) = matrices[i].parts  # of a new matrix, which is written to entry by entry
        for k, value in terms:
            numerators[k, j] = value
    return [*matrices] if table.den == 1 else [a.scale(QQ.one / table.den) for a in matrices]


def coadjoint(algebra: LieAlgebra) -> Representation:
    """The coadjoint representation x -> -(ad x)^T on the dual of g, in the dual basis.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.coadjoint(lh.heisenberg(1)).orbit_dimension([0, 0, 1])
    2
    """
    dual = adjoint(algebra).dual()
    return Representation(algebra, dual.matrices, size=dual.size, name="coadjoint", check=False)  # a dual


def trivial(algebra: LieAlgebra, n: int = 1) -> Representation:
    """The trivial representation of g on K^n: all matrices are zero.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.representations.trivial(lh.so(3), 2).isotropy([1, 0]).dimension
    3
    """
    if isinstance(n, bool) or not isinstance(n, int) or n < 0:
        raise InputError(f"the dimension of a trivial representation is an integer at least 0, got {displayed(n)}")
    _require_algebra(algebra)
    # All commutators and all images vanish.
    return Representation(algebra, [algebra.field.zeros(n, n)] * algebra.dimension, size=n, name="trivial", check=False)


def sym_conjugation(k: int, algebra: LieAlgebra | None = None) -> Representation:
    """The representation of so(k) on the symmetric matrices Sym(k) by S -> A S - S A.

    The coordinates are the entries S[i, j], i <= j, in lexicographic order of (i, j), as in `symmetric_to_vector` and
    `vector_to_symmetric`.

    Parameters
    ----------
    k : int
        Size of the matrices, at least 1.
    algebra : LieAlgebra, optional
        A copy of so(k) in its standard basis (default: a new one named 'so(k)').

    Examples
    --------
    The isotropy of a matrix with eigenvalues of multiplicities 3 and 1 is so(3):

    >>> rho = sym_conjugation(4)
    >>> rho.isotropy(symmetric_to_vector([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0]])).dimension
    3
    """
    size: object = k
    if not isinstance(size, Integral):
        raise InputError(f"k is {displayed(k)}, expected an integer")
    within("dimension", abs(int(k)), "the size of the symmetric matrices is {}")
    induced = congruence_map(k)
    rho = defining(f"so({k})" if algebra is None else algebra)
    # A^T = -A: S -> A S + S A^T, and (A S + S A^T) is the restriction of A (x) 1 + 1 (x) A to symmetric tensors.
    if any(not (a + a.T).is_zero() for a in rho.matrices) or rho.size != k:
        raise InputError(f"conjugation on Sym({k}) needs so({k}) by skew-symmetric matrices")
    images = [induced(a) for a in rho.matrices]
    return Representation(rho.algebra, images, size=induced.target, name=f"conjugation on Sym({k})", check=False)


def hermitian_conjugation(k: int, algebra: LieAlgebra | None = None) -> Representation:
    """The representation of su(k) on the Hermitian k x k matrices by H -> A H - H A.

    The coordinates are those of `Representation.on_hermitian_matrices`, the arguments as for `sym_conjugation`.

    Examples
    --------
    The isotropy of diag(1, 0, 0) is u(2):

    >>> rho = hermitian_conjugation(3)
    >>> rho.isotropy([1, 0, 0, 0, 0, 0, 0, 0, 0]).dimension, rho.isotropy([[1, 0, 0], [0, 0, 0], [0, 0, 0]]).dimension
    (4, 4)
    """
    rho = defining(f"su({k})" if algebra is None else algebra)
    if any(not (a + a.T).is_zero() for a in rho.matrices) or rho.complex_size != k:
        raise InputError(f"conjugation of Hermitian {k} x {k} matrices needs su({k}) by skew-Hermitian matrices")
    action, title = rho.on_hermitian_matrices(), f"conjugation of Hermitian {k} x {k} matrices"
    return Representation(  # the same matrices with a name
        rho.algebra, action.matrices, size=action.size, name=title, coordinates=action.coordinates, check=False
    )


def pair_from_matrices(
    g_matrices: Iterable[MatrixLike],
    h_matrices: Iterable[MatrixLike],
    *,
    field: Field | None = None,
    hermitian: bool = False,
    name: str | None = None,
) -> Pair:
    """The pair (g, h) of the real Lie algebras that two lists of real or complex matrices generate.

    Parameters
    ----------
    g_matrices : sequence of (n, n) array_like
        Generators of g, see `Representation.from_matrices`.
    h_matrices : sequence of (n, n) array_like
        Generators of h, in g. They are the basis of h if they are independent and span a Lie algebra.
    field : Field, optional
        By default the smallest real field that contains the entries of both lists, or their parts.
    hermitian : bool
        All matrices are Hermitian: each is multiplied by i.
    name : str, optional
        A name to print.

    Raises
    ------
    NotInSpanError
        If a matrix of h is not in g; `index` is its index in `h_matrices`.

    Examples
    --------
    >>> import liehom as lh
    >>> pauli = lh.algebra.pauli_matrices()
    >>> pair = lh.pair_from_matrices(pauli[:2], [pauli[2]], hermitian=True)
    >>> pair, lh.decide_fullness(pair).full
    (<pair of dimensions 3/1 over QQ>, True)
    """
    first, second = list_of_matrices(g_matrices), list_of_matrices(h_matrices)
    field = field_of_matrices([*first, *second]) if field is None else field
    if hermitian or any(has_complex_entry(a, field) for a in (*first, *second)):
        first = [*real_matrices(first, field, hermitian=hermitian)]
        second = [*real_matrices(second, field, hermitian=hermitian)]
    rho = Representation.from_matrices(square_matrices(first, field))
    rows = rows_of_matrices(rho, square_matrices(second, field), of=" of h")
    try:
        subalgebra = rho.algebra.subalgebra(rows)
    except (DependentRowsError, NotASubalgebraError):
        subalgebra = rho.algebra.subalgebra_generated_by(rows)
    return Pair(rho.algebra, subalgebra, name=name)


def symmetric_to_vector(matrix: MatrixLike) -> list[Any]:
    """The entries S[i, j], i <= j, of a symmetric matrix in lexicographic order of (i, j).

    Examples
    --------
    >>> symmetric_to_vector([[1, 2], [2, 3]])
    [1, 2, 3]
    """
    rows = matrix.to_rows() if hasattr(matrix, "to_rows") else [list(row) for row in matrix]
    k = len(rows)
    if any(len(row) != k for row in rows):
        raise ShapeError(f"a symmetric matrix is square, got {k} rows of lengths {[len(row) for row in rows]}")
    for i, j in monomials(k, 2):
        if rows[i][j] != rows[j][i]:
            raise InputError(f"the matrix is not symmetric: entries ({i}, {j}) and ({j}, {i}) differ")
    return [rows[i][j] for i, j in monomials(k, 2)]


def vector_to_symmetric(vector: VectorLike, field: Field = QQ) -> Matrix:
    """The symmetric matrix with these entries S[i, j], i <= j, in lexicographic order of (i, j).

    Examples
    --------
    >>> print(vector_to_symmetric([1, 2, 3]))
    [1, 2]
    [2, 3]
    """
    values = list(vector)
    k = next((k for k in range(len(values) + 1) if k * (k + 1) // 2 >= len(values)), 0)
    if k * (k + 1) // 2 != len(values):
        raise ShapeError(f"a vector of length {len(values)} is not one of k (k + 1) / 2 entries")
    position = {place: x for x, place in enumerate(monomials(k, 2))}
    return field.matrix([[values[position[min(i, j), max(i, j)]] for j in range(k)] for i in range(k)], (k, k))
