"""Options of a run, initial points and time spans, and progress."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np
import numpy.typing as npt

from liehom.base.budget import in_time
from liehom.base.errors import InputError, displayed
from liehom.base.objects import refuse_masked
from liehom.base.typing import Array, BooleanArray, IntegerArray
from liehom.flow.run.check import LOOKS
from liehom.flow.run.events import EventFunction

# Options of a run, and the codes and messages of the ways in which a trajectory can end.

Span: TypeAlias = tuple[np.floating[Any], np.floating[Any]]
"""Start and end of the time span, in the floating type of the points."""


RTOL, ATOL = 1e-6, 1e-9  # default tolerances
END, EVENT, NOT_FINITE, PSI, CLOCK, TOO_SMALL, IMPLICIT, LINEAR, TOO_MANY, CONE = 0, 1, -1, -2, -3, -4, -5, -6, -7, -8
MESSAGES = {
    END: "The solver successfully reached the end of the integration interval.",
    EVENT: "A termination event occurred.",
    NOT_FINITE: "The solution is not finite after a step; take smaller steps.",
    PSI: "psi or one of its derivatives is not finite.",
    CLOCK: "The clock of the corrected step does not run at this step size; take a smaller dt, or LieTaylor if the "
    "path comes to the cone on which the range condition fails.",
    TOO_SMALL: "The step size that the tolerance asks for is below round-off.",
    IMPLICIT: "The equations of an implicit step could not be solved; take a smaller step size.",
    LINEAR: "The linear algebra of a step failed.",
    TOO_MANY: "The end was not reached in max_steps steps.",
    CONE: "The clock of the corrected step does not run at this step size, because the path comes within two steps of "
    "the cone on which the range condition fails; take LieTaylor, which needs no range condition, or a smaller dt.",
}
ORDER_NOT_KEPT = -2  # status of a trajectory that came to its end, but did not keep the order of its corrected step
TRAJECTORY_MARK, LOST = ", trajectory ", " did not keep it"
"""In a message, the first string precedes the index of the first trajectory, the second one may end it."""


@final
@dataclass(frozen=True, slots=True)
class Options:
    """Checked options of a run: see `integrate`."""

    dt: Array | None  # fixed step sizes (...,); None for adaptive ones
    t_eval: Array | None  # in the direction of integration
    nominal: bool  # time advances by the parameter of the step, not by its clock τ
    rtol: float = RTOL
    atol: float = ATOL
    dense_output: bool = False
    events: EventFunction | Sequence[EventFunction] | None = None
    max_step: float = np.inf
    first_step: float | None = None
    max_steps: float = 1e7
    checkpoint_every: float = 30.0
    progress: bool | Callable[[float], object] = False
    checkpoint: Path | None = None  # a file that can be written
    min_step: float = 0.0
    looks: int | None = None

    @property
    def least_step(self) -> float:
        """`min_step` for adaptive step sizes, 0 for fixed ones."""
        return self.min_step if self.dt is None else 0.0

    @property
    def clock(self) -> str:
        """Name of the option `clock`, "nominal" or "corrected"."""
        return "nominal" if self.nominal else "corrected"

    def check(self, time_dependent: bool) -> str:
        """How steps of adaptive sizes are checked, a clause; empty for fixed sizes."""
        if self.dt is not None:
            return ""
        if self.looks == 0:
            return "not checked (looks=0)"
        looks = LOOKS if self.looks is None and time_dependent else self.looks
        return "psi looked at in each step" + ("" if looks is None else f" and {looks} times across the span")

    def fixed_text(self) -> str:
        """String of the scalar options that must not change when a run is continued."""
        kind, output = "adaptive" if self.dt is None else "fixed", "steps" if self.t_eval is None else "t_eval"
        numbers = self.rtol, self.atol, output, self.dense_output, self.clock, self.max_step, self.first_step
        least, looks = [self.min_step] * (self.min_step != 0), [] if self.dt is not None else ["looks", self.looks]
        return " ".join(map(str, (kind, *numbers, *least, *looks)))


def overall_status(statuses: IntegerArray) -> int:
    """The status of a run from those of its trajectories: -1 if any failed, else -2 if any did not keep its order."""
    for status in (-1, ORDER_NOT_KEPT):
        if np.any(statuses == status):
            return status
    return int(np.max(statuses, initial=0))


class Outcome(NamedTuple):
    """How the trajectories of a run ended."""

    status: int  # of the whole run
    statuses: IntegerArray
    message: str  # how the trajectories ended, and where the first failure is
    stopped_at: float | None  # the earliest time of a failure


def outcome(
    codes: IntegerArray, ended_at: Array, unkept_from: Array, direction: float, order: int, reason: str
) -> Outcome:
    """The `Outcome` of a run."""
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
    """Sentence that is added to the message of a run that failed and had not kept its order before."""
    return f" Before, order {order} was not kept: {reason}."


def among(some: BooleanArray, tail: str) -> str:
    """The first of some trajectories and their number, as the end of a message; only a point without an ensemble."""
    if not some.ndim:
        return "."
    index = tuple(int(i) for i in np.argwhere(some)[0])
    return f"{TRAJECTORY_MARK}{index[0] if len(index) == 1 else index}; {int(some.sum())} of {some.size}{tail}."


# Initial points and time spans as users give them, read as float64 or numpy.longdouble.

REMEDIES = {  # what to do about initial points of a kind that is refused
    "c": "on C^n give z.view(float), the coordinates (Re z_1, Im z_1, ...); .view(complex) reads points back",
    "f": "y0.astype(numpy.float64) computes in double precision",
    "b": "y0.astype(float) computes with 0 and 1",
}
ROUNDED = ("mpf", "mpc", "mpfr", "Decimal", "Float", "arb")
"""Names of types of numbers of more digits than floats, in mpmath, gmpy2, decimal, sympy and flint."""


def points_of(y0: npt.ArrayLike) -> Array:
    """Initial points as an array of float64 (exact numbers too), or of longdouble if they are given in it."""
    refuse_masked("the start", y0)
    try:
        array = np.asarray(y0)
        if array.dtype.kind == "O":
            for name in {type(x).__name__ for x in array.flat}.intersection(ROUNDED):
                raise InputError(
                    f"the start has a number of type {name}, which would be rounded: "
                    "numpy.array(y0, dtype=float) computes in double precision, numpy.longdouble in extended precision"
                )
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"the start is not a point of floats: {error}") from None
    if array.dtype in (np.float64, np.longdouble) or array.dtype.kind in "iu":
        return array.astype(array.dtype if array.dtype.kind == "f" else np.float64)
    remedy = REMEDIES.get(array.dtype.kind)
    expected = "float64" if array.dtype.kind == "f" else "real numbers"
    raise InputError(f"the start has the type {array.dtype}, expected {expected}" + (f": {remedy}" if remedy else ""))


def span_of(t_span: Iterable[float] | Span, dtype: np.dtype[Any]) -> Span:
    """Start and end of a time span, in a floating type."""
    try:
        if isinstance(t_span, str | bytes):
            raise TypeError
        first, last = (dtype.type(t) for t in t_span)
        if np.ndim(first) or np.ndim(last):
            raise TypeError
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"t_span is {displayed(t_span)}, expected two numbers (start, end)") from None
    if not (np.isfinite(first) and np.isfinite(last)):
        raise InputError(f"t_span is {displayed(t_span)}: start and end must be finite")
    return first, last


# Progress of a run: a bar on standard error, or a user's function of the fraction done.

INTERVAL = 0.1  # seconds between two reports


@final
class Progress:
    """Reports of the fraction done, at most every tenth of a second and at the end."""

    def __init__(self, show: bool | Callable[[float], object], task: str = "integrating") -> None:
        if not callable(show) and show not in (True, False, None):
            raise InputError(f"progress is {displayed(show)}, expected True, False or a function of the fraction done")
        self._callback = show if callable(show) else None
        self._name, self._silent, self._last = task, not show, -INTERVAL
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> Progress:
        if not self._silent and self._callback is None:
            from rich.console import Console
            from rich.progress import Progress as Bar

            self._bar = Bar(console=Console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task(self._name, total=1.0)
        return self

    def update(self, fraction: Callable[[], float], *, last: bool = False) -> None:
        """Report the fraction done; `fraction` is called only if it is shown. Raises `LimitError` after a deadline."""
        in_time()
        if self._silent:
            return
        now = time.monotonic()
        if not last and now - self._last < INTERVAL:
            return
        self._last = now
        done = min(1.0, max(0.0, fraction()))
        if self._callback is not None:
            self._callback(done)
        if self._bar is not None:
            self._bar.update(self._task, completed=done)

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.stop()
