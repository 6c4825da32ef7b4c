"""Representations constructed from a Lie algebra: defining, adjoint, coadjoint, trivial, conjugation of matrices.

Constructions from a representation (dual, sums, products, powers, restriction) are methods of `Representation`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from numbers import Integral
from typing import Any

from liehom.algebra import LieAlgebra
from liehom.algebra import matrices as families
from liehom.algebra.closure.closure import lie_closure, square_matrices
from liehom.algebra.closure.complex_matrices import (
    field_of_matrices,
    has_complex_entry,
    list_of_matrices,
    real_matrices,
)
from liehom.algebra.constructions.simple import simple
from liehom.algebra.matrices.named_matrices import classical_matrices, exceptional_matrices, linear_lie_algebra
from liehom.budget import within
from liehom.errors import (
    DependentRowsError,
    InputError,
    NotASubalgebraError,
    RepresentationError,
    ShapeError,
    displayed,
)
from liehom.representations.core.coordinates import Coordinates
from liehom.representations.core.elements import rows_of_matrices
from liehom.representations.core.pair import Pair
from liehom.representations.core.representation import Representation
from liehom.representations.highest_weight.highest_weight import highest_weight_module
from liehom.representations.highest_weight.real_form_module import real_module
from liehom.representations.invariants.induced import congruence_map, monomials
from liehom.scalars import QQ, ExactField, Field, Matrix
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import IntegerArray, VectorLike

_CLASSICAL = re.compile(r"(gl|sl|so|su|u|sp|spin)\(([0-9]+)(?:,([0-9]+|[RCH]))?\)")
_COMPLEX = re.compile(r"s?u\([0-9]+(,[0-9]+)?\)|(gl|sl|so|sp)\([0-9]+,C\)")
_SO_STAR = re.compile(r"so\*\(([0-9]*[02468])\)")


def defining(algebra: LieAlgebra | str) -> Representation:
    """The defining representation of a classical or exceptional algebra by its standard matrices.

    Parameters
    ----------
    algebra : LieAlgebra or str
        An algebra whose name is one of 'gl(n)', 'sl(n)' (also 'sl(n,C)', 'sl(n,H)'), 'so(p)', 'so(p,q)',
        'so(n,C)', 'so*(2n)', 'su(p,q)', 'u(p,q)', 'sp(p,q)' (quaternionic), 'sp(2n,R)', 'sp(2n,C)',
        'spin(p,q)', or an exceptional one such as 'g2', 'g2(2)', 'f4', 'e6(-26)', in the basis of its
        standard matrices; or such a name.

    Returns
    -------
    Representation
        A representation of this algebra. C^n is R^(2n) and H^n is R^(4n).

    Raises
    ------
    InputError, CatalogError
        If the name is not known.
    RepresentationError
        If the algebra does not have the basis of the standard matrices, for example after a change of basis.

    Notes
    -----
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
    """
    if not isinstance(algebra, str):
        _require_algebra(algebra)
    name = algebra if isinstance(algebra, str) else algebra.name
    if (least := _LEAST_MODULES.get((name or "").replace(" ", ""))) is not None:
        return _of_algebra(least(), algebra)
    matrices = standard_matrices(name)
    size = int(matrices.shape[1])
    coordinates = _coordinates(name)
    if isinstance(algebra, str) and not len(matrices):
        zero = linear_lie_algebra(matrices, name)
        return Representation(zero, [], size=size, name="defining", coordinates=coordinates)
    if isinstance(algebra, str):
        made = lie_closure(matrices, close=False, name=name)
        # The constants are those of the commutators themselves.
        return Representation(made.algebra, made.matrices, name="defining", coordinates=coordinates, check=False)
    if isinstance(algebra.field, ExactField):
        over = [algebra.field.from_integers(a.ravel().tolist(), size, size) for a in matrices]
    else:
        over = [algebra.field.from_entries([float(x) for x in a.ravel().tolist()], size, size) for a in matrices]
    if len(over) != algebra.dimension:
        raise RepresentationError(
            (0, 0), f"{displayed(algebra)} does not have the dimension {len(over)} of the standard matrices of {name}"
        )
    return Representation(algebra, over, size=size, name="defining", coordinates=coordinates)


def _coordinates(name: str | None) -> Coordinates:
    """Whether the standard matrices of a name are on C^n, in the convention of complex matrices."""
    return "complex" if _COMPLEX.fullmatch((name or "").replace(" ", "")) else "real"


def _of_algebra(rho: Representation, algebra: LieAlgebra | str) -> Representation:
    """The representation with the same matrices for an equal algebra, which may be over a larger field."""
    if isinstance(algebra, str):
        return rho
    made = rho if algebra.field == rho.field else rho.over(algebra.field)
    if made.algebra != algebra:
        raise RepresentationError((0, 0), f"{displayed(algebra)} does not have the basis that liehom.simple gives it")
    # the constants are those of the algebra that the matrices represent
    return Representation(algebra, made.matrices, size=made.size, name=made.name, check=False)


def _adjoint_of(type_name: str, form: str) -> Callable[[], Representation]:
    return lambda: adjoint(simple(type_name, form))


def _least_real_module(form: str, weight: Sequence[int]) -> Callable[[], Representation]:
    return lambda: real_module(form, weight).representation


# The exceptional forms without a family of matrices, in the bases of `liehom.simple`.
_LEAST_MODULES: dict[str, Callable[[], Representation]] = {
    **{name: _least_real_module(name, [1, 0, 0, 0, 0, 0]) for name in ("e6(2)", "e6(-14)", "e6")},
    **{name: _least_real_module(name, [0, 0, 0, 0, 0, 0, 1]) for name in ("e7(-5)", "e7(-25)", "e7")},
    "e7(7)": lambda: highest_weight_module("E7", [0, 0, 0, 0, 0, 0, 1]).representation,
    **{name: _adjoint_of("E8", name) for name in ("e8(8)", "e8(-24)", "e8")},
}


def standard_matrices(name: str | None) -> IntegerArray:
    """The standard basis of a named matrix algebra, integer matrices of shape (dim, N, N).

    Raises
    ------
    InputError, CatalogError
        If the name is not known.

    Examples
    --------
    >>> standard_matrices("so(4)").shape, standard_matrices("sp(4,R)").shape
    ((6, 4, 4), (10, 4, 4))
    """
    text = (name or "").replace(" ", "")
    if match := _CLASSICAL.fullmatch(text):
        kind, first, second = match.groups()
        parameter = 0 if second is None else int(second) if second.isdigit() else second
        return classical_matrices(kind, int(first), parameter)
    if match := _SO_STAR.fullmatch(text):
        return families.so_star(int(match[1]) // 2)
    if text[:2] in ("g2", "f4", "e6"):
        return exceptional_matrices(text)
    known = "so(4), so(3,1), su(2), sl(3), sl(2,C), gl(2), sp(2), sp(4,R), so*(6), spin(7), g2, f4, e6(-26)"
    raise InputError(f"no defining representation is known for {displayed(name)}; names are such as {known}")


def adjoint(algebra: LieAlgebra) -> Representation:
    """The adjoint representation x -> ad x on g.

    Raises
    ------
    InputError
        If the argument is not a `LieAlgebra`, for example a name.

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
    n, over = algebra.dimension, algebra.field
    if over != QQ:
        return [algebra.ad(over.unit(n, i)) for i in range(n)]
    table = algebra.table
    made = [QQ.zeros(n, n) for _ in range(n)]
    for (i, j), terms in table.by_pair().items():
        (numerators,) = made[i].parts  # of a new matrix, which is written to entry by entry
        for k, value in terms:
            numerators[k, j] = value
    return [*made] if table.den == 1 else [a.scale(QQ.one / table.den) for a in made]


