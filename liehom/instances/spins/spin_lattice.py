"""SpinLattice: chains, grids and blocks of unit vectors, with the sum over nearest neighbours.

    (sum m)_i = m_{i-1} + m_{i+1}  along each axis of the lattice

Spins are arrays of shape (..., *shape, 3); leading axes are an ensemble of lattices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.errors import InputError, ShapeError
from liehom.typing import Values

MIN_PERIOD = 3
"""Smallest number of spins on a periodic axis."""


@final
@dataclass(frozen=True, slots=True)
class SpinLattice:
    """A rectangular lattice of spins, periodic or open along each axis.

    Parameters
    ----------
    shape : tuple of int
        (): single spins; (n,): a chain; (n1, n2): a grid; and so on.
    periodic : bool or tuple of bool
        One value for all axes, or one for each. A periodic axis has at least 3 spins, because two spins would be
        neighbours twice.

    Raises
    ------
    InputError
        If the shape or the boundary is not of this form.

    Examples
    --------
    >>> import numpy as np
    >>> m = np.arange(1.0, 5.0)[:, None] * [0.0, 0.0, 1.0]
    >>> SpinLattice((4,), False).neighbour_sum(m)[:, 2].tolist(), SpinLattice((4,)).neighbour_sum(m)[:, 2].tolist()
    ([2.0, 4.0, 6.0, 3.0], [6.0, 4.0, 6.0, 4.0])
    """

    shape: tuple[int, ...] = ()
    periodic: tuple[bool, ...] | bool = True

    def __post_init__(self) -> None:
        shape = self.shape if isinstance(self.shape, Sequence) else (self.shape,)
        if any(isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1 for n in shape):
            raise InputError(f"the shape of a lattice is a tuple of positive integers, got {self.shape!r}")
        given = self.periodic
        periodic = tuple(given) if isinstance(given, Sequence) else (given,) * len(shape)
        if len(periodic) != len(shape) or any(not isinstance(p, bool | np.bool_) for p in periodic):
            raise InputError(f"periodic is True, False or one of them for each of {len(shape)} axes, got {given!r}")
        for n, closed in zip(shape, periodic, strict=True):
            if closed and n < MIN_PERIOD:
                raise InputError(
                    f"an axis of {n} spins cannot be periodic: the least is {MIN_PERIOD}; take periodic=False"
                )
        object.__setattr__(self, "shape", tuple(int(n) for n in shape))
        object.__setattr__(self, "periodic", tuple(bool(p) for p in periodic))

    @property
    def count(self) -> int:
        """Number of spins."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def bonds(self) -> int:
        """Number of pairs of neighbours.

        Examples
        --------
        >>> SpinLattice((3, 4)).bonds, SpinLattice((3, 4), False).bonds
        (24, 17)
        """
        closed = self.periodic if isinstance(self.periodic, tuple) else ()
        return sum((n if p else n - 1) * self.count // n for n, p in zip(self.shape, closed, strict=True))

    def neighbour_sum(self, m: Values) -> Any:
        """Sum of the neighbours of every spin, for m (..., *shape, 3), an array or a Jet of this shape."""
        total: Any = 0 * m
        for axis, n in enumerate(self.shape):
            if n > 1:
                before, after = self._neighbours(m, axis)
                total = total + before + after
        return total

    def difference(self, m: Values, axis: int) -> Any:
        """m_{i + 1} - m_{i - 1} along an axis of the lattice; beyond an open end a spin is 0.

        Examples
        --------
        >>> import numpy as np
        >>> m = np.array([1.0, 2.0, 4.0])[:, None] * [0.0, 0.0, 1.0]
        >>> SpinLattice((3,), False).difference(m, 0)[:, 2].tolist()
        [2.0, 3.0, -2.0]
        """
        before, after = self._neighbours(m, axis)
        return after - before

    def _neighbours(self, m: Values, axis: int) -> tuple[Any, Any]:
        """m_{i - 1} and m_{i + 1} along an axis of the lattice."""
        n, place = self.shape[axis], axis - len(self.shape) - 1
        before, after = np.roll(m, 1, axis=place), np.roll(m, -1, axis=place)
        if isinstance(self.periodic, tuple) and self.periodic[axis]:
            return before, after
        first = np.ones(n, dtype=int).reshape(-1, *[1] * -(place + 1))
        last = first.copy()
        first[0], last[-1] = 0, 0
        return before * first, after * last

    def total(self, x: Values) -> Any:
        """Sum of x (..., *shape) over all spins, shape (...,)."""
        axes = tuple(range(-len(self.shape), 0))
        return np.sum(x, axis=axes) if axes else x

    def check(self, m: npt.ArrayLike | Values) -> None:
        """Raise ShapeError unless m has the shape (..., *shape, 3).

        Examples
        --------
        >>> import numpy as np
        >>> SpinLattice((4,)).check(np.zeros((3, 3)))
        Traceback (most recent call last):
        ...
        liehom.errors.ShapeError: spins of shape (3, 3), expected (..., 4, 3)
        """
        own = (*self.shape, 3)
        if tuple(np.shape(m)[-len(own) :]) != own:
            raise ShapeError(f"spins of shape {np.shape(m)}, expected (..., {', '.join(map(str, own))})")
