"""Integral bases: a basis with small entries of the integer vectors in a rational subspace.

Echelon bases of subspaces in general position have large entries, and clearing denominators leaves a sublattice of
large index. With the echelon form (1 | R / d), the integer vectors are x (1 | R / d) for x in Z^k with x R = 0 mod d.
These x form the dual of the lattice that Z^k and the columns of R / d generate.
"""

from __future__ import annotations

from typing import Any

import flint

from liehom.scalars.fields.exact_field import ExactMatrix

SHORT_BITS = 64  # entries of an echelon basis that is kept


def integral_basis(rows: ExactMatrix) -> ExactMatrix:
    """An LLL-reduced basis of the integer vectors in the span of rows over QQ; over QQ(a) an echelon basis.

    Parameters
    ----------
    rows : ExactMatrix
        Shape (k, n); the rows may be dependent.

    Returns
    -------
    ExactMatrix
        Shape (rank, n).

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(integral_basis(QQ.matrix([[4, 0, 6], [1, 1, 1]])))
    [1, 1, 1]
    [0, -2, 1]
    """
    reduced, pivots = rows.echelon()
    if rows.field.degree > 1 or not pivots:
        return reduced
    integers = reduced.parts[0]
    if reduced.den > 1:
        chosen = set(pivots)
        free = [j for j in range(rows.ncols) if j not in chosen]
        integers = _coordinates(reduced.select(columns=free).parts[0], reduced.den) * integers
        integers = (flint.fmpq_mat(integers) / reduced.den).numer_denom()[0]
    return ExactMatrix(rows.field, (integers.lll(),), 1)


def short_basis(rows: ExactMatrix) -> ExactMatrix:
    """The reduced echelon basis of a row space if its entries have at most 64 bits, else `integral_basis`.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> print(short_basis(QQ.matrix([[2, 4]])), short_basis(QQ.matrix([[2**80, 3**50, 5]])).nrows)
    [1, 2] 1
    """
    reduced = rows.row_space()
    bits = max((int(abs(x)).bit_length() for part in reduced.parts for x in part.entries()), default=0)
    return reduced if max(bits, reduced.den.bit_length()) <= SHORT_BITS else integral_basis(reduced)


def _coordinates(table: flint.fmpz_mat, den: int) -> flint.fmpz_mat:
    """Basis (k, k) of the lattice of x in Z^k with x R = 0 modulo den."""
    k, columns = table.nrows(), table.transpose().tolist()
    lattice: list[Any] = [[den * int(i == j) for j in range(k)] for i in range(k)]
    width = max(2 * k, 8)
    batch = columns[:width]
    while True:
        lattice = flint.fmpz_mat([*lattice, *batch]).hnf().tolist()[:k]
        # the lattice contains den Z^k, so that den times the inverse is integral
        dual = (flint.fmpq_mat(flint.fmpz_mat(lattice)).inv() * den).numer_denom()[0].transpose()
        products = (dual * table).entries()
        m = len(columns)
        missed = sorted({x % m for x, v in enumerate(products) if v % den})
        if not missed:
            return dual
        batch = [columns[j] for j in missed[:width]]
