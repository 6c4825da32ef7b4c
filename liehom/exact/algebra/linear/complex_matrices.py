"""Complex matrices as real ones: multiplication by a complex n x n matrix on C^n = R^(2n).

The coordinates of a vector z are (Re z_1, Im z_1, ..., Re z_n, Im z_n), so that an entry a + ib becomes the block [[a,
-b], [b, a]]. This is the convention of all matrix bases here and of `liehom.exact.algebra.linear.complex_structure`,
the multiplication by i. Products go to products, hence commutators to commutators: complex matrices generate the real
Lie algebra of their real matrices.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from liehom.base.errors import FieldError, InputError, ParseError, ShapeError, displayed
from liehom.base.typing import ComplexArray
from liehom.exact.algebra.core.tables import field_of_values
from liehom.exact.scalars.complex_parts import complex_parts, field_determining_values, is_complex
from liehom.exact.scalars.field import Field, Matrix, MatrixLike, Scalar, rows_of
from liehom.exact.scalars.floating import FloatField

Part = list[list[Scalar]]


def as_real_matrices(
    matrices: Iterable[MatrixLike], field: Field | None = None, *, hermitian: bool = False
) -> tuple[list[MatrixLike], bool]:
    """Matrices that may be complex as matrices to be read over a real field."""
    listed = list_of_matrices(matrices)
    if not hermitian and not any(has_complex_entry(a, field) for a in listed):
        return listed, False
    return list(real_matrices(listed, field, hermitian=hermitian)), True


def list_of_matrices(matrices: Iterable[MatrixLike]) -> list[MatrixLike]:
    """A list of the matrices, each of which can be read twice: real arrays and `Matrix` as they are, others as rows."""
    if isinstance(matrices, str) or not hasattr(matrices, "__iter__"):
        raise InputError(f"a list of square matrices was expected, got {displayed(matrices)}")
    return [a if isinstance(a, Matrix) or _kind(a) in "biuf" else rows_of(a) for a in matrices]


def has_complex_entry(matrix: MatrixLike, field: Field | None = None) -> bool:
    """Whether an entry of a matrix from `list_of_matrices` is complex, see `is_complex`."""
    if isinstance(matrix, Matrix) or _kind(matrix) in "biuf":
        return False
    return any(is_complex(x, field) for row in matrix for x in row)


def field_of_matrices(matrices: Sequence[MatrixLike]) -> Field:
    """The smallest real field that contains the parts of all entries; over floats that of a `Matrix`, or float64."""
    floats = (a.field for a in matrices if isinstance(a, Matrix) and not a.field.exact)
    values = (x for a in matrices for row in _table(a) for v in row for x in field_determining_values(v))
    return next(floats, None) or field_of_values(values)


def real_matrices(
    matrices: Sequence[MatrixLike], field: Field | None = None, *, hermitian: bool = False, start: int = 0
) -> list[Matrix]:
    """The real matrices (2n, 2n) of matrices (n, n) over the complex numbers, whether their entries are real or not."""
    tables = [_table(a) for a in matrices]
    for k, table in enumerate(tables, start):
        _require_numbers(table, k, len(tables[0]))
    field = field or field_of_matrices(tables)
    real: list[Matrix] = []
    for k, table in enumerate(tables, start):
        x, y = _parts(table, field, k)
        if hermitian:
            _require_hermitian(x, y, field, k)
            x, y = [[-v for v in row] for row in y], x  # i (X + i Y) = -Y + i X
        real.append(_blocks(x, y, field))
    return real


def parts_of_real_matrix(matrix: Matrix) -> tuple[Matrix, Matrix]:
    """The matrices X and Y of a real matrix (2n, 2n) of X + i Y."""
    even, odd = range(0, matrix.nrows, 2), range(1, matrix.nrows, 2)
    return matrix.select(rows=even, columns=even), matrix.select(rows=odd, columns=even)


def is_complex_linear(matrix: Matrix) -> bool:
    """Whether a real matrix (2n, 2n) commutes with the multiplication by i."""
    even, odd = range(0, matrix.nrows, 2), range(1, matrix.nrows, 2)
    x, y = parts_of_real_matrix(matrix)
    right, below = matrix.select(rows=even, columns=odd), matrix.select(rows=odd, columns=odd)
    return (x - below).is_zero() and (y + right).is_zero()


def is_hermitian_array(array: ComplexArray, rtol: float) -> bool:
    """Whether A - A^* is at most `rtol` times A in the Frobenius norm."""
    scaled = array / (np.abs(array).max(initial=0.0) or 1.0)  # squares of the entries can leave the range of floats
    return bool(np.linalg.norm(scaled - scaled.conj().T) <= rtol * np.linalg.norm(scaled))


def _kind(matrix: object) -> str:
    """The kind of the entries of an array: 'i', 'u', 'f', 'c', or 'O' for everything else."""
    return str(getattr(getattr(matrix, "dtype", None), "kind", "O"))


def _table(matrix: MatrixLike) -> list[list[Any]]:
    return matrix.to_rows() if isinstance(matrix, Matrix) else rows_of(matrix)


def _require_numbers(table: list[list[Any]], k: int, n: int) -> None:
    lengths = sorted({len(row) for row in table})
    if len(table) != n or lengths not in ([], [n]):
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
    blocks = ([[(a, -b), (b, a)] for a, b in zip(*rows, strict=True)] for rows in zip(x, y, strict=True))
    entries = [v for row in blocks for part in (0, 1) for block in row for v in block[part]]
    return field.from_entries(entries, 2 * n, 2 * n)


def _require_hermitian(x: Part, y: Part, field: Field, k: int) -> None:
    """Raise `InputError` unless X + i Y is Hermitian, for floats up to the relative tolerance in the Frobenius norm."""
    n = len(x)
    if isinstance(field, FloatField):
        real, imaginary = (np.array(part, dtype=complex).reshape(n, n) for part in (x, y))
        if is_hermitian_array(real + 1j * imaginary, field.rtol):
            return
    pairs = combinations_with_replacement(range(n), 2)
    wrong = next(((i, j) for i, j in pairs if x[i][j] != x[j][i] or y[i][j] != -y[j][i]), None)
    if wrong is not None:
        i, j = wrong
        raise InputError(
            f"matrix {k} is not Hermitian: entry ({i}, {j}) is not the conjugate of entry ({j}, {i}); without "
            "hermitian=True the matrices are taken as they are"
        )
