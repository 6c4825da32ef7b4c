"""Where a matrix of linear forms loses rank on a line x + t y, over the complex numbers.

If M(y) has full row rank d, the determinant of (M(x) + t M(y)) T for a constant matrix T is, up to a factor, the
characteristic polynomial of -(M(y) T)^-1 M(x) T.  The roots of the greatest common divisor of a few of them contain all
t at which the rank is less than d.  At a root of an irreducible factor f the rank is computed over QQ(t) by its
companion matrix C: it is the rank of M(x) (x) 1 + M(y) (x) C over QQ divided by the degree of f.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import NamedTuple, cast

import flint

from liehom.errors import FieldError, InputError
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.rational import QQ
from liehom.scalars.spaces.linear_forms import LinearForms
from liehom.typing import ScalarLike

SAMPLES = 3


class RankLoss(NamedTuple):
    """Conjugate points x + t y of a line at which the rank is less than the number of rows d.

    Attributes
    ----------
    degree : int
        The number of points.
    rank : int
        The rank at each of them.
    transversal : bool
        Whether the direction y of the line is outside the column space there.
    """

    degree: int
    rank: int
    transversal: bool


def rank_losses_on_line(
    forms: LinearForms, start: Sequence[ScalarLike], direction: Sequence[ScalarLike]
) -> list[RankLoss]:
    """The points of a line x + t y over the complex numbers at which the rank is less than the number of rows.

    Parameters
    ----------
    forms : LinearForms
        Over QQ, with as many rows as variables.
    start, direction : sequences of numbers
        x and y; at y the matrix has full row rank.

    Raises
    ------
    FieldError
        Over a number field.
    InputError
        If the matrix does not have full row rank at `direction`.

    Examples
    --------
    >>> forms = LinearForms([QQ.matrix([[1, 0], [0, 1]]), QQ.matrix([[0, 1], [-1, 0]])])
    >>> rank_losses_on_line(forms, [0, 1], [1, 0])
    [RankLoss(degree=2, rank=1, transversal=True)]
    """
    if forms.field != QQ:
        raise FieldError(f"polynomials are factored over QQ only, not over {forms.field.name}")
    d = forms.shape[0]
    first, last = forms.at(start), forms.at(direction)
    if last.rank() < d:
        raise InputError(f"the matrix has rank {last.rank()} < {d} at the direction of the line")
    column = QQ.matrix([list(direction)]).T
    rng = random.Random(d)
    common = flint.fmpq_poly([0])
    for _ in range(SAMPLES):
        common = common.gcd(_minor(first, last, rng))
    losses = []
    for factor, _ in common.factor()[1]:
        e = factor.degree()
        companion = _companion(factor)
        at = _kronecker(first, QQ.identity(e)) + _kronecker(last, companion)
        rank = at.rank() // e
        if rank < d:
            more = QQ.stack_rows([at.T, _kronecker(column, QQ.identity(e)).T], d * e).rank() // e
            losses.append(RankLoss(e, rank, more == rank + 1))
    return losses


def _minor(first: ExactMatrix, last: ExactMatrix, rng: random.Random) -> flint.fmpq_poly:
    """det((M(x) + t M(y)) T) for a random constant T with det(M(y) T) != 0, divided by the leading coefficient."""
    d, m = last.shape
    while True:
        mix = QQ.matrix([[rng.randint(-2, 2) for _ in range(d)] for _ in range(m)])
        square = last @ mix
        if square.rank() == d:
            # -(M(y) T)^-1 M(x) T has the eigenvalues t
            coefficients = (-square.solve(first @ mix)).characteristic_coefficients()
            return flint.fmpq_poly(cast(list[flint.fmpq], coefficients))


def _companion(factor: flint.fmpq_poly) -> ExactMatrix:
    e = factor.degree()
    lead = flint.fmpq(factor[e])
    rows = [[flint.fmpq(int(i == j + 1)) for j in range(e - 1)] + [-flint.fmpq(factor[i]) / lead] for i in range(e)]
    made: ExactMatrix = QQ.matrix(rows)
    return made


def _kronecker(left: ExactMatrix, right: ExactMatrix) -> ExactMatrix:
    """The matrix whose (i, j) block is left[i, j] times the right matrix."""
    rows = [QQ.stack_rows([right.scale(c).T for c in row], right.nrows).T for row in left.to_rows()]
    made: ExactMatrix = QQ.stack_rows(rows, left.ncols * right.ncols)
    return made
