"""Pairs of a classical algebra or g2 and a subalgebra h that acts irreducibly, from modules with rational matrices.

The classical hull of an irreducible linear algebra is the largest linear algebra with the same commutant and the same
invariant form: so, sp, su or sl over the reals, the complex numbers or the quaternions. For h of type A1 on R^7, the
stabilizer of the invariant three-form is g2 or g2(2). Everything is linear algebra over QQ.
"""

from __future__ import annotations

import numpy as np

from liehom.algebra import Subalgebra
from liehom.algebra.matrices import exterior_power
from liehom.algebra.matrices.matrix_basis import null_space
from liehom.algebra.matrices.named_matrices import classical_matrices, linear_lie_algebra
from liehom.catalog.linear import linear_matrices
from liehom.catalog.names import parse_expression
from liehom.catalog.subalgebras import coordinates, preserving
from liehom.errors import InputError
from liehom.representations import Pair, Representation, real_module
from liehom.scalars import QQ, Matrix, as_exact
from liehom.typing import IntegerArray


def module_pair(name: str, form: str, weight: tuple[int, ...]) -> Pair:
    """The pair of the classical hull of an irreducible real module, and the algebra that acts.

    Parameters
    ----------
    name : str
        The name of the pair.
    form : str
        The name of a simple real algebra.
    weight : tuple of int
        The highest weight of the module, as in `liehom.real_module`.

    Examples
    --------
    >>> module_pair("so(3,2)/S4(sl(2))", "sl(2,R)", (4,)).algebra.real_form()
    'so(3,2)'
    """
    representation = real_module(form, weight).representation
    return hull_pair(name, np.stack([integers(m) for m in representation.matrices]))


def linear_pair(name: str, linear: str) -> Pair:
    """The pair of the classical hull of an irreducible linear Lie algebra of the catalogue, and this algebra.

    Examples
    --------
    >>> linear_pair("sp(6,R)/tensor(sl(2),so(2,1))", "tensor(sl(2),so(2,1))").dimension
    15
    """
    return hull_pair(name, linear_matrices(parse_expression(linear)))


def principal_pair(name: str, form: str) -> Pair:
    """The pair of g2 or g2(2) and its principal three-dimensional subalgebra, for the form so(3) or sl(2,R).

    Examples
    --------
    >>> principal_pair("g2/principal(so(3))", "so(3)").algebra.real_form()
    'g2'
    """
    matrices = np.stack([integers(m) for m in real_module(form, (6,)).representation.matrices])
    invariant = null_space(exterior_power(matrices, 3).reshape(-1, 35))  # unique up to a factor
    whole = classical_matrices("gl", 7, "R")
    rows = preserving(exterior_power(whole, 3), points=list(invariant))
    return _of_matrices(name, np.tensordot(rows, whole, axes=1), matrices)


def hull_pair(name: str, matrices: IntegerArray) -> Pair:
    """The pair of the classical hull of an irreducible linear Lie algebra, given by a basis of matrices, and itself.

    Examples
    --------
    >>> from liehom.algebra.matrices import su
    >>> hull_pair("so(8)/ad(su(3))", su(3)).dimension  # su(3) on C^3 is its own hull
    0
    """
    return _of_matrices(name, classical_hull(matrices), matrices)


def classical_hull(matrices: IntegerArray) -> IntegerArray:
    """The classical linear Lie algebra of an irreducible representation, as a matrix basis.

    Parameters
    ----------
    matrices : (k, N, N) integers
        A basis of the image of a semisimple algebra.

    Returns
    -------
    (m, N, N) integers
        All matrices without trace that commute with the commutant, preserve the invariant form if there is one, and if
        the commutant is C have no trace over C.

    Examples
    --------
    The adjoint representation of so(3) has so(3), and su(2) on R^4 has sp(1):

    >>> from liehom.algebra.matrices import so, su
    >>> len(classical_hull(so(3))), len(classical_hull(su(2)))
    (3, 3)
    """
    size = matrices.shape[1]
    algebra = linear_lie_algebra(matrices)
    representation = Representation(algebra, list(matrices), check=False)
    commutant = [integers(c) for c in representation.commutant()]
    forms = representation.invariant_forms()
    form = [*forms.symmetric, *forms.skew][:1]
    whole = classical_matrices("gl", size, "R")
    rows = preserving(whole, commuting=commutant, forms=[integers(p) for p in form])
    found = np.tensordot(rows, whole, axes=1)
    scalars = commutant if len(commutant) == 2 else [np.eye(size, dtype=np.int64)]
    traces = np.stack([np.einsum("aij,ji->a", found, c) for c in scalars])
    kept: IntegerArray = np.tensordot(null_space(traces), found, axes=1)
    return kept


def complexified(pair: Pair, name: str) -> Pair:
    """The complexification of a real pair, as a pair of real algebras with the bases x, i x.

    Examples
    --------
    >>> import liehom as lh
    >>> complexified(lh.pair("g2(2)/sl(3)"), "g2(C)/sl(3,C)").algebra.real_form()
    'g2(C)'
    """
    algebra = pair.algebra.complexification(name=name.partition("/")[0]).algebra
    rows = as_exact(pair.subalgebra.basis)
    none = rows.field.zeros(*rows.shape)
    blocks = [rows.field.stack_columns([rows, none], rows.nrows), rows.field.stack_columns([none, rows], rows.nrows)]
    # no check: x and i x for the basis elements x of a subalgebra
    return Pair(algebra, Subalgebra(algebra, rows.field.stack_rows(blocks, algebra.dimension), check=False), name=name)


def integers(matrix: Matrix) -> IntegerArray:
    """The primitive integer multiple of a rational matrix, as an array.

    Examples
    --------
    >>> integers(QQ.matrix([["1/2", 1]])).tolist()
    [[1, 2]]
    """
    entries = as_exact(matrix).reshape(1, matrix.nrows * matrix.ncols).primitive().parts[0].entries()
    return np.array([int(x) for x in entries], dtype=np.int64).reshape(matrix.shape)


def _of_matrices(name: str, whole: IntegerArray, part: IntegerArray) -> Pair:
    """The pair of two linear Lie algebras, the second in the first."""
    algebra = linear_lie_algebra(whole, name.partition("/")[0])
    rows = coordinates(whole, part)
    if rows is None:
        raise InputError(f"{name}: the matrices of h are not in the span of the matrices of g")
    return Pair(algebra, Subalgebra(algebra, QQ.from_integers(rows.ravel().tolist(), len(rows), len(whole))), name=name)
