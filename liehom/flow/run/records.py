"""Records of a run: its path, requested points, events, statistics, and the report of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt

from liehom.base.typing import Array, BooleanArray, IntegerArray, Lanes, Real, Values
from liehom.flow.action.space import Action
from liehom.flow.steps.first_integral import combination
from liehom.flow.steps.step import Diagnostics, LocalStep, Step

# Report, the summary of the corrections of a run, and how well it conserved first integrals.

TOTALS = {"max": "largest", "min": "smallest", "sum": "sum over steps"}  # words for what is recorded of a diagnostic


def loss_of_order(failed: int, near: int, order: int) -> str:
    """Why an order was not kept, a clause; empty if it was kept."""
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

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.flow.steps import Conserving
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

    def __str__(self) -> str:
        newton = f"Newton, at most {self.iterations} iteration" + "s" * (self.iterations != 1)
        text = f"first integrals kept to {self.defect:.2g} ({newton}; least rank of chi {self.rank} of {self.wanted})"
        if self.missed_steps:
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
    """Up to 8 coordinates of a point with 4 digits, for reports."""
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
        (`liehom.flow.steps.corrected.Correction.near_cone`). At these only the base order is claimed.
    unkept_from : float or None
        Time of the first step that did not keep the order asked for; None if all kept it.
    stopped_at : float or None
        The earliest time at which a trajectory failed: up to it the path was checked. None if none failed.
    diagnostics : tuple of (str, str, float)
        (name, "max", "min" or "sum", total) of the other numbers that steps report (`LocalStep.diagnostics`), over all
        steps of all trajectories.
    check : str
        How psi is looked at within steps of adaptive sizes (`looks` of `integrate`); empty for fixed sizes.
    looks, cuts : int
        Number of looks at psi within steps, and how often one made a size smaller, over all steps of all trajectories.
        0 for methods that ask psi at stages, and on JAX arrays, where they are not counted.
    engine : str
        What made the steps: "numpy", "python", "llvm", "jax", or several of them in order, as "numpy, llvm". Reports
        that differ in this entry only are equal.
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
    check: str = ""
    looks: int = 0
    cuts: int = 0
    engine: str = field(default="", compare=False)

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
        conserved = [] if self.conservation is None else [str(self.conservation)]
        others = [f"{name}, {TOTALS[kind]}: {value:.6g}" for name, kind, value in self.diagnostics]
        if self.check:
            made = f"; {self.looks} looks, {self.cuts} sizes cut" if self.looks else ""
            others.append(f"sizes by the tolerance, {self.check}{made}")
        if self.range_condition is None:
            return "\n".join([*lines, f"order {self.order}, no correction", *conserved, *others])
        until = "" if self.stopped_at is None else f" up to t = {self.stopped_at:.6g}"
        stopped = until and f"{until}, where the run stopped"
        if self.range_condition:
            lines.append(f"orbits captured to order {self.order} at every step{until} (base order {self.base_order})")
            state = f"holds{stopped}"
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
            checked = f", checked{stopped}" if stopped and not self.range_condition else ""
            lines.append(f"range condition: {state}, {singular}{checked}")
            if not self.range_condition:
                time, point = self.singular_at
                lines.append(f"    smallest at t = {time:.6g}, m = ({shown_point(point)})")
        if self.equilibria:
            lines.append(f"equilibria met at {self.equilibria} steps: left as they are")
        return "\n".join([*lines, *conserved, f"least corrections in {self.inner_product}", *others])


# Statistics of a run: what its steps report (`LocalStep.diagnostics`), as extremes and sums over all steps.

NEUTRAL = {"max": -np.inf, "min": np.inf, "sum": 0.0}  # the total of a diagnostic before the first step
LOST = "lost"  # the diagnostic that says whether a step misses its order: its first time is recorded, and not its total
REPORTED = ("equilibria", "failed", "near", "short", "residual", "singular", "rank", "looks", "cuts")
"""Diagnostics of corrected and of adaptive steps, which have entries of their own in a `Report`."""
OF_CONSERVATION = "conservation_"  # prefix of the diagnostics of a conserving step


@final
class StepStatistics:
    """Extremes and sums over all steps of what the steps reported, for each trajectory."""

    def __init__(self, step: Step, shape: tuple[int, ...]) -> None:
        self._step, self._shape = step, shape
        # arrays are replaced, never written into: older states stay whole
        self._totals: dict[str, Array] = {}  # "max.name", "min.name", "sum.name"
        self.unkept_from: Array = np.full(shape, np.nan)  # time of the first step that did not keep the order, or NaN
        self._places: dict[str, npt.NDArray[Any]] = {}  # (t, m) by "place.name", and "detail.name"

    def take(self, diagnostics: Diagnostics, local: LocalStep, t: Array, m: Array, active: BooleanArray) -> None:
        """Record the diagnostics of a step at (t, m), for the active trajectories."""
        for name, (value, kind) in diagnostics.items():
            if name == LOST:
                lost = active & value
                if lost.any():
                    self.unkept_from = np.where(lost & np.isnan(self.unkept_from), t, self.unkept_from)
                continue
            old, new = self._total(name, kind), np.asarray(value, dtype=float)
            better = active & (new != 0 if kind == "sum" else new > old if kind == "max" else new < old)
            if not better.any():
                continue
            if kind == "sum":
                self._note_first(name, local, t, m, better)
            elif kind == "min":
                self._note_lowest(name, np.where(better, new, np.inf), t, m)
            self._totals[f"{kind}.{name}"] = np.where(better, new if kind != "sum" else old + new, old)

    def take_lowest(self, diagnostics: Diagnostics, lanes: IntegerArray, t: Array, m: Array) -> None:
        """Record those diagnostics at (t, m) of which the smallest is kept, for some trajectories of the ensemble."""
        lowest = {name: np.broadcast_to(x, t.shape) for name, (x, kind) in diagnostics.items() if kind == "min"}
        for name, new in lowest.items():
            self._note_lowest(name, new, t, m)
        self.add_compiled(lanes, {name: (new, "min") for name, new in lowest.items()}, ())

    def _total(self, name: str, kind: str) -> Array:
        total = self._totals.get(f"{kind}.{name}")
        return np.full(self._shape, NEUTRAL[kind]) if total is None else total

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

    def add_compiled(self, lanes: IntegerArray, totals: Mapping[str, tuple[Array, str]], ends: Sequence[float]) -> None:
        """Record the totals of compiled steps, for some trajectories of the flattened ensemble."""
        for name, (value, kind) in totals.items():
            if name == "unkept":
                times = np.array(self.unkept_from).reshape(-1)
                new = (value > 0) & np.isnan(times[lanes])
                times[lanes] = np.where(new, time_of(value, ends), times[lanes])
                self.unkept_from = times.reshape(self._shape)
                continue
            rows = np.array(self._total(name, kind)).reshape(-1)
            join = {"max": np.maximum, "min": np.minimum, "sum": np.add}[kind]
            rows[lanes] = join(rows[lanes], value)
            self._totals[f"{kind}.{name}"] = rows.reshape(self._shape)

    # -- results -----------------------------------------------------------------------------------------
    @property
    def loss(self) -> str:
        """Why the order was not kept, a clause; empty if it was kept."""
        return loss_of_order(self._count("failed"), self._count("near"), self._order())

    def _largest(self, name: str, otherwise: float = 0.0) -> float:
        return float(np.max(self._total(name, "max"), initial=otherwise))

    def _smallest(self, name: str) -> float:
        return float(np.min(self._total(name, "min"), initial=np.inf))

    def _rank(self, name: str) -> int:
        rank = self._smallest(name)
        return int(rank) if rank < np.inf else 0

    def _count(self, name: str) -> int:
        return int(self._total(name, "sum").sum())

    def _order(self) -> int:
        return self._step.order - int(self._largest("short"))

    def _shown(self, name: str) -> tuple[float, tuple[float, ...]] | None:
        """(t, point) at which a diagnostic is noted; None if it is not."""
        place = self._places.get(f"place.{name}")
        return None if place is None else (float(place[0]), tuple(float(x) for x in place[1:]))

    def report(
        self, action: Action, clock: str, orbit_dimension: int | IntegerArray, direction: float = 1.0,
        stopped_at: float | None = None, check: str = "", engine: str = "",
    ) -> Report:  # fmt: skip
        """The statistics as a `Report`."""
        from_times, step = direction * self.unkept_from, self._step
        return Report(
            step=repr(step), exponential=action.exponential.name, clock=clock, base_order=step.base_order,
            order=self._order(), wanted_order=step.order, worst_residual=self._largest("residual"),
            singular_value=self._smallest("singular"), singular_at=self._shown("singular"), rank=self._rank("rank"),
            orbit_dimension=int(np.max(orbit_dimension, initial=0)), failed_steps=self._count("failed"),
            equilibria=self._count("equilibria"), inner_product=action.inner_product.name,
            conservation=self._conservation(), near_steps=self._count("near"),
            unkept_from=None if bool(np.isnan(from_times).all()) else direction * float(np.nanmin(from_times)),
            stopped_at=stopped_at, diagnostics=self._others(), check=check, looks=self._count("looks"),
            cuts=self._count("cuts"), engine=engine,
        )  # fmt: skip

    def _conservation(self) -> ConservationReport | None:
        """The report on first integrals; None for a step that conserves none."""
        p = OF_CONSERVATION
        if f"max.{p}defect" not in self._totals:
            return None
        place = self._shown(f"{p}short")
        names = ", ".join(combination(z) for z in self._places.get(f"detail.{p}short", ()))
        return ConservationReport(
            rank=self._rank(p + "rank"), wanted=int(self._largest(p + "wanted")),
            iterations=int(self._largest(p + "iterations")), defect=self._largest(p + "defect"),
            missed_steps=self._count(p + "missed"), left_steps=self._count(p + "left"),
            short_steps=self._count(p + "short"), short_at=None if place is None else (*place, names),
        )  # fmt: skip

    def _others(self) -> tuple[tuple[str, str, float], ...]:
        """(name, kind, total over all trajectories) of the diagnostics without an entry of their own."""
        return tuple(
            (name, kind, float(getattr(total, kind)()))
            for (kind, _, name), total in ((key.partition("."), total) for key, total in self._totals.items())
            if name not in REPORTED and not name.startswith(OF_CONSERVATION)
        )

    # -- checkpoints -------------------------------------------------------------------------------------
    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return {**self._totals, **self._places, "unkept_from": self.unkept_from}

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self._totals = {key: x for key, x in arrays.items() if key.split(".")[0] in NEUTRAL}
        self._places = {key: x for key, x in arrays.items() if key.split(".")[0] in ("place", "detail")}
        self.unkept_from = arrays.get("unkept_from", np.full(self._shape, np.nan))


def _place(index: tuple[Any, ...], t: Array, m: Array) -> Array:
    return np.array([t[index], *m[index]], dtype=float)


def bounds_of(ends: Sequence[float]) -> tuple[float, float]:
    """(1, or -1 if time decreases; a number that exceeds the times between the ends by at least 1)."""
    return (1.0 if ends[1] >= ends[0] else -1.0), abs(float(ends[0])) + abs(float(ends[1])) + 1.0


def earliness(time: Values, bounds: tuple[Real, Real]) -> Values:
    """A decreasing function of the time that passes, positive up to the end; its largest value is the earliest time."""
    direction, limit = bounds
    return limit - direction * time


def time_of(value: Array, ends: Sequence[float]) -> Array:
    """The time of a given `earliness`."""
    direction, limit = bounds_of(ends)
    return direction * (limit - value)


# Records of a run: its path, the points at requested times, and the events. Each record gives its state as named
# arrays, for checkpoints.

PATH_NAMES = ("times", "points", "sizes", "moved")


@final
class Path:
    """Times, points and sizes of all steps; in an ensemble, some trajectories may not move in a step."""

    def __init__(self, t: Array, m: Array) -> None:
        # blocks (k, ...) of times, points, sizes, and of booleans: whether the trajectory moved
        self._blocks: list[tuple[npt.NDArray[Any], ...]] = []
        self.add(t, m, np.zeros_like(t), np.ones(t.shape, dtype=bool))

    def __len__(self) -> int:
        return sum(len(block[0]) for block in self._blocks)

    def add(self, t: Array, m: Array, h: Array, moved: BooleanArray) -> None:
        """Append a step of sizes h to (t, m), for the trajectories that moved."""
        self.extend(np.asarray(t)[None], np.asarray(m)[None], np.asarray(h)[None], np.asarray(moved)[None])

    def extend(self, t: Array, m: Array, h: Array, moved: BooleanArray) -> None:
        """Append several steps, along a first axis."""
        self._blocks.append((t, m, h, moved))

    def cut(self, length: int) -> None:
        """Remove all but the first `length` entries."""
        excess = len(self) - length
        while excess > 0:
            block = self._blocks.pop()
            if len(block[0]) > excess:
                self._blocks.append(tuple(x[:-excess] for x in block))
            excess -= len(block[0])

    def _whole(self) -> tuple[npt.NDArray[Any], ...]:
        block = tuple(np.concatenate(parts) for parts in zip(*self._blocks, strict=True))
        self._blocks = [block]
        return block

    def compact(self) -> tuple[Array, Array, Array]:
        """Times (n + 1, ...), points (n + 1, ..., N) and sizes (n, ...) without gaps, then NaN (sizes: 0)."""
        times, points, sizes, moved = self._whole()
        if not bool(moved.all()):
            points, times, sizes = (without_gaps(x, moved) for x in (points, times, sizes))
        return times, points, np.nan_to_num(sizes[1:])

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return dict(zip(PATH_NAMES, self._whole(), strict=True))

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self._blocks = [tuple(arrays[name] for name in PATH_NAMES)]


def without_gaps(rows: Array, moved: BooleanArray) -> Array:
    """Rows (j, L, ...) of which those are kept in which a trajectory moved, then NaN."""
    moved = moved.reshape(*moved.shape, *[1] * (rows.ndim - moved.ndim))
    order = np.argsort(~moved, axis=0, kind="stable")[: int(moved.sum(axis=0).max(initial=1))]
    return np.where(np.take_along_axis(moved, order, axis=0), np.take_along_axis(rows, order, axis=0), np.nan)


def of_lanes(entries: Sequence[npt.NDArray[Any]], shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """An array of one array for each trajectory, which `np.array` would join; the only one without an ensemble."""
    if not shape:
        return entries[0]
    array = np.empty(len(entries), dtype=object)
    for i, entry in enumerate(entries):
        array[i] = entry
    return array.reshape(shape)


@final
class Samples:
    """Points at requested times, filled in when a step passes them."""

    def __init__(self, times: Array, t: np.floating[Any], m: Array, direction: float) -> None:
        self.times, self._direction, self._ascending = times, direction, direction * times
        self.points: Array = np.full((*m.shape, len(times)), np.nan, dtype=m.dtype)
        first = int(t in times[:1])
        self.done: IntegerArray = np.full(m.shape[:-1], first)
        self.points[..., :first] = m[..., None]

    def fill(self, at: Callable[[Array, BooleanArray], Array], after: Array, moves: BooleanArray) -> None:
        """Fill in the times up to `after` by at(time, here), for the trajectories that move."""
        upto = np.searchsorted(self._ascending, self._direction * after, side="right")
        new = moves & (upto > self.done)
        if not bool(np.any(new)):
            return
        first, last = np.min(self.done, where=new, initial=len(self.times)), np.max(upto, where=new, initial=0)
        for k in range(int(first), int(last)):
            here = new & (self.done <= k) & (k < upto)
            if bool(np.any(here)):
                self.points[..., k] = np.where(here[..., None], at(self.times[k], here), self.points[..., k])
        self.done = np.where(new, upto, self.done)

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        return {"points": self.points, "done": self.done}

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self.points, self.done = arrays["points"], arrays["done"]


class Occurrence(NamedTuple):
    """A zero of an event function at the size s within a step, or at the `distance` |s|, for one trajectory."""

    step: int
    distance: Any
    event: int
    lane: int
    s: Any
    t: Any
    y: Array
    counted: bool = True  # towards the number that ends the trajectory


def occurrences_of(event: int, here: BooleanArray, s: Lanes, t: Lanes, y: Lanes) -> list[Occurrence]:
    """The occurrences at (t, y) of the trajectories `here`, which are at the sizes s of a step."""
    sizes, times, points = np.reshape(s, -1), np.reshape(t, -1), np.reshape(y, (-1, y.shape[-1]))
    lanes = np.flatnonzero(here).tolist()
    return [Occurrence(0, abs(sizes[b]), event, b, sizes[b], times[b], points[b]) for b in lanes]


@final
class EventLog:
    """Log of the events that occurred: rows (event, trajectory, time, point), for each trajectory in order of time."""

    def __init__(self, count: int, shape: tuple[int, ...], size: int) -> None:
        self._count, self._shape, self._size = count, shape, size
        self.occurrences: IntegerArray = np.zeros((count, *shape), dtype=int)
        self.rows: list[tuple[int, int, np.floating[Any], Array]] = []

    def record(self, occurrences: Sequence[Occurrence], terminal: Sequence[float]) -> dict[int, Occurrence]:
        """Log occurrences in order of time, up to those that end a trajectory, which are returned by trajectory."""
        halts, counts = dict[int, Occurrence](), np.array(self.occurrences)
        flat = counts.reshape(len(counts), -1)
        for x in sorted(occurrences, key=lambda x: x[:3]):
            halt = halts.get(x.lane)
            if halt is not None and x[:2] > halt[:2]:
                continue
            self.rows.append((x.event, x.lane, x.t, x.y))
            flat[x.event, x.lane] += x.counted
            if x.counted and flat[x.event, x.lane] >= terminal[x.event]:
                halts.setdefault(x.lane, x)
        self.occurrences = counts
        return halts

    def lists(self) -> tuple[list[npt.NDArray[Any]], list[npt.NDArray[Any]]]:
        """(t_events, y_events) of a `Solution`."""
        size = int(np.prod(self._shape, dtype=int))
        groups: list[list[list[Any]]] = [[[] for _ in range(size)] for _ in range(self._count)]
        for i, b, t, y in self.rows:
            groups[i][b].append((t, y))
        times = [[np.array([t for t, _ in lane]) for lane in group] for group in groups]
        points = [[np.array([y for _, y in lane]).reshape(-1, self._size) for lane in group] for group in groups]
        return [of_lanes(x, self._shape) for x in times], [of_lanes(x, self._shape) for x in points]

    def arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as named arrays, for a checkpoint."""
        index = np.array([row[:2] for row in self.rows], dtype=int).reshape(-1, 2)
        t, y = (np.array([row[k] for row in self.rows]) for k in (2, 3))
        return {"occurrences": self.occurrences, "index": index, "t": t, "y": y}

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Replace the state by one that `arrays` returned."""
        self.occurrences = arrays["occurrences"]
        rows = zip(arrays["index"], arrays["t"], arrays["y"], strict=True)
        self.rows = [(int(i), int(b), t, y) for (i, b), t, y in rows]
