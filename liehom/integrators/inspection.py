"""Inspection: what a step can do at given points, without a step being made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.conserving import ConservingStep
from liehom.correctors.isotropy.corrected import CorrectedStep
from liehom.correctors.step import Generator
from liehom.integrators.engine import Problem
from liehom.typing import Array, IntegerArray


@final
@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """Orders, ranks and singular values of a step at points, by `Propagator.inspect`.

    Attributes
    ----------
    step : str
        The method, as printed.
    wanted_order : int
        The order of the step.
    order : int array of shape (...,)
        The order to which the step captures the orbit of each point.
    residual : array of shape (...,)
        The largest relative residual of the linear systems of Theorem 5; 0 for steps without correction.
    singular_value : array of shape (...,)
        The smallest singular value that decides the range condition (6.2); inf for steps without correction and at
        equilibria.
    rank, orbit_dimension : int arrays of shape (...,)
        The rank met in the range condition, 0 where it does not matter, and the dimension of the orbit, which it should
        be.
    """

    step: str
    wanted_order: int
    order: IntegerArray
    residual: Array
    singular_value: Array
    rank: IntegerArray
    orbit_dimension: IntegerArray

    def __str__(self) -> str:
        lines = [f"{self.step} at {self.order.size} point{'' if self.order.size == 1 else 's'}"]
        short = int(np.sum(self.order < self.wanted_order))
        least = int(self.order.min(initial=self.wanted_order))
        lines.append(f"order {least}" + (f": {self.wanted_order} is not reached at {short}" if short else ""))
        if np.isfinite(self.singular_value).any():
            index = np.unravel_index(int(np.argmin(self.singular_value)), self.singular_value.shape)
            place = tuple(int(i) for i in index)
            found = f"smallest singular value {self.singular_value[place]:.3g}, rank {self.rank[place]} of "
            lines.append(f"{found}{self.orbit_dimension[place]}" + (f", at point {place}" if place else ""))
        return "\n".join(lines)


def inspected(problem: Problem) -> Inspection:
    """The `Inspection` of the step of a problem at its initial points and time.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2, 1)), ["1", "1/4 + m1", "0"])
    >>> problem = lh.Propagator(field, lh.Corrected("euler", 3)).problem((0, 0), [1.0, 0.0, 0.0])
    >>> inspected(problem).order
    array(3)
    """
    points: Any = np.asarray(problem.start)
    lead = points.shape[:-1]
    dimension = np.broadcast_to(np.asarray(problem.orbit_dimension), lead)
    times = np.full(lead, problem.span[0])
    order = np.full(lead, problem.step.order)
    residual, singular, rank = np.zeros(lead), np.full(lead, np.inf), np.zeros(lead, dtype=int)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        psi = Generator(problem.bound, problem.orbit_dimension, points)
        local = problem.step.at(problem.action, psi, points, times[..., None])
        inner = local.base if isinstance(local, ConservingStep) else local
        if isinstance(inner, CorrectedStep):
            found: Any = inner.correction
            # at an equilibrium every order is reached
            order = np.where(found.leading == 0, problem.step.order, np.minimum(found.reached, problem.step.order))
            residual = np.broadcast_to(found.residual, lead)
            singular, rank = np.broadcast_to(found.singular_value, lead), np.broadcast_to(found.rank, lead)
    return Inspection(repr(problem.step), problem.step.order, order, residual, singular, rank, dimension)
