"""The linear system of Theorem 5 at a point with exact coordinates, over QQ or a number field.

    e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c in the field

Solvability is decided by a rank.  Of several solutions the one with the smallest |c| and, among those, the smallest
|zeta| is taken; if there is none, the system is solved in least squares.  No float is involved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.homogeneous.frames.inner_product import exact_gram_matrix
from liehom.representations import Representation
from liehom.scalars.fields.field import Matrix, Scalar
from liehom.typing import ObjectArray, ScalarLike, VectorLike


@final
@dataclass(frozen=True, slots=True)
class ExactSolution:
    """Solution of the linear system at one point.

    Attributes
    ----------
    solvable : bool
    zeta : array of shape (dim g,), of exact numbers
    c : number
    residual : array of shape (N,)
        r - (e rho(zeta) w_l - l c w_l), exactly 0 if the system is solvable.
    rank : int
        Rank of [rho(g_m) w_l, w_l].
    dimension : int
        Dimension of the orbit.
    """

    solvable: bool
    zeta: ObjectArray
    c: Scalar
    residual: ObjectArray
    rank: int
    dimension: int


def solve_exactly(
    representation: Representation,
    m: VectorLike,
    velocity: VectorLike,
    right: VectorLike,
    leading: int,
    factor: ScalarLike,
) -> ExactSolution:
    """`ExactSolution` of the linear system at one point.

    Parameters
    ----------
    representation : Representation
        Over an exact field.
    m, velocity, right : sequences of N numbers of the field
        The point, w_l and r.
    leading : int
        l.
    factor : number of the field
        e.

    Raises
    ------
    FieldError
        If a coordinate is not in the field.

    Examples
    --------
    >>> import liehom as lh
    >>> QQ = lh.QQ
    >>> rho, half = lh.defining(lh.so(3)), QQ.convert("1/2")
    >>> found = solve_exactly(rho, [0, 0, 1], [1, 0, 0], [QQ.convert("1/4"), half, 0], 1, half)
    >>> found.solvable, found.c, sorted(map(abs, found.zeta.tolist())), found.rank, found.dimension
    (True, -1/4, [0, 0, 1], 2, 2)
    """
    field, n = representation.field, representation.size
    isotropy = representation.isotropy(m)
    basis = isotropy.basis
    velocity_column, right_column = (field.matrix([list(x)], (1, n)).T for x in (velocity, right))
    images = [(representation(row) @ velocity_column).scale(factor).T for row in isotropy.rows()]
    moves = field.stack_rows(images, n).T if images else field.zeros(n, 0)
    full = field.stack_columns([moves, velocity_column.scale(field.convert(-leading))], n)
    rank, moved = full.rank(), moves.rank()
    solvable = field.stack_columns([full, right_column], n).rank() == rank
    # least squares: A^T A x = A^T r has solutions, all with the same A x
    both = full.solve(right_column) if solvable else (full.T @ full).solve(full.T @ right_column)
    reached = full @ both
    c = field.zero if moved == rank else both[both.nrows - 1, 0]
    target = reached + velocity_column.scale(c * leading)
    zeta = basis.T @ _least(moves, target, basis @ exact_gram_matrix(representation) @ basis.T)
    left = right_column - reached
    return ExactSolution(
        solvable,
        object_array([row[0] for row in zeta.to_rows()]),
        c,
        object_array([row[0] for row in left.to_rows()]),
        int(rank),
        representation.algebra.dimension - isotropy.dimension,
    )


def _least(moves: Matrix, target: Matrix, gram: Matrix) -> Matrix:
    """The y with moves y = target and the smallest y^T gram y, in the form y = gram^-1 moves^T u."""
    if moves.ncols == 0:
        found: Matrix = moves.T @ target
        return found
    turned = gram.solve(moves.T)
    found = turned @ (moves @ turned).solve(target)
    return found


def object_array(elements: Sequence[object] | ObjectArray) -> ObjectArray:
    """One-dimensional array of objects with these elements, into which numpy does not look.

    Examples
    --------
    >>> object_array([[1, 2], [3, 4]]).shape
    (2,)
    """
    made: ObjectArray = np.empty(len(elements), dtype=object)
    for i, element in enumerate(elements):
        made[i] = element
    return made
