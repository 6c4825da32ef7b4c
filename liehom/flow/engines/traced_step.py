"""A step and its adaptive sizes as a graph, with its parameters."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from functools import reduce
from typing import Any

import numpy as np

from liehom.base.errors import LiehomError, TraceError
from liehom.base.pytrees import Leaf, PerTrajectory, leaves, mapped
from liehom.base.typing import Array, IntegerArray, Lanes, Pytree, Real, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action, tight_frame
from liehom.flow.run.check import Seen, is_unbounded
from liehom.flow.run.control import (
    ERROR_TERMS,
    MAX_RATE,
    MIN_RATE,
    NEWTON_ITERATIONS,
    SLACK,
    SizeLimits,
    clock_at,
    first_size,
    judgement,
    tried_size,
)
from liehom.flow.run.records import LOST, bounds_of, earliness
from liehom.flow.steps.step import Generator, LocalStep, Step
from liehom.flow.tracing.array import Operand, Traced
from liehom.flow.tracing.graph import LEAST_LOOP, Expr, LongGraphError, Tape
from liehom.flow.tracing.loop import Sizes, StepGraph, while_loop

# Parameters of a traced step: the numbers in args, as constants of the run or of a trajectory. A number is known by its
# name, such as ``args['inertia'][0]``. So a graph that was traced for some args can be run for others of the same form,
# with the values of `arg_values`.


def traced_args(tape: Tape, args: Pytree, lead: int = 1) -> Pytree:
    """args with tracers for its numbers: `RunConstant` and, for slices of a trajectory, `LaneConstant`."""

    def traced(leaf: Leaf) -> Traced:
        value, shape, varies = _of(leaf, lead)
        constant = tape.lane_constant if varies else tape.run_constant
        entries = np.empty(shape, dtype=object)
        for entry, name, number in _entries(leaf, lead):
            entries[entry] = constant(name, number)
        return Traced(tape, entries) != 0 if _is_boolean(value) else Traced(tape, entries)

    return mapped(args, traced)


def arg_values(args: Pytree, lead: int) -> dict[str, Any]:
    """The numbers in args by their names: numbers, or arrays (L,) for slices of the trajectories."""
    return {name: number for leaf in leaves(args) for _, name, number in _entries(leaf, lead)}


def numbers_in(found: Sequence[Leaf], lead: int) -> list[Any]:
    """The numbers in the leaves of args, without JAX, in the order of `arg_values`."""
    numbers: list[Any] = []
    for _, x in found:
        if isinstance(x, PerTrajectory):
            numbers += list(x.value.reshape(int(np.prod(x.value.shape[:lead], dtype=int)), -1).T)
        else:
            numbers += (x if type(x) is np.ndarray else np.asarray(x)).reshape(-1).tolist()
    return numbers


def args_form(args: Pytree, lead: int) -> Hashable:
    """The form that args must share for one graph to serve them: paths and shapes."""
    form = ((leaf.path, *_of(leaf, lead)) for leaf in leaves(args))
    return tuple((path, shape, varies, _is_boolean(value)) for path, value, shape, varies in form)


def args_of_lanes(args: Pytree, lead: tuple[int, ...], lanes: IntegerArray) -> Pytree:
    """args of some trajectories of an ensemble, whose slices per trajectory are then of shape (L, ...)."""

    def taken(leaf: Leaf) -> object:
        if not isinstance(leaf.value, PerTrajectory):
            return leaf.value
        value = leaf.value.value
        return PerTrajectory(value.reshape(-1, *value.shape[len(lead) :])[lanes])

    return mapped(args, taken)


def _of(leaf: Leaf, lead: int) -> tuple[Any, tuple[int, ...], bool]:
    """Value of a leaf, its shape for one trajectory, and whether it has one slice per trajectory."""
    varies = isinstance(leaf.value, PerTrajectory)
    value = leaf.value.value if varies else leaf.value
    return value, tuple(np.shape(value))[lead if varies else 0 :], varies


def _is_boolean(value: object) -> bool:
    """Whether a number or an array is of boolean type."""
    return bool(getattr(value, "dtype", np.dtype(type(value))).kind == "b")


def _entries(leaf: Leaf, lead: int) -> Iterator[tuple[tuple[int, ...], str, Any]]:
    """Place, name and value of each number of a leaf."""
    value, shape, varies = _of(leaf, lead)
    for entry in np.ndindex(shape):
        number = value[(..., *entry)].reshape(-1) if varies else value[entry] if entry else value
        yield entry, leaf.path + "".join(f"[{i}]" for i in entry), number


EPS = float(np.finfo(np.float64).eps)


def size_to_stop(
    local: LocalStep | None, h: Lanes, left: Lanes, bounds: tuple[Lanes, Lanes]
) -> tuple[Lanes, Lanes, Lanes]:
    """A step size that ends at a stop in the time `left` if the step reaches it: on tracers."""
    direction, tiny = bounds
    if local is None:
        reached = direction * (left - h) <= SLACK * np.abs(h) + tiny
        return np.where(reached, left, h), reached, True
    tape, size = h.tape, h
    passed = local.time(h)
    reached = direction * (left - passed) <= SLACK * np.abs(h)

    def newton(wanted: Lanes, s: Lanes) -> tuple[list[Lanes], Lanes]:
        slope = 1 + sum(k * c * s ** (k - 1) for k, c in local.clock)
        new = s + (left - local.time(s)) / np.clip(slope, MIN_RATE, MAX_RATE)
        again = wanted & (np.abs(new - s) > 2 * EPS * np.abs(s))
        return [again, np.where(wanted, new, s)], again

    unsolved, size = while_loop(newton, [reached, h], tape, NEWTON_ITERATIONS, guarded=True)
    return size, reached, ~unsolved


# A step of the library as a graph of scalar operations: the code of the step, run on tracers.

MAX_CLOCK_DEVIATION = 0.8  # τ certainly increases at an admissible rate if |τ' - 1| is below this over the whole step


def traced_step(
    action: Action, field: GeneratorField, step: Step, points: Array, orbit_dimension: int, *, nominal: bool,
    ends: tuple[float, float] = (0.0, 0.0), limits: SizeLimits | None = None,
    stops: bool = False, args: Pytree = None, lead: int = 1, branching: bool = True,
    unrolled: int | None = None,
) -> StepGraph:  # fmt: skip
    """The graph of a step on orbits of one dimension; of more than `unrolled` operations, with loops over entries."""

    def traced(tape: Tape) -> StepGraph:
        own = field if args is None else field.with_args(traced_args(tape, args, lead))
        graph = _traced(tape, action, own, step, points, orbit_dimension, nominal, ends, limits, stops)
        tape.most = None  # a check of the initial points is added later
        return graph

    try:
        try:
            return traced(Tape(branching=branching, most=unrolled))
        except LongGraphError:
            return traced(Tape(least_loop=LEAST_LOOP))
    except TraceError as error:
        raise TraceError(f"{step!r} cannot be compiled for this field: {error}") from error
    except (LiehomError, TypeError, AttributeError, ValueError, IndexError) as error:
        raise TraceError(
            f"{step!r} cannot be compiled for this field, because its code does not run on traced numbers "
            f"({type(error).__name__}: {error}): write psi with numpy functions, or take engine='numpy'"
        ) from error


def _traced(
    tape: Tape, action: Action, field: GeneratorField, step: Step, points: Array, orbit_dimension: int, nominal: bool,
    ends: tuple[float, float], limits: SizeLimits | None, stops: bool,
) -> StepGraph:  # fmt: skip
    n = field.representation.size
    action = with_traced_frame(tape, action, step, points, orbit_dimension)
    m, t = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n))
    h: Any = Traced(tape, tape.input(n + 1))
    psi, error_terms = Generator(_counted(tape, field), orbit_dimension), 0 if limits is None else ERROR_TERMS
    local = step.at(action, psi, m, t[..., None], error_terms=error_terms)
    tried = None
    if limits is not None:
        # `moves`, and a gap that is None or inf, stay as they are; the others are constants of the run
        fixed = {"moves", "gap"} if limits.gap is None or is_unbounded(limits.gap) else {"moves"}
        given: Any = {k: Traced(tape, tape.run_constant(k, x)) for k, x in limits._asdict().items() if k not in fixed}
        limits = limits._replace(**given)
        tried = tried_size(limits, action, psi, local, step.order, m, t, h, field)
        h = limits.direction * tried.size
    own_clock, first, reached = bool(local.clock) and not nominal, None, None
    passed = _number(tape, local.time(h) if own_clock else None if limits is None else h)
    if stops:
        before = tape.calls
        first = None if limits is None else first_size(limits, local, psi, m, t)
        tape.calls = before
        stop, directed = Traced(tape, tape.input(n + 2)), Traced(tape, tape.run_constant("direction", 1.0))
        bounds = directed, Traced(tape, tape.run_constant("rest", 8 * EPS * max(abs(ends[0]), abs(ends[1]))))
        h, reached, solvable = size_to_stop(local if own_clock else None, h, stop - t, bounds)
        tape.required.append(_number(tape, solvable))
    size = h[..., None]
    moved: Any = _moved(tape, local, size, tried and tried.seen)
    runs = None
    clock: tuple[tuple[int, Expr], ...] = ()
    if own_clock:
        clock = tuple((k, _number(tape, c)) for k, c in local.clock)  # coefficients of h^k in τ(h), k > 1
        change = sum(k * abs(c) * abs(h) ** (k - 1) for k, c in sorted(local.clock, key=lambda term: term[0]))
        runs = _number(tape, change < MAX_CLOCK_DEVIATION)
        if limits is not None:  # adaptive steps are larger than fixed ones: the sharper test of a run
            runs = _number(tape, clock_at(local, h)[0])
    sizes = None
    if limits is not None:
        sizes = Sizes(*[_number(tape, x) for x in (h, *judgement(limits, local, m, size))])
    worst, summed = _statistics(tape, local, t, size, ends)
    if tried is not None and limits is not None and limits.gap is not None and local.estimate_order is None:
        summed |= {"looks": _number(tape, tried.looks), "cuts": _number(tape, tried.cuts)}
    valid: Any = local.valid(size)
    # the estimate of a step that is not solved rejects it; a stop within it is left to numpy
    tape.required.append(_number(tape, valid if reached is None or not local.collocates else valid | ~reached))
    solved = all_of(tape, tape.required)
    certain = tape.true if tried is None else _number(tape, tried.good)
    runs = all_of(tape, [x for x in (runs, solved, certain) if x is not None])
    point = [_number(tape, moved[i]) for i in range(n)]
    calls = int(tape.calls.value) if tape.calls.constant else None
    if calls is None:
        summed["calls"] = tape.calls
    return StepGraph(
        point, passed, runs, worst, summed, tuple(tape.constant_functions), clock, solved, sizes, calls,
        reached=_number(tape, reached), tried=_number(tape, h if stops else None), first=_number(tape, first),
    )  # fmt: skip


def _moved(tape: Tape, local: LocalStep, size: Values, seen: Seen | None) -> Values:
    """The point after a step of size (1,); it is known if psi was looked at there, but for lanes that end elsewhere."""
    if seen is None or not local.looks_ahead:
        return local.point(size)

    def again(elsewhere: Values, size: Values, point: Values) -> tuple[list[Values], Values]:
        return [elsewhere, size, np.where(elsewhere, local.point(size), point)], np.zeros((), bool)

    return while_loop(again, [(size != seen.size)[..., 0], size, seen.point], tape, 1, guarded=True)[2]


def with_traced_frame(tape: Tape, action: Action, step: Step, points: Array, orbit_dimension: int) -> Action:
    """The action with what a step can use of the orbits of points, with constants of the trajectories on a tape."""
    tight = action.tight_frame
    if tight is None and step.uses_isotropy:
        tight = tight_frame(action, points, orbit_dimension)
    if tight is not None and action.inner_product.invariant:
        form = tight.trace
        over = tape.trajectory_constant(lambda points: orbit_dimension / ((points @ form) * points).sum(axis=-1))
        tight = tight._replace(over=Traced(tape, over))
    return action.with_tight_frame(tight)


def all_of(tape: Tape, conditions: Sequence[Expr]) -> Expr | None:
    """Whether all conditions hold; None if they are constants that do."""
    unsure = [x for x in conditions if x is not tape.true]
    return reduce(tape.both, unsure) if unsure else None


def _counted(tape: Tape, field: GeneratorField) -> GeneratorField:
    """The field, with its calls counted on the tape."""

    def psi(m: Values, t: Real = 0.0) -> Values:
        tape.calls = tape.calls + tape.one
        return field.psi(m, t)

    return GeneratorField(field.representation, psi, time_dependent=field.time_dependent)


def _number(tape: Tape, x: object) -> Operand:
    """A number, or a tracer of shape (), as an expression on the tape; None stays None."""
    return None if x is None else Traced(tape, x).entry


def _statistics(
    tape: Tape, local: LocalStep, t: Values, size: Values, ends: tuple[float, float]
) -> tuple[dict[str, Expr], dict[str, Expr]]:
    """`StepGraph.largest` and `StepGraph.summed`, from the diagnostics of the step."""
    largest, summed = dict[str, Any](), dict[str, Any]()
    for name, (value, kind) in local.diagnostics(size).items():
        if name == LOST:
            names = zip(("direction", "latest"), bounds_of(ends), strict=True)
            direction, limit = [Traced(tape, tape.run_constant(*x)) for x in names]
            largest["unkept"] = np.where(value, earliness(t, (direction, limit)), 0.0)
        elif kind == "sum":
            summed[name] = value
        else:
            largest[name if kind == "max" else f"-{name}"] = value if kind == "max" else -value
    # booleans count as 0 or 1
    first, second = ({k: tape.number(_number(tape, x)) for k, x in some.items()} for some in (largest, summed))
    return first, second
