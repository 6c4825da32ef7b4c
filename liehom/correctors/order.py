"""The order-n isotropy corrector: Theorem 5, iterated to any order, with its clock.

Let the step agree with the reparametrised flow F_tau(t) through order n - 1, with w_l the leading coefficient of the
flow.  Then zeta t^(n-l) in the generator, zeta in g_m, and c t^(n-l+1) in tau change the difference at order n by

    e rho(zeta) w_l - l c w_l,    which is set equal to    r = [t^n] (F_tau - step),

so that the step agrees with the new F_tau through order n.  Doing this for n = p + 1, p + 2, ... raises a step of
order p to any order.  Imports expansion, range_solver, step, homogeneous, series.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.expansion import Clock, Flow, flow_series, leading_order, step_series
from liehom.correctors.range_solver import RangeSolver
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.homogeneous import Action, GeneratorField, IsotropyFrame
from liehom.homogeneous.field import check_point
from liehom.series.arrays import as_values, is_jax, namespace
from liehom.series.jet import Jet

SOLVED_RTOL = 1e-6
NOISE = 1e4


@final
@dataclass(frozen=True, slots=True)
class Correction:
    """What the corrector found at a point.

    Attributes
    ----------
    zeta : tuple
        Coefficient k of the isotropy correction, shape (..., dim g), or None.
    clock : tuple
        Coefficient k of tau, shape (...,), or None; clock[1] = 1.
    leading : array of shape (...,)
        l, the order of the first non-zero coefficient of the flow; 0 at an equilibrium.
    reached : array of shape (...,)
        The order to which the corrected step captures the orbit.
    residual : array of shape (...,)
        The largest of the relative residuals of the linear systems.
    defects : tuple
        (k, array): the size of [t^k] (F_tau - corrected step) where it is not 0.
    singular_value : array of shape (...,)
        The smallest singular value that decides the range condition (6.2) at the point.
    rank : array of shape (...,)
        The rank that (6.2) asks to be the dimension of the orbit.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> found = lh.correction(field, lh.Euler(), np.array([0.6, 0.0, 0.8]), order=3)
    >>> int(found.reached), bool(found.residual < 1e-10)
    (3, True)
    """

    zeta: tuple[Any, ...]
    clock: tuple[Any, ...]
    leading: Any
    reached: Any
    residual: Any
    defects: tuple[tuple[int, Any], ...]
    singular_value: Any
    rank: Any

    def generator(self, h: Any) -> Any:
        """sum_k zeta_k h^k for h of shape (..., 1), array or Jet; None if there is no correction."""
        return _polynomial(self.zeta, h)

    def time(self, h: Any) -> Any:
        """tau(h), for h of shape (...,)."""
        made = _polynomial(self.clock, h)
        return h if made is None else made


def _polynomial(coefficients: tuple[Any, ...], h: Any) -> Any:
    """Horner's rule over coefficients of which some are None; coefficient 0 is None."""
    total: Any = None
    for x in reversed(coefficients):
        if total is not None:
            total = total * h
        if x is not None:
            total = x if total is None else total + x
    return total


def correction(
    field: GeneratorField,
    step: Step,
    m: Any,
    order: int,
    *,
    t: Any = 0.0,
    exponential: Any = "exp",
    weight: float | None = None,
) -> Correction:
    """What raises a step to a given order at a point: the coefficients of the isotropy correction and of the clock.

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

    Raises
    ------
    ShapeError, InputError
        If m is not a point on an orbit of positive dimension.

    Notes
    -----
    Theorem 5 of the paper, with the factor 1/2 and the clock as the notation page has them.

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
    >>> found = correction(field, lh.Euler(), m, 2)
    >>> bool(np.allclose(found.zeta[1], sigma * m))
    True
    """
    point = as_values(m)
    dimension = check_point(field.representation, point)
    action = Action(field.representation, exponential)
    local = step.at(action, Generator(field, dimension), point, np.asarray(t)[..., None])
    return correct(
        action,
        field,
        local,
        point,
        t,
        base_order=step.order,
        order=order,
        orbit_dimension=dimension,
        weight=weight,
        one_exponential=step.one_exponential,
    )


def correct(
    action: Action,
    field: GeneratorField,
    local: LocalStep,
    m: Any,
    t: Any,
    *,
    base_order: int,
    order: int,
    orbit_dimension: Any,
    weight: float | None = None,
    one_exponential: bool = True,
    error_terms: int = 0,
) -> Correction:
    """The corrections that raise a step from `base_order` to `order` at a point.

    Parameters
    ----------
    action, field
    local : LocalStep
        The base step at (m, t).
    m : array of shape (..., N)
    t : float or array of shape (...,)
    base_order, order : int
    orbit_dimension : int or array of shape (...,)
    weight : float, optional
        See `RangeSolver`.
    one_exponential : bool
        Whether the correction is added to the generator (e = 1/2) or is an outermost factor (e = 1).
    error_terms : int
        How many coefficients beyond `order` to compute for `defects`.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> action, m = lh.Action(field.representation), np.array([0.6, 0.0, 0.8])
    >>> local = lh.Euler().at(action, Generator(field, 2), m, 0.0)
    >>> int(correct(action, field, local, m, 0.0, base_order=1, order=2, orbit_dimension=2).reached)
    2
    """
    work = _Work(action, field, local, m, t, order + error_terms, orbit_dimension, one_exponential, weight)
    for n in range(base_order + 1, order + 1):
        work.level(n)
    return work.result(base_order, order)


