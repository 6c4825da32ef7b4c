"""Measured orders of the solution and of the energy for Figure 6: T = 6, dt = 1/16 .. 1/64, extended precision."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.instances.rigid_body.rigid_body import RigidBody
from liehom.paper.kernels import Body, kernel
from liehom.paper.printed_data import UPDATES
from liehom.paper.samples import NARROW_MOMENTS, SEED, random_bodies
from liehom.typing import Array

Longdoubles: TypeAlias = npt.NDArray[np.longdouble]

SPAN = 6.0
SIZES = (1 / 16, 1 / 32, 1 / 64)
BODIES = 20


class Orders(NamedTuple):
    """Measured orders of an update, for averages over the bodies."""

    solution: float
    energy: float


def measured_orders(bodies: int = BODIES, sizes: tuple[float, ...] = SIZES, seed: int = SEED) -> dict[str, Orders]:
    """Orders of the 13 updates, by name: slopes of the error at T and of the largest energy error on [0, T].

    The slopes are those between the last two step sizes. The runs are in numpy.longdouble, because the errors of sy4_io
    reach 5e-15. The reference is the exact solution by elliptic functions.

    Examples
    --------
    >>> orders = measured_orders(bodies=4, sizes=(1 / 8, 1 / 16))
    >>> round(orders["eul_i"].energy), round(orders["eul_i"].solution)
    (2, 1)
    """
    sample = random_bodies("triaxial", bodies, NARROW_MOMENTS, seed)
    moments, start = sample.moments.astype(np.longdouble), sample.start.astype(np.longdouble)
    start /= np.sqrt((start**2).sum(axis=0))
    w = 1 / moments
    body = Body((w[0], w[1], w[2]))
    exact: Any = np.stack([RigidBody(sample.moments[:, i]).exact(start[:, i], SPAN) for i in range(bodies)], axis=-1)
    found = {}
    for name in UPDATES:
        errors = [_errors(name, body, start, exact, dt) for dt in sizes[-2:]]
        slopes = np.log(np.array(errors[0]) / np.array(errors[1])) / np.log(sizes[-2] / sizes[-1])
        found[name] = Orders(float(slopes[0]), float(slopes[1]))
    return found


def _errors(name: str, body: Body, start: Longdoubles, exact: Array, dt: float) -> tuple[float, float]:
    """Averages over the bodies of |m(T) - exact| and of the largest |H - H_0|."""
    update, m = kernel(name, body), (start[0], start[1], start[2])
    before = body.energy(m)
    largest = np.zeros_like(before)
    for _ in range(round(SPAN / dt)):
        m = update(m, dt)
        np.maximum(largest, np.abs(body.energy(m) - before), out=largest)
    away = np.sqrt(((np.stack(m) - exact) ** 2).sum(axis=0))
    return float(away.mean()), float(largest.mean())
