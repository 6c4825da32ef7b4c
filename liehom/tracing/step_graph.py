"""StepGraph, a traced step: what the compiled loops over steps read and what they return to the run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy.typing as npt

from liehom.tracing.expr import Expr
from liehom.tracing.graph import TrajectoryConstant


@final
@dataclass(frozen=True, slots=True)
class Sizes:
    """Outputs of an adaptive traced step; input N + 1 of its graph is then the proposed size, without sign.

    Attributes
    ----------
    tried : Expr
        Size of the step that was tried, signed.
    accepted : Expr
        Boolean: whether the step is taken.
    proposal : Expr
        Size proposed for the next step, whether this one is taken or not.
    """

    tried: Expr
    accepted: Expr
    proposal: Expr


@final
@dataclass(frozen=True, slots=True)
class StepGraph:
    """Graph of a traced step: inputs 0..N-1 are the point, N the time, N + 1 the step size, -1, -2, ... constants.

    Attributes
    ----------
    point : list of Expr
        Coordinates of the point after the step.
    elapsed : Expr or None
        Time that passes in the step; None if it is the step size.
    ordinary : Expr or None
        Boolean: whether the step is certainly an ordinary one, that is, its clock is increasing at an admissible rate
        and its equations were solved. None if it always is.
    largest, summed : dict of str to Expr
        Numbers by name; the run records their largest value, which is -inf before the first step, or their sum, over
        the steps taken. The name "-x" stands for the negative of a number x of which the smallest value is recorded.
    constant_functions : tuple of callable
        Inputs -1, -2, ...: numbers that are constant along a trajectory, as functions of the initial points (L, N).
    clock : tuple of (int, Expr)
        (k, c_k): the time h + c_2 h^2 + ... passes in a step of size h.
    solved : Expr or None
        Boolean: whether all equations of the step were solved (`ordinary` implies it); None if there are none.
    sizes : Sizes or None
        None if the step size is fixed.
    calls : int or None
        Calls of psi in a step. None if their number depends on values; `summed["calls"]` then counts them.
    reached : Expr or None
        Boolean: whether input N + 2, the time of the next stop, is within the step; the point is then that at the stop,
        and `elapsed` the time that passes in the whole step. None if the graph knows of no stops.
    tried : Expr or None
        The signed size of the step, to the stop if it is reached.
    first : Expr or None
        Size of the first step, without sign, where none is proposed; a function of point and time.
    guard : Expr or None
        Boolean: whether a run may begin at the initial point, a function of it; None if it may.
    """

    point: list[Expr]
    elapsed: Expr | None
    ordinary: Expr | None
    largest: dict[str, Expr]
    summed: dict[str, Expr]
    constant_functions: tuple[TrajectoryConstant, ...] = ()
    clock: tuple[tuple[int, Expr], ...] = ()
    solved: Expr | None = None
    sizes: Sizes | None = None
    calls: int | None = 0
    reached: Expr | None = None
    tried: Expr | None = None
    first: Expr | None = None
    guard: Expr | None = None

    @property
    def size(self) -> int:
        """N, the number of coordinates."""
        return len(self.point)

    def constants(self, points: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
        """Values of inputs -1, -2, ...: a list of arrays (L,), for initial points (L, N)."""
        return [number(points) for number in self.constant_functions]

    @property
    def outputs(self) -> list[Expr]:
        """All outputs: point, time, booleans, step sizes, recorded numbers, and last those of stops."""
        extra = [x for x in (self.elapsed, self.ordinary) if x is not None]
        sizes = self.sizes
        adapted = [] if sizes is None else [sizes.tried, sizes.accepted, sizes.proposal]
        stops = [x for x in (self.tried, self.reached) if x is not None]
        return [*self.point, *extra, *adapted, *self.largest.values(), *self.summed.values(), *stops]
