"""Conserving: a step that conserves first integrals by isotropy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.base.errors import InputError, TraceError, checked_integer
from liehom.base.typing import Array, BooleanArray, IntegerArray, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.series.arrays import is_exact, is_jax, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.steps.corrected import round_off
from liehom.flow.steps.expansion import ROUND_OFF_UNITS, Flow, flow_series
from liehom.flow.steps.first_integral import (
    RANK_RTOL,
    Conservation,
    FirstIntegral,
    IntegralSource,
    combination,
    conditioning,
)
from liehom.flow.steps.step import (
    Derived,
    Diagnostics,
    ExponentialLike,
    Factors,
    Generator,
    LastSize,
    LocalStep,
    Step,
    StepLike,
    StepLimits,
    as_step,
    length,
    moved_by_isotropy,
    polynomial,
    read_point,
    step_variable,
    with_correction,
    zero_series,
)
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop

# Newton's method for the isotropy that puts a step on a level set of first integrals (Proposition 10). The unknown is
# an element x of V_m, the complement of ker chi_m in g_m. The first Jacobian is that of Corollary 11 along the step, e
# DF(m) rho(x) (step - m). Broyden's updates correct it by the differences observed, which for one integral is the
# secant method. Residuals are measured in units of the round-off of F.

MAX_ITERATIONS = 20
MAX_STALLED_ITERATIONS = 2  # the iteration ends after this many iterations that did not reduce the residual
MIN_RESOLVED_UNITS = 32.0
"""A direction along which one radian changes F by less than this many units of round-off is not used: near an
equilibrium F does not resolve the orbits."""


@final
@dataclass(frozen=True, slots=True)
class LevelSolution:
    """The isotropy that Newton's method adds."""

    x: Values | None  # (..., dim g); None if it is 0 in all trajectories
    residual: Values  # F - target with this x, (..., k)
    iterations: Values
    resolved: Values  # in how many directions F resolves the change by isotropy, (...,)


def solve_levels(
    residual: Callable[[Any], Any], first: Values, directions: Values, jacobian: Values, unit: Values, size: float
) -> LevelSolution:
    """Proposition 10 with V_m = (ker chi_m)^perp: x in the span of `directions` with residual(x) = 0 to round-off,
    without the equations that isotropy does not reach.
    """
    units: Any = np.maximum(unit, float(np.finfo(first.dtype).tiny))
    if jacobian.shape[-2:] == (1, 1):
        return _of_one(residual, first[..., 0], directions[..., 0], jacobian[..., 0, 0], units[..., 0], size)
    slope: Any = jacobian
    project, lift, slopes, kept = _reduced(slope / units[..., None], MIN_RESOLVED_UNITS * size)
    resolved = kept.sum(axis=-1)
    r = (project @ (first / units)[..., None])[..., 0]
    active = np.abs(r).max(axis=-1, initial=0.0) > 1
    iterations = np.zeros(active.shape, dtype=int)
    if not active.any():
        return LevelSolution(None, first, iterations, resolved)
    turn = directions @ lift
    inverse = np.where(kept, 1 / np.where(kept, slopes, 1.0), 0.0)[..., None] * np.eye(kept.shape[-1], dtype=r.dtype)
    c, left, stalled = 0 * r, first, 0 * iterations
    for _ in range(MAX_ITERATIONS):
        step = _limited(-(inverse @ r[..., None])[..., 0], 1 / size) * active[..., None]
        value = residual((turn @ (c + step)[..., None])[..., 0])
        reduced = (project @ (value / units)[..., None])[..., 0]
        iterations = iterations + active
        inverse = _updated(inverse, step, reduced - r)
        better = active & (_square(reduced) < _square(r))
        c, r = np.where(better[..., None], c + step, c), np.where(better[..., None], reduced, r)
        left = np.where(better[..., None], value, left)
        stalled = np.where(better, stalled, stalled + 1)
        active = active & (np.abs(r).max(axis=-1) > 1) & (stalled < MAX_STALLED_ITERATIONS)
        if not active.any():
            break
    return LevelSolution((turn @ c[..., None])[..., 0], left, iterations, resolved)


