"""Equations x = F(x) of implicit steps: fixed points, Newton's method, Krylov spaces, compiled loops."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from importlib import import_module
from operator import add
from typing import Any, TypeAlias, cast, final

import numpy as np

from liehom.base.errors import ConvergenceError, LiehomError
from liehom.base.typing import Array, BooleanArray, Real, Values
from liehom.flow.action.space import Action
from liehom.flow.series.arrays import is_jax, is_lazy, namespace, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.series.node import Node
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.loop import while_loop

# Equation: x = F(A x) for the stages of an implicit step, with derivatives of F by Jets of order 1. x has the shape (S,
# ..., n): S stages, the axes of the ensemble, n coordinates. A mixes the stages only, and stage i of F depends on y_i =
# (A x)_i only, so that the derivative of F has one n x n block for each stage and trajectory.

Stage: TypeAlias = Any  # an array, Jet or tracer of shape (..., n), or None for 0
SparseRow: TypeAlias = tuple[tuple[int, Any], ...]  # (index, entry) of the nonzero entries of a row of coefficients
Stages: TypeAlias = Callable[[list[Any]], Sequence[Any]]  # from y_1, ..., y_S, None for 0, to F_1(y_1), ..., F_S(y_S)

DIFFERENCE = 2.0**-26  # size of the differences that replace Jets, the root of the round-off of float64
NOT_ON_JETS = (LiehomError, TypeError, ValueError, IndexError, AttributeError, NotImplementedError)
"""Errors of a function of arrays that does not run on Jets, or not on an additional first axis."""


def combined(row: SparseRow, terms: Sequence[Values] | Values) -> Stage:
    """sum_j row[j] terms[j]; None if the row has no entries."""
    parts: Any = terms
    products = [parts[j] * weight for j, weight in row]
    return reduce(add, products) if products else None


@final
class Equation:
    """The equation x = F(A x)."""

    def __init__(self, function: Stages, rows: Sequence[SparseRow]) -> None:
        self.function, self.rows = function, rows
        self._on_jets = self._at_once = True
        self._checked = False

    @property
    def matrix(self) -> Array:
        """A as an array (S, S)."""
        matrix = np.zeros((len(self.rows),) * 2)
        for i, row in enumerate(self.rows):
            for j, weight in row:
                matrix[i, j] = weight
        return matrix

    def arguments(self, x: Values) -> list[Any]:
        """The list of y_i = (A x)_i, None for rows without entries."""
        return [combined(row, x) for row in self.rows]

    def value(self, x: Values) -> Values:
        """F(A x), of the shape of x."""
        stages = self.function(self.arguments(x))
        return namespace(*stages).stack(stages)

    def blocks(self, x: Values) -> Values:
        """The derivatives of F_i by y_i, shape (S, ..., n, n); the last axis is that of the direction."""
        y = self.arguments(x)
        columns: Any = self._batched(y, x) if self._at_once else None
        if columns is None:
            columns = [
                self._derivative(y, [None if v is None else 0 * v + e for v in y], x) for e in np.eye(x.shape[-1])
            ]
        return namespace(*columns).stack(columns, axis=-1)

    def along(self, x: Values, v: Values) -> Values:
        """The derivative of F(A x) in the direction v, of the shape of x."""
        return self._derivative(self.arguments(x), self.arguments(v), x)

    def _batched(self, y: list[Any], x: Values) -> list[Any] | None:
        """The columns of `blocks` from one evaluation on an additional first axis; None if F has no such form."""
        if type(x) is not np.ndarray or not self._on_jets:
            return None
        n = x.shape[-1]
        e = np.eye(n, dtype=x.dtype).reshape(n, *[1] * (x.ndim - 2), n)
        try:
            parts = [_parts(k) for k in self.function([None if v is None else _in_directions(v, e) for v in y])]
            values = [value for value, _ in parts] if self._checked else self.function(y)
            if any(is_lazy(k) for k in values):
                return None
        except NOT_ON_JETS:
            self._at_once = False
            return None
        for (value, _), wanted in [] if self._checked else zip(parts, values, strict=True):
            scale = float(np.abs(wanted).max(initial=0.0))
            if value.shape not in ((n, *np.shape(wanted)), np.shape(wanted)) or not np.allclose(
                value, wanted, rtol=0, atol=1e-9 * scale, equal_nan=True
            ):
                self._at_once = False
                return None
        self._checked = True
        return list(np.stack([np.broadcast_to(slope, (n, *x.shape[1:])) for _, slope in parts], axis=1))

    def _derivative(self, y: list[Any], directions: list[Any], x: Values) -> Values:
        """The derivative of F at y in the given directions, stacked; by differences if F does not run on Jets."""
        if self._on_jets:
            try:
                stages = self.function(
                    [None if v is None else Jet.variable(v, 1, d) for v, d in zip(y, directions, strict=True)]
                )
                slopes = [0 * x[0] + _parts(k)[1] for k in stages]
                return namespace(*slopes).stack(slopes)
            except NOT_ON_JETS:
                self._on_jets = False
        ahead = [None if v is None else v + DIFFERENCE * d for v, d in zip(y, directions, strict=True)]
        quotients = [(a - b) / DIFFERENCE for a, b in zip(self.function(ahead), self.function(y), strict=True)]
        return namespace(*quotients).stack(quotients)


def _in_directions(v: Array, e: Array) -> Jet:
    """v + e t for all directions e at once; the value is a view, so that exponentials of it are computed once."""
    value = np.broadcast_to(v, np.broadcast_shapes(v.shape, e.shape))
    return Jet.from_node(Node(1, value, [value, np.broadcast_to(e, value.shape)]))


def _parts(k: Stage) -> tuple[Any, Any]:
    """Value and slope of a stage, which is a Jet of order 1 unless it does not depend on its argument."""
    return (k.coefficient(0), k.coefficient(1)) if isinstance(k, Jet) else (k, 0 * k)


# GMRES for many linear systems at once, each with the iterates that it has alone. For lattices and other large systems,
# of which only the product of the matrix with a vector is known.

MAX_VECTORS = 80  # largest dimension of a Krylov space; the solution of least residual in it is returned


def gmres(product: Callable[[Array], Array], right: Array, axes: tuple[int, ...], *, rtol: float = 1e-4) -> Array:
    """Approximate solutions of product(x) = right, of the shape of right, by the method of minimal residuals."""

    def norm(x: Array) -> Array:
        return np.sqrt((x * x).sum(axis=axes, keepdims=True))

    size = norm(right)
    basis = [right / np.where(size > 0, size, 1.0)]
    columns: list[list[Array]] = []
    weights: list[Array] = []
    for j in range(min(MAX_VECTORS, int(np.prod([right.shape[a] for a in axes])))):
        w = product(basis[j])
        column = []
        for v in basis:
            column.append((v * w).sum(axis=axes, keepdims=True))
            w = w - column[-1] * v
        column.append(norm(w))
        columns.append(column)
        ended = column[-1] <= 1e-14 * sum(np.abs(c) for c in column)
        basis.append(np.where(ended, 0.0, w / np.where(ended, 1.0, column[-1])))
        weights, residual = _least_squares(columns, size)
        if bool((residual <= rtol * size).all()):
            break
    return sum((c * v for c, v in zip(weights, basis, strict=False)), np.zeros_like(right))


def _least_squares(columns: list[list[Array]], size: Array) -> tuple[list[Array], Array]:
    """Weights of the basis vectors, and norms of the residuals, from the Hessenberg matrices."""
    j = len(columns)
    h, first = np.zeros((*size.shape, j + 1, j)), np.zeros((*size.shape, j + 1, 1))
    first[..., 0, 0] = size
    for k, column in enumerate(columns):
        for i, entry in enumerate(column):
            h[..., i, k] = entry
    solution = np.linalg.pinv(np.nan_to_num(h)) @ first
    residual = np.sqrt(((h @ solution - first) ** 2).sum(axis=(-1, -2)))
    return [solution[..., k, 0] for k in range(j)], residual


# Newton's method for x = F(A x), for every trajectory separately. The derivative is evaluated again for a trajectory
# only if its residual did not fall enough (simplified Newton). Small systems are solved by elimination, large ones by
# `gmres`. For stiff F there are several solutions, and the one that belongs to the step is the end of the
# pseudo-transient x' = F(A x) - x, x(0) = 0. Newton's step leads there unless F expands along it. Where it points
# against F - x, the step is that of backward Euler for the pseudo-transient, (1/d + 1 - F') step = F - x, with a size d
# that grows as the residual falls (C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation,
# 1998). If F' has a real eigenvalue above 1 at a solution, it may be on another branch than that from h = 0. The
# solutions of x = s F(A x) are then followed from s = 0 to 1, and the last one is that of the step.

MAX_NEWTON_ITERATIONS = 60
MAX_DENSE = 48  # largest number of unknowns of one trajectory for elimination
REFRESH = 0.03  # the derivative is evaluated again if the residual is multiplied by more than this
FIRST_PART, MAX_PARTS = 1e-8, 400  # the first part of h on the way from 0, and the largest number of parts
NEAR = 0.1  # a part in which x moves by more than this fraction of the reach is made in smaller parts
MAX_GROWTH = 10.0  # a step that multiplies the residual by more than this is rejected
GUIDED = 0.1  # steps above this fraction of the reach are compared with the direction of the pseudo-transient
CRAWLS = 1e-3
"""Damped steps below this fraction of the reach that do not reduce the residual end the guidance: they lead nowhere."""


def newton(
    equation: Equation, start: Array, wanted: BooleanArray, reach: float, *, joint: bool = False
) -> tuple[Array, BooleanArray, Array]:
    """The x, which of them are solutions to round-off, and the last changes, for the trajectories `wanted`."""
    x, solved, change, repels = _newton_iterated(equation, start, wanted, reach, joint, guided=True)
    if bool((wanted & ~solved).any()):
        again, more, last, others = _newton_iterated(equation, start, wanted & ~solved, reach, joint, guided=False)
        x, solved, repels = np.where(more, again, x), solved | more, np.where(more, others, repels)
        change = np.where(more, 0.0, last)
    if bool((astray := wanted & solved & repels).any()):
        followed, more = _followed(equation, x, astray, reach, joint)
        x, solved = np.where(more, followed, x), (solved & ~astray) | more
    return x, solved, change


def _followed(
    equation: Equation, like: Array, wanted: BooleanArray, reach: float, joint: bool
) -> tuple[Array, BooleanArray]:
    """The ends of the branches x = s F(A x), s from 0 to 1, from x = 0, and for which trajectories they are reached."""
    axes = tuple(range(like.ndim)) if joint else (0, -1)
    x, left = np.zeros_like(like), wanted
    s, size = np.zeros(wanted.shape), np.full(wanted.shape, FIRST_PART)
    for _ in range(MAX_PARTS):
        ahead: Any = np.minimum(s + size, 1.0)
        part = Equation(lambda y, by=ahead[0]: [k * by for k in equation.function(y)], equation.rows)  # type: ignore[misc]
        trial, solved, *_ = _newton_iterated(part, x, left, reach, joint, guided=False)
        near = left & solved & (_norm(trial - x, axes) <= NEAR * reach)
        x, s, size = (
            np.where(near, trial, x),
            np.where(near, ahead, s),
            np.where(near, np.minimum(2 * size, ahead / 4), size / 4),
        )
        left = left & (s < 1)
        if not left.any():
            break
    return x, wanted & (s == 1)


def _newton_iterated(
    equation: Equation, x: Array, wanted: BooleanArray, reach: float, joint: bool, *, guided: bool
) -> tuple[Array, BooleanArray, Array, BooleanArray]:
    axes = tuple(range(x.ndim)) if joint else (0, -1)
    system = _System(equation, x, axes, wanted)
    eps = float(np.finfo(x.dtype).eps)
    residual: Any = equation.value(x) - x
    size, before = _norm(residual, axes), np.full(np.shape(wanted), np.inf)
    active, solved = wanted, np.zeros_like(wanted)
    stale, damping = wanted, np.zeros(np.shape(wanted), dtype=x.dtype)
    change, free = before, np.full(np.shape(wanted), not guided)
    for _ in range(MAX_NEWTON_ITERATIONS):
        system.refresh(x, stale)
        step = system.solve(residual, damping)
        if not free.all():
            against = active & ~free & ((step * residual).sum(axis=axes, keepdims=True) <= 0)
            against = against & (_norm(step, axes) > GUIDED * reach)
            if bool(against.any()):
                damping = np.where(against, np.maximum(4 * damping, system.size), damping)
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
        exact = new <= eps * system.size * largest  # the round-off of F
        done = (change <= 2 * eps * largest) | (small & ((change >= before / 2) | exact))
        done = good & done & (damping == 0) & ~limited
        ratio = np.where(good, new / np.where(size > 0, size, 1.0), np.inf)
        damping = np.where(good, damping * np.minimum(ratio, 1.0), np.maximum(4 * damping, system.size))
        crawls = good & ~free & (damping > 0) & (ratio > 0.5) & (length < CRAWLS * reach)
        free = free | crawls
        damping = np.where((damping < 1e-3) | small | crawls, 0.0, damping)
        x, residual, size = np.where(good, trial, x), np.where(good, value, residual), np.where(good, new, size)
        before = np.where(good, change, before)
        stale = good & ~small & ((ratio > REFRESH) | (damping > 0))
        solved, active = solved | done, active & ~done
        if not active.any():
            break
    return x, solved, change, system.repels()


class _System:
    """The linear systems (1 + damping - F') step = residual of all trajectories."""

    def __init__(self, equation: Equation, x: Array, axes: tuple[int, ...], wanted: BooleanArray) -> None:
        self.equation, self.axes, self.at = equation, axes, x
        self.dense = len(axes) == 2 and x.shape[0] * x.shape[-1] <= MAX_DENSE
        self.jacobian: Array = np.zeros(())
        self.size: Array = np.zeros(np.shape(wanted))  # a norm of F', at least 1, shape (1, ..., 1)

    def refresh(self, x: Array, stale: BooleanArray) -> None:
        """Evaluate the derivative at x for the trajectories for which it is `stale`."""
        if not stale.any():
            return
        if not self.dense:
            self.at = np.where(stale, x, self.at)
            moved: Any = self.equation.along(self.at, _unit(x, self.axes))
            self.size = np.maximum(1.0, _norm(moved, self.axes))
            return
        blocks = np.where(stale[..., None], self.equation.blocks(x), 0.0)
        s, n = x.shape[0], x.shape[-1]
        # the derivative of F_i by x_j is a_ij times block i
        derivative = np.einsum("i...ab,ij->...iajb", blocks, self.equation.matrix)
        derivative = derivative.reshape(*x.shape[1:-1], s * n, s * n)
        self.jacobian = np.where(stale.reshape(*x.shape[1:-1], 1, 1), derivative, self.jacobian)
        self.size = np.maximum(1.0, np.sqrt((self.jacobian**2).sum(axis=(-1, -2)))).reshape(np.shape(stale))

    def repels(self) -> BooleanArray:
        """Whether F' has a real eigenvalue above 1, bool (1, ..., 1); False for large systems (not computed)."""
        if not self.dense:
            return np.zeros(np.shape(self.size), dtype=bool)
        jacobian = np.where(np.isfinite(self.jacobian), self.jacobian, 0.0).astype(np.float64, copy=False)
        values: Any = np.linalg.eigvals(jacobian)
        return ((values.imag == 0) & (values.real > 1)).any(axis=-1).reshape(np.shape(self.size))

    def solve(self, residual: Array, damping: Array) -> Array:
        """The steps, of the shape of the residual; 0 where the residual is not finite."""
        right = np.where(np.isfinite(residual).all(axis=self.axes, keepdims=True), residual, 0.0)
        if not self.dense:
            return gmres(lambda v: v * (1 + damping) - self.equation.along(self.at, v), right, self.axes)
        s, *lead, n = residual.shape
        flat = np.moveaxis(right, 0, -2).reshape(*lead, s * n, 1)
        unit = np.eye(s * n, dtype=right.dtype)
        matrix = (1 + damping.reshape(*lead, 1, 1)) * unit - np.where(np.isfinite(self.jacobian), self.jacobian, 0.0)
        return np.moveaxis(_solved_systems(matrix, flat).reshape(*lead, s, n), -2, 0)


def _solved_systems(matrix: Array, right: Array) -> Array:
    """Solutions of linear systems, those of least squares if a matrix is singular."""
    matrix, right = matrix.astype(np.float64, copy=False), right.astype(np.float64, copy=False)
    try:
        return cast(Array, np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        pseudo: Any = np.linalg.pinv(matrix)
        return pseudo @ right


def _norm(x: Array, axes: tuple[int, ...]) -> Array:
    with np.errstate(over="ignore", invalid="ignore"):
        return np.sqrt((x * x).sum(axis=axes, keepdims=True))


def _unit(x: Array, axes: tuple[int, ...]) -> Array:
    """Random vectors of norm 1, always the same ones."""
    shape = [x.shape[a] if a % x.ndim in {b % x.ndim for b in axes} else 1 for a in range(x.ndim)]
    v = np.random.default_rng(0).normal(size=shape) + 0 * x
    return v / _norm(v, axes)


# The equations of implicit steps in compiled code: loops whose iterations each lane makes as long as it needs.

Tracer: TypeAlias = Any  # a traced array, or a JAX array

FIXED_POINT_ITERATIONS = 200
NEWTON_ITERATIONS = 30
JAX_ITERATIONS = 60
ALONG = 1e-6  # longer steps, in units of the reach, must go along the pseudo-transient: arrays compare eigenvalues
MAX_TRACED = 18
"""Largest number of unknowns for which the elimination is traced; larger systems iterate the fixed point only."""
EPS = float(np.finfo(np.float64).eps)


def solved_on_tape(equation: Equation, start: Values, tape: Tape, slow: float, reach: float) -> Traced:
    """Solution x of x = F(A x) on tracers, of the shape of start; numpy takes a step for which it fails."""
    small = int(np.prod(np.shape(start))) <= MAX_TRACED

    def iteration(x: Traced, before: Traced, settled: Values, failed: Values) -> tuple[list[Values], Values]:
        value = equation.value(x)
        change: Values = np.where(settled, 0.0, np.abs(value - x).max())
        size = np.abs(value).max()
        kept: Values = np.where(settled, x, value)
        settled = settled | (change <= 2 * EPS * size) | ((change <= 1e4 * EPS * size) & (change >= before))
        failed = failed | ~np.isfinite(change)
        if small:
            failed = failed | (~settled & (change > slow * before) & (change > 1e4 * EPS * size))
        return [kept, change, settled, failed], ~settled & ~failed

    first = [start, np.inf, tape.false, tape.false]
    x, _, settled, _ = while_loop(iteration, first, tape, FIXED_POINT_ITERATIONS)
    if not small:
        tape.required.append(settled.entry)
        return x
    solved, done = _newton_on_tape(equation, start, tape, ~settled, reach)
    tape.required.append((settled | done).entry)
    return np.where(settled, x, solved)  # type: ignore[return-value]


def _newton_on_tape(
    equation: Equation, start: Values, tape: Tape, wanted: Tracer, reach: float
) -> tuple[Traced, Tracer]:
    """Newton's method in the lanes `wanted`, without the search for a direction that arrays have."""

    def iteration(active: Tracer, x: Tracer, before: Tracer, solved: Tracer) -> tuple[list[Values], Values]:
        step, along, limited = _compiled_step(equation, x, reach)
        trial = x + step
        change, size = np.abs(step).max(), np.abs(trial).max()
        done = (change <= 2 * EPS * size) | (
            (change <= 1e4 * EPS * np.maximum(size, 1.0)) & ((change >= before / 2) | (change == 0))
        )
        done = active & done & ~limited[0, 0]
        x = np.where(active, trial, x)
        solved = solved | done
        active = active & ~done & along[0, 0] & np.isfinite(change)
        return [active, x, np.where(active, change, before), solved], active

    first = [wanted, start, np.inf, tape.false]
    _, x, _, solved = while_loop(iteration, first, tape, NEWTON_ITERATIONS, guarded=True)
    return x, solved


def _compiled_step(equation: Equation, x: Tracer, reach: float) -> tuple[Tracer, Tracer, Tracer]:
    """The step of Newton's method at x (S, ..., n), at most the reach long, and, both of shape (1, ..., 1), whether it
    goes along the pseudo-transient and whether it was longer.
    """
    xp, (s, *lead, n) = namespace(x), np.shape(x)
    residual, matrix = equation.value(x) - x, xp.asarray(equation.matrix, dtype=x.dtype)
    derivative = xp.einsum("i...ab,ij->...iajb", equation.blocks(x), matrix).reshape(*lead, s * n, s * n)
    right = xp.moveaxis(residual, 0, -2).reshape(*lead, s * n, 1)
    step = xp.linalg.solve(xp.eye(s * n, dtype=x.dtype) - derivative, right)
    step = xp.moveaxis(step.reshape(*lead, s, n), -2, 0)
    length = xp.sqrt(xp.sum(step * step, axis=(0, -1), keepdims=True))
    along = (xp.sum(step * residual, axis=(0, -1), keepdims=True) > 0) | (length <= ALONG * reach)
    limited = length > reach
    return step * xp.where(limited, reach / xp.where(limited, length, 1.0), 1.0), along, limited


def solved_by_jax(equation: Equation, start: Tracer, reach: float) -> Tracer:
    """Solution of x = F(A x) on JAX arrays of shape (S, ..., n); NaN where none is found. Derivatives are those of one
    more step of Newton's method from the solution.
    """
    jax = import_module("jax")
    jnp = jax.numpy
    if start.shape[0] * start.shape[-1] > MAX_TRACED:
        # a loop, as sixty copies of the function would take minutes to compile
        found = jax.lax.fori_loop(0, JAX_ITERATIONS, lambda _, x: equation.value(x), start)
        return jnp.where(_is_small(equation.value(found) - found, found), found, jnp.nan)

    def iteration(state: tuple[int, Tracer, Tracer]) -> tuple[int, Tracer, Tracer]:
        k, x, _ = state
        step, along, _ = _compiled_step(equation, x, reach)
        step = jnp.where(along, step, jnp.nan)  # it would lead to another solution, far away
        return k + 1, x + step, jnp.all(_is_small(step, x) | ~jnp.isfinite(step))

    found = jax.lax.while_loop(lambda s: (s[0] < NEWTON_ITERATIONS) & ~s[2], iteration, (0, start, start.size == 0))[1]
    found = jax.lax.stop_gradient(found)
    step, *_ = _compiled_step(equation, found, reach)
    return jnp.where(_is_small(jax.lax.stop_gradient(step), found), found + step, jnp.nan)


def _is_small(change: Tracer, x: Tracer) -> Tracer:
    """Whether a change of x (S, ..., n) is below 10^4 units of round-off, bool (1, ..., 1); False for NaN."""
    jnp = import_module("jax.numpy")
    bound = 1e4 * float(jnp.finfo(x.dtype).eps) * jnp.maximum(jnp.max(jnp.abs(x), axis=(0, -1), keepdims=True), 1.0)
    return jnp.max(jnp.abs(change), axis=(0, -1), keepdims=True) <= bound


MAX_ITERATIONS = 200
SLOW = 0.4
"""A fixed point iteration that multiplies the change by more than this is given up, and Newton's method begins."""
UNSOLVED = 1e-6
"""A solution whose residual is above this after the others were found belongs to an equation that couples them."""


def solve_implicitly(
    function: Callable[[Any], Any],
    start: Values,
    h: Real,
    *,
    rows: Sequence[SparseRow] | None = None,
    reach: float = 1.0,
) -> Values:
    """Solution x of x = function(x), where function has a factor h.

    Jets are solved coefficient by coefficient. Arrays are iterated from `start` while this converges fast, and else
    solved by Newton's method with the derivative of `function` by Jets. Each trajectory is treated separately, so that
    no result depends on the other trajectories, unless `function` couples them.

    Parameters
    ----------
    function : callable
    start : array of shape (..., n), or () for a number
    h : float, array, Jet or tracer
    rows : sequence of sparse rows, optional
        Coefficients a_ij of a Runge-Kutta method with S stages. The first axis of x is then that of the stages, and
        x_i = function([y_1, ..., y_S])_i with y_i = sum_j a_ij x_j, or None for an empty row; stage i of `function`
        depends on y_i only.
    reach : float
        The largest norm of a step of Newton's method.

    Raises
    ------
    ConvergenceError
        If no solution is found: the step size is too large. Its `unsolved` says for which trajectories.

    Notes
    -----
    A function that does not run on Jets, because it compares values, is differentiated by differences. The derivative
    has no influence on the solution. In compiled code, systems with more than 18 unknowns iterate the fixed point only,
    and numpy makes the other steps.

    Examples
    --------
    >>> import numpy as np
    >>> float(solve_implicitly(lambda x: 0.5 * np.cos(x), np.array(0.0), 0.5).round(6))
    0.450184
    >>> x = solve_implicitly(lambda x: -1000 * np.sin(x - 1.0), np.zeros(1), 1.0)  # stiff
    >>> x.round(6).tolist()
    [0.999001]
    """
    if isinstance(h, Jet):
        return _solved_on_jets(function, start, h.order, rows)
    number = rows is None and np.ndim(start) == 0
    if rows is not None:
        equation = Equation(function, rows)
    elif number:
        start, equation = start[None, None], Equation(lambda y: [function(y[0][..., 0])[..., None]], [((0, 1.0),)])
    else:
        start, equation = start[None], Equation(lambda y: [function(y[0])], [((0, 1.0),)])
    tape = h.tape if isinstance(h, Traced) else start.tape if isinstance(start, Traced) else None
    x: Any
    if tape is not None:
        x = solved_on_tape(equation, start, tape, SLOW, reach)
    elif is_jax(start):
        x = solved_by_jax(equation, start, reach)
    else:
        x = _solved(equation, np.asarray(start), reach)
    return x if rows is not None else x[0][..., 0] if number else x[0]


def reach_of(action: Action) -> float:
    """The largest norm of a step of Newton's method for generators: about a radian, a float."""
    largest = action.max_norm * float(np.sqrt(np.max(np.diag(action.inner_product.matrix))))
    return float(np.sqrt(2 * max(1.0, action.dimension / 3)) / max(largest, 1e-300))


def _solved_on_jets(function: Callable[[Any], Any], start: Values, order: int, rows: Sequence[SparseRow] | None) -> Jet:
    x = Jet.growing(zeros(start, np.shape(start)), order, zero=True)
    value: Any = function(x) if rows is None else Equation(function, rows).value(x)
    x.node.depends((value.node, 0), rule=lambda k: value.node.known[k])
    return x


def _solved(equation: Equation, start: Array, reach: float) -> Array:
    """Solution (S, ..., n), by the fixed point iteration if that is fast, else by Newton's method."""
    with np.errstate(over="ignore", invalid="ignore"):  # divergence is reported below
        x, settled, change = _iterated(equation, start)
        if settled.all():
            return x
        x, solved, change = newton(equation, np.where(settled, x, start), ~settled, reach)
        solved = solved | settled
        if x.ndim > 2 and not (solved.all() and _is_solution(equation, x)) and _couples(equation, start):
            x, solved, change = newton(equation, start, np.ones((1,) * x.ndim, dtype=bool), reach, joint=True)
    if not solved.all():
        raise ConvergenceError(
            f"an implicit step did not converge (last change of Newton's method {np.max(change):.2g}): "
            "take a smaller step size",
            np.broadcast_to(~solved[0, ..., 0], x.shape[1:-1]),
        )
    return x


def _iterated(equation: Equation, start: Array) -> tuple[Array, BooleanArray, Array]:
    """The fixed point iteration: x, where it is a solution, and the last change."""
    eps, axes, x = float(np.finfo(np.result_type(start, float)).eps), (0, -1), start
    before: Any = np.inf
    change: Any = np.zeros(())
    settled: Any = np.zeros((1, *start.shape[1:-1], 1), dtype=bool)
    slow = settled
    for _ in range(MAX_ITERATIONS):
        new: Any = equation.value(x)
        change = np.where(settled, 0.0, np.abs(new - x).max(axis=axes, keepdims=True, initial=0.0))
        size = np.abs(new).max(axis=axes, keepdims=True, initial=0.0)
        x = np.where(settled, x, new) if settled.any() else new
        settled = settled | (change <= 2 * eps * size) | ((change <= 1e4 * eps * size) & (change >= before))
        slow = slow | ~(settled | (change <= SLOW * before) | (change <= 1e4 * eps * size)) | ~np.isfinite(change)
        if (settled | slow).all():
            break
        if slow.any():
            x = np.where(slow, start, x)
        before = change
    return x, settled & ~slow, change


def _is_solution(equation: Equation, x: Array) -> bool:
    """Whether x solves the equation in all trajectories at once."""
    size = np.maximum(np.abs(x).max(axis=(0, -1), initial=0.0), 1.0)
    return bool((np.abs(equation.value(x) - x).max(axis=(0, -1), initial=0.0) <= UNSOLVED * size).all())


def _couples(equation: Equation, x: Array) -> bool:
    """Whether F of a trajectory depends on the points of other ones, by its derivative in two directions."""
    generator = np.random.default_rng(0)
    v = generator.normal(size=x.shape).astype(x.dtype)
    scales = generator.uniform(1.0, 2.0, size=(1, *x.shape[1:-1], 1)).astype(x.dtype)
    with np.errstate(over="ignore", invalid="ignore"):  # where psi is not finite nothing is known
        one, other = scales * equation.along(x, v), equation.along(x, scales * v)
        known = np.isfinite(one) & np.isfinite(other)
        size = float(np.abs(one).max(initial=0.0, where=known))
        return not bool(np.allclose(one[known], other[known], rtol=1e-6, atol=1e-6 * size))
