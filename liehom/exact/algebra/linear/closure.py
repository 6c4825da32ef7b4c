"""From matrices to an abstract Lie algebra: independence, closure under commutators, structure constants.

Coordinates in the span of d matrices are read from d entries that determine them. Over an exact field residues modulo
a prime give the dimension and the matrices to append, and the exact bracket table proves closure.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import lcm
from typing import Any, Literal, final

import numpy as np

from liehom.base.errors import DependentRowsError, FieldError, InputError, NotClosedError, ShapeError, displayed
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import independent_rows
from liehom.exact.algebra.core.tables import field_of_values
from liehom.exact.algebra.linear.complex_matrices import as_real_matrices
from liehom.exact.algebra.linear.generated_span import (
    GeneratedSpan,
    commutator_pairs,
    entries_of,
    exclusive_entries,
    float_closure,
    generated_span,
    spanning_commutators,
    sparse_commutator_table,
)
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field, MatricesLike, Matrix, MatrixLike, rows_of
from liehom.exact.scalars.floating import FloatField
from liehom.exact.scalars.rational import QQ

LARGEST_COORDINATES = 3000  # dimension times bits of the largest entry up to which commutators complete a basis
Completion = Literal["auto", "commutators", "reduced"]


@final
@dataclass(frozen=True, slots=True)
class Closure:
    """The Lie algebra that matrices generate.

    Attributes
    ----------
    algebra : LieAlgebra
    matrices : tuple of Matrix
        The basis of the algebra: the generators in order, then the appended ones.
    kept : tuple of int
        Indices of the generators that were kept (all, unless dependent ones were dropped).
    appended : tuple of (int, int)
        The commutators [i, j] of basis elements that were appended, in order; empty if the basis is completed by
        reduced matrices. Over floats the part of the commutator orthogonal to the matrices before it is appended, with
        the geometric mean of the norms of the generators as its norm.
    """

    algebra: LieAlgebra
    matrices: tuple[Matrix, ...]
    kept: tuple[int, ...]
    appended: tuple[tuple[int, int], ...]


def square_matrices(matrices: Iterable[MatrixLike], field: Field | None = None) -> list[Any]:
    """A list of `Matrix` over a common field from square arrays of one size."""
    if not hasattr(matrices, "__iter__") or isinstance(matrices, str):
        raise InputError(f"a list of square matrices was expected, got {displayed(matrices)}")
    square: list[Any] = list(matrices)
    if square and all(hasattr(a, "nrows") for a in square):
        over = field or square[0].field
        for i, a in enumerate(square):
            if a.field != over:
                raise FieldError(f"matrix {i} is over {a.field.name}, not over {over.name}; use over()")
    elif square and all(_is_integer_square(a) for a in square) and (field is None or isinstance(field, ExactField)):
        square = [(field or QQ).from_integers(a.ravel().tolist(), len(a), len(a)) for a in square]
    else:
        tables = [a.to_rows() if hasattr(a, "nrows") else rows_of(a) for a in square]
        over = field or field_of_values(x for table in tables for row in table for x in row)
        for i, rows in enumerate(tables):
            if any(len(row) != len(rows) for row in rows):
                raise ShapeError(f"matrix {i} is not square: {len(rows)} rows of lengths {[len(r) for r in rows]}")
            square[i] = over.matrix(rows, (len(rows), len(rows)))
    for i, a in enumerate(square):
        if a.shape != square[0].shape or a.nrows != a.ncols:
            raise ShapeError(
                f"matrix {i} has shape {a.shape}, expected the square shape of matrix 0, {square[0].shape}"
            )
    return square


def acting_matrices(
    algebra: LieAlgebra, matrices: MatricesLike, size: int | None, hint: str
) -> tuple[tuple[Matrix, ...], int]:
    """One square matrix for each basis element, and their size; `ShapeError` with the hint if it is not known."""
    square = square_matrices(matrices, algebra.field)
    if len(square) != algebra.dimension:
        raise ShapeError(f"{len(square)} matrices for an algebra of dimension {algebra.dimension}")
    if not square and size is None:
        raise ShapeError(f"the zero algebra acts on a space of any size: {hint}")
    return tuple(square), int(square[0].nrows) if square else int(size or 0)


def _is_integer_square(a: object) -> bool:
    return isinstance(a, np.ndarray) and a.dtype.kind == "i" and a.ndim == 2 and a.shape[0] == a.shape[1]


def lie_closure(
    matrices: Iterable[MatrixLike],
    *,
    field: Field | None = None,
    independent: bool = False,
    close: bool = True,
    limit: int | None = None,
    name: str | None = None,
    completion: Completion = "auto",
) -> Closure:
    """The Lie algebra generated by matrices under the commutator.

    Parameters
    ----------
    matrices : sequence of (N, N) array_like
        Complex matrices of size n become real matrices of size N = 2n, see `complex_matrices`.
    field : Field, optional
        By default the smallest field that contains the entries.
    independent : bool
        Drop matrices that depend on earlier ones. By default they raise `DependentRowsError`.
    close : bool
        Append missing commutators (default). Otherwise they raise `NotClosedError`.
    limit : int, optional
        Largest dimension; `NotClosedError` beyond it (default N*N, which is never exceeded).
    name : str, optional
    completion : {'auto', 'commutators', 'reduced'}
        The matrices that are appended: missing commutators in lexicographic order of (i, j), or matrices of the
        reduced echelon basis of the generated span (over QQ only). 'auto' means commutators, unless the dimension
        times the bits of the largest entry exceeds 3000.

    Raises
    ------
    NotClosedError
        If they do not span a Lie algebra and `close` is False, or generate more than `limit` dimensions.
    UndecidedError
        Over floats, if the dimension hangs on a residual near the tolerance, which the message names, or the norms of
        the matrices differ by more than a factor of 100.

    Notes
    -----
    Over floats no answer depends on the scale of the matrices, and a wrong dimension is not returned for data within
    the tolerance of the field. A smaller tolerance, ``field=lh.FloatField(1e-14)``, decides more if the data are
    accurate.

    Examples
    --------
    >>> closure = lie_closure([[[0, 1], [0, 0]], [[0, 0], [1, 0]]])
    >>> closure.algebra.dimension, closure.appended
    (3, ((0, 1),))
    """
    basis = square_matrices(as_real_matrices(matrices, field)[0], field)
    if not basis:
        raise InputError("no matrices were given; the size of the space would be unknown")
    if completion not in ("auto", "commutators", "reduced"):
        raise InputError(f"completion is 'auto', 'commutators' or 'reduced', got {displayed(completion)}")
    over = basis[0].field
    if isinstance(over, FloatField):
        _require_rational(completion, over)
        numerical = float_closure(basis, independent=independent, close=close, limit=limit)
        # Commutators of matrices satisfy the Jacobi identity.
        return Closure(LieAlgebra(numerical[0], name=name, check=False), *numerical[1:])
    kept = _independent(basis, independent)
    basis = [basis[i] for i in kept]
    if not basis:
        return Closure(LieAlgebra(StructureConstants(over, 0, []), name=name, check=False), (), kept, ())
    _require_rational(completion, over)
    basis, appended, table = _completed(basis, completion, limit) if close else (basis, [], None)
    if table is None:
        span = _Span(basis)
        while isinstance(brackets := span.commutators(), tuple):
            if not close:
                a, b = brackets
                raise NotClosedError(brackets, f"the commutator of matrices {a} and {b} is not in their span")
            if limit is not None and len(span.basis) >= limit:
                raise NotClosedError(brackets, f"the matrices generate more than {limit} dimensions")
            pairs = span.appendable()
            appended += pairs
            span = _Span(span.basis + [span.basis[i] @ span.basis[j] - span.basis[j] @ span.basis[i] for i, j in pairs])
        basis, table = span.basis, brackets
    # Commutators of matrices satisfy the Jacobi identity.
    return Closure(LieAlgebra(table, name=name, check=False), tuple(basis), kept, tuple(appended))


def _require_rational(completion: Completion, field: Field) -> None:
    if completion == "reduced" and field != QQ:
        raise InputError(f"a basis is completed by reduced matrices over QQ only, not over {field.name}")


def _completed(
    basis: list[ExactMatrix], completion: Completion, limit: int | None
) -> tuple[list[ExactMatrix], list[tuple[int, int]], StructureConstants | None]:
    """The completed basis, the commutators that were appended, and the bracket table if it is a by-product."""
    dimension = len(spanning_commutators(basis))
    if dimension == len(basis):
        return basis, [], None
    pairs = commutator_pairs(basis, dimension) if completion != "reduced" else []
    if limit is not None and dimension > limit:
        first = (pairs or commutator_pairs(basis, dimension))[max(limit - len(basis), 0)]
        raise NotClosedError(first, f"the matrices generate more than {limit} dimensions")
    grown = list(basis)
    for i, j in pairs:
        grown.append(grown[i] @ grown[j] - grown[j] @ grown[i])
    rational, reduced = basis[0].field.degree == 1, completion == "reduced"
    small = completion == "commutators" or len(grown) * _bits(grown) <= LARGEST_COORDINATES
    span = generated_span(basis) if rational and (reduced or not small or not _is_sparse(grown)) else None
    if span is None or len(span.pivots) != dimension:
        return grown, pairs, None
    if not reduced and small:
        return grown, pairs, _proved_table(grown, span)
    coordinates = span.coordinates(basis)
    rest = sorted(set(range(dimension)) - set(coordinates.echelon()[1]))
    units = coordinates.field.identity(dimension).select(rows=rest)
    change = coordinates.field.stack_rows([coordinates, units], dimension)
    n = basis[0].nrows
    matrices = [*basis, *span.rows.select(rows=rest).split_rows(n, n)]
    return matrices, [], span.table.changed(change, change.inverse())


def _proved_table(basis: list[ExactMatrix], generated: GeneratedSpan) -> StructureConstants:
    """The bracket table of a basis of a span that is known to be closed, as numerators over one determinant."""
    span, d = _Span(basis), len(basis)
    inverse = generated.coordinates(basis).inverse()
    # over one denominator for all rows: the entries are large, and reducing each of them would cost most of the time
    den = lcm(*(a.den for a in basis)) ** 2
    entries: dict[tuple[int, int, int], int] = {}
    for i in range(d - 1):
        rows = span.products(i).select(columns=generated.pivots)
        integers = (rows.scale(den).cleared() @ inverse.cleared()).parts[0].entries()
        entries |= {(i, i + 1 + x // d, x % d): int(v) for x, v in enumerate(integers) if v}
    index = np.array(list(entries), dtype=np.int64).reshape(len(entries), 3)
    columns = (index[:, 0], index[:, 1], index[:, 2])
    return StructureConstants.from_integers(span.field, d, *columns, list(entries.values()), den * inverse.den)


def _bits(matrices: list[ExactMatrix]) -> int:
    """The number of bits of the largest numerator of matrices over an exact field."""
    return max(int(abs(x)).bit_length() for a in matrices for part in a.parts for x in part.entries())


def _independent(basis: list[Any], drop: bool) -> tuple[int, ...]:
    """Indices of matrices that are a basis of their span; `DependentRowsError` if `drop` is False and some are not."""
    every = tuple(range(len(basis)))
    if _exclusive_entries(basis) is not None:
        return every
    flat = _Span(basis).flat
    rank = flat.rank()
    if rank == len(basis):
        return every
    kept = independent_rows(flat)
    if not drop:
        raise DependentRowsError(rank, sorted(set(every) - set(kept)), "matrices")
    return tuple(kept)


def _exclusive_entries(basis: list[Any]) -> list[int] | None:
    """For each matrix over QQ a flat index where it alone is not zero, which shows independence, or None."""
    rational = basis[0].field.degree == 1
    return exclusive_entries([entries_of(a) for a in basis], basis[0].nrows) if rational else None


def _is_sparse(basis: list[Any]) -> bool:
    """Whether matrices over QQ have so few non-zero entries that products by dictionaries are faster."""
    n = basis[0].nrows
    filled = sum(1 for a in basis for x in a.parts[0].entries() if x)
    return bool(filled <= len(basis) * max(2 * n, n * n // 6))


class _Span:
    """The span of independent matrices, with coordinates read from entries that determine them."""

    def __init__(self, basis: list[Any]) -> None:
        self.basis, self.field, self.size = basis, basis[0].field, basis[0].nrows ** 2

    @cached_property
    def flat(self) -> Any:
        """The matrix (d, N*N) whose rows are the flattened matrices."""
        return self.field.stack_rows([a.reshape(1, self.size) for a in self.basis], self.size)

    @cached_property
    def _determined(self) -> tuple[list[int], Any]:
        """Flat indices of entries that determine an element of the span, and the inverse of the basis there."""
        positions = self.flat.echelon()[1]
        return positions, self.flat.select(columns=positions).inverse()

    def products(self, i: int) -> Any:
        """The commutators [A_i, A_j] for all j > i, as flattened rows."""
        later, n = self.basis[i + 1 :], self.basis[0].nrows
        left = (self.basis[i] @ self.field.stack_columns(later, n)).reshape(n * len(later), n)
        order = [a * len(later) + j for j in range(len(later)) for a in range(n)]
        return (left.select(rows=order) - self.field.stack_rows(later, n) @ self.basis[i]).reshape(len(later), n * n)

    def commutators(self) -> StructureConstants | tuple[int, int]:
        """The bracket table, or the first pair of matrices whose commutator is not in the span."""
        if self.field.degree == 1 and _is_sparse(self.basis):
            exclusive = _exclusive_entries(self.basis) is not None
            return sparse_commutator_table(self.basis, *((None, None) if exclusive else self._determined))
        entries, d, zero = [], len(self.basis), self.field.zero
        for i in range(d - 1):
            rows, (positions, inverse) = self.products(i), self._determined
            coordinates = rows.select(columns=positions) @ inverse
            j = (rows - coordinates @ self.flat).first_nonzero_row()
            if j is not None:
                return i, i + 1 + j
            entries += [(i, i + 1 + x // d, x % d, v) for x, v in enumerate(coordinates.entries()) if v != zero]
        return StructureConstants(self.field, d, entries)

    def appendable(self) -> list[tuple[int, int]]:
        """Pairs (i, j), lexicographic, whose commutators extend the span, each independent of the earlier ones."""
        d = len(self.basis)
        pairs = list(combinations(range(d), 2))
        table = self.field.stack_rows([self.flat] + [self.products(i) for i in range(d - 1)], self.size)
        return [pairs[i - d] for i in table.T.echelon()[1] if i >= d]
