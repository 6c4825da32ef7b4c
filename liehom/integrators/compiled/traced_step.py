"""A step of the library as a graph of scalar operations: the code of the step, run on tracers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import LiehomError, TraceError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.frames.branch_free_frames import tight_frame
from liehom.integrators.compiled.parameters import traced_args
from liehom.integrators.compiled.traced_size import EPS, SizeLimits, first_size, judgement, size_to_stop, tried_size
from liehom.integrators.run.clock import clock_at
from liehom.integrators.run.control import ERROR_TERMS
from liehom.integrators.run.statistics import LOST, bounds_of, earliness
from liehom.tracing import Expr, Sizes, StepGraph, Tape, Traced
from liehom.typing import Array, Pytree, Real, Values

MAX_CLOCK_DEVIATION = 0.8
"""τ certainly increases at an admissible rate if |τ' - 1| is below this over the whole step."""


def traced_step(
    action: Action, field: GeneratorField, step: Step, points: Array, orbit_dimension: int, *, nominal: bool,
    ends: tuple[float, float] = (0.0, 0.0), limits: SizeLimits | None = None,
    stops: bool = False, args: Pytree = None, lead: int = 1,
) -> StepGraph:  # fmt: skip
    """The graph of a step on orbits of one dimension.

    Parameters
    ----------
    action : Action
    field : GeneratorField
    step : Step
        As `Step.prepare` returned it, if sizes are adaptive.
    points : array of shape (L, N)
        Points on the orbits of the run; special properties of these orbits may be used.
    orbit_dimension : int
    nominal : bool
        Whether time advances by the step size rather than by the time reparametrization τ of the step.
    ends : (float, float)
        Initial and final time, which show the order of times in the report.
    limits : SizeLimits, optional
        Tolerances for an adaptive step size; without them the size is an input of the graph.
    stops : bool
        Whether the graph goes no further than to a stop, whose time is an input.
    args : pytree, optional
        The args of psi; their numbers are constants by name, see `liehom.integrators.compiled.parameters`.
    lead : int
        The number of leading axes of arrays with one slice per trajectory in `args`.

    Raises
    ------
    TraceError
        If the step or psi does something with values that compiled code cannot do.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> graph = traced_step(lh.Action(field.representation), field, lh.Euler(), np.eye(2), 1, nominal=True)
    >>> len(graph.point), graph.elapsed
    (2, None)
    """
    try:
        tape = Tape()
        field = field if args is None else field.with_args(traced_args(tape, args, lead))
        return _traced(tape, action, field, step, points, orbit_dimension, nominal, ends, limits, stops)
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
    tight = action.tight_frame
    if tight is None and step.uses_isotropy:
        tight = tight_frame(action, points, orbit_dimension)
    if tight is not None and action.inner_product.invariant:
        form = tight.trace
        over = tape.trajectory_constant(lambda points: orbit_dimension / ((points @ form) * points).sum(axis=-1))
        tight = tight._replace(over=Traced(tape, over))
    action = action.with_tight_frame(tight)
    m, t = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n))
    h: Any = Traced(tape, tape.input(n + 1))
    psi, error_terms = Generator(_counted(tape, field), orbit_dimension), 0 if limits is None else ERROR_TERMS
    local = step.at(action, psi, m, t[..., None], error_terms=error_terms)
    given_limits: SizeLimits | None = None
    certain: Any = True
    if limits is not None:
        given_limits = _traced_limits(tape, limits)
        h, certain = tried_size(given_limits, action, psi, local, step, m, t, h)
    own_clock, first, reached = bool(local.clock) and not nominal, None, None
    passed = _number(tape, local.time(h) if own_clock else h) if own_clock or limits is not None else None
    if stops:
        before = tape.calls
        first = first_size(given_limits, local, psi, m, t) if given_limits is not None else None
        tape.calls = before
        stop, directed = Traced(tape, tape.input(n + 2)), Traced(tape, tape.run_constant("direction", 1.0))
        bounds = directed, Traced(tape, tape.run_constant("rest", 8 * EPS * max(abs(ends[0]), abs(ends[1]))))
        h, reached, found = size_to_stop(local if own_clock else None, h, stop - t, bounds)
        tape.required.append(_number(tape, found))
    size = h[..., None]
    made: Any = local.point(size)
    runs = None
    clock: tuple[tuple[int, Expr], ...] = ()
    if own_clock:
        clock = _clock_coefficients(tape, local.clock)
        runs = _clock_is_admissible(tape, local.clock, h)
        if limits is not None:  # adaptive steps are larger than fixed ones: the rate is sampled, as in a run
            runs = _number(tape, clock_at(local, h)[0])
    sizes = None
    if given_limits is not None:
        sizes = Sizes(_number(tape, h), *[_number(tape, x) for x in judgement(given_limits, local, m, size)])
    worst, summed = _statistics(tape, local, t, size, ends)
    tape.required.append(_number(tape, local.valid(size)))
    required = [x for x in tape.required if x is not tape.true]
    solved = reduce(tape.both, required) if required else None
    plain = [x for x in (runs, solved, _number(tape, certain)) if x is not None and x is not tape.true]
    runs = reduce(tape.both, plain) if plain else None
    point = [_number(tape, made[i]) for i in range(n)]
    calls = int(tape.calls.value) if tape.calls.constant else None
    if calls is None:
        summed["calls"] = tape.calls
    return StepGraph(
        point, passed, runs, worst, summed, tuple(tape.constant_functions), clock, solved, sizes, calls,
        reached=None if reached is None else _number(tape, reached),
        tried=None if reached is None else _number(tape, h),
        first=None if first is None else _number(tape, first),
    )  # fmt: skip


