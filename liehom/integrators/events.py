"""Events: zeros of functions g(t, y) along trajectories, located on the dense output of a step.

Imports correctors, errors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from liehom.errors import InputError

ITERATIONS = 100


@final
class Events:
    """The events of a run, for one trajectory or an ensemble.

    Parameters
    ----------
    functions : callable or sequence of callables
        g(t, y) with y (N,); for an ensemble y (..., N) and t (...,), result (...,). As in solve_ivp a function may
        have the attributes `terminal` (bool, or the number of occurrences that ends the integration) and
        `direction` (positive: only where g rises; negative: only where it falls).

    Raises
    ------
    InputError
        If one is not a function, or returns an array of another shape.

    Examples
    --------
    >>> events = Events(lambda t, y: y[..., 0])
    >>> events.count
    1
    """

    def __init__(self, functions: Any) -> None:
        listed = [functions] if callable(functions) else list(functions)
        for i, g in enumerate(listed):
            if not callable(g):
                raise InputError(f"events[{i}] is {g!r}, expected a function g(t, y)")
        self.functions: Sequence[Callable[[Any, Any], Any]] = listed
        self.directions = [float(getattr(g, "direction", 0)) for g in listed]
        self.terminal = [_limit(getattr(g, "terminal", False), i) for i, g in enumerate(listed)]

    @property
    def count(self) -> int:
        """How many events there are."""
        return len(self.functions)

    def values(self, t: Any, y: Any) -> list[Any]:
        """g_i(t, y), each of shape (...,)."""
        found = []
        for i, g in enumerate(self.functions):
            value = np.asarray(g(t if np.ndim(t) else t[()], y))
            if value.shape != y.shape[:-1]:
                raise InputError(
                    f"events[{i}] has shape {value.shape} at y of shape {y.shape}, expected {y.shape[:-1]} "
                    "(one number for each trajectory: write y[..., 0])"
                )
            found.append(value)
        return found

    def crossed(self, i: int, before: Any, after: Any) -> Any:
        """Where event i occurs between two points, shape (...,)."""
        rises = (before < 0) & (after >= 0)
        falls = (before > 0) & (after <= 0)
        if self.directions[i] > 0:
            return rises
        return falls if self.directions[i] < 0 else rises | falls

    def locate(self, i: int, at: Callable[[Any], tuple[Any, Any]], h: Any, before: Any, here: Any) -> Any:
        """The step sizes s in (0, h] at which event i occurs, where `here`; by bisection and false position.

        Parameters
        ----------
        at : callable
            s (...,) -> (t, y).
        """
        low, high = np.zeros_like(h), np.where(here, h, 0.0)
        left = before.astype(h.dtype)
        right = self.values(*at(high))[i].astype(h.dtype)
        side = np.zeros(np.shape(h))
        for count in range(ITERATIONS):
            if bool(np.all(~here | (np.abs(high - low) <= 4 * np.finfo(h.dtype).eps * np.abs(h)) | (right == 0))):
                break
            spread = right - left
            secant = (low * right - high * left) / np.where(spread == 0, 1.0, spread)
            middle = np.where((spread == 0) | (count % 4 == 3), (low + high) / 2, secant)
            value = self.values(*at(middle))[i]
            same = np.sign(value) == np.sign(left)
            # Illinois: the end that stays twice in a row has its value halved
            right = np.where(~same, value, np.where(side == 1, right / 2, right))
            left = np.where(same, value, np.where(side == -1, left / 2, left))
            low, high = np.where(same, middle, low), np.where(same, high, middle)
            side = np.where(same, 1, -1)
        return high


def _limit(terminal: Any, i: int) -> float:
    """The number of occurrences that ends the integration."""
    if isinstance(terminal, bool | np.bool_) or terminal is None:
        return 1.0 if terminal else np.inf
    if isinstance(terminal, int | np.integer | float) and terminal == int(terminal) and terminal >= 0:
        return float(terminal) if terminal > 0 else np.inf
    raise InputError(f"events[{i}].terminal is {terminal!r}, expected a bool or a positive number of occurrences")
