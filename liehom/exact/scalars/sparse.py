"""Sparse matrices: integers over a common denominator, and exact matrices from their non-zero entries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.base.budget import in_time
from liehom.base.typing import IntegerArray, ObjectArray
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix

if TYPE_CHECKING:
    from scipy import sparse

# Products use scipy.sparse with int64 if a bound on every sum excludes overflow, else dictionaries of Python integers.
# The class has only the operations that contractions of structure constants need.

# bound for sums of int64 products, with a factor 2 to spare
INT64_LIMIT = 1 << 62


@final
class SparseInteger:
    """A sparse matrix with integer entries over a common denominator."""

    columns: IntegerArray
    rows: IntegerArray

    __slots__ = ("columns", "den", "rows", "shape", "values")

    def __init__(
        self, rows: npt.ArrayLike, columns: npt.ArrayLike, values: npt.ArrayLike, shape: tuple[int, int], den: int = 1
    ) -> None:
        self.rows = np.asarray(rows, dtype=np.int64)
        self.columns = np.asarray(columns, dtype=np.int64)
        self.values: IntegerArray | ObjectArray = _narrowed(values)
        self.shape: tuple[int, int] = shape
        self.den: int = den

    @classmethod
    def from_matrix(cls, matrix: ExactMatrix) -> SparseInteger:
        """The `SparseInteger` equal to a matrix over QQ."""
        entries = {x: int(v) for x, v in enumerate(matrix.parts[0].entries()) if v}
        index, n = np.array(list(entries), dtype=np.int64), max(matrix.ncols, 1)
        return cls(index // n, index % n, list(entries.values()), matrix.shape, matrix.den)

    def __matmul__(self, other: SparseInteger) -> SparseInteger:
        in_time()
        shape = (self.shape[0], other.shape[1])
        den = self.den * other.den
        if not len(self.values) or not len(other.values):
            return SparseInteger([], [], [], shape, den)
        if self._product_fits(other):
            product = (self._csr() @ other._csr()).tocoo()
            keep = product.data != 0
            return SparseInteger(product.row[keep], product.col[keep], product.data[keep], shape, den)
        return self._product_by_dictionaries(other, shape, den)

    def _product_fits(self, other: SparseInteger) -> bool:
        if self.values.dtype == object or other.values.dtype == object:
            return False
        sums = np.zeros(self.shape[0])
        np.add.at(sums, self.rows, np.abs(self.values.astype(np.float64)))
        return bool(sums.max() * float(np.abs(other.values.astype(np.float64)).max()) < INT64_LIMIT / 2)

    def _csr(self) -> sparse.csr_array:
        from scipy import sparse

        return sparse.coo_array((self.values.astype(np.int64), (self.rows, self.columns)), shape=self.shape).tocsr()

    def _product_by_dictionaries(self, other: SparseInteger, shape: tuple[int, int], den: int) -> SparseInteger:
        right: dict[int, list[tuple[int, int]]] = {}
        for r, c, v in zip(other.rows.tolist(), other.columns.tolist(), other.values.tolist(), strict=True):
            right.setdefault(r, []).append((c, v))
        total: dict[tuple[int, int], int] = {}
        for r, c, v in zip(self.rows.tolist(), self.columns.tolist(), self.values.tolist(), strict=True):
            in_time()
            for column, w in right.get(c, ()):
                total[r, column] = total.get((r, column), 0) + v * w
        places, values = [x for x, v in total.items() if v], [v for v in total.values() if v]
        return SparseInteger([r for r, _ in places], [c for _, c in places], values, shape, den)

    def reshape(self, nrows: int, ncols: int) -> SparseInteger:
        """The matrix of shape (nrows, ncols) with these entries, row after row."""
        place = self.rows * self.shape[1] + self.columns
        return SparseInteger(place // ncols, place % ncols, self.values, (nrows, ncols), self.den)

    def regroup(self, p: int, q: int, r: int) -> SparseInteger:
        """The matrix of shape (q, p*r) with the first two of three indices exchanged, from shape (p, q*r)."""
        j, c = self.columns // r, self.columns % r
        return SparseInteger(j, self.rows * r + c, self.values, (q, p * r), self.den)

    def first_entry(self) -> tuple[int, int] | None:
        """Position (row, column) of the first non-zero entry by column, then row, or None."""
        if not len(self.values):
            return None
        place = int(np.lexsort((self.rows, self.columns))[0])
        return int(self.rows[place]), int(self.columns[place])

    def dense_blocks(self, field: ExactField, p: int, q: int, r: int) -> list[ExactMatrix]:
        """List of the p blocks of shape (q, r), side by side in this matrix of shape (q, p*r)."""
        tables = [[0] * (q * r) for _ in range(p)]
        for row, column, v in zip(self.rows.tolist(), self.columns.tolist(), self.values.tolist(), strict=True):
            a, c = divmod(column, r)
            tables[a][row * r + c] = v
        return [ExactMatrix(field, (flint.fmpz_mat(q, r, t),), self.den).normalized() for t in tables]


def _narrowed(values: Any) -> IntegerArray | ObjectArray:
    """Array of int64 if all values fit, else an object array of Python integers."""
    if isinstance(values, np.ndarray) and values.dtype == np.int64:
        return values
    try:
        return np.array(values, dtype=np.int64)
    except OverflowError:
        return np.array([int(v) for v in values], dtype=np.object_)


def matrix_from_entries(
    field: ExactField, tables: Sequence[Mapping[int, int | flint.fmpz]], nrows: int, ncols: int, den: int = 1
) -> ExactMatrix:
    """The matrix with the given integer coordinates at some indices and zero elsewhere, over a common denominator."""
    parts = []
    for table in tables:
        part = flint.fmpz_mat(nrows, ncols)
        for index, value in table.items():
            part[index // ncols, index % ncols] = value
        parts.append(part)
    return ExactMatrix(field, tuple(parts), den).normalized()
