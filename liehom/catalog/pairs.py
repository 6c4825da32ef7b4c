"""Pairs by name: the linear Lie algebra G and the subalgebra H of a name ``G/H``.

affine(H)       H + R^N over H                       sym(n;m1,m2,...)   so(n), a symmetric matrix with multiplicities
G/0, G/G        trivial ones                         e(n)/so(n), iso(p,q)/so(p,q), galilei(n)/so(n), bargmann(n)/so(n),
                                                     schroedinger(n)/so(n), aff(n)/gl(n), R^n/R^m, heisenberg(n)/R
G/Pk, G/P       the stabilizer of a k-dimensional subspace over the scalars, isotropic if G preserves a form; P = P1;
                in e6 the stabilizer of the line of an idempotent, in g2(2) of a null line
G/P{i,j,...}    the parabolic subalgebra of a simple real algebra with these nodes of the Satake diagram crossed
G/B             in sl(n) and gl(n) the stabilizer of a complete flag
G/H             the subalgebra in the table of `special`; otherwise H as diagonal blocks of the matrices of G
"""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np

from liehom.algebra import LieAlgebra, Subalgebra, abelian, direct_sum, semidirect_sum
from liehom.algebra.matrices.named_matrices import linear_lie_algebra
from liehom.catalog.algebras import affine_algebra, algebra_of
from liehom.catalog.claims import CLAIMS
from liehom.catalog.linear import irrational_spiral, is_linear, linear_matrices
from liehom.catalog.names import Expression, Quotient, Term, canonical, parse, terms, unknown
from liehom.catalog.parabolics import parabolic_pair
from liehom.catalog.special import parabolic_rows, special_rows
from liehom.catalog.subalgebras import coordinates, placements, preserving
from liehom.errors import CatalogError
from liehom.representations import Pair
from liehom.scalars import ExactField, number_field
from liehom.typing import IntegerArray, ScalarLike

_ROTATING = ("e", "iso", "galilei", "bargmann", "schroedinger")
"""Families whose first basis elements are those of so(n) or so(p,q)."""


def pair(name: str) -> Pair:
    """The pair with a catalogue name.

    Parameters
    ----------
    name : str
        Such as 'so(4)/so(3)', 'su(3)/u(2)', 'sl(3)/P1', 'affine(spin(9,1)+R)', 'sym(4;3,1)'; `pair_names` lists
        one of each kind; other sizes are valid too.

    Returns
    -------
    Pair
        Named by the canonical form of the given name; its repr is the call that constructs it.

    Raises
    ------
    CatalogError
        If the name is not in the catalogue; the message lists the nearest names.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.pair("so(4)/so(3)"), lh.pair("sl(3, R)/P1").name
    (pair('so(4)/so(3)'), 'sl(3)/P1')
    >>> lh.pair("so(4)/so(5)")
    Traceback (most recent call last):
    ...
    liehom.errors.CatalogError: 'so(4)/so(5)' is not the name of a pair in the catalogue; the nearest are ...
    """
    tree = parse(name)
    if isinstance(tree, Quotient) and isinstance(tree.bottom, Term) and tree.bottom.head.startswith("P{"):
        if not isinstance(tree.top, Term):
            raise unknown(str(tree), CLAIMS, "pair")
        return parabolic_pair(tree.top, tree.bottom)
    if isinstance(tree, Quotient):
        return _quotient(tree)
    if isinstance(tree, Term) and tree.head == "affine":
        return _affine(tree)
    if isinstance(tree, Term) and tree.head == "sym" and tree.after:
        return _symmetric(tree)
    raise unknown(str(tree), CLAIMS, "pair")


def pair_names() -> tuple[str, ...]:
    """Names of pairs of every kind, full pairs first.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.catalog.pair_names()[:2]
    ('so(2)/so(1)', 'so(3)/so(2)')
    """
    return tuple(CLAIMS)


def _made(algebra: LieAlgebra, rows: IntegerArray, name: object, *, check: bool = False) -> Pair:
    matrix = algebra.field.from_integers(rows.ravel().tolist(), len(rows), algebra.dimension)  # type: ignore[attr-defined]
    return Pair(algebra, Subalgebra(algebra, matrix, check=check), name=None if name is None else str(name))


def _affine(tree: Term) -> Pair:
    if len(tree.items) != 1 or isinstance(tree.items[0], int | Fraction) or tree.after or not is_linear(tree.items[0]):
        raise unknown(str(tree), CLAIMS, "pair")
    spiral = irrational_spiral(tree.items[0])
    if spiral is not None:
        matrices, j, square, frequency = spiral
        return spiral_pair(matrices, j, number_field(f"sqrt({square})"), f"sqrt({square})", frequency, str(tree))
    matrices = linear_matrices(tree.items[0])
    algebra = affine_algebra(matrices, str(tree))
    # no check: the linear part of an affine algebra is a subalgebra
    return _made(algebra, _first(len(matrices), algebra.dimension), tree)


