"""Composition: a symmetric step composed with itself, so that it has any even order.

    S_(p+2)(h) = S_p(c h)^k S_p((1 - 2k c) h) S_p(c h)^k,    c = 1 / (2k - (2k)^(1/(p+1)))

with k = 1 (H. Yoshida, Construction of higher order symplectic integrators, Phys. Lett. A 150, 1990) or k = 2
(M. Suzuki, Fractal decomposition of exponential operators, Phys. Lett. A 146, 1990).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import final

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.typing import Values

REPETITIONS = {"yoshida": 1, "suzuki": 2}
"""k of each scheme."""


@final
@dataclass(frozen=True)
class Composition(Step):
    """Substeps c_1 h, ..., c_k h of a symmetric step, of any even order; symplectic if the step is.

    Parameters
    ----------
    step : Step
        A symmetric step, one with the attribute ``symmetric = True``.
    order : int
        Even, and at least the order of the step.
    scheme : "suzuki" or "yoshida"
        Five or three substeps to raise the order by 2. Suzuki's have smaller errors, and need shorter steps backwards.

    Attributes
    ----------
    sizes : tuple of float
        c_1, ..., c_k, with sum 1.

    Raises
    ------
    InputError
        If an argument is not valid.

    Examples
    --------
    >>> import liehom as lh
    >>> step = lh.Composition(lh.SphericalMidpoint(), 4)
    >>> step.order, [round(c, 4) for c in step.sizes]
    (4, [0.4145, 0.4145, -0.658, 0.4145, 0.4145])
    """

    step: Step
    order: int = 4
    scheme: str = "suzuki"
    sizes: tuple[float, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not isinstance(self.step, Step) or not getattr(self.step, "symmetric", False):
            raise InputError(
                f"a composition is of a symmetric step, such as liehom.SphericalMidpoint(), got {self.step!r}"
            )
        order = self.order
        if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < self.step.order or order % 2:
            raise InputError(f"the order is {order!r}, expected an even integer from {self.step.order}")
        if self.scheme not in REPETITIONS:
            raise InputError(f"the scheme is {self.scheme!r}, expected one of {', '.join(map(repr, REPETITIONS))}")
        sizes = (1.0,)
        double = 2 * REPETITIONS[self.scheme]
        for p in range(self.step.order, int(order), 2):
            c = 1 / (double - double ** (1 / (p + 1)))
            around = tuple(c * x for x in sizes) * (double // 2)
            sizes = (*around, *((1 - double * c) * x for x in sizes), *around)
        object.__setattr__(self, "sizes", sizes)

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    @property
    def prepares_by_psi(self) -> bool:
        return self.step.prepares_by_psi

    @property
    def trace_key(self) -> Hashable:
        return self.step.trace_key

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Composition:
        """The composition of the prepared step."""
        return self.with_prepared(step=self.step.prepare(action, psi, m, t))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        def point(h: Values) -> Values:
            here, passed = m, 0.0
            for c in self.sizes:
                here = self.step.at(action, psi, here, t + passed * h).point(c * h)
                passed += c
            return here

        return LocalStep(action, m, point=point)
