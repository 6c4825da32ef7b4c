"""What the tests of instances share: bodies, points, slopes."""

from fractions import Fraction
from typing import Any

import numpy as np

from liehom.studies.rigid_body import RigidBody
from tests.flow.steps.support import slopes as slopes, unit as unit


def rotation(seed: int) -> Any:
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def tilted(seed: int, moments: Any = (1.0, 1.7, 2.6)) -> RigidBody:
    """A body whose principal axes are not those of R^3."""
    q = rotation(seed)
    return RigidBody(q @ np.diag(moments) @ q.T)


BODIES = {
    "triaxial": RigidBody([1, 2, 3]),
    "unsorted": RigidBody(["5/2", 1, "3/2"]),
    "no triangle": RigidBody([0.3, 0.4, 3.0]),
    "disc": RigidBody([1, 1, 2]),
    "rod": RigidBody([2, 1, 2]),
    "nearly a disc": RigidBody([1, 1 + 1e-9, 2]),
    "sphere": RigidBody([2, 2, 2]),
    "tilted": tilted(3),
}


def on_sphere(seed: int, *shape: int) -> Any:
    return unit(seed, *shape, 3)


def rational(values: Any) -> Any:
    import liehom as lh

    out = np.empty(len(values), dtype=object)
    for i, x in enumerate(values):
        out[i] = lh.QQ.convert(Fraction(x))
    return out
