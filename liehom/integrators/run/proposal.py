"""StepProposal: a step of all trajectories of a run before it is committed, with the positions within it.

`logging.getLogger("liehom.integrators")` gets one line at level DEBUG for each step and each failure of a run.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.correctors.step import LocalStep
from liehom.integrators.run.clock import size_for
from liehom.typing import Array, BooleanArray

LOGGER = logging.getLogger("liehom.integrators")


@final
@dataclass(frozen=True, slots=True)
class StepProposal:
    """A step of all trajectories before it is committed.

    Attributes
    ----------
    local : LocalStep
    t, m : arrays of shape (...,) and (..., N)
        Times and points before the step.
    h : array of shape (...,)
        Signed step sizes; 0 for trajectories that do not move.
    after, made : arrays of shape (...,) and (..., N)
        Times and points after the step.
    moves, last : bool arrays of shape (...,)
        Which trajectories move, and for which the step ends at the end of the time span.
    nominal : bool
        Whether time advances by the parameter of the step rather than by its time reparametrization τ.

    Examples
    --------
    >>> import liehom as lh
    >>> action, m, t, yes = lh.Action(lh.defining(lh.so(2))), np.array([1.0, 0.0]), np.array(0.0), np.array(True)
    >>> local = LocalStep(action, m, lambda h: (h * np.array([1.0]),))
    >>> made = action.act(np.array([0.5]), m)
    >>> proposal = StepProposal(local, t, m, t + 0.5, t + 0.5, made, yes, yes, nominal=False)
    >>> proposal.point(np.array(0.25), yes).round(6).tolist() == [round(np.cos(0.25), 6), round(np.sin(0.25), 6)]
    True
    """

    local: LocalStep
    t: Array
    m: Array
    h: Array
    after: Array
    made: Array
    moves: BooleanArray
    last: BooleanArray
    nominal: bool

    def log(self, active: BooleanArray) -> None:
        """Log times, sizes, and the numbers of active trajectories that accept and reject the step."""
        t, h = (x[self.moves] for x in (self.t, self.h))
        ranges = "".join(f", {n} {x.min():.17g} to {x.max():.17g}" for n, x in (("t", t), ("h", h)) if x.size)
        LOGGER.debug("step: %d accepted, %d rejected%s", self.moves.sum(), (active & ~self.moves).sum(), ranges)

    def position(self, s: Array) -> tuple[Array, Array]:
        """(t, y) within the step at the parameter s (...,)."""
        passed = s if self.nominal else self.local.time(s)
        low, high = np.minimum(self.t, self.after), np.maximum(self.t, self.after)
        t = np.where(s == self.h, self.after, np.clip(self.t + passed, low, high))
        point: Any = self.local.point(s[..., None])
        return t, point

    def point(self, time: Array, here: BooleanArray) -> Array:
        """The points (..., N) at a time within the step, for the trajectories `here`."""
        elapsed = np.where(here, time - self.t, 0)
        s = elapsed if self.nominal else size_for(self.local, elapsed, np.where(here, self.h, 0))
        return self.position(np.where(here & (time == self.after), self.h, s))[1]
