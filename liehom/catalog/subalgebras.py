"""Subalgebras of linear Lie algebras as stabilizers, and by inclusion of matrices.

Each of these conditions is linear in X, and the X that satisfy it are closed under commutators:

    X W in W for a subspace W,   X v = 0,   X T = T X,   X^T F + F X = 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations
from math import prod
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.algebra.closure.sparse_commutators import exclusive_entries
from liehom.algebra.matrices.matrix_basis import null_space
from liehom.catalog.linear import at_offset
from liehom.typing import IntegerArray

MAX_PERMUTED = 6


def preserving(
    matrices: IntegerArray,
    *,
    subspaces: Sequence[IntegerArray] = (),
    points: Sequence[IntegerArray] = (),
    commuting: Sequence[IntegerArray] = (),
    forms: Sequence[IntegerArray] = (),
) -> IntegerArray:
    """Basis of the combinations of the matrices that satisfy all conditions, as rows (m, dim).

    Parameters
    ----------
    matrices : (dim, N, N) integers
    subspaces : sequence of (r, N) integers
        Rows that span the subspaces W.
    points : sequence of (N,) integers
        The vectors v.
    commuting, forms : sequences of (N, N) integers
        The matrices T and F.

    Examples
    --------
    The upper triangular matrices of sl(2):

    >>> from liehom.algebra.matrices import sl
    >>> preserving(sl(2), subspaces=[np.array([[1, 0]])]).tolist()
    [[1, 0, 0], [0, 0, 1]]
    """
    if len(matrices) == 0:
        return np.zeros((0, 0), dtype=np.int64)
    transposed = matrices.transpose(0, 2, 1)
    conditions = [null_space(w) @ matrices @ w.T for w in subspaces]
    conditions += [matrices @ v for v in points]
    conditions += [matrices @ t - t @ matrices for t in commuting]
    conditions += [transposed @ f + f @ matrices for f in forms]
    flat = [c.reshape(len(matrices), prod(c.shape[1:])) for c in conditions]
    system = np.concatenate([np.zeros((len(matrices), 1), dtype=np.int64), *flat], axis=1).T
    return null_space(system[system.any(axis=1)].reshape(-1, len(matrices)))


def coordinates(matrices: IntegerArray, elements: IntegerArray) -> IntegerArray | None:
    """Integer rows (m, dim) with the span of elements in a matrix basis, or None if one is not in the span.

    Each row is a positive multiple of the coefficients of one element.
    """
    if matrices.shape[1:] != elements.shape[1:]:
        return None
    if len(elements) == 0 or len(matrices) == 0:
        rows = np.zeros((len(elements), len(matrices)), dtype=np.int64)
        return rows if not elements.any() else None
    flat = matrices.reshape(len(matrices), -1)
    wanted = elements.reshape(len(elements), -1)
    positions = exclusive_entries([_entries(a) for a in matrices], matrices.shape[1])
    if positions is None:
        return _solved(flat, wanted)
    own = flat[range(len(flat)), positions]
    scale = int(np.lcm.reduce(np.abs(own)))
    rows = wanted[:, positions] * (scale // own)
    used = np.flatnonzero(rows.any(axis=0))
    largest = max(np.abs(rows).sum(axis=1).max(initial=0) * np.abs(flat).max(), scale * np.abs(wanted).max(initial=0))
    kind = np.dtype(float if largest < 2**53 else object)  # float64 products below 2^53 are exact, and faster
    product: npt.NDArray[Any] = rows[:, used].astype(kind) @ flat[used].astype(kind)
    return rows if np.array_equal(product, scale * wanted.astype(kind)) else None


def _entries(matrix: IntegerArray) -> dict[tuple[int, int], int]:
    """The non-zero entries of a matrix as {(row, column): value}, row by row."""
    rows, columns = matrix.nonzero()
    return dict(zip(zip(rows.tolist(), columns.tolist(), strict=True), matrix[rows, columns].tolist(), strict=True))


def _solved(flat: IntegerArray, wanted: IntegerArray) -> IntegerArray | None:
    """The coefficients by the linear relations between both families, or None."""
    m, n = len(wanted), len(flat)
    relations = null_space(np.concatenate([flat, wanted]).T)
    if len(relations) != m:
        return None
    # the basis is independent, so each wanted element is the free column of one relation
    free = relations[:, n:]
    if np.count_nonzero(free) != m:
        return None
    rows: IntegerArray = -np.sign(free.sum(axis=1, keepdims=True)) * relations[:, :n]
    return rows


def placements(parts: Sequence[IntegerArray], size: int) -> Iterator[IntegerArray]:
    """Matrix bases with the parts as consecutive diagonal blocks on R^size, in any order, from either end."""
    total = sum(part.shape[1] for part in parts)
    if total > size:
        return
    for order in _orders(parts):
        for start in sorted({0, size - total}):
            offset, placed = start, []
            for part in order:
                placed.append(at_offset(part, offset, size))
                offset += part.shape[1]
            yield np.concatenate(placed)


def _orders(parts: Sequence[IntegerArray]) -> Iterator[Sequence[IntegerArray]]:
    """The different orders of the parts; of more than `MAX_PERMUTED` parts only the given one and its reverse."""
    if len(parts) > MAX_PERMUTED:
        yield parts
        yield parts[::-1]
        return
    kinds = [next(i for i, other in enumerate(parts) if np.array_equal(part, other)) for part in parts]
    for order in dict.fromkeys(permutations(kinds)):
        yield [parts[i] for i in order]
