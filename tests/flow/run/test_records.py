"""What a run records, by hand: the text of reports, extremes and places of diagnostics, paths, samples and events."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.run.records import (
    ConservationReport,
    EventLog,
    Occurrence,
    Path,
    Report,
    Samples,
    StepStatistics,
    bounds_of,
    earliness,
    shown_point,
    time_of,
)  # fmt: skip

PLAIN: dict[str, Any] = {
    "step": "Step()", "exponential": "exp", "clock": "plain", "base_order": 1, "order": 3, "wanted_order": 3,
    "worst_residual": 0.0, "singular_value": 0.5, "singular_at": (0.25, (1.0, 2.0)), "rank": 2, "orbit_dimension": 2,
    "failed_steps": 0, "equilibria": 0, "inner_product": "<x, y>",
}  # fmt: skip
FIRST, LAST = "Step() with exp, clock plain", "least corrections in <x, y>"
KEPT = ConservationReport(1, 2, 1, 1e-16, 0, 0, 0, None)
LOST = ConservationReport(1, 2, 3, 2e-5, 4, 6, 5, (0.5, (1.0, 2.0), "m0"))
KEPT_TEXT = "first integrals kept to 1e-16 (Newton, at most 1 iteration; least rank of chi 1 of 2)"
LOST_TEXT = """first integrals kept to 2e-05 (Newton, at most 3 iterations; least rank of chi 1 of 2)
    NOT to round-off after 4 steps
    chi is NOT onto at 5 steps, first at t = 0.5, m = (1, 2): isotropy does not reach m0
    left alone at 6 steps, at or next to equilibria"""
HELD = "orbits captured to order 3 at every step"
SINGULAR, PLACE = "smallest singular value 0.5, rank 2 of 2", "    smallest at t = 0.25, m = (1, 2)"
REPORTS: list[tuple[dict[str, Any], list[str]]] = [
    ({}, [FIRST, f"{HELD} (base order 1)", f"range condition: holds, {SINGULAR}", LAST]),
    ({"stopped_at": 2.5}, [
        FIRST, f"{HELD} up to t = 2.5 (base order 1)",
        f"range condition: holds up to t = 2.5, where the run stopped, {SINGULAR}", LAST]),
    ({"wanted_order": 1, "order": 1, "conservation": KEPT, "looks": 9, "check": "looked at"}, [
        FIRST, "order 1, no correction", KEPT_TEXT, "sizes by the tolerance, looked at; 9 looks, 0 sizes cut"]),
    ({"failed_steps": 7, "order": 2, "worst_residual": 0.125, "equilibria": 4, "conservation": LOST, "check": "blind"},
     [FIRST, "order 3 NOT reached: the order stays 2 at 7 steps, largest relative residual 0.125",
      f"range condition: FAILS, {SINGULAR}", PLACE, "equilibria met at 4 steps: left as they are", LOST_TEXT, LAST,
      "sizes by the tolerance, blind"]),
    ({"near_steps": 2, "unkept_from": 1.5, "stopped_at": 2.5,
      "diagnostics": (("way", "sum", 6.0), ("gap", "min", 0.5))}, [
      FIRST, "order 3 NOT kept: the path comes within two steps of the cone on which the range condition fails, "
      "first at t = 1.5", f"range condition: NEARLY FAILS, {SINGULAR}, checked up to t = 2.5, where the run stopped",
      PLACE, LAST, "way, sum over steps: 6", "gap, smallest: 0.5"]),
    ({"singular_at": None}, [FIRST, f"{HELD} (base order 1)", LAST]),
]  # fmt: skip


@pytest.mark.parametrize(("changed", "lines"), REPORTS)
def test_the_text_of_a_report(changed: dict[str, Any], lines: list[str]) -> None:
    report = Report(**PLAIN | changed)
    assert str(report) == "\n".join(lines)
    condition = changed.get("wanted_order") != 1 and not {"failed_steps", "near_steps"} & changed.keys()
    assert report.range_condition is (None if changed.get("wanted_order") == 1 else condition)
    assert (report.loss != "") == (not condition and "wanted_order" not in changed)


def test_at_most_eight_coordinates_of_a_point_are_shown() -> None:
    assert shown_point([0.5] * 8) == ", ".join(["0.5"] * 8)
    assert shown_point([0.5] * 9) == ", ".join(["0.5"] * 8) + ", ..."


class Detailed:
    """A step with details of one diagnostic."""

    def detail(self, name: str, index: tuple[int, ...]) -> Any:
        return np.array([float(len(index))]) if name == "conservation_short" else None


def test_statistics_are_extremes_and_sums_with_their_places() -> None:
    step: Any = lh.Heun()
    statistics, local = StepStatistics(step, (2,)), Detailed()
    points, active = np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([True, True])

    def take(time: float, values: dict[str, tuple[list[float], str]], active: Any = active) -> None:
        given: Any = {name: (np.array(value), kind) for name, (value, kind) in values.items()}
        statistics.take(given, local, np.full(2, time), points + time, active)  # type: ignore[arg-type]

    take(0.0, {"way": ([1, 2], "sum"), "singular": ([5, 4], "min"), "residual": ([1, 3], "max")})
    take(
        1.0, {"way": ([1, 2], "sum"), "singular": ([3, 6], "min"), "residual": ([2, 9], "max")}, np.array([True, False])
    )
    take(2.0, {"way": ([0, 0], "sum"), "singular": ([7, 7], "min"), "conservation_short": ([0, 1], "sum")})
    statistics.take({"lost": (np.array([False, True]), "max")}, local, np.full(2, 3.0), points, active)  # type: ignore
    statistics.take({"lost": (np.array([True, True]), "max")}, local, np.full(2, 4.0), points, active)  # type: ignore
    arrays = statistics.arrays()
    assert arrays["sum.way"].tolist() == [2, 2] and arrays["min.singular"].tolist() == [3, 4]
    assert arrays["max.residual"].tolist() == [2, 3] and statistics.unkept_from.tolist() == [4, 3]
    assert arrays["place.singular"].tolist() == [1, 2, 3]  # time, and the first point at that time
    assert arrays["place.conservation_short"].tolist() == [2, 5, 6] and arrays[
        "detail.conservation_short"
    ].tolist() == [1]
    statistics.take_lowest({"singular": (1.0, "min"), "way": (9.0, "sum")}, np.array([1]), np.array([6.0]), points[1:])
    arrays = statistics.arrays()
    assert arrays["min.singular"].tolist() == [3, 1] and arrays["sum.way"].tolist() == [2, 2]
    assert arrays["place.singular"].tolist() == [6, 3, 4]
    again = StepStatistics(step, (2,))
    again.restore(arrays)
    assert all(np.array_equal(value, again.arrays()[name]) for name, value in arrays.items())


def test_compiled_totals_join_those_of_numpy() -> None:
    step: Any = lh.Heun()
    statistics, lanes = StepStatistics(step, (3,)), np.array([2, 0])
    for factor in (1.0, 3.0):
        totals = {name: (factor * np.array([1.0, 2.0]), name) for name in ("max", "min", "sum")}
        statistics.add_compiled(lanes, totals, (0.0, 10.0))
    arrays = statistics.arrays()
    assert arrays["max.max"].tolist() == [6, -np.inf, 3] and arrays["min.min"].tolist() == [2, np.inf, 1]
    assert arrays["sum.sum"].tolist() == [8, 0, 4]
    for ends, time in (((0.0, 10.0), 2.5), ((10.0, 0.0), 2.5)):
        fresh = StepStatistics(step, (3,))
        value = earliness(np.array([time, 11.0]), bounds_of(ends))
        assert np.allclose(time_of(value, ends), [time, 11.0])
        fresh.add_compiled(lanes, {"unkept": (np.array([value[0], 0.0]), "max")}, ends)
        fresh.add_compiled(lanes, {"unkept": (value * 0 + 1.0, "max")}, ends)
        assert fresh.unkept_from.tolist()[1:] == [pytest.approx(np.nan, nan_ok=True), time]


def test_paths_without_the_steps_of_trajectories_that_wait() -> None:
    path = Path(np.zeros(2), np.zeros((2, 1)))
    for k, moved in enumerate([[True, True], [False, True], [True, True], [False, True]], start=1):
        path.add(np.full(2, 1.0 * k), np.full((2, 1), 10.0 * k), np.full(2, 0.5), np.array(moved))
    assert len(path) == 5
    path.cut(7)
    path.cut(4)
    assert len(path) == 4
    times, points, sizes = path.compact()
    assert np.array_equal(times, [[0, 0], [1, 1], [3, 2], [np.nan, 3]], equal_nan=True)
    assert np.array_equal(points[..., 0], 10 * times, equal_nan=True)
    assert sizes.tolist() == [[0.5, 0.5], [0.5, 0.5], [0, 0.5]]
    path.extend(*(np.array(x) for x in ([[4.0, 4.0]] * 3, [[[40.0]] * 2] * 3, [[1.0, 1.0]] * 3, [[True, True]] * 3)))
    path.cut(5)
    assert len(path) == 5 and np.array_equal(path.compact()[0][-2:], [[4, 3], [np.nan, 4]], equal_nan=True)


def test_requested_times_are_filled_when_a_step_passes_them() -> None:
    for direction in (1.0, -1.0):
        samples = Samples(direction * np.array([0.0, 1.0, 2.0]), np.float64(0.0), np.array([[7.0], [8.0]]), direction)
        asked: list[float] = []

        def at(time: Any, here: Any, asked: list[float] = asked) -> Any:
            asked.append(float(time))
            return np.where(here, time, np.nan)[:, None]

        samples.fill(at, direction * np.array([1.0, 0.5]), np.array([True, True]))
        samples.fill(at, direction * np.array([2.0, 2.0]), np.array([False, True]))
        assert np.array_equal(
            samples.points[:, 0], [[7, direction, np.nan], [8, direction, 2 * direction]], equal_nan=True
        )
        assert samples.done.tolist() == [2, 3] and asked == [direction, direction, 2 * direction]
    late = Samples(np.array([1.0]), np.float64(0.0), np.array([7.0]), 1.0)
    assert late.done.tolist() == 0 and np.isnan(late.points).all()


def test_a_trajectory_ends_at_the_event_that_fills_its_count() -> None:
    log = EventLog(2, (2,), 1)
    rows = [(0, 0.5, 0, 0, True), (0, 0.25, 1, 1, True), (1, 0.5, 0, 0, True), (1, 0.5, 1, 0, True),
            (2, 0.5, 0, 0, True), (1, 0.75, 1, 0, True), (1, 0.25, 0, 1, False)]  # fmt: skip
    made = [
        Occurrence(step, s, event, lane, s, step + s, np.array([s]), counted) for step, s, event, lane, counted in rows
    ]
    halts = log.record(made, [2, np.inf])
    assert {lane: (x.step, x.event) for lane, x in halts.items()} == {0: (1, 0)}
    assert log.occurrences.tolist() == [[2, 0], [1, 1]]
    times, points = log.lists()
    assert [[x.tolist() for x in lanes] for lanes in times] == [[[0.5, 1.5], [1.25]], [[1.5], [0.25]]]
    assert points[0][0].shape == (2, 1)
    again = EventLog(2, (2,), 1)
    again.restore(log.arrays())
    assert [(i, b, float(t)) for i, b, t, _ in again.rows] == [(i, b, float(t)) for i, b, t, _ in log.rows]
