"""Isotropy subalgebras and orbit dimensions of points under the matrices of a representation."""

from __future__ import annotations

from collections.abc import Sequence

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.errors import InputError, ShapeError
from liehom.scalars import FloatMatrix, Matrix
from liehom.typing import VectorLike


def moved_point(algebra: LieAlgebra, matrices: Sequence[Matrix], size: int, point: VectorLike) -> Matrix:
    """The matrix (dim g, N) with rows rho(e_i) point.

    Raises
    ------
    ShapeError
        If the point does not have N coordinates.
    InputError
        If a coordinate has free symbols.
    FieldError
        If a coordinate is not in the field.
    """
    values = list(point)
    if len(values) != size:
        raise ShapeError(f"the point has {len(values)} coordinates, the representation acts on {size}")
    symbols = sorted({str(s) for v in values for s in getattr(v, "free_symbols", ())})
    if symbols:
        raise InputError(f"the point has the free symbols {', '.join(symbols)}; use Representation.symbolic_isotropy")
    column = algebra.field.matrix([values], (1, size)).T
    rows = [(a @ column).T for a in matrices]
    moved: Matrix = algebra.field.stack_rows(rows, size) if rows else algebra.field.zeros(0, size)
    return moved


def stabilizer(algebra: LieAlgebra, matrices: Sequence[Matrix], size: int, point: VectorLike) -> Subalgebra:
    """The subalgebra {x : rho(x) point = 0}."""
    moved = moved_point(algebra, matrices, size, point)
    _require_clear(moved, "the isotropy at the point")
    rows = moved.left_null_space()
    return Subalgebra(algebra, rows, check=False)  # closed: rho([x, y]) p = rho(x) rho(y) p - rho(y) rho(x) p = 0


def orbit_dimension(algebra: LieAlgebra, matrices: Sequence[Matrix], size: int, point: VectorLike) -> int:
    """Dimension of the orbit of a point: the rank of x -> rho(x) point."""
    moved = moved_point(algebra, matrices, size, point)
    _require_clear(moved, "the orbit dimension of the point")
    return int(moved.rank())


def _require_clear(moved: Matrix, question: str) -> None:
    """Over floats, raise `UndecidedError` if a singular value is within a factor 100 of the error."""
    if isinstance(moved, FloatMatrix):
        moved.rank_decision().require_clear(question)
