"""Pictures of trajectories: between steps, phase portraits, on quadrics, their eigenvalues, and in motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.plotting.canvas import new_figure
from liehom.plotting.trajectory_plot import stage
from pictures import picture

BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / np.array([1.0, 2.0, 3.0]))
VIEW = {"projection": "3d", "elev": 22, "azim": 35}


@picture
def curve_between_steps(colours: Sequence[str]) -> Any:
    """Seven large steps, and the curve that the method draws between them."""
    sol = lh.integrate(BODY, (0, 14), [0.6, 0.0, 0.8], dt=2.0)
    figure = new_figure(4.4, 7.4)
    lh.plotting.plot_trajectory(sol, show="both", ax=figure.add_subplot(2, 1, 1, **VIEW))
    lh.plotting.plot_trajectory(sol, show="both", over_time=True, ax=figure.add_subplot(2, 1, 2))
    for axes in figure.axes:
        axes.set_title("", loc="left")
    return figure


@picture
def phase_portraits(colours: Sequence[str]) -> Any:
    """The free rigid body, and the same body with a torque that takes away energy."""

    def damped(m: Any) -> Any:
        velocity = m / np.array([1.0, 2.0, 3.0])
        return -velocity - np.cross(m, velocity) / 5

    figure = new_figure(6.4, 3.9)
    lh.plotting.plot_phase_portrait("m0**2/2 + m1**2/4 + m2**2/6", figure.add_subplot(1, 2, 1, **VIEW))
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), damped)
    lh.plotting.plot_phase_portrait(field, figure.add_subplot(1, 2, 2, **VIEW))
    figure.axes[0].set_title("free rigid body", loc="center")
    figure.axes[1].set_title("with damping", loc="center")
    return figure


@picture
def orbits_on_quadrics(colours: Sequence[str]) -> Any:
    """Orbits of SO(2,1) in space, a sheet of a hyperboloid, a cone, a hyperboloid of one sheet, and an ellipsoid."""
    rho = lh.defining(lh.so(2, 1))
    field = lh.GeneratorField(rho, [1.0, 0.3, 0.2])
    starts = {
        "timelike": [[0.0, 0.0, 1.0], [0.5, 0.0, 1.25**0.5], [1.0, 1.0, 3**0.5]],
        "lightlike": [[0.6, 0.8, 1.0], [-1.2, 1.6, 2.0]],
        "spacelike": [[1.0, 0.0, 0.0], [1.0, 0.5, 0.5]],
    }
    figure = new_figure(5.4, 5.6)
    for k, (name, points) in enumerate(starts.items()):
        axes = figure.add_subplot(2, 2, k + 1, **VIEW)
        lh.plotting.plot_quadric(rho, lh.integrate(field, (0, 6), points), axes)
        axes.set_title(name, loc="center")
    stretched = lh.Representation.from_matrices(
        [[[0, -2, 0], ["1/2", 0, 0], [0, 0, 0]], [[0, 0, 3], [0, 0, 0], ["-1/3", 0, 0]]]
    )
    sol = lh.integrate(lh.GeneratorField(stretched, [1.0, 0.4]), (0, 5), [[3.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    axes = figure.add_subplot(2, 2, 4, **VIEW)
    lh.plotting.plot_quadric(stretched, sol, axes)
    axes.set_title("a stretched sphere", loc="center")
    for axes in figure.axes:
        axes.set_title("", loc="left")
        axes.get_legend().remove()
    return figure


@picture
def spectrum_over_time(colours: Sequence[str]) -> Any:
    """Eigenvalues along an isospectral flow on Sym(3): by a step on the orbit, and by Euler's method in space."""
    space = lh.instances.SymmetricMatrices(3)
    a = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, -2.0], [0.0, 2.0, 0.0]])
    field = space.flow(lambda s: (s @ a + a @ s) / 4)
    sol = lh.integrate(field, (0, 4), space.point((1, 1, 1)), step=lh.Euler(), dt=0.025)
    points = [sol.y[:, 0]]
    for _ in sol.t[1:]:
        points.append(points[-1] + 0.025 * field.vector(points[-1]))
    both = {"Lie-Euler": sol, "Euler in $R^6$": (sol.t, np.transpose(points))}
    figure = new_figure(5.0, 3.4)
    lh.plotting.plot_spectrum(both, figure.add_subplot())
    return figure


@picture
def frames_of_an_animation(colours: Sequence[str]) -> Any:
    """Four frames of what animate_trajectory shows."""
    sol = lh.integrate(BODY, (0, 12), [[0.95, 0.0, 0.3122499], [0.1, 0.7, 0.5**0.5]])
    figure = new_figure(4.8, 4.8)
    for k in range(4):
        for actor in stage(sol, ax=figure.add_subplot(2, 2, k + 1, **VIEW)):
            actor.move((k + 1) / 4)
    return figure
