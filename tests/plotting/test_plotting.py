"""Pictures: what is drawn is what was measured and integrated; files; what is refused; nothing global is touched."""

import dataclasses
import importlib
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import FormatError, InputError
from liehom.flow.convergence.orders import ConvergenceTable
from liehom.plotting.canvas import COLOURS, DARK_COLOURS, current_colours, inline_svg, new_figure, style
from liehom.plotting.error_plot import draw_floor, plot_convergence
from liehom.plotting.trajectory_plot import curves_of, plot_trajectory

matplotlib = pytest.importorskip("matplotlib")
trajectory_plot = importlib.import_module("liehom.plotting.trajectory_plot")
Figure = pytest.importorskip("matplotlib.figure").Figure
Text = pytest.importorskip("matplotlib.text").Text
NAN = float("nan")


def table(order: int = 4, *, floor: float = 1e-14, trajectory: int | None = None, **changes: Any) -> ConvergenceTable:
    """Errors that are powers of the step size."""
    dts = (0.2, 0.1, 0.05, 0.025)
    made = ConvergenceTable(
        f"Method({order})", "exp", "corrected", order, (0.0, 1.0), 1, "float64", dts,
        tuple(1e-2 * h**order for h in dts), tuple(1e-1 * h ** (trajectory or order) for h in dts),
        (floor,) * 4, floor / 10, ("",) * 4,
    )  # fmt: skip
    return dataclasses.replace(made, **changes)


def rotation(size: int) -> lh.GeneratorField:
    rho = lh.defining(lh.so(size))
    return lh.GeneratorField(rho, np.arange(1.0, rho.algebra.dimension + 1))


def solution(size: int, lead: tuple[int, ...] = (), end: float = 2.0, **options: Any) -> lh.Solution:
    start = np.random.default_rng(size).normal(size=(*lead, size))
    start /= np.linalg.norm(start, axis=-1, keepdims=True)
    return lh.integrate(rotation(size), (0, end), start, dt=0.1, **options)


def lines(figure: Any) -> list[Any]:
    found = [np.array(line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()) for line in
             figure.axes[0].lines]  # fmt: skip
    return [line for line in found if np.isfinite(line.astype(float)).any()]


def holds(figure: Any, wanted: Any) -> bool:
    """Whether some line passes through all these points, shape (axes, n)."""
    return any(line.shape == wanted.shape and np.allclose(line.astype(float), wanted) for line in lines(figure))


def misses(figure: Any, points: Any) -> float:
    """The largest distance from a point of shape (axes, n) to the nearest point of a line."""
    drawn = np.concatenate([line.astype(float).T for line in lines(figure) if len(line) == len(points)])
    return float(max(np.nanmin(np.linalg.norm(drawn - point, axis=-1)) for point in points.T))


