"""The engine "jax": numpy arrays by `Run` with compiled ordinary steps, JAX arrays by loops that JAX can transform.

A call on JAX arrays is one of three.

* All numbers are known: one compiled loop.
* `jax.grad` differentiates the call, and the numbers are known: the same loop, and for the gradient a loop with the
  step sizes of the first one, differentiated in reverse (the discrete adjoint).
* JAX traces the call (`jax.jit`, `jax.vmap`, `jax.jvp`): the loop with given sizes is part of that trace.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from math import ceil
from typing import Any, final

import numpy as np
from numpy.typing import DTypeLike

from liehom.errors import InputError
from liehom.homogeneous import GeneratorField
from liehom.integrators.compiled.compiled import compiled_steps
from liehom.integrators.compiled.jax_kernel import enabled_x64
from liehom.integrators.compiled.traced_size import SizeLimits
from liehom.integrators.engine import Problem, executed
from liehom.integrators.jax_engine.forms import step_for
from liehom.integrators.jax_engine.local_steps import StepOnJax
from liehom.integrators.jax_engine.loops import At, bound_step, with_adaptive_sizes, with_given_sizes
from liehom.integrators.jax_engine.programs import Leaves, Program, is_float
from liehom.integrators.jax_engine.solutions import Found, solution_of
from liehom.integrators.run.clock import SLACK
from liehom.integrators.run.solution import Solution
from liehom.pytrees import PerTrajectory
from liehom.series.arrays import is_jax, is_traced, namespace
from liehom.tracing.jax_code import JaxArray

STEPS_PER_NOMINAL_STEP = 1.5
"""Largest number of steps of a step with a time of its own, in units of the nominal number."""
MAX_RECORDED = 1024
"""Largest number of adaptive steps of a trajectory where JAX traces the call; `max_steps` may lower it."""
FIRST_RECORDED = 128
"""Sizes that are recorded at first where the numbers are known; the record is doubled until it is long enough."""
UNBOUNDED = 1_000_000
"""A value of `max_steps` from which on it does not bound the length of a loop."""


@final
class JaxEngine:
    """The engine "jax", which makes ordinary steps of numpy arrays, and all steps of JAX arrays, by code of JAX.

    Examples
    --------
    >>> JaxEngine().name
    'jax'
    """

    name = "jax"

    def __init__(self) -> None:
        _register_with_jax()
        self._programs: dict[Hashable, Program] = {}
        self.steps: dict[Hashable, StepOnJax] = {}

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem, with JAX arrays if the start is one."""
        if not is_jax(problem.start):
            if problem.field.sites:
                return _lattice_of_numpy(self, problem)
            return executed(problem, lambda run: compiled_steps(run, self.name))
        start: Any = problem.start
        double = start.dtype == np.float64
        with enabled_x64() if double else nullcontext():
            return _Call(self, problem).solution()

    def program(self, key: Hashable, function: Callable[..., Sequence[JaxArray]], arguments: Leaves) -> Program:
        """The trace of a function for arguments of these shapes and types, kept under a key."""
        shapes = tuple((x.shape, str(x.dtype), bool(getattr(x, "weak_type", False))) for x in arguments)
        whole = key, shapes
        if whole in self._programs:
            return self._programs[whole]
        made = Program.of(function, arguments)
        if not any(is_traced(x) for x in made.constants):
            self._programs[whole] = made
        return made


def _lattice_of_numpy(engine: JaxEngine, problem: Problem) -> Solution:
    """The solution for lattices given as numpy arrays, by array code for whole lattices; all steps without t_eval."""
    from jax import numpy as jnp

    o, start = problem.options, np.asarray(problem.start)
    times: Any = o.t_eval
    if times is None:
        if o.dt is None:
            raise InputError("engine='jax' on a lattice gives points at given times: give t_eval, or a dt")
        size, length = float(np.max(o.dt)), float(problem.span[1] - problem.span[0])
        steps = max(int(np.ceil(abs(length) / size - SLACK)), 1)
        times = problem.span[0] + np.sign(length) * size * np.arange(steps + 1)
        times[-1] = problem.span[1]
    with enabled_x64():
        whole: Any = jnp.asarray(start)
        found = engine.solve(replace(problem, start=whole, options=replace(o, t_eval=times)))
    t = times if o.t_eval is not None else np.broadcast_to(times, (*start.shape[:-1], len(times)))
    return replace(
        found, t=t, y=np.asarray(found.y), n_steps=np.asarray(found.n_steps), statuses=np.asarray(found.statuses)
    )


