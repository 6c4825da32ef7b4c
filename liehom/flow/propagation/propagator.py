"""Propagator: a generator field with its method and its engine, called for many starts."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, Unpack, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, SeriesError, displayed
from liehom.base.pytrees import PerTrajectory, check_numbers, leaves
from liehom.base.typing import Array, IntegerArray, Pytree, Values
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.action.space import Action
from liehom.flow.door import Representation
from liehom.flow.engines.arguments import (
    CLOCKS,
    CallOptions,
    check_generator,
    check_option_names,
    checked_options,
    has_jax,
    jax_span,
    jax_start,
    jax_times,
    least_atol,
    positive,
    shapes_named,
    step_sizes,
    times_of,
    traces_times,
    with_tight_frame,
    without_jax,
)
from liehom.flow.engines.auto_engine import AutoEngine
from liehom.flow.engines.engine import Engine, NumpyEngine, Problem
from liehom.flow.engines.jax_engine import JaxEngine
from liehom.flow.engines.llvm_engine import LlvmEngine
from liehom.flow.engines.sensitivity import Sensitivity
from liehom.flow.methods.low_order import LieTaylor
from liehom.flow.methods.stability import warn_of_stiffness
from liehom.flow.methods.taylor import Taylor
from liehom.flow.run.options import ATOL, RTOL, Span, points_of, span_of
from liehom.flow.run.solution import Solution, warn_of_failure
from liehom.flow.series.arrays import is_jax
from liehom.flow.steps.conserving import ConservingStep
from liehom.flow.steps.corrected import CorrectedStep, check_adaptive
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.step import ExponentialLike, Generator, Step, StepLike, as_step

# Engines by name.

ENGINES: dict[str, Callable[[], Engine]] = {
    "auto": AutoEngine,
    "numpy": NumpyEngine,
    "llvm": LlvmEngine,
    "jax": JaxEngine,
}


def engine_of(engine: str | Engine) -> Engine:
    """A new engine by its name, or the engine itself."""
    if isinstance(engine, str) and engine in ENGINES:
        return ENGINES[engine]()
    if callable(getattr(engine, "solve", None)) and isinstance(getattr(engine, "name", None), str):
        return engine  # type: ignore[return-value]
    raise InputError(f"engine is {displayed(engine)}, expected one of {', '.join(map(repr, ENGINES))}")


# Inspection: what a step can do at given points, without a step being made.


@final
@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """Orders, ranks and singular values of a step at points, by `Propagator.inspect`.

    Attributes
    ----------
    step : str
        The method, as printed.
    wanted_order : int
        The order of the step.
    order : int array of shape (...,)
        The order to which the step captures the orbit of each point.
    residual : array of shape (...,)
        The largest relative residual of the linear systems of Theorem 5; 0 for steps without correction.
    singular_value : array of shape (...,)
        The smallest singular value that decides the range condition (6.2); inf for steps without correction and at
        equilibria.
    rank, orbit_dimension : int arrays of shape (...,)
        The rank met in the range condition, 0 where it does not matter, and the dimension of the orbit, which it should
        be.
    """

    step: str
    wanted_order: int
    order: IntegerArray
    residual: Array
    singular_value: Array
    rank: IntegerArray
    orbit_dimension: IntegerArray

    def __str__(self) -> str:
        lines = [f"{self.step} at {self.order.size} point{'' if self.order.size == 1 else 's'}"]
        short = int(np.sum(self.order < self.wanted_order))
        least = int(self.order.min(initial=self.wanted_order))
        lines.append(f"order {least}" + (f": {self.wanted_order} is not reached at {short}" if short else ""))
        if np.isfinite(self.singular_value).any():
            least_at = np.unravel_index(int(np.argmin(self.singular_value)), self.singular_value.shape)
            place = tuple(map(int, least_at))
            text = f"smallest singular value {self.singular_value[place]:.3g}, rank {self.rank[place]} of "
            lines.append(f"{text}{self.orbit_dimension[place]}" + (f", at point {place}" if place else ""))
        return "\n".join(lines)


def inspected(problem: Problem) -> Inspection:
    """The `Inspection` of the step of a problem at its initial points and time."""
    points: Any = np.asarray(problem.start)
    lead = points.shape[:-1]
    dimension = np.broadcast_to(np.asarray(problem.orbit_dimension), lead)
    times = np.full(lead, problem.span[0])
    order = np.full(lead, problem.step.order)
    residual, singular, rank = np.zeros(lead), np.full(lead, np.inf), np.zeros(lead, dtype=int)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        psi = Generator(problem.bound, problem.orbit_dimension, points)
        local = problem.step.at(problem.action, psi, points, times[..., None])
        inner = local.base if isinstance(local, ConservingStep) else local
        if isinstance(inner, CorrectedStep):
            correction: Any = inner.correction
            # at an equilibrium every order is reached
            order = np.where(
                correction.leading == 0, problem.step.order, np.minimum(correction.reached, problem.step.order)
            )
            residual = np.broadcast_to(correction.residual, lead)
            singular, rank = np.broadcast_to(correction.singular_value, lead), np.broadcast_to(correction.rank, lead)
    return Inspection(repr(problem.step), problem.step.order, order, residual, singular, rank, dimension)


# Propagator: a generator field with its method and its engine, made once and called for many starts and spans.

DEFAULT_ORDER = 6  # order of the default step with fixed step sizes
WARNS: ContextVar[bool] = ContextVar("WARNS", default=True)  # whether failures are reported by warnings


@final
class Propagator:
    """A field with a method and an engine: call it for a time span and initial points.

    Parameters
    ----------
    field : GeneratorField
    step : Step or str, optional
        The method, or its name (default: `Taylor` of an order that follows from the tolerances of the call,
        ``Taylor.for_tolerance(rtol + atol)``, and ``LieTaylor(6)`` for fixed step sizes; ``RKMK("dop853")`` if psi has
        no Taylor series, as it branches on values).
    args : pytree, optional
        The last argument of psi(m, t, args), where a call gives none.
    exponential, clock, engine
        As for `integrate`.

    Attributes
    ----------
    field : GeneratorField
    step : Step or None
        None for the default.
    engine : Engine
        It keeps what it has compiled from one call to the next.

    Notes
    -----
    `integrate` makes a propagator and calls it once. The engines "llvm" and "jax" trace and compile the step in the
    first call. Later calls compare the code of psi, its closure and the globals that it names, and one value of psi,
    and compile again if one of them has changed. They notice no other change. `args` hold the numbers that change from
    call to call.

    Examples
    --------
    >>> import liehom as lh
    >>> body = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    >>> propagator = lh.Propagator(body, lh.RKMK("rk4"))
    >>> for height in (0.1, 0.2):
    ...     sol = propagator((0, 5), [np.sqrt(1 - height**2), 0.0, height], dt=0.1)
    ...     print(sol.status, sol.y.shape)
    0 (3, 51)
    0 (3, 51)

    Inertia that changes from call to call:

    >>> body = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"])
    >>> propagator = lh.Propagator(body, lh.RKMK("rk4"))
    >>> for third in (3.0, 4.0):
    ...     end = propagator((0, 5), [0.6, 0.0, 0.8], dt=0.1, args={"inertia": np.array([1.0, 2.0, third])}).y[:, -1]
    ...     print(end.round(4))
    [0.3879 0.9154 0.1072]
    [0.2432 0.9501 0.1956]
    """

    def __init__(
        self,
        field: GeneratorField,
        step: StepLike | None = None,
        *,
        args: Pytree = None,
        exponential: ExponentialLike = "exp",
        clock: str = "corrected",
        engine: str | Engine = "auto",
    ) -> None:
        if not isinstance(field, GeneratorField):
            raise InputError(f"expected a GeneratorField, got {displayed(field)}: call liehom.GeneratorField(rho, psi)")
        self.field: GeneratorField = field
        self.args: Pytree = field.args if args is None else args
        self.step: Step | None = None if step is None else as_step(step)
        self.engine: Engine = engine_of(engine)
        # an engine is for one step: the default steps for several tolerances have one each
        self._new_engine: str | None = engine if isinstance(engine, str) else None
        self._engines: dict[Step, Engine] = {}
        self._choices: dict[Hashable, tuple[Step, Engine]] = {}
        self._without_series: Step | None = None  # the default step if psi turns out to have no Taylor series
        if clock not in CLOCKS:
            raise InputError(f"clock is {displayed(clock)}, expected one of {', '.join(map(repr, CLOCKS))}")
        self._nominal = clock == "nominal"
        self._action = _action(field.representation, exponential)

    def __call__(
        self, t_span: Iterable[float] | Span, y0: npt.ArrayLike, *, args: Pytree = None, **options: Unpack[CallOptions]
    ) -> Solution:
        """The trajectories from y0, a `Solution`; parameters and options are those of `integrate`."""
        engine = self.engine
        if self.step is None:
            wanted: Any = options.get("dt") is None, options.get("rtol", RTOL), options.get("atol", ATOL)
            try:
                _, engine = self._choices[wanted]
            except (KeyError, TypeError):  # an array is not hashable
                _, engine = self._choice(options.get("dt"), *wanted[1:])
        again: Callable[..., Solution | None] | None = getattr(engine, "again", None)
        args = self.args if args is None else args
        solution = None if again is None else again(t_span, y0, options, args)
        if solution is None:
            problem = self.problem(t_span, y0, args=args, **options)
            return warned(self.solve(problem), problem)
        return solution

    def solve(self, problem: Problem) -> Solution:
        """The solution of a `problem` of this propagator, by its engine; by numpy if the group fixes a point."""
        return (NumpyEngine() if has_fixed_points(problem) else self._engine_for(problem.step)).solve(problem)

    def inspect(self, y0: npt.ArrayLike, t: float = 0.0, *, args: Pytree = None) -> Inspection:
        """Orders, ranks and singular values of the step at points, an `Inspection`; no step is made.

        Parameters
        ----------
        y0 : array_like of shape (..., N)
        t : float
        args : pytree, optional

        Examples
        --------
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
        >>> print(lh.Propagator(field, lh.Corrected("euler", 3)).inspect([0.6, 0.0, 0.8]))
        Corrected(Euler(), order=3) at 1 point
        order 3
        smallest singular value 0.354, rank 2 of 2
        """
        return inspected(self.problem((t, t), y0, args=args))

    def sensitivity(
        self, t_span: Iterable[float] | Span, y0: npt.ArrayLike, *, args: Pytree = None, **options: Unpack[CallOptions]
    ) -> Sensitivity:
        """The trajectories from y0 with the derivatives of their points by y0 and args, a `Sensitivity`.

        Parameters and options are those of a call. The step must be one that can be compiled, without iterations.

        Examples
        --------
        >>> import liehom as lh
        >>> body = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"])
        >>> args = {"inertia": np.array([1.0, 2.0, 4.0])}
        >>> found = lh.Propagator(body).sensitivity((0, 5), [0.6, 0.0, 0.8], args=args, t_eval=[5])
        >>> found.solution.y.shape, found.y0.shape, found.args["inertia"].shape
        ((3, 1), (3, 3, 1), (3, 3, 1))
        """
        if is_jax(y0) or has_jax(args):
            raise InputError("sensitivity is for numpy arrays: jax.grad, jax.jvp and jax.vjp differentiate JAX arrays")
        options["dense_output"] = True
        problem = self.problem(t_span, y0, args=args, **options)
        if has_fixed_points(problem):
            raise InputError("the group fixes an initial point, so that its trajectory is constant: leave it out")
        return Sensitivity(problem, warned(self.solve(problem), problem))

    def _choice(self, dt: npt.ArrayLike | None, rtol: float, atol: npt.ArrayLike) -> tuple[Step, Engine]:
        """The step of a call with these options, and its engine."""
        if self.step is not None:
            return self.step, self.engine
        wanted = dt is None, rtol, atol
        try:
            return self._choices[wanted]
        except (KeyError, TypeError):  # an array is not hashable
            is_plain = isinstance(rtol, float) and isinstance(atol, float)
        if self._without_series is not None:
            step = self._without_series
        elif self._new_engine is None and self._engines:
            step = next(iter(self._engines))
        else:
            step = default_step(dt, rtol, least_atol(atol, self.field.representation.size))
        choice = step, self._engine_for(step)
        if is_plain:
            self._choices[wanted] = choice
        return choice

    def _engine_for(self, step: Step) -> Engine:
        """The engine for a step."""
        if self.step is not None:
            return self.engine
        if step not in self._engines:
            first = self._new_engine is None or not self._engines
            self._engines[step] = self.engine if first else engine_of(str(self._new_engine))
        return self._engines[step]

    def problem(
        self, t_span: Iterable[float] | Span, y0: npt.ArrayLike, *, args: Pytree = None, **options: Unpack[CallOptions]
    ) -> Problem:
        """The `Problem` of a call, with all arguments checked."""
        check_option_names(options)
        dt, t_eval = options.get("dt"), options.get("t_eval")
        step, _ = self._choice(dt, options.get("rtol", RTOL), options.get("atol", ATOL))
        timed = self.engine.name == "jax" and traces_times(t_span, (dt, t_eval))
        start, orbit_dimension, span, action, bound, args = self._started(t_span, y0, args, step, timed=timed)
        if self.step is None and not (timed or is_jax(start) or has_series(bound, np.asarray(start), float(span[0]))):
            step = self._without_series = as_step("dop853")
            self._choices.clear()
        if timed:
            sizes, times = jax_times(dt, t_eval, start)
        else:
            sizes = None if dt is None else step_sizes(dt, start, span)
            times = None if t_eval is None else times_of(t_eval, span)
        checked = checked_options(options, start.shape[-1], sizes, times, self._nominal)
        if checked.dt is None and (timed or span[0] != span[1]):  # else no step is made
            check_adaptive(step, action, start, orbit_dimension)
        return Problem(action, self.field, step, span, start, orbit_dimension, checked, bound, args)

    def _started(
        self, t_span: Iterable[float] | Span, y0: npt.ArrayLike, args: Pytree, step: Step, *, timed: bool
    ) -> tuple[Values, int | IntegerArray, Span, Action, GeneratorField, Pytree]:
        """Start, orbit dimensions, span, action, field with args, and args, checked; `timed` if JAX traces times."""
        args = self.args if args is None else args
        rho, action = self.field.representation, self._action
        on_jax = self.engine.name == "jax" and (is_jax(y0) or has_jax(args) or timed)
        if on_jax:
            start, orbit_dimension = jax_start(rho, y0)
        else:
            args = without_jax(args)
            start = one_each(points_of(y0), args)
            orbit_dimension = check_point(rho, start, fixed=True)
            action = with_tight_frame(action, step, start, orbit_dimension)
        check_numbers(args, start.shape[:-1])
        span = jax_span(t_span) if timed else span_of(t_span, np.dtype(np.float64) if on_jax else start.dtype)
        bound = self.field if args is None else self.field.with_args(args)
        if not on_jax:
            with shapes_named(args):
                check_generator(bound, np.asarray(start), span)
        return start, orbit_dimension, span, action, bound, args

    def __repr__(self) -> str:
        step = "default step" if self.step is None else repr(self.step)
        return f"Propagator({self.field!r}, {step}, engine={self.engine.name!r})"


_latest: tuple[Representation, str, Action] | None = None


def _action(rho: Representation, exponential: ExponentialLike) -> Action:
    """The action by an exponential; calls in a loop with one representation share it."""
    global _latest
    if not isinstance(exponential, str):
        return Action(rho, exponential)
    known = _latest
    if known is None or known[0] is not rho or known[1] != exponential:
        known = _latest = rho, exponential, Action(rho, exponential)
    return known[2]


def default_step(dt: npt.ArrayLike | None, rtol: float, atol: float) -> Step:
    """The step for given sizes, or for tolerances, where none is given."""
    if dt is not None:
        return LieTaylor(DEFAULT_ORDER)
    return Taylor.for_tolerance(positive("rtol", rtol, zero=True) + atol)


def one_each(start: Array, args: Pytree) -> Array:
    """One initial point (N,) for each trajectory that args have a slice for, (L, N); other points as they are."""
    counts = {len(x.value) for _, x in leaves(args) if isinstance(x, PerTrajectory) and x.value.ndim}
    return np.tile(start, (counts.pop(), 1)) if start.ndim == 1 and len(counts) == 1 else start


def has_series(field: GeneratorField, points: Array, t: float) -> bool:
    """Whether psi has Taylor series at points, on which the default steps call it."""
    try:
        with np.errstate(all="ignore"):
            flow_series(field, points, 1, t)
    except SeriesError:
        return False
    return True


def has_fixed_points(problem: Problem) -> bool:
    """Whether the group fixes an initial point. Such trajectories are constant, and stepped by numpy."""
    return not bool(np.all(problem.orbit_dimension))


@contextmanager
def without_order_warning() -> Iterator[None]:
    """A context without `OrderWarning`, for callers that show the message or merge reports."""
    token = WARNS.set(False)
    try:
        yield
    finally:
        WARNS.reset(token)


def warned(solution: Solution, p: Problem) -> Solution:
    """The solution, after a warning if `success` is False, and a `StiffnessWarning` if it was slow."""
    if WARNS.get():  # at the line that calls the caller
        warn_of_failure(solution, stacklevel=3)
        if p.options.dt is None and type(solution.y) is np.ndarray:
            warn_of_stiffness(p.action, p.bound, p.step, p.orbit_dimension, p.span, solution, stacklevel=3)
    return solution
