"""Taylor: the Taylor series of the trajectory, landed on the orbit.

    m~(h) = m_0 + m_1 h + ... + m_n h^n,   (k + 1) m_(k+1) = sum_(i <= k) rho(psi_i) m_(k-i)

is next to the orbit, at a distance of order n + 1. The landing moves it there without a loss of order: see
docs/theory/taylor.md.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from math import ceil, log, log2
from types import ModuleType
from typing import Any, ClassVar, final

import numpy as np

from liehom.base.errors import InputError, checked_integer
from liehom.base.typing import Array, BooleanArray, IntegerArray, Values
from liehom.flow.action.exponential import TrueExponential
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.invariants import InvariantLanding, Quadrics, invariant_landing, quadric_orbits
from liehom.flow.action.space import Action
from liehom.flow.series.arrays import coarse, is_traced, namespace
from liehom.flow.series.jet import Jet
from liehom.flow.series.quadratic import AffineFlow, affine_flow
from liehom.flow.steps.corrected import least_generator
from liehom.flow.steps.expansion import Flow, flow_series
from liehom.flow.steps.step import (
    SERIES_FRACTION,
    Generator,
    LastSize,
    LocalStep,
    Step,
    StepLimits,
    polynomial,
    series_at,
    squared_length,
)
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import LARGEST_EXPONENT

MAGNUS_ORDER = 4  # order of Exp(xi) m for xi = M_0 - [M_0, M_1] and the true exponential
SECOND_ORDER = 2  # the same for any other Exp, which agrees with the true one through order 2
EVEN = 2.0  # a term of a Taylor series is at most this, in units of what it is if the series converges evenly
SHARP_ORDER = 12  # order from which on a series is mostly so near the orbit that it is landed by one map
MIN_DEFAULT_ORDER, MAX_DEFAULT_ORDER = 4, 24  # bounds for the order that follows from a tolerance


@final
@dataclass(frozen=True)
class Taylor(Step):
    """The Taylor series of the trajectory, of any order n, landed on the orbit.

    Parameters
    ----------
    n : int
        The order, at least 1.

    Notes
    -----
    The series of the trajectory costs n (n + 1) / 2 actions rho(psi_i) m_k, and no bracket. How it is landed on the
    orbit follows from the orbit (theory/taylor).

    * By projection onto level sets of invariant quadratic forms, if the orbit is open in them. Spheres, hyperboloids,
      light cones and their products are such orbits. The levels are those at the start of the run.
    * By nothing, if the orbit is open in V, or in V up to constant coordinates.
    * By an equivariant polynomial map that leaves the points of the orbit where they are and moves points next to it
      much closer, repeated. It is found from invariants of degree 2 to 5. Orbits of matrices with given eigenvalues,
      projective spaces, Grassmannians, Stiefel manifolds and coadjoint orbits of rigid motions are such orbits.
    * Otherwise by two exponentials, Exp(eta) Exp(xi) m. Here xi is the Magnus series of order 4 of the psi_i, and eta
      is the generator of minimal norm that moves Exp(xi) m to the series, in ceil((n + 1) / 5) - 1 iterations.

    An adaptive step size follows from the last two coefficients: the terms m_(n-1) h^(n-1) and m_n h^n are at most the
    tolerance, which is then far above what is left out. These coefficients are those at the initial point of the step,
    so psi is looked at within the step before it is taken (`looks` of `liehom.integrate`, docs/step-sizes.md).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8], step=lh.Taylor(12), dt=0.5)
    >>> bool(abs(np.linalg.norm(sol.y[:, -1]) - 1) < 1e-15)
    True
    """

    n: int
    _prepared: ClassVar[bool] = False
    _landing: ClassVar[Quadrics | InvariantLanding | None] = None  # of `prepare`; None is by exponentials

    def __post_init__(self) -> None:
        checked_integer(self.n, "the order of a Taylor step")

    @classmethod
    def for_tolerance(cls, tolerance: float) -> Taylor:
        """The step of the order 1 - ln(tolerance) / 2, rounded up: the cheapest one at this relative tolerance.

        The size of a step is about the radius of convergence rho of the series times tolerance^(1/n), and its cost is
        about n^2. The order minimizes n^2 / tolerance^(1/n), up to the rounding.

        Parameters
        ----------
        tolerance : float
            The order is between 4 and 24.

        Examples
        --------
        >>> Taylor.for_tolerance(1e-6), Taylor.for_tolerance(1e-12)
        (Taylor(n=8), Taylor(n=15))
        """
        n = ceil(1 - log(tolerance) / 2) if tolerance > 0 else MAX_DEFAULT_ORDER
        return cls(min(max(n, MIN_DEFAULT_ORDER), MAX_DEFAULT_ORDER))

    @property
    def order(self) -> int:
        return int(self.n)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if not self._prepared:
            return self.prepare(action, psi, m, t).at(action, psi, m, t, error_terms=error_terms)
        flow = _flow(psi.field, m, self.order, t[..., 0] if np.ndim(t) else t)
        points = [flow.point(k) for k in range(1, self.order + 1)]
        velocity = [flow.psi(k) for k in range(self.order)]
        if error_terms and isinstance(m, np.ndarray):  # psi = sqrt(t) has no derivative at 0, and steps by tolerance
            points, velocity = _finite(points), _finite(velocity)
        if isinstance(self._landing, Quadrics):
            return ProjectedSeries(action, m, points, self._landing, psi.start)
        landed = LandedSeries(action, m, points, velocity, psi.orbit_dimension)
        return landed if self._landing is None else InvariantSeries(landed, self._landing, psi.start)

    @property
    def trace_key(self) -> Hashable:
        """How points are landed."""
        return self._prepared, type(self._landing), getattr(self._landing, "key", None)

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Taylor:
        """The step with the landing on the orbits of a run."""
        start: Any = psi.start if psi.start is not None else m
        points = np.zeros((0, m.shape[-1])) if is_traced(start) else np.asarray(start)
        landing: Any = quadric_orbits(action.representation, psi.orbit_dimension, points)
        dimensions = np.unique(psi.orbit_dimension)
        if landing is None and len(dimensions) == 1 and points.dtype.kind == "f":
            landing = invariant_landing(action.representation, int(dimensions[0]), points)
        return self.with_prepared(_prepared=True, _landing=landing)


class TaylorSeries(LocalStep):
    """The Taylor polynomial of the trajectory at one point, next to the orbit."""

    def __init__(self, action: Action, m: Values, coefficients: Sequence[Values]) -> None:
        super().__init__(action, m)
        self.trajectory = coefficients

    def size(self, limits: StepLimits) -> Array:
        """Largest size (...,) at which the last two terms, and those of the upper half of the orders as the last may
        vanish, are within the error that is allowed, and at most a tenth of the length |X| h of the step. With an error
        of |m| theta^n a term of order k is at most `EVEN` |m| theta^k, k/n rounded down to eighths.
        """
        n, axes = len(self.trajectory), limits.axes
        xp, first = namespace(limits.largest, limits.speed), max(n // 2, 1)
        squares = [squared_length(x, axes) for x in self.trajectory[first - 1 :]]
        error: Any = coarse("coarse_log2", limits.allowed)
        way: Any = xp.where(limits.speed > 0, coarse("coarse_log2", SERIES_FRACTION * limits.speed), np.inf)
        size: Any = 0.5 * coarse("coarse_log2", squared_length(self.m, axes))
        # log2 h is at most the least of these, by |m_k| h^j <= bound; terms of high order come last, as they are known
        least: Any = xp.where(limits.allowed + limits.speed < np.inf, LARGEST_EXPONENT, np.nan)
        for k, square in enumerate(squares, first):
            log: Any = coarse("coarse_log2", square)
            bound = error
            if k < n - 1:
                share = 8 * k // n / 8
                bound = size * (1 - share) + (error * share + log2(EVEN))
            allows = bound * (1 / k) - log * (0.5 / k)
            if k >= n - 1 and n > 3:
                allows = _lesser(xp, allows, way * (1 / (k - 1)) - log * (0.5 / (k - 1)))
            least = _lesser(xp, xp.where(square == 0, LARGEST_EXPONENT, allows), least)
        return _lesser(xp, limits.largest, coarse("coarse_exp2", least))

    def series(self, h: Values) -> Values:
        """m_0 + m_1 h + ... + m_n h^n for h of shape (..., 1), shape (..., N)."""
        return series_at(self.m, self.trajectory, h)


@final
class ProjectedSeries(TaylorSeries):
    """The Taylor polynomial, projected onto level sets of quadratic forms."""

    looks_ahead = True

    def __init__(
        self, action: Action, m: Values, coefficients: Sequence[Values], quadrics: Quadrics, start: Values | None
    ) -> None:
        super().__init__(action, m, coefficients)
        self._quadrics, self._numbers = quadrics, _numbers(quadrics, m, start)

    def point(self, h: Values) -> Values:
        """Point after the step of size h (..., 1), shape (..., N)."""
        return self._landed(self.series(h))

    def look(self, h: Values, time: Values) -> tuple[Values, Values]:
        point, velocity = super().look(h, time)
        return self._landed(point), velocity

    def _landed(self, point: Values) -> Values:
        return self._quadrics.project(point, self._numbers) if self._numbers else point


@final
class LandedSeries(TaylorSeries):
    """The Taylor polynomial m~(h), landed on the orbit by exponentials: Exp(eta(h)) Exp(xi(h)) m."""

    def __init__(
        self,
        action: Action,
        m: Values,
        coefficients: Sequence[Values],
        velocity: Sequence[Values],
        orbit_dimension: int | IntegerArray,
    ) -> None:
        super().__init__(action, m, coefficients)
        self._dimension, self._velocity = orbit_dimension, velocity
        magnus = MAGNUS_ORDER if isinstance(action.exponential, TrueExponential) else SECOND_ORDER
        # corrections of eta: with q - 1 the order of Exp(xi(h)) m, the error is O(h^(q (j + 1))) after j of them
        self.iterations: int = ceil((len(coefficients) + 1) / (magnus + 1)) - 1

    def generator(self, h: Values) -> Values:
        """xi(h) = M_0 - [M_0, M_1] for h of shape (..., 1), shape (..., dim g)."""
        psi = self._velocity
        mean = polynomial([None, *(x / (k + 1) for k, x in enumerate(psi))], h)
        if len(psi) == 1:
            return mean
        weights = [1 / (k + 2) - 1 / (2 * (k + 1)) for k in range(1, len(psi))]
        moment = polynomial([None, *(w * x for w, x in zip(weights, psi[1:], strict=True))], h) * h
        return mean - self.action.bracket(mean, moment)

    def point(self, h: Values) -> Values:
        """Point after the step of size h (..., 1), shape (..., N)."""
        if isinstance(h, Jet):
            raise InputError("the landing of a Taylor step on these orbits is not expanded in h: correct LieTaylor")
        near = self.action.act(self.generator(h), self.m)
        if not self.iterations:
            return near
        wanted, frame = self.series(h), self.action.isotropy_frame(near, self._dimension)
        eta, landed = None, near
        for _ in range(self.iterations):
            change = least_generator(frame, wanted - landed)
            eta = change if eta is None else eta + change
            landed = self.action.act(eta, near)
        return landed


@final
class InvariantSeries(TaylorSeries):
    """The Taylor polynomial, landed on the orbit by an equivariant map, or from far away by exponentials."""

    def __init__(self, far: LandedSeries, landing: InvariantLanding, start: Values | None) -> None:
        super().__init__(far.action, far.m, far.trajectory)
        self._far, self._landing = far, landing
        self._landed = LastSize(self._at)
        self._numbers = _numbers(landing, self.m, start)

    def point(self, h: Values) -> Values:
        """Point after the step of size h (..., 1), shape (..., N)."""
        landed, near = self._landed(h)
        if not isinstance(near, np.ndarray | np.bool_) or near.all():
            return landed
        return np.where(near[..., None], landed, self._far.point(h))

    def valid(self, h: Values) -> Values | bool:
        """Whether the landing is that of a point near the orbit, on tracers; arrays are landed from anywhere."""
        near = self._landed(h)[1]
        return True if isinstance(near, np.ndarray | np.bool_) else near

    def _at(self, h: Values) -> tuple[Values, Values | BooleanArray]:
        """The point after a step of size h, and whether it is that of the orbit."""
        return self._landing.landed(self.series(h), self._numbers, 1 if len(self.trajectory) >= SHARP_ORDER else 2)


def _flow(field: GeneratorField, m: Values, order: int, t: Values) -> Flow | AffineFlow:
    """The expansion of the flow: of a traced one in fewer operations, which wait less for each other, if psi allows."""
    if isinstance(m, Traced) and not field.time_dependent and m.tape.least_loop is None:
        before = m.tape.calls
        known = affine_flow(m, Traced(m.tape, field.psi(m)), field.infinitesimal, order)
        if known is not None:
            return known
        m.tape.calls = before
    return flow_series(field, m, order, t)


def _lesser(xp: ModuleType, a: Values, b: Values) -> Array:
    """The lesser of two numbers; b if one of them is NaN."""
    return xp.where(a < b, a, b)


def _finite(coefficients: list[Values]) -> list[Values]:
    """The coefficients (..., N) of series, which end before the first one that is not finite."""
    last: Any = coefficients[-1]
    if np.isfinite(last).all():  # after a coefficient that is not finite none is
        return coefficients
    good: Any = True
    ended: list[Any] = []
    for c in coefficients:
        good = good & np.isfinite(c).all(axis=-1, keepdims=True) if ended else True
        ended.append(np.where(good, c, 0.0))
    return ended


def _numbers(landing: Quadrics | InvariantLanding, m: Values, start: Values | None) -> Sequence[Values]:
    """The numbers of the orbits, in compiled code computed once for each trajectory."""
    if isinstance(m, Traced):
        count = len(landing.numbers(np.ones((1, m.shape[-1]))))
        functions = [lambda points, i=i: landing.numbers(points)[i] for i in range(count)]
        return [Traced(m.tape, m.tape.trajectory_constant(f)) for f in functions]
    return landing.numbers(m if start is None else start)
