"""Loops in a traced step: each lane iterates until its own numbers no longer change.

Operations that do not depend on the changing numbers are moved before the loop.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.tracing.array import Traced
from liehom.tracing.expr import Expr
from liehom.tracing.graph import Tape, needed


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Loop:
    """A loop that replaces variables by new values, at least once and until no lane wants another iteration.

    Attributes
    ----------
    variables, new : tuple of Expr
    again : Expr
        Boolean: whether a lane wants another iteration.
    inside : tuple of Expr
        The operations of one iteration, in the order of the tape.
    limit : int
        The most iterations.
    guarded : bool
        Whether there is no iteration at all if the first variable, a boolean, is false in all lanes.
    """

    variables: tuple[Expr, ...]
    new: tuple[Expr, ...]
    again: Expr
    inside: tuple[Expr, ...]
    limit: int
    guarded: bool = False

    def __repr__(self) -> str:
        # equal loops must print equally, and no others: the repr is part of the compile-cache key
        rows = [(x.op, *[_printed(a) for a in x.args], x.value) for x in self.inside]
        ends = [_printed(x) for x in (*self.variables, *self.new, self.again)]
        return f"Loop({ends}, {rows}, {self.limit}{', guarded' if self.guarded else ''})"


def _printed(x: Expr) -> int | tuple[str, Any]:
    """The index of an expression; the value of a constant, which has no other place in the repr."""
    return ("=", x.value) if x.constant else x.index


def scalar_while_loop(
    tape: Tape,
    start: Sequence[Expr],
    body: Callable[[list[Expr]], tuple[Sequence[Expr], Expr]],
    limit: int,
    *,
    guarded: bool = False,
) -> list[Expr]:
    """Tracers of the variables after a loop.

    A lane that has converged iterates along with the others; `body` must keep its numbers, by `Tape.select`.

    Parameters
    ----------
    tape : Tape
    start : sequence of Expr
    body : callable
        The numbers to (their new values, whether to iterate again).
    limit : int
        The most iterations; there is at least one unless the loop is guarded.
    guarded : bool
        Whether there is no iteration at all if the first number, a boolean, is false in all lanes.

    Examples
    --------
    >>> from liehom.tracing.jax_code import evaluate_with_jax
    >>> tape = Tape()
    >>> a = tape.input(0)
    >>> def heron(x):
    ...     new = (x[0] + a / x[0]) * 0.5
    ...     return [new], tape.compare("lt", tape.constant(1e-12), tape.call("abs", new - x[0]))
    ...
    >>> root, = scalar_while_loop(tape, [a], heron, 50)
    >>> round(float(evaluate_with_jax([root], {0: 2.0})[0]), 5)
    1.41421
    """
    first, calls, count = len(tape.recorded), tape.calls, len(start)
    tape.calls = tape.zero
    variables = [tape.variable((first, i), boolean=x.boolean) for i, x in enumerate(start)]
    new, again = body(list(variables))
    if tape.calls is not tape.zero:  # count the calls of psi in each lane's own iterations
        start = [*start, tape.zero, tape.true]
        total, wanted = (tape.variable((first, count + i), boolean=i == 1) for i in (0, 1))
        new = [*new, total + tape.select(wanted, tape.calls, tape.zero), tape.both(wanted, again)]
        variables += [total, wanted]
    changing = {x.index for x in variables}
    inside, fixed = [], {}
    for x in needed([*new, again]):
        if x.index not in changing and any(a.index in changing for a in x.args):
            changing.add(x.index)
            inside.append(x)
    for x in [*new, again, *[a for y in inside for a in y.args]]:
        if x.index not in changing and not x.constant:
            fixed[x.index] = x
    loop = Loop(tuple(variables), tuple(new), again, tuple(inside), limit, guarded)
    found = tape.block("loop", [*start, *fixed.values()], len(start), loop)
    tape.calls = calls + found[count] if len(found) > count else calls
    return found[:count]


def while_loop(
    function: Callable[..., tuple[Sequence[Any], Any]],
    start: Sequence[Any],
    tape: Tape,
    limit: int,
    *,
    guarded: bool = False,
) -> list[Traced]:
    """Traced arrays after a loop: the array version of `scalar_while_loop`.

    Parameters
    ----------
    function : callable
        The arrays to (their new values, whether to iterate again).
    start : sequence of arrays
    tape : Tape
    limit : int
    guarded : bool
        Whether there is no iteration at all if the first array, one boolean, is false in all lanes.

    Examples
    --------
    >>> tape = Tape()
    >>> x, = while_loop(lambda x: ([x / 2], np.any(x > 1)), [Traced.inputs(tape, 0, 2)], tape, 10)
    >>> x
    <traced array of shape (2,)>
    """
    arrays = [Traced(tape, x) for x in start]
    cuts = np.cumsum([x.size for x in arrays])[:-1]

    def shaped(entries: Sequence[Expr]) -> list[Traced]:
        flat = np.empty(len(entries), dtype=object)
        flat[:] = entries
        return [Traced(tape, e.reshape(x.shape)) for e, x in zip(np.split(flat, cuts), arrays, strict=True)]

    def body(entries: list[Expr]) -> tuple[list[Expr], Expr]:
        new, again = function(*shaped(entries))
        flat = [e for x in new for e in Traced(tape, x).entries.flat]
        return flat, Traced(tape, again).entry

    return shaped(scalar_while_loop(tape, [e for x in arrays for e in x.entries.flat], body, limit, guarded=guarded))
