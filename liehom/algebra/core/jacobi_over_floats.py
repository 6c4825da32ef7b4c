"""Whether the Jacobi identity holds over floats, relative to the uncertainty of the table.

With J(x, y) = ad [x, y] - [ad x, ad y], a matrix for each x and y, the cyclic sums of all basis elements are the
entries of J. The table c has an error e, so the Frobenius norm of J is uncertain by 6 ||c|| e, to first order:
J is a sum of three products of c with itself. The table is divided by a power of two near its norm first, so that no
product overflows or vanishes.

In small dimensions the norm of J is computed. In large ones it is estimated from J(x, y) for pairs of Gaussian vectors,
because the expected square of the norm of J(x, y) is that of J. J is alternating, so J(x, y) is small for all pairs by
accident only if every x and y lie near a subspace of codimension 2: with 16 pairs the estimate is below a tenth of the
norm with a probability below 1e-18.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import FieldError
from liehom.scalars import Scalar
from liehom.scalars.fields.floating import norm_of
from liehom.typing import Array

ALL_PAIRS = 20  # dimension up to which all pairs of basis elements are tried
RANDOM_PAIRS = 16
DENSE = 20  # a table with more than a twentieth of all entries is held dense
PRODUCTS = 6.0  # the error of J is at most this many times the norm of the table times its error

Failure = tuple[tuple[int, int, int], dict[int, Scalar]]


def failure_over_floats(table: StructureConstants) -> Failure | None:
    """Indices (i, j, k) and the coefficients of a cyclic sum that is not zero, or None if the identity holds.

    Examples
    --------
    >>> import liehom as lh
    >>> failure_over_floats(lh.so(4).over(lh.RR).table) is None
    True
    """
    norm = table.norm()
    if norm == 0:
        return None
    if not math.isfinite(norm):
        raise FieldError("the norm of the table leaves the range of float64; multiply it by a power of two, or use QQ")
    unit = 2.0 ** min(math.frexp(norm)[1], 1023)
    scaled = _Scaled(table, unit)
    bound = PRODUCTS * (norm / unit) * (table.error / unit)
    n = table.dimension
    squares, worst = 0.0, (0.0, np.zeros(n), np.zeros(n))
    for x, y in _pairs(n):
        size = norm_of(scaled.defect(x, y))
        squares += size * size
        worst = max(worst, (size, x, y), key=lambda found: found[0])
    mean = 2 * squares if n <= ALL_PAIRS else squares / RANDOM_PAIRS
    return None if math.sqrt(mean) <= bound else scaled.located(worst[1], worst[2], unit)


def _pairs(n: int) -> Iterator[tuple[Array, Array]]:
    """All pairs of basis elements, or Gaussian vectors."""
    if n <= ALL_PAIRS:
        one = np.eye(n)
        yield from ((one[i], one[j]) for i in range(n) for j in range(i + 1, n))
        return
    rng = np.random.default_rng(n)
    for _ in range(RANDOM_PAIRS):
        yield rng.normal(size=n), rng.normal(size=n)


class _Scaled:
    """A table over floats, divided by a power of two: dense, or as lists of its entries for both orders of i and j."""

    def __init__(self, table: StructureConstants, unit: float) -> None:
        values = np.asarray(table.parts[0], dtype=np.float64) / unit
        self.n = table.dimension
        self.flat: Array | None = None
        if len(values) * DENSE >= self.n**3:
            upper = np.zeros((self.n, self.n, self.n))
            upper[table.i, table.j, table.k] = values
            self.flat = (upper - upper.transpose(1, 0, 2)).reshape(self.n, self.n**2)
            return
        self.first = np.concatenate([table.i, table.j])
        self.place = np.concatenate([table.k * self.n + table.j, table.k * self.n + table.i])
        self.values = np.concatenate([values, -values])

    def ad(self, x: Array) -> Array:
        """The matrix of y -> [x, y] on columns."""
        if self.flat is not None:
            return np.asarray((x @ self.flat).reshape(self.n, self.n).T, dtype=np.float64)
        weights = x[self.first] * self.values
        made = np.bincount(self.place, weights, self.n * self.n).astype(np.float64)
        return made.reshape(self.n, self.n)

    def defect(self, x: Array, y: Array) -> Array:
        """The matrix J(x, y), on columns."""
        of_x, of_y = self.ad(x), self.ad(y)
        made: Array = self.ad(of_x @ y) - of_x @ of_y + of_y @ of_x
        return made

    def located(self, x: Array, y: Array, unit: float) -> Failure:
        """The largest cyclic sum of basis elements near x and y with J(x, y) not zero, times the square of the unit."""
        one = np.eye(self.n)
        k = int(np.linalg.norm(self.defect(x, y), axis=0).argmax())
        # J(x, y) e_k = J(e_k, x) y
        j = int(np.linalg.norm(self.defect(one[k], x), axis=0).argmax())
        sums = self.defect(one[k], one[j])
        i = int(np.linalg.norm(sums, axis=0).argmax())
        i, j, k = sorted((i, j, k))
        cyclic = self.defect(one[i], one[j]) @ one[k]
        size = float(np.abs(cyclic).max())
        # the unit may be so large that its square is infinite
        value: dict[int, Scalar] = {
            m: float(v * unit) * unit for m, v in enumerate(cyclic.tolist()) if abs(v) > 1e-6 * size
        }
        return (i, j, k), value
