"""DenseSolution: the solution as a function of time, on the manifold and to the order of the step.

Within a step it is s -> Exp(xi(m, s)) m at time tau(s); the step is prepared again where it is asked for, so
that only points and step sizes are kept.  Imports clock, correctors.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step, apply_factors
from liehom.homogeneous import Action
from liehom.integrators.clock import size_for


@final
class DenseSolution:
    """The solution of one trajectory or of an ensemble as a function of t.

    Parameters
    ----------
    action, psi, step
        What was integrated.
    times : array (n + 1, ...)
    points : array (n + 1, ..., N)
    sizes : array (n, ...)
        Step sizes in the step's own parameter, 0 where a trajectory stood still.
    nominal : bool
        Whether time is the parameter of the step rather than its clock.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> sol = lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.25, dense_output=True).sol
    >>> bool(np.allclose(sol(0.3), [np.cos(0.3), np.sin(0.3)])), sol([0.1, 0.2, 0.3]).shape
    (True, (2, 3))
    """

    def __init__(
        self, action: Action, psi: Generator, step: Step, times: Any, points: Any, sizes: Any, *, nominal: bool
    ) -> None:
        self._action, self._psi, self._step = action, psi, step
        self._times, self._points, self._sizes, self._nominal = times, points, sizes, nominal
        self._prepared: tuple[int, LocalStep] | None = None

    @property
    def t_min(self) -> Any:
        """The earliest time, (...,)."""
        return np.nanmin(self._times, axis=0)

    @property
    def t_max(self) -> Any:
        """The latest time, (...,)."""
        return np.nanmax(self._times, axis=0)

    def __call__(self, t: Any) -> Any:
        """The points at times t: a number gives (..., N), an array (k,) gives (..., N, k).

        Outside the interval of integration the first or last step is continued, as solve_ivp's dense output does.
        """
        queries = np.asarray(t, dtype=self._times.dtype)
        flat = queries.reshape(-1)
        out = np.full((*self._points.shape[1:], flat.size), np.nan, dtype=self._points.dtype)
        index = self._segments(flat)
        for k, time in enumerate(flat):
            for i in np.unique(index[k]):
                here = index[k] == i
                out[..., k] = np.where(here[..., None], self._at(int(i), time, here), out[..., k])
        return out[..., 0] if queries.ndim == 0 else out

    def _segments(self, flat: Any) -> Any:
        """For each query (k, ...) the index of the step whose interval contains it."""
        moved = self._sizes != 0
        last = moved.shape[0] - 1 - np.argmax(moved[::-1], axis=0)
        direction = np.sign(np.nansum(self._times[1:] - self._times[:-1], axis=0))
        starts = self._times[:-1]
        found = np.empty((flat.size, *starts.shape[1:]), dtype=int)
        for k, time in enumerate(flat):
            with np.errstate(invalid="ignore"):
                passed = (direction * (time - starts) >= 0) & moved
            found[k] = np.clip(passed.sum(axis=0) - 1, 0, last)
        return found

    def _at(self, i: int, time: Any, here: Any) -> Any:
        point, start = self._points[i], self._times[i]
        clean = np.where(np.isfinite(start), start, 0.0)
        finite = np.where(np.isfinite(point), point, self._points[0])
        if self._prepared is None or self._prepared[0] != i:
            self._prepared = (i, self._step.at(self._action, self._psi, finite, clean[..., None]))
        local = self._prepared[1]
        elapsed = np.where(here & (self._sizes[i] != 0), time - clean, 0.0)
        s = elapsed if self._nominal else size_for(local, elapsed, np.where(here, self._sizes[i], 0))
        return apply_factors(self._action, local.factors(s[..., None]), finite)
