"""Complex matrices as real ones: multiplication by a complex n x n matrix on C^n = R^(2n).

The coordinates of a vector z are (Re z_1, Im z_1, ..., Re z_n, Im z_n), so that an entry a + ib becomes the block
[[a, -b], [b, a]]. This is the convention of all matrix bases here and of `liehom.algebra.matrices.complex_structure`,
the multiplication by i. Products go to products, hence commutators to commutators: complex matrices generate the real
Lie algebra of their real matrices.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from liehom.algebra.core.tables import field_of_values
from liehom.errors import FieldError, InputError, ParseError, ShapeError, displayed
from liehom.scalars import Field, FloatField, Matrix, Scalar
from liehom.scalars.fields.complex_parts import complex_parts, field_determining_values, is_complex
from liehom.scalars.fields.field import MatrixLike, rows_of
from liehom.typing import ComplexArray

Part = list[list[Scalar]]


def as_real_matrices(
    matrices: Iterable[MatrixLike], field: Field | None = None, *, hermitian: bool = False
) -> tuple[list[MatrixLike], bool]:
    """Matrices that may be complex as matrices to be read over a real field.

    Parameters
    ----------
    matrices : sequence of (n, n) array_like
    field : Field, optional
        The real field of the parts; by default the smallest one that contains them.
    hermitian : bool
        Multiply every matrix by i, after a check that it is Hermitian.

    Returns
    -------
    list
        The matrices as given if they are all real, else real matrices of size 2n over one field.
    bool
        Whether they were complex: one of them has a complex entry, or `hermitian` is True.

    Raises
    ------
    InputError
        If a matrix is not Hermitian but should be, or has an entry with free symbols; names the matrix.
    ShapeError, ParseError, FieldError
        If a complex matrix is not square of the size of the first, or an entry is not a number of the field.

    Examples
    --------
    >>> made, was_complex = as_real_matrices([[[0, "-i"], ["i", 0]]])
    >>> was_complex
    True
    >>> print(made[0])
    [0, 0, 0, 1]
    [0, 0, -1, 0]
    [0, -1, 0, 0]
    [1, 0, 0, 0]
    """
    given = list_of_matrices(matrices)
    if not hermitian and not any(has_complex_entry(a, field) for a in given):
        return given, False
    return list(real_matrices(given, field, hermitian=hermitian)), True


def list_of_matrices(matrices: Iterable[MatrixLike]) -> list[MatrixLike]:
    """A list of the matrices, each of which can be read twice: real arrays and `Matrix` as they are, others as rows.

    Raises
    ------
    InputError, ShapeError
        If the argument is not a list, or a matrix is not given by its rows.

    Examples
    --------
    >>> list_of_matrices(zip([1, 2], [3, 4]) for _ in range(2))
    [[[1, 3], [2, 4]], [[1, 3], [2, 4]]]
    """
    if isinstance(matrices, str) or not hasattr(matrices, "__iter__"):
        raise InputError(f"a list of square matrices was expected, got {displayed(matrices)}")
    return [a if isinstance(a, Matrix) or _kind(a) in "biuf" else rows_of(a) for a in matrices]


def has_complex_entry(matrix: MatrixLike, field: Field | None = None) -> bool:
    """Whether an entry of a matrix from `list_of_matrices` is complex, see `is_complex`.

    Examples
    --------
    >>> has_complex_entry([[0, "i"], [0, 0]]), has_complex_entry([[0, 1], [0, 0]])
    (True, False)
    """
    if isinstance(matrix, Matrix) or _kind(matrix) in "biuf":
        return False
    return any(is_complex(x, field) for row in matrix for x in row)


def field_of_matrices(matrices: Sequence[MatrixLike]) -> Field:
    """The smallest real field that contains the parts of all entries; float64 if one is a float.

    A `Matrix` over floats decides by its field, which has its own tolerance.

    Examples
    --------
    >>> field_of_matrices([[["i*sqrt(2)"]], [["1/2"]]]), field_of_matrices([[[1j]]])
    (QQ(sqrt(2)), float64)
    """
    for a in matrices:
        if isinstance(a, Matrix) and not a.field.exact:
            return a.field
    return field_of_values(x for a in matrices for row in _table(a) for v in row for x in field_determining_values(v))


def real_matrices(
    matrices: Sequence[MatrixLike], field: Field | None = None, *, hermitian: bool = False, start: int = 0
) -> list[Matrix]:
    """The real matrices (2n, 2n) of matrices (n, n) over the complex numbers, whether their entries are real or not.

    Parameters
    ----------
    matrices : sequence of (n, n) array_like
    field : Field, optional
        The real field of the parts; by default the smallest one that contains them.
    hermitian : bool
        Multiply every matrix by i, after a check that it is Hermitian.
    start : int, optional
        The index of the first matrix in messages.

    Raises
    ------
    InputError, ShapeError, ParseError, FieldError
        See `as_real_matrices`.

    Examples
    --------
    >>> print(real_matrices([[["1+2i"]]])[0])
    [1, -2]
    [2, 1]
    """
    tables = [_table(a) for a in matrices]
    for k, table in enumerate(tables, start):
        _require_numbers(table, k, len(tables[0]))
    if field is None:
        field = field_of_matrices(tables)
    made: list[Matrix] = []
    for k, table in enumerate(tables, start):
        x, y = _parts(table, field, k)
        if hermitian:
            _require_hermitian(x, y, field, k)
            x, y = [[-v for v in row] for row in y], x  # i (X + i Y) = -Y + i X
        made.append(_blocks(x, y, field))
    return made


def parts_of_real_matrix(matrix: Matrix) -> tuple[Matrix, Matrix]:
    """The matrices X and Y of a real matrix (2n, 2n) of X + i Y.

    Examples
    --------
    >>> x, y = parts_of_real_matrix(real_matrices([[["1+2i"]]])[0])
    >>> print(x, y)
    [1] [2]
    """
    even, odd = range(0, matrix.nrows, 2), range(1, matrix.nrows, 2)
    return matrix.select(rows=even, columns=even), matrix.select(rows=odd, columns=even)


def is_complex_linear(matrix: Matrix) -> bool:
    """Whether a real matrix (2n, 2n) commutes with the multiplication by i.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> is_complex_linear(QQ.matrix([[1, -2], [2, 1]])), is_complex_linear(QQ.matrix([[1, 0], [0, -1]]))
    (True, False)
    """
    even, odd = range(0, matrix.nrows, 2), range(1, matrix.nrows, 2)
    x, y = parts_of_real_matrix(matrix)
    right, below = matrix.select(rows=even, columns=odd), matrix.select(rows=odd, columns=odd)
    return (x - below).is_zero() and (y + right).is_zero()


def is_hermitian_array(array: ComplexArray, rtol: float) -> bool:
    """Whether A - A^* is at most `rtol` times A in the Frobenius norm.

    Examples
    --------
    >>> is_hermitian_array(np.array([[0, -1e-200j], [1e-200j, 0]]), 1e-9), is_hermitian_array(np.array([[1j]]), 1e-9)
    (True, False)
    """
    scaled = array / (np.abs(array).max(initial=0.0) or 1.0)  # squares of the entries can leave the range of floats
    return bool(np.linalg.norm(scaled - scaled.conj().T) <= rtol * np.linalg.norm(scaled))


def _kind(matrix: object) -> str:
    """The kind of the entries of an array: 'i', 'u', 'f', 'c', or 'O' for everything else."""
    return str(getattr(getattr(matrix, "dtype", None), "kind", "O"))


def _table(matrix: MatrixLike) -> list[list[Any]]:
    return matrix.to_rows() if isinstance(matrix, Matrix) else rows_of(matrix)


def _require_numbers(table: list[list[Any]], k: int, n: int) -> None:
    lengths = sorted({len(row) for row in table})
    if len(table) != n or any(length != n for length in lengths):
        raise ShapeError(
            f"matrix {k} has {len(table)} rows of lengths {lengths}, expected the square shape ({n}, {n}) by the "
            "number of rows of matrix 0"
        )
    for i, row in enumerate(table):
        for j, value in enumerate(row):
            symbols = sorted(map(str, getattr(value, "free_symbols", ())))
            if symbols:
                raise InputError(
                    f"matrix {k}, entry ({i}, {j}): {value} has the free symbols {', '.join(symbols)}; expected a "
                    "number, so substitute numbers for them"
                )


def _parts(table: list[list[Any]], field: Field, k: int) -> tuple[Part, Part]:
    """The real and the imaginary parts of the entries, as elements of the field."""
    x: Part = [[] for _ in table]
    y: Part = [[] for _ in table]
    for i, row in enumerate(table):
        for j, value in enumerate(row):
            try:
                real, imaginary = complex_parts(value, field)
                x[i].append(field.convert(real))
                y[i].append(field.convert(imaginary))
            except (ParseError, FieldError) as error:
                raise type(error)(f"matrix {k}, entry ({i}, {j}): {error}") from None
    return x, y


def _blocks(x: Part, y: Part, field: Field) -> Matrix:
    """The real matrix of X + i Y."""
    n = len(x)
    entries: list[Scalar] = []
    for i in range(n):
        entries += [v for j in range(n) for v in (x[i][j], -y[i][j])]
        entries += [v for j in range(n) for v in (y[i][j], x[i][j])]
    made: Matrix = field.from_entries(entries, 2 * n, 2 * n)
    return made


def _array(x: Part, y: Part) -> ComplexArray:
    n = len(x)
    made: ComplexArray = np.array(x, dtype=complex).reshape(n, n) + 1j * np.array(y, dtype=complex).reshape(n, n)
    return made


def _require_hermitian(x: Part, y: Part, field: Field, k: int) -> None:
    """Raise `InputError` unless X + i Y is Hermitian, for floats up to the relative tolerance in the Frobenius norm."""
    n = len(x)
    if isinstance(field, FloatField) and is_hermitian_array(_array(x, y), field.rtol):
        return
    wrong = [(i, j) for i in range(n) for j in range(i, n) if x[i][j] != x[j][i] or y[i][j] != -y[j][i]]
    if wrong:
        i, j = wrong[0]
        raise InputError(
            f"matrix {k} is not Hermitian: entry ({i}, {j}) is not the conjugate of entry ({j}, {i}); without "
            "hermitian=True the matrices are taken as they are"
        )