def _traced_limits(tape: Tape, limits: SizeLimits) -> SizeLimits:
    """The numbers of the limits by name, as constants of the run; `moves` as it is."""
    numbers = (Traced(tape, tape.run_constant(*x)) for x in limits._asdict().items() if x[0] != "moves")
    return SizeLimits._make((*numbers, limits.moves))


def _counted(tape: Tape, field: GeneratorField) -> GeneratorField:
    """The field, with its calls counted on the tape."""

    def psi(m: Values, t: Real = 0.0) -> Values:
        tape.calls = tape.calls + tape.one
        made: Values = field.psi(m, t)
        return made

    return GeneratorField(field.representation, psi, time_dependent=field.time_dependent)


def _number(tape: Tape, x: object) -> Expr:
    """A number, or a tracer of shape (), as an expression on the tape."""
    return Traced(tape, x).entry


def _clock_coefficients(tape: Tape, clock: Sequence[tuple[int, Any]]) -> tuple[tuple[int, Expr], ...]:
    """(k, coefficient of h^k in τ(h)) for k > 1."""
    return tuple((k, _number(tape, c)) for k, c in clock)


def _clock_is_admissible(tape: Tape, clock: Sequence[tuple[int, Any]], h: Values) -> Expr:
    """Whether |τ' - 1| is small over the step, by the sizes of the coefficients."""
    size: Any = abs(h)
    total: Any = 0.0
    for k, c in sorted(clock, key=lambda term: term[0]):
        power = size
        for _ in range(k - 2):
            power = power * size
        total = total + k * abs(c) * power
    return _number(tape, total < MAX_CLOCK_DEVIATION)


def _statistics(
    tape: Tape, local: LocalStep, t: Values, size: Values, ends: tuple[float, float]
) -> tuple[dict[str, Expr], dict[str, Expr]]:
    """`StepGraph.largest` and `StepGraph.summed`, from the diagnostics of the step."""
    largest: dict[str, Any] = {}
    summed: dict[str, Any] = {}
    for name, (value, kind) in local.diagnostics(size).items():
        if name == LOST:
            names = zip(("direction", "latest"), bounds_of(ends), strict=True)
            direction, limit = [Traced(tape, tape.run_constant(*x)) for x in names]
            largest["unkept"] = np.where(value, earliness(t, (direction, limit)), 0.0)
        elif kind == "sum":
            summed[name] = value
        else:
            largest[name if kind == "max" else f"-{name}"] = value if kind == "max" else -value
    return ({k: _amount(tape, x) for k, x in largest.items()}, {k: _amount(tape, x) for k, x in summed.items()})


def totals_of(graph: StepGraph, rows: Sequence[Array]) -> dict[str, tuple[Array, str]]:
    """Totals of compiled steps by name, with their kind, from the rows of `graph.largest` and `graph.summed`.

    The calls of psi are not among them.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["1", "m0", "0"])
    >>> action, step = lh.Action(field.representation), lh.Corrected(lh.Euler(), 2)
    >>> graph = traced_step(action, field, step, np.eye(3), 2, nominal=True)
    >>> graph.largest, totals_of(graph, [np.array([3.0])])
    ({}, {'equilibria': (array([3.]), 'sum')})
    """
    kinds = ["max"] * len(graph.largest) + ["sum"] * len(graph.summed)
    found = zip((*graph.largest, *graph.summed), rows[: len(kinds)], kinds, strict=True)
    kept = [(name, x, kind) for name, x, kind in found if name != "calls"]
    return {name.removeprefix("-"): (-x, "min") if name[0] == "-" else (x, kind) for name, x, kind in kept}


def _amount(tape: Tape, x: object) -> Expr:
    """A number, or 0 or 1 for a boolean."""
    return tape.number(_number(tape, x))
