"""A few matrices of a representation that generate the others: matrices that commute with these commute with all.

Random elements generate the algebra if the smallest space that contains them and is closed under brackets with them is
the whole algebra.  A rank modulo a prime proves this.
"""

from __future__ import annotations

import random
from typing import cast

from liehom.representations.core.representation import Representation
from liehom.scalars import ExactMatrix
from liehom.scalars.modular.modular import invariant_hull_rank

SMALL_SIZE = 20_000  # entries of all matrices up to which all of them are used
MAX_ELEMENTS = 4


def generating_matrices(rho: Representation, size: int | None = None) -> tuple[ExactMatrix, ...]:
    """Matrices with the same commutant, invariant forms, vectors and subspaces as all rho(x).

    Parameters
    ----------
    rho : Representation
        Over an exact field.
    size : int, optional
        Size used in the choice (default: of rho). With equal sizes, representations of one algebra are given by the
        matrices of the same elements.

    Returns
    -------
    tuple of Matrix
        All matrices of the basis if they are few and small or if two to four random elements do not generate the
        algebra, else the matrices of these random elements.

    Examples
    --------
    >>> import liehom as lh
    >>> len(generating_matrices(lh.defining(lh.so(3)))), len(generating_matrices(lh.sym_conjugation(9)))
    (3, 2)
    """
    n = rho.algebra.dimension
    if n <= MAX_ELEMENTS or n * (rho.size if size is None else size) ** 2 <= SMALL_SIZE:
        return exact_matrices(rho)
    rng = random.Random(n)
    rows: list[ExactMatrix] = []
    adjoints: list[ExactMatrix] = []
    for _ in range(MAX_ELEMENTS):
        x = rho.field.matrix([[rng.choice((-1, 0, 0, 1)) for _ in range(n)]])
        rows.append(x)
        adjoints.append(rho.algebra.ad(x.row(0)).T)
        if len(rows) > 1 and invariant_hull_rank(rho.field.stack_rows(rows, n), adjoints) == n:
            return tuple(cast(ExactMatrix, rho(x.row(0))) for x in rows)
    return exact_matrices(rho)


def exact_matrices(rho: Representation) -> tuple[ExactMatrix, ...]:
    """The matrices of a representation that is known to be over an exact field."""
    return cast("tuple[ExactMatrix, ...]", rho.matrices)
