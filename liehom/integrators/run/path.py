"""Path: the points after every step of a run, kept as blocks of steps.

Its state is a set of named arrays, for checkpoints.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

NAMES = ("times", "points", "sizes", "moved")


@final
class Path:
    """The points after every step, of one trajectory or an ensemble of which not all move in every step.

    Parameters
    ----------
    t : array of shape (...,)
    m : array of shape (..., N)

    Examples
    --------
    >>> path = Path(np.zeros(2), np.zeros((2, 3)))
    >>> path.add(np.array([0.0, 0.5]), np.ones((2, 3)), np.array([0.0, 0.5]), np.array([False, True]))
    >>> times, points, sizes = path.compact()
    >>> times.tolist(), points.shape, sizes.tolist()
    ([[0.0, 0.0], [nan, 0.5]], (2, 2, 3), [[0.0, 0.5]])
    """

    def __init__(self, t: Any, m: Any) -> None:
        # blocks (k, ...) of times, points, sizes, and of where a step was made
        self._blocks: list[tuple[Any, ...]] = []
        self.add(t, m, np.zeros_like(t), np.ones(t.shape, dtype=bool))

    def __len__(self) -> int:
        return sum(len(block[0]) for block in self._blocks)

    def add(self, t: Any, m: Any, h: Any, moved: Any) -> None:
        """A step of sizes h to (t, m), where trajectories moved."""
        self.extend(np.asarray(t)[None], np.asarray(m)[None], np.asarray(h)[None], np.asarray(moved)[None])

    def extend(self, t: Any, m: Any, h: Any, moved: Any) -> None:
        """Steps one after the other, along a first axis.

        Examples
        --------
        >>> path = Path(np.array(0.0), np.zeros(2))
        >>> path.extend(np.array([1.0, 2.0]), np.ones((2, 2)), np.ones(2), np.ones(2, dtype=bool))
        >>> len(path)
        3
        """
        self._blocks.append((t, m, h, moved))

    def cut(self, length: int) -> None:
        """Forget what was added after the first `length` entries."""
        excess = len(self) - length
        while excess > 0:
            block = self._blocks.pop()
            if len(block[0]) > excess:
                self._blocks.append(tuple(x[:-excess] for x in block))
            excess -= len(block[0])

    def _whole(self) -> tuple[Any, ...]:
        made = tuple(np.concatenate(parts) for parts in zip(*self._blocks, strict=True))
        self._blocks = [made]
        return made

    def compact(self) -> tuple[Any, Any, Any]:
        """Times (n + 1, ...), points (n + 1, ..., N) and sizes (n, ...), each trajectory from its start without gaps.

        Filled up with NaN (sizes with 0) to the largest number of steps.
        """
        times, points, sizes, moved = self._whole()
        if not bool(moved.all()):
            order = np.argsort(~moved, axis=0, kind="stable")[: int(moved.sum(axis=0).max(initial=1))]
            moved = np.take_along_axis(moved, order, axis=0)
            times = np.where(moved, np.take_along_axis(times, order, axis=0), np.nan)
            sizes = np.where(moved, np.take_along_axis(sizes, order, axis=0), 0)
            points = np.where(moved[..., None], np.take_along_axis(points, order[..., None], axis=0), np.nan)
        return times, points, sizes[1:]

    def arrays(self) -> dict[str, Any]:
        """The state, for a checkpoint."""
        return dict(zip(NAMES, self._whole(), strict=True))

    def restore(self, arrays: dict[str, Any]) -> None:
        """Take a state back."""
        self._blocks = [tuple(arrays[name] for name in NAMES)]
