"""Cost of a step: the number of arithmetic operations, and the time relative to a step of Euler."""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from liehom.paper.kernels import Body, Update, Vector, kernel
from liehom.paper.printed_data import UPDATES
from liehom.paper.samples import SEED, random_bodies

LANES, ROUNDS = 1000, 21
"""Bodies in the arrays, and rounds of all updates in which times are measured."""
DT = 0.1


class Cost(NamedTuple):
    """Cost of a step: operations, and time relative to xi_b^Eul on arrays of 1000 bodies and on one body."""

    operations: int
    arrays: float
    numbers: float


class Counted:
    """Number that counts the arithmetic operations on it.

    Examples
    --------
    >>> counter = [0]
    >>> x = Counted(2.0, counter)
    >>> (x * x + 1).value, counter
    (5.0, [2])
    """

    counter: list[int]
    value: float

    __slots__ = ("counter", "value")

    def __init__(self, value: float, counter: list[int]) -> None:
        self.value, self.counter = value, counter

    def _made(self, value: float) -> Counted:
        self.counter[0] += 1
        return Counted(value, self.counter)

    def __add__(self, other: Counted | float) -> Counted:
        return self._made(self.value + _value(other))

    def __sub__(self, other: Counted | float) -> Counted:
        return self._made(self.value - _value(other))

    def __mul__(self, other: Counted | float) -> Counted:
        return self._made(self.value * _value(other))

    def __truediv__(self, other: Counted | float) -> Counted:
        return self._made(self.value / _value(other))

    def __rsub__(self, other: Counted | float) -> Counted:
        return self._made(_value(other) - self.value)

    def __rtruediv__(self, other: Counted | float) -> Counted:
        return self._made(_value(other) / self.value)

    __radd__ = __add__
    __rmul__ = __mul__


def operations(name: str) -> int:
    """Number of sums, products and quotients in a step of an update, without powers of dt and constants of the body.

    Examples
    --------
    >>> operations("eul_b") < operations("eul_i") < operations("rk2_b") < operations("rk4_b")
    True
    """
    counter = [0]
    w = tuple(Counted(x, counter) for x in (1.0, 0.5, 0.25))
    body = Body((w[0], w[1], w[2]))
    update = kernel(name, body)
    counter[0] = 0
    m = tuple(Counted(x, counter) for x in (0.6, 0.48, 0.64))
    update((m[0], m[1], m[2]), DT)
    return counter[0]


def costs(lanes: int = LANES, rounds: int = ROUNDS, seed: int = SEED) -> dict[str, Cost]:
    """Costs of the 13 updates, by name. Times are medians of ratios, each within one round of all updates.

    Ratios depend less on the machine than times.

    Examples
    --------
    >>> costs(lanes=10, rounds=1)["eul_b"].arrays
    1.0
    """
    sample = random_bodies("triaxial", lanes, seed=seed)
    w, m = (tuple(float(x) for x in column) for column in (1 / sample.moments[:, 0], sample.start[:, 0]))
    one = Body((w[0], w[1], w[2])), (m[0], m[1], m[2])
    arrays = _ratios(sample.body, sample.points, rounds, 10)
    numbers = _ratios(*one, rounds, 100)
    return {name: Cost(operations(name), arrays[name], numbers[name]) for name in UPDATES}


def _ratios(body: Body, m: Vector, rounds: int, repeats: int) -> dict[str, float]:
    updates = {name: kernel(name, body) for name in UPDATES}
    taken = np.array([[_seconds(update, m, repeats) for update in updates.values()] for _ in range(rounds)])
    ratios = np.median(taken / taken[:, :1], axis=0)
    return {name: float(ratio) for name, ratio in zip(updates, ratios, strict=True)}


def _seconds(update: Update, m: Vector, repeats: int) -> float:
    """Shortest of three times for `repeats` steps, in seconds."""
    found = []
    for _ in range(3):
        begin = time.perf_counter()
        for _ in range(repeats):
            update(m, DT)
        found.append(time.perf_counter() - begin)
    return min(found)


def _value(x: Counted | float) -> float:
    return x.value if isinstance(x, Counted) else float(x)
