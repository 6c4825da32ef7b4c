"""Pieces: invariant subspaces over real number fields with their commuting matrices; isotypic pieces over the reals.

The centre of the commutant of a completely reducible V over K is a product of fields K_j = K[t]/(f_j).  A real root
alpha of f_j belongs to one isotypic component over R, ker(z - alpha) over K(alpha), a pair of complex roots to another,
ker(z^2 - p z + q) over K(p, q).  Its commutant is M_m(R), M_m(C) or M_m(H): C where the root is not real, else R
or H by the sign of the signature +-k of tr(x y) on k^2 dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, final

from liehom.errors import InternalError
from liehom.representations.analysis.submodules import restricted
from liehom.representations.invariants.irreducibility import evaluated
from liehom.representations.invariants.matrix_algebra import MatrixAlgebra
from liehom.scalars import ExactField, ExactMatrix
from liehom.scalars.roots.extension import Extension, RealFactor, real_factors, trivial_extension

CommutantType = Literal["R", "C", "H"]
"""What commutes with an irreducible representation: the reals, complex numbers or quaternions."""


@final
@dataclass(frozen=True, slots=True)
class Piece:
    """An invariant subspace over an extension of the base field.

    Attributes
    ----------
    extension : Extension
        The base field K in the field F of the piece.
    rows : Matrix
        A basis over F, shape (r, N).
    commuting : MatrixAlgebra
        What commutes with the action on the piece, in the coordinates of the rows (matrices (r, r) on columns).
    """

    extension: Extension
    rows: ExactMatrix
    commuting: MatrixAlgebra

    @property
    def field(self) -> ExactField:
        """The field F."""
        return self.extension.field

    @property
    def dimension(self) -> int:
        """The dimension r."""
        return int(self.rows.nrows)

    def over(self, extension: Extension) -> Piece:
        """The same piece over a larger field, given by an extension of F."""
        if extension.is_trivial:
            return self
        maps = [extension.matrix(t) for t in self.commuting.basis]
        algebra = MatrixAlgebra(extension.field, self.dimension, maps)
        return Piece(self.extension.then(extension), extension.matrix(self.rows), algebra)

    def part(self, rows: ExactMatrix) -> Piece:
        """The part spanned by rows (s, r) in the coordinates of the piece, where all that commutes preserves it."""
        maps = restricted(self.commuting.basis, rows)
        return Piece(self.extension, rows @ self.rows, MatrixAlgebra(self.field, rows.nrows, maps))

    def parts(self, blocks: Sequence[ExactMatrix]) -> list[Piece]:
        """The summands spanned by blocks of rows (s, r), together a basis; each with its corner of what commutes."""
        whole = self.field.stack_rows(blocks, self.dimension)
        inverse = whole.inverse()
        # in the new basis a matrix t has the block form whose diagonal blocks are the corners
        turned = [whole @ t.T @ inverse for t in self.commuting.basis]
        found, start = [], 0
        for block in blocks:
            places = range(start, start + block.nrows)
            corners = [t.select(rows=places, columns=places).T for t in turned]
            found.append(Piece(self.extension, block @ self.rows, MatrixAlgebra(self.field, block.nrows, corners)))
            start += block.nrows
        return found


@final
@dataclass(frozen=True, slots=True)
class IsotypicPiece:
    """An isotypic component over the reals: `multiplicity` copies of one irreducible representation of a `type`."""

    piece: Piece
    type: CommutantType
    multiplicity: int


def isotypic_pieces(field: ExactField, size: int, commuting: Sequence[ExactMatrix]) -> list[IsotypicPiece]:
    """The isotypic components over the reals of a completely reducible space, from what commutes with the action.

    Parameters
    ----------
    field : Field
    size : int
        At least 1.
    commuting : sequence of Matrix
        A basis of the commutant, matrices (N, N).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> J = QQ.matrix([[0, 2], [1, 0]])
    >>> [(p.piece.field, p.type, p.multiplicity) for p in isotypic_pieces(QQ, 2, [QQ.identity(2), J])]
    [(QQ(sqrt(2)), 'R', 1), (QQ(sqrt(2)), 'R', 1)]
    """
    whole = Piece(trivial_extension(field), field.identity(size), MatrixAlgebra(field, size, commuting))
    z, polynomial = whole.commuting.center().generator()
    found = []
    for f, _ in polynomial.factor():
        rows = evaluated(f, z).null_space().row_space() if f.degree < polynomial.degree else field.identity(size)
        part = whole.part(rows)
        central = restricted([z], rows)[0]
        found += [_over_the_reals(part, central, factor, f.degree) for factor in real_factors(f)]
    return found


def _over_the_reals(part: Piece, central: ExactMatrix, factor: RealFactor, degree: int) -> IsotypicPiece:
    """The component of one real factor of the minimal polynomial of a central element."""
    g = factor.polynomial
    piece = part.over(factor.extension)
    if g.degree < degree:
        piece = piece.part(evaluated(g, factor.extension.matrix(central)).null_space().row_space())
    k = _root(piece.commuting.dimension // g.degree)
    if g.degree == 2:
        return IsotypicPiece(piece, "C", k)
    if k % 2 or _trace_signature(piece.commuting) > 0:
        return IsotypicPiece(piece, "R", k)
    return IsotypicPiece(piece, "H", k // 2)


def _root(square: int) -> int:
    k = next(k for k in range(square + 1) if k * k >= square)
    if k * k != square:
        raise InternalError(f"a simple algebra over its centre has dimension {square}, which is no square")
    return k


def _trace_signature(algebra: MatrixAlgebra) -> int:
    """Positive minus negative squares of tr(x y)."""
    rows = [[(s @ t).trace() for t in algebra.basis] for s in algebra.basis]
    positive, negative, zero = algebra.field.matrix(rows, (len(rows), len(rows))).signature()
    if zero:
        raise InternalError("the trace form of a semisimple algebra is degenerate")
    return int(positive - negative)
