"""NominalTimeCorrected(step, n): a step of order n as a trajectory at the nominal time.

Isotropy and multiples of psi raise its order.

The system of Theorem 5, (1/2) rho(zeta) w_1 - c w_1 = w_n - z_n, has two unknowns. In `liehom.Corrected`, c changes the
time reparametrization τ. Here it changes the generator: adding zeta t^(n-1) - c psi(m) t^n changes the coefficient of
t^n by (1/2) rho(zeta) w_1 - c w_1, and time is nominal, τ(t) = t. Applied to xi = sum psi^(j-1) t^j / j!, this gives
the paper's xi_o^sy4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.expansion import flow_series
from liehom.correctors.isotropy.isotropy_corrector import correct
from liehom.correctors.step import Diagnostics, Factors, Generator, LocalStep, OneExponential
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.typing import Values


@final
@dataclass(frozen=True)
class GeneratorTaylor(OneExponential):
    """The step xi = sum_(j <= n) psi^(j-1) t^j / j!, the series of the integral of psi along the flow: order at most 2.

    Parameters
    ----------
    n : int

    Examples
    --------
    >>> GeneratorTaylor(4).order
    2
    """

    n: int

    @property
    def order(self) -> int:
        return min(self.n, 2)

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        flow = flow_series(psi.field, m, self.n, t[..., 0] if np.ndim(t) else t)
        total = flow.psi(self.n - 1) / self.n * h
        for j in range(self.n - 1, 0, -1):
            total = (total + flow.psi(j - 1) / j) * h
        return total


@final
class NominalTimeCorrected(OneExponential):
    """A step whose order is raised by isotropy and by multiples of psi(m), at the nominal time τ(h) = h.

    Parameters
    ----------
    step : OneExponential
    order : int

    Raises
    ------
    InputError
        If the step has several exponentials.

    Notes
    -----
    For autonomous fields, at points at which the range condition (6.2) holds. At others the order is not reached: the
    run has status -2, and an `OrderWarning` says so.

    Examples
    --------
    >>> import liehom as lh
    >>> NominalTimeCorrected(lh.Euler(), 3)
    NominalTimeCorrected(Euler(), order=3)
    """

    def __init__(self, step: OneExponential, order: int) -> None:
        if not step.one_exponential:
            raise InputError(f"{step!r} has several exponentials, expected one")
        self.step = step
        self._order = order

    @property
    def order(self) -> int:
        return max(self._order, self.step.order)

    @property
    def base_order(self) -> int:
        """Order of the base, an int."""
        return self.step.order

    @property
    def uses_isotropy(self) -> bool:
        """Whether the step asks for isotropy frames: True."""
        return True

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        local = self.step.at(action, psi, m, t)
        velocity = psi(m, t)
        time = t[..., 0] if np.ndim(t) else t
        for n in range(self.step.order + 1, self.order + 1):
            found = correct(
                action, psi.field, local, m, time, base_order=n - 1, order=n, orbit_dimension=psi.orbit_dimension
            )
            zeta, c = found.zeta[n - 1], found.clock[n]
            if zeta is not None and c is not None:  # they are None if no trajectory moves
                short = np.where((found.leading != 0) & (found.reached < n), self.order - n + 1, 0)
                local = _Raised(local, n, zeta, -c[..., None] * velocity, short)
        return local

    def __repr__(self) -> str:
        return f"NominalTimeCorrected({self.step!r}, order={self.order})"


@final
class _Raised(LocalStep):
    """The generator xi + zeta h^(n-1) + x h^n."""

    def __init__(self, base: LocalStep, n: int, zeta: Values, x: Values, short: Values) -> None:
        super().__init__(base.action, base.m)
        self.base, self.n, self.zeta, self.x, self.short = base, n, zeta, x, short

    def valid(self, h: Values) -> Values | bool:
        return self.base.valid(h)

    def diagnostics(self, h: Values) -> Diagnostics:
        """Numbers of the base, and whether and by how many orders a linear system without a solution lowers the order.

        See `CorrectedStep.diagnostics`.
        """
        found = self.base.diagnostics(h)
        before, _ = found.get("short", (0 * self.short, "max"))
        short: Any = np.maximum(before, self.short)
        return {**found, "failed": (short > 0, "sum"), "lost": (short > 0, "sum"), "short": (short, "max")}

    def factors(self, h: Values) -> Factors:
        power = h
        for _ in range(self.n - 2):
            power = power * h
        return (self.base.factors(h)[0] + (self.zeta + self.x * h) * power,)
