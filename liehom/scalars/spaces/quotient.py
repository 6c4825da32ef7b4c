"""Coordinates on a quotient K^n / U with small numbers.

Over QQ, an echelon basis of a subspace in general position has huge entries. In that case the lattice of integer
covectors that vanish on U is LLL-reduced together with a completion to a basis of Z^n. Its first d members are the
coordinate functions, and the dual basis gives a complement and a basis of U.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, final, overload

import flint

from liehom.budget import within
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.field import M, Matrix
from liehom.scalars.fields.floating import FloatMatrix

# bits of numbers for which no reduction is tried
MAX_SMALL_BITS = 5
# up to this dimension the lattice of covectors is reduced
MAX_LATTICE_DIMENSION = 130


@final
@dataclass(frozen=True, slots=True)
class Quotient(Generic[M]):
    """A basis of U, a complement of U, and the coordinates of the quotient in it.

    Attributes
    ----------
    subspace : Matrix
        Rows (k, n), a basis of U.
    lift : Matrix
        Rows (d, n), a complement W of U.
    projection : Matrix
        (n, d), with U Q = 0 and W Q = 1: x Q are the coordinates of x mod U.
    """

    subspace: M
    lift: M
    projection: M


@overload
def quotient(basis: ExactMatrix) -> Quotient[ExactMatrix]: ...
@overload
def quotient(basis: Matrix) -> Quotient[Matrix]: ...


def quotient(basis: Matrix) -> Quotient[ExactMatrix] | Quotient[FloatMatrix]:
    """`Quotient` with coordinates on K^n modulo the span of independent rows.

    Parameters
    ----------
    basis : Matrix
        Independent rows (k, n).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> q = quotient(QQ.matrix([[1, 1, 0]]))
    >>> (q.subspace @ q.projection).is_zero(), q.lift @ q.projection == QQ.identity(2)
    (True, True)
    """
    if isinstance(basis, FloatMatrix):
        across = basis.null_space()
        return Quotient(basis.row_space(), across, across.T)
    if not isinstance(basis, ExactMatrix):
        raise TypeError(f"no quotient over {basis.field}")
    reduced, pivots = basis.echelon()
    n = basis.ncols
    if basis.field.degree == 1 and 0 < basis.nrows < n <= MAX_LATTICE_DIMENSION and not _is_small(reduced):
        return _by_lattice(basis)
    return _from_echelon(reduced, pivots)


def echelon_quotient(basis: ExactMatrix) -> Quotient[ExactMatrix]:
    """`Quotient` by the echelon basis, whose complement consists of unit vectors: faster, with larger numbers.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> echelon_quotient(QQ.matrix([[1, 7, 0]])).projection.to_strings()
    [['-7', '0'], ['1', '0'], ['0', '1']]
    """
    return _from_echelon(*basis.echelon())


def _from_echelon(reduced: ExactMatrix, pivots: list[int]) -> Quotient[ExactMatrix]:
    n, chosen = reduced.ncols, set(pivots)
    free = [j for j in range(n) if j not in chosen]
    within("memory", 2 * 8 * n * len(free), "the coordinates on the quotient need {} bytes")
    unit = flint.fmpz_mat(len(free), n)
    for f, j in enumerate(free):
        unit[f, j] = 1
    rest = tuple(flint.fmpz_mat(len(free), n) for _ in range(reduced.field.degree - 1))
    return Quotient(reduced, ExactMatrix(reduced.field, (unit, *rest), 1), _projection(reduced, pivots, free))


def _projection(reduced: ExactMatrix, pivots: list[int], free: list[int]) -> ExactMatrix:
    """Matrix (n, d): row f is a unit vector for a free column f, row p minus the free part of its echelon row."""
    n, d = reduced.ncols, len(free)
    parts = []
    for s, part in enumerate(reduced.parts):
        out = flint.fmpz_mat(n, d)
        for i, pivot in enumerate(pivots):
            for f, j in enumerate(free):
                if x := part[i, j]:
                    out[pivot, f] = -x
        if s == 0:
            for f, j in enumerate(free):
                out[j, f] = reduced.den
        parts.append(out)
    return ExactMatrix(reduced.field, tuple(parts), reduced.den).normalized()


def _is_small(matrix: ExactMatrix) -> bool:
    bound = 1 << MAX_SMALL_BITS
    return matrix.den < bound and all(-bound < x < bound for x in matrix.parts[0].entries())


def _by_lattice(basis: ExactMatrix) -> Quotient[ExactMatrix]:
    n, k, field = basis.ncols, basis.nrows, basis.field
    rows = basis.parts[0].entries()
    bits = 10
    while True:
        weight = 1 << bits
        table: list[int | flint.fmpz] = []
        for i in range(n):
            table += [int(i == j) for j in range(n)]
            table += [weight * rows[a * n + i] for a in range(k)]
        reduced = flint.fmpz_mat(n, n + k, table).lll().tolist()
        d = n - k
        if all(x == 0 for row in reduced[:d] for x in row[n:]):
            break
        bits *= 2
    unimodular = flint.fmpz_mat([row[:n] for row in reduced])
    dual, sign = flint.fmpq_mat(unimodular).inv().numer_denom()
    # the matrix is unimodular, so its inverse is integral, with the dual basis as columns
    whole = ExactMatrix(field, (dual.transpose(),), int(sign)).normalized()
    functions = ExactMatrix(field, (unimodular,), 1).select(rows=range(d)).T
    return Quotient(whole.select(rows=range(d, n)), whole.select(rows=range(d)), functions)
