"""Cartan involutions of algebras in floating point, from whichever generic element gives the most accurate one."""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.cartan_involution import cartan_involution_of_constants, nearest_cartan_involution
from liehom.errors import ConvergenceError
from liehom.scalars import RR

SEEDS = 4
ACCURATE = 1e-11


def numerical_involution(algebra: LieAlgebra) -> Any:
    """The Cartan involution with the least trace of -K(x, theta y), (n, n) on rows, of an algebra over float64.

    Raises
    ------
    ConvergenceError
        If double precision is not enough.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> np.round(numerical_involution(lh.sl(2).over(lh.RR)), 6) + 0.0
    array([[ 0., -1.,  0.],
           [-1.,  0.,  0.],
           [ 0.,  0., -1.]])
    """
    n = algebra.dimension
    constants = algebra.table.dense().array.reshape(n, n, n)
    killing = algebra.killing_form().to_numpy()
    return _found(constants, killing, _numerical_rank(constants))


def approximate_involution(algebra: LieAlgebra, rank: int) -> Any:
    """The same, (n, n) on rows, for a semisimple algebra of known rank over any field; None without convergence.

    Examples
    --------
    >>> import liehom as lh
    >>> approximate_involution(lh.so(4, 1), 2).shape
    (10, 10)
    """
    n = algebra.dimension
    try:
        constants = algebra.over(RR).table.dense().array.reshape(n, n, n)
        return _found(constants, algebra.killing_form().to_numpy(), rank)
    except (ConvergenceError, np.linalg.LinAlgError):
        return None


def _numerical_rank(constants: Any) -> int:
    x = np.random.default_rng(len(constants)).standard_normal(len(constants))
    values = np.abs(np.linalg.eigvals(np.einsum("i,ijk->jk", x, constants)))
    return int((values < 1e-6 * max(values.max(), 1e-300)).sum())


def _found(constants: Any, killing: Any, rank: int) -> Any:
    """Theta on rows, from the generic element that gives the most accurate one."""
    failure: Exception | None = None
    best, least = None, np.inf
    for seed in range(SEEDS):
        try:
            theta = cartan_involution_of_constants(constants, killing, rank, seed)
            theta = nearest_cartan_involution(constants, killing, theta)
        except (ConvergenceError, np.linalg.LinAlgError) as error:
            failure = error
            continue
        size = float(np.abs(theta @ theta - np.eye(len(theta))).max())
        if size < least:
            best, least = theta, size
        if size < ACCURATE:
            break
    if best is None:
        raise ConvergenceError(f"no Cartan involution in double precision: {failure}")
    return best
