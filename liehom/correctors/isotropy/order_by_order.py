"""The recursion over orders at a point, or at one point of each trajectory, that `correct` runs.

At level n the corrected step agrees with F_tau through order n - 1.  The difference r at order n is removed by zeta
and c (`range_solver`), or by terms of the flow itself where isotropy does not enter (`completion`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any, final

import numpy as np

from liehom.correctors.expansion import ROUND_OFF_UNITS, Clock, Flow, at_rest, flow_series, leading_order, vanishing
from liehom.correctors.isotropy.completion import generator_norm, isotropy_fraction, lifted
from liehom.correctors.isotropy.range_solver import RangeSolver, TightFrameSolver
from liehom.correctors.step import Factors, LocalStep, apply_factors, step_variable, with_correction
from liehom.homogeneous import Action, GeneratorField, IsotropyFrame
from liehom.series.arrays import is_jax, is_lazy, namespace
from liehom.series.jet import Jet
from liehom.tracing.array import Traced
from liehom.typing import IntegerArray, Real, Values

SOLVED_RTOL = 1e-6


@final
@dataclass(frozen=True, slots=True)
class Part:
    """Trajectories with the same leading order, and their linear system.

    Attributes
    ----------
    leading : int
        l. Larger than the order of the expansion if all coefficients of a time-dependent field's flow vanish.
    here : array of bool, shape (...,), or None
        Mask of these trajectories; None for all.
    solver : RangeSolver or None
        None if isotropy does not enter at any order.
    fraction : array of shape (...,), or None
        Fraction of a correction that isotropy makes; None is 1 in all trajectories.
    drift : array of shape (..., N), or None
        rho(psi_1) m, the rate at which the velocity w_1 changes in a frame that the flow carries along; None if l > 1.
    """

    leading: int
    here: Values | None
    solver: RangeSolver | TightFrameSolver | None
    fraction: Values | None
    drift: Values | None = None


@final
class OrderRecursion:
    """State of the recursion: the corrections so far, and the remaining difference.

    Parameters
    ----------
    action, field, local, m, t
        As for `liehom.correctors.isotropy.isotropy_corrector.correct`.
    total : int
        The order to which flow and step are expanded.
    orbit_dimension : int or array of shape (...,)
    one_exponential : bool
    weight : float or None

    Attributes
    ----------
    zeta : Jet
        The correction, values of shape (..., dim g).
    clock : Clock
    leading, levels, residual : arrays of shape (...,)
        l, the last level that was solved (0 if none), and the largest relative residual.
    defects : list of (int, array)
    parts : list of Part
    """

    action: Action
    m: Values
    total: int
    levels: Any

    def __init__(
        self,
        action: Action,
        field: GeneratorField,
        local: LocalStep,
        m: Values,
        t: Real,
        *,
        total: int,
        orbit_dimension: int | IntegerArray,
        one_exponential: bool = True,
        weight: float | None = None,
    ) -> None:
        self.xp: ModuleType = namespace(m)
        self.action, self.m, self.total = action, m, total
        self.shape: tuple[int, ...] = tuple(m.shape[:-1])
        self.flow: Flow = flow_series(field, m, total, t)
        self.zeta: Jet = self._no_correction()
        h = step_variable(total, m)
        self._factors = with_correction(local.factors(h), self.zeta, one_exponential) if local.has_factors else None
        if self._factors is None:
            step: Any = action.act(self.zeta, local.point(h))
        else:
            step = apply_factors(action, self._factors, m)
        self.step: Jet = step
        self.clock: Clock = Clock(self.flow, total, self.shape)
        self._orbit_dimension = orbit_dimension
        # tracers have no values; for them w_1 = 0 is handled by a fraction of 0
        if is_lazy(m):
            self.leading: Values = np.ones(self.shape, dtype=int)
        elif action.tight_frame is not None and not field.time_dependent:
            self.leading = np.where(at_rest(action, self.flow), 0, 1)
        else:
            self.leading = leading_order(self.flow, total)
        # None stands for all trajectories, which saves masks
        self.active: Values | None = None
        self.moving: Values | None = None
        if is_lazy(m) and not field.time_dependent:
            still = at_rest(action, self.flow) if type(m) is Traced else vanishing(self.flow, 1)
            self.active = self.moving = ~still
        elif not field.time_dependent and not bool(np.all(self.leading)):
            self.active = self.leading > 0
        self.parts: list[Part] = self._split(0.5 if one_exponential else 1.0, weight)
        self.levels = 0 * self.xp.asarray(self.leading)
        self.residual: Values = self.xp.zeros(self.shape, dtype=m.dtype)
        self.defects: list[tuple[int, Values]] = []

    @cached_property
    def frame(self) -> IsotropyFrame:
        """Isotropy frame at m, computed at first use (rarely, if there is a tight frame)."""
        return self.action.isotropy_frame(self.m, self._orbit_dimension)

    def _no_correction(self) -> Jet:
        zero = self.xp.zeros((*self.shape, self.action.dimension), dtype=self.m.dtype)
        zeta = Jet.growing(zero, self.total, zero=True)
        for _ in range(self.total):
            zeta.extend(None)
        return zeta

    def _split(self, factor: float, weight: float | None) -> list[Part]:
        parts = []
        some = np.asarray(self.leading).flat[:1]
        alike = bool(np.all(self.leading == some))  # the common case
        for l in [int(x) for x in (some if alike else np.unique(self.leading))]:
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
            parts.append(Part(l, here, solver, fraction, self._drift(l, solver)))
        return parts

    def _drift(self, leading: int, solver: RangeSolver | TightFrameSolver) -> Values | None:
        if leading > 1 or self.total < 2 or type(solver) is TightFrameSolver or is_jax(self.m):
            return None
        made: Values = self.action.infinitesimal(self.flow.psi(1), self.m)
        return made

    # -- one order ---------------------------------------------------------------------------------------
    def level(self, n: int) -> None:
        """Make the step agree with F_tau at order n."""
        difference = self.difference(n)
        if self.active is not None and not all(isinstance(part.solver, TightFrameSolver) for part in self.parts):
            # where a lower order was not solved, what is left at this one is part of the error
            left = norm(self.xp, difference)
            self.defects.append((n, self.xp.where(self.active, 0.0, left)))
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
        found: Values = self.clock.point(n) - self.step.coefficient(n)
        return found

    def _complete(self, changed: dict[int, Values], n: int, here: Values | None, difference: Values) -> None:
        made = lifted(self.action, self.frame, self.m, difference)
        _add(changed, n, _masked(self.xp, here, made))

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
            left = norm(xp, residual / scale[..., None])
            exact = left / xp.maximum(norm(xp, difference / scale[..., None]), 1.0)
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
    """Bound of the round-off in [t^n] (F_tau - step), shape (...,), from the terms of exp(|xi| + |psi| t) |m|.

    A step without exponentials (`factors` is None) is taken to have terms of the size of those of the flow.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field, m = lh.GeneratorField(lh.defining(lh.so(2)), [1]), np.array([1.0, 0.0])
    >>> xi = Jet([[0.0], [1.0], [0.0]])
    >>> bool(round_off(lh.Action(field.representation), m, flow_series(field, m, 2), (xi,), 2) < 1e-12)
    True
    """
    xp = namespace(m)
    expanded: Any = factors
    rates = [xp.zeros(m.shape[:-1], dtype=m.dtype)]
    for k in range(1, n + 1):
        own = generator_norm(action, flow.psi(k - 1))
        step: Any = own if factors is None else k * sum(generator_norm(action, x.coefficient(k)) for x in expanded)
        rates.append(step + own)
    terms = [norm(xp, m)]
    for k in range(1, n + 1):
        terms.append(sum(rates[i] * terms[k - i] for i in range(1, k + 1)) / k)
    found: Values = ROUND_OFF_UNITS * np.finfo(m.dtype).eps * terms[n]
    return found


def _add(changed: dict[int, Values], k: int, value: Values) -> None:
    changed[k] = value if k not in changed else changed[k] + value


def _both(a: Values | None, b: Values | None) -> Values | None:
    """The mask a & b, where None is the mask of all trajectories."""
    return b if a is None else a if b is None else a & b


def _masked(xp: ModuleType, here: Values | None, value: Values) -> Values:
    return value if here is None else xp.where(here[..., None], value, 0.0)


def norm(xp: ModuleType, x: Values) -> Values:
    """Euclidean norms of x (..., N), shape (...,)."""
    found: Values = xp.sqrt(xp.sum(x * x, axis=-1))
    return found
