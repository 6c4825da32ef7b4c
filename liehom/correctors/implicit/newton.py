"""Newton's method for x = F(A x), for every trajectory separately.

The derivative is evaluated again for a trajectory only if its residual did not fall enough (simplified Newton). Small
systems are solved by elimination, large ones by `gmres`.

For stiff F there are several solutions, and the one that belongs to the step is the end of the pseudo-transient
x' = F(A x) - x, x(0) = 0. Newton's step leads there unless F expands along it. Where it points against F - x, the step
is that of backward Euler for the pseudo-transient, (1/d + 1 - F') step = F - x, with a size d that grows as the
residual falls (C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, 1998).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.implicit.equation import Equation
from liehom.correctors.implicit.krylov import gmres
from liehom.typing import Array, BooleanArray

MAX_ITERATIONS = 60
HASTY_ITERATIONS = 20
"""Iterations of a step that is cheaper to repeat with half its size."""
MAX_DENSE = 48
"""Largest number of unknowns of one trajectory for elimination."""
REFRESH = 0.03
"""The derivative is evaluated again if the residual is multiplied by more than this."""
MAX_GROWTH = 10.0
"""A step that multiplies the residual by more than this is rejected."""
GUIDED = 0.1
"""Steps above this fraction of the reach are compared with the direction of the pseudo-transient."""
CRAWLS = 1e-3
"""Damped steps below this fraction of the reach that do not reduce the residual end the guidance: they lead nowhere."""


def newton(
    equation: Equation,
    start: Array,
    wanted: BooleanArray,
    reach: float,
    *,
    joint: bool = False,
    hasty: bool = False,
) -> tuple[Array, BooleanArray, Array]:
    """The solutions x, which of them are solutions to round-off, and the last changes, for the trajectories `wanted`.

    Parameters
    ----------
    equation : Equation
    start : array of shape (S, ..., n)
    wanted : bool array of shape (1, ..., 1)
    reach : float
        The largest norm of a step.
    joint : bool
        Whether F couples the trajectories, so that they are one system.
    hasty : bool
        Whether to give up after few iterations.

    Examples
    --------
    >>> equation = Equation(lambda y: [-1000 * np.sin(y[0])], [((0, 1.0),)])
    >>> x, solved, _ = newton(equation, np.array([[1.0]]), np.array([[True]]), 1.0)
    >>> bool(solved), bool(abs(x) < 1e-15)
    (True, True)
    """
    x, solved, change = _iterated(equation, start, wanted, reach, joint, guided=True, hasty=hasty)
    if not hasty and bool((wanted & ~solved).any()):
        again, more, last = _iterated(equation, start, wanted & ~solved, reach, joint, guided=False)
        x, solved = np.where(more, again, x), solved | more
        change = np.where(more, 0.0, last)
    return x, solved, change


def _iterated(
    equation: Equation,
    x: Array,
    wanted: BooleanArray,
    reach: float,
    joint: bool,
    *,
    guided: bool,
    hasty: bool = False,
) -> tuple[Array, BooleanArray, Array]:
    axes = tuple(range(x.ndim)) if joint else (0, -1)
    system = _System(equation, x, axes, wanted)
    eps = float(np.finfo(x.dtype).eps)
    residual: Any = equation.value(x) - x
    size, before = _norm(residual, axes), np.full(np.shape(wanted), np.inf)
    active, solved = wanted, np.zeros_like(wanted)
    stale, damping = wanted, np.zeros(np.shape(wanted), dtype=x.dtype)
    change, free = before, np.full(np.shape(wanted), not guided)
    for _ in range(HASTY_ITERATIONS if hasty else MAX_ITERATIONS):
        system.refresh(x, stale)
        step = system.solve(residual, damping)
        if not free.all():
            against = active & ~free & ((step * residual).sum(axis=axes, keepdims=True) <= 0)
            against = against & (_norm(step, axes) > GUIDED * reach)
            if bool(against.any()):
                damping = np.where(against, np.maximum(4 * damping, system.size()), damping)
                step = system.solve(residual, damping)
        length = _norm(step, axes)
        limited = length > reach
        step = np.where(active, step * np.where(limited, reach / np.where(limited, length, 1.0), 1.0), 0.0)
        trial = x + step
        value: Any = equation.value(trial) - trial
        new = _norm(value, axes)
        change = np.abs(step).max(axis=axes, keepdims=True, initial=0.0)
        largest = np.abs(trial).max(axis=axes, keepdims=True, initial=0.0)
        small = change <= 1e4 * eps * np.maximum(largest, 1.0)  # the residual may be round-off
        good = active & ((new <= MAX_GROWTH * size) | (small & np.isfinite(new)))
        exact = new <= eps * system.size() * largest  # the round-off of F
        done = (change <= 2 * eps * largest) | (small & ((change >= before / 2) | exact))
        done = good & done & (damping == 0) & ~limited
        ratio = np.where(good, new / np.where(size > 0, size, 1.0), np.inf)
        damping = np.where(good, damping * np.minimum(ratio, 1.0), np.maximum(4 * damping, system.size()))
        crawls = good & ~free & (damping > 0) & (ratio > 0.5) & (length < CRAWLS * reach)
        free = free | crawls
        damping = np.where((damping < 1e-3) | small | crawls, 0.0, damping)
        x, residual, size = np.where(good, trial, x), np.where(good, value, residual), np.where(good, new, size)
        before = np.where(good, change, before)
        stale = good & ~small & ((ratio > REFRESH) | (damping > 0))
        solved, active = solved | done, active & ~done
        if not active.any():
            break
    return x, solved, change


class _System:
    """The linear systems (1 + damping - F') step = residual of all trajectories."""

    def __init__(self, equation: Equation, x: Array, axes: tuple[int, ...], wanted: BooleanArray) -> None:
        self.equation, self.axes, self.at = equation, axes, x
        self.dense = len(axes) == 2 and x.shape[0] * x.shape[-1] <= MAX_DENSE
        self.jacobian: Array = np.zeros(())
        self._size: Array = np.zeros(np.shape(wanted))

    def refresh(self, x: Array, stale: BooleanArray) -> None:
        """Evaluate the derivative at x for the trajectories for which it is `stale`."""
        if not stale.any():
            return
        if not self.dense:
            self.at = np.where(stale, x, self.at)
            moved: Any = self.equation.along(self.at, _unit(x, self.axes))
            self._size = np.maximum(1.0, _norm(moved, self.axes))
            return
        blocks = np.where(stale[..., None], self.equation.blocks(x), 0.0)
        s, n = x.shape[0], x.shape[-1]
        # the derivative of F_i by x_j is a_ij times block i
        whole = np.einsum("i...ab,ij->...iajb", blocks, self.equation.matrix)
        whole = whole.reshape(*x.shape[1:-1], s * n, s * n)
        fresh = stale.reshape(*x.shape[1:-1], 1, 1)
        self.jacobian = np.where(fresh, whole, self.jacobian)
        self._size = np.maximum(1.0, np.sqrt((self.jacobian**2).sum(axis=(-1, -2)))).reshape(np.shape(stale))

    def _along(self, v: Array) -> Array:
        moved: Any = self.equation.along(self.at, v)
        found: Array = moved
        return found

    def size(self) -> Array:
        """A norm of F', at least 1, shape (1, ..., 1)."""
        return self._size

    def solve(self, residual: Array, damping: Array) -> Array:
        """The steps, of the shape of the residual; 0 where the residual is not finite."""
        finite = np.isfinite(residual).all(axis=self.axes, keepdims=True)
        right = np.where(finite, residual, 0.0)
        if not self.dense:
            one = 1 + damping
            return gmres(lambda v: v * one - self._along(v), right, self.axes)
        s, n = residual.shape[0], residual.shape[-1]
        lead = residual.shape[1:-1]
        flat = np.moveaxis(right, 0, -2).reshape(*lead, s * n, 1)
        unit = np.eye(s * n, dtype=right.dtype)
        matrix = (1 + damping.reshape(*lead, 1, 1)) * unit - np.where(np.isfinite(self.jacobian), self.jacobian, 0.0)
        found = _solved(matrix, flat)
        return np.moveaxis(found.reshape(*lead, s, n), -2, 0)


def _solved(matrix: Array, right: Array) -> Array:
    """Solutions of linear systems, those of least squares if a matrix is singular."""
    matrix, right = matrix.astype(np.float64, copy=False), right.astype(np.float64, copy=False)
    found: Any
    try:
        found = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        found = np.linalg.pinv(matrix) @ right
    steps: Array = found
    return steps


def _norm(x: Array, axes: tuple[int, ...]) -> Array:
    with np.errstate(over="ignore", invalid="ignore"):
        found: Array = np.sqrt((x * x).sum(axis=axes, keepdims=True))
    return found


def _unit(x: Array, axes: tuple[int, ...]) -> Array:
    """Random vectors of norm 1, always the same ones."""
    shape = [x.shape[a] if a % x.ndim in {b % x.ndim for b in axes} else 1 for a in range(x.ndim)]
    v = np.random.default_rng(0).normal(size=shape) + 0 * x
    unit: Array = v / _norm(v, axes)
    return unit
