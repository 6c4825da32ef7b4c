"""Plots of work and precision: what is drawn is what was measured, with failed and unresolved runs told."""

import dataclasses
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.convergence.costs import WorkPrecisionRow, WorkPrecisionTable
from liehom.plotting.error_plot import _small_label, plot_work_precision

pytest.importorskip("matplotlib")

from liehom.plotting.canvas import DARK_COLOURS, GREY, new_figure, style

NAN = float("nan")


def row(method: str, k: int, *, tolerance: bool = False, **changes: Any) -> WorkPrecisionRow:
    size = 0.5**k
    made = WorkPrecisionRow(
        method, None if tolerance else size, size if tolerance else None, 10.0 ** (-2 * k), 10.0 ** (-2 * k - 1),
        1e-15, 7 * k, 3 * k, 0.1 * k, 0.2 * k,
    )  # fmt: skip
    return made._replace(**changes)


def table(*rows: WorkPrecisionRow) -> WorkPrecisionTable:
    return WorkPrecisionTable(rows, (0.0, 4.0), 1, "numpy", "made up", 1e-16, "no machine", len(rows))


TWO = table(*(row(name, k) for name in ("a", "b") for k in (1, 2, 3)))


def data(ax: Any) -> list[Any]:
    lines = [np.array(line.get_data(), dtype=float) for line in ax.lines]
    return [line for line in lines if np.isfinite(line).any()]


def labels(ax: Any) -> list[str]:
    return [text.get_text() for text in (ax.get_legend() or ax.figure.legends[0]).get_texts()]


@pytest.mark.parametrize(
    ("against", "error", "x", "y"),
    [("time", "trajectory", [0.1, 0.2, 0.3], 0), ("wall", "trajectory", [0.2, 0.4, 0.6], 0),
     ("calls", "orbit", [7, 14, 21], 1), ("steps", "orbit", [3, 6, 9], 1)],
)  # fmt: skip
def test_errors_are_drawn_over_the_cost(against: str, error: str, x: list[float], y: int) -> None:
    ax = TWO.plot(against=against, error=error)
    for line in data(ax):
        np.testing.assert_allclose(line, [x, 10.0 ** -(2 * np.arange(1, 4) + y)])
    assert (ax.get_xscale(), ax.get_yscale(), len(data(ax))) == ("log", "log", 2)
    assert error in ax.get_ylabel() and labels(ax) == ["a", "b"]


@pytest.mark.parametrize("span", [1.5, 3.0, 6.0, 18.0, 60.0, 900.0])
def test_labels_of_short_axes_do_not_overlap(span: float) -> None:
    ax = table(*(row("a", k, cpu_time=cost) for k, cost in ((1, 2e-3), (2, 2e-3 * span)))).plot()
    ax.figure.canvas.draw()
    shown = [tick.get_window_extent() for tick in ax.get_xticklabels(which="both") if tick.get_text()]
    low, high = ax.bbox.x0, ax.bbox.x1
    boxes = sorted((box.x0, box.x1) for box in shown if low <= (box.x0 + box.x1) / 2 <= high)
    assert len(boxes) >= 2
    assert all(left[1] < right[0] for left, right in pairwise(boxes))


def test_methods_differ_in_color_dashes_and_markers() -> None:
    looks = [(line.get_color(), line.get_linestyle(), line.get_marker()) for line in plot_work_precision(TWO).lines]
    assert all(a != b for a, b in zip(*looks, strict=True))


def test_failed_runs_are_counted_in_the_legend() -> None:
    failed = row("a", 4, error=NAN, orbit_error=NAN, calls=None, steps=None, cpu_time=NAN, wall_time=NAN, message="no")
    assert labels(plot_work_precision(table(*TWO.rows, failed), against="calls")) == ["a (1 failed)", "b"]


def test_unresolved_errors_are_open_and_gray_and_their_region_is_shaded() -> None:
    ax = plot_work_precision(table(row("a", 1), row("a", 2), row("a", 3, floor=1e-5)))
    gray = [line for line in ax.lines if line.get_color() == GREY and line.get_linestyle() == "None"]
    assert [line.get_ydata().tolist() for line in gray] == [[1e-6]]
    assert gray[0].get_markerfacecolor() == "white"
    assert len(ax.patches) == 1
    assert not plot_work_precision(TWO).patches  # a control


def test_adaptive_runs_have_a_curve_of_their_own() -> None:
    ax = plot_work_precision(table(*(row("a", k, tolerance=adaptive) for adaptive in (False, True) for k in (1, 2))))
    assert labels(ax) == ["a", "a, adaptive"]
    assert [line.get_markerfacecolor() for line in ax.lines] == [ax.lines[0].get_color(), "white"]
    assert labels(plot_work_precision(table(row("a", 1, tolerance=True), row("a", 2, tolerance=True)))) == ["a"]


def test_the_axes_and_the_style_of_the_caller_are_used() -> None:
    with style(dark=True):
        given = new_figure(4, 3).add_subplot()
        assert TWO.plot(given) is given
    assert given.lines[0].get_color() == DARK_COLOURS[0] and not given.figure.legends


def test_an_ensemble_has_root_mean_squares() -> None:
    assert "root mean square" in plot_work_precision(dataclasses.replace(TWO, trajectories=5)).get_ylabel()


def test_a_measured_table_is_drawn() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2)), ["1 + m0/2"])
    made = lh.work_precision(field, ["euler"], (0, 1), [1.0, 0.0], dts=[0.2, 0.1], repeats=1)
    (line,) = data(made.plot(against="steps"))
    np.testing.assert_allclose(line, [[5, 10], [r.error for r in made.rows]])


@pytest.mark.parametrize(
    ("given", "options"), [(3, {}), (TWO, {"against": "cost"}), (TWO, {"error": "energy"}), (TWO, {"ax": "axes"})]
)
def test_wrong_arguments_are_refused(given: Any, options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"expected|axes of matplotlib"):
        plot_work_precision(given, **options)


@pytest.mark.parametrize(
    ("tick", "axis", "text"),
    [
        (2e-3, (1e-3, 9e-3), r"$2\times10^{-3}$"),
        (4e-3, (1e-3, 9e-3), ""),
        (5e-3, (1e-3, 9e-3), r"$5\times10^{-3}$"),
        (4e-3, (2e-3, 6e-3), r"$4\times10^{-3}$"),
        (2e-3, (1e-3, 9e-2), ""),
        (1e-2, (8e-3, 2e-2), r"$1\times10^{-2}$"),
    ],
)
def test_minor_ticks_have_a_label_if_there_is_room(tick: float, axis: tuple[float, float], text: str) -> None:
    assert _small_label(tick, *axis) == text


def test_runs_without_an_error_or_a_cost_are_not_drawn() -> None:
    ax = plot_work_precision(table(row("a", 1, error=0.0), row("a", 2), row("a", 3), row("a", 4, cpu_time=0.0)))
    np.testing.assert_allclose(data(ax), [[[0.2, 0.3], [1e-4, 1e-6]]])


def test_an_error_of_the_size_of_its_floor_is_unresolved() -> None:
    ax = plot_work_precision(table(row("a", 1), row("a", 2, floor=1e-4)))
    assert [line.get_ydata().tolist() for line in ax.lines if line.get_color() == GREY][-1] == [1e-4]
