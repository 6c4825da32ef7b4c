"""Figures 1 and 2 and the separatrix experiment."""

from __future__ import annotations

import numpy as np

from liehom.base.typing import Array
from liehom.studies.paper.energy_errors import (
    KINDS,
    MOMENTS,
    NARROW_MOMENTS,
    SEED,
    Sample,
    averages,
    described,
    kernels_agree,
    largest_energy_error,
    random_bodies,
    scale,
    spread,
)
from liehom.studies.paper.kernels import kernel
from liehom.studies.paper.plots import draw_separatrices, draw_spheres
from liehom.studies.paper.reproduction import Check, Reproduction
from liehom.studies.paper.table import EULER, FIGURE_2, SEPARATRIX as PRINTED, Table
from liehom.studies.rigid_body import RigidBody

# Figures 1 and 2: trajectories of Euler's method over [0, 200] with dt = 0.1, and their largest energy errors.

SPAN, DT = 200.0, 0.1
STARTS, MANY = 3, 400
# With this seed most initial points are in front of the sphere, and both bodies are far from spherical
FIGURE_SEED = 44
EVERY = 10  # Every 10th step is in the CSV file
ZERO = 1e-12


def figure1(quick: bool = False, seed: int = FIGURE_SEED) -> Reproduction:
    """Figure 1: trajectories on the sphere for a triaxial and an axisymmetric body, whole also if `quick`.

    Examples
    --------
    >>> figure1(quick=True).tables["bodies"].columns[:2]
    ('body', 'moments')
    """
    curves = {(kind, name): trajectory(name, _one_body(kind, seed), SPAN) for kind in KINDS for name in EULER}
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
        f"Figure 1: trajectories of the forward Euler method, [0, {SPAN:g}], dt = {DT}",
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
            range_ = spread(others)
            middles[kind, name] = range_.median
            if (kind, name) == ("axisymmetric", "eul_i"):
                largest = float(others.max())
            paper = FIGURE_2[kind, DT, name]
            inside = range_.has(paper) or max(range_.high, paper) < ZERO
            rows.append((kind, name, here, *range_, paper, "yes" if inside else "no"))
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
    """Points of a run, an array of shape (steps + 1, 3, N)."""
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


# Separatrix experiment of section 4: Euler's method from random points of separatrices, on [0, 500].

SEPARATRIX_SPAN, BATCHES = 500.0, 40
SHOWN_DT = 0.1  # Step size of the plot


def separatrix(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Energy errors on separatrices: xi_b^Eul leaves a separatrix, xi_o^Eul and xi_i^Eul stay on it.

    Examples
    --------
    >>> separatrix(quick=True).holds
    True
    """
    span, batches = (50.0, 2) if quick else (SEPARATRIX_SPAN, BATCHES)
    sample = separatrix_sample(10 * batches, seed)
    dts = [dt for dt in PRINTED if not quick or dt > 0.05]
    rows, largest, apart, shown = [], 0.0, 0.0, 0
    for dt in dts:
        for name in EULER:
            errors = largest_energy_error(kernel(name, sample.body), sample.body, sample.points, dt, span)
            range_ = spread(averages(errors))
            paper = PRINTED[dt] if name == "eul_b" else None
            rows.append((dt, name, *range_, paper, "" if paper is None else "yes" if range_.has(paper) else "no"))
            if name == "eul_b" and dt == SHOWN_DT:
                shown = int(np.argmax(errors))
            if name != "eul_b":
                largest = max(largest, float(errors.max()))
        steps = [np.stack(kernel(name, sample.body)(sample.points, dt)) for name in ("eul_o", "eul_i")]
        apart = max(apart, float(np.abs(steps[0] - steps[1]).max()))
    smallest = min(row[2] for row in rows if row[1] == "eul_b")
    checks = (
        Check("xi_o^Eul and xi_i^Eul keep the separatrix", f"largest error {largest:.0e}", largest < ZERO),
        Check("xi_o^Eul and xi_i^Eul coincide on it", f"they differ by {apart:.0e}", apart < ZERO),
        Check("xi_b^Eul does not keep it", f"smallest average error {smallest:.1e}", smallest > 1e-5),
        kernels_agree(scale(True, seed), EULER),
    )
    columns = ("dt", "update", "average error", "low", "high", "paper", "paper in range")
    law = described(MOMENTS, batches, seed).replace(
        "I_1 = I_2 for axisymmetric bodies; starting points uniform on the unit sphere",
        "starting points at uniform angles on the separatrices",
    )
    table = Table(f"Average of the largest energy errors of ten runs on [0, {span:g}]", columns, rows)
    return Reproduction(
        "separatrix",
        "The separatrix, section 4",
        law,
        {"": table},
        checks,
        draw=lambda: draw_separatrices(sample.moments[:, shown], _trajectories(sample, shown, span)),
        shows=f"Trajectories with dt = {SHOWN_DT} on [0, {span:g}] from a point of a separatrix, on the phase portrait "
        "of the body with the largest error.",
    )


def _trajectories(sample: Sample, shown: int, span: float) -> dict[str, Array]:
    """Points (steps, 3) of the runs of one body, by update."""
    one = Sample("triaxial", sample.moments[:, [shown]], sample.start[:, [shown]])
    return {name: trajectory(name, one, span, SHOWN_DT)[:, :, 0] for name in EULER}


def separatrix_sample(count: int, seed: int = SEED) -> Sample:
    """Triaxial bodies, each with a point at a random angle on one of its two great circles h = w_2."""
    drawn: Sample = random_bodies("triaxial", count, MOMENTS, seed)
    rng = np.random.default_rng([seed, 2])
    angles, branches = rng.uniform(0, 2 * np.pi, count), rng.choice([-1, 1], count)
    points: list[Array] = [RigidBody(drawn.moments[:, i]).separatrix(angles[i], int(branches[i])) for i in range(count)]
    return Sample("triaxial", drawn.moments, np.stack(points, axis=-1))
