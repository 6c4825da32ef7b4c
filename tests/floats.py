"""Pairs and algebras as arrays of floats, in rotated bases and scaled."""

from typing import Any

import numpy as np

import liehom as lh


def rotation(n: int, rng: np.random.Generator) -> Any:
    """A random orthogonal matrix (n, n)."""
    return np.linalg.qr(rng.standard_normal((n, n)))[0]


def constants_of(pair: lh.Pair) -> tuple[Any, Any]:
    """Structure constants (n, n, n) and the rows of the subalgebra (k, n), rounded."""
    n, field = pair.algebra.dimension, pair.field
    constants = np.zeros((n, n, n))
    for i, j, k, value in pair.algebra.table:
        constants[i, j, k] = field.to_float(value)
        constants[j, i, k] = -constants[i, j, k]
    return constants, pair.subalgebra.basis.to_numpy()


def rotated(constants: Any, rows: Any, turn: Any, scale: float = 1.0) -> tuple[Any, Any]:
    """The same in the basis of the rows of an orthogonal matrix, with the structure constants multiplied by `scale`."""
    turned = np.einsum("ai,bj,ijk,ck->abc", turn, turn, constants, turn, optimize=True) * scale
    return (turned - turned.transpose(1, 0, 2)) / 2, rows @ turn.T


def pair_of(constants: Any, rows: Any, field: lh.FloatField = lh.RR) -> lh.Pair:
    """The pair over floats, with its axioms checked."""
    algebra = lh.LieAlgebra(np.asarray(constants, dtype=float), field=field)
    return lh.Pair(algebra, np.asarray(rows, dtype=float).tolist() if len(rows) else [])
