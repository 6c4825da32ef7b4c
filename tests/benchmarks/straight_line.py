"""Python source of a vector field as straight-line code, recorded while the field computes: what numba compiles.

A person who writes a fast kernel for one field writes its terms one after the other.  For fields of some hundred terms
this is done by recording them; sums and products of constants are left to the compiler.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

OPERATIONS = {"add": "+", "sub": "-", "mul": "*"}


class Recorded:
    """A number that writes down what is computed with it."""

    def __init__(self, name: str, lines: list[str]) -> None:
        self.name, self.lines = name, lines

    def _new(self, text: str) -> Recorded:
        made = Recorded(f"v{len(self.lines)}", self.lines)
        self.lines.append(f"{made.name} = {text}")
        return made

    def __add__(self, other: Any) -> Recorded:
        return self._new(f"{self.name} + {_text(other)}")

    def __sub__(self, other: Any) -> Recorded:
        return self._new(f"{self.name} - {_text(other)}")

    def __mul__(self, other: Any) -> Recorded:
        return self._new(f"{self.name} * {_text(other)}")

    def __neg__(self) -> Recorded:
        return self._new(f"-{self.name}")

    def __rsub__(self, other: Any) -> Recorded:
        return self._new(f"{_text(other)} - {self.name}")

    __radd__, __rmul__ = __add__, __mul__


def _text(x: Any) -> str:
    return x.name if isinstance(x, Recorded) else repr(float(x))


def source(rates: Callable[[Sequence[Any]], Sequence[Any]], size: int) -> str:
    """A function `field(x0, x1, ...)` that returns a tuple.

    >>> print(source(lambda x: [x[1], 2 * x[0]], 2))
    def field(x0, x1):
        v0 = x0 * 2.0
        return (x1, v0,)
    """
    lines: list[str] = []
    names = [f"x{i}" for i in range(size)]
    made = rates([Recorded(name, lines) for name in names])
    body = [*lines, f"return ({' '.join(_text(x) + ',' for x in made)})"]
    return "\n".join([f"def field({', '.join(names)}):", *[f"    {line}" for line in body]])


def rk4_source(size: int) -> str:
    """One step of the classical method on `size` numbers, as straight-line code around `field`."""
    x, z = _names("x", size), _names("z", size)
    lines = [f"({a},) = field({', '.join(x)})" for a in [", ".join(_names("a", size))]]
    for before, stage, weight in (("a", "b", "half"), ("b", "c", "half"), ("c", "d", "h")):
        at = ", ".join(f"{p} + {weight} * {k}" for p, k in zip(x, _names(before, size), strict=True))
        lines.append(f"({', '.join(_names(stage, size))},) = field({at})")
    for i in range(size):
        lines.append(f"{z[i]} = x{i} + sixth * (a{i} + 2.0 * (b{i} + c{i}) + d{i})")
    head = f"def step({', '.join(x)}, h):"
    start = ["half = 0.5 * h", "sixth = h / 6.0"]
    return "\n".join([head, *[f"    {line}" for line in [*start, *lines, f"return ({', '.join(z)},)"]]])


def loop_source(size: int, width: int) -> str:
    """All steps of a block of lanes before the next block; `width` 1 is one trajectory at a time."""
    x = ", ".join(f"b[{i}, k]" for i in range(size))
    return f"""
def run(x, h, steps):
    b = np.empty(({size}, {width}))
    for first in range(0, x.shape[1], {width}):
        for i in range({size}):
            for k in range({width}):
                b[i, k] = x[i, first + k]
        for _ in range(steps):
            for k in range({width}):
                ({x},) = step({x}, h)
        for i in range({size}):
            for k in range({width}):
                x[i, first + k] = b[i, k]
"""


def _names(letter: str, size: int) -> list[str]:
    return [f"{letter}{i}" for i in range(size)]
