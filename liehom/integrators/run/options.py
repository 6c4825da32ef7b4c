"""Options of a run, and the codes and messages of the ways in which a trajectory can end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from liehom.integrators.run.events import EventFunction
from liehom.typing import Array, BooleanArray, IntegerArray

Span: TypeAlias = tuple[np.floating[Any], np.floating[Any]]
"""Start and end of the time span, in the floating type of the points."""


END, EVENT, NOT_FINITE, PSI, CLOCK, TOO_SMALL, IMPLICIT, LINEAR, TOO_MANY, CONE = 0, 1, -1, -2, -3, -4, -5, -6, -7, -8
MESSAGES = {
    END: "The solver successfully reached the end of the integration interval.",
    EVENT: "A termination event occurred.",
    NOT_FINITE: "The solution is not finite after a step; take smaller steps.",
    PSI: "psi or one of its derivatives is not finite.",
    CLOCK: "The clock of the corrected step does not run at this step size; take a smaller dt.",
    TOO_SMALL: "The step size that the tolerance asks for is below round-off.",
    IMPLICIT: "The equations of an implicit step could not be solved; take a smaller step size.",
    LINEAR: "The linear algebra of a step failed.",
    TOO_MANY: "The end was not reached in max_steps steps.",
    CONE: "The clock of the corrected step does not run at this step size, because the path comes within two steps of "
    "the cone on which the range condition fails; take LieTaylor, which needs no range condition, or a smaller dt.",
}
ORDER_NOT_KEPT = -2
"""Status of a trajectory that came to its end, but did not keep the order of its corrected step."""
TRAJECTORY_MARK, LOST = ", trajectory ", " did not keep it"
"""In a message, the first string precedes the index of the first trajectory, the second one may end it."""


@final
@dataclass(frozen=True, slots=True)
class Options:
    """Checked options of a run: see `integrate`.

    Attributes
    ----------
    dt : array of shape (...,) or None
        Fixed step sizes; None for adaptive ones.
    t_eval : array of shape (k,) or None
        In the direction of integration.
    nominal : bool
        Whether time advances by the parameter of the step rather than by its time reparametrization τ.
    progress : bool or callable
    checkpoint : Path or None
        A file that can be written.
    """

    dt: Array | None
    rtol: float
    atol: float
    t_eval: Array | None
    dense_output: bool
    events: EventFunction | Sequence[EventFunction] | None
    nominal: bool
    max_step: float
    first_step: float | None
    max_steps: float
    checkpoint_every: float
    progress: bool | Callable[[float], object] = False
    checkpoint: Path | None = None
    min_step: float = 0.0

    @property
    def least_step(self) -> float:
        """`min_step` for adaptive step sizes, 0 for fixed ones."""
        return self.min_step if self.dt is None else 0.0

    @property
    def clock(self) -> str:
        """Name of the option `clock`, "nominal" or "corrected"."""
        return "nominal" if self.nominal else "corrected"

    def fixed_text(self) -> str:
        """String of the scalar options that must not change when a run is continued.

        Examples
        --------
        >>> Options(None, 1e-6, 1e-9, None, False, None, False, 1.0, None, 10, 30.0).fixed_text()
        'adaptive 1e-06 1e-09 steps False corrected 1.0 None'
        """
        return (
            f"{'adaptive' if self.dt is None else 'fixed'} {self.rtol} {self.atol} "
            f"{'steps' if self.t_eval is None else 't_eval'} {self.dense_output} "
            f"{self.clock} {self.max_step} {self.first_step}" + (f" {self.min_step}" if self.min_step else "")
        )


def overall_status(statuses: IntegerArray) -> int:
    """The status of a run from those of its trajectories: -1 if any failed, else -2 if any did not keep its order.

    Examples
    --------
    >>> [overall_status(np.array(x)) for x in ([0, 1, -2, -1], [0, -2, 1], [0, 1], [])]
    [-1, -2, 1, 0]
    """
    for status in (-1, ORDER_NOT_KEPT):
        if np.any(statuses == status):
            return status
    return int(np.max(statuses, initial=0))


class Outcome(NamedTuple):
    """How the trajectories of a run ended.

    Attributes
    ----------
    status : int
        That of the whole run.
    statuses : int array of shape (...,)
    message : str
        How the trajectories ended, and where the first failure is.
    stopped_at : float or None
        The earliest time at which a trajectory failed.
    """

    status: int
    statuses: IntegerArray
    message: str
    stopped_at: float | None


def outcome(
    codes: IntegerArray, ended_at: Array, unkept_from: Array, direction: float, order: int, reason: str
) -> Outcome:
    """The `Outcome` of a run.

    Parameters
    ----------
    codes, ended_at : (...) arrays
        How each trajectory ended, a code of this module, and when.
    unkept_from : (...) array
        The time of the first step that did not keep the order; NaN for trajectories without such a step.
    direction : float
        1, or -1 if time decreases.
    order : int
        The order of the step.
    reason : str
        Why it was not kept, a clause.

    Examples
    --------
    >>> codes, times = np.array([END, EVENT]), np.array([2.0, 1.0])
    >>> found = outcome(codes, times, np.array([np.nan, 0.5]), 1.0, 3, "the range condition fails")
    >>> found.status, found.statuses.tolist(), found.message[-74:]
    (-2, [0, -2], 'e range condition fails. At t = 0.5, trajectory 1; 1 of 2 did not keep it.')
    """
    lost = ~np.isnan(unkept_from)
    failed = codes < 0
    statuses = np.where(lost & ~failed, ORDER_NOT_KEPT, np.maximum(codes, -1))
    status = overall_status(statuses)
    stopped_at = direction * float((direction * ended_at[failed]).min()) if bool(failed.any()) else None
    if status >= 0:
        return Outcome(status, statuses, MESSAGES[status], stopped_at)
    here, times = (failed, ended_at) if status == -1 else (lost, unkept_from)
    first = tuple(int(i) for i in np.argwhere(here)[0])
    if status == -1:
        message, tail = f"{MESSAGES[int(codes[first])]} At t = {float(times[first]):.10g}", " failed"
    else:
        stopped = bool((codes == EVENT).any())
        end = "A termination event occurred" if stopped else "The solver reached the end of the integration interval"
        message, tail = f"{end}, but order {order} was not kept: {reason}. At t = {float(times[first]):.6g}", LOST
    message += among(here, tail)
    if status == -1 and bool(lost.any()):
        message += also_lost(order, reason)
    return Outcome(status, statuses, message, stopped_at)


def also_lost(order: int, reason: str) -> str:
    """Sentence that is added to the message of a run that failed and had not kept its order before.

    Examples
    --------
    >>> also_lost(4, "the range condition fails")
    ' Before, order 4 was not kept: the range condition fails.'
    """
    return f" Before, order {order} was not kept: {reason}."


def among(some: BooleanArray, tail: str) -> str:
    """The first of some trajectories and their number, as the end of a message; only a point without an ensemble.

    Examples
    --------
    >>> among(np.array([False, True, True]), " failed"), among(np.array(True), " failed")
    (', trajectory 1; 2 of 3 failed.', '.')
    """
    if not some.ndim:
        return "."
    index = tuple(int(i) for i in np.argwhere(some)[0])
    return f"{TRAJECTORY_MARK}{index[0] if len(index) == 1 else index}; {int(some.sum())} of {some.size}{tail}."
