"""Solution: what `integrate` returns, shaped as scipy's solve_ivp shapes it; and Report, what the corrector says."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from liehom.integrators.run.conservation_statistics import ConservationReport


@final
@dataclass(frozen=True, slots=True)
class Report:
    """What was reached along the trajectories, and at what cost to the linear algebra.

    Attributes
    ----------
    step, exponential, clock : str
        The method, as printed.
    base_order, order : int
        The order of the base step, and the order to which orbits were captured at every step of every trajectory.
    wanted_order : int
        The order that was asked for.
    worst_residual : float
        The largest relative residual of the linear systems of Theorem 5; 0 for plain steps.
    singular_value : float
        The smallest singular value that decided the range condition (6.2); inf for plain steps.
    singular_at : tuple or None
        (t, point) where it was met. Compiled steps take no singular values: with ``compile`` it is that of the steps
        between them, and so is the rank.
    rank, orbit_dimension : int
        The least rank met in the range condition, and the dimension of the orbits that it should have.
    failed_steps : int
        At how many steps (of all trajectories) the order asked for was not reached.
    equilibria : int
        At how many steps the point was an equilibrium.
    inner_product : str
        The inner product in which corrections are least.
    conservation : ConservationReport or None
        How first integrals were kept by a `Conserving` step.
    range_condition : bool or None
        Whether the correction could be solved everywhere; None for plain steps.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> sol = lh.integrate(field, (0, 1), [0.6, 0, 0.8], step=lh.Corrected(lh.Euler(), 3), dt=0.1)
    >>> print(sol.report)
    Corrected(Euler(), order=3) with exp (Rodrigues), clock corrected
    orbits captured to order 3 at every step (base order 1)
    range condition: holds, smallest singular value 0.354, rank 2 of 2
    least corrections in -tr(rho(x) rho(y)), Ad-invariant
    """

    step: str
    exponential: str
    clock: str
    base_order: int
    order: int
    wanted_order: int
    worst_residual: float
    singular_value: float
    singular_at: tuple[float, tuple[float, ...]] | None
    rank: int
    orbit_dimension: int
    failed_steps: int
    equilibria: int
    inner_product: str
    conservation: ConservationReport | None = None

    @property
    def range_condition(self) -> bool | None:
        """Whether every linear system had a solution."""
        return None if self.wanted_order == self.base_order else self.failed_steps == 0

    def __str__(self) -> str:
        lines = [f"{self.step} with {self.exponential}, clock {self.clock}"]
        if self.range_condition is None:
            lines.append(f"order {self.order}, no correction")
            if self.conservation is not None:
                lines.append(str(self.conservation))
            return "\n".join(lines)
        if self.range_condition:
            lines.append(f"orbits captured to order {self.order} at every step (base order {self.base_order})")
            state = f"holds, smallest singular value {self.singular_value:.3g}"
        else:
            lines.append(
                f"order {self.wanted_order} NOT reached: the order stays {self.order} at {self.failed_steps} steps, "
                f"largest relative residual {self.worst_residual:.3g}"
            )
            state = f"FAILS, smallest singular value {self.singular_value:.3g}"
        if self.singular_at is not None:
            lines.append(f"range condition: {state}, rank {self.rank} of {self.orbit_dimension}")
            if not self.range_condition:
                time, point = self.singular_at
                shown = ", ".join(f"{x:.4g}" for x in point[:8]) + (", ..." if len(point) > 8 else "")
                lines.append(f"    smallest at t = {time:.6g}, m = ({shown})")
        if self.equilibria:
            lines.append(f"equilibria met at {self.equilibria} steps: left as they are")
        if self.conservation is not None:
            lines.append(str(self.conservation))
        lines.append(f"least corrections in {self.inner_product}")
        return "\n".join(lines)


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Solution:
    """The result of `integrate`; its entries are attributes, and items as in a dictionary.

    Attributes
    ----------
    t : array (n,), or (..., n) for an ensemble
        Times; NaN where a trajectory took fewer steps than others. With `t_eval`: these times, (k,).
    y : array (N, n), or (..., N, n)
        Points. With `t_eval`: (..., N, k), for an ensemble NaN at times that a trajectory has not reached.
    sol : DenseSolution or None
        The solution as a function of t, if dense output was asked for.
    t_events, y_events : list or None
        For each event the times (k,) and points (k, N) at which it occurred; for an ensemble object arrays of such.
    nfev : int
        How often psi was called (on points or on series; a call for a whole ensemble counts once).
    njev, nlu : int
        0; as solve_ivp has them.
    status : int
        0: the end was reached; 1: a terminal event occurred; -1: a step failed. For an ensemble -1 if any
        trajectory failed, else 1 if any was ended by an event.
    message : str
    success : bool
        Whether status >= 0.
    n_steps : int or array of shape (...,)
        Steps taken.
    report : Report
    statuses : int or array of shape (...,)
        The status of each trajectory.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    >>> sol = lh.integrate(field, (0, np.pi), [1.0, 0.0], dt=0.1)
    >>> sol.success, np.round(sol["y"][:, -1], 10).tolist()
    (True, [-1.0, 0.0])
    >>> print(repr(sol)[:66])
      message: The solver successfully reached the end of the integrat
    """

    t: Any
    y: Any
    sol: Any
    t_events: list[Any] | None
    y_events: list[Any] | None
    nfev: int
    status: int
    message: str
    n_steps: Any
    report: Report
    statuses: Any
    njev: int = field(default=0)
    nlu: int = field(default=0)

    @property
    def success(self) -> bool:
        """Whether the end was reached or a terminal event occurred."""
        return self.status >= 0

    def keys(self) -> tuple[str, ...]:
        """The names of the entries."""
        return NAMES

    def __getitem__(self, name: str) -> Any:
        """The entry of a name, as of a dictionary."""
        if name not in NAMES:
            raise KeyError(name)
        return getattr(self, name)

    def __contains__(self, name: object) -> bool:
        return name in NAMES

    def __iter__(self) -> Iterator[str]:
        return iter(NAMES)

    def __len__(self) -> int:
        return len(NAMES)

    def __repr__(self) -> str:
        shown = [n for n in CARD if n != "statuses" or np.ndim(self.statuses)]
        width = max(map(len, shown)) + 1
        return "\n".join(f"{name:>{width}}: {_card_entry(self[name], width + 2)}" for name in shown)


_OF_SOLVE_IVP = ("t", "y", "sol", "t_events", "y_events", "nfev", "njev", "nlu", "status", "message", "success")
NAMES = (*_OF_SOLVE_IVP, "n_steps", "report", "statuses")
CARD = (
    "message",
    "success",
    "status",
    "statuses",
    "t",
    "y",
    "sol",
    "t_events",
    "y_events",
    "nfev",
    "n_steps",
    "report",
)


def _card_entry(value: Any, indent: int) -> str:
    """A value in a few lines, of which those after the first are indented."""
    if isinstance(value, list):
        text = f"{len(value)} event{'' if len(value) == 1 else 's'}: " + "; ".join(_occurrences(x) for x in value)
        text = textwrap.shorten(text, 100, placeholder=" ...")
    elif isinstance(value, np.ndarray) and value.ndim:
        shape = f" of shape {value.shape}" if value.ndim > 1 or value.size > 6 else ""
        text = np.array2string(value, precision=4, threshold=6, edgeitems=2, max_line_width=100) + shape
    else:
        text = str(value)
    return text.replace("\n", "\n" + " " * indent)


def _occurrences(found: Any) -> str:
    """How often an event occurred."""
    count = len(found) if found.dtype != object else sum(len(times) for times in found.reshape(-1))
    return f"{count} time{'' if count == 1 else 's'}"
