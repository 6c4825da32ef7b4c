"""The engine "jax": steps on JAX arrays as scalar graphs or array code."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from math import ceil
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import DTypeLike

from liehom.base.errors import InputError, TraceError
from liehom.base.pytrees import PerTrajectory, leaves, unwrapped
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.fingerprint import Watch, parts_of
from liehom.flow.action.space import tight_frame
from liehom.flow.engines.engine import Problem, executed
from liehom.flow.engines.jax_loops import (
    ArrayStep,
    At,
    GraphStep,
    JaxKernel,
    Leaves,
    Program,
    chosen,
    enabled_x64,
    is_float,
    with_adaptive_sizes,
    with_given_sizes,
)
from liehom.flow.engines.llvm_engine import CodeStore, CompiledRun
from liehom.flow.engines.traced_step import args_form, traced_step
from liehom.flow.run.check import gap_of
from liehom.flow.run.control import ERROR_TERMS, SLACK, SizeLimits
from liehom.flow.run.options import END, ORDER_NOT_KEPT, outcome
from liehom.flow.run.records import Report, StepStatistics, loss_of_order
from liehom.flow.run.solution import Solution
from liehom.flow.series.arrays import is_jax, is_traced, namespace
from liehom.flow.steps.conserving import Conserving
from liehom.flow.tracing.graph import needed
from liehom.flow.tracing.loop import StepGraph
from liehom.flow.tracing.sweeps import JaxArray, jax, jnp

StepOnJax: TypeAlias = ArrayStep | GraphStep

# The choice between the two forms of a step on JAX arrays, a scalar graph or array code. XLA compiles a graph of n
# operations in a time that grows like n^2, on one core about 0.2 s for 600, 2 s for 1600 and 20 s for 6000. Array code
# of the same steps takes 0.4 s to 1 s. Once compiled, short graphs are 3 to 10 times faster.

MAX_GRAPH_OPERATIONS = 700  # of scalar graphs that are compiled as graphs, longer ones as array code
MAX_GRAPH_ARGS = 100  # numbers in args; with more, each of which is an operation, steps are compiled as array code


def step_for(problem: Problem, dimension: int, known: dict[Hashable, StepOnJax]) -> StepOnJax:
    """The step in the form that is compiled: as a graph if it is short, else as array code."""
    o, action, step = problem.options, problem.action, problem.step
    array = ArrayStep(action, step, dimension, o.nominal, ERROR_TERMS if o.dt is None else 0)
    args, lead = problem.args, problem.start.ndim - 1
    numbers = sum(int(np.size(leaf.value)) for leaf in leaves(unwrapped(args)))
    if o.dt is None or numbers > MAX_GRAPH_ARGS or _closes_over_jax(problem.field.source):
        return array
    n, traced = problem.field.representation.size, is_traced(problem.start)
    start: Any = np.random.default_rng(0).normal(size=(16, n)) if traced else problem.start
    points = np.asarray(start, dtype=np.float64).reshape(-1, n)
    tight = tight_frame(action, points, dimension) if step.uses_isotropy else None
    form = None if args is None else (lead, args_form(args, lead))
    # numpy zeros in place of numbers, which JAX may trace
    blank = jax.tree.map(lambda x: np.zeros(np.shape(x), getattr(x, "dtype", np.dtype(type(x)))), args)
    key = dimension, form, None if tight is None else repr([np.asarray(x).tolist() for x in tight[:4]])
    if key not in known:
        try:
            graph = traced_step(
                action, problem.field, step, points, dimension, nominal=o.nominal, args=blank, lead=lead,
                branching=False,
            )  # fmt: skip
            known[key] = GraphStep(graph) if _is_short(graph) or isinstance(step, Conserving) else array
        except TraceError:
            known[key] = array
    return known[key]


def _closes_over_jax(source: object) -> bool:
    """Whether a function uses JAX arrays of its surroundings; a graph would have their numbers in its operations."""
    return any(is_jax(x) for part in parts_of(source) for x in jax.tree.leaves(part))


def _is_short(graph: StepGraph) -> bool:
    """Whether a graph is compiled as such: array code differentiates loops by the implicit function theorem."""
    operations = needed([*graph.point, *graph.summed.values()])
    return len(operations) <= MAX_GRAPH_OPERATIONS and not any(x.op == "loop" for x in operations)


# The `Solution` of a call on JAX arrays, with a status for each trajectory as from numpy arrays.


def solution_of(problem: Problem, dimension: int, times: JaxArray, results: Leaves) -> Solution:
    """The solution, with JAX arrays, from points (k, ..., N) and arrays (...) of a `State` at the times."""
    report = _report(problem, dimension)
    code, count, t, failed, near, lost = map(jax.lax.stop_gradient, results[1:])
    unkept_order = ORDER_NOT_KEPT if problem.options.dt is not None else 0
    statuses: Any = jnp.where(code < 0, -1, jnp.where(jnp.isfinite(lost), unkept_order, 0))
    status, message = 0, "Traced by JAX: `statuses` is -1 for trajectories that failed; there y is nan."
    if not is_traced(code) and not is_traced(problem.span[0]):
        start, end = (np.asarray(jax.lax.stop_gradient(x)) for x in problem.span)
        direction = 1.0 if end >= start else -1.0
        first: Any = np.where(np.isfinite(lost), lost, np.nan)
        failed, near = (int(np.sum(np.asarray(x))) for x in (failed, near))
        reason = loss_of_order(failed, near, report.base_order)
        counted = first if unkept_order else np.full_like(first, np.nan)
        ended = outcome(np.asarray(code), np.asarray(t), counted, direction, problem.step.order, reason)
        status, message = ended.status, ended.message
        if not np.all(np.isnan(first)):
            unkept = direction * float(np.nanmin(direction * first))
            order = report.base_order
            report = replace(report, order=order, failed_steps=failed, near_steps=near, unkept_from=unkept)
        report = replace(report, stopped_at=ended.stopped_at)
    alone = code.ndim == 0 and not is_traced(code)
    return Solution(
        t=times, y=jnp.moveaxis(results[0], 0, -1), sol=None, t_events=None, y_events=None, nfev=0, status=status,
        message=message, n_steps=count + (code == END), report=report, statuses=status if alone else statuses,
    )  # fmt: skip


def _report(problem: Problem, dimension: int) -> Report:
    """The report that repeats the options; the order that is reached is not known while JAX traces."""
    o, record = problem.options, StepStatistics(problem.step, ())
    check = o.check(problem.field.time_dependent)
    report = record.report(problem.action, o.clock, dimension, check=check, engine="jax")
    return replace(report, worst_residual=float("nan"), singular_value=float("nan"), rank=dimension)


# The engine "jax": numpy arrays by `Run` with compiled steps, JAX arrays by loops that JAX can transform. A
# call on JAX arrays is one of three.
# * All numbers are known: one compiled loop.
# * `jax.grad` differentiates the call, and the numbers are known: the same loop, and for the gradient a loop with the
#   step sizes of the first one, differentiated in reverse (the discrete adjoint).
# * JAX traces the call (`jax.jit`, `jax.vmap`, `jax.jvp`): the loop with given sizes is part of that trace.

STEPS_PER_NOMINAL_STEP = 1.5  # largest number of steps of a step with a time of its own, in units of the nominal number
MAX_RECORDED = 1024  # adaptive steps of a trajectory, at most, where JAX traces the call; `max_steps` may lower it
FIRST_RECORDED = 128  # sizes that are recorded at first where the numbers are known; doubled until they are enough
UNBOUNDED = 1_000_000  # a value of `max_steps` from which on it does not bound the length of a loop


@final
class JaxEngine:
    """The engine "jax", which makes the steps of numpy arrays and of JAX arrays by code of JAX."""

    name = "jax"

    def __init__(self) -> None:
        _register_with_jax()
        self._programs: dict[Hashable, Program] = {}
        self.steps: dict[Hashable, StepOnJax] = {}
        self._watch: Watch | None = None

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem, with JAX arrays if the start is one."""
        if not is_jax(problem.start):
            if problem.field.sites:
                return _lattice_of_numpy(self, problem)
            if problem.options.events is not None:
                raise InputError("engine='jax' does not look for events: take engine='llvm' or engine='numpy'")
            return executed(problem, lambda run: CompiledRun(problem, run, CodeStore(JaxKernel)))
        if self._watch is None or self._watch.changed():
            self._programs, self.steps = {}, {}
            self._watch = Watch(problem.bound, problem.start, problem.span[0])
        with enabled_x64() if problem.start.dtype == np.float64 else nullcontext():
            return _Call(self, problem).solution()

    def program(self, key: Hashable, function: Callable[..., Sequence[JaxArray]], arguments: Leaves) -> Program:
        """The trace of a function for arguments of these shapes and types, kept under a key."""
        shapes = tuple((x.shape, str(x.dtype), bool(getattr(x, "weak_type", False))) for x in arguments)
        program = self._programs.get((key, shapes)) or Program.of(function, arguments)
        if not any(map(is_traced, program.constants)):
            self._programs[key, shapes] = program
        return program


