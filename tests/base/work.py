"""Tasks that can be sent to another process, since they have a name in a module."""

import os
import signal
from pathlib import Path

import numpy as np

import liehom as lh


def square(x: int) -> int:
    return x * x


def fails_at_three(x: int) -> int:
    if x == 3:
        raise lh.errors.DependentRowsError(1, [x])
    return x


def kills_its_worker_once(task: tuple[str, int]) -> int:
    """The first time that task 2 is tried its process is killed."""
    folder, x = task
    mark = Path(folder) / "killed"
    if x == 2 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return x


def kills_its_worker(_: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def top(m: np.ndarray) -> np.ndarray:
    return -m * np.array([1.0, 0.5, 0.25])


def velocity(m: np.ndarray, args: np.ndarray) -> np.ndarray:
    return -m / args


def spinning(inertia: np.ndarray | None = None) -> lh.GeneratorField:
    """Rigid bodies, each with its own moments of inertia, which are args if they are not given."""
    return lh.GeneratorField(lh.adjoint(lh.so(3)), velocity if inertia is None else lambda m: -m / inertia)


def crossing(t: float, y: np.ndarray) -> np.ndarray:
    return y[..., 0]
