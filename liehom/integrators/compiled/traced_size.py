"""Adaptive step sizes of a traced step: the rules of `liehom.integrators.run.control` on tracers and JAX arrays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.correctors.step_size import StepLimits, over_sites
from liehom.homogeneous import Action
from liehom.integrators.run.automaton import FIRST_STEP_FRACTION
from liehom.integrators.run.clock import MAX_RATE, MIN_RATE, NEWTON_ITERATIONS, SLACK
from liehom.integrators.run.control import (
    MAX_GROWTH,
    Tolerance,
    is_large_enough,
    judged,
    known_size,
    largest_size,
    length,
    time_scale,
)
from liehom.series.arrays import namespace
from liehom.tracing import while_loop
from liehom.typing import Real, Values

EPS = float(np.finfo(np.float64).eps)


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
    moves : float
        Bound for the way of a point in a step, in units of |m|; inf for none.
    """

    rtol: Real
    atol: Real
    max_step: Real
    end: Real
    direction: Real
    tiny: Real
    moves: float = float("inf")


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
    xp = namespace(m, t)
    left = xp.abs(limits.end - t)
    bound: Any = largest_size(limits.max_step, left)
    if limits.moves < np.inf:
        bound = xp.minimum(bound, limits.moves * time_scale(psi.field, m, t))
    h: Any = xp.minimum(proposal, bound)
    if local.estimate_order is None:
        axes = len(psi.field.sites)
        speed = over_sites(length(m), axes) / time_scale(psi.field, m, t)
        own = StepLimits(Tolerance(limits.rtol, limits.atol, axes).norm(m), speed, h, axes)
        h = known_size(action, psi, local, m, t, step.order, own)
    return limits.direction * h, is_large_enough(h, limits.tiny, left)


def judgement(
    limits: SizeLimits, local: LocalStep, m: Values, size: Values, axes: int = 0
) -> tuple[Values | bool, Values]:
    """Whether a step of signed size (..., 1) is accepted, and the size proposed for the next step.

    The last `axes` leading axes are those of a lattice, which has one size.

    Examples
    --------
    >>> limits = SizeLimits(1e-3, 1e-3, 0.5, 0.0, -1.0, 1e-15)
    >>> import liehom as lh
    >>> local = LocalStep(lh.Action(lh.defining(lh.so(2))), np.zeros(2))
    >>> accepted, proposal = judgement(limits, local, np.zeros(2), np.array([-0.25]))
    >>> bool(accepted), float(proposal)
    (True, 2.0)
    """
    h: Values = size[..., 0]
    if local.estimate_order is None:
        return True, MAX_GROWTH * abs(h)
    allowed = Tolerance(limits.rtol, limits.atol, axes).norm(m)
    return judged(local.estimate(size), allowed, h, local.estimate_order, axes)


def first_size(limits: SizeLimits, local: LocalStep, psi: Generator, m: Values, t: Values) -> Values | None:
    """Size of the first step of an embedded pair, without sign; None where the Taylor coefficients give it.

    Examples
    --------
    >>> import liehom as lh
    >>> field, m = lh.GeneratorField(lh.defining(lh.so(2)), [4]), np.array([1.0, 0.0])
    >>> psi, local = Generator(field, 1), LocalStep(lh.Action(field.representation), m)
    >>> first_size(SizeLimits(1e-3, 1e-3, 1.0, 1.0, 1.0, 1e-15), local, psi, m, np.array(0.0))
    """
    if local.estimate_order is None:
        return None
    xp = namespace(m, t)
    bound = largest_size(limits.max_step, xp.abs(limits.end - t))
    found: Values = xp.minimum(bound, FIRST_STEP_FRACTION * time_scale(psi.field, m, t))
    return found


def size_to_stop(
    local: LocalStep | None, h: Values, left: Values, bounds: tuple[Real, Real]
) -> tuple[Values, Values, Values | bool]:
    """A step size that ends at a stop in the time `left` if the step reaches it: on tracers.

    Parameters
    ----------
    local : LocalStep or None
        A step with a time reparametrization τ; None if the time that passes is the size.
    h, left : traced arrays of shape ()
        The signed size of the step, and the signed time to the stop.
    bounds : (traced direction, traced time below which a rest is not a step)

    Returns
    -------
    size, reached, found : traced arrays of shape ()
        The size, whether it is that to the stop, and whether τ(size) = left if so.
    """
    direction, tiny = bounds
    if local is None:
        reached = direction * (left - h) <= SLACK * np.abs(h) + tiny
        return np.where(reached, left, h), reached, True
    size: Any = h
    tape = size.tape
    passed = local.time(h)
    reached = direction * (left - passed) <= SLACK * np.abs(h)

    def newton(wanted: Values, s: Values) -> tuple[list[Values], Values]:
        slope = 1 + sum(k * c * s ** (k - 1) for k, c in local.clock)
        new = s + (left - local.time(s)) / np.clip(slope, MIN_RATE, MAX_RATE)
        again = wanted & (np.abs(new - s) > 2 * EPS * np.abs(s))
        return [again, np.where(wanted, new, s)], again

    unsolved, size = while_loop(newton, [reached, h], tape, NEWTON_ITERATIONS, guarded=True)
    return size, reached, ~unsolved