def texts(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


# -- convergence -----------------------------------------------------------------------------------------
def test_errors_are_drawn_over_step_sizes() -> None:
    made = table()
    figure = plot_convergence(made)
    axes = figure.axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert "$h$" in axes.get_xlabel() and "error" in axes.get_ylabel()
    for errors in (made.orbit_errors, made.trajectory_errors):
        assert holds(figure, np.array([made.dts[::-1], errors[::-1]]))
    assert any("orbit, order 4.00" in text for text in texts(figure))


def test_a_triangle_has_the_slope_that_was_measured() -> None:
    axes = plot_convergence(table(4, trajectory=1)).axes[0]
    slopes = []
    for triangle in axes.patches:
        corners = np.log(triangle.get_xy()[:3])
        if len(triangle.get_xy()) == 4:
            slopes.append((corners[2, 1] - corners[0, 1]) / (corners[2, 0] - corners[0, 0]))
    assert sorted(np.round(slopes, 9)) == [1, 4]


def test_no_triangle_for_an_order_far_from_an_integer() -> None:
    wild = table(orbit_errors=tuple(h**2.5 for h in table().dts), trajectory_errors=(NAN,) * 4)
    assert not plot_convergence(wild).axes[0].patches


def test_errors_at_round_off_are_apart() -> None:
    made = table(floor=1e-7)
    figure = plot_convergence(made)
    kept = [i for i, e in enumerate(made.orbit_errors) if e > 1e-7]
    assert 0 < len(kept) < 4
    assert holds(figure, np.array([[made.dts[i] for i in kept[::-1]], [made.orbit_errors[i] for i in kept[::-1]]]))
    assert any("round-off" in text for text in texts(figure))
    assert not any("round-off" in text for text in texts(plot_convergence(table(floor=1e-30))))


def test_several_tables() -> None:
    figure = plot_convergence([table(1), table(2), table(3)], labels=["one", "two", "three"])
    found = " ".join(texts(figure))
    assert all(word in found for word in ("one", "two", "three", "orders 2.00, 2.00", "orbit", "trajectory"))
    assert len({line.get_color() for line in figure.axes[0].lines if len(line.get_xdata()) == 4}) == 3


def test_tables_without_any_error() -> None:
    """A run that failed for all step sizes but one, a method that is exact."""
    plot_convergence(table(orbit_errors=(NAN,) * 4))
    plot_convergence(table(orbit_errors=(0.0,) * 4, trajectory_errors=(0.0,) * 4))
    plot_convergence(table(floor=1.0))


def test_on_axes_of_the_caller() -> None:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert plot_convergence(table(), axes=right) is figure
    assert not left.lines and right.lines


@pytest.mark.parametrize(
    ("tables", "options", "match"),
    [
        ([], {}, "tables"),
        ("abc", {}, "tables"),
        ([table(), 1], {}, "tables"),
        (table(), {"labels": ["a", "b"]}, "2 labels"),
        (table(), {"axes": 3}, "axes"),
    ],
)
def test_plot_convergence_raises_for_wrong_arguments(tables: Any, options: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        plot_convergence(tables, **options)


# -- trajectories ----------------------------------------------------------------------------------------
def test_three_coordinates_on_a_sphere() -> None:
    made = solution(3)
    figure = plot_trajectory(made)
    assert figure.axes[0].name == "3d"
    assert any("$|m|$ = 1" in text for text in texts(figure))
    assert {"$m_0$", "$m_1$", "$m_2$"} <= set(texts(figure))
    drawn = np.concatenate([line.astype(float).T for line in lines(figure)])
    for point in made.y.T:  # every point lies on a curve, before or behind the sphere
        assert np.nanmin(np.linalg.norm(drawn - point, axis=-1)) < 1e-12


def test_what_is_behind_the_sphere_is_pale() -> None:
    made = lh.integrate(lh.GeneratorField(lh.adjoint(lh.so(3)), [0, 0, 1]), (0, 12), [0.8, 0.0, 0.6], dt=0.2)
    axes = plot_trajectory(made).axes[0]
    up, around = np.radians(axes.elev), np.radians(axes.azim)
    eye = np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])
    curves = [line for line in axes.lines if len(line.get_data_3d()[0]) > 300 and line.get_color() == "#0072B2"]
    assert sorted(line.get_alpha() or 1.0 for line in curves) == [0.3, 1.0]
    for line in curves:
        depth = eye @ np.array(line.get_data_3d(), dtype=float)
        depth = depth[np.isfinite(depth)]
        assert len(depth) > 20
        assert np.mean((depth < 0) == (line.get_alpha() is not None)) > 0.9


def test_three_coordinates_elsewhere_have_no_sphere() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(2, 1)), [0.5, 0.25, 1.0])
    made = lh.integrate(field, (0, 1), [0.0, 0.0, 1.0], dt=0.1)
    figure = plot_trajectory(made)
    assert not any("|m|" in text for text in texts(figure))
    assert holds(plot_trajectory(made, show="steps"), made.y)
    assert misses(figure, made.y) < 1e-12


def test_two_coordinates_in_the_plane() -> None:
    made = solution(2)
    figure = plot_trajectory(made)
    assert holds(plot_trajectory(made, show="steps"), made.y)
    assert misses(figure, made.y) < 1e-12
    assert figure.axes[0].get_aspect() == 1
    assert (figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()) == ("$m_0$", "$m_1$")


@pytest.mark.parametrize("size", [4, 5])
def test_more_coordinates_over_time(size: int) -> None:
    made = solution(size)
    figure = plot_trajectory(made)
    for values in made.y:
        assert holds(plot_trajectory(made, show="steps"), np.array([made.t, values]))
        assert misses(figure, np.array([made.t, values])) < 1e-12
    assert figure.axes[0].get_xlabel() == "time $t$"
    assert f"$m_{size - 1}$" in texts(figure)


def test_many_coordinates_as_colours() -> None:
    made = lh.integrate(rotation(9), (0, 1), np.eye(9)[0], dt=0.1)
    assert np.allclose(np.asarray(plot_trajectory(made).axes[0].collections[0].get_array()).reshape(9, -1), made.y)


