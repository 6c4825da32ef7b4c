"""Pictures of the start page and of the first steps: orbits of the free rigid body on the sphere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.plotting.canvas import new_figure
from liehom.plotting.phase_plot import AZIMUTH, ELEVATION, Scene, space_axes, sphere
from pictures import picture

FIELD = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))
ANGLES = np.radians([9.0, 17.0, 66.0])
STARTS = np.stack([np.sin(ANGLES), 0 * ANGLES, np.cos(ANGLES)], axis=-1)


@picture
def orbits_on_the_sphere(colours: Sequence[str]) -> Any:
    """Left Euler's step, right the same step corrected to order 4; the exact orbits are thin."""
    times = np.linspace(0, 30, 500)
    exact = lh.integrate(FIELD, (0, 30), STARTS, t_eval=times, rtol=1e-8).y
    figure = new_figure(5.6, 3.05)
    steps = {"Euler()": lh.Euler(), "Corrected(Euler(), order=4)": lh.Corrected(lh.Euler(), order=4)}
    for axes, (title, step) in zip(figure.subplots(1, 2), steps.items(), strict=True):
        # the viewer is between the axes of the least and largest moment of inertia
        scene, ball = Scene(space_axes(axes), elevation=50, azimuth=22), sphere(1.0)
        ball.draw(scene)
        axes.set(xlim=(-1.03, 1.03), ylim=(-1.03, 1.03), aspect="equal")
        found = lh.integrate(FIELD, (0, 30), STARTS, step=step, dt=0.25, t_eval=times).y
        for k, colour in enumerate(colours[:3]):
            scene.curve(ball, found[k], color=colour, linewidth=1.3)
            scene.curve(ball, exact[k], color=colours[6], linewidth=0.8, zorder=2)
            scene.mark(ball, STARTS[k], "o", color=colour, markersize=4)
        axes.set_title(title, loc="center")
    return figure


@picture
def first_orbit(colours: Sequence[str]) -> Any:
    """The picture of the last block of the first steps, in the colours of the page."""
    sol = lh.integrate(FIELD, (0, 30), [0.8, 0.0, 0.6], step=lh.Corrected(lh.Euler(), order=4), dt=0.25)
    figure = new_figure(4.2, 4.4)
    lh.plotting.plot_trajectory(sol, ax=figure.add_subplot(projection="3d", elev=ELEVATION, azim=AZIMUTH))
    return figure
