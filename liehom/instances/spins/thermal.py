"""Thermal noise of spins: Brownian increments that depend on a seed alone, and steps in the sense of Stratonovich.

    dm = g (h + a m x h) x m dt + g (w + a m x w) x m,   w = (2 a T / gamma)^(1/2) dW,   g = gamma/(1 + a^2)

with the increments dW of a Wiener process for each coordinate of each spin. The strength is that of the
fluctuation-dissipation theorem, so the stationary distribution has the density exp(-E/T). In a step of size h the noise
is a constant field w/h. A step of order 2 for smooth fields then converges to the solution in the sense of
Stratonovich, with weak order 1 and strong order 1/2, or 1 for one source of noise. Its exponentials keep spins on the
sphere.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np

from liehom.correctors.step import Factors, Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action, GeneratorField
from liehom.typing import Array, Real, Values


@final
class Increments:
    """Increments of independent Wiener processes, one for each entry of an array, in steps of one size.

    Parameters
    ----------
    shape : tuple of int
    size : float
        Length of a step in time.
    seed : int
    parts : int
        Number of drawn increments of which each is the sum: steps of size h in p parts see the same path as steps of
        size h/p in one part.

    Examples
    --------
    >>> fine, coarse = Increments((2,), 0.1, 7), Increments((2,), 0.2, 7, parts=2)
    >>> bool(np.allclose(fine(0) + fine(1), coarse(0)))
    True
    """

    def __init__(self, shape: tuple[int, ...], size: float, seed: int, parts: int = 1) -> None:
        self.shape, self.size, self.seed, self.parts = shape, size, seed, parts
        self._last: tuple[int, Array] | None = None

    def __call__(self, k: int) -> Array:
        """The increments of step k, of standard deviation size^(1/2)."""
        if self._last is None or self._last[0] != k:
            total = np.zeros(self.shape)
            for j in range(k * self.parts, (k + 1) * self.parts):
                # a stream of its own for every step, so that a step does not depend on those before
                total += np.random.Generator(np.random.Philox(key=self.seed, counter=[0, 0, 0, j])).normal(
                    size=self.shape
                )
            self._last = k, np.sqrt(self.size / self.parts) * total
        return self._last[1]


@final
class ThermalStep(Step):
    """A step with noise, as a constant field over the step.

    Parameters
    ----------
    step : Step
        Of order 2 for smooth fields, such as Heun.
    increments : Increments
    response : callable
        (m, w) -> generator of the field w at m, linear in w.
    begin : float
        The initial time.

    Examples
    --------
    >>> import liehom as lh
    >>> noise = Increments((3,), 0.1, 0)
    >>> step = ThermalStep(lh.Heun(), noise, lambda m, w: w, 0.0)
    >>> step, step.order
    (ThermalStep(Heun(), size=0.1, seed=0, parts=1), 2)
    """

    def __init__(
        self, step: Step, increments: Increments, response: Callable[[Values, Array], Values], begin: float
    ) -> None:
        self.step, self.increments, self.begin = step, increments, begin
        self.response = response

    @property
    def order(self) -> int:
        return self.step.order

    def factors(self, action: Action, psi: Generator, m: Values, t: Values, h: Values) -> Factors:
        return self.at(action, psi, m, t).factors(h)

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        if error_terms:
            raise InputError("steps with thermal noise have a fixed size: give dt")
        noise = self.noise(float(np.max(t)))

        def noisy(point: Values, time: Real = 0.0) -> Values:
            made: Any = psi.field.psi(point, time)
            total: Values = made + self.response(point, noise)
            return total

        field = psi.field
        made = GeneratorField(field.representation, noisy, time_dependent=True, sites=field.sites)
        return self.step.at(action, Generator(made, psi.orbit_dimension, psi.start), m, t)

    def noise(self, t: float) -> Array:
        """The noise of the step that begins at a time, as a field."""
        size = self.increments.size
        return self.increments(int(np.rint(abs(t - self.begin) / size))) / size

    def __repr__(self) -> str:
        noise = self.increments
        return f"ThermalStep({self.step!r}, size={noise.size}, seed={noise.seed}, parts={noise.parts})"
