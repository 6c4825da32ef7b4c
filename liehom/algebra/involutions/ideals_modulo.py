"""Ideals of a Lie algebra over a small prime field, as submodules of its adjoint module that a vector generates.

A vector that a random element a of the associative algebra of all ad x annihilates, or a - t with a number t, lies in a
proper submodule more often than other vectors do.  This also holds for the dual module, whose submodules are the
annihilators of ideals.  The list of ideals need not be complete.
"""

from __future__ import annotations

import numpy as np

from liehom.scalars.modular.modular_span import ModularSpan, invariant_span, left_kernel
from liehom.typing import IntegerArray

LARGEST_PRIME = 1000  # primes below this one are small
SHIFTS = 3  # numbers t that are tried for each random element


def ideals_modulo(constants: IntegerArray, p: int, tries: int, limit: int) -> list[IntegerArray]:
    """Some proper non-zero ideals, each by its reduced echelon basis, sorted by dimension.

    Parameters
    ----------
    constants : (n, n, n) integer array
        c[i, j, k] modulo p.
    p : int
        A prime below 1000.
    tries : int
        Number of random elements.
    limit : int
        Number of ideals after which the search ends.

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
        for t in range(min(p, SHIFTS)):
            shifted = (action - int(rng.integers(p) if p > SHIFTS else t) * np.eye(n, dtype=np.int64)) % p
            for module, rows in ((maps, left_kernel(shifted, p)), (dual, left_kernel(shifted.T, p))):
                if not len(rows):
                    continue
                vector = rng.integers(0, p, len(rows)) @ rows % p
                space = invariant_span(module, vector[None, :], p).echelon()[0]
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
