"""Algebras of commuting matrices: minimal polynomials, the trace form, candidates for a generator.

A commutative algebra A of matrices has A / rad A = K_1 x ... x K_s with fields K_i, and rad A is the radical of the
form tr(a b) (characteristic 0).  An element whose minimal polynomial has a squarefree part of degree
dim A / rad A generates A / rad A, and that part has one irreducible factor for each K_i.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from liehom.errors import InternalError, SingularError
from liehom.scalars import ExactMatrix, Polynomial

ATTEMPTS = 40  # random sums of matrices that are tried as generators


def minimal_polynomial(matrix: ExactMatrix, start: ExactMatrix) -> Polynomial:
    """The monic polynomial f of smallest degree with f(A) v = 0.

    Parameters
    ----------
    matrix : ExactMatrix
        A, shape (n, n).
    start : ExactMatrix
        The vector v as a row, (1, n).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> minimal_polynomial(QQ.matrix([[0, 2], [1, 0]]), QQ.matrix([[1, 0]]))
    (-2)*t**0 + (1)*t**2
    """
    field, n = matrix.field, matrix.nrows
    rows = [start]
    for degree in range(n + 1):
        whole = field.stack_rows(rows, n)
        if int(whole.modulo().rank()) <= degree:
            try:
                found = whole.select(rows=range(degree)).T.solve(rows[-1].T) if degree else field.zeros(0, 1)
                if degree or rows[-1].is_zero():
                    return Polynomial(field, [*(-c for c in found.entries()), field.one])
            except SingularError:
                pass  # the vectors are dependent modulo the prime only
        rows.append((matrix @ rows[-1].T).T)
    raise InternalError("a vector and its images are independent in a space that is too small for them")


def evaluate(polynomial: Polynomial, matrix: ExactMatrix) -> ExactMatrix:
    """The matrix f(A) for a polynomial f over the field of A, by Horner's rule.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(evaluate(Polynomial(QQ, [1, 0, 1]), QQ.matrix([[0, -1], [1, 0]])))
    [0, 0]
    [0, 0]
    """
    field, n = matrix.field, matrix.nrows
    total, one = field.zeros(n, n), field.identity(n)
    for c in reversed(polynomial.coefficients):
        total = total @ matrix + one.scale(c)
    return total


def semisimple_rank(maps: Sequence[ExactMatrix]) -> int:
    """The dimension of A / rad A for a commutative algebra A of matrices with this basis, the rank of tr(a b).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> semisimple_rank([QQ.identity(2), QQ.matrix([[0, 1], [0, 0]])])
    1
    """
    if not maps:
        return 0
    size = maps[0].nrows ** 2
    field = maps[0].field
    flat = field.stack_rows([a.reshape(1, size) for a in maps], size)
    turned = field.stack_rows([a.T.reshape(1, size) for a in maps], size)
    return int((flat @ turned.T).rank())


def combinations(maps: Sequence[ExactMatrix], rng: random.Random) -> Iterator[ExactMatrix]:
    """The matrices themselves, then `ATTEMPTS` random sums of them with growing integer weights."""
    yield from maps
    for attempt in range(ATTEMPTS):
        size = len(maps) * (1 + attempt // 2) // 2
        total = maps[0].scale(rng.randint(-size, size))
        for a in maps[1:]:
            total = total + a.scale(rng.randint(-size, size))
        yield total


def are_independent(maps: Sequence[ExactMatrix]) -> bool:
    """Whether matrices of one shape are linearly independent.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> are_independent([QQ.identity(2), QQ.identity(2).scale(3)])
    False
    """
    if not maps:
        return True
    size = maps[0].nrows * maps[0].ncols
    flat = maps[0].field.stack_rows([a.reshape(1, size) for a in maps], size)
    return bool(flat.rank() == len(maps))
