"""Subspace: a linear subspace of K^n, given by its canonical basis.

Over an exact field the basis is in reduced echelon form, so equal subspaces have equal bases. Over float64 it is
orthonormal. Vectors are rows.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.display import Displayed
from liehom.errors import ShapeError
from liehom.immutable import Immutable
from liehom.scalars.fields.exact_field import as_exact
from liehom.scalars.fields.field import Field, Matrix, MatrixLike, Scalar, rows_of
from liehom.typing import VectorLike

NEARLY_LONGEST = 0.999  # fraction of the longest vector from which the first index is taken


@final
class Subspace(Displayed, Immutable):
    """The span of rows in K^n, with a canonical basis.

    Parameters
    ----------
    field : Field
    rows : iterable of rows, or a matrix
        Spanning vectors, shape (k, n); they may be dependent.
    ambient : int
        The dimension n of the ambient space.

    Raises
    ------
    ShapeError
        If a row does not have length `ambient`.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> U = Subspace(QQ, [[1, 1, 0], [2, 2, 0]], 3)
    >>> U.dimension, [1, 0, 0] in U, (U + Subspace(QQ, [[0, 0, 1]], 3)).dimension
    (1, False, 2)
    """

    field: Field[Any]

    __slots__ = ("ambient", "basis", "field")

    def __init__(self, field: Field, rows: MatrixLike, ambient: int) -> None:
        matrix: Matrix = rows if isinstance(rows, Matrix) else _as_matrix(field, rows, ambient)
        if matrix.ncols != ambient:
            raise ShapeError(f"rows of length {matrix.ncols} in a space of dimension {ambient}")
        self.field = field
        self.ambient: int = ambient
        self.basis: Matrix = matrix.row_space()

    @property
    def dimension(self) -> int:
        """Dimension, an int."""
        return int(self.basis.nrows)

    def __contains__(self, vector: VectorLike) -> bool:
        row = self.field.matrix([vector])
        if row.ncols != self.ambient:
            raise ShapeError(f"a vector of length {row.ncols} in a space of dimension {self.ambient}")
        if not self.field.exact:
            return bool((row @ self.basis.null_space().T).is_zero())  # however short the vector is
        return int(self.field.stack_rows([self.basis, row], self.ambient).rank()) == self.dimension

    def includes(self, other: Subspace) -> bool:
        """Whether this subspace contains `other`."""
        return (self + other).dimension == self.dimension

    def __add__(self, other: Subspace) -> Subspace:
        return Subspace(self.field, self.field.stack_rows([self.basis, other.basis], self.ambient), self.ambient)

    def intersection(self, other: Subspace) -> Subspace:
        """The intersection of two subspaces."""
        return Subspace(self.field, self.annihilator_rows(other), self.ambient)

    def annihilator_rows(self, other: Subspace) -> Matrix:
        """Rows that span the intersection with `other`: the vectors on which the annihilator of `other` is 0."""
        functionals = other.basis.null_space()
        rows: Matrix = (functionals @ self.basis.T).null_space() @ self.basis
        return rows

    def annihilator(self) -> Subspace:
        """Subspace of the covectors, as rows, that vanish on the subspace."""
        return Subspace(self.field, self.basis.null_space(), self.ambient)

    def complement_indices(self) -> list[int]:
        """List of indices, increasing, of standard basis vectors that span a complement."""
        if self.field.exact:
            pivots = set(as_exact(self.basis).echelon()[1])
            return [j for j in range(self.ambient) if j not in pivots]
        # coordinates of the basis vectors on the orthogonal complement; the longest remaining part is next
        parts = self.basis.null_space().to_numpy()
        chosen: list[int] = []
        for _ in range(len(parts)):
            lengths = np.linalg.norm(parts, axis=0)
            j = int(np.flatnonzero(lengths >= NEARLY_LONGEST * lengths.max())[0])
            unit = parts[:, j] / lengths[j]
            parts = parts - np.outer(unit, unit @ parts)
            chosen.append(j)
        return sorted(chosen)

    def complement(self) -> Subspace:
        """The complement that is spanned by standard basis vectors (`complement_indices`)."""
        return Subspace(
            self.field, self.field.identity(self.ambient).select(rows=self.complement_indices()), self.ambient
        )

    def quotient_map(self) -> tuple[Matrix, Matrix]:
        """A complement W, shape (d, n), and Q, shape (n, d), where x Q are the coordinates of x mod U in W.

        U Q = 0 and W Q = 1.
        """
        indices = self.complement_indices()
        lift = self.field.identity(self.ambient).select(rows=indices)
        whole = self.field.stack_rows([lift, self.basis], self.ambient)
        return lift, whole.inverse().select(columns=range(len(indices)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Subspace) or self.ambient != other.ambient or self.dimension != other.dimension:
            return False
        if self.field.exact or other.field.exact:
            return bool(self.basis == other.basis)
        return self.includes(other)

    def __hash__(self) -> int:
        # over floats, equal subspaces have different bases
        return hash((self.ambient, self.basis if self.field.exact else self.dimension))

    def rows(self) -> list[list[Scalar]]:
        """List of the rows of the canonical basis, each a list of field elements."""
        rows: list[list[Scalar]] = self.basis.to_rows()
        return rows

    def __repr__(self) -> str:
        return f"<subspace of dimension {self.dimension} in {self.field.name}^{self.ambient}>"


def _as_matrix(field: Field, rows: MatrixLike, ambient: int) -> Matrix:
    table = rows_of(rows)
    for i, row in enumerate(table):
        if len(row) != ambient:
            raise ShapeError(f"row {i} has length {len(row)}, expected {ambient}")
    matrix: Matrix = field.matrix(table, (len(table), ambient))
    return matrix
