"""The Chevalley-Eilenberg complex of a Lie algebra g with values in a module V, as matrices.

A k-cochain is a row of length C(n, k) m, m = dim V. It lists the values w(e_i1, ..., e_ik) for i1 < ... < ik in the
order of ``itertools.combinations``, with the coordinates of V innermost. The differential is

    (dw)(x_0, ..., x_k) = sum_a (-1)^a rho(x_a) w(..., no x_a, ...)
                        + sum_{a < b} (-1)^(a+b) w([x_a, x_b], ..., no x_a, no x_b, ...).
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Sequence
from math import comb, lcm
from typing import Any, final

import numpy as np

from liehom.algebra.closure.closure import square_matrices
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.errors import InputError, RepresentationError, ShapeError
from liehom.scalars import ExactField, Field, FloatField, FloatMatrix, Matrix, as_exact
from liehom.scalars.fields.field import MatricesLike

MAX_ENTRIES = 30_000_000
"""Largest number of entries of a differential, a dense matrix."""


@final
class CochainComplex:
    """The cochains of g with values in V, and their differentials (each computed once).

    Parameters
    ----------
    algebra : LieAlgebra
        g, of dimension n.
    matrices : sequence of (m, m) array_like, optional
        rho(e_i) on columns, one for each basis element; by default V = R with rho = 0.
    size : int, optional
        m, needed only if matrices are given and g has dimension 0.

    Raises
    ------
    ShapeError
        If the number of matrices or their size does not fit.
    RepresentationError
        If they do not satisfy rho([x, y]) = rho(x) rho(y) - rho(y) rho(x) for x = e_i, y = e_j; names i and j.

    Examples
    --------
    >>> import liehom as lh
    >>> cochains = CochainComplex(lh.heisenberg(1))
    >>> print(cochains.differential(1))
    [0, 0, 0]
    [0, 0, 0]
    [-1, 0, 0]
    >>> (cochains.differential(1) @ cochains.differential(2)).is_zero()
    True
    """

    size: int

    __slots__ = ("_differentials", "algebra", "matrices", "size")

    def __init__(self, algebra: LieAlgebra, matrices: MatricesLike | None = None, *, size: int | None = None) -> None:
        self.algebra: LieAlgebra = algebra
        self._differentials: dict[int, Matrix] = {}
        self.matrices: tuple[Matrix, ...] | None = None
        self.size = 1
        if matrices is not None:
            made = square_matrices(matrices, algebra.field)
            if len(made) != algebra.dimension:
                raise ShapeError(f"{len(made)} matrices for an algebra of dimension {algebra.dimension}")
            if not made and size is None:
                raise ShapeError("the zero algebra acts on a space of any size: give size")
            self.matrices, self.size = tuple(made), int(made[0].nrows) if made else int(size or 0)
            _prove_representation(algebra, self.matrices)

    def length(self, degree: int) -> int:
        """The dimension of the space of cochains of a degree, an int; 0 for negative degrees."""
        return comb(self.algebra.dimension, degree) * self.size if degree >= 0 else 0

    def differential(self, degree: int) -> Matrix:
        """The matrix of d from k-cochains to (k+1)-cochains; rows are multiplied with it from the right.

        Raises
        ------
        InputError
            If it has more than 30 million entries.
        """
        if degree not in self._differentials:
            shape = (self.length(degree), self.length(degree + 1))
            if shape[0] * shape[1] > MAX_ENTRIES:
                raise InputError(
                    f"the differential of cochains of degree {degree} has {shape[0]} x {shape[1]} entries, more than "
                    f"{MAX_ENTRIES}; a smaller degree is cheaper"
                )
            self._differentials[degree] = self._assembled(degree, shape)
        return self._differentials[degree]

    def index_tuples(self, degree: int) -> list[tuple[int, ...]]:
        """The increasing tuples of indices of a degree, in the order of the coordinates of cochains."""
        return list(itertools.combinations(range(self.algebra.dimension), degree)) if degree >= 0 else []

    # -- the matrix --------------------------------------------------------------------------------------
    def _assembled(self, degree: int, shape: tuple[int, int]) -> Matrix:
        field = self.algebra.field
        whole: Matrix = field.zeros(*shape)
        if 0 in shape:
            return whole
        whole = self._from_brackets(degree, shape)
        if self.matrices is not None and not all(a.is_zero() for a in self.matrices):
            whole = whole + self._from_action(degree, shape)
        return whole

    def _from_brackets(self, degree: int, shape: tuple[int, int]) -> Matrix:
        """The second sum of d: each c[i, j, l] and each set R without i, j, l map R + l to R + i + j."""
        table, n, m = self.algebra.table, self.algebra.dimension, self.size
        source = {indices: x for x, indices in enumerate(self.index_tuples(degree))}
        target = {indices: x for x, indices in enumerate(self.index_tuples(degree + 1))}
        parts = [[0] * (shape[0] * shape[1]) for _ in table.parts]
        constants = list(zip(table.i.tolist(), table.j.tolist(), table.k.tolist(), strict=True))
        for rest in itertools.combinations(range(n), degree - 1) if degree else ():
            for entry, (i, j, l) in enumerate(constants):
                if i in rest or j in rest or l in rest:
                    continue
                at = bisect_left(rest, i), bisect_left(rest, j), bisect_left(rest, l)
                moved = (*rest[: at[2]], l, *rest[at[2] :])
                grown = (*rest[: at[0]], i, *rest[at[0] : at[1]], j, *rest[at[1] :])
                negative = (at[0] + at[1] + 1 + at[2]) % 2
                row, column = source[moved] * m, target[grown] * m
                for u in range(m):
                    for part, values in zip(parts, table.parts, strict=True):
                        value = values[entry]
                        part[(row + u) * shape[1] + column + u] += -value if negative else value
        # a constant occurs in at most comb(n - 2, degree - 1) m entries, an entry is a sum of at most n constants
        occurrences = comb(max(n - 2, 0), max(degree - 1, 0)) * m * n
        return _matrix(self.algebra.field, parts, shape, table.den, table.error * math.sqrt(occurrences))

    def _from_action(self, degree: int, shape: tuple[int, int]) -> Matrix:
        """The first sum of d: the matrix of e_t maps S to S + t."""
        m, field = self.size, self.algebra.field
        source = {indices: x for x, indices in enumerate(self.index_tuples(degree))}
        den, action = _integral(self.matrices or (), field)
        parts: list[list[Any]] = [[0] * (shape[0] * shape[1]) for _ in range(field.degree)]
        for x, grown in enumerate(self.index_tuples(degree + 1)):
            for a, t in enumerate(grown):
                start = source[grown[:a] + grown[a + 1 :]] * m
                for part, values in zip(parts, action[t], strict=True):
                    for index, value in values:
                        u, v = divmod(index, m)
                        part[(start + v) * shape[1] + x * m + u] += -value if a % 2 else value
        error = math.hypot(*(a.error for a in self.matrices or () if isinstance(a, FloatMatrix)))
        return _matrix(field, parts, shape, den, error * math.sqrt(comb(self.algebra.dimension - 1, degree)))


def _matrix(field: Field, parts: Sequence[Sequence[Any]], shape: tuple[int, int], den: int, error: float) -> Matrix:
    """The matrix with these numerators; over floats with this error."""
    if isinstance(field, FloatField):
        return FloatMatrix(field, np.array(parts[0], dtype=np.float64).reshape(shape), error)
    if not isinstance(field, ExactField):
        raise InputError(f"cochains over {field} are not supported")
    return field.from_parts(parts, *shape, den)


def _integral(matrices: Sequence[Matrix], field: Field) -> tuple[int, list[list[list[tuple[int, Any]]]]]:
    """A common denominator, and for each matrix and field coordinate the non-zero numerators by flat index.

    Over float64 the denominator is 1 and the numerators are floats.
    """
    if not field.exact:
        return 1, [[[(x, v) for x, v in enumerate(a.entries()) if v != 0]] for a in matrices]
    exact = [as_exact(a) for a in matrices]
    den = lcm(*(a.den for a in exact))
    made = []
    for a in exact:
        factor = den // a.den
        made.append([[(x, int(v) * factor) for x, v in enumerate(part.entries()) if v] for part in a.parts])
    return den, made


def _prove_representation(algebra: LieAlgebra, matrices: tuple[Matrix, ...]) -> None:
    n, field = algebra.dimension, algebra.field
    if n == 0 or matrices[0].nrows == 0:
        return
    size = matrices[0].nrows ** 2
    flat = field.stack_rows([a.reshape(1, size) for a in matrices], size)
    one = field.identity(n)
    for i, block in enumerate(algebra.table.contract(one, one, flat)):
        for j in range(i + 1, n):
            left = block.select(rows=[j]).reshape(matrices[0].nrows, matrices[0].nrows)
            products = matrices[i] @ matrices[j], matrices[j] @ matrices[i]
            defect = left - products[0] + products[1]
            if not defect.is_zero():
                names = algebra.basis_names
                raise RepresentationError(
                    (i, j),
                    f"the matrices are not a representation: rho([{names[i]}, {names[j]}]) differs from the commutator "
                    f"of rho({names[i]}) and rho({names[j]})",
                )
