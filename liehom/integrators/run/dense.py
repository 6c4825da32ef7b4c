"""DenseSolution: the solution as a function of time, on the manifold and to the order of the step.

Within a step the solution is s -> Exp(xi(m, s)) m at the time τ(s). A step is computed again when a time in it is asked
for, so only points and step sizes are stored.
"""

from __future__ import annotations

import pickle
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import ConvergenceError, ShapeError
from liehom.homogeneous import Action
from liehom.integrators.run.clock import size_for
from liehom.typing import Array, IntegerArray


@final
class DenseSolution:
    """The solution of one trajectory or of an ensemble as a function of time; call it with a time or a list of times.

    Parameters
    ----------
    action : Action
    psi : Generator
    step : Step
        The method that made the steps.
    times : array of shape (n + 1, ...)
        Times of every trajectory from its initial one on without gaps, filled up with NaN.
    points : array of shape (n + 1, ..., N)
    sizes : array of shape (n, ...)
        Step sizes in the parameter of the step, filled up with 0.
    nominal : bool
        Whether time is the parameter of the step rather than its time reparametrization τ.

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
        self, action: Action, psi: Generator, step: Step, times: Array, points: Array, sizes: Array, *, nominal: bool
    ) -> None:
        self._action, self._psi, self._step = action, psi, step
        self._times, self._points, self._sizes, self._nominal = times, points, sizes, nominal
        self._shape: tuple[int, ...] = points.shape[1:-1]
        count = np.isfinite(times).sum(axis=0)  # points of each trajectory
        self._last_point = np.reshape(count - 1, -1)
        last = np.take_along_axis(times, (count - 1)[None], axis=0)[0]
        self._direction = np.where(last >= times[0], 1, -1)
        # times in the direction of integration, trajectory by trajectory, for searches
        rows = (self._direction * times).reshape(len(times), -1).T
        self._rows = [np.ascontiguousarray(row[:k]) for row, k in zip(rows, count.reshape(-1), strict=True)]
        self._prepared: tuple[IntegerArray, LocalStep] | None = None

    @property
    def steps(self) -> tuple[Array, Array, Array]:
        """Times (n + 1, ...), points (n + 1, ..., N) and sizes (n, ...) of the steps of each trajectory, filled up."""
        return self._times, self._points, self._sizes

    def __getstate__(self) -> dict[str, Any]:
        try:
            pickle.dumps(self._psi.field)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise pickle.PicklingError(
                f"the dense output calls psi, which cannot be pickled ({error}): define psi as a function of a module, "
                "or write the rest of the solution by sol.save(path)"
            ) from None
        return self.__dict__

    @property
    def t_min(self) -> Array:
        """The earliest time of each trajectory, shape (...,)."""
        earliest: Array = np.nanmin(self._times, axis=0)
        return earliest

    @property
    def t_max(self) -> Array:
        """The latest time of each trajectory, shape (...,)."""
        latest: Array = np.nanmax(self._times, axis=0)
        return latest

    def __call__(self, t: npt.ArrayLike) -> Array:
        """Points at times t: shape (..., N) for a number, (..., N, k) for k times.

        Outside the time span the first or last step is continued, as solve_ivp's dense output does.
        """
        queries = np.asarray(t, dtype=self._times.dtype)
        if queries.ndim > 1:
            raise ShapeError(f"t has shape {queries.shape}, expected a number or a list of times")
        flat = queries.reshape(-1)
        out: Array = np.full((*self._points.shape[1:], flat.size), np.nan, dtype=self._points.dtype)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for k in np.argsort(flat, kind="stable"):
                if np.isfinite(flat[k]):
                    out[..., k] = self._at(flat[k])
        return out[..., 0] if queries.ndim == 0 else out

    def _at(self, time: np.floating[Any]) -> Array:
        """Points (..., N) at one time, every trajectory in the step that contains it."""
        if not len(self._sizes):
            first: Array = self._points[0]
            return first
        wanted = (self._direction * time).reshape(-1)
        found = [np.searchsorted(row, x, side="right") - 1 for row, x in zip(self._rows, wanted, strict=True)]
        index = np.clip(np.array(found, dtype=int), 0, np.maximum(self._last_point - 1, 0)).reshape(self._shape)
        start, point = _rows(self._times, index), _rows(self._points, index[..., None])
        local = self._prepare(index, start, point)
        size = _rows(self._sizes, index)
        elapsed = np.where(size != 0, time - start, 0)
        ends = _rows(self._times, index + 1) == time
        s = elapsed if self._nominal else size_for(local, elapsed, size)
        made = self._step_to(local, np.where(ends, size, s), size)
        made = np.where((elapsed == 0)[..., None], point, made)
        return np.where(ends[..., None], _rows(self._points, (index + 1)[..., None]), made)

    def _step_to(self, local: LocalStep, s: Array, size: Array) -> Array:
        made: Any
        try:
            made = local.point(s[..., None])
        except (ConvergenceError, np.linalg.LinAlgError):
            # an implicit step that is continued beyond its ends need not have a solution
            outside = (s * np.sign(size) < 0) | (np.abs(s) > np.abs(size))
            made = local.point(np.where(outside, 0, s)[..., None])
            made = np.where(outside[..., None], np.nan, made)
        points: Array = made
        return points

    def _prepare(self, index: IntegerArray, start: Array, point: Array) -> LocalStep:
        """The steps number `index` of the trajectories; the last ones are cached, because times come in order."""
        if self._prepared is None or not np.array_equal(self._prepared[0], index):
            self._prepared = (index, self._step.at(self._action, self._psi, point, start[..., None]))
        return self._prepared[1]


def _rows(array: Array, index: IntegerArray) -> Array:
    """array[index[...], ...]: for each trajectory its own row."""
    rows: Array = np.take_along_axis(array, index[None], axis=0)[0]
    return rows