def _of_one(
    residual: Callable[[Any], Any], first: Values, direction: Values, slope: Values, unit: Values, size: float
) -> LevelSolution:
    """`solve_levels` for one integral and one direction, by the secant method; on tracers in each lane separately."""
    resolved = np.abs(slope) > MIN_RESOLVED_UNITS * size * unit
    active: Any = resolved & (np.abs(first) > unit)
    if not isinstance(active, Traced) and not active.any():
        return LevelSolution(None, first[..., None], np.zeros(active.shape, dtype=int), resolved.astype(int))

    def iteration(
        active: Values, c: Values, best: Values, over: Values, stalled: Values, count: Values
    ) -> tuple[list[Values], Values]:
        # 1 / slope is kept, which needs one division less
        step = np.clip(-best * over, -1 / size, 1 / size)
        value = residual((c + step)[..., None] * direction)[..., 0]
        change = value - best
        better = active & (np.abs(value) < np.abs(best))
        clear = np.abs(change * over) > 1e-3 * np.abs(step)
        over = np.where(clear, step / np.where(clear, change, 1.0), over)
        c, best = np.where(better, c + step, c), np.where(better, value, best)
        stalled = np.where(better, stalled, stalled + 1.0)
        count = count + np.where(active, 1.0, 0.0)
        active = active & (np.abs(best) > unit) & (stalled < MAX_STALLED_ITERATIONS)
        return [active, c, best, over, stalled, count], active

    zero = np.zeros(np.shape(first))
    state: list[Any] = [active, zero, first, 1.0 / np.where(resolved, slope, 1.0), zero, zero]
    if isinstance(active, Traced):
        state = list(while_loop(iteration, state, active.tape, MAX_ITERATIONS))
        return LevelSolution(state[1] * direction, state[2][None], state[5], np.where(resolved, 1, 0))
    for _ in range(MAX_ITERATIONS):
        state, _active = iteration(*state)
        if not state[0].any():
            break
    return LevelSolution(
        state[1][..., None] * direction, state[2][..., None], state[5].astype(int), resolved.astype(int)
    )


def _reduced(jacobian: Array, cutoff: float) -> tuple[Array, Array, Array, BooleanArray]:
    """(U^T, V, S, mask of the singular values above the cutoff) of a singular value decomposition."""
    left, slopes, right = np.linalg.svd(np.nan_to_num(np.asarray(jacobian, dtype=np.float64)), full_matrices=False)
    kept = (slopes > cutoff) & (slopes > RANK_RTOL * slopes[..., :1])
    project, lift = np.swapaxes(left * kept[..., None, :], -1, -2), np.swapaxes(right * kept[..., None], -1, -2)
    return project.astype(jacobian.dtype), lift.astype(jacobian.dtype), slopes.astype(jacobian.dtype), kept


def _limited(step: Array, largest: float) -> Array:
    """step, shortened to norm at most `largest`; 0 where it is not finite."""
    norm = np.sqrt(_square(step))[..., None]
    step = np.where(norm > largest, step * (largest / np.where(norm > 0, norm, 1.0)), step)
    return np.where(np.isfinite(norm), step, 0.0)


def _updated(inverse: Array, step: Array, change: Array) -> Array:
    """Inverse Jacobian after Broyden's update, which maps `change` of the residual to `step`."""
    moved = (inverse @ change[..., None])[..., 0]
    row = (step[..., None, :] @ inverse)[..., 0, :]
    along = (step * moved).sum(axis=-1)[..., None, None]
    good = np.isfinite(along) & (np.abs(along) > 1e-3 * _square(step)[..., None, None])
    return inverse + np.where(good, (step - moved)[..., :, None] * row[..., None, :] / np.where(good, along, 1.0), 0.0)


