"""Exact objects as sympy has them: numbers, matrices, and arrays of structure constants.

Into liehom, sympy's matrices, arrays and numbers go as they are.
"""

from __future__ import annotations

from typing import Any

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.errors import InputError
from liehom.representations.core.representation import Representation
from liehom.scalars import QQ, AlgebraicNumber, Field, FloatField, NumberField
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.floating import FloatMatrix


def to_sympy(thing: Any) -> Any:
    """The same in sympy.

    Parameters
    ----------
    thing : LieAlgebra, Subalgebra, Representation, Matrix or number

    Returns
    -------
    sympy object
        Of an algebra the sparse array ``c[i, j, k]`` of shape (n, n, n); of a subalgebra the matrix of its rows
        (k, n); of a representation the list of its matrices; of a matrix a matrix; of a number a number. Elements
        of a number field become expressions in square roots, or in ``CRootOf`` where the generator is no square root.

    Raises
    ------
    InputError
        If it is something else.

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
    if isinstance(thing, LieAlgebra):
        return _array(thing)
    if isinstance(thing, ExactMatrix | FloatMatrix):
        return _matrix(thing)
    if isinstance(thing, Subalgebra):
        return _matrix(thing.basis)
    if isinstance(thing, Representation):
        return [_matrix(a) for a in thing.matrices]
    if isinstance(thing, AlgebraicNumber):
        return _number(thing.field, thing)
    if isinstance(thing, int | float) or type(thing) is type(QQ.one):
        import sympy

        return sympy.Float(thing) if isinstance(thing, float) else _number(QQ, QQ.convert(thing))
    raise InputError(
        f"a {type(thing).__name__} has no form in sympy; "
        "expected an algebra, subalgebra, representation, matrix or number"
    )


def _matrix(matrix: Any) -> Any:
    import sympy

    return sympy.Matrix(*matrix.shape, [_number(matrix.field, x) for row in matrix.to_rows() for x in row])


def _array(algebra: LieAlgebra) -> Any:
    import sympy

    n, entries = algebra.dimension, {}
    for i, j, k, v in algebra.structure_constants():
        value = _number(algebra.field, v)
        entries[(i * n + j) * n + k] = value
        entries[(j * n + i) * n + k] = -value
    return sympy.ImmutableSparseNDimArray(entries, (n, n, n))


def _number(field: Field, value: Any) -> Any:
    import sympy

    if isinstance(field, FloatField):
        return sympy.Float(value)
    if not isinstance(field, NumberField):
        return sympy.Rational(int(value.p), int(value.q))
    if field.symbol.startswith("sqrt("):
        root = sympy.sqrt(int(field.symbol[5:-1]))
    else:
        t = sympy.Symbol("t")
        # Real roots come first and in order, in sympy too.
        root = sympy.CRootOf(sympy.Add(*(c * t**p for p, c in enumerate(field.minpoly))), field.root_index)
    terms = (_number(QQ, c) * (field.leading * root) ** p for p, c in enumerate(field.coordinates(value)))
    return sympy.Add(*terms)
