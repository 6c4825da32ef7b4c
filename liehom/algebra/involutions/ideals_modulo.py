"""Ideals of a Lie algebra over a small prime field: submodules of its adjoint module, found by spinning vectors.

A vector killed by a random element a of the associative algebra of all ad x, or by a - t, lies in a proper submodule
more often than others; the same for the dual module, whose submodules are annihilators of ideals.  The list is not
complete.
"""

from __future__ import annotations

import numpy as np

from liehom.scalars.modular.modular_span import ModularSpan, invariant_span, left_kernel
from liehom.typing import IntegerArray

LARGEST_PRIME = 1000


def ideals_modulo(constants: IntegerArray, p: int, tries: int, limit: int) -> list[IntegerArray]:
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
    found: dict[bytes, IntegerArray] = {}
    for attempt in range(tries):
        a, b, c = (np.einsum("i,ijk->jk", rng.integers(0, p, n), maps) % p for _ in range(3))
        action = (a + b @ c) % p if attempt % 2 else a
        for t in range(min(p, 3)):
            shifted = (action - int(rng.integers(p) if p > 3 else t) * np.eye(n, dtype=np.int64)) % p
            for module, rows in ((maps, left_kernel(shifted, p)), (dual, left_kernel(shifted.T, p))):
                if not len(rows):
                    continue
                seed = rng.integers(0, p, len(rows)) @ rows % p
                space = invariant_span(module, seed[None, :], p).echelon()[0]
                if module is dual and len(space):
                    space = _annihilator(space, p)
                if 0 < len(space) < n:
                    found[space.tobytes()] = space
        if len(found) >= limit:
            break
    return sorted(found.values(), key=lambda x: (len(x), x.tolist()))


def _annihilator(space: IntegerArray, p: int) -> IntegerArray:
    """The reduced echelon basis of the vectors on which all rows of a space vanish."""
    span = ModularSpan(p, space.shape[1])
    span.extend(left_kernel(space.T, p))
    return span.echelon()[0]
