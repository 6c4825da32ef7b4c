"""Statistics of a run: what its steps report (`LocalStep.diagnostics`), as extremes and sums over all steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.correctors.conserving.conservation import combination
from liehom.correctors.step import Diagnostics, LocalStep, Step
from liehom.homogeneous import Action
from liehom.integrators.run.solution import ConservationReport, Report, loss_of_order
from liehom.typing import Array, BooleanArray, IntegerArray, Real, Values

NEUTRAL = {"max": -np.inf, "min": np.inf, "sum": 0.0}
"""The total of a diagnostic before the first step."""
LOST = "lost"
"""The diagnostic that says whether a step misses its order: its first time is recorded, and not its total."""
OF_CORRECTIONS = ("equilibria", "failed", "near", "short", "residual", "singular", "rank")
"""Diagnostics of a corrected step, which have entries of their own in a `Report`."""
OF_CONSERVATION = "conservation_"
"""Prefix of the diagnostics of a conserving step."""
NO_RANK = int(np.iinfo(np.int64).max)
"""In checkpoints of 0.1.0, the smallest rank before the first step."""
SUMMED_IN_0_1_0 = ("failed", "equilibria", "near", "missed", "left", "short")
PLACES_IN_0_1_0 = {"where": "place.singular", "conservation_place": "place.conservation_short"}


@final
class StepStatistics:
    """Extremes and sums over all steps of what the steps reported, for each trajectory.

    Parameters
    ----------
    step : Step
    shape : tuple of int
        Shape of the ensemble.

    Examples
    --------
    >>> import liehom as lh
    >>> statistics, yes = StepStatistics(lh.Euler(), (2,)), np.array([True, True])
    >>> local = LocalStep(lh.Action(lh.defining(lh.so(2))), np.zeros((2, 2)))
    >>> for k in (3, 2):
    ...     statistics.take({"iterations": (np.array([k, 1]), "max")}, local, np.zeros(2), local.m, yes)
    ...
    >>> statistics.arrays()["max.iterations"].tolist()
    [3.0, 1.0]
    """

    def __init__(self, step: Step, shape: tuple[int, ...]) -> None:
        self._step, self._shape = step, shape
        # arrays are replaced, never written into: older states stay whole
        self._totals: dict[str, Array] = {}  # "max.name", "min.name", "sum.name"
        self._unkept_from: Array = np.full(shape, np.nan)
        self._places: dict[str, npt.NDArray[Any]] = {}  # (t, m) by "place.name", and "detail.name"

    def take(self, found: Diagnostics, local: LocalStep, t: Array, m: Array, active: BooleanArray) -> None:
        """Record the diagnostics of a step at (t, m), for the active trajectories."""
        for name, (value, kind) in found.items():
            if name == LOST:
                lost = active & value
                if lost.any():
                    self._unkept_from = np.where(lost & np.isnan(self._unkept_from), t, self._unkept_from)
                continue
            old, new = self._total(name, kind), np.broadcast_to(np.asarray(value, dtype=float), self._shape)
            better = active & (new != 0 if kind == "sum" else new > old if kind == "max" else new < old)
            if not better.any():
                continue
            if kind == "sum":
                self._note_first(name, local, t, m, better)
            elif kind == "min":
                self._note_lowest(name, np.where(better, new, np.inf), t, m)
            self._totals[f"{kind}.{name}"] = np.where(better, new if kind != "sum" else old + new, old)

    def take_lowest(self, found: Diagnostics, lanes: IntegerArray, t: Array, m: Array) -> None:
        """Record those diagnostics at (t, m) of which the smallest is kept, for some trajectories of the ensemble."""
        for name, (value, kind) in found.items():
            if kind == "min":
                new = np.broadcast_to(np.asarray(value, dtype=float), t.shape)
                self._note_lowest(name, new, t, m)
                least = np.array(self._total(name, kind))
                np.minimum.at(least.reshape(-1), lanes, new)
                self._totals[f"{kind}.{name}"] = least

    def _total(self, name: str, kind: str) -> Array:
        found = self._totals.get(f"{kind}.{name}")
        return np.full(self._shape, NEUTRAL[kind]) if found is None else found

    def _note_lowest(self, name: str, lowest: Array, t: Array, m: Array) -> None:
        """Record where the smallest value of all trajectories was met, if it is in `lowest`."""
        if float(lowest.min()) < float(self._total(name, "min").min()):
            self._places[f"place.{name}"] = _place(np.unravel_index(int(np.argmin(lowest)), t.shape), t, m)

    def _note_first(self, name: str, local: LocalStep, t: Array, m: Array, here: BooleanArray) -> None:
        """Record the place and the details of the first step at which a sum is not 0, if the step has details."""
        if f"place.{name}" in self._places or (self._total(name, "sum") != 0).any():
            return
        index = tuple(int(i) for i in np.argwhere(here)[0])
        detail = local.detail(name, index)
        if detail is not None:
            self._places[f"place.{name}"] = _place(index, t, m)
            self._places[f"detail.{name}"] = detail

    def add_compiled(self, lanes: IntegerArray, found: Mapping[str, tuple[Array, str]], ends: Sequence[float]) -> None:
        """Record the totals of compiled steps, for some trajectories of the flattened ensemble.

        Parameters
        ----------
        lanes : array of int of shape (L,)
            Indices of the trajectories.
        found : dict
            Their totals (L,) by name, with the kind. "unkept" is the `earliness` of the first step that missed the
            order, not positive if there is none.
        ends : (float, float)
            Initial and final time.
        """
        for name, (value, kind) in found.items():
            if name == "unkept":
                times = np.array(self._unkept_from).reshape(-1)
                new = (value > 0) & np.isnan(times[lanes])
                times[lanes] = np.where(new, time_of(value, ends), times[lanes])
                self._unkept_from = times.reshape(self._shape)
                continue
            rows = np.array(self._total(name, kind)).reshape(-1)
            join = {"max": np.maximum, "min": np.minimum, "sum": np.add}[kind]
            rows[lanes] = join(rows[lanes], value)
            self._totals[f"{kind}.{name}"] = rows.reshape(self._shape)

    # -- results -----------------------------------------------------------------------------------------
    @property
    def unkept_from(self) -> Array:
        """Time of the first step that did not keep the order, shape (...,); NaN if there is none."""
        return self._unkept_from

    @property
    def loss(self) -> str:
        """Why the order was not kept, a clause; empty if it was kept."""
        return loss_of_order(self._count("failed"), self._count("near"), self._order())

    def _largest(self, name: str, otherwise: float = 0.0) -> float:
        return float(np.max(self._total(name, "max"), initial=otherwise))

    def _smallest(self, name: str) -> float:
        return float(np.min(self._total(name, "min"), initial=np.inf))

    def _rank(self, name: str) -> int:
        found = self._smallest(name)
        return int(found) if found < NO_RANK else 0

    def _count(self, name: str) -> int:
        return int(self._total(name, "sum").sum())

    def _order(self) -> int:
        return self._step.order - int(self._largest("short"))

    def report(
        self,
        action: Action,
        clock: str,
        orbit_dimension: int | IntegerArray,
        direction: float = 1.0,
        stopped_at: float | None = None,
    ) -> Report:
        """The statistics as a `Report`."""
        from_times = direction * self._unkept_from
        place = self._places.get("place.singular")
        return Report(
            step=repr(self._step),
            exponential=action.exponential.name,
            clock=clock,
            base_order=self._step.base_order,
            order=self._order(),
            wanted_order=self._step.order,
            worst_residual=self._largest("residual"),
            singular_value=self._smallest("singular"),
            singular_at=None if place is None else _shown(place),
            rank=self._rank("rank"),
            orbit_dimension=int(np.max(orbit_dimension, initial=0)),
            failed_steps=self._count("failed"),
            equilibria=self._count("equilibria"),
            inner_product=action.inner_product.name,
            conservation=self._conservation(),
            near_steps=self._count("near"),
            unkept_from=None if bool(np.isnan(from_times).all()) else direction * float(np.nanmin(from_times)),
            stopped_at=stopped_at,
            diagnostics=self._others(),
        )

    def _conservation(self) -> ConservationReport | None:
        """The report on first integrals; None for a step that conserves none."""
        p = OF_CONSERVATION
        if f"max.{p}defect" not in self._totals:
            return None
        place = self._places.get(f"place.{p}short")
        names = ", ".join(combination(z) for z in self._places.get(f"detail.{p}short", ()))
        return ConservationReport(
            rank=self._rank(p + "rank"),
            wanted=int(self._largest(p + "wanted")),
            iterations=int(self._largest(p + "iterations")),
            defect=self._largest(p + "defect"),
            missed_steps=self._count(p + "missed"),
            left_steps=self._count(p + "left"),
            short_steps=self._count(p + "short"),
            short_at=None if place is None else (*_shown(place), names),
            linear=self._largest(p + "linear") > 0,
        )

    def _others(self) -> tuple[tuple[str, str, float], ...]:
        """(name, kind, total over all trajectories) of the diagnostics without an entry of their own."""
        made = []
        for key, total in self._totals.items():
            kind, name = key.split(".", 1)
            if name not in OF_CORRECTIONS and not name.startswith(OF_CONSERVATION):
                joined = total.max() if kind == "max" else total.min() if kind == "min" else total.sum()
                made.append((name, kind, float(joined)))
        return tuple(made)

    # -- checkpoints -------------------------------------------------------------------------------------
    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return {**self._totals, **self._places, "unkept_from": self._unkept_from}

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        if "reached" in arrays:
            arrays = _of_0_1_0(arrays, self._step.order)
        self._totals = {key: x for key, x in arrays.items() if key.split(".")[0] in NEUTRAL}
        self._places = {key: x for key, x in arrays.items() if key.split(".")[0] in ("place", "detail")}
        self._unkept_from = arrays.get("unkept_from", np.full(self._shape, np.nan))


def _of_0_1_0(arrays: Mapping[str, npt.NDArray[Any]], order: int) -> dict[str, npt.NDArray[Any]]:
    """The arrays of a checkpoint of 0.1.0 by their names of today."""
    made: dict[str, npt.NDArray[Any]] = {}
    p = OF_CONSERVATION
    conserves = bool((arrays[p + "rank"] < NO_RANK).any() or arrays[p + "left"].any())
    for name, given in arrays.items():
        if name.startswith(p) and not conserves:
            continue
        x = given.astype(float)
        short = name.removeprefix(OF_CONSERVATION)
        if name == "reached":
            made["max.short"] = order - x
        elif name in PLACES_IN_0_1_0:
            if len(x):
                made[PLACES_IN_0_1_0[name]] = x
        elif short == "covectors":
            made["detail.conservation_short"] = x
        elif name == "unkept_from":
            made[name] = x
        elif short in SUMMED_IN_0_1_0:
            made[f"sum.{name}"] = x
        else:
            made[f"{'min' if short in ('rank', 'singular') else 'max'}.{name}"] = x
    return made


def _place(index: tuple[Any, ...], t: Array, m: Array) -> Array:
    return np.array([t[index], *m[index]], dtype=float)


def _shown(place: Array) -> tuple[float, tuple[float, ...]]:
    return float(place[0]), tuple(float(x) for x in place[1:])


def bounds_of(ends: Sequence[float]) -> tuple[float, float]:
    """(1, or -1 if time decreases; a number that exceeds the times between the ends by at least 1).

    Examples
    --------
    >>> bounds_of((2.0, 0.0))
    (-1.0, 3.0)
    """
    return (1.0 if ends[1] >= ends[0] else -1.0), abs(float(ends[0])) + abs(float(ends[1])) + 1.0


def earliness(time: Values, bounds: tuple[Real, Real]) -> Values:
    """A decreasing function of the time that passes, positive up to the end; its largest value is the earliest time.

    Examples
    --------
    >>> earliness(np.array([0.5, 2.0]), (1.0, 3.0)).tolist(), float(earliness(np.array(0.5), (-1.0, 3.0)))
    ([2.5, 1.0], 3.5)
    """
    direction, limit = bounds
    found: Values = limit - direction * time
    return found


def time_of(value: Array, ends: Sequence[float]) -> Array:
    """The time of a given `earliness`.

    Examples
    --------
    >>> time_of(np.array([2.5, 1.0]), (0.0, 2.0)).tolist(), float(time_of(np.array(3.5), (2.0, 0.0)))
    ([0.5, 2.0], 0.5)
    """
    direction, limit = bounds_of(ends)
    found: Array = direction * (limit - value)
    return found
