"""Subspaces of K^n, coordinates on quotients, integral bases and orthogonal bases."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, final, overload

import flint
import numpy as np

from liehom.base.budget import within
from liehom.base.errors import ShapeError
from liehom.base.objects import Displayed, Immutable
from liehom.base.typing import VectorLike
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Field, M, Matrix, MatrixLike, Scalar, rows_of
from liehom.exact.scalars.floating import FloatMatrix
from liehom.exact.scalars.sparse import matrix_from_entries

# Over an exact field the canonical basis of a subspace is in reduced echelon form, so equal subspaces have equal bases.
# Over float64 it is orthonormal. Vectors are rows.

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

    Examples
    --------
    >>> from liehom.exact.scalars import QQ
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
        return (other.basis.null_space() @ self.basis.T).null_space() @ self.basis

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
        inverse = self.field.stack_rows([lift, self.basis], self.ambient).inverse()
        return lift, inverse.select(columns=range(len(indices)))

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
        return self.basis.to_rows()

    def __repr__(self) -> str:
        return f"<subspace of dimension {self.dimension} in {self.field.name}^{self.ambient}>"


def _as_matrix(field: Field, rows: MatrixLike, ambient: int) -> Matrix:
    table = rows_of(rows)
    for i, row in enumerate(table):
        if len(row) != ambient:
            raise ShapeError(f"row {i} has length {len(row)}, expected {ambient}")
    return field.matrix(table, (len(table), ambient))


# Quotients K^n / U with small numbers: over QQ, an echelon basis of a subspace in general position has huge entries. In
# that case the lattice of integer covectors that vanish on U is LLL-reduced together with a completion to a basis of
# Z^n. Its first d members are the coordinate functions, and the dual basis gives a complement and a basis of U.

MAX_SMALL_BITS = 5  # of numbers for which no reduction is tried
MAX_LATTICE_DIMENSION = 130  # up to which the lattice of covectors is reduced


@final
@dataclass(frozen=True, slots=True)
class Quotient(Generic[M]):
    """A basis of U, a complement of U, and the coordinates of the quotient in it."""

    subspace: M  # rows (k, n), a basis of U
    lift: M  # rows (d, n), a complement W of U
    projection: M  # (n, d), with U Q = 0 and W Q = 1: x Q are the coordinates of x mod U


@overload
def quotient(basis: ExactMatrix) -> Quotient[ExactMatrix]: ...
@overload
def quotient(basis: Matrix) -> Quotient[Matrix]: ...


def quotient(basis: Matrix) -> Quotient[ExactMatrix] | Quotient[FloatMatrix]:
    """`Quotient` with coordinates on K^n modulo the span of independent rows."""
    if isinstance(basis, FloatMatrix):
        across = basis.null_space()
        return Quotient(basis.row_space(), across, across.T)
    if not isinstance(basis, ExactMatrix):
        raise TypeError(f"no quotient over {basis.field}")
    reduced, pivots = basis.echelon()
    n = basis.ncols
    if basis.field.degree == 1 and 0 < basis.nrows < n <= MAX_LATTICE_DIMENSION and not _is_small(reduced):
        return _by_lattice(basis)
    return _from_echelon(reduced, pivots)


def echelon_quotient(basis: ExactMatrix) -> Quotient[ExactMatrix]:
    """`Quotient` by the echelon basis, whose complement consists of unit vectors: faster, with larger numbers."""
    return _from_echelon(*basis.echelon())


def _from_echelon(reduced: ExactMatrix, pivots: list[int]) -> Quotient[ExactMatrix]:
    n, chosen = reduced.ncols, set(pivots)
    free = [j for j in range(n) if j not in chosen]
    within("memory", 2 * 8 * n * len(free), "the coordinates on the quotient need {} bytes")
    field, d = reduced.field, len(free)
    units = [{f * n + j: int(s == 0) for f, j in enumerate(free)} for s in range(field.degree)]
    lift = matrix_from_entries(field, units, d, n)
    # row f of the projection is a unit vector for a free column f, row p minus the free part of its echelon row
    tables: list[dict[int, int | flint.fmpz]] = [
        {p * d + f: -x for i, p in enumerate(pivots) for f, j in enumerate(free) if (x := part[i, j])}
        for part in reduced.parts
    ]
    tables[0] |= {j * d + f: reduced.den for f, j in enumerate(free)}
    return Quotient(reduced, lift, matrix_from_entries(field, tables, n, d, reduced.den))


def _is_small(matrix: ExactMatrix) -> bool:
    bound = 1 << MAX_SMALL_BITS
    return matrix.den < bound and all(-bound < x < bound for x in matrix.parts[0].entries())


def _by_lattice(basis: ExactMatrix) -> Quotient[ExactMatrix]:
    n, k, field = basis.ncols, basis.nrows, basis.field
    rows = basis.parts[0].entries()
    bits, d = 10, n - k
    while True:
        table = [int(i == j) if j < n else rows[(j - n) * n + i] << bits for i in range(n) for j in range(n + k)]
        reduced = flint.fmpz_mat(n, n + k, table).lll().tolist()
        if all(x == 0 for row in reduced[:d] for x in row[n:]):
            break
        bits *= 2
    unimodular = flint.fmpz_mat([row[:n] for row in reduced])
    dual, sign = flint.fmpq_mat(unimodular).inv().numer_denom()
    # the matrix is unimodular, so its inverse is integral, with the dual basis as columns
    basis = ExactMatrix(field, (dual.transpose(),), int(sign)).normalized()
    functions = ExactMatrix(field, (unimodular,), 1).select(rows=range(d)).T
    return Quotient(basis.select(rows=range(d, n)), basis.select(rows=range(d)), functions)


# Integral bases: echelon bases of subspaces in general position have large entries, and clearing denominators leaves a
# sublattice of large index. With the echelon form (1 | R / d), the integer vectors are x (1 | R / d) for x in Z^k with
# x R = 0 mod d. These x form the dual of the lattice that Z^k and the columns of R / d generate.

SHORT_BITS = 64  # entries of an echelon basis that is kept


def integral_basis(rows: ExactMatrix) -> ExactMatrix:
    """An LLL-reduced basis of the integer vectors in the span of rows over QQ; over QQ(a) an echelon basis."""
    reduced, pivots = rows.echelon()
    if rows.field.degree > 1 or not pivots:
        return reduced
    integers = reduced.parts[0]
    if reduced.den > 1:
        chosen = set(pivots)
        free = [j for j in range(rows.ncols) if j not in chosen]
        integers = _coordinates(reduced.select(columns=free).parts[0], reduced.den) * integers
        integers = (flint.fmpq_mat(integers) / reduced.den).numer_denom()[0]
    return ExactMatrix(rows.field, (integers.lll(),), 1)


def short_basis(rows: ExactMatrix) -> ExactMatrix:
    """The reduced echelon basis of a row space if its entries have at most 64 bits, else `integral_basis`."""
    reduced = rows.row_space()
    bits = max((int(abs(x)).bit_length() for part in reduced.parts for x in part.entries()), default=0)
    return reduced if max(bits, reduced.den.bit_length()) <= SHORT_BITS else integral_basis(reduced)


def _coordinates(table: flint.fmpz_mat, den: int) -> flint.fmpz_mat:
    """Basis (k, k) of the lattice of x in Z^k with x R = 0 modulo den."""
    k, columns = table.nrows(), table.transpose().tolist()
    lattice: list[Any] = [[den * int(i == j) for j in range(k)] for i in range(k)]
    width = max(2 * k, 8)
    batch = columns[:width]
    while True:
        lattice = flint.fmpz_mat([*lattice, *batch]).hnf().tolist()[:k]
        # the lattice contains den Z^k, so that den times the inverse is integral
        dual = (flint.fmpq_mat(flint.fmpz_mat(lattice)).inv() * den).numer_denom()[0].transpose()
        products = (dual * table).entries()
        m = len(columns)
        missed = sorted({x % m for x, v in enumerate(products) if v % den})
        if not missed:
            return dual
        batch = [columns[j] for j in missed[:width]]


def orthogonal_basis(form: ExactMatrix) -> tuple[list[ExactMatrix], list[Scalar]]:
    """An orthogonal basis: rows u_i with form(u_i, u_j) = 0, and the values form(u_i, u_i), by exact Gram-Schmidt."""
    field, d = form.field, form.nrows
    rest = [field.unit(d, i) for i in range(d)]
    rows: list[ExactMatrix] = []
    values: list[Scalar] = []
    while rest:
        images = [r @ form for r in rest]
        norms = [(m @ r.T)[0, 0] for m, r in zip(images, rest, strict=True)]
        place = next((i for i, v in enumerate(norms) if v != 0), None)
        if place is None:
            places = ((i, j) for i in range(len(rest)) for j in range(i))
            pair = next(((i, j) for i, j in places if (images[i] @ rest[j].T)[0, 0] != 0), None)
            if pair is None:
                return rows + rest, values + [field.zero] * len(rest)
            rest[pair[0]] = rest[pair[0]] + rest[pair[1]]
            continue
        chosen, image, norm = rest.pop(place), images.pop(place), norms[place]
        rows.append(chosen)
        values.append(norm)
        rest = [r - chosen.scale((image @ r.T)[0, 0] / norm) for r in rest]
    return rows, values
