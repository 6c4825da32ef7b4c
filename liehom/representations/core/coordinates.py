"""Real coordinates of complex vectors and Hermitian matrices, and the complex matrices of a representation on C^n.

A vector z of C^n has the coordinates (Re z_1, Im z_1, ..., Re z_n, Im z_n). A Hermitian matrix H has the coordinates
H[i, i], and Re H[i, j], Im H[i, j] for i < j, in lexicographic order of (i, j).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt
from typing import Any, Literal, TypeAlias

import numpy as np

from liehom.algebra.closure.complex_matrices import is_complex_linear, is_hermitian_array, parts_of_real_matrix
from liehom.errors import InputError, ShapeError
from liehom.scalars import RR, Field, FloatField, Matrix
from liehom.scalars.fields.complex_parts import complex_parts, is_complex
from liehom.scalars.fields.field import MatrixLike, rows_of
from liehom.scalars.fields.sympy_number import sympy_number
from liehom.typing import ComplexArray, Expression, ScalarLike, VectorLike

Coordinates: TypeAlias = Literal["real", "complex", "hermitian"]
"""What the vectors of a representation are."""

KINDS: tuple[Coordinates, ...] = ("real", "complex", "hermitian")


def require_coordinates(coordinates: Coordinates, matrices: Sequence[Matrix], size: int) -> None:
    """Raise `InputError` or `ShapeError` if matrices of this size do not act on vectors with these coordinates."""
    if coordinates not in KINDS:
        raise InputError(f"coordinates are {', '.join(map(repr, KINDS))}, got {coordinates!r}")
    if coordinates == "hermitian" and isqrt(size) ** 2 != size:
        raise ShapeError(f"Hermitian n x n matrices have n^2 real coordinates, the matrices have size {size}")
    if coordinates != "complex":
        return
    if size % 2:
        raise ShapeError(f"C^n has 2n real coordinates, the matrices have the odd size {size}")
    for k, a in enumerate(matrices):
        if not is_complex_linear(a):
            raise InputError(f"matrix {k} is not complex linear: a complex entry a + ib is the block [[a, -b], [b, a]]")


def real_point(coordinates: Coordinates, size: int, field: Field, point: VectorLike | MatrixLike) -> list[ScalarLike]:
    """The real coordinates of a point, which may be a complex vector or a Hermitian matrix if the coordinates say so.

    Raises
    ------
    ShapeError, ParseError
        If the point has another shape, or an entry is not a number.
    InputError
        If a matrix is not Hermitian.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> real_point("complex", 4, QQ, [1, "2-i"]), real_point("hermitian", 4, QQ, [[1, "i"], ["-i", 0]])
    ([1, 0, 2, -1], [1, 0, 1, 0])
    """
    given: Any = point
    if coordinates == "hermitian" and (rows := _matrix_rows(point)) is not None:
        return _hermitian_coordinates(rows, isqrt(size), field)
    values = list(given)
    if coordinates != "complex":
        return values
    if len(values) == size // 2:
        return [x for v in values for x in complex_parts(v, field)]
    if len(values) != size:
        raise ShapeError(
            f"the point has {len(values)} coordinates, the representation acts on {size // 2} complex or {size} real "
            "coordinates"
        )
    if any(is_complex(v, field) for v in values):
        raise ShapeError(f"the point has {size} complex coordinates, the representation acts on C^{size // 2}")
    return values


def has_float(values: Sequence[ScalarLike]) -> bool:
    """Whether a value is a float, or an expression of sympy with a float: then only a numerical answer is possible.

    Examples
    --------
    >>> import sympy
    >>> has_float([1, "0.5"]), has_float([1, 0.5]), has_float([sympy.Float(0.5) * sympy.sqrt(2)])
    (False, True, True)
    """
    for value in values:
        expression: Any = value
        if isinstance(value, (float, np.floating)) or (hasattr(value, "atoms") and _has_float_atom(expression)):
            return True
    return False


def _has_float_atom(expression: Expression) -> bool:
    return any(getattr(atom, "is_Float", False) for atom in expression.atoms())


def complex_matrix(matrix: Matrix) -> ComplexArray | Expression:
    """The complex matrix (n, n) of a real one (2n, 2n): a sympy matrix, over floats an array of complex128.

    Examples
    --------
    >>> from liehom.scalars import QQ, RR
    >>> complex_matrix(QQ.matrix([[1, -2], [2, 1]])), complex_matrix(RR.matrix([[1, -2], [2, 1]]))
    (Matrix([[1 + 2*I]]), array([[1.+2.j]]))
    """
    x, y = parts_of_real_matrix(matrix)
    if not matrix.field.exact:
        return x.to_numpy() + 1j * y.to_numpy()
    import sympy

    def written(part: Matrix) -> Expression:
        return sympy.Matrix(*part.shape, [sympy_number(part.field, v) for row in part.to_rows() for v in row])

    return written(x) + sympy.I * written(y)


def _matrix_rows(point: VectorLike | MatrixLike) -> list[list[Any]] | None:
    """The rows of a matrix, or None for a vector."""
    given: Any = point
    if isinstance(point, Matrix):
        return point.to_rows()
    shape = getattr(point, "shape", None)
    if shape is not None:
        return None if len(shape) != 2 or shape[1] == 1 < shape[0] else rows_of(given)
    nested = all(hasattr(row, "__iter__") and not isinstance(row, str) for row in given)
    return rows_of(given) if nested and len(given) else None


def _hermitian_coordinates(rows: list[list[Any]], n: int, field: Field) -> list[ScalarLike]:
    if len(rows) != n or any(len(row) != n for row in rows):
        lengths = sorted({len(row) for row in rows})
        raise ShapeError(f"a Hermitian {n} x {n} matrix was expected, got {len(rows)} rows of lengths {lengths}")
    parts = [[complex_parts(v, field) for v in row] for row in rows]
    floats = any(isinstance(v, (float, np.floating)) for row in parts for pair in row for v in pair)
    if floats or not field.exact:
        array = np.array([[complex(*map(RR.convert, pair)) for pair in row] for row in parts]).reshape(n, n)
        is_hermitian = is_hermitian_array(array, field.rtol if isinstance(field, FloatField) else RR.rtol)
    else:
        x, y = ([[_exact(pair[part], field) for pair in row] for row in parts] for part in range(2))
        is_hermitian = all(x[i][j] == x[j][i] and y[i][j] == -y[j][i] for i in range(n) for j in range(i, n))
    if not is_hermitian:
        raise InputError("the matrix is not Hermitian: an entry (i, j) is not the conjugate of entry (j, i)")
    return [v for i in range(n) for j in range(i, n) for v in (parts[i][j] if i < j else parts[i][j][:1])]


def _exact(value: ScalarLike, field: Field) -> Expression:
    """A number of the field, or the sympy expression itself if it has symbols."""
    return value if getattr(value, "free_symbols", ()) else field.convert(value)
