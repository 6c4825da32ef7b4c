"""Independence in R^n of rows over several real number fields, proved by rigorous enclosures."""

from __future__ import annotations

from collections.abc import Sequence

import flint

from liehom.errors import ShapeError
from liehom.scalars.fields.balls import working_precision
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.spaces.ball_matrices import ball_matrix

PRECISION_LIMIT = 1 << 14


def is_basis_of_reals(blocks: Sequence[ExactMatrix], n: int) -> bool:
    """Whether the rows of all blocks are a basis of R^n.

    Parameters
    ----------
    blocks : sequence of ExactMatrix
        Over any real number fields, with n columns.
    n : int

    Returns
    -------
    bool
        True is proved, because a ball around the determinant excludes 0. False means that the number of rows is not n,
        or that the determinant is 0 to 16384 bits.

    Examples
    --------
    >>> from liehom.scalars import QQ, number_field
    >>> K = number_field("sqrt(2)")
    >>> is_basis_of_reals([QQ.matrix([[1, 1]]), K.matrix([["sqrt(2)", 1]])], 2)
    True
    """
    if any(b.ncols != n for b in blocks):
        raise ShapeError(f"rows of length {[b.ncols for b in blocks]} in R^{n}")
    if sum(b.nrows for b in blocks) != n:
        return False
    precision = 128
    while precision <= PRECISION_LIMIT:
        with working_precision(precision):
            table = [row for block in blocks for row in ball_matrix(block, precision).tolist()]
            if not table or not flint.arb_mat(table).det().contains(0):
                return True
        precision *= 2
    return False
