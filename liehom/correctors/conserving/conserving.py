"""Conserving(step, F): a step that conserves first integrals by isotropy, to round-off or to one order higher.

    m -> Exp(xi(m, t) + t^(n-1) sigma) m,    sigma in g_m,    F(step) = F(start of the run)         (7.2), (7.6)

Here n - 1 is the order to which the base step conserves F.  sigma is in V_m, the complement of ker chi_m in g_m; its
linearization solves chi_m(sigma) = -E_n.  See section 7 of the paper.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.correctors.conserving.conservation import Conservation, combination
from liehom.correctors.conserving.conserved_order import EXTRA_ORDERS, agreement, expanded, round_off_of
from liehom.correctors.conserving.conserving_step import ConservingStep
from liehom.correctors.conserving.first_integral import FirstIntegral, IntegralSource
from liehom.correctors.expansion import flow_series
from liehom.correctors.step import Generator, Step, StepLike, as_step
from liehom.errors import InputError, TraceError
from liehom.homogeneous import Action
from liehom.series.arrays import is_exact, is_jax
from liehom.tracing import Traced
from liehom.typing import Array, Values

AIMS = ("start", "previous")
EXTRA_POINTS, ENOUGH_TRAJECTORIES = 2, 16
TIME_SHIFT = 0.01


@final
class Conserving(Step):
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
    linear : bool
        One linear solve per step instead of Newton's method: F is then conserved to order n.
    order : int, optional
        n - 1, the order to which the base conserves F. By default it is measured near the initial points.
    value : float or array of shape (..., k), optional
        The target, in place of the value of F at the initial point.

    Raises
    ------
    InputError
        If an argument is not valid. At the first step, if F is not a first integral, or if isotropy does not reach a
        combination of the integrals, which the message names.

    Notes
    -----
    Proposition 10 of the paper. Newton's method starts at the solution of chi_m(sigma_0) = -E_n up to higher order (E_n
    need not vanish, unlike its proof says); `linear` is the linearization after the proposition. At an equilibrium
    chi_m = 0, and the step is the base step; likewise if F does not resolve the orbits at the precision of the numbers.
    If chi_m loses rank along a trajectory, large steps of low order may not be able to reach the level set; the report
    counts the steps that miss it. The order as a method for trajectories is the order of the base.

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

    step: Step
    linear: bool
    _begun: _Begun | None = None  # of `prepare`

    def __init__(
        self,
        step: StepLike,
        F: IntegralSource,
        *,
        aim: str = "start",
        linear: bool = False,
        order: int | None = None,
        value: ArrayLike | None = None,
    ) -> None:
        step = as_step(step)
        if isinstance(step, Conserving):
            raise InputError("the step conserves something already: give its base and a list of all integrals")
        if aim not in AIMS:
            raise InputError(f"aim is {aim!r}, expected one of {', '.join(map(repr, AIMS))}")
        if order is not None and (isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1):
            raise InputError(f"the order to which F is conserved is an integer at least 1, got {order!r}")
        if value is not None and aim == "previous":
            raise InputError("the step aims at the previous point: leave out the value")
        self.step, self.aim, self.linear = step, aim, bool(linear)
        self.conserved_order: int | None = None if order is None else int(order)
        self._source = F
        self._value = None if value is None else np.asarray(value, dtype=float)

    @property
    def order(self) -> int:
        return self.step.order

    @property
    def one_exponential(self) -> bool:
        return self.step.one_exponential

    @property
    def base_order(self) -> int:
        """`base_order` of the base, an int."""
        return self.step.base_order

    @property
    def uses_isotropy(self) -> bool:
        """Whether the step asks for isotropy frames: True."""
        return True

    @property
    def kept_order(self) -> int | None:
        """The n of (7.2), after `prepare`; None if all E_n computed vanish."""
        return None if self._begun is None else self._begun.n

    @property
    def prepares_by_psi(self) -> bool:
        return True

    @property
    def trace_key(self) -> Hashable:
        return self.kept_order, self.step.trace_key

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Conserving:
        """The step with the checked first integrals, their target values, and n, for a run from m at times t."""
        made = self.with_prepared(step=self.step.prepare(action, psi, m, t))
        return made.with_prepared(_begun=_Begun(made, action, psi, m, t))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> ConservingStep:
        if is_jax(m) or is_exact(m):
            raise InputError("a conserving step iterates to round-off, on numpy arrays of floats only")
        time = t[..., 0] if np.ndim(t) else t
        if self.linear and type(m) is Traced:
            raise TraceError("linear=True measures the order to which F is kept, which is not compiled: leave it out")
        if self._begun is None:
            return self.prepare(action, psi, m, time).at(action, psi, m, t, error_terms=error_terms)
        known = self._begun
        local = self.step.at(action, psi, m, t, error_terms=error_terms)
        frame = action.isotropy_frame(m, psi.orbit_dimension)
        factor = 0.5 if self.one_exponential else 1.0
        found = Conservation(action, known.integral, frame, m, psi.field.psi(m, time), factor)
        target = self._traced_target(known.integral, m) if type(m) is Traced else known.target
        return ConservingStep(local, found, target, known.n, one_exponential=self.one_exponential, linear=self.linear)

    def _traced_target(self, integral: FirstIntegral, m: Traced) -> Values | None:
        """Target of a traced step, a number of each trajectory; None for F(m)."""
        if self.aim == "previous":
            return None
        if self._value is not None:
            if self._value.size > 1:
                raise TraceError("a value of F for each trajectory is not compiled: give one, or leave it to the start")
            return _aimed_at(self._value.reshape(()), integral(m))
        return Traced(m.tape, [m.tape.trajectory_constant(lambda points: integral(points)[..., 0])])

    def __repr__(self) -> str:
        given = repr(self._source) if isinstance(self._source, str) else _shown(self._source)
        options = "" if self.aim == "start" else f", aim={self.aim!r}"
        options += ", linear=True" * self.linear
        options += "" if self.conserved_order is None else f", order={self.conserved_order}"
        options += "" if self._value is None else f", value={self._value.tolist()}"
        return f"Conserving({self.step!r}, {given}{options})"


def _shown(source: IntegralSource) -> str:
    if callable(source):
        return str(getattr(source, "__qualname__", type(source).__name__))
    return str([str(x) for x in source] if np.iterable(source) else source)


@final
class _Begun:
    """Data of a conserving step for a run: the first integral, checked, its target value, and n."""

    def __init__(self, step: Conserving, action: Action, psi: Generator, m: Values, t: Values) -> None:
        start = m if psi.start is None else psi.start
        self.integral = FirstIntegral(step._source, action.representation.size)
        self.n: int | None = None
        self.target: Any = None
        if type(m) is Traced:  # without a run: n stays None
            return
        bound = step.order + 1
        self.integral.check(flow_series(psi.field, start, bound, t), bound)
        if step.aim == "start" and (psi.start is not None or step._value is not None):
            value = self.integral(start)
            self.target = value if step._value is None else _aimed_at(step._value, value)
        self._explore(step, action, psi, start, t)

    def _explore(self, step: Conserving, action: Action, psi: Generator, start: Values, t: Values) -> None:
        """Find n, and check that chi is onto, at the initial points and near them, as symmetric points may mislead."""
        factor = 0.5 if step.one_exponential else 1.0
        inner = Generator(psi.field, psi.orbit_dimension, start)
        short: Any = np.ones(start.shape[:-1], dtype=bool)
        orders = []
        first: Conservation | None = None
        bound = step.order + EXTRA_ORDERS
        for j in range(EXTRA_POINTS + 1):
            if j > 1 and short.size >= ENOUGH_TRAJECTORIES and not short.any():
                break  # this many trajectories, moved once from points that may be symmetric, are enough points
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
                made = expanded(self.integral, local, bound)
                finite = np.isfinite(np.asarray(made)).all(axis=(0, -1))
                noise = round_off_of(action, self.integral, flow, local, point, bound)
                orders.append(np.where(finite, agreement(made, noise), bound).min(initial=bound))
        if short.any() and first is not None:
            _refuse(first, tuple(int(i) for i in np.argwhere(short)[0]), np.broadcast_to(t, short.shape))
        order = step.conserved_order if step.conserved_order is not None else int(min(orders))
        if step.conserved_order is not None or order < bound:
            self.n = order + 1


def _aimed_at(given: Array, value: Values) -> Values:
    try:
        return np.broadcast_to(given[..., None] if given.ndim < value.ndim else given, value.shape).astype(value.dtype)
    except ValueError:
        raise InputError(f"the value has shape {given.shape}, F has shape {value.shape}") from None


def _refuse(found: Conservation, index: tuple[int, ...], t: Values) -> None:
    names = ", ".join(combination(z) for z in found.unreachable(index))
    rank, wanted = int(np.asarray(found.rank)[index]), int(np.asarray(found.wanted)[index])
    raise InputError(
        f"isotropy does not reach {names}: at m = {found.m[index]}, t = {t[index]} chi_m has rank {rank}, and "
        f"{wanted} integrals are independent on the orbit (Proposition 10 asks for a chi_m that is onto). Conserve "
        "fewer integrals, or others"
    )
