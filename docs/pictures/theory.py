"""Pictures of the proofs: the range condition, its cones, corrections, landings, and signatures of simple ideals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import liehom as lh
from liehom.plotting.canvas import GREY, new_figure
from pictures import picture


@picture
def range_condition_in_the_plane(colours: Sequence[str]) -> Any:
    """The isotropy of two pairs on the directions x of g/h; where rho(h) x is along x, the condition fails."""
    figure = new_figure(5.6, 3.1)
    turn = np.linspace(0, 2 * np.pi, 181)
    for axes, name in zip(figure.subplots(1, 2), ("so(3)/so(2)", "so(2,1)/so(1,1)"), strict=True):
        pair = lh.pair(name)
        (rho,) = (np.array(m.to_numpy(), dtype=float) for m in pair.isotropy_representation().matrices)
        axes.plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=0.8)
        for angle in np.arange(16) * np.pi / 8:
            x = np.array([np.cos(angle), np.sin(angle)])
            move = 0.5 * rho @ x / np.linalg.norm(rho, 2)
            fails = abs(x[0] * move[1] - x[1] * move[0]) < 1e-12
            arrow = {"arrowstyle": "-|>", "color": colours[1 if fails else 0], "linewidth": 2.2 if fails else 1.2}
            axes.plot([0, x[0]], [0, x[1]], color=GREY, linewidth=0.5, alpha=0.6)
            axes.annotate("", x + move, x, arrowprops=arrow)
        axes.set_title(f"{name}: {'full' if lh.decide_fullness(pair).full else 'not full'}", loc="center")
        axes.set(aspect="equal", xlim=(-1.6, 1.6), ylim=(-1.6, 1.6))
        axes.set_axis_off()
    return figure


@picture
def circles_of_isotropy(colours: Sequence[str]) -> Any:
    """An orbit of the rigid body and the circles exp(t (psi + s m)) m, seen from above m; one of them osculates."""
    moments = np.array([1.0, 2.0, 3.0])
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / moments)
    m = np.array([0.6, 0.0, 0.8])
    zeta = lh.steps.correction(field, lh.Euler(), m, order=2).zeta[1]
    psi, best = -m / moments, zeta @ m
    along = np.cross(psi, m) / np.linalg.norm(np.cross(psi, m))
    seen = np.array([along, np.cross(m, along)])
    figure = new_figure(5.2, 3.6)
    axes = figure.add_subplot()
    action, times = lh.Action(field.representation), np.linspace(-4.0, 4.0, 401)
    for s in np.linspace(-1.0, 2.0, 13):
        circle = action.act(times[:, None] * (psi + s * best * m), m)
        axes.plot(*(seen @ circle.T), color=GREY, linewidth=0.6, alpha=0.7)
    for s, colour, dash, label in ((0, colours[1], "--", "Euler's step: ζ = 0"), (1, colours[0], "-.", "corrected: ζ")):
        circle = action.act(times[:, None] * (psi + s * best * m), m)
        axes.plot(*(seen @ circle.T), color=colour, linestyle=dash, linewidth=2.0, label=label)
    halves = [lh.integrate(field, (0, end), m, t_eval=np.linspace(0, end, 101), rtol=1e-9).y for end in (-4.0, 4.0)]
    orbit = np.hstack([halves[0][:, ::-1], halves[1]])
    axes.plot(*(seen @ orbit), color=colours[2], linewidth=2.6, alpha=0.8, label="the orbit", zorder=1.5)
    axes.plot(0, 0, "o", color=colours[6], markersize=6, zorder=4)
    axes.annotate("m", (0, 0), xytext=(4, -14), textcoords="offset points")
    axes.set(aspect="equal", xlim=(-0.85, 0.85), ylim=(-0.5, 0.5))
    axes.set_axis_off()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=3)
    return figure


@picture
def landing_on_a_circle(colours: Sequence[str]) -> Any:
    """Taylor polynomials of a rotation leave the circle; the projection puts their ends back."""
    figure = new_figure(5.0, 4.4)
    axes = figure.add_subplot()
    turn, h = np.linspace(-0.4, 2.0, 200), 1.2
    axes.plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=2.0, label="the orbit")
    times = np.linspace(0, h, 60)
    flow = lh.steps.flow_series(
        lh.GeneratorField(lh.defining(lh.so(2)), lambda m: 0 * m[..., :1] + 1), [1.0, 0.0], order=3
    )
    terms = np.array(flow.points.coefficients)
    for n, dash in zip((1, 2, 3), ("--", "-.", ":"), strict=True):
        curve = sum(np.outer(term, times**k) for k, term in enumerate(terms[: n + 1]))
        end = curve[:, -1]
        axes.plot(*curve, color=colours[n - 1], linestyle=dash, linewidth=2.0, label=f"Taylor polynomial, n = {n}")
        arrow = {"arrowstyle": "-|>", "color": colours[n - 1], "linewidth": 1.6, "shrinkA": 4, "shrinkB": 4}
        axes.annotate("", end / np.linalg.norm(end), end, arrowprops=arrow)
        axes.plot(*end, "s", color=colours[n - 1], markersize=5)
        axes.plot(*(end / np.linalg.norm(end)), "o", color=colours[n - 1], markersize=6)
    axes.plot(np.cos(h), np.sin(h), "*", color=colours[6], markersize=11, label="the end of the flow", zorder=5)
    axes.set(aspect="equal")
    axes.set_axis_off()
    figure.legend(loc="outside lower center", ncols=2)
    return figure


@picture
def signatures_of_simple_ideals(colours: Sequence[str]) -> Any:
    """The signature of K((theta - c) x, y) falls at each real root of the centroid, by twice that of the ideal."""
    brackets = {(0, 1): {2: 1}, (1, 2): {3: 1}, (0, 2): {4: -1}, (0, 4): {5: 1}}
    brackets |= {(1, 3): {5: -1}, (3, 4): {2: 2}, (1, 5): {0: 2}, (2, 4): {0: -2}}
    brackets |= {(4, 5): {3: 2}, (0, 5): {1: -2}, (2, 3): {1: 2}, (3, 5): {4: -2}}
    g = lh.LieAlgebra(brackets, dimension=6)
    killing = np.array(g.killing_form().to_numpy(), dtype=float)
    theta = np.array(g.centroid()[1].to_numpy(), dtype=float)
    cs = np.linspace(-3.2, 3.6, 1361)
    forms = [killing @ (theta - c * np.eye(6)) for c in cs]
    figure = new_figure(5.2, 3.0)
    axes = figure.add_subplot()
    signatures = [np.sign(np.linalg.eigvalsh((form + form.T) / 2)).sum() for form in forms]
    axes.step(cs, signatures, color=colours[0], where="mid", linewidth=2.0)
    for root, level, text in (
        (1 - 2**0.5, 1, "so(3), K of signature −3:\nup by 6"),
        (1 + 2**0.5, 3, "sl(2,R), +1:\ndown by 2"),
    ):
        axes.axvline(root, color=colours[1], linestyle=":", linewidth=1.2)
        axes.annotate(text, (root, level), xytext=(-6, 0), textcoords="offset points", ha="right", va="center")
    axes.set(xlabel="c", ylabel="signature", yticks=[-2, 0, 2, 4], xlim=(-3.2, 3.6))
    return figure


@picture
def isotropy_beyond_a_turn(colours: Sequence[str]) -> Any:
    """Euler's step for damping with the isotropy s > 2 pi: its factor, and which starts approach the equilibrium."""
    figure = new_figure(6.4, 3.2)
    left, right = figure.subplots(1, 2)
    sizes = np.geomspace(2.0, 100.0, 41)
    turns = np.full(len(sizes), 2 * np.pi)
    for _ in range(200):  # s = 2 (pi + e), tan e = s / (2 K h)
        turns = 2 * np.pi + 2 * np.arctan(turns / 2 / sizes)
    left.loglog(sizes, np.abs(1 - sizes), color=colours[1], linestyle="--", label="s = 0")
    left.loglog(sizes, np.sin(turns / 2 - np.pi), color=colours[0], label="s above 2π")
    left.axhline(1.0, color=GREY, linewidth=0.6)
    left.set(xlabel="K h", ylabel="factor of a deviation", ylim=(0.02, 100.0))
    left.legend(loc="upper left")
    up, distances = np.array([0.0, 0.0, 1.0]), np.geomspace(0.008, 3.0, 28)
    starts = np.stack([np.sin(distances), 0 * distances, np.cos(distances)], axis=-1)
    for size, turn in zip(sizes[::2], turns[::2], strict=True):
        field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, x=size, s=turn: x * np.cross(m, up) + s * m)
        sol = lh.integrate(field, (0, 100), starts, step=lh.Euler(), dt=1.0, t_eval=[0.0, 100.0])
        good = np.linalg.norm(sol.y[..., -1] - up, axis=-1) < 0.01 * distances
        for chosen, mark, colour in ((good, "o", colours[0]), (~good, "x", colours[1])):
            right.plot(np.full(chosen.sum(), size), distances[chosen], mark, color=colour, markersize=2.6)
    right.plot(sizes, 2 * 2**0.5 * np.pi * sizes**-1.5, color=colours[6], linewidth=1.4)
    right.set(xscale="log", yscale="log", xlabel="K h", ylabel="distance of the start", ylim=(0.007, 3.6))
    return figure


