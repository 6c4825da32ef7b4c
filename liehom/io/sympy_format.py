"""Exact objects as objects of sympy: numbers, matrices, and arrays of structure constants.

In the other direction nothing is needed: liehom accepts matrices, arrays and numbers of sympy as input.
"""

from __future__ import annotations

from typing import Any, TypeAlias

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.errors import InputError
from liehom.representations.core.representation import Representation
from liehom.scalars import QQ, AlgebraicNumber, Matrix
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.floating import FloatMatrix
from liehom.scalars.fields.sympy_number import sympy_number

SympyObject: TypeAlias = Any
"""An object of sympy, which has no types."""


def to_sympy(obj: object) -> SympyObject:
    """Object of sympy with the same entries: an array, a matrix, a list of matrices or a number.

    Parameters
    ----------
    obj : LieAlgebra, Subalgebra, Representation, Matrix or number

    Returns
    -------
    sympy object
        * for an algebra, the sparse array ``c[i, j, k]`` of shape (n, n, n);
        * for a subalgebra, the matrix of its rows, of shape (k, n);
        * for a representation, the list of its matrices;
        * for a matrix, a matrix; for a number, a number.

        Elements of a number field become expressions in square roots, or in ``CRootOf`` if the generator is not a
        square root.

    Raises
    ------
    InputError
        If `obj` is of another type.

    Examples
    --------
    >>> import liehom as lh
    >>> to_sympy(lh.so(3)).shape, to_sympy(lh.so(3).killing_form())
    ((3, 3, 3), Matrix([
    [-2,  0,  0],
    [ 0, -2,  0],
    [ 0,  0, -2]]))
    >>> to_sympy(lh.number_field("sqrt(2)").convert("1/2 - sqrt(2)"))
    1/2 - sqrt(2)
    """
    if isinstance(obj, LieAlgebra):
        return _array(obj)
    if isinstance(obj, ExactMatrix | FloatMatrix):
        return _matrix(obj)
    if isinstance(obj, Subalgebra):
        return _matrix(obj.basis)
    if isinstance(obj, Representation):
        return [_matrix(a) for a in obj.matrices]
    if isinstance(obj, AlgebraicNumber):
        return sympy_number(obj.field, obj)
    if isinstance(obj, int | float) or type(obj) is type(QQ.one):
        import sympy

        return sympy.Float(obj) if isinstance(obj, float) else sympy_number(QQ, QQ.convert(obj))
    raise InputError(
        f"a {type(obj).__name__} has no form in sympy; "
        "expected an algebra, subalgebra, representation, matrix or number"
    )


def _matrix(matrix: Matrix) -> SympyObject:
    import sympy

    return sympy.Matrix(*matrix.shape, [sympy_number(matrix.field, x) for row in matrix.to_rows() for x in row])


def _array(algebra: LieAlgebra) -> SympyObject:
    import sympy

    n, entries = algebra.dimension, {}
    for i, j, k, v in algebra.structure_constants():
        value = sympy_number(algebra.field, v)
        entries[(i * n + j) * n + k] = value
        entries[(j * n + i) * n + k] = -value
    return sympy.ImmutableSparseNDimArray(entries, (n, n, n))
