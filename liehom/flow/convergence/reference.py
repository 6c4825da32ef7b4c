"""The reference solution, and distances from an orbit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import ConvergenceError, InputError, ShapeError, checked_integer
from liehom.base.typing import Array, IntegerArray
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.run.options import points_of
from liehom.flow.steps.expansion import flow_series

# Reference: the solution of m' = rho(psi(m, t)) m to round-off, with which integrators are compared. It is a piecewise
# Taylor series in V, F(t_i + s) = w_0 + w_1 s + ... + w_n s^n with the coefficients of `flow_series`, and uses no
# exponential and no step of the library.

ORDERS: dict[np.dtype[Any], int] = {np.dtype(np.float64): 20, np.dtype(np.longdouble): 24}
MIN_ORDER = 4
MORE_ORDERS, SHORTER = 3, 0.7
"""The second solution, for the accuracy: orders added to those of the first, and the ratio of the lengths of pieces."""

LOOKS = 512  # looks at psi on the way to a target, besides one at the end of each piece
ALLOWED_RESIDUAL = 1e4  # h |p'(s) - X(p(s))| of a piece p, in units of the tolerance times |m|
OFFSET, CUT = 0.382, 0.7  # looks are not symmetric in a piece; a piece that does not pass is shortened by this factor


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
    SeriesError
        If psi cannot be expanded.

    Notes
    -----
    All trajectories of an ensemble have the same pieces, because psi is always called on all of them. A piece ends at
    tolerance^(1/n) times the radius of convergence, estimated by the root test on the upper half of the coefficients.
    It is shorter if psi within it is not what the series says (docs/step-sizes.md).

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
        eps = np.finfo(start.dtype).eps
        self.field, self.start = field, start
        self.order = checked_integer(order, "the order of a reference", MIN_ORDER)
        self.t0: np.floating[Any] = _number("t0", t0, start.dtype)
        self.tolerance: np.floating[Any] = eps if tolerance is None else _number("tolerance", tolerance, start.dtype)
        if not 0 < self.tolerance < 1:
            raise InputError(f"tolerance is {tolerance!r}, expected a number between 0 and 1")
        self._solution = _Solution(self, self.order, 1.0)
        self._other = _Solution(self, self.order + MORE_ORDERS, SHORTER)

    def __call__(self, t: npt.ArrayLike) -> Array:
        """Points at time t, shape (..., N)."""
        return self._solution.evaluate(self._times(t), 0)

    def derivative(self, t: npt.ArrayLike, k: int = 1) -> Array:
        """The k-th derivative with respect to time at t, of the shape of ``ref(t)``."""
        return self._solution.evaluate(self._times(t), checked_integer(k, "the number of derivatives", 0))

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
        points = self._solution.evaluate(times, 0)
        gap = np.linalg.norm(points - self._other.evaluate(times, 0), axis=-1)
        roundoff = np.finfo(points.dtype).eps * np.linalg.norm(points, axis=-1)
        return np.maximum(np.maximum(gap, self._solution.gaps(self._other, times)), roundoff)

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
        return times

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
    """A piecewise solution: a branch after t0 and one before it, in pieces shorter than those of `ref` by a factor."""

    def __init__(self, ref: Reference, order: int, factor: float) -> None:
        self.t0 = ref.t0
        self.branches = [_Branch(ref, order, sign * factor) for sign in (1, -1)]

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
        earlier = value(self.branches[1], np.where(after, self.t0, times))
        if later is None:
            return earlier
        return np.where(after[..., None] if earlier.ndim > after.ndim else after, later, earlier)


@final
class _Branch:
    """The pieces on one side of t0: piece i from times[i] to times[i + 1], with its coefficients."""

    def __init__(self, ref: Reference, order: int, factor: float) -> None:
        self.field, self.order, self.tolerance, self.point = ref.field, order, ref.tolerance, ref.start
        self.direction, self.factor = ref.start.dtype.type(np.sign(factor)), abs(factor)
        self.times: list[Any] = [ref.t0]
        self.pieces: list[Array] = []  # (..., N, n + 1)
        self.worst: list[Array] = []  # (...): the largest gap up to the beginning of piece i
        self._stacked: Array = np.zeros((0,))

    def evaluate(self, times: Array, k: int) -> Array:
        """The k-th derivative at times on this side of t0."""
        index = self._pieces_at(times)
        if len(self._stacked) != len(self.pieces):
            self._stacked = np.stack(self.pieces)
        series = self._stacked[(index, *np.indices(self.point.shape[:-1]))]
        return _horner(series, (times - np.array(self.times)[index])[..., None], k)

    def gaps(self, other: _Solution, times: Array) -> Array:
        """For each time, the largest distance at beginnings of pieces before it, (...,)."""
        index = self._pieces_at(times)
        for i in range(len(self.worst), len(self.pieces)):
            at = np.broadcast_to(self.times[i], self.point.shape[:-1])
            gap = np.linalg.norm(self.pieces[i][..., 0] - other.evaluate(at, 0), axis=-1)
            self.worst.append(np.maximum(gap, self.worst[-1]) if self.worst else gap)
        return np.stack(self.worst)[(index, *np.indices(self.point.shape[:-1]))]

    def _pieces_at(self, times: Array) -> IntegerArray:
        """Indices of the pieces that contain the times; computes missing pieces."""
        furthest = max((times * self.direction).max(initial=-np.inf), self.times[0] * self.direction)
        while not self.pieces or furthest > self.times[-1] * self.direction:
            self._extend(furthest * self.direction)
        ends = np.array(self.times[1:]) * self.direction
        return np.minimum(np.searchsorted(ends, times * self.direction), len(self.pieces) - 1)

    def _extend(self, target: np.floating[Any]) -> None:
        """Compute one more piece; it ends at `target` if the series converges everywhere."""
        here = self.times[-1]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            flow = flow_series(self.field, self.point, self.order, np.full(self.point.shape[:-1], here))
            coefficients = [np.broadcast_to(flow.point(k), self.point.shape) for k in range(self.order + 1)]
            series = np.stack(coefficients, axis=-1).astype(self.point.dtype)
            length = self._length(series)
            way = abs(target - self.times[0]) or here.dtype.type(1)
            length = min(length, way) if length == length else length
            while length > 0 and not self._passes(series, length, way):
                length = CUT * length
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

    def _passes(self, series: Array, length: np.floating[Any], way: np.floating[Any]) -> bool:
        """Whether the velocity of a piece is that of the field, at its end and at looks on the way to the target."""
        here, count = self.times[-1], int(np.ceil(LOOKS * length / way))
        allowed = ALLOWED_RESIDUAL * self.tolerance * np.linalg.norm(series[..., 0], axis=-1)
        times = np.abs(here) * np.linalg.norm(2 * series[..., min(2, self.order)], axis=-1)
        rounded = 8 * np.finfo(here.dtype).eps * (np.linalg.norm(series[..., 1], axis=-1) + times)
        for j in range(count):
            s: Any = self.direction * length * (1 if j == 0 else (count - j - OFFSET) / (count - OFFSET))
            t = np.full(self.point.shape[:-1], here + s)
            lack = np.linalg.norm(_horner(series, s, 1) - self.field.vector(_horner(series, s, 0), t), axis=-1)
            if not bool((length * np.maximum(lack - rounded, 0) <= allowed).all()):
                return False
        return True

    def _length(self, series: Array) -> Any:
        """tolerance^(1/n) times the smallest radius of convergence; inf if it has none, 0 (an error later) for NaN."""
        sizes = np.abs(series).max(axis=-2)  # (..., n + 1)
        k = np.arange((self.order + 1) // 2, self.order + 1)
        ratio = sizes[..., k] / sizes[..., :1]
        largest = (ratio ** (1 / k.astype(series.dtype))).max(initial=0)
        longest = self.factor * self.tolerance ** (series.dtype.type(1) / self.order)
        return longest / largest if np.isfinite(largest) else series.dtype.type(0)


def _horner(series: Array, s: Array, k: int) -> Array:
    """The k-th derivative of sum_i series[..., i] s^i."""
    total: Array = np.zeros_like(series[..., 0])
    for i in range(series.shape[-1] - 1, k - 1, -1):
        factor = np.prod(np.arange(i - k + 1, i + 1, dtype=series.dtype))
        total = total * s + factor * series[..., i]
    return total


# orbit_distance: the distance of a point from the orbit of the flow, min over s of |y - F_s(m_0)|, s near t. Newton's
# method on <y - F_s, F_s'> = 0, on any manifold; first integrals are not used.

ITERATIONS = 100
HALVINGS = 30
TRUST_FRACTION = 0.5
"""Longest Newton step in units of |F'| / |F''|, a time in which the tangent turns or changes by its own length."""