def _square(x: Array) -> Array:
    return (x * x).sum(axis=-1)


CONSERVED_ROUNDOFFS = 32.0  # F counts as conserved up to this many units of its round-off
TOLERATED_UNITS = 0.5  # residuals of F within this many units of round-off, eps times `Conservation.scale`, count as 0


class _Made(NamedTuple):
    """The step of one size: its isotropy, its point and its diagnostics."""

    zeta: Values | None
    point: Values
    numbers: Diagnostics


@final
class ConservingStep(LocalStep):
    """A conserving step at one point, by chi_m, and the value (..., k) at which F is to be, or None for F(m)."""

    def __init__(self, base: LocalStep, found: Conservation, target: Values | None, *, one_exponential: bool) -> None:
        super().__init__(base.action, base.m, clock=base.clock)
        self.base, self.found = base, found
        self.estimate_order, self.widest_gap, self.trajectory = base.estimate_order, base.widest_gap, base.trajectory
        self._target = found.value if target is None else target
        self._one = one_exponential
        self._unit = TOLERATED_UNITS * float(np.finfo(found.m.dtype).eps) * found.scale
        self._made = LastSize(self._corrected)

    @property
    def has_factors(self) -> bool:
        """Whether the base is a product of exponentials."""
        return self.base.has_factors

    def factors(self, h: Values) -> Factors:
        return with_correction(self.base.factors(h), self._isotropy(h), self._one)

    def point(self, h: Values) -> Values:
        if isinstance(h, Jet):
            return moved_by_isotropy(self.base, h, self._series(h), self._one)
        return self._made(h).point

    def size(self, limits: StepLimits) -> Values | None:
        return self.base.size(limits)

    def look(self, h: Values, time: Values) -> tuple[Values, Values]:
        return self.base.look(h, time) if self.base.trajectory else super().look(h, time)

    def estimate(self, h: Values) -> Values:
        return self.base.estimate(h)

    def valid(self, h: Values) -> Values | bool:
        return self.base.valid(h)

    def departure(self, h: Values) -> Values | None:
        return self.base.departure(h)

    def diagnostics(self, h: Values) -> Diagnostics:
        """Numbers of the base, and of the conservation with the prefix ``"conservation_"``.

        "defect" is the largest |F_i(step) - target_i|, "missed" says whether it is more than round-off, "left" whether
        the step has no correction, at or near an equilibrium or for h = 0, and "short" whether chi_m is not onto.
        Compiled code makes no step at which it is not.
        """
        numbers = self._made(h).numbers
        return {**self.base.diagnostics(h), **{f"conservation_{name}": x for name, x in numbers.items()}}

    def detail(self, name: str, index: tuple[int, ...]) -> Array | None:
        """For "conservation_short", the combinations of integrals that isotropy does not reach, shape (j, k)."""
        return self.found.unreachable(index) if name == "conservation_short" else self.base.detail(name, index)

    def is_near_cone(self, h: Values) -> BooleanArray:
        return self.base.is_near_cone(h)

    def _isotropy(self, h: Values) -> Values | None:
        return self._series(h) if isinstance(h, Jet) else self._made(h).zeta

    def _corrected(self, h: Values) -> _Made:
        found, action, m = self.found, self.found.action, self.found.m
        xi = self.base.factors(h)[0] if self._one else None
        z = self.base.point(h) if xi is None else action.act(xi, m)

        def moved(x: Values) -> Values:
            return action.act(x, z) if xi is None else action.act(xi + x, m)

        def residual(x: Values) -> Values:
            return found.integral(moved(x)) - self._target

        first = found.integral(z) - self._target
        if type(m) is Traced:
            found.needs_motion(z - m)
        elif not found.moving.all():
            found = found.toward(z - m)
        directions = found.directions
        jacobian = found.along(z - m, directions)
        solution = solve_levels(residual, first, directions, jacobian, self._unit, action.max_norm)
        x, resolved, left = solution.x, solution.resolved, solution.residual
        defect = np.abs(left)
        units = (defect / np.maximum(self._unit, float(np.finfo(defect.dtype).tiny))).max(axis=-1)
        rank, wanted = found.rank, found.wanted
        alone = (resolved < rank) | ~found.moving | (wanted == 0)
        numbers: Diagnostics = {
            "iterations": (solution.iterations, "max"),
            "defect": (defect.max(axis=-1), "max"),
            "missed": (units > CONSERVED_ROUNDOFFS, "sum"),
            "left": (alone, "sum"),
            "rank": (np.where(alone, np.inf, rank), "min"),
            "wanted": (np.where(alone, 0, wanted), "max"),
        }
        if isinstance(h, Traced):
            onto: Any = alone | (rank >= wanted)
            h.tape.required.append(Traced(h.tape, onto).entry)
        else:
            numbers["short"] = ~alone & (rank < wanted), "sum"
        return _Made(x, z if x is None else moved(x), numbers)

    def _removing(self, along: Jet, z: Jet, k: int) -> Values:
        """The zeta in V_m with chi_m(zeta) = -[t^k] F along the step z."""
        value, m = along.coefficient(k), self.found.m
        size = np.maximum(length(m), np.finfo(float).tiny)
        rate = 0.0 * size
        for j in range(1, k + 1):
            rate = np.maximum(rate, (length(z.coefficient(j)) / size) ** (1 / j))
        noise = ROUND_OFF_UNITS * np.finfo(m.dtype).eps * self.found.scale * rate[..., None] ** k
        return -self.found.preimage(np.where(np.abs(value) > noise, value, 0.0))

    def _series(self, h: Jet) -> Jet | None:
        """The isotropy as a Jet in h that conserves F(m) to its order; None if that is 1."""
        total, found = h.order, self.found
        if total < 2:
            return None
        m = found.m
        zeta = zero_series(zeros(m, (*m.shape[:-1], found.dimension)), total)
        z: Any = moved_by_isotropy(self.base, step_variable(total, m), zeta, self._one)
        along: Any = found.integral(z)
        for k in range(2, total + 1):
            zeta.replace(k - 1, self._removing(along, z, k), along, z)
        return polynomial(zeta.node.known, h)


