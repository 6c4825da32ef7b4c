"""Conserving(step, F): a step that keeps first integrals by isotropy, exactly or to one order more; section 7.

    m -> Exp(xi(m, t) + t^(n-1) sigma) m,    sigma in g_m,    F(step) = F(start of the run)         (7.2), (7.6)

n - 1 is the order to which the step conserves F by itself.  sigma lies in V_m, the complement of ker chi_m in g_m; its
linearisation solves chi_m(sigma) = -E_n.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.conserving.conservation import Conservation, combination
from liehom.correctors.conserving.conserved_order import EXTRA_ORDERS, agreement, expanded, round_off_of
from liehom.correctors.conserving.first_integral import FirstIntegral
from liehom.correctors.conserving.level_newton import solve_levels
from liehom.correctors.expansion import ROUND_OFF_UNITS, flow_series
from liehom.correctors.isotropy.order_by_order import with_correction
from liehom.correctors.step import Generator, LocalStep, Step, apply_factors, step_variable
from liehom.errors import InputError, TraceError
from liehom.homogeneous import Action
from liehom.series.arrays import is_exact, is_jax, zeros
from liehom.series.jet import Jet
from liehom.tracing import Traced

AIMS = ("start", "previous")
TOLERATED_UNITS = 0.5
EXTRA_POINTS, ENOUGH_TRAJECTORIES = 2, 16
TIME_SHIFT = 0.01


@final
class Conserving(Step):
    """A step whose generator gets t^(n-1) sigma, sigma in g_m, so that first integrals keep their values.

    Parameters
    ----------
    step : Step
        The base, of any kind.
    F : callable, text, sympy expression or list of these
        The first integral, or k of them: see `FirstIntegral`.
    aim : "start" or "previous"
        Whether F is to be what it was at the start of the run, so that round-off does not add up, or at the point
        from which the step is made.
    linear : bool
        One linear solve per step instead of Newton's method: F is then conserved to order n.
    order : int, optional
        n - 1, the order to which the base conserves F; by default it is measured next to the start of the run.
    value : float or array of shape (..., k), optional
        What F is to be, instead of F at the start of the run.

    Raises
    ------
    InputError
        If an argument is not right. At the first step: if F is not a first integral, or isotropy does not reach a
        combination of the integrals, which the message names.

    Notes
    -----
    Proposition 10 of the paper, with Newton's method started at the solution of chi_m(sigma_0) = -E_n up to higher
    order (E_n need not vanish, unlike what its proof says); `linear` is the linearisation after it. At an equilibrium
    chi_m = 0, and the step is that of the base; so it is where F does not resolve the orbits at the precision of the
    numbers. Where chi_m loses rank on the way, the level set may be out of the reach of isotropy for large steps of a
    low order: the report counts steps that miss it. The order as a method for trajectories is that of the base.

    Examples
    --------
    The energy of the free rigid body by Heun's step:

    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.correctors import Conserving
    >>> w, m = np.array([1.0, 0.5, 0.25]), np.array([0.6, 0.48, 0.64])
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * w)
    >>> energy = lambda m: np.sum(m * m * w, axis=-1) / 2
    >>> sol = lh.integrate(field, (0, 20), m, step=Conserving(lh.Heun(), energy), dt=0.1)
    >>> bool(np.abs(energy(sol.y.T) - energy(m)).max() < 1e-15)
    True
    """

    def __init__(
        self,
        step: Step,
        F: Any,
        *,
        aim: str = "start",
        linear: bool = False,
        order: int | None = None,
        value: Any = None,
    ) -> None:
        if not isinstance(step, Step):
            raise InputError(f"expected a step such as liehom.Heun(), got {step!r}")
        if isinstance(step, Conserving):
            raise InputError("the step conserves something already: give its base and a list of all integrals")
        if aim not in AIMS:
            raise InputError(f"aim is {aim!r}, expected one of {', '.join(map(repr, AIMS))}")
        if order is not None and (isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1):
            raise InputError(f"the order to which F is conserved is an integer at least 1, got {order!r}")
        if value is not None and aim == "previous":
            raise InputError("the step aims at the previous point: leave out the value")
        self.step, self.aim, self.linear = step, aim, bool(linear)
        self.conserved_order = None if order is None else int(order)
        self._source = F
        self._value = None if value is None else np.asarray(value, dtype=float)

    @property
    def order(self) -> int:
        return self.step.order

    @property
    def one_exponential(self) -> bool:
        return self.step.one_exponential

    def factors(self, action: Action, psi: Generator, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
        return self.at(action, psi, m, t).factors(h)

    def at(self, action: Action, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> ConservingStep:
        if is_jax(m) or is_exact(m):
            raise InputError("a conserving step iterates to round-off, on numpy arrays of floats only")
        time = t[..., 0] if np.ndim(t) else t
        if self.linear and type(m) is Traced:
            raise TraceError("linear=True measures the order to which F is kept, which is not compiled: leave it out")
        known = self._begun(action, psi, m, time)
        local = self.step.at(action, psi, m, t, error_terms=error_terms)
        frame = action.isotropy_frame(m, psi.orbit_dimension)
        factor = 0.5 if self.one_exponential else 1.0
        found = Conservation(action, known.integral, frame, m, psi.field.psi(m, time), factor)
        has_clock = type(local).time is not LocalStep.time
        return (ClockedConservingStep if has_clock else ConservingStep)(
            local, found, known.target, known.n, one_exponential=self.one_exponential, linear=self.linear
        )

    def kept_order(self, action: Action, psi: Generator, m: Any, t: Any) -> int | None:
        """n of (7.2) at the start of a run, with t of shape (...,); None if no E_n was found that does not vanish."""
        return self._begun(action, psi, m, t).n

    def _begun(self, action: Action, psi: Generator, m: Any, t: Any) -> _Begun:
        known: _Begun | None = psi.prepared.get((self, action))
        if known is None:
            known = psi.prepared[self, action] = _Begun(self, action, psi, m, t)
        return known

    def __repr__(self) -> str:
        given = repr(self._source) if isinstance(self._source, str) else _shown(self._source)
        options = "" if self.aim == "start" else f", aim={self.aim!r}"
        options += ", linear=True" * self.linear
        options += "" if self.conserved_order is None else f", order={self.conserved_order}"
        options += "" if self._value is None else f", value={self._value.tolist()}"
        return f"Conserving({self.step!r}, {given}{options})"


def _shown(source: Any) -> str:
    if callable(source):
        return str(getattr(source, "__qualname__", type(source).__name__))
    return str([str(x) for x in source] if np.iterable(source) else source)


@final
class _Begun:
    """What a conserving step knows at the start of a run: that F is a first integral, its value there, and n."""

    def __init__(self, step: Conserving, action: Action, psi: Generator, m: Any, t: Any) -> None:
        start = m if psi.start is None else psi.start
        self.integral = FirstIntegral(step._source, action.representation.size)
        self.n: int | None = None
        self.target: Any = None
        if type(m) is Traced:
            self.target, self.n = self._given(step, m), psi.prepared.get(step)
            return
        bound = step.order + 1
        self.integral.check(flow_series(psi.field, start, bound, t), bound)
        if step.aim == "start" and (psi.start is not None or step._value is not None):
            value = self.integral(start)
            self.target = value if step._value is None else _aimed_at(step._value, value)
        self._explore(step, action, psi, start, t)

    def _given(self, step: Conserving, m: Any) -> Any:
        """The target of a traced step, a number that every trajectory has; None for F(m)."""
        if step.aim == "previous":
            return None
        if step._value is not None:
            if step._value.size > 1:
                raise TraceError("a value of F for each trajectory is not compiled: give one, or leave it to the start")
            return _aimed_at(step._value.reshape(()), self.integral(m))
        return Traced(m.tape, [m.tape.trajectory_constant(lambda points: self.integral(points)[..., 0])])

    def _explore(self, step: Conserving, action: Action, psi: Generator, start: Any, t: Any) -> None:
        """n, and whether chi is onto, at the start and at points next to it, as symmetric points may mislead."""
        factor = 0.5 if step.one_exponential else 1.0
        inner = Generator(psi.field, psi.orbit_dimension, start)
        short: Any = np.ones(start.shape[:-1], dtype=bool)
        orders = []
        first: Conservation | None = None
        bound = step.order + EXTRA_ORDERS
        for j in range(EXTRA_POINTS + 1):
            if j > 1 and short.size >= ENOUGH_TRAJECTORIES and not short.any():
                break  # so many trajectories, moved once from where they may all be symmetric, are points enough
            x = np.cos((1.0 + j) * np.arange(1, action.dimension + 1)) / (action.max_norm or 1.0)
            point = action.act(np.broadcast_to(x, (*start.shape[:-1], x.size)), start) if j else start
            point = point.astype(start.dtype, copy=False)
            time = t + TIME_SHIFT * j if psi.field.time_dependent else t
            usable = np.isfinite(point).all(axis=-1) & np.isfinite(psi.field.psi(point, time)).all(axis=-1)
            point = np.where(usable[..., None], point, start)
            frame = action.isotropy_frame(point, psi.orbit_dimension)
            found = Conservation(action, self.integral, frame, point, psi.field.psi(point, time), factor)
            first = first or found
            short = short & found.moving & (found.rank < found.wanted)
            if step.conserved_order is None:
                local = step.step.at(action, inner, point, np.asarray(time)[..., None])
                flow = flow_series(psi.field, point, bound, time)
                made = expanded(action, self.integral, local, point, bound)
                finite = np.isfinite(np.asarray(made)).all(axis=(0, -1))
                noise = round_off_of(action, self.integral, flow, local, point, bound)
                orders.append(np.where(finite, agreement(made, noise), bound).min(initial=bound))
        if short.any() and first is not None:
            _refuse(first, tuple(int(i) for i in np.argwhere(short)[0]), np.broadcast_to(t, short.shape))
        order = step.conserved_order if step.conserved_order is not None else int(min(orders))
        if step.conserved_order is not None or order < bound:
            self.n = order + 1


def _aimed_at(given: Any, value: Any) -> Any:
    try:
        return np.broadcast_to(given[..., None] if given.ndim < value.ndim else given, value.shape).astype(value.dtype)
    except ValueError:
        raise InputError(f"the value has shape {given.shape}, F has shape {value.shape}") from None


def _refuse(found: Conservation, index: tuple[int, ...], t: Any) -> None:
    names = ", ".join(combination(z) for z in found.unreachable(index))
    rank, wanted = int(np.asarray(found.rank)[index]), int(np.asarray(found.wanted)[index])
    raise InputError(
        f"isotropy does not reach {names}: at m = {found.m[index]}, t = {t[index]} chi_m has rank {rank}, and "
        f"{wanted} integrals are independent on the orbit (Proposition 10 asks for a chi_m that is onto). Conserve "
        "fewer integrals, or others"
    )


@final
@dataclass(frozen=True, slots=True)
class Conserved:
    """What a conserving step of one size reports, all of shape (...,).

    Attributes
    ----------
    iterations : array of int
        Of Newton's method.
    defect : array
        The largest of the |F_i(step) - target_i|.
    units : array
        The same in units of what F_i is rounded by.
    rank, wanted : array of int
        The rank of chi_m, and how many integrals are independent on the orbit at m.
    left : array of bool
        Where isotropy was left alone because F does not resolve its effect: at or next to an equilibrium, or h = 0.
    """

    iterations: Any
    defect: Any
    units: Any
    rank: Any
    wanted: Any
    left: Any


class ConservingStep(LocalStep):
    """A conserving step at one point, as a function of h; the correction is found for each h.

    Made by `Conserving.at`.

    Parameters
    ----------
    base : LocalStep
    found : Conservation
        chi_m.
    target : array of shape (..., k), or None
        What F is to be; None for F(m).
    n : int or None
        The first coefficient E_n that does not vanish everywhere.
    one_exponential, linear : bool

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    >>> action, psi = lh.Action(field.representation), lh.correctors.Generator(field, 2)
    >>> step = Conserving(lh.Euler(), "m0**2 + m1**2/2 + m2**2/4")
    >>> local = step.at(action, psi, np.array([0.6, 0.48, 0.64]), np.array([0.0]))
    >>> made = local.conserved(np.array([0.1]))
    >>> bool(made.defect < 1e-15), int(made.rank), bool(made.iterations < 4)
    (True, 1, True)
    """

    def __init__(
        self,
        base: LocalStep,
        found: Conservation,
        target: Any,
        n: int | None,
        *,
        one_exponential: bool,
        linear: bool,
    ) -> None:
        self.base, self.found, self.n = base, found, n
        self.defects = base.defects
        self.estimate = getattr(base, "estimate", None)
        self.estimate_order = getattr(base, "estimate_order", None)
        self._target = found.value if target is None else target
        self._one, self._linear = one_exponential, linear
        self._unit = TOLERATED_UNITS * float(np.finfo(found.m.dtype).eps) * found.scale
        self._last: tuple[Any, tuple[Any, ...], Conserved] | None = None
        self._sigma: Any = None

    def factors(self, h: Any) -> tuple[Any, ...]:
        if isinstance(h, Jet):
            return with_correction(self.base.factors(h), self._series(h), self._one)
        return self._made(h)[1]

    def conserved(self, h: Any) -> Conserved:
        """What became of F in the step of size h (..., 1)."""
        return self._made(h)[2]

    def isotropy(self, h: Any) -> Any:
        """t^(n-1) sigma of the step of size h (..., 1), shape (..., dim g)."""
        made, base = self._made(h)[1], self.base.factors(h)
        if len(made) > len(base):
            return made[-1]
        return made[0] - base[0]

    def sigma(self) -> Any:
        """The solution of chi_m(sigma) = -E_n in V_m, shape (..., dim g); 0 where E_n is round-off."""
        if self._sigma is None:
            m = self.found.m
            if self.n is None:
                self._sigma = zeros(m, (*m.shape[:-1], self.found.dimension))
            else:
                z = apply_factors(self.found.action, self.base.factors(step_variable(self.n, m)), m)
                self._sigma = self._removing(self.found.integral(z), z, self.n)
        return self._sigma

    # -- private -----------------------------------------------------------------------------------------
    def _made(self, h: Any) -> tuple[Any, tuple[Any, ...], Conserved]:
        if isinstance(h, Traced):
            if self._last is None or self._last[0] is not h:
                self._last = (h, *self._corrected(h))
            return self._last
        last, h = self._last, np.asarray(h)
        if last is None or h.shape != last[0].shape or h.dtype != last[0].dtype or not (h == last[0]).all():
            last = self._last = (h.copy(), *self._corrected(h))
        return last

    def _corrected(self, h: Any) -> tuple[tuple[Any, ...], Conserved]:
        found, action, m = self.found, self.found.action, self.found.m
        made = self.base.factors(h)
        if not self._one and not made:
            raise InputError("the base step has no exponential")
        z = apply_factors(action, made, m)

        def residual(x: Any) -> Any:
            point = action.act(made[0] + x, m) if self._one else action.act(x, z)
            return found.integral(point) - self._target

        first = found.integral(z) - self._target
        if self._linear:
            x = self.sigma() * h ** ((self.n or 1) - 1)
            resolved, iterations, left = found.rank, np.zeros(m.shape[:-1], dtype=int), residual(x)
        else:
            if type(m) is Traced:
                found.needs_motion(z - m)
            elif not found.moving.all():
                found = found.toward(z - m)
            directions = found.directions
            jacobian = found.along(z - m, directions)
            solution = solve_levels(residual, first, directions, jacobian, self._unit, action.max_norm)
            x, resolved, iterations, left = solution.x, solution.resolved, solution.iterations, solution.residual
        defect = np.abs(left)
        units = (defect / np.maximum(self._unit, float(np.finfo(defect.dtype).tiny))).max(axis=-1)
        rank, wanted = found.rank, found.wanted
        alone = (resolved < rank) | ~found.moving | (wanted == 0)
        record = Conserved(iterations, defect.max(axis=-1), units, rank, wanted, alone)
        if x is None:
            return made, record
        return ((made[0] + x,) if self._one else (*made, x)), record

    def _removing(self, along: Any, z: Any, k: int) -> Any:
        """The zeta in V_m with chi_m(zeta) = -[t^k] F along the step z."""
        value, m = along.coefficient(k), self.found.m
        size = np.maximum(_length(m), np.finfo(float).tiny)
        rate = 0.0 * size
        for j in range(1, k + 1):
            rate = np.maximum(rate, (_length(z.coefficient(j)) / size) ** (1 / j))
        noise = ROUND_OFF_UNITS * np.finfo(m.dtype).eps * self.found.scale * rate[..., None] ** k
        return -self.found.preimage(np.where(np.abs(value) > noise, value, 0.0))

    def _series(self, h: Jet) -> Any:
        """t^(n-1) sigma as a series in h, which conserves F(m) to its order; None if there is nothing to do."""
        total, found = h.order, self.found
        if self.n is None or total < self.n:
            return None
        if self._linear:
            return self.sigma() * h ** (self.n - 1) if self.n > 1 else None
        m = found.m
        zeta = Jet.growing(zeros(m, (*m.shape[:-1], found.dimension)), total, zero=True)
        for _ in range(total):
            zeta.extend(None)
        factors = with_correction(self.base.factors(step_variable(total, m)), zeta, self._one)
        z = apply_factors(found.action, factors, m)
        along = found.integral(z)
        for k in range(max(self.n, 2), total + 1):
            zeta.replace(k - 1, self._removing(along, z, k), along, z)
        made: Any = None
        for k in range(total, 0, -1):
            made = made * h if made is not None else None
            x = zeta.node.known[k]
            if x is not None:
                made = x + (made if made is not None else 0.0 * h)
        return None if made is None else made * h


def _length(x: Any) -> Any:
    return np.linalg.norm(x if type(x) is Traced else np.asarray(x, dtype=float), axis=-1)


@final
class ClockedConservingStep(ConservingStep):
    """A conserving step whose base has a clock of its own, such as a `Corrected` step.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    >>> action, psi = lh.Action(field.representation), lh.correctors.Generator(field, 2)
    >>> step = Conserving(lh.Corrected(lh.Euler(), 3), "m0**2 + m1**2/2 + m2**2/4")
    >>> local = step.at(action, psi, np.array([0.6, 0.48, 0.64]), np.array([0.0]))
    >>> bool(local.time(0.1) == local.base.time(0.1))
    True
    """

    def time(self, h: Any) -> Any:
        """tau(h) of the base, for h of shape (...,)."""
        return self.base.time(h)
