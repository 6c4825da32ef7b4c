"""Corrected(step, order): a step raised to any order by isotropy, with its clock (time reparametrization) tau."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, final

import numpy as np

from liehom.correctors.isotropy.isotropy_corrector import Correction, correct
from liehom.correctors.step import (
    Diagnostics,
    Factors,
    Generator,
    LocalStep,
    Step,
    StepLike,
    as_step,
    moved_by_isotropy,
    with_correction,
)
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.series.arrays import is_lazy, namespace, zeros
from liehom.typing import BooleanArray, Values


@final
class Corrected(Step):
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

    Raises
    ------
    InputError
        If the order is less than 1, the weight not positive, or the step is itself corrected.

    Notes
    -----
    At times tau(h) of the step's own clock the trajectory, not only the orbit, has order n, at every point where the
    range condition (6.2) holds. If a linear system has no solution, the order reached before remains, and the residual
    shows it.

    A field psi(m, t) may vanish at some time t_0, as t f(m) does at 0. Isotropy and clock raise the order at t_0 itself
    (leading order l > 1), but shortly after t_0 they are series in h / (t - t_0). By isotropy alone the global order
    through such a point would be the order of the base plus 1 for any n: 2 for Euler, 3 for Heun, 4 for LieTaylor(3)
    and 5 for RKMK("rk4") (measured on S^2: 2, 2.9, 4 and 5). Therefore a smooth fraction of each correction is left
    to terms of the flow's own generator there (`liehom.correctors.isotropy.completion`), and the order is n again.
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
        if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1:
            raise InputError(f"the order is an integer at least 1, got {order!r}")
        if weight is not None and not weight > 0:
            raise InputError(f"the weight of the clock is a positive number, got {weight!r}")
        self.step = step
        self.weight = weight
        self._order = max(int(order), step.order)

    @property
    def order(self) -> int:
        return self._order

    @property
    def one_exponential(self) -> bool:
        return self.step.one_exponential

    @property
    def base_order(self) -> int:
        """Order of the base, an int."""
        return self.step.order

    @property
    def uses_isotropy(self) -> bool:
        """Whether the step asks for isotropy frames: True."""
        return True

    @property
    def prepares_by_psi(self) -> bool:
        return self.step.prepares_by_psi

    @property
    def trace_key(self) -> Hashable:
        return self.step.trace_key

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Corrected:
        base = self.step.with_exponential_of(action).prepare(action, psi, m, t)
        return self if base is self.step else Corrected(base, self._order, weight=self.weight)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> CorrectedStep:
        base = self.step.with_exponential_of(action)
        local = base.at(action, psi, m, t)
        found = correct(
            action,
            psi.field,
            local,
            m,
            t[..., 0] if np.ndim(t) else t,
            base_order=base.order,
            order=self._order,
            orbit_dimension=psi.orbit_dimension,
            weight=self.weight,
            one_exponential=self.step.one_exponential,
            error_terms=error_terms,
        )
        return CorrectedStep(local, found, self)

    def __repr__(self) -> str:
        weight = "" if self.weight is None else f", weight={self.weight!r}"
        return f"Corrected({self.step!r}, order={self._order}{weight})"


@final
class CorrectedStep(LocalStep):
    """A corrected step at one point, as a function of h, with its clock.

    Parameters
    ----------
    base : LocalStep
    correction : Correction
    step : Corrected

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> action, psi = lh.Action(field.representation), Generator(field, 2)
    >>> local = lh.Corrected(lh.Euler(), order=3).at(action, psi, np.array([0.6, 0.0, 0.8]), 0.0)
    >>> int(local.correction.reached), float(local.time(0.0))
    (3, 0.0)
    """

    defects: tuple[tuple[int, Values], ...]

    def __init__(self, base: LocalStep, correction: Correction, step: Corrected) -> None:
        super().__init__(base.action, base.m, clock=_clock_of(correction))
        self.base = base
        self.correction = correction
        self.defects = correction.defects
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
        found, (base, order), xp = self.correction, self._orders, namespace(self.m)
        rest: Any = found.leading == 0
        made: Diagnostics = {**self.base.diagnostics(h), "equilibria": (rest, "sum")}
        if not is_lazy(self.m):
            made["singular"] = xp.where(rest, np.inf, found.singular_value), "min"
            made["rank"] = xp.where(rest, np.inf, found.rank), "min"
        if not found.always_solvable:
            short: Any = xp.where(rest, 0, order - found.reached)
            failed, near = short > 0, self.is_near_cone(h[..., 0])
            made |= {
                "failed": (failed, "sum"),
                "near": (near, "sum"),
                "lost": (failed | near, "sum"),
                "short": (xp.where(near, order - base, short), "max"),
                "residual": (found.residual, "max"),
            }
        return made

    def is_near_cone(self, h: Values) -> BooleanArray:
        """`Correction.near_cone`."""
        return self.correction.near_cone(h)


def _clock_of(correction: Correction) -> tuple[tuple[int, Values], ...]:
    """(k, c_k) for all k from 2 on, so that it is empty or not whatever the points of the ensemble are."""
    zero = zeros(correction.residual, np.shape(correction.residual))
    return tuple((k, zero if c is None else c) for k, c in enumerate(correction.clock) if k > 1)