# The order to which a step conserves a first integral at a point (Definition 9), by expanding F along the step.
#     F(step(t)) - F(m) = E_n t^n + E_(n+1) t^(n+1) + ...,    conserved to order n - 1
# At exact points the coefficients E_n are exact.

EXTRA_ORDERS = 4  # default number of coefficients beyond the order of the step that are computed


@final
@dataclass(frozen=True, slots=True)
class ConservedOrder:
    """Order to which a step conserves F, at one or several points.

    Attributes
    ----------
    order : int or array of shape (...,)
        The largest p, up to `bound`, with F(step(t)) - F(m) = O(t^(p+1)).
    coefficients : tuple
        E_0, ..., E_bound, the Taylor coefficients of F(step(t)) - F(m): arrays of shape (...,), or (..., k) if F is
        a list. E_n with n = order + 1 is the first that is not 0.
    bound : int
        Index of the last coefficient that was computed.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> print(conserved_order(field, lh.Euler(), [1.0, 0.0], "m0**2 + m1**2"))
    conserved to order 5 at least
    """

    order: int | IntegerArray
    coefficients: tuple[Values, ...]
    bound: int

    def __str__(self) -> str:
        order = int(np.min(self.order))
        return f"conserved to order {order}" + (" at least" if order == self.bound else "")


