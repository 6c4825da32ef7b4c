"""Engines: what makes the steps of a checked problem, in numpy or in compiled code.

This is all that `Propagator` knows of an engine, and all that an engine needs to know of a call.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, final

import numpy as np

from liehom.base.typing import IntegerArray, Pytree, Values
from liehom.flow.action.field import GeneratorField
from liehom.flow.action.space import Action
from liehom.flow.run.options import Options, Span
from liehom.flow.run.run import Run
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import Generator, Step


@final
@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """One call of a `Propagator`, with its arguments checked.

    Attributes
    ----------
    action : Action
        With a tight frame of the orbits of these initial points, if a corrected step can use one.
    field : GeneratorField
        As it was given to the propagator: the same object in all calls.
    step : Step
    span : (float, float)
        Initial and final time, in the type of the points.
    start : array of shape (..., N)
        The initial points, of float64 or longdouble. JAX arrays are given to the engine "jax" only.
    orbit_dimension : int or array of shape (...,)
        The dimension of the orbit of each point. For points that JAX traces it is the largest dimension of an orbit.
    options : Options
    bound : GeneratorField
        The field with `args`, whose psi is a function of (m, t).
    args : pytree
        What psi gets as its last argument, with arrays in `liehom.PerTrajectory` of one slice for each point; None if
        psi takes none. Their structure may differ from call to call. With the engine "jax", leaves may be JAX arrays.
    """

    action: Action
    field: GeneratorField
    step: Step
    span: Span
    start: Values
    orbit_dimension: int | IntegerArray
    options: Options
    bound: GeneratorField
    args: Pytree = None


class Engine(Protocol):
    """An engine makes the steps of a `Propagator`; it is an object with a name and one method that takes a `Problem`.

    Every `Propagator` makes one engine and keeps it, so an engine may keep machine code and traces from one call to the
    next. Between the calls of one engine `field`, `step`, the exponential of `action` and ``options.nominal`` stay the
    same objects. Everything else may differ: start, orbit dimensions, span, sizes, tolerances, output, events, args.

    * Of `Problem` an engine relies on what is stated there, and checks nothing again. It raises `InputError` for what
      it cannot do, and `TraceError` if the step cannot be compiled.
    * A trajectory that fails has status -1 in the solution; it is not a reason for an exception.
    * Results agree with those of `NumpyEngine` to round-off.
    * Warnings are issued by `Propagator`, from ``solution.report``.

    Examples
    --------
    >>> import liehom as lh
    >>> class Counting:
    ...     name, calls = "counting", 0
    ...     def solve(self, problem):
    ...         self.calls += 1
    ...         return NumpyEngine().solve(problem)
    ...
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> propagator = lh.Propagator(field, engine=Counting())
    >>> [propagator((0, 1), y0).status for y0 in np.eye(2)], propagator.engine.calls
    ([0, 0], 2)
    """

    @property
    def name(self) -> str:
        """How users call the engine."""
        ...

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem."""
        ...


@final
class NumpyEngine:
    """The engine "numpy": every step in numpy, by `Run`."""

    name = "numpy"

    def solve(self, problem: Problem) -> Solution:
        """The solution of a problem."""
        return executed(problem)


def executed(problem: Problem, fast_path: Callable[[Run], Callable[[Run], bool]] | None = None) -> Solution:
    """The solution of a problem by `Run`, where code that `fast_path` makes for the run takes the ordinary steps."""
    p, options = problem, problem.options
    # numbers that are not finite are noticed, and end a trajectory with a message
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        run = Run(p.action, Generator(p.bound, p.orbit_dimension), p.step, p.span, np.asarray(p.start), options)
        run.fast_path = None if fast_path is None else fast_path(run)
        solution = run.execute(options.progress, options.checkpoint)
    if options.least_step > 0:
        below = f"below min_step, {options.min_step:g}"
        return replace(solution, message=solution.message.replace("below round-off", below))
    return solution
