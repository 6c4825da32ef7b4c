"""Errors of first integrals over time: what is drawn is |F(y(t)) - F(y(t0))|, on whose axes, in which scale."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.plotting.drift_plot import plot_energy_drift

pytest.importorskip("matplotlib")

from liehom.plotting.canvas import COLOURS, DARK_COLOURS, new_figure, style
from liehom.plotting.drift_plot import HAIRLINE, _places

FIELD = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))
ENERGY = "m0**2/2 + m1**2/4 + m2**2/6"


def energy(m: Any) -> Any:
    return np.sum(m * m / np.array([2.0, 4.0, 6.0]), axis=-1)


def run(step: Any = "heun", end: float = 20.0, start: Any = (0.6, 0.0, 0.8), **options: Any) -> lh.Solution:
    return lh.integrate(FIELD, (0, end), np.array(start), step=step, dt=0.25, **options)


def curve(ax: Any, k: int = 0) -> tuple[Any, Any]:
    return ax.lines[k].get_data()


def test_errors_are_differences_from_the_initial_value() -> None:
    sol = run()
    t, error = curve(plot_energy_drift(sol, energy, largest_so_far=False))
    values = energy(sol.y.T)
    np.testing.assert_array_equal(t, sol.t[1:])
    np.testing.assert_allclose(error, np.maximum(np.abs(values / values[0] - 1)[1:], HAIRLINE), rtol=1e-12, atol=1e-15)
    assert error.max() > 1e-3


def test_the_largest_error_so_far_never_decreases_and_is_an_error() -> None:
    sol = run("rk4", end=100.0)
    ax = plot_energy_drift(sol, ENERGY)
    (_, largest), (_, error) = curve(ax), curve(plot_energy_drift(sol, ENERGY, largest_so_far=False))
    np.testing.assert_array_equal(largest, np.maximum.accumulate(error))
    assert (np.diff(error) < 0).any()


def test_scales_follow_the_times() -> None:
    short, long = plot_energy_drift(run(end=5.0), ENERGY), plot_energy_drift(run(end=30.0), ENERGY)
    assert [ax.get_yscale() for ax in (short, long)] == ["log", "log"]
    assert [ax.get_xscale() for ax in (short, long)] == ["linear", "log"]
    assert plot_energy_drift(run(end=30.0), ENERGY, largest_so_far=False).get_xscale() == "linear"


def test_steps_differ_in_color_dashes_and_markers_and_are_named() -> None:
    runs = {name: run(name) for name in ("euler", "heun", "rk4")}
    for given, wanted in ((runs, list(runs)), (list(runs.values()), ["Euler()", "Heun()", "RKMK('rk4')"])):
        ax = plot_energy_drift(given, ENERGY)
        looks = [(line.get_color(), line.get_linestyle(), line.get_marker()) for line in ax.lines]
        assert all(len({look[i] for look in looks}) == 3 for i in range(3))
        assert [text.get_text() for text in ax.get_legend().get_texts()] == wanted
    assert [text.get_text() for text in plot_energy_drift(runs, ENERGY, labels="abc").get_legend().get_texts()] == [
        "a", "b", "c",
    ]  # fmt: skip


def test_an_error_is_absolute_if_the_integral_is_initially_zero() -> None:
    start = (0.6, 0.0, 0.8)
    shifted = energy(np.array(start))
    ax = plot_energy_drift(run(start=start), lambda m: energy(m) - shifted)
    relative = plot_energy_drift(run(start=start), energy)
    assert "absolute" in ax.get_ylabel() and "relative" in relative.get_ylabel()
    np.testing.assert_allclose(curve(ax)[1], curve(relative)[1] * shifted, rtol=1e-9)


def test_of_several_integrals_the_largest_error_counts() -> None:
    sol = run()
    both = plot_energy_drift(sol, ["m0**2 + m1**2 + m2**2", ENERGY])
    np.testing.assert_array_equal(curve(both)[1], curve(plot_energy_drift(sol, ENERGY))[1])


def test_trajectories_of_an_ensemble_share_a_color_and_a_label() -> None:
    starts = np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]])
    ensemble = lh.integrate(FIELD, (0, 10), starts, rtol=1e-3)  # of different lengths, filled up with NaN
    assert np.isnan(ensemble.t).any()
    ax = plot_energy_drift({"both": ensemble, "one": run()}, ENERGY)
    assert [line.get_color() for line in ax.lines] == [COLOURS[0], COLOURS[0], COLOURS[1]]
    assert len(ax.get_legend().get_texts()) == 2
    assert all(np.isfinite(line.get_ydata()).all() for line in ax.lines)


def test_a_value_replaces_the_one_at_the_first_stored_point() -> None:
    start, late = (0.6, 0.0, 0.8), [10.0, 15.0, 20.0]
    exact = energy(np.array(start))
    sol = run(t_eval=late)
    error = curve(plot_energy_drift(sol, energy, value=exact, largest_so_far=False))[1]
    np.testing.assert_allclose(error, np.abs(energy(sol.y.T) / exact - 1)[1:], rtol=1e-9)
    with pytest.raises(ShapeError, match="1 components"):
        plot_energy_drift(sol, energy, value=[1.0, 2.0])


def test_the_axes_and_the_style_of_the_caller_are_used() -> None:
    with style(dark=True):
        given = new_figure(4, 3).add_subplot()
        assert plot_energy_drift(run(), ENERGY, given) is given
    assert given.lines[0].get_color() == DARK_COLOURS[0]


@pytest.mark.parametrize("given", [[], {}, 3, ["sol"], {"a": 1}])
def test_what_is_no_solution_is_refused(given: Any) -> None:
    with pytest.raises(InputError, match="expected solutions"):
        plot_energy_drift(given, ENERGY)


def test_labels_are_counted_and_integrals_checked() -> None:
    with pytest.raises(InputError, match="1 solutions and 2 labels"):
        plot_energy_drift(run(), ENERGY, labels=["a", "b"])
    with pytest.raises(ShapeError, match="last axis"):
        plot_energy_drift(run(), lambda m: m[0])
    with pytest.raises(InputError, match="axes of matplotlib"):
        plot_energy_drift(run(), ENERGY, "axes")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("solution", "F", "options", "match"),
    [
        (run(start=np.zeros((0, 3))), ENERGY, {}, "no point"),
        (run(t_eval=[]), ENERGY, {}, "no point"),
        (run(), ENERGY, {"value": "x"}, "value"),
        (run(), ENERGY, {"value": 1j}, "value"),
        (run(), ENERGY, {"value": float("nan")}, "finite"),
        (run(), "sqrt(m0 - 5)", {}, "finite"),
        (run(), ENERGY, {"labels": 3}, "labels"),
        (run(), ENERGY, {"ax": new_figure(2, 2).add_subplot(projection="3d")}, "axes"),
    ],
)
def test_nothing_is_drawn_without_points_and_finite_values(solution: Any, F: Any, options: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        plot_energy_drift(solution, F, **options)


@pytest.mark.parametrize("logarithmic", [False, True])
def test_markers_are_evenly_spread_over_the_axis(logarithmic: bool) -> None:
    times = np.geomspace(1, 1e4, 2000) if logarithmic else np.linspace(3, 7, 2000)
    places = _places(times, 0.25, logarithmic)
    assert np.allclose(places, (np.arange(6) + 0.25) / 6 * 2000, atol=2)


def test_short_curves_are_marked_at_their_ends() -> None:
    assert [_places(np.array(t), 0.5, False) for t in ([], [3.0], [3.0, 4.0])] == [[], [0], [1]]


def test_points_that_are_not_finite_are_left_out() -> None:
    sol = run()
    y = sol.y.copy()
    y[0, -3:] = np.inf
    t, error = curve(plot_energy_drift(dataclasses.replace(sol, y=y), ENERGY))
    assert np.array_equal(t, sol.t[1:-3]) and np.isfinite(error).all()


def test_times_are_those_since_the_first_point() -> None:
    sol = lh.integrate(FIELD, (2, 4), [0.6, 0.0, 0.8], step="heun", dt=0.25)
    assert np.allclose(curve(plot_energy_drift(sol, ENERGY))[0], np.arange(1, 9) / 4)
