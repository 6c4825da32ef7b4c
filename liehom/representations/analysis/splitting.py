"""Splitting of an isotypic piece by zero divisors of M_m(R), M_m(C), M_m(H), over the field where possible.

A commuting matrix t whose characteristic polynomial has two factors, or which is not semisimple, splits the piece over
its field F.  Small elements are tried first (for a maximal order of M_m(Q) the shortest element is a zero divisor).
For a quaternion algebra over QQ a conic decides.  If nothing splits over F, a real root of one t is adjoined, or a pair
of complex roots.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import final

from liehom.errors import InternalError
from liehom.representations.analysis.commutant_type import COMMUTANT_DIMENSIONS, CommutantType
from liehom.representations.analysis.isotypic import IsotypicPiece, Piece, exact_square_root
from liehom.representations.invariants.irreducibility import anticommutator_gram, combination, evaluated, traceless
from liehom.scalars import ExactMatrix, Polynomial
from liehom.scalars.lattices.conic import rational_zero
from liehom.scalars.roots.extension import real_factors
from liehom.scalars.spaces.forms import orthogonal_basis

CANDIDATES = 40  # commuting matrices that are tried, beyond twice the dimension of the commutant


@final
@dataclass(frozen=True, slots=True)
class _Root:
    """A matrix whose minimal polynomial is irreducible over the field, and the degree of the extension to adjoin."""

    cost: int
    matrix: ExactMatrix
    polynomial: Polynomial


def irreducible_pieces(component: IsotypicPiece) -> list[Piece]:
    """The irreducible pieces over the reals of an isotypic component, as many as its multiplicity."""
    waiting, found = [component.piece], []
    while waiting:
        piece = waiting.pop(0)
        count = _multiplicity(piece, component.type)
        if count == 1:
            found.append(piece)
        else:
            waiting = [*_split(piece, component.type), *waiting]
    if len(found) != component.multiplicity:
        raise InternalError(f"{len(found)} irreducible pieces in a component of multiplicity {component.multiplicity}")
    return found


def _multiplicity(piece: Piece, kind: CommutantType) -> int:
    return exact_square_root(piece.commuting.dimension // COMMUTANT_DIMENSIONS[kind])


def _split(piece: Piece, kind: CommutantType) -> list[Piece]:
    """Two or more summands of a piece, over its field if they are found there."""
    roots: list[_Root] = []
    for element in islice(_tried(piece, kind), CANDIDATES + 2 * piece.commuting.dimension):
        found = _split_by(piece, element, roots)
        if found:
            return found
    zero = _nilpotent(piece, kind)
    if zero is not None:
        return _split_by(piece, zero, roots)
    extra = [] if roots else _indefinite(piece)
    for element in extra:
        found = _split_by(piece, element, roots)
        if found:
            return found
    if not roots:
        raise InternalError("no commuting matrix splits a reducible piece")
    return _split_above(piece, min(roots, key=lambda root: root.cost))


def _tried(piece: Piece, kind: CommutantType) -> Iterator[ExactMatrix]:
    """Candidates t: commuting matrices, small ones first, and for type C their products with the complex structure."""
    structure = None
    if kind == "C":
        center = piece.commuting.center()
        structure = next(z for z in center.basis if z != piece.field.identity(piece.dimension).scale(z[0, 0]))
    for t in piece.commuting.elements():
        yield t
        if structure is not None:
            yield t @ structure


def _split_by(piece: Piece, t: ExactMatrix, roots: list[_Root]) -> list[Piece]:
    """The summands given by t over the field, or an empty list and perhaps a further entry of `roots`."""
    factors = piece.commuting.minimal_polynomial_power(t).factor()
    if len(factors) > 1:
        size = piece.dimension
        kernels = [_power(evaluated(f, t), size).null_space().row_space() for f, _ in factors]
        return piece.parts(kernels)
    f = factors[0][0]
    value = evaluated(f, t)
    if not value.is_zero():
        return piece.parts(_with_complement(piece, value.null_space().row_space()))
    real = f.count_real_roots()
    if f.degree > 1 and real:
        roots.append(_Root(f.degree, t, f))
    elif f.degree > 2:
        roots.append(_Root(f.degree * (f.degree - 1) // 2 + 1, t, f))
    return []


def _power(matrix: ExactMatrix, size: int) -> ExactMatrix:
    """A power of the matrix whose kernel is the kernel of all higher powers."""
    exponent = 1
    while exponent < size:
        matrix, exponent = matrix @ matrix, 2 * exponent
    return matrix


def _with_complement(piece: Piece, rows: ExactMatrix) -> list[ExactMatrix]:
    """The rows and an invariant complement of their span, the kernel of a commuting projection onto the span."""
    field, size = piece.field, piece.dimension
    away = rows.null_space().T  # its left kernel is the span
    conditions = [
        field.stack_columns([(t.T @ away).reshape(1, size * away.ncols), (rows @ t.T).reshape(1, rows.nrows * size)], 1)
        for t in piece.commuting.basis
    ]
    width = size * away.ncols + rows.nrows * size
    target = field.stack_columns([field.zeros(1, size * away.ncols), rows.reshape(1, rows.nrows * size)], 1)
    weights = field.stack_rows(conditions, width).T.solve(target.T)
    projection = piece.commuting.element(weights.entries())
    return [rows, projection.null_space().row_space()]


def _nilpotent(piece: Piece, kind: CommutantType) -> ExactMatrix | None:
    """An element of square 0 in a quaternion algebra over QQ that has one (M_2(QQ)), or None."""
    if kind != "R" or piece.commuting.dimension != 4 or piece.field.degree > 1:
        return None
    imaginary = traceless(piece.commuting.basis, piece.dimension, piece.field)
    gram = anticommutator_gram(imaginary, piece.dimension, piece.field)
    if gram is None:
        raise InternalError("the traceless part of a quaternion algebra has an anticommutator that is not a scalar")
    row = rational_zero(gram)
    return None if row is None else combination(imaginary, row.row(0))


def _indefinite(piece: Piece) -> list[ExactMatrix]:
    """Elements of positive square, where all small elements generate copies of C."""
    imaginary = traceless(piece.commuting.basis, piece.dimension, piece.field)
    gram = anticommutator_gram(imaginary, piece.dimension, piece.field)
    if gram is None:
        return []
    rows, values = orthogonal_basis(gram)
    return [
        combination(imaginary, row.row(0))
        for row, value in zip(rows, values, strict=True)
        if piece.field.sign(value) >= 0
    ]


def _split_above(piece: Piece, root: _Root) -> list[Piece]:
    """The summands over a larger field: the kernels of a factor and of its cofactor."""
    factor = real_factors(root.polynomial)[0]
    whole = piece.over(factor.extension)
    t = factor.extension.matrix(root.matrix)
    cofactor = factor.extension.polynomial(root.polynomial) // factor.polynomial
    return whole.parts([evaluated(g, t).null_space().row_space() for g in (factor.polynomial, cofactor)])
