"""Separatrix experiment of section 4: Euler's method from random points of separatrices, on [0, 500]."""

from __future__ import annotations

import numpy as np

from liehom.instances.rigid_body.rigid_body import RigidBody
from liehom.paper.energy_errors import kernels_agree, scale
from liehom.paper.kernels import kernel
from liehom.paper.plots import draw_separatrices
from liehom.paper.printed_data import EULER
from liehom.paper.printed_data import SEPARATRIX as PRINTED
from liehom.paper.reproduction import Check, Reproduction
from liehom.paper.samples import MOMENTS, SEED, Sample, averages, described, largest_energy_error, random_bodies, spread
from liehom.paper.table import Table
from liehom.paper.trajectories import trajectory
from liehom.typing import Array

SPAN, BATCHES = 500.0, 40
ZERO = 1e-12
SHOWN_DT = 0.1
"""Step size of the plot."""


def separatrix(quick: bool = False, seed: int = SEED) -> Reproduction:
    """Energy errors on separatrices: xi_b^Eul leaves a separatrix, xi_o^Eul and xi_i^Eul stay on it.

    Examples
    --------
    >>> separatrix(quick=True).holds
    True
    """
    span, batches = (50.0, 2) if quick else (SPAN, BATCHES)
    sample = separatrix_sample(10 * batches, seed)
    dts = [dt for dt in PRINTED if not quick or dt > 0.05]
    rows, largest, apart, shown = [], 0.0, 0.0, 0
    for dt in dts:
        for name in EULER:
            errors = largest_energy_error(kernel(name, sample.body), sample.body, sample.points, dt, span)
            found = spread(averages(errors))
            paper = PRINTED[dt] if name == "eul_b" else None
            rows.append((dt, name, *found, paper, "" if paper is None else "yes" if found.has(paper) else "no"))
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
    """Triaxial bodies, each with a point at a random angle on one of its two great circles h = w_2.

    Examples
    --------
    >>> sample = separatrix_sample(5)
    >>> middle = np.sort(1 / sample.moments, axis=0)[1]
    >>> bool(np.allclose(2 * sample.body.energy(sample.points), middle))
    True
    """
    drawn: Sample = random_bodies("triaxial", count, MOMENTS, seed)
    rng = np.random.default_rng([seed, 2])
    angles, branches = rng.uniform(0, 2 * np.pi, count), rng.choice([-1, 1], count)
    points: list[Array] = [RigidBody(drawn.moments[:, i]).separatrix(angles[i], int(branches[i])) for i in range(count)]
    return Sample("triaxial", drawn.moments, np.stack(points, axis=-1))
