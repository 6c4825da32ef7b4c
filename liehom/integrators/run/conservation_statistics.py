"""Statistics of a conserving step over a run: how well first integrals were conserved, as extremes over all steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.conserving import Conserving, ConservingStep
from liehom.correctors.conserving.conservation import combination
from liehom.correctors.step import Step
from liehom.typing import Array, BooleanArray, IntegerArray

CONSERVED_ROUNDOFFS = 32.0
"""F counts as conserved up to this many units of its round-off."""
NO_RANK = int(np.iinfo(np.int64).max)
"""Stands for the smallest rank as long as no rank was met."""


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
class ConservationStatistics:
    """Extremes and counts of what conserving steps reported, for each trajectory.

    Examples
    --------
    >>> import liehom as lh
    >>> ConservationStatistics(lh.Heun(), (3,)).report() is None
    True
    """

    def __init__(self, step: Step, shape: tuple[int, ...]) -> None:
        self._step = step
        self._seen: dict[str, npt.NDArray[Any]] = {
            "rank": np.full(shape, NO_RANK),
            "wanted": np.zeros(shape, dtype=int),
            "iterations": np.zeros(shape, dtype=int),
            "defect": np.zeros(shape),
            "missed": np.zeros(shape, dtype=int),
            "left": np.zeros(shape, dtype=int),
            "short": np.zeros(shape, dtype=int),
            "place": np.zeros(0),
            "covectors": np.zeros((0, 0)),
        }

    def add(self, local: ConservingStep, h: Array, t: Array, m: Array, active: BooleanArray) -> None:
        """Record one step of size h (...,) of the active trajectories."""
        made, old = local.conserved(h[..., None]), self._seen
        usual = active & ~made.left
        short = usual & (made.rank < made.wanted)
        seen = {
            "rank": np.where(usual, np.minimum(old["rank"], made.rank), old["rank"]),
            "wanted": np.where(usual, np.maximum(old["wanted"], made.wanted), old["wanted"]),
            "iterations": np.where(active, np.maximum(old["iterations"], made.iterations), old["iterations"]),
            "defect": np.where(active, np.maximum(old["defect"], made.defect), old["defect"]),
            "missed": old["missed"] + (active & (made.units > CONSERVED_ROUNDOFFS)),
            "left": old["left"] + (active & made.left),
            "short": old["short"] + short,
            "place": old["place"],
            "covectors": old["covectors"],
        }
        if short.any() and not len(old["place"]):
            index = tuple(int(i) for i in np.argwhere(short)[0])
            seen["place"] = np.array([t[index], *m[index]], dtype=float)
            seen["covectors"] = local.found.unreachable(index)
        self._seen = seen  # arrays are replaced, never written into: older states stay whole

    def add_compiled(self, lanes: IntegerArray, extra: Mapping[str, Array]) -> None:
        """Record the totals of compiled steps with one integral, for some trajectories of the flattened ensemble.

        At the steps that are corrected ("usual") chi is onto; compiled code does not make others.
        """
        old = self._seen
        seen = {name: np.array(x).reshape(-1) for name, x in old.items() if name not in ("place", "covectors")}
        usual = extra["usual"] > 0
        seen["rank"][lanes] = np.where(usual, np.minimum(seen["rank"][lanes], 1), seen["rank"][lanes])
        seen["wanted"][lanes] = np.where(usual, np.maximum(seen["wanted"][lanes], 1), seen["wanted"][lanes])
        for name in ("iterations", "defect"):
            seen[name][lanes] = np.maximum(seen[name][lanes], extra[name].astype(seen[name].dtype))
        for name in ("missed", "left"):
            seen[name][lanes] += extra[name].astype(int)
        self._seen = {**old, **{name: x.reshape(np.shape(old[name])) for name, x in seen.items()}}

    def report(self) -> ConservationReport | None:
        """The report of a conserving step; None for other steps."""
        if not isinstance(self._step, Conserving):
            return None
        seen = self._seen
        rank, place = int(np.min(seen["rank"], initial=NO_RANK)), [float(x) for x in seen["place"]]
        names = ", ".join(combination(z) for z in seen["covectors"])
        return ConservationReport(
            rank=0 if rank == NO_RANK else rank,
            wanted=int(np.max(seen["wanted"], initial=0)),
            iterations=int(np.max(seen["iterations"], initial=0)),
            defect=float(np.max(seen["defect"], initial=0.0)),
            missed_steps=int(seen["missed"].sum()),
            left_steps=int(seen["left"].sum()),
            short_steps=int(seen["short"].sum()),
            short_at=(place[0], tuple(place[1:]), names) if place else None,
            linear=self._step.linear,
        )

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return dict(self._seen)

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self._seen = {name: arrays[name] for name in self._seen}