class _Work:
    """The state of the iteration over the orders at one point (or one for each trajectory)."""

    def __init__(
        self,
        action: Action,
        field: GeneratorField,
        local: LocalStep,
        m: Any,
        t: Any,
        total: int,
        orbit_dimension: Any,
        one_exponential: bool,
        weight: float | None,
    ) -> None:
        self.xp = namespace(m)
        self.m, self.total = m, total
        self.shape = tuple(m.shape[:-1])
        self.flow: Flow = flow_series(field, m, total, t)
        zero = self.xp.zeros((*self.shape, action.dimension), dtype=m.dtype)
        self.zeta = Jet.growing(zero, total, zero=True)
        for _ in range(total):
            self.zeta.extend(None)
        self.step = step_series(action, local, m, total, self.zeta)
        self.clock = Clock(self.flow, total, self.shape)
        self.frame: IsotropyFrame = action.isotropy_frame(m, orbit_dimension)
        self.leading = np.ones(self.shape, dtype=int) if is_jax(m) else leading_order(self.flow, total)
        factor = 0.5 if one_exponential else 1.0
        self.solvers = {
            int(leading): RangeSolver(action, self.frame, self.flow.point(int(leading)), int(leading), factor, weight)
            for leading in np.unique(self.leading)
            if leading > 0
        }
        self.active = self.xp.asarray(self.leading > 0)
        if is_jax(m):
            self.active = self._moving()
        self.reached_levels = 0 * self.xp.asarray(self.leading)
        self.residual = self.xp.zeros(self.shape, dtype=m.dtype)
        self.defects: list[tuple[int, Any]] = []

    def _moving(self) -> Any:
        from liehom.correctors.expansion import vanishing

        return ~vanishing(self.flow, 1)

    def level(self, n: int) -> None:
        """Make the step agree with F_tau at order n."""
        difference = self.clock.point(n) - self.step.coefficient(n)
        changed: dict[int, Any] = {}
        for leading, solver in self.solvers.items():
            here = self.active & (self.leading == leading)
            if n <= leading:
                # isotropy cannot enter at order n <= l: a base of lower order is completed by the flow's own term
                tangential = (self.xp.swapaxes(self.frame.tangent, -1, -2) @ difference[..., None])[..., 0]
                lifted = (self.frame.lift @ tangential[..., None])[..., 0]
                self._add(changed, n, here, lifted)
                self.reached_levels = self.xp.where(here, n, self.reached_levels)
                continue
            zeta, c, residual = solver.solve(difference)
            self._add(changed, n - leading, here, zeta)
            self.clock.set(n - leading + 1, self.xp.where(here, c, 0.0))
            self._judge(n, here, difference, residual)
        for k in sorted(changed):
            old = self.zeta.node.known[k]
            self.zeta.replace(k, changed[k] if old is None else old + changed[k], self.step)

    def _add(self, changed: dict[int, Any], k: int, here: Any, value: Any) -> None:
        masked = self.xp.where(here[..., None], value, 0.0)
        changed[k] = masked if k not in changed else changed[k] + masked

    def _judge(self, n: int, here: Any, difference: Any, residual: Any) -> None:
        """Record the residual; where the system was not solved, the order stays and no more is corrected."""
        left, size = _norm(self.xp, residual), _norm(self.xp, difference)
        noise = NOISE * np.finfo(difference.dtype).eps
        terms = _norm(self.xp, self.flow.point(n)) + _norm(self.xp, self.step.coefficient(n))
        relevant = here & (size > noise * terms)
        relative = self.xp.where(relevant, left / self.xp.where(size > 0, size, 1.0), 0.0)
        self.residual = self.xp.maximum(self.residual, relative)
        solved = relative <= SOLVED_RTOL
        self.defects.append((n, self.xp.where(here & ~solved, left, 0.0)))
        self.reached_levels = self.xp.where(here & solved, n, self.reached_levels)
        self.active = self.active & (solved | ~here)

    def result(self, base_order: int, order: int) -> Correction:
        for k in range(order + 1, self.total + 1):
            self.defects.append((k, _norm(self.xp, self.clock.point(k) - self.step.coefficient(k))))
        reached = self.xp.maximum(self.reached_levels, base_order)
        reached = self.xp.where(self.xp.asarray(self.leading) == 0, order, reached)  # an equilibrium stays
        singular, rank = self.xp.zeros(self.shape, dtype=self.m.dtype) + np.inf, 0 * self.leading
        for leading, solver in self.solvers.items():
            singular = self.xp.where(self.leading == leading, solver.singular_value, singular)
            rank = self.xp.where(self.leading == leading, solver.rank, rank)
        return Correction(
            tuple(self.zeta.node.known[: order + 1]),
            tuple(self.clock.coefficients[: order + 1]),
            self.leading,
            reached,
            self.residual,
            tuple(self.defects),
            singular,
            rank,
        )


def _norm(xp: Any, x: Any) -> Any:
    return xp.sqrt(xp.sum(x * x, axis=-1))