def conserved_order(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    F: IntegralSource,
    *,
    up_to: int | None = None,
    t: Real = 0,
    exponential: ExponentialLike = "exp",
) -> ConservedOrder:
    """`ConservedOrder`: the order to which a step conserves a first integral, with the coefficients E_n.

    Parameters
    ----------
    field : GeneratorField
    step : Step
    m : array_like of shape (..., N)
        Floats, or exact numbers of the representation's field in an array of objects; E_n is then exact.
    F : callable, string, sympy expression or list of these
        See `FirstIntegral`.
    up_to : int, optional
        Index of the last coefficient to compute (default: the order of the step plus 4).
    t : number or array of shape (...,)
    exponential : str, Exponential or callable

    Notes
    -----
    Definition 9 of the paper: F is conserved to order n - 1 if F(step(t)) - F(m) = O(t^n). The coefficients
    come from the expansion of the step in its size.

    Examples
    --------
    Heun's step of the free rigid body conserves the energy to order 3, its own order plus 1:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    >>> m = np.array([lh.QQ.convert(x) for x in ["3/5", "12/25", "16/25"]])
    >>> result = conserved_order(field, lh.Heun(), m, "m0**2/2 + m1**2/4 + m2**2/8")
    >>> result.order, result.coefficients[4]
    (3, 100899/25000000)
    """
    bound = step.order + EXTRA_ORDERS if up_to is None else checked_integer(up_to, "up_to")
    point, dimension = read_point(field.representation, m)
    integral = FirstIntegral(F, field.representation.size)
    action = Action(field.representation, exponential)
    flow = flow_series(field, point, bound, t)
    integral.check(flow, bound)
    local = step.at(action, Generator(field, dimension), point, np.asarray(t)[..., None])
    coefficients = expanded(integral, local, bound)
    noise = None if is_exact(point) else round_off_of(action, integral, flow, local, point, bound)
    order = agreement(coefficients, noise)
    return ConservedOrder(order if order.ndim else int(order), tuple(integral.squeezed(x) for x in coefficients), bound)


def agreement(coefficients: list[Array], noise: list[Array] | None) -> IntegerArray:
    """The largest p with E_1 = ... = E_p = 0, shape (...,), exactly or up to the noise given."""
    bound = len(coefficients) - 1
    order = np.full(np.shape(coefficients[0])[:-1], bound)
    for k in range(bound, 0, -1):
        value = np.asarray(coefficients[k])
        some = np.asarray(value != 0, dtype=bool) if noise is None else ~(np.abs(value) <= noise[k])
        order = np.where(some.any(axis=-1), k - 1, order)
    return order


def expanded(integral: FirstIntegral, local: LocalStep, bound: int) -> list[Array]:
    """List of E_0, ..., E_bound, arrays of shape (..., k)."""
    series: Any = integral(local.point(step_variable(bound, local.m)))
    if not isinstance(series, Jet):
        return [0 * series] * (bound + 1)
    return [0 * series.coefficient(0), *[series.coefficient(k) for k in range(1, bound + 1)]]


def round_off_of(
    action: Action, integral: FirstIntegral, flow: Flow, local: LocalStep, m: Values, bound: int
) -> list[Array]:
    """List of bounds of the round-off in E_0, ..., E_bound, arrays of shape (..., k)."""
    eps = np.finfo(m.dtype).eps
    scale = conditioning(*integral.gradient(m), m)
    size = np.linalg.norm(np.asarray(m, dtype=float), axis=-1)
    factors: Any = local.factors(step_variable(bound, m)) if local.has_factors else None
    rate, noise = 0.0 * size, [ROUND_OFF_UNITS * eps * scale]
    for k in range(1, bound + 1):
        term = round_off(action, m, flow, factors, k) / (ROUND_OFF_UNITS * eps * size)
        rate = np.maximum(rate, term ** (1 / k))
        noise.append(4 * ROUND_OFF_UNITS * eps * scale * rate[..., None] ** k)
    return noise


# Conserving(step, F) conserves first integrals by isotropy, to round-off.
#     m -> Exp(xi(m, t) + t^(n-1) sigma) m,    sigma in g_m,    F(step) = F(start of the run)         (7.2), (7.6)
# Here n - 1 is the order to which the base step conserves F. sigma is in V_m, the complement of ker chi_m in g_m. See
# section 7 of the paper.