def coadjoint(algebra: LieAlgebra) -> Representation:
    """The coadjoint representation x -> -(ad x)^T on the dual of g, in the dual basis.

    Raises
    ------
    InputError
        If the argument is not a `LieAlgebra`.

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
    >>> lh.trivial(lh.so(3), 2).isotropy([1, 0]).dimension
    3
    """
    if isinstance(n, bool) or not isinstance(n, int) or n < 0:
        raise InputError(f"the dimension of a trivial representation is an integer at least 0, got {displayed(n)}")
    _require_algebra(algebra)
    zero = algebra.field.zeros(n, n)
    # All commutators and all images vanish.
    return Representation(algebra, [zero] * algebra.dimension, size=n, name="trivial", check=False)


def sym_conjugation(k: int, algebra: LieAlgebra | None = None) -> Representation:
    """The representation of so(k) on the symmetric matrices Sym(k) by S -> A S - S A.

    Parameters
    ----------
    k : int
        Size of the matrices, at least 1.
    algebra : LieAlgebra, optional
        A copy of so(k) in its standard basis (default: a new one named 'so(k)').

    Returns
    -------
    Representation
        On K^(k (k + 1) / 2). The coordinates are the entries S[i, j], i <= j, in lexicographic order of (i, j), as in
        `symmetric_to_vector` and `vector_to_symmetric`.

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
    made = [induced(a) for a in rho.matrices]
    return Representation(rho.algebra, made, size=induced.target, name=f"conjugation on Sym({k})", check=False)


def hermitian_conjugation(k: int, algebra: LieAlgebra | None = None) -> Representation:
    """The representation of su(k) on the Hermitian k x k matrices by H -> A H - H A.

    Parameters
    ----------
    k : int
        Size of the matrices, at least 1.
    algebra : LieAlgebra, optional
        A copy of su(k) in its standard basis (default: a new one named 'su(k)').

    Returns
    -------
    Representation
        On K^(k^2), see `Representation.on_hermitian_matrices`. The coordinates are H[i, i], and Re H[i, j], Im H[i, j]
        for i < j, in lexicographic order of (i, j).

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
    made = rho.on_hermitian_matrices()
    title = f"conjugation of Hermitian {k} x {k} matrices"
    # the same matrices with a name
    return Representation(
        rho.algebra, made.matrices, size=made.size, name=title, coordinates=made.coordinates, check=False
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
    ShapeError, InputError
        See `Representation.from_matrices`.

    Examples
    --------
    >>> import liehom as lh
    >>> pauli = lh.pauli_matrices()
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

    Raises
    ------
    ShapeError, InputError
        If the matrix is not square, or not symmetric.

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

    Raises
    ------
    ShapeError
        If the length is not k (k + 1) / 2.

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
    made: Matrix = field.matrix([[values[position[min(i, j), max(i, j)]] for j in range(k)] for i in range(k)], (k, k))
    return made
