"""RunState, the part of a run that changes from step to step.

Checkpoints save it, and after an interruption it is rolled back to the last whole step.
Steps replace the arrays of the state and never write into them, so a snapshot needs no copies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.integrators.run.records import EventLog, Path, Samples
from liehom.integrators.run.statistics import StepStatistics
from liehom.typing import Array, BooleanArray, IntegerArray

ARRAYS = ("t", "m", "active", "code", "ended_at", "h", "taken")
"""Attributes with one entry for each trajectory; also their names in a checkpoint."""


class Snapshot(NamedTuple):
    """A state between two steps: its arrays, and how much of the records belongs to it."""

    arrays: dict[str, Any]
    path_length: int
    statistics: dict[str, npt.NDArray[Any]]
    occurrences: IntegerArray
    event_rows: int
    samples_done: IntegerArray | None


@final
@dataclass(slots=True)
class RunState:
    """State of a run between two steps.

    Attributes
    ----------
    t, m : arrays of shape (...,) and (..., N)
        Times and points; those of the start for trajectories that have ended.
    active : bool array of shape (...,)
        Which trajectories go on.
    code : int array of shape (...,)
        How trajectories have ended: a code of `liehom.integrators.run.options`.
    ended_at : array of shape (...,)
        When they have ended.
    h : array of shape (...,)
        Step sizes proposed for the next step, positive; inf if there is no proposal yet.
    taken : int array of shape (...,)
        Numbers of steps.
    calls : int
        Number of calls of psi.
    event_values : list of arrays of shape (...,)
        The event functions at (t, m).
    path, statistics, event_log, samples
        What was recorded so far; `samples` is None without t_eval.

    Examples
    --------
    >>> import liehom as lh
    >>> t, m, zero = np.zeros(()), np.zeros(3), np.zeros((), dtype=int)
    >>> state = RunState(
    ...     t, m, zero == 0, zero, t, t + np.inf, zero, 0, [], Path(t, m), StepStatistics(lh.Euler(), ()),
    ...     EventLog(0, (), 3), None,
    ... )
    >>> before = state.snapshot()
    >>> state.t, state.taken = np.array(0.5), np.array(1)
    >>> state.path.add(state.t, m, state.t, np.array(True))
    >>> state.rollback(before)
    >>> float(state.t), int(state.taken), len(state.path)
    (0.0, 0, 1)
    """

    t: Array
    m: Array
    active: BooleanArray
    code: IntegerArray
    ended_at: Array
    h: Array
    taken: IntegerArray
    calls: int
    event_values: list[Array]
    path: Path
    statistics: StepStatistics
    event_log: EventLog
    samples: Samples | None

    # -- interruptions -----------------------------------------------------------------------------------
    def snapshot(self) -> Snapshot:
        """The state as it is now, for `rollback`; nothing is copied."""
        kept = {name: getattr(self, name) for name in (*ARRAYS, "calls", "event_values")}
        done = None if self.samples is None else self.samples.done
        log = self.event_log
        return Snapshot(kept, len(self.path), self.statistics.arrays(), log.occurrences, len(log.rows), done)

    def rollback(self, snapshot: Snapshot) -> None:
        """Undo what an interrupted step has done since the snapshot."""
        for name, value in snapshot.arrays.items():
            setattr(self, name, value)
        self.path.cut(snapshot.path_length)
        self.event_log.occurrences = snapshot.occurrences
        del self.event_log.rows[snapshot.event_rows :]
        self.statistics.restore(snapshot.statistics)
        if self.samples is not None and snapshot.samples_done is not None:
            self.samples.done = snapshot.samples_done

    # -- checkpoints -------------------------------------------------------------------------------------
    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """All that `restore` needs, as named arrays: the content of a checkpoint."""
        made = {name: np.asarray(getattr(self, name)) for name in (*ARRAYS, "calls")}
        made |= {f"before_{i}": g for i, g in enumerate(self.event_values)}
        for part, record in self._records().items():
            made |= {f"{part}_{name}": value for name, value in record.arrays().items()}
        return made

    def restore(self, made: dict[str, npt.NDArray[Any]]) -> None:
        """Replace the state by the content of a checkpoint, bit for bit."""
        for name in ARRAYS:
            setattr(self, name, made[name])
        self.calls = int(made["calls"])
        self.event_values = [made[f"before_{i}"] for i in range(len(self.event_values))]
        for part, record in self._records().items():
            start = f"{part}_"
            record.restore({name[len(start) :]: x for name, x in made.items() if name.startswith(start)})

    def _records(self) -> dict[str, Path | StepStatistics | EventLog | Samples]:
        """The records by the names that they have in checkpoints since version 0.1.0."""
        found: dict[str, Path | StepStatistics | EventLog | Samples]
        found = {"path": self.path, "account": self.statistics, "found": self.event_log}
        return found if self.samples is None else {**found, "samples": self.samples}
