"""Loops in a traced step, and the step as the engines read it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Expr, Tape, TrajectoryConstant, needed

# Loops in a traced step: each lane iterates until its own numbers no longer change.
#
# Operations that do not depend on the changing numbers are moved before the loop.


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Loop:
    """A loop that replaces variables by new values, at least once and until no lane wants another iteration."""

    variables: tuple[Expr, ...]
    new: tuple[Expr, ...]
    again: Expr  # boolean: whether a lane wants another iteration
    inside: tuple[Expr, ...]  # operations of one iteration, in the order of the tape
    limit: int  # the most iterations
    guarded: bool = False  # no iteration if the first variable, a boolean, is false in all lanes

    def __repr__(self) -> str:
        # equal loops must print equally, and no others: the repr is part of the compile-cache key
        rows = [(x.op, *[_printed(a) for a in x.args], x.value) for x in self.inside]
        ends = [_printed(x) for x in (*self.variables, *self.new, self.again)]
        return f"Loop({ends}, {rows}, {self.limit}{', guarded' if self.guarded else ''})"


def _printed(x: Expr) -> int | tuple[str, Any]:
    """The index of an expression; the value of a constant, which has no other place in the repr."""
    return ("=", x.value) if x.constant else x.index


def while_loop(
    function: Callable[..., tuple[Sequence[Any], Any]], start: Sequence[Any], tape: Tape, limit: int, *,
    guarded: bool = False,
) -> list[Traced]:  # fmt: skip
    """Traced arrays after a loop; `function` takes them to (their new values, whether to iterate again).

    A lane that has converged iterates along with the others; `function` must keep its numbers, by `np.where`.

    Examples
    --------
    >>> tape = Tape()
    >>> x, = while_loop(lambda x: ([x / 2], np.any(x > 1)), [Traced.inputs(tape, 0, 2)], tape, 10)
    >>> x
    <traced array of shape (2,)>
    """
    arrays = [Traced(tape, x) for x in start]
    before = [e for x in arrays for e in x.entries.flat]
    first, calls, count = len(tape.recorded), tape.calls, len(before)
    cuts = np.cumsum([x.size for x in arrays])[:-1]

    def shaped(entries: Sequence[Expr]) -> list[Traced]:
        flat = np.empty(count, dtype=object)
        flat[:] = entries
        return [Traced(tape, e.reshape(x.shape)) for e, x in zip(np.split(flat, cuts), arrays, strict=True)]

    tape.calls = tape.zero
    variables = [tape.variable((first, i), boolean=x.boolean) for i, x in enumerate(before)]
    values, wish = function(*shaped(variables))
    new, again = [e for x in values for e in Traced(tape, x).entries.flat], Traced(tape, wish).entry
    if tape.calls is not tape.zero:  # count the calls of psi in each lane's own iterations
        before += [tape.zero, tape.true]
        total, wanted = (tape.variable((first, count + i), boolean=i == 1) for i in (0, 1))
        new += [total + tape.select(wanted, tape.calls, tape.zero), tape.both(wanted, again)]
        variables += [total, wanted]
    changing, inside = {x.index for x in variables}, []
    for x in needed([*new, again]):
        if x.index not in changing and any(a.index in changing for a in x.args):
            changing.add(x.index)
            inside.append(x)
    read = [*new, again, *[a for x in inside for a in x.args]]
    fixed = {x.index: x for x in read if x.index not in changing and not x.constant}
    loop = Loop(tuple(variables), tuple(new), again, tuple(inside), limit, guarded)
    after = tape.block("loop", [*before, *fixed.values()], len(before), loop)
    tape.calls = calls + after[count] if len(after) > count else calls
    return shaped(after[:count])


@final
@dataclass(frozen=True, slots=True)
class Sizes:
    """Outputs of an adaptive traced step; input N + 1 of its graph is then the proposed size, without sign."""

    tried: Expr  # size of the step that was tried, signed
    accepted: Expr  # boolean: whether the step is taken
    proposal: Expr  # size proposed for the next step, whether this one is taken or not


@final
@dataclass(frozen=True, slots=True)
class StepGraph:
    """Graph of a traced step: inputs 0..N-1 are the point, N the time, N + 1 the step size, -1, -2, ... constants.

    Input N + 2 is the time of the next stop, if the graph knows of stops; else `reached` and `tried` are None. The run
    records the largest value of the numbers in `largest`, which is -inf before the first step, and the sum of those in
    `summed`, over the steps taken. The name "-x" stands for the negative of a number x of which the smallest value is
    recorded. Booleans that always hold are None.
    """

    point: list[Expr]  # coordinates of the point after the step, or at the stop
    elapsed: Expr | None  # time that passes in the whole step; None if it is the step size
    ordinary: Expr | None  # boolean, whether the clock is certainly admissible and all equations were solved
    largest: dict[str, Expr]
    summed: dict[str, Expr]
    constant_functions: tuple[TrajectoryConstant, ...] = ()  # inputs -1, -2, ... as functions of initial points (L, N)
    clock: tuple[tuple[int, Expr], ...] = ()  # (k, c_k): the time h + c_2 h^2 + ... passes in a step of size h
    solved: Expr | None = None  # boolean, whether all equations were solved
    sizes: Sizes | None = None  # of steps of adaptive sizes
    calls: int | None = (
        0  # of psi in a step, or None if their number depends on values and `summed["calls"]` counts them
    )
    reached: Expr | None = None  # boolean, whether the stop is within the step
    tried: Expr | None = None  # signed size of the step, to the stop if it is reached
    first: Expr | None = None  # size of the first step, without sign, if none is proposed: a function of point and time
    guard: Expr | None = None  # boolean, whether a run may begin at the initial point

    @property
    def size(self) -> int:
        """N, the number of coordinates."""
        return len(self.point)

    def constants(self, points: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
        """Values of inputs -1, -2, ...: a list of arrays (L,), for initial points (L, N)."""
        return [number(points) for number in self.constant_functions]

    @property
    def recorded(self) -> dict[str, tuple[str, str]]:
        """(name, "max" or "sum") of the recorded numbers, by their names in the state of a lane."""
        rows = [*[(name, "max") for name in self.largest], *[(name, "sum") for name in self.summed]]
        return {f"e{i}": row for i, row in enumerate(rows)}

    @property
    def outputs(self) -> list[Expr]:
        """All outputs: point, time, booleans, step sizes, recorded numbers, and last those of stops."""
        sizes = self.sizes
        adapted = () if sizes is None else (sizes.tried, sizes.accepted, sizes.proposal)
        recorded = (*self.largest.values(), *self.summed.values())
        outputs = (*self.point, self.elapsed, self.ordinary, *adapted, *recorded, self.tried, self.reached)
        return [x for x in outputs if x is not None]
