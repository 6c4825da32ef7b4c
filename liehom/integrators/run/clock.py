"""The time reparametrization τ of a step, its "clock": τ(h) is the time that passes in a step of size h.

The clock is admissible over a step if τ increases everywhere at between 1/5 and 5 times the nominal rate 1. The step
size s with τ(s) = a given time is found by Newton's method.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.step import LocalStep
from liehom.typing import Array, BooleanArray, Values

NEWTON_ITERATIONS = 60
MIN_RATE = 0.2
"""Smallest admissible rate dτ/dh."""
MAX_RATE = 5.0
"""Largest admissible rate dτ/dh."""
RATE_SAMPLES = 4
"""Equal parts of a step over which the rate is measured."""
MAX_HALVINGS = 40
SLACK = 1e-9
"""A step that ends this close to the end of the integration, in units of the step, ends there."""


def clock_at(local: LocalStep, h: Values) -> tuple[BooleanArray, Array]:
    """Whether the clock is admissible over [0, h], bool (...,), and the time τ(h), both for h of shape (...,).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> local = LocalStep(lh.Action(lh.defining(lh.so(2))), np.zeros(2))
    >>> runs, passed = clock_at(local, np.array(0.1))
    >>> bool(runs), float(passed)
    (True, 0.1)
    """
    size: Any = h
    if not local.clock:
        return np.ones(np.shape(size), dtype=bool), size
    parts = np.arange(RATE_SAMPLES + 1).reshape(-1, *[1] * np.ndim(size)) / RATE_SAMPLES * size
    times: Any = local.time(parts)
    advance = (times[1:] - times[:-1]) * np.sign(size)
    part = np.abs(size) / RATE_SAMPLES
    runs = ((advance > MIN_RATE * part) & (advance < MAX_RATE * part)).all(axis=0)
    return runs | (size == 0), times[-1]


def size_for(local: LocalStep, time: Array, guess: Array) -> Array:
    """Step sizes s (...,) with τ(s) = time, of the sign of time; 0 where time is 0, NaN if no s is found.

    Parameters
    ----------
    local : LocalStep
    time : array of shape (...,)
    guess : array of shape (...,)
        Size of a step over which the clock is admissible; s is sought within it, or beyond it if time is beyond.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> local = LocalStep(lh.Action(lh.defining(lh.so(2))), np.zeros(2))
    >>> size_for(local, np.array([0.5]), np.array([1.0])).tolist()
    [0.5]
    """
    if not local.clock:
        return time + 0 * guess
    reached: Any = local.time(guess)
    fraction = np.divide(time, reached, out=np.ones_like(time), where=reached != 0)
    within = (fraction >= 0) & (fraction <= 1)
    s = np.where(within, fraction * guess, time)
    low, high = 0 * s, np.where(within, guess, np.sign(time) * np.inf)
    eps = np.finfo(s.dtype).eps
    settled = np.zeros(np.shape(s), dtype=bool)  # a trajectory does not depend on those it is solved with
    for _ in range(NEWTON_ITERATIONS):
        times: Any = local.time(np.stack([s - 1e-4 * s, s, s + 1e-4 * s]))
        before, now, beyond = times
        missing = time - now
        short = missing * np.sign(time) > 0
        low, high = np.where(short, s, low), np.where(short, high, s)
        slope = (beyond - before) / np.where(s == 0, 1.0, 2e-4 * s)
        new = s + missing / np.clip(slope, MIN_RATE, MAX_RATE)
        outside = (new - low) * (new - high) > 0
        new = np.where(outside, np.where(np.isfinite(high), (low + high) / 2, 2 * s), new)
        done = (np.abs(new - s) <= 2 * eps * np.abs(s)) | (missing == 0)
        s = np.where(settled | (missing == 0), s, new)
        settled = settled | done
        if bool(settled.all()):
            break
    solved = np.abs(local.time(s) - time) <= 64 * eps * np.abs(time)
    return np.where(solved, s, np.nan)


def fitted(local: LocalStep, h: Array, left: Array, *, halve: bool) -> tuple[Array, Array, BooleanArray, BooleanArray]:
    """Step sizes that end within the time `left`: h, or the size that takes exactly that time if it is shorter.

    Parameters
    ----------
    local : LocalStep
    h : array of shape (...,)
        Signed; 0 for trajectories that take no step.
    left : array of shape (...,)
        The time to the end, of the same sign.
    halve : bool
        Whether h may be halved until the clock is admissible.

    Returns
    -------
    h, passed, last, runs : arrays of shape (...,)
        The size, the time that passes, whether that is `left`, and whether the clock is admissible over the step.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> local = LocalStep(lh.Action(lh.defining(lh.so(2))), np.zeros(2))
    >>> [float(x) for x in fitted(local, np.array(0.5), np.array(0.25), halve=False)]
    [0.25, 0.25, 1.0, 1.0]
    """
    runs, passed = clock_at(local, h)
    for _ in range(MAX_HALVINGS if halve else 0):
        if bool(runs.all()):
            break
        h = np.where(runs, h, h / 2)
        runs, passed = clock_at(local, h)
    over = (h != 0) & (np.sign(h) * (left - passed) <= SLACK * np.abs(h))
    # a clock that is not admissible over the whole step may still be so up to the end
    last = over if bool(runs.all()) else np.where(runs, over, np.abs(left) <= MAX_RATE * np.abs(h))
    if not bool(last.any()):
        return h, passed, last, runs
    s = size_for(local, np.where(last, left, 0), np.where(runs, h, left))
    last = last & clock_at(local, s)[0] & (np.abs(s) <= np.abs(h) * (1 + SLACK * 2 * MAX_RATE))
    return np.where(last, s, h), np.where(last, left, passed), last, last | (runs & ~over)