@picture
def cone_of_a_form(colours: Sequence[str]) -> Any:
    """The cone B = 0 of so(3,1)/so(2,1), and one point in each of the three open orbits."""
    form = np.diag([1.0, 1.0, -1.0])
    figure = new_figure(4.2, 3.6)
    axes = figure.add_subplot(projection="3d")
    turn, height = np.meshgrid(np.linspace(0, 2 * np.pi, 61), np.linspace(-1, 1, 21))
    axes.plot_surface(height * np.cos(turn), height * np.sin(turn), height, color=GREY, alpha=0.35, linewidth=0)
    for colour, point in zip(colours, ([0, 0, 0.9], [0, 0, -0.9], [1.1, 0, 0]), strict=False):
        x = np.array(point)
        axes.scatter(*x, color=colour, s=40)
        axes.text(*np.add(x, (0.12, 0, 0.04)), f"B {'<' if x @ form @ x < 0 else '>'} 0", color=colour)
    axes.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), zlim=(-1, 1), box_aspect=(1, 1, 0.9))
    axes.set_axis_off()
    return figure


@picture
def open_orbits_of_cubics(colours: Sequence[str]) -> Any:
    """Cubics x^3 + p x + q: inside the cusp of the discriminant they have three real roots, outside one."""
    figure = new_figure(4.4, 3.0)
    axes = figure.add_subplot()
    p, q = np.meshgrid(np.linspace(-3, 1.5, 201), np.linspace(-2.5, 2.5, 201))
    axes.contourf(p, q, -4 * p**3 - 27 * q**2, levels=[-1e9, 0, 1e9], colors=colours[:2], alpha=0.25)
    axes.contour(p, q, -4 * p**3 - 27 * q**2, levels=[0], colors=colours[1])
    for x, y in ((-2.2, 0.0), (0.2, 1.4)):
        roots = np.roots([1, 0, x, y])
        number = int((abs(roots.imag) < 1e-9).sum())
        axes.text(x, y, f"{number} real root{'s' * (number > 1)}", ha="center", va="center")
    axes.set(xlabel="p", ylabel="q")
    return figure
