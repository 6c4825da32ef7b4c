"""The proof that matrices respect a bracket: rho([x, y]) = rho(x) rho(y) - rho(y) rho(x), exactly and quickly.

For sparse rational matrices every commutator is computed by dictionaries.  For dense matrices a few elements x that
generate the algebra are enough, because the elements x that satisfy the identity for all y form a subalgebra (by the
Jacobi identity on both sides).  A rank modulo a prime proves that they generate.
"""

from __future__ import annotations

import random
from typing import Any

from liehom.algebra import LieAlgebra
from liehom.algebra.closure.sparse_commutators import first_difference
from liehom.scalars import Matrix, as_exact
from liehom.scalars.modular.modular import invariant_hull_rank

RANDOM_ELEMENTS = 4


def failing_pair(algebra: LieAlgebra, matrices: tuple[Matrix, ...]) -> tuple[int, int] | None:
    """The first pair (i, j) for which rho([e_i, e_j]) differs from the commutator of the matrices, or None.

    Over floats the differences may be as large as their error, propagated from the errors of the structure constants
    and of the matrices.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.LieAlgebra({(0, 1): {1: 1}}, dimension=2)
    >>> matrices = [lh.QQ.matrix([[1, 0], [0, 0]]), lh.QQ.matrix([[0, 1], [0, 0]])]
    >>> failing_pair(g, tuple(matrices)), failing_pair(g, (matrices[0], lh.QQ.identity(2)))
    (None, (0, 1))
    """
    if len(matrices) < 2 or matrices[0].nrows == 0:
        return None
    if not algebra.field.exact:
        return _first_failure(algebra, matrices, _Stack(algebra, matrices))
    if _is_sparse(matrices):
        return first_difference(list(matrices), algebra.table)
    stack = _Stack(algebra, matrices)
    return None if _proved_by_generators(algebra, stack) else _first_failure(algebra, matrices, stack)


def _is_sparse(matrices: tuple[Matrix, ...]) -> bool:
    if matrices[0].field.degree > 1:
        return False
    n = matrices[0].nrows
    filled = sum(1 for a in matrices for x in as_exact(a).parts[0].entries() if x != 0)
    return filled <= len(matrices) * max(2 * n, n * n // 6)


class _Stack:
    """The matrices side by side (`wide`), one below the other (`tall`), and as rows (`flat`)."""

    def __init__(self, algebra: LieAlgebra, matrices: tuple[Matrix, ...]) -> None:
        field, self.size = algebra.field, matrices[0].nrows
        self.algebra, self.count = algebra, len(matrices)
        self.flat = field.stack_rows([a.reshape(1, self.size**2) for a in matrices], self.size**2)
        self.wide = field.stack_columns(matrices, self.size)
        self.tall = field.stack_rows(matrices, self.size)
        n, d = self.size, self.count
        self._order = [a * d + j for j in range(d) for a in range(n)]

    def defects(self, x: Matrix) -> tuple[Matrix, Matrix]:
        """The rows rho([x, e_j]) - [rho(x), rho(e_j)], flattened, for all j, and the rows [x, e_j]."""
        n, d = self.size, self.count
        image = (x @ self.flat).reshape(n, n)
        left = (image @ self.wide).reshape(n * d, n).select(rows=self._order)
        commutators = (left - self.tall @ image).reshape(d, n * n)
        brackets = self.algebra.ad(x).T
        return brackets @ self.flat - commutators, brackets


def _proved_by_generators(algebra: LieAlgebra, stack: _Stack) -> bool:
    """Whether the identity holds for all y and random x that are proved to generate."""
    n = algebra.dimension
    rng = random.Random(n)
    elements: list[Any] = []
    adjoints: list[Any] = []
    for _ in range(RANDOM_ELEMENTS):
        x = algebra.field.matrix([[rng.randint(-2, 2) for _ in range(n)]])
        defects, brackets = stack.defects(x)
        if not defects.is_zero():
            return False
        elements.append(x)
        adjoints.append(brackets)
        if invariant_hull_rank(algebra.field.stack_rows(elements, n), adjoints) == n:
            return True
    return False


def _first_failure(algebra: LieAlgebra, matrices: tuple[Matrix, ...], stack: _Stack) -> tuple[int, int] | None:
    for i in range(len(matrices)):
        defects = stack.defects(algebra.field.unit(len(matrices), i))[0]
        bad = defects.first_nonzero_row()
        if bad is not None:
            return (i, bad) if i < bad else (bad, i)
    return None