def orbit_distance(reference: Reference, y: npt.ArrayLike, t: npt.ArrayLike) -> tuple[Array, Array]:
    """Distances of points from the orbits through the initial points of a reference, and the times of the minima.

    Parameters
    ----------
    reference : Reference
    y : array_like of shape (..., N)
        One point for each trajectory; more leading axes are more points.
    t : float or array of shape (...,)
        The times near which the orbit is searched, at |s - t| <= |t - t0|, t0 the initial time of the reference.

    Returns
    -------
    distance, s : arrays of shape (...,)
        The local minimum |y - F_s(m_0)| that is found by descent from s = t; at most |y - F_t(m_0)|.

    Raises
    ------
    ConvergenceError
        If the solution does not exist until t.

    Notes
    -----
    A step of the descent is a Newton step, or a Gauss-Newton step if the distance is not convex in s. It is halved
    until the distance decreases. At equilibria F' = 0, and s does not change. The error of the distance is of second
    order in the error of s.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> ref = lh.convergence.Reference(lh.GeneratorField(lh.defining(lh.so(2)), [1]), [1.0, 0.0])
    >>> distance, s = orbit_distance(ref, [1.25 * np.cos(2), 1.25 * np.sin(2)], 1.5)
    >>> round(float(distance), 14), round(float(s), 12)
    (0.25, 2.0)
    """
    points, s = _arguments(reference, y, t)
    window = np.abs(s - reference.t0)
    low, high = s - window, s + window
    best = _distance(reference, points, s)
    eps = np.finfo(points.dtype).eps
    open_ = best > 0
    for _ in range(ITERATIONS):
        if not open_.any():
            break
        step, speed = _newton_step(reference, points, s)
        step = np.where(open_, np.clip(s + step, low, high) - s, 0)
        open_ = open_ & (np.abs(step) * speed > eps * np.linalg.norm(points, axis=-1))
        step, distance = _descended(reference, points, s, np.where(open_, step, 0), best)
        open_ = open_ & (distance < best)
        s, best = np.where(open_, s + step, s), np.where(open_, distance, best)
    return best, s


