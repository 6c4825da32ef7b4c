"""Options of a run, and the codes and messages of the ways in which a trajectory can end."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, TypedDict, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.step import ExponentialLike, Step
from liehom.integrators.run.events import EventFunction
from liehom.typing import Array, IntegerArray

Span: TypeAlias = tuple[np.floating[Any], np.floating[Any]]
"""Start and end of the time span, in the floating type of the points."""


END, EVENT, NOT_FINITE, PSI, CLOCK, TOO_SMALL, IMPLICIT, LINEAR, TOO_MANY = 0, 1, -1, -2, -3, -4, -5, -6, -7
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
}


class RunOptions(TypedDict, total=False):
    """Keyword arguments of `integrate` that ensembles and lattices of spins hand on to it."""

    rtol: float
    atol: float
    t_eval: npt.ArrayLike | None
    events: EventFunction | Sequence[EventFunction] | None
    exponential: ExponentialLike
    clock: str
    max_step: float
    first_step: float | None
    max_steps: int
    compile: str | None


class EnsembleOptions(RunOptions, total=False):
    """Keyword arguments of `integrate` that `integrate_ensemble` hands on to it."""

    step: Step | None
    dt: npt.ArrayLike | None


class SingleRunOptions(RunOptions, total=False):
    """All keyword arguments of `integrate` but `step` and `dt`."""

    dense_output: bool
    progress: bool | Callable[[float], object]
    checkpoint: str | os.PathLike[str] | None
    checkpoint_every: float


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
            f"{'nominal' if self.nominal else 'corrected'} {self.max_step} {self.first_step}"
        )


def ending_message(status: int, codes: IntegerArray, ended_at: Array) -> str:
    """Message of a solution: how its trajectories ended, and where the first failure is.

    Parameters
    ----------
    status : int
        The status of the whole run; negative if a trajectory failed.
    codes, ended_at : (...) arrays
        Status of each trajectory, and the time at which it ended.
    """
    if status >= 0:
        return MESSAGES[status]
    failed = np.argwhere(codes < 0)
    index = tuple(int(i) for i in failed[0])
    message = f"{MESSAGES[int(codes[index])]} At t = {float(ended_at[index]):.10g}"
    if codes.ndim:
        shown = index[0] if len(index) == 1 else index
        message += f", trajectory {shown}; {len(failed)} of {codes.size} failed"
    return message + "."
