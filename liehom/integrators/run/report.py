"""Report, the summary of the corrections of a run, and how well it conserved first integrals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import final

TOTALS = {"max": "largest", "min": "smallest", "sum": "sum over steps"}
"""Words for what is recorded of a diagnostic."""


def loss_of_order(failed: int, near: int, order: int) -> str:
    """Why an order was not kept, a clause; empty if it was kept.

    Parameters
    ----------
    failed, near : int
        Numbers of steps at which a linear system had no solution, and from which the cone was within two steps.
    order : int
        The order that was reached.

    Examples
    --------
    >>> loss_of_order(0, 1, 1)
    'the path comes within two steps of the cone on which the range condition fails'
    """
    if failed:
        return f"the linear systems of the corrections have no solution, and the order stays {order}"
    return "the path comes within two steps of the cone on which the range condition fails" if near else ""


@final
@dataclass(frozen=True, slots=True)
class ConservationReport:
    """How well first integrals F were conserved along the trajectories.

    Attributes
    ----------
    rank, wanted : int
        The smallest rank of chi_m that was met, and the number of integrals that are independent on the orbits.
    iterations : int
        The largest number of iterations of Newton's method in a step; 0 for the linear correction.
    defect : float
        The largest |F(step) - target|, over all integrals.
    missed_steps : int
        Number of steps after which F differed from its target by more than round-off.
    left_steps : int
        Number of steps without a correction: at equilibria, or where F does not resolve the orbits.
    short_steps : int
        Number of steps at which chi_m was not onto.
    short_at : tuple or None
        (t, point, the combination of the integrals that is not reached) of the first such step.
    linear : bool
        Whether each step was corrected by one linear solve instead of Newton's method.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.correctors import Conserving
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    >>> step = Conserving(lh.Heun(), "m0**2 + m1**2/2 + m2**2/4")
    >>> report = lh.integrate(field, (0, 1), [0.6, 0.48, 0.64], step=step, dt=0.1).report.conservation
    >>> report.rank, report.missed_steps, bool(report.defect < 1e-15)
    (1, 0, True)
    """

    rank: int
    wanted: int
    iterations: int
    defect: float
    missed_steps: int
    left_steps: int
    short_steps: int
    short_at: tuple[float, tuple[float, ...], str] | None
    linear: bool

    def __str__(self) -> str:
        if self.linear:
            how = "one linear solve per step"
        else:
            how = f"Newton, at most {self.iterations} iteration" + "s" * (self.iterations != 1)
        text = f"first integrals kept to {self.defect:.2g} ({how}; least rank of chi {self.rank} of {self.wanted})"
        if self.missed_steps and not self.linear:
            text += f"\n    NOT to round-off after {self.missed_steps} steps"
        if self.short_at is not None:
            time, point, names = self.short_at
            text += (
                f"\n    chi is NOT onto at {self.short_steps} steps, first at t = {time:.6g}, m = "
                f"({shown_point(point)}): isotropy does not reach {names}"
            )
        if self.left_steps:
            text += f"\n    left alone at {self.left_steps} steps, at or next to equilibria"
        return text


def shown_point(point: Sequence[float]) -> str:
    """Up to 8 coordinates of a point with 4 digits, for reports.

    Examples
    --------
    >>> shown_point([0.6, 0.0, 0.8])
    '0.6, 0, 0.8'
    """
    return ", ".join(f"{x:.4g}" for x in point[:8]) + (", ..." if len(point) > 8 else "")


@final
@dataclass(frozen=True, slots=True)
class Report:
    """Orders that were reached along the trajectories, and singular values and residuals of the corrections.

    Attributes
    ----------
    step, exponential, clock : str
        The method, as printed.
    base_order, order : int
        The order of the base step, and the order to which orbits were captured at every step of every trajectory.
    wanted_order : int
        The order that was asked for.
    worst_residual : float
        The largest relative residual of the linear systems of Theorem 5; 0 for steps without correction.
    singular_value : float
        The smallest singular value that decided the range condition (6.2); inf for steps without correction.
    singular_at : tuple or None
        (t, point) where that singular value was met. Compiled steps compute no singular values: with an engine that
        compiles, this entry and `rank` are those at initial points, of at most 64 trajectories, and of steps in numpy.
    rank, orbit_dimension : int
        The smallest rank met in the range condition, and the dimension of the orbits, which it should have.
    failed_steps : int
        Number of steps (of all trajectories) at which the order asked for was not reached.
    equilibria : int
        Number of steps at which the point was an equilibrium.
    inner_product : str
        The inner product in which the norm of corrections is minimal.
    conservation : ConservationReport or None
        How well a `Conserving` step conserved its first integrals.
    near_steps : int
        Number of steps that came within two steps of the cone on which the range condition fails
        (`liehom.correctors.isotropy.isotropy_corrector.Correction.near_cone`). At these only the base order is claimed.
    unkept_from : float or None
        Time of the first step that did not keep the order asked for; None if all kept it.
    stopped_at : float or None
        The earliest time at which a trajectory failed: up to it the path was checked. None if none failed.
    diagnostics : tuple of (str, str, float)
        (name, "max", "min" or "sum", total) of the other numbers that steps report (`LocalStep.diagnostics`), over all
        steps of all trajectories.
    range_condition : bool or None
        Whether every correction could be solved and no step came near the cone; None for steps without correction.

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
    near_steps: int = 0
    unkept_from: float | None = None
    stopped_at: float | None = None
    diagnostics: tuple[tuple[str, str, float], ...] = ()

    def __setstate__(self, state: Sequence[object]) -> None:
        later = [entry.default for entry in fields(self)[len(state) :]]  # entries that pickles of 0.1.0 lack
        for entry, value in zip(fields(self), [*state, *later], strict=True):
            object.__setattr__(self, entry.name, value)

    @property
    def range_condition(self) -> bool | None:
        """Whether every linear system had a solution, and no step came near the cone on which some have none."""
        return None if self.wanted_order == self.base_order else self.failed_steps == 0 and not self.near_steps

    @property
    def loss(self) -> str:
        """Why the order asked for was not kept, a clause; empty if it was kept."""
        return loss_of_order(self.failed_steps, self.near_steps, self.order)

    def __str__(self) -> str:
        lines = [f"{self.step} with {self.exponential}, clock {self.clock}"]
        if self.range_condition is None:
            lines.append(f"order {self.order}, no correction")
            if self.conservation is not None:
                lines.append(str(self.conservation))
            return "\n".join([*lines, *self._others])
        if self.range_condition:
            every = "every step" if self.stopped_at is None else f"every step up to t = {self.stopped_at:.6g}"
            lines.append(f"orbits captured to order {self.order} at {every} (base order {self.base_order})")
            state = (
                "holds" if self.stopped_at is None else f"holds up to t = {self.stopped_at:.6g}, where the run stopped"
            )
        elif self.failed_steps:
            lines.append(
                f"order {self.wanted_order} NOT reached: the order stays {self.order} at {self.failed_steps} steps, "
                f"largest relative residual {self.worst_residual:.3g}"
            )
            state = "FAILS"
        else:
            lines.append(f"order {self.wanted_order} NOT kept: {self.loss}, first at t = {self.unkept_from:.6g}")
            state = "NEARLY FAILS"
        if self.singular_at is not None:
            singular = f"smallest singular value {self.singular_value:.3g}, rank {self.rank} of {self.orbit_dimension}"
            if self.stopped_at is not None and not self.range_condition:
                singular += f", checked up to t = {self.stopped_at:.6g}, where the run stopped"
            lines.append(f"range condition: {state}, {singular}")
            if not self.range_condition:
                time, point = self.singular_at
                lines.append(f"    smallest at t = {time:.6g}, m = ({shown_point(point)})")
        if self.equilibria:
            lines.append(f"equilibria met at {self.equilibria} steps: left as they are")
        if self.conservation is not None:
            lines.append(str(self.conservation))
        lines.append(f"least corrections in {self.inner_product}")
        return "\n".join([*lines, *self._others])

    @property
    def _others(self) -> list[str]:
        return [f"{name}, {TOTALS[kind]}: {value:.6g}" for name, kind, value in self.diagnostics]