AIMS = ("start", "previous")
EXTRA_POINTS = 2
TIME_SHIFT = 0.01


@final
class Conserving(Derived):
    """A step that adds t^(n-1) sigma, sigma in g_m, to its generator, so that first integrals keep their values.

    Parameters
    ----------
    step : Step or str
        The base, of any kind, or its name.
    F : callable, string, sympy expression or list of these
        The first integral, or k of them: see `FirstIntegral`.
    aim : "start" or "previous"
        The target: the value of F at the initial point of the run, so that round-off does not add up, or at the point
        before the step.
    value : float or array of shape (..., k), optional
        The target, in place of the value of F at the initial point.

    Notes
    -----
    Proposition 10 of the paper. Newton's method starts at the solution of chi_m(sigma_0) = -E_n up to higher order (E_n
    need not vanish, unlike its proof says). At an equilibrium
    chi_m = 0, and the step is the base step; likewise if F does not resolve the orbits at the precision of the numbers.
    If chi_m loses rank along a trajectory, large steps of low order may not be able to reach the level set; the report
    counts the steps that miss it. The order as a method for trajectories is the order of the base.

    Examples
    --------
    The energy of the free rigid body by Heun's step:

    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.flow.steps import Conserving
    >>> w, m = np.array([1.0, 0.5, 0.25]), np.array([0.6, 0.48, 0.64])
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * w)
    >>> energy = lambda m: np.sum(m * m * w, axis=-1) / 2
    >>> sol = lh.integrate(field, (0, 20), m, step=Conserving(lh.Heun(), energy), dt=0.1)
    >>> bool(np.abs(energy(sol.y.T) - energy(m)).max() < 1e-15)
    True
    """

    _begun: _Begun | None = None  # of `prepare`

    def __init__(
        self,
        step: StepLike,
        F: IntegralSource,
        *,
        aim: str = "start",
        value: ArrayLike | None = None,
    ) -> None:
        step = as_step(step)
        if isinstance(step, Conserving):
            raise InputError("the step conserves something already: give its base and a list of all integrals")
        if aim not in AIMS:
            raise InputError(f"aim is {aim!r}, expected one of {', '.join(map(repr, AIMS))}")
        if value is not None and aim == "previous":
            raise InputError("the step aims at the previous point: leave out the value")
        self.step, self.aim = step, aim
        self._source = F
        self._value = None if value is None else np.asarray(value, dtype=float)

    @property
    def order(self) -> int:
        return self.step.order

    @property
    def base_order(self) -> int:
        """`base_order` of the base, an int."""
        return self.step.base_order

    uses_isotropy = True

    prepares_by_psi = True

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Conserving:
        """The step with the checked first integrals and their target values, for a run from m at times t."""
        made = self.with_prepared(step=self.step.prepare(action, psi, m, t))
        return made.with_prepared(_begun=_Begun(made, action, psi, m, t))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> ConservingStep:
        if is_jax(m) or is_exact(m):
            raise InputError("a conserving step iterates to round-off, on numpy arrays of floats only")
        time = t[..., 0] if np.ndim(t) else t
        if self._begun is None:
            return self.prepare(action, psi, m, time).at(action, psi, m, t, error_terms=error_terms)
        known = self._begun
        local = self.step.at(action, psi, m, t, error_terms=error_terms)
        frame = action.isotropy_frame(m, psi.orbit_dimension)
        factor = 0.5 if self.one_exponential else 1.0
        chi = Conservation(action, known.integral, frame, m, psi.field.psi(m, time), factor)
        target = known.target
        if type(m) is Traced:
            target = self._target(known.integral, m)
        elif psi.start is not None and psi.start is not known.start:  # some trajectories of the run
            target = self._target(known.integral, psi.start)
        return ConservingStep(local, chi, target, one_exponential=self.one_exponential)

    def _target(self, integral: FirstIntegral, start: Values) -> Values | None:
        """The values of F at which trajectories from these points aim; None for F(m)."""
        if self.aim == "previous":
            return None
        if isinstance(start, Traced) and self._value is None:  # a number of each trajectory
            return Traced(start.tape, [start.tape.trajectory_constant(lambda points: integral(points)[..., 0])])
        if isinstance(start, Traced) and self._value is not None and self._value.size > 1:
            raise TraceError("a value of F for each trajectory is not compiled: give one, or leave it to the start")
        value = integral(start)
        return value if self._value is None else _aimed_at(self._value, value)

    def __repr__(self) -> str:
        source = repr(self._source) if isinstance(self._source, str) else _shown(self._source)
        options = "" if self.aim == "start" else f", aim={self.aim!r}"
        options += "" if self._value is None else f", value={self._value.tolist()}"
        return f"Conserving({self.step!r}, {source}{options})"


