"""FloatField and FloatMatrix: float64 with a stated relative tolerance.

Every rank is the number of singular values above ``rtol * largest``; `FloatMatrix.rank_decision` reports the gap at
this tolerance. No exact value is guessed from floats.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, final

import numpy as np
import numpy.typing as npt

from liehom.errors import FieldError, ShapeError, SingularError
from liehom.scalars.fields.field import Field, Matrix, MatrixLike, Scalar, rows_of
from liehom.typing import Array, ScalarLike


@final
@dataclass(frozen=True, slots=True)
class RankDecision:
    """A numerical rank and the singular values on both sides of the tolerance.

    Attributes
    ----------
    rank : int
    kept, dropped : float
        The smallest singular value that counts and the largest that does not, relative to the largest singular
        value; 0 if no such value exists.
    """

    rank: int
    kept: float
    dropped: float

    @property
    def gap(self) -> float:
        """Ratio kept / dropped, a float; infinite if no singular value was dropped."""
        return math.inf if self.dropped == 0 else self.kept / self.dropped


@final
class FloatField(Field["FloatMatrix"]):
    """The field float64 with a relative tolerance for ranks.

    Parameters
    ----------
    rtol : float, optional
        Singular values below ``rtol`` times the largest count as zero (default 1e-9).

    Examples
    --------
    >>> F = FloatField()
    >>> F, F.matrix([[1.0, 2.0], [0.5, 1.0]]).rank()
    (float64, 1)
    """

    __slots__ = ("rtol",)

    def __init__(self, rtol: float = 1e-9) -> None:
        if not 0 < rtol < 1:
            raise FieldError(f"rtol must lie between 0 and 1, got {rtol}")
        self.rtol: float = rtol

    @property
    def exact(self) -> bool:
        return False

    @property
    def name(self) -> str:
        return "float64"

    @property
    def zero(self) -> float:
        return 0.0

    @property
    def one(self) -> float:
        return 1.0

    def convert(self, value: ScalarLike) -> float:
        if isinstance(value, str):
            from liehom.scalars.fields.number_fields import exact_value

            return float(exact_value(value))
        if isinstance(value, (bool, np.bool_)):
            raise FieldError(f"{value!r} is not a number")
        try:
            given: Any = value
            number = int(given.p) / int(given.q) if hasattr(given, "p") else float(given)
        except (TypeError, ValueError, OverflowError) as error:
            raise FieldError(f"{value!r} is not a float64 number: {error}") from None
        if not math.isfinite(number):
            raise FieldError(f"{value!r} is not finite")
        return number

    def format(self, value: Scalar) -> str:
        return repr(float(value))

    def sign(self, value: Scalar) -> int:
        return int(value > 0) - int(value < 0)

    def to_float(self, value: Scalar) -> float:
        return float(value)

    def matrix(self, rows: MatrixLike, shape: tuple[int, int] | None = None) -> FloatMatrix:
        table = [[self.convert(x) for x in row] for row in rows_of(rows)]
        nrows, ncols = shape if shape is not None else (len(table), len(table[0]) if table else 0)
        if len(table) != nrows or any(len(row) != ncols for row in table):
            lengths = sorted({len(row) for row in table})
            raise ShapeError(f"expected {nrows} rows of length {ncols}, got {len(table)} rows of lengths {lengths}")
        return FloatMatrix(self, np.array(table, dtype=np.float64).reshape(nrows, ncols))

    def from_entries(self, entries: Sequence[Any], nrows: int, ncols: int) -> FloatMatrix:
        return FloatMatrix(self, np.array(entries, dtype=np.float64).reshape(nrows, ncols))

    def zeros(self, nrows: int, ncols: int) -> FloatMatrix:
        return FloatMatrix(self, np.zeros((nrows, ncols)))

    def identity(self, n: int) -> FloatMatrix:
        return FloatMatrix(self, np.eye(n))

    def stack_rows(self, blocks: Sequence[FloatMatrix], ncols: int) -> FloatMatrix:
        return FloatMatrix(self, np.vstack([np.zeros((0, ncols)), *[b.array for b in blocks]]))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FloatField) and self.rtol == other.rtol

    def __hash__(self) -> int:
        return hash(("float64", self.rtol))


@final
class FloatMatrix(Matrix):
    """A float64 matrix with the tolerance of its field, constructed by ``FloatField().matrix(rows)``.

    Examples
    --------
    >>> A = FloatField().matrix([[3.0, 0.0], [0.0, 1e-13]])
    >>> A.rank_decision().rank
    1
    """

    __slots__ = ("_field", "array")

    def __init__(self, field: FloatField, array: Array) -> None:
        self._field = field
        self.array: Array = array

    @property
    def field(self) -> FloatField:
        return self._field

    @property
    def shape(self) -> tuple[int, int]:
        return self.array.shape[0], self.array.shape[1]

    def __getitem__(self, index: tuple[int, int]) -> float:
        return float(self.array[index])

    def entries(self) -> list[Scalar]:
        return [float(x) for x in self.array.ravel()]

    def to_rows(self) -> list[list[Scalar]]:
        return [[float(x) for x in row] for row in self.array]

    def to_numpy(self) -> Array:
        return self.array.copy()

    def select(self, rows: Sequence[int] | None = None, columns: Sequence[int] | None = None) -> FloatMatrix:
        array = self.array if rows is None else self.array[list(rows), :]
        return self._made(array if columns is None else array[:, list(columns)])

    def reshape(self, nrows: int, ncols: int) -> FloatMatrix:
        return self._made(self.array.reshape(nrows, ncols))

    def split_rows(self, nrows: int, ncols: int) -> list[FloatMatrix]:
        return [self._made(row.reshape(nrows, ncols)) for row in self.array]

    def _made(self, array: npt.NDArray[np.floating[Any]]) -> FloatMatrix:
        return FloatMatrix(self._field, np.asarray(array, dtype=np.float64))

    def __repr__(self) -> str:
        return f"<matrix {self.nrows} x {self.ncols} over float64>"

    def __str__(self) -> str:
        return str(self.array)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FloatMatrix) and np.array_equal(self.array, other.array)

    __hash__: ClassVar[None] = None  # type: ignore[assignment]

    @property
    def T(self) -> FloatMatrix:
        return self._made(self.array.T)

    def __add__(self, other: FloatMatrix) -> FloatMatrix:
        return self._made(self.array + other.array)

    def __sub__(self, other: FloatMatrix) -> FloatMatrix:
        return self._made(self.array - other.array)

    def __neg__(self) -> FloatMatrix:
        return self._made(-self.array)

    def __matmul__(self, other: FloatMatrix) -> FloatMatrix:
        if self.ncols != other.nrows:
            raise ShapeError(f"matrices of shapes {self.shape} and {other.shape} do not multiply")
        return self._made(self.array @ other.array)

    def scale(self, factor: ScalarLike) -> FloatMatrix:
        return self._made(self.array * self._field.convert(factor))

    def is_zero(self) -> bool:
        return self.array.size == 0 or float(np.abs(self.array).max()) <= self._field.rtol

    def trace(self) -> float:
        return float(np.trace(self.array))

    def rank_decision(self) -> RankDecision:
        """`RankDecision`: the rank and the singular values on both sides of the tolerance."""
        if self.array.size == 0:
            return RankDecision(0, 0.0, 0.0)
        values = np.linalg.svd(self.array, compute_uv=False)
        if values[0] == 0:
            return RankDecision(0, 0.0, 0.0)
        relative = values / values[0]
        rank = int((relative > self._field.rtol).sum())
        return RankDecision(rank, float(relative[rank - 1]), float(relative[rank]) if rank < len(values) else 0.0)

    def rank(self) -> int:
        return self.rank_decision().rank

    def row_space(self) -> FloatMatrix:
        if self.array.size == 0:
            return self._made(np.zeros((0, self.ncols)))
        right = np.linalg.svd(self.array)[2]
        return self._made(right[: self.rank()])

    def null_space(self) -> FloatMatrix:
        if self.array.size == 0:
            return self._made(np.eye(self.ncols))
        right = np.linalg.svd(self.array)[2]
        return self._made(right[self.rank() :])

    def solve(self, right: FloatMatrix) -> FloatMatrix:
        solution, *_ = np.linalg.lstsq(self.array, right.array, rcond=self._field.rtol)
        size = float(np.abs(right.array).max(initial=0.0)) + float(np.abs(self.array).max(initial=0.0))
        if float(np.abs(self.array @ solution - right.array).max(initial=0.0)) > 1e3 * self._field.rtol * max(
            size, 1e-300
        ):
            raise SingularError("the linear system has no solution within the tolerance")
        return self._made(solution)

    def inverse(self) -> FloatMatrix:
        if self.rank() < self.nrows:
            raise SingularError("the matrix is singular within the tolerance")
        return self._made(np.linalg.inv(self.array))

    def signature(self) -> tuple[int, int, int]:
        values = np.linalg.eigvalsh((self.array + self.array.T) / 2)
        bound = self._field.rtol * float(np.abs(values).max(initial=0.0))
        positive, negative = int((values > bound).sum()), int((values < -bound).sum())
        return positive, negative, len(values) - positive - negative


RR = FloatField()
