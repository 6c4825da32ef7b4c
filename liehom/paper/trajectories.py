"""Figures 1 and 2: trajectories of Euler's method over [0, 200] with dt = 0.1, and their largest energy errors."""

from __future__ import annotations

import numpy as np

from liehom.paper.energy_errors import kernels_agree, scale
from liehom.paper.kernels import kernel
from liehom.paper.plots import draw_spheres
from liehom.paper.printed_data import EULER, FIGURE_2
from liehom.paper.reproduction import Check, Reproduction
from liehom.paper.samples import KINDS, NARROW_MOMENTS, Sample, largest_energy_error, random_bodies, spread
from liehom.paper.table import Table
from liehom.typing import Array

SPAN, DT = 200.0, 0.1
STARTS, MANY = 3, 400
FIGURE_SEED = 44
"""With this seed most initial points are in front of the sphere, and both bodies are far from spherical."""
EVERY = 10
"""Every 10th step is in the CSV file."""
ZERO = 1e-12


def figure1(quick: bool = False, seed: int = FIGURE_SEED) -> Reproduction:
    """Figure 1: trajectories on the sphere for a triaxial and an axisymmetric body.

    Examples
    --------
    >>> figure1(quick=True).tables["bodies"].columns[:2]
    ('body', 'moments')
    """
    span = 20.0 if quick else SPAN
    curves = {(kind, name): trajectory(name, _one_body(kind, seed), span) for kind in KINDS for name in EULER}
    points = [
        (kind, name, k + 1, step * DT, *map(float, curve[step, :, k]))
        for (kind, name), curve in curves.items()
        for k in range(STARTS)
        for step in range(0, len(curve), EVERY)
    ]
    samples = {kind: _one_body(kind, seed) for kind in KINDS}
    bodies = [
        (kind, _triple(sample.moments[:, 0]), *(_triple(start) for start in sample.start.T))
        for kind, sample in samples.items()
    ]
    off = max(float(np.abs((curve**2).sum(axis=1) - 1).max()) for curve in curves.values())
    return Reproduction(
        "fig1",
        f"Figure 1: trajectories of the forward Euler method, [0, {span:g}], dt = {DT}",
        _described(seed),
        {
            "": Table(
                f"Points of the curves, every {EVERY}th step",
                ("body", "update", "trajectory", "t", "m1", "m2", "m3"),
                points,
                in_markdown=False,
            ),
            "bodies": Table(
                "Bodies and starting points", ("body", "moments", *(f"start {k + 1}" for k in range(STARTS))), bodies
            ),
        },
        (Check("all points stay on the sphere", f"| |m|^2 - 1 | at most {off:.0e}", off < ZERO),),
        draw=lambda: draw_spheres(curves),
        shows="Upper row: a triaxial body, lower row: an axisymmetric body. Parts behind the sphere are faint.",
    )


def figure2(quick: bool = False, seed: int = FIGURE_SEED) -> Reproduction:
    """Figure 2: the largest energy error of these trajectories, and of many others.

    Examples
    --------
    >>> figure2(quick=True).holds
    True
    """
    span, count = (20.0, 30) if quick else (SPAN, MANY)
    rows, middles, largest = [], {}, 0.0
    for kind in KINDS:
        for name in EULER:
            here = float(_errors(name, _one_body(kind, seed), span).max())
            others = _errors(name, random_bodies(kind, count, NARROW_MOMENTS, seed + 1), span)
            found = spread(others)
            middles[kind, name] = found.median
            if (kind, name) == ("axisymmetric", "eul_i"):
                largest = float(others.max())
            paper = FIGURE_2[kind, DT, name]
            inside = found.has(paper) or max(found.high, paper) < ZERO
            rows.append((kind, name, here, *found, paper, "yes" if inside else "no"))
    ratio = middles["triaxial", "eul_o"] / middles["triaxial", "eul_i"]
    checks = (
        Check("axisymmetric, xi_i^Eul: zero to round-off", f"largest of {count} errors {largest:.0e}", largest < ZERO),
        Check("triaxial: xi_i^Eul gains three orders of magnitude over xi_o^Eul", f"factor {ratio:.0f}", ratio > 300),
        kernels_agree(scale(True, seed), EULER),
    )
    title = "Largest energy errors"
    columns = (
        "body",
        "update",
        "trajectories of Figure 1",
        "median of others",
        "low",
        "high",
        "paper",
        "paper in range",
    )
    sample = (
        f"{_described(seed)} Beside them {count} other bodies with one trajectory each: median, 5th, 95th percentile."
    )
    count_inside = sum(row[-1] == "yes" for row in rows)
    notes = (
        f"{count_inside} of {len(rows)} numbers of the paper lie in the range.",
        "The first update is xi_b^Eul; the paper's header reads xi_n^Eul.",
    )
    return Reproduction(
        "fig2", f"Figure 2: {title.lower()} of Euler's method", sample, {"": Table(title, columns, rows)}, checks, notes
    )


def trajectory(name: str, sample: Sample, span: float, dt: float = DT) -> Array:
    """Points of a run, an array of shape (steps + 1, 3, N).

    Examples
    --------
    >>> trajectory("eul_o", random_bodies("triaxial", 4), 1.0).shape
    (11, 3, 4)
    """
    update, m = kernel(name, sample.body), sample.points
    points = [np.stack(np.broadcast_arrays(*m))]
    for _ in range(round(span / dt)):
        m = update(m, dt)
        points.append(np.stack(m))
    return np.stack(points)


def _one_body(kind: str, seed: int) -> Sample:
    """One body with several initial points."""
    several = random_bodies(kind, STARTS, NARROW_MOMENTS, seed)
    return Sample(kind, several.moments[:, :1], several.start)


def _errors(name: str, sample: Sample, span: float) -> Array:
    return largest_energy_error(kernel(name, sample.body), sample.body, sample.points, DT, span)


def _described(seed: int) -> str:
    low, high = NARROW_MOMENTS
    return (
        f"Principal moments uniform on ({low:g}, {high:g}), I_1 = I_2 for the axisymmetric body; {STARTS} starting "
        f"points uniform on the unit sphere; seed {seed}. The paper does not give the data of its figure."
    )


def _triple(values: Array) -> str:
    return "(" + ", ".join(f"{x:.4f}" for x in values) + ")"