def _shown(source: IntegralSource) -> str:
    if callable(source):
        return str(getattr(source, "__qualname__", type(source).__name__))
    return str([str(x) for x in source] if np.iterable(source) else source)


@final
class _Begun:
    """Data of a conserving step for a run: the first integral, checked, and its target value."""

    def __init__(self, step: Conserving, action: Action, psi: Generator, m: Values, t: Values) -> None:
        self.start, start = psi.start, m if psi.start is None else psi.start
        self.integral = FirstIntegral(step._source, action.representation.size)
        self.target: Any = None
        if type(m) is Traced:  # without a run
            return
        bound = step.order + 1
        self.integral.check(flow_series(psi.field, start, bound, t), bound)
        if psi.start is not None or step._value is not None:
            self.target = step._target(self.integral, start)
        self._explore(step, action, psi, start, t)

    def _explore(self, step: Conserving, action: Action, psi: Generator, start: Values, t: Values) -> None:
        """Check that chi is onto, at the initial points or near them, as symmetric points may mislead."""
        factor = 0.5 if step.one_exponential else 1.0
        short: Any = np.ones(start.shape[:-1], dtype=bool)
        first: Conservation | None = None
        for j in range(EXTRA_POINTS + 1):
            x = np.cos((1.0 + j) * np.arange(1, action.dimension + 1)) / (action.max_norm or 1.0)
            point = action.act(np.broadcast_to(x, (*start.shape[:-1], x.size)), start) if j else start
            point = point.astype(start.dtype, copy=False)
            time = t + TIME_SHIFT * j if psi.field.time_dependent else t
            usable = np.isfinite(point).all(axis=-1) & np.isfinite(psi.field.psi(point, time)).all(axis=-1)
            point = np.where(usable[..., None], point, start)
            frame = action.isotropy_frame(point, psi.orbit_dimension)
            chi = Conservation(action, self.integral, frame, point, psi.field.psi(point, time), factor)
            first = first or chi
            short = short & chi.moving & (chi.rank < chi.wanted)
            if not short.any():
                return
        if short.any() and first is not None:
            _refuse(first, tuple(int(i) for i in np.argwhere(short)[0]), np.broadcast_to(t, short.shape))


def _aimed_at(target: Array, value: Values) -> Values:
    try:
        wide = target[..., None] if target.ndim < value.ndim else target
        return np.broadcast_to(wide, value.shape).astype(value.dtype)
    except ValueError:
        raise InputError(f"the value has shape {target.shape}, F has shape {value.shape}") from None


def _refuse(chi: Conservation, index: tuple[int, ...], t: Values) -> None:
    names = ", ".join(combination(z) for z in chi.unreachable(index))
    rank, wanted = int(np.asarray(chi.rank)[index]), int(np.asarray(chi.wanted)[index])
    raise InputError(
        f"isotropy does not reach {names}: at m = {chi.m[index]}, t = {t[index]} chi_m has rank {rank}, and "
        f"{wanted} integrals are independent on the orbit (Proposition 10 asks for a chi_m that is onto). Conserve "
        "fewer integrals, or others"
    )
