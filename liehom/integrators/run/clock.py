"""The clock of a step: whether it runs, and the step size s with tau(s) = a given time, by Newton.

A clock runs over a step if it advances everywhere at between 1/5 and 5 times the nominal rate.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.step import LocalStep

NEWTON_ITERATIONS = 60
MIN_RATE = 0.2
MAX_RATE = 5.0
RATE_SAMPLES = 4
MAX_HALVINGS = 40
SLACK = 1e-9
"""A step that ends this close to the end of the integration, in units of the step, ends there."""


def has_clock(local: LocalStep) -> bool:
    """Whether the step has a clock of its own.

    Examples
    --------
    >>> has_clock(LocalStep(lambda h: ()))
    False
    """
    return type(local).time is not LocalStep.time


def clock_at(local: LocalStep, h: Any) -> tuple[Any, Any]:
    """Whether the clock runs over [0, h], bool (...,), and tau(h), for h of shape (...,).

    Examples
    --------
    >>> import numpy as np
    >>> runs, passed = clock_at(LocalStep(lambda h: ()), np.array(0.1))
    >>> bool(runs), float(passed)
    (True, 0.1)
    """
    if not has_clock(local):
        return np.ones(np.shape(h), dtype=bool), h
    parts = np.arange(RATE_SAMPLES + 1).reshape(-1, *[1] * np.ndim(h)) / RATE_SAMPLES * h
    times = local.time(parts)
    advance = (times[1:] - times[:-1]) * np.sign(h)
    part = np.abs(h) / RATE_SAMPLES
    runs = ((advance > MIN_RATE * part) & (advance < MAX_RATE * part)).all(axis=0)
    return runs | (h == 0), times[-1]


def size_for(local: LocalStep, time: Any, guess: Any) -> Any:
    """s (...,) with local.time(s) = time, of the sign of time; 0 where time is 0, NaN where none is found.

    Parameters
    ----------
    local : LocalStep
    time : array of shape (...,)
    guess : array of shape (...,)
        The size of a step over which the clock runs; s is looked for within it, or beyond it where time is.

    Examples
    --------
    >>> import numpy as np
    >>> size_for(LocalStep(lambda h: ()), np.array([0.5]), np.array([1.0])).tolist()
    [0.5]
    """
    if not has_clock(local):
        return time + 0 * guess
    reached = local.time(guess)
    share = np.divide(time, reached, out=np.ones_like(time), where=reached != 0)
    within = (share >= 0) & (share <= 1)
    s = np.where(within, share * guess, time)
    low, high = 0 * s, np.where(within, guess, np.sign(time) * np.inf)
    eps = np.finfo(s.dtype).eps
    settled = np.zeros(np.shape(s), dtype=bool)  # a trajectory does not depend on those it is solved with
    for _ in range(NEWTON_ITERATIONS):
        before, now, beyond = local.time(np.stack([s - 1e-4 * s, s, s + 1e-4 * s]))
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


def fitted(local: LocalStep, h: Any, left: Any, *, halve: bool) -> tuple[Any, Any, Any, Any]:
    """A step of size h, or the one that ends exactly after the time `left`, if that is shorter.

    Parameters
    ----------
    local : LocalStep
    h : array of shape (...,)
        Signed; 0 where no step is made.
    left : array of shape (...,)
        The time to the end, of the same sign.
    halve : bool
        Whether h may be halved until the clock runs.

    Returns
    -------
    h, passed, last, runs : arrays of shape (...,)
        The size, the time that passes, whether that is `left`, and whether the clock runs over the step.

    Examples
    --------
    >>> import numpy as np
    >>> [float(x) for x in fitted(LocalStep(lambda h: ()), np.array(0.5), np.array(0.25), halve=False)]
    [0.25, 0.25, 1.0, 1.0]
    """
    runs, passed = clock_at(local, h)
    for _ in range(MAX_HALVINGS if halve else 0):
        if bool(runs.all()):
            break
        h = np.where(runs, h, h / 2)
        runs, passed = clock_at(local, h)
    over = (h != 0) & (np.sign(h) * (left - passed) <= SLACK * np.abs(h))
    # where the clock does not run over the whole step it may still run up to the end
    last = over if bool(runs.all()) else np.where(runs, over, np.abs(left) <= MAX_RATE * np.abs(h))
    if not bool(last.any()):
        return h, passed, last, runs
    s = size_for(local, np.where(last, left, 0), np.where(runs, h, left))
    last = last & clock_at(local, s)[0] & (np.abs(s) <= np.abs(h) * (1 + SLACK * 2 * MAX_RATE))
    return np.where(last, s, h), np.where(last, left, passed), last, last | (runs & ~over)
