"""To hit a time: the step size s with tau(s) = a given time, by Newton. Imports correctors, errors."""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.step import LocalStep

ITERATIONS = 50
SLOWEST = 0.2
FASTEST = 5.0


def size_for(local: LocalStep, time: Any, guess: Any) -> Any:
    """s (...,) with local.time(s) = time, starting from a guess of the same sign; 0 where time is 0.

    Examples
    --------
    >>> import numpy as np
    >>> size_for(LocalStep(lambda h: ()), np.array([0.5]), np.array([1.0])).tolist()
    [0.5]
    """
    if not has_clock(local):
        return time + 0 * guess
    low, high = 0 * guess, np.where(time == 0, 0, guess)
    reached = np.abs(local.time(high))
    inside = reached >= np.abs(time)  # else the step is continued beyond its end
    s = np.where(
        inside & (reached > 0), high * np.abs(time) / np.where(reached > 0, reached, 1.0), np.where(time == 0, 0, time)
    )
    eps = np.finfo(np.result_type(s, float)).eps
    for _ in range(ITERATIONS):
        missing = time - local.time(s)
        short = missing * np.sign(time) > 0
        low, high = np.where(short, s, low), np.where(short, high, s)
        delta = 1e-4 * s
        span = np.where(s == 0, 1.0, 2 * delta)
        slope = (local.time(s + delta) - local.time(s - delta)) / span
        new = s + missing / np.clip(slope, SLOWEST, FASTEST)
        outside = inside & ((new - low) * (new - high) > 0)
        new = np.where(outside, (low + high) / 2, new)
        done = np.abs(new - s) <= 2 * eps * np.abs(s)
        s = new
        if bool(np.all(done)):
            break
    return np.where(time == 0, 0 * s, s)


def has_clock(local: LocalStep) -> bool:
    """Whether the step has a clock of its own."""
    return type(local).time is not LocalStep.time


def runs(local: LocalStep, h: Any) -> Any:
    """Whether the clock is usable over the step: it advances at between 1/5 and 5 times the nominal rate.

    Examples
    --------
    >>> import numpy as np
    >>> bool(runs(LocalStep(lambda h: ()), np.array(0.1)))
    True
    """
    if not has_clock(local):
        return np.ones(np.shape(h), dtype=bool)
    good = np.ones(np.shape(h), dtype=bool)
    safe = np.where(h == 0, 1.0, h)
    for part in (0.5, 1.0):
        rate = local.time(part * h) / (part * safe)
        good &= (h == 0) | ((rate > SLOWEST) & (rate < FASTEST))
    return good
