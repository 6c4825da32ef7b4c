"""Random bodies and starting points, and the largest error of the energy over a run.

The paper averages over ten runs whose data it does not give. Here many such averages are made, each over ten bodies of
its own, and their median is shown with the range that nine tenths of them lie in.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from liehom.errors import InputError
from liehom.paper.kernels import Body, Update, Vector

RUNS = 10
SEED = 2001
MOMENTS = (1.0, 20.0)
# of a law with w about 1 and bodies that all turn: for orders of convergence
NARROW_MOMENTS = (1.0, 3.0)
KINDS = ("triaxial", "axisymmetric")


@dataclass(frozen=True, slots=True)
class Sample:
    """Bodies in their principal axes, one in each lane, and a starting point for each.

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
    moments: Any
    start: Any

    @property
    def body(self) -> Body:
        """The bodies as the kernels take them."""
        w = 1 / self.moments
        return Body((w[0], w[1], w[2]))

    @property
    def points(self) -> Vector:
        """The starting points, coordinate by coordinate."""
        return self.start[0], self.start[1], self.start[2]


def random_bodies(kind: str, count: int, law: tuple[float, float] = MOMENTS, seed: int = SEED) -> Sample:
    """Principal moments uniform on the interval `law`, independent; starting points uniform on the unit sphere.

    Axisymmetric bodies have I_1 = I_2. A random rotation of the tensor would change nothing but the names of the axes:
    updates commute with rotations and the starting points are uniform.

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
    """The data of the tables of errors, in words."""
    return (
        f"Principal moments independent and uniform on ({law[0]:g}, {law[1]:g}), I_1 = I_2 for axisymmetric bodies; "
        f"starting points uniform on the unit sphere; seed {seed}. Errors are averages over {RUNS} runs: medians of "
        f"{batches} such averages with the range from the 5th to the 95th percentile, {RUNS * batches} bodies in all."
    )


def largest_energy_error(update: Update, body: Body, m: Vector, dt: float, span: float) -> Any:
    """max |H(m_k) - H(m_0)| over the steps of a run, for each lane.

    Examples
    --------
    >>> from liehom.paper.kernels import kernel
    >>> sample = random_bodies("axisymmetric", 5)
    >>> update = kernel("eul_i", sample.body)
    >>> bool(largest_energy_error(update, sample.body, sample.points, 0.5, 10.0).max() < 1e-14)
    True
    """
    start = body.energy(m)
    largest = np.zeros_like(start)
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
        """Whether a value is in the range."""
        return self.low <= value <= self.high


def spread(values: Any) -> Spread:
    """Median and range of numbers.

    Examples
    --------
    >>> spread(np.arange(101.0))
    Spread(median=50.0, low=5.0, high=95.0)
    """
    return Spread(*(float(np.quantile(values, q)) for q in (0.5, 0.05, 0.95)))


def averages(errors: Any) -> Any:
    """Averages over ten runs each, shape (N / 10,)."""
    return errors.reshape(-1, RUNS).mean(axis=1)


def slope(coarse: Any, fine: Any, ratio: float, floor: float = 1e-13) -> float:
    """The median over runs of log(coarse / fine) / log(ratio), of runs whose errors are above round-off.

    Examples
    --------
    >>> slope(np.array([4e-6, 8e-3]), np.array([1e-6, 2e-3]), 2.0)
    2.0
    """
    above = fine > floor
    if not above.any():
        return float("nan")
    return float(np.median(np.log(coarse[above] / fine[above])) / np.log(ratio))
