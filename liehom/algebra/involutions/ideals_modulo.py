"""Ideals of a Lie algebra over a small prime field: submodules of its adjoint module, found by spinning vectors.

A vector killed by a random element a of the associative algebra of all ad x, or by a - t, lies in a proper submodule
more often than others; the same for the dual module, whose submodules are annihilators of ideals.  The list is not
complete.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

IntArray = npt.NDArray[np.int64]
LARGEST_PRIME = 1000


def echelon_modulo(table: IntArray, p: int) -> tuple[IntArray, list[int]]:
    """The non-zero rows of the reduced echelon form modulo a small prime, and the pivots.

    Examples
    --------
    >>> echelon_modulo(np.array([[2, 4], [1, 2]]), 5)
    (array([[1, 2]]), [0])
    """
    table = table % p
    pivots: list[int] = []
    for column in range(table.shape[1]):
        rank = len(pivots)
        places = np.flatnonzero(table[rank:, column])
        if not len(places):
            continue
        found = rank + int(places[0])
        table[[rank, found]] = table[[found, rank]]
        table[rank] = table[rank] * pow(int(table[rank, column]), -1, p) % p
        factors = table[:, column].copy()
        factors[rank] = 0
        table = (table - np.outer(factors, table[rank])) % p
        pivots.append(column)
        if len(pivots) == len(table):
            break
    return table[: len(pivots)], pivots


def kernel_rows(table: IntArray, p: int) -> IntArray:
    """A basis of the rows x with x A = 0.

    Examples
    --------
    >>> kernel_rows(np.array([[1], [4]]), 5)
    array([[1, 1]])
    """
    n = len(table)
    reduced, pivots = echelon_modulo(table.T, p)
    free = [j for j in range(n) if j not in set(pivots)]
    rows = np.zeros((len(free), n), dtype=np.int64)
    for i, j in enumerate(free):
        rows[i, j] = 1
        rows[i, pivots] = -reduced[:, j] % p
    return rows


def ideals_modulo(constants: IntArray, p: int, tries: int, limit: int) -> list[IntArray]:
    """Some proper non-zero ideals, each by its reduced echelon basis, by dimension.

    Parameters
    ----------
    constants : (n, n, n) integer array
        c[i, j, k] modulo p.
    p : int
        A prime below 1000.
    tries : int
        How many random elements.
    limit : int
        How many ideals at most.

    Examples
    --------
    >>> import liehom as lh
    >>> c = lh.direct_sum(lh.so(3), lh.so(3)).over(lh.RR).table.dense().array.reshape(6, 6, 6)
    >>> [np.flatnonzero(x.any(axis=0)).tolist() for x in ideals_modulo(np.rint(c).astype(int) % 3, 3, 20, 9)]
    [[3, 4, 5], [0, 1, 2]]
    """
    n = len(constants)
    rng = np.random.default_rng(n)
    maps = constants % p  # rows y: y @ maps[i] = [e_i, y]
    dual = np.ascontiguousarray(maps.transpose(0, 2, 1))
    found: dict[bytes, IntArray] = {}
    for attempt in range(tries):
        a, b, c = (np.einsum("i,ijk->jk", rng.integers(0, p, n), maps) % p for _ in range(3))
        action = (a + b @ c) % p if attempt % 2 else a
        for t in range(min(p, 3)):
            shifted = (action - int(rng.integers(p) if p > 3 else t) * np.eye(n, dtype=np.int64)) % p
            for module, rows in ((maps, kernel_rows(shifted, p)), (dual, kernel_rows(shifted.T, p))):
                if not len(rows):
                    continue
                seed = rng.integers(0, p, len(rows)) @ rows % p
                space = _spun(module, seed[None, :], p)
                if module is dual and len(space):
                    space = echelon_modulo(kernel_rows(space.T, p), p)[0]
                if 0 < len(space) < n:
                    found[space.tobytes()] = space
        if len(found) >= limit:
            break
    return sorted(found.values(), key=lambda x: (len(x), x.tolist()))


def _spun(module: IntArray, rows: IntArray, p: int) -> IntArray:
    """The reduced echelon basis of the submodule that rows generate."""
    n = module.shape[1]
    space = echelon_modulo(rows, p)[0]
    new = space
    while len(new) and len(space) < n:
        images = np.einsum("aj,ijk->aik", new, module).reshape(-1, n) % p
        larger = echelon_modulo(np.concatenate([space, images]), p)[0]
        if len(larger) == len(space):
            break
        space = new = larger
    return space
