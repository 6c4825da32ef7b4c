"""Data of a pair with denominators cleared, which `verify_modular` and `verify_sparse` reduce modulo primes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.scalars import ExactField, ExactMatrix

Integers: TypeAlias = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class IntegralPair:
    """Pair with denominators cleared: c' = delta c, Q' = q Q, h'_p = q h_p = q e_p - Q'_p e_free.

    The isotropy R'_p[u, v] = ([h'_p, e_u]' Q')_v, where [x, y]' = delta [x, y] and u counts the free indices,
    is delta q^2 R_p. The notation is that of `liehom.fullness.checker.verify_pair`.
    """

    field: ExactField
    dimension: int
    free: tuple[int, ...]
    pivots: tuple[int, ...]
    places: Integers
    """Indices (i, j, k) of the structure constants, i < j; shape (number, 3)."""
    constants: ExactMatrix
    """Constants c' at these indices, shape (1, number)."""
    quotient: ExactMatrix
    """Q', shape (n, d)."""
    scale: int
    """q."""
    isotropy: ExactMatrix
    """R', shape (k, d d)."""
