"""Schedule of a run with steps of one size: the micro-steps of all trajectories, made once for (span, dt, t_eval).

A *micro-step* starts at the point before a step and goes to the end of the step, or to an output time within it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from liehom.integrators.run.run import Run
from liehom.typing import Array, BooleanArray, IntegerArray


@final
@dataclass(frozen=True, slots=True, eq=False)
class Schedule:
    """Micro-steps of a run with steps of one size.

    Attributes
    ----------
    sizes, times : arrays of shape (q,)
        Signed size, and time before each micro-step.
    codes : array of int64 of shape (q,)
        Twice the row in which the point is stored (-2 for none), plus 1 if the trajectory goes there.
    repeats : array of int64 of shape (q,)
        Number of the first micro-step after each that has another size or code, or is stored, or does not go on.
    first : array of int of shape (n + 1,)
        First micro-step of each of the n steps, and q.
    reached : array of shape (n + 1,)
        Times before the first step and after each step.
    rows : array of int of shape (q + 1,)
        Number of points that are stored before each micro-step.
    output : array of int
        For each stored point the index of its output time, -1 for none.
    ends : bool array
        For each stored point whether it is the end of a step.
    """

    sizes: Array
    times: Array
    codes: IntegerArray
    repeats: IntegerArray
    first: IntegerArray
    reached: Array
    rows: IntegerArray
    output: IntegerArray
    ends: BooleanArray

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.first) - 1


def schedule(
    span: tuple[float, float], dt: float, steps: int, times: Array | None, *, keeps: bool, whole: bool = True
) -> Schedule:
    """The schedule of `steps` steps of size dt, the last of them to the end of the span if it is the `whole` run.

    Parameters
    ----------
    span : (float, float)
    dt : float
        Positive.
    steps : int
    times : array, optional
        Output times in the direction of integration.
    keeps : bool
        Whether the end of every step is stored too.
    whole : bool
        False if the run is cut off after these steps.

    Examples
    --------
    >>> made = schedule((0.0, 1.0), 0.4, 3, np.array([0.5, 0.8]), keeps=False)
    >>> made.sizes.round(12).tolist(), made.codes.tolist()
    ([0.4, 0.1, 0.4, 0.2], [-1, 0, 3, -1])
    """
    begin, end = span
    direction = 1.0 if end >= begin else -1.0
    reached: Array = begin + np.arange(steps + 1, dtype=np.float64) * (direction * dt)
    reached[0] = begin
    sizes = np.full(steps, direction * dt)
    if whole:
        reached[-1], sizes[-1] = end, end - reached[-2]
    output = np.full(steps, -1)
    wanted = np.zeros(0) if times is None else times
    offset = int(len(wanted) > 0 and wanted[0] == begin)  # the start is stored by the run
    wanted = wanted[offset:]
    if not whole:
        wanted = wanted[direction * wanted <= direction * reached[-1]]
    step = np.searchsorted(direction * reached[1:], direction * wanted)
    at_end = np.flatnonzero(reached[step + 1] == wanted)
    if len(at_end):
        at_end = at_end[np.unique(step[at_end], return_index=True)[1]]
        output[step[at_end]] = at_end + offset
    within = np.setdiff1d(np.arange(len(wanted)), at_end)
    order = np.argsort(np.concatenate([2 * np.arange(steps) + 1, 2 * step[within]]), kind="stable")
    output = np.concatenate([output, within + offset])[order]
    commits = order < steps
    stored = (output >= 0) | (commits & keeps)
    rows = np.concatenate([[0], np.cumsum(stored)])
    sizes = np.concatenate([sizes, wanted[within] - reached[step[within]]])[order]
    alone = stored | ~commits
    begins = np.append(True, alone[1:] | alone[:-1] | (sizes[1:] != sizes[:-1]))
    places = np.append(np.flatnonzero(begins), len(sizes))
    return Schedule(
        sizes=sizes,
        times=np.concatenate([reached[:-1], reached[step[within]]])[order],
        codes=(2 * np.where(stored, rows[:-1], -1) + commits).astype(np.int64),
        repeats=places[np.cumsum(begins)].astype(np.int64),
        first=np.concatenate([[0], np.flatnonzero(commits) + 1]),
        reached=reached,
        rows=rows,
        output=output[stored],
        ends=commits[stored],
    )


class RunSchedule(NamedTuple):
    """The numbers from which the schedule of a run follows, hashable."""

    span: tuple[float, float]
    dt: float
    steps: int
    times: tuple[float, ...] | None
    keeps: bool
    whole: bool

    @classmethod
    def of(cls, run: Run, *, keeps: bool) -> RunSchedule:
        """That of a run with steps of one size; no more steps than `max_steps` are scheduled."""
        samples = run.state.samples
        times = None if samples is None else tuple(samples.times.tolist())
        total = float(np.max(np.asarray(run.stops.total)))
        steps, dt = int(min(total, run.options.max_steps)), float(np.max(np.asarray(run.options.dt)))
        return cls((float(run.span[0]), float(run.span[1])), dt, steps, times, keeps, steps == total)

    def schedule(self) -> Schedule:
        """The schedule itself."""
        times = None if self.times is None else np.array(self.times)
        return schedule(self.span, self.dt, self.steps, times, keeps=self.keeps, whole=self.whole)
