"""A step of the library as a graph of scalar operations: the code of the step, run on tracers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np

from liehom.correctors.conserving import Conserving, ConservingStep
from liehom.correctors.isotropy.corrected import Corrected, CorrectedStep
from liehom.correctors.isotropy.range_solver import TightFrameSolver
from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import LiehomError, TraceError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.frames.branch_free_frames import tight_frame
from liehom.integrators.compiled.parameters import traced_args
from liehom.integrators.compiled.traced_size import SizeLimits, first_size, judgement, size_to_stop, tried_size
from liehom.integrators.run.clock import clock_at, has_clock
from liehom.integrators.run.conservation_statistics import CONSERVED_ROUNDOFFS
from liehom.integrators.run.control import ERROR_TERMS
from liehom.integrators.run.records import bounds_of, earliness
from liehom.tracing import Expr, Sizes, StepGraph, Tape, Traced
from liehom.typing import Array, Pytree, Real, Values

MAX_CLOCK_DEVIATION = 0.8
"""τ certainly increases at an admissible rate if |τ' - 1| is below this over the whole step."""


def traced_step(
    action: Action, field: GeneratorField, step: Step, points: Array, orbit_dimension: int, *, nominal: bool,
    ends: tuple[float, float] = (0.0, 0.0), limits: SizeLimits | None = None, kept_order: int | None = None,
    stops: bool = False, args: Pytree = None, lead: int = 1,
) -> StepGraph:  # fmt: skip
    """The graph of a step on orbits of one dimension.

    Parameters
    ----------
    action : Action
    field : GeneratorField
    step : Step
    points : array of shape (L, N)
        Points on the orbits of the run; special properties of these orbits may be used.
    orbit_dimension : int
    nominal : bool
        Whether time advances by the step size rather than by the time reparametrization τ of the step.
    ends : (float, float)
        Initial and final time, which show the order of times in the report.
    limits : SizeLimits, optional
        Tolerances for an adaptive step size; without them the size is an input of the graph.
    kept_order : int, optional
        ``Conserving.kept_order``, on which the sizes of a conserving step depend.
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
        return _traced(tape, action, field, step, points, orbit_dimension, nominal, ends, limits, kept_order, stops)
    except TraceError as error:
        raise TraceError(f"{step!r} cannot be compiled for this field: {error}") from error
    except (LiehomError, TypeError, AttributeError, ValueError, IndexError) as error:
        raise TraceError(
            f"{step!r} cannot be compiled for this field, because its code does not run on traced numbers "
            f"({type(error).__name__}: {error}): write psi with numpy functions, or take engine='numpy'"
        ) from error


def _traced(
    tape: Tape, action: Action, field: GeneratorField, step: Step, points: Array, orbit_dimension: int, nominal: bool,
    ends: tuple[float, float], limits: SizeLimits | None, kept_order: int | None, stops: bool,
) -> StepGraph:  # fmt: skip
    n = field.representation.size
    tight = action.tight_frame
    if tight is None and isinstance(step, Corrected | Conserving):  # others ask for no isotropy
        tight = tight_frame(action, points, orbit_dimension)
    if tight is not None and action.inner_product.invariant:
        form = tight.trace
        over = tape.trajectory_constant(lambda points: orbit_dimension / ((points @ form) * points).sum(axis=-1))
        tight = tight._replace(over=Traced(tape, over))
    action = action.with_tight_frame(tight)
    m, t = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n))
    h: Any = Traced(tape, tape.input(n + 1))
    psi, error_terms = Generator(_counted(tape, field), orbit_dimension), 0 if limits is None else ERROR_TERMS
    psi.prepared[step] = kept_order
    local = step.at(action, psi, m, t[..., None], error_terms=error_terms)
    given_limits: SizeLimits | None = None
    certain: Any = True
    if limits is not None:
        given_limits = SizeLimits._make(Traced(tape, tape.run_constant(*x)) for x in limits._asdict().items())
        h, certain = tried_size(given_limits, action, psi, local, step, m, t, h)
    own_clock, first, reached = has_clock(local) and not nominal, None, None
    passed = _number(tape, local.time(h) if own_clock else h) if own_clock or limits is not None else None
    if stops:
        calls = tape.calls
        first = first_size(given_limits, local, psi, m, t) if given_limits is not None else None
        tape.calls = calls
        stop, directed = Traced(tape, tape.input(n + 2)), Traced(tape, tape.run_constant("direction", 1.0))
        bounds = directed, Traced(tape, tape.run_constant("tiny", 0.0))
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
    worst, summed = _statistics(tape, local, step, t, size, ends)
    solved = reduce(tape.both, tape.required) if tape.required else None
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
    tape: Tape, local: LocalStep, step: Step, t: Values, size: Values, ends: tuple[float, float]
) -> tuple[dict[str, Expr], dict[str, Expr]]:
    """Numbers of a step for the report: those of which the largest is stored, and those that are summed up."""
    largest: dict[str, Any] = {}
    summed: dict[str, Any] = {}
    if isinstance(local, ConservingStep):
        made = local.conserved(size)
        tape.required.append(_number(tape, made.left | (made.rank >= made.wanted)))
        largest |= {"iterations": made.iterations, "defect": made.defect}
        summed |= {
            "missed": np.where(made.units > CONSERVED_ROUNDOFFS, 1.0, 0.0),
            "left": np.where(made.left, 1.0, 0.0),
            "usual": np.where(made.left, 0.0, 1.0),
        }
        local = local.base
    if isinstance(local, CorrectedStep):
        found = local.correction
        rest = Traced(tape, found.leading) == 0
        summed["equilibria"] = np.where(rest, 1.0, 0.0)
        if not all(isinstance(part.solver, TightFrameSolver) for part in found.parts):
            short = step.order - np.where(rest, step.order, Traced(tape, found.reached))
            near = found.near_cone(size[..., 0])
            failed = np.where(short > 0, 1.0, 0.0)
            direction, limit = [
                Traced(tape, tape.run_constant(*x)) for x in zip(("direction", "latest"), bounds_of(ends), strict=True)
            ]
            now = np.where((short > 0) | near, earliness(t, (direction, limit)), 0.0)
            largest |= {"residual": found.residual, "short": short, "unkept": now}
            summed |= {"failed": failed, "near": np.where(near, 1.0, 0.0)}
    return ({k: _number(tape, x) for k, x in largest.items()}, {k: _number(tape, x) for k, x in summed.items()})
