"""Sensitivity: derivatives of the points of a solution by the initial points and by the arguments of psi.

A step is a map m_(k+1) = S(m_k, t_k, h_k, args). Its graph, recorded once, is differentiated by backward sweeps, which
run on all steps of all trajectories at once, because their points are known. The derivatives of the steps are then
multiplied: forward for the derivatives of all points by few numbers (tangents), backward for the derivatives of one
number by many (adjoints).

The accepted step sizes h_k are constants. A step with its own clock has t_(k+1) = t_k + tau(m_k, t_k, h_k), so that
the times of its steps have derivatives too. Where a step ends at a given time, at the end of the run or at a time of
t_eval, its size follows from that time: dh = -(dt_k + dtau) / (dtau/dh).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, ShapeError
from liehom.base.pytrees import Leaf, PerTrajectory, mapped
from liehom.base.typing import Array, BooleanArray, IntegerArray, Pytree
from liehom.flow.engines.engine import Problem
from liehom.flow.engines.traced_step import arg_values, args_of_lanes, traced_step
from liehom.flow.run.solution import Solution
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import LaneConstant, RunConstant, Tape, needed
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.sweeps import Sweeps

NUMBERS_AT_ONCE = 20_000_000  # numbers of a sweep, operations times lanes, that are in memory at once
NEWTON_ITERATIONS = 50


class Gradient(NamedTuple):
    """The derivatives of a number by what a solution depends on.

    Attributes
    ----------
    y0 : array of shape (..., N)
    args : pytree
        Of the structure of args, with arrays of the shapes of its leaves; None without args.
    """

    y0: Array
    args: Pytree


@final
class Sensitivity:
    """Derivatives of the points of a solution, the accepted step sizes held fixed: `Propagator.sensitivity`.

    They are the exact derivatives of the numbers that the method computes for these step sizes, to round-off, and
    not an approximation with a tolerance of its own. They approach the derivatives of the flow with the order of the
    method.

    Raises
    ------
    InputError
        If the `solution` has no dense output.
    TraceError
        On evaluation, if the step cannot be recorded, or contains an iteration, as implicit steps do.

    Notes
    -----
    `y0` and `args` cost as many sweeps over the recorded step as a point has coordinates, `vjp` costs one more.
    Terminal events are not differentiated: their times count as given.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), lambda m, t, args: args["rate"] + 0 * m[..., :1])
    >>> found = lh.Propagator(field).sensitivity((0, 1), [1.0, 0.0], args={"rate": 0.5}, t_eval=[1.0])
    >>> exact = [-np.sin(0.5), np.cos(0.5)]  # y = (cos 0.5 t, sin 0.5 t)
    >>> bool(np.allclose(found.args["rate"][:, 0], exact)), found.y0.shape
    (True, (2, 2, 1))
    >>> bool(np.allclose(found.vjp([[1.0], [0.0]]).args["rate"], exact[0]))
    True
    """

    solution: Solution

    def __init__(self, problem: Problem, solution: Solution) -> None:
        if solution.sol is None:
            raise InputError("derivatives need the steps of the run: integrate with dense_output=True")
        self.solution = solution
        self._problem = problem
        self._shape: tuple[int, ...] = problem.start.shape[:-1]
        self._size: int = int(problem.start.shape[-1])
        dimensions = np.broadcast_to(np.asarray(problem.orbit_dimension), self._shape).reshape(-1)
        self._groups = [_Group(problem, solution, np.flatnonzero(dimensions == d)) for d in np.unique(dimensions)]

    @property
    def y0(self) -> Array:
        """Derivatives of the points by the initial point: [..., i, j, k] is dy_i(t_k) / dy0_j."""
        return self._tangents[..., : self._size, :]

    @property
    def args(self) -> Pytree:
        """Derivatives of the points by args, a pytree with arrays (..., N, *shape of the leaf, number of times)."""
        tangents = self._tangents[..., self._size :, :]

        def of_leaf(_: Leaf, shape: tuple[int, ...], part: slice) -> Array:
            columns = tangents[..., part, :]
            return columns.reshape(*columns.shape[:-2], *shape, columns.shape[-1])

        return self._by_leaf(of_leaf)

    def vjp(self, weights: npt.ArrayLike) -> Gradient:
        """The derivatives of sum(weights * solution.y), by one backward pass: a `Gradient`.

        Parameters
        ----------
        weights : array_like of shape (..., N, number of times)
        """
        w = np.asarray(weights, dtype=np.float64)
        if w.shape != np.shape(self.solution.y):
            raise ShapeError(f"weights of shape {w.shape}, expected that of solution.y, {np.shape(self.solution.y)}")
        flat = np.moveaxis(w, -1, 0).reshape(w.shape[-1], -1, self._size)
        parts = [group.adjoint(flat[:, group.lanes]) for group in self._groups]
        y0 = np.zeros((flat.shape[1], self._size))
        by_parameter = np.zeros((len(parts[0][1]) if parts else 0, flat.shape[1]))
        for group, part in zip(self._groups, parts, strict=True):
            y0[group.lanes], by_parameter[:, group.lanes] = part

        def of_leaf(leaf: Leaf, shape: tuple[int, ...], part: slice) -> Array:
            if isinstance(leaf.value, PerTrajectory):
                return np.moveaxis(by_parameter[part], 0, -1).reshape(*self._shape, *shape)
            return by_parameter[part].sum(axis=1).reshape(shape)

        return Gradient(y0.reshape(*self._shape, self._size), self._by_leaf(of_leaf))

    # -- private -----------------------------------------------------------------------------------------
    @cached_property
    def _tangents(self) -> Array:
        """Derivatives of the points by y0 and all numbers in args, shape (..., N, N + P, number of times)."""
        parts = [(group.lanes, group.tangents()) for group in self._groups]
        times, _, size, columns = parts[0][1].shape
        tangents = np.zeros((times, int(np.prod(self._shape, dtype=int)), size, columns))
        for lanes, part in parts:
            tangents[:, lanes] = part
        tangents = np.moveaxis(tangents, 0, -1).reshape(*self._shape, size, columns, times)
        return np.where(np.isfinite(np.asarray(self.solution.y))[..., None, :], tangents, np.nan)

    def _by_leaf(self, made: Callable[[Leaf, tuple[int, ...], slice], Array]) -> Pytree:
        """args with made(leaf, shape for one trajectory, places of its numbers) in place of its leaves."""
        first = 0

        def of_leaf(leaf: Leaf) -> Array:
            nonlocal first
            value: Any = leaf.value
            shape = value.value.shape[len(self._shape) :] if isinstance(value, PerTrajectory) else np.shape(value)
            part = slice(first, first + int(np.prod(shape, dtype=int)))
            first = part.stop
            return made(leaf, shape, part)

        return mapped(self._problem.args, of_leaf)


@final
class _Group:
    """Trajectories with orbits of one dimension: the graph of their step, their steps, and where the samples lie."""

    def __init__(self, problem: Problem, solution: Solution, lanes: IntegerArray) -> None:
        self.lanes = lanes
        dense: Any = solution.sol
        times, points, sizes = dense.steps
        n = points.shape[-1]
        self._n, self._start = n, np.asarray(problem.start, dtype=np.float64).reshape(-1, n)[lanes]
        self._times = times.reshape(len(times), -1)[:, lanes].astype(np.float64)
        self._points = points.reshape(len(points), -1, n)[:, lanes].astype(np.float64)
        self._sizes = sizes.reshape(len(sizes), -1)[:, lanes].astype(np.float64)
        self._end = float(problem.span[1])
        dimension = int(np.broadcast_to(np.asarray(problem.orbit_dimension), problem.start.shape[:-1]).flat[lanes[0]])
        args = None if problem.args is None else args_of_lanes(problem.args, problem.start.shape[:-1], lanes)
        self.graph: StepGraph = traced_step(
            problem.action, problem.field, problem.step, self._start, dimension, nominal=problem.options.nominal,
            args=args, branching=False,
        )  # fmt: skip
        self._outputs = [*self.graph.point, *([] if self.graph.elapsed is None else [self.graph.elapsed])]
        self._given = self.graph.constants(self._start)
        functions = self.graph.constant_functions
        named = {f.name: -1 - i for i, f in enumerate(functions) if isinstance(f, RunConstant | LaneConstant)}
        # inputs of the graph: functions of the initial point, and the numbers in args
        self._constants = [-1 - i for i, f in enumerate(functions) if not isinstance(f, RunConstant | LaneConstant)]
        self._parameters = [] if args is None else [named[name] for name in arg_values(args, 1)]
        self._moved: BooleanArray = np.nan_to_num(self._sizes) != 0
        samples = problem.options.t_eval
        self._samples: tuple[IntegerArray, Array] | None = None if samples is None else self._located(samples)

    # -- where the samples lie -----------------------------------------------------------------------------
    def _located(self, samples: Array) -> tuple[IntegerArray, Array]:
        """The steps that contain the times of t_eval, and the sizes at which they reach them, both (k, L)."""
        direction = 1.0 if self._end >= self._times[0, 0] else -1.0
        last = np.maximum(np.isfinite(self._times).sum(axis=0) - 2, 0)
        index = np.zeros((len(samples), len(self.lanes)), dtype=int)
        for lane in range(len(self.lanes)):
            row = direction * self._times[np.isfinite(self._times[:, lane]), lane]
            step = np.searchsorted(row, direction * samples, side="right") - 1
            index[:, lane] = np.clip(step, 0, last[lane])
        begin = np.take_along_axis(self._times, index, axis=0)
        after = np.take_along_axis(self._times, np.minimum(index + 1, len(self._times) - 1), axis=0)
        size = np.take_along_axis(np.nan_to_num(self._sizes), index, axis=0)
        left = samples[:, None] - begin
        sizes = left if self.graph.elapsed is None else self._solved(index, begin, left, size)
        return index, np.where(after == samples[:, None], size, sizes)

    def _solved(self, index: IntegerArray, begin: Array, left: Array, size: Array) -> Array:
        """The sizes s with tau(s) = left, by Newton's method."""
        points = np.take_along_axis(self._points, index[..., None], axis=0)
        sweeps = self._swept([c for _, c in self.graph.clock], points, begin, size)
        coefficients = {k: c for (k, _), c in zip(self.graph.clock, next(sweeps)[1].values, strict=True)}
        coefficients = {k: c.reshape(left.shape) for k, c in coefficients.items()}
        s = left
        for _ in range(NEWTON_ITERATIONS):
            time = s + sum(c * s**k for k, c in coefficients.items())
            s = s + (left - time) / (1 + sum(k * c * s ** (k - 1) for k, c in coefficients.items()))
        return s

    # -- derivatives of steps ------------------------------------------------------------------------------
    def _swept(
        self, outputs: list[Any], points: Array, times: Array, sizes: Array, *, at_once: bool = True
    ) -> Iterator[tuple[slice, Sweeps]]:
        """Sweeps over the graph at steps (k, L), in parts of the flattened steps; one part if `at_once`."""
        n, count = self._n, sizes.size
        lanes = np.broadcast_to(np.arange(len(self.lanes)), sizes.shape).reshape(-1)
        flat, t, h = points.reshape(-1, n), times.reshape(-1), sizes.reshape(-1)
        most = count if at_once else max(1, NUMBERS_AT_ONCE // max(1, len(needed(outputs))))
        for first in range(0, count, max(most, 1)):
            part = slice(first, min(first + most, count))
            rows = lanes[part]
            inputs: dict[int, Any] = {i: flat[part, i] for i in range(n)} | {n: t[part], n + 1: h[part]}
            inputs |= {-1 - i: c[rows] for i, c in enumerate(self._given)}
            yield part, Sweeps(outputs, inputs, len(rows))

    def _derivatives(self, points: Array, times: Array, sizes: Array, *, parameters: bool) -> tuple[Array, Array]:
        """Derivatives of the outputs of steps (k, L), (k, L, outputs, ...), by state and parameters, and by size."""
        n, rows = self._n, len(self._outputs)
        columns = [n + 1, *range(n + 1), *self._constants, *(self._parameters if parameters else [])]
        slopes = np.zeros((sizes.size, rows, len(columns)))
        for part, sweeps in self._swept(self._outputs, points, times, sizes, at_once=False):
            for i in range(rows):
                by_input = sweeps.pulled([1.0 if j == i else 0.0 for j in range(rows)])
                for place, column in enumerate(columns):
                    slopes[part, i, place] = by_input.get(column, 0.0)
        slopes = slopes.reshape(*sizes.shape, rows, len(columns))
        return slopes[..., 1:], slopes[..., 0]

    def _steps(self) -> tuple[Array, Array, Array]:
        """Points, times and sizes of the steps; those of size 0 at the start for trajectories that do not move."""
        points = np.where(self._moved[..., None], self._points[:-1], self._start)
        times = np.where(self._moved, self._times[:-1], self._times[0])
        return points, times, np.where(self._moved, self._sizes, 0.0)

    def _steps_to_samples(self) -> tuple[Array, Array, Array]:
        """Points, times and sizes of the steps to the times of t_eval."""
        index, sizes = self._samples  # type: ignore[misc]
        points = np.take_along_axis(self._points, index[..., None], axis=0)
        return points, np.take_along_axis(self._times, index, axis=0), sizes

    def _constant_slopes(self) -> Array:
        """Derivatives of the constants of the trajectories by their initial points, shape (L, constants, N)."""
        n, functions = self._n, [self.graph.constant_functions[-1 - c] for c in self._constants]
        slopes = np.zeros((len(self.lanes), len(functions), n))
        for i, function in enumerate(functions):
            tape = Tape()
            output = Traced(tape, function(Traced.inputs(tape, 0, n))).entry
            if not output.constant:
                by_input = Sweeps([output], dict(enumerate(self._start.T)), len(self.lanes)).pulled([1.0])
                for j in range(n):
                    slopes[:, i, j] = by_input.get(j, 0.0)
        return slopes

    # The state of a trajectory: its point, its time, and its constants, which steps do not change.

    # -- forward -------------------------------------------------------------------------------------------
    def tangents(self) -> Array:
        """Derivatives of the points at all times by y0 and the numbers in args, shape (k, L, N, N + P)."""
        n, lanes = self._n, len(self.lanes)
        z = np.zeros((lanes, n + 1 + len(self._constants), n + len(self._parameters)))
        z[:, :n, :n], z[:, n + 1 :, :n] = np.eye(n), self._constant_slopes()
        slopes, by_size = self._derivatives(*self._steps(), parameters=True)
        states = [z]
        for k, moves in enumerate(self._moved):
            new = self._pushed(slopes[k], by_size[k], z, self._times[k + 1] == self._end)
            z = np.where(moves[:, None, None], new, z)
            states.append(z)
        if self._samples is None:
            return np.stack(states)[:, :, :n]
        slopes, by_size = self._derivatives(*self._steps_to_samples(), parameters=True)
        before, everywhere = np.stack(states)[self._samples[0], np.arange(lanes)], np.ones(lanes, dtype=bool)
        return np.stack([self._pushed(*row, everywhere)[:, :n] for row in zip(slopes, by_size, before, strict=True)])

    def _pushed(self, slopes: Array, by_size: Array, z: Array, lands: BooleanArray) -> Array:
        """Derivatives of the state after a step, from those before it; `lands` if it ends at a given time."""
        n, count = self._n, z.shape[1]
        moved = slopes[..., :count] @ z
        moved[..., n:] += slopes[..., count:]
        after = z.copy()
        after[:, :n] = moved[:, :n]
        if self.graph.elapsed is not None:
            time = z[:, n] + moved[:, n]
            after[:, n] = np.where(lands[:, None], 0.0, time)
            after[:, :n] -= by_size[:, :n, None] * ((time - after[:, n]) / by_size[:, n, None])[:, None]
        return after

    # -- backward ------------------------------------------------------------------------------------------
    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Derivatives of sum(weights (k, L, N) * all points) by y0, (L, N), and by the numbers in args, (P, L)."""
        n, lanes, count = self._n, len(self.lanes), len(self._sizes)
        states = np.zeros((count + 1, lanes, n + 1 + len(self._constants)))
        by_parameter = np.zeros((len(self._parameters), lanes))
        weights = np.nan_to_num(weights)
        if self._samples is None:
            states[..., :n] += weights[: count + 1]
        else:
            index, everywhere = self._samples[0], np.ones(lanes, dtype=bool)
            slopes, by_size = self._derivatives(*self._steps_to_samples(), parameters=False)
            seeds = np.zeros(by_size.shape)
            after = np.zeros((len(index), *states.shape[1:]))
            after[..., :n] = weights
            for q, places in enumerate(index):
                seeds[q], before = self._pulled(slopes[q], by_size[q], after[q], everywhere)
                np.add.at(states, (places, np.arange(lanes)), before)
            self._add_parameters(by_parameter, *self._steps_to_samples(), seeds)
        slopes, by_size = self._derivatives(*self._steps(), parameters=False)
        seeds = np.zeros(by_size.shape)
        for k in range(count - 1, -1, -1):
            moves = self._moved[k][:, None]
            seed, before = self._pulled(slopes[k], by_size[k], states[k + 1], self._times[k + 1] == self._end)
            seeds[k] = np.where(moves, seed, 0.0)
            states[k] += np.where(moves, before, states[k + 1])
        self._add_parameters(by_parameter, *self._steps(), seeds)
        by_constant = np.einsum("lc,lcj->lj", states[0, :, n + 1 :], self._constant_slopes())
        return states[0, :, :n] + by_constant, by_parameter

    def _pulled(self, slopes: Array, by_size: Array, after: Array, lands: BooleanArray) -> tuple[Array, Array]:
        """Weights of the outputs of a step, and of the state before it, from those of the state after it, (L, ...)."""
        n, before = self._n, after.copy()
        if self.graph.elapsed is not None:
            at_end = -(after[:, :n] * by_size[:, :n]).sum(axis=1) / by_size[:, n]
            before[:, n] = np.where(lands, at_end, after[:, n])
        seeds = before[:, : len(self._outputs)].copy()
        before[:, :n] = 0.0
        return seeds, before + np.einsum("lo,los->ls", seeds, slopes)

    def _add_parameters(self, total: Array, points: Array, times: Array, sizes: Array, seeds: Array) -> None:
        """Add the derivatives by the numbers in args, from the weights (k, L, outputs) of the outputs of steps."""
        if not self._parameters:
            return
        lanes = np.broadcast_to(np.arange(len(self.lanes)), sizes.shape).reshape(-1)
        flat = seeds.reshape(-1, seeds.shape[-1])
        for part, sweeps in self._swept(self._outputs, points, times, sizes, at_once=False):
            by_input = sweeps.pulled(list(flat[part].T))
            for i, column in enumerate(self._parameters):
                if column in by_input:
                    np.add.at(total[i], lanes[part], by_input[column])