@final
class _Call:
    """One call on JAX arrays.

    Parameters
    ----------
    engine : JaxEngine
    problem : Problem
    """

    def __init__(self, engine: JaxEngine, problem: Problem) -> None:
        import jax

        o, start = problem.options, problem.start
        if o.events is not None or o.dense_output or o.checkpoint is not None:
            raise InputError(
                "integrate on JAX arrays gives points at t_eval, and no events, dense output or checkpoints: start "
                "from a numpy array for these"
            )
        dimensions = np.unique(problem.orbit_dimension)
        if len(dimensions) > 1 and problem.step.uses_isotropy:  # others ask for no isotropy
            raise InputError(
                "trajectories on orbits of several dimensions: integrate them one by one, or from numpy arrays"
            )
        self.engine, self.problem, self.dimension = engine, problem, int(dimensions.max())
        self.adaptive = o.dt is None
        self.step = step_for(problem, self.dimension, engine.steps)
        kind: Any = start
        kind = kind.dtype
        t0, t1 = (_array(x, kind) for x in problem.span)
        sizes = [o.rtol, o.atol, o.max_step, o.first_step or np.inf] if o.dt is None else [o.dt]
        self.times = _array(_output_times(problem), kind)
        args, self.args = jax.tree.flatten(problem.args)
        leaves = [start, t0, t1, self.times, *[_array(x, kind) for x in sizes], *map(_array, args)]
        self.leaves: Leaves = leaves
        self.known = [_known(x) for x in leaves]

    def solution(self) -> Solution:
        """The `Solution`, of JAX arrays."""
        traced = [is_traced(x) for x in self.leaves]
        program = self._program(traced=_is_nested() or (any(traced) and not self._is_reverse(self.leaves)))
        constants = program.constants
        if _is_nested() or not self._is_reverse([*self.leaves, *constants]):
            if any(traced) or any(is_traced(c) for c in constants) or _is_nested():
                if self.adaptive:
                    program = self._program(traced=True)
                found = program.compiled()(program.constants, self._arguments(traced=True))
            else:
                found = self._forward(program)
        else:
            found = self._differentiated()
        return solution_of(self.problem, self.dimension, self.times, Found(*found[:7]))

    @staticmethod
    def _is_reverse(values: Leaves) -> bool:
        """Whether JAX differentiates some of these numbers in reverse, and does nothing else with any of them."""
        # within another derivative, the numbers of the inner one are traced too
        traced = [x for x in values if is_traced(x)]
        return bool(traced) and all(_is_linear(x) and not is_traced(getattr(x, "primal", x)) for x in traced)

    # -- programs ----------------------------------------------------------------------------------------
    def _program(self, *, traced: bool, recorded: int = FIRST_RECORDED) -> Program:
        """The trace of the loop: with given sizes, with adaptive ones, or with both if JAX traces the call."""
        if not self.adaptive:
            return self._given(None)
        recorded = self._most_recorded() if traced else recorded
        key = "adaptive", traced, recorded, self.problem.options.least_step

        def function(*leaves: JaxArray) -> Sequence[JaxArray]:
            found, sizes = self._adapted(leaves, recorded)
            if not traced:
                return [*found, sizes]
            import jax

            sizes = jax.lax.stop_gradient(sizes)
            return [self._looped((*leaves[:4], sizes, *leaves[9:]), recorded + 1, table=True)[0], *found[1:]]

        return self.engine.program((*key, self._static()), function, self._arguments(traced=traced))

    def _given(self, table: JaxArray | None) -> Program:
        """The trace of the loop with given sizes: those of a table, or one for all steps."""
        import jax

        if table is None:
            arguments, iterations = self.leaves, _rounded(self._nominal_number())
        else:
            arguments, iterations = [*self.leaves[:4], table, *self.leaves[8:]], len(table) + 1
        arguments = [jax.lax.stop_gradient(x) if _is_linear(x) else x for x in arguments]
        return self.engine.program(
            ("given", iterations, table is not None, self._static()),
            lambda *leaves: self._looped(leaves, iterations, table=table is not None),
            arguments,
        )

    def _static(self) -> Hashable:
        return self.dimension, self.args, type(self.step).__name__, self.problem.step, id(self.step)

    def _arguments(self, *, traced: bool) -> Leaves:
        """Arguments of the program of `_program`."""
        if not self.adaptive:
            return self.leaves
        most = self._most_recorded() if traced else int(min(self.problem.options.max_steps, 2**31 - 2))
        return [*self.leaves[:8], np.asarray(most, np.int32), *self.leaves[8:]]

    def _most_recorded(self) -> int:
        return int(min(self.problem.options.max_steps, MAX_RECORDED))

    def _nominal_number(self) -> int:
        """A bound for the number of steps from one output time to the next."""
        most = self.problem.options.max_steps
        _, t0, _, times, dt, *_ = self.known
        if t0 is None or times is None or dt is None:
            if most >= UNBOUNDED:
                raise InputError(
                    "jax.jit traces the times or dt, so the number of steps is not known: give max_steps, a bound for "
                    "the number of steps between two output times"
                )
            return int(most)
        gaps = np.abs(np.diff(np.concatenate([[t0], times])))
        ratio = float(gaps.max(initial=0.0)) / float(np.min(dt)) if gaps.size else 0.0
        return int(min(ceil(ratio * STEPS_PER_NOMINAL_STEP if self._has_clock() else ratio) + 2, most))

    def _has_clock(self) -> bool:
        return not self.problem.options.nominal and self.problem.step.uses_isotropy

    # -- loops -------------------------------------------------------------------------------------------
    def _bound(self, start: JaxArray, args: Sequence[JaxArray]) -> tuple[GeneratorField, At]:
        import jax

        field = self.problem.field
        if self.problem.args is not None:
            field = field.with_args(jax.tree.unflatten(self.args, list(args)))
        return field, bound_step(self.step, field, start)

    def _looped(self, leaves: Sequence[JaxArray], iterations: int, *, table: bool) -> list[JaxArray]:
        """Results of the loop with given sizes, for start, span, times, sizes and the leaves of args."""
        from jax import numpy as jnp

        start, t0, t1, times, sizes, *args = leaves
        lead = start.shape[:-1]
        direction = jnp.where(t1 >= t0, 1.0, -1.0).astype(start.dtype)
        places = jnp.arange(int(np.prod(lead)))

        def size(count: JaxArray) -> JaxArray:
            if not table:
                return direction * jnp.broadcast_to(sizes, lead)
            index = jnp.minimum(count.reshape(-1), len(sizes) - 1)
            found: JaxArray = sizes.reshape(len(sizes), -1)[index, places].reshape(lead)
            return found

        _, at = self._bound(start, args)
        found, state = with_given_sizes(
            at, start, t0, times, size, iterations, end=t1, direction=direction, by_counting=not table
        )
        return [found, state.code, state.count, state.t, state.failed, state.near, state.lost]

    def _adapted(self, leaves: Sequence[JaxArray], recorded: int) -> tuple[list[JaxArray], JaxArray]:
        """Results of the loop with adaptive sizes, and these sizes (recorded, ...); no derivative passes through."""
        import jax
        from jax import numpy as jnp

        start, t0, t1, times, rtol, atol, max_step, first, most, *args = map(jax.lax.stop_gradient, leaves)
        direction: Any = jnp.where(t1 >= t0, 1.0, -1.0).astype(start.dtype)
        tiny: Any = 8 * float(np.finfo(start.dtype).eps) * jnp.maximum(jnp.abs(t0), jnp.abs(t1))
        tiny = jnp.maximum(tiny, self.problem.options.least_step)
        limits = SizeLimits(rtol, atol, max_step, t1, direction, tiny)
        field, at = self._bound(start, args)
        step: Any = self.step
        found, state, sizes = with_adaptive_sizes(step, field, at, start, t0, times, limits, first, most, recorded)
        return [found, state.code, state.count, state.t, state.failed, state.near, state.lost], sizes

    # -- the ways to run them ----------------------------------------------------------------------------
    def _forward(self, program: Program) -> Leaves:
        return program.compiled("forward")(_concrete(program.constants), _concrete(self._arguments(traced=False)))

    def _differentiated(self) -> Leaves:
        """Results of a call that JAX differentiates in reverse: first the numbers, then, if wanted, the derivative."""
        import jax

        values, table = self._forward_and_sizes()
        program = self._given(table)
        arguments = self.leaves if table is None else [*self.leaves[:4], table, *self.leaves[8:]]
        linear = [is_float(x) and _is_linear(x) for x in arguments]
        moving = [is_float(c) for c in program.constants]
        known, constants = _concrete(arguments), _concrete(program.constants)

        def value(*_: JaxArray) -> Leaves:
            return values

        def backward(_: object, cotangents: Leaves) -> tuple[JaxArray, ...]:
            pullback = program.pullback(linear, nested=is_traced(cotangents[0]) or _is_nested())
            to_constants, to_arguments = pullback(constants, known, cotangents[0])
            return (*to_constants, *to_arguments)

        run = jax.custom_vjp(value)
        run.defvjp(lambda *_: (values, None), backward)
        parts = [c for c, take in zip(program.constants, moving, strict=True) if take]
        found: Leaves = run(*parts, *[x for x, take in zip(arguments, linear, strict=True) if take])
        return found

    def _forward_and_sizes(self) -> tuple[Leaves, JaxArray | None]:
        """Results of the loop for the known numbers, and the step sizes if they are adaptive."""
        if not self.adaptive:
            return self._forward(self._program(traced=False)), None
        recorded, most = FIRST_RECORDED, self.problem.options.max_steps
        while True:
            *values, sizes = self._forward(self._program(traced=False, recorded=recorded))
            count = int(np.max(values[2], initial=0)) + 1
            if count <= recorded or recorded >= most:
                return values, sizes[: min(recorded, _rounded(count))]
            recorded = min(_rounded(2 * count), int(most))


