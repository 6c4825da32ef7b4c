"""Corrected: a step raised to any order by isotropy, order by order."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from types import ModuleType
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.base.errors import InputError, checked_integer
from liehom.base.typing import BooleanArray, IntegerArray, Real, Values
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.action.space import Action, IsotropyFrame
from liehom.flow.series.arrays import as_values, is_exact, is_jax, is_lazy, is_traced, namespace, norm, zeros
from liehom.flow.steps.expansion import ROUND_OFF_UNITS, Clock, Flow, at_rest, flow_series, leading_order, vanishing
from liehom.flow.steps.range_solver import SMALLEST_SQUARE, RangeSolver, TightFrameSolver
from liehom.flow.steps.step import (
    Derived,
    Diagnostics,
    ExponentialLike,
    Factors,
    Generator,
    LocalStep,
    Step,
    StepLike,
    as_step,
    length,
    moved_by_isotropy,
    polynomial,
    series_at,
    step_variable,
    with_correction,
    zero_series,
)
from liehom.flow.tracing.array import Traced

# Corrections by terms of the flow's own generator, near zeros of a time-dependent field. Let w_l be the leading
# coefficient at (m, t). At orders n <= l isotropy does not enter. Let w_l be small compared with the later w_k, as
# shortly after a time at which the field vanishes. Then zeta and c are series in h / t_1 with
#     t_1 = min over k > l of (l |w_l| / (k |w_k|))^(1/(k-l)),    the time in which the velocity changes by itself,
# so they are useful only for steps h << t_1. Therefore t_1 is compared with the time scale 1/rate of the generator,
# rate = max_k |psi_k|^(1/(k+1)). Isotropy makes the fraction s(rate t_1) of each correction, where s = 0 up to 1/4, s =
# 1 from 1/2 on, and s is smooth between. The rest of the correction at order n is a term x t^n of the generator, as in
# a Taylor step, where rho(x) m is the remaining difference.

NO_ISOTROPY_UP_TO, ONLY_ISOTROPY_FROM = 1 / 4, 1 / 2
"""Values of rate t_1, without unit, between which the fraction of isotropy grows from 0 to 1."""
REFINEMENTS = 2


def isotropy_fraction(action: Action, flow: Flow, leading: int, order: int) -> Values:
    """Fraction s(rate t_1) of each correction that isotropy makes, shape (...,)."""
    xp = namespace(flow.points.value)
    first = leading * norm(flow.point(leading))
    scale: Any = xp.zeros_like(first) + np.inf
    for k in range(leading + 1, order + 1):
        later = k * norm(flow.point(k))
        ratio = xp.where(later > 0, first / xp.where(later > 0, later, 1.0), np.inf)
        scale = xp.minimum(scale, ratio ** (1 / (k - leading)))
    rate: Any = xp.zeros_like(first)
    for k in range(order):
        rate = xp.maximum(rate, generator_norm(action, flow.psi(k)) ** (1 / (k + 1)))
    moves = first * first > SMALLEST_SQUARE  # else rate and scale, which need squares, are not known
    product = xp.where(moves, rate * xp.minimum(scale, 1 / xp.where(moves, rate, 1.0)), 0.0)
    x = xp.clip((product - NO_ISOTROPY_UP_TO) / (ONLY_ISOTROPY_FROM - NO_ISOTROPY_UP_TO), 0.0, 1.0)
    return x * x * (3 - 2 * x)


def generator_norm(action: Action, x: Values) -> Values:
    """Upper bound of the norm of rho(x) for x (..., dim g), shape (...,)."""
    xp = namespace(x)
    square = xp.einsum("...a,ab,...b->...", x, xp.asarray(action.inner_product.matrix), x)
    return action.max_norm * xp.sqrt(xp.maximum(square, 0.0))


def lifted(action: Action, frame: IsotropyFrame, m: Values, tangent: Values) -> Values:
    """The smallest generator x with rho(x) m = a given tangent vector, shape (..., dim g)."""
    x = least_generator(frame, tangent)
    for _ in range(REFINEMENTS if tangent.dtype == np.longdouble else 0):  # the frame is of double precision
        x = x + least_generator(frame, tangent - action.infinitesimal(x, m))
    return x


def least_generator(frame: IsotropyFrame, v: Values) -> Values:
    """The smallest generator x with rho(x) m = the tangential part of v, shape (..., dim g)."""
    down = namespace(v).swapaxes(frame.tangent, -1, -2)
    return (frame.lift @ (down @ v[..., None]))[..., 0]


# The recursion over orders at a point, or at one point of each trajectory, that `correct` runs. At level n the
# corrected step agrees with F_tau through order n - 1. The difference r at order n is removed by zeta and c
# (`range_solver`), or by terms of the flow itself where isotropy does not enter (`completion`).

SOLVED_RTOL = 1e-6
VELOCITIES, AT_ONCE = 2, 4096  # for which a range condition is looked at before a run, and points in one array
LITTLE_ISOTROPY = 1 / 8  # a correction below this fraction of the way of a point counts as small


@final
@dataclass(frozen=True, slots=True)
class Part:
    """Trajectories with the same leading order, and their linear system."""

    leading: int  # l; larger than the order of the expansion if all coefficients of the flow vanish
    here: Values | None  # mask (...,); None for all
    solver: RangeSolver | TightFrameSolver | None  # None if isotropy enters at no order
    fraction: Values | None  # of a correction that isotropy makes, (...,); None is 1
    drift: Values | None = None  # rho(psi_1) m, by which w_1 changes in a frame that the flow carries; None if l > 1


@final
class OrderRecursion:
    """State of the recursion: zeta, a Jet (..., dim g), the clock, the remaining difference, and arrays (...,): leading
    is l, levels the last level that was solved (0 if none), residual the largest relative one.
    """

    def __init__(
        self,
        action: Action,
        flow: Flow,
        local: LocalStep,
        m: Values,
        *,
        orbit_dimension: int | IntegerArray,
        one_exponential: bool = True,
        weight: float | None = None,
    ) -> None:
        self.xp: ModuleType = namespace(m)
        self.action, self.m, self.flow = action, m, flow
        self.total = total = flow.points.order
        self.shape: tuple[int, ...] = tuple(m.shape[:-1])
        self.zeta = zero_series(self.xp.zeros((*self.shape, action.dimension), dtype=m.dtype), total)
        h = step_variable(total, m)
        self._factors = with_correction(local.factors(h), self.zeta, one_exponential) if local.has_factors else None
        self.step: Any = m if self._factors is not None else local.point(h)
        for x in self._factors or (self.zeta,):
            self.step = action.act(x, self.step)
        self.clock = Clock(flow, total, self.shape)
        self._orbit_dimension = orbit_dimension
        # tracers have no values; for them w_1 = 0 is handled by a fraction of 0
        if is_lazy(m):
            self.leading: Values = np.ones(self.shape, dtype=int)
        elif action.tight_frame is not None and not flow.time_dependent:
            self.leading = np.where(at_rest(action, flow), 0, 1)
        else:
            self.leading = leading_order(flow, total)
        # None stands for all trajectories, which saves masks
        self.active: Values | None = None
        self.moving: Values | None = None
        if is_lazy(m) and not flow.time_dependent:
            self.active = self.moving = ~(at_rest(action, flow) if type(m) is Traced else vanishing(flow, 1))
        elif not flow.time_dependent and not bool(np.all(self.leading)):
            self.active = self.leading > 0
        self.parts = self._split(0.5 if one_exponential else 1.0, weight)
        self.levels: Any = 0 * self.xp.asarray(self.leading)
        self.residual: Values = self.xp.zeros(self.shape, dtype=m.dtype)
        self.defects: list[tuple[int, Values]] = []

    @cached_property
    def frame(self) -> IsotropyFrame:
        """Isotropy frame at m, computed at first use (rarely, if there is a tight frame)."""
        return self.action.isotropy_frame(self.m, self._orbit_dimension)

    def _split(self, factor: float, weight: float | None) -> list[Part]:
        parts = []
        some = np.asarray(self.leading).flat[:1]
        alike = bool(np.all(self.leading == some))  # the common case
        for l in map(int, some if alike else np.unique(self.leading)):
            here = None if alike else self.leading == l
            if l == 0:
                if self.flow.time_dependent:
                    parts.append(Part(self.total + 1, here, None, None))
                continue
            velocity = _masked(self.xp, here, self.flow.point(l))
            solver: RangeSolver | TightFrameSolver
            if self.action.tight_frame is not None and not is_jax(self.m):
                solver = TightFrameSolver(self.action, self.m, self._orbit_dimension, velocity, l, factor, self.moving)
            else:
                solver = RangeSolver(self.action, self.frame, velocity, l, factor, weight)
            fraction = isotropy_fraction(self.action, self.flow, l, self.total) if self.flow.time_dependent else None
            if fraction is not None and not is_lazy(fraction) and bool(np.all(fraction == 1)):
                fraction = None
            drifts = l == 1 and self.total > 1 and type(solver) is RangeSolver
            drift = self.action.infinitesimal(self.flow.psi(1), self.m) if drifts else None
            parts.append(Part(l, here, solver, fraction, drift))
        return parts

    def level(self, n: int) -> None:
        """Make the step agree with F_tau at order n."""
        difference = self.difference(n)
        if self.active is not None and not all(isinstance(part.solver, TightFrameSolver) for part in self.parts):
            # where a lower order was not solved, what is left at this one is part of the error
            self.defects.append((n, self.xp.where(self.active, 0.0, norm(difference))))
        changed: dict[int, Values] = {}
        for part in self.parts:
            here = _both(self.active, part.here)
            if part.solver is None or n <= part.leading:
                self._complete(changed, n, here, difference)
                self._reach(n, here)
                continue
            own = difference if part.fraction is None else part.fraction[..., None] * difference
            zeta, c, residual = part.solver.solve(own)
            where = None if residual is None else here  # without a residual zeta and c are 0 in other trajectories
            _add(changed, n - part.leading, _masked(self.xp, where, zeta))
            self.clock.set(n - part.leading + 1, c if where is None else self.xp.where(where, c, 0.0))
            if part.fraction is not None:
                self._complete(changed, n, here, difference - own)
            self._judge(n, here, difference, residual)
        for k in sorted(changed):
            old = self.zeta.node.known[k]
            self.zeta.replace(k, changed[k] if old is None else old + changed[k], self.step)

    def difference(self, n: int) -> Values:
        """Coefficient [t^n] (F_tau - step), shape (..., N)."""
        return self.clock.point(n) - self.step.coefficient(n)

    def _complete(self, changed: dict[int, Values], n: int, here: Values | None, difference: Values) -> None:
        _add(changed, n, _masked(self.xp, here, lifted(self.action, self.frame, self.m, difference)))

    def _reach(self, n: int, where: Values | None) -> None:
        self.levels = 0 * self.levels + n if where is None else self.xp.where(where, n, self.levels)

    def _judge(self, n: int, here: Values | None, difference: Values, residual: Values | None) -> None:
        """Record the residual; trajectories whose system was not solved are not corrected at higher orders."""
        xp = self.xp
        if residual is None:  # the system always has a solution
            self._reach(n, here)
            return
        largest = xp.max(xp.abs(difference), axis=-1)
        scale = xp.where(largest > 0, largest, 1.0)
        relative = xp.max(xp.abs(residual), axis=-1) / scale
        if not is_lazy(relative):
            relative = _masked(xp, here, relative[..., None])[..., 0]
        suspicious = relative > SOLVED_RTOL / 10
        if is_lazy(relative) or bool(np.any(suspicious)):
            # scaled, so that squares do not underflow
            left = norm(residual / scale[..., None])
            exact = left / xp.maximum(norm(difference / scale[..., None]), 1.0)
            exact = _masked(xp, here, exact[..., None])[..., 0]
            noise = round_off(self.action, self.m, self.flow, self._factors, n)
            exact = xp.where(left * scale > noise, exact, 0.0)
            relative = exact if is_lazy(relative) else xp.where(suspicious, exact, relative)
            solved = relative <= SOLVED_RTOL
            self.defects.append((n, xp.where(solved, 0.0, left * scale)))
            self._reach(n, _both(here, solved))
            self.active = solved if here is None else _both(self.active, solved | ~here)
        else:
            self.defects.append((n, xp.zeros_like(relative)))
            self._reach(n, here)
        self.residual = xp.maximum(self.residual, relative)


def round_off(action: Action, m: Values, flow: Flow, factors: Factors | None, n: int) -> Values:
    """Bound of the round-off in [t^n] (F_tau - step), shape (...,), from the terms of exp(|xi| + |psi| t) |m|, or of
    those of the flow for a step without exponentials (`factors` is None).
    """
    xp = namespace(m)
    expanded: Any = factors
    rates, terms = [xp.zeros(m.shape[:-1], dtype=m.dtype)], [norm(m)]
    for k in range(1, n + 1):
        own = generator_norm(action, flow.psi(k - 1))
        step: Any = own if factors is None else k * sum(generator_norm(action, x.coefficient(k)) for x in expanded)
        rates.append(step + own)
    for k in range(1, n + 1):
        terms.append(sum(rates[i] * terms[k - i] for i in range(1, k + 1)) / k)
    return ROUND_OFF_UNITS * np.finfo(m.dtype).eps * terms[n]


def _add(changed: dict[int, Values], k: int, value: Values) -> None:
    changed[k] = value if k not in changed else changed[k] + value


def _both(a: Values | None, b: Values | None) -> Values | None:
    """The mask a & b, where None is the mask of all trajectories."""
    return b if a is None else a if b is None else a & b


def _masked(xp: ModuleType, here: Values | None, value: Values) -> Values:
    return value if here is None else xp.where(here[..., None], value, 0.0)


# The order-n isotropy corrector: Theorem 5 iterated to any order, with its clock (time reparametrization) tau. Let the
# step agree with the reparametrized flow F_tau(t) through order n - 1, with w_l the leading coefficient of the flow.
# Then zeta t^(n-l) in the generator, zeta in g_m, and c t^(n-l+1) in tau change the difference at order n by
#     e rho(zeta) w_l - l c w_l,    which is set equal to    r = [t^n] (F_tau - step),
# so that the step agrees with the new F_tau through order n. This is done for n = p + 1, p + 2, ... and raises a step
# of order p to any order.


@final
@dataclass(frozen=True, slots=True)
class Correction:
    """Isotropy correction at a point: coefficients, order reached, residual.

    Attributes
    ----------
    zeta : tuple
        Coefficients k = 0, 1, ... of the isotropy correction, shape (..., dim g), or None. They include terms of the
        flow's own generator where isotropy does not enter (see `liehom.flow.steps.corrected`).
    clock : tuple
        Coefficients k = 0, 1, ... of tau, shape (...,), or None; clock[1] = 1.
    leading : array of shape (...,)
        l, the order of the first non-zero coefficient of the flow; 0 at an equilibrium.
    reached : array of shape (...,)
        The order to which the corrected step captures the orbit.
    residual : array of shape (...,)
        The largest of the relative residuals of the linear systems.
    defects : tuple
        (k, array): the norm of [t^k] (F_tau - corrected step), for the k at which it need not be 0.
    parts : tuple of Part
        The linear systems, one for each leading order in the ensemble.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> raised = lh.steps.correction(field, lh.Euler(), np.array([0.6, 0.0, 0.8]), order=3)
    >>> int(raised.reached), bool(raised.residual < 1e-10)
    (3, True)
    """

    zeta: tuple[Values | None, ...]
    clock: tuple[Values | None, ...]
    leading: Values
    reached: Values
    residual: Values
    defects: tuple[tuple[int, Values], ...]
    parts: tuple[Part, ...] = field(repr=False)

    @property
    def singular_value(self) -> Values:
        """Smallest singular value that decides the range condition (6.2) at the point, shape (...,).

        It is infinite at an equilibrium.
        """
        return self._of_parts("singular_value", np.inf)

    @property
    def rank(self) -> Values:
        """Rank that must be the dimension of the orbit for (6.2) to hold, shape (...,); 0 at an equilibrium."""
        return self._of_parts("rank", 0)

    @property
    def always_solvable(self) -> bool:
        """Whether every linear system has a solution, because the orbits have a tight frame."""
        return all(isinstance(part.solver, TightFrameSolver) for part in self.parts)

    def near_cone(self, h: Values) -> BooleanArray:
        """Whether the cone on which the range condition fails is within two steps of size h, bool (...,); cf. Notes.

        Parameters
        ----------
        h : array of shape (...,)
            Signed step sizes.

        Notes
        -----
        To first order in h, forwards and backwards: `RangeSolver.is_near_cone` with the change h rho(psi_1) m of the
        velocity. Equilibria, orbits with a tight frame (where there is no cone) and points at which isotropy makes only
        a fraction of the correction count as far from it.
        """
        xp = namespace(self.residual)
        near: BooleanArray = xp.zeros(xp.shape(self.residual), dtype=bool)
        for part in self.parts:
            if part.drift is None or not isinstance(part.solver, RangeSolver):
                continue
            of_part = part.solver.is_near_cone(part.drift * h[..., None])
            if part.fraction is not None:
                of_part = of_part & (part.fraction == 1)
            near = near | (of_part if part.here is None else of_part & part.here)
        return near

    def _of_parts(self, name: str, otherwise: float) -> Values:
        xp = namespace(self.residual)
        result = xp.full(xp.shape(self.residual), otherwise)
        for part in [part for part in self.parts if part.solver is not None]:
            value = getattr(part.solver, name)
            result = value if part.here is None else xp.where(part.here, value, result)
        return result

    def generator(self, h: Values) -> Values | None:
        """The sum of zeta_k h^k for h of shape (..., 1), array or Jet; None if there is no correction."""
        return polynomial(self.zeta, h)

    def time(self, h: Values) -> Values:
        """Time tau(h) that passes in the step, for h of shape (...,)."""
        time = polynomial(self.clock, h)
        return h if time is None else time


def correction(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    order: int,
    *,
    t: Real = 0.0,
    exponential: ExponentialLike = "exp",
    weight: float | None = None,
) -> Correction:
    """`Correction` that raises a step to a given order at a point: coefficients of zeta and of the clock tau.

    Parameters
    ----------
    field : GeneratorField
    step : Step
        The base, of order p.
    m : array_like of shape (..., N)
    order : int
    t : float or array of shape (...,)
    exponential : str, Exponential or callable
    weight : float, optional
        See `Corrected`.

    Notes
    -----
    Theorem 5 of the paper, with the factor 1/2 and the clock of docs/notation.md.

    Examples
    --------
    The correction of Euler's step on the sphere, (3.5) of the paper: sigma_i = <omega', m x omega>/|omega|^2

    >>> import numpy as np
    >>> import liehom as lh
    >>> inertia, m = np.array([1.0, 2.0, 3.0]), np.array([0.6, 0.48, 0.64])
    >>> rho = lh.Representation.from_matrices([[[0, 0, 0], [0, 0, -1], [0, 1, 0]],
    ...     [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]])
    >>> field = lh.GeneratorField(rho, lambda m: -m / inertia + np.sum(m * m / inertia, -1, keepdims=True) * m)
    >>> x = np.cross(m, m / inertia)
    >>> sigma = x @ (x / inertia) / (x @ x) - m @ (m / inertia)
    >>> raised = correction(field, lh.Euler(), m, 2)
    >>> bool(np.allclose(raised.zeta[1], sigma * m))
    True
    """
    point = as_values(m)
    if is_exact(point):
        raise InputError(
            "corrections are computed in floats: give the point in floats, or use liehom.steps.order_condition"
        )
    dimension = check_point(field.representation, point)
    psi, raised = Generator(field, dimension), Corrected(step, order, weight=weight)
    return raised.at(Action(field.representation, exponential), psi, point, np.asarray(t)[..., None]).correction


def correct(recursion: OrderRecursion, base_order: int, order: int) -> Correction:
    """`Correction` that raises a step from `base_order` to `order` at a point."""
    for n in range(base_order + 1, order + 1):
        recursion.level(n)
    xp, defects = recursion.xp, recursion.defects
    defects += [(k, norm(recursion.difference(k))) for k in range(order + 1, recursion.total + 1)]
    leading = recursion.leading if recursion.moving is None else xp.where(recursion.moving, 1, 0)
    return Correction(
        tuple(recursion.zeta.node.known[: order + 1]),
        tuple(recursion.clock.coefficients[: order + 1]),
        leading,
        # an equilibrium does not move
        xp.where(leading == 0, order, xp.maximum(recursion.levels, base_order)),
        recursion.residual,
        tuple(defects),
        tuple(recursion.parts),
    )


@final
class Corrected(Derived):
    """A step corrected along the isotropy of each point, so that it captures orbits to order n.

    Parameters
    ----------
    step : Step or str
        The base, of any order p >= 1, or its name.
    order : int
        n. For n = p + 1 this is Theorem 5. For larger n it is applied for the orders p + 1, p + 2, ..., n in turn. For
        n <= p nothing is corrected.
    weight : float, optional
        The choice among several corrections at each order: the smallest |zeta|^2 + weight^2 c^2. None (default) is an
        infinite weight: the smallest change c of the clock and, among those, the smallest zeta.

    Notes
    -----
    At times tau(h) of the step's own clock the trajectory, not only the orbit, has order n, at every point where the
    range condition (6.2) holds. If a linear system has no solution, the order reached before remains, and the residual
    shows it. Adaptive sizes are refused on orbits where (6.2) fails for every velocity.

    A field psi(m, t) may vanish at some time t_0, as t f(m) does at 0. Isotropy and clock raise the order at t_0 itself
    (leading order l > 1), but shortly after t_0 they are series in h / (t - t_0). By isotropy alone the global order
    through such a point would be the order of the base plus 1 for any n: 2 for Euler, 3 for Heun, 4 for LieTaylor(3)
    and 5 for RKMK("rk4") (measured on S^2: 2, 2.9, 4 and 5). Therefore a smooth fraction of each correction is left
    to terms of the flow's own generator there (`liehom.flow.steps.corrected`), and the order is n again.
    With steps from t_0 = 0 and across it, 4.0, 4.0, 5.0 and 5.0 were measured for n = 4, 4, 5, 5. Away from zeros, and
    everywhere for autonomous fields, isotropy makes the whole correction.

    Next to equilibria of an autonomous field the corrections stay bounded. Points that are equilibria up to round-off
    do not move.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.Corrected(lh.Euler(), order=4)
    Corrected(Euler(), order=4)
    """

    def __init__(self, step: StepLike, order: int, *, weight: float | None = None) -> None:
        step = as_step(step)
        if isinstance(step, Corrected):
            raise InputError("the step is corrected already: give its base and the higher order")
        if weight is not None and not weight > 0:
            raise InputError(f"the weight of the clock is a positive number, got {weight!r}")
        self.step, self.weight = step, weight
        self._order = max(checked_integer(order, "the order"), step.order)

    @property
    def order(self) -> int:
        return self._order

    @property
    def base_order(self) -> int:
        """Order of the base, an int."""
        return self.step.order

    uses_isotropy = True

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Corrected:
        base = self.step.with_exponential_of(action).prepare(action, psi, m, t)
        return self if base is self.step else Corrected(base, self._order, weight=self.weight)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> CorrectedStep:
        base = self.step.with_exponential_of(action)
        local = base.at(action, psi, m, t)
        flow = flow_series(psi.field, m, self._order + error_terms, t[..., 0] if np.ndim(t) else t)
        recursion = OrderRecursion(
            action,
            flow,
            local,
            m,
            orbit_dimension=psi.orbit_dimension,
            weight=self.weight,
            one_exponential=self.step.one_exponential,
        )
        raised = CorrectedStep(local, correct(recursion, base.order, self._order), self)
        if error_terms:
            flow.note(raised, self._order + error_terms)
        return raised

    def __repr__(self) -> str:
        weight = "" if self.weight is None else f", weight={self.weight!r}"
        return f"Corrected({self.step!r}, order={self._order}{weight})"


def check_adaptive(step: Step, action: Action, m: Values, orbit_dimension: int | IntegerArray) -> None:
    """Refuse sizes by the tolerance where the range condition fails for all velocities, so that isotropy reaches no
    order, at one of the points m (..., N).
    """
    while isinstance(step, Derived) and not isinstance(step, Corrected):
        step = step.step
    if not isinstance(step, Corrected) or step.order == step.base_order or action.tight_frame is not None:
        return
    if is_traced(m) or not np.size(m):  # JAX traces it: it has no values
        return
    points = np.asarray(m, dtype=float).reshape(-1, np.shape(m)[-1])
    dimension = np.broadcast_to(orbit_dimension, np.shape(m)[:-1]).reshape(-1)
    rank = 0 * dimension
    for k in range(0, len(points), AT_ONCE):
        here = slice(k, k + AT_ONCE)
        frame = action.isotropy_frame(points[here], dimension[here])
        for j in range(VELOCITIES):
            some = np.cos((1.0 + j) * np.arange(1, frame.tangent.shape[-1] + 1))
            rank[here] = np.maximum(rank[here], RangeSolver(action, frame, frame.tangent @ some, 1, 1.0).rank)
            if bool((rank[here] >= dimension[here]).all()):
                break
    if bool((rank >= dimension).all()):
        return
    b = int(np.argmax(rank < dimension))
    place = "" if np.ndim(m) == 1 else f" of trajectory {b}"
    raise InputError(
        f"{step!r} cannot follow a tolerance from the start{place}: isotropy and the clock reach {rank[b]} of the "
        f"{dimension[b]} dimensions of its orbit, whatever the velocity, so no order above {step.base_order} is "
        f"reached. Take LieTaylor({step.order}), which needs no range condition. With dt= steps are made all the same, "
        "and the run says what they miss"
    )


@final
class CorrectedStep(LocalStep):
    """A corrected step at one point, as a function of h, with its clock."""

    def __init__(self, base: LocalStep, correction: Correction, step: Corrected) -> None:
        zero = zeros(correction.residual, np.shape(correction.residual))
        # all k from 2 on, so that the clock is empty or not whatever the points of the ensemble are
        clock = tuple((k, zero if c is None else c) for k, c in enumerate(correction.clock) if k > 1)
        super().__init__(base.action, base.m, clock=clock)
        self.base, self.correction = base, correction
        self.defects, self.quick = correction.defects, base.quick
        self._one_exponential, self._orders = step.one_exponential, (step.base_order, step.order)

    @property
    def has_factors(self) -> bool:
        """Whether the base is a product of exponentials."""
        return self.base.has_factors

    def factors(self, h: Values) -> Factors:
        return with_correction(self.base.factors(h), self.correction.generator(h), self._one_exponential)

    def point(self, h: Values) -> Values:
        return moved_by_isotropy(self.base, h, self.correction.generator(h), self._one_exponential)

    def valid(self, h: Values) -> Values | bool:
        return self.base.valid(h)

    def departure(self, h: Values) -> Values | None:
        """Next to the cone zeta has a pole, which the coefficients of the error may not show; the flow has none. Steps
        that isotropy hardly changes, and those on orbits without a cone, are not judged.
        """
        zeta = self.correction.generator(h)
        if zeta is None or self.action.tight_frame is not None or not self.trajectory:
            return None
        xp, size = namespace(self.m, h), h[..., 0]
        way = length(self.trajectory[0]) * xp.abs(size)
        isotropy = generator_norm(self.action, zeta) * length(self.m)
        apart = length(self.point(h) - series_at(self.m, self.trajectory, self.time(size)[..., None]))
        return xp.where(isotropy > LITTLE_ISOTROPY * way, apart, 0.0)

    def diagnostics(self, h: Values) -> Diagnostics:
        """Numbers of the correction, and of the base.

        * Whether the point is an equilibrium ("equilibria").
        * Whether a linear system had no solution ("failed").
        * The value of `is_near_cone` ("near").
        * Whether one of the latter two holds ("lost").
        * The number of orders that were missed ("short").
        * The largest relative residual ("residual").
        * The numbers of these names in `Correction` ("singular", "rank"), which are not computed in compiled code.

        Where every linear system has a solution, only "equilibria", "singular" and "rank" are there.
        """
        correction, (base, order), xp = self.correction, self._orders, namespace(self.m)
        rest: Any = correction.leading == 0
        numbers: Diagnostics = {**self.base.diagnostics(h), "equilibria": (rest, "sum")}
        if not is_lazy(self.m):
            numbers["singular"] = xp.where(rest, np.inf, correction.singular_value), "min"
            numbers["rank"] = xp.where(rest, np.inf, correction.rank), "min"
        if not correction.always_solvable:
            short: Any = xp.where(rest, 0, order - correction.reached)
            failed, near = short > 0, self.is_near_cone(h[..., 0])
            numbers |= {
                "failed": (failed, "sum"),
                "near": (near, "sum"),
                "lost": (failed | near, "sum"),
                "short": (xp.where(near, order - base, short), "max"),
                "residual": (correction.residual, "max"),
            }
        return numbers

    def is_near_cone(self, h: Values) -> BooleanArray:
        """`Correction.near_cone`."""
        return self.correction.near_cone(h)
