"""A few matrices of a representation that generate all of them: what commutes with these commutes with all.

Random elements of the algebra generate it if the least space that holds them and is closed under their brackets is
everything, which a rank modulo a prime proves.
"""

from __future__ import annotations

import random
from typing import cast

from liehom.representations.core.representation import Representation
from liehom.scalars import ExactMatrix
from liehom.scalars.modular.modular import invariant_hull_rank

SMALL = 20_000
MOST = 4


def generating_matrices(rho: Representation, size: int | None = None) -> tuple[ExactMatrix, ...]:
    """Matrices with the same commutant, invariant forms, vectors and subspaces as all rho(x).

    Parameters
    ----------
    rho : Representation
        Over an exact field.
    size : int, optional
        Decide as for a representation of this size: with one size, representations of one algebra are given by
        matrices of the same elements.

    Returns
    -------
    tuple of Matrix
        All matrices of the basis where they are few and small, or where two to four random elements do not generate;
        else those of such elements.

    Examples
    --------
    >>> import liehom as lh
    >>> len(generating_matrices(lh.defining(lh.so(3)))), len(generating_matrices(lh.sym_conjugation(9)))
    (3, 2)
    """
    n = rho.algebra.dimension
    if n <= MOST or n * (rho.size if size is None else size) ** 2 <= SMALL:
        return exact_matrices(rho)
    rng = random.Random(n)
    rows: list[ExactMatrix] = []
    adjoints: list[ExactMatrix] = []
    for _ in range(MOST):
        x = rho.field.matrix([[rng.choice((-1, 0, 0, 1)) for _ in range(n)]])
        rows.append(x)
        adjoints.append(rho.algebra.ad(x.row(0)).T)
        if len(rows) > 1 and invariant_hull_rank(rho.field.stack_rows(rows, n), adjoints) == n:
            return tuple(cast(ExactMatrix, rho(x.row(0))) for x in rows)
    return exact_matrices(rho)


def exact_matrices(rho: Representation) -> tuple[ExactMatrix, ...]:
    """The matrices of a representation that is known to be over an exact field."""
    return cast("tuple[ExactMatrix, ...]", rho.matrices)
