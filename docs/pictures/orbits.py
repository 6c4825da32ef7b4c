"""Pictures of the start page and of the first steps: orbits of the free rigid body on the sphere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.plotting.canvas import GREY, new_figure
from liehom.plotting.surfaces import AZIMUTH, ELEVATION
from pictures import picture

FIELD = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))
# towards the viewer, to the right and up: the viewer is between the axes of the least and largest moment of inertia
EYE = np.array([0.60, 0.25, 0.76]) / np.linalg.norm([0.60, 0.25, 0.76])
RIGHT = np.cross([0.0, 1.0, 0.0], EYE) / np.linalg.norm(np.cross([0.0, 1.0, 0.0], EYE))
SCREEN = np.array([RIGHT, np.cross(EYE, RIGHT)])
ANGLES = np.radians([9.0, 17.0, 66.0])
STARTS = np.stack([np.sin(ANGLES), 0 * ANGLES, np.cos(ANGLES)], axis=-1)


def _curve(axes: Any, points: Any, **look: Any) -> None:
    """A curve on the sphere as the viewer sees it; the parts behind the sphere are left out."""
    axes.plot(*(SCREEN @ np.where(EYE @ points >= 0, points, np.nan)), **look)


def _sphere(axes: Any) -> None:
    """The disc of the sphere with circles of latitude and longitude."""
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.fill(np.cos(turn), np.sin(turn), facecolor=GREY, alpha=0.10, linewidth=0, zorder=0)
    axes.plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=0.8, zorder=0)
    for z in np.sin(np.radians([-60, -30, 0, 30, 60])):
        radius = np.sqrt(1 - z * z)
        circle = np.array([radius * np.cos(turn), radius * np.sin(turn), z + 0 * turn])
        _curve(axes, circle, color=GREY, linewidth=0.6, alpha=0.45, zorder=1)
    for angle in np.radians(np.arange(0, 180, 30)):
        circle = np.array([np.cos(angle) * np.sin(turn), np.sin(angle) * np.sin(turn), np.cos(turn)])
        _curve(axes, circle, color=GREY, linewidth=0.6, alpha=0.45, zorder=1)


@picture
def orbits_on_the_sphere(colours: Sequence[str]) -> Any:
    """Left Euler's step, right the same step corrected to order 4; the exact orbits are thin."""
    times = np.linspace(0, 30, 500)
    exact = lh.integrate(FIELD, (0, 30), STARTS, t_eval=times, rtol=1e-8).y
    figure = new_figure(5.6, 3.05)
    steps = {"Euler()": lh.Euler(), "Corrected(Euler(), order=4)": lh.Corrected(lh.Euler(), order=4)}
    for axes, (title, step) in zip(figure.subplots(1, 2), steps.items(), strict=True):
        _sphere(axes)
        found = lh.integrate(FIELD, (0, 30), STARTS, step=step, dt=0.25, t_eval=times).y
        for k, colour in enumerate(colours[:3]):
            _curve(axes, found[k], color=colour, linewidth=1.3)
            _curve(axes, exact[k], color=colours[6], linewidth=0.8, zorder=1.5)
            axes.plot(*(SCREEN @ STARTS[k]), "o", color=colour, markersize=4)
        axes.set_title(title, loc="center")
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure


@picture
def first_orbit(colours: Sequence[str]) -> Any:
    """The picture of the last block of the first steps, in the colours of the page."""
    sol = lh.integrate(FIELD, (0, 30), [0.8, 0.0, 0.6], step=lh.Corrected(lh.Euler(), order=4), dt=0.25)
    figure = new_figure(4.2, 4.4)
    lh.plotting.plot_trajectory(sol, ax=figure.add_subplot(projection="3d", elev=ELEVATION, azim=AZIMUTH))
    return figure