def test_dense_output_is_drawn_finely() -> None:
    made = lh.integrate(rotation(2), (0, 3), [1.0, 0.0], dt=1.0, dense_output=True)
    curve = max(lines(plot_trajectory(made)), key=lambda line: line.shape[1])
    assert curve.shape[1] > 100
    assert np.abs(np.linalg.norm(curve, axis=0) - 1).max() < 1e-12
    back = lh.integrate(rotation(2), (3, 0), [1.0, 0.0], dt=1.0, dense_output=True)
    assert np.allclose(max(lines(plot_trajectory(back)), key=lambda line: line.shape[1])[:, 0], [1, 0])


def furthest_from_the_circle(sol: lh.Solution, show: str = "curve") -> float:
    """How far midpoints of the segments that are drawn are from the unit circle: 0.12 for a chord of 1 radian."""
    curve = max(lines(plot_trajectory(sol, show=show)), key=lambda line: line.shape[1]).astype(float)
    return float(np.abs(np.linalg.norm((curve[:, 1:] + curve[:, :-1]) / 2, axis=0) - 1).max())


def test_curves_follow_the_method_between_steps() -> None:
    """With a step of 1 radian the chord would be 0.12 away; and the angle is the one of the step, not of a spline."""
    sol = lh.integrate(rotation(2), (0, 6), [1.0, 0.0], dt=1.0)
    assert sol.sol is None
    assert furthest_from_the_circle(sol) < 1e-4
    turned = max(lines(plot_trajectory(sol, over_time=True)), key=lambda line: line.shape[1]).astype(float)
    assert np.abs(turned[1] - np.cos(turned[0])).max() < 1e-12
    assert furthest_from_the_circle(sol, "steps") > 0.1  # a control


def test_curves_of_files_and_of_output_times_are_splines_on_the_sphere(tmp_path: Path) -> None:
    sol = lh.integrate(rotation(2), (0, 6), [1.0, 0.0], dt=0.5)
    sol.save(tmp_path / "sol.npz")
    sampled = lh.integrate(rotation(2), (6, 0), [1.0, 0.0], t_eval=np.arange(6.0, -0.1, -0.5))
    for made in (lh.Solution.load(tmp_path / "sol.npz"), sampled, pickle.loads(pickle.dumps(sol))):
        assert furthest_from_the_circle(made) < 1e-4
        angle = max(lines(plot_trajectory(made, over_time=True)), key=lambda line: line.shape[1]).astype(float)
        assert np.abs(angle[1] - np.cos(angle[0] - made.t[0])).max() < 2e-3
        assert misses(plot_trajectory(made), made.y) < 1e-12


def test_long_runs_have_a_limit_of_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.import_module("liehom.plotting.trajectory_plot"), "MAX_POINTS", 1000)
    figure = plot_trajectory(lh.integrate(rotation(2), (0, 25), [1.0, 0.0], dt=0.01, step=lh.Euler()))
    assert max(line.shape[1] for line in lines(figure)) <= 1001
    assert "one of 3 steps" in figure.axes[0].get_title(loc="left")


def test_chosen_coordinates_and_markers() -> None:
    made = solution(5)
    figure = plot_trajectory(made, coordinates=(4, 1))
    assert misses(figure, made.y[[4, 1]]) < 1e-12
    assert (figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()) == ("$m_4$", "$m_1$")
    assert plot_trajectory(made, coordinates=(0, 1, 2)).axes[0].name == "3d"
    both = plot_trajectory(made, coordinates=(4, 1), show="both")
    assert holds(both, made.y[[4, 1]]) and not holds(figure, made.y[[4, 1]])