# -- private helpers -------------------------------------------------------------------------------------
def _output_times(problem: Problem) -> JaxArray:
    """Times of `t_eval`, by default the initial and the final time."""
    times = problem.options.t_eval
    if times is not None:
        return times
    t0, t1 = problem.span
    same = _known(t0) is not None and _known(t1) is not None and float(_known(t0)) == float(_known(t1))
    ends = [t0] if same else [t0, t1]
    return namespace(*ends).stack(ends)


def _array(x: JaxArray, dtype: DTypeLike | None = None) -> JaxArray:
    """x as an array; within jax.jit, numbers stay numpy arrays, so that they are known."""
    return namespace(x).asarray(x, dtype)


def _is_nested() -> bool:
    """Whether JAX traces all operations, as under jax.jit."""
    from jax import numpy as jnp

    return is_traced(jnp.zeros(()))


def _is_linear(x: JaxArray) -> bool:
    return is_traced(x) and type(x).__name__ == "LinearizeTracer"


def _known(x: JaxArray) -> JaxArray:
    """The numbers of an array, also while JAX differentiates it; None if they are not known."""
    if is_traced(x):
        import jax

        x = jax.lax.stop_gradient(x)
    return None if is_traced(x) else np.asarray(x)


def _concrete(values: Leaves) -> Leaves:
    import jax

    return [jax.lax.stop_gradient(x) if is_traced(x) else x for x in values]


def _rounded(number: int) -> int:
    """The number rounded up to three binary digits, so that few loops of different lengths are compiled.

    Examples
    --------
    >>> [_rounded(n) for n in (3, 9, 100, 113)]
    [3, 10, 112, 128]
    """
    unit = 1 << max(0, number.bit_length() - 3)
    return -(-number // unit) * unit


def _register_with_jax() -> None:
    """Make `PerTrajectory` a container for JAX, so that jax.grad, jax.jit and jax.vmap look into it."""
    try:
        import jax
    except ImportError:
        return  # the first run says what is missing

    def made(_: None, inside: tuple[Any, ...]) -> PerTrajectory:
        found = object.__new__(PerTrajectory)  # JAX puts placeholders into containers
        (found.value,) = inside
        return found

    with suppress(ValueError):  # it is registered already
        jax.tree_util.register_pytree_node(PerTrajectory, lambda given: ((given.value,), None), made)
