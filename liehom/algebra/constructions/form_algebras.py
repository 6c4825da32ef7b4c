"""The orthogonal and symplectic Lie algebras of a bilinear form given by its matrix.

For a form F(v, w) = v^T F w, symmetric (s = -1) or skew-symmetric (s = 1), and basis vectors a, b let

    M_ab v = F(a, v) b + s F(b, v) a,      [M_ab, M_cd] = F_ac M_bd + s F_bc M_ad + F_ad M_cb + s F_bd M_ca.

These span {X : X^T F + F X = 0} if F is not degenerate. The formulas need no division.
"""

from __future__ import annotations

import itertools

from liehom.algebra.closure.closure import lie_closure, square_matrices
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import InputError, ShapeError, displayed
from liehom.scalars import Matrix, Scalar
from liehom.scalars.fields.field import MatrixLike


def so_form(form: MatrixLike, *, name: str | None = None) -> LieAlgebra:
    """The orthogonal algebra {X : X^T S + S X = 0} of a symmetric form S, which may be degenerate.

    Parameters
    ----------
    form : (n, n) array_like
        The symmetric matrix S: integers, fractions, strings such as 'sqrt(2)', sympy numbers, or floats.
    name : str, optional

    Returns
    -------
    LieAlgebra
        Over the field of the entries. If S is not degenerate, of dimension n (n - 1) / 2 with the basis M_ij,
        i < j, of the module; ``so_form(identity)`` is so(n) and a diagonal of signs gives so(p, q). If S has
        rank r < n, of dimension r (r - 1) / 2 + (n - r) n: all maps into the radical of S belong to it.

    Raises
    ------
    ShapeError
        If the matrix is not square.
    InputError
        If it is not symmetric.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so_form([[0, 0, 1], [0, 1, 0], [1, 0, 0]])
    >>> print(g)
    Lie algebra so of a form of signature (2, 1) over QQ, dimension 3
      basis m12, m13, m23
      [m12, m13] = m12
      [m12, m23] = -m13
      [m13, m23] = m23
    >>> lh.so_form([[1, 0], [0, 0]]).dimension
    2
    """
    matrix = _form(form, -1)
    positive, negative, zero = matrix.signature()
    signature = f"({positive}, {negative}, {zero})" if zero else f"({positive}, {negative})"
    return _algebra(matrix, -1, name or f"so of a form of signature {signature}", zero > 0)


def sp_form(form: MatrixLike, *, name: str | None = None) -> LieAlgebra:
    """The symplectic algebra {X : X^T J + J X = 0} of a skew-symmetric form J, which may be degenerate.

    Parameters
    ----------
    form : (n, n) array_like
        The skew-symmetric matrix J, with entries as for `so_form`.
    name : str, optional

    Returns
    -------
    LieAlgebra
        Over the field of the entries. If J is not degenerate (then n is even), of dimension n (n + 1) / 2 with
        the basis M_ij, i <= j, of the module; if its rank is r < n, of dimension r (r + 1) / 2 + (n - r) n.

    Raises
    ------
    ShapeError
        If the matrix is not square.
    InputError
        If it is not skew-symmetric.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.sp_form([[0, 1], [-1, 0]]).killing_signature()
    (2, 1, 0)
    >>> lh.sp_form([[0, 1, 0], [-1, 0, 0], [0, 0, 0]]).dimension
    6
    """
    matrix = _form(form, 1)
    rank = matrix.rank()
    return _algebra(matrix, 1, name or f"sp of a form of rank {rank}", rank < matrix.nrows)


def index_name(letter: str, *indices: int) -> str:
    """The name of a basis element; its indices count from 0, those in the name from 1.

    Examples
    --------
    >>> index_name("m", 0, 1), index_name("m", 0, 11)
    ('m12', 'm1_12')
    """
    shown = [str(i + 1) for i in indices]
    return letter + ("_" if any(len(x) > 1 for x in shown) else "").join(shown)


def form_brackets(
    matrix: Matrix, sign: int, positions: dict[tuple[int, int], tuple[int, int]]
) -> list[tuple[int, int, int, Scalar]]:
    """Entries of the bracket table of the M_ab of a form, in a basis of signed M_ab.

    Parameters
    ----------
    matrix : Matrix
        The form F, (n, n).
    sign : int
        s: -1 for a symmetric form, 1 for a skew-symmetric form.
    positions : dict
        (a, b) to (k, e): M_ab is e times basis element k, e = 1 or -1; both orders of a, b are given.

    Returns
    -------
    list of (i, j, k, value)
        The entries with i < j, for `StructureConstants`.
    """
    rows = matrix.to_rows()
    near = [[(b, v) for b, v in enumerate(row) if v != 0] for row in rows]
    basis = {k: pair for pair, (k, e) in positions.items() if e == 1}
    entries: list[tuple[int, int, int, Scalar]] = []
    for i, (a, b) in basis.items():
        found: dict[tuple[int, int], Scalar] = {}
        # M_ab e_c = F_ac e_b + s F_bc e_a, and [X, M_cd] = M_{Xc, d} + M_{c, Xd}
        image: dict[int, list[tuple[int, Scalar]]] = {}
        for c, v in near[a]:
            image.setdefault(c, []).append((b, v))
        for c, v in near[b]:
            image.setdefault(c, []).append((a, v * sign))
        for c, moved in image.items():
            for d in range(len(rows)):
                _add_images(found, positions, basis, i, (c, d), moved)
        entries += [(i, j, k, v) for (j, k), v in found.items() if v != 0]
    return entries


def _add_images(
    found: dict[tuple[int, int], Scalar],
    positions: dict[tuple[int, int], tuple[int, int]],
    basis: dict[int, tuple[int, int]],
    i: int,
    pair: tuple[int, int],
    moved: list[tuple[int, Scalar]],
) -> None:
    """Add M_{Xc, d} to the bracket of basis element i with the basis element +-M_cd; twice if c = d."""
    if pair not in positions:
        return
    j, e = positions[pair]
    if j <= i:
        return
    c, d = pair
    for x, v in moved:
        target = positions.get((x, d))
        if target is not None:
            k, f = target
            found[j, k] = found.get((j, k), 0) + v * (e * f * (2 if c == d else 1))


def _form(form: MatrixLike, sign: int) -> Matrix:
    """The matrix of a form, checked: its transpose is -sign times the matrix."""
    if isinstance(form, Matrix):
        matrix = form
    else:
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
    return matrix


def _algebra(matrix: Matrix, sign: int, name: str, degenerate: bool) -> LieAlgebra:
    if degenerate:
        return _degenerate(matrix, name)
    n = matrix.nrows
    pairs = [(a, b) for a in range(n) for b in range(a + (sign < 0), n)]
    positions = {pair: (k, 1) for k, pair in enumerate(pairs)}
    for k, (a, b) in enumerate(pairs):
        if a != b:
            positions[b, a] = (k, sign)
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
