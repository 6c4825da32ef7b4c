"""Classical Lie algebras, algebras of forms and simple algebras by type."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any, cast

from liehom.base.errors import CatalogError, InputError, ShapeError, displayed
from liehom.base.typing import IntegerArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear import linear_bases
from liehom.exact.algebra.linear.closure import lie_closure, square_matrices
from liehom.exact.algebra.linear.linear_bases import require_size
from liehom.exact.algebra.linear.named_matrices import (
    EXCEPTIONAL_MATRICES,
    Parameter,
    classical_matrices,
    classical_name,
    linear_lie_algebra,
)
from liehom.exact.algebra.roots.chevalley import chevalley, real_form_of
from liehom.exact.algebra.roots.real_form import RealForm, canonical_real_form, complex_form, parse_name, real_forms
from liehom.exact.algebra.roots.root_system import parse_type
from liehom.exact.scalars.field import Matrix, MatrixLike, Scalar

# The classical Lie algebras gl, sl, so, su, u, sp and so*(2n), and the parabolic subalgebras of sl(n).
# Each is over QQ, in the basis of its matrices (`liehom.exact.algebra.linear`), and has a name that the catalogue
# reads.


def gl(n: int, over: str = "R") -> LieAlgebra:
    """The real Lie algebra gl(n) over 'R', 'C' or 'H', of dimension n**2, 2 n**2 or 4 n**2.

    The basis is E_ij, row by row (``lh.defining(g)`` has the matrices). Over C each E_ij is followed by i E_ij, over H
    by i E_ij, j E_ij, k E_ij.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.gl(2).dimension, lh.gl(1, "H").dimension
    (4, 4)
    """
    return _classical("gl", n, over)


def sl(n: int, over: str = "R") -> LieAlgebra:
    """The real Lie algebra sl(n) over 'R', 'C' or 'H'; over H, the real trace vanishes.

    The basis is E_ij for i != j, row by row, then E_ii - E_{i+1,i+1}. Over C each of these is followed by its multiple
    by i. Over H it is q E_ij for i != j and q = 1, i, j, k, then q E_ii for q = i, j, k, then E_ii - E_{i+1,i+1}.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sl(3), lh.sl(2, "H").dimension
    (<Lie algebra sl(3) of dimension 8 over QQ>, 15)
    """
    return _classical("sl", n, over)


def so(p: int, q: int | str = 0) -> LieAlgebra:
    """The real Lie algebra so(p, q), of dimension n (n - 1) / 2 with n = p + q, or so(n, 'C').

    The basis is L_ij = d_i E_ji - d_j E_ij for i < j in lexicographic order, with d_i = 1 for the first p indices and
    -1 for the others (for p = 0 all are 1). In so(n), L_ij rotates e_i towards e_j. For n = 3 these are hat(z),
    -hat(y), hat(x) with hat(w) v = w x v. In so(n, 'C') each E_ji - E_ij is followed by its multiple by i.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.so(3).killing_signature(), lh.so(2, 1).killing_signature(), lh.so(3, "C").dimension
    ((0, 3, 0), (2, 1, 0), 6)
    """
    return _classical("so", p, q)


def su(p: int, q: int = 0) -> LieAlgebra:
    """The real Lie algebra su(p, q), of dimension n**2 - 1 with n = p + q.

    The basis is d_k E_lk - d_l E_kl, then i (d_k E_lk + d_l E_kl), for each k < l in lexicographic order, and after all
    these i (E_kk - E_{k+1,k+1}); d_k = 1 for the first p indices and -1 for the others (for p = 0 all are 1). On R^2n
    an entry a + bi is the block [[a, -b], [b, a]]. In su(2) these are -i sigma_y, i sigma_x, i sigma_z.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.su(3).killing_signature(), lh.su(1, 1).killing_signature()
    ((0, 8, 0), (2, 1, 0))
    """
    return _classical("su", p, q)


def u(p: int, q: int = 0) -> LieAlgebra:
    """The real Lie algebra u(p, q), of dimension n**2 with n = p + q.

    The basis is i E_kk for all k, then for k < l the elements of `su`: d_k E_lk - d_l E_kl and i (d_k E_lk + d_l E_kl).

    Examples
    --------
    >>> import liehom as lh
    >>> lh.u(2).center().dimension
    1
    """
    return _classical("u", p, q)


def sp(p: int, q: int | str = 0) -> LieAlgebra:
    """The compact sp(n), sp(p, q) on H^(p+q), or with a letter the split sp(2n, 'R') and sp(2n, 'C').

    Parameters
    ----------
    p : int
        If q is a number, sp(p, q) has dimension n (2n + 1) with n = p + q; sp(1) = su(2). If q is a letter, p is the
        even size 2n.
    q : int, 'R' or 'C'

    Notes
    -----
    The basis of sp(p, q) is i E_kk for all k, j E_kk for all k, k E_kk for all k (the units i, j, k of H), then for
    each k < l and x = 1, i, j, k the matrix d_k x E_lk - d_l conj(x) E_kl, with the signs d of `su`. On R^4n an entry
    x is the block of the left multiplication by x in the basis 1, i, j, k.

    The basis of sp(2n, 'R') is E_ij - E_{n+j,n+i} row by row, then for i <= j in lexicographic order
    E_{i,n+j} + E_{j,n+i} (E_{i,n+i} for i = j), then the transposes of these. In sp(2n, 'C') each is followed by its
    multiple by i.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sp(2).killing_signature(), lh.sp(4, "R").killing_signature(), lh.sp(1, 1).killing_signature()
    ((0, 10, 0), (6, 4, 0), (4, 6, 0))
    """
    return _classical("sp", p, q)


def so_star(n: int) -> LieAlgebra:
    """The real Lie algebra so*(2n) = {X in gl(n, H) : X* j + j X = 0}, of dimension n (2n - 1).

    The basis is j E_kk for all k, then for each k < l and q = 1, i, j, k the matrix q E_kl + j conj(q) j E_lk.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.algebra.so_star(3), lh.algebra.so_star(3).killing_signature()
    (<Lie algebra so*(6) of dimension 15 over QQ>, (6, 9, 0))
    """
    require_size("n", n)
    return linear_lie_algebra(linear_bases.so_star(n), f"so*({2 * n})")


def parabolic_subalgebra(*sizes: int) -> Subalgebra:
    """The parabolic subalgebra of block upper triangular matrices in sl(n).

    Parameters
    ----------
    *sizes : int
        The sizes of the diagonal blocks, at least one, each at least 1; n is their sum. Sizes 1, ..., 1 give the Borel
        subalgebra. (For `LieAlgebra.parabolic_subalgebra` the ends of the blocks are crossed.)

    Examples
    --------
    >>> import liehom as lh
    >>> h = lh.algebra.parabolic_subalgebra(1, 2)
    >>> h, h.algebra.normalizer(h).dimension
    (<subalgebra of dimension 6 in sl(3) over QQ>, 6)
    """
    if not sizes:
        raise InputError("a parabolic subalgebra needs the sizes of its diagonal blocks, such as (1, 2)")
    for size in sizes:
        require_size("the size of a block", size)
    *ends, n = itertools.accumulate(sizes)
    return sl(n).parabolic_subalgebra([end - 1 for end in ends])


def _classical(kind: str, first: int, second: Parameter) -> LieAlgebra:
    return linear_lie_algebra(classical_matrices(kind, first, second), classical_name(kind, first, second))


# The orthogonal and symplectic Lie algebras of a bilinear form given by its matrix.
# For a form F(v, w) = v^T F w, symmetric (s = -1) or skew-symmetric (s = 1), and basis vectors a, b let
#
#     M_ab v = F(a, v) b + s F(b, v) a,      [M_ab, M_cd] = F_ac M_bd + s F_bc M_ad + F_ad M_cb + s F_bd M_ca.
#
# These span {X : X^T F + F X = 0} if F is not degenerate. The formulas need no division.


def so_form(form: MatrixLike, *, name: str | None = None) -> LieAlgebra:
    """The orthogonal algebra {X : X^T S + S X = 0} of a symmetric form S, which may be degenerate.

    It is over the field of the entries. If S is not degenerate, it has dimension n (n - 1) / 2 and the basis M_ij, i <
    j, of the module; ``so_form(identity)`` is so(n) and a diagonal of signs gives so(p, q). If S has rank r < n, the
    dimension is r (r - 1) / 2 + (n - r) n: all maps into the radical of S belong to it.

    Parameters
    ----------
    form : (n, n) array_like
        The symmetric matrix S: integers, fractions, strings such as 'sqrt(2)', sympy numbers, or floats.
    name : str, optional

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.algebra.so_form([[0, 0, 1], [0, 1, 0], [1, 0, 0]])
    >>> print(g)
    Lie algebra so of a form of signature (2, 1) over QQ, dimension 3
      basis m12, m13, m23
      [m12, m13] = m12
      [m12, m23] = -m13
      [m13, m23] = m23
    >>> lh.algebra.so_form([[1, 0], [0, 0]]).dimension
    2
    """
    matrix = _checked_form(form, -1)
    positive, negative, zero = matrix.signature()
    signature = f"({positive}, {negative}, {zero})" if zero else f"({positive}, {negative})"
    return _algebra(matrix, -1, name or f"so of a form of signature {signature}", zero > 0)


def sp_form(form: MatrixLike, *, name: str | None = None) -> LieAlgebra:
    """The symplectic algebra {X : X^T J + J X = 0} of a skew-symmetric form J, which may be degenerate.

    It is over the field of the entries. If J is not degenerate (then n is even), it has dimension n (n + 1) / 2 and the
    basis M_ij, i <= j, of the module; if its rank is r < n, the dimension is r (r + 1) / 2 + (n - r) n.

    J has shape (n, n) and entries as for `so_form`.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.algebra.sp_form([[0, 1], [-1, 0]]).killing_signature()
    (2, 1, 0)
    >>> lh.algebra.sp_form([[0, 1, 0], [-1, 0, 0], [0, 0, 0]]).dimension
    6
    """
    matrix = _checked_form(form, 1)
    rank = matrix.rank()
    return _algebra(matrix, 1, name or f"sp of a form of rank {rank}", rank < matrix.nrows)


def index_name(letter: str, *indices: int) -> str:
    """The name of a basis element; its indices count from 0, those in the name from 1."""
    shown = [str(i + 1) for i in indices]
    return letter + ("_" if any(len(x) > 1 for x in shown) else "").join(shown)


def form_brackets(
    matrix: Matrix, sign: int, positions: dict[tuple[int, int], tuple[int, int]]
) -> list[tuple[int, int, int, Scalar]]:
    """Entries of the bracket table of the M_ab of a form, in a basis of signed M_ab."""
    rows = matrix.to_rows()
    near = [[(b, v) for b, v in enumerate(row) if v != 0] for row in rows]
    entries: list[tuple[int, int, int, Scalar]] = []
    for i, (a, b) in {k: pair for pair, (k, e) in positions.items() if e == 1}.items():
        bracket: dict[tuple[int, int], Scalar] = {}
        # M_ab e_c = F_ac e_b + s F_bc e_a, and [X, M_cd] = M_{Xc, d} + M_{c, Xd}
        image: dict[int, list[tuple[int, Scalar]]] = {}
        for c, term in [(c, (b, v)) for c, v in near[a]] + [(c, (a, v * sign)) for c, v in near[b]]:
            image.setdefault(c, []).append(term)
        for c, moved in image.items():
            for d in range(len(rows)):
                # M_{Xc, d} is a term of the bracket with the basis element +-M_cd, twice if c = d
                j, e = positions.get((c, d), (-1, 0))
                for x, v in moved if j > i else ():
                    if (x, d) in positions:
                        k, f = positions[x, d]
                        bracket[j, k] = bracket.get((j, k), 0) + v * (e * f * (2 if c == d else 1))
        entries += [(i, j, k, v) for (j, k), v in bracket.items() if v != 0]
    return entries


def _checked_form(form: MatrixLike, sign: int) -> Matrix:
    """The matrix of a form, checked: its transpose is -sign times the matrix."""
    matrix: Any = form
    if not isinstance(form, Matrix):
        rows = getattr(form, "tolist", lambda: form)()
        if not hasattr(rows, "__iter__") or isinstance(rows, str):
            raise ShapeError(f"a form is given by a square matrix, got {displayed(form)}")
        matrix = square_matrices([list(rows)])[0]
    if matrix.nrows != matrix.ncols or matrix.nrows == 0:
        raise ShapeError(f"a form is given by a square matrix of size at least 1, got shape {matrix.shape}")
    defect = matrix - matrix.T if sign < 0 else matrix + matrix.T
    if not defect.is_zero():
        kind = "symmetric" if sign < 0 else "skew-symmetric"
        i, j = next((i, j) for i in range(matrix.nrows) for j in range(matrix.nrows) if defect[i, j] != 0)
        shown = [matrix.field.format(matrix[x]) for x in ((i, j), (j, i))]
        raise InputError(f"the form is not {kind}: entry ({i}, {j}) is {shown[0]} and ({j}, {i}) is {shown[1]}")
    return cast(Matrix, matrix)


def _algebra(matrix: Matrix, sign: int, name: str, degenerate: bool) -> LieAlgebra:
    if degenerate:
        return _degenerate(matrix, name)
    n = matrix.nrows
    pairs = [(a, b) for a in range(n) for b in range(a + (sign < 0), n)]
    positions = {pair: (k, 1) for k, pair in enumerate(pairs)}
    positions |= {(b, a): (k, sign) for k, (a, b) in enumerate(pairs) if a != b}
    table = StructureConstants(matrix.field, len(pairs), form_brackets(matrix, sign, positions))
    # The brackets are those of the matrices M_ab, which are independent because F is not degenerate.
    return LieAlgebra(table, basis=[index_name("m", *pair) for pair in pairs], name=name, check=False)


def _degenerate(matrix: Matrix, name: str) -> LieAlgebra:
    """The Lie algebra of all X with X^T F + F X = 0, from the null space of this map."""
    n, field = matrix.nrows, matrix.field
    rows = []
    for a, b in itertools.product(range(n), repeat=2):
        # the image of E_ab has row a of F as row b, and column a of F as column b
        image = [field.zero] * (n * n)
        for x in range(n):
            image[b * n + x] = image[b * n + x] + matrix[a, x]
            image[x * n + b] = image[x * n + b] + matrix[x, a]
        rows.append(image)
    solutions = field.matrix(rows, (n * n, n * n)).left_null_space()
    return lie_closure(solutions.split_rows(n, n), field=field, close=False, name=name).algebra


# Simple real Lie algebras by type and real form: all real forms of all types, and complex algebras as real ones.
# All have integer structure constants. Classical algebras, g2, f4 and two forms of e6 have bases of integer matrices,
# e7(7) and e8(8) have Chevalley bases, and the others have bases of eigenvectors of a Cartan involution.

Builder = Callable[[], LieAlgebra]


def simple(type_name: str, real_form: str | None = None) -> LieAlgebra:
    """The simple real Lie algebra with a given complex type and real form.

    Parameters
    ----------
    type_name : str
        'A3', 'B2', ..., 'E8', 'F4', 'G2'; or the name of a real form alone, such as 'f4(-20)'.
    real_form : str, optional
        Its name, such as 'so(4,1)', 'sl(2,H)', 'so*(6)', 'f4(-20)', 'e7(-25)', 'sl(3,C)', or 'split', 'compact',
        'complex'. Other names of the same algebra, such as 'e8(-248)', are accepted. By default the split form.

    Raises
    ------
    CatalogError
        If there is no such type or form; the message lists the existing forms.

    Notes
    -----
    `liehom.real_forms` describes the forms of a type. Classical algebras have the bases of the constructors `so`,
    `su`, ... See `chevalley` and `liehom.algebra.real_form_of` for other bases.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.simple("G2", "g2").killing_signature(), lh.simple("B2").name, lh.simple("E7", "e7(-25)").dimension
    ((0, 14, 0), 'so(3,2)', 133)
    >>> lh.simple("f4(-20)") == lh.simple("F4", "f4(-20)")
    True
    """
    if not isinstance(type_name, str) or not isinstance(real_form, str | None):
        raise CatalogError(
            "a type and a real form are strings such as 'E7' and 'e7(-25)', got "
            f"{displayed(type_name)} and {displayed(real_form)}"
        )
    if real_form is None and ("(" in type_name or type_name.strip()[:1].islower()):
        form = RealForm.of_name(type_name)
        type_name, real_form = form.type, form.name
    forms = real_form_builders(type_name)
    wanted = next(iter(forms)) if real_form is None else real_form.replace(" ", "")
    wanted = {"split": real_forms(type_name)[0].name, "compact": real_forms(type_name)[-1].name}.get(wanted, wanted)
    if wanted in forms:
        return forms[wanted]()
    complex_one, asked = complex_form(type_name), _canonical(wanted)
    if wanted == "complex" or asked == complex_one.name:
        return _complex_algebra(complex_one)
    for name in forms if asked is not None else ():
        if canonical_real_form(name) == asked:
            return forms[name]()
    known = ", ".join([*forms, complex_one.name])
    raise CatalogError(f"{type_name} has no real form {wanted!r}; known: {known}, and 'split', 'compact', 'complex'")


def real_form_builders(type_name: str) -> dict[str, Builder]:
    """Functions that construct the real forms of a complex type, by name, the split form first."""
    parts = parse_type(type_name)
    if len(parts) != 1 or parts[0] == ("D", 2):
        raise CatalogError(f"{type_name!r} is not the type of a simple Lie algebra, such as A1, B2, C3, D4, G2, F4, E6")
    series, rank = parts[0]
    if series in _CLASSICAL:
        return dict(_CLASSICAL[series](rank))
    return {form.name: _exceptional(form) for form in real_forms(type_name)}


def _canonical(name: str) -> str | None:
    try:
        return canonical_real_form(name)
    except CatalogError:
        return None


def _exceptional(form: RealForm) -> Builder:
    if form.name in EXCEPTIONAL_MATRICES:
        return _of_matrices(EXCEPTIONAL_MATRICES[form.name], form.name)
    return lambda: _split(form) if form.is_split else real_form_of(form.vogan, form.name)


def _complex_algebra(form: RealForm) -> LieAlgebra:
    kind, numbers, _ = parse_name(form.name)
    if not numbers:
        return real_form_of(form.vogan, form.name)
    return linear_lie_algebra(classical_matrices(kind, numbers[0], "C"), form.name)


def _split(form: RealForm) -> LieAlgebra:
    algebra = chevalley(form.type)
    return LieAlgebra(algebra.table, basis=algebra.basis_names, name=form.name, check=False)  # the same table


def _of_matrices(build: Callable[[], IntegerArray], name: str) -> Builder:
    return lambda: linear_lie_algebra(build(), name)


def _real_form(kind: str, first: int, second: int | str = 0) -> tuple[str, Builder]:
    name = classical_name(kind, first, second)
    return name, _of_matrices(lambda: classical_matrices(kind, first, second), name)


def _type_a(rank: int) -> Iterator[tuple[str, Builder]]:
    n = rank + 1
    yield _real_form("sl", n, "R")
    yield from (_real_form("su", n - q, q) for q in range(n // 2 + 1))
    if n % 2 == 0 and n > 2:  # sl(1,H) is su(2)
        yield _real_form("sl", n // 2, "H")


def _type_b(rank: int) -> Iterator[tuple[str, Builder]]:
    yield from (_real_form("so", 2 * rank + 1 - q, q) for q in range(rank, -1, -1))


def _type_c(rank: int) -> Iterator[tuple[str, Builder]]:
    yield _real_form("sp", 2 * rank, "R")
    yield from (_real_form("sp", rank - q, q) for q in range(rank // 2 + 1))


def _type_d(rank: int) -> Iterator[tuple[str, Builder]]:
    yield from (_real_form("so", 2 * rank - q, q) for q in range(rank, -1, -1))
    name = f"so*({2 * rank})"
    yield name, _of_matrices(lambda: linear_bases.so_star(rank), name)


_CLASSICAL = {"A": _type_a, "B": _type_b, "C": _type_c, "D": _type_d}
