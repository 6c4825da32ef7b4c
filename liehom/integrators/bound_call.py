"""BoundCall: a call of a propagator from the same points, for inner loops."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, final

from liehom.integrators.arguments import step_sizes, times_of
from liehom.integrators.engine import Problem
from liehom.integrators.points import span_of
from liehom.integrators.run.options import Span
from liehom.integrators.run.solution import Solution
from liehom.pytrees import check_numbers
from liehom.typing import Pytree


@final
class BoundCall:
    """A call of a propagator from its points, as a function of time span and args; `Propagator.bind` makes it.

    The first call checks everything. The next ones check times, step sizes and args only, so that they cost little more
    than the steps.

    Parameters
    ----------
    problem : callable
        (t_span, args) -> `Problem`, with all checks.
    solve : callable
        `Problem` -> `Solution`.
    options : mapping
        Options of the calls.
    again : callable, optional
        t_span -> `Solution` of an engine that knows the call already, else None.
    """

    def __init__(
        self,
        problem: Callable[[Iterable[float] | Span, Pytree], Problem],
        solve: Callable[[Problem], Solution],
        options: Mapping[str, Any],
        again: Callable[[Iterable[float] | Span], Solution | None] | None = None,
    ) -> None:
        self._problem, self._solve, self._again = problem, solve, again
        self._dt, self._times = options.get("dt"), options.get("t_eval")
        self._first: Problem | None = None

    def __call__(self, t_span: Iterable[float] | Span, args: Pytree = None) -> Solution:
        """The trajectories over a time span, with other args if they are given."""
        if self._again is not None and args is None:
            made = self._again(t_span)
            if made is not None:
                return made
        known = self._first
        if known is None or (args is not None and known.args is None):
            self._first = self._problem(t_span, args)
            return self._solve(self._first)
        start: Any = known.start
        span = span_of(t_span, start.dtype)
        options, bound = known.options, known.bound
        if self._dt is not None or self._times is not None:
            dt = None if self._dt is None else step_sizes(self._dt, start, span)
            times = None if self._times is None else times_of(self._times, span)
            options = replace(options, dt=dt, t_eval=times)
        if args is not None:
            check_numbers(args, start.shape[:-1])
            bound = known.field.with_args(args)
        else:
            args = known.args
        return self._solve(replace(known, span=span, options=options, bound=bound, args=args))