def spiral_pair(
    matrices: IntegerArray,
    j: IntegerArray,
    field: ExactField,
    growth: ScalarLike,
    frequency: ScalarLike,
    name: str | None,
) -> Pair:
    """X + K (a + bJ) on K^N with the translations, for matrices X that commute with J and a, b in a field K.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.pair("affine(spiral(sqrt(2),1))").field
    QQ(sqrt(2))
    """
    size = j.shape[0]
    read = [field.from_integers(a.ravel().tolist(), size, size) for a in (*matrices, j)]
    spiral = field.identity(size).scale(growth) + read.pop().scale(frequency)
    # no check: the matrices commute with the spiral and are a basis of their span
    h = direct_sum(linear_lie_algebra(matrices), abelian(1)).over(field)
    algebra = semidirect_sum(h, [*read, spiral], size=size, name=name, check=False)
    return _made(algebra, _first(len(matrices) + 1, algebra.dimension), name)


def _symmetric(tree: Term) -> Pair:
    """so(n) with the stabilizer of diag(1, ..., 1, 2, ..., 2, ...) in the symmetric matrices."""
    (n,) = tree.integers() if len(tree.items) == 1 else (0,)
    multiplicities = [int(m) for m in tree.after]
    if n < 1 or any(m < 1 for m in multiplicities) or sum(multiplicities) != n:
        raise CatalogError(f"sym(n;m1,m2,...) needs positive multiplicities with sum n; got {tree}")
    matrices = linear_matrices(Term("so", (n,)))
    point = np.diag(np.repeat(np.arange(1, len(multiplicities) + 1), multiplicities))
    rows = preserving(matrices, commuting=[point])
    return _made(linear_lie_algebra(matrices, f"so({n})"), rows, tree)  # a stabilizer


def _quotient(tree: Quotient) -> Pair:
    top, bottom = tree.top, tree.bottom
    plain = _not_linear(top, bottom)
    if plain is not None:
        return _made(*plain, tree)
    if not is_linear(top):
        raise unknown(str(tree), CLAIMS, "pair")
    matrices = linear_matrices(top)
    algebra = linear_lie_algebra(matrices, str(top))
    rows = _rows(top, bottom, matrices)
    if rows is not None:
        return _made(algebra, rows, tree)  # no check: the stabilizer of something, see `preserving`
    rows = _included(matrices, bottom)
    if rows is not None:
        return _made(algebra, rows, tree, check=True)
    raise unknown(str(tree), CLAIMS, "pair")


def _rows(top: Expression, bottom: Expression, matrices: IntegerArray) -> IntegerArray | None:
    """The rows of a subalgebra that is the stabilizer of something, or None."""
    if bottom == Term("0"):
        return np.zeros((0, len(matrices)), dtype=np.int64)
    if not isinstance(top, Term):
        return None
    if isinstance(bottom, Term) and not bottom.items and re.fullmatch(r"P\d*|B", bottom.head):
        return parabolic_rows(top, bottom.head, matrices)
    return special_rows(top, bottom, matrices)


def _included(matrices: IntegerArray, bottom: Expression) -> IntegerArray | None:
    """The rows of the subalgebra whose matrices are diagonal blocks of the algebra, in some order, or None."""
    if not is_linear(bottom):
        return None
    size = matrices.shape[1]
    try:
        whole = linear_matrices(bottom)
    except CatalogError:  # the sum means blocks, not an algebra with scalars
        whole = None
    if whole is not None and whole.shape[1] == size:
        rows = coordinates(matrices, whole)
        if rows is not None:
            return rows
    for placed in placements([linear_matrices(t) for t in terms(bottom)], size):
        rows = coordinates(matrices, placed)
        if rows is not None:
            return rows
    return None


def _not_linear(top: Expression, bottom: Expression) -> tuple[LieAlgebra, IntegerArray] | None:
    """Abelian, Euclidean, affine and Heisenberg algebras with the rows of a named subalgebra, or None."""
    if not isinstance(top, Term) or not isinstance(bottom, Term):
        return None
    known = top.head in ("0", "R", "heisenberg", "aff", "affine", *_ROTATING) or top.head.startswith("R^")
    if not known or (top.head == "R" and bottom.head not in ("0", "R")):
        return None
    algebra = algebra_of(top)
    n = algebra.dimension
    if bottom.head == "0":
        return algebra, _first(0, n)
    if top.head[0] in "0R" and bottom.head[0] == "R" and algebra_of(bottom).dimension <= n:
        return algebra, _first(algebra_of(bottom).dimension, n)
    beginning = {"aff": Term("gl", top.items)}.get(top.head, canonical(Term("so", top.items)))
    if (top.head in (*_ROTATING, "aff") and bottom == beginning) or (str(top) == "aff(1)" and bottom == Term("R")):
        return algebra, _first(algebra_of(bottom).dimension, n)
    if top.head == "heisenberg" and bottom == Term("R"):
        return algebra, np.eye(n, dtype=np.int64)[-1:]
    if top.head == "affine" and len(top.items) == 1 and top.items[0] == bottom:
        return algebra, _first(algebra_of(bottom).dimension, n)
    return None


def _first(k: int, n: int) -> IntegerArray:
    """The rows (k, n) of the first k basis elements."""
    return np.eye(n, dtype=np.int64)[:k]