def _lattice_of_numpy(engine: JaxEngine, problem: Problem) -> Solution:
    """The solution for lattices given as numpy arrays, by array code for whole lattices; all steps without t_eval."""
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
        lattice: Any = jnp.asarray(start)
        solution = engine.solve(replace(problem, start=lattice, options=replace(o, t_eval=times)))
    t = times if o.t_eval is not None else np.broadcast_to(times, (*start.shape[:-1], len(times)))
    return replace(
        solution, t=t, y=np.asarray(solution.y), n_steps=np.asarray(solution.n_steps),
        statuses=np.asarray(solution.statuses),
    )  # fmt: skip


@final
class _Call:
    """One call on JAX arrays."""

    def __init__(self, engine: JaxEngine, problem: Problem) -> None:
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
        kind = start.dtype
        t0, t1 = (_array(x, kind) for x in problem.span)
        sizes = [o.rtol, o.atol, o.max_step, o.first_step or np.inf] if o.dt is None else [o.dt]
        self.times = _array(_output_times(problem), kind)
        args, self.args = jax.tree.flatten(problem.args)
        self.leaves: Leaves = [start, t0, t1, self.times, *[_array(x, kind) for x in sizes], *map(_array, args)]
        self.known = [_known(x) for x in self.leaves]

    def solution(self) -> Solution:
        """The `Solution`, of JAX arrays."""
        nested, traced = _is_nested(), any(map(is_traced, self.leaves))
        program = self._program(traced=nested or (traced and not self._is_reverse(self.leaves)))
        if not nested and self._is_reverse([*self.leaves, *program.constants]):
            results = self._differentiated()
        elif nested or traced or any(map(is_traced, program.constants)):
            program = self._program(traced=True) if self.adaptive else program
            results = program.compiled()(program.constants, self._arguments(traced=True))
        else:
            results = self._forward(program)
        return solution_of(self.problem, self.dimension, self.times, results[:7])

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
        recorded = int(min(self.problem.options.max_steps, MAX_RECORDED)) if traced else recorded
        key = "adaptive", traced, recorded, self.problem.options.least_step, self.problem.options.looks

        def function(*leaves: JaxArray) -> Sequence[JaxArray]:
            results, sizes = self._adapted(leaves, recorded)
            if not traced:
                return [*results, sizes]
            leaves = *leaves[:4], jax.lax.stop_gradient(sizes), *leaves[9:]
            return [self._looped(leaves, recorded + 1, table=True)[0], *results[1:]]

        return self.engine.program((*key, self._static()), function, self._arguments(traced=traced))

    def _given(self, table: JaxArray | None) -> Program:
        """The trace of the loop with given sizes: those of a table, or one for all steps."""
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
        most = int(min(self.problem.options.max_steps, MAX_RECORDED if traced else 2**31 - 2))
        return [*self.leaves[:8], np.asarray(most, np.int32), *self.leaves[8:]]

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
        has_clock = not self.problem.options.nominal and self.problem.step.uses_isotropy
        return int(min(ceil(ratio * STEPS_PER_NOMINAL_STEP if has_clock else ratio) + 2, most))

    # -- loops -------------------------------------------------------------------------------------------
    def _bound(self, start: JaxArray, args: Sequence[JaxArray]) -> tuple[GeneratorField, At]:
        field = self.problem.field
        if self.problem.args is not None:
            field = field.with_args(jax.tree.unflatten(self.args, list(args)))
        return field, lambda m, t: self.step.at(field, m, t, start)

    def _looped(self, leaves: Sequence[JaxArray], iterations: int, *, table: bool) -> list[JaxArray]:
        """Results of the loop with given sizes, for start, span, times, sizes and the leaves of args."""
        start, t0, t1, times, sizes, *args = leaves
        lead = start.shape[:-1]
        direction = jnp.where(t1 >= t0, 1.0, -1.0).astype(start.dtype)
        places = jnp.arange(int(np.prod(lead)))

        def size(count: JaxArray) -> JaxArray:
            if not table:
                return direction * jnp.broadcast_to(sizes, lead)
            index = jnp.minimum(count.reshape(-1), len(sizes) - 1)
            return sizes.reshape(len(sizes), -1)[index, places].reshape(lead)

        _, at = self._bound(start, args)
        points, state = with_given_sizes(
            at, start, t0, times, size, iterations, end=t1, direction=direction, by_counting=not table
        )
        return [points, state.code, state.count, state.t, state.failed, state.near, state.lost]

    def _adapted(self, leaves: Sequence[JaxArray], recorded: int) -> tuple[list[JaxArray], JaxArray]:
        """Results of the loop with adaptive sizes, and these sizes (recorded, ...); no derivative passes through."""
        start, t0, t1, times, rtol, atol, max_step, first, most, *args = map(jax.lax.stop_gradient, leaves)
        direction: Any = jnp.where(t1 >= t0, 1.0, -1.0).astype(start.dtype)
        tiny: Any = 8 * float(np.finfo(start.dtype).eps) * jnp.maximum(jnp.abs(t0), jnp.abs(t1))
        tiny = jnp.maximum(tiny, self.problem.options.least_step)
        field, at = self._bound(start, args)
        gap = gap_of(self.problem.options.looks, t1 - t0, field)
        limits = SizeLimits(rtol, atol, max_step, t1, direction, tiny, gap)
        step: Any = self.step
        points, state, sizes = with_adaptive_sizes(step, field, at, start, t0, times, limits, first, most, recorded)
        return [points, state.code, state.count, state.t, state.failed, state.near, state.lost], sizes

    # -- the ways to run them ----------------------------------------------------------------------------
    def _forward(self, program: Program) -> Leaves:
        return program.compiled("forward")(_concrete(program.constants), _concrete(self._arguments(traced=False)))

    def _differentiated(self) -> Leaves:
        """Results of a call that JAX differentiates in reverse: first the numbers, then, if wanted, the derivative."""
        values, table = self._forward_and_sizes()
        program = self._given(table)
        arguments = self.leaves if table is None else [*self.leaves[:4], table, *self.leaves[8:]]
        linear = [is_float(x) and _is_linear(x) for x in arguments]
        moving = [is_float(c) for c in program.constants]
        known, constants = _concrete(arguments), _concrete(program.constants)

        def backward(_: object, cotangents: Leaves) -> tuple[JaxArray, ...]:
            pullback = program.pullback(linear, nested=is_traced(cotangents[0]) or _is_nested())
            to_constants, to_arguments = pullback(constants, known, cotangents[0])
            return (*to_constants, *to_arguments)

        run = jax.custom_vjp(lambda *_: values)
        run.defvjp(lambda *_: (values, None), backward)
        return run(*chosen(moving, program.constants), *chosen(linear, arguments))

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


