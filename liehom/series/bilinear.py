"""Bilinear: a bilinear map with constant sparse coefficients, such as the bracket or the action rho(x) m.

    B(x, y)_k = sum over entries (i, j, k, v) of v x_i y_j

It runs on numpy arrays, JAX arrays and exact scalars with any leading axes, and on Jets.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from fractions import Fraction
from typing import Any, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.errors import ShapeError
from liehom.series import recurrences
from liehom.series.arrays import NumbersLike, as_values, constant_like, is_jax, namespace, owned, zeros
from liehom.series.jet import Jet

DENSE_UP_TO_ENTRIES = 4096
DENSE_FROM_FRACTION = 0.2
"""A map is applied as one dense matrix if a b c is at most DENSE_UP_TO_ENTRIES, or more than this fraction of its
entries is not 0."""


@final
class Bilinear:
    """Bilinear map K^a x K^b -> K^c with constant coefficients.

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

    __slots__ = ("__weakref__", "_cache", "_dense", "_i", "_j", "_k", "_starts", "_values", "shape")

    def __init__(self, entries: Iterable[tuple[int, int, int, Any]], shape: tuple[int, int, int]) -> None:
        rows = sorted(entries, key=lambda entry: (entry[2], entry[0], entry[1]))
        for i, j, k, _ in rows:
            if not (0 <= i < shape[0] and 0 <= j < shape[1] and 0 <= k < shape[2]):
                raise ShapeError(f"entry ({i}, {j}, {k}) of a bilinear map of shape {shape}")
        self.shape: tuple[int, int, int] = shape
        self._i, self._j, self._k = (np.array([row[a] for row in rows], dtype=int) for a in range(3))
        self._values = np.empty(len(rows), dtype=object)
        for index, row in enumerate(rows):
            self._values[index] = int(row[3]) if isinstance(row[3], np.integer) else row[3]
        self._starts = np.flatnonzero(np.r_[True, self._k[1:] != self._k[:-1]]) if rows else np.zeros(0, dtype=int)
        size = shape[0] * shape[1] * shape[2]
        self._dense = size <= DENSE_UP_TO_ENTRIES or len(rows) > DENSE_FROM_FRACTION * size
        self._cache: dict[Hashable, npt.NDArray[Any]] = {}

    def tensor(self) -> npt.NDArray[Any]:
        """Coefficients as an array of shape (a, b, c), of floats, or of objects if a coefficient is exact or symbolic.

        Examples
        --------
        >>> Bilinear([(0, 1, 0, 2)], (1, 2, 1)).tensor().tolist()
        [[[0.0], [2.0]]]
        """
        plain = all(isinstance(v, int | float | np.floating) for v in self._values)
        return self._filled(self._values.astype(np.float64) if plain else self._values)

    def __call__(self, x: NumbersLike, y: NumbersLike) -> Any:
        """B(x, y), array of shape (..., c), for x (..., a) and y (..., b); a Jet if x or y is one.

        Raises
        ------
        ShapeError
            If the last axis of an argument does not have the right length.
        """
        a, b = (v if isinstance(v, Jet) else _values_of(v) for v in (x, y))
        for v, length in zip((a, b), self.shape, strict=False):
            if not v.shape or v.shape[-1] != length:
                raise ShapeError(f"an argument of shape {v.shape}, expected (..., {length}) for a map of {self.shape}")
        if isinstance(a, Jet):
            if isinstance(b, Jet):
                return Jet.from_node(recurrences.multilinear(self._apply, [a.node, b.node]))
            right = owned(b)
            return Jet.from_node(recurrences.linear(lambda left: self._apply(left, right), [a.node]))
        if isinstance(b, Jet):
            left = owned(a)
            return Jet.from_node(recurrences.linear(lambda right: self._apply(left, right), [b.node]))
        return self._apply(a, b)

    def left(self, x: NumbersLike) -> npt.NDArray[Any]:
        """The matrix of y -> B(x, y), shape (..., c, b).

        Examples
        --------
        >>> Bilinear([(0, 1, 2, 1.0)], (2, 2, 3)).left([2.0, 0.0])[2].tolist()
        [0.0, 2.0]
        """
        return self._contracted("...i,ijk->...kj", x)

    def right(self, y: NumbersLike) -> npt.NDArray[Any]:
        """The matrix of x -> B(x, y), shape (..., c, a)."""
        return self._contracted("...j,ijk->...ki", y)

    def _contracted(self, subscripts: str, x: NumbersLike) -> npt.NDArray[Any]:
        factor = x if isinstance(x, Jet) else _values_of(x)
        xp = np if isinstance(factor, Jet) else namespace(factor)
        found: npt.NDArray[Any] = xp.einsum(subscripts, factor, self._tensor_for(factor))
        return found

    def _tensor_for(self, x: Jet | npt.NDArray[Any]) -> npt.NDArray[Any]:
        value = x.value if isinstance(x, Jet) else x
        return self._cached("tensor", value, lambda: self._filled(self._coefficients(value)))

    def _filled(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        out = np.zeros(self.shape, dtype=values.dtype)
        np.add.at(out, (self._i, self._j, self._k), values)
        return out

    def _apply(self, x: npt.NDArray[Any], y: npt.NDArray[Any]) -> npt.NDArray[Any]:
        a, b, c = self.shape
        kind = x if x.dtype == y.dtype else np.broadcast_to(np.zeros((), np.result_type(x.dtype, y.dtype)), (1,))
        if kind.dtype == object:
            kind = x if x.dtype == object else y
        elif self._dense:
            matrix = self._cached("matrix", kind, lambda: self._filled(self._coefficients(kind)).reshape(a * b, c))
            if matrix.dtype != object:
                pairs = x[..., :, None] * y[..., None, :]
                xp = namespace(pairs)
                flat: npt.NDArray[Any] = pairs.reshape(*pairs.shape[:-2], a * b)
                found: npt.NDArray[Any] = flat @ (matrix if xp is np else xp.asarray(matrix))
                return found
        products = x[..., self._i] * y[..., self._j] * self._cached("values", kind, lambda: self._coefficients(kind))
        return self._collected(products, kind)

    def _collected(self, products: npt.NDArray[Any], kind: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Array (..., c) of the sums of the products that belong to each component."""
        shape = (*products.shape[:-1], self.shape[2])
        if is_jax(products):
            whole: Any = zeros(products, shape)
            found: npt.NDArray[Any] = whole.at[..., self._k].add(products)
            return found
        out = zeros(products if products.size else kind, shape)
        if len(self._starts):
            out[..., self._k[self._starts]] = np.add.reduceat(products, self._starts, axis=-1)
        return out

    def _coefficients(self, like: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Coefficients as numbers of the kind of `like`."""
        if like.dtype == object:
            return constant_like(like, self._values)
        dtype = np.zeros((), like.dtype).real.dtype
        try:
            return np.array([constant_like(np.zeros((), dtype), v)[()] for v in self._values], dtype=dtype)
        except TypeError:  # symbols
            return self._values

    def _cached(self, name: str, like: npt.NDArray[Any], make: Callable[[], npt.NDArray[Any]]) -> npt.NDArray[Any]:
        """The value of make(), cached by its name and the kind of numbers in `like`."""
        if like.dtype != object:
            key: Hashable = (name, np.dtype(like.dtype))
        else:
            kind = type(like.flat[0]) if like.size else None
            if kind is None or not issubclass(kind, Fraction | flint.fmpq):
                return make()
            key = (name, kind)
        if key not in self._cache:
            self._cache[key] = make()
        return self._cache[key]


def _values_of(x: NumbersLike) -> npt.NDArray[Any]:
    return x if type(x) is np.ndarray and x.dtype.kind in "fcO" else as_values(x)
