"""Animations of trajectories, in memory or as a GIF or an HTML page."""

from __future__ import annotations

import html
import os
import re
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liehom.disk import check_target, write_file
from liehom.errors import FormatError, InputError, displayed
from liehom.integrators import Solution
from liehom.integrators.run.progress import Progress
from liehom.plotting.canvas import matplotlib_module, style_unless
from liehom.plotting.curves import curves_of
from liehom.plotting.surfaces import FAINT, AnyAxes, Quadric, Scene, only
from liehom.plotting.trajectory_plot import MAX_LINES, chosen_coordinates, draw_scenery, look
from liehom.typing import Array

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

MAX_TRAJECTORIES = 10
SUFFIXES = (".gif", ".html")
DPI = 100
TAIL = 0.25
"""The bright part of a curve, as a fraction of the time span."""
SYMBOLS = {
    "fa fa-minus": "\N{MINUS SIGN}",
    "fa fa-fast-backward": "|\N{BLACK LEFT-POINTING POINTER}",
    "fa fa-step-backward": "\N{LEFT-POINTING ANGLE BRACKET}",
    "fa fa-play fa-flip-horizontal": "\N{BLACK LEFT-POINTING POINTER}",
    "fa fa-pause": "||",
    "fa fa-play": "\N{BLACK RIGHT-POINTING POINTER}",
    "fa fa-step-forward": "\N{RIGHT-POINTING ANGLE BRACKET}",
    "fa fa-fast-forward": "\N{BLACK RIGHT-POINTING POINTER}|",
    "fa fa-plus": "+",
}


def animate_trajectory(
    solution: Solution,
    path: str | os.PathLike[str] | None = None,
    *,
    seconds: float = 6.0,
    fps: int = 20,
    coordinates: Sequence[int] | None = None,
    over_time: bool = False,
    ax: Axes | None = None,
    progress: bool | Callable[[float], object] | None = None,
) -> FuncAnimation:
    """Animation of a solution of `integrate`: points that move along the trajectories, at most 10 of them.

    Parameters
    ----------
    solution : Solution
    path : path, optional
        File to write: .gif, or .html for a page with buttons that needs no other file and no network.
    seconds : float, optional
        Length of the animation, in which the whole time span passes.
    fps : int, optional
        Frames in a second.
    coordinates, over_time, ax
        As for `plot_trajectory`. For more than three coordinates, they are drawn over time.
    progress : bool or callable, optional
        Whether to show the progress of writing on standard error, by default if that is a terminal; or a function of
        the fraction done.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        In a notebook, ``IPython.display.HTML(animation.to_jshtml())`` shows it.

    Raises
    ------
    InputError
        If matplotlib is not installed, or an argument is not of this kind.
    FormatError
        If the path has another suffix, or cannot be written.

    Notes
    -----
    Curves are those of `plot_trajectory`. A file is written as a whole: an interrupted call leaves no file, or the one
    that was there before.

    Examples
    --------
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8])
    >>> animation = animate_trajectory(sol, "polhode.gif")  # doctest: +SKIP
    """
    target = None if path is None else _target(path)
    frames = _frames(seconds, fps)
    show = progress if progress is not None else target is not None and sys.stderr.isatty()
    with style_unless(ax):
        actors = stage(solution, coordinates, over_time=over_time, ax=ax)
    with Progress(show, "drawing") as report:

        def draw(frame: int) -> list[object]:
            report.update(lambda: (frame + 1) / frames, last=frame == frames - 1)
            return [line for actor in actors for line in actor.move(frame / (frames - 1))]

        made: FuncAnimation = matplotlib_module("animation").FuncAnimation(
            actors[0].scene.axes.figure, draw, frames=frames, interval=1000 / fps, blit=False
        )
        if target is not None:
            _write(made, target, fps)
    return made


def stage(
    solution: Solution, coordinates: Sequence[int] | None = None, *, over_time: bool = False, ax: Axes | None = None
) -> list[Actor]:
    """The trajectories of an animation, drawn in the axes with what does not move."""
    curves = curves_of(solution)
    chosen, names = chosen_coordinates(coordinates, curves.y.shape[1])
    if len(chosen) > MAX_LINES:
        raise InputError(f"an animation shows up to {MAX_LINES} coordinates, got {len(chosen)}: choose coordinates=")
    times, y = curves.t[:MAX_TRAJECTORIES], curves.y[:MAX_TRAJECTORIES][:, chosen]
    if over_time or len(chosen) not in (2, 3):
        # each coordinate is a curve in the plane of time and value
        y = np.stack([np.broadcast_to(times[:, None], y.shape), y], axis=2).reshape(-1, 2, y.shape[-1])
        times, names = np.repeat(times, len(chosen), axis=0), ["time $t$", "coordinates"]
    scene, surface = draw_scenery(y, names, ax)
    if names[0] == "time $t$":
        scene.axes.set_aspect("auto")
    span = float(np.nanmax(np.abs(times - times[:, :1])))
    cast = zip(times, y, strict=True)
    return [Actor(scene, surface, t, points, span, look(k, len(y))) for k, (t, points) in enumerate(cast)]