def _output_times(problem: Problem) -> JaxArray:
    """Times of `t_eval`, by default the initial and the final time."""
    times = problem.options.t_eval
    if times is not None:
        return times
    t0, t1 = map(_known, problem.span)
    same = t0 is not None and t1 is not None and float(t0) == float(t1)
    ends = problem.span[: 1 if same else 2]
    return namespace(*ends).stack(ends)


def _array(x: JaxArray, dtype: DTypeLike | None = None) -> JaxArray:
    """x as an array; within jax.jit, numbers stay numpy arrays, so that they are known."""
    return namespace(x).asarray(x, dtype)


def _is_nested() -> bool:
    """Whether JAX traces all operations, as under jax.jit."""
    return is_traced(jnp.zeros(()))


def _is_linear(x: JaxArray) -> bool:
    return is_traced(x) and type(x).__name__ == "LinearizeTracer"


def _known(x: JaxArray) -> JaxArray:
    """The numbers of an array, also while JAX differentiates it; None if they are not known."""
    if is_traced(x):
        x = jax.lax.stop_gradient(x)
    return None if is_traced(x) else np.asarray(x)


def _concrete(values: Leaves) -> Leaves:
    return [jax.lax.stop_gradient(x) if is_traced(x) else x for x in values]


def _rounded(number: int) -> int:
    """The number rounded up to three binary digits, so that few loops of different lengths are compiled."""
    unit = 1 << max(0, number.bit_length() - 3)
    return -(-number // unit) * unit


def _register_with_jax() -> None:
    """Make `PerTrajectory` a container for JAX, so that jax.grad, jax.jit and jax.vmap look into it."""

    def made(_: None, inside: tuple[Any, ...]) -> PerTrajectory:
        slices = object.__new__(PerTrajectory)  # JAX puts placeholders into containers
        (slices.value,) = inside
        return slices

    with suppress(ValueError, ImportError):  # it is registered already, or the first run says what is missing
        jax.tree_util.register_pytree_node(PerTrajectory, lambda given: ((given.value,), None), made)
