"""Field and Matrix: the interfaces of a scalar type and of the matrices over it.

A `Field` converts, parses and prints numbers and makes matrices over itself; a `Matrix` is immutable and knows its
field. The algebra of liehom is written once over these two. QQ and the real number fields implement them in
`exact_field`, float64 in `floating`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Generic, Protocol, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.errors import FieldError, ShapeError, displayed
from liehom.base.objects import Typeset
from liehom.base.typing import ScalarLike, VectorLike


class Scalar(Protocol):
    """A number of a field: ``flint.fmpq`` over QQ, `AlgebraicNumber` over QQ(a), ``float`` over float64.

    Every field has the operations below, between its numbers and with integers.
    """

    def __neg__(self) -> Self: ...
    def __add__(self, other: Any, /) -> Self: ...
    def __radd__(self, other: Any, /) -> Self: ...
    def __sub__(self, other: Any, /) -> Self: ...
    def __rsub__(self, other: Any, /) -> Self: ...
    def __mul__(self, other: Any, /) -> Self: ...
    def __rmul__(self, other: Any, /) -> Self: ...
    def __truediv__(self, other: Any, /) -> Self: ...
    def __rtruediv__(self, other: Any, /) -> Self: ...
    def __pow__(self, exponent: int, /) -> Self: ...
    def __abs__(self) -> Self: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __lt__(self, other: Any, /) -> bool: ...
    def __le__(self, other: Any, /) -> bool: ...
    def __gt__(self, other: Any, /) -> bool: ...
    def __ge__(self, other: Any, /) -> bool: ...
    def __float__(self) -> float: ...


def rows_of(rows: MatrixLike) -> list[list[Any]]:
    """List of rows, each a list of numbers, from nested sequences or a matrix of numpy, scipy or sympy."""
    source: Any = rows
    for convert in ("toarray", "to_Matrix", "tolist"):  # scipy's sparse arrays, sympy's DomainMatrix, then all arrays
        source = getattr(source, convert)() if hasattr(source, convert) else source
    if isinstance(source, str) or not hasattr(source, "__iter__"):
        raise ShapeError(f"a matrix is given by its rows, got {displayed(source)}")
    table = []
    for i, row in enumerate(source):
        if isinstance(row, str) or not (hasattr(row, "__iter__") or hasattr(row, "__len__")):  # sympy's have a length
            raise ShapeError(f"row {i} is {displayed(row)}, expected a sequence of numbers")
        table.append(list(row))
    return table


class Matrix(Typeset, ABC):
    """An immutable matrix over a field: the interface of exact and numerical matrices.

    Vectors are rows: a subspace is given by the rows of a matrix, and ``null_space`` returns rows. Iteration gives the
    rows as lists, ``len`` their number, and ``numpy.asarray`` an array of shape (nrows, ncols): of exact numbers as
    objects, or of floats with ``dtype=float``. ``2 * A``, ``A / 3`` and ``sum([A, B])`` are matrices; ``A @ B`` is the
    matrix product.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> A = QQ.matrix([[1, 2], [2, 4]])
    >>> A.rank(), A.null_space().to_strings()
    (1, [['-2', '1']])
    >>> [sum(row) for row in A], np.asarray(A / 2).tolist(), sum([A, 3 * A]) == A * 4
    ([3, 6], [[1/2, 1], [1, 2]], True)
    """

    __slots__ = ()
    __array_ufunc__ = None  # the operators of numpy's arrays and numbers leave a matrix to its own operators

    # -- shape and entries -------------------------------------------------------------------------------
    @property
    @abstractmethod
    def field(self) -> Field:
        """Field of the entries."""

    @property
    @abstractmethod
    def shape(self) -> tuple[int, int]:
        """(number of rows, number of columns)."""

    @property
    def nrows(self) -> int:
        """Number of rows."""
        return self.shape[0]

    @property
    def ncols(self) -> int:
        """Number of columns."""
        return self.shape[1]

    @abstractmethod
    def __getitem__(self, index: tuple[int, int]) -> Scalar: ...

    @abstractmethod
    def to_rows(self) -> list[list[Scalar]]:
        """List of rows, each a list of field elements."""

    def __len__(self) -> int:
        return self.nrows

    def __iter__(self) -> Iterator[list[Scalar]]:
        return iter(self.to_rows())

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        """Array for ``numpy.asarray(matrix)``: exact numbers as objects, or floats for a float or complex dtype."""
        if copy is False:
            raise ValueError(f"an array of {displayed(self)} is always a copy; use numpy.asarray without copy=False")
        wanted = np.dtype(dtype if dtype is not None else object if self.field.exact else np.float64)
        if wanted.kind in "fc" or not self.field.exact:
            return self.to_numpy().astype(wanted)
        array: npt.NDArray[Any] = np.empty(self.shape, dtype=object)
        try:
            array.reshape(-1)[:] = [int(self.field.format(x)) if wanted.kind in "iu" else x for x in self.entries()]
            return array.astype(wanted)
        except (ValueError, OverflowError):
            kind = f"integers that {wanted} holds" if wanted.kind in "iu" else f"of the type {wanted}"
            raise FieldError(
                f"{displayed(self)} has entries that are not {kind}; numpy.asarray(A) has them exactly"
            ) from None

    def to_strings(self) -> list[list[str]]:
        """List of rows of strings in the grammar of values, as in JSON files."""
        zero = self.field.format(self.field.zero)
        return [[self.field.format(x) if x != 0 else zero for x in row] for row in self.to_rows()]

    def row(self, i: int) -> list[Scalar]:
        """Row i as a list of field elements."""
        return [self[i, j] for j in range(self.ncols)]

    @abstractmethod
    def to_numpy(self) -> npt.NDArray[np.float64]:
        """Array of float64, shape (nrows, ncols), with the rounded entries."""

    @abstractmethod
    def select(self, rows: Sequence[int] | None = None, columns: Sequence[int] | None = None) -> Self:
        """The submatrix of the given rows and columns; None selects all."""

    # -- arithmetic --------------------------------------------------------------------------------------
    @property
    @abstractmethod
    def T(self) -> Self:
        """The transpose."""

    @abstractmethod
    def __add__(self, other: Self) -> Self: ...

    @abstractmethod
    def __sub__(self, other: Self) -> Self: ...

    @abstractmethod
    def __neg__(self) -> Self: ...

    @abstractmethod
    def __matmul__(self, other: Self) -> Self: ...

    def __radd__(self, other: int) -> Self:
        # sum(matrices) begins with 0
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __mul__(self, factor: ScalarLike) -> Self:
        if isinstance(factor, (Matrix, np.ndarray, Sequence)):
            raise TypeError(
                f"* multiplies a matrix by a number, @ by a matrix over the same field; got {displayed(factor)}"
            )
        return self.scale(factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: ScalarLike) -> Self:
        return self * (self.field.one / self.field.convert(divisor))

    @abstractmethod
    def scale(self, factor: ScalarLike) -> Self:
        """The matrix times a number of the field."""

    @abstractmethod
    def is_zero(self) -> bool:
        """Whether every entry is zero; over float64, whether the norm is at most the error of the matrix."""

    def first_nonzero_row(self) -> int | None:
        """Index of the first row that is not zero, None for a zero matrix.

        Over floats, where the error is one of all rows, the index of the longest row.
        """
        if self.is_zero():
            return None
        if self.field.exact:
            return next(i for i in range(self.nrows) if not self.select(rows=[i]).is_zero())
        return int(np.linalg.norm(self.to_numpy(), axis=1).argmax())

    @abstractmethod
    def trace(self) -> Scalar:
        """Sum of the diagonal entries."""

    @abstractmethod
    def reshape(self, nrows: int, ncols: int) -> Self:
        """The matrix of shape (nrows, ncols) with these entries, row after row."""

    @abstractmethod
    def split_rows(self, nrows: int, ncols: int) -> list[Self]:
        """List of matrices of shape (nrows, ncols), one from each row."""

    @abstractmethod
    def entries(self) -> list[Scalar]:
        """List of the entries, row after row."""

    # -- linear algebra ----------------------------------------------------------------------------------
    @abstractmethod
    def rank(self) -> int:
        """Rank, an int."""

    @abstractmethod
    def row_space(self, question: str = "") -> Self:
        """A canonical basis of the span of the rows (reduced echelon form; orthonormal over floats).

        Over floats a question that the dimension decides can be given: `UndecidedError` names it if the rank is not
        clear (`RankDecision.clear`). The same holds for null spaces.
        """

    @abstractmethod
    def null_space(self, question: str = "") -> Self:
        """A matrix whose rows are a basis of {x : A x = 0}."""

    def left_null_space(self, question: str = "") -> Self:
        """A matrix whose rows are a basis of {y : y A = 0}."""
        return self.T.null_space(question)

    @abstractmethod
    def solve(self, right: Self) -> Self:
        """Some X with A X = right; `SingularError` if no X exists."""

    @abstractmethod
    def inverse(self) -> Self:
        """The inverse; `SingularError` if the matrix is singular."""

    @abstractmethod
    def signature(self) -> tuple[int, int, int]:
        """Numbers of (positive, negative, zero) eigenvalues of a symmetric matrix."""

    def is_positive_definite(self) -> bool:
        """Whether a symmetric matrix is positive definite."""
        return self.signature()[0] == self.nrows


if TYPE_CHECKING:
    from typing_extensions import TypeVar

    M = TypeVar("M", bound=Matrix, covariant=True, default=Any)
else:
    from typing import TypeVar  # the default, for `Field` without a parameter, needs Python 3.13

    M = TypeVar("M")


class Field(ABC, Generic[M]):
    """A field of real numbers together with its matrices.

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
    >>> QQ.convert("3/4") + 1
    7/4
    """

    __slots__ = ()

    @property
    @abstractmethod
    def exact(self) -> bool:
        """Whether arithmetic is exact."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name in messages and reprs, such as 'QQ', 'QQ(sqrt(2))', 'float64'."""

    @property
    def degree(self) -> int:
        """Degree over QQ of an exact field; 1 for float64."""
        return 1

    @property
    @abstractmethod
    def zero(self) -> Scalar:
        """The number 0."""

    @property
    @abstractmethod
    def one(self) -> Scalar:
        """The number 1."""

    @abstractmethod
    def convert(self, value: ScalarLike) -> Scalar:
        """The field element that `value` denotes; `FieldError` or `ParseError` if it denotes no element."""

    @abstractmethod
    def format(self, value: Scalar) -> str:
        """The element as a string in the grammar of values, which ``convert`` reads back."""

    def show(self, value: Scalar) -> str:
        """The element as it is printed, a string in the grammar of values: the shortest known form."""
        return self.format(value)

    @abstractmethod
    def sign(self, value: Scalar) -> int:
        """Sign of an element: -1, 0 or 1."""

    @abstractmethod
    def to_float(self, value: Scalar) -> float:
        """The nearest float (to a few units in the last place)."""

    def sqrt(self, value: ScalarLike) -> Scalar:
        """The non-negative square root of an element; `FieldError` if it is not in the field, or the field is RR."""
        raise FieldError(f"square roots of {self.name} are not exact; use numpy.sqrt for {value}")

    @abstractmethod
    def matrix(self, rows: MatrixLike, shape: tuple[int, int] | None = None) -> M:
        """The matrix with these rows; `shape` is needed if there may be no rows or no columns."""

    def read(self, rows: MatrixLike, shape: tuple[int, int] | None = None) -> M:
        """The matrix over this field with the given rows, or with the entries of a matrix over another field.

        Raises `FieldError` if an entry is not in this field.
        """
        matrix: Any = rows
        if not isinstance(rows, Matrix):
            return self.matrix(rows, shape)
        return matrix if rows.field == self else self.matrix(rows.to_rows(), rows.shape)

    @abstractmethod
    def from_entries(self, entries: Sequence[Any], nrows: int, ncols: int) -> M:
        """The matrix of shape (nrows, ncols) with these field elements, row after row."""

    @abstractmethod
    def zeros(self, nrows: int, ncols: int) -> M:
        """Zero matrix of shape (nrows, ncols)."""

    @abstractmethod
    def identity(self, n: int) -> M:
        """Identity matrix of shape (n, n)."""

    @abstractmethod
    def stack_rows(self, blocks: Sequence[Any], ncols: int) -> M:
        """The matrix whose rows are those of the blocks, one block below the other; all have `ncols` columns."""

    def stack_columns(self, blocks: Sequence[Any], nrows: int) -> M:
        """The matrix whose columns are those of the blocks, side by side; all have `nrows` rows."""
        return self.stack_rows([b.T for b in blocks], nrows).T

    def unit(self, n: int, i: int) -> M:
        """The row matrix (1, n) with a one in column i."""
        return self.identity(n).select(rows=[i])

    def __repr__(self) -> str:
        return self.name


MatrixLike: TypeAlias = Sequence[VectorLike] | npt.NDArray[Any] | Matrix
"""Input that a field reads as a matrix: rows of numbers, arrays of numpy, scipy and sympy, a `Matrix`."""

MatricesLike: TypeAlias = Sequence[MatrixLike] | npt.NDArray[Any]
"""Several matrices of one shape: a sequence of them, or an array of shape (k, m, n)."""
