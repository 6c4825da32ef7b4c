"""Reference: the solution of m' = rho(psi(m, t)) m to round-off, with which integrators are compared.

It is a piecewise Taylor series in V, F(t_i + s) = w_0 + w_1 s + ... + w_n s^n with the coefficients of `flow_series`,
and uses no exponential and no step of the library.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.expansion import flow_series
from liehom.errors import ConvergenceError, InputError, ShapeError
from liehom.homogeneous import GeneratorField
from liehom.homogeneous.fields.field import check_point
from liehom.integrators.points import points_of
from liehom.typing import Array, IntegerArray

ORDERS: dict[np.dtype[Any], int] = {np.dtype(np.float64): 20, np.dtype(np.longdouble): 24}
MIN_ORDER = 4
MORE_ORDERS, SHORTER = 3, 0.7
"""The second solution, for the accuracy: orders added to those of the first, and the ratio of the lengths of pieces."""


@final
class Reference:
    """The solution through (t0, y0) as a function of time, extended forwards and backwards on demand.

    Parameters
    ----------
    field : GeneratorField
    y0 : array_like of shape (N,) or (..., N)
        The point at t0, or the points of an ensemble. numpy.longdouble gives three or more additional digits.
    t0 : float
    order : int, optional
        Degree n of the series, at least 4 (default 20, in extended precision 24).
    tolerance : float, optional
        The last term of a series relative to |m|, which determines the length of a piece (default: the unit of
        round-off of the dtype).

    Raises
    ------
    ShapeError, InputError
        If an initial point, the order or the tolerance is not right.
    SeriesError
        If psi cannot be expanded.

    Notes
    -----
    All trajectories of an ensemble have the same pieces, because psi is always called on all of them. A piece ends at
    tolerance^(1/n) times the radius of convergence, estimated by the root test on the upper half of the coefficients.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> ref = Reference(lh.GeneratorField(lh.defining(lh.so(2)), [1]), [1.0, 0.0])
    >>> bool(np.abs(ref(-3.0) - [np.cos(3), -np.sin(3)]).max() < 1e-15), bool(ref.accuracy(-3.0) < 1e-15)
    (True, True)
    """

    field: GeneratorField
    order: int
    start: Array

    __slots__ = ("_other", "_solution", "field", "order", "start", "t0", "tolerance")

    def __init__(
        self,
        field: GeneratorField,
        y0: npt.ArrayLike,
        t0: float | np.floating[Any] = 0.0,
        *,
        order: int | None = None,
        tolerance: float | None = None,
    ) -> None:
        if not isinstance(field, GeneratorField):
            raise InputError(f"expected a GeneratorField, got {field!r}: make one by liehom.GeneratorField(rho, psi)")
        start = points_of(y0)
        check_point(field.representation, start)
        order = ORDERS[start.dtype] if order is None else order
        if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < MIN_ORDER:
            raise InputError(f"the order of a reference is an integer at least {MIN_ORDER}, got {order!r}")
        eps = np.finfo(start.dtype).eps
        self.field, self.start, self.order = field, start, int(order)
        self.t0: np.floating[Any] = _number("t0", t0, start.dtype)
        self.tolerance: np.floating[Any] = eps if tolerance is None else _number("tolerance", tolerance, start.dtype)
        if not 0 < self.tolerance < 1:
            raise InputError(f"tolerance is {tolerance!r}, expected a number between 0 and 1")
        self._solution = _Solution(field, start, self.t0, self.order, self.tolerance, 1.0)
        self._other = _Solution(field, start, self.t0, self.order + MORE_ORDERS, self.tolerance, SHORTER)

    def __call__(self, t: npt.ArrayLike) -> Array:
        """Points at time t, shape (..., N).

        Parameters
        ----------
        t : float or array
            One time for all trajectories, or one for each, (...,); more leading axes are more times.

        Raises
        ------
        ConvergenceError
            If the solution does not exist until t.

        Examples
        --------
        >>> import liehom as lh
        >>> ref = Reference(lh.GeneratorField(lh.defining(lh.so(2)), [1]), [1.0, 0.0])
        >>> ref([0.0, 1.0, 2.0]).shape
        (3, 2)
        """
        return self._solution.evaluate(self._times(t), 0)

    def derivative(self, t: npt.ArrayLike, k: int = 1) -> Array:
        """The k-th derivative with respect to time at t, of the shape of ``ref(t)``."""
        if isinstance(k, bool) or not isinstance(k, int | np.integer) or k < 0:
            raise InputError(f"the number of derivatives is an integer at least 0, got {k!r}")
        return self._solution.evaluate(self._times(t), int(k))

    def accuracy(self, t: npt.ArrayLike) -> Array:
        """Largest distance from a second solution, of order n + 3 and with shorter pieces, until t, shape (...,).

        The distance is measured at t and at all ends of pieces before it; it is at least one unit of round-off of |m|.

        Examples
        --------
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
        >>> bool(Reference(field, [0.6, 0.0, 0.8]).accuracy(1.0) < 1e-15)
        True
        >>> bool(1e-9 < Reference(field, [0.6, 0.0, 0.8], order=6, tolerance=1e-6).accuracy(1.0) < 1e-5)
        True
        """
        times = self._times(t)
        made = self._solution.evaluate(times, 0)
        gap = np.linalg.norm(made - self._other.evaluate(times, 0), axis=-1)
        gap = np.maximum(gap, self._solution.gaps(self._other, times))
        largest: Array = np.maximum(gap, np.finfo(made.dtype).eps * np.linalg.norm(made, axis=-1))
        return largest

    def _times(self, t: npt.ArrayLike) -> Array:
        """t as an array that is broadcast against the ensemble."""
        try:
            times: Any = np.asarray(t).astype(self.start.dtype, casting="same_kind")
            times = np.broadcast_to(times, np.broadcast_shapes(times.shape, self.start.shape[:-1]))
        except TypeError:
            raise InputError(f"the time is {t!r}, expected a number or an array of numbers") from None
        except ValueError:
            raise ShapeError(f"the times have shape {np.shape(t)}, the ensemble {self.start.shape[:-1]}") from None
        if not bool(np.isfinite(times).all()):
            raise InputError(f"the time is {t!r}, expected finite numbers")
        checked: Array = times
        return checked

    def __repr__(self) -> str:
        return f"<reference of order {self.order}, {self.start.dtype.name}, through t = {self.t0} for {self.field!r}>"


def _number(name: str, value: float | np.floating[Any], dtype: np.dtype[Any]) -> Any:
    """A finite number in a floating type."""
    try:
        number = dtype.type(value)
    except (TypeError, ValueError):
        number = dtype.type(np.nan)
    if not np.isfinite(number):
        raise InputError(f"{name} is {value!r}, expected a finite number")
    return number


@final
class _Solution:
    """A piecewise solution: a branch after t0 and one before it."""

    def __init__(
        self,
        field: GeneratorField,
        start: Array,
        t0: np.floating[Any],
        order: int,
        tolerance: float | np.floating[Any],
        factor: float,
    ) -> None:
        self.t0 = t0
        self.branches = [_Branch(field, start, t0, order, tolerance, sign * factor) for sign in (1, -1)]

    def evaluate(self, times: Array, k: int) -> Array:
        """The k-th derivative at times of the shape of the ensemble, or with more leading axes."""
        return self._joined(times, lambda branch, t: branch.evaluate(t, k))

    def gaps(self, other: _Solution, times: Array) -> Array:
        """The largest distance from another solution at the ends of pieces before the times."""
        return self._joined(times, lambda branch, t: branch.gaps(other, t))

    def _joined(self, times: Array, value: Callable[[_Branch, Array], Array]) -> Array:
        """Values from the branch to which each time belongs."""
        after = times >= self.t0
        if bool(after.all()):
            return value(self.branches[0], times)
        later = value(self.branches[0], np.where(after, times, self.t0)) if after.any() else None
        made = value(self.branches[1], np.where(after, self.t0, times))
        if later is None:
            return made
        return np.where(after[..., None] if made.ndim > after.ndim else after, later, made)


@final
class _Branch:
    """The pieces on one side of t0: piece i from times[i] to times[i + 1], with its coefficients."""

    def __init__(
        self,
        field: GeneratorField,
        start: Array,
        t0: np.floating[Any],
        order: int,
        tolerance: float | np.floating[Any],
        factor: float,
    ) -> None:
        self.field, self.order, self.tolerance = field, order, tolerance
        self.direction, self.factor = start.dtype.type(np.sign(factor)), abs(factor)
        self.times: list[Any] = [t0]
        self.point = start
        self.pieces: list[Array] = []  # (..., N, n + 1)
        self.worst: list[Array] = []  # (...): the largest gap up to the beginning of piece i
        self._stacked: Array = np.zeros((0,))

    def evaluate(self, times: Array, k: int) -> Array:
        """The k-th derivative at times on this side of t0."""
        index = self._pieces_at(times)
        if len(self._stacked) != len(self.pieces):
            self._stacked = np.stack(self.pieces)
        lead = np.indices(self.point.shape[:-1])
        series = self._stacked[(index, *lead)]
        s = (times - np.array(self.times)[index])[..., None]
        return _horner(series, s, k)

    def gaps(self, other: _Solution, times: Array) -> Array:
        """For each time, the largest distance at beginnings of pieces before it, (...,)."""
        index = self._pieces_at(times)
        for i in range(len(self.worst), len(self.pieces)):
            at = np.broadcast_to(self.times[i], self.point.shape[:-1])
            gap = np.linalg.norm(self.pieces[i][..., 0] - other.evaluate(at, 0), axis=-1)
            self.worst.append(np.maximum(gap, self.worst[-1]) if self.worst else gap)
        largest: Array = np.stack(self.worst)[(index, *np.indices(self.point.shape[:-1]))]
        return largest

    def _pieces_at(self, times: Array) -> IntegerArray:
        """Indices of the pieces that contain the times; computes missing pieces."""
        furthest = max((times * self.direction).max(initial=-np.inf), self.times[0] * self.direction)
        while not self.pieces or furthest > self.times[-1] * self.direction:
            self._extend(furthest * self.direction)
        ends = np.array(self.times[1:]) * self.direction
        index: IntegerArray = np.minimum(np.searchsorted(ends, times * self.direction), len(self.pieces) - 1)
        return index

    def _extend(self, target: np.floating[Any]) -> None:
        """Compute one more piece; it ends at `target` if the series converges everywhere."""
        here = self.times[-1]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            flow = flow_series(self.field, self.point, self.order, np.full(self.point.shape[:-1], here))
            coefficients = [flow.point(k) for k in range(self.order + 1)]
            series = np.stack([np.broadcast_to(w, self.point.shape) for w in coefficients], axis=-1)
            series = series.astype(self.point.dtype)
            length = self._length(series)
            if not np.isfinite(length):
                length = max(abs(target - here), here.dtype.type(1))
            after = here + self.direction * length
            point = _horner(series, after - here, 0)
        if not bool(np.isfinite(point).all()) or after == here or length < 4 * np.finfo(here.dtype).eps * abs(here):
            raise ConvergenceError(
                f"the reference solution cannot be continued to t = {float(target):.8g}: psi or the solution is not "
                f"finite, or its series does not converge, at t = {float(here):.8g}; end before that"
            )
        self.pieces.append(series)
        self.times.append(after)
        self.point = point

    def _length(self, series: Array) -> Any:
        """tolerance^(1/n) times the smallest radius of convergence; inf if the upper coefficients all vanish.

        NaN in a coefficient becomes length 0, which raises an error.
        """
        sizes = np.abs(series).max(axis=-2)  # (..., n + 1)
        k = np.arange((self.order + 1) // 2, self.order + 1)
        ratio = sizes[..., k] / sizes[..., :1]
        largest = (ratio ** (1 / k.astype(series.dtype))).max(initial=0)
        if not np.isfinite(largest):
            return series.dtype.type(0)
        return self.factor * self.tolerance ** (series.dtype.type(1) / self.order) / largest


def _horner(series: Array, s: Array, k: int) -> Array:
    """The k-th derivative of sum_i series[..., i] s^i."""
    total: Array = np.zeros_like(series[..., 0])
    for i in range(series.shape[-1] - 1, k - 1, -1):
        factor = np.prod(np.arange(i - k + 1, i + 1, dtype=series.dtype))
        total = total * s + factor * series[..., i]
    return total
