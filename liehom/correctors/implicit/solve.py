"""solve_implicitly: the solution of the equation of an implicit step, on arrays, Jets, tracers and JAX arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from liehom.correctors.implicit.equation import Equation, SparseRow, Stage
from liehom.correctors.implicit.newton import newton
from liehom.correctors.implicit.on_tape import solved_by_jax, solved_on_tape
from liehom.errors import ConvergenceError
from liehom.homogeneous import Action
from liehom.series.arrays import is_jax, zeros
from liehom.series.jet import Jet
from liehom.tracing import Traced
from liehom.typing import Array, BooleanArray, Real, Values

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
    stacked: bool = False,
    rows: Sequence[SparseRow] | None = None,
    reach: float = 1.0,
    hasty: bool = False,
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
    stacked : bool
        Whether the first axis is not one of the ensemble, as for unknowns that are matrices.
    rows : sequence of sparse rows, optional
        Coefficients a_ij of a Runge-Kutta method with S stages. The first axis of x is then that of the stages, and
        x_i = function([y_1, ..., y_S])_i with y_i = sum_j a_ij x_j, or None for an empty row; stage i of `function`
        depends on y_i only.
    reach : float
        The largest norm of a step of Newton's method.
    hasty : bool
        Whether to give up after few iterations, if a smaller step is tried then. Arrays only.

    Raises
    ------
    ConvergenceError
        If no solution is found: the step size is too large. Its `unsolved` says for which trajectories.

    Notes
    -----
    A function that does not run on Jets, because it compares values, is differentiated by differences. The derivative
    has no influence on the solution. In compiled code, systems with more than 12 unknowns iterate the fixed point only,
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
    if rows is not None:
        equation = Equation(function, rows)
    else:
        shape, start = np.shape(start), _flat(start, stacked)[None]
        equation = Equation(lambda y: [_flat(function(_shaped(y[0], shape, stacked)), stacked)], [((0, 1.0),)])
    tape = h.tape if isinstance(h, Traced) else start.tape if isinstance(start, Traced) else None
    if tape is not None:
        found: Any = solved_on_tape(equation, start, tape, SLOW, reach)
    else:
        found = (
            solved_by_jax(equation, start, reach)
            if is_jax(start)
            else _solved(equation, np.asarray(start), reach, hasty)
        )
    solution: Values = found if rows is not None else _shaped(found[0], shape, stacked)
    return solution


def _flat(x: Stage, stacked: bool) -> Stage:
    """x with all unknowns of a trajectory on the last axis."""
    if np.ndim(x) == 0:
        return x[..., None]
    if not stacked:
        return x
    return np.concatenate([x[i] for i in range(np.shape(x)[0])], axis=-1)


def _shaped(y: Stage, shape: tuple[int, ...], stacked: bool) -> Stage:
    """The inverse of `_flat`."""
    if not shape:
        return y[..., 0]
    n = shape[-1]
    return np.stack([y[..., i * n : (i + 1) * n] for i in range(shape[0])]) if stacked else y


def reach_of(action: Action) -> float:
    """The largest norm of a step of Newton's method for generators: about a radian, a float.

    Examples
    --------
    >>> import liehom as lh
    >>> round(reach_of(lh.Action(lh.defining(lh.so(3)))), 12)
    1.0
    """
    largest = action.max_norm * float(np.sqrt(np.max(np.diag(action.inner_product.matrix))))
    return float(np.sqrt(2 * max(1.0, action.dimension / 3)) / max(largest, 1e-300))


def _solved_on_jets(function: Callable[[Any], Any], start: Values, order: int, rows: Sequence[SparseRow] | None) -> Jet:
    x = Jet.growing(zeros(start, np.shape(start)), order, zero=True)
    made: Any = function(x) if rows is None else Equation(function, rows).value(x)
    x.node.depends((made.node, 0), rule=lambda k: made.node.known[k])
    return x


def _solved(equation: Equation, start: Array, reach: float, hasty: bool) -> Array:
    """Solution (S, ..., n), by the fixed point iteration if that is fast, else by Newton's method."""
    with np.errstate(over="ignore", invalid="ignore"):  # divergence is reported below
        x, settled, change = _iterated(equation, start)
        if settled.all():
            return x
        x, solved, change = newton(equation, np.where(settled, x, start), ~settled, reach, hasty=hasty)
        solved = solved | settled
        if x.ndim > 2 and not (solved.all() and _is_solution(equation, x)) and _couples(equation, start):
            everywhere = np.ones((1,) * x.ndim, dtype=bool)
            x, solved, change = newton(equation, start, everywhere, reach, joint=True)
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
    one, other = scales * equation.along(x, v), equation.along(x, scales * v)
    return not bool(np.allclose(one, other, rtol=1e-6, atol=1e-6 * float(np.abs(one).max(initial=0.0))))
