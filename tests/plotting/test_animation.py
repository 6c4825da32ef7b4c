"""Animations: the points of the frames, files as a whole, pages without the network, interruptions, what is refused."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh

pytest.importorskip("matplotlib")
pytest.importorskip("PIL")

from PIL import Image

from liehom.base.errors import FormatError, InputError
from liehom.plotting.canvas import new_figure
from liehom.plotting.trajectory_plot import _frames, animate_trajectory, stage

SPIN = lh.GeneratorField(lh.defining(lh.so(2)), [1])
SOL = lh.integrate(SPIN, (0, 3), [1.0, 0.0], dt=0.5)


def small() -> Any:
    return new_figure(1.2, 1.2).add_subplot()


def test_the_point_is_the_solution_at_the_time_of_the_frame() -> None:
    (actor,) = stage(SOL, ax=small())
    for fraction in (0.0, 0.37, 1.0):
        tail, hidden, dot = actor.move(fraction)
        place = np.array(dot.get_data(), dtype=float)[:, 0]
        assert np.abs(place - [np.cos(3 * fraction), np.sin(3 * fraction)]).max() < 1e-5
        assert np.allclose(np.array(tail.get_data(), dtype=float)[:, -1], place)
        assert not np.isfinite(np.array(hidden.get_data(), dtype=float)).any()


def test_points_behind_the_sphere_are_faint() -> None:
    sol = lh.integrate(lh.GeneratorField(lh.adjoint(lh.so(3)), [0, 0, 1]), (0, 2 * np.pi), [1.0, 0.0, 0.0], dt=0.5)
    (actor,) = stage(sol, ax=new_figure(2, 2).add_subplot(projection="3d", elev=10, azim=0))
    assert [actor.move(fraction)[2].get_alpha() for fraction in (0.0, 0.5, 1.0)] == [1.0, 0.3, 1.0]


@pytest.mark.parametrize("suffix", [".gif", ".html"])
def test_files_have_all_frames_and_progress_is_reported(suffix: str, tmp_path: Path) -> None:
    seen: list[float] = []
    file = tmp_path / f"orbit{suffix}"
    animate_trajectory(SOL, file, seconds=0.4, fps=10, ax=small(), progress=seen.append)
    assert seen[-1] == 1.0 and seen == sorted(seen)
    assert [path.name for path in tmp_path.iterdir()] == [file.name]
    if suffix == ".gif":
        with Image.open(file) as made:
            assert made.n_frames == 4 and made.info["duration"] == 100 and made.info["loop"] == 0
            first = np.asarray(made.convert("RGB"), dtype=int)
            made.seek(2)
            assert np.abs(np.asarray(made.convert("RGB"), dtype=int) - first).max() > 50  # something has moved
        return
    text = file.read_text(encoding="utf-8")
    assert text.count("data:image/png;base64") == 4
    assert not re.search(r"https?://|<link|fa-", text)
    assert text.startswith("<!doctype html>") and "<title>orbit</title>" in text


@pytest.mark.parametrize("suffix", [".gif", ".html"])
def test_an_interruption_leaves_the_file_that_was_there(suffix: str, tmp_path: Path) -> None:
    def interrupt(fraction: float) -> None:
        if fraction > 0.5:
            raise KeyboardInterrupt

    file, missing = tmp_path / f"old{suffix}", tmp_path / f"new{suffix}"
    file.write_bytes(b"before")
    for path in (file, missing):
        with pytest.raises(KeyboardInterrupt):
            animate_trajectory(SOL, path, seconds=0.3, fps=10, ax=small(), progress=interrupt)
    assert [path.name for path in tmp_path.iterdir()] == [file.name] and file.read_bytes() == b"before"


def test_coordinates_over_time_and_chosen_ones() -> None:
    sol = lh.integrate(lh.GeneratorField(lh.defining(lh.so(4)), np.arange(1.0, 7)), (0, 1), np.eye(4)[0], dt=0.1)
    actors = stage(sol, ax=small())
    assert len(actors) == 4
    for i, actor in enumerate(actors):
        assert np.allclose(np.array(actor.move(1.0)[2].get_data(), dtype=float)[:, 0], [1.0, sol.y[i, -1]])
    (actor,) = stage(sol, (3, 1), ax=small())
    assert np.allclose(np.array(actor.move(1.0)[2].get_data(), dtype=float)[:, 0], sol.y[[3, 1], -1])


def test_only_pictures_over_time_have_scales_of_their_own() -> None:
    sol = lh.integrate(lh.GeneratorField(lh.defining(lh.so(4)), np.arange(1.0, 7)), (0, 1), np.eye(4)[0], dt=0.1)
    assert stage(sol, ax=small())[0].scene.axes.get_aspect() == "auto"
    assert stage(sol, (3, 1), ax=small())[0].scene.axes.get_aspect() == 1.0
    assert stage(sol, (3, 1), over_time=True, ax=small())[0].scene.axes.get_aspect() == "auto"


def test_the_time_of_an_animation_is_that_of_the_run() -> None:
    sol = lh.integrate(SPIN, (2, 3.5), [1.0, 0.0], dt=0.5)
    for options in ({}, {"over_time": True}):
        actors = stage(sol, ax=small(), **options)
        assert [actor.span for actor in actors] == [1.5] * len(actors)


def test_points_without_a_surface_fill_the_window() -> None:
    sol = lh.integrate(lh.GeneratorField(lh.defining(lh.so(4)), np.arange(1.0, 7)), (0, 3), np.eye(4)[0], dt=0.1)
    for axes in (small(), new_figure(2, 2).add_subplot(projection="3d")):
        scene = stage(sol, (0, 1, 2), ax=axes)[0].scene
        points = sol.y[:3]
        low, high = points.min(axis=1), points.max(axis=1)
        half, middle = (high - low).max() / 2, (low + high) / 2
        if scene.solid:
            window = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
            assert np.allclose(window.mean(axis=1), middle, atol=0.02)
            assert np.allclose(np.diff(window), 2.1 * half, rtol=0.02)
        else:
            window, seen = np.array([axes.get_xlim(), axes.get_ylim()]), scene.screen @ points
            assert (window[:, 0] <= seen.min(axis=1)).all() and (seen.max(axis=1) <= window[:, 1]).all()
            assert np.allclose(window.mean(axis=1), scene.screen @ middle, atol=0.02)


@pytest.mark.parametrize(
    ("options", "error", "match"),
    [
        ({"path": "orbit.mp4"}, FormatError, ".gif or .html"),
        ({"path": "no/such/folder/orbit.gif"}, FormatError, "does not exist"),
        ({"fps": 0}, InputError, "frames"),
        ({"seconds": 1e9}, InputError, "5000"),
        ({"seconds": float("nan")}, InputError, "frames"),
        ({"coordinates": (0, 2)}, InputError, "from 0 to 1"),
    ],
)
def test_wrong_arguments_raise_before_the_work(
    options: Any, error: type[Exception], match: str, tmp_path: Path
) -> None:
    with pytest.raises(error, match=match):
        animate_trajectory(SOL, **options)


def test_many_coordinates_must_be_chosen() -> None:
    field = lh.GeneratorField(lh.defining(lh.so(9)), np.arange(1.0, 37))
    with pytest.raises(InputError, match="up to 8 coordinates"):
        stage(lh.integrate(field, (0, 1), np.eye(9)[0], dt=0.5))


@pytest.mark.parametrize("options", [{"seconds": "a"}, {"fps": "20"}, {"fps": 1j}, {"seconds": None}])
def test_lengths_that_are_not_numbers_are_refused(options: Any) -> None:
    with pytest.raises(InputError, match="expected numbers"):
        animate_trajectory(SOL, **options)


def test_coordinates_over_time_are_not_in_space() -> None:
    with pytest.raises(InputError, match="axes in the plane"):
        animate_trajectory(SOL, ax=new_figure(2, 2).add_subplot(projection="3d"))


def test_the_number_of_frames_and_their_rate_are_bounded() -> None:
    for seconds, fps in ((0.02, 100), (50, 100), (0.1, 20), (5000, 1)):
        assert _frames(seconds, fps) == round(seconds * fps)
    for seconds, fps in ((1, 101), (50.01, 100), (0.019, 100), (1, -2)):
        with pytest.raises(InputError, match="from 2 to 5000"):
            _frames(seconds, fps)


def test_frames_are_evenly_spread_over_the_time() -> None:
    animation = animate_trajectory(SOL, seconds=0.5, fps=10, ax=small())
    for frame in range(5):
        dot = animation._func(frame)[2]  # type: ignore[attr-defined]
        angle = 3 * frame / 4
        assert np.allclose(np.array(dot.get_data(), dtype=float)[:, 0], [np.cos(angle), np.sin(angle)], atol=1e-5)
    animation._draw_was_started = True  # type: ignore[attr-defined]


def test_progress_is_shown_on_a_terminal(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = []
    for terminal in (False, True):
        monkeypatch.setattr("sys.stderr.isatty", lambda answer=terminal: answer)
        animate_trajectory(SOL, tmp_path / "orbit.gif", seconds=0.3, fps=10, ax=small())
        shown.append(capsys.readouterr().err)
    assert not shown[0] and "drawing" in shown[1] and "100%" in shown[1]


def test_a_point_stays_where_its_trajectory_ends_early() -> None:
    def event(t: Any, y: Any) -> Any:
        return y[..., 0] - 0.5

    event.terminal = True  # type: ignore[attr-defined]
    made = lh.integrate(SPIN, (0, 2), [[1.0, 0.0], [0.1, 0.0]], events=event)
    actors = stage(made, ax=small())
    for actor, end in zip(actors, ([0.5, 0.75**0.5], [0.1 * np.cos(2), 0.1 * np.sin(2)]), strict=True):
        assert np.isfinite(actor.points).all()
        assert np.allclose(np.array(actor.move(1.0)[2].get_data(), dtype=float)[:, 0], end, atol=5e-3)
