"""Adaptive step sizes of a traced step: the rules of `liehom.integrators.run.control`, run on tracers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.homogeneous import Action
from liehom.integrators.run.control import (
    MAX_GROWTH,
    Tolerance,
    defects_of,
    is_large_enough,
    judged,
    largest_size,
    length,
    size_from_defects,
    time_scale,
)
from liehom.typing import Real, Values


class SizeLimits(NamedTuple):
    """Tolerances and bounds of adaptive step sizes: numbers of a run, or tracers for them.

    Attributes
    ----------
    rtol, atol : float
    max_step : float
    end : float
        The time at the end.
    direction : float
        1, or -1 if time decreases.
    tiny : float
        Below this size time does not advance.
    """

    rtol: Real
    atol: Real
    max_step: Real
    end: Real
    direction: Real
    tiny: Real


def tried_size(
    limits: SizeLimits,
    action: Action,
    psi: Generator,
    local: LocalStep,
    step: Step,
    m: Values,
    t: Values,
    proposal: Values,
) -> tuple[Values, Values]:
    """The signed size of the next step, and whether time advances by it; if not, the run ends the trajectory.

    Parameters
    ----------
    limits : SizeLimits
    action : Action
    psi : Generator
    local : LocalStep
        ``step.at(action, psi, m, t)``
    step : Step
    m : array of shape (..., N)
    t, proposal : arrays of shape (...,)
        Time, and the size proposed by the step before.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> action, psi, m = lh.Action(field.representation), Generator(field, 1), np.array([1.0, 0.0])
    >>> local = lh.RKMK("heun").at(action, psi, m, np.array([0.0]))
    >>> limits = SizeLimits(1e-3, 1e-3, 0.5, 0.0, -1.0, 1e-15)
    >>> h, certain = tried_size(limits, action, psi, local, lh.RKMK("heun"), m, np.array(1.0), np.array(8.0))
    >>> float(h), bool(certain)
    (-0.5, True)
    """
    left = np.abs(limits.end - t)
    h: Any = np.minimum(proposal, largest_size(limits.max_step, left))
    if getattr(local, "estimate", None) is None:
        speed = length(m) / time_scale(psi.field, m, t)
        defects = defects_of(action, psi, local, m, t, step.order)
        h = size_from_defects(defects, Tolerance(limits.rtol, limits.atol).norm(m), speed, h)
    return limits.direction * h, is_large_enough(h, limits.tiny, left)


def judgement(limits: SizeLimits, local: LocalStep, m: Values, size: Values) -> tuple[Values | bool, Values]:
    """Whether a step of signed size (..., 1) is accepted, and the size proposed for the next step.

    Examples
    --------
    >>> limits = SizeLimits(1e-3, 1e-3, 0.5, 0.0, -1.0, 1e-15)
    >>> accepted, proposal = judgement(limits, LocalStep(None, np.zeros(2)), np.zeros(3), np.array([-0.25]))
    >>> bool(accepted), float(proposal)
    (True, 2.0)
    """
    h: Values = size[..., 0]
    estimate = getattr(local, "estimate", None)
    if estimate is None:
        return True, MAX_GROWTH * np.abs(h)
    allowed = Tolerance(limits.rtol, limits.atol).norm(m)
    return judged(estimate(size), allowed, h, local.estimate_order)  # type: ignore[attr-defined]
