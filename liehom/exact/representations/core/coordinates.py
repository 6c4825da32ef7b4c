"""Real coordinates of complex vectors and of Hermitian matrices, and the matrices of n equal representations.

A vector z of C^n has the coordinates (Re z_1, Im z_1, ..., Re z_n, Im z_n). A Hermitian matrix H has the coordinates
H[i, i], and Re H[i, j], Im H[i, j] for i < j, in lexicographic order of (i, j).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isqrt
from typing import Any, Literal, Protocol, TypeAlias, final, overload

import numpy as np

from liehom.base.errors import InputError, ShapeError, displayed
from liehom.base.typing import ComplexArray, Expression, ScalarLike, VectorLike
from liehom.exact.algebra.linear.complex_matrices import is_complex_linear, is_hermitian_array, parts_of_real_matrix
from liehom.exact.scalars.complex_parts import complex_parts, is_complex, sympy_number
from liehom.exact.scalars.field import Field, Matrix, MatrixLike, Scalar, rows_of
from liehom.exact.scalars.floating import RR, FloatField

Coordinates: TypeAlias = Literal["real", "complex", "hermitian"]
"""What the vectors of a representation are."""

KINDS: tuple[Coordinates, ...] = ("real", "complex", "hermitian")


def require_coordinates(coordinates: Coordinates, matrices: Sequence[Matrix], size: int) -> None:
    """Raise `InputError` or `ShapeError` if matrices of this size do not act on vectors with these coordinates."""
    if coordinates not in KINDS:
        raise InputError(f"coordinates are {', '.join(map(repr, KINDS))}, got {displayed(coordinates)}")
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
    """Real coordinates of a point, which may be a complex vector or a Hermitian matrix."""
    if coordinates == "hermitian" and (rows := _matrix_rows(point)) is not None:
        return _hermitian_coordinates(rows, isqrt(size), field)
    values: list[Any] = list(point)
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
    """Whether a value is a float, or an expression of sympy with a float: then only a numerical answer is possible."""
    return any(
        isinstance(value, (float, np.floating))
        or (hasattr(value, "atoms") and any(getattr(atom, "is_Float", False) for atom in value.atoms()))
        for value in values
    )


def complex_matrix(matrix: Matrix) -> ComplexArray | Expression:
    """The complex matrix (n, n) of a real one (2n, 2n): a sympy matrix, over floats an array of complex128."""
    x, y = parts_of_real_matrix(matrix)
    if not matrix.field.exact:
        return x.to_numpy() + 1j * y.to_numpy()
    import sympy

    real, imaginary = (
        sympy.Matrix(*part.shape, [sympy_number(part.field, v) for row in part.to_rows() for v in row])
        for part in (x, y)
    )
    return real + sympy.I * imaginary


def _matrix_rows(point: VectorLike | MatrixLike) -> list[list[Any]] | None:
    """The rows of a matrix, or None for a vector."""
    entries: Any = point
    if isinstance(point, Matrix):
        return point.to_rows()
    shape = getattr(point, "shape", None)
    if shape is not None:
        return None if len(shape) != 2 or shape[1] == 1 < shape[0] else rows_of(entries)
    nested = all(hasattr(row, "__iter__") and not isinstance(row, str) for row in entries)
    return rows_of(entries) if nested and len(entries) else None


def _hermitian_coordinates(rows: list[list[Any]], n: int, field: Field) -> list[ScalarLike]:
    if len(rows) != n or any(len(row) != n for row in rows):
        lengths = sorted({len(row) for row in rows})
        raise ShapeError(f"a Hermitian {n} x {n} matrix was expected, got {len(rows)} rows of lengths {lengths}")
    parts: list[list[Any]] = [[complex_parts(v, field) for v in row] for row in rows]
    if any(isinstance(v, (float, np.floating)) for row in parts for pair in row for v in pair) or not field.exact:
        array = np.array([[complex(*map(RR.convert, pair)) for pair in row] for row in parts]).reshape(n, n)
        is_hermitian = is_hermitian_array(array, field.rtol if isinstance(field, FloatField) else RR.rtol)
    else:
        # an entry with symbols stays an expression
        x, y = (
            [[p[k] if getattr(p[k], "free_symbols", ()) else field.convert(p[k]) for p in row] for row in parts]
            for k in range(2)
        )
        is_hermitian = all(x[i][j] == x[j][i] and y[i][j] == -y[j][i] for i in range(n) for j in range(i, n))
    if not is_hermitian:
        raise InputError("the matrix is not Hermitian: an entry (i, j) is not the conjugate of entry (j, i)")
    return [v for i in range(n) for j in range(i, n) for v in (parts[i][j] if i < j else parts[i][j][:1])]


class Single(Protocol):
    """The representation that is copied, by its matrices."""

    @property
    def field(self) -> Field: ...
    @property
    def size(self) -> int: ...
    @property
    def matrices(self) -> tuple[Matrix, ...]: ...


@final
class Copies(Sequence[Matrix]):
    """The matrices of n copies of a representation sigma, on which the n-th direct power of the algebra acts.

    rho(x_1, ..., x_n)(m_1, ..., m_n) = (sigma(x_1) m_1, ..., sigma(x_n) m_n). Each matrix is computed when it is asked
    for: all have n^3 dim g N^2 entries, nearly all of them 0, for 100 spins 27 million.
    """

    single: Any
    copies: int

    def __init__(self, single: Single, count: int) -> None:
        self.single, self.copies = single, count
        self._computed: dict[int, Matrix] = {}

    @property
    def size(self) -> int:
        """n N, the number of coordinates."""
        return self.copies * self.single.size

    def entries(self) -> list[tuple[int, int, int, Scalar]]:
        """The entries (a, j, i, value) of matrix a in row i and column j that are not 0."""
        own = [
            (a, j, i, value)
            for a, matrix in enumerate(self.single.matrices)
            for i, row in enumerate(matrix.to_rows())
            for j, value in enumerate(row)
            if value != 0
        ]
        d, n = len(self.single.matrices), self.single.size
        return [(a + d * k, j + n * k, i + n * k, value) for k in range(self.copies) for a, j, i, value in own]

    def __len__(self) -> int:
        return self.copies * len(self.single.matrices)

    @overload
    def __getitem__(self, index: int) -> Matrix: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Matrix]: ...
    def __getitem__(self, index: int | slice) -> Matrix | Sequence[Matrix]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        place = index % len(self)
        if place not in self._computed:
            n, field = self.single.size, self.single.field
            k, a = divmod(place, len(self.single.matrices))
            rows = [[field.zero] * self.size for _ in range(self.size)]
            for i, row in enumerate(self.single.matrices[a].to_rows()):
                rows[k * n + i][k * n : (k + 1) * n] = row
            self._computed[place] = field.matrix(rows, (self.size, self.size))
        return self._computed[place]

    def __iter__(self) -> Iterator[Matrix]:
        return (self[i] for i in range(len(self)))

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Copies):
            return self.copies == other.copies and self.single == other.single
        return isinstance(other, tuple) and tuple(self) == other

    def __hash__(self) -> int:
        return hash(tuple(self))


def copies_of(representation: Single) -> Copies | None:
    """The matrices of a representation if they are `Copies`, else None."""
    matrices: Any = representation.matrices
    return matrices if isinstance(matrices, Copies) else None