def test_axes_of_the_caller_in_space_and_in_the_plane() -> None:
    made = solution(3)
    whole = Figure()
    solid, flat = whole.add_subplot(1, 2, 1, projection="3d"), whole.add_subplot(1, 2, 2)
    assert plot_trajectory(made, ax=solid) is whole
    assert plot_trajectory(made, ax=flat) is whole
    drawn = np.concatenate([np.array(line.get_data(), dtype=float) for line in flat.lines], axis=1)
    assert np.nanmax(np.hypot(*drawn)) == pytest.approx(1.15, abs=0.1)  # the sphere and the ends of its axes


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"show": "dots"}, "'both'"),
        ({"coordinates": (0, 3)}, "from 0 to 2"),
        ({"coordinates": (0, -1)}, "from 0 to 2"),
        ({"coordinates": ()}, "from 0 to 2"),
    ],
)
def test_wrong_options_of_plot_trajectory_raise(options: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        plot_trajectory(solution(3), **options)


@pytest.mark.parametrize(("size", "dense"), [(2, False), (3, True), (4, False), (9, False)])
def test_ensembles(size: int, dense: bool) -> None:
    title = plot_trajectory(solution(size, (2, 30), end=0.3, dense_output=dense)).axes[0].get_title(loc="left")
    assert "of 60 trajectories" in title
    assert ("first 1" if size == 9 else "first 50") in title


@pytest.mark.parametrize("dense", [False, True])
@pytest.mark.parametrize("size", [2, 3, 4])
def test_trajectories_of_different_length(size: int, dense: bool) -> None:
    """Adapted steps fill up with NaN; events end trajectories early."""

    def event(t: Any, y: Any) -> Any:
        return y[..., 0] - 0.1

    event.terminal = True  # type: ignore[attr-defined]
    made = lh.integrate(rotation(size), (0, 4), np.eye(size)[:2] * [[1.0], [2.0]], events=event, dense_output=dense)
    assert np.isnan(made.t).any() and not np.isnan(made.t[..., :2]).any()
    assert all(np.isfinite(line.astype(float)[:, 0]).all() for line in lines(plot_trajectory(made)))


def test_a_solution_without_a_step() -> None:
    for size in (2, 3, 4, 9):
        plot_trajectory(lh.integrate(rotation(size), (0, 0), np.eye(size)[0], dense_output=True))


def test_plot_trajectory_raises_for_other_objects() -> None:
    for empty in (lh.integrate(rotation(3), (0, 1), np.zeros((0, 3))), solution(3, t_eval=[])):
        with pytest.raises(InputError, match="no point"):
            plot_trajectory(empty)
    with pytest.raises(InputError, match="solution"):
        plot_trajectory(np.zeros((3, 4)))  # type: ignore[arg-type]


def test_list_of_solutions_is_sent_to_one_call_of_integrate() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    solutions = [lh.integrate(field, (0, 1), start, dt=0.5) for start in ([1, 0, 0], [0, 1, 0])]
    with pytest.raises(InputError, match=r"give integrate initial points \(k, N\)"):
        lh.plotting.plot_trajectory(solutions)  # type: ignore[arg-type]


# -- files and settings ----------------------------------------------------------------------------------
@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_equal_plots_are_equal_files(suffix: str, tmp_path: Path) -> None:
    made = solution(3)
    for draw in (lambda path: plot_trajectory(made, path), lambda path: plot_convergence(table(), path)):
        first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
        draw(first)
        draw(str(second))
        assert first.read_bytes() == second.read_bytes()
        assert first.stat().st_size > 1000


@pytest.mark.parametrize("name", ["picture.txt", "picture", "no/such/folder/picture.png", ""])
def test_names_without_a_plot_suffix_raise(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FormatError):
        plot_convergence(table(), name)
    assert not list(tmp_path.iterdir())


def test_settings_of_matplotlib_stay() -> None:
    before = dict(matplotlib.rcParams)
    plot_convergence(table())
    plot_trajectory(solution(3))
    assert dict(matplotlib.rcParams) == before


def test_no_backend_is_chosen_and_nothing_is_loaded_early() -> None:
    code = (
        "import sys, liehom.plotting; assert 'matplotlib' not in sys.modules\n"
        "import liehom as lh\n"
        "field = lh.GeneratorField(lh.defining(lh.so(2)), [1])\n"
        "liehom.plotting.plot_trajectory(lh.integrate(field, (0, 1), [1.0, 0.0], dt=0.5))\n"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str, package: str | None = None) -> Any:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(importlib.import_module("liehom.plotting.canvas"), "import_module", missing)
    for draw in (lambda: plot_convergence(table()), lambda: plot_trajectory(solution(2))):
        with pytest.raises(InputError, match="pip install matplotlib"):
            draw()


# -- notebooks -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("picture", ["figure", "axes", "axes in space"])
def test_a_notebook_shows_figures_and_axes_as_pictures(picture: str) -> None:
    formatters = pytest.importorskip("IPython.core.formatters")
    shown = {
        "figure": lambda: plot_trajectory(solution(2)),
        "axes": lambda: lh.plotting.plot_dynkin("G2"),
        "axes in space": lambda: lh.plotting.plot_root_system("A3"),
    }[picture]()
    data, _ = formatters.DisplayFormatter().format(shown)
    assert data["image/svg+xml"].count("<svg") == 1
    assert pickle.loads(pickle.dumps(shown))._repr_svg_().count("<svg") == 1


def test_axes_of_the_caller_are_shown_as_the_caller_shows_them() -> None:
    ax = Figure().add_subplot()
    assert lh.plotting.plot_dynkin("G2", ax) is ax
    assert not hasattr(ax, "_repr_svg_")


def test_axes_of_another_kind_are_refused() -> None:
    flat, solid = new_figure(2, 2).add_subplot(), new_figure(2, 2).add_subplot(projection="3d")
    polar = new_figure(2, 2).add_subplot(projection="polar")
    sol = solution(3)
    for ax, options in ((solid, {"over_time": True}), (solid, {"coordinates": (0, 1)}), (polar, {}), (flat.figure, {})):
        with pytest.raises(InputError, match="axes"):
            plot_trajectory(sol, ax=ax, **options)
    for ax in (solid, polar):
        with pytest.raises(InputError, match="axes"):
            plot_convergence(table(), axes=ax)
        with pytest.raises(InputError, match="axes"):
            plot_trajectory(solution(9), ax=ax)


def test_axes_in_a_subfigure_give_the_whole_figure(tmp_path: Path) -> None:
    whole = new_figure(8, 4)
    assert plot_trajectory(solution(2), tmp_path / "part.svg", ax=whole.subfigures(1, 2)[0].add_subplot()) is whole


@pytest.mark.parametrize("suffix", [".JPG", ".webp", ".tiff", ".eps"])
def test_formats_without_metadata_are_written(suffix: str, tmp_path: Path) -> None:
    plot_trajectory(solution(2), tmp_path / f"curve{suffix}")
    assert (tmp_path / f"curve{suffix}").stat().st_size > 1000


def test_names_that_are_too_long_are_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="too long"):
        plot_trajectory(solution(2), tmp_path / f"{'x' * 300}.png")


