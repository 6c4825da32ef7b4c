"""FloatField and FloatMatrix: float64 matrices that carry a bound on their uncertainty.

A `FloatMatrix` A has an attribute ``error``, a bound on the Frobenius norm of the difference from the matrix that is
meant. Data have the error ``rtol * ||A||_F``; arithmetic propagates it to first order. A matrix is zero if its norm is
within its error, and a rank is the number of singular values above the error. Only norms, singular values and
eigenvalues are compared with errors, so that no answer changes if all data are multiplied by a number or transformed
orthogonally. No exact value is guessed from floats.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import FieldError, ShapeError, SingularError, UndecidedError, displayed
from liehom.base.objects import Immutable
from liehom.base.typing import Array, ScalarLike
from liehom.exact.scalars.field import Field, Matrix, MatrixLike, Scalar, rows_of

ROUNDING = 1e-15  # least error of a computed matrix, relative to its norm
CLEAR = 100.0  # margin of the singular values on both sides of the error with which a rank is beyond doubt
SMALLEST, LARGEST = 1e-280, 1e280  # norms of results outside these bounds have lost digits


@final
@dataclass(frozen=True, slots=True)
class RankDecision:
    """A numerical rank and the singular values on both sides of the error.

    Attributes
    ----------
    rank : int
    kept, dropped : float
        The smallest singular value that counts and the largest that does not, relative to the largest singular
        value; 0 if no such value exists.
    error : float
        The bound on the uncertainty that decided, relative to the largest singular value; 0 for a zero matrix.
    """

    rank: int
    kept: float
    dropped: float
    error: float = 0.0

    @property
    def gap(self) -> float:
        """Ratio kept / dropped, a float; infinite if no singular value was dropped."""
        return math.inf if self.dropped == 0 else self.kept / self.dropped

    @property
    def clear(self) -> bool:
        """Whether no singular value is between a hundredth of the error and 100 times the error."""
        return (self.rank == 0 or self.kept >= CLEAR * self.error) and CLEAR * self.dropped <= self.error

    def require_clear(self, question: str) -> None:
        """Raise `UndecidedError` unless the rank is clear; `question` is what it decides, for the message."""
        if not self.clear:
            raise UndecidedError(
                f"{question} is not decided by the given numbers: a singular value of relative size {self.kept:.2g} "
                f"counts and {self.dropped:.2g} does not, with a tolerance of {self.error:.2g}; give more accurate "
                "numbers, another tolerance lh.FloatField(rtol), or exact numbers by lh.rationalize"
            )


def rank_decision(values: Array, error: float) -> RankDecision:
    """`RankDecision` for descending singular values that are known up to an absolute error."""
    if len(values) == 0 or values[0] == 0:
        return RankDecision(0, 0.0, 0.0, 0.0)
    largest = float(values[0])
    relative = values / largest
    rank = int((values > error).sum())
    kept = float(relative[rank - 1]) if rank else 0.0
    return RankDecision(rank, kept, float(relative[rank]) if rank < len(values) else 0.0, error / largest)


def norm_of(array: npt.NDArray[np.floating[Any]]) -> float:
    """Frobenius norm without overflow or underflow of the squares; `FieldError` if an entry is not finite."""
    size = float(max(array.max(), -array.min())) if array.size else 0.0
    if 1e-140 < size < 1e140:
        return float(np.linalg.norm(array))
    norm = size * float(np.linalg.norm(array / size)) if 0 < size < math.inf else size
    if not math.isfinite(norm):
        _require_range(norm)
    return norm


def _require_range(norm: float) -> None:
    """Raise `FieldError` if the norm of a result is so large or small that digits are lost."""
    if not SMALLEST < norm < LARGEST:
        raise FieldError(
            f"a matrix of norm {norm:.1e} leaves the range of float64; multiply the data by a power of two, or use QQ"
        )


@final
class FloatField(Field["FloatMatrix"], Immutable):
    """The field float64 with the relative accuracy of data.

    Parameters
    ----------
    rtol : float, optional
        The matrices that are given have an uncertainty of ``rtol`` times their Frobenius norm (default 1e-9).

    Notes
    -----
    A single number carries no error: `convert` takes it as it is, `sign` is its sign, and only 0.0 is zero. Whether
    something vanishes is a question to a `FloatMatrix`, which knows the scale of the data that it comes from.

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
            from liehom.exact.scalars.number_fields import exact_value

            return float(exact_value(value))
        if isinstance(value, (bool, np.bool_)):
            raise FieldError(f"{displayed(value)} is not a number")
        try:
            source: Any = value
            number = int(source.p) / int(source.q) if hasattr(source, "p") else float(source)
        except (TypeError, ValueError, OverflowError) as error:
            raise FieldError(f"{displayed(value)} is not a float64 number: {error}") from None
        if not math.isfinite(number):
            raise FieldError(f"{displayed(value)} is not finite")
        return number

    def format(self, value: Scalar) -> str:
        return repr(float(value))

    def show(self, value: Scalar) -> str:
        return repr(float(value) + 0.0)  # 0.0 for -0.0

    def sign(self, value: Scalar) -> int:
        return int(value > 0) - int(value < 0)

    def to_float(self, value: Scalar) -> float:
        return float(value)

    def matrix(self, rows: MatrixLike, shape: tuple[int, int] | None = None) -> FloatMatrix:
        if isinstance(rows, np.ndarray) and rows.dtype == np.float64 and rows.ndim == 2:
            if shape is not None and rows.shape != shape:
                raise ShapeError(f"expected {shape[0]} rows of length {shape[1]}, got an array of shape {rows.shape}")
            if not np.isfinite(rows).all():
                raise FieldError(f"{rows[~np.isfinite(rows)][0]!r} is not finite")
            return FloatMatrix(self, rows.copy())
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
        return FloatMatrix(self, np.eye(n), 0.0, spectral=1.0)

    def stack_rows(self, blocks: Sequence[FloatMatrix], ncols: int) -> FloatMatrix:
        array = np.vstack([np.zeros((0, ncols)), *[b.array for b in blocks]])
        return FloatMatrix(self, array, math.hypot(*(b.error for b in blocks)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FloatField) and self.rtol == other.rtol

    def __hash__(self) -> int:
        return hash(("float64", self.rtol))


@final
class FloatMatrix(Matrix, Immutable):
    """A float64 matrix with a bound on its uncertainty, constructed by ``FloatField().matrix(rows)``.

    Parameters
    ----------
    field : FloatField
    array : ndarray of float64, shape (m, n)
    error : float, optional
        Bound on the Frobenius norm of the uncertainty. By default the matrix is data, with the error
        ``field.rtol * ||array||_F``. It is never below ``1e-15 * ||array||_F``, because of rounding.
    spectral : float, optional
        Bound on the largest singular value, if a better one than the Frobenius norm is known.

    Notes
    -----
    Errors are propagated to first order: those of a sum add; A B has ``||A|| e_B + ||B|| e_A``; an inverse
    ``e / s^2`` with the smallest singular value s; a null space or row space, with orthonormal rows, ``e / s`` with
    the smallest singular value s that counts; A X = B has ``(e_B + e_A ||X||) / s``. A selection of rows or columns
    has the error of the whole.

    Examples
    --------
    >>> A = FloatField().matrix([[3.0, 0.0], [0.0, 1e-13]])
    >>> A.rank(), f"{A.error:.0e}", (A - A).is_zero(), A.is_zero()
    (1, '3e-09', True, False)
    """

    error: float

    __slots__ = ("_field", "_norm", "_spectral", "array", "error")

    def __init__(
        self, field: FloatField, array: Array, error: float | None = None, *, spectral: float | None = None
    ) -> None:
        self._field = field
        self.array: Array = array
        self._norm: float = norm_of(array)
        self._spectral: float = self._norm if spectral is None else min(spectral, self._norm)
        self.error = max(field.rtol * self._norm if error is None else error, ROUNDING * self._norm)
        if not math.isfinite(self.error):
            raise FieldError("the uncertainty leaves the range of float64; multiply the data by a power of two")

    @property
    def field(self) -> FloatField:
        return self._field

    @property
    def shape(self) -> tuple[int, int]:
        return self.array.shape[0], self.array.shape[1]

    @property
    def norm(self) -> float:
        """Frobenius norm, a float."""
        return self._norm

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
        array = array if columns is None else array[:, list(columns)]
        return self._made(array, self.error, self._spectral)

    def reshape(self, nrows: int, ncols: int) -> FloatMatrix:
        return self._made(self.array.reshape(nrows, ncols), self.error)

    def regroup(self, p: int, q: int, r: int) -> FloatMatrix:
        """The matrix (q, p * r) with entry (b, a r + c) the entry a, b, c of these numbers as an array (p, q, r)."""
        return self._made(self.array.reshape(p, q, r).transpose(1, 0, 2).reshape(q, p * r), self.error)

    def split_rows(self, nrows: int, ncols: int) -> list[FloatMatrix]:
        return [self._made(row.reshape(nrows, ncols), self.error) for row in self.array]

    def _made(self, array: npt.NDArray[np.floating[Any]], error: float, spectral: float | None = None) -> FloatMatrix:
        return FloatMatrix(self._field, np.asarray(array, dtype=np.float64), error, spectral=spectral)

    def __repr__(self) -> str:
        return f"<matrix {self.nrows} x {self.ncols} over float64>"

    def __str__(self) -> str:
        return str(self.array)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FloatMatrix) and np.array_equal(self.array, other.array)

    def __hash__(self) -> int:
        return hash((self.shape, tuple((self.array + 0.0).ravel().tolist())))  # -0.0 + 0.0 is 0.0

    @property
    def T(self) -> FloatMatrix:
        return self._made(self.array.T, self.error, self._spectral)

    def __add__(self, other: FloatMatrix | int) -> FloatMatrix:
        if not isinstance(other, FloatMatrix):
            return self.__radd__(other)
        _require_range(max(self._norm + other._norm, SMALLEST * 2))
        return self._made(self.array + other.array, self.error + other.error)

    def __sub__(self, other: FloatMatrix | int) -> FloatMatrix:
        if not isinstance(other, FloatMatrix):
            return self.__radd__(other)
        return self + -other

    def __neg__(self) -> FloatMatrix:
        return self._made(-self.array, self.error, self._spectral)

    def __matmul__(self, other: FloatMatrix) -> FloatMatrix:
        if not isinstance(other, FloatMatrix):
            return NotImplemented
        if self.ncols != other.nrows:
            raise ShapeError(f"matrices of shapes {self.shape} and {other.shape} do not multiply")
        error = self._spectral * other.error + other._spectral * self.error
        if self._norm and other._norm:
            _require_range(max(self._norm * other._norm, error))  # digits below the error may be lost
        return self._made(self.array @ other.array, error, self._spectral * other._spectral)

    def scale(self, factor: ScalarLike) -> FloatMatrix:
        number = self._field.convert(factor)
        if self._norm and number:
            _require_range(max(self._norm, self.error) * abs(number))
        return self._made(self.array * number, self.error * abs(number), self._spectral * abs(number))

    def unit_rows(self) -> FloatMatrix:
        """The matrix as data in which each row that is not 0 has length 1: rows with an uncertainty of their own."""
        size = np.abs(self.array).max(axis=1, initial=0.0)
        scaled = self.array / np.where(size > 0, size, 1.0)[:, None]
        lengths = np.linalg.norm(scaled, axis=1)
        return FloatMatrix(self._field, scaled / np.where(lengths > 0, lengths, 1.0)[:, None])

    def is_zero(self) -> bool:
        return self._norm <= self.error

    def trace(self) -> float:
        return float(np.trace(self.array))

    # -- singular values -----------------------------------------------------------------------------------
    def rank_decision(self) -> RankDecision:
        """`RankDecision`: the rank and the singular values on both sides of the error."""
        values = np.zeros(0) if not self.array.size else np.asarray(np.linalg.svd(self.array, compute_uv=False), float)
        return rank_decision(values, self.error)

    def rank(self) -> int:
        return self.rank_decision().rank

    def _right(self, question: str) -> tuple[float, Array, int]:
        """The smallest singular value that counts, the right singular vectors as rows, the rank.

        A rank that is not clear raises `UndecidedError` if a question is given.
        """
        m, n = self.shape
        if not self.array.size:
            return math.inf, np.eye(n), 0
        small = np.linalg.qr(self.array, mode="r") if m > 2 * n else self.array
        _, values, right = np.linalg.svd(small, full_matrices=m < n)
        decision = rank_decision(values, self.error)
        if question:
            decision.require_clear(question)
        return float(values[decision.rank - 1]) if decision.rank else math.inf, right, decision.rank

    def row_space(self, question: str = "") -> FloatMatrix:
        smallest, right, rank = self._right(question)
        return self._made(right[:rank], self.error / smallest, 1.0)

    def null_space(self, question: str = "") -> FloatMatrix:
        smallest, right, rank = self._right(question)
        return self._made(right[rank:], self.error / smallest, 1.0)

    def solve(self, right: FloatMatrix) -> FloatMatrix:
        if right.nrows != self.nrows:
            raise ShapeError(f"the right-hand side has {right.nrows} rows, the matrix {self.nrows}")
        if not self.array.size:
            left, values, rows = np.zeros((self.nrows, 0)), np.zeros(0), np.zeros((0, self.ncols))
        else:
            left, values, rows = np.linalg.svd(self.array, full_matrices=False)
        rank = int((values > self.error).sum())
        solution = rows[:rank].T @ ((left[:, :rank].T @ right.array) / values[:rank, None])
        error = right.error + self.error * norm_of(solution)
        if norm_of(self.array @ solution - right.array) > error:
            raise SingularError("the linear system has no solution within the tolerance")
        return self._made(solution, error / values[rank - 1] if rank else 0.0)

    def inverse(self) -> FloatMatrix:
        n = self.nrows
        if n != self.ncols:
            raise ShapeError(f"a matrix of shape {self.shape} has no inverse")
        if not n:
            return self
        smallest = float(np.linalg.svd(self.array, compute_uv=False)[-1])
        if smallest <= self.error:
            raise SingularError("the matrix is singular within the tolerance")
        # LAPACK's elimination is accurate for rows of very different lengths, the singular vectors are not
        return self._made(np.linalg.inv(self.array), self.error / smallest / smallest, 1 / smallest)

    def signature(self) -> tuple[int, int, int]:
        if norm_of(self.array - self.array.T) > 2 * self.error:
            raise FieldError("only a symmetric matrix has a signature; this matrix is not symmetric")
        values = np.linalg.eigvalsh((self.array + self.array.T) / 2) if self.array.size else np.zeros(0)
        positive, negative = int((values > self.error).sum()), int((values < -self.error).sum())
        return positive, negative, len(values) - positive - negative


RR = FloatField()
