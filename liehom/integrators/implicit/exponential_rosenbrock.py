"""ExponentialRosenbrock: steps that integrate the linearization of the field exactly.

For u' = f(u), u(0) = 0 in the algebra, J = f'(0), D(u) = f(u) - f(0) - J u and phi_k(z) = sum_j z^j / (j + k)!,

    order 2:  u = h phi_1 f(0)
    order 3:  u = v + 2 h phi_3 D(v),   v = h phi_1 f(0)
    order 4:  u = v + h (16 phi_3 - 48 phi_4) D(p) + h (12 phi_4 - 2 phi_3) D(q),
              p = h/2 phi_1(h J/2) f(0),   q = v + h phi_1 D(p)

with phi_k = phi_k(h J) (M. Hochbruck, A. Ostermann, J. Schweitzer, SIAM J. Numer. Anal. 47, 2009). Time is an
additional coordinate s of the linear equation, s' = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial
from typing import Any, final

import numpy as np

from liehom.correctors.implicit import Stage
from liehom.correctors.step import Factors, Generator, LocalStep, OneExponential
from liehom.errors import InputError, TraceError, displayed
from liehom.homogeneous import Action
from liehom.integrators.implicit.linearization import LastSize, Linearization
from liehom.series.arrays import is_lazy
from liehom.series.jet import Jet
from liehom.typing import Values

PHIS = 4
"""phi_1, ..., phi_4 are computed together."""


@final
@dataclass(frozen=True)
class ExponentialRosenbrock(OneExponential):
    """An exponential step of order 2, 3 or 4 for stiff and for rapidly oscillating fields.

    Parameters
    ----------
    order : int

    Raises
    ------
    InputError
        If the order is not 2, 3 or 4.

    Notes
    -----
    Orders 3 and 4 have an estimate of the error. The functions phi_k are those of matrices, computed by
    ``scipy.linalg.expm``, so the step is not compiled.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e4 * np.cross(m, [0, 0, 1.0]))
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=ExponentialRosenbrock(4))
    >>> sol.success, sol.n_steps < 80, bool(abs(sol.y[2, -1] - 1) < 1e-9)
    (True, True, True)
    """

    order: int = 4

    def __post_init__(self) -> None:
        if isinstance(self.order, bool) or self.order not in (2, 3, 4):
            raise InputError(f"exponential Rosenbrock steps have order 2, 3 or 4, got {displayed(self.order)}")

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        return self.at(action, psi, m, t).factors(h)[0]

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if is_lazy(m):
            raise TraceError("exponential Rosenbrock steps need exponentials of matrices: take Rosenbrock('rodas4')")
        linear = Linearization(action, psi, m, t, max(self.order - 1, 1))
        return _ExponentialStep(self.order, linear)


@final
class _ExponentialStep(LocalStep):
    """An exponential Rosenbrock step at one point; from order 3 on with an estimate of its error."""

    def __init__(self, order: int, linear: Linearization) -> None:
        super().__init__(linear.action, linear.m)
        self.order, self._linear = order, linear
        self.estimate_order = None if order == 2 else order
        self._last = LastSize[tuple[Any, Any]]()

    def factors(self, h: Values) -> Factors:
        return (self._solved(h)[0],)

    def _solved(self, h: Values) -> tuple[Any, Any]:
        """The generator of the step and the difference from the one of lower order; for the size h."""
        return self._last.of(h, lambda: self._computed(h))

    def _computed(self, h: Values) -> tuple[Any, Any]:
        at = self._linear
        jacobian: Any = at.jacobian
        phi = _phis(h, jacobian)
        rate = at.rate
        v = h * _times(phi[0], at.start)
        if rate is not None:
            v = v + h * h * _times(phi[1], rate)
        if self.order == 2:
            return v, None

        def rest(u: Values, s: Values) -> Stage:
            found = at.value(u, s) - at.start - _times(jacobian, u)
            return found if rate is None else found - s * rate

        if self.order == 3:
            extra = 2 * h * _times(phi[2], rest(v, h))
            return v + extra, extra
        half = _phis(h / 2, jacobian)
        p = h / 2 * _times(half[0], at.start)
        if rate is not None:
            p = p + h * h / 4 * _times(half[1], rate)
        d = rest(p, h / 2)
        e = rest(v + h * _times(phi[0], d), h)
        extra = h * _times(phi[3], 12 * e - 48 * d)
        return v + h * _times(phi[2], 16 * d - 2 * e) + extra, extra

    def estimate(self, h: Values) -> Values:
        """rho(x) m with x the difference of the methods of two orders, for h (..., 1); shape (..., N)."""
        found: Values = self.action.infinitesimal(self._solved(h)[1], self.m)
        return found


def _times(matrix: Stage, v: Stage) -> Stage:
    return (matrix @ v[..., None])[..., 0]


def _phis(h: Values, jacobian: Values) -> list[Any]:
    """phi_1(h J), ..., phi_4(h J), each of shape (..., n, n), for h (..., 1)."""
    a: Any = h[..., None] * jacobian
    n = jacobian.shape[-1]
    if isinstance(a, Jet):
        return [_series(a, k, n) for k in range(1, PHIS + 1)]
    from scipy.linalg import expm

    wide = np.zeros((*a.shape[:-2], n * (PHIS + 1), n * (PHIS + 1)))
    wide[..., :n, :n] = np.where(np.isfinite(a).all(axis=(-1, -2), keepdims=True), a, 0.0)
    for k in range(PHIS):
        wide[..., n * k : n * (k + 1), n * (k + 1) : n * (k + 2)] = np.eye(n)
    made = expm(wide)
    return [made[..., :n, n * k : n * (k + 1)] for k in range(1, PHIS + 1)]


def _series(a: Jet, k: int, n: int) -> Stage:
    """phi_k of a series without constant term."""
    total: Any = np.eye(n) / factorial(k)
    power: Any = a
    for j in range(1, a.order + 1):
        total = total + power / factorial(j + k)
        power = power @ a
    return total
