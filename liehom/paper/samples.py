"""Random bodies and initial points, and the largest error of the energy in a run.

The paper averages over ten runs and does not give their data. A reproduction therefore computes many such averages,
each over a batch of ten new bodies, and shows their median with the range from the 5th to the 95th percentile.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from liehom.errors import InputError
from liehom.paper.kernels import Body, Update, Vector
from liehom.typing import Array

RUNS = 10
"""Bodies in a batch."""
SEED = 2001
MOMENTS = (1.0, 20.0)
"""Interval of the principal moments."""
NARROW_MOMENTS = (1.0, 3.0)
"""Interval for orders of convergence: all bodies rotate at about the same rate."""
KINDS = ("triaxial", "axisymmetric")


@dataclass(frozen=True, slots=True)
class Sample:
    """Bodies in their principal axes, one per column, and an initial point for each.

    Attributes
    ----------
    moments : array of shape (3, N)
    start : array of shape (3, N)
        Unit vectors.

    Examples
    --------
    >>> random_bodies("axisymmetric", 20).moments.shape
    (3, 20)
    """

    kind: str
    moments: Array
    start: Array

    @property
    def body(self) -> Body:
        """Bodies in the form that the kernels use."""
        w = 1 / self.moments
        return Body((w[0], w[1], w[2]))

    @property
    def points(self) -> Vector:
        """Initial points as three arrays of coordinates."""
        return self.start[0], self.start[1], self.start[2]


def random_bodies(kind: str, count: int, law: tuple[float, float] = MOMENTS, seed: int = SEED) -> Sample:
    """Bodies with independent principal moments, uniform on `law`, and initial points uniform on the unit sphere.

    Axisymmetric bodies have I_1 = I_2. A random rotation of the inertia tensor would only rename the axes, because
    updates commute with rotations and the initial points are uniform.

    Raises
    ------
    InputError
        If the kind is not "triaxial" or "axisymmetric".

    Examples
    --------
    >>> sample = random_bodies("triaxial", 3)
    >>> bool(np.allclose(np.linalg.norm(sample.start, axis=0), 1)), bool((sample.moments > 1).all())
    (True, True)
    """
    if kind not in KINDS:
        raise InputError(f"the kind of a body is {kind!r}, expected one of {', '.join(KINDS)}")
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    moments = rng.uniform(*law, (3, count))
    if kind == "axisymmetric":
        moments[1] = moments[0]
    start = rng.standard_normal((3, count))
    return Sample(kind, moments, start / np.linalg.norm(start, axis=0))


def described(law: tuple[float, float], batches: int, seed: int) -> str:
    """Sentence that describes the random data of the tables of errors."""
    return (
        f"Principal moments independent and uniform on ({law[0]:g}, {law[1]:g}), I_1 = I_2 for axisymmetric bodies; "
        f"starting points uniform on the unit sphere; seed {seed}. Errors are averages over {RUNS} runs: medians of "
        f"{batches} such averages with the range from the 5th to the 95th percentile, {RUNS * batches} bodies in all."
    )


def largest_energy_error(update: Update, body: Body, m: Vector, dt: float, span: float) -> Array:
    """Largest |H(m_k) - H(m_0)| over the steps of a run, for each body.

    Examples
    --------
    >>> from liehom.paper.kernels import kernel
    >>> sample = random_bodies("axisymmetric", 5)
    >>> update = kernel("eul_i", sample.body)
    >>> bool(largest_energy_error(update, sample.body, sample.points, 0.5, 10.0).max() < 1e-14)
    True
    """
    start = body.energy(m)
    largest: Array = np.zeros_like(start)
    for _ in range(round(span / dt)):
        m = update(m, dt)
        np.maximum(largest, np.abs(body.energy(m) - start), out=largest)
    return largest


class Spread(NamedTuple):
    """Median, 5th and 95th percentile."""

    median: float
    low: float
    high: float

    def has(self, value: float) -> bool:
        """Whether a value is between the 5th and the 95th percentile."""
        return self.low <= value <= self.high


def spread(values: Array) -> Spread:
    """Median, 5th and 95th percentile of numbers.

    Examples
    --------
    >>> spread(np.arange(101.0))
    Spread(median=50.0, low=5.0, high=95.0)
    """
    return Spread(*(float(np.quantile(values, q)) for q in (0.5, 0.05, 0.95)))


def averages(errors: Array) -> Array:
    """Averages over batches of ten runs, shape (N / 10,)."""
    means: Array = errors.reshape(-1, RUNS).mean(axis=1)
    return means


def slope(coarse: Array, fine: Array, ratio: float, floor: float = 1e-13) -> float:
    """Median of log(coarse / fine) / log(ratio) over the runs with errors above round-off; NaN if there are none.

    Examples
    --------
    >>> slope(np.array([4e-6, 8e-3]), np.array([1e-6, 2e-3]), 2.0)
    2.0
    """
    above = fine > floor
    if not above.any():
        return float("nan")
    return float(np.median(np.log(coarse[above] / fine[above])) / np.log(ratio))