def test_small_spheres_are_spheres() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), [1, 2, 3])
    figure = plot_trajectory(lh.integrate(field, (0, 1), [1e-6, 0.0, 0.0], dt=0.1))
    assert "$|m|$ = 1e-06" in figure.axes[0].get_title(loc="left")


def test_coordinates_are_integers_of_any_kind() -> None:
    sol = solution(3)
    assert holds(plot_trajectory(sol, coordinates=np.array([2, 0]), show="steps"), sol.y[[2, 0]])
    with pytest.raises(InputError, match="coordinates are indices"):
        plot_trajectory(sol, coordinates=1)  # type: ignore[arg-type]


def test_tables_on_dark_pages_have_light_lines() -> None:
    with style(dark=True):
        figure = plot_convergence(table())
    assert {line.get_color() for line in figure.axes[0].lines} & set(DARK_COLOURS)


def test_no_triangle_for_errors_that_do_not_decrease() -> None:
    flat = table(orbit_errors=(1e-3,) * 4, trajectory_errors=(NAN,) * 4)
    assert not plot_convergence(flat).axes[0].patches


def test_errors_that_are_zero_are_left_out() -> None:
    axes = plot_convergence(table(orbit_errors=(1e-3, 0.0, 1e-5, 0.0), trajectory_errors=(0.0,) * 4)).axes[0]
    (line,) = (line for line in axes.lines if np.isfinite(line.get_xdata()).any())
    assert [*zip(line.get_xdata(), line.get_ydata(), strict=True)] == [(0.05, 1e-5), (0.2, 1e-3)]


def test_an_error_of_the_size_of_its_floor_has_an_open_marker() -> None:
    made = table(orbit_errors=(1e-3, 1e-4, 1e-5, 1e-6), trajectory_errors=(NAN,) * 4, floors=(1e-6,) * 4)
    axes = plot_convergence(made).axes[0]
    assert [line.get_ydata().tolist() for line in axes.lines if line.get_linestyle() == "None"] == [[1e-6]]
    assert [1e-5, 1e-4, 1e-3] in [line.get_ydata().tolist() for line in axes.lines]


@pytest.mark.parametrize(("errors", "lowest"), [([0.9, 0.0], 0.05), ([0.1, 0.9], 0.03), ([NAN, 0.1], 0.03)])
def test_the_floor_is_shaded_down_to_the_smallest_error(errors: list[float], lowest: float) -> None:
    axes = new_figure(3, 3).add_subplot()
    draw_floor(axes, 1.0, errors)
    (patch,) = axes.patches
    assert np.allclose([patch.get_y(), patch.get_y() + patch.get_height()], [lowest, 1.0])