class Actor:
    """A trajectory of an animation: its whole curve, faint, its bright tail, and the point that moves.

    Parameters
    ----------
    scene : Scene
    surface : Quadric or None
        What hides parts of the curve.
    t : array of shape (n,)
    points : array of shape (2, n) or (3, n)
    span : float
        Time span of the animation.
    style : dict
        Color and width of the curve.
    """

    def __init__(
        self,
        scene: Scene,
        surface: Quadric | None,
        t: Array,
        points: Array,
        span: float,
        style: Mapping[str, object],
    ) -> None:
        there = np.isfinite(t) & np.isfinite(points).all(axis=0)
        self.scene, self.surface = scene, surface
        self.points: Array = points[:, there]
        self.passed: Array = np.abs(t[there] - t[there][0])
        self.span = span
        scene.plot(self.points, **{**style, "linewidth": 0.8, "alpha": FAINT, "zorder": 1})
        blank = self.points[:, :1] * np.nan
        self.lines: list[AnyAxes] = []
        for mark, more in (("-", {"linewidth": 2.2}), ("-", {"alpha": FAINT}), ("o", {"markersize": 8, "zorder": 5})):
            scene.plot(blank, mark, **{**style, **more})
            self.lines.append(scene.axes.lines[-1])

    def move(self, fraction: float) -> list[AnyAxes]:
        """Show the trajectory up to a fraction of the time span; returns the lines that have changed."""
        now = fraction * self.span
        place = np.array([np.interp(now, self.passed, x) for x in self.points])[:, None]
        tail = (self.passed > now - TAIL * self.span) & (self.passed <= now)
        points = np.concatenate([self.points[:, tail], place], axis=1)
        hidden = np.zeros(points.shape[1], dtype=bool)
        if self.surface is not None:
            hidden = self.surface.hidden(points, self.scene.eye)
        for line, part in zip(self.lines, (only(points, ~hidden), only(points, hidden), place), strict=True):
            self.scene.move(line, part)
        self.lines[2].set_alpha(FAINT if hidden[-1] else 1.0)
        return self.lines


def _frames(seconds: float, fps: int) -> int:
    numbers = all(isinstance(x, int | float | np.integer | np.floating) for x in (seconds, fps))
    if not numbers or not 0 < fps <= 100 or not 2 <= seconds * fps <= 5000:
        raise InputError(
            f"seconds is {displayed(seconds)} and fps is {displayed(fps)}, expected numbers with a product from 2 to "
            "5000, which is the number of frames, and fps at most 100"
        )
    return round(seconds * fps)


def _target(path: str | os.PathLike[str]) -> Path:
    """The file to write, checked before the work."""
    target = Path(os.fspath(path))
    if target.suffix.lower() not in SUFFIXES:
        raise FormatError(f"{os.fspath(path)!r} is not the name of an animation: it must end in .gif or .html")
    check_target(target, force=True)
    return target


def _write(animation: FuncAnimation, target: Path, fps: int) -> None:
    """Write a GIF or a page, as a whole or not at all."""
    if target.suffix.lower() == ".html":
        # no frame is left out, however large the page
        with matplotlib_module("").rc_context({"animation.embed_limit": 2.0**20, "savefig.dpi": DPI}):
            content = page(animation.to_jshtml(fps=fps), target.stem).encode()
    else:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "animation.gif"
            animation.save(file, writer=matplotlib_module("animation").PillowWriter(fps=fps), dpi=DPI)
            content = file.read_bytes()
    write_file(target, content)


def page(player: str, title: str) -> str:
    """A page with matplotlib's player, whose symbols are characters instead of a font from the network.

    Examples
    --------
    >>> "fa-play" in page('<link rel="stylesheet" href="https://example.org"> <i class="fa fa-play"></i>', "orbit")
    False
    """
    player = re.sub(r"<link [^>]*>", "", player)
    for name, symbol in SYMBOLS.items():
        player = player.replace(f'<i class="{name}"></i>', symbol)
    return (
        f'<!doctype html>\n<html lang="en">\n<head><meta charset="utf-8"><title>{html.escape(title)}</title></head>\n'
        f"<body>\n{player}\n</body>\n</html>\n"
    )
