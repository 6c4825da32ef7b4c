"""Linearization: u' = f(u, s) in the algebra at a point, with f(u, s) = dexp^-1_u psi(Exp(u) m, t + s)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar, final

import numpy as np

from liehom.correctors.implicit.equation import DIFFERENCE, NOT_ON_JETS, Equation
from liehom.correctors.step import Generator
from liehom.homogeneous import Action
from liehom.homogeneous.exponentials.matrix_functions import solve
from liehom.series.arrays import zeros
from liehom.series.jet import Jet
from liehom.typing import Real, Values

Found = TypeVar("Found")


@final
class LastSize(Generic[Found]):
    """The result of a computation for the last step size.

    Examples
    --------
    >>> last, h = LastSize[float](), np.array([0.5])
    >>> last.of(h, lambda: 1.0), last.of(h.copy(), lambda: 2.0), last.of(2 * h, lambda: 3.0)
    (1.0, 1.0, 3.0)
    """

    def __init__(self) -> None:
        self._h: Any = None
        self._found: list[Found] = []

    def of(self, h: Values, compute: Callable[[], Found]) -> Found:
        """The result for the size h; arrays are compared by value, because their owner may have changed them."""
        arrays = isinstance(h, np.ndarray) and isinstance(self._h, np.ndarray)
        same = h is self._h if not arrays else h.dtype == self._h.dtype and np.array_equal(h, self._h)
        if not (same and self._found):
            self._found = [compute()]
            self._h = h.copy() if isinstance(h, np.ndarray) else h
        return self._found[0]


@final
class Linearization:
    """f and its derivatives at u = 0, s = 0.

    Parameters
    ----------
    action : Action
    psi : Generator
    m : array of shape (..., N)
    t : array of shape (..., 1)
    terms : int
        Number of terms of dexp^-1; 1 leaves it out.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 5 * np.cross(m, [0, 0, 1.0]))
    >>> psi, m = Generator(field, 2), np.array([0.0, 0.0, 1.0])
    >>> at = Linearization(lh.Action(field.representation), psi, m, np.array([0.0]), 3)
    >>> np.diag(at.jacobian).tolist()
    [-5.0, -5.0, 0.0]
    """

    def __init__(self, action: Action, psi: Generator, m: Values, t: Values, terms: int) -> None:
        self.action, self.psi, self.m, self.t, self.terms = action, psi, m, t, terms
        self.shape = (*np.shape(m)[:-1], action.dimension)
        self.start: Values = psi(m, t)  # f(0, 0)
        self._jacobian: Values | None = None
        self._rate: Values | None = None

    def value(self, u: Values, s: Real) -> Values:
        """f(u, s), of the shape of u."""
        velocity = self.psi(self.action.act(u, self.m), self.t + s)
        if self.terms > 1:
            velocity = self.action.exponential.differential_inverse(u, velocity, self.terms)
        return velocity

    @property
    def jacobian(self) -> Values:
        """df/du, shape (..., n, n)."""
        if self._jacobian is None:
            equation = Equation(lambda y: [self.value(y[0], 0.0)], [((0, 1.0),)])
            self._jacobian = equation.blocks(zeros(self.m, (1, *self.shape)))[0]
        return self._jacobian

    @property
    def rate(self) -> Values | None:
        """df/ds, shape (..., n); None if psi does not depend on t."""
        if not self.psi.field.time_dependent:
            return None
        if self._rate is None:
            try:
                moved: Any = self.psi(Jet.constant(self.m, 1), Jet.variable(self.t, 1))
                self._rate = moved.coefficient(1) if isinstance(moved, Jet) else 0 * moved
            except NOT_ON_JETS:
                self._rate = (self.psi(self.m, self.t + DIFFERENCE) - self.start) / DIFFERENCE
        return self._rate

    def solve(self, scale: Values, right: Values) -> Values:
        """x with (1 - scale J) x = right, for scale (..., 1)."""
        matrix: Any = np.eye(self.shape[-1]) - scale[..., None] * self.jacobian
        found: Values = solve(matrix, right[..., None])[..., 0]
        return found