def test_eight_coordinates_are_curves_and_nine_are_colors() -> None:
    eight, nine = (plot_trajectory(solution(size)).axes[0] for size in (8, 9))
    assert (len(eight.lines), len(eight.collections)) == (8, 0)
    assert (len(nine.lines), len(nine.collections)) == (0, 1)


def test_steps_are_made_again_for_few_short_runs_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trajectory_plot, "MAX_STEPS_MADE", 6)
    monkeypatch.setattr(trajectory_plot, "MAX_TRAJECTORIES", 2)
    for end, count, exact in ((6, 1, True), (7, 1, False), (6, 2, True), (6, 3, False)):
        made = curves_of(lh.integrate(rotation(2), (0, end), [[1.0, 0.0]] * count, dt=1.0))
        assert bool(np.abs(made.y[0, 0] - np.cos(made.t[0])).max() < 1e-12) is exact


def test_times_of_trajectories_that_end_early_cover_the_longest() -> None:
    ahead = np.array([[0.0, 1.0, NAN], [0.0, 1.0, 2.0]])
    for times, first, last in ((ahead, 0.0, 2.0), (5 - ahead, 5.0, 3.0)):
        fine = trajectory_plot._times(times)
        assert (fine[0], fine[-1], len(fine)) == (first, last, 400)
    assert len(trajectory_plot._times(np.arange(300.0)[None])) == 2 * 299 + 1
    same = trajectory_plot._times(np.array([[0.0, 1.0, 3.0]] * 2))
    assert np.allclose(same, np.r_[np.linspace(0, 1, 133, endpoint=False), np.linspace(1, 3, 134)])


def test_splines_have_the_points_and_the_parts() -> None:
    t = np.array([0.0, 1.0, 2.0, 3.0])
    for parts in (1, 2, 5):
        times, points = trajectory_plot._splined(t, np.array([t**2, t]), parts)
        assert np.allclose(times, np.linspace(0, 3, 3 * parts + 1)) and np.allclose(points, [times**2, times])
    times, points = trajectory_plot._splined(np.array([0.0, NAN]), np.array([[1.0, NAN]]), 2)
    assert times[0] == 0 and points[0, 0] == 1 and np.isnan(times[1:]).all() and np.isnan(points[0, 1:]).all()


def test_the_title_has_the_times_of_the_first_trajectory() -> None:
    def event(t: Any, y: Any) -> Any:
        return y[..., 0] - 0.5

    event.terminal = True  # type: ignore[attr-defined]
    made = lh.integrate(rotation(2), (0, 2), [[1.0, 0.0], [0.1, 0.0]], events=event)
    title = plot_trajectory(made).axes[0].get_title(loc="left")
    assert f"$t$ = 0 to {np.pi / 3:.4g}" in title
    assert np.isfinite(made.t[1]).sum() > 0 and np.nanmax(made.t[1]) == 2


def test_a_picture_within_a_page_has_no_background_and_no_warning() -> None:
    def draw() -> Any:
        ax = new_figure(2, 2).add_subplot()
        ax.text(0.5, 0.5, "\U00013000")  # no font of matplotlib has it
        return ax

    text = inline_svg(draw, "part")
    assert text.startswith("<svg ") and "\U00013000" in text
    background = text[text.index('id="part-patch_1"') :]
    assert "opacity: 0" in background[: background.index("/>")]


def test_colors_reach_from_the_largest_value_to_its_negative() -> None:
    for size in (1e-3, 50.0):
        made = lh.integrate(rotation(9), (0, 1), size * np.eye(9)[0], dt=0.1)
        assert np.allclose(plot_trajectory(made).axes[0].collections[0].get_clim(), (-size, size))


@pytest.mark.parametrize("count", [7, 8])
def test_up_to_seven_step_sizes_are_ticks(count: int) -> None:
    sizes = tuple(0.3 / (k + 1) for k in range(count))
    errors = tuple(h**2 for h in sizes)
    made = table(dts=sizes, orbit_errors=errors, trajectory_errors=errors, floors=(1e-14,) * count)
    labels = [text.get_text() for text in plot_convergence(made).axes[0].get_xticklabels()]
    assert (labels == [f"{h:.4g}" for h in sorted(sizes)]) is (count == 7)


def test_gray_text_is_not_that_of_a_dark_page() -> None:
    for gray, colours in (("0.5", COLOURS), ("0.51", DARK_COLOURS)):
        with matplotlib.rc_context({"text.color": gray}):
            assert current_colours() == colours
