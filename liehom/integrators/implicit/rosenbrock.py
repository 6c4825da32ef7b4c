"""Rosenbrock: linearly implicit steps, which solve linear systems with 1 - h gamma J and iterate nothing.

For u' = f(u, s), u(0) = 0 in the algebra, with J = f_u(0, 0) and f_s at the start,

    (1/gamma - h J) U_i = h f(sum_j a_ij U_j, alpha_i h) + sum_j c_ij U_j + gamma_i h^2 f_s,    u = sum_i m_i U_i

(E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.7).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple, final

from liehom.correctors.implicit import Stage
from liehom.correctors.step import Factors, Generator, LocalStep, OneExponential
from liehom.errors import InputError, displayed
from liehom.homogeneous import Action
from liehom.integrators.implicit.linearization import LastSize, Linearization
from liehom.typing import Values

_G = 1 - 1 / sqrt(2)


class RosenbrockData(NamedTuple):
    """Coefficients of a method; `e` are the weights of the estimate of the error, of order `estimate_order`."""

    order: int
    gamma: float
    a: tuple[tuple[float, ...], ...]
    c: tuple[tuple[float, ...], ...]
    m: tuple[float, ...]
    e: tuple[float, ...]
    alpha: tuple[float, ...]
    gammas: tuple[float, ...]
    estimate_order: int


_RODAS5 = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950)
METHODS = {
    "ros2": RosenbrockData(
        2, _G, ((), (1 / _G,)), ((), (-2 / _G,)), (1.5 / _G, 0.5 / _G), (0.5 / _G, 0.5 / _G), (0.0, 1.0), (_G, -_G), 2
    ),
    "rodas3": RosenbrockData(
        3, 0.5, ((), (0.0,), (2.0, 0.0), (2.0, 0.0, 1.0)), ((), (4.0,), (1.0, -1.0), (1.0, -1.0, -8 / 3)),
        (2.0, 0.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.5, 1.5, 0.0, 0.0), 3,
    ),
    "rodas4": RosenbrockData(
        4, 0.25,
        (
            (), (1.544,), (0.9466785280815826, 0.2557011698983284),
            (3.314825187068521, 2.896124015972201, 0.9986419139977817), _RODAS5, (*_RODAS5, 1.0),
        ),
        (
            (), (-5.6688,), (-2.430093356833875, -0.2063599157091915),
            (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
            (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
            (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
        ),
        (*_RODAS5, 1.0, 1.0), (0.0, 0.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.386, 0.21, 0.63, 1.0, 1.0),
        (0.25, -0.1043, 0.1035, -0.03620000000000023, 0.0, 0.0), 4,
    ),
}  # fmt: skip
"""ros2: J. G. Verwer et al. 1999; rodas3: A. Sandu et al. 1997; rodas4: E. Hairer, G. Wanner 1996. All are L-stable."""


@final
@dataclass(frozen=True)
class Rosenbrock(OneExponential):
    """A linearly implicit step of order 2, 3 or 4 for stiff fields, with an estimate of its error.

    Parameters
    ----------
    name : str
        "ros2", "rodas3" or "rodas4".

    Raises
    ------
    InputError
        If the name is not one of these.

    Notes
    -----
    psi is differentiated by Jets; psi that does not run on Jets is differentiated by differences.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e4 * np.cross(m, [0, 0, 1.0]))
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=Rosenbrock("rodas4"))
    >>> sol.success, sol.n_steps < 80, bool(abs(sol.y[2, -1] - 1) < 1e-9)
    (True, True, True)
    """

    name: str = "rodas4"

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or self.name not in METHODS:
            known = ", ".join(map(repr, METHODS))
            raise InputError(f"no Rosenbrock method is called {displayed(self.name)}; known: {known}")

    @property
    def order(self) -> int:
        return METHODS[self.name].order

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        return self.at(action, psi, m, t).factors(h)[0]

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        return RosenbrockStep(METHODS[self.name], Linearization(action, psi, m, t, max(self.order - 1, 1)))


@final
class RosenbrockStep(LocalStep):
    """A Rosenbrock step at one point; `Rosenbrock.at` returns it.

    Attributes
    ----------
    estimate_order : int
        The estimate is O(h^estimate_order).
    """

    estimate_order: int

    def __init__(self, method: RosenbrockData, linear: Linearization) -> None:
        super().__init__(linear.action, linear.m)
        self.estimate_order = method.estimate_order
        self._method, self._linear = method, linear
        self._last = LastSize[list[Any]]()

    def factors(self, h: Values) -> Factors:
        return (_weighted(self._method.m, self._stages(h)),)

    def estimate(self, h: Values) -> Values:
        """rho(x) m with x the difference of the embedded methods, for h (..., 1); shape (..., N)."""
        difference = _weighted(self._method.e, self._stages(h))
        found: Values = self.action.infinitesimal(difference, self.m)
        return found

    def _stages(self, h: Values) -> list[Any]:
        """U_1, ..., U_s."""
        return self._last.of(h, lambda: self._computed(h))

    def _computed(self, h: Values) -> list[Any]:
        method, linear = self._method, self._linear
        stages: list[Any] = []
        for i, gamma_i in enumerate(method.gammas):
            u = _weighted(method.a[i], stages)
            if u is None:
                right = h * (
                    linear.start if method.alpha[i] == 0 else linear.psi(self.m, linear.t + method.alpha[i] * h)
                )
            else:
                right = h * linear.value(u, method.alpha[i] * h)
            before = _weighted(method.c[i], stages)
            right = right if before is None else right + before
            if gamma_i and linear.rate is not None:
                right = right + gamma_i * h * h * linear.rate
            stages.append(linear.solve(method.gamma * h, method.gamma * right))
        return stages


def _weighted(weights: tuple[float, ...], terms: list[Any]) -> Stage:
    """sum_j weights[j] terms[j]; None if there is nothing to add."""
    total = None
    for weight, term in zip(weights, terms, strict=False):
        if weight:
            total = weight * term if total is None else total + weight * term
    return total
