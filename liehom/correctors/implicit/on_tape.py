"""The equations of implicit steps in compiled code: loops whose iterations each lane makes as long as it needs."""

from __future__ import annotations

from importlib import import_module
from typing import Any, TypeAlias

import numpy as np

from liehom.correctors.implicit.equation import Equation
from liehom.tracing import Tape, Traced, while_loop
from liehom.typing import Values

Tracer: TypeAlias = Any
"""A traced array, or a JAX array."""

FIXED_POINT_ITERATIONS = 200
NEWTON_ITERATIONS = 30
JAX_ITERATIONS = 60
MAX_TRACED = 12
"""Largest number of unknowns for which the elimination is traced; larger systems iterate the fixed point only."""
EPS = float(np.finfo(np.float64).eps)


def solved_on_tape(equation: Equation, start: Values, tape: Tape, slow: float, reach: float) -> Traced:
    """Solution x of x = F(A x) on tracers, of the shape of start; numpy takes a step for which it fails.

    Parameters
    ----------
    equation : Equation
    start : array of shape (S, n)
    tape : Tape
    slow : float
        A fixed point iteration that multiplies the change by more than this is given up, and Newton's method begins.
    reach : float
        The largest norm of a step of Newton's method.
    """
    small = int(np.prod(np.shape(start))) <= MAX_TRACED

    def iteration(x: Traced, before: Traced, settled: Values, failed: Values) -> tuple[list[Values], Values]:
        made = equation.value(x)
        change: Values = np.where(settled, 0.0, np.abs(made - x).max())
        size = np.abs(made).max()
        kept: Values = np.where(settled, x, made)
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
    found: Traced = np.where(settled, x, solved)  # type: ignore[assignment]
    return found


def _newton_on_tape(
    equation: Equation, start: Values, tape: Tape, wanted: Tracer, reach: float
) -> tuple[Traced, Tracer]:
    """Newton's method in the lanes `wanted`, without the search for a direction that arrays have."""
    shape = np.shape(start)
    count = shape[0] * shape[1]

    def iteration(active: Tracer, x: Tracer, before: Tracer, solved: Tracer) -> tuple[list[Values], Values]:
        residual = equation.value(x) - x
        step: Tracer = np.linalg.solve(np.eye(count) - _whole(equation, x), residual.reshape(count)).reshape(shape)
        length = np.sqrt((step * step).sum())
        along = ((step * residual).sum() > 0) | (length <= 0.1 * reach)
        limited = length > reach
        step = step * np.where(limited, reach / np.where(limited, length, 1.0), 1.0)
        trial = x + step
        change, size = np.abs(step).max(), np.abs(trial).max()
        done = (change <= 2 * EPS * size) | (
            (change <= 1e4 * EPS * np.maximum(size, 1.0)) & ((change >= before / 2) | (change == 0))
        )
        done = active & done & ~limited
        x = np.where(active, trial, x)
        solved = solved | done
        active = active & ~done & along & np.isfinite(change)
        return [active, x, np.where(active, change, before), solved], active

    first = [wanted, start, np.inf, tape.false]
    _, x, _, solved = while_loop(iteration, first, tape, NEWTON_ITERATIONS, guarded=True)
    return x, solved


def _whole(equation: Equation, x: Tracer) -> Tracer:
    """The derivative of F(A x), shape (S n, S n)."""
    blocks: Tracer = equation.blocks(x)
    s, n = np.shape(x)
    matrix = equation.matrix
    rows = [[blocks[i, a, b] * matrix[i, j] for j in range(s) for b in range(n)] for i in range(s) for a in range(n)]
    return np.stack([np.stack(row) for row in rows])


def solved_by_jax(equation: Equation, start: Tracer, reach: float) -> Tracer:
    """Solution of x = F(A x) on JAX arrays of shape (S, ..., n); NaN for trajectories for which none is found.

    Iterations are not differentiated. One more step of Newton's method from the solution has the derivative that the
    implicit function theorem gives.
    """
    jax = import_module("jax")
    jnp = jax.numpy
    s, n = start.shape[0], start.shape[-1]
    if s * n > MAX_TRACED:
        # a loop, as sixty copies of the function would take minutes to compile
        found = jax.lax.fori_loop(0, JAX_ITERATIONS, lambda _, x: equation.value(x), start)
        return jnp.where(_is_small(equation.value(found) - found, found), found, jnp.nan)
    lead, matrix, one = start.shape[1:-1], jnp.asarray(equation.matrix, start.dtype), jnp.eye(s * n, dtype=start.dtype)

    def newton(x: Tracer) -> Tracer:
        whole = jnp.einsum("i...ab,ij->...iajb", equation.blocks(x), matrix).reshape(*lead, s * n, s * n)
        right = jnp.moveaxis(equation.value(x) - x, 0, -2).reshape(*lead, s * n, 1)
        step = jnp.linalg.solve(one - whole, right).reshape(*lead, s, n)
        return jnp.moveaxis(step, -2, 0)

    def iteration(state: tuple[int, Tracer, Tracer]) -> tuple[int, Tracer, Tracer]:
        k, x, _ = state
        step = newton(x)
        length = jnp.sqrt(jnp.sum(step * step, axis=(0, -1), keepdims=True))
        along = (jnp.sum(step * (equation.value(x) - x), axis=(0, -1), keepdims=True) > 0) | (length <= 0.1 * reach)
        step = step * jnp.where(length > reach, reach / jnp.where(length > reach, length, 1.0), 1.0)
        step = jnp.where(along, step, jnp.nan)  # it would lead to another solution, far away
        return k + 1, x + step, jnp.all(_is_small(step, x) | ~jnp.isfinite(step))

    found = jax.lax.while_loop(lambda s: (s[0] < NEWTON_ITERATIONS) & ~s[2], iteration, (0, start, start.size == 0))[1]
    found = jax.lax.stop_gradient(found)
    step = newton(found)
    return jnp.where(_is_small(jax.lax.stop_gradient(step), found), found + step, jnp.nan)


def _is_small(change: Tracer, x: Tracer) -> Tracer:
    """Whether a change of x (S, ..., n) is below 10^4 units of round-off, bool (1, ..., 1); False for NaN."""
    jnp = import_module("jax.numpy")
    bound = 1e4 * float(jnp.finfo(x.dtype).eps) * jnp.maximum(jnp.max(jnp.abs(x), axis=(0, -1), keepdims=True), 1.0)
    small: Tracer = jnp.max(jnp.abs(change), axis=(0, -1), keepdims=True) <= bound
    return small
