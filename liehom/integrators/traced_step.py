"""A step of the library as a graph of scalar operations: the step's own code, run on numbers that are not known.

Imports clock, correctors, homogeneous, tracing, errors.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liehom.correctors.conserving import Conserving
from liehom.correctors.corrected import CorrectedStep
from liehom.correctors.range_solver import EvenRangeSolver
from liehom.correctors.step import Generator, Step, apply_factors
from liehom.errors import LiehomError, TraceError
from liehom.homogeneous import Action, GeneratorField
from liehom.homogeneous.lazy_frame import evenness
from liehom.integrators.clock import has_clock
from liehom.tracing import Expr, StepGraph, Tape, Traced

CALM = 0.8
"""A clock certainly runs if tau' is that close to 1 over the whole step."""


def traced_step(
    action: Action, field: GeneratorField, step: Step, points: Any, orbit_dimension: int, *, nominal: bool
) -> StepGraph:
    """The graph of a step on orbits of one dimension.

    Parameters
    ----------
    action, field, step
    points : array of shape (L, N)
        On the orbits of the run: what is special about them may be used.
    orbit_dimension : int
    nominal : bool
        Whether time advances by the step size rather than by the step's own clock.

    Raises
    ------
    TraceError
        If the step or psi does something with values that compiled code cannot.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), ["m0"])
    >>> graph = traced_step(lh.Action(field.representation), field, lh.Euler(), np.eye(2), 1, nominal=True)
    >>> len(graph.point), graph.passed
    (2, None)
    """
    if isinstance(step, Conserving):
        raise TraceError(
            f"{step!r} solves equations by iterations whose length depends on values, which is not compiled: "
            "integrate without compile="
        )
    try:
        return _traced(action, field, step, points, orbit_dimension, nominal)
    except TraceError as error:
        raise TraceError(f"{step!r} cannot be compiled for this field: {error}") from error
    except (LiehomError, TypeError, AttributeError, ValueError, IndexError) as error:
        raise TraceError(
            f"{step!r} cannot be compiled for this field, because its code does not run on traced numbers "
            f"({type(error).__name__}: {error}): write psi with numpy functions, or integrate without compile="
        ) from error


def _traced(
    action: Action, field: GeneratorField, step: Step, points: Any, orbit_dimension: int, nominal: bool
) -> StepGraph:
    tape, n = Tape(), field.representation.size
    even = evenness(action, points, orbit_dimension)
    forms: tuple[tuple[int, Any], ...] = ()
    if even is not None and action.inner_product.invariant:
        forms = ((orbit_dimension, even.trace),)
        even = even._replace(over=Traced(tape, tape.input(n + 2)))
    action = action.on_even_orbits(even)
    m, t, h = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n)), Traced(tape, tape.input(n + 1))
    local = step.at(action, Generator(field, orbit_dimension), m, t[..., None])
    made = apply_factors(action, local.factors(h[..., None]), m)
    passed, runs = None, None
    clock: tuple[tuple[int, Expr], ...] = ()
    if has_clock(local) and not nominal:
        passed = _number(tape, local.time(h))
        runs, clock = _runs(tape, local, h), _coefficients(tape, local)
    worst, summed = _account(tape, local, step) if isinstance(local, CorrectedStep) else ((), ())
    return StepGraph([_number(tape, made[i]) for i in range(n)], passed, runs, worst, summed, forms, clock)


def _number(tape: Tape, x: Any) -> Expr:
    made: Expr = Traced(tape, x).entries[()]
    return made


def _coefficients(tape: Tape, local: Any) -> tuple[tuple[int, Expr], ...]:
    return tuple((k, _number(tape, c)) for k, c in enumerate(local.correction.clock) if k > 1 and c is not None)


def _runs(tape: Tape, local: Any, h: Any) -> Expr | None:
    """Whether |tau' - 1| is small over the step, by the sizes of the coefficients."""
    if not isinstance(local, CorrectedStep):
        raise TraceError("a clock that is not that of a corrected step is not compiled")
    size, power, total = abs(h), None, None
    for k, c in enumerate(local.correction.clock):
        if k < 2:
            continue
        power = size if power is None else power * size
        if c is not None:
            term = k * abs(c) * power
            total = term if total is None else total + term
    return None if total is None else _number(tape, total < CALM)


def _account(tape: Tape, local: CorrectedStep, step: Step) -> tuple[tuple[Expr, ...], tuple[Expr, ...]]:
    """(residual, orders missed) and (steps that missed the order, steps at equilibria)."""
    found = local.correction
    if all(isinstance(part.solver, EvenRangeSolver) for part in found.parts):
        rest = _number(tape, np.where(Traced(tape, found.leading) == 0, 1.0, 0.0))
        return (), (tape.zero, rest)
    missed = step.order - np.where(Traced(tape, found.leading) == 0, step.order, Traced(tape, found.reached))
    worst = _number(tape, found.residual), _number(tape, missed)
    summed = np.where(missed > 0, 1.0, 0.0), np.where(Traced(tape, found.leading) == 0, 1.0, 0.0)
    return worst, (_number(tape, summed[0]), _number(tape, summed[1]))
