"""Steps of low order (Euler, backward Euler and Heun), and LieTaylor, of any order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.correctors.expansion import Flow, flow_series, step_series
from liehom.correctors.implicit import reach_of, solve_implicitly
from liehom.correctors.step import Factors, Generator, LocalStep, OneExponential
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.series.arrays import as_values, namespace, zeros
from liehom.series.jet import Jet
from liehom.typing import Values


@final
@dataclass(frozen=True)
class Euler(OneExponential):
    """xi = h psi(m): order 1, section 3 of the paper.

    Examples
    --------
    >>> Euler().order
    1
    """

    @property
    def order(self) -> int:
        return 1

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        return h * psi(m, t)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        velocity = psi(m, t)  # once for all h
        return LocalStep(action, m, lambda h: (h * velocity,))


@final
@dataclass(frozen=True)
class BackwardEuler(OneExponential):
    """xi = h psi(Exp(xi) m, t + h): order 1, implicit.

    Examples
    --------
    >>> BackwardEuler().order
    1
    """

    @property
    def order(self) -> int:
        return 1

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        start = zeros(m, (*np.shape(m)[:-1], action.dimension))
        reach = reach_of(action)
        return solve_implicitly(lambda x: h * psi(action.act(x, m), t + h), start, h, reach=reach)


@final
@dataclass(frozen=True)
class Heun(OneExponential):
    """xi = (h/2)(psi(m) + psi(Exp(h psi(m)) m)): order 2, the paper's RK2.

    Examples
    --------
    >>> Heun().order
    2
    """

    @property
    def order(self) -> int:
        return 2

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        first = psi(m, t)
        return h / 2 * (first + psi(action.act(h * first, m), t + h))


@final
@dataclass(frozen=True)
class LieTaylor(OneExponential):
    """xi = xi_1 h + ... + xi_n h^n, the series with Exp(xi(h)) m = F_h(m) to order n, for any n and any Exp.

    Parameters
    ----------
    n : int
        The order, at least 1.

    Notes
    -----
    xi' = dExp^-1_xi (psi(F_t m)): the Magnus series of the generator along the flow; for the Cayley transform on
    so(3) and n = 4 the paper's xi^sy4. For an Exp whose differential is not known, xi_k is psi_(k-1)/k plus the
    generator of minimal norm for which order k holds.

    Raises
    ------
    InputError
        If n is not an integer at least 1.

    Examples
    --------
    >>> LieTaylor(6)
    LieTaylor(n=6)
    """

    n: int

    def __post_init__(self) -> None:
        if isinstance(self.n, bool) or not isinstance(self.n, int | np.integer) or self.n < 1:
            raise InputError(f"the order of a Taylor step is an integer at least 1, got {self.n!r}")

    @property
    def order(self) -> int:
        return int(self.n)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        time = t[..., 0] if np.ndim(t) else t
        flow = flow_series(psi.field, m, self.order + error_terms, time)
        velocity = Jet.from_node(flow.generator.node)
        series = action.exponential.logarithmic_series(velocity)
        if series is None:
            coefficients = _fitted(action, psi, flow, m, self.order)
        else:
            coefficients = [series.coefficient(k) for k in range(1, self.order + 1)]
        local = _Polynomial(action, m, coefficients)
        if error_terms:
            step = step_series(action, local, m, self.order + error_terms)
            local.defects = tuple(
                (k, namespace(m).linalg.norm(flow.point(k) - step.coefficient(k), axis=-1))
                for k in range(self.order + 1, self.order + error_terms + 1)
            )
        return local


@final
class _Polynomial(LocalStep):
    """xi(h) = xi_1 h + ... + xi_n h^n."""

    def __init__(self, action: Action, m: Values, coefficients: Sequence[Values]) -> None:
        super().__init__(action, m)
        self.coefficients = coefficients

    def factors(self, h: Values) -> Factors:
        total = self.coefficients[-1] * h
        for x in reversed(self.coefficients[:-1]):
            total = (total + x) * h
        return (total,)


def _fitted(action: Action, psi: Generator, flow: Flow, m: Values, order: int) -> list[Values]:
    """Coefficients xi_1, ..., xi_n for an Exp of which only the action is known."""
    frame = action.isotropy_frame(as_values(m), psi.orbit_dimension)
    found: list[Values] = []
    for k in range(1, order + 1):
        guess = flow.psi(k - 1) / k
        step = step_series(action, _Polynomial(action, m, [*found, guess]), m, k)
        missing = flow.point(k) - step.coefficient(k)
        tangential = (np.swapaxes(frame.tangent, -1, -2) @ missing[..., None])[..., 0]
        found.append(guess + (frame.lift @ tangential[..., None])[..., 0])
    return found
