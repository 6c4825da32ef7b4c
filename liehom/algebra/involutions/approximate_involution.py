"""Cartan involutions of algebras in floating point, the most accurate one for several generic elements.

The integral elements that are short for -K(x, theta y), or near the fixed points of theta, are where exact involutions
are looked for.
"""

from __future__ import annotations

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.cartan_involution import (
    cartan_involution_of_constants,
    involution_frame,
    nearest_cartan_involution,
)
from liehom.errors import ConvergenceError
from liehom.scalars import RR
from liehom.typing import Array

SEEDS = 4  # generic elements that are tried
ACCURATE = 1e-11  # largest entry of theta^2 - 1 with which no further generic element is tried
LARGEST = 200  # short elements at most
HEIGHTS = (2, 4, 8, 16, 32, 64)  # largest coefficients of elements near k
NULL = 1e-6  # eigenvalues of a generic ad x below this fraction of the largest count as 0


def float_constants(algebra: LieAlgebra) -> Array:
    """The structure constants of an algebra over any field as an array (n, n, n) of float64.

    Examples
    --------
    >>> import liehom as lh
    >>> float_constants(lh.so(3))[0]
    array([[ 0.,  0.,  0.],
           [ 0.,  0.,  1.],
           [ 0., -1.,  0.]])
    """
    n = algebra.dimension
    return algebra.over(RR).table.dense().to_numpy().reshape(n, n, n)


def orthonormal_frame(algebra: LieAlgebra, theta: Array) -> Array:
    """A frame F, (n, n), with F F^T the form -K(x, theta y), for a Cartan involution theta on rows."""
    return involution_frame(algebra.killing_form().to_numpy(), theta)


def numerical_involution(algebra: LieAlgebra) -> Array:
    """The Cartan involution with the smallest trace of -K(x, theta y), (n, n) on rows, of an algebra over float64.

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
    constants = float_constants(algebra)
    killing = algebra.killing_form().to_numpy()
    return _found(constants, killing, _numerical_rank(constants))


def approximate_involution(algebra: LieAlgebra, rank: int) -> Array | None:
    """A Cartan involution, (n, n) on rows, of a semisimple algebra of known rank over any field, in floating point.

    It is the one with the smallest trace of -K(x, theta y), or None if double precision is not enough.

    Examples
    --------
    >>> import liehom as lh
    >>> approximate_involution(lh.so(4, 1), 2).shape
    (10, 10)
    """
    try:
        return _found(float_constants(algebra), algebra.killing_form().to_numpy(), rank)
    except (ConvergenceError, np.linalg.LinAlgError):
        return None


def short_elements(algebra: LieAlgebra, theta: Array) -> Array:
    """Basis elements, their sums and differences, and their brackets if these are integral, (m, n), shortest first.

    Parameters
    ----------
    algebra : LieAlgebra
        A semisimple algebra.
    theta : (n, n) float array
        A Cartan involution, on rows, approximately; lengths are those of -K(x, theta x).

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3)
    >>> short_elements(g, approximate_involution(g, 1))[:3]
    array([[0., 0., 1.],
           [0., 1., 0.],
           [1., 0., 0.]])
    """
    constants, n = float_constants(algebra), algebra.dimension
    form = -algebra.killing_form().to_numpy() @ theta.T
    one = np.eye(n)
    i, j = np.triu_indices(n, 1)
    vectors = [one, one[i] + one[j], one[i] - one[j]]
    if (constants == np.rint(constants)).all():
        vectors.append(constants.reshape(-1, n))
    rows = np.concatenate(vectors)
    rows = rows[(rows != 0).any(axis=1)]
    leading = np.take_along_axis(rows, np.argmax(rows != 0, axis=1)[:, None], axis=1)
    rows = np.unique(rows * np.sign(leading), axis=0)
    lengths = np.einsum("ai,ij,aj->a", rows, form, rows, optimize=True)
    return np.asarray(rows[np.argsort(np.round(lengths / lengths.max(), 9), kind="stable")[:LARGEST]])


def near_compact(theta: Array, seed: int) -> Array:
    """An integral row near a random fixed point of theta, with coefficients that grow with the seed."""
    x = np.random.default_rng(seed).standard_normal(len(theta)) @ (np.eye(len(theta)) + theta)
    height = HEIGHTS[min(seed, len(HEIGHTS) - 1)] if seed else 10**6
    return np.asarray(np.rint(x * (height / np.abs(x).max())))


def _numerical_rank(constants: Array) -> int:
    """The number of eigenvalues of a generic ad x that are 0 up to rounding."""
    x = np.random.default_rng(len(constants)).standard_normal(len(constants))
    values = np.abs(np.linalg.eigvals(np.einsum("i,ijk->jk", x, constants)))
    return int((values < NULL * max(values.max(), 1e-300)).sum())


def _found(constants: Array, killing: Array, rank: int) -> Array:
    """Theta on rows, from the generic element that gives the most accurate one; `ConvergenceError` if none does."""
    failure: Exception | None = None
    best: Array | None = None
    least = np.inf
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
