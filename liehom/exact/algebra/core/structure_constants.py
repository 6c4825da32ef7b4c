"""StructureConstants: the bracket as a sparse table, and its contractions with matrices."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from math import gcd, lcm
from typing import Any, TypeVar, cast, final

import numpy as np

from liehom.base.objects import Immutable
from liehom.base.typing import Array, IntegerArray
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, Scalar
from liehom.exact.scalars.floating import FloatField, FloatMatrix, norm_of
from liehom.exact.scalars.sparse import SparseInteger, matrix_from_entries

# The numbers of a bracket table as integers over a common denominator, and as dense exact matrices.


def integers_of(field: Field, values: Sequence[Any]) -> tuple[tuple[Any, ...], int]:
    """Numerators (one sequence per coordinate over QQ) and their common denominator; floats as one array over 1."""
    if isinstance(field, FloatField):
        return (np.array(values, dtype=np.float64),), 1
    exact = exactly(field)
    if exact.degree == 1:
        den = lcm(*(int(v.q) for v in values))
        return ([int(v.p) * (den // int(v.q)) for v in values],), den
    columns = [exact.coordinates(v) for v in values]
    den = lcm(*(int(c.q) for column in columns for c in column))
    integral = [[int(c.p) * (den // int(c.q)) for c in column] for column in columns]
    return tuple(list(part) for part in zip(*integral, strict=True)) or ([],) * exact.degree, den


def exactly(field: Field) -> ExactField:
    """The given field, typed as an `ExactField`; `TypeError` if it is not exact."""
    if not isinstance(field, ExactField):
        raise TypeError(f"structure constants over {field} are not supported")
    return field


def dense_exact(
    field: ExactField,
    shape: tuple[int, int],
    forward: list[int],
    backward: list[int],
    parts: tuple[Sequence[int], ...],
    den: int,
) -> ExactMatrix:
    """The matrix with numerators `parts` at the flat indices `forward`, and their negatives at `backward`."""
    dense = [[0] * (shape[0] * shape[1]) for _ in parts]
    for out, part in zip(dense, parts, strict=True):
        for f, b, v in zip(forward, backward, part, strict=True):
            out[f] = v
            out[b] = -v
    return field.from_parts(dense, *shape, den)


# StructureConstants: the bracket as a sparse table, and its contractions with matrices.
# The table holds c[i, j, k] for i < j, [e_i, e_j] = sum_k c[i, j, k] e_k, as integers over a common denominator (over
# a number field the integer coordinates of entries). Contractions are products in float64 if a bound proves them exact;
# else one dense flint product, or sparse integer products that cannot overflow.

M = TypeVar("M", bound=Matrix)

DENSE_DIMENSION = 64  # up to this dimension one dense product is faster than sparse ones, whatever the table
LARGEST_DENSE = 160  # up to this dimension tables with more than n^2 entries are contracted densely
EXACT_FLOATS = float(1 << 53)  # float64 holds all integers below this one
FEW_ROWS = 3  # whose normalizer is found with unknown coefficients
SPARSE = 3  # entries for each that is not 0, from which a matrix is made of these alone
MOST_FLOATS = 1 << 22  # entries of the arrays of one contraction in float64


def exact_floats(matrix: ExactMatrix) -> Array | None:
    """The numerators of a matrix over QQ as float64, or None if one of them is not small."""
    return _small_floats(matrix.parts[0].entries(), matrix.shape)


def _small_floats(values: Sequence[Any], shape: tuple[int, ...]) -> Array | None:
    """Integers as an array of float64, or None if one of them has more than 32 bits."""
    try:
        narrow = np.array([int(x) for x in values], dtype=np.int64)
    except OverflowError:
        return None
    return narrow.astype(np.float64).reshape(shape) if not len(values) or np.abs(narrow).max() < 1 << 32 else None


def _from_floats(field: ExactField, values: Array, shape: tuple[int, int], den: int) -> ExactMatrix:
    """The matrix over QQ with integers in float64 as numerators, row after row."""
    flat = values.astype(np.int64).ravel()
    places = np.flatnonzero(flat)
    if SPARSE * len(places) < len(flat):
        return matrix_from_entries(field, [dict(zip(places.tolist(), flat[places].tolist(), strict=True))], *shape, den)
    return field.from_integers(flat.tolist(), *shape, den)


def _largest(array: Array) -> float:
    return float(np.abs(array).max(initial=0.0))


@final
class StructureConstants(Immutable):
    """The entries c[i, j, k], i < j, of a bracket table over a field, sorted by (i, j, k).

    Parameters
    ----------
    field : Field
    dimension : int
    entries : iterable of (i, j, k, value)
        Each position once, i < j, values non-zero elements of the field.
    error : float, optional
        Over floats, the uncertainty of computed entries; by default they are data.

    Attributes
    ----------
    error : float
        Over floats a bound on the uncertainty of the table, as of the `FloatMatrix` of all c[i, j, k]; 0 over an
        exact field.
    """

    den: int
    dimension: int
    error: float
    field: Field[Any]
    i: IntegerArray
    j: IntegerArray
    k: IntegerArray
    parts: tuple[Sequence[int], ...]
    _dense: Matrix | None
    _flat: Matrix | None
    _floats: Array | bool | None
    _sparse: SparseInteger | None

    __slots__ = ("_dense", "_flat", "_floats", "_sparse", "den", "dimension", "error", "field", "i", "j", "k", "parts")

    def __init__(
        self, field: Field, dimension: int, entries: Iterable[tuple[int, int, int, Scalar]], error: float | None = None
    ) -> None:
        ordered = sorted(entries, key=lambda e: e[:3])
        index = np.array([e[:3] for e in ordered], dtype=np.int64).reshape(len(ordered), 3)
        self._set(field, dimension, tuple(index.T), *integers_of(field, [e[3] for e in ordered]), error)

    def _set(
        self,
        field: Field,
        dimension: int,
        index: tuple[IntegerArray, ...],
        parts: tuple[Any, ...],
        den: int,
        error: float | None,
    ) -> StructureConstants:
        """This table, with all its attributes assigned."""
        self.field, self.dimension, self.parts, self.den = field, dimension, parts, den
        self.i, self.j, self.k = index
        self.error = self._error_of_data() if error is None else error
        self._dense = self._flat = self._floats = self._sparse = None
        return self

    @classmethod
    def from_integers(
        cls,
        field: Field,
        dimension: int,
        i: IntegerArray,
        j: IntegerArray,
        k: IntegerArray,
        numerators: Sequence[int],
        den: int = 1,
    ) -> StructureConstants:
        """The table with rational entries numerators[x] / den at distinct indices (i[x], j[x], k[x]) with i < j.

        Zero entries are dropped.  This is fast for large tables because it constructs no field element.
        """
        order = [x for x in np.lexsort((k, j, i)).tolist() if numerators[x]]
        common = gcd(den, *(numerators[x] for x in order)) if den != 1 else 1
        parts = ([numerators[x] // common for x in order], *([0] * len(order) for _ in range(field.degree - 1)))
        return cls.__new__(cls)._set(field, dimension, (i[order], j[order], k[order]), parts, den // common, 0.0)

    @classmethod
    def from_array(cls, field: FloatField, constants: Array, error: float | None = None) -> StructureConstants:
        """The table over floats with the entries c[i, j, k], i < j, of an array of shape (n, n, n).

        Parameters
        ----------
        field : FloatField
        constants : ndarray
        error : float, optional
            The uncertainty of a computed array; by default the array is data.
        """
        n = len(constants)
        upper = (constants != 0) & np.triu(np.ones((n, n), dtype=bool), 1)[:, :, None]
        return cls.__new__(cls)._set(field, n, np.nonzero(upper), (constants[upper],), 1, error)

    def _error_of_data(self) -> float:
        return self.field.rtol * self.norm() if isinstance(self.field, FloatField) else 0.0

    def norm(self) -> float:
        """Frobenius norm of all c[i, j, k] of a table over floats."""
        return math.sqrt(2) * norm_of(np.asarray(self.parts[0], dtype=np.float64))

    def is_zero(self) -> bool:
        """Whether all brackets vanish; over floats, whether the norm of the table is within its error."""
        return self.norm() <= self.error if isinstance(self.field, FloatField) else len(self) == 0

    @classmethod
    def from_blocks(cls, field: Field, n: int, blocks: Sequence[Any]) -> StructureConstants:
        """The table with [e_i, e_j] = row j of block i, a list of n matrices (n, n) known to be antisymmetric."""
        if isinstance(field, FloatField):
            array = np.array([block.array for block in blocks]).reshape(n, n, n)
            return cls.from_array(field, array, math.hypot(*(block.error for block in blocks)))
        if field.degree == 1:
            return cls._from_rational_blocks(field, n, blocks)
        entries = ((i, x, v) for i, block in enumerate(blocks) for x, v in enumerate(block.entries()))
        nonzero = [(i, x // n, x % n, v) for i, x, v in entries if x >= (i + 1) * n and v != field.zero]
        return cls(field, n, nonzero)

    @classmethod
    def _from_rational_blocks(cls, field: Field, n: int, blocks: Sequence[ExactMatrix]) -> StructureConstants:
        den = lcm(*(block.den for block in blocks))
        numerators: dict[int, int] = {}
        for i, block in enumerate(blocks):
            entries, factor = block.parts[0].entries(), den // block.den
            numerators |= {i * n * n + x: int(entries[x]) * factor for x in range((i + 1) * n, n * n) if entries[x]}
        index = np.array(list(numerators), dtype=np.int64)
        values = list(numerators.values())
        return cls.from_integers(field, n, index // (n * n), index // n % n, index % n, values, den)

    # -- entries -----------------------------------------------------------------------------------------
    def __len__(self) -> int:
        return len(self.i)

    def values(self) -> list[Scalar]:
        """The entries as field elements, in the table's order."""
        if isinstance(self.field, FloatField):
            return [float(x) for x in self.parts[0]]
        make, den = exactly(self.field).from_integer_coordinates, self.den
        return [make(x, den) for x in zip(*self.parts, strict=True)]

    def __iter__(self) -> Iterator[tuple[int, int, int, Scalar]]:
        return zip(self.i.tolist(), self.j.tolist(), self.k.tolist(), self.values(), strict=True)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, StructureConstants):
            return NotImplemented
        same_size = self.dimension == other.dimension and len(self) == len(other)
        return self.field == other.field and same_size and self._content() == other._content()

    def __hash__(self) -> int:
        return hash((self.field, self.dimension, self._content()))

    def _content(self) -> tuple[Any, ...]:
        """Indices, numerators and their common denominator, which is the least: equal tables have equal contents."""
        index = (self.i.tobytes(), self.j.tobytes(), self.k.tobytes())
        return (*index, self.den, *(tuple(part) for part in self.parts))

    def exact_field(self) -> ExactField:
        """The field of a table over an exact field; `TypeError` over floats."""
        return exactly(self.field)

    def by_pair(self) -> dict[tuple[int, int], list[tuple[int, Any]]]:
        """The table as {(i, j): [(k, value), ...]} for both orders of i and j, with numerators as values over QQ."""
        table: dict[tuple[int, int], list[tuple[int, Any]]] = {}
        values = self.parts[0] if len(self.parts) == 1 and self.field.exact else self.values()
        for i, j, k, v in zip(self.i.tolist(), self.j.tolist(), self.k.tolist(), values, strict=True):
            table.setdefault((i, j), []).append((k, v))
            table.setdefault((j, i), []).append((k, -v))
        return table

    def jacobi_terms(self) -> int:
        """The number of products in all double brackets, the cost of a sparse proof of the Jacobi identity."""
        out, first, second = (np.bincount(index, minlength=self.dimension) for index in (self.k, self.i, self.j))
        return int(out @ (first + second))

    # -- contractions ------------------------------------------------------------------------------------
    def is_dense(self) -> bool:
        """Whether contractions use one dense product instead of sparse ones."""
        n = self.dimension
        return n <= DENSE_DIMENSION or not self.field.exact or (n <= LARGEST_DENSE and len(self) > n * n)

    def dense(self) -> Matrix:
        """The matrix (n*n, n) with row i*n + j the coefficients of [e_i, e_j]."""
        if self._dense is None:
            self._dense = self._filled(self.dimension**2, self.dimension)
        return self._dense

    def _filled(self, nrows: int, ncols: int) -> Matrix:
        """All c[i, j, k] in lexicographic order of (i, j, k), as a matrix of the given shape."""
        n = self.dimension
        forward = (self.i * n + self.j) * n + self.k
        backward = (self.j * n + self.i) * n + self.k
        if isinstance(self.field, FloatField):
            array = np.zeros(n**3)
            array[forward], array[backward] = self.parts[0], -np.array(self.parts[0])
            return FloatMatrix(self.field, array.reshape(nrows, ncols), self.error)
        return dense_exact(
            exactly(self.field), (nrows, ncols), forward.tolist(), backward.tolist(), self.parts, self.den
        )

    def flat(self) -> Matrix:
        """The matrix (n, n*n) with row i the matrix c[i, :, :] row after row (cached): x flat() is ad x transposed."""
        if self._flat is None:
            self._flat = self._filled(self.dimension, self.dimension**2)
        return self._flat

    def sparse(self) -> SparseInteger:
        """The integer table (n*n, n) as a sparse matrix; only over QQ."""
        if self._sparse is None:
            n = self.dimension
            rows = np.concatenate([self.i * n + self.j, self.j * n + self.i])
            values = [*self.parts[0], *(-v for v in self.parts[0])]
            self._sparse = SparseInteger(rows, np.concatenate([self.k, self.k]), values, (n * n, n), self.den)
        return self._sparse

    def floats(self) -> Array | None:
        """The numerators of a table over QQ as float64 (cached), or None if one of them is not small."""
        if self._floats is None:
            small = _small_floats(self.parts[0], (len(self),)) if self.field.exact and self.field.degree == 1 else None
            self._floats = False if small is None else small
        return None if isinstance(self._floats, bool) else self._floats

    def adjoint(self, x: M) -> M:
        """The matrix (n, n) of y -> [x, y] on columns, for a row matrix x of shape (1, n)."""
        n = self.dimension
        if isinstance(x, ExactMatrix) and (c := self.floats()) is not None and (w := exact_floats(x)) is not None:
            fits = 2 * n * _largest(c) * _largest(w) < EXACT_FLOATS
            if fits:
                return cast(M, _from_floats(x.field, self.adjoint_floats(w[0], c), (n, n), self.den * x.den))
        if self.is_dense():
            return (x @ cast(M, self.flat())).reshape(n, n).T
        return self.contract(x, self.field.identity(n), self.field.identity(n))[0].T

    def adjoint_floats(self, x: Array, values: Array) -> Array:
        """The matrix (n, n) of y -> [x, y] on columns in float64, for x (n,) and entries of the table."""
        n = self.dimension
        index = np.concatenate([self.k * n + self.j, self.k * n + self.i])
        weights = np.concatenate([x[self.i] * values, -x[self.j] * values])
        return np.bincount(index, weights, n * n).astype(np.float64).reshape(n, n)

    def contract_floats(self, left: Matrix, right: Matrix, out: Matrix) -> Array | None:
        """The numerators of `contract` in float64, shape (p, q, r), or None if they may not be exact, or too many."""
        n, p, q, r = self.dimension, left.nrows, right.nrows, out.ncols
        few = p < r  # the matrices ad x of the rows x on the left are made one by one
        size = p * max(n, q) * n if few else max(n, p) * max(n, q) * r
        if 0 in (n, p, q, r) or size > MOST_FLOATS or (c := self.floats()) is None:
            return None
        one = self.field.identity(n)
        factors: list[Array | None] = []  # None stands for the identity
        for a in (left, right, out):
            factors.append(None if a == one else exact_floats(cast(ExactMatrix, a)))
            if factors[-1] is None and a != one:
                return None
        x, y, z = factors
        sums = [1.0 if f is None else float(np.abs(f).sum(axis=1).max()) for f in (x, y)]
        if (
            n * _largest(c) * (1.0 if z is None else _largest(z)) * sums[0] * sums[1] * (2 * n if few else 1)
            >= EXACT_FLOATS
        ):
            return None
        if few and x is not None:
            array = np.stack([self.adjoint_floats(row, c).T for row in x])
            array = array if y is None else np.matmul(y, array)
            return array if z is None else array @ z
        array = np.zeros((n, n, r))
        if z is None:
            array[self.i, self.j, self.k] = c
        elif len(self):
            starts = np.flatnonzero(np.diff(self.i * n + self.j, prepend=-1))
            array[self.i[starts], self.j[starts]] = np.add.reduceat(c[:, None] * z[self.k], starts, axis=0)
        array -= array.transpose(1, 0, 2)
        array = array if x is None else (x @ array.reshape(n, n * r)).reshape(p, n, r)
        return array if y is None else np.matmul(y, array)

    def contract(self, left: M, right: M, out: M) -> list[M]:
        """For each row a of `left`, the matrix with rows [left_a, right_b] @ out.

        Parameters
        ----------
        left, right : Matrix
            Rows of coefficients, shapes (p, n) and (q, n).
        out : Matrix
            Shape (n, r).

        Returns
        -------
        list of Matrix
            p matrices of shape (q, r).
        """
        n, p, q, r = self.dimension, left.nrows, right.nrows, out.ncols
        if p == 0 or q == 0 or r == 0 or n == 0:
            return [self.field.zeros(q, r) for _ in range(p)]
        if isinstance(left, FloatMatrix):
            return cast(list[M], self._contract_floats(left, right, out).reshape(p, q * r).split_rows(q, r))
        if (floats := self.contract_floats(left, right, out)) is not None:
            den = self.den * math.prod(a.den for a in (left, right, out) if isinstance(a, ExactMatrix))
            return cast(list[M], [_from_floats(exactly(self.field), block, (q, r), den) for block in floats])
        if self.is_dense() or self.field.degree > 1:
            if self.field.degree == 1:
                return self._contract_rational(left, right, out)
            one, flat = self.field.identity(n), cast(M, self.flat())
            blocks = (flat if left == one else left @ flat).split_rows(n, n)
            if right != one:
                blocks = [right @ block for block in blocks]
            return blocks if out == one else [block @ out for block in blocks]
        product = self._contract_sparse(left, right, out)
        return cast(list[M], product.dense_blocks(exactly(self.field), p, q, r))

    def _contract_floats(self, left: Matrix, right: Matrix, out: Matrix) -> FloatMatrix:
        """All rows [left_a, right_b] @ out, shape (p * q, r), with one error for the whole."""
        n, p, q = self.dimension, left.nrows, right.nrows
        one = self.field.identity(n)
        flat: Any = self.flat()
        brackets = flat if left == one else left @ flat
        if right != one:
            brackets = (right @ brackets.regroup(p, n, n)).regroup(q, p, n)
        rows: FloatMatrix = brackets.reshape(p * q, n)
        return rows if out == one else rows @ cast(FloatMatrix, out)

    def _contract_rational(self, left: Any, right: Any, out: Any) -> list[Any]:
        """`contract` for a dense table over QQ: numerators are multiplied, denominators reduced once."""
        n, field = self.dimension, exactly(self.field)
        one = field.identity(n)
        flat: Any = self.flat()
        integers = flat.parts[0] if left == one else left.parts[0] * flat.parts[0]
        den = flat.den * left.den * right.den * out.den
        blocks = [block.parts[0] for block in ExactMatrix(field, (integers,), 1).split_rows(n, n)]
        if right != one:
            blocks = [right.parts[0] * block for block in blocks]
        if out != one:
            blocks = [block * out.parts[0] for block in blocks]
        return [ExactMatrix(field, (block,), den).normalized() for block in blocks]

    def bracket_rows(self, left: M, right: M) -> M:
        """The matrix (p * q, n) with the rows [left_a, right_b] in lexicographic order of (a, b)."""
        one = cast(M, self.field.identity(self.dimension))
        if isinstance(left, FloatMatrix) and left.nrows and right.nrows:
            return cast(M, self._contract_floats(left, right, one))
        if isinstance(left, ExactMatrix) and (floats := self.contract_floats(left, right, one)) is not None:
            den = self.den * left.den * cast(ExactMatrix, right).den
            return cast(M, _from_floats(left.field, floats, (left.nrows * right.nrows, self.dimension), den))
        return self.field.stack_rows(self.contract(left, right, one), self.dimension)

    def bracket_columns(self, left: M, out: M) -> M:
        """The matrix (n, p * r) of x -> [left_a, x] @ out for all a, on rows x; columns that are 0 may be left out."""
        n, p, one = self.dimension, left.nrows, cast(M, self.field.identity(self.dimension))
        if isinstance(left, FloatMatrix) and p and n and out.ncols:
            return cast(M, self._contract_floats(left, one, out).regroup(p, n, out.ncols))
        if isinstance(left, ExactMatrix) and (floats := self.contract_floats(left, one, out)) is not None:
            wide = floats.transpose(1, 0, 2).reshape(n, p * out.ncols)
            wide = wide[:, wide.any(axis=0)]
            return cast(M, _from_floats(left.field, wide, wide.shape, self.den * left.den * cast(ExactMatrix, out).den))
        blocks = self.contract(left, one, out)
        return self.field.stack_columns(blocks, n) if blocks else self.field.zeros(n, 0)

    def normalizing_columns(self, rows: ExactMatrix) -> ExactMatrix | None:
        """The equations [r_i, x] = sum_j c_ij r_j for few rows r_i, on rows (c, x); None if they are many or large."""
        n, k, one = self.dimension, rows.nrows, exactly(self.field).identity(self.dimension)
        brackets = None if k > FEW_ROWS else self.contract_floats(rows, one, one)
        values = None if brackets is None else exact_floats(rows)
        if brackets is None or values is None:
            return None
        # the unknown c_ij come first, since x determines them; their scale and sign do not matter
        wide = np.zeros((k * k + n, k, n))
        for i in range(k):
            wide[i * k : (i + 1) * k, i] = values
        wide[k * k :] = brackets.transpose(1, 0, 2)
        flat = wide.reshape(k * k + n, k * n)
        flat = flat[:, flat.any(axis=0)]
        return _from_floats(rows.field, flat, flat.shape, 1)

    def first_nonzero(self, left: Matrix, right: Matrix, out: Matrix) -> tuple[int, int] | None:
        """The first (a, b) with [left_a, right_b] @ out not zero, or None, which proves that all vanish.

        Over floats None says that all together are within the error, and the pair is the one with the largest row.
        """
        if min(left.nrows, right.nrows, out.ncols, self.dimension) == 0:
            return None
        if isinstance(left, FloatMatrix):
            largest = self._contract_floats(left, right, out).first_nonzero_row()
            return None if largest is None else divmod(largest, right.nrows)
        if (floats := self.contract_floats(left, right, out)) is not None:
            nonzero = np.flatnonzero(floats.any(axis=2))
            return divmod(int(nonzero[0]), right.nrows) if len(nonzero) else None
        if self.is_dense() or self.field.degree > 1:
            rows = enumerate(block.first_nonzero_row() for block in self.contract(left, right, out))
            return next(((a, b) for a, b in rows if b is not None), None)
        entry = self._contract_sparse(left, right, out).first_entry()
        return None if entry is None else (entry[1] // out.ncols, entry[0])

    def changed(self, rows: Matrix, inverse: Matrix) -> StructureConstants:
        """The table in the basis given by rows (p, n) and functionals (n, p) that read coordinates in it.

        For an invertible matrix of rows these are its inverse. Fewer rows give a subalgebra or a quotient.
        """
        n, p = self.dimension, rows.nrows
        if isinstance(rows, FloatMatrix):
            brackets = self._contract_floats(rows, rows, inverse) if p else rows
            return StructureConstants.from_array(rows.field, brackets.array.reshape(p, p, p), brackets.error)
        if n and not self.is_dense() and self.field.degree == 1:
            product = self._contract_sparse(rows, rows, inverse)  # (b, a n + c)
            i, j, k = product.columns // p, product.rows, product.columns % p
            upper = i < j
            values = product.values[upper].tolist()
            return StructureConstants.from_integers(self.field, p, i[upper], j[upper], k[upper], values, product.den)
        return StructureConstants.from_blocks(self.field, p, self.contract(rows, rows, inverse))

    def _contract_sparse(self, left: Any, right: Any, out: Any) -> SparseInteger:
        """The contraction as one sparse matrix with rows b and columns a * r + c."""
        n, p, r = self.dimension, left.nrows, out.ncols
        first = self.sparse() @ SparseInteger.from_matrix(out)  # (i n + j, c)
        second = SparseInteger.from_matrix(left) @ first.reshape(n, n * r)  # (a, j r + c)
        return SparseInteger.from_matrix(right) @ second.regroup(p, n, r)  # regrouped: (j, a r + c)
