"""Bilinear: a bilinear map with constant sparse coefficients, such as the bracket or the action rho(x) m.

    B(x, y)_k = sum over entries (i, j, k, v) of v x_i y_j

It runs on numpy arrays, JAX arrays and exact scalars with any leading axes, and on Jets.
Imports jet, recurrences, arrays, errors.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, final

import numpy as np

from liehom.errors import ShapeError
from liehom.series import recurrences
from liehom.series.arrays import is_jax, namespace
from liehom.series.jet import Jet

DENSE_SIZE = 4096
DENSE_SHARE = 0.2


@final
class Bilinear:
    """A bilinear map K^a x K^b -> K^c with constant coefficients.

    Parameters
    ----------
    entries : iterable of (i, j, k, value)
        B(e_i, e_j) has value in component k; entries with the same indices add up.
    shape : (a, b, c)

    Raises
    ------
    ShapeError
        If an index is out of range.

    Examples
    --------
    >>> cross = Bilinear([(0, 1, 2, 1.0), (1, 0, 2, -1.0)], (2, 2, 3))
    >>> cross([1.0, 0.0], [0.0, 1.0])
    array([0., 0., 1.])
    """

    __slots__ = ("_dense", "_exact", "_i", "_j", "_k", "_starts", "_v", "_values", "shape")

    def __init__(self, entries: Iterable[tuple[int, int, int, Any]], shape: tuple[int, int, int]) -> None:
        rows = sorted(entries, key=lambda entry: (entry[2], entry[0], entry[1]))
        for i, j, k, _ in rows:
            if not (0 <= i < shape[0] and 0 <= j < shape[1] and 0 <= k < shape[2]):
                raise ShapeError(f"entry ({i}, {j}, {k}) of a bilinear map of shape {shape}")
        self.shape = shape
        self._i, self._j, self._k = (np.array([row[a] for row in rows], dtype=int) for a in range(3))
        values = [row[3] for row in rows]
        self._exact = any(not isinstance(v, int | np.integer | float | np.floating) for v in values)
        # what exact vectors are multiplied by: integers must not pass through a float
        self._values = np.array([int(v) if isinstance(v, int | np.integer) else v for v in values], dtype=object)
        self._v = self._values if self._exact else self._values.astype(np.float64)
        self._starts = np.flatnonzero(np.r_[True, self._k[1:] != self._k[:-1]]) if rows else np.zeros(0, dtype=int)
        size = shape[0] * shape[1] * shape[2]
        small = not self._exact and size <= DENSE_SIZE
        self._dense = self.tensor() if small or (not self._exact and len(rows) > DENSE_SHARE * size) else None

    def tensor(self) -> Any:
        """The coefficients as an array of shape (a, b, c)."""
        out = np.zeros(self.shape, dtype=self._v.dtype)
        for i, j, k, v in zip(self._i, self._j, self._k, self._v, strict=True):
            out[i, j, k] += v
        return out

    def __call__(self, x: Any, y: Any) -> Any:
        """B(x, y) for x (..., a) and y (..., b): shape (..., c); Jets give a Jet."""
        if isinstance(x, Jet) or isinstance(y, Jet):
            if not isinstance(x, Jet):
                x = np.asarray(x) if not is_jax(x) else x
                return Jet.from_node(recurrences.linear(lambda b: self._apply(x, b), [y.node]))
            if not isinstance(y, Jet):
                y = np.asarray(y) if not is_jax(y) else y
                return Jet.from_node(recurrences.linear(lambda a: self._apply(a, y), [x.node]))
            return Jet.from_node(recurrences.multilinear(self._apply, [x.node, y.node]))
        return self._apply(x if is_jax(x) else np.asarray(x), y if is_jax(y) else np.asarray(y))

    def left(self, x: Any) -> Any:
        """The matrix of y -> B(x, y), shape (..., c, b).

        Examples
        --------
        >>> Bilinear([(0, 1, 2, 1.0)], (2, 2, 3)).left([2.0, 0.0])[2].tolist()
        [0.0, 2.0]
        """
        return np.einsum("...i,ijk->...kj", x, self._tensor_for(x))

    def right(self, y: Any) -> Any:
        """The matrix of x -> B(x, y), shape (..., c, a)."""
        return np.einsum("...j,ijk->...ki", y, self._tensor_for(y))

    def _tensor_for(self, x: Any) -> Any:
        tensor = self.tensor() if self._dense is None else self._dense
        value = x.value if isinstance(x, Jet) else x
        return namespace(value).asarray(tensor) if is_jax(value) else tensor

    def _apply(self, x: Any, y: Any) -> Any:
        xp = namespace(x, y)
        if self._dense is not None and x.dtype != object and y.dtype != object:
            matrix = xp.tensordot(x, xp.asarray(self._dense), axes=1)
            return (y[..., None, :] @ matrix)[..., 0, :]
        exact = x.dtype == object or y.dtype == object
        products = x[..., self._i] * y[..., self._j] * (self._values if exact else self._v)
        if is_jax(products):
            total = xp.zeros((*products.shape[:-1], self.shape[2]), dtype=products.dtype)
            return total.at[..., self._k].add(products)
        out = np.zeros((*products.shape[:-1], self.shape[2]), dtype=products.dtype)
        if products.dtype == object:
            out[...] = 0 * _representative(x, y)
        if len(self._starts):
            out[..., self._k[self._starts]] = np.add.reduceat(products, self._starts, axis=-1)
        return out


def _representative(*arrays: Any) -> Any:
    """Some exact entry, to make a zero of its kind."""
    for a in arrays:
        for x in a.flat:
            if not isinstance(x, int | float):
                return x
    return 0
