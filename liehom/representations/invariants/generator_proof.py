"""The proof that sparse integer matrices respect a bracket, from generators of the algebra alone.

The elements x with rho([x, y]) = [rho(x), rho(y)] for all y form a subalgebra: if it contains x and x', the Jacobi
identity on both sides shows that it contains [x, x'].  It is therefore enough to take x from 2 r generators and y from
the basis: 2 r dim g commutators of sparse matrices instead of dim g (dim g - 1) / 2.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, final

import numpy as np

from liehom.algebra import StructureConstants
from liehom.scalars.spaces.sparse import SparseInteger
from liehom.typing import IntegerArray, ObjectArray

SUM_LIMIT = 1 << 60


@final
class SparseStack:
    """Sparse integer matrices A_0, ..., A_(d-1) of size N, laid out in the three ways that commutators need.

    Parameters
    ----------
    size : int
        N.
    matrices : sequence of sequences of mappings
        ``matrices[j][c]`` is column c of A_j as ``{row: entry}``.

    Examples
    --------
    >>> stack = SparseStack(2, [[{}, {0: 1}], [{1: 1}, {}]])
    >>> stack.wide.shape, stack.tall.shape, stack.flat.shape
    ((2, 4), (4, 2), (2, 4))
    """

    __slots__ = ("flat", "size", "tall", "wide")

    def __init__(self, size: int, matrices: Sequence[Sequence[dict[int, int]]]) -> None:
        entries = [
            (j, b, c, v)
            for j, columns in enumerate(matrices)
            for c, column in enumerate(columns)
            for b, v in column.items()
        ]
        j, b, c = (np.array([e[x] for e in entries], dtype=np.int64) for x in range(3))
        values = [e[3] for e in entries]
        d = len(matrices)
        self.size: int = size
        self.wide: SparseInteger = SparseInteger(b, j * size + c, values, (size, d * size))
        self.tall: SparseInteger = SparseInteger(j * size + b, c, values, (d * size, size))
        self.flat: SparseInteger = SparseInteger(j, b * size + c, values, (d, size * size))

    def matrix(self, j: int) -> SparseInteger:
        """The sparse matrix A_j."""
        chosen = self.flat.rows == j
        places = self.flat.columns[chosen]
        shape = (self.size, self.size)
        return SparseInteger(places // self.size, places % self.size, self.flat.values[chosen], shape)


def failing_generator_pair(
    table: StructureConstants, stack: SparseStack, generators: Iterable[int]
) -> tuple[int, int] | None:
    """The first pair (i, j), i a generator, for which [A_i, A_j] differs from sum_k c[i, j, k] A_k; None is a proof.

    Parameters
    ----------
    table : StructureConstants
        The structure constants c of a Lie algebra over QQ.
    stack : SparseStack
        One matrix per basis element.
    generators : iterable of int
        Numbers of basis elements that generate the algebra, which is not checked.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.LieAlgebra({(0, 1): {1: 1}}, dimension=2)
    >>> right, wrong = [[{0: 1}, {}], [{}, {0: 1}]], [[{0: 1}, {}], [{1: 1}, {}]]
    >>> [failing_generator_pair(g.table, SparseStack(2, matrices), [0, 1]) for matrices in (right, wrong)]
    [None, (0, 1)]
    """
    d, n = table.dimension, stack.size
    brackets = table.sparse()
    for i in generators:
        matrix = stack.matrix(i)
        kept = brackets.rows // d == i
        constants = SparseInteger(brackets.rows[kept] % d, brackets.columns[kept], brackets.values[kept], (d, d))
        left = (matrix @ stack.wide).regroup(n, d, n)  # (j, b N + c), as the other two
        right = (stack.tall @ matrix).reshape(d, n * n)
        found = _first_row_of_sum([(left, table.den), (right, -table.den), (constants @ stack.flat, -1)])
        if found is not None:
            return i, found
    return None


def _first_row_of_sum(terms: list[tuple[SparseInteger, int]]) -> int | None:
    """The first row in which a combination of sparse matrices is not zero, or None."""
    width = terms[0][0].shape[1]
    places = np.concatenate([a.rows * width + a.columns for a, _ in terms])
    if not len(places):
        return None
    values: Any = np.concatenate([_times(a.values, factor) for a, factor in terms])
    order = np.argsort(places, kind="stable")
    places, values = places[order], values[order]
    starts: IntegerArray = np.flatnonzero(np.concatenate([[True], places[1:] != places[:-1]]))
    sums = np.add.reduceat(values, starts)
    wrong = places[starts][sums != 0]
    return int(wrong[0] // width) if len(wrong) else None


def _times(values: IntegerArray | ObjectArray, factor: int) -> IntegerArray | ObjectArray:
    """The multiples of integers, as Python integers where a sum of three of them might overflow."""
    if values.dtype != object and len(values) and int(np.abs(values).max()) * abs(factor) > SUM_LIMIT:
        values = values.astype(object)
    return values * factor