def _arguments(reference: Reference, y: npt.ArrayLike, t: npt.ArrayLike) -> tuple[Array, Array]:
    """Points and times, checked and broadcast."""
    points, times = points_of(y).astype(reference.start.dtype), reference._times(t)
    if points.shape[-1:] != reference.start.shape[-1:]:
        raise ShapeError(f"a point has {reference.start.shape[-1]} coordinates, got shape {points.shape}")
    try:
        shape = np.broadcast_shapes(points.shape[:-1], times.shape)
    except ValueError:
        raise ShapeError(
            f"points of shape {points.shape}, times of shape {np.shape(t)} and the ensemble "
            f"{reference.start.shape[:-1]} do not fit together"
        ) from None
    if not bool(np.isfinite(points).all()):
        raise InputError("a point is not finite: the distance from an orbit needs finite points")
    return np.broadcast_to(points, (*shape, points.shape[-1])), np.broadcast_to(times, shape)


def _distance(reference: Reference, y: Array, s: Array) -> Array:
    return np.linalg.norm(y - reference(s), axis=-1)


def _newton_step(reference: Reference, y: Array, s: Array) -> tuple[Array, Array]:
    """The change of s by a Newton step, and the speed |F'|."""
    rest = y - reference(s)
    first, second = reference.derivative(s, 1), reference.derivative(s, 2)
    speed, bend = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
    moves = speed > np.finfo(y.dtype).tiny
    safe = np.where(moves, speed, 1)
    # every term is divided by the speed, whose square may underflow
    slope = np.sum(rest * first / safe[..., None], axis=-1)
    curvature = np.sum(rest * second / safe[..., None], axis=-1)
    steepness = np.where(curvature < 0.75 * safe, safe - curvature, safe)
    bound = TRUST_FRACTION * np.divide(safe, bend, out=np.full_like(safe, np.inf), where=bend > 0)
    return np.where(moves, np.clip(slope / steepness, -bound, bound), 0), speed


def _descended(reference: Reference, y: Array, s: Array, step: Array, best: Array) -> tuple[Array, Array]:
    """The step, halved until the distance decreases, and the distances after it."""
    distance = best
    for _ in range(HALVINGS):
        try:
            distance = _distance(reference, y, s + step)
        except ConvergenceError:  # the solution ends within the window
            distance = np.full_like(best, np.inf)
        worse = (distance >= best) & (step != 0)
        if not worse.any():
            break
        step = np.where(worse, step / 2, step)
    return step, distance
