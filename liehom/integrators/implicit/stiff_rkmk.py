"""StiffRKMK: implicit Runge-Kutta-Munthe-Kaas steps with an estimate of the error that stays small for stiff fields.

For a collocation method with s stages the comparison is the quadrature with the nodes 0, c_1, ..., c_s and weight gamma
at 0, of order s (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8). The difference is
multiplied by (1 - h gamma J)^-1, J the derivative of the equation in the algebra, which keeps it bounded for stiff J.
"""

from __future__ import annotations

import dataclasses
from typing import Any, final

import numpy as np

from liehom.correctors.implicit import SparseRow, combined
from liehom.correctors.step import Factors, Generator, LocalStep, OneExponential
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.integrators.implicit.linearization import Linearization
from liehom.integrators.methods.rkmk import RKMK, Stages
from liehom.integrators.tableaux.tableau import Tableau
from liehom.integrators.tableaux.tableaux import tableau as tableau_of
from liehom.typing import Array, Values


@final
@dataclasses.dataclass(frozen=True, init=False, repr=False)
class StiffRKMK(OneExponential):
    """The Runge-Kutta-Munthe-Kaas step of an implicit tableau, with a step size for stiff fields.

    With a fixed step size it is `RKMK` of the same tableau. An adaptive size follows from an embedded estimate, whereas
    that of `RKMK` follows from Taylor coefficients of the error, which are large for stiff fields.

    Parameters
    ----------
    tableau : Tableau or str
        "radau3", "radau5", "radau9" (Radau IIA, L-stable), "sdirk4" (L-stable), "gauss2", "gauss3", ... (A-stable).

    Raises
    ------
    InputError
        If the tableau is explicit, or gives no estimate: it has no embedded method, and its nodes are not distinct, or
        one of them is 0.

    Examples
    --------
    A field with the rate 10^4, in a few steps:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 1e4 * np.cross(m, [0, 0, 1.0]))
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=StiffRKMK("radau5"), rtol=1e-6)
    >>> sol.success, sol.n_steps < 60, bool(abs(sol.y[2, -1] - 1) < 1e-9)
    (True, True, True)
    """

    tableau: Tableau
    _base: RKMK = dataclasses.field(compare=False)

    def __init__(self, tableau: Tableau | str) -> None:
        object.__setattr__(self, "tableau", tableau_of(tableau))
        object.__setattr__(self, "_base", RKMK(self.tableau))
        if self.tableau.explicit:
            raise InputError(f"tableau {self.tableau.name!r} is explicit: take RKMK({self.tableau.name!r})")
        object.__setattr__(self, "_estimate", _estimate_of(self.tableau))

    @property
    def order(self) -> int:
        return self.tableau.order

    def generator(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Values:
        return self._base.generator(action, psi, m, t, h)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        stages = Stages(self._base, action, psi, m, t, hasty=error_terms > 0)  # sizes are adaptive
        return StiffStep(stages, *self._estimate)  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        return f"StiffRKMK({self.tableau.name!r})"


@final
class StiffStep(LocalStep):
    """An implicit step at one point, with the estimate of its error; `StiffRKMK.at` returns it.

    Parameters
    ----------
    stages : Stages
    weights : sparse row
        Weights of the stages in the estimate.
    gamma : float
        The weight of f(0), and the factor of J.
    at_start : bool
        Whether f(0) is part of the estimate.
    order : int
        The estimate is O(h^order).
    """

    estimate_order: int

    def __init__(self, stages: Stages, weights: SparseRow, gamma: float, at_start: bool, order: int) -> None:
        super().__init__(stages.action, stages.m)
        self.estimate_order = order
        self._stages, self._weights, self._gamma, self._at_start = stages, weights, gamma, at_start
        self._linear: Linearization | None = None

    def factors(self, h: Values) -> Factors:
        return (self._stages.combined(self._stages.numbers.b, h),)

    def estimate(self, h: Values) -> Values:
        """rho(x) m with x the filtered difference of two methods, for h (..., 1); shape (..., N)."""
        stages = self._stages
        if self._linear is None:
            self._linear = Linearization(stages.action, stages.psi, stages.m, stages.t, min(stages.method.terms, 2))
        stages.combined(stages.numbers.b, h)
        difference: Any = combined(self._weights, stages.known)
        if self._at_start:
            difference = difference + self._gamma * h * self._linear.start
        filtered = self._linear.solve(self._gamma * h, difference)
        estimate: Values = stages.action.infinitesimal(filtered, stages.m)
        return estimate


def _estimate_of(tableau: Tableau) -> tuple[SparseRow, float, bool, int]:
    """Weights of the estimate, gamma, whether f(0) takes part, and the order of the estimate."""
    a, b, c, embedded = tableau.to_numpy()
    eigenvalues = np.linalg.eigvals(a)
    real = np.abs(eigenvalues[np.abs(eigenvalues.imag) < 1e-6])
    gamma = float(real.max() if real.size and real.max() > 0 else np.abs(eigenvalues).max())
    if embedded is not None:
        order = min(tableau.order, tableau.embedded_order or tableau.order) + 1
        return _sparse(embedded - b), gamma, False, order
    s = len(c)
    if len(np.unique(np.round(c, 12))) < s or bool((np.abs(c) < 1e-12).any()):
        raise InputError(
            f"tableau {tableau.name!r} has no embedded method, and its nodes {c.round(6).tolist()} give none: take "
            "distinct nodes other than 0, or RKMK with a fixed step size"
        )
    # sum_i w_i c_i^(q-1) = 1/q for q = 1, ..., s, where the node 0 contributes gamma to q = 1
    powers = np.vander(c, s, increasing=True).T
    wanted = 1 / np.arange(1, s + 1)
    wanted[0] -= gamma
    return _sparse(np.linalg.solve(powers, wanted) - b), gamma, True, s + 1


def _sparse(row: Array) -> SparseRow:
    return tuple((j, float(x)) for j, x in enumerate(row) if x != 0)
